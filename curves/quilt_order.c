/* SPDX-License-Identifier: Apache-2.0 */
/* Pairing that keeps the order of lines: along a seam between two patches stand the ends of
 * lines of both, a_1 a_2 .. and b_1 b_2 .. ; c(i, j) = the least cost to settle the first i
 * and j of them,
 *
 *   c(i, j) = min  c(i-1, j-1) + meet(a_i, b_j)     they meet, the seam is warped there
 *                  c(i-2, j) + turn(a_i-1, a_i)     a line turns back into its neighbour
 *                  c(i, j-2) + turn(b_j-1, b_j)
 *                  c(i-1, j) + loose, c(i, j-1) + loose
 *
 * so that nothing that joins them crosses. An end that stays loose costs the more the fewer
 * ends the exemplar has: without any, many lines are rather shifted by one each. */
#include <stdlib.h>
#include <string.h>

#include "curves/quilt_internal.h"

enum { SEAM_MOST = 512 }; /* ends on one side of a seam that are settled at once */

typedef struct stand {
    int32_t seam, cut;
    bool b; /* on the side of the higher label */
    double at;
} stand;

typedef struct order {
    tz_ctx *ctx;
    const quilt_source *s;
    const quilt_map *m;
    quilt_runs *r;
    double loose;  /* cost of an end that meets nothing */
    int32_t *seam; /* per step between cells: its seam, or -1 */
    int32_t *at;   /* 2 (place along it) + 1 if it is run through backwards */
    int32_t seams;
    TZ_ARRAY(stand)
    stand;
    float *cost;
    uint8_t *move;
} order;

/* ---- seams --------------------------------------------------------------------------- */

static int32_t wrapped(int32_t i, int32_t n) { return ((i % n) + n) % n; }

static int32_t label_at(const quilt_map *m, int32_t x, int32_t y)
{
    if (m->domain->torus) {
        x = wrapped(x, m->nx);
        y = wrapped(y, m->ny);
    } else if (x < 0 || y < 0 || x >= m->nx || y >= m->ny) {
        return QUILT_OUTSIDE;
    }
    return m->label[(ptrdiff_t)y * m->nx + x];
}

/* Step to the right of a cell (0) or below it (1); -1 = no seam between patches. */
static ptrdiff_t step_of(const quilt_map *m, int32_t x, int32_t y, int below)
{
    const int32_t p = label_at(m, x, y), q = label_at(m, x + !below, y + below);
    if (p < 0 || q < 0 || p == q)
        return -1;
    if (m->domain->torus) {
        x = wrapped(x, m->nx);
        y = wrapped(y, m->ny);
    }
    return 2 * ((ptrdiff_t)y * m->nx + x) + below;
}

static void labels_of(const quilt_map *m, ptrdiff_t step, int32_t label[2])
{
    const int32_t x = (int32_t)(step / 2 % m->nx), y = (int32_t)(step / 2 / m->nx),
                  below = step % 2;
    const int32_t p = label_at(m, x, y), q = label_at(m, x + !below, y + below);
    label[0] = p < q ? p : q;
    label[1] = p < q ? q : p;
}

/* The step that goes on from one at its far (or near) corner, if just one does, between
 * the same patches. */
static ptrdiff_t onward(const quilt_map *m, ptrdiff_t step, bool far, bool *back)
{
    const int32_t x = (int32_t)(step / 2 % m->nx), y = (int32_t)(step / 2 / m->nx),
                  below = step % 2;
    /* corner: lower right of the cell, or where the step begins */
    const int32_t cx = x + (below && !far ? 0 : 1), cy = y + (!below && !far ? 0 : 1);
    /* left, right, up, down of the corner: cells whose steps they are */
    const ptrdiff_t around[4] = {step_of(m, cx - 1, cy - 1, 1), step_of(m, cx, cy - 1, 1),
                                 step_of(m, cx - 1, cy - 1, 0),
                                 step_of(m, cx - 1, cy, 0)};
    ptrdiff_t next = -1;
    int32_t own[2], other[2];
    int n = 0;
    for (int k = 0; k < 4; k++) {
        n += around[k] >= 0;
        if (around[k] >= 0 && around[k] != step) {
            next = around[k];
            *back = k == 0 || k == 2; /* it ends here: run through backwards */
        }
    }
    if (n != 2 || next < 0)
        return -1;
    labels_of(m, step, own);
    labels_of(m, next, other);
    return own[0] == other[0] && own[1] == other[1] ? next : -1;
}

