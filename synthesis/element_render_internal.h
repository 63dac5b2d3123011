/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Parts of the element renderer. Not installed.
 *
 *   set ──drawing─▶ paths with flat paints, or a document for librsvg   element_drawing.c
 *       ──matte───▶ alpha, pure colour and shade of a cut-out           element_matte.c
 *       ──rim─────▶ what it carries along of the gap about it           element_rim.c
 *       ──cutout──▶ pixels ready for sampling, at the sizes needed      element_cutout.c
 *       ──bent────▶ elements that no rigid pose shows                   element_bent.c
 *       ──index───▶ which elements may show in which tiles              element_index.c
 *   tile ◀─render── all of these, one above the other                   element_render.c */
#ifndef TZ_SYNTHESIS_ELEMENT_RENDER_INTERNAL_H
#define TZ_SYNTHESIS_ELEMENT_RENDER_INTERNAL_H

#include "base/svg.h"
#include "elements/bend.h"
#include "synthesis/compose_internal.h"
#include "synthesis/element_cover_internal.h"
#include "synthesis/element_render.h"
#include "synthesis/element_vector_module.h"

enum { TZ_TABLE = 4096 };

/** sRGB and linear light of 0..1 by chords of tables: 1e-6 off at most. */
typedef struct tz_tables {
    float decode[TZ_TABLE + 2]; /**< linear light of sRGB k / TZ_TABLE */
    float encode[TZ_TABLE + 2]; /**< sRGB of the square of k / TZ_TABLE */
} tz_tables;

static inline float tz_tables_decode(const tz_tables *t, float v)
{
    if (!(v >= 0 && v <= 1))
        return tz_srgb_decode(v);
    const float u = v * TZ_TABLE;
    const int32_t i = (int32_t)u;
    return t->decode[i] + (u - (float)i) * (t->decode[i + 1] - t->decode[i]);
}
static inline float tz_tables_encode(const tz_tables *t, float v)
{
    if (!(v > 0.004F && v <= 1)) /* below, sRGB is straight and its root is not */
        return tz_srgb_encode(v);
    const float u = sqrtf(v) * TZ_TABLE;
    const int32_t i = (int32_t)u;
    return t->encode[i] + (u - (float)i) * (t->encode[i + 1] - t->encode[i]);
}

/** Rectangle of real numbers; empty where x0 > x1. */
typedef struct tz_bounds {
    double x0, y0, x1, y1;
} tz_bounds;

/** Bounds of b's corners after a map. */
tz_bounds tz_bounds_map(tz_bounds b, tz_affine m);

/* ---- one tile ------------------------------------------------------------------------ */

/** Pixels of a tile while elements are laid one above the other: linear light (maps: their
 * own numbers) times alpha, and alpha. */
typedef struct tz_layer {
    tz_rect rect; /**< canvas px that it shows */
    tz_f4 *px;    /**< TZ_ELEMENT_TILE a row */
    float *mask;  /**< not NULL: receives what the next element covers, not px */
} tz_layer;

/** Scratch memory of a worker. */
typedef struct tz_layer_work {
    tz_layer layer;
    float *mask;
    tz_cover cover;
    float *row; /**< coverage, or samples, of a row */
    tz_f4 *sum; /**< sums of samples */
    int32_t *label;
    uint32_t *block; /**< what librsvg draws into */
    void **document; /**< of each drawing, opened when first drawn */
    TZ_ARRAY(tz_vec2)
    point; /**< flattened */
    TZ_ARRAY(bool)
    smooth;
    const tz_tables *tables;
    const tz_vector_api *api;
    float decoded[256]; /**< linear light of sRGB k / 255, set along with api */
} tz_layer_work;

/** Source over: (colour, alpha) premultiplied. */
static inline void tz_layer_over(tz_f4 *at, tz_f4 v) { *at = v + *at * (1 - v[3]); }

/** Lays a flat colour, premultiplied, onto rows of the cover, which becomes empty.
 * @param row  scratch of a tile's width */
void tz_layer_paint(tz_layer *layer, tz_cover *c, float *row, tz_f4 colour,
                    bool even_odd);
