/* SPDX-License-Identifier: Apache-2.0 */
/* AUTO:  quilt ─▶ finish ─┬──────────────────────────▶ likeness ─┐
 *                         └▶ optimise it ─▶ finish ─▶ likeness ─┴▶ the better
 *        if that is poor:    optimise patches ─▶ finish ─▶ likeness ─▶ if better
 *
 * A quilt keeps the exemplar's own lines and is right but for its seams, so the optimiser
 * begins at its finest levels, to mend those and leave the rest. Regular patterns come out
 * of quilting right; whether the optimiser has helped is measured, not assumed. */
#include "curves/curve_arrange.h"

#include <string.h>
#include <time.h>

#include "curves/clip.h"
#include "curves/curve_edit.h"
#include "curves/finish.h"
#include "curves/reconstruct.h"

/* ---- parameters -----------------------------------------------------------------------
 */

#define AT(m) offsetof(tz_curve_arrange_params, m)
static const tz_param rows[] = {
    {"curve-method", TZ_PARAM_ENUM, AT(method), 0, 0, "auto", "", "auto|quilt|optimise",
     "Curves: quilted from pieces of the exemplar, or optimised sample by sample; auto "
     "does both and takes what is more like the exemplar."},
    {"curve-start", TZ_PARAM_ENUM, AT(synthesis.start), 0, 0, "patches", "",
     "patches|noise",
     "Curves: what --curve-method optimise begins with, patches of samples or samples at "
     "random places."},
    {"curve-levels", TZ_PARAM_INT, AT(synthesis.levels), 1, TZ_SAMPLE_LEVELS, "3", "",
     NULL, "Curves: levels of the optimiser, from few samples to many."},
    {"curve-iterations", TZ_PARAM_INT, AT(synthesis.iterations), 0, 1000, "7", "", NULL,
     "Curves: iterations of the optimiser on each level."},
    {"curve-scale", TZ_PARAM_DOUBLE, AT(synthesis.scale), 0.1, 10, "1", "", NULL,
     "Curves: distance of samples and size of neighbourhoods, against the usual ones."},
    {"curve-detail", TZ_PARAM_BOOL, AT(detail), 0, 1, "true", "", NULL,
     "Curves: optimised lines take the shape of the exemplar's lines; without, they run "
     "smoothly through their samples."},
    {"curve-finish", TZ_PARAM_BOOL, AT(finish), 0, 1, "true", "", NULL,
     "Curves: gaps are closed and stubs removed, as far as the exemplar has none."},
    {"curve-patch", TZ_PARAM_DOUBLE, AT(quilt.patch), 0, 1, "0", "", NULL,
     "Curves: side of a quilted piece, in parts of the exemplar's shorter side; 0 = "
     "automatic."},
    {"curve-overlap", TZ_PARAM_DOUBLE, AT(quilt.overlap), 0, 0.45, "0", "", NULL,
     "Curves: by how much quilted pieces overlap, in parts of a piece; 0 = automatic."},
    {"curve-candidates", TZ_PARAM_INT, AT(quilt.candidates), 0, 64, "0", "", NULL,
     "Curves: pieces of the exemplar that are tried for each place; 0 = automatic."},
    {"curve-edges", TZ_PARAM_BOOL, AT(synthesis.edges), 0, 1, "true", "", NULL,
     "Curves: edges between samples count when neighbourhoods are compared."},
    {"curve-robust", TZ_PARAM_BOOL, AT(synthesis.robust), 0, 1, "true", "", NULL,
     "Curves: samples may stay without a partner when neighbourhoods are compared."},
    {"curve-existence", TZ_PARAM_BOOL, AT(synthesis.existence), 0, 1, "true", "", NULL,
     "Curves: the optimiser adds samples that are missing and removes those that are "
     "amiss."},
};
#undef AT
const tz_param_table tz_curve_arrange_param_table = {
    "curves", "Arrangement of curves over a domain.", rows, sizeof rows / sizeof *rows,
    sizeof(tz_curve_arrange_params)};

