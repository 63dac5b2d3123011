/* SPDX-License-Identifier: Apache-2.0 */
/* What lies around a place of the output, and how well a neighbourhood of the exemplar
 * fits it.
 *
 * [Dav19] Sec. 4 pairs each seen element with the nearest free one of the exemplar's
 * neighbourhood, by a k-d tree. Here each unit has a small map of its surroundings whose
 * cells name the nearest neighbour, so that a pair costs one look-up:
 *
 *     +--------+      o  unit          cells of the map nearer to a than to
 *     |aaabbbbb|      a  neighbour 0   any other neighbour hold 0, ...
 *     |aaaobbbb|      b  neighbour 1
 *     +--------+
 *
 * Pairs farther apart than half the spacing are partial; so are pairs of unlike kinds. */
#include "elements/growth_internal.h"

/* What an unpaired element costs, in units of the squared limit: where the exemplar shows
 * that nothing is there, where it shows another kind, and where it ends. */
static const float cost_stranger = 1, cost_kind = 1.5F, cost_unknown = 0.2F;
/* A unit whose surroundings the exemplar's border cuts leads nowhere on that side. */
static const float cost_cut = 0.1F;
/* Axes at right angles, and radii of which one is thrice the other. */
static const float cost_axis = 0.5F, cost_size = 1;
/* Another symbol of the same kind; samples that lie about their centres quite otherwise. */
static const float cost_symbol = 0.25F, cost_shape = 0.5F;
enum { SAMPLES = 12, NONE = 255 }; /* compared of an element; entry of empty cells */

/* ---- what is seen ---------------------------------------------------------------- */

static void look_in(const tz_growth *g, int32_t cell, tz_vec2 from, float radius,
                    int32_t but, tz_growth_view *view)
{
    for (int32_t i = g->head[cell]; i >= 0; i = g->spot.v[i].next) {
        const tz_growth_spot *q = &g->spot.v[i];
        const float x = (float)(q->x - from.x), y = (float)(q->y - from.y);
        const float d = radius + q->r;
        if (x * x + y * y > d * d || view->n == TZ_GROWTH_SEEN ||
            (i == but && x == 0 && y == 0))
            continue;
        view->v[view->n++] =
            (tz_growth_seen){x,       y,         q->r,    q->c2,      q->s2, q->angle,
                             q->kind, q->symbol, q->hard, q->texture, i,     q->copy};
    }
}

static int32_t wrapped(int32_t c, int32_t n, int32_t *turns)
{
    int32_t t = c / n;
    if (c < 0 && t * n != c)
        t--;
    *turns = t;
    return c - t * n;
}

static int32_t clamped(double c, int32_t lo, int32_t hi)
{
    return c <= lo ? lo : c >= hi ? hi : (int32_t)floor(c);
}

/* Into the local frame, whose angle and scale are given. */
static void turn_in(tz_growth_view *view, double angle, double scale)
{
    view->c = (float)cos(angle), view->s = (float)sin(angle);
    view->scale = scale;
    const float c = (float)cos(2 * angle), s = (float)sin(2 * angle);
    for (int32_t i = 0; i < view->n; i++) {
        tz_growth_seen *o = &view->v[i];
        const float x = o->x, y = o->y, c2 = o->c2, s2 = o->s2;
        o->x = (view->c * x + view->s * y) / (float)scale;
        o->y = (view->c * y - view->s * x) / (float)scale;
        o->r /= (float)scale;
        o->c2 = c * c2 + s * s2, o->s2 = c * s2 - s * c2;
        o->angle -= (float)angle;
    }
}

void tz_growth_look(const tz_growth *g, double x, double y, double radius, int32_t but,
                    tz_growth_view *view)
{
    const bool torus = g->out->domain.torus;
    const int32_t turns = torus ? 3 : 0; /* copies seen of a domain narrower than that */
    const double scale = tz_domain_apart(&g->out->domain, (tz_vec3){x, y, 0});
    radius *= scale;
    const double wide = radius + g->most * g->radius;
    const int32_t lo_x = -turns * g->nx, hi_x = (turns + 1) * g->nx - 1;
    const int32_t lo_y = -turns * g->ny, hi_y = (turns + 1) * g->ny - 1;
    const int32_t x0 = clamped((x - wide) / g->cell_x, lo_x, hi_x);
    const int32_t x1 = clamped((x + wide) / g->cell_x, lo_x, hi_x);
    const int32_t y0 = clamped((y - wide) / g->cell_y, lo_y, hi_y);
    const int32_t y1 = clamped((y + wide) / g->cell_y, lo_y, hi_y);
    view->n = 0;
    for (int32_t cy = y0; cy <= y1; cy++) {
        int32_t ty, tx;
        const int32_t row = wrapped(cy, g->ny, &ty) * g->nx;
        for (int32_t cx = x0; cx <= x1; cx++) {
            const int32_t cell = row + wrapped(cx, g->nx, &tx);
            const tz_vec2 from = {x - tx * g->out->domain.size.x,
                                  y - ty * g->out->domain.size.y};
            look_in(g, cell, from, (float)radius, but, view);
        }
    }
    view->c = 1, view->s = 0, view->scale = 1;
    if (g->out->domain.frames)
        turn_in(view, tz_domain_frame(&g->out->domain, (tz_vec3){x, y, 0}), scale);
}

