/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/material.h"

#include <string.h>
#include <strings.h>

#include "cli/figures.h"

static const tz_param output_rows[] = {
    {"output", TZ_PARAM_STRING, offsetof(tz_output_params, output), 0, 0, "", "FILE",
     NULL,
     "File to write; - = standard output. {name}, {seed}, {ext}, {width} and {height} "
     "stand "
     "for themselves."},
};
const tz_param_table tz_output_param_table = {"output", "Where the result goes.",
                                              output_rows, 1, sizeof(tz_output_params)};
static const tz_param map_output_rows[] = {
    {"map-output", TZ_PARAM_STRING, offsetof(tz_map_output_params, map_output), 0, 0,
     "{name}_{map}.{ext}", "FILE", NULL,
     "Files of the other maps; {name} and {ext} are those of --output, and a name "
     "without "
     "a folder goes beside it."},
};
const tz_param_table tz_map_output_param_table = {
    "map-output", "Where the other maps go.", map_output_rows, 1,
    sizeof(tz_map_output_params)};
static const tz_param maps_rows[] = {
    {"maps", TZ_PARAM_STRING, offsetof(tz_maps_params, maps), 0, 0, "", "NAME=FILE,...",
     NULL,
     "Other maps of the photo to render with the same layout and seams, such as "
     "normal=rock_n.exr,height=rock_h.exr. Names that begin with normal are "
     "tangent-space "
     "normals; albedo, basecolor, color, colour, diffuse and emission are colour; all "
     "others are data and never colour-converted."},
};
const tz_param_table tz_maps_param_table = {"maps", "Other maps of the material.",
                                            maps_rows, 1, sizeof(tz_maps_params)};

/* ---- maps ---------------------------------------------------------------------------
 */

static tz_map_kind kind_of(const char *name)
{
    static const char *const colour[] = {"albedo", "basecolor", "base_color", "color",
                                         "colour", "diffuse",   "emission",   "emissive"};
    if (strncasecmp(name, "normal", 6) == 0)
        return TZ_MAP_NORMAL;
    for (size_t i = 0; i < sizeof colour / sizeof colour[0]; i++)
        if (strcasecmp(name, colour[i]) == 0)
            return TZ_MAP_COLOUR;
    return TZ_MAP_DATA;
}

static tz_map *find_map(tz_map_list *l, const char *name)
{
    for (int32_t i = 0; i < l->n; i++)
        if (strcmp(l->v[i].name, name) == 0)
            return &l->v[i];
    return NULL;
}

/* End of the piece at p: a comma that is followed by NAME=, or the end of the text. */
static const char *piece_end(const char *p)
{
    for (const char *c = strchr(p, ','); c; c = strchr(c + 1, ',')) {
        size_t n = strcspn(c + 1, "=,/");
        if (n > 0 && c[1 + n] == '=')
            return c;
    }
    return p + strlen(p);
}

/* One NAME=FILE, n characters. */
static tz_status add_map(tz_ctx *ctx, const char *p, int n, tz_map_list *out)
{
    char path[TZ_PARAM_STRING_SIZE];
    const char *eq = memchr(p, '=', (size_t)n);
    int length = eq ? (int)(eq - p) : 0;
    if (length < 1 || length >= 64 || length + 1 == n || memchr(p, '/', (size_t)length))
        return tz_fail(ctx, TZ_INVALID,
                       "--maps: '%.*s' is not NAME=FILE, such as "
                       "normal=rock_n.exr",
                       n, p);
    tz_map m = {0};
    snprintf(m.name, sizeof m.name, "%.*s", length, p);
    snprintf(path, sizeof path, "%.*s", n - length - 1, eq + 1);
    m.kind = kind_of(m.name);
    tz_status s = TZ_OK;
    if (!find_map(out, m.name))
        s = tz_array_push(ctx, out, m);
    return s == TZ_OK ? tz_paths_add(ctx, &find_map(out, m.name)->path, path) : s;
}

