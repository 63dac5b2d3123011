/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/support/arranged.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

void source_from(tz_ctx *ctx, arranged_source *s, tz_image photo, const char *name)
{
    memset(s, 0, sizeof *s);
    s->photo = photo;
    tz_ebpt_params p;
    tz_params_default(&tz_ebpt_param_table, &p);
    assert_int_equal(tz_ebpt_analyze(ctx, &s->photo, &p, &s->ebpt), TZ_OK);
    s->exemplar = (tz_exemplar){&s->photo, &s->ebpt, name, NULL};
}

void source_init(tz_ctx *ctx, arranged_source *s, picture_kind kind, int32_t width,
                 int32_t height, uint64_t seed)
{
    source_from(ctx, s, picture(ctx, kind, width, height, 3, seed), "drawn.png");
}

void source_deinit(arranged_source *s)
{
    tz_ebpt_deinit(&s->ebpt);
    tz_image_deinit(&s->photo);
}

tz_arrange_params arrange_params(int32_t width, int32_t height, uint64_t seed, bool tile)
{
    tz_arrange_params p;
    tz_params_default(&tz_arrange_param_table, &p);
    p.size[0] = width, p.size[1] = height;
    p.seed = seed, p.tile = tile;
    return p;
}

void arrange_one(tz_ctx *ctx, const arranged_source *s, const tz_rules *rules,
                 const tz_arrange_params *p, tz_layout *l)
{
    memset(l, 0, sizeof *l);
    const tz_status st = tz_arrange(ctx, &s->exemplar, 1, rules, p, l);
    if (st != TZ_OK)
        fail_msg("arrange: %s: %s", tz_status_text(st), tz_ctx_message(ctx));
}

static void mix(uint64_t *h, const void *data, size_t n)
{
    const unsigned char *p = data;
    for (size_t i = 0; i < n; i++)
        *h = (*h ^ p[i]) * 0x100000001b3ULL; /* FNV-1a */
}

uint64_t layout_hash(const tz_layout *l)
{
    uint64_t h = 0xcbf29ce484222325ULL;
    mix(&h, &l->width, sizeof l->width);
    mix(&h, &l->height, sizeof l->height);
    mix(&h, &l->place.n, sizeof l->place.n);
    for (int32_t k = 0; k < l->place.n; k++) {
        const tz_placement *p = &l->place.v[k];
        mix(&h, &p->map, sizeof p->map);
        mix(&h, &p->source, sizeof p->source);
        mix(&h, &p->group, sizeof p->group);
        mix(&h, l->border.v + p->border, (size_t)p->points * sizeof *l->border.v);
    }
    return h;
}

static int compare_double(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Marks the pixels whose centres lie in a placement's border; wraps on a torus. */
static void mark(const tz_layout *l, const tz_placement *p, uint8_t *covered)
{
    double *x = malloc(3 * sizeof *x * (size_t)p->points), *y = x + p->points;
    double *cross = y + p->points, y0 = INFINITY, y1 = -INFINITY;
    for (int32_t i = 0; i < p->points; i++) {
        const tz_point b = l->border.v[p->border + i];
        const tz_vec2 v = tz_affine_apply(p->map, (tz_vec2){b.x, b.y});
        x[i] = v.x, y[i] = v.y;
        y0 = fmin(y0, v.y), y1 = fmax(y1, v.y);
    }
    for (int32_t j = (int32_t)floor(y0); j <= (int32_t)y1; j++) {
        int32_t n = 0;
        if (!l->tile && (j < 0 || j >= l->height))
            continue;
        for (int32_t i = 0, k = p->points - 1; i < p->points; k = i++)
            if ((y[i] > j + 0.5) != (y[k] > j + 0.5))
                cross[n++] = x[i] + (j + 0.5 - y[i]) * (x[k] - x[i]) / (y[k] - y[i]);
        qsort(cross, (size_t)n, sizeof *cross, compare_double);
        for (int32_t c = 0; c + 1 < n; c += 2)
            for (int32_t i = (int32_t)ceil(cross[c] - 0.5); i + 0.5 < cross[c + 1]; i++)
                if (l->tile)
                    covered[(j % l->height + l->height) % l->height * l->width +
                            (i % l->width + l->width) % l->width] = 1;
                else if (i >= 0 && i < l->width)
                    covered[j * l->width + i] = 1;
    }
    free(x);
}

int64_t bare_pixels(const tz_layout *l, double *farthest)
{
    const int32_t w = l->width, h = l->height, most = 20;
    uint8_t *covered = calloc((size_t)w * (size_t)h, 1);
    int64_t n = 0;
    for (int32_t k = 0; k < l->place.n; k++)
        if (!l->place.v[k].removed)
            mark(l, &l->place.v[k], covered);
    *farthest = 0;
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            if (covered[y * w + x])
                continue;
            n++;
            int32_t least = most * most;
            for (int32_t j = y > most ? y - most : 0; j < h && j <= y + most; j++)
                for (int32_t i = x > most ? x - most : 0; i < w && i <= x + most; i++) {
                    const int32_t d = (i - x) * (i - x) + (j - y) * (j - y);
                    if (covered[j * w + i] && d < least)
                        least = d;
                }
            *farthest = fmax(*farthest, sqrt(least));
        }
    free(covered);
    return n;
}

