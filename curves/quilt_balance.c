/* SPDX-License-Identifier: Apache-2.0 */
/* Minimum cuts avoid lines, so that along seams between things that stand by themselves
 * either those of both patches stay (strokes: too many), or those that would lie over
 * others go away (wheels: too few). Here the length of lines is made right again, by whole
 * things only:
 *
 *   too much    the thing where lines are densest goes, and the next
 *   too little  into the widest gap goes the longest thing that fits, and on
 *
 * until what is off is less than half a thing. Densities are those of blocks that hold
 * about one thing each, smoothed by 1 2 1; gaps are found by a distance transform. */
#include <stdlib.h>
#include <string.h>

#include "curves/quilt_internal.h"

#define TOO_MUCH 0.03
#define FEW      0.2 /* share of lines that are of things */

typedef struct block {
    double length, area;
} block;

typedef struct ranked {
    double density;
    int32_t thing;
} ranked;

typedef struct balance {
    tz_ctx *ctx;
    const quilt_source *s;
    quilt_map *m;
    quilt_runs *r;
    const quilt_thing *thing;
    const int32_t *order;
    int32_t things;
    double *length; /* per thing */
    double all, of_things, want;
    block *block;
    int32_t bx, by;
    double side;
} balance;

/* ---- lengths ------------------------------------------------------------------------ */

typedef void visitor(balance *b, tz_vec2 at, double length, double *sum);

/* Calls f for short pieces of a run. */
static double visit_run(balance *b, int32_t run, visitor *f, double *sum)
{
    enum { MOST = 1 << 12 };
    const quilt_run *r = &b->r->run.v[run];
    const quilt_patch *p = &b->m->patch.v[r->patch];
    double all = 0;
    for (int32_t k = r->part; k < r->part + r->parts; k++) {
        const quilt_part *part = &b->r->part.v[k];
        const tz_bezier whole =
            tz_curve_bezier(b->s->set, &b->s->set->piece.v[part->piece]);
        const tz_bezier c = tz_bezier_part(&whole, part->t0, part->t1);
        const double length = tz_bezier_length(&c);
        const int32_t n = (int32_t)fmin(MOST, fmax(1, ceil(2 * length / b->side)));
        all += length;
        for (int32_t i = 0; i < n && f; i++)
            f(b, quilt_place_at(p, tz_bezier_at(&c, (i + 0.5) / n)), length / n, sum);
    }
    return all;
}

static double visit_thing(balance *b, int32_t thing, visitor *f, double *sum)
{
    const quilt_thing *t = &b->thing[thing];
    double all = 0;
    for (int32_t k = 0; k < t->runs; k++)
        all += visit_run(b, b->order[t->run + k], f, sum);
    return all;
}

static bool is_gone(const balance *b, int32_t thing)
{
    return b->thing[thing].runs == 0 || b->r->run.v[b->order[b->thing[thing].run]].gone;
}

/* Length by area of the exemplar. About things by themselves half their distance is empty,
 * which is part of the pattern; margins that are wider are not. */
static double usual_density(const balance *b)
{
    const quilt_source *s = b->s;
    const tz_curve_set *e = s->original;
    const tz_vec3 size = e->domain.size;
    double length = 0;
    for (int32_t i = 0; i < e->piece.n; i++) {
        const tz_bezier c = tz_curve_bezier(e, &e->piece.v[i]);
        length += tz_bezier_length(&c);
    }
    if (e->domain.torus)
        return length / (size.x * size.y);
    const double area = (s->hi.x - s->lo.x) * (s->hi.y - s->lo.y),
                 more = fmax(0, sqrt(area / fmax(1, s->objects)) - s->spacing) / 2;
    const tz_vec2 lo = {fmax(0, s->lo.x - more), fmax(0, s->lo.y - more)},
                  hi = {fmin(size.x, s->hi.x + more), fmin(size.y, s->hi.y + more)};
    return length / ((hi.x - lo.x) * (hi.y - lo.y));
}

static void measure(balance *b)
{
    int64_t cells = 0;
    for (ptrdiff_t i = 0; i < (ptrdiff_t)b->m->nx * b->m->ny; i++)
        cells += b->m->label[i] >= 0;
    b->want = (double)cells * b->m->cx * b->m->cy * usual_density(b);
    b->side = fmax(b->m->cx, b->m->cy);
    for (int32_t i = 0; i < b->r->run.n; i++)
        if (!b->r->run.v[i].gone)
            b->all += visit_run(b, i, NULL, NULL);
    for (int32_t i = 0; i < b->things; i++) {
        b->length[i] = visit_thing(b, i, NULL, NULL);
        b->of_things += is_gone(b, i) ? 0 : b->length[i];
    }
}

/* ---- too much ----------------------------------------------------------------------- */

static int32_t axis(double x, double side, int32_t n, bool torus)
{
    const double k = floor(x / side);
    if (torus)
        return (int32_t)(k - n * floor(k / n));
    return (int32_t)fmax(0, fmin(n - 1, k));
}

static block *block_at(const balance *b, tz_vec2 p)
{
    const bool torus = b->m->domain->torus;
    return &b->block[(ptrdiff_t)axis(p.y, b->side, b->by, torus) * b->bx +
                     axis(p.x, b->side, b->bx, torus)];
}

