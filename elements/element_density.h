/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How many elements an area holds, as a set shows it: its border taken into account.
 *
 * Elements over area is right where every element whose centre lies in the frame is there
 * and stands for itself. Three habits of drawings spoil it:
 *   - the drawing shows one period, and what its frame cuts is drawn at both sides. Then
 *     only centres in the frame count;
 *   - elements that the frame cuts are pieces, with a centre of their own (two halves of
 *     one thing count twice). Then only whole ones count, each by how likely a thing of
 *     its extent w, h is to be whole in a frame W, H:
 *         density = sum of 1 / ((W - w) (H - h))
 *   - cut elements were left out, which leaves a margin that the texture itself has not.
 *     Then an inner window counts, whose weight rises smoothly from its border, so that
 *     rows of lattices do not enter at one stroke.
 * @source the second: Horvitz, Thompson, A generalization of sampling without replacement,
 *   1952 */
#ifndef TZ_ELEMENTS_ELEMENT_DENSITY_H
#define TZ_ELEMENTS_ELEMENT_DENSITY_H

#include "elements/element.h"

/** Elements by area, 1 over user units squared.
 * @param voids  elements that stand for empty room count too
 * @cost O(points of outlines + cut elements * elements) */
TZ_API double tz_element_density(const tz_element_set *set, bool voids);

/** How many elements by area each stands for: all together the density. A cut piece stands
 * for none where whole ones are counted.
 * @param[out] weight  one an element @param[out] period  NULL, or whether what is cut has
 * a twin that is drawn whole
 * @cost as tz_element_density */
TZ_API void tz_element_weights(const tz_element_set *set, double *weight, bool *period);

/** One thing that is counted. */
typedef struct tz_counted {
    tz_vec2 at; /**< from the frame's corner */
    double radius;
    const tz_element *element; /**< of the set */
} tz_counted;

/** What is counted, and the frame it is counted in: parts of sets, perhaps scaled. */
typedef struct tz_crowd {
    const tz_element_set *set;
    double scale;
    tz_vec2 size;
    bool torus;
    int32_t n;
    bool (*get)(const void *of, int32_t k, tz_counted *u); /**< false = does not count */
    const void *of;
} tz_crowd;

/** Whether a frame shows one period: all that it cuts, at least two things, has a twin a
 * width or a height away. @cost O(cut elements * elements) */
bool tz_crowd_repeats(const tz_crowd *c);
/** Whether a thing lies in a frame that repeats: the lower sides are in, the upper ones
 * out. */
bool tz_crowd_holds(tz_vec2 size, tz_vec2 at, double radius);
/** How a crowd is counted. */
typedef struct tz_counting {
    enum { TZ_COUNT_FRAME, TZ_COUNT_PERIOD, TZ_COUNT_WHOLE, TZ_COUNT_WINDOW } how;
    tz_vec2 rim; /* of a window */
    double ramp;
} tz_counting;
/** @param repeats  as tz_crowd_repeats says */
tz_counting tz_crowd_counting(const tz_crowd *c, bool repeats);
/** How many elements by area one stands for; their sum is the density. */
double tz_crowd_weight(const tz_crowd *c, const tz_counting *how, const tz_counted *u);
double tz_crowd_density(const tz_crowd *c, const tz_counting *how);

#endif
