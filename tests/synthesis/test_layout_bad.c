/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Layout documents that are broken or hostile: one clear message, nothing lost, no hang.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "synthesis/layout.h"

#define NS                                          \
    "<svg xmlns=\"http://www.w3.org/2000/svg\" "    \
    "xmlns:xlink=\"http://www.w3.org/1999/xlink\" " \
    "xmlns:tz=\"https://terrazzo.example/ns/1\" "
#define ROOT NS "viewBox=\"0 0 200 100\">\n"
#define IMAGE(href)                                                                  \
    "<image id=\"s0\" tz:source=\"0\" width=\"64\" height=\"48\" xlink:href=\"" href \
    "\"/>"
#define CLIP(shape) "<clipPath id=\"b0\">" shape "</clipPath>"
#define SQUARE      CLIP("<path d=\"M0 0 9 0 9 9 0 9Z\"/>")
#define DEFS        "<defs>" IMAGE("p.jpg") SQUARE "</defs>\n"
#define PIECE       "<use xlink:href=\"#s0\" clip-path=\"url(#b0)\"/>"

static tz_status parse(const char *text, size_t size, char *message)
{
    tz_ctx *ctx = NULL;
    tz_layout l = {0};
    tz_ctx_options opt = {.threads = 1};
    assert_int_equal(tz_ctx_new(&opt, &ctx), TZ_OK);
    tz_status st = tz_layout_parse(ctx, "l.svg", text, size, &l);
    snprintf(message, 1000, "%s", tz_ctx_message(ctx));
    if (st)
        assert_null(l.place.v);
    tz_layout_deinit(&l);
    assert_int_equal(tz_ctx_memory_used(ctx), 0);
    tz_ctx_free(ctx);
    return st;
}

