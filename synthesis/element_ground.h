/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Ground of an element layout: the plate of its photo (the photo with the things taken
 * out), arranged over the domain as edge groups. In the element document it stands as a
 * layout of its own beneath the elements. */
#ifndef TZ_SYNTHESIS_ELEMENT_GROUND_H
#define TZ_SYNTHESIS_ELEMENT_GROUND_H

#include "analysis/ebpt.h"
#include "elements/element.h"
#include "synthesis/layout.h"

/** Analyses the plate and arranges it over the domain, one px a unit; on a torus it tiles.
 * @param plate   the photo's size, sRGB
 * @param path, sha256  of its file, as the layout is to name it
 * @param params  of the analysis
 * @param[out] ground  zeroed; filled; untouched on error
 * @return what tz_ebpt_analyze and tz_arrange return; TZ_INVALID (a domain over
 *   TZ_IMAGE_MAX_SIDE) */
TZ_API tz_status tz_element_ground_arrange(tz_ctx *ctx, const tz_image *plate,
                                           const char *path, const char *sha256,
                                           const tz_ebpt_params *params,
                                           const tz_domain *domain, uint64_t seed,
                                           tz_layout *ground);
/** Makes a ground the set's background.
 * @param document  path of the document that the set will be written to */
TZ_API tz_status tz_element_ground_embed(tz_ctx *ctx, const char *document,
                                         const tz_layout *ground, tz_element_set *set);
/** Whether a set's background is a ground. */
TZ_API bool tz_element_ground_is(const tz_element_set *set);
/** Reads the ground of a set that was read from `document`.
 * @param[out] ground  zeroed; filled where the set has one
 * @return what tz_layout_parse returns; TZ_OK where there is none */
TZ_API tz_status tz_element_ground_read(tz_ctx *ctx, const char *document,
                                        const tz_element_set *set, tz_layout *ground);

#endif
