/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Edge map: the pixels where the response has a ridge, one pixel wide. Private to
 * analysis/. */
#ifndef TZ_ANALYSIS_EDGES_H
#define TZ_ANALYSIS_EDGES_H

#include "base/alloc.h"

typedef struct tz_edge_map {
    int32_t width, height;
    float *response; /**< width * height, >= 0, any unit */
    float *normal;   /**< planes d, c: cos, sin of twice the angle across the edge */
    uint8_t *on;     /**< width * height, 1 on an edge */
    float strong;    /**< the picture's own edge strength: 0.9 quantile over its ridges */
    tz_ctx *ctx;
} tz_edge_map;

/** Room for everything, zeroed. */
tz_status tz_edge_map_init(tz_ctx *ctx, tz_edge_map *m, int32_t width, int32_t height);
void tz_edge_map_deinit(tz_edge_map *m);

/** Fills `on` and `strong` from response and normal: ridges (non-maximum suppression),
 * kept where they reach `threshold` times the picture's own strength or hang on such a
 * ridge and reach half of it, thinned to one pixel.
 * @param threshold  0..1
 * @param least      responses below are never edges (same unit as the response)
 * @source Canny, PAMI 1986; simple points: Yokoi, Toriwaki, Fukumura, CGIP 1975 */
tz_status tz_edge_map_detect(tz_edge_map *m, double threshold, double least);

/** Thins `on` to curves one pixel wide, 8-connected, without changing connectivity; the
 * weakest pixels go first, so that curves settle on the ridge. */
tz_status tz_edge_map_thin(tz_edge_map *m);

#endif
