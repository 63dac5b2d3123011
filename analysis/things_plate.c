/* SPDX-License-Identifier: Apache-2.0 */
/* What is surely ground is kept, evened out (things_even.c). The rest is filled with patches
 * of it, from coarse to fine: every patch that touches the hole looks for its nearest in
 * the ground (PatchMatch: neighbours hand on what they have found, random looks around it),
 * then each pixel of the hole becomes the mean of what the patches over it propose, the
 * better ones counting more; twice as fine, the same places are the start. Joints are
 * narrower than patches: a patch serves where most of it is ground, and proposes only what
 * is. Levels on which there is too little ground are left out; where there is too little
 * on all, the hole is filled smoothly from the ground around it, with grain as strong as
 * the ground's.
 * @source Wexler, Shechtman, Irani, PAMI 2007; Barnes et al., PatchMatch, SIGGRAPH 2009 */
#include "analysis/things_plate.h"

#include <string.h>

#include "analysis/things_even.h"
#include "base/rng.h"

enum {
    LEVELS = 6,
    R = 2,
    SIDE = 2 * R + 1,
    CHANNELS = TZ_THINGS_EVEN_CHANNELS,
    FEW = 300,
    COARSEST = 24,
    MANY = 500000, /* px of a level, from which on coarser ones must have settled it */
    MOSTLY = 15    /* px of a patch that are ground */
};

typedef struct level {
    int32_t w, h;
    float *v;       /* w * h * CHANNELS */
    uint8_t *known; /* w * h: kept, and good to fill the rest with */
    uint8_t *whole; /* w * h: most of the patch about it is known */
    int32_t *from;  /* w * h: centre of the patch that it shows, -1 = not looked for */
    float *error;   /* w * h: of that patch */
    TZ_ARRAY(int32_t)
    source; /* centres of such patches */
} level;

typedef struct plate {
    tz_ctx *ctx;
    level at[LEVELS];
    int32_t n;
} plate;

/* ---- levels -------------------------------------------------------------------------- */

static tz_status open_level(plate *f, int32_t w, int32_t h)
{
    level *l = &f->at[f->n++];
    const size_t n = (size_t)w * (size_t)h;
    l->w = w;
    l->h = h;
    tz_status s = tz_alloc_zero(f->ctx, &l->v, n * CHANNELS, sizeof *l->v);
    if (s == TZ_OK)
        s = tz_alloc_zero(f->ctx, &l->known, n, 1);
    return s;
}

static void close_levels(plate *f)
{
    for (int32_t i = 0; i < f->n; i++) {
        level *l = &f->at[i];
        tz_free(f->ctx, l->v);
        tz_free(f->ctx, l->known);
        tz_free(f->ctx, l->whole);
        tz_free(f->ctx, l->from);
        tz_free(f->ctx, l->error);
        tz_array_free(f->ctx, &l->source);
    }
}

/* Half the size: means of what is known, if half of it is. */
static tz_status halve(plate *f)
{
    const int32_t w = f->at[f->n - 1].w / 2, h = f->at[f->n - 1].h / 2;
    const tz_status s = open_level(f, w, h);
    const level *fine = &f->at[f->n - 2];
    level *l = &f->at[f->n - 1];
    for (int32_t y = 0; y < h && s == TZ_OK; y++)
        for (int32_t x = 0; x < w; x++) {
            const ptrdiff_t to = (ptrdiff_t)y * w + x;
            float sum[CHANNELS] = {0};
            int32_t known = 0;
            for (int k = 0; k < 4; k++) {
                const ptrdiff_t p = (ptrdiff_t)(2 * y + k / 2) * fine->w + 2 * x + k % 2;
                known += fine->known[p];
                for (int c = 0; c < CHANNELS && fine->known[p]; c++)
                    sum[c] += fine->v[p * CHANNELS + c];
            }
            l->known[to] = known >= 2;
            for (int c = 0; c < CHANNELS && known > 0; c++)
                l->v[to * CHANNELS + c] = sum[c] / (float)known;
        }
    return s;
}

/* Centres of patches, known themselves, most of which is known. */
static tz_status find_sources(plate *f, level *l)
{
    tz_status s = tz_alloc_zero(f->ctx, &l->whole, (size_t)l->w * (size_t)l->h, 1);
    for (int32_t y = R; y + R < l->h && s == TZ_OK; y++) {
        int32_t column[SIDE] = {0}, sum = 0;
        for (int32_t x = 0; x < l->w && s == TZ_OK; x++) {
            int32_t known = 0; /* in the column at x, which replaces the leftmost */
            for (int32_t d = -R; d <= R; d++)
                known += l->known[(ptrdiff_t)(y + d) * l->w + x];
            sum += known - column[x % SIDE];
            column[x % SIDE] = known;
            const ptrdiff_t p = (ptrdiff_t)y * l->w + x - R;
            if (x < SIDE - 1 || sum < MOSTLY || !l->known[p])
                continue;
            l->whole[p] = 1;
            s = tz_array_push(f->ctx, &l->source, (int32_t)p);
        }
    }
    return s;
}

