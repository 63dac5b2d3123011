/* SPDX-License-Identifier: Apache-2.0 */
/* Arrangement by growing.
 *
 * The layout is filled strip by strip. At the first void place of a strip, candidates are
 * gathered: groups that continue a placed neighbour as the exemplar does, groups whose
 * neighbourhood in the exemplar is like that of such a continuation, and groups drawn at
 * random. Each is laid so that it covers the place and overlaps what is there; the overlap
 * is compared by features, the best few are shifted to where edges and tones meet, their
 * seams are found, and the best seam wins.
 */
#include <string.h>

#include "synthesis/arrange_internal.h"

static const tz_param rows[] = {
    {"size", TZ_PARAM_SIZE, offsetof(tz_arrange_params, size), 1, TZ_IMAGE_MAX_SIDE,
     "2048x2048", "px", NULL, "Width and height of the layout"},
    {"seed", TZ_PARAM_UINT64, offsetof(tz_arrange_params, seed), 0, 1.8e19, "1", "", NULL,
     "Names the variant: the same seed gives the same texture"},
    {"tile", TZ_PARAM_BOOL, offsetof(tz_arrange_params, tile), 0, 1, "false", "", NULL,
     "Make the texture seamless: opposite borders fit"},
    {"piece", TZ_PARAM_DOUBLE, offsetof(tz_arrange_params, piece), 0, 4096, "0", "px",
     NULL,
     "Diameter of a placed piece; 0 takes it from the picture's own scale of structure"},
    {"rotate-auto", TZ_PARAM_BOOL, offsetof(tz_arrange_params, rotate_auto), 0, 1, "true",
     "", NULL, "Turn pieces as far as the exemplar's own directions allow"},
    {"rotation", TZ_PARAM_RANGE, offsetof(tz_arrange_params, rotation), -180, 180, "0,0",
     "deg", NULL, "Range of rotation when rotate-auto is off"},
    {"scale", TZ_PARAM_RANGE, offsetof(tz_arrange_params, scale), 0.25, 4, "0.94,1.06",
     "", NULL, "Range of the factor by which pieces are scaled"},
    {"mirror", TZ_PARAM_ENUM, offsetof(tz_arrange_params, mirror), 0, 2, "auto", "",
     "auto|never|always", "Whether pieces may be mirrored left to right"},
    {"coherence", TZ_PARAM_DOUBLE, offsetof(tz_arrange_params, coherence), 0, 1, "0.35",
     "", NULL,
     "How readily a piece runs on just as the exemplar does; high values keep long "
     "structures "
     "and repeat more"},
    {"effort", TZ_PARAM_INT, offsetof(tz_arrange_params, effort), 1, 9, "4", "", NULL,
     "Candidates tried for each piece"},
};

const tz_param_table tz_arrange_param_table = {
    "arrange", "Arrangement of edge groups over a domain", rows,
    sizeof rows / sizeof rows[0], sizeof(tz_arrange_params)};

static bool has_fixed(const tz_layout *l)
{
    for (int32_t k = 0; k < l->place.n; k++)
        if (l->place.v[k].fixed && !l->place.v[k].removed)
            return true;
    return false;
}

static tz_status write_layout(const tz_grower *g, const tz_layout *old, tz_layout *l)
{
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < g->n && s == TZ_OK; k++) {
        int32_t id;
        s = tz_layout_add_source(l, g->ex[k].path, g->ex[k].sha256, g->ex[k].photo->width,
                                 g->ex[k].photo->height, &id);
    }
    for (int32_t t = 0; t < g->strips * g->tiles && s == TZ_OK; t++)
        for (int32_t k = 0; k < g->tile[t].n && s == TZ_OK; k++) {
            const tz_grown *q = &g->tile[t].v[k];
            const tz_star *star = &g->stars.star.v[q->star];
            tz_point border[TZ_BORDER];
            for (int ray = 0; ray < TZ_BORDER; ray++) {
                const tz_vec2 dir = tz_ray(ray, TZ_BORDER);
                border[ray] =
                    (tz_point){(float)(star->centre.x + q->border[ray] * dir.x),
                               (float)(star->centre.y + q->border[ray] * dir.y)};
            }
            int32_t id;
            s = tz_layout_add(l, star->exemplar, star->group, q->map, border, TZ_BORDER,
                              &id);
        }
    /* what the artist has set lies on top */
    for (int32_t k = 0; k < old->place.n && s == TZ_OK; k++) {
        const tz_placement *p = &old->place.v[k];
        int32_t id;
        if (!p->fixed || p->removed)
            continue;
        s = tz_layout_add(l, p->source, p->group, p->map, old->border.v + p->border,
                          p->points, &id);
        if (s == TZ_OK)
            l->place.v[id].fixed = 1, l->place.v[id].medium = p->medium;
    }
    return s;
}

