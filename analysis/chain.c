/* SPDX-License-Identifier: Apache-2.0 */
/* Two pixels are linked if they are 4-neighbours, or diagonal neighbours without a common
 * 4-neighbour on the curve (mixed adjacency): so a corner has two links, not three.
 *
 *     # #        the corner's pixels a-b-c are linked a-b and b-c, not a-c
 *       #
 *
 * A pixel with two links is inside a chain; any other ends chains. Each link belongs to
 * exactly one chain. */
#include "analysis/chain.h"

#include "analysis/moments.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const int8_t tz_chain_dx[8] = {1, 1, 0, -1, -1, -1, 0, 1};
const int8_t tz_chain_dy[8] = {0, -1, -1, -1, 0, 1, 1, 1};

typedef struct links {
    int32_t width, height;
    uint8_t *mask; /* bit k: linked in direction k; cleared as chains use them up */
    uint8_t *kind; /* number of links */
    TZ_ARRAY(int64_t)
    pixel; /* those on curves, in raster order */
} links;

static bool is_on(const tz_edge_map *m, int32_t x, int32_t y)
{
    return x >= 0 && y >= 0 && x < m->width && y < m->height &&
           m->on[(int64_t)y * m->width + x];
}

/* Pixels of the map in raster order; once listed, they only become fewer. */
static tz_status list_pixels(const tz_edge_map *m, links *l)
{
    tz_status s = TZ_OK;
    if (l->pixel.n > 0) {
        int32_t kept = 0;
        for (int32_t i = 0; i < l->pixel.n; i++)
            if (m->on[l->pixel.v[i]])
                l->pixel.v[kept++] = l->pixel.v[i];
        l->pixel.n = kept;
        return s;
    }
    const uint8_t *end = m->on + (size_t)m->width * m->height;
    for (const uint8_t *p = m->on; s == TZ_OK; p++) {
        p = memchr(p, 1, (size_t)(end - p));
        if (!p)
            break;
        s = tz_array_push(m->ctx, &l->pixel, p - m->on);
    }
    return s;
}

static void find_links(const tz_edge_map *m, links *l)
{
    for (int32_t i = 0; i < l->pixel.n; i++) {
        const int64_t p = l->pixel.v[i];
        const int32_t x = (int32_t)(p % m->width), y = (int32_t)(p / m->width);
        uint8_t mask = 0, n = 0;
        for (int32_t k = 0; k < 8; k++) {
            const int32_t u = x + tz_chain_dx[k], v = y + tz_chain_dy[k];
            if (!is_on(m, u, v))
                continue;
            if ((k & 1) && (is_on(m, u, y) || is_on(m, x, v)))
                continue;
            mask |= (uint8_t)(1 << k);
            n++;
        }
        l->mask[p] = mask;
        l->kind[p] = n;
    }
}

/* Follows links from p, beginning in direction k, until a pixel that is not inside a
 * chain or, for a closed curve, p again. */
static tz_status trace(links *l, int64_t p, int32_t k, tz_ebpt *e)
{
    const int64_t w = l->width, start = p;
    tz_edge c;
    memset(&c, 0, sizeof c); /* padding too: edges are compared as bytes */
    c.x = (int32_t)(p % w), c.y = (int32_t)(p / w), c.code = e->code.n;
    tz_status s;
    for (;;) {
        if ((s = tz_array_push(e->ctx, &e->code, (uint8_t)k)) != TZ_OK)
            return s;
        l->mask[p] &= (uint8_t) ~(1 << k);
        p += tz_chain_dx[k] + tz_chain_dy[k] * w;
        l->mask[p] &= (uint8_t) ~(1 << (k ^ 4));
        if (l->kind[p] != 2 || p == start)
            break;
        k = __builtin_ctz(l->mask[p]);
    }
    c.length = e->code.n - c.code;
    return tz_array_push(e->ctx, &e->edge, c);
}

static tz_status trace_all(links *l, tz_ebpt *e)
{
    tz_status s;
    for (int32_t closed = 0; closed < 2; closed++) {
        for (int32_t i = 0; i < l->pixel.n; i++) {
            const int64_t p = l->pixel.v[i];
            if (!closed && l->kind[p] == 2)
                continue;
            while (l->mask[p]) {
                s = trace(l, p, __builtin_ctz(l->mask[p]), e);
                if (s != TZ_OK)
                    return s;
            }
        }
    }
    return TZ_OK;
}

