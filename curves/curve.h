/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curve textures: paths of straight and cubic pieces, joined where they share nodes and
 * merely crossing elsewhere, together with discrete elements. One struct serves as
 * exemplar and as output. Lengths are user units of the document, y down.
 * @source [Tu20] Sec. 3, 4.1. Deviates: pieces are cubic, which hold the paper's linear
 *   and quadratic ones exactly; every path has a pen, of which the paper says nothing */
#ifndef TZ_CURVES_CURVE_H
#define TZ_CURVES_CURVE_H

#include "elements/element.h"

/** How a path is stroked. */
typedef struct tz_curve_pen {
    double width;       /**< > 0 */
    uint32_t color;     /**< 0xrrggbbaa */
    uint32_t cap, join; /**< butt, round, square; miter, round, bevel */
} tz_curve_pen;

/** A cubic by itself. */
typedef struct tz_bezier {
    tz_vec2 p[4];
} tz_bezier;

/** Widths of the line at the ends of a piece, linear by arc length between. */
typedef struct tz_curve_taper {
    double from, to; /**< > 0, user units */
} tz_curve_taper;

/** Cubic from node to node. A straight one has its control points at the thirds.
 *
 * On a torus (set.domain.torus) nodes lie in [0, size). A piece begins at its node `from`
 * there; its control points and its end are not wrapped: it ends at the copy of node `to`
 * that is nearest to `b` (tz_curve_piece_end), which may lie outside of the rectangle. The
 * piece behind it begins anew at node `to` in the rectangle. Whoever uses tz_curve_bezier
 * gets this right; who walks along a path adds up the steps end - node. A closed path may
 * run around the torus. Documents show such paths drawn through, and shifted copies of
 * what crosses the border (marked tz:copy), so that any viewer shows a tile. */
typedef struct tz_curve_piece {
    int32_t from, to; /**< tz_curve_set.node */
    tz_vec2 a, b;     /**< control points */
    bool straight;
} tz_curve_piece;

/** Pieces one behind another: each begins at the node where the one before it ends. */
typedef struct tz_curve_path {
    int32_t piece, pieces; /**< set.piece[piece .. piece + pieces - 1], pieces > 0 */
    int32_t pen;           /**< tz_curve_set.pen */
    bool closed;           /**< the last ends where the first begins */
} tz_curve_path;

typedef struct tz_curve_set {
    tz_domain domain;
    TZ_ARRAY(tz_vec2)
    node; /**< each is an end of some piece */
    TZ_ARRAY(tz_curve_piece)
    piece; /**< in order of their paths, none left over */
    TZ_ARRAY(tz_curve_path)
    path; /**< in drawing order */
    TZ_ARRAY(tz_curve_taper)
    taper; /**< none, or one a piece; without any, lines are as wide as their pens */
    TZ_ARRAY(tz_bezier)
    origin; /**< none, or one a piece: the curve of the exemplar, in the exemplar's
                 coordinates, whose shape and pixels the piece took, run through in the
                 same direction; all NAN = of none. Without any, the set is an exemplar */
    TZ_ARRAY(tz_curve_pen)
    pen;
    tz_element_set element; /**< discrete elements, above all paths; may hold none. Its
                                 photo 0, if it has one, is the photo that the curves were
                                 found in (one px a user unit of the exemplar), its
                                 background what lies beneath the curves */
    uint32_t background;    /**< 0xrrggbbaa, aa = 0: none */
    double unit_mm;         /**< length of a user unit on paper, mm; 0 = none is known */
    char *recipe;           /**< JSON text of how it was made, owned; NULL = none */
    tz_ctx *ctx;
} tz_curve_set;

TZ_API void tz_curve_set_deinit(tz_curve_set *s); /**< takes zeroed */
/** Domain, pens, background and photos of `from`, and kinds and symbols of its elements:
 * no paths, no elements.
 * @param domain   NULL = that of `from`
 * @param[out] to  overwritten, not freed; zeroed on error
 * @return TZ_OK; TZ_NOMEM */
TZ_API tz_status tz_curve_set_like(tz_ctx *ctx, const tz_curve_set *from,
                                   const tz_domain *domain, tz_curve_set *to);
/** Checks what algorithms rely on: finite numbers, indices in range, pieces that follow
 * each other, control points of straight pieces at the thirds, no node without a piece,
 * and the elements.
 * @return TZ_OK; TZ_INVALID (names the path) */
TZ_API tz_status tz_curve_set_check(tz_ctx *ctx, const tz_curve_set *s, const char *name);

/* ---- building -------------------------------------------------------------------- */

