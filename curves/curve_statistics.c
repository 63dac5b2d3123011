/* SPDX-License-Identifier: Apache-2.0 */
/* From a set to a field. What is measured is what the drawing shows: paths are joined,
 * crossings too; a torus is cut open at its border, where lines are cut as on any other.
 * Chords are short against the scale, so that windows, regions and frames need not cut
 * them exactly; very long drawings get longer ones. */
#include "curves/curve_statistics.h"

#include <stdlib.h>
#include <string.h>

#include "curves/curve_join.h"

#define CHORD       0.25 /* units: longest */
#define TURN_STEP   0.25 /* units: places where turning is measured */
#define TOLERANCE   0.005
#define BORDER      0.05  /* units: what is so near to the border is cut by it */
#define BORDER_MOST 0.25  /* or half of a line's width, but no more than this */
#define CORNER_NEAR 0.125 /* units: ways that a corner is measured over */
#define CORNER_FAR  0.25
#define CORNER_SAME 0.6 /* a corner turns as much over the short way; a bend half */
enum { MOST_CHORDS = 4000000, MOST_TURNS = 1000000 };

/* A path with the length up to each point. */
typedef struct polyline {
    TZ_ARRAY(tz_vec2)
    point;
    TZ_ARRAY(double)
    along;
    TZ_ARRAY(bool)
    crossed; /* the point is a node of other degree than 2 */
    bool closed;
} polyline;

typedef struct builder {
    tz_ctx *ctx;
    tz_linework_field *f;
    tz_curve_set set; /* joined, plain */
    double chord;     /* longest */
    double border;    /* what ends, or what nodes have, so near to it is cut by it */
    int32_t *degree;  /* by node */
    int32_t *first;   /* by node: end[first[k] .. first[k + 1] - 1] */
    int32_t *end;     /* piece << 1 | whether it is the piece's `to` */
    uint8_t *done;    /* by piece */
    polyline line;
} builder;

/* ---- torus and length --------------------------------------------------------------- */

static tz_status add_straight(tz_curve_set *to, tz_vec2 p, tz_vec2 q)
{
    int32_t a = 0, b = 0;
    tz_status s = tz_curve_add_node(to, p, &a);
    if (s == TZ_OK)
        s = tz_curve_add_node(to, q, &b);
    return s == TZ_OK ? tz_curve_line(to, a, b) : s;
}

/* A chord of a torus, cut at the border; its parts inside of the rectangle. */
static tz_status add_wrapped(tz_curve_set *to, tz_vec2 p, tz_vec2 q, int32_t pen)
{
    const double w = to->domain.size.x, h = to->domain.size.y;
    double t = 0;
    tz_status s = TZ_OK;
    for (int part = 0; t < 1 && part < 8 && s == TZ_OK; part++) {
        const double dx = q.x - p.x, dy = q.y - p.y, small = 1e-9;
        const tz_vec2 in = {p.x + (t + small) * dx, p.y + (t + small) * dy};
        const double ox = floor(in.x / w) * w, oy = floor(in.y / h) * h;
        double end = 1;
        if (dx != 0)
            end = fmin(end, ((dx > 0 ? ox + w : ox) - p.x) / dx);
        if (dy != 0)
            end = fmin(end, ((dy > 0 ? oy + h : oy) - p.y) / dy);
        end = fmin(1, fmax(end, t + 2 * small));
        s = tz_curve_begin(to, pen);
        if (s == TZ_OK)
            s = add_straight(to, (tz_vec2){p.x + t * dx - ox, p.y + t * dy - oy},
                             (tz_vec2){p.x + end * dx - ox, p.y + end * dy - oy});
        tz_curve_end(to, false);
        t = end;
    }
    return s;
}

