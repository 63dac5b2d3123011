/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Layout documents: exact round trips, what an editor makes of them, and what they show.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/file.h"
#include "base/image_io.h"
#include "base/rng.h"
#include "base/svg.h"
#include "synthesis/layout.h"

static char dir[64];

static const char *in_dir(const char *name)
{
    static char path[4][256];
    static int k;
    k = (k + 1) % 4;
    snprintf(path[k], sizeof path[k], "%s/%s", dir, name);
    return path[k];
}

static int set_up(void **state)
{
    (void)state;
    char real[200];
    strcpy(dir, "/tmp/tz-layout-XXXXXX");
    if (!mkdtemp(dir) || !realpath(dir, real))
        return 1;
    return mkdir(in_dir("sub dir"), 0777);
}

static int tear_down(void **state)
{
    (void)state;
    char command[160];
    snprintf(command, sizeof command, "rm -r '%s'", dir);
    return system(command);
}

static void read_text(const char *text, tz_layout *l)
{
    tz_ctx *ctx = NULL;
    assert_int_equal(tz_ctx_new(NULL, &ctx), TZ_OK);
    tz_status st = tz_layout_parse(ctx, "/d/l.svg", text, strlen(text), l);
    if (st)
        print_error("%s\n", tz_ctx_message(ctx));
    assert_int_equal(st, TZ_OK);
}

static void drop(tz_layout *l)
{
    tz_ctx *ctx = l->ctx;
    tz_layout_deinit(l);
    if (ctx)
        assert_int_equal(tz_ctx_memory_used(ctx), 0);
    tz_ctx_free(ctx);
}

/* ---- round trip ------------------------------------------------------------------ */

static float any_float(tz_rng *r)
{
    switch (tz_rng_below(r, 6)) {
    case 0: return (float)tz_rng_below(r, 2000);
    case 1: return (float)tz_rng_below(r, 20000) / 8;
    case 2: return (float)tz_rng_range(r, -5000, 5000);
    case 3: return (float)(tz_rng_normal(r) * 1e-3);
    case 4: return (float)(tz_rng_normal(r) * 1e7);
    default: return tz_rng_below(r, 2) ? -0.0f : 1e-30f;
    }
}

static double any_double(tz_rng *r)
{
    switch (tz_rng_below(r, 4)) {
    case 0: return tz_rng_range(r, -2, 2);
    case 1: return tz_rng_below(r, 4096);
    case 2: return tz_rng_normal(r) * 1e5;
    default: return tz_rng_normal(r) * 1e-5;
    }
}

static void fill(tz_layout *l, uint64_t seed, int n)
{
    tz_rng r = tz_rng_make(seed, 1);
    tz_point b[40];
    int points = 0;
    for (int i = 0; i < n; i++) {
        if (!points || tz_rng_below(&r, 3) == 0) { /* often the border before again */
            points = 3 + tz_rng_below(&r, 37);
            for (int k = 0; k < points; k++)
                b[k] = (tz_point){any_float(&r), any_float(&r)};
        }
        tz_affine m = {any_double(&r), any_double(&r), any_double(&r),
                       any_double(&r), any_double(&r), any_double(&r)};
        int32_t id;
        if (tz_layout_add(l, tz_rng_below(&r, l->source.n), tz_rng_below(&r, 500) - 1, m,
                          b, points, &id))
            continue; /* not invertible */
        l->place.v[id].medium = (uint8_t)tz_rng_below(&r, 3);
        l->place.v[id].fixed = (uint8_t)tz_rng_below(&r, 2);
        l->place.v[id].removed = tz_rng_below(&r, 10) == 0;
    }
    tz_ctx_clear(l->ctx);
}

static void assert_same(const tz_layout *a, const tz_layout *b)
{
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_int_equal(a->tile, b->tile);
    assert_int_equal(a->source.n, b->source.n);
    for (int i = 0; i < a->source.n; i++) {
        assert_string_equal(a->source.v[i].path, b->source.v[i].path);
        assert_string_equal(a->source.v[i].sha256, b->source.v[i].sha256);
        assert_int_equal(a->source.v[i].width, b->source.v[i].width);
        assert_int_equal(a->source.v[i].height, b->source.v[i].height);
    }
    if (a->recipe)
        assert_string_equal(a->recipe, b->recipe);
    else
        assert_null(b->recipe);
    assert_int_equal(a->place.n, b->place.n);
    for (int i = 0; i < a->place.n; i++) {
        const tz_placement *p = &a->place.v[i], *q = &b->place.v[i];
        assert_memory_equal(&p->map, &q->map, sizeof p->map);
        assert_int_equal(p->source, q->source);
        assert_int_equal(p->group, q->group);
        assert_int_equal(p->medium, q->medium);
        assert_int_equal(p->fixed, q->fixed);
        assert_int_equal(p->points, q->points);
        assert_memory_equal(a->border.v + p->border, b->border.v + q->border,
                            sizeof(tz_point) * (size_t)p->points);
    }
}

