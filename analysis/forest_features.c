/* SPDX-License-Identifier: Apache-2.0 */
/* Stages, each over the rows that the next one needs:
 *
 *   rgb -> padded Luv -> gradient magnitude M and bin -> M / (blur M + 0.01) ----+
 *               |                                          histogram of 2 x 2 ---+-> 13
 *               +-> half Luv -> the same without pooling ------------------------+   |
 *                                                        blur 1 -> regular <---------+
 *                                                        blur 4 -> coarse  <---------+
 *
 * Thresholds of a trained forest lie as close to values as the training data did, so sums
 * must come out to the last bit: see forest_rows.h. */
#include "analysis/forest_features.h"

#include <string.h>

#include "analysis/forest_rows.h"

#define BLOCK   16 /* rows a task */
#define BLUR    TZ_FOREST_BLUR
#define LANES   TZ_FOREST_LANES
#define CONTEXT (BLUR + 1) /* rows of half px that a raw position depends on */

/* Rows first .. first + rows - 1 of a plane, `stride` floats each. */
typedef struct plane {
    float *v;
    int32_t stride, first, rows;
} plane;

static float *row_of(const plane *p, int32_t y)
{
    return p->v + (size_t)(y - p->first) * (size_t)p->stride;
}

/* ... b a | a b ... */
static int32_t reflect(int32_t i, int32_t n)
{
    while (i < 0 || i >= n)
        i = i < 0 ? -1 - i : 2 * n - 1 - i;
    return i;
}

/* ... c b | a b c ... */
static int32_t reflect_101(int32_t i, int32_t n)
{
    while (n > 1 && (i < 0 || i >= n))
        i = i < 0 ? -i : 2 * n - 2 - i;
    return n > 1 ? i : 0;
}

typedef struct scale {
    int32_t width, height; /* px of this scale */
    plane luv[3];
    plane magnitude, bin, across;
} scale;

typedef struct work {
    tz_forest_row row;
    const void *source;
    const tz_forest_rows *loop;
    int32_t photo_width, photo_height;
    scale s[2]; /* full, half */
    tz_forest_features *f;
    float *scratch; /* a piece a worker */
    size_t scratch_size;
    float luminance[1064];
} work;

/* Rows of the stage that task i has. */
static void rows_of_task(const plane *p, int64_t i, int32_t *from, int32_t *to)
{
    *from = p->first + (int32_t)i * BLOCK;
    *to = *from + BLOCK < p->first + p->rows ? *from + BLOCK : p->first + p->rows;
}

static float *scratch(const work *k, int worker)
{
    return k->scratch + (size_t)worker * k->scratch_size;
}

/* ---- stages -------------------------------------------------------------------------- */

static tz_status luv_rows(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const work *k = arg;
    const scale *s = &k->s[0];
    const int32_t w = k->photo_width, pad = TZ_FOREST_PAD;
    float *rgb = scratch(k, worker);
    int32_t from, to;
    (void)ctx;
    rows_of_task(&s->luv[0], i, &from, &to);
    for (int32_t y = from; y < to; y++) {
        float *p[3], *inner[3];
        for (int c = 0; c < 3; c++)
            inner[c] = (p[c] = row_of(&s->luv[c], y)) + pad;
        k->row(k->source, reflect(y - pad, k->photo_height), rgb);
        k->loop->luv(k->luminance, rgb, w, inner);
        for (int c = 0; c < 3; c++)
            for (int32_t x = 0; x < pad; x++) {
                p[c][x] = inner[c][reflect(x - pad, w)];
                inner[c][w + x] = inner[c][reflect(w + x, w)];
            }
    }
    return TZ_OK;
}

static tz_status half_rows(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const work *k = arg;
    int32_t from, to;
    (void)ctx, (void)worker;
    rows_of_task(&k->s[1].luv[0], i, &from, &to);
    for (int c = 0; c < 3; c++)
        for (int32_t y = from; y < to; y++)
            k->loop->halve(row_of(&k->s[0].luv[c], 2 * y),
                           row_of(&k->s[0].luv[c], 2 * y + 1), k->s[1].width,
                           row_of(&k->s[1].luv[c], y));
    return TZ_OK;
}