/* A torus cut open: a plain set of lines. */
static tz_status cut_open(tz_ctx *ctx, const tz_curve_set *from, double tolerance,
                          tz_curve_set *to)
{
    memset(to, 0, sizeof *to);
    to->ctx = ctx;
    to->domain = from->domain;
    to->domain.torus = false;
    tz_status s = TZ_OK;
    int32_t pen = 0;
    for (int32_t i = 0; i < from->pen.n && s == TZ_OK; i++)
        s = tz_array_push(ctx, &to->pen, from->pen.v[i]);
    for (int32_t i = 0; i < from->path.n && s == TZ_OK; i++) {
        const tz_curve_path *path = &from->path.v[i];
        pen = path->pen;
        for (int32_t k = path->piece; k < path->piece + path->pieces && s == TZ_OK; k++) {
            const tz_bezier c = tz_curve_bezier(from, &from->piece.v[k]);
            const int32_t n =
                from->piece.v[k].straight ? 1 : 1 + tz_bezier_steps(&c, tolerance);
            tz_vec2 p = c.p[0];
            for (int32_t j = 1; j <= n && s == TZ_OK; j++) {
                const tz_vec2 q = j == n ? c.p[3] : tz_bezier_at(&c, (double)j / n);
                if (p.x != q.x || p.y != q.y)
                    s = add_wrapped(to, p, q, pen);
                p = q;
            }
        }
    }
    return s;
}

tz_status tz_linework_scale_of(tz_ctx *ctx, const tz_curve_set *s, tz_linework_scale *out)
{
    const double shorter = fmin(s->domain.size.x, s->domain.size.y);
    double length = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        length += tz_bezier_length(&b);
    }
    if (!(length > 0) || !isfinite(length))
        return tz_fail(ctx, TZ_INVALID,
                       "likeness: the exemplar has no lines to compare with");
    const double unit = tz_domain_area(&s->domain) / length;
    *out = (tz_linework_scale){.unit = fmin(fmax(unit, shorter / 1000), shorter / 8)};
    out->way = fmin(8 * out->unit, shorter / 2);
    out->pixel = fmax(out->unit / 8, shorter / TZ_LINEWORK_SIDE);
    out->patch = fmin(3 * out->unit, 0.3 * shorter);
    for (int k = 0; k < TZ_LINEWORK_LAGS; k++)
        out->lag[k] = out->unit * (0.25 * (1 << k));
    return TZ_OK;
}

/* ---- chords by edge ----------------------------------------------------------------- */

static double depth(const tz_domain *d, tz_vec2 p)
{
    const double r = fmin(fmin(p.x, d->size.x - p.x), fmin(p.y, d->size.y - p.y));
    return d->region ? fmin(r, tz_region_distance(d->region, (tz_vec3){p.x, p.y, 0})) : r;
}

/* In the rectangle, whose left and upper border belong to it, also after rounding: what is
 * drawn along the borders of a tile counts once. */
static bool is_inside(const tz_linework_field *f, tz_vec2 p)
{
    const double e = TZ_LINEWORK_ROUNDING * f->scale.unit;
    return p.x >= -e && p.y >= -e && p.x < f->domain.size.x - e &&
           p.y < f->domain.size.y - e &&
           (!f->domain.region ||
            tz_region_distance(f->domain.region, (tz_vec3){p.x, p.y, 0}) > 0);
}

static tz_status add_chord(builder *b, tz_vec2 p, tz_vec2 q)
{
    tz_linework_field *f = b->f;
    const tz_vec2 d = tz_vec2_sub(q, p);
    const tz_vec3 mid = {(p.x + q.x) / 2, (p.y + q.y) / 2, 0};
    double angle = atan2(d.y, d.x) - tz_domain_frame(&f->domain, mid);
    angle -= floor(angle / TZ_PI) * TZ_PI;
    const tz_linework_chord c = {.p = p,
                                 .q = q,
                                 .length = (float)tz_vec2_length(d),
                                 .angle = (float)angle,
                                 .inside = !f->domain.region ||
                                           tz_region_distance(f->domain.region, mid) > 0};
    return c.length > 0 ? tz_array_push(b->ctx, &f->chord, c) : TZ_OK;
}

