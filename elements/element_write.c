/* SPDX-License-Identifier: Apache-2.0 */
/* Sets of elements as SVG, JSON and CSV.
 *
 * SVG: symbols and one <use> an element. What SVG shows is its transform; what reading
 * needs to the bit stands beside it, in few attributes, since readers count them:
 *   tz:place    "kind depth source flags x y z angle scale radius [index]",
 *               flags 1 = cut, 2 = fixed, 4 = doubtful; index where drawing order is another order
 *   tz:samples  "x y z id weight ..." but for one sample of weight 1 in the middle
 * On a torus, copies marked tz:copy show what reaches over the border. The <use> of a bent
 * element is marked tz:bent and does not show; beside it, a tz:copy, its shape does.
 *
 * Photos: element_write_photo.c. */
#include "elements/element_io.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "elements/bend.h"
#include "elements/element_write_internal.h"

/* ---- SVG --------------------------------------------------------------------------- */

static void put_raw(tz_svg_writer *w, const char *markup)
{
    tz_svg_put_text(w, ""); /* closes the tag */
    if (w->status == TZ_OK)
        fputs(markup, w->out.f);
}

static void put_kinds(tz_svg_writer *w, const tz_element_set *s)
{
    tz_svg_begin(w, "g");
    tz_svg_set(w, "id", "tz-kinds");
    for (int32_t i = 0; i < s->kind.n; i++) {
        tz_svg_begin(w, "g");
        tz_svg_set(w, "tz:class", s->kind.v[i].name);
        if (s->kind.v[i].oriented)
            tz_svg_set(w, "tz:oriented", "1");
        if (s->kind.v[i].is_void)
            tz_svg_set(w, "tz:void", "1");
        tz_svg_end(w);
    }
    tz_svg_end(w);
}

static void put_symbols(tz_svg_writer *w, const tz_element_set *s)
{
    for (int32_t i = 0; i < s->symbol.n; i++) {
        const tz_element_symbol *y = &s->symbol.v[i];
        tz_svg_begin(w, "symbol");
        tz_svg_set(w, "id", y->id);
        tz_svg_set(w, "overflow", "visible");
        tz_svg_set_number(w, "tz:radius", y->radius);
        if (y->photo_scale > 0) {
            tz_element_put_cut(w, y);
        } else if (*y->markup) {
            put_raw(w, y->markup);
        } else {
            tz_svg_begin(w, "circle");
            tz_svg_set_number(w, "r", y->radius);
            tz_svg_set(w, "fill", "#808080");
            tz_svg_set(w, "tz:disc", "1");
            tz_svg_end(w);
        }
        tz_svg_end(w);
    }
}

static void put_background(tz_svg_writer *w, const tz_element_set *s)
{
    tz_svg_begin(w, "symbol");
    tz_svg_set(w, "id", "tz-background");
    tz_svg_set(w, "overflow", "visible");
    put_raw(w, s->background);
    tz_svg_end(w);
}

static bool plain_sample(const tz_element *e, const tz_sample *p)
{
    return e->samples == 1 && p->id == 0 && p->weight == 1 && p->at.x == e->at.x &&
           p->at.y == e->at.y && p->at.z == e->at.z;
}

static tz_status put_samples(tz_svg_writer *w, const tz_element_set *s,
                             const tz_element *e)
{
    double few[5 * 16], *v = few;
    if (plain_sample(e, &s->sample.v[e->sample]))
        return TZ_OK;
    if (e->samples > 16) {
        tz_status st = tz_alloc(s->ctx, &v, (size_t)e->samples, 5 * sizeof *v);
        if (st != TZ_OK)
            return st;
    }
    for (int32_t i = 0; i < e->samples; i++) {
        const tz_sample *p = &s->sample.v[e->sample + i];
        const double row[5] = {p->at.x, p->at.y, p->at.z, p->id, p->weight};
        memcpy(v + (size_t)i * 5, row, sizeof row);
    }
    tz_svg_set_numbers(w, "tz:samples", v, e->samples * 5);
    if (v != few)
        tz_free(s->ctx, v);
    return TZ_OK;
}

static void put_use(tz_svg_writer *w, const tz_element_set *s, const tz_element *e,
                    double dx, double dy)
{
    const double c = cos(e->angle) * e->scale, d = sin(e->angle) * e->scale;
    tz_svg_begin(w, "use");
    tz_svg_setf(w, "xlink:href", "#%s", s->symbol.v[e->symbol].id);
    tz_svg_set_affine(w, "transform",
                      (tz_affine){c, d, 0 - d, c, e->at.x + dx, e->at.y + dy});
}

