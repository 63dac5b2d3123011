/* SPDX-License-Identifier: Apache-2.0 */
/* Sets of elements: making, copying, checking. */
#include "elements/element.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "base/number.h"

static void symbol_deinit(tz_ctx *ctx, tz_element_symbol *y)
{
    tz_free(ctx, y->id);
    tz_free(ctx, y->markup);
    tz_free(ctx, y->words);
    tz_array_free(ctx, &y->outline);
    tz_array_free(ctx, &y->part);
}

static void photo_deinit(tz_ctx *ctx, tz_element_photo *p)
{
    tz_free(ctx, p->path);
    tz_free(ctx, p->plate);
}

void tz_element_set_deinit(tz_element_set *s)
{
    tz_ctx *ctx = s->ctx;
    for (int32_t i = 0; i < s->kind.n; i++)
        tz_free(ctx, s->kind.v[i].name);
    for (int32_t i = 0; i < s->symbol.n; i++)
        symbol_deinit(ctx, &s->symbol.v[i]);
    for (int32_t i = 0; i < s->photo.n; i++)
        photo_deinit(ctx, &s->photo.v[i]);
    tz_array_free(ctx, &s->photo);
    tz_array_free(ctx, &s->element);
    tz_array_free(ctx, &s->sample);
    tz_array_free(ctx, &s->kind);
    tz_array_free(ctx, &s->symbol);
    tz_free(ctx, s->background);
    tz_free(ctx, s->recipe);
    memset(s, 0, sizeof *s);
}

/* ---- copies ---------------------------------------------------------------------- */

static tz_status copy_kind(tz_element_set *to, const tz_element_kind *k)
{
    tz_element_kind copy = *k;
    copy.name = NULL;
    tz_status s = tz_strdup(to->ctx, k->name, &copy.name);
    if (s == TZ_OK)
        s = tz_array_push(to->ctx, &to->kind, copy);
    if (s != TZ_OK)
        tz_free(to->ctx, copy.name);
    return s;
}

tz_status tz_element_symbol_copy(tz_element_set *to, const tz_element_symbol *y)
{
    tz_ctx *ctx = to->ctx;
    tz_element_symbol copy = {.radius = y->radius,
                              .photo_scale = y->photo_scale,
                              .photo_at = y->photo_at,
                              .photo = y->photo};
    tz_status s = tz_strdup(ctx, y->id, &copy.id);
    if (s == TZ_OK)
        s = tz_strdup(ctx, y->markup, &copy.markup);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &copy.outline, y->outline.n);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &copy.part, y->part.n);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &to->symbol, (int64_t)to->symbol.n + 1);
    if (s != TZ_OK) {
        symbol_deinit(ctx, &copy);
        return s;
    }
    for (int32_t i = 0; i < y->outline.n; i++)
        copy.outline.v[copy.outline.n++] = y->outline.v[i];
    for (int32_t i = 0; i < y->part.n; i++)
        copy.part.v[copy.part.n++] = y->part.v[i];
    to->symbol.v[to->symbol.n++] = copy;
    return TZ_OK;
}

static tz_status copy_photo(tz_element_set *to, const tz_element_photo *p)
{
    tz_ctx *ctx = to->ctx;
    tz_element_photo copy = {.width = p->width, .height = p->height};
    memcpy(copy.sha256, p->sha256, sizeof copy.sha256);
    tz_status s = tz_strdup(ctx, p->path, &copy.path);
    if (s == TZ_OK && p->plate)
        s = tz_strdup(ctx, p->plate, &copy.plate);
    if (s == TZ_OK)
        s = tz_array_push(ctx, &to->photo, copy);
    if (s != TZ_OK)
        photo_deinit(ctx, &copy);
    return s;
}

/** Background of `from`, stretched over the domain of `to`. */
static tz_status copy_background(const tz_element_set *from, tz_element_set *to)
{
    static const char form[] = "<g transform=\"scale(%s %s)\">%s</g>";
    const tz_vec3 a = from->domain.size, b = to->domain.size;
    char x[32], y[32];
    if (a.x == b.x && a.y == b.y)
        return tz_strdup(to->ctx, from->background, &to->background);
    tz_number_format(b.x / a.x, x);
    tz_number_format(b.y / a.y, y);
    const size_t room = sizeof form + sizeof x + sizeof y + strlen(from->background);
    tz_status s = tz_alloc(to->ctx, &to->background, room, 1);
    if (s == TZ_OK)
        snprintf(to->background, room, form, x, y, from->background);
    return s;
}

tz_status tz_element_set_like(tz_ctx *ctx, const tz_element_set *from,
                              const tz_domain *domain, tz_element_set *to)
{
    tz_element_set set = {.domain = domain ? *domain : from->domain, .ctx = ctx};
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < from->kind.n && s == TZ_OK; i++)
        s = copy_kind(&set, &from->kind.v[i]);
    for (int32_t i = 0; i < from->symbol.n && s == TZ_OK; i++)
        s = tz_element_symbol_copy(&set, &from->symbol.v[i]);
    for (int32_t i = 0; i < from->photo.n && s == TZ_OK; i++)
        s = copy_photo(&set, &from->photo.v[i]);
    if (s == TZ_OK && from->background)
        s = copy_background(from, &set);
    if (s != TZ_OK)
        tz_element_set_deinit(&set);
    *to = set;
    return s;
}

