/* SPDX-License-Identifier: Apache-2.0 */
/* Kinds without a generator of their own yet borrow another. */
#include "analysis/forest_scene_canvas.h"

tz_status tz_scene_CRACKS(tz_canvas *c) { return tz_scene_STONES(c); }
