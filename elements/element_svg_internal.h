/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Shared by the files that read elements out of SVG. Not installed.
 *
 *   document ──walk──▶ parts (one drawn shape each), spans (the groups they stand in)
 *            ──group─▶ things (one element each: its parts and their map to the view)
 *            ──symbol▶ elements and symbols (equal shapes share one)
 *            ──wrap──▶ pieces at opposite borders joined
 *            ──class─▶ kinds, samples */
#ifndef TZ_ELEMENTS_ELEMENT_SVG_INTERNAL_H
#define TZ_ELEMENTS_ELEMENT_SVG_INTERNAL_H

#include "elements/element_io.h"
#include "elements/element_shape.h"

/** How a shape is painted. All bytes count: compared with memcmp, so zero it first. */
typedef struct tz_look {
    uint32_t fill, stroke; /**< 0xrrggbbaa, aa = 0: not painted */
    double width;          /**< of the stroke, in the path's own units */
    uint32_t rule;         /**< 0 nonzero, 1 evenodd */
    uint32_t cap, join;    /**< butt, round, square; miter, round, bevel */
    uint32_t pad;
} tz_look;

/** Style in force at a node. */
typedef struct tz_style {
    uint32_t fill, stroke, color; /**< 0xrrggbbaa */
    double fill_opacity, stroke_opacity, opacity, width;
    uint32_t rule, cap, join;
    bool visible, shown;
    tz_svg_node pattern; /**< that the fill names, or NULL */
} tz_style;

/** A drawn shape. */
typedef struct tz_part {
    int32_t verb, verbs;   /**< tz_element_reader.verb */
    int32_t point, points; /**< tz_element_reader.point */
    tz_look look;
    tz_box box; /**< of the curve's control points, without its stroke */
    bool round; /**< a circle */
    bool owned; /**< belongs to a thing already */
    int32_t line, order;
    const char *name;  /**< tz:class, or NULL */
    const char *id;    /**< or NULL */
    const char *label; /**< inkscape:label, or NULL */
    const char *group; /**< tz:class of the innermost group or <use> that has one */
    tz_svg_node node,
        up; /**< what it is drawn by; the innermost group about it, or NULL */
} tz_part;

/** A group of the document: parts first .. end - 1, and the spans within it follow. */
typedef struct tz_span {
    int32_t first, end;
    int32_t next; /**< index of the first span that is not inside */
} tz_span;

/** One element to be. */
typedef struct tz_thing {
    int32_t item, items;  /**< its parts: tz_element_reader.item */
    tz_affine map;        /**< of its parts to the view */
    bool use;             /**< of a symbol, which keeps its frame */
    tz_svg_node target;   /**< that it uses */
    tz_svg_node node, up; /**< where words about it stand: its own go before up's */
    const char *name;     /**< class, or NULL */
    int32_t order;        /**< drawing order */
    int32_t line;
} tz_thing;

typedef struct tz_css_rule {
    const char *name; /**< into css text, terminated */
    const char *body;
    char kind; /**< '.', '#', 'e' or '*' */
    int32_t order;
} tz_css_rule;

typedef struct tz_element_reader {
    tz_ctx *ctx;
    const char *name; /**< of the file */
    tz_svg_doc *doc;
    tz_element_read_options opt;
    tz_vec2 view;  /**< size of the view */
    bool tile;     /**< the document says that it repeats */
    bool may_lack; /**< a document of ours without elements is fine */
    char *css;
    TZ_ARRAY(tz_css_rule)
    rule;
    TZ_ARRAY(uint8_t)
    verb;
    TZ_ARRAY(tz_vec2)
    point;
    TZ_ARRAY(tz_part)
    part;
    TZ_ARRAY(tz_span)
    span;
    TZ_ARRAY(int32_t)
    item;
    TZ_ARRAY(tz_thing)
    thing;
    TZ_ARRAY(char)
    background;
    tz_svg_node pattern; /**< painted over the whole view, or NULL */
    int32_t steps, ignored;
    int32_t copied;  /**< steps within <use> */
    void *templates; /**< of <use>, element_svg_walk.c */
    tz_element_set set;
} tz_element_reader;

