/* SPDX-License-Identifier: Apache-2.0 */
/* Things (small parts that hang together) are laid as a whole by the patch that owns their
 * centre, so that near a seam they may lie over what another patch has laid. Those that
 * lie most among their own go first; what then would cross another's lines goes away. */
#include <stdlib.h>
#include <string.h>

#include "curves/quilt_internal.h"

typedef struct crowd {
    tz_ctx *ctx;
    const quilt_source *s;
    const quilt_map *m;
    quilt_runs *r;
    int32_t *claim; /* per cell: patch + 1 whose lines run there, 0 = none */
    int32_t *order; /* runs of things */
    TZ_ARRAY(quilt_thing)
    thing;
} crowd;

typedef enum visit { CLAIM, COUNT } visit;

static ptrdiff_t cell_of(const quilt_map *m, tz_vec2 p)
{
    if (m->domain->torus)
        p = (tz_vec2){tz_domain_wrap_axis(p.x, m->domain->size.x),
                      tz_domain_wrap_axis(p.y, m->domain->size.y)};
    const double x = floor(p.x / m->cx), y = floor(p.y / m->cy);
    return x >= 0 && y >= 0 && x < m->nx && y < m->ny
               ? (ptrdiff_t)y * m->nx + (ptrdiff_t)x
               : -1;
}

/* Claims the cells of a run, or counts: own cells, all cells, cells of others' lines. */
static void visit_run(crowd *c, int32_t run, visit v, int64_t count[3])
{
    const quilt_run *r = &c->r->run.v[run];
    const quilt_patch *p = &c->m->patch.v[r->patch];
    for (int32_t k = r->part; k < r->part + r->parts; k++) {
        const quilt_part *part = &c->r->part.v[k];
        const tz_bezier whole =
            tz_curve_bezier(c->s->set, &c->s->set->piece.v[part->piece]);
        const tz_bezier b = tz_bezier_part(&whole, part->t0, part->t1);
        const double n = fmin(ceil(tz_bezier_length(&b) / (c->m->cx / 2)), 1 << 14);
        for (int32_t j = 0; j <= n; j++) {
            const ptrdiff_t at =
                cell_of(c->m, quilt_place_at(p, tz_bezier_at(&b, j / fmax(n, 1))));
            if (at < 0)
                continue;
            if (v == CLAIM) {
                c->claim[at] = r->patch + 1;
                continue;
            }
            count[0] += c->m->label[at] == r->patch;
            count[1]++;
            count[2] += c->m->label[at] == QUILT_GIVEN ||
                        (c->claim[at] != 0 && c->claim[at] != r->patch + 1);
        }
    }
}

static int by_own(const void *a, const void *b)
{
    const quilt_thing *p = a, *q = b;
    if (p->own != q->own)
        return p->own > q->own ? -1 : 1;
    if (p->patch != q->patch)
        return p->patch < q->patch ? -1 : 1;
    return (p->object > q->object) - (p->object < q->object);
}

/* Things of one patch: first .. last of its runs. */
static tz_status list_things(crowd *c, int32_t first, int32_t last, int32_t *n)
{
    const int32_t from = c->thing.n;
    tz_status st = TZ_OK;
    for (int32_t i = first; i < last && st == TZ_OK; i++) {
        const int32_t o = c->s->object[c->r->run.v[i].path];
        int32_t k = from;
        if (o < 0)
            continue;
        while (k < c->thing.n && c->thing.v[k].object != o)
            k++;
        if (k == c->thing.n)
            st = tz_array_push(
                c->ctx, &c->thing,
                ((quilt_thing){.patch = c->r->run.v[i].patch, .object = o}));
        if (st == TZ_OK)
            c->thing.v[k].runs++;
    }
    for (int32_t k = from; k < c->thing.n; k++) {
        c->thing.v[k].run = *n;
        *n += c->thing.v[k].runs;
        c->thing.v[k].runs = 0;
    }
    for (int32_t i = first; i < last && st == TZ_OK; i++) {
        const int32_t o = c->s->object[c->r->run.v[i].path];
        for (int32_t k = from; k < c->thing.n && o >= 0; k++)
            if (c->thing.v[k].object == o)
                c->order[c->thing.v[k].run + c->thing.v[k].runs++] = i;
    }
    return st;
}

static void settle(crowd *c)
{
    for (int32_t i = 0; i < c->thing.n; i++) {
        int64_t count[3] = {0, 0, 0};
        for (int32_t k = 0; k < c->thing.v[i].runs; k++)
            visit_run(c, c->order[c->thing.v[i].run + k], COUNT, count);
        c->thing.v[i].own = count[1] ? (double)count[0] / (double)count[1] : 0;
    }
    if (c->thing.n > 1)
        qsort(c->thing.v, (size_t)c->thing.n, sizeof *c->thing.v, by_own);
    for (int32_t i = 0; i < c->thing.n; i++) {
        const quilt_thing *t = &c->thing.v[i];
        int64_t count[3] = {0, 0, 0};
        for (int32_t k = 0; k < t->runs; k++)
            visit_run(c, c->order[t->run + k], COUNT, count);
        for (int32_t k = 0; k < t->runs; k++) {
            const int32_t run = c->order[t->run + k];
            if (count[2] > 0)
                c->r->run.v[run].gone = true;
            else
                visit_run(c, run, CLAIM, count);
        }
    }
}

tz_status quilt_drop_things(tz_ctx *ctx, const quilt_source *s, quilt_map *m,
                            quilt_runs *r)
{
    crowd c = {.ctx = ctx, .s = s, .m = m, .r = r};
    int32_t n = 0;
    if (s->objects == 0)
        return TZ_OK;
    tz_status st =
        tz_alloc_zero(ctx, &c.claim, (size_t)m->nx * (size_t)m->ny, sizeof *c.claim);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &c.order, (size_t)r->run.n, sizeof *c.order);
    for (int32_t i = 0, j; i < r->run.n && st == TZ_OK; i = j) {
        for (j = i; j < r->run.n && r->run.v[j].patch == r->run.v[i].patch; j++)
            if (s->object[r->run.v[j].path] < 0)
                visit_run(&c, j, CLAIM, NULL);
        st = list_things(&c, i, j, &n);
    }
    if (st == TZ_OK)
        settle(&c);
    if (st == TZ_OK)
        st = quilt_balance(ctx, s, m, r, c.thing.v, c.thing.n, c.order);
    tz_free(ctx, c.claim);
    tz_free(ctx, c.order);
    tz_array_free(ctx, &c.thing);
    return st;
}
