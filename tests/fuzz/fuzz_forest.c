/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Any bytes as a structured-forest model: a walk through what is read must end inside it,
 * and writing it gives the same forest again. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "analysis/forest_features.h"
#include "analysis/forest_model.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What a detector relies on, at every node. */
static void check(const tz_forest *f)
{
    if (f->trees < 1 || f->evaluated < 1 || f->evaluated > f->trees || f->nodes < 1)
        abort();
    for (int32_t i = 0; i < f->trees * f->nodes; i++) {
        const int32_t at = i % f->nodes, c = f->child[i];
        if (c != 0 && (c - 1 <= at || c >= f->nodes || f->feature[i] < 0 ||
                       f->feature[i] >= TZ_FOREST_FEATURES))
            abort();
        if (f->bound[i] < 0 || f->bound[i + 1] < f->bound[i])
            abort();
        if (!(f->threshold[i] - f->threshold[i] == 0)) /* finite */
            abort();
    }
}

static void check_same(const tz_forest *a, const tz_forest *b)
{
    const size_t n = (size_t)a->trees * (size_t)a->nodes;
    if (a->trees != b->trees || a->evaluated != b->evaluated || a->nodes != b->nodes ||
        memcmp(a->child, b->child, n * sizeof *a->child) != 0 ||
        memcmp(a->feature, b->feature, n * sizeof *a->feature) != 0 ||
        memcmp(a->bound, b->bound, (n + 1) * sizeof *a->bound) != 0 ||
        (a->bound[n] && memcmp(a->bin, b->bin, (size_t)a->bound[n]) != 0))
        abort();
    for (size_t i = 0; i < n; i++)
        if (a->threshold[i] != b->threshold[i])
            abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char path[64], back[64];
    const tz_ctx_options o = {.threads = 1, .memory = (size_t)256 << 20};
    tz_ctx *ctx = NULL;
    tz_forest a, b;

    if (!path[0]) {
        const char *dir = access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm";
        snprintf(path, sizeof path, "%s/tz-fuzz-forest-%ld.yml", dir, (long)getpid());
        snprintf(back, sizeof back, "%s/tz-fuzz-forest-%ld.out", dir, (long)getpid());
    }
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data, 1, size, f) != size || fclose(f) || tz_ctx_new(&o, &ctx))
        abort();
    if (tz_forest_read(ctx, path, &a) == TZ_OK) {
        check(&a);
        if (tz_forest_write(ctx, back, &a) != TZ_OK ||
            tz_forest_read(ctx, back, &b) != TZ_OK)
            abort();
        check_same(&a, &b);
        tz_forest_deinit(&b);
    } else if (!*tz_ctx_message(ctx) || a.child || a.bin) {
        abort(); /* no failure without a message, nothing left behind */
    }
    tz_forest_deinit(&a);
    if (tz_ctx_memory_used(ctx))
        abort();
    tz_ctx_free(ctx);
    unlink(path);
    unlink(back);
    return 0;
}