static tz_status check(tz_ctx *ctx, const tz_exemplar *ex, int32_t n, const tz_layout *l,
                       const tz_arrange_params *p)
{
    if (l->place.n && (l->width != p->size[0] || l->height != p->size[1] ||
                       l->tile != p->tile || l->source.n != n))
        return tz_fail(
            ctx, TZ_INVALID,
            "arrange: the layout to go on from is %d x %d px with %d sources, not "
            "%d x %d with %d",
            (int)l->width, (int)l->height, (int)l->source.n, (int)p->size[0],
            (int)p->size[1], (int)n);
    for (int k = 0; k < 2; k++)
        if (p->size[k] < 1 || p->size[k] > TZ_IMAGE_MAX_SIDE)
            return tz_fail(
                ctx, TZ_INVALID,
                "arrange: a layout of %d x %d px cannot be made; sides are 1 to %d",
                (int)p->size[0], (int)p->size[1], TZ_IMAGE_MAX_SIDE);
    if (n < 1 || n > 64)
        return tz_fail(ctx, TZ_INVALID, "arrange: 1 to 64 exemplars are needed, not %d",
                       (int)n);
    for (int32_t k = 0; k < n; k++)
        if (ex[k].photo->width != ex[k].ebpt->width ||
            ex[k].photo->height != ex[k].ebpt->height)
            return tz_fail(
                ctx, TZ_INVALID,
                "%s: the photo is %d x %d px but its exemplar was made for %d x %d; "
                "analyze it again",
                ex[k].path ? ex[k].path : "photo", (int)ex[k].photo->width,
                (int)ex[k].photo->height, (int)ex[k].ebpt->width,
                (int)ex[k].ebpt->height);
    for (int32_t k = 0; l->place.n && k < n; k++)
        if (l->source.v[k].width != ex[k].photo->width ||
            l->source.v[k].height != ex[k].photo->height)
            return tz_fail(
                ctx, TZ_INVALID,
                "arrange: the layout to go on from was made for a %s of %d x %d px, not "
                "%d x %d",
                l->source.v[k].path ? l->source.v[k].path : "photo",
                (int)l->source.v[k].width, (int)l->source.v[k].height,
                (int)ex[k].photo->width, (int)ex[k].photo->height);
    return TZ_OK;
}

/* Where a rule leaves nothing to choose from, anything is laid: void is worse. */
static void warn_of_empty_rules(tz_ctx *ctx, const tz_grower *g)
{
    for (int32_t r = 0; r < g->rules->rule.n; r++) {
        const tz_rule *rule = &g->rules->rule.v[r];
        int32_t k = 0;
        while (k < g->stars.count && !tz_star_allowed(g, rule, &g->stars.star.v[k]))
            k++;
        if (k == g->stars.count)
            tz_warn(ctx,
                    "rules: no group fits rule \"%s\"; all are used there, widen its "
                    "limits",
                    rule->name);
    }
}

/* What frames ask of pieces. @param[out] levels  of thinning */
static tz_status read_frames(tz_ctx *ctx, tz_grower *g, int32_t *levels)
{
    const tz_frames *f = g->p.frames;
    double least = 1, most = 1;
    *levels = f && f->thinned ? TZ_THIN_LEVELS : 1;
    for (int64_t i = 0; f && f->size && i < (int64_t)f->raster.width * f->raster.height;
         i++) {
        least = fmin(least, (double)f->size[i]);
        most = fmax(most, (double)f->size[i]);
    }
    g->largest = most * pow(2, 0.5 * (*levels - 1));
    return least >= 0.249 && most <= 4.01
               ? TZ_OK
               : tz_fail(ctx, TZ_INVALID,
                         "arrange: the field says sizes from %.3g to %.3g; edge groups "
                         "follow sizes from 0.25 to 4",
                         least, most);
}

static double piece_size(const tz_exemplar *ex, int32_t n, double wanted)
{
    if (wanted > 0)
        return fmax(wanted, 16);
    double sum = 0;
    for (int32_t k = 0; k < n; k++) {
        const double shorter = ex[k].ebpt->width < ex[k].ebpt->height
                                   ? ex[k].ebpt->width
                                   : ex[k].ebpt->height;
        sum += fmin(fmax(2.5 * ex[k].ebpt->scale, 104), fmax(shorter / 2.6, 16));
    }
    return sum / n;
}

