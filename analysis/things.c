/* SPDX-License-Identifier: Apache-2.0 */
/* Photo to things:
 *
 *   photo -> strength of borders: edge forest times fine gradient   things_picture.c
 *         -> tree of regions, joined where borders are weak         things_tree.c
 *         -> the best disjoint choice of regions that are things    things_choose.c, _score.c
 *         -> pixels: joints go to the ground                        things_mask.c
 *         -> outlines finer than pixels                             things_outline.c
 *         -> which lies above which, hidden parts                   things_depth.c
 *         -> elements, samples, kinds                               things_set.c
 *         -> plate: ground where things have been                   things_plate.c */
#include "analysis/things.h"

#include <math.h>
#include <string.h>

#include "analysis/things_choose.h"
#include "analysis/things_depth.h"
#include "analysis/things_mask.h"
#include "analysis/things_picture.h"
#include "analysis/things_plate.h"

#define STEP  5.0  /* px, width of superpixels: what is smaller is no thing */
#define LEAST 16.0 /* px of the smallest thing there is */

static const tz_param rows[] = {
    {"size-range", TZ_PARAM_RANGE, offsetof(tz_things_params, size_range), 0, 1000000,
     "0", "px", NULL,
     "least and largest diameter of a thing (of a circle of its area); 0 is automatic"},
    {"classes", TZ_PARAM_INT, offsetof(tz_things_params, classes), 0, 64, "0", "", NULL,
     "wanted number of classes of things; 0 is automatic"},
    {"smoothing", TZ_PARAM_DOUBLE, offsetof(tz_things_params, smoothing), 0, 10, "1",
     "px", NULL, "how much outlines are smoothed"},
    {"certainty", TZ_PARAM_DOUBLE, offsetof(tz_things_params, certainty), 0, 1, "0.35",
     "", NULL, "what is less surely a thing than this is ground"},
};

const tz_param_table tz_things_param_table = {
    "elements", "Finds the things of a photo and cuts them out", rows,
    (int32_t)(sizeof rows / sizeof *rows), sizeof(tz_things_params)};

typedef struct work {
    tz_ctx *ctx;
    const tz_image *photo;
    const tz_things_params *params;
    tz_things_view view;
    tz_things_tree tree;
    tz_things_nodes chosen;
    int32_t *label, count;
    tz_things_found *found;
} work;

/* ---- stages -------------------------------------------------------------------------- */

static double disc(double diameter) { return 0.25 * TZ_PI * diameter * diameter; }

static tz_status find_regions(work *k)
{
    const double all = (double)k->photo->width * k->photo->height;
    const double *range = k->params->size_range;
    const tz_things_choice how = {.least = fmax(LEAST, disc(range[0])),
                                  .most = range[1] > 0 ? disc(range[1]) : all / 4,
                                  .certainty = k->params->certainty};
    tz_things_sizes sizes;
    tz_status s = tz_things_tree_grow(k->ctx, &k->view.picture, STEP, how.most, &k->tree);
    if (s == TZ_OK)
        s = tz_things_choose(k->ctx, &k->tree, &how, &k->chosen, NULL, &sizes);
    return s == TZ_OK ? tz_things_mask(k->ctx, &k->view.picture, &k->tree, &k->chosen,
                                       LEAST, k->label, &k->count)
                      : s;
}

/* What is too thin to have an outline is no thing. */
static tz_status drop_empty(work *k)
{
    const size_t n = (size_t)k->photo->width * (size_t)k->photo->height;
    int32_t *to = NULL, kept = 0;
    const tz_status s = tz_alloc(k->ctx, &to, (size_t)k->count + 1, sizeof *to);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < k->count; i++) {
        to[i] = k->found[i].outline.part.n > 0 ? kept : -1;
        if (to[i] >= 0)
            k->found[kept++] = k->found[i];
        else
            tz_things_outline_deinit(k->ctx, &k->found[i].outline);
    }
    for (size_t p = 0; p < n; p++)
        k->label[p] = k->label[p] >= 0 ? to[k->label[p]] : -1;
    k->count = kept;
    tz_free(k->ctx, to);
    return TZ_OK;
}

static tz_status find_outlines(work *k)
{
    const int32_t w = k->photo->width, h = k->photo->height;
    tz_things_outline *out = NULL;
    tz_status s = tz_alloc_zero(k->ctx, &out, (size_t)k->count + 1, sizeof *out);
    if (s == TZ_OK)
        s = tz_alloc_zero(k->ctx, &k->found, (size_t)k->count + 1, sizeof *k->found);
    if (s == TZ_OK)
        s = tz_things_outlines(k->ctx, k->label, w, h, k->count, k->params->smoothing,
                               out);
    for (int32_t i = 0; out && i < k->count; i++)
        if (k->found)
            k->found[i].outline = out[i];
    tz_free(k->ctx, out);
    if (s == TZ_OK)
        s = drop_empty(k);
    return s == TZ_OK ? tz_things_order(k->ctx, k->label, w, h, k->found, k->count) : s;
}