void map_parts(tz_affine m, double *angle, double *scale, bool *mirror)
{
    const double det = tz_affine_det(m);
    *mirror = det < 0;
    *scale = sqrt(fabs(det));
    *angle = atan2(-m.c, m.d); /* the second column is never mirrored */
}

tz_vec2 middle_of(const tz_layout *l, int32_t id)
{
    const tz_placement *p = &l->place.v[id];
    tz_vec2 sum = {0, 0};
    for (int32_t k = p->border; k < p->border + p->points; k++)
        sum = tz_vec2_add(sum, (tz_vec2){l->border.v[k].x, l->border.v[k].y});
    return tz_affine_apply(p->map, tz_vec2_scale(sum, 1.0 / p->points));
}

void assert_sound(const tz_layout *l, const tz_exemplar *ex, int32_t n, double slack)
{
    assert_int_equal(l->source.n, n);
    for (int32_t k = 0; k < n; k++) {
        assert_int_equal(l->source.v[k].width, ex[k].photo->width);
        assert_int_equal(l->source.v[k].height, ex[k].photo->height);
        assert_string_equal(l->source.v[k].path, ex[k].path);
    }
    assert_true(l->place.n > 0);
    for (int32_t k = 0; k < l->place.n; k++) {
        const tz_placement *p = &l->place.v[k];
        assert_true(tz_affine_finite(p->map));
        /* turned, scaled, stretched a little, but not sheared */
        const double along = hypot(p->map.a, p->map.b),
                     across = hypot(p->map.c, p->map.d);
        const double dot = p->map.a * p->map.c + p->map.b * p->map.d;
        if (fabs(dot) > 1e-9)
            fail_msg("placement %d is sheared by %g: %g %g %g %g", k, dot, p->map.a,
                     p->map.b, p->map.c, p->map.d);
        assert_true(along > 0.2 && along < 5 && along / across > 0.9 &&
                    along / across < 1.11);
        assert_in_range(p->source, 0, n - 1);
        assert_in_range(p->group, 0, ex[p->source].ebpt->group.n - 1);
        assert_true(p->points >= 3 && p->border >= 0 &&
                    p->border + p->points <= l->border.n);
        assert_int_equal(p->medium, TZ_MEDIUM_EDGE_GROUP);
        assert_false(p->removed);
        const double w = ex[p->source].photo->width, h = ex[p->source].photo->height;
        for (int32_t i = p->border; i < p->border + p->points; i++) {
            const tz_point q = l->border.v[i];
            if (!(q.x >= -slack && q.y >= -slack && q.x <= w + slack && q.y <= h + slack))
                fail_msg(
                    "placement %d: border point %g, %g lies outside the photo of %g x %g",
                    k, (double)q.x, (double)q.y, w, h);
        }
    }
}
