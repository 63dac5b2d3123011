/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rule files and the look-up of the rule at a point. */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/image_io.h"
#include "base/rng.h"
#include "synthesis/rules.h"

static tz_status parse(const char *text, tz_rules *r)
{
    return tz_rules_parse(NULL, "r.json", text, strlen(text), r);
}

static double share(const tz_rules *r, tz_vec2 p, int32_t rule)
{
    enum { N = 4000 };
    int in = 0;
    for (int i = 0; i < N; i++)
        in += tz_rules_at(r, 200, 100, p, (i + 0.5) / N) == rule;
    return (double)in / N;
}

static void test_default(void **state)
{
    (void)state;
    tz_rules r = {0};
    assert_int_equal(tz_rules_default(NULL, &r), TZ_OK);
    assert_int_equal(r.rule.n, 1);
    assert_int_equal(r.rule.v[0].structure, TZ_STRUCTURE_EXEMPLAR);
    assert_true(isnan(r.rule.v[0].rotation[0]));
    assert_int_equal(tz_rules_at(&r, 10, 10, (tz_vec2){3, 3}, 0.5), 0);
    assert_true(tz_rules_field(&r, 0, 10, 10, (tz_vec2){3, 3}) == 0);
    tz_rules_deinit(&r);
    tz_rules_deinit(&r);
}

static void test_all_keys(void **state)
{
    (void)state;
    tz_rules r = {0};
    assert_int_equal(
        parse("{\"$schema\": \"x\", \"name\": \"n\", \"rules\": ["
              "{\"name\": \"first\", \"structure\": \"granular\", \"size\": [4, null],"
              " \"rotation\": [-90, 45], \"scale\": [0.5, 2], \"density\": 1.5,"
              " \"length_bins\": [0, 2], \"angle_bins\": [1], \"groups\": [7, 3],"
              " \"source\": 1},"
              "{\"rect\": [0.5, 0, 0.5, 1], \"angle\": 180, \"scale\": 3, \"feather\": 8,"
              " \"source\": \"all\", \"structure\": \"random\", \"size\": [1, 2]}]}",
              &r),
        TZ_OK);
    const tz_rule *q = &r.rule.v[0];
    assert_int_equal(r.rule.n, 2);
    assert_string_equal(q->name, "first");
    assert_int_equal(q->structure, TZ_STRUCTURE_GRANULAR);
    assert_true(q->size[0] == 4 && isinf(q->size[1]));
    assert_true(fabs(q->rotation[0] + TZ_PI / 2) < 1e-12);
    assert_true(fabs(q->rotation[1] - TZ_PI / 4) < 1e-12);
    assert_true(q->scale[0] == 0.5 && q->scale[1] == 2 && q->density == 1.5);
    assert_int_equal(q->length_bins, 5);
    assert_int_equal(q->angle_bins, 2);
    assert_int_equal(q->groups.n, 2);
    assert_int_equal(q->groups.v[1], 3);
    assert_int_equal(q->source, 1);
    q = &r.rule.v[1];
    assert_string_equal(q->name, "rule 1");
    assert_true(q->rotation[0] == q->rotation[1] && fabs(q->rotation[0] - TZ_PI) < 1e-12);
    assert_true(q->scale[0] == 3 && q->scale[1] == 3);
    assert_int_equal(q->length_bins, ~0u);
    assert_int_equal(q->source, -1);
    tz_rules_deinit(&r);
}

static void test_regions(void **state)
{
    (void)state;
    tz_rules r = {0};
    /* no rule for everywhere: one is put below */
    assert_int_equal(parse("{\"rules\": [{\"rect\": [0, 0, 0.5, 1]},"
                           "{\"circle\": [0.25, 0.5, 0.1]},"
                           "{\"polygon\": [[0.6, 0.2], [0.9, 0.2], [0.9, 0.8]]}]}",
                           &r),
                     TZ_OK);
    assert_int_equal(r.rule.n, 4);
    assert_int_equal(tz_rules_at(&r, 200, 100, (tz_vec2){0, 0}, 0.3), 1);
    assert_int_equal(tz_rules_at(&r, 200, 100, (tz_vec2){99, 99}, 0.3), 1);
    assert_int_equal(tz_rules_at(&r, 200, 100, (tz_vec2){101, 99}, 0.3), 0);
    assert_int_equal(tz_rules_at(&r, 200, 100, (tz_vec2){50, 50}, 0.3), 2);
    assert_int_equal(tz_rules_at(&r, 200, 100, (tz_vec2){50, 61}, 0.3), 1);
    assert_int_equal(tz_rules_at(&r, 200, 100, (tz_vec2){175, 30}, 0.3), 3);
    assert_int_equal(tz_rules_at(&r, 200, 100, (tz_vec2){130, 60}, 0.3), 0);
    tz_rules_deinit(&r);
}

