/* SPDX-License-Identifier: Apache-2.0 */
/* Classes of elements: how near two may come, and how many of each there should be.
 *
 * [Dav19] keeps two elements apart by one share of the sum of their radii. That share is
 * right for one exemplar only: leaves overlap, trees keep their distance, and small
 * things stand closer to large ones than to each other. Here each pair of classes (kind
 * and size) keeps the least share that the exemplar shows. */
#include <math.h>

#include "elements/growth_internal.h"

enum { LEAST = 16, RARE = 25, AXES = 6, FEW = 10, EXPECTED = 6 };
static const float tolerance = 0.97F;

/* The lowest shares seen of a pair of classes. */
typedef struct lows {
    int32_t n;
    float v[LEAST];
} lows;

/* Sums over a class. */
typedef struct tally {
    float n, wide, radius;
} tally;

static void note(lows *l, float v)
{
    int32_t i = l->n < LEAST ? l->n : LEAST;
    l->n++;
    for (; i > 0 && l->v[i - 1] > v; i--)
        if (i < LEAST)
            l->v[i] = l->v[i - 1];
    if (i < LEAST)
        l->v[i] = v;
}

/* The share that one in so many pairs undercuts. */
static float low_of(const lows *l, int32_t rare)
{
    const int32_t i = l->n / rare;
    return tolerance * l->v[i < LEAST ? i : LEAST - 1];
}

/* Of many pairs one in a hundred may be an accident. */
static float low(const lows *l) { return low_of(l, 100); }

static int32_t size_bin(const tz_growth_unit *e, double radius)
{
    const double b = floor(log2(e->r / radius) / 0.7 + 0.5);
    return (int32_t)fmin(fmax(b, -4), 4) + 4;
}

static int32_t axis_bin(const tz_growth_unit *e)
{
    if (e->c2 == 0 && e->s2 == 0)
        return 0;
    const double turn =
        atan2((double)e->s2, (double)e->c2) / (2 * TZ_PI) + 0.5 + 0.5 / AXES;
    return 1 + (int32_t)(turn * AXES) % AXES;
}

/* Number of a key among those met so far; beyond the last all share one. */
static int32_t number_of(int64_t *key, int32_t *n, int64_t k)
{
    for (int32_t i = 0; i < *n; i++)
        if (key[i] == k) /* NOLINT(clang-analyzer-core.*): the first n are set */
            return i;
    if (*n < TZ_GROWTH_CLASSES)
        key[(*n)++] = k;
    return *n - 1;
}

static void number_all(tz_growth_exemplar *ex)
{
    int64_t hard[TZ_GROWTH_CLASSES], class[TZ_GROWTH_CLASSES];
    double radius = 0;
    for (int32_t k = 0; k < ex->elements; k++)
        radius += ex->unit[k].r / ex->elements;
    for (int32_t k = 0; k < ex->n; k++) {
        tz_growth_unit *e = &ex->unit[k];
        const int64_t key = (int64_t)e->kind * 16 + size_bin(e, radius);
        /* what has a symbol of its own is balanced by growth_use.c */
        const int64_t symbol = e->source < 0 || ex->own ? 0 : e->symbol + 1;
        e->hard = number_of(hard, &ex->hards, key);
        e->class = number_of(class, &ex->classes,
                             (key * 16 + axis_bin(e)) * 65536 + symbol % 65536);
    }
}

/* A class that the exemplar shows at its border only may still be called for. */
static const float least_weight = 1e-3F;

static void count_all(tz_growth_exemplar *ex)
{
    float sum = 0;
    for (int32_t k = 0; k < ex->n; k++)
        if (ex->unit[k].stand_in >= 0) {
            const float weight = ex->unit[k].source < 0 ? 1 : ex->unit[k].weight;
            ex->frequency[ex->unit[ex->unit[k].stand_in].class] += weight + least_weight;
            sum += weight + least_weight;
        }
    for (int32_t c = 0; c < ex->classes; c++)
        ex->frequency[c] /= sum;
}

/* Distance of two over the sum of their radii, or over that at which they touch. */
static float share_of(const tz_growth_exemplar *ex, const tz_growth_unit *e,
                      const tz_growth_near *o, bool touch)
{
    const tz_growth_body a = tz_growth_body_of(e),
                         b = tz_growth_body_of(&ex->unit[o->unit]);
    const float d = hypotf(o->x, o->y);
    if (!touch)
        return d / (a.r + b.r);
    const float to = atan2f(o->y, o->x);
    return d /
           (tz_growth_extent(ex, &a, to) + tz_growth_extent(ex, &b, to + (float)TZ_PI));
}

/* Of each class the one that is nearest, in its share, to each unit; all of them to
 * `every`. */
static void note_all(const tz_growth_exemplar *ex, bool touch, lows *pair, lows *every)
{
    for (int32_t k = 0; k < ex->n; k++) {
        const tz_growth_unit *e = &ex->unit[k];
        float least[TZ_GROWTH_CLASSES];
        bool room[TZ_GROWTH_CLASSES]; /* voids are no measure of elements */
        for (int32_t h = 0; h < ex->hards; h++)
            least[h] = INFINITY, room[h] = e->source < 0;
        for (int32_t j = 0; j < e->nears; j++) {
            const tz_growth_near *o = &ex->near.v[e->near + j];
            const int32_t hard = ex->unit[o->unit].hard;
            room[hard] = room[hard] || ex->unit[o->unit].source < 0;
            if (touch || least[hard] == INFINITY)
                least[hard] = fminf(least[hard], share_of(ex, e, o, touch));
        }
        for (int32_t h = 0; h < ex->hards; h++) {
            if (least[h] == INFINITY)
                continue;
            note(&pair[e->hard * ex->hards + h], least[h]);
            if (!room[h])
                note(every, least[h]);
        }
    }
}

