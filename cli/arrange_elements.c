/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/arrange_elements.h"

#include <math.h>
#include <string.h>

#include "cli/figures.h"
#include "cli/material.h"
#include "elements/element_io.h"
#include "synthesis/element_ground.h"

typedef struct run_state {
    tz_cli *cli;
    const tz_elements_job *job;
    tz_record record;
    tz_element_exemplar exemplar;
    tz_element_set layout, kept;
    tz_guides guides;
    char *path;
} run_state;

/* ---- what is kept -------------------------------------------------------------------- */

static bool same_tables(const tz_element_set *a, const tz_element_set *b)
{
    bool same = a->kind.n == b->kind.n && a->symbol.n == b->symbol.n;
    for (int32_t i = 0; same && i < a->kind.n; i++)
        same = strcmp(a->kind.v[i].name, b->kind.v[i].name) == 0;
    for (int32_t i = 0; same && i < a->symbol.n; i++)
        same = strcmp(a->symbol.v[i].id, b->symbol.v[i].id) == 0;
    return same;
}

/** Reads the layout to keep; it sets the size. */
static tz_status read_kept(run_state *r, tz_domain *d)
{
    tz_cli *cli = r->cli;
    const char *path = r->job->keep;
    if (!*path)
        return TZ_OK;
    tz_status s = tz_elements_read(cli, path, r->job->medium, 0, &r->record, &r->kept);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &r->exemplar.inputs, tz_cli_find(cli, path));
    if (s == TZ_OK && !same_tables(&r->exemplar.set, &r->kept))
        s = tz_fail(cli->ctx, TZ_INVALID,
                    "--keep: %s was made from another exemplar than %s, or with other "
                    "classes; give the one that it was made from",
                    path, cli->operand[0]);
    if (s == TZ_OK && tz_cli_given(cli, "size") &&
        (d->size.x != r->kept.domain.size.x || d->size.y != r->kept.domain.size.y))
        s = tz_fail(cli->ctx, TZ_INVALID,
                    "--size %gx%g: the layout to keep, %s, is %g x %g; leave --size out",
                    d->size.x, d->size.y, path, r->kept.domain.size.x,
                    r->kept.domain.size.y);
    if (s == TZ_OK)
        *d = (tz_domain){.size = r->kept.domain.size, .torus = r->kept.domain.torus};
    return s;
}

/** Brushes work on all that is there; else what was placed by hand stays and the rest is
 * arranged anew. */
static tz_status put_kept(run_state *r)
{
    const bool all = *r->job->guides->brush != 0;
    tz_element_set *to = &r->layout;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < r->kept.element.n && s == TZ_OK; i++) {
        tz_element e = r->kept.element.v[i];
        const int32_t first = e.sample;
        if (!(all || e.fixed))
            continue;
        if (e.source >= r->exemplar.set.element.n)
            e.source = -1;
        e.sample = to->sample.n;
        for (int32_t k = 0; k < e.samples && s == TZ_OK; k++)
            s = tz_array_push(r->cli->ctx, &to->sample, r->kept.sample.v[first + k]);
        if (s == TZ_OK)
            s = tz_array_push(r->cli->ctx, &to->element, e);
    }
    return s;
}

static tz_status name_output(run_state *r, const tz_domain *d)
{
    tz_cli *cli = r->cli;
    char stem[TZ_PARAM_STRING_SIZE];
    tz_path_list outputs = {0};
    tz_path_stem(cli->operand[0], stem, sizeof stem);
    const tz_name_values names = {stem,
                                  "svg",
                                  "layout",
                                  r->job->arrange->seed,
                                  (int32_t)fmin(1e9, rint(d->size.x)),
                                  (int32_t)fmin(1e9, rint(d->size.y))};
    tz_status s = tz_name_expand(cli->ctx, r->job->output, &names, &r->path);
    if (s != TZ_OK)
        return s;
    cli->piped = strcmp(r->path, "-") == 0;
    if (cli->piped && cli->common->json)
        s = tz_cli_usage(cli, "--json and the layout both want standard output");
    if (s == TZ_OK)
        s = tz_element_write_check(cli->ctx, r->path);
    if (s == TZ_OK)
        s = tz_guides_paths(cli, r->job->guides, &r->exemplar.inputs);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &outputs, r->path);
    if (s == TZ_OK)
        s = tz_element_exemplar_name_plate(cli, r->path, &outputs, &r->exemplar);
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &r->exemplar.inputs, &outputs);
    tz_paths_free(cli->ctx, &outputs);
    return s;
}