enum {
    WINDOW = 3,           /* exemplars a side that likeness is measured on, at most */
    MOST_SAMPLES = 30000, /* that AUTO optimises; more are only quilted */
    FEW_SAMPLES = 6000,   /* that AUTO optimises twice */
    MOST_NEIGHBOURS = 64, /* of a sample, likewise */
    GIVEN_LEVELS = 1      /* the finest ones, which a quilt is optimised on */
};
#define MOST_PIECES    2e7
/* bytes a piece, of exemplar and layout: less than it takes in the end, so that nothing is
 * refused that would fit */
#define PIECE_BYTES    300
#define FINISHED_BYTES 700  /* of pieces cut where they cross */
#define MARGIN         0.02 /* by which an optimised layout must be more alike */
#define POOR           1.3 /* unlikeness from which on AUTO also optimises from patches */

typedef struct candidate {
    tz_curve_set set;
    double mean; /* NAN = not measured */
} candidate;

/** `quilted` ends up as what is taken. */
typedef struct work {
    tz_ctx *ctx;
    const tz_curve_arrange_job *job;
    const char *name;
    tz_curve_arrange_params params;
    tz_curve_finish_measure *measure; /* NULL where nothing is finished */
    candidate quilted, optimised;
    tz_curve_arrange_report report;
} work;

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double length_of(const tz_curve_set *s)
{
    double sum = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier c = tz_curve_bezier(s, &s->piece.v[i]);
        sum += tz_bezier_length(&c);
    }
    return sum;
}

/* ---- what is asked for ----------------------------------------------------------------
 */

static tz_status check(const work *w)
{
    const tz_curve_set *e = w->job->exemplar;
    const tz_domain *d = w->job->domain;
    if (e->path.n == 0)
        return tz_fail(w->ctx, TZ_INVALID,
                       e->element.element.n > 0
                           ? "%s: holds elements but no curves; arrange them as elements "
                             "(--as elements)"
                           : "%s: holds no curves; give a drawing with lines in it",
                       w->name);
    const double ew = e->domain.size.x, eh = e->domain.size.y;
    if (!(ew > 0 && eh > 0) || !isfinite(ew) || !isfinite(eh))
        return tz_fail(w->ctx, TZ_INVALID,
                       "%s: its view of %g x %g has no area; give it a viewBox", w->name,
                       ew, eh);
    if (!(d->size.x > 0 && d->size.y > 0) || !isfinite(d->size.x) || !isfinite(d->size.y))
        return tz_fail(w->ctx, TZ_INVALID,
                       "%s: cannot be arranged over %g x %g; give a size above 0",
                       w->name, d->size.x, d->size.y);
    if (d->torus && (d->size.x < 1e-3 * ew || d->size.y < 1e-3 * eh))
        return tz_fail(w->ctx, TZ_INVALID,
                       "%s: a tile of %g x %g is too small for a drawing of %g x %g",
                       w->name, d->size.x, d->size.y, ew, eh);
    const double pieces = e->piece.n * (tz_domain_area(d) / (ew * eh));
    if (!(pieces <= MOST_PIECES))
        return tz_fail(
            w->ctx, TZ_LIMIT,
            "%s: over %g x %g there would be about %.2g pieces of curves, over "
            "%.2g; arrange a smaller part",
            w->name, d->size.x, d->size.y, pieces, MOST_PIECES);
    return TZ_OK;
}

/** Refuses what will not fit into memory before the work begins; knows more once the
 * exemplar is measured. */
static tz_status check_memory(const work *w)
{
    const tz_curve_set *e = w->job->exemplar;
    const tz_domain *d = w->job->domain;
    const bool finished = w->measure;
    const double most = (double)tz_ctx_memory(w->ctx),
                 own = finished ? tz_curve_finish_measure_pieces(w->measure) : e->piece.n,
                 pieces =
                     own * (tz_domain_area(d) / (e->domain.size.x * e->domain.size.y)),
                 bytes = (own + pieces) * (finished ? FINISHED_BYTES : PIECE_BYTES);
    if (!(most > 0) || bytes <= most)
        return TZ_OK;
    return tz_fail(
        w->ctx, TZ_LIMIT,
        "%s: over %g x %g there would be about %.2g pieces of curves%s, which take "
        "more than %.1f GiB of memory; %.1f GiB are allowed; arrange a smaller "
        "part%s, or allow more memory",
        w->name, d->size.x, d->size.y, pieces, finished ? " between crossings" : "",
        bytes / (1 << 30), most / (1 << 30),
        finished ? ", leave gaps open (--no-curve-finish)" : "");
}

