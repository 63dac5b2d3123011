/* SPDX-License-Identifier: Apache-2.0 */
/* Strokes that were turned into outlines become strokes again:
 *
 *   fill    the shape is drawn on a raster, six cells across its mean width 2 area /
 *   outline thin    to lines one cell wide
 *   trace   lines become chains of points between ends and junctions
 *   prune   chains shorter than the shape is wide there, which corners leave behind
 *           (curve_prune.c)
 *   centre  each point moves to the middle between the outlines on both sides
 *   mend    lines that bend towards each other where they meet run straight again
 *           (curve_mend.c)
 *   fit     cubics through the points (curve_fit.c), a pen as wide as the shape
 *
 * What is not long and thin (four times as long as wide, all connected chains together)
 * is left. The width of a pen is the mean over chains whose widths differ by less than a
 * quarter.
 * @source Guo, Hall: Parallel thinning with two-subiteration algorithms, CACM 32, 1989 */
#include "curves/curve_centre_internal.h"
#include "curves/curve_fit_internal.h"
#include "curves/curve_read_internal.h"
#include "elements/guide.h"

#include <stdlib.h>
#include <string.h>

#define ACROSS     6
#define MOST_SIDE  6000
#define MOST_CELLS 40000000.0

enum { INK = 1, NODE = 2, SEEN = 4 };

/* ---- fill -------------------------------------------------------------------------- */

typedef struct counter {
    int64_t cells;
    uint8_t *v;
    int32_t w;
} counter;

static void count_span(void *user, int32_t row, int32_t x0, int32_t x1)
{
    counter *c = user;
    c->cells += x1 - x0;
    if (c->v)
        memset(c->v + (size_t)row * (size_t)c->w + x0, INK, (size_t)(x1 - x0));
}

static double outline_length(const tz_polys *p)
{
    double sum = 0;
    for (int32_t k = 0; k < p->part.n; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(p, k, &n);
        for (int32_t i = 0; i < n; i++)
            sum += tz_vec2_length(tz_vec2_sub(v[(i + 1) % n], v[i]));
    }
    return sum;
}

/* The shape on cells that large, 2 of room about it; *area in cells. */
static tz_status draw(centring *c, const tz_part *p, double cell, bool keep,
                      int64_t *area)
{
    const double pad = 2 * cell;
    const double w = ceil((p->box.x1 - p->box.x0) / cell) + 4,
                 h = ceil((p->box.y1 - p->box.y0) / cell) + 4;
    const tz_raster raster = {
        .width = (int32_t)w, .height = (int32_t)h, .size = {w * cell, h * cell, 0}};
    counter k = {.w = raster.width};
    tz_status s = TZ_OK;
    c->origin = (tz_vec2){p->box.x0 - pad, p->box.y0 - pad};
    c->cell = cell;
    c->w = raster.width;
    c->h = raster.height;
    if (keep)
        s = tz_alloc_zero(c->ctx, &c->v, (size_t)c->w * (size_t)c->h, 1);
    k.v = c->v;
    for (int32_t i = 0; i < c->polys.point.n; i++)
        c->polys.point.v[i] = tz_vec2_sub(c->polys.point.v[i], c->origin);
    if (s == TZ_OK)
        s = tz_guide_fill(c->ctx, &raster, &c->polys, p->look.rule == 1, count_span, &k);
    for (int32_t i = 0; i < c->polys.point.n; i++)
        c->polys.point.v[i] = tz_vec2_add(c->polys.point.v[i], c->origin);
    *area = k.cells;
    return s;
}

/* ---- thin -------------------------------------------------------------------------- */

/* The eight neighbours, from north clockwise. */
static void ring(const centring *c, int32_t i, int32_t out[8])
{
    const int32_t w = c->w;
    const int32_t step[8] = {-w, 1 - w, 1, 1 + w, w, w - 1, -1, -1 - w};
    for (int k = 0; k < 8; k++)
        out[k] = i + step[k];
}

