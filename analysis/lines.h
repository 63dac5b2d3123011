/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The lines of a photo: cracks, veins, joints, bands, as curves with widths.
 *
 *   photo -> ridges (dark or light lines) or edges (borders between regions) at the scale
 *   that the photo has them -> hysteresis -> thinning, to a part of a pixel -> graph:
 *   spurs pruned, near junctions merged, gaps bridged -> cubics within half a pixel
 *
 * @source Steger: An unbiased detector of curvilinear structures, PAMI 1998; Lindeberg: Edge
 *   detection and ridge detection with automatic scale selection, IJCV 1998; Schneider: An
 *   algorithm for automatically fitting digitized curves, Graphics Gems 1990 */
#ifndef TZ_ANALYSIS_LINES_H
#define TZ_ANALYSIS_LINES_H

#include "base/image.h"
#include "base/param.h"
#include "curves/curve.h"

typedef enum tz_line_kind {
    TZ_LINE_AUTO,  /**< whichever the photo has */
    TZ_LINE_EDGE,  /**< borders between regions that differ */
    TZ_LINE_RIDGE, /**< lines darker or lighter than both of their sides */
    TZ_LINE_BOTH   /**< joints: ridges where there are, else edges */
} tz_line_kind;

/** Table: tz_lines_param_table. */
typedef struct tz_lines_params {
    int32_t line; /**< tz_line_kind */
    int32_t tone; /**< ridges: 0 automatic, 1 dark, 2 light, 3 both */
    double
        strength; /**< 0 .. 1: how much a line must stand out; 0.5 = as the photo tells */
    double width[2]; /**< of lines, px; 0, 0 = automatic */
    double length;   /**< shortest line and spur kept, px; 0 = automatic */
    double gap;      /**< widest gap bridged, px; 0 = automatic, < 0 = none */
    double error;    /**< of the fitted cubics, px; 0.5 */
    int32_t most;    /**< the photo is halved until it has no more px than this; 4 Mpx */
} tz_lines_params;
TZ_API extern const tz_param_table tz_lines_param_table;

/** What the photo's lines are, and whether a curve texture suits it. */
typedef struct tz_lines_verdict {
    bool is_lines;   /**< a curve texture suits it */
    int32_t line;    /**< tz_line_kind that was used */
    int32_t tone;    /**< 1 dark, 2 light, 3 both */
    double width;    /**< median, px */
    double length;   /**< of all lines, px */
    double contrast; /**< of lines against their sides, in spreads of what lies between */
    double run;      /**< mean length of a path, in widths; borders count as 6 px wide */
    double joined;   /**< share of line ends that meet others */
    double closed;   /**< share of their length that leads on to lines at both ends */
    char why[128];   /**< "dark lines 3 px wide form 41 cells" */
} tz_lines_verdict;

/** The set: plain domain as large as the photo, one unit a px of the photo as it was given;
 * pens by colour and width (few), tapers; photo 0 of set.element has the size and an empty
 * path (tz_things_name_photo of set.element names it).
 * @param photo        1 to 4 channels, any encoding but data
 * @param[out] out     overwritten, not freed; zeroed on error; no paths where there are no
 *                     lines
 * @param[out] plate   NULL, or overwritten: the photo with its lines taken out, 3 channels
 *                     (1 of a grey photo), size and encoding of the photo; empty on error
 * @param[out] verdict NULL, or filled; zeroed on error
 * @return TZ_OK; TZ_INVALID; TZ_NOMEM; TZ_CANCELLED
 * @cost O(pixels) */
TZ_API tz_status tz_lines_find(tz_ctx *ctx, const tz_image *photo,
                               const tz_lines_params *params, tz_curve_set *out,
                               tz_image *plate, tz_lines_verdict *verdict);

#endif
