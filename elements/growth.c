/* SPDX-License-Identifier: Apache-2.0 */
/* Region growing, the driver: [Dav19] Algorithm 1.
 *
 *     while target region is not filled do            TZ_GROW
 *         visit seeds: copy what their best units have and they have not
 *         optimise what the round has touched
 *     fill what is left                               FILL
 *         visit once more those that found nothing good enough, and take what fits
 *         start anew in empty places that no seed reaches
 *     optimise everything once more                   POLISH
 *
 * Seeds are served in the order in which they came, so that the growth spreads as a disc.
 * A round takes a fixed number of them, whatever the budget of the step: the output does
 * not depend on how the work is cut into steps. Everything is serial. */
#include "elements/growth.h"

#include <string.h>

#include "elements/growth_internal.h"

typedef enum phase { GROW, FILL, START, POLISH, DONE } phase;

enum { STARTS = 8, SAMPLED = 256, CELLS = 1 << 22 };

/* Places emptier than this many of the exemplar's holes are started in; they are looked
 * for at a step of this many spacings. */
static const double start_gap = 1.05, start_step = 0.33;

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
    double cell = 0.9 * g->ex.spacing;
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

static tz_status add_given(tz_growth *g, int32_t i)
{
    const tz_element *e = &g->out->element.v[i];
    const bool oriented =
        e->kind < g->ex.set->kind.n && g->ex.set->kind.v[e->kind].oriented;
    const int32_t unit = like(&g->ex, e->kind, e->radius);
    const tz_status s = tz_growth_reserve(g, 1);
    if (s != TZ_OK)
        return s;
    const bool copy = e->source >= 0 && e->source < g->ex.elements &&
                      g->ex.unit[e->source].kind == e->kind;
    g->spot.v[g->spot.n] = (tz_growth_spot){.x = e->at.x,
                                            .y = e->at.y,
                                            .r = (float)e->radius,
                                            .c2 = oriented ? (float)cos(2 * e->angle) : 0,
                                            .s2 = oriented ? (float)sin(2 * e->angle) : 0,
                                            .kind = e->kind,
                                            .hard = unit < 0 ? -1 : g->ex.unit[unit].hard,
                                            .match = copy ? e->source : unit,
                                            .out = i,
                                            .node = -1,
                                            .fixed = e->fixed};
    tz_growth_link(g, g->spot.n);
    g->spot.n++;
    g->ex.radius = fmax(g->ex.radius, e->radius);
    if (unit >= 0) {
        g->count[g->ex.unit[g->spot.v[i].match].class]++;
        g->counted++;
        tz_growth_enqueue(g, i);
    }
    return TZ_OK;
}

/* Given elements that copy nothing get the unit whose surroundings are most like theirs.
 */
static void match_given(tz_growth *g, int32_t i)
{
    tz_growth_spot *q = &g->spot.v[i];
    const int32_t step = g->ex.n / SAMPLED + 1;
    tz_growth_view view;
    uint64_t used;
    float least = INFINITY;
    if (q->match < 0 || g->out->element.v[i].source == q->match)
        return;
    tz_growth_look(g, q->x, q->y, g->ex.reach, i, &view);
    for (int32_t k = 0; k < g->ex.n; k += step) {
        const float cost = tz_growth_match(&g->ex, k, view.v, view.n, &used, NULL) +
                           (g->ex.unit[k].whole ? 0 : 0.1F) +
                           fabsf(g->ex.unit[k].r - q->r) / (g->ex.unit[k].r + q->r);
        if (g->ex.unit[k].kind == q->kind && cost < least)
            least = cost, q->match = k;
    }
}

static tz_status prepare(tz_growth *g)
{
    tz_status s = tz_growth_exemplar_init(g->ctx, g->ex.set, &g->params, &g->ex);
    if (s == TZ_OK)
        s = make_grid(g);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &g->count, (size_t)g->ex.classes, sizeof *g->count);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &g->node, TZ_GROWTH_NODES, sizeof *g->node);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &g->edge, TZ_GROWTH_EDGES, sizeof *g->edge);
    for (int32_t i = 0; i < g->out->element.n && s == TZ_OK; i++)
        s = add_given(g, i);
    for (int32_t i = 0; i < g->spot.n && s == TZ_OK; i++)
        match_given(g, i);
    return s;
}

tz_status tz_growth_begin(tz_ctx *ctx, const tz_element_set *exemplar,
                          const tz_growth_params *params, tz_element_set *output,
                          tz_growth **growth)
{
    tz_growth *g = NULL;
    const tz_vec3 size = output->domain.size;
    if (!(size.x > 0) || !(size.y > 0) || !isfinite(size.x) || !isfinite(size.y))
        return tz_fail(ctx, TZ_INVALID, "growth: a domain of %g x %g has no area", size.x,
                       size.y);
    tz_status s = tz_alloc_zero(ctx, &g, 1, sizeof *g);
    if (s != TZ_OK)
        return s;
    g->ctx = ctx;
    g->params = *params;
    g->out = output;
    g->ex.set = exemplar;
    s = prepare(g);
    if (s != TZ_OK)
        tz_growth_end(g);
    else
        *growth = g;
    return s;
}

