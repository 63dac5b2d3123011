/* SPDX-License-Identifier: Apache-2.0 */
/* The command from photo or drawing to pixels by way of curves: expand, render, replay. */
#include "tests/cli/shell.h"

/* Stones of one tone each, joints between them. */
static void draw_wall(const char *path)
{
    tz_ctx *ctx = NULL;
    tz_image im;
    assert_int_equal(tz_ctx_new(NULL, &ctx), TZ_OK);
    assert_int_equal(tz_image_init(ctx, &im, 224, 176, 3), TZ_OK);
    im.encoding = TZ_ENCODING_SRGB;
    for (int32_t y = 0; y < im.height; y++)
        for (int32_t x = 0; x < im.width; x++) {
            const int32_t row = y / 22, u = x + (row % 2) * 20, stone = u / 40 + 7 * row;
            const bool joint = y % 22 < 4 || u % 40 < 4;
            tz_rng rng = tz_rng_make(1, (uint64_t)(y * im.width + x));
            for (int32_t c = 0; c < 3; c++)
                tz_image_at(&im, x, y)[c] =
                    (joint ? 0.15F : 0.5F + 0.04F * (float)((stone * 5 + c) % 7)) +
                    0.03F * (float)tz_rng_unit(&rng);
        }
    assert_int_equal(tz_image_write(ctx, path, &im, NULL), TZ_OK);
    tz_image_deinit(&im);
    tz_ctx_free(ctx);
}

static int setup(void **state)
{
    if (enter_scratch(state) != 0)
        return -1;
    draw_wall("wall.png");
    FILE *f = fopen("waves.svg", "w");
    if (!f)
        return -1;
    fputs("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 120 90'><g fill='none' "
          "stroke='#234' stroke-width='2'>",
          f);
    for (int i = 0; i < 9; i++)
        fprintf(f, "<path d='M0 %d C40 %d 80 %d 120 %d'/>", 5 + 10 * i, 1 + 10 * i,
                9 + 10 * i, 5 + 10 * i);
    fputs("</g></svg>", f);
    fclose(f);
    return 0;
}

#define WALL                                                                 \
    "$T expand wall.png --as curves --curve-method quilt --size 320x256 -q " \
    "--seed 3 "

static void a_photo_becomes_a_texture_of_its_lines(void **state)
{
    (void)state;
    assert_exit(0, WALL "-o a.png --save-layout a.svg --save-exemplar e.svg");
    assert_true(exists("a.png") && exists("a.svg") && exists("e.svg"));
    assert_exit(0, WALL "-o b.png --threads 1");
    assert_exit(0, "$T replay a.png -q -o c.png && cmp a.png c.png");
    assert_exit(0, "$T expand wall.png --as curves --curve-method quilt --grow 1.1 -q "
                   "--seeds 3,8 -o v_{seed}.png --save-layout v_{seed}.svg");
    assert_exit(0, "$T replay v_8.png -o w.png -q && cmp v_8.png w.png");
    /* the plate goes beside the document and is named after it */
    assert_exit(0, "$T replay v_3.svg -o w.svg -q && "
                   "sed 's/w[.]plate/v_%%7Bseed%%7D.plate/' w.svg | cmp - v_3.svg");
    assert_exit(1, "cmp -s v_3.png v_8.png");
    /* the layout's pixels, whole and in part, and maps of them */
    assert_exit(0, "$T render a.svg -q -o d.png --maps "
                   "id=id.exr,distance=far.exr,along=along.exr,rough=wall.png "
                   "--map-output m_{map}.png");
    assert_true(exists("id.exr") && exists("far.exr") && exists("along.exr") &&
                exists("m_rough.png"));
    assert_exit(0, "$T render a.svg -q -o part.png --crop 100,60,50,40");
    tz_ctx *ctx = NULL;
    tz_image whole = {0}, part = {0}, first = {0}, one = {0};
    assert_int_equal(tz_ctx_new(NULL, &ctx), TZ_OK);
    assert_int_equal(tz_image_read(ctx, "d.png", NULL, &whole), TZ_OK);
    assert_int_equal(tz_image_read(ctx, "part.png", NULL, &part), TZ_OK);
    assert_int_equal(tz_image_read(ctx, "a.png", NULL, &first), TZ_OK);
    assert_int_equal(tz_image_read(ctx, "b.png", NULL, &one), TZ_OK);
    assert_int_equal(whole.width, 320);
    assert_int_equal(whole.height, 256);
    double most = 0, threads = 0;
    for (int32_t y = 0; y < 256; y++)
        for (int32_t x = 0; x < 320 * whole.channels; x++) {
            const int64_t at = y * whole.stride + x;
            most = fmax(most, fabs((double)whole.px[at] - (double)first.px[at]));
            threads = fmax(threads, fabs((double)one.px[at] - (double)first.px[at]));
        }
    assert_true(threads == 0);
    assert_true(most < 0.05); /* the plate has gone through 8 bits */
    for (int32_t y = 0; y < 40; y++)
        for (int32_t x = 0; x < 50; x++)
            for (int32_t c = 0; c < 3; c++)
                assert_true(tz_image_at(&part, x, y)[c] ==
                            tz_image_at(&whole, 100 + x, 60 + y)[c]);
    tz_image_deinit(&whole);
    tz_image_deinit(&part);
    tz_image_deinit(&first);
    tz_image_deinit(&one);
    tz_ctx_free(ctx);
}

static void an_exemplar_goes_on_where_the_photo_would(void **state)
{
    (void)state;
    assert_exit(0, "$T analyze wall.png --as curves -q -o wall.svg");
    assert_exit(0, "$T expand wall.svg --curve-method quilt --size 320x256 --seed 3 -q "
                   "-o f.png");
    assert_exit(0, "$T render wall.svg -q -o same.png");
    assert_true(exists("f.png"));
}

static void drawings_become_strokes(void **state)
{
    (void)state;
    assert_exit(0, "$T expand waves.svg --as curves --size 200x150 -q -o w.png "
                   "--save-layout w.svg --resolution 2 --curve-method quilt");
    assert_exit(0, "$T render w.svg -q -o w2.png --resolution 2");
    assert_exit(0, "$T render w.svg -q -o x.exr --crop 3,4,50,60");
    assert_exit(1, "$T render w.svg -o x.png --maps rough=wall.png -q");
    assert_one_line();
    assert_said("there are id, distance and along");
    assert_exit(1, "$T render w.svg -o x.png --curve-source photo -q");
    assert_one_line();
    assert_said("which was not given");
    assert_exit(2, "$T expand waves.svg wall.png --as curves -o x.png -q");
    assert_false(exists("x.png"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_photo_becomes_a_texture_of_its_lines),
        cmocka_unit_test(an_exemplar_goes_on_where_the_photo_would),
        cmocka_unit_test(drawings_become_strokes),
    };
    return cmocka_run_group_tests(tests, setup, leave_scratch);
}
