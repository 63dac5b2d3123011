/* SPDX-License-Identifier: Apache-2.0 */
/* Quilting of curves: the driver.
 *
 *   source   what can be copied                          quilt_source.c
 *   map      cells of the domain; what is given           (here)
 *   lay      places in rows, each with its best patch     quilt_patch.c, quilt_seam.c
 *   fill     places that rows have left                   (here)
 *   repair   new patches over the worst seams, where they are better
 *   cut, pair, emit                                       quilt_cut.c, ..
 *
 * Places whose windows do not touch are laid at once: rows are walked aslant (a place
 * needs those at its left and above), in an order that depends on places only. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "curves/quilt_internal.h"

static const tz_param rows[] = {
    {"patch", TZ_PARAM_DOUBLE, offsetof(tz_curve_quilt_params, patch), 0, 1, "0", "",
     NULL, "Side of a patch, of the exemplar's shorter side; 0 chooses it"},
    {"overlap", TZ_PARAM_DOUBLE, offsetof(tz_curve_quilt_params, overlap), 0.05, 0.45,
     "0.4", "", NULL, "How far patches overlap, of their side"},
    {"candidates", TZ_PARAM_INT, offsetof(tz_curve_quilt_params, candidates), 1, 64, "8",
     "", NULL, "Patches that are tried for each place"},
};

const tz_param_table tz_curve_quilt_param_table = {
    "quilt", "Lays pieces of the exemplar's curves side by side", rows,
    (int32_t)(sizeof rows / sizeof *rows), sizeof(tz_curve_quilt_params)};

/* ---- map ---------------------------------------------------------------------------- */

int32_t quilt_label(const quilt_map *m, tz_vec2 p)
{
    double x = p.x, y = p.y;
    if (m->domain->torus) {
        x = tz_domain_wrap_axis(x, m->domain->size.x);
        y = tz_domain_wrap_axis(y, m->domain->size.y);
    } else if (!(x >= 0 && y >= 0 && x <= m->domain->size.x && y <= m->domain->size.y)) {
        return QUILT_OUTSIDE;
    }
    if (m->domain->region &&
        tz_region_distance(m->domain->region, (tz_vec3){x, y, 0}) < 0)
        return QUILT_OUTSIDE;
    const int32_t i = (int32_t)(x / m->cx), j = (int32_t)(y / m->cy);
    return m->label[(ptrdiff_t)(j < m->ny ? j : m->ny - 1) * m->nx +
                    (i < m->nx ? i : m->nx - 1)];
}

static tz_status map_init(tz_ctx *ctx, const quilt_source *s, const tz_domain *d,
                          quilt_map *m)
{
    const double most = 4e7, nx = fmax(1, round(d->size.x / s->cell)),
                 ny = fmax(1, round(d->size.y / s->cell));
    *m = (quilt_map){.ctx = ctx, .domain = d};
    if (!(nx * ny <= most))
        return tz_fail(ctx, TZ_LIMIT,
                       "quilt: %g x %g is %.3g times the exemplar's spacing squared: "
                       "make tiles, or a larger exemplar",
                       d->size.x, d->size.y, nx * ny / 16);
    m->nx = (int32_t)nx;
    m->ny = (int32_t)ny;
    m->cx = d->size.x / nx;
    m->cy = d->size.y / ny;
    const size_t n = (size_t)m->nx * (size_t)m->ny;
    tz_status st = tz_alloc(ctx, &m->label, n, sizeof *m->label);
    if (st == TZ_OK)
        st = tz_alloc_zero(ctx, &m->closed, n, 1);
    if (st == TZ_OK)
        st = tz_alloc_zero(ctx, &m->cell, n, sizeof *m->cell);
    if (st == TZ_OK)
        st = tz_alloc_zero(ctx, &m->seam, 2 * n, sizeof *m->seam);
    for (int32_t j = 0; j < m->ny && st == TZ_OK; j++)
        for (int32_t i = 0; i < m->nx; i++) {
            const ptrdiff_t at = (ptrdiff_t)j * m->nx + i;
            const tz_vec3 c = {(i + 0.5) * m->cx, (j + 0.5) * m->cy, 0};
            m->label[at] = QUILT_NONE;
            m->closed[at] = d->region && tz_region_distance(d->region, c) < -1.5 * m->cx;
        }
    return st;
}

static void map_deinit(quilt_map *m)
{
    tz_free(m->ctx, m->label);
    tz_free(m->ctx, m->closed);
    tz_free(m->ctx, m->cell);
    tz_free(m->ctx, m->seam);
    tz_array_free(m->ctx, &m->patch);
}

