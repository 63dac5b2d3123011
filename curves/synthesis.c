/* SPDX-License-Identifier: Apache-2.0 */
/* The optimisation from above: levels, in each of them search and assignment by turns.
 *
 * What is synthesised reaches beyond the border of a plain domain, or of a region, by
 * three fifths of the first level's radius (35 px of the paper's), so that the border is
 * as good as the rest; of what lies there only edges that touch the inside are kept.
 * @source [Tu20] Sec. 4.3 */
#include "curves/synthesis.h"

#include <string.h>
#include <time.h>

#include "curves/synthesis_internal.h"

#define MARGIN 0.6  /* radii of the first level */
#define FINEST 0.25 /* of the default spacing */

static const tz_param rows[] = {
    {"start", TZ_PARAM_ENUM, offsetof(tz_curve_synthesis_params, start), 0, 2, "patches",
     "", "patches|noise|given",
     "What is optimised: patches of the exemplar, samples at random, or curves that are "
     "there"},
    {"levels", TZ_PARAM_INT, offsetof(tz_curve_synthesis_params, levels), 1,
     TZ_SAMPLE_LEVELS, "3", "", NULL,
     "Levels from coarse to fine; fewer are quicker and keep less of large shapes"},
    {"iterations", TZ_PARAM_INT, offsetof(tz_curve_synthesis_params, iterations), 0, 1000,
     "7", "", NULL, "How often all samples of a level are matched and moved"},
    {"scale", TZ_PARAM_DOUBLE, offsetof(tz_curve_synthesis_params, scale), 0.1, 10, "1",
     "", NULL,
     "Size of what is matched: spacings of samples and radii of neighbourhoods"},
    {"edges", TZ_PARAM_BOOL, offsetof(tz_curve_synthesis_params, edges), 0, 1, "true", "",
     NULL, "Lines between samples count in matching"},
    {"robust", TZ_PARAM_BOOL, offsetof(tz_curve_synthesis_params, robust), 0, 1, "true",
     "", NULL, "Samples that fit nowhere may stay without a match"},
    {"existence", TZ_PARAM_BOOL, offsetof(tz_curve_synthesis_params, existence), 0, 1,
     "true", "", NULL, "Samples that are missing are added, those too many removed"},
};

const tz_param_table tz_curve_synthesis_param_table = {
    "curve-synthesis", "Curves arranged by optimisation of a graph of samples", rows,
    sizeof rows / sizeof rows[0], sizeof(tz_curve_synthesis_params)};

/* ---- one iteration ------------------------------------------------------------------ */

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static tz_curve_energy energy_of(const tz_curve_solve *t)
{
    tz_curve_energy e = {.level = t->level,
                         .iteration = t->iteration,
                         .samples = t->o.sample.n,
                         .edges = t->o.edge.n};
    for (int32_t i = 0; i < t->o.sample.n; i++) {
        const double depth = tz_curve_solve_depth(t, t->o.sample.v[i].at);
        e.match += isfinite(t->cost[i]) ? (double)t->cost[i] : 0;
        e.domain += depth < 0 ? depth * depth : 0;
    }
    e.neighbours = e.samples > 0 ? (double)t->m.ho.first[e.samples] / e.samples : 0;
    e.mean = e.samples > 0 ? e.match / (e.samples * t->o.spacing) : 0;
    return e;
}

/* Samples that stay, moved, and those that come. */
static tz_status next_samples(tz_curve_solve *t, tz_sample_graph *next, int32_t *to)
{
    int32_t n = 0;
    tz_status s =
        tz_array_reserve(t->ctx, &next->sample, (int64_t)t->o.sample.n + t->extra.n);
    for (int32_t i = 0; i < t->o.sample.n && s == TZ_OK; i++) {
        to[i] = t->drop[i] ? -1 : n;
        if (t->drop[i])
            continue;
        tz_curve_sample p = t->o.sample.v[i];
        p.at = tz_curve_wrapped(t->job->domain, tz_vec2_add(p.at, t->move[i]));
        t->match.v[n++] = t->match.v[i];
        s = tz_array_push(t->ctx, &next->sample, p);
    }
    t->match.n = n;
    for (int32_t i = 0; i < t->extra.n && s == TZ_OK; i++)
        if (t->extra.v[i].q == TZ_SAMPLE_CURVE) {
            s = tz_array_push(t->ctx, &next->sample, t->extra.v[i]);
            if (s == TZ_OK)
                s = tz_array_push(t->ctx, &t->match, t->extra.v[i].turn);
        }
    return s;
}

