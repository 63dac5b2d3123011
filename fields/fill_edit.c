/* SPDX-License-Identifier: Apache-2.0 */
/* Brushes. What a stroke touches, and a few bodies about it, is awake: lists, diagram and
 * steps then run over these alone, and the rest is held as it lies. */
#include "base/rng.h"
#include "elements/element_shape.h"
#include "fields/fill_internal.h"

#define HALO 2.0 /* mean reaches about a stroke that give way */
enum {
    STREAM_BRUSH = 0xf1e21,
    BLOCK = 64, /* points of a stroke that are passed over together */
    PARTS = 64  /* of a piece, at most */
};

static tz_status check(tz_fill *f, int32_t n, const tz_vec2 *stroke, double radius)
{
    if (n < 1 || !(radius > 0) || !isfinite(radius))
        return tz_fail(f->ctx, TZ_INVALID,
                       "a brush needs a stroke of one point or more and a radius above 0 "
                       "(%d points, radius %g)",
                       n, radius);
    for (int32_t i = 0; i < n; i++)
        if (!isfinite(stroke[i].x) || !isfinite(stroke[i].y))
            return tz_fail(f->ctx, TZ_INVALID, "point %d of a brush is not a number", i);
    return TZ_OK;
}

/* A stroke as it is asked for: on a torus its long pieces are cut, since a place is sought
 * over the copy nearest to a piece's middle; BLOCK points each have a box about them. */
typedef struct brush {
    const tz_fill *f;
    double radius;
    TZ_ARRAY(tz_vec2)
    point;
    TZ_ARRAY(double)
    along; /* way from its beginning to each point */
    TZ_ARRAY(tz_box)
    box;
} brush;

static void brush_deinit(brush *b)
{
    tz_array_free(b->f->ctx, &b->point);
    tz_array_free(b->f->ctx, &b->along);
    tz_array_free(b->f->ctx, &b->box);
}

static tz_status brush_init(const tz_fill *f, int32_t n, const tz_vec2 *v, double radius,
                            brush *b)
{
    const double period = 0.25 * fmin(f->domain.size.x, f->domain.size.y);
    *b = (brush){.f = f, .radius = radius};
    tz_status s = tz_array_reserve(f->ctx, &b->point, n);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        const tz_vec2 d = tz_vec2_sub(v[i + 1 < n ? i + 1 : i], v[i]);
        const int32_t parts =
            f->domain.torus ? 1 + (int32_t)fmin(tz_vec2_length(d) / period, PARTS) : 1;
        for (int32_t k = 0; k < parts && s == TZ_OK; k++)
            s = tz_array_push(f->ctx, &b->point,
                              tz_vec2_add(v[i], tz_vec2_scale(d, (double)k / parts)));
    }
    double way = 0;
    for (int32_t i = 0; i < b->point.n && s == TZ_OK; i++) {
        way += i > 0 ? hypot(b->point.v[i].x - b->point.v[i - 1].x,
                             b->point.v[i].y - b->point.v[i - 1].y)
                     : 0;
        s = tz_array_push(f->ctx, &b->along, way);
    }
    for (int32_t i = 0; i < b->point.n && s == TZ_OK; i += BLOCK) {
        tz_box box = tz_box_empty();
        for (int32_t k = i; k <= i + BLOCK && k < b->point.n; k++)
            tz_box_add(&box, b->point.v[k]);
        s = tz_array_push(f->ctx, &b->box, box);
    }
    if (s != TZ_OK)
        brush_deinit(b);
    return s;
}

/* Whether a place lies within reach of a piece. */
static bool by_piece(const tz_fill *f, tz_vec2 a, tz_vec2 b, tz_vec3 p, double reach)
{
    const double x = b.x - a.x, y = b.y - a.y, l = x * x + y * y;
    const tz_vec3 e = tz_fill_vector(f, (tz_vec3){a.x + x / 2, a.y + y / 2, 0}, p);
    const double t = l > 0 ? fmin(fmax((e.x * x + e.y * y) / l, -0.5), 0.5) : 0;
    const double u = e.x - t * x, w = e.y - t * y;
    return u * u + w * w <= reach * reach;
}

