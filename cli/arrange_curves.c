/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/arrange_curves.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/curve_photos.h"
#include "cli/curve_watch.h"
#include "cli/exemplars.h"
#include "cli/figures.h"
#include "curves/curve_edit.h"
#include "curves/predict.h"

#define AT(m) offsetof(tz_curve_draw_params, m)
static const tz_param draw_rows[] = {
    {"given", TZ_PARAM_STRING, AT(given), 0, 0, "", "FILE", NULL,
     "Curves: drawing, in the layout's own units, whose strokes stay as they are and are "
     "arranged around."},
    {"complete", TZ_PARAM_STRING, AT(complete), 0, 0, "", "FILE", NULL,
     "Curves: shape (as for --domain) in which the drawing itself is filled up like the "
     "rest of it; the output is the whole drawing."},
    {"clone", TZ_PARAM_STRING, AT(clone), 0, 0, "", "FILE[,FILE]", NULL,
     "Curves: shape whose strokes are the pattern for another part of the drawing, which "
     "--to (or a second file behind a comma) tells; the output is the whole drawing."},
    {"to", TZ_PARAM_STRING, AT(to), 0, 0, "", "FILE", NULL,
     "Curves: shape that --clone fills."},
};
#undef AT
const tz_param_table tz_curve_draw_param_table = {
    "drawing", "What is drawn already.", draw_rows, sizeof draw_rows / sizeof *draw_rows,
    sizeof(tz_curve_draw_params)};

#define AT(m) offsetof(tz_curve_watch_params, m)
static const tz_param watch_rows[] = {
    {"trace", TZ_PARAM_STRING, AT(trace), 0, 0, "", "FILE", NULL,
     "Curves: table (CSV) of the optimiser's energy after each iteration."},
    {"samples", TZ_PARAM_STRING, AT(samples), 0, 0, "", "FILE", NULL,
     "Curves: picture (SVG) of the optimiser's samples on each level."},
};
#undef AT
const tz_param_table tz_curve_watch_param_table = {
    "watching", "Figures of how curves are optimised.", watch_rows,
    sizeof watch_rows / sizeof *watch_rows, sizeof(tz_curve_watch_params)};

typedef struct run_state {
    tz_cli *cli;
    const tz_curves_job *job;
    tz_record record;
    tz_curve_exemplar e; /* with the files that were read */
    tz_curve_set given, layout;
    tz_guides guides;
    tz_curve_watch watch;
    char from[TZ_PARAM_STRING_SIZE],
        to[TZ_PARAM_STRING_SIZE]; /* regions of the drawing */
    char *path;
} run_state;

/* ---- what the options say -------------------------------------------------------------
 */

/** --clone A --to B, --clone A,B and --complete B as two regions, of which A may be none. */
static tz_status settle_regions(run_state *r)
{
    tz_cli *cli = r->cli;
    const tz_curve_draw_params *d = r->job->draw;
    const char *comma = strchr(d->clone, ',');
    if (*d->complete && *d->clone)
        return tz_cli_usage(cli, "--complete and --clone exclude each other");
    if (*d->to && !*d->clone)
        return tz_cli_usage(cli, "--to tells where --clone draws; there is no --clone");
    if (!*d->clone) {
        snprintf(r->to, sizeof r->to, "%s", d->complete);
        return TZ_OK;
    }
    if (*d->to) {
        snprintf(r->from, sizeof r->from, "%s", d->clone);
        snprintf(r->to, sizeof r->to, "%s", d->to);
        return TZ_OK;
    }
    if (!comma || comma == d->clone || !comma[1])
        return tz_cli_usage(cli,
                            "--clone: give two shapes, --clone FROM.svg --to TO.svg");
    snprintf(r->from, sizeof r->from, "%.*s", (int)(comma - d->clone), d->clone);
    snprintf(r->to, sizeof r->to, "%s", comma + 1);
    return TZ_OK;
}

