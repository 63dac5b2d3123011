/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/render_curves.h"

#include <math.h>

#include "cli/figures.h"
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
    tz_cli *cli = r->cli;
    const tz_render_curves_job *j = r->job;
    char stem[TZ_PARAM_STRING_SIZE];
    tz_path_list outputs = {0};
    tz_rect crop;
    const int32_t size[2] = {
        (int32_t)fmin(1e9, fmax(1, rint(r->layout.domain.size.x * j->look->scale))),
        (int32_t)fmin(1e9, fmax(1, rint(r->layout.domain.size.y * j->look->scale)))};
    tz_path_stem(cli->operand[0], stem, sizeof stem);
    const tz_name_values names = {stem, "png", "colour", 0, size[0], size[1]};
    tz_status s = tz_curve_maps_parse(cli, j->maps, r->layout.element.photo.n, &r->maps);
    if (s == TZ_OK)
        s = tz_element_pictures_plan(cli, j->output, j->map_output, &r->maps, names,
                                     &r->pictures);
    for (int32_t i = 0; s == TZ_OK && i < r->pictures.n; i++)
        s = tz_paths_add(cli->ctx, &outputs, r->pictures.v[i].path);
    for (int32_t i = 0; s == TZ_OK && i < r->maps.map.n; i++)
        for (int32_t k = 0;
             s == TZ_OK && r->maps.what.v[i] < 0 && k < r->maps.map.v[i].path.n; k++)
            s = tz_paths_add(cli->ctx, &r->material.inputs,
                             tz_cli_find(cli, r->maps.map.v[i].path.v[k]));
    if (s == TZ_OK && cli->piped && cli->common->json)
        s = tz_cli_usage(cli, "--json and the image both want standard output");
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &r->material.inputs, &outputs);
    if (s == TZ_OK)
        s = tz_pictures_check(cli, &r->pictures, j->format);
    if (s == TZ_OK)
        s = tz_crop_settle(cli->ctx, size, j->compose, &crop);
    tz_paths_free(cli->ctx, &outputs);
    return s;
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