/* Whether a place lies within reach of a stroke. */
static bool by_stroke(const brush *b, tz_vec3 p, double reach)
{
    for (int32_t k = 0; k < b->box.n; k++) {
        const tz_box *o = &b->box.v[k];
        const tz_vec3 e = tz_fill_vector(
            b->f, (tz_vec3){(o->x0 + o->x1) / 2, (o->y0 + o->y1) / 2, 0}, p);
        if (fabs(e.x) - (o->x1 - o->x0) / 2 > reach ||
            fabs(e.y) - (o->y1 - o->y0) / 2 > reach)
            continue;
        const int32_t last = b->point.n - 1, from = k * BLOCK;
        for (int32_t i = from; i < from + BLOCK && i <= last; i++)
            if (by_piece(b->f, b->point.v[i], b->point.v[i < last ? i + 1 : i], p, reach))
                return true;
    }
    return false;
}

/* Middle of a body's discs. */
static tz_vec3 middle(const tz_fill *f, const tz_fill_body *b)
{
    tz_vec3 m = {0, 0, 0};
    for (int32_t k = b->first; k < b->first + b->n; k++)
        m.x += f->at[k].x / b->n, m.y += f->at[k].y / b->n;
    return m;
}

static double halo(const tz_fill *f)
{
    double sum = 0;
    for (int32_t k = 0; k < f->entries; k++)
        sum += f->model.v[k].reach * f->model.v[k].size[1] / f->entries;
    return HALO * sum;
}

static void hold_all(tz_fill *f)
{
    for (int32_t i = 0; i < f->body.n; i++)
        f->body.v[i].awake = false;
    f->local = true;
    f->stale = true;
    f->known = f->known && f->fresh;
}

static void wake(tz_fill *f, const brush *brush)
{
    const double reach = brush->radius + halo(f);
    if (!f->local)
        hold_all(f);
    for (int32_t i = 0; i < f->body.n; i++) {
        tz_fill_body *b = &f->body.v[i];
        if (!b->gone && !b->fixed && !b->awake)
            b->awake = by_stroke(brush, f->at[b->first], reach);
    }
    f->stale = true;
}

void tz_fill_hold(tz_fill *f) { hold_all(f); }

tz_status tz_fill_remove(tz_fill *f, int32_t body)
{
    tz_fill_body *b = &f->body.v[body];
    tz_status s = tz_array_reserve(f->ctx, &f->left, (int64_t)f->left.n + b->n);
    for (int32_t k = b->first; k < b->first + b->n && s == TZ_OK; k++)
        f->left.v[f->left.n++] = k;
    if (s == TZ_OK) {
        b->gone = true;
        f->stale = true, f->fresh = false;
    }
    return s;
}

tz_status tz_fill_wake(tz_fill *f, tz_vec2 at, double radius)
{
    brush b;
    tz_status s = check(f, 1, &at, radius);
    if (s == TZ_OK)
        s = brush_init(f, 1, &at, radius, &b);
    if (s != TZ_OK)
        return s;
    wake(f, &b);
    brush_deinit(&b);
    return s;
}

void tz_fill_wake_all(tz_fill *f)
{
    for (int32_t i = 0; i < f->body.n; i++)
        f->body.v[i].awake = true;
    f->local = false;
    f->stale = true, f->fresh = false;
}

static tz_status erase(tz_fill *f, const brush *brush)
{
    tz_status s = TZ_OK;
    wake(f, brush);
    for (int32_t i = 0; i < f->body.n && s == TZ_OK; i++) {
        const tz_fill_body *b = &f->body.v[i];
        if (!b->gone && !b->fixed && b->awake &&
            by_stroke(brush, middle(f, b), brush->radius))
            s = tz_fill_remove(f, i);
    }
    return s;
}

