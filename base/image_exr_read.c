/* SPDX-License-Identifier: Apache-2.0 */
#include "base/image_internal.h"

tz_status tz_exr_read(const tz_image_source *src, tz_image *im, tz_image_found *found)
{
    (void)src;
    (void)im;
    (void)found;
    return TZ_UNSUPPORTED;
}
