/* SPDX-License-Identifier: Apache-2.0 */
/* Foretold strokes meet what is drawn. Loose ends of the drawing at the region and loose
 * ends of what is foretold are paired, the best pair first, by the way between them and
 * how straight a line would run on; then the foretold end is moved onto the drawn one, and
 * the strokes behind it follow, less and less:
 *
 *   node at arc length s from the end moves by  (1 - s / W)^2 (1 + 2 s / W)  of that way
 *
 * What is left over and points at a line near ahead is drawn on to it. */
#include <stdlib.h>
#include <string.h>

#include "curves/curve_edit.h"
#include "curves/predict_internal.h"

#define REACH  1.1 /* of the distance from line to line: farthest pair */
#define WITHIN 3.0 /* as much dearer are pairs of foretold ends */
#define AHEAD  0.8 /* of it: farthest that an end is drawn on */
#define FOLLOW 2.5 /* of it: W */

/** A loose end. */
typedef struct loose {
    tz_vec2 at, out; /* place; unit direction in which it would run on */
    int32_t node, piece, pen;
    bool first; /* it is the beginning of its path */
    bool paired;
} loose;

/** The second moves onto the first, which is drawn, or foretold too. */
typedef struct pair {
    int32_t to, from;
    bool drawn;
    double cost;
} pair;

typedef TZ_ARRAY(loose)
loose_list;

typedef struct joiner {
    tz_ctx *ctx;
    const tz_curve_set *drawing;
    tz_curve_set *set;
    const tz_region *to;
    double spacing;
    loose_list drawn, foretold;
    TZ_ARRAY(pair)
    pair;
} joiner;

static tz_vec2 unit(tz_vec2 v)
{
    const double n = tz_vec2_length(v);
    return n > 0 ? tz_vec2_scale(v, 1 / n) : (tz_vec2){0, 0};
}

/** Ends of paths that nothing else meets, not farther than `beyond` outside the region. */
static tz_status find_loose(const joiner *j, const tz_curve_set *s, double beyond,
                            loose_list *list)
{
    int32_t *uses = NULL;
    tz_status st = tz_alloc_zero(j->ctx, &uses, (size_t)s->node.n, sizeof *uses);
    for (int32_t i = 0; i < s->piece.n && st == TZ_OK; i++) {
        uses[s->piece.v[i].from]++;
        uses[s->piece.v[i].to]++;
    }
    for (int32_t p = 0; p < s->path.n; p++)
        for (int k = 0; k < 2 && st == TZ_OK; k++) {
            const tz_curve_path *path = &s->path.v[p];
            const int32_t piece = path->piece + (k ? path->pieces - 1 : 0);
            const tz_curve_piece *q = &s->piece.v[piece];
            const tz_bezier c = tz_curve_bezier(s, q);
            loose e = {.node = k ? q->to : q->from,
                       .piece = piece,
                       .pen = path->pen,
                       .first = k == 0};
            e.at = s->node.v[e.node];
            if (uses[e.node] != 1 ||
                tz_region_distance(j->to, (tz_vec3){e.at.x, e.at.y, 0}) < -beyond)
                continue;
            const double t = k ? 1 : 0, in = k ? 0.9 : 0.1;
            e.out = unit(tz_vec2_sub(tz_bezier_at(&c, t), tz_bezier_at(&c, in)));
            st = tz_array_push(j->ctx, list, e);
        }
    tz_free(j->ctx, uses);
    return st;
}

/** How badly two ends go together; INFINITY: not at all. Sideways counts double; ends that
 * have run past each other are as near as ones that have not met. */
static double cost_of(const joiner *j, const loose *a, const tz_curve_pen *p,
                      const loose *b)
{
    const tz_vec2 v =
        tz_vec2_sub(tz_curve_copy(&j->drawing->domain, b->at, a->at), a->at);
    const double along = tz_vec2_dot(v, a->out),
                 side = fabs(v.x * a->out.y - v.y * a->out.x),
                 straight = -tz_vec2_dot(a->out, b->out);
    const double reach = REACH * j->spacing;
    if (tz_vec2_length(v) > reach || straight < 0.3 || side > 0.6 * reach)
        return INFINITY;
    const tz_curve_pen *q = &j->set->pen.v[b->pen];
    const double pens = p->color != q->color || p->width != q->width ? reach : 0;
    return fabs(along) + 2 * side + (1 - straight) * j->spacing + pens;
}

