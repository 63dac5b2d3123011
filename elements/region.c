/* SPDX-License-Identifier: Apache-2.0 */
/* Regions. A mask's border is the polyline through the places where it is 1/2 between
 * neighbouring cells (marching squares):
 *
 *    1 ---- 1          o: crossings on the lines of the grid
 *    |      o\
 *    o------- 0        distance = to the nearest crossing (exact, in two passes), and
 *    0 ---- 0          near the border to the nearest piece of the line between them
 *
 * Crossings on rows have whole y and any x, so the squared distance along the rows and
 * then the lower envelope of its parabolas down the columns is exact; those on columns
 * the other way round.
 * @source Felzenszwalb, Huttenlocher: Distance transforms of sampled functions, 2012 */
#include "elements/region.h"

#include <string.h>

#include "elements/guide.h"

enum { MOST = 8192, FINE = 8 /* samples of a drawn shape across a cell */, REACH = 4 };

void tz_region_free(tz_region *r)
{
    if (!r)
        return;
    tz_ctx *ctx = r->ctx;
    tz_free(ctx, r->distance);
    tz_free(ctx, r);
}

/* ---- distances ------------------------------------------------------------------- */

/* One of both axes is "along" (crossings lie on its lines), the other "across". */
typedef struct axis {
    int32_t n, lines;       /* cells along, lines across */
    int64_t step, next;     /* in the mask, along and across */
    double cell, cell_next; /* user units */
} axis;

typedef struct field {
    const float *mask;
    tz_raster raster;
    tz_vec2 cell;
    float *square;  /* least squared distances so far */
    float *partial; /* along one axis only */
    axis a;
    double far;
} field;

static double at_cell(const field *f, int64_t i)
{
    const double v = (double)f->mask[i];
    return v == v ? v : 0;
}

static bool crosses(double v, double w) { return (v >= 0.5) != (w >= 0.5); }

static double share(double v, double w) { return (0.5 - v) / (w - v); }

/* Squared distances to the crossings on one line: a pass there and one back. */
static tz_status along(tz_ctx *ctx, void *arg, int64_t line, int worker)
{
    (void)ctx, (void)worker;
    field *f = arg;
    const axis *a = &f->a;
    const int64_t base = line * a->next;
    const bool torus = f->raster.torus;
    const int32_t turns = torus ? 2 * a->n : a->n;
    double last = -HUGE_VAL;
    for (int32_t k = 0; k < turns; k++) { /* the nearest to the left */
        const int32_t i = k % a->n, j = i > 0 ? i - 1 : torus ? a->n - 1 : 0;
        const double v = at_cell(f, base + j * a->step),
                     w = at_cell(f, base + i * a->step);
        if (crosses(v, w))
            last = k - 1 + share(v, w);
        if (k >= turns - a->n)
            f->partial[base + i * a->step] =
                (float)fmin(f->far, (k - last) * a->cell * (k - last) * a->cell);
    }
    last = HUGE_VAL;
    for (int32_t k = turns - 1; k >= 0; k--) { /* and to the right */
        const int32_t i = k % a->n, j = i + 1 < a->n ? i + 1 : torus ? 0 : i;
        const double v = at_cell(f, base + i * a->step),
                     w = at_cell(f, base + j * a->step);
        if (crosses(v, w))
            last = k + share(v, w);
        float *p = &f->partial[base + i * a->step];
        if (k < a->n)
            *p = (float)fmin((double)*p, (last - k) * a->cell * (last - k) * a->cell);
    }
    return TZ_OK;
}

/* Envelope of the parabolas at all lines, for one cell of each. */
typedef struct envelope {
    int32_t *v; /* roots, in lines; on a torus of three turns */
    double *z;  /* where each begins to be the least */
} envelope;

static double height(const field *f, int64_t cell, int32_t k)
{
    const int32_t n = f->a.lines;
    return (double)f->partial[cell * f->a.step + (int64_t)((k + n) % n) * f->a.next];
}

static tz_status across(tz_ctx *ctx, void *arg, int64_t cell, int worker)
{
    (void)worker;
    field *f = arg;
    const axis *a = &f->a;
    const int32_t from = f->raster.torus ? -a->lines : 0;
    const int32_t to = f->raster.torus ? 2 * a->lines : a->lines;
    const double c2 = a->cell_next * a->cell_next;
    envelope e = {0};
    int32_t top = -1;
    tz_status s = tz_alloc(ctx, &e.v, (size_t)(to - from), sizeof *e.v);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &e.z, (size_t)(to - from) + 1, sizeof *e.z);
    for (int32_t q = from; s == TZ_OK && q < to; q++) {
        const double h = height(f, cell, q) / c2;
        double z = -HUGE_VAL;
        if (h * c2 >= f->far)
            continue; /* no crossing on this line */
        for (; top >= 0; top--) {
            const double p = e.v[top], g = height(f, cell, e.v[top]) / c2;
            z = (h + (double)q * q - g - p * p) / (2 * (q - p));
            if (z > e.z[top])
                break;
            z = -HUGE_VAL;
        }
        e.v[++top] = q;
        e.z[top] = z;
    }
    for (int32_t q = 0, k = 0; s == TZ_OK && top >= 0 && q < a->lines; q++) {
        while (k < top && e.z[k + 1] < q)
            k++;
        const double d = q - e.v[k];
        float *p = &f->square[cell * a->step + (int64_t)q * a->next];
        *p = (float)fmin((double)*p, height(f, cell, e.v[k]) + d * d * c2);
    }
    tz_free(ctx, e.v);
    tz_free(ctx, e.z);
    return s;
}

