/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/layout_pictures.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/figures.h"
#include "synthesis/element_ground.h"

/* ---- maps -------------------------------------------------------------------------- */

static int32_t index_of(const char *name, const char *const *names, int32_t n)
{
    for (int32_t i = 0; i < n; i++)
        if (strcmp(names[i], name) == 0)
            return i;
    return -1;
}

/* "a, b and c" */
static void list_names(const char *const *names, int32_t n, char *out, size_t size)
{
    size_t at = 0;
    for (int32_t i = 0; i < n && at < size; i++)
        at += (size_t)snprintf(out + at, size - at, "%s%s",
                               i == 0       ? ""
                               : i + 1 == n ? " and "
                                            : ", ",
                               names[i]);
}

tz_status tz_layout_maps_parse(tz_cli *cli, const char *text, int32_t photos,
                               const char *const *names, int32_t n, tz_element_maps *out)
{
    char known[200] = "";
    list_names(names, n, known, sizeof known);
    tz_status s = tz_maps_parse(cli->ctx, text, -1, &out->map);
    for (int32_t i = 0; i < out->map.n && s == TZ_OK; i++) {
        const tz_map *m = &out->map.v[i];
        const int32_t what = index_of(m->name, names, n), want = what >= 0 ? 1 : photos;
        if (m->path.n != want && photos == 0)
            s = tz_fail(cli->ctx, TZ_INVALID,
                        "--maps: a drawing has no photo that '%s' could be a map of; "
                        "there are %s",
                        m->name, known);
        else if (m->path.n != want)
            s = tz_fail(cli->ctx, TZ_INVALID,
                        "--maps: %s is given %d times, wanted %d times; give a map once "
                        "a photo",
                        m->name, m->path.n, want);
        else
            s = tz_array_push(cli->ctx, &out->what, what);
    }
    return s;
}

tz_status tz_layout_maps_paths(tz_cli *cli, const tz_element_maps *maps,
                               tz_path_list *inputs)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < maps->map.n && s == TZ_OK; i++)
        for (int32_t k = 0; k < maps->map.v[i].path.n && s == TZ_OK; k++)
            if (maps->what.v[i] < 0)
                s = tz_paths_add(cli->ctx, inputs,
                                 tz_cli_find(cli, maps->map.v[i].path.v[k]));
    return s;
}

/* ---- pictures ---------------------------------------------------------------------- */

void tz_layout_pixels(const tz_domain *d, double scale, int32_t size[2])
{
    size[0] = (int32_t)fmin(1e9, fmax(1, rint(d->size.x * scale)));
    size[1] = (int32_t)fmin(1e9, fmax(1, rint(d->size.y * scale)));
}

tz_status tz_layout_pictures_plan(tz_cli *cli, const tz_layout_wish *w,
                                  const tz_element_maps *maps, tz_path_list *inputs,
                                  tz_picture_list *pictures)
{
    char stem[TZ_PARAM_STRING_SIZE];
    tz_path_list outputs = {0};
    tz_rect crop;
    int32_t size[2];
    tz_layout_pixels(w->domain, w->scale, size);
    tz_path_stem(cli->operand[0], stem, sizeof stem);
    const tz_name_values names = {stem, "png", "colour", 0, size[0], size[1]};
    tz_status s =
        tz_element_pictures_plan(cli, w->output, w->map_output, maps, names, pictures);
    for (int32_t i = 0; s == TZ_OK && i < pictures->n; i++)
        s = tz_paths_add(cli->ctx, &outputs, pictures->v[i].path);
    if (s == TZ_OK)
        s = tz_layout_maps_paths(cli, maps, inputs);
    if (s == TZ_OK && cli->piped && cli->common->json)
        s = tz_cli_usage(cli, "--json and the image both want standard output");
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, inputs, &outputs);
    if (s == TZ_OK)
        s = tz_pictures_check(cli, pictures, w->format);
    if (s == TZ_OK)
        s = tz_crop_settle(cli->ctx, size, w->compose, &crop);
    tz_paths_free(cli->ctx, &outputs);
    return s;
}

/* ---- documents --------------------------------------------------------------------- */

tz_status tz_layout_document(tz_cli *cli, const char *path, const tz_record *record,
                             const tz_layout *ground, tz_element_set *elements,
                             char **recipe, const void *set,
                             tz_status (*write)(tz_ctx *ctx, const char *path,
                                                const void *set))
{
    char *background = NULL;
    tz_status s = tz_record_text(cli, record, NULL, "layout", recipe);
    if (s == TZ_OK && ground->place.n > 0) {
        background = elements->background;
        elements->background = NULL;
        s = tz_element_ground_embed(cli->ctx, path, ground, elements);
        if (s == TZ_OK)
            s = write(cli->ctx, path, set);
        tz_free(cli->ctx, elements->background);
        elements->background = background;
        return s;
    }
    return s == TZ_OK ? write(cli->ctx, path, set) : s;
}

void tz_layout_tell(tz_cli *cli, const char *path, const char *what, const tz_domain *d)
{
    tz_figures_output(cli, path, what, (int32_t)fmin(2e9, rint(d->size.x)),
                      (int32_t)fmin(2e9, rint(d->size.y)));
}
