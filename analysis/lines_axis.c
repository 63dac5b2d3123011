/* SPDX-License-Identifier: Apache-2.0 */
/* Fisher's discriminant: d is the mean difference of colour between lines and their sides,
 * S the covariance of that difference plus that of differences as far apart beside the
 * lines; w = S^-1 d has the largest ratio (w'd)^2 / w'Sw. It is taken where that ratio is
 * at least a fifth larger than the grey picture's.
 * @source Fisher: The use of multiple measurements in taxonomic problems, 1936 */
#include "analysis/lines_axis.h"

#include <math.h>

#define BETTER  1.2
#define FEWEST  200 /* points that tell */
#define SAMPLES 20000
#define RIDGE   1.0 /* added to variances: below the camera's noise nothing is sure */

typedef struct moments {
    double sum[3], square[3][3], n;
} moments;

static const double grey_of[3] = {0.30, 0.59, 0.11};

static bool colour_at(const tz_line_picture *im, tz_vec2 p, double out[3])
{
    const ptrdiff_t all = (ptrdiff_t)im->width * im->height;
    const double x = floor(p.x), y = floor(p.y);
    if (!(x >= 0 && y >= 0 && x < im->width && y < im->height))
        return false;
    for (int c = 0; c < 3; c++)
        out[c] = im->v[c * all + (ptrdiff_t)y * im->width + (ptrdiff_t)x];
    return true;
}

static void add(moments *m, const double v[3], double weight)
{
    for (int i = 0; i < 3; i++) {
        m->sum[i] += weight * v[i];
        for (int k = 0; k < 3; k++)
            m->square[i][k] += weight * v[i] * v[k];
    }
    m->n += weight;
}

/* Lines against the mean of their sides. */
static void look_across(const tz_line_graph *g, const tz_line_picture *im, moments *m)
{
    for (int32_t i = 0; i < g->chain.n; i++) {
        const tz_line_chain *c = &g->chain.v[i];
        for (int32_t k = 2; k < c->n - 2; k++) {
            const tz_line_point *p = &g->point.v[c->first + k];
            const tz_vec2 d = tz_vec2_sub(p[2].at, p[-2].at);
            const double far = tz_vec2_length(d), reach = 0.75 * p->width + 1.5;
            double mid[3], a[3], b[3];
            if (!(far > 0))
                continue;
            const tz_vec2 n = {-d.y / far * reach, d.x / far * reach};
            if (!colour_at(im, p->at, mid) || !colour_at(im, tz_vec2_add(p->at, n), a) ||
                !colour_at(im, tz_vec2_sub(p->at, n), b))
                continue;
            for (int e = 0; e < 3; e++)
                mid[e] -= 0.5 * (a[e] + b[e]);
            add(m, mid, 1);
        }
    }
}

static tz_status look_between(const tz_line_graph *g, const tz_line_picture *im,
                              int32_t far, moments *m)
{
    const int32_t w = im->width, h = im->height;
    const int32_t step = 1 + (int32_t)sqrt((double)w * h / SAMPLES);
    uint8_t *line = NULL;
    tz_status s = tz_alloc_zero(g->ctx, &line, (size_t)w * (size_t)h, 1);
    if (s == TZ_OK)
        tz_line_graph_cover(g, 1, 1, w, h, line);
    for (int32_t y = 0; y < h - far && s == TZ_OK; y += step)
        for (int32_t x = 0; x < w - far; x += step)
            for (int k = 0; k < 2; k++) {
                const int32_t u = k ? x : x + far, v = k ? y + far : y;
                double a[3], b[3];
                if (line[(ptrdiff_t)y * w + x] || line[(ptrdiff_t)v * w + u] ||
                    !colour_at(im, (tz_vec2){x, y}, a) ||
                    !colour_at(im, (tz_vec2){u, v}, b))
                    continue;
                for (int e = 0; e < 3; e++)
                    a[e] -= b[e];
                add(m, a, 1);
            }
    tz_free(g->ctx, line);
    return s;
}

/* x = a^-1 b of a symmetric positive definite one (Cholesky). */
static bool solve(double a[3][3], const double b[3], double x[3])
{
    double l[3][3] = {{0}}, y[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k <= i; k++) {
            double sum = a[i][k];
            for (int e = 0; e < k; e++)
                sum -= l[i][e] * l[k][e];
            if (i == k && !(sum > 1e-9))
                return false;
            l[i][k] = i == k ? sqrt(sum) : sum / l[k][k];
        }
    for (int i = 0; i < 3; i++) {
        y[i] = b[i];
        for (int k = 0; k < i; k++)
            y[i] -= l[i][k] * y[k];
        y[i] /= l[i][i];
    }
    for (int i = 2; i >= 0; i--) {
        x[i] = y[i];
        for (int k = i + 1; k < 3; k++)
            x[i] -= l[k][i] * x[k];
        x[i] /= l[i][i];
    }
    return true;
}

static double ratio(double s[3][3], const double d[3], const double w[3])
{
    double up = 0, down = 0;
    for (int i = 0; i < 3; i++) {
        up += w[i] * d[i];
        for (int k = 0; k < 3; k++)
            down += w[i] * s[i][k] * w[k];
    }
    return down > 0 ? up * up / down : 0;
}

tz_status tz_line_axis(const tz_line_graph *g, const tz_line_picture *picture,
                       float *grey, bool *changed)
{
    moments line = {.n = 0}, between = {.n = 0};
    const ptrdiff_t all = (ptrdiff_t)picture->width * picture->height;
    double width = 0, length = 0, d[3], s[3][3], w[3], rise = 0, grey_rise = 0;
    *changed = false;
    if (picture->channels < 3)
        return TZ_OK;
    for (int32_t i = 0; i < g->chain.n; i++) {
        width += g->chain.v[i].length * g->chain.v[i].width;
        length += g->chain.v[i].length;
    }
    look_across(g, picture, &line);
    if (line.n < FEWEST)
        return TZ_OK;
    const tz_status st =
        look_between(g, picture, (int32_t)fmax(2, rint(0.75 * width / length)), &between);
    if (st != TZ_OK || between.n < FEWEST)
        return st;
    for (int i = 0; i < 3; i++)
        d[i] = line.sum[i] / line.n;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            s[i][k] = line.square[i][k] / line.n - d[i] * d[k] +
                      between.square[i][k] / between.n + (i == k ? RIDGE : 0);
    if (!solve(s, d, w) || ratio(s, d, w) < BETTER * ratio(s, d, grey_of))
        return TZ_OK;
    for (int i = 0; i < 3; i++) {
        rise += w[i] * d[i];
        grey_rise += grey_of[i] * d[i];
    }
    if (!(fabs(rise) > 1e-9) || !(fabs(grey_rise) > 1e-9))
        return TZ_OK;
    for (ptrdiff_t p = 0; p < all; p++) {
        double v = 0;
        for (int i = 0; i < 3; i++)
            v += w[i] * (picture->v[i * all + p] - 50);
        grey[p] = (float)(50 + v * grey_rise / rise);
    }
    *changed = true;
    return TZ_OK;
}
