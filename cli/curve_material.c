/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/curve_material.h"

#include "cli/figures.h"
#include "cli/layout_pictures.h"

enum { MAP_ID, MAP_DISTANCE, MAP_ALONG };

/* ---- maps -------------------------------------------------------------------------- */

tz_status tz_curve_maps_parse(tz_cli *cli, const char *text, int32_t photos,
                              tz_element_maps *out)
{
    static const char *const names[] = {
        [MAP_ID] = "id", [MAP_DISTANCE] = "distance", [MAP_ALONG] = "along"};
    return tz_layout_maps_parse(cli, text, photos, names, sizeof names / sizeof *names,
                                out);
}

/* ---- rendering --------------------------------------------------------------------- */

/* One image under way. */
typedef struct picture_state {
    tz_curve_composer *composer;
    int32_t what; /* -1 = pixels */
} picture_state;

static tz_status render_pixels(tz_ctx *ctx, void *user, tz_rect r, tz_image *out)
{
    return tz_curve_composer_render(ctx, ((picture_state *)user)->composer, r, out);
}

static tz_status stream_pixels(tz_ctx *ctx, void *user, tz_rect r, tz_image_sink *sink)
{
    return tz_curve_composer_stream(ctx, ((picture_state *)user)->composer, r, sink);
}

/* Paths are counted from 1, as elements are; 0 where there is none. */
static tz_status render_what(tz_ctx *ctx, void *user, tz_rect r, tz_image *out)
{
    const picture_state *p = user;
    const size_t n = (size_t)r.w * (size_t)r.h;
    int32_t *id = NULL;
    float *v = NULL;
    tz_status s = tz_alloc(ctx, &v, n, sizeof *v);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &id, n, sizeof *id);
    if (s == TZ_OK)
        s = tz_curve_composer_map(ctx, p->composer, r, id,
                                  p->what == MAP_DISTANCE ? v : NULL,
                                  p->what == MAP_ALONG ? v : NULL);
    for (int32_t y = 0; y < r.h && s == TZ_OK; y++)
        for (int32_t x = 0; x < r.w; x++) {
            const size_t at = (size_t)y * (size_t)r.w + (size_t)x;
            *tz_image_at(out, x, y) = p->what == MAP_ID ? (float)(id[at] + 1)
                                      : id[at] < 0      ? 0
                                                        : v[at];
        }
    out->encoding = TZ_ENCODING_DATA;
    tz_free(ctx, id);
    tz_free(ctx, v);
    if (s == TZ_OK)
        tz_progress_add(ctx, (int64_t)n);
    return s;
}

/** Image of one pixel that is like what will be written. */
static tz_status make_like(tz_cli *cli, const picture_state *p, tz_image *like)
{
    if (p->what < 0)
        return tz_curve_composer_image(cli->ctx, p->composer, 1, 1, like);
    tz_status s = tz_image_init(cli->ctx, like, 1, 1, 1);
    like->encoding = TZ_ENCODING_DATA;
    like->depth = 32;
    return s;
}

static tz_status write_picture(tz_cli *cli, const tz_curve_pictures_job *job,
                               picture_state *state, const tz_record *extra,
                               const char *name, const char *path)
{
    char *recipe = NULL;
    tz_image like = {0};
    tz_render_figures f = {0};
    const bool what = state->what >= 0;
    tz_pixels_job pixels = {.user = state,
                            .render = what ? render_what : render_pixels,
                            .stream = what ? NULL : stream_pixels,
                            .like = &like,
                            .path = path,
                            .format = job->format};
    int32_t size[2];
    tz_curve_composer_size(state->composer, &size[0], &size[1]);
    tz_status s = tz_crop_settle(cli->ctx, size, job->compose, &pixels.rect);
    if (s == TZ_OK)
        s = tz_record_text(cli, job->record, extra, name, &recipe);
    if (s == TZ_OK)
        s = make_like(cli, state, &like);
    pixels.recipe = recipe;
    if (s == TZ_OK) {
        tz_progress_begin(cli->ctx, "render", "px",
                          (int64_t)pixels.rect.w * pixels.rect.h);
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

static tz_status render_one(tz_cli *cli, const tz_curve_pictures_job *job,
                            const tz_picture *p)
{
    const tz_element_material *m = job->material;
    const tz_map *map = p->map < 0 ? NULL : &job->maps->map.v[p->map];
    picture_state state = {.what = map ? job->maps->what.v[p->map] : -1};
    const bool of_photo = map && state.what < 0;
    const int32_t photos = m->photos.n;
    tz_image *images = NULL, *plates = NULL;
    tz_element_pixels pixels = {0};
    tz_record extra = {0};
    const double start = tz_seconds();
    tz_status s = TZ_OK;
    if (of_photo) {
        s = tz_alloc_zero(cli->ctx, &images, (size_t)photos, sizeof *images);
        if (s == TZ_OK)
            s = tz_map_load(cli, map, images, &extra);
    }
    if (s == TZ_OK && images && m->ground.place.n > 0)
        s = tz_element_material_plates(cli, m, images, &plates);
    if (photos > 0)
        pixels = (tz_element_pixels){&m->photos.photo[0],
                                     m->photos.plate[0].px ? &m->photos.plate[0] : NULL,
                                     images ? &images[0] : NULL};
    const tz_element_ground ground = {&m->ground, plates ? plates : m->ground_photo,
                                      m->ground.source.n, job->compose};
    if (s == TZ_OK)
        s = tz_curve_composer_new(cli->ctx, m->ground.place.n ? &ground : NULL,
                                  job->layout, photos > 0 ? &pixels : NULL,
                                  of_photo ? map->kind : TZ_MAP_COLOUR, job->render,
                                  &state.composer);
    tz_figures_seconds(cli, "prepare", tz_seconds() - start);
    if (s == TZ_OK)
        s = write_picture(cli, job, &state, &extra, map ? map->name : "colour", p->path);
    tz_curve_composer_free(state.composer);
    for (int32_t i = 0; images && i < photos; i++)
        tz_image_deinit(&images[i]);
    for (int32_t i = 0; plates && i < m->ground.source.n; i++)
        tz_image_deinit(&plates[i]);
    tz_free(cli->ctx, plates);
    tz_free(cli->ctx, images);
    tz_record_free(cli, &extra);
    return s;
}

tz_status tz_curve_pictures_render(tz_cli *cli, const tz_curve_pictures_job *job,
                                   const tz_picture_list *pictures, int32_t first,
                                   int32_t end)
{
    tz_status s = TZ_OK;
    for (int32_t i = first; s == TZ_OK && i < end; i++)
        s = render_one(cli, job, &pictures->v[i]);
    return s;
}