static void test_round_trip(void **state)
{
    (void)state;
    const char *sha = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";
    for (int run = 0; run < 12; run++) {
        tz_layout l = {0}, back = {0};
        tz_ctx *ctx = NULL;
        const char *doc = in_dir(run & 1 ? "layout.svg" : "sub dir/layout.svg");
        assert_int_equal(tz_ctx_new(NULL, &ctx), TZ_OK);
        assert_int_equal(tz_layout_init(ctx, &l, 3000, 2000, run & 2), TZ_OK);
        tz_layout_add_source(&l, in_dir("photo.jpg"), sha, 640, 480, NULL);
        tz_layout_add_source(&l, in_dir("sub dir/a \"b\" & 50%<c>:é.png"), NULL, 1, 99999,
                             NULL);
        tz_layout_add_source(&l, "/no/such/place/x.png", NULL, 12, 13, NULL);
        fill(&l, (uint64_t)run, run * 40);
        if (run & 4)
            tz_strdup(ctx, "{\"a\": \"<&>]]> \\\"q\\\" é\",\n \"b\": [1, 2]}\n",
                      &l.recipe);
        tz_status st = tz_layout_write(ctx, doc, &l);
        if (!st)
            st = tz_layout_read(ctx, doc, &back);
        if (st)
            print_error("%s\n", tz_ctx_message(ctx));
        assert_int_equal(st, TZ_OK);
        assert_int_equal(tz_layout_compact(&l), TZ_OK);
        assert_same(&l, &back);
        /* once more: the same bytes */
        char *text[2] = {0};
        size_t size[2];
        assert_int_equal(tz_file_read(ctx, doc, 1 << 30, &text[0], &size[0]), TZ_OK);
        assert_int_equal(tz_layout_write(ctx, doc, &back), TZ_OK);
        assert_int_equal(tz_file_read(ctx, doc, 1 << 30, &text[1], &size[1]), TZ_OK);
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(text[0], text[1], size[0]);
        tz_free(ctx, text[0]);
        tz_free(ctx, text[1]);
        assert_string_equal(tz_ctx_message(ctx), "");
        tz_layout_deinit(&back);
        drop(&l);
    }
}

/** What was moved since the document was written is fixed, what was not is not. */
static void test_moved(void **state)
{
    (void)state;
    const tz_affine map = {1, 0, 0, 1, 10, 20};
    char text[1200];
    tz_layout l = {0};
    for (int moved = 0; moved < 2; moved++) {
        snprintf(
            text, sizeof text,
            "<svg xmlns='http://www.w3.org/2000/svg' width='100' height='100' "
            "xmlns:xlink='http://www.w3.org/1999/xlink' xmlns:tz='" TZ_NS "'>"
            "<defs><image id='p' width='64' height='64' xlink:href='a.png'/></defs>"
            "<g transform='matrix(1 0 0 1 %d 20)' tz:group='3' tz:source='0' tz:at='%%x'>"
            "<use xlink:href='#p'/></g></svg>",
            10 + moved);
        char full[1400];
        char *mark = strstr(text, "%x");
        snprintf(full, sizeof full, "%.*s%x%s", (int)(mark - text), text,
                 (unsigned)tz_layout_stamp(map), mark + 2);
        read_text(full, &l);
        assert_int_equal(l.place.n, 1);
        assert_int_equal(l.place.v[0].group, 3);
        assert_int_equal(l.place.v[0].fixed, moved);
        drop(&l);
        memset(&l, 0, sizeof l);
    }
}

