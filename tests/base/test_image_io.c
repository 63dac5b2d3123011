/* SPDX-License-Identifier: Apache-2.0 */
/* Image files: every format and depth there and back, the same bytes at any thread count,
 * streaming, and what goes wrong. */
#include "tests/base/check.h"

#include <math.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "base/file.h"
#include "base/image_io.h"
#include "base/rng.h"

static char dir[64];

static int set_up(void **state)
{
    (void)state;
    begin_dir(dir);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    end_dir(dir);
    return 0;
}

static const char *in_dir(const char *name)
{
    static char path[4][200];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", dir, name);
    return path[turn];
}

/* Smooth in part, noisy in part; values are multiples of 1/255 in sRGB where `codes`. */
static tz_image picture(tz_ctx *ctx, int w, int h, int channels, int levels)
{
    tz_image im;
    tz_rng r = tz_rng_make(9, (uint64_t)channels);
    ok(ctx, tz_image_init(ctx, &im, w, h, channels));
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            for (int c = 0; c < channels; c++) {
                double v =
                    x < w / 2 ? (x + 3 * y + 40 * c) % levels : tz_rng_below(&r, levels);
                if (c == im.alpha && v == 0)
                    v = levels - 1;
                tz_image_at(&im, x, y)[c] = (float)(v / (levels - 1));
            }
    im.encoding = TZ_ENCODING_SRGB;
    return im;
}

static tz_image_write_options usual(void)
{
    return (tz_image_write_options){.compression = -1};
}

typedef struct trip {
    const char *name;
    tz_sample_type type;
    int channels, levels, depth;
    double eps; /* in the encoding that is compared */
    bool linear;
} trip;

static void compare(const tz_image *a, const tz_image *b, double eps)
{
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_int_equal(a->channels, b->channels);
    double worst = 0;
    for (int y = 0; y < a->height; y++)
        for (int i = 0; i < a->width * a->channels; i++)
            worst = fmax(worst, fabs((double)tz_image_at(a, 0, y)[i] -
                                     (double)tz_image_at(b, 0, y)[i]));
    if (worst > eps)
        fail_msg("largest difference %g, allowed %g", worst, eps);
}

