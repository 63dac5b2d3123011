/* SPDX-License-Identifier: Apache-2.0 */
/* Blend of strips and ground: the screened Poisson equation of compose_blend.c, on the same
 * grids and with the same steps. There a place belongs to a placement, whose one map tells
 * what any other place would show. Here each node has a map of its own, and what it would
 * show elsewhere follows from the map's derivative. Two nodes belong together where each of
 * them tells the other's place in the photo; all else are seams:
 *
 *     J_nm = 1/2 [(s_n - s_m)(n) + (s_n - s_m)(m)],   s_n(m) = photo(u_n + du_n (m - n))
 *
 * Pixels next to a seam also mix what either side shows there, within TZ_FADE px. */
#include <string.h>

#include "synthesis/curve_strip_internal.h"

enum { FADE = 3, TAPS = 9 };

static const int32_t tap[TAPS][2] = {{0, 0},  {-3, 0}, {3, 0},   {0, -3}, {0, 3},
                                     {-2, 2}, {2, 2},  {-2, -2}, {2, -2}};

/* ---- maps ------------------------------------------------------------------------------ */

static inline tz_vec2 shows_at(const tz_strip_map *m, double dx, double dy)
{
    return (tz_vec2){m->u + (double)m->f[0] * dx + (double)m->f[1] * dy,
                     m->v + (double)m->f[2] * dx + (double)m->f[3] * dy};
}

/* Whether b, at a's place plus (dx, dy), continues a. */
static inline bool continues(const tz_strip_map *a, const tz_strip_map *b, double dx,
                             double dy, double tolerance)
{
    if (a->plane != b->plane)
        return false;
    if (a->plane < 0)
        return true;
    const double x = a->u + (double)a->f[0] * dx + (double)a->f[1] * dy - b->u,
                 y = a->v + (double)a->f[2] * dx + (double)a->f[3] * dy - b->v;
    return x * x + y * y <= tolerance * tolerance;
}

static inline double tolerance_of(const tz_strips *s, double distance)
{
    return (0.75 + 0.1 * distance) * (s->shrink > 1 ? s->shrink : 1);
}

/* Normals turn as the surface does: from the photo's frame to the canvas'. Their y points
 * up. */
static tz_f4 turn_normal(const tz_strip_map *m, tz_f4 v)
{
    const float det = m->f[0] * m->f[3] - m->f[1] * m->f[2], mirror = det < 0 ? -1 : 1;
    /* the nearest rotation (with a mirror) */
    const float c = m->f[0] + mirror * m->f[3], d = m->f[2] - mirror * m->f[1],
                l = sqrtf(c * c + d * d);
    if (!(l > 1e-9F))
        return v;
    /* photo -> canvas: the transpose, R^T n, with y downwards conjugated */
    const float a = c / l, b = d / l, x = v[0] - 0.5F, y = v[1] - 0.5F;
    v[0] = a * x - b * y + 0.5F;
    v[1] = mirror * (b * x + a * y) + 0.5F;
    return v;
}

static tz_f4 low_at(const tz_strips *s, const tz_strip_map *m, int level, double dx,
                    double dy)
{
    const tz_source_plane *p = tz_strip_plane(s, m->plane);
    const tz_vec2 at = shows_at(m, dx, dy);
    float out[4] = {0};
    tz_source_low(p, level, at.x, at.y, out);
    tz_f4 v = tz_load4(out);
    return s->kind == TZ_MAP_NORMAL ? turn_normal(m, v) : v;
}

/* ---- the equation ---------------------------------------------------------------------- */

