/* SPDX-License-Identifier: Apache-2.0 */
/* The exemplar document: round trips to the bit, and hostile documents. */
#include "tests/analysis/draw.h"

#include "analysis/outline.h"
#include "base/file.h"
#include "base/image_io.h"

static char folder[] = "/tmp/tz-test-ebpt-XXXXXX";

static const char *file(const char *name)
{
    static char path[4][256];
    static int next;
    char *p = path[next++ % 4];
    snprintf(p, sizeof path[0], "%s/%s", folder, name);
    return p;
}

static const char sum[] =
    "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";

static void round_trip(tz_ctx *ctx, const tz_ebpt *e)
{
    tz_ebpt back;
    char *photo, sha256[65];
    ok(ctx, tz_ebpt_write(ctx, file("a.svg"), e, "my photo #1 50%.jpg", sum));
    ok(ctx, tz_ebpt_read(ctx, file("a.svg"), &back, &photo, sha256));
    check_same(e, &back);
    check_ebpt(&back);
    assert_string_equal(photo, file("my photo #1 50%.jpg"));
    assert_string_equal(sha256, sum);
    tz_free(ctx, photo);
    tz_ebpt_deinit(&back);
}

static void drawn_pictures(void **state)
{
    (void)state;
    static const int32_t size[][2] = {{1, 1}, {3, 5}, {300, 1}, {97, 61}, {256, 256}};
    tz_ebpt_params p = default_params();
    tz_ctx *ctx = new_ctx(2);
    for (int32_t k = 0; k < 5; k++) {
        for (int32_t kind = 0; kind < 3; kind++) {
            tz_image im = new_picture(ctx, size[k][0], size[k][1], 3);
            tz_ebpt e;
            p.binning = kind % 2;
            p.edge_threshold = 0.1 + 0.1 * kind;
            memset(p.model, 0, sizeof p.model);
            strcpy(p.model, kind == 2 ? "odd <\"&'> name\ttab.yml" : "");
            p.edges = TZ_EDGES_GRADIENT;
            if (kind == 1)
                draw_noise(&im, (uint64_t)k);
            if (kind == 2)
                draw_pebbles(&im, 20, (uint64_t)k);
            ok(ctx, tz_ebpt_analyze(ctx, &im, &p, &e));
            round_trip(ctx, &e);
            tz_ebpt_deinit(&e);
            tz_image_deinit(&im);
        }
    }
    end_ctx(ctx);
}

static void photos(void **state)
{
    (void)state;
    static const char *const name[] = {"stone_wall.jpg", "bark_lichen.jpg",
                                       "brick_gray.png"};
    const tz_ebpt_params p = default_params();
    const tz_image_read_options o = {.want = TZ_ENCODING_SRGB};
    need_photos();
    tz_ctx *ctx = new_ctx(2);
    for (int32_t i = 0; i < 3; i++) {
        char path[1024];
        tz_image im;
        tz_ebpt e;
        snprintf(path, sizeof path, PHOTO("%s"), name[i]);
        ok(ctx, tz_image_read(ctx, path, &o, &im));
        ok(ctx, tz_ebpt_analyze(ctx, &im, &p, &e));
        round_trip(ctx, &e);
        tz_ebpt_deinit(&e);
        tz_image_deinit(&im);
    }
    end_ctx(ctx);
}

/* Regions with holes, islands in them, and pixels that touch at corners. */
static void outlines(void **state)
{
    (void)state;
    enum { W = 23, H = 17 };
    tz_ctx *ctx = new_ctx(1);
    for (uint64_t seed = 0; seed < 60; seed++) {
        tz_rng r = tz_rng_make(seed, 1);
        int32_t label[W * H], back[W * H];
        uint8_t seen[W * H] = {0};
        const int32_t kinds = 1 + (int32_t)(seed % 4);
        for (int32_t i = 0; i < W * H; i++)
            label[i] = tz_rng_below(&r, kinds), back[i] = -1;
        for (int32_t id = 0; id < kinds; id++) {
            tz_outline_text t = {0};
            tz_outline_sides sides = {0};
            tz_svg_path path = {0};
            const char *why = NULL;
            const tz_rect all = {0, 0, W, H};
            ok(ctx, tz_outline_trace(ctx, label, W, H, id, all, seen, &t));
            ok(ctx, tz_svg_path_parse(ctx, t.v ? t.v : "", &path));
            ok(ctx, tz_outline_read(ctx, &path, W, H, 2 * (W + 1) * H, &sides, &why));
            assert_true(tz_outline_fill(&sides, W, id, back));
            tz_array_free(ctx, &t);
            tz_array_free(ctx, &sides);
            tz_svg_path_deinit(ctx, &path);
        }
        assert_memory_equal(label, back, sizeof label);
    }
    end_ctx(ctx);
}

/* ---- hostile documents ----------------------------------------------------------- */

static char *sound; /* a document that reads */