static double chain_extent(const tz_ebpt *e, const tz_edge *c)
{
    int32_t odd = 0;
    for (int32_t i = 0; i < c->length; i++)
        odd += e->code.v[c->code + i] & 1;
    return (c->length - odd) + odd * sqrt(2.0);
}

/* Clears the chain's pixels but for those where other chains go on. */
static void erase(tz_edge_map *m, const links *l, const tz_ebpt *e, const tz_edge *c)
{
    int64_t p = (int64_t)c->y * m->width + c->x;
    for (int32_t i = 0; i <= c->length; i++) {
        if (l->kind[p] <= 2)
            m->on[p] = 0;
        if (i == c->length)
            break;
        const int32_t k = e->code.v[c->code + i];
        p += tz_chain_dx[k] + (int64_t)tz_chain_dy[k] * m->width;
    }
}

static int64_t last_pixel(const links *l, const tz_ebpt *e, const tz_edge *c)
{
    int64_t p = (int64_t)c->y * l->width + c->x;
    for (int32_t i = 0; i < c->length; i++) {
        const int32_t k = e->code.v[c->code + i];
        p += tz_chain_dx[k] + (int64_t)tz_chain_dy[k] * l->width;
    }
    return p;
}

typedef struct twig {
    int64_t branching;
    double extent;
    int32_t id;
} twig;

static int by_branching(const void *p, const void *q)
{
    const twig *a = p, *b = q;
    if (a->branching != b->branching)
        return a->branching < b->branching ? -1 : 1;
    if (a->extent != b->extent)
        return a->extent < b->extent ? -1 : 1;
    return a->id < b->id ? -1 : a->id > b->id;
}

/* Erases the shortest twigs of each branching, so that two chains are left to go through.
 */
static tz_status cut_twigs(tz_edge_map *m, const links *l, double min_length, tz_ebpt *e,
                           int32_t *cut)
{
    TZ_ARRAY(twig)
    twigs = {0};
    tz_status s = TZ_OK;
    *cut = 0;
    for (int32_t i = 0; i < e->edge.n; i++) {
        const tz_edge *c = &e->edge.v[i];
        const int64_t a = (int64_t)c->y * m->width + c->x, b = last_pixel(l, e, c);
        twig t = {
            .branching = l->kind[a] > 2 ? a : b, .extent = chain_extent(e, c), .id = i};
        if (t.extent >= min_length || (l->kind[a] != 1 && l->kind[b] != 1) ||
            l->kind[t.branching] <= 2)
            continue;
        if ((s = tz_array_push(e->ctx, &twigs, t)) != TZ_OK)
            goto done;
    }
    if (twigs.n > 0)
        qsort(twigs.v, (size_t)twigs.n, sizeof *twigs.v, by_branching);
    for (int32_t i = 0, here = 0; i < twigs.n; i++) {
        const twig *t = &twigs.v[i];
        here = i > 0 && t->branching == twigs.v[i - 1].branching ? here + 1 : 0;
        if (here >= l->kind[t->branching] - 2)
            continue;
        erase(m, l, e, &e->edge.v[t->id]);
        ++*cut;
    }
done:
    tz_array_free(e->ctx, &twigs);
    return s;
}

/* Keeps chains of min_length at least. */
static void drop_short(double min_length, tz_ebpt *e)
{
    int32_t kept = 0, codes = 0;
    for (int32_t i = 0; i < e->edge.n; i++) {
        tz_edge c = e->edge.v[i];
        if (chain_extent(e, &c) < min_length)
            continue;
        memmove(e->code.v + codes, e->code.v + c.code, (size_t)c.length);
        c.code = codes;
        codes += c.length;
        e->edge.v[kept++] = c;
    }
    e->edge.n = kept;
    e->code.n = codes;
}

