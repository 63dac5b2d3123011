/* SPDX-License-Identifier: Apache-2.0 */
/* Draws the figures of docs/ that no command of terrazzo draws: what analysis has found in
 * a photo (SVG), and what a layout lays where (SVG, PNG). tests/figures.sh runs it.
 *
 *   draw_figures edges EXEMPLAR.svg OUT.svg           photo and edges, coloured by bin
 *   draw_figures bins EXEMPLAR.svg OUT.svg            one panel a bin
 *   draw_figures polar EXEMPLAR.svg OUT.svg           a group and its polar grid
 *   draw_figures cut EXEMPLAR.svg LAYOUT.svg OUT.svg  a group's region, and what is cut out
 *   draw_figures pieces LAYOUT.svg OUT.svg            which piece shows where, flat colours
 *   draw_figures borders LAYOUT.svg PIXELS OUT.png    the same as lines over the pixels
 *   draw_figures difference A B OUT.png               grey + 4 (A - B)
 *   draw_figures normals PHOTO OUT.png                normals as if lightness were height
 *   draw_figures numbers MAP OUT.png                  a map of ids, classes, angles or uv
 *
 * OUT.svg must stand in the photo's folder. */
#include <stdio.h>
#include <string.h>

#include "analysis/ebpt.h"
#include "base/image_io.h"
#include "base/svg.h"
#include "synthesis/expand.h"

/* Edges of one angle bin have one hue, longer bins stronger lines. */
static const char *const hue[] = {"#d1495b", "#00798c", "#edae49",
                                  "#5b8e3e", "#7d5ba6", "#30638e"};
enum { HUES = sizeof hue / sizeof *hue };

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* ---- pieces of SVG --------------------------------------------------------------- */

typedef TZ_ARRAY(char)
path_text;

static tz_status put(tz_ctx *ctx, path_text *t, const char *letter, double x, double y)
{
    char s[64];
    const int n = snprintf(s, sizeof s, "%s%.2f %.2f", letter, x, y);
    tz_status st = tz_array_reserve(ctx, t, (int64_t)t->n + n + 1);
    if (st != TZ_OK)
        return st;
    memcpy(t->v + t->n, s, (size_t)n + 1);
    t->n += n;
    return st;
}

/* An edge as path data, along its chain code. */
static tz_status edge_path(tz_ctx *ctx, const tz_ebpt *e, const tz_edge *d, path_text *t)
{
    static const int dx[] = {1, 1, 0, -1, -1, -1, 0, 1};
    static const int dy[] = {0, -1, -1, -1, 0, 1, 1, 1};
    double x = d->x + 0.5, y = d->y + 0.5;
    t->n = 0;
    tz_status s = put(ctx, t, "M", x, y);
    for (int32_t k = 0; k < d->length && s == TZ_OK; k++) {
        const uint8_t c = e->code.v[d->code + k];
        x += dx[c], y += dy[c];
        s = put(ctx, t, "L", x, y);
    }
    return s;
}

static void draw_photo(tz_svg_writer *w, const tz_ebpt *e, const char *photo, double veil)
{
    tz_svg_begin(w, "image");
    tz_svg_set(w, "xlink:href", base_name(photo));
    tz_svg_setf(w, "width", "%d", e->width);
    tz_svg_setf(w, "height", "%d", e->height);
    tz_svg_end(w);
    tz_svg_begin(w, "rect");
    tz_svg_setf(w, "width", "%d", e->width);
    tz_svg_setf(w, "height", "%d", e->height);
    tz_svg_set(w, "fill", "#ffffff");
    tz_svg_set_number(w, "fill-opacity", veil);
    tz_svg_end(w);
}

static tz_status draw_edge(tz_ctx *ctx, tz_svg_writer *w, const tz_ebpt *e,
                           const tz_edge *d, double zoom, path_text *t)
{
    tz_status s = edge_path(ctx, e, d, t);
    if (s != TZ_OK)
        return s;
    tz_svg_begin(w, "path");
    tz_svg_set(w, "d", t->v);
    tz_svg_set(w, "fill", "none");
    tz_svg_set(w, "stroke", hue[d->angle_bin % HUES]);
    tz_svg_set_number(w, "stroke-width", zoom * (1.2 + 0.5 * d->length_bin));
    tz_svg_set(w, "stroke-linejoin", "round");
    tz_svg_end(w);
    return s;
}