/** A folder with document and photo can be moved; photos are found from anywhere. */
static void test_paths(void **state)
{
    (void)state;
    tz_layout l = {0}, back = {0};
    char *text = NULL, here[1024], want[300];
    size_t size;
    assert_non_null(getcwd(here, sizeof here));
    assert_int_equal(tz_layout_init(NULL, &l, 30, 20, false), TZ_OK);
    assert_int_equal(chdir(dir), 0);
    tz_layout_add_source(&l, "my photo.jpg", NULL, 64, 48, NULL);
    tz_layout_add_source(&l, "sub dir/../sub dir/./two.jpg", NULL, 64, 48, NULL);
    assert_int_equal(tz_layout_write(NULL, "sub dir/l.svg", &l), TZ_OK);
    assert_int_equal(tz_file_read(NULL, "sub dir/l.svg", 1 << 20, &text, &size), TZ_OK);
    assert_non_null(strstr(text, "=\"../my%20photo.jpg\""));
    assert_non_null(strstr(text, "=\"two.jpg\""));
    assert_int_equal(chdir("sub dir"), 0);
    assert_int_equal(tz_layout_read(NULL, "l.svg", &back), TZ_OK);
    snprintf(want, sizeof want, "%s/my photo.jpg", dir);
    assert_string_equal(back.source.v[0].path, want);
    snprintf(want, sizeof want, "%s/sub dir/two.jpg", dir);
    assert_string_equal(back.source.v[1].path, want);
    assert_int_equal(chdir(here), 0);
    tz_free(NULL, text);
    tz_layout_deinit(&l);
    tz_layout_deinit(&back);
}

/** Most placements show a piece that another shows too: some 150 bytes each. */
static void test_document_is_small(void **state)
{
    (void)state;
    tz_layout l = {0};
    struct stat info;
    tz_rng r = tz_rng_make(3, 3);
    assert_int_equal(tz_layout_init(NULL, &l, 4096, 4096, false), TZ_OK);
    tz_layout_add_source(&l, in_dir("photo.jpg"), NULL, 640, 480, NULL);
    for (int i = 0; i < 5000; i++) {
        tz_point b[20];
        for (int k = 0; k < 20; k++)
            b[k] = (tz_point){(float)(i % 100 + k), (float)(k * k)};
        tz_affine m = tz_affine_place(
            (tz_vec2){0, 0},
            (tz_vec2){tz_rng_range(&r, 0, 4096), tz_rng_range(&r, 0, 4096)},
            tz_rng_range(&r, 0, 6), 1, false);
        assert_int_equal(tz_layout_add(&l, 0, i % 100, m, b, 20, NULL), TZ_OK);
    }
    assert_int_equal(tz_layout_write(NULL, in_dir("small.svg"), &l), TZ_OK);
    assert_int_equal(stat(in_dir("small.svg"), &info), 0);
    assert_true(info.st_size < 5000 * 300);
    tz_layout_deinit(&l);
    assert_int_equal(tz_layout_read(NULL, in_dir("small.svg"), &l), TZ_OK);
    assert_int_equal(l.place.n, 5000);
    assert_int_equal(l.border.n, 2000); /* shared */
    tz_layout_deinit(&l);
}

/* ---- after an editor ------------------------------------------------------------- */

#define ROOT                                        \
    "<svg xmlns=\"http://www.w3.org/2000/svg\" "    \
    "xmlns:xlink=\"http://www.w3.org/1999/xlink\" " \
    "xmlns:tz=\"https://terrazzo.example/ns/1\" "
#define HEAD                                                                      \
    ROOT "viewBox=\"0 0 200 100\" width=\"200\" height=\"100\">"                  \
         "<defs><image id=\"s0\" tz:source=\"0\" tz:size=\"64 48\" width=\"64\" " \
         "height=\"48\" preserveAspectRatio=\"none\" xlink:href=\"photo.jpg\"/>"  \
         "<clipPath id=\"b0\"><path d=\"M10 10 20 10 20 20 10 20Z\"/></clipPath>" \
         "</defs>"
#define PIECE "<use xlink:href=\"#s0\" clip-path=\"url(#b0)\"/>"

static void assert_map(const tz_placement *p, double a, double b, double c, double d,
                       double e, double f)
{
    double want[] = {a, b, c, d, e, f};
    double got[] = {p->map.a, p->map.b, p->map.c, p->map.d, p->map.e, p->map.f};
    for (int i = 0; i < 6; i++)
        assert_true(fabs(want[i] - got[i]) < 1e-9);
}

