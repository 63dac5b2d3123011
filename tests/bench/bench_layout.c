/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Layout documents of 300,000 placements: all of one border each, and sharing 400
 * borders. */
#include <stdio.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/rng.h"
#include "synthesis/layout.h"

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int run(int32_t n, int32_t borders)
{
    char path[64];
    snprintf(path, sizeof path, "/tmp/tz-bench-layout-%ld.svg", (long)getpid());
    tz_ctx *ctx = NULL;
    tz_layout l = {0}, back = {0};
    tz_rect box = {0};
    struct stat info;
    tz_status st = tz_ctx_new(NULL, &ctx);
    if (!st)
        st = tz_layout_init(ctx, &l, 65536, 65536, true);
    if (!st)
        st = tz_layout_add_source(&l, "photo.jpg", NULL, 1024, 1024, NULL);
    double t0 = now();
    for (int32_t i = 0; i < n && !st; i++) {
        tz_point b[16];
        tz_rng r = tz_rng_make(1, (uint64_t)(i % borders));
        for (int k = 0; k < 16; k++)
            b[k] = (tz_point){(float)tz_rng_range(&r, 0, 1024),
                              (float)tz_rng_range(&r, 0, 1024)};
        r = tz_rng_make(2, (uint64_t)i);
        tz_vec2 to = {tz_rng_range(&r, 0, 65536), tz_rng_range(&r, 0, 65536)};
        tz_affine m =
            tz_affine_place((tz_vec2){512, 512}, to, tz_rng_range(&r, 0, 6), 1, false);
        st = tz_layout_add(&l, 0, i % borders, m, b, 16, NULL);
    }
    double t1 = now();
    if (!st)
        st = tz_layout_write(ctx, path, &l);
    double t2 = now();
    if (!st)
        st = tz_layout_read(ctx, path, &back);
    double t3 = now();
    for (int32_t i = 0; i < l.place.n; i++)
        box = tz_layout_box(&l, i);
    int32_t at = tz_layout_at(&l, (tz_vec2){3, 3});
    double t4 = now();
    if (!stat(path, &info) && !st)
        printf("layout of %d placements, %d borders: add %.3f s, write %.3f s (%.1f MB), "
               "read %.3f s, box and at %.3f s\n",
               n, borders, t1 - t0, t2 - t1, (double)info.st_size * 1e-6, t3 - t2,
               t4 - t3);
    else
        fprintf(stderr, "bench_layout: %s\n", tz_ctx_message(ctx));
    unlink(path);
    tz_layout_deinit(&back);
    tz_layout_deinit(&l);
    tz_ctx_free(ctx);
    return st != TZ_OK || box.w < 0 || at < -1;
}

int main(void) { return run(300000, 300000) | run(300000, 400); }
