/* SPDX-License-Identifier: Apache-2.0 */
/* Mending the junctions of thinned lines. Thinning pulls a line aside where another joins
 * it, over about its width:
 *
 *      -----.   .-----              -------------
 *            '.'          becomes         |
 *             |                           |
 *
 * Each line is cut off where it is still straight, and the pair of ends that point most
 * away from each other is joined by a cubic along their directions. The junction is where
 * the next line meets that cubic; all others go there, too. */
#include "curves/curve_centre_internal.h"

#include <string.h>

#define CUT   0.9 /* of the mean width: cut off a line */
#define STEPS 12  /* points of a cubic */
#define MOST  8   /* lines of a junction that is mended */

/* What becomes of one end of a chain. */
typedef struct mended {
    int32_t skip;     /* points that go */
    int32_t first, n; /* points that follow, outwards to the junction */
} mended;

/* An end of a chain, seen from where it is cut off. */
typedef struct stub {
    int32_t end, skip;
    tz_vec2 at, out; /* cut; unit direction towards the junction */
} stub;

static tz_vec2 point_of(const centring *c, int32_t end, int32_t i)
{
    const chain *e = &c->chain.v[end >> 1];
    return c->point.v[e->first + (end & 1 ? e->n - 1 - i : i)];
}

/* Cuts an end off; false if the chain is too short for that. */
static bool cut_end(const centring *c, int32_t end, stub *out)
{
    const chain *e = &c->chain.v[end >> 1];
    const double reach = CUT * c->width;
    const tz_vec2 tip = point_of(c, end, 0);
    int32_t i = 0, k;
    if (e->length < 4 * reach)
        return false;
    while (i < e->n - 1 && tz_vec2_length(tz_vec2_sub(point_of(c, end, i), tip)) < reach)
        i++;
    out->end = end;
    out->skip = i;
    out->at = point_of(c, end, i);
    /* two chords from there give the direction to second order */
    tz_vec2 q[2] = {out->at, out->at};
    for (int j = 0; j < 2; j++) {
        for (k = i;
             k < e->n - 1 && tz_vec2_length(tz_vec2_sub(point_of(c, end, k), out->at)) <
                                 (j + 1) * reach / 2;
             k++)
            continue;
        q[j] = point_of(c, end, k);
    }
    const tz_vec2 d = {3 * out->at.x - 4 * q[0].x + q[1].x,
                       3 * out->at.y - 4 * q[0].y + q[1].y};
    const double n = tz_vec2_length(d);
    if (!(n > 0))
        return false;
    out->out = tz_vec2_scale(d, 1 / n);
    return true;
}

/* The cubic from stub a to stub b. */
static void bridge(const stub *a, const stub *b, tz_vec2 out[STEPS + 1])
{
    const double h = tz_vec2_length(tz_vec2_sub(b->at, a->at)) / 3;
    const tz_vec2 p = a->at, q = tz_vec2_add(a->at, tz_vec2_scale(a->out, h)),
                  r = tz_vec2_add(b->at, tz_vec2_scale(b->out, h)), s = b->at;
    for (int i = 0; i <= STEPS; i++) {
        const double t = (double)i / STEPS, u = 1 - t;
        out[i] = (tz_vec2){u * u * u * p.x + 3 * u * u * t * q.x + 3 * u * t * t * r.x +
                               t * t * t * s.x,
                           u * u * u * p.y + 3 * u * u * t * q.y + 3 * u * t * t * r.y +
                               t * t * t * s.y};
    }
}

/* The point of the bridge that a stub runs into. */
static int meet(const tz_vec2 *line, const stub *s)
{
    int best = STEPS / 2;
    double least = INFINITY;
    for (int i = 1; i < STEPS; i++) {
        const tz_vec2 d = tz_vec2_sub(line[i], s->at);
        const double off = fabs(d.x * s->out.y - d.y * s->out.x);
        if (tz_vec2_dot(d, s->out) > 0 && off < least) {
            least = off;
            best = i;
        }
    }
    return best;
}

static tz_status put(centring *c, mended *m, tz_vec2 p)
{
    if (m->n == 0)
        m->first = c->point.n;
    m->n++;
    return tz_array_push(c->ctx, &c->point, p);
}

static tz_status mend_junction(centring *c, const ended *e, int32_t n, mended *out)
{
    stub s[MOST];
    tz_vec2 line[STEPS + 1];
    int a = 0, b = 1, third = -1;
    double best = INFINITY;
    tz_status st = TZ_OK;
    for (int32_t i = 0; i < n; i++)
        if (!cut_end(c, e[i].end, &s[i]))
            return TZ_OK;
    for (int i = 0; i < n; i++)
        for (int j = i + 1; j < n; j++)
            if (tz_vec2_dot(s[i].out, s[j].out) < best) {
                best = tz_vec2_dot(s[i].out, s[j].out);
                a = i, b = j;
            }
    if (best > -0.5)
        return TZ_OK; /* nothing runs on: a star */
    for (int i = 0; i < n && third < 0; i++)
        third = i != a && i != b ? i : -1;
    bridge(&s[a], &s[b], line);
    const int at = meet(line, &s[third]);
    for (int i = 1; i <= at && st == TZ_OK; i++)
        st = put(c, &out[s[a].end], line[i]);
    for (int i = STEPS - 1; i >= at && st == TZ_OK; i--)
        st = put(c, &out[s[b].end], line[i]);
    for (int32_t i = 0; i < n && st == TZ_OK; i++) {
        if (i != a && i != b) /* a point on the way, so that the end stays straight */
            st = put(c, &out[s[i].end],
                     tz_vec2_scale(tz_vec2_add(s[i].at, line[at]), 0.5));
        if (i != a && i != b && st == TZ_OK)
            st = put(c, &out[s[i].end], line[at]);
        out[s[i].end].skip = s[i].skip;
    }
    return st;
}

/* A chain with its ends mended, as points of its own. */
static tz_status rebuild(centring *c, chain *e, const mended m[2])
{
    const chain was = *e;
    const int32_t first = c->point.n;
    tz_status s = TZ_OK;
    if (m[0].n + m[1].n == 0)
        return TZ_OK;
    for (int32_t i = m[0].n - 1; i >= 0 && s == TZ_OK; i--)
        s = tz_array_push(c->ctx, &c->point, c->point.v[m[0].first + i]);
    for (int32_t i = m[0].skip; i < was.n - m[1].skip && s == TZ_OK; i++)
        s = tz_array_push(c->ctx, &c->point, c->point.v[was.first + i]);
    for (int32_t i = 0; i < m[1].n && s == TZ_OK; i++)
        s = tz_array_push(c->ctx, &c->point, c->point.v[m[1].first + i]);
    e->first = first;
    e->n = c->point.n - first;
    return s;
}

tz_status tz_centring_mend(centring *c, ended *e)
{
    const int32_t n = tz_centring_ends(c, e);
    mended *m = NULL;
    tz_status s = tz_alloc_zero(c->ctx, &m, 2 * (size_t)c->chain.n, sizeof *m);
    for (int32_t i = 0, j; i < n && s == TZ_OK; i = j) {
        for (j = i; j < n && e[j].cell == e[i].cell; j++)
            continue;
        if (j - i >= 3 && j - i <= MOST)
            s = mend_junction(c, e + i, j - i, m);
    }
    for (int32_t k = 0; k < c->chain.n && s == TZ_OK; k++)
        if (!c->chain.v[k].gone && c->chain.v[k].a >= 0)
            s = rebuild(c, &c->chain.v[k], m + 2 * (size_t)k);
    tz_free(c->ctx, m);
    return s;
}
