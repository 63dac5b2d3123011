/* SPDX-License-Identifier: Apache-2.0 */
/* Strengths become levels 0..33 once; each level that differs from the next higher one is
 * thinned and paired by itself, in parallel. The truth is thinned in the same way as what
 * is found: staircases of truth made from label maps would otherwise count twice the
 * pixels that a thinned curve can have, and the perfect detector would miss half of them.
 *
 * The figures are those of the Berkeley benchmark: precision and recall between two
 * thresholds are interpolated for the best F. Deviates: the area under the curve goes on
 * to recall 0 at the precision of the lowest recall reached, because a detector whose
 * strengths seldom come near 1 is no worse for that. */
#include "analysis/boundary_score.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "analysis/boundary_parts.h"

typedef struct match_job {
    int32_t width, height, margin, stride;
    size_t size;    /* of a framed mask */
    uint8_t *level; /* width * height: how many thresholds the strength reaches */
    int32_t *id;    /* framed: number of the true pixel, or -1 */
    int32_t truth;
    tz_boundary_disc disc;
    int32_t run[TZ_BOUNDARY_LEVELS]; /* thresholds to work on, as indices */
    tz_boundary_counts *counts;
} match_job;

/* ---- one picture ------------------------------------------------------------------- */

static void find_levels(const float *strength, match_job *j, int64_t *count)
{
    float threshold[TZ_BOUNDARY_LEVELS + 2];
    for (int32_t k = 0; k <= TZ_BOUNDARY_LEVELS; k++)
        threshold[k] = (float)(k / (TZ_BOUNDARY_LEVELS + 1.0));
    threshold[TZ_BOUNDARY_LEVELS + 1] = INFINITY;
    for (int64_t p = 0; p < (int64_t)j->width * j->height; p++) {
        const float v = strength[p];
        int32_t k = 0;
        if (v >= threshold[TZ_BOUNDARY_LEVELS])
            k = TZ_BOUNDARY_LEVELS;
        else if (v > 0) /* not NaN */
            k = (int32_t)(v * (TZ_BOUNDARY_LEVELS + 1));
        /* rounding of the product */
        k += v >= threshold[k + 1];
        k -= k > 0 && v < threshold[k];
        j->level[p] = (uint8_t)k;
        count[k]++;
    }
}

/* Framed mask and list of the pixels at or above `least`. */
static tz_status make_mask(tz_ctx *ctx, const match_job *j, const uint8_t *of,
                           int32_t least, uint8_t **on, int32_t **px, int32_t *n)
{
    const int64_t all = (int64_t)j->width * j->height;
    int64_t count = 0;
    tz_status s;
    for (int64_t p = 0; p < all; p++)
        count += of[p] >= least;
    *n = 0;
    if ((s = tz_alloc_zero(ctx, on, j->size, 1)) != TZ_OK)
        return s;
    if ((s = tz_alloc(ctx, px, (size_t)count, sizeof **px)) != TZ_OK)
        return s;
    for (int32_t y = 0; y < j->height; y++) {
        const uint8_t *row = of + (size_t)y * j->width;
        for (int32_t x = 0; x < j->width; x++) {
            if (row[x] < least)
                continue;
            const int32_t q = (y + j->margin) * j->stride + x + j->margin;
            (*on)[q] = 1;
            (*px)[(*n)++] = q;
        }
    }
    return TZ_OK;
}

static tz_status match_level(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const match_job *j = arg;
    const int32_t k = j->run[i];
    uint8_t *on = NULL;
    int32_t *px = NULL, n = 0, pairs = 0;
    tz_status s;
    (void)worker;

    if ((s = make_mask(ctx, j, j->level, k + 1, &on, &px, &n)) != TZ_OK)
        goto done;
    if ((s = tz_boundary_skeleton(ctx, on, j->stride, px, &n)) != TZ_OK)
        goto done;
    if ((s = tz_boundary_pair(ctx, px, n, j->id, j->truth, &j->disc, &pairs)) != TZ_OK)
        goto done;
    j->counts->found[k] = n;
    j->counts->found_true[k] = j->counts->truth_found[k] = pairs;
done:
    tz_free(ctx, on);
    tz_free(ctx, px);
    return s;
}

static tz_status number_truth(tz_ctx *ctx, const uint8_t *truth, match_job *j)
{
    uint8_t *on = NULL;
    int32_t *px = NULL, n = 0;
    tz_status s;
    if ((s = make_mask(ctx, j, truth, 1, &on, &px, &n)) != TZ_OK)
        goto done;
    if ((s = tz_boundary_skeleton(ctx, on, j->stride, px, &n)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &j->id, j->size, sizeof *j->id)) != TZ_OK)
        goto done;
    for (size_t q = 0; q < j->size; q++)
        j->id[q] = -1;
    for (int32_t i = 0; i < n; i++)
        j->id[px[i]] = i;
    j->truth = n;
done:
    tz_free(ctx, on);
    tz_free(ctx, px);
    return s;
}

