/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Plates of other maps of a material: what a photo's plate (the photo with the things taken
 * out, the holes filled with patches of its own ground) is for the photo, for its heights,
 * normals and the like.
 * @source Barnes, Shechtman, Finkelstein, Goldman, PatchMatch, SIGGRAPH 2009; Rong, Tan,
 *   Jump flooding in GPU, I3D 2006 */
#ifndef TZ_SYNTHESIS_PLATE_MAP_H
#define TZ_SYNTHESIS_PLATE_MAP_H

#include "base/image.h"

/** Where photo and plate show the same, but for slow light, the map is kept; elsewhere it
 * is copied from that sure ground whose colours the plate repeats there, pixel by pixel:
 * nothing is blended or turned, so that normals and identities stay what they are.
 * @param photo, plate  of one size and channel count
 * @param map   of the photo's proportions, to a pixel and a half
 * @param[out] out  overwritten; empty on error; like `map` in size, channels and encoding.
 *   A copy of it where photo and plate have nothing in common
 * @return TZ_OK; TZ_INVALID (sizes do not fit); TZ_NOMEM; TZ_CANCELLED
 * @cost about 1.5 us a pixel of the photo that is no ground; 40 bytes a pixel of the photo.
 *   Parallel inside; the same bytes at any thread count */
TZ_API tz_status tz_plate_map(tz_ctx *ctx, const tz_image *photo, const tz_image *plate,
                              const tz_image *map, tz_image *out);

#endif
