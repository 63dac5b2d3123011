/* SPDX-License-Identifier: Apache-2.0 */
#include "fields/ramp.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "elements/element_color.h"

/* Ends the id of a coloured symbol: "leaf-ramp07". */
#define MARK "-ramp"

/* ---- ramps -------------------------------------------------------------------------- */

typedef struct named {
    const char *name, *stops;
} named;

/* The first two are Matplotlib's, at even steps; hue goes round at even lightness. */
static const named known[] = {
    {"viridis", "#440154,#482878,#3e4989,#31688e,#26828e,#1f9e89,#35b779,#6ece58,#b5de2b,"
                "#fde725"},
    {"magma", "#000004,#180f3d,#440f76,#721f81,#9e2f7f,#cd4071,#f1605d,#fd9668,#feca8d,"
              "#fcfdbf"},
    {"grey", "#202020,#e0e0e0"},
    {"hue", "#e0607e,#d8743c,#a89220,#5ea64c,#16a98c,#1c9fc4,#7c89d8,#c06cc0"},
};

tz_status tz_ramp_parse(tz_ctx *ctx, const char *text, tz_ramp *ramp)
{
    const char *at = text;
    tz_ramp r = {.closed = strcmp(text, "hue") == 0};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(text, known[i].name) == 0)
            at = known[i].stops;
    while (*at) {
        uint32_t c;
        at += strspn(at, " ");
        const size_t n = strcspn(at, ", ");
        if (r.n == TZ_RAMP_STOPS)
            return tz_fail(ctx, TZ_INVALID, "ramp: over %d colours; give fewer",
                           TZ_RAMP_STOPS);
        if (n == 0 || !tz_color_parse(at, n, &c))
            return tz_fail(ctx, TZ_INVALID,
                           "ramp: \"%.*s\" is no colour; give colours as "
                           "\"#123,#abcdef\", or viridis, magma, grey or hue",
                           (int)(n < 40 ? n : 40), at);
        for (int k = 0; k < 3; k++)
            r.stop[r.n][k] = (uint8_t)(c >> (24 - 8 * k));
        r.n++;
        at += n;
        at += strspn(at, " ");
        at += *at == ',';
    }
    if (r.n == 0)
        return tz_fail(ctx, TZ_INVALID,
                       "ramp: it holds no colour; give some as \"#123,#abc\"");
    *ramp = r;
    return TZ_OK;
}

void tz_ramp_at(const tz_ramp *ramp, double t, uint8_t rgb[3])
{
    const int32_t pieces = ramp->closed ? ramp->n : ramp->n - 1;
    t = !(t == t) ? 0 : ramp->closed ? t - floor(t) : fmin(fmax(t, 0), 1);
    const double x = t * pieces;
    const int32_t i = (int32_t)fmin(floor(x), ramp->n - 1);
    const int32_t j = i + 1 < ramp->n ? i + 1 : ramp->closed ? 0 : i;
    for (int k = 0; k < 3; k++) {
        const double a = ramp->stop[i][k], b = ramp->stop[j][k];
        rgb[k] = (uint8_t)lrint(a + (x - i) * (b - a));
    }
}

/* ---- markup ------------------------------------------------------------------------- */