/* Copies n groups of `step` floats with BLUR mirrored groups on either side. */
static void pad_row(const float *in, int32_t n, int32_t step, float *out)
{
    const size_t group = (size_t)step * sizeof *in;
    memcpy(out + BLUR * step, in, (size_t)n * group);
    for (int32_t i = 1; i <= BLUR; i++) {
        memcpy(out + (BLUR - i) * step, in + reflect_101(-i, n) * step, group);
        memcpy(out + (size_t)(BLUR + n - 1 + i) * (size_t)step,
               in + (size_t)reflect_101(n - 1 + i, n) * (size_t)step, group);
    }
}

static void gradient_rows(const work *k, const scale *s, int64_t i, int worker)
{
    const float *line[3][3];
    int32_t from, to;
    rows_of_task(&s->magnitude, i, &from, &to);
    for (int32_t y = from; y < to; y++) {
        float *m = row_of(&s->magnitude, y);
        for (int d = 0; d < 3; d++)
            for (int c = 0; c < 3; c++)
                line[d][c] = row_of(&s->luv[c], reflect(y + d - 1, s->height));
        k->loop->gradient(line[0], line[1], line[2], s->width, m, row_of(&s->bin, y));
        pad_row(m, s->width, 1, scratch(k, worker));
        k->loop->blur_across(scratch(k, worker), s->width, 1, row_of(&s->across, y));
    }
}

static tz_status full_gradients(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const work *k = arg;
    (void)ctx;
    gradient_rows(k, &k->s[0], i, worker);
    return TZ_OK;
}

static tz_status half_gradients(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const work *k = arg;
    (void)ctx;
    gradient_rows(k, &k->s[1], i, worker);
    return TZ_OK;
}

/* Row y of the magnitude over its surroundings. */
static void normalise_row(const work *k, const scale *s, int32_t y, float *out)
{
    const float *line[2 * BLUR + 1];
    for (int32_t d = -BLUR; d <= BLUR; d++)
        line[d + BLUR] = row_of(&s->across, reflect_101(y + d, s->height));
    k->loop->blur_down(line, s->width, out);
    k->loop->divide(row_of(&s->magnitude, y), s->width, out);
}

/* OpenCV halves magnitudes in fours of positions, and what is left over in another order
 * of sums. */
static float mean_of_four(const float *above, const float *below, bool four)
{
    const float up = above[0] + above[1];
    return (four ? up + (below[0] + below[1]) : up + below[0] + below[1]) * 0.25F;
}

/* 13 channels of one row of positions; `m` has room for five rows of half px. */
static void gather_row(const work *k, int32_t y, float *m, float *out)
{
    const scale *full = &k->s[0], *half = &k->s[1];
    const float *bin[2] = {row_of(&full->bin, 2 * y), row_of(&full->bin, 2 * y + 1)};
    const float *bh = row_of(&half->bin, y), *luv[3];
    float *below = m + full->width, *mh = below + full->width;
    normalise_row(k, full, 2 * y, m);
    normalise_row(k, full, 2 * y + 1, below);
    normalise_row(k, half, y, mh);
    for (int c = 0; c < 3; c++)
        luv[c] = row_of(&half->luv[c], y);
    memset(out, 0, (size_t)half->width * LANES * sizeof *out);
    for (int32_t x = 0; x < half->width; x++, out += LANES) {
        for (int c = 0; c < 3; c++)
            out[c] = luv[c][x];
        out[3] = mean_of_four(m + 2 * x, below + 2 * x, x < half->width / 4 * 4);
        for (int32_t i = 2 * x; i < 2 * x + 2; i++)
            out[4 + (int)bin[0][i]] += m[i] * 0.25F;
        for (int32_t i = 2 * x; i < 2 * x + 2; i++)
            out[4 + (int)bin[1][i]] += below[i] * 0.25F;
        out[8] = mh[x];
        out[9 + (int)bh[x]] = mh[x];
    }
}

/* Channels of a block of rows, and both blurs of them; all rows across are kept in
 * scratch. */
