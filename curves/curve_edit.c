/* SPDX-License-Identifier: Apache-2.0 */
/* Every function builds what is new beside what is there, and puts it in its place at the
 * end, so that nothing is half done where memory runs out. */
#include "curves/curve_edit.h"

#include <stdlib.h>
#include <string.h>

/* ---- choosing -------------------------------------------------------------------------
 */

/** Node of `to` for one of `from`, made when first asked for. */
static tz_status node_of(const tz_curve_set *from, tz_curve_set *to, int32_t *map,
                         int32_t node, tz_vec2 shift, int32_t *id)
{
    tz_status s = TZ_OK;
    if (map[node] < 0)
        s = tz_curve_add_node(to, tz_vec2_add(from->node.v[node], shift), &map[node]);
    *id = map[node];
    return s;
}

static tz_status add_path(const tz_curve_set *from, const tz_curve_path *p, int32_t pen,
                          tz_vec2 shift, int32_t *map, bool taper, bool origin,
                          tz_curve_set *to)
{
    tz_status s = tz_curve_begin(to, pen);
    for (int32_t i = p->piece; i < p->piece + p->pieces && s == TZ_OK; i++) {
        tz_curve_piece q = from->piece.v[i];
        tz_curve_carry c = tz_curve_carried(from, i);
        if (!c.has_taper)
            c.taper =
                (tz_curve_taper){from->pen.v[p->pen].width, from->pen.v[p->pen].width};
        if (!c.has_origin)
            c.origin = tz_curve_no_origin();
        c.has_taper = taper;
        c.has_origin = origin;
        s = node_of(from, to, map, q.from, shift, &q.from);
        if (s == TZ_OK)
            s = node_of(from, to, map, q.to, shift, &q.to);
        q.a = tz_vec2_add(q.a, shift);
        q.b = tz_vec2_add(q.b, shift);
        if (s == TZ_OK && q.straight && (shift.x != 0 || shift.y != 0)) {
            const tz_bezier line =
                tz_bezier_line(to->node.v[q.from], tz_curve_piece_end(to, &q));
            q.a = line.p[1];
            q.b = line.p[2];
        }
        if (s == TZ_OK)
            s = tz_curve_add_piece(to, &q, &c);
    }
    if (s == TZ_OK) {
        tz_curve_end(to, p->closed);
        to->path.v[to->path.n - 1].closed = p->closed;
    }
    return s;
}

static tz_status new_map(tz_ctx *ctx, const tz_curve_set *s, int32_t **map)
{
    const tz_status st = tz_alloc(ctx, map, (size_t)s->node.n, sizeof **map);
    for (int32_t i = 0; st == TZ_OK && i < s->node.n; i++)
        (*map)[i] = -1;
    return st;
}

static tz_status add_element(tz_ctx *ctx, const tz_element_set *from, int32_t i,
                             tz_vec2 shift, tz_element_set *to)
{
    tz_element e = from->element.v[i];
    const int32_t first = e.sample;
    tz_status s = TZ_OK;
    e.sample = to->sample.n;
    e.at.x += shift.x;
    e.at.y += shift.y;
    for (int32_t k = 0; k < e.samples && s == TZ_OK; k++) {
        tz_sample p = from->sample.v[first + k];
        p.at.x += shift.x;
        p.at.y += shift.y;
        s = tz_array_push(ctx, &to->sample, p);
    }
    return s == TZ_OK ? tz_array_push(ctx, &to->element, e) : s;
}

