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
    COARSE = 4,
    VALUES = SIDE * SIDE,
    COARSES = COARSE * COARSE,
    QUERIES = 128,
    MOST_PLACES = 16384,
    MOST_TRIES = 64,
    FEW = 12,   /* places of the grid that are looked at closely */
    REFINED = 3 /* and about */
};

typedef struct search {
    const tz_linework_field *f;
    const tz_linework_raster *r;
    double patch, unit, step;
    int32_t n;
    tz_vec2 *at;   /* places of the grid */
    float *value;  /* n * COARSES */
    float *wanted; /* QUERIES * VALUES */
    float *coarse; /* QUERIES * COARSES */
    double *best;  /* of queries */
} search;

/* Where a coordinate lies between two pixels. */
typedef struct between {
    int32_t i, j;
    float t;
} between;

static between between_pixels(double x, double origin, double pixel, int32_t n)
{
    const double u = fmin(fmax((x - origin) / pixel - 0.5, 0), n - 1);
    const int32_t i = (int32_t)u;
    return (between){i, i + 1 < n ? i + 1 : i, (float)(u - i)};
}

static float blend(const tz_linework_raster *r, between x, between y)
{
    const float *p = r->distance + (int64_t)y.i * r->width,
                *q = r->distance + (int64_t)y.j * r->width;
    const float a = p[x.i] + x.t * (p[x.j] - p[x.i]),
                b = q[x.i] + x.t * (q[x.j] - q[x.i]);
    return a + y.t * (b - a);
}

/* Distances to the next line about a place, over the unit. */
static void take(const tz_linework_field *f, const tz_linework_raster *r, tz_vec2 at,
                 double patch, double unit, int32_t side, float *out)
{
    const float scale = (float)(1 / unit);
    between x[SIDE], y[SIDE];
    if (!f->domain.frames) {
        for (int k = 0; k < side; k++) {
            const double u = (k - 0.5 * (side - 1)) * patch / side;
            x[k] = between_pixels(at.x + u, r->origin.x, r->pixel, r->width);
            y[k] = between_pixels(at.y + u, r->origin.y, r->pixel, r->height);
        }
        for (int k = 0; k < side * side; k++)
            out[k] = scale * blend(r, x[k % side], y[k / side]);
        return;
    }
    const double turn = tz_domain_frame(&f->domain, (tz_vec3){at.x, at.y, 0});
    const double c = cos(turn) * patch / side, s = sin(turn) * patch / side;
    for (int k = 0; k < side * side; k++) {
        const double u = k % side - 0.5 * (side - 1), v = k / side - 0.5 * (side - 1);
        out[k] =
            scale *
            blend(r,
                  between_pixels(at.x + c * u - s * v, r->origin.x, r->pixel, r->width),
                  between_pixels(at.y + s * u + c * v, r->origin.y, r->pixel, r->height));
    }
}

static float apart(const float *a, const float *b, int32_t n)
{
    float sum[8] = {0}, all = 0;
    for (int k = 0; k < n; k += 8)
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
        s = tz_alloc(k->f->ctx, &k->value, n * COARSES, sizeof *k->value);
    for (int32_t i = 0; s == TZ_OK && i < nx * ny; i++) {
        const tz_vec2 at = {w.lo.x + i % nx * k->step,
                            w.lo.y + (double)(i / nx) * k->step};
        if (!fits(k->f, at, k->patch))
            continue;
        k->at[k->n] = at;
        take(k->f, k->r, at, k->patch, k->unit, COARSE,
             k->value + (size_t)k->n++ * COARSES);
    }
    return s;
}

/* The best near a place of the grid. */
static float refine(const search *k, const float *wanted, tz_vec2 at, float best)
{
    double step = k->step / 2;
    float value[VALUES];
    for (int tries = 0; tries < MOST_TRIES && step > 0.06 * k->r->pixel && best > 0;
         tries++) {
        tz_vec2 to = at;
        for (int m = 0; m < 9; m += 1 + (m == 3)) {
            const tz_vec2 p = {at.x + (m % 3 - 1) * step, at.y + (m / 3 - 1) * step};
            take(k->f, k->r, p, k->patch, k->unit, SIDE, value);
            const float d = apart(wanted, value, VALUES);
            if (d < best)
                best = d, to = p;
        }
        if (to.x == at.x && to.y == at.y)
            step /= 2;
        at = to;
    }
    return best;
}

/* Keeps the FEW nearest places, nearest first. @return how many there are */
static int32_t keep(float near[FEW], tz_vec2 at[FEW], int32_t n, float d, tz_vec2 p)
{
    if (n == FEW && !(d < near[n - 1]))
        return n;
    int32_t m = n < FEW ? n : n - 1;
    for (; m > 0 && d < near[m - 1]; m--)
        near[m] = near[m - 1], at[m] = at[m - 1];
    near[m] = d, at[m] = p;
    return n < FEW ? n + 1 : n;
}

/* The few best of the grid by coarse patches, the best of these by the whole ones. */
static tz_status find(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    search *k = arg;
    const float *wanted = k->wanted + i * VALUES, *coarse = k->coarse + i * COARSES;
    float near[FEW], fine[FEW], value[VALUES], best = INFINITY;
    tz_vec2 at[FEW], best_at[FEW];
    int32_t n = 0, m = 0;
    (void)ctx, (void)worker;
    for (int32_t j = 0; j < k->n; j++)
        n = keep(near, at, n, apart(coarse, k->value + (size_t)j * COARSES, COARSES),
                 k->at[j]);
    for (int32_t j = 0; j < n; j++) {
        take(k->f, k->r, at[j], k->patch, k->unit, SIDE, value);
        m = keep(fine, best_at, m, apart(wanted, value, VALUES), at[j]);
    }
    for (int32_t j = 0; j < m && j < REFINED; j++)
        best = fminf(best, refine(k, wanted, best_at[j], fine[j]));
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
        s = tz_alloc(fa->ctx, &k.coarse, (size_t)QUERIES * COARSES, sizeof *k.coarse);
    if (s == TZ_OK)
        s = tz_alloc(fa->ctx, &k.best, QUERIES, sizeof *k.best);
    if (s != TZ_OK)
        goto done;
    for (int32_t i = 0; i < 8 * QUERIES && n < QUERIES; i++) {
        const double x = tz_rng_range(&rng, ra.lo.x, ra.hi.x),
                     y = tz_rng_range(&rng, ra.lo.y, ra.hi.y);
        const tz_vec2 at = {x, y};
        if (!fits(fa, at, patch))
            continue;
        take(fa, a, at, patch, unit, SIDE, k.wanted + (size_t)n * VALUES);
        take(fa, a, at, patch, unit, COARSE, k.coarse + (size_t)n++ * COARSES);
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
    tz_free(fa->ctx, k.coarse);
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