/** Lays part of a layer over the picture `out` of canvas rectangle rect, which has
 * `colours` channels or one more for alpha. */
void tz_layer_lay(const tz_layer *layer, tz_rect part, int32_t colours, tz_map_kind kind,
                  tz_rect rect, tz_image *out);

/* ---- drawings ------------------------------------------------------------------------ */

/** Paint of one colour: linear light times alpha, alpha; alpha 0 = not painted. */
typedef struct tz_flat_part {
    tz_svg_path path; /**< empty: the circle */
    tz_vec2 centre;
    double radius;
    tz_f4 fill, stroke;
    bool even_odd;
    tz_pen pen; /**< width in the symbol's units */
} tz_flat_part;

/** A symbol (or the background) as it is drawn. */
typedef struct tz_drawing {
    TZ_ARRAY(tz_flat_part)
    part;
    char *document;   /**< not NULL: librsvg draws this */
    bool filtered;    /**< what it paints depends on pixels round about */
    const char *name; /**< of the symbol, for messages */
    tz_bounds box;    /**< of all that it paints, symbol's units */
} tz_drawing;

/** @param markup  of the symbol, "" = a plain disc of that radius
 * @param name  borrowed */
tz_status tz_drawing_init(tz_ctx *ctx, tz_drawing *d, const char *name,
                          const char *markup, double radius);
void tz_drawing_deinit(tz_ctx *ctx, tz_drawing *d); /**< takes zeroed */
/** Scales the widths of its lines, but for librsvg's. */
void tz_drawing_widen(tz_drawing *d, double scale);
/** Lays it onto a layer (or into its mask).
 * @param number  of the drawing: place of its open document in w->document */
tz_status tz_drawing_draw(tz_ctx *ctx, const tz_drawing *d, int32_t number, tz_affine map,
                          tz_layer *layer, tz_layer_work *w);

/* ---- photos -------------------------------------------------------------------------- */

/** Linear colour of a photo's pixel (nearest inside) in 3 lanes; raw: as it is.
 * @param t  NULL = slowly and exactly */
tz_f4 tz_photo_linear(const tz_image *photo, int32_t x, int32_t y, bool raw,
                      const tz_tables *t);
/** Channels without alpha. */
static inline int32_t tz_photo_colours(const tz_image *im)
{
    return im->channels - (im->alpha >= 0);
}

enum { TZ_LIGHT = 16 }; /* cells of a photo's light, along its longer side */

/** Slow light of a photo: means of luminance over cells, smoothed. */
typedef struct tz_photo_light {
    int32_t nx, ny;
    float v[TZ_LIGHT * TZ_LIGHT], mean;
} tz_photo_light;

/** Of the plate where there is one. */
void tz_photo_find_light(const tz_element_pixels *p, tz_photo_light *l);
/** Gain of what lies at photo px p, between half and double. */
float tz_photo_gain(const tz_photo_light *l, const tz_image *photo, tz_vec2 p,
                    double share);

/* ---- cut-outs ------------------------------------------------------------------------ */

/** Of one symbol at its photo's resolution; dense rows of box. */
typedef struct tz_matte {
    tz_rect box;     /**< photo px */
    float *alpha;    /**< 0..1 */
    float *distance; /**< to the outline, photo px, > 0 inside; far = +-reach */
    float *shade;    /**< 0 = no shadow .. 1 = black; NULL = none */
    float *rim;      /**< 0..1: how much of what lies behind, and beside, it carries
                          along; NULL = nothing */
    float *colour;   /**< 3 a pixel, linear, free of what lies behind */
    float reach;
} tz_matte;

/** What mattes of one photo share. */
typedef struct tz_matte_photo {
    const tz_image *photo, *plate;
    int32_t *label; /**< width * height: 0 = ground; number + 1 of the symbol that covers
                         half the pixel or more; its negative where it covers less; NULL =
                         nothing casts shadows or has rims */
    double rim;     /**< widest rim of this photo's things, px */
    bool sized;     /**< small things have narrower ones */
    float gap_lo[3], gap_hi[3]; /**< how most of what lies between things looks */
    bool shadows;               /**< kept */
    const tz_tables *tables;
} tz_matte_photo;

