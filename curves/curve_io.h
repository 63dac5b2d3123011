/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curve textures out of any SVG, and back.
 *
 * What is stroked becomes paths; what is filled and long and thin (a stroke turned into
 * an outline) becomes its centre line, as wide as it was. Other filled shapes are no
 * curves, but may become elements. Transforms, viewBox, units, style attributes, CSS
 * classes and <use> are followed. Of what runs far outside of the view (by more than its
 * longer side) nothing is kept there. */
#ifndef TZ_CURVES_CURVE_IO_H
#define TZ_CURVES_CURVE_IO_H

#include "curves/curve.h"

/** All zero: all that is described above. */
typedef struct tz_curve_read_options {
    double reach;   /**< gap that ends are joined over, as in tz_curve_join_params */
    bool as_drawn;  /**< paths are not joined, chained or thinned */
    bool crossings; /**< where paths cross they are joined */
    bool elements;  /**< filled shapes that are no curves become elements (equal ones
                         share a symbol); else they are left out, with a warning */
    bool outlines;  /**< filled shapes count as their outlines, not their centre lines */
} tz_curve_read_options;

/** @param options  NULL = all zero
 * @param[out] s  overwritten, not freed; zeroed on error; the domain is the viewBox moved
 *   to 0, 0
 * @return TZ_OK; TZ_IO; TZ_FORMAT (line and fault); TZ_INVALID (no curves in it);
 *   TZ_LIMIT; TZ_NOMEM
 * @cost O(n log n) for a drawing that does not lie in one spot */
TZ_API tz_status tz_curve_read_svg(tz_ctx *ctx, const char *path,
                                   const tz_curve_read_options *options, tz_curve_set *s);
/** The same of a text in memory; `name` stands for it in messages. A zero byte follows
 * text[size - 1]. */
TZ_API tz_status tz_curve_parse_svg(tz_ctx *ctx, const char *name, const char *text,
                                    size_t size, const tz_curve_read_options *options,
                                    tz_curve_set *s);

/** Writes one <path> a path. Reading gives the same set, bit for bit; after an editor has
 * been at it, it is read like any drawing. A foreign viewer shows it as it is.
 * @return TZ_OK; TZ_INVALID (the set is not sound); TZ_IO; TZ_NOMEM */
TZ_API tz_status tz_curve_write_svg(tz_ctx *ctx, const char *path, const tz_curve_set *s);

#endif
