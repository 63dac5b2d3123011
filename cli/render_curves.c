/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/render_curves.h"

#include "cli/figures.h"
#include "cli/layout_pictures.h"
#include "curves/curve_io.h"

typedef struct run_state {
    tz_cli *cli;
    const tz_render_curves_job *job;
    tz_record record;
    tz_curve_set layout;
    tz_element_material material;
    tz_element_maps maps;
    tz_picture_list pictures;
} run_state;

/** Names and checks every output before the work begins. */
static tz_status plan(run_state *r)
{
    const tz_render_curves_job *j = r->job;
    const tz_layout_wish w = {.output = j->output,
                              .map_output = j->map_output,
                              .compose = j->compose,
                              .format = j->format,
                              .domain = &r->layout.domain,
                              .scale = j->look->scale};
    const tz_status s =
        tz_curve_maps_parse(r->cli, j->maps, r->layout.element.photo.n, &r->maps);
    return s == TZ_OK ? tz_layout_pictures_plan(r->cli, &w, &r->maps, &r->material.inputs,
                                                &r->pictures)
                      : s;
}

/** The document as it is: nothing is joined that was apart, and origins are kept. */
static tz_status read_layout(run_state *r)
{
    tz_cli *cli = r->cli;
    const char *path = cli->operand[0];
    const tz_curve_read_options as_drawn = {.as_drawn = true};
    const double start = tz_seconds();
    tz_status s = tz_record_input(cli, &r->record, path, NULL);
    if (s == TZ_OK)
        s = tz_curve_read_svg(cli->ctx, tz_cli_find(cli, path), &as_drawn, &r->layout);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &r->material.inputs, tz_cli_find(cli, path));
    if (s == TZ_OK)
        s = tz_element_material_read(cli, path, &r->layout.element, &r->record,
                                     &r->material);
    if (s == TZ_OK) {
        tz_figures_seconds(cli, "read", tz_seconds() - start);
        tz_figures_count(cli, "paths", r->layout.path.n);
    }
    return s;
}

tz_status tz_render_curves(tz_cli *cli, const tz_render_curves_job *job)
{
    run_state r = {.cli = cli, .job = job};
    tz_status s = read_layout(&r);
    if (s == TZ_OK)
        s = plan(&r);
    const tz_curve_pictures_job pictures = {
        &r.layout, &r.material, &r.maps, job->compose, job->look, job->format, &r.record};
    if (s == TZ_OK)
        s = tz_curve_pictures_render(cli, &pictures, &r.pictures, 0, r.pictures.n);
    tz_element_material_free(cli, &r.material);
    tz_curve_set_deinit(&r.layout);
    tz_element_maps_free(cli->ctx, &r.maps);
    tz_record_free(cli, &r.record);
    tz_pictures_free(cli->ctx, &r.pictures);
    return s;
}
