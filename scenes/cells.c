/* SPDX-License-Identifier: Apache-2.0 */
/* Points of a disc, and the cells around points.
 *
 * Cells are found block by block: the points that may own a pixel of an 8 x 8 block, or
 * share a border with those which do, are gathered once from buckets, then every pixel
 * of the block looks at these few only. */
#include "scenes/rock.h"

#include <float.h>
#include <string.h>

#include "base/grid.h"
#include "scenes/noise.h"

enum { BLOCK = 8, NEAR = 14 };

tz_status tz_rock_points(tz_canvas *c, tz_rng *r, double gap, tz_vec2 from, tz_vec2 to,
                         tz_vec2 **out, int32_t *n)
{
    tz_grid g = {0};
    const double wide = to.x - from.x, high = to.y - from.y;
    const double least = sqrt(wide * high / 1e6); /* a million points at most */
    const double apart = gap > least ? gap : least;
    const int64_t tries = (int64_t)(7 * wide * high / (apart * apart)) + 8;
    *out = NULL, *n = 0;
    tz_status s = tz_grid_init(c->ctx, &g, from, (tz_vec2){wide, high}, apart, false);
    for (int64_t i = 0; s == TZ_OK && i < tries; i++) {
        const double x = tz_rng_range(r, from.x, to.x), y = tz_rng_range(r, from.y, to.y);
        int32_t other;
        if (i % 4096 == 0 && tz_ctx_cancelled(c->ctx))
            s = TZ_CANCELLED;
        else if (tz_grid_query(&g, (tz_vec2){x, y}, apart, &other, 1) == 0)
            s = tz_grid_add(c->ctx, &g, (tz_vec2){x, y}, &other);
    }
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, out, (size_t)g.point.n, sizeof **out);
    if (s == TZ_OK) {
        memcpy(*out, g.point.v, (size_t)g.point.n * sizeof **out);
        *n = g.point.n;
    }
    tz_grid_deinit(c->ctx, &g);
    return s;
}

tz_status tz_canvas_points(tz_canvas *c, tz_rng *r, double gap, double margin,
                           tz_vec2 **out, int32_t *n)
{
    return tz_rock_points(c, r, gap, (tz_vec2){-margin, -margin},
                          (tz_vec2){c->width + margin, c->height + margin}, out, n);
}

/* ---- cells ------------------------------------------------------------------------- */

typedef struct near_point {
    float x, y, w2;
    int32_t id;
} near_point;

typedef struct cells {
    const tz_vec2 *p;
    const double *weight;
    int32_t n, nx, ny;
    double side, left, top, heaviest;
    int32_t *first, *item; /* points of bucket b: item[first[b]..first[b + 1] - 1] */
    near_point *near;      /* gathered for the block */
    int32_t nears, owners; /* the first of them may own a pixel of the block */
} cells;

static int32_t bucket(const cells *s, tz_vec2 p)
{
    const int32_t i = (int32_t)((p.x - s->left) / s->side);
    const int32_t j = (int32_t)((p.y - s->top) / s->side);
    const int32_t x = i < 0 ? 0 : i >= s->nx ? s->nx - 1 : i;
    const int32_t y = j < 0 ? 0 : j >= s->ny ? s->ny - 1 : j;
    return y * s->nx + x;
}

static tz_status fill_buckets(tz_canvas *c, cells *s)
{
    double right = -DBL_MAX, bottom = -DBL_MAX;
    s->left = s->top = DBL_MAX;
    for (int32_t i = 0; i < s->n; i++) {
        s->left = fmin(s->left, s->p[i].x), right = fmax(right, s->p[i].x);
        s->top = fmin(s->top, s->p[i].y), bottom = fmax(bottom, s->p[i].y);
        if (s->weight)
            s->heaviest = fmax(s->heaviest, fabs(s->weight[i]));
    }
    const double wide = right - s->left + 1, high = bottom - s->top + 1;
    s->side = fmax(sqrt(wide * high / s->n), fmax(wide, high) / 4000);
    s->nx = (int32_t)(wide / s->side) + 1;
    s->ny = (int32_t)(high / s->side) + 1;
    const int32_t count = s->nx * s->ny;
    tz_status status =
        tz_alloc_zero(c->ctx, &s->first, (size_t)count + 2, sizeof(int32_t));
    if (status == TZ_OK)
        status = tz_alloc(c->ctx, &s->item, (size_t)s->n, sizeof(int32_t));
    if (status == TZ_OK)
        status = tz_alloc(c->ctx, &s->near, (size_t)s->n, sizeof *s->near);
    if (status != TZ_OK)
        return status;
    for (int32_t i = 0; i < s->n; i++)
        s->first[bucket(s, s->p[i]) + 2]++;
    for (int32_t b = 1; b < count + 2; b++)
        s->first[b] += s->first[b - 1];
    for (int32_t i = 0; i < s->n; i++)
        s->item[s->first[bucket(s, s->p[i]) + 1]++] = i;
    return TZ_OK;
}

