/* SPDX-License-Identifier: Apache-2.0 */
/* A sheet of training scenes: one of each kind, and its true boundaries beside it.
 *
 *   draw_scenes OUT.png [SEED [SIDE]]        (default seed 1000000, held out; 192 px) */
#include <stdio.h>
#include <stdlib.h>

#include "base/image_io.h"
#include "scenes/scene.h"

enum { PAIRS = 4, GAP = 4 };

static void put(tz_image *sheet, const tz_scene *scene, int32_t x0, int32_t y0)
{
    const int32_t side = scene->photo.width;
    for (int32_t y = 0; y < side; y++)
        for (int32_t x = 0; x < side; x++) {
            const float *p = tz_image_at(&scene->photo, x, y);
            const bool on = scene->boundary[(size_t)y * (size_t)side + (size_t)x];
            for (int32_t c = 0; c < 3; c++) {
                tz_image_at(sheet, x0 + x, y0 + y)[c] = p[c];
                tz_image_at(sheet, x0 + side + x, y0 + y)[c] = on ? 0.1F : 1;
            }
        }
}

static tz_status draw(tz_ctx *ctx, const char *path, uint64_t seed, int32_t side)
{
    const tz_image_write_options opt = {.compression = 9};
    const int32_t rows = (TZ_SCENE_COUNT + PAIRS - 1) / PAIRS;
    tz_image sheet;
    tz_status s = tz_image_init(ctx, &sheet, PAIRS * (2 * side + GAP) - GAP,
                                rows * (side + GAP) - GAP, 3);
    if (s != TZ_OK)
        return s;
    sheet.encoding = TZ_ENCODING_SRGB;
    sheet.depth = 8;
    for (int64_t i = 0; i < (int64_t)sheet.width * sheet.height * 3; i++)
        sheet.px[i] = 1;
    for (int32_t k = 0; k < TZ_SCENE_COUNT && s == TZ_OK; k++) {
        tz_scene scene;
        s = tz_scene_render(ctx, (tz_scene_kind)k, TZ_SCENE_WILD, side, side,
                            seed + (uint64_t)k, &scene);
        if (s == TZ_OK)
            put(&sheet, &scene, k % PAIRS * (2 * side + GAP), k / PAIRS * (side + GAP));
        tz_scene_deinit(&scene);
    }
    if (s == TZ_OK)
        s = tz_image_write(ctx, path, &sheet, &opt);
    tz_image_deinit(&sheet);
    return s;
}

int main(int argc, char **argv)
{
    tz_ctx *ctx = NULL;
    if (argc < 2) {
        fprintf(stderr, "use: draw_scenes OUT.png [SEED [SIDE]]\n");
        return 2;
    }
    if (tz_ctx_new(NULL, &ctx) != TZ_OK)
        return 1;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1000000;
    const tz_status s = draw(ctx, argv[1], seed, argc > 3 ? atoi(argv[3]) : 192);
    if (s != TZ_OK)
        fprintf(stderr, "draw_scenes: %s\n", tz_ctx_message(ctx));
    tz_ctx_free(ctx);
    return s != TZ_OK;
}