static void draw_dot(tz_svg_writer *w, tz_vec2 p, double radius, const char *fill)
{
    tz_svg_begin(w, "circle");
    tz_svg_set_number(w, "cx", p.x);
    tz_svg_set_number(w, "cy", p.y);
    tz_svg_set_number(w, "r", radius);
    tz_svg_set(w, "fill", fill);
    tz_svg_end(w);
}

/* Pixel outline of a group's region, as a set of sides. */
static tz_status region_path(tz_ctx *ctx, const tz_ebpt *e, int32_t id, path_text *t)
{
    const tz_rect b = e->group.v[id].box;
    tz_status s = TZ_OK;
    t->n = 0;
    for (int32_t y = b.y - 1; y < b.y + b.h; y++)
        for (int32_t x = b.x - 1; x < b.x + b.w && s == TZ_OK; x++) {
            const int32_t at[][2] = {{x, y}, {x + 1, y}, {x, y + 1}};
            bool in[3];
            for (int k = 0; k < 3; k++)
                in[k] = at[k][0] >= 0 && at[k][1] >= 0 && at[k][0] < e->width &&
                        at[k][1] < e->height &&
                        e->label[(int64_t)at[k][1] * e->width + at[k][0]] == id;
            if (in[0] != in[1] && (s = put(ctx, t, "M", x + 1, y)) == TZ_OK)
                s = put(ctx, t, "L", x + 1, y + 1);
            if (in[0] != in[2] && s == TZ_OK && (s = put(ctx, t, "M", x, y + 1)) == TZ_OK)
                s = put(ctx, t, "L", x + 1, y + 1);
        }
    return s;
}

static void draw_line(tz_svg_writer *w, const char *d, const char *stroke, double width)
{
    tz_svg_begin(w, "path");
    tz_svg_set(w, "d", d);
    tz_svg_set(w, "fill", "none");
    tz_svg_set(w, "stroke", stroke);
    tz_svg_set_number(w, "stroke-width", width);
    tz_svg_set(w, "stroke-linecap", "round");
    tz_svg_set(w, "stroke-linejoin", "round");
    tz_svg_end(w);
}

static void draw_words(tz_svg_writer *w, double x, double y, double size,
                       const char *text)
{
    tz_svg_begin(w, "text");
    tz_svg_set_number(w, "x", x);
    tz_svg_set_number(w, "y", y);
    tz_svg_set_number(w, "font-size", size);
    tz_svg_set(w, "font-family", "sans-serif");
    tz_svg_put_text(w, text);
    tz_svg_end(w);
}

/* ---- figures of analysis --------------------------------------------------------- */

static tz_status edges(tz_ctx *ctx, const tz_ebpt *e, const char *photo, const char *out)
{
    tz_svg_writer w;
    path_text t = {0};
    tz_status s = tz_svg_writer_open(ctx, out, e->width, e->height, &w);
    if (s != TZ_OK)
        return s;
    draw_photo(&w, e, photo, 0.55);
    for (int32_t i = 0; i < e->edge.n && s == TZ_OK; i++)
        s = draw_edge(ctx, &w, e, &e->edge.v[i], 1, &t);
    tz_array_free(ctx, &t);
    if (s != TZ_OK)
        tz_svg_writer_abort(&w);
    return s == TZ_OK ? tz_svg_writer_close(&w) : s;
}

/* A panel a bin: angle to the right, length downwards. */
static tz_status bins(tz_ctx *ctx, const tz_ebpt *e, const char *photo, const char *out)
{
    (void)photo;
    const double letters = 0.055 * e->width, gap = 0.02 * e->width, line = 1.4 * letters;
    const int32_t columns = e->params.angle_bins, rows = e->params.length_bins;
    const double x1 = e->width + gap, y1 = e->height + gap + line;
    tz_svg_writer w;
    path_text t = {0};
    tz_status s = tz_svg_writer_open(ctx, out, columns * x1 - gap, rows * y1 - gap, &w);
    if (s != TZ_OK)
        return s;
    for (int32_t j = 0; j < rows; j++)
        for (int32_t i = 0; i < columns; i++) {
            int32_t n = 0;
            char text[100];
            tz_svg_begin(&w, "g");
            tz_svg_setf(&w, "transform", "translate(%g %g)", i * x1, j * y1);
            tz_svg_begin(&w, "rect");
            tz_svg_setf(&w, "width", "%d", e->width);
            tz_svg_setf(&w, "height", "%d", e->height);
            tz_svg_set(&w, "fill", "#f4f1ea");
            tz_svg_end(&w);
            for (int32_t k = 0; k < e->edge.n && s == TZ_OK; k++) {
                const tz_edge *d = &e->edge.v[k];
                if (d->length_bin != j || d->angle_bin != i)
                    continue;
                s = draw_edge(ctx, &w, e, d, 2, &t);
                n++;
            }
            snprintf(text, sizeof text, "length %d, angle %d: %d edges", j, i, n);
            draw_words(&w, 0, e->height + letters, letters, text);
            tz_svg_end(&w);
        }
    tz_array_free(ctx, &t);
    if (s != TZ_OK)
        tz_svg_writer_abort(&w);
    return s == TZ_OK ? tz_svg_writer_close(&w) : s;
}

