/* SPDX-License-Identifier: Apache-2.0 */
/* Plates of other maps. A plate is made by patches, from coarse to fine, and so is the way
 * back found: on each level of a pyramid of the plate every pixel that is no ground looks
 * for the patch about a pixel of sure ground that is most like its own, in what its
 * neighbours have found (1 to 8 px away: all pixels of a round look at the last round's
 * finds, so that it does not matter who comes first) and in random places around its best.
 * On the finest one each pixel then has as many proposals as patches lie over it; the one
 * whose colour there is nearest is taken. */
#include "synthesis/plate_map.h"

#include <math.h>
#include <string.h>

#include "base/rng.h"

enum {
    LEVELS = 6,
    COARSEST = 48, /* px of the shorter side */
    R = 2,
    SIDE = 2 * R + 1,
    MOSTLY = 15, /* px of a patch that are ground, about a place to copy from */
    SEED = 20090801
};

/* How much photo and plate may differ where they are the same: quickly, slowly. */
#define GRAIN 0.008F
#define SLOW  0.15F
#define FOUND 1e-3F /* the error of a patch that need not be sought any more */

typedef struct level {
    int32_t w, h;
    float *v;      /* 3 a px: the plate */
    uint8_t *same; /* sure ground */
    int32_t
        *from; /* centre of the patch that is shown; own index where same; -1 = none */
    int32_t *next;  /* of the round under way */
    float *error;   /* of that patch */
    int32_t *place; /* n places that can be copied from */
    int32_t n;
} level;

typedef struct job {
    level at[LEVELS];
    int32_t levels;
    level *l;    /* of the round */
    int32_t now; /* its number within all rounds */
    int32_t jump;
    const tz_image *photo, *plate, *map;
    tz_image *out;
} job;

/* ---- levels -------------------------------------------------------------------------- */

static tz_status open_level(tz_ctx *ctx, level *l, int32_t w, int32_t h)
{
    const size_t n = (size_t)w * (size_t)h;
    l->w = w, l->h = h;
    tz_status s = tz_alloc(ctx, &l->v, 3 * n, sizeof *l->v);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &l->same, n, 1);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &l->from, n, sizeof *l->from);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &l->next, n, sizeof *l->next);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &l->error, n, sizeof *l->error);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &l->place, n, sizeof *l->place);
    return s;
}

static void close_levels(tz_ctx *ctx, job *b)
{
    for (int32_t k = 0; k < LEVELS; k++) {
        level *l = &b->at[k];
        tz_free(ctx, l->v);
        tz_free(ctx, l->same);
        tz_free(ctx, l->from);
        tz_free(ctx, l->next);
        tz_free(ctx, l->error);
        tz_free(ctx, l->place);
    }
}

static void colour_of(const tz_image *im, int32_t x, int32_t y, float v[3])
{
    const float *p = tz_image_at(im, x, y);
    int32_t n = 0;
    v[0] = 0;
    for (int32_t k = 0; k < im->channels && n < 3; k++)
        if (k != im->alpha)
            v[n++] = p[k];
    for (; n < 3; n++)
        v[n] = v[0];
}

/* Whether photo and plate show the same about (x, y): within 3 x 3 px they differ by one
 * small number. */
static bool same_at(const job *b, int32_t x, int32_t y)
{
    float mean[3] = {0}, square = 0, n = 0;
    for (int32_t v = y - 1; v <= y + 1; v++)
        for (int32_t u = x - 1; u <= x + 1; u++) {
            float p[3] = {0}, q[3] = {0};
            if (u < 0 || v < 0 || u >= b->photo->width || v >= b->photo->height)
                continue;
            colour_of(b->photo, u, v, p);
            colour_of(b->plate, u, v, q);
            for (int c = 0; c < 3; c++) {
                mean[c] += p[c] - q[c];
                square += (p[c] - q[c]) * (p[c] - q[c]);
            }
            n++;
        }
    float off = square;
    for (int c = 0; c < 3; c++) {
        off -= mean[c] * mean[c] / n;
        if (fabsf(mean[c]) > SLOW * n)
            return false;
    }
    return off <= 3 * n * GRAIN * GRAIN;
}

