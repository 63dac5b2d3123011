/* SPDX-License-Identifier: Apache-2.0 */
/* Bad input and bad luck, end to end: one clear line, exit 1, nothing lost, nothing
 * half-written. */
#include "tests/cli/shell.h"

#include <math.h>

static void write_file(const char *path, const char *text)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(text, 1, strlen(text), f), strlen(text));
    assert_int_equal(fclose(f), 0);
}

/* Nothing that begins with "o" stands in the folder, nor anybody's temporary file. */
static void assert_no_output(void)
{
    assert_exit(1, "ls -A | grep -E '^\\.?o\\.|tmp|\\.part'");
}

/* Expanding `photo` fails with one line that names it and says `why`. */
static void refused(const char *photo, const char *why)
{
    assert_exit(1, "$T expand '%s' -o o.png --size 64x64", photo);
    assert_one_line();
    assert_said(photo);
    assert_said(why);
    assert_no_output();
}

/* Expanding works and its warning, if any is wanted, says `warning`. */
static void accepted(const char *photo, const char *warning)
{
    assert_exit(0, "$T expand '%s' -o o.png --size 96x64 && test -s o.png && rm o.png",
                photo);
    if (*warning)
        assert_said(warning);
    else
        assert_string_equal(err_text, "");
}

/* ---- photos ---------------------------------------------------------------------------
 */

static void files_that_are_no_photos(void **state)
{
    (void)state;
    write_file("empty.png", "");
    write_file("text.png", "this is not a picture\n");
    assert_exit(0, "mkdir -p folder.png && head -c 30000 stones.png >cut.png");
    refused("missing.png", "check the name");
    refused("folder.png", "directory");
    refused("empty.png", "empty");
    refused("text.png", "not a");
    refused("cut.png", "truncated");
    assert_exit(0, "for e in jpg exr; do $T expand stones.png -o whole.$e -q; "
                   "head -c 20000 whole.$e >cut.$e; done; "
                   "cp stones.png wrong.jpg");
    refused("cut.jpg", "truncated");
    refused("cut.exr", "cut.exr");
    accepted("wrong.jpg", ""); /* a PNG by another name is a PNG */
}

static float grey(int32_t x, int32_t y, int32_t c)
{
    (void)x, (void)y, (void)c;
    return 0.5f;
}

static float transparent(int32_t x, int32_t y, int32_t c)
{
    return c == 3 ? 0 : (float)((x + y) % 7) / 7;
}

static float holes(int32_t x, int32_t y, int32_t c)
{
    return x % 13 == 5 && y % 11 == 3 ? 12345.5f : random_shade(x / 8, y / 8, c);
}

/* Writers never write what is not a number, so it is put into the file by hand. */
static void put_not_a_number(const char *path)
{
    static char data[1 << 20];
    const float mark = 12345.5f, bad[2] = {NAN, -INFINITY};
    FILE *f = fopen(path, "r+b");
    assert_non_null(f);
    size_t n = fread(data, 1, sizeof data, f), found = 0;
    for (size_t i = 0; i + 4 <= n; i++)
        if (memcmp(data + i, &mark, 4) == 0)
            memcpy(data + i, &bad[found++ % 2], 4);
    assert_true(found > 10);
    rewind(f);
    assert_int_equal(fwrite(data, 1, n, f), n);
    assert_int_equal(fclose(f), 0);
}

static void odd_photos_still_expand(void **state)
{
    (void)state;
    const tz_encoding srgb = TZ_ENCODING_SRGB;
    picture("one.png", (tz_rect){0, 0, 1, 1}, 3, srgb, random_shade, TZ_SAMPLE_U8);
    picture("tiny.png", (tz_rect){0, 0, 3, 5}, 3, srgb, random_shade, TZ_SAMPLE_U8);
    picture("flat.png", (tz_rect){0, 0, 64, 64}, 1, srgb, grey, TZ_SAMPLE_U8);
    picture("noise.png", (tz_rect){0, 0, 96, 96}, 3, srgb, random_shade, TZ_SAMPLE_U8);
    picture("nan.exr", (tz_rect){0, 0, 96, 96}, 3, TZ_ENCODING_LINEAR, holes,
            TZ_SAMPLE_FLOAT);
    put_not_a_number("nan.exr");
    picture("clear.png", (tz_rect){0, 0, 32, 32}, 4, srgb, transparent, TZ_SAMPLE_U8);
    picture("many.exr", (tz_rect){0, 0, 32, 32}, 7, srgb, grey, TZ_SAMPLE_HALF);
    accepted("one.png", "1 x 1 pixels");
    accepted("tiny.png", "3 x 5 pixels");
    accepted("flat.png", "no edges");
    accepted("noise.png", "");
    accepted("nan.exr", "not a number");
    refused("clear.png", "transparent");
    refused("many.exr", "7 channels");
    assert_exit(0, "cp \"$DATA\"/palette.png \"$DATA\"/cmyk.jpg .");
    accepted("palette.png", "");
    accepted("cmyk.jpg", "");
}