tz_status tz_maps_parse(tz_ctx *ctx, const char *text, int32_t photos, tz_map_list *out)
{
    for (const char *p = text; *p;) {
        const char *end = piece_end(p);
        tz_status s = add_map(ctx, p, (int)(end - p), out);
        if (s != TZ_OK)
            return s;
        p = *end ? end + 1 : end;
    }
    for (int32_t i = 0; i < out->n; i++)
        if (photos >= 0 && out->v[i].path.n != photos)
            return tz_fail(ctx, TZ_INVALID,
                           "--maps: %s is given %d times for %d photos; give "
                           "it once a photo, in their order",
                           out->v[i].name, out->v[i].path.n, photos);
    return TZ_OK;
}

void tz_maps_free(tz_ctx *ctx, tz_map_list *l)
{
    for (int32_t i = 0; i < l->n; i++)
        tz_paths_free(ctx, &l->v[i].path);
    tz_array_free(ctx, l);
}

static tz_image_read_options read_options(tz_map_kind kind)
{
    return (tz_image_read_options){.data = kind != TZ_MAP_COLOUR,
                                   .want = TZ_ENCODING_SRGB};
}

tz_status tz_maps_check(tz_cli *cli, const tz_map_list *l, int32_t k,
                        const char *photo_path, const tz_image *photo)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; s == TZ_OK && i < l->n; i++) {
        if (!tz_cli_makes(cli, l->v[i].name))
            continue;
        const char *path = l->v[i].path.v[k];
        tz_image_read_options opt = read_options(l->v[i].kind);
        tz_image m = {0};
        s = tz_image_read(cli->ctx, tz_cli_find(cli, path), &opt, &m);
        if (s != TZ_OK)
            break;
        if ((int64_t)m.width * photo->height != (int64_t)m.height * photo->width)
            s = tz_fail(
                cli->ctx, TZ_INVALID,
                "%s: the %s map is %d x %d but its photo %s is %d x %d; give a map of "
                "that size or in proportion to it",
                path, l->v[i].name, m.width, m.height, photo_path, photo->width,
                photo->height);
        else if (l->v[i].kind == TZ_MAP_NORMAL && m.channels < 3)
            s = tz_fail(
                cli->ctx, TZ_INVALID,
                "%s: a normal map has 3 channels, this file has %d; name it otherwise "
                "to treat it as data",
                path, m.channels);
        tz_image_deinit(&m);
    }
    return s;
}

/* ---- pictures -----------------------------------------------------------------------
 */

static tz_status add_picture(tz_cli *cli, char *path, int32_t map, tz_picture_list *l)
{
    tz_status s = tz_array_push(cli->ctx, l, ((tz_picture){path, map}));
    if (s != TZ_OK)
        tz_free(cli->ctx, path);
    else if (strcmp(path, "-") == 0)
        cli->piped = true;
    return s;
}

static const char *name_of_map(const tz_map_list *maps, int32_t map)
{
    return map < 0 ? "colour" : maps->v[map].name;
}

tz_status tz_pictures_plan(tz_cli *cli, const char *output, const char *map_output,
                           const tz_map_list *maps, tz_name_values v,
                           tz_picture_list *pictures)
{
    char stem[TZ_PARAM_STRING_SIZE], folder[TZ_PARAM_STRING_SIZE], ext[64];
    char *main_path = NULL;
    v.map = "colour";
    tz_status s = tz_name_expand(cli->ctx, output, &v, &main_path);
    if (s != TZ_OK)
        return s;
    bool piped = strcmp(main_path, "-") == 0;
    tz_path_stem(main_path, stem, sizeof stem);
    tz_path_folder(main_path, folder, sizeof folder);
    snprintf(ext, sizeof ext, "%s", tz_path_extension(main_path));
    if (tz_cli_makes(cli, "colour"))
        s = add_picture(cli, main_path, -1, pictures);
    else
        tz_free(cli->ctx, main_path);
    if (!piped)
        v.name = stem, v.ext = ext;
    for (int32_t i = 0; s == TZ_OK && i < maps->n; i++) {
        if (!tz_cli_makes(cli, maps->v[i].name))
            continue;
        char *path = NULL, joined[2 * TZ_PARAM_STRING_SIZE];
        v.map = maps->v[i].name;
        /* Under replay the one thing made goes to --output itself. */
        s = tz_name_expand(cli->ctx, cli->replay ? output : map_output, &v, &path);
        if (s == TZ_OK && !cli->replay && !strchr(path, '/') && *folder) {
            snprintf(joined, sizeof joined, "%s%s", folder, path);
            tz_free(cli->ctx, path);
            path = NULL;
            s = tz_strdup(cli->ctx, joined, &path);
        }
        if (s == TZ_OK)
            s = add_picture(cli, path, i, pictures);
    }
    return s;
}