TZ_API tz_status tz_curve_add_node(tz_curve_set *s, tz_vec2 at, int32_t *id);
/** Index of that pen; a new one if there is none. */
TZ_API tz_status tz_curve_add_pen(tz_curve_set *s, tz_curve_pen pen, int32_t *id);
/** Opens an empty path, which pieces are then appended to. */
TZ_API tz_status tz_curve_begin(tz_curve_set *s, int32_t pen);
/** On a torus to the copy of `to` nearest to `from`. */
TZ_API tz_status tz_curve_line(tz_curve_set *s, int32_t from, int32_t to);
/** @param a, b  beside node `from` as it lies, see tz_curve_piece */
TZ_API tz_status tz_curve_cubic(tz_curve_set *s, int32_t from, int32_t to, tz_vec2 a,
                                tz_vec2 b);
/** What a piece carries beside its curve. */
typedef struct tz_curve_carry {
    tz_curve_taper taper;
    tz_bezier origin;
    bool has_taper, has_origin; /**< the set has them */
} tz_curve_carry;
TZ_API tz_curve_carry tz_curve_carried(const tz_curve_set *s, int32_t piece);
/** What the part t0 .. t1 of the piece with that curve carries. */
TZ_API tz_curve_carry tz_curve_carry_part(const tz_curve_carry *c, const tz_bezier *curve,
                                          double t0, double t1);
/** What the piece carries when it is run through the other way. */
TZ_API tz_curve_carry tz_curve_carry_back(const tz_curve_carry *c);
/** Appends a piece as it is to the open path, with what it carries (NULL = nothing): all
 * pieces of a set must have the same. */
TZ_API tz_status tz_curve_add_piece(tz_curve_set *s, const tz_curve_piece *p,
                                    const tz_curve_carry *c);
/** An origin that says: of none. */
TZ_API tz_bezier tz_curve_no_origin(void);
/** Ends the path: closed if it is to be and returns to its first node; one without pieces
 * goes away. */
TZ_API void tz_curve_end(tz_curve_set *s, bool closed);

/** Brings the nodes of a torus into [0, size), control points along: so paths may be
 * built beyond its border first. Nodes that come to lie on one another stay two (see
 * tz_curve_join). Nothing on a plain domain. */
TZ_API void tz_curve_wrap(tz_curve_set *s);

/* ---- geometry of one piece ------------------------------------------------------- */

/** Copy of p nearest to `beside` on a torus; p itself on a plain domain. */
static inline tz_vec2 tz_curve_copy(const tz_domain *d, tz_vec2 p, tz_vec2 beside)
{
    if (d->torus) {
        p.x += floor((beside.x - p.x) / d->size.x + 0.5) * d->size.x;
        p.y += floor((beside.y - p.y) / d->size.y + 0.5) * d->size.y;
    }
    return p;
}
/** Where a piece ends, see there. */
static inline tz_vec2 tz_curve_piece_end(const tz_curve_set *s, const tz_curve_piece *p)
{
    return tz_curve_copy(&s->domain, s->node.v[p->to], p->b);
}
static inline tz_bezier tz_curve_bezier(const tz_curve_set *s, const tz_curve_piece *p)
{
    return (tz_bezier){{s->node.v[p->from], p->a, p->b, tz_curve_piece_end(s, p)}};
}
/** The piece as it lies on the way of its path: `by` is the way that copies have moved so
 * far (0, 0 at first; to be kept from piece to piece), and is moved on. */
static inline tz_bezier tz_curve_through(const tz_curve_set *s, const tz_curve_piece *p,
                                         tz_vec2 *by)
{
    tz_bezier c = tz_curve_bezier(s, p);
    const tz_vec2 step = {c.p[3].x - s->node.v[p->to].x, c.p[3].y - s->node.v[p->to].y};
    for (int k = 0; k < 4 && s->domain.torus; k++)
        c.p[k] = (tz_vec2){c.p[k].x + by->x, c.p[k].y + by->y};
    if (s->domain.torus)
        by->x += round(step.x / s->domain.size.x) * s->domain.size.x,
            by->y += round(step.y / s->domain.size.y) * s->domain.size.y;
    return c;
}
/** The piece run through the other way. */
TZ_API tz_curve_piece tz_curve_reversed(const tz_curve_set *s, const tz_curve_piece *p);
/** The line from p to q, control points at the thirds. */
TZ_API tz_bezier tz_bezier_line(tz_vec2 p, tz_vec2 q);
TZ_API tz_vec2 tz_bezier_at(const tz_bezier *c, double t);
/** Derivative by t. */
TZ_API tz_vec2 tz_bezier_slope(const tz_bezier *c, double t);
/** The part from t0 to t1 (0 <= t0 <= t1 <= 1). */
TZ_API tz_bezier tz_bezier_part(const tz_bezier *c, double t0, double t1);
/** How many equal steps of t keep chords within `tolerance` of the curve: 1 .. 256.
 * @source Wang 1984: n >= sqrt(d (d - 1) / 8 M / tolerance), M the largest of the second
 *   differences */
TZ_API int32_t tz_bezier_steps(const tz_bezier *c, double tolerance);
/** Length to about 1e-6 of itself for curves without cusps (Gauss-Legendre, 4 parts). */
TZ_API double tz_bezier_length(const tz_bezier *c);

#endif
