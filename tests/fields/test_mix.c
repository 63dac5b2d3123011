/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Mixes as text: shares, words, names, and what cannot be understood. */
#include "tests/base/check.h"

#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/svg.h"
#include "elements/element_io.h"
#include "fields/mix.h"
#include "tests/support/elements.h"

/** Things of three classes, called leaf, stone and a:3. */
static void named_set(tz_ctx *ctx, tz_element_set *set)
{
    ok(ctx, drawn_darts(ctx, 100, 9, 60, 3, false, set));
    for (int32_t k = 0; k < 3; k++) {
        tz_free(ctx, set->kind.v[k].name);
        ok(ctx, tz_strdup(ctx, (const char *[]){"leaf", "stone", "a:3"}[k],
                          &set->kind.v[k].name));
    }
}

static double share_of(const tz_mix *m, const tz_element_set *set, int32_t kind)
{
    double sum = 0;
    for (int32_t i = 0; i < m->n; i++)
        if (set->element.v[m->v[i].element].kind == kind)
            sum += m->v[i].share;
    return sum;
}

static const tz_fill_entry *first_of(const tz_mix *m, const tz_element_set *set,
                                     int32_t kind)
{
    for (int32_t i = 0; i < m->n; i++)
        if (set->element.v[m->v[i].element].kind == kind)
            return &m->v[i];
    fail_msg("no entry of class %d", kind);
    return NULL;
}

static void mixes_are_read(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set set;
    tz_mix m = {0};
    named_set(ctx, &set);
    ok(ctx, tz_mix_parse(ctx,
                         " leaf:3  rigidity=20 size=0.5..2 turn=90 jitter=-180,"
                         "\nstone size=.25,, *:0.5",
                         &set, 70, &m));
    assert_int_equal(m.n, set.element.n);
    assert_true(fabs(share_of(&m, &set, 0) - 3) < 1e-12);
    assert_true(fabs(share_of(&m, &set, 1) - 1) < 1e-12);
    assert_true(fabs(share_of(&m, &set, 2) - 0.5) < 1e-12);
    const tz_fill_entry *leaf = first_of(&m, &set, 0), *stone = first_of(&m, &set, 1);
    assert_true(leaf->rigidity == 20 && leaf->size[0] == 0.5 && leaf->size[1] == 2);
    assert_true(fabs(leaf->turn - TZ_PI / 2) < 1e-12 &&
                fabs(leaf->jitter - TZ_PI) < 1e-12);
    assert_true(stone->rigidity == 70 && stone->size[0] == 0.25 &&
                stone->size[1] == 0.25);
    assert_true(stone->turn == 0 && stone->jitter == 0);
    tz_array_free(ctx, &m);
    /* names may hold colons; a symbol's name will do; what has no share is left out */
    m = (tz_mix){0};
    char text[128];
    snprintf(text, sizeof text, "a:3:7,leaf:0,%s", set.symbol.v[0].id);
    ok(ctx, tz_mix_parse(ctx, text, &set, 0, &m));
    assert_true(fabs(share_of(&m, &set, 2) - 7) < 1e-12);
    assert_true(share_of(&m, &set, 0) == 0);
    tz_array_free(ctx, &m);
    tz_element_set_deinit(&set);
    end_ctx(ctx);
}

static void bad_mixes_are_named(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "",
        "  , ,",
        "nobody",
        "leaf:-1",
        "leaf:1e99",
        "leaf size=",
        "leaf size=0",
        "leaf size=2..1",
        "leaf size=1..",
        "leaf size=a",
        "leaf:0",
        "leaf rigidity=",
        "leaf turn=999",
        "leaf rigidity=-1",
        "leaf 3",
        "leaf size=nan",
        "leaf rigidity=101",
        "leaf jitter=x",
        "leaf colour=red",
    };
    tz_ctx *ctx = new_ctx(1);
    tz_element_set set;
    named_set(ctx, &set);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        tz_mix m = {0};
        fails(ctx, tz_mix_parse(ctx, bad[i], &set, 50, &m), TZ_INVALID, "mix");
        assert_null(m.v);
    }
    /* things that must not be copied are not there */
    for (int32_t i = 0; i < set.element.n; i++)
        set.element.v[i].doubtful = set.element.v[i].kind == 0;
    tz_mix m = {0};
    fails(ctx, tz_mix_parse(ctx, "leaf", &set, 50, &m), TZ_INVALID, "leaf");
    tz_element_set_deinit(&set);
    end_ctx(ctx);
}

