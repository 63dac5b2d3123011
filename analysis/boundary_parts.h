/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Thinning and pairing of boundary pixels, the two steps under boundary_score.h. Private
 * to analysis/.
 *
 * Masks stand in a frame: `margin` >= 1 empty pixels on every side, so that neighbours
 * need no check. Pixels are indices into the framed mask, `stride` a row. */
#ifndef TZ_ANALYSIS_BOUNDARY_PARTS_H
#define TZ_ANALYSIS_BOUNDARY_PARTS_H

#include "base/alloc.h"

/** Thins the pixels of the list, which are those that are 1 in `on`, to curves one pixel
 * wide, 8-connected: nothing is torn, ends stay, thick parts shrink from all sides alike.
 * @param on  framed, 0 and 1; thinned
 * @param px  rising; what was removed is taken out
 * @cost O(pixels * thickness) */
tz_status tz_boundary_skeleton(tz_ctx *ctx, uint8_t *on, int32_t stride, int32_t *px,
                               int32_t *n);

/** Disc of offsets in a framed mask, nearest first. */
typedef struct tz_boundary_disc {
    int32_t *offset;
    int32_t n;
    tz_ctx *ctx;
} tz_boundary_disc;

/** Offsets (0, 0) .. within `radius`, ceil(radius) <= margin. */
tz_status tz_boundary_disc_init(tz_ctx *ctx, double radius, int32_t stride,
                                tz_boundary_disc *d);
void tz_boundary_disc_deinit(tz_boundary_disc *d); /**< takes zeroed */

/** Largest number of pairs of a found and a true pixel, no pixel in two pairs, that lie
 * within the disc of each other.
 * @param id  framed: number of the true pixel there, 0..truth-1, or -1
 * @cost O(sqrt(found) * found * near ones), near linear in practice */
tz_status tz_boundary_pair(tz_ctx *ctx, const int32_t *px, int32_t found,
                           const int32_t *id, int32_t truth, const tz_boundary_disc *d,
                           int32_t *pairs);

#endif
