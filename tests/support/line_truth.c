/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/support/line_truth.h"

#include <stdlib.h>

#include "base/grid.h"
#include "base/rng.h"
#include "scenes/scene.h"

#define TOLERANCE 2.0

const char *const line_kind_name[LINE_KINDS] = {"cells", "cracks", "veins"};

/* ---- lines --------------------------------------------------------------------------- */

static tz_status add(line_truth *t, tz_vec2 at, double width)
{
    return tz_array_push(t->ctx, &t->sample, ((line_sample){at, width}));
}

/* A line from p to q that strays by up to an eighth of its length. */
static tz_status stray(line_truth *t, tz_rng *r, tz_vec2 p, tz_vec2 q, double width,
                       int depth)
{
    const tz_vec2 d = tz_vec2_sub(q, p);
    const double far = tz_vec2_length(d);
    if (far <= 0.8 || depth > 12)
        return add(t, p, width);
    const double off = (far > 6 ? 0.12 : 0) * tz_rng_range(r, -1, 1);
    const tz_vec2 m = {0.5 * (p.x + q.x) - off * d.y, 0.5 * (p.y + q.y) + off * d.x};
    const tz_status s = stray(t, r, p, m, width, depth + 1);
    return s == TZ_OK ? stray(t, r, m, q, width, depth + 1) : s;
}

/* Bricks pulled about: each corner has three lines. */
static tz_status draw_cells(line_truth *t, tz_rng *r, int32_t side)
{
    enum { N = 9 };
    tz_vec2 corner[N + 3][N + 3];
    const double pitch = (double)side / N;
    tz_status s = TZ_OK;
    for (int y = 0; y < N + 3; y++)
        for (int x = 0; x < N + 3; x++)
            corner[y][x] = (tz_vec2){(x - 1 + tz_rng_range(r, -0.22, 0.22)) * pitch,
                                     (y - 1 + tz_rng_range(r, -0.22, 0.22)) * pitch};
    for (int y = 0; y < N + 2; y++)
        for (int x = 0; x < N + 2; x++) {
            const double width = tz_rng_range(r, 4, 6);
            if (s == TZ_OK)
                s = stray(t, r, corner[y][x], corner[y][x + 1], width, 0);
            if (s == TZ_OK && (x + y) % 2)
                s = stray(t, r, corner[y][x], corner[y + 1][x], width, 0);
        }
    return s;
}

static tz_status walk_crack(line_truth *t, tz_rng *r, tz_vec2 at, double angle,
                            double width, double life, int born)
{
    tz_status s = TZ_OK;
    double bend = 0;
    for (double far = 0; far < life && s == TZ_OK; far += 0.8) {
        const double here = fmax(1.5, width * sqrt(1 - far / life));
        s = add(t, at, here);
        bend = 0.9 * bend + 0.008 * tz_rng_normal(r);
        angle += bend;
        at.x += 0.8 * cos(angle);
        at.y += 0.8 * sin(angle);
        if (s == TZ_OK && born < 2 && far > 40 && life - far > 60 &&
            tz_rng_unit(r) < 0.005) {
            const double turn = tz_rng_unit(r) < 0.5 ? -0.9 : 0.9;
            s = walk_crack(t, r, at, angle + turn, 0.8 * here, 0.6 * (life - far),
                           born + 1);
        }
    }
    return s;
}

static tz_status draw_cracks(line_truth *t, tz_rng *r, int32_t side)
{
    tz_status s = TZ_OK;
    for (int k = 0; k < 7 && s == TZ_OK; k++) {
        const tz_vec2 at = {tz_rng_range(r, 0, side), tz_rng_range(r, 0, side)};
        s = walk_crack(t, r, at, tz_rng_range(r, 0, 2 * TZ_PI), tz_rng_range(r, 3, 7),
                       tz_rng_range(r, 0.4, 1) * side, 0);
    }
    return s;
}

