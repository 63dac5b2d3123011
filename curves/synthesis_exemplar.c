/* SPDX-License-Identifier: Apache-2.0 */
/* The exemplar as one level sees it. Ends at its border are no ends of the pattern: what
 * was cut there goes on. They lend their place to matches, but are no matches themselves
 * and have no say in how many edges a sample gets.
 *
 * The look-up is a raster of a quarter of the spacing, filled by handing each cell's
 * nearest sample on to its neighbours twice over (Danielsson's distance transform): off
 * by less than a cell. */
#include <stdlib.h>
#include <string.h>

#include "curves/synthesis_internal.h"

enum { MOST_CELLS = 1 << 22 };
#define AT_BORDER 0.02 /* of the spacing: how near to the border an end is cut by it */

/* ---- look-up ----------------------------------------------------------------------- */

static tz_vec2 centre_of(const tz_curve_lookup *l, int32_t x, int32_t y)
{
    return (tz_vec2){l->origin.x + (x + 0.5) * l->cell,
                     l->origin.y + (y + 0.5) * l->cell};
}

static double distance2(tz_vec2 p, tz_vec2 q)
{
    return (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y);
}

/* Takes over the sample of the cell at dx, dy if it is nearer. */
static void take(tz_curve_lookup *l, const tz_sample_graph *g, int32_t x, int32_t y,
                 int32_t dx, int32_t dy)
{
    if (x + dx < 0 || y + dy < 0 || x + dx >= l->nx || y + dy >= l->ny)
        return;
    int32_t *mine = &l->id[y * l->nx + x];
    const int32_t other = l->id[(y + dy) * l->nx + x + dx];
    const tz_vec2 c = centre_of(l, x, y);
    if (other >= 0 && (*mine < 0 || distance2(g->sample.v[other].at, c) <
                                        distance2(g->sample.v[*mine].at, c)))
        *mine = other;
}

static void spread(tz_curve_lookup *l, const tz_sample_graph *g)
{
    for (int32_t y = 0; y < l->ny; y++) {
        for (int32_t x = 0; x < l->nx; x++)
            for (int k = -1; k <= 1; k++) {
                take(l, g, x, y, k, -1);
                take(l, g, x, y, -1, 0);
            }
        for (int32_t x = l->nx - 1; x >= 0; x--)
            take(l, g, x, y, 1, 0);
    }
    for (int32_t y = l->ny - 1; y >= 0; y--) {
        for (int32_t x = l->nx - 1; x >= 0; x--)
            for (int k = -1; k <= 1; k++) {
                take(l, g, x, y, k, 1);
                take(l, g, x, y, 1, 0);
            }
        for (int32_t x = 0; x < l->nx; x++)
            take(l, g, x, y, -1, 0);
    }
}

static tz_status make_lookup(tz_curve_model *m)
{
    const tz_sample_graph *g = &m->g;
    tz_curve_lookup *l = &m->look;
    tz_vec2 lo = {INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY};
    for (int32_t i = 0; i < g->sample.n; i++) {
        const tz_vec2 p = g->sample.v[i].at;
        lo = (tz_vec2){fmin(lo.x, p.x), fmin(lo.y, p.y)};
        hi = (tz_vec2){fmax(hi.x, p.x), fmax(hi.y, p.y)};
    }
    const double wide = hi.x - lo.x, high = hi.y - lo.y;
    l->cell = fmax(g->spacing / 4, fmax(wide, high) / 4000);
    while ((wide / l->cell + 1) * (high / l->cell + 1) > MOST_CELLS)
        l->cell *= 1.5;
    l->origin = lo;
    l->nx = (int32_t)(wide / l->cell) + 1;
    l->ny = (int32_t)(high / l->cell) + 1;
    const size_t n = (size_t)l->nx * (size_t)l->ny;
    const tz_status s = tz_alloc(m->ctx, &l->id, n, sizeof *l->id);
    if (s != TZ_OK)
        return s;
    memset(l->id, 255, n * sizeof *l->id);
    for (int32_t i = 0; i < g->sample.n; i++) {
        const tz_vec2 p = g->sample.v[i].at;
        const int32_t x = (int32_t)((p.x - lo.x) / l->cell),
                      y = (int32_t)((p.y - lo.y) / l->cell);
        int32_t *id =
            &l->id[(y < l->ny ? y : l->ny - 1) * l->nx + (x < l->nx ? x : l->nx - 1)];
        const tz_vec2 c = centre_of(l, x, y);
        if (g->sample.v[i].q == TZ_SAMPLE_CURVE && !m->cut[i] &&
            (*id < 0 || distance2(p, c) < distance2(g->sample.v[*id].at, c)))
            *id = i;
    }
    spread(l, g);
    return TZ_OK;
}

/* ---- samples of elements ----------------------------------------------------------- */

