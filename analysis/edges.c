/* SPDX-License-Identifier: Apache-2.0 */
/* Ridges: a pixel stays if the response falls off to both sides along its normal, at
 * interpolated points one pixel away. The reference strength is a quantile over the
 * ridges alone: it does not depend on how much of the picture is empty, and a photo with
 * a tenth of the contrast has a tenth of the reference, hence the same edges. */
#include "analysis/edges.h"

#include <math.h>
#include <string.h>

#include "base/array.h"

#define BAND 16
#define BINS 4096

static const int8_t step_x[8] = {1, 1, 0, -1, -1, -1, 0, 1};
static const int8_t step_y[8] = {0, -1, -1, -1, 0, 1, 1, 1};

typedef TZ_ARRAY(int64_t)
pixel_list;

tz_status tz_edge_map_init(tz_ctx *ctx, tz_edge_map *m, int32_t width, int32_t height)
{
    const size_t n = (size_t)width * height;
    tz_status s;
    *m = (tz_edge_map){.width = width, .height = height, .ctx = ctx};
    if ((s = tz_alloc(ctx, &m->response, n, sizeof(float))) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &m->normal, n, 2 * sizeof(float))) != TZ_OK)
        goto done;
    if ((s = tz_alloc_zero(ctx, &m->on, n, 1)) != TZ_OK)
        goto done;
done:
    if (s != TZ_OK)
        tz_edge_map_deinit(m);
    return s;
}

void tz_edge_map_deinit(tz_edge_map *m)
{
    tz_free(m->ctx, m->response);
    tz_free(m->ctx, m->normal);
    tz_free(m->ctx, m->on);
    *m = (tz_edge_map){0};
}

/* ---- non-maximum suppression ----------------------------------------------------- */

typedef struct ridge_job {
    tz_edge_map *m;
    float least, top; /* top: largest response, end of the histogram */
    float *band_top;
    uint32_t *count; /* histogram of a band */
} ridge_job;

static tz_status top_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    ridge_job *j = arg;
    const tz_edge_map *m = j->m;
    const size_t from = (size_t)i * BAND * m->width, all = (size_t)m->width * m->height;
    const size_t to =
        from + (size_t)BAND * m->width < all ? from + (size_t)BAND * m->width : all;
    float top = 0;
    (void)ctx, (void)worker;
    for (size_t p = from; p < to; p++)
        top = m->response[p] > top ? m->response[p] : top;
    j->band_top[i] = top;
    return TZ_OK;
}

static bool is_ridge(const tz_edge_map *m, int32_t x, int32_t y)
{
    const int64_t w = m->width, p = y * w + x;
    const float *r = m->response + p;
    const float d = m->normal[p], c = m->normal[p + w * m->height];
    const float norm = sqrtf(d * d + c * c);
    if (norm <= 0)
        return false;
    const float cos2 = d / norm;
    float nx = sqrtf(fmaxf(0, 0.5f * (1 + cos2))),
          ny = sqrtf(fmaxf(0, 0.5f * (1 - cos2)));
    int64_t straight, diagonal;
    float f;
    if (nx >= ny) {
        straight = 1, diagonal = c < 0 ? 1 - w : 1 + w, f = ny / nx;
    } else {
        straight = c < 0 ? -w : w, diagonal = c < 0 ? 1 - w : 1 + w, f = nx / ny;
    }
    if (nx < ny && c < 0)
        straight = -w;
    const float ahead = r[straight] + f * (r[diagonal] - r[straight]);
    const float behind = r[-straight] + f * (r[-diagonal] - r[-straight]);
    return r[0] > ahead && r[0] >= behind;
}

static tz_status ridge_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    ridge_job *j = arg;
    tz_edge_map *m = j->m;
    const int32_t y1 =
        (int32_t)(i + 1) * BAND < m->height ? (int32_t)(i + 1) * BAND : m->height;
    const float scale = (float)(BINS - 1) / j->top;
    uint32_t *count = j->count + (size_t)i * BINS;
    (void)ctx, (void)worker;
    for (int32_t y = (int32_t)i * BAND; y < y1; y++) {
        uint8_t *on = m->on + (size_t)y * m->width;
        const float *r = m->response + (size_t)y * m->width;
        memset(on, 0, (size_t)m->width);
        if (y == 0 || y == m->height - 1)
            continue;
        for (int32_t x = 1; x < m->width - 1; x++) {
            if (r[x] <= j->least || !is_ridge(m, x, y))
                continue;
            on[x] = 1;
            count[(int32_t)(r[x] * scale)]++;
        }
    }
    return TZ_OK;
}

/* Response that `share` of the ridge pixels stay below. */
static float quantile(const ridge_job *j, int32_t bands, double share)
{
    uint64_t all = 0, below = 0;
    uint64_t count[BINS] = {0};
    for (int32_t i = 0; i < bands; i++)
        for (int32_t k = 0; k < BINS; k++)
            count[k] += j->count[(size_t)i * BINS + k];
    for (int32_t k = 0; k < BINS; k++)
        all += count[k];
    for (int32_t k = 0; k < BINS; k++) {
        below += count[k];
        if (below > 0 && (double)below >= share * (double)all)
            return (float)(k + 1) * j->top / (float)(BINS - 1);
    }
    return 0;
}

