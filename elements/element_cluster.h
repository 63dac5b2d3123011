/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Classes by look: of drawn symbols and of things cut from photos. Not installed. */
#ifndef TZ_ELEMENTS_ELEMENT_CLUSTER_H
#define TZ_ELEMENTS_ELEMENT_CLUSTER_H

#include "elements/element_shape.h"

enum { TZ_ELEMENT_LOOKS = 6, TZ_ELEMENT_CLASSES = 64 };

/** What a symbol looks like: a distance of 1 is another class. */
typedef struct tz_element_look {
    double v[TZ_ELEMENT_LOOKS];
    double fullness; /**< area over that of the circle that holds it */
    int32_t count;   /**< elements of the symbol; 0: it does not count */
    int32_t kind;    /**< its cluster */
} tz_element_look;

/** Oklab of linear light: distances in it are about as large as they look. */
void tz_element_lab(const double rgb[3], double lab[3]);
/** @param lab  mean colour  @param polys  outline of a symbol with this radius
 *  @param size  radius of its elements */
void tz_element_look_at(const double lab[3], const tz_polys *polys, double radius,
                        double size, tz_element_look *look);

/** Clusters by farthest-first seeds and k-means (wanted > 0), or by leaders (0): a symbol
 * farther than 1 from every leader so far becomes one. Sets kind, 0 .. 63.
 * @return TZ_OK; TZ_NOMEM */
tz_status tz_element_cluster(tz_ctx *ctx, tz_element_look *look, int32_t n,
                             int32_t wanted);

#endif