static bool removable(const centring *c, int32_t i, int pass)
{
    int32_t at[8];
    bool p[8];
    ring(c, i, at);
    for (int k = 0; k < 8; k++)
        p[k] = c->v[at[k]] != 0;
    int turns = 0, n1 = 0, n2 = 0;
    for (int k = 0; k < 8; k += 2) {
        turns += !p[k] && (p[k + 1] || p[(k + 2) & 7]);
        n1 += p[(k + 7) & 7] || p[k];
        n2 += p[k] || p[k + 1];
    }
    const int n = n1 < n2 ? n1 : n2;
    const bool m =
        pass ? (p[0] || p[1] || !p[3]) && p[2] : (p[4] || p[5] || !p[7]) && p[6];
    return turns == 1 && n >= 2 && n <= 3 && !m;
}

static tz_status thin(centring *c)
{
    const int32_t n = c->w * c->h;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        if (c->v[i])
            s = tz_array_push(c->ctx, &c->ink, i);
    bool *gone = NULL;
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &gone, (size_t)c->ink.n, sizeof *gone);
    int idle = 0;
    for (int32_t turn = 0; s == TZ_OK && idle < 2 && turn < 2 * MOST_SIDE; turn++) {
        int32_t kept = 0;
        for (int32_t k = 0; k < c->ink.n; k++)
            gone[k] = removable(c, c->ink.v[k], turn & 1);
        for (int32_t k = 0; k < c->ink.n; k++) {
            if (gone[k])
                c->v[c->ink.v[k]] = 0;
            else
                c->ink.v[kept++] = c->ink.v[k];
        }
        idle = kept == c->ink.n ? idle + 1 : 0;
        c->ink.n = kept;
        if (tz_ctx_cancelled(c->ctx))
            s = TZ_CANCELLED;
    }
    tz_free(c->ctx, gone);
    return s;
}

/* ---- trace ------------------------------------------------------------------------- */

/* Neighbours on the line: diagonal ones only where there is no way around the corner. */
static int links(const centring *c, int32_t i, int32_t out[8])
{
    int32_t at[8];
    int n = 0;
    ring(c, i, at);
    for (int k = 0; k < 8; k++)
        if (c->v[at[k]] && !((k & 1) && (c->v[at[k - 1]] || c->v[at[(k + 1) & 7]])))
            out[n++] = at[k];
    return n;
}

static tz_vec2 centre_of(const centring *c, int32_t i)
{
    return (tz_vec2){c->origin.x + (i % c->w + 0.5) * c->cell,
                     c->origin.y + (i / c->w + 0.5) * c->cell};
}

/* From a cell through `next` until a node, or back to the start of a loop. */
static tz_status follow(centring *c, int32_t start, int32_t next)
{
    chain e = {.first = c->point.n, .a = start, .b = start};
    int32_t before = start, at = next, to[8];
    tz_status s = tz_array_push(c->ctx, &c->point, centre_of(c, start));
    while (s == TZ_OK) {
        s = tz_array_push(c->ctx, &c->point, centre_of(c, at));
        e.b = at;
        if (s != TZ_OK || (c->v[at] & NODE) || at == start)
            break;
        c->v[at] |= SEEN;
        const int n = links(c, at, to);
        int32_t on = -1;
        for (int k = 0; k < n && on < 0; k++)
            if (to[k] != before && (!(c->v[to[k]] & SEEN) || to[k] == start))
                on = to[k];
        if (on < 0)
            break;
        before = at;
        at = on;
    }
    e.n = c->point.n - e.first;
    return s == TZ_OK ? tz_array_push(c->ctx, &c->chain, e) : s;
}

