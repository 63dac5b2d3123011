/* SPDX-License-Identifier: Apache-2.0 */
/* The command on curves: drawings in, layouts, completed drawings and DXF out. */
#include <math.h>

#include "tests/cli/shell.h"

#include <jansson.h>

static void text(const char *path, const char *content)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(content, f);
    fclose(f);
}

#define HEAD                                                                       \
    "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 120 90'><g fill='none' " \
    "stroke='#234' stroke-width='1'>"
#define TAIL "</g></svg>"

/* Wavy rungs and rails; `hole` leaves out what lies within 20 of the middle. */
static void draw_net(const char *path, bool hole)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(HEAD, f);
    for (int i = 0; i < 12; i++) {
        bool pen = false;
        const bool rail = i < 6;
        const int n = rail ? 60 : 45;
        for (int k = 0; k <= n; k++) {
            const double u = 2 * k,
                         v = 8 + (rail ? 15 : 20) * (i % 6) + 2 * sin(u / 9 + i),
                         x = rail ? u : v, y = rail ? v : u;
            if (hole && hypot(x - 60, y - 45) < 20) {
                fputs(pen ? "'/>" : "", f);
                pen = false;
            } else {
                fprintf(f, "%s%.3f %.3f", pen ? "L" : "<path d='M", x, y);
                pen = true;
            }
        }
        fputs(pen ? "'/>" : "", f);
    }
    fputs(TAIL, f);
    fclose(f);
}

static int setup(void **state)
{
    if (enter_scratch(state) != 0)
        return -1;
    draw_net("net.svg", false);
    draw_net("hole.svg", true);
    text("spot.svg", "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 120 90'>"
                     "<circle cx='60' cy='45' r='20'/></svg>");
    text("side.svg", "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 120 90'>"
                     "<rect x='0' y='0' width='40' height='90'/></svg>");
    return 0;
}

#define CURVES "$T arrange net.svg --as curves --size 200x150 -q "

/* ---- layouts -------------------------------------------------------------------------- */

static void layouts_are_documents_of_curves(void **state)
{
    (void)state;
    assert_exit(0, CURVES "-o l.svg");
    assert_exit(0, "grep -q 'tz:document=\"curves\"' l.svg");
    assert_exit(0, "grep -q 'viewBox=\"0 0 200 150\"' l.svg");
    assert_exit(0, "test $(grep -c '<path' l.svg) -gt 5");
    assert_exit(0, "rsvg-convert l.svg -o l.png || ! command -v rsvg-convert");
    /* a document of curves is taken as such */
    assert_exit(0, "$T arrange l.svg -o m.svg --size 250x250 -q");
    assert_exit(0, "grep -q 'tz:document=\"curves\"' m.svg");
    /* without --size: four times the drawing's sides */
    assert_exit(0, "$T arrange net.svg --as curves -o g.svg -q --curve-method quilt");
    assert_exit(0, "grep -q 'viewBox=\"0 0 480 360\"' g.svg");
}

static void same_bytes_at_any_threads(void **state)
{
    (void)state;
    assert_exit(0, CURVES "-o a.svg -j1 && " CURVES "-o b.svg -j2 && " CURVES
                          "-o c.svg -j8");
    assert_exit(0, "cmp a.svg b.svg && cmp b.svg c.svg");
    assert_exit(0, CURVES "-o d.svg --seed 77");
    assert_int_not_equal(sh("cmp -s a.svg d.svg"), 0);
}

static void replay_gives_the_same_bytes(void **state)
{
    (void)state;
    static const char *const how[] = {
        "--size 200x150",
        "",
        "--tile --size 160x160",
        "--size 150x150 --curve-method optimise --curve-start noise",
        "--size 200x200 --domain spot.svg --field 30",
        "--complete spot.svg",
        "--clone side.svg --to spot.svg",
        "--clone side.svg,spot.svg",
        "--size 200x150 --given net.svg --seed 4",
    };
    for (size_t i = 0; i < sizeof how / sizeof *how; i++) {
        assert_exit(0, "$T arrange hole.svg --as curves -q -o r.svg %s", how[i]);
        assert_exit(0, "$T replay r.svg -o r2.svg -q");
        if (sh("cmp r.svg r2.svg") != 0)
            fail_msg("replay differs: %s", how[i]);
    }
}