/* element_svg_read.c */
/** Elements, with symbols and kinds, of the shapes of a walked drawing that nothing owns;
 * none at all is fine. Neither background nor what a border cuts in two is looked after. */
tz_status tz_element_from_parts(tz_element_reader *r);
/** Size of the view, and the map that moves its corner to 0, 0. */
tz_status tz_element_view(tz_element_reader *r, tz_affine *map);
void tz_element_reader_deinit(tz_element_reader *r);

/* element_style.c */
tz_style tz_style_initial(void);
tz_status tz_style_load(tz_element_reader *r);
/** The style at n, given that of its parent.
 * @return TZ_OK; TZ_FORMAT for numbers that cannot be read */
tz_status tz_style_at(tz_element_reader *r, tz_svg_node n, const tz_style *up,
                      tz_style *out);
tz_look tz_style_look(const tz_style *s);
/** A length with a unit in px; % of `whole`. False if it is none. */
bool tz_style_length(const char *text, double whole, double *out);

/* element_svg_shape.c */
/** Appends a part where n is a shape that has an extent; no part otherwise.
 * @return TZ_OK; TZ_FORMAT; TZ_LIMIT; TZ_NOMEM */
tz_status tz_part_add(tz_element_reader *r, tz_svg_node n, const tz_style *style,
                      tz_affine map, bool owned);
/** A length attribute; `missing` where it is not there. */
tz_status tz_element_length(tz_element_reader *r, tz_svg_node n, const char *name,
                            double whole, double missing, double *out);

/* element_svg_walk.c */
/** The whole drawing, or (node not NULL) the content of one node through a map. */
tz_status tz_element_walk(tz_element_reader *r, tz_svg_node content, tz_affine map);
/** All shapes of the drawing as parts, in drawing order; no things, no background. */
tz_status tz_element_walk_shapes(tz_element_reader *r, tz_affine map);
void tz_element_walk_end(tz_element_reader *r);

/* element_group.c */
/** Turns parts that no thing owns into things: compounds and separate shapes. */
tz_status tz_element_group(tz_element_reader *r, int32_t first_part, int32_t first_span);
/** Polygons of a part in the units of `map`; stroke outlines where it is not filled. */
tz_status tz_part_polys(tz_element_reader *r, const tz_part *p, tz_affine map,
                        double tolerance, tz_polys *out);
/** Half of the pen's width where the part is stroked, else 0. */
double tz_part_pen(const tz_part *p);
/** Joins i and j in a forest of n parents; finds a root. */
int32_t tz_forest_root(int32_t *up, int32_t i);
void tz_forest_join(int32_t *up, int32_t i, int32_t j);

/* element_words.c */
/** Names and words of a thing, blanks between, those of `up` first; each may be NULL.
 * @param[out] out  owned by the caller */
tz_status tz_element_words(tz_ctx *ctx, tz_svg_node up, tz_svg_node node, char **out);

/* element_symbol.c */
/** Elements and symbols of things first .. n - 1. */
tz_status tz_element_symbols(tz_element_reader *r, int32_t first);

/* element_markup.c */
/** Whether the part is a circle after the map. */
bool tz_part_circle(const tz_element_reader *r, const tz_part *p, tz_affine map,
                    tz_vec2 *centre, double *radius);
/** Markup of parts, moved by `map` and then drawn at scale 1; digits by `radius`. */
tz_status tz_element_markup(tz_element_reader *r, const int32_t *item, int32_t items,
                            tz_affine map, double radius, char **out);

/** Outline of a symbol, its radius set, of parts through a map. */
tz_status tz_element_outline(tz_element_reader *r, const int32_t *item, int32_t items,
                             tz_affine map, tz_element_symbol *y);

/* element_wrap.c */
tz_status tz_element_wrap(tz_element_reader *r);

/* element_class.c */
tz_status tz_element_classes(tz_element_reader *r);

/* element_svg_own.c */
/** Reads a document that tz_element_write_svg wrote. */
tz_status tz_element_read_own(tz_element_reader *r, const char *text);

#endif
