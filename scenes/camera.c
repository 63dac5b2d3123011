/* SPDX-License-Identifier: Apache-2.0 */
/* Camera of a scene, in the order of a real one: optics (box filter, vignette, defocus,
 * shake), exposure, sensor noise, tone and colour, sharpening, 8 bits, JPEG. */
#include "scenes/stage.h"

typedef struct lens {
    double grey; /* mean of the picture that exposure aims at, linear */
    double blur, shake, shake_x, shake_y, vignette;
    double shot, read, noise_blur, noise_colour;
    double contrast, lift, saturation, shoulder;
    float gain[3];
    double sharpen, sharpen_size;
    int quality; /* 0: no JPEG */
    bool halved;
    uint32_t seed;
} lens;

static void draw_colour(tz_rng *r, lens *l)
{
    const double cast = tz_scene_chance(r, 0.15) ? 0.22 : 0.05;
    const double warm = cast * tz_rng_normal(r), green = 0.5 * cast * tz_rng_normal(r);
    l->gain[0] = (float)exp(warm), l->gain[1] = (float)exp(green);
    l->gain[2] = (float)exp(-warm);
    l->saturation = tz_scene_chance(r, 0.2) ? 0 : tz_rng_range(r, 0.35, 1.15);
    l->contrast = tz_scene_chance(r, 0.11) ? tz_scene_spread(r, 0.2, 0.5)
                                           : tz_scene_spread(r, 0.5, 1.35);
    l->lift = 0.06 * tz_rng_normal(r);
    l->shoulder = tz_scene_chance(r, 0.5) ? tz_rng_range(r, 0.1, 0.6) : 0;
    l->grey = 0.2 * exp(0.45 * tz_rng_normal(r));
}

static lens draw_lens(const tz_canvas *c, tz_scene_camera camera)
{
    tz_rng r = tz_rng_make(c->seed, tz_rng_stream(0xCA3, 0, 0));
    lens l = {.grey = 0.25, .contrast = 1, .saturation = 1, .gain = {1, 1, 1}};
    l.seed = tz_rng_u32(&r);
    if (camera == TZ_SCENE_CLEAN)
        return l;
    draw_colour(&r, &l);
    if (tz_scene_chance(&r, 0.5))
        l.blur = tz_scene_spread(&r, 0.25, tz_scene_chance(&r, 0.3) ? 2.2 : 0.8);
    if (tz_scene_chance(&r, 0.08)) {
        const double way = tz_rng_range(&r, 0, TZ_PI);
        l.shake = tz_scene_spread(&r, 1.5, 6);
        l.shake_x = cos(way), l.shake_y = sin(way);
    }
    l.vignette = tz_scene_chance(&r, 0.4) ? tz_rng_range(&r, 0.1, 0.8) : 0;
    if (tz_scene_chance(&r, 0.75)) {
        l.shot = tz_scene_spread(&r, 0.002, 0.06);
        l.read = tz_scene_spread(&r, 0.0005, 0.012);
        l.noise_blur = tz_scene_chance(&r, 0.5) ? tz_rng_range(&r, 0.4, 1.1) : 0;
        l.noise_colour = tz_rng_range(&r, 0.2, 1);
    }
    if (tz_scene_chance(&r, 0.5)) {
        l.sharpen = tz_scene_spread(&r, 0.2, 1.6);
        l.sharpen_size = tz_scene_spread(&r, 0.6, 2.2);
    }
    if (tz_scene_chance(&r, 0.75)) {
        l.quality = 35 + tz_rng_below(&r, 61);
        l.halved = l.quality < 90 && tz_scene_chance(&r, 0.7);
    }
    return l;
}

/* ---- optics ------------------------------------------------------------------------ */

typedef struct film {
    tz_ctx *ctx;
    float *v; /* planes R, G, B, then a spare one */
    int32_t width, height;
    int64_t n;
} film;

static void take(const tz_canvas *c, const lens *l, film *f)
{
    const int64_t plane = (int64_t)c->width * c->height;
    for (int32_t k = 0; k < 3; k++)
        for (int32_t y = 0; y < f->height; y++)
            for (int32_t x = 0; x < f->width; x++) {
                const float *q =
                    c->albedo + k * plane + (int64_t)2 * y * c->width + 2 * x;
                const float sum = q[0] + q[1] + q[c->width] + q[c->width + 1];
                const double u = 2.0 * x / f->width - 1, v = 2.0 * y / f->height - 1;
                const double fall = 1 - l->vignette * (u * u + v * v) / 2;
                f->v[k * f->n + (int64_t)y * f->width + x] = (float)(sum * fall / 4);
            }
}