/** Whether the optimiser's work stays within reason: few enough samples, and not so many
 * to a neighbourhood that matching would see only the innermost of them. */
static tz_status worth_optimising(work *w, bool *worth)
{
    const tz_curve_set *e = w->job->exemplar;
    const tz_sample_levels l = tz_sample_levels_default(e);
    const double scale = w->params.synthesis.scale,
                 area = e->domain.size.x * e->domain.size.y,
                 spacing = l.spacing[l.levels - 1] * scale,
                 radius = l.radius[l.levels - 1] * scale;
    tz_sample_graph g = {0};
    *worth = false;
    if (length_of(e) / spacing > MOST_SAMPLES || e->piece.n > MOST_SAMPLES)
        return TZ_OK;
    const tz_status s = tz_sample_graph_make(w->ctx, e, spacing, radius, &g);
    if (s != TZ_OK)
        return s;
    *worth = g.sample.n * (tz_domain_area(w->job->domain) / area) <= MOST_SAMPLES &&
             g.sample.n * (TZ_PI * radius * radius / area) <= MOST_NEIGHBOURS;
    tz_sample_graph_deinit(&g);
    return TZ_OK;
}

/* ---- quilting -------------------------------------------------------------------------
 */

static tz_status quilt(work *w)
{
    const tz_curve_arrange_job *j = w->job;
    const tz_curve_quilt_job q = {.exemplar = j->exemplar,
                                  .domain = j->domain,
                                  .given = j->given,
                                  .given_region = j->given_region,
                                  .params = &w->params.quilt,
                                  .seed = j->seed};
    tz_curve_quilt_report r = {0};
    const double start = seconds();
    const tz_status s = tz_curve_quilt(w->ctx, &q, &w->quilted.set, &r);
    if (s == TZ_OK)
        tz_curve_wrap(&w->quilted.set);
    w->report.quilt = seconds() - start;
    w->report.patches = r.patches;
    w->report.crossings = r.crossings;
    w->report.joined = r.joined;
    return s;
}

/* ---- optimising -----------------------------------------------------------------------
 */

/** Takes what was given out of the graph again. */
static tz_status drop_given(tz_sample_graph *g)
{
    int32_t n = 0;
    for (int32_t i = 0; i < g->edge.n; i++) {
        const tz_curve_edge *e = &g->edge.v[i];
        if (!(g->sample.v[e->from].fixed && g->sample.v[e->to].fixed))
            g->edge.v[n++] = *e;
    }
    if (n == g->edge.n)
        return TZ_OK;
    g->edge.n = n;
    return tz_sample_graph_link(g);
}

/** Cut at the border of the domain, and where what is given is complete. */
static tz_status cut(const work *w, const tz_curve_set *whole, tz_curve_set *out)
{
    const tz_domain *d = w->job->domain;
    const tz_curve_window border = {.size = d->torus ? (tz_vec2){0, 0}
                                                     : (tz_vec2){d->size.x, d->size.y},
                                    .region = d->region};
    const tz_curve_window open = {.region = w->job->given_region, .outside = true};
    tz_curve_set inside = {0};
    if (!open.region)
        return tz_curve_clip(w->ctx, whole, &border, out);
    tz_status s = tz_curve_clip(w->ctx, whole, &border, &inside);
    if (s == TZ_OK)
        s = tz_curve_clip(w->ctx, &inside, &open, out);
    tz_curve_set_deinit(&inside);
    return s;
}

static tz_status draw(work *w, const tz_sample_graph *g, const tz_sample_graph *exemplar,
                      tz_curve_set *out)
{
    const tz_curve_set *like = w->job->exemplar;
    tz_curve_set whole = {0};
    tz_status s = w->params.detail
                      ? tz_curve_reconstruct_detail(w->ctx, g, exemplar, like, &whole)
                      : tz_curve_reconstruct(w->ctx, g, like, &whole);
    if (s == TZ_OK) {
        whole.domain = *w->job->domain;
        s = cut(w, &whole, out);
    }
    tz_curve_set_deinit(&whole);
    return s;
}

