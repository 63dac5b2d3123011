/* SPDX-License-Identifier: Apache-2.0 */
/* Zones. Drawings are painted cell by cell in drawing order, colours by name. Pictures
 * have soft borders and noise: a pixel within TOLERANCE of a named colour is of its zone;
 * one that is like few of its neighbours stands on a border, and takes the zone of the
 * nearest pixel that does not. */
#include "elements/zones.h"

#include <string.h>

#include "elements/element_color.h"
#include "elements/guide.h"

enum { MOST_ZONES = 255, TOLERANCE = 24 /* of 255, a channel */ };

void tz_zones_free(tz_zones *z)
{
    if (!z)
        return;
    tz_ctx *ctx = z->ctx;
    tz_free(ctx, z->zone);
    tz_free(ctx, z->allow);
    tz_free(ctx, z);
}

/* ---- the table ------------------------------------------------------------------- */

typedef struct table {
    int32_t n;
    uint32_t colour[MOST_ZONES + 1]; /* 0xrrggbbaa; zone 0 has none */
    uint64_t allow[MOST_ZONES + 1];
} table;

typedef struct word {
    const char *v;
    size_t n;
} word;

/* Up to one of `ends`, without blanks around. */
static word next_word(const char **at, const char *ends)
{
    word w = {*at, strcspn(*at, ends)};
    *at += w.n;
    while (w.n > 0 && strchr(" \t\r\n", *w.v))
        w.v++, w.n--;
    while (w.n > 0 && strchr(" \t\r\n", w.v[w.n - 1]))
        w.n--;
    return w;
}

static int32_t find_kind(const char *const *kinds, int32_t n, word w)
{
    for (int32_t k = 0; k < n; k++)
        if (strlen(kinds[k]) == w.n && memcmp(kinds[k], w.v, w.n) == 0)
            return k;
    return -1;
}

static tz_status read_kinds(tz_ctx *ctx, const char **at, const char *const *kinds,
                            int32_t n, uint64_t *allow)
{
    for (;;) {
        const word w = next_word(at, ",;");
        const int32_t k = w.n > 0 ? find_kind(kinds, n, w) : -1;
        if (w.n > 0 && k < 0)
            return tz_fail(ctx, TZ_INVALID,
                           "zones: there is no class \"%.*s\"; the exemplar's first is "
                           "\"%.60s\"",
                           (int)(w.n < 60 ? w.n : 60), w.v, n > 0 ? kinds[0] : "");
        if (k >= 0 && k < 64)
            *allow |= UINT64_C(1) << k;
        if (**at != ',')
            return TZ_OK;
        ++*at;
    }
}

/* "colour=class,class;colour=..." */
static tz_status read_table(tz_ctx *ctx, const char *text, const char *const *kinds,
                            int32_t n, table *t)
{
    tz_status s = TZ_OK;
    t->n = 1;
    t->allow[0] = UINT64_MAX;
    for (const char *p = text; *p && s == TZ_OK; p += *p == ';') {
        const word w = next_word(&p, "=;");
        uint32_t colour;
        if (w.n == 0 && *p != '=')
            continue;
        if (*p != '=' || !tz_color_parse(w.v, w.n, &colour))
            return tz_fail(ctx, TZ_INVALID,
                           "zones: \"%.*s\" is no colour with classes; write "
                           "#rrggbb=class,class;...",
                           (int)(w.n < 60 ? w.n : 60), w.v);
        p++;
        if (t->n > MOST_ZONES)
            return tz_fail(ctx, TZ_LIMIT, "zones: over %d colours; name fewer",
                           MOST_ZONES);
        t->colour[t->n] = colour;
        t->allow[t->n] = 0;
        s = read_kinds(ctx, &p, kinds, n, &t->allow[t->n]);
        t->n++;
    }
    return s;
}

/* Greatest difference of a channel. */
static int32_t unlike(uint32_t a, uint32_t b)
{
    int32_t most = 0;
    for (int k = 8; k < 32; k += 8) {
        const int32_t d = (int32_t)(a >> k & 255) - (int32_t)(b >> k & 255);
        most = d > most ? d : -d > most ? -d : most;
    }
    return most;
}

/* Zone of a colour: the nearest named one, else 0. */
static uint8_t zone_of(const table *t, uint32_t colour, int32_t tolerance)
{
    int32_t least = tolerance + 1, found = 0;
    for (int32_t k = 1; k < t->n; k++)
        if (unlike(t->colour[k], colour) < least)
            least = unlike(t->colour[k], colour), found = k;
    return (uint8_t)found;
}

/* ---- drawings -------------------------------------------------------------------- */

typedef struct painter {
    tz_zones *z;
    uint8_t zone;
} painter;

static void paint(void *user, int32_t row, int32_t x0, int32_t x1)
{
    const painter *p = user;
    memset(p->z->zone + (int64_t)row * p->z->raster.width + x0, p->zone,
           (size_t)(x1 - x0));
}

static tz_status read_drawing(tz_ctx *ctx, const char *path, const table *t, tz_zones *z)
{
    tz_element_reader r;
    tz_polys polys = {0};
    tz_status s = tz_guide_read_svg(ctx, path, z->raster.size, &r);
    for (int32_t i = 0; i < r.part.n && s == TZ_OK; i++) {
        const tz_part *p = &r.part.v[i];
        const bool filled = (p->look.fill & 255) != 0;
        painter brush = {
            z, zone_of(t, filled ? p->look.fill : p->look.stroke, TOLERANCE / 4)};
        tz_polys_clear(&polys);
        s = tz_part_polys(&r, p, tz_affine_identity(),
                          0.1 * z->raster.size.x / z->raster.width, &polys);
        if (s == TZ_OK)
            s = tz_guide_fill(ctx, &z->raster, &polys, filled && p->look.rule == 1, paint,
                              &brush);
    }
    tz_polys_deinit(ctx, &polys);
    tz_element_reader_deinit(&r);
    return s;
}

