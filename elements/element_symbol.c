/* SPDX-License-Identifier: Apache-2.0 */
/* Symbols: things that look alike share one.
 *
 * The map of a <use> is split into turn, scale and a rest N that no element can have
 * (mirror, skew, unequal scales): uses of one target with the same N share a symbol, in
 * the target's own frame. Shapes that are drawn out are compared by their control points:
 * those of q = z p + t (complex numbers, z = scale and turn) in the least-squares sense
 * share the symbol of the first. Candidates come from a hash of what a similarity leaves
 * unchanged: verbs, paint, the distances of a few points from their
 * centre. A symbol's own x axis lies along the long axis of its shape if it has one, so
 * that angles of different leaves compare. */
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "elements/element_color.h"
#include "elements/element_svg_internal.h"

#define SAME 0.01         /* of the radius: points that far apart are one */
#define NEAR (1.5 * SAME) /* so far apart may their distances from the centre be */
#define CELL (4 * NEAR)   /* of the hash */

enum { KEYS = 5 }; /* distances of four points, width of the pen */

/* What a symbol was made of: to compare others with. */
typedef struct proto {
    uint64_t key;   /* of verbs and paint, or of target and rest */
    double rest[4]; /* N, uses */
    tz_vec2 middle; /* of its points, and their spread */
    double spread;
    int32_t item, items;
    tz_vec2 centre; /* of its circle, in the space of its parts (after N) */
    double angle;   /* of the symbol's x axis there */
    int32_t symbol;
    int32_t next; /* in its cell of the table */
} proto;

typedef struct work {
    tz_element_reader *r;
    TZ_ARRAY(proto)
    proto;
    int32_t *head;
    uint32_t cells; /* power of two */
    tz_polys polys;
    TZ_ARRAY(tz_vec2)
    p;
    TZ_ARRAY(tz_vec2)
    q;
} work;

/* ---- making a symbol --------------------------------------------------------------- */

/** Circle about the parts of a thing, pens included. */
static tz_status measure(work *w, const tz_thing *t, tz_affine map, tz_vec2 *centre,
                         double *radius)
{
    tz_element_reader *r = w->r;
    tz_box box = tz_box_empty();
    tz_status s = TZ_OK;
    const double scale = sqrt(fabs(tz_affine_det(map)));
    for (int32_t i = 0; i < t->items; i++)
        tz_box_join(&box, r->part.v[r->item.v[t->item + i]].box);
    const double tolerance = fmax(tz_box_diagonal(box) * scale / 400, 1e-12);
    *radius = 0;
    tz_polys_clear(&w->polys);
    for (int32_t i = 0; i < t->items && s == TZ_OK; i++)
        s = tz_part_polys(r, &r->part.v[r->item.v[t->item + i]], map, tolerance,
                          &w->polys);
    if (s != TZ_OK || w->polys.point.n == 0)
        return s;
    const tz_part *only = &r->part.v[r->item.v[t->item]];
    if (t->items == 1 && tz_part_circle(r, only, map, centre, radius)) {
        if (!(only->look.fill & 255))
            *radius += only->look.width * scale / 2;
    } else {
        *radius = tz_smallest_circle(r->ctx, w->polys.point.v, w->polys.point.n, centre);
        if (*radius < 0)
            return TZ_NOMEM;
    }
    double pen = 0;
    for (int32_t i = 0; i < t->items; i++)
        pen = fmax(pen, tz_part_pen(&r->part.v[r->item.v[t->item + i]]) * scale);
    *radius += pen;
    return TZ_OK;
}

static tz_status set_outline(work *w, const tz_thing *t, tz_affine map,
                             tz_element_symbol *y)
{
    return tz_element_outline(w->r, w->r->item.v + t->item, t->items, map, y);
}

tz_status tz_element_outline(tz_element_reader *r, const int32_t *item, int32_t items,
                             tz_affine map, tz_element_symbol *y)
{
    tz_polys polys = {0};
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < items && s == TZ_OK; i++)
        s = tz_part_polys(r, &r->part.v[item[i]], map, fmax(y->radius / 50, 1e-12),
                          &polys);
    if (s != TZ_OK) {
        tz_polys_deinit(r->ctx, &polys);
        return s;
    }
    y->outline.v = polys.point.v;
    y->outline.n = polys.point.n;
    y->outline.cap = polys.point.cap;
    y->part.v = polys.part.v;
    y->part.n = polys.part.n;
    y->part.cap = polys.part.cap;
    tz_array_free(r->ctx, &polys.closed);
    return TZ_OK;
}