/** A feathered border passes smoothly from one rule to the other, and not at the rim. */
static void test_feather(void **state)
{
    (void)state;
    tz_rules r = {0};
    assert_int_equal(
        parse("{\"rules\": [{}, {\"rect\": [0, 0, 0.5, 1], \"feather\": 40}]}", &r),
        TZ_OK);
    double last = 1;
    for (int x = 0; x <= 200; x += 5) {
        double s = share(&r, (tz_vec2){x, 50}, 1);
        assert_true(s <= last + 0.01);
        if (x <= 80)
            assert_true(s == 1);
        if (x >= 120)
            assert_true(s == 0);
        last = s;
    }
    assert_true(fabs(share(&r, (tz_vec2){100, 50}, 1) - 0.5) < 0.02);
    /* disc beyond a chord half a radius from its centre: 0.1955 of its area */
    assert_true(fabs(share(&r, (tz_vec2){110, 50}, 1) - 0.1955) < 0.02);
    assert_true(share(&r, (tz_vec2){0, 0}, 1) == 1);
    tz_rules_deinit(&r);
}

static void test_fields(void **state)
{
    (void)state;
    tz_rules r = {0};
    assert_int_equal(parse("{\"rules\": [{\"field\": {\"around\": 1, \"angle\": 90}},"
                           "{\"field\": {\"angle\": -30, \"slope\": [60, 0]}}]}",
                           &r),
                     TZ_OK);
    for (int i = 0; i < 64; i++) {
        double a = 2 * TZ_PI * i / 64, c = cos(a), s = sin(a);
        tz_vec2 p = {100 + 60 * c, 50 + 30 * s};
        double got = tz_rules_field(&r, 0, 200, 100, p), want = a + TZ_PI / 2;
        assert_true(fabs(remainder(got - want, 2 * TZ_PI)) < 0.02);
        got = tz_rules_field(&r, 1, 200, 100, p);
        want = (-30 + 60 * p.x / 200) * TZ_PI / 180;
        assert_true(fabs(got - want) < 0.01);
    }
    tz_rules_deinit(&r);
}

/** Masks and fields from image files, found from the rule file's folder, read once. */
static void test_images(void **state)
{
    (void)state;
    char dir[] = "/tmp/tz-rules-XXXXXX", path[100];
    tz_image im = {0};
    tz_rules r = {0};
    assert_non_null(mkdtemp(dir));
    snprintf(path, sizeof path, "%s/m.png", dir);
    assert_int_equal(tz_image_init(NULL, &im, 8, 4, 1), TZ_OK);
    im.encoding = TZ_ENCODING_DATA;
    for (int i = 0; i < 32; i++)
        im.px[i] = i % 8 < 4 ? 1.0f : 0.0f;
    assert_int_equal(tz_image_write(NULL, path, &im, NULL), TZ_OK);
    for (int i = 0; i < 32; i++)
        im.px[i] = 64 / 255.0f; /* some 90 degrees */
    snprintf(path, sizeof path, "%s/f.png", dir);
    assert_int_equal(tz_image_write(NULL, path, &im, NULL), TZ_OK);
    snprintf(path, sizeof path, "%s/r.json", dir);
    FILE *f = fopen(path, "w");
    fputs("{\"rules\": [{}, {\"mask\": \"m.png\", \"field\": \"f.png\"},"
          "{\"mask\": \"m.png\", \"rect\": [0, 0, 1, 0.5], \"feather\": 20}]}",
          f);
    fclose(f);
    assert_int_equal(tz_rules_read(NULL, path, &r), TZ_OK);
    assert_int_equal(r.mask.n, 2);
    assert_int_equal(tz_rules_at(&r, 200, 100, (tz_vec2){50, 90}, 0.2), 1);
    assert_int_equal(tz_rules_at(&r, 200, 100, (tz_vec2){150, 90}, 0.2), 0);
    assert_int_equal(tz_rules_at(&r, 200, 100, (tz_vec2){50, 20}, 0.2), 2);
    double s = share(&r, (tz_vec2){100, 20}, 2);
    assert_true(s > 0.3 && s < 0.7);
    assert_true(fabs(tz_rules_field(&r, 1, 200, 100, (tz_vec2){9, 9}) - TZ_PI / 2) <
                0.03);
    tz_rules_deinit(&r);
    assert_int_equal(tz_rules_read(NULL, dir, &r), TZ_IO);
    snprintf(path, sizeof path, "%s/none.json", dir);
    assert_int_equal(tz_rules_read(NULL, path, &r), TZ_IO);
    tz_image_deinit(&im);
    snprintf(path, sizeof path, "rm -r '%s'", dir);
    assert_int_equal(system(path), 0);
}