tz_status tz_curve_choose(tz_ctx *ctx, const tz_curve_set *from, const uint8_t *path,
                          const uint8_t *element, const tz_domain *domain, tz_vec2 shift,
                          tz_curve_set *to)
{
    int32_t *map = NULL;
    tz_status s = tz_curve_set_like(ctx, from, domain, to);
    if (s != TZ_OK)
        return s;
    s = new_map(ctx, from, &map);
    for (int32_t i = 0; i < from->path.n && s == TZ_OK; i++)
        if (!path || path[i])
            s = add_path(from, &from->path.v[i], from->path.v[i].pen, shift, map,
                         from->taper.n > 0, from->origin.n > 0, to);
    for (int32_t i = 0; i < from->element.element.n && s == TZ_OK; i++)
        if (!element || element[i])
            s = add_element(ctx, &from->element, i, shift, &to->element);
    tz_free(ctx, map);
    if (s != TZ_OK) {
        tz_curve_set_deinit(to);
        *to = (tz_curve_set){0};
    } else {
        tz_curve_wrap(to);
    }
    return s;
}

/* ---- adding ---------------------------------------------------------------------------
 */

static bool same_tables(const tz_element_set *a, const tz_element_set *b)
{
    bool same = a->kind.n == b->kind.n && a->symbol.n == b->symbol.n;
    for (int32_t i = 0; same && i < a->kind.n; i++)
        same = strcmp(a->kind.v[i].name, b->kind.v[i].name) == 0;
    for (int32_t i = 0; same && i < a->symbol.n; i++)
        same = strcmp(a->symbol.v[i].id, b->symbol.v[i].id) == 0;
    return same;
}

/** All of one set's paths with its own pens, found again in `to`. */
static tz_status add_all(tz_ctx *ctx, const tz_curve_set *from, bool taper, bool origin,
                         tz_curve_set *to)
{
    int32_t *map = NULL, pen = 0;
    tz_status s = new_map(ctx, from, &map);
    for (int32_t i = 0; i < from->path.n && s == TZ_OK; i++) {
        const tz_curve_path *p = &from->path.v[i];
        s = tz_curve_add_pen(to, from->pen.v[p->pen], &pen);
        if (s == TZ_OK)
            s = add_path(from, p, pen, (tz_vec2){0, 0}, map, taper, origin, to);
    }
    for (int32_t i = 0; i < from->element.element.n && s == TZ_OK; i++)
        s = add_element(ctx, &from->element, i, (tz_vec2){0, 0}, &to->element);
    tz_free(ctx, map);
    return s;
}

/** `next` in place of what *s is; its recipe stays. */
static void replace(tz_curve_set *s, tz_curve_set *next)
{
    next->recipe = s->recipe;
    s->recipe = NULL;
    tz_curve_set_deinit(s);
    *s = *next;
}

tz_status tz_curve_append(tz_ctx *ctx, tz_curve_set *to, const tz_curve_set *from)
{
    const bool taper = to->taper.n > 0 || from->taper.n > 0,
               origin = to->origin.n > 0 || from->origin.n > 0;
    tz_curve_set next;
    if (from->element.element.n > 0 && !same_tables(&to->element, &from->element))
        return tz_fail(
            ctx, TZ_INVALID,
            "elements of one drawing cannot go into another: their classes and "
            "symbols differ");
    tz_status s = tz_curve_set_like(ctx, to, NULL, &next);
    if (s != TZ_OK)
        return s;
    s = add_all(ctx, to, taper, origin, &next);
    if (s == TZ_OK)
        s = add_all(ctx, from, taper, origin, &next);
    if (s == TZ_OK)
        replace(to, &next);
    else
        tz_curve_set_deinit(&next);
    return s;
}

/* ---- welding --------------------------------------------------------------------------
 */

enum { MOST_CELLS = 1 << 20, STEPS = 16 };

/** A place on a piece that is to be cut. */
typedef struct cut {
    int32_t piece, node;
    double t;
} cut;

/** Chords of earlier pieces in cells as wide as they reach. */
typedef struct welder {
    tz_ctx *ctx;
    tz_curve_set *s;
    int32_t pieces; /* of earlier paths */
    double reach, cell;
    tz_vec2 origin;
    int32_t nx, ny;
    int32_t *head;
    TZ_ARRAY(int32_t)
    next; /* per entry: next entry of the cell */
    TZ_ARRAY(int32_t)
    piece;           /* per entry */
    int32_t *target; /* per node: the one that it becomes */
    TZ_ARRAY(tz_vec2)
    made; /* nodes at cuts */
    TZ_ARRAY(cut)
    cut;
    int32_t joined;
} welder;