/* Gathers the points within `reach` of a place. */
static void gather(cells *s, double x, double y, double reach)
{
    const int32_t x0 = (int32_t)fmax(floor((x - reach - s->left) / s->side), 0);
    const int32_t y0 = (int32_t)fmax(floor((y - reach - s->top) / s->side), 0);
    const double right = floor((x + reach - s->left) / s->side);
    const double bottom = floor((y + reach - s->top) / s->side);
    s->nears = 0;
    for (int32_t j = y0; j < s->ny && j <= bottom; j++)
        for (int32_t i = x0; i < s->nx && i <= right; i++)
            for (int32_t k = s->first[j * s->nx + i]; k < s->first[j * s->nx + i + 1];
                 k++) {
                const int32_t id = s->item[k];
                const double dx = s->p[id].x - x, dy = s->p[id].y - y;
                const double w = s->weight ? s->weight[id] : 0;
                if (dx * dx + dy * dy <= reach * reach)
                    s->near[s->nears++] =
                        (near_point){(float)dx, (float)dy, (float)(w * w), id};
            }
}

/* The two lowest powers that a pixel within `half` of the middle may have at most. */
static void low_powers(const cells *s, double half, double low[2])
{
    low[0] = low[1] = DBL_MAX;
    for (int32_t k = 0; k < s->nears; k++) {
        const near_point *q = &s->near[k];
        const double d = sqrt((double)q->x * q->x + (double)q->y * q->y) + half;
        const double power = d * d - q->w2;
        if (power < low[0])
            low[1] = low[0], low[0] = power;
        else if (power < low[1])
            low[1] = power;
    }
}

/* Moves those to the front whose least power is not above the most that one has. */
static void owners_first(cells *s, double half, double most)
{
    s->owners = 0;
    for (int32_t k = 0; k < s->nears; k++) {
        const near_point q = s->near[k];
        const double d = sqrt((double)q.x * q.x + (double)q.y * q.y) - half;
        const double power = (d > 0 ? d * d : 0) - q.w2;
        if (power > most + 1e-3 * fabs(most))
            continue;
        s->near[k] = s->near[s->owners];
        s->near[s->owners++] = q;
    }
}

/* Everything that may own a pixel of the block, and enough others to know the borders. */
static void gather_block(cells *s, double x, double y, double half)
{
    const double all = 4 * (s->side * (s->nx + s->ny) + fabs(x) + fabs(y) +
                            fabs(s->left) + fabs(s->top));
    for (double reach = 2.2 * s->side + half;; reach *= 1.35) {
        const double beyond = reach - half;
        double low[2];
        gather(s, x, y, reach);
        low_powers(s, half, low);
        if (reach > all ||
            (s->nears >= NEAR && beyond * beyond - s->heaviest * s->heaviest > low[1])) {
            owners_first(s, half, low[0]);
            return;
        }
    }
}

/* Owner of a place given from the block's middle, and the distance to its border: with
 * powers P = d^2 - w^2 the border to q is (P_q - P_own) / (2 |q - own|) away. */