/* ---- what is given ------------------------------------------------------------------ */

static void mark_given(quilt_map *m, tz_vec2 at, double reach)
{
    assert(m->nx > 0 && m->ny > 0);
    const int32_t rx = (int32_t)(reach / m->cx), ry = (int32_t)(reach / m->cy);
    const int32_t x = (int32_t)floor(at.x / m->cx), y = (int32_t)floor(at.y / m->cy);
    for (int32_t j = y - ry; j <= y + ry; j++)
        for (int32_t i = x - rx; i <= x + rx; i++) {
            int32_t u = i, v = j;
            if (m->domain->torus) {
                u = (u % m->nx + m->nx) % m->nx;
                v = (v % m->ny + m->ny) % m->ny;
            }
            if (u >= 0 && v >= 0 && u < m->nx && v < m->ny)
                m->label[(ptrdiff_t)v * m->nx + u] = QUILT_GIVEN;
        }
}

static void draw_given(quilt_map *m, const tz_curve_set *g, double reach)
{
    for (int32_t i = 0; i < g->path.n; i++) {
        const tz_curve_path *p = &g->path.v[i];
        const uint8_t pen = (uint8_t)(p->pen < 254 ? p->pen + 1 : 255);
        for (int32_t k = p->piece; k < p->piece + p->pieces; k++) {
            const tz_bezier b = tz_curve_bezier(g, &g->piece.v[k]);
            const double n = fmin(ceil(tz_bezier_length(&b) / (m->cx / 2)), 65536);
            for (int32_t j = 0; j < n; j++) {
                const tz_vec2 d = tz_bezier_slope(&b, (j + 0.5) / n);
                tz_vec2 at = tz_bezier_at(&b, (j + 0.5) / n);
                if (reach >= 0)
                    mark_given(m, at, reach);
                if (m->domain->torus)
                    at = (tz_vec2){tz_domain_wrap_axis(at.x, m->domain->size.x),
                                   tz_domain_wrap_axis(at.y, m->domain->size.y)};
                const double x = at.x / m->cx, y = at.y / m->cy;
                if (!(x >= 0 && y >= 0 && x < m->nx && y < m->ny))
                    continue;
                double a = atan2(d.y, d.x) / TZ_PI * 256;
                a -= floor(a / 256) * 256;
                quilt_spot_add(&m->cell[(ptrdiff_t)y * m->nx + (ptrdiff_t)x],
                               (quilt_spot){(uint8_t)((x - floor(x)) * 256),
                                            (uint8_t)((y - floor(y)) * 256),
                                            (uint8_t)((int32_t)a & 255), pen});
            }
        }
    }
}

static void take_given(const quilt_source *s, const tz_curve_quilt_job *job, quilt_map *m)
{
    if (job->given_region)
        for (int32_t j = 0; j < m->ny; j++)
            for (int32_t i = 0; i < m->nx; i++)
                if (tz_region_distance(
                        job->given_region,
                        (tz_vec3){(i + 0.5) * m->cx, (j + 0.5) * m->cy, 0}) > 0)
                    m->label[(ptrdiff_t)j * m->nx + i] = QUILT_GIVEN;
    if (job->given)
        draw_given(m, job->given, job->given_region ? -1 : s->spacing / 2);
    /* lines that nothing is known about do not count */
    for (ptrdiff_t i = 0; i < (ptrdiff_t)m->nx * m->ny; i++)
        if (m->label[i] == QUILT_NONE)
            memset(&m->cell[i], 0, sizeof m->cell[i]);
}

/* ---- places ------------------------------------------------------------------------- */

typedef struct quilting {
    tz_ctx *ctx;
    const quilt_source *s;
    const tz_curve_quilt_params *q;
    quilt_map *m;
    uint64_t seed;
    tz_vec2 side;         /* of windows */
    quilt_window *window; /* per worker */
    TZ_ARRAY(quilt_place)
    place;
    bool *done, *laid;
    const int32_t *batch; /* places that run at once */
    int32_t sites, patches;
} quilting;

static tz_status run_place(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    quilting *q = arg;
    (void)ctx;
    const int32_t at = q->batch[i];
    return quilt_place_patch(q->s, q->m, &q->place.v[at], q->q, q->seed,
                             &q->window[worker], &q->laid[at]);
}

