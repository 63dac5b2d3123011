/* SPDX-License-Identifier: Apache-2.0 */
/* Photo to EBPT, [Kim21] Sec. 4:
 *
 *   photo -> boundary tensor, an octave a level           tensor.c
 *         -> ridges, thinned, linked into chains, Eq. (1)  edges.c, chain.c   Sec. 4.1
 *         -> the picture's scale of structure              scale.c
 *         -> superpixels, merged into whole things         superpixel.c, regions.c
 *         -> edge groups and meta group, Eq. (2)           groups.c           Sec. 4.2 */
#include "analysis/ebpt.h"

#include <string.h>

#include "analysis/chain.h"
#include "analysis/edges.h"
#include "analysis/forest.h"
#include "analysis/groups.h"
#include "analysis/regions.h"
#include "analysis/scale.h"
#include "analysis/superpixel.h"
#include "analysis/tensor.h"

/* Lab units; less than a quarter of a grey step of 8 bits is noise of coding. */
#define LEAST_RESPONSE 0.25
/* Share of trees that see an edge: less is grain; and where most of them agree. */
#define LEAST_FOREST   0.08
#define FULL_FOREST    0.3F
#define LEAST_DIAMETER 12.0

static const tz_param rows[] = {
    {"edges", TZ_PARAM_ENUM, offsetof(tz_ebpt_params, edges), 0, 0, "auto", "",
     "auto|forest|gradient", "edge detector; auto is forest"},
    {"model", TZ_PARAM_STRING, offsetof(tz_ebpt_params, model), 0, 0, "", "", NULL,
     "structured-forest model (.yml or .yml.gz); without one the one that Terrazzo "
     "ships"},
    {"edge-threshold", TZ_PARAM_DOUBLE, offsetof(tz_ebpt_params, edge_threshold), 0, 1,
     "0.4", "", NULL, "weakest edge, as a share of the picture's own edge strength"},
    {"min-length", TZ_PARAM_INT, offsetof(tz_ebpt_params, min_length), 1, 10000, "8",
     "px", NULL, "shorter edges are dropped"},
    {"groups", TZ_PARAM_INT, offsetof(tz_ebpt_params, groups), 0, 1000000, "0", "", NULL,
     "wanted number of edge groups; 0 takes it from the scale of the structure"},
    {"length-bins", TZ_PARAM_INT, offsetof(tz_ebpt_params, length_bins), 1, 64, "3", "",
     NULL, "bins of edge length"},
    {"angle-bins", TZ_PARAM_INT, offsetof(tz_ebpt_params, angle_bins), 1, 64, "3", "",
     NULL, "bins of edge angle"},
    {"binning", TZ_PARAM_ENUM, offsetof(tz_ebpt_params, binning), 0, 0, "uniform", "",
     "uniform|adaptive", "bins of equal width, or of equal numbers of edges"},
    {"polar-rings", TZ_PARAM_INT, offsetof(tz_ebpt_params, polar_rings), 1, 1024, "12",
     "", NULL, "rings of a group's polar grid"},
    {"polar-sectors", TZ_PARAM_INT, offsetof(tz_ebpt_params, polar_sectors), 1, 1024,
     "30", "", NULL, "sectors of a group's polar grid"},
    {"merge", TZ_PARAM_DOUBLE, offsetof(tz_ebpt_params, merge), 0, 1, "0.5", "", NULL,
     "how readily superpixels without an edge between them join; 0 leaves them apart"},
};

const tz_param_table tz_ebpt_param_table = {
    "analyze", "Takes a photo apart into regions, edges and edge groups", rows,
    (int32_t)(sizeof rows / sizeof *rows), sizeof(tz_ebpt_params)};

void tz_ebpt_deinit(tz_ebpt *e)
{
    tz_free(e->ctx, e->label);
    tz_array_free(e->ctx, &e->code);
    tz_array_free(e->ctx, &e->edge);
    tz_array_free(e->ctx, &e->group);
    tz_array_free(e->ctx, &e->group_edge);
    tz_array_free(e->ctx, &e->cell);
    tz_array_free(e->ctx, &e->cell_edge);
    tz_array_free(e->ctx, &e->neighbour_first);
    tz_array_free(e->ctx, &e->neighbour);
    *e = (tz_ebpt){0};
}

/* ---- stages ---------------------------------------------------------------------- */

typedef struct work {
    const tz_image *photo;
    tz_ebpt *e;
    tz_tensor t;
    tz_edge_map m;           /* response for edges */
    float *borders;          /* response for regions */
    double full;             /* edge response of strength 1 */
    const tz_forest *forest; /* NULL: the gradient finds the edges */
    int32_t count;           /* regions */
} work;

#define EDGES_A_TASK 64

static tz_status measure_some(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const work *k = arg;
    const int64_t end = (i + 1) * EDGES_A_TASK, n = k->e->edge.n;
    (void)ctx, (void)worker;
    for (int64_t id = i * EDGES_A_TASK; id < end && id < n; id++)
        tz_chain_measure(&k->m, k->full, k->e, (int32_t)id);
    return TZ_OK;
}

/* Contrast counts more where the forest sees a border, and less inside of things: grain
 * and shadows do not part a stone. */
static void weigh_borders(work *k)
{
    const size_t n = (size_t)k->e->width * (size_t)k->e->height;
    for (size_t i = 0; i < n; i++)
        k->borders[i] *= 0.25F + fminf(k->m.response[i] / FULL_FOREST, 1.5F);
}