static tz_status value_rows(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const work *k = arg;
    const tz_forest_features *f = k->f;
    const int32_t n = f->width * LANES, height = f->height;
    const plane out = {f->value, 2 * n, f->first, f->rows};
    float *m = scratch(k, worker), *raw = m + (ptrdiff_t)6 * f->width;
    float *padded = raw + n, *a = padded + n + (ptrdiff_t)2 * BLUR * LANES;
    float *b = a + (ptrdiff_t)(BLOCK + 2 * BLUR) * n;
    int32_t from, to;
    rows_of_task(&out, i, &from, &to);
    const int32_t first = from - BLUR > 0 ? from - BLUR : 0;
    const int32_t last = to + BLUR < height ? to + BLUR : height;
    const plane wide = {a, n, first, last - first}, narrow = {b, n, first, last - first};
    for (int32_t y = first; y < last; y++) {
        gather_row(k, y, m, raw);
        pad_row(raw, f->width, LANES, padded);
        k->loop->blur_across(padded, n, LANES, row_of(&wide, y));
        if (y < from - 1 || y > to)
            continue;
        const float *const side[3] = {padded + (ptrdiff_t)(BLUR - 1) * LANES,
                                      padded + (ptrdiff_t)BLUR * LANES,
                                      padded + (ptrdiff_t)(BLUR + 1) * LANES};
        k->loop->blur_three(side, n, row_of(&narrow, y));
    }
    for (int32_t y = from; y < to; y++) {
        const float *line[2 * BLUR + 1];
        for (int32_t d = -BLUR; d <= BLUR; d++)
            line[d + BLUR] = row_of(&wide, reflect_101(y + d, height));
        k->loop->blur_down_lanes(line, f->width, row_of(&out, y) + LANES);
        for (int32_t d = -1; d <= 1; d++)
            line[d + 1] = row_of(&narrow, reflect_101(y + d, height));
        k->loop->blur_three_lanes(line, f->width, row_of(&out, y));
    }
    return tz_ctx_cancelled(ctx) ? TZ_CANCELLED : TZ_OK;
}

/* ---- driver -------------------------------------------------------------------------- */

/* Rows [from, to) as far as there are rows. */
static tz_status plane_init(tz_ctx *ctx, plane *p, int32_t stride, int32_t height,
                            int32_t from, int32_t to)
{
    from = from > 0 ? from : 0;
    to = to < height ? to : height;
    *p = (plane){NULL, stride, from, to - from};
    return tz_alloc(ctx, &p->v, (size_t)p->rows * (size_t)stride, sizeof *p->v);
}

static tz_status work_init(tz_ctx *ctx, work *k)
{
    const tz_forest_features *f = k->f;
    const int32_t from = f->first - BLUR > 0 ? f->first - BLUR : 0;
    const int32_t to =
        f->first + f->rows + BLUR < f->height ? f->first + f->rows + BLUR : f->height;
    tz_status s = TZ_OK;
    for (int i = 0; i < 2 && s == TZ_OK; i++) {
        scale *sc = &k->s[i];
        const int32_t up = i == 0 ? 2 : 1, w = sc->width, h = sc->height;
        const int32_t m0 = up * from - BLUR, m1 = up * to + BLUR;
        for (int c = 0; c < 3 && s == TZ_OK; c++)
            s = plane_init(ctx, &sc->luv[c], w, h, up * (from - CONTEXT),
                           up * (to + CONTEXT));
        if (s == TZ_OK)
            s = plane_init(ctx, &sc->magnitude, w, h, m0, m1);
        if (s == TZ_OK)
            s = plane_init(ctx, &sc->bin, w, h, m0, m1);
        if (s == TZ_OK)
            s = plane_init(ctx, &sc->across, w, h, m0, m1);
    }
    if (s != TZ_OK)
        return s;
    const size_t line = (size_t)f->width * LANES, pad = (size_t)2 * BLUR * LANES;
    k->scratch_size = (size_t)6 * f->width + (2 + 2 * (BLOCK + 2 * BLUR)) * line + pad;
    k->scratch_size = (k->scratch_size + 15) / 16 * 16;
    return tz_alloc(ctx, &k->scratch, (size_t)tz_ctx_threads(ctx) * k->scratch_size,
                    sizeof *k->scratch);
}

