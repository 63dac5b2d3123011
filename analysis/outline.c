/* SPDX-License-Identifier: Apache-2.0 */
/* Crack following. The walker goes along pixel corners with the region on its right:
 *
 *        ahead left | ahead right      ahead right outside: turn right
 *        -----------+-----------       ahead left outside:  straight on
 *              left ^ right            else:                turn left
 *
 * so that pixels which touch only at a corner stay apart (4-connected regions). Every
 * loop passes the upper side of its topmost pixels in direction +x; a map of passed upper
 * sides tells which loops have been walked. */
#include "analysis/outline.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct walker {
    const int32_t *label;
    int32_t width, height, id;
} walker;

static bool inside(const walker *k, int32_t x, int32_t y)
{
    return x >= 0 && y >= 0 && x < k->width && y < k->height &&
           k->label[(int64_t)y * k->width + x] == k->id;
}

static tz_status append(tz_ctx *ctx, tz_outline_text *out, const char *text)
{
    const size_t n = strlen(text);
    tz_status s = tz_array_reserve(ctx, out, (int64_t)out->n + (int64_t)n + 1);
    if (s != TZ_OK)
        return s;
    memcpy(out->v + out->n, text, n + 1);
    out->n += (int32_t)n;
    return TZ_OK;
}

static tz_status append_run(tz_ctx *ctx, tz_outline_text *out, int32_t direction,
                            int32_t n)
{
    char text[24];
    snprintf(text, sizeof text, "%c%d", direction & 1 ? 'v' : 'h',
             direction < 2 ? n : -n);
    return append(ctx, out, text);
}

/* Direction 0 = +x, 1 = +y, 2 = -x, 3 = -y. Pixel ahead on the right of corner (x, y)
 * when walking in direction d is (x + right_x[d], y + right_y[d]). */
static const int32_t step_x[4] = {1, 0, -1, 0}, step_y[4] = {0, 1, 0, -1};
static const int32_t right_x[4] = {0, -1, -1, 0}, right_y[4] = {0, 0, -1, -1};
static const int32_t left_x[4] = {0, 0, -1, -1}, left_y[4] = {-1, 0, 0, -1};

static tz_status walk(tz_ctx *ctx, const walker *k, int32_t x0, int32_t y0, uint8_t *seen,
                      tz_outline_text *out)
{
    int32_t x = x0, y = y0, d = 0, run = 0;
    char text[32];
    snprintf(text, sizeof text, "M%d %d", x, y);
    tz_status s = append(ctx, out, text);
    while (s == TZ_OK) {
        if (d == 0)
            seen[(int64_t)y * k->width + x] = 1;
        x += step_x[d];
        y += step_y[d];
        run++;
        int32_t turn = d;
        if (!inside(k, x + right_x[d], y + right_y[d]))
            turn = (d + 1) & 3;
        else if (inside(k, x + left_x[d], y + left_y[d]))
            turn = (d + 3) & 3;
        const bool home = x == x0 && y == y0 && turn == 0;
        if (turn == d && !home)
            continue;
        if (!home || turn == d) /* z draws the last run, unless it would be bent */
            s = append_run(ctx, out, d, run);
        if (home)
            return s == TZ_OK ? append(ctx, out, "z") : s;
        run = 0;
        d = turn;
    }
    return s;
}

tz_status tz_outline_trace(tz_ctx *ctx, const int32_t *label, int32_t width,
                           int32_t height, int32_t id, tz_rect box, uint8_t *seen,
                           tz_outline_text *out)
{
    const walker k = {label, width, height, id};
    for (int32_t y = box.y; y < box.y + box.h; y++) {
        for (int32_t x = box.x; x < box.x + box.w; x++) {
            const int64_t p = (int64_t)y * width + x;
            if (label[p] != id || seen[p] || inside(&k, x, y - 1))
                continue;
            tz_status s = walk(ctx, &k, x, y, seen, out);
            if (s != TZ_OK)
                return s;
        }
    }
    return TZ_OK;
}

