/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Parts of region growing that share one state: the prepared exemplar (units), the field
 * of what has been placed (spots), matching, seeds, optimisation. */
#ifndef TZ_ELEMENTS_GROWTH_INTERNAL_H
#define TZ_ELEMENTS_GROWTH_INTERNAL_H

#include "base/rng.h"
#include "elements/extent.h"
#include "elements/growth.h"

enum {
    TZ_GROWTH_NEAR = 60,     /* neighbours of a unit at most: bits of a word */
    TZ_GROWTH_LUT = 32,      /* cells a side of a unit's map of neighbours */
    TZ_GROWTH_COHERENT = 8,  /* similar units kept at most */
    TZ_GROWTH_SEEN = 160,    /* neighbours of a spot at most */
    TZ_GROWTH_FREE = 16,     /* free-space points of a unit at most */
    TZ_GROWTH_CLASSES = 192, /* of collision, and of balance */
    TZ_GROWTH_TEXTURES = 64,
    TZ_GROWTH_BATCH = 48,   /* seeds between two optimisations */
    TZ_GROWTH_NODES = 2048, /* spots in one local optimisation at most */
    TZ_GROWTH_EDGES = 65536,
    TZ_GROWTH_UNITS = 65536, /* elements of an exemplar at most */
    TZ_GROWTH_OTHERS = 16    /* units that may be placed for one, at most */
};

/** A shape as collisions see it: its extents, and what class it is of. */
typedef struct tz_growth_body {
    float r, angle;
    int32_t hard, symbol; /* class of collision; -1 = a disc */
} tz_growth_body;

/** Neighbour of a unit: offset from it, and what the two need to be compared. */
typedef struct tz_growth_near {
    float x, y, d;   /* offset; distance less what it is larger by */
    float r, c2, s2; /* radius; doubled angle, 0, 0 = not oriented */
    int32_t kind, symbol, unit;
} tz_growth_near;

/** Element of the exemplar, or a void found in it. */
typedef struct tz_growth_unit {
    double x, y;
    float r, c2, s2, angle;
    float spacing;             /* mean distance to its first ring */
    float reach, wide;         /* radius of its neighbourhood, of its first ring */
    float view;                /* its reach, less the radius of any other */
    float sight;               /* the same, or how far its ring's collisions reach */
    float weight;              /* how many of its like the exemplar's area holds */
    float clear;               /* how far its own do, less the other's radius */
    float half;                /* of the square that its map covers */
    int32_t kind, hard, class; /* kind; class of collision; class of balance */
    int32_t symbol, source;    /* of the element in the palette, -1 = void */
    int32_t near, nears;       /* its neighbours, nearest first */
    int32_t ring;              /* how many of them are in its first ring */
    int32_t due, ring_due;     /* neighbours, and first ones, to be had by a copy */
    int32_t frees;
    tz_vec2 free[TZ_GROWTH_FREE]; /* free-space points of its first ring */
    int32_t coherents, coherent[TZ_GROWTH_COHERENT];
    bool larger; /* there are larger things in its neighbourhood */
    int32_t others, other[TZ_GROWTH_OTHERS]; /* alike units, that it may be shown as */
    float unlike[TZ_GROWTH_OTHERS];          /* how much they differ: share of radius */
    int32_t uses;                            /* copies of it in the output */
    float recent;                            /* distance of the nearest, while chosen */
    int32_t stand_in; /* unit that is placed for it: itself unless cut; -1 = none */
    bool copied;      /* not cut: may be placed */
    bool bent;        /* of several samples: its shape is compared */
    bool whole;       /* its neighbourhood lies within the exemplar */
    bool known;       /* so does its first ring */
} tz_growth_unit;