/* ---- how it fits ----------------------------------------------------------------- */

/* The map's entry at an offset; `scale` cells make a unit of length. */
static int32_t entry(const uint8_t *lut, float half, float scale, float x, float y)
{
    enum { N = TZ_GROWTH_LUT };
    const float i = (x + half) * scale, j = (y + half) * scale;
    if (!(i >= 0 && j >= 0 && i < N && j < N))
        return -1;
    const uint8_t at = lut[(size_t)(int)j * N + (size_t)(int)i];
    return at == NONE ? -1 : at;
}

static const uint8_t *map_of(const tz_growth_exemplar *ex, int32_t u)
{
    return ex->lut + (size_t)u * TZ_GROWTH_LUT * TZ_GROWTH_LUT;
}

int32_t tz_growth_at(const tz_growth_exemplar *ex, int32_t u, float x, float y)
{
    const float half = ex->unit[u].half;
    return entry(map_of(ex, u), half, TZ_GROWTH_LUT / (2 * half), x, y);
}

static bool is_known(const tz_growth_exemplar *ex, const tz_growth_unit *e,
                     const tz_growth_seen *o)
{
    const double x = e->x + o->x, y = e->y + o->y, rim = 0.1 * e->spacing;
    return ex->torus || (x > ex->lo.x - rim && y > ex->lo.y - rim && x < ex->hi.x + rim &&
                         y < ex->hi.y + rim);
}

/* How differently the samples of two units lie about their centres, 0..1: those of one id
 * are pairs, those without a partner are as far off as can be. */
static float unlike_shape(const tz_growth_exemplar *ex, int32_t a, int32_t b)
{
    const tz_element_set *set = ex->set;
    const int32_t sa = ex->unit[a].source, sb = ex->unit[b].source;
    if (sa < 0 || sb < 0)
        return 0;
    const tz_element *p = &set->element.v[sa], *q = &set->element.v[sb];
    const double r2 = fmax(p->radius, q->radius) * fmax(p->radius, q->radius);
    const int32_t n = p->samples < SAMPLES ? p->samples : SAMPLES;
    const int32_t m = q->samples < SAMPLES ? q->samples : SAMPLES;
    double sum = 0;
    int32_t pairs = 0;
    for (int32_t i = 0; i < n; i++) {
        const tz_sample *s = &set->sample.v[p->sample + i];
        for (int32_t j = 0; j < m; j++) {
            const tz_sample *t = &set->sample.v[q->sample + j];
            if (s->id != t->id)
                continue;
            const double x = s->at.x - p->at.x - (t->at.x - q->at.x);
            const double y = s->at.y - p->at.y - (t->at.y - q->at.y);
            sum += fmin(1, (x * x + y * y) / r2);
            pairs++;
            break;
        }
    }
    const int32_t all = n + m - pairs;
    return all > 0 ? (float)((sum + all - pairs) / all) : 0;
}

/* Attributes of a pair: [Dav19]'s omega, in units of the squared limit. */
static float attributes(const tz_growth_exemplar *ex, const tz_growth_seen *o,
                        const tz_growth_near *c)
{
    float cost = 0;
    if (o->c2 != c->c2 || o->s2 != c->s2) {
        const float axes =
            sqrtf((o->c2 * o->c2 + o->s2 * o->s2) * (c->c2 * c->c2 + c->s2 * c->s2));
        cost += 0.5F * cost_axis * (axes - o->c2 * c->c2 - o->s2 * c->s2);
    }
    if (o->r != c->r) {
        const float size = (o->r - c->r) / (o->r + c->r);
        cost += cost_size * size * size;
    }
    if (o->symbol != c->symbol && ex->symbols)
        cost += cost_symbol;
    if (o->copy >= 0 && o->copy != c->unit && ex->unit[c->unit].bent)
        cost += cost_shape * unlike_shape(ex, o->copy, c->unit);
    return cost;
}

