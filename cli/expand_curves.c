/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/expand_curves.h"

#include <math.h>
#include <string.h>

#include "base/file.h"
#include "cli/exemplars.h"
#include "cli/figures.h"
#include "cli/layout_pictures.h"
#include "curves/curve_io.h"
#include "synthesis/element_ground.h"

typedef struct run_state {
    tz_cli *cli;
    const tz_expand_curves_job *job;
    tz_expand_plan plan;
    tz_record record;
    tz_curve_exemplar exemplar;
    tz_element_photos photos; /* photo and plate, out of the exemplar or its files */
    tz_element_maps maps;
    tz_domain domain;
    tz_guides guides;
    tz_curve_render_params look;
} run_state;

/* ---- reading ----------------------------------------------------------------------- */

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

/** Photo and plate: those found just now, or the files that the document names. */
static tz_status take_photos(run_state *r)
{
    tz_cli *cli = r->cli;
    tz_curve_exemplar *e = &r->exemplar;
    tz_status s = TZ_OK;
    if (!e->photo.px) {
        s = tz_element_photos_read(cli, &e->set.element, &r->record, &e->inputs,
                                   &r->photos);
    } else {
        s = tz_element_photos_init(cli, 1, &r->photos);
        if (s != TZ_OK)
            return s;
        r->photos.photo[0] = e->photo;
        e->photo = (tz_image){0};
        s = tz_image_copy(cli->ctx, &e->plate, &r->photos.plate[0]);
    }
    return s == TZ_OK ? tz_element_photos_match(cli, &r->photos, NULL, 0) : s;
}

static tz_status read_exemplar(run_state *r, bool known)
{
    tz_cli *cli = r->cli;
    const tz_expand_curves_job *j = r->job;
    const char *path = cli->operand[0];
    tz_curve_exemplar *e = &r->exemplar;
    tz_status s = TZ_OK;
    if (!known && tz_path_is_svg(path))
        s = tz_curves_read(cli, path, j->input, true, &r->record, &e->inputs, &e->set);
    else if (!known)
        s = tz_curve_exemplar_find(cli, path, j->lines, &r->record, e);
    if (s == TZ_OK && e->set.path.n == 0)
        s = tz_fail(cli->ctx, TZ_INVALID,
                    "%s: no lines stand out in it; try a smaller --line-strength, "
                    "--line edge, or --as edges",
                    path);
    return s;
}

/** --size where it is given, else the exemplar's times --grow, in whole units. */
static void settle_domain(run_state *r)
{
    const tz_expand_curves_job *j = r->job;
    r->domain =
        (tz_domain){.size = r->exemplar.set.domain.size, .torus = j->arrange->tile};
    if (tz_cli_given(r->cli, "size")) {
        r->domain.size.x = j->arrange->size[0];
        r->domain.size.y = j->arrange->size[1];
    } else {
        r->domain.size.x = fmax(1, rint(r->domain.size.x * j->grow));
        r->domain.size.y = fmax(1, rint(r->domain.size.y * j->grow));
    }
}

static tz_status check_guides(const run_state *r)
{
    const tz_guide_params *g = r->job->guides;
    if (r->cli->operands != 1)
        return tz_cli_usage(r->cli, "curves are expanded from one photo or drawing");
    if (*g->zones || *g->zone_kinds || *g->textures || *g->brush)
        return tz_cli_usage(r->cli,
                            "%s is for elements; curves take --domain and --field",
                            *g->textures ? "--textures"
                            : *g->brush  ? "--brush"
                                         : "--zones");
    return TZ_OK;
}

static tz_status prepare(run_state *r, bool known)
{
    tz_cli *cli = r->cli;
    const tz_expand_curves_job *j = r->job;
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
    tz_status s = check_guides(r);
    if (s == TZ_OK)
        s = tz_expand_seeds(cli, &w, &r->plan);
    if (s == TZ_OK)
        s = read_exemplar(r, known);
    if (s == TZ_OK)
        s = tz_curve_maps_parse(cli, j->maps, r->exemplar.set.element.photo.n, &r->maps);
    if (s == TZ_OK)
        s = list_inputs(r);
    if (s == TZ_OK && *j->own->save_exemplar)
        s = tz_curve_exemplar_name_plate(cli, j->own->save_exemplar, &plates,
                                         &r->exemplar);
    if (s == TZ_OK && *j->own->save_layout)
        s = tz_curve_exemplar_name_plate(cli, j->own->save_layout, &plates, &r->exemplar);
    if (s != TZ_OK)
        goto done;
    settle_domain(r);
    tz_layout_pixels(&r->domain, j->look->scale, size);
    w.width = size[0];
    w.height = size[1];
    s = tz_expand_plan_make(cli, &w, &r->plan);
    if (s == TZ_OK && r->plan.pictures.n)
        s = tz_crop_settle(cli->ctx, size, j->compose, &crop);
    if (s == TZ_OK)
        s = tz_guides_read(cli, j->guides, &r->exemplar.set.element, &r->record,
                           &r->domain, &r->guides);
    if (s == TZ_OK)
        s = tz_guides_only_turn(cli, &r->guides);
    if (s == TZ_OK)
        s = tz_curve_exemplar_write_plate(cli, &r->exemplar);
    if (s == TZ_OK)
        s = take_photos(r);
done:
    tz_paths_free(cli->ctx, &plates);
    return s;
}

