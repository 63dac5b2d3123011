/* SPDX-License-Identifier: Apache-2.0 */
/* [Kim21] Sec. 4.2: assignment of edges by their centres, length x angle bins, Eq. (2),
 * the polar grid with its non-empty cells, ranking; then the groups as the edges of one
 * meta group. Lists are made by counting, in rising ids, so that they are the same
 * always. */
#include "analysis/groups.h"

#include <stdlib.h>
#include <string.h>

#include "analysis/moments.h"

typedef struct ranked {
    double value;
    int32_t id;
} ranked;

static int by_value(const void *p, const void *q)
{
    const ranked *a = p, *b = q;
    if (a->value != b->value)
        return a->value < b->value ? -1 : 1;
    return a->id < b->id ? -1 : a->id > b->id;
}

static int32_t clamp_bin(double share, int32_t n)
{
    const int32_t b = (int32_t)floor(share * n);
    return b < 0 ? 0 : b < n ? b : n - 1;
}

/* ---- bins ------------------------------------------------------------------------ */

typedef struct binned {
    double length, angle;
    int32_t length_bin, angle_bin;
} binned;

/* Uniform: equal ranges of 0..longest and 0..pi. Adaptive: by rank, so that the bins hold
 * the same number to within one: first over length, then over angle inside a length bin.
 */
static tz_status quantise(tz_ctx *ctx, const tz_ebpt_params *p, binned *b, int32_t n)
{
    ranked *order = NULL;
    double longest = 0;
    tz_status s = TZ_OK;

    if (p->binning == TZ_BINNING_UNIFORM) {
        for (int32_t i = 0; i < n; i++)
            longest = fmax(longest, b[i].length);
        for (int32_t i = 0; i < n; i++) {
            b[i].length_bin =
                longest > 0 ? clamp_bin(b[i].length / longest, p->length_bins) : 0;
            b[i].angle_bin = clamp_bin(b[i].angle / TZ_PI, p->angle_bins);
        }
        goto done;
    }
    if ((s = tz_alloc(ctx, &order, (size_t)n, sizeof *order)) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < n; i++)
        order[i] = (ranked){b[i].length, i};
    qsort(order, (size_t)n, sizeof *order, by_value);
    for (int32_t k = 0; k < p->length_bins; k++) {
        const int32_t from = (int32_t)((int64_t)n * k / p->length_bins);
        const int32_t m = (int32_t)((int64_t)n * (k + 1) / p->length_bins) - from;
        ranked *part = order + from;
        for (int32_t i = 0; i < m; i++) {
            b[part[i].id].length_bin = k;
            part[i].value = b[part[i].id].angle;
        }
        qsort(part, (size_t)m, sizeof *part, by_value);
        for (int32_t i = 0; i < m; i++)
            b[part[i].id].angle_bin = (int32_t)((int64_t)i * p->angle_bins / m);
    }
done:
    tz_free(ctx, order);
    return s;
}

static tz_status bin_edges(tz_ebpt *e)
{
    binned *b = NULL;
    tz_status s = tz_alloc(e->ctx, &b, (size_t)e->edge.n, sizeof *b);
    if (s != TZ_OK)
        goto done;
    for (int32_t i = 0; i < e->edge.n; i++)
        b[i] = (binned){.length = e->edge.v[i].extent, .angle = e->edge.v[i].angle};
    if ((s = quantise(e->ctx, &e->params, b, e->edge.n)) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < e->edge.n; i++) {
        e->edge.v[i].length_bin = b[i].length_bin;
        e->edge.v[i].angle_bin = b[i].angle_bin;
    }
done:
    tz_free(e->ctx, b);
    return s;
}

/* ---- regions --------------------------------------------------------------------- */

