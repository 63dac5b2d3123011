/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/render_elements.h"

#include "cli/element_material.h"
#include "cli/elements.h"
#include "cli/layout_pictures.h"

typedef struct run_state {
    tz_cli *cli;
    const tz_render_elements_job *job;
    tz_record record;
    tz_element_set layout;
    tz_element_material material;
    tz_element_maps maps;
    tz_picture_list pictures;
} run_state;

/** Names and checks every output before the work begins. */
static tz_status plan(run_state *r)
{
    const tz_render_elements_job *j = r->job;
    const tz_layout_wish w = {.output = j->output,
                              .map_output = j->map_output,
                              .compose = j->compose,
                              .format = j->format,
                              .domain = &r->layout.domain,
                              .scale = j->look->scale};
    const tz_status s =
        tz_element_maps_parse(r->cli, j->maps, r->layout.photo.n, &r->maps);
    return s == TZ_OK ? tz_layout_pictures_plan(r->cli, &w, &r->maps, &r->material.inputs,
                                                &r->pictures)
                      : s;
}

tz_status tz_render_elements(tz_cli *cli, const tz_render_elements_job *job)
{
    run_state r = {.cli = cli, .job = job};
    tz_medium_params medium;
    tz_params_default(&tz_medium_param_table, &medium);
    tz_status s =
        tz_elements_read(cli, cli->operand[0], &medium, 0, &r.record, &r.layout);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &r.material.inputs, tz_cli_find(cli, cli->operand[0]));
    if (s == TZ_OK)
        s = tz_element_material_read(cli, cli->operand[0], &r.layout, &r.record,
                                     &r.material);
    if (s == TZ_OK)
        s = plan(&r);
    const tz_element_job pictures = {&r.material, &r.maps,     job->compose,
                                     job->look,   job->format, &r.record};
    if (s == TZ_OK)
        s = tz_element_pictures_render(cli, &pictures, &r.pictures, 0, r.pictures.n);
    tz_element_material_free(cli, &r.material);
    tz_element_set_deinit(&r.layout);
    tz_element_maps_free(cli->ctx, &r.maps);
    tz_record_free(cli, &r.record);
    tz_pictures_free(cli->ctx, &r.pictures);
    return s;
}
