/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/element_material.h"

#include "cli/elements.h"
#include "cli/figures.h"
#include "cli/layout_pictures.h"
#include "synthesis/element_ground.h"
#include "synthesis/plate_map.h"

/* ---- pixels ------------------------------------------------------------------------ */

static tz_status read_ground(tz_cli *cli, const char *document, tz_element_set *layout,
                             tz_record *record, tz_element_material *m)
{
    tz_status s =
        tz_element_ground_read(cli->ctx, tz_cli_find(cli, document), layout, &m->ground);
    if (s == TZ_OK && m->ground.place.n > 0) {
        tz_free(cli->ctx, layout->background);
        layout->background = NULL;
    }
    if (s == TZ_OK)
        s = tz_alloc_zero(cli->ctx, &m->ground_photo, (size_t)m->ground.source.n,
                          sizeof *m->ground_photo);
    for (int32_t i = 0; i < m->ground.source.n && s == TZ_OK; i++) {
        const tz_layout_source *l = &m->ground.source.v[i];
        s = tz_picture_read(cli, l->path, l->sha256, l->width, l->height, record,
                            &m->inputs, &m->ground_photo[i]);
    }
    return s;
}

tz_status tz_element_material_read(tz_cli *cli, const char *document,
                                   tz_element_set *layout, tz_record *record,
                                   tz_element_material *m)
{
    m->layout = layout;
    tz_status s = read_ground(cli, document, layout, record, m);
    if (s == TZ_OK)
        s = tz_element_photos_read(cli, layout, record, &m->inputs, &m->photos);
    if (s == TZ_OK)
        s = tz_element_photos_match(cli, &m->photos, m->ground_photo, m->ground.source.n);
    return s;
}

void tz_element_material_free(tz_cli *cli, tz_element_material *m)
{
    for (int32_t i = 0; m->ground_photo && i < m->ground.source.n; i++)
        tz_image_deinit(&m->ground_photo[i]);
    tz_free(cli->ctx, m->ground_photo);
    tz_element_photos_free(cli, &m->photos);
    tz_layout_deinit(&m->ground);
    tz_paths_free(cli->ctx, &m->inputs);
    *m = (tz_element_material){0};
}

/* ---- maps -------------------------------------------------------------------------- */

tz_status tz_element_maps_parse(tz_cli *cli, const char *text, int32_t photos,
                                tz_element_maps *out)
{
    static const char *const names[] = {[TZ_ELEMENT_MAP_ID] = "id",
                                        [TZ_ELEMENT_MAP_CLASS] = "class",
                                        [TZ_ELEMENT_MAP_ANGLE] = "angle",
                                        [TZ_ELEMENT_MAP_UV] = "uv"};
    return tz_layout_maps_parse(cli, text, photos, names, sizeof names / sizeof *names,
                                out);
}

void tz_element_maps_free(tz_ctx *ctx, tz_element_maps *m)
{
    tz_maps_free(ctx, &m->map);
    tz_array_free(ctx, &m->what);
}

tz_status tz_element_pictures_plan(tz_cli *cli, const char *output,
                                   const char *map_output, const tz_element_maps *maps,
                                   tz_name_values v, tz_picture_list *pictures)
{
    const int32_t first = pictures->n;
    tz_status s = tz_pictures_plan(cli, output, map_output, &maps->map, v, pictures);
    for (int32_t i = first; i < pictures->n && s == TZ_OK; i++) {
        tz_picture *p = &pictures->v[i];
        if (p->map < 0 || maps->what.v[p->map] < 0 || cli->replay)
            continue;
        v.map = maps->map.v[p->map].name;
        tz_free(cli->ctx, p->path);
        p->path = NULL;
        s = tz_name_expand(cli->ctx, maps->map.v[p->map].path.v[0], &v, &p->path);
    }
    return s;
}

/* ---- rendering --------------------------------------------------------------------- */

/* One image under way. */
typedef struct picture_state {
    tz_element_composer *composer;
    tz_element_map what;
} picture_state;

static tz_status render_pixels(tz_ctx *ctx, void *user, tz_rect r, tz_image *out)
{
    return tz_element_composer_render(ctx, ((picture_state *)user)->composer, r, out);
}

static tz_status stream_pixels(tz_ctx *ctx, void *user, tz_rect r, tz_image_sink *sink)
{
    return tz_element_composer_stream(ctx, ((picture_state *)user)->composer, r, sink);
}

static tz_status render_what(tz_ctx *ctx, void *user, tz_rect r, tz_image *out)
{
    const picture_state *p = user;
    return tz_element_renderer_map(ctx, tz_element_composer_renderer(p->composer),
                                   p->what, r, out);
}

/** Image of one pixel that is like what will be written. */
static tz_status make_like(tz_cli *cli, const picture_state *p, bool what, tz_image *like)
{
    if (!what)
        return tz_element_composer_image(cli->ctx, p->composer, 1, 1, like);
    tz_status s = tz_image_init(cli->ctx, like, 1, 1, tz_element_map_channels(p->what));
    like->encoding = TZ_ENCODING_DATA;
    like->depth = 32;
    return s;
}

