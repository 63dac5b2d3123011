/* SPDX-License-Identifier: Apache-2.0 */
/* Brushes. What a stroke touches, and a few bodies about it, is awake: lists, diagram and
 * steps then run over these alone, and the rest is held as it lies. */
#include "base/rng.h"
#include "fields/fill_internal.h"

#define HALO 2.0 /* mean reaches about a stroke that give way */
enum { STREAM_BRUSH = 0xf1e21 };

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

/* Distance to a stroke; along which its nearest piece runs. */
static double to_stroke(const tz_fill *f, tz_vec3 p, int32_t n, const tz_vec2 *v)
{
    double least = HUGE_VAL;
    for (int32_t i = 0; i < n; i++) {
        const tz_vec2 a = v[i], b = v[i + 1 < n ? i + 1 : i];
        const tz_vec3 e = tz_fill_vector(f, (tz_vec3){a.x, a.y, 0}, p);
        const double x = b.x - a.x, y = b.y - a.y, l = x * x + y * y;
        const double t = l > 0 ? fmin(fmax((e.x * x + e.y * y) / l, 0), 1) : 0;
        const double u = e.x - t * x, w = e.y - t * y;
        least = fmin(least, u * u + w * w);
    }
    return sqrt(least);
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

static void wake(tz_fill *f, int32_t n, const tz_vec2 *stroke, double radius)
{
    const double reach = radius + halo(f);
    if (!f->local)
        hold_all(f);
    for (int32_t i = 0; i < f->body.n; i++) {
        tz_fill_body *b = &f->body.v[i];
        if (!b->gone && !b->fixed && !b->awake)
            b->awake = to_stroke(f, f->at[b->first], n, stroke) < reach;
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
    const tz_status s = check(f, 1, &at, radius);
    if (s == TZ_OK)
        wake(f, 1, &at, radius);
    return s;
}

void tz_fill_wake_all(tz_fill *f)
{
    for (int32_t i = 0; i < f->body.n; i++)
        f->body.v[i].awake = true;
    f->local = false;
    f->stale = true, f->fresh = false;
}

tz_status tz_fill_erase(tz_fill *f, int32_t n, const tz_vec2 *stroke, double radius)
{
    tz_status s = check(f, n, stroke, radius);
    if (s != TZ_OK)
        return s;
    wake(f, n, stroke, radius);
    for (int32_t i = 0; i < f->body.n && s == TZ_OK; i++) {
        const tz_fill_body *b = &f->body.v[i];
        if (!b->gone && !b->fixed && b->awake &&
            to_stroke(f, middle(f, b), n, stroke) <= radius)
            s = tz_fill_remove(f, i);
    }
    return s;
}

/* Room for things under a stroke: the brush's area inside the domain, less what lies
 * there. */
static double room_under(const tz_fill *f, int32_t n, const tz_vec2 *stroke,
                         double radius)
{
    enum { CELLS = 96 };
    tz_vec2 lo = stroke[0], hi = stroke[0];
    double sum = 0, used = 0;
    for (int32_t i = 1; i < n; i++) {
        lo = (tz_vec2){fmin(lo.x, stroke[i].x), fmin(lo.y, stroke[i].y)};
        hi = (tz_vec2){fmax(hi.x, stroke[i].x), fmax(hi.y, stroke[i].y)};
    }
    const double w = hi.x - lo.x + 2 * radius, h = hi.y - lo.y + 2 * radius;
    for (int k = 0; k < CELLS * CELLS; k++) {
        const tz_vec3 p = {lo.x - radius + (k % CELLS + 0.5) * w / CELLS,
                           lo.y - radius + (k / CELLS + 0.5) * h / CELLS, 0};
        sum += tz_domain_contains(&f->domain, tz_domain_wrap(&f->domain, p)) &&
               to_stroke(f, p, n, stroke) <= radius;
    }
    for (int32_t i = 0; i < f->body.n; i++) {
        const tz_fill_body *b = &f->body.v[i];
        if (b->gone || to_stroke(f, middle(f, b), n, stroke) > radius)
            continue;
        const double size = b->size * tz_fill_scale(f, b->first);
        used += f->model.v[b->model].area * size * size;
    }
    return f->par.fill * sum * w * h / (CELLS * CELLS) - used;
}

/* A place on a stroke, and its direction there. */
static tz_vec2 on_stroke(int32_t n, const tz_vec2 *v, double t, tz_vec2 *way)
{
    double all = 0;
    for (int32_t i = 1; i < n; i++)
        all += hypot(v[i].x - v[i - 1].x, v[i].y - v[i - 1].y);
    double left = t * all;
    *way = (tz_vec2){1, 0};
    for (int32_t i = 1; i < n; i++) {
        const tz_vec2 d = tz_vec2_sub(v[i], v[i - 1]);
        const double l = tz_vec2_length(d);
        if (l > 0)
            *way = tz_vec2_scale(d, 1 / l);
        if (left <= l && l > 0)
            return tz_vec2_add(v[i - 1], tz_vec2_scale(*way, left));
        left -= l;
    }
    return v[n - 1];
}

tz_status tz_fill_add(tz_fill *f, int32_t n, const tz_vec2 *stroke, double radius,
                      int32_t entry, double size)
{
    tz_status s = check(f, n, stroke, radius);
    if (s == TZ_OK && (entry < -1 || entry >= f->entries))
        s = tz_fail(f->ctx, TZ_INVALID, "brush: the mix has no entry %d", entry);
    if (s == TZ_OK && (!(size > 0) || !isfinite(size)))
        s = tz_fail(f->ctx, TZ_INVALID, "brush: size %g; it must be above 0", size);
    if (s != TZ_OK)
        return s;
    wake(f, n, stroke, radius);
    double room = room_under(f, n, stroke, radius);
    for (int32_t k = 0; s == TZ_OK && k < TZ_FILL_MOST; k++) {
        tz_rng g =
            tz_rng_make(f->seed, tz_rng_stream(STREAM_BRUSH, (uint64_t)f->made, 0));
        /* along by the golden ratio, which spreads any count evenly */
        const double t = (k + 0.5) * 0.6180339887498949;
        tz_vec2 way;
        const tz_vec2 p = on_stroke(n, stroke, t - floor(t), &way);
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
        if (room < -0.5 * area) { /* one too many */
            f->n = b->first;
            f->body.n--;
            break;
        }
    }
    return s;
}

tz_status tz_fill_replace(tz_fill *f, int32_t n, const tz_vec2 *stroke, double radius,
                          int32_t entry, double size)
{
    const tz_status s = tz_fill_erase(f, n, stroke, radius);
    return s == TZ_OK ? tz_fill_add(f, n, stroke, radius, entry, size) : s;
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