/* ---- one seed ---------------------------------------------------------------------- */

/** The plate arranged over the domain; no placements where there is no plate. */
static tz_status make_ground(run_state *r, uint64_t seed, tz_layout *ground)
{
    tz_cli *cli = r->cli;
    const tz_element_set *e = &r->exemplar.set.element;
    char sha256[65] = "";
    if (r->photos.n == 0 || !r->photos.plate[0].px)
        return TZ_OK;
    const char *path = e->photo.v[0].plate;
    const double start = tz_seconds();
    tz_status s = TZ_OK;
    if (path)
        s = tz_file_sha256(cli->ctx, tz_cli_find(cli, path), sha256);
    if (s == TZ_OK)
        s = tz_element_ground_arrange(cli->ctx, &r->photos.plate[0],
                                      path ? path : "plate", sha256, r->job->analyze,
                                      &r->domain, seed, ground);
    tz_figures_seconds(cli, "ground", tz_seconds() - start);
    return s;
}

static tz_status write_set(tz_ctx *ctx, const char *path, const void *set)
{
    return tz_curve_write_svg(ctx, path, set);
}

/** Document of one seed. */
static tz_status save_layout(run_state *r, int32_t i, tz_curve_set *layout,
                             const tz_layout *ground)
{
    if (r->plan.layouts.n == 0)
        return TZ_OK;
    const char *path = r->plan.layouts.v[i];
    const tz_status s =
        tz_layout_document(r->cli, path, &r->record, ground, &layout->element,
                           &layout->recipe, layout, write_set);
    if (s == TZ_OK)
        tz_layout_tell(r->cli, path, "layout", &r->domain);
    return s;
}

static tz_status one_seed(run_state *r, int32_t i)
{
    tz_cli *cli = r->cli;
    const tz_expand_curves_job *j = r->job;
    const uint64_t seed = j->arrange->seed = r->plan.seeds.v[i];
    tz_curve_arrange_report report = {0};
    tz_curve_set layout = {0};
    tz_element_material m = {.photos = r->photos};
    const tz_curve_arrange_job a = {.exemplar = &r->exemplar.set,
                                    .name = cli->operand[0],
                                    .domain = &r->domain,
                                    .params = j->curves,
                                    .seed = seed};
    const double start = tz_seconds();
    tz_status s = tz_curve_arrange(cli->ctx, &a, &layout, &report);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "arrange", tz_seconds() - start);
    tz_figures_count(cli, "placements", layout.path.n);
    s = make_ground(r, seed, &m.ground);
    if (s == TZ_OK)
        s = save_layout(r, i, &layout, &m.ground);
    m.layout = &layout.element;
    m.ground_photo = r->photos.plate;
    const tz_curve_pictures_job job = {&layout,  &m,        &r->maps,  j->compose,
                                       &r->look, j->format, &r->record};
    if (s == TZ_OK)
        s = tz_curve_pictures_render(cli, &job, &r->plan.pictures, r->plan.first[i],
                                     r->plan.first[i + 1]);
done:
    tz_layout_deinit(&m.ground);
    tz_curve_set_deinit(&layout);
    return s;
}

static tz_status save_exemplar(run_state *r)
{
    const char *path = r->job->own->save_exemplar;
    if (!*path)
        return TZ_OK;
    tz_status s = tz_curve_write_svg(r->cli->ctx, path, &r->exemplar.set);
    if (s == TZ_OK)
        tz_layout_tell(r->cli, path, "exemplar", &r->exemplar.set.domain);
    return s;
}

tz_status tz_expand_curves(tz_cli *cli, const tz_expand_curves_job *job,
                           tz_curve_exemplar *found, tz_record *record)
{
    run_state r = {.cli = cli, .job = job, .look = *job->look};
    if (found) {
        r.exemplar = *found;
        r.record = *record;
        *found = (tz_curve_exemplar){0};
        *record = (tz_record){0};
    }
    tz_status s = prepare(&r, found != NULL);
    if (s == TZ_OK)
        s = save_exemplar(&r);
    const bool layout = r.plan.layouts.n || r.plan.pictures.n;
    for (int32_t i = 0; s == TZ_OK && layout && i < r.plan.seeds.n; i++)
        s = one_seed(&r, i);
    tz_guides_free(&r.guides);
    tz_element_photos_free(cli, &r.photos);
    tz_curve_exemplar_free(cli, &r.exemplar);
    tz_element_maps_free(cli->ctx, &r.maps);
    tz_record_free(cli, &r.record);
    tz_expand_plan_free(cli, &r.plan);
    return s;
}
