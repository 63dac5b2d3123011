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
    tz_element_set layout;
    tz_guides guides;
    char *path;
} run_state;

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
    tz_figures_count(cli, "percent filled", (int64_t)rint(100 * report.filled));
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
        s = name_output(&r, &d);
    }
    if (s == TZ_OK)
        s = tz_guides_read(cli, job->guides, &r.exemplar.set, &r.record, &d, &r.guides);
    if (s == TZ_OK)
        s = tz_element_exemplar_write_plate(cli, &r.exemplar);
    if (s == TZ_OK)
        s = tz_element_set_like(cli->ctx, &r.exemplar.set, &d, &r.layout);
    if (s == TZ_OK)
        s = arrange(&r);
    if (s == TZ_OK)
        s = lay_ground(&r, &d);
    if (s == TZ_OK)
        s = write_layout(&r, &d);
    tz_element_set_deinit(&r.layout);
    tz_element_exemplar_free(cli, &r.exemplar);
    tz_guides_free(&r.guides);
    tz_record_free(cli, &r.record);
    tz_free(cli->ctx, r.path);
    return s;
}