static tz_status arrange(run_state *r)
{
    tz_cli *cli = r->cli;
    tz_element_arrange_report report;
    tz_element_arrange_job job = {.exemplar = &r->exemplar.set,
                                  .name = cli->operand[0],
                                  .params = r->job->elements,
                                  .seed = r->job->arrange->seed};
    tz_guides_apply(&r->guides, &job);
    tz_status s = tz_element_arrange(cli->ctx, &job, &r->layout, &report);
    if (s != TZ_OK)
        return s;
    tz_figures_seconds(cli, "grow", report.grow);
    tz_figures_seconds(cli, "solve", report.solve);
    tz_figures_count(cli, "placements", report.elements);
    tz_figures_count(cli, "percent_filled", (int64_t)rint(100 * report.filled));
    return TZ_OK;
}

/** Ground beneath things of a photo, in documents that show it. */
static tz_status lay_ground(run_state *r, const tz_domain *d)
{
    tz_cli *cli = r->cli;
    tz_layout ground = {0};
    if (!tz_path_is_svg(r->path) && strcmp(r->path, "-") != 0)
        return TZ_OK;
    tz_status s = tz_element_exemplar_ground(cli, &r->exemplar, r->job->analyze, d,
                                             r->job->arrange->seed, &ground);
    if (s == TZ_OK && ground.place.n > 0)
        s = tz_element_ground_embed(cli->ctx, r->path, &ground, &r->layout);
    tz_layout_deinit(&ground);
    return s;
}

static tz_status write_layout(run_state *r, const tz_domain *d)
{
    tz_cli *cli = r->cli;
    const double start = tz_seconds();
    tz_status s = tz_record_text(cli, &r->record, NULL, "layout", &r->layout.recipe);
    if (s == TZ_OK)
        s = tz_element_write(cli->ctx, r->path, &r->layout);
    if (s != TZ_OK)
        return s;
    tz_figures_seconds(cli, "write", tz_seconds() - start);
    tz_figures_output(cli, r->path, "layout", (int32_t)fmin(2e9, rint(d->size.x)),
                      (int32_t)fmin(2e9, rint(d->size.y)));
    return TZ_OK;
}

tz_status tz_arrange_elements(tz_cli *cli, const tz_elements_job *job)
{
    run_state r = {.cli = cli, .job = job};
    tz_domain d = {.torus = false};
    if (cli->operands != 1)
        return tz_cli_usage(cli, "elements are arranged from one drawing or photo; put "
                                 "several exemplars into one SVG");
    tz_status s = tz_element_exemplar_read(cli, cli->operand[0], job->medium, job->things,
                                           job->analyze->model, &r.record, &r.exemplar);
    if (s == TZ_OK) {
        d = tz_element_domain(cli, &r.exemplar.set, job->arrange, job->grow);
        s = read_kept(&r, &d);
    }
    if (s == TZ_OK)
        s = name_output(&r, &d);
    if (s == TZ_OK)
        s = tz_guides_read(cli, job->guides, &r.exemplar.set, &r.record, &d, &r.guides);
    if (s == TZ_OK)
        s = tz_element_exemplar_write_plate(cli, &r.exemplar);
    if (s == TZ_OK)
        s = tz_element_set_like(cli->ctx, &r.exemplar.set, &d, &r.layout);
    if (s == TZ_OK)
        s = put_kept(&r);
    if (s == TZ_OK)
        s = arrange(&r);
    if (s == TZ_OK)
        s = lay_ground(&r, &d);
    if (s == TZ_OK)
        s = write_layout(&r, &d);
    tz_element_set_deinit(&r.layout);
    tz_element_set_deinit(&r.kept);
    tz_element_exemplar_free(cli, &r.exemplar);
    tz_guides_free(&r.guides);
    tz_record_free(cli, &r.record);
    tz_free(cli->ctx, r.path);
    return s;
}
