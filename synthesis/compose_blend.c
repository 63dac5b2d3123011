/* SPDX-License-Identifier: Apache-2.0 */
/* Gradient-domain correction of seams.
 *
 * Let s_a be the source as placement a shows it. Inside a placement the composite keeps
 * the gradient of s_a; across a seam between a and b it takes the mean of both gradients.
 * The composite is s + c, so that the correction c obeys
 *
 *     c_m - c_n = J_nm,   J_nm = 1/2 [(s_a - s_b)(n) + (s_a - s_b)(m)]   labels a at n, b at m
 *
 * between neighbours n, m (J = 0 inside a placement), plus a weak pull (spacing / decay)^2
 * c_n = 0, which fades the correction over `decay` px: colours never drift over long
 * distances. That is the screened Poisson equation. Away from seams c is smooth, so it is
 * solved on a grid of 16 px and improved on one of 4 px with low-passed sources, by a fixed
 * count of Jacobi steps. A node's value then depends on the nodes within that count of
 * steps alone and on no boundary: any crop that is solved with such a margin gives the same
 * bytes as the whole.
 *
 * Between grids and from the fine grid to pixels, c is continued across seams through the
 * smooth target t = s + c: at a node that another placement b owns, placement a sees
 * c_a = c_b + s_b - s_a.
 *
 * @source Perez, Gangnet, Blake: Poisson image editing, SIGGRAPH 2003 (membrane);
 *   Bhat, Curless, Cohen, Zitnick: Fourier analysis of the 2D screened Poisson equation for
 *   gradient domain problems, ECCV 2008 */
#include <string.h>

#include "synthesis/compose_internal.h"

enum { COARSE_STEPS = TZ_COARSE_STEPS, FINE_STEPS = TZ_FINE_STEPS };

void tz_piece_low(const tz_composer *c, int32_t id, int level, double px, double py,
                  float *out)
{
    const tz_piece *p = &c->piece[id];
    const tz_vec2 shift = tz_piece_shift(c, id, px, py);
    const double x = px - shift.x, y = py - shift.y;
    tz_source_low(&c->source[p->source], level, p->inv.a * x + p->inv.c * y + p->inv.e,
                  p->inv.b * x + p->inv.d * y + p->inv.f, out);
    if (p->turned) {
        const float nx = out[0] - 0.5F, ny = out[1] - 0.5F;
        out[0] = p->n00 * nx + p->n01 * ny + 0.5F;
        out[1] = p->n10 * nx + p->n11 * ny + 0.5F;
    }
}

tz_status tz_correction_reserve(tz_ctx *ctx, tz_correction *g, int32_t step)
{
    const size_t nodes = (size_t)g->nx * (size_t)g->ny;
    if (nodes <= g->cap)
        return TZ_OK;
    tz_correction_deinit(ctx, g);
    const size_t floats = nodes * (size_t)step;
    tz_status s = tz_alloc(ctx, &g->label, nodes, sizeof *g->label);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &g->c, floats, sizeof *g->c);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &g->spare, floats, sizeof *g->spare);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &g->jump, floats, sizeof *g->jump);
    if (s == TZ_OK)
        g->cap = nodes;
    else
        tz_correction_deinit(ctx, g);
    return s;
}

void tz_correction_deinit(tz_ctx *ctx, tz_correction *g)
{
    tz_free(ctx, g->label);
    tz_free(ctx, g->c);
    tz_free(ctx, g->spare);
    tz_free(ctx, g->jump);
    g->label = NULL;
    g->c = g->spare = g->jump = NULL;
    g->cap = 0;
}

static inline tz_vec2 node_at(const tz_correction *g, int32_t i, int32_t j)
{
    return (tz_vec2){(double)g->x0 + (i + 0.5) * g->spacing,
                     (double)g->y0 + (j + 0.5) * g->spacing};
}

/* jump[n] = sum over the four neighbours m of -J_nm: the right-hand side of node n. A
 * node's sum runs left, right, up, down, each pair seen from both ends. */