static bool right_hand_side(const tz_strips *s, tz_correction *g, const tz_strip_map *map)
{
    const int32_t nx = g->nx, ny = g->ny;
    const double h = g->spacing, near = tolerance_of(s, h);
    tz_f4 *jump = (tz_f4 *)g->jump;
    bool any = false;
    memset(jump, 0, (size_t)nx * (size_t)ny * sizeof *jump);
    for (int32_t j = 0; j < ny; j++)
        for (int32_t i = 0; i < nx; i++)
            for (int side = 0; side < 2; side++) {
                const int32_t i2 = i + !side, j2 = j + side;
                if (i2 >= nx || j2 >= ny)
                    continue;
                const int64_t n = (int64_t)j * nx + i, m = (int64_t)j2 * nx + i2;
                const double dx = side ? 0 : h, dy = side ? h : 0;
                if (map[n].plane < 0 || map[m].plane < 0 ||
                    continues(&map[n], &map[m], dx, dy, near) ||
                    continues(&map[m], &map[n], -dx, -dy, near))
                    continue;
                const tz_f4 step = low_at(s, &map[n], g->level, 0, 0) -
                                   low_at(s, &map[m], g->level, -dx, -dy) +
                                   low_at(s, &map[n], g->level, dx, dy) -
                                   low_at(s, &map[m], g->level, 0, 0);
                jump[n] -= 0.5F * step;
                jump[m] += 0.5F * step;
                any = true;
            }
    return any;
}

/* Correction at a node as another map, at (dx, dy) from it, sees it. */
static tz_f4 node_seen(const tz_strips *s, const tz_correction *g,
                       const tz_strip_map *map, int64_t node, const tz_strip_map *own,
                       double dx, double dy)
{
    const tz_f4 c = ((const tz_f4 *)g->c)[node];
    if (map[node].plane < 0 || own->plane < 0 ||
        continues(own, &map[node], -dx, -dy, tolerance_of(s, g->spacing)))
        return c;
    return c + low_at(s, &map[node], g->level, 0, 0) - low_at(s, own, g->level, -dx, -dy);
}

/* Correction at a place of the canvas, bilinear. */
static tz_f4 correction_at(const tz_strips *s, const tz_correction *g,
                           const tz_strip_map *map, const tz_strip_map *own, double x,
                           double y)
{
    const double h = g->spacing, u = (x - (double)g->x0) / h - 0.5,
                 v = (y - (double)g->y0) / h - 0.5;
    const int32_t i = (int32_t)u, j = (int32_t)v;
    const double fu = u - i, fv = v - j;
    const int64_t n = (int64_t)j * g->nx + i;
    const tz_f4 a = node_seen(s, g, map, n, own, fu * h, fv * h),
                b = node_seen(s, g, map, n + 1, own, (fu - 1) * h, fv * h),
                c = node_seen(s, g, map, n + g->nx, own, fu * h, (fv - 1) * h),
                d = node_seen(s, g, map, n + g->nx + 1, own, (fu - 1) * h, (fv - 1) * h);
    const tz_f4 top = a + (float)fu * (b - a), down = c + (float)fu * (d - c);
    return top + (float)fv * (down - top);
}

/* Maps and right-hand side of a grid. */
static tz_status prepare(tz_ctx *ctx, const tz_strips *s, int which, tz_strip_work *w,
                         bool *any)
{
    tz_correction *g = &w->grid[which];
    const size_t n = (size_t)g->nx * (size_t)g->ny;
    tz_status st = tz_correction_reserve(ctx, g, 4);
    if (st == TZ_OK && n > w->maps[which]) {
        tz_free(ctx, w->map[which]);
        w->map[which] = NULL;
        w->maps[which] = 0;
        st = tz_alloc(ctx, &w->map[which], n, sizeof **w->map);
        if (st == TZ_OK)
            w->maps[which] = n;
    }
    if (st == TZ_OK)
        st = tz_strip_maps(ctx, s, g->x0, g->y0, g->spacing, g->nx, g->ny, w->map[which],
                           w);
    if (st == TZ_OK)
        *any = right_hand_side(s, g, w->map[which]);
    return st;
}

tz_status tz_strip_coarse(tz_ctx *ctx, const tz_strips *s, tz_rect r, tz_strip_work *w)
{
    tz_correction *g = &w->grid[0], fine = {0};
    tz_correction_span(&fine, r, TZ_FINE, TZ_FINE_STEPS + 1);
    const tz_rect inner = {(int32_t)fine.x0, (int32_t)fine.y0, fine.nx * TZ_FINE,
                           fine.ny * TZ_FINE};
    tz_correction_span(g, inner, TZ_COARSE, TZ_COARSE_STEPS + 1);
    g->level = 0;
    bool any = false;
    const tz_status st = prepare(ctx, s, 0, w, &any);
    if (st != TZ_OK)
        return st;
    memset(g->c, 0, (size_t)g->nx * (size_t)g->ny * sizeof(tz_f4));
    if (any) /* else nothing would come of it */
        tz_correction_iterate(g, 4, s->decay, TZ_COARSE_STEPS);
    return TZ_OK;
}

