/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Fields, partial by nature: strokes and images that say at some places which way things
 * point, how large they are and how densely they lie. Elsewhere nothing is said, and who
 * arranges decides.
 *
 * A drawing of strokes: each path, line or outline that is seen points along itself and
 * speaks under its width; what is only filled and covers all of the view is left out. Its
 * tz:class, or its label in Inkscape (inkscape:label), or the tz:class of the group or
 * <use> that it is drawn by, holds words, all optional, numbers one for the stroke or
 * several, spread evenly along it and linear between:
 *
 *   size=2  size=1,2,1   factor of the things' own size, 0.001 .. 1000
 *   density=0.5          1 = as dense as the rest, 0 = sparsest
 *   weight=3             of its say against continuity, and against lighter strokes
 *   direction=no         says nothing about directions
 * @source [Hsu20] Sec. Autocomplete, Field alignment, Distribution manipulation */
#ifndef TZ_ELEMENTS_FIELD_H
#define TZ_ELEMENTS_FIELD_H

#include "base/array.h"
#include "elements/raster.h"

#define TZ_ELEMENT_FIELD_LEAST_SIZE  1e-3
#define TZ_ELEMENT_FIELD_MOST_SIZE   1e3
#define TZ_ELEMENT_FIELD_MOST_WEIGHT 1e6

/** A point of a stroke. */
typedef struct tz_element_field_point {
    tz_vec2 at;
    double size;    /**< within the limits above; 0 = not said */
    double density; /**< 0 .. 1; < 0 = not said */
} tz_element_field_point;

typedef struct tz_element_field_stroke {
    int32_t point, points; /**< tz_element_field.point */
    double radius;         /**< half of its width, user units; >= 0 */
    double weight;         /**< > 0, <= 1e6 */
    bool directed;         /**< says directions */
    bool closed;
} tz_element_field_stroke;

typedef enum tz_element_field_map {
    TZ_ELEMENT_FIELD_DIRECTION, /**< red, green = vector (green down; 0.5 = 0, in files of
                                   floating point numbers 0 = 0); grey = angle */
    TZ_ELEMENT_FIELD_SIZE,      /**< value / 0.5: mid grey is size 1; 0 = not said */
    TZ_ELEMENT_FIELD_DENSITY    /**< value 0 .. 1 */
} tz_element_field_map;

/** What can be said: direction, size, density. */
enum { TZ_ELEMENT_FIELD_SAYINGS = 3 };

/** What is said in one cell. */
typedef struct tz_element_field_cell {
    float x, y;                             /**< unit vector; 0, 0 = not said */
    float size;                             /**< 0 = not said */
    float density;                          /**< < 0 = not said */
    float weight[TZ_ELEMENT_FIELD_SAYINGS]; /**< of direction, size, density; 0 where that
                                                 is not said */
} tz_element_field_cell;

/** Strokes are kept as they were drawn; `cell` is what they and the images say. */
typedef struct tz_element_field {
    tz_raster raster;
    TZ_ARRAY(tz_element_field_stroke)
    stroke;
    TZ_ARRAY(tz_element_field_point)
    point;
    tz_element_field_cell
        *image;                  /**< what images say, beneath the strokes; NULL = none */
    tz_element_field_cell *cell; /**< after tz_element_field_settle */
    int32_t *nearest[3]; /**< of each cell the nearest one that says direction, size,
                               density; -1 = none does */
    tz_ctx *ctx;
} tz_element_field;

/** An empty field over a domain, which says nothing.
 * @param side  cells along the longer side, 1 .. 4096; 0 = 512
 * @return TZ_OK; TZ_INVALID; TZ_NOMEM */
TZ_API tz_status tz_element_field_init(tz_ctx *ctx, tz_vec3 size, bool torus,
                                       int32_t side, tz_element_field *f);
TZ_API void tz_element_field_deinit(tz_element_field *f); /**< takes zeroed */
/** Appends a stroke. Between two points size and density are said where both say them.
 * @param s  point, points are set by the call
 * @return TZ_OK; TZ_INVALID (not numbers, no point, a weight or radius out of range);
 *   TZ_LIMIT (over 10 million points); TZ_NOMEM */
TZ_API tz_status tz_element_field_add(tz_element_field *f, tz_element_field_stroke s,
                                      int32_t n, const tz_element_field_point *point);
/** Takes strokes away: those that a disc meets. */
TZ_API void tz_element_field_erase(tz_element_field *f, tz_vec2 at, double radius);
/** Places the strokes of another field again (a preset), mapped; widths are scaled along.
 * @return TZ_OK; TZ_INVALID (the map has no inverse); TZ_LIMIT; TZ_NOMEM */
TZ_API tz_status tz_element_field_place(tz_element_field *f,
                                        const tz_element_field *preset, tz_affine map);
/** Adds the strokes of a drawing, whose view is stretched over the domain. Strokes of no
 * length and those out of view say nothing.
 * @return TZ_OK; TZ_IO; TZ_FORMAT; TZ_INVALID (no strokes in view; a word that is unknown
 *   or out of range, names file, line and path); TZ_LIMIT; TZ_NOMEM; TZ_CANCELLED */
TZ_API tz_status tz_element_field_read_strokes(tz_element_field *f, const char *path);
/** Adds what an image says everywhere (but where it is transparent); means of pixels.
 * @return TZ_OK; TZ_IO; TZ_FORMAT; TZ_INVALID (it says nothing at all); TZ_NOMEM */
TZ_API tz_status tz_element_field_read_image(tz_element_field *f, const char *path,
                                             tz_element_field_map map);
/** Reads a drawing of strokes or (other suffix) an image of directions: all of a field.
 * @param[out] f  overwritten; zeroed on error */
TZ_API tz_status tz_element_field_read(tz_ctx *ctx, const char *path, tz_vec3 size,
                                       bool torus, tz_element_field *f);
/** Works out the cells; to be called after changes and before use. Where strokes meet in a
 * cell the later one has its say. @return TZ_OK; TZ_LIMIT (strokes that cover
 * it thousands of times over); TZ_NOMEM @cost O(cells + strokes) */
TZ_API tz_status tz_element_field_settle(tz_element_field *f);

/** What is said at a place; NULL = nothing. */
static inline const tz_element_field_cell *tz_element_field_at(const tz_element_field *f,
                                                               tz_vec3 at)
{
    const tz_element_field_cell *c = &f->cell[tz_raster_at(&f->raster, at)];
    return c->weight[0] > 0 || c->weight[1] > 0 || c->weight[2] > 0 ? c : NULL;
}

#endif
