/* SPDX-License-Identifier: Apache-2.0 */
/* Responses to ridges, and masks to skeletons.
 *
 * Ridge: the response, smoothed by a triangle of radius 4, bends most across the
 * boundary, downwards on the ridge and upwards at its foot: along the eigenvector of the
 * eigenvalue that is larger in magnitude, hence of the trace's sign, of
 *
 *     ( Oxx  Oxy )              1
 *     ( Oxy  Oyy )     angle =  - atan2(2 Oxy, Oxx - Oyy), + 90 degrees if Oxx + Oyy < 0
 *                               2
 * A pixel stays if it is no more than a hundredth weaker than the response one pixel away
 * on both sides along that axis: plateaus two pixels wide survive and are left to the
 * skeleton.
 * @source Dollar, Zitnick: Fast edge detection using structured forests, PAMI 2015,
 * Sec. 3. Deviates: the eigenvector itself in place of its approximation from the
 * gradients' signs; no fading at the picture's border, where boundaries count as well. */
#include <math.h>

#include "analysis/boundary_parts.h"
#include "analysis/boundary_score.h"

#define RADIUS   4
#define TOLERANT 1.01f

/* ---- ridges ------------------------------------------------------------------------ */

typedef struct thin_job {
    int32_t width, height;
    const float *response;
    float *clean, *rows, *smooth; /* without NaN; smoothed along x; along both */
    float *strength, *normal;
} thin_job;

/* Index into 0..n-1, mirrored at the ends. */
static int32_t mirror(int32_t i, int32_t n)
{
    while (i < 0 || i >= n)
        i = i < 0 ? -i - 1 : 2 * n - 1 - i;
    return i;
}

static tz_status smooth_along_x(tz_ctx *ctx, void *arg, int64_t y, int worker)
{
    const thin_job *j = arg;
    const int32_t w = j->width;
    const float *in = j->response + (size_t)y * w;
    float *clean = j->clean + (size_t)y * w, *out = j->rows + (size_t)y * w;
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < w; x++)
        clean[x] = in[x] > 0 && in[x] <= 3e38f ? in[x] : 0;
    for (int32_t x = 0; x < w; x++) {
        float sum = (RADIUS + 1) * clean[x];
        if (x >= RADIUS && x < w - RADIUS)
            for (int32_t d = 1; d <= RADIUS; d++)
                sum += (float)(RADIUS + 1 - d) * (clean[x - d] + clean[x + d]);
        else
            for (int32_t d = 1; d <= RADIUS; d++)
                sum += (float)(RADIUS + 1 - d) *
                       (clean[mirror(x - d, w)] + clean[mirror(x + d, w)]);
        out[x] = sum;
    }
    return TZ_OK;
}

static tz_status smooth_along_y(tz_ctx *ctx, void *arg, int64_t y, int worker)
{
    const thin_job *j = arg;
    const int32_t w = j->width, h = j->height;
    float *out = j->smooth + (size_t)y * w;
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < w; x++)
        out[x] = (RADIUS + 1) * j->rows[(size_t)y * w + x];
    for (int32_t d = 1; d <= RADIUS; d++) {
        const float *up = j->rows + (size_t)mirror((int32_t)y - d, h) * w;
        const float *down = j->rows + (size_t)mirror((int32_t)y + d, h) * w;
        for (int32_t x = 0; x < w; x++)
            out[x] += (float)(RADIUS + 1 - d) * (up[x] + down[x]);
    }
    return TZ_OK;
}

static float smooth_at(const thin_job *j, int32_t x, int32_t y)
{
    return j->smooth[(size_t)mirror(y, j->height) * j->width + mirror(x, j->width)];
}

/* Twice the angle across the ridge, times a length; differences over two pixels, as the
 * response itself is some pixels wide. */
static void double_angle(const thin_job *j, int32_t x, int32_t y, float *c, float *s)
{
    const float middle = 2 * smooth_at(j, x, y);
    const float xx = smooth_at(j, x - 2, y) + smooth_at(j, x + 2, y) - middle;
    const float yy = smooth_at(j, x, y - 2) + smooth_at(j, x, y + 2) - middle;
    const float xy = smooth_at(j, x + 1, y + 1) + smooth_at(j, x - 1, y - 1) -
                     smooth_at(j, x - 1, y + 1) - smooth_at(j, x + 1, y - 1);
    const float sign = xx + yy < 0 ? -1.0f : 1.0f;
    *c = sign * (xx - yy);
    *s = sign * 2 * xy;
}

static void find_normal(const thin_job *j, int32_t x, int32_t y, float *nx, float *ny)
{
    float c, s;
    double_angle(j, x, y, &c, &s);
    const float a = 0.5f * atan2f(s, c);
    *nx = cosf(a);
    *ny = sinf(a);
}

static float clean_at(const thin_job *j, float x, float y)
{
    x = fminf(fmaxf(x, 0), (float)(j->width - 1));
    y = fminf(fmaxf(y, 0), (float)(j->height - 1));
    const int32_t x0 = (int32_t)x, y0 = (int32_t)y;
    const int32_t x1 = x0 + 1 < j->width ? x0 + 1 : x0;
    const int32_t y1 = y0 + 1 < j->height ? y0 + 1 : y0;
    const float *a = j->clean + (size_t)y0 * j->width,
                *b = j->clean + (size_t)y1 * j->width;
    const float u = x - (float)x0, v = y - (float)y0;
    const float up = a[x0] + u * (a[x1] - a[x0]), down = b[x0] + u * (b[x1] - b[x0]);
    return up + v * (down - up);
}

