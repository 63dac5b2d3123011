/* SPDX-License-Identifier: Apache-2.0 */
/* Patches of the distance transform: each of some places of one field against all of a
 * grid of places of the other, the best then moved about until nothing near is better, so
 * that the grid's coarseness does not count. Both ways: what is there must be the
 * exemplar's, and what the exemplar has must be there.
 * @source Simakov, Caspi, Shechtman, Irani: Summarizing visual data using bidirectional
 *   similarity, CVPR 2008 */
#include "base/rng.h"
#include "curves/curve_statistics.h"

enum {
    SIDE = 8,
    VALUES = SIDE * SIDE,
    QUERIES = 128,
    MOST_PLACES = 4096,
    MOST_TRIES = 64,
    FEW = 4 /* places of the grid that are looked about */
};

typedef struct search {
    const tz_linework_field *f;
    const tz_linework_raster *r;
    double patch, unit, step;
    int32_t n;
    tz_vec2 *at;   /* places of the grid */
    float *value;  /* n * VALUES */
    float *wanted; /* QUERIES * VALUES */
    double *best;  /* of queries */
} search;

/* The distance to the next line, over the unit. */
static float sample(const tz_linework_raster *r, double unit, double x, double y)
{
    const double u = fmin(fmax((x - r->origin.x) / r->pixel - 0.5, 0), r->width - 1),
                 v = fmin(fmax((y - r->origin.y) / r->pixel - 0.5, 0), r->height - 1);
    const int32_t i = (int32_t)u, j = (int32_t)v, w = r->width;
    const int32_t i1 = i + 1 < w ? i + 1 : i, j1 = j + 1 < r->height ? j + 1 : j;
    const double s = u - i, t = v - j;
    const float *p = r->distance + (int64_t)j * w, *q = r->distance + (int64_t)j1 * w;
    const double d = ((double)p[i] * (1 - s) + (double)p[i1] * s) * (1 - t) +
                     ((double)q[i] * (1 - s) + (double)q[i1] * s) * t;
    return (float)(d / unit);
}

static void take(const tz_linework_field *f, const tz_linework_raster *r, tz_vec2 at,
                 double patch, double unit, float *out)
{
    const double turn = tz_domain_frame(&f->domain, (tz_vec3){at.x, at.y, 0});
    const double c = cos(turn) * patch / SIDE, s = sin(turn) * patch / SIDE;
    for (int k = 0; k < VALUES; k++) {
        const double u = k % SIDE - 0.5 * (SIDE - 1), v = k / SIDE - 0.5 * (SIDE - 1);
        out[k] = sample(r, unit, at.x + c * u - s * v, at.y + s * u + c * v);
    }
}

static float apart(const float *a, const float *b)
{
    float sum[8] = {0}, all = 0;
    for (int k = 0; k < VALUES; k += 8)
        for (int i = 0; i < 8; i++) {
            const float d = a[k + i] - b[k + i];
            sum[i] += d * d;
        }
    for (int i = 0; i < 8; i++)
        all += sum[i];
    return all;
}

/* Where patches may lie: the window less their half. */
static tz_linework_window room(const tz_linework_field *f, const tz_linework_raster *r,
                               tz_linework_window w, double patch)
{
    const double half = patch * (f->domain.frames ? 0.7072 : 0.5);
    const tz_vec2 far = {r->origin.x + r->width * r->pixel,
                         r->origin.y + r->height * r->pixel};
    return (tz_linework_window){
        {fmax(w.lo.x, r->origin.x) + half, fmax(w.lo.y, r->origin.y) + half},
        {fmin(w.hi.x, far.x) - half, fmin(w.hi.y, far.y) - half}};
}

static bool fits(const tz_linework_field *f, tz_vec2 at, double patch)
{
    return !f->domain.region ||
           tz_region_distance(f->domain.region, (tz_vec3){at.x, at.y, 0}) > 0.5 * patch;
}

static tz_status fill_grid(search *k, tz_linework_window w)
{
    const double x = w.hi.x - w.lo.x, y = w.hi.y - w.lo.y;
    const int32_t nx = 1 + (int32_t)(x / k->step), ny = 1 + (int32_t)(y / k->step);
    const size_t n = (size_t)nx * (size_t)ny;
    tz_status s = tz_alloc(k->f->ctx, &k->at, n, sizeof *k->at);
    if (s == TZ_OK)
        s = tz_alloc(k->f->ctx, &k->value, n * VALUES, sizeof *k->value);
    for (int32_t i = 0; s == TZ_OK && i < nx * ny; i++) {
        const tz_vec2 at = {w.lo.x + i % nx * k->step,
                            w.lo.y + (double)(i / nx) * k->step};
        if (!fits(k->f, at, k->patch))
            continue;
        k->at[k->n] = at;
        take(k->f, k->r, at, k->patch, k->unit, k->value + (size_t)k->n++ * VALUES);
    }
    return s;
}