/* Share that keeps two classes apart that are never seen side by side. If many pairs were
 * to be expected by chance they avoid each other, and stay out of first rings. */
static float avoidance(const tz_growth_exemplar *ex, const tally *a, const tally *b,
                       float overlap)
{
    const float pairs = a->n * b->n / (float)ex->n * ex->ring_mean;
    const float wide = fminf(a->wide / a->n, b->wide / b->n);
    const float radii = a->radius / a->n + b->radius / b->n;
    return pairs < EXPECTED ? overlap : fmaxf(overlap, tolerance * wide / radii);
}

static void set_limits(const tz_growth_exemplar *ex, const lows *pair, const lows *every,
                       float overlap, float *limit)
{
    const int32_t h = ex->hards;
    tally sum[TZ_GROWTH_CLASSES] = {{0, 0, 0}};
    for (int32_t k = 0; k < ex->n; k++) {
        tally *t = &sum[ex->unit[k].hard];
        t->n += 1, t->wide += ex->unit[k].wide, t->radius += ex->unit[k].r;
    }
    for (int32_t i = 0; i < h; i++)
        for (int32_t j = 0; j < h; j++) {
            const lows *p = &pair[i * h + j], *q = &pair[j * h + i];
            float v;
            if (p->n && q->n)
                v = fminf(low(p), low(q));
            else if (p->n || q->n)
                v = low(p->n ? p : q);
            else
                v = avoidance(ex, &sum[i], &sum[j], overlap);
            if (p->n + q->n > 0 && p->n + q->n < FEW) /* may come nearer than they do */
                v = fminf(v, fmaxf(overlap, low(every)));
            limit[i * h + j] = v;
        }
}

/* Long and cornered things are kept apart by where they touch, in each direction, and by
 * their circles no more than the exemplar shows. Shapes that were never seen side by side
 * do not overlap, unless all do. */
static tz_status find_limits(tz_ctx *ctx, tz_growth_exemplar *ex)
{
    const size_t pairs = (size_t)ex->hards * (size_t)ex->hards;
    lows *pair = NULL, every[2] = {{0}, {0}};
    tz_status s = TZ_OK;
    for (int touch = 0; touch < 2 && s == TZ_OK; touch++) {
        float overlap = (float)ex->overlap;
        s = tz_alloc_zero(ctx, &pair, pairs, sizeof *pair);
        if (s != TZ_OK)
            break;
        note_all(ex, touch, pair, &every[touch]);
        if (touch && every[1].n > 0)
            overlap = fmaxf(overlap, fminf(1, low(&every[1])));
        set_limits(ex, pair, &every[touch], overlap, touch ? ex->touch : ex->limit);
        /* what has been cut out of a photo overlaps by mistake only */
        for (size_t k = 0; k < pairs && touch && ex->own && every[1].n > 0; k++)
            ex->touch[k] = fmaxf(ex->touch[k], fminf(1, low_of(&every[1], RARE)));
        tz_free(ctx, pair);
    }
    for (size_t k = 0; s == TZ_OK && k < pairs; k++)
        ex->bound[k] = fmaxf(ex->limit[k], ex->touch[k]);
    return s;
}

/* How far from each unit things stand that may collide with what grows around it. */
static void set_sight(tz_growth_exemplar *ex)
{
    float largest[TZ_GROWTH_CLASSES] = {0}, least = INFINITY;
    for (int32_t k = 0; k < ex->n; k++)
        least = fminf(least, ex->unit[k].r);
    for (int32_t k = 0; k < ex->n; k++)
        largest[ex->unit[k].hard] = fmaxf(largest[ex->unit[k].hard], ex->unit[k].r);
    for (int32_t k = 0; k < ex->n; k++) {
        tz_growth_unit *e = &ex->unit[k];
        e->sight = e->view = e->reach - least;
        e->clear = (float)ex->overlap * e->r;
        for (int32_t h = 0; h < ex->hards; h++)
            e->clear =
                fmaxf(e->clear, ex->bound[e->hard * ex->hards + h] * (e->r + largest[h]) -
                                    largest[h]);
        for (int32_t j = 0; j < (e->larger ? e->nears : e->ring); j++) {
            const tz_growth_near *o = &ex->near.v[e->near + j];
            const float d = hypotf(o->x, o->y);
            if (j >= e->ring && !tz_growth_is_larger(o, e))
                continue;
            const float *limit = &ex->bound[ex->unit[o->unit].hard * ex->hards];
            for (int32_t h = 0; h < ex->hards; h++)
                e->sight =
                    fmaxf(e->sight, d + limit[h] * (o->r + largest[h]) - largest[h]);
        }
    }
}

tz_status tz_growth_find_classes(tz_ctx *ctx, tz_growth_exemplar *ex)
{
    number_all(ex);
    const size_t pairs = (size_t)ex->hards * (size_t)ex->hards;
    tz_status s = tz_alloc_zero(ctx, &ex->limit, pairs, sizeof *ex->limit);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &ex->touch, pairs, sizeof *ex->touch);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &ex->bound, pairs, sizeof *ex->bound);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &ex->frequency, (size_t)ex->classes,
                          sizeof *ex->frequency);
    if (s == TZ_OK) {
        count_all(ex);
        s = find_limits(ctx, ex);
    }
    if (s == TZ_OK)
        set_sight(ex);
    return s;
}
