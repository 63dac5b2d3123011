/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/support/things_truth.h"

#include <stdlib.h>
#include <string.h>

enum { LEAST_AREA = 30 };

/* ---- nodes --------------------------------------------------------------------------- */

/* Pixels by piece: order[first[k]] .. order[first[k + 1] - 1]. */
static tz_status by_piece(tz_ctx *ctx, const tz_scene *scene, int32_t **first,
                          int32_t **order)
{
    const size_t n = (size_t)scene->photo.width * (size_t)scene->photo.height;
    tz_status s = tz_alloc_zero(ctx, first, (size_t)scene->pieces + 2, sizeof **first);
    if (s == TZ_OK)
        s = tz_alloc(ctx, order, n, sizeof **order);
    if (s != TZ_OK)
        return s;
    for (size_t p = 0; p < n; p++)
        (*first)[scene->segment[p] + 2]++;
    for (int32_t k = 0; k < scene->pieces; k++)
        (*first)[k + 2] += (*first)[k + 1];
    for (size_t p = 0; p < n; p++)
        (*order)[(*first)[scene->segment[p] + 1]++] = (int32_t)p;
    return TZ_OK;
}

tz_status truth_of_nodes(tz_ctx *ctx, const tz_things_tree *t, const tz_scene *scene,
                         float *iou)
{
    int32_t *first = NULL, *order = NULL, *shared = NULL;
    tz_status s = by_piece(ctx, scene, &first, &order);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &shared, (size_t)t->n, sizeof *shared);
    for (int32_t v = 0; v < t->n && s == TZ_OK; v++)
        iou[v] = 0;
    for (int32_t k = 0; k < scene->pieces && s == TZ_OK; k++) {
        if (!scene->piece[k].element)
            continue;
        for (int32_t i = first[k]; i < first[k + 1]; i++)
            for (int32_t v = t->leaf[order[i]]; v >= 0; v = t->node[v].parent)
                shared[v]++;
        for (int32_t i = first[k]; i < first[k + 1]; i++)
            for (int32_t v = t->leaf[order[i]]; v >= 0 && shared[v];
                 v = t->node[v].parent) {
                const double q = shared[v];
                const float r = (float)(q / (t->node[v].area + scene->piece[k].area - q));
                iou[v] = r > iou[v] ? r : iou[v];
                shared[v] = 0;
            }
    }
    tz_free(ctx, first);
    tz_free(ctx, order);
    tz_free(ctx, shared);
    return s;
}

/* ---- labels -------------------------------------------------------------------------- */

typedef struct overlap {
    int32_t piece, label, area;
    double iou;
} overlap;

typedef struct count {
    tz_ctx *ctx;
    const tz_scene *scene;
    const int32_t *label;
    int32_t labels;
    int32_t *area; /* of labels */
    bool *ignored; /* pieces */
    bool *taken;   /* pieces, then labels */
    uint64_t *key; /* piece << 32 | label of each pixel that has both */
    int64_t keys;
    overlap *pair;
    int32_t pairs;
} count;

