/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Layout: where copies go. A list of placed things in drawing order, small even for a
 * texture of many gigapixels, independent of pixels. All media meet here. */
#ifndef TZ_SYNTHESIS_LAYOUT_H
#define TZ_SYNTHESIS_LAYOUT_H

#include "base/array.h"
#include "base/geom.h"
#include "base/image.h"

typedef enum tz_medium {
    TZ_MEDIUM_EDGE_GROUP,
    TZ_MEDIUM_ELEMENT,
    TZ_MEDIUM_CURVE
} tz_medium;

/** A photo (or drawing) that placements take their pixels from. */
typedef struct tz_layout_source {
    char *path;      /**< as this program opens it: relative to the working folder, or
                             absolute; the document holds it relative to itself */
    char sha256[65]; /**< of the file, "" = unknown */
    int32_t width, height;
} tz_layout_source;

/** One placed thing. An edge group shows the source's pixels inside its border, moved by
 * `map`. Later placements cover earlier ones. */
typedef struct tz_placement {
    tz_affine map;   /**< source px -> layout px */
    int32_t source;  /**< index into tz_layout.source */
    int32_t group;   /**< edge group of the source's EBPT, -1 = none (drawn by hand) */
    int32_t border;  /**< first of its border points in tz_layout.border */
    int32_t points;  /**< 3 or more; simple polygon, source px */
    uint8_t medium;  /**< tz_medium */
    uint8_t fixed;   /**< set by the artist: arranging again keeps it */
    uint8_t removed; /**< left out; slots keep their ids until tz_layout_compact */
} tz_placement;

typedef struct tz_point {
    float x, y;
} tz_point;

typedef struct tz_layout {
    int32_t width, height; /**< px */
    bool tile;             /**< lives on a torus: things wrap at the borders */
    TZ_ARRAY(tz_layout_source)
    source;
    TZ_ARRAY(tz_placement)
    place; /**< in drawing order, first = lowest */
    TZ_ARRAY(tz_point)
    border;       /**< pool of border points */
    char *recipe; /**< JSON text or NULL */
    tz_ctx *ctx;
} tz_layout;

/** Empty layout. @return TZ_OK; TZ_INVALID (sizes outside 1 .. TZ_IMAGE_MAX_SIDE) */
TZ_API tz_status tz_layout_init(tz_ctx *ctx, tz_layout *l, int32_t width, int32_t height,
                                bool tile);
TZ_API void tz_layout_deinit(tz_layout *l); /**< takes zeroed */
/** Adds a source. */
TZ_API tz_status tz_layout_add_source(tz_layout *l, const char *path, const char *sha256,
                                      int32_t width, int32_t height, int32_t *id);
/** Appends a placement on top. @param border n points in source px, n >= 3
 *  @return TZ_OK; TZ_INVALID (bad source, map not invertible, n < 3); TZ_NOMEM */
TZ_API tz_status tz_layout_add(tz_layout *l, int32_t source, int32_t group, tz_affine map,
                               const tz_point *border, int32_t n, int32_t *id);
/** Bounding box in layout px of a placement's border under its map, rounded outwards. */
TZ_API tz_rect tz_layout_box(const tz_layout *l, int32_t id);
/** Topmost placement at a point of the layout (wrapped on a torus), or -1. */
TZ_API int32_t tz_layout_at(const tz_layout *l, tz_vec2 p);
/** Drops removed placements and unused border points; ids change. */
TZ_API tz_status tz_layout_compact(tz_layout *l);

/** Short stamp of a map, by which a document tells what was moved since it was written:
 * equal maps have equal stamps; others do too once in 2^32. */
TZ_API uint32_t tz_layout_stamp(tz_affine map);

/** SVG 1.1: opens in Inkscape and browsers and shows as it will look; each placement is a
 * <g transform> of the clipped photo, so that it can be moved there and read back.
 * Round trip is exact (maps and borders bit for bit). */
TZ_API tz_status tz_layout_write(tz_ctx *ctx, const char *path, const tz_layout *l);
/** The same as an <svg> element that can stand within another document.
 * @param path  of that document: photos are referred to from there
 * @param[out] text  caller frees with tz_free */
TZ_API tz_status tz_layout_text(tz_ctx *ctx, const char *path, const tz_layout *l,
                                char **text);
/** Reads a layout, also after Inkscape has edited it: nested groups and transforms are
 * multiplied, order is drawing order, hidden or deleted placements are gone.
 * @return TZ_OK; TZ_IO; TZ_FORMAT with line and fault; TZ_LIMIT; TZ_NOMEM */
TZ_API tz_status tz_layout_read(tz_ctx *ctx, const char *path, tz_layout *l);
/** The same from text in memory; `name` stands in messages, and photos are found from its
 * folder. */
TZ_API tz_status tz_layout_parse(tz_ctx *ctx, const char *name, const char *text,
                                 size_t size, tz_layout *l);

/* ---- editing, with undo --------------------------------------------------------- */

/** Journal of edits on a layout; each edit reports which pixels it touched. While a journal
 * is open the layout changes through it alone, and tz_layout_compact waits: ids must hold.
 * What is placed or changed by hand becomes `fixed`. On error nothing is changed. */
typedef struct tz_layout_edit tz_layout_edit;
TZ_API tz_status tz_layout_edit_new(tz_layout *l,
                                    tz_layout_edit **out); /**< l must outlive it */
TZ_API void tz_layout_edit_free(tz_layout_edit *e);
/** (Where a layout leaves void, the nearest placements fill it, and moving one may change
 * void pixels anywhere: render the whole again there.)
 * Each returns in *dirty the layout rectangle where the placement showed before or shows
 * now (the whole layout where a torus would make it wrap; w = h = 0 if outside). The
 * compositor's correction reaches beyond it: grow it by the compositor's reach (on a torus
 * with wrap) before rendering again, then the rest of the picture keeps its bytes. */
TZ_API tz_status tz_layout_edit_place(tz_layout_edit *e, int32_t source, int32_t group,
                                      tz_affine map, const tz_point *border, int32_t n,
                                      int32_t *id, tz_rect *dirty);
TZ_API tz_status tz_layout_edit_map(tz_layout_edit *e, int32_t id, tz_affine map,
                                    tz_rect *dirty);
TZ_API tz_status tz_layout_edit_move(tz_layout_edit *e, int32_t id, tz_vec2 by,
                                     tz_rect *dirty);
/** Turns about the placement's centre (mean of its border). */
TZ_API tz_status tz_layout_edit_rotate(tz_layout_edit *e, int32_t id, double angle,
                                       tz_rect *dirty);
TZ_API tz_status tz_layout_edit_scale(tz_layout_edit *e, int32_t id, double factor,
                                      tz_rect *dirty);
TZ_API tz_status tz_layout_edit_remove(tz_layout_edit *e, int32_t id, tz_rect *dirty);
TZ_API tz_status tz_layout_edit_undo(tz_layout_edit *e,
                                     tz_rect *dirty); /**< TZ_INVALID: nothing */
TZ_API tz_status tz_layout_edit_redo(tz_layout_edit *e, tz_rect *dirty);

TZ_API bool tz_layout_edit_can_undo(const tz_layout_edit *e);
TZ_API bool tz_layout_edit_can_redo(const tz_layout_edit *e);

#endif