/* The group to show: many edges, not cut by the photo's border. */
static int32_t choose_group(const tz_ebpt *e)
{
    int32_t best = 0;
    for (int32_t i = 0; i < e->group.n; i++) {
        const tz_edge_group *g = &e->group.v[i], *b = &e->group.v[best];
        if (!g->cut && (b->cut || g->edges > b->edges ||
                        (g->edges == b->edges && g->area > b->area)))
            best = i;
    }
    return best;
}

static tz_status draw_group(tz_ctx *ctx, tz_svg_writer *w, const tz_ebpt *e, int32_t id)
{
    const tz_edge_group *g = &e->group.v[id];
    path_text t = {0};
    tz_status s = region_path(ctx, e, id, &t);
    if (s == TZ_OK && t.n)
        draw_line(w, t.v, "#222222", 0.8);
    for (int32_t k = g->edge; k < g->edge + g->edges && s == TZ_OK; k++) {
        const tz_edge *d = &e->edge.v[e->group_edge.v[k]];
        s = draw_edge(ctx, w, e, d, 1, &t);
        draw_dot(w, d->centre, 1.1, "#222222");
    }
    draw_dot(w, g->centre, 1.6, "#ffffff");
    draw_dot(w, g->centre, 1, "#d1495b");
    tz_array_free(ctx, &t);
    return s;
}

/* Cell between two radii and two angles. */
static tz_status cell_path(tz_ctx *ctx, const double r[2], const double a[2],
                           path_text *t)
{
    enum { STEPS = 8 };
    t->n = 0;
    tz_status s = TZ_OK;
    for (int k = 0; k <= 2 * STEPS + 1 && s == TZ_OK; k++) {
        const int side = k > STEPS;
        const double u = (double)(side ? 2 * STEPS + 1 - k : k) / STEPS;
        const double angle = a[0] + u * (a[1] - a[0]);
        s = put(ctx, t, k ? "L" : "M", r[side] * cos(angle), r[side] * sin(angle));
    }
    return s;
}

static tz_status draw_grid(tz_ctx *ctx, tz_svg_writer *w, const tz_ebpt *e, int32_t id)
{
    const tz_edge_group *g = &e->group.v[id];
    const int32_t rings = e->params.polar_rings, sectors = e->params.polar_sectors;
    path_text t = {0};
    tz_status s = TZ_OK;
    double most = 0;
    for (int32_t k = g->cell; k < g->cell + g->cells; k++)
        most = fmax(most, e->cell.v[k].share);
    for (int32_t k = 0; k < rings * sectors && s == TZ_OK; k++) {
        const int32_t ring = k / sectors, sector = k % sectors;
        double share = 0;
        for (int32_t c = g->cell; c < g->cell + g->cells; c++)
            if (e->cell.v[c].ring == ring && e->cell.v[c].sector == sector)
                share = e->cell.v[c].share;
        const double r[] = {g->reach * ring / rings, g->reach * (ring + 1) / rings};
        const double a[] = {2 * TZ_PI * sector / sectors,
                            2 * TZ_PI * (sector + 1) / sectors};
        s = cell_path(ctx, r, a, &t);
        if (s != TZ_OK)
            break;
        tz_svg_begin(w, "path");
        tz_svg_set(w, "d", t.v);
        tz_svg_set(w, "fill", share > 0 ? "#00798c" : "#f4f1ea");
        tz_svg_set_number(w, "fill-opacity", share > 0 ? 0.25 + 0.6 * share / most : 1);
        tz_svg_set(w, "stroke", "#999999");
        tz_svg_set_number(w, "stroke-width", 0.15);
        tz_svg_end(w);
    }
    for (int32_t k = g->edge; k < g->edge + g->edges; k++)
        draw_dot(w, tz_vec2_sub(e->edge.v[e->group_edge.v[k]].centre, g->centre), 0.7,
                 "#222222");
    draw_dot(w, (tz_vec2){0, 0}, 1, "#d1495b");
    tz_array_free(ctx, &t);
    return s;
}