static tz_status trace(centring *c)
{
    int32_t to[8];
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < c->ink.n; k++)
        if (links(c, c->ink.v[k], to) != 2)
            c->v[c->ink.v[k]] |= NODE;
    for (int32_t k = 0; k < c->ink.n && s == TZ_OK; k++) {
        const int32_t i = c->ink.v[k];
        if (!(c->v[i] & NODE))
            continue;
        const int n = links(c, i, to);
        for (int j = 0; j < n && s == TZ_OK; j++) {
            const uint8_t v = c->v[to[j]];
            if (v & NODE ? i < to[j] : !(v & SEEN))
                s = follow(c, i, to[j]);
        }
    }
    for (int32_t k = 0; k < c->ink.n && s == TZ_OK; k++) {
        const int32_t i = c->ink.v[k];
        if (c->v[i] & (NODE | SEEN))
            continue;
        const int n = links(c, i, to);
        c->v[i] |= SEEN;
        if (n > 0)
            s = follow(c, i, to[0]);
        if (s == TZ_OK)
            c->chain.v[c->chain.n - 1].a = c->chain.v[c->chain.n - 1].b = -1;
    }
    return s;
}

/* ---- centre ------------------------------------------------------------------------ */

static tz_status put_outline(centring *c)
{
    const tz_vec2 size = {c->w * c->cell, c->h * c->cell};
    int32_t id;
    tz_status s = tz_grid_init(c->ctx, &c->outline, c->origin, size, c->width, false);
    for (int32_t k = 0; k < c->polys.part.n && s == TZ_OK; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(&c->polys, k, &n);
        for (int32_t i = 0; i < n && s == TZ_OK; i++) {
            const tz_vec2 p = v[i], d = tz_vec2_sub(v[(i + 1) % n], p);
            const int32_t m = 1 + (int32_t)(tz_vec2_length(d) / c->cell);
            for (int32_t j = 0; j < m && s == TZ_OK; j++) {
                const double t = (double)j / m;
                s = tz_grid_add(c->ctx, &c->outline,
                                (tz_vec2){p.x + t * d.x, p.y + t * d.y}, &id);
            }
        }
    }
    return s;
}

/* Moves p to the middle of the shape; how wide it is there. */
double tz_centring_to_middle(const centring *c, tz_vec2 *p)
{
    enum { MOST = 512 };
    int32_t id[MOST], n = 0;
    for (double r = 0.8 * c->width; n == 0 && r < 100 * c->width; r *= 2)
        n = tz_grid_query(&c->outline, *p, r, id, MOST);
    double near = INFINITY, far = INFINITY;
    tz_vec2 to = {0, 0};
    for (int32_t i = 0; i < (n < MOST ? n : MOST); i++) {
        const tz_vec2 d = tz_vec2_sub(c->outline.point.v[id[i]], *p);
        if (tz_vec2_length(d) < near) {
            near = tz_vec2_length(d);
            to = d;
        }
    }
    if (!(near < INFINITY) || !(near > 0))
        return 0;
    n = tz_grid_query(&c->outline, *p, 2 * near + 2 * c->cell, id, MOST);
    for (int32_t i = 0; i < (n < MOST ? n : MOST); i++) {
        const tz_vec2 d = tz_vec2_sub(c->outline.point.v[id[i]], *p);
        const double l = tz_vec2_length(d);
        if (tz_vec2_dot(d, to) < -0.7 * l * near)
            far = fmin(far, l);
    }
    if (!(far - near < 3 * c->cell))
        return 2 * near;
    *p = tz_vec2_sub(*p, tz_vec2_scale(to, (far - near) / (2 * near)));
    return near + far;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Places, length and median width of each chain. */
static tz_status centre_chains(centring *c)
{
    TZ_ARRAY(double)
    width = {0};
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < c->chain.n && s == TZ_OK; k++) {
        chain *e = &c->chain.v[k];
        tz_vec2 *p = c->point.v + e->first;
        width.n = 0;
        for (int32_t i = 0; i < e->n && s == TZ_OK; i++) {
            const bool end = (i == 0 || i == e->n - 1) && e->a >= 0;
            tz_vec2 q = p[i];
            s = tz_array_push(c->ctx, &width, tz_centring_to_middle(c, &q));
            if (!end) /* those are shared */
                p[i] = q;
        }
        if (e->a < 0)
            p[e->n - 1] = p[0];
        for (int32_t i = 1; i < e->n; i++)
            e->length += tz_vec2_length(tz_vec2_sub(p[i], p[i - 1]));
        if (s == TZ_OK) {
            qsort(width.v, (size_t)width.n, sizeof *width.v, by_value);
            e->width = width.v[width.n / 2];
        }
    }
    tz_array_free(c->ctx, &width);
    return s;
}

