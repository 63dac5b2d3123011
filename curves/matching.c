/* SPDX-License-Identifier: Apache-2.0 */
/* Matching. The cost of a pair of neighbours is
 *
 *     |(p(so') - p(so)) - (p(si') - p(si))| + gamma * E(so', si'),            Eq. (8)
 *
 * and the edge difference E, itself an assignment, does not depend on the centres: it is
 * computed once for each pair of samples and looked up ever after. Rows are filled
 * nearest neighbour first; the sum of their least entries is a lower bound of the cost
 * and ends hopeless matches before the solver is asked. */
#include "curves/matching.h"

#include <stdlib.h>
#include <string.h>

#include "base/grid.h"

#define TABLE_MOST ((size_t)256 << 20)
#define INSIDE     0.85 /* of the radius: neighbours whose lack counts */

/* ---- small assignments ------------------------------------------------------------- */

/* All of n rows (1 <= n <= m <= 3) to columns, by trying. */
static double try_all(int32_t n, int32_t m, double cost[][TZ_ASSIGN_MOST], int32_t *to)
{
    const int32_t m1 = n > 1 ? m : 1, m2 = n > 2 ? m : 1;
    double best = INFINITY;
    for (int32_t i = 0; i < m; i++)
        for (int32_t j = 0; j < m1; j++)
            for (int32_t k = 0; k < m2; k++) {
                if ((n > 1 && i == j) || (n > 2 && (i == k || j == k)))
                    continue;
                const double sum =
                    cost[0][i] + (n > 1 ? cost[1][j] : 0) + (n > 2 ? cost[2][k] : 0);
                if (sum < best) {
                    const int32_t found[3] = {i, j, k};
                    best = sum;
                    memcpy(to, found, (size_t)n * sizeof *to);
                }
            }
    return best;
}

/* All of n rows to m >= n columns. */
static double assign_all(int32_t n, int32_t m, double cost[][TZ_ASSIGN_MOST], int32_t *to)
{
    tz_assign a;
    if (n == 0)
        return 0;
    if (m <= 3)
        return try_all(n, m, cost, to);
    a.rows = n;
    a.cols = m;
    for (int32_t i = 0; i < n; i++) {
        a.exit[i] = INFINITY;
        for (int32_t j = 0; j < m; j++)
            a.cost[i][j] = (float)cost[i][j];
    }
    (void)tz_assign_solve(&a, false, INFINITY);
    double sum = 0;
    for (int32_t i = 0; i < n; i++) {
        to[i] = a.to[i];
        sum += cost[i][to[i]];
    }
    return sum;
}

typedef double (*entry)(const void *a, int32_t i, const void *b, int32_t j);

/* Least sum over one-to-one pairs of n with m things: as many pairs as there can be. */
static double match_all(const void *a, int32_t n, const void *b, int32_t m, entry cost_of,
                        int32_t *to)
{
    double cost[TZ_ASSIGN_MOST][TZ_ASSIGN_MOST];
    int32_t pair[TZ_ASSIGN_MOST];
    const bool turned = n > m;
    const int32_t rows = turned ? m : n, cols = turned ? n : m;
    for (int32_t i = 0; i < rows; i++)
        for (int32_t j = 0; j < cols; j++)
            cost[i][j] = turned ? cost_of(a, j, b, i) : cost_of(a, i, b, j);
    const double sum = assign_all(rows, cols, cost, pair);
    for (int32_t i = 0; i < n && to; i++)
        to[i] = turned ? -1 : pair[i];
    for (int32_t i = 0; turned && i < rows && to; i++)
        to[pair[i]] = i;
    return sum;
}

/* ---- samples ----------------------------------------------------------------------- */

static double edge_distance(const void *a, int32_t i, const void *b, int32_t j)
{
    const tz_vec2 d = tz_vec2_sub(((const tz_vec2 *)a)[i], ((const tz_vec2 *)b)[j]);
    return tz_vec2_length(d);
}