/* ---- smooth fill --------------------------------------------------------------------- */

typedef struct sums {
    int32_t w, h;
    float *v; /* w * h * (CHANNELS + 1): sums, count */
} sums;

/* Means over ever larger blocks, until one holds something; then back, interpolated. */
static tz_status fill_smoothly(tz_ctx *ctx, level *l)
{
    enum { MOST = 24, C = CHANNELS + 1 };
    sums p[MOST] = {{0}};
    int32_t n = 1;
    tz_status s = TZ_OK;
    p[0] = (sums){l->w, l->h, NULL};
    for (int32_t i = 0; i < MOST && s == TZ_OK; i++) {
        sums *q = &p[i];
        n = i + 1;
        if (i > 0)
            q->w = (p[i - 1].w + 1) / 2, q->h = (p[i - 1].h + 1) / 2;
        s = tz_alloc_zero(ctx, &q->v, (size_t)q->w * (size_t)q->h * C, sizeof *q->v);
        const int32_t w = i ? p[i - 1].w : l->w, h = i ? p[i - 1].h : l->h;
        for (int32_t y = 0; y < h && s == TZ_OK; y++)
            for (int32_t x = 0; x < w; x++) {
                const ptrdiff_t from = (ptrdiff_t)y * w + x;
                const ptrdiff_t to = i ? (ptrdiff_t)(y / 2) * q->w + x / 2 : from;
                if (i == 0 && l->known[from]) {
                    for (int c = 0; c < CHANNELS; c++)
                        q->v[to * C + c] = l->v[from * CHANNELS + c];
                    q->v[to * C + CHANNELS] = 1;
                } else if (i > 0 && p[i - 1].v[from * C + CHANNELS] > 0) {
                    const float *a = p[i - 1].v + from * C; /* weights stay below 1 */
                    for (int c = 0; c < C; c++)
                        q->v[to * C + c] += a[c];
                }
            }
        for (ptrdiff_t k = 0; i > 0 && s == TZ_OK && k < (ptrdiff_t)q->w * q->h; k++) {
            const float weight = q->v[k * C + CHANNELS];
            if (weight > 1)
                for (int c = 0; c < C; c++)
                    q->v[k * C + c] /= weight;
        }
        if (q->w == 1 && q->h == 1)
            break;
    }
    for (int32_t i = n - 2; i >= 0 && s == TZ_OK; i--)
        for (int32_t y = 0; y < p[i].h; y++)
            for (int32_t x = 0; x < p[i].w; x++) {
                float *a = p[i].v + ((ptrdiff_t)y * p[i].w + x) * C, up[C] = {0};
                if (a[CHANNELS] >= 1)
                    continue;
                const float cx = 0.5F * (float)x - 0.25F, cy = 0.5F * (float)y - 0.25F;
                for (int k = 0; k < 4; k++) { /* bilinear, clamped */
                    int32_t ux = (int32_t)floorf(cx) + k % 2,
                            uy = (int32_t)floorf(cy) + k / 2;
                    const float fx = 1 - fabsf(cx - (float)ux),
                                fy = 1 - fabsf(cy - (float)uy);
                    ux = ux < 0 ? 0 : ux < p[i + 1].w ? ux : p[i + 1].w - 1;
                    uy = uy < 0 ? 0 : uy < p[i + 1].h ? uy : p[i + 1].h - 1;
                    const float *b = p[i + 1].v + ((ptrdiff_t)uy * p[i + 1].w + ux) * C;
                    for (int c = 0; c < C; c++)
                        up[c] += fx * fy * b[c];
                }
                const float rest =
                    up[CHANNELS] > 0 ? (1 - a[CHANNELS]) / up[CHANNELS] : 0;
                for (int c = 0; c < CHANNELS; c++)
                    a[c] += rest * up[c];
                a[CHANNELS] = 1;
            }
    for (ptrdiff_t k = 0; s == TZ_OK && k < (ptrdiff_t)l->w * l->h; k++)
        for (int c = 0; c < CHANNELS && !l->known[k]; c++)
            l->v[k * CHANNELS + c] = p[0].v[k * C + c];
    for (int32_t i = 0; i < n; i++)
        tz_free(ctx, p[i].v);
    return s;
}

