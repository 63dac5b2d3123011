/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Hand placement with undo. An edit changes one placement, and a placement's whole state
 * but its border never grows, so the journal keeps the state before and after and one
 * rule serves undo and redo of every kind of edit: placing is "removed -> there",
 * removing is "there -> removed". Slots and their borders stay when an edit is undone, so
 * ids hold for the journal's life.
 *
 * What an edit may change on the screen is where the placement showed before and where it
 * shows after, hence the union of the two boxes; the compositor's correction reaches
 * further by a finite length which only the compositor knows, so the caller grows the
 * rectangle by that. */
#include "synthesis/layout.h"

typedef struct record {
    int32_t id;
    tz_placement before, after;
} record;

struct tz_layout_edit {
    tz_layout *l;
    TZ_ARRAY(record)
    done; /* v[0 .. now - 1] can be undone, v[now .. n - 1] redone */
    int32_t now;
};

tz_status tz_layout_edit_new(tz_layout *l, tz_layout_edit **out)
{
    tz_layout_edit *e = NULL;
    tz_status st = tz_alloc_zero(l->ctx, &e, 1, sizeof *e);
    if (st)
        return st;
    e->l = l;
    *out = e;
    return TZ_OK;
}

void tz_layout_edit_free(tz_layout_edit *e)
{
    if (!e)
        return;
    tz_ctx *ctx = e->l->ctx;
    tz_array_free(ctx, &e->done);
    tz_free(ctx, e);
}

bool tz_layout_edit_can_undo(const tz_layout_edit *e) { return e->now > 0; }
bool tz_layout_edit_can_redo(const tz_layout_edit *e) { return e->now < e->done.n; }

/* ---- dirty rectangles ------------------------------------------------------------ */

static tz_rect join(tz_rect p, tz_rect q)
{
    if (tz_rect_empty(p))
        return q;
    if (tz_rect_empty(q))
        return p;
    int32_t x0 = p.x < q.x ? p.x : q.x, y0 = p.y < q.y ? p.y : q.y;
    int32_t x1 = p.x + p.w > q.x + q.w ? p.x + p.w : q.x + q.w;
    int32_t y1 = p.y + p.h > q.y + q.h ? p.y + p.h : q.y + q.h;
    return (tz_rect){x0, y0, x1 - x0, y1 - y0};
}

/** Part of the layout where a placement shows; all of it where it wraps. */
static tz_rect shown(const tz_layout *l, int32_t id)
{
    tz_rect all = {0, 0, l->width, l->height};
    if (l->place.v[id].removed)
        return (tz_rect){0};
    tz_rect box = tz_layout_box(l, id);
    tz_rect in = tz_rect_intersect(box, all);
    if (l->tile && (in.w != box.w || in.h != box.h))
        return all;
    return in;
}

/** Puts a placement into a state and reports what that touches. */
static void set(tz_layout *l, int32_t id, const tz_placement *state, tz_rect *dirty)
{
    tz_rect old = shown(l, id);
    l->place.v[id] = *state;
    *dirty = join(old, shown(l, id));
}

/* ---- the journal ----------------------------------------------------------------- */

/** Records and applies an edit; what could be redone is forgotten. */
static tz_status apply(tz_layout_edit *e, record r, tz_rect *dirty)
{
    tz_status st = tz_array_reserve(e->l->ctx, &e->done, (int64_t)e->now + 1);
    if (st)
        return st;
    e->done.v[e->now++] = r;
    e->done.n = e->now;
    set(e->l, r.id, &r.after, dirty);
    return TZ_OK;
}

/** Starts a record on an existing placement. */
static tz_status begin(const tz_layout_edit *e, int32_t id, record *r)
{
    const tz_layout *l = e->l;
    if (id < 0 || id >= l->place.n)
        return tz_fail(l->ctx, TZ_INVALID, "no placement %d: the layout has 0 to %d", id,
                       l->place.n - 1);
    if (l->place.v[id].removed)
        return tz_fail(l->ctx, TZ_INVALID, "placement %d was removed: undo that first",
                       id);
    *r = (record){.id = id, .before = l->place.v[id], .after = l->place.v[id]};
    r->after.fixed = 1;
    return TZ_OK;
}

