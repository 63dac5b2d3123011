/* SPDX-License-Identifier: Apache-2.0 */
/* A picture is one of lines if they stand out from what lies between them, and run on:
 *
 *   contrast  of the lines against the nearer side, the mean along them, over the spread
 *             of differences between places beside the lines that are as far apart as a
 *             line is wide
 *   run       mean length of a path, in widths of the lines
 *
 *   contrast sqrt(run) >= 5.8,  and as much line as two sides of the picture
 *
 * Of 15 photos, bark with lichen, leaf litter, moss and gravel have 3.9 to 5.3; pebbles
 * (their gaps), a stone wall, cracked rock 6.0 to 6.4; setts, slabs, strata, veins, onyx,
 * lava stones, bark in furrows, brick more. Borders, which count as 6 px wide, have 2.7 to
 * 4.4 where a picture is not made of regions and 5.4 and more where it is: from 4.9. */
#include "analysis/lines_judge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SAMPLES           20000
#define STANDS_OUT        5.8
#define BORDER_STANDS_OUT 4.9
#define BORDER            6 /* width that borders count as, px */

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

static double share(const tz_line_graph *g, const tz_line_ends *e)
{
    int64_t all = 0, met = 0;
    for (int32_t i = 0; i < g->node.n; i++) {
        const int32_t n = tz_line_degree(e, i);
        all += n;
        met += n > 1 || at_border(g, g->node.v[i]) ? n : 0;
    }
    return all > 0 ? (double)met / (double)all : 1;
}

tz_status tz_line_joined(const tz_line_graph *g, double *joined)
{
    tz_line_ends ends;
    const tz_status s = tz_line_ends_init(g, &ends);
    *joined = s == TZ_OK && g->chain.n > 0 ? share(g, &ends) : 0;
    tz_line_ends_deinit(g, &ends);
    return s;
}

/* Share of the length of lines that is left when loose ends are cut off until there are
 * none: what runs from line to line, around cells or from border to border. */
static tz_status closed_share(const tz_line_graph *g, double *closed)
{
    tz_line_ends ends;
    int32_t *degree = NULL, *queue = NULL, n = 0;
    uint8_t *cut = NULL;
    double all = 0, left = 0;
    tz_status s = tz_line_ends_init(g, &ends);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &degree, (size_t)g->node.n, sizeof *degree);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &queue, (size_t)g->node.n, sizeof *queue);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &cut, (size_t)g->chain.n, 1);
    if (s != TZ_OK)
        goto done;
    for (int32_t i = 0; i < g->node.n; i++) {
        degree[i] = tz_line_degree(&ends, i) + at_border(g, g->node.v[i]);
        if (degree[i] == 1)
            queue[n++] = i;
    }
    for (int32_t k = 0; k < n; k++)
        for (int32_t e = ends.first[queue[k]]; e < ends.first[queue[k] + 1]; e++) {
            const int32_t c = ends.end[e] >> 1,
                          to = g->chain.v[c].node[!(ends.end[e] & 1)];
            if (cut[c])
                continue;
            cut[c] = 1;
            if (--degree[to] == 1)
                queue[n++] = to;
        }
    for (int32_t i = 0; i < g->chain.n; i++) {
        all += g->chain.v[i].length;
        left += cut[i] ? 0 : g->chain.v[i].length;
    }
    *closed = all > 0 ? left / all : 0;
done:
    tz_line_ends_deinit(g, &ends);
    tz_free(g->ctx, degree);
    tz_free(g->ctx, queue);
    tz_free(g->ctx, cut);
    return s;
}

static int32_t root_of(int32_t *up, int32_t i)
{
    while (up[i] != i) {
        up[i] = up[up[i]];
        i = up[i];
    }
    return i;
}

/* Closed cells: what is inside of the graph by Euler's formula, E - V + parts. */
static tz_status count_cells(const tz_line_graph *g, int32_t *cells)
{
    int32_t *up = NULL, loops = 0, parts = 0;
    tz_status s = tz_alloc(g->ctx, &up, (size_t)g->node.n, sizeof *up);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < g->node.n; i++)
        up[i] = i;
    for (int32_t i = 0; i < g->chain.n; i++) {
        const tz_line_chain *c = &g->chain.v[i];
        loops += c->node[0] < 0;
        if (c->node[0] >= 0)
            up[root_of(up, c->node[0])] = root_of(up, c->node[1]);
    }
    for (int32_t i = 0; i < g->node.n; i++)
        parts += up[i] == i;
    *cells = (g->chain.n - loops) - g->node.n + parts + loops;
    tz_free(g->ctx, up);
    return TZ_OK;
}

static void say(tz_lines_verdict *v, int32_t paths, int32_t cells)
{
    static const char *const tone[] = {"", "dark ", "light ", "dark and light "};
    const char *what = v->line == TZ_LINE_EDGE ? "borders" : "lines";
    const char *kind = v->line == TZ_LINE_EDGE ? "" : tone[v->tone & 3];
    if (paths == 0)
        snprintf(v->why, sizeof v->why, "no lines stand out");
    else if (!v->is_lines)
        snprintf(v->why, sizeof v->why,
                 "%s%s hardly stand out: contrast %.1f, %.0f times as long as wide", kind,
                 what, v->contrast, v->run);
    else if (cells > paths / 4)
        snprintf(v->why, sizeof v->why, "%s%s %.1f px wide form %d cells", kind, what,
                 v->width, cells);
    else
        snprintf(v->why, sizeof v->why, "%d %s%s %.1f px wide, %.0f times as long", paths,
                 kind, what, v->width, v->run);
}

tz_status tz_line_judge(const tz_line_graph *g, const tz_line_picture *picture,
                        const float *grey, double side, int32_t paths,
                        tz_lines_verdict *v)
{
    double strength = 0, width = 0, length = 0, spread = 0;
    int32_t cells = 0;
    tz_status s = tz_line_joined(g, &v->joined);
    if (s == TZ_OK)
        s = closed_share(g, &v->closed);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < g->chain.n; i++) {
        const tz_line_chain *c = &g->chain.v[i];
        strength += c->length * c->strength;
        width += c->length * c->width;
        length += c->length;
    }
    if (length > 0)
        s = spread_between(g, picture, grey, width / length, &spread);
    if (s == TZ_OK)
        s = count_cells(g, &cells);
    if (s != TZ_OK)
        return s;
    v->length = side * length;
    v->width = length > 0 ? side * width / length : 0;
    v->contrast = length > 0 ? fmin(strength / length / fmax(spread, 0.01), 1e3) : 0;
    const double thick = v->line == TZ_LINE_EDGE ? BORDER : width / fmax(length, 1);
    v->run = paths > 0 ? length / paths / thick : 0;
    const double wanted = v->line == TZ_LINE_EDGE ? BORDER_STANDS_OUT : STANDS_OUT;
    v->is_lines =
        v->contrast * sqrt(v->run) >= wanted && length >= 2 * fmax(g->width, g->height);
    say(v, paths, cells);
    return TZ_OK;
}
