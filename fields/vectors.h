/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How long the vectors of an image are: for fields to be shown by the sizes or colours of
 * things that lie along them. Their directions are read by elements/field.h.
 * @source [Hsu20] Fig. 19, in the plane */
#ifndef TZ_FIELDS_VECTORS_H
#define TZ_FIELDS_VECTORS_H

#include "elements/field.h"

typedef struct tz_vectors {
    tz_raster raster;
    float *length;   /**< of each cell, against the greatest: 0 .. 1 */
    double greatest; /**< as it stands in the file */
    tz_ctx *ctx;
} tz_vectors;

/** Reads red and green as vectors, 0 = 0 in files of floating point numbers (EXR), else
 * 0.5; where the image is transparent, or holds no number, the length is 0.
 * @param[out] v  overwritten; zeroed on error
 * @return TZ_OK; TZ_IO; TZ_FORMAT; TZ_INVALID (a grey image, which has angles alone; all
 *   of them are 0; names the file); TZ_NOMEM */
TZ_API tz_status tz_vectors_read(tz_ctx *ctx, const char *path, tz_vec3 size, bool torus,
                                 tz_vectors *v);
TZ_API void tz_vectors_deinit(tz_vectors *v); /**< takes zeroed */
/** Says sizes beneath the strokes of a field: `least` where vectors are 0, `most` where
 * they are longest, linear between. The field is to be settled again afterwards.
 * @return TZ_OK; TZ_INVALID (a size out of the field's range); TZ_NOMEM */
TZ_API tz_status tz_vectors_say_sizes(const tz_vectors *v, double least, double most,
                                      tz_element_field *field);
/** Length at a place, 0 .. 1, bilinear. */
static inline double tz_vectors_at(const tz_vectors *v, tz_vec3 at)
{
    return tz_raster_sample(&v->raster, v->length, at);
}

#endif