/* Lightness noise as strong as that of the known pixels against those beside them. */
static void add_grain(level *l)
{
    double square = 0;
    int64_t n = 0;
    for (ptrdiff_t p = 1; p < (ptrdiff_t)l->w * l->h; p++)
        if (l->known[p] && l->known[p - 1] && p % l->w) {
            const double d = l->v[p * CHANNELS + 1] - l->v[(p - 1) * CHANNELS + 1];
            square += d * d;
            n++;
        }
    const double deviation = n > 0 ? fmin(sqrt(0.5 * square / (double)n), 0.04) : 0;
    for (int32_t y = 0; y < l->h; y++) {
        tz_rng g = tz_rng_make(1, tz_rng_stream(0x91a7e, (uint64_t)y, 0));
        for (int32_t x = 0; x < l->w; x++) {
            const ptrdiff_t p = (ptrdiff_t)y * l->w + x;
            const float d = (float)(deviation * tz_rng_normal(&g));
            for (int c = 0; c < CHANNELS && !l->known[p]; c++)
                l->v[p * CHANNELS + c] = fmaxf(0, l->v[p * CHANNELS + c] + d);
        }
    }
}

/* ---- patches ------------------------------------------------------------------------- */

/* Squared difference of the patches about p and a source q, up to `most`. */
static float compare(const level *l, int32_t x, int32_t y, int32_t q, float most)
{
    float sum = 0;
    const int32_t y0 = y < R ? -y : -R, y1 = y + R < l->h ? R : l->h - 1 - y;
    const int32_t x0 = x < R ? -x : -R, x1 = x + R < l->w ? R : l->w - 1 - x;
    const float scale = (float)(SIDE * SIDE) / (float)((y1 - y0 + 1) * (x1 - x0 + 1));
    for (int32_t dy = y0; dy <= y1 && sum * scale < most; dy++) {
        const float *a = l->v + ((ptrdiff_t)(y + dy) * l->w + x + x0) * CHANNELS,
                    *b = l->v + ((ptrdiff_t)q + (ptrdiff_t)dy * l->w + x0) * CHANNELS;
        for (int32_t k = 0; k < (x1 - x0 + 1) * CHANNELS; k++)
            sum += (a[k] - b[k]) * (a[k] - b[k]);
    }
    return sum * scale;
}

static void try(level *l, int32_t x, int32_t y, int32_t sx, int32_t sy)
{
    const ptrdiff_t p = (ptrdiff_t)y * l->w + x;
    if (sx < R || sy < R || sx + R >= l->w || sy + R >= l->h)
        return;
    const int32_t q = sy * l->w + sx;
    if (!l->whole[q] || q == l->from[p])
        return;
    const float e = compare(l, x, y, q, l->error[p]);
    if (e < l->error[p]) {
        l->error[p] = e;
        l->from[p] = q;
    }
}

/* One pass of PatchMatch, forwards or back. */
static void search(level *l, int32_t pass, uint64_t name)
{
    const int32_t step = pass % 2 ? -1 : 1;
    for (int32_t i = 0; i < l->h; i++) {
        const int32_t y = step > 0 ? i : l->h - 1 - i;
        tz_rng g = tz_rng_make(1, tz_rng_stream(name, (uint64_t)pass, (uint64_t)y));
        for (int32_t j = 0; j < l->w; j++) {
            const int32_t x = step > 0 ? j : l->w - 1 - j;
            const ptrdiff_t p = (ptrdiff_t)y * l->w + x;
            if (l->from[p] < 0)
                continue;
            const int32_t bx = x - step, by = y - step;
            if (bx >= 0 && bx < l->w && l->from[p - step] >= 0)
                try(l, x, y, l->from[p - step] % l->w + step, l->from[p - step] / l->w);
            if (by >= 0 && by < l->h && l->from[p - step * l->w] >= 0)
                try(l, x, y, l->from[p - step * l->w] % l->w,
                    l->from[p - step * l->w] / l->w + step);
            const int32_t any = l->source.v[tz_rng_below(&g, l->source.n)];
            try(l, x, y, any % l->w, any / l->w);
            const int32_t r = 8;
            try(l, x, y, l->from[p] % l->w + tz_rng_below(&g, 2 * r + 1) - r,
                l->from[p] / l->w + tz_rng_below(&g, 2 * r + 1) - r);
        }
    }
}

