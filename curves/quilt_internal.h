/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Inside of quilting. Everything is done on a fine grid of cells over the domain, each of
 * which belongs to one patch and knows which lines run through it:
 *
 *   quilt_unroll.c  a torus as a plain drawing
 *   quilt_source.c  the exemplar as dabs (points with direction and pen) and as features
 *   quilt_patch.c   candidates for a place, and their exact shift
 *   quilt_seam.c    minimum cut between what lies there and a candidate
 *   quilt_cut.c     curves of each patch inside its cells, and where they are cut
 *   quilt_things.c  things that would lie over others taken away
 *   quilt_balance.c as many things as the exemplar has, by length
 *   quilt_gaps.c    things laid into gaps
 *   quilt_order.c   cuts paired in order along each seam
 *   quilt_pair.c    and what is left by place
 *   quilt_warp.c    the field that moves paired ends onto each other
 *   quilt_emit.c    runs chained to paths
 */
#ifndef TZ_CURVES_QUILT_INTERNAL_H
#define TZ_CURVES_QUILT_INTERNAL_H

#include "base/grid.h"
#include "base/rng.h"
#include "curves/quilt.h"

enum {
    QUILT_SPOTS = 4,    /* lines a cell can hold */
    QUILT_CHANNELS = 5, /* features: coverage in four directions, and by pens */
    QUILT_NONE = -1,    /* cells of no patch, yet or for ever */
    QUILT_GIVEN = -2,   /* cells of what is drawn already */
    QUILT_OUTSIDE = -3  /* places beyond a plain domain */
};

/* In quilt_source.object: what the border has left of a thing, which is not laid. */
enum { QUILT_REST = -2 };

/* A point of a line. */
typedef struct quilt_dab {
    tz_vec2 at;
    uint8_t turn; /* direction without sign, 256 = pi */
    uint8_t pen;  /* pen + 1, at most 255 */
} quilt_dab;

/* A line through a cell: where it comes nearest to the centre, about. */
typedef struct quilt_spot {
    uint8_t x, y; /* within the cell, 256 = its side */
    uint8_t turn;
    uint8_t pen; /* pen + 1; 0 = no line */
} quilt_spot;

typedef struct quilt_cell {
    quilt_spot spot[QUILT_SPOTS];
} quilt_cell;

typedef struct quilt_source {
    tz_ctx *ctx;
    const tz_curve_set *set;
    const tz_curve_set *original; /* whose pieces origins name */
    int32_t *origin;              /* piece of `original`, per piece; NULL = the same */
    tz_curve_set unrolled;        /* what `set` is then, if the original is a torus */
    tz_vec2 lo, hi;               /* what may be copied */
    double spacing;               /* mean distance of lines */
    double cell;                  /* side of fine cells */
    double coarse;                /* side of cells of features */
    double patch;                 /* side of patches, at most */
    TZ_ARRAY(quilt_dab)
    dab;                  /* by bin */
    int32_t *bin, bx, by; /* first dab of each bin of side `coarse` */
    double *cover;        /* [y (fx + 1) + x]: coverage above and left of x, y */
    double density;       /* spots a cell */
    float *feature;       /* [(y fx + x) QUILT_CHANNELS + channel] */
    uint8_t *valid;       /* [y fx + x]: may be copied */
    int32_t fx, fy;
    double rest;     /* share of lines that are not laid */
    bool loops;      /* nearly all of it are loops by themselves */
    double largest;  /* sides of things are below */
    int32_t *object; /* per path: thing that it is part of, or -1 */
    int32_t objects;
    tz_vec2 *centre; /* of each thing */
    double broad;    /* the longest side of a thing */
    tz_vec2 *anchor; /* per node: where the field is read that moves it */
    bool *rigid;     /* per path: it moves as a whole */
    int32_t *degree; /* ends of pieces at each node */
    tz_vec2 *box;    /* [2 piece], [2 piece + 1]: its bounds */
} quilt_source;

/* Copy of the exemplar: x -> to + R(angle) (x - from). */
typedef struct quilt_patch {
    tz_vec2 from, to;
    double angle, c, s;
    tz_vec2 half; /* half sides of the window, in axes of the exemplar */
} quilt_patch;

static inline tz_vec2 quilt_turn(const quilt_patch *p, tz_vec2 v)
{
    return (tz_vec2){p->c * v.x - p->s * v.y, p->s * v.x + p->c * v.y};
}
static inline tz_vec2 quilt_unturn(const quilt_patch *p, tz_vec2 v)
{
    return (tz_vec2){p->c * v.x + p->s * v.y, p->c * v.y - p->s * v.x};
}
static inline tz_vec2 quilt_place_at(const quilt_patch *p, tz_vec2 x)
{
    return tz_vec2_add(p->to, quilt_turn(p, tz_vec2_sub(x, p->from)));
}
static inline tz_vec2 quilt_source_at(const quilt_patch *p, tz_vec2 x)
{
    return tz_vec2_add(p->from, quilt_unturn(p, tz_vec2_sub(x, p->to)));
}

