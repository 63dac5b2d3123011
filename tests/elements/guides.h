/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Small files for tests of regions, frames and zones. Include after check.h. */
#ifndef TZ_TESTS_GUIDES_H
#define TZ_TESTS_GUIDES_H

#include "base/image_io.h"

static char guide_dir[64], guide_path[512];

static inline int guide_begin(void **state)
{
    (void)state;
    begin_dir(guide_dir);
    return 0;
}

static inline int guide_end(void **state)
{
    (void)state;
    end_dir(guide_dir);
    return 0;
}

/* Writes a text, returns its path (one at a time). */
static inline const char *guide_text(const char *name, const char *text)
{
    snprintf(guide_path, sizeof guide_path, "%s/%s", guide_dir, name);
    FILE *f = fopen(guide_path, "w");
    assert_non_null(f);
    fputs(text, f);
    fclose(f);
    return guide_path;
}

/* A drawing of 100 x 100 with this inside. */
static inline const char *guide_svg(const char *inside)
{
    static char text[8192];
    snprintf(text, sizeof text,
             "<svg xmlns='http://www.w3.org/2000/svg' "
             "xmlns:xlink='http://www.w3.org/1999/xlink' viewBox='0 0 100 100'>%s</svg>",
             inside);
    return guide_text("guide.svg", text);
}

/* Writes an image of plain numbers: value(x, y, c). */
static inline const char *guide_image(tz_ctx *ctx, int32_t width, int32_t height,
                                      int32_t channels,
                                      float (*value)(int32_t, int32_t, int32_t))
{
    tz_image im;
    const tz_image_write_options opt = {.type = TZ_SAMPLE_U8, .compression = -1};
    assert_int_equal(tz_image_init(ctx, &im, width, height, channels), TZ_OK);
    im.encoding = TZ_ENCODING_SRGB; /* as the file: no conversion */
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++)
            for (int32_t c = 0; c < channels; c++)
                tz_image_at(&im, x, y)[c] = value(x, y, c);
    snprintf(guide_path, sizeof guide_path, "%s/guide.png", guide_dir);
    assert_int_equal(tz_image_write(ctx, guide_path, &im, &opt), TZ_OK);
    tz_image_deinit(&im);
    return guide_path;
}

#endif