/* Mean along a short straight way. */
static void shake(film *f, const lens *l, float *plane)
{
    float *from = f->v + 3 * f->n;
    const int32_t steps = (int32_t)ceil(l->shake) + 1;
    for (int64_t p = 0; p < f->n; p++)
        from[p] = plane[p];
    for (int32_t y = 0; y < f->height; y++)
        for (int32_t x = 0; x < f->width; x++) {
            float sum = 0;
            for (int32_t k = 0; k < steps; k++) {
                const double t = l->shake * ((double)k / (steps - 1) - 0.5);
                const double u = tz_scene_clamp(x + t * l->shake_x, 0, f->width - 1);
                const double v = tz_scene_clamp(y + t * l->shake_y, 0, f->height - 1);
                const int32_t i = (int32_t)u, j = (int32_t)v;
                const int64_t p = (int64_t)j * f->width + i;
                const int64_t right = i + 1 < f->width, down = j + 1 < f->height;
                const float a = (float)(u - i), b = (float)(v - j);
                const float *q = from + p, *d = q + down * f->width;
                sum += (1 - b) * (q[0] + a * (q[right] - q[0])) +
                       b * (d[0] + a * (d[right] - d[0]));
            }
            plane[(int64_t)y * f->width + x] = sum / (float)steps;
        }
}

static void expose(film *f, const lens *l)
{
    double mean = 0;
    for (int64_t p = 0; p < f->n; p++)
        mean += 0.25 * f->v[p] + 0.6 * f->v[f->n + p] + 0.15 * f->v[2 * f->n + p];
    const double scale = l->grey / (mean / (double)f->n + 1e-6);
    for (int32_t k = 0; k < 3; k++)
        for (int64_t p = 0; p < f->n; p++)
            f->v[k * f->n + p] *= (float)(scale * l->gain[k]);
}

/* ---- noise ------------------------------------------------------------------------- */

/* About normal, variance 1: four bytes pairs of a hash added up. */
static float normal_at(uint32_t seed, uint32_t i)
{
    uint32_t h[2];
    for (uint32_t k = 0; k < 2; k++) {
        uint32_t z = seed + (2 * i + k) * 0x9E3779B1u;
        z = (z ^ (z >> 16)) * 0x7FEB352Du;
        z = (z ^ (z >> 15)) * 0x846CA68Bu;
        h[k] = z ^ (z >> 16);
    }
    const float sum = (float)(h[0] & 0xFFFF) + (float)(h[0] >> 16) +
                      (float)(h[1] & 0xFFFF) + (float)(h[1] >> 16);
    return (sum / 65535 - 2) * 1.7320508f;
}

/* Noise of light and of colour; what a camera removed of it leaves the coarse part. */
static tz_status add_noise(film *f, const lens *l)
{
    float *noise = f->v + 3 * f->n;
    const double left = l->noise_blur > 0 ? 1 + 1.6 * l->noise_blur : 1;
    for (int32_t k = 0; k < 3; k++) {
        const uint32_t own = l->seed + 0x51ED2701u * (uint32_t)(k + 1);
        const float share = (float)(l->noise_colour / sqrt(1 + l->noise_colour));
        for (int64_t p = 0; p < f->n; p++)
            noise[p] = (1 - 0.5f * share) * normal_at(l->seed, (uint32_t)p) +
                       share * normal_at(own, (uint32_t)p);
        const tz_status s =
            tz_scene_blur(f->ctx, noise, f->width, f->height, l->noise_blur);
        if (s != TZ_OK)
            return s;
        float *v = f->v + k * f->n;
        for (int64_t p = 0; p < f->n; p++) {
            const float light = v[p] > 0 ? v[p] : 0;
            const float sigma =
                sqrtf((float)(l->shot * l->shot) * light + (float)(l->read * l->read));
            v[p] += (float)left * sigma * noise[p];
        }
    }
    return TZ_OK;
}

/* ---- tone -------------------------------------------------------------------------- */

static float encoded(float v) { return v <= 0 ? 0 : tz_srgb_encode(v > 4 ? 4 : v); }

