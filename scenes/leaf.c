/* SPDX-License-Identifier: Apache-2.0 */
/* Outlines of leaves. Along the midrib, t from 0 at the base to 1 at the tip:
 *
 *   half width(t) = width * sin(pi t^bow)^tip * lobes(t) * teeth(t) * noise(t)
 *
 * and of star-shaped ones round the end of the stalk, the longest of the lobes' rays. */
#include "scenes/leaf.h"

void tz_leaf_species_draw(tz_rng *r, double length, tz_leaf_species *s)
{
    *s = (tz_leaf_species){.length = length, .tip = tz_rng_range(r, 0.7, 1.3)};
    double kind = tz_rng_unit(r);
    s->kind = kind < 0.4    ? TZ_LEAF_OVAL
              : kind < 0.72 ? TZ_LEAF_LOBED
              : kind < 0.88 ? TZ_LEAF_STAR
                            : TZ_LEAF_BLADE;
    s->width = tz_shape_log_range(r, 0.1, 0.42);
    s->bow = tz_rng_range(r, 0.65, 1.4);
    s->rough = tz_shape_log_range(r, 0.02, 0.2);
    s->bend = 0.25 * tz_rng_unit(r);
    s->squash = tz_rng_range(r, 0.4, 0.95);
    s->stalk = tz_shape_chance(r, 0.6) ? tz_rng_range(r, 0.08, 0.5) : 0;
    s->veins = tz_shape_chance(r, 0.75) ? 5 + tz_rng_below(r, 9) : 0;
    if (tz_shape_chance(r, 0.5)) {
        s->teeth = 8 + tz_rng_below(r, 26);
        s->tooth_depth = tz_rng_range(r, 0.05, 0.2);
    }
    if (s->kind == TZ_LEAF_LOBED) {
        s->lobes = 2 + tz_rng_below(r, 4);
        s->lobe_depth = tz_rng_range(r, 0.25, 0.7);
        s->width = tz_rng_range(r, 0.26, 0.42);
    } else if (s->kind == TZ_LEAF_STAR) {
        s->lobes = 3 + 2 * tz_rng_below(r, 3);
        s->lobe_depth = tz_rng_range(r, 0.12, 0.4);
    } else if (s->kind == TZ_LEAF_BLADE) {
        s->width = tz_shape_log_range(r, 0.012, 0.05);
        s->length *= 1.6;
        s->bend = 0.5 * tz_rng_unit(r);
        s->stalk = 0, s->veins = 0, s->teeth = 0;
    }
}

static double wobble(uint64_t seed, double t)
{
    return (double)tz_canvas_noise(seed, 5 * t, 0.5) +
           0.5 * (double)tz_canvas_noise(seed, 14 * t, 7.5) +
           0.35 * (double)tz_canvas_noise(seed, 41 * t, 3.5);
}

static double sawtooth(double t) { return t - floor(t); }

static void draw_sides(tz_rng *r, const tz_leaf_species *s, tz_leaf *leaf)
{
    double phase = tz_rng_unit(r), lobe_phase = tz_rng_range(r, 0.3, 0.7);
    double teeth = s->tooth_depth * (s->teeth && leaf->length / s->teeth > 6);
    for (int side = 0; side < 2; side++) {
        uint64_t seed = tz_rng_u64(r);
        double bite = tz_shape_chance(r, 0.15) ? tz_rng_unit(r) : 9;
        double shift = lobe_phase + 0.12 * tz_rng_normal(r);
        double grow = exp(0.08 * tz_rng_normal(r));
        for (int i = 0; i < TZ_LEAF_TABLE; i++) {
            double t = (double)i / (TZ_LEAF_TABLE - 1);
            double w = pow(sin(TZ_PI * pow(t, s->bow)) + 1e-9, s->tip);
            if (s->kind == TZ_LEAF_BLADE)
                w = fmin(1, fmin(12 * t + 0.3, 5 * (1 - t)));
            if (s->kind == TZ_LEAF_LOBED) {
                double bow = 0.5 - 0.5 * cos(2 * TZ_PI * (s->lobes * t + shift));
                w *= 1 - s->lobe_depth * bow * (1 - 0.6 * fabs(2 * t - 1));
            }
            w *= 1 - teeth * sawtooth(-s->teeth * t + phase);
            w *= 1 + s->rough * wobble(seed, t);
            w *= 1 - 0.7 * exp(-(t - bite) * (t - bite) * 300);
            leaf->side[side][i] = (float)(leaf->length * s->width * grow * fmax(w, 0));
        }
    }
}

/* Both tables together are one turn: angle -pi at side[0][0], +pi at the end. */
static void draw_star(tz_rng *r, const tz_leaf_species *s, tz_leaf *leaf)
{
    uint64_t seed = tz_rng_u64(r);
    double open = tz_rng_range(r, 0.3, 0.55), narrow = 1.2 + 6 * s->lobe_depth;
    double teeth = s->tooth_depth * (s->teeth && leaf->length / s->teeth > 5);
    for (int i = 0; i < 2 * TZ_LEAF_TABLE; i++) {
        double angle = TZ_PI * ((double)i / TZ_LEAF_TABLE - 1), far = 0.16;
        for (int j = 0; j < s->lobes; j++) {
            double out = j - 0.5 * (s->lobes - 1),
                   d = angle - out * open * 5 / s->lobes * 1.5;
            double ray = 1 - 0.16 * out * out * 9 / (s->lobes * s->lobes) * 2;
            far = fmax(far, ray / (1 + narrow * narrow * d * d * 2));
        }
        far *= 1 - teeth * 2 * sawtooth(s->teeth * fabs(angle));
        far *= 1 + s->rough * wobble(seed, 1.5 * angle);
        leaf->side[i / TZ_LEAF_TABLE][i % TZ_LEAF_TABLE] =
            (float)(0.8 * leaf->length * fmax(far, 0.03));
    }
}

