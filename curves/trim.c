/* SPDX-License-Identifier: Apache-2.0 */
/* Two measures, both on the joined drawing.
 *
 * Emptiness, of nets: where the next line is farther than anywhere in the middle of the drawing (1.6
 * times its 0.99 quantile), a disc as large is empty. If discs cover much of the area, the
 * largest rectangle is taken that hardly any of them reach into.
 *
 * Ends: at a side, n(d) free ends face it no deeper than d, r a depth end anywhere, and U
 * lines cross a parallel to it (median). The cut is where
 *
 *     n(d) - 2 r d - LOSS U d / most      is largest,   and made if that is over U / 3
 *
 * which weighs the ends that go against chance and against the drawing that is lost. */
#include "curves/trim.h"

#include <stdlib.h>
#include <string.h>

#include "curves/clip.h"
#include "curves/curve_edit.h"
#include "curves/curve_join.h"

enum {
    FEW = 6,     /* lines across, at least */
    LEAST = 4,   /* ends at a side that are a cluster */
    BINS = 250,  /* of depth, to the middle */
    CELLS = 192, /* of distances, along the longer side */
    COARSE = 48, /* of rectangles, likewise */
    PASSES = 2
};
#define MOST   0.12 /* that a side loses */
#define LOSS   0.6  /* lines that the most is worth */
#define SHARE  (1.0 / 3)
#define FACING 0.5  /* cosine of an end's direction and the side's */
#define BEYOND 2e-3 /* of the extent: cut so far behind the last end */
#define WIDE   1.6  /* times the usual distance: empty */
#define EMPTY  0.05 /* share of area that is too much */
#define LEFT   0.02 /* share of a rectangle that may be empty */
#define ENOUGH 0.4  /* share of the area that a rectangle holds */

typedef struct rect {
    tz_vec2 lo, hi;
} rect;

typedef struct loose_end {
    tz_vec2 at, out; /* out: direction in which it ends */
} loose_end;

typedef struct trimmer {
    tz_ctx *ctx;
    tz_curve_set set; /* joined, crossings too */
    TZ_ARRAY(loose_end)
    end;
    TZ_ARRAY(tz_vec2)
    chord; /* in pairs */
    tz_curve_trim_report report;
} trimmer;

/* ---- ends and chords ------------------------------------------------------------------ */

static tz_vec2 outwards(const tz_bezier *b, bool last)
{
    const tz_vec2 end = b->p[last ? 3 : 0];
    for (int k = 1; k < 4; k++) {
        const tz_vec2 d = tz_vec2_sub(end, b->p[last ? 3 - k : k]);
        const double size = tz_vec2_length(d);
        if (size > 0)
            return tz_vec2_scale(d, 1 / size);
    }
    return (tz_vec2){0, 0};
}

static tz_status find_ends(trimmer *t)
{
    const tz_curve_set *set = &t->set;
    int32_t *degree = NULL;
    tz_status s = tz_alloc_zero(t->ctx, &degree, (size_t)set->node.n, sizeof *degree);
    for (int32_t i = 0; i < set->piece.n && s == TZ_OK; i++) {
        degree[set->piece.v[i].from]++;
        degree[set->piece.v[i].to]++;
    }
    for (int32_t i = 0; i < set->piece.n && s == TZ_OK; i++) {
        const tz_bezier b = tz_curve_bezier(set, &set->piece.v[i]);
        for (int k = 0; k < 2 && s == TZ_OK; k++)
            if (degree[k ? set->piece.v[i].to : set->piece.v[i].from] == 1)
                s = tz_array_push(t->ctx, &t->end,
                                  ((loose_end){b.p[3 * k], outwards(&b, k)}));
    }
    tz_free(t->ctx, degree);
    return s;
}

static tz_status find_chords(trimmer *t, double tolerance)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < t->set.piece.n && s == TZ_OK; i++) {
        const tz_bezier b = tz_curve_bezier(&t->set, &t->set.piece.v[i]);
        const int32_t steps = tz_bezier_steps(&b, tolerance);
        tz_vec2 p = b.p[0];
        for (int32_t k = 1; k <= steps && s == TZ_OK; k++) {
            const tz_vec2 q = tz_bezier_at(&b, (double)k / steps);
            s = tz_array_push(t->ctx, &t->chord, p);
            if (s == TZ_OK)
                s = tz_array_push(t->ctx, &t->chord, q);
            p = q;
        }
        if (s == TZ_OK && !(i & 4095) && tz_ctx_cancelled(t->ctx))
            s = TZ_CANCELLED;
    }
    return s;
}

