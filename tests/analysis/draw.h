/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pictures that the tests of analysis/ draw, and the check that an EBPT is sound. */
#ifndef TZ_TESTS_ANALYSIS_DRAW_H
#define TZ_TESTS_ANALYSIS_DRAW_H

#include "tests/base/check.h"

#include "analysis/chain.h"
#include "analysis/ebpt.h"
#include "base/rng.h"

static inline tz_image new_picture(tz_ctx *ctx, int32_t w, int32_t h, int32_t channels)
{
    tz_image im;
    ok(ctx, tz_image_init(ctx, &im, w, h, channels));
    im.encoding = TZ_ENCODING_SRGB;
    for (int64_t i = 0; i < (int64_t)w * h * channels; i++)
        im.px[i] = 1;
    return im;
}

static inline void set_pixel(tz_image *im, int32_t x, int32_t y, float v)
{
    for (int32_t c = 0; c < im->channels; c++)
        if (c != im->alpha)
            tz_image_at(im, x, y)[c] = v;
}

/* Uniform noise. */
static inline void draw_noise(tz_image *im, uint64_t seed)
{
    tz_rng r = tz_rng_make(seed, 1);
    for (int64_t i = 0; i < (int64_t)im->width * im->height * im->channels; i++)
        im->px[i] = (float)tz_rng_unit(&r);
}

/* Discs of random grey on a dark ground, `step` px apart. */
static inline void draw_pebbles(tz_image *im, int32_t step, uint64_t seed)
{
    for (int32_t y = 0; y < im->height; y++) {
        for (int32_t x = 0; x < im->width; x++) {
            const int32_t i = x / step, j = y / step;
            tz_rng r = tz_rng_make(seed, tz_rng_stream(1, (uint64_t)i, (uint64_t)j));
            const double grey = tz_rng_range(&r, 0.5, 0.9);
            const double dx = x + 0.5 - (i + 0.5) * step, dy = y + 0.5 - (j + 0.5) * step;
            const double edge = 0.42 * step - sqrt(dx * dx + dy * dy);
            const double share = edge > 0.5 ? 1 : edge < -0.5 ? 0 : edge + 0.5;
            set_pixel(im, x, y, (float)(0.1 + share * (grey - 0.1)));
        }
    }
}

static inline tz_ebpt_params default_params(void)
{
    tz_ebpt_params p;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_ebpt_param_table, &p);
    return p;
}

/* Photo of the collection beside the repository; skips the test if it is not there. */
#define PHOTO(name) TZ_SOURCE_DIR "/../shared/exemplars/photos/" name

static inline void need_photos(void)
{
    if (access(PHOTO("stone_wall.jpg"), R_OK)) {
        print_message("         no exemplar photos beside the repository: skipped\n");
        skip();
    }
}

/* Number of 4-connected pieces of the label map. */
static inline int32_t count_pieces(const int32_t *label, int32_t w, int32_t h)
{
    const int64_t n = (int64_t)w * h;
    int64_t *queue = malloc((size_t)n * sizeof *queue);
    uint8_t *seen = n > 0 ? calloc((size_t)n, 1) : NULL;
    int32_t pieces = 0;
    for (int64_t first = 0; first < n; first++) {
        int64_t end = 0;
        if (seen[first])
            continue;
        pieces++;
        seen[first] = 1;
        queue[end++] = first;
        for (int64_t i = 0; i < end; i++) {
            const int64_t p = queue[i], x = p % w, y = p / w;
            const int64_t next[4] = {x > 0 ? p - 1 : p, x < w - 1 ? p + 1 : p,
                                     y > 0 ? p - w : p, y < h - 1 ? p + w : p};
            for (int32_t k = 0; k < 4; k++) {
                if (seen[next[k]] || label[next[k]] != label[p])
                    continue;
                seen[next[k]] = 1;
                queue[end++] = next[k];
            }
        }
    }
    free(queue);
    free(seen);
    return pieces;
}

static inline void check_edge(const tz_ebpt *e, int32_t id)
{
    const tz_edge *d = &e->edge.v[id];
    int32_t x = d->x, y = d->y, odd = 0;
    assert_in_range(d->group, 0, e->group.n - 1);
    assert_in_range(d->length_bin, 0, e->params.length_bins - 1);
    assert_in_range(d->angle_bin, 0, e->params.angle_bins - 1);
    assert_true(d->length >= 1 && d->code >= 0 && d->code + d->length <= e->code.n);
    for (int32_t k = 0; k < d->length; k++) {
        const int32_t code = e->code.v[d->code + k];
        assert_in_range(code, 0, 7);
        x += tz_chain_dx[code], y += tz_chain_dy[code], odd += code & 1;
        assert_true(x >= 0 && y >= 0 && x < e->width && y < e->height);
    }
    assert_float_equal(d->extent, d->length - odd + odd * sqrt(2), 1e-9);
    assert_true(d->extent >= e->params.min_length);
    assert_true(d->angle >= 0 && d->angle < TZ_PI);
    assert_true(d->strength > 0 && d->strength <= 1 && d->width > 0 && d->width <= 16);
    assert_true(d->end[1].x == x + 0.5 && d->end[1].y == y + 0.5);
    for (int32_t k = 0; k < 2; k++)
        assert_true(d->end_angle[k] > -TZ_PI - 1e-12 && d->end_angle[k] <= TZ_PI);
    const int32_t cx = (int32_t)d->centre.x, cy = (int32_t)d->centre.y;
    assert_int_equal(e->label[(int64_t)cy * e->width + cx], d->group);
}

