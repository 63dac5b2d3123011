/* SPDX-License-Identifier: Apache-2.0 */
/* From shapes to things. Within a group of the document, shapes that overlap or touch are
 * one compound thing (an icon of several parts); a group that spreads over the drawing is
 * a layer and joins nothing. One of several small groups side by side is a unit: whoever
 * drew it grouped icon by icon, so parts that lie near each other are joined too. A path that stands alone falls into its subpaths, each with
 * the subpaths that lie inside it. */
#include <stdlib.h>
#include <string.h>

#include "elements/element_svg_internal.h"

/* Groups of more shapes are layers: touching is tried pair by pair. Units have few. */
enum { MOST_PARTS = 4096, UNIT_PARTS = 64, UNITS = 3 };

int32_t tz_forest_root(int32_t *up, int32_t i)
{
    while (up[i] != i)
        i = up[i] = up[up[i]];
    return i;
}

void tz_forest_join(int32_t *up, int32_t i, int32_t j)
{
    i = tz_forest_root(up, i);
    j = tz_forest_root(up, j);
    up[i > j ? i : j] = i < j ? i : j; /* the root is the first */
}

/* ---- shapes as polygons ------------------------------------------------------------ */

double tz_part_pen(const tz_part *p)
{
    return (p->look.stroke & 255) && (p->look.fill & 255) ? p->look.width / 2 : 0;
}

tz_status tz_part_polys(tz_element_reader *r, const tz_part *p, tz_affine map,
                        double tolerance, tz_polys *out)
{
    const uint8_t *verb = r->verb.v + p->verb;
    const tz_vec2 *point = r->point.v + p->point;
    if (p->look.fill & 255)
        return tz_polys_add_path(r->ctx, out, verb, p->verbs, point, map, tolerance);
    tz_polys line = {0};
    const double scale = sqrt(fabs(tz_affine_det(map)));
    tz_status s = tz_polys_add_path(r->ctx, &line, verb, p->verbs, point, map, tolerance);
    if (s == TZ_OK)
        s = tz_polys_add_stroke(r->ctx, out, &line, p->look.width * scale,
                                p->look.cap != 0);
    tz_polys_deinit(r->ctx, &line);
    return s;
}

/* ---- which pieces belong together --------------------------------------------------- */

typedef struct piece {
    tz_polys polys;
    tz_box box;
    double pen;
    int32_t verb, verbs, point, points; /* of a subpath */
} piece;

typedef struct pieces {
    piece *v;
    int32_t n;
    int32_t *up;    /* forest */
    int32_t *order; /* by left border */
} pieces;

static void pieces_free(tz_element_reader *r, pieces *p)
{
    for (int32_t i = 0; i < p->n; i++)
        tz_polys_deinit(r->ctx, &p->v[i].polys);
    tz_free(r->ctx, p->v);
    tz_free(r->ctx, p->up);
    tz_free(r->ctx, p->order);
}

static tz_status pieces_make(tz_element_reader *r, int32_t n, pieces *p)
{
    memset(p, 0, sizeof *p);
    tz_status s = tz_alloc_zero(r->ctx, &p->v, (size_t)n, sizeof *p->v);
    if (s == TZ_OK)
        s = tz_alloc(r->ctx, &p->up, (size_t)n, sizeof *p->up);
    if (s == TZ_OK)
        s = tz_alloc(r->ctx, &p->order, (size_t)n, sizeof *p->order);
    if (s == TZ_OK)
        p->n = n;
    for (int32_t i = 0; i < p->n; i++)
        p->up[i] = p->order[i] = i;
    return s;
}

static void measure(piece *p)
{
    p->box = tz_box_empty();
    for (int32_t i = 0; i < p->polys.point.n; i++)
        tz_box_add(&p->box, p->polys.point.v[i]);
}

static bool box_in(tz_box a, tz_box b)
{
    return a.x0 >= b.x0 && a.y0 >= b.y0 && a.x1 <= b.x1 && a.y1 <= b.y1;
}

/* The first point of a ring may lie on the other's border: two of three decide. */
static bool nests(const piece *in, const piece *out)
{
    const int32_t n = in->polys.point.n;
    int votes = 0;
    if (n == 0 || !box_in(in->box, out->box))
        return false;
    for (int k = 0; k < 3; k++)
        votes += tz_polys_contain(&out->polys, in->polys.point.v[(int64_t)n * k / 3]);
    return votes >= 2;
}

