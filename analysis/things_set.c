/* SPDX-License-Identifier: Apache-2.0 */
/* Elements of things: symbol and outline, samples, kind.
 *
 * Kinds: natural things of one kind vary, so that clusters are believed only where they
 * stand apart. Of k = 2 .. MOST clusterings the one is taken in which the mean of
 * 1 - a / b is largest, a and b being a thing's distances from its own and from the next
 * cluster's centre (the simplified silhouette); one kind where that is below APART or the
 * centres are closer than what counts as another look. Where that finds one kind, things
 * are parted by colour, along the axis on which it varies most, and by size, each where the
 * values lie in two heaps: the best threshold takes away more than HEAPS of their variance
 * (a normal distribution loses 0.64 of it, an even one 0.75) and their means are apart. */
#include "analysis/things_set.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "elements/element_cluster.h"

enum { MOST = 5, MOST_SAMPLES = 9, FEWEST = 12 };

#define ERROR    0.2 /* px: of the simplified outline */
#define APART    0.80
#define HEAPS    0.83
#define DISTANCE 0.8 /* of the heaps: looks, octaves of area */
#define LEAST    0.2 /* share of the things in the smaller heap */

typedef tz_element_look look;

/* ---- looks --------------------------------------------------------------------------- */

typedef struct colours {
    double rgb[3]; /* sums of linear light */
    int64_t n;
} colours;

static void sum_colours(const tz_image *photo, const int32_t *label, colours *c)
{
    const bool srgb = photo->encoding == TZ_ENCODING_SRGB;
    const int32_t w = photo->width, h = photo->height;
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            const int32_t l = label[(ptrdiff_t)y * w + x];
            const float *p = tz_image_at(photo, x, y);
            if (l < 0)
                continue;
            for (int k = 0; k < 3; k++) {
                float v = p[photo->channels >= 3 ? k : 0];
                v = v > 0 ? (v < 1 ? v : 1) : 0;
                c[l].rgb[k] += srgb ? tz_srgb_decode(v) : v;
            }
            c[l].n++;
        }
}

static double between(const double *a, const double *b)
{
    double d = 0;
    for (int k = 0; k < TZ_ELEMENT_LOOKS; k++)
        d += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(d);
}

/* How far the clusters stand apart: mean of 1 - a / b; 0 where two of them look alike, or
 * one is hardly there. */
static double silhouette(const look *v, int32_t n, int32_t k)
{
    double centre[MOST][TZ_ELEMENT_LOOKS] = {{0}}, sum = 0;
    int32_t count[MOST] = {0};
    for (int32_t i = 0; i < n; i++) {
        count[v[i].kind]++;
        for (int j = 0; j < TZ_ELEMENT_LOOKS; j++)
            centre[v[i].kind][j] += v[i].v[j];
    }
    for (int32_t c = 0; c < k; c++) {
        if (count[c] * 40 < n || count[c] < 2)
            return 0;
        for (int j = 0; j < TZ_ELEMENT_LOOKS; j++)
            centre[c][j] /= count[c];
    }
    for (int32_t a = 0; a < k; a++)
        for (int32_t b = 0; b < a; b++)
            if (between(centre[a], centre[b]) < 1)
                return 0;
    for (int32_t i = 0; i < n; i++) {
        double own = between(v[i].v, centre[v[i].kind]), next = INFINITY;
        for (int32_t c = 0; c < k; c++)
            if (c != v[i].kind)
                next = fmin(next, between(v[i].v, centre[c]));
        sum += 1 - fmin(own / fmax(next, 1e-9), 1);
    }
    return sum / n;
}

static int by_value(const void *p, const void *q)
{
    const double a = *(const double *)p, b = *(const double *)q;
    return (a > b) - (a < b);
}

/* The threshold between two heaps of values; false where there are none.
 * @param v      is sorted
 * @param apart  least distance of the means
 * @source Otsu 1979 */
static bool find_heaps(double *v, int32_t n, double apart, double *threshold)
{
    double sum = 0, square = 0, below = 0, best = 0;
    qsort(v, (size_t)n, sizeof *v, by_value);
    for (int32_t i = 0; i < n; i++)
        sum += v[i], square += v[i] * v[i];
    const double all = square - sum * sum / n;
    for (int32_t i = 1; i < n; i++) {
        below += v[i - 1];
        const double d = (sum - below) / (n - i) - below / i;
        const double between = d * d * i * (n - i) / n;
        if (i < LEAST * n || n - i < LEAST * n || d < apart || between <= best)
            continue;
        best = between;
        *threshold = 0.5 * (v[i - 1] + v[i]);
    }
    return best > HEAPS * all;
}

