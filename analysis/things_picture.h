/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A photo as the search for things sees it: smoothed colours and the strength of
 * borders. Private to analysis/. */
#ifndef TZ_ANALYSIS_THINGS_PICTURE_H
#define TZ_ANALYSIS_THINGS_PICTURE_H

#include "analysis/tensor.h"
#include "analysis/things_tree.h"

typedef struct tz_things_view {
    tz_things_picture picture; /**< points into what follows */
    tz_tensor tensor;
    float *edge, *normal; /**< normal: planes d, c, see analysis/edges.h */
    float *forest;        /**< response of the forest */
} tz_things_view;

/** @param model  structured-forest file, "" = Terrazzo's own
 *  @param[out] v  replaced; empty on error */
tz_status tz_things_look(tz_ctx *ctx, const tz_image *photo, const char *model,
                         tz_things_view *v);
void tz_things_view_deinit(tz_ctx *ctx, tz_things_view *v); /**< takes zeroed */

#endif