static void round_trips(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    static const trip trips[] = {
        {"a.png", TZ_SAMPLE_AUTO, 1, 256, 8, 1e-6, false},
        {"a.png", TZ_SAMPLE_U8, 2, 256, 8, 1e-6, false},
        {"a.png", TZ_SAMPLE_U8, 3, 256, 8, 1e-6, false},
        {"a.png", TZ_SAMPLE_U8, 4, 256, 8, 1e-6, false},
        {"a.png", TZ_SAMPLE_U16, 1, 65536, 16, 1e-6, false},
        {"a.PNG", TZ_SAMPLE_U16, 3, 65536, 16, 1e-6, false},
        {"a.png", TZ_SAMPLE_U16, 4, 65536, 16, 1e-6, false},
        {"a.exr", TZ_SAMPLE_AUTO, 3, 256, 17, 5e-4, true},
        {"a.exr", TZ_SAMPLE_HALF, 4, 256, 17, 2e-3, true},
        {"a.exr", TZ_SAMPLE_FLOAT, 1, 256, 32, 0, true},
        {"a.exr", TZ_SAMPLE_FLOAT, 7, 256, 32, 0, true},
        {"a.exr", TZ_SAMPLE_FLOAT, 4, 256, 32, 1e-6, true},
        {"a.tif", TZ_SAMPLE_AUTO, 3, 256, 8, 1e-6, false},
        {"a.tif", TZ_SAMPLE_U8, 4, 256, 8, 1e-6, false},
        {"a.tiff", TZ_SAMPLE_U16, 1, 65536, 16, 1e-6, false},
        {"a.tif", TZ_SAMPLE_FLOAT, 3, 256, 32, 0, true},
        {"a.hdr", TZ_SAMPLE_AUTO, 3, 256, 32, 8e-3, true},
        {"a.webp", TZ_SAMPLE_AUTO, 3, 2, 8, 2, false},
        {"a.jpg", TZ_SAMPLE_AUTO, 1, 2, 8, 2, false},
        {"a.jpeg", TZ_SAMPLE_AUTO, 3, 2, 8, 2, false},
    };
    for (size_t i = 0; i < sizeof trips / sizeof *trips; i++) {
        const trip *t = &trips[i];
        tz_image im = picture(ctx, 301, 277, t->channels, t->levels), back;
        tz_image_write_options opt = usual();
        tz_image_read_options ropt = {.want = t->linear ? TZ_ENCODING_LINEAR
                                                        : TZ_ENCODING_SRGB};
        opt.type = t->type;
        if (t->linear)
            ok(ctx, tz_image_convert(ctx, &im, TZ_ENCODING_LINEAR));
        ok(ctx, tz_image_set_meta(&im, "terrazzo:recipe",
                                  "{\"seed\": 7, \"\xc3\xa4\": \"<\"}"));
        ok(ctx, tz_image_write(ctx, in_dir(t->name), &im, &opt));
        ok(ctx, tz_image_read(ctx, in_dir(t->name), &ropt, &back));
        assert_int_equal(back.depth, t->depth);
        assert_int_equal(back.alpha, im.alpha);
        assert_int_equal(back.encoding, ropt.want);
        compare(&im, &back, t->eps);
        const char *recipe = tz_image_meta(&back, "terrazzo:recipe");
        if (strcmp(t->name, "a.hdr") != 0 && strcmp(t->name, "a.webp") != 0) {
            if (!recipe)
                fail_msg("%s lost its metadata", t->name);
            assert_string_equal(recipe, "{\"seed\": 7, \"\xc3\xa4\": \"<\"}");
        }
        tz_image_deinit(&back);
        tz_image_deinit(&im);
        remove(in_dir(t->name));
    }
    assert_int_equal(dir_count(dir), 0);
    end_ctx(ctx);
}

/* Lossy formats: close on a smooth picture. */
static void lossy(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    static const char *const names[] = {"s.jpg", "s.webp"};
    for (int k = 0; k < 2; k++) {
        tz_image im, back;
        ok(ctx, tz_image_init(ctx, &im, 64, 48, 3));
        for (int y = 0; y < 48; y++)
            for (int x = 0; x < 64; x++)
                for (int c = 0; c < 3; c++)
                    tz_image_at(&im, x, y)[c] = (float)(x + y + 20 * c) / 160;
        im.encoding = TZ_ENCODING_SRGB;
        ok(ctx, tz_image_write(ctx, in_dir(names[k]), &im, NULL));
        tz_image_read_options opt = {.want = TZ_ENCODING_SRGB};
        ok(ctx, tz_image_read(ctx, in_dir(names[k]), &opt, &back));
        compare(&im, &back, 0.04);
        tz_image_deinit(&back);
        tz_image_deinit(&im);
        remove(in_dir(names[k]));
    }
    end_ctx(ctx);
}

/* All 256 codes survive linear light, at every compression. */
static void codes_survive_linear_light(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    for (int level = 0; level <= 9; level++) {
        tz_image im = picture(ctx, 256, 40, 3, 256), back;
        tz_image_write_options opt = usual();
        opt.compression = level;
        ok(ctx, tz_image_convert(ctx, &im, TZ_ENCODING_LINEAR));
        ok(ctx, tz_image_write(ctx, in_dir("l.png"), &im, &opt));
        ok(ctx, tz_image_read(ctx, in_dir("l.png"), NULL, &back));
        assert_int_equal(back.encoding, TZ_ENCODING_LINEAR);
        compare(&im, &back, 1e-6);
        tz_image_deinit(&back);
        ok(ctx, tz_image_write(ctx, in_dir("l.exr"), &im, &opt));
        ok(ctx, tz_image_read(ctx, in_dir("l.exr"), NULL, &back));
        compare(&im, &back, 5e-4);
        tz_image_deinit(&back);
        tz_image_deinit(&im);
    }
    remove(in_dir("l.png"));
    remove(in_dir("l.exr"));
    end_ctx(ctx);
}

