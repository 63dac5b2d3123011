/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Boundaries of a part of a photo, drawn by hand (tests/truth): an SVG of the part's
 * size, its root with tz:document="boundaries", tz:photo (file name), tz:sha256 of that
 * file and tz:crop="x y width height"; every <path> is a boundary. */
#ifndef TZ_TESTS_TRUTH_SVG_H
#define TZ_TESTS_TRUTH_SVG_H

#include "base/alloc.h"
#include "base/geom.h"

typedef struct truth_drawing {
    char photo[256], sha256[65];
    tz_rect crop;
    int32_t paths;
    uint8_t *mask; /**< crop.w * crop.h, 1 on boundaries, 8-connected */
    tz_ctx *ctx;
} truth_drawing;

/** @return TZ_OK; TZ_IO; TZ_FORMAT (not such a document); TZ_NOMEM */
tz_status truth_read(tz_ctx *ctx, const char *path, truth_drawing *t);
void truth_deinit(truth_drawing *t); /**< takes zeroed */

#endif