/* The best near a place of the grid. */
static float refine(const search *k, const float *wanted, tz_vec2 at, float best)
{
    double step = k->step / 2;
    float value[VALUES];
    for (int tries = 0; tries < MOST_TRIES && step > 0.03 * k->r->pixel; tries++) {
        tz_vec2 to = at;
        for (int m = 0; m < 9; m++) {
            const tz_vec2 p = {at.x + (m % 3 - 1) * step, at.y + (m / 3 - 1) * step};
            take(k->f, k->r, p, k->patch, k->unit, value);
            const float d = apart(wanted, value);
            if (d < best)
                best = d, to = p;
        }
        if (to.x == at.x && to.y == at.y)
            step /= 2;
        at = to;
    }
    return best;
}

static tz_status find(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    search *k = arg;
    const float *wanted = k->wanted + i * VALUES;
    float near[FEW], best = INFINITY;
    tz_vec2 at[FEW] = {{0, 0}};
    int32_t n = 0;
    (void)ctx, (void)worker;
    for (int32_t j = 0; j < k->n; j++) {
        const float d = apart(wanted, k->value + (size_t)j * VALUES);
        if (n == FEW && !(d < near[n - 1]))
            continue;
        int32_t m = n < FEW ? n++ : n - 1;
        for (; m > 0 && d < near[m - 1]; m--)
            near[m] = near[m - 1], at[m] = at[m - 1];
        near[m] = d, at[m] = k->at[j];
    }
    for (int32_t j = 0; j < n; j++)
        best = fminf(best, refine(k, wanted, at[j], near[j]));
    k->best[i] = sqrt((double)best / VALUES);
    return TZ_OK;
}

/* Patches of `a` at random, each against the most alike of `b`. */
static tz_status one_way(const tz_linework_field *fa, const tz_linework_raster *a,
                         tz_linework_window wa, const tz_linework_field *fb,
                         const tz_linework_raster *b, tz_linework_window wb,
                         int32_t places, double *out)
{
    const double patch = fb->scale.patch, unit = fb->scale.unit;
    const tz_linework_window ra = room(fa, a, wa, patch), rb = room(fb, b, wb, patch);
    const double all = fb->domain.size.x * fb->domain.size.y;
    search k = {.f = fb, .r = b, .patch = patch, .unit = unit};
    tz_rng rng = tz_rng_make(1, 1);
    int32_t n = 0;
    *out = NAN;
    if (!(ra.hi.x > ra.lo.x && ra.hi.y > ra.lo.y && rb.hi.x > rb.lo.x &&
          rb.hi.y > rb.lo.y))
        return TZ_OK;
    /* as fine for a part as for the whole */
    k.step = fmax(unit / 4, sqrt(all / places));
    tz_status s = fill_grid(&k, rb);
    if (s == TZ_OK)
        s = tz_alloc(fa->ctx, &k.wanted, (size_t)QUERIES * VALUES, sizeof *k.wanted);
    if (s == TZ_OK)
        s = tz_alloc(fa->ctx, &k.best, QUERIES, sizeof *k.best);
    if (s != TZ_OK)
        goto done;
    for (int32_t i = 0; i < 8 * QUERIES && n < QUERIES; i++) {
        const double x = tz_rng_range(&rng, ra.lo.x, ra.hi.x),
                     y = tz_rng_range(&rng, ra.lo.y, ra.hi.y);
        if (fits(fa, (tz_vec2){x, y}, patch))
            take(fa, a, (tz_vec2){x, y}, patch, unit, k.wanted + (size_t)n++ * VALUES);
    }
    if (n == 0 || k.n == 0)
        goto done;
    s = tz_parallel_for(fa->ctx, n, find, &k);
    double sum = 0;
    for (int32_t i = 0; s == TZ_OK && i < n; i++)
        sum += k.best[i];
    if (s == TZ_OK)
        *out = sum / n;
done:
    tz_free(fa->ctx, k.at);
    tz_free(fa->ctx, k.value);
    tz_free(fa->ctx, k.wanted);
    tz_free(fa->ctx, k.best);
    return s;
}

tz_status tz_linework_patches(const tz_linework_field *fa, const tz_linework_raster *a,
                              tz_linework_window wa, const tz_linework_field *fb,
                              const tz_linework_raster *b, tz_linework_window wb,
                              double *out)
{
    const double area_a = fa->domain.size.x * fa->domain.size.y,
                 area_b = fb->domain.size.x * fb->domain.size.y;
    double there = NAN, back = NAN;
    *out = NAN;
    const tz_status s = one_way(fa, a, wa, fb, b, wb, MOST_PLACES, &there);
    if (s != TZ_OK)
        return s;
    /* of a larger field as many as are of the other in the same area, in bounds */
    const double more = fmin(4, fmax(1, area_a / area_b));
    const tz_status t =
        one_way(fb, b, wb, fa, a, wa, (int32_t)(MOST_PLACES * more), &back);
    if (t == TZ_OK && !isnan(there) && !isnan(back))
        *out = (there + back) / 2;
    return t;
}
