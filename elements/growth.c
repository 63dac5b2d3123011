/* SPDX-License-Identifier: Apache-2.0 */
/* Region growing, the driver: [Dav19] Algorithm 1.
 *
 *     while target region is not filled do            TZ_GROW
 *         visit seeds: copy what their best units have and they have not
 *         optimise what the round has touched
 *     fill what is left                               FILL
 *         visit once more those that found nothing good enough, and take what fits
 *         start anew in empty places that no seed reaches
 *     look for holes, and for room where it is too sparse   CLOSE, MEND
 *     solve for all positions, if that is wished            POLISH
 *
 * Seeds are served in the order in which they came, so that the growth spreads as a disc.
 * A round takes a fixed number of them, whatever the budget of the step: the output does
 * not depend on how the work is cut into steps. Everything is serial. */
#include "elements/growth.h"

#include <string.h>

#include "elements/growth_internal.h"

typedef enum phase { GROW, FILL, START, CLOSE, MEND, POLISH, DONE } phase;

enum { STARTS = 8, SAMPLED = 256, CELLS = 1 << 22 };

/* Places emptier than this many of the exemplar's holes are started in; they are looked
 * for at a step of this many spacings. */
static const double start_gap = 1.02, start_step = 0.33;

/* Density is mended below this error. */
static const float mend_below = -0.02F;

static const tz_param rows[] = {
    {"seed", TZ_PARAM_UINT64, offsetof(tz_growth_params, seed), 0, 1.8e19, "1", "", NULL,
     "Names the variant: the same seed gives the same texture"},
    {"rings", TZ_PARAM_INT, offsetof(tz_growth_params, rings), 1, 3, "2", "", NULL,
     "Rings of neighbours that are compared: more keep larger figures"},
    {"coherent", TZ_PARAM_INT, offsetof(tz_growth_params, coherent), 1,
     TZ_GROWTH_COHERENT, "5", "", NULL,
     "Similar elements of the exemplar that are tried: more give more variation"},
    {"optimise", TZ_PARAM_ENUM, offsetof(tz_growth_params, optimise), 0, 2, "local", "",
     "none|local|global", "What is moved into better places after each round"},
    {"overlap", TZ_PARAM_DOUBLE, offsetof(tz_growth_params, overlap), 0, 2, "0.8", "",
     NULL,
     "Two elements of classes that the exemplar never shows side by side keep apart by "
     "this share of the sum of their radii"},
    {"ratio", TZ_PARAM_DOUBLE, offsetof(tz_growth_params, ratio), 1, 1000, "2", "", NULL,
     "Neighbourhoods that fit this many times worse than the best are not copied"},
    {"balance", TZ_PARAM_DOUBLE, offsetof(tz_growth_params, balance), 0, 1, "0.5", "",
     NULL, "How hard the shares of classes follow the exemplar's"},
    {"inside", TZ_PARAM_DOUBLE, offsetof(tz_growth_params, inside), 0, 1, "0", "", NULL,
     "Share of an element's radius that must lie within the domain: 0 is its centre, 1 "
     "all of it"},
    {"most", TZ_PARAM_INT, offsetof(tz_growth_params, most), 0, 100000000, "0", "", NULL,
     "Elements placed at most; 0 fills the domain"},
};
const tz_param_table tz_growth_param_table = {
    "grow", "Region growing of element textures", rows, sizeof rows / sizeof rows[0],
    sizeof(tz_growth_params)};

/* ---- begin ----------------------------------------------------------------------- */

tz_status tz_growth_reserve(tz_growth *g, int64_t more)
{
    const int64_t need = (int64_t)g->spot.n + more;
    tz_status s = tz_array_reserve(g->ctx, &g->spot, need);
    if (s != TZ_OK || g->spot.cap <= g->queue_cap)
        return s;
    int32_t *queue = NULL;
    s = tz_alloc(g->ctx, &queue, (size_t)g->spot.cap, sizeof *queue);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < g->queue_n; i++)
        queue[i] = g->queue[(g->queue_head + i) % g->queue_cap];
    tz_free(g->ctx, g->queue);
    g->queue = queue;
    g->queue_head = 0;
    g->queue_cap = g->spot.cap;
    return TZ_OK;
}