/* A clip path of the page's panel that is moved to (0, 0). */
static void clip_panel(tz_svg_writer *w, const char *id, double side)
{
    tz_svg_begin(w, "clipPath");
    tz_svg_set(w, "id", id);
    tz_svg_begin(w, "rect");
    tz_svg_set_number(w, "width", side);
    tz_svg_set_number(w, "height", side);
    tz_svg_end(w);
    tz_svg_end(w);
}

static tz_status polar(tz_ctx *ctx, const tz_ebpt *e, const char *photo, const char *out)
{
    const double side = 480, gap = 12;
    const int32_t id = choose_group(e);
    const tz_edge_group *g = &e->group.v[id];
    const double zoom = side / (2.3 * fmax(g->reach, 4));
    tz_svg_writer w;
    tz_status s = tz_svg_writer_open(ctx, out, 2 * side + gap, side, &w);
    if (s != TZ_OK)
        return s;
    clip_panel(&w, "panel", side);
    tz_svg_begin(&w, "g");
    tz_svg_set(&w, "clip-path", "url(#panel)");
    tz_svg_begin(&w, "g");
    tz_svg_setf(&w, "transform", "translate(%g %g) scale(%g) translate(%g %g)", side / 2,
                side / 2, zoom, -g->centre.x, -g->centre.y);
    draw_photo(&w, e, photo, 0.35);
    s = draw_group(ctx, &w, e, id);
    tz_svg_end(&w);
    tz_svg_end(&w);
    tz_svg_begin(&w, "g");
    tz_svg_setf(&w, "transform", "translate(%g %g) scale(%g)", 1.5 * side + gap, side / 2,
                zoom);
    if (s == TZ_OK)
        s = draw_grid(ctx, &w, e, id);
    if (s != TZ_OK)
        tz_svg_writer_abort(&w);
    return s == TZ_OK ? tz_svg_writer_close(&w) : s;
}

/* ---- figures of a layout --------------------------------------------------------- */

/* The placement of the largest group that lies well inside the photo. */
static int32_t choose_placement(const tz_ebpt *e, const tz_layout *l)
{
    int32_t best = -1, most = -1;
    for (int32_t k = 0; k < l->place.n; k++) {
        const tz_placement *p = &l->place.v[k];
        if (p->group < 0 || p->group >= e->group.n)
            continue;
        const tz_edge_group *g = &e->group.v[p->group];
        const tz_vec2 c = g->region_centre;
        const double room = fmin(fmin(c.x, c.y), fmin(e->width - c.x, e->height - c.y));
        if (room > 0.25 * e->height && g->area > most)
            most = g->area, best = k;
    }
    return best;
}

static tz_status cut(tz_ctx *ctx, const tz_ebpt *e, const char *photo, const tz_layout *l,
                     const char *out)
{
    const int32_t id = choose_placement(e, l);
    path_text t = {0};
    tz_svg_writer w;
    if (id < 0)
        return tz_fail(ctx, TZ_INVALID, "%s: no placement to show", out);
    const tz_placement *p = &l->place.v[id];
    tz_status s = tz_svg_writer_open(ctx, out, e->width, e->height, &w);
    if (s != TZ_OK)
        return s;
    draw_photo(&w, e, photo, 0);
    for (int32_t k = 0; k < p->points && s == TZ_OK; k++) {
        const tz_point q = l->border.v[p->border + k];
        s = put(ctx, &t, k ? "L" : "M", (double)q.x, (double)q.y);
    }
    if (s == TZ_OK)
        s = put(ctx, &t, "L", (double)l->border.v[p->border].x,
                (double)l->border.v[p->border].y);
    if (s == TZ_OK) {
        draw_line(&w, t.v, "#ffffff", 3.5);
        draw_line(&w, t.v, "#d1495b", 2);
        s = region_path(ctx, e, p->group, &t);
    }
    if (s == TZ_OK) {
        draw_line(&w, t.v, "#ffffff", 2.5);
        draw_line(&w, t.v, "#00798c", 1.5);
        draw_dot(&w, e->group.v[p->group].region_centre, 3, "#ffffff");
        draw_dot(&w, e->group.v[p->group].region_centre, 2, "#d1495b");
    }
    tz_array_free(ctx, &t);
    if (s != TZ_OK)
        tz_svg_writer_abort(&w);
    return s == TZ_OK ? tz_svg_writer_close(&w) : s;
}

