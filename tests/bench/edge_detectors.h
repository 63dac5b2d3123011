/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The edge detectors that are measured against each other, ours and the rivals, each to
 * the same strength map: 0..1 on ridges. Variants of a family differ in one setting; the
 * best one of a set stands for the family. */
#ifndef TZ_TESTS_EDGE_DETECTORS_H
#define TZ_TESTS_EDGE_DETECTORS_H

#include "base/image.h"
#include "tests/bench/rivals_cv.h"

typedef struct edge_input {
    const tz_image *photo; /**< 3 channels, sRGB */
    rival_photo dense;     /**< the same */
    const char *model;     /**< or NULL */
} edge_input;

typedef struct edge_detector {
    const char *family, *variant;
    tz_status (*detect)(tz_ctx *ctx, const edge_input *in, double setting,
                        float *strength, double *seconds);
    double setting;
    bool wants_model;
    bool shown; /**< in the pictures side by side */
} edge_detector;

extern const edge_detector edge_detectors[];
extern const int32_t edge_detectors_n;

#endif