static tz_status make_responses(tz_ctx *ctx, work *k)
{
    static const double fine[TZ_TENSOR_LEVELS] = {0.35, 0.5, 0.35};
    tz_ebpt *e = k->e;
    double coarse[TZ_TENSOR_LEVELS] = {0};
    tz_status s;

    s = tz_edge_map_init(ctx, &k->m, e->width, e->height);
    if (s != TZ_OK)
        return s;
    s = tz_alloc(ctx, &k->borders, (size_t)e->width * e->height, sizeof *k->borders);
    if (s != TZ_OK)
        return s;
    if (k->forest)
        s = tz_forest_response(ctx, k->photo, k->forest, k->m.response, k->m.normal);
    else
        s = tz_tensor_response(&k->t, fine, k->m.response, k->m.normal);
    if (s != TZ_OK)
        return s;
    tz_scale_weights(e->scale, coarse);
    if ((s = tz_tensor_response(&k->t, coarse, k->borders, NULL)) != TZ_OK)
        return s;
    if (k->forest)
        weigh_borders(k);
    return tz_scale_balance(ctx, k->borders, e->width, e->height, e->scale);
}

/* Sec. 4.1 without the features. */
static tz_status find_edges(work *k)
{
    const bool forest = k->forest != NULL;
    const double least = forest ? LEAST_FOREST : LEAST_RESPONSE;
    tz_status s = tz_edge_map_detect(&k->m, k->e->params.edge_threshold, least);
    if (s != TZ_OK)
        return s;
    k->full = forest ? 1 : 2.0 * k->m.strong;
    return tz_chain_link(&k->m, k->e->params.min_length, k->e);
}

/* Superpixels and their merging. */
static tz_status find_regions(tz_ctx *ctx, work *k)
{
    tz_ebpt *e = k->e;
    const bool told = e->params.groups > 0;
    const int32_t side = e->width > e->height ? e->width : e->height;
    const double full =
        fmax(LEAST_RESPONSE, tz_scale_full(k->borders, (int64_t)e->width * e->height));
    const double share = e->params.merge > 0 ? 0.22 : 1;
    const double step = fmax(told ? 2 : 6, share * e->scale);
    const tz_region_picture in = {.width = e->width,
                                  .height = e->height,
                                  .channels = k->t.channels,
                                  .response = k->borders,
                                  .lab = k->t.level[0].lab};
    const tz_region_options o = {
        .full = full,
        .scale = e->scale,
        .merge = e->params.merge,
        .wanted = e->params.groups,
        .longest = (int32_t)fmax(side / 3.0, told ? 3 * e->scale : LEAST_DIAMETER),
        .least = told ? 1 : 0.25 * TZ_PI * LEAST_DIAMETER * LEAST_DIAMETER};
    tz_status s = tz_superpixels(ctx, k->borders, e->width, e->height, full, step,
                                 e->label, &k->count);
    return s == TZ_OK ? tz_regions_merge(ctx, &in, &o, e->label, &k->count) : s;
}

/* Edges and regions know nothing of each other: both are found at the same time. */
static tz_status edges_or_regions(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)worker;
    return i == 0 ? find_regions(ctx, arg) : find_edges(arg);
}

static tz_status check(tz_ctx *ctx, const tz_image *photo)
{
    if (photo->width < 1 || photo->height < 1 || photo->channels < 1)
        return tz_fail(ctx, TZ_INVALID, "analyze: the photo has no pixels");
    return TZ_OK;
}

tz_status tz_ebpt_analyze(tz_ctx *ctx, const tz_image *photo,
                          const tz_ebpt_params *params, tz_ebpt *out)
{
    const int64_t pixels = (int64_t)photo->width * photo->height;
    tz_ebpt e = {.width = photo->width, .height = photo->height, .ctx = ctx};
    work k = {.photo = photo, .e = &e};
    tz_status s;

    *out = (tz_ebpt){0};
    if ((s = check(ctx, photo)) != TZ_OK)
        return s;
    if (params->edges != TZ_EDGES_GRADIENT &&
        (s = tz_forest_of(ctx, params->model, &k.forest)) != TZ_OK)
        return s;
    e.params = *params;
    tz_progress_begin(ctx, "analyze", "px", 3 * pixels);
    if ((s = tz_alloc(ctx, &e.label, (size_t)pixels, sizeof *e.label)) != TZ_OK)
        goto done;
    if ((s = tz_tensor_init(ctx, photo, &k.t)) != TZ_OK)
        goto done;
    if ((s = tz_scale_find(&k.t, &e.params, &e.scale)) != TZ_OK)
        goto done;
    if ((s = make_responses(ctx, &k)) != TZ_OK)
        goto done;
    tz_progress_add(ctx, pixels);
    if ((s = tz_parallel_for(ctx, 2, edges_or_regions, &k)) != TZ_OK)
        goto done;
    tz_progress_add(ctx, pixels);
    s = tz_parallel_for(ctx, (e.edge.n + EDGES_A_TASK - 1) / EDGES_A_TASK, measure_some,
                        &k);
    if (s != TZ_OK)
        goto done;
    if ((s = tz_groups_encode(&e, k.count)) != TZ_OK)
        goto done;
    tz_progress_add(ctx, pixels);
    if (tz_ctx_cancelled(ctx))
        s = TZ_CANCELLED;
done:
    tz_progress_end(ctx);
    tz_tensor_deinit(&k.t);
    tz_edge_map_deinit(&k.m);
    tz_free(ctx, k.borders);
    if (s == TZ_OK)
        *out = e;
    else
        tz_ebpt_deinit(&e);
    return s;
}