static void make_sound(tz_ctx *ctx)
{
    const tz_ebpt_params p = default_params();
    tz_image im = new_picture(ctx, 48, 48, 3);
    size_t size;
    tz_ebpt e;
    char *text;
    draw_pebbles(&im, 24, 1);
    ok(ctx, tz_ebpt_analyze(ctx, &im, &p, &e));
    assert_true(e.edge.n >= 2 && e.group.n >= 2);
    ok(ctx, tz_ebpt_write(ctx, file("sound.svg"), &e, "p.png", sum));
    ok(ctx, tz_file_read(ctx, file("sound.svg"), 1 << 20, &text, &size));
    sound = strdup(text);
    tz_free(ctx, text);
    tz_ebpt_deinit(&e);
    tz_image_deinit(&im);
}

static tz_status read_text(tz_ctx *ctx, const char *text)
{
    tz_ebpt e;
    char *photo, sha256[65];
    FILE *f = fopen(file("bad.svg"), "w");
    fputs(text, f);
    fclose(f);
    tz_status s = tz_ebpt_read(ctx, file("bad.svg"), &e, &photo, sha256);
    if (s != TZ_OK) {
        assert_null(e.label);
        assert_null(photo);
    } else {
        check_ebpt(&e);
    }
    tz_ebpt_deinit(&e);
    tz_free(ctx, photo);
    return s;
}

/* The sound document with the first `from` (after `after`) replaced. */
static tz_status read_changed(tz_ctx *ctx, const char *after, const char *from,
                              const char *to)
{
    const char *start = strstr(sound, after);
    assert_non_null(start);
    const char *at = strstr(start, from);
    assert_non_null(at);
    char *text = malloc(strlen(sound) + strlen(to) + 1);
    sprintf(text, "%.*s%s%s", (int)(at - sound), sound, to, at + strlen(from));
    const tz_status s = read_text(ctx, text);
    free(text);
    return s;
}

static void hostile(void **state)
{
    (void)state;
    static const struct {
        const char *after, *from, *to, *part;
        tz_status status;
    } t[] = {
        {"<svg", "tz:pixels=\"48 48\"", "tz:pixels=\"48 nan\"", "tz:pixels", TZ_FORMAT},
        {"<svg", "tz:pixels=\"48 48\"", "tz:pixels=\"48 49\"", "cover", TZ_FORMAT},
        {"<svg", "tz:pixels=\"48 48\"", "tz:pixels=\"900000 900000\"", "pixels",
         TZ_LIMIT},
        {"<svg", "tz:pixels=\"48 48\"", "tz:pixels=\"0 48\"", "no pixels", TZ_FORMAT},
        {"<svg", "tz:pixels=\"48 48\"", "tz:pixels=\"30000 30000\"", "cover", TZ_FORMAT},
        {"<svg", "tz:groups=\"", "tz:groups=\"9", "missing", TZ_FORMAT},
        {"<svg", "tz:groups=\"", "tz:groups=\"-", "tz:groups", TZ_FORMAT},
        {"<svg", "tz:edges=\"", "tz:edges=\"99", "missing", TZ_FORMAT},
        {"<svg", "tz:param-polar-rings=\"12\"", "tz:param-polar-rings=\"0\"",
         "polar-rings", TZ_FORMAT},
        {"region-0", "tz:group=\"0\"", "tz:group=\"1\"", "line", TZ_FORMAT},
        {"region-0", "tz:group=\"0\"", "tz:group=\"2147483648\"", "tz:group", TZ_FORMAT},
        {"region-0", "tz:group=\"0\"", "", "region 0", TZ_FORMAT},
        {"region-0", " d=\"M0 0", " d=\"M0 0.5", "grid", TZ_FORMAT},
        {"region-0", " d=\"M0 0", " d=\"M-1 0", "grid", TZ_FORMAT},
        {"region-0", " d=\"M0 0", " d=\"M1e300 0", "grid", TZ_FORMAT},
        {"region-0", " d=\"M0 0", " d=\"M0 0c1 1 2 2 3 3", "curve", TZ_FORMAT},
        {"region-0", " d=\"M0 0", " d=\"M0 0L5 5M0 0", "slanted", TZ_FORMAT},
        {"region-0", " d=\"M0 0", " d=\"M0 0h1v1h-1zM0 0", "cover", TZ_FORMAT},
        {"region-0", " d=\"M0 0", " d=\"rubbish M0 0", "path data", TZ_FORMAT},
        {"region-0", " d=\"", " x=\"", "no outline", TZ_FORMAT},
        {"region-0", "tz:rank=\"", "tz:rank=\"77", "tz:rank", TZ_FORMAT},
        {"region-0", "tz:centre=\"", "tz:centre=\"inf ", "tz:centre", TZ_FORMAT},
        {"region-0", "tz:neighbours=\"", "tz:neighbours=\"500 ", "tz:neighbours",
         TZ_FORMAT},
        {"region-0", "tz:neighbours=\"", "tz:neighbours=\"1 1 ", "tz:neighbours",
         TZ_FORMAT},
        {"tz:cells", "tz:cells=\"", "tz:cells=\"400 0 1 1 ", "tz:cells", TZ_FORMAT},
        {"tz:cells", "tz:cells=\"", "tz:cells=\"7 ", "tz:cells", TZ_FORMAT},
        {"tz:cells", "tz:members=\"", "tz:members=\"0 0 0 ", "tz:", TZ_FORMAT},
        {"edge-0", "tz:code=\"", "tz:code=\"9", "tz:code", TZ_FORMAT},
        {"edge-0", "tz:code=\"",
         "tz:code=\"0000000000000000000000000000000000000000000000"
         "00000000",
         "leaves", TZ_FORMAT},
        {"edge-0", "tz:group-of=\"", "tz:group-of=\"8888", "tz:group-of", TZ_FORMAT},
        {"edge-0", "tz:start=\"", "tz:start=\"4", "tz:start", TZ_FORMAT},
        {"edge-0", "tz:width=\"", "tz:width=\"1 2 ", "tz:width", TZ_FORMAT},
        {"edge-0", "tz:strength=\"", "tz:strength=\"NaN", "tz:strength", TZ_FORMAT},
        {"<g id=\"regions\"", "<g", "<g transform=\"translate(1 0)\"", "moved",
         TZ_FORMAT},
        {"<image", "xlink:href=\"p.png\"", "xlink:href=\"http://x.example/p.png\"",
         "remote", TZ_FORMAT},
        {"<image", "xlink:href=\"p.png\"", "xlink:href=\"data:image/png;base64,AA\"",
         "embedded", TZ_FORMAT},
        {"<image", "xlink:href=\"p.png\"", "xlink:href=\"p%00.png\"", "%00", TZ_FORMAT},
        {"<image", "xlink:href=\"p.png\"", "", "reference", TZ_FORMAT},
    };
    tz_ctx *ctx = new_ctx(1);
    make_sound(ctx);
    ok(ctx, read_text(ctx, sound));
    for (size_t i = 0; i < sizeof t / sizeof *t; i++) {
        const tz_status s = read_changed(ctx, t[i].after, t[i].from, t[i].to);
        if (s != t[i].status || !strstr(tz_ctx_message(ctx), t[i].part))
            print_error("%s -> %s\n", t[i].from, t[i].to);
        fails(ctx, s, t[i].status, t[i].part);
    }
    free(sound);
    end_ctx(ctx);
}

