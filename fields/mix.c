/* SPDX-License-Identifier: Apache-2.0 */
#include "fields/mix.h"

#include <stdlib.h>
#include <string.h>

#include "base/svg.h"

#define BLANKS " \t\r\n"

/** A stretch of the text. */
typedef struct span {
    const char *v;
    int n;
} span;

/** What is said of an entry. */
enum { SHARE = 1, RIGIDITY = 2, SIZE = 4, TURN = 8, JITTER = 16 };

/** One part: what it names, and what its elements are. */
typedef struct part {
    span name;
    tz_fill_entry entry; /**< share: of all of them together */
    unsigned said;
} part;

enum { MOST_PARTS = 256 };

static tz_status bad(tz_ctx *ctx, span w, const char *why)
{
    return tz_fail(ctx, TZ_INVALID, "mix: \"%.*s\" %s", w.n, w.v, why);
}

static bool is(span a, const char *b)
{
    return (int)strlen(b) == a.n && memcmp(a.v, b, (size_t)a.n) == 0;
}

/** One number, which takes up all of the span. */
static bool number(span w, double *out)
{
    char text[64];
    if (w.n <= 0 || w.n >= (int)sizeof text)
        return false;
    memcpy(text, w.v, (size_t)w.n);
    text[w.n] = 0;
    return tz_svg_number(text, out);
}

static span after(span w, int n) { return (span){w.v + n, w.n - n}; }

/** "A..B", or one number for both. */
static bool range(span w, double out[2])
{
    for (int i = 0; i + 1 < w.n; i++)
        if (w.v[i] == '.' && w.v[i + 1] == '.')
            return number((span){w.v, i}, &out[0]) && number(after(w, i + 2), &out[1]);
    if (!number(w, &out[0]))
        return false;
    out[1] = out[0];
    return true;
}

/** @param share  it may be said so, too */
static tz_status read_word(tz_ctx *ctx, span w, bool share, part *p)
{
    double v[2];
    tz_fill_entry *e = &p->entry;
    const char *eq = memchr(w.v, '=', (size_t)w.n);
    const span name = {w.v, eq ? (int)(eq - w.v) : w.n};
    const span value = eq ? after(w, name.n + 1) : (span){w.v, 0};
    if (is(name, "rigidity")) {
        if (!number(value, v) || !(v[0] >= 0 && v[0] <= 100))
            return bad(ctx, w, "wants a number from 0 (soft) to 100 (rigid)");
        e->rigidity = v[0], p->said |= RIGIDITY;
    } else if (is(name, "size")) {
        if (!range(value, v) || !(v[0] >= 0.001 && v[0] <= v[1] && v[1] <= 1000))
            return bad(ctx, w, "wants a size, or two as 0.5..2, from 0.001 to 1000");
        e->size[0] = v[0], e->size[1] = v[1], p->said |= SIZE;
    } else if (is(name, "turn") || is(name, "jitter")) {
        if (!number(value, v) || !(fabs(v[0]) <= 360))
            return bad(ctx, w, "wants degrees from -360 to 360");
        if (is(name, "turn"))
            e->turn = v[0] * TZ_PI / 180, p->said |= TURN;
        else
            e->jitter = fabs(v[0]) * TZ_PI / 180, p->said |= JITTER;
    } else if (share && (is(name, "share") || is(name, "weight"))) {
        if (!number(value, v) || !(v[0] >= 0 && v[0] <= 1e9))
            return bad(ctx, w, "wants a share from 0 to 1e9");
        e->share = v[0], p->said |= SHARE;
    } else {
        return bad(ctx, w,
                   share ? "is not one of share=, rigidity=, size=, turn= and jitter="
                         : "is not one of rigidity=, size=, turn= and jitter=");
    }
    return TZ_OK;
}

