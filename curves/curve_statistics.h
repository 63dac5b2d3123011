/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Statistics of curves: of a set, or of what a rectangle (window) of its domain shows.
 *
 * Everything is estimated so that a window tells about the pattern, not about its own
 * border: lines are clipped to it, what the border cuts counts as cut.
 *
 *   set -> joined, crossings too -> field (chords by edge, nodes, turns)  --window-->
 *   statistics;  field -> raster (cells, distance to the next line)  --window--> cells,
 *   patches
 *
 * Not installed. */
#ifndef TZ_CURVES_CURVE_STATISTICS_H
#define TZ_CURVES_CURVE_STATISTICS_H

#include "curves/curve_compare.h"

enum {
    TZ_LINEWORK_TURNS = 24,  /**< bins of directions, [0, pi) */
    TZ_LINEWORK_LAGS = 4,    /**< lengths over which lines turn */
    TZ_LINEWORK_ANGLES = 32, /**< bins of these angles, as an eye tells them apart */
    TZ_LINEWORK_WAYS = 48,   /**< steps of the way to the end of an edge */
    TZ_LINEWORK_AREAS = 32,  /**< bins of cells' areas, two a doubling */
    TZ_LINEWORK_SIDE = 2048  /**< most pixels a side of rasters */
};

#define TZ_LINEWORK_ROUNDING \
    1e-4 /**< units: a window reaches so far to the left and up */

/** What sets that are compared are measured by. */
typedef struct tz_linework_scale {
    double unit;  /**< area over length: as far as parallel lines of that density are
                       apart; 1/1000 to 1/8 of the shorter side */
    double way;   /**< ways along edges are looked at up to here */
    double pixel; /**< of rasters */
    double patch; /**< side of patches */
    double lag[TZ_LINEWORK_LAGS];
} tz_linework_scale;

typedef struct tz_linework_chord {
    tz_vec2 p, q;
    float length;
    float angle; /**< [0, pi), against the local frame */
    bool inside; /**< its middle lies in the region */
} tz_linework_chord;

/** Between two nodes of other degree than 2: field.chord[chord .. chord + chords - 1]. */
typedef struct tz_linework_edge {
    int32_t chord, chords;
    bool ends[2]; /**< it really ends there; else the domain cuts it */
    bool loop;    /**< without any such node */
} tz_linework_edge;

typedef struct tz_linework_node {
    tz_vec2 at;
    int32_t degree; /**< 1 .. TZ_CURVE_DEGREES - 1 or more; 2 = corner; of a node on the
                         border, that lines run along, as if mirrored there */
} tz_linework_node;

/** By how much a line turns at a place, straight on at crossings: angle between the ways to the places so far before
 * and behind. */
typedef struct tz_linework_turn {
    tz_vec2 at;
    float angle[TZ_LINEWORK_LAGS]; /**< 0 .. pi; NAN = the line is too short */
    float depth;                   /**< way to the border */
} tz_linework_turn;

typedef struct tz_linework_field {
    tz_ctx *ctx;
    tz_domain domain;
    tz_linework_scale scale;
    TZ_ARRAY(tz_linework_chord)
    chord;
    TZ_ARRAY(tz_linework_edge)
    edge;
    TZ_ARRAY(tz_linework_node)
    node; /**< inside; what the domain's border cuts is none */
    double
        share[TZ_CURVE_DEGREES]; /**< degrees of the inner nodes from 3; sums to 1 or 0 */
    TZ_ARRAY(tz_linework_turn)
    turn;
} tz_linework_field;

/** Rectangle of a domain. */
typedef struct tz_linework_window {
    tz_vec2 lo, hi;
} tz_linework_window;

/** The scale that a set is to be measured by, out of its length and domain. */
tz_status tz_linework_scale_of(tz_ctx *ctx, const tz_curve_set *s,
                               tz_linework_scale *out);

/** @param[out] f  overwritten, not freed; zeroed on error
 * @return TZ_OK; TZ_LIMIT, TZ_NOMEM, TZ_CANCELLED (see tz_curve_join) */
tz_status tz_linework_field_init(tz_ctx *ctx, const tz_curve_set *s,
                                 const tz_linework_scale *scale, tz_linework_field *f);
void tz_linework_field_deinit(tz_linework_field *f); /**< takes zeroed */
tz_linework_window tz_linework_whole(const tz_linework_field *f);

typedef struct tz_linework_statistics {
    double area, length;
    double nodes[TZ_CURVE_DEGREES];        /**< by degree, [0] = degree 1 */
    double orientation[TZ_LINEWORK_TURNS]; /**< shares of length */
    double turning[TZ_LINEWORK_LAGS][TZ_LINEWORK_ANGLES]; /**< shares */
    double told
        [TZ_LINEWORK_LAGS]; /**< share of places where lines are long enough to turn */
    /** Share of places on lines from which the edge goes on for longer than so many
     * steps, either way; NAN where nothing in the window is long enough to tell.
     * @source Kaplan, Meier 1958; for spatial windows Baddeley, Gill 1997 */
    double survival[TZ_LINEWORK_WAYS + 1];
} tz_linework_statistics;

/** @cost O(chords + nodes + turns) */
void tz_linework_statistics_of(const tz_linework_field *f, tz_linework_window w,
                               tz_linework_statistics *out);

/* ---- rasters ------------------------------------------------------------------------ */

/** A cell: room that lines enclose. */
typedef struct tz_linework_cell {
    double area;
    tz_vec2 lo, hi; /**< box */
    bool cut;       /**< the border of the raster or of the region cuts it */
} tz_linework_cell;

typedef struct tz_linework_raster {
    tz_ctx *ctx;
    int32_t width, height;
    double pixel;
    tz_vec2 origin;  /**< in the domain: corner of pixel 0, 0 */
    float *distance; /**< to the next line, at most scale.unit; user units */
    TZ_ARRAY(tz_linework_cell)
    cell;
} tz_linework_raster;

/** Of the whole domain; of a domain over TZ_LINEWORK_SIDE pixels the middle. */
tz_status tz_linework_raster_init(const tz_linework_field *f, tz_linework_raster *r);
void tz_linework_raster_deinit(tz_linework_raster *r); /**< takes zeroed */

/** Share of the area that lies in cells of up to (k + 1) half doublings of area. Cells
 * wider than 0.7 of `widest` count as endless; of the others those that the window cuts are
 * made up for by the weight of those that it could have cut.
 * @source Miles 1974, Lantuejoul 1980: area over that of the places where the box fits */
void tz_linework_cells_of(const tz_linework_field *f, const tz_linework_raster *r,
                          tz_linework_window w, tz_vec2 widest,
                          double share[TZ_LINEWORK_AREAS]);

/** Root mean square difference between a patch of distances of one and the most alike one
 * of the other, mean over places of both, in units of the scale; NAN where no patch fits
 * in. With frames patches are turned. */
tz_status tz_linework_patches(const tz_linework_field *fa, const tz_linework_raster *a,
                              tz_linework_window wa, const tz_linework_field *fb,
                              const tz_linework_raster *b, tz_linework_window wb,
                              double *out);

/* ---- repeats ------------------------------------------------------------------------ */

/** Share of the length of lines that occurs a second time elsewhere, only moved: in a run
 * at least `run` long of one path, to 0.4 % of that. Straight runs do not count: any line
 * repeats those. Estimated from at most 3,000 runs. */
tz_status tz_linework_repeats(tz_ctx *ctx, const tz_curve_set *s, double run,
                              double *share);

#endif
