/* SPDX-License-Identifier: Apache-2.0 */
/* Verbatim repetition: the share of 48-px patches that occur again elsewhere.
 *
 * Everything happens on a band-passed lightness D = blur(L, 1.2) - blur(L, 3), so that
 * shading, gradient-domain composition and 8-bit rounding do not hide a copy.
 *
 *   1. Anchors: local extrema of D. They move with the content, so that a copy at any
 *      integer offset has its anchors at the same places of the patch.
 *   2. Codes: 64 comparisons of D at pairs of points around the anchor [Calonder et al.
 *      2010]. Equal 16-bit quarters of a code bring anchors together (multi-index hashing
 *      [Norouzi et al. 2012]); those within a few bits are pairs, each votes an offset.
 *   3. Patches on a grid: the offsets that most anchors inside voted for are tried; the
 *      patch occurs again if the normalised cross-correlation of D with the patch at
 *      some offset is at least NCC_COPY (a copy). It nearly does where that is so with
 *      each ninth of the patch moved by up to WARP px to where it fits best: stretched or
 *      turned a little, a copy is no longer verbatim, yet an eye knows it again.
 *
 * Patches without structure never count: D must have contrast, and the patch must not
 * resemble itself under a small shift (a straight edge, a fine lattice: such a thing looks
 * the same in many places without being a copy). What the exemplar repeats of itself is
 * taken off: (share - own) / (1 - own). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/filter_cv.h"
#include "analysis/quality_measures.h"
#include "base/array.h"
#include "base/rng.h"

#define SIDE          TZ_QUALITY_REPEAT
#define STEP          16   /* grid of patches tested */
#define FAR           SIDE /* least offset: the two patches do not overlap */
#define NCC_COPY      0.92 /* a copy */
#define NCC_TRY       0.35 /* worth a look whether it is a copy but for a slight warp */
#define WARPED        2    /* offsets looked at so, a patch */
#define PART          16   /* side of the parts that a warp moves .. */
#define WARP          2    /* .. by so many px: 8 % of stretch, 5 degrees */
#define CELL          4    /* offsets of one cell are voted for together, px */
#define NCC_SELF      0.75 /* resembles itself SELF_SHIFT px further: no structure */
#define SELF_SHIFT    8
#define CONTRAST      0.3 /* least rms of D, of 100 */
#define RADIUS        11  /* of the code's neighbourhood */
#define EXTREMUM      2   /* radius in which an anchor is the extremum */
#define CODE_DISTANCE 10  /* bits of 64 */
#define WINDOW        12  /* neighbours compared in the order of codes */
#define TRIES         8   /* offsets verified a patch */
#define LEAST_VOTES   3   /* an anchor has up to four for an offset, one a quarter */

typedef struct anchor {
    int32_t crop, x, y;
    uint64_t code;
} anchor;

typedef struct match {
    int32_t from, to; /* anchors */
} match;

typedef TZ_ARRAY(anchor)
anchors;
typedef TZ_ARRAY(match)
matches;

typedef struct repeat_search {
    const tz_quality_picture *p;
    float *band[TZ_QUALITY_CROPS]; /* D */
    anchors anchor;
    int32_t crop_first[TZ_QUALITY_CROPS + 1]; /* anchors of a crop */
    int32_t *row_first[TZ_QUALITY_CROPS];     /* and of its rows, h + 1 */
    matches quarter[4];
    int32_t *first;  /* anchor -> its matches, n + 1 */
    int32_t *target; /* anchors matched */
    int8_t pair[64][4];
} repeat_search;

/* ---- band ----------------------------------------------------------------------- */

typedef struct band_job {
    const tz_quality_planes *f;
    float *wide, *out;
} band_job;

static tz_status band_rows(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const band_job *j = arg;
    int32_t w = j->f->w, h = j->f->h;
    int32_t y0 = (int32_t)i * TZ_QUALITY_BAND, y1 = tz_quality_band_end(i, h);
    (void)worker;
    tz_status s = tz_cv_blur(ctx, j->f->v[0], j->out, w, h, y0, y1, 1.2);
    if (s == TZ_OK)
        s = tz_cv_blur(ctx, j->f->v[0], j->wide, w, h, y0, y1, 3);
    for (size_t k = (size_t)y0 * w; s == TZ_OK && k < (size_t)y1 * w; k++)
        j->out[k] -= j->wide[k];
    return s;
}

