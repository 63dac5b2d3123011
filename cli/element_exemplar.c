/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/element_exemplar.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "cli/exemplars.h"
#include "cli/figures.h"
#include "synthesis/element_ground.h"

tz_status tz_element_exemplar_judge(tz_cli *cli, const char *path,
                                    const tz_things_params *things, const char *model,
                                    tz_record *record, tz_element_exemplar *e,
                                    tz_things_verdict *verdict)
{
    tz_source src = {0};
    tz_things_params p = *things;
    double start = tz_seconds();
    snprintf(p.model, sizeof p.model, "%s", model);
    tz_status s = tz_source_read(cli->ctx, tz_cli_find(cli, path), &src);
    if (s == TZ_OK && record)
        s = tz_record_input(cli, record, path, src.sha256);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &e->inputs, src.path);
    if (s == TZ_OK)
        s = tz_element_photos_init(cli, 1, &e->photos);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "read", tz_seconds() - start);
    start = tz_seconds();
    s = tz_things_judge(cli->ctx, &src.photo, &p, &e->set, &e->photos.plate[0], NULL,
                        verdict);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "analyze", tz_seconds() - start);
    tz_figures_count(cli, "elements", e->set.element.n);
    e->photos.photo[0] = src.photo;
    src.photo = (tz_image){0};
    e->found = true;
    s = tz_things_name_photo(&e->set, src.path, src.sha256, NULL);
    if (s == TZ_OK)
        s = tz_element_photos_match(cli, &e->photos, NULL, 0);
done:
    tz_source_deinit(&src);
    return s;
}

tz_status tz_element_exemplar_read(tz_cli *cli, const char *path,
                                   const tz_medium_params *medium,
                                   const tz_things_params *things, const char *model,
                                   tz_record *record, tz_element_exemplar *e)
{
    tz_things_verdict verdict;
    tz_status s;
    if (!tz_path_is_svg(path)) {
        s = tz_element_exemplar_judge(cli, path, things, model, record, e, &verdict);
        return s == TZ_OK && e->set.element.n == 0
                   ? tz_fail(
                         cli->ctx, TZ_INVALID,
                         "%s: no things stand out in it; try another --size-range, or "
                         "--as edges",
                         path)
                   : s;
    }
    s = tz_paths_add(cli->ctx, &e->inputs, tz_cli_find(cli, path));
    if (s == TZ_OK)
        s = tz_elements_read(cli, path, medium, things->classes, record, &e->set);
    if (s == TZ_OK)
        s = tz_element_photos_read(cli, &e->set, record, &e->inputs, &e->photos);
    return s == TZ_OK ? tz_element_photos_match(cli, &e->photos, NULL, 0) : s;
}

/* ---- plate ------------------------------------------------------------------------- */

tz_status tz_element_exemplar_name_plate(tz_cli *cli, const char *document,
                                         tz_path_list *outputs, tz_element_exemplar *e)
{
    char folder[TZ_PARAM_STRING_SIZE], stem[TZ_PARAM_STRING_SIZE],
        path[2 * TZ_PARAM_STRING_SIZE + 16];
    if (!e->found || e->plate || !e->photos.plate[0].px || !tz_path_is_svg(document))
        return TZ_OK;
    tz_path_folder(document, folder, sizeof folder);
    tz_path_stem(document, stem, sizeof stem);
    snprintf(path, sizeof path, "%s%s.plate.png", folder, stem);
    tz_status s = tz_strdup(cli->ctx, path, &e->plate);
    return s == TZ_OK ? tz_paths_add(cli->ctx, outputs, path) : s;
}

tz_status tz_element_exemplar_write_plate(tz_cli *cli, tz_element_exemplar *e)
{
    char photo[65];
    tz_format_params format;
    tz_image_write_options opt;
    if (!e->plate)
        return TZ_OK;
    tz_params_default(&tz_format_param_table, &format);
    tz_status s =
        tz_format_settle(cli->ctx, e->plate, &format, &e->photos.photo[0], &opt);
    if (s == TZ_OK)
        s = tz_image_write(cli->ctx, e->plate, &e->photos.plate[0], &opt);
    if (s != TZ_OK)
        return s;
    memcpy(photo, e->set.photo.v[0].sha256, sizeof photo);
    char *path = NULL;
    s = tz_strdup(cli->ctx, e->set.photo.v[0].path, &path);
    if (s == TZ_OK)
        s = tz_things_name_photo(&e->set, path, photo, e->plate);
    tz_free(cli->ctx, path);
    return s;
}

tz_status tz_element_exemplar_ground(tz_cli *cli, const tz_element_exemplar *e,
                                     const tz_ebpt_params *analyze,
                                     const tz_domain *domain, uint64_t seed,
                                     tz_layout *ground)
{
    char sha256[65] = "";
    if (e->photos.n == 0 || !e->photos.plate[0].px)
        return TZ_OK;
    const char *path = e->plate ? e->plate : e->set.photo.v[0].plate;
    const double start = tz_seconds();
    tz_status s = TZ_OK;
    if (path)
        s = tz_file_sha256(cli->ctx, path, sha256);
    if (s == TZ_OK)
        s = tz_element_ground_arrange(cli->ctx, &e->photos.plate[0],
                                      path ? path : "plate", sha256, analyze, domain,
                                      seed, ground);
    tz_figures_seconds(cli, "ground", tz_seconds() - start);
    return s;
}

void tz_element_exemplar_free(tz_cli *cli, tz_element_exemplar *e)
{
    tz_element_photos_free(cli, &e->photos);
    tz_element_set_deinit(&e->set);
    tz_paths_free(cli->ctx, &e->inputs);
    tz_free(cli->ctx, e->plate);
    *e = (tz_element_exemplar){0};
}

tz_domain tz_element_domain(const tz_cli *cli, const tz_element_set *exemplar,
                            const tz_arrange_params *arrange, double grow)
{
    tz_domain d = {.size = exemplar->domain.size, .torus = arrange->tile};
    if (tz_cli_given(cli, "size")) {
        d.size.x = arrange->size[0];
        d.size.y = arrange->size[1];
    } else {
        d.size.x *= grow;
        d.size.y *= grow;
        if (exemplar->photo.n > 0) {
            d.size.x = fmax(1, rint(d.size.x));
            d.size.y = fmax(1, rint(d.size.y));
        }
    }
    return d;
}