static int by_key(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static int by_iou(const void *a, const void *b)
{
    const overlap *p = a, *q = b;
    if (p->iou != q->iou)
        return p->iou > q->iou ? -1 : 1;
    return p->piece != q->piece ? (p->piece > q->piece) - (p->piece < q->piece)
                                : (p->label > q->label) - (p->label < q->label);
}

/* Pieces that are too small, or mostly cut. */
static tz_status find_ignored(count *c)
{
    const int32_t w = c->scene->photo.width, h = c->scene->photo.height;
    const int32_t *seg = c->scene->segment;
    int32_t *around = NULL, *frame = NULL;
    tz_status s =
        tz_alloc_zero(c->ctx, &around, (size_t)c->scene->pieces, sizeof *around);
    if (s == TZ_OK)
        s = tz_alloc_zero(c->ctx, &frame, (size_t)c->scene->pieces, sizeof *frame);
    for (int32_t y = 0; y < h && s == TZ_OK; y++)
        for (int32_t x = 0; x < w; x++) {
            const int32_t *p = seg + (size_t)y * (size_t)w + (size_t)x;
            const int32_t f = (x == 0) + (y == 0) + (x + 1 == w) + (y + 1 == h);
            frame[*p] += f;
            around[*p] += f + (x > 0 && p[-1] != *p) + (y > 0 && p[-w] != *p) +
                          (x + 1 < w && p[1] != *p) + (y + 1 < h && p[w] != *p);
        }
    for (int32_t k = 0; k < c->scene->pieces && s == TZ_OK; k++)
        c->ignored[k] = c->scene->piece[k].area < LEAST_AREA || 3 * frame[k] > around[k];
    tz_free(c->ctx, around);
    tz_free(c->ctx, frame);
    return s;
}

static tz_status find_overlaps(count *c)
{
    const int64_t n = (int64_t)c->scene->photo.width * c->scene->photo.height;
    tz_status s = tz_alloc(c->ctx, &c->key, (size_t)n, sizeof *c->key);
    if (s != TZ_OK)
        return s;
    for (int64_t p = 0; p < n; p++) {
        if (c->label[p] < 0)
            continue;
        c->area[c->label[p]]++;
        if (c->scene->piece[c->scene->segment[p]].element)
            c->key[c->keys++] =
                (uint64_t)c->scene->segment[p] << 32 | (uint32_t)c->label[p];
    }
    qsort(c->key, (size_t)c->keys, sizeof *c->key, by_key);
    s = tz_alloc(c->ctx, &c->pair, (size_t)c->keys + 1, sizeof *c->pair);
    for (int64_t i = 0, j; i < c->keys && s == TZ_OK; i = j) {
        for (j = i; j < c->keys && c->key[j] == c->key[i];)
            j++;
        overlap o = {.piece = (int32_t)(c->key[i] >> 32),
                     .label = (int32_t)(uint32_t)c->key[i],
                     .area = (int32_t)(j - i)};
        o.iou =
            (double)o.area / (c->scene->piece[o.piece].area + c->area[o.label] - o.area);
        c->pair[c->pairs++] = o;
    }
    return s;
}

/* Labels that do not count are taken beforehand, and labels that pair with things that do
 * not count are taken too. */
static void pair_up(count *c, truth_counts *out)
{
    bool *label_taken = c->taken + c->scene->pieces;
    *out = (truth_counts){0};
    for (int32_t l = 0; l < c->labels; l++)
        label_taken[l] = c->area[l] < LEAST_AREA;
    for (int32_t i = 0; i < c->pairs; i++) {
        const overlap *o = &c->pair[i];
        if (c->ignored[o->piece] && 2 * o->area > c->area[o->label])
            label_taken[o->label] = true;
    }
    for (int32_t l = 0; l < c->labels; l++)
        out->found += !label_taken[l];
    for (int32_t k = 0; k < c->scene->pieces; k++)
        out->things += c->scene->piece[k].element && !c->ignored[k];
    for (int32_t i = 0; i < c->pairs && c->pair[i].iou >= 0.5; i++) {
        const overlap *o = &c->pair[i];
        if (c->taken[o->piece] || label_taken[o->label] || c->ignored[o->piece])
            continue;
        c->taken[o->piece] = label_taken[o->label] = true;
        out->pairs++;
        out->iou += o->iou;
    }
}

tz_status truth_count(tz_ctx *ctx, const tz_scene *scene, const int32_t *label,
                      int32_t labels, truth_counts *out)
{
    count c = {.ctx = ctx, .scene = scene, .label = label, .labels = labels};
    const size_t all = (size_t)scene->pieces + (size_t)labels + 1;
    tz_status s = tz_alloc_zero(ctx, &c.area, (size_t)labels + 1, sizeof *c.area);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &c.ignored, (size_t)scene->pieces + 1, sizeof *c.ignored);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &c.taken, all, sizeof *c.taken);
    if (s == TZ_OK)
        s = find_ignored(&c);
    if (s == TZ_OK)
        s = find_overlaps(&c);
    if (s == TZ_OK) {
        qsort(c.pair, (size_t)c.pairs, sizeof *c.pair, by_iou);
        pair_up(&c, out);
    }
    tz_free(ctx, c.area);
    tz_free(ctx, c.ignored);
    tz_free(ctx, c.taken);
    tz_free(ctx, c.key);
    tz_free(ctx, c.pair);
    return s;
}