static tz_status make_band(tz_ctx *ctx, const tz_quality_planes *f, float **out)
{
    band_job j = {.f = f};
    size_t n = (size_t)f->w * f->h;
    tz_status s = tz_alloc(ctx, out, n, sizeof(float));
    if (s == TZ_OK)
        s = tz_alloc(ctx, &j.wide, n, sizeof(float));
    j.out = *out;
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, tz_quality_bands(f->h), band_rows, &j);
    tz_free(ctx, j.wide);
    return s;
}

/* ---- anchors -------------------------------------------------------------------- */

static void draw_pairs(repeat_search *r)
{
    tz_rng g = tz_rng_make(0, tz_rng_stream('b', 0, 0));
    for (int k = 0; k < 64; k++)
        for (int e = 0; e < 4; e++) {
            double v = tz_rng_normal(&g) * RADIUS / 2.2;
            v = v > RADIUS ? RADIUS : v < -RADIUS ? -RADIUS : v;
            r->pair[k][e] = (int8_t)lround(v);
        }
}

static uint64_t code_at(const repeat_search *r, const float *d, int32_t w)
{
    uint64_t code = 0;
    for (int k = 0; k < 64; k++) {
        const int8_t *e = r->pair[k];
        code |= (uint64_t)(d[e[1] * w + e[0]] > d[e[3] * w + e[2]]) << k;
    }
    return code;
}

static bool is_extremum(const float *d, int32_t w)
{
    float v = *d, sign = v > 0 ? 1 : -1;
    if (v * sign < CONTRAST)
        return false;
    if (sign * d[-1] >= sign * v || sign * d[1] > sign * v)
        return false;
    for (int32_t y = -EXTREMUM; y <= EXTREMUM; y++)
        for (int32_t x = -EXTREMUM; x <= EXTREMUM; x++) {
            float o = sign * d[y * w + x], m = sign * v;
            if (o > m || (o == m && (y < 0 || (y == 0 && x < 0))))
                return false;
        }
    return true;
}

typedef struct anchor_job {
    repeat_search *r;
    int32_t crop;
    anchors *band;
} anchor_job;

static tz_status anchor_band(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const anchor_job *j = arg;
    const tz_quality_planes *f = &j->r->p->at[j->crop].gauss[0];
    int32_t y0 = (int32_t)i * TZ_QUALITY_BAND, y1 = tz_quality_band_end(i, f->h);
    tz_status s = TZ_OK;
    (void)worker;
    y0 = y0 < RADIUS ? RADIUS : y0;
    y1 = y1 > f->h - RADIUS ? f->h - RADIUS : y1;
    for (int32_t y = y0; y < y1; y++)
        for (int32_t x = RADIUS; x < f->w - RADIUS && s == TZ_OK; x++) {
            const float *d = j->r->band[j->crop] + (size_t)y * f->w + x;
            if (!is_extremum(d, f->w))
                continue;
            anchor a = {j->crop, x, y, code_at(j->r, d, f->w)};
            s = tz_array_push(ctx, &j->band[i], a);
        }
    return s;
}

/* Anchors of all crops, by crop, row and column; row_first finds those of a row. */
static tz_status find_anchors(tz_ctx *ctx, repeat_search *r)
{
    tz_status s = TZ_OK;
    for (int32_t c = 0; c < r->p->n && s == TZ_OK; c++) {
        const tz_quality_planes *f = &r->p->at[c].gauss[0];
        int64_t n = tz_quality_bands(f->h);
        anchor_job j = {.r = r, .crop = c};
        r->crop_first[c] = r->anchor.n;
        s = make_band(ctx, f, &r->band[c]);
        if (s == TZ_OK)
            s = tz_alloc_zero(ctx, &j.band, (size_t)n, sizeof *j.band);
        if (s == TZ_OK)
            s = tz_alloc(ctx, &r->row_first[c], (size_t)f->h + 1, sizeof(int32_t));
        if (s == TZ_OK)
            s = tz_parallel_for(ctx, n, anchor_band, &j);
        for (int64_t i = 0; i < n && j.band; i++) {
            for (int32_t k = 0; k < j.band[i].n && s == TZ_OK; k++)
                s = tz_array_push(ctx, &r->anchor, j.band[i].v[k]);
            tz_array_free(ctx, &j.band[i]);
        }
        tz_free(ctx, j.band);
        r->crop_first[c + 1] = r->anchor.n;
        if (s != TZ_OK)
            break;
        int32_t at = r->crop_first[c];
        for (int32_t y = 0; y <= f->h; y++) {
            while (at < r->anchor.n && r->anchor.v[at].y < y)
                at++;
            r->row_first[c][y] = at;
        }
    }
    return s;
}

