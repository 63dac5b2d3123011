/* SPDX-License-Identifier: Apache-2.0 */
/* Photo to things, at half, one or double size:
 *
 *   photo -> strength of borders: edge forest times fine gradient   things_picture.c
 *         -> tree of regions, joined where borders are weak         things_tree.c
 *         -> the best disjoint choice of regions that are things    things_choose.c, _score.c
 *         -> pixels: joints go to the ground                        things_mask.c
 *         -> outlines finer than pixels                             things_outline.c
 *         -> which lies above which, hidden parts                   things_depth.c
 *         -> what is surely ground, what may be copied  things_ground.c, things_doubt.c
 *         -> elements, samples, kinds                               things_set.c
 *         -> plate: ground where things have been   things_plate.c, things_even.c
 *         -> whether the photo is made of things                    things_judge.c */
#include "analysis/things.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/things_choose.h"
#include "analysis/things_depth.h"
#include "analysis/things_doubt.h"
#include "analysis/things_judge.h"
#include "analysis/things_mask.h"
#include "analysis/things_picture.h"
#include "analysis/things_plate.h"

#define STEP   5.0 /* px, width of superpixels: what is smaller is no thing */
#define SMALL  8.6 /* log2 px of the middle thing: smaller ones want the double size */
#define LARGE  9.0 /* the same: larger ones need no more than the size looked at */
#define ENOUGH 8.5 /* the same in photos of more than MOST_DOUBLED px, for speed */
#define LEAST_HALVED \
    150000 /* px of a photo: larger ones are looked at in half size first */
#define MOST_DOUBLED 600000 /* px of a photo */
#define DOUBT        0.4    /* of the certainty: more is no sure ground */
#define ROUNDING     0.045 /* of the middle thing's diameter: as large a smoothing is 1 */
#define SCARCE       0.16  /* share of the picture: less ground than that is no plate */
#define COVERED      0.08  /* mean hidden share of piled things */
#define CLEAR        0.6   /* share of the things that is unlike the ground */
#define SOLID        0.95  /* mean share of the convex hulls */
#define LEAST        16.0  /* px of the smallest thing there is */

static const tz_param rows[] = {
    {"size-range", TZ_PARAM_RANGE, offsetof(tz_things_params, size_range), 0, 1000000,
     "0", "px", NULL,
     "least and largest diameter of a thing (of a circle of its area); 0 is automatic"},
    {"classes", TZ_PARAM_INT, offsetof(tz_things_params, classes), 0, 64, "0", "", NULL,
     "wanted number of classes of things; 0 is automatic"},
    {"smoothing", TZ_PARAM_DOUBLE, offsetof(tz_things_params, smoothing), 0, 10, "1", "",
     NULL, "how much outlines are smoothed; 1 suits the size of the things"},
    {"certainty", TZ_PARAM_DOUBLE, offsetof(tz_things_params, certainty), 0, 1, "0.35",
     "", NULL, "what is less surely a thing than this is ground"},
    {"detail", TZ_PARAM_ENUM, offsetof(tz_things_params, detail), 0, 0, "auto", "",
     "auto|normal|double",
     "at which size of the photo to look for things; auto starts at half in large ones "
     "and goes up to double in small ones"},
    {"plate", TZ_PARAM_ENUM, offsetof(tz_things_params, plate), 0, 0, "auto", "",
     "auto|ground|photo",
     "what lies beneath the things: ground with them taken out, or the photo itself, "
     "which "
     "suits piles; auto is the photo for piles"},
};

const tz_param_table tz_things_param_table = {
    "elements", "Finds the things of a photo and cuts them out", rows,
    (int32_t)(sizeof rows / sizeof *rows), sizeof(tz_things_params)};

/* What is found at one size of the photo. */
typedef struct search {
    double scale; /* 1/2, 1 or 2 times the photo's size; 0 = nothing */
    tz_things_view view;
    tz_things_tree tree;
    tz_things_nodes chosen;
    tz_things_sizes sizes;
    float *sure; /* of nodes */
    double gain; /* of the choice, see things_choose.c */
} search;

