/* SPDX-License-Identifier: Apache-2.0 */
/* What lines run through: pixels that answer strongly enough, both for the picture and
 * against the strongest within a few px (skirts of strong lines are no branches), without
 * small holes. Thinning that, the weakest pixels first, leaves lines that hang together at
 * junctions, where ridges by themselves break up. */
#include <math.h>

#include "analysis/lines_field.h"

#define REACH 6
#define SHARE 0.3F /* of the strongest within REACH */

typedef struct job {
    tz_edge_map *m;
    float *most; /* along rows */
    float least;
} job;

static tz_status along_row(tz_ctx *ctx, void *arg, int64_t y, int worker)
{
    const job *j = arg;
    const int32_t w = j->m->width;
    const float *r = j->m->response + (ptrdiff_t)y * w;
    float *out = j->most + (ptrdiff_t)y * w;
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < w; x++) {
        const int32_t a = x > REACH ? x - REACH : 0,
                      b = x + REACH < w ? x + REACH : w - 1;
        float most = 0;
        for (int32_t k = a; k <= b; k++)
            most = r[k] > most ? r[k] : most;
        out[x] = most;
    }
    return TZ_OK;
}

static tz_status mark_row(tz_ctx *ctx, void *arg, int64_t y, int worker)
{
    const job *j = arg;
    const int32_t w = j->m->width, h = j->m->height;
    const int32_t a = y > REACH ? (int32_t)y - REACH : 0,
                  b = y + REACH < h ? (int32_t)y + REACH : h - 1;
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < w; x++) {
        const ptrdiff_t p = (ptrdiff_t)y * w + x;
        float most = 0;
        j->m->on[p] = 0;
        if (j->m->response[p] < j->least)
            continue;
        for (int32_t k = a; k <= b; k++) {
            const float v = j->most[(ptrdiff_t)k * w + x];
            most = v > most ? v : most;
        }
        j->m->on[p] = j->m->response[p] >= SHARE * most;
    }
    return TZ_OK;
}

/* Marks what marked pixels enclose, up to so many pixels in one place. */
static tz_status fill_holes(tz_edge_map *m, int32_t most)
{
    const int32_t w = m->width, h = m->height, n = w * h;
    int32_t *queue = NULL;
    uint8_t *seen = NULL;
    tz_status s = tz_alloc(m->ctx, &queue, (size_t)n, sizeof *queue);
    if (s == TZ_OK)
        s = tz_alloc_zero(m->ctx, &seen, (size_t)n, 1);
    for (int32_t p = 0; p < n && s == TZ_OK; p++) {
        int32_t tail = 0;
        bool open = false; /* reaches the border */
        if (m->on[p] || seen[p])
            continue;
        seen[p] = 1;
        queue[tail++] = p;
        for (int32_t head = 0; head < tail; head++) {
            const int32_t q = queue[head], x = q % w, y = q / w;
            const int32_t to[4] = {x > 0 ? q - 1 : -1, x < w - 1 ? q + 1 : -1,
                                   y > 0 ? q - w : -1, y < h - 1 ? q + w : -1};
            for (int k = 0; k < 4; k++) {
                open |= to[k] < 0;
                if (to[k] < 0 || m->on[to[k]] || seen[to[k]])
                    continue;
                seen[to[k]] = 1;
                queue[tail++] = to[k];
            }
        }
        for (int32_t k = 0; k < tail && !open && tail <= most; k++)
            m->on[queue[k]] = 1;
    }
    tz_free(m->ctx, queue);
    tz_free(m->ctx, seen);
    return s;
}

tz_status tz_line_crest(tz_line_field *f, double least, int32_t hole)
{
    job j = {.m = &f->map, .least = (float)least};
    const size_t n = (size_t)f->map.width * (size_t)f->map.height;
    tz_status s = tz_alloc(j.m->ctx, &j.most, n, sizeof *j.most);
    if (s == TZ_OK)
        s = tz_parallel_for(j.m->ctx, f->map.height, along_row, &j);
    if (s == TZ_OK)
        s = tz_parallel_for(j.m->ctx, f->map.height, mark_row, &j);
    tz_free(j.m->ctx, j.most);
    return s == TZ_OK ? fill_holes(j.m, hole) : s;
}