static void data_stays_data(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    static const char *const names[] = {"d.png", "d.exr", "d.tif"};
    for (int k = 0; k < 3; k++) {
        tz_image im = picture(ctx, 50, 40, 4, 256), back;
        tz_image_write_options opt = usual();
        tz_image_read_options data = {.data = true};
        im.encoding = TZ_ENCODING_DATA;
        opt.type = k == 1 ? TZ_SAMPLE_FLOAT : TZ_SAMPLE_U8;
        ok(ctx, tz_image_write(ctx, in_dir(names[k]), &im, &opt));
        ok(ctx, tz_image_read(ctx, in_dir(names[k]), &data, &back));
        assert_int_equal(back.encoding, TZ_ENCODING_DATA);
        compare(&im, &back, 1e-6);
        tz_image_deinit(&back);
        tz_image_deinit(&im);
        remove(in_dir(names[k]));
    }
    end_ctx(ctx);
}

static void same_bytes_at_any_thread_count(void **state)
{
    (void)state;
    static const char *const names[] = {"t.png", "t.exr", "t.tif", "t.jpg", "t.hdr"};
    for (int k = 0; k < 5; k++) {
        char first[65] = "", hex[65];
        for (int threads = 1; threads <= 8; threads *= 2) {
            tz_ctx *ctx = new_ctx(threads);
            tz_image im = picture(ctx, 1000, 700, 3, 256);
            ok(ctx, tz_image_write(ctx, in_dir(names[k]), &im, NULL));
            tz_image_deinit(&im);
            ok(ctx, tz_file_sha256(ctx, in_dir(names[k]), hex));
            if (!first[0])
                strcpy(first, hex);
            assert_string_equal(first, hex);
            end_ctx(ctx);
        }
        remove(in_dir(names[k]));
    }
}

/* Rows in odd portions give the same file as in one go, wide and narrow. */
static void portions_do_not_matter(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    static const char *const names[] = {"p.png", "p.exr", "p.tif"};
    static const tz_sample_type types[] = {TZ_SAMPLE_U16, TZ_SAMPLE_HALF, TZ_SAMPLE_U8};
    for (int k = 0; k < 6; k++) {
        const char *name = in_dir(names[k % 3]);
        char one[65], many[65];
        tz_image im =
            k < 3 ? picture(ctx, 70, 3000, 3, 256) : picture(ctx, 5000, 31, 4, 256);
        tz_image_write_options opt = usual();
        tz_image_sink *sink;
        opt.type = types[k % 3];
        opt.tile = 64;
        ok(ctx, tz_image_write(ctx, name, &im, &opt));
        ok(ctx, tz_file_sha256(ctx, name, one));
        ok(ctx, tz_image_sink_open(ctx, name, im.width, im.height, &im, &opt, &sink));
        for (int y = 0, n = 1; y < im.height; y += n, n = n * 3 % 101 + 1) {
            if (n > im.height - y)
                n = im.height - y;
            tz_image part = tz_image_view(&im, (tz_rect){0, y, im.width, n});
            ok(ctx, tz_image_sink_rows(sink, &part));
        }
        ok(ctx, tz_image_sink_close(sink));
        ok(ctx, tz_file_sha256(ctx, name, many));
        assert_string_equal(one, many);
        tz_image_deinit(&im);
        remove(name);
    }
    end_ctx(ctx);
}