/* Turned back by the frame where there are frames. */
static int32_t edge_vectors(const tz_sample_graph *g, int32_t s, tz_vec2 *out)
{
    const tz_curve_sample *p = &g->sample.v[s];
    const int32_t n = p->links < TZ_ASSIGN_MOST ? p->links : TZ_ASSIGN_MOST;
    for (int32_t i = 0; i < n; i++) {
        const tz_vec2 q = g->sample.v[g->link.v[p->link + i].to].at;
        const tz_vec3 v = tz_domain_vector(&g->domain, (tz_vec3){p->at.x, p->at.y, 0},
                                           (tz_vec3){q.x, q.y, 0});
        out[i] = (tz_vec2){v.x, v.y};
    }
    if (n > 0 && g->domain.frames) {
        const double a = tz_domain_frame(&g->domain, (tz_vec3){p->at.x, p->at.y, 0});
        const double c = cos(a), sine = sin(a);
        for (int32_t i = 0; i < n; i++)
            out[i] =
                (tz_vec2){c * out[i].x + sine * out[i].y, c * out[i].y - sine * out[i].x};
    }
    return n;
}

double tz_match_edges(const tz_sample_graph *o, int32_t so, const tz_sample_graph *i,
                      int32_t si, double beta, int32_t *to)
{
    tz_vec2 a[TZ_ASSIGN_MOST], b[TZ_ASSIGN_MOST];
    const int32_t n = edge_vectors(o, so, a), m = edge_vectors(i, si, b);
    if (n == 0)
        return 0;
    const int32_t more = o->sample.v[so].links - i->sample.v[si].links;
    return match_all(a, n, b, m, edge_distance, to) + beta * (more < 0 ? -more : more);
}

static double turn_distance(const void *a, int32_t i, const void *b, int32_t j)
{
    return tz_curve_angle_between(((const double *)a)[i], ((const double *)b)[j]);
}

double tz_match_turns(const double *a, int32_t n, const double *b, int32_t m, int32_t *to)
{
    n = n < TZ_ASSIGN_MOST ? n : TZ_ASSIGN_MOST;
    m = m < TZ_ASSIGN_MOST ? m : TZ_ASSIGN_MOST;
    return match_all(a, n, b, m, turn_distance, to);
}

/* ---- neighbourhoods ---------------------------------------------------------------- */

typedef struct neighbour {
    double distance;
    int32_t id;
    tz_vec2 v;
} neighbour;

static int by_distance(const void *a, const void *b)
{
    const neighbour *p = a, *q = b;
    if (p->distance != q->distance)
        return p->distance < q->distance ? -1 : 1;
    return (p->id > q->id) - (p->id < q->id);
}

/* Neighbours of a sample into list, nearest first; how many there are, up to MOST. */
static tz_status gather(tz_ctx *ctx, const tz_sample_graph *g, const tz_grid *grid,
                        double radius, int32_t s, void *list_of_neighbours,
                        int32_t *count)
{
    typedef TZ_ARRAY(neighbour)
    list_type;
    list_type *list = list_of_neighbours;
    const tz_vec2 at = g->sample.v[s].at;
    int32_t few[256], *id = few;
    tz_status st = TZ_OK;
    const int32_t n = tz_grid_query(grid, at, radius, few, 256);
    if (n > 256) {
        st = tz_alloc(ctx, &id, (size_t)n, sizeof *id);
        if (st != TZ_OK)
            return st;
        tz_grid_query(grid, at, radius, id, n);
    }
    list->n = 0;
    for (int32_t i = 0; i < n && st == TZ_OK; i++) {
        const tz_vec2 q = g->sample.v[id[i]].at;
        const tz_vec3 v = tz_domain_vector(&g->domain, (tz_vec3){at.x, at.y, 0},
                                           (tz_vec3){q.x, q.y, 0});
        if (id[i] != s)
            st = tz_array_push(ctx, list,
                               ((neighbour){v.x * v.x + v.y * v.y, id[i], {v.x, v.y}}));
    }
    if (id != few)
        tz_free(ctx, id);
    if (list->n > 1)
        qsort(list->v, (size_t)list->n, sizeof *list->v, by_distance);
    *count = list->n < TZ_MATCH_MOST ? list->n : TZ_MATCH_MOST;
    return st;
}

