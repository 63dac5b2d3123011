/* SPDX-License-Identifier: Apache-2.0 */
/* What is worth copying: the product of five goods, each 0..1, that say how far a thing is
 *
 *   sure         the certainty of the choice
 *   whole        little of it is hidden by others
 *   solid        its area fills its convex hull about as the others' do
 *   smooth       its outline is about as long, against the hull's, as the others' are
 *   no ground    its colour is likelier among the things' colours than among the ground's
 *   no crumb     it is not far smaller than the others
 *
 * "The others" are the better half by certainty and solidity. What is below GOOD is not
 * copied, unless too few would be left; then the best are. */
#include "analysis/things_doubt.h"

#include <math.h>
#include <stdlib.h>

#define GOOD   0.35
#define LIKELY 1.5 /* log likelihood ratio */

enum { ENOUGH = 12, SHARE = 3 };

typedef struct thing {
    double ragged, good;
} thing;

/* ---- shape --------------------------------------------------------------------------- */

static int by_place(const void *p, const void *q)
{
    const tz_vec2 *a = p, *b = q;
    if (a->x != b->x)
        return a->x < b->x ? -1 : 1;
    return (a->y > b->y) - (a->y < b->y);
}

static double turn(tz_vec2 a, tz_vec2 b, tz_vec2 c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* Hull of n sorted points, into room for 2 n.  @source Andrew 1979 */
static int32_t hull_of(const tz_vec2 *v, int32_t n, tz_vec2 *out)
{
    int32_t k = 0;
    for (int32_t i = 0; i < n; i++) {
        while (k >= 2 && turn(out[k - 2], out[k - 1], v[i]) <= 0)
            k--;
        out[k++] = v[i];
    }
    for (int32_t i = n - 2, lower = k + 1; i >= 0; i--) {
        while (k >= lower && turn(out[k - 2], out[k - 1], v[i]) <= 0)
            k--;
        out[k++] = v[i];
    }
    return k > 1 ? k - 1 : k;
}

static void measure_polygon(const tz_vec2 *v, int32_t n, double *area, double *length)
{
    *area = *length = 0;
    for (int32_t i = 0, j = n - 1; i < n; j = i++) {
        *area += 0.5 * (v[j].x * v[i].y - v[i].x * v[j].y);
        *length += hypot(v[i].x - v[j].x, v[i].y - v[j].y);
    }
    *area = fabs(*area);
}

static tz_status measure_shape(tz_ctx *ctx, tz_things_found *f, thing *t)
{
    const tz_things_outline *o = &f->outline;
    const int32_t n = o->part.n > 1 ? o->part.v[1] : o->point.n;
    tz_vec2 *v = NULL;
    double area, length, hull, around;
    const tz_status s = tz_alloc(ctx, &v, 3 * (size_t)n + 1, sizeof *v);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n; i++)
        v[i] = o->point.v[i];
    measure_polygon(v, n, &area, &length);
    qsort(v, (size_t)n, sizeof *v, by_place);
    measure_polygon(v + n, hull_of(v, n, v + n), &hull, &around);
    f->solid = hull > 0 ? fmin(area / hull, 1) : 0;
    t->ragged = around > 0 ? length / around : 1;
    tz_free(ctx, v);
    return TZ_OK;
}

static void measure_pixels(const tz_image *photo, const int32_t *label,
                           tz_things_found *found)
{
    const int32_t w = photo->width, h = photo->height;
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            const int32_t l = label[(ptrdiff_t)y * w + x];
            float c[3];
            if (l < 0)
                continue;
            tz_things_colour(tz_image_at(photo, x, y), photo->channels, c);
            for (int k = 0; k < 3; k++)
                found[l].colour[k] += c[k];
            found[l].area++;
            found[l].frame =
                found[l].frame || x == 0 || y == 0 || x + 1 == w || y + 1 == h;
        }
}

/* ---- the others ---------------------------------------------------------------------- */

typedef struct others {
    double solid, ragged, area; /* medians */
    double colour[3], spread[3];
} others;

static int by_value(const void *p, const void *q)
{
    const double a = *(const double *)p, b = *(const double *)q;
    return (a > b) - (a < b);
}

static double median(double *v, int32_t n)
{
    if (n == 0)
        return 0;
    qsort(v, (size_t)n, sizeof *v, by_value);
    return v[n / 2];
}

