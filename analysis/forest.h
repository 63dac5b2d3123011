/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Structured-forest edges through OpenCV's ximgproc, which lives in a module that is
 * opened when first needed. Private to analysis/.
 * @source [Kim21] Sec. 4.1; Dollar, Zitnick, Fast edge detection using structured
 * forests, PAMI 2015 */
#ifndef TZ_ANALYSIS_FOREST_H
#define TZ_ANALYSIS_FOREST_H

#include "base/image.h"

/** @param model  .yml or .yml.gz, checked before it is used
 *  @param[out] response  width * height, 0..1
 *  @param[out] normal    planes: cos, sin of twice the angle across the edge
 *  @return TZ_OK; TZ_IO (no such file); TZ_FORMAT (not a model); TZ_LIMIT; TZ_UNSUPPORTED
 *    (module not installed); TZ_NOMEM */
tz_status tz_forest_response(tz_ctx *ctx, const tz_image *photo, const char *model,
                             float *response, float *normal);

#endif