static void out_of_range_values(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    static const float v[] = {-1,  2,    1e9f,  INFINITY, -INFINITY,
                              NAN, 0.5f, 70000, 1e-7f,    65504};
    static const float half[] = {-1, 2,    65504, 65504,         -65504,
                                 0,  0.5f, 65504, 1.1920929e-7f, 65504};
    tz_image im, back;
    tz_image_write_options opt = usual();
    ok(ctx, tz_image_init(ctx, &im, 10, 1, 1));
    memcpy(im.px, v, sizeof v);
    ok(ctx, tz_image_write(ctx, in_dir("o.exr"), &im, &opt));
    ok(ctx, tz_image_read(ctx, in_dir("o.exr"), NULL, &back));
    for (int i = 0; i < 10; i++)
        assert_true(back.px[i] == half[i]);
    tz_image_deinit(&back);
    opt.type = TZ_SAMPLE_FLOAT;
    ok(ctx, tz_image_write(ctx, in_dir("o.exr"), &im, &opt));
    ok(ctx, tz_image_read(ctx, in_dir("o.exr"), NULL, &back));
    assert_true(back.px[2] == 1e9f && back.px[3] == 0 && back.px[5] == 0);
    tz_image_deinit(&back);
    ok(ctx, tz_image_write(ctx, in_dir("o.png"), &im, NULL));
    ok(ctx, tz_image_read(ctx, in_dir("o.png"), NULL, &back));
    assert_true(back.px[0] == 0 && back.px[1] == 1 && back.px[3] == 1 && back.px[5] == 0);
    tz_image_deinit(&back);
    tz_image_deinit(&im);
    remove(in_dir("o.exr"));
    remove(in_dir("o.png"));
    end_ctx(ctx);
}

static void one_pixel(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    static const char *const names[] = {"1.png", "1.exr",  "1.tif",
                                        "1.jpg", "1.webp", "1.hdr"};
    for (int k = 0; k < 6; k++) {
        tz_image im, back;
        ok(ctx, tz_image_init(ctx, &im, 1, 1, 3));
        ok(ctx, tz_image_write(ctx, in_dir(names[k]), &im, NULL));
        ok(ctx, tz_image_read(ctx, in_dir(names[k]), NULL, &back));
        assert_true(back.width == 1 && back.height == 1 && back.px[0] < 0.02f);
        tz_image_deinit(&back);
        tz_image_deinit(&im);
        remove(in_dir(names[k]));
    }
    end_ctx(ctx);
}

/* ---- bad input ----------------------------------------------------------------------
 */

static void put(const char *path, const void *data, size_t n)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(data, 1, n, f), n);
    fclose(f);
}

static void not_images(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image im;
    fails(ctx, tz_image_read(ctx, in_dir("none.png"), NULL, &im), TZ_IO, "No such file");
    fails(ctx, tz_image_read(ctx, dir, NULL, &im), TZ_IO, "directory");
    put(in_dir("e.png"), "", 0);
    fails(ctx, tz_image_read(ctx, in_dir("e.png"), NULL, &im), TZ_FORMAT, "empty");
    put(in_dir("e.png"), "This is no picture.\nIndeed.\n", 28);
    fails(ctx, tz_image_read(ctx, in_dir("e.png"), NULL, &im), TZ_FORMAT, "e.png");
    put(in_dir("e.png"), "\x89PNG\r\n\x1a\n", 8);
    fails(ctx, tz_image_read(ctx, in_dir("e.png"), NULL, &im), TZ_FORMAT, "too soon");
    put(in_dir("e.png"), "\xff\xd8\xff\xe0", 4);
    fails(ctx, tz_image_read(ctx, in_dir("e.png"), NULL, &im), TZ_FORMAT, "JPEG");
    put(in_dir("e.png"), "\x76\x2f\x31\x01", 4);
    fails(ctx, tz_image_read(ctx, in_dir("e.png"), NULL, &im), TZ_FORMAT, "EXR");
    remove(in_dir("e.png"));
    assert_null(im.px);
    end_ctx(ctx);
}

