/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * OpenCV's edge detectors as rivals, each at its best: a detector that only says edge or
 * no edge is run over a ladder of thresholds, and the strength of a pixel is the highest
 * rung on which it is an edge, over 34 (rungs 1..33), so that every threshold of the
 * measure is one rung. Times are those of one run, as a user would call it. */
#ifndef TZ_TESTS_RIVALS_CV_H
#define TZ_TESTS_RIVALS_CV_H

#ifdef __cplusplus
extern "C" {
#endif

#include "base/ctx.h"

/** Photo as the rivals take it: 3 * width * height interleaved, sRGB-encoded, 0..1. */
typedef struct rival_photo {
    float *rgb;
    int32_t width, height;
} rival_photo;

/** Canny, blurred before by a Gaussian; low threshold 0.4 of the high one. The gradient
 * is computed on floats, which keeps more of faint edges than Canny on bytes.
 * @param colour  the channel with the largest gradient counts; else grey */
tz_status rival_canny(tz_ctx *ctx, const rival_photo *photo, double sigma, bool colour,
                      float *strength, double *seconds);

/** EdgeDrawing on grey. @param op  0 Prewitt, 1 Sobel, 2 Scharr */
tz_status rival_edge_drawing(tz_ctx *ctx, const rival_photo *photo, int op, double sigma,
                             float *strength, double *seconds);

/** Structured forest with the detector's own code; not thinned. */
tz_status rival_forest(tz_ctx *ctx, const rival_photo *photo, const char *model,
                       float *response, double *seconds);

/** Things by watershed, as OpenCV's tutorial on image segmentation has it: Otsu's
 * threshold, opening, distance transform, markers where that exceeds `share` of its
 * largest value, watershed. (rivals_things_cv.cpp)
 * @param inverted  things are darker than the ground
 * @param[out] label  0 .. *labels - 1, -1 = ground and lines */
tz_status rival_watershed(tz_ctx *ctx, const rival_photo *photo, double share,
                          bool inverted, int32_t *label, int32_t *labels,
                          double *seconds);

#ifdef __cplusplus
}
#endif
#endif