float tz_growth_match(const tz_growth_exemplar *ex, int32_t u, const tz_growth_seen *v,
                      int32_t n, float enough, uint64_t *used, int8_t *pair)
{
    enum { N = TZ_GROWTH_LUT };
    const tz_growth_unit *e = &ex->unit[u];
    const tz_growth_near *near = ex->near.v + e->near;
    const uint8_t *lut = map_of(ex, u);
    const float half = e->half, scale = N / (2 * half), reach = e->reach, r = e->r;
    const float limit = 0.25F * e->spacing * e->spacing, part = 1 / limit;
    const float most = enough * (float)n;
    uint64_t taken = 0;
    float cost = 0;
    int32_t counted = 0;
    for (int32_t i = 0; i < n && cost <= most; i++) {
        const tz_growth_seen *o = &v[i];
        const float far = reach + (o->r > r ? o->r - r : 0);
        if (pair)
            pair[i] = -1;
        if (o->x * o->x + o->y * o->y > far * far || o->texture != ex->number)
            continue;
        counted++;
        const float cx = (o->x + half) * scale, cy = (o->y + half) * scale;
        const bool mapped = cx >= 0 && cy >= 0 && cx < N && cy < N;
        const uint8_t j = mapped ? lut[(size_t)((int32_t)cy * N + (int32_t)cx)] : NONE;
        if (j == NONE || (taken >> j & 1)) {
            cost += is_known(ex, e, o) ? cost_stranger : cost_unknown;
            continue;
        }
        const float dx = o->x - near[j].x, dy = o->y - near[j].y;
        const float d = dx * dx + dy * dy;
        if (d >= limit) {
            cost += is_known(ex, e, o) ? cost_stranger : cost_unknown;
        } else if (o->kind != near[j].kind) {
            cost += cost_kind;
        } else {
            cost += d * part + attributes(ex, o, &near[j]);
            taken |= (uint64_t)1 << j;
            if (pair)
                pair[i] = (int8_t)j;
        }
    }
    *used = taken;
    return cost > most ? INFINITY : counted ? cost / (float)counted : 0;
}

float tz_growth_cost(const tz_growth_exemplar *ex, int32_t u, const tz_growth_view *view,
                     float enough, uint64_t *used)
{
    return tz_growth_match(ex, u, view->v, view->n, enough, used, NULL) +
           (ex->unit[u].whole ? 0 : cost_cut);
}

int32_t tz_growth_nearest(const tz_growth_exemplar *ex, int32_t u,
                          const tz_growth_view *view)
{
    const tz_growth_unit *e = &ex->unit[u];
    uint64_t used;
    int32_t best = u;
    float least = tz_growth_cost(ex, u, view, INFINITY, &used);
    for (int32_t k = 0; k < e->coherents; k++) {
        const float c = tz_growth_cost(ex, e->coherent[k], view, least, &used);
        if (c < least)
            least = c, best = e->coherent[k];
    }
    return best;
}

/* ---- what keeps apart ------------------------------------------------------------ */

float tz_growth_bound(const tz_growth_exemplar *ex, const tz_growth_body *b,
                      const tz_growth_seen *o)
{
    const bool known = b->hard >= 0 && o->hard >= 0 && o->texture == ex->number;
    const float share =
        known ? ex->bound[b->hard * ex->hards + o->hard] : (float)ex->overlap;
    return share * (b->r + o->r);
}

float tz_growth_extent(const tz_growth_exemplar *ex, const tz_growth_body *b,
                       float direction)
{
    enum { N = TZ_EXTENT_DIRECTIONS };
    if (b->symbol < 0 || b->symbol >= ex->extents->n)
        return b->r;
    const float *ray = ex->extents->v[b->symbol].r;
    const float at = (direction - b->angle) * (float)(N / (2 * TZ_PI));
    const float low = floorf(at), t = at - low;
    const int32_t i = (int32_t)low & (N - 1);
    return b->r * (ray[i] * (1 - t) + ray[(i + 1) & (N - 1)] * t);
}

float tz_growth_apart(const tz_growth_exemplar *ex, const tz_growth_body *b, float x,
                      float y, const tz_growth_seen *o)
{
    const tz_growth_body other = {o->r, o->angle, o->hard, o->symbol};
    const bool known = b->hard >= 0 && o->hard >= 0 && o->texture == ex->number;
    const int32_t pair = known ? b->hard * ex->hards + o->hard : 0;
    const float limit = known ? ex->limit[pair] * (b->r + o->r) : 0;
    const float to = atan2f(y, x);
    const float touch =
        tz_growth_extent(ex, b, to) + tz_growth_extent(ex, &other, to + (float)TZ_PI);
    return fmaxf(limit, (known ? ex->touch[pair] : (float)ex->overlap) * touch);
}
