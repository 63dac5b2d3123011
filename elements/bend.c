/* SPDX-License-Identifier: Apache-2.0 */
/* Poses and the warp. With p the samples at rest (at the element's scale), q where they
 * are now, as complex numbers, and w = 1 / |p - v|^4,
 *
 *   p* = sum w p / sum w,   q* = sum w q / sum w
 *   r  = sum w conj(p - p*) (q - q*)
 *   f(v) = q* + r / |r| (v - p*)
 *
 * is the rigid motion that fits the samples near v best; it passes through all samples,
 * and beyond the last one goes on as that one is turned. The exponent 4, not 2: with 2
 * all samples have a say everywhere, and what is bent far also shrinks.
 * Its inverse of a place u is found by steps v - conj(r) / |r| (f(v) - u), from the sample
 * that is nearest to u. */
#include "elements/bend.h"

#include <string.h>

#include "elements/element_shape.h"

tz_pose tz_pose_fit(int32_t n, const tz_vec2 *from, const tz_vec2 *to,
                    const double *weight, bool scaled)
{
    tz_pose p = {.scale = 1};
    double total = 0, cosine = 0, sine = 0, square = 0;
    for (int32_t k = 0; k < n; k++) {
        const double w = weight ? weight[k] : 1;
        p.from = tz_vec2_add(p.from, tz_vec2_scale(from[k], w));
        p.to = tz_vec2_add(p.to, tz_vec2_scale(to[k], w));
        total += w;
    }
    p.from = tz_vec2_scale(p.from, 1 / total), p.to = tz_vec2_scale(p.to, 1 / total);
    for (int32_t k = 0; k < n; k++) {
        const double w = weight ? weight[k] : 1;
        const tz_vec2 a = tz_vec2_sub(from[k], p.from), b = tz_vec2_sub(to[k], p.to);
        cosine += w * tz_vec2_dot(a, b);
        sine += w * (a.x * b.y - a.y * b.x);
        square += w * tz_vec2_dot(a, a);
    }
    if (n > 1 && square > 0) {
        p.angle = atan2(sine, cosine);
        if (scaled && hypot(sine, cosine) > 0)
            p.scale = hypot(sine, cosine) / square;
    }
    return p;
}

/* ---- rest ------------------------------------------------------------------------ */

/* As elements/element_class.c lays samples. */
static tz_status find_rest(tz_ctx *ctx, const tz_element_symbol *symbol, tz_vec2 *out,
                           int32_t *n)
{
    tz_polys polys = {0};
    *n = 1;
    out[0] = (tz_vec2){0, 0};
    if (symbol->outline.n == 0)
        return TZ_OK;
    memcpy(&polys.point, &symbol->outline, sizeof polys.point);
    memcpy(&polys.part, &symbol->part, sizeof polys.part);
    tz_status s = tz_polys_axis(ctx, &polys, TZ_BEND_SAMPLES, out, n);
    if (s == TZ_OK && *n == 1)
        out[0] = (tz_vec2){0, 0};
    return s;
}

tz_status tz_bend_rest(tz_ctx *ctx, const tz_element_symbol *symbol, int32_t samples,
                       tz_vec2 *out)
{
    tz_vec2 found[TZ_BEND_SAMPLES];
    int32_t n;
    const tz_status s = find_rest(ctx, symbol, found, &n);
    if (s != TZ_OK)
        return s;
    if (n != samples)
        return tz_fail(ctx, TZ_INVALID,
                       "symbol %.60s has %d samples at rest, its element has %d",
                       symbol->id ? symbol->id : "", n, samples);
    memcpy(out, found, (size_t)n * sizeof *out);
    return TZ_OK;
}

void tz_bend_rests_deinit(tz_bend_rests *r)
{
    tz_free(r->ctx, r->samples);
    tz_free(r->ctx, r->rest);
    *r = (tz_bend_rests){0};
}