static void test_messages(void **state)
{
    (void)state;
#define RULE(x) "{\"rules\": [{}, {" x "}]}"
    static const struct {
        const char *text;
        tz_status status;
        const char *says;
    } t[] = {
        {"", TZ_FORMAT, "r.json:"},
        {"{\n\"rules\": [\n{,}]}", TZ_FORMAT, "r.json:3:"},
        {"{\"rules\": [{\"angle\": 1, \"angle\": 2}]}", TZ_FORMAT, "duplicate"},
        {"[]", TZ_INVALID, "rules"},
        {"{}", TZ_INVALID, "rules"},
        {"{\"rules\": {}}", TZ_INVALID, "list of rules"},
        {"{\"rules\": [3]}", TZ_INVALID, "rules[0] must be an object"},
        {"{\"rules\": [], \"rule\": 1}", TZ_INVALID, "did you mean \"rules\"?"},
        {RULE("\"rotaton\": [0, 1]"), TZ_INVALID,
         "rules[1].rotaton is no key of a rule file; did you mean \"rotation\"?"},
        {RULE("\"xyzzy\": 1"), TZ_INVALID, "known are name,"},
        {RULE("\"structure\": \"granul\""), TZ_INVALID, "did you mean \"granular\"?"},
        {RULE("\"structure\": 3"), TZ_INVALID, "rules[1].structure must be"},
        {RULE("\"rotation\": [40, 0]"), TZ_INVALID,
         "rules[1].rotation runs from 40 down"},
        {RULE("\"rotation\": 40"), TZ_INVALID, "list of 2 numbers"},
        {RULE("\"rotation\": [\"a\", 1]"), TZ_INVALID, "must be a number"},
        {RULE("\"rotation\": [0, 40], \"angle\": 3"), TZ_INVALID, "keep one"},
        {RULE("\"rect\": [0, 0, 1, 1], \"circle\": [0, 0, 1]"), TZ_INVALID, "keep one"},
        {RULE("\"rect\": [0, 0, 0, 1]"), TZ_INVALID, "no area"},
        {RULE("\"circle\": [0, 0, -1]"), TZ_INVALID, "no area"},
        {RULE("\"polygon\": [[0, 0], [1, 1]]"), TZ_INVALID, "3 to"},
        {RULE("\"polygon\": [[0, 0], [1, 1], [1e9, 1]]"), TZ_INVALID, "from -10 to 10"},
        {RULE("\"feather\": -1"), TZ_INVALID, "rules[1].feather is -1"},
        {RULE("\"density\": 0"), TZ_INVALID, "rules[1].density"},
        {RULE("\"density\": 1e999"), TZ_FORMAT, "r.json:1"},
        {RULE("\"size\": [3]"), TZ_INVALID, "rules[1].size"},
        {RULE("\"scale\": 0"), TZ_INVALID, "rules[1].scale"},
        {RULE("\"length_bins\": []"), TZ_INVALID, "rules[1].length_bins"},
        {RULE("\"length_bins\": [32]"), TZ_INVALID, "0 to 31"},
        {RULE("\"angle_bins\": [0.5]"), TZ_INVALID, "rules[1].angle_bins"},
        {RULE("\"groups\": [-1]"), TZ_INVALID, "rules[1].groups"},
        {RULE("\"source\": -1"), TZ_INVALID, "rules[1].source"},
        {RULE("\"mask\": 3"), TZ_INVALID, "path of an image"},
        {RULE("\"mask\": \"no-such.png\""), TZ_IO, "no-such.png"},
        {RULE("\"field\": 3"), TZ_INVALID, "rules[1].field"},
        {RULE("\"field\": {\"arround\": 1}"), TZ_INVALID, "did you mean \"around\"?"},
        {RULE("\"field\": {\"around\": 0.5}"), TZ_INVALID, "whole number"},
        {RULE("\"name\": 3"), TZ_INVALID, "rules[1].name"},
    };
    for (size_t i = 0; i < sizeof t / sizeof *t; i++) {
        tz_ctx *ctx = NULL;
        tz_rules r = {0};
        assert_int_equal(tz_ctx_new(NULL, &ctx), TZ_OK);
        tz_status st = tz_rules_parse(ctx, "r.json", t[i].text, strlen(t[i].text), &r);
        const char *message = tz_ctx_message(ctx);
        if (st != t[i].status || !strstr(message, t[i].says) || strchr(message, '\n'))
            fail_msg("case %zu: status %d, message \"%s\", expected \"%s\"", i, st,
                     message, t[i].says);
        assert_null(r.rule.v);
        assert_int_equal(tz_ctx_memory_used(ctx), 0);
        tz_ctx_free(ctx);
    }
}

