/* SPDX-License-Identifier: Apache-2.0 */
#include "analysis/lines.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/lines_fit.h"
#include "analysis/lines_graph.h"

#define AT(m) offsetof(tz_lines_params, m)
static const tz_param rows[] = {
    {"line", TZ_PARAM_ENUM, AT(line), 0, 0, "auto", "", "auto|edge|ridge|both",
     "Which lines of a photo: borders between what differs, ridges (cracks, veins, "
     "joints: darker or lighter than both sides), or ridges and, elsewhere, borders."},
    {"tone", TZ_PARAM_ENUM, AT(tone), 0, 0, "auto", "", "auto|dark|light|both",
     "Ridges: darker or lighter than their sides."},
    {"line-strength", TZ_PARAM_DOUBLE, AT(strength), 0, 1, "0.5", "", NULL,
     "How much a line must stand out; 0.5 = as the photo tells, less finds more."},
    {"line-width", TZ_PARAM_RANGE, AT(width), 0, 1e4, "0,0", "px", NULL,
     "Widths of the lines looked for; 0,0 = as the photo tells."},
    {"line-length", TZ_PARAM_DOUBLE, AT(length), 0, 1e6, "0", "px", NULL,
     "Shortest line and branch that is kept; 0 = as the widths tell."},
    {"line-gap", TZ_PARAM_DOUBLE, AT(gap), -1, 1e5, "0", "px", NULL,
     "Widest gap in a line that is bridged; 0 = as the widths tell, -1 = none."},
    {"line-error", TZ_PARAM_DOUBLE, AT(error), 0.01, 100, "0.5", "px", NULL,
     "How far curves may lie off the line that was found."},
    {"line-most", TZ_PARAM_INT, AT(most), 10000, 2e9, "4000000", "px", NULL,
     "The photo is halved until it has no more pixels than this."},
};
#undef AT
const tz_param_table tz_lines_param_table = {
    "lines", "Finds the lines of a photo.", rows, (int32_t)(sizeof rows / sizeof *rows),
    sizeof(tz_lines_params)};

typedef struct search {
    tz_ctx *ctx;
    const tz_image *photo;
    const tz_lines_params *p;
    tz_line_picture picture;
    double side; /* px of the photo a px of the picture */
    float *grey;
    tz_line_field ridge[2], edge;
    tz_line_graph g;
} search;

static tz_status look(search *f)
{
    int32_t shift = 0;
    while ((((int64_t)f->photo->width >> shift) * (f->photo->height >> shift)) >
           f->p->most)
        shift++;
    f->side = 1 << shift;
    tz_status s = tz_line_picture_init(f->ctx, f->photo, shift, &f->picture);
    const size_t n = (size_t)f->picture.width * (size_t)f->picture.height;
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &f->grey, n, sizeof *f->grey);
    for (size_t i = 0; i < n && s == TZ_OK; i++)
        f->grey[i] = f->picture.channels == 1
                         ? f->picture.v[i]
                         : 0.30F * f->picture.v[i] + 0.59F * f->picture.v[n + i] +
                               0.11F * f->picture.v[2 * n + i];
    return s;
}

static int by_size(const void *a, const void *b)
{
    const float p = *(const float *)a, q = *(const float *)b;
    return (p > q) - (p < q);
}

/* Quantiles of the strength over the thinned ridges. */
static tz_status quantiles(search *f, const tz_line_field *r, const double *at, int n,
                           double *out)
{
    const tz_edge_map *m = &r->map;
    const ptrdiff_t all = (ptrdiff_t)m->width * m->height;
    float *v = NULL;
    ptrdiff_t count = 0;
    tz_status s = tz_alloc(f->ctx, &v, (size_t)all, sizeof *v);
    for (ptrdiff_t i = 0; i < all && s == TZ_OK; i++)
        if (m->on[i])
            v[count++] = m->response[i];
    if (s == TZ_OK)
        qsort(v, (size_t)count, sizeof *v, by_size);
    for (int k = 0; k < n && s == TZ_OK; k++)
        out[k] = count ? v[(ptrdiff_t)(at[k] * (double)(count - 1))] : 0;
    tz_free(f->ctx, v);
    return s;
}