/* ---- pairs ---------------------------------------------------------------------- */

typedef struct coded {
    uint64_t code;
    int32_t id;
} coded;

static int by_code(const void *a, const void *b)
{
    const coded *p = a, *q = b;
    if (p->code != q->code)
        return p->code < q->code ? -1 : 1;
    return p->id < q->id ? -1 : p->id > q->id;
}

/* Whether two places of the whole picture are apart by FAR at least. */
static bool far_apart(const tz_quality_picture *p, int32_t crop_a, int32_t xa, int32_t ya,
                      int32_t crop_b, int32_t xb, int32_t yb)
{
    int32_t dx = p->crop[crop_a].x + xa - p->crop[crop_b].x - xb;
    int32_t dy = p->crop[crop_a].y + ya - p->crop[crop_b].y - yb;
    return abs(dx) >= FAR || abs(dy) >= FAR;
}

/* Quarter k of the codes turned to the front, then neighbours in the order. */
static tz_status match_quarter(tz_ctx *ctx, void *arg, int64_t k, int worker)
{
    repeat_search *r = arg;
    int32_t n = r->anchor.n;
    int turn = (int)k * 16;
    coded *c;
    (void)worker;
    tz_status s = tz_alloc(ctx, &c, (size_t)n, sizeof *c);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n; i++) {
        uint64_t code = r->anchor.v[i].code;
        c[i] = (coded){turn ? code << turn | code >> (64 - turn) : code, i};
    }
    qsort(c, (size_t)n, sizeof *c, by_code);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        for (int32_t j = i + 1; j < n && j <= i + WINDOW && s == TZ_OK; j++) {
            if (c[i].code >> 48 != c[j].code >> 48)
                break;
            if (__builtin_popcountll(c[i].code ^ c[j].code) > CODE_DISTANCE)
                continue;
            const anchor *a = &r->anchor.v[c[i].id], *b = &r->anchor.v[c[j].id];
            if (!far_apart(r->p, a->crop, a->x, a->y, b->crop, b->x, b->y))
                continue;
            match m = {c[i].id, c[j].id};
            s = tz_array_push(ctx, &r->quarter[k], m);
        }
    tz_free(ctx, c);
    return s;
}

/* Pairs of all quarters as lists: anchor i has target[first[i] .. first[i + 1] - 1]. */
static tz_status list_matches(tz_ctx *ctx, repeat_search *r)
{
    int32_t n = r->anchor.n;
    int64_t total = 0;
    for (int k = 0; k < 4; k++)
        total += 2 * (int64_t)r->quarter[k].n;
    tz_status s = tz_alloc_zero(ctx, &r->first, (size_t)n + 2, sizeof(int32_t));
    if (s == TZ_OK)
        s = tz_alloc(ctx, &r->target, (size_t)total, sizeof(int32_t));
    if (s != TZ_OK)
        return s;
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < 4; k++)
            for (int32_t i = 0; i < r->quarter[k].n; i++) {
                match m = r->quarter[k].v[i];
                if (pass == 0) {
                    r->first[m.from + 2]++, r->first[m.to + 2]++;
                } else {
                    r->target[r->first[m.from + 1]++] = m.to;
                    r->target[r->first[m.to + 1]++] = m.from;
                }
            }
        for (int32_t i = 0; i < n && pass == 0; i++)
            r->first[i + 2] += r->first[i + 1];
    }
    return TZ_OK;
}

/* ---- patches -------------------------------------------------------------------- */

/* Sums of squares and products of two patches, every `skip`-th row; a sum a column, so
 * that the order of sums is fixed and columns go side by side. D has no mean to take off. */
