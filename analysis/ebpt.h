/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Edge-based procedural texture: what a photo is made of. Regions (superpixels, merged
 * into whole things), edges with their features, edge groups, and the meta group.
 * @source [Kim21] Sec. 4 */
#ifndef TZ_ANALYSIS_EBPT_H
#define TZ_ANALYSIS_EBPT_H

#include "base/array.h"
#include "base/image.h"
#include "base/param.h"

typedef enum tz_edge_detector {
    TZ_EDGES_AUTO,
    TZ_EDGES_FOREST,
    TZ_EDGES_GRADIENT
} tz_edge_detector;
typedef enum tz_binning { TZ_BINNING_UNIFORM, TZ_BINNING_ADAPTIVE } tz_binning;

/** Table: tz_ebpt_param_table. */
typedef struct tz_ebpt_params {
    int32_t edges; /**< tz_edge_detector; auto = forest */
    char model
        [TZ_PARAM_STRING_SIZE]; /**< structured-forest model file, "" = Terrazzo's own */
    double
        edge_threshold; /**< hysteresis, share of the picture's own edge strength 0..1 */
    int32_t min_length; /**< px; shorter chains are dropped */
    int32_t groups;     /**< wanted number of groups, 0 = from the structure's scale */
    int32_t length_bins, angle_bins;    /**< 3 x 3 */
    int32_t binning;                    /**< tz_binning */
    int32_t polar_rings, polar_sectors; /**< 12 x 30 */
    double merge; /**< 0..1: how readily superpixels with no edge between them
                                 join into one region; 0 = plain superpixels */
} tz_ebpt_params;
TZ_API extern const tz_param_table tz_ebpt_param_table;

/** One edge: a chain of Moore neighbours without branchings. */
typedef struct tz_edge {
    int32_t x, y;         /**< first pixel */
    int32_t code, length; /**< Freeman codes tz_ebpt.code[code .. code + length - 1];
        0 = +x, then counter-clockwise as seen (y down: 2 = -y); pixels = length + 1 */
    int32_t group;        /**< its edge group */
    int32_t length_bin, angle_bin;
    double extent;       /**< l_e: arc length, px (1 or sqrt 2 a step) */
    tz_vec2 centre;      /**< c_e, px, from chain-code moments */
    double angle;        /**< alpha_e in [0, pi): first principal axis against +x */
    double width;        /**< w_e: mean width of the edge response, px */
    double strength;     /**< mean response 0..1 */
    tz_vec2 end[2];      /**< first and last pixel centres, px */
    double end_angle[2]; /**< outward tangent directions there, (-pi, pi] */
} tz_edge;

/** Non-empty cell of a group's polar grid. */
typedef struct tz_polar_cell {
    int32_t ring, sector;
    double share;         /**< edges with their centre here / edges of the group */
    int32_t first, count; /**< members: tz_ebpt.cell_edge[first .. first + count - 1] */
} tz_polar_cell;

/** One edge group = one region and the edges whose centres lie in it. Group i covers the
 * pixels of label i; a group without edges is legal (regions alone carry it). */
typedef struct tz_edge_group {
    tz_vec2 centre;        /**< c_eg, Eq. (2); the region's centroid if it has no edge */
    double angle;          /**< principal axis of its edges' centres, [0, pi) */
    double size;           /**< sqrt(area / pi) of the region, px */
    double reach;          /**< largest distance of an edge's centre from c_eg, px */
    tz_vec2 region_centre; /**< centroid of the region, px */
    int32_t area;          /**< px of the region */
    tz_rect box;           /**< of the region */
    int32_t edge, edges;   /**< ids tz_ebpt.group_edge[edge .. edge + edges - 1] */
    int32_t cell, cells;   /**< tz_ebpt.cell[cell .. cell + cells - 1], by ring, sector */
    int32_t rank;          /**< 0 = the most salient group (edge extent x strength) */
    int32_t length_bin, angle_bin; /**< in the meta group: size and angle */
    bool cut;                      /**< touches the photo's border */
} tz_edge_group;

/** Groups encoded as edges are. */
typedef struct tz_meta_group {
    tz_vec2 centre;
    double angle;
    double reach;
} tz_meta_group;

typedef struct tz_ebpt {
    int32_t width, height;
    tz_ebpt_params params;
    double scale;   /**< the picture's own scale of structure, px */
    int32_t *label; /**< width * height group ids, 0 .. group.n - 1, each 4-connected */
    TZ_ARRAY(uint8_t)
    code;
    TZ_ARRAY(tz_edge)
    edge;
    TZ_ARRAY(tz_edge_group)
    group;
    TZ_ARRAY(int32_t)
    group_edge; /**< edge ids by group */
    TZ_ARRAY(tz_polar_cell)
    cell;
    TZ_ARRAY(int32_t)
    cell_edge; /**< edge ids by cell */
    TZ_ARRAY(int32_t)
    neighbour_first; /**< group.n + 1 offsets into neighbour */
    TZ_ARRAY(int32_t)
    neighbour; /**< groups that share a border, rising ids */
    tz_meta_group meta;
    tz_ctx *ctx;
} tz_ebpt;

TZ_API void tz_ebpt_deinit(tz_ebpt *e); /**< takes zeroed */

/** Photo to EBPT.
 * @param photo   1 to 4 channels, any encoding but data; any size from 1 x 1
 * @param[out] e  replaced; empty on error
 * @return TZ_OK; TZ_INVALID; TZ_NOMEM; TZ_CANCELLED; what the model reader returns
 * @cost O(pixels) @source [Kim21] Sec. 4, Eq. (1), (2) */
TZ_API tz_status tz_ebpt_analyze(tz_ctx *ctx, const tz_image *photo,
                                 const tz_ebpt_params *params, tz_ebpt *e);

/** Writes the exemplar document: the photo (referenced by `photo_path`), its regions and
 * its edges coloured by group, every number in tz: attributes. Reading gives the same EBPT
 * bit for bit.
 * @param photo_path  as it shall stand in the document (relative to it, or absolute) */
TZ_API tz_status tz_ebpt_write(tz_ctx *ctx, const char *path, const tz_ebpt *e,
                               const char *photo_path, const char *photo_sha256);
/** @param[out] photo_path  resolved against the document's folder; free with tz_free
 *  @return TZ_OK; TZ_IO; TZ_FORMAT (line and fault named); TZ_LIMIT; TZ_NOMEM */
TZ_API tz_status tz_ebpt_read(tz_ctx *ctx, const char *path, tz_ebpt *e,
                              char **photo_path, char photo_sha256[65]);

#endif