static tz_status solve_fine(tz_ctx *ctx, const tz_strips *s, tz_rect tile,
                            tz_strip_work *w)
{
    tz_correction *g = &w->grid[1];
    bool any = false;
    tz_correction_span(g, tile, TZ_FINE, TZ_FINE_STEPS + 1);
    g->level = 1;
    const tz_status st = prepare(ctx, s, 1, w, &any);
    if (st != TZ_OK)
        return st;
    tz_f4 *c = (tz_f4 *)g->c;
    for (int32_t j = 0; j < g->ny; j++)
        for (int32_t i = 0; i < g->nx; i++) {
            const int64_t n = (int64_t)j * g->nx + i;
            c[n] = correction_at(s, &w->grid[0], w->map[0], &w->map[1][n],
                                 (double)g->x0 + (i + 0.5) * g->spacing,
                                 (double)g->y0 + (j + 0.5) * g->spacing);
        }
    tz_correction_iterate(g, 4, s->decay, TZ_FINE_STEPS);
    return TZ_OK;
}

/* ---- pixels ---------------------------------------------------------------------------- */

enum { TILE = TZ_CURVE_TILE, SIDE = TILE + 2 * FADE };

static tz_status work_init(tz_ctx *ctx, tz_strip_work *w)
{
    tz_status s = TZ_OK;
    if (!w->u)
        s = tz_alloc(ctx, &w->u, SIDE, sizeof *w->u);
    if (s == TZ_OK && !w->v)
        s = tz_alloc(ctx, &w->v, SIDE, sizeof *w->v);
    if (s == TZ_OK && !w->row)
        s = tz_alloc(ctx, &w->row, SIDE, sizeof *w->row);
    if (s == TZ_OK && !w->texel)
        s = tz_alloc(ctx, &w->texel, 4 * (size_t)SIDE, sizeof *w->texel);
    if (s == TZ_OK && !w->seam)
        s = tz_alloc(ctx, &w->seam, (size_t)SIDE * SIDE, sizeof *w->seam);
    if (s == TZ_OK && !w->map[2]) {
        s = tz_alloc(ctx, &w->map[2], (size_t)SIDE * SIDE, sizeof *w->map[2]);
        w->maps[2] = (size_t)SIDE * SIDE;
    }
    return s;
}

/* A pixel of the photo itself, where a place falls onto its middle: what is moved by whole
 * pixels is copied, not resampled. */
static bool take_pixel(const tz_source_plane *p, double u, double v, float *texel)
{
    const double x = floor(u * p->sx), y = floor(v * p->sy);
    if (!(fabs(u * p->sx - x - 0.5) < 1e-4 && fabs(v * p->sy - y - 0.5) < 1e-4) ||
        !(x >= 0 && y >= 0 && x < p->width && y < p->height))
        return false;
    memcpy(texel,
           p->texel + ((int64_t)y + p->pad) * p->stride + ((int64_t)x + p->pad) * p->step,
           (size_t)p->step * sizeof *texel);
    return true;
}

