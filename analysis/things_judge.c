/* SPDX-License-Identifier: Apache-2.0 */
/* In pictures of bark, moss or strata things are found, too, but hardly any surely: the
 * mean certainty tells them from pictures of things. It counts for a little more where
 * things are unlike the ground, which bark's furrows and stone's veins are not:
 *
 *     sure + 0.1 (distinct - 1/2) > LIMIT
 *
 * and there must be enough of them. */
#include "analysis/things_judge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FEWEST = 8 };

#define LIMIT   0.6
#define COVERED 0.2
#define ALIKE   1.0 /* octaves of area */

static int by_value(const void *p, const void *q)
{
    const double a = *(const double *)p, b = *(const double *)q;
    return (a > b) - (a < b);
}

static double spread_of(double *v, int32_t n)
{
    if (n == 0)
        return 0;
    qsort(v, (size_t)n, sizeof *v, by_value);
    const double middle = v[n / 2];
    for (int32_t i = 0; i < n; i++)
        v[i] = fabs(v[i] - middle);
    qsort(v, (size_t)n, sizeof *v, by_value);
    return 1.48 * v[n / 2];
}

static void say(tz_things_verdict *v)
{
    const int percent = (int)lrint(100 * v->covered);
    if (v->copied < FEWEST)
        snprintf(v->why, sizeof v->why, "only %d whole thing%s out", v->copied,
                 v->copied == 1 ? " stands" : "s stand");
    else if (v->covered < COVERED)
        snprintf(v->why, sizeof v->why, "things cover no more than %d %% of the picture",
                 percent);
    else if (!v->is_things)
        snprintf(v->why, sizeof v->why,
                 "what stands out in it has no clear borders or is like its ground");
    else
        snprintf(v->why, sizeof v->why, "%d things cover %d %% of the picture and %s",
                 v->things, percent,
                 v->spread < ALIKE ? "are alike in size" : "are of many sizes");
}

tz_status tz_things_sum_up(tz_ctx *ctx, const tz_things_found *found, int32_t count,
                           const tz_things_ground *ground, int64_t pixels,
                           tz_things_verdict *out)
{
    tz_things_verdict v = {.things = count, .distinct = ground->clear};
    double *size = NULL;
    int32_t inner = 0;
    const tz_status s = tz_alloc(ctx, &size, (size_t)count + 1, sizeof *size);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < count; i++) {
        const tz_things_found *f = &found[i];
        v.covered += f->area / (double)pixels;
        if (!f->frame) {
            v.sure += f->sure;
            inner++;
        }
        if (!f->cut) {
            v.solid += f->solid;
            size[v.copied++] = log2(fmax(f->area, 1));
        }
    }
    v.sure /= inner > 0 ? inner : 1;
    v.solid /= v.copied > 0 ? v.copied : 1;
    v.spread = spread_of(size, v.copied);
    v.is_things = v.copied >= FEWEST && v.covered >= COVERED &&
                  v.sure + 0.1 * (v.distinct - 0.5) > LIMIT;
    say(&v);
    *out = v;
    tz_free(ctx, size);
    return TZ_OK;
}
