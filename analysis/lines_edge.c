/* SPDX-License-Identifier: Apache-2.0 */
/* Borders: the forest's response, and where across the border it is highest: the vertex of
 * the parabola through the response at the pixel and one px to either side. */
#include <math.h>
#include <string.h>

#include "analysis/forest.h"
#include "analysis/lines_field.h"

#define WIDE 2 /* of a border, px */

static float at(const tz_edge_map *m, float x, float y)
{
    if (!(x >= 0 && y >= 0 && x < (float)(m->width - 1) && y < (float)(m->height - 1)))
        return 0;
    const int32_t u = (int32_t)x, v = (int32_t)y;
    const float fx = x - (float)u, fy = y - (float)v;
    const float *p = m->response + (ptrdiff_t)v * m->width + u;
    const float a = p[0] + fx * (p[1] - p[0]),
                b = p[m->width] + fx * (p[m->width + 1] - p[m->width]);
    return a + fy * (b - a);
}

static tz_status row(tz_ctx *ctx, void *arg, int64_t y, int worker)
{
    tz_line_field *f = arg;
    const tz_edge_map *m = &f->map;
    const ptrdiff_t all = (ptrdiff_t)m->width * m->height;
    (void)ctx, (void)worker;
    for (int32_t x = 0; x < m->width; x++) {
        const ptrdiff_t p = (ptrdiff_t)y * m->width + x;
        const double angle =
            0.5 * atan2((double)m->normal[p + all], (double)m->normal[p]);
        const float nx = (float)cos(angle), ny = (float)sin(angle), here = m->response[p];
        const float a = at(m, (float)x - nx, (float)y - ny),
                    b = at(m, (float)x + nx, (float)y + ny);
        const float bend = a + b - 2 * here;
        f->offset[p] = bend < 0 ? fminf(fmaxf(0.5F * (a - b) / bend, -1), 1) : 0;
        f->wide[p] = WIDE;
    }
    return TZ_OK;
}

tz_status tz_line_edges(tz_ctx *ctx, const tz_image *photo, const char *model,
                        tz_line_field *out)
{
    const tz_forest *forest = NULL;
    const size_t n = (size_t)photo->width * (size_t)photo->height;
    *out = (tz_line_field){.edge = true};
    tz_status s = tz_forest_of(ctx, model, &forest);
    if (s == TZ_OK)
        s = tz_line_field_init(ctx, out, photo->width, photo->height);
    if (s == TZ_OK)
        s = tz_forest_response(ctx, photo, forest, out->map.response, out->map.normal);
    for (size_t p = 0; p < n && s == TZ_OK; p++)
        out->map.response[p] *= 100;
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, photo->height, row, out);
    if (s != TZ_OK)
        tz_line_field_deinit(ctx, out);
    out->edge = true;
    return s;
}
