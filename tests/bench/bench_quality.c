/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Quality measures of an output of 2048 x 2048 px against an exemplar of 1024 x 1024 (drawn
 * stones), on two threads: best of 3 runs in seconds, and the peak of memory. */
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "analysis/quality.h"
#include "base/rng.h"

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Voronoi stones, 40 px, with joints and noise; `seed` tells one wall from the other. */
static tz_status draw(tz_ctx *ctx, int32_t side, uint64_t seed, tz_image *im)
{
    tz_status s = tz_image_init(ctx, im, side, side, 3);
    im->encoding = TZ_ENCODING_SRGB;
    tz_rng noise = tz_rng_make(seed, 1);
    for (int32_t y = 0; y < side && s == TZ_OK; y++) {
        for (int32_t x = 0; x < side; x++) {
            double near[2] = {1e9, 1e9}, grey = 0;
            for (int32_t j = y / 40 - 1; j <= y / 40 + 1; j++) {
                for (int32_t i = x / 40 - 1; i <= x / 40 + 1; i++) {
                    tz_rng r =
                        tz_rng_make(seed, tz_rng_stream(2, (uint64_t)i, (uint64_t)j));
                    double dx = (i + tz_rng_unit(&r)) * 40 - x;
                    double dy = (j + tz_rng_unit(&r)) * 40 - y,
                           d = sqrt(dx * dx + dy * dy);
                    near[1] = d < near[0] ? near[0] : d < near[1] ? d : near[1];
                    if (d < near[0]) {
                        near[0] = d;
                        grey = tz_rng_range(&r, 0.3, 0.7);
                    }
                }
            }
            double stone = fmin(1, fmax(0, (near[1] - near[0]) / 6));
            for (int32_t c = 0; c < 3; c++)
                tz_image_at(im, x, y)[c] = (float)(0.15 + stone * (grey - 0.15) +
                                                   tz_rng_range(&noise, -0.05, 0.05));
        }
    }
    return s;
}

int main(void)
{
    const tz_ctx_options opt = {.threads = 2};
    tz_ctx *ctx = NULL;
    tz_image e = {0}, o = {0};
    tz_quality_params p;
    tz_quality q = {0};
    double best = 1e9;
    tz_status s = tz_ctx_new(&opt, &ctx);
    if (s != TZ_OK)
        return 1;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_quality_param_table, &p);
    s = draw(ctx, 1024, 1, &e);
    if (s == TZ_OK)
        s = draw(ctx, 2048, 2, &o);
    for (int k = 0; k < 3 && s == TZ_OK; k++) {
        double start = now();
        s = tz_quality_measure(ctx, &e, &o, &p, &q, NULL);
        best = fmin(best, now() - start);
    }
    if (s == TZ_OK)
        printf("quality 2048x2048 of 1024x1024 (score %.1f, peak %.0f MiB) %.3f\n",
               q.score, (double)tz_ctx_memory_peak(ctx) / (1 << 20), best);
    else
        fprintf(stderr, "bench_quality: %s\n", tz_ctx_message(ctx));
    tz_image_deinit(&e);
    tz_image_deinit(&o);
    tz_ctx_free(ctx);
    return s != TZ_OK;
}