static tz_status make_grid(tz_growth *g)
{
    const tz_vec3 size = g->out->domain.size;
    double cell = 0.9 * g->spacing * sqrt(g->least * g->most);
    double nx = fmax(1, floor(size.x / cell)), ny = fmax(1, floor(size.y / cell));
    while (nx * ny > CELLS) {
        cell *= 1.5;
        nx = fmax(1, floor(size.x / cell)), ny = fmax(1, floor(size.y / cell));
    }
    g->nx = (int32_t)nx, g->ny = (int32_t)ny;
    g->cell_x = size.x / nx, g->cell_y = size.y / ny;
    const size_t cells = (size_t)g->nx * (size_t)g->ny;
    const tz_status s = tz_alloc(g->ctx, &g->head, cells, sizeof *g->head);
    if (s == TZ_OK)
        memset(g->head, 0xff, cells * sizeof *g->head);
    return s;
}

/* Unit of a kind that is nearest in size, -1 = none. */
static int32_t like(const tz_growth_exemplar *ex, int32_t kind, double radius)
{
    int32_t best = -1;
    for (int32_t k = 0; k < ex->elements; k++)
        if (ex->unit[k].kind == kind &&
            (best < 0 || fabs(ex->unit[k].r - radius) < fabs(ex->unit[best].r - radius)))
            best = k;
    return best;
}

/* Unit that copies an element of the palette (they rise by source), -1 = none. */
static int32_t unit_of(const tz_growth_exemplar *ex, int32_t source)
{
    int32_t lo = 0, hi = ex->elements - 1;
    while (lo <= hi) {
        const int32_t at = (lo + hi) / 2;
        if (ex->unit[at].source == source)
            return at;
        if (ex->unit[at].source < source)
            lo = at + 1;
        else
            hi = at - 1;
    }
    return -1;
}

/* Texture and unit that a given element copies, or is like. True if it is a copy. */
static bool identify(const tz_growth *g, const tz_element *e, int32_t *texture,
                     int32_t *unit)
{
    for (*texture = 0; *texture < g->textures; ++*texture) {
        const tz_growth_exemplar *ex = &g->ex[*texture];
        *unit = e->source < 0 ? -1 : unit_of(ex, e->source);
        if (*unit >= 0 && ex->unit[*unit].kind == e->kind)
            return true;
    }
    for (*texture = 0; *texture < g->textures; ++*texture) {
        *unit = like(&g->ex[*texture], e->kind, e->radius);
        if (*unit >= 0)
            return false;
    }
    *texture = 0, *unit = -1;
    return false;
}

static tz_status add_given(tz_growth *g, int32_t i)
{
    const tz_element *e = &g->out->element.v[i];
    const tz_element_set *set = g->ex[0].set;
    const bool oriented = e->kind < set->kind.n && set->kind.v[e->kind].oriented;
    int32_t texture, unit;
    const bool copy = identify(g, e, &texture, &unit);
    const double scale = tz_domain_apart(&g->out->domain, e->at);
    const double room = scale / tz_domain_scale(&g->out->domain, e->at);
    const tz_growth_exemplar *ex = &g->ex[texture];
    const tz_status s = tz_growth_reserve(g, 1);
    if (s != TZ_OK)
        return s;
    g->spot.v[g->spot.n] = (tz_growth_spot){.x = e->at.x,
                                            .y = e->at.y,
                                            .r = (float)(room * e->radius),
                                            .c2 = oriented ? (float)cos(2 * e->angle) : 0,
                                            .s2 = oriented ? (float)sin(2 * e->angle) : 0,
                                            .angle = (float)e->angle,
                                            .kind = e->kind,
                                            .symbol = e->symbol,
                                            .hard = unit < 0 ? -1 : ex->unit[unit].hard,
                                            .texture = texture,
                                            .copy = unit,
                                            .match = unit,
                                            .out = i,
                                            .node = -1,
                                            .strange = !copy,
                                            .fixed = e->fixed};
    tz_growth_link(g, g->spot.n);
    g->spot.n++;
    g->radius = fmax(g->radius, room * e->radius / g->most);
    g->placed++;
    if (unit >= 0) {
        g->count[texture * TZ_GROWTH_CLASSES + ex->unit[unit].class]++;
        g->counted[texture]++;
        g->ex[texture].unit[unit].uses++;
        g->cover.count[texture] += 1;
        tz_growth_decide_place(g, texture, e->at.x, e->at.y, 0.5 * scale * ex->spacing);
        tz_growth_enqueue(g, i);
    }
    return TZ_OK;
}

/* Given elements that copy nothing get the unit whose surroundings are most like theirs.
 */
