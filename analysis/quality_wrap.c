/* SPDX-License-Identifier: Apache-2.0 */
/* Wrap seam of a tile: the step across its border over the steps inside.
 *
 * As for seams, r = d0 - (d-1 + d+1) / 4 across the joint of the last column (row) and the
 * first, mean |r| along it, over the mean |r| of both border strips; lightness and colour
 * apart. A second look at strips of WIDE px sees a step of shading or colour that was
 * blurred: the mean |difference| of neighbouring strips' means over WIDE x WIDE px, across
 * the joint and inside. The figure is the worst of all. */
#include <math.h>
#include <string.h>

#include "analysis/quality_measures.h"

#define STRIP 32
#define WIDE  8

/* Mean |r| at the joint, between column w - 1 and 0 (or rows), and inside the strips. */
static double fine_step(const tz_quality_planes *f, int first, int end, bool down)
{
    int32_t along = down ? f->w : f->h, across = down ? f->h : f->w;
    size_t step = down ? (size_t)f->w : 1, row = down ? 1 : (size_t)f->w;
    int32_t m = across / 2 < STRIP ? across / 2 : STRIP;
    double joint = 0, inside = 0;
    for (int32_t i = 0; i < along; i++)
        for (int32_t k = -m + 1; k < m - 2; k++) {
            double sum = 0;
            for (int c = first; c < end; c++) {
                const float *p = f->v[c] + (size_t)i * row;
                float v[4];
                for (int t = 0; t < 4; t++)
                    v[t] = p[(size_t)((k + t - 1 + across) % across) * step];
                float r = v[2] - v[1] - 0.25f * (v[1] - v[0] + v[3] - v[2]);
                sum += (double)r * (double)r;
            }
            if (k == -1)
                joint += sqrt(sum);
            else if (k < -3 || k > 1)
                inside += sqrt(sum);
        }
    return tz_quality_ratio(joint / along, inside / along / (2 * m - 8), 0.02);
}

/* Mean |difference| of strip means, across the joint over inside. */
static tz_status wide_step(tz_ctx *ctx, const tz_quality_planes *f, bool down,
                           double *ratio)
{
    int32_t along = (down ? f->w : f->h) / WIDE, across = (down ? f->h : f->w) / WIDE;
    size_t step = down ? (size_t)f->w : 1, row = down ? 1 : (size_t)f->w;
    int32_t length = down ? f->h : f->w;
    double *mean, joint = 0, inside = 0;
    tz_status s = tz_alloc(ctx, &mean, (size_t)across, sizeof *mean);
    for (int32_t i = 0; i < along && s == TZ_OK; i++)
        for (int c = 0; c < f->n; c++) {
            for (int32_t k = 0; k < across; k++) {
                /* the second half of the strips is aligned to the far border */
                int32_t k0 = k < across / 2 ? k * WIDE : length - (across - k) * WIDE;
                mean[k] = 0;
                for (int32_t v = 0; v < WIDE; v++)
                    for (int32_t u = 0; u < WIDE; u++)
                        mean[k] += (double)f->v[c][(size_t)(i * WIDE + v) * row +
                                                   (size_t)(k0 + u) * step];
                mean[k] /= WIDE * WIDE;
            }
            joint += fabs(mean[0] - mean[across - 1]);
            for (int32_t k = 1; k < across; k++)
                inside += fabs(mean[k] - mean[k - 1]) / (across - 1);
        }
    double n = (double)along * f->n;
    *ratio = s == TZ_OK ? tz_quality_ratio(joint / n, inside / n, 0.05) : 1;
    tz_free(ctx, mean);
    return s;
}

tz_status tz_quality_wrap(tz_ctx *ctx, const tz_image *output, tz_quality *q)
{
    tz_quality_planes f = {0};
    tz_rect all = {0, 0, output->width, output->height};
    double worst = 0;
    tz_status s =
        tz_quality_planes_from_image(ctx, &f, output, all, tz_quality_colours(output));
    for (int down = 0; down < 2 && s == TZ_OK; down++) {
        double v[3] = {fine_step(&f, 0, 1, down),
                       f.n == 3 ? fine_step(&f, 1, 3, down) : 0};
        s = wide_step(ctx, &f, down, &v[2]);
        for (int k = 0; k < 3; k++)
            worst = v[k] > worst ? v[k] : worst;
    }
    q->wrap = worst;
    tz_quality_planes_deinit(&f);
    return s;
}
