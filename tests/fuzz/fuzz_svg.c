/* SPDX-License-Identifier: Apache-2.0 */
/* SVG: the document, and each attribute as path, transform and numbers. */
#include "base/svg.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void visit(tz_ctx *ctx, tz_svg_doc *doc, tz_svg_node n, int depth)
{
    for (; n; n = tz_svg_next(n)) {
        tz_affine m;
        tz_svg_path path;
        tz_numbers numbers = {0};
        double v;
        const char *d = tz_svg_attr(n, "d"), *points = tz_svg_attr(n, "points");
        tz_svg_transform(ctx, tz_svg_attr(n, "transform"), &m);
        tz_svg_number(tz_svg_attr(n, "width"), &v);
        if (d && tz_svg_path_parse(ctx, d, &path) == TZ_OK)
            tz_svg_path_deinit(ctx, &path);
        if (points)
            tz_svg_numbers(ctx, points, &numbers);
        tz_array_free(ctx, &numbers);
        const char *id = tz_svg_attr(n, "id");
        if (id && !tz_svg_by_id(doc, id))
            __builtin_trap();
        tz_svg_text(doc, n);
        if (depth < 300)
            visit(ctx, doc, tz_svg_child(n), depth + 1);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static tz_ctx *ctx;
    tz_ctx_options opt = {.threads = 1};
    if (!ctx && tz_ctx_new(&opt, &ctx) != TZ_OK)
        return 0;
    tz_svg_doc *doc;
    if (tz_svg_parse(ctx, "fuzz", (const char *)data, size, &doc) == TZ_OK) {
        visit(ctx, doc, tz_svg_root(doc), 0);
        tz_svg_free(doc);
    }
    tz_ctx_clear(ctx);
    if (tz_ctx_memory_used(ctx) != 0)
        __builtin_trap();
    return 0;
}
