/* SPDX-License-Identifier: Apache-2.0 */
/* Patches: windows of the exemplar side by side, row by row, a quarter of each over what
 * is there. Of some windows the one is taken whose samples in the overlap fit those there
 * best (the assignment of Eq. (7), positions and numbers of edges); what finds a partner
 * there is not laid again, and elements come as wholes.
 *
 * Windows are drawn so that one sample of the overlap, a junction or an end if possible,
 * falls on one of the exemplar that has as many edges, and the best is moved by what its
 * pairs are off on average: a window of a regular pattern that is drawn anywhere fits one
 * time in a hundred.
 * @source [Tu20] Sec. 4.3.2. Deviates: windows are drawn to fit; edges inside a patch, and
 *   from it to the partners, come along, and so do matches: the first search begins with
 *   them */
#include <string.h>

#include "base/grid.h"
#include "curves/synthesis_internal.h"

enum { TRIES = 48, PICKS = 16, MOST_FOUND = 512 };
#define PATCH   2.5  /* radii: side */
#define OVERLAP 0.25 /* of the side */
#define ALONE   1.5  /* of the samples' distance: cost of one without a partner */
#define SAME    0.4  /* of the samples' distance: nearer ones are one */

typedef struct quilt {
    tz_curve_solve *t;
    double side;
    tz_vec2 step;     /* from patch to patch */
    tz_grid grid;     /* samples of the output */
    int32_t *partner; /* per sample of the exemplar: the output's, -1 = none */
    tz_assign work;
    int32_t here[TZ_ASSIGN_MOST], there[TZ_ASSIGN_MOST]; /* rows and columns of it */
} quilt;

/* A window: centre in the output and in the exemplar. */
typedef struct window {
    tz_vec2 at, from;
    double frame;
    bool left, right, above, below; /* what is laid already */
} window;

static bool inside(tz_vec2 v, double half)
{
    return fabs(v.x) <= half && fabs(v.y) <= half;
}

/* Samples of the output in the window, in the exemplar's frame. */
static int32_t find_here(quilt *k, const window *w, tz_vec2 *v)
{
    const tz_curve_solve *t = k->t;
    int32_t found[MOST_FOUND], n = 0;
    const int32_t all =
        tz_grid_query(&k->grid, w->at, k->side * 0.7072, found, MOST_FOUND);
    for (int32_t i = 0; i < (all < MOST_FOUND ? all : MOST_FOUND) && n < TZ_ASSIGN_MOST;
         i++) {
        const tz_vec2 d = tz_curve_rotate(
            tz_curve_vector(t->job->domain, w->at, k->grid.point.v[found[i]]), -w->frame);
        if (!inside(d, k->side / 2))
            continue;
        v[n] = d;
        k->here[n++] = found[i];
    }
    return n;
}

static int32_t links_of(const tz_curve_solve *t, int32_t s)
{
    return t->match.v[s] >= 0 ? t->x->g.sample.v[t->match.v[s]].links
                              : t->o.sample.v[s].links;
}

/* Whether a place of the window lies in a patch that is laid already. */
static bool covered(const quilt *k, const window *w, tz_vec2 v)
{
    const tz_vec2 to = tz_curve_rotate(v, w->frame),
                  in = {k->side / 2 - k->step.x, k->side / 2 - k->step.y};
    return ((w->left && to.x < in.x) || (w->right && -to.x < in.x) ||
            (w->above && to.y < in.y) || (w->below && -to.y < in.y)) &&
           tz_curve_solve_depth(
               k->t, tz_curve_wrapped(k->t->job->domain, tz_vec2_add(w->at, to))) >= 0;
}

/* How ill the window fits what is there: per sample in the overlap, also those of the
 * window that have no partner there.
 * @param d  distance of samples: pairs may be half as far again from each other */
static double misfit(quilt *k, const window *w, const tz_vec2 *v, int32_t n, double d)
{
    const tz_curve_solve *t = k->t;
    const tz_sample_graph *g = &t->x->g;
    tz_assign *a = &k->work;
    a->rows = n;
    a->cols = 0;
    for (int32_t j = 0; j < g->sample.n && a->cols < TZ_ASSIGN_MOST; j++) {
        const tz_vec2 p = tz_curve_vector(&g->domain, w->from, g->sample.v[j].at);
        if (!inside(p, k->side / 2) || t->x->cut[j])
            continue;
        bool near = false;
        for (int32_t i = 0; i < n; i++) {
            const double far = tz_vec2_length(tz_vec2_sub(v[i], p));
            const int32_t more = links_of(t, k->here[i]) - g->sample.v[j].links;
            const bool alike = t->o.sample.v[k->here[i]].q == g->sample.v[j].q;
            a->cost[i][a->cols] =
                alike ? (float)(far + 0.5 * d * (more < 0 ? -more : more)) : INFINITY;
            near = near || far < ALONE * d;
        }
        if (near)
            k->there[a->cols++] = j;
    }
    for (int32_t i = 0; i < n; i++)
        a->exit[i] = (float)(ALONE * d);
    if (n == 0)
        return 0;
    double sum = (double)tz_assign_solve(a, false, INFINITY);
    int32_t all = n;
    for (int32_t j = 0; j < a->cols; j++) {
        const tz_vec2 p =
            tz_curve_vector(&g->domain, w->from, g->sample.v[k->there[j]].at);
        if (a->row[j] >= 0 || !covered(k, w, p))
            continue;
        sum += ALONE * d;
        all++;
    }
    return sum / all;
}