tz_status tz_bend_rests_init(tz_ctx *ctx, const tz_element_set *s, tz_bend_rests *r)
{
    const size_t n = (size_t)s->symbol.n;
    *r = (tz_bend_rests){.set = s, .ctx = ctx};
    tz_status st = tz_alloc_zero(ctx, &r->samples, n, sizeof *r->samples);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &r->rest, n * TZ_BEND_SAMPLES, sizeof *r->rest);
    if (st != TZ_OK)
        tz_bend_rests_deinit(r);
    return st;
}

/* An outline that was drawn anew may have its middle line elsewhere, which is no bend:
 * bending keeps the length, and the element's own angle is that of its samples. */
static bool belongs(const tz_element_set *s, const tz_element *e, const tz_vec2 *rest)
{
    const tz_sample *p = &s->sample.v[e->sample];
    double at_rest = 0, now = 0, cosine = 0, sine = 0;
    tz_vec2 a = {0, 0}, b = {0, 0};
    for (int32_t k = 0; k < e->samples; k++) {
        a.x += rest[k].x / e->samples, a.y += rest[k].y / e->samples;
        b.x += p[k].at.x / e->samples, b.y += p[k].at.y / e->samples;
        if (k == 0)
            continue;
        at_rest += hypot(rest[k].x - rest[k - 1].x, rest[k].y - rest[k - 1].y);
        now += hypot(p[k].at.x - p[k - 1].at.x, p[k].at.y - p[k - 1].at.y);
    }
    for (int32_t k = 0; k < e->samples; k++) {
        const double x = rest[k].x - a.x, y = rest[k].y - a.y;
        const double u = p[k].at.x - b.x, v = p[k].at.y - b.y;
        cosine += x * u + y * v, sine += x * v - y * u;
    }
    const double turn = remainder(atan2(sine, cosine) - e->angle, 2 * TZ_PI);
    return fabs(now / (at_rest * e->scale) - 1) < 0.35 && fabs(turn) < 0.6;
}

tz_status tz_bend_rests_warp(tz_bend_rests *r, int32_t i, tz_bend *b)
{
    const tz_element *e = &r->set->element.v[i];
    tz_vec2 *rest = &r->rest[(ptrdiff_t)e->symbol * TZ_BEND_SAMPLES];
    int32_t *n = &r->samples[e->symbol];
    *b = (tz_bend){0};
    if (e->samples > 1 && *n == 0) {
        tz_status s = find_rest(r->ctx, &r->set->symbol.v[e->symbol], rest, n);
        if (s != TZ_OK)
            return s;
    }
    const bool fits = e->samples > 2 && *n == e->samples && belongs(r->set, e, rest);
    return tz_bend_from(r->ctx, r->set, i, fits ? rest : NULL, b);
}

void tz_element_snap(tz_element_set *s, int32_t i, const tz_vec2 *rest, tz_shape shape)
{
    tz_element *e = &s->element.v[i];
    tz_sample *p = &s->sample.v[e->sample];
    tz_vec2 from = {0, 0}, to = {0, 0};
    double total = 0, cosine = 0, sine = 0, square = 0;
    for (int32_t k = 0; k < e->samples; k++) {
        const double w = p[k].weight;
        from = tz_vec2_add(from, tz_vec2_scale(rest[k], w));
        to.x += w * p[k].at.x, to.y += w * p[k].at.y;
        total += w;
    }
    from = tz_vec2_scale(from, 1 / total), to = tz_vec2_scale(to, 1 / total);
    for (int32_t k = 0; k < e->samples; k++) {
        const tz_vec2 a = tz_vec2_sub(rest[k], from);
        const tz_vec2 b = {p[k].at.x - to.x, p[k].at.y - to.y};
        cosine += p[k].weight * tz_vec2_dot(a, b);
        sine += p[k].weight * (a.x * b.y - a.y * b.x);
        square += p[k].weight * tz_vec2_dot(a, a);
    }
    tz_pose pose = {from, to, e->angle, e->scale};
    if (e->samples > 1 && square > 0) {
        pose.angle = atan2(sine, cosine);
        if (shape == TZ_SHAPE_SIMILARITY)
            pose.scale =
                fmin(fmax(hypot(sine, cosine) / square, e->scale / 2), 2 * e->scale);
    }
    const tz_vec2 at = tz_pose_apply(pose, (tz_vec2){0, 0});
    e->at.x = at.x, e->at.y = at.y;
    e->angle = pose.angle;
    e->radius *= pose.scale / e->scale;
    e->scale = pose.scale;
    for (int32_t k = 0; shape != TZ_SHAPE_BEND && k < e->samples; k++) {
        const tz_vec2 q = tz_pose_apply(pose, rest[k]);
        p[k].at.x = q.x, p[k].at.y = q.y;
    }
}

