/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * One leaf: its outline in its own coordinates. Private to scenes/. */
#ifndef TZ_SCENES_LEAF_H
#define TZ_SCENES_LEAF_H

#include "scenes/shapes.h"

typedef enum tz_leaf_kind {
    TZ_LEAF_OVAL,  /* beech, willow: one bow a side, with teeth or without */
    TZ_LEAF_LOBED, /* oak: bows along the midrib */
    TZ_LEAF_STAR,  /* maple: lobes round the stalk */
    TZ_LEAF_BLADE, /* grass, needle, twig: as wide from end to end */
    TZ_LEAF_KINDS
} tz_leaf_kind;

enum { TZ_LEAF_TABLE = 128 };

/** What the leaves of one kind of tree share. Lengths are shares of the leaf's length. */
typedef struct tz_leaf_species {
    tz_leaf_kind kind;
    double length, width; /* length in px */
    double bow, tip;      /* where it is widest, how pointed */
    int lobes, teeth;
    double lobe_depth, tooth_depth, rough;
    double bend, squash; /* of the midrib, and how aslant leaves are seen at most */
    double stalk;
    int veins; /* side veins; 0 = none */
} tz_leaf_species;

/** Half widths left and right along the midrib, or radii around the stalk's end. */
typedef struct tz_leaf {
    tz_leaf_kind kind;
    tz_vec2 at;    /* base */
    double co, si; /* direction of the midrib */
    double length, bend, squash, stalk, stalk_half;
    double reach;  /* px round the base beyond which there is nothing */
    double widest; /* px from the chord of the midrib beyond which there is nothing */
    float side[2][TZ_LEAF_TABLE];
} tz_leaf;

/** Where a pixel lies on a leaf. */
typedef struct tz_leaf_spot {
    double u, v, edge; /* along and across the midrib, and inwards from the border, px */
    bool stalk;
} tz_leaf_spot;

void tz_leaf_species_draw(tz_rng *r, double length, tz_leaf_species *s);
void tz_leaf_draw(tz_rng *r, const tz_leaf_species *s, tz_vec2 middle, double angle,
                  tz_leaf *leaf);
/** Columns that row y of the leaf's box may fill, within *x0 .. *x1; x1 <= x0 if none. */
void tz_leaf_span(const tz_leaf *leaf, double y, double *x0, double *x1);
/** False outside. */
bool tz_leaf_at(const tz_leaf *leaf, double x, double y, tz_leaf_spot *spot);

#endif