/* ---- pieces of the border -------------------------------------------------------- */

static double to_segment(tz_vec2 p, tz_vec2 a, tz_vec2 b)
{
    const tz_vec2 d = tz_vec2_sub(b, a), e = tz_vec2_sub(p, a);
    const double l = tz_vec2_dot(d, d);
    const double t = l > 0 ? fmin(fmax(tz_vec2_dot(e, d) / l, 0), 1) : 0;
    const double x = e.x - t * d.x, y = e.y - t * d.y;
    return x * x + y * y;
}

/* Cells about a piece learn how far it is. */
static void spread(field *f, int32_t i, int32_t j, tz_vec2 p, tz_vec2 q)
{
    const tz_raster *r = &f->raster;
    const tz_vec2 a = {p.x * f->cell.x, p.y * f->cell.y};
    const tz_vec2 b = {q.x * f->cell.x, q.y * f->cell.y};
    for (int32_t y = j - REACH; y <= j + 1 + REACH; y++)
        for (int32_t x = i - REACH; x <= i + 1 + REACH; x++) {
            if (!r->torus && (x < 0 || y < 0 || x >= r->width || y >= r->height))
                continue;
            const tz_vec2 at = {x * f->cell.x, y * f->cell.y};
            float *d =
                &f->square[(int64_t)tz_raster_index(y, r->height, r->torus) * r->width +
                           tz_raster_index(x, r->width, r->torus)];
            *d = (float)fmin((double)*d, to_segment(at, a, b));
        }
}

/* The square between four cells' centres: its crossings in turn, joined two by two so
 * that a mean of 1/2 and more joins the inside across. */