static void palettes_bring_mixes(void **state)
{
    (void)state;
    char dir[64], path[96], *text;
    tz_ctx *ctx = new_ctx(1);
    begin_dir(dir);
    snprintf(path, sizeof path, "%s/p.svg", dir);
    for (int i = 0; i < 2; i++) {
        FILE *f = fopen(path, "w");
        assert_non_null(f);
        fprintf(f, "<svg xmlns='http://www.w3.org/2000/svg' xmlns:tz='" TZ_NS "' %s/>",
                i ? "tz:mix='a:3, b'" : "");
        assert_int_equal(fclose(f), 0);
        ok(ctx, tz_mix_of_document(ctx, path, &text));
        assert_string_equal(text, i ? "a:3, b" : "");
        tz_free(ctx, text);
    }
    fails(ctx, tz_mix_of_document(ctx, "/nowhere/p.svg", &text), TZ_IO, "p.svg");
    end_dir(dir);
    end_ctx(ctx);
}

static const char *const inkscape =
    "<svg xmlns='http://www.w3.org/2000/svg' xmlns:tz='" TZ_NS "' "
    "xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape' width='60mm' "
    "height='20mm' viewBox='-5 -5 60 20'><g inkscape:label='Layer 1' data-jitter='9' "
    "transform='translate(2,1)'><path id='path12' inkscape:label='leaf share=3 "
    "size=0.5..1 draft=yes' d='M0 5C5 0 14 0 20 5C14 10 5 10 0 5Z'/><ellipse id='ball' "
    "cx='30' cy='5' rx='2.5' ry='2.5' data-share='2' data-rigidity='50'/><path "
    "tz:mix='share=0 turn=90' id='twig' d='M40 0L48 1L40 2Z'/></g></svg>";

/* Things of a plain drawing say themselves what they are like. */
static void things_say_their_own(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_element_set set;
    tz_mix m = {0};
    ok(ctx, tz_element_parse_svg(ctx, "p", inkscape, strlen(inkscape), NULL, &set));
    assert_int_equal(set.element.n, 3);
    ok(ctx, tz_mix_parse(ctx, "*", &set, 70, &m));
    assert_int_equal(m.n, 2); /* the twig has no share */
    assert_true(tz_mix_is(&set, m.v[0].element, "leaf"));
    assert_true(tz_mix_is(&set, m.v[0].element, "path12"));
    assert_false(tz_mix_is(&set, m.v[0].element, "lea"));
    assert_true(tz_mix_is(&set, m.v[1].element, "ball"));
    assert_true(fabs(m.v[0].share / m.v[1].share - 1.5) < 1e-12);
    assert_true(m.v[0].size[0] == 0.5 && m.v[0].size[1] == 1 && m.v[0].rigidity == 70);
    assert_true(m.v[1].rigidity == 50 && m.v[1].size[0] == 1);
    assert_true(fabs(m.v[1].jitter - 9 * TZ_PI / 180) < 1e-12); /* its layer's */
    tz_array_free(ctx, &m);
    /* the mix goes before */
    ok(ctx, tz_mix_parse(ctx, "leaf:1 size=2 jitter=0, ball:4", &set, 70, &m));
    assert_true(m.v[0].size[0] == 2 && m.v[0].size[1] == 2 && m.v[0].jitter == 0);
    assert_true(fabs(m.v[1].share / m.v[0].share - 4) < 1e-12);
    assert_true(m.v[1].rigidity == 50);
    tz_array_free(ctx, &m);
    fails(ctx, tz_mix_parse(ctx, "twig", &set, 70, &m), TZ_INVALID, "share");
    tz_element_set_deinit(&set);
    static const char *const bad[] = {"share=-1", "size=0", "rigidity=101", "turn=x"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[2048];
        const char *at = strstr(inkscape, "share=3");
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - inkscape), inkscape, bad[i],
                 at + strlen("share=3"));
        ok(ctx, tz_element_parse_svg(ctx, "p", text, strlen(text), NULL, &set));
        fails(ctx, tz_mix_parse(ctx, "*", &set, 70, &m), TZ_INVALID, bad[i]);
        assert_null(m.v);
        tz_element_set_deinit(&set);
    }
    end_ctx(ctx);
}

static tz_status read_once(tz_ctx *c)
{
    tz_element_set set;
    tz_mix m = {0};
    tz_status s = tz_element_parse_svg(c, "p", inkscape, strlen(inkscape), NULL, &set);
    if (s != TZ_OK)
        return s;
    s = tz_mix_parse(c, "*", &set, 1, &m);
    tz_array_free(c, &m);
    tz_element_set_deinit(&set);
    return s;
}

static tz_status parse_once(tz_ctx *c)
{
    tz_element_set set;
    tz_mix m = {0};
    tz_status s = drawn_darts(c, 100, 9, 60, 2, false, &set);
    if (s != TZ_OK)
        return s;
    s = tz_mix_parse(c, "*", &set, 1, &m);
    tz_array_free(c, &m);
    tz_element_set_deinit(&set);
    return s;
}

static void survives_want_of_memory(void **state)
{
    (void)state;
    survive(parse_once, 1);
    survive(read_once, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mixes_are_read),          cmocka_unit_test(bad_mixes_are_named),
        cmocka_unit_test(palettes_bring_mixes),    cmocka_unit_test(things_say_their_own),
        cmocka_unit_test(survives_want_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