/* Elements stand by rising depth; the labels follow. */
static tz_status sort_found(work *k)
{
    const size_t n = (size_t)k->photo->width * (size_t)k->photo->height;
    tz_things_found *sorted = NULL;
    int32_t *to = NULL, *first = NULL, deepest = 0;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < k->count; i++)
        deepest = k->found[i].depth > deepest ? k->found[i].depth : deepest;
    s = tz_alloc(k->ctx, &sorted, (size_t)k->count + 1, sizeof *sorted);
    if (s == TZ_OK)
        s = tz_alloc(k->ctx, &to, (size_t)k->count + 1, sizeof *to);
    if (s == TZ_OK)
        s = tz_alloc_zero(k->ctx, &first, (size_t)deepest + 2, sizeof *first);
    if (s == TZ_OK) {
        for (int32_t i = 0; i < k->count; i++)
            first[k->found[i].depth + 1]++;
        for (int32_t d = 0; d <= deepest; d++)
            first[d + 1] += first[d];
        for (int32_t i = 0; i < k->count; i++) {
            to[i] = first[k->found[i].depth]++;
            sorted[to[i]] = k->found[i];
        }
        for (size_t p = 0; p < n; p++)
            k->label[p] = k->label[p] >= 0 ? to[k->label[p]] : -1;
        memcpy(k->found, sorted, (size_t)k->count * sizeof *sorted);
    }
    tz_free(k->ctx, sorted);
    tz_free(k->ctx, to);
    tz_free(k->ctx, first);
    return s;
}

static tz_status check(tz_ctx *ctx, const tz_image *photo, const tz_things_params *p)
{
    if (photo->width < 1 || photo->height < 1 || photo->channels < 1 ||
        photo->channels > 4 || photo->encoding == TZ_ENCODING_DATA)
        return tz_fail(ctx, TZ_INVALID,
                       "elements: a photo of 1 to 4 channels of colour is needed");
    if (p->size_range[1] > 0 && p->size_range[1] < p->size_range[0])
        return tz_fail(ctx, TZ_INVALID,
                       "elements: size-range %g,%g holds no size; give least,largest",
                       p->size_range[0], p->size_range[1]);
    return TZ_OK;
}

static void work_deinit(work *k)
{
    for (int32_t i = 0; k->found && i < k->count; i++)
        tz_things_outline_deinit(k->ctx, &k->found[i].outline);
    tz_free(k->ctx, k->found);
    tz_free(k->ctx, k->label);
    tz_array_free(k->ctx, &k->chosen);
    tz_things_tree_deinit(&k->tree);
    tz_things_view_deinit(k->ctx, &k->view);
}

tz_status tz_things_find(tz_ctx *ctx, const tz_image *photo,
                         const tz_things_params *params, tz_element_set *out,
                         tz_image *plate, int32_t *label)
{
    const int64_t pixels = (int64_t)photo->width * photo->height;
    work k = {.ctx = ctx, .photo = photo, .params = params};
    tz_status s = check(ctx, photo, params);

    *out = (tz_element_set){0};
    if (plate)
        *plate = (tz_image){0};
    if (s != TZ_OK)
        return s;
    tz_progress_begin(ctx, "elements", "px", 4 * pixels);
    if ((s = tz_alloc(ctx, &k.label, (size_t)pixels, sizeof *k.label)) != TZ_OK)
        goto done;
    if ((s = tz_things_look(ctx, photo, params->model, &k.view)) != TZ_OK)
        goto done;
    tz_progress_add(ctx, pixels);
    if ((s = find_regions(&k)) != TZ_OK)
        goto done;
    tz_progress_add(ctx, pixels);
    if ((s = find_outlines(&k)) != TZ_OK)
        goto done;
    if ((s = sort_found(&k)) != TZ_OK)
        goto done;
    tz_progress_add(ctx, pixels);
    s = tz_things_make_set(ctx, photo, k.label, k.found, k.count, params->classes, out);
    if (s == TZ_OK && plate)
        s = tz_things_plate(ctx, photo, k.label, plate);
    if (s == TZ_OK && tz_ctx_cancelled(ctx))
        s = TZ_CANCELLED;
    if (s == TZ_OK && label)
        memcpy(label, k.label, (size_t)pixels * sizeof *label);
    tz_progress_add(ctx, pixels);
done:
    tz_progress_end(ctx);
    work_deinit(&k);
    if (s != TZ_OK) {
        tz_element_set_deinit(out);
        if (plate)
            tz_image_deinit(plate);
    }
    return s;
}

/* ---- photo --------------------------------------------------------------------------- */

tz_status tz_things_name_photo(tz_element_set *s, const char *path, const char *sha256,
                               const char *plate)
{
    char *new_path = NULL, *new_plate = NULL;
    if (s->photo.n < 1)
        return tz_fail(s->ctx, TZ_INVALID, "%s: no element is cut from a photo", path);
    tz_status st = tz_strdup(s->ctx, path, &new_path);
    if (st == TZ_OK && plate)
        st = tz_strdup(s->ctx, plate, &new_plate);
    if (st != TZ_OK) {
        tz_free(s->ctx, new_path);
        return st;
    }
    tz_element_photo *p = &s->photo.v[0];
    tz_free(s->ctx, p->path);
    tz_free(s->ctx, p->plate);
    p->path = new_path;
    p->plate = new_plate;
    memset(p->sha256, 0, sizeof p->sha256);
    if (sha256 && strlen(sha256) == 64)
        memcpy(p->sha256, sha256, 64);
    return TZ_OK;
}