static tz_status compare_row(tz_ctx *ctx, void *arg, int64_t y, int worker)
{
    job *b = arg;
    level *l = &b->at[0];
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < l->w; x++) {
        colour_of(b->plate, x, (int32_t)y, &l->v[3 * (y * l->w + x)]);
        l->next[y * l->w + x] = same_at(b, x, (int32_t)y);
    }
    return TZ_OK;
}

/* Ground about which all is ground: what agrees by chance is left out. */
static tz_status erode_row(tz_ctx *ctx, void *arg, int64_t y, int worker)
{
    level *l = ((job *)arg)->at;
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < l->w; x++) {
        bool all = true;
        for (int32_t v = (int32_t)y - 1; v <= y + 1; v++)
            for (int32_t u = x - 1; u <= x + 1; u++)
                if (u >= 0 && v >= 0 && u < l->w && v < l->h)
                    all = all && l->next[(int64_t)v * l->w + u];
        l->same[y * l->w + x] = all;
    }
    return TZ_OK;
}

static void halve(const level *f, level *l)
{
    for (int32_t y = 0; y < l->h; y++)
        for (int32_t x = 0; x < l->w; x++) {
            const int64_t to = (int64_t)y * l->w + x;
            float sum[3] = {0};
            int same = 0;
            for (int k = 0; k < 4; k++) {
                const int64_t p = (int64_t)(2 * y + k / 2) * f->w + 2 * x + k % 2;
                same += f->same[p];
                for (int c = 0; c < 3; c++)
                    sum[c] += f->v[3 * p + c];
            }
            l->same[to] = same >= 3;
            for (int c = 0; c < 3; c++)
                l->v[3 * to + c] = 0.25F * sum[c];
        }
}

/* Places whose patches lie within the plate and are ground for the most part. */
static void find_places(level *l)
{
    for (int32_t y = R; y + R < l->h; y++)
        for (int32_t x = R; x + R < l->w; x++) {
            const int64_t at = (int64_t)y * l->w + x;
            int n = 0;
            for (int32_t v = -R; v <= R && l->same[at]; v++)
                for (int32_t u = -R; u <= R; u++)
                    n += l->same[at + (int64_t)v * l->w + u];
            if (n >= MOSTLY)
                l->place[l->n++] = (int32_t)at;
        }
}

/* ---- search -------------------------------------------------------------------------- */

static float distance(const level *l, int32_t at, int32_t from, float most)
{
    const int32_t x = at % l->w, y = at / l->w;
    float sum = 0;
    for (int32_t v = -R; v <= R && sum < most; v++)
        for (int32_t u = -R; u <= R; u++) {
            /* beyond the border nothing is compared */
            if (x + u < 0 || y + v < 0 || x + u >= l->w || y + v >= l->h)
                continue;
            const float *p = l->v + 3 * (at + (int64_t)v * l->w + u),
                        *q = l->v + 3 * (from + (int64_t)v * l->w + u);
            for (int c = 0; c < 3; c++)
                sum += (p[c] - q[c]) * (p[c] - q[c]);
        }
    return sum;
}

static bool can_copy(const level *l, int32_t x, int32_t y)
{
    return x >= R && y >= R && x + R < l->w && y + R < l->h &&
           l->same[(int64_t)y * l->w + x];
}

static void propose(const level *l, int32_t at, int32_t x, int32_t y, int32_t *best,
                    float *error)
{
    const int32_t from = y * l->w + x;
    if (!can_copy(l, x, y) || from == *best)
        return;
    const float d = distance(l, at, from, *error);
    if (d < *error)
        *error = d, *best = from;
}

