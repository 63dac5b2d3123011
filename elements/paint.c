/* SPDX-License-Identifier: Apache-2.0 */
#include "elements/paint.h"

#include <string.h>

#include "elements/guide.h"

enum { MOST_PLACES = 1000000, BUDGET = 256 };

void tz_paint_deinit(tz_paint *p)
{
    tz_array_free(p->ctx, &p->stroke);
    tz_array_free(p->ctx, &p->point);
    *p = (tz_paint){0};
}

/* ---- reading ------------------------------------------------------------------------ */

static tz_paint_tool tool_of(const tz_part *part)
{
    static const char *const name[] = {"grow", "erase", "relax", "fill"};
    const uint32_t colour =
        part->look.stroke & 0xff ? part->look.stroke : part->look.fill;
    for (int i = 0; part->name && i < 4; i++)
        if (strcmp(part->name, name[i]) == 0)
            return (tz_paint_tool)i;
    switch (colour >> 8) {
    case 0xff0000: return TZ_PAINT_ERASE;
    case 0x0000ff: return TZ_PAINT_RELAX;
    case 0x00ff00:
    case 0x008000: return TZ_PAINT_FILL;
    default: return TZ_PAINT_GROW;
    }
}

static tz_status add_place(tz_paint *p, tz_vec2 at)
{
    if (p->point.n >= MOST_PLACES)
        return tz_fail(p->ctx, TZ_LIMIT,
                       "brush: over %d places; use fewer or wider strokes", MOST_PLACES);
    const tz_status s = tz_array_push(p->ctx, &p->point, at);
    if (s == TZ_OK)
        p->stroke.v[p->stroke.n - 1].points++;
    return s;
}

/** Places along a polyline, half a radius apart, its ends among them. */
static tz_status add_line(tz_paint *p, const tz_vec2 *v, int32_t n, double radius)
{
    tz_status s = add_place(p, v[0]);
    for (int32_t i = 1; i < n && s == TZ_OK; i++) {
        const tz_vec2 d = tz_vec2_sub(v[i], v[i - 1]);
        const double steps = fmin(MOST_PLACES, ceil(tz_vec2_length(d) / (radius / 2)));
        for (int32_t k = 1; k <= steps && s == TZ_OK; k++)
            s = add_place(p, tz_vec2_add(v[i - 1], tz_vec2_scale(d, k / steps)));
    }
    return s;
}

static tz_status add_part(tz_paint *p, const tz_element_reader *r, const tz_part *part,
                          double radius)
{
    tz_polys lines = {0};
    tz_status s =
        tz_polys_add_path(p->ctx, &lines, r->verb.v + part->verb, part->verbs,
                          r->point.v + part->point, tz_affine_identity(), 0.1 * radius);
    for (int32_t k = 0; k < lines.part.n && s == TZ_OK; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(&lines, k, &n);
        if (n < 1)
            continue;
        const tz_paint_stroke stroke = {
            .tool = tool_of(part), .point = p->point.n, .radius = radius};
        s = tz_array_push(p->ctx, &p->stroke, stroke);
        if (s == TZ_OK)
            s = add_line(p, v, n, radius);
        if (s == TZ_OK && lines.closed.v[k])
            s = add_line(p, (tz_vec2[]){v[n - 1], v[0]}, 2, radius);
    }
    tz_polys_deinit(p->ctx, &lines);
    return s;
}

tz_status tz_paint_read(tz_ctx *ctx, const char *path, tz_vec3 size, double radius,
                        double least, tz_paint *p)
{
    tz_element_reader r;
    *p = (tz_paint){.ctx = ctx};
    tz_status s = tz_guide_read_svg(ctx, path, size, &r);
    for (int32_t i = 0; s == TZ_OK && i < r.part.n; i++) {
        const double width = r.part.v[i].look.stroke & 0xff ? r.part.v[i].look.width : 0;
        s = add_part(p, &r, &r.part.v[i], radius > 0 ? radius : fmax(least, 0.5 * width));
    }
    if (s == TZ_OK && p->stroke.n == 0)
        s = tz_fail(
            ctx, TZ_INVALID,
            "%s: there are no strokes in view; draw some that the brush follows%s", path,
            tz_guide_hint(&r));
    tz_element_reader_deinit(&r);
    if (s != TZ_OK)
        tz_paint_deinit(p);
    return s;
}

/* ---- painting ----------------------------------------------------------------------- */

static tz_status grow_all(tz_growth *g)
{
    bool more = true;
    tz_status s = TZ_OK;
    while (more && s == TZ_OK)
        s = tz_growth_step(g, BUDGET, &more);
    return s;
}

static tz_status dab(tz_growth *g, const tz_paint_stroke *k, tz_vec2 at, int32_t texture)
{
    tz_status s = TZ_OK;
    switch (k->tool) {
    case TZ_PAINT_ERASE: return tz_brush_erase(g, at, k->radius, NULL);
    case TZ_PAINT_RELAX: return tz_brush_relax(g, at, k->radius);
    case TZ_PAINT_FILL: s = tz_brush_fill(g, at, texture, NULL); break;
    case TZ_PAINT_GROW: s = tz_brush_paint(g, at, k->radius, texture); break;
    }
    return s == TZ_OK ? grow_all(g) : s;
}

tz_status tz_paint_apply(const tz_paint *p, tz_growth *g, const tz_domain *domain,
                         int32_t texture)
{
    tz_status s = TZ_OK;
    tz_progress_begin(p->ctx, "paint", "places", p->point.n);
    for (int32_t i = 0; i < p->stroke.n && s == TZ_OK; i++) {
        const tz_paint_stroke *k = &p->stroke.v[i];
        const int32_t places = k->tool == TZ_PAINT_FILL ? 1 : k->points;
        for (int32_t j = 0; j < places && s == TZ_OK; j++) {
            const tz_vec2 at = p->point.v[k->point + j];
            if (tz_domain_contains(domain, (tz_vec3){at.x, at.y, 0}))
                s = dab(g, k, at, texture);
            if (s == TZ_OK && tz_ctx_cancelled(p->ctx))
                s = TZ_CANCELLED;
        }
        tz_progress_add(p->ctx, k->points);
    }
    tz_progress_end(p->ctx);
    return s;
}
