/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/exemplars.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#include "cli/figures.h"

static const tz_param rules_rows[] = {
    {"rules", TZ_PARAM_STRING, offsetof(tz_rules_params, rules), 0, 0, "", "FILE", NULL,
     "Rule file (JSON): which groups go where, how turned and how large."},
};
const tz_param_table tz_rules_param_table = {"rules", "Procedural rules.", rules_rows, 1,
                                             sizeof(tz_rules_params)};

static const tz_param growth_rows[] = {
    {"grow", TZ_PARAM_DOUBLE, offsetof(tz_enlarge_params, grow), 0.01, 10000, "4", "",
     NULL,
     "Where --size is not given: the layout's sides are the first photo's times this."},
};
const tz_param_table tz_enlarge_param_table = {"growth", "Size without --size.",
                                               growth_rows, 1, sizeof(tz_enlarge_params)};

bool tz_path_is_svg(const char *path)
{
    return strcasecmp(tz_path_extension(path), "svg") == 0;
}

static tz_status match(tz_cli *cli, tz_exemplars *e)
{
    tz_image **p = NULL;
    tz_status s = tz_alloc(cli->ctx, &p, (size_t)e->n, sizeof *p);
    for (int32_t i = 0; s == TZ_OK && i < e->n; i++)
        p[i] = &e->v[i].photo;
    if (s == TZ_OK)
        s = tz_images_match(cli->ctx, p, e->n);
    tz_free(cli->ctx, p);
    return s;
}

tz_status tz_exemplars_read(tz_cli *cli, tz_record *record, tz_exemplars *e)
{
    double start = tz_seconds();
    tz_status s = tz_alloc_zero(cli->ctx, &e->v, (size_t)cli->operands, sizeof *e->v);
    for (int32_t i = 0; s == TZ_OK && i < cli->operands; i++) {
        const char *path = cli->operand[i], *at = tz_cli_find(cli, path);
        bool svg = tz_path_is_svg(path);
        s = svg ? tz_source_read_exemplar(cli->ctx, at, &e->v[i])
                : tz_source_read(cli->ctx, at, &e->v[i]);
        if (s != TZ_OK)
            break;
        e->n++;
        if (svg)
            s = tz_record_input(cli, record, path, NULL);
        if (s == TZ_OK)
            s = tz_record_input(cli, record, svg ? e->v[i].path : path, e->v[i].sha256);
        if (s == TZ_OK)
            s = tz_paths_add(cli->ctx, &e->input, at);
        if (s == TZ_OK && svg)
            s = tz_paths_add(cli->ctx, &e->input, e->v[i].path);
    }
    if (s == TZ_OK)
        s = match(cli, e);
    tz_figures_seconds(cli, "read", tz_seconds() - start);
    return s;
}

tz_status tz_exemplars_analyze(tz_cli *cli, const tz_ebpt_params *params, tz_exemplars *e)
{
    double start = tz_seconds();
    tz_status s = TZ_OK;
    for (int32_t i = 0; s == TZ_OK && i < e->n; i++) {
        if (!e->v[i].ebpt.label)
            s = tz_source_analyze(cli->ctx, params, &e->v[i]);
        if (s == TZ_OK) {
            tz_figures_count(cli, "groups", e->v[i].ebpt.group.n);
            tz_figures_count(cli, "edges", e->v[i].ebpt.edge.n);
        }
    }
    tz_figures_seconds(cli, "analyze", tz_seconds() - start);
    return s;
}

tz_status tz_exemplars_write(tz_cli *cli, const tz_exemplars *e, int32_t i,
                             const char *path)
{
    const tz_source *src = &e->v[i];
    double start = tz_seconds();
    char *photo = NULL;
    tz_status s = strcmp(src->path, "-") == 0
                      ? tz_fail(cli->ctx, TZ_INVALID,
                                "%s: an exemplar refers to its photo, "
                                "which must be a file and not standard input",
                                path)
                      : tz_path_relative(cli->ctx, path, src->path, &photo);
    if (s == TZ_OK)
        s = tz_ebpt_write(cli->ctx, path, &src->ebpt, photo, src->sha256);
    tz_free(cli->ctx, photo);
    if (s != TZ_OK)
        return s;
    tz_figures_seconds(cli, "write", tz_seconds() - start);
    tz_figures_output(cli, path, "exemplar", src->ebpt.width, src->ebpt.height);
    return TZ_OK;
}

void tz_exemplars_free(tz_cli *cli, tz_exemplars *e)
{
    for (int32_t i = 0; i < e->n; i++)
        tz_source_deinit(&e->v[i]);
    tz_free(cli->ctx, e->v);
    tz_paths_free(cli->ctx, &e->input);
    *e = (tz_exemplars){0};
}

tz_status tz_arrange_settle(tz_cli *cli, const tz_exemplars *e, double grow,
                            tz_arrange_params *p)
{
    const tz_image *photo = &e->v[0].photo;
    double w = fmax(1, rint(photo->width * grow)),
           h = fmax(1, rint(photo->height * grow));
    if (tz_cli_given(cli, "rotation") && !tz_cli_given(cli, "rotate-auto"))
        p->rotate_auto = false;
    if (tz_cli_given(cli, "size"))
        return TZ_OK;
    if (w > TZ_IMAGE_MAX_SIDE || h > TZ_IMAGE_MAX_SIDE)
        return tz_fail(
            cli->ctx, TZ_LIMIT,
            "%s: %g times %d x %d pixels is too large; give a --size of at most "
            "%d a side",
            e->v[0].path, grow, photo->width, photo->height, TZ_IMAGE_MAX_SIDE);
    p->size[0] = (int32_t)w;
    p->size[1] = (int32_t)h;
    return TZ_OK;
}
