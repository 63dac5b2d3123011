/* SPDX-License-Identifier: Apache-2.0 */
/* The driver: begin, iterate, write. */
#include "fields/fill.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "elements/bend.h"
#include "fields/fill_internal.h"

static const tz_param rows[] = {
    {"alpha", TZ_PARAM_DOUBLE, offsetof(tz_fill_params, alpha), 0, 100, "1", "", NULL,
     "how much neighbours turn alike, against following strokes"},
    {"beta", TZ_PARAM_DOUBLE, offsetof(tz_fill_params, beta), 0, 100, "1", "", NULL,
     "how much neighbours are sized alike, against following strokes"},
    {"iterations", TZ_PARAM_INT, offsetof(tz_fill_params, iterations), 0, 10000, "100",
     "", NULL, "of the solver; 5 give a preview"},
    {"fill", TZ_PARAM_DOUBLE, offsetof(tz_fill_params, fill), 0.01, 1.5, "0.72", "", NULL,
     "area of all things over that of the domain"},
    {"rigidity", TZ_PARAM_DOUBLE, offsetof(tz_fill_params, rigidity), 0, 1e6, "100", "",
     NULL, "0 = things bend, 100 = they never do"},
    {"start", TZ_PARAM_ENUM, offsetof(tz_fill_params, start), 0, 1, "insert", "",
     "random|insert", "all at random places, or the smaller half into gaps"},
    {"discs", TZ_PARAM_INT, offsetof(tz_fill_params, discs), 1, TZ_COVER_DISCS, "9", "",
     NULL, "that a thing is made of, at most"},
    {"repair", TZ_PARAM_BOOL, offsetof(tz_fill_params, repair), 0, 1, "true", "", NULL,
     "keeps true outlines apart and fills gaps at the end"},
};
const tz_param_table tz_fill_param_table = {
    "fill", "fills a domain with things along strokes", rows, sizeof rows / sizeof *rows,
    sizeof(tz_fill_params)};

void tz_fill_end(tz_fill *f)
{
    if (!f)
        return;
    tz_ctx *ctx = f->ctx;
    for (int32_t i = 0; i < f->model.n; i++)
        tz_fill_model_deinit(ctx, &f->model.v[i]);
    tz_array_free(ctx, &f->model);
    tz_array_free(ctx, &f->body);
    tz_array_free(ctx, &f->obstacle);
    tz_array_free(ctx, &f->left);
    tz_array_free(ctx, &f->changed);
    tz_array_free(ctx, &f->obstacle_sample);
    tz_array_free(ctx, &f->live);
    tz_array_free(ctx, &f->live_sample);
    tz_array_free(ctx, &f->live_node);
    tz_array_free(ctx, &f->link);
    tz_power_free(f->power);
    tz_fill_guide_deinit(f);
    void *const all[] = {
        f->at,     f->radius,   f->c,          f->rho,      f->o,          f->owner,
        f->node,   f->weight,   f->target,     f->target_c, f->target_rho, f->confident,
        f->said_c, f->said_rho, f->link_start, f->edge_to,  f->edge_w,     f->link_count,
        f->diag,   f->rank,     f->gradient,   f->step,     f->kept,       f->block,
        f->work,   f->pressure, f->prior,      f->wide,     f->peer,       f->named};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        tz_free(ctx, all[i]);
    tz_free(ctx, f);
}

/* ---- begin -------------------------------------------------------------------------- */

static bool between(double v, double lo, double hi) { return v >= lo && v <= hi; }

static tz_status check(tz_ctx *ctx, const tz_fill_job *j, const tz_fill_params *p)
{
    const tz_vec3 size = j->domain.size;
    if (!(size.x > 0) || !(size.y > 0) || !isfinite(size.x) || !isfinite(size.y))
        return tz_fail(ctx, TZ_INVALID, "a domain of %g x %g has no area to fill", size.x,
                       size.y);
    if (!(tz_domain_area(&j->domain) > 0))
        return tz_fail(ctx, TZ_INVALID, "nothing of the domain lies inside its region");
    if (!between(p->alpha, 0, 1e6) || !between(p->beta, 0, 1e6) ||
        !between(p->fill, 1e-6, 1e3) || !(p->rigidity >= 0) ||
        !between(p->iterations, 0, 1e6) || !between(p->discs, 1, TZ_COVER_DISCS))
        return tz_fail(ctx, TZ_INVALID,
                       "a parameter of the fill is out of range (alpha %g, beta %g, fill "
                       "%g, rigidity %g, iterations %d, discs %d)",
                       p->alpha, p->beta, p->fill, p->rigidity, p->iterations, p->discs);
    if (j->field && !j->field->cell)
        return tz_fail(ctx, TZ_INVALID, "the field has not been settled");
    if (j->count > TZ_FILL_MOST)
        return tz_fail(ctx, TZ_LIMIT, "%d elements; at most %d can be arranged", j->count,
                       TZ_FILL_MOST);
    return TZ_OK;
}