static int by_cost(const void *p, const void *q)
{
    const pair *a = p, *b = q;
    if (a->cost != b->cost)
        return a->cost < b->cost ? -1 : 1;
    if (a->drawn != b->drawn)
        return a->drawn ? -1 : 1;
    return a->to != b->to ? a->to - b->to : a->from - b->from;
}

static tz_status find_pairs(joiner *j)
{
    tz_status s = TZ_OK;
    for (int32_t b = 0; b < j->foretold.n; b++) {
        for (int32_t a = 0; a < j->drawn.n && s == TZ_OK; a++) {
            const loose *e = &j->drawn.v[a];
            const pair p = {a, b, true,
                            cost_of(j, e, &j->drawing->pen.v[e->pen], &j->foretold.v[b])};
            if (p.cost < INFINITY)
                s = tz_array_push(j->ctx, &j->pair, p);
        }
        for (int32_t a = 0; a < b && s == TZ_OK; a++) {
            const loose *e = &j->foretold.v[a];
            const pair p = {a, b, false,
                            WITHIN *
                                cost_of(j, e, &j->set->pen.v[e->pen], &j->foretold.v[b])};
            if (e->node != j->foretold.v[b].node && p.cost < INFINITY)
                s = tz_array_push(j->ctx, &j->pair, p);
        }
    }
    if (s == TZ_OK && j->pair.n > 0)
        qsort(j->pair.v, (size_t)j->pair.n, sizeof *j->pair.v, by_cost);
    return s;
}

static loose *first_of(joiner *j, const pair *p)
{
    return p->drawn ? &j->drawn.v[p->to] : &j->foretold.v[p->to];
}

/** Moves an end of a path, and the path behind it as far as it follows. */
static void add_moves(const joiner *j, const loose *e, tz_vec2 by, tz_vec2 *move)
{
    const tz_curve_set *s = j->set;
    const double w = fmax(FOLLOW * j->spacing, 3 * tz_vec2_length(by));
    double way = 0;
    int32_t p = e->piece, end = 0;
    for (int32_t i = 0; i < s->path.n; i++) /* of the path that the piece is in */
        if (p >= s->path.v[i].piece && p < s->path.v[i].piece + s->path.v[i].pieces)
            end = e->first ? s->path.v[i].piece + s->path.v[i].pieces
                           : s->path.v[i].piece - 1;
    move[e->node] = tz_vec2_add(move[e->node], by);
    for (; p != end && way < w; p += e->first ? 1 : -1) {
        const tz_curve_piece *q = &s->piece.v[p];
        const tz_bezier c = tz_curve_bezier(s, q);
        const int32_t node = e->first ? q->to : q->from;
        way += tz_bezier_length(&c);
        const double t = way / w, part = t < 1 ? (1 - t) * (1 - t) * (1 + 2 * t) : 0;
        move[node] = tz_vec2_add(move[node], tz_vec2_scale(by, part));
    }
}

static void apply_moves(joiner *j, const tz_vec2 *move)
{
    tz_curve_set *s = j->set;
    for (int32_t i = 0; i < s->node.n; i++)
        s->node.v[i] = tz_vec2_add(s->node.v[i], move[i]);
    for (int32_t i = 0; i < s->piece.n; i++) {
        tz_curve_piece *q = &s->piece.v[i];
        q->a = tz_vec2_add(q->a, move[q->from]);
        q->b = tz_vec2_add(q->b, move[q->to]);
        if (!q->straight)
            continue;
        const tz_bezier line =
            tz_bezier_line(s->node.v[q->from], tz_curve_piece_end(s, q));
        q->a = line.p[1];
        q->b = line.p[2];
    }
}

