/* SPDX-License-Identifier: Apache-2.0 */
/* Each thing's mask, smoothed by a Gaussian, is cut at one half by marching squares on
 * the grid of pixel centres. The smoothed masks of all things and the ground sum to 1, so
 * that no two of them pass one half at the same place: outlines do not overlap. Beyond
 * the photo's border the mask goes on as it is at the border; outlines end there. */
#include "analysis/things_outline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/ctx.h"

#define LEAST_AREA 3.0

void tz_things_outline_deinit(tz_ctx *ctx, tz_things_outline *o)
{
    tz_array_free(ctx, &o->point);
    tz_array_free(ctx, &o->part);
}

/* ---- smoothed masks ------------------------------------------------------------------ */

/* A window on the photo with the mask of one thing; margins are outside the thing. */
typedef struct window {
    tz_ctx *ctx;
    int32_t x0, y0, w, h;
    float *v;      /* w * h */
    float *line;   /* scratch, the longer side */
    uint8_t *done; /* w * h: bits of cell sides that lines have left by */
    int64_t room;
} window;

static int32_t clamp(int32_t v, int32_t n) { return v < 0 ? 0 : v < n ? v : n - 1; }

static tz_status open_window(window *f, tz_rect box, int32_t margin)
{
    f->x0 = box.x - margin;
    f->y0 = box.y - margin;
    f->w = box.w + 2 * margin;
    f->h = box.h + 2 * margin;
    const int64_t n = (int64_t)f->w * f->h;
    if (n <= f->room)
        return TZ_OK;
    tz_free(f->ctx, f->v);
    tz_free(f->ctx, f->line);
    tz_free(f->ctx, f->done);
    f->v = f->line = NULL;
    f->done = NULL;
    f->room = 0;
    tz_status s = tz_alloc(f->ctx, &f->v, (size_t)n, sizeof *f->v);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &f->line, (size_t)n, sizeof *f->line);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &f->done, (size_t)n, sizeof *f->done);
    if (s == TZ_OK)
        f->room = n;
    return s;
}

static void blur(window *f, double sigma)
{
    float k[64] = {0};
    const int32_t r = (int32_t)fmin(ceil(3 * sigma), 31);
    double sum = 0;
    for (int32_t i = 0; i <= r; i++)
        sum += (i ? 2 : 1) * exp(-0.5 * i * i / (sigma * sigma));
    for (int32_t i = 0; i <= r; i++)
        k[i] = (float)(exp(-0.5 * i * i / (sigma * sigma)) / sum);
    for (int pass = 0; pass < 2; pass++) {
        const int32_t n = pass ? f->h : f->w, lines = pass ? f->w : f->h;
        const int32_t step = pass ? f->w : 1, next = pass ? 1 : f->w;
        for (int32_t l = 0; l < lines; l++) {
            float *v = f->v + (ptrdiff_t)l * next;
            for (int32_t i = 0; i < n; i++)
                f->line[i] = v[(ptrdiff_t)i * step];
            for (int32_t i = 0; i < n; i++) {
                float a = k[0] * f->line[i];
                for (int32_t j = 1; j <= r; j++)
                    a += k[j] * (f->line[clamp(i - j, n)] + f->line[clamp(i + j, n)]);
                v[(ptrdiff_t)i * step] = a;
            }
        }
    }
}