static tz_status measure_regions(tz_ebpt *e, int32_t count)
{
    tz_status s = tz_array_reserve(e->ctx, &e->group, count);
    if (s != TZ_OK)
        return s;
    memset(e->group.v, 0, (size_t)count * sizeof *e->group.v);
    e->group.n = count;
    for (int32_t i = 0; i < count; i++)
        e->group.v[i].box = (tz_rect){e->width, e->height, 0, 0};
    /* box.w, box.h hold the far corner until the end */
    for (int32_t y = 0; y < e->height; y++) {
        const int32_t *l = e->label + (int64_t)y * e->width;
        for (int32_t x = 0; x < e->width; x++) {
            tz_edge_group *g = &e->group.v[l[x]];
            g->area++;
            g->region_centre.x += x + 0.5;
            g->region_centre.y += y + 0.5;
            if (x < g->box.x)
                g->box.x = x;
            if (y < g->box.y)
                g->box.y = y;
            if (x >= g->box.w)
                g->box.w = x + 1;
            if (y >= g->box.h)
                g->box.h = y + 1;
        }
    }
    for (int32_t i = 0; i < count; i++) {
        tz_edge_group *g = &e->group.v[i];
        g->cut = g->box.x == 0 || g->box.y == 0 || g->box.w == e->width ||
                 g->box.h == e->height;
        g->box.w -= g->box.x;
        g->box.h -= g->box.y;
        g->region_centre = tz_vec2_scale(g->region_centre, 1.0 / g->area);
        g->size = sqrt(g->area / TZ_PI);
    }
    return TZ_OK;
}

static int by_number(const void *p, const void *q)
{
    const int64_t a = *(const int64_t *)p, b = *(const int64_t *)q;
    return a < b ? -1 : a > b;
}

typedef TZ_ARRAY(int64_t)
pair_list;

/* Sorts and drops doubles. */
static void settle(pair_list *l)
{
    int32_t kept = 0;
    if (l->n > 0)
        qsort(l->v, (size_t)l->n, sizeof *l->v, by_number);
    for (int32_t i = 0; i < l->n; i++)
        if (i == 0 || l->v[i] != l->v[i - 1])
            l->v[kept++] = l->v[i];
    l->n = kept;
}

static tz_status add_pair(tz_ctx *ctx, pair_list *l, int32_t a, int32_t b)
{
    if (a == b)
        return TZ_OK;
    const int64_t pair = a < b ? (int64_t)a << 32 | b : (int64_t)b << 32 | a;
    for (int32_t i = l->n - 1; i >= 0 && i >= l->n - 4; i--)
        if (l->v[i] == pair)
            return TZ_OK;
    if (l->n == l->cap && l->n > 4096)
        settle(l); /* few are new: keeps the list short */
    return tz_array_push(ctx, l, pair);
}

static tz_status find_neighbours(tz_ebpt *e)
{
    pair_list pairs = {0};
    const int32_t n = e->group.n, w = e->width;
    tz_status s = TZ_OK;

    for (int32_t y = 0; y < e->height; y++) {
        const int32_t *l = e->label + (int64_t)y * w;
        for (int32_t x = 0; x < w; x++) {
            if (x + 1 < w && l[x] != l[x + 1] &&
                (s = add_pair(e->ctx, &pairs, l[x], l[x + 1])) != TZ_OK)
                goto done;
            if (y + 1 < e->height && l[x] != l[x + w] &&
                (s = add_pair(e->ctx, &pairs, l[x], l[x + w])) != TZ_OK)
                goto done;
        }
    }
    settle(&pairs);
    if ((s = tz_array_reserve(e->ctx, &e->neighbour_first, (int64_t)n + 1)) != TZ_OK)
        goto done;
    if ((s = tz_array_reserve(e->ctx, &e->neighbour, 2 * (int64_t)pairs.n)) != TZ_OK)
        goto done;
    int32_t *first = e->neighbour_first.v;
    memset(first, 0, ((size_t)n + 1) * sizeof *first);
    e->neighbour_first.n = n + 1;
    e->neighbour.n = 2 * pairs.n;
    for (int32_t i = 0; i < pairs.n; i++) {
        first[(int32_t)(pairs.v[i] >> 32) + 1]++;
        first[(int32_t)pairs.v[i] + 1]++;
    }
    for (int32_t i = 0; i < n; i++)
        first[i + 1] += first[i];
    /* sorted pairs: smaller neighbours first, then the larger ones, both rising */
    for (int32_t pass = 0; pass < 2; pass++) {
        for (int32_t i = 0; i < pairs.n; i++) {
            const int32_t a = (int32_t)(pairs.v[i] >> 32), b = (int32_t)pairs.v[i];
            if (pass == 0)
                e->neighbour.v[first[b]++] = a;
            else
                e->neighbour.v[first[a]++] = b;
        }
    }
    for (int32_t i = n; i > 0; i--)
        first[i] = first[i - 1];
    first[0] = 0;
done:
    tz_array_free(e->ctx, &pairs);
    return s;
}

