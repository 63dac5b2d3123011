/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/bench/edge_detectors.h"

#include "analysis/boundary_score.h"
#include "analysis/edges.h"
#include "analysis/forest.h"
#include "analysis/tensor.h"
#include "tests/bench/bench.h"

/* Lab units of the gradient's response that count as 1. */
#define FULL_GRADIENT 20

/* Thins a response and brings it to 0..1. */
static tz_status finish(tz_ctx *ctx, const edge_input *in, const float *response,
                        float full, float *strength)
{
    const int32_t w = in->photo->width, h = in->photo->height;
    const tz_status s = tz_boundary_thin(ctx, response, w, h, strength);
    for (int64_t p = 0; p < (int64_t)w * h && s == TZ_OK; p++)
        strength[p] = strength[p] < full ? strength[p] / full : 1;
    return s;
}

/* Thinned as every response, or (setting 1) by the edge map of the analysis itself, which
 * knows the tensor's own direction. */
static tz_status detect_gradient(tz_ctx *ctx, const edge_input *in, double setting,
                                 float *strength, double *seconds)
{
    /* those of analysis/ebpt.c */
    static const double fine[TZ_TENSOR_LEVELS] = {0.35, 0.5, 0.35};
    const int32_t w = in->photo->width, h = in->photo->height;
    const double start = bench_now();
    tz_tensor t;
    tz_edge_map m = {0};
    tz_status s = tz_tensor_init(ctx, in->photo, &t);
    if (s != TZ_OK)
        return s;
    if ((s = tz_edge_map_init(ctx, &m, w, h)) != TZ_OK)
        goto done;
    if ((s = tz_tensor_response(&t, fine, m.response, m.normal)) != TZ_OK)
        goto done;
    *seconds = bench_now() - start;
    if (setting == 0) {
        s = finish(ctx, in, m.response, FULL_GRADIENT, strength);
        goto done;
    }
    if ((s = tz_edge_map_detect(&m, 0, 0.1)) != TZ_OK)
        goto done;
    for (int64_t p = 0; p < (int64_t)w * h; p++)
        strength[p] = m.on[p] ? fminf(1, m.response[p] / FULL_GRADIENT) : 0;
done:
    tz_edge_map_deinit(&m);
    tz_tensor_deinit(&t);
    return s;
}

static tz_status detect_forest(tz_ctx *ctx, const edge_input *in, double setting,
                               float *strength, double *seconds)
{
    const size_t n = (size_t)in->photo->width * in->photo->height;
    const tz_forest *forest = NULL;
    float *r = NULL;
    (void)setting;
    tz_status s = tz_forest_of(ctx, in->model, &forest);
    if (s != TZ_OK)
        return s;
    if ((s = tz_alloc(ctx, &r, n, 3 * sizeof *r)) != TZ_OK)
        return s;
    const double start = bench_now();
    s = tz_forest_response(ctx, in->photo, forest, r, r + n);
    *seconds = bench_now() - start;
    if (s == TZ_OK)
        s = finish(ctx, in, r, 1, strength);
    tz_free(ctx, r);
    return s;
}

static tz_status detect_forest_cv(tz_ctx *ctx, const edge_input *in, double setting,
                                  float *strength, double *seconds)
{
    const size_t n = (size_t)in->photo->width * in->photo->height;
    float *r = NULL;
    (void)setting;
    tz_status s = tz_alloc(ctx, &r, n, sizeof *r);
    if (s != TZ_OK)
        return s;
    s = rival_forest(ctx, &in->dense, in->model, r, seconds);
    if (s == TZ_OK)
        s = finish(ctx, in, r, 1, strength);
    tz_free(ctx, r);
    return s;
}

static tz_status detect_canny(tz_ctx *ctx, const edge_input *in, double setting,
                              float *strength, double *seconds)
{
    return rival_canny(ctx, &in->dense, fabs(setting), setting < 0, strength, seconds);
}

static tz_status detect_drawing(tz_ctx *ctx, const edge_input *in, double setting,
                                float *strength, double *seconds)
{
    const int op = (int)setting;
    return rival_edge_drawing(ctx, &in->dense, op, 10 * (setting - op), strength,
                              seconds);
}

const edge_detector edge_detectors[] = {
    {"forest", "-", detect_forest, 0, true, true},
    {"forest-opencv", "-", detect_forest_cv, 0, true, false},
    {"gradient", "ridges", detect_gradient, 0, false, false},
    {"gradient", "own-ridges", detect_gradient, 1, false, true},
    /* sigma, negative: in colour */
    {"canny", "1.0", detect_canny, 1.0, false, false},
    {"canny", "1.5", detect_canny, 1.5, false, false},
    {"canny", "2.0", detect_canny, 2.0, false, true},
    {"canny", "2.5", detect_canny, 2.5, false, false},
    {"canny", "3.0", detect_canny, 3.0, false, false},
    {"canny", "colour-1.5", detect_canny, -1.5, false, false},
    {"canny", "colour-2.0", detect_canny, -2.0, false, false},
    /* operator + sigma / 10 */
    {"edge-drawing", "prewitt-1.0", detect_drawing, 0.10, false, false},
    {"edge-drawing", "prewitt-1.5", detect_drawing, 0.15, false, true},
    {"edge-drawing", "prewitt-2.0", detect_drawing, 0.20, false, false},
    {"edge-drawing", "sobel-1.5", detect_drawing, 1.15, false, false},
    {"edge-drawing", "scharr-1.5", detect_drawing, 2.15, false, false},
};
const int32_t edge_detectors_n =
    (int32_t)(sizeof edge_detectors / sizeof *edge_detectors);
