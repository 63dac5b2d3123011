/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the timing programs share: clocks, medians, the exemplar. Each prints one line a
 * measurement, fields apart by blanks, which tests/bench.sh makes tables of. */
#ifndef TZ_TESTS_BENCH_H
#define TZ_TESTS_BENCH_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "base/image_io.h"
#include "base/rng.h"

static inline double bench_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/** Processor seconds of this process so far. */
static inline double bench_cpu(void)
{
    struct rusage u;
    getrusage(RUSAGE_SELF, &u);
    return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
           1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

/** Largest resident size of this process so far, MiB. */
static inline double bench_peak(void)
{
    struct rusage u;
    getrusage(RUSAGE_SELF, &u);
    return (double)u.ru_maxrss / 1024;
}

static inline int bench_compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/** Median; sorts v. */
static inline double bench_median(double *v, int n)
{
    qsort(v, (size_t)n, sizeof *v, bench_compare);
    return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

/** Stops the program with the context's message unless s is TZ_OK. */
static inline void bench_check(tz_ctx *ctx, tz_status s)
{
    if (s == TZ_OK)
        return;
    fprintf(stderr, "bench: %s\n", tz_ctx_message(ctx));
    exit(1);
}

/** Context of `threads` workers (0 = all) without a memory limit. */
static inline tz_ctx *bench_ctx(int threads)
{
    const tz_ctx_options o = {.threads = threads};
    tz_ctx *ctx = NULL;
    bench_check(NULL, tz_ctx_new(&o, &ctx));
    return ctx;
}

/** Photo, sRGB-encoded; `channels` 0 = as it is, else 1 or 3. */
static inline tz_image bench_photo(tz_ctx *ctx, const char *path, int32_t channels)
{
    const tz_image_read_options o = {.want = TZ_ENCODING_SRGB};
    tz_image im, out;
    bench_check(ctx, tz_image_read(ctx, path, &o, &im));
    if (channels == 0 || channels == im.channels)
        return im;
    bench_check(ctx, tz_image_init(ctx, &out, im.width, im.height, channels));
    out.encoding = im.encoding;
    for (int32_t y = 0; y < im.height; y++)
        for (int32_t x = 0; x < im.width; x++)
            for (int32_t k = 0; k < channels; k++)
                tz_image_at(&out, x, y)[k] = tz_image_at(
                    &im, x, y)[im.channels >= 3 ? (channels == 1 ? 1 : k) : 0];
    tz_image_deinit(&im);
    return out;
}

#endif