static double lightness(const uint8_t c[3])
{
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

/* The next "#rrggbb" of a fill or stroke: where its # stands; NULL = there is none. */
static char *next_paint(char *at, uint8_t c[3])
{
    static const char *const name[] = {" fill=\"#", " stroke=\"#"};
    char *best = NULL;
    for (int i = 0; i < 2; i++) {
        char *p = strstr(at, name[i]);
        if (p && (!best || p < best))
            best = p;
    }
    if (!best)
        return NULL;
    best = strchr(best, '#');
    unsigned v[3];
    if (strspn(best + 1, "0123456789abcdefABCDEF") != 6 ||
        sscanf(best + 1, "%2x%2x%2x", &v[0], &v[1], &v[2]) != 3)
        return next_paint(best + 1, c);
    for (int k = 0; k < 3; k++)
        c[k] = (uint8_t)v[k];
    return best;
}

/* All paints of a markup, whose length does not change. */
static void colour_markup(char *markup, const uint8_t to[3])
{
    uint8_t c[3], first[3];
    if (!next_paint(markup, first))
        return;
    for (char *p = next_paint(markup, c); p; p = next_paint(p, c)) {
        const double by = lightness(c) - lightness(first);
        for (int k = 0; k < 3; k++) {
            const int v = (int)lrint(fmin(fmax(to[k] + by, 0), 255));
            p[1 + 2 * k] = "0123456789abcdef"[v >> 4];
            p[2 + 2 * k] = "0123456789abcdef"[v & 15];
        }
        p += 7;
    }
}

/* ---- layouts ------------------------------------------------------------------------ */

/* A plain disc is drawn by its radius: it needs markup to have a colour. */
static tz_status markup_of(tz_ctx *ctx, const tz_element_symbol *y, char **out)
{
    char text[96];
    if (*y->markup)
        return tz_strdup(ctx, y->markup, out);
    snprintf(text, sizeof text, "<circle r=\"%.9g\" fill=\"#808080\"/>", y->radius);
    return tz_strdup(ctx, text, out);
}

static tz_status add_symbol(tz_element_set *s, int32_t from, int32_t step,
                            const uint8_t rgb[3], int32_t *out)
{
    const char *id = s->symbol.v[from].id;
    const size_t room = strlen(id) + sizeof MARK + 16;
    char *name = NULL, *markup = NULL;
    tz_status st = tz_alloc(s->ctx, &name, room, 1);
    if (st == TZ_OK) {
        snprintf(name, room, "%s" MARK "%02d", id, step);
        st = markup_of(s->ctx, &s->symbol.v[from], &markup);
    }
    if (st == TZ_OK)
        st = tz_element_symbol_copy(s, &s->symbol.v[from]);
    if (st != TZ_OK) {
        tz_free(s->ctx, name), tz_free(s->ctx, markup);
        return st;
    }
    *out = s->symbol.n - 1;
    tz_element_symbol *y = &s->symbol.v[*out];
    tz_free(s->ctx, y->id), tz_free(s->ctx, y->markup);
    y->id = name, y->markup = markup;
    colour_markup(y->markup, rgb);
    return TZ_OK;
}

tz_status tz_ramp_check(const tz_element_set *palette)
{
    for (int32_t i = 0; i < palette->symbol.n; i++)
        if (palette->symbol.v[i].photo_scale > 0)
            return tz_fail(palette->ctx, TZ_UNSUPPORTED,
                           "ramp: things that are cut out of a photo keep its colours; "
                           "give a drawing as the palette");
    return TZ_OK;
}

tz_status tz_ramp_paint(const tz_ramp *ramp, tz_element_set *layout, const double *value)
{
    const int32_t symbols = layout->symbol.n;
    const int32_t steps = TZ_RAMP_STEPS;
    int32_t *made = NULL;
    tz_status s = tz_ramp_check(layout);
    if (s == TZ_OK)
        s = tz_alloc(layout->ctx, &made, (size_t)symbols * (size_t)steps, sizeof *made);
    for (int32_t i = 0; i < symbols * steps && s == TZ_OK; i++)
        made[i] = -1;
    for (int32_t i = 0; i < layout->element.n && s == TZ_OK; i++) {
        tz_element *e = &layout->element.v[i];
        if (!(value[i] == value[i]))
            continue;
        const double t = ramp->closed ? value[i] - floor(value[i])
                                      : fmin(fmax(value[i], 0), 1) * (steps - 1) / steps;
        const int32_t k =
            (int32_t)fmin(floor(t * steps + 0.5 * !ramp->closed), steps - 1);
        int32_t *to = &made[e->symbol * steps + k];
        if (*to < 0) {
            uint8_t rgb[3];
            tz_ramp_at(ramp, ramp->closed ? (k + 0.5) / steps : (double)k / (steps - 1),
                       rgb);
            s = add_symbol(layout, e->symbol, k, rgb, to);
        }
        if (s == TZ_OK)
            e->symbol = *to;
    }
    tz_free(layout->ctx, made);
    return s;
}

/* The palette's symbol that an id is made from; -1 = none. */
static int32_t base_of(const tz_element_set *palette, const char *id)
{
    const char *mark = NULL;
    for (const char *p = strstr(id, MARK); p; p = strstr(p + 1, MARK))
        mark = p;
    const size_t n = mark && strspn(mark + sizeof MARK - 1, "0123456789") ==
                                 strlen(mark + sizeof MARK - 1)
                         ? (size_t)(mark - id)
                         : strlen(id);
    for (int32_t k = 0; k < palette->symbol.n; k++)
        if (strncmp(palette->symbol.v[k].id, id, n) == 0 && !palette->symbol.v[k].id[n])
            return k;
    return -1;
}

bool tz_ramp_strip(tz_element_set *layout, const tz_element_set *palette)
{
    const int32_t own = palette->symbol.n;
    if (layout->symbol.n < own)
        return false;
    for (int32_t k = 0; k < layout->symbol.n; k++) {
        const char *id = layout->symbol.v[k].id;
        if (k < own ? strcmp(id, palette->symbol.v[k].id) != 0 : base_of(palette, id) < 0)
            return false;
    }
    for (int32_t i = 0; i < layout->element.n; i++) {
        tz_element *e = &layout->element.v[i];
        if (e->symbol >= own)
            e->symbol = base_of(palette, layout->symbol.v[e->symbol].id);
    }
    return true;
}
