/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Any bytes as a drawing: the curves in it hold together, can be written and read again as
 * the same, sampled, and made anew of the samples. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "curves/curve_io.h"
#include "curves/reconstruct.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_same(const tz_curve_set *a, const tz_curve_set *b)
{
    if (a->node.n != b->node.n || a->piece.n != b->piece.n || a->path.n != b->path.n ||
        a->pen.n != b->pen.n)
        abort();
    for (int32_t i = 0; i < a->node.n; i++)
        if (a->node.v[i].x != b->node.v[i].x || a->node.v[i].y != b->node.v[i].y)
            abort();
    for (int32_t i = 0; i < a->piece.n; i++) {
        const tz_curve_piece *p = &a->piece.v[i], *q = &b->piece.v[i];
        if (p->from != q->from || p->to != q->to || p->a.x != q->a.x ||
            p->b.y != q->b.y || p->straight != q->straight)
            abort();
    }
}

static void sample(tz_ctx *ctx, const tz_curve_set *s)
{
    const tz_sample_levels l = tz_sample_levels_default(s);
    tz_sample_graph g;
    tz_curve_set back;
    if (tz_sample_graph_make(ctx, s, l.spacing[2], l.radius[2], &g) != TZ_OK) {
        if (!*tz_ctx_message(ctx))
            abort();
        return;
    }
    if (tz_sample_graph_check(ctx, &g, "graph") != TZ_OK)
        abort();
    if (g.edge.n > 0 && tz_curve_reconstruct(ctx, &g, s, &back) == TZ_OK) {
        if (tz_curve_set_check(ctx, &back, "back") != TZ_OK)
            abort();
        tz_curve_set_deinit(&back);
    }
    tz_sample_graph_deinit(&g);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char path[64];
    const tz_ctx_options o = {.threads = 1, .memory = (size_t)256 << 20};
    tz_ctx *ctx = NULL;
    tz_curve_set a, b;
    char *text = malloc(size + 1);

    if (!path[0]) {
        const char *dir = access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm";
        snprintf(path, sizeof path, "%s/tz-fuzz-curve-%ld.svg", dir, (long)getpid());
    }
    if (!text || tz_ctx_new(&o, &ctx))
        abort();
    memcpy(text, data, size);
    text[size] = 0;
    if (tz_curve_parse_svg(ctx, "fuzz.svg", text, size, NULL, &a) == TZ_OK) {
        if (tz_curve_write_svg(ctx, path, &a) != TZ_OK ||
            tz_curve_read_svg(ctx, path, NULL, &b) != TZ_OK)
            abort();
        check_same(&a, &b);
        sample(ctx, &a);
        tz_curve_set_deinit(&b);
        unlink(path);
    } else if (!*tz_ctx_message(ctx) || a.node.v) {
        abort(); /* no failure without a message, nothing left behind */
    }
    tz_curve_set_deinit(&a);
    if (tz_ctx_memory_used(ctx))
        abort();
    tz_ctx_free(ctx);
    free(text);
    return 0;
}
