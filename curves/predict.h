/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Drawing with predictions: what a region may hold, foretold from what is drawn about it
 * (autocomplete) or somewhere else (clone), to be taken, taken in part, or left.
 * @source [Tu20] Sec. 3, Fig. 4 */
#ifndef TZ_CURVES_PREDICT_H
#define TZ_CURVES_PREDICT_H

#include "curves/curve_arrange.h"

typedef struct tz_curve_predict_job {
    const tz_curve_set *drawing; /**< all that is drawn; not changed */
    const tz_region
        *from;           /**< where the exemplar is taken from; NULL = all of the drawing
                                outside `to` that has something drawn near it. Regions span
                                the drawing's domain */
    const tz_region *to; /**< where it is foretold. What is drawn inside it stays, and is
                                fitted */
    const tz_curve_arrange_params
        *params; /**< NULL = defaults; method AUTO means quilting,
                                                which joins what is drawn without fail */
    uint64_t seed;
} tz_curve_predict_job;

typedef enum tz_curve_choice {
    TZ_CURVE_OPEN,
    TZ_CURVE_TAKEN,
    TZ_CURVE_LEFT
} tz_curve_choice;

/** A prediction: paths and elements in the drawing's coordinates, and what has become of
 * each of them. */
typedef struct tz_curve_prediction {
    tz_curve_set set;
    TZ_ARRAY(uint8_t)
    path; /**< tz_curve_choice of set.path */
    TZ_ARRAY(uint8_t)
    element;       /**< tz_curve_choice of set.element.element */
    int32_t round; /**< how often it was foretold anew */
} tz_curve_prediction;

/** @param[out] p  overwritten, not freed; zeroed on error; everything TZ_CURVE_OPEN
 * @return TZ_OK; TZ_INVALID (region outside the drawing or as large as it, nothing drawn
 *   to go by); what tz_curve_arrange returns
 * @cost that of arranging the region */
TZ_API tz_status tz_curve_predict(tz_ctx *ctx, const tz_curve_predict_job *job,
                                  tz_curve_prediction *p);
TZ_API void tz_curve_prediction_deinit(tz_curve_prediction *p); /**< takes zeroed */

/** Marks what lies inside a region (half of it or more), or, with region NULL, all that is
 * still open. @return how many paths and elements changed */
TZ_API int32_t tz_curve_predict_mark(tz_curve_prediction *p, const tz_region *region,
                                     tz_curve_choice choice);
/** Marks the path nearest to a place, within `reach`. @return it; -1 = none */
TZ_API int32_t tz_curve_predict_mark_at(tz_curve_prediction *p, tz_vec2 at, double reach,
                                        tz_curve_choice choice);
/** Adds what is taken to the drawing, joined with what it meets, and drops it and what is
 * left from the prediction; what is open stays open.
 * @param[in,out] drawing  unchanged on error (as the prediction is)
 * @return TZ_OK; TZ_INVALID (elements of another drawing); TZ_NOMEM */
TZ_API tz_status tz_curve_predict_accept(tz_ctx *ctx, tz_curve_prediction *p,
                                         tz_curve_set *drawing);
/** Foretells anew what is open, around what is drawn and taken by now, with another seed;
 * what is left goes.
 * @param[in,out] p  unchanged on error */
TZ_API tz_status tz_curve_predict_again(tz_ctx *ctx, const tz_curve_predict_job *job,
                                        tz_curve_prediction *p);

#endif