/* ---- back ------------------------------------------------------------------------ */

static int by_row(const void *p, const void *q)
{
    const tz_outline_side *a = p, *b = q;
    if (a->y != b->y)
        return a->y < b->y ? -1 : 1;
    return a->x < b->x ? -1 : a->x > b->x;
}

static bool corner(tz_vec2 p, int32_t width, int32_t height)
{
    return p.x >= 0 && p.y >= 0 && p.x <= width && p.y <= height && p.x == floor(p.x) &&
           p.y == floor(p.y);
}

static tz_status add_line(tz_ctx *ctx, tz_vec2 a, tz_vec2 b, int64_t limit,
                          tz_outline_sides *out, const char **why)
{
    if (a.x != b.x && a.y != b.y) {
        *why = "a region's outline has a slanted line; outlines run along pixels";
        return TZ_FORMAT;
    }
    if (a.x != b.x)
        return TZ_OK;
    const int32_t y0 = (int32_t)fmin(a.y, b.y), y1 = (int32_t)fmax(a.y, b.y);
    if ((int64_t)out->n + (y1 - y0) > limit) {
        *why = "a region's outline crosses itself or another's";
        return TZ_FORMAT;
    }
    tz_status s = tz_array_reserve(ctx, out, (int64_t)out->n + (y1 - y0));
    if (s != TZ_OK)
        return s;
    for (int32_t y = y0; y < y1; y++)
        out->v[out->n++] = (tz_outline_side){y, (int32_t)a.x};
    return TZ_OK;
}

tz_status tz_outline_read(tz_ctx *ctx, const tz_svg_path *path, int32_t width,
                          int32_t height, int64_t limit, tz_outline_sides *out,
                          const char **why)
{
    tz_vec2 start = {0, 0}, at = {0, 0};
    int32_t point = 0;
    out->n = 0;
    for (int32_t i = 0; i < path->verb.n; i++) {
        const uint8_t verb = path->verb.v[i];
        tz_vec2 to = start;
        if (verb == TZ_PATH_CUBIC) {
            *why = "a region's outline has a curve; outlines run along pixels";
            return TZ_FORMAT;
        }
        if (verb != TZ_PATH_CLOSE)
            to = path->point.v[point++];
        if (!corner(to, width, height)) {
            *why = "a region's outline leaves the pixel grid or the photo";
            return TZ_FORMAT;
        }
        /* filling closes open subpaths */
        const tz_vec2 end = verb == TZ_PATH_MOVE ? start : to;
        if (i > 0) {
            tz_status s = add_line(ctx, at, end, limit, out, why);
            if (s != TZ_OK)
                return s;
        }
        if (verb == TZ_PATH_MOVE)
            start = to;
        at = to;
    }
    if (path->verb.n > 0) {
        tz_status s = add_line(ctx, at, start, limit, out, why);
        if (s != TZ_OK)
            return s;
    }
    if (out->n > 0)
        qsort(out->v, (size_t)out->n, sizeof *out->v, by_row);
    return TZ_OK;
}

int64_t tz_outline_area(const tz_outline_sides *sides)
{
    int64_t area = 0;
    for (int32_t i = 0; i + 1 < sides->n; i += 2)
        area += sides->v[i + 1].x - sides->v[i].x;
    return area;
}

bool tz_outline_fill(const tz_outline_sides *sides, int32_t width, int32_t id,
                     int32_t *label)
{
    /* closed outlines cross each row an even number of times */
    for (int32_t i = 0; i + 1 < sides->n; i += 2) {
        int32_t *row = label + (int64_t)sides->v[i].y * width;
        for (int32_t x = sides->v[i].x; x < sides->v[i + 1].x; x++) {
            if (row[x] >= 0)
                return false;
            row[x] = id;
        }
    }
    return true;
}