static void right_hand_side(const tz_composer *c, tz_correction *g)
{
    const int32_t nx = g->nx, ny = g->ny, step = c->step;
    float an[TZ_IMAGE_MAX_CHANNELS + 4], am[TZ_IMAGE_MAX_CHANNELS + 4];
    float bn[TZ_IMAGE_MAX_CHANNELS + 4], bm[TZ_IMAGE_MAX_CHANNELS + 4];
    memset(g->jump, 0, (size_t)nx * (size_t)ny * (size_t)step * sizeof *g->jump);
    for (int32_t j = 0; j < ny; j++)
        for (int32_t i = 0; i < nx; i++)
            for (int side = 0; side < 2; side++) { /* to the right, then down */
                const int32_t i2 = i + !side, j2 = j + side;
                if (i2 >= nx || j2 >= ny)
                    continue;
                const int64_t n = (int64_t)j * nx + i, m = (int64_t)j2 * nx + i2;
                const int32_t a = g->label[n], b = g->label[m];
                if (a == b || a < 0 || b < 0)
                    continue;
                const tz_vec2 pn = node_at(g, i, j), pm = node_at(g, i2, j2);
                tz_piece_low(c, a, g->level, pn.x, pn.y, an);
                tz_piece_low(c, a, g->level, pm.x, pm.y, am);
                tz_piece_low(c, b, g->level, pn.x, pn.y, bn);
                tz_piece_low(c, b, g->level, pm.x, pm.y, bm);
                float *at_n = g->jump + n * step, *at_m = g->jump + m * step;
                for (int32_t k = 0; k < step; k++) {
                    const float jump = 0.5F * ((an[k] - bn[k]) + (am[k] - bm[k]));
                    at_n[k] -= jump;
                    at_m[k] += jump;
                }
            }
}

/* One Jacobi step; nodes on the rim see themselves in place of missing neighbours. They
 * lie outside what is used. */
static void relax(const tz_correction *g, int32_t step, float pull, const float *in,
                  float *out)
{
    const int32_t nx = g->nx, ny = g->ny;
    const int64_t row = (int64_t)nx * step;
    const float scale = 1.0F / (4 + pull);
    for (int32_t j = 0; j < ny; j++) {
        const float *mid = in + j * row, *jump = g->jump + j * row;
        const float *up = j ? mid - row : mid, *down = j + 1 < ny ? mid + row : mid;
        float *o = out + j * row;
        for (int32_t k = 0; k < step; k++) {
            const int64_t e = row - step + k;
            const int64_t right = nx > 1 ? k + step : k, left = nx > 1 ? e - step : e;
            o[k] = (((mid[k] + mid[right]) + (up[k] + down[k])) + jump[k]) * scale;
            o[e] = (((mid[left] + mid[e]) + (up[e] + down[e])) + jump[e]) * scale;
        }
        for (int64_t k = step; k < row - step; k++)
            o[k] =
                (((mid[k - step] + mid[k + step]) + (up[k] + down[k])) + jump[k]) * scale;
    }
}

void tz_correction_iterate(tz_correction *g, int32_t step, double decay, int32_t steps)
{
    const double r = g->spacing / decay;
    for (int32_t k = 0; k < steps; k++) {
        relax(g, step, (float)(r * r), g->c, g->spare);
        float *t = g->c;
        g->c = g->spare;
        g->spare = t;
    }
}

void tz_correction_node(const tz_composer *c, const tz_correction *g, int32_t i,
                        int32_t j, int32_t id, float *out)
{
    const int64_t n = (int64_t)j * g->nx + i;
    const int32_t owner = g->label[n], step = c->step;
    memcpy(out, g->c + n * step, (size_t)step * sizeof *out);
    if (owner == id || owner < 0 || id < 0)
        return;
    float theirs[TZ_IMAGE_MAX_CHANNELS + 4], ours[TZ_IMAGE_MAX_CHANNELS + 4];
    const tz_vec2 p = node_at(g, i, j);
    tz_piece_low(c, owner, g->level, p.x, p.y, theirs);
    tz_piece_low(c, id, g->level, p.x, p.y, ours);
    for (int32_t k = 0; k < step; k++)
        out[k] += theirs[k] - ours[k];
}

/* Start of the fine grid: the coarse correction, continued bilinearly. Neighbours in a row
 * mostly lie in one coarse cell, whose corners are looked at once. */