static void piece(field *f, int32_t i, int32_t j)
{
    const tz_raster *r = &f->raster;
    const int32_t x1 = tz_raster_index(i + 1, r->width, true),
                  y1 = tz_raster_index(j + 1, r->height, true);
    const int64_t at[4] = {(int64_t)j * r->width + i, (int64_t)j * r->width + x1,
                           (int64_t)y1 * r->width + x1, (int64_t)y1 * r->width + i};
    static const tz_vec2 corner[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    double v[4], mean = 0;
    tz_vec2 c[4];
    int n = 0;
    for (int k = 0; k < 4; k++)
        mean += (v[k] = at_cell(f, at[k])) / 4;
    for (int k = 0; k < 4; k++) {
        const int m = (k + 1) % 4;
        if (!crosses(v[k], v[m]))
            continue;
        const double t = share(v[k], v[m]);
        c[n++] = (tz_vec2){i + corner[k].x + t * (corner[m].x - corner[k].x),
                           j + corner[k].y + t * (corner[m].y - corner[k].y)};
    }
    /* of four, 0-1 and 2-3 cut off corners 1 and 3, 1-2 and 3-0 corners 2 and 0 */
    const int first = n == 4 && crosses(mean, v[1]) ? 0 : n == 4 ? 1 : 0;
    for (int k = 0; k + 1 < n; k += 2)
        spread(f, i, j, c[(k + first) % n], c[(k + first + 1) % n]);
}

static tz_status measure(tz_ctx *ctx, field *f)
{
    const tz_raster *r = &f->raster;
    const axis x = {r->width, r->height, 1, r->width, f->cell.x, f->cell.y};
    const axis y = {r->height, r->width, r->width, 1, f->cell.y, f->cell.x};
    tz_status s = TZ_OK;
    for (int k = 0; k < 2 && s == TZ_OK; k++) {
        f->a = k ? y : x;
        s = tz_parallel_for(ctx, f->a.lines, along, f);
        if (s == TZ_OK)
            s = tz_parallel_for(ctx, f->a.n, across, f);
    }
    const int32_t w = r->torus ? r->width : r->width - 1;
    const int32_t h = r->torus ? r->height : r->height - 1;
    for (int32_t j = 0; s == TZ_OK && j < h; j++)
        for (int32_t i = 0; i < w; i++)
            piece(f, i, j);
    return s;
}

/* ---- regions --------------------------------------------------------------------- */

/* Squares become signed distances; the rectangle's own border counts inside. */
static void finish(tz_region *r, const field *f)
{
    const tz_raster *g = &r->raster;
    const double far = hypot(g->size.x, g->size.y);
    const double cell = fmin(f->cell.x, f->cell.y);
    double sum = 0;
    for (int32_t j = 0; j < g->height; j++)
        for (int32_t i = 0; i < g->width; i++) {
            float *p = &r->distance[(int64_t)j * g->width + i];
            const bool in = at_cell(f, (int64_t)j * g->width + i) >= 0.5;
            const double x = (i + 0.5) * f->cell.x, y = (j + 0.5) * f->cell.y;
            double d = fmin(sqrt((double)*p), far);
            sum += fmin(fmax((in ? d : -d) / cell + 0.5, 0), 1);
            if (in && !g->torus)
                d = fmin(d, fmin(fmin(x, g->size.x - x), fmin(y, g->size.y - y)));
            *p = (float)(in ? d : -d);
        }
    r->area = sum * f->cell.x * f->cell.y;
}

static bool holds(const float *mask, int64_t n)
{
    for (int64_t i = 0; i < n; i++)
        if (mask[i] >= 0.5f)
            return true;
    return false;
}

tz_status tz_region_from_mask(tz_ctx *ctx, const float *mask, int32_t width,
                              int32_t height, tz_vec3 size, bool torus, tz_region **out)
{
    *out = NULL;
    if (width < 1 || height < 1 || width > MOST || height > MOST)
        return tz_fail(ctx, TZ_INVALID,
                       "a mask of %d x %d cannot be a region; it may have 1 to %d a side",
                       width, height, MOST);
    if (!(size.x > 0) || !(size.y > 0) || !isfinite(size.x) || !isfinite(size.y))
        return tz_fail(ctx, TZ_INVALID, "a domain of %g x %g has no area for a region",
                       size.x, size.y);
    const int64_t n = (int64_t)width * height;
    if (!holds(mask, n))
        return tz_fail(ctx, TZ_INVALID, "nothing lies inside the region");
    tz_region *r = NULL;
    field f = {.mask = mask,
               .raster = {width, height, size, torus},
               .cell = {size.x / width, size.y / height},
               .far = 1e30};
    tz_status s = tz_alloc_zero(ctx, &r, 1, sizeof *r);
    if (s != TZ_OK)
        return s;
    r->ctx = ctx;
    r->raster = f.raster;
    s = tz_alloc(ctx, &r->distance, (size_t)n, sizeof *r->distance);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &f.partial, (size_t)n, sizeof *f.partial);
    f.square = r->distance;
    for (int64_t i = 0; s == TZ_OK && i < n; i++)
        f.square[i] = (float)f.far;
    if (s == TZ_OK)
        s = measure(ctx, &f);
    if (s == TZ_OK)
        finish(r, &f);
    tz_free(ctx, f.partial);
    if (s != TZ_OK)
        tz_region_free(r);
    else
        *out = r;
    return s;
}

/* ---- drawings -------------------------------------------------------------------- */

/* FINE x FINE samples of each cell as bits, so that shapes that overlap or meet are one. */
typedef struct cover {
    tz_raster fine;
    int32_t width;
    uint64_t *bits;
} cover;

static void add_span(void *user, int32_t row, int32_t x0, int32_t x1)
{
    cover *c = user;
    uint64_t *line = &c->bits[(int64_t)(row / FINE) * c->width];
    const int shift = row % FINE * FINE;
    for (int32_t x = x0; x < x1;) {
        const int32_t cell = x / FINE,
                      end = x1 < (cell + 1) * FINE ? x1 : (cell + 1) * FINE;
        const uint64_t ones = (UINT64_C(1) << (end - x)) - 1;
        line[cell] |= ones << (x % FINE) << shift;
        x = end;
    }
}

static int count_bits(uint64_t v)
{
    int n = 0;
    for (; v; v &= v - 1)
        n++;
    return n;
}

/* Filled shapes, and lines that end where they began. */
static tz_status cover_part(tz_element_reader *r, const tz_part *p, cover *c, bool *any)
{
    const double tolerance = 0.02 * c->fine.size.x / c->width;
    tz_polys all = {0}, polys = {0};
    tz_status s =
        tz_polys_add_path(r->ctx, &all, r->verb.v + p->verb, p->verbs,
                          r->point.v + p->point, tz_affine_identity(), tolerance);
    for (int32_t k = 0; k < all.part.n && s == TZ_OK; k++) {
        int32_t n;
        const tz_vec2 *v = tz_polys_part(&all, k, &n);
        const double gap = hypot(v[0].x - v[n - 1].x, v[0].y - v[n - 1].y);
        if (!(p->look.fill & 255) && !all.closed.v[k] &&
            !(gap <= 1e-3 * tz_box_diagonal(p->box)))
            continue;
        s = tz_array_push(r->ctx, &polys.part, polys.point.n);
        for (int32_t i = 0; i < n && s == TZ_OK; i++)
            s = tz_array_push(r->ctx, &polys.point, v[i]);
    }
    *any = *any || polys.part.n > 0;
    if (s == TZ_OK)
        s = tz_guide_fill(r->ctx, &c->fine, &polys, p->look.rule == 1, add_span, c);
    tz_polys_deinit(r->ctx, &all);
    tz_polys_deinit(r->ctx, &polys);
    return s;
}

