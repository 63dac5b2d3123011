/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the tests of element fields share. Include after tests/base/check.h. */
#ifndef TZ_TESTS_FILLING_H
#define TZ_TESTS_FILLING_H

#include <math.h>
#include <string.h>
#include <time.h>

#include "elements/element_io.h"
#include "fields/fill.h"

/** A leaf, a disc and a bar, `scale` times as large. */
static inline tz_status filling_palette(tz_ctx *ctx, double scale, tz_element_set *s)
{
    char text[2048];
    snprintf(text, sizeof text,
             "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %g %g\">"
             "<g transform=\"scale(%g)\">"
             "<path d=\"M10,20 C15,15 24,15 30,20 C24,25 15,25 10,20Z\"/>"
             "<circle cx=\"60\" cy=\"20\" r=\"4\"/>"
             "<path d=\"M80,18 L112,18 L112,22 L80,22Z\"/></g></svg>",
             120 * scale, 40 * scale, scale);
    return tz_element_parse_svg(ctx, "palette", text, strlen(text), NULL, s);
}

static inline tz_fill_params filling_params(int32_t iterations)
{
    tz_fill_params p;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_fill_param_table, &p);
    p.iterations = iterations;
    return p;
}

/** One wavy stroke over a domain; `turned`: about its middle by a quarter turn. */
static inline tz_status filling_field(tz_ctx *ctx, tz_vec3 size, bool torus, bool turned,
                                      tz_element_field *f)
{
    tz_element_field_point p[24];
    const tz_element_field_stroke stroke = {
        .radius = 0.02 * size.x, .weight = 1, .directed = true};
    for (int k = 0; k < 24; k++) {
        const double x = (0.1 + 0.8 * k / 23) * size.x;
        const double y = (0.5 + 0.2 * sin(k * 0.27)) * size.y;
        p[k] = (tz_element_field_point){
            turned ? (tz_vec2){size.y - y, x} : (tz_vec2){x, y}, 0, -1};
    }
    tz_status s = tz_element_field_init(ctx, size, torus, 256, f);
    if (s == TZ_OK)
        s = tz_element_field_add(f, stroke, 24, p);
    if (s == TZ_OK)
        s = tz_element_field_settle(f);
    if (s != TZ_OK)
        tz_element_field_deinit(f);
    return s;
}

/* What is filled in most tests. */
typedef struct bed {
    tz_ctx *ctx;
    tz_element_set palette, layout;
    tz_element_field field;
    tz_domain domain;
    tz_fill_params params;
    tz_fill_job job;
} bed;

static inline void bed_lay(bed *b, int threads, double side, double scale,
                           int32_t iterations)
{
    memset(b, 0, sizeof *b);
    b->ctx = new_ctx(threads);
    b->domain = (tz_domain){.size = {side, side, 0}};
    b->params = filling_params(iterations);
    ok(b->ctx, filling_palette(b->ctx, scale, &b->palette));
    ok(b->ctx, filling_field(b->ctx, b->domain.size, false, false, &b->field));
    ok(b->ctx, tz_element_set_like(b->ctx, &b->palette, &b->domain, &b->layout));
    b->job = (tz_fill_job){.palette = &b->palette,
                           .domain = b->domain,
                           .field = &b->field,
                           .params = &b->params,
                           .seed = 3};
}

static inline void bed_clear(bed *b)
{
    tz_element_set_deinit(&b->palette);
    tz_element_set_deinit(&b->layout);
    tz_element_field_deinit(&b->field);
    end_ctx(b->ctx);
}

/* Whatever was asked for, a layout holds together. */
static inline void filling_sound(tz_ctx *ctx, const tz_element_set *layout)
{
    ok(ctx, tz_element_set_check(ctx, layout, "layout"));
    for (int32_t i = 0; i < layout->element.n; i++) {
        const tz_element *e = &layout->element.v[i];
        assert_true(isfinite(e->at.x) && isfinite(e->at.y) && isfinite(e->angle));
        assert_true(isfinite(e->scale) && e->scale > 0);
    }
    for (int32_t i = 0; i < layout->sample.n; i++)
        assert_true(isfinite(layout->sample.v[i].at.x) &&
                    isfinite(layout->sample.v[i].at.y));
}

/* All of it lies where it may. */
static inline void filling_inside(const tz_domain *d, const tz_element_set *layout)
{
    for (int32_t i = 0; i < layout->element.n; i++)
        assert_true(tz_domain_contains(d, layout->element.v[i].at));
}

/* Processor time, which the work of others on the machine does not lengthen. */
static inline double filling_seconds(void)
{
    struct timespec t = {0};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* No input may keep one busy for longer (sanitizers take their own time). */
static inline void filling_in_time(const char *what, double since)
{
    const double spent = filling_seconds() - since;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    const double most = 200;
#else
    const double most = 10;
#endif
    if (spent > most)
        fail_msg("%s took %.1f s", what, spent);
}

#endif