/* ---- hysteresis ------------------------------------------------------------------ */

/* Ridges are 1; strong ones and what hangs on them become 2; the rest is cleared. */
static tz_status hysteresis(tz_edge_map *m, float high, float low)
{
    const int64_t n = (int64_t)m->width * m->height;
    pixel_list stack = {0};
    tz_status s = TZ_OK;
    for (int64_t p = 0; p < n; p++) {
        if (m->on[p] != 1 || m->response[p] < high)
            continue;
        m->on[p] = 2;
        if ((s = tz_array_push(m->ctx, &stack, p)) != TZ_OK)
            goto done;
        while (stack.n > 0) {
            const int64_t q = stack.v[--stack.n]; /* never on the border */
            for (int32_t k = 0; k < 8; k++) {
                const int64_t t = q + step_x[k] + (int64_t)step_y[k] * m->width;
                if (m->on[t] != 1 || m->response[t] < low)
                    continue;
                m->on[t] = 2;
                if ((s = tz_array_push(m->ctx, &stack, t)) != TZ_OK)
                    goto done;
            }
        }
    }
    for (int64_t p = 0; p < n; p++)
        m->on[p] >>= 1;
done:
    tz_array_free(m->ctx, &stack);
    return s;
}

tz_status tz_edge_map_detect(tz_edge_map *m, double threshold, double least)
{
    const int32_t bands = (m->height + BAND - 1) / BAND;
    ridge_job j = {.m = m, .least = (float)least};
    tz_status s;

    m->strong = 0;
    if ((s = tz_alloc(m->ctx, &j.band_top, bands, sizeof(float))) != TZ_OK)
        goto done;
    if ((s = tz_alloc_zero(m->ctx, &j.count, bands, BINS * sizeof(uint32_t))) != TZ_OK)
        goto done;
    if ((s = tz_parallel_for(m->ctx, bands, top_band, &j)) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < bands; i++)
        j.top = fmaxf(j.top, j.band_top[i]);
    memset(m->on, 0, (size_t)m->width * m->height);
    if (!(j.top > least))
        goto done; /* structureless */
    if ((s = tz_parallel_for(m->ctx, bands, ridge_band, &j)) != TZ_OK)
        goto done;
    m->strong = quantile(&j, bands, 0.9);
    const float high = fmaxf((float)threshold * m->strong, j.least);
    if ((s = hysteresis(m, high, fmaxf(0.5f * high, j.least))) != TZ_OK)
        goto done;
    s = tz_edge_map_thin(m);
done:
    tz_free(m->ctx, j.band_top);
    tz_free(m->ctx, j.count);
    return s;
}

/* ---- thinning -------------------------------------------------------------------- */

/* Bit k of the index: the neighbour in Freeman direction k is on. */
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

static uint32_t ring_at(const tz_edge_map *m, int64_t p)
{
    const int32_t x = (int32_t)(p % m->width), y = (int32_t)(p / m->width);
    uint32_t ring = 0;
    for (int32_t k = 0; k < 8; k++) {
        const int32_t u = x + step_x[k], v = y + step_y[k];
        if (u < 0 || v < 0 || u >= m->width || v >= m->height)
            continue;
        ring |= (uint32_t)m->on[(int64_t)v * m->width + u] << k;
    }
    return ring;
}

tz_status tz_edge_map_thin(tz_edge_map *m)
{
    const int64_t n = (int64_t)m->width * m->height;
    int64_t *order = NULL, count = 0, first[257] = {0};
    float top = 0;
    bool table[256];
    tz_status s;

    for (uint32_t k = 0; k < 256; k++)
        table[k] = removable(k);
    for (int64_t p = 0; p < n; p++) {
        if (!m->on[p])
            continue;
        count++;
        top = fmaxf(top, m->response[p]);
    }
    if ((s = tz_alloc(m->ctx, &order, (size_t)count, sizeof *order)) != TZ_OK)
        goto done;
    /* counting sort by strength; ties in raster order */
    const float scale = top > 0 ? 255.0f / top : 0;
    for (int64_t p = 0; p < n; p++)
        if (m->on[p])
            first[(int32_t)(m->response[p] * scale) + 1]++;
    for (int32_t k = 0; k < 256; k++)
        first[k + 1] += first[k];
    for (int64_t p = 0; p < n; p++)
        if (m->on[p])
            order[first[(int32_t)(m->response[p] * scale)]++] = p;
    for (bool changed = true; changed;) {
        int64_t kept = 0;
        for (int64_t i = 0; i < count; i++) {
            const int64_t p = order[i];
            if (table[ring_at(m, p)])
                m->on[p] = 0;
            else
                order[kept++] = p;
        }
        changed = kept < count;
        count = kept;
    }
done:
    tz_free(m->ctx, order);
    return s;
}
