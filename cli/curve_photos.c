/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/curve_photos.h"

#include <stdio.h>
#include <string.h>

#include "analysis/things.h"
#include "cli/exemplars.h"
#include "cli/figures.h"

tz_status tz_curve_exemplar_find(tz_cli *cli, const char *path, const tz_lines_params *p,
                                 tz_record *record, tz_curve_exemplar *e)
{
    tz_source src = {0};
    double start = tz_seconds();
    tz_status s = tz_source_read(cli->ctx, tz_cli_find(cli, path), &src);
    if (s == TZ_OK && record)
        s = tz_record_input(cli, record, path, src.sha256);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &e->inputs, src.path);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "read", tz_seconds() - start);
    start = tz_seconds();
    s = tz_lines_find(cli->ctx, &src.photo, p, &e->set, &e->plate, &e->found);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "analyze", tz_seconds() - start);
    tz_figures_count(cli, "paths", e->set.path.n);
    tz_figures_text(cli, "lines", e->found.why);
    e->photo = src.photo;
    src.photo = (tz_image){0};
    s = tz_things_name_photo(&e->set.element, src.path, src.sha256, NULL);
done:
    tz_source_deinit(&src);
    return s;
}

tz_status tz_curve_exemplar_name_plate(tz_cli *cli, const char *document,
                                       tz_path_list *outputs, tz_curve_exemplar *e)
{
    char folder[TZ_PARAM_STRING_SIZE], stem[TZ_PARAM_STRING_SIZE],
        path[2 * TZ_PARAM_STRING_SIZE + 16];
    if (e->plate_path || !e->plate.px || !tz_path_is_svg(document))
        return TZ_OK;
    tz_path_folder(document, folder, sizeof folder);
    tz_path_stem(document, stem, sizeof stem);
    snprintf(path, sizeof path, "%s%s.plate.png", folder, stem);
    const tz_status s = tz_strdup(cli->ctx, path, &e->plate_path);
    return s == TZ_OK ? tz_paths_add(cli->ctx, outputs, path) : s;
}

tz_status tz_curve_exemplar_write_plate(tz_cli *cli, tz_curve_exemplar *e)
{
    char sha256[65], *path = NULL;
    tz_format_params format;
    tz_image_write_options opt;
    if (!e->plate_path)
        return TZ_OK;
    tz_params_default(&tz_format_param_table, &format);
    tz_status s = tz_format_settle(cli->ctx, e->plate_path, &format, &e->photo, &opt);
    if (s == TZ_OK)
        s = tz_image_write(cli->ctx, e->plate_path, &e->plate, &opt);
    if (s != TZ_OK)
        return s;
    memcpy(sha256, e->set.element.photo.v[0].sha256, sizeof sha256);
    s = tz_strdup(cli->ctx, e->set.element.photo.v[0].path, &path);
    if (s == TZ_OK)
        s = tz_things_name_photo(&e->set.element, path, sha256, e->plate_path);
    tz_free(cli->ctx, path);
    return s;
}

void tz_curve_exemplar_free(tz_cli *cli, tz_curve_exemplar *e)
{
    tz_curve_set_deinit(&e->set);
    tz_image_deinit(&e->photo);
    tz_image_deinit(&e->plate);
    tz_paths_free(cli->ctx, &e->inputs);
    tz_free(cli->ctx, e->plate_path);
    *e = (tz_curve_exemplar){0};
}

tz_status tz_analyze_curves(tz_cli *cli, const char *path, const char *output,
                            const tz_lines_params *p)
{
    tz_curve_exemplar e = {0};
    tz_path_list outputs = {0};
    const tz_curve_output_params as_named = {0};
    const tz_curve_input_params as_drawn = {0};
    tz_curve_format format;
    cli->piped = strcmp(output, "-") == 0;
    if (cli->piped && cli->common->json)
        return tz_cli_usage(cli, "--json and the curves both want standard output");
    tz_status s = tz_curves_format(cli, output, &as_named, &format);
    if (s == TZ_OK && tz_path_is_svg(path))
        s = tz_curves_read(cli, path, &as_drawn, false, NULL, &e.inputs, &e.set);
    else if (s == TZ_OK)
        s = tz_curve_exemplar_find(cli, path, p, NULL, &e);
    if (s == TZ_OK && e.set.path.n == 0)
        s = tz_fail(cli->ctx, TZ_INVALID,
                    "%s: no lines stand out in it; try a smaller --line-strength, "
                    "--line edge, or --as edges",
                    path);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &outputs, output);
    if (s == TZ_OK)
        s = tz_curve_exemplar_name_plate(cli, output, &outputs, &e);
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &e.inputs, &outputs);
    if (s == TZ_OK)
        s = tz_curve_exemplar_write_plate(cli, &e);
    if (s == TZ_OK)
        s = tz_curves_write(cli, output, &as_named, &e.set);
    tz_curve_exemplar_free(cli, &e);
    tz_paths_free(cli->ctx, &outputs);
    return s;
}