/* How many chords a piece is cut into. */
static int32_t steps_of(const builder *b, const tz_curve_piece *piece, const tz_bezier *c)
{
    const double box = tz_vec2_length(tz_vec2_sub(c->p[1], c->p[0])) +
                       tz_vec2_length(tz_vec2_sub(c->p[2], c->p[1])) +
                       tz_vec2_length(tz_vec2_sub(c->p[3], c->p[2]));
    const double fine = ceil(fmin(box / b->chord, 1e6));
    const int32_t bent =
        piece->straight ? 1 : 1 + tz_bezier_steps(c, TOLERANCE * b->f->scale.unit);
    return fine > bent ? (int32_t)fine : bent;
}

static tz_status add_piece_chords(builder *b, int32_t piece, bool back)
{
    const tz_curve_piece *v = &b->set.piece.v[piece];
    const tz_bezier c = tz_curve_bezier(&b->set, v);
    const int32_t n = steps_of(b, v, &c);
    tz_vec2 p = c.p[back ? 3 : 0];
    tz_status s = TZ_OK;
    b->done[piece] = 1;
    for (int32_t k = 1; k <= n && s == TZ_OK; k++) {
        const double t = (double)k / n;
        const tz_vec2 q = k == n ? c.p[back ? 0 : 3] : tz_bezier_at(&c, back ? 1 - t : t);
        s = add_chord(b, p, q);
        p = q;
    }
    return s;
}

/* Whether an edge that comes to this node ends there; not where the domain cuts it. */
static bool ends_at(const builder *b, int32_t node)
{
    const tz_vec2 p = b->set.node.v[node];
    return b->degree[node] == 1 ? depth(&b->f->domain, p) > b->border
                                : is_inside(b->f, p);
}

/* The edge that leaves `node` by that end of a piece. */
static tz_status add_edge(builder *b, int32_t node, int32_t end, bool loop)
{
    tz_linework_edge e = {.chord = b->f->chord.n, .loop = loop};
    tz_status s = TZ_OK;
    e.ends[0] = loop || ends_at(b, node);
    for (int32_t guard = 0; guard <= b->set.piece.n && s == TZ_OK; guard++) {
        const int32_t piece = end >> 1;
        const bool back = end & 1;
        s = add_piece_chords(b, piece, back);
        node = back ? b->set.piece.v[piece].from : b->set.piece.v[piece].to;
        if (b->degree[node] != 2)
            break;
        const int32_t *two = &b->end[b->first[node]];
        end = two[0] == (end ^ 1) ? two[1] : two[0];
        if (b->done[end >> 1])
            break;
    }
    e.ends[1] = loop || ends_at(b, node);
    e.chords = b->f->chord.n - e.chord;
    return s == TZ_OK && e.chords > 0 ? tz_array_push(b->ctx, &b->f->edge, e) : s;
}

static tz_status link_nodes(builder *b)
{
    const tz_curve_set *set = &b->set;
    const size_t n = (size_t)set->node.n, m = (size_t)set->piece.n;
    tz_status s = tz_alloc_zero(b->ctx, &b->degree, n, sizeof *b->degree);
    if (s == TZ_OK)
        s = tz_alloc_zero(b->ctx, &b->first, n + 2, sizeof *b->first);
    if (s == TZ_OK)
        s = tz_alloc(b->ctx, &b->end, 2 * m, sizeof *b->end);
    if (s == TZ_OK)
        s = tz_alloc_zero(b->ctx, &b->done, m, 1);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < set->piece.n; i++) {
        b->degree[set->piece.v[i].from]++;
        b->degree[set->piece.v[i].to]++;
    }
    for (int32_t i = 0; i < set->node.n; i++)
        b->first[i + 2] = b->first[i + 1] + b->degree[i];
    for (int32_t i = 0; i < set->piece.n; i++) {
        b->end[b->first[set->piece.v[i].from + 1]++] = i << 1;
        b->end[b->first[set->piece.v[i].to + 1]++] = i << 1 | 1;
    }
    return TZ_OK;
}

