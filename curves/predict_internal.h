/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where predictions take from and draw to. Not installed. */
#ifndef TZ_CURVES_PREDICT_INTERNAL_H
#define TZ_CURVES_PREDICT_INTERNAL_H

#include "curves/predict.h"

/** Where the drawing is an exemplar, and where it is complete.
 * @param[out] source    replaced; NULL on error
 * @param[out] complete  replaced; NULL on error
 * @param[out] spacing   distance from line to line, user units */
tz_status tz_predict_regions(tz_ctx *ctx, const tz_curve_predict_job *job,
                             tz_region **source, tz_region **complete, double *spacing);

/** Joins what is foretold with loose ends of the drawing in and about the region.
 * @param[in,out] set  what is foretold; sound also after an error
 * @param[out] loss    how badly it fits: little is good
 * @return TZ_OK; TZ_NOMEM  @cost O(loose ends squared, and times pieces) */
tz_status tz_predict_join(tz_ctx *ctx, const tz_curve_set *drawing, const tz_region *to,
                          double spacing, tz_curve_set *set, double *loss);

#endif
