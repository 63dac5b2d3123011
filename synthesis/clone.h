/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Compositing by OpenCV's stock seamlessClone, one placement after another, as [Kim21]
 * does it: the reference that our own compositor is tested and timed against. Private. */
#ifndef TZ_SYNTHESIS_CLONE_H
#define TZ_SYNTHESIS_CLONE_H

#include "synthesis/compose_internal.h"

/** Renders the whole layout and cuts r out of it. 8 bits a channel inside: colours are
 * clipped to 0..1, data keeps the sources' range.
 * @param[out] out  r.w x r.h, as many channels as the composer
 * @return TZ_OK; TZ_INVALID (r leaves the layout, normal maps, neither grey nor RGB,
 *   OpenCV's refusal);
 *   TZ_UNSUPPORTED (module missing); TZ_NOMEM; TZ_CANCELLED
 * @cost the whole layout for any r; a discrete sine transform for each placement's box
 * @source [Kim21] Sec. 5.2; Perez, Gangnet, Blake: Poisson image editing, SIGGRAPH 2003 */
tz_status tz_clone_render(tz_ctx *ctx, const tz_composer *c, tz_rect r, tz_image *out);

#endif
