/* SPDX-License-Identifier: Apache-2.0 */
#include "elements/spacing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "elements/cells.h"

enum {
    MOST_KINDS = 128,
    NEAR = 48, /* neighbours looked at */
    RARE = 50  /* one in so many pairs may be nearer */
};
/* Two farther apart than this share of where they touch are not side by side. */
static const double side_by_side = 1.5;
/* Of the push that a pair lacks, per round: two sided, so that chains do not swing. */
static const double step = 0.45;

void tz_spacing_deinit(tz_spacing *s)
{
    tz_free(s->ctx, s->least);
    tz_extents_deinit(&s->extents);
    *s = (tz_spacing){0};
}

/* ---- the exemplar ------------------------------------------------------------------- */

/** Nearest partner of a class, as seen from one element. */
typedef struct pair {
    int32_t key; /* of the two classes, the lower first; kinds^2 = any */
    float share; /* distance over the one at which they touch */
} pair;

typedef TZ_ARRAY(pair)
pair_list;

static int32_t key_of(const tz_spacing *s, int32_t a, int32_t b)
{
    return a < b ? a * s->kinds + b : b * s->kinds + a;
}

/** Distance at which two elements touch; the offset from a to b. */
static double touch(const tz_spacing *s, const tz_element *a, const tz_element *b,
                    double dx, double dy)
{
    return a->symbol < s->extents.n && b->symbol < s->extents.n
               ? tz_extent_touch(&s->extents, a, b, dx, dy)
               : a->radius + b->radius;
}

static int32_t class_of(const tz_spacing *s, const tz_element *e)
{
    return s->kinds == 1 || e->kind >= s->kinds ? 0 : e->kind;
}

static int by_key(const void *a, const void *b)
{
    const pair *p = a, *q = b;
    if (p->key != q->key)
        return p->key < q->key ? -1 : 1;
    return (p->share > q->share) - (p->share < q->share);
}

static bool counts(const tz_element_set *set, const tz_element *e)
{
    return !set->kind.v[e->kind].is_void;
}

static double largest_radius(const tz_element_set *set)
{
    double r = 0;
    for (int32_t i = 0; i < set->element.n; i++)
        if (counts(set, &set->element.v[i]))
            r = fmax(r, set->element.v[i].radius);
    return r;
}

/** Positions and their cells. */
static tz_status sort_places(tz_ctx *ctx, const tz_element_set *set, double reach,
                             tz_vec3 *at, tz_cells *c)
{
    for (int32_t i = 0; i < set->element.n; i++)
        at[i] = set->element.v[i].at;
    return tz_cells_fill(ctx, c, &set->domain, at, set->element.n, reach);
}

/** Nearest partners of element i, one a class. */
static tz_status gather(const tz_spacing *s, const tz_element_set *set, const tz_cells *c,
                        const tz_vec3 *at, int32_t i, double reach, pair_list *list)
{
    tz_nearby near[NEAR];
    const tz_element *e = &set->element.v[i];
    const int32_t from = list->n;
    const int32_t n = tz_cells_near(c, at, at[i], reach, i, near, NEAR);
    for (int32_t k = 0; k < n; k++) {
        const tz_element *f = &set->element.v[near[k].id];
        const double share = sqrt((double)near[k].dist2) /
                             touch(s, e, f, (double)near[k].x, (double)near[k].y);
        if (!counts(set, f) || share > side_by_side)
            continue;
        const pair p = {key_of(s, class_of(s, e), class_of(s, f)), (float)share};
        int32_t j = from;
        while (j < list->n && list->v[j].key != p.key)
            j++;
        if (j < list->n) {
            list->v[j].share = fminf(list->v[j].share, p.share);
            continue;
        }
        const tz_status st = tz_array_push(s->ctx, list, p);
        if (st != TZ_OK)
            return st;
    }
    return TZ_OK;
}

/** The share that one in RARE of a sorted run undercuts. */
static float rare(const pair *p, int32_t n) { return p[n / RARE].share; }

static tz_status measure(tz_spacing *s, pair_list *list)
{
    const int32_t n = list->n;
    float any = 0;
    if (n > 0) {
        pair *all = NULL;
        tz_status st = tz_alloc(s->ctx, &all, (size_t)n, sizeof *all);
        if (st != TZ_OK)
            return st;
        for (int32_t i = 0; i < n; i++)
            all[i] = (pair){0, list->v[i].share};
        qsort(all, (size_t)n, sizeof *all, by_key);
        any = rare(all, n);
        tz_free(s->ctx, all);
        qsort(list->v, (size_t)n, sizeof *list->v, by_key);
    }
    for (int32_t i = 0; i < s->kinds * s->kinds; i++)
        s->least[i] = any;
    for (int32_t i = 0, j; i < n; i = j) {
        const int32_t a = list->v[i].key / s->kinds, b = list->v[i].key % s->kinds;
        for (j = i; j < n && list->v[j].key == list->v[i].key;)
            j++;
        s->least[a * s->kinds + b] = s->least[b * s->kinds + a] =
            rare(list->v + i, j - i);
    }
    return TZ_OK;
}

