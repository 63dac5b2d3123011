/* SPDX-License-Identifier: Apache-2.0 */
/* JPEG and back in memory, for what compression does to edges: rings, blocks, bleeding
 * colours. libjpeg's integer transform gives the same bytes everywhere. */
#include "scenes/stage.h"

#include <stdio.h>
/* jpeglib.h needs FILE */
#include <jpeglib.h>
#include <setjmp.h>
#include <stdlib.h>

typedef struct codec {
    struct jpeg_error_mgr err; /* first: libjpeg hands back a pointer to it */
    jmp_buf jump;
    struct jpeg_compress_struct c;
    struct jpeg_decompress_struct d;
    unsigned char *bytes; /* libjpeg's own, from malloc */
    unsigned long size;
} codec;

static void on_error(j_common_ptr c) { longjmp(((codec *)c->err)->jump, 1); }

static void on_message(j_common_ptr c, int level)
{
    (void)c;
    (void)level;
}

static void compress(codec *k, uint8_t *rgb, int32_t width, int32_t height, int quality,
                     bool halved)
{
    jpeg_create_compress(&k->c);
    jpeg_mem_dest(&k->c, &k->bytes, &k->size);
    k->c.image_width = (JDIMENSION)width;
    k->c.image_height = (JDIMENSION)height;
    k->c.input_components = 3;
    k->c.in_color_space = JCS_RGB;
    jpeg_set_defaults(&k->c);
    jpeg_set_quality(&k->c, quality, TRUE);
    k->c.comp_info[0].h_samp_factor = k->c.comp_info[0].v_samp_factor = halved ? 2 : 1;
    jpeg_start_compress(&k->c, TRUE);
    for (int32_t y = 0; y < height; y++) {
        JSAMPROW row = rgb + (size_t)y * (size_t)width * 3;
        jpeg_write_scanlines(&k->c, &row, 1);
    }
    jpeg_finish_compress(&k->c);
}

static void decompress(codec *k, uint8_t *rgb, int32_t width)
{
    jpeg_create_decompress(&k->d);
    jpeg_mem_src(&k->d, k->bytes, k->size);
    jpeg_read_header(&k->d, TRUE);
    k->d.out_color_space = JCS_RGB;
    jpeg_start_decompress(&k->d);
    while (k->d.output_scanline < k->d.output_height) {
        JSAMPROW row = rgb + (size_t)k->d.output_scanline * (size_t)width * 3;
        jpeg_read_scanlines(&k->d, &row, 1);
    }
    jpeg_finish_decompress(&k->d);
}

tz_status tz_scene_jpeg(tz_ctx *ctx, uint8_t *rgb, int32_t width, int32_t height,
                        int quality, bool halved)
{
    codec *k;
    tz_status s = tz_alloc_zero(ctx, &k, 1, sizeof *k);
    if (s != TZ_OK)
        return s;
    k->c.err = k->d.err = jpeg_std_error(&k->err);
    k->err.error_exit = on_error;
    k->err.emit_message = on_message;
    if (setjmp(k->jump) == 0) {
        compress(k, rgb, width, height, quality, halved);
        decompress(k, rgb, width);
    } else {
        s = tz_fail(ctx, TZ_NOMEM, "JPEG of a scene: out of memory");
    }
    jpeg_destroy_compress(&k->c); /* both take what was only zeroed */
    jpeg_destroy_decompress(&k->d);
    free(k->bytes);
    tz_free(ctx, k);
    return s;
}
