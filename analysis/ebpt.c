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
#define LEAST_FOREST   0.02
#define LEAST_DIAMETER 12.0

static const tz_param rows[] = {
    {"edges", TZ_PARAM_ENUM, offsetof(tz_ebpt_params, edges), 0, 0, "auto", "",
     "auto|forest|gradient", "edge detector; auto is forest if a model is given"},
    {"model", TZ_PARAM_STRING, offsetof(tz_ebpt_params, model), 0, 0, "", "", NULL,
     "structured-forest model file (.yml or .yml.gz)"},
    {"edge-threshold", TZ_PARAM_DOUBLE, offsetof(tz_ebpt_params, edge_threshold), 0, 1,
     "0.35", "", NULL, "weakest edge, as a share of the picture's own edge strength"},
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

typedef struct measure_job {
    const tz_edge_map *m;
    tz_ebpt *e;
    double full; /* response of an edge of strength 1 */
} measure_job;

#define EDGES_A_TASK 64

static tz_status measure_some(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    measure_job *j = arg;
    (void)ctx, (void)worker;
    for (int64_t k = i * EDGES_A_TASK; k < (i + 1) * EDGES_A_TASK && k < j->e->edge.n;
         k++)
        tz_chain_measure(j->m, j->full, j->e, (int32_t)k);
    return TZ_OK;
}

static tz_status edge_response(const tz_tensor *t, const tz_image *photo, tz_edge_map *m,
                               const tz_ebpt_params *p, bool *forest)
{
    static const double weight[TZ_TENSOR_LEVELS] = {0.5, 0.5};
    *forest = p->edges == TZ_EDGES_FOREST || (p->edges == TZ_EDGES_AUTO && p->model[0]);
    if (!*forest)
        return tz_tensor_response(t, weight, m->response, m->normal);
    if (!p->model[0])
        return tz_fail(t->ctx, TZ_INVALID,
                       "edges \"forest\" needs a model file (--model), or "
                       "take --edges gradient");
    return tz_forest_response(t->ctx, photo, p->model, m->response, m->normal);
}

/* Sec. 4.1: edges and their features. */
static tz_status find_edges(const tz_tensor *t, const tz_image *photo, tz_edge_map *m,
                            tz_ebpt *e)
{
    measure_job j = {.m = m, .e = e};
    bool forest;
    tz_status s = edge_response(t, photo, m, &e->params, &forest);
    if (s != TZ_OK)
        return s;
    s = tz_edge_map_detect(m, e->params.edge_threshold,
                           forest ? LEAST_FOREST : LEAST_RESPONSE);
    if (s != TZ_OK)
        return s;
    if ((s = tz_chain_link(m, e->params.min_length, e)) != TZ_OK)
        return s;
    j.full = forest ? 1 : 2.0 * m->strong;
    return tz_parallel_for(e->ctx, (e->edge.n + EDGES_A_TASK - 1) / EDGES_A_TASK,
                           measure_some, &j);
}

/* Superpixels and their merging; *count regions. */
static tz_status find_regions(const tz_tensor *t, float *response, tz_ebpt *e,
                              int32_t *count)
{
    const int32_t side = e->width > e->height ? e->width : e->height;
    double weight[TZ_TENSOR_LEVELS] = {0}, full;
    tz_status s;
    tz_scale_weights(e->scale, weight);
    if ((s = tz_tensor_response(t, weight, response, NULL)) != TZ_OK)
        return s;
    s = tz_scale_balance(e->ctx, response, e->width, e->height, e->scale);
    if (s != TZ_OK)
        return s;
    full = tz_scale_full(response, (int64_t)e->width * e->height);
    if (full < LEAST_RESPONSE)
        full = LEAST_RESPONSE;
    const double share = e->params.merge > 0 ? 0.2 : 1;
    const double step = fmax(e->params.groups > 0 ? 2 : 5, share * e->scale);
    if ((s = tz_superpixels(e->ctx, response, e->width, e->height, full, step, e->label,
                            count)) != TZ_OK)
        return s;
    const tz_region_picture in = {.width = e->width,
                                  .height = e->height,
                                  .channels = t->channels,
                                  .response = response,
                                  .lab = t->level[0].lab};
    const tz_region_options o = {
        .full = full,
        .scale = e->scale,
        .merge = e->params.merge,
        .wanted = e->params.groups,
        .longest = (int32_t)fmax(side / 3.0,
                                 e->params.groups > 0 ? 3 * e->scale : LEAST_DIAMETER),
        .least =
            e->params.groups > 0 ? 1 : 0.25 * TZ_PI * LEAST_DIAMETER * LEAST_DIAMETER};
    return tz_regions_merge(e->ctx, &in, &o, e->label, count);
}

tz_status tz_ebpt_analyze(tz_ctx *ctx, const tz_image *photo,
                          const tz_ebpt_params *params, tz_ebpt *out)
{
    tz_ebpt e = {
        .width = photo->width, .height = photo->height, .params = *params, .ctx = ctx};
    tz_tensor t = {0};
    tz_edge_map m = {0};
    int32_t count = 0;
    tz_status s;

    *out = (tz_ebpt){0};
    if (photo->width < 1 || photo->height < 1 || photo->channels < 1)
        return tz_fail(ctx, TZ_INVALID, "analyze: the photo has no pixels");
    tz_progress_begin(ctx, "analyze", "px", (int64_t)photo->width * photo->height);
    s = tz_alloc(ctx, &e.label, (size_t)photo->width * photo->height, sizeof *e.label);
    if (s != TZ_OK)
        goto done;
    if ((s = tz_tensor_init(ctx, photo, &t)) != TZ_OK)
        goto done;
    if ((s = tz_edge_map_init(ctx, &m, photo->width, photo->height)) != TZ_OK)
        goto done;
    if ((s = find_edges(&t, photo, &m, &e)) != TZ_OK)
        goto done;
    if ((s = tz_scale_find(&t, &e.params, &e.scale)) != TZ_OK)
        goto done;
    if ((s = find_regions(&t, m.response, &e, &count)) != TZ_OK)
        goto done;
    if ((s = tz_groups_encode(&e, count)) != TZ_OK)
        goto done;
    if (tz_ctx_cancelled(ctx))
        s = TZ_CANCELLED;
done:
    tz_progress_end(ctx);
    tz_tensor_deinit(&t);
    tz_edge_map_deinit(&m);
    if (s == TZ_OK)
        *out = e;
    else
        tz_ebpt_deinit(&e);
    return s;
}