/* ---- paths ------------------------------------------------------------------------- */

typedef struct broad {
    double width, length;
    int32_t chain, pad;
} broad;

static int by_width(const void *a, const void *b)
{
    const broad *p = a, *q = b;
    if (p->width != q->width)
        return p->width < q->width ? -1 : 1;
    return (p->chain > q->chain) - (p->chain < q->chain);
}

/* One width for chains of nearly one. */
static tz_status level_widths(centring *c)
{
    broad *b = NULL;
    int32_t n = 0;
    const tz_status s = tz_alloc(c->ctx, &b, (size_t)c->chain.n, sizeof *b);
    if (s != TZ_OK)
        return s;
    for (int32_t k = 0; k < c->chain.n; k++)
        if (!c->chain.v[k].gone)
            b[n++] = (broad){c->chain.v[k].width, c->chain.v[k].length, k, 0};
    if (n > 1)
        qsort(b, (size_t)n, sizeof *b, by_width);
    for (int32_t i = 0, j; i < n; i = j) {
        double sum = 0, length = 0;
        for (j = i; j < n && b[j].width <= 1.25 * b[i].width; j++) {
            sum += b[j].width * b[j].length;
            length += b[j].length;
        }
        for (int32_t k = i; k < j; k++)
            c->chain.v[b[k].chain].width =
                fmax(length > 0 ? sum / length : b[k].width, 1e-3 * c->width);
    }
    tz_free(c->ctx, b);
    return TZ_OK;
}

/* An end short of the border of the view that the shape reaches goes on to it. */
static void reach_border(const centring *c, tz_vec2 *end, tz_vec2 inner, double width)
{
    const tz_vec2 d = tz_vec2_sub(*end, inner), size = c->view;
    const double most = 1.5 * width, l = tz_vec2_length(d);
    double best = INFINITY;
    if (!(l > 0))
        return;
    if (d.x < 0 || d.x > 0)
        best = fmin(best, ((d.x < 0 ? 0 : size.x) - end->x) / (d.x / l));
    if (d.y < 0 || d.y > 0)
        best = fmin(best, ((d.y < 0 ? 0 : size.y) - end->y) / (d.y / l));
    if (best > 0 && best < most)
        *end = tz_vec2_add(*end, tz_vec2_scale(d, best / l));
}

static tz_status add_path(centring *c, const chain *e, const int32_t *degree, int32_t k,
                          uint32_t color, tz_curve_set *to)
{
    tz_vec2 *p = c->point.v + e->first;
    const int32_t back = e->n < 2 * ACROSS ? e->n - 1 : 2 * ACROSS;
    int32_t pen, node[2] = {0, 0};
    if (e->n < 2)
        return TZ_OK;
    if (e->a >= 0 && degree[2 * k] == 1)
        reach_border(c, &p[0], p[back], e->width);
    if (e->a >= 0 && degree[2 * k + 1] == 1)
        reach_border(c, &p[e->n - 1], p[e->n - 1 - back], e->width);
    tz_status s = tz_curve_add_pen(
        to, (tz_curve_pen){.width = e->width, .color = color, .cap = 1, .join = 1}, &pen);
    if (s == TZ_OK)
        s = tz_curve_add_node(to, p[0], &node[0]);
    node[1] = node[0];
    if (s == TZ_OK && e->a >= 0)
        s = tz_curve_add_node(to, p[e->n - 1], &node[1]);
    if (s == TZ_OK)
        s = tz_curve_begin(to, pen);
    if (s == TZ_OK)
        s = tz_curve_fit(to, p, e->n, 0.75 * c->cell, 1.2 * c->width, node);
    if (s == TZ_OK)
        tz_curve_end(to, e->a < 0);
    return s;
}