void tz_leaf_draw(tz_rng *r, const tz_leaf_species *s, tz_vec2 middle, double angle,
                  tz_leaf *leaf)
{
    *leaf = (tz_leaf){.kind = s->kind, .co = cos(angle), .si = sin(angle)};
    leaf->length = s->length * exp(0.25 * tz_rng_normal(r));
    leaf->bend = s->bend * tz_rng_normal(r) / leaf->length;
    leaf->squash = tz_rng_range(r, s->squash, 1);
    leaf->stalk = s->stalk * leaf->length;
    leaf->stalk_half = fmin(3.5, 0.8 + 0.008 * leaf->length);
    double back = s->kind == TZ_LEAF_STAR ? 0.25 : 0.5;
    leaf->at = (tz_vec2){middle.x - back * leaf->length * leaf->co,
                         middle.y - back * leaf->length * leaf->si};
    leaf->reach = leaf->length * (1.05 + 1.2 * fabs(leaf->bend) * leaf->length);
    if (s->kind == TZ_LEAF_STAR)
        draw_star(r, s, leaf);
    else
        draw_sides(r, s, leaf);
    leaf->widest = leaf->length;
    if (s->kind != TZ_LEAF_STAR) {
        leaf->widest = leaf->stalk_half;
        for (int i = 0; i < 2 * TZ_LEAF_TABLE; i++)
            leaf->widest = fmax(leaf->widest,
                                (double)leaf->side[i / TZ_LEAF_TABLE][i % TZ_LEAF_TABLE]);
        double far = fmax(leaf->length, leaf->stalk);
        leaf->widest += fabs(leaf->bend) * far * far + 1;
    }
}

/* Where row y meets the rectangle -u0 <= u <= u1, |w| <= widest about the midrib's
 * chord. */
void tz_leaf_span(const tz_leaf *leaf, double y, double *x0, double *x1)
{
    double dy = y - leaf->at.y,
           back = leaf->kind == TZ_LEAF_STAR ? leaf->length : leaf->stalk;
    const double slope[2] = {leaf->co, -leaf->si};
    const double at[2] = {leaf->si * dy, leaf->co * dy};
    const double lo[2] = {-back - 1, -leaf->widest},
                 hi[2] = {leaf->length + 1, leaf->widest};
    for (int i = 0; i < 2; i++) {
        if (fabs(slope[i]) < 1e-6) {
            if (at[i] < lo[i] || at[i] > hi[i])
                *x1 = *x0;
            continue;
        }
        double a = (lo[i] - at[i]) / slope[i], b = (hi[i] - at[i]) / slope[i];
        *x0 = fmax(*x0, leaf->at.x + fmin(a, b) - 1);
        *x1 = fmin(*x1, leaf->at.x + fmax(a, b) + 1);
    }
}

static double table(const float *v, double at, double *slope)
{
    int i = at < 0 ? 0 : at > TZ_LEAF_TABLE - 2 ? TZ_LEAF_TABLE - 2 : (int)at;
    *slope = (double)(v[i + 1] - v[i]);
    return (double)v[i] + (at - i) * *slope;
}

static bool star_at(const tz_leaf *leaf, double u, double v, tz_leaf_spot *spot)
{
    double rho = sqrt(u * u + v * v);
    if (rho > leaf->length)
        return false;
    double at = (atan2(v, u) / TZ_PI + 1) * TZ_LEAF_TABLE, slope;
    const float *all = leaf->side[0]; /* both sides lie one after the other */
    int i = (int)at, last = 2 * TZ_LEAF_TABLE - 1;
    i = i > last ? last : i;
    double a = (double)all[i], b = (double)all[i == last ? 0 : i + 1];
    slope = (b - a) * TZ_LEAF_TABLE / TZ_PI / fmax(rho, 1);
    spot->edge = (a + (at - i) * (b - a) - rho) / sqrt(1 + slope * slope);
    return spot->edge > 0;
}

bool tz_leaf_at(const tz_leaf *leaf, double x, double y, tz_leaf_spot *spot)
{
    double dx = x - leaf->at.x, dy = y - leaf->at.y;
    double u = leaf->co * dx + leaf->si * dy;
    double v = (-leaf->si * dx + leaf->co * dy) / leaf->squash - leaf->bend * u * u;
    *spot = (tz_leaf_spot){.u = u, .v = v};
    if (leaf->kind == TZ_LEAF_STAR ? star_at(leaf, u, v, spot) : false)
        return true;
    if (u < 0 && u > -leaf->stalk && fabs(v) < leaf->stalk_half) {
        spot->stalk = true;
        spot->edge = leaf->stalk_half - fabs(v);
        return true;
    }
    if (leaf->kind == TZ_LEAF_STAR || u <= 0 || u >= leaf->length)
        return false;
    double slope, step = leaf->length / (TZ_LEAF_TABLE - 1);
    double w = table(leaf->side[v > 0], u / step, &slope) - fabs(v);
    if (w <= 0)
        return false;
    slope /= step;
    spot->edge = w * leaf->squash / sqrt(1 + slope * slope);
    return true;
}