/** What reaches over the border of a torus, shown on the other side too. */
static void put_copies(tz_svg_writer *w, const tz_element_set *s, const tz_element *e)
{
    const tz_vec3 size = s->domain.size;
    for (int j = -1; j <= 1; j++)
        for (int i = -1; i <= 1; i++) {
            const double x = e->at.x + i * size.x, y = e->at.y + j * size.y;
            if ((i == 0 && j == 0) || x + e->radius < 0 || y + e->radius < 0 ||
                x - e->radius > size.x || y - e->radius > size.y)
                continue;
            put_use(w, s, e, i * size.x, j * size.y);
            tz_svg_set(w, "tz:copy", "1");
            tz_svg_end(w);
        }
}

/** The bent shape beside a <use> that does not show: readers leave it out. */
static void put_bent(tz_svg_writer *w, const tz_element_set *s, const tz_element *e,
                     const char *markup)
{
    const tz_vec3 size = s->domain.size;
    const int reach = s->domain.torus;
    for (int j = -reach; j <= reach; j++)
        for (int i = -reach; i <= reach; i++) {
            const double x = e->at.x + i * size.x, y = e->at.y + j * size.y;
            const double r = 2 * e->radius; /* bending moves things about */
            if ((i != 0 || j != 0) &&
                (x + r < 0 || y + r < 0 || x - r > size.x || y - r > size.y))
                continue;
            tz_svg_begin(w, "g");
            tz_svg_set(w, "tz:copy", "1");
            tz_svg_set_affine(w, "transform", (tz_affine){1, 0, 0, 1, x, y});
            put_raw(w, markup);
            tz_svg_end(w);
        }
}

/** Markup of an element that is bent so far that one sees it, about its own place; NULL
 * if it can be drawn as its symbol is. */
static tz_status bend_element(tz_bend_rests *rests, const tz_element_set *s, int32_t i,
                              char **markup)
{
    const tz_element *e = &s->element.v[i];
    tz_bend b;
    *markup = NULL;
    const tz_element_symbol *y = &s->symbol.v[e->symbol];
    if (e->samples < 3 || e->cut || s->kind.v[e->kind].is_void || !*y->markup ||
        y->photo_scale > 0)
        return TZ_OK;
    tz_status st = tz_bend_rests_warp(rests, i, &b);
    if (st == TZ_OK && b.strain > 0.05 * b.radius * b.scale)
        st = tz_bend_markup(&b, y->markup, (tz_vec2){e->at.x, e->at.y}, markup);
    tz_bend_deinit(&b);
    return st == TZ_UNSUPPORTED || st == TZ_FORMAT ? TZ_OK : st;
}

static tz_status put_element(tz_svg_writer *w, const tz_element_set *s, int32_t i,
                             bool ordered, tz_bend_rests *rests)
{
    char *bent;
    const tz_element *e = &s->element.v[i];
    const bool is_void = s->kind.v[e->kind].is_void;
    const double place[11] = {
        e->kind,  e->depth,  e->source, e->cut + 2 * e->fixed + 4 * e->doubtful,
        e->at.x,  e->at.y,   e->at.z,   e->angle,
        e->scale, e->radius, i};
    tz_status st = bend_element(rests, s, i, &bent);
    if (st != TZ_OK)
        return st;
    put_use(w, s, e, 0, 0);
    if (is_void || bent)
        tz_svg_set(w, "display", "none");
    if (bent)
        tz_svg_set(w, "tz:bent", "1");
    tz_svg_set_numbers(w, "tz:place", place, ordered ? 10 : 11);
    st = put_samples(w, s, e);
    tz_svg_end(w);
    if (st == TZ_OK && bent)
        put_bent(w, s, e, bent);
    else if (st == TZ_OK && s->domain.torus && !is_void)
        put_copies(w, s, e);
    tz_free(s->ctx, bent);
    return st;
}

static int by_depth(const void *a, const void *b, void *elements)
{
    const tz_element *e = elements;
    const int32_t i = *(const int32_t *)a, j = *(const int32_t *)b;
    if (e[i].depth != e[j].depth)
        return e[i].depth < e[j].depth ? -1 : 1;
    return (i > j) - (i < j);
}