static tz_status search_row(tz_ctx *ctx, void *arg, int64_t row, int worker)
{
    const job *b = arg;
    const level *l = b->l;
    const int32_t y = (int32_t)row;
    tz_rng rng = tz_rng_make(SEED, (uint64_t)b->now << 32 | (uint64_t)row);
    (void)worker;
    for (int32_t x = 0; x < l->w; x++) {
        const int32_t at = y * l->w + x;
        int32_t best = l->from[at];
        float error = l->error[at];
        l->next[at] = best;
        if (l->same[at])
            continue;
        for (int k = 0; k < 9 && error > FOUND; k++) {
            const int32_t dx = (k % 3 - 1) * b->jump, dy = (k / 3 - 1) * b->jump;
            if ((dx == 0 && dy == 0) || x + dx < 0 || y + dy < 0 || x + dx >= l->w ||
                y + dy >= l->h)
                continue;
            const int32_t f = l->from[(int64_t)(y + dy) * l->w + x + dx];
            if (f >= 0)
                propose(l, at, f % l->w - dx, f / l->w - dy, &best, &error);
        }
        const int32_t far = l->place[tz_rng_below(&rng, l->n)];
        if (error > FOUND)
            propose(l, at, far % l->w, far / l->w, &best, &error);
        for (int32_t r = 16; r > 0 && best >= 0 && error > FOUND; r /= 4) {
            const int32_t dx = (int32_t)tz_rng_below(&rng, 2 * r + 1) - r,
                          dy = (int32_t)tz_rng_below(&rng, 2 * r + 1) - r;
            propose(l, at, best % l->w + dx, best / l->w + dy, &best, &error);
        }
        l->next[at] = best;
        l->error[at] = error;
    }
    return tz_ctx_cancelled(ctx) ? TZ_CANCELLED : TZ_OK;
}

/* What the next coarser level has found, or nothing. */
static void start_level(level *l, const level *coarse)
{
    for (int32_t y = 0; y < l->h; y++)
        for (int32_t x = 0; x < l->w; x++) {
            const int32_t at = y * l->w + x;
            l->from[at] = l->same[at] ? at : -1;
            l->error[at] = INFINITY;
            if (l->same[at] || !coarse || x / 2 >= coarse->w || y / 2 >= coarse->h)
                continue;
            const int32_t f = coarse->from[(int64_t)(y / 2) * coarse->w + x / 2];
            if (f >= 0)
                propose(l, at, 2 * (f % coarse->w) + x % 2, 2 * (f / coarse->w) + y % 2,
                        &l->from[at], &l->error[at]);
        }
}

static tz_status search(tz_ctx *ctx, job *b)
{
    static const int32_t jump[] = {8, 4, 2, 1, 8, 4, 2, 1, 4, 2, 1, 1};
    enum { ROUNDS = sizeof jump / sizeof *jump, FINE = 5 };
    tz_status s = TZ_OK;
    const level *coarse = NULL;
    for (int32_t k = b->levels - 1; k >= 0 && s == TZ_OK; k--) {
        level *l = b->l = &b->at[k];
        if (l->n == 0)
            continue;
        start_level(l, coarse);
        for (int32_t i = coarse ? ROUNDS - FINE : 0; i < ROUNDS && s == TZ_OK; i++) {
            b->jump = jump[i];
            b->now = k * ROUNDS + i;
            s = tz_parallel_for(ctx, l->h, search_row, b);
            int32_t *t = l->from;
            l->from = l->next;
            l->next = t;
        }
        coarse = l;
    }
    return s;
}

/* ---- the map ------------------------------------------------------------------------- */

/* Where the plate's pixel (x, y) comes from: of all patches over it, the one that shows
 * its colour best. */
static int32_t origin_of(const level *l, int32_t x, int32_t y)
{
    const int32_t at = y * l->w + x;
    const float *own = l->v + 3 * (int64_t)at;
    int32_t best = at;
    float least = INFINITY;
    if (l->same[at])
        return at;
    for (int32_t v = -R; v <= R; v++)
        for (int32_t u = -R; u <= R; u++) {
            if (x + u < 0 || y + v < 0 || x + u >= l->w || y + v >= l->h)
                continue;
            const int64_t p = at + (int64_t)v * l->w + u;
            const int32_t f = l->same[p] ? -1 : l->from[p];
            if (f < 0)
                continue;
            const int32_t q = f - v * l->w - u;
            if (!l->same[q])
                continue;
            const float *c = l->v + 3 * (int64_t)q;
            float d = l->error[p] / (SIDE * SIDE);
            for (int k = 0; k < 3; k++)
                d += (c[k] - own[k]) * (c[k] - own[k]);
            if (d < least)
                least = d, best = q;
        }
    return best;
}