static int32_t own_at(const cells *s, float x, float y, float *edge)
{
    int32_t own = 0;
    float best = FLT_MAX, least = FLT_MAX;
    for (int32_t k = 0; k < s->owners; k++) {
        const near_point *q = &s->near[k];
        const float dx = q->x - x, dy = q->y - y, power = dx * dx + dy * dy - q->w2;
        if (power < best || (power <= best && q->id < s->near[own].id))
            best = power, own = k;
    }
    const near_point *o = &s->near[own];
    for (int32_t k = 0; edge && k < s->nears; k++) {
        const near_point *q = &s->near[k];
        const float dx = q->x - x, dy = q->y - y, ox = q->x - o->x, oy = q->y - o->y;
        const float gain = dx * dx + dy * dy - q->w2 - best, apart2 = ox * ox + oy * oy;
        if (k != own && gain * gain < least * least * 4 * apart2)
            least = gain / (2 * sqrtf(apart2));
    }
    if (edge)
        *edge = least < 1e6f ? least : 1e6f;
    return o->id;
}

static void fill_block(tz_canvas *c, cells *s, const tz_vec2 *at, tz_rect b,
                       int32_t *nearest, float *edge)
{
    double x0 = DBL_MAX, x1 = -DBL_MAX, y0 = DBL_MAX, y1 = -DBL_MAX;
    for (int32_t i = 0; i < b.w * b.h; i++) {
        x0 = fmin(x0, at[i].x), x1 = fmax(x1, at[i].x);
        y0 = fmin(y0, at[i].y), y1 = fmax(y1, at[i].y);
    }
    const double mx = (x0 + x1) / 2, my = (y0 + y1) / 2;
    gather_block(s, mx, my, sqrt((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0)) / 2);
    for (int32_t i = 0; i < b.w * b.h; i++) {
        const int64_t p = (int64_t)(b.y + i / b.w) * c->width + b.x + i % b.w;
        nearest[p] = own_at(s, (float)(at[i].x - mx), (float)(at[i].y - my),
                            edge ? &edge[p] : NULL);
    }
}

/* Warped places of a block's pixels on the plane of the points. */
static void place_block(const tz_rock_plane *plane, tz_rect b, tz_vec2 *at)
{
    const uint32_t seed = tz_noise_seed(plane->seed);
    const int octaves = plane->octaves > 4 ? 4 : plane->octaves;
    for (int32_t i = 0; i < b.w * b.h; i++) {
        const double u = b.x + i % b.w + 0.5, v = b.y + i / b.w + 0.5;
        const double su = u / plane->warp_size, sv = v / plane->warp_size;
        tz_vec2 q = {u, v};
        if (plane->warp > 0) {
            float n[2];
            tz_noise_pair(seed, seed + 1, su, sv, octaves, (float)plane->gain, n);
            q.x += plane->warp * n[0];
            q.y += plane->warp * n[1];
        }
        at[i] = tz_affine_apply(plane->map, q);
    }
}

tz_status tz_rock_cells(tz_canvas *c, const tz_rock_plane *plane, const tz_vec2 *p,
                        const double *weight, int32_t n, int32_t *nearest, float *edge)
{
    cells s = {.p = p, .weight = weight, .n = n};
    if (n < 1)
        return tz_fail(c->ctx, TZ_INVALID, "cells need a point");
    tz_status status = fill_buckets(c, &s);
    for (int32_t y = 0; status == TZ_OK && y < c->height; y += BLOCK) {
        if (tz_ctx_cancelled(c->ctx))
            status = TZ_CANCELLED;
        for (int32_t x = 0; status == TZ_OK && x < c->width; x += BLOCK) {
            const tz_rect b = {x, y, x + BLOCK < c->width ? BLOCK : c->width - x,
                               y + BLOCK < c->height ? BLOCK : c->height - y};
            tz_vec2 at[BLOCK * BLOCK];
            place_block(plane, b, at);
            fill_block(c, &s, at, b, nearest, edge);
        }
    }
    tz_free(c->ctx, s.first);
    tz_free(c->ctx, s.item);
    tz_free(c->ctx, s.near);
    return status;
}

tz_status tz_canvas_cells(tz_canvas *c, const tz_vec2 *p, const double *weight, int32_t n,
                          double warp, double warp_size, int32_t *nearest, float *edge)
{
    const tz_rock_plane plane = {.map = tz_affine_identity(),
                                 .warp = warp,
                                 .warp_size = warp_size,
                                 .octaves = 3,
                                 .gain = 0.5,
                                 .seed = tz_rng_stream(c->seed, 0xCE11, (uint64_t)n)};
    return tz_rock_cells(c, &plane, p, weight, n, nearest, edge);
}
