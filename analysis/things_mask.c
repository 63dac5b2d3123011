/* SPDX-License-Identifier: Apache-2.0 */
/* A joint narrower than a superpixel has none of its own: the things at its sides meet in
 * its middle. There the border's colour c lies outside of what lies between the colours a
 * and b of the two cores, (c - a) . (c - b) > 0, and far from both. From such places the
 * joint spreads into each thing, as long as pixels look more like the joint than like the
 * core, and not deeper than a share of the thing's own depth. */
#include "analysis/things_mask.h"

#include <math.h>
#include <string.h>

enum { FAR = 30000 };

#define CORE    0.5  /* of a thing's largest depth: deeper is its core */
#define DEEPEST 0.25 /* of a thing's largest depth: as deep joints may cut */
#define CLEAR   4.0  /* as many times nearer, squared, must be the joint's colour */
#define LEAST   5.0  /* Lab units: less than this is no joint */
#define TAIL    0.22 /* of a thing's largest depth: what is thinner than twice that goes */

typedef struct core {
    double colour[3], area;
    int32_t depth; /* largest, 3 a px */
} core;

typedef struct seed {
    int32_t p;
    int32_t steps;
    float colour[3];
} seed;

typedef struct mask {
    tz_ctx *ctx;
    const tz_things_picture *in;
    int32_t *label, n;
    int16_t *depth;
    core *core;
    uint8_t *joint;
    TZ_ARRAY(seed)
    queue;
} mask;

/* ---- depth --------------------------------------------------------------------------- */

static int16_t least(int16_t a, int32_t b) { return b < a ? (int16_t)b : a; }

tz_status tz_things_depth_map(tz_ctx *ctx, const int32_t *label, int32_t width,
                              int32_t height, int16_t **out)
{
    const ptrdiff_t w = width, n = w * height;
    int16_t *d = NULL;
    const tz_status s = tz_alloc(ctx, &d, (size_t)n, sizeof *d);
    if (s != TZ_OK)
        return s;
    for (ptrdiff_t p = 0; p < n; p++) {
        const ptrdiff_t x = p % w;
        d[p] = FAR;
        if ((x > 0 && label[p - 1] != label[p]) || (p >= w && label[p - w] != label[p]) ||
            (x + 1 < w && label[p + 1] != label[p]) ||
            (p + w < n && label[p + w] != label[p]))
            d[p] = 2; /* half a pixel to the border between them */
    }
    for (ptrdiff_t p = 0; p < n; p++) {
        const ptrdiff_t x = p % w;
        if (x > 0)
            d[p] = least(d[p], d[p - 1] + 3);
        if (p >= w) {
            d[p] = least(d[p], d[p - w] + 3);
            if (x > 0)
                d[p] = least(d[p], d[p - w - 1] + 4);
            if (x + 1 < w)
                d[p] = least(d[p], d[p - w + 1] + 4);
        }
    }
    for (ptrdiff_t p = n - 1; p >= 0; p--) {
        const ptrdiff_t x = p % w;
        if (x + 1 < w)
            d[p] = least(d[p], d[p + 1] + 3);
        if (p + w < n) {
            d[p] = least(d[p], d[p + w] + 3);
            if (x > 0)
                d[p] = least(d[p], d[p + w - 1] + 4);
            if (x + 1 < w)
                d[p] = least(d[p], d[p + w + 1] + 4);
        }
    }
    *out = d;
    return TZ_OK;
}

/* ---- joints -------------------------------------------------------------------------- */

static void measure_cores(mask *m)
{
    const size_t n = (size_t)m->in->width * (size_t)m->in->height;
    for (size_t p = 0; p < n; p++)
        if (m->label[p] >= 0 && m->depth[p] > m->core[m->label[p]].depth)
            m->core[m->label[p]].depth = m->depth[p];
    for (size_t p = 0; p < n; p++) {
        core *c = m->label[p] >= 0 ? &m->core[m->label[p]] : NULL;
        if (!c || m->depth[p] < CORE * c->depth)
            continue;
        c->area++;
        for (int32_t k = 0; k < m->in->channels; k++)
            c->colour[k] += m->in->lab[(size_t)k * n + p];
    }
    for (int32_t i = 0; i < m->n; i++)
        for (int k = 0; k < 3; k++)
            m->core[i].colour[k] /= fmax(m->core[i].area, 1);
}

static tz_status add_seed(mask *m, int32_t p, int32_t steps, const float colour[3])
{
    if (m->joint[p])
        return TZ_OK;
    m->joint[p] = 1;
    return tz_array_push(m->ctx, &m->queue,
                         ((seed){p, steps, {colour[0], colour[1], colour[2]}}));
}