static tz_status make_grid(tz_ctx *ctx, const tz_sample_graph *g, double radius,
                           tz_grid *grid)
{
    tz_vec2 lo = {INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY};
    int32_t id;
    for (int32_t i = 0; i < g->sample.n; i++) {
        const tz_vec2 p = g->sample.v[i].at;
        lo = (tz_vec2){fmin(lo.x, p.x), fmin(lo.y, p.y)};
        hi = (tz_vec2){fmax(hi.x, p.x), fmax(hi.y, p.y)};
    }
    tz_vec2 size = {fmax(hi.x - lo.x, radius), fmax(hi.y - lo.y, radius)};
    if (g->domain.torus) {
        lo = (tz_vec2){0, 0};
        size = (tz_vec2){g->domain.size.x, g->domain.size.y};
    }
    if (g->sample.n == 0)
        lo = (tz_vec2){0, 0};
    tz_status s = tz_grid_init(ctx, grid, lo, size, radius / 2, g->domain.torus);
    for (int32_t i = 0; i < g->sample.n && s == TZ_OK; i++)
        s = tz_grid_add(ctx, grid, g->sample.v[i].at, &id);
    return s;
}

void tz_match_hoods_deinit(tz_match_hoods *h)
{
    tz_free(h->ctx, h->first);
    tz_free(h->ctx, h->id);
    tz_free(h->ctx, h->x);
    tz_free(h->ctx, h->y);
    memset(h, 0, sizeof *h);
}

tz_status tz_match_hoods_make(tz_ctx *ctx, const tz_sample_graph *g, double radius,
                              tz_match_hoods *h)
{
    TZ_ARRAY(neighbour)
    near = {0}, all = {0};
    tz_match_hoods out = {.n = g->sample.n, .ctx = ctx};
    tz_grid grid = {0};
    memset(h, 0, sizeof *h);
    tz_status s = make_grid(ctx, g, radius, &grid);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &out.first, (size_t)out.n + 1, sizeof *out.first);
    for (int32_t i = 0; i < out.n && s == TZ_OK; i++) {
        int32_t n = 0;
        out.first[i] = all.n;
        s = gather(ctx, g, &grid, radius, i, &near, &n);
        for (int32_t k = 0; k < n && s == TZ_OK; k++)
            s = tz_array_push(ctx, &all, near.v[k]);
    }
    if (s == TZ_OK)
        s = tz_alloc(ctx, &out.id, (size_t)all.n, sizeof *out.id);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &out.x, (size_t)all.n, sizeof *out.x);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &out.y, (size_t)all.n, sizeof *out.y);
    for (int32_t k = 0; k < all.n && s == TZ_OK; k++) {
        out.id[k] = all.v[k].id;
        out.x[k] = (float)all.v[k].v.x;
        out.y[k] = (float)all.v[k].v.y;
    }
    if (s == TZ_OK)
        out.first[out.n] = all.n;
    tz_grid_deinit(ctx, &grid);
    tz_array_free(ctx, &near);
    tz_array_free(ctx, &all);
    if (s == TZ_OK)
        *h = out;
    else
        tz_match_hoods_deinit(&out);
    return s;
}

/* ---- the matcher ------------------------------------------------------------------- */

tz_match_params tz_match_params_default(void)
{
    return (tz_match_params){.gamma = 0.5, .more = 1.25};
}

/* Edges of all samples as vectors, turned back by the frame: item link + k is the k-th. */
typedef struct edge_table {
    tz_matcher *m;
    float *ox, *oy, *ix, *iy;
} edge_table;

