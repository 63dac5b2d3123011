/* SPDX-License-Identifier: Apache-2.0 */
/* A picture is one of lines if they stand out from what lies between them, and run on:
 *
 *   contrast  of the lines against the nearer side, the mean along them, over the spread
 *             of differences between places beside the lines that are as far apart as a
 *             line's middle is from its side
 *   joined    share of ends of chains that meet others or the border
 *   reach     length of what hangs together, the mean over the length of lines, against
 *             the picture's longer side */
#include "analysis/lines_judge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SAMPLES 20000

static int by_size(const void *a, const void *b)
{
    const float p = *(const float *)a, q = *(const float *)b;
    return (p > q) - (p < q);
}

/* 1.48 times the middle difference between places beside the lines. */
static tz_status spread_between(const tz_line_graph *g, const tz_line_picture *im,
                                const float *grey, double width, double *out)
{
    const int32_t w = im->width, h = im->height, far = (int32_t)fmax(2, rint(width));
    const int32_t step = 1 + (int32_t)sqrt((double)w * h / SAMPLES);
    uint8_t *line = NULL;
    float *v = NULL;
    int32_t n = 0;
    tz_status s = tz_alloc_zero(g->ctx, &line, (size_t)w * (size_t)h, 1);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &v, 2 * SAMPLES, sizeof *v);
    if (s == TZ_OK)
        tz_line_graph_cover(g, 1, 1, w, h, line);
    for (int32_t y = 0; y < h - far && s == TZ_OK; y += step)
        for (int32_t x = 0; x < w - far && n < 2 * SAMPLES - 1; x += step) {
            const ptrdiff_t p = (ptrdiff_t)y * w + x,
                            q[2] = {p + far, p + (ptrdiff_t)far * w};
            for (int k = 0; k < 2; k++)
                if (!line[p] && !line[q[k]])
                    v[n++] = fabsf(grey[p] - grey[q[k]]);
        }
    if (s == TZ_OK)
        qsort(v, (size_t)n, sizeof *v, by_size);
    *out = n > 0 ? 1.48 * v[n / 2] : 0;
    tz_free(g->ctx, line);
    tz_free(g->ctx, v);
    return s;
}

static bool at_border(const tz_line_graph *g, tz_vec2 p)
{
    return p.x < 4 || p.y < 4 || p.x > g->width - 4 || p.y > g->height - 4;
}

static double joined(const tz_line_graph *g, const tz_line_ends *e)
{
    int64_t all = 0, met = 0;
    for (int32_t i = 0; i < g->node.n; i++) {
        const int32_t n = tz_line_degree(e, i);
        all += n;
        met += n > 1 || at_border(g, g->node.v[i]) ? n : 0;
    }
    return all > 0 ? (double)met / (double)all : 1;
}

static int32_t root_of(int32_t *up, int32_t i)
{
    while (up[i] != i) {
        up[i] = up[up[i]];
        i = up[i];
    }
    return i;
}

/* Cells: faces of the graph, by Euler's formula; and the reach. */
static tz_status reach(const tz_line_graph *g, double *out, int32_t *cells)
{
    int32_t *up = NULL, loops = 0, parts = 0;
    double *length = NULL, sum = 0, all = 0;
    const size_t n = (size_t)g->node.n + 1;
    tz_status s = tz_alloc(g->ctx, &up, n, sizeof *up);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &length, n, sizeof *length);
    if (s != TZ_OK)
        goto done;
    for (int32_t i = 0; i < g->node.n; i++)
        up[i] = i;
    for (int32_t i = 0; i < g->chain.n; i++)
        if (g->chain.v[i].node[0] >= 0)
            up[root_of(up, g->chain.v[i].node[0])] = root_of(up, g->chain.v[i].node[1]);
    for (int32_t i = 0; i < g->node.n; i++)
        parts += up[i] == i;
    for (int32_t i = 0; i < g->chain.n; i++) {
        const tz_line_chain *c = &g->chain.v[i];
        all += c->length;
        loops += c->node[0] < 0;
        if (c->node[0] >= 0)
            length[root_of(up, c->node[0])] += c->length;
        else
            sum += c->length * c->length;
    }
    for (int32_t i = 0; i < g->node.n; i++)
        sum += length[i] * length[i];
    *out = all > 0 ? sum / all / fmax(g->width, g->height) : 0;
    *cells = g->chain.n - loops - g->node.n + parts + loops;
done:
    tz_free(g->ctx, up);
    tz_free(g->ctx, length);
    return s;
}

tz_status tz_line_judge(const tz_line_graph *g, const tz_line_picture *picture,
                        const float *grey, double side, tz_lines_verdict *v)
{
    tz_line_ends ends;
    double strength = 0, width = 0, length = 0, far = 0, spread = 0;
    int32_t cells = 0;
    tz_status s = tz_line_ends_init(g, &ends);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < g->chain.n; i++) {
        const tz_line_chain *c = &g->chain.v[i];
        strength += c->length * c->strength;
        width += c->length * c->width;
        length += c->length;
    }
    v->length = side * length;
    v->width = length > 0 ? side * width / length : 0;
    v->joined = joined(g, &ends);
    tz_line_ends_deinit(g, &ends);
    s = spread_between(g, picture, grey, v->width / side, &spread);
    if (s == TZ_OK)
        s = reach(g, &far, &cells);
    if (s != TZ_OK)
        return s;
    v->contrast = length > 0 && spread > 0 ? strength / length / spread : 0;
    snprintf(v->why, sizeof v->why, "spread %.2f reach %.2f cells %d density %.3f",
             spread, far, cells,
             length * sqrt((double)g->width * g->height) / g->width / g->height);
    return TZ_OK;
}
