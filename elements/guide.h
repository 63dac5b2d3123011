/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Drawings and pictures that guide an arrangement (regions, directions, zones), brought
 * to the size of the domain. Not installed. */
#ifndef TZ_ELEMENTS_GUIDE_H
#define TZ_ELEMENTS_GUIDE_H

#include "base/image_io.h"
#include "elements/element_svg_internal.h"
#include "elements/raster.h"

enum { TZ_GUIDE_SIDE = 1024 /**< cells along the longer side of a drawn guide */ };

/** Raster of square cells over a domain, `side` along the longer side.
 * @return TZ_OK; TZ_INVALID where the domain has no area */
tz_status tz_guide_raster(tz_ctx *ctx, tz_vec3 size, bool torus, int32_t side,
                          tz_raster *out);

/** Whether the name ends in .svg. */
bool tz_guide_is_svg(const char *path);

/** Shapes of a drawing in drawing order: r->part, points in units of the domain, the view
 * stretched over it. Free with tz_element_reader_deinit also after an error.
 * @return TZ_OK; TZ_IO; TZ_FORMAT; TZ_LIMIT; TZ_NOMEM */
tz_status tz_guide_read_svg(tz_ctx *ctx, const char *path, tz_vec3 size,
                            tz_element_reader *r);
/** "; convert texts to paths" where the drawing holds some, else "". */
const char *tz_guide_hint(const tz_element_reader *r);

/** An image, plain numbers as they stand in the file, made smaller by whole factors until
 * no side is over `most`. With `sharp` by leaving out, else by means. */
tz_status tz_guide_read_image(tz_ctx *ctx, const char *path, int32_t most, bool sharp,
                              tz_image *im);

/** Called for cells x0 .. x1 - 1 of one row that lie inside. */
typedef void (*tz_guide_span)(void *user, int32_t row, int32_t x0, int32_t x1);
/** Calls `span` for the cells whose centres lie inside polygons; parts are closed.
 * @return TZ_OK; TZ_NOMEM; TZ_LIMIT */
tz_status tz_guide_fill(tz_ctx *ctx, const tz_raster *raster, const tz_polys *polys,
                        bool even_odd, tz_guide_span span, void *user);

#endif