static void trace(order *o, ptrdiff_t first)
{
    const ptrdiff_t most = 2 * (ptrdiff_t)o->m->nx * o->m->ny;
    ptrdiff_t at = first;
    bool back = false, turned = false;
    /* to where the seam begins, or once around */
    for (ptrdiff_t k = 0; k < most; k++) {
        const ptrdiff_t next = onward(o->m, at, back, &turned);
        if (next < 0 || next == first)
            break;
        at = next;
        back = !turned;
    }
    /* and along it */
    for (int32_t k = 0; at >= 0 && o->seam[at] < 0; k++) {
        o->seam[at] = o->seams;
        o->at[at] = 2 * k + back;
        at = onward(o->m, at, !back, &turned);
        back = turned;
    }
    o->seams++;
}

static void trace_all(order *o)
{
    const ptrdiff_t n = 2 * (ptrdiff_t)o->m->nx * o->m->ny;
    memset(o->seam, -1, (size_t)n * sizeof *o->seam);
    for (ptrdiff_t i = 0; i < n; i++) {
        const ptrdiff_t cell = i / 2;
        const int32_t x = (int32_t)(cell % o->m->nx), y = (int32_t)(cell / o->m->nx);
        if (step_of(o->m, x, y, (int)(i % 2)) >= 0 && o->seam[i] < 0)
            trace(o, i);
    }
}

/* ---- where ends stand ----------------------------------------------------------------- */

static tz_status add_stand(order *o, int32_t cut)
{
    const quilt_cut *c = &o->r->cut.v[cut];
    const double x = c->at.x / o->m->cx, y = c->at.y / o->m->cy, dx = fabs(x - round(x)),
                 dy = fabs(y - round(y));
    if (c->run < 0 || c->mate >= 0 || c->other < 0 || o->r->run.v[c->run].gone)
        return TZ_OK;
    for (int k = 0; k < 2; k++) {
        const int below = (dy < dx) != (k == 1);
        const ptrdiff_t step =
            below ? step_of(o->m, (int32_t)floor(x), (int32_t)round(y) - 1, 1)
                  : step_of(o->m, (int32_t)round(x) - 1, (int32_t)floor(y), 0);
        int32_t label[2];
        if (step < 0)
            continue;
        labels_of(o->m, step, label);
        const bool b = label[1] == c->patch;
        if (label[b] != c->patch || label[!b] != c->other || o->seam[step] < 0)
            continue;
        const double f = below ? x - floor(x) : y - floor(y);
        const int32_t at = o->at[step];
        return tz_array_push(o->ctx, &o->stand,
                             ((stand){.seam = o->seam[step],
                                      .cut = cut,
                                      .b = b,
                                      .at = at / 2 + (at % 2 ? 1 - f : f)}));
    }
    return TZ_OK;
}

static int along(const void *a, const void *b)
{
    const stand *p = a, *q = b;
    if (p->seam != q->seam)
        return p->seam < q->seam ? -1 : 1;
    if (p->b != q->b)
        return p->b ? 1 : -1;
    if (p->at != q->at)
        return p->at < q->at ? -1 : 1;
    return (p->cut > q->cut) - (p->cut < q->cut);
}

/* ---- costs ---------------------------------------------------------------------------- */

static double meet_cost(const order *o, const quilt_cut *a, const quilt_cut *b)
{
    const tz_vec3 v = tz_domain_vector(o->m->domain, (tz_vec3){a->at.x, a->at.y, 0},
                                       (tz_vec3){b->at.x, b->at.y, 0});
    const double d = hypot(v.x, v.y) / fmax(3 * o->m->cx, 0.5 * o->s->spacing),
                 facing = -tz_vec2_dot(a->out, b->out);
    if (facing < 0.1 || d > 8)
        return INFINITY;
    const double turn = acos(fmin(1, facing)) / (TZ_PI / 3);
    return 0.7 * d + 0.3 * turn * turn + (a->pen != b->pen ? 0.6 : 0);
}

/* Whether a line is straight where it is cut: such do not turn back. */
static bool straight(const order *o, const quilt_cut *c)
{
    const quilt_run *r = &o->r->run.v[c->run];
    if (r->parts == 0)
        return false;
    const int32_t part = c->side ? r->part + r->parts - 1 : r->part;
    return o->s->set->piece.v[o->r->part.v[part].piece].straight;
}