static int32_t cell_of(double x, double origin, double cell, int32_t n)
{
    const double c = floor((x - origin) / cell);
    return c < 0 ? 0 : c >= n ? n - 1 : (int32_t)c;
}

/** Enters the piece in all cells that the box about its control points, wider by the
 * reach, touches. */
static tz_status enter(welder *w, int32_t piece)
{
    const tz_bezier c = tz_curve_bezier(w->s, &w->s->piece.v[piece]);
    tz_vec2 lo = c.p[0], hi = c.p[0];
    tz_status s = TZ_OK;
    for (int i = 1; i < 4; i++) {
        lo = (tz_vec2){fmin(lo.x, c.p[i].x), fmin(lo.y, c.p[i].y)};
        hi = (tz_vec2){fmax(hi.x, c.p[i].x), fmax(hi.y, c.p[i].y)};
    }
    const int32_t x0 = cell_of(lo.x - w->reach, w->origin.x, w->cell, w->nx),
                  x1 = cell_of(hi.x + w->reach, w->origin.x, w->cell, w->nx),
                  y0 = cell_of(lo.y - w->reach, w->origin.y, w->cell, w->ny),
                  y1 = cell_of(hi.y + w->reach, w->origin.y, w->cell, w->ny);
    for (int32_t y = y0; y <= y1 && s == TZ_OK; y++)
        for (int32_t x = x0; x <= x1 && s == TZ_OK; x++) {
            int32_t *head = &w->head[(int64_t)y * w->nx + x];
            s = tz_array_push(w->ctx, &w->piece, piece);
            if (s == TZ_OK)
                s = tz_array_push(w->ctx, &w->next, *head);
            if (s == TZ_OK)
                *head = w->next.n - 1;
        }
    return s;
}

static double distance2(const tz_bezier *c, double t, tz_vec2 p)
{
    const tz_vec2 v = tz_vec2_sub(tz_bezier_at(c, t), p);
    return tz_vec2_dot(v, v);
}

/** Every step that is nearer than both beside it is a start: a cubic has up to three. */
double tz_bezier_nearest(const tz_bezier *c, tz_vec2 p, double *t)
{
    double d[STEPS + 1], best = INFINITY;
    for (int i = 0; i <= STEPS; i++)
        d[i] = distance2(c, (double)i / STEPS, p);
    for (int i = 0; i <= STEPS; i++) {
        if ((i > 0 && d[i - 1] < d[i]) || (i < STEPS && d[i + 1] < d[i]))
            continue;
        double least = d[i], at = (double)i / STEPS, step = 0.5 / STEPS;
        for (int k = 0; k < 64 && step > 1e-12; k++) { /* halved: it cannot run away */
            const double down = fmax(0, at - step), up = fmin(1, at + step),
                         low = distance2(c, down, p), high = distance2(c, up, p);
            if (low < least && low <= high) {
                least = low;
                at = down;
            } else if (high < least) {
                least = high;
                at = up;
            } else {
                step /= 2;
            }
        }
        if (least < best) {
            best = least;
            *t = at;
        }
    }
    return sqrt(best);
}

