/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/arrange_elements.h"

#include <math.h>
#include <string.h>

#include "cli/figures.h"
#include "cli/material.h"
#include "elements/element_io.h"

typedef struct run_state {
    tz_cli *cli;
    const tz_elements_job *job;
    tz_record record;
    tz_path_list inputs;
    tz_element_set exemplar, layout;
    tz_guides guides;
    char *path;
} run_state;

/** Domain of the layout: --size in the drawing's units, else its own times --grow. */
static tz_status settle_domain(run_state *r, tz_domain *d)
{
    const tz_elements_job *j = r->job;
    *d = (tz_domain){.size = r->exemplar.domain.size, .torus = j->arrange->tile};
    if (tz_cli_given(r->cli, "size")) {
        d->size.x = j->arrange->size[0];
        d->size.y = j->arrange->size[1];
    } else {
        d->size.x *= j->grow;
        d->size.y *= j->grow;
    }
    return TZ_OK;
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
        s = tz_paths_add(cli->ctx, &r->inputs, tz_cli_find(cli, cli->operand[0]));
    if (s == TZ_OK)
        s = tz_guides_paths(cli, r->job->guides, &r->inputs);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &outputs, r->path);
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &r->inputs, &outputs);
    tz_paths_free(cli->ctx, &outputs);
    return s;
}

static tz_status arrange(run_state *r)
{
    tz_cli *cli = r->cli;
    tz_element_arrange_report report;
    tz_status s =
        tz_element_arrange(cli->ctx, &r->exemplar, cli->operand[0], r->job->elements,
                           r->job->arrange->seed, &r->layout, &report);
    if (s != TZ_OK)
        return s;
    tz_figures_seconds(cli, "grow", report.grow);
    tz_figures_seconds(cli, "solve", report.solve);
    tz_figures_count(cli, "placements", report.elements);
    tz_figures_count(cli, "percent filled", (int64_t)rint(100 * report.filled));
    return TZ_OK;
}

tz_status tz_arrange_elements(tz_cli *cli, const tz_elements_job *job)
{
    run_state r = {.cli = cli, .job = job};
    tz_domain d;
    if (cli->operands != 1)
        return tz_cli_usage(cli, "elements are arranged from one drawing; put several "
                                 "exemplars into one SVG");
    tz_status s =
        tz_elements_read(cli, cli->operand[0], job->medium, &r.record, &r.exemplar);
    if (s == TZ_OK)
        s = settle_domain(&r, &d);
    if (s == TZ_OK)
        s = name_output(&r, &d);
    if (s == TZ_OK)
        s = tz_guides_read(cli, job->guides, &r.exemplar, &r.record, &d, &r.guides);
    if (s == TZ_OK)
        s = tz_element_set_like(cli->ctx, &r.exemplar, &d, &r.layout);
    if (s == TZ_OK)
        s = arrange(&r);
    const double start = tz_seconds();
    if (s == TZ_OK)
        s = tz_record_text(cli, &r.record, NULL, "layout", &r.layout.recipe);
    if (s == TZ_OK)
        s = tz_element_write(cli->ctx, r.path, &r.layout);
    if (s == TZ_OK) {
        tz_figures_seconds(cli, "write", tz_seconds() - start);
        tz_figures_output(cli, r.path, "layout", (int32_t)fmin(2e9, rint(d.size.x)),
                          (int32_t)fmin(2e9, rint(d.size.y)));
    }
    tz_element_set_deinit(&r.layout);
    tz_element_set_deinit(&r.exemplar);
    tz_guides_free(&r.guides);
    tz_record_free(cli, &r.record);
    tz_paths_free(cli->ctx, &r.inputs);
    tz_free(cli->ctx, r.path);
    return s;
}