static void assert_border(const tz_layout *l, int id, int n, const double *want)
{
    const tz_placement *p = &l->place.v[id];
    assert_int_equal(p->points, n);
    for (int i = 0; i < n; i++) {
        assert_true(fabs(l->border.v[p->border + i].x - want[2 * i]) < 1e-4);
        assert_true(fabs(l->border.v[p->border + i].y - want[2 * i + 1]) < 1e-4);
    }
}
static const double corner[] = {10, 10, 20, 10, 20, 20, 10, 20};

/** What Inkscape 1.2 saves: its own attributes and namespaces, a layer that was moved and
 * turned, relative path commands, new ids, a hidden group, a copy, a clone, an order
 * changed. */
static void test_inkscape(void **state)
{
    (void)state;
    static const char text[] =
        "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"no\"?>\n"
        "<svg\n   viewBox=\"0 0 200 100\"\n   width=\"52.9mm\"\n   height=\"26.45mm\"\n"
        "   tz:document=\"layout\"\n   tz:tile=\"1\"\n   version=\"1.1\"\n   "
        "id=\"svg42\"\n"
        "   sodipodi:docname=\"layout.svg\"\n"
        "   inkscape:version=\"1.2.2 (b0a8486541, 2022-12-01)\"\n"
        "   xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\"\n"
        "   xmlns:sodipodi=\"http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd\"\n"
        "   xmlns:xlink=\"http://www.w3.org/1999/xlink\"\n"
        "   xmlns=\"http://www.w3.org/2000/svg\"\n"
        "   xmlns:svg=\"http://www.w3.org/2000/svg\"\n"
        "   xmlns:tz=\"https://terrazzo.example/ns/1\">\n"
        "  <sodipodi:namedview\n     id=\"namedview44\"\n     pagecolor=\"#ffffff\"\n"
        "     inkscape:zoom=\"2.8\" />\n"
        "  <metadata id=\"metadata3\">{\"seed\": 7}</metadata>\n"
        "  <defs id=\"defs12\">\n"
        "    <inkscape:path-effect effect=\"spiro\" id=\"path-effect9\" />\n"
        "    <image id=\"s0\" width=\"64\" height=\"48\" preserveAspectRatio=\"none\"\n"
        "       xlink:href=\"file:///d/my%20photo.jpg\" tz:source=\"0\" tz:size=\"64 "
        "48\" />\n"
        "    <clipPath id=\"clipPath8\" clipPathUnits=\"userSpaceOnUse\">\n"
        "      <path d=\"m 10,10 h 10 v 10 l -10,0 z\" id=\"path7\"\n"
        "         style=\"stroke-width:1\" inkscape:connector-curvature=\"0\" />\n"
        "    </clipPath>\n"
        "    <clipPath id=\"clipPath8-3\">\n"
        "      <path d=\"M 10,10 H 20 V 20 H 10 Z\" id=\"path7-6\" />\n"
        "    </clipPath>\n"
        "  </defs>\n"
        "  <g inkscape:groupmode=\"layer\" id=\"layer1\" inkscape:label=\"Stones\"\n"
        "     transform=\"translate(100,50) rotate(90)\" style=\"display:inline\">\n"
        "    <g transform=\"translate(3,4)\" tz:source=\"0\" tz:group=\"5\" id=\"g20\">\n"
        "      <use xlink:href=\"#s0\" clip-path=\"url(#clipPath8)\" id=\"use18\"\n"
        "         width=\"100%\" height=\"100%\" x=\"0\" y=\"0\" />\n"
        "      <use tz:copy=\"1\" xlink:href=\"#s0\" transform=\"translate(-200)\"\n"
        "         clip-path=\"url(#clipPath8)\" id=\"use19\" />\n"
        "    </g>\n"
        "  </g>\n"
        "  <g transform=\"matrix(1,0,0,1,7,8)\" tz:source=\"0\" tz:group=\"6\" "
        "id=\"g24\"\n"
        "     style=\"display:none\"><use xlink:href=\"#s0\" id=\"use22\" "
        "clip-path=\"url(#clipPath8)\" /></g>\n"
        "  <g id=\"g30\" transform=\"scale(2)\"><g id=\"g31\" transform=\"scale(0.5)\">\n"
        "    <g transform=\"translate(30)\" tz:source=\"0\" tz:group=\"7\" "
        "tz:fixed=\"1\"\n"
        "       id=\"g20-3\"><use xlink:href=\"#s0\" clip-path=\"url(#clipPath8-3)\"\n"
        "       id=\"use18-7\" /></g></g></g>\n"
        "  <use x=\"0\" y=\"0\" xlink:href=\"#g20\" id=\"use40\" width=\"100%\"\n"
        "     height=\"100%\" transform=\"translate(11,12)\" />\n"
        "  <!-- ungrouped: the transform went to the use, our notes are gone -->\n"
        "  <use xlink:href=\"#s0\" clip-path=\"url(#clipPath8)\" id=\"use50\"\n"
        "     transform=\"matrix(0,1,-1,0,60,0)\" />\n"
        "</svg>\n";
    tz_layout l = {0};
    read_text(text, &l);
    assert_int_equal(l.width, 200);
    assert_int_equal(l.height, 100);
    assert_true(l.tile);
    assert_string_equal(l.recipe, "{\"seed\": 7}");
    assert_int_equal(l.source.n, 1);
    assert_string_equal(l.source.v[0].path, "/d/my photo.jpg");
    assert_int_equal(l.place.n, 4);
    assert_map(&l.place.v[0], 0, 1, -1, 0, 96, 53); /* (3, 4) turned, then moved */
    assert_int_equal(l.place.v[0].group, 5);
    assert_int_equal(l.place.v[0].fixed, 0);
    assert_map(&l.place.v[1], 1, 0, 0, 1, 30, 0);
    assert_int_equal(l.place.v[1].group, 7);
    assert_int_equal(l.place.v[1].fixed, 1);
    assert_map(&l.place.v[2], 1, 0, 0, 1, 14, 16);
    assert_int_equal(l.place.v[2].group, 5);
    assert_map(&l.place.v[3], 0, 1, -1, 0, 60, 0);
    assert_int_equal(l.place.v[3].group, -1);
    assert_int_equal(l.place.v[3].fixed, 1);
    for (int i = 0; i < 4; i++)
        assert_border(&l, i, 4, corner);
    drop(&l);
}