/** Finds what a loose end meets: an earlier node, else an earlier piece. */
static tz_status weld_end(welder *w, int32_t node)
{
    const tz_curve_set *s = w->s;
    const tz_vec2 p = s->node.v[node];
    double near_node = w->reach, near_piece = w->reach, at = 0;
    int32_t to = -1, piece = -1;
    const int32_t x = cell_of(p.x, w->origin.x, w->cell, w->nx),
                  y = cell_of(p.y, w->origin.y, w->cell, w->ny);
    for (int32_t e = w->head[(int64_t)y * w->nx + x]; e >= 0; e = w->next.v[e]) {
        const int32_t id = w->piece.v[e];
        const tz_curve_piece *q = &s->piece.v[id];
        tz_bezier c = tz_curve_bezier(s, q);
        const tz_vec2 home = tz_curve_copy(&s->domain, p, tz_bezier_at(&c, 0.5));
        for (int k = 0; k < 2; k++) {
            const double d = hypot(c.p[3 * k].x - home.x, c.p[3 * k].y - home.y);
            const int32_t n = k ? q->to : q->from;
            if (d < near_node || (d == near_node && (to < 0 || n < to))) {
                near_node = d;
                to = n;
            }
        }
        double t = 0;
        const double d = tz_bezier_nearest(&c, home, &t);
        if (d < near_piece || (d == near_piece && (piece < 0 || id < piece))) {
            near_piece = d;
            piece = id;
            at = t;
        }
    }
    if (to >= 0) {
        w->target[node] = to;
    } else if (piece >= 0) {
        const tz_bezier c = tz_curve_bezier(s, &s->piece.v[piece]);
        const cut k = {piece, s->node.n + w->made.n, at};
        tz_status st = tz_array_push(w->ctx, &w->made, tz_bezier_at(&c, at));
        if (st == TZ_OK)
            st = tz_array_push(w->ctx, &w->cut, k);
        if (st != TZ_OK)
            return st;
        w->target[node] = k.node;
    } else {
        return TZ_OK;
    }
    w->joined++;
    return TZ_OK;
}

static int by_piece(const void *p, const void *q)
{
    const cut *a = p, *b = q;
    if (a->piece != b->piece)
        return a->piece < b->piece ? -1 : 1;
    return a->t < b->t ? -1 : a->t > b->t ? 1 : a->node - b->node;
}

static tz_vec2 place_of(const welder *w, int32_t node)
{
    return node < w->s->node.n ? w->s->node.v[node] : w->made.v[node - w->s->node.n];
}

/** A piece whose ends move with their nodes: so do the control points beside them. */
static tz_status put_moved(const welder *w, int32_t i, int32_t *map, tz_curve_set *to)
{
    const tz_curve_piece *q = &w->s->piece.v[i];
    const tz_bezier c = tz_curve_bezier(w->s, q);
    const tz_curve_carry carry = tz_curve_carried(w->s, i);
    const int32_t from = w->target[q->from], end = w->target[q->to];
    const tz_domain *d = &w->s->domain;
    const tz_vec2 p = tz_curve_copy(d, place_of(w, from), c.p[0]),
                  r = tz_curve_copy(d, place_of(w, end), c.p[3]);
    tz_curve_piece out = *q;
    tz_vec2 home = {0, 0};
    tz_status s = TZ_OK;
    for (int k = 0; k < 2 && s == TZ_OK; k++) {
        const int32_t n = k ? end : from;
        if (map[n] < 0)
            s = tz_curve_add_node(to, place_of(w, n), &map[n]);
        *(k ? &out.to : &out.from) = map[n];
    }
    if (s != TZ_OK)
        return s;
    home = tz_vec2_sub(to->node.v[out.from], p); /* on a torus: where the node is */
    out.a = tz_vec2_add(out.a, tz_vec2_add(home, tz_vec2_sub(p, c.p[0])));
    out.b = tz_vec2_add(out.b, tz_vec2_add(home, tz_vec2_sub(r, c.p[3])));
    if (q->straight) {
        const tz_bezier line =
            tz_bezier_line(to->node.v[out.from], tz_curve_piece_end(to, &out));
        out.a = line.p[1];
        out.b = line.p[2];
    }
    if (out.from == out.to && q->straight && hypot(p.x - r.x, p.y - r.y) == 0)
        return TZ_OK; /* a crumb, gone with the weld */
    return tz_curve_add_piece(to, &out, &carry);
}

