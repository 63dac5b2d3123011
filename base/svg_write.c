/* SPDX-License-Identifier: Apache-2.0 */
/* Streaming SVG writer. */
#include <assert.h>
#include <stdarg.h>
#include <string.h>

#include "base/svg.h"

static void put(tz_svg_writer *w, const char *text)
{
    if (w->status == TZ_OK)
        fputs(text, w->out.f); /* errors are seen at commit */
}

/* Characters that XML has no way to write become '?'. */
static void put_escaped(tz_svg_writer *w, const char *text, bool attribute)
{
    if (w->status != TZ_OK)
        return;
    for (const char *p = text; *p; p++) {
        unsigned char c = (unsigned char)*p;
        if (c == '&')
            fputs("&amp;", w->out.f);
        else if (c == '<')
            fputs("&lt;", w->out.f);
        else if (c == '>')
            fputs("&gt;", w->out.f);
        else if (c == '"' && attribute)
            fputs("&quot;", w->out.f);
        else if (c == '\r' || (attribute && (c == '\n' || c == '\t')))
            fprintf(w->out.f, "&#%d;", c); /* else normalised away by readers */
        else if (c < 0x20 && c != '\n' && c != '\t')
            fputc('?', w->out.f);
        else
            fputc(c, w->out.f);
    }
}

static void close_tag(tz_svg_writer *w)
{
    if (w->in_tag)
        put(w, ">");
    w->in_tag = false;
}

/** The root; unit_mm > 0: its size on paper is told. */
static tz_status open_root(double width, double height, double unit_mm, tz_svg_writer *w)
{
    const double box[4] = {0, 0, width, height};
    tz_svg_begin(w, "svg");
    tz_svg_set(w, "xmlns", TZ_SVG_NS);
    tz_svg_set(w, "xmlns:xlink", TZ_XLINK_NS);
    tz_svg_set(w, "xmlns:tz", TZ_NS);
    tz_svg_set(w, "version", "1.1");
    if (unit_mm > 0) {
        tz_svg_setf(w, "width", "%.9gmm", width * unit_mm);
        tz_svg_setf(w, "height", "%.9gmm", height * unit_mm);
    } else {
        tz_svg_set_number(w, "width", width);
        tz_svg_set_number(w, "height", height);
    }
    tz_svg_set_numbers(w, "viewBox", box, 4);
    const tz_status s = w->status;
    if (s != TZ_OK)
        tz_svg_writer_abort(w);
    return s;
}

tz_status tz_svg_writer_open(tz_ctx *ctx, const char *path, double width, double height,
                             tz_svg_writer *w)
{
    return tz_svg_writer_open_mm(ctx, path, width, height, 0, w);
}

tz_status tz_svg_writer_open_mm(tz_ctx *ctx, const char *path, double width,
                                double height, double unit_mm, tz_svg_writer *w)
{
    memset(w, 0, sizeof *w);
    tz_status s = tz_file_out_open(ctx, path, &w->out);
    if (s != TZ_OK)
        return w->status = s;
    put(w, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>");
    return open_root(width, height, unit_mm, w);
}

tz_status tz_svg_writer_open_text(tz_ctx *ctx, const char *name, double width,
                                  double height, tz_svg_writer *w)
{
    memset(w, 0, sizeof *w);
    tz_status s = tz_file_out_open_text(ctx, name, &w->out);
    return s == TZ_OK ? open_root(width, height, 0, w) : (w->status = s);
}

void tz_svg_begin(tz_svg_writer *w, const char *name)
{
    if (w->status != TZ_OK)
        return;
    close_tag(w);
    w->status = tz_array_push(w->out.ctx, &w->open, name);
    put(w, "\n<");
    put(w, name);
    w->in_tag = true;
}

void tz_svg_set(tz_svg_writer *w, const char *attr, const char *value)
{
    assert((w->in_tag || w->status != TZ_OK) && "attributes come before children");
    put(w, " ");
    put(w, attr);
    put(w, "=\"");
    put_escaped(w, value, true);
    put(w, "\"");
}

void tz_svg_setf(tz_svg_writer *w, const char *attr, const char *fmt, ...)
{
    char small[256], *text = small;
    va_list args;
    if (w->status != TZ_OK)
        return;
    va_start(args, fmt);
    int n = vsnprintf(small, sizeof small, fmt, args);
    va_end(args);
    if (n >= (int)sizeof small) {
        w->status = tz_alloc(w->out.ctx, &text, (size_t)n + 1, 1);
        if (w->status != TZ_OK)
            return;
        va_start(args, fmt);
        vsnprintf(text, (size_t)n + 1, fmt, args);
        va_end(args);
    }
    tz_svg_set(w, attr, text);
    if (text != small)
        tz_free(w->out.ctx, text);
}

void tz_svg_set_number(tz_svg_writer *w, const char *attr, double value)
{
    tz_svg_set_numbers(w, attr, &value, 1);
}

void tz_svg_set_numbers(tz_svg_writer *w, const char *attr, const double *v, int32_t n)
{
    assert((w->in_tag || w->status != TZ_OK) && "attributes come before children");
    char text[32];
    put(w, " ");
    put(w, attr);
    put(w, "=\"");
    for (int32_t i = 0; i < n; i++) {
        assert(isfinite(v[i]));
        tz_number_format(v[i], text);
        if (i > 0)
            put(w, " ");
        put(w, text);
    }
    put(w, "\"");
}

void tz_svg_set_affine(tz_svg_writer *w, const char *attr, tz_affine m)
{
    const double v[6] = {m.a, m.b, m.c, m.d, m.e, m.f};
    char text[6 * 32 + 16] = "matrix(";
    size_t n = strlen(text);
    for (int i = 0; i < 6; i++) {
        tz_number_format(v[i], text + n);
        n += strlen(text + n);
        text[n++] = i < 5 ? ' ' : ')';
    }
    text[n] = 0;
    tz_svg_set(w, attr, text);
}

void tz_svg_put_text(tz_svg_writer *w, const char *text)
{
    close_tag(w);
    put_escaped(w, text, false);
}

void tz_svg_end(tz_svg_writer *w)
{
    if (w->status != TZ_OK)
        return;
    assert(w->open.n > 0);
    const char *name = w->open.v[--w->open.n];
    if (w->in_tag) {
        put(w, "/>");
    } else {
        put(w, "</");
        put(w, name);
        put(w, ">");
    }
    w->in_tag = false;
}

static tz_status end_all(tz_svg_writer *w)
{
    while (w->open.n > 0 && w->status == TZ_OK)
        tz_svg_end(w);
    put(w, "\n");
    return w->status;
}

tz_status tz_svg_writer_close_text(tz_svg_writer *w, char **text)
{
    tz_status s = end_all(w);
    tz_array_free(w->out.ctx, &w->open);
    if (s == TZ_OK)
        s = tz_file_out_text(&w->out, text);
    tz_svg_writer_abort(w);
    return s;
}

tz_status tz_svg_writer_close(tz_svg_writer *w)
{
    tz_status s = end_all(w);
    tz_array_free(w->out.ctx, &w->open);
    if (s == TZ_OK)
        s = tz_file_out_commit(&w->out);
    tz_svg_writer_abort(w);
    return s;
}

void tz_svg_writer_abort(tz_svg_writer *w)
{
    tz_array_free(w->out.ctx, &w->open);
    tz_file_out_abort(&w->out);
    memset(w, 0, sizeof *w);
}