static tz_status write_picture(tz_cli *cli, const tz_element_job *job,
                               picture_state *state, bool what, const tz_record *extra,
                               const char *name, const char *path)
{
    char *recipe = NULL;
    tz_image like = {0};
    tz_render_figures f = {0};
    tz_pixels_job pixels = {.user = state,
                            .render = what ? render_what : render_pixels,
                            .stream = what ? NULL : stream_pixels,
                            .like = &like,
                            .path = path,
                            .format = job->format};
    int32_t size[2];
    tz_element_composer_size(state->composer, &size[0], &size[1]);
    tz_status s = tz_crop_settle(cli->ctx, size, job->compose, &pixels.rect);
    if (s == TZ_OK)
        s = tz_record_text(cli, job->record, extra, name, &recipe);
    if (s == TZ_OK)
        s = make_like(cli, state, what, &like);
    pixels.recipe = recipe;
    if (s == TZ_OK) {
        tz_progress_begin(cli->ctx, "render", "px",
                          (int64_t)pixels.rect.w * pixels.rect.h *
                              (job->material->ground.place.n && !what ? 2 : 1));
        s = tz_pixels_write(cli->ctx, &pixels, &f);
        tz_progress_end(cli->ctx);
    }
    if (s == TZ_OK) {
        tz_figures_seconds(cli, "render", f.render);
        tz_figures_seconds(cli, "write", f.write);
        tz_figures_output(cli, path, name, f.width, f.height);
    }
    tz_image_deinit(&like);
    tz_free(cli->ctx, recipe);
    return s;
}

tz_status tz_element_material_plates(tz_cli *cli, const tz_element_material *m,
                                     const tz_image *maps, tz_image **out)
{
    const int32_t n = m->ground.source.n;
    tz_status s = tz_alloc_zero(cli->ctx, out, (size_t)n, sizeof **out);
    for (int32_t i = 0; i < n && i < m->photos.n && s == TZ_OK; i++) {
        const tz_image *photo = &m->photos.photo[i], *plate = &m->ground_photo[i];
        const bool plates = photo->width == plate->width &&
                            photo->height == plate->height &&
                            photo->channels == plate->channels;
        s = plates ? tz_plate_map(cli->ctx, photo, plate, &maps[i], &(*out)[i])
                   : tz_image_copy(cli->ctx, &maps[i], &(*out)[i]);
    }
    return s;
}

static tz_status render_one(tz_cli *cli, const tz_element_job *job, const tz_picture *p)
{
    const tz_element_material *m = job->material;
    const tz_map *map = p->map < 0 ? NULL : &job->maps->map.v[p->map];
    const bool what = map && job->maps->what.v[p->map] >= 0;
    const int32_t photos = m->photos.n;
    tz_image *images = NULL, *plates = NULL;
    tz_element_pixels *pixels = NULL;
    tz_record extra = {0};
    picture_state state = {.what = what ? (tz_element_map)job->maps->what.v[p->map] : 0};
    const double start = tz_seconds();
    tz_status s = tz_alloc_zero(cli->ctx, &pixels, (size_t)photos, sizeof *pixels);
    if (s == TZ_OK && map && !what) {
        s = tz_alloc_zero(cli->ctx, &images, (size_t)photos, sizeof *images);
        if (s == TZ_OK)
            s = tz_map_load(cli, map, images, &extra);
    }
    for (int32_t i = 0; i < photos && s == TZ_OK; i++)
        pixels[i] = (tz_element_pixels){
            &m->photos.photo[i], m->photos.plate[i].px ? &m->photos.plate[i] : NULL,
            images ? &images[i] : NULL};
    if (s == TZ_OK && images && m->ground.place.n > 0)
        s = tz_element_material_plates(cli, m, images, &plates);
    const tz_element_ground ground = {&m->ground, plates ? plates : m->ground_photo,
                                      m->ground.source.n, job->compose};
    if (s == TZ_OK)
        s = tz_element_composer_new(
            cli->ctx, m->ground.place.n ? &ground : NULL, m->layout, pixels,
            map && !what ? map->kind : TZ_MAP_COLOUR, job->render, &state.composer);
    tz_figures_seconds(cli, "prepare", tz_seconds() - start);
    if (s == TZ_OK)
        s = write_picture(cli, job, &state, what, &extra, map ? map->name : "colour",
                          p->path);
    tz_element_composer_free(state.composer);
    for (int32_t i = 0; images && i < photos; i++)
        tz_image_deinit(&images[i]);
    for (int32_t i = 0; plates && i < m->ground.source.n; i++)
        tz_image_deinit(&plates[i]);
    tz_free(cli->ctx, plates);
    tz_free(cli->ctx, images);
    tz_free(cli->ctx, pixels);
    tz_record_free(cli, &extra);
    return s;
}

tz_status tz_element_pictures_render(tz_cli *cli, const tz_element_job *job,
                                     const tz_picture_list *pictures, int32_t first,
                                     int32_t end)
{
    tz_status s = TZ_OK;
    for (int32_t i = first; s == TZ_OK && i < end; i++)
        s = render_one(cli, job, &pictures->v[i]);
    return s;
}