static void what_is_said(tz_fill *f)
{
    if (!f->field)
        return;
    f->any_direction = f->field->nearest[0][0] >= 0;
    f->any_size = f->field->nearest[1][0] >= 0;
    f->any_density = f->field->nearest[2][0] >= 0;
}

static void mean_radius(tz_fill *f)
{
    double sum = 0, n = 0;
    for (int32_t k = 0; k < f->entries; k++) {
        const tz_fill_model *m = &f->model.v[k];
        for (int32_t i = 0; i < m->n; i++)
            sum += m->share * m->radius[i] * sqrt(m->size[0] * m->size[1]), n += m->share;
    }
    f->unit = sum / n;
}

tz_status tz_fill_begin(tz_ctx *ctx, const tz_fill_job *job, tz_element_set *layout,
                        tz_fill **out)
{
    tz_fill *f = NULL;
    tz_fill_params p;
    double count = job->count;
    tz_params_default(&tz_fill_param_table, &p);
    *out = NULL;
    tz_status s = check(ctx, job, job->params ? job->params : &p);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &f, 1, sizeof *f);
    if (s != TZ_OK)
        return s;
    f->ctx = ctx;
    f->dim = f->m = 2, f->columns = 1;
    f->domain = job->domain;
    f->field = job->field;
    f->par = job->params ? *job->params : p;
    f->seed = job->seed;
    f->job = *job;
    f->stale = true;
    f->calm = 1;
    what_is_said(f);
    s = tz_power_new(ctx, &f->domain, &f->power);
    if (s == TZ_OK)
        s = tz_fill_guide_init(f);
    if (s == TZ_OK)
        s = tz_fill_models(f);
    if (s == TZ_OK) {
        mean_radius(f);
        s = tz_fill_begin_bodies(f, layout);
    }
    if (s == TZ_OK && job->count == 0)
        s = tz_fill_count(f, &count);
    if (s == TZ_OK)
        s = tz_fill_start_bodies(f, job->count < 0
                                        ? 0
                                        : (int32_t)fmax(job->count == 0 ? 1 : 0,
                                                        floor(count + 0.5) - f->body.n));
    if (s != TZ_OK)
        tz_fill_end(f);
    else
        *out = f;
    return s;
}

/* ---- iterations --------------------------------------------------------------------- */

static tz_status iterate_once(tz_fill *f, tz_fill_energy *e)
{
    double turn[4], place[3] = {0}, graph;
    *e = (tz_fill_energy){0};
    tz_status s = tz_fill_diagram(f);
    if (s != TZ_OK || f->live.n == 0)
        return s;
    tz_fill_release(f);
    f->guided = fmin(fmax(1.5 - f->iteration / 40.0, 0), 1);
    const tz_power_cells cells = tz_power_get(f->power);
    s = tz_fill_neighbours(f, &cells);
    double pair[2];
#define STEP(k, call)                                  \
    if (s == TZ_OK) {                                  \
        s = call;                                      \
        e->before[k] = pair[0], e->after[k] = pair[1]; \
    }
    STEP(0, tz_fill_scale_step(f, pair))
    STEP(1, tz_fill_turn_step(f, pair))
    if (s == TZ_OK && f->job.trace) {
        s = tz_fill_turn_energy(f, turn, false);
        e->align = 2 * turn[0], e->continuity = 2 * turn[1];
        e->rigidity = 2 * turn[2], e->rotation = 2 * turn[3];
    }
    STEP(2, tz_fill_distribution_step(f, &cells, NULL, pair, f->job.trace ? place : NULL))
    STEP(3, tz_fill_graph_step(f, pair, &graph))
#undef STEP
    if (f->job.trace && s == TZ_OK) {
        e->distribution = place[0], e->conflict = place[1], e->border = place[2];
        e->graph = graph;
    }
    f->fresh = false;
    f->iteration++;
    return s;
}

tz_status tz_fill_iterate(tz_fill *f, int32_t iterations, tz_fill_energy *last)
{
    tz_fill_energy e = {0};
    tz_status s = TZ_OK;
    const bool traced = f->job.trace != NULL;
    for (int32_t k = 0; k < iterations && s == TZ_OK; k++) {
        s = tz_ctx_cancelled(f->ctx) ? TZ_CANCELLED : iterate_once(f, &e);
        if (s == TZ_OK && traced && !f->job.trace(f->job.user, f, f->iteration, &e))
            break;
    }
    if (last)
        *last = e;
    return s;
}

/* ---- writing ------------------------------------------------------------------------ */