static tz_status pieces(tz_ctx *ctx, const tz_layout *l, const char *out)
{
    path_text t = {0};
    tz_svg_writer w;
    tz_status s = tz_svg_writer_open(ctx, out, l->width, l->height, &w);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < l->place.n && s == TZ_OK; i++) {
        const tz_placement *p = &l->place.v[i];
        t.n = 0;
        for (int32_t k = 0; k < p->points && s == TZ_OK; k++) {
            const tz_point q = l->border.v[p->border + k];
            const tz_vec2 v =
                tz_affine_apply(p->map, (tz_vec2){(double)q.x, (double)q.y});
            s = put(ctx, &t, k ? "L" : "M", v.x, v.y);
        }
        if (s != TZ_OK)
            break;
        /* a hue a group: the golden angle keeps neighbouring numbers apart */
        const int angle = (int)(p->group * 137.508) % 360;
        tz_svg_begin(&w, "path");
        tz_svg_set(&w, "d", t.v);
        const double a = angle * TZ_PI / 180;
        tz_svg_setf(&w, "fill", "#%02x%02x%02x", (int)(186 + 44 * cos(a)),
                    (int)(186 + 44 * cos(a - 2.1)), (int)(186 + 44 * cos(a + 2.1)));
        tz_svg_set(&w, "stroke", "#333333");
        tz_svg_set_number(&w, "stroke-width", 1);
        tz_svg_end(&w);
    }
    tz_array_free(ctx, &t);
    if (s != TZ_OK)
        tz_svg_writer_abort(&w);
    return s == TZ_OK ? tz_svg_writer_close(&w) : s;
}

static tz_status read_colour(tz_ctx *ctx, const char *path, tz_image *im)
{
    const tz_image_read_options opt = {.want = TZ_ENCODING_SRGB};
    return tz_image_read(ctx, path, &opt, im);
}

static tz_status write_rgb(tz_ctx *ctx, const char *path, const tz_image *im)
{
    const tz_image_write_options opt = {.compression = 6};
    return tz_image_write(ctx, path, im, &opt);
}

/* Copy with three channels. */
static tz_status rgb_like(tz_ctx *ctx, const tz_image *from, tz_image *out)
{
    tz_status s = tz_image_init(ctx, out, from->width, from->height, 3);
    if (s != TZ_OK)
        return s;
    out->encoding = TZ_ENCODING_SRGB;
    const int32_t colours = from->channels - (from->alpha >= 0);
    for (int32_t y = 0; y < from->height; y++)
        for (int32_t x = 0; x < from->width; x++)
            for (int32_t k = 0; k < 3; k++)
                tz_image_at(out, x, y)[k] = tz_image_at(from, x, y)[colours < 3 ? 0 : k];
    return s;
}

/* Lines where neighbouring pixels come from different placements. */
static tz_status borders(tz_ctx *ctx, const tz_layout *l, const char *pixels,
                         const char *out)
{
    tz_image im = {0}, rgb = {0};
    tz_composer *c = NULL;
    int32_t *label = NULL;
    const tz_rect all = {0, 0, l->width, l->height};
    tz_compose_params p;
    tz_image photo = {0};
    tz_params_default(&tz_compose_param_table, &p);
    tz_status s = read_colour(ctx, pixels, &im);
    if (s == TZ_OK && (im.width != l->width || im.height != l->height))
        s = tz_fail(ctx, TZ_INVALID, "%s: not of the layout's size", pixels);
    if (s == TZ_OK)
        s = rgb_like(ctx, &im, &rgb);
    if (s == TZ_OK)
        s = read_colour(ctx, l->source.v[0].path, &photo);
    if (s == TZ_OK)
        s = tz_composer_new(ctx, l, &photo, 1, TZ_MAP_COLOUR, &p, &c);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &label, (size_t)l->width * (size_t)l->height, sizeof *label);
    if (s == TZ_OK)
        s = tz_composer_labels(ctx, c, all, label);
    if (s != TZ_OK)
        goto done;
    for (int32_t y = 0; y + 1 < l->height; y++)
        for (int32_t x = 0; x + 1 < l->width; x++) {
            const int32_t *at = label + (int64_t)y * l->width + x;
            if (at[0] == at[1] && at[0] == at[l->width])
                continue;
            float *q = tz_image_at(&rgb, x, y);
            q[0] = 1, q[1] = 0.75F, q[2] = 0.1F;
        }
    s = write_rgb(ctx, out, &rgb);