static void test_messages(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        tz_status status;
        const char *says; /* part of the message; all name the file */
    } t[] = {
        {"", TZ_FORMAT, "l.svg"},
        {"hello", TZ_FORMAT, "l.svg"},
        {"<svg", TZ_FORMAT, "l.svg"},
        {"<html/>", TZ_FORMAT, "l.svg"},
        {NS "/>", TZ_FORMAT, "viewBox"},
        {NS "viewBox=\"0 0 nan 3\"/>", TZ_FORMAT, "viewBox"},
        {NS "viewBox=\"0 0 0 3\"/>", TZ_FORMAT, "no area"},
        {NS "viewBox=\"0 0 -1 3\"/>", TZ_FORMAT, "no area"},
        {NS "viewBox=\"0 0 2147483648 3\"/>", TZ_LIMIT, "1000000"},
        {NS "viewBox=\"0 0 9 9\" tz:document=\"exemplar\"/>", TZ_FORMAT, "not a layout"},
        {ROOT IMAGE("http://example.org/p.jpg") PIECE "</svg>", TZ_FORMAT,
         "l.svg:2: photo is remote"},
        {ROOT IMAGE("//example.org/p.jpg") "</svg>", TZ_FORMAT, "l.svg:2: "},
        {ROOT IMAGE("file://host/p.jpg") "</svg>", TZ_FORMAT, "another machine"},
        {ROOT IMAGE("data:image/png;base64,AAAA") "</svg>", TZ_FORMAT, "embedded"},
        {ROOT IMAGE("") "</svg>", TZ_FORMAT, "empty"},
        {ROOT IMAGE("a%00b") "</svg>", TZ_FORMAT, "%00"},
        {ROOT "<image width=\"9\" height=\"9\"/></svg>", TZ_FORMAT, "xlink:href"},
        {ROOT "<image xlink:href=\"p.jpg\"/></svg>", TZ_FORMAT, "width and height"},
        {ROOT "<image width=\"9%\" height=\"9\" xlink:href=\"p\"/></svg>", TZ_FORMAT,
         "width"},
        {ROOT "<image width=\"1e300\" height=\"9\" xlink:href=\"p\"/></svg>", TZ_FORMAT,
         "width"},
        {ROOT DEFS "<g transform=\"matrix(nan 0 0 1 0 0)\">" PIECE "</g></svg>",
         TZ_FORMAT, "l.svg:3: transform"},
        {ROOT DEFS "<g transform=\"matrix(1 0 0 1 0)\">" PIECE "</g></svg>", TZ_FORMAT,
         "l.svg:3: transform"},
        {ROOT DEFS "<g transform=\"scale(0)\">" PIECE "</g></svg>", TZ_FORMAT,
         "inverted"},
        {ROOT DEFS "<g transform=\"scale(1e200)\"><g transform=\"scale(1e200)\">" PIECE
                   "</g></g></svg>",
         TZ_FORMAT, "l.svg:3"},
        {ROOT DEFS "<g tz:group=\"x\">" PIECE "</g></svg>", TZ_FORMAT, "tz:group"},
        {ROOT DEFS "<g tz:group=\"1e12\">" PIECE "</g></svg>", TZ_FORMAT, "tz:group"},
        {ROOT DEFS "<g tz:group=\"1\" tz:medium=\"jam\">" PIECE "</g></svg>", TZ_FORMAT,
         "tz:medium"},
        {ROOT DEFS "<use xlink:href=\"#none\"/></svg>", TZ_FORMAT,
         "l.svg:3: there is no \"none\""},
        {ROOT DEFS "<use xlink:href=\"other.svg#x\"/></svg>", TZ_FORMAT, "another file"},
        {ROOT DEFS "<use xlink:href=\"#s0\" clip-path=\"url(#q)\"/></svg>", TZ_FORMAT,
         "no clip path \"q\""},
        {ROOT DEFS "<use xlink:href=\"#s0\" clip-path=\"url(#s0)\"/></svg>", TZ_FORMAT,
         "no clip path"},
        {ROOT DEFS "<use xlink:href=\"#s0\" clip-path=\"rect(0)\"/></svg>", TZ_FORMAT,
         "clip-path"},
        {ROOT "<g id=\"a\"><use xlink:href=\"#a\"/></g></svg>", TZ_FORMAT,
         "inside itself"},
        {ROOT "<g id=\"a\"><use xlink:href=\"#b\"/></g>\n<g id=\"b\"><use "
              "xlink:href=\"#a\"/></g></svg>",
         TZ_FORMAT, "inside itself"},
        {ROOT "<use id=\"a\" xlink:href=\"#a\"/></svg>", TZ_FORMAT, "inside itself"},
        {ROOT IMAGE("p.jpg") "\n" CLIP("") PIECE "</svg>", TZ_FORMAT,
         "l.svg:3: clip path b0"},
        {ROOT IMAGE("p.jpg") CLIP("<path d=\"M0 0 1 1\"/>") PIECE "</svg>", TZ_FORMAT,
         "clip path"},
        {ROOT IMAGE("p.jpg") CLIP("<path d=\"M0 0 nan 1 2 2Z\"/>") PIECE "</svg>",
         TZ_FORMAT, "clip path"},
        {ROOT IMAGE("p.jpg") CLIP("<path d=\"bogus\"/>") PIECE "</svg>", TZ_FORMAT,
         "clip path"},
        {ROOT IMAGE("p.jpg") CLIP("<path d=\"M0 0 1e30 1 2 2Z\"/>") PIECE "</svg>",
         TZ_FORMAT, "beyond"},
        {ROOT IMAGE("p.jpg") CLIP("<use xlink:href=\"#b0\"/>") PIECE "</svg>", TZ_FORMAT,
         "clip path"},
        {ROOT IMAGE("p.jpg") CLIP("<use id=\"u\" xlink:href=\"#u\"/>") PIECE "</svg>",
         TZ_FORMAT, "clip path"},
        {ROOT IMAGE(
             "p.jpg") "<clipPath id=\"b0\" clipPathUnits=\"objectBoundingBox\"><rect "
                      "width=\"1\" height=\"1\"/></clipPath>" PIECE "</svg>",
         TZ_FORMAT, "userSpaceOnUse"},
        {"<!DOCTYPE svg [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;\">]>\n" ROOT
         "<g>&b;</g></svg>",
         TZ_FORMAT, "l.svg"},
        {"<!DOCTYPE svg [<!ENTITY x SYSTEM \"file:///etc/passwd\">]>\n" ROOT
         "<g>&x;</g></svg>",
         TZ_FORMAT, "l.svg"},
    };
    for (size_t i = 0; i < sizeof t / sizeof *t; i++) {
        char message[1000];
        tz_status st = parse(t[i].text, strlen(t[i].text), message);
        if (st != t[i].status || !strstr(message, t[i].says) || !strstr(message, "l.svg"))
            fail_msg("case %zu: status %d, message \"%s\", expected \"%s\"", i, st,
                     message, t[i].says);
        assert_null(strchr(message, '\n'));
    }
}