static tz_status put_elements(tz_svg_writer *w, const tz_element_set *s)
{
    const int32_t n = s->element.n;
    int32_t *order = NULL;
    bool ordered = true;
    tz_bend_rests rests = {0};
    tz_status st = tz_alloc(s->ctx, &order, (size_t)n, sizeof *order);
    if (st == TZ_OK)
        st = tz_bend_rests_init(s->ctx, s, &rests);
    if (st != TZ_OK) {
        tz_free(s->ctx, order);
        return st;
    }
    for (int32_t i = 0; i < n; i++) {
        order[i] = i;
        ordered =
            ordered && (i == 0 || s->element.v[i - 1].depth <= s->element.v[i].depth);
    }
    if (!ordered)
        qsort_r(order, (size_t)n, sizeof *order, by_depth, s->element.v);
    for (int32_t i = 0; i < n && st == TZ_OK; i++)
        st = put_element(w, s, order[i], ordered, &rests);
    tz_bend_rests_deinit(&rests);
    tz_free(s->ctx, order);
    return st;
}

static int by_id(const void *a, const void *b)
{
    return strcmp((*(const tz_element_symbol *const *)a)->id,
                  (*(const tz_element_symbol *const *)b)->id);
}

/** Two symbols of one id would be read as one. */
static tz_status check_ids(tz_ctx *ctx, const char *path, const tz_element_set *s)
{
    const tz_element_symbol **y = NULL;
    const int32_t n = s->symbol.n;
    tz_status st = tz_alloc(ctx, &y, (size_t)n, sizeof *y);
    if (st != TZ_OK)
        return st;
    for (int32_t i = 0; i < n; i++)
        y[i] = &s->symbol.v[i];
    if (n > 0)
        qsort(y, (size_t)n, sizeof *y, by_id);
    for (int32_t i = 0; i < n && st == TZ_OK; i++)
        if (!*y[i]->id || (i > 0 && strcmp(y[i]->id, y[i - 1]->id) == 0))
            st = tz_fail(ctx, TZ_INVALID,
                         "%s: two symbols are named \"%s\"; give each its own id", path,
                         y[i]->id);
    tz_free(ctx, y);
    return st;
}

tz_status tz_element_put_ground(tz_ctx *ctx, const char *path, tz_svg_writer *w,
                                const tz_element_set *s)
{
    tz_svg_begin(w, "defs");
    put_kinds(w, s);
    const tz_status st = tz_element_put_photos(ctx, path, w, s);
    if (s->background)
        put_background(w, s);
    put_symbols(w, s);
    tz_svg_end(w);
    tz_element_put_plate(w, s);
    if (s->background) {
        tz_svg_begin(w, "use");
        tz_svg_set(w, "xlink:href", "#tz-background");
        tz_svg_set(w, "tz:copy", "1");
        tz_svg_end(w);
    }
    return st;
}

tz_status tz_element_put_elements(tz_svg_writer *w, const tz_element_set *s)
{
    return put_elements(w, s);
}

tz_status tz_element_put_set(tz_ctx *ctx, const char *path, tz_svg_writer *w,
                             const tz_element_set *s)
{
    const tz_status st = tz_element_put_ground(ctx, path, w, s);
    return st == TZ_OK ? put_elements(w, s) : st;
}

tz_status tz_element_put_check(tz_ctx *ctx, const char *path, const tz_element_set *s)
{
    const tz_status st = tz_element_set_check(ctx, s, path);
    return st == TZ_OK ? check_ids(ctx, path, s) : st;
}

tz_status tz_element_write_svg(tz_ctx *ctx, const char *path, const tz_element_set *s)
{
    const double size[3] = {s->domain.size.x, s->domain.size.y, s->domain.size.z};
    tz_svg_writer w;
    tz_status st = tz_element_put_check(ctx, path, s);
    if (st == TZ_OK)
        st = tz_svg_writer_open(ctx, path, size[0], size[1], &w);
    if (st != TZ_OK)
        return st;
    tz_svg_set(&w, "tz:document", "elements");
    tz_svg_set_numbers(&w, "tz:size", size, 3);
    tz_svg_set(&w, "tz:torus", s->domain.torus ? "1" : "0");
    if (s->recipe) {
        tz_svg_begin(&w, "metadata");
        tz_svg_set(&w, "id", "tz-recipe");
        tz_svg_put_text(&w, s->recipe);
        tz_svg_end(&w);
    }
    st = tz_element_put_set(ctx, path, &w, s);
    if (st != TZ_OK) {
        tz_svg_writer_abort(&w);
        return st;
    }
    return tz_svg_writer_close(&w);
}

/* ---- tables ------------------------------------------------------------------------ */

static void put_number(FILE *f, double v)
{
    char text[32];
    tz_number_format(v, text);
    fputs(text, f);
}

