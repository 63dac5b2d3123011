/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Any bytes as a drawing: the elements in it hold together, and can be written and read
 * again as the same. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "elements/element_io.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_same(const tz_element_set *a, const tz_element_set *b)
{
    if (a->element.n != b->element.n || a->sample.n != b->sample.n ||
        a->kind.n != b->kind.n || a->symbol.n != b->symbol.n)
        abort();
    for (int32_t i = 0; i < a->element.n; i++) {
        const tz_element *p = &a->element.v[i], *q = &b->element.v[i];
        if (memcmp(&p->at, &q->at, sizeof p->at) != 0 || p->angle != q->angle ||
            p->scale != q->scale || p->radius != q->radius || p->kind != q->kind ||
            p->symbol != q->symbol || p->samples != q->samples)
            abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char path[64];
    const tz_ctx_options o = {.threads = 1, .memory = (size_t)256 << 20};
    const tz_element_read_options automatic = {.wrap_auto = true};
    tz_ctx *ctx = NULL;
    tz_element_set a, b;
    char *text = malloc(size + 1);

    if (!path[0]) {
        const char *dir = access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm";
        snprintf(path, sizeof path, "%s/tz-fuzz-element-%ld.svg", dir, (long)getpid());
    }
    if (!text || tz_ctx_new(&o, &ctx))
        abort();
    memcpy(text, data, size);
    text[size] = 0;
    if (tz_element_parse_svg(ctx, "fuzz.svg", text, size, &automatic, &a) == TZ_OK) {
        if (tz_element_write_svg(ctx, path, &a) != TZ_OK ||
            tz_element_read_svg(ctx, path, NULL, &b) != TZ_OK)
            abort();
        check_same(&a, &b);
        tz_element_set_deinit(&b);
        unlink(path);
    } else if (!*tz_ctx_message(ctx) || a.element.v) {
        abort(); /* no failure without a message, nothing left behind */
    }
    tz_element_set_deinit(&a);
    if (tz_ctx_memory_used(ctx))
        abort();
    tz_ctx_free(ctx);
    free(text);
    return 0;
}