typedef struct work {
    tz_ctx *ctx;
    const tz_image *photo;
    const tz_things_params *params;
    search best;
    double scale;      /* of the labels, until they are scaled back */
    int32_t w, h;      /* size of the labels */
    uint8_t *doubtful; /* pixels of things that may have been missed */
    int32_t *label, count;
    float *sure; /* of labels */
    tz_things_sizes sizes;
    tz_things_found *found;
    tz_things_ground ground;
} work;

/* ---- stages -------------------------------------------------------------------------- */

static double disc(double diameter) { return 0.25 * TZ_PI * diameter * diameter; }

/* Pixels outside of chosen nodes that lie in one which is not surely no thing. */
static tz_status find_doubtful(work *k)
{
    enum { HOLDS = 1, WITHIN = 2 }; /* a chosen node; in or at one */
    const size_t n = (size_t)k->photo->width * (size_t)k->photo->height;
    const search *r = &k->best;
    const tz_things_tree *t = &r->tree;
    const float limit = (float)(DOUBT * k->params->certainty);
    uint8_t *where = NULL;
    tz_status s = tz_alloc(k->ctx, &k->doubtful, n, 1);
    if (s == TZ_OK)
        s = tz_alloc_zero(k->ctx, &where, (size_t)t->n, 1);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < r->chosen.n; i++) {
        for (int32_t v = r->chosen.v[i]; v >= 0 && !where[v]; v = t->node[v].parent)
            where[v] = HOLDS;
        where[r->chosen.v[i]] = WITHIN;
    }
    for (int32_t v = t->n - 1; v >= 0; v--) { /* sure becomes that of any node above */
        const int32_t up = t->node[v].parent;
        if (up >= 0 && where[up] == WITHIN)
            where[v] = WITHIN;
        r->sure[v] = where[v] ? 0 : fmaxf(r->sure[v], up >= 0 ? r->sure[up] : 0);
    }
    for (int32_t y = 0; y < k->photo->height; y++)
        for (int32_t x = 0; x < k->photo->width; x++) {
            const ptrdiff_t at = (ptrdiff_t)(y * r->scale) * r->view.picture.width +
                                 (ptrdiff_t)(x * r->scale);
            const int32_t leaf = t->leaf[at];
            k->doubtful[(ptrdiff_t)y * k->photo->width + x] = r->sure[leaf] > limit;
        }
    tz_free(k->ctx, where);
    return TZ_OK;
}

static void forget(tz_ctx *ctx, search *r)
{
    tz_array_free(ctx, &r->chosen);
    tz_free(ctx, r->sure);
    tz_things_tree_deinit(&r->tree);
    tz_things_view_deinit(ctx, &r->view);
    *r = (search){0};
}

/* @param photo  at that scale */
static tz_status look_for(const work *k, const tz_image *photo, double scale, search *r)
{
    const double area = scale * scale, *range = k->params->size_range;
    const double all = (double)photo->width * photo->height;
    const tz_things_choice how = {.least =
                                      fmax(fmax(scale, 1) * LEAST, area * disc(range[0])),
                                  .most = range[1] > 0 ? area * disc(range[1]) : all / 4,
                                  .certainty = k->params->certainty};
    *r = (search){.scale = scale};
    tz_status s = tz_things_look(k->ctx, photo, k->params->model, &r->view);
    if (s == TZ_OK)
        s = tz_things_tree_grow(k->ctx, &r->view.picture, STEP, how.most, &r->tree);
    if (s == TZ_OK)
        s = tz_alloc(k->ctx, &r->sure, (size_t)r->tree.n, sizeof *r->sure);
    if (s == TZ_OK)
        s = tz_things_choose(k->ctx, &r->tree, &how, &r->chosen, r->sure, &r->sizes);
    for (int32_t i = 0; s == TZ_OK && i < r->chosen.n; i++)
        r->gain += r->sure[r->chosen.v[i]] - how.certainty;
    if (s != TZ_OK)
        forget(k->ctx, r);
    return s;
}

