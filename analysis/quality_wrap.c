/* SPDX-License-Identifier: Apache-2.0 */
#include "analysis/quality_measures.h"

tz_status tz_quality_wrap(tz_ctx *ctx, const tz_image *w, tz_quality *q)
{
    (void)ctx, (void)w;
    q->wrap = 1;
    return TZ_OK;
}