static void match_given(tz_growth *g, int32_t i)
{
    tz_growth_spot *q = &g->spot.v[i];
    const tz_growth_exemplar *ex = &g->ex[q->texture];
    const int32_t step = ex->n / SAMPLED + 1;
    tz_growth_view view;
    uint64_t used;
    float least = INFINITY;
    if (q->match < 0 || !q->strange)
        return;
    tz_growth_look(g, q->x, q->y, ex->reach, i, &view);
    for (int32_t k = 0; k < ex->n; k += step) {
        const float r = q->r / (float)view.scale;
        const float cost = tz_growth_match(ex, k, view.v, view.n, INFINITY, &used, NULL) +
                           (ex->unit[k].whole ? 0 : 0.1F) +
                           fabsf(ex->unit[k].r - r) / (ex->unit[k].r + r);
        if (ex->unit[k].kind == q->kind && cost < least)
            least = cost, q->match = k;
    }
}

/* Extents of symbols, and which are discs. */
static tz_status find_extents(tz_growth *g, const tz_element_set *set)
{
    tz_status s = tz_extents_init(g->ctx, set, &g->extents);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &g->disc, (size_t)set->symbol.n + 1, sizeof *g->disc);
    for (int32_t i = 0; s == TZ_OK && i < set->symbol.n; i++) {
        g->disc[i] = true;
        for (int32_t k = 0; k < TZ_EXTENT_DIRECTIONS; k++)
            g->disc[i] = g->disc[i] && g->extents.v[i].r[k] >= 1;
    }
    return s;
}

static tz_status prepare_textures(tz_growth *g, const tz_element_set *set,
                                  const tz_growth_texture *texture)
{
    tz_status s = find_extents(g, set);
    g->spacing = INFINITY;
    for (int32_t t = 0; t < g->textures && s == TZ_OK; t++) {
        tz_growth_exemplar *ex = &g->ex[t];
        ex->number = t;
        ex->extents = &g->extents;
        ex->disc = g->disc;
        if (texture[t].zone < 0 ||
            (texture[t].zone > 0 &&
             (!g->out->domain.zones || texture[t].zone > g->out->domain.zones->zones)))
            return tz_fail(g->ctx, TZ_INVALID,
                           "growth: texture %d wants zone %d, which the domain has not",
                           (int)t, (int)texture[t].zone - 1);
        s = tz_growth_exemplar_init(g->ctx, set, &texture[t], &g->params, ex);
        g->spacing = fmin(g->spacing, ex->spacing);
        g->radius = fmax(g->radius, ex->radius);
        g->reach = fmax(g->reach, ex->reach);
        g->wide = fmax(g->wide, ex->wide);
    }
    return s;
}

static tz_status prepare(tz_growth *g, const tz_element_set *set,
                         const tz_growth_texture *texture, bool closed)
{
    const size_t classes = (size_t)g->textures * TZ_GROWTH_CLASSES;
    tz_status s = tz_alloc_zero(g->ctx, &g->ex, (size_t)g->textures, sizeof *g->ex);
    if (s == TZ_OK)
        s = prepare_textures(g, set, texture);
    if (s == TZ_OK)
        s = make_grid(g);
    if (s == TZ_OK)
        s = tz_growth_cover_init(g, closed);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &g->count, classes, sizeof *g->count);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &g->node, TZ_GROWTH_NODES, sizeof *g->node);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &g->edge, TZ_GROWTH_EDGES, sizeof *g->edge);
    for (int32_t i = 0; i < g->out->element.n && s == TZ_OK; i++)
        s = add_given(g, i);
    for (int32_t i = 0; i < g->spot.n && s == TZ_OK; i++)
        match_given(g, i);
    if (closed) /* what is given stays as it is until a tool touches it */
        g->phase = DONE;
    return s;
}

