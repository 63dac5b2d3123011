/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Any bytes as a layout document; what is read must hold together. */
#include <stdlib.h>

#include "synthesis/layout.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    tz_ctx *ctx = NULL;
    tz_layout l = {0};
    tz_ctx_options opt = {.threads = 1, .memory = (size_t)256 << 20};
    if (tz_ctx_new(&opt, &ctx))
        return 0;
    tz_status st = tz_layout_parse(ctx, "fuzz.svg", (const char *)data, size, &l);
    if (!st) {
        for (int32_t i = 0; i < l.place.n; i++) {
            const tz_placement *p = &l.place.v[i];
            tz_affine inverse;
            tz_layout_box(&l, i);
            if (p->source < 0 || p->source >= l.source.n || p->points < 3 ||
                p->border < 0 || p->border + p->points > l.border.n ||
                !tz_affine_invert(p->map, &inverse))
                abort();
        }
        tz_layout_at(&l, (tz_vec2){1, 1});
        if (tz_layout_compact(&l))
            abort();
    } else if (!*tz_ctx_message(ctx) || l.place.v) {
        abort(); /* no failure without a message, nothing left behind */
    }
    tz_layout_deinit(&l);
    if (tz_ctx_memory_used(ctx))
        abort();
    tz_ctx_free(ctx);
    return 0;
}