/* The domain as laid so far. */
typedef struct quilt_map {
    tz_ctx *ctx;
    const tz_domain *domain;
    const tz_curve_set *given; /* NULL, or what is drawn already */
    int32_t nx, ny;
    double cx, cy;   /* sides of cells */
    int32_t *label;  /* patch of each cell, or QUILT_NONE, QUILT_GIVEN */
    uint8_t *closed; /* cells that nothing may be laid in */
    quilt_cell *cell;
    float *seam; /* [2 cell]: cost of the seam at its right, [2 cell + 1]: below */
    TZ_ARRAY(quilt_patch)
    patch;
    double balance; /* spots laid so far less those that the exemplar would have there */
} quilt_map;

/* Label at a place of the domain (on a torus, of its copy inside). */
int32_t quilt_label(const quilt_map *m, tz_vec2 p);

/* Whether a thing is known to be whole: where a torus was laid out, what the border there
 * has cut off may be what it was part of. */
static inline bool quilt_is_whole(const quilt_source *s, int32_t object)
{
    const tz_vec2 c = s->centre[object];
    return !s->original->domain.torus ||
           (c.x >= s->broad && c.y >= s->broad && c.x <= s->hi.x + s->lo.x - s->broad &&
            c.y <= s->hi.y + s->lo.y - s->broad);
}

/* What a worker needs to place a patch: a window of the map. */
typedef struct quilt_window {
    tz_ctx *ctx;
    int32_t x, y, w, h; /* cells; x and y may be outside on a torus */
    int32_t most;       /* cells there is room for */
    /* cells with a rim of two: of the candidate, of the best so far, of what lies there */
    quilt_cell *fresh, *kept, *old;
    float *off;     /* how far old and fresh lines differ */
    uint8_t *state; /* quilt_state */
    uint8_t *side;  /* result: 1 = fresh */
    uint8_t *best;  /* that of the best candidate */
    struct quilt_flow *flow;
    int32_t near[256]; /* patches whose sources count, about the place */
    int32_t nears;
    float wave[384]; /* sine of directions, 256 = pi */
    float *score;    /* of each shift */
    float *feature;  /* of what lies there already */
    float *weight;
    int32_t most_coarse;
} quilt_window;

typedef enum quilt_state {
    QUILT_BLOCKED, /* not part of the window */
    QUILT_OLD,     /* stays */
    QUILT_FRESH,   /* must be laid */
    QUILT_FREE     /* either */
} quilt_state;

/* Width at t of a piece: linear by arc length. */
double quilt_width_at(const quilt_source *s, int32_t piece, double t);
/* A torus laid out plain: all copies of pieces that reach 0 .. size. Nodes stay shared.
 * @param[out] origin  piece of `from`, per piece; caller frees */
tz_status quilt_unroll(tz_ctx *ctx, const tz_curve_set *from, tz_vec2 size,
                       tz_curve_set *to, int32_t **origin);
/* @param domain  that is to be filled */
tz_status quilt_source_init(tz_ctx *ctx, const tz_curve_set *set, const tz_domain *domain,
                            const tz_curve_quilt_params *p, quilt_source *s);
void quilt_source_deinit(quilt_source *s);
/* Puts a line into a cell unless one like it is there or the cell is full. */
void quilt_spot_add(quilt_cell *c, quilt_spot spot);
/* Adds the features of a dab at x, y (cells of features) of weight k. */
void quilt_feature_add(float *feature, int32_t w, int32_t h, tz_vec2 at, uint8_t turn,
                       uint8_t pen, float k);
void quilt_feature_blur(float *feature, float *scratch, int32_t w, int32_t h);

tz_status quilt_window_init(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                            tz_vec2 side, quilt_window *w);
void quilt_window_deinit(quilt_window *w);

typedef struct quilt_place {
    tz_vec2 at;    /* centre */
    tz_vec2 half;  /* half sides of the window */
    double core;   /* > 0: a repair, which must replace all within this radius */
    int32_t patch; /* number it takes */
    int32_t seen;  /* patches whose sources it may look at */
    uint64_t stream;
    double surplus; /* result: what it adds to the balance */
} quilt_place;

/* Lays the best candidate; a repair only if it is better than what lies there.
 * @param[out] laid  whether it did */
tz_status quilt_place_patch(const quilt_source *s, quilt_map *m, quilt_place *p,
                            const tz_curve_quilt_params *q, uint64_t seed,
                            quilt_window *w, bool *laid);

