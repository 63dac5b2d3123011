/* SPDX-License-Identifier: Apache-2.0 */
#include "fields/fill_paint.h"

#include <string.h>

#include "base/number.h"
#include "elements/guide.h"
#include "fields/fill_internal.h"
#include "fields/mix.h"

enum { MOST_POINTS = 100000 };

void tz_fill_paint_deinit(tz_fill_paint *p)
{
    tz_array_free(p->ctx, &p->stroke);
    tz_array_free(p->ctx, &p->point);
    *p = (tz_fill_paint){0};
}

/* ---- words -------------------------------------------------------------------------- */

static const char *const tools[] = {"add", "erase", "replace", "relax"};

static bool is(const char *w, size_t n, const char *text)
{
    return strlen(text) == n && memcmp(w, text, n) == 0;
}

static bool read_tool(const char *w, size_t n, tz_fill_tool *out)
{
    for (int k = 0; k < 4; k++)
        if (is(w, n, tools[k])) {
            *out = (tz_fill_tool)k;
            return true;
        }
    return false;
}

static bool read_number(const char *w, size_t n, double *out)
{
    char text[64];
    const char *rest = text;
    if (n == 0 || n >= sizeof text)
        return false;
    memcpy(text, w, n), text[n] = 0;
    return tz_number_parse(text, &rest, out) && !*rest && isfinite(*out);
}

/* @return NULL, or what the word should be */
static const char *read_word(const char *w, size_t n, bool strict, tz_fill_stroke *t)
{
    const char *eq = memchr(w, '=', n);
    const size_t k = eq ? (size_t)(eq - w) : n, v = eq ? n - k - 1 : 0;
    if (!eq) {
        read_tool(w, n, &t->tool); /* else a plain class name */
        return NULL;
    }
    if (is(w, k, "op"))
        return read_tool(eq + 1, v, &t->tool)
                   ? NULL
                   : "it may be op=add, erase, replace or relax";
    if (is(w, k, "size"))
        return read_number(eq + 1, v, &t->size) &&
                       t->size >= TZ_ELEMENT_FIELD_LEAST_SIZE &&
                       t->size <= TZ_ELEMENT_FIELD_MOST_SIZE
                   ? NULL
                   : "a size is one number from 0.001 to 1000";
    if (is(w, k, "entry")) {
        if (v == 0 || v >= TZ_FILL_NAME)
            return "it names a class or symbol of the palette, of up to 63 letters";
        memcpy(t->entry, eq + 1, v), t->entry[v] = 0;
        return NULL;
    }
    return strict ? "it may say op=erase, entry=leaf and size=1.5" : NULL;
}

static tz_status read_text(tz_ctx *ctx, const char *path, const char *p, bool strict,
                           tz_fill_stroke *t)
{
    static const char blank[] = " \t\r\n";
    while (p && *p) {
        p += strspn(p, blank);
        const size_t n = strcspn(p, blank);
        const char *why = n > 0 ? read_word(p, n, strict, t) : NULL;
        if (why)
            return tz_fail(ctx, TZ_INVALID, "%s:%d: a stroke says \"%.*s\"; %s", path,
                           t->line, (int)(n < 40 ? n : 40), p, why);
        p += n;
    }
    return TZ_OK;
}

static tz_fill_tool tool_of(const tz_part *part)
{
    const uint32_t colour =
        part->look.stroke & 0xff ? part->look.stroke : part->look.fill;
    switch (colour >> 8) {
    case 0xff0000: return TZ_FILL_ERASE;
    case 0x0000ff: return TZ_FILL_RELAX;
    case 0xff00ff: return TZ_FILL_REPLACE;
    default: return TZ_FILL_ADD;
    }
}

/* ---- reading ------------------------------------------------------------------------ */

static tz_status add_line(tz_fill_paint *p, tz_fill_stroke t, const tz_vec2 *v, int32_t n,
                          bool closed)
{
    const int32_t all = n + (closed && n > 1);
    t.point = p->point.n, t.points = all;
    if ((int64_t)p->point.n + all > MOST_POINTS)
        return tz_fail(p->ctx, TZ_LIMIT,
                       "brush: over %d points of strokes; use fewer or plainer ones",
                       MOST_POINTS);
    tz_status s = tz_array_reserve(p->ctx, &p->point, (int64_t)p->point.n + all);
    for (int32_t i = 0; i < all && s == TZ_OK; i++)
        p->point.v[p->point.n++] = v[i % n];
    return s == TZ_OK ? tz_array_push(p->ctx, &p->stroke, t) : s;
}

static tz_status add_part(tz_fill_paint *p, const char *path, const tz_element_reader *r,
                          const tz_part *part, double radius)
{
    tz_polys lines = {0};
    const double pen = part->look.stroke & 0xff ? 0.5 * part->look.width : 0;
    tz_fill_stroke t = {.tool = tool_of(part), .line = part->line};
    t.radius = radius > 0 ? radius : pen;
    tz_status s = read_text(p->ctx, path, part->group, true, &t);
    if (s == TZ_OK)
        s = read_text(p->ctx, path, part->label, false, &t);
    if (s == TZ_OK)
        s = read_text(p->ctx, path, part->name, true, &t);
    if (s == TZ_OK && !(t.radius > 0))
        s = tz_fail(p->ctx, TZ_INVALID,
                    "%s:%d: a stroke of the brush has no width; give it one, or all of "
                    "them with --brush-radius",
                    path, part->line);
    if (s == TZ_OK)
        s = tz_polys_add_path(p->ctx, &lines, r->verb.v + part->verb, part->verbs,
                              r->point.v + part->point, tz_affine_identity(),
                              0.05 * t.radius);
    for (int32_t k = 0; k < lines.part.n && s == TZ_OK; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(&lines, k, &n);
        if (n > 0)
            s = add_line(p, t, v, n, lines.closed.v[k]);
    }
    tz_polys_deinit(p->ctx, &lines);
    return s;
}

