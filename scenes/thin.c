/* SPDX-License-Identifier: Apache-2.0 */
/* Thinning: pixels are taken off the four sides in turn as long as that neither breaks a
 * curve nor shortens it. Candidates are those of one side at the start of a turn; whether
 * one may go is asked when its turn comes, so curves two pixels wide keep one of them. */
#include "scenes/stage.h"

enum { ANCHOR = 2, ANCHOR_RUN = 6 };

/* Neighbours, clockwise from the upper left; bit k of a neighbourhood is neighbour k. */
static const int32_t next_x[8] = {-1, 0, 1, 1, 1, 0, -1, -1};
static const int32_t next_y[8] = {-1, -1, -1, 0, 1, 1, 1, 0};

static unsigned neighbourhood(const uint8_t *mask, int32_t w, int32_t h, int64_t p)
{
    const int32_t x = (int32_t)(p % w), y = (int32_t)(p / w);
    unsigned bits = 0;
    for (int32_t k = 0; k < 8; k++) {
        const int32_t u = x + next_x[k], v = y + next_y[k];
        if (u >= 0 && v >= 0 && u < w && v < h && mask[(int64_t)v * w + u])
            bits |= 1u << k;
    }
    return bits;
}

static unsigned bit(unsigned bits, int32_t k) { return bits >> (k & 7) & 1; }

/* Whether the neighbours stay in one part without the pixel between them (Hilditch's
 * crossing number is 1): sides 1, 3, 5, 7 that are empty and followed by something. */
static bool simple(unsigned bits)
{
    int32_t crossings = 0;
    for (int32_t k = 1; k < 8; k += 2)
        crossings += !bit(bits, k) && (bit(bits, k + 1) || bit(bits, k + 2));
    return crossings == 1;
}

static bool removable(unsigned bits)
{
    return (bits & (bits - 1)) != 0 && simple(bits); /* two neighbours at least */
}

/* One side's turn. Returns how many went. */
static int64_t peel(uint8_t *mask, int32_t w, int32_t h, int32_t side, int64_t *list)
{
    const int32_t dx = next_x[side], dy = next_y[side];
    int64_t n = 0, gone = 0;
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            const int64_t p = (int64_t)y * w + x;
            const int32_t u = x + dx, v = y + dy;
            if (!mask[p])
                continue;
            if (u < 0 || v < 0 || u >= w || v >= h || !mask[p + (int64_t)dy * w + dx])
                list[n++] = p;
        }
    for (int64_t i = 0; i < n; i++)
        if (mask[list[i]] != ANCHOR && removable(neighbourhood(mask, w, h, list[i]))) {
            mask[list[i]] = 0;
            gone++;
        }
    return gone;
}

/* A curve that leaves the picture is no end: the middle of each short run along the frame
 * stays. `step` leads along one side of n pixels. */
static void anchor_side(uint8_t *mask, int64_t first, int64_t step, int32_t n)
{
    for (int32_t i = 0, run = 0; i <= n; i++) {
        if (i < n && mask[first + i * step]) {
            run++;
            continue;
        }
        if (run > 0 && run <= ANCHOR_RUN)
            mask[first + (i - (run + 1) / 2) * step] = ANCHOR;
        run = 0;
    }
}

/* Where curves cross on the diagonals a square of four may be left of which none is
 * simple; one of them goes all the same. */
static void break_squares(uint8_t *mask, int32_t w, int32_t h)
{
    for (int32_t y = 0; y + 1 < h; y++)
        for (int32_t x = 0; x + 1 < w; x++) {
            const int64_t p = (int64_t)y * w + x, q[4] = {p, p + 1, p + w, p + w + 1};
            if (!mask[q[0]] || !mask[q[1]] || !mask[q[2]] || !mask[q[3]])
                continue;
            int32_t pick = 0;
            for (int32_t k = 3; k >= 0; k--)
                if (simple(neighbourhood(mask, w, h, q[k])))
                    pick = k;
            mask[q[pick]] = 0;
        }
}

tz_status tz_scene_thin(tz_ctx *ctx, uint8_t *mask, int32_t width, int32_t height)
{
    static const int32_t turn[4] = {5, 3, 1, 7}; /* below, right, above, left */
    int64_t *list = NULL, gone = 1;
    const tz_status s =
        tz_alloc(ctx, &list, (size_t)width * (size_t)height, sizeof *list);
    if (s != TZ_OK)
        return s;
    anchor_side(mask, 0, 1, width);
    anchor_side(mask, (int64_t)(height - 1) * width, 1, width);
    anchor_side(mask, 0, width, height);
    anchor_side(mask, width - 1, width, height);
    while (gone > 0) {
        gone = 0;
        for (int32_t k = 0; k < 4; k++)
            gone += peel(mask, width, height, turn[k], list);
    }
    break_squares(mask, width, height);
    for (int64_t p = 0; p < (int64_t)width * height; p++)
        mask[p] = mask[p] != 0;
    tz_free(ctx, list);
    return TZ_OK;
}
