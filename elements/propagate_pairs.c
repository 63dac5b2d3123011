/* SPDX-License-Identifier: Apache-2.0 */
/* Who is who before and after an edit. Documents may have been written, reordered and
 * read again in between: places tell, numbers help. */
#include <stdlib.h>
#include <string.h>

#include "elements/propagate_internal.h"

enum { LOOK = 16 };

static int32_t kind_before(const tz_propagation *g, const char *name)
{
    for (int32_t k = 0; k < g->before->kind.n; k++)
        if (strcmp(g->before->kind.v[k].name, name) == 0)
            return k;
    return -1;
}

static bool same_symbol(const tz_propagation *g, const tz_element *a, const tz_element *b)
{
    const char *p = g->before->symbol.v[a->symbol].id,
               *q = g->after->symbol.v[b->symbol].id;
    return p && q ? strcmp(p, q) == 0 : a->symbol == b->symbol;
}

/* Rounding in a document is no change. */
static bool unchanged(const tz_propagation *g, const tz_element *a, const tz_element *b)
{
    const double e = 1e-3;
    const tz_vec3 v = tz_domain_vector(&g->before->domain, a->at, b->at);
    return hypot(v.x, v.y) < e * g->spacing && g->kind[b->kind] == a->kind &&
           same_symbol(g, a, b) && fabs(remainder(a->angle - b->angle, 2 * TZ_PI)) < e &&
           fabs(a->scale / b->scale - 1) < e;
}

static void join(tz_propagation *g, int32_t before, int32_t after)
{
    g->partner[before] = after;
    g->origin[after] = before;
}

/* Possible pair of two changed elements. */
typedef struct couple {
    double distance;
    int32_t before, after;
} couple;

static int by_distance(const void *a, const void *b)
{
    const couple *p = a, *q = b;
    if (p->distance != q->distance)
        return p->distance < q->distance ? -1 : 1;
    if (p->before != q->before)
        return p->before < q->before ? -1 : 1;
    return (p->after > q->after) - (p->after < q->after);
}

/* Those left over, nearest first; the same number, and the same symbol, bring nearer. */
static tz_status join_changed(tz_propagation *g)
{
    const double reach = 2 * g->spacing;
    TZ_ARRAY(couple)
    all = {0};
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < g->before->element.n; i++)
        for (int32_t j = 0; g->partner[i] < 0 && j < g->after->element.n; j++) {
            const tz_element *a = &g->before->element.v[i], *b = &g->after->element.v[j];
            if (g->origin[j] >= 0 || s != TZ_OK)
                continue;
            const tz_vec3 v = tz_domain_vector(&g->before->domain, a->at, b->at);
            const bool number = i == j && g->before->element.n == g->after->element.n;
            const double d =
                hypot(v.x, v.y) * (number ? 0.25 : 1) * (same_symbol(g, a, b) ? 0.5 : 1);
            if (d < reach)
                s = tz_array_push(g->ctx, &all, ((couple){d, i, j}));
        }
    if (s == TZ_OK && all.n > 1)
        qsort(all.v, (size_t)all.n, sizeof *all.v, by_distance);
    for (int32_t k = 0; k < all.n && s == TZ_OK; k++)
        if (g->partner[all.v[k].before] < 0 && g->origin[all.v[k].after] < 0)
            join(g, all.v[k].before, all.v[k].after);
    tz_array_free(g->ctx, &all);
    return s;
}

/* The nearest unchanged element that an added one belongs to, or -1. */
static int32_t home_of(const tz_propagation *g, const tz_element *b)
{
    double least = HUGE_VAL;
    int32_t found = -1;
    for (int32_t i = 0; i < g->before->element.n; i++) {
        const tz_vec3 v =
            tz_domain_vector(&g->before->domain, g->before->element.v[i].at, b->at);
        const double d = hypot(v.x, v.y);
        if (!g->changed[i] && d < least)
            least = d, found = i;
    }
    return found;
}

static tz_status list_examples(tz_propagation *g)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < g->before->element.n && s == TZ_OK; i++) {
        const int32_t j = g->partner[i];
        g->changed[i] =
            j < 0 || !unchanged(g, &g->before->element.v[i], &g->after->element.v[j]);
        if (g->changed[i])
            s = tz_array_push(g->ctx, &g->example,
                              ((tz_example){.before = i, .after = j}));
    }
    for (int32_t j = 0; j < g->after->element.n && s == TZ_OK; j++) {
        const int32_t home = g->origin[j] < 0 ? home_of(g, &g->after->element.v[j]) : -1;
        if (home >= 0)
            s = tz_array_push(g->ctx, &g->example,
                              ((tz_example){.before = home, .after = j, .added = true}));
    }
    return s;
}

tz_status tz_propagate_pairs(tz_propagation *g)
{
    const int32_t n = g->before->element.n, m = g->after->element.n;
    tz_cells cells = {0};
    tz_vec3 *at = NULL;
    tz_nearby found[LOOK];
    for (int32_t k = 0; k < g->after->kind.n; k++)
        g->kind[k] = kind_before(g, g->after->kind.v[k].name);
    for (int32_t i = 0; i < n; i++)
        g->partner[i] = -1;
    for (int32_t j = 0; j < m; j++)
        g->origin[j] = -1;
    tz_status s = tz_alloc(g->ctx, &at, (size_t)m, sizeof *at);
    for (int32_t j = 0; j < m && s == TZ_OK; j++)
        at[j] = g->after->element.v[j].at;
    if (s == TZ_OK)
        s = tz_cells_fill(g->ctx, &cells, &g->after->domain, at, m, 0.01 * g->spacing);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        const tz_element *a = &g->before->element.v[i];
        const int32_t k =
            tz_cells_near(&cells, at, a->at, 0.01 * g->spacing, -1, found, LOOK);
        for (int32_t f = 0; f < k && g->partner[i] < 0; f++)
            if (g->origin[found[f].id] < 0 &&
                unchanged(g, a, &g->after->element.v[found[f].id]))
                join(g, i, found[f].id);
    }
    if (s == TZ_OK)
        s = join_changed(g);
    if (s == TZ_OK)
        s = list_examples(g);
    tz_cells_free(g->ctx, &cells);
    tz_free(g->ctx, at);
    return s;
}