static tz_status draw_veins(line_truth *t, tz_rng *r, int32_t side)
{
    tz_status s = TZ_OK;
    for (int k = 0; k < 8 && s == TZ_OK; k++) {
        const double y = (k + tz_rng_range(r, 0.2, 0.8)) * side / 8, a = 0.03 * side,
                     f = tz_rng_range(r, 1, 3) * 2 * TZ_PI / side,
                     g = tz_rng_range(r, 4, 7) * 2 * TZ_PI / side,
                     u = tz_rng_range(r, 0, 6), v = tz_rng_range(r, 0, 6),
                     width = tz_rng_range(r, 4, 9);
        for (double x = 0; x < side && s == TZ_OK; x += 0.6)
            s = add(t, (tz_vec2){x, y + a * sin(f * x + u) + 0.2 * a * sin(g * x + v)},
                    width * (1 + 0.4 * sin(0.5 * g * x + u)));
    }
    return s;
}

/* ---- picture ------------------------------------------------------------------------- */

/* Ground of a mean of 0.45 and a deviation of 0.04. */
static tz_status draw_ground(line_truth *t, int32_t side, uint64_t seed)
{
    tz_scene scene;
    double sum = 0, square = 0;
    tz_status s = tz_scene_render(t->ctx, TZ_SCENE_GROUND, TZ_SCENE_CLEAN, side, side,
                                  seed, &scene);
    if (s != TZ_OK)
        return s;
    t->photo = scene.photo;
    scene.photo = (tz_image){0};
    tz_scene_deinit(&scene);
    const int64_t n = (int64_t)side * side;
    for (int64_t p = 0; p < n; p++) {
        sum += t->photo.px[3 * p + 1];
        square += t->photo.px[3 * p + 1] * t->photo.px[3 * p + 1];
    }
    const double mean = sum / (double)n,
                 spread = sqrt(fmax(square / (double)n - mean * mean, 1e-6));
    for (int64_t p = 0; p < n; p++)
        for (int c = 0; c < 3; c++) {
            float *v = &t->photo.px[3 * p + c];
            *v = (float)(0.45 + 0.04 * (*v - mean) / spread);
        }
    return TZ_OK;
}

/* How much of each pixel lines cover: bars whose borders are a px soft. */
static void stamp(const line_truth *t, float *cover, int32_t side)
{
    for (int32_t i = 0; i < t->sample.n; i++) {
        const line_sample *p = &t->sample.v[i];
        const double reach = 0.5 * p->width + 1;
        for (int32_t y = (int32_t)fmax(0, floor(p->at.y - reach));
             y < side && y <= p->at.y + reach; y++)
            for (int32_t x = (int32_t)fmax(0, floor(p->at.x - reach));
                 x < side && x <= p->at.x + reach; x++) {
                const double far = hypot(x + 0.5 - p->at.x, y + 0.5 - p->at.y);
                const float c = (float)fmin(1, fmax(0, 0.5 * p->width + 0.5 - far));
                float *v = &cover[(ptrdiff_t)y * side + x];
                *v = c > *v ? c : *v;
            }
    }
}

tz_status line_truth_draw(tz_ctx *ctx, line_kind kind, int32_t side, double depth,
                          uint64_t seed, line_truth *out)
{
    float *cover = NULL;
    tz_rng r = tz_rng_make(seed, tz_rng_stream(kind, 1, 0));
    *out = (line_truth){.ctx = ctx};
    tz_status s = draw_ground(out, side, seed);
    if (s == TZ_OK)
        s = kind == LINE_CELLS    ? draw_cells(out, &r, side)
            : kind == LINE_CRACKS ? draw_cracks(out, &r, side)
                                  : draw_veins(out, &r, side);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &cover, (size_t)side * (size_t)side, sizeof *cover);
    if (s == TZ_OK)
        stamp(out, cover, side);
    const float by = (float)(kind == LINE_VEINS ? depth : -depth);
    for (int64_t p = 0; p < (int64_t)side * side && s == TZ_OK; p++)
        for (int c = 0; c < 3; c++)
            out->photo.px[3 * p + c] += by * cover[p];
    int32_t kept = 0; /* what lies in the picture */
    for (int32_t i = 0; i < out->sample.n; i++) {
        const tz_vec2 a = out->sample.v[i].at;
        if (a.x >= 0 && a.y >= 0 && a.x < side && a.y < side)
            out->sample.v[kept++] = out->sample.v[i];
    }
    out->sample.n = kept;
    tz_free(ctx, cover);
    if (s != TZ_OK)
        line_truth_deinit(out);
    return s;
}