/** Names it after the <symbol> that is used, or by number. */
static tz_status set_id(work *w, const tz_thing *t, bool plain, tz_element_symbol *y)
{
    char text[64];
    const char *id = t->use ? tz_svg_attr(t->target, "id") : NULL;
    if (id && plain)
        return tz_strdup(w->r->ctx, id, &y->id);
    snprintf(text, sizeof text, "tz-s%d", w->r->set.symbol.n);
    return tz_strdup(w->r->ctx, text, &y->id);
}

/** Appends a symbol for the thing; p->centre, angle and symbol are set. *radius 0 if the
 * thing has no extent. */
static tz_status make_symbol(work *w, const tz_thing *t, tz_affine rest, bool plain,
                             proto *p, double *radius)
{
    tz_element_reader *r = w->r;
    tz_element_symbol y = {0};
    tz_status s = measure(w, t, rest, &p->centre, radius);
    if (s != TZ_OK || !(*radius > 0))
        return s;
    y.radius = *radius;
    const tz_moments m = tz_polys_moments(&w->polys);
    p->angle = !t->use && m.aspect > 1.25 ? m.angle : 0;
    const tz_affine turn =
        tz_affine_place(p->centre, (tz_vec2){0, 0}, -p->angle, 1, false);
    const tz_affine map = tz_affine_then(rest, turn);
    s = set_id(w, t, plain, &y);
    if (s == TZ_OK)
        s = tz_element_markup(r, r->item.v + t->item, t->items, map, y.radius, &y.markup);
    if (s == TZ_OK)
        s = set_outline(w, t, map, &y);
    if (s == TZ_OK)
        s = tz_element_words(r->ctx, t->up, t->node, &y.words);
    p->symbol = r->set.symbol.n;
    if (s == TZ_OK)
        s = tz_array_push(r->ctx, &r->set.symbol, y);
    if (s != TZ_OK) {
        tz_free(r->ctx, y.id);
        tz_free(r->ctx, y.markup);
        tz_free(r->ctx, y.words);
        tz_array_free(r->ctx, &y.outline);
        tz_array_free(r->ctx, &y.part);
    }
    return s;
}

/* ---- the table ---------------------------------------------------------------------- */

static uint64_t mix(uint64_t h, uint64_t v) { return tz_rng_stream(h, v, 0x7a); }

static tz_status insert(work *w, proto p, uint64_t cell)
{
    tz_ctx *ctx = w->r->ctx;
    int32_t *head = &w->head[cell & (w->cells - 1)];
    p.next = *head;
    tz_status s = tz_array_push(ctx, &w->proto, p);
    if (s == TZ_OK)
        *head = w->proto.n - 1;
    return s;
}

static void add_element(work *w, const tz_thing *t, const proto *p, tz_vec2 at,
                        double angle, double scale)
{
    tz_element_set *set = &w->r->set;
    angle -= floor(angle / (2 * TZ_PI) + 0.5) * 2 * TZ_PI;
    /* room has been made */
    set->element.v[set->element.n++] =
        (tz_element){.kind = 0,
                     .symbol = p->symbol,
                     .source = -1,
                     .at = {at.x, at.y, 0},
                     .angle = angle,
                     .scale = scale,
                     .radius = set->symbol.v[p->symbol].radius * scale,
                     .depth = t->order};
}

static bool same_four(const double *a, const double *b)
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2] && a[3] == b[3];
}

/* ---- uses --------------------------------------------------------------------------- */

