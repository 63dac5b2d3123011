/* SPDX-License-Identifier: Apache-2.0 */
/* Reading guides, and polygons as spans of cells by scan lines. */
#include "elements/guide.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

tz_status tz_guide_raster(tz_ctx *ctx, tz_vec3 size, bool torus, int32_t side,
                          tz_raster *out)
{
    if (!(size.x > 0) || !(size.y > 0) || !isfinite(size.x) || !isfinite(size.y))
        return tz_fail(ctx, TZ_INVALID, "a domain of %g x %g has no area for a guide",
                       size.x, size.y);
    const double cell = fmax(size.x, size.y) / side;
    *out = (tz_raster){.width = (int32_t)fmax(1, floor(size.x / cell + 0.5)),
                       .height = (int32_t)fmax(1, floor(size.y / cell + 0.5)),
                       .size = size,
                       .torus = torus};
    return TZ_OK;
}

bool tz_guide_is_svg(const char *path)
{
    const size_t n = strlen(path);
    return n >= 4 && strcasecmp(path + n - 4, ".svg") == 0;
}

/* ---- drawings -------------------------------------------------------------------- */

tz_status tz_guide_read_svg(tz_ctx *ctx, const char *path, tz_vec3 size,
                            tz_element_reader *r)
{
    tz_affine map = tz_affine_identity();
    *r = (tz_element_reader){.ctx = ctx, .name = path, .set = {.ctx = ctx}};
    tz_status s = tz_svg_read(ctx, path, &r->doc);
    if (s == TZ_OK)
        s = tz_element_view(r, &map);
    if (s == TZ_OK)
        s = tz_style_load(r);
    if (s != TZ_OK)
        return s;
    const double x = size.x / r->view.x, y = size.y / r->view.y;
    map = tz_affine_then(map, (tz_affine){x, 0, 0, y, 0, 0});
    return tz_element_walk_shapes(r, map);
}

const char *tz_guide_hint(const tz_element_reader *r)
{
    return r->ignored > 0 ? "; turn texts into paths" : "";
}

/* ---- pictures -------------------------------------------------------------------- */

tz_status tz_guide_read_image(tz_ctx *ctx, const char *path, int32_t most, bool sharp,
                              tz_image *im)
{
    const tz_image_read_options opt = {.data = true, .max_pixels = 1 << 28};
    tz_image full = {0};
    *im = (tz_image){0};
    tz_status s = tz_image_read(ctx, path, &opt, &full);
    if (s != TZ_OK)
        return s;
    const int32_t longer = full.width > full.height ? full.width : full.height;
    const int32_t k = (longer + most - 1) / most;
    if (k <= 1) {
        *im = full;
        return TZ_OK;
    }
    s = tz_image_init(ctx, im, (full.width + k - 1) / k, (full.height + k - 1) / k,
                      full.channels);
    im->alpha = full.alpha, im->depth = full.depth;
    for (int32_t y = 0; s == TZ_OK && y < im->height; y++)
        for (int32_t x = 0; x < im->width; x++) {
            const int32_t x1 = (x + 1) * k < full.width ? (x + 1) * k : full.width;
            const int32_t y1 = (y + 1) * k < full.height ? (y + 1) * k : full.height;
            float *out = tz_image_at(im, x, y);
            const float *middle =
                tz_image_at(&full, (x * k + x1 - 1) / 2, (y * k + y1 - 1) / 2);
            for (int32_t c = 0; c < im->channels; c++) {
                double sum = 0;
                for (int32_t j = y * k; j < y1 && !sharp; j++)
                    for (int32_t i = x * k; i < x1; i++)
                        sum += (double)tz_image_at(&full, i, j)[c];
                out[c] = sharp ? middle[c]
                               : (float)(sum / ((double)(x1 - x * k) * (y1 - y * k)));
            }
        }
    tz_image_deinit(&full);
    return s;
}

/* ---- scan lines ------------------------------------------------------------------ */

/* Where an edge crosses the middle of a row. */
typedef struct crossing {
    int32_t row;
    int32_t turn; /* +1 downwards, -1 upwards */
    double x;     /* in cells */
} crossing;

typedef struct crossings {
    TZ_ARRAY(crossing)
    list;
} crossings;

/* Rows whose middles lie in [y0, y1): each vertex belongs to one of its edges. */
static tz_status add_edge(tz_ctx *ctx, crossings *c, tz_vec2 p, tz_vec2 q, int32_t rows)
{
    const int32_t turn = p.y < q.y ? 1 : -1;
    const tz_vec2 a = turn > 0 ? p : q, b = turn > 0 ? q : p;
    const double first = fmax(0, ceil(a.y - 0.5)), last = fmin(rows, ceil(b.y - 0.5));
    tz_status s = TZ_OK;
    for (int32_t row = (int32_t)fmin(first, rows); row < last && s == TZ_OK; row++) {
        const double t = (row + 0.5 - a.y) / (b.y - a.y);
        s = tz_array_push(ctx, &c->list, ((crossing){row, turn, a.x + t * (b.x - a.x)}));
    }
    return s;
}

static int by_row(const void *a, const void *b)
{
    const crossing *p = a, *q = b;
    if (p->row != q->row)
        return p->row < q->row ? -1 : 1;
    return (p->x > q->x) - (p->x < q->x);
}

static int32_t column(double x, int32_t width)
{
    const double c = ceil(x - 0.5);
    return c < 0 ? 0 : c > width ? width : (int32_t)c;
}

tz_status tz_guide_fill(tz_ctx *ctx, const tz_raster *raster, const tz_polys *polys,
                        bool even_odd, tz_guide_span span, void *user)
{
    const double sx = raster->width / raster->size.x,
                 sy = raster->height / raster->size.y;
    crossings c = {0};
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < polys->part.n && s == TZ_OK; k++) {
        int32_t n;
        const tz_vec2 *p = tz_polys_part(polys, k, &n);
        for (int32_t i = 0; i < n && s == TZ_OK; i++) {
            const tz_vec2 q = p[(i + 1) % n];
            s = add_edge(ctx, &c, (tz_vec2){p[i].x * sx, p[i].y * sy},
                         (tz_vec2){q.x * sx, q.y * sy}, raster->height);
        }
    }
    if (s == TZ_OK && c.list.n > 1)
        qsort(c.list.v, (size_t)c.list.n, sizeof *c.list.v, by_row);
    int32_t winding = 0;
    for (int32_t i = 0; s == TZ_OK && i + 1 < c.list.n; i++) {
        const crossing *a = &c.list.v[i], *b = a + 1;
        winding = even_odd ? !winding : winding + a->turn;
        if (a->row != b->row) {
            winding = 0;
            continue;
        }
        const int32_t x0 = column(a->x, raster->width), x1 = column(b->x, raster->width);
        if (winding != 0 && x0 < x1)
            span(user, a->row, x0, x1);
    }
    tz_array_free(ctx, &c.list);
    return s;
}