static double merit(const tz_things_found *f) { return f->sure * f->solid; }

/* @param v  scratch, count + 1 */
static others survey(const tz_things_found *f, const thing *t, int32_t count, double *v)
{
    others o = {0};
    int32_t n = 0;
    for (int32_t i = 0; i < count; i++)
        v[n++] = merit(&f[i]);
    const double bar = median(v, n);
    for (int what = 0; what < 9; what++) {
        const int c = (what - 3) % 3;
        n = 0;
        for (int32_t i = 0; i < count; i++) {
            if (merit(&f[i]) < bar)
                continue;
            v[n++] = what == 0   ? f[i].solid
                     : what == 1 ? t[i].ragged
                     : what == 2 ? f[i].area
                     : what < 6  ? f[i].colour[c]
                                 : fabs(f[i].colour[c] - o.colour[c]);
        }
        const double m = median(v, n);
        if (what == 0)
            o.solid = m;
        else if (what == 1)
            o.ragged = m;
        else if (what == 2)
            o.area = m;
        else if (what < 6)
            o.colour[c] = m;
        else
            o.spread[c] = fmax(1.48 * m, 0.02);
    }
    return o;
}

/* ---- goods --------------------------------------------------------------------------- */

static double step(double from, double to, double v)
{
    const double t = fmax(0, fmin(1, (v - from) / (to - from)));
    return t * t * (3 - 2 * t);
}

/* Log likelihood ratio of normal colours: > 0 where ground is likelier. */
static double like_ground(const others *o, const tz_things_ground *g, const double *c)
{
    double ratio = g->share > 0 ? 0 : -100;
    for (int k = 0; k < 3; k++) {
        const double spread = fmax(g->spread[k], 0.02);
        const double a = (c[k] - o->colour[k]) / o->spread[k],
                     b = (c[k] - g->middle[k]) / spread;
        ratio += 0.5 * (fmin(a * a, 25) - fmin(b * b, 25)) + log(o->spread[k] / spread);
    }
    return ratio;
}

static double good_of(const others *o, const tz_things_ground *g,
                      const tz_things_found *f, const thing *t)
{
    const double ground = like_ground(o, g, f->colour);
    return step(0.3, 0.55, f->sure) * (1 - step(0.06, 0.2, f->hidden)) *
           step(o->solid - 0.16, o->solid - 0.02, f->solid) *
           (1 - step(o->ragged + 0.02, o->ragged + 0.16, t->ragged)) *
           (1 - step(0, 3, ground)) * step(0.06, 0.25, f->area / fmax(o->area, 1));
}

/* The good that a thing must have. @param v  scratch, count + 1 */
static double bar_of(const tz_things_found *f, const thing *t, int32_t count, double *v)
{
    int32_t n = 0;
    for (int32_t i = 0; i < count; i++)
        if (!f[i].frame)
            v[n++] = t[i].good;
    if (n == 0)
        return GOOD;
    const int32_t wanted = n / SHARE > ENOUGH ? n / SHARE : n < ENOUGH ? n : ENOUGH;
    qsort(v, (size_t)n, sizeof *v, by_value);
    return fmin(GOOD, v[n - wanted]);
}

tz_status tz_things_doubt(tz_ctx *ctx, const tz_image *photo, const int32_t *label,
                          const tz_things_ground *ground, tz_things_found *found,
                          int32_t count)
{
    thing *t = NULL;
    double *v = NULL;
    tz_status s = tz_alloc_zero(ctx, &t, (size_t)count + 1, sizeof *t);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &v, (size_t)count + 1, sizeof *v);
    if (s != TZ_OK)
        goto done;
    measure_pixels(photo, label, found);
    for (int32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++)
            found[i].colour[k] /= fmax(found[i].area, 1);
        if ((s = measure_shape(ctx, &found[i], &t[i])) != TZ_OK)
            goto done;
    }
    const others o = survey(found, t, count, v);
    for (int32_t i = 0; i < count; i++) {
        t[i].good = good_of(&o, ground, &found[i], &t[i]);
        found[i].like_ground = like_ground(&o, ground, found[i].colour) > LIKELY;
    }
    const double bar = bar_of(found, t, count, v);
    for (int32_t i = 0; i < count; i++)
        found[i].cut = found[i].frame || t[i].good < bar;
done:
    tz_free(ctx, t);
    tz_free(ctx, v);
    return s;
}
