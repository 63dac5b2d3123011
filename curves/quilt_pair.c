/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts of different patches that face each other over a seam are paired: by least cost
 * (distance, direction, pen) among all that compete. Cuts that compete make a group; where
 * a group falls into two sides that only pair across, the assignment is optimal, else
 * (three patches in one spot) the best pairs go first. */
#include <stdlib.h>
#include <string.h>

#include "curves/assign.h"
#include "curves/quilt_internal.h"

typedef struct link {
    float cost;
    int32_t a, b; /* cuts, a < b */
} link;

enum { ROUNDS = 3, BRIDGES = 2 };

typedef struct pairing {
    tz_ctx *ctx;
    const quilt_source *s;
    const quilt_map *m;
    quilt_runs *r;
    int round; /* from 1: each is less strict */
    TZ_ARRAY(link)
    link;
    int32_t *up; /* group of each cut */
    int8_t *colour;
} pairing;

static int32_t root(int32_t *up, int32_t i)
{
    while (up[i] != i) {
        up[i] = up[up[i]];
        i = up[i];
    }
    return i;
}

static bool pairs_at_all(const quilt_cut *c)
{
    return c->mate < 0 && c->other != QUILT_OUTSIDE;
}

/* Cost of pairing two cuts; INFINITY: never. A line's end alone costs 1. */
static float pair_cost(const pairing *q, const quilt_cut *a, const quilt_cut *b,
                       double reach)
{
    const tz_vec3 v = tz_domain_vector(q->m->domain, (tz_vec3){a->at.x, a->at.y, 0},
                                       (tz_vec3){b->at.x, b->at.y, 0});
    const double d = hypot(v.x, v.y), facing = -tz_vec2_dot(a->out, b->out);
    double cost = d / reach;
    if (!(d < reach) || facing < (q->round < 3 ? 0.5 : 0.25))
        return INFINITY;
    if (a->patch == b->patch) { /* only over a gap in the same line */
        if (a->run < 0 || b->run < 0 || abs(a->run - b->run) != 1 ||
            q->r->run.v[a->run].path != q->r->run.v[b->run].path || a->side == b->side ||
            !(d < 3 * q->m->cx))
            return INFINITY;
        cost += 0.3;
    } else if (a->other != b->patch && b->other != a->patch) {
        cost += 0.2;
    }
    const double turn = acos(fmin(1, facing)) / (TZ_PI / 3);
    cost = 0.7 * cost + 0.3 * turn * turn + (a->pen != b->pen ? 0.5 / q->round : 0);
    return cost < 1 ? (float)cost : INFINITY;
}

/* ---- bridges ------------------------------------------------------------------------- */

tz_bezier quilt_bridge(const tz_domain *d, const quilt_cut *a, const quilt_cut *b)
{
    const tz_vec3 v = tz_domain_vector(d, (tz_vec3){a->at.x, a->at.y, 0},
                                       (tz_vec3){b->at.x, b->at.y, 0});
    const tz_vec2 q = {a->at.x + v.x, a->at.y + v.y};
    const double n = hypot(v.x, v.y), facing = -tz_vec2_dot(a->out, b->out),
                 k = n * (0.5 - facing / 6); /* 1/3 ahead, 2/3 for a half circle */
    return (tz_bezier){{a->at, tz_vec2_add(a->at, tz_vec2_scale(a->out, k)),
                        tz_vec2_add(q, tz_vec2_scale(b->out, k)), q}};
}

/* Whether a line runs through cells that hold none, but for its ends. */
static bool is_free(const quilt_map *m, const tz_bezier *b)
{
    const double n = fmin(ceil(tz_bezier_length(b) / (m->cx / 2)), 512);
    for (int32_t i = 0; i <= n; i++) {
        tz_vec2 p = tz_bezier_at(b, i / fmax(n, 1));
        if (tz_vec2_length(tz_vec2_sub(p, b->p[0])) < 1.5 * m->cx ||
            tz_vec2_length(tz_vec2_sub(p, b->p[3])) < 1.5 * m->cx)
            continue;
        if (quilt_label(m, p) < 0)
            return false;
        if (m->domain->torus)
            p = (tz_vec2){tz_domain_wrap_axis(p.x, m->domain->size.x),
                          tz_domain_wrap_axis(p.y, m->domain->size.y)};
        const double x = fmin(floor(p.x / m->cx), m->nx - 1),
                     y = fmin(floor(p.y / m->cy), m->ny - 1);
        if (m->cell[(ptrdiff_t)y * m->nx + (ptrdiff_t)x].spot[0].pen)
            return false;
    }
    return true;
}