/* Samples of n places of one plane. */
static void sample(const tz_strips *s, int32_t plane, const double *u, const double *v,
                   int32_t n, float *texel, tz_f4 *out)
{
    const tz_source_plane *p = tz_strip_plane(s, plane);
    const int32_t step = p->step;
    if (p->spline) {
        int32_t known = 0;
        while (known < n &&
               take_pixel(p, u[known], v[known], texel + (int64_t)known * step))
            known++;
        if (known < n)
            tz_source_points(p, u + known, v + known, n - known,
                             texel + (int64_t)known * step);
        for (int32_t i = known; i < n; i++)
            take_pixel(p, u[i], v[i], texel + (int64_t)i * step);
    } else { /* only ever moved by whole pixels */
        const float *origin = p->texel + p->pad * p->stride + (int64_t)p->pad * step;
        for (int32_t i = 0; i < n; i++) {
            const int32_t x = tz_mirror((int64_t)floor(u[i] * p->sx), p->width),
                          y = tz_mirror((int64_t)floor(v[i] * p->sy), p->height);
            memcpy(texel + (int64_t)i * step, origin + y * p->stride + (int64_t)x * step,
                   (size_t)step * sizeof *texel);
        }
    }
    for (int32_t i = 0; i < n; i++)
        if (step == 4)
            out[i] = tz_load4(texel + 4 * (int64_t)i);
        else
            out[i] = (tz_f4){texel[i], 0, 0, 0};
}

/* Marks pixels whose neighbours within FADE px lie beyond a seam. */
static bool mark_seams(const tz_strips *s, const tz_strip_map *map, int32_t nx,
                       int32_t ny, uint8_t *seam)
{
    const double near = tolerance_of(s, 1);
    bool any = false;
    memset(seam, 0, (size_t)nx * (size_t)ny);
    for (int32_t y = 0; y < ny; y++)
        for (int32_t x = 0; x < nx; x++) {
            const int64_t n = (int64_t)y * nx + x;
            if ((x + 1 < nx && !continues(&map[n], &map[n + 1], 1, 0, near)) ||
                (y + 1 < ny && !continues(&map[n], &map[n + nx], 0, 1, near)))
                seam[n] = 1, any = true;
        }
    if (!any)
        return false;
    for (int32_t y = 0; y < ny; y++) { /* widened across, then down */
        uint8_t *row = seam + (int64_t)y * nx;
        int32_t last = -2 * FADE;
        for (int32_t x = 0; x < nx; x++) {
            if (row[x] & 1)
                last = x;
            if (x - last <= FADE)
                row[x] |= 2;
        }
        last = nx + 2 * FADE;
        for (int32_t x = nx - 1; x >= 0; x--) {
            if (row[x] & 1)
                last = x;
            if (last - x <= FADE)
                row[x] |= 2;
        }
    }
    for (int32_t x = 0; x < nx; x++) {
        int32_t last = -2 * FADE;
        for (int32_t y = 0; y < ny; y++) {
            uint8_t *at = seam + (int64_t)y * nx + x;
            if (*at & 2)
                last = y;
            if (y - last <= FADE)
                *at |= 4;
        }
        last = ny + 2 * FADE;
        for (int32_t y = ny - 1; y >= 0; y--) {
            uint8_t *at = seam + (int64_t)y * nx + x;
            if (*at & 2)
                last = y;
            if (last - y <= FADE)
                *at |= 4;
        }
    }
    return true;
}

typedef struct tile_job {
    const tz_strips *s;
    tz_strip_work *w;
    tz_rect tile, rect;
    tz_image *out;
} tile_job;

/* Colour that a map shows at pixel (x, y) of the canvas. */
static tz_f4 shade(const tile_job *b, const tz_strip_map *m, tz_f4 colour, int32_t x,
                   int32_t y)
{
    if (b->s->kind == TZ_MAP_NORMAL)
        colour = turn_normal(m, colour);
    return colour +
           correction_at(b->s, &b->w->grid[1], b->w->map[1], m, x + 0.5, y + 0.5);
}

/* Mix of what lies to all sides of a seam. */
static tz_f4 mix(const tile_job *b, const tz_strip_map *m, tz_f4 own, int32_t x,
                 int32_t y, float *share)
{
    const tz_strips *s = b->s;
    const double near = tolerance_of(s, FADE);
    tz_f4 sum = {0};
    float there = 0, strange = 0;
    for (int k = 0; k < TAPS; k++) {
        const int dx = tap[k][0], dy = tap[k][1];
        const tz_strip_map *q = m + (int64_t)dy * SIDE + dx;
        if (q->plane < 0) {
            strange += m->plane >= 0;
            continue;
        }
        there += 1;
        if (k == 0 || (m->plane >= 0 && continues(m, q, dx, dy, near))) {
            sum += own;
            continue;
        }
        strange += 1;
        tz_strip_map here = *q; /* moved to this pixel */
        const tz_vec2 at = shows_at(q, -dx, -dy);
        float texel[4];
        tz_f4 v;
        here.u = at.x;
        here.v = at.y;
        sample(s, q->plane, &at.x, &at.y, 1, texel, &v);
        sum += shade(b, &here, v, x, y);
    }
    if (strange == 0) /* no seam so near */
        return own;
    *share = there / TAPS;
    return there > 0 ? sum * (1 / there) : sum;
}

