/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Statistics of where elements lie: of a set, or of a half of one. */
#ifndef TZ_ELEMENTS_ELEMENT_STATISTICS_H
#define TZ_ELEMENTS_ELEMENT_STATISTICS_H

#include "elements/extent.h"

enum {
    TZ_STATISTICS_QUANTILES = 32, /**< of nearest distances */
    TZ_STATISTICS_BINS = 24,      /**< of pair distances, up to `reach` */
    TZ_STATISTICS_TURNS = 16,     /**< of angles */
    TZ_STATISTICS_CLASSES = 16    /**< classes told apart; others count as the last */
};

/** One element as statistics see it. */
typedef struct tz_field_item {
    tz_vec3 at;
    double angle, radius;
    int32_t kind;
    bool oriented, is_void;
    const tz_element *element;
} tz_field_item;

/** Elements in a rectangle that begins at 0, 0. */
typedef struct tz_field {
    tz_ctx *ctx;
    tz_domain domain;
    int32_t n;
    tz_field_item *item;
    tz_vec3 *at; /**< once more, for cells */
    tz_extents extents;
} tz_field;

/** A part of a set, which must outlive it: shares of the width and height; all of it keeps
 * its torus. */
tz_status tz_field_init(tz_ctx *ctx, tz_field *f, const tz_element_set *s, tz_vec2 from,
                        tz_vec2 to);
void tz_field_deinit(tz_field *f);

typedef struct tz_statistics {
    double nearest[TZ_STATISTICS_QUANTILES];
    /** Pair correlation: of all with all, then of each class with itself; 1 = as many as
     * by chance. Of a class with fewer than 8 elements it says nothing: weight 0. */
    double correlation[1 + TZ_STATISTICS_CLASSES][TZ_STATISTICS_BINS];
    double share[TZ_STATISTICS_CLASSES];
    double weight[1 + TZ_STATISTICS_CLASSES];
    double turn[TZ_STATISTICS_TURNS]; /**< shares of the oriented ones; all 0 = none */
} tz_statistics;

/** @param reach  largest pair distance, less than half of every domain's sides
 *  @cost O(n); of more than 4,096 elements every few are centres */
tz_status tz_statistics_of(const tz_field *f, double spacing, double reach,
                           tz_statistics *out);
/** Share of elements that overlap another: nearer than 0.8 of the distance at which the two
 * touch, see elements/extent.h. */
tz_status tz_field_overlaps(const tz_field *f, double *share);
/** Radius of the widest disc in the domain that touches no element's outline, see
 * elements/extent.h, to about a hundredth of the spacing. */
tz_status tz_field_hole(const tz_field *f, double *radius);
/** Mean over f of the distance to the most alike neighbourhood of g, root mean square
 * over the `near` neighbours.
 * @source [Dav19] Eq. (5) */
tz_status tz_field_distance(const tz_field *f, const tz_field *g, double spacing,
                            int32_t near, double *out);

#endif
