/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where predictions take from and draw to. Not installed. */
#ifndef TZ_CURVES_PREDICT_INTERNAL_H
#define TZ_CURVES_PREDICT_INTERNAL_H

#include "curves/predict.h"

/** Where the drawing is an exemplar, and where it is complete.
 * @param[out] source    replaced; NULL on error
 * @param[out] complete  replaced; NULL on error */
tz_status tz_predict_regions(tz_ctx *ctx, const tz_curve_predict_job *job,
                             tz_region **source, tz_region **complete);

#endif