/* Cost of a bridge between two ends that are left; they may well belong to one patch and
 * look the same way: the line turns back then. */
static float bridge_cost(const pairing *q, const quilt_cut *a, const quilt_cut *b,
                         double reach)
{
    const tz_vec3 v = tz_domain_vector(q->m->domain, (tz_vec3){a->at.x, a->at.y, 0},
                                       (tz_vec3){b->at.x, b->at.y, 0});
    const double d = hypot(v.x, v.y);
    if (!(d < reach && d > 0) || a->run < 0 || b->run < 0 || a->run == b->run ||
        a->pen != b->pen)
        return INFINITY;
    const tz_vec2 to = {v.x / d, v.y / d};
    const double ahead = tz_vec2_dot(a->out, to), back = -tz_vec2_dot(b->out, to);
    if (ahead < -0.3 || back < -0.3)
        return INFINITY;
    const tz_bezier bridge = quilt_bridge(q->m->domain, a, b);
    const double cost = 0.5 * d / reach + 0.2 * (2 - ahead - back);
    return cost < 1 && is_free(q->m, &bridge) ? (float)cost : INFINITY;
}

/* Ends of lines that may be copied, an area: those at the exemplar's border are none. */
static double ends_of(const quilt_source *s)
{
    double n = 0;
    for (int32_t i = 0; i < s->set->node.n; i++) {
        const tz_vec2 p = s->set->node.v[i];
        n += s->degree[i] == 1 && p.x > s->lo.x + s->cell && p.y > s->lo.y + s->cell &&
             p.x < s->hi.x - s->cell && p.y < s->hi.y - s->cell;
    }
    return n / ((s->hi.x - s->lo.x) * (s->hi.y - s->lo.y));
}

/* What an end costs that stays loose, against 1 for one that is moved by half the lines'
 * distance: from 1, where one in four of the spacings squared has one, to 6. */
static double loose_cost(const quilt_source *s)
{
    const double ends = ends_of(s) * s->spacing * s->spacing;
    return fmax(1, fmin(6, 0.12 / fmax(ends, 1e-6)));
}

/* Whether more ends are left than a tenth of those that the exemplar would have. */
static bool too_many_ends(const pairing *q)
{
    double left = 0;
    for (int32_t i = 0; i < q->r->cut.n; i++)
        left += pairs_at_all(&q->r->cut.v[i]) && q->r->cut.v[i].run >= 0;
    return left > 0.1 * ends_of(q->s) * tz_domain_area(q->m->domain);
}

static tz_status find_links(pairing *q, double reach)
{
    enum { MOST = 128 };
    const quilt_runs *r = q->r;
    const tz_vec3 size = q->m->domain->size;
    int32_t near[MOST], id;
    tz_grid grid;
    tz_status st = tz_grid_init(q->ctx, &grid, (tz_vec2){0, 0}, (tz_vec2){size.x, size.y},
                                fmin(reach, fmin(size.x, size.y)), q->m->domain->torus);
    for (int32_t i = 0; i < r->cut.n && st == TZ_OK; i++)
        st = tz_grid_add(q->ctx, &grid, r->cut.v[i].at, &id);
    for (int32_t i = 0; i < r->cut.n && st == TZ_OK; i++) {
        if (!pairs_at_all(&r->cut.v[i]))
            continue;
        const int32_t n = tz_grid_query(&grid, r->cut.v[i].at, reach, near, MOST);
        for (int32_t k = 0; k < (n < MOST ? n : MOST) && st == TZ_OK; k++) {
            if (near[k] <= i || !pairs_at_all(&r->cut.v[near[k]]))
                continue;
            const quilt_cut *a = &r->cut.v[i], *b = &r->cut.v[near[k]];
            const float cost = q->round > ROUNDS ? bridge_cost(q, a, b, reach)
                                                 : pair_cost(q, a, b, reach);
            if (cost < INFINITY)
                st = tz_array_push(q->ctx, &q->link, ((link){cost, i, near[k]}));
        }
    }
    tz_grid_deinit(q->ctx, &grid);
    return st;
}

