/* SPDX-License-Identifier: Apache-2.0 */
/* How like the neighbourhood of an element is to that of an example, over all turns that
 * bring a near neighbour of the one onto one of the other. Both ways: what the example
 * has and the element lacks counts as much as the reverse. Neighbours that would lie
 * beyond the border of a plain domain do not count. Where two turns fit alike, none, or
 * that of the elements themselves, is meant. */
#include <stdlib.h>
#include <string.h>

#include "elements/propagate_internal.h"

enum { MOST = 24, TURNS = 32 };
#define PREFER 0.02 /* spacings that a turn must fit better than none */

typedef struct job {
    tz_propagation *g;
    tz_vec3 *at;
    tz_cells cells;
} job;

/* Neighbours as they lie; `wanted` of them within the radius, the rest a little beyond. */
typedef struct ring {
    int32_t n, wanted;
    tz_nearby v[MOST];
} ring;

static void look(const job *w, int32_t i, ring *r)
{
    const tz_propagation *g = w->g;
    r->n = tz_cells_near(&w->cells, w->at, w->at[i], 1.3 * g->radius, i, r->v, MOST);
    r->wanted = 0;
    while (r->wanted < r->n && (double)r->v[r->wanted].dist2 <= g->radius * g->radius)
        r->wanted++;
}

static void fill_side(const tz_propagation *g, const ring *r, int32_t n, double turn,
                      tz_pairing_side *s)
{
    const double c = cos(turn), d = sin(turn);
    s->n = n;
    for (int32_t k = 0; k < n; k++) {
        const tz_element *e = &g->before->element.v[r->v[k].id];
        const bool oriented = g->before->kind.v[e->kind].oriented;
        const double x = (double)r->v[k].x, y = (double)r->v[k].y;
        const double angle = oriented ? e->angle + turn : 0;
        s->x[k] = (float)(c * x - d * y), s->y[k] = (float)(d * x + c * y);
        s->a[k] = (float)(e->radius * cos(angle));
        s->b[k] = (float)(e->radius * sin(angle));
        s->l[k] = (float)e->kind;
    }
    tz_pairing_sort(s, NULL);
}

/* Cost a neighbour of wanted, seen from `at`; INFINITY if the border hides too much. */
static double one_way(const job *w, tz_pairing *pairing, const tz_pairing_side *wanted,
                      const tz_pairing_side *have, tz_vec3 at, double back)
{
    const tz_domain *d = &w->g->before->domain;
    const double c = cos(back), s = sin(back);
    float weight[MOST];
    double seen = 0;
    for (int32_t k = 0; k < wanted->n; k++) {
        const double x = (double)wanted->x[k], y = (double)wanted->y[k];
        const tz_vec3 p = {at.x + c * x - s * y, at.y + s * x + c * y, at.z};
        weight[k] = tz_domain_contains(d, p) ? 1 : 0;
        seen += (double)weight[k];
    }
    if (2 * seen < wanted->n || seen < 1)
        return wanted->n == 0 ? 0 : INFINITY;
    pairing->weight = weight;
    return (double)tz_pairing_best(pairing, wanted, have, INFINITY) / seen;
}

/* Distance of ring b, turned by -turn, from ring a, in spacings. */
static double distance(const job *w, int32_t ia, const ring *a, int32_t ib, const ring *b,
                       double turn)
{
    const tz_propagation *g = w->g;
    tz_pairing pairing = {.attributes = true, .limit = (float)(g->spacing * g->spacing)};
    tz_pairing_side p, q;
    fill_side(g, a, a->wanted, 0, &p);
    fill_side(g, b, b->n, -turn, &q);
    const double there = one_way(w, &pairing, &p, &q, w->at[ib], turn);
    fill_side(g, b, b->wanted, -turn, &q);
    fill_side(g, a, a->n, 0, &p);
    const double back = one_way(w, &pairing, &q, &p, w->at[ia], 0);
    return sqrt(0.5 * (there + back)) / g->spacing;
}