static bool touches(const piece *a, const piece *b)
{
    const double t =
        a->pen + b->pen + 0.02 * fmin(tz_box_diagonal(a->box), tz_box_diagonal(b->box));
    return a->box.x0 <= b->box.x1 + t && b->box.x0 <= a->box.x1 + t &&
           a->box.y0 <= b->box.y1 + t && b->box.y0 <= a->box.y1 + t &&
           tz_polys_touch(&a->polys, &b->polys, t);
}

static int by_left(const void *a, const void *b, void *all)
{
    const piece *v = all;
    const int32_t i = *(const int32_t *)a, j = *(const int32_t *)b;
    const double p = v[i].box.x0 - v[i].pen, q = v[j].box.x0 - v[j].pen;
    return p < q ? -1 : p > q ? 1 : (i > j) - (i < j);
}

/** Joins the pieces that touch, or only those that nest. A sweep from left to right:
 * each piece meets those that still reach as far. */
static void join_pieces(pieces *p, bool touching)
{
    int32_t *active = p->order; /* its front part is free as the sweep goes on */
    int32_t n = 0;
    double slack = 0;
    for (int32_t i = 0; i < p->n; i++)
        slack = fmax(slack, p->v[i].pen + 0.02 * tz_box_diagonal(p->v[i].box));
    qsort_r(p->order, (size_t)p->n, sizeof *p->order, by_left, p->v);
    for (int32_t k = 0; k < p->n; k++) {
        const int32_t j = p->order[k];
        const piece *b = &p->v[j];
        int32_t kept = 0;
        for (int32_t a = 0; a < n; a++) {
            const int32_t i = active[a];
            const piece *c = &p->v[i];
            if (c->box.x1 + c->pen + slack < b->box.x0 - b->pen)
                continue;
            active[kept++] = i;
            if (tz_forest_root(p->up, i) == tz_forest_root(p->up, j))
                continue;
            if (touching ? touches(c, b) : nests(c, b) || nests(b, c))
                tz_forest_join(p->up, i, j);
        }
        active[kept++] = j;
        n = kept;
    }
}

/* ---- things ------------------------------------------------------------------------ */

static tz_status add_thing(tz_element_reader *r, int32_t item, const tz_part *p)
{
    const tz_thing t = {.item = item,
                        .items = r->item.n - item,
                        .map = tz_affine_identity(),
                        .name = p->name,
                        .node = p->node,
                        .up = p->up,
                        .order = p->order,
                        .line = p->line};
    return tz_array_push(r->ctx, &r->thing, t);
}

static tz_status add_single(tz_element_reader *r, int32_t part)
{
    const int32_t item = r->item.n;
    tz_status s = tz_array_push(r->ctx, &r->item, part);
    const tz_part p = r->part.v[part];
    return s == TZ_OK ? add_thing(r, item, &p) : s;
}

/** A new part of the subpaths of one tree of the forest: piece[0..n-1]. */
static tz_status add_subpaths(tz_element_reader *r, const tz_part *whole, const pieces *p,
                              const int32_t *piece_of, int32_t n)
{
    tz_part part = *whole;
    tz_status s = TZ_OK;
    part.box = tz_box_empty();
    part.verb = r->verb.n;
    part.point = r->point.n;
    for (int32_t i = 0; i < n; i++)
        tz_box_join(&part.box, p->v[piece_of[i]].box);
    if (n == 1) { /* as it stands */
        const piece *one = &p->v[piece_of[0]];
        part.verb = one->verb;
        part.verbs = one->verbs;
        part.point = one->point;
        part.points = one->points;
        s = tz_array_push(r->ctx, &r->part, part);
        return s == TZ_OK ? add_single(r, r->part.n - 1) : s;
    }
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        const piece *one = &p->v[piece_of[i]];
        for (int32_t k = 0; k < one->verbs && s == TZ_OK; k++)
            s = tz_array_push(r->ctx, &r->verb, r->verb.v[one->verb + k]);
        for (int32_t k = 0; k < one->points && s == TZ_OK; k++) {
            const tz_vec2 q = r->point.v[one->point + k];
            s = tz_array_push(r->ctx, &r->point, q);
        }
    }
    part.verbs = r->verb.n - part.verb;
    part.points = r->point.n - part.point;
    if (s == TZ_OK)
        s = tz_array_push(r->ctx, &r->part, part);
    return s == TZ_OK ? add_single(r, r->part.n - 1) : s;
}