static tz_status place_use(work *w, const tz_thing *t)
{
    const tz_affine m = t->map;
    const double scale = sqrt(fabs(tz_affine_det(m))), angle = atan2(m.b, m.a);
    const double c = cos(angle) / scale, d = sin(angle) / scale;
    double n[4] = {c * m.a + d * m.b, -d * m.a + c * m.b, c * m.c + d * m.d,
                   -d * m.c + c * m.d};
    const bool plain = fabs(n[0] - 1) < 1e-6 && fabs(n[1]) < 1e-6 && fabs(n[2]) < 1e-6 &&
                       fabs(n[3] - 1) < 1e-6;
    uint64_t key = mix((uint64_t)t->item, 1);
    if (plain)
        n[0] = n[3] = 1, n[1] = n[2] = 0;
    for (int i = 0; i < 4; i++) {
        n[i] = rint(n[i] * 1e5) / 1e5;
        key = mix(key, (uint64_t)(int64_t)rint(n[i] * 1e5));
    }
    const proto *p = NULL;
    for (int32_t i = w->head[key & (w->cells - 1)]; i >= 0 && !p; i = w->proto.v[i].next)
        if (w->proto.v[i].key == key && w->proto.v[i].item == t->item &&
            same_four(w->proto.v[i].rest, n))
            p = &w->proto.v[i];
    const tz_affine rest = {n[0], n[1], n[2], n[3], 0, 0};
    if (!p) {
        proto made = {.key = key, .item = t->item, .items = t->items, .symbol = -1};
        double radius;
        memcpy(made.rest, n, sizeof n);
        tz_status s = make_symbol(w, t, rest, plain, &made, &radius);
        if (s != TZ_OK)
            return s;
        if (!(radius > 0))
            return TZ_OK;
        s = insert(w, made, key);
        if (s != TZ_OK)
            return s;
        p = &w->proto.v[w->proto.n - 1];
    }
    const double x = p->centre.x * scale, y = p->centre.y * scale;
    const tz_vec2 at = {cos(angle) * x - sin(angle) * y + m.e,
                        sin(angle) * x + cos(angle) * y + m.f};
    add_element(w, t, p, at, angle, scale);
    return TZ_OK;
}

/* ---- drawn shapes ------------------------------------------------------------------- */

typedef struct points {
    const tz_vec2 *v;
    int32_t n;
    tz_vec2 mean;
    double spread; /* root mean square distance from the mean */
} points;

static points summed_up(const tz_vec2 *v, int32_t n)
{
    points p = {v, n, {0, 0}, 0};
    for (int32_t i = 0; i < n; i++) {
        p.mean.x += v[i].x / n;
        p.mean.y += v[i].y / n;
    }
    for (int32_t i = 0; i < n; i++) {
        const tz_vec2 d = tz_vec2_sub(v[i], p.mean);
        p.spread += tz_vec2_dot(d, d) / n;
    }
    p.spread = sqrt(p.spread);
    return p;
}

/** Key of what does not change with place, turn and scale; counts points. */
static uint64_t key_of(const tz_element_reader *r, int32_t item, int32_t items,
                       int32_t *n)
{
    uint64_t key = mix(2, (uint64_t)items);
    *n = 0;
    for (int32_t i = 0; i < items; i++) {
        const tz_part *p = &r->part.v[r->item.v[item + i]];
        const tz_look *k = &p->look;
        uint64_t verbs = 0;
        for (int32_t j = 0; j < p->verbs; j++)
            verbs = verbs * 1099511628211u + r->verb.v[p->verb + j] + 1;
        key = mix(mix(key, verbs), (uint64_t)k->fill << 32 | k->stroke);
        key = mix(key, k->rule | k->cap << 2 | k->join << 4);
        *n += p->points;
    }
    return key;
}

static void gather(const tz_element_reader *r, int32_t item, int32_t items, tz_vec2 *out)
{
    for (int32_t i = 0; i < items; i++) {
        const tz_part *p = &r->part.v[r->item.v[item + i]];
        memcpy(out, r->point.v + p->point, (size_t)p->points * sizeof *out);
        out += p->points;
    }
}

/** The points of a thing: where they lie, or gathered in `room`. */
static const tz_vec2 *points_of(const work *w, int32_t item, int32_t items, tz_vec2 *room)
{
    if (items == 1)
        return w->r->point.v + w->r->part.v[w->r->item.v[item]].point;
    gather(w->r, item, items, room);
    return room;
}

/** Distances of four points from the centre and the pen's width, in units of the spread;
 * the pen so that 2 % of it are NEAR. */
static void describe(const tz_element_reader *r, const tz_thing *t, const points *p,
                     double far[KEYS])
{
    double width = 0;
    for (int k = 0; k < KEYS - 1; k++) {
        const int32_t i = (int32_t)((int64_t)p->n * k / (KEYS - 1));
        far[k] = tz_vec2_length(tz_vec2_sub(p->v[i], p->mean)) / p->spread;
    }
    for (int32_t i = 0; i < t->items; i++)
        width = fmax(width, r->part.v[r->item.v[t->item + i]].look.width);
    far[KEYS - 1] = width > 0 ? log(width / p->spread) * NEAR / 0.02 : 0;
}