/** A point of a symbol in its photo, px. */
static inline tz_vec2 tz_matte_point(const tz_element_symbol *y, tz_vec2 p)
{
    return tz_vec2_add(y->photo_at, tz_vec2_scale(p, y->photo_scale));
}
/** Marks what the outline of symbol `number` covers in p->label. */
tz_status tz_matte_mark(tz_ctx *ctx, const tz_element_symbol *y, int32_t number,
                        tz_matte_photo *p);
/** @param params  of which shadow and matte count; box is empty if nothing lies within
 *   the photo
 * @param rim  of this symbol, px, 0 = none */
tz_status tz_matte_init(tz_ctx *ctx, const tz_element_symbol *y, int32_t number,
                        const tz_matte_photo *p, const tz_element_render_params *params,
                        double rim, tz_matte *m);
void tz_matte_deinit(tz_ctx *ctx, tz_matte *m);
/** Makes m->shade of a matte whose alpha and distances are known.
 * @param photo  linear, of m->box  @param band  px */
tz_status tz_matte_shade(tz_ctx *ctx, const tz_matte_photo *p, const tz_f4 *photo,
                         float band, tz_matte *m);

/** Looks at what lies between the things of a photo: sets p->gap_lo, p->gap_hi, and p->rim
 * where it is < 0. p->label is complete. */
tz_status tz_rim_look(tz_ctx *ctx, const tz_element_set *set, int32_t photo,
                      tz_matte_photo *p);
/** Width of a symbol's rim, px. */
double tz_rim_width(const tz_element_symbol *y, const tz_matte_photo *p);
/** Makes m->rim of a matte whose alpha and distances are known.
 * @param own  label of the symbol  @param photo  linear, of m->box  @param width  px */
tz_status tz_matte_rim(tz_ctx *ctx, const tz_matte_photo *p, int32_t own,
                       const tz_f4 *photo, float width, tz_matte *m);

enum { TZ_CUTOUT_LEVELS = 20 };

/** A symbol's pixels: planes at map px / 2^level, colour (as sRGB) times alpha, alpha. */
typedef struct tz_cutout {
    tz_rect box;    /**< map px of level 0 */
    uint8_t *solid; /**< alpha of level 0 without rim and shadow, 0..255 */
    tz_source_plane plane[TZ_CUTOUT_LEVELS];
    tz_source_plane shade[TZ_CUTOUT_LEVELS]; /**< 0 = light .. 1 = black, if shaded */
    bool shaded, encoded;                    /**< encoded: colour as sRGB */
    tz_f4 lo, hi;                            /**< range of colours, as planes hold them */
    float mx, my;                            /**< map px a photo px */
    uint32_t levels;                         /**< bit of each level that is needed */
    bool spline;     /**< some copy is not moved by whole pixels only */
    float gain;      /**< on colour, evens the light */
    double rim;      /**< photo px */
    tz_bounds local; /**< box in the symbol's units */
    const tz_tables *tables;
    bool empty;
} tz_cutout;

/** How one copy samples it. */
typedef struct tz_cutout_view {
    tz_affine inv; /**< canvas px -> px of the level, from the level's corner */
    int32_t level;
    int32_t taps; /**< samples a pixel and axis */
    bool exact;
    float turn[4]; /**< of normals */
} tz_cutout_view;

/** @param map  symbol -> canvas px */
tz_cutout_view tz_cutout_look(const tz_cutout *c, const tz_element_symbol *y,
                              tz_affine map);
/** Box and bounds of a symbol in its map, before planes are made.
 * @param rim  photo px */
void tz_cutout_place(tz_cutout *c, const tz_element_symbol *y, const tz_element_pixels *p,
                     const tz_element_render_params *params, double rim);
/** Makes the planes of c->levels. */
tz_status tz_cutout_fill(tz_ctx *ctx, tz_cutout *c, const tz_element_symbol *y,
                         const tz_element_pixels *p, const tz_matte *m, tz_map_kind kind);