static void tiles_tile(void **state)
{
    (void)state;
    assert_exit(0, CURVES "-o t.svg --tile");
    assert_exit(0, "grep -q 'tz:torus=\"1\"' t.svg");
}

/* Every switch of the optimiser changes what comes out. */
static void ablations_do_something(void **state)
{
    (void)state;
    static const char *const off[] = {"--no-curve-edges",     "--no-curve-robust",
                                      "--no-curve-existence", "--no-curve-detail",
                                      "--curve-start noise",  "--curve-iterations 0",
                                      "--curve-levels 1"};
    assert_exit(0, CURVES "--curve-method optimise -o on.svg");
    for (size_t i = 0; i < sizeof off / sizeof *off; i++) {
        assert_exit(0, CURVES "--curve-method optimise -o off.svg %s", off[i]);
        assert_exit(0, "grep '<path' on.svg > on.txt; grep '<path' off.svg > off.txt");
        if (sh("cmp -s on.txt off.txt") == 0)
            fail_msg("%s changes nothing", off[i]);
    }
}

static void work_can_be_watched(void **state)
{
    (void)state;
    assert_exit(0,
                CURVES "--curve-method optimise -o w.svg --trace e.csv --samples s.svg");
    assert_exit(0, "head -1 e.csv | grep -q '^level,iteration,samples,edges,match'");
    assert_exit(0, "test $(wc -l < e.csv) -ge 21"); /* three levels, seven iterations */
    assert_exit(0, "grep -q '<circle' s.svg && grep -q '<line' s.svg");
    assert_exit(0, CURVES "--curve-method quilt -o w.svg --trace f.csv");
    assert_exit(0, "test $(wc -l < f.csv) = 1");
}

/* A photo's lines are arranged with its pixels in mind: render makes them. */
static void photos_have_lines(void **state)
{
    (void)state;
    assert_exit(0, "$T arrange mud.png --as curves -o p.svg --size 300x300 -q");
    assert_true(exists("p.plate.png"));
    assert_exit(0, "grep -q 'tz:document=\"curves\"' p.svg");
    assert_exit(0, "$T render p.svg -o p.png -q");
    assert_exit(0, "$T replay p.svg -o p2.svg -q");
}

/* ---- dxf ------------------------------------------------------------------------------ */

static void dxf_has_the_paper_s_size(void **state)
{
    (void)state;
    text("mm.svg", "<svg xmlns='http://www.w3.org/2000/svg' width='60mm' height='45mm' "
                   "viewBox='0 0 120 90'><path d='M0 90L120 90' stroke='#000'/>"
                   "<path d='M20 20H100' stroke='#000'/></svg>");
    assert_exit(0, "$T arrange mm.svg --as curves -o mm.dxf --size 120x90 --json");
    json_t *v = json_loads(out_text, 0, NULL);
    assert_non_null(v);
    const json_t *way = json_object_get(v, "pen_up_mm");
    assert_true(json_is_number(json_object_get(way, "ordered")));
    json_decref(v);
    /* half a mm a unit: nothing lies beyond 60 */
    assert_exit(0, "awk '/^ 10$/ {getline; if ($1 > 60.0001) exit 1}' mm.dxf");
    assert_exit(0, CURVES "-o - --format dxf | grep -q AC1009");
    assert_exit(0, CURVES "-o u.dxf --unit 10");
    assert_exit(0, "awk '/^ 10$/ {getline; if ($1 > m) m = $1} END {exit !(m > 1900)}' "
                   "u.dxf");
}

/* ---- predictions ---------------------------------------------------------------------- */

static void holes_are_filled(void **state)
{
    (void)state;
    static const char *const how[] = {"--complete spot.svg",
                                      "--clone side.svg --to spot.svg"};
    for (int i = 0; i < 2; i++) {
        assert_exit(0, "$T arrange hole.svg --as curves %s -o c.svg --json", how[i]);
        json_t *v = json_loads(out_text, 0, NULL);
        assert_non_null(v);
        assert_true(json_integer_value(json_object_get(v, "foretold")) > 2);
        json_decref(v);
        assert_exit(0, "grep -q 'viewBox=\"0 0 120 90\"' c.svg");
        /* nothing of what was drawn is lost */
        assert_exit(0, "test $(grep -c '<path' c.svg) -gt $(grep -o '<path' hole.svg | "
                       "wc -l)");
    }
}