static void tone(film *f, const lens *l)
{
    double sum = 0, squares = 0;
    for (int64_t i = 0; i < 3 * f->n; i++) {
        const float v = f->v[i];
        const float rolled = (float)(v * (1 + l->shoulder * 0.3 * v) /
                                     (1 + l->shoulder * (v > 0 ? v : 0)));
        f->v[i] = encoded(rolled);
        sum += f->v[i];
        squares += (double)f->v[i] * f->v[i];
    }
    const float mean = (float)(sum / (3.0 * (double)f->n));
    const double variance = squares / (3.0 * (double)f->n) - (double)mean * mean;
    const double least = 0.035 / (sqrt(fmax(variance, 0)) + 0.003); /* still visible */
    const float k = (float)(l->contrast > least ? l->contrast : fmin(least, 1.6));
    const float level = mean + (float)l->lift;
    for (int64_t p = 0; p < f->n; p++) {
        float *v[3] = {f->v + p, f->v + f->n + p, f->v + 2 * f->n + p};
        const float grey = 0.3f * *v[0] + 0.59f * *v[1] + 0.11f * *v[2];
        for (int32_t c = 0; c < 3; c++)
            *v[c] = level + k * (grey + (float)l->saturation * (*v[c] - grey) - mean);
    }
}

static tz_status sharpen(film *f, const lens *l)
{
    float *soft = f->v + 3 * f->n;
    for (int32_t k = 0; k < 3; k++) {
        float *v = f->v + k * f->n;
        for (int64_t p = 0; p < f->n; p++)
            soft[p] = v[p];
        const tz_status s =
            tz_scene_blur(f->ctx, soft, f->width, f->height, l->sharpen_size);
        if (s != TZ_OK)
            return s;
        for (int64_t p = 0; p < f->n; p++)
            v[p] += (float)l->sharpen * (v[p] - soft[p]);
    }
    return TZ_OK;
}

static tz_status develop(film *f, const lens *l, tz_image *photo)
{
    uint8_t *rgb = NULL;
    tz_status s = tz_alloc(f->ctx, &rgb, (size_t)f->n, 3);
    if (s != TZ_OK)
        return s;
    for (int64_t p = 0; p < f->n; p++)
        for (int32_t k = 0; k < 3; k++) {
            const float v = f->v[k * f->n + p];
            rgb[3 * p + k] = (uint8_t)(v <= 0 ? 0 : v >= 1 ? 255 : v * 255 + 0.5f);
        }
    if (l->quality > 0)
        s = tz_scene_jpeg(f->ctx, rgb, f->width, f->height, l->quality, l->halved);
    for (int64_t p = 0; s == TZ_OK && p < f->n; p++) {
        float *to = tz_image_at(photo, (int32_t)(p % f->width), (int32_t)(p / f->width));
        for (int32_t k = 0; k < 3; k++)
            to[k] = (float)rgb[3 * p + (l->saturation > 0 ? k : 1)] / 255;
    }
    tz_free(f->ctx, rgb);
    return s;
}

tz_status tz_scene_shoot(tz_canvas *c, tz_scene_camera camera, tz_scene *scene)
{
    const lens l = draw_lens(c, camera);
    film f = {.ctx = c->ctx, .width = c->width / 2, .height = c->height / 2};
    f.n = (int64_t)f.width * f.height;
    tz_status s = tz_image_init(c->ctx, &scene->photo, f.width, f.height, 3);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &f.v, (size_t)(4 * f.n), sizeof *f.v);
    if (s != TZ_OK)
        return s;
    scene->photo.encoding = TZ_ENCODING_SRGB;
    scene->photo.depth = 8;
    take(c, &l, &f);
    for (int32_t k = 0; k < 3 && s == TZ_OK; k++) {
        s = tz_scene_blur(c->ctx, f.v + k * f.n, f.width, f.height, l.blur);
        if (l.shake > 0)
            shake(&f, &l, f.v + k * f.n);
    }
    if (s == TZ_OK) {
        expose(&f, &l);
        s = l.shot > 0 ? add_noise(&f, &l) : TZ_OK;
    }
    if (s == TZ_OK) {
        tone(&f, &l);
        s = l.sharpen > 0 ? sharpen(&f, &l) : TZ_OK;
    }
    if (s == TZ_OK)
        s = develop(&f, &l, &scene->photo);
    tz_free(c->ctx, f.v);
    return s;
}