static tz_status check_options(run_state *r)
{
    tz_cli *cli = r->cli;
    const tz_guide_params *g = r->job->guides;
    const bool foretells = *r->to != 0;
    if (cli->operands != 1)
        return tz_cli_usage(cli, "curves are arranged from one drawing; put several "
                                 "exemplars into one SVG");
    if (foretells && !tz_path_is_svg(cli->operand[0]))
        return tz_fail(
            cli->ctx, TZ_INVALID,
            "%s: --complete and --clone draw into drawings; find the lines of a "
            "photo with analyze --as curves first",
            cli->operand[0]);
    if (*r->job->keep)
        return tz_cli_usage(cli, "--keep is for elements and edges; strokes of curves "
                                 "stay with --given");
    if (*g->zones || *g->zone_kinds || *g->textures || *g->brush)
        return tz_cli_usage(cli, "%s is for elements; curves take --domain and --field",
                            *g->textures ? "--textures"
                            : *g->brush  ? "--brush"
                                         : "--zones");
    if (foretells && (*g->domain || *g->field || *g->directions || *g->sizes ||
                      *g->densities || *r->job->draw->given))
        return tz_cli_usage(cli,
                            "%s: the drawing itself is worked on with --complete and "
                            "--clone",
                            *g->domain             ? "--domain"
                            : *r->job->draw->given ? "--given"
                                                   : "--field");
    if (foretells && (*r->job->watch->trace || *r->job->watch->samples))
        return tz_cli_usage(cli, "--trace and --samples watch whole layouts, not "
                                 "--complete and --clone");
    return TZ_OK;
}

/** Curves of a drawing, or the lines of a photo. */
static tz_status read_exemplar(run_state *r)
{
    tz_cli *cli = r->cli;
    const char *path = cli->operand[0];
    if (tz_path_is_svg(path))
        return tz_curves_read(cli, path, r->job->input,
                              !*r->job->draw->complete && !*r->job->draw->clone,
                              &r->record, &r->e.inputs, &r->e.set);
    const tz_status s =
        tz_curve_exemplar_find(cli, path, r->job->lines, &r->record, &r->e);
    return s == TZ_OK && r->e.set.path.n == 0
               ? tz_fail(cli->ctx, TZ_INVALID,
                         "%s: no lines stand out in it; try --line edge, or --as edges",
                         path)
               : s;
}

/** The layout's size: as given, else the exemplar's times `grow`, in whole units; of
 * predictions, the drawing's. */
static tz_status settle_size(run_state *r, tz_domain *d)
{
    tz_cli *cli = r->cli;
    tz_arrange_params *a = r->job->arrange;
    const tz_vec3 size = r->e.set.domain.size;
    if (*r->to) {
        *d = r->e.set.domain;
        return TZ_OK;
    }
    if (!tz_cli_given(cli, "size")) {
        const double w = fmax(1, rint(size.x * r->job->grow)),
                     h = fmax(1, rint(size.y * r->job->grow));
        if (!(w <= TZ_IMAGE_MAX_SIDE && h <= TZ_IMAGE_MAX_SIDE))
            return tz_fail(cli->ctx, TZ_LIMIT,
                           "%s: %g times %g x %g units is too large; give a --size of at "
                           "most %d a side",
                           cli->operand[0], r->job->grow, size.x, size.y,
                           TZ_IMAGE_MAX_SIDE);
        a->size[0] = (int32_t)w;
        a->size[1] = (int32_t)h;
    }
    *d = (tz_domain){.size = {a->size[0], a->size[1], 0}, .torus = a->tile};
    return TZ_OK;
}

static tz_status name_output(run_state *r, const tz_domain *d)
{
    tz_cli *cli = r->cli;
    const tz_curves_job *j = r->job;
    char stem[TZ_PARAM_STRING_SIZE];
    tz_curve_format format;
    tz_path_list outputs = {0};
    const char *const watch[2] = {j->watch->trace, j->watch->samples};
    tz_path_stem(cli->operand[0], stem, sizeof stem);
    const tz_name_values names = {stem,
                                  j->format->format == TZ_CURVE_FORMAT_DXF ? "dxf"
                                                                           : "svg",
                                  "layout",
                                  j->arrange->seed,
                                  (int32_t)fmin(1e9, rint(d->size.x)),
                                  (int32_t)fmin(1e9, rint(d->size.y))};
    tz_status s = tz_name_expand(cli->ctx, j->output, &names, &r->path);
    if (s != TZ_OK)
        return s;
    cli->piped = strcmp(r->path, "-") == 0;
    if (cli->piped && cli->common->json)
        s = tz_cli_usage(cli, "--json and the layout both want standard output");
    if (s == TZ_OK)
        s = tz_curves_format(cli, r->path, j->format, &format);
    if (s == TZ_OK)
        s = tz_guides_paths(cli, j->guides, &r->e.inputs);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &outputs, r->path);
    for (int i = 0; i < 2 && s == TZ_OK; i++)
        if (*watch[i])
            s = tz_paths_add(cli->ctx, &outputs, watch[i]);
    if (s == TZ_OK)
        s = tz_curve_exemplar_name_plate(cli, r->path, &outputs, &r->e);
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &r->e.inputs, &outputs);
    tz_paths_free(cli->ctx, &outputs);
    return s;
}

