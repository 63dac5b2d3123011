/* SPDX-License-Identifier: Apache-2.0 */
/* Between things lies ground, and things that were missed. Ground is either narrow, as
 * joints are against the things at their sides, or of the same colours as what is narrow:
 *
 *   candidates   no thing, not doubtful, not in the blurred rim of a thing
 *   narrow       a disc of WIDE of the middle thing's diameter does not fit there (opening)
 *   colours      median and median distance of the narrow candidates; of all, where few
 *                are narrow
 *   sure         candidates whose colour, a mean of SIDE x SIDE, is within FAR spreads
 *
 * The colours are found twice, the second time of what is within them. */
#include "analysis/things_ground.h"

#include <math.h>

#include "analysis/things_mask.h"

enum { BINS = 512, SIDE = 5, RIM = 5, PASSES = 3 };

#define WIDE  0.5   /* of the middle diameter */
#define FAR   2.6   /* spreads */
#define LEAST 0.012 /* of a spread, of the full range */
#define FEW   0.004 /* of the picture: fewer candidates than that are taken from nearer */

typedef struct work {
    tz_ctx *ctx;
    const tz_image *photo;
    const int32_t *label;
    int32_t w, h, count;
    float *colour;  /* w * h * 3: means of SIDE x SIDE */
    uint8_t *about; /* w * h: 1 = candidate, 2 = and narrow */
    tz_things_ground g;
} work;

void tz_things_colour(const float *px, int32_t channels, float colour[3])
{
    float v[3];
    for (int k = 0; k < 3; k++) {
        v[k] = px[channels >= 3 ? k : 0];
        v[k] = v[k] > 0 ? (v[k] < 1 ? v[k] : 1) : 0;
    }
    colour[0] = (v[0] + v[1] + v[2]) / 3;
    colour[1] = v[0] - v[1];
    colour[2] = 0.5F * (v[0] + v[1]) - v[2];
}

/* ---- colours ------------------------------------------------------------------------- */

/* Sums along x, then along y, clamped at the border. */
static tz_status blur_colours(work *k)
{
    const int32_t w = k->w, h = k->h, r = SIDE / 2;
    float *row = NULL;
    tz_status s = tz_alloc(k->ctx, &k->colour, (size_t)w * (size_t)h * 3, sizeof(float));
    if (s == TZ_OK)
        s = tz_alloc(k->ctx, &row, (size_t)w * (size_t)h * 3, sizeof *row);
    for (int32_t y = 0; y < h && s == TZ_OK; y++) {
        float *to = row + (ptrdiff_t)y * w * 3;
        for (int32_t x = 0; x < w; x++) {
            to[3 * x] = to[3 * x + 1] = to[3 * x + 2] = 0;
            for (int32_t d = -r; d <= r; d++) {
                const int32_t at = x + d < 0 ? 0 : x + d < w ? x + d : w - 1;
                float c[3];
                tz_things_colour(tz_image_at(k->photo, at, y), k->photo->channels, c);
                for (int i = 0; i < 3; i++)
                    to[3 * x + i] += c[i] / SIDE;
            }
        }
    }
    for (int32_t y = 0; y < h && s == TZ_OK; y++) {
        float *to = k->colour + (ptrdiff_t)y * w * 3;
        for (int32_t i = 0; i < 3 * w; i++)
            to[i] = 0;
        for (int32_t d = -r; d <= r; d++) {
            const int32_t at = y + d < 0 ? 0 : y + d < h ? y + d : h - 1;
            for (int32_t i = 0; i < 3 * w; i++)
                to[i] += row[(ptrdiff_t)at * w * 3 + i] / SIDE;
        }
    }
    tz_free(k->ctx, row);
    return s;
}

static int32_t bin_of(double v)
{
    const double b = v * (BINS - 1);
    return b > 0 ? (b < BINS - 1 ? (int32_t)b : BINS - 1) : 0;
}

/* Middle of the bin that holds the middle of the counts. */
static double middle_of(const int64_t *bin, int64_t all)
{
    int64_t below = 0;
    int32_t b = 0;
    while (b + 1 < BINS && 2 * (below + bin[b]) < all)
        below += bin[b++];
    return (b + 0.5) / (BINS - 1);
}

static double distance2(const tz_things_ground *g, const float *c)
{
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        const double d = (c[i] - g->middle[i]) / g->spread[i];
        sum += d * d;
    }
    return sum;
}

/* Median and median distance of the pixels that are at least `about`; from the second pass
 * on, of those within the colours found before. Channel 0 is 0..1, others -1..1. */
static void measure(work *k, int32_t about, int32_t pass)
{
    const ptrdiff_t n = (ptrdiff_t)k->w * k->h;
    const tz_things_ground old = k->g;
    for (int i = 0; i < 3; i++) {
        int64_t value[BINS] = {0}, far[BINS] = {0}, all = 0;
        const double from = i ? -1 : 0, range = i ? 2 : 1;
        for (ptrdiff_t p = 0; p < n; p++) {
            if (k->about[p] < about ||
                (pass > 0 && distance2(&old, k->colour + 3 * p) > FAR * FAR))
                continue;
            value[bin_of((k->colour[3 * p + i] - from) / range)]++;
            all++;
        }
        if (all == 0)
            continue;
        k->g.middle[i] = from + range * middle_of(value, all);
        for (ptrdiff_t p = 0; p < n; p++)
            if (k->about[p] >= about &&
                (pass == 0 || distance2(&old, k->colour + 3 * p) <= FAR * FAR))
                far[bin_of(fabs(k->colour[3 * p + i] - k->g.middle[i]))]++;
        k->g.spread[i] = fmax(1.48 * middle_of(far, all), LEAST);
    }
}

