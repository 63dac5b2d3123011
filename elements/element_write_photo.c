/* SPDX-License-Identifier: Apache-2.0 */
/* Symbols cut from photos, and plates, as any viewer of SVG shows them. */
#include "elements/element_write_internal.h"

#include <string.h>

#include "base/href.h"

static tz_status put_image(tz_ctx *ctx, const char *doc, tz_svg_writer *w,
                           const tz_element_photo *p, int32_t i, bool plate)
{
    char *href = NULL;
    const tz_status s = tz_href_make(ctx, doc, plate ? p->plate : p->path, &href);
    if (s != TZ_OK)
        return s;
    tz_svg_begin(w, "image");
    tz_svg_setf(w, "id", plate ? "tz-plate-%d" : "tz-photo-%d", i);
    tz_svg_setf(w, plate ? "tz:plate" : "tz:photo", "%d", i);
    tz_svg_setf(w, "width", "%d", p->width);
    tz_svg_setf(w, "height", "%d", p->height);
    tz_svg_set(w, "preserveAspectRatio", "none");
    tz_svg_set(w, "xlink:href", href);
    if (!plate)
        tz_svg_setf(w, "tz:pixels", "%d %d", p->width, p->height);
    if (!plate && *p->sha256)
        tz_svg_set(w, "tz:sha256", p->sha256);
    tz_svg_end(w);
    tz_free(ctx, href);
    return TZ_OK;
}

tz_status tz_element_put_photos(tz_ctx *ctx, const char *doc, tz_svg_writer *w,
                                const tz_element_set *s)
{
    tz_status st = TZ_OK;
    for (int32_t i = 0; i < s->photo.n && st == TZ_OK; i++) {
        const tz_element_photo *p = &s->photo.v[i];
        if (!*p->path)
            return tz_fail(ctx, TZ_INVALID,
                           "%s: the photo that elements are cut from has no file name; "
                           "save it and name it",
                           doc);
        st = put_image(ctx, doc, w, p, i, false);
        if (st == TZ_OK && p->plate)
            st = put_image(ctx, doc, w, p, i, true);
    }
    return st;
}

static void put_point(FILE *f, char verb, tz_vec2 p)
{
    char x[32], y[32];
    tz_number_format(p.x, x);
    tz_number_format(p.y, y);
    fprintf(f, "%c%s %s", verb, x, y);
}

/* Too long for a formatted attribute: goes to the file as it is made. */
static void put_outline(tz_svg_writer *w, const tz_element_symbol *y)
{
    tz_svg_set(w, "clip-rule", "evenodd");
    if (w->status != TZ_OK)
        return;
    fputs(" d=\"", w->out.f);
    for (int32_t k = 0; k < y->part.n; k++) {
        const int32_t end = k + 1 < y->part.n ? y->part.v[k + 1] : y->outline.n;
        for (int32_t i = y->part.v[k]; i < end; i++)
            put_point(w->out.f, i == y->part.v[k] ? 'M' : 'L', y->outline.v[i]);
        fputc('Z', w->out.f);
    }
    fputc('"', w->out.f);
}

void tz_element_put_cut(tz_svg_writer *w, const tz_element_symbol *y)
{
    const double from[4] = {y->photo, y->photo_scale, y->photo_at.x, y->photo_at.y};
    const double s = 1 / y->photo_scale;
    tz_svg_set_numbers(w, "tz:photo", from, 4);
    tz_svg_begin(w, "clipPath");
    tz_svg_setf(w, "id", "%s-outline", y->id);
    tz_svg_begin(w, "path");
    put_outline(w, y);
    tz_svg_end(w);
    tz_svg_end(w);
    tz_svg_begin(w, "g");
    tz_svg_setf(w, "clip-path", "url(#%s-outline)", y->id);
    tz_svg_begin(w, "use");
    tz_svg_setf(w, "xlink:href", "#tz-photo-%d", y->photo);
    tz_svg_set_affine(
        w, "transform",
        (tz_affine){s, 0, 0, s, 0 - y->photo_at.x * s, 0 - y->photo_at.y * s});
    tz_svg_end(w);
    tz_svg_end(w);
}

/* ---- the plate ----------------------------------------------------------------------- */

static void put_plate_use(tz_svg_writer *w, tz_affine m)
{
    tz_svg_begin(w, "use");
    tz_svg_set(w, "xlink:href", "#tz-plate-0");
    tz_svg_set(w, "tz:copy", "1");
    tz_svg_set_affine(w, "transform", m);
    tz_svg_end(w);
}

/* Four mirror images in a row and column: borders of equal pixels meet. */
static void put_pattern(tz_svg_writer *w, const tz_element_photo *p, double s)
{
    tz_svg_begin(w, "pattern");
    tz_svg_set(w, "id", "tz-plate-pattern");
    tz_svg_set(w, "patternUnits", "userSpaceOnUse");
    tz_svg_set_number(w, "width", 2 * p->width * s);
    tz_svg_set_number(w, "height", 2 * p->height * s);
    for (int k = 0; k < 4; k++) {
        const double x = k % 2 ? -s : s, y = k / 2 ? -s : s;
        put_plate_use(w, (tz_affine){x, 0, 0, y, k % 2 ? 2 * p->width * s : 0,
                                     k / 2 ? 2 * p->height * s : 0});
    }
    tz_svg_end(w);
}

void tz_element_put_plate(tz_svg_writer *w, const tz_element_set *s)
{
    double scale = 0;
    if (s->photo.n == 0 || !s->photo.v[0].plate)
        return;
    for (int32_t i = 0; i < s->symbol.n && !(scale > 0); i++)
        if (s->symbol.v[i].photo == 0)
            scale = s->symbol.v[i].photo_scale;
    const tz_element_photo *p = &s->photo.v[0];
    const double unit = scale > 0 ? 1 / scale : 1;
    tz_svg_begin(w, "g");
    tz_svg_set(w, "id", "tz-ground");
    tz_svg_set(w, "tz:copy", "1");
    if (s->domain.size.x <= p->width * unit && s->domain.size.y <= p->height * unit) {
        put_plate_use(w, (tz_affine){unit, 0, 0, unit, 0, 0});
    } else {
        put_pattern(w, p, unit);
        tz_svg_begin(w, "rect");
        tz_svg_set_number(w, "width", s->domain.size.x);
        tz_svg_set_number(w, "height", s->domain.size.y);
        tz_svg_set(w, "fill", "url(#tz-plate-pattern)");
        tz_svg_end(w);
    }
    tz_svg_end(w);
}