/** Cuts the part at its moves. */
static tz_status cut_subpaths(tz_element_reader *r, const tz_part *part, pieces *p)
{
    const double tolerance = fmax(tz_box_diagonal(part->box) / 4000, 1e-9);
    tz_status s = TZ_OK;
    int32_t at = part->point, k = -1;
    for (int32_t i = part->verb; i < part->verb + part->verbs; i++) {
        const uint8_t verb = r->verb.v[i];
        const int32_t n = verb == TZ_PATH_CUBIC ? 3 : verb == TZ_PATH_CLOSE ? 0 : 1;
        if (verb == TZ_PATH_MOVE) {
            k++;
            p->v[k].verb = i;
            p->v[k].point = at;
        }
        p->v[k].verbs++;
        p->v[k].points += n;
        at += n;
    }
    for (k = 0; k < p->n && s == TZ_OK; k++) {
        tz_part one = *part;
        one.verb = p->v[k].verb;
        one.verbs = p->v[k].verbs;
        one.point = p->v[k].point;
        s = tz_part_polys(r, &one, tz_affine_identity(), tolerance, &p->v[k].polys);
        measure(&p->v[k]);
    }
    return s;
}

static int by_root(const void *a, const void *b, void *up)
{
    const int32_t i = *(const int32_t *)a, j = *(const int32_t *)b;
    const int32_t p = ((const int32_t *)up)[i], q = ((const int32_t *)up)[j];
    return p < q ? -1 : p > q ? 1 : (i > j) - (i < j);
}

/** Orders the pieces by their trees; up[i] becomes the root itself. */
static void by_tree(pieces *p)
{
    for (int32_t i = 0; i < p->n; i++) {
        p->up[i] = tz_forest_root(p->up, i);
        p->order[i] = i;
    }
    qsort_r(p->order, (size_t)p->n, sizeof *p->order, by_root, p->up);
}

/** A shape that stands alone. */
static tz_status separate(tz_element_reader *r, int32_t index)
{
    const tz_part part = r->part.v[index];
    pieces p;
    int32_t moves = 0;
    for (int32_t i = 0; i < part.verbs; i++)
        moves += r->verb.v[part.verb + i] == TZ_PATH_MOVE;
    if (moves < 2)
        return add_single(r, index);
    tz_status s = pieces_make(r, moves, &p);
    if (s == TZ_OK)
        s = cut_subpaths(r, &part, &p);
    if (s == TZ_OK)
        join_pieces(&p, !(part.look.fill & 255));
    if (s == TZ_OK)
        by_tree(&p);
    for (int32_t i = 0, k; i < p.n && s == TZ_OK; i = k) {
        const int32_t root = p.up[p.order[i]];
        for (k = i; k < p.n && p.up[p.order[k]] == root;)
            k++;
        if (p.v[p.order[i]].polys.point.n > 0)
            s = add_subpaths(r, &part, &p, p.order + i, k - i);
    }
    pieces_free(r, &p);
    return s;
}

/* ---- groups ------------------------------------------------------------------------ */

/** Things of the trees of a group's parts. */
static tz_status add_trees(tz_element_reader *r, const int32_t *part, const pieces *p)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < p->n && s == TZ_OK; i++) {
        const int32_t item = r->item.n;
        if (tz_forest_root(p->up, i) != i)
            continue;
        for (int32_t k = i; k < p->n && s == TZ_OK; k++)
            if (tz_forest_root(p->up, k) == i)
                s = tz_array_push(r->ctx, &r->item, part[k]);
        const tz_part first = r->part.v[part[i]];
        if (s == TZ_OK && r->item.n - item > 1) {
            s = add_thing(r, item, &first);
        } else if (s == TZ_OK) {
            r->item.n = item;
            s = separate(r, part[i]);
        }
    }
    return s;
}

static tz_box box_of(const tz_element_reader *r, const int32_t *part, int32_t n)
{
    tz_box b = tz_box_empty();
    for (int32_t i = 0; i < n; i++)
        tz_box_join(&b, r->part.v[part[i]].box);
    return b;
}

