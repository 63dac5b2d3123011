/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Photo of 512 x 512 and 1024 x 1024 px (drawn stones with texture, or the photos that
 * are given) to an EBPT, in memory, on two threads: best of 5 runs in seconds; and of that
 * the detection of edges alone. */
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "analysis/ebpt.h"
#include "analysis/forest.h"
#include "base/image_io.h"
#include "base/rng.h"

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Voronoi stones, 40 px, each of its own colour, with joints and noise. */
static tz_status draw(tz_ctx *ctx, int32_t side, tz_image *im)
{
    tz_status s = tz_image_init(ctx, im, side, side, 3);
    im->encoding = TZ_ENCODING_SRGB;
    tz_rng noise = tz_rng_make(1, 0);
    for (int32_t y = 0; y < side && s == TZ_OK; y++) {
        for (int32_t x = 0; x < side; x++) {
            double near[2] = {1e9, 1e9}, colour[3] = {0};
            for (int32_t j = y / 40 - 1; j <= y / 40 + 1; j++) {
                for (int32_t i = x / 40 - 1; i <= x / 40 + 1; i++) {
                    tz_rng r = tz_rng_make(2, tz_rng_stream(0, (uint64_t)i, (uint64_t)j));
                    const double dx = (i + tz_rng_unit(&r)) * 40 - x;
                    const double dy = (j + tz_rng_unit(&r)) * 40 - y,
                                 d = sqrt(dx * dx + dy * dy);
                    near[1] = d < near[0] ? near[0] : d < near[1] ? d : near[1];
                    if (d < near[0]) {
                        near[0] = d;
                        for (int32_t c = 0; c < 3; c++)
                            colour[c] = tz_rng_range(&r, 0.3, 0.7);
                    }
                }
            }
            const double stone = fmin(1, fmax(0, (near[1] - near[0]) / 6));
            const double grain = tz_rng_range(&noise, -0.1, 0.1);
            for (int32_t c = 0; c < 3; c++)
                tz_image_at(im, x, y)[c] =
                    (float)(0.15 + stone * (colour[c] + grain - 0.15));
        }
    }
    return s;
}

/* Best of 5 runs of the shipped forest. */
static tz_status detect(tz_ctx *ctx, const tz_image *im, double *best)
{
    const size_t n = (size_t)im->width * (size_t)im->height;
    const tz_forest *forest = NULL;
    float *response = NULL;
    tz_status s = tz_forest_of(ctx, "", &forest);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &response, n, 3 * sizeof *response);
    *best = 1e9;
    for (int32_t k = 0; k < 5 && s == TZ_OK; k++) {
        const double start = now();
        s = tz_forest_response(ctx, im, forest, response, response + n);
        *best = fmin(*best, now() - start);
    }
    tz_free(ctx, response);
    return s;
}

static tz_status run(tz_ctx *ctx, const char *name, const tz_image *im)
{
    tz_ebpt_params p;
    double best = 1e9;
    int32_t groups = 0, edges = 0;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_ebpt_param_table, &p);
    for (int32_t k = 0; k < 5; k++) {
        tz_ebpt e;
        const double start = now();
        const tz_status s = tz_ebpt_analyze(ctx, im, &p, &e);
        if (s != TZ_OK)
            return s;
        best = fmin(best, now() - start);
        groups = e.group.n;
        edges = e.edge.n;
        tz_ebpt_deinit(&e);
    }
    double forest = 0;
    const tz_status s = detect(ctx, im, &forest);
    printf("analyze %s %dx%d (%d groups, %d edges) %.4f %.4f\n", name, im->width,
           im->height, groups, edges, forest, best);
    return s;
}

int main(int argc, char **argv)
{
    const tz_ctx_options o = {.threads = 2};
    const tz_image_read_options read = {.want = TZ_ENCODING_SRGB};
    tz_ctx *ctx = NULL;
    tz_status s = tz_ctx_new(&o, &ctx);
    for (int32_t side = 512; side <= 1024 && s == TZ_OK && argc < 2; side *= 2) {
        tz_image im;
        if ((s = draw(ctx, side, &im)) == TZ_OK)
            s = run(ctx, "stones", &im);
        tz_image_deinit(&im);
    }
    for (int i = 1; i < argc && s == TZ_OK; i++) {
        tz_image im;
        if ((s = tz_image_read(ctx, argv[i], &read, &im)) == TZ_OK)
            s = run(ctx, argv[i], &im);
        tz_image_deinit(&im);
    }
    if (s != TZ_OK)
        fprintf(stderr, "bench_analyze: %s\n", tz_ctx_message(ctx));
    tz_ctx_free(ctx);
    return s != TZ_OK;
}