tz_status tz_layout_edit_place(tz_layout_edit *e, int32_t source, int32_t group,
                               tz_affine map, const tz_point *border, int32_t n,
                               int32_t *id, tz_rect *dirty)
{
    tz_layout *l = e->l;
    int32_t at, points = l->border.n;
    tz_status st = tz_layout_add(l, source, group, map, border, n, &at);
    if (st)
        return st;
    record r = {.id = at, .before = l->place.v[at], .after = l->place.v[at]};
    r.before.removed = 1;
    r.before.fixed = r.after.fixed = 1;
    l->place.v[at].removed = 1; /* so that `set` sees it come */
    st = apply(e, r, dirty);
    if (st) {
        l->place.n = at;
        l->border.n = points;
        return st;
    }
    if (id)
        *id = at;
    return TZ_OK;
}

tz_status tz_layout_edit_map(tz_layout_edit *e, int32_t id, tz_affine map, tz_rect *dirty)
{
    record r = {0};
    tz_affine inverse;
    tz_status st = begin(e, id, &r);
    if (st)
        return st;
    if (!tz_affine_invert(map, &inverse))
        return tz_fail(e->l->ctx, TZ_INVALID,
                       "placement %d: its new map cannot be inverted", id);
    r.after.map = map;
    return apply(e, r, dirty);
}

tz_status tz_layout_edit_move(tz_layout_edit *e, int32_t id, tz_vec2 by, tz_rect *dirty)
{
    record r = {0};
    tz_status st = begin(e, id, &r);
    if (st)
        return st;
    tz_affine map = r.before.map;
    map.e += by.x;
    map.f += by.y;
    return tz_layout_edit_map(e, id, map, dirty);
}

/** The placement's map, then the linear map (a b c d) about its centre. */
static tz_status about_centre(tz_layout_edit *e, int32_t id, tz_affine q, tz_rect *dirty)
{
    record r = {0};
    tz_status st = begin(e, id, &r);
    if (st)
        return st;
    const tz_point *b = e->l->border.v + r.before.border;
    tz_vec2 c = {0, 0};
    for (int32_t i = 0; i < r.before.points; i++) {
        c.x += b[i].x;
        c.y += b[i].y;
    }
    c = tz_affine_apply(r.before.map, tz_vec2_scale(c, 1.0 / r.before.points));
    tz_vec2 moved = tz_affine_apply(q, c);
    q.e = c.x - moved.x;
    q.f = c.y - moved.y;
    return tz_layout_edit_map(e, id, tz_affine_then(r.before.map, q), dirty);
}

tz_status tz_layout_edit_rotate(tz_layout_edit *e, int32_t id, double angle,
                                tz_rect *dirty)
{
    double c = cos(angle), s = sin(angle);
    return about_centre(e, id, (tz_affine){c, s, -s, c, 0, 0}, dirty);
}

tz_status tz_layout_edit_scale(tz_layout_edit *e, int32_t id, double factor,
                               tz_rect *dirty)
{
    return about_centre(e, id, (tz_affine){factor, 0, 0, factor, 0, 0}, dirty);
}

tz_status tz_layout_edit_remove(tz_layout_edit *e, int32_t id, tz_rect *dirty)
{
    record r = {0};
    tz_status st = begin(e, id, &r);
    if (st)
        return st;
    r.after.removed = 1;
    return apply(e, r, dirty);
}

tz_status tz_layout_edit_undo(tz_layout_edit *e, tz_rect *dirty)
{
    if (!tz_layout_edit_can_undo(e))
        return tz_fail(e->l->ctx, TZ_INVALID, "nothing to undo");
    const record *r = &e->done.v[--e->now];
    set(e->l, r->id, &r->before, dirty);
    return TZ_OK;
}

tz_status tz_layout_edit_redo(tz_layout_edit *e, tz_rect *dirty)
{
    if (!tz_layout_edit_can_redo(e))
        return tz_fail(e->l->ctx, TZ_INVALID, "nothing to redo");
    const record *r = &e->done.v[e->now++];
    set(e->l, r->id, &r->after, dirty);
    return TZ_OK;
}