static void sixteen_bits_stay(void **state)
{
    (void)state;
    tz_image im = {0};
    picture("deep.png", (tz_rect){0, 0, 64, 64}, 1, TZ_ENCODING_SRGB, random_shade,
            TZ_SAMPLE_U16);
    assert_exit(0, "$T expand deep.png -o deep_big.png --size 96x96");
    assert_int_equal(tz_image_read(NULL, "deep_big.png", NULL, &im), TZ_OK);
    assert_int_equal(im.depth, 16);
    assert_int_equal(im.channels, 1);
    tz_image_deinit(&im);
}

static void long_strips_expand(void **state)
{
    (void)state;
    picture("strip.png", (tz_rect){0, 0, 50000, 12}, 3, TZ_ENCODING_SRGB, random_shade,
            TZ_SAMPLE_U8);
    assert_exit(0, "$T expand strip.png -o strip_big.png --grow 2 --json");
    assert_non_null(strstr(out_text, "100000"));
    assert_exit(1, "$T expand strip.png -o o.png --grow 30");
    assert_said("--size");
    assert_no_output();
}

/* ---- options --------------------------------------------------------------------------
 */

static void sizes_and_crops(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "--size 0x64",    "--size 64x0",         "--size -64x64",
        "--size 64",      "--size 2147483648x4", "--size 9999999999999999999x4",
        "--size axb",     "--crop 0,0,65,1",     "--crop -1,0,5,5",
        "--crop 0,0,0,5", "--crop 1,2,3",        "--memory 1K",
        "--threads -1",   "--seed -1",           "--seed 1.5",
        "--depth 12",     "--scale 0,0",         "--edges none",
        "--tile=perhaps",
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_exit(1, "$T expand stones.png -o o.png --size 64x64 %s", bad[i]);
        assert_one_line();
    }
    assert_no_output();
}

static void too_little_memory(void **state)
{
    (void)state;
    assert_exit(1, "$T expand strip.png -o o.png --memory 16M --grow 1");
    assert_one_line();
    assert_no_output();
}

static void maps_of_another_size(void **state)
{
    (void)state;
    picture("small.exr", (tz_rect){0, 0, 100, 90}, 3, TZ_ENCODING_DATA, grey,
            TZ_SAMPLE_HALF);
    assert_exit(1, "$T expand stones.png -o o.png --maps normal=small.exr");
    assert_one_line();
    assert_said("100 x 90");
    assert_said("256 x 256");
    assert_exit(1, "$T expand stones.png -o o.png --maps normal=missing.exr");
    assert_said("missing.exr");
    assert_exit(1, "$T expand stones.png mud.png -o o.png --maps height=stones.png");
    assert_said("once a photo");
    assert_exit(1, "$T expand stones.png -o o.png --maps wibble");
    assert_said("NAME=FILE");
    assert_no_output();
}

/* ---- outputs --------------------------------------------------------------------------
 */

static void outputs_that_cannot_be(void **state)
{
    (void)state;
    static const char *const bad[][2] = {
        {"-o folder.png", "is a folder"},
        {"-o nowhere/o.png", "folder nowhere/"},
        {"-o stones.png/o.png", "stones.png"},
        {"-o o.bmp", "'.bmp'"},
        {"-o o", "no extension"},
        {"-o o.png --format exr", "make them agree"},
        {"-o o.png --save-layout o.png", "written twice"},
        {"-o o.png --save-layout ./folder.png/../o.png", "written twice"},
        {"-o o.png --maps height=bricks.png --map-output bricks.png", "is also an input"},
    };
    assert_exit(0, "sha256sum stones.png bricks.png >sums");
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_exit(1, "$T expand stones.png --size 64x64 %s", bad[i][0]);
        assert_one_line();
        assert_said(bad[i][1]);
        assert_no_output();
    }
    assert_exit(1, "$T expand stones.png -o ./folder.png/../stones.png");
    assert_said("is also an input");
    assert_exit(0, "ln -sf stones.png link.png");
    assert_exit(1, "$T expand stones.png -o link.png");
    assert_said("is also an input");
    assert_exit(1, "$T analyze stones.png -o o.png");
    assert_said(".svg");
    assert_exit(0, "sha256sum -c --status sums");
}

static void full_disks_and_closed_pipes(void **state)
{
    (void)state;
    static const char *const ext[] = {"png", "exr", "tif", "jpg", "svg"};
    for (size_t i = 0; i < 5; i++) {
        assert_exit(0, "echo before >o.%s", ext[i]);
        if (i < 4)
            assert_exit(1, "(ulimit -f 20; $T expand stones.png -o o.%s --grow 3)",
                        ext[i]);
        else
            assert_exit(1, "(ulimit -f 20; $T analyze stones.png -o o.svg)");
        assert_one_line();
        assert_said(ext[i]);
        /* what stood there before still does */
        assert_exit(0, "test \"$(cat o.%s)\" = before && rm o.%s", ext[i], ext[i]);
        assert_no_output();
    }
    assert_exit(1, "$T expand stones.png -o - --format png >/dev/full");
    assert_one_line();
    assert_exit(1, "$T params >/dev/full");
    assert_exit(0, "($T expand stones.png -o - --format png; echo $? >rc) | head -c 9 "
                   ">/dev/null; test $(cat rc) = 1");
}