/** The joined ends go on in one direction, if the stroke is curved. */
static void align(joiner *j, const loose *a, const loose *b)
{
    tz_curve_set *s = j->set;
    tz_curve_piece *q = &s->piece.v[b->piece];
    const tz_vec2 at = s->node.v[b->node];
    if (q->straight)
        return;
    if (b->first) {
        const double n = tz_vec2_length(tz_vec2_sub(q->a, at));
        q->a = tz_vec2_add(at, tz_vec2_scale(a->out, n));
    } else {
        const tz_vec2 end = tz_curve_piece_end(s, q);
        const double n = tz_vec2_length(tz_vec2_sub(q->b, end));
        q->b = tz_vec2_add(end, tz_vec2_scale(a->out, n));
    }
}

/** Where the first end of a pair lies by now. */
static tz_vec2 place_of(joiner *j, const pair *p)
{
    const loose *a = first_of(j, p);
    return p->drawn ? a->at : j->set->node.v[a->node];
}

/** Two foretold ends become one node; the other one is dropped. */
static tz_status merge(joiner *j)
{
    tz_curve_set *s = j->set, next;
    bool any = false;
    for (int32_t i = 0; i < j->pair.n; i++) {
        const pair *p = &j->pair.v[i];
        const loose *b = &j->foretold.v[p->from];
        if (p->drawn || !(p->cost < INFINITY))
            continue;
        tz_curve_piece *q = &s->piece.v[b->piece];
        *(b->first ? &q->from : &q->to) = first_of(j, p)->node;
        any = true;
    }
    if (!any)
        return TZ_OK;
    const tz_status st =
        tz_curve_choose(j->ctx, s, NULL, NULL, NULL, (tz_vec2){0, 0}, &next);
    if (st == TZ_OK) {
        tz_curve_set_deinit(s);
        *s = next;
    }
    return st;
}

static tz_status join_pairs(joiner *j)
{
    tz_vec2 *move = NULL;
    tz_status s = tz_alloc_zero(j->ctx, &move, (size_t)j->set->node.n, sizeof *move);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < j->pair.n; i++) {
        pair *p = &j->pair.v[i];
        loose *a = first_of(j, p), *b = &j->foretold.v[p->from];
        if (a->paired || b->paired) {
            p->cost = INFINITY;
            continue;
        }
        a->paired = b->paired = true;
        add_moves(j, b, tz_vec2_sub(tz_curve_copy(&j->set->domain, a->at, b->at), b->at),
                  move);
    }
    /* a node between two moved ends has moved for both: each end is put right again */
    apply_moves(j, move);
    memset(move, 0, (size_t)j->set->node.n * sizeof *move);
    for (int32_t i = 0; i < j->pair.n; i++) {
        const pair *p = &j->pair.v[i];
        const loose *b = &j->foretold.v[p->from];
        const tz_vec2 now = j->set->node.v[b->node];
        if (p->cost < INFINITY)
            move[b->node] =
                tz_vec2_sub(tz_curve_copy(&j->set->domain, place_of(j, p), now), now);
    }
    apply_moves(j, move);
    for (int32_t i = 0; i < j->pair.n; i++)
        if (j->pair.v[i].cost < INFINITY)
            align(j, first_of(j, &j->pair.v[i]), &j->foretold.v[j->pair.v[i].from]);
    tz_free(j->ctx, move);
    return s;
}

/* ---- what is left over ----------------------------------------------------------------
 */

/** Where the ray from an end meets a piece first: way along the ray, INFINITY = nowhere. */
static double hit(const tz_curve_set *s, int32_t piece, const loose *e, double far)
{
    enum { STEPS = 12 };
    const tz_bezier c = tz_curve_bezier(s, &s->piece.v[piece]);
    double best = INFINITY;
    tz_vec2 p = tz_vec2_sub(c.p[0], e->at);
    for (int k = 1; k <= STEPS; k++) {
        const tz_vec2 q = tz_vec2_sub(tz_bezier_at(&c, (double)k / STEPS), e->at);
        const double u = p.x * e->out.y - p.y * e->out.x,
                     v = q.x * e->out.y - q.y * e->out.x;
        if ((u < 0) != (v < 0)) {
            const double t = u / (u - v), way = (1 - t) * tz_vec2_dot(p, e->out) +
                                                t * tz_vec2_dot(q, e->out);
            if (way > 1e-6 * far && way < best && way <= far)
                best = way;
        }
        p = q;
    }
    return best;
}