static double turn_cost(const order *o, const quilt_cut *a, const quilt_cut *b)
{
    const tz_vec3 v = tz_domain_vector(o->m->domain, (tz_vec3){a->at.x, a->at.y, 0},
                                       (tz_vec3){b->at.x, b->at.y, 0});
    const double d = hypot(v.x, v.y);
    const quilt_run *r = o->r->run.v;
    if (straight(o, a) && straight(o, b))
        return INFINITY;
    if (abs(a->run - b->run) == 1 && r[a->run].path == r[b->run].path &&
        a->side != b->side && d < 3 * o->m->cx)
        return 0.3; /* a line that leaves its patch for a step or two */
    if (a->pen != b->pen || a->run == b->run || !(d > 0) || d > 3 * o->s->spacing)
        return INFINITY;
    const tz_vec2 to = {v.x / d, v.y / d};
    const double ahead = tz_vec2_dot(a->out, to), back = -tz_vec2_dot(b->out, to);
    if (ahead < -0.5 || back < -0.5)
        return INFINITY;
    return 1.2 + 0.5 * d / o->s->spacing + 0.4 * (1 - 0.5 * (ahead + back));
}

/* ---- one seam ------------------------------------------------------------------------- */

enum { MEET = 1, TURN_A, TURN_B, LOOSE_A, LOOSE_B };

static void marry(quilt_runs *r, int32_t a, int32_t b, bool bridge)
{
    r->cut.v[a].mate = b;
    r->cut.v[b].mate = a;
    r->cut.v[a].bridge = r->cut.v[b].bridge = bridge;
}

static void settle_seam(order *o, const stand *a, int32_t na, const stand *b, int32_t nb)
{
    const quilt_cut *c = o->r->cut.v;
    const int32_t w = nb + 1;
    for (int32_t i = 0; i <= na; i++)
        for (int32_t j = 0; j <= nb; j++) {
            double best = i + j == 0 ? 0 : INFINITY;
            uint8_t move = 0;
            const double cost[6] = {
                INFINITY,
                i && j ? (double)o->cost[(i - 1) * w + j - 1] +
                             meet_cost(o, &c[a[i - 1].cut], &c[b[j - 1].cut])
                       : INFINITY,
                i > 1 ? (double)o->cost[(i - 2) * w + j] +
                            turn_cost(o, &c[a[i - 2].cut], &c[a[i - 1].cut])
                      : INFINITY,
                j > 1 ? (double)o->cost[i * w + j - 2] +
                            turn_cost(o, &c[b[j - 2].cut], &c[b[j - 1].cut])
                      : INFINITY,
                i ? (double)o->cost[(i - 1) * w + j] + o->loose : INFINITY,
                j ? (double)o->cost[i * w + j - 1] + o->loose : INFINITY};
            for (uint8_t k = 1; k < 6; k++)
                if (cost[k] < best) {
                    best = cost[k];
                    move = k;
                }
            o->cost[i * w + j] = (float)best;
            o->move[i * w + j] = move;
        }
    for (int32_t i = na, j = nb; i + j > 0;) {
        switch (o->move[i * w + j]) {
        case MEET: marry(o->r, a[--i].cut, b[--j].cut, false); break;
        case TURN_A:
            i -= 2;
            marry(o->r, a[i].cut, a[i + 1].cut, true);
            break;
        case TURN_B:
            j -= 2;
            marry(o->r, b[j].cut, b[j + 1].cut, true);
            break;
        case LOOSE_A: i--; break;
        default: j--;
        }
    }
}

tz_status quilt_order(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                      quilt_runs *r, double loose)
{
    order o = {.ctx = ctx, .s = s, .m = m, .r = r, .loose = loose};
    const size_t steps = 2 * (size_t)m->nx * (size_t)m->ny,
                 room = (size_t)(SEAM_MOST + 1) * (SEAM_MOST + 1);
    tz_status st = tz_alloc(ctx, &o.seam, steps, sizeof *o.seam);
    if (st == TZ_OK)
        st = tz_alloc_zero(ctx, &o.at, steps, sizeof *o.at);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &o.cost, room, sizeof *o.cost);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &o.move, room, 1);
    if (st == TZ_OK)
        trace_all(&o);
    for (int32_t i = 0; i < r->cut.n && st == TZ_OK; i++)
        st = add_stand(&o, i);
    if (st == TZ_OK && o.stand.n > 1)
        qsort(o.stand.v, (size_t)o.stand.n, sizeof *o.stand.v, along);
    for (int32_t i = 0, j; i < o.stand.n && st == TZ_OK; i = j) {
        int32_t mid = i;
        for (j = i; j < o.stand.n && o.stand.v[j].seam == o.stand.v[i].seam; j++)
            mid += !o.stand.v[j].b;
        if (mid - i <= SEAM_MOST && j - mid <= SEAM_MOST)
            settle_seam(&o, o.stand.v + i, mid - i, o.stand.v + mid, j - mid);
        if (tz_ctx_cancelled(ctx))
            st = TZ_CANCELLED;
    }
    tz_free(ctx, o.seam);
    tz_free(ctx, o.at);
    tz_free(ctx, o.cost);
    tz_free(ctx, o.move);
    tz_array_free(ctx, &o.stand);
    return st;
}
