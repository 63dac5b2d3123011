/* SPDX-License-Identifier: Apache-2.0 */
/* Widths. Profiles across a line, a sample each half px, averaged over the neighbours
 * along it, tell its borders: on either side where the profile has fallen halfway from the
 * line's extreme to the extreme of that side, within 1.25 of the width that the scale
 * gave. A blur of deviation b leaves that halfway width w true for w > 2.4 b and widens
 * thinner lines to 2.4 b; hence for those  sqrt(w^2 - (2.4 b)^2), b = 0.6 px for the
 * camera, the pixel and the interpolation. (Steger corrects his gradient maxima in the
 * same sense; halfway points need no model of what lies on either side.) */
#include "analysis/lines_graph.h"

#include <math.h>

#define NEAR_END 0.9  /* of the width */
#define AROUND   3    /* points to either side that are averaged */
#define MOST     129  /* samples of a profile */
#define BLUR     1.44 /* 2.4 b */

typedef struct gauge {
    tz_line_graph *g;
    const float *grey;
} gauge;

static float grey_at(const gauge *j, double x, double y)
{
    const int32_t w = j->g->width, h = j->g->height;
    x = fmin(fmax(x - 0.5, 0), w - 1);
    y = fmin(fmax(y - 0.5, 0), h - 1);
    const int32_t u = (int32_t)x < w - 1 ? (int32_t)x : (w > 1 ? w - 2 : 0),
                  v = (int32_t)y < h - 1 ? (int32_t)y : (h > 1 ? h - 2 : 0);
    const float fx = (float)(x - u), fy = (float)(y - v);
    const int32_t right = w > 1, down = h > 1 ? w : 0;
    const float *p = j->grey + (ptrdiff_t)v * w + u;
    const float a = p[0] + fx * (p[right] - p[0]),
                b = p[down] + fx * (p[down + right] - p[down]);
    return a + fy * (b - a);
}

static tz_vec2 normal_at(const tz_line_point *p, int32_t n, int32_t i)
{
    const int32_t a = i > 2 ? i - 2 : 0, b = i + 2 < n ? i + 2 : n - 1;
    const tz_vec2 d = tz_vec2_sub(p[b].at, p[a].at);
    const double far = tz_vec2_length(d);
    return far > 0 ? (tz_vec2){-d.y / far, d.x / far} : (tz_vec2){0, 0};
}

/* Halfway place between the extreme at `from` and that of the side, going by `step`;
 * *depth is how far the side falls off. */
static double border(const double *v, int32_t n, int32_t from, int step, double *depth)
{
    int32_t low = from, i;
    for (i = from; i >= 0 && i < n; i += step)
        if (v[i] < v[low])
            low = i;
    const double half = 0.5 * (v[from] + v[low]);
    *depth = v[from] - v[low];
    for (i = from; i != low && v[i] > half; i += step)
        continue;
    if (i == from)
        return from;
    const double before = v[i - step], after = v[i];
    const double t = before > after ? (before - half) / (before - after) : 0;
    return i - step + step * t;
}

static void gauge_point(const gauge *j, const tz_line_chain *c, const tz_line_point *p,
                        int32_t i, tz_line_point *out, double *move)
{
    double v[MOST] = {0};
    const double reach = fmin(1.25 * p[i].width + 1.5, 0.25 * (MOST - 1));
    const int32_t half = (int32_t)ceil(2 * reach), n = 2 * half + 1;
    const int32_t a = i > AROUND ? i - AROUND : 0,
                  b = i + AROUND < c->n ? i + AROUND : c->n - 1;
    const double sign = c->light ? 1 : -1;
    for (int32_t k = a; k <= b; k++) {
        const tz_vec2 m = normal_at(p, c->n, k);
        for (int32_t s = 0; s < n; s++)
            v[s] += sign *
                    grey_at(j, p[k].at.x + 0.5 * (s - half) * m.x,
                            p[k].at.y + 0.5 * (s - half) * m.y) /
                    (b - a + 1);
    }
    int32_t top = half; /* the extreme, near to the middle */
    const int32_t slack = (int32_t)fmax(1, 0.6 * p[i].width);
    for (int32_t s = half - slack; s <= half + slack; s++)
        if (s >= 0 && s < n && v[s] > v[top])
            top = s;
    double fall[2];
    const double left = border(v, n, top, -1, &fall[0]),
                 right = border(v, n, top, 1, &fall[1]);
    const double wide = 0.5 * (right - left);
    *out = p[i];
    *move = 0;
    out->strength = (float)fmin(fall[0], fall[1]);
    if (!(wide > 0) || !(out->strength > 0))
        return;
    out->width =
        (float)(wide > 2 * BLUR
                    ? wide
                    : sqrt(fmax(wide * wide -
                                    BLUR * BLUR * fmin(1, (2 * BLUR - wide) / BLUR),
                                0.09)));
    const double off = 0.5 * (0.5 * (left + right) - half);
    const double most = 0.35 * p[i].width;
    *move = off > most ? most : off < -most ? -most : off;
}

