/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Tree of regions: superpixels, joined two by two until one is left. Every node is a
 * region that may be a thing. Private to analysis/.
 * @source Salembier, Garrido, Binary partition tree, TIP 2000; Arbelaez et al., PAMI
 *   2011, Sec. 4 (strength of a border = mean along it) */
#ifndef TZ_ANALYSIS_THINGS_TREE_H
#define TZ_ANALYSIS_THINGS_TREE_H

#include "base/array.h"
#include "base/geom.h"

enum { TZ_THINGS_BINS = 4 };

/** What things are looked for in. */
typedef struct tz_things_picture {
    int32_t width, height;
    int32_t channels;  /**< of lab: 1 or 3 */
    const float *lab;  /**< channels planes, lightness first */
    const float *edge; /**< width * height, 0..1: how surely a border runs there */
} tz_things_picture;

/** A region. Sums run over its pixels, or over pairs of pixels on its outline. */
typedef struct tz_things_node {
    int32_t child[2]; /**< -1: a superpixel */
    int32_t parent;   /**< -1: the root */
    double area;
    double colour[3], colour2;   /**< sums of lab and of its square */
    double inner;                /**< sum of edge over the pixels */
    double x, y, xx, xy, yy;     /**< moments about the photo's corner */
    double perimeter;            /**< pairs, without the photo's border */
    double frame;                /**< pixel sides on the photo's border */
    double edge;                 /**< sum over the outline */
    double light;                /**< sum of lightness over the outline */
    int32_t bin[TZ_THINGS_BINS]; /**< pairs by edge: up to 0.1, 0.25, 0.5, 1 */
    double level;           /**< strength of the border that was removed in it last */
    double strongest;       /**< the largest level in it */
    double hull;            /**< area of its convex hull, 0 = too large to matter */
    int32_t x0, y0, x1, y1; /**< box, x1 and y1 outside */
} tz_things_node;

typedef struct tz_things_tree {
    tz_things_node *node; /**< leaves first, children before parents */
    int32_t leaves, n;    /**< n = 2 leaves - 1 */
    int32_t *leaf;        /**< width * height: the leaf of each pixel */
    double spread;        /**< of the leaves' colours */
    tz_ctx *ctx;
} tz_things_tree;

/** @param step     px, width of the superpixels
 *  @param largest  px: hulls of larger areas are not looked at
 *  @param[out] t   replaced; empty on error
 *  @cost O(pixels + superpixels log superpixels) */
tz_status tz_things_tree_grow(tz_ctx *ctx, const tz_things_picture *in, double step,
                              double largest, tz_things_tree *t);
void tz_things_tree_deinit(tz_things_tree *t); /**< takes zeroed */

#endif