tz_status tz_chain_link(tz_edge_map *m, double min_length, tz_ebpt *e)
{
    const size_t n = (size_t)m->width * m->height;
    links l = {.width = m->width, .height = m->height};
    int32_t cut = 1;
    tz_status s;

    if ((s = tz_alloc(m->ctx, &l.mask, n, 1)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(m->ctx, &l.kind, n, 1)) != TZ_OK)
        goto done;
    for (int32_t round = 0;; round++) {
        e->edge.n = e->code.n = 0;
        if ((s = list_pixels(m, &l)) != TZ_OK)
            goto done;
        find_links(m, &l);
        if ((s = trace_all(&l, e)) != TZ_OK)
            goto done;
        if (round == 2)
            break;
        if ((s = cut_twigs(m, &l, min_length, e, &cut)) != TZ_OK)
            goto done;
        if (cut == 0)
            break;
        if ((s = tz_edge_map_thin(m)) != TZ_OK)
            goto done;
    }
    drop_short(min_length, e);
done:
    tz_free(m->ctx, l.mask);
    tz_free(m->ctx, l.kind);
    tz_array_free(m->ctx, &l.pixel);
    return s;
}

/* ---- Eq. (1) --------------------------------------------------------------------- */

/* Distance from pixel p along +-normal to where the response falls under half of its
 * value on the edge; at most 8 px. */
static double half_width(const tz_edge_map *m, int32_t x, int32_t y, double nx, double ny)
{
    const float half = 0.5f * m->response[(int64_t)y * m->width + x];
    float before = 2 * half;
    for (int32_t i = 1; i <= 8; i++) {
        const int32_t u = x + (int32_t)lround(i * nx), v = y + (int32_t)lround(i * ny);
        if (u < 0 || v < 0 || u >= m->width || v >= m->height)
            return i - 0.5;
        const float r = m->response[(int64_t)v * m->width + u];
        if (r <= half)
            return i - (before > r ? (half - r) / (before - r) : 0.5f);
        if (r > 1.1f * before)
            return i - 1; /* a neighbour's flank */
        before = r;
    }
    return 8;
}

static double width_at(const tz_edge_map *m, int32_t x, int32_t y)
{
    const int64_t p = (int64_t)y * m->width + x;
    const double angle = 0.5 * atan2((double)m->normal[p + (int64_t)m->width * m->height],
                                     (double)m->normal[p]);
    const double nx = cos(angle), ny = sin(angle);
    return half_width(m, x, y, nx, ny) + half_width(m, x, y, -nx, -ny);
}

/* Direction at which the chain leaves through end 0 or 1, over its last 6 steps. */
static double tangent(const tz_ebpt *e, const tz_edge *c, int32_t end)
{
    int32_t dx = 0, dy = 0;
    for (int32_t i = 0; i < 6 && i < c->length; i++) {
        const int32_t k = e->code.v[c->code + (end ? c->length - 1 - i : i)];
        dx += tz_chain_dx[k];
        dy += tz_chain_dy[k];
    }
    return end ? atan2(dy, dx) : atan2(-dy, -dx);
}

void tz_chain_measure(const tz_edge_map *m, double full, tz_ebpt *e, int32_t i)
{
    tz_edge *c = &e->edge.v[i];
    double l = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, width = 0, strength = 0;
    int32_t x = c->x, y = c->y;

    /* line moments about the first pixel: each step adds length times its midpoint */
    for (int32_t k = 0;; k++) {
        strength += m->response[(int64_t)y * m->width + x];
        width += width_at(m, x, y);
        if (k == c->length)
            break;
        const int32_t code = e->code.v[c->code + k];
        const double step = code & 1 ? sqrt(2.0) : 1;
        const double u = x - c->x + 0.5 * tz_chain_dx[code];
        const double v = y - c->y + 0.5 * tz_chain_dy[code];
        l += step, sx += step * u, sy += step * v;
        sxx += step * u * u, sxy += step * u * v, syy += step * v * v;
        x += tz_chain_dx[code];
        y += tz_chain_dy[code];
    }
    c->extent = l;
    const double mx = l > 0 ? sx / l : 0, my = l > 0 ? sy / l : 0;
    c->centre = (tz_vec2){c->x + 0.5 + mx, c->y + 0.5 + my};
    c->angle = tz_axis_angle(sxx - l * mx * mx, sxy - l * mx * my, syy - l * my * my);
    c->width = width / (c->length + 1);
    c->strength = full > 0 ? fmin(1, strength / (c->length + 1) / full) : 0;
    c->end[0] = (tz_vec2){c->x + 0.5, c->y + 0.5};
    c->end[1] = (tz_vec2){x + 0.5, y + 0.5};
    c->end_angle[0] = tangent(e, c, 0);
    c->end_angle[1] = tangent(e, c, 1);
}
