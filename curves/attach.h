/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Elements that sit on lines (leaves on a vine) keep sitting on them: where lines have been
 * drawn anew, each is put to the line beside it, as it sits on its own in the exemplar.
 * @source [Tu20] Fig. 18 shows mixed patterns, whose parts it places independently */
#ifndef TZ_CURVES_ATTACH_H
#define TZ_CURVES_ATTACH_H

#include "curves/curve.h"

/** How an element of an exemplar sits on the nearest line. */
typedef struct tz_curve_seat {
    bool sits;     /**< the element touches a line */
    bool at_end;   /**< at a free end of it */
    double along;  /**< from the place on the line to the element's `at`, in the direction
                        of the line's tangent there; at an end: outwards */
    double across; /**< and to the side that +x turns to +y */
    double angle;  /**< of that direction, radians */
} tz_curve_seat;

/** Seats of all elements of a set. An element touches a line that comes nearer to its centre
 * than its radius and half of the line's width.
 * @param[out] seat  one an element; caller frees
 * @return TZ_OK; TZ_NOMEM  @cost O(n log n) */
TZ_API tz_status tz_curve_seats(tz_ctx *ctx, const tz_curve_set *s, tz_curve_seat **seat);

/** Moves and turns elements of a layout that copy elements which sit on lines onto the
 * nearest line, if one is within `reach` of where that line would be. Fixed elements stay.
 * @param exemplar  whose elements set->element's `source` name
 * @param reach     user units; 0 = half of the finest default spacing
 * @param[in,out] set  unchanged on error
 * @param[out] moved  NULL, or how many have been put to a line
 * @return TZ_OK; TZ_INVALID (a source does not exist; reach); TZ_NOMEM */
TZ_API tz_status tz_curve_attach(tz_ctx *ctx, const tz_curve_set *exemplar, double reach,
                                 tz_curve_set *set, int32_t *moved);

#endif
