/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Element fields: a domain filled with things that lie evenly, turn and grow smoothly
 * along a few strokes, and bend if they are soft. No exemplar arrangement is needed, only
 * the things.
 *
 *   tz_element_field_read(ctx, "strokes.svg", size, torus, &field);
 *   tz_element_set_like(ctx, &palette, &domain, &layout);
 *   tz_params_default(&tz_fill_param_table, &params);
 *   tz_fill_run(ctx, &(tz_fill_job){.palette = &palette, .domain = domain,
 *               .field = &field, .params = &params, .seed = 1}, &layout, NULL);
 *
 * Interactive use: tz_fill_begin, then tz_fill_iterate, tz_fill_repair, the brushes and
 * tz_fill_write in any order.
 * @source [Hsu20]; fields/fill_internal.h has the formulation */
#ifndef TZ_FIELDS_FILL_H
#define TZ_FIELDS_FILL_H

#include "base/param.h"
#include "elements/element.h"
#include "elements/field.h"

typedef struct tz_fill tz_fill;

/** One thing of the palette. It lies along directions as it is drawn: its +x points along
 * the stroke. */
typedef struct tz_fill_entry {
    int32_t element; /**< of the palette */
    double share;    /**< of the count, against the others; >= 0 */
    double rigidity; /**< 0 = bends .. 100 = never bends (tied exactly from 100 on) */
    double
        size[2];   /**< least and greatest, against the palette's size; each element draws
                          its own between them; the field's size is multiplied with it */
    double turn;   /**< radians against the field */
    double jitter; /**< each element draws a turn of its own from -jitter .. jitter */
} tz_fill_entry;

typedef enum tz_fill_start { TZ_FILL_RANDOM, TZ_FILL_INSERT } tz_fill_start;

typedef struct tz_fill_params {
    double alpha;       /**< continuity of directions, [Hsu20] Eq. (11) */
    double beta;        /**< continuity of sizes and densities, Eq. (12) */
    int32_t iterations; /**< 5 .. 100 as published */
    double fill;        /**< area of all things over that of the domain, which the count
                             follows from */
    double rigidity;    /**< of things that the mix says nothing about */
    int32_t start;      /**< tz_fill_start */
    int32_t discs;      /**< that a thing is made of, at most */
    bool repair;        /**< true outlines are kept apart and gaps filled at the end */
} tz_fill_params;
TZ_API extern const tz_param_table tz_fill_param_table;

/** Energies as in [Hsu20] Eq. (1) to (12), lengths in mean disc radii. */
typedef struct tz_fill_energy {
    double distribution, conflict, border, graph;   /**< Eq. (1), (2), (3) */
    double align, continuity, rigidity, rotation;   /**< Eq. (7) to (10) */
    double size_align, size_continuity, size_rigid; /**< Eq. (12) */
    double before[4], after[4]; /**< totals that the scale, orientation, distribution and
                                     graph step lowered */
} tz_fill_energy;

typedef struct tz_fill_job {
    const tz_element_set *palette; /**< its elements that may be copied */
    const tz_fill_entry *entry;    /**< NULL = all of them, in equal shares */
    int32_t entries;
    tz_domain domain;
    const tz_element_field *field; /**< settled; NULL = says nothing */
    const tz_fill_params *params;  /**< NULL = defaults */
    uint64_t seed;
    int32_t
        count; /**< of elements; 0 = by area and density; < 0 = none but what the layout
                        holds and brushes add */
    /** After each iteration; false stops. `fill` may be written out. NULL = none */
    bool (*trace)(void *user, const tz_fill *fill, int32_t iteration,
                  const tz_fill_energy *e);
    void *user;
} tz_fill_job;

/** Begins. What the layout holds is kept: fixed elements stay, others take part. Those
 * that copy no entry of the palette are obstacles: discs of their own that stay.
 * @param layout  of the same palette (tz_element_set_like) and domain; written by
 *                tz_fill_write only
 * @return TZ_OK; TZ_INVALID (no palette, nothing in the domain, numbers out of range,
 *   every thing larger than the domain: one line each); TZ_LIMIT (over 2 million
 *   elements); TZ_NOMEM */