static void marry(const pairing *q, int32_t a, int32_t b)
{
    quilt_cut *v = q->r->cut.v;
    v[a].mate = b;
    v[b].mate = a;
    v[a].bridge = v[b].bridge = q->round > ROUNDS;
}

/* ---- groups ------------------------------------------------------------------------- */

static int by_group(const pairing *q, const link *a, const link *b)
{
    const int32_t ga = q->up[a->a], gb = q->up[b->a];
    if (ga != gb)
        return ga < gb ? -1 : 1;
    if (a->cost != b->cost)
        return a->cost < b->cost ? -1 : 1;
    if (a->a != b->a)
        return a->a < b->a ? -1 : 1;
    return (a->b > b->b) - (a->b < b->b);
}

/* Merge sort: stable and without a global for the comparison. */
static void sort_links(const pairing *q, link *v, link *scratch, int32_t n)
{
    for (int32_t w = 1; w<n; w = w> n / 2 ? n : 2 * w) {
        for (int32_t i = 0; i < n; i += 2 * w) {
            const int32_t mid = i + w < n ? i + w : n, end = mid + w < n ? mid + w : n;
            int32_t a = i, b = mid, o = i;
            while (a < mid || b < end)
                scratch[o++] = b >= end || (a < mid && by_group(q, &v[a], &v[b]) <= 0)
                                   ? v[a++]
                                   : v[b++];
            if (end == n)
                break;
        }
        memcpy(v, scratch, (size_t)n * sizeof *v);
    }
}

/* Gives the cuts of a group's links colours 1 and 2 so that links join different ones.
 * False if that cannot be. */
static bool colour_group(pairing *q, const link *v, int32_t n)
{
    bool more = true;
    for (int32_t i = 0; i < n; i++)
        q->colour[v[i].a] = q->colour[v[i].b] = 0;
    q->colour[v[0].a] = 1;
    while (more) {
        more = false;
        for (int32_t i = 0; i < n; i++) {
            int8_t *a = &q->colour[v[i].a], *b = &q->colour[v[i].b];
            if (*a && *a == *b)
                return false;
            if (*a && !*b) {
                *b = (int8_t)(3 - *a);
                more = true;
            } else if (*b && !*a) {
                *a = (int8_t)(3 - *b);
                more = true;
            }
        }
    }
    return true;
}

static int32_t index_in(int32_t *list, int32_t *n, int32_t id)
{
    for (int32_t i = 0; i < *n; i++)
        if (list[i] == id)
            return i;
    if (*n == TZ_ASSIGN_MOST)
        return -1;
    list[*n] = id;
    return (*n)++;
}

static bool assign_group(pairing *q, const link *v, int32_t n, tz_assign *a)
{
    int32_t row[TZ_ASSIGN_MOST] = {0}, col[TZ_ASSIGN_MOST] = {0};
    if (n > 2048 || !colour_group(q, v, n))
        return false;
    a->rows = a->cols = 0;
    for (int32_t i = 0; i < n; i++) {
        const bool first = q->colour[v[i].a] == 1;
        if (index_in(row, &a->rows, first ? v[i].a : v[i].b) < 0 ||
            index_in(col, &a->cols, first ? v[i].b : v[i].a) < 0)
            return false;
    }
    for (int32_t i = 0; i < a->rows; i++) {
        a->exit[i] = 1;
        for (int32_t j = 0; j < a->cols; j++)
            a->cost[i][j] = INFINITY;
    }
    for (int32_t i = 0; i < n; i++) {
        const bool first = q->colour[v[i].a] == 1;
        a->cost[index_in(row, &a->rows, first ? v[i].a : v[i].b)]
               [index_in(col, &a->cols, first ? v[i].b : v[i].a)] = v[i].cost;
    }
    if (!(tz_assign_solve(a, false, INFINITY) < INFINITY))
        return false;
    for (int32_t i = 0; i < a->rows; i++)
        if (a->to[i] >= 0)
            marry(q, row[i], col[a->to[i]]);
    return true;
}