/* ---- pictures -------------------------------------------------------------------- */

static uint32_t byte_of(float v)
{
    return v > 0 ? v < 1 ? (uint32_t)(v * 255 + 0.5f) : 255 : 0;
}

static uint32_t colour_at(const tz_image *im, int32_t x, int32_t y)
{
    const float *p = tz_image_at(im, x, y);
    const bool grey = im->channels - (im->alpha >= 0) < 3;
    return byte_of(p[0]) << 24 | byte_of(p[grey ? 0 : 1]) << 16 |
           byte_of(p[grey ? 0 : 2]) << 8 | 255;
}

/* On a border fewer than five of nine pixels are alike. */
static bool is_flat(const tz_image *im, int32_t x, int32_t y)
{
    const uint32_t own = colour_at(im, x, y);
    int alike = 0, all = 0;
    for (int32_t j = y - 1; j <= y + 1; j++)
        for (int32_t i = x - 1; i <= x + 1; i++)
            if (i >= 0 && j >= 0 && i < im->width && j < im->height) {
                all++;
                alike += unlike(own, colour_at(im, i, j)) <= TOLERANCE;
            }
    return 2 * alike > all;
}

/* Cells that are not settled take the zone of the nearest that is, ring by ring. */
static tz_status settle(tz_ctx *ctx, tz_zones *z, uint8_t *settled)
{
    const int32_t w = z->raster.width, h = z->raster.height;
    TZ_ARRAY(int32_t)
    queue = {0};
    tz_status s = tz_array_reserve(ctx, &queue, (int64_t)w * h);
    for (int32_t i = 0; s == TZ_OK && i < w * h; i++)
        if (settled[i])
            queue.v[queue.n++] = i;
    for (int32_t k = 0; k < queue.n; k++) {
        const int32_t i = queue.v[k], x = i % w, y = i / w;
        const int32_t next[4] = {x > 0 ? i - 1 : i, x + 1 < w ? i + 1 : i,
                                 y > 0 ? i - w : i, y + 1 < h ? i + w : i};
        for (int m = 0; m < 4; m++)
            if (!settled[next[m]]) {
                settled[next[m]] = 1;
                z->zone[next[m]] = z->zone[i];
                queue.v[queue.n++] = next[m];
            }
    }
    tz_array_free(ctx, &queue);
    return s;
}

static tz_status read_picture(tz_ctx *ctx, const tz_image *im, const table *t,
                              tz_zones *z)
{
    uint8_t *settled = NULL;
    tz_status s = tz_alloc_zero(ctx, &settled, (size_t)im->width * (size_t)im->height, 1);
    for (int32_t y = 0; s == TZ_OK && y < im->height; y++)
        for (int32_t x = 0; x < im->width; x++) {
            const int64_t i = (int64_t)y * im->width + x;
            z->zone[i] = zone_of(t, colour_at(im, x, y), TOLERANCE);
            settled[i] = is_flat(im, x, y);
        }
    if (s == TZ_OK)
        s = settle(ctx, z, settled);
    tz_free(ctx, settled);
    return s;
}

/* ---- zones ----------------------------------------------------------------------- */

static tz_status make(tz_ctx *ctx, tz_raster raster, const table *t, tz_zones **out)
{
    tz_zones *z = NULL;
    tz_status s = tz_alloc_zero(ctx, &z, 1, sizeof *z);
    if (s != TZ_OK)
        return s;
    z->raster = raster;
    z->ctx = ctx;
    z->zones = t->n;
    s = tz_alloc_zero(ctx, &z->zone, (size_t)raster.width * (size_t)raster.height, 1);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &z->allow, (size_t)t->n, sizeof *z->allow);
    if (s == TZ_OK)
        memcpy(z->allow, t->allow, (size_t)t->n * sizeof *z->allow);
    if (s != TZ_OK)
        tz_zones_free(z);
    else
        *out = z;
    return s;
}

tz_status tz_zones_read(tz_ctx *ctx, const char *path, const char *text,
                        const char *const *kinds, int32_t n, tz_vec3 size, bool torus,
                        tz_zones **out)
{
    const bool drawn = tz_guide_is_svg(path);
    tz_raster r = {0};
    tz_image im = {0};
    tz_zones *z = NULL;
    table t;
    *out = NULL;
    tz_status s = read_table(ctx, text, kinds, n, &t);
    if (s == TZ_OK)
        s = tz_guide_raster(ctx, size, torus, TZ_GUIDE_SIDE, &r);
    if (s == TZ_OK && !drawn) {
        s = tz_guide_read_image(ctx, path, 2 * TZ_GUIDE_SIDE, true, &im);
        r.width = im.width, r.height = im.height;
    }
    if (s == TZ_OK)
        s = make(ctx, r, &t, &z);
    if (s == TZ_OK)
        s = drawn ? read_drawing(ctx, path, &t, z) : read_picture(ctx, &im, &t, z);
    tz_image_deinit(&im);
    if (s != TZ_OK)
        tz_zones_free(z);
    else
        *out = z;
    return s;
}
