/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Procedural rules: which rule holds at a point.
 *
 * A feathered border is one method for polygons and masks alike: the point is first moved
 * by a random offset from the disc of diameter `feather`, then tested against the hard
 * shape. A point at signed distance d from a straight border is then inside with the
 * share of the disc that lies beyond it, which runs smoothly from 0 at -feather/2 to 1 at
 * +feather/2. One number u is enough for the two-dimensional offset: a Fermat spiral
 * (radius sqrt u, many turns) fills the disc evenly. Points are kept inside the layout,
 * so that shapes which end at its border are not thinned out there. */
#include "synthesis/rules.h"

#define SPIRAL_TURNS 1618.0339887

tz_status tz_rules_default(tz_ctx *ctx, tz_rules *r)
{
    tz_rule rule = tz_rule_default();
    tz_rules out = {.ctx = ctx};
    tz_status st = tz_array_push(ctx, &out.rule, rule);
    if (!st)
        *r = out;
    return st;
}

tz_rule tz_rule_default(void)
{
    return (tz_rule){.name = "default",
                     .mask = -1,
                     .structure = TZ_STRUCTURE_EXEMPLAR,
                     .size = {0, INFINITY},
                     .rotation = {NAN, NAN},
                     .field = -1,
                     .scale = {NAN, NAN},
                     .density = 1,
                     .length_bins = ~0u,
                     .angle_bins = ~0u,
                     .source = -1};
}

void tz_rules_deinit(tz_rules *r)
{
    for (int32_t i = 0; i < r->rule.n; i++) {
        tz_array_free(r->ctx, &r->rule.v[i].shape);
        tz_array_free(r->ctx, &r->rule.v[i].groups);
    }
    for (int32_t i = 0; i < r->mask.n; i++)
        tz_image_deinit(&r->mask.v[i]);
    tz_array_free(r->ctx, &r->rule);
    tz_array_free(r->ctx, &r->mask);
    *r = (tz_rules){0};
}

/** NaN gives lo. */
static double clamp(double v, double lo, double hi)
{
    return v > lo ? (v < hi ? v : hi) : lo;
}

/** Even-odd rule, half open. x, y in units of the layout. */
static bool in_polygon(const tz_vec2 *v, int32_t n, double x, double y)
{
    bool in = false;
    for (int32_t i = 0, j = n - 1; i < n; j = i++)
        if ((v[i].y > y) != (v[j].y > y) &&
            x < (v[j].x - v[i].x) * (y - v[i].y) / (v[j].y - v[i].y) + v[i].x)
            in = !in;
    return in;
}

/** Four neighbours and weights of a bilinear look-up at (x, y) in 0..1. */
static void taps(const tz_image *im, double x, double y, const float *px[4], double wt[4])
{
    double u = clamp(x * im->width - 0.5, 0, im->width - 1);
    double v = clamp(y * im->height - 0.5, 0, im->height - 1);
    int32_t i = (int32_t)u, j = (int32_t)v;
    int32_t i1 = i + 1 < im->width ? i + 1 : i, j1 = j + 1 < im->height ? j + 1 : j;
    u -= i;
    v -= j;
    px[0] = tz_image_at(im, i, j);
    px[1] = tz_image_at(im, i1, j);
    px[2] = tz_image_at(im, i, j1);
    px[3] = tz_image_at(im, i1, j1);
    wt[0] = (1 - u) * (1 - v);
    wt[1] = u * (1 - v);
    wt[2] = (1 - u) * v;
    wt[3] = u * v;
}

/** Channels that carry values, i.e. without alpha. */
static int32_t value_channels(const tz_image *im)
{
    return im->alpha >= 0 && im->channels > 1 ? im->channels - 1 : im->channels;
}

/** Grey of a mask: mean of up to three value channels, times alpha. */
static double grey(const tz_image *im, const float *px)
{
    int32_t n = value_channels(im);
    double sum = px[0];
    if (n >= 3)
        sum = (px[0] + px[1] + px[2]) / 3.0;
    return im->alpha > 0 && im->alpha < im->channels ? sum * px[im->alpha] : sum;
}

static bool in_mask(const tz_image *im, double x, double y)
{
    const float *px[4];
    double wt[4], sum = 0;
    taps(im, x, y, px, wt);
    for (int k = 0; k < 4; k++)
        sum += wt[k] * grey(im, px[k]);
    return sum > 0.5;
}

int32_t tz_rules_at(const tz_rules *r, int32_t w, int32_t h, tz_vec2 p, double u)
{
    double turn = 2 * TZ_PI * (u * SPIRAL_TURNS - floor(u * SPIRAL_TURNS));
    double radius = sqrt(clamp(u, 0, 1)), dx = radius * cos(turn),
           dy = radius * sin(turn);
    for (int32_t i = r->rule.n - 1; i > 0; i--) {
        const tz_rule *q = &r->rule.v[i];
        if (!q->shape.n && q->mask < 0)
            return i;
        double x = clamp((p.x + 0.5 * q->feather * dx) / w, 0, 1 - 1e-9);
        double y = clamp((p.y + 0.5 * q->feather * dy) / h, 0, 1 - 1e-9);
        if (q->shape.n && !in_polygon(q->shape.v, q->shape.n, x, y))
            continue;
        if (q->mask >= 0 && !in_mask(&r->mask.v[q->mask], x, y))
            continue;
        return i;
    }
    return 0;
}

double tz_rules_field(const tz_rules *r, int32_t rule, int32_t w, int32_t h, tz_vec2 p)
{
    int32_t field = r->rule.v[rule].field;
    if (field < 0)
        return 0;
    const tz_image *im = &r->mask.v[field];
    bool vector = value_channels(im) >= 2;
    const float *px[4];
    double wt[4], x = 0, y = 0;
    taps(im, p.x / w, p.y / h, px, wt);
    /* blended as directions, because angles do not blend across 2 pi */
    for (int k = 0; k < 4; k++) {
        double a = 2 * TZ_PI * px[k][0];
        x += wt[k] * (vector ? 2.0 * px[k][0] - 1 : cos(a));
        y += wt[k] * (vector ? 2.0 * px[k][1] - 1 : sin(a));
    }
    return x * x + y * y > 1e-12 ? atan2(y, x) : 0;
}