/* ---- laying a patch ----------------------------------------------------------------- */

static bool is_free(const quilt *k, tz_vec2 at)
{
    int32_t any;
    return tz_grid_query(&k->grid, at, SAME * k->t->x->apart, &any, 1) == 0;
}

static tz_status grid_rest(quilt *k)
{
    tz_status s = TZ_OK;
    int32_t id;
    while (k->grid.point.n < k->t->o.sample.n && s == TZ_OK)
        s = tz_grid_add(k->t->ctx, &k->grid, k->t->o.sample.v[k->grid.point.n].at, &id);
    return s;
}

static tz_status lay_sample(quilt *k, const window *w, int32_t j)
{
    tz_curve_solve *t = k->t;
    const tz_sample_graph *g = &t->x->g;
    const tz_curve_sample *q = &g->sample.v[j];
    const tz_vec2 v = tz_curve_vector(&g->domain, w->from, q->at);
    const tz_vec2 at = tz_curve_wrapped(t->job->domain,
                                        tz_vec2_add(w->at, tz_curve_rotate(v, w->frame)));
    if (!inside(v, k->side / 2) || t->x->cut[j] || k->partner[j] >= 0 ||
        tz_curve_solve_depth(t, at) < 0)
        return TZ_OK;
    if (q->q != TZ_SAMPLE_CURVE)
        return tz_curve_solve_place(t, j, at);
    if (!is_free(k, at))
        return TZ_OK;
    tz_curve_sample p = {.at = at,
                         .q = q->q,
                         .element = -1,
                         .existence = 1,
                         .turn = t->o.turn.n,
                         .turns = q->turns};
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < q->turns && s == TZ_OK; i++)
        s = tz_array_push(t->ctx, &t->o.turn,
                          tz_curve_angle(g->turn.v[q->turn + i] + w->frame));
    k->partner[j] = t->o.sample.n;
    return s == TZ_OK ? tz_curve_solve_add(t, &p, j) : s;
}

/* Edges of the window between samples of which at least one is new. */
static tz_status lay_edges(quilt *k, int32_t first_new)
{
    tz_curve_solve *t = k->t;
    const tz_sample_graph *g = &t->x->g;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < g->edge.n && s == TZ_OK; i++) {
        const int32_t a = k->partner[g->edge.v[i].from], b = k->partner[g->edge.v[i].to];
        if (a < 0 || b < 0 || (a < first_new && b < first_new))
            continue;
        s = tz_array_push(
            t->ctx, &t->o.edge,
            ((tz_curve_edge){
                .from = a, .to = b, .pen = g->edge.v[i].pen, .existence = 1, .like = i}));
    }
    return s;
}

static tz_status lay(quilt *k, const window *w, const tz_vec2 *v, int32_t n)
{
    tz_curve_solve *t = k->t;
    const int32_t before = t->o.sample.n;
    tz_status s = TZ_OK;
    memset(k->partner, 255, (size_t)t->x->g.sample.n * sizeof *k->partner);
    (void)misfit(k, w, v, n, t->o.spacing);
    for (int32_t i = 0; i < n; i++)
        if (k->work.to[i] >= 0)
            k->partner[k->there[k->work.to[i]]] = k->here[i];
    for (int32_t j = 0; j < t->x->g.sample.n && s == TZ_OK; j++)
        s = lay_sample(k, w, j);
    if (s == TZ_OK)
        s = lay_edges(k, before);
    return s == TZ_OK ? grid_rest(k) : s;
}

/* A window that lies in the exemplar. */
static tz_vec2 any_window(const quilt *k, tz_rng *r)
{
    const tz_vec3 size = k->t->x->g.domain.size;
    const double half = k->side / 2;
    if (k->t->x->g.domain.torus)
        return (tz_vec2){tz_rng_range(r, 0, size.x), tz_rng_range(r, 0, size.y)};
    return (tz_vec2){size.x > k->side ? tz_rng_range(r, half, size.x - half) : size.x / 2,
                     size.y > k->side ? tz_rng_range(r, half, size.y - half)
                                      : size.y / 2};
}

static bool lies_in(const quilt *k, tz_vec2 from)
{
    const tz_vec3 size = k->t->x->g.domain.size;
    const double half = k->side / 2;
    return k->t->x->g.domain.torus || (from.x >= half && from.x <= size.x - half &&
                                       from.y >= half && from.y <= size.y - half);
}

/* A window that puts a sample of the exemplar onto one that is there; anywhere, if none of
 * those that are drawn does. */