TZ_API tz_status tz_fill_begin(tz_ctx *ctx, const tz_fill_job *job,
                               tz_element_set *layout, tz_fill **out);
/** Iterations of scale, orientation, distribution and graph step; of what is awake only,
 * if a brush was used.
 * @param[out] last  NULL, or the energies after the last one (costs half an iteration)
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED; the fill stays whole
 * @cost O(samples) each */
TZ_API tz_status tz_fill_iterate(tz_fill *f, int32_t iterations, tz_fill_energy *last);
/** Keeps true outlines apart, with gaps as even as they can be; what is jammed moves to the
 * largest empty places, what still overlaps shrinks by up to a fifth, or goes. If the count
 * is free and less lies there than asked for, empty places get things of the palette.
 * @return as tz_fill_iterate */
TZ_API tz_status tz_fill_repair(tz_fill *f);
/** Writes all elements over those of the layout, in the order of their ids. Soft ones are
 * bent through their samples (elements/bend.h).
 * @return TZ_OK; TZ_NOMEM (the layout is untouched) */
TZ_API tz_status tz_fill_write(const tz_fill *f, tz_element_set *layout);
TZ_API void tz_fill_end(tz_fill *f); /**< takes NULL */

/* ---- brushes: [Hsu20] Sec. Brush operations --------------------------------------- */

/** Under a stroke of that radius: elements whose centres lie there go. */
TZ_API tz_status tz_fill_erase(tz_fill *f, int32_t n, const tz_vec2 *stroke,
                               double radius);
/** New things are placed there, along the stroke, between what is there.
 * @param entry  of the job, -1 = the mix; count by area, as all
 * @param size   factor, > 0 */
TZ_API tz_status tz_fill_add(tz_fill *f, int32_t n, const tz_vec2 *stroke, double radius,
                             int32_t entry, double size);
/** Erase, then add. */
TZ_API tz_status tz_fill_replace(tz_fill *f, int32_t n, const tz_vec2 *stroke,
                                 double radius, int32_t entry, double size);
/** Everything within reach of a place takes part in the next iterations, the rest is held.
 * Brushes wake what they touch by themselves. */
TZ_API tz_status tz_fill_wake(tz_fill *f, tz_vec2 at, double radius);
/** All is held, until something is woken. */
TZ_API void tz_fill_hold(tz_fill *f);
/** All is awake again: the next iterations settle the whole domain (autocomplete). */
TZ_API void tz_fill_wake_all(tz_fill *f);
/** Settles what is awake: iterations, repair, then all is held. */
TZ_API tz_status tz_fill_settle(tz_fill *f, int32_t iterations);

/* ---- all at once ------------------------------------------------------------------ */

typedef struct tz_fill_report {
    int32_t elements, samples, entries, iterations;
    int32_t moved, shrunk, dropped, inserted; /**< by repair and teleportation; shrunk
                                                   by over 2 % */
    double covered; /**< share of the domain's area, by outlines */
    double overlap; /**< area that two things share, over the things' area */
    double outside; /**< area of theirs out of the region, over the things' area */
    double align, align_most; /**< angle to strokes under them, radians: mean, greatest */
    double turn, turn_rms, turn_95; /**< angle between neighbours, radians: mean, root of
                                         mean square, 95th percentile */
    double spacing;                 /**< mean distance of these neighbours, user units */
    double hole;                    /**< radius of the largest empty disc, user units */
    double seconds;
} tz_fill_report;

/** Begin, iterate, repair, write. @param report  NULL = not wanted */
TZ_API tz_status tz_fill_run(tz_ctx *ctx, const tz_fill_job *job, tz_element_set *layout,
                             tz_fill_report *report);
/** Measures any layout: the report's lower half, by outlines on a raster. Directions are
 * those of the palette's things as drawn; round things have none.
 * @param palette  that sources of elements name; NULL = directions are those of symbols
 * @param side  cells along the longer side, 0 = 1024 */
TZ_API tz_status tz_fill_measure(tz_ctx *ctx, const tz_element_set *layout,
                                 const tz_element_set *palette,
                                 const tz_element_field *field, int32_t side,
                                 tz_fill_report *r);

#endif
