/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/expand_elements.h"

#include "cli/element_exemplar.h"
#include "cli/element_material.h"
#include "cli/figures.h"
#include "cli/layout_pictures.h"
#include "elements/element_io.h"
#include "synthesis/element_ground.h"

typedef struct run_state {
    tz_cli *cli;
    const tz_expand_elements_job *job;
    tz_expand_plan plan;
    tz_record record;
    tz_element_exemplar exemplar;
    tz_element_maps maps;
    tz_domain domain;
    tz_guides guides;
} run_state;

static tz_status name_pictures(tz_cli *cli, void *user, tz_name_values v,
                               tz_picture_list *out)
{
    const run_state *r = user;
    return tz_element_pictures_plan(cli, r->job->output, r->job->map_output, &r->maps, v,
                                    out);
}

static tz_status list_inputs(run_state *r)
{
    const tz_status s = tz_guides_paths(r->cli, r->job->guides, &r->exemplar.inputs);
    return s == TZ_OK ? tz_layout_maps_paths(r->cli, &r->maps, &r->exemplar.inputs) : s;
}

static tz_status prepare(run_state *r)
{
    tz_cli *cli = r->cli;
    const tz_expand_elements_job *j = r->job;
    tz_path_list plates = {0};
    tz_rect crop;
    int32_t size[2];
    tz_expand_wish w = {.own = j->own,
                        .output = j->output,
                        .format = j->format,
                        .seed = j->arrange->seed,
                        .inputs = &r->exemplar.inputs,
                        .besides = &plates,
                        .pictures = name_pictures,
                        .user = r};
    if (cli->operands != 1)
        return tz_cli_usage(cli, "elements are expanded from one photo or drawing");
    tz_status s = tz_expand_seeds(cli, &w, &r->plan);
    if (s == TZ_OK && !r->exemplar.found)
        s = tz_element_exemplar_read(cli, cli->operand[0], j->medium, j->things,
                                     j->analyze->model, &r->record, &r->exemplar);
    if (s == TZ_OK)
        s = tz_element_maps_parse(cli, j->maps, r->exemplar.photos.n, &r->maps);
    if (s == TZ_OK)
        s = list_inputs(r);
    if (s == TZ_OK && *j->own->save_exemplar)
        s = tz_element_exemplar_name_plate(cli, j->own->save_exemplar, &plates,
                                           &r->exemplar);
    if (s == TZ_OK && *j->own->save_layout)
        s = tz_element_exemplar_name_plate(cli, j->own->save_layout, &plates,
                                           &r->exemplar);
    if (s != TZ_OK)
        goto done;
    r->domain = tz_element_domain(cli, &r->exemplar.set, j->arrange, j->grow);
    tz_layout_pixels(&r->domain, j->look->scale, size);
    w.width = size[0];
    w.height = size[1];
    s = tz_expand_plan_make(cli, &w, &r->plan);
    if (s == TZ_OK && r->plan.pictures.n)
        s = tz_crop_settle(cli->ctx, size, j->compose, &crop);
    if (s == TZ_OK)
        s = tz_guides_read(cli, j->guides, &r->exemplar.set, &r->record, &r->domain,
                           &r->guides);
    if (s == TZ_OK)
        s = tz_element_exemplar_write_plate(cli, &r->exemplar);
done:
    tz_paths_free(cli->ctx, &plates);
    return s;
}

static tz_status write_set(tz_ctx *ctx, const char *path, const void *set)
{
    return tz_element_write(ctx, path, set);
}

/** Document of one seed. */
static tz_status save_layout(run_state *r, int32_t i, tz_element_set *layout,
                             const tz_layout *ground)
{
    if (r->plan.layouts.n == 0)
        return TZ_OK;
    const char *path = r->plan.layouts.v[i];
    const tz_status s = tz_layout_document(r->cli, path, &r->record, ground, layout,
                                           &layout->recipe, layout, write_set);
    if (s == TZ_OK)
        tz_layout_tell(r->cli, path, "layout", &r->domain);
    return s;
}

static tz_status one_seed(run_state *r, int32_t i)
{
    tz_cli *cli = r->cli;
    const tz_expand_elements_job *j = r->job;
    const uint64_t seed = j->arrange->seed = r->plan.seeds.v[i];
    tz_element_arrange_report report;
    tz_element_set layout = {0};
    tz_element_material m = {.layout = &layout, .photos = r->exemplar.photos};
    tz_status s = tz_element_set_like(cli->ctx, &r->exemplar.set, &r->domain, &layout);
    tz_element_arrange_job a = {.exemplar = &r->exemplar.set,
                                .name = cli->operand[0],
                                .params = j->elements,
                                .seed = seed};
    tz_guides_apply(&r->guides, &a);
    if (s == TZ_OK)
        s = tz_element_arrange(cli->ctx, &a, &layout, &report);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "arrange", report.grow + report.solve);
    tz_figures_count(cli, "placements", report.elements);
    s = tz_element_exemplar_ground(cli, &r->exemplar, j->analyze, &r->domain, seed,
                                   &m.ground);
    if (s == TZ_OK)
        s = save_layout(r, i, &layout, &m.ground);
    m.ground_photo = r->exemplar.photos.plate;
    const tz_element_job job = {&m, &r->maps, j->compose, j->look, j->format, &r->record};
    if (s == TZ_OK)
        s = tz_element_pictures_render(cli, &job, &r->plan.pictures, r->plan.first[i],
                                       r->plan.first[i + 1]);
done:
    tz_layout_deinit(&m.ground);
    tz_element_set_deinit(&layout);
    return s;
}

static tz_status save_exemplar(run_state *r)
{
    const char *path = r->job->own->save_exemplar;
    if (!*path)
        return TZ_OK;
    tz_status s = tz_element_write(r->cli->ctx, path, &r->exemplar.set);
    if (s == TZ_OK)
        tz_layout_tell(r->cli, path, "exemplar", &r->exemplar.set.domain);
    return s;
}

tz_status tz_expand_elements(tz_cli *cli, const tz_expand_elements_job *job,
                             tz_element_exemplar *found, tz_record *record)
{
    run_state r = {.cli = cli, .job = job};
    if (found) {
        r.exemplar = *found;
        r.record = *record;
        *found = (tz_element_exemplar){0};
        *record = (tz_record){0};
    }
    tz_status s = prepare(&r);
    if (s == TZ_OK)
        s = save_exemplar(&r);
    const bool layout = r.plan.layouts.n || r.plan.pictures.n;
    for (int32_t i = 0; s == TZ_OK && layout && i < r.plan.seeds.n; i++)
        s = one_seed(&r, i);
    tz_guides_free(&r.guides);
    tz_element_exemplar_free(cli, &r.exemplar);
    tz_element_maps_free(cli->ctx, &r.maps);
    tz_record_free(cli, &r.record);
    tz_expand_plan_free(cli, &r.plan);
    return s;
}