/** Whether q = z p to within a tolerance, about their means. */
static bool fits(const points *p, const points *q, tz_vec2 z, double tolerance)
{
    for (int32_t i = 0; i < p->n; i++) {
        const tz_vec2 a = tz_vec2_sub(p->v[i], p->mean),
                      b = tz_vec2_sub(q->v[i], q->mean);
        if (hypot(z.x * a.x - z.y * a.y - b.x, z.x * a.y + z.y * a.x - b.y) > tolerance)
            return false;
    }
    return true;
}

/** z with q = z p nearly. A pure shift is preferred: it leaves numbers as they are. Most
 * candidates fail at their first points, by the distance from the mean. */
static bool similar(const points *p, const points *q, tz_vec2 *z)
{
    const double scale = q->spread / p->spread;
    double re = 0, im = 0;
    for (int32_t i = 0; i < p->n; i++) {
        const tz_vec2 a = tz_vec2_sub(p->v[i], p->mean),
                      b = tz_vec2_sub(q->v[i], q->mean);
        if (fabs(scale * tz_vec2_length(a) - tz_vec2_length(b)) > 1.5 * SAME * q->spread)
            return false;
        re += a.x * b.x + a.y * b.y;
        im += a.x * b.y - a.y * b.x;
    }
    *z = (tz_vec2){1, 0};
    if (fabs(p->spread - q->spread) < SAME * q->spread &&
        fits(p, q, *z, SAME * 0.7 * q->spread))
        return true;
    const double norm = p->spread * p->spread * p->n;
    *z = (tz_vec2){re / norm, im / norm};
    return tz_vec2_length(*z) > 1e-12 && fits(p, q, *z, SAME * q->spread);
}

/** Whether pens scale along. */
static bool same_pens(const tz_element_reader *r, const proto *p, const tz_thing *t,
                      double scale)
{
    for (int32_t i = 0; i < t->items; i++) {
        const tz_look *a = &r->part.v[r->item.v[p->item + i]].look;
        const tz_look *b = &r->part.v[r->item.v[t->item + i]].look;
        if (a->fill != b->fill || a->stroke != b->stroke ||
            fabs(a->width * scale - b->width) > 0.02 * b->width)
            return false;
    }
    return true;
}

static uint64_t cell_of(uint64_t key, const int64_t at[KEYS])
{
    for (int k = 0; k < KEYS; k++)
        key = mix(key, (uint64_t)at[k]);
    return key;
}

/** A proto in one cell that the points are similar to, or NULL. */
static const proto *find_in_cell(const work *w, const tz_thing *t, uint64_t key,
                                 uint64_t cell, const points *q, tz_vec2 *z)
{
    for (int32_t i = w->head[cell & (w->cells - 1)]; i >= 0; i = w->proto.v[i].next) {
        const proto *p = &w->proto.v[i];
        if (p->key != key || p->items != t->items)
            continue;
        const points a = {points_of(w, p->item, p->items, w->p.v), q->n, p->middle,
                          p->spread};
        if (similar(&a, q, z) && same_pens(w->r, p, t, tz_vec2_length(*z)))
            return p;
    }
    return NULL;
}

/** The same in all cells that may hold one: at most two each way. */
static const proto *find_proto(const work *w, const tz_thing *t, uint64_t key,
                               const points *q, const double far[KEYS], tz_vec2 *z)
{
    int64_t lo[KEYS], hi[KEYS], at[KEYS];
    for (int k = 0; k < KEYS; k++) {
        lo[k] = (int64_t)floor((far[k] - NEAR) / CELL);
        hi[k] = (int64_t)floor((far[k] + NEAR) / CELL);
    }
    for (int m = 0; m < 1 << KEYS; m++) {
        bool twice = false;
        for (int k = 0; k < KEYS; k++) {
            at[k] = m >> k & 1 ? hi[k] : lo[k];
            twice = twice || ((m >> k & 1) && lo[k] == hi[k]);
        }
        const proto *p = twice ? NULL : find_in_cell(w, t, key, cell_of(key, at), q, z);
        if (p)
            return p;
    }
    return NULL;
}

