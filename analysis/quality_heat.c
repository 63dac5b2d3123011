/* SPDX-License-Identifier: Apache-2.0 */
#include "analysis/quality_measures.h"

tz_status tz_quality_heat(tz_ctx *ctx, const tz_quality_work *w, tz_image *map)
{
    return tz_image_init(ctx, map, w->output->crop[0].w, w->output->crop[0].h, 1);
}
