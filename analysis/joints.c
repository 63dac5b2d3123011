/* SPDX-License-Identifier: Apache-2.0 */
/* Width of a region: twice the largest distance of its pixels from its border, by a
 * chamfer distance over the label map (Borgefors 1986, weights 1 and 1.4). A joint's
 * pixels are emptied and flooded breadth-first from all sides at once, so that its
 * neighbours meet in its middle; flooding goes through 4-neighbours, so that they stay
 * connected. */
#include "analysis/joints.h"

#include <math.h>

typedef struct region_width {
    float radius;
    int64_t area;
    int32_t fresh; /* new id, -1 = joint */
} region_width;

static float nearer(const int32_t *label, const float *d, int64_t p, int64_t q,
                    float step, float best)
{
    const float v = label[p] == label[q] ? d[q] + step : 0.5f * step;
    return v < best ? v : best;
}

static void chamfer(int32_t w, int32_t h, const int32_t *label, float *d)
{
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 0; x < w; x++) {
            const int64_t p = (int64_t)y * w + x;
            float v = 1e9f;
            if (x > 0)
                v = nearer(label, d, p, p - 1, 1, v);
            if (y > 0) {
                v = nearer(label, d, p, p - w, 1, v);
                if (x > 0)
                    v = nearer(label, d, p, p - w - 1, 1.4f, v);
                if (x < w - 1)
                    v = nearer(label, d, p, p - w + 1, 1.4f, v);
            }
            d[p] = v;
        }
    }
    for (int32_t y = h - 1; y >= 0; y--) {
        for (int32_t x = w - 1; x >= 0; x--) {
            const int64_t p = (int64_t)y * w + x;
            float v = d[p];
            if (x < w - 1)
                v = nearer(label, d, p, p + 1, 1, v);
            if (y < h - 1) {
                v = nearer(label, d, p, p + w, 1, v);
                if (x < w - 1)
                    v = nearer(label, d, p, p + w + 1, 1.4f, v);
                if (x > 0)
                    v = nearer(label, d, p, p + w - 1, 1.4f, v);
            }
            d[p] = v;
        }
    }
}

static void claim(int32_t *label, int64_t from, int64_t to, int64_t *queue, int64_t *tail)
{
    if (label[to] >= 0)
        return;
    label[to] = label[from];
    queue[(*tail)++] = to;
}

static void flood(int32_t w, int32_t h, int32_t *label, int64_t *queue)
{
    const int64_t n = (int64_t)w * h;
    int64_t tail = 0;
    for (int64_t p = 0; p < n; p++) {
        const int32_t x = (int32_t)(p % w), y = (int32_t)(p / w);
        if (label[p] < 0)
            continue;
        if ((x > 0 && label[p - 1] < 0) || (x < w - 1 && label[p + 1] < 0) ||
            (y > 0 && label[p - w] < 0) || (y < h - 1 && label[p + w] < 0))
            queue[tail++] = p;
    }
    for (int64_t head = 0; head < tail; head++) {
        const int64_t p = queue[head];
        const int32_t x = (int32_t)(p % w), y = (int32_t)(p / w);
        if (x > 0)
            claim(label, p, p - 1, queue, &tail);
        if (x < w - 1)
            claim(label, p, p + 1, queue, &tail);
        if (y > 0)
            claim(label, p, p - w, queue, &tail);
        if (y < h - 1)
            claim(label, p, p + w, queue, &tail);
    }
}

tz_status tz_joints_dissolve(tz_ctx *ctx, int32_t width_px, int32_t height_px,
                             double width, int32_t *label, int32_t *count)
{
    const int64_t n = (int64_t)width_px * height_px;
    float *distance = NULL;
    int64_t *queue = NULL;
    region_width *r = NULL;
    tz_status s;

    if ((s = tz_alloc(ctx, &distance, (size_t)n, sizeof *distance)) != TZ_OK)
        goto done;
    if ((s = tz_alloc_zero(ctx, &r, (size_t)*count, sizeof *r)) != TZ_OK)
        goto done;
    chamfer(width_px, height_px, label, distance);
    for (int64_t p = 0; p < n; p++) {
        region_width *v = &r[label[p]];
        v->area++;
        if (distance[p] > v->radius)
            v->radius = distance[p];
    }
    int32_t left = 0;
    for (int32_t i = 0; i < *count; i++) {
        const double across = 2.0 * r[i].radius;
        const bool joint = across < width && (double)r[i].area > 2.5 * across * across;
        r[i].fresh = joint ? -1 : left++;
    }
    if (left == 0 || left == *count)
        goto done;
    if ((s = tz_alloc(ctx, &queue, (size_t)n, sizeof *queue)) != TZ_OK)
        goto done;
    for (int64_t p = 0; p < n; p++)
        label[p] = r[label[p]].fresh;
    flood(width_px, height_px, label, queue);
    *count = left;
done:
    tz_free(ctx, distance);
    tz_free(ctx, queue);
    tz_free(ctx, r);
    return s;
}