/* Minimum cut between QUILT_OLD and QUILT_FRESH cells.
 * @param[out] cost  of the seam */
struct quilt_flow *quilt_flow_new(tz_ctx *ctx, int32_t most);
void quilt_flow_free(tz_ctx *ctx, struct quilt_flow *f);
void quilt_flow_cut(struct quilt_flow *f, int32_t w, int32_t h, const float *off,
                    const uint8_t *state, uint8_t *side, double *cost);
#define QUILT_SEAM_LEAST 0.02F /* cost of a step of the seam through empty cells */

/* ---- after all is laid ------------------------------------------------------------- */

/* Part of a piece of the exemplar. */
typedef struct quilt_part {
    int32_t piece;
    double t0, t1;
} quilt_part;

/* Parts one behind another, of one patch and path. */
typedef struct quilt_run {
    int32_t patch, path;
    int32_t part, parts;
    int32_t cut[2]; /* at its begin and end: quilt_cut, or -1 = the path itself ends */
    bool closed;    /* a whole closed path */
    bool gone;
} quilt_run;

typedef struct quilt_cut {
    tz_vec2 at;           /* in the domain, not wrapped */
    tz_vec2 out;          /* unit, away from the run */
    int32_t run;          /* -1 = of what is given */
    int32_t side;         /* 0: the run begins here */
    int32_t patch, other; /* whose, and label beyond: may be QUILT_NONE, .. */
    int32_t pen;
    int32_t mate; /* paired cut, or -1 */
    tz_vec2 to;   /* where it comes to lie */
    double turn;  /* by how much the line is turned there */
    double width; /* of the line */
    double widen; /* logarithm of what it is to be multiplied with */
    bool fixed;
    bool bridge; /* joined by a line between, not by being moved */
} quilt_cut;

/* The line that joins two cuts over a gap: smooth at both. */
tz_bezier quilt_bridge(const tz_domain *d, const quilt_cut *a, const quilt_cut *b);

typedef struct quilt_runs {
    tz_ctx *ctx;
    TZ_ARRAY(quilt_part)
    part;
    TZ_ARRAY(quilt_run)
    run; /* by patch */
    TZ_ARRAY(quilt_cut)
    cut;
} quilt_runs;

tz_status quilt_cut_runs(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                         quilt_runs *r);
void quilt_runs_deinit(quilt_runs *r);
/* Takes away things that would lie over what other patches have laid, and balances. */
tz_status quilt_drop_things(tz_ctx *ctx, const quilt_source *s, quilt_map *m,
                            quilt_runs *r);
/* One copy of a thing of the exemplar. */
typedef struct quilt_thing {
    int32_t patch, object, run, runs; /* of a list of runs */
    double own;                       /* share of it in cells of its patch */
} quilt_thing;
/* Where most lines are of things: takes things away or lays more of them until the length
 * of lines by area is the exemplar's. */
tz_status quilt_balance(tz_ctx *ctx, const quilt_source *s, quilt_map *m, quilt_runs *r,
                        const quilt_thing *thing, int32_t things, const int32_t *order);
/* Lays things into gaps until `length` is laid, or none fits. Each takes a patch of its
 * own, without cells. */
tz_status quilt_fill_gaps(tz_ctx *ctx, const quilt_source *s, quilt_map *m, quilt_runs *r,
                          double length);
/* All of a thing, where patch has it. */
tz_status quilt_cut_thing(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                          quilt_runs *r, int32_t patch, int32_t object);
/* Pairs cuts along each seam, or joins neighbours by bridges, by least cost.
 * @param loose  cost of an end that stays */
tz_status quilt_order(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                      quilt_runs *r, double loose);
tz_status quilt_pair(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                     quilt_runs *r, tz_curve_quilt_report *report);
/* The field that moves the ends of pairs onto each other, and all of their patch about
 * them, less the farther away. */
typedef struct quilt_warp {
    tz_ctx *ctx;
    const quilt_runs *r;
    tz_grid grid;  /* of all cuts */
    double radius; /* beyond which nothing moves */
} quilt_warp;
tz_status quilt_warp_init(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                          quilt_runs *r, quilt_warp *w);
void quilt_warp_deinit(quilt_warp *w);
/* What widths are multiplied with at x. */
double quilt_warp_width(const quilt_warp *w, int32_t patch, tz_vec2 x);
tz_vec2 quilt_warp_at(const quilt_warp *w, int32_t patch, tz_vec2 x);
/* Whether anything moves within `reach` of x. */
bool quilt_warp_near(const quilt_warp *w, int32_t patch, tz_vec2 x, double reach);

tz_status quilt_emit(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                     quilt_runs *r, uint64_t seed, tz_curve_set *out);

#endif