/* Cut anywhere, a file must be refused; flipped bits must not crash. */
static void cut_and_damaged(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    static const char *const names[] = {"c.png", "c.jpg", "c.exr",
                                        "c.tif", "c.hdr", "c.webp"};
    for (int k = 0; k < 6; k++) {
        tz_image im = picture(ctx, 120, 90, 3, 256), back;
        char *data;
        size_t n;
        const char *name = in_dir(names[k]);
        ok(ctx, tz_image_write(ctx, name, &im, NULL));
        ok(ctx, tz_file_read(ctx, name, 1 << 24, &data, &n));
        for (int part = 1; part < 20; part++) {
            put(name, data, n * (size_t)part / 20);
            tz_status s = tz_image_read(ctx, name, NULL, &back);
            if (s == TZ_OK)
                fail_msg("%s cut to %d/20 was read", names[k], part);
            fails(ctx, s, TZ_FORMAT, names[k]);
        }
        if (k < 3) { /* the last byte alone */
            put(name, data, n - 1);
            fails(ctx, tz_image_read(ctx, name, NULL, &back), TZ_FORMAT, names[k]);
        }
        tz_rng r = tz_rng_make(1, (uint64_t)k);
        for (int i = 0; i < 100; i++) {
            int32_t at = tz_rng_below(&r, i % 2 ? (int32_t)n : 200);
            char old = data[at];
            data[at] ^= (char)(1 << tz_rng_below(&r, 8));
            put(name, data, n);
            if (tz_image_read(ctx, name, NULL, &back) == TZ_OK)
                tz_image_deinit(&back);
            tz_ctx_clear(ctx);
            data[at] = old;
        }
        tz_free(ctx, data);
        tz_image_deinit(&im);
        remove(name);
        assert_int_equal(tz_ctx_memory_used(ctx), 0);
    }
    end_ctx(ctx);
}

static void too_large(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    static const char *const names[] = {"h.png", "h.jpg", "h.exr", "h.tif"};
    for (int k = 0; k < 4; k++) {
        tz_image im = picture(ctx, 40, 30, 3, 256), back;
        tz_image_read_options opt = {.max_pixels = 40 * 30 - 1};
        ok(ctx, tz_image_write(ctx, in_dir(names[k]), &im, NULL));
        fails(ctx, tz_image_read(ctx, in_dir(names[k]), &opt, &back), TZ_LIMIT,
              "40 x 30");
        opt.max_pixels++;
        ok(ctx, tz_image_read(ctx, in_dir(names[k]), &opt, &back));
        tz_image_deinit(&back);
        tz_image_deinit(&im);
        remove(in_dir(names[k]));
    }
    /* a header that claims 2^31-1 x 2^31-1 */
    static const uint8_t bomb[] = {0x89, 'P',  'N',  'G',  '\r', '\n', 0x1a, '\n', 0,
                                   0,    0,    13,   'I',  'H',  'D',  'R',  0x7f, 0xff,
                                   0xff, 0xff, 0x7f, 0xff, 0xff, 0xff, 8,    2,    0,
                                   0,    0,    0,    0,    0,    0};
    tz_image im;
    put(in_dir("bomb.png"), bomb, sizeof bomb);
    tz_status s = tz_image_read(ctx, in_dir("bomb.png"), NULL, &im);
    assert_true(s == TZ_LIMIT || s == TZ_FORMAT);
    tz_ctx_clear(ctx);
    remove(in_dir("bomb.png"));
    end_ctx(ctx);
}

