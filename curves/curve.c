/* SPDX-License-Identifier: Apache-2.0 */
/* The model of curve textures: building, checking, and the geometry of a cubic. */
#include "curves/curve.h"

#include <string.h>

/* ---- cubics ---------------------------------------------------------------------- */

static tz_vec2 between(tz_vec2 p, tz_vec2 q, double t)
{
    return (tz_vec2){p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
}

tz_bezier tz_bezier_line(tz_vec2 p, tz_vec2 q)
{
    return (tz_bezier){{p, between(p, q, 1.0 / 3), between(p, q, 2.0 / 3), q}};
}

tz_vec2 tz_bezier_at(const tz_bezier *c, double t)
{
    const double s = 1 - t, k0 = s * s * s, k1 = 3 * s * s * t, k2 = 3 * s * t * t,
                 k3 = t * t * t;
    return (tz_vec2){k0 * c->p[0].x + k1 * c->p[1].x + k2 * c->p[2].x + k3 * c->p[3].x,
                     k0 * c->p[0].y + k1 * c->p[1].y + k2 * c->p[2].y + k3 * c->p[3].y};
}

tz_vec2 tz_bezier_slope(const tz_bezier *c, double t)
{
    const double s = 1 - t, k0 = 3 * s * s, k1 = 6 * s * t, k2 = 3 * t * t;
    const tz_vec2 a = tz_vec2_sub(c->p[1], c->p[0]), b = tz_vec2_sub(c->p[2], c->p[1]),
                  d = tz_vec2_sub(c->p[3], c->p[2]);
    return (tz_vec2){k0 * a.x + k1 * b.x + k2 * d.x, k0 * a.y + k1 * b.y + k2 * d.y};
}

/* Blossoms: the control points of a part are the polar values at its ends. */
static tz_vec2 blossom(const tz_bezier *c, double u, double v, double w)
{
    const tz_vec2 a = between(c->p[0], c->p[1], u), b = between(c->p[1], c->p[2], u),
                  d = between(c->p[2], c->p[3], u);
    return between(between(a, b, v), between(b, d, v), w);
}

tz_bezier tz_bezier_part(const tz_bezier *c, double t0, double t1)
{
    return (tz_bezier){{t0 > 0 ? blossom(c, t0, t0, t0) : c->p[0], blossom(c, t0, t0, t1),
                        blossom(c, t0, t1, t1),
                        t1 < 1 ? blossom(c, t1, t1, t1) : c->p[3]}};
}

int32_t tz_bezier_steps(const tz_bezier *c, double tolerance)
{
    double most = 0;
    for (int i = 0; i < 2; i++)
        most = fmax(most, hypot(c->p[i].x - 2 * c->p[i + 1].x + c->p[i + 2].x,
                                c->p[i].y - 2 * c->p[i + 1].y + c->p[i + 2].y));
    const double n = ceil(sqrt(0.75 * most / tolerance));
    return n < 1 ? 1 : n > 256 ? 256 : (int32_t)n;
}

double tz_bezier_length(const tz_bezier *c)
{
    static const double at[3] = {0.2386191860831969, 0.6612093864662645,
                                 0.9324695142031521},
                        weight[3] = {0.4679139345726910, 0.3607615730481386,
                                     0.1713244923791704};
    double sum = 0;
    for (int part = 0; part < 4; part++)
        for (int i = 0; i < 6; i++) {
            const double x = i < 3 ? at[i] : -at[i - 3];
            const double t = (part + 0.5 + 0.5 * x) / 4;
            sum += weight[i % 3] * tz_vec2_length(tz_bezier_slope(c, t));
        }
    return sum / 8;
}

/* ---- building -------------------------------------------------------------------- */

tz_status tz_curve_add_node(tz_curve_set *s, tz_vec2 at, int32_t *id)
{
    const int32_t n = s->node.n;
    const tz_status st = tz_array_push(s->ctx, &s->node, at);
    if (st == TZ_OK)
        *id = n;
    return st;
}

static bool same_pen(const tz_curve_pen *p, const tz_curve_pen *q)
{
    return p->width == q->width && p->color == q->color && p->cap == q->cap &&
           p->join == q->join;
}

tz_status tz_curve_add_pen(tz_curve_set *s, tz_curve_pen pen, int32_t *id)
{
    for (int32_t i = 0; i < s->pen.n; i++)
        if (same_pen(&s->pen.v[i], &pen)) {
            *id = i;
            return TZ_OK;
        }
    const int32_t n = s->pen.n;
    const tz_status st = tz_array_push(s->ctx, &s->pen, pen);
    if (st == TZ_OK)
        *id = n;
    return st;
}

tz_status tz_curve_begin(tz_curve_set *s, int32_t pen)
{
    const tz_curve_path p = {.piece = s->piece.n, .pen = pen};
    return tz_array_push(s->ctx, &s->path, p);
}

static tz_status add_piece(tz_curve_set *s, tz_curve_piece p)
{
    const tz_status st = tz_array_push(s->ctx, &s->piece, p);
    if (st == TZ_OK)
        s->path.v[s->path.n - 1].pieces++;
    return st;
}

tz_status tz_curve_line(tz_curve_set *s, int32_t from, int32_t to)
{
    const tz_vec2 p = s->node.v[from];
    const tz_bezier c = tz_bezier_line(p, tz_curve_copy(&s->domain, s->node.v[to], p));
    return add_piece(
        s, (tz_curve_piece){
               .from = from, .to = to, .a = c.p[1], .b = c.p[2], .straight = true});
}

tz_status tz_curve_cubic(tz_curve_set *s, int32_t from, int32_t to, tz_vec2 a, tz_vec2 b)
{
    return add_piece(s, (tz_curve_piece){.from = from, .to = to, .a = a, .b = b});
}

/* ---- what pieces carry ------------------------------------------------------------- */

tz_bezier tz_curve_no_origin(void)
{
    const tz_vec2 none = {NAN, NAN};
    return (tz_bezier){{none, none, none, none}};
}

tz_curve_carry tz_curve_carried(const tz_curve_set *s, int32_t piece)
{
    tz_curve_carry c = {.origin = tz_curve_no_origin(),
                        .has_taper = s->taper.n > 0,
                        .has_origin = s->origin.n > 0};
    if (c.has_taper)
        c.taper = s->taper.v[piece];
    if (c.has_origin)
        c.origin = s->origin.v[piece];
    return c;
}

tz_curve_carry tz_curve_carry_part(const tz_curve_carry *c, const tz_bezier *curve,
                                   double t0, double t1)
{
    tz_curve_carry out = *c;
    if (c->has_origin)
        out.origin = tz_bezier_part(&c->origin, t0, t1);
    if (c->has_taper && c->taper.from != c->taper.to) {
        const tz_bezier head = tz_bezier_part(curve, 0, t0),
                        part = tz_bezier_part(curve, t0, t1);
        const double whole = tz_bezier_length(curve), a = tz_bezier_length(&head),
                     b = a + tz_bezier_length(&part), by = c->taper.to - c->taper.from;
        if (whole > 0) {
            out.taper.from =
                t0 > 0 ? c->taper.from + by * fmin(a / whole, 1) : c->taper.from;
            out.taper.to = t1 < 1 ? c->taper.from + by * fmin(b / whole, 1) : c->taper.to;
        }
    }
    return out;
}

tz_curve_carry tz_curve_carry_back(const tz_curve_carry *c)
{
    tz_curve_carry out = *c;
    out.taper = (tz_curve_taper){c->taper.to, c->taper.from};
    for (int i = 0; i < 4; i++)
        out.origin.p[i] = c->origin.p[3 - i];
    return out;
}

tz_status tz_curve_add_piece(tz_curve_set *s, const tz_curve_piece *p,
                             const tz_curve_carry *c)
{
    tz_status st = TZ_OK;
    if (c && c->has_taper)
        st = tz_array_push(s->ctx, &s->taper, c->taper);
    if (st == TZ_OK && c && c->has_origin)
        st = tz_array_push(s->ctx, &s->origin, c->origin);
    return st == TZ_OK ? add_piece(s, *p) : st;
}

void tz_curve_end(tz_curve_set *s, bool closed)
{
    tz_curve_path *p = &s->path.v[s->path.n - 1];
    if (p->pieces == 0) {
        s->path.n--;
        return;
    }
    p->closed = closed && s->piece.v[p->piece].from == s->piece.v[s->piece.n - 1].to;
}

tz_curve_piece tz_curve_reversed(const tz_curve_set *s, const tz_curve_piece *p)
{
    const tz_vec2 back = tz_vec2_sub(s->node.v[p->to], tz_curve_piece_end(s, p));
    tz_curve_piece r = {p->to, p->from, tz_vec2_add(p->b, back), tz_vec2_add(p->a, back),
                        p->straight};
    if (p->straight) {
        const tz_vec2 from = s->node.v[p->to];
        const tz_bezier c =
            tz_bezier_line(from, tz_curve_copy(&s->domain, s->node.v[p->from], r.b));
        r.a = c.p[1], r.b = c.p[2];
    }
    return r;
}

void tz_curve_wrap(tz_curve_set *s)
{
    const tz_vec3 size = s->domain.size;
    if (!s->domain.torus)
        return;
    for (int32_t i = 0; i < s->piece.n; i++) {
        tz_curve_piece *p = &s->piece.v[i];
        const tz_vec2 at = s->node.v[p->from], end = tz_curve_piece_end(s, p);
        const tz_vec2 by = {tz_domain_wrap_axis(at.x, size.x) - at.x,
                            tz_domain_wrap_axis(at.y, size.y) - at.y};
        p->a = tz_vec2_add(p->a, by);
        p->b = tz_vec2_add(p->b, by);
        if (p->straight) { /* its thirds to the bit, when its ends have moved */
            const tz_vec2 to = s->node.v[p->to], in = {tz_domain_wrap_axis(to.x, size.x),
                                                       tz_domain_wrap_axis(to.y, size.y)};
            const tz_bezier c =
                tz_bezier_line((tz_vec2){tz_domain_wrap_axis(at.x, size.x),
                                         tz_domain_wrap_axis(at.y, size.y)},
                               tz_curve_copy(&s->domain, in, tz_vec2_add(end, by)));
            p->a = c.p[1], p->b = c.p[2];
        }
    }
    for (int32_t i = 0; i < s->node.n; i++) {
        tz_vec2 *p = &s->node.v[i];
        p->x = tz_domain_wrap_axis(p->x, size.x);
        p->y = tz_domain_wrap_axis(p->y, size.y);
    }
}

/* ---- sets ------------------------------------------------------------------------ */

void tz_curve_set_deinit(tz_curve_set *s)
{
    tz_array_free(s->ctx, &s->node);
    tz_array_free(s->ctx, &s->piece);
    tz_array_free(s->ctx, &s->path);
    tz_array_free(s->ctx, &s->taper);
    tz_array_free(s->ctx, &s->origin);
    tz_array_free(s->ctx, &s->pen);
    tz_free(s->ctx, s->recipe);
    s->recipe = NULL;
    tz_element_set_deinit(&s->element);
}

tz_status tz_curve_set_like(tz_ctx *ctx, const tz_curve_set *from,
                            const tz_domain *domain, tz_curve_set *to)
{
    tz_status s = TZ_OK;
    tz_curve_set out = {.ctx = ctx,
                        .domain = domain ? *domain : from->domain,
                        .background = from->background,
                        .unit_mm = from->unit_mm,
                        .element = {.ctx = ctx}};
    if (from->element.kind.n > 0 || from->element.photo.n > 0 || from->element.background)
        s = tz_element_set_like(ctx, &from->element, &out.domain, &out.element);
    for (int32_t i = 0; i < from->pen.n && s == TZ_OK; i++)
        s = tz_array_push(ctx, &out.pen, from->pen.v[i]);
    if (s != TZ_OK) {
        tz_curve_set_deinit(&out);
        memset(&out, 0, sizeof out);
    }
    *to = out;
    return s;
}

static bool finite2(tz_vec2 p)
{
    return fabs(p.x) < 1e15 && fabs(p.y) < 1e15; /* false for NaN */
}

static bool equal(tz_vec2 p, tz_vec2 q) { return p.x == q.x && p.y == q.y; }

/* NULL, or what is wrong with the pieces of a path. */
static const char *path_fault(const tz_curve_set *s, const tz_curve_path *p)
{
    for (int32_t i = p->piece; i < p->piece + p->pieces; i++) {
        const tz_curve_piece *c = &s->piece.v[i];
        if (c->from < 0 || c->to < 0 || c->from >= s->node.n || c->to >= s->node.n)
            return "a piece ends at a node that does not exist";
        if (!finite2(c->a) || !finite2(c->b))
            return "a control point is not finite";
        const tz_bezier b = tz_bezier_line(s->node.v[c->from], tz_curve_piece_end(s, c));
        if (c->straight && (!equal(c->a, b.p[1]) || !equal(c->b, b.p[2])))
            return "a straight piece has control points off its thirds";
        if (i > p->piece && c[-1].to != c->from)
            return "a piece does not begin where the one before it ends";
    }
    if (p->closed && s->piece.v[p->piece].from != s->piece.v[p->piece + p->pieces - 1].to)
        return "it is closed but does not return to its first node";
    return NULL;
}

static tz_status check_paths(tz_ctx *ctx, const tz_curve_set *s, const char *name)
{
    int32_t next = 0;
    for (int32_t i = 0; i < s->path.n; i++) {
        const tz_curve_path *p = &s->path.v[i];
        const char *fault =
            p->pen < 0 || p->pen >= s->pen.n ? "its pen does not exist"
            : p->piece != next || p->pieces < 1 || p->pieces > s->piece.n - next
                ? "its pieces do not follow those of the path before it"
                : path_fault(s, p);
        if (fault)
            return tz_fail(ctx, TZ_INVALID, "%s: path %d: %s", name, i, fault);
        next += p->pieces;
    }
    if (next != s->piece.n)
        return tz_fail(ctx, TZ_INVALID, "%s: %d pieces belong to no path", name,
                       s->piece.n - next);
    return TZ_OK;
}

static tz_status check_nodes(tz_ctx *ctx, const tz_curve_set *s, const char *name)
{
    bool *used = NULL;
    tz_status st = tz_alloc_zero(ctx, &used, (size_t)s->node.n, sizeof *used);
    if (st != TZ_OK)
        return st;
    for (int32_t i = 0; i < s->piece.n; i++)
        used[s->piece.v[i].from] = used[s->piece.v[i].to] = true;
    for (int32_t i = 0; i < s->node.n && st == TZ_OK; i++)
        if (!used[i] || !finite2(s->node.v[i]))
            st = tz_fail(ctx, TZ_INVALID, "%s: node %d %s", name, i,
                         used[i] ? "is not finite" : "belongs to no piece");
    for (int32_t i = 0; i < s->node.n && st == TZ_OK && s->domain.torus; i++) {
        const tz_vec2 p = s->node.v[i];
        if (!(p.x >= 0 && p.y >= 0 && p.x < s->domain.size.x && p.y < s->domain.size.y))
            st = tz_fail(ctx, TZ_INVALID, "%s: node %d lies outside of the torus", name,
                         i);
    }
    tz_free(ctx, used);
    return st;
}

/* Tapers and origins, which are there for all pieces or for none. */
static tz_status check_shapes(tz_ctx *ctx, const tz_curve_set *s, const char *name)
{
    if ((s->taper.n && s->taper.n != s->piece.n) ||
        (s->origin.n && s->origin.n != s->piece.n))
        return tz_fail(ctx, TZ_INVALID,
                       "%s: %d widths and %d origins for %d pieces: one each, or none",
                       name, s->taper.n, s->origin.n, s->piece.n);
    for (int32_t i = 0; i < s->taper.n; i++) {
        const tz_curve_taper *t = &s->taper.v[i];
        if (!(t->from > 0 && t->to > 0 && t->from < 1e12 && t->to < 1e12))
            return tz_fail(ctx, TZ_INVALID, "%s: piece %d: widths %g, %g cannot be", name,
                           i, t->from, t->to);
    }
    for (int32_t i = 0; i < s->origin.n; i++)
        for (int k = 1; k < 4 && !isnan(s->origin.v[i].p[0].x); k++)
            if (!finite2(s->origin.v[i].p[0]) || !finite2(s->origin.v[i].p[k]))
                return tz_fail(ctx, TZ_INVALID, "%s: piece %d: its origin is no curve",
                               name, i);
    return TZ_OK;
}

tz_status tz_curve_set_check(tz_ctx *ctx, const tz_curve_set *s, const char *name)
{
    if (!(s->domain.size.x > 0) || !(s->domain.size.y > 0) ||
        !(s->domain.size.x < 1e12) || !(s->domain.size.y < 1e12))
        return tz_fail(ctx, TZ_INVALID, "%s: a domain of %g x %g has no area", name,
                       s->domain.size.x, s->domain.size.y);
    for (int32_t i = 0; i < s->pen.n; i++)
        if (!(s->pen.v[i].width > 0) || !(s->pen.v[i].width < 1e12) ||
            s->pen.v[i].cap > 2 || s->pen.v[i].join > 2)
            return tz_fail(ctx, TZ_INVALID,
                           "%s: pen %d: its width, cap or join cannot be", name, i);
    tz_status st = check_paths(ctx, s, name);
    if (st == TZ_OK)
        st = check_shapes(ctx, s, name);
    if (st == TZ_OK)
        st = check_nodes(ctx, s, name);
    if (st == TZ_OK && s->element.element.n > 0)
        st = tz_element_set_check(ctx, &s->element, name);
    return st;
}