/* The mask, 1 to 0, never one half to the bit. @return pixels of at least one half */
static int64_t fill(window *f, const int32_t *label, int32_t width, int32_t height,
                    int32_t id, double sigma)
{
    int64_t count = 0;
    for (int32_t y = 0; y < f->h; y++)
        for (int32_t x = 0; x < f->w; x++) {
            const int32_t px = clamp(f->x0 + x, width), py = clamp(f->y0 + y, height);
            f->v[(ptrdiff_t)y * f->w + x] =
                label[(ptrdiff_t)py * width + px] == id ? 1 : 0;
        }
    if (sigma > 0.05)
        blur(f, sigma);
    for (int32_t x = 0; x < f->w; x++) /* nothing leaves the window */
        f->v[x] = f->v[(ptrdiff_t)(f->h - 1) * f->w + x] = 0;
    for (int32_t y = 0; y < f->h; y++)
        f->v[(ptrdiff_t)y * f->w] = f->v[(ptrdiff_t)y * f->w + f->w - 1] = 0;
    for (ptrdiff_t p = 0; p < (ptrdiff_t)f->w * f->h; p++) {
        if (fabsf(f->v[p] - 0.5F) < 1e-4F)
            f->v[p] = 0.5F - 1e-4F;
        count += f->v[p] > 0.5F;
    }
    return count;
}

/* ---- marching squares ---------------------------------------------------------------- */

/* Cell (x, y) has the corners (x, y) .. (x + 1, y + 1). Sides: 0 top, 1 right, 2 bottom,
 * 3 left. A line goes on with the inside at its right hand (y down: clockwise about it). */
static bool inside(const window *f, int32_t x, int32_t y)
{
    return f->v[(ptrdiff_t)y * f->w + x] > 0.5F;
}

/* Side by which a line that came in by side `from` leaves the cell. The saddle joins the
 * inside corners where the mean of the four is inside. */
static int leave(const window *f, int32_t x, int32_t y, int from)
{
    const bool c[4] = {inside(f, x, y), inside(f, x + 1, y), inside(f, x + 1, y + 1),
                       inside(f, x, y + 1)};
    const float *v = f->v + (ptrdiff_t)y * f->w + x;
    const bool middle = v[0] + v[1] + v[f->w] + v[f->w + 1] > 2;
    const int ahead[3] = {(from + 1) % 4, (from + 2) % 4, (from + 3) % 4};
    bool cut[4];
    for (int k = 0; k < 4; k++)
        cut[k] = c[k] != c[(k + 1) % 4];
    if (cut[ahead[0]] && cut[ahead[1]] && cut[ahead[2]]) {
        /* corner k + 1 lies between sides k and k + 1; the line goes about one that is
         * alone: inside ones where the middle is outside */
        const bool corner = c[(from + 1) % 4];
        return corner != middle ? ahead[0] : ahead[2];
    }
    for (int k = 0; k < 3; k++)
        if (cut[ahead[k]])
            return ahead[k];
    return from;
}

static tz_vec2 crossing(const window *f, int32_t x, int32_t y, int side)
{
    static const int corner[4][4] = {
        {0, 0, 1, 0}, {1, 0, 1, 1}, {0, 1, 1, 1}, {0, 0, 0, 1}};
    const int *k = corner[side];
    const float a = f->v[(ptrdiff_t)(y + k[1]) * f->w + x + k[0]],
                b = f->v[(ptrdiff_t)(y + k[3]) * f->w + x + k[2]];
    const double t = (0.5 - a) / ((double)b - a);
    return (tz_vec2){f->x0 + x + k[0] + t * (k[2] - k[0]) + 0.5,
                     f->y0 + y + k[1] + t * (k[3] - k[1]) + 0.5};
}

static double area_of(const tz_vec2 *v, int32_t n)
{
    double twice = 0;
    for (int32_t i = 0, j = n - 1; i < n; j = i++)
        twice += v[j].x * v[i].y - v[i].x * v[j].y;
    return 0.5 * twice;
}

static tz_status add_point(tz_ctx *ctx, tz_things_outline *o, int32_t first, tz_vec2 p)
{
    const int32_t n = o->point.n;
    if (n > first && o->point.v[n - 1].x == p.x && o->point.v[n - 1].y == p.y)
        return TZ_OK;
    return tz_array_push(ctx, &o->point, p);
}