static tz_status thin_row(tz_ctx *ctx, void *arg, int64_t row, int worker)
{
    const thin_job *j = arg;
    const int32_t y = (int32_t)row;
    float *out = j->strength + (size_t)y * j->width;
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < j->width; x++) {
        const float v = j->clean[(size_t)y * j->width + x], limit = TOLERANT * v;
        float nx, ny;
        out[x] = 0;
        if (v <= 0)
            continue;
        find_normal(j, x, y, &nx, &ny);
        if (clean_at(j, (float)x + nx, (float)y + ny) <= limit &&
            clean_at(j, (float)x - nx, (float)y - ny) <= limit)
            out[x] = v;
    }
    return TZ_OK;
}

static tz_status normal_row(tz_ctx *ctx, void *arg, int64_t row, int worker)
{
    const thin_job *j = arg;
    const size_t n = (size_t)j->width * j->height, at = (size_t)row * j->width;
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < j->width; x++) {
        float c, s;
        double_angle(j, x, (int32_t)row, &c, &s);
        const float length = sqrtf(c * c + s * s);
        j->normal[at + (size_t)x] = length > 0 ? c / length : 1;
        j->normal[n + at + (size_t)x] = length > 0 ? s / length : 0;
    }
    return TZ_OK;
}

/* Smooths, then runs `task` over the rows. */
static tz_status run(tz_ctx *ctx, thin_job *j, tz_task task)
{
    const size_t n = (size_t)j->width * j->height;
    tz_status s;

    if ((s = tz_alloc(ctx, &j->clean, n, sizeof *j->clean)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &j->rows, n, sizeof *j->rows)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &j->smooth, n, sizeof *j->smooth)) != TZ_OK)
        goto done;
    if ((s = tz_parallel_for(ctx, j->height, smooth_along_x, j)) != TZ_OK)
        goto done;
    if ((s = tz_parallel_for(ctx, j->height, smooth_along_y, j)) != TZ_OK)
        goto done;
    s = tz_parallel_for(ctx, j->height, task, j);
done:
    tz_free(ctx, j->clean);
    tz_free(ctx, j->rows);
    tz_free(ctx, j->smooth);
    return s;
}

tz_status tz_boundary_thin(tz_ctx *ctx, const float *response, int32_t width,
                           int32_t height, float *strength)
{
    thin_job j = {
        .width = width, .height = height, .response = response, .strength = strength};
    return run(ctx, &j, thin_row);
}

tz_status tz_boundary_normals(tz_ctx *ctx, const float *response, int32_t width,
                              int32_t height, float *normal)
{
    thin_job j = {
        .width = width, .height = height, .response = response, .normal = normal};
    return run(ctx, &j, normal_row);
}

/* ---- skeletons --------------------------------------------------------------------- */

/* Bit k of the index: the neighbour in Freeman direction k is on. True if the pixel may
 * go: it touches one piece of curve (Yokoi's number is 1) and is no end. */
static bool removable(uint32_t ring)
{
    int32_t crossings = 0, on = 0;
    for (int32_t k = 0; k < 8; k++)
        on += (int32_t)(ring >> k & 1);
    for (int32_t k = 0; k < 8; k += 2) {
        const uint32_t a = ~ring >> k & 1, b = ~ring >> (k + 1) & 1,
                       c = ~ring >> ((k + 2) & 7) & 1;
        crossings += (int32_t)(a - (a & b & c));
    }
    return crossings == 1 && on >= 2;
}

static uint32_t ring_at(const uint8_t *p, int32_t stride)
{
    const uint8_t *up = p - stride, *down = p + stride;
    return (uint32_t)(p[1] | up[1] << 1 | up[0] << 2 | up[-1] << 3 | p[-1] << 4 |
                      down[-1] << 5 | down[0] << 6 | down[1] << 7);
}

tz_status tz_boundary_skeleton(tz_ctx *ctx, uint8_t *on, int32_t stride, int32_t *px,
                               int32_t *n)
{
    const int32_t side[4] = {-stride, stride, -1, 1};
    int32_t *marked = NULL;
    bool table[256];
    const tz_status s = tz_alloc(ctx, &marked, (size_t)*n, sizeof *marked);
    if (s != TZ_OK)
        return s;
    for (uint32_t k = 0; k < 256; k++)
        table[k] = removable(k);
    for (bool changed = true; changed;) {
        int32_t kept = 0;
        /* one layer from each side in turn: first marked, so that a sweep does not run
         * on through the whole thickness */
        for (int32_t d = 0; d < 4; d++) {
            int32_t marks = 0;
            for (int32_t i = 0; i < *n; i++)
                if (on[px[i]] && !on[px[i] + side[d]] &&
                    table[ring_at(on + px[i], stride)])
                    marked[marks++] = px[i];
            for (int32_t i = 0; i < marks; i++)
                if (table[ring_at(on + marked[i], stride)])
                    on[marked[i]] = 0;
        }
        for (int32_t i = 0; i < *n; i++)
            if (on[px[i]])
                px[kept++] = px[i];
        changed = kept < *n;
        *n = kept;
    }
    tz_free(ctx, marked);
    return TZ_OK;
}
