/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The picture's own scale of structure. Private to analysis/. */
#ifndef TZ_ANALYSIS_SCALE_H
#define TZ_ANALYSIS_SCALE_H

#include "analysis/ebpt.h"
#include "analysis/tensor.h"

/** Typical diameter of a thing (a stone, a brick), px; 1/12 of the side if there is
 * nothing to see; from p->groups if that is set. */
tz_status tz_scale_find(const tz_tensor *t, const tz_ebpt_params *p, double *scale);

/** Brings the response half way to the same mean everywhere (over about 1.5 scale), so
 * that things in the shade have borders too. */
tz_status tz_scale_balance(tz_ctx *ctx, float *response, int32_t width, int32_t height,
                           double scale);

/** Weights for tz_tensor_response under which borders of things of this diameter stand
 * out and their inner texture does not. */
void tz_scale_weights(double scale, double weight[]);

/** Response of a full border: 0.9 quantile over the pixels. */
double tz_scale_full(const float *response, int64_t n);

#endif