/* Pixel i of the double size lies at (i - 1/2) / 2 of the photo: 3/4 of the nearer one. */
static tz_status make_twice(const work *k, tz_image *out)
{
    const tz_image *im = k->photo;
    const int32_t w = im->width, h = im->height, c = im->channels;
    const tz_status s = tz_image_init(k->ctx, out, 2 * w, 2 * h, c);
    if (s != TZ_OK)
        return s;
    out->encoding = im->encoding;
    out->alpha = im->alpha;
    for (int32_t y = 0; y < 2 * h; y++)
        for (int32_t x = 0; x < 2 * w; x++) {
            const int32_t nx = x / 2, ny = y / 2;
            int32_t fx = x % 2 ? nx + 1 : nx - 1, fy = y % 2 ? ny + 1 : ny - 1;
            fx = fx < 0 ? 0 : fx < w ? fx : w - 1;
            fy = fy < 0 ? 0 : fy < h ? fy : h - 1;
            for (int32_t i = 0; i < c; i++)
                tz_image_at(out, x, y)[i] = 0.75F * (0.75F * tz_image_at(im, nx, ny)[i] +
                                                     0.25F * tz_image_at(im, fx, ny)[i]) +
                                            0.25F * (0.75F * tz_image_at(im, nx, fy)[i] +
                                                     0.25F * tz_image_at(im, fx, fy)[i]);
        }
    return TZ_OK;
}

/* Means of 2 x 2; the last row and column of an odd photo stand for two. */
static tz_status make_half(const work *k, tz_image *out)
{
    const tz_image *im = k->photo;
    const int32_t w = (im->width + 1) / 2, h = (im->height + 1) / 2, c = im->channels;
    const tz_status s = tz_image_init(k->ctx, out, w, h, c);
    if (s != TZ_OK)
        return s;
    out->encoding = im->encoding;
    out->alpha = im->alpha;
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            const int32_t x1 = 2 * x + 1 < im->width ? 2 * x + 1 : 2 * x;
            const int32_t y1 = 2 * y + 1 < im->height ? 2 * y + 1 : 2 * y;
            for (int32_t i = 0; i < c; i++)
                tz_image_at(out, x, y)[i] =
                    0.25F *
                    (tz_image_at(im, 2 * x, 2 * y)[i] + tz_image_at(im, x1, 2 * y)[i] +
                     tz_image_at(im, 2 * x, y1)[i] + tz_image_at(im, x1, y1)[i]);
        }
    return TZ_OK;
}

/* Looks at the photo at another size; keeps what is found if more is gained by it. */
static tz_status look_at(work *k, double scale)
{
    tz_image other = {0};
    search r = {0};
    tz_status s = scale > 1   ? make_twice(k, &other)
                  : scale < 1 ? make_half(k, &other)
                              : TZ_OK;
    if (s == TZ_OK)
        s = look_for(k, scale == 1 ? k->photo : &other, scale, &r);
    tz_image_deinit(&other);
    if (s != TZ_OK)
        return s;
    if (k->best.scale == 0 || r.gain > k->best.gain) {
        const search old = k->best;
        k->best = r;
        r = old;
    }
    forget(k->ctx, &r);
    return TZ_OK;
}

/* Things are seen best where they are about 10 to 40 px wide: finer grain than that
 * parts them, coarser hides them. The photo is looked at in half its size first, where it
 * is large, and in more only where things want it. */
static tz_status look_around(work *k)
{
    const int64_t pixels = (int64_t)k->photo->width * k->photo->height;
    const tz_things_sizes *sizes = &k->best.sizes;
    const int32_t detail = k->params->detail;
    tz_status s = TZ_OK;
    if (detail == TZ_THINGS_DOUBLE)
        return look_at(k, 2);
    if (detail == TZ_THINGS_AUTO && pixels > LEAST_HALVED)
        s = look_at(k, 0.5);
    if (s != TZ_OK ||
        (sizes->known && sizes->middle > (pixels > MOST_DOUBLED ? ENOUGH : LARGE)))
        return s;
    s = look_at(k, 1);
    if (s == TZ_OK && detail == TZ_THINGS_AUTO && pixels <= MOST_DOUBLED &&
        k->best.scale == 1 && (!sizes->known || sizes->middle < SMALL))
        s = look_at(k, 2);
    return s;
}

