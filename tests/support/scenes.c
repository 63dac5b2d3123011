/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/support/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/rng.h"
#include "tests/support/pictures.h"

tz_ctx *new_ctx(int threads)
{
    tz_ctx *ctx = NULL;
    assert_int_equal(tz_ctx_new(&(tz_ctx_options){.threads = threads}, &ctx), TZ_OK);
    return ctx;
}

void scene_init(tz_ctx *ctx, tz_layout *l, int32_t width, int32_t height, bool tile,
                int32_t source_width, int32_t source_height)
{
    assert_int_equal(tz_layout_init(ctx, l, width, height, tile), TZ_OK);
    assert_int_equal(
        tz_layout_add_source(l, "photo.png", NULL, source_width, source_height, NULL),
        TZ_OK);
}

int32_t scene_box(tz_layout *l, int32_t source, tz_affine map, double x0, double y0,
                  double x1, double y1)
{
    const tz_point b[] = {{(float)x0, (float)y0},
                          {(float)x1, (float)y0},
                          {(float)x1, (float)y1},
                          {(float)x0, (float)y1}};
    int32_t id = -1;
    assert_int_equal(tz_layout_add(l, source, -1, map, b, 4, &id), TZ_OK);
    return id;
}

int32_t scene_window(tz_layout *l, int32_t source, tz_affine map, tz_rect r)
{
    const double x[] = {r.x, r.x + r.w, r.x + r.w, r.x};
    const double y[] = {r.y, r.y, r.y + r.h, r.y + r.h};
    tz_affine inverse;
    assert_true(tz_affine_invert(map, &inverse));
    tz_point b[4];
    for (int k = 0; k < 4; k++) {
        const tz_vec2 p = tz_affine_apply(inverse, (tz_vec2){x[k], y[k]});
        b[k] = (tz_point){(float)p.x, (float)p.y};
    }
    int32_t id = -1;
    assert_int_equal(tz_layout_add(l, source, -1, map, b, 4, &id), TZ_OK);
    return id;
}

void scene_random(tz_layout *l, int32_t n, uint64_t seed)
{
    const tz_layout_source *s = &l->source.v[0];
    const double w = s->width, h = s->height;
    /* a floor that leaves no void; on a torus one turn's worth is enough */
    scene_window(l, 0,
                 turned((tz_vec2){w / 2, h / 2},
                        (tz_vec2){l->width / 2.0, l->height / 2.0}, 11, 1.07, false),
                 (tz_rect){-8, -8, l->width + 16, l->height + 16});
    for (int32_t k = 0; k < n; k++) {
        tz_rng r = tz_rng_make(seed, (uint64_t)k);
        const double radius = tz_rng_range(&r, 6, 0.45 * fmin(w, h));
        const tz_vec2 c = {tz_rng_range(&r, 0.3, 0.7) * w,
                           tz_rng_range(&r, 0.3, 0.7) * h};
        const tz_vec2 to = {tz_rng_range(&r, -20, l->width + 20.0),
                            tz_rng_range(&r, -20, l->height + 20.0)};
        tz_point b[23];
        for (int i = 0; i < 23; i++) {
            const double a = 2 * TZ_PI * i / 23, q = radius * tz_rng_range(&r, 0.6, 1);
            b[i] = (tz_point){(float)(c.x + q * cos(a)), (float)(c.y + q * sin(a))};
        }
        const bool whole = tz_rng_below(&r, 4) == 0;
        const tz_affine m =
            whole ? move_by(floor(to.x - c.x), floor(to.y - c.y))
                  : turned(c, to, tz_rng_range(&r, -180, 180), tz_rng_range(&r, 0.6, 1.5),
                           tz_rng_below(&r, 2) == 0);
        assert_int_equal(tz_layout_add(l, 0, -1, m, b, 23, NULL), TZ_OK);
    }
}

tz_affine move_by(double x, double y) { return (tz_affine){1, 0, 0, 1, x, y}; }

tz_affine turned(tz_vec2 centre, tz_vec2 to, double degrees, double scale, bool mirror)
{
    return tz_affine_place(centre, to, degrees * TZ_PI / 180, scale, mirror);
}

tz_image render(tz_ctx *ctx, const tz_layout *l, const tz_image *photos, int32_t n,
                tz_map_kind kind, const tz_compose_params *params, tz_rect r)
{
    tz_composer *c = NULL;
    if (r.w == 0)
        r = (tz_rect){0, 0, l->width, l->height};
    assert_int_equal(tz_composer_new(ctx, l, photos, n, kind, params, &c), TZ_OK);
    tz_image out = blank(ctx, r.w, r.h, photos[0].channels);
    assert_int_equal(tz_composer_render(ctx, c, r, &out), TZ_OK);
    tz_composer_free(c);
    return out;
}

tz_image render_colour(tz_ctx *ctx, const tz_layout *l, const tz_image *photo, tz_rect r)
{
    return render(ctx, l, photo, 1, TZ_MAP_COLOUR, NULL, r);
}

tz_compose_params cloned(tz_clone clone)
{
    tz_compose_params p;
    tz_params_default(&tz_compose_param_table, &p);
    p.clone = clone;
    return p;
}
