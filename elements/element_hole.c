/* SPDX-License-Identifier: Apache-2.0 */
/* The widest empty disc between shapes, by branch and bound: the room about a place changes no faster
 * than the place moves, so a square whose middle has room f cannot hold a place with more
 * than f + half its diagonal. Squares that may hold more than the best so far are
 * quartered until they are small.
 *
 * Shapes are what their extents make of them: points on the ends of their rays stand for
 * the outline, so that room is a distance, and rays tell what lies within. Discs are
 * themselves. */
#include <stdlib.h>
#include <string.h>

#include "base/kdtree.h"
#include "elements/element_statistics.h"

enum {
    NEAREST = 16,
    MOST_SQUARES = 4000,
    SPLITS = 6,
    MANY = 20000, /* elements from which on every fourth ray does */
    SPARSE = 4
};

typedef struct square {
    double x, y, room;
} square;

typedef struct hole {
    const tz_field *f;
    tz_kdtree tree, rim; /* centres, ends of rays; on a torus with copies that reach in */
    TZ_ARRAY(float)
    point;
    TZ_ARRAY(int32_t)
    item; /* that a point is the centre of */
    TZ_ARRAY(float)
    end;
    TZ_ARRAY(square)
    open, next;
} hole;

static bool is_disc(const tz_field *f, const tz_element *e)
{
    if (e->symbol < 0 || e->symbol >= f->extents.n)
        return true;
    for (int32_t k = 0; k < TZ_EXTENT_DIRECTIONS; k++)
        if (f->extents.v[e->symbol].r[k] < 1)
            return false;
    return true;
}

static tz_status add_item(hole *h, int32_t i, double x, double y)
{
    const tz_field *f = h->f;
    const tz_element *e = f->item[i].element;
    const int32_t step = f->n > MANY ? SPARSE : 1;
    tz_status s = tz_array_push(f->ctx, &h->point, (float)x);
    if (s == TZ_OK)
        s = tz_array_push(f->ctx, &h->point, (float)y);
    if (s == TZ_OK)
        s = tz_array_push(f->ctx, &h->item, i);
    if (is_disc(f, e))
        return s;
    for (int32_t k = 0; k < TZ_EXTENT_DIRECTIONS && s == TZ_OK; k += step) {
        const double angle = e->angle + 2 * TZ_PI * k / TZ_EXTENT_DIRECTIONS;
        const double r = e->radius * f->extents.v[e->symbol].r[k];
        s = tz_array_push(f->ctx, &h->end, (float)(x + r * cos(angle)));
        if (s == TZ_OK)
            s = tz_array_push(f->ctx, &h->end, (float)(y + r * sin(angle)));
    }
    return s;
}

static tz_status plant(hole *h)
{
    const tz_field *f = h->f;
    const tz_vec3 size = f->domain.size;
    const int32_t copies = f->domain.torus ? 1 : 0;
    const double spacing = sqrt(size.x * size.y / (f->n + 1));
    const double mx = fmin(size.x, fmax(8 * spacing, 0.25 * size.x));
    const double my = fmin(size.y, fmax(8 * spacing, 0.25 * size.y));
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < f->n; i++)
        for (int32_t k = -copies; k <= copies; k++)
            for (int32_t m = -copies; m <= copies && s == TZ_OK; m++) {
                const double x = f->at[i].x + k * size.x, y = f->at[i].y + m * size.y;
                if (!f->item[i].is_void && x > -mx && x < size.x + mx && y > -my &&
                    y < size.y + my)
                    s = add_item(h, i, x, y);
            }
    if (s == TZ_OK && h->item.n > 0)
        s = tz_kdtree_init(f->ctx, &h->tree, h->point.v, h->item.n, 2);
    if (s == TZ_OK && h->end.n > 0)
        s = tz_kdtree_init(f->ctx, &h->rim, h->end.v, h->end.n / 2, 2);
    return s;
}

/* Room about a place: to the nearest outline and, on a plain domain, to the border; below
 * 0 within a shape. */
