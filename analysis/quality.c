/* SPDX-License-Identifier: Apache-2.0 */
/* Driver of the quality measures: docs/quality.md tells what each sees and what it costs.
 *
 * Exemplar and output become planes and pyramids once (quality_planes.c); then each
 * measure works alone, in parallel inside itself. Huge pictures are measured on seeded
 * crops, so that memory does not grow with the output. */
#include "analysis/quality.h"

#include <math.h>
#include <stddef.h>

#include "analysis/quality_measures.h"

#define F(m) offsetof(tz_quality_params, m)
static const tz_param rows[] = {
    {"seed", TZ_PARAM_UINT64, F(seed), 0, 1.8e19, "1", "", NULL,
     "seed of the places and directions that are drawn"},
    {"tile", TZ_PARAM_BOOL, F(tile), 0, 1, "false", "", NULL,
     "the output is a tile: measure the seam across its wrap too"},
    {"projections", TZ_PARAM_INT, F(projections), 1, 1024, "64", "", NULL,
     "directions of the sliced Wasserstein distance, a level"},
    {"patches", TZ_PARAM_INT, F(patches), 16, 65536, "4096", "", NULL,
     "patches drawn from each picture, a level"},
};
#undef F

const tz_param_table tz_quality_param_table = {
    "compare", "measures how well an output continues its exemplar", rows,
    sizeof rows / sizeof *rows, sizeof(tz_quality_params)};

static tz_status check(tz_ctx *ctx, const tz_image *e, const tz_image *o)
{
    const tz_image *im[2] = {e, o};
    static const char *const name[2] = {"exemplar", "output"};
    for (int i = 0; i < 2; i++) {
        if (im[i]->width < TZ_QUALITY_MIN_SIDE || im[i]->height < TZ_QUALITY_MIN_SIDE)
            return tz_fail(ctx, TZ_INVALID,
                           "%s is %d x %d px, quality is measured from %d x %d px on",
                           name[i], im[i]->width, im[i]->height, TZ_QUALITY_MIN_SIDE,
                           TZ_QUALITY_MIN_SIDE);
        if (tz_quality_colours(im[i]) == 0)
            return tz_fail(ctx, TZ_INVALID,
                           "%s has %d channels, quality is measured on grey or RGB, with "
                           "or without alpha",
                           name[i], im[i]->channels);
    }
    return TZ_OK;
}

tz_status tz_quality_measure(tz_ctx *ctx, const tz_image *exemplar,
                             const tz_image *output, const tz_quality_params *params,
                             tz_quality *q, tz_image *heat)
{
    static tz_status (*const measure[])(tz_ctx *, const tz_quality_work *,
                                        tz_quality *) = {
        tz_quality_patch,     tz_quality_orientation, tz_quality_correlation,
        tz_quality_sharpness, tz_quality_repetition,  tz_quality_seam,
        tz_quality_lines,
    };
    enum { N = sizeof measure / sizeof *measure };
    tz_quality_picture e = {0}, o = {0};
    tz_quality_work w = {.exemplar = &e, .output = &o, .params = params};
    tz_quality r = {.wrap = NAN};
    tz_image map = {0};
    size_t area = (size_t)output->width * (size_t)output->height;
    tz_status s = check(ctx, exemplar, output);
    if (s != TZ_OK)
        return s;
    tz_progress_begin(ctx, "compare", "measures", N + 2);
    /* a grey picture and a coloured one are compared in colour */
    int32_t a = tz_quality_colours(exemplar), b = tz_quality_colours(output);
    int32_t planes = a > b ? a : b;
    if (heat && (int64_t)area > TZ_QUALITY_MAX_AREA) {
        s = tz_fail(ctx, TZ_LIMIT,
                    "a heat map of %d x %d px is too large, ask for it on a crop of the "
                    "output up to %d px",
                    output->width, output->height, TZ_QUALITY_MAX_AREA);
        goto done;
    }
    s = tz_quality_picture_init(ctx, &e, exemplar, planes, 1, params->seed);
    if (s == TZ_OK)
        s = tz_quality_picture_init(ctx, &o, output, planes, TZ_QUALITY_CROPS,
                                    params->seed);
    if (s == TZ_OK && heat)
        s = tz_alloc_zero(ctx, &w.heat_repeat, area, sizeof(float));
    if (s == TZ_OK && heat)
        s = tz_alloc_zero(ctx, &w.heat_seam, area, sizeof(float));
    tz_progress_add(ctx, 1);
    for (int i = 0; i < N && s == TZ_OK; i++) {
        s = tz_ctx_cancelled(ctx) ? TZ_CANCELLED : measure[i](ctx, &w, &r);
        tz_progress_add(ctx, 1);
    }
    if (s == TZ_OK && params->tile)
        s = tz_quality_wrap(ctx, output, &r);
    if (s == TZ_OK && heat)
        s = tz_quality_heat(ctx, &w, &map);
    tz_progress_add(ctx, 1);
    if (s != TZ_OK)
        goto done;
    tz_quality_score(&r);
    *q = r;
    if (heat)
        *heat = map;
done:
    tz_progress_end(ctx);
    tz_free(ctx, w.heat_repeat);
    tz_free(ctx, w.heat_seam);
    tz_quality_picture_deinit(&e);
    tz_quality_picture_deinit(&o);
    return s;
}