/* How surely the node is a thing that each label comes from. */
static tz_status keep_certainty(work *k)
{
    const search *r = &k->best;
    const ptrdiff_t n = (ptrdiff_t)k->w * k->h;
    int32_t *of = NULL;
    tz_status s = tz_alloc_zero(k->ctx, &k->sure, (size_t)k->count + 1, sizeof *k->sure);
    if (s == TZ_OK)
        s = tz_alloc(k->ctx, &of, (size_t)r->tree.n, sizeof *of);
    if (s != TZ_OK)
        return s;
    memset(of, 255, (size_t)r->tree.n * sizeof *of);
    for (int32_t i = 0; i < r->chosen.n; i++)
        of[r->chosen.v[i]] = r->chosen.v[i];
    for (int32_t v = r->tree.n - 2; v >= 0; v--)
        if (of[r->tree.node[v].parent] >= 0)
            of[v] = of[r->tree.node[v].parent];
    for (ptrdiff_t p = 0; p < n; p++)
        if (k->label[p] >= 0 && of[r->tree.leaf[p]] >= 0)
            k->sure[k->label[p]] = r->sure[of[r->tree.leaf[p]]];
    tz_free(k->ctx, of);
    return TZ_OK;
}

static tz_status find_regions(work *k)
{
    tz_status s = look_around(k);
    const search *r = &k->best;
    k->scale = r->scale;
    k->sizes = r->sizes;
    k->w = r->view.picture.width;
    k->h = r->view.picture.height;
    if (s == TZ_OK) /* room for the photo's own, too */
        s = tz_alloc(k->ctx, &k->label,
                     (size_t)(k->w > k->photo->width ? k->w : k->photo->width) *
                         (size_t)(k->h > k->photo->height ? k->h : k->photo->height),
                     sizeof *k->label);
    if (s == TZ_OK)
        s = tz_things_mask(k->ctx, &r->view.picture, &r->tree, &r->chosen,
                           fmax(r->scale, 1) * LEAST, k->label, &k->count);
    if (s == TZ_OK)
        s = keep_certainty(k);
    if (s == TZ_OK)
        s = find_doubtful(k);
    forget(k->ctx, &k->best); /* outlines need labels only */
    return s;
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

/* Outlines, and labels, back to the photo's size. */
static tz_status scale_back(work *k, tz_things_outline *out)
{
    const double back = 1 / k->scale;
    if (back == 1)
        return TZ_OK;
    for (int32_t i = 0; i < k->count; i++)
        for (int32_t j = 0; j < out[i].point.n; j++) {
            const tz_vec2 p = out[i].point.v[j];
            out[i].point.v[j] = (tz_vec2){fmin(p.x * back, k->photo->width),
                                          fmin(p.y * back, k->photo->height)};
        }
    return tz_things_paint(k->ctx, out, k->count, k->photo->width, k->photo->height,
                           k->label);
}

/* In px of the labels: superpixels leave outlines as ragged as they are wide, and small
 * things want to stay sharp. */
static double smoothing_of(const work *k)
{
    const double diameter = k->sizes.known ? sqrt(exp2(k->sizes.middle) * 4 / TZ_PI) : 0;
    return fmin(10, k->params->smoothing * fmax(k->scale, ROUNDING * diameter));
}

static tz_status find_outlines(work *k)
{
    const int32_t w = k->photo->width, h = k->photo->height;
    tz_things_outline *out = NULL;
    tz_status s = tz_alloc_zero(k->ctx, &out, (size_t)k->count + 1, sizeof *out);
    if (s == TZ_OK)
        s = tz_alloc_zero(k->ctx, &k->found, (size_t)k->count + 1, sizeof *k->found);
    if (s == TZ_OK)
        s = tz_things_outlines(k->ctx, k->label, k->w, k->h, k->count, smoothing_of(k),
                               out);
    if (s == TZ_OK)
        s = scale_back(k, out);
    for (int32_t i = 0; out && i < k->count; i++)
        if (k->found) {
            k->found[i].outline = out[i];
            k->found[i].sure = k->sure[i];
        }
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

/* Colour only, and no holes in it. */
static tz_status take_photo(const work *k, tz_image *plate)
{
    const tz_image *im = k->photo;
    const int32_t channels = im->channels >= 3 ? 3 : 1;
    const tz_status s = tz_image_init(k->ctx, plate, im->width, im->height, channels);
    if (s != TZ_OK)
        return s;
    plate->encoding = im->encoding;
    plate->depth = im->depth;
    for (int32_t y = 0; y < im->height; y++)
        for (int32_t x = 0; x < im->width; x++)
            for (int32_t c = 0; c < channels; c++) {
                const float v = tz_image_at(im, x, y)[c];
                tz_image_at(plate, x, y)[c] = v == v ? v : 0;
            }
    return TZ_OK;
}

/* Piles hide their ground: what would show through a gap is more of the same. Their things
 * cover each other, or what is between them is like them and they have no clear outline. */
static bool is_pile(const work *k)
{
    const double pixels = (double)k->photo->width * k->photo->height;
    double hidden = 0, solid = 0, share = k->ground.share;
    int32_t n = 0;
    for (int32_t i = 0; i < k->count; i++)
        if (k->found[i].like_ground) {
            share += k->found[i].area / pixels;
        } else {
            hidden += k->found[i].hidden;
            solid += k->found[i].solid;
            n++;
        }
    return n > 0 && share < SCARCE &&
           (hidden > COVERED * n || (k->ground.clear < CLEAR && solid < SOLID * n));
}

static tz_status make_plate(const work *k, tz_image *plate)
{
    const int32_t how = k->params->plate;
    if (how == TZ_THINGS_PLATE_PHOTO || (how == TZ_THINGS_PLATE_AUTO && is_pile(k)))
        return take_photo(k, plate);
    return tz_things_plate(k->ctx, k->photo, &k->ground, plate);
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
    tz_free(k->ctx, k->sure);
    tz_free(k->ctx, k->doubtful);
    tz_things_ground_deinit(k->ctx, &k->ground);
    forget(k->ctx, &k->best);
}

tz_status tz_things_find(tz_ctx *ctx, const tz_image *photo,
                         const tz_things_params *params, tz_element_set *out,
                         tz_image *plate, int32_t *label)
{
    tz_things_verdict verdict;
    return tz_things_judge(ctx, photo, params, out, plate, label, &verdict);
}

tz_status tz_things_judge(tz_ctx *ctx, const tz_image *photo,
                          const tz_things_params *params, tz_element_set *out,
                          tz_image *plate, int32_t *label, tz_things_verdict *verdict)
{
    const int64_t pixels = (int64_t)photo->width * photo->height;
    work k = {.ctx = ctx, .photo = photo, .params = params};
    tz_status s = check(ctx, photo, params);

    *out = (tz_element_set){0};
    *verdict = (tz_things_verdict){0};
    if (plate)
        *plate = (tz_image){0};
    if (s != TZ_OK)
        return s;
    tz_progress_begin(ctx, "elements", "px", 4 * pixels);
    if ((s = find_regions(&k)) != TZ_OK)
        goto done;
    tz_progress_add(ctx, 2 * pixels);
    if ((s = find_outlines(&k)) != TZ_OK)
        goto done;
    if ((s = sort_found(&k)) != TZ_OK)
        goto done;
    tz_progress_add(ctx, pixels);
    s = tz_things_ground_find(ctx, photo, k.label, k.count, k.doubtful, &k.ground);
    if (s == TZ_OK)
        s = tz_things_doubt(ctx, photo, k.label, &k.ground, k.found, k.count);
    if (s == TZ_OK)
        s = tz_things_make_set(ctx, photo, k.label, k.found, k.count, params->classes,
                               out);
    if (s == TZ_OK && plate)
        s = make_plate(&k, plate);
    if (s == TZ_OK)
        s = tz_things_sum_up(ctx, k.found, k.count, &k.ground, pixels, verdict);
    if (s == TZ_OK && tz_ctx_cancelled(ctx))
        s = TZ_CANCELLED;
    if (s == TZ_OK && label)
        memcpy(label, k.label, (size_t)pixels * sizeof *label);
    tz_progress_add(ctx, pixels);
done:
    tz_progress_end(ctx);
    work_deinit(&k);
    if (s != TZ_OK) {
        *verdict = (tz_things_verdict){0};
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
