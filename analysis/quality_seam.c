/* SPDX-License-Identifier: Apache-2.0 */
#include "analysis/quality_measures.h"

tz_status tz_quality_seam(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q)
{
    (void)ctx, (void)w;
    q->seam = 0;
    return TZ_OK;
}