/** A piece with nodes put into it. */
static tz_status put_cut(const welder *w, int32_t i, const cut *k, int32_t n,
                         int32_t *map, tz_curve_set *to)
{
    const tz_curve_piece *q = &w->s->piece.v[i];
    const tz_bezier c = tz_curve_bezier(w->s, q);
    const tz_curve_carry carry = tz_curve_carried(w->s, i);
    tz_status s = TZ_OK;
    double t0 = 0;
    int32_t from = q->from;
    for (int32_t j = 0; j <= n && s == TZ_OK; j++) {
        const double t1 = j < n ? k[j].t : 1;
        const int32_t end = j < n ? k[j].node : q->to;
        const tz_bezier part = tz_bezier_part(&c, t0, t1);
        const tz_curve_carry some = tz_curve_carry_part(&carry, &c, t0, t1);
        tz_curve_piece out = {.straight = q->straight, .a = part.p[1], .b = part.p[2]};
        if (map[from] < 0)
            s = tz_curve_add_node(to, place_of(w, from), &map[from]);
        if (s == TZ_OK && map[end] < 0)
            s = tz_curve_add_node(to, place_of(w, end), &map[end]);
        if (s != TZ_OK)
            break;
        out.from = map[from];
        out.to = map[end];
        const tz_vec2 at = to->node.v[out.from], home = tz_vec2_sub(at, part.p[0]);
        if (w->s->domain.torus) { /* where the node really is */
            out.a = tz_vec2_add(out.a, home);
            out.b = tz_vec2_add(out.b, home);
        }
        if (out.straight) { /* its thirds to the bit */
            const tz_bezier line = tz_bezier_line(at, tz_curve_piece_end(to, &out));
            out.a = line.p[1];
            out.b = line.p[2];
        }
        s = tz_curve_add_piece(to, &out, &some);
        from = end;
        t0 = t1;
    }
    return s;
}

static tz_status rebuild(welder *w, int32_t *map, tz_curve_set *to)
{
    const tz_curve_set *s = w->s;
    tz_status st = TZ_OK;
    int32_t k = 0;
    for (int32_t p = 0; p < s->path.n && st == TZ_OK; p++) {
        const tz_curve_path *path = &s->path.v[p];
        st = tz_curve_begin(to, path->pen);
        for (int32_t i = path->piece; i < path->piece + path->pieces && st == TZ_OK;
             i++) {
            const int32_t first = k;
            while (k < w->cut.n && w->cut.v[k].piece == i)
                k++;
            st = k > first ? put_cut(w, i, w->cut.v + first, k - first, map, to)
                           : put_moved(w, i, map, to);
        }
        if (st == TZ_OK) {
            const int32_t paths = to->path.n;
            tz_curve_end(to, path->closed);
            if (to->path.n == paths)
                to->path.v[paths - 1].closed = path->closed;
        }
    }
    for (int32_t i = 0; i < s->element.element.n && st == TZ_OK; i++)
        st = add_element(w->ctx, &s->element, i, (tz_vec2){0, 0}, &to->element);
    return st;
}

/** Entries that cells of that width would make. */
static double entries(const welder *w, double cell)
{
    double sum = 0;
    for (int32_t i = 0; i < w->pieces; i++) {
        const tz_bezier c = tz_curve_bezier(w->s, &w->s->piece.v[i]);
        tz_vec2 lo = c.p[0], hi = c.p[0];
        for (int k = 1; k < 4; k++) {
            lo = (tz_vec2){fmin(lo.x, c.p[k].x), fmin(lo.y, c.p[k].y)};
            hi = (tz_vec2){fmax(hi.x, c.p[k].x), fmax(hi.y, c.p[k].y)};
        }
        sum += (1 + (hi.x - lo.x + 2 * w->reach) / cell) *
               (1 + (hi.y - lo.y + 2 * w->reach) / cell);
    }
    return sum;
}

/** Cells about as many as there are pieces, no narrower than the reach, and wider where
 * pieces are long. */