/* Whether windows of two places touch. */
static bool touch(const quilting *q, const quilt_place *a, const quilt_place *b)
{
    const tz_domain *d = q->m->domain;
    const tz_vec3 v = tz_domain_vector(d, (tz_vec3){a->at.x, a->at.y, 0},
                                       (tz_vec3){b->at.x, b->at.y, 0});
    const double rim = 6 * fmax(q->m->cx, q->m->cy);
    if (d->frames) {
        const double r = hypot(a->half.x, a->half.y) + hypot(b->half.x, b->half.y) + rim;
        return fabs(v.x) < r && fabs(v.y) < r;
    }
    return fabs(v.x) < a->half.x + b->half.x + rim &&
           fabs(v.y) < a->half.y + b->half.y + rim;
}

/* Lays places first .. n - 1 in their order, but those of one batch at once: a batch is
 * made of places that touch neither each other nor any that comes before and waits.
 * @param ahead  how many of them are looked at */
static tz_status lay_places(quilting *q, int32_t first, int32_t ahead)
{
    int32_t *batch = NULL, *wait = NULL;
    const int32_t n = q->place.n;
    int32_t head = first;
    tz_status st = tz_alloc(q->ctx, &batch, (size_t)ahead, sizeof *batch);
    if (st == TZ_OK)
        st = tz_alloc(q->ctx, &wait, (size_t)ahead, sizeof *wait);
    tz_free(q->ctx, q->done);
    tz_free(q->ctx, q->laid);
    q->done = q->laid = NULL;
    if (st == TZ_OK)
        st = tz_alloc_zero(q->ctx, &q->done, (size_t)n, sizeof *q->done);
    if (st == TZ_OK)
        st = tz_alloc_zero(q->ctx, &q->laid, (size_t)n, sizeof *q->laid);
    while (head < n && st == TZ_OK) {
        int32_t runs = 0, waits = 0;
        const int32_t seen = q->m->patch.n;
        for (int32_t i = head; i < n && i < head + ahead && st == TZ_OK; i++) {
            bool blocked = q->done[i];
            for (int32_t k = 0; k < runs && !blocked; k++)
                blocked = touch(q, &q->place.v[i], &q->place.v[batch[k]]);
            for (int32_t k = 0; k < waits && !blocked; k++)
                blocked = touch(q, &q->place.v[i], &q->place.v[wait[k]]);
            if (blocked) {
                if (!q->done[i])
                    wait[waits++] = i;
                continue;
            }
            q->place.v[i].patch = q->m->patch.n;
            q->place.v[i].seen = seen;
            st = tz_array_push(q->ctx, &q->m->patch, ((quilt_patch){.c = 1}));
            batch[runs++] = i;
        }
        q->batch = batch;
        if (st == TZ_OK)
            st = tz_parallel_for(q->ctx, runs, run_place, q);
        for (int32_t k = 0; k < runs; k++) {
            q->done[batch[k]] = true;
            q->patches += q->laid[batch[k]];
            q->m->balance += q->laid[batch[k]] ? q->place.v[batch[k]].surplus : 0;
        }
        while (head < n && q->done[head])
            head++;
    }
    tz_free(q->ctx, batch);
    tz_free(q->ctx, wait);
    return st;
}

/* How many places along a side, and where the first and the next lie. */
static int32_t spread(double size, double side, double step, bool torus, double *first,
                      double *by)
{
    if (torus) {
        const double n = fmax(2, ceil(size / step - 1e-9));
        *first = 0;
        *by = size / n;
        return (int32_t)n;
    }
    if (side >= size) {
        *first = size / 2;
        *by = 0;
        return 1;
    }
    const double n = 1 + ceil((size - side) / step - 1e-9);
    *first = side / 2;
    *by = (size - side) / (n - 1);
    return (int32_t)n;
}

static bool any_open(const quilting *q, tz_vec2 at, double reach)
{
    const tz_domain *d = q->m->domain;
    return !d->region || tz_region_distance(d->region, (tz_vec3){at.x, at.y, 0}) > -reach;
}