/** "leaf:3". Names may hold colons: the last one counts if a number follows. */
static tz_status read_name(tz_ctx *ctx, span w, part *p)
{
    double share;
    p->name = w;
    for (int i = w.n - 1; i >= 0; i--) {
        if (w.v[i] != ':')
            continue;
        if (i > 0 && number(after(w, i + 1), &share)) {
            if (!(share >= 0 && share <= 1e9))
                return bad(ctx, w, "wants a share from 0 to 1e9");
            p->name.n = i;
            p->entry.share = share, p->said |= SHARE;
        }
        break;
    }
    return TZ_OK;
}

static tz_status read_part(tz_ctx *ctx, const char *text, size_t n, double rigidity,
                           part *p)
{
    bool named = false;
    tz_status s = TZ_OK;
    *p = (part){.entry = {.share = 1, .rigidity = rigidity, .size = {1, 1}}};
    for (const char *at = text, *end = text + n; s == TZ_OK && at < end;) {
        at += strspn(at, BLANKS);
        const size_t k = strcspn(at, BLANKS ",");
        if (at >= end || k == 0)
            break;
        const span w = {at, (int)k};
        s = named ? read_word(ctx, w, false, p) : read_name(ctx, w, p);
        named = true;
        at += k;
    }
    return s;
}

static bool names(const part *p, const tz_element_set *palette, const tz_element *e)
{
    const tz_element_symbol *y = &palette->symbol.v[e->symbol];
    if (is(p->name, palette->kind.v[e->kind].name) || is(p->name, y->id))
        return true;
    for (const char *w = y->words ? y->words : ""; *w;) {
        const size_t n = strcspn(w, BLANKS);
        if ((int)n == p->name.n && memcmp(w, p->name.v, n) == 0)
            return true;
        w += n;
        w += strspn(w, BLANKS);
    }
    return false;
}

bool tz_mix_is(const tz_element_set *palette, int32_t element, const char *name)
{
    const part p = {.name = {name, (int)strlen(name)}};
    return names(&p, palette, &palette->element.v[element]);
}

/** The first part that names an element; -1 = none. A star has what others leave. */
static int32_t part_of(const part *p, int32_t n, const tz_element_set *palette,
                       const tz_element *e)
{
    int32_t star = -1;
    for (int32_t i = 0; i < n; i++) {
        if (names(&p[i], palette, e))
            return i;
        if (is(p[i].name, "*"))
            star = i;
    }
    return star;
}

/** What a thing's own drawing says of it. */
static tz_status read_own(tz_ctx *ctx, const tz_element_symbol *y, double rigidity,
                          part *own)
{
    tz_status s = TZ_OK;
    *own = (part){.entry = {.share = 1, .rigidity = rigidity, .size = {1, 1}}};
    for (const char *w = y->words ? y->words : ""; *w && s == TZ_OK;) {
        const size_t n = strcspn(w, BLANKS);
        if (memchr(w, '=', n))
            s = read_word(ctx, (span){w, (int)n}, true, own);
        w += n;
        w += strspn(w, BLANKS);
    }
    return s;
}

/** Shares of all that a part names, as they say themselves. */
typedef struct tally {
    int32_t count;
    double share;
    bool said;
} tally;

/** An element's entry: its own words, and over them those of the part. */
static tz_fill_entry entry_of(const part *own, const part *p, const tally *all)
{
    tz_fill_entry e = own->entry;
    if (p->said & RIGIDITY)
        e.rigidity = p->entry.rigidity;
    if (p->said & SIZE)
        e.size[0] = p->entry.size[0], e.size[1] = p->entry.size[1];
    if (p->said & TURN)
        e.turn = p->entry.turn;
    if (p->said & JITTER)
        e.jitter = p->entry.jitter;
    const double total = p->said & SHARE ? p->entry.share : all->said ? all->share : 1;
    e.share = all->share > 0 ? total * e.share / all->share : 0;
    return e;
}