/** Every preset reads. */
static void test_presets(void **state)
{
    (void)state;
    DIR *d = opendir(TZ_SOURCE_DIR "/data/presets");
    int n = 0;
    assert_non_null(d);
    for (struct dirent *e; (e = readdir(d));) {
        char path[1000];
        tz_ctx *ctx = NULL;
        tz_rules r = {0};
        const char *dot = strrchr(e->d_name, '.');
        if (!dot || strcmp(dot, ".json") || strstr(e->d_name, "schema"))
            continue;
        snprintf(path, sizeof path, TZ_SOURCE_DIR "/data/presets/%s", e->d_name);
        assert_int_equal(tz_ctx_new(NULL, &ctx), TZ_OK);
        if (tz_rules_read(ctx, path, &r))
            fail_msg("%s", tz_ctx_message(ctx));
        tz_rules_deinit(&r);
        tz_ctx_free(ctx);
        n++;
    }
    closedir(d);
    assert_true(n >= 8);
}

static void test_allocation_failures(void **state)
{
    (void)state;
    static const char text[] =
        "{\"rules\": [{\"rect\": [0, 0, 1, 1]}, {\"groups\": [1, 2], \"circle\": [0, 0, "
        "1],"
        "\"field\": {\"around\": 1}}, {\"polygon\": [[0, 0], [1, 0], [1, 1]]}]}";
    for (int64_t fail = 1;; fail++) {
        tz_ctx *ctx = NULL;
        tz_rules r = {0};
        tz_ctx_options opt = {.threads = 1, .fail_alloc = fail};
        if (tz_ctx_new(&opt, &ctx))
            continue;
        tz_status st = tz_rules_parse(ctx, "r.json", text, sizeof text - 1, &r);
        if (st) {
            assert_int_equal(st, TZ_NOMEM);
            assert_null(r.rule.v);
        }
        tz_rules_deinit(&r);
        assert_int_equal(tz_ctx_memory_used(ctx), 0);
        tz_ctx_free(ctx);
        if (!st)
            break;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_default),
        cmocka_unit_test(test_all_keys),
        cmocka_unit_test(test_regions),
        cmocka_unit_test(test_feather),
        cmocka_unit_test(test_fields),
        cmocka_unit_test(test_images),
        cmocka_unit_test(test_messages),
        cmocka_unit_test(test_presets),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