static tz_status place_shape(work *w, const tz_thing *t)
{
    double far[KEYS];
    int32_t n;
    const uint64_t key = key_of(w->r, t->item, t->items, &n);
    tz_status s = tz_array_reserve(w->r->ctx, &w->q, n);
    if (s != TZ_OK)
        return s;
    gather(w->r, t->item, t->items, w->q.v);
    const points q = summed_up(w->q.v, n);
    if (!(q.spread > 0))
        return TZ_OK;
    describe(w->r, t, &q, far);
    s = tz_array_reserve(w->r->ctx, &w->p, n);
    if (s != TZ_OK)
        return s;
    tz_vec2 z;
    const proto *p = find_proto(w, t, key, &q, far, &z);
    if (!p) {
        proto made = {.key = key, .item = t->item, .items = t->items, .symbol = -1};
        double radius;
        int64_t at[KEYS];
        s = make_symbol(w, t, tz_affine_identity(), false, &made, &radius);
        if (s != TZ_OK || !(radius > 0))
            return s;
        made.middle = q.mean;
        made.spread = q.spread;
        for (int k = 0; k < KEYS; k++)
            at[k] = (int64_t)floor(far[k] / CELL);
        z = (tz_vec2){1, 0};
        s = insert(w, made, cell_of(key, at));
        if (s != TZ_OK)
            return s;
        p = &w->proto.v[w->proto.n - 1];
    }
    const bool round = t->items == 1 && w->r->part.v[w->r->item.v[t->item]].round &&
                       w->r->part.v[w->r->item.v[p->item]].round;
    const tz_vec2 v = tz_vec2_sub(p->centre, p->middle);
    const tz_vec2 at = {z.x * v.x - z.y * v.y + q.mean.x,
                        z.x * v.y + z.y * v.x + q.mean.y};
    add_element(w, t, p, at, round ? p->angle : p->angle + atan2(z.y, z.x),
                tz_vec2_length(z));
    return TZ_OK;
}

/* ---- all ---------------------------------------------------------------------------- */

static int by_id(const void *a, const void *b, void *symbols)
{
    const tz_element_symbol *y = symbols;
    const int32_t i = *(const int32_t *)a, j = *(const int32_t *)b;
    const int d = strcmp(y[i].id, y[j].id);
    return d ? d : (i > j) - (i < j);
}

/** Gives each symbol an id of its own. */
static tz_status part_ids(tz_element_reader *r)
{
    tz_element_symbol *y = r->set.symbol.v;
    const int32_t n = r->set.symbol.n;
    int32_t *order = NULL;
    tz_status s = tz_alloc(r->ctx, &order, (size_t)n, sizeof *order);
    bool again = s == TZ_OK;
    while (again) {
        again = false;
        for (int32_t i = 0; i < n; i++)
            order[i] = i;
        qsort_r(order, (size_t)n, sizeof *order, by_id, y);
        for (int32_t i = n - 1; i > 0 && s == TZ_OK; i--) {
            tz_element_symbol *a = &y[order[i]];
            if (strcmp(a->id, y[order[i - 1]].id) != 0)
                continue;
            const size_t k = strlen(a->id);
            s = tz_realloc(r->ctx, &a->id, k + 16, 1);
            if (s == TZ_OK)
                snprintf(a->id + k, 16, "-%d", order[i]);
            again = s == TZ_OK;
        }
    }
    tz_free(r->ctx, order);
    return s;
}

static tz_status place_all(work *w, int32_t first)
{
    tz_element_reader *r = w->r;
    int32_t kept = first;
    tz_status s = tz_array_reserve(r->ctx, &r->set.element, r->thing.n);
    for (int32_t i = first; i < r->thing.n && s == TZ_OK; i++) {
        const tz_thing t = r->thing.v[i];
        if (!(i & 1023) && tz_ctx_cancelled(r->ctx))
            s = TZ_CANCELLED;
        else
            s = t.use ? place_use(w, &t) : place_shape(w, &t);
        if (s == TZ_OK && r->set.element.n > kept)
            r->thing.v[kept++] = t; /* things and elements stay side by side */
    }
    if (s == TZ_OK)
        r->thing.n = kept;
    return s;
}

tz_status tz_element_symbols(tz_element_reader *r, int32_t first)
{
    work w = {.r = r, .cells = 1024};
    while (w.cells < (uint32_t)(r->thing.n - first) && w.cells < 1u << 21)
        w.cells *= 2;
    assert(r->set.element.n == first);
    tz_status s = tz_alloc(r->ctx, &w.head, w.cells, sizeof *w.head);
    if (s == TZ_OK) {
        memset(w.head, 255, w.cells * sizeof *w.head);
        s = place_all(&w, first);
    }
    if (s == TZ_OK)
        s = part_ids(r);
    tz_free(r->ctx, w.head);
    tz_array_free(r->ctx, &w.proto);
    tz_array_free(r->ctx, &w.p);
    tz_array_free(r->ctx, &w.q);
    tz_polys_deinit(r->ctx, &w.polys);
    return s;
}