/* ---- emptiness ------------------------------------------------------------------------ */

typedef struct plane {
    int32_t w, h;
    double cell;
    float *d; /* squared distance, cells */
    float *line;
    int32_t *at;
    float *from;
} plane;

/* Lower envelope of parabolas along one line of cells.
 * @source Felzenszwalb, Huttenlocher: Distance transforms of sampled functions, 2012 */
static void transform_line(const plane *p, float *f, int32_t n, int32_t step)
{
    int32_t k = 0;
    for (int32_t i = 0; i < n; i++)
        p->line[i] = f[(size_t)i * step];
    p->at[0] = 0;
    p->from[0] = -INFINITY;
    for (int32_t q = 1; q < n; q++) {
        float s;
        for (;;) {
            const int32_t v = p->at[k];
            s = (p->line[q] - p->line[v] + (float)(q * q - v * v)) / (float)(2 * (q - v));
            if (s > p->from[k] || k == 0)
                break;
            k--;
        }
        if (s <= p->from[k])
            s = p->from[k];
        k++;
        p->at[k] = q;
        p->from[k] = s;
    }
    for (int32_t q = 0, j = 0; q < n; q++) {
        while (j < k && p->from[j + 1] < (float)q)
            j++;
        const int32_t v = p->at[j];
        f[(size_t)q * step] = (float)((q - v) * (q - v)) + p->line[v];
    }
}

static void transform(const plane *p)
{
    for (int32_t x = 0; x < p->w; x++)
        transform_line(p, p->d + x, p->h, p->w);
    for (int32_t y = 0; y < p->h; y++)
        transform_line(p, p->d + (size_t)y * p->w, p->w, 1);
}

static tz_status plane_init(trimmer *t, plane *p)
{
    const tz_vec3 size = t->set.domain.size;
    const float far = 4.0f * CELLS * CELLS;
    p->cell = fmax(size.x, size.y) / CELLS;
    p->w = (int32_t)fmin(fmax(ceil(size.x / p->cell), 1), CELLS);
    p->h = (int32_t)fmin(fmax(ceil(size.y / p->cell), 1), CELLS);
    tz_status s = tz_alloc(t->ctx, &p->d, (size_t)p->w * p->h, sizeof *p->d);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &p->line, CELLS + 1, sizeof *p->line);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &p->at, CELLS + 1, sizeof *p->at);
    if (s == TZ_OK)
        s = tz_alloc(t->ctx, &p->from, CELLS + 1, sizeof *p->from);
    for (int32_t i = 0; i < p->w * p->h && s == TZ_OK; i++)
        p->d[i] = far;
    for (int32_t i = 0; i + 1 < t->chord.n && s == TZ_OK; i += 2) {
        const tz_vec2 a = t->chord.v[i], v = tz_vec2_sub(t->chord.v[i + 1], a);
        const double n = ceil(2 * tz_vec2_length(v) / p->cell);
        const int32_t steps = (int32_t)fmin(fmax(n, 1), 8 * CELLS);
        for (int32_t k = 0; k <= steps; k++) {
            const double x = (a.x + v.x * k / steps) / p->cell,
                         y = (a.y + v.y * k / steps) / p->cell;
            if (x >= 0 && y >= 0 && x < p->w && y < p->h)
                p->d[(size_t)(int32_t)y * p->w + (int32_t)x] = 0;
        }
    }
    return s;
}

static void plane_deinit(tz_ctx *ctx, plane *p)
{
    tz_free(ctx, p->d);
    tz_free(ctx, p->line);
    tz_free(ctx, p->at);
    tz_free(ctx, p->from);
}