/* ---- making a warp --------------------------------------------------------------- */

/* Samples of the source in the exemplar, in its symbol's coordinates. */
static bool rest_of_source(const tz_element_set *from, const tz_element *e, tz_vec2 *rest)
{
    if (!from || e->source < 0 || e->source >= from->element.n)
        return false;
    const tz_element *m = &from->element.v[e->source];
    if (m->samples != e->samples || m->symbol != e->symbol)
        return false;
    const tz_pose back = {
        {m->at.x, m->at.y}, {0, 0}, -m->angle, 1 / m->scale}; /* into the symbol */
    for (int32_t k = 0; k < e->samples; k++) {
        const tz_vec3 p = from->sample.v[m->sample + k].at;
        rest[k] = tz_pose_apply(back, (tz_vec2){p.x, p.y});
    }
    return true;
}

tz_status tz_bend_from(tz_ctx *ctx, const tz_element_set *s, int32_t i,
                       const tz_vec2 *rest, tz_bend *b)
{
    const tz_element *e = &s->element.v[i];
    const size_t n = (size_t)e->samples;
    *b = (tz_bend){.scale = e->scale,
                   .angle = e->angle,
                   .radius = s->symbol.v[e->symbol].radius,
                   .ctx = ctx};
    tz_status st = tz_alloc(ctx, &b->rest, n, sizeof *b->rest);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &b->at, n, sizeof *b->at);
    if (st != TZ_OK) {
        tz_bend_deinit(b);
        return st;
    }
    b->at[0] = (tz_vec2){e->at.x, e->at.y}; /* of the plain pose */
    b->n = rest && e->samples > 1 ? e->samples : 0;
    const tz_pose own = {{0, 0}, {e->at.x, e->at.y}, e->angle, e->scale};
    for (int32_t k = 0; k < b->n; k++) {
        const tz_vec3 p = s->sample.v[e->sample + k].at;
        const tz_vec2 q = tz_pose_apply(own, rest[k]);
        b->rest[k] = rest[k];
        b->at[k] = (tz_vec2){p.x, p.y};
        b->strain = fmax(b->strain, hypot(q.x - p.x, q.y - p.y));
    }
    return TZ_OK;
}

tz_status tz_bend_init(tz_ctx *ctx, const tz_element_set *s, int32_t i,
                       const tz_element_set *from, tz_bend *b)
{
    const tz_element *e = &s->element.v[i];
    tz_vec2 *rest = NULL;
    *b = (tz_bend){0};
    tz_status st = tz_alloc(ctx, &rest, (size_t)e->samples, sizeof *rest);
    if (st != TZ_OK)
        return st;
    bool known = e->samples > 1 && rest_of_source(from, e, rest);
    if (e->samples > 1 && !known) {
        st = tz_bend_rest(NULL, &s->symbol.v[e->symbol], e->samples, rest);
        known = st == TZ_OK;
        st = st == TZ_INVALID ? TZ_OK : st; /* to have no warp is no error */
    }
    if (st == TZ_OK)
        st = tz_bend_from(ctx, s, i, known ? rest : NULL, b);
    tz_free(ctx, rest);
    return st;
}

void tz_bend_deinit(tz_bend *b)
{
    tz_free(b->ctx, b->rest);
    tz_free(b->ctx, b->at);
    *b = (tz_bend){0};
}