tz_status tz_fill_paint_read(tz_ctx *ctx, const char *path, tz_vec3 size, double radius,
                             tz_fill_paint *p)
{
    tz_element_reader r;
    *p = (tz_fill_paint){.ctx = ctx};
    tz_status s = tz_guide_read_svg(ctx, path, size, &r);
    for (int32_t i = 0; s == TZ_OK && i < r.part.n; i++)
        s = add_part(p, path, &r, &r.part.v[i], radius);
    if (s == TZ_OK && p->stroke.n == 0)
        s = tz_fail(
            ctx, TZ_INVALID,
            "%s: there are no strokes in view; draw some that the brush follows%s", path,
            tz_guide_hint(&r));
    tz_element_reader_deinit(&r);
    if (s != TZ_OK)
        tz_fill_paint_deinit(p);
    return s;
}

/* ---- painting ----------------------------------------------------------------------- */

static bool adds(const tz_fill_stroke *t)
{
    return t->tool == TZ_FILL_ADD || t->tool == TZ_FILL_REPLACE;
}

tz_status tz_fill_paint_say(const tz_fill_paint *p, tz_element_field *field)
{
    TZ_ARRAY(tz_element_field_point)
    point = {0};
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < p->stroke.n && s == TZ_OK; i++) {
        const tz_fill_stroke *t = &p->stroke.v[i];
        double way = 0;
        if (!adds(t))
            continue;
        s = tz_array_reserve(field->ctx, &point, t->points);
        for (int32_t k = 0; k < t->points && s == TZ_OK; k++) {
            const tz_vec2 at = p->point.v[t->point + k];
            point.v[k] =
                (tz_element_field_point){.at = at, .size = t->size, .density = -1};
            if (k > 0)
                way += tz_vec2_length(tz_vec2_sub(at, point.v[k - 1].at));
        }
        if (s == TZ_OK && (way > 0 || t->size > 0))
            s = tz_element_field_add(field,
                                     (tz_element_field_stroke){.radius = t->radius,
                                                               .weight = 1,
                                                               .directed = way > 0},
                                     t->points, point.v);
    }
    tz_array_free(field->ctx, &point);
    return s;
}

/* Things are drawn from the mix by their shares: those of another name have none while
 * the stroke is painted. */
static tz_status add_named(const tz_fill_stroke *t, tz_fill *f, const tz_vec2 *v)
{
    double *share = NULL, left = 0;
    bool known = false;
    tz_status s = tz_alloc(f->ctx, &share, (size_t)f->entries, sizeof *share);
    if (s != TZ_OK)
        return s;
    for (int32_t k = 0; k < f->entries; k++) {
        tz_fill_model *m = &f->model.v[k];
        const bool named = !*t->entry || tz_mix_is(f->job.palette, m->element, t->entry);
        known = known || named;
        share[k] = m->share;
        m->share *= named;
        left += m->share;
    }
    const double size = t->size > 0 ? t->size : 1;
    if (!(left > 0))
        s = tz_fail(f->ctx, TZ_INVALID,
                    known ? "brush, line %d: \"%s\" is larger than the domain, or has no "
                            "share in the mix"
                          : "brush, line %d: the mix has no \"%s\"; name a class or "
                            "symbol of the palette, and have it in --mix",
                    t->line, t->entry);
    else
        s = tz_fill_add(f, t->points, v, t->radius, -1, size);
    for (int32_t k = 0; k < f->entries; k++)
        f->model.v[k].share = share[k];
    tz_free(f->ctx, share);
    return s;
}

/* Places along a stroke, a radius apart. */
static tz_status wake_along(const tz_fill_stroke *t, tz_fill *f, const tz_vec2 *v)
{
    tz_status s = tz_fill_wake(f, v[0], t->radius);
    for (int32_t i = 1; i < t->points && s == TZ_OK; i++) {
        const tz_vec2 d = tz_vec2_sub(v[i], v[i - 1]);
        const int32_t steps =
            (int32_t)fmin(MOST_POINTS, ceil(tz_vec2_length(d) / t->radius));
        for (int32_t k = 1; k <= steps && s == TZ_OK; k++)
            s = tz_fill_wake(
                f, tz_vec2_add(v[i - 1], tz_vec2_scale(d, (double)k / steps)), t->radius);
    }
    return s;
}

tz_status tz_fill_paint_apply(const tz_fill_paint *p, tz_fill *f, int32_t iterations)
{
    tz_status s = TZ_OK;
    tz_progress_begin(f->ctx, "paint", "strokes", p->stroke.n);
    for (int32_t i = 0; i < p->stroke.n && s == TZ_OK; i++) {
        const tz_fill_stroke *t = &p->stroke.v[i];
        const tz_vec2 *v = p->point.v + t->point;
        if (t->tool == TZ_FILL_ERASE || t->tool == TZ_FILL_REPLACE)
            s = tz_fill_erase(f, t->points, v, t->radius);
        if (s == TZ_OK && adds(t))
            s = add_named(t, f, v);
        if (t->tool == TZ_FILL_RELAX)
            s = wake_along(t, f, v);
        if (s == TZ_OK && tz_ctx_cancelled(f->ctx))
            s = TZ_CANCELLED;
        if (s == TZ_OK && t->tool == TZ_FILL_ERASE)
            tz_fill_hold(f); /* nothing drifts to where it is to be empty */
        else if (s == TZ_OK)
            s = tz_fill_settle(f, iterations);
        tz_progress_add(f->ctx, 1);
    }
    tz_progress_end(f->ctx);
    return s;
}
