/* SPDX-License-Identifier: Apache-2.0 */
/* The score: 100 less what each fault costs.
 *
 *   saturate(x, a) = 1 - exp(-x / a), x >= 0
 *
 * A ratio of 1 or below costs nothing: being closer to the exemplar than a second crop of
 * it would be earns nothing. Each fault costs on its own, up to its weight. */
#include <math.h>

#include "analysis/quality_measures.h"

static double saturate(double x, double scale) { return x > 0 ? 1 - exp(-x / scale) : 0; }

void tz_quality_score(tz_quality *q)
{
    q->cost_patch = 40 * saturate(q->patch - 1, 3);
    q->cost_structure =
        25 * saturate(q->orientation - 1, 2) + 10 * saturate(q->correlation - 1, 3);
    double off =
        fabs(log(q->sharpness > 1e-6 ? q->sharpness : 1e-6)) - log(q->sharpness_range);
    q->cost_sharpness = 40 * saturate(off, 0.8);
    q->cost_repetition =
        40 * saturate(0.6 * q->repetition + 0.4 * q->repetition_near, 0.4);
    q->cost_periodicity = 20 * saturate(q->periodicity, 0.4);
    q->cost_seam = 30 * saturate(q->seam - 3e-4, 0.006);
    q->cost_broken = 20 * saturate(q->broken - 1.1, 0.5);
    q->cost_wrap = isfinite(q->wrap) ? 20 * saturate(q->wrap - 1.2, 1) : 0;
    double s = 100 - q->cost_patch - q->cost_structure - q->cost_sharpness -
               q->cost_repetition - q->cost_periodicity - q->cost_seam - q->cost_broken -
               q->cost_wrap;
    q->score = s > 0 ? s : 0;
}