static void put_json_text(FILE *f, const char *text)
{
    fputc('"', f);
    for (const unsigned char *p = (const unsigned char *)text; *p; p++)
        if (*p == '"' || *p == '\\')
            fprintf(f, "\\%c", *p);
        else if (*p < 0x20)
            fprintf(f, "\\u%04x", *p);
        else
            fputc(*p, f);
    fputc('"', f);
}

static void put_csv_text(FILE *f, const char *text)
{
    if (!strpbrk(text, ",\"\r\n")) {
        fputs(text, f);
        return;
    }
    fputc('"', f);
    for (const char *p = text; *p; p++) {
        if (*p == '"')
            fputc('"', f);
        fputc(*p, f);
    }
    fputc('"', f);
}

static void put_json_element(FILE *f, const tz_element_set *s, const tz_element *e)
{
    const double v[6] = {e->at.x, e->at.y, e->at.z, e->angle, e->scale, e->radius};
    static const char *const name[6] = {
        "{\"x\":", ",\"y\":", ",\"z\":", ",\"angle\":", ",\"scale\":", ",\"radius\":"};
    for (int k = 0; k < 6; k++) {
        if (k == 3) {
            fputs(",\"type\":", f);
            put_json_text(f, s->kind.v[e->kind].name);
        }
        fputs(name[k], f);
        put_number(f, v[k]);
    }
    fprintf(f, ",\"source\":%d}", e->source);
}

static void put_csv_element(FILE *f, const tz_element_set *s, const tz_element *e)
{
    const double v[6] = {e->at.x, e->at.y, e->at.z, e->angle, e->scale, e->radius};
    for (int k = 0; k < 6; k++) {
        if (k == 3) {
            put_csv_text(f, s->kind.v[e->kind].name);
            fputc(',', f);
        }
        put_number(f, v[k]);
        fputc(',', f);
    }
    fprintf(f, "%d\n", e->source);
}

static tz_status write_table(tz_ctx *ctx, const char *path, const tz_element_set *s,
                             bool json)
{
    tz_file_out out;
    bool first = true;
    tz_status st = tz_element_set_check(ctx, s, path);
    if (st == TZ_OK)
        st = tz_file_out_open(ctx, path, &out);
    if (st != TZ_OK)
        return st;
    if (json) {
        fputs("{\"domain\":[0,0,", out.f);
        put_number(out.f, s->domain.size.x);
        fputc(',', out.f);
        put_number(out.f, s->domain.size.y);
        fputs("],\"elements\":[", out.f);
    } else {
        fputs("x,y,z,type,angle,scale,radius,source\n", out.f);
    }
    for (int32_t i = 0; i < s->element.n; i++) {
        const tz_element *e = &s->element.v[i];
        if (s->kind.v[e->kind].is_void)
            continue;
        if (json) {
            fputs(first ? "\n" : ",\n", out.f);
            put_json_element(out.f, s, e);
        } else {
            put_csv_element(out.f, s, e);
        }
        first = false;
    }
    if (json)
        fputs("\n]}\n", out.f);
    return tz_file_out_commit(&out); /* sees what failed on the way */
}

tz_status tz_element_write_json(tz_ctx *ctx, const char *path, const tz_element_set *s)
{
    return write_table(ctx, path, s, true);
}

tz_status tz_element_write_csv(tz_ctx *ctx, const char *path, const tz_element_set *s)
{
    return write_table(ctx, path, s, false);
}

typedef tz_status (*writer)(tz_ctx *ctx, const char *path, const tz_element_set *s);

/** What writes a file of that name, or NULL. */
static writer writer_of(const char *path)
{
    static const struct {
        const char *suffix;
        writer write;
    } list[] = {{".svg", tz_element_write_svg},
                {".json", tz_element_write_json},
                {".csv", tz_element_write_csv}};
    const char *dot = strrchr(path, '.');
    if (strcmp(path, "-") == 0)
        return tz_element_write_svg;
    for (size_t i = 0; dot && i < sizeof list / sizeof *list; i++)
        if (strcasecmp(dot, list[i].suffix) == 0)
            return list[i].write;
    return NULL;
}

tz_status tz_element_write_check(tz_ctx *ctx, const char *path)
{
    return writer_of(path)
               ? TZ_OK
               : tz_fail(ctx, TZ_INVALID,
                         "%s: elements are written as .svg, .json or .csv", path);
}

tz_status tz_element_write(tz_ctx *ctx, const char *path, const tz_element_set *s)
{
    const tz_status status = tz_element_write_check(ctx, path);
    return status == TZ_OK ? writer_of(path)(ctx, path, s) : status;
}
