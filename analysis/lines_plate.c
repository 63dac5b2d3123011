/* SPDX-License-Identifier: Apache-2.0 */
/* Where lines are, the plate is what lies beside them:
 *
 *     plate(p) = low(p) + photo(q) - low(q),    q = 2 f - p
 *
 * low is the blur of what is no line, divided by the blur of where that is, so that it
 * runs from one side of a line over to the other; f is the nearest pixel that is no line,
 * and q its mirror image, whose grain is lent. */
#include "analysis/lines_plate.h"

#include <math.h>
#include <string.h>

#include "analysis/filter_cv.h"

#define BAND 64
#define MORE 1.5 /* px that a line's blur reaches beyond its border */

typedef struct nearest {
    int32_t x, y; /* -1 = unknown */
} nearest;

typedef struct job {
    const tz_image *photo;
    tz_image *plate;
    uint8_t *line;
    nearest *at;
    float *raw, *low, *weight;
    int32_t w, h, channel;
    double sigma;
    float *from, *to; /* planes of a blur */
} job;

static float value(const job *j, int32_t x, int32_t y)
{
    const float v = tz_image_at(j->photo, x, y)[j->channel];
    return isfinite(v) ? v : 0;
}

/* ---- nearest pixel beside a line (Danielsson 1980, two passes) ----------------------- */

static void offer(const job *j, int32_t x, int32_t y, int32_t u, int32_t v)
{
    if (u < 0 || v < 0 || u >= j->w || v >= j->h)
        return;
    const nearest n = j->at[(ptrdiff_t)v * j->w + u];
    nearest *own = &j->at[(ptrdiff_t)y * j->w + x];
    if (n.x < 0)
        return;
    const int64_t dx = n.x - x, dy = n.y - y, ox = own->x - x, oy = own->y - y;
    if (own->x < 0 || dx * dx + dy * dy < ox * ox + oy * oy)
        *own = n;
}

static void find_nearest(const job *j)
{
    for (int32_t y = 0; y < j->h; y++)
        for (int32_t x = 0; x < j->w; x++) {
            const ptrdiff_t p = (ptrdiff_t)y * j->w + x;
            j->at[p] = j->line[p] ? (nearest){-1, -1} : (nearest){x, y};
            if (!j->line[p])
                continue;
            for (int k = -1; k <= 1; k++)
                offer(j, x, y, x + k, y - 1);
            offer(j, x, y, x - 1, y);
        }
    for (int32_t y = j->h - 1; y >= 0; y--) {
        for (int32_t x = j->w - 1; x >= 0; x--) {
            if (!j->line[(ptrdiff_t)y * j->w + x])
                continue;
            for (int k = -1; k <= 1; k++)
                offer(j, x, y, x + k, y + 1);
            offer(j, x, y, x + 1, y);
        }
        for (int32_t x = 1; x < j->w; x++)
            if (j->line[(ptrdiff_t)y * j->w + x])
                offer(j, x, y, x - 1, y);
    }
}

/* ---- blur ---------------------------------------------------------------------------- */

static tz_status blur_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    job *j = arg;
    const int32_t y0 = (int32_t)i * BAND, y1 = y0 + BAND < j->h ? y0 + BAND : j->h;
    (void)worker;
    return tz_cv_blur(ctx, j->from, j->to, j->w, j->h, y0, y1, j->sigma);
}

static tz_status blur(tz_ctx *ctx, job *j, float *from, float *to)
{
    j->from = from;
    j->to = to;
    return tz_parallel_for(ctx, (j->h + BAND - 1) / BAND, blur_band, j);
}

static tz_status fill_channel(tz_ctx *ctx, job *j)
{
    const ptrdiff_t n = (ptrdiff_t)j->w * j->h;
    double sum = 0;
    int64_t known = 0;
    for (ptrdiff_t p = 0; p < n; p++) {
        j->raw[p] = j->line[p] ? 0 : value(j, (int32_t)(p % j->w), (int32_t)(p / j->w));
        sum += j->raw[p];
        known += !j->line[p];
    }
    const float mean = known ? (float)(sum / (double)known) : 0;
    const tz_status s = blur(ctx, j, j->raw, j->low);
    if (s != TZ_OK)
        return s;
    for (ptrdiff_t p = 0; p < n; p++) {
        const int32_t x = (int32_t)(p % j->w), y = (int32_t)(p / j->w);
        float *out = tz_image_at(j->plate, x, y) + j->channel;
        *out = value(j, x, y);
        if (!j->line[p])
            continue;
        *out = j->weight[p] > 1e-4F ? j->low[p] / j->weight[p] : mean;
        const nearest f = j->at[p];
        if (f.x < 0)
            continue;
        int32_t u = 2 * f.x - x, v = 2 * f.y - y;
        if (u < 0 || v < 0 || u >= j->w || v >= j->h ||
            j->line[(ptrdiff_t)v * j->w + u]) {
            u = f.x;
            v = f.y;
        }
        const ptrdiff_t q = (ptrdiff_t)v * j->w + u;
        *out += j->raw[q] - j->low[q] / j->weight[q]; /* it is no line: weight > 0 */
    }
    return TZ_OK;
}

tz_status tz_line_plate(tz_ctx *ctx, const tz_image *photo, const tz_line_graph *g,
                        double side, tz_image *plate)
{
    job j = {.photo = photo, .plate = plate, .w = photo->width, .h = photo->height};
    const size_t n = (size_t)j.w * (size_t)j.h;
    double width = 0, length = 0;
    tz_status s = tz_image_init(ctx, plate, j.w, j.h, photo->channels >= 3 ? 3 : 1);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &j.line, n, 1);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &j.at, n, sizeof *j.at);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &j.raw, n, sizeof *j.raw);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &j.low, n, sizeof *j.low);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &j.weight, n, sizeof *j.weight);
    if (s != TZ_OK)
        goto done;
    plate->encoding = photo->encoding;
    plate->depth = photo->depth;
    tz_line_graph_cover(g, side, MORE, j.w, j.h, j.line);
    for (int32_t i = 0; i < g->chain.n; i++) {
        width += g->chain.v[i].length * g->chain.v[i].width;
        length += g->chain.v[i].length;
    }
    j.sigma = fmin(fmax(length > 0 ? 0.8 * side * width / length : 2, 2), 32);
    find_nearest(&j);
    for (size_t p = 0; p < n; p++)
        j.raw[p] = j.line[p] ? 0 : 1;
    s = blur(ctx, &j, j.raw, j.weight);
    for (; j.channel < plate->channels && s == TZ_OK; j.channel++)
        s = fill_channel(ctx, &j);
done:
    tz_free(ctx, j.line);
    tz_free(ctx, j.at);
    tz_free(ctx, j.raw);
    tz_free(ctx, j.low);
    tz_free(ctx, j.weight);
    if (s != TZ_OK)
        tz_image_deinit(plate);
    return s;
}