static tz_status write_body(const tz_fill *f, int32_t i, tz_element_set *to)
{
    const tz_fill_body *b = &f->body.v[i];
    const tz_fill_model *m = &f->model.v[b->model];
    tz_vec2 at;
    double angle, scale;
    tz_fill_pose(f, i, &at, &angle, &scale);
    const int32_t first = to->sample.n, n = to->element.n;
    tz_status s = tz_element_set_place(to, f->job.palette, m->element,
                                       (tz_vec3){at.x, at.y, 0}, angle, scale);
    if (s != TZ_OK)
        return s;
    tz_element *e = &to->element.v[n];
    e->fixed = b->fixed;
    if (m->rigidity >= TZ_FILL_RIGID || m->samples < 2 || b->n < 2)
        return TZ_OK;
    /* the copy on a torus may lie a period away from the discs */
    const tz_vec2 off = {e->at.x - at.x, e->at.y - at.y};
    for (int32_t k = 0; k < m->samples; k++) {
        const tz_vec2 q = tz_fill_to_world(f, i, m->sample[k]);
        to->sample.v[first + k].at = (tz_vec3){q.x + off.x, q.y + off.y, 0};
    }
    return s;
}

tz_status tz_fill_write(const tz_fill *f, tz_element_set *layout)
{
    tz_element_set to = {.domain = layout->domain, .ctx = layout->ctx};
    tz_status s = tz_array_reserve(to.ctx, &to.element, f->body.n);
    if (s == TZ_OK)
        s = tz_array_reserve(to.ctx, &to.sample, f->n);
    for (int32_t i = 0; i < f->body.n && s == TZ_OK; i++) {
        const tz_fill_body *b = &f->body.v[i];
        if (b->gone)
            continue;
        if (b->source < 0) {
            s = write_body(f, i, &to);
            continue;
        }
        tz_element e = f->obstacle.v[b->source];
        const int32_t from = e.sample;
        e.sample = to.sample.n;
        s = tz_array_push(to.ctx, &to.element, e);
        for (int32_t k = 0; k < e.samples && s == TZ_OK; k++)
            s = tz_array_push(to.ctx, &to.sample, f->obstacle_sample.v[from + k]);
    }
    if (s != TZ_OK) {
        tz_element_set_deinit(&to);
        return s;
    }
    tz_array_free(layout->ctx, &layout->element);
    tz_array_free(layout->ctx, &layout->sample);
    memcpy(&layout->element, &to.element, sizeof to.element);
    memcpy(&layout->sample, &to.sample, sizeof to.sample);
    return TZ_OK;
}

/* ---- all at once -------------------------------------------------------------------- */

/* Iterations, with teleportation while there is time to settle after it. */
static tz_status iterate_all(tz_fill *f)
{
    const int32_t n = f->par.iterations;
    tz_status s = TZ_OK;
    tz_progress_begin(f->ctx, "fill", "iterations", n);
    for (int32_t k = 0; k < n && s == TZ_OK; k++) {
        const double late = (k - 0.6 * n) / (0.4 * n);
        if (f->par.start == TZ_FILL_INSERT && late > 0)
            f->calm = exp(-3 * late);
        s = tz_fill_iterate(f, 1, NULL);
        if (s == TZ_OK && f->par.start == TZ_FILL_INSERT && k % 5 == 4 && k < 0.7 * n) {
            s = tz_fill_diagram(f);
            if (s == TZ_OK)
                s = tz_fill_teleport(f, 0.02);
        }
        if (s == TZ_OK && f->par.repair && k % 10 == 9 && k < 0.9 * n)
            s = tz_fill_loosen(f);
        tz_progress_add(f->ctx, 1);
    }
    tz_progress_end(f->ctx);
    f->calm = 1;
    return s;
}

/* An empty domain is no result, unless nothing was asked for. */
static tz_status check_any(const tz_fill *f)
{
    for (int32_t i = 0; i < f->body.n; i++)
        if (!f->body.v[i].gone)
            return TZ_OK;
    if (f->job.count < 0)
        return TZ_OK;
    return tz_fail(f->ctx, TZ_INVALID,
                   "nothing of the palette fits whole into the domain of %g x %g; scale "
                   "the palette down",
                   f->domain.size.x, f->domain.size.y);
}

tz_status tz_fill_run(tz_ctx *ctx, const tz_fill_job *job, tz_element_set *layout,
                      tz_fill_report *report)
{
    struct timespec t0, t1;
    tz_fill *f = NULL;
    timespec_get(&t0, TIME_UTC);
    tz_status s = tz_fill_begin(ctx, job, layout, &f);
    if (s == TZ_OK)
        s = iterate_all(f);
    if (s == TZ_OK && f->par.repair)
        s = tz_fill_repair(f);
    if (s == TZ_OK)
        s = check_any(f);
    if (s == TZ_OK)
        s = tz_fill_write(f, layout);
    timespec_get(&t1, TIME_UTC);
    if (s == TZ_OK && report) {
        *report = (tz_fill_report){0};
        s = tz_fill_measure(ctx, layout, job->palette, job->field, 0, report);
        report->samples = f->n, report->entries = f->entries;
        report->iterations = f->iteration;
        report->moved = f->moved, report->shrunk = f->shrunk;
        report->dropped = f->dropped, report->inserted = f->inserted;
        report->seconds =
            (double)(t1.tv_sec - t0.tv_sec) + 1e-9 * (double)(t1.tv_nsec - t0.tv_nsec);
    }
    tz_fill_end(f);
    return s;
}