/** The clip path may stand on any element, with transforms between. */
static void test_clip_elsewhere(void **state)
{
    (void)state;
    tz_layout l = {0};
    read_text(HEAD "<g clip-path=\"url(#b0)\" transform=\"translate(5 5)\">"
                   "<use xlink:href=\"#s0\" transform=\"translate(1 2) scale(2)\"/></g>"
                   "<g style=\"clip-path:url('#b0'); fill:red\" tz:group=\"3\">"
                   "<use xlink:href=\"#s0\"/></g>"
                   "<use xlink:href=\"#s0\" x=\"4\" y=\"-4\"/>"
                   "</svg>",
              &l);
    assert_int_equal(l.place.n, 3);
    assert_map(&l.place.v[0], 2, 0, 0, 2, 6, 7);
    const double want[] = {4.5, 4, 9.5, 4, 9.5, 9, 4.5, 9};
    assert_border(&l, 0, 4, want);
    assert_border(&l, 1, 4, corner);
    const double all[] = {0, 0, 64, 0, 64, 48, 0, 48};
    assert_map(&l.place.v[2], 1, 0, 0, 1, 4, -4);
    assert_border(&l, 2, 4, all);
    drop(&l);
}

static void test_clip_shapes(void **state)
{
    (void)state;
    static const struct {
        const char *clip;
        int points;
        double box[4];
    } t[] = {
        {"<rect x=\"1\" y=\"2\" width=\"3\" height=\"4\"/>", 4, {1, 2, 4, 6}},
        {"<polygon points=\"1,2 4,2 4,6\"/>", 3, {1, 2, 4, 6}},
        {"<circle cx=\"10\" cy=\"20\" r=\"5\"/>", 96, {5, 15, 15, 25}},
        {"<ellipse cx=\"10\" cy=\"20\" rx=\"5\" ry=\"3\"/>", 96, {5, 17, 15, 23}},
        {"<path d=\"M0 0h1v1h-1z m5,5 h10 v10 h-10 z m20 0 l1 0 0 1z\"/>",
         4,
         {5, 5, 15, 15}},
        {"<path transform=\"translate(1) scale(2)\" d=\"M0 0 10 0 10 10z\"/>",
         3,
         {1, 0, 21, 20}},
        {"<path d=\"M0 0 C 0 10 10 10 10 0 Z\"/>", 0, {0, 0, 10, 7.5}},
        {"<title>t</title><use xlink:href=\"#shape\" x=\"1\"/>", 4, {2, 1, 5, 4}},
    };
    for (size_t i = 0; i < sizeof t / sizeof *t; i++) {
        char text[2000];
        tz_layout l = {0};
        snprintf(text, sizeof text,
                 HEAD
                 "<defs><rect id=\"shape\" x=\"1\" y=\"1\" width=\"3\" height=\"3\"/>"
                 "<clipPath id=\"c\">%s</clipPath></defs>"
                 "<use xlink:href=\"#s0\" clip-path=\"url(#c)\"/></svg>",
                 t[i].clip);
        read_text(text, &l);
        assert_int_equal(l.place.n, 1);
        if (t[i].points)
            assert_int_equal(l.place.v[0].points, t[i].points);
        double lo[2] = {1e9, 1e9}, hi[2] = {-1e9, -1e9};
        for (int k = 0; k < l.place.v[0].points; k++) {
            tz_point q = l.border.v[l.place.v[0].border + k];
            lo[0] = fmin(lo[0], q.x);
            lo[1] = fmin(lo[1], q.y);
            hi[0] = fmax(hi[0], q.x);
            hi[1] = fmax(hi[1], q.y);
        }
        assert_true(fabs(lo[0] - t[i].box[0]) < 0.2 && fabs(lo[1] - t[i].box[1]) < 0.2);
        assert_true(fabs(hi[0] - t[i].box[2]) < 0.2 && fabs(hi[1] - t[i].box[3]) < 0.2);
        drop(&l);
    }
}

