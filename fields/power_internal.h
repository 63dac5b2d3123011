/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Power diagrams, inside. Not installed.
 *
 *   power.c        which cells are found anew, which from their rings
 *   power_grid.c   sites by place and weight
 *   power_cell.c   one cell as a polygon: by clipping, or from its ring
 *   power_area.c   its area, centre, emptiest corner
 *   power_solid.c  cells in a box, apart from all these
 *
 * A cell's ring are its neighbours in the order of its edges, counter-clockwise. */
#ifndef TZ_FIELDS_POWER_INTERNAL_H
#define TZ_FIELDS_POWER_INTERNAL_H

#include <string.h>

#include "base/array.h"
#include "fields/power.h"

enum {
    TZ_POWER_LEVELS = 12,
    TZ_POWER_BLOCK = 256, /* cells that one task does */
    /* How a ring lies to the border: beside it nowhere; or beside one side, between its
     * last and its first neighbour (bottom, right, top, left); or anyhow. */
    TZ_POWER_INNER = 0,
    TZ_POWER_SIDE = 1,
    TZ_POWER_ODD = 5
};

/** Sites of radii below one and above the half of it, by cells; each is a list. */
typedef struct tz_power_level {
    double cell_x, cell_y, most; /**< greatest weight that it has held */
    int32_t nx, ny, n, made_for; /**< sites in it, and when it was made */
    int32_t *head;               /**< nx * ny, -1 = empty */
} tz_power_level;

typedef struct tz_power_list {
    TZ_ARRAY(int32_t)
    v;
} tz_power_list;

/** A ring just found: its neighbours, and after which of them a side comes (of the first
 * 64). */
typedef struct tz_power_found {
    int32_t count;
    uint64_t sides;
} tz_power_found;

/** A worker's: corners of the running cell. */
typedef struct tz_power_scratch {
    TZ_ARRAY(tz_power_corner)
    a;
    TZ_ARRAY(tz_power_corner)
    b;
} tz_power_scratch;

struct tz_power {
    tz_ctx *ctx;
    tz_domain domain;
    int32_t n, cap;
    const tz_vec3 *at; /**< of the running update */
    const double *weight;
    double *area, *gap;
    tz_vec2 *centre, *gap_at;
    int32_t *start, *count;
    uint8_t *kind;           /**< of the ring */
    int32_t *mark;           /**< stamp of the update that last did something about it */
    tz_power_list neighbour; /**< what start points into */
    int64_t used;            /**< of it */
    int32_t stamp;
    /* grid */
    double unit; /**< radius of level 0 */
    tz_power_level lv[TZ_POWER_LEVELS];
    int32_t *next, *cell; /**< of a site: in its list; its cell, -1 = in none */
    uint8_t *level;
    /* work */
    tz_power_scratch *work; /**< a worker */
    int workers;
    tz_power_list *blocks; /**< rings just found, by tasks */
    int32_t block_cap;
    tz_power_list dirty, hidden;
    int32_t from; /**< where a slab of dirty cells begins */
    tz_power_found *found;
};

/** The running cell: a polygon about its site. A corner's site is that beyond the edge
 * that begins there; -1 .. -4 = bottom, right, top, left of the domain. */
typedef struct tz_power_polygon {
    const tz_power *p;
    tz_power_scratch *k;
    tz_vec2 at;
    double w;
    double far2, reach; /**< squared distance of the farthest corner; its root */
    int32_t site;
    bool gone;
} tz_power_polygon;

/* power_grid.c */
/** Brings the grid up to date with those of `which`, NULL = with all sites.
 * @return TZ_INVALID (a place is not a number); TZ_NOMEM */
tz_status tz_power_grid_update(tz_power *p, int32_t n, const int32_t *which);
void tz_power_grid_forget(tz_power *p);
static inline int32_t tz_power_clamp(double x, int32_t n)
{
    return x < 0 ? 0 : x < n ? (int32_t)x : n - 1;
}

/* power_cell.c */
tz_power_polygon tz_power_polygon_of(const tz_power *p, int32_t i, tz_power_scratch *k);
/** Exact, by all sites that can cut. */
tz_status tz_power_clip(tz_power_polygon *c);
/** By the ring alone; false if it is no ring any more. */
tz_status tz_power_from_ring(tz_power_polygon *c, bool *valid);

/* power_area.c */
/** Area, centre and gap of the polygon go to its site. */
void tz_power_measure(tz_power *p, const tz_power_polygon *c);

#endif