tz_status tz_fill_erase(tz_fill *f, int32_t n, const tz_vec2 *stroke, double radius)
{
    brush b;
    tz_status s = check(f, n, stroke, radius);
    if (s == TZ_OK)
        s = brush_init(f, n, stroke, radius, &b);
    if (s != TZ_OK)
        return s;
    s = erase(f, &b);
    brush_deinit(&b);
    return s;
}

/* Where a stroke may be: its box and its radius, no more than the domain, or one period. */
static tz_box box_of(const brush *b)
{
    const tz_domain *d = &b->f->domain;
    const double x = d->size.x, y = d->size.y, r = b->radius;
    tz_box all = tz_box_empty();
    for (int32_t i = 0; i < b->point.n; i++)
        tz_box_add(&all, b->point.v[i]);
    if (!d->torus)
        return (tz_box){fmax(all.x0 - r, 0), fmax(all.y0 - r, 0), fmin(all.x1 + r, x),
                        fmin(all.y1 + r, y)};
    if (!(all.x1 - all.x0 + 2 * r < x))
        all.x0 = r, all.x1 = x - r;
    if (!(all.y1 - all.y0 + 2 * r < y))
        all.y0 = r, all.y1 = y - r;
    return (tz_box){all.x0 - r, all.y0 - r, all.x1 + r, all.y1 + r};
}

/* Room for things under a stroke: the brush's area inside the domain, less what lies
 * there, if that stays. */
static double room_under(const tz_fill *f, const brush *brush, bool stays)
{
    enum { CELLS = 96 };
    const tz_box box = box_of(brush);
    const double w = fmax(box.x1 - box.x0, 0), h = fmax(box.y1 - box.y0, 0);
    double sum = 0, used = 0;
    for (int k = 0; k < CELLS * CELLS && w > 0 && h > 0; k++) {
        const tz_vec3 p = {box.x0 + (k % CELLS + 0.5) * w / CELLS,
                           box.y0 + (k / CELLS + 0.5) * h / CELLS, 0};
        sum += tz_domain_contains(&f->domain, tz_domain_wrap(&f->domain, p)) &&
               by_stroke(brush, p, brush->radius);
    }
    for (int32_t i = 0; i < f->body.n && stays; i++) {
        const tz_fill_body *b = &f->body.v[i];
        if (b->gone || !by_stroke(brush, middle(f, b), brush->radius))
            continue;
        const double size = b->size * tz_fill_scale(f, b->first);
        used += f->model.v[b->model].area * size * size;
    }
    return f->par.fill * sum * w * h / (CELLS * CELLS) - used;
}

/* A place on a stroke at a share of its length, and its direction there. */
static tz_vec2 on_stroke(const brush *b, double t, tz_vec2 *way)
{
    const int32_t n = b->point.n;
    const double left = t * b->along.v[n - 1];
    int32_t lo = 0, hi = n - 1; /* the last point that lies no farther, and has length */
    while (lo + 1 < hi) {
        const int32_t mid = (lo + hi) / 2;
        if (b->along.v[mid] <= left)
            lo = mid;
        else
            hi = mid;
    }
    const tz_vec2 d = tz_vec2_sub(b->point.v[hi], b->point.v[lo]);
    const double l = tz_vec2_length(d);
    *way = l > 0 ? tz_vec2_scale(d, 1 / l) : (tz_vec2){1, 0};
    return tz_vec2_add(b->point.v[lo], tz_vec2_scale(*way, left - b->along.v[lo]));
}

/* Whether so much room is for no more than may be. */
static tz_status check_room(tz_fill *f, int32_t entry, double size, double room)
{
    double area = 0, share = 0;
    for (int32_t k = 0; k < f->entries; k++) {
        const tz_fill_model *m = &f->model.v[k];
        const double w = entry < 0 ? m->share : k == entry;
        area += w * m->area * m->size[0] * m->size[0], share += w;
    }
    const double count = room / (area / share * size * size);
    return !(count > TZ_FILL_MOST - f->body.n)
               ? TZ_OK
               : tz_fail(f->ctx, TZ_LIMIT,
                         "brush: %.3g elements would fill it; take larger ones, or a "
                         "smaller brush",
                         count);
}

