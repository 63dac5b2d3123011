/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Fuzzes the reader of exemplar documents: what it accepts must be safe to write again.
 */
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "analysis/ebpt.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char path[64], back[64];
    const tz_ctx_options o = {.threads = 1, .memory = (size_t)256 << 20};
    tz_ctx *ctx = NULL;
    tz_ebpt e;
    char *photo, sha256[65];

    if (!path[0]) {
        const char *dir = access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm";
        snprintf(path, sizeof path, "%s/tz-fuzz-ebpt-%ld.svg", dir, (long)getpid());
        snprintf(back, sizeof back, "%s/tz-fuzz-ebpt-%ld.out", dir, (long)getpid());
    }
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data, 1, size, f) != size || fclose(f) || tz_ctx_new(&o, &ctx))
        abort();
    if (tz_ebpt_read(ctx, path, &e, &photo, sha256) == TZ_OK) {
        if (tz_ebpt_write(ctx, back, &e, photo, sha256) != TZ_OK)
            abort();
        tz_ebpt_deinit(&e);
        tz_free(ctx, photo);
    }
    tz_ctx_free(ctx);
    unlink(path);
    unlink(back);
    return 0;
}