tz_status tz_spacing_init(tz_ctx *ctx, const tz_element_set *exemplar, tz_spacing *s)
{
    const int32_t n = exemplar->element.n;
    const double radius = largest_radius(exemplar), reach = side_by_side * 2 * radius;
    pair_list list = {0};
    tz_cells cells = {0};
    tz_vec3 *at = NULL;
    *s = (tz_spacing){.ctx = ctx,
                      .kinds = exemplar->kind.n > MOST_KINDS || exemplar->kind.n < 1
                                   ? 1
                                   : exemplar->kind.n};
    tz_status st = tz_alloc_zero(ctx, &s->least, (size_t)s->kinds * (size_t)s->kinds,
                                 sizeof *s->least);
    if (st == TZ_OK)
        st = tz_extents_init(ctx, exemplar, &s->extents);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &at, (size_t)n, sizeof *at);
    if (st == TZ_OK && reach > 0)
        st = sort_places(ctx, exemplar, reach, at, &cells);
    for (int32_t i = 0; i < n && st == TZ_OK && reach > 0; i++)
        if (counts(exemplar, &exemplar->element.v[i]))
            st = gather(s, exemplar, &cells, at, i, reach, &list);
    if (st == TZ_OK)
        st = measure(s, &list);
    for (int32_t i = 0; st == TZ_OK && i < s->kinds * s->kinds; i++)
        s->most = fmaxf(s->most, s->least[i]);
    tz_cells_free(ctx, &cells);
    tz_array_free(ctx, &list);
    tz_free(ctx, at);
    if (st != TZ_OK)
        tz_spacing_deinit(s);
    return st;
}

/* ---- the layout --------------------------------------------------------------------- */

typedef struct relax_job {
    const tz_spacing *s;
    tz_element_set *set;
    const tz_cells *cells;
    const tz_vec3 *at;
    tz_vec2 *push;
    double largest;
} relax_job;

enum { CHUNK = 256 };

/** What pushes element i. */
static tz_vec2 push_of(const relax_job *j, int32_t i)
{
    tz_nearby near[NEAR];
    const tz_element *e = &j->set->element.v[i];
    const double reach = (double)j->s->most * (e->radius + j->largest);
    tz_vec2 sum = {0, 0};
    if (e->fixed || !counts(j->set, e) || !(reach > 0))
        return sum;
    const int32_t n = tz_cells_near(j->cells, j->at, j->at[i], reach, i, near, NEAR);
    for (int32_t k = 0; k < n; k++) {
        const tz_element *f = &j->set->element.v[near[k].id];
        const double d = sqrt((double)near[k].dist2),
                     least = (double)j->s->least[class_of(j->s, e) * j->s->kinds +
                                                 class_of(j->s, f)] *
                             touch(j->s, e, f, (double)near[k].x, (double)near[k].y);
        if (!counts(j->set, f) || d >= least)
            continue;
        /* coincident ones part, each in a direction of its own: the golden angle */
        const double own = 2.39996322972865 * i;
        const tz_vec2 away = d > 1e-9 * least ? (tz_vec2){-near[k].x / d, -near[k].y / d}
                                              : (tz_vec2){cos(own), sin(own)};
        const double by = (least - d) * (f->fixed ? 2 * step : step);
        sum = tz_vec2_add(sum, tz_vec2_scale(away, by));
    }
    const double length = tz_vec2_length(sum);
    return length > e->radius ? tz_vec2_scale(sum, e->radius / length) : sum;
}

static tz_status push_task(tz_ctx *ctx, void *arg, int64_t chunk, int worker)
{
    (void)ctx;
    (void)worker;
    const relax_job *j = arg;
    const int64_t n = j->set->element.n;
    for (int64_t i = chunk * CHUNK; i < n && i < (chunk + 1) * CHUNK; i++)
        j->push[i] = push_of(j, (int32_t)i);
    return TZ_OK;
}

/** Moves an element and its samples, unless it would leave the domain. */
static bool move(tz_element_set *set, tz_element *e, tz_vec2 by)
{
    const tz_vec3 to = {e->at.x + by.x, e->at.y + by.y, e->at.z};
    if ((by.x == 0 && by.y == 0) || !tz_domain_contains(&set->domain, to))
        return false;
    const tz_vec3 at = tz_domain_wrap(&set->domain, to);
    for (int32_t k = e->sample; k < e->sample + e->samples; k++) {
        set->sample.v[k].at.x += at.x - e->at.x;
        set->sample.v[k].at.y += at.y - e->at.y;
    }
    e->at = at;
    return true;
}

tz_status tz_spacing_relax(const tz_spacing *s, tz_element_set *layout, int32_t rounds)
{
    tz_ctx *ctx = s->ctx;
    const int32_t n = layout->element.n;
    const double largest = largest_radius(layout), reach = 2 * largest * (double)s->most;
    tz_cells cells = {0};
    tz_vec3 *at = NULL;
    tz_vec2 *push = NULL;
    bool moved = reach > 0;
    tz_status st = tz_alloc(ctx, &at, (size_t)n, sizeof *at);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &push, (size_t)n, sizeof *push);
    for (int32_t r = 0; r < rounds && moved && st == TZ_OK; r++) {
        relax_job j = {s, layout, &cells, at, push, largest};
        st = sort_places(ctx, layout, reach, at, &cells);
        if (st == TZ_OK)
            st = tz_parallel_for(ctx, (n + CHUNK - 1) / CHUNK, push_task, &j);
        moved = false;
        for (int32_t i = 0; i < n && st == TZ_OK; i++)
            moved |= move(layout, &layout->element.v[i], push[i]);
    }
    tz_cells_free(ctx, &cells);
    tz_free(ctx, at);
    tz_free(ctx, push);
    return st;
}