static tz_status add(tz_fill *f, const brush *brush, int32_t entry, double size)
{
    const int32_t n = brush->point.n, bodies = f->body.n, samples = f->n;
    const double radius = brush->radius;
    double room = room_under(f, brush, true);
    tz_status s = TZ_OK;
    for (int32_t k = 0; s == TZ_OK && k < TZ_FILL_MOST; k++) {
        tz_rng g =
            tz_rng_make(f->seed, tz_rng_stream(STREAM_BRUSH, (uint64_t)f->made, 0));
        /* along by the golden ratio, which spreads any count evenly */
        const double t = (k + 0.5) * 0.6180339887498949;
        tz_vec2 way;
        const tz_vec2 p = on_stroke(brush, t - floor(t), &way);
        const double off = radius * (2 * tz_rng_unit(&g) - 1),
                     along = n > 1 ? 0 : radius * (2 * tz_rng_unit(&g) - 1);
        const tz_vec3 at = {p.x - way.y * off + way.x * along,
                            p.y + way.x * off + way.y * along, 0};
        int32_t body;
        s = tz_fill_new_body(f, entry, tz_domain_wrap(&f->domain, at), &body);
        if (s != TZ_OK)
            break;
        const tz_fill_body *b = &f->body.v[body];
        tz_fill_put(f, body, tz_domain_wrap(&f->domain, at), atan2(way.y, way.x), size);
        const double area = f->model.v[b->model].area * b->size * b->size * size * size;
        room -= area;
        if (!(room >= -0.5 * area)) { /* one too many */
            f->n = b->first;
            f->body.n--;
            break;
        }
    }
    if (s != TZ_OK) /* all or nothing */
        f->body.n = bodies, f->n = samples;
    return s;
}

/* What erases first, if wanted, then adds. */
static tz_status paint(tz_fill *f, int32_t n, const tz_vec2 *stroke, double radius,
                       int32_t entry, double size, bool clear)
{
    brush b;
    tz_status s = check(f, n, stroke, radius);
    if (s == TZ_OK && (entry < -1 || entry >= f->entries))
        s = tz_fail(f->ctx, TZ_INVALID, "brush: the mix has no entry %d", entry);
    if (s == TZ_OK && (!(size > 0) || !isfinite(size)))
        s = tz_fail(f->ctx, TZ_INVALID, "brush: size %g; it must be above 0", size);
    if (s == TZ_OK)
        s = brush_init(f, n, stroke, radius, &b);
    if (s != TZ_OK)
        return s;
    wake(f, &b);
    s = check_room(f, entry, size, room_under(f, &b, !clear));
    if (s == TZ_OK && clear)
        s = erase(f, &b);
    if (s == TZ_OK)
        s = add(f, &b, entry, size);
    brush_deinit(&b);
    return s;
}

tz_status tz_fill_add(tz_fill *f, int32_t n, const tz_vec2 *stroke, double radius,
                      int32_t entry, double size)
{
    return paint(f, n, stroke, radius, entry, size, false);
}

tz_status tz_fill_replace(tz_fill *f, int32_t n, const tz_vec2 *stroke, double radius,
                          int32_t entry, double size)
{
    return paint(f, n, stroke, radius, entry, size, true);
}

tz_status tz_fill_settle(tz_fill *f, int32_t iterations)
{
    tz_status s = tz_fill_iterate(f, iterations, NULL);
    if (s == TZ_OK && f->par.repair)
        s = tz_fill_repair(f);
    if (s == TZ_OK)
        s = tz_fill_diagram(f);
    if (s == TZ_OK)
        hold_all(f);
    return s;
}