/* ---- layouts --------------------------------------------------------------------------
 */

static tz_status read_given(run_state *r, const tz_domain *d)
{
    const char *path = r->job->draw->given;
    if (!*path)
        return TZ_OK;
    tz_status s = tz_curves_read(r->cli, path, r->job->input, false, &r->record,
                                 &r->e.inputs, &r->given);
    if (s != TZ_OK)
        return s;
    const tz_vec3 size = r->given.domain.size;
    if (size.x > d->size.x || size.y > d->size.y)
        return tz_fail(r->cli->ctx, TZ_INVALID,
                       "--given: %s is %g x %g, larger than the layout of %g x %g", path,
                       size.x, size.y, d->size.x, d->size.y);
    r->given.domain = *d;
    r->given.element.domain = *d;
    tz_curve_wrap(&r->given);
    return TZ_OK;
}

static void tell(const run_state *r, const tz_curve_arrange_report *report)
{
    tz_cli *cli = r->cli;
    char why[160], mean[48] = "";
    if (isfinite(report->mean)) {
        snprintf(mean, sizeof mean, "; unlikeness %.2f", report->mean);
        json_object_set_new(cli->figures, "mean", json_real(report->mean));
    }
    if (report->optimised)
        snprintf(why, sizeof why, "%d samples optimised%s%s", report->samples,
                 report->patches ? " from a quilt" : "", mean);
    else
        snprintf(why, sizeof why, "quilted from %d pieces, %d of %d ends joined%s",
                 report->patches, report->joined, report->crossings, mean);
    tz_figures_text(cli, "as", "curves");
    tz_figures_text(cli, "why", why);
    tz_figures_seconds(cli, "quilt", report->quilt);
    tz_figures_seconds(cli, "solve", report->solve);
    tz_figures_seconds(cli, "finish", report->finish);
    tz_figures_seconds(cli, "compare", report->compare);
    tz_figures_count(cli, "patches", report->patches);
    tz_figures_count(cli, "samples", report->samples);
    tz_figures_count(cli, "optimised", report->optimised);
}

static tz_status arrange(run_state *r, const tz_domain *d)
{
    tz_cli *cli = r->cli;
    const tz_curves_job *j = r->job;
    const bool watched = *j->watch->trace || *j->watch->samples;
    tz_curve_arrange_report report = {0};
    r->watch.ctx = cli->ctx;
    const tz_curve_arrange_job job = {.exemplar = &r->e.set,
                                      .name = cli->operand[0],
                                      .domain = d,
                                      .given = r->given.path.n ? &r->given : NULL,
                                      .params = j->curves,
                                      .seed = j->arrange->seed,
                                      .trace = watched ? tz_curve_watch_see : NULL,
                                      .user = &r->watch};
    tz_status s = tz_curve_arrange(cli->ctx, &job, &r->layout, &report);
    if (s == TZ_OK && *j->draw->given) { /* the layout is shown with what it is around */
        tz_curve_set all = r->given;
        r->given = (tz_curve_set){0};
        s = tz_curve_append(cli->ctx, &r->layout, &all);
        tz_curve_set_deinit(&all);
    }
    if (s == TZ_OK && watched && report.samples == 0)
        tz_warn(cli->ctx, "--trace, --samples: nothing was optimised (--curve-method)");
    if (s == TZ_OK && *j->watch->trace)
        s = tz_curve_watch_table(&r->watch, j->watch->trace);
    if (s == TZ_OK && *j->watch->samples)
        s = tz_curve_watch_picture(&r->watch, j->watch->samples);
    if (s == TZ_OK)
        tell(r, &report);
    return s;
}