tz_status tz_boundary_match(tz_ctx *ctx, const float *strength, const uint8_t *truth,
                            int32_t width, int32_t height, double tolerance,
                            tz_boundary_counts *counts)
{
    const double radius =
        tolerance * sqrt((double)width * width + (double)height * height);
    int64_t count[TZ_BOUNDARY_LEVELS + 1] = {0};
    tz_boundary_counts all = {0};
    match_job j = {.width = width, .height = height, .counts = &all};
    int32_t runs = 0;
    tz_status s;

    assert(width > 0 && height > 0 && tolerance >= 0 && tolerance <= 1);
    j.margin = 1 + (int32_t)radius;
    j.stride = width + 2 * j.margin;
    j.size = (size_t)j.stride * (size_t)(height + 2 * j.margin);
    if (j.size > INT32_MAX)
        return tz_fail(ctx, TZ_NOMEM, "boundaries: %d x %d px are too many", width,
                       height);
    if ((s = tz_alloc(ctx, &j.level, (size_t)width * height, 1)) != TZ_OK)
        goto done;
    if ((s = number_truth(ctx, truth, &j)) != TZ_OK)
        goto done;
    if ((s = tz_boundary_disc_init(ctx, radius, j.stride, &j.disc)) != TZ_OK)
        goto done;
    find_levels(strength, &j, count);
    all.truth = j.truth;
    for (int32_t k = 0; k < TZ_BOUNDARY_LEVELS; k++) /* the longest first */
        if (count[k + 1] > 0)
            j.run[runs++] = k;
    if ((s = tz_parallel_for(ctx, runs, match_level, &j)) != TZ_OK)
        goto done;
    for (int32_t k = TZ_BOUNDARY_LEVELS - 2; k >= 0; k--) {
        if (count[k + 1] > 0)
            continue; /* else the same pixels as one level higher */
        all.found[k] = all.found[k + 1];
        all.found_true[k] = all.found_true[k + 1];
        all.truth_found[k] = all.truth_found[k + 1];
    }
    *counts = all;
done:
    tz_free(ctx, j.level);
    tz_free(ctx, j.id);
    tz_boundary_disc_deinit(&j.disc);
    return s;
}

/* ---- figures ----------------------------------------------------------------------- */

typedef struct point {
    double recall, precision;
} point;

static double share(int64_t part, int64_t all)
{
    return all > 0 ? (double)part / (double)all : 0;
}

static double f_of(point p)
{
    const double sum = p.recall + p.precision;
    return sum > 0 ? 2 * p.recall * p.precision / sum : 0;
}

static point point_at(const tz_boundary_counts *c, int32_t k)
{
    return (point){share(c->truth_found[k], c->truth),
                   share(c->found_true[k], c->found[k])};
}

/* Best F, also between two thresholds. */
static void find_best(const tz_boundary_counts *sum, tz_boundary_score *score)
{
    const int32_t steps = 100;
    for (int32_t k = 0; k < TZ_BOUNDARY_LEVELS; k++) {
        const point a = point_at(sum, k);
        const bool last = k + 1 == TZ_BOUNDARY_LEVELS || sum->found[k + 1] == 0;
        const point b = last ? a : point_at(sum, k + 1);
        for (int32_t i = 0; i < (last ? 1 : steps); i++) {
            const double t = (double)i / steps;
            const point p = {a.recall + t * (b.recall - a.recall),
                             a.precision + t * (b.precision - a.precision)};
            if (f_of(p) <= score->ods)
                continue;
            score->ods = f_of(p);
            score->ods_threshold = (k + 1 + t) / (TZ_BOUNDARY_LEVELS + 1.0);
            score->ods_precision = p.precision;
            score->ods_recall = p.recall;
        }
    }
}

/* Where a picture is best: largest F, of equal ones the fewest pixels found. */
static int32_t own_best(const tz_boundary_counts *c)
{
    int32_t best = TZ_BOUNDARY_LEVELS - 1;
    for (int32_t k = best - 1; k >= 0; k--)
        if (f_of(point_at(c, k)) > f_of(point_at(c, best)))
            best = k;
    return best;
}

static int by_recall(const void *a, const void *b)
{
    const point *p = a, *q = b;
    if (p->recall != q->recall)
        return p->recall < q->recall ? -1 : 1;
    return (p->precision < q->precision) - (p->precision > q->precision);
}

static double area(const tz_boundary_counts *sum)
{
    point p[TZ_BOUNDARY_LEVELS];
    double all = 0;
    int32_t n = 0;
    for (int32_t k = 0; k < TZ_BOUNDARY_LEVELS; k++)
        if (sum->found[k] > 0)
            p[n++] = point_at(sum, k);
    if (n == 0)
        return 0;
    qsort(p, (size_t)n, sizeof *p, by_recall);
    all = p[0].recall * p[0].precision;
    for (int32_t i = 1, before = 0; i < n; i++) {
        if (p[i].recall == p[before].recall)
            continue; /* the most precise of equal recall came first */
        all += 0.5 * (p[i].precision + p[before].precision) *
               (p[i].recall - p[before].recall);
        before = i;
    }
    return all;
}

tz_boundary_score tz_boundary_score_of(const tz_boundary_counts *counts, int32_t n)
{
    tz_boundary_score score = {0};
    tz_boundary_counts sum = {0}, own = {0};
    for (int32_t i = 0; i < n; i++) {
        const tz_boundary_counts *c = &counts[i];
        const int32_t best = own_best(c);
        for (int32_t k = 0; k < TZ_BOUNDARY_LEVELS; k++) {
            sum.found[k] += c->found[k];
            sum.found_true[k] += c->found_true[k];
            sum.truth_found[k] += c->truth_found[k];
        }
        sum.truth += c->truth;
        own.truth += c->truth;
        own.found[0] += c->found[best];
        own.found_true[0] += c->found_true[best];
        own.truth_found[0] += c->truth_found[best];
    }
    find_best(&sum, &score);
    score.ois = f_of(point_at(&own, 0));
    score.ap = area(&sum);
    return score;
}