typedef struct tz_growth_exemplar {
    const tz_element_set *set;
    const tz_extents *extents; /* of the set's symbols */
    const bool *disc;          /* which of them are mere discs */
    tz_growth_texture texture;
    int32_t number;      /* of the texture */
    bool symbols;        /* symbols are told apart: each is used more than once */
    bool own;            /* each element has one of its own, and is known by it */
    int32_t n, elements; /* units; the first `elements` are the set's own */
    tz_growth_unit *unit;
    TZ_ARRAY(tz_growth_near)
    near;
    uint8_t *lut; /* n maps: index of the nearest neighbour of a unit, 255 = none */
    bool torus;
    tz_vec2 lo, hi; /* box of all centres: what lies beyond is not known */
    double spacing, reach, wide, radius; /* median; the others: largest */
    float ring_mean;                     /* of units' first rings */
    double hole; /* radius of the widest disc between its elements */
    int32_t hards, classes;
    float *limit;     /* hards * hards: share of the radii's sum that keeps two apart */
    float *touch;     /* the same of the distance at which they touch: extent.h */
    float *bound;     /* larger one of both */
    float *frequency; /* of a class, sum 1 */
    double overlap;
    double density; /* elements an area, edges corrected: element_density.h */
    float units;    /* units (voids too) for each element that is copied */
    tz_vec2 origin; /* of its frame in the palette */
    tz_vec2 size;   /* of the exemplar's period, or its domain */
} tz_growth_exemplar;

/** Element of the output, or a void. Where frames thin the output out, its radius is that
 * of the room that it has: larger than the element's by as much as distances are. */
typedef struct tz_growth_spot {
    double x, y;
    float r, c2, s2, angle;
    int32_t kind, symbol, hard, texture;
    int32_t copy;  /* unit that it copies, or is most like */
    int32_t match; /* unit whose neighbourhood it has; -1 = an obstacle of unknown kind */
    int32_t next, cell;    /* in the grid */
    int32_t out;           /* element of the output, -1 = void */
    int32_t node;          /* in the running optimisation, -1 = none */
    int16_t visits, first; /* visits as a seed; neighbours in its first ring */
    int16_t run; /* steps since the growth last left one place of the exemplar */
    bool queued, waiting, fixed;
    bool strange, gone; /* given, no copy; to be removed */
} tz_growth_spot;

/** Spot as seen from a place. */
typedef struct tz_growth_seen {
    float x, y;
    float r, c2, s2, angle;
    int32_t kind, symbol, hard, texture, spot, copy;
} tz_growth_seen;

/** All in the local frame of the place, which is turned and scaled: one unit of it is one
 * of the exemplar. */
typedef struct tz_growth_view {
    float c, s;   /* of the frame's angle */
    double scale; /* of its unit in the world */
    int32_t n;
    tz_growth_seen v[TZ_GROWTH_SEEN];
} tz_growth_view;

typedef struct tz_growth_edge {
    int32_t from, to; /* nodes: position of `to` - position of `from` should be x, y */
    float x, y, weight;
} tz_growth_edge;

typedef struct tz_growth_node {
    int32_t spot;
    float x, y;        /* shift, in the making */
    float sx, sy, sum; /* of predictions */
    float self;        /* weight of where it is */
} tz_growth_node;

/** What has been decided: copied from the exemplar, be it elements or empty room. */
typedef struct tz_growth_cover {
    int32_t nx, ny, words; /* cells; words a row */
    double step_x, step_y;
    bool led;                /* by a brush, which says what texture grows where */
    size_t cells;            /* words in all */
    uint64_t *inside;        /* cells of the domain */
    uint64_t *open, *done;   /* cells that may be grown in; that are decided */
    uint64_t *zone;          /* by texture: cells that it may grow in; NULL = all */
    float *share;            /* by texture and zone: of its elements that are let in */
    int64_t opened, covered; /* cells open; and of them decided */
    double due[TZ_GROWTH_TEXTURES], count[TZ_GROWTH_TEXTURES]; /* elements: due, placed */
} tz_growth_cover;