/* Errors of the places as they are, after the hole has changed. */
static void measure(level *l)
{
    for (int32_t y = 0; y < l->h; y++)
        for (int32_t x = 0; x < l->w; x++) {
            const ptrdiff_t p = (ptrdiff_t)y * l->w + x;
            if (l->from[p] >= 0)
                l->error[p] = compare(l, x, y, l->from[p], HUGE_VALF);
        }
}

/* Each pixel of the hole: mean over the patches that hold it, or over every `step`-th of
 * them along x and y. */
static tz_status vote(tz_ctx *ctx, level *l, int32_t step)
{
    const size_t n = (size_t)l->w * (size_t)l->h;
    float *out = NULL;
    const tz_status s = tz_alloc(ctx, &out, n * CHANNELS, sizeof *out);
    if (s != TZ_OK)
        return s;
    memcpy(out, l->v, n * CHANNELS * sizeof *out);
    for (int32_t y = 0; y < l->h; y++)
        for (int32_t x = 0; x < l->w; x++) {
            const ptrdiff_t p = (ptrdiff_t)y * l->w + x;
            float sum[CHANNELS] = {0}, weight = 0;
            if (l->known[p])
                continue;
            for (int32_t dy = -R; dy <= R; dy += step)
                for (int32_t dx = -R; dx <= R; dx += step) {
                    const int32_t cx = x + dx, cy = y + dy;
                    const ptrdiff_t c = p + (ptrdiff_t)dy * l->w + dx;
                    if (cx < 0 || cy < 0 || cx >= l->w || cy >= l->h || l->from[c] < 0)
                        continue;
                    const ptrdiff_t q = l->from[c] - (ptrdiff_t)dy * l->w - dx;
                    if (!l->known[q])
                        continue;
                    const float e = l->error[c] + 1e-3F, k = 1 / (e * e);
                    weight += k;
                    for (int i = 0; i < CHANNELS; i++)
                        sum[i] += k * l->v[q * CHANNELS + i];
                }
            for (int i = 0; i < CHANNELS && weight > 0; i++)
                out[p * CHANNELS + i] = sum[i] / weight;
        }
    tz_free(ctx, l->v);
    l->v = out;
    return TZ_OK;
}

/* A first picture of the hole: each pixel as its own patch has it. */
static void copy_places(level *l)
{
    for (ptrdiff_t p = 0; p < (ptrdiff_t)l->w * l->h; p++)
        if (!l->known[p])
            memcpy(l->v + p * CHANNELS, l->v + (ptrdiff_t)l->from[p] * CHANNELS,
                   CHANNELS * sizeof *l->v);
}

static bool touches_hole(const level *l, int32_t x, int32_t y)
{
    for (int32_t dy = -R; dy <= R; dy++)
        for (int32_t dx = -R; dx <= R; dx++)
            if (x + dx >= 0 && y + dy >= 0 && x + dx < l->w && y + dy < l->h &&
                !l->known[(ptrdiff_t)(y + dy) * l->w + x + dx])
                return true;
    return false;
}

/* First places: those of the coarser level, else any. */
static tz_status start(plate *f, level *l, const level *coarse, uint64_t name)
{
    const size_t n = (size_t)l->w * (size_t)l->h;
    tz_status s = tz_alloc(f->ctx, &l->from, n, sizeof *l->from);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &l->error, n, sizeof *l->error);
    for (int32_t y = 0; y < l->h && s == TZ_OK; y++) {
        tz_rng g = tz_rng_make(1, tz_rng_stream(name, 1000, (uint64_t)y));
        for (int32_t x = 0; x < l->w; x++) {
            const ptrdiff_t p = (ptrdiff_t)y * l->w + x;
            l->from[p] = -1;
            l->error[p] = HUGE_VALF;
            if (!touches_hole(l, x, y))
                continue;
            int32_t q = -1;
            if (coarse && x / 2 < coarse->w && y / 2 < coarse->h) {
                const int32_t c = coarse->from[(ptrdiff_t)(y / 2) * coarse->w + x / 2];
                if (c >= 0)
                    q = (2 * (c / coarse->w) + y % 2) * l->w + 2 * (c % coarse->w) +
                        x % 2;
                if (q >= 0 && !l->whole[q])
                    q = -1;
            }
            l->from[p] = q >= 0 ? q : l->source.v[tz_rng_below(&g, l->source.n)];
        }
    }
    return s;
}