tz_status tz_growth_open(tz_ctx *ctx, const tz_element_set *palette,
                         const tz_growth_texture *texture, int32_t n,
                         const tz_growth_params *params, tz_element_set *output,
                         bool closed, tz_growth **growth)
{
    tz_growth *g = NULL;
    const tz_vec3 size = output->domain.size;
    if (!(size.x > 0) || !(size.y > 0) || !isfinite(size.x) || !isfinite(size.y))
        return tz_fail(ctx, TZ_INVALID, "growth: a domain of %g x %g has no area", size.x,
                       size.y);
    if (n < 1 || n > TZ_GROWTH_TEXTURES)
        return tz_fail(ctx, TZ_INVALID, "growth: %d textures: give 1 to %d", (int)n,
                       (int)TZ_GROWTH_TEXTURES);
    tz_status s = tz_alloc_zero(ctx, &g, 1, sizeof *g);
    if (s != TZ_OK)
        return s;
    g->ctx = ctx;
    g->params = *params;
    g->out = output;
    const tz_frames *f = output->domain.frames;
    g->least = f && f->apart ? f->apart_least : 1;
    g->most = f && f->apart ? f->apart_most : 1;
    g->textures = n;
    g->box_hi = (tz_vec2){size.x, size.y};
    s = prepare(g, palette, texture, closed);
    if (s != TZ_OK)
        tz_growth_end(g);
    else
        *growth = g;
    return s;
}

tz_status tz_growth_begin_palette(tz_ctx *ctx, const tz_element_set *palette,
                                  const tz_growth_texture *texture, int32_t n,
                                  const tz_growth_params *params, tz_element_set *output,
                                  tz_growth **growth)
{
    return tz_growth_open(ctx, palette, texture, n, params, output, false, growth);
}

tz_status tz_growth_begin(tz_ctx *ctx, const tz_element_set *exemplar,
                          const tz_growth_params *params, tz_element_set *output,
                          tz_growth **growth)
{
    const tz_growth_texture all = {.scale = 1};
    return tz_growth_open(ctx, exemplar, &all, 1, params, output, false, growth);
}

void tz_growth_radii(const tz_growth *g, int32_t texture, tz_growth_radius *radius)
{
    const tz_growth_exemplar *ex = &g->ex[texture];
    const double scale = ex->texture.scale;
    for (int32_t kind = 0; kind < ex->set->kind.n; kind++) {
        int32_t n = 0;
        radius[kind] = (tz_growth_radius){0, 0};
        for (int32_t k = 0; k < ex->elements; k++)
            if (ex->unit[k].kind == kind) {
                radius[kind].bounding += (double)ex->unit[k].r / scale;
                radius[kind].neighbourhood += (double)ex->unit[k].reach / scale;
                n++;
            }
        if (n) {
            radius[kind].bounding /= n;
            radius[kind].neighbourhood /= n;
        }
    }
}

void tz_growth_end(tz_growth *g)
{
    if (!g)
        return;
    for (int32_t t = 0; g->ex && t < g->textures; t++)
        tz_growth_exemplar_deinit(g->ctx, &g->ex[t]);
    tz_growth_cover_deinit(g);
    tz_extents_deinit(&g->extents);
    tz_free(g->ctx, g->disc);
    tz_free(g->ctx, g->ex);
    tz_array_free(g->ctx, &g->spot);
    tz_free(g->ctx, g->head);
    tz_free(g->ctx, g->queue);
    tz_free(g->ctx, g->count);
    tz_free(g->ctx, g->node);
    tz_free(g->ctx, g->edge);
    tz_free(g->ctx, g);
}

/* ---- rounds ---------------------------------------------------------------------- */

static bool is_full(const tz_growth *g)
{
    return g->params.most > 0 && g->placed >= g->params.most;
}

static tz_status grow(tz_growth *g)
{
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < TZ_GROWTH_BATCH && g->queue_n > 0 && s == TZ_OK; k++) {
        const int32_t seed = g->queue[g->queue_head];
        int32_t grown;
        g->queue_head = (g->queue_head + 1) % g->queue_cap;
        g->queue_n--;
        g->spot.v[seed].queued = false;
        s = tz_growth_visit(g, seed, TZ_GROWTH_STRICT, &grown);
        if (grown)
            g->round[g->rounds++] = seed;
    }
    if (g->queue_n == 0)
        g->phase = FILL;
    return s;
}

/* Seeds that found nothing good enough take what fits. */
static tz_status fill(tz_growth *g)
{
    tz_status s = TZ_OK;
    int32_t grown = 0;
    while (g->filled < g->spot.n && !grown && s == TZ_OK) {
        const int32_t i = g->filled++;
        if (g->spot.v[i].waiting)
            s = tz_growth_visit(g, i, TZ_GROWTH_LOOSE, &grown);
    }
    g->phase = grown ? GROW : START;
    return s;
}

/* Any unit that may stand there, one whose neighbourhood is known if possible; -1 = none.
 */