/** Whether the group is a layer: it spreads over more than half the view both ways. */
static bool is_layer(const tz_element_reader *r, const int32_t *part, int32_t n)
{
    const tz_box b = box_of(r, part, n);
    return n > MOST_PARTS || (b.x1 - b.x0 > r->view.x / 2 && b.y1 - b.y0 > r->view.y / 2);
}

/** Whether the group could be one of many units. */
static bool is_small(const tz_element_reader *r, const tz_span *span)
{
    tz_box b = tz_box_empty();
    int32_t n = 0;
    for (int32_t i = span->first; i < span->end && n <= UNIT_PARTS; i++)
        if (!r->part.v[i].owned) {
            tz_box_join(&b, r->part.v[i].box);
            n++;
        }
    return n > 1 && n <= UNIT_PARTS && b.x1 - b.x0 < r->view.x / 4 &&
           b.y1 - b.y0 < r->view.y / 4;
}

/** Joins pieces whose boxes are no farther apart than a quarter of the whole. */
static void join_near(pieces *p, double size)
{
    const double t = size / 4;
    for (int32_t i = 0; i < p->n; i++)
        for (int32_t j = 0; j < i; j++) {
            const tz_box a = p->v[i].box, b = p->v[j].box;
            if (a.x0 <= b.x1 + t && b.x0 <= a.x1 + t && a.y0 <= b.y1 + t &&
                b.y0 <= a.y1 + t)
                tz_forest_join(p->up, i, j);
        }
}

/** Compounds of a group; *done false if it has none. */
static tz_status compound(tz_element_reader *r, const tz_span *span, bool unit,
                          bool *done)
{
    int32_t *part = NULL, n = 0;
    pieces p = {0};
    *done = false;
    tz_status s =
        tz_alloc(r->ctx, &part, (size_t)(span->end - span->first), sizeof *part);
    for (int32_t i = span->first; i < span->end && s == TZ_OK; i++)
        if (!r->part.v[i].owned)
            part[n++] = i;
    if (s != TZ_OK || n < 2 || is_layer(r, part, n))
        goto done;
    s = pieces_make(r, n, &p);
    for (int32_t i = 0; i < p.n && s == TZ_OK; i++) {
        const tz_part *q = &r->part.v[part[i]];
        const double tolerance = fmax(tz_box_diagonal(q->box) / 400, 1e-9);
        s = tz_part_polys(r, q, tz_affine_identity(), tolerance, &p.v[i].polys);
        p.v[i].pen = tz_part_pen(q);
        measure(&p.v[i]);
    }
    if (s != TZ_OK)
        goto done;
    join_pieces(&p, true);
    if (unit)
        join_near(&p, tz_box_diagonal(box_of(r, part, n)));
    for (int32_t i = 0; i < n; i++)
        *done = *done || p.up[i] != i;
    if (*done)
        s = add_trees(r, part, &p);
done:
    pieces_free(r, &p);
    tz_free(r->ctx, part);
    return s;
}

/** Parts first..end-1 with the spans first_span.. among them. */
static tz_status group(tz_element_reader *r, int32_t first, int32_t end,
                       int32_t first_span, int32_t end_span)
{
    tz_status s = TZ_OK;
    int32_t k = first_span, units = 0;
    for (int32_t j = first_span; j < end_span; j = r->span.v[j].next)
        units += is_small(r, &r->span.v[j]);
    for (int32_t i = first; i < end && s == TZ_OK;) {
        while (k < end_span && r->span.v[k].first == r->span.v[k].end)
            k = k + 1; /* empty; what is in it is empty too */
        if (k < end_span && r->span.v[k].first == i) {
            const tz_span span = r->span.v[k];
            bool done;
            s = compound(r, &span, units >= UNITS && is_small(r, &span), &done);
            if (s == TZ_OK && !done)
                s = group(r, span.first, span.end, k + 1, span.next);
            i = span.end;
            k = span.next;
        } else {
            if (!r->part.v[i].owned)
                s = separate(r, i);
            i++;
        }
    }
    return s;
}

tz_status tz_element_group(tz_element_reader *r, int32_t first_part, int32_t first_span)
{
    return group(r, first_part, r->part.n, first_span, r->span.n);
}
