/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What all quality measures look at: a picture as up to three planes of a perceptual
 * space, and its pyramid. Private to analysis/quality*.c. */
#ifndef TZ_ANALYSIS_QUALITY_PLANES_H
#define TZ_ANALYSIS_QUALITY_PLANES_H

#include "base/image.h"

#define TZ_QUALITY_LEVELS   5
#define TZ_QUALITY_MIN_SIDE 16
#define TZ_QUALITY_MAX_AREA (2100 * 2100) /* larger pictures are measured on crops */
#define TZ_QUALITY_CROPS    4             /* of at most a quarter of that area each */

/** Rows of one parallel item: sums are kept per band and added in the order of bands. */
#define TZ_QUALITY_BAND 32

/** Dense planes of one size: v[c][y * w + x]. 0: lightness 0..100 (sRGB-encoded luma);
 * 1: red-green; 2: yellow-blue, on the same scale; n = 1 if the picture is grey. */
typedef struct tz_quality_planes {
    int32_t w, h, n;
    float *v[3];
    tz_ctx *ctx;
} tz_quality_planes;

/** Gaussian and Laplacian pyramid. gauss[0] is the picture, gauss[n - 1] the last level of
 * at least 8 px a side; laplace[i] = gauss[i] - expand(gauss[i + 1]) for i < n - 1; the
 * last of all five levels repeats gauss (the low-pass residual), a last one before that
 * has no laplace (w = 0). */
typedef struct tz_quality_pyramid {
    int32_t n;
    tz_quality_planes gauss[TZ_QUALITY_LEVELS], laplace[TZ_QUALITY_LEVELS];
} tz_quality_pyramid;

/** A picture under measurement: itself or, if it is huge, seeded crops of it. */
typedef struct tz_quality_picture {
    int32_t n;
    tz_rect crop[TZ_QUALITY_CROPS];
    tz_quality_pyramid at[TZ_QUALITY_CROPS];
} tz_quality_picture;

tz_status tz_quality_planes_init(tz_ctx *ctx, tz_quality_planes *p, int32_t w, int32_t h,
                                 int32_t n);
void tz_quality_planes_deinit(tz_quality_planes *p);

/** Number of colour channels: 1 grey, 3 colour, else 0 (cannot be compared as colour). */
int32_t tz_quality_colours(const tz_image *im);

/** The part r of an image as n planes (1 or 3). @return TZ_OK; TZ_NOMEM; TZ_CANCELLED */
tz_status tz_quality_planes_from_image(tz_ctx *ctx, tz_quality_planes *p,
                                       const tz_image *im, tz_rect r, int32_t n);

/** @param planes  1 or 3; a grey picture may be asked for 3 (two of them are zero)
 *  @param crops   most crops wanted (1: the largest single crop within the area)
 *  @return TZ_OK; TZ_NOMEM; TZ_CANCELLED */
tz_status tz_quality_picture_init(tz_ctx *ctx, tz_quality_picture *p, const tz_image *im,
                                  int32_t planes, int32_t crops, uint64_t seed);
void tz_quality_picture_deinit(tz_quality_picture *p);

/** Pixels of all crops. */
int64_t tz_quality_area(const tz_quality_picture *p);

/** Runs `task` on bands of TZ_QUALITY_BAND rows: i = band. */
static inline int64_t tz_quality_bands(int32_t h)
{
    return ((int64_t)h + TZ_QUALITY_BAND - 1) / TZ_QUALITY_BAND;
}
static inline int32_t tz_quality_band_end(int64_t i, int32_t h)
{
    int64_t y = (i + 1) * TZ_QUALITY_BAND;
    return y < h ? (int32_t)y : h;
}
static inline int32_t tz_quality_clamp(int32_t v, int32_t n)
{
    return v < 0 ? 0 : v >= n ? n - 1 : v;
}

#endif