/* Turns worth trying; the first `free` of them need not fit better. */
static int32_t list_turns(const tz_propagation *g, int32_t ia, const ring *a, int32_t ib,
                          const ring *b, double *turn, int32_t *preferred)
{
    const tz_element *e = &g->before->element.v[ia], *f = &g->before->element.v[ib];
    int32_t n = 0;
    if (g->before->kind.v[e->kind].oriented && g->p.turned)
        turn[n++] = remainder(f->angle - e->angle, 2 * TZ_PI);
    else
        turn[n++] = 0;
    *preferred = n;
    for (int32_t i = 0; g->p.turned && i < a->wanted && i < 2; i++)
        for (int32_t j = 0; j < b->n && n < TURNS; j++) {
            const double ratio = sqrt((double)b->v[j].dist2 / (double)a->v[i].dist2);
            if (g->before->element.v[a->v[i].id].kind ==
                    g->before->element.v[b->v[j].id].kind &&
                ratio > 0.75 && ratio < 1.33)
                turn[n++] = remainder(atan2((double)b->v[j].y, (double)b->v[j].x) -
                                          atan2((double)a->v[i].y, (double)a->v[i].x),
                                      2 * TZ_PI);
        }
    return n;
}

static tz_likeness compare(const job *w, int32_t ia, const ring *a, int32_t ib)
{
    double turn[TURNS];
    int32_t preferred;
    ring b;
    tz_likeness best = {INFINITY, 0};
    look(w, ib, &b);
    const int32_t n = list_turns(w->g, ia, a, ib, &b, turn, &preferred);
    double least = INFINITY;
    for (int32_t k = 0; k < n; k++) {
        const double d = distance(w, ia, a, ib, &b, turn[k]);
        const double rank = k < preferred ? d : d + PREFER;
        if (rank < least) {
            least = rank;
            best = (tz_likeness){(float)d, (float)turn[k]};
        }
    }
    return best;
}

static tz_status compare_one(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx, (void)worker;
    job *w = arg;
    tz_propagation *g = w->g;
    const int32_t n = g->example.n;
    for (int32_t k = 0; k < n; k++) {
        const int32_t of = g->example.v[k].before;
        tz_likeness *out = &g->likeness[i * n + k];
        ring a;
        *out = (tz_likeness){INFINITY, 0};
        if (g->before->element.v[i].kind != g->before->element.v[of].kind || i == of)
            continue;
        look(w, of, &a);
        *out = compare(w, of, &a, (int32_t)i);
    }
    return TZ_OK;
}

/* ---- limits ---------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const float p = *(const float *)a, q = *(const float *)b;
    return (p > q) - (p < q);
}

/* The widest gap between the differences that occur, from 0 up to FAR. */
static double gap_of(float *d, int32_t n)
{
    const double far = 0.45, wide = 0.08, plain = 0.2;
    double best = wide, limit = plain, last = 0;
    qsort(d, (size_t)n, sizeof *d, by_value);
    for (int32_t k = 0; k <= n && last < far; k++) {
        const double next = k < n ? fmin((double)d[k], far) : far;
        if (next - last > best && last < 0.3) {
            best = next - last;
            limit = last + 0.5 * best;
        }
        last = next;
    }
    return limit;
}

static tz_status find_limits(tz_propagation *g)
{
    const int32_t n = g->before->element.n, m = g->example.n;
    float *d = NULL;
    tz_status s = tz_alloc(g->ctx, &d, (size_t)n, sizeof *d);
    for (int32_t k = 0; k < m && s == TZ_OK; k++) {
        int32_t count = 0;
        for (int32_t i = 0; i < n; i++)
            if (isfinite(g->likeness[(ptrdiff_t)i * m + k].distance))
                d[count++] = g->likeness[(ptrdiff_t)i * m + k].distance;
        g->example.v[k].alike = g->p.alike > 0 ? g->p.alike : gap_of(d, count);
    }
    tz_free(g->ctx, d);
    return s;
}

tz_status tz_propagate_likeness(tz_propagation *g)
{
    const int32_t n = g->before->element.n;
    job w = {.g = g};
    tz_status s = tz_alloc(g->ctx, &w.at, (size_t)n, sizeof *w.at);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        w.at[i] = g->before->element.v[i].at;
    if (s == TZ_OK)
        s = tz_cells_fill(g->ctx, &w.cells, &g->before->domain, w.at, n, 1.3 * g->radius);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &g->likeness, (size_t)n * (size_t)g->example.n,
                     sizeof *g->likeness);
    if (s == TZ_OK)
        s = tz_parallel_for(g->ctx, n, compare_one, &w);
    if (s == TZ_OK)
        s = find_limits(g);
    tz_cells_free(g->ctx, &w.cells);
    tz_free(g->ctx, w.at);
    return s;
}
