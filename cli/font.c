/* SPDX-License-Identifier: Apache-2.0 */
/* A glyph is 8 rows of 5 dots in one number: dot (x, y) is bit 5 y + x. 'A':
 *
 *     . # # # .     row 0: bits 1, 2, 3
 *     # . . . #     row 1: bits 5, 9          the last row is for descenders
 *     # . . . #     ... */
#include "cli/font.h"

static const uint64_t glyph[95] = {
    0x0,         0x100421084, 0x14a,        0x295f57d4a,  0x11f4717c4, 0x672222273,
    0x593511526, 0x84,        0x208210888,  0x88842082,   0x9575480,   0x84f9080,
    0x88600000,  0xf8000,     0x18c000000,  0x42222210,   0x3a33ae62e, 0x3884210c4,
    0x7c444422e, 0x3a304111f, 0x211f4a988,  0x3a3083c3f,  0x3a317844c, 0x8422221f,
    0x3a317462e, 0x1910f462e, 0xc6018c0,    0x886018c0,   0x208208888, 0x1f07c00,
    0x44441041,  0x10044422e, 0x783daf62e,  0x4631fc62e,  0x3e317c62f, 0x3a210862e,
    0x1d318c527, 0x7c217843f, 0x4217843f,   0x7a31e862e,  0x4631fc631, 0x38842108e,
    0x19284211c, 0x452519531, 0x7c2108421,  0x4631ad771,  0x4639ace31, 0x3a318c62e,
    0x4217c62f,  0x59358c62e, 0x45257c62f,  0x3e107043e,  0x10842109f, 0x3a318c631,
    0x11518c631, 0x2ab5ac631, 0x462a22a31,  0x108422a31,  0x7c222221f, 0x38421084e,
    0x420820821, 0x39084210e, 0x4544,       0x7c0000000,  0x82,        0x7a3e83800,
    0x3e319b421, 0x3a210b800, 0x7a31cda10,  0x383f8b800,  0x84238a4c,  0x743d18f800,
    0x46319b421, 0x388421804, 0x3250843008, 0x24a32a421,  0x388421086, 0x4635aac00,
    0x46319b400, 0x3a318b800, 0x85f18bc00,  0x843d1cd800, 0x4219b400,  0x3e0e0b800,
    0x324211c42, 0x5b318c400, 0x11518c400,  0x2ab58c400,  0x454454400, 0x743d18c400,
    0x7c4447c00, 0x30841108c, 0x108421084,  0x188441086,  0x11510000,
};

static void dot(tz_image *im, tz_rect r, float value)
{
    r = tz_rect_intersect(r, (tz_rect){0, 0, im->width, im->height});
    for (int32_t y = r.y; y < r.y + r.h; y++)
        for (int32_t x = r.x; x < r.x + r.w; x++)
            for (int32_t c = 0; c < im->channels; c++)
                tz_image_at(im, x, y)[c] = c == im->alpha ? 1 : value;
}

void tz_font_draw(tz_image *im, int32_t x, int32_t y, int32_t scale, float value,
                  const char *text)
{
    for (; *text; text++, x += TZ_FONT_WIDTH * scale) {
        int code = *text >= 32 && *text < 127 ? *text - 32 : '?' - 32;
        for (int32_t i = 0; i < 40; i++)
            if (glyph[code] >> i & 1)
                dot(im, (tz_rect){x + i % 5 * scale, y + i / 5 * scale, scale, scale},
                    value);
    }
}