static void add_length(balance *b, tz_vec2 at, double length, double *sum)
{
    block_at(b, at)->length += *sum * length;
}

static void add_density(balance *b, tz_vec2 at, double length, double *sum)
{
    double in = 0, area = 0;
    for (int j = -1; j <= 1; j++)
        for (int i = -1; i <= 1; i++) {
            const block *k =
                block_at(b, (tz_vec2){at.x + i * b->side, at.y + j * b->side});
            const double w = (2 - abs(i)) * (2 - abs(j));
            in += w * k->length;
            area += w * k->area;
        }
    *sum += area > 0 ? length * in / area : 0;
}

static double density_of(balance *b, int32_t thing)
{
    double sum = 0;
    visit_thing(b, thing, add_density, &sum);
    return b->length[thing] > 0 ? sum / b->length[thing] : 0;
}

static tz_status make_blocks(balance *b)
{
    const tz_vec3 size = b->m->domain->size;
    const double area = b->m->cx * b->m->cy;
    b->side = fmax(sqrt(size.x * size.y / fmax(1, b->things)), b->side);
    b->bx = (int32_t)fmax(1, ceil(size.x / b->side));
    b->by = (int32_t)fmax(1, ceil(size.y / b->side));
    const tz_status st =
        tz_alloc_zero(b->ctx, &b->block, (size_t)b->bx * (size_t)b->by, sizeof *b->block);
    if (st != TZ_OK)
        return st;
    for (int32_t j = 0; j < b->m->ny; j++)
        for (int32_t i = 0; i < b->m->nx; i++)
            if (b->m->label[(ptrdiff_t)j * b->m->nx + i] >= 0)
                block_at(b, (tz_vec2){(i + 0.5) * b->m->cx, (j + 0.5) * b->m->cy})
                    ->area += area;
    double one = 1;
    for (int32_t i = 0; i < b->r->run.n; i++)
        if (!b->r->run.v[i].gone)
            visit_run(b, i, add_length, &one);
    return TZ_OK;
}

static bool before(ranked a, ranked b)
{
    return a.density > b.density || (a.density == b.density && a.thing < b.thing);
}

static void sift(ranked *heap, int32_t n, int32_t i)
{
    for (;;) {
        int32_t top = i;
        for (int32_t c = 2 * i + 1; c <= 2 * i + 2 && c < n; c++)
            if (before(heap[c], heap[top]))
                top = c;
        if (top == i)
            return;
        const ranked t = heap[i];
        heap[i] = heap[top];
        heap[top] = t;
        i = top;
    }
}

/* The densest first. Densities only fall, so that one that is still above the next is the
 * highest. */
static tz_status thin(balance *b)
{
    ranked *heap = NULL;
    int32_t n = 0;
    double less = -1;
    tz_status st = make_blocks(b);
    if (st == TZ_OK)
        st = tz_alloc(b->ctx, &heap, (size_t)b->things, sizeof *heap);
    if (st != TZ_OK)
        return st;
    for (int32_t i = 0; i < b->things; i++)
        if (!is_gone(b, i) && b->length[i] > 0)
            heap[n++] = (ranked){density_of(b, i), i};
    for (int32_t i = n / 2; i-- > 0;)
        sift(heap, n, i);
    while (n > 0 && b->all > b->want) {
        const int32_t t = heap[0].thing;
        const double now = density_of(b, t);
        if (now < heap[0].density) {
            heap[0].density = now;
            sift(heap, n, 0);
            continue;
        }
        heap[0] = heap[--n];
        sift(heap, n, 0);
        if (b->length[t] > 2 * (b->all - b->want))
            continue; /* it would be more off without */
        visit_thing(b, t, add_length, &less);
        b->all -= b->length[t];
        for (int32_t k = 0; k < b->thing[t].runs; k++)
            b->r->run.v[b->order[b->thing[t].run + k]].gone = true;
    }
    tz_free(b->ctx, heap);
    return TZ_OK;
}

/* ---- all of it ---------------------------------------------------------------------- */

tz_status quilt_balance(tz_ctx *ctx, const quilt_source *s, quilt_map *m, quilt_runs *r,
                        const quilt_thing *thing, int32_t things, const int32_t *order)
{
    balance b = {.ctx = ctx,
                 .s = s,
                 .m = m,
                 .r = r,
                 .thing = thing,
                 .things = things,
                 .order = order};
    tz_status st = tz_alloc(ctx, &b.length, (size_t)things, sizeof *b.length);
    if (st != TZ_OK || things == 0)
        goto done;
    measure(&b);
    /* where most lines hang together, their seams settle how many there are, and things
     * only make up for what is far too much */
    const bool most = b.of_things >= 0.5 * b.all;
    if (b.all > (most ? 1 : 1 + TOO_MUCH) * b.want)
        st = b.of_things >= FEW * b.all ? thin(&b) : TZ_OK;
    else if (most && s->loops && b.all < b.want && s->original->element.element.n == 0)
        /* elements get their places later */
        st = quilt_fill_gaps(ctx, s, m, r, b.want - b.all);
done:
    tz_free(ctx, b.length);
    tz_free(ctx, b.block);
    return st;
}