void tz_cutout_deinit(tz_ctx *ctx, tz_cutout *c); /**< takes zeroed */
void tz_cutout_draw(const tz_cutout *c, const tz_element_symbol *y, tz_affine map,
                    tz_map_kind kind, tz_layer *layer, tz_layer_work *w);
/** A part of it under one view. @param part  canvas px, within the layer */
void tz_cutout_run(const tz_cutout *c, const tz_cutout_view *v, tz_map_kind kind,
                   tz_rect part, tz_layer *layer, tz_layer_work *w);

/* ---- index --------------------------------------------------------------------------- */

/** One showing of an element; on a torus it may show several times. */
typedef struct tz_showing {
    int32_t element; /**< -1 = the background */
    tz_affine map;   /**< symbol -> canvas px */
    tz_bounds box;   /**< canvas px */
} tz_showing;

/** Showings by squares of the canvas, in drawing order. */
typedef struct tz_showing_index {
    int32_t cell, nx, ny; /**< px, a multiple of TZ_ELEMENT_TILE */
    int64_t *first;       /**< nx * ny + 1 */
    int32_t *item;        /**< showings */
    TZ_ARRAY(tz_showing)
    showing; /**< in drawing order */
} tz_showing_index;

/** An element that is bent so far that one sees it. */
typedef struct tz_bent {
    int32_t element;
    tz_bend bend;
    tz_drawing
        drawing; /**< bent, world units about the element's place; of cut-outs none */
} tz_bent;

struct tz_element_renderer {
    const tz_element_set *set;
    tz_map_kind kind;
    tz_element_render_params params;
    int32_t width, height;
    double sx, sy; /**< px a unit */
    int32_t colours;
    bool encode;         /**< colour: pixels may be sRGB */
    int32_t depth;       /**< of what is shown: a hint for writers */
    bool *used;          /**< per symbol */
    tz_drawing *drawing; /**< per symbol, and the background */
    tz_cutout *cutout;   /**< per symbol */
    tz_tables *tables;
    int32_t *bent_of; /**< per element: index into bent, -1 = plain; NULL = all plain */
    TZ_ARRAY(tz_bent)
    bent;
    tz_showing_index index;
    tz_ctx *ctx;
};

/** Fills r->bent. */
tz_status tz_bent_init(tz_ctx *ctx, tz_element_renderer *r);
void tz_bent_deinit(tz_ctx *ctx, tz_element_renderer *r);
/** The warp of an element; NULL = its plain pose. */
static inline const tz_bent *tz_bent_find(const tz_element_renderer *r, int32_t element)
{
    const int32_t k = r->bent_of && element >= 0 ? r->bent_of[element] : -1;
    return k >= 0 ? &r->bent.v[k] : NULL;
}
/** Where it shows, canvas px. @param map  of its plain pose, symbol -> canvas px */
tz_bounds tz_bent_bounds(const tz_element_renderer *r, const tz_bent *b, tz_affine map);
/** Place of the symbol that shows at a place of the canvas. */
tz_vec2 tz_bent_source(const tz_element_renderer *r, const tz_bent *b, tz_affine map,
                       double x, double y);
/** Angle of its symbol's x axis there, radians. */
double tz_bent_angle(const tz_element_renderer *r, const tz_bent *b, tz_affine map,
                     double x, double y);
void tz_bent_draw_cutout(const tz_element_renderer *r, const tz_bent *b,
                         const tz_showing *p, tz_layer *layer, tz_layer_work *w);

/** Symbol of a showing is a cut-out. */
static inline bool tz_symbol_cut(const tz_element_symbol *y)
{
    return y->photo_scale > 0;
}
/** Fills r->index from elements, and c->levels of cut-outs. */
tz_status tz_showing_index_init(tz_ctx *ctx, tz_element_renderer *r);
void tz_showing_index_deinit(tz_ctx *ctx, tz_showing_index *ix);

struct tz_element_composer;
/** What renders its ground, on the canvas of the elements; NULL = none. */
const tz_composer *tz_element_composer_ground(const struct tz_element_composer *c);

/** Rows of a strip of rect that leave room in the context's budget. */
int32_t tz_element_strip(tz_ctx *ctx, tz_rect rect, int32_t channels);

#endif