static double room_at(const hole *h, double x, double y)
{
    const tz_field *f = h->f;
    const tz_vec3 size = f->domain.size;
    double room = fmin(size.x, size.y) / 2, rim = INFINITY;
    int32_t id[NEAREST];
    float dist2[NEAREST];
    const float q[2] = {(float)x, (float)y};
    if (!f->domain.torus)
        room = fmin(fmin(x, size.x - x), fmin(y, size.y - y));
    if (h->end.n > 0 && tz_kdtree_nearest(&h->rim, q, 1, id, dist2) > 0)
        rim = sqrt((double)dist2[0]);
    const int32_t n =
        h->item.n > 0 ? tz_kdtree_nearest(&h->tree, q, NEAREST, id, dist2) : 0;
    for (int32_t k = 0; k < n; k++) {
        const tz_element *e = f->item[h->item.v[id[k]]].element;
        const double d = sqrt((double)dist2[k]);
        if (is_disc(f, e))
            room = fmin(room, d - e->radius);
        else if (d < e->radius &&
                 d < tz_extent_of(&f->extents, e,
                                  atan2(y - (double)h->point.v[2 * id[k] + 1],
                                        x - (double)h->point.v[2 * id[k]])))
            room = fmin(room, -rim);
    }
    return fmin(room, rim);
}

static int by_room(const void *a, const void *b)
{
    const square *p = a, *q = b;
    if (p->room != q->room)
        return p->room < q->room ? 1 : -1;
    if (p->y != q->y)
        return p->y < q->y ? -1 : 1;
    return (p->x > q->x) - (p->x < q->x);
}

static tz_status first_squares(hole *h, double side, double *best)
{
    const tz_vec3 size = h->f->domain.size;
    tz_status s = TZ_OK;
    for (double y = side / 2; y < size.y + side / 2; y += side)
        for (double x = side / 2; x < size.x + side / 2 && s == TZ_OK; x += side) {
            const square q = {x, y, room_at(h, x, y)};
            *best = fmax(*best, q.room);
            s = tz_array_push(h->f->ctx, &h->open, q);
        }
    return s;
}

static tz_status split(hole *h, double side, double *best)
{
    tz_status s = TZ_OK;
    /* where very many are as good as each other, some will do */
    if (h->open.n > MOST_SQUARES) {
        qsort(h->open.v, (size_t)h->open.n, sizeof *h->open.v, by_room);
        h->open.n = MOST_SQUARES;
    }
    h->next.n = 0;
    for (int32_t i = 0; i < h->open.n; i++)
        for (int32_t k = 0; k < 4 && s == TZ_OK; k++) {
            square q = {h->open.v[i].x + (k % 2 ? 0.25 : -0.25) * side,
                        h->open.v[i].y + (k / 2 ? 0.25 : -0.25) * side, 0};
            if (h->open.v[i].room + side * 0.7072 <= *best)
                break; /* best has grown since */
            q.room = room_at(h, q.x, q.y);
            *best = fmax(*best, q.room);
            if (q.room + side / 2 * 0.7072 > *best)
                s = tz_array_push(h->f->ctx, &h->next, q);
        }
    const square *old = h->open.v;
    const int32_t cap = h->open.cap;
    h->open.v = h->next.v, h->open.n = h->next.n, h->open.cap = h->next.cap;
    h->next.v = (square *)old, h->next.n = 0, h->next.cap = cap;
    return s;
}

tz_status tz_field_hole(const tz_field *f, double *radius)
{
    hole h = {.f = f};
    const tz_vec3 size = f->domain.size;
    double side = sqrt(size.x * size.y / (f->n + 4)), best = 0;
    tz_status s = plant(&h);
    /* long thin domains: no more squares than is sensible */
    side = fmax(side, fmax(size.x, size.y) / 4096);
    if (s == TZ_OK)
        s = first_squares(&h, side, &best);
    for (int k = 0; k < SPLITS && s == TZ_OK; k++, side /= 2)
        s = tz_ctx_cancelled(f->ctx) ? TZ_CANCELLED : split(&h, side, &best);
    *radius = best;
    if (h.tree.n > 0)
        tz_kdtree_deinit(&h.tree);
    if (h.rim.n > 0)
        tz_kdtree_deinit(&h.rim);
    tz_array_free(f->ctx, &h.point);
    tz_array_free(f->ctx, &h.item);
    tz_array_free(f->ctx, &h.end);
    tz_array_free(f->ctx, &h.open);
    tz_array_free(f->ctx, &h.next);
    return s;
}