static tz_status solve(pairing *q)
{
    tz_assign *a = NULL;
    link *scratch = NULL;
    link *v = q->link.v;
    for (int32_t i = 0; i < q->r->cut.n; i++)
        q->up[i] = i;
    for (int32_t i = 0; i < q->link.n; i++) {
        const int32_t x = root(q->up, v[i].a), y = root(q->up, v[i].b);
        q->up[x > y ? x : y] = x > y ? y : x;
    }
    for (int32_t i = 0; i < q->r->cut.n; i++)
        q->up[i] = root(q->up, i);
    tz_status st = tz_alloc_zero(q->ctx, &a, 1, sizeof *a);
    if (st == TZ_OK)
        st = tz_alloc(q->ctx, &scratch, (size_t)q->link.n, sizeof *scratch);
    if (st == TZ_OK)
        sort_links(q, v, scratch, q->link.n);
    for (int32_t i = 0, j; i < q->link.n && st == TZ_OK; i = j) {
        for (j = i + 1; j < q->link.n && q->up[v[j].a] == q->up[v[i].a];)
            j++;
        if (assign_group(q, v + i, j - i, a))
            continue;
        for (int32_t k = i; k < j; k++)
            if (q->r->cut.v[v[k].a].mate < 0 && q->r->cut.v[v[k].b].mate < 0)
                marry(q, v[k].a, v[k].b);
    }
    tz_free(q->ctx, a);
    tz_free(q->ctx, scratch);
    return st;
}

/* ---- where pairs meet ---------------------------------------------------------------- */

static double between(tz_vec2 a, tz_vec2 b)
{
    return atan2(a.x * b.y - a.y * b.x, tz_vec2_dot(a, b));
}

static void settle(const pairing *q)
{
    for (int32_t i = 0; i < q->r->cut.n; i++) {
        quilt_cut *a = &q->r->cut.v[i];
        a->to = a->at;
        a->turn = a->widen = 0;
        if (a->mate < 0 || a->bridge)
            continue;
        const quilt_cut *b = &q->r->cut.v[a->mate];
        const tz_vec3 v = tz_domain_vector(q->m->domain, (tz_vec3){a->at.x, a->at.y, 0},
                                           (tz_vec3){b->at.x, b->at.y, 0});
        const double k = a->fixed ? 0 : b->fixed ? 1 : 0.5;
        const tz_vec2 t = a->fixed   ? a->out
                          : b->fixed ? tz_vec2_scale(b->out, -1)
                                     : tz_vec2_sub(a->out, b->out);
        a->to = (tz_vec2){a->at.x + k * v.x, a->at.y + k * v.y};
        a->turn = between(a->out, t);
        if (q->s->set->taper.n && a->width > 0 && b->width > 0)
            a->widen = k * log(b->width / a->width);
    }
}

tz_status quilt_pair(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                     quilt_runs *r, tz_curve_quilt_report *report)
{
    pairing q = {.ctx = ctx, .s = s, .m = m, .r = r};
    const double reach = fmax(3 * m->cx, 0.5 * s->spacing);
    tz_status st = tz_alloc(ctx, &q.up, (size_t)r->cut.n, sizeof *q.up);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &q.colour, (size_t)r->cut.n, sizeof *q.colour);
    if (st == TZ_OK)
        st = quilt_order(ctx, s, m, r, loose_cost(s));
    for (int round = 1; round <= ROUNDS + BRIDGES && st == TZ_OK; round++) {
        if (round == ROUNDS + 1 && !too_many_ends(&q))
            break;
        q.link.n = 0;
        q.round = round;
        st = find_links(&q, (round <= ROUNDS ? round : 2 * round - ROUNDS) * reach);
        if (st == TZ_OK)
            st = solve(&q);
    }
    if (st == TZ_OK) {
        settle(&q);
        for (int32_t i = 0; i < r->cut.n; i++) {
            report->crossings += r->cut.v[i].other != QUILT_OUTSIDE;
            report->joined += r->cut.v[i].mate >= 0;
        }
    }
    tz_array_free(ctx, &q.link);
    tz_free(ctx, q.up);
    tz_free(ctx, q.colour);
    return st;
}