/* ---- predictions ----------------------------------------------------------------------
 */

static tz_status read_region(run_state *r, const char *path, tz_region **out)
{
    const tz_domain *d = &r->e.set.domain;
    tz_status s = tz_record_input(r->cli, &r->record, path, NULL);
    return s == TZ_OK ? tz_region_read(r->cli->ctx, tz_cli_find(r->cli, path), d->size,
                                       d->torus, out)
                      : s;
}

/** The drawing, completed: everything that is foretold is taken. */
static tz_status foretell(run_state *r)
{
    tz_cli *cli = r->cli;
    tz_region *from = NULL, *to = NULL;
    tz_curve_prediction p = {0};
    tz_status s = *r->from ? read_region(r, r->from, &from) : TZ_OK;
    if (s == TZ_OK)
        s = read_region(r, r->to, &to);
    if (s != TZ_OK)
        goto done;
    const tz_curve_predict_job job = {.drawing = &r->e.set,
                                      .from = from,
                                      .to = to,
                                      .params = r->job->curves,
                                      .seed = r->job->arrange->seed};
    const double start = tz_seconds();
    s = tz_curve_predict(cli->ctx, &job, &p);
    if (s == TZ_OK) {
        tz_figures_count(cli, "foretold", p.set.path.n);
        tz_curve_predict_mark(&p, NULL, TZ_CURVE_TAKEN);
        s = tz_curve_predict_accept(cli->ctx, &p, &r->e.set);
    }
    if (s == TZ_OK) {
        r->layout = r->e.set;
        r->e.set = (tz_curve_set){0};
        tz_figures_seconds(cli, "predict", tz_seconds() - start);
    }
done:
    tz_curve_prediction_deinit(&p);
    tz_region_free(from);
    tz_region_free(to);
    return s;
}

static tz_status paths_of_regions(run_state *r)
{
    const char *const file[2] = {r->from, r->to};
    tz_status s = TZ_OK;
    for (int i = 0; i < 2 && s == TZ_OK; i++)
        if (*file[i])
            s = tz_paths_add(r->cli->ctx, &r->e.inputs, tz_cli_find(r->cli, file[i]));
    return s;
}

/* ---- all of it ------------------------------------------------------------------------
 */

static tz_status write_layout(run_state *r)
{
    tz_cli *cli = r->cli;
    tz_free(r->layout.ctx, r->layout.recipe);
    r->layout.recipe = NULL;
    const tz_status s =
        tz_record_text(cli, &r->record, NULL, "layout", &r->layout.recipe);
    return s == TZ_OK ? tz_curves_write(cli, r->path, r->job->format, &r->layout) : s;
}

tz_status tz_arrange_curves(tz_cli *cli, const tz_curves_job *job)
{
    run_state r = {.cli = cli, .job = job, .watch = {.ctx = cli->ctx}};
    tz_domain d = {.torus = false};
    tz_status s = settle_regions(&r);
    if (s == TZ_OK)
        s = check_options(&r);
    if (s == TZ_OK)
        s = read_exemplar(&r);
    if (s == TZ_OK)
        s = settle_size(&r, &d);
    if (s == TZ_OK)
        s = paths_of_regions(&r);
    if (s == TZ_OK)
        s = read_given(&r, &d);
    if (s == TZ_OK)
        s = name_output(&r, &d);
    if (s == TZ_OK)
        s = tz_guides_read(cli, job->guides, &r.e.set.element, &r.record, &d, &r.guides);
    if (s == TZ_OK)
        s = tz_guides_only_turn(cli, &r.guides);
    if (s == TZ_OK)
        s = tz_curve_exemplar_write_plate(cli, &r.e);
    if (s == TZ_OK)
        s = *r.to ? foretell(&r) : arrange(&r, &d);
    if (s == TZ_OK)
        s = write_layout(&r);
    tz_curve_set_deinit(&r.layout);
    tz_curve_set_deinit(&r.given);
    tz_curve_watch_deinit(&r.watch);
    tz_guides_free(&r.guides);
    tz_curve_exemplar_free(cli, &r.e);
    tz_record_free(cli, &r.record);
    tz_free(cli->ctx, r.path);
    return s;
}