/* Unit vector along which the colours vary most; power iteration. */
static void colour_axis(const look *v, int32_t n, double axis[3])
{
    double mean[3] = {0}, m[3][3] = {{0}};
    for (int32_t i = 0; i < n; i++)
        for (int a = 0; a < 3; a++)
            mean[a] += v[i].v[a] / n;
    for (int32_t i = 0; i < n; i++)
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                m[a][b] += (v[i].v[a] - mean[a]) * (v[i].v[b] - mean[b]);
    axis[0] = 1, axis[1] = 0.9, axis[2] = 0.8;
    for (int k = 0; k < 40; k++) {
        double w[3] = {0}, length = 0;
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                w[a] += m[a][b] * axis[b];
        for (int a = 0; a < 3; a++)
            length += w[a] * w[a];
        for (int a = 0; a < 3 && length > 0; a++)
            axis[a] = w[a] / sqrt(length);
    }
}

/* Up to four kinds: two colours times two sizes. Heaps are looked for among the things
 * that may be copied. */
static tz_status part_by_heaps(tz_ctx *ctx, look *v, const tz_things_found *found,
                               int32_t n)
{
    double axis[3], *value = NULL, threshold = 0;
    const tz_status s = tz_alloc(ctx, &value, (size_t)n + 1, sizeof *value);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n; i++)
        v[i].kind = 0;
    colour_axis(v, n, axis);
    for (int what = 0; what < 2; what++) {
        int32_t used = 0;
        for (int pass = 0; pass < 2; pass++) {
            for (int32_t i = 0; i < n; i++) {
                const double *c = v[i].v;
                const double q = what ? log2(fmax(found[i].area, 1))
                                      : c[0] * axis[0] + c[1] * axis[1] + c[2] * axis[2];
                if (pass)
                    v[i].kind += q > threshold ? 1 + what : 0;
                else if (!found[i].cut)
                    value[used++] = q;
            }
            if (pass == 0 &&
                (used < FEWEST || !find_heaps(value, used, DISTANCE, &threshold)))
                break;
        }
    }
    tz_free(ctx, value);
    return TZ_OK;
}

static tz_status find_kinds(tz_ctx *ctx, look *v, const tz_things_found *found, int32_t n,
                            int32_t wanted)
{
    double best = APART;
    int32_t k = wanted > 0 ? wanted : 1;
    tz_status s = TZ_OK;
    for (int32_t i = 2; i <= MOST && wanted <= 0 && i < n && s == TZ_OK; i++) {
        s = tz_element_cluster(ctx, v, n, i);
        const double apart = s == TZ_OK ? silhouette(v, n, i) : 0;
        if (apart > best)
            best = apart, k = i;
    }
    if (s == TZ_OK && k == 1 && wanted <= 0)
        return part_by_heaps(ctx, v, found, n);
    return s == TZ_OK ? tz_element_cluster(ctx, v, n, k) : s;
}

/* Clusters become kinds in the order of their first elements; a kind has an axis that
 * matters where most of its elements are far from round. */
static tz_status name_kinds(tz_element_set *s, const look *v)
{
    int32_t kind_of[TZ_ELEMENT_CLASSES], votes[TZ_ELEMENT_CLASSES] = {0};
    tz_status st = TZ_OK;
    memset(kind_of, 255, sizeof kind_of);
    for (int32_t i = 0; i < s->element.n && st == TZ_OK; i++) {
        int32_t *k = &kind_of[v[i].kind];
        if (*k < 0) {
            char name[32];
            tz_element_kind kind = {0};
            snprintf(name, sizeof name, "class-%d", s->kind.n + 1);
            *k = s->kind.n;
            st = tz_strdup(s->ctx, name, &kind.name);
            if (st == TZ_OK && (st = tz_array_push(s->ctx, &s->kind, kind)) != TZ_OK)
                tz_free(s->ctx, kind.name);
        }
        s->element.v[i].kind = *k;
        votes[*k] += v[i].fullness < 0.6 ? 1 : -1;
    }
    for (int32_t k = 0; k < s->kind.n; k++)
        s->kind.v[k].oriented = votes[k] > 0;
    return st;
}

/* ---- elements ------------------------------------------------------------------------ */