/* Moves, the mean over a width, so that a line does not follow its borders' grain. */
static void centre(const tz_line_chain *c, const tz_line_point *p, const double *move,
                   tz_line_point *fresh)
{
    const int32_t around = (int32_t)fmax(2, c->width);
    for (int32_t i = 1; i < c->n - 1; i++) {
        const int32_t most = i < c->n - 1 - i ? i : c->n - 1 - i;
        const int32_t reach = around < most ? around : most;
        double sum = 0;
        for (int32_t k = i - reach; k <= i + reach; k++)
            sum += move[k];
        const tz_vec2 m = normal_at(p, c->n, i);
        fresh[i].at = tz_vec2_add(p[i].at, tz_vec2_scale(m, sum / (2 * reach + 1)));
    }
}

/* The step across a border: between the means of 2, 3 and 4 px to either side. */
static void gauge_border(const gauge *j, tz_line_chain *c, tz_line_point *p)
{
    double step = 0;
    for (int32_t i = 0; i < c->n; i++) {
        const tz_vec2 m = normal_at(p, c->n, i);
        double sum = 0;
        for (int k = 2; k <= 4; k++)
            sum += (grey_at(j, p[i].at.x + k * m.x, p[i].at.y + k * m.y) -
                    grey_at(j, p[i].at.x - k * m.x, p[i].at.y - k * m.y)) /
                   3;
        step += sum;
        p[i].strength = (float)fabs(sum);
    }
    tz_line_chain_measure(j->g, c);
    c->strength = fabs(step) / c->n;
}

/* Near its ends a chain runs into others, which its profiles cannot be told from: what
 * lies within about a width of an end is as wide as the chain is there, and stays. */
static void keep_ends(const tz_line_chain *c, const tz_line_point *p, double *move,
                      tz_line_point *fresh)
{
    const double reach = fmin(NEAR_END * c->width, c->length / 3);
    for (int end = 0; end < 2 && c->node[0] >= 0; end++) {
        const int step = end ? -1 : 1;
        double far = 0;
        int32_t i = end ? c->n - 1 : 0, k;
        const int32_t first = i;
        while (i + step >= 0 && i + step < c->n && far < reach) {
            far += tz_vec2_length(tz_vec2_sub(p[i + step].at, p[i].at));
            i += step;
        }
        for (k = first; k != i; k += step) {
            fresh[k].width = fresh[i].width;
            move[k] = 0;
        }
    }
}

static tz_status gauge_chain(tz_ctx *ctx, void *arg, int64_t at, int worker)
{
    const gauge *j = arg;
    tz_line_chain *c = &j->g->chain.v[at];
    tz_line_point *p = j->g->point.v + c->first, *fresh = NULL;
    double *move = NULL;
    (void)worker;
    if (c->edge) {
        gauge_border(j, c, p);
        return TZ_OK;
    }
    tz_status s = tz_alloc(ctx, &fresh, (size_t)c->n, sizeof *fresh);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &move, (size_t)c->n, sizeof *move);
    for (int32_t i = 0; i < c->n && s == TZ_OK; i++)
        gauge_point(j, c, p, i, &fresh[i], &move[i]);
    if (s == TZ_OK) {
        keep_ends(c, p, move, fresh);
        centre(c, p, move, fresh);
    }
    for (int32_t i = 0; i < c->n && s == TZ_OK; i++)
        p[i] = fresh[i];
    if (s == TZ_OK)
        tz_line_chain_measure(j->g, c);
    tz_free(ctx, fresh);
    tz_free(ctx, move);
    return s;
}

tz_status tz_line_graph_measure(tz_line_graph *g, const float *grey)
{
    gauge j = {g, grey};
    return tz_parallel_for(g->ctx, g->chain.n, gauge_chain, &j);
}

void tz_line_graph_cover(const tz_line_graph *g, double side, double more, int32_t w,
                         int32_t h, uint8_t *mask)
{
    for (int32_t i = 0; i < g->chain.n; i++)
        for (int32_t k = 0; k < g->chain.v[i].n; k++) {
            const tz_line_point *p = &g->point.v[g->chain.v[i].first + k];
            const double r = side * 0.5 * p->width + more, x0 = side * p->at.x,
                         y0 = side * p->at.y;
            for (int32_t y = (int32_t)fmax(0, floor(y0 - r)); y < h && y <= y0 + r; y++)
                for (int32_t x = (int32_t)fmax(0, floor(x0 - r)); x < w && x <= x0 + r;
                     x++)
                    if ((x + 0.5 - x0) * (x + 0.5 - x0) +
                            (y + 0.5 - y0) * (y + 0.5 - y0) <=
                        r * r)
                        mask[(ptrdiff_t)y * w + x] = 1;
        }
}