/* Where two things meet at p and q, and what lies between them is neither. */
static tz_status look_between(mask *m, int32_t p, int32_t q, double limit)
{
    const size_t n = (size_t)m->in->width * (size_t)m->in->height;
    const core *a = &m->core[m->label[p]], *b = &m->core[m->label[q]];
    double dot = 0, to_a = 0, to_b = 0;
    float c[3] = {0};
    for (int32_t k = 0; k < m->in->channels; k++) {
        const float *lab = m->in->lab + (size_t)k * n;
        c[k] = 0.5F * (lab[p] + lab[q]);
        const double u = c[k] - a->colour[k], v = c[k] - b->colour[k];
        dot += u * v;
        to_a += u * u;
        to_b += v * v;
    }
    if (!(dot > 0.5 * sqrt(to_a * to_b)) || to_a < limit * limit || to_b < limit * limit)
        return TZ_OK;
    const tz_status s = add_seed(m, p, 0, c);
    return s == TZ_OK ? add_seed(m, q, 0, c) : s;
}

static tz_status find_joints(mask *m, double limit)
{
    const int32_t w = m->in->width, h = m->in->height;
    tz_status s = TZ_OK;
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            const int32_t p = y * w + x, l = m->label[p];
            if (l < 0)
                continue;
            if (x + 1 < w && m->label[p + 1] >= 0 && m->label[p + 1] != l &&
                (s = look_between(m, p, p + 1, limit)) != TZ_OK)
                return s;
            if (y + 1 < h && m->label[p + w] >= 0 && m->label[p + w] != l &&
                (s = look_between(m, p, p + w, limit)) != TZ_OK)
                return s;
        }
    return s;
}

/* Whether a pixel of thing l looks more like a joint of this colour than like its core. */
static bool like_joint(const mask *m, int32_t p, const float *colour)
{
    const size_t n = (size_t)m->in->width * (size_t)m->in->height;
    const core *c = &m->core[m->label[p]];
    double joint = 0, own = 0;
    for (int32_t k = 0; k < m->in->channels; k++) {
        const double v = m->in->lab[(size_t)k * n + (size_t)p];
        joint += (v - colour[k]) * (v - colour[k]);
        own += (v - c->colour[k]) * (v - c->colour[k]);
    }
    return CLEAR * joint < own;
}

static tz_status spread_joints(mask *m)
{
    const int32_t w = m->in->width, h = m->in->height;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < m->queue.n && s == TZ_OK; i++) {
        const seed e = m->queue.v[i];
        const int32_t x = e.p % w, y = e.p / w, l = m->label[e.p];
        const int32_t next[4] = {x > 0 ? e.p - 1 : -1, x + 1 < w ? e.p + 1 : -1,
                                 y > 0 ? e.p - w : -1, y + 1 < h ? e.p + w : -1};
        if (3 * (e.steps + 1) > DEEPEST * m->core[l].depth)
            continue;
        for (int k = 0; k < 4 && s == TZ_OK; k++)
            if (next[k] >= 0 && m->label[next[k]] == l && !m->joint[next[k]] &&
                like_joint(m, next[k], e.colour))
                s = add_seed(m, next[k], e.steps + 1, e.colour);
    }
    for (int32_t i = 0; i < m->queue.n && s == TZ_OK; i++)
        m->label[m->queue.v[i].p] = -1;
    return s;
}

static tz_status cut_joints(mask *m, double spread)
{
    const size_t n = (size_t)m->in->width * (size_t)m->in->height;
    tz_status s =
        tz_things_depth_map(m->ctx, m->label, m->in->width, m->in->height, &m->depth);
    if (s == TZ_OK)
        s = tz_alloc_zero(m->ctx, &m->core, (size_t)m->n + 1, sizeof *m->core);
    if (s == TZ_OK)
        s = tz_alloc_zero(m->ctx, &m->joint, n, sizeof *m->joint);
    if (s == TZ_OK) {
        measure_cores(m);
        s = find_joints(m, fmax(LEAST, 0.5 * spread));
    }
    return s == TZ_OK ? spread_joints(m) : s;
}

/* ---- tails --------------------------------------------------------------------------- */

/* Opening of each thing by a disc that is small against it: scraps of joints and of other
 * things that hang on it go to the ground. */
static tz_status cut_tails(tz_ctx *ctx, int32_t *label, int32_t w, int32_t h,
                           int32_t count)
{
    const ptrdiff_t n = (ptrdiff_t)w * h;
    int16_t *depth = NULL, *far = NULL, *radius = NULL;
    int32_t *core = NULL;
    tz_status s = tz_things_depth_map(ctx, label, w, h, &depth);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &radius, (size_t)count + 1, sizeof *radius);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &core, (size_t)n, sizeof *core);
    for (ptrdiff_t p = 0; p < n && s == TZ_OK; p++)
        if (label[p] >= 0 && depth[p] > radius[label[p]])
            radius[label[p]] = depth[p];
    for (int32_t i = 0; i < count && s == TZ_OK; i++)
        radius[i] = (int16_t)(TAIL * radius[i]);
    for (ptrdiff_t p = 0; p < n && s == TZ_OK; p++)
        core[p] = label[p] >= 0 && depth[p] > radius[label[p]] ? label[p] : -1;
    if (s == TZ_OK)
        s = tz_things_depth_map(ctx, core, w, h, &far);
    for (ptrdiff_t p = 0; p < n && s == TZ_OK; p++)
        if (label[p] >= 0 && core[p] < 0 && far[p] > radius[label[p]] + 1)
            label[p] = -1;
    tz_free(ctx, depth);
    tz_free(ctx, far);
    tz_free(ctx, radius);
    tz_free(ctx, core);
    return s;
}

