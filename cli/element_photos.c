/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/element_photos.h"

#include <string.h>

#include "cli/figures.h"

tz_status tz_picture_read(tz_cli *cli, const char *path, const char *sha256,
                          int32_t width, int32_t height, tz_record *record,
                          tz_path_list *inputs, tz_image *out)
{
    tz_source src = {0};
    tz_status s = tz_source_read(cli->ctx, tz_cli_find(cli, path), &src);
    if (s != TZ_OK)
        return s;
    if ((int64_t)src.photo.width * height != (int64_t)src.photo.height * width)
        s = tz_fail(cli->ctx, TZ_INVALID,
                    "%s: is %d x %d, the elements were cut from %d x %d; give a photo of "
                    "that size or in proportion to it",
                    path, src.photo.width, src.photo.height, width, height);
    else if (sha256[0] && strcmp(sha256, src.sha256) != 0)
        tz_warn(cli->ctx, "%s: has changed since the elements were cut from it", path);
    if (s == TZ_OK && record)
        s = tz_record_input(cli, record, path, src.sha256);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, inputs, src.path);
    if (s == TZ_OK) {
        *out = src.photo;
        src.photo = (tz_image){0};
    }
    tz_source_deinit(&src);
    return s;
}

tz_status tz_element_photos_init(tz_cli *cli, int32_t n, tz_element_photos *p)
{
    tz_status s = tz_alloc_zero(cli->ctx, &p->photo, (size_t)n, sizeof *p->photo);
    if (s == TZ_OK)
        s = tz_alloc_zero(cli->ctx, &p->plate, (size_t)n, sizeof *p->plate);
    p->n = n;
    return s;
}

tz_status tz_element_photos_read(tz_cli *cli, const tz_element_set *set,
                                 tz_record *record, tz_path_list *inputs,
                                 tz_element_photos *p)
{
    const double start = tz_seconds();
    tz_status s = tz_element_photos_init(cli, set->photo.n, p);
    for (int32_t i = 0; i < set->photo.n && s == TZ_OK; i++) {
        const tz_element_photo *f = &set->photo.v[i];
        s = tz_picture_read(cli, f->path, f->sha256, f->width, f->height, record, inputs,
                            &p->photo[i]);
        if (s == TZ_OK && f->plate)
            s = tz_picture_read(cli, f->plate, "", f->width, f->height, record, inputs,
                                &p->plate[i]);
    }
    tz_figures_seconds(cli, "read", tz_seconds() - start);
    return s;
}

tz_status tz_element_photos_match(tz_cli *cli, tz_element_photos *p, tz_image *more,
                                  int32_t n)
{
    tz_image **all = NULL;
    int32_t used = 0;
    tz_status s = tz_alloc(cli->ctx, &all, 2 * (size_t)p->n + (size_t)n, sizeof *all);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < p->n; i++) {
        all[used++] = &p->photo[i];
        if (p->plate[i].px)
            all[used++] = &p->plate[i];
    }
    for (int32_t i = 0; i < n; i++)
        all[used++] = &more[i];
    s = tz_images_match(cli->ctx, all, used);
    tz_free(cli->ctx, all);
    return s;
}

void tz_element_photos_free(tz_cli *cli, tz_element_photos *p)
{
    for (int32_t i = 0; p->photo && i < p->n; i++)
        tz_image_deinit(&p->photo[i]);
    for (int32_t i = 0; p->plate && i < p->n; i++)
        tz_image_deinit(&p->plate[i]);
    tz_free(cli->ctx, p->photo);
    tz_free(cli->ctx, p->plate);
    *p = (tz_element_photos){0};
}