done:
    tz_free(ctx, label);
    tz_composer_free(c);
    tz_image_deinit(&photo);
    tz_image_deinit(&rgb);
    tz_image_deinit(&im);
    return s;
}

/* ---- pictures -------------------------------------------------------------------- */

static tz_status difference(tz_ctx *ctx, const char *a, const char *b, const char *out)
{
    tz_image one = {0}, two = {0}, rgb = {0}, other = {0};
    tz_status s = read_colour(ctx, a, &one);
    if (s == TZ_OK)
        s = read_colour(ctx, b, &two);
    if (s == TZ_OK && (one.width != two.width || one.height != two.height))
        s = tz_fail(ctx, TZ_INVALID, "%s, %s: sizes differ", a, b);
    if (s == TZ_OK)
        s = rgb_like(ctx, &one, &rgb);
    if (s == TZ_OK)
        s = rgb_like(ctx, &two, &other);
    for (int32_t y = 0; s == TZ_OK && y < rgb.height; y++)
        for (int32_t x = 0; x < rgb.width; x++) {
            float *p = tz_image_at(&rgb, x, y), *q = tz_image_at(&other, x, y);
            for (int32_t k = 0; k < 3; k++)
                p[k] = fminf(1, fmaxf(0, 0.5F + 4 * (p[k] - q[k])));
        }
    if (s == TZ_OK)
        s = write_rgb(ctx, out, &rgb);
    tz_image_deinit(&one);
    tz_image_deinit(&two);
    tz_image_deinit(&rgb);
    tz_image_deinit(&other);
    return s;
}

/* A normal map to try --maps with; y points up, as in OpenGL. */
static tz_status normals(tz_ctx *ctx, const char *photo, const char *out)
{
    tz_image im = {0}, rgb = {0};
    tz_status s = read_colour(ctx, photo, &im);
    if (s == TZ_OK)
        s = tz_image_init(ctx, &rgb, im.width, im.height, 3);
    rgb.encoding = TZ_ENCODING_DATA;
    for (int32_t y = 0; s == TZ_OK && y < im.height; y++)
        for (int32_t x = 0; x < im.width; x++) {
            const int32_t x0 = x ? x - 1 : 0, x1 = x + 1 < im.width ? x + 1 : x;
            const int32_t y0 = y ? y - 1 : 0, y1 = y + 1 < im.height ? y + 1 : y;
            const int32_t green = im.channels >= 3 ? 1 : 0;
            const float dx =
                tz_image_at(&im, x1, y)[green] - tz_image_at(&im, x0, y)[green];
            const float dy =
                tz_image_at(&im, x, y1)[green] - tz_image_at(&im, x, y0)[green];
            const float n[] = {-2 * dx, 2 * dy, 1};
            const float length = sqrtf(n[0] * n[0] + n[1] * n[1] + 1);
            for (int32_t k = 0; k < 3; k++)
                tz_image_at(&rgb, x, y)[k] = 0.5F + 0.5F * n[k] / length;
        }
    if (s == TZ_OK)
        s = write_rgb(ctx, out, &rgb);
    tz_image_deinit(&im);
    tz_image_deinit(&rgb);
    return s;
}

/* ---- main ------------------------------------------------------------------------ */