/* ---- candidates ---------------------------------------------------------------------- */

/* Diameter of a disc of the middle thing's area. */
static tz_status measure_size(work *k)
{
    int32_t *area = NULL;
    int64_t bin[128] = {0}, below = 0; /* 4 an octave */
    int32_t b = 0;
    const tz_status s = tz_alloc_zero(k->ctx, &area, (size_t)k->count + 1, sizeof *area);
    if (s != TZ_OK)
        return s;
    for (ptrdiff_t p = 0; p < (ptrdiff_t)k->w * k->h; p++)
        if (k->label[p] >= 0)
            area[k->label[p]]++;
    for (int32_t i = 0; i < k->count; i++)
        bin[area[i] > 0 ? (int32_t)(4 * log2(area[i])) : 0]++;
    while (b < 127 && 2 * (below + bin[b]) < k->count)
        below += bin[b++];
    k->g.size = k->count > 0 ? sqrt(exp2((b + 0.5) / 4) * 4 / TZ_PI) : 0;
    tz_free(k->ctx, area);
    return TZ_OK;
}

/* Marks candidates, and among them those that are narrow. */
static tz_status find_candidates(work *k, const uint8_t *doubtful)
{
    const ptrdiff_t n = (ptrdiff_t)k->w * k->h;
    const int32_t radius = (int32_t)(3 * 0.5 * WIDE * k->g.size);
    int16_t *depth = NULL, *far = NULL;
    int32_t *core = NULL;
    int64_t good = 0;
    tz_status s = tz_things_depth_map(k->ctx, k->label, k->w, k->h, &depth);
    if (s == TZ_OK)
        s = tz_alloc(k->ctx, &core, (size_t)n, sizeof *core);
    for (ptrdiff_t p = 0; p < n && s == TZ_OK; p++)
        core[p] = k->label[p] < 0 && depth[p] > radius ? 0 : -1;
    if (s == TZ_OK)
        s = tz_things_depth_map(k->ctx, core, k->w, k->h, &far);
    for (int32_t rim = RIM; rim >= 2 && (double)good < FEW * (double)n && s == TZ_OK;
         rim -= 3) {
        good = 0;
        for (ptrdiff_t p = 0; p < n; p++) {
            const bool candidate = k->label[p] < 0 && depth[p] > rim && !doubtful[p];
            const bool wide = core[p] == 0 || (k->count > 0 && far[p] <= radius);
            k->about[p] = candidate ? (wide ? 1 : 2) : 0;
            good += candidate;
        }
    }
    tz_free(k->ctx, depth);
    tz_free(k->ctx, far);
    tz_free(k->ctx, core);
    return s;
}

static void choose(work *k)
{
    const ptrdiff_t n = (ptrdiff_t)k->w * k->h;
    int64_t narrow = 0, all = 0, sure = 0, alike = 0, things = 0;
    for (ptrdiff_t p = 0; p < n; p++) {
        narrow += k->about[p] == 2;
        all += k->about[p] > 0;
    }
    const int32_t about = narrow * 5 > all ? 2 : 1;
    for (int32_t pass = 0; pass < PASSES; pass++)
        measure(k, about, pass);
    for (ptrdiff_t p = 0; p < n; p++) {
        const bool like = distance2(&k->g, k->colour + 3 * p) <= FAR * FAR;
        k->g.sure[p] = k->about[p] > 0 && like;
        sure += k->g.sure[p];
        things += k->label[p] >= 0;
        alike += k->label[p] >= 0 && like;
    }
    k->g.share = (double)sure / (double)n;
    k->g.clear = things > 0 ? 1 - (double)alike / (double)things : 1;
}

tz_status tz_things_ground_find(tz_ctx *ctx, const tz_image *photo, const int32_t *label,
                                int32_t count, const uint8_t *doubtful,
                                tz_things_ground *out)
{
    const size_t n = (size_t)photo->width * (size_t)photo->height;
    work k = {.ctx = ctx,
              .photo = photo,
              .label = label,
              .w = photo->width,
              .h = photo->height,
              .count = count,
              .g = {.spread = {LEAST, LEAST, LEAST}}};
    *out = (tz_things_ground){0};
    tz_status s = tz_alloc_zero(ctx, &k.g.sure, n, 1);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &k.about, n, 1);
    if (s == TZ_OK)
        s = blur_colours(&k);
    if (s == TZ_OK)
        s = measure_size(&k);
    if (s == TZ_OK)
        s = find_candidates(&k, doubtful);
    if (s == TZ_OK) {
        choose(&k);
        *out = k.g;
        k.g.sure = NULL;
    }
    tz_free(ctx, k.g.sure);
    tz_free(ctx, k.about);
    tz_free(ctx, k.colour);
    return s;
}

void tz_things_ground_deinit(tz_ctx *ctx, tz_things_ground *g)
{
    tz_free(ctx, g->sure);
    *g = (tz_things_ground){0};
}