struct tz_growth {
    tz_ctx *ctx;
    tz_growth_params params;
    tz_growth_exemplar *ex;
    int32_t textures;
    double spacing, radius, reach, wide; /* least of all textures; largest */
    double least, most; /* scale of frames: a unit of an exemplar in the world */
    tz_element_set *out;
    tz_extents extents; /* of the palette's symbols */
    bool *disc;
    tz_growth_cover cover;
    TZ_ARRAY(tz_growth_spot)
    spot;
    int32_t *head; /* of the grid's cells */
    int32_t nx, ny;
    double cell, cell_x, cell_y;
    int32_t *queue, queue_cap, queue_head, queue_n; /* ring of seeds */
    int32_t *count;                                 /* by texture and class of balance */
    int32_t counted[TZ_GROWTH_TEXTURES];
    int32_t placed; /* elements, voids not counted */
    int32_t round[4 * TZ_GROWTH_BATCH * TZ_GROWTH_FREE], rounds; /* spots of this round */
    int32_t phase;   /* of the growth: see growth.c */
    int64_t started; /* how far the passes over places and spots are */
    int32_t closed, filled, mended;
    tz_vec2 box_lo, box_hi; /* where holes are looked for */
    int32_t solved;         /* spots when everything was solved last */
    tz_growth_node *node;
    tz_growth_edge *edge;
    int32_t nodes, edges;
};

/* ---- growth_units.c -------------------------------------------------------------- */

/** Elements of a palette that a texture selects. */
int32_t tz_growth_count_units(const tz_element_set *set, const tz_growth_texture *t);
/** ex->unit and what is known of them all; room for all selected. */
void tz_growth_set_units(tz_growth_exemplar *ex);

/* ---- growth_exemplar.c ----------------------------------------------------------- */

tz_status tz_growth_exemplar_init(tz_ctx *ctx, const tz_element_set *set,
                                  const tz_growth_texture *texture,
                                  const tz_growth_params *p, tz_growth_exemplar *ex);
void tz_growth_exemplar_deinit(tz_ctx *ctx, tz_growth_exemplar *ex);
/** Similar units of all units, by their neighbourhoods. */
tz_status tz_growth_find_coherent(tz_ctx *ctx, tz_growth_exemplar *ex,
                                  const tz_growth_params *p);
/** Free-space points of all units. */
void tz_growth_find_free(tz_growth_exemplar *ex);
/** Classes of collision and of balance; what keeps each pair of classes apart. */
tz_status tz_growth_find_classes(tz_ctx *ctx, tz_growth_exemplar *ex);

/* ---- growth.c ------------------------------------------------------------------- */

/** tz_growth_begin_palette. @param closed  nothing is grown until places are opened */
tz_status tz_growth_open(tz_ctx *ctx, const tz_element_set *palette,
                         const tz_growth_texture *texture, int32_t n,
                         const tz_growth_params *params, tz_element_set *output,
                         bool closed, tz_growth **growth);
/** Goes on after places within `radius` were opened. */
void tz_growth_resume(tz_growth *g, tz_vec2 at, double radius);
/** Nothing more is to be done. */
void tz_growth_rest(tz_growth *g);
/** Starts a texture at a place unless it has elements within `gap`. */
tz_status tz_growth_seed(tz_growth *g, int32_t texture, double x, double y, double gap);
/** Radius of the disc about a place that touches no element; up to `most`. Both in units of
 * the local frame. */
double tz_growth_gap(const tz_growth *g, double x, double y, double most);
/** The texture that grows at a place; of several by lot, -1 = none. */
int32_t tz_growth_texture_at(const tz_growth *g, double x, double y);

/* ---- growth_remove.c ------------------------------------------------------------- */

/** Takes spots that are `gone` out, and their elements.
 * @return TZ_OK; TZ_NOMEM (nothing is removed) */
tz_status tz_growth_remove(tz_growth *g);

