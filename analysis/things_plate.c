/* SPDX-License-Identifier: Apache-2.0 */
#include "analysis/things_plate.h"

tz_status tz_things_plate(tz_ctx *ctx, const tz_image *photo, const int32_t *label,
                          tz_image *plate)
{
    (void)label;
    return tz_image_copy(ctx, photo, plate);
}
