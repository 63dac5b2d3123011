/* SPDX-License-Identifier: Apache-2.0 */
/* What a window shows of a field. Ways along edges are estimated as life times are: a
 * place on a line looks along its edge; it sees the end (an event) or, before that, the
 * border (it drops out). A stretch of length L, both ways, is
 *
 *   at risk after the way t:  2 (L - t)      events up to t:  t for each real end
 *
 * and the survival is the product over the steps of (1 - events / at risk). An edge cut by
 * the border is thus neither left out nor taken for a short one. A whole loop ends where
 * it comes back. */
#include "curves/curve_statistics.h"

#include <string.h>

#define LEAST 0.005        /* share of all places that must be left to tell */
#define BLUNT (TZ_PI / 45) /* turns that no eye sees as such */
#define KEEN  (TZ_PI / 18) /* from here on, turns are told apart by their ratio */

typedef struct risk {
    double step, at[TZ_LINEWORK_WAYS + 1], events[TZ_LINEWORK_WAYS];
} risk;

static void add_stretch(risk *r, double length, int ends)
{
    for (int k = 0; k < TZ_LINEWORK_WAYS && k * r->step < length; k++) {
        r->at[k] += 2 * (length - k * r->step);
        r->events[k] += ends * fmin(r->step, length - k * r->step);
    }
}

static void add_loop(risk *r, double length)
{
    for (int k = 0; k < TZ_LINEWORK_WAYS && k * r->step < length; k++) {
        r->at[k] += 2 * length;
        r->events[k] += (k + 1) * r->step >= length ? 2 * length : 0;
    }
}

static void survive(const risk *r, double out[TZ_LINEWORK_WAYS + 1])
{
    double s = 1;
    bool tells = r->at[0] > 0;
    for (int k = 0; k <= TZ_LINEWORK_WAYS; k++) {
        out[k] = tells ? s : NAN;
        if (k == TZ_LINEWORK_WAYS)
            break;
        if (s > 0.01) /* else all have ended: nobody is left to ask, nor needs to be */
            tells &= r->at[k] > LEAST * r->at[0];
        if (r->at[k] > 0)
            s *= 1 - fmin(1, r->events[k] / r->at[k]);
    }
}

/* Part [t0, t1] of a chord inside of the window; false = none. */
static bool clip(const tz_linework_chord *c, const tz_linework_window *w, double *t0,
                 double *t1)
{
    const double p[2] = {c->p.x, c->p.y}, q[2] = {c->q.x, c->q.y};
    const double lo[2] = {w->lo.x, w->lo.y}, hi[2] = {w->hi.x, w->hi.y};
    *t0 = 0, *t1 = 1;
    for (int k = 0; k < 2; k++) {
        const double d = q[k] - p[k];
        if (d == 0) {
            if (p[k] < lo[k] || p[k] >= hi[k])
                return false;
            continue;
        }
        const double a = (lo[k] - p[k]) / d, b = (hi[k] - p[k]) / d;
        *t0 = fmax(*t0, fmin(a, b));
        *t1 = fmin(*t1, fmax(a, b));
    }
    return c->inside && *t0 < *t1;
}

/* Adds to two neighbouring bins of a circle. */
static void add_round(double *bins, int32_t n, double at, double weight)
{
    const double x = at * n - 0.5, low = floor(x);
    const int32_t i = ((int32_t)low % n + n) % n;
    bins[i] += weight * (1 - (x - low));
    bins[(i + 1) % n] += weight * (x - low);
}

static void walk_edge(const tz_linework_field *f, const tz_linework_edge *e,
                      const tz_linework_window *w, risk *r, tz_linework_statistics *out)
{
    double run = 0; /* of the stretch that is being walked */
    bool open = false, begun = false, whole = true;
    for (int32_t k = e->chord; k < e->chord + e->chords; k++) {
        const tz_linework_chord *c = &f->chord.v[k];
        double t0, t1;
        if (!clip(c, w, &t0, &t1)) {
            if (open)
                add_stretch(r, run, begun);
            open = whole = false;
            continue;
        }
        if (open && t0 > 0) /* it left just there */
            add_stretch(r, run, begun), open = false;
        if (!open) {
            run = 0;
            open = true;
            begun = k == e->chord && t0 == 0 && e->ends[0] && !e->loop;
        }
        const double length = (t1 - t0) * (double)c->length;
        run += length;
        out->length += length;
        add_round(out->orientation, TZ_LINEWORK_TURNS, (double)c->angle / TZ_PI, length);
        whole &= t0 == 0 && t1 == 1;
        if (t1 < 1)
            add_stretch(r, run, begun), open = false;
    }
    if (!open)
        return;
    if (e->loop && whole)
        add_loop(r, run);
    else
        add_stretch(r, run, begun + (e->ends[1] && !e->loop));
}

