/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Zones of a domain: which kinds of elements may lie where (constrained selection).
 * Immutable once made, read from any thread.
 * @source [Ma11] Sec. 4.5 */
#ifndef TZ_ELEMENTS_ZONES_H
#define TZ_ELEMENTS_ZONES_H

#include "base/ctx.h"
#include "elements/raster.h"

typedef struct tz_zones {
    tz_raster raster;
    uint8_t *zone;   /**< raster.width * raster.height, 0 .. zones-1 */
    uint64_t *allow; /**< per zone: bit of each kind that may lie there; kinds from 64 on
                          may lie anywhere */
    int32_t zones;   /**< 1..256 */
    tz_ctx *ctx;
} tz_zones;

/** Zones from a picture (SVG or image): each flat colour is a zone.
 * @param text   "#ff0000=leaf,flower;#0000ff=stone": which kinds each colour allows, by
 *               name; colours that are not named allow all
 * @param kinds, n  names of the kinds, in their order
 * @return TZ_OK; TZ_IO; TZ_FORMAT; TZ_INVALID (unknown kind or bad table, names it);
 *   TZ_LIMIT (over 255 colours named); TZ_NOMEM */
TZ_API tz_status tz_zones_read(tz_ctx *ctx, const char *path, const char *text,
                               const char *const *kinds, int32_t n, tz_vec3 size,
                               bool torus, tz_zones **out);
TZ_API void tz_zones_free(tz_zones *z); /**< takes NULL */

static inline bool tz_zones_allow(const tz_zones *z, tz_vec3 at, int32_t kind)
{
    return kind < 0 || kind >= 64 ||
           (z->allow[z->zone[tz_raster_at(&z->raster, at)]] >> kind & 1) != 0;
}

#endif