static void not_an_exemplar(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    fails(ctx,
          read_text(ctx, "<svg xmlns=\"http://www.w3.org/2000/svg\"><path d=\"M0 0h3\"/>"
                         "</svg>"),
          TZ_FORMAT, "not an exemplar");
    fails(ctx, read_text(ctx, "hello"), TZ_FORMAT, "");
    fails(ctx, read_text(ctx, ""), TZ_FORMAT, "");
    fails(ctx,
          read_text(ctx, "<!DOCTYPE s [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]>"
                         "<svg xmlns=\"http://www.w3.org/2000/svg\">&b;</svg>"),
          TZ_FORMAT, "");
    tz_ebpt e;
    char *photo, sha256[65];
    fails(ctx, tz_ebpt_read(ctx, file("none.svg"), &e, &photo, sha256), TZ_IO,
          "none.svg");
    fails(ctx, tz_ebpt_read(ctx, folder, &e, &photo, sha256), TZ_IO, "");
    end_ctx(ctx);
}

static tz_status write_and_read(tz_ctx *ctx)
{
    tz_ebpt_params p = default_params();
    tz_image im;
    tz_ebpt e = {0}, back = {0};
    char *photo = NULL, sha256[65];
    tz_status s = tz_image_init(ctx, &im, 32, 32, 1);
    p.min_length = 4;
    if (s == TZ_OK) {
        im.encoding = TZ_ENCODING_SRGB;
        draw_pebbles(&im, 16, 1);
        s = tz_ebpt_analyze(ctx, &im, &p, &e);
    }
    if (s == TZ_OK)
        s = tz_ebpt_write(ctx, file("b.svg"), &e, "x.png", NULL);
    if (s == TZ_OK)
        s = tz_ebpt_read(ctx, file("b.svg"), &back, &photo, sha256);
    tz_free(ctx, photo);
    tz_ebpt_deinit(&e);
    tz_ebpt_deinit(&back);
    tz_image_deinit(&im);
    return s;
}

static void memory_may_fail(void **state)
{
    (void)state;
    survive(write_and_read, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outlines),        cmocka_unit_test(drawn_pictures),
        cmocka_unit_test(photos),          cmocka_unit_test(hostile),
        cmocka_unit_test(not_an_exemplar), cmocka_unit_test(memory_may_fail),
    };
    if (!mkdtemp(folder))
        return 1;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    char command[300];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command) ? 1 : failed;
}
