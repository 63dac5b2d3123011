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

/* Where a word stands, for messages. */
typedef struct place {
    tz_ctx *ctx;
    const char *file;
    const tz_part *part;
} place;

/* A word that cannot be. */
static tz_status refuse(const place *at, const char *word, size_t n, const char *why)
{
    const char *id = at->part->id && *at->part->id ? at->part->id : NULL;
    return tz_fail(at->ctx, TZ_INVALID, "%s:%d: %s%.60s%s says \"%.*s\"; %s", at->file,
                   at->part->line, id ? "path \"" : "a stroke", id ? id : "",
                   id ? "\"" : "", (int)(n < 40 ? n : 40), word, why);
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
        if (stop && text == end)
            return 0; /* a comma at the end */
    }
    return text >= end ? count : 0;
}

static bool all_within(const double *v, int32_t n, double least, double most)
{
    for (int32_t i = 0; i < n; i++)
        if (!(v[i] >= least && v[i] <= most))
            return false;
    return n > 0;
}

/* A word of four: its value's length is n. @return NULL, or what it should be */
static const char *read_value(int key, const char *v, size_t n, words *out)
{
    double one[MOST_NUMBERS];
    switch (key) {
    case 0:
        out->sizes = numbers(v, n, out->size);
        return all_within(out->size, out->sizes, TZ_ELEMENT_FIELD_LEAST_SIZE,
                          TZ_ELEMENT_FIELD_MOST_SIZE)
                   ? NULL
                   : "sizes are numbers from 0.001 to 1000, with commas between";
    case 1:
        out->densities = numbers(v, n, out->density);
        return all_within(out->density, out->densities, 0, 1)
                   ? NULL
                   : "densities are numbers from 0 (sparsest) to 1, with commas between";
    case 2:
        if (numbers(v, n, one) != 1 ||
            !(one[0] > 0 && one[0] <= TZ_ELEMENT_FIELD_MOST_WEIGHT))
            return "a weight is one number above 0, up to a million";
        out->weight = one[0];
        return NULL;
    default:
        out->directed = n == 3 && strncmp(v, "yes", 3) == 0;
        return out->directed || (n == 2 && strncmp(v, "no", 2) == 0)
                   ? NULL
                   : "it may be direction=yes or direction=no";
    }
}

/* @param strict  words that are none of ours are refused */
static tz_status read_word(const place *at, const char *w, size_t n, bool strict,
                           words *out)
{
    static const char *const key[] = {"size=", "density=", "weight=", "direction="};
    for (int k = 0; k < 4; k++) {
        const size_t l = strlen(key[k]);
        if (n < l || strncmp(w, key[k], l) != 0)
            continue;
        const char *why = read_value(k, w + l, n - l, out);
        return why ? refuse(at, w, n, why) : TZ_OK;
    }
    return strict && memchr(w, '=', n) /* else a plain class name */
               ? refuse(at, w, n,
                        "it may say size=2, density=0.5, weight=3 (or several numbers "
                        "with commas) and direction=no")
               : TZ_OK;
}

static tz_status read_text(const place *at, const char *p, bool strict, words *out)
{
    static const char blank[] = " \t\r\n";
    tz_status s = TZ_OK;
    while (p && *p && s == TZ_OK) {
        p += strspn(p, blank);
        const size_t n = strcspn(p, blank);
        if (n > 0)
            s = read_word(at, p, n, strict, out);
        p += n;
    }
    return s;
}