static tz_status flatten_edges(tz_ctx *ctx, const tz_sample_graph *g, float **x,
                               float **y)
{
    const size_t n = (size_t)g->link.n;
    tz_status s = tz_alloc(ctx, x, n, sizeof **x);
    if (s == TZ_OK)
        s = tz_alloc(ctx, y, n, sizeof **y);
    for (int32_t i = 0; i < g->sample.n && s == TZ_OK; i++) {
        const tz_curve_sample *p = &g->sample.v[i];
        tz_vec2 v[TZ_ASSIGN_MOST];
        const int32_t few = edge_vectors(g, i, v);
        for (int32_t k = 0; k < few; k++) {
            (*x)[p->link + k] = (float)v[k].x;
            (*y)[p->link + k] = (float)v[k].y;
        }
    }
    return s;
}

/* Least sum of n <= m <= 3 rows to columns; a row is an edge of the side that has fewer. */
static float try_few(const float *ax, const float *ay, int32_t n, const float *bx,
                     const float *by, int32_t m)
{
    float d[3][3] = {{0}}, best = INFINITY;
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j < m; j++) {
            const float dx = ax[i] - bx[j], dy = ay[i] - by[j];
            d[i][j] = sqrtf(dx * dx + dy * dy);
        }
    for (int32_t i = 0; i < m; i++) {
        if (n == 1) {
            best = d[0][i] < best ? d[0][i] : best;
            continue;
        }
        for (int32_t j = 0; j < m; j++) {
            if (i == j)
                continue;
            const float two = d[0][i] + d[1][j];
            const float sum = n == 2 ? two : two + d[2][3 - i - j];
            best = sum < best ? sum : best;
        }
    }
    return best;
}

/* Eq. (5) of few edges, as tz_match_edges has it. */
static float edges_few(const edge_table *t, const tz_curve_sample *p,
                       const tz_curve_sample *q, float beta)
{
    const float *px = t->ox + p->link, *py = t->oy + p->link;
    const float *qx = t->ix + q->link, *qy = t->iy + q->link;
    const int32_t n = p->links, m = q->links;
    if (n == 0 || m == 0)
        return n == 0 ? 0 : beta * (float)n;
    return n <= m ? try_few(px, py, n, qx, qy, m) + beta * (float)(m - n)
                  : try_few(qx, qy, m, px, py, n) + beta * (float)(n - m);
}

static tz_status fill_edges(tz_ctx *ctx, void *arg, int64_t row, int worker)
{
    const edge_table *t = arg;
    const tz_matcher *m = t->m;
    const tz_curve_sample *p = &m->o->sample.v[row];
    float *out = m->edges + (size_t)row * (size_t)m->i->sample.n;
    const float beta = (float)m->i->spacing, gamma = (float)m->params.gamma;
    (void)ctx, (void)worker;
    for (int32_t j = 0; j < m->i->sample.n; j++) {
        const tz_curve_sample *q = &m->i->sample.v[j];
        float e =
            p->links <= 3 && q->links <= 3
                ? edges_few(t, p, q, beta)
                : (float)tz_match_edges(m->o, (int32_t)row, m->i, j, m->i->spacing, NULL);
        if (m->params.cut && m->params.cut[j] && p->links > q->links)
            e -= beta * (float)(p->links - q->links);
        out[j] = gamma * e;
    }
    return TZ_OK;
}

static tz_status make_table(tz_ctx *ctx, tz_matcher *m)
{
    const size_t pairs = (size_t)m->o->sample.n * (size_t)m->i->sample.n;
    edge_table t = {.m = m};
    if (pairs * sizeof *m->edges > TABLE_MOST)
        return TZ_OK;
    tz_status s = flatten_edges(ctx, m->o, &t.ox, &t.oy);
    if (s == TZ_OK)
        s = flatten_edges(ctx, m->i, &t.ix, &t.iy);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &m->edges, pairs, sizeof *m->edges);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, m->o->sample.n, fill_edges, &t);
    tz_free(ctx, t.ox);
    tz_free(ctx, t.oy);
    tz_free(ctx, t.ix);
    tz_free(ctx, t.iy);
    return s;
}