static tz_status optimise(work *w, const tz_curve_set *start)
{
    const tz_curve_arrange_job *j = w->job;
    tz_curve_synthesis_params p = w->params.synthesis;
    tz_curve_synthesis_job job = {.exemplar = j->exemplar,
                                  .domain = j->domain,
                                  .given = j->given,
                                  .params = &p,
                                  .seed = j->seed,
                                  .trace = j->trace,
                                  .user = j->user};
    tz_sample_graph g = {0}, exemplar = {0};
    tz_element_set elements = {0};
    const double begun = seconds();
    if (start) {
        job.start = start;
        p.start = TZ_CURVE_GIVEN;
        p.levels = p.levels < GIVEN_LEVELS ? p.levels : GIVEN_LEVELS;
    }
    tz_status s = tz_curve_synthesis(w->ctx, &job, &g, &exemplar, &elements);
    if (s == TZ_OK) {
        w->report.samples = g.sample.n;
        s = drop_given(&g);
    }
    if (s == TZ_OK && g.edge.n > 0)
        s = draw(w, &g, &exemplar, &w->optimised.set);
    else if (s == TZ_OK)
        s = tz_curve_set_like(w->ctx, j->exemplar, j->domain, &w->optimised.set);
    if (s == TZ_OK)
        tz_curve_wrap(&w->optimised.set);
    if (s == TZ_OK && elements.element.n > 0) {
        tz_element_set_deinit(&w->optimised.set.element);
        w->optimised.set.element = elements;
        elements = (tz_element_set){0};
    }
    w->report.solve += seconds() - begun;
    tz_element_set_deinit(&elements);
    tz_sample_graph_deinit(&g);
    tz_sample_graph_deinit(&exemplar);
    return s;
}

/* ---- finishing, judging ---------------------------------------------------------------
 */

/** What tells how to finish; once for all that is finished. */
static tz_status measure(work *w)
{
    const double start = seconds();
    const tz_status s =
        tz_curve_finish_measure_new(w->ctx, w->job->exemplar, &w->measure);
    w->report.finish += seconds() - start;
    return s;
}

static tz_status finish(work *w, candidate *c)
{
    const double start = seconds();
    const tz_status s =
        w->measure && c->set.path.n > 0
            ? tz_curve_finish_like(w->ctx, w->measure, w->job->given, &c->set, NULL)
            : TZ_OK;
    w->report.finish += seconds() - start;
    return s;
}

tz_status tz_curve_arrange_judge(tz_ctx *ctx, const tz_curve_set *exemplar,
                                 const tz_curve_set *layout, const tz_curve_set *given,
                                 tz_curve_likeness *out)
{
    const tz_vec3 e = exemplar->domain.size, d = layout->domain.size;
    const tz_domain part = {
        .size = {fmin(d.x, WINDOW * e.x), fmin(d.y, WINDOW * e.y), 0}};
    const bool whole = (part.size.x >= d.x && part.size.y >= d.y) ||
                       layout->domain.region || layout->domain.frames;
    const tz_curve_window window = {
        .at = {0.5 * (d.x - part.size.x), 0.5 * (d.y - part.size.y)},
        .size = {part.size.x, part.size.y}};
    tz_curve_set all = {0}, seen = {0}, moved = {0};
    tz_status s = tz_curve_choose(ctx, layout, NULL, NULL, NULL, (tz_vec2){0, 0}, &all);
    if (s == TZ_OK && given)
        s = tz_curve_append(ctx, &all, given);
    if (s == TZ_OK && !whole)
        s = tz_curve_clip(ctx, &all, &window, &seen);
    if (s == TZ_OK && !whole) {
        seen.domain.torus = false; /* it is a cut-out, and lies as it is */
        s = tz_curve_choose(ctx, &seen, NULL, NULL, &part, tz_vec2_scale(window.at, -1),
                            &moved);
    }
    if (s == TZ_OK)
        s = tz_curve_compare(ctx, exemplar, whole ? &all : &moved, out);
    tz_curve_set_deinit(&all);
    tz_curve_set_deinit(&seen);
    tz_curve_set_deinit(&moved);
    return s;
}