/** Uses of uses: 20 levels of 8 each would draw 8^20 things. */
static void test_use_bomb(void **state)
{
    (void)state;
    char message[1000], *text = malloc(100000);
    size_t n = (size_t)sprintf(text, ROOT DEFS "<defs><g id=\"g0\">" PIECE "</g>");
    for (int i = 1; i <= 20; i++) {
        n += (size_t)sprintf(text + n, "<g id=\"g%d\">", i);
        for (int k = 0; k < 8; k++)
            n += (size_t)sprintf(text + n, "<use xlink:href=\"#g%d\"/>", i - 1);
        n += (size_t)sprintf(text + n, "</g>");
    }
    n += (size_t)sprintf(text + n, "</defs><use xlink:href=\"#g20\"/></svg>");
    clock_t start = clock();
    assert_int_equal(parse(text, n, message), TZ_LIMIT);
    double s = (double)(clock() - start) / CLOCKS_PER_SEC;
    print_message("use bomb refused after %.2f s: %s\n", s, message);
    free(text);
}

static void test_deep_nesting(void **state)
{
    (void)state;
    enum { DEPTH = 20000 };
    char message[1000], *text = malloc(DEPTH * 10 + 2000);
    size_t n = (size_t)sprintf(text, ROOT DEFS);
    for (int i = 0; i < DEPTH; i++)
        n += (size_t)sprintf(text + n, "<g>");
    for (int i = 0; i < DEPTH; i++)
        n += (size_t)sprintf(text + n, "</g>");
    n += (size_t)sprintf(text + n, "</svg>");
    tz_status st = parse(text, n, message);
    assert_true(st == TZ_LIMIT || st == TZ_FORMAT);
    /* a chain of uses is deep without being nested */
    n = (size_t)sprintf(text, ROOT DEFS "<g id=\"g0\">" PIECE "</g>");
    for (int i = 1; i < 400; i++)
        n += (size_t)sprintf(text + n, "<use id=\"g%d\" xlink:href=\"#g%d\"/>", i, i - 1);
    n += (size_t)sprintf(text + n, "</svg>");
    assert_int_equal(parse(text, n, message), TZ_LIMIT);
    free(text);
}

/** Cut anywhere, a document is refused or read, never more. */
static void test_truncated(void **state)
{
    (void)state;
    static const char text[] =
        ROOT DEFS "<g transform=\"translate(3)\" tz:group=\"2\">" PIECE "</g></svg>";
    char message[1000];
    for (size_t n = 0; n < sizeof text - 1; n++)
        assert_int_equal(parse(text, n, message), TZ_FORMAT);
    assert_int_equal(parse(text, sizeof text - 1, message), TZ_OK);
}

/** Random bytes changed. */
static void test_mutations(void **state)
{
    (void)state;
    static const char text[] =
        ROOT DEFS "<g transform=\"translate(3)\" tz:group=\"2\">" PIECE "</g></svg>";
    char copy[sizeof text], message[1000];
    uint32_t r = 12345;
    for (int i = 0; i < 20000; i++) {
        memcpy(copy, text, sizeof text);
        for (int k = 0; k < 3; k++) {
            r = r * 1664525u + 1013904223u;
            copy[(r >> 8) % (sizeof text - 1)] =
                "0123456789<>/\"'=# -.eZMznx&;:"[(r >> 3) % 29];
        }
        parse(copy, sizeof text - 1, message);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_messages),     cmocka_unit_test(test_use_bomb),
        cmocka_unit_test(test_deep_nesting), cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_mutations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
