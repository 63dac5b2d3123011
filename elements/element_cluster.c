/* SPDX-License-Identifier: Apache-2.0 */
/* Looks and their clusters: colour, shape and (little) size. */
#include "elements/element_cluster.h"

#include <math.h>
#include <string.h>

enum { ROUNDS = 12 };

void tz_element_lab(const double rgb[3], double lab[3])
{
    const double l =
        cbrt(0.4122214708 * rgb[0] + 0.5363325363 * rgb[1] + 0.0514459929 * rgb[2]);
    const double m =
        cbrt(0.2119034982 * rgb[0] + 0.6806995451 * rgb[1] + 0.1073969566 * rgb[2]);
    const double s =
        cbrt(0.0883024619 * rgb[0] + 0.2817188376 * rgb[1] + 0.6299787005 * rgb[2]);
    lab[0] = 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
    lab[1] = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s;
    lab[2] = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s;
}

void tz_element_look_at(const double lab[3], const tz_polys *polys, double radius,
                        double size, tz_element_look *look)
{
    const tz_moments m = tz_polys_moments(polys);
    for (int k = 0; k < 3; k++)
        look->v[k] = lab[k] / 0.1;
    look->v[3] = log2(fmin(m.aspect, 8)) / 1.5;
    look->v[4] =
        m.perimeter > 0 ? 4 * TZ_PI * m.area / (m.perimeter * m.perimeter) / 0.5 : 0;
    look->v[5] = log2(size) / 4;
    look->fullness = m.area / (TZ_PI * radius * radius);
}

static double distance(const double *a, const double *b)
{
    double d = 0;
    for (int k = 0; k < TZ_ELEMENT_LOOKS; k++)
        d += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(d);
}

/* ---- clusters ---------------------------------------------------------------------- */

typedef struct clusters {
    double at[TZ_ELEMENT_CLASSES][TZ_ELEMENT_LOOKS];
    int32_t n;
} clusters;

static int32_t nearest(const clusters *c, const double *v, double *d)
{
    int32_t best = 0;
    *d = INFINITY;
    for (int32_t k = 0; k < c->n; k++) {
        const double e = distance(c->at[k], v);
        if (e < *d) {
            *d = e;
            best = k;
        }
    }
    return best;
}

static void add_seed(clusters *c, const tz_element_look *f)
{
    memcpy(c->at[c->n++], f->v, sizeof f->v);
}

/** The most frequent symbol first, then always the one farthest from all seeds. */
static void seed_wanted(clusters *c, const tz_element_look *f, int32_t n, int32_t wanted)
{
    int32_t pick = -1;
    for (int32_t i = 0; i < n; i++)
        if (f[i].count > (pick < 0 ? 0 : f[pick].count))
            pick = i;
    while (pick >= 0 && c->n < wanted) {
        double farthest = 0;
        add_seed(c, &f[pick]);
        pick = -1;
        for (int32_t i = 0; i < n; i++) {
            double d;
            if (f[i].count == 0)
                continue;
            nearest(c, f[i].v, &d);
            if (d > farthest) {
                farthest = d;
                pick = i;
            }
        }
    }
}

static void seed_leaders(clusters *c, const tz_element_look *f, int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        double d;
        if (f[i].count == 0)
            continue;
        nearest(c, f[i].v, &d);
        if (d > 1 && c->n < TZ_ELEMENT_CLASSES)
            add_seed(c, &f[i]);
    }
}

/** Moves each centre to the mean of its symbols; sets f[].kind. */
static void settle(clusters *c, tz_element_look *f, int32_t n)
{
    for (int round = 0; round < ROUNDS; round++) {
        double sum[TZ_ELEMENT_CLASSES][TZ_ELEMENT_LOOKS] = {{0}},
               weight[TZ_ELEMENT_CLASSES] = {0};
        bool moved = false;
        for (int32_t i = 0; i < n; i++) {
            double d;
            if (f[i].count == 0)
                continue;
            const int32_t k = nearest(c, f[i].v, &d);
            moved = moved || round == 0 || k != f[i].kind;
            f[i].kind = k;
            weight[k] += f[i].count;
            for (int j = 0; j < TZ_ELEMENT_LOOKS; j++)
                sum[k][j] += f[i].v[j] * f[i].count;
        }
        if (!moved)
            return;
        for (int32_t k = 0; k < c->n; k++)
            for (int j = 0; j < TZ_ELEMENT_LOOKS && weight[k] > 0; j++)
                c->at[k][j] = sum[k][j] / weight[k];
    }
}

tz_status tz_element_cluster(tz_ctx *ctx, tz_element_look *look, int32_t n,
                             int32_t wanted)
{
    clusters *c = NULL;
    const tz_status s = tz_alloc_zero(ctx, &c, 1, sizeof *c);
    if (s != TZ_OK)
        return s;
    if (wanted > 0)
        seed_wanted(c, look, n,
                    wanted < TZ_ELEMENT_CLASSES ? wanted : TZ_ELEMENT_CLASSES);
    else
        seed_leaders(c, look, n);
    settle(c, look, n);
    tz_free(ctx, c);
    return TZ_OK;
}