/* Degree of a node, of which the border may hide a part: what a lattice has on the border
 * of its tile. Where lines run along the border the rest of the node is the mirror image
 * of what is seen; elsewhere all of it is seen. */
static int32_t whole_degree(const builder *b, int32_t node)
{
    const tz_domain *d = &b->f->domain;
    const tz_vec2 p = b->set.node.v[node];
    int32_t along = 0, inside = 0;
    if (b->degree[node] == 1 || depth(d, p) > b->border)
        return b->degree[node];
    for (int32_t k = b->first[node]; k < b->first[node + 1]; k++) {
        const tz_bezier c = tz_curve_bezier(&b->set, &b->set.piece.v[b->end[k] >> 1]);
        const bool back = b->end[k] & 1;
        const double t = fmin(0.5, b->f->scale.unit / fmax(tz_bezier_length(&c), 1e-300));
        const double at = depth(d, tz_bezier_at(&c, back ? 1 - t : t));
        along += fabs(at) <= b->border;
        inside += at > b->border;
    }
    const bool corner = fmin(p.x, d->size.x - p.x) <= b->border &&
                        fmin(p.y, d->size.y - p.y) <= b->border;
    return along > 0 ? (along + 2 * inside) * (corner ? 2 : 1) : b->degree[node];
}

static tz_status add_edges(builder *b)
{
    tz_status s = link_nodes(b);
    for (int32_t i = 0; s == TZ_OK && i < b->set.node.n; i++) {
        for (int32_t k = b->first[i];
             b->degree[i] != 2 && k < b->first[i + 1] && s == TZ_OK; k++)
            if (!b->done[b->end[k] >> 1])
                s = add_edge(b, i, b->end[k], false);
        if (s == TZ_OK && b->degree[i] != 2 && ends_at(b, i))
            s = tz_array_push(b->ctx, &b->f->node,
                              ((tz_linework_node){.at = b->set.node.v[i],
                                                  .degree = whole_degree(b, i)}));
    }
    for (int32_t i = 0; s == TZ_OK && i < b->set.piece.n; i++)
        if (!b->done[i])
            s = add_edge(b, b->set.piece.v[i].from, i << 1, true);
    return s;
}

/* ---- turning and corners ------------------------------------------------------------ */

static tz_status add_point(builder *b, tz_vec2 p, int32_t node)
{
    polyline *l = &b->line;
    const bool crossed = node >= 0 && b->degree[node] != 2;
    double along = 0;
    if (l->point.n > 0) {
        const double step = tz_vec2_length(tz_vec2_sub(p, l->point.v[l->point.n - 1]));
        if (!(step > 0))
            return TZ_OK;
        along = l->along.v[l->along.n - 1] + step;
    }
    tz_status s = tz_array_push(b->ctx, &l->point, p);
    if (s == TZ_OK)
        s = tz_array_push(b->ctx, &l->along, along);
    return s == TZ_OK ? tz_array_push(b->ctx, &l->crossed, crossed) : s;
}

static tz_status flatten(builder *b, const tz_curve_path *path)
{
    const double tolerance = TOLERANCE * b->f->scale.unit;
    tz_status s = TZ_OK;
    b->line.point.n = b->line.along.n = b->line.crossed.n = 0;
    b->line.closed = path->closed;
    for (int32_t i = path->piece; i < path->piece + path->pieces && s == TZ_OK; i++) {
        const tz_curve_piece *v = &b->set.piece.v[i];
        const tz_bezier c = tz_curve_bezier(&b->set, v);
        const int32_t n = v->straight ? 1 : 1 + tz_bezier_steps(&c, tolerance);
        if (i == path->piece)
            s = add_point(b, c.p[0], v->from);
        for (int32_t k = 1; k < n && s == TZ_OK; k++)
            s = add_point(b, tz_bezier_at(&c, (double)k / n), -1);
        if (s == TZ_OK)
            s = add_point(b, c.p[3], v->to);
    }
    return s;
}

