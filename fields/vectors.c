/* SPDX-License-Identifier: Apache-2.0 */
#include "fields/vectors.h"

#include <math.h>

#include "elements/guide.h"

enum { SIDE = 512, MOST_PIXELS = 4096 };

void tz_vectors_deinit(tz_vectors *v)
{
    tz_free(v->ctx, v->length);
    *v = (tz_vectors){0};
}

static double length_of(const tz_image *im, const float *p)
{
    const double zero = im->depth > 16 ? 0 : 0.5;
    const double l = hypot((double)p[0] - zero, (double)p[1] - zero);
    return isfinite(l) && !(im->alpha >= 0 && p[im->alpha] < 0.5f) ? l : 0;
}

/* Mean length of the pixels under a cell, at least of the one under its middle. */
static double mean_length(const tz_image *im, const tz_raster *r, int32_t x, int32_t y)
{
    const int32_t x0 = (int32_t)((int64_t)x * im->width / r->width),
                  y0 = (int32_t)((int64_t)y * im->height / r->height);
    const int32_t x1 = (int32_t)((int64_t)(x + 1) * im->width / r->width),
                  y1 = (int32_t)((int64_t)(y + 1) * im->height / r->height);
    double sum = 0, n = 0;
    for (int32_t j = y0; j < (y1 > y0 ? y1 : y0 + 1); j++)
        for (int32_t i = x0; i < (x1 > x0 ? x1 : x0 + 1); i++)
            sum += length_of(im, tz_image_at(im, i, j)), n++;
    return sum / n;
}

tz_status tz_vectors_read(tz_ctx *ctx, const char *path, tz_vec3 size, bool torus,
                          tz_vectors *v)
{
    tz_image im = {0};
    *v = (tz_vectors){.ctx = ctx};
    tz_raster *r = &v->raster;
    tz_status s = tz_guide_raster(ctx, size, torus, SIDE, r);
    if (s == TZ_OK)
        s = tz_guide_read_image(ctx, path, MOST_PIXELS, true, &im);
    if (s == TZ_OK && im.channels - (im.alpha >= 0) < 2)
        s = tz_fail(ctx, TZ_INVALID,
                    "%s: a grey image holds angles, which have no length; give one of "
                    "vectors in red and green",
                    path);
    const size_t n = s == TZ_OK ? (size_t)r->width * (size_t)r->height : 0;
    if (s == TZ_OK)
        s = tz_alloc(ctx, &v->length, n, sizeof *v->length);
    for (size_t i = 0; i < n && s == TZ_OK; i++) {
        const double l = mean_length(&im, r, (int32_t)(i % (size_t)r->width),
                                     (int32_t)(i / (size_t)r->width));
        v->length[i] = (float)fmin(l, 1e30);
        v->greatest = fmax(v->greatest, (double)v->length[i]);
    }
    if (s == TZ_OK && !(v->greatest > 0))
        s = tz_fail(ctx, TZ_INVALID, "%s: all of its vectors are 0; give one of others",
                    path);
    for (size_t i = 0; i < n && s == TZ_OK; i++)
        v->length[i] = (float)((double)v->length[i] / v->greatest);
    tz_image_deinit(&im);
    if (s != TZ_OK)
        tz_vectors_deinit(v);
    return s;
}

tz_status tz_vectors_say_sizes(const tz_vectors *v, double least, double most,
                               tz_element_field *field)
{
    const tz_raster *r = &field->raster;
    const size_t n = (size_t)r->width * (size_t)r->height;
    tz_status s = TZ_OK;
    if (!(least >= TZ_ELEMENT_FIELD_LEAST_SIZE) || !(least <= most) ||
        !(most <= TZ_ELEMENT_FIELD_MOST_SIZE))
        return tz_fail(field->ctx, TZ_INVALID,
                       "sizes %g to %g by length of vectors; they must be from 0.001 to "
                       "1000, in order",
                       least, most);
    if (!field->image) {
        s = tz_alloc(field->ctx, &field->image, n, sizeof *field->image);
        for (size_t i = 0; i < n && s == TZ_OK; i++)
            field->image[i] = (tz_element_field_cell){.density = -1};
    }
    for (size_t i = 0; i < n && s == TZ_OK; i++) {
        const tz_vec3 at = {((double)(i % (size_t)r->width) + 0.5) * r->size.x / r->width,
                            (floor((double)i / r->width) + 0.5) * r->size.y / r->height,
                            0};
        tz_element_field_cell *c = &field->image[i];
        c->size = (float)(least + tz_vectors_at(v, at) * (most - least));
        c->weight[1] = 1;
    }
    return s;
}
