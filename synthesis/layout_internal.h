/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the layout's writer and reader share. */
#ifndef TZ_SYNTHESIS_LAYOUT_INTERNAL_H
#define TZ_SYNTHESIS_LAYOUT_INTERNAL_H

#include "base/href.h"
#include "base/svg.h"
#include "synthesis/layout.h"

/** Largest subpath of a clip's shape as a polygon, curves flattened, in its user space.
 * @param clip    <clipPath> element
 * @param[out] p  emptied array, filled
 * @return TZ_OK; TZ_FORMAT with line; TZ_NOMEM */
typedef TZ_ARRAY(tz_vec2)
tz_polygon;
tz_status tz_layout_clip_read(tz_ctx *ctx, const char *name, const tz_svg_doc *doc,
                              tz_svg_node clip, tz_polygon *p);

/* ---- reading --------------------------------------------------------------------- */

/** A clip path once read: its polygon, in its own space, as a range of the border pool.
 */
typedef struct tz_read_clip {
    int32_t border, points;
} tz_read_clip;

/** An <image> once read. */
typedef struct tz_read_photo {
    int32_t source;
    tz_affine box; /**< source px -> user units of the element */
} tz_read_photo;

typedef struct tz_read_slot {
    tz_svg_node node; /**< NULL = free */
    int32_t index;    /**< into tz_reader.clip or .photo */
} tz_read_slot;

/** What reading a layout carries along. */
typedef struct tz_reader {
    tz_ctx *ctx;
    const char *name; /**< of the document */
    tz_svg_doc *doc;
    tz_layout l;
    tz_read_slot *table; /**< open addressing by node */
    size_t used, room;
    TZ_ARRAY(tz_read_clip)
    clip;
    TZ_ARRAY(tz_read_photo)
    photo;
    TZ_ARRAY(int32_t)
    number;             /**< tz:source of each source, -1 = none */
    tz_polygon polygon; /**< scratch */
    int64_t steps;
    int32_t shapes; /**< drawn things that show no photo */
} tz_reader;

/** Reads an <image> element, at its first use; adds its source if that is new. */
tz_status tz_reader_photo(tz_reader *r, tz_svg_node n, tz_read_photo *out);
/** Border of a placement in the pool: the clip path seen from the photo, or all of the
 * photo.
 * @param clip      <clipPath> or NULL
 * @param clip_map  clip path's space -> layout
 * @param map       source px -> layout, invertible */
tz_status tz_reader_border(tz_reader *r, tz_svg_node clip, tz_affine clip_map,
                           tz_affine map, int32_t source, int32_t line, int32_t *border,
                           int32_t *points);
/** A length attribute in px; absent gives `otherwise`. */
tz_status tz_reader_length(tz_reader *r, tz_svg_node n, const char *name,
                           double otherwise, double *out);
/** Member by member. */
static inline bool tz_reader_same_map(tz_affine p, tz_affine q)
{
    return p.a == q.a && p.b == q.b && p.c == q.c && p.d == q.d && p.e == q.e &&
           p.f == q.f;
}
/** An integer in lo..hi. */
bool tz_reader_integer(const char *text, int32_t lo, int32_t hi, int32_t *out);

#endif