static tz_status make_chains(centring *c)
{
    ended *e = NULL;
    int32_t *degree = NULL;
    tz_status s = trace(c);
    if (s == TZ_OK)
        s = put_outline(c);
    if (s == TZ_OK)
        s = centre_chains(c);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &e, 2 * (size_t)c->chain.n, sizeof *e);
    if (s == TZ_OK)
        s = tz_alloc_zero(c->ctx, &degree, 2 * (size_t)c->chain.n, sizeof *degree);
    for (int round = 0; round < 2 && s == TZ_OK; round++)
        tz_centring_prune(c, e, degree);
    if (s == TZ_OK)
        s = tz_centring_splice(c, e);
    tz_free(c->ctx, e);
    e = NULL;
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &e, 2 * (size_t)c->chain.n, sizeof *e);
    if (s == TZ_OK)
        s = tz_centring_drop_stout(c, e);
    if (s == TZ_OK)
        s = tz_centring_mend(c, e);
    if (s == TZ_OK)
        s = level_widths(c);
    tz_free(c->ctx, e);
    tz_free(c->ctx, degree);
    return s;
}

static tz_status add_paths(centring *c, uint32_t color, tz_curve_set *to, bool *taken)
{
    ended *e = NULL;
    int32_t *degree = NULL;
    tz_status s = tz_alloc(c->ctx, &e, 2 * (size_t)c->chain.n, sizeof *e);
    if (s == TZ_OK)
        s = tz_alloc_zero(c->ctx, &degree, 2 * (size_t)c->chain.n, sizeof *degree);
    if (s == TZ_OK) {
        const int32_t n = tz_centring_ends(c, e);
        for (int32_t i = 0; i < n; i++) {
            const bool alone = (i == 0 || e[i - 1].cell != e[i].cell) &&
                               (i == n - 1 || e[i + 1].cell != e[i].cell);
            degree[e[i].end] = alone ? 1 : 2;
        }
    }
    for (int32_t k = 0; k < c->chain.n && s == TZ_OK; k++)
        if (!c->chain.v[k].gone) {
            *taken = true;
            s = add_path(c, &c->chain.v[k], degree, k, color, to);
        }
    tz_free(c->ctx, e);
    tz_free(c->ctx, degree);
    return s;
}

/* ---- all --------------------------------------------------------------------------- */

static tz_status find_lines(centring *c, const tz_part *p, double most)
{
    const double side = fmax(p->box.x1 - p->box.x0, p->box.y1 - p->box.y0);
    int64_t area;
    if (!(side > 0) || c->polys.part.n == 0)
        return TZ_OK;
    tz_status s = draw(c, p, side / 1500, false, &area);
    const double length = outline_length(&c->polys);
    if (s != TZ_OK || area == 0 || !(length > 0))
        return s;
    c->width = 2 * (double)area * c->cell * c->cell / length;
    if (c->width > most)
        return TZ_OK;
    const double cells = (p->box.x1 - p->box.x0) * (p->box.y1 - p->box.y0);
    double cell = fmax(c->width / ACROSS, side / MOST_SIDE);
    cell = fmax(cell, sqrt(cells / MOST_CELLS));
    s = draw(c, p, cell, true, &area);
    if (s == TZ_OK)
        s = thin(c);
    return s == TZ_OK ? make_chains(c) : s;
}

tz_status tz_curve_centre_lines(tz_element_reader *r, const tz_part *p, double most,
                                tz_curve_set *to, bool *taken)
{
    centring c = {.ctx = r->ctx, .view = r->view};
    const double tolerance = 1e-4 * fmin(r->view.x, r->view.y);
    *taken = false;
    tz_status s = tz_part_polys(r, p, tz_affine_identity(), tolerance, &c.polys);
    if (s == TZ_OK)
        s = find_lines(&c, p, most);
    if (s == TZ_OK)
        s = add_paths(&c, p->look.fill, to, taken);
    tz_polys_deinit(r->ctx, &c.polys);
    tz_free(r->ctx, c.v);
    tz_array_free(r->ctx, &c.ink);
    tz_array_free(r->ctx, &c.point);
    tz_array_free(r->ctx, &c.chain);
    tz_grid_deinit(r->ctx, &c.outline);
    return s;
}