/* The offset of a sample from its element, turned and scaled about the element. */
static tz_vec3 turned(tz_vec3 from, tz_vec3 p, double cosine, double sine, double scale)
{
    const double x = (p.x - from.x) * scale, y = (p.y - from.y) * scale;
    return (tz_vec3){cosine * x - sine * y, sine * x + cosine * y,
                     (p.z - from.z) * scale};
}

tz_status tz_element_set_place(tz_element_set *s, const tz_element_set *from,
                               int32_t source, tz_vec3 at, double angle, double scale)
{
    assert(source >= 0 && source < from->element.n);
    const tz_element o = from->element.v[source];
    const double cosine = cos(angle), sine = sin(angle);
    tz_element e = o;
    tz_status st = tz_array_reserve(s->ctx, &s->element, (int64_t)s->element.n + 1);
    if (st == TZ_OK)
        st = tz_array_reserve(s->ctx, &s->sample, (int64_t)s->sample.n + o.samples);
    if (st != TZ_OK)
        return st;
    e.source = source;
    e.sample = s->sample.n;
    e.at = tz_domain_wrap(&s->domain, at);
    e.angle += angle;
    e.scale *= scale;
    e.radius *= scale;
    e.fixed = false;
    e.doubtful = false;
    for (int32_t i = 0; i < o.samples; i++) {
        /* read after the growth above: `from` may be `s` */
        tz_sample p = from->sample.v[o.sample + i];
        const tz_vec3 v = turned(o.at, p.at, cosine, sine, scale);
        p.at = (tz_vec3){e.at.x + v.x, e.at.y + v.y, e.at.z + v.z};
        s->sample.v[s->sample.n++] = p;
    }
    s->element.v[s->element.n++] = e;
    return TZ_OK;
}

/* ---- checks ---------------------------------------------------------------------- */

static bool finite3(tz_vec3 p) { return isfinite(p.x) && isfinite(p.y) && isfinite(p.z); }

static bool positive(double v) { return v > 0 && isfinite(v); }

/** What is wrong with an element, or NULL. */
static const char *fault_of(const tz_element_set *s, const tz_element *e)
{
    if (e->kind < 0 || e->kind >= s->kind.n)
        return "its class does not exist";
    if (e->symbol < 0 || e->symbol >= s->symbol.n)
        return "its symbol does not exist";
    if (e->source < -1)
        return "its source is below -1";
    if (e->samples < 1 || e->sample < 0 || e->samples > s->sample.n - e->sample)
        return "it has no samples, or some that do not exist";
    if (!finite3(e->at) || !isfinite(e->angle))
        return "its position or angle is not a number";
    if (!positive(e->scale) || !positive(e->radius))
        return "its scale or radius is not above 0";
    for (int32_t i = e->sample; i < e->sample + e->samples; i++) {
        if (!finite3(s->sample.v[i].at))
            return "a sample's position is not a number";
        if (!positive(s->sample.v[i].weight))
            return "a sample's weight is not above 0";
    }
    return NULL;
}

/** What is wrong with the tables, or NULL; *at is the row. */
static const char *fault_of_tables(const tz_element_set *s, int32_t *at)
{
    for (*at = 0; *at < s->kind.n; ++*at)
        if (!s->kind.v[*at].name)
            return "class";
    for (*at = 0; *at < s->photo.n; ++*at)
        if (!s->photo.v[*at].path || s->photo.v[*at].width < 1 ||
            s->photo.v[*at].height < 1)
            return "photo";
    for (*at = 0; *at < s->symbol.n; ++*at) {
        const tz_element_symbol *y = &s->symbol.v[*at];
        if (y->photo_scale != 0 &&
            (!positive(y->photo_scale) || y->photo < 0 || y->photo >= s->photo.n ||
             !isfinite(y->photo_at.x) || !isfinite(y->photo_at.y)))
            return "symbol";
        if (!y->id || !y->markup || !positive(y->radius))
            return "symbol";
        for (int32_t k = 0; k < y->outline.n; k++)
            if (!isfinite(y->outline.v[k].x) || !isfinite(y->outline.v[k].y))
                return "symbol";
        for (int32_t k = 0; k < y->part.n; k++)
            if (y->part.v[k] < (k ? y->part.v[k - 1] : 0) || y->part.v[k] >= y->outline.n)
                return "symbol";
    }
    return NULL;
}

tz_status tz_element_set_check(tz_ctx *ctx, const tz_element_set *s, const char *name)
{
    int32_t row;
    if (!positive(s->domain.size.x) || !positive(s->domain.size.y) ||
        !isfinite(s->domain.size.z))
        return tz_fail(ctx, TZ_INVALID, "%s: the domain of %g x %g has no area", name,
                       s->domain.size.x, s->domain.size.y);
    const char *fault = fault_of_tables(s, &row);
    if (fault)
        return tz_fail(ctx, TZ_INVALID, "%s: %s %d is incomplete; read the drawing again",
                       name, fault, row);
    for (int32_t i = 0; i < s->element.n; i++) {
        fault = fault_of(s, &s->element.v[i]);
        if (fault)
            return tz_fail(ctx, TZ_INVALID, "%s: element %d cannot be used: %s", name, i,
                           fault);
    }
    return TZ_OK;
}