static tz_vec2 place(const polyline *l, double along)
{
    const double length = l->along.v[l->along.n - 1];
    int32_t lo = 0, hi = l->along.n - 1;
    if (l->closed)
        along -= floor(along / length) * length;
    along = fmin(fmax(along, 0), length);
    while (hi - lo > 1) {
        const int32_t mid = lo + (hi - lo) / 2;
        *(l->along.v[mid] <= along ? &lo : &hi) = mid;
    }
    const double t = (along - l->along.v[lo]) / (l->along.v[hi] - l->along.v[lo]);
    const tz_vec2 p = l->point.v[lo], q = l->point.v[hi];
    return (tz_vec2){p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
}

/* Angle between the ways to the places `lag` before and behind; NAN = there is no such. */
static double turn_at(const polyline *l, double along, double lag)
{
    const double length = l->along.v[l->along.n - 1];
    if (l->closed ? 4 * lag > length : along < lag || along > length - lag)
        return NAN;
    const tz_vec2 p = place(l, along), u = tz_vec2_sub(p, place(l, along - lag)),
                  v = tz_vec2_sub(place(l, along + lag), p);
    return fabs(atan2(u.x * v.y - u.y * v.x, tz_vec2_dot(u, v)));
}

static tz_status add_turns(builder *b, double step)
{
    const polyline *l = &b->line;
    const double length = l->along.v[l->along.n - 1];
    const double n = ceil(length / step);
    tz_status s = TZ_OK;
    for (double i = 0; i < n && s == TZ_OK; i++) {
        const double along = (i + 0.5) / n * length;
        tz_linework_turn t = {.at = place(l, along)};
        t.depth = (float)depth(&b->f->domain, t.at);
        for (int k = 0; k < TZ_LINEWORK_LAGS; k++)
            t.angle[k] = (float)turn_at(l, along, b->f->scale.lag[k]);
        if (is_inside(b->f, t.at))
            s = tz_array_push(b->ctx, &b->f->turn, t);
    }
    return s;
}

/* Points of the path where it turns at once; of near ones the first. */
static tz_status add_corners(builder *b)
{
    const polyline *l = &b->line;
    const double unit = b->f->scale.unit, length = l->along.v[l->along.n - 1];
    const double far = fmin(CORNER_FAR * unit, 0.2 * length),
                 near = fmin(CORNER_NEAR * unit, 0.1 * length);
    double first = -1, last = -far;
    tz_status s = TZ_OK;
    for (int32_t i = l->closed ? 0 : 1; i < l->point.n - 1 && s == TZ_OK; i++) {
        const double along = l->along.v[i];
        if (l->crossed.v[i] || along - last < far ||
            (l->closed && first >= 0 && first + length - along < far))
            continue;
        const double turn = turn_at(l, along, near);
        if (!(turn > TZ_PI / 9) || turn < CORNER_SAME * turn_at(l, along, far) ||
            !is_inside(b->f, l->point.v[i]))
            continue;
        first = first < 0 ? along : first;
        last = along;
        s = tz_array_push(b->ctx, &b->f->node,
                          ((tz_linework_node){.at = l->point.v[i], .degree = 2}));
    }
    return s;
}

static tz_status add_paths(builder *b, double length)
{
    const double step = fmax(TURN_STEP * b->f->scale.unit, length / MOST_TURNS);
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < b->set.path.n && s == TZ_OK; i++) {
        s = flatten(b, &b->set.path.v[i]);
        if (s == TZ_OK && b->line.point.n < 2)
            continue;
        if (s == TZ_OK)
            s = add_turns(b, step);
        if (s == TZ_OK)
            s = add_corners(b);
        if (s == TZ_OK && !(i & 255) && tz_ctx_cancelled(b->ctx))
            s = TZ_CANCELLED;
    }
    return s;
}