void tz_growth_end(tz_growth *g)
{
    if (!g)
        return;
    tz_growth_exemplar_deinit(g->ctx, &g->ex);
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
        s = tz_growth_visit(g, seed, false, &grown);
        if (grown)
            g->round[g->rounds++] = seed;
    }
    if (g->queue_n == 0)
        g->phase = FILL;
    return s;
}

static tz_status fill(tz_growth *g)
{
    tz_status s = TZ_OK;
    int32_t grown = 0;
    while (g->filled < g->spot.n && !grown && s == TZ_OK) {
        const int32_t i = g->filled++;
        if (g->spot.v[i].waiting)
            s = tz_growth_visit(g, i, true, &grown);
    }
    g->phase = grown ? GROW : START;
    return s;
}

static bool is_empty(const tz_growth *g, double x, double y, double gap)
{
    tz_growth_view view;
    tz_growth_look(g, x, y, gap, -1, &view);
    for (int32_t i = 0; i < view.n; i++) {
        const tz_growth_seen *o = &view.v[i];
        const double d = gap + fmax(0, o->r - 0.5 * g->ex.spacing);
        if (o->x * o->x + o->y * o->y < d * d)
            return false;
    }
    return true;
}

/* Any unit, one whose neighbourhood is known if possible. */
static int32_t draw_unit(const tz_growth *g, tz_rng *r)
{
    const int32_t from = tz_rng_below(r, g->ex.n);
    int32_t other = -1;
    for (int32_t i = 0; i < g->ex.n; i++) {
        const int32_t k = (from + i) % g->ex.n;
        if (g->ex.unit[k].copied && g->ex.unit[k].whole)
            return k;
        if (g->ex.unit[k].copied && other < 0)
            other = k;
    }
    return other;
}

/* Starts in an empty place: of some units drawn by lot the one that fits best. */
static tz_status start_at(tz_growth *g, double x, double y, bool forced, bool *started)
{
    tz_growth_view view;
    tz_rng r = tz_rng_make(g->params.seed, tz_rng_stream('s', (uint64_t)g->spot.n, 0));
    int32_t best = -1;
    float least = INFINITY;
    tz_growth_look(g, x, y, fmax(g->ex.wide, g->ex.spacing), -1, &view);
    for (int32_t k = 0; k < STARTS; k++) {
        const int32_t unit = draw_unit(g, &r);
        const tz_growth_unit *u = &g->ex.unit[unit];
        uint64_t used;
        if (!forced && !tz_growth_fits(g, u, 0, 0, &view))
            continue;
        const float due = g->ex.frequency[u->class] * (float)(g->counted + 1);
        const float cost = (0.1F + tz_growth_cost(&g->ex, unit, &view, &used)) *
                           ((float)g->count[u->class] + 2) / (due + 2);
        if (cost < least)
            least = cost, best = unit;
    }
    *started = best >= 0;
    return best >= 0 ? tz_growth_place(g, best, x, y, &view) : TZ_OK;
}

static tz_status start(tz_growth *g)
{
    const tz_vec3 size = g->out->domain.size;
    const double step = start_step * g->ex.spacing;
    const double gap = fmax(start_gap * g->ex.hole, 0.5 * g->ex.spacing);
    const int32_t nx = (int32_t)fmin(16384, fmax(1, ceil(size.x / step)));
    const int32_t ny = (int32_t)fmin(16384, fmax(1, ceil(size.y / step)));
    bool started = false;
    tz_status s = TZ_OK;
    if (g->spot.n == 0)
        s = start_at(g, 0.5 * size.x, 0.5 * size.y, true, &started);
    while (s == TZ_OK && !started && g->started < nx * ny) {
        const int32_t i = g->started++;
        const double x = (i % nx + 0.5) * size.x / nx;
        const double y = ((double)(i / nx) + 0.5) * size.y / ny;
        const double rim = fmin(fmin(x, size.x - x), fmin(y, size.y - y));
        if ((g->out->domain.torus || rim > 0.5 * gap) && is_empty(g, x, y, gap))
            s = start_at(g, x, y, false, &started);
    }
    g->phase = started ? GROW : POLISH;
    return s;
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

/* Once over everything in the order of placement. */
static void polish(tz_growth *g)
{
    while (g->polished < g->spot.n && g->rounds < 4 * TZ_GROWTH_BATCH)
        g->round[g->rounds++] = g->polished++;
    if (g->polished == g->spot.n || g->params.optimise != TZ_GROWTH_LOCAL)
        g->phase = DONE;
}

tz_status tz_growth_step(tz_growth *g, int32_t budget, bool *more)
{
    const int64_t until = (int64_t)g->placed + (budget > 1 ? budget : 1);
    tz_status s = TZ_OK;
    *more = g->phase != DONE;
    while (s == TZ_OK && g->phase != DONE && (g->placed < until || g->phase == POLISH)) {
        if (tz_ctx_cancelled(g->ctx))
            return TZ_CANCELLED;
        g->rounds = 0;
        if (is_full(g) && g->phase < POLISH)
            g->phase = POLISH;
        switch ((phase)g->phase) {
        case GROW: s = grow(g); break;
        case FILL: s = fill(g); break;
        case START: s = start(g); break;
        case POLISH: polish(g); break;
        case DONE: break;
        }
        if (s == TZ_OK)
            s = optimise(g);
    }
    *more = g->phase != DONE;
    return s;
}