static tz_status copy_row(tz_ctx *ctx, void *arg, int64_t row, int worker)
{
    const job *b = arg;
    const level *l = &b->at[0];
    const int32_t w = b->map->width, h = b->map->height, y = (int32_t)row;
    const double sx = (double)w / l->w, sy = (double)h / l->h;
    const int32_t py = (int32_t)fmin((y + 0.5) / sy, l->h - 1);
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < w; x++) {
        const int32_t px = (int32_t)fmin((x + 0.5) / sx, l->w - 1);
        const int32_t from = origin_of(l, px, py);
        int32_t u = x + (int32_t)rint((from % l->w - px) * sx),
                v = y + (int32_t)rint((from / l->w - py) * sy);
        u = u < 0 ? 0 : u < w ? u : w - 1;
        v = v < 0 ? 0 : v < h ? v : h - 1;
        memcpy(tz_image_at(b->out, x, y), tz_image_at(b->map, u, v),
               (size_t)b->map->channels * sizeof *b->map->px);
    }
    return TZ_OK;
}

static tz_status check(tz_ctx *ctx, const tz_image *photo, const tz_image *plate,
                       const tz_image *map)
{
    const double sx = (double)map->width / photo->width,
                 sy = (double)map->height / photo->height;
    const int32_t side = photo->width > photo->height ? photo->width : photo->height;
    if (plate->width != photo->width || plate->height != photo->height ||
        plate->channels - (plate->alpha >= 0) != photo->channels - (photo->alpha >= 0))
        return tz_fail(ctx, TZ_INVALID,
                       "plate: is %d x %d px of %d channels, the photo %d x %d of %d; "
                       "make both alike",
                       plate->width, plate->height, plate->channels, photo->width,
                       photo->height, photo->channels);
    if (!(fabs(sx - sy) * side <= 1.5))
        return tz_fail(ctx, TZ_INVALID,
                       "map: is %d x %d px, the photo %d x %d; resize it to the same "
                       "proportions",
                       map->width, map->height, photo->width, photo->height);
    return TZ_OK;
}

static tz_status open_levels(tz_ctx *ctx, job *b)
{
    tz_status s = open_level(ctx, &b->at[0], b->photo->width, b->photo->height);
    b->levels = 1;
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, b->at[0].h, compare_row, b);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, b->at[0].h, erode_row, b);
    while (s == TZ_OK && b->levels < LEVELS) {
        const level *f = &b->at[b->levels - 1];
        const int32_t w = f->w / 2, h = f->h / 2;
        if ((w < h ? w : h) < COARSEST)
            break;
        s = open_level(ctx, &b->at[b->levels++], w, h);
        if (s == TZ_OK)
            halve(f, &b->at[b->levels - 1]);
    }
    for (int32_t k = 0; k < b->levels && s == TZ_OK; k++)
        find_places(&b->at[k]);
    return s;
}

tz_status tz_plate_map(tz_ctx *ctx, const tz_image *photo, const tz_image *plate,
                       const tz_image *map, tz_image *out)
{
    *out = (tz_image){0};
    tz_status s = check(ctx, photo, plate, map);
    if (s != TZ_OK)
        return s;
    job *b = NULL;
    s = tz_image_copy(ctx, map, out);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &b, 1, sizeof *b);
    if (s != TZ_OK)
        goto done;
    b->photo = photo, b->plate = plate, b->map = map, b->out = out;
    s = open_levels(ctx, b);
    if (s == TZ_OK && b->at[0].n > 0)
        s = search(ctx, b);
    if (s == TZ_OK && b->at[0].n > 0)
        s = tz_parallel_for(ctx, map->height, copy_row, b);
    close_levels(ctx, b);
done:
    tz_free(ctx, b);
    if (s != TZ_OK)
        tz_image_deinit(out);
    return s;
}