/* Offsets into the frames of their centres. */
static void turn_hoods(const tz_sample_graph *g, tz_match_hoods *h)
{
    for (int32_t i = 0; i < h->n && g->domain.frames; i++) {
        const tz_vec2 p = g->sample.v[i].at;
        const double a = tz_domain_frame(&g->domain, (tz_vec3){p.x, p.y, 0});
        const float c = (float)cos(a), s = (float)sin(a);
        for (int32_t k = h->first[i]; k < h->first[i + 1]; k++) {
            const float x = h->x[k], y = h->y[k];
            h->x[k] = c * x + s * y;
            h->y[k] = c * y - s * x;
        }
    }
}

/* Mean distance of the exemplar's element samples to their nearest. */
static double element_spacing(const tz_sample_graph *g, const tz_match_hoods *h)
{
    double sum = 0;
    int32_t n = 0;
    for (int32_t i = 0; i < g->sample.n; i++) {
        if (g->sample.v[i].q == TZ_SAMPLE_CURVE)
            continue;
        for (int32_t k = h->first[i]; k < h->first[i + 1]; k++)
            if (g->sample.v[h->id[k]].q != TZ_SAMPLE_CURVE) {
                sum += hypot((double)h->x[k], (double)h->y[k]);
                n++;
                break;
            }
    }
    return n > 0 ? sum / n : g->spacing;
}

static tz_status fill_exits(tz_matcher *m)
{
    const double apart = element_spacing(m->i, &m->hi);
    const tz_status s =
        tz_alloc(m->ctx, &m->exit, (size_t)m->o->sample.n, sizeof *m->exit);
    if (s != TZ_OK)
        return s;
    for (int32_t k = 0; k < m->o->sample.n; k++) {
        const tz_curve_sample *p = &m->o->sample.v[k];
        const double c = p->q == TZ_SAMPLE_CURVE
                             ? fmin(2, 1.2 + 0.4 * p->links) * m->i->spacing
                             : 1.5 * apart;
        const double hard = 8 * m->i->radius; /* more than any match */
        m->exit[k] = p->fixed ? INFINITY : (float)(m->params.hard ? hard : c);
        m->mixed = m->mixed || p->q != TZ_SAMPLE_CURVE;
    }
    for (int32_t k = 0; k < m->i->sample.n; k++)
        m->mixed = m->mixed || m->i->sample.v[k].q != TZ_SAMPLE_CURVE;
    return TZ_OK;
}

/* Neighbours come nearest first, so those well inside are the first ones. */
static tz_status count_inner(tz_matcher *m)
{
    const tz_match_hoods *h = &m->hi;
    const double r = INSIDE * m->i->radius;
    const tz_status s = tz_alloc(m->ctx, &m->inner, (size_t)h->n, sizeof *m->inner);
    for (int32_t i = 0; i < h->n && s == TZ_OK; i++) {
        int32_t k = h->first[i];
        while (k < h->first[i + 1] && hypot((double)h->x[k], (double)h->y[k]) <= r)
            k++;
        m->inner[i] = k - h->first[i];
    }
    return s;
}

void tz_matcher_deinit(tz_matcher *m)
{
    tz_match_hoods_deinit(&m->ho);
    tz_match_hoods_deinit(&m->hi);
    tz_free(m->ctx, m->inner);
    tz_free(m->ctx, m->exit);
    tz_free(m->ctx, m->edges);
    memset(m, 0, sizeof *m);
}

tz_status tz_matcher_init(tz_ctx *ctx, const tz_sample_graph *o, const tz_sample_graph *i,
                          const tz_match_params *params, tz_matcher *m)
{
    tz_matcher out = {.ctx = ctx,
                      .o = o,
                      .i = i,
                      .params = params ? *params : tz_match_params_default()};
    memset(m, 0, sizeof *m);
    if (i->sample.n == 0)
        return tz_fail(ctx, TZ_INVALID, "the exemplar has no samples to match with");
    tz_status s = tz_match_hoods_make(ctx, o, i->radius, &out.ho);
    if (s == TZ_OK)
        s = tz_match_hoods_make(ctx, i, i->radius * out.params.more, &out.hi);
    if (s == TZ_OK)
        s = count_inner(&out);
    if (s == TZ_OK)
        s = fill_exits(&out);
    if (s == TZ_OK) {
        turn_hoods(o, &out.ho);
        s = make_table(ctx, &out);
    }
    if (s == TZ_OK)
        *m = out;
    else
        tz_matcher_deinit(&out);
    return s;
}