/* ---- groups ---------------------------------------------------------------------- */

static tz_status assign_edges(tz_ebpt *e)
{
    const int32_t n = e->group.n;
    tz_status s = tz_array_reserve(e->ctx, &e->group_edge, e->edge.n);
    if (s != TZ_OK)
        return s;
    e->group_edge.n = e->edge.n;
    for (int32_t i = 0; i < e->edge.n; i++) {
        tz_edge *d = &e->edge.v[i];
        int32_t x = (int32_t)floor(d->centre.x), y = (int32_t)floor(d->centre.y);
        x = x < 0 ? 0 : x < e->width ? x : e->width - 1;
        y = y < 0 ? 0 : y < e->height ? y : e->height - 1;
        d->group = e->label[(int64_t)y * e->width + x];
        e->group.v[d->group].edges++;
    }
    for (int32_t i = 0, at = 0; i < n; i++) {
        e->group.v[i].edge = at;
        at += e->group.v[i].edges;
        e->group.v[i].edges = 0;
    }
    for (int32_t i = 0; i < e->edge.n; i++) {
        tz_edge_group *g = &e->group.v[e->edge.v[i].group];
        e->group_edge.v[g->edge + g->edges++] = i;
    }
    return TZ_OK;
}

/* Centre, angle and reach of a set of points. */
static void encode_points(const tz_vec2 *c, int32_t n, tz_vec2 *centre, double *angle,
                          double *reach)
{
    double xx = 0, xy = 0, yy = 0;
    tz_vec2 m = {0, 0};
    for (int32_t i = 0; i < n; i++)
        m = tz_vec2_add(m, c[i]);
    m = tz_vec2_scale(m, 1.0 / n);
    *reach = 0;
    for (int32_t i = 0; i < n; i++) {
        const tz_vec2 d = tz_vec2_sub(c[i], m);
        xx += d.x * d.x, xy += d.x * d.y, yy += d.y * d.y;
        *reach = fmax(*reach, tz_vec2_length(d));
    }
    *centre = m;
    *angle = tz_axis_angle(xx, xy, yy);
}