/* ---- all ---------------------------------------------------------------------------- */

static double length_of(const tz_curve_set *s)
{
    double length = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        length += tz_bezier_length(&b);
    }
    return length;
}

/* At crossings lines run on as an eye follows them, not as they happen to be drawn: every
 * piece is a path of its own, and paths are chained by what they look like. */
static tz_status follow(builder *b)
{
    const tz_curve_join_params chain = {.only_chain = true};
    const tz_curve_set *from = &b->set;
    tz_curve_set apart = *from, to = {0};
    tz_status s = TZ_OK;
    memset(&apart.path, 0, sizeof apart.path);
    for (int32_t i = 0; i < from->path.n && s == TZ_OK; i++)
        for (int32_t k = 0; k < from->path.v[i].pieces && s == TZ_OK; k++) {
            const int32_t piece = from->path.v[i].piece + k;
            const tz_curve_piece *p = &from->piece.v[piece];
            s = tz_array_push(b->ctx, &apart.path,
                              ((tz_curve_path){.piece = piece,
                                               .pieces = 1,
                                               .closed = p->from == p->to,
                                               .pen = from->path.v[i].pen}));
        }
    if (s == TZ_OK)
        s = tz_curve_join(b->ctx, &apart, &chain, &to);
    tz_array_free(b->ctx, &apart.path);
    if (s == TZ_OK) {
        tz_curve_set_deinit(&b->set);
        b->set = to;
    }
    return s;
}

tz_status tz_linework_field_init(tz_ctx *ctx, const tz_curve_set *s,
                                 const tz_linework_scale *scale, tz_linework_field *f)
{
    const tz_curve_join_params join = {.crossings = true, .reach = tz_curve_reach(s)};
    builder b = {.ctx = ctx, .f = f};
    b.border = scale->unit * fmin(BORDER_MOST, fmax(BORDER, join.reach / scale->unit));
    tz_curve_set flat = {0};
    *f = (tz_linework_field){.ctx = ctx, .domain = s->domain, .scale = *scale};
    f->domain.torus = false;
    tz_status st = TZ_OK;
    if (s->domain.torus)
        st = cut_open(ctx, s, TOLERANCE * scale->unit, &flat);
    if (st == TZ_OK)
        st = tz_curve_join(ctx, s->domain.torus ? &flat : s, &join, &b.set);
    if (st == TZ_OK)
        st = follow(&b);
    if (st != TZ_OK)
        goto done;
    const double length = length_of(&b.set);
    b.chord = fmax(CHORD * scale->unit, length / MOST_CHORDS);
    st = add_edges(&b);
    if (st == TZ_OK)
        st = add_paths(&b, length);
done:
    tz_free(ctx, b.degree);
    tz_free(ctx, b.first);
    tz_free(ctx, b.end);
    tz_free(ctx, b.done);
    tz_array_free(ctx, &b.line.point);
    tz_array_free(ctx, &b.line.along);
    tz_array_free(ctx, &b.line.crossed);
    tz_curve_set_deinit(&b.set);
    tz_curve_set_deinit(&flat);
    if (st != TZ_OK)
        tz_linework_field_deinit(f);
    return st;
}

void tz_linework_field_deinit(tz_linework_field *f)
{
    tz_array_free(f->ctx, &f->chord);
    tz_array_free(f->ctx, &f->edge);
    tz_array_free(f->ctx, &f->node);
    tz_array_free(f->ctx, &f->turn);
    *f = (tz_linework_field){0};
}

tz_linework_window tz_linework_whole(const tz_linework_field *f)
{
    return (tz_linework_window){{0, 0}, {f->domain.size.x, f->domain.size.y}};
}