static void products(const float *a, int32_t stride_a, const float *b, int32_t stride_b,
                     int32_t skip, double sum[3])
{
    float aa[SIDE] = {0}, bb[SIDE] = {0}, ab[SIDE] = {0};
    for (int32_t y = 0; y < SIDE; y += skip) {
        const float *u = a + (size_t)y * stride_a, *v = b + (size_t)y * stride_b;
        for (int32_t x = 0; x < SIDE; x++) {
            aa[x] += u[x] * u[x];
            bb[x] += v[x] * v[x];
            ab[x] += u[x] * v[x];
        }
    }
    sum[0] = sum[1] = sum[2] = 0;
    for (int x = 0; x < SIDE; x++)
        sum[0] += (double)aa[x], sum[1] += (double)bb[x], sum[2] += (double)ab[x];
}

/* Normalised cross-correlation; 0 where one of both has no contrast. */
static double correlate(const float *a, int32_t stride_a, const float *b,
                        int32_t stride_b, int32_t skip)
{
    double s[3], least = SIDE * SIDE * CONTRAST * CONTRAST / skip;
    products(a, stride_a, b, stride_b, skip, s);
    return s[0] < least || s[1] < least ? 0 : s[2] / sqrt(s[0] * s[1]);
}

/* The same where each part of the patch may move by WARP px to where it fits best. */
static double correlate_warped(const float *a, int32_t w, const tz_quality_planes *f,
                               const float *d, int32_t tx, int32_t ty)
{
    double aa = 0, bb = 0, ab = 0;
    for (int32_t block = 0; block < (SIDE / PART) * (SIDE / PART); block++) {
        int32_t x0 = block % (SIDE / PART) * PART, y0 = block / (SIDE / PART) * PART;
        double best = -2, own[3] = {0};
        for (int32_t s = 0; s < (2 * WARP + 1) * (2 * WARP + 1); s++) {
            int32_t x = tx + x0 + s % (2 * WARP + 1) - WARP;
            int32_t y = ty + y0 + s / (2 * WARP + 1) - WARP;
            if (x < 0 || y < 0 || x > f->w - PART || y > f->h - PART)
                continue;
            float uu[PART] = {0}, vv[PART] = {0}, uv[PART] = {0};
            for (int32_t k = 0; k < PART; k++) {
                const float *u = a + (size_t)(y0 + k) * w + x0;
                const float *v = d + (size_t)(y + k) * f->w + x;
                for (int32_t i = 0; i < PART; i++) {
                    uu[i] += u[i] * u[i];
                    vv[i] += v[i] * v[i];
                    uv[i] += u[i] * v[i];
                }
            }
            double t[3] = {0};
            for (int32_t i = 0; i < PART; i++)
                t[0] += (double)uu[i], t[1] += (double)vv[i], t[2] += (double)uv[i];
            double ncc = t[2] / sqrt(t[0] * t[1] + 1e-9);
            if (ncc > best) {
                best = ncc;
                memcpy(own, t, sizeof own);
            }
        }
        aa += own[0], bb += own[1], ab += own[2];
    }
    return aa > 0 && bb > 0 ? ab / sqrt(aa * bb) : 0;
}

