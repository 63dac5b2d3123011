/* SPDX-License-Identifier: Apache-2.0 */
/* Strength of borders out of two witnesses: the edge forest, which knows borders from
 * grain but is blunt, and the fine gradient of colour, which is sharp. */
#include "analysis/things_picture.h"

#include <math.h>

#include "analysis/forest.h"
#include "analysis/scale.h"

#define FULL_FOREST 0.5F /* share of trees that makes a full border */

/* edge = F (0.7 + 0.3 G) + 0.06 G, up to 1, with forest F and gradient G in shares of a
 * full border. */
static void combine(tz_things_view *v, const float *gradient, float full)
{
    const size_t n = (size_t)v->picture.width * (size_t)v->picture.height;
    for (size_t i = 0; i < n; i++) {
        const float f = fminf(v->forest[i] / FULL_FOREST, 1.5F);
        const float g = fminf(gradient[i] / full, 1.5F);
        v->edge[i] = fminf(1, f * (0.7F + 0.3F * g) + 0.06F * g);
    }
}

tz_status tz_things_look(tz_ctx *ctx, const tz_image *photo, const char *model,
                         tz_things_view *v)
{
    static const double fine[TZ_TENSOR_LEVELS] = {0.7, 0.5};
    const size_t n = (size_t)photo->width * (size_t)photo->height;
    const tz_forest *forest = NULL;
    float *gradient = NULL;
    *v = (tz_things_view){0};
    tz_status s = tz_forest_of(ctx, model, &forest);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &v->edge, n, sizeof *v->edge);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &v->forest, n, sizeof *v->forest);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &v->normal, n, 2 * sizeof *v->normal);
    if (s == TZ_OK)
        s = tz_forest_response(ctx, photo, forest, v->forest, v->normal);
    if (s == TZ_OK)
        s = tz_tensor_init(ctx, photo, &v->tensor);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &gradient, n, sizeof *gradient);
    if (s == TZ_OK)
        s = tz_tensor_response(&v->tensor, fine, gradient, NULL);
    if (s == TZ_OK) {
        v->picture = (tz_things_picture){.width = photo->width,
                                         .height = photo->height,
                                         .channels = v->tensor.channels,
                                         .lab = v->tensor.level[0].lab,
                                         .edge = v->edge};
        combine(v, gradient, (float)fmax(0.25, tz_scale_full(gradient, (int64_t)n)));
    }
    tz_free(ctx, gradient);
    if (s != TZ_OK)
        tz_things_view_deinit(ctx, v);
    return s;
}

void tz_things_view_deinit(tz_ctx *ctx, tz_things_view *v)
{
    tz_tensor_deinit(&v->tensor);
    tz_free(ctx, v->edge);
    tz_free(ctx, v->normal);
    tz_free(ctx, v->forest);
    *v = (tz_things_view){0};
}