/** What has too little in it to be measured is not: it stays as good as it is. */
static tz_status judge(work *w, candidate *c)
{
    const double start = seconds();
    tz_curve_likeness l;
    tz_status s =
        tz_curve_arrange_judge(w->ctx, w->job->exemplar, &c->set, w->job->given, &l);
    if (s == TZ_OK)
        c->mean = l.mean;
    if (s == TZ_INVALID) {
        s = tz_ctx_cancelled(w->ctx) ? TZ_CANCELLED : TZ_OK;
        if (s == TZ_OK)
            tz_ctx_clear(w->ctx);
    }
    w->report.compare += seconds() - start;
    return s;
}

/* ---- all of it ------------------------------------------------------------------------
 */

/** The better of the two becomes the first. Without a measure that is the quilt. */
static void choose(work *w)
{
    const double than = w->quilted.mean;
    if (!(w->optimised.mean < than - MARGIN))
        return;
    const candidate worse = w->quilted;
    w->quilted = w->optimised;
    w->optimised = worse;
    w->report.optimised = true;
}

/** Optimises, finishes, measures, and keeps it if it is better. */
static tz_status try_optimised(work *w, const tz_curve_set *start)
{
    tz_curve_set_deinit(&w->optimised.set);
    w->optimised = (candidate){.mean = NAN};
    tz_status s = optimise(w, start);
    if (s == TZ_OK)
        s = finish(w, &w->optimised);
    if (s == TZ_OK)
        s = judge(w, &w->optimised);
    if (s == TZ_OK)
        choose(w);
    return s;
}

static tz_status run_auto(work *w)
{
    bool worth = false;
    tz_status s = quilt(w);
    if (s == TZ_OK)
        s = finish(w, &w->quilted);
    if (s == TZ_OK && w->params.method == TZ_CURVES_AUTO)
        s = worth_optimising(w, &worth);
    worth = worth && w->quilted.set.path.n > 0;
    if (s == TZ_OK && (worth || !w->job->unmeasured))
        s = judge(w, &w->quilted);
    if (s == TZ_OK && worth)
        s = try_optimised(w, &w->quilted.set);
    /* what does not quilt well may still come out of samples */
    if (s == TZ_OK && worth && w->quilted.mean > POOR && w->report.samples <= FEW_SAMPLES)
        s = try_optimised(w, NULL);
    return s;
}

static tz_status run_optimise(work *w)
{
    tz_status s = optimise(w, NULL);
    if (s == TZ_OK)
        s = finish(w, &w->optimised);
    if (s == TZ_OK && !w->job->unmeasured)
        s = judge(w, &w->optimised);
    w->quilted = w->optimised;
    w->optimised = (candidate){.mean = NAN};
    w->report.optimised = true;
    return s;
}

/** What is left to the parts is theirs to say. */
static void settle(tz_curve_arrange_params *p)
{
    tz_curve_quilt_params quilt;
    tz_params_default(&tz_curve_quilt_param_table, &quilt);
    if (!(p->quilt.overlap > 0))
        p->quilt.overlap = quilt.overlap;
    if (p->quilt.candidates <= 0)
        p->quilt.candidates = quilt.candidates;
}

tz_status tz_curve_arrange(tz_ctx *ctx, const tz_curve_arrange_job *job,
                           tz_curve_set *out, tz_curve_arrange_report *report)
{
    work w = {.ctx = ctx,
              .job = job,
              .name = job->name ? job->name : "exemplar",
              .quilted.mean = NAN,
              .optimised.mean = NAN};
    *out = (tz_curve_set){0};
    if (job->params)
        w.params = *job->params;
    else
        tz_params_default(&tz_curve_arrange_param_table, &w.params);
    tz_status s = check(&w);
    settle(&w.params);
    if (s == TZ_OK)
        s = check_memory(&w);
    if (s == TZ_OK && w.params.finish) {
        s = measure(&w);
        if (s == TZ_OK)
            s = check_memory(&w);
    }
    if (s == TZ_OK)
        s = w.params.method == TZ_CURVES_OPTIMISE ? run_optimise(&w) : run_auto(&w);
    if (s == TZ_OK) {
        w.report.mean = w.quilted.mean;
        *out = w.quilted.set;
        w.quilted.set = (tz_curve_set){0};
        if (report)
            *report = w.report;
    }
    tz_curve_finish_measure_free(w.measure);
    tz_curve_set_deinit(&w.quilted.set);
    tz_curve_set_deinit(&w.optimised.set);
    return s;
}
