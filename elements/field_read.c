/* SPDX-License-Identifier: Apache-2.0 */
/* Fields out of drawings and images. */
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "elements/field.h"
#include "elements/guide.h"

enum { MOST_NUMBERS = 256 };

/* What a stroke's words say. */
typedef struct words {
    double size[MOST_NUMBERS], density[MOST_NUMBERS], weight;
    int32_t sizes, densities;
    bool directed;
} words;

static tz_status unknown(tz_ctx *ctx, const char *path, int32_t line, const char *word,
                         size_t n)
{
    return tz_fail(ctx, TZ_INVALID,
                   "%s:%d: a stroke says \"%.*s\"; it may say size=2, density=0.5, "
                   "weight=3 (or several numbers with commas) and direction=no",
                   path, line, (int)(n < 40 ? n : 40), word);
}

/* Numbers with commas between; 0 where they are none. */
static int32_t numbers(const char *text, size_t n, double *out)
{
    int32_t count = 0;
    const char *end = text + n;
    while (text < end && count < MOST_NUMBERS) {
        char word[64];
        const char *stop = memchr(text, ',', (size_t)(end - text));
        const size_t length = (size_t)((stop ? stop : end) - text);
        if (length == 0 || length >= sizeof word)
            return 0;
        memcpy(word, text, length), word[length] = 0;
        const char *rest = word;
        if (!tz_number_parse(word, &rest, &out[count]) || *rest || !isfinite(out[count]))
            return 0;
        count++;
        text += length + 1;
    }
    return text >= end ? count : 0;
}

static tz_status read_word(tz_ctx *ctx, const char *path, int32_t line, const char *w,
                           size_t n, words *out)
{
    double one[MOST_NUMBERS];
    int32_t k = 0;
    bool good = false;
    if (n > 5 && strncmp(w, "size=", 5) == 0) {
        k = out->sizes = numbers(w + 5, n - 5, out->size);
        good = k > 0;
        for (int32_t i = 0; i < k; i++)
            good = good && out->size[i] > 0;
    } else if (n > 8 && strncmp(w, "density=", 8) == 0) {
        k = out->densities = numbers(w + 8, n - 8, out->density);
        good = k > 0;
        for (int32_t i = 0; i < k; i++)
            out->density[i] = fmin(fmax(out->density[i], 0), 1);
    } else if (n > 7 && strncmp(w, "weight=", 7) == 0) {
        good = numbers(w + 7, n - 7, one) == 1 && one[0] > 0;
        out->weight = good ? one[0] : 1;
    } else if (n > 10 && strncmp(w, "direction=", 10) == 0) {
        out->directed = strncmp(w + 10, "no", 2) != 0;
        good = n == 12 && !out->directed;
    } else {
        good = !memchr(w, '=', n); /* a plain class name */
    }
    return good ? TZ_OK : unknown(ctx, path, line, w, n);
}

static tz_status read_words(tz_ctx *ctx, const char *path, const tz_part *part,
                            words *out)
{
    tz_status s = TZ_OK;
    out->sizes = out->densities = 0;
    out->weight = 1;
    out->directed = true;
    for (const char *p = part->name ? part->name : ""; *p && s == TZ_OK;) {
        p += strspn(p, " \t\n");
        const size_t n = strcspn(p, " \t\n");
        if (n > 0)
            s = read_word(ctx, path, part->line, p, n, out);
        p += n;
    }
    return s;
}

/* The value at a share of the way along a stroke. */
static double along(const double *v, int32_t n, double t, double missing)
{
    if (n == 0)
        return missing;
    const double x = t * (n - 1);
    const int32_t i = (int32_t)fmin(floor(x), n - 1), j = i + 1 < n ? i + 1 : i;
    return v[i] + (x - i) * (v[j] - v[i]);
}

static double length_of(const tz_vec2 *v, int32_t n)
{
    double l = 0;
    for (int32_t i = 1; i < n; i++)
        l += hypot(v[i].x - v[i - 1].x, v[i].y - v[i - 1].y);
    return l;
}

/* A long straight piece gets points where the numbers have theirs. */
static tz_status add_line(tz_element_field *f, tz_element_field_stroke stroke,
                          const tz_vec2 *v, int32_t n, const words *w)
{
    TZ_ARRAY(tz_element_field_point)
    points = {0};
    const double all = length_of(v, n);
    const int32_t most = w->sizes > w->densities ? w->sizes : w->densities;
    double way = 0;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        const tz_vec2 to = v[i + 1 < n ? i + 1 : i], d = tz_vec2_sub(to, v[i]);
        const double l = tz_vec2_length(d);
        const int32_t parts =
            all > 0 && most > 1 ? (int32_t)ceil(l / all * (most - 1)) : 1;
        for (int32_t k = 0; k < (parts > 1 ? parts : 1) && s == TZ_OK; k++) {
            const double share = parts > 1 ? (double)k / parts : 0;
            const double t = all > 0 ? (way + share * l) / all : 0;
            const tz_element_field_point p = {tz_vec2_add(v[i], tz_vec2_scale(d, share)),
                                              along(w->size, w->sizes, t, 0),
                                              along(w->density, w->densities, t, -1)};
            s = tz_array_push(f->ctx, &points, p);
        }
        way += l;
    }
    if (s == TZ_OK)
        s = tz_element_field_add(f, stroke, points.n, points.v);
    tz_array_free(f->ctx, &points);
    return s;
}

