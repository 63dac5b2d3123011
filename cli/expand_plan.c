/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/expand_plan.h"

#include <string.h>

#include "cli/exemplars.h"

static const tz_param rows[] = {
    {"seeds", TZ_PARAM_STRING, offsetof(tz_expand_params, seeds), 0, 0, "", "SEEDS", NULL,
     "Makes one variant a seed: 1..8, or 1,4,10..12. The names need {seed}."},
    {"save-exemplar", TZ_PARAM_STRING, offsetof(tz_expand_params, save_exemplar), 0, 0,
     "", "FILE", NULL, "Also writes the (first) exemplar as SVG."},
    {"save-layout", TZ_PARAM_STRING, offsetof(tz_expand_params, save_layout), 0, 0, "",
     "FILE", NULL, "Also writes the layout as SVG; edit it and render it again."},
};
const tz_param_table tz_expand_param_table = {"expand", "What to make.", rows,
                                              sizeof rows / sizeof rows[0],
                                              sizeof(tz_expand_params)};

tz_status tz_expand_seeds(tz_cli *cli, const tz_expand_wish *w, tz_expand_plan *p)
{
    return *w->own->seeds ? tz_seeds_parse(cli->ctx, w->own->seeds, &p->seeds)
                          : tz_array_push(cli->ctx, &p->seeds, w->seed);
}

static tz_status plan_seed(tz_cli *cli, const tz_expand_wish *w, int32_t i,
                           tz_expand_plan *p, tz_path_list *outputs)
{
    char stem[TZ_PARAM_STRING_SIZE];
    const char *photo = cli->operand[0], *ext = tz_path_extension(photo);
    tz_path_stem(photo, stem, sizeof stem);
    const tz_name_values v = {stem,     *ext && !tz_path_is_svg(photo) ? ext : "png",
                              "layout", p->seeds.v[i],
                              w->width, w->height};
    tz_status s = TZ_OK;
    if (*w->own->save_layout && tz_cli_makes(cli, "layout")) {
        char *path = NULL;
        s = tz_name_expand(cli->ctx, w->own->save_layout, &v, &path);
        if (s == TZ_OK)
            s = tz_paths_add(cli->ctx, &p->layouts, path);
        if (s == TZ_OK)
            s = tz_paths_add(cli->ctx, outputs, path);
        cli->piped = cli->piped || (path && strcmp(path, "-") == 0);
        tz_free(cli->ctx, path);
    }
    p->first[i] = p->pictures.n;
    if (s == TZ_OK && *w->output)
        s = w->pictures(cli, w->user, v, &p->pictures);
    p->first[i + 1] = p->pictures.n;
    for (int32_t k = p->first[i]; s == TZ_OK && k < p->pictures.n; k++)
        s = tz_paths_add(cli->ctx, outputs, p->pictures.v[k].path);
    return s;
}

tz_status tz_expand_plan_make(tz_cli *cli, const tz_expand_wish *w, tz_expand_plan *p)
{
    tz_path_list outputs = {0};
    const char *exemplar = w->own->save_exemplar;
    if (!*w->output && !*w->own->save_layout && !*exemplar)
        return tz_cli_usage(cli, "no output; give one with -o FILE");
    tz_status s =
        tz_alloc_zero(cli->ctx, &p->first, (size_t)p->seeds.n + 1, sizeof *p->first);
    for (int32_t i = 0; s == TZ_OK && i < p->seeds.n; i++)
        s = plan_seed(cli, w, i, p, &outputs);
    if (s == TZ_OK && *exemplar) {
        cli->piped = cli->piped || strcmp(exemplar, "-") == 0;
        s = tz_paths_add(cli->ctx, &outputs, exemplar);
    }
    for (int32_t i = 0; s == TZ_OK && w->besides && i < w->besides->n; i++)
        s = tz_paths_add(cli->ctx, &outputs, w->besides->v[i]);
    if (s == TZ_OK && cli->piped && cli->common->json)
        s = tz_cli_usage(cli, "--json and an output both want standard output");
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, w->inputs, &outputs);
    if (s == TZ_OK)
        s = tz_pictures_check(cli, &p->pictures, w->format);
    tz_paths_free(cli->ctx, &outputs);
    return s;
}

void tz_expand_plan_free(tz_cli *cli, tz_expand_plan *p)
{
    tz_array_free(cli->ctx, &p->seeds);
    tz_paths_free(cli->ctx, &p->layouts);
    tz_pictures_free(cli->ctx, &p->pictures);
    tz_free(cli->ctx, p->first);
    *p = (tz_expand_plan){0};
}