/* Places in rows, by the step at which they can be laid. */
static tz_status lay_rows(quilting *q)
{
    const tz_domain *d = q->m->domain;
    tz_vec2 first, by;
    const double k = 1 - q->q->overlap;
    const int32_t nx =
        spread(d->size.x, q->side.x, k * q->side.x, d->torus, &first.x, &by.x);
    const int32_t ny =
        spread(d->size.y, q->side.y, k * q->side.y, d->torus, &first.y, &by.y);
    tz_status st = TZ_OK;
    for (int64_t t = 0; t < nx + 2 * (int64_t)ny && st == TZ_OK; t++)
        for (int32_t j = 0; j < ny && st == TZ_OK; j++) {
            const int64_t i = t - 2 * (int64_t)j;
            if (i < 0 || i >= nx)
                continue;
            const tz_vec2 at = {first.x + (double)i * by.x, first.y + j * by.y};
            if (any_open(q, at, hypot(q->side.x, q->side.y) / 2))
                st = tz_array_push(q->ctx, &q->place,
                                   ((quilt_place){.at = at,
                                                  .half = {q->side.x / 2, q->side.y / 2},
                                                  .stream = tz_rng_stream(1, (uint64_t)i,
                                                                          (uint64_t)j)}));
        }
    q->sites = q->place.n;
    return st == TZ_OK ? lay_places(q, 0, ny + 8) : st;
}

/* Places that no patch has reached. */
static tz_status fill(quilting *q)
{
    quilt_map *m = q->m;
    tz_status st = TZ_OK;
    for (int32_t j = 0; j < m->ny && st == TZ_OK; j++)
        for (int32_t i = 0; i < m->nx && st == TZ_OK; i++) {
            const ptrdiff_t at = (ptrdiff_t)j * m->nx + i;
            const int32_t first = q->place.n;
            if (m->label[at] != QUILT_NONE || m->closed[at])
                continue;
            /* a little on, so that it reaches what else is open there */
            const quilt_place p = {.at = {(i + 0.5) * m->cx + 0.2 * q->side.x,
                                          (j + 0.5) * m->cy + 0.2 * q->side.y},
                                   .half = {q->side.x / 2, q->side.y / 2},
                                   .stream = tz_rng_stream(2, (uint64_t)at, 0)};
            st = tz_array_push(q->ctx, &q->place, p);
            if (st == TZ_OK)
                st = lay_places(q, first, 1);
            if (m->label[at] == QUILT_NONE)
                m->closed[at] = 1;
        }
    return st;
}

/* ---- repair ------------------------------------------------------------------------- */

typedef struct defect {
    double cost;
    tz_vec2 sum;
    int32_t block;
} defect;

static int by_cost(const void *a, const void *b)
{
    const defect *p = a, *q = b;
    if (p->cost != q->cost)
        return p->cost > q->cost ? -1 : 1;
    return (p->block > q->block) - (p->block < q->block);
}

/* New patches over the worst places of the seams. */
static tz_status repair(quilting *q, int32_t pass)
{
    quilt_map *m = q->m;
    defect *d = NULL;
    const int32_t first = q->place.n;
    const double block = 0.2 * fmin(q->side.x, q->side.y), least = 3;
    const int32_t bx = (int32_t)(m->domain->size.x / block) + 1,
                  by = (int32_t)(m->domain->size.y / block) + 1;
    tz_status st = tz_alloc_zero(q->ctx, &d, (size_t)bx * (size_t)by, sizeof *d);
    if (st != TZ_OK)
        return st;
    for (int32_t i = 0; i < bx * by; i++)
        d[i].block = i;
    for (int32_t j = 0; j < m->ny; j++)
        for (int32_t i = 0; i < m->nx; i++) {
            const ptrdiff_t at = (ptrdiff_t)j * m->nx + i;
            const double x = (i + 0.5) * m->cx, y = (j + 0.5) * m->cy,
                         cost = (double)m->seam[2 * at] + (double)m->seam[2 * at + 1];
            defect *b = &d[(int32_t)(y / block) * bx + (int32_t)(x / block)];
            b->cost += cost;
            b->sum = tz_vec2_add(b->sum, (tz_vec2){cost * x, cost * y});
        }
    qsort(d, (size_t)bx * (size_t)by, sizeof *d, by_cost);
    const int32_t most = q->sites / 3 + 1 < bx * by ? q->sites / 3 + 1 : bx * by;
    for (int32_t i = 0; i < most && d[i].cost > least && st == TZ_OK; i++) {
        const quilt_place p = {
            .at = tz_vec2_scale(d[i].sum, 1 / d[i].cost),
            .half = {q->side.x / 2, q->side.y / 2},
            .core = block / 2,
            .stream = tz_rng_stream(3, (uint64_t)pass, (uint64_t)d[i].block)};
        st = tz_array_push(q->ctx, &q->place, p);
    }
    tz_free(q->ctx, d);
    return st == TZ_OK ? lay_places(q, first, 64) : st;
}