static tz_status add_part(tz_element_field *f, const char *path,
                          const tz_element_reader *r, const tz_part *part, words *w)
{
    tz_polys lines = {0};
    const double cell = f->raster.size.x / f->raster.width;
    const double width = part->look.stroke & 0xff ? part->look.width : 0;
    tz_status s = read_words(f->ctx, path, part, w);
    if (s == TZ_OK)
        s = tz_polys_add_path(f->ctx, &lines, r->verb.v + part->verb, part->verbs,
                              r->point.v + part->point, tz_affine_identity(), 0.1 * cell);
    for (int32_t k = 0; k < lines.part.n && s == TZ_OK; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(&lines, k, &n);
        const tz_element_field_stroke stroke = {.radius = width / 2,
                                                .weight = w->weight,
                                                .directed = w->directed,
                                                .closed = lines.closed.v[k]};
        if (n > 1 && length_of(v, n) > 0)
            s = add_line(f, stroke, v, n, w);
    }
    tz_polys_deinit(f->ctx, &lines);
    return s;
}

tz_status tz_element_field_read_strokes(tz_element_field *f, const char *path)
{
    tz_element_reader r;
    words *w = NULL;
    const int32_t before = f->stroke.n;
    tz_status s = tz_guide_read_svg(f->ctx, path, f->raster.size, &r);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &w, 1, sizeof *w);
    for (int32_t i = 0; i < r.part.n && s == TZ_OK; i++)
        s = add_part(f, path, &r, &r.part.v[i], w);
    if (s == TZ_OK && f->stroke.n == before)
        s = tz_fail(
            f->ctx, TZ_INVALID,
            "%s: there are no strokes in view; draw some that directions follow%s", path,
            tz_guide_hint(&r));
    tz_free(f->ctx, w);
    tz_element_reader_deinit(&r);
    return s;
}

/* ---- images ------------------------------------------------------------------------- */

static tz_vec2 direction_of(const tz_image *im, const float *p)
{
    const double blind = 0.02; /* nearer to 0 than 8 bits can say */
    if (im->channels - (im->alpha >= 0) < 2) {
        const double a = 2 * TZ_PI * (double)p[0];
        return (tz_vec2){cos(a), sin(a)};
    }
    const tz_vec2 v = {(double)p[0] - 0.5, (double)p[1] - 0.5};
    return tz_vec2_length(v) < blind ? (tz_vec2){0, 0} : v;
}

static void say_pixel(tz_element_field_cell *c, tz_element_field_map map,
                      const tz_image *im, const float *p)
{
    if (im->alpha >= 0 && p[im->alpha] < 0.5f)
        return;
    const tz_vec2 v = direction_of(im, p);
    const double l = tz_vec2_length(v);
    const float value = fminf(fmaxf(p[0], 0), 1);
    if (map == TZ_ELEMENT_FIELD_DIRECTION && l > 0)
        c->x = (float)(v.x / l), c->y = (float)(v.y / l), c->weight[0] = 1;
    if (map == TZ_ELEMENT_FIELD_SIZE && value > 0)
        c->size = 2 * value, c->weight[1] = 1;
    if (map == TZ_ELEMENT_FIELD_DENSITY)
        c->density = value, c->weight[2] = 1;
}

tz_status tz_element_field_read_image(tz_element_field *f, const char *path,
                                      tz_element_field_map map)
{
    const tz_raster *r = &f->raster;
    const size_t n = (size_t)r->width * (size_t)r->height;
    tz_image im = {0};
    tz_status s = tz_guide_read_image(f->ctx, path, 4096, true, &im);
    if (s == TZ_OK && !f->image) {
        s = tz_alloc(f->ctx, &f->image, n, sizeof *f->image);
        for (size_t i = 0; i < n && s == TZ_OK; i++)
            f->image[i] = (tz_element_field_cell){.density = -1};
    }
    for (int32_t j = 0; j < r->height && s == TZ_OK; j++)
        for (int32_t i = 0; i < r->width; i++) {
            const int32_t x = (int32_t)((i + 0.5) * im.width / r->width);
            const int32_t y = (int32_t)((j + 0.5) * im.height / r->height);
            say_pixel(&f->image[(int64_t)j * r->width + i], map, &im,
                      tz_image_at(&im, x, y));
        }
    tz_image_deinit(&im);
    return s;
}

tz_status tz_element_field_read(tz_ctx *ctx, const char *path, tz_vec3 size, bool torus,
                                tz_element_field *f)
{
    tz_status s = tz_element_field_init(ctx, size, torus, 0, f);
    if (s == TZ_OK)
        s = tz_guide_is_svg(path)
                ? tz_element_field_read_strokes(f, path)
                : tz_element_field_read_image(f, path, TZ_ELEMENT_FIELD_DIRECTION);
    if (s == TZ_OK)
        s = tz_element_field_settle(f);
    if (s != TZ_OK)
        tz_element_field_deinit(f);
    return s;
}