/* One closed line, that leaves cell (x, y) by its top side. */
static tz_status follow(window *f, int32_t width, int32_t height, int32_t x, int32_t y,
                        tz_things_outline *o)
{
    static const int32_t dx[4] = {0, 1, 0, -1}, dy[4] = {-1, 0, 1, 0};
    const int32_t first = o->point.n, sx = x, sy = y;
    int side = 0;
    tz_status s = TZ_OK;
    do {
        tz_vec2 p = crossing(f, x, y, side);
        p.x = fmin(fmax(p.x, 0), width); /* the mask goes on beyond the photo */
        p.y = fmin(fmax(p.y, 0), height);
        s = add_point(f->ctx, o, first, p);
        if (side == 0)
            f->done[(ptrdiff_t)y * f->w + x] = 1;
        x += dx[side];
        y += dy[side];
        side = leave(f, x, y, (side + 2) % 4);
    } while (s == TZ_OK && (x != sx || y != sy || side != 0));
    if (s != TZ_OK)
        return s;
    if (fabs(area_of(o->point.v + first, o->point.n - first)) < LEAST_AREA)
        o->point.n = first;
    return o->point.n > first ? tz_array_push(f->ctx, &o->part, first) : TZ_OK;
}

/* Every closed line leaves some cell by its top side, with the inside at the right. */
static tz_status trace(window *f, int32_t width, int32_t height, tz_things_outline *o)
{
    tz_status s = TZ_OK;
    memset(f->done, 0, (size_t)f->w * (size_t)f->h);
    for (int32_t y = 1; y + 1 < f->h && s == TZ_OK; y++)
        for (int32_t x = 0; x + 1 < f->w && s == TZ_OK; x++)
            if (!inside(f, x, y) && inside(f, x + 1, y) &&
                !f->done[(ptrdiff_t)y * f->w + x])
                s = follow(f, width, height, x, y, o);
    return s;
}

/* ---- all ----------------------------------------------------------------------------- */

typedef struct job {
    int32_t width, height;
    const int32_t *label;
    const tz_rect *box;
    double smoothing;
    tz_things_outline *out;
    window *window; /* one a worker */
} job;

static int32_t points_of(const tz_things_outline *o, int32_t k)
{
    return (k + 1 < o->part.n ? o->part.v[k + 1] : o->point.n) - o->part.v[k];
}

/* Puts the part of the largest area first. */
static tz_status largest_first(tz_ctx *ctx, tz_things_outline *o)
{
    tz_things_outline r = {0};
    int32_t best = 0;
    double most = 0;
    for (int32_t k = 0; k < o->part.n; k++) {
        const double a = fabs(area_of(o->point.v + o->part.v[k], points_of(o, k)));
        if (a > most)
            most = a, best = k;
    }
    if (best == 0)
        return TZ_OK;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < o->part.n && s == TZ_OK; i++) {
        const int32_t k = i == 0 ? best : i <= best ? i - 1 : i;
        s = tz_array_push(ctx, &r.part, r.point.n);
        for (int32_t j = 0; j < points_of(o, k) && s == TZ_OK; j++)
            s = tz_array_push(ctx, &r.point, o->point.v[o->part.v[k] + j]);
    }
    tz_things_outline old = *o;
    if (s == TZ_OK)
        *o = r, r = old;
    tz_things_outline_deinit(ctx, &r);
    return s;
}

static tz_status outline_one(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const job *j = arg;
    window *f = &j->window[worker];
    const tz_rect box = j->box[i];
    double sigma = j->smoothing;
    tz_status s = TZ_OK;
    f->ctx = ctx;
    if (box.w <= 0)
        return TZ_OK;
    s = open_window(f, box, (int32_t)ceil(2 * sigma) + 2);
    int64_t whole =
        s == TZ_OK ? fill(f, j->label, j->width, j->height, (int32_t)i, 0) : 0;
    for (int tries = 0; tries < 3 && s == TZ_OK;
         tries++, sigma = tries < 2 ? sigma / 2 : 0)
        if (2 * fill(f, j->label, j->width, j->height, (int32_t)i, sigma) > whole)
            break;
    if (s == TZ_OK)
        s = trace(f, j->width, j->height, &j->out[i]);
    return s == TZ_OK ? largest_first(ctx, &j->out[i]) : s;
}