static tz_status add_symbol(tz_element_set *s, const tz_things_found *f)
{
    char id[32];
    tz_things_outline o = {0};
    tz_element_symbol y = {.radius = f->radius, .photo_scale = 1, .photo_at = f->at};
    snprintf(id, sizeof id, "thing-%d", s->symbol.n + 1);
    tz_status st = tz_strdup(s->ctx, id, &y.id);
    if (st == TZ_OK)
        st = tz_strdup(s->ctx, "", &y.markup);
    if (st == TZ_OK)
        st = tz_things_simplify(s->ctx, &f->outline, ERROR, &o);
    for (int32_t i = 0; i < o.point.n && st == TZ_OK; i++)
        st = tz_array_push(s->ctx, &y.outline, tz_vec2_sub(o.point.v[i], f->at));
    for (int32_t i = 0; i < o.part.n && st == TZ_OK; i++)
        st = tz_array_push(s->ctx, &y.part, o.part.v[i]);
    if (st == TZ_OK)
        st = tz_array_push(s->ctx, &s->symbol, y);
    tz_things_outline_deinit(s->ctx, &o);
    if (st != TZ_OK) {
        tz_free(s->ctx, y.id);
        tz_free(s->ctx, y.markup);
        tz_array_free(s->ctx, &y.outline);
        tz_array_free(s->ctx, &y.part);
    }
    return st;
}

static tz_polys polys_of(const tz_element_symbol *y)
{
    return (tz_polys){{y->outline.v, y->outline.n, 0}, {y->part.v, y->part.n, 0}, {0}};
}

static tz_status add_samples(tz_element_set *s, tz_element *e)
{
    const tz_polys polys = polys_of(&s->symbol.v[e->symbol]);
    tz_vec2 at[MOST_SAMPLES];
    tz_status st = tz_polys_axis(s->ctx, &polys, MOST_SAMPLES, at, &e->samples);
    e->sample = s->sample.n;
    if (e->samples == 1)
        at[0] = (tz_vec2){0, 0};
    for (int32_t k = 0; k < e->samples && st == TZ_OK; k++)
        st = tz_array_push(s->ctx, &s->sample,
                           ((tz_sample){{e->at.x + at[k].x, e->at.y + at[k].y, 0},
                                        k,
                                        1.0 / e->samples}));
    return st;
}

static tz_status add_thing(tz_element_set *s, const tz_things_found *f)
{
    tz_element e = {.symbol = s->symbol.n,
                    .source = -1,
                    .at = {f->at.x, f->at.y, 0},
                    .scale = 1,
                    .radius = f->radius,
                    .depth = f->depth,
                    .cut = f->frame,
                    .doubtful = f->cut && !f->frame};
    tz_status st = add_symbol(s, f);
    if (st == TZ_OK)
        st = add_samples(s, &e);
    return st == TZ_OK ? tz_array_push(s->ctx, &s->element, e) : st;
}

static tz_status add_photo(tz_element_set *s, const tz_image *photo)
{
    tz_element_photo p = {.width = photo->width, .height = photo->height};
    tz_status st = tz_strdup(s->ctx, "", &p.path);
    if (st == TZ_OK && (st = tz_array_push(s->ctx, &s->photo, p)) != TZ_OK)
        tz_free(s->ctx, p.path);
    return st;
}

tz_status tz_things_make_set(tz_ctx *ctx, const tz_image *photo, const int32_t *label,
                             const tz_things_found *found, int32_t count, int32_t classes,
                             tz_element_set *s)
{
    colours *c = NULL;
    look *v = NULL;
    *s = (tz_element_set){.ctx = ctx,
                          .domain = {.size = {photo->width, photo->height, 0}}};
    tz_status st = tz_alloc_zero(ctx, &c, (size_t)count + 1, sizeof *c);
    if (st == TZ_OK)
        st = tz_alloc_zero(ctx, &v, (size_t)count + 1, sizeof *v);
    if (st == TZ_OK)
        st = add_photo(s, photo);
    if (st == TZ_OK)
        sum_colours(photo, label, c);
    for (int32_t i = 0; i < count && st == TZ_OK; i++) {
        double rgb[3], lab[3];
        st = add_thing(s, &found[i]);
        if (st != TZ_OK)
            break;
        for (int k = 0; k < 3; k++)
            rgb[k] = c[i].rgb[k] / (double)(c[i].n > 0 ? c[i].n : 1);
        tz_element_lab(rgb, lab);
        const tz_polys polys = polys_of(&s->symbol.v[i]);
        tz_element_look_at(lab, &polys, found[i].radius, found[i].radius, &v[i]);
        v[i].count = 1;
    }
    if (st == TZ_OK)
        st = find_kinds(ctx, v, found, count, classes);
    if (st == TZ_OK)
        st = name_kinds(s, v);
    tz_free(ctx, c);
    tz_free(ctx, v);
    if (st != TZ_OK)
        tz_element_set_deinit(s);
    return st;
}