/* ---- all of it ---------------------------------------------------------------------- */

static tz_status check_job(tz_ctx *ctx, const tz_curve_quilt_job *job)
{
    const tz_curve_set *e = job->exemplar;
    const tz_domain *d = job->domain;
    tz_status st = tz_curve_set_check(ctx, e, "exemplar");
    if (st == TZ_OK && e->path.n == 0 && e->element.element.n == 0)
        st = tz_fail(ctx, TZ_INVALID, "exemplar: there is nothing drawn in it");
    if (st == TZ_OK &&
        (!(d->size.x > 0 && d->size.y > 0) || !(d->size.x < 1e12) || !(d->size.y < 1e12)))
        st = tz_fail(ctx, TZ_INVALID, "quilt: a domain of %g x %g has no area", d->size.x,
                     d->size.y);
    if (st == TZ_OK && job->given)
        st = tz_curve_set_check(ctx, job->given, "given");
    return st;
}

/* Sides of windows: the whole domain if the exemplar holds it. */
static tz_vec2 window_side(const quilt_source *s, const tz_curve_quilt_job *job,
                           const tz_curve_quilt_params *p)
{
    const tz_vec3 size = job->domain->size;
    const tz_vec2 most = tz_vec2_sub(s->hi, s->lo);
    if (!job->domain->torus && !job->domain->frames && !job->given &&
        !job->given_region && !s->set->domain.region && p->patch == 0 &&
        size.x <= most.x && size.y <= most.y)
        return (tz_vec2){size.x, size.y};
    const double k = job->domain->torus ? 0.8 : 1;
    return (tz_vec2){fmin(s->patch, k * size.x), fmin(s->patch, k * size.y)};
}

static tz_status lay_all(tz_ctx *ctx, const tz_curve_quilt_job *job,
                         const tz_curve_quilt_params *p, const quilt_source *s,
                         quilt_map *m, int32_t *patches)
{
    enum { PASSES = 2 };
    const int threads = tz_ctx_threads(ctx);
    quilting q = {.ctx = ctx, .s = s, .q = p, .m = m, .seed = job->seed};
    q.side = window_side(s, job, p);
    tz_status st = tz_alloc_zero(ctx, &q.window, (size_t)threads, sizeof *q.window);
    for (int i = 0; i < threads && st == TZ_OK; i++)
        st = quilt_window_init(ctx, s, m, q.side, &q.window[i]);
    if (st == TZ_OK)
        st = lay_rows(&q);
    if (st == TZ_OK)
        st = fill(&q);
    for (int i = 0; i < PASSES && st == TZ_OK; i++)
        st = repair(&q, i);
    for (int i = 0; i < threads && q.window; i++)
        quilt_window_deinit(&q.window[i]);
    tz_free(ctx, q.window);
    tz_free(ctx, q.done);
    tz_free(ctx, q.laid);
    tz_array_free(ctx, &q.place);
    *patches = q.patches;
    return st;
}

tz_status tz_curve_quilt(tz_ctx *ctx, const tz_curve_quilt_job *job, tz_curve_set *out,
                         tz_curve_quilt_report *report)
{
    tz_curve_quilt_params p;
    quilt_source s = {0};
    quilt_map m = {0};
    quilt_runs r = {.ctx = ctx};
    tz_curve_quilt_report done = {0};
    memset(out, 0, sizeof *out);
    tz_params_default(&tz_curve_quilt_param_table, &p);
    if (job->params)
        p = *job->params;
    tz_status st = check_job(ctx, job);
    if (st == TZ_OK)
        st = quilt_source_init(ctx, job->exemplar, job->domain, &p, &s);
    if (st == TZ_OK)
        st = map_init(ctx, &s, job->domain, &m);
    if (st == TZ_OK) {
        m.given = job->given;
        take_given(&s, job, &m);
        st = lay_all(ctx, job, &p, &s, &m, &done.patches);
    }
    if (st == TZ_OK)
        st = quilt_cut_runs(ctx, &s, &m, &r);
    if (st == TZ_OK)
        st = quilt_drop_things(ctx, &s, &m, &r);
    if (st == TZ_OK)
        st = quilt_pair(ctx, &s, &m, &r, &done);
    if (st == TZ_OK)
        st = quilt_emit(ctx, &s, &m, &r, job->seed, out);
    if (st == TZ_OK && report)
        *report = done;
    quilt_runs_deinit(&r);
    map_deinit(&m);
    quilt_source_deinit(&s);
    return st;
}