/* ---- the warp -------------------------------------------------------------------- */

/* Moving least squares from p (times scale) to q; *turn = r / |r|. */
static tz_vec2 warp(int32_t n, const tz_vec2 *p, const tz_vec2 *q, double scale,
                    tz_vec2 v, tz_vec2 *turn)
{
    tz_vec2 a = {0, 0}, b = {0, 0}, r = {0, 0};
    double total = 0, least = HUGE_VAL;
    for (int32_t k = 0; k < n; k++) {
        const tz_vec2 d = {p[k].x * scale - v.x, p[k].y * scale - v.y};
        least = fmin(least, tz_vec2_dot(d, d));
    }
    least = fmax(least, 1e-300);
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t k = 0; k < n; k++) {
            const tz_vec2 at = tz_vec2_scale(p[k], scale), d = tz_vec2_sub(at, v);
            /* nearest has weight 1; at a sample itself the others have nearly none */
            const double near = fmax(tz_vec2_dot(d, d), 1e-300) / least;
            const double w = 1 / (near * near);
            if (pass == 0) {
                a = tz_vec2_add(a, tz_vec2_scale(at, w));
                b = tz_vec2_add(b, tz_vec2_scale(q[k], w));
                total += w;
            } else {
                const tz_vec2 x = tz_vec2_sub(at, a), y = tz_vec2_sub(q[k], b);
                r.x += w * tz_vec2_dot(x, y);
                r.y += w * (x.x * y.y - x.y * y.x);
            }
        }
        if (pass == 0)
            a = tz_vec2_scale(a, 1 / total), b = tz_vec2_scale(b, 1 / total);
    }
    const double l = tz_vec2_length(r);
    *turn = l > 0 ? tz_vec2_scale(r, 1 / l) : (tz_vec2){1, 0};
    const tz_vec2 d = tz_vec2_sub(v, a);
    return (tz_vec2){b.x + turn->x * d.x - turn->y * d.y,
                     b.y + turn->y * d.x + turn->x * d.y};
}

static tz_pose plain_pose(const tz_bend *b)
{
    return (tz_pose){{0, 0}, b->at[0], b->angle, b->scale};
}

tz_vec2 tz_bend_apply(const tz_bend *b, tz_vec2 p)
{
    tz_vec2 turn;
    if (b->n == 0)
        return tz_pose_apply(plain_pose(b), p);
    return warp(b->n, b->rest, b->at, b->scale, tz_vec2_scale(p, b->scale), &turn);
}

tz_vec2 tz_bend_invert(const tz_bend *b, tz_vec2 p)
{
    enum { MOST_STEPS = 24 };
    tz_vec2 turn, best;
    double least = HUGE_VAL, gain = 1;
    if (b->n == 0) {
        const tz_pose w = plain_pose(b);
        return tz_pose_apply((tz_pose){w.to, w.from, -w.angle, 1 / w.scale}, p);
    }
    tz_vec2 v = {0, 0};
    for (int32_t k = 0; k < b->n; k++) { /* from the sample that is nearest */
        const tz_vec2 d = tz_vec2_sub(p, b->at[k]);
        if (tz_vec2_dot(d, d) < least)
            least = tz_vec2_dot(d, d), v = tz_vec2_scale(b->rest[k], b->scale);
    }
    least = HUGE_VAL;
    best = v;
    for (int step = 0; step < MOST_STEPS; step++) {
        const tz_vec2 e = tz_vec2_sub(warp(b->n, b->rest, b->at, b->scale, v, &turn), p);
        const double off = tz_vec2_length(e);
        if (off < least)
            least = off, best = v;
        else
            gain *= 0.5; /* it swings */
        if (off < 1e-5 * b->radius * b->scale)
            break;
        v.x -= gain * (turn.x * e.x + turn.y * e.y);
        v.y -= gain * (turn.x * e.y - turn.y * e.x);
    }
    return tz_vec2_scale(best, 1 / b->scale);
}