static void work_deinit(tz_ctx *ctx, work *k)
{
    for (int i = 0; i < 2; i++) {
        for (int c = 0; c < 3; c++)
            tz_free(ctx, k->s[i].luv[c].v);
        tz_free(ctx, k->s[i].magnitude.v);
        tz_free(ctx, k->s[i].bin.v);
        tz_free(ctx, k->s[i].across.v);
    }
    tz_free(ctx, k->scratch);
}

static tz_status run(tz_ctx *ctx, const plane *p, tz_task task, work *k)
{
    return tz_parallel_for(ctx, (p->rows + BLOCK - 1) / BLOCK, task, k);
}

tz_status tz_forest_features_init(tz_ctx *ctx, tz_forest_row row, const void *source,
                                  int32_t width, int32_t height, int32_t first,
                                  int32_t rows, tz_forest_features *f)
{
    const int32_t w = width + 2 * TZ_FOREST_PAD, h = height + 2 * TZ_FOREST_PAD;
    work k = {.row = row,
              .source = source,
              .loop = tz_forest_rows_get(),
              .photo_width = width,
              .photo_height = height,
              .s = {{.width = w, .height = h}, {.width = w / 2, .height = h / 2}},
              .f = f};
    tz_status s;
    *f = (tz_forest_features){
        .width = w / 2, .height = h / 2, .first = first, .rows = rows, .ctx = ctx};
    const size_t n = (size_t)rows * f->width;
    const plane out = {NULL, 0, first, rows};
    tz_forest_luminance_table(k.luminance);
    if ((s = work_init(ctx, &k)) != TZ_OK)
        goto done;
    if ((s = tz_alloc(ctx, &f->value, n, TZ_FOREST_STEP * sizeof(float))) != TZ_OK)
        goto done;
    if ((s = run(ctx, &k.s[0].luv[0], luv_rows, &k)) != TZ_OK)
        goto done;
    if ((s = run(ctx, &k.s[1].luv[0], half_rows, &k)) != TZ_OK)
        goto done;
    if ((s = run(ctx, &k.s[0].magnitude, full_gradients, &k)) != TZ_OK)
        goto done;
    if ((s = run(ctx, &k.s[1].magnitude, half_gradients, &k)) != TZ_OK)
        goto done;
    s = run(ctx, &out, value_rows, &k);
done:
    work_deinit(ctx, &k);
    if (s != TZ_OK)
        tz_forest_features_deinit(f);
    return s;
}

void tz_forest_features_deinit(tz_forest_features *f)
{
    tz_free(f->ctx, f->value);
    *f = (tz_forest_features){0};
}

void tz_forest_feature_place(int32_t id, int32_t width, int32_t *a, int32_t *b)
{
    /* middles of cells: (i + 1) (16 + 2 * 2 - 1) / 6 - 2, rounded */
    static const int32_t middle[TZ_FOREST_GRID] = {1, 4, 8, 11, 14};
    const int32_t side = TZ_FOREST_SIDE, cells = TZ_FOREST_GRID * TZ_FOREST_GRID;
    const int32_t step = TZ_FOREST_STEP;
    if (id < TZ_FOREST_REGULAR) {
        const int32_t z = id / (side * side), at = id % (side * side);
        const int32_t place = ((at % side) * width + at / side) * step;
        *a = place + z; /* column * 16 + row */
        *b = place + TZ_FOREST_CHANNELS;
        return;
    }
    const int32_t pair = id - TZ_FOREST_REGULAR, z = LANES + pair / TZ_FOREST_PAIRS;
    int32_t first = 0, left = pair % TZ_FOREST_PAIRS;
    while (left >= cells - 1 - first)
        left -= cells - 1 - first++;
    const int32_t second = first + 1 + left;
    *a = (middle[first % 5] * width + middle[first / 5]) * step + z;
    *b = (middle[second % 5] * width + middle[second / 5]) * step + z;
}