/* ---- growth_cover.c -------------------------------------------------------------- */

/** @param closed  nothing may be grown yet */
tz_status tz_growth_cover_init(tz_growth *g, bool closed);
void tz_growth_cover_deinit(tz_growth *g);
/** Share of the first ring of a spot's unit about it that is open and not decided. */
float tz_growth_undecided(tz_growth *g, const tz_growth_spot *q);
/** Decides the first ring about a spot: it is the unit's, elements and empty room. */
void tz_growth_decide(tz_growth *g, const tz_growth_spot *q, int32_t unit);
void tz_growth_decide_place(tz_growth *g, int32_t texture, double x, double y, double r);
void tz_growth_forget_place(tz_growth *g, int32_t texture, double x, double y, double r);
/** Lets growth into a disc of the domain, or shuts it out. */
void tz_growth_open_place(tz_growth *g, int32_t texture, double x, double y, double r,
                          bool open);
bool tz_growth_is_decided(const tz_growth *g, double x, double y);
/** Whether a texture may grow at a place. */
bool tz_growth_is_of(const tz_growth *g, int32_t texture, double x, double y);
/** Whether the zones of textures let something move to a place of the domain. */
bool tz_growth_may_go(const tz_growth *g, int32_t texture, double x, double y);
/** Whether domain, zones and what is open admit a unit. */
bool tz_growth_may_stand(const tz_growth *g, int32_t texture, const tz_growth_unit *u,
                         double x, double y);
/** By which share of what is due a texture is too dense. */
float tz_growth_error(const tz_growth *g, int32_t texture);
/** The first place from `*from` on, row by row, that is open and not decided. */
bool tz_growth_next_open(const tz_growth *g, int64_t *from, double *x, double *y);

/* ---- growth_match.c -------------------------------------------------------------- */

/** What can be seen from x, y within `radius`, in units of the local frame; `but` is left
 * out at its own place. */
void tz_growth_look(const tz_growth *g, double x, double y, double radius, int32_t but,
                    tz_growth_view *view);
/** Cost of seeing what of one's own texture is there where the neighbourhood of unit `u`
 * should be.
 * @param enough     costs above this may be given as INFINITY
 * @param[out] used  which neighbours of the unit are paired
 * @param[out] pair  NULL, or per seen one its neighbour of the unit, -1 = none */
float tz_growth_match(const tz_growth_exemplar *ex, int32_t u, const tz_growth_seen *v,
                      int32_t n, float enough, uint64_t *used, int8_t *pair);
/** How far away a unit sees something: large things count from nearer. */
static inline float tz_growth_far(const tz_growth_unit *u, float x, float y, float r)
{
    return sqrtf(x * x + y * y) - (r > u->r ? r - u->r : 0);
}
/** Whether a neighbour is so large that it needs its place before others take it. */
static inline bool tz_growth_is_larger(const tz_growth_near *o, const tz_growth_unit *u)
{
    return o->r > 1.5F * u->r;
}
/** Neighbour of unit u at an offset, or -1. */
int32_t tz_growth_at(const tz_growth_exemplar *ex, int32_t u, float x, float y);
/** Distance within which a body may be too near to what is seen, and what it must be when
 * it lies in direction (-x, -y) from that. */
float tz_growth_bound(const tz_growth_exemplar *ex, const tz_growth_body *b,
                      const tz_growth_seen *o);
float tz_growth_apart(const tz_growth_exemplar *ex, const tz_growth_body *b, float x,
                      float y, const tz_growth_seen *o);
/** How far a body reaches in a direction. */
float tz_growth_extent(const tz_growth_exemplar *ex, const tz_growth_body *b,
                       float direction);
static inline tz_growth_body tz_growth_body_of(const tz_growth_unit *u)
{
    return (tz_growth_body){u->r, u->angle, u->hard, u->symbol};
}
/** The same of all that is seen, and a little more for units at the exemplar's border. */
float tz_growth_cost(const tz_growth_exemplar *ex, int32_t u, const tz_growth_view *view,
                     float enough, uint64_t *used);
