/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Procedural rules: which groups go where, how turned and how large, by region.
 * @source [Kim21] Table 1, Fig. 8, 13 to 15 */
#ifndef TZ_SYNTHESIS_RULES_H
#define TZ_SYNTHESIS_RULES_H

#include "base/array.h"
#include "base/geom.h"
#include "base/image.h"

typedef enum tz_structure {
    TZ_STRUCTURE_EXEMPLAR, /**< neighbours fit as in the exemplar */
    TZ_STRUCTURE_RANDOM,   /**< groups drawn at random, seams only */
    TZ_STRUCTURE_GRANULAR  /**< small groups, closely packed */
} tz_structure;

typedef struct tz_rule {
    char name[64];
    /* where: shape in units of the layout (0..1), or a mask; both absent = everywhere */
    TZ_ARRAY(tz_vec2)
    shape;              /**< polygon; the JSON also takes "rect" and "circle" */
    int32_t mask;       /**< index into tz_rules.mask, -1 = none; grey > 0.5 = inside */
    double feather;     /**< px: width of the random transition at its border */
    int32_t structure;  /**< tz_structure */
    double size[2];     /**< limits of group size (tz_edge_group.size), px */
    double rotation[2]; /**< rad, drawn uniformly; NAN, NAN = automatic */
    int32_t field;      /**< index into tz_rules.mask of a rotation field (grey 0..1 =
                                  0..2 pi; RG(B) = vector 2v - 1), -1 = none */
    double scale[2];    /**< factor; NAN, NAN = automatic */
    double density;     /**< factor on groups per area: > 1 = closer, smaller pieces */
    uint32_t length_bins, angle_bins; /**< bit sets of the bins used, ~0 = all; a group is
                                  used if its meta bins or one of its edges match */
    TZ_ARRAY(int32_t)
    groups;         /**< whitelist, empty = all */
    int32_t source; /**< exemplar index, -1 = all */
} tz_rule;

typedef struct tz_rules {
    TZ_ARRAY(tz_rule)
    rule; /**< the last rule that contains a point holds there */
    TZ_ARRAY(tz_image)
    mask; /**< loaded images, data encoding */
    tz_ctx *ctx;
} tz_rules;

/** A rule with no shape that changes nothing. */
TZ_API tz_rule tz_rule_default(void);
/** One rule that holds everywhere, with defaults. */
TZ_API tz_status tz_rules_default(tz_ctx *ctx, tz_rules *r);
/** Reads a JSON rule file; image paths are relative to it. Unknown keys, wrong types and
 * values out of range are errors that name the key. Angles in the file are degrees.
 * @return TZ_OK; TZ_IO; TZ_FORMAT (line); TZ_INVALID; TZ_LIMIT; TZ_NOMEM */
TZ_API tz_status tz_rules_read(tz_ctx *ctx, const char *path, tz_rules *r);
/** The same from text in memory; `name` stands in messages, and image paths are relative to
 * its folder. */
TZ_API tz_status tz_rules_parse(tz_ctx *ctx, const char *name, const char *text,
                                size_t size, tz_rules *r);
TZ_API void tz_rules_deinit(tz_rules *r); /**< takes zeroed */
/** Rule index at layout point p of a w x h layout; `u` in [0, 1) decides in feathered
 * borders. Always valid: rule 0 is everywhere. */
TZ_API int32_t tz_rules_at(const tz_rules *r, int32_t w, int32_t h, tz_vec2 p, double u);
/** Angle of a rule's rotation field at p, rad; 0 if it has none. */
TZ_API double tz_rules_field(const tz_rules *r, int32_t rule, int32_t w, int32_t h,
                             tz_vec2 p);

#endif