static void wrong_requests(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image im = picture(ctx, 8, 8, 5, 256), rgb = picture(ctx, 8, 8, 3, 256);
    tz_image_write_options opt = usual();
    fails(ctx, tz_image_write(ctx, in_dir("x.png"), &im, NULL), TZ_UNSUPPORTED,
          "5 channels");
    fails(ctx, tz_image_write(ctx, in_dir("x.gif"), &rgb, NULL), TZ_UNSUPPORTED, "gif");
    fails(ctx, tz_image_write(ctx, in_dir("x"), &rgb, NULL), TZ_UNSUPPORTED, "which");
    fails(ctx, tz_image_write(ctx, "-", &rgb, NULL), TZ_UNSUPPORTED, "which");
    fails(ctx, tz_image_write(ctx, in_dir("no/x.png"), &rgb, NULL), TZ_IO, "no/x.png");
    opt.type = TZ_SAMPLE_HALF;
    fails(ctx, tz_image_write(ctx, in_dir("x.png"), &rgb, &opt), TZ_UNSUPPORTED, "half");
    opt = usual();
    opt.compression = 10;
    fails(ctx, tz_image_write(ctx, in_dir("x.png"), &rgb, &opt), TZ_INVALID,
          "compression");
    opt = usual();
    opt.tile = 17;
    fails(ctx, tz_image_write(ctx, in_dir("x.exr"), &rgb, &opt), TZ_INVALID, "tiles");
    tz_image_sink *sink;
    fails(ctx, tz_image_sink_open(ctx, in_dir("x.png"), 0, 5, &rgb, NULL, &sink),
          TZ_INVALID, "0 x 5");
    fails(ctx,
          tz_image_sink_open(ctx, in_dir("x.jpg"), 100000, 100000, &rgb, NULL, &sink),
          TZ_UNSUPPORTED, "");
    fails(ctx,
          tz_image_sink_open(ctx, in_dir("x.webp"), 100000, 100000, &rgb, NULL, &sink),
          TZ_LIMIT, "webp");
    /* too few rows, too many, wrong width */
    ok(ctx, tz_image_sink_open(ctx, in_dir("x.png"), 8, 10, &rgb, NULL, &sink));
    ok(ctx, tz_image_sink_rows(sink, &rgb));
    fails(ctx, tz_image_sink_close(sink), TZ_INVALID, "8 of 10");
    ok(ctx, tz_image_sink_open(ctx, in_dir("x.png"), 8, 10, &rgb, NULL, &sink));
    ok(ctx, tz_image_sink_rows(sink, &rgb));
    fails(ctx, tz_image_sink_rows(sink, &rgb), TZ_INVALID, "do not fit");
    assert_int_equal(tz_image_sink_close(sink), TZ_INVALID);
    tz_ctx_clear(ctx);
    ok(ctx, tz_image_sink_open(ctx, in_dir("x.exr"), 8, 10, &rgb, NULL, &sink));
    tz_image_sink_abort(sink);
    tz_image_sink_abort(NULL);
    memcpy(rgb.names[1], "R", 2);
    fails(ctx, tz_image_write(ctx, in_dir("x.exr"), &rgb, NULL), TZ_INVALID,
          "two channels");
    tz_image_deinit(&im);
    tz_image_deinit(&rgb);
    assert_int_equal(dir_count(dir), 0);
    end_ctx(ctx);
}

static void full_device(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    static const char *const formats[] = {"png", "exr", "jpg", "tif"};
    for (int k = 0; k < 4; k++) {
        tz_image im = picture(ctx, 500, 400, 3, 256);
        tz_image_write_options opt = usual();
        opt.format = formats[k];
        fails(ctx, tz_image_write(ctx, "/dev/full", &im, &opt), TZ_IO, "/dev/full");
        tz_image_deinit(&im);
    }
    end_ctx(ctx);
}

/* A file system of 64 KiB, where the system lets us mount one. */
static void full_disk(void **state)
{
    (void)state;
    if (geteuid() != 0 || mount("none", dir, "tmpfs", 0, "size=64k") != 0)
        skip();
    tz_ctx *ctx = new_ctx(2);
    static const char *const names[] = {"f.png", "f.exr", "f.jpg", "f.tif"};
    int left = 0;
    tz_status status[4];
    for (int k = 0; k < 4; k++) {
        tz_image im = picture(ctx, 500, 400, 3, 256);
        status[k] = tz_image_write(ctx, in_dir(names[k]), &im, NULL);
        tz_ctx_clear(ctx);
        left += dir_count(dir);
        tz_image_deinit(&im);
    }
    umount(dir);
    for (int k = 0; k < 4; k++)
        assert_int_equal(status[k], TZ_IO);
    assert_int_equal(left, 0);
    end_ctx(ctx);
}

