/* SPDX-License-Identifier: Apache-2.0 */
/* How far the neighbourhoods of one field are from those of another: for each of some
 * hundred elements, the most alike neighbourhood of the same class. */
#include <string.h>

#include "elements/cells.h"
#include "elements/element_statistics.h"
#include "elements/pairing.h"

enum { MOST_CENTRES = 256, MOST_RIVALS = 512, MOST = TZ_PAIRING_MOST };

typedef struct sides {
    int32_t n;
    int32_t *id; /* elements that have a side */
    tz_pairing_side *side;
} sides;

typedef struct distance_job {
    const tz_field *f, *g;
    const sides *wanted, *rivals;
    double spacing;
    double *cost;
    bool attributes; /* do they differ anywhere */
} distance_job;

static void fill_side(const tz_field *f, const tz_nearby *near, int32_t n,
                      tz_pairing_side *s)
{
    s->n = n;
    for (int32_t k = 0; k < n; k++) {
        const tz_field_item *v = &f->item[near[k].id];
        const double angle = v->oriented ? v->angle : 0;
        s->x[k] = near[k].x, s->y[k] = near[k].y;
        s->a[k] = (float)(v->radius * cos(angle));
        s->b[k] = (float)(v->radius * sin(angle));
        s->l[k] = (float)v->kind;
    }
    tz_pairing_sort(s, NULL);
}

/* Elements whose neighbourhood lies inside a plain domain, if there are enough; of many,
 * every few. */
static int32_t choose(const tz_field *f, double margin, int32_t most, int32_t *id)
{
    const tz_vec3 size = f->domain.size;
    int32_t n = 0;
    for (int32_t i = 0; i < f->n; i++) {
        const tz_vec3 p = f->at[i];
        if (f->domain.torus || (p.x >= margin && p.y >= margin &&
                                p.x <= size.x - margin && p.y <= size.y - margin))
            id[n++] = i;
    }
    if (n < 4) {
        n = f->n;
        for (int32_t i = 0; i < n; i++)
            id[i] = i;
    }
    const int32_t kept = n < most ? n : most;
    for (int32_t i = 0; i < kept; i++)
        id[i] = id[(int64_t)i * n / kept];
    return kept;
}

static tz_status make_sides(const tz_field *f, double spacing, int32_t near,
                            double margin, int32_t centres, sides *out)
{
    /* a disc that holds twice as many on average, cut to the nearest */
    const double reach = sqrt(2 * near / TZ_PI) * spacing;
    tz_cells cells = {0};
    tz_nearby found[MOST];
    tz_status s = tz_alloc(f->ctx, &out->id, (size_t)f->n, sizeof *out->id);
    if (s == TZ_OK)
        s = tz_cells_fill(f->ctx, &cells, &f->domain, f->at, f->n, reach);
    if (s == TZ_OK) {
        out->n = choose(f, margin, centres, out->id);
        s = tz_alloc(f->ctx, &out->side, (size_t)out->n, sizeof *out->side);
    }
    for (int32_t i = 0; s == TZ_OK && i < out->n; i++) {
        const int32_t o = out->id[i], n = tz_cells_near(&cells, f->at, f->at[o], reach, o,
                                                        found, near < MOST ? near : MOST);
        fill_side(f, found, n, &out->side[i]);
    }
    tz_cells_free(f->ctx, &cells);
    return s;
}

static tz_status nearest_of(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx, (void)worker;
    distance_job *job = arg;
    const tz_pairing_side *p = &job->wanted->side[i];
    const tz_field_item *e = &job->f->item[job->wanted->id[i]];
    const float limit = (float)(job->spacing * job->spacing);
    tz_pairing w = {.attributes = job->attributes, .limit = limit};
    float best = limit * (float)p->n;
    for (int32_t k = 0; k < job->rivals->n; k++) {
        if (job->g->item[job->rivals->id[k]].kind != e->kind)
            continue;
        const float c = tz_pairing_best(&w, p, &job->rivals->side[k], best);
        best = c < best ? c : best;
    }
    job->cost[i] = p->n > 0 ? sqrt((double)best / p->n) : 0;
    return TZ_OK;
}

static void see_what_differs(distance_job *job, const tz_field *f)
{
    const tz_field_item *first = &job->f->item[0];
    for (int32_t i = 0; i < f->n; i++)
        job->attributes =
            job->attributes || f->item[i].oriented || f->item[i].radius != first->radius;
}

tz_status tz_field_distance(const tz_field *f, const tz_field *g, double spacing,
                            int32_t near, double *out)
{
    sides wanted = {0}, rivals = {0};
    distance_job job = {f, g, &wanted, &rivals, spacing, NULL, false};
    tz_ctx *ctx = f->ctx;
    see_what_differs(&job, f);
    see_what_differs(&job, g);
    tz_status s =
        make_sides(f, spacing, near, sqrt(near / TZ_PI) * spacing, MOST_CENTRES, &wanted);
    if (s == TZ_OK) /* neighbourhoods cut by the border dismiss themselves */
        s = make_sides(g, spacing, near + near / 3, 0, MOST_RIVALS, &rivals);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &job.cost, (size_t)wanted.n, sizeof *job.cost);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, wanted.n, nearest_of, &job);
    *out = 0;
    for (int32_t i = 0; s == TZ_OK && i < wanted.n; i++)
        *out += job.cost[i] / wanted.n;
    tz_free(ctx, job.cost);
    tz_free(ctx, wanted.id);
    tz_free(ctx, wanted.side);
    tz_free(ctx, rivals.id);
    tz_free(ctx, rivals.side);
    return s;
}