/* ---- a match ----------------------------------------------------------------------- */

static float attribute_cost(const tz_matcher *m, int32_t so, int32_t si)
{
    if (m->edges)
        return m->edges[(size_t)so * (size_t)m->i->sample.n + (size_t)si];
    double e = tz_match_edges(m->o, so, m->i, si, m->i->spacing, NULL);
    const int32_t more = m->o->sample.v[so].links - m->i->sample.v[si].links;
    if (m->params.cut && m->params.cut[si] && more > 0)
        e -= m->i->spacing * more;
    return (float)(m->params.gamma * e);
}

/* Costs of one row and the least of them. */
static float fill_row(const tz_matcher *m, int32_t k, int32_t si, tz_assign *w,
                      int32_t row)
{
    const int32_t so = m->ho.id[k], first = m->hi.first[si], n = w->cols;
    const int32_t *id = m->hi.id + first;
    const float *hx = m->hi.x + first, *hy = m->hi.y + first;
    const float x = m->ho.x[k], y = m->ho.y[k];
    float *cost = w->cost[row], best = m->exit[so];
    for (int32_t j = 0; j < n; j++) {
        const float dx = hx[j] - x, dy = hy[j] - y;
        cost[j] = sqrtf(dx * dx + dy * dy);
    }
    if (m->edges) {
        const float *edges = m->edges + (size_t)so * (size_t)m->i->sample.n;
        for (int32_t j = 0; j < n; j++)
            cost[j] += edges[id[j]];
    } else {
        for (int32_t j = 0; j < n; j++)
            if (cost[j] < best) /* else it had better stay alone anyhow */
                cost[j] += attribute_cost(m, so, id[j]);
    }
    if (m->mixed)
        for (int32_t j = 0; j < n; j++)
            if (m->i->sample.v[id[j]].q != m->o->sample.v[so].q)
                cost[j] = INFINITY;
    for (int32_t j = 0; j < n; j++)
        best = cost[j] < best ? cost[j] : best;
    return best;
}

/* Samples well inside the exemplar's neighbourhood without a partner. */
static int32_t count_lacks(const tz_matcher *m, int32_t si, const tz_assign *w)
{
    int32_t n = m->inner[si];
    for (int32_t k = 0; k < w->rows; k++)
        n -= w->to[k] >= 0 && w->to[k] < m->inner[si];
    return n;
}

float tz_match(const tz_matcher *m, int32_t so, int32_t si, tz_assign *w, bool warm,
               float enough)
{
    const int32_t first = m->ho.first[so];
    if (m->o->sample.v[so].q != m->i->sample.v[si].q)
        return INFINITY;
    const float centre = attribute_cost(m, so, si);
    const float lack = (float)(m->params.lack * m->i->spacing);
    w->rows = m->ho.first[so + 1] - first;
    w->cols = m->hi.first[si + 1] - m->hi.first[si];
    const int32_t least = m->inner[si] > w->rows ? m->inner[si] - w->rows : 0;
    float bound = centre + lack * (float)least;
    for (int32_t k = 0; k < w->rows; k++) {
        w->exit[k] = m->exit[m->ho.id[first + k]];
        bound += fill_row(m, first + k, si, w, k);
        if (!(bound < enough))
            return INFINITY;
    }
    float cost = centre + tz_assign_solve(w, warm, enough - centre);
    if (cost < enough && lack > 0)
        cost += lack * (float)count_lacks(m, si, w);
    return cost < enough ? cost : INFINITY;
}
