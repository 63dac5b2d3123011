/* SPDX-License-Identifier: Apache-2.0 */
/* Light of a photo: what changes slowly over it is taken for the light, and evened by a gain
 * for each cut-out, as if all of them had lain in the mean light. */
#include <string.h>

#include "synthesis/element_render_internal.h"

static void smooth_light(tz_photo_light *l)
{
    float next[TZ_LIGHT * TZ_LIGHT];
    for (int pass = 0; pass < 3; pass++) {
        for (int32_t y = 0; y < l->ny; y++)
            for (int32_t x = 0; x < l->nx; x++) {
                float sum = 0, n = 0;
                for (int32_t v = y - 1; v <= y + 1; v++)
                    for (int32_t u = x - 1; u <= x + 1; u++)
                        if (u >= 0 && v >= 0 && u < l->nx && v < l->ny)
                            sum += l->v[v * l->nx + u], n++;
                next[y * l->nx + x] = sum / n;
            }
        memcpy(l->v, next, sizeof next);
    }
}

/* Of the plate where there is one: its ground is of one stuff more than the photo is. */
void tz_photo_find_light(const tz_element_pixels *p, tz_photo_light *l)
{
    const tz_image *im = p->plate ? p->plate : p->photo;
    const int32_t side = im->width > im->height ? im->width : im->height;
    const int32_t colours = tz_photo_colours(im);
    l->nx = (int32_t)((int64_t)im->width * TZ_LIGHT / side);
    l->ny = (int32_t)((int64_t)im->height * TZ_LIGHT / side);
    l->nx = l->nx < 1 ? 1 : l->nx;
    l->ny = l->ny < 1 ? 1 : l->ny;
    for (int32_t j = 0; j < l->ny; j++)
        for (int32_t i = 0; i < l->nx; i++) {
            const int32_t x0 = (int32_t)((int64_t)i * im->width / l->nx),
                          x1 = (int32_t)((int64_t)(i + 1) * im->width / l->nx),
                          y0 = (int32_t)((int64_t)j * im->height / l->ny),
                          y1 = (int32_t)((int64_t)(j + 1) * im->height / l->ny);
            const int32_t dx = 1 + (x1 - x0) / 32, dy = 1 + (y1 - y0) / 32;
            double sum = 0, n = 0;
            for (int32_t y = y0; y < y1; y += dy)
                for (int32_t x = x0; x < x1; x += dx, n++) {
                    const tz_f4 v = tz_photo_linear(im, x, y, false, NULL);
                    sum += colours < 3 ? v[0]
                                       : 0.2126F * v[0] + 0.7152F * v[1] + 0.0722F * v[2];
                }
            l->v[j * l->nx + i] = (float)(n > 0 ? sum / n : 0);
        }
    smooth_light(l);
    double sum = 0;
    for (int32_t k = 0; k < l->nx * l->ny; k++)
        sum += l->v[k];
    l->mean = (float)(sum / (l->nx * l->ny));
}

/* Gain of what lies at photo px p, between half and double. */
float tz_photo_gain(const tz_photo_light *l, const tz_image *photo, tz_vec2 p,
                    double share)
{
    const double u = fmin(fmax(p.x / photo->width * l->nx - 0.5, 0), l->nx - 1),
                 v = fmin(fmax(p.y / photo->height * l->ny - 0.5, 0), l->ny - 1);
    const int32_t i = (int32_t)u, j = (int32_t)v, i1 = i + 1 < l->nx ? i + 1 : i,
                  j1 = j + 1 < l->ny ? j + 1 : j;
    const double fx = u - i, fy = v - j;
    const float *a = l->v + (int64_t)j * l->nx, *b = l->v + (int64_t)j1 * l->nx;
    const double here =
        (a[i] * (1 - fx) + a[i1] * fx) * (1 - fy) + (b[i] * (1 - fx) + b[i1] * fx) * fy;
    if (!(here > 1e-5) || !(l->mean > 1e-5))
        return 1;
    const double gain = pow(l->mean / here, share);
    return (float)fmin(fmax(gain, 0.5), 2);
}