void line_truth_deinit(line_truth *t)
{
    tz_image_deinit(&t->photo);
    tz_array_free(t->ctx, &t->sample);
}

/* ---- score --------------------------------------------------------------------------- */

static tz_status fill(tz_ctx *ctx, const line_sample *v, int32_t n, double side,
                      tz_grid *g)
{
    int32_t id;
    tz_status s =
        tz_grid_init(ctx, g, (tz_vec2){0, 0}, (tz_vec2){side, side}, TOLERANCE, false);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        s = tz_grid_add(ctx, g, v[i].at, &id);
    return s;
}

/* Nearest of the grid's points within the tolerance; -1 = none. */
static int32_t nearest(const tz_grid *g, tz_vec2 p, double *far)
{
    int32_t near[256], best = -1;
    const int32_t n = tz_grid_query(g, p, TOLERANCE, near, 256);
    *far = INFINITY;
    for (int32_t i = 0; i < n && i < 256; i++) {
        const double d = tz_vec2_length(tz_vec2_sub(g->point.v[near[i]], p));
        if (d < *far) {
            *far = d;
            best = near[i];
        }
    }
    return best;
}

static int by_size(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

tz_status line_truth_score(const line_truth *t, const line_sample *found, int32_t n,
                           line_score *out)
{
    tz_grid truth = {0}, had = {0};
    double *far = NULL, *wide = NULL;
    int32_t right = 0, met = 0;
    *out = (line_score){0};
    const double side = t->photo.width;
    tz_status s = fill(t->ctx, t->sample.v, t->sample.n, side, &truth);
    if (s == TZ_OK)
        s = fill(t->ctx, found, n, side, &had);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &far, (size_t)t->sample.n, sizeof *far);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &wide, (size_t)t->sample.n, sizeof *wide);
    if (s != TZ_OK)
        goto done;
    for (int32_t i = 0; i < n; i++) {
        double d;
        right += nearest(&truth, found[i].at, &d) >= 0;
    }
    for (int32_t i = 0; i < t->sample.n; i++) {
        double d;
        const int32_t k = nearest(&had, t->sample.v[i].at, &d);
        if (k < 0)
            continue;
        wide[met] = fabs(found[k].width / t->sample.v[i].width - 1);
        far[met++] = d;
    }
    out->precision = n > 0 ? (double)right / n : 0;
    out->recall = t->sample.n > 0 ? (double)met / t->sample.n : 0;
    const double sum = out->precision + out->recall;
    out->f = sum > 0 ? 2 * out->precision * out->recall / sum : 0;
    qsort(far, (size_t)met, sizeof *far, by_size);
    qsort(wide, (size_t)met, sizeof *wide, by_size);
    out->place = met > 0 ? far[met / 2] : 0;
    out->width = met > 0 ? wide[met / 2] : 0;
done:
    tz_grid_deinit(t->ctx, &truth);
    tz_grid_deinit(t->ctx, &had);
    tz_free(t->ctx, far);
    tz_free(t->ctx, wide);
    return s;
}

tz_status line_samples_of(tz_ctx *ctx, const tz_curve_set *set, line_sample **v,
                          int32_t *n)
{
    TZ_ARRAY(line_sample)
    out = {0};
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < set->path.n && s == TZ_OK; i++)
        for (int32_t k = 0; k < set->path.v[i].pieces && s == TZ_OK; k++) {
            const int32_t at = set->path.v[i].piece + k;
            const tz_bezier c = tz_curve_bezier(set, &set->piece.v[at]);
            const double pen = set->pen.v[set->path.v[i].pen].width;
            const tz_curve_taper w =
                set->taper.n ? set->taper.v[at] : (tz_curve_taper){pen, pen};
            const int32_t steps = 1 + (int32_t)(1.5 * tz_bezier_length(&c));
            for (int32_t e = 0; e < steps && s == TZ_OK; e++) {
                const double u = (double)e / steps;
                s = tz_array_push(
                    ctx, &out,
                    ((line_sample){tz_bezier_at(&c, u), w.from + u * (w.to - w.from)}));
            }
        }
    *v = out.v;
    *n = out.n;
    return s;
}