static tz_status ridges(search *f)
{
    const int32_t w = f->picture.width, h = f->picture.height;
    double width[2] = {f->p->width[0] / f->side, f->p->width[1] / f->side};
    if (!(width[1] > 0)) {
        width[0] = 2;
        width[1] = fmin(16, fmax(4, fmin(w, h) / 32.0));
    }
    tz_status s = tz_line_ridges(f->ctx, f->grey, w, h, width, f->ridge);
    for (int k = 0; k < 2 && s == TZ_OK; k++)
        s = tz_edge_map_detect(&f->ridge[k].map, 0, 1);
    return s;
}

static tz_status graph(search *f, const tz_line_field *r)
{
    const double at[4] = {0.25, 0.5, 0.75, 0.95};
    double q[4] = {0};
    tz_status s = quantiles(f, r, at, 4, q);
    tz_line_tidy t = {.low = 1.5 * q[1] * exp2(4 * (f->p->strength - 0.5)), .length = 8, .gap = 12};
    t.proof = 12 * t.low;
    if (getenv("TZ_LINES_DEBUG"))
        fprintf(stderr, "light %d q %.2f %.2f %.2f %.2f low %.2f\n", r->light, q[0], q[1], q[2], q[3], t.low);
    if (s == TZ_OK)
        s = tz_line_graph_trace(r, &f->g);
    if (s == TZ_OK)
        s = tz_line_graph_rejoin(&f->g);
    if (s == TZ_OK)
        s = tz_line_graph_select(&f->g, &t);
    if (s == TZ_OK)
        s = tz_line_graph_mend(&f->g);
    if (s == TZ_OK)
        s = tz_line_graph_smooth(&f->g, 1.2);
    return s;
}

static tz_status open_set(search *f, tz_curve_set *out)
{
    const tz_vec3 size = {f->photo->width, f->photo->height, 0};
    tz_element_photo p = {.width = f->photo->width, .height = f->photo->height};
    out->ctx = out->element.ctx = f->ctx;
    out->domain.size = out->element.domain.size = size;
    tz_status s = tz_strdup(f->ctx, "", &p.path);
    if (s == TZ_OK && (s = tz_array_push(f->ctx, &out->element.photo, p)) != TZ_OK)
        tz_free(f->ctx, p.path);
    return s;
}

tz_status tz_lines_find(tz_ctx *ctx, const tz_image *photo, const tz_lines_params *params,
                        tz_curve_set *out, tz_image *plate, tz_lines_verdict *verdict)
{
    search f = {.ctx = ctx, .photo = photo, .p = params, .g = {.ctx = ctx}};
    *out = (tz_curve_set){0};
    if (plate)
        *plate = (tz_image){0};
    if (verdict)
        *verdict = (tz_lines_verdict){0};
    if (photo->encoding == TZ_ENCODING_DATA || photo->channels < 1 ||
        photo->channels > 4 || photo->width < 1 || photo->height < 1)
        return tz_fail(ctx, TZ_INVALID,
                       "lines are found in photos of 1 to 4 channels that show colours; "
                       "this is %d x %d of %d channels",
                       photo->width, photo->height, photo->channels);
    tz_status s = look(&f);
    if (s == TZ_OK)
        s = ridges(&f);
    if (s == TZ_OK && params->tone != 2)
        s = graph(&f, &f.ridge[0]);
    if (s == TZ_OK && params->tone == 2)
        s = graph(&f, &f.ridge[1]);
    if (s == TZ_OK)
        s = open_set(&f, out);
    if (s == TZ_OK)
        s = tz_line_fit(&f.g, &f.picture, f.side, params->error, out);
    tz_line_picture_deinit(&f.picture);
    tz_free(ctx, f.grey);
    for (int k = 0; k < 2; k++)
        tz_line_field_deinit(ctx, &f.ridge[k]);
    tz_line_field_deinit(ctx, &f.edge);
    tz_line_graph_deinit(&f.g);
    if (s != TZ_OK)
        tz_curve_set_deinit(out);
    return s;
}