/* A rectangle about the whole view is paper where something else is drawn. */
static bool is_paper(const tz_element_reader *r, const tz_part *p, tz_vec3 size)
{
    const double e = 1e-3 * fmin(size.x, size.y);
    return r->part.n > 1 && p->points <= 5 && p->box.x0 <= e && p->box.y0 <= e &&
           p->box.x1 >= size.x - e && p->box.y1 >= size.y - e;
}

static tz_status read_drawing(tz_ctx *ctx, const char *path, tz_raster raster,
                              float **mask)
{
    tz_element_reader r;
    cover c = {.fine = raster, .width = raster.width};
    bool any = false;
    const size_t n = (size_t)raster.width * (size_t)raster.height;
    c.fine.width *= FINE, c.fine.height *= FINE;
    tz_status s = tz_guide_read_svg(ctx, path, raster.size, &r);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &c.bits, n, sizeof *c.bits);
    if (s == TZ_OK)
        s = tz_alloc(ctx, mask, n, sizeof **mask);
    for (int32_t i = 0; i < r.part.n && s == TZ_OK; i++)
        if (!is_paper(&r, &r.part.v[i], raster.size))
            s = tz_ctx_cancelled(ctx) ? TZ_CANCELLED
                                      : cover_part(&r, &r.part.v[i], &c, &any);
    for (size_t i = 0; i < n && s == TZ_OK; i++)
        (*mask)[i] = (float)count_bits(c.bits[i]) / (FINE * FINE);
    if (s == TZ_OK && !any)
        s = tz_fail(ctx, TZ_INVALID,
                    "%s: there is no filled or closed shape to be the region; draw one%s",
                    path, tz_guide_hint(&r));
    tz_free(ctx, c.bits);
    tz_element_reader_deinit(&r);
    return s;
}

/* ---- pictures -------------------------------------------------------------------- */

static bool is_opaque(const tz_image *im)
{
    for (int32_t y = 0; im->alpha >= 0 && y < im->height; y++)
        for (int32_t x = 0; x < im->width; x++)
            if (tz_image_at(im, x, y)[im->alpha] < 1)
                return false;
    return true;
}

static tz_status read_picture(tz_ctx *ctx, const char *path, float **mask, int32_t *width,
                              int32_t *height)
{
    tz_image im;
    tz_status s = tz_guide_read_image(ctx, path, 2 * TZ_GUIDE_SIDE, false, &im);
    if (s == TZ_OK)
        s = tz_alloc(ctx, mask, (size_t)im.width * (size_t)im.height, sizeof **mask);
    const bool grey = s == TZ_OK && is_opaque(&im);
    const int32_t colours = im.channels - (im.alpha >= 0);
    for (int32_t y = 0; s == TZ_OK && y < im.height; y++)
        for (int32_t x = 0; x < im.width; x++) {
            const float *p = tz_image_at(&im, x, y);
            float *v = &(*mask)[(int64_t)y * im.width + x];
            *v = !grey          ? p[im.alpha]
                 : colours >= 3 ? 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2]
                                : p[0];
        }
    *width = im.width, *height = im.height;
    tz_image_deinit(&im);
    return s;
}

tz_status tz_region_read(tz_ctx *ctx, const char *path, tz_vec3 size, bool torus,
                         tz_region **out)
{
    tz_raster raster = {0};
    float *mask = NULL;
    *out = NULL;
    tz_status s = tz_guide_raster(ctx, size, torus, TZ_GUIDE_SIDE, &raster);
    if (s == TZ_OK)
        s = tz_guide_is_svg(path)
                ? read_drawing(ctx, path, raster, &mask)
                : read_picture(ctx, path, &mask, &raster.width, &raster.height);
    if (s == TZ_OK && !holds(mask, (int64_t)raster.width * raster.height))
        s = tz_fail(ctx, TZ_INVALID,
                    "%s: nothing in it is inside (light, opaque, or filled and in view)",
                    path);
    if (s == TZ_OK)
        s = tz_region_from_mask(ctx, mask, raster.width, raster.height, size, torus, out);
    tz_free(ctx, mask);
    return s;
}