static tz_status encode_cells(tz_ebpt *e, tz_edge_group *g, int64_t *key)
{
    const int32_t rings = e->params.polar_rings, sectors = e->params.polar_sectors;
    tz_status s;
    for (int32_t i = 0; i < g->edges; i++) {
        const int32_t id = e->group_edge.v[g->edge + i];
        const tz_vec2 d = tz_vec2_sub(e->edge.v[id].centre, g->centre);
        const double turn = atan2(d.y, d.x) / (2 * TZ_PI);
        const double r = g->reach > 0 ? tz_vec2_length(d) / g->reach : 0;
        const int64_t ring = clamp_bin(r, rings);
        const int64_t sector = clamp_bin(turn < 0 ? turn + 1 : turn, sectors);
        key[i] = (ring * sectors + sector) << 32 | id;
    }
    qsort(key, (size_t)g->edges, sizeof *key, by_number);
    g->cell = e->cell.n;
    for (int32_t i = 0; i < g->edges;) {
        const int64_t place = key[i] >> 32;
        tz_polar_cell c = {.ring = (int32_t)(place / sectors),
                           .sector = (int32_t)(place % sectors),
                           .first = e->cell_edge.n};
        for (; i < g->edges && key[i] >> 32 == place; i++) {
            s = tz_array_push(e->ctx, &e->cell_edge, (int32_t)key[i]);
            if (s != TZ_OK)
                return s;
        }
        c.count = e->cell_edge.n - c.first;
        c.share = (double)c.count / g->edges;
        if ((s = tz_array_push(e->ctx, &e->cell, c)) != TZ_OK)
            return s;
    }
    g->cells = e->cell.n - g->cell;
    return TZ_OK;
}

static tz_status encode_groups(tz_ebpt *e)
{
    tz_vec2 *c = NULL;
    int64_t *key = NULL;
    tz_status s;
    if ((s = tz_alloc(e->ctx, &c, (size_t)e->edge.n, sizeof *c)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(e->ctx, &key, (size_t)e->edge.n, sizeof *key)) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < e->group.n; i++) {
        tz_edge_group *g = &e->group.v[i];
        g->centre = g->region_centre;
        g->cell = e->cell.n;
        if (g->edges == 0)
            continue;
        for (int32_t k = 0; k < g->edges; k++)
            c[k] = e->edge.v[e->group_edge.v[g->edge + k]].centre;
        encode_points(c, g->edges, &g->centre, &g->angle, &g->reach);
        if ((s = encode_cells(e, g, key)) != TZ_OK)
            goto done;
    }
done:
    tz_free(e->ctx, c);
    tz_free(e->ctx, key);
    return s;
}

/* Rank by saliency, then the groups as the edges of the meta group. */
static tz_status encode_meta(tz_ebpt *e)
{
    const int32_t n = e->group.n;
    ranked *order = NULL;
    binned *b = NULL;
    tz_vec2 *c = NULL;
    tz_status s;

    if ((s = tz_alloc(e->ctx, &order, (size_t)n, sizeof *order)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(e->ctx, &b, (size_t)n, sizeof *b)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(e->ctx, &c, (size_t)n, sizeof *c)) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < n; i++) {
        const tz_edge_group *g = &e->group.v[i];
        double saliency = 0;
        for (int32_t k = 0; k < g->edges; k++) {
            const tz_edge *d = &e->edge.v[e->group_edge.v[g->edge + k]];
            saliency += d->extent * d->strength;
        }
        order[i] = (ranked){-saliency, i};
        b[i] = (binned){.length = g->size, .angle = g->angle};
        c[i] = g->centre;
    }
    qsort(order, (size_t)n, sizeof *order, by_value);
    for (int32_t i = 0; i < n; i++)
        e->group.v[order[i].id].rank = i;
    if ((s = quantise(e->ctx, &e->params, b, n)) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < n; i++) {
        e->group.v[i].length_bin = b[i].length_bin;
        e->group.v[i].angle_bin = b[i].angle_bin;
    }
    encode_points(c, n, &e->meta.centre, &e->meta.angle, &e->meta.reach);
done:
    tz_free(e->ctx, order);
    tz_free(e->ctx, b);
    tz_free(e->ctx, c);
    return s;
}

tz_status tz_groups_encode(tz_ebpt *e, int32_t count)
{
    tz_status s;
    if ((s = measure_regions(e, count)) != TZ_OK)
        return s;
    if ((s = bin_edges(e)) != TZ_OK)
        return s;
    if ((s = assign_edges(e)) != TZ_OK)
        return s;
    if ((s = encode_groups(e)) != TZ_OK)
        return s;
    if ((s = encode_meta(e)) != TZ_OK)
        return s;
    return find_neighbours(e);
}