static void prolong(const tz_composer *c, const tz_correction *from, tz_correction *to)
{
    const int32_t step = c->step;
    float kept[4][TZ_IMAGE_MAX_CHANNELS + 4] = {{0}};
    const float *v[4] = {kept[0], kept[1], kept[2], kept[3]};
    for (int32_t j = 0; j < to->ny; j++) {
        int32_t last_cell = INT32_MIN, last_id = -1;
        for (int32_t i = 0; i < to->nx; i++) {
            const tz_vec2 p = node_at(to, i, j);
            const double u = (p.x - (double)from->x0) / from->spacing - 0.5;
            const double w = (p.y - (double)from->y0) / from->spacing - 0.5;
            const int32_t ci = (int32_t)u, cj = (int32_t)w;
            const float fu = (float)(u - ci), fw = (float)(w - cj);
            const int64_t n = (int64_t)j * to->nx + i;
            const int32_t id = to->label[n];
            if (ci != last_cell || id != last_id)
                for (int k = 0; k < 4; k++) {
                    const int32_t cx = ci + (k & 1), cy = cj + (k >> 1);
                    const int64_t at = (int64_t)cy * from->nx + cx;
                    v[k] = from->c + at * step;
                    if (from->label[at] != id) {
                        tz_correction_node(c, from, cx, cy, id, kept[k]);
                        v[k] = kept[k];
                    }
                }
            last_cell = ci, last_id = id;
            float *out = to->c + n * step;
            for (int32_t k = 0; k < step; k++) {
                const float a = v[0][k] + fu * (v[1][k] - v[0][k]);
                const float b = v[2][k] + fu * (v[3][k] - v[2][k]);
                out[k] = a + fw * (b - a);
            }
        }
    }
}

int32_t tz_composer_reach(void)
{
    return (FINE_STEPS + 2) * TZ_FINE + (COARSE_STEPS + 2) * TZ_COARSE;
}

static int64_t floor_to(int64_t x, int64_t unit)
{
    const int64_t q = x / unit - (x % unit < 0);
    return q * unit;
}

void tz_correction_span(tz_correction *g, tz_rect r, int32_t spacing, int32_t margin)
{
    g->spacing = spacing;
    g->x0 = floor_to((int64_t)r.x - spacing / 2, spacing) - (int64_t)margin * spacing;
    g->y0 = floor_to((int64_t)r.y - spacing / 2, spacing) - (int64_t)margin * spacing;
    g->nx = (int32_t)((floor_to((int64_t)r.x + r.w + spacing / 2, spacing) - g->x0) /
                      spacing) +
            1 + margin;
    g->ny = (int32_t)((floor_to((int64_t)r.y + r.h + spacing / 2, spacing) - g->y0) /
                      spacing) +
            1 + margin;
}

static tz_status prepare(tz_ctx *ctx, const tz_composer *c, tz_correction *g,
                         tz_label_scratch *scratch)
{
    tz_status s = tz_correction_reserve(ctx, g, c->step);
    if (s == TZ_OK)
        s = tz_label_grid(ctx, c, g->x0, g->y0, g->spacing, g->nx, g->ny, g->label,
                          scratch);
    if (s == TZ_OK)
        right_hand_side(c, g);
    return s;
}

tz_status tz_correction_coarse(tz_ctx *ctx, const tz_composer *c, tz_rect r,
                               tz_correction *coarse, tz_label_scratch *scratch)
{
    tz_correction fine;
    tz_correction_span(&fine, r, TZ_FINE, FINE_STEPS + 1);
    const tz_rect inner = {(int32_t)fine.x0, (int32_t)fine.y0, fine.nx * TZ_FINE,
                           fine.ny * TZ_FINE};
    tz_correction_span(coarse, inner, TZ_COARSE, COARSE_STEPS + 1);
    coarse->level = 0;
    const tz_status s = prepare(ctx, c, coarse, scratch);
    if (s != TZ_OK)
        return s;
    memset(coarse->c, 0,
           (size_t)coarse->nx * (size_t)coarse->ny * (size_t)c->step * sizeof *coarse->c);
    tz_correction_iterate(coarse, c->step, c->params.decay, COARSE_STEPS);
    return TZ_OK;
}

tz_status tz_correction_fine(tz_ctx *ctx, const tz_composer *c, tz_rect r,
                             const tz_correction *coarse, tz_correction *fine,
                             tz_label_scratch *scratch)
{
    tz_correction_span(fine, r, TZ_FINE, FINE_STEPS + 1);
    fine->level = 1;
    const tz_status s = prepare(ctx, c, fine, scratch);
    if (s != TZ_OK)
        return s;
    prolong(c, coarse, fine);
    tz_correction_iterate(fine, c->step, c->params.decay, FINE_STEPS);
    return TZ_OK;
}