static int up(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Squared distance that counts as empty: from the middle half of both sides. */
static tz_status usual_distance(trimmer *t, const plane *p, double *far)
{
    double *d = NULL;
    int32_t n = 0;
    const tz_status s = tz_alloc(t->ctx, &d, (size_t)p->w * p->h, sizeof *d);
    if (s != TZ_OK)
        return s;
    for (int32_t y = p->h / 4; y <= 3 * p->h / 4 && y < p->h; y++)
        for (int32_t x = p->w / 4; x <= 3 * p->w / 4 && x < p->w; x++)
            d[n++] = p->d[(size_t)y * p->w + x];
    qsort(d, (size_t)n, sizeof *d, up);
    *far = WIDE * WIDE * fmax(d[(int32_t)(0.99 * (n - 1))], 4);
    tz_free(t->ctx, d);
    return TZ_OK;
}

/* Sums of empty cells of a coarse raster: sum[(y * (w + 1)) + x] of all left of and above. */
typedef struct coarse {
    int32_t w, h, sum[(COARSE + 1) * (COARSE + 1)];
} coarse;

static int32_t inside(const coarse *c, int32_t x0, int32_t y0, int32_t x1, int32_t y1)
{
    const int32_t row = c->w + 1;
    return c->sum[y1 * row + x1] - c->sum[y0 * row + x1] - c->sum[y1 * row + x0] +
           c->sum[y0 * row + x0];
}

static void sum_up(const plane *p, double far, coarse *c)
{
    const int32_t each = CELLS / COARSE;
    memset(c, 0, sizeof *c);
    c->w = (p->w + each - 1) / each;
    c->h = (p->h + each - 1) / each;
    for (int32_t y = 0; y < c->h; y++)
        for (int32_t x = 0, row = 0; x < c->w; x++) {
            const int32_t py = y * each + each / 2, px = x * each + each / 2,
                          my = py < p->h ? py : p->h - 1, mx = px < p->w ? px : p->w - 1;
            row += p->d[(size_t)my * p->w + mx] < far;
            c->sum[(y + 1) * (c->w + 1) + x + 1] = c->sum[y * (c->w + 1) + x + 1] + row;
        }
}

/* The largest rectangle that is filled; in doubt the first. */
static bool largest(const coarse *c, int32_t best[4])
{
    int32_t most = 0;
    for (int32_t y0 = 0; y0 < c->h; y0++)
        for (int32_t y1 = y0 + 1; y1 <= c->h; y1++)
            for (int32_t x0 = 0; x0 < c->w; x0++)
                for (int32_t x1 = c->w; x1 > x0; x1--) {
                    const int32_t area = (y1 - y0) * (x1 - x0);
                    if (area <= most)
                        break;
                    if (inside(c, x0, y0, x1, y1) > LEFT * area)
                        continue;
                    most = area;
                    best[0] = x0, best[1] = y0, best[2] = x1, best[3] = y1;
                }
    return most >= ENOUGH * c->w * c->h;
}

static int32_t root_of(int32_t *parent, int32_t i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

/* Whether most of the length hangs together: only a net has an inside. */
static tz_status is_net(const trimmer *t, bool *net)
{
    const tz_curve_set *set = &t->set;
    int32_t *root = NULL;
    double *length = NULL, all = 0, most = 0;
    tz_status s = tz_alloc(t->ctx, &root, (size_t)set->node.n, sizeof *root);
    if (s == TZ_OK)
        s = tz_alloc_zero(t->ctx, &length, (size_t)set->node.n, sizeof *length);
    for (int32_t i = 0; i < set->node.n && s == TZ_OK; i++)
        root[i] = i;
    for (int32_t i = 0; i < set->piece.n && s == TZ_OK; i++) {
        const int32_t a = root_of(root, set->piece.v[i].from),
                      b = root_of(root, set->piece.v[i].to);
        root[a > b ? a : b] = a < b ? a : b;
    }
    for (int32_t i = 0; i < set->piece.n && s == TZ_OK; i++) {
        const tz_bezier b = tz_curve_bezier(set, &set->piece.v[i]);
        const double size = tz_bezier_length(&b);
        double *sum = &length[root_of(root, set->piece.v[i].from)];
        all += size;
        most = fmax(most, *sum += size);
    }
    tz_free(t->ctx, root);
    tz_free(t->ctx, length);
    *net = most > all / 2;
    return s;
}

static tz_status find_filled(trimmer *t, rect *r)
{
    plane p = {0};
    coarse c;
    double far = 0;
    int32_t best[4] = {0};
    const float none = 4.0f * CELLS * CELLS;
    tz_status s = plane_init(t, &p);
    if (s == TZ_OK) {
        transform(&p);
        s = usual_distance(t, &p, &far);
    }
    if (s == TZ_OK) { /* discs about what is far from all lines */
        for (int32_t i = 0; i < p.w * p.h; i++)
            p.d[i] = p.d[i] > far ? 0 : none;
        transform(&p);
        sum_up(&p, far, &c);
        t->report.empty = (double)inside(&c, 0, 0, c.w, c.h) / (c.w * c.h);
        if (t->report.empty > EMPTY && largest(&c, best)) {
            const double cell = p.cell * CELLS / COARSE;
            t->report.filled = true;
            *r = (rect){{best[0] * cell, best[1] * cell},
                        {fmin(best[2] * cell, r->hi.x), fmin(best[3] * cell, r->hi.y)}};
        }
    }
    plane_deinit(t->ctx, &p);
    return s;
}

/* ---- ends at the sides ----------------------------------------------------------------- */

/* Depth of a place behind a side of the rectangle. */
static double depth(const rect *r, int side, tz_vec2 p)
{
    switch (side) {
    case TZ_CURVE_LEFT: return p.x - r->lo.x;
    case TZ_CURVE_TOP: return p.y - r->lo.y;
    case TZ_CURVE_RIGHT: return r->hi.x - p.x;
    default: return r->hi.y - p.y;
    }
}

/* Whether it lies between the sides beside that one. */
static bool between(const rect *r, int side, tz_vec2 p)
{
    return side == TZ_CURVE_LEFT || side == TZ_CURVE_RIGHT
               ? p.y >= r->lo.y && p.y <= r->hi.y
               : p.x >= r->lo.x && p.x <= r->hi.x;
}

/* Lines that cross the parallels at the middles of BINS depths up to the rectangle's
 * middle. */
static void count_lines(const trimmer *t, const rect *r, int side, double extent,
                        double count[BINS + 1])
{
    memset(count, 0, (BINS + 1) * sizeof *count);
    for (int32_t i = 0; i + 1 < t->chord.n; i += 2) {
        const tz_vec2 p = t->chord.v[i], q = t->chord.v[i + 1];
        if (!between(r, side, tz_vec2_scale(tz_vec2_add(p, q), 0.5)))
            continue;
        const double a = depth(r, side, p), b = depth(r, side, q);
        const double scale = 2 * BINS / extent;
        const double lo = fmin(fmax(ceil(fmin(a, b) * scale - 0.5), 0), BINS),
                     hi = fmin(fmax(ceil(fmax(a, b) * scale - 0.5), 0), BINS);
        count[(int32_t)lo] += 1;
        count[(int32_t)hi] -= 1;
    }
    for (int k = 1; k <= BINS; k++)
        count[k] += count[k - 1];
}

static double median(const double *v, int n)
{
    double copy[BINS];
    memcpy(copy, v, (size_t)n * sizeof *v);
    qsort(copy, (size_t)n, sizeof *copy, up);
    return copy[n / 2];
}

/* Depths of the ends that face the side, in order; those deeper than half are left out. */
static tz_status facing(const trimmer *t, const rect *r, int side, double extent,
                        double *d, int32_t *n)
{
    static const tz_vec2 normal[TZ_CURVE_SIDES] = {{-1, 0}, {0, -1}, {1, 0}, {0, 1}};
    *n = 0;
    for (int32_t i = 0; i < t->end.n; i++) {
        const loose_end *e = &t->end.v[i];
        const double at = depth(r, side, e->at);
        if (between(r, side, e->at) && at >= 0 && at < extent / 2 &&
            tz_vec2_dot(e->out, normal[side]) > FACING)
            d[(*n)++] = at;
    }
    if (*n > 1)
        qsort(d, (size_t)*n, sizeof *d, up);
    return tz_ctx_cancelled(t->ctx) ? TZ_CANCELLED : TZ_OK;
}

/* How deep a side is cut, 0 = not at all; of `extent`, at most `most`. */
static double cut_of(const double *count, const double *d, int32_t n, double extent,
                     double most, int32_t *ends)
{
    const int first = (int)(2 * BINS * MOST);
    const double usual = median(count + first, BINS - first);
    int32_t near = 0;
    *ends = 0;
    if (usual < FEW || !(most > 0))
        return 0;
    while (near < n && d[near] <= MOST * extent)
        near++;
    const double anywhere = (n - near) / ((0.5 - MOST) * extent);
    double best = SHARE * usual, at = 0;
    for (int32_t i = 0; i < near; i++) {
        const double cut = d[i] + BEYOND * extent;
        const double score =
            i + 1 - 2 * anywhere * cut - LOSS * usual * cut / (MOST * extent);
        if (cut > most)
            break;
        if (i + 1 >= LEAST && score > best) {
            best = score;
            at = cut;
            *ends = i + 1;
        }
    }
    /* before the first quarter of them has ended few lines are left */
    const int32_t quarter = *ends > 0 ? (*ends - 1) / 4 : 0;
    const int rim = (int)(2 * BINS * (*ends > 0 ? d[quarter] : 0) / extent);
    if (at > 0 && median(count, rim < 1 ? 1 : rim) < usual / 2)
        return at;
    *ends = 0;
    return 0;
}

static tz_status trim_sides(trimmer *t, rect *r)
{
    const rect whole = *r;
    double count[BINS + 1], *d = NULL;
    int32_t n, ends;
    tz_status s = tz_alloc(t->ctx, &d, (size_t)t->end.n, sizeof *d);
    for (int k = 0; k < PASSES * TZ_CURVE_SIDES && s == TZ_OK; k++) {
        const int side = k % TZ_CURVE_SIDES;
        const bool across = side == TZ_CURVE_LEFT || side == TZ_CURVE_RIGHT;
        const double extent = across ? whole.hi.x - whole.lo.x : whole.hi.y - whole.lo.y;
        double *edge = side == TZ_CURVE_LEFT    ? &r->lo.x
                       : side == TZ_CURVE_TOP   ? &r->lo.y
                       : side == TZ_CURVE_RIGHT ? &r->hi.x
                                                : &r->hi.y;
        const double gone = side == TZ_CURVE_LEFT    ? r->lo.x - whole.lo.x
                            : side == TZ_CURVE_TOP   ? r->lo.y - whole.lo.y
                            : side == TZ_CURVE_RIGHT ? whole.hi.x - r->hi.x
                                                     : whole.hi.y - r->hi.y;
        count_lines(t, r, side, extent, count);
        s = facing(t, r, side, extent, d, &n);
        const double cut = cut_of(count, d, n, extent, MOST * extent - gone, &ends);
        *edge += side < TZ_CURVE_RIGHT ? cut : -cut;
        t->report.ends[side] += ends;
    }
    tz_free(t->ctx, d);
    return s;
}

/* ---- all of it -------------------------------------------------------------------------- */

static tz_status measure(trimmer *t, const tz_curve_set *from, rect *r)
{
    const tz_curve_join_params join = {.crossings = true};
    const double side = fmax(from->domain.size.x, from->domain.size.y);
    bool net = false;
    tz_status s = tz_curve_join(t->ctx, from, &join, &t->set);
    t->set.ctx = t->ctx;
    if (s == TZ_OK)
        s = find_ends(t);
    if (s == TZ_OK)
        s = find_chords(t, side / (4 * CELLS));
    if (s == TZ_OK)
        s = is_net(t, &net);
    if (s == TZ_OK && net)
        s = find_filled(t, r);
    return s == TZ_OK ? trim_sides(t, r) : s;
}

tz_status tz_curve_trim(tz_ctx *ctx, const tz_curve_set *from, tz_curve_set *to,
                        tz_curve_trim_report *report)
{
    const tz_vec3 size = from->domain.size;
    trimmer t = {.ctx = ctx, .set = {.ctx = ctx}};
    tz_curve_set cut = {.ctx = ctx};
    rect r = {{0, 0}, {size.x, size.y}};
    tz_status s = TZ_OK;
    memset(to, 0, sizeof *to);
    if (from->path.n > 0 && from->element.photo.n == 0 && !from->domain.torus &&
        !from->domain.region && size.x > 0 && size.y > 0 && isfinite(size.x) &&
        isfinite(size.y))
        s = measure(&t, from, &r);
    t.report.at = r.lo;
    t.report.size = tz_vec2_sub(r.hi, r.lo);
    t.report.trimmed = r.lo.x > 0 || r.lo.y > 0 || r.hi.x < size.x || r.hi.y < size.y;
    const tz_curve_window window = {.at = r.lo, .size = t.report.size};
    tz_domain domain = from->domain;
    domain.size.x = t.report.size.x;
    domain.size.y = t.report.size.y;
    if (s == TZ_OK && t.report.trimmed) {
        s = tz_curve_clip(ctx, from, &window, &cut);
        if (s == TZ_OK)
            s = tz_curve_choose(ctx, &cut, NULL, NULL, &domain, tz_vec2_scale(r.lo, -1),
                                to);
    } else if (s == TZ_OK) {
        s = tz_curve_choose(ctx, from, NULL, NULL, NULL, (tz_vec2){0, 0}, to);
    }
    if (s == TZ_OK && report)
        *report = t.report;
    tz_curve_set_deinit(&t.set);
    tz_curve_set_deinit(&cut);
    tz_array_free(ctx, &t.end);
    tz_array_free(ctx, &t.chord);
    return s;
}