/* Its group's, its label's and its own; later ones overrule. */
static tz_status read_words(const place *at, words *out)
{
    out->sizes = out->densities = 0;
    out->weight = 1;
    out->directed = true;
    tz_status s = read_text(at, at->part->group, true, out);
    if (s == TZ_OK)
        s = read_text(at, at->part->label, false, out);
    return s == TZ_OK ? read_text(at, at->part->name, true, out) : s;
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

/* What is only filled and covers all of the view is its ground. */
static bool is_ground(const tz_element_field *f, const tz_part *p)
{
    const double e = 1e-3 * fmin(f->raster.size.x, f->raster.size.y);
    return !(p->look.stroke & 0xff) && p->box.x0 < e && p->box.y0 < e &&
           p->box.x1 > f->raster.size.x - e && p->box.y1 > f->raster.size.y - e;
}

/* Whether a box that far about a line meets the domain, or on a torus one of the copies
 * that cells are drawn of. */
static bool in_view(const tz_element_field *f, const tz_vec2 *v, int32_t n, double radius)
{
    const tz_vec3 size = f->raster.size;
    const double far = f->raster.torus ? 1 : 0;
    tz_box b = tz_box_empty();
    for (int32_t i = 0; i < n; i++)
        tz_box_add(&b, v[i]);
    return b.x0 - radius <= size.x * (1 + far) && b.y0 - radius <= size.y * (1 + far) &&
           b.x1 + radius >= -size.x * far && b.y1 + radius >= -size.y * far;
}

static tz_status add_part(tz_element_field *f, const char *path,
                          const tz_element_reader *r, const tz_part *part, words *w)
{
    tz_polys lines = {0};
    const double cell = f->raster.size.x / f->raster.width;
    const double radius = part->look.stroke & 0xff ? part->look.width / 2 : 0;
    const place at = {f->ctx, path, part};
    if (is_ground(f, part))
        return TZ_OK;
    tz_status s = read_words(&at, w);
    if (s == TZ_OK)
        s = tz_polys_add_path(f->ctx, &lines, r->verb.v + part->verb, part->verbs,
                              r->point.v + part->point, tz_affine_identity(), 0.1 * cell);
    for (int32_t k = 0; k < lines.part.n && s == TZ_OK; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(&lines, k, &n);
        const tz_element_field_stroke stroke = {.radius = radius,
                                                .weight = w->weight,
                                                .directed = w->directed,
                                                .closed = lines.closed.v[k]};
        if (n > 1 && length_of(v, n) > 0 && in_view(f, v, n, radius))
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
    for (int32_t i = 0; i < r.part.n && s == TZ_OK; i++) {
        s = add_part(f, path, &r, &r.part.v[i], w);
        if (s == TZ_OK && !(i & 4095) && tz_ctx_cancelled(f->ctx))
            s = TZ_CANCELLED;
    }
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

/* What pixels say, and how much of it has been summed. */
typedef struct sum {
    double x, y, size, density;
    double weight[TZ_ELEMENT_FIELD_SAYINGS], all;
} sum;

/* Files of floating point numbers (EXR) hold vectors as they are; in others 0.5 is 0. */
static tz_vec2 direction_of(const tz_image *im, const float *p)
{
    const bool is_float = im->depth > 16;
    const double zero = is_float ? 0 : 0.5;
    const double blind = is_float ? 0 : 0.02; /* nearer to 0 than 8 bits can say */
    if (im->channels - (im->alpha >= 0) < 2) {
        const double a = 2 * TZ_PI * (double)p[0];
        return (tz_vec2){cos(a), sin(a)};
    }
    const tz_vec2 v = {(double)p[0] - zero, (double)p[1] - zero};
    return tz_vec2_length(v) >= blind && isfinite(v.x) && isfinite(v.y) ? v
                                                                        : (tz_vec2){0, 0};
}

static void hear(sum *s, tz_element_field_map map, const tz_image *im, const float *p,
                 double w)
{
    s->all += w;
    if (im->alpha >= 0 && p[im->alpha] < 0.5f)
        return;
    const double value = fmin(fmax((double)p[0], 0), 1);
    if (map == TZ_ELEMENT_FIELD_DIRECTION) {
        const tz_vec2 v = direction_of(im, p);
        if (v.x != 0 || v.y != 0)
            s->x += w * v.x, s->y += w * v.y, s->weight[0] += w;
    } else if (map == TZ_ELEMENT_FIELD_SIZE) {
        if (value > 0)
            s->size += w * value, s->weight[1] += w;
    } else {
        s->density += w * value, s->weight[2] += w;
    }
}

/* What most of the pixels about a cell say, on average; angles are no numbers, so that
 * means are of vectors. @return whether they say anything */
static bool tell(tz_element_field_cell *c, const sum *s)
{
    const double l = hypot(s->x, s->y), half = 0.5 * s->all;
    bool any = false;
    if (s->weight[0] > half && l > 1e-6 * s->weight[0]) {
        c->x = (float)(s->x / l), c->y = (float)(s->y / l);
        c->weight[0] = 1, any = true;
    }
    if (s->weight[1] > half) {
        c->size = (float)fmax(2 * s->size / s->weight[1], TZ_ELEMENT_FIELD_LEAST_SIZE);
        c->weight[1] = 1, any = true;
    }
    if (s->weight[2] > half) {
        c->density = (float)fmin(s->density / s->weight[2], 1);
        c->weight[2] = 1, any = true;
    }
    return any;
}

/* Pixels about the middle of cell i of n, of w pixels along: all under the cell, or the
 * nearest two where it is smaller than they. */
typedef struct span {
    int32_t from, to;
    double at, reach;
} span;

static span span_of(int32_t i, int32_t n, int32_t w)
{
    span s = {.at = (i + 0.5) * w / n - 0.5, .reach = fmax(1, (double)w / n)};
    s.from = (int32_t)fmax(ceil(s.at - s.reach + 1e-9), 0);
    s.to = (int32_t)fmin(floor(s.at + s.reach - 1e-9), w - 1);
    return s;
}

static double share_of(const span *s, int32_t i)
{
    return 1 - fabs(i - s->at) / s->reach;
}

static sum hear_cell(const tz_image *im, tz_element_field_map map, const span *across,
                     const span *down)
{
    sum s = {0};
    for (int32_t y = down->from; y <= down->to; y++)
        for (int32_t x = across->from; x <= across->to; x++)
            hear(&s, map, im, tz_image_at(im, x, y),
                 share_of(across, x) * share_of(down, y));
    return s;
}

tz_status tz_element_field_read_image(tz_element_field *f, const char *path,
                                      tz_element_field_map map)
{
    static const char *const hint[] = {
        "it says no direction; red and green are to be x and y, 0.5 is 0",
        "it says no size; mid grey is size 1, black is none",
        "it says no density; let some of it be opaque"};
    const tz_raster *r = &f->raster;
    const size_t n = (size_t)r->width * (size_t)r->height;
    tz_image im = {0};
    bool any = false;
    tz_status s = tz_guide_read_image(f->ctx, path, 4096, true, &im);
    if (s == TZ_OK && !f->image) {
        s = tz_alloc(f->ctx, &f->image, n, sizeof *f->image);
        for (size_t i = 0; i < n && s == TZ_OK; i++)
            f->image[i] = (tz_element_field_cell){.density = -1};
    }
    for (int32_t j = 0; j < r->height && s == TZ_OK; j++)
        for (int32_t i = 0; i < r->width; i++) {
            const span across = span_of(i, r->width, im.width),
                       down = span_of(j, r->height, im.height);
            const sum all = hear_cell(&im, map, &across, &down);
            any |= tell(&f->image[(int64_t)j * r->width + i], &all);
        }
    if (s == TZ_OK && !any)
        s = tz_fail(f->ctx, TZ_INVALID, "%s: %s", path, hint[map]);
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
