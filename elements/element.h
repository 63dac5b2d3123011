/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element textures: things (elements) and where they lie. One struct serves as exemplar
 * and as layout: in a layout each element tells which element of the exemplar it copies.
 * @source [Ma11] Sec. 3; [Dav19] Sec. 4. Lengths are user units of the document, y down */
#ifndef TZ_ELEMENTS_ELEMENT_H
#define TZ_ELEMENTS_ELEMENT_H

#include "base/array.h"
#include "elements/domain.h"

/** A point of an element. An element of one sample has it at its own position. Samples are
 * not wrapped: `at` of a sample less `at` of its element is their vector, also on a torus.
 */
typedef struct tz_sample {
    tz_vec3 at;    /**< in the world */
    int32_t id;    /**< of this sample within its element: pairs with the same id only */
    double weight; /**< in matching, > 0 */
} tz_sample;

/** A thing. Its shape is that of its symbol, turned by angle and scaled about `at`. */
typedef struct tz_element {
    int32_t kind;   /**< class: index into tz_element_set.kind */
    int32_t symbol; /**< shape: index into tz_element_set.symbol */
    int32_t source; /**< element of the exemplar that it copies; -1 in an exemplar */
    int32_t sample,
        samples;   /**< its samples: set.sample[sample .. sample + samples - 1] */
    tz_vec3 at;    /**< reference point: centre of its smallest circle */
    double angle;  /**< radians against the symbol, y down: positive turns clockwise */
    double scale;  /**< against the symbol, > 0 */
    double radius; /**< of the circle about `at` that holds it, at this scale */
    int32_t depth; /**< higher lies above lower */
    bool cut;      /**< cut by the exemplar's border: never copied as a whole */
    bool doubtful; /**< seen in part or not for sure: it counts, but is never copied */
    bool fixed;    /**< stays where it is */
} tz_element;

/** Whether an element of an exemplar may be copied. */
static inline bool tz_element_may_copy(const tz_element *e)
{
    return !e->cut && !e->doubtful;
}

typedef struct tz_element_kind {
    char *name;    /**< owned */
    bool oriented; /**< its elements have an axis that matters */
    bool is_void;  /**< stands for empty room (sparse patterns): drawn as nothing */
} tz_element_kind;

/** A shape in its own coordinates, reference point at the origin. */
typedef struct tz_element_symbol {
    char *id;      /**< of the <symbol> in documents, owned */
    char *markup;  /**< SVG content of the <symbol>, owned, "" = a plain disc */
    char *words;   /**< names and words ("leaf share=3") that its drawing has for it, with
                        blanks between; owned; NULL = not kept (layouts) */
    double radius; /**< of the circle about the origin that holds it */
    TZ_ARRAY(tz_vec2)
    outline; /**< polygons, flattened to 1/50 of the radius */
    TZ_ARRAY(int32_t)
    part;               /**< first point of each polygon */
    double photo_scale; /**< px of its photo a unit; 0 = drawn: it has none */
    tz_vec2 photo_at;   /**< px of its photo that the origin lies on */
    int32_t photo;      /**< index into tz_element_set.photo */
} tz_element_symbol;

/** A photo that shapes are cut from: what lies inside the outline, with a soft border. */
typedef struct tz_element_photo {
    char *path;      /**< as this program opens it; the document holds it relative to
                              itself; owned */
    char sha256[65]; /**< of the file, "" = unknown */
    int32_t width, height;
    char *plate; /**< photo of the ground with the things taken out, of the same size, or
                      NULL; owned */
} tz_element_photo;

typedef struct tz_element_set {
    tz_domain domain;
    TZ_ARRAY(tz_element)
    element;
    TZ_ARRAY(tz_sample)
    sample;
    TZ_ARRAY(tz_element_kind)
    kind;
    TZ_ARRAY(tz_element_symbol)
    symbol;
    TZ_ARRAY(tz_element_photo)
    photo;
    char *background; /**< SVG markup beneath all elements, owned; NULL = none */
    char *recipe;     /**< JSON text of how a layout was made, owned; NULL = none */
    tz_ctx *ctx;
} tz_element_set;

TZ_API void tz_element_set_deinit(tz_element_set *s); /**< takes zeroed */
/** Kinds, symbols, photos and background of `from`, no elements: the start of a layout.
 * The background is stretched over the domain.
 * @param domain   NULL = that of `from`
 * @param[out] to  overwritten, not freed (it may be uninitialised); zeroed on error
 * @return TZ_OK; TZ_NOMEM */
TZ_API tz_status tz_element_set_like(tz_ctx *ctx, const tz_element_set *from,
                                     const tz_domain *domain, tz_element_set *to);
/** Appends a copy of element `source` of `from` at a place: its samples are turned and
 * scaled along. It is not fixed, and lies at the source's depth.
 * @param from   with the same kinds and symbols; may be s itself
 * @param at     wrapped into the domain on a torus
 * @param angle, scale  added to, and multiplied with, the source's own; scale > 0
 * @return TZ_OK; TZ_NOMEM; TZ_LIMIT */
TZ_API tz_status tz_element_set_place(tz_element_set *s, const tz_element_set *from,
                                      int32_t source, tz_vec3 at, double angle,
                                      double scale);
/** Appends a copy of a symbol.
 * @return TZ_OK; TZ_NOMEM (the set is as before) */
TZ_API tz_status tz_element_symbol_copy(tz_element_set *to, const tz_element_symbol *y);
/** Checks what algorithms rely on: indices in range, samples inside the arrays, finite
 * numbers, positive radii and weights.
 * @return TZ_OK; TZ_INVALID (names the element) */
TZ_API tz_status tz_element_set_check(tz_ctx *ctx, const tz_element_set *s,
                                      const char *name);

#endif