static int32_t first_of(const tz_curve_model *m, int32_t q)
{
    int32_t lo = 0, hi = m->by_q.n;
    while (lo < hi) {
        const int32_t mid = lo + (hi - lo) / 2;
        if (m->g.sample.v[m->by_q.v[mid]].q < q)
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo;
}

typedef struct keyed {
    int32_t q, id;
} keyed;

static int by_q_then_id(const void *a, const void *b)
{
    const keyed *p = a, *r = b;
    if (p->q != r->q)
        return p->q < r->q ? -1 : 1;
    return (p->id > r->id) - (p->id < r->id);
}

static tz_status sort_by_q(tz_curve_model *m)
{
    const int32_t n = m->g.sample.n;
    keyed *list = NULL;
    int32_t count = 0;
    tz_status s = tz_alloc(m->ctx, &list, (size_t)n, sizeof *list);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        if (!m->cut[i])
            list[count++] = (keyed){m->g.sample.v[i].q, i};
    if (s == TZ_OK && count > 1)
        qsort(list, (size_t)count, sizeof *list, by_q_then_id);
    for (int32_t i = 0; i < count && s == TZ_OK; i++)
        s = tz_array_push(m->ctx, &m->by_q, list[i].id);
    tz_free(m->ctx, list);
    return s;
}

/* ---- the model --------------------------------------------------------------------- */

bool tz_curve_model_knows(const tz_curve_model *m, tz_vec2 at)
{
    return tz_domain_depth(&m->g.domain, (tz_vec3){at.x, at.y, 0}) > 0;
}

int32_t tz_curve_model_nearest(const tz_curve_model *m, tz_vec2 at, int32_t q)
{
    at = tz_curve_wrapped(&m->g.domain, at);
    if (q == TZ_SAMPLE_CURVE) {
        const tz_curve_lookup *l = &m->look;
        const double x = (at.x - l->origin.x) / l->cell,
                     y = (at.y - l->origin.y) / l->cell;
        const int32_t cx = (int32_t)fmin(fmax(x, 0), l->nx - 1),
                      cy = (int32_t)fmin(fmax(y, 0), l->ny - 1);
        return l->id[cy * l->nx + cx];
    }
    double best = INFINITY;
    int32_t found = -1;
    for (int32_t k = first_of(m, q); k < m->by_q.n && m->g.sample.v[m->by_q.v[k]].q == q;
         k++) {
        const tz_vec2 v =
            tz_curve_vector(&m->g.domain, at, m->g.sample.v[m->by_q.v[k]].at);
        if (tz_vec2_dot(v, v) < best) {
            best = tz_vec2_dot(v, v);
            found = m->by_q.v[k];
        }
    }
    return found;
}

int32_t tz_curve_model_any(const tz_curve_model *m, int32_t q, tz_rng *r)
{
    const int32_t a = first_of(m, q), b = first_of(m, q + 1);
    return b > a ? m->by_q.v[a + tz_rng_below(r, b - a)] : -1;
}

/* All ends would be cut where a drawing is nothing but lines from border to border that
 * are shorter than a spacing: then they have to do. */
static void find_cuts(tz_curve_model *m)
{
    const double reach = AT_BORDER * m->g.spacing;
    int32_t left = 0;
    for (int32_t i = 0; i < m->g.sample.n; i++) {
        const tz_curve_sample *p = &m->g.sample.v[i];
        m->cut[i] = p->q == TZ_SAMPLE_CURVE && p->links <= 1 &&
                    tz_domain_depth(&m->g.domain, (tz_vec3){p->at.x, p->at.y, 0}) < reach;
        left += !m->cut[i];
    }
    if (left == 0)
        memset(m->cut, 0, (size_t)m->g.sample.n * sizeof *m->cut);
}

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static tz_status find_apart(tz_curve_model *m)
{
    tz_match_hoods h = {0};
    float *d = NULL;
    int32_t n = 0;
    tz_status s = tz_match_hoods_make(m->ctx, &m->g, m->g.spacing, &h);
    if (s == TZ_OK)
        s = tz_alloc(m->ctx, &d, (size_t)h.n, sizeof *d);
    for (int32_t i = 0; i < h.n && s == TZ_OK; i++) {
        const int32_t k = h.first[i];
        if (m->g.sample.v[i].q == TZ_SAMPLE_CURVE && k < h.first[i + 1])
            d[n++] = hypotf(h.x[k], h.y[k]);
    }
    if (n > 1)
        qsort(d, (size_t)n, sizeof *d, by_value);
    m->apart = n > 0 ? (double)d[n / 10] : m->g.spacing;
    tz_match_hoods_deinit(&h);
    tz_free(m->ctx, d);
    return s;
}

void tz_curve_model_deinit(tz_curve_model *m)
{
    tz_sample_graph_deinit(&m->g);
    tz_free(m->ctx, m->cut);
    tz_free(m->ctx, m->look.id);
    tz_array_free(m->ctx, &m->by_q);
    memset(m, 0, sizeof *m);
}

tz_status tz_curve_model_init(tz_ctx *ctx, const tz_curve_set *exemplar, double spacing,
                              double radius, tz_curve_model *m)
{
    *m = (tz_curve_model){.ctx = ctx};
    tz_status s = tz_sample_graph_make(ctx, exemplar, spacing, radius, &m->g);
    if (s == TZ_OK && m->g.sample.n == 0)
        s = tz_fail(ctx, TZ_INVALID, "the exemplar has no lines that could be sampled");
    if (s == TZ_OK)
        s = tz_alloc(ctx, &m->cut, (size_t)m->g.sample.n, sizeof *m->cut);
    if (s == TZ_OK) {
        find_cuts(m);
        s = sort_by_q(m);
    }
    if (s == TZ_OK)
        s = find_apart(m);
    if (s == TZ_OK)
        s = make_lookup(m);
    if (s != TZ_OK)
        tz_curve_model_deinit(m);
    return s;
}