/* The graph that the votes make. */
static tz_status rebuild(tz_curve_solve *t)
{
    tz_sample_graph next = {.ctx = t->ctx,
                            .domain = t->o.domain,
                            .spacing = t->o.spacing,
                            .radius = t->o.radius};
    int32_t *to = NULL;
    tz_status s = tz_alloc(t->ctx, &to, (size_t)t->o.sample.n, sizeof *to);
    if (s == TZ_OK)
        s = next_samples(t, &next, to);
    if (s == TZ_OK)
        s = tz_curve_solve_turns(t, &next);
    for (int32_t i = 0; i < t->edge.n && s == TZ_OK; i++) {
        tz_curve_edge e = t->edge.v[i];
        e.from = to[e.from];
        e.to = to[e.to];
        s = tz_array_push(t->ctx, &next.edge, e);
    }
    if (s == TZ_OK)
        s = tz_sample_graph_link(&next);
    if (s == TZ_OK) {
        const tz_sample_graph old = t->o;
        t->o = next;
        next = old;
    }
    tz_sample_graph_deinit(&next);
    tz_free(t->ctx, to);
    for (int32_t i = 0; i < t->extra.n && s == TZ_OK; i++)
        if (t->extra.v[i].q != TZ_SAMPLE_CURVE)
            s = tz_curve_solve_place(t, t->extra.v[i].turn, t->extra.v[i].at);
    return s;
}

static tz_status iterate(tz_curve_solve *t)
{
    tz_curve_energy e = {0};
    const double begun = seconds();
    tz_status s = tz_curve_solve_search(t, t->iteration == 0 ? 5 : 2);
    const double searched = seconds();
    if (s == TZ_OK)
        e = energy_of(t);
    if (s == TZ_OK)
        s = tz_curve_solve_votes(t);
    if (s == TZ_OK)
        s = tz_curve_solve_positions(t);
    if (s == TZ_OK)
        s = tz_curve_solve_existence(t);
    if (s == TZ_OK)
        s = tz_curve_solve_edges(t);
    if (s == TZ_OK)
        s = tz_curve_solve_pens(t);
    if (s == TZ_OK)
        s = rebuild(t);
    if (s == TZ_OK)
        s = tz_curve_solve_shapes(t);
    tz_curve_solve_forget(t);
    e.search = searched - begun;
    e.assign = seconds() - searched;
    if (s == TZ_OK && t->job->trace)
        t->job->trace(t->job->user, &e, &t->o);
    return s;
}

static tz_status run_level(tz_curve_solve *t)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < t->p.iterations && t->o.sample.n > 0 && s == TZ_OK; i++) {
        t->iteration = i;
        t->last = i + 1 == t->p.iterations;
        s = tz_ctx_cancelled(t->ctx) ? TZ_CANCELLED : iterate(t);
        tz_progress_add(t->ctx, 1);
    }
    return s;
}

/* ---- the end ------------------------------------------------------------------------ */

/* Samples inside, those that an edge joins with one inside, and no lone ones. */
static tz_status cut_margin(tz_curve_solve *t, tz_sample_graph *out)
{
    int32_t *to = NULL;
    const tz_sample_graph *g = &t->o;
    tz_status s = tz_alloc(t->ctx, &to, (size_t)g->sample.n, sizeof *to);
    *out = (tz_sample_graph){
        .ctx = t->ctx, .domain = g->domain, .spacing = g->spacing, .radius = g->radius};
    for (int32_t i = 0; i < g->sample.n && s == TZ_OK; i++) {
        const tz_curve_sample *p = &g->sample.v[i];
        bool keep = tz_curve_solve_depth(t, p->at) > t->margin &&
                    (p->links > 0 || p->element >= 0);
        for (int32_t k = p->link; k < p->link + p->links && !keep; k++)
            keep = tz_curve_solve_depth(t, g->sample.v[g->link.v[k].to].at) > t->margin;
        to[i] = keep ? out->sample.n : -1;
        if (!keep)
            continue;
        tz_curve_sample q = *p;
        q.turn = out->turn.n;
        for (int32_t k = 0; k < p->turns && s == TZ_OK; k++)
            s = tz_array_push(t->ctx, &out->turn, g->turn.v[p->turn + k]);
        if (s == TZ_OK)
            s = tz_array_push(t->ctx, &out->sample, q);
    }
    for (int32_t i = 0; i < g->edge.n && s == TZ_OK; i++) {
        tz_curve_edge e = g->edge.v[i];
        e.from = to[e.from];
        e.to = to[e.to];
        if (e.from >= 0 && e.to >= 0)
            s = tz_array_push(t->ctx, &out->edge, e);
    }
    if (s == TZ_OK)
        s = tz_sample_graph_link(out);
    if (s != TZ_OK)
        tz_sample_graph_deinit(out);
    tz_free(t->ctx, to);
    return s;
}

static void release(tz_curve_solve *t)
{
    tz_curve_solve_forget(t);
    tz_sample_graph_deinit(&t->o);
    tz_array_free(t->ctx, &t->match);
    tz_array_free(t->ctx, &t->body);
    tz_array_free(t->ctx, &t->extra);
    tz_array_free(t->ctx, &t->edge);
}

