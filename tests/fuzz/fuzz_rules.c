/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Any bytes as a rule file; what is read must be usable. */
#include <stdlib.h>

#include "synthesis/rules.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    tz_ctx *ctx = NULL;
    tz_rules r = {0};
    tz_ctx_options opt = {.threads = 1, .memory = (size_t)256 << 20};
    if (tz_ctx_new(&opt, &ctx))
        return 0;
    tz_status st =
        tz_rules_parse(ctx, "/nowhere/rules.json", (const char *)data, size, &r);
    if (!st) {
        if (r.rule.n < 1 || r.rule.v[0].shape.n || r.rule.v[0].mask >= 0)
            abort();
        for (int i = 0; i < 16; i++) {
            tz_vec2 p = {i * 13 % 100, i * 7 % 80};
            int32_t k = tz_rules_at(&r, 100, 80, p, i / 16.0);
            if (k < 0 || k >= r.rule.n)
                abort();
            if (!(fabs(tz_rules_field(&r, k, 100, 80, p)) <= TZ_PI + 1e-9))
                abort();
        }
    } else if (!*tz_ctx_message(ctx) || r.rule.v) {
        abort();
    }
    tz_rules_deinit(&r);
    if (tz_ctx_memory_used(ctx))
        abort();
    tz_ctx_free(ctx);
    return 0;
}