static void put(const tile_job *b, const tz_strip_map *m, tz_f4 v, float share, float *at)
{
    const tz_strips *s = b->s;
    const int32_t n = s->channels;
    if (s->kind == TZ_MAP_NORMAL && n >= 3) {
        const float x = 2 * v[0] - 1, y = 2 * v[1] - 1, z = 2 * v[2] - 1,
                    l = sqrtf((x * x + y * y) + z * z);
        if (l > 1e-6F)
            v = (tz_f4){0.5F + 0.5F * x / l, 0.5F + 0.5F * y / l, 0.5F + 0.5F * z / l,
                        v[3]};
    }
    const tz_source_plane *p = tz_strip_plane(s, m->plane < 0 ? 0 : m->plane);
    for (int32_t k = 0; k < n; k++)
        at[k] = s->kind == TZ_MAP_NORMAL && k < 3 ? v[k]
                : v[k] < p->lo[k]                 ? p->lo[k]
                : v[k] > p->hi[k]                 ? p->hi[k]
                                                  : v[k];
    if (b->out->channels > n) /* nothing beneath: what is not there is transparent */
        at[n] = share;
    else if (b->out->alpha >= 0 && share < 1)
        at[b->out->alpha] *= share;
    if (share <= 0)
        memset(at, 0, (size_t)b->out->channels * sizeof *at);
}

static void put_row(const tile_job *b, int32_t y, bool seams)
{
    const tz_strips *s = b->s;
    tz_strip_work *w = b->w;
    const int32_t nx = b->tile.w;
    const int64_t first = (int64_t)(y + FADE) * SIDE + FADE;
    const tz_strip_map *map = w->map[2] + first;
    const uint8_t *seam = w->seam + first;
    float *at = tz_image_at(b->out, b->tile.x - b->rect.x, b->tile.y - b->rect.y + y);
    for (int32_t x = 0, e; x < nx; x = e) {
        for (e = x; e < nx && map[e].plane == map[x].plane; e++)
            w->u[e] = map[e].u, w->v[e] = map[e].v;
        if (map[x].plane >= 0)
            sample(s, map[x].plane, w->u + x, w->v + x, e - x, w->texel, w->row + x);
    }
    for (int32_t x = 0; x < nx; x++, at += b->out->channels) {
        const int32_t px = b->tile.x + x, py = b->tile.y + y;
        tz_f4 v = {0};
        float share = map[x].plane >= 0;
        if (share > 0)
            v = shade(b, &map[x], w->row[x], px, py);
        if (seams && seam[x])
            v = mix(b, &map[x], v, px, py, &share);
        put(b, &map[x], v, share, at);
    }
}

tz_status tz_strip_tile(tz_ctx *ctx, const tz_strips *s, tz_rect tile, tz_rect rect,
                        tz_image *out, tz_strip_work *w)
{
    const tile_job b = {s, w, tile, rect, out};
    tz_status st = work_init(ctx, w);
    if (st == TZ_OK)
        st = solve_fine(ctx, s, tile, w);
    /* always whole rows of SIDE, so that neighbours are found alike */
    if (st == TZ_OK)
        st = tz_strip_maps(ctx, s, (int64_t)tile.x - FADE, (int64_t)tile.y - FADE, 1,
                           SIDE, tile.h + 2 * FADE, w->map[2], w);
    if (st != TZ_OK)
        return st;
    const bool seams = mark_seams(s, w->map[2], SIDE, tile.h + 2 * FADE, w->seam);
    for (int32_t y = 0; y < tile.h; y++)
        put_row(&b, y, seams);
    return TZ_OK;
}