/** Walks all elements that may be copied: counts them, or adds entries to the mix. */
static tz_status walk(tz_ctx *ctx, const part *p, int32_t n,
                      const tz_element_set *palette, double rigidity, tally *all,
                      tz_mix *mix)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < palette->element.n && s == TZ_OK; i++) {
        const tz_element *of = &palette->element.v[i];
        const int32_t k = part_of(p, n, palette, of);
        part own;
        if (k < 0 || !tz_element_may_copy(of))
            continue;
        s = read_own(ctx, &palette->symbol.v[of->symbol], rigidity, &own);
        if (s == TZ_OK && !mix) {
            all[k].count++;
            all[k].share += own.entry.share;
            all[k].said = all[k].said || (own.said & SHARE);
        } else if (s == TZ_OK) {
            tz_fill_entry e = entry_of(&own, &p[k], &all[k]);
            e.element = i;
            if (e.share > 0)
                s = tz_array_push(ctx, mix, e);
        }
    }
    return s;
}

/* No part of a mix may be left without things. */
static tz_status names_nothing(tz_ctx *ctx, const part *p, int32_t k,
                               const tz_element_set *palette)
{
    for (int32_t i = 0; i < k; i++)
        if (p[i].name.n == p[k].name.n &&
            memcmp(p[i].name.v, p[k].name.v, (size_t)p[k].name.n) == 0)
            return tz_fail(ctx, TZ_INVALID, "mix: \"%.*s\" is named twice; say it once",
                           p[k].name.n, p[k].name.v);
    return tz_fail(ctx, TZ_INVALID,
                   "mix: nothing in the palette that may be copied is called \"%.*s\"; "
                   "its first class is \"%s\"",
                   p[k].name.n, p[k].name.v,
                   palette->kind.n > 0 ? palette->kind.v[0].name : "");
}

static tz_status divide(tz_ctx *ctx, const part *p, int32_t n,
                        const tz_element_set *palette, double rigidity, tz_mix *mix)
{
    tally all[MOST_PARTS] = {{0, 0, false}};
    const tz_status s = walk(ctx, p, n, palette, rigidity, all, NULL);
    if (s != TZ_OK)
        return s;
    for (int32_t k = 0; k < n; k++)
        if (all[k].count == 0 && !is(p[k].name, "*"))
            return names_nothing(ctx, p, k, palette);
    return walk(ctx, p, n, palette, rigidity, all, mix);
}

tz_status tz_mix_parse(tz_ctx *ctx, const char *text, const tz_element_set *palette,
                       double rigidity, tz_mix *mix)
{
    part p[MOST_PARTS];
    int32_t n = 0;
    tz_status s = TZ_OK;
    for (const char *at = text; s == TZ_OK && *at;) {
        const size_t k = strcspn(at, ",");
        if (strspn(at, BLANKS) < k) {
            if (n == MOST_PARTS)
                return tz_fail(ctx, TZ_LIMIT, "mix: over %d parts; name fewer",
                               MOST_PARTS);
            s = read_part(ctx, at, k, rigidity, &p[n++]);
        }
        at += k + (at[k] == ',');
    }
    if (s == TZ_OK && n == 0)
        s = tz_fail(ctx, TZ_INVALID,
                    "mix: it names nothing; give classes as \"leaf:3, stone:1\"");
    if (s == TZ_OK)
        s = divide(ctx, p, n, palette, rigidity, mix);
    if (s == TZ_OK && mix->n == 0)
        s = tz_fail(ctx, TZ_INVALID, "mix: all shares are 0; give one of them more");
    if (s != TZ_OK)
        tz_array_free(ctx, mix);
    return s;
}

tz_status tz_mix_of_document(tz_ctx *ctx, const char *path, char **text)
{
    tz_svg_doc *doc = NULL;
    tz_status s = tz_svg_read(ctx, path, &doc);
    if (s != TZ_OK)
        return s;
    const char *mix = tz_svg_attr(tz_svg_root(doc), "tz:mix");
    s = tz_strdup(ctx, mix ? mix : "", text);
    tz_svg_free(doc);
    return s;
}