/** Photos that were added, copied or resized in an editor. */
static void test_photos(void **state)
{
    (void)state;
    tz_layout l = {0};
    read_text(HEAD "<image x=\"10\" y=\"20\" width=\"32\" height=\"24\" "
                   "preserveAspectRatio=\"none\" xlink:href=\"file:/d/photo.jpg\"/>"
                   "<image x=\"0\" y=\"0\" width=\"30\" height=\"40\" "
                   "xlink:href=\"file://localhost/x/new.png\"/>"
                   "<image x=\"0\" y=\"0\" width=\"60\" height=\"40\" "
                   "xlink:href=\"../x/new.png\"/>"
                   "<g visibility=\"hidden\">" PIECE "</g></svg>",
              &l);
    assert_int_equal(l.source.n, 2);
    assert_string_equal(l.source.v[0].path, "/d/photo.jpg");
    assert_string_equal(l.source.v[1].path, "/x/new.png");
    assert_int_equal(l.source.v[1].width, 30);
    assert_int_equal(l.place.n, 3);
    assert_map(&l.place.v[0], 0.5, 0, 0, 0.5, 10, 20);
    assert_map(&l.place.v[1], 1, 0, 0, 1, 0, 0);
    assert_map(&l.place.v[2], 1, 0, 0, 1, 15, 0); /* fitted and centred */
    drop(&l);
}

static void test_view_box(void **state)
{
    (void)state;
    tz_layout l = {0};
    read_text(ROOT "viewBox=\"10 20 300.0004 40\"/>", &l);
    assert_int_equal(l.width, 300);
    assert_int_equal(l.height, 40);
    drop(&l);
    read_text(ROOT "width=\"30px\" height=\"40\"/>", &l);
    assert_int_equal(l.width, 30);
    drop(&l);
}

/* ---- what it shows --------------------------------------------------------------- */