static inline void check_group(const tz_ebpt *e, int32_t id)
{
    const tz_edge_group *g = &e->group.v[id];
    tz_vec2 c = {0, 0};
    double share = 0;
    assert_true(g->area > 0 && g->edges >= 0 && g->reach >= 0);
    assert_in_range(g->rank, 0, e->group.n - 1);
    assert_true(isfinite(g->centre.x) && isfinite(g->centre.y) && g->angle >= 0);
    for (int32_t i = 0; i < g->edges; i++) {
        const int32_t k = e->group_edge.v[g->edge + i];
        assert_int_equal(e->edge.v[k].group, id);
        c = tz_vec2_add(c, e->edge.v[k].centre);
    }
    if (g->edges > 0) { /* Eq. (2) */
        assert_float_equal(g->centre.x, c.x / g->edges, 1e-9);
        assert_float_equal(g->centre.y, c.y / g->edges, 1e-9);
    }
    int32_t members = 0;
    for (int32_t i = 0; i < g->cells; i++) {
        const tz_polar_cell *p = &e->cell.v[g->cell + i];
        assert_in_range(p->ring, 0, e->params.polar_rings - 1);
        assert_in_range(p->sector, 0, e->params.polar_sectors - 1);
        assert_true(p->count > 0);
        share += p->share;
        members += p->count;
    }
    assert_int_equal(members, g->edges);
    if (g->edges > 0)
        assert_float_equal(share, 1, 1e-9);
    for (int32_t i = e->neighbour_first.v[id]; i < e->neighbour_first.v[id + 1]; i++) {
        const int32_t k = e->neighbour.v[i];
        bool mutual = false;
        assert_true(k != id);
        for (int32_t j = e->neighbour_first.v[k]; j < e->neighbour_first.v[k + 1]; j++)
            mutual = mutual || e->neighbour.v[j] == id;
        assert_true(mutual);
    }
}

/* Everything that holds for any EBPT. */
static inline void check_ebpt(const tz_ebpt *e)
{
    const int64_t n = (int64_t)e->width * e->height;
    int64_t area = 0;
    assert_true(e->group.n > 0 && e->scale > 0);
    for (int64_t p = 0; p < n; p++)
        assert_true(e->label[p] >= 0 && e->label[p] < e->group.n);
    assert_int_equal(count_pieces(e->label, e->width, e->height), e->group.n);
    for (int32_t i = 0; i < e->edge.n; i++)
        check_edge(e, i);
    for (int32_t i = 0; i < e->group.n; i++) {
        check_group(e, i);
        area += e->group.v[i].area;
    }
    assert_int_equal(area, n);
    assert_int_equal(e->group_edge.n, e->edge.n);
    assert_int_equal(e->cell_edge.n, e->edge.n);
    assert_int_equal(e->neighbour_first.n, e->group.n + 1);
}

#define SAME_ARRAY(a, b)                                                      \
    do {                                                                      \
        assert_int_equal((a).n, (b).n);                                       \
        if ((a).n > 0)                                                        \
            assert_memory_equal((a).v, (b).v, (size_t)(a).n * sizeof *(a).v); \
    } while (0)

/* Fields from one member to the end of another: padding may differ. */
#define SAME_FIELDS(a, b, T, from, to)                         \
    assert_memory_equal((const char *)(a) + offsetof(T, from), \
                        (const char *)(b) + offsetof(T, from), \
                        offsetof(T, to) + sizeof(a)->to - offsetof(T, from))

/* Bit for bit, contexts and spare room aside. */
static inline void check_same(const tz_ebpt *a, const tz_ebpt *b)
{
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_memory_equal(&a->params, &b->params, sizeof a->params);
    assert_memory_equal(&a->scale, &b->scale, sizeof a->scale);
    assert_memory_equal(a->label, b->label,
                        (size_t)a->width * a->height * sizeof *a->label);
    SAME_ARRAY(a->code, b->code);
    assert_int_equal(a->edge.n, b->edge.n);
    for (int32_t i = 0; i < a->edge.n; i++) {
        const tz_edge *p = &a->edge.v[i], *q = &b->edge.v[i];
        SAME_FIELDS(p, q, tz_edge, x, angle_bin);
        SAME_FIELDS(p, q, tz_edge, extent, end_angle);
    }
    assert_int_equal(a->group.n, b->group.n);
    for (int32_t i = 0; i < a->group.n; i++) {
        const tz_edge_group *p = &a->group.v[i], *q = &b->group.v[i];
        SAME_FIELDS(p, q, tz_edge_group, centre, cut);
    }
    SAME_ARRAY(a->group_edge, b->group_edge);
    SAME_ARRAY(a->cell, b->cell);
    SAME_ARRAY(a->cell_edge, b->cell_edge);
    SAME_ARRAY(a->neighbour_first, b->neighbour_first);
    SAME_ARRAY(a->neighbour, b->neighbour);
    assert_memory_equal(&a->meta, &b->meta, sizeof a->meta);
}

#endif