static bool within(const tz_linework_window *w, tz_vec2 p)
{
    return p.x >= w->lo.x && p.y >= w->lo.y && p.x < w->hi.x && p.y < w->hi.y;
}

static void normalise(double *v, int32_t n)
{
    double sum = 0;
    for (int32_t k = 0; k < n; k++)
        sum += v[k];
    for (int32_t k = 0; k < n && sum > 0; k++)
        v[k] /= sum;
}

static void count_nodes(const tz_linework_field *f, const tz_linework_window *w,
                        tz_linework_statistics *out)
{
    for (int32_t i = 0; i < f->node.n; i++) {
        const int32_t d = f->node.v[i].degree;
        if (within(w, f->node.v[i].at))
            out->nodes[d < TZ_CURVE_DEGREES ? d - 1 : TZ_CURVE_DEGREES - 1]++;
    }
}

/* Place of a turn among the bins: as an eye tells turns apart. Those of a degree or so are
 * none, the noise of samples; from some degrees on it is their ratio that counts. */
static double turn_bin(double angle)
{
    const double seen = hypot(angle, BLUNT) - BLUNT;
    return log1p(seen / KEEN) / log1p((hypot(TZ_PI, BLUNT) - BLUNT) / KEEN) *
           (TZ_LINEWORK_ANGLES - 1);
}

static void count_turns(const tz_linework_field *f, const tz_linework_window *w,
                        tz_linework_statistics *out)
{
    double all[TZ_LINEWORK_LAGS] = {0};
    for (int32_t i = 0; i < f->turn.n; i++) {
        const tz_linework_turn *t = &f->turn.v[i];
        if (!within(w, t->at))
            continue;
        for (int k = 0; k < TZ_LINEWORK_LAGS; k++) {
            const bool open = (double)t->depth > f->scale.lag[k];
            all[k] += open;
            if (isnan(t->angle[k]))
                continue;
            const double x = turn_bin((double)t->angle[k]);
            out->told[k] += open;
            const int32_t b =
                x < TZ_LINEWORK_ANGLES - 2 ? (int32_t)x : TZ_LINEWORK_ANGLES - 2;
            out->turning[k][b] += 1 - (x - b);
            out->turning[k][b + 1] += x - b;
        }
    }
    for (int k = 0; k < TZ_LINEWORK_LAGS; k++) {
        normalise(out->turning[k], TZ_LINEWORK_ANGLES);
        out->told[k] = all[k] > 0 ? out->told[k] / all[k] : 0;
    }
}

static double area_of(const tz_linework_field *f, const tz_linework_window *w)
{
    const double x = w->hi.x - w->lo.x, y = w->hi.y - w->lo.y;
    const int32_t n = 128;
    int32_t inside = 0;
    if (!f->domain.region)
        return x * y;
    if (w->lo.x <= 0 && w->lo.y <= 0 && w->hi.x >= f->domain.size.x &&
        w->hi.y >= f->domain.size.y)
        return f->domain.region->area;
    for (int32_t i = 0; i < n * n; i++) {
        const tz_vec3 at = {w->lo.x + (i % n + 0.5) / n * x,
                            w->lo.y + ((double)(i / n) + 0.5) / n * y, 0};
        inside += tz_region_distance(f->domain.region, at) > 0;
    }
    return x * y * inside / (n * n);
}

void tz_linework_statistics_of(const tz_linework_field *f, tz_linework_window w,
                               tz_linework_statistics *out)
{
    risk r = {.step = f->scale.way / TZ_LINEWORK_WAYS};
    const double e = TZ_LINEWORK_ROUNDING * f->scale.unit;
    *out = (tz_linework_statistics){.area = area_of(f, &w)};
    w = (tz_linework_window){{w.lo.x - e, w.lo.y - e}, {w.hi.x - e, w.hi.y - e}};
    for (int32_t i = 0; i < f->edge.n; i++)
        walk_edge(f, &f->edge.v[i], &w, &r, out);
    survive(&r, out->survival);
    normalise(out->orientation, TZ_LINEWORK_TURNS);
    count_nodes(f, &w, out);
    count_turns(f, &w, out);
}