static void folders_without_permission(void **state)
{
    (void)state;
    if (geteuid() == 0)
        skip(); /* root may write everywhere */
    assert_exit(0, "mkdir -p locked && chmod 555 locked");
    assert_exit(1, "$T expand stones.png -o locked/o.png");
    assert_one_line();
    assert_said("locked/");
}

static void interrupts_leave_nothing(void **state)
{
    (void)state;
    static const char *const name[] = {"INT", "TERM"};
    for (size_t i = 0; i < 2; i++) {
        assert_exit(130,
                    "timeout --preserve-status -s %s 0.7 $T expand stones.png -o o.exr "
                    "--size 20000x20000",
                    name[i]);
        assert_said("cancelled");
        assert_no_output();
    }
}

/* ---- documents ------------------------------------------------------------------------
 */

#define SVG                                                \
    "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink=" \
    "'http://www.w3.org/1999/xlink' "

static void hostile_documents(void **state)
{
    (void)state;
    static const char *const text[] = {
        "<?xml version='1.0'?><!DOCTYPE svg [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b "
        "'&a;&a;&a;&a;&a;&a;&a;&a;'>]>" SVG "width='9' height='9'><text>&b;</text></svg>",
        "<?xml version='1.0'?><!DOCTYPE svg [<!ENTITY x SYSTEM "
        "'file:///etc/passwd'>]>" SVG "width='9' height='9'><text>&x;</text></svg>",
        SVG "width='9' height='9'><g id='a'><use xlink:href='#b'/></g><g id='b'>"
            "<use xlink:href='#a'/></g><use xlink:href='#a'/></svg>",
        SVG "width='nan' height='9'></svg>",
        SVG "width='1e99' height='1e99'></svg>",
        SVG "width='-4' height='9'></svg>",
        SVG "width='9' height='9'><image xlink:href='http://example.com/x.png' width='9' "
            "height='9'/></svg>",
        SVG "width='9' height='9'>",
        "<html/>",
        "",
        "\x89PNG",
    };
    for (size_t i = 0; i < sizeof text / sizeof text[0]; i++) {
        write_file("evil.svg", text[i]);
        assert_exit(1, "timeout 20 $T render evil.svg -o o.png");
        assert_one_line();
        assert_said("evil.svg");
        assert_exit(1, "timeout 20 $T arrange evil.svg -o o.svg");
        assert_one_line();
        assert_exit(1, "timeout 20 $T replay evil.svg -o o.svg");
        assert_one_line();
        assert_no_output();
    }
}

static void broken_rules(void **state)
{
    (void)state;
    write_file("rules.json", "{\"regions\": [{\"structure\": \"exemplary\"}]}");
    assert_exit(1, "$T expand stones.png -o o.png --rules rules.json");
    assert_one_line();
    assert_said("rules.json");
    write_file("rules.json", "{");
    assert_exit(1, "$T arrange stones.png -o o.svg --rules rules.json");
    assert_one_line();
    assert_exit(1, "$T expand stones.png -o o.png --rules missing.json");
    assert_said("missing.json");
    assert_no_output();
}

static void photos_that_changed(void **state)
{
    (void)state;
    assert_exit(0, "cp stones.png moved.png && $T analyze moved.png -o moved.svg && "
                   "$T arrange moved.svg -o moved_l.svg --size 64x64 && "
                   "cp mud.png moved.png");
    assert_exit(0, "$T render moved_l.svg -o m.png");
    assert_said("has changed");
    assert_exit(0, "$T sheet mud.png -o moved.png --cell 64x64");
    assert_exit(1, "$T arrange moved.svg -o o.svg");
    assert_one_line();
    assert_said("256 x 256");
    assert_exit(0, "rm moved.png");
    assert_exit(1, "$T render moved_l.svg -o o.png");
    assert_said("moved.png");
    assert_no_output();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_that_are_no_photos),
        cmocka_unit_test(odd_photos_still_expand),
        cmocka_unit_test(sixteen_bits_stay),
        cmocka_unit_test(long_strips_expand),
        cmocka_unit_test(sizes_and_crops),
        cmocka_unit_test(too_little_memory),
        cmocka_unit_test(maps_of_another_size),
        cmocka_unit_test(outputs_that_cannot_be),
        cmocka_unit_test(full_disks_and_closed_pipes),
        cmocka_unit_test(folders_without_permission),
        cmocka_unit_test(interrupts_leave_nothing),
        cmocka_unit_test(hostile_documents),
        cmocka_unit_test(broken_rules),
        cmocka_unit_test(photos_that_changed),
    };
    return cmocka_run_group_tests(tests, enter_scratch, leave_scratch);
}