/* ---- parts --------------------------------------------------------------------------- */

typedef struct part {
    int32_t label, area;
} part;

/* Numbers the 4-connected parts of the labels, things only; -1 elsewhere. */
static tz_status number_parts(tz_ctx *ctx, const int32_t *label, int32_t w, int32_t h,
                              int32_t *of, int32_t *stack, tz_things_nodes *area)
{
    const int32_t n = w * h;
    for (int32_t p = 0; p < n; p++)
        of[p] = -1;
    for (int32_t start = 0; start < n; start++) {
        int32_t count = 1, size = 0;
        if (label[start] < 0 || of[start] >= 0)
            continue;
        const int32_t id = area->n;
        stack[0] = start;
        of[start] = id;
        while (count > 0) {
            const int32_t p = stack[--count], x = p % w, y = p / w;
            const int32_t next[4] = {x > 0 ? p - 1 : -1, x + 1 < w ? p + 1 : -1,
                                     y > 0 ? p - w : -1, y + 1 < h ? p + w : -1};
            size++;
            for (int k = 0; k < 4; k++)
                if (next[k] >= 0 && of[next[k]] < 0 && label[next[k]] == label[start]) {
                    of[next[k]] = id;
                    stack[count++] = next[k];
                }
        }
        const tz_status s = tz_array_push(ctx, area, size);
        if (s != TZ_OK)
            return s;
    }
    return TZ_OK;
}

/* Each label keeps its largest part; labels are numbered anew in their order. */
static tz_status keep_largest(tz_ctx *ctx, int32_t *label, int32_t w, int32_t h,
                              double least_area, int32_t *count)
{
    const size_t n = (size_t)w * (size_t)h;
    int32_t *of = NULL, *stack = NULL, *best = NULL, kept = 0;
    tz_things_nodes area = {0};
    tz_status s = tz_alloc(ctx, &of, n, sizeof *of);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &stack, n, sizeof *stack);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &best, (size_t)*count + 1, sizeof *best);
    if (s == TZ_OK)
        s = number_parts(ctx, label, w, h, of, stack, &area);
    if (s != TZ_OK)
        goto done;
    for (int32_t l = 0; l < *count; l++)
        best[l] = -1;
    for (size_t p = 0; p < n; p++) {
        if (label[p] < 0 || !area.v)
            continue;
        int32_t *b = &best[label[p]];
        if (*b < 0 || area.v[of[p]] > area.v[*b])
            *b = of[p];
    }
    for (size_t p = 0; p < n; p++)
        if (label[p] >= 0 && best[label[p]] != of[p])
            label[p] = -1;
    for (int32_t l = 0; l < *count; l++) /* best becomes the new number */
        best[l] = area.v && best[l] >= 0 && area.v[best[l]] >= least_area ? kept++ : -1;
    for (size_t p = 0; p < n; p++)
        label[p] = label[p] >= 0 ? best[label[p]] : -1;
    *count = kept;
done:
    tz_free(ctx, of);
    tz_free(ctx, stack);
    tz_free(ctx, best);
    tz_array_free(ctx, &area);
    return s;
}

/* ---- driver -------------------------------------------------------------------------- */

/* The chosen node above each leaf. */
static tz_status label_pixels(tz_ctx *ctx, const tz_things_tree *t,
                              const tz_things_nodes *chosen, size_t n, int32_t *label)
{
    int32_t *of = NULL;
    const tz_status s = tz_alloc(ctx, &of, (size_t)t->n, sizeof *of);
    if (s != TZ_OK)
        return s;
    memset(of, 255, (size_t)t->n * sizeof *of);
    for (int32_t i = 0; i < chosen->n; i++)
        of[chosen->v[i]] = i;
    for (int32_t v = t->n - 2; v >= 0; v--)
        if (of[t->node[v].parent] >= 0)
            of[v] = of[t->node[v].parent];
    for (size_t p = 0; p < n; p++)
        label[p] = of[t->leaf[p]];
    tz_free(ctx, of);
    return TZ_OK;
}

tz_status tz_things_mask(tz_ctx *ctx, const tz_things_picture *in,
                         const tz_things_tree *t, const tz_things_nodes *chosen,
                         double least_area, int32_t *label, int32_t *count)
{
    const size_t n = (size_t)in->width * (size_t)in->height;
    mask m = {.ctx = ctx, .in = in, .label = label, .n = chosen->n};
    tz_status s = label_pixels(ctx, t, chosen, n, label);
    *count = chosen->n;
    if (s == TZ_OK)
        s = cut_joints(&m, t->spread);
    if (s == TZ_OK)
        s = cut_tails(ctx, label, in->width, in->height, chosen->n);
    if (s == TZ_OK)
        s = keep_largest(ctx, label, in->width, in->height, least_area, count);
    tz_free(ctx, m.depth);
    tz_free(ctx, m.core);
    tz_free(ctx, m.joint);
    tz_array_free(ctx, &m.queue);
    return s;
}
