/* SPDX-License-Identifier: Apache-2.0 */
/* The exemplar document, written:
 *
 *   <svg tz:document="edge-groups" ...>
 *     <image xlink:href="photo.jpg" tz:sha256="..."/>
 *     <g id="regions" tz:scale tz:meta="cx cy angle reach" + one attribute a parameter>
 *       <path id="region-0" d="M..h..v..z"          outline along pixel corners
 *             tz:group="0" tz:centre="x y" tz:angle tz:size tz:reach tz:region-centre
 *             tz:rank tz:bins="size angle" tz:edges="ids" tz:neighbours="ids"
 *             tz:cells="ring sector share members ..." tz:members="ids, cell by cell"/>
 *     <g id="edges">
 *       <path id="edge-0" d="M.." tz:edge="0" tz:start="x y" tz:code="0071.." tz:group-of
 *             tz:bins tz:extent tz:centre tz:angle tz:width tz:strength
 *             tz:ends="x y angle x y angle"/>
 *
 * What follows from these to the bit (areas, boxes, offsets) is not written. */
#include <stdio.h>
#include <string.h>

#include "analysis/chain.h"
#include "analysis/outline.h"

typedef tz_outline_text text;

static tz_status put(tz_ctx *ctx, text *t, const char *s)
{
    const size_t n = strlen(s);
    tz_status st = tz_array_reserve(ctx, t, (int64_t)t->n + (int64_t)n + 1);
    if (st != TZ_OK)
        return st;
    memcpy(t->v + t->n, s, n + 1);
    t->n += (int32_t)n;
    return TZ_OK;
}

static tz_status put_integer(tz_ctx *ctx, text *t, int64_t v)
{
    char s[24];
    snprintf(s, sizeof s, t->n > 0 ? " %lld" : "%lld", (long long)v);
    return put(ctx, t, s);
}

static tz_status put_double(tz_ctx *ctx, text *t, double v)
{
    char s[33] = " ";
    tz_number_format(v, s + 1);
    return put(ctx, t, t->n > 0 ? s : s + 1);
}

/* Attribute of integers; `t` is scratch. */
static tz_status set_ids(tz_ctx *ctx, tz_svg_writer *w, text *t, const char *name,
                         const int32_t *v, int32_t n)
{
    tz_status s = TZ_OK;
    t->n = 0;
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        s = put_integer(ctx, t, v[i]);
    if (s == TZ_OK)
        tz_svg_set(w, name, n > 0 ? t->v : "");
    return s;
}

/* Hues a golden angle apart, so that neighbouring ids differ. */
static void set_colour(tz_svg_writer *w, const char *name, int32_t id)
{
    const double hue = fmod(id * 0.61803398874989485, 1) * 6, f = hue - floor(hue);
    const int32_t lo = 64, hi = 255, up = lo + (int32_t)(f * (hi - lo));
    const int32_t down = hi + lo - up;
    const int32_t rgb[6][3] = {{hi, up, lo},   {down, hi, lo}, {lo, hi, up},
                               {lo, down, hi}, {up, lo, hi},   {hi, lo, down}};
    const int32_t *c = rgb[(int32_t)hue % 6];
    tz_svg_setf(w, name, "#%02x%02x%02x", (unsigned)c[0], (unsigned)c[1], (unsigned)c[2]);
}

/* Characters that a reference may not hold as they are become %XX. */
static tz_status set_reference(tz_ctx *ctx, tz_svg_writer *w, text *t, const char *path)
{
    t->n = 0;
    tz_status s = put(ctx, t, "");
    for (const char *p = path; *p && s == TZ_OK; p++) {
        char c[4] = {*p, 0, 0, 0};
        if (strchr(" %#?\"<>\\^`{|}", *p) || (unsigned char)*p < 0x20)
            snprintf(c, sizeof c, "%%%02X", (unsigned)(unsigned char)*p);
        s = put(ctx, t, c);
    }
    if (s == TZ_OK)
        tz_svg_set(w, "xlink:href", t->v);
    return s;
}