tz_status tz_pictures_check(tz_cli *cli, const tz_picture_list *l,
                            const tz_format_params *format)
{
    tz_image_write_options opt;
    tz_status s = TZ_OK;
    for (int32_t i = 0; s == TZ_OK && i < l->n; i++)
        s = tz_format_settle(cli->ctx, l->v[i].path, format, NULL, &opt);
    return s;
}

void tz_pictures_free(tz_ctx *ctx, tz_picture_list *l)
{
    for (int32_t i = 0; i < l->n; i++)
        tz_free(ctx, l->v[i].path);
    tz_array_free(ctx, l);
}

static tz_status match_colour(tz_ctx *ctx, tz_image *images, int32_t n)
{
    tz_image **p = NULL;
    tz_status s = tz_alloc(ctx, &p, (size_t)n, sizeof *p);
    for (int32_t i = 0; s == TZ_OK && i < n; i++)
        p[i] = &images[i];
    if (s == TZ_OK)
        s = tz_images_match(ctx, p, n);
    tz_free(ctx, p);
    return s;
}

tz_status tz_map_load(tz_cli *cli, const tz_map *map, tz_image *images, tz_record *extra)
{
    tz_status s = TZ_OK;
    const tz_image_read_options opt = read_options(map->kind);
    for (int32_t k = 0; s == TZ_OK && k < map->path.n; k++) {
        s = tz_image_read(cli->ctx, tz_cli_find(cli, map->path.v[k]), &opt, &images[k]);
        if (s == TZ_OK)
            s = tz_record_input(cli, extra, map->path.v[k], NULL);
        if (s == TZ_OK && images[k].channels != images[0].channels &&
            map->kind != TZ_MAP_COLOUR)
            s = tz_fail(cli->ctx, TZ_INVALID,
                        "%s: has %d channels, %s has %d; maps of one "
                        "name must agree",
                        map->path.v[k], images[k].channels, map->path.v[0],
                        images[0].channels);
    }
    return s == TZ_OK && map->kind == TZ_MAP_COLOUR
               ? match_colour(cli->ctx, images, map->path.n)
               : s;
}

static tz_status render_one(tz_cli *cli, const tz_material *m, const tz_picture *p)
{
    const tz_map *map = p->map < 0 ? NULL : &m->maps->v[p->map];
    tz_image *images = NULL;
    tz_record extra = {0};
    char *recipe = NULL;
    tz_render_figures f = {0};
    double start = tz_seconds();
    tz_status s = TZ_OK;
    if (map) {
        s = tz_alloc_zero(cli->ctx, &images, (size_t)m->n, sizeof *images);
        if (s == TZ_OK)
            s = tz_map_load(cli, map, images, &extra);
        tz_figures_seconds(cli, "read", tz_seconds() - start);
    }
    if (s == TZ_OK)
        s = tz_record_text(cli, m->record, &extra, name_of_map(m->maps, p->map), &recipe);
    if (s != TZ_OK)
        goto done;
    const tz_render_job job = {m->layout,  map ? images : m->photos,
                               m->n,       map ? map->kind : TZ_MAP_COLOUR,
                               m->compose, p->path,
                               m->format,  recipe};
    s = tz_expand_render(cli->ctx, &job, &f);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "render", f.render);
    tz_figures_seconds(cli, "write", f.write);
    tz_figures_output(cli, p->path, name_of_map(m->maps, p->map), f.width, f.height);
done:
    for (int32_t i = 0; images && i < m->n; i++)
        tz_image_deinit(&images[i]);
    tz_free(cli->ctx, images);
    tz_record_free(cli, &extra);
    tz_free(cli->ctx, recipe);
    return s;
}

tz_status tz_pictures_render(tz_cli *cli, const tz_material *m,
                             const tz_picture_list *pictures, int32_t first, int32_t end)
{
    tz_status s = TZ_OK;
    for (int32_t i = first; s == TZ_OK && i < end; i++)
        s = render_one(cli, m, &pictures->v[i]);
    return s;
}