/* ---- labels -------------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Gives the free pixels whose centres an outline holds, even-odd, its label. */
static tz_status paint(tz_ctx *ctx, const tz_things_outline *o, tz_rect box, int32_t id,
                       int32_t width, int32_t *label)
{
    TZ_ARRAY(double)
    at = {0};
    tz_status s = TZ_OK;
    for (int32_t y = box.y; y < box.y + box.h && s == TZ_OK; y++) {
        const double cy = y + 0.5;
        at.n = 0;
        for (int32_t k = 0; k < o->part.n; k++) {
            const tz_vec2 *v = o->point.v + o->part.v[k];
            const int32_t n = points_of(o, k);
            for (int32_t i = 0, j = n - 1; i < n && s == TZ_OK; j = i++)
                if ((v[i].y > cy) != (v[j].y > cy))
                    s = tz_array_push(ctx, &at,
                                      v[i].x + (cy - v[i].y) / (v[j].y - v[i].y) *
                                                   (v[j].x - v[i].x));
        }
        if (at.n > 1)
            qsort(at.v, (size_t)at.n, sizeof *at.v, by_value);
        for (int32_t i = 0; i + 1 < at.n; i += 2)
            for (int32_t x = (int32_t)ceil(at.v[i] - 0.5); x + 0.5 <= at.v[i + 1]; x++)
                if (x >= 0 && x < width && label[(ptrdiff_t)y * width + x] < 0)
                    label[(ptrdiff_t)y * width + x] = id;
    }
    tz_array_free(ctx, &at);
    return s;
}

static tz_rect box_of(const tz_things_outline *o, int32_t height)
{
    double y0 = height, y1 = 0;
    for (int32_t i = 0; i < o->point.n; i++) {
        y0 = fmin(y0, o->point.v[i].y);
        y1 = fmax(y1, o->point.v[i].y);
    }
    const int32_t top = (int32_t)floor(y0), end = (int32_t)fmin(ceil(y1), height);
    return (tz_rect){0, top, 0, end > top ? end - top : 0};
}

tz_status tz_things_paint(tz_ctx *ctx, const tz_things_outline *o, int32_t count,
                          int32_t width, int32_t height, int32_t *label)
{
    tz_status s = TZ_OK;
    memset(label, 255, (size_t)width * (size_t)height * sizeof *label);
    for (int32_t i = 0; i < count && s == TZ_OK; i++)
        s = paint(ctx, &o[i], box_of(&o[i], height), i, width, label);
    return s;
}

static void find_boxes(const int32_t *label, int32_t width, int32_t height, tz_rect *box)
{
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++) {
            const int32_t l = label[(ptrdiff_t)y * width + x];
            if (l < 0)
                continue;
            tz_rect *b = &box[l];
            if (b->w == 0) {
                *b = (tz_rect){x, y, 1, 1};
                continue;
            }
            const int32_t x1 = b->x + b->w > x + 1 ? b->x + b->w : x + 1;
            b->x = x < b->x ? x : b->x;
            b->w = x1 - b->x;
            b->h = y + 1 - b->y;
        }
}

tz_status tz_things_outlines(tz_ctx *ctx, int32_t *label, int32_t width, int32_t height,
                             int32_t count, double smoothing, tz_things_outline *out)
{
    const int threads = tz_ctx_threads(ctx);
    job j = {.width = width,
             .height = height,
             .label = label,
             .smoothing = smoothing,
             .out = out};
    tz_rect *box = NULL;
    tz_status s = tz_alloc_zero(ctx, &box, (size_t)count + 1, sizeof *box);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &j.window, (size_t)threads, sizeof *j.window);
    if (s == TZ_OK) {
        find_boxes(label, width, height, box);
        j.box = box;
        s = tz_parallel_for(ctx, count, outline_one, &j);
    }
    if (s == TZ_OK)
        s = tz_things_paint(ctx, out, count, width, height, label);
    for (int i = 0; j.window && i < threads; i++) {
        tz_free(ctx, j.window[i].v);
        tz_free(ctx, j.window[i].line);
        tz_free(ctx, j.window[i].done);
    }
    tz_free(ctx, j.window);
    tz_free(ctx, box);
    return s;
}