static tz_status write_head(tz_ctx *ctx, tz_svg_writer *w, text *t, const tz_ebpt *e,
                            const char *photo, const char *sha256)
{
    tz_svg_set(w, "tz:document", "edge-groups");
    tz_svg_begin(w, "image");
    tz_status s = set_reference(ctx, w, t, photo);
    tz_svg_setf(w, "width", "%d", e->width);
    tz_svg_setf(w, "height", "%d", e->height);
    if (sha256 && *sha256)
        tz_svg_set(w, "tz:sha256", sha256);
    tz_svg_end(w);
    return s;
}

static tz_status write_group(tz_ctx *ctx, tz_svg_writer *w, text *t, const tz_ebpt *e,
                             int32_t id, uint8_t *seen)
{
    const tz_edge_group *g = &e->group.v[id];
    const int32_t near = e->neighbour_first.v[id];
    tz_status s;

    tz_svg_begin(w, "path");
    tz_svg_setf(w, "id", "region-%d", id);
    set_colour(w, "fill", id);
    t->n = 0;
    s = tz_outline_trace(ctx, e->label, e->width, e->height, id, g->box, seen, t);
    if (s != TZ_OK)
        return s;
    tz_svg_set(w, "d", t->v);
    tz_svg_setf(w, "tz:group", "%d", id);
    tz_svg_set_numbers(w, "tz:centre", &g->centre.x, 2);
    tz_svg_set_number(w, "tz:angle", g->angle);
    tz_svg_set_number(w, "tz:size", g->size);
    tz_svg_set_number(w, "tz:reach", g->reach);
    tz_svg_set_numbers(w, "tz:region-centre", &g->region_centre.x, 2);
    tz_svg_setf(w, "tz:rank", "%d", g->rank);
    tz_svg_setf(w, "tz:bins", "%d %d", g->length_bin, g->angle_bin);
    s = set_ids(ctx, w, t, "tz:neighbours", e->neighbour.v + near,
                e->neighbour_first.v[id + 1] - near);
    if (s == TZ_OK && g->edges > 0) {
        s = set_ids(ctx, w, t, "tz:edges", e->group_edge.v + g->edge, g->edges);
        t->n = 0;
        for (int32_t i = g->cell; i < g->cell + g->cells && s == TZ_OK; i++) {
            const tz_polar_cell *c = &e->cell.v[i];
            if ((s = put_integer(ctx, t, c->ring)) != TZ_OK ||
                (s = put_integer(ctx, t, c->sector)) != TZ_OK ||
                (s = put_double(ctx, t, c->share)) != TZ_OK ||
                (s = put_integer(ctx, t, c->count)) != TZ_OK)
                break;
        }
        if (s == TZ_OK && g->cells > 0)
            tz_svg_set(w, "tz:cells", t->v);
        if (s == TZ_OK && g->cells > 0)
            s = set_ids(ctx, w, t, "tz:members",
                        e->cell_edge.v + e->cell.v[g->cell].first, g->edges);
    }
    tz_svg_end(w);
    return s;
}

static tz_status write_regions(tz_ctx *ctx, tz_svg_writer *w, text *t, const tz_ebpt *e)
{
    const double meta[4] = {e->meta.centre.x, e->meta.centre.y, e->meta.angle,
                            e->meta.reach};
    uint8_t *seen = NULL;
    tz_status s = tz_alloc_zero(ctx, &seen, (size_t)e->width * e->height, 1);
    if (s != TZ_OK)
        goto done;
    tz_svg_begin(w, "g");
    tz_svg_set(w, "id", "regions");
    tz_svg_set(w, "fill-rule", "evenodd");
    tz_svg_set(w, "fill-opacity", "0.15");
    tz_svg_set(w, "stroke", "#ffffff");
    tz_svg_set(w, "stroke-width", "0.7");
    tz_svg_setf(w, "tz:pixels", "%d %d", e->width, e->height);
    tz_svg_setf(w, "tz:groups", "%d", e->group.n);
    tz_svg_setf(w, "tz:edges", "%d", e->edge.n);
    tz_svg_set_number(w, "tz:scale", e->scale);
    tz_svg_set_numbers(w, "tz:meta", meta, 4);
    for (int32_t i = 0; i < tz_ebpt_param_table.n; i++) {
        const tz_param *p = &tz_ebpt_param_table.row[i];
        char name[64], value[TZ_PARAM_STRING_SIZE + 64];
        snprintf(name, sizeof name, "tz:param-%s", p->name);
        tz_params_get(p, &e->params, value, sizeof value);
        tz_svg_set(w, name, value);
    }
    for (int32_t i = 0; i < e->group.n && s == TZ_OK; i++)
        s = write_group(ctx, w, t, e, i, seen);
    tz_svg_end(w);
done:
    tz_free(ctx, seen);
    return s;
}