/** librsvg draws the document as the layout says, also where it wraps. */
static void test_renders(void **state)
{
    (void)state;
    tz_image photo = {0}, seen = {0};
    tz_layout l = {0};
    char command[700];
    if (system("rsvg-convert --version > /dev/null 2>&1"))
        skip();
    assert_int_equal(tz_image_init(NULL, &photo, 40, 20, 3), TZ_OK);
    photo.encoding = TZ_ENCODING_SRGB;
    for (int y = 0; y < 20; y++)
        for (int x = 0; x < 40; x++)
            tz_image_at(&photo, x, y)[x < 20 ? 0 : 1] = 1;
    assert_int_equal(tz_image_write(NULL, in_dir("sub dir/rg photo.png"), &photo, NULL),
                     TZ_OK);
    assert_int_equal(tz_layout_init(NULL, &l, 100, 80, true), TZ_OK);
    tz_layout_add_source(&l, in_dir("sub dir/rg photo.png"), NULL, 40, 20, NULL);
    tz_point all[] = {{0, 0}, {40, 0}, {40, 20}, {0, 20}};
    tz_layout_add(&l, 0, 0, (tz_affine){1, 0, 0, 1, 10, 10}, all, 4, NULL);
    tz_layout_add(&l, 0, 0, (tz_affine){0, 1, -1, 0, 110, 60}, all, 4, NULL); /* wraps */
    assert_int_equal(tz_layout_write(NULL, in_dir("sub dir/seen.svg"), &l), TZ_OK);
    snprintf(command, sizeof command,
             "rsvg-convert -o '%s' '%s' 2> '%s' && test ! -s '%s'", in_dir("seen.png"),
             in_dir("sub dir/seen.svg"), in_dir("log"), in_dir("log"));
    assert_int_equal(system(command), 0);
    tz_image_read_options srgb = {.want = TZ_ENCODING_SRGB};
    assert_int_equal(tz_image_read(NULL, in_dir("seen.png"), &srgb, &seen), TZ_OK);
    assert_int_equal(seen.width, 100);
    assert_int_equal(seen.height, 80);
    assert_int_equal(seen.channels, 4);
    /* x, y, red, green, alpha: turned by 90 deg, (0, 0) goes to (110, 60), x runs down */
    static const int want[][5] = {{15, 15, 1, 0, 1}, {45, 15, 0, 1, 1}, {60, 50, 0, 0, 0},
                                  {95, 65, 1, 0, 1}, {5, 65, 1, 0, 1},  {95, 5, 0, 1, 1},
                                  {5, 5, 0, 1, 1},   {5, 30, 0, 0, 0}};
    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        const float *px = tz_image_at(&seen, want[i][0], want[i][1]);
        assert_true(fabs(px[3] - want[i][4]) < 0.1);
        if (want[i][4]) {
            assert_true(fabs(px[0] - want[i][2]) < 0.1);
            assert_true(fabs(px[1] - want[i][3]) < 0.1);
        }
    }
    tz_image_deinit(&photo);
    tz_image_deinit(&seen);
    tz_layout_deinit(&l);
}

/** Every allocation of a write and a read fails in turn. */
static void test_allocation_failures(void **state)
{
    (void)state;
    tz_layout l = {0};
    assert_int_equal(tz_layout_init(NULL, &l, 100, 80, true), TZ_OK);
    tz_layout_add_source(&l, in_dir("p.png"), NULL, 40, 20, NULL);
    for (int i = 0; i < 30; i++) {
        tz_point b[] = {{0, 0}, {40, 0}, {(float)i, 20}};
        tz_layout_add(&l, 0, 0, (tz_affine){1, 0, 0, 1, i * 3, 10}, b, 3, NULL);
    }
    tz_strdup(NULL, "{}", &l.recipe);
    const char *doc = in_dir("alloc.svg");
    int done = 0;
    for (int64_t fail = 1; done < 2; fail++) {
        tz_ctx *ctx = NULL;
        tz_layout back = {0};
        tz_ctx_options opt = {.threads = 1, .fail_alloc = fail};
        if (tz_ctx_new(&opt, &ctx))
            continue;
        tz_status st =
            done ? tz_layout_read(ctx, doc, &back) : tz_layout_write(ctx, doc, &l);
        if (st) {
            assert_int_equal(st, TZ_NOMEM);
            assert_int_equal(back.place.n, 0);
            assert_null(back.place.v);
            if (!done)
                assert_int_equal(access(doc, F_OK), -1);
        } else {
            assert_int_equal(back.place.n, done ? 30 : 0);
            done++;
            fail = 0;
        }
        tz_layout_deinit(&back);
        assert_int_equal(tz_ctx_memory_used(ctx), 0);
        tz_ctx_free(ctx);
    }
    tz_layout_deinit(&l);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_moved),
        cmocka_unit_test(test_paths),
        cmocka_unit_test(test_document_is_small),
        cmocka_unit_test(test_inkscape),
        cmocka_unit_test(test_clip_elsewhere),
        cmocka_unit_test(test_clip_shapes),
        cmocka_unit_test(test_photos),
        cmocka_unit_test(test_view_box),
        cmocka_unit_test(test_renders),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