static tz_vec2 fitting_window(const quilt *k, const tz_vec2 *v, int32_t n, tz_rng *r)
{
    const tz_curve_solve *t = k->t;
    const tz_sample_graph *g = &t->x->g;
    int32_t i = tz_rng_below(r, n);
    for (int pick = 0; pick < PICKS && links_of(t, k->here[i]) == 2; pick++)
        i = tz_rng_below(r, n);
    for (int pick = 0; pick < 4 * PICKS; pick++) {
        const int32_t j = tz_rng_below(r, g->sample.n);
        if (t->x->cut[j] || g->sample.v[j].q != t->o.sample.v[k->here[i]].q ||
            g->sample.v[j].links != links_of(t, k->here[i]))
            continue;
        const tz_vec2 from =
            tz_curve_wrapped(&g->domain, tz_vec2_sub(g->sample.v[j].at, v[i]));
        if (lies_in(k, from))
            return from;
    }
    return any_window(k, r);
}

/* The window moved by the mean of what its pairs are off; misfit() has been called. */
static tz_vec2 settled(const quilt *k, const window *w, const tz_vec2 *v, int32_t n)
{
    const tz_sample_graph *g = &k->t->x->g;
    tz_vec2 sum = {0, 0};
    double pairs = 0;
    for (int32_t i = 0; i < n; i++) {
        if (k->work.to[i] < 0)
            continue;
        const tz_vec2 at = g->sample.v[k->there[k->work.to[i]]].at;
        sum =
            tz_vec2_add(sum, tz_vec2_sub(tz_curve_vector(&g->domain, w->from, at), v[i]));
        pairs++;
    }
    const tz_vec2 from = tz_curve_wrapped(
        &g->domain, tz_vec2_add(w->from, tz_vec2_scale(sum, pairs > 0 ? 1 / pairs : 0)));
    return lies_in(k, from) ? from : w->from;
}

static tz_status fill_place(quilt *k, window best, int32_t place)
{
    tz_curve_solve *t = k->t;
    tz_rng r = tz_rng_make(t->job->seed, tz_rng_stream(0x9a7c4, (uint64_t)place, 0));
    const tz_vec2 at = best.at;
    best.from = any_window(k, &r);
    best.frame = tz_curve_solve_frame(t, at);
    tz_vec2 v[TZ_ASSIGN_MOST];
    if (tz_curve_solve_depth(t, at) < -0.7072 * k->side)
        return TZ_OK;
    const int32_t n = find_here(k, &best, v);
    double least = INFINITY;
    for (int32_t i = 0; i < TRIES && n > 0; i++) {
        window w = best;
        w.from = fitting_window(k, v, n, &r);
        double m = misfit(k, &w, v, n, t->x->apart);
        if (!(m < least))
            continue;
        least = m;
        best = w;
        w.from = settled(k, &w, v, n);
        m = misfit(k, &w, v, n, t->x->apart);
        if (m < least) {
            least = m;
            best = w;
        }
    }
    return lay(k, &best, v, n);
}

tz_status tz_curve_solve_patches(tz_curve_solve *t)
{
    const tz_domain *d = t->job->domain;
    const tz_vec3 size = t->x->g.domain.size;
    const double m = d->torus ? 0 : t->margin;
    const double wide = d->size.x + 2 * m, high = d->size.y + 2 * m;
    quilt k = {.t = t};
    k.side = fmin(PATCH * t->x->g.radius, 0.8 * fmin(size.x, size.y));
    const double step = k.side * (1 - OVERLAP);
    const double nx = fmax(floor(wide / step + 0.5), 1),
                 ny = fmax(floor(high / step + 0.5), 1);
    k.step = (tz_vec2){wide / nx, high / ny};
    if (nx * ny > 4e6)
        return tz_fail(t->ctx, TZ_LIMIT,
                       "the domain is %g times as large as a patch of the exemplar; make "
                       "it smaller",
                       nx * ny);
    tz_status s = tz_grid_init(t->ctx, &k.grid, (tz_vec2){-m, -m}, (tz_vec2){wide, high},
                               t->x->g.spacing, d->torus);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &k.partner, (size_t)t->x->g.sample.n, sizeof *k.partner);
    if (s == TZ_OK)
        s = tz_sample_graph_link(&t->o);
    if (s == TZ_OK)
        s = grid_rest(&k);
    for (int32_t y = 0; y < (int32_t)ny && s == TZ_OK; y++)
        for (int32_t x = 0; x < (int32_t)nx && s == TZ_OK; x++) {
            const window w = {
                .at = {-m + (x + 0.5) * k.step.x, -m + (y + 0.5) * k.step.y},
                .left = x > 0,
                .right = d->torus && x > 0 && x + 1 == (int32_t)nx,
                .above = y > 0,
                .below = d->torus && y > 0 && y + 1 == (int32_t)ny};
            s = tz_ctx_cancelled(t->ctx) ? TZ_CANCELLED
                                         : fill_place(&k, w, y * (int32_t)nx + x);
        }
    tz_grid_deinit(t->ctx, &k.grid);
    tz_free(t->ctx, k.partner);
    return s;
}