tz_status tz_arrange(tz_ctx *ctx, const tz_exemplar *ex, int32_t n, const tz_rules *rules,
                     const tz_arrange_params *params, tz_layout *l)
{
    tz_grower g = {.ex = ex, .n = n, .rules = rules, .p = *params};
    tz_rules own = {0};
    tz_layout made = {0};
    int32_t levels;
    tz_status s = check(ctx, ex, n, l, params);
    if (s == TZ_OK)
        s = read_frames(ctx, &g, &levels);
    if (s == TZ_OK && !rules) {
        s = tz_rules_default(ctx, &own);
        g.rules = &own;
    }
    if (s != TZ_OK)
        return s;
    g.piece = piece_size(ex, n, params->piece);
    s = tz_stars_init(ctx, ex, n, g.rules, g.piece, levels, &g.stars);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &g.map, (size_t)n, sizeof *g.map);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &g.freedom, (size_t)n, sizeof *g.freedom);
    if (s == TZ_OK)
        s = tz_feature_maps_init(ctx, ex, n, g.map);
    for (int32_t k = 0; k < n && s == TZ_OK; k++)
        s = tz_freedom_measure(ctx, &ex[k], &g.freedom[k]);
    if (s != TZ_OK)
        goto done;

    tz_canvas *c = &g.canvas;
    c->torus = params->tile;
    if (params->tile && (params->size[0] % 16 || params->size[1] % 16))
        tz_warn(ctx, "%d x %d px: sides that are multiples of 16 px tile most exactly",
                (int)params->size[0], (int)params->size[1]);
    c->nx = (params->size[0] + TZ_CELL - 1) / TZ_CELL;
    c->ny = (params->size[1] + TZ_CELL - 1) / TZ_CELL;
    g.strip = (int32_t)fmax(g.piece / TZ_CELL, 4);
    g.span =
        (int32_t)((g.largest * (2.2 * g.piece + 2.2 * g.stars.reach) + 16) / TZ_CELL);
    g.strips = (c->ny + g.strip - 1) / g.strip;
    g.tiles = (c->nx + g.span - 1) / g.span;
    if ((int64_t)g.strips * g.tiles >= INT32_MAX >> TZ_KEY_BITS) {
        s = tz_fail(ctx, TZ_LIMIT,
                    "arrange: pieces of %.0f px are too small for %d x %d px", g.piece,
                    (int)params->size[0], (int)params->size[1]);
        goto done;
    }
    c->ring =
        (tz_ctx_threads(ctx) + 10) * g.strip + (int32_t)(6 * g.stars.reach / TZ_CELL);
    if (c->ring > c->ny || params->tile || has_fixed(l) || params->frames)
        c->ring = c->ny;
    const size_t cells = (size_t)c->nx * (size_t)c->ring;
    s = tz_alloc(ctx, &c->feature, cells, sizeof *c->feature);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &c->label, cells, sizeof *c->label);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &g.tile, (size_t)g.strips * (size_t)g.tiles + 1,
                          sizeof *g.tile);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &g.progress, (size_t)g.strips, sizeof *g.progress);
    if (s != TZ_OK)
        goto done;
    memset(c->label, 0xff, cells * sizeof *c->label);
    c->fixed = INT32_MAX;
    if (has_fixed(l)) {
        s = tz_grower_draw_fixed(ctx, &g, l);
        if (s != TZ_OK)
            goto done;
    }
    warn_of_empty_rules(ctx, &g);
    s = tz_grower_run(ctx, &g);
    if (s != TZ_OK)
        goto done;
    s = tz_layout_init(ctx, &made, params->size[0], params->size[1], params->tile);
    if (s == TZ_OK)
        s = write_layout(&g, l, &made);
    if (s == TZ_OK) {
        tz_layout_deinit(l);
        *l = made;
        made = (tz_layout){0};
    }
done:
    tz_layout_deinit(&made);
    tz_rules_deinit(&own);
    for (int32_t k = 0; g.tile && k <= g.strips * g.tiles; k++)
        tz_array_free(ctx, &g.tile[k]);
    tz_free(ctx, g.tile);
    tz_free(ctx, g.progress);
    tz_free(ctx, g.canvas.feature);
    tz_free(ctx, g.canvas.label);
    if (g.map)
        tz_feature_maps_deinit(ctx, g.map, n);
    tz_free(ctx, g.map);
    tz_free(ctx, g.freedom);
    tz_stars_deinit(ctx, &g.stars, n);
    return s;
}
