/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Middle of a photo as an input of a given size, continued by mirror images where the photo
 * is smaller.
 *
 *   bench_cut PHOTO SIDE CHANNELS OUT.png */
#include "tests/bench/bench.h"

static int32_t mirror(int32_t i, int32_t n)
{
    i = ((i % (2 * n)) + 2 * n) % (2 * n);
    return i < n ? i : 2 * n - 1 - i;
}

int main(int argc, char **argv)
{
    if (argc != 5 || atoi(argv[2]) < 1) {
        fprintf(stderr, "use: bench_cut PHOTO SIDE CHANNELS OUT.png\n");
        return 2;
    }
    const int32_t side = atoi(argv[2]);
    tz_ctx *ctx = bench_ctx(1);
    tz_image photo = bench_photo(ctx, argv[1], atoi(argv[3])), out;
    bench_check(ctx, tz_image_init(ctx, &out, side, side, photo.channels));
    out.encoding = photo.encoding;
    for (int32_t y = 0; y < side; y++)
        for (int32_t x = 0; x < side; x++)
            memcpy(tz_image_at(&out, x, y),
                   tz_image_at(&photo, mirror(x + (photo.width - side) / 2, photo.width),
                               mirror(y + (photo.height - side) / 2, photo.height)),
                   (size_t)photo.channels * sizeof(float));
    const tz_image_write_options o = {.type = TZ_SAMPLE_U8, .compression = -1};
    bench_check(ctx, tz_image_write(ctx, argv[4], &out, &o));
    tz_image_deinit(&out);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
    return 0;
}