static int32_t draw_unit(const tz_growth *g, int32_t texture, double x, double y,
                         tz_rng *r)
{
    const tz_growth_exemplar *ex = &g->ex[texture];
    const int32_t from = tz_rng_below(r, ex->n);
    int32_t other = -1;
    for (int32_t i = 0; i < ex->n; i++) {
        const int32_t k = (from + i) % ex->n;
        const tz_growth_unit *u = &ex->unit[k];
        if (!u->copied || !tz_growth_may_stand(g, texture, u, x, y))
            continue;
        if (u->whole)
            return k;
        other = other < 0 ? k : other;
    }
    return other;
}

/* Starts in an empty place: of some units drawn by lot the one that fits best. */
static tz_status start_at(tz_growth *g, int32_t texture, double x, double y, bool forced,
                          bool *started)
{
    const tz_growth_exemplar *ex = &g->ex[texture];
    tz_growth_view view;
    tz_rng r = tz_rng_make(g->params.seed, tz_rng_stream('s', (uint64_t)g->spot.n, 0));
    int32_t best = -1;
    float least = INFINITY;
    tz_growth_look(g, x, y, fmax(g->wide, ex->spacing), -1, &view);
    for (int32_t k = 0; k < STARTS; k++) {
        const int32_t unit = draw_unit(g, texture, x, y, &r);
        uint64_t used;
        if (unit < 0 || (!forced && !tz_growth_fits_elements(ex, &ex->unit[unit], &view)))
            continue;
        const float cost = (0.1F + tz_growth_cost(ex, unit, &view, INFINITY, &used)) *
                           (1 + tz_growth_surplus(g, texture, ex->unit[unit].class));
        if (cost < least)
            least = cost, best = unit;
    }
    *started = best >= 0;
    if (best < 0)
        return TZ_OK;
    return tz_growth_place(g, texture, best,
                           tz_growth_show(g, texture, best, x, y, &view), x, y, &view);
}

/* Radius of the disc about a place that touches no element; up to `most`. */
double tz_growth_gap(const tz_growth *g, double x, double y, double most)
{
    tz_growth_view view;
    tz_growth_look(g, x, y, most, -1, &view);
    for (int32_t i = 0; i < view.n; i++) {
        const tz_growth_seen *o = &view.v[i];
        if (g->spot.v[o->spot].out >= 0)
            most = fmin(most, (double)hypotf(o->x, o->y) - o->r);
    }
    return most;
}

int32_t tz_growth_texture_at(const tz_growth *g, double x, double y)
{
    tz_rng r = tz_rng_make(g->params.seed, tz_rng_stream('t', (uint64_t)g->spot.n, 0));
    const int32_t from = tz_rng_below(&r, g->textures);
    for (int32_t k = 0; k < g->textures; k++) {
        const int32_t t = (from + k) % g->textures;
        if (tz_growth_is_of(g, t, x, y))
            return t;
    }
    return -1;
}

static double scale_at(const tz_growth *g, double x, double y)
{
    return tz_domain_apart(&g->out->domain, (tz_vec3){x, y, 0});
}

/* A place that no seed has reached. If the output is dense enough and the exemplar has
 * holes as wide it stays empty. */
static tz_status start(tz_growth *g)
{
    bool started = false;
    tz_status s = TZ_OK;
    double x, y;
    while (s == TZ_OK && !started && tz_growth_next_open(g, &g->started, &x, &y)) {
        const int32_t t = tz_growth_texture_at(g, x, y);
        if (t < 0) {
            tz_growth_decide_place(g, 0, x, y, 0);
            continue;
        }
        const tz_growth_exemplar *ex = &g->ex[t];
        const double hole = start_gap * ex->hole;
        const bool first = g->counted[t] == 0;
        const double cx = 0.5 * g->out->domain.size.x, cy = 0.5 * g->out->domain.size.y;
        if (first && tz_growth_is_of(g, t, cx, cy))
            s = start_at(g, t, cx, cy, true, &started);
        if (started || s != TZ_OK) {
            g->started = 0; /* the place itself is still open */
            break;
        }
        const double gap = tz_growth_gap(g, x, y, hole);
        if (first || gap >= hole || tz_growth_error(g, t) < 0)
            s = start_at(g, t, x, y, first, &started);
        if (!started && s == TZ_OK)
            tz_growth_decide_place(g, t, x, y,
                                   start_step * ex->spacing * scale_at(g, x, y));
    }
    if (!started && s == TZ_OK) { /* scraps behind those that have started: empty */
        int64_t from = 0;
        while (tz_growth_next_open(g, &from, &x, &y)) {
            const int32_t t = tz_growth_texture_at(g, x, y);
            tz_growth_decide_place(g, t < 0 ? 0 : t, x, y,
                                   start_step * g->spacing * scale_at(g, x, y));
        }
    }
    g->phase = started ? GROW : CLOSE;
    return s;
}