/* Whether the patch differs from itself at a small shift in every direction. */
static bool has_structure(const float *d, int32_t w, int32_t h, int32_t x, int32_t y)
{
    static const int8_t shift[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
    const float *a = d + (size_t)y * w + x;
    if (correlate(a, w, a, w, 1) == 0)
        return false;
    for (int k = 0; k < 4; k++) {
        int32_t dx = shift[k][0] * SELF_SHIFT, dy = shift[k][1] * SELF_SHIFT;
        if (x + dx > w - SIDE || y + dy < 0 || y + dy > h - SIDE) {
            dx = -dx, dy = -dy; /* the other way, at the far borders */
            if (x + dx < 0 || y + dy < 0 || y + dy > h - SIDE)
                continue;
        }
        if (correlate(a, w, a + (int64_t)dy * w + dx, w, 2) > NCC_SELF)
            return false;
    }
    return true;
}

/* Votes for offsets of one cell of CELL x CELL px. */
typedef struct vote {
    int64_t key; /* crop, dy / CELL, dx / CELL */
    int32_t n, crop;
    int32_t dx, dy; /* that most votes in a row agreed on, else the first */
    int32_t hold;   /* Boyer-Moore majority counter of dx, dy */
} vote;

#define VOTES    768
#define SLOTS    2048 /* of the hash table, a power of two */
#define KEY_BITS 23
#define KEY_BIAS ((int64_t)1 << (KEY_BITS - 1))

static bool more_votes(vote a, vote b) { return a.n != b.n ? a.n > b.n : a.key < b.key; }

/* The offsets that most anchors inside a patch vote for, most votes first. */
static int32_t gather_votes(const repeat_search *r, int32_t crop, int32_t x, int32_t y,
                            vote top[TRIES])
{
    vote v[VOTES];
    int16_t slot[SLOTS];
    int32_t n = 0, all = 0, m = 0;
    memset(slot, -1, sizeof slot);
    for (int32_t row = y; row < y + SIDE; row++)
        for (int32_t i = r->row_first[crop][row]; i < r->row_first[crop][row + 1]; i++) {
            const anchor *a = &r->anchor.v[i];
            if (a->x < x || a->x >= x + SIDE)
                continue;
            for (int32_t k = r->first[i]; k < r->first[i + 1] && all < VOTES;
                 k++, all++) {
                const anchor *b = &r->anchor.v[r->target[k]];
                int32_t dx = b->x - a->x, dy = b->y - a->y;
                int64_t key = (int64_t)b->crop << (2 * KEY_BITS) |
                              (dy + KEY_BIAS) / CELL << KEY_BITS | (dx + KEY_BIAS) / CELL;
                uint32_t h = (uint32_t)((uint64_t)key * 0x9e3779b97f4a7c15u >> 53);
                while (slot[h] >= 0 && v[slot[h]].key != key)
                    h = (h + 1) & (SLOTS - 1);
                if (slot[h] < 0) {
                    slot[h] = (int16_t)n;
                    v[n++] = (vote){.key = key, .crop = b->crop, .dx = dx, .dy = dy};
                }
                vote *o = &v[slot[h]];
                o->n++;
                if (o->dx == dx && o->dy == dy)
                    o->hold++;
                else if (--o->hold < 0)
                    o->dx = dx, o->dy = dy, o->hold = 1;
            }
        }
    for (int32_t i = 0; i < n; i++) {
        if (v[i].n < LEAST_VOTES || (m == TRIES && !more_votes(v[i], top[m - 1])))
            continue;
        int32_t at = m < TRIES ? m++ : m - 1;
        for (; at > 0 && more_votes(v[i], top[at - 1]); at--)
            top[at] = top[at - 1];
        top[at] = v[i];
    }
    return m;
}

enum { NEW, NEAR_COPY, COPY };

static int occurs_again(const repeat_search *r, int32_t crop, int32_t x, int32_t y)
{
    vote v[TRIES];
    int32_t n = gather_votes(r, crop, x, y, v), w = r->p->at[crop].gauss[0].w, m = 0;
    const float *a = r->band[crop] + (size_t)y * w + x;
    for (int32_t i = 0; i < n; i++) {
        int32_t to = v[i].crop, tx = x + v[i].dx, ty = y + v[i].dy;
        const tz_quality_planes *f = &r->p->at[to].gauss[0];
        if (tx < 0 || ty < 0 || tx > f->w - SIDE || ty > f->h - SIDE ||
            !far_apart(r->p, crop, x, y, to, tx, ty))
            continue;
        double ncc = correlate(a, w, r->band[to] + (size_t)ty * f->w + tx, f->w, 1);
        if (ncc >= NCC_COPY)
            return COPY;
        if (ncc >= NCC_TRY && m < WARPED)
            v[m++] = v[i];
    }
    for (int32_t i = 0; i < m; i++) {
        const tz_quality_planes *f = &r->p->at[v[i].crop].gauss[0];
        if (correlate_warped(a, w, f, r->band[v[i].crop], x + v[i].dx, y + v[i].dy) >=
            NCC_COPY)
            return NEAR_COPY;
    }
    return NEW;
}

/* Counts of patches. */
typedef struct patch_count {
    int64_t structured, copies, near; /* near: copies too */
} patch_count;

typedef struct patch_job {
    repeat_search *r;
    int32_t crop;
    patch_count *row; /* a row of patches */
    float *heat;
} patch_job;

static void paint(const patch_job *j, int32_t x, int32_t y, float v)
{
    int32_t w = j->r->p->at[j->crop].gauss[0].w, inner = (SIDE - STEP) / 2;
    for (int32_t k = 0; k < STEP; k++)
        for (int32_t i = 0; i < STEP; i++)
            j->heat[(size_t)(y + inner + k) * w + x + inner + i] = v;
}

static tz_status patch_row(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const patch_job *j = arg;
    const tz_quality_planes *f = &j->r->p->at[j->crop].gauss[0];
    const float *d = j->r->band[j->crop];
    int32_t y = (int32_t)i * STEP;
    (void)ctx, (void)worker;
    for (int32_t x = 0; x <= f->w - SIDE; x += STEP) {
        if (!has_structure(d, f->w, f->h, x, y))
            continue;
        int again = occurs_again(j->r, j->crop, x, y);
        j->row[i].structured++;
        j->row[i].copies += again == COPY;
        j->row[i].near += again != NEW;
        if (j->heat && again != NEW)
            paint(j, x, y, again == COPY ? 1 : 0.6f);
    }
    return TZ_OK;
}

/* ---- share ---------------------------------------------------------------------- */

typedef struct repeat_share {
    double copies, near;
} repeat_share;

static tz_status count_patches(tz_ctx *ctx, repeat_search *r, float *heat,
                               repeat_share *share)
{
    int64_t all = 0;
    patch_count sum = {0};
    tz_status s = TZ_OK;
    for (int32_t c = 0; c < r->p->n && s == TZ_OK; c++) {
        const tz_quality_planes *f = &r->p->at[c].gauss[0];
        if (f->w < SIDE || f->h < SIDE)
            continue;
        int64_t rows = (f->h - SIDE) / STEP + 1;
        patch_job j = {.r = r, .crop = c, .heat = heat};
        s = tz_alloc_zero(ctx, &j.row, (size_t)rows, sizeof *j.row);
        if (s == TZ_OK)
            s = tz_parallel_for(ctx, rows, patch_row, &j);
        for (int64_t i = 0; i < rows && s == TZ_OK; i++) {
            sum.structured += j.row[i].structured;
            sum.copies += j.row[i].copies;
            sum.near += j.row[i].near;
        }
        all += rows * ((f->w - SIDE) / STEP + 1);
        tz_free(ctx, j.row);
    }
    /* where hardly a patch has structure, few repeats must not pass for many */
    double of = fmax((double)sum.structured, 0.1 * (double)all);
    *share = (repeat_share){of > 0 ? (double)sum.copies / of : 0,
                            of > 0 ? (double)sum.near / of : 0};
    return s;
}

static tz_status repeated_share(tz_ctx *ctx, const tz_quality_picture *p, float *heat,
                                repeat_share *share)
{
    repeat_search r = {.p = p};
    draw_pairs(&r);
    tz_status s = find_anchors(ctx, &r);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, 4, match_quarter, &r);
    if (s == TZ_OK)
        s = list_matches(ctx, &r);
    if (s == TZ_OK)
        s = count_patches(ctx, &r, heat, share);
    for (int32_t c = 0; c < TZ_QUALITY_CROPS; c++) {
        tz_free(ctx, r.band[c]);
        tz_free(ctx, r.row_first[c]);
        tz_array_free(ctx, &r.quarter[c]);
    }
    tz_array_free(ctx, &r.anchor);
    tz_free(ctx, r.first);
    tz_free(ctx, r.target);
    return s;
}

static double beyond(double share, double own)
{
    return share > own ? (share - own) / (1 - own) : 0;
}

tz_status tz_quality_repetition(tz_ctx *ctx, const tz_quality_work *w, tz_quality *q)
{
    repeat_share own = {0}, share = {0};
    tz_status s = repeated_share(ctx, w->exemplar, NULL, &own);
    if (s == TZ_OK)
        s = repeated_share(ctx, w->output, w->heat_repeat, &share);
    q->repetition = beyond(share.copies, own.copies);
    q->repetition_near = fmax(beyond(share.near, own.near), q->repetition);
    return s;
}