static void cancelled(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(2);
    static const char *const names[] = {"k.png", "k.exr", "k.tif", "k.jpg"};
    for (int k = 0; k < 4; k++) {
        tz_image im = picture(ctx, 300, 200, 3, 256), back;
        tz_image_sink *sink;
        ok(ctx, tz_image_sink_open(ctx, in_dir(names[k]), 300, 400, &im, NULL, &sink));
        ok(ctx, tz_image_sink_rows(sink, &im));
        tz_ctx_cancel(ctx);
        assert_int_equal(tz_image_sink_rows(sink, &im), TZ_CANCELLED);
        assert_int_equal(tz_image_sink_close(sink), TZ_CANCELLED);
        assert_int_equal(dir_count(dir), 0);
        tz_ctx_clear(ctx);
        ok(ctx, tz_image_write(ctx, in_dir(names[k]), &im, NULL));
        tz_ctx_cancel(ctx);
        assert_int_equal(tz_image_read(ctx, in_dir(names[k]), NULL, &back), TZ_CANCELLED);
        tz_ctx_clear(ctx);
        remove(in_dir(names[k]));
        tz_image_deinit(&im);
    }
    end_ctx(ctx);
}

/* ---- memory failures ------------------------------------------------------------------
 */

static const char *survivor;

static tz_status write_and_read(tz_ctx *ctx)
{
    tz_image im, back;
    tz_status s = tz_image_init(ctx, &im, 40, 30, 4);
    if (s != TZ_OK)
        return s;
    s = tz_image_set_meta(&im, "Title", "t");
    if (s == TZ_OK)
        s = tz_image_write(ctx, in_dir(survivor), &im, NULL);
    if (s == TZ_OK)
        s = tz_image_read(ctx, in_dir(survivor), NULL, &back);
    if (s == TZ_OK)
        tz_image_deinit(&back);
    tz_image_deinit(&im);
    return s;
}

static void failures_leave_nothing(void **state)
{
    (void)state;
    static const char *const names[] = {"m.png", "m.exr", "m.jpg", "m.tif"};
    for (int k = 0; k < 4; k++) {
        survivor = names[k];
        survive(write_and_read, 1);
        survive(write_and_read, 3);
        remove(in_dir(survivor));
        assert_int_equal(dir_count(dir), 0);
    }
}

/* ---- pipes ----------------------------------------------------------------------------
 */

static void standard_output_and_input(void **state)
{
    (void)state;
    static const char *const formats[] = {"png", "exr", "jpg", "tif"};
    for (int k = 0; k < 4; k++) {
        const char *name = in_dir("pipe");
        pid_t child = fork();
        if (child == 0) { /* writes to a pipe, reads from a file as standard input */
            tz_ctx *ctx = new_ctx(2);
            tz_image im = picture(ctx, 64, 64, 3, 256), back;
            tz_image_write_options opt = usual();
            opt.format = formats[k];
            int bad = !freopen(name, "wb", stdout);
            bad |= tz_image_write(ctx, "-", &im, &opt) != TZ_OK;
            fflush(stdout);
            bad |= !freopen(name, "rb", stdin);
            bad |= tz_image_read(ctx, "-", NULL, &back) != TZ_OK;
            bad |= back.width != 64;
            if (bad)
                fprintf(stderr, "%s\n", tz_ctx_message(ctx));
            _exit(bad);
        }
        int rc;
        waitpid(child, &rc, 0);
        assert_int_equal(rc, 0);
        remove(name);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(round_trips),
        cmocka_unit_test(lossy),
        cmocka_unit_test(codes_survive_linear_light),
        cmocka_unit_test(data_stays_data),
        cmocka_unit_test(same_bytes_at_any_thread_count),
        cmocka_unit_test(portions_do_not_matter),
        cmocka_unit_test(out_of_range_values),
        cmocka_unit_test(one_pixel),
        cmocka_unit_test(not_images),
        cmocka_unit_test(cut_and_damaged),
        cmocka_unit_test(too_large),
        cmocka_unit_test(wrong_requests),
        cmocka_unit_test(full_device),
        cmocka_unit_test(full_disk),
        cmocka_unit_test(cancelled),
        cmocka_unit_test(failures_leave_nothing),
        cmocka_unit_test(standard_output_and_input),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