/* Straight runs of the chain through pixel centres, relative. */
static tz_status chain_path(tz_ctx *ctx, text *t, const tz_ebpt *e, const tz_edge *d)
{
    char s[64];
    t->n = 0;
    snprintf(s, sizeof s, "M%d.5 %d.5l", d->x, d->y);
    tz_status st = put(ctx, t, s);
    for (int32_t i = 0; i < d->length && st == TZ_OK;) {
        const int32_t k = e->code.v[d->code + i];
        int32_t n = 0;
        while (i < d->length && e->code.v[d->code + i] == k)
            n++, i++;
        snprintf(s, sizeof s, i == n ? "%d %d" : " %d %d", n * tz_chain_dx[k],
                 n * tz_chain_dy[k]);
        st = put(ctx, t, s);
    }
    return st;
}

static tz_status write_edge(tz_ctx *ctx, tz_svg_writer *w, text *t, const tz_ebpt *e,
                            int32_t id)
{
    const tz_edge *d = &e->edge.v[id];
    const double ends[6] = {d->end[0].x, d->end[0].y, d->end_angle[0],
                            d->end[1].x, d->end[1].y, d->end_angle[1]};
    tz_status s = chain_path(ctx, t, e, d);
    if (s != TZ_OK)
        return s;
    tz_svg_begin(w, "path");
    tz_svg_setf(w, "id", "edge-%d", id);
    set_colour(w, "stroke", d->group);
    tz_svg_set(w, "d", t->v);
    tz_svg_setf(w, "tz:edge", "%d", id);
    tz_svg_setf(w, "tz:start", "%d %d", d->x, d->y);
    t->n = 0;
    if ((s = tz_array_reserve(ctx, t, (int64_t)d->length + 1)) != TZ_OK)
        return s;
    for (int32_t i = 0; i < d->length; i++)
        t->v[i] = (char)('0' + e->code.v[d->code + i]);
    t->v[d->length] = 0;
    tz_svg_set(w, "tz:code", t->v);
    tz_svg_setf(w, "tz:group-of", "%d", d->group);
    tz_svg_setf(w, "tz:bins", "%d %d", d->length_bin, d->angle_bin);
    tz_svg_set_number(w, "tz:extent", d->extent);
    tz_svg_set_numbers(w, "tz:centre", &d->centre.x, 2);
    tz_svg_set_number(w, "tz:angle", d->angle);
    tz_svg_set_number(w, "tz:width", d->width);
    tz_svg_set_number(w, "tz:strength", d->strength);
    tz_svg_set_numbers(w, "tz:ends", ends, 6);
    tz_svg_end(w);
    return TZ_OK;
}

tz_status tz_ebpt_write(tz_ctx *ctx, const char *path, const tz_ebpt *e,
                        const char *photo_path, const char *photo_sha256)
{
    tz_svg_writer w;
    text t = {0};
    tz_status s = tz_svg_writer_open(ctx, path, e->width, e->height, &w);
    if (s != TZ_OK)
        return s;
    if ((s = write_head(ctx, &w, &t, e, photo_path, photo_sha256)) != TZ_OK)
        goto done;
    if ((s = write_regions(ctx, &w, &t, e)) != TZ_OK)
        goto done;
    tz_svg_begin(&w, "g");
    tz_svg_set(&w, "id", "edges");
    tz_svg_set(&w, "fill", "none");
    tz_svg_set(&w, "stroke-width", "1");
    for (int32_t i = 0; i < e->edge.n && s == TZ_OK; i++)
        s = write_edge(ctx, &w, &t, e, i);
done:
    tz_array_free(ctx, &t);
    if (s != TZ_OK)
        tz_svg_writer_abort(&w);
    else
        s = tz_svg_writer_close(&w);
    return s;
}