/* ---- simplification ------------------------------------------------------------------ */

static double distance_to(tz_vec2 p, tz_vec2 a, tz_vec2 b)
{
    const tz_vec2 d = tz_vec2_sub(b, a), v = tz_vec2_sub(p, a);
    const double n = tz_vec2_dot(d, d);
    const double t = n > 0 ? fmin(fmax(tz_vec2_dot(v, d) / n, 0), 1) : 0;
    return tz_vec2_length(tz_vec2_sub(v, tz_vec2_scale(d, t)));
}

/* Marks what stays of v[0 .. n - 1], the first and last of which do. */
static tz_status mark(tz_ctx *ctx, const tz_vec2 *v, int32_t n, double error, bool *stays)
{
    TZ_ARRAY(int32_t)
    stack = {0};
    tz_status s = tz_array_push(ctx, &stack, 0);
    if (s == TZ_OK)
        s = tz_array_push(ctx, &stack, n - 1);
    stays[0] = stays[n - 1] = true;
    while (s == TZ_OK && stack.n > 0) {
        const int32_t b = stack.v[stack.n - 1], a = stack.v[stack.n - 2];
        int32_t far = -1;
        double most = error;
        stack.n -= 2;
        for (int32_t i = a + 1; i < b; i++) {
            const double d = distance_to(v[i], v[a], v[b]);
            if (d > most)
                most = d, far = i;
        }
        if (far < 0)
            continue;
        stays[far] = true;
        const int32_t next[4] = {a, far, far, b};
        for (int k = 0; k < 4 && s == TZ_OK; k++)
            s = tz_array_push(ctx, &stack, next[k]);
    }
    tz_array_free(ctx, &stack);
    return s;
}

/* A closed polygon: cut at its first point and the one farthest from it. */
static tz_status simplify_part(tz_ctx *ctx, const tz_vec2 *v, int32_t n, double error,
                               tz_things_outline *out)
{
    bool *stays = NULL;
    tz_vec2 *ring = NULL;
    int32_t far = 0;
    double most = -1;
    tz_status s = tz_alloc_zero(ctx, &stays, (size_t)n + 1, sizeof *stays);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &ring, (size_t)n + 1, sizeof *ring);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        const double d = tz_vec2_length(tz_vec2_sub(v[i], v[0]));
        ring[i] = v[i];
        if (d > most)
            most = d, far = i;
    }
    if (s == TZ_OK) {
        ring[n] = v[0];
        s = mark(ctx, ring, far + 1, error, stays);
    }
    if (s == TZ_OK)
        s = mark(ctx, ring + far, n - far + 1, error, stays + far);
    if (s == TZ_OK)
        s = tz_array_push(ctx, &out->part, out->point.n);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        if (stays[i])
            s = tz_array_push(ctx, &out->point, v[i]);
    tz_free(ctx, stays);
    tz_free(ctx, ring);
    return s;
}

tz_status tz_things_simplify(tz_ctx *ctx, const tz_things_outline *in, double error,
                             tz_things_outline *out)
{
    tz_status s = TZ_OK;
    *out = (tz_things_outline){0};
    for (int32_t k = 0; k < in->part.n && s == TZ_OK; k++)
        s = simplify_part(ctx, in->point.v + in->part.v[k], points_of(in, k), error, out);
    if (s != TZ_OK)
        tz_things_outline_deinit(ctx, out);
    return s;
}