static tz_status lay_cells(welder *w)
{
    const tz_curve_set *s = w->s;
    const double span = fmax(1e-300, fmax(s->domain.size.x, s->domain.size.y));
    const double wanted = sqrt(fmin(MOST_CELLS, fmax(1, w->pieces)));
    w->cell = fmax(span / wanted, 2 * w->reach);
    for (int i = 0; i < 10 && entries(w, w->cell) > 24.0 * w->pieces + 1024; i++)
        w->cell *= 2;
    w->nx = 1 + (int32_t)fmin(wanted, s->domain.size.x / w->cell);
    w->ny = 1 + (int32_t)fmin(wanted, s->domain.size.y / w->cell);
    tz_status st =
        tz_alloc(w->ctx, &w->head, (size_t)w->nx * (size_t)w->ny, sizeof *w->head);
    if (st != TZ_OK)
        return st;
    for (int64_t i = 0; i < (int64_t)w->nx * w->ny; i++)
        w->head[i] = -1;
    for (int32_t i = 0; i < w->pieces && st == TZ_OK; i++)
        st = enter(w, i);
    return st;
}

tz_status tz_curve_weld(tz_ctx *ctx, tz_curve_set *s, int32_t first, double reach,
                        int32_t *joined)
{
    welder w = {.ctx = ctx, .s = s};
    int32_t *map = NULL, *uses = NULL;
    tz_curve_set next = {0}, used = {0};
    if (joined)
        *joined = 0;
    if (first >= s->path.n || first <= 0)
        return TZ_OK;
    w.pieces = s->path.v[first].piece;
    w.reach = fmax(reach, 1e-7 * hypot(s->domain.size.x, s->domain.size.y));
    tz_status st = lay_cells(&w);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &w.target, (size_t)s->node.n, sizeof *w.target);
    if (st == TZ_OK)
        st = tz_alloc_zero(ctx, &uses, (size_t)s->node.n, sizeof *uses);
    if (st != TZ_OK)
        goto done;
    for (int32_t i = 0; i < s->node.n; i++)
        w.target[i] = i;
    for (int32_t i = 0; i < s->piece.n; i++) {
        uses[s->piece.v[i].from]++;
        uses[s->piece.v[i].to]++;
    }
    for (int32_t p = first; p < s->path.n && st == TZ_OK; p++)
        for (int k = 0; k < 2 && st == TZ_OK; k++) {
            const tz_curve_path *path = &s->path.v[p];
            const int32_t node = k ? s->piece.v[path->piece + path->pieces - 1].to
                                   : s->piece.v[path->piece].from;
            if (uses[node] == 1)
                st = weld_end(&w, node);
        }
    if (st == TZ_OK && w.cut.n > 0)
        qsort(w.cut.v, (size_t)w.cut.n, sizeof *w.cut.v, by_piece);
    const int32_t nodes = s->node.n + w.made.n;
    if (st == TZ_OK)
        st = tz_alloc(ctx, &map, (size_t)nodes, sizeof *map);
    if (st == TZ_OK)
        st = tz_curve_set_like(ctx, s, NULL, &next);
    if (st != TZ_OK)
        goto done;
    for (int32_t i = 0; i < nodes; i++)
        map[i] = -1;
    st = rebuild(&w, map, &next);
    if (st == TZ_OK) /* without nodes that cuts have left alone */
        st = tz_curve_choose(ctx, &next, NULL, NULL, NULL, (tz_vec2){0, 0}, &used);
    if (st == TZ_OK) {
        replace(s, &used);
        tz_curve_set_deinit(&next);
        next = (tz_curve_set){0};
        if (joined)
            *joined = w.joined;
    }
done:
    tz_curve_set_deinit(&next);
    tz_free(ctx, map);
    tz_free(ctx, uses);
    tz_free(ctx, w.target);
    tz_free(ctx, w.head);
    tz_array_free(ctx, &w.next);
    tz_array_free(ctx, &w.piece);
    tz_array_free(ctx, &w.made);
    tz_array_free(ctx, &w.cut);
    return st;
}