/** Best of a unit and its coherent ones. */
int32_t tz_growth_nearest(const tz_growth_exemplar *ex, int32_t u,
                          const tz_growth_view *view);
/** Vector of a view in the world, and back. */
static inline tz_vec2 tz_growth_out(const tz_growth_view *w, float x, float y)
{
    return (tz_vec2){w->scale * (double)(w->c * x - w->s * y),
                     w->scale * (double)(w->s * x + w->c * y)};
}
static inline tz_vec2 tz_growth_in(const tz_growth_view *w, double x, double y)
{
    return (tz_vec2){((double)w->c * x + (double)w->s * y) / w->scale,
                     ((double)w->c * y - (double)w->s * x) / w->scale};
}

/* ---- growth_candidate.c ---------------------------------------------------------- */

typedef enum tz_growth_visiting {
    TZ_GROWTH_STRICT,
    TZ_GROWTH_LOOSE, /* takes what fits, however badly */
    TZ_GROWTH_MEND   /* the same, also where all is decided */
} tz_growth_visiting;
/** Grows around one seed. @param[out] grown  how many were placed */
tz_status tz_growth_visit(tz_growth *g, int32_t seed, tz_growth_visiting how,
                          int32_t *grown);
/** Places a copy of unit `shown` that has the neighbourhood of `unit`.
 * @param view  what is seen from there, at least first rings */
tz_status tz_growth_place(tz_growth *g, int32_t texture, int32_t unit, int32_t shown,
                          double x, double y, const tz_growth_view *view);
/** Whether a unit may stand at dx, dy from the place that a view is of. */
bool tz_growth_fits(const tz_growth_exemplar *ex, const tz_growth_unit *u, float dx,
                    float dy, const tz_growth_view *view);
/** The same of elements only, at the place itself: voids do not count. */
bool tz_growth_fits_elements(const tz_growth_exemplar *ex, const tz_growth_unit *u,
                             const tz_growth_view *view);
/** What a class has over what is due to it. */
float tz_growth_surplus(const tz_growth *g, int32_t texture, int32_t class);
/** Room for `more` spots. */
tz_status tz_growth_reserve(tz_growth *g, int64_t more);
void tz_growth_enqueue(tz_growth *g, int32_t spot);
/** Puts a spot into the grid. */
void tz_growth_link(tz_growth *g, int32_t spot);
void tz_growth_unlink(tz_growth *g, int32_t spot);

/* ---- growth_hole.c --------------------------------------------------------------- */

/** ex->hole. */
tz_status tz_growth_find_hole(tz_ctx *ctx, tz_growth_exemplar *ex);
/** Fills or narrows holes until something has been placed or there are none. */
tz_status tz_growth_close_holes(tz_growth *g, bool *started);

/* ---- growth_use.c ---------------------------------------------------------------- */

/** Alike units of all units. */
tz_status tz_growth_find_others(tz_ctx *ctx, tz_growth_exemplar *ex);
/** The unit that is shown where `unit` is due: itself or one alike, used the least and
 * farthest from here, that has room. */
int32_t tz_growth_show(tz_growth *g, int32_t texture, int32_t unit, double x, double y,
                       const tz_growth_view *view);
/** Whether what tz_growth_show has named would stand beside a copy of itself. */
bool tz_growth_is_twin(const tz_growth *g, int32_t texture, int32_t shown);

/* ---- growth_optimise.c ----------------------------------------------------------- */

/** Moves a spot as far as its neighbours let it. */
void tz_growth_move(tz_growth *g, int32_t spot, double dx, double dy);
/** Relaxes the spots of the round. */
void tz_growth_relax(tz_growth *g);
/** Solves for all positions. */
tz_status tz_growth_solve(tz_growth *g);

#endif
