/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * True outlines of bodies, and the contacts between them. Not installed.
 *
 *   fill_outline.c   where outlines lie, how deep one lies in another
 *   fill_contact.c   pairs that are near, gaps between them, rounds that even these out
 *   fill_gap.c       things that come into empty places, or move there out of jams
 *   fill_repair.c    what is done when
 *
 * A body keeps half of a gap about itself (tz_fill_pose.gap, times tz_fill_outlines.part);
 * what two bodies lack to both halves, or one to the border of the domain to its own, is a
 * lack. Rounds lower the sum of squares of all lacks (and, if wanted, of the ways to the
 * centres of all bodies' cells, which close holes that things stand about like arches). With gaps as wide as the free area
 * allows nearly all neighbours lack something, and gaps become even; with narrow ones only
 * what is too near moves. */
#ifndef TZ_FIELDS_FILL_OUTLINE_INTERNAL_H
#define TZ_FIELDS_FILL_OUTLINE_INTERNAL_H

#include "fields/fill_internal.h"

/** A body as a contact sees it. */
typedef struct tz_fill_pose {
    tz_vec2 at, turn;    /**< of its reference point; turn times scale */
    double scale, reach; /**< reach: farthest that its outline lies from `at` */
    double gap;          /**< half of the gap that it is to have about it */
    bool soft;
    int32_t border; /**< of a soft body: where its outline's points are kept */
} tz_fill_pose_of;

/** Nearest points of two bodies: of a's outline to b, and of b's to a. */
typedef struct tz_fill_contact {
    int32_t a, b;
    int8_t age;       /**< rounds since all of the outlines were looked at */
    bool both, near;  /**< b moves too; they are near enough to be looked at */
    int8_t best[2];   /**< point of the outline; -1 = none within the gap */
    double lack[2];   /**< > 0: of the gap */
    tz_vec2 way[2];   /**< in which a is to go, b the other way */
    tz_vec2 at[2];    /**< where */
    double arm[2][2]; /**< how a turn of a, of b moves it that way, over their reaches */
} tz_fill_contact;

/** A lack that another body shares, as its body's row has it. */
typedef struct tz_fill_share {
    int32_t with;
    double x, y, own, other; /**< way; arms of this body and of the other */
} tz_fill_share;

/** What one body lacks, of all its contacts and the border. */
typedef struct tz_fill_lack {
    double depth;   /**< largest overlap, true outlines; < 0 = least gap */
    double energy;  /**< sum of squares of its lacks: how hard it is pressed */
    double border;  /**< > 0: lack to the border */
    tz_vec2 way;    /**< into the domain */
    tz_vec2 pull;   /**< to the centre of its cells, as the diagram was found */
    double turned;  /**< radians so far */
    int32_t shares; /**< lacks that move others, too */
    double arm;     /**< of the border's lack */
    double row[6]; /**< of the system, for x, y and turn times reach: xx xy yy xt yt tt */
    tz_vec3 b, x, r, p, q; /**< right side, step, conjugate gradients */
} tz_fill_lack;

typedef struct tz_fill_outlines {
    tz_fill *f;
    double even;           /**< weight of pulls; 0 = none */
    double part;           /**< of gaps that are asked for now */
    bool straight;         /**< contacts only push */
    tz_fill_pose_of *pose; /**< a body each */
    tz_fill_lack *lack;
    bool *moved, *known;           /**< since contacts were found; whether the pose is */
    double *shrunk;                /**< so far */
    tz_vec2 *border;               /**< TZ_FILL_BORDER a soft body */
    double (*way)[TZ_FILL_BORDER]; /**< a model: along its outline's points */
    double *rim;                   /**< a model: length of its outline */
    int32_t softs;
    bool any_soft;
    int32_t bodies, room;  /**< that arrays are filled for, that they hold */
    int32_t *start, *near; /**< bodies near each */
    int32_t *touch;        /**< of near: its contact; ~ if this body is its b */
    tz_fill_contact *contact;
    int32_t contacts;
    tz_fill_share *share; /**< of body i from 2 * start[i] on */
} tz_fill_outlines;

/* fill_outline.c */
tz_status tz_fill_outlines_init(tz_fill *f, tz_fill_outlines *o);
void tz_fill_outlines_deinit(tz_fill_outlines *o);
/** Room for `more` bodies besides those that are there. */
tz_status tz_fill_outlines_reserve(tz_fill_outlines *o, int32_t more);
/** Where a body lies, after its samples have changed. */
void tz_fill_outline_find(tz_fill_outlines *o, int32_t body);
void tz_fill_outline_move(tz_fill_outlines *o, int32_t body, tz_vec2 by);
void tz_fill_outline_turn(tz_fill_outlines *o, int32_t body, double by);
/** Whether gaps between two bodies have to be looked at. */
bool tz_fill_outlines_near(const tz_fill_outlines *o, int32_t a, int32_t b);
/** Depth in b of the point of a's outline that is deepest there, or nearest.
 * @param least     shallower ones do not count
 * @param whole     all points are looked at, not only those about `best`
 * @param[in,out] best  the point; tried first, if >= 0; -1 = none is over `least`
 * @param[out] at, way  where it is, and the way out of b; if there is one
 * @return its depth; `least` if there is none */
double tz_fill_outline_depth(const tz_fill_outlines *o, int32_t a, int32_t b,
                             double least, bool whole, int8_t *best, tz_vec2 *at,
                             tz_vec2 *way);
/** What a body's outline lacks to the domain's border with a gap; <= 0: nothing. */
double tz_fill_outline_border(const tz_fill_outlines *o, int32_t body, double gap,
                              tz_vec2 *at, tz_vec2 *way);
/** Overlap that nobody sees. */
double tz_fill_slack(const tz_fill *f, int32_t body);

/* fill_contact.c */
/** Bodies near each, from the power diagram. */
tz_status tz_fill_contacts_find(tz_fill_outlines *o);
/** All contacts and lacks as things lie. */
tz_status tz_fill_contacts_measure(tz_fill_outlines *o);
/** Rounds with `part` of the gaps, until nothing lacks more than the slack.
 * @param[out] left  NULL, or bodies that do in the end */
tz_status tz_fill_contacts_relax(tz_fill_outlines *o, int32_t rounds, double part,
                                 int32_t *left);

/* fill_gap.c */
/** The hardest pressed go to the largest empty places, if these are larger than what they
 * have. */
tz_status tz_fill_gap_move(tz_fill_outlines *o, double share, int32_t *moved);
/** Things of the mix come where one is pressed no harder than all are in the mean.
 * @param room  area that they may take up, with what their density asks for */
tz_status tz_fill_gap_fill(tz_fill_outlines *o, double room, int32_t *came);

#endif