/* Holes wider than the exemplar's widest, wherever they are. */
static tz_status close_holes(tz_growth *g)
{
    bool started;
    const tz_status s = tz_growth_close_holes(g, &started);
    g->phase = started ? GROW : MEND;
    return s;
}

/* Where the output is too sparse as a whole, neighbours that found no room are tried once
 * more: by now things have moved. */
static tz_status mend(tz_growth *g)
{
    tz_status s = TZ_OK;
    int32_t grown = 0;
    while (g->mended < g->spot.n && g->rounds < TZ_GROWTH_BATCH && s == TZ_OK) {
        const int32_t i = g->mended++;
        const tz_growth_spot *q = &g->spot.v[i];
        if (q->match >= 0 && tz_growth_error(g, q->texture) < mend_below &&
            q->first < g->ex[q->texture].unit[q->match].ring_due)
            s = tz_growth_visit(g, i, TZ_GROWTH_MEND, &grown);
    }
    if (g->mended >= g->spot.n)
        g->phase = g->queue_n > 0 ? GROW : POLISH;
    return s;
}

tz_status tz_growth_seed(tz_growth *g, int32_t texture, double x, double y, double gap)
{
    bool started;
    tz_growth_view view;
    tz_growth_look(g, x, y, gap, -1, &view);
    for (int32_t i = 0; i < view.n; i++)
        if (view.v[i].texture == texture)
            return TZ_OK;
    g->rounds = 0;
    return start_at(g, texture, x, y, false, &started);
}

void tz_growth_resume(tz_growth *g, tz_vec2 at, double radius)
{
    const tz_vec3 size = g->out->domain.size;
    tz_vec2 lo = {at.x - radius, at.y - radius}, hi = {at.x + radius, at.y + radius};
    if (g->phase != DONE) { /* what was to be done is still */
        lo = (tz_vec2){fmin(lo.x, g->box_lo.x), fmin(lo.y, g->box_lo.y)};
        hi = (tz_vec2){fmax(hi.x, g->box_hi.x), fmax(hi.y, g->box_hi.y)};
    }
    const bool over = lo.x < 0 || lo.y < 0 || hi.x > size.x || hi.y > size.y;
    if (g->out->domain.torus && over)
        lo = (tz_vec2){0, 0}, hi = (tz_vec2){size.x, size.y};
    g->box_lo = (tz_vec2){fmax(0, lo.x), fmax(0, lo.y)};
    g->box_hi = (tz_vec2){fmin(size.x, hi.x), fmin(size.y, hi.y)};
    g->phase = GROW;
    g->started = 0;
    g->closed = g->filled = g->mended = 0;
}

void tz_growth_rest(tz_growth *g)
{
    g->phase = DONE;
    g->rounds = 0;
}

static tz_status optimise(tz_growth *g)
{
    if (g->params.optimise == TZ_GROWTH_GLOBAL &&
        (g->spot.n > 1.25 * g->solved + TZ_GROWTH_BATCH || g->phase >= POLISH))
        return tz_growth_solve(g);
    if (g->params.optimise == TZ_GROWTH_LOCAL)
        tz_growth_relax(g);
    return TZ_OK;
}

tz_status tz_growth_step(tz_growth *g, int32_t budget, bool *more)
{
    const int64_t until = (int64_t)g->placed + (budget > 1 ? budget : 1);
    tz_status s = TZ_OK;
    *more = g->phase != DONE;
    while (s == TZ_OK && g->phase != DONE && g->placed < until) {
        if (tz_ctx_cancelled(g->ctx))
            return TZ_CANCELLED;
        g->rounds = 0;
        if (is_full(g) && g->phase < POLISH)
            g->phase = POLISH;
        switch ((phase)g->phase) {
        case GROW: s = grow(g); break;
        case FILL: s = fill(g); break;
        case START: s = start(g); break;
        case CLOSE: s = close_holes(g); break;
        case MEND: s = mend(g); break;
        case POLISH: g->phase = DONE; break;
        case DONE: break;
        }
        if (s == TZ_OK)
            s = optimise(g);
    }
    *more = g->phase != DONE;
    return s;
}