/** Draws an end on to the nearest line ahead. */
static tz_status draw_on(joiner *j, const loose *e, bool foretold)
{
    tz_curve_set *s = j->set;
    const double far = AHEAD * j->spacing;
    const tz_curve_set *const among[2] = {j->drawing, s};
    double best = INFINITY;
    for (int k = 0; k < 2; k++)
        for (int32_t i = 0; i < among[k]->piece.n; i++)
            if (!((k == 1) == foretold && i == e->piece))
                best = fmin(best, hit(among[k], i, e, far));
    if (!(best < INFINITY))
        return TZ_OK;
    const tz_vec2 end = tz_vec2_add(e->at, tz_vec2_scale(e->out, best));
    const tz_curve_pen pen = foretold ? s->pen.v[e->pen] : j->drawing->pen.v[e->pen];
    int32_t id, from = e->node, to;
    tz_status st = tz_curve_add_pen(s, pen, &id);
    if (st == TZ_OK && !foretold)
        st = tz_curve_add_node(s, e->at, &from);
    if (st == TZ_OK)
        st = tz_curve_add_node(s, end, &to);
    if (st == TZ_OK)
        st = tz_curve_begin(s, id);
    if (st != TZ_OK)
        return st;
    const tz_bezier line = tz_bezier_line(s->node.v[from], end);
    const tz_curve_piece q = {from, to, line.p[1], line.p[2], true};
    const tz_curve_carry carry = {.taper = {pen.width, pen.width},
                                  .origin = tz_curve_no_origin(),
                                  .has_taper = s->taper.n > 0,
                                  .has_origin = s->origin.n > 0};
    st = tz_curve_add_piece(s, &q, &carry);
    tz_curve_end(s, false);
    return st;
}

/** What the joints cost, in distances from line to line; an end left over costs two. */
static double loss_of(const joiner *j)
{
    double sum = 0;
    for (int32_t i = 0; i < j->pair.n; i++)
        sum += j->pair.v[i].cost < INFINITY ? j->pair.v[i].cost / j->spacing : 0;
    for (int32_t i = 0; i < j->drawn.n; i++)
        sum += j->drawn.v[i].paired ? 0 : 2;
    for (int32_t i = 0; i < j->foretold.n; i++)
        sum += j->foretold.v[i].paired ? 0 : 2;
    return sum;
}

tz_status tz_predict_join(tz_ctx *ctx, const tz_curve_set *drawing, const tz_region *to,
                          double spacing, tz_curve_set *set, double *loss)
{
    joiner j = {.ctx = ctx, .drawing = drawing, .set = set, .to = to, .spacing = spacing};
    tz_status s = find_loose(&j, drawing, spacing, &j.drawn);
    if (s == TZ_OK)
        s = find_loose(&j, set, spacing, &j.foretold);
    if (s == TZ_OK)
        s = find_pairs(&j);
    if (s == TZ_OK)
        s = join_pairs(&j);
    for (int32_t i = 0; i < j.drawn.n && s == TZ_OK; i++)
        if (!j.drawn.v[i].paired)
            s = draw_on(&j, &j.drawn.v[i], false);
    for (int32_t i = 0; i < j.foretold.n && s == TZ_OK; i++)
        if (!j.foretold.v[i].paired) {
            j.foretold.v[i].at = set->node.v[j.foretold.v[i].node];
            s = draw_on(&j, &j.foretold.v[i], true);
        }
    if (s == TZ_OK)
        s = merge(&j);
    if (s == TZ_OK)
        tz_curve_wrap(set);
    if (s == TZ_OK)
        *loss = loss_of(&j);
    tz_array_free(ctx, &j.drawn);
    tz_array_free(ctx, &j.foretold);
    tz_array_free(ctx, &j.pair);
    return s;
}