static tz_status of_exemplar(tz_ctx *ctx, char **arg, int n)
{
    tz_ebpt e = {0};
    tz_layout l = {0};
    char *photo = NULL, sha256[65];
    tz_status s = tz_ebpt_read(ctx, arg[1], &e, &photo, sha256);
    if (s == TZ_OK && n == 4)
        s = tz_layout_read(ctx, arg[2], &l);
    if (s == TZ_OK && n == 4)
        s = cut(ctx, &e, photo, &l, arg[3]);
    else if (s == TZ_OK)
        s = (strcmp(arg[0], "edges") == 0  ? edges
             : strcmp(arg[0], "bins") == 0 ? bins
                                           : polar)(ctx, &e, photo, arg[2]);
    tz_free(ctx, photo);
    tz_layout_deinit(&l);
    tz_ebpt_deinit(&e);
    return s;
}

static tz_status of_layout(tz_ctx *ctx, char **arg, int n)
{
    tz_layout l = {0};
    tz_status s = tz_layout_read(ctx, arg[1], &l);
    if (s == TZ_OK)
        s = n == 3 ? pieces(ctx, &l, arg[2]) : borders(ctx, &l, arg[2], arg[3]);
    tz_layout_deinit(&l);
    return s;
}

/* Hue of a share of the circle, as bright as v. */
static void set_hue(float *p, float turn, float v)
{
    for (int k = 0; k < 3; k++) {
        const float t = turn + (float)k / 3;
        p[k] = v * (0.55F + 0.45F * cosf(2 * (float)TZ_PI * t));
    }
}

/* Whole numbers get colours far from their neighbours', shares of a turn their hue; maps
 * of three channels stay. */
static tz_status numbers(tz_ctx *ctx, const char *map, const char *out)
{
    const tz_image_read_options opt = {.data = true};
    tz_image im = {0}, rgb = {0};
    bool whole = true;
    tz_status s = tz_image_read(ctx, map, &opt, &im);
    if (s == TZ_OK)
        s = tz_image_init(ctx, &rgb, im.width, im.height, 3);
    rgb.encoding = TZ_ENCODING_SRGB;
    for (int64_t i = 0; s == TZ_OK && i < (int64_t)im.height * im.width; i++) {
        const float v =
            tz_image_at(&im, (int32_t)(i % im.width), (int32_t)(i / im.width))[0];
        whole = whole && v == floorf(v);
    }
    for (int32_t y = 0; s == TZ_OK && y < rgb.height; y++)
        for (int32_t x = 0; x < rgb.width; x++) {
            float *p = tz_image_at(&rgb, x, y);
            const float *q = tz_image_at(&im, x, y);
            if (im.channels >= 3)
                memcpy(p, q, 3 * sizeof *p);
            else if (q[0] == 0)
                p[0] = p[1] = p[2] = 0.1F;
            else
                set_hue(p, whole ? 0.61803F * q[0] : q[0],
                        whole ? 0.7F + 0.3F * cosf(2.4F * q[0]) : 1);
        }
    if (s == TZ_OK)
        s = write_rgb(ctx, out, &rgb);
    tz_image_deinit(&im);
    tz_image_deinit(&rgb);
    return s;
}

static bool is(char **arg, int n, const char *name, int wanted)
{
    return n == wanted && strcmp(arg[0], name) == 0;
}

int main(int argc, char **argv)
{
    tz_ctx *ctx = NULL;
    char **arg = argv + 1;
    const int n = argc - 1;
    tz_status s = tz_ctx_new(NULL, &ctx);
    if (s != TZ_OK)
        return 1;
    if (is(arg, n, "edges", 3) || is(arg, n, "bins", 3) || is(arg, n, "polar", 3) ||
        is(arg, n, "cut", 4)) {
        s = of_exemplar(ctx, arg, n);
    } else if (is(arg, n, "pieces", 3) || is(arg, n, "borders", 4)) {
        s = of_layout(ctx, arg, n);
    } else if (is(arg, n, "difference", 4)) {
        s = difference(ctx, arg[1], arg[2], arg[3]);
    } else if (is(arg, n, "normals", 3)) {
        s = normals(ctx, arg[1], arg[2]);
    } else if (is(arg, n, "numbers", 3)) {
        s = numbers(ctx, arg[1], arg[2]);
    } else {
        fprintf(stderr,
                "use: draw_figures FIGURE ARGUMENTS (see tests/draw_figures.c)\n");
        tz_ctx_free(ctx);
        return 2;
    }
    if (s != TZ_OK)
        fprintf(stderr, "draw_figures: %s\n", tz_ctx_message(ctx));
    tz_ctx_free(ctx);
    return s == TZ_OK ? 0 : 1;
}