/* Coarse to fine from level `top`; the hole of `top` is filled smoothly before. */
static tz_status fill_by_patches(plate *f, int32_t top)
{
    tz_status s = fill_smoothly(f->ctx, &f->at[top]);
    for (int32_t i = top; i >= 0 && s == TZ_OK; i--) {
        level *l = &f->at[i];
        const level *coarse = i < top ? &f->at[i + 1] : NULL;
        const int64_t pixels = (int64_t)l->w * l->h;
        const int32_t rounds = i == top          ? 6
                               : pixels < 70000  ? 4
                               : pixels < 200000 ? 2
                                                 : 1;
        s = start(f, l, coarse, (uint64_t)i);
        if (s == TZ_OK && coarse)
            copy_places(l);
        for (int32_t k = 0; k < rounds && s == TZ_OK; k++) {
            if (tz_ctx_cancelled(f->ctx))
                return TZ_CANCELLED;
            measure(l);
            if (!coarse || pixels < MANY) { /* else they are good enough */
                search(l, 2 * k, (uint64_t)i);
                search(l, 2 * k + 1, (uint64_t)i);
            }
            s = vote(f->ctx, l, i == 0 && pixels >= MANY ? 2 : 1);
        }
    }
    return s;
}

/* ---- driver -------------------------------------------------------------------------- */

/* The darkest pixels, where there is no ground at all. */
static void take_darkest(level *l)
{
    const ptrdiff_t n = (ptrdiff_t)l->w * l->h;
    int64_t dark[256] = {0};
    int32_t least = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (ptrdiff_t p = 0; p < n; p++) {
            const float g = l->v[p * CHANNELS + 1];
            const int32_t k = (int32_t)(255 * (g > 0 ? (g < 1 ? g : 1) : 0));
            if (pass)
                l->known[p] = k <= least;
            else
                dark[k]++;
        }
        for (int64_t below = dark[0]; !pass && below < n / 50 + 1;)
            below += dark[++least];
    }
}

static void take_photo(level *l, const tz_image *photo)
{
    for (int32_t y = 0; y < l->h; y++)
        for (int32_t x = 0; x < l->w; x++)
            for (int c = 0; c < CHANNELS; c++) {
                const float v = tz_image_at(photo, x, y)[photo->channels >= 3 ? c : 0];
                l->v[((ptrdiff_t)y * l->w + x) * CHANNELS + c] = v == v ? v : 0;
            }
}

static tz_status fill(plate *f)
{
    int32_t top = -1;
    tz_status s = find_sources(f, &f->at[0]);
    while (s == TZ_OK && f->n < LEVELS && f->at[f->n - 1].source.n >= FEW &&
           f->at[f->n - 1].w >= 2 * COARSEST && f->at[f->n - 1].h >= 2 * COARSEST) {
        s = halve(f);
        if (s == TZ_OK)
            s = find_sources(f, &f->at[f->n - 1]);
    }
    for (int32_t i = 0; i < f->n; i++)
        if (f->at[i].source.n >= FEW)
            top = i;
    if (s == TZ_OK && top >= 0)
        return fill_by_patches(f, top);
    if (s == TZ_OK)
        s = fill_smoothly(f->ctx, &f->at[0]);
    if (s == TZ_OK)
        add_grain(&f->at[0]);
    return s;
}

tz_status tz_things_plate(tz_ctx *ctx, const tz_image *photo,
                          const tz_things_ground *ground, tz_image *out)
{
    plate f = {.ctx = ctx};
    const int32_t w = photo->width, h = photo->height;
    const int32_t channels = photo->channels >= 3 ? 3 : 1;
    const int32_t cell = ground->size > 8 ? (int32_t)fmin(ground->size, 512) : 8;
    tz_status s = tz_image_init(ctx, out, w, h, channels);
    if (s == TZ_OK)
        s = open_level(&f, w, h);
    if (s == TZ_OK) {
        out->encoding = photo->encoding;
        out->depth = photo->depth;
        take_photo(&f.at[0], photo);
        memcpy(f.at[0].known, ground->sure, (size_t)w * (size_t)h);
        if (!(ground->share > 0))
            take_darkest(&f.at[0]);
        s = tz_things_even(ctx, f.at[0].v, f.at[0].known, w, h, cell);
    }
    if (s == TZ_OK)
        s = fill(&f);
    if (s == TZ_OK) { /* patches gather in islands of like colours */
        memset(f.at[0].known, 1, (size_t)w * (size_t)h);
        s = tz_things_even(ctx, f.at[0].v, f.at[0].known, w, h, (cell + 1) / 2);
    }
    for (int32_t y = 0; y < h && s == TZ_OK; y++)
        for (int32_t x = 0; x < w; x++)
            for (int c = 0; c < channels; c++)
                tz_image_at(out, x, y)[c] =
                    f.at[0].v[((ptrdiff_t)y * w + x) * CHANNELS + c];
    close_levels(&f);
    if (s != TZ_OK)
        tz_image_deinit(out);
    return s;
}