/* ---- what is wrong -------------------------------------------------------------------- */

static void bad_drawings_get_one_line(void **state)
{
    (void)state;
    static const struct {
        const char *body, *said;
    } bad[] = {
        {"", "no curves"},
        {"<path d='M10 50H10V50'/>", "no curves"},
        {"<path d='MNaN 50H90'/>", "cannot be read"},
        {"<path d='M10 50H1e300'/>", "beyond any drawing"},
        {"<circle cx='50' cy='50' r='20' fill='red' stroke='none'/>", "no curves"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char all[400];
        snprintf(all, sizeof all, HEAD "%s" TAIL, bad[i].body);
        text("bad.svg", all);
        assert_exit(1, "$T arrange bad.svg --as curves -o o.svg --size 50x50");
        assert_said(bad[i].said);
        assert_one_line();
        assert_false(exists("o.svg"));
    }
    static const char *const odd[] = {
        "<path d='M10 50H90'/>",
        "<circle cx='60' cy='45' r='30'/>",
        "<path d='M10 50H90'/><path d='M10 50H90'/><path d='M20 50H90'/>",
        "<path d='M10 10L90 80L10 80L90 10L50 85L20 5L80 50L5 40Z'/>",
    };
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        char all[400];
        snprintf(all, sizeof all, HEAD "%s" TAIL, odd[i]);
        text("odd.svg", all);
        assert_exit(0, "$T arrange odd.svg --as curves -o o.svg --size 200x200 -q");
        assert_exit(0, "$T arrange odd.svg --as curves -o o.svg --size 7x5 --tile -q");
        assert_exit(0, "rm o.svg");
    }
}

static void bad_wishes_get_one_line(void **state)
{
    (void)state;
    static const struct {
        int code;
        const char *how, *said;
    } bad[] = {
        /* 2 = the command line itself is wrong */
        {1, "--curve-method best", "curve-method"},
        {2, "--curve-methd quilt", "curve-method"},
        {2, "--complete spot.svg --clone side.svg,spot.svg", "exclude"},
        {2, "--clone side.svg", "--to"},
        {2, "--to spot.svg", "--clone"},
        {1, "--complete missing.svg", "missing.svg"},
        {2, "--complete spot.svg --domain spot.svg", "--domain"},
        {2, "--keep net.svg", "--given"},
        {2, "--textures kinds=a", "--textures"},
        {1, "--given stones.png", "stones.png"},
        {1, "--format dxf", "contradicts"},
        {1, "--trace o.svg", "twice"},
        {1, "--trace net.svg", "net.svg"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_exit(bad[i].code,
                    "$T arrange net.svg --as curves -o o.svg --size 200x150 %s",
                    bad[i].how);
        assert_one_line();
        if (!strstr(err_text, bad[i].said))
            fail_msg("%s: %s", bad[i].how, err_text);
        assert_false(exists("o.svg"));
    }
    assert_exit(1, "$T arrange net.svg --as curves -o o.png");
    assert_said(".dxf");
    assert_one_line();
    assert_exit(1, "$T arrange net.svg --as curves -o nowhere/o.svg");
    assert_one_line();
    assert_exit(1, "$T arrange net.svg --as curves --size 200x150 -o /dev/full");
    assert_exit(1, "$T arrange stones.png --as curves -o o.svg --complete spot.svg");
    assert_said("analyze");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layouts_are_documents_of_curves),
        cmocka_unit_test(same_bytes_at_any_threads),
        cmocka_unit_test(replay_gives_the_same_bytes),
        cmocka_unit_test(tiles_tile),
        cmocka_unit_test(ablations_do_something),
        cmocka_unit_test(work_can_be_watched),
        cmocka_unit_test(photos_have_lines),
        cmocka_unit_test(dxf_has_the_paper_s_size),
        cmocka_unit_test(holes_are_filled),
        cmocka_unit_test(bad_drawings_get_one_line),
        cmocka_unit_test(bad_wishes_get_one_line),
    };
    return cmocka_run_group_tests(tests, setup, leave_scratch);
}
