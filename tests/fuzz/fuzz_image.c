/* SPDX-License-Identifier: Apache-2.0 */
/* Image readers of our own: PNG, JPEG, EXR, by way of a file in memory. */
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/image_internal.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static tz_ctx *ctx;
    tz_ctx_options opt = {.threads = 1, .memory = 256u << 20};
    if (!ctx && tz_ctx_new(&opt, &ctx) != TZ_OK)
        return 0;
    tz_image_read_options read = {.max_pixels = 1 << 20};
    tz_image_source src = {.ctx = ctx,
                           .path = "fuzz",
                           .piped = true,
                           .data = data,
                           .size = size,
                           .opt = &read,
                           .max_pixels = 1 << 20};
    tz_image im = {0};
    tz_image_found found = {0};
    tz_status s = TZ_FORMAT;
    if (size < 4)
        return 0;
    if (data[0] == 0x89)
        s = tz_png_read(&src, &im, &found);
    else if (data[0] == 0xff)
        s = tz_jpeg_read(&src, &im, &found);
    else
        s = tz_exr_read(&src, &im, &found);
    if (s == TZ_OK)
        tz_image_orient(ctx, &im, found.orientation);
    tz_image_deinit(&im);
    tz_ctx_clear(ctx);
    if (tz_ctx_memory_used(ctx) != 0)
        __builtin_trap();
    return 0;
}