static tz_status check(tz_ctx *ctx, const tz_curve_synthesis_job *job,
                       const tz_curve_synthesis_params *p)
{
    const tz_vec3 d = job->domain->size, e = job->exemplar->domain.size;
    if (!(d.x > 0) || !(d.y > 0) || !isfinite(d.x) || !isfinite(d.y))
        return tz_fail(ctx, TZ_INVALID,
                       "a domain of %g x %g has no area; give it a size above 0", d.x,
                       d.y);
    if (!(e.x > 0) || !(e.y > 0) || !isfinite(e.x) || !isfinite(e.y))
        return tz_fail(ctx, TZ_INVALID, "the exemplar's size of %g x %g has no area", e.x,
                       e.y);
    if (p->start == TZ_CURVE_GIVEN && !job->start)
        return tz_fail(ctx, TZ_INVALID,
                       "there are no curves to start from; name some, or "
                       "choose another start");
    if (p->levels < 1 || p->levels > TZ_SAMPLE_LEVELS || p->iterations < 0 ||
        !(p->scale > 0) || !isfinite(p->scale))
        return tz_fail(ctx, TZ_INVALID,
                       "%d levels of %d iterations at a scale of %g cannot be", p->levels,
                       p->iterations, p->scale);
    return TZ_OK;
}

/* Lines that lie closer than the finest spacing are sampled finer, so that samples know
 * which line they are of: the spacing is no more than what a line has to itself, area over
 * length. */
static double fineness(const tz_curve_set *s, double spacing)
{
    double length = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier c = tz_curve_bezier(s, &s->piece.v[i]);
        length += tz_bezier_length(&c);
    }
    const double room = s->domain.size.x * s->domain.size.y / length;
    return length > 0 ? fmin(fmax(room / spacing, FINEST), 1) : 1;
}

/* The last ones of the default levels. The finest one's spacing is made to fit the
 * drawing, the coarsest keeps its own, to see large shapes. */
static tz_sample_levels choose_levels(const tz_curve_set *exemplar,
                                      const tz_curve_synthesis_params *p)
{
    tz_sample_levels l = tz_sample_levels_default(exemplar);
    const int32_t skip = l.levels - p->levels;
    const double fine = fineness(exemplar, l.spacing[l.levels - 1]);
    for (int32_t i = 0; i < p->levels; i++) {
        const double share = (i + skip) / (double)(l.levels - 1);
        const double f = p->scale * pow(fine, share);
        l.spacing[i] = f * l.spacing[i + skip];
        l.radius[i] = f * l.radius[i + skip];
    }
    l.levels = p->levels;
    return l;
}

static tz_status run(tz_curve_solve *t, tz_curve_model x[2])
{
    tz_status s = TZ_OK;
    for (t->level = 0; t->level < t->levels.levels && s == TZ_OK; t->level++) {
        tz_curve_model *now = &x[t->level & 1], *before = &x[(t->level & 1) ^ 1];
        tz_curve_model_deinit(now);
        s = tz_curve_model_init(t->ctx, t->job->exemplar, t->levels.spacing[t->level],
                                t->levels.radius[t->level], now);
        if (s != TZ_OK)
            break;
        t->x = now;
        s = t->level == 0 ? tz_curve_solve_start(t) : tz_curve_solve_refine(t, before);
        if (s == TZ_OK)
            s = run_level(t);
    }
    return s;
}

tz_status tz_curve_synthesis(tz_ctx *ctx, const tz_curve_synthesis_job *job,
                             tz_sample_graph *out, tz_sample_graph *exemplar_graph,
                             tz_element_set *elements)
{
    tz_curve_model x[2] = {{.ctx = ctx}, {.ctx = ctx}};
    tz_curve_solve t = {.ctx = ctx, .job = job};
    tz_sample_graph graph = {0};
    tz_element_set set = {0};
    memset(out, 0, sizeof *out);
    if (exemplar_graph)
        memset(exemplar_graph, 0, sizeof *exemplar_graph);
    if (elements)
        memset(elements, 0, sizeof *elements);
    if (job->params)
        t.p = *job->params;
    else
        tz_params_default(&tz_curve_synthesis_param_table, &t.p);
    tz_status s = check(ctx, job, &t.p);
    if (s != TZ_OK)
        return s;
    t.levels = choose_levels(job->exemplar, &t.p);
    t.margin =
        job->domain->torus && !job->domain->region ? 0 : MARGIN * t.levels.radius[0];
    tz_progress_begin(ctx, "curves", "iterations",
                      (int64_t)t.levels.levels * t.p.iterations);
    s = run(&t, x);
    if (s == TZ_OK)
        s = cut_margin(&t, &graph);
    if (s == TZ_OK && elements)
        s = tz_curve_solve_elements(&t, &set);
    tz_progress_end(ctx);
    if (s == TZ_OK) {
        *out = graph;
        if (elements)
            *elements = set;
        if (exemplar_graph) {
            tz_curve_model *fine = &x[(t.levels.levels - 1) & 1];
            *exemplar_graph = fine->g;
            memset(&fine->g, 0, sizeof fine->g);
        }
    }
    release(&t);
    tz_curve_model_deinit(&x[0]);
    tz_curve_model_deinit(&x[1]);
    return s;
}
