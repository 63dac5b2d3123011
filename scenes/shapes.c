/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/shapes.h"

#include <assert.h>
#include <string.h>

/* ---- small numbers, colour --------------------------------------------------------- */

/* Finalizer of splitmix64: cheap enough for once a pixel, where tz_rng is not. */
static uint64_t mix64(uint64_t z)
{
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

double tz_shape_unit(uint64_t seed, int64_t a, int64_t b)
{
    uint64_t z = mix64(seed + UINT64_C(0x9e3779b97f4a7c15) * (uint64_t)(a + 1));
    z = mix64(z + UINT64_C(0xd1b54a32d192ed03) * (uint64_t)(b + 1));
    return (double)(z >> 11) * 0x1p-53;
}

void tz_shape_tint(tz_canvas *c, int64_t i, const float colour[3], double share)
{
    int64_t plane = (int64_t)c->width * c->height;
    for (int k = 0; k < 3; k++) {
        float *a = &c->albedo[k * plane + i];
        *a += (float)share * (colour[k] - *a);
    }
}

void tz_shape_dim(tz_canvas *c, int64_t i, double factor)
{
    int64_t plane = (int64_t)c->width * c->height;
    for (int k = 0; k < 3; k++)
        c->albedo[k * plane + i] =
            (float)fmin(1, fmax(0, c->albedo[k * plane + i] * factor));
}

void tz_shape_joint(tz_canvas *c, int64_t i, double edge, double half,
                    const float colour[3], double share)
{
    if (edge < half + 1.5)
        tz_shape_tint(c, i, colour,
                      share * (1 - tz_shape_ramp(half - 1, half + 1.5, edge)));
}

static double luminance(const float c[3])
{
    return 0.2126 * (double)c[0] + 0.7152 * (double)c[1] + 0.0722 * (double)c[2];
}

void tz_shape_part(float colour[3], const float other[3], double least)
{
    double a = luminance(colour) + 1e-3, b = luminance(other) + 1e-3;
    double ratio = log(a / b);
    if (fabs(ratio) >= least)
        return;
    bool up = ratio > 0;
    if (up && b * exp(least) > 0.8)
        up = false;
    if (!up && b * exp(-least) < 0.006)
        up = true;
    double factor = b * exp(up ? least : -least) / a;
    for (int k = 0; k < 3; k++)
        colour[k] = (float)fmin(0.92, fmax(0.004, (double)colour[k] * factor));
}

void tz_shape_crack(tz_canvas *c, int64_t i, uint64_t seed, tz_vec2 q, tz_vec2 wave,
                    double open, const float colour[3])
{
    if (open <= 0)
        return;
    double u = q.x / wave.x, v = q.y / wave.y, du = 1 / wave.x, dv = 1 / wave.y;
    double n = (double)tz_canvas_fbm(seed, u, v, 3, 0.45);
    if (fabs(n) > 8 * (du + dv))
        return;
    double nx = (double)tz_canvas_fbm(seed, u + du, v, 3, 0.45);
    double ny = (double)tz_canvas_fbm(seed, u, v + dv, 3, 0.45);
    double gx = nx - n, gy = ny - n;
    double edge = fabs(n) / fmax(sqrt(gx * gx + gy * gy), 0.15 * (du + dv));
    double half = 0.4 + 2 * open;
    tz_shape_joint(c, i, edge, half, colour, fmin(1, 1.5 * open));
    if (edge < half)
        c->relief[i] -= (float)(3 * open);
    if ((n * nx <= 0 || n * ny <= 0) && open > 0.3)
        c->line[i] = 1;
}

/* ---- things ------------------------------------------------------------------------ */

tz_status tz_shape_things_init(tz_canvas *c, int32_t n, tz_shape_things *t)
{
    *t = (tz_shape_things){0};
    tz_status s = tz_alloc_zero(c->ctx, &t->v, (size_t)n, sizeof *t->v);
    if (s != TZ_OK)
        return s;
    t->n = n;
    for (int32_t i = 0; i < n; i++)
        t->v[i].element = true, t->v[i].depth = 1;
    return TZ_OK;
}

void tz_shape_things_deinit(tz_canvas *c, tz_shape_things *t)
{
    tz_free(c->ctx, t->v);
    *t = (tz_shape_things){0};
}

void tz_shape_things_count(const tz_canvas *c, tz_shape_things *t)
{
    for (int32_t i = 0; i < t->n; i++)
        t->v[i].seen = 0;
    for (int64_t i = 0, n = (int64_t)c->width * c->height; i < n; i++) {
        assert(c->segment[i] >= 0 && c->segment[i] < t->n);
        t->v[c->segment[i]].seen++;
    }
}

tz_status tz_shape_things_commit(tz_canvas *c, const tz_shape_things *t)
{
    int32_t *id = NULL;
    tz_status s = tz_alloc(c->ctx, &id, (size_t)t->n, sizeof *id);
    for (int32_t i = 0; i < t->n && s == TZ_OK; i++) {
        const tz_shape_thing *v = &t->v[i];
        if (v->seen == 0)
            continue;
        s = tz_canvas_add_piece(c, v->element, v->depth, &id[i]);
        if (s == TZ_OK && v->whole > 0)
            c->piece.v[id[i]].whole = v->whole > v->seen ? v->whole : v->seen;
    }
    for (int64_t i = 0, n = (int64_t)c->width * c->height; i < n && s == TZ_OK; i++)
        c->segment[i] = id[c->segment[i]];
    tz_free(c->ctx, id);
    return s;
}

/* ---- bent planes ------------------------------------------------------------------- */

enum { BEND_STEP = 4 };

tz_shape_bend_def tz_shape_bend_draw(tz_rng *r, double spread, double size)
{
    tz_shape_bend_def d = {0};
    d.angle = tz_rng_normal(r) * spread;
    d.octaves = 1 + tz_rng_below(r, 3);
    d.warp_size = size * tz_shape_log_range(r, 1, 8);
    d.warp = d.warp_size * tz_shape_log_range(r, 0.01, 0.16);
    if (tz_shape_chance(r, 0.25))
        d.tilt = tz_rng_range(r, -0.5, 0.5);
    return d;
}

/* The pattern at a point of the canvas: the slant first, as a plane's photo has it, then
 * the turn, the circle and the warp. */
static tz_vec2 bend_exact(const tz_canvas *c, uint64_t seed, const tz_shape_bend_def *d,
                          double x, double y)
{
    double side = c->width > c->height ? c->width : c->height;
    double px = x - 0.5 * c->width, py = y - 0.5 * c->height;
    double scale = 1 / (1 - d->tilt * py / side);
    px *= scale, py *= scale;
    double co = cos(d->angle), si = sin(d->angle);
    double qx = co * px + si * py, qy = -si * px + co * py;
    if (d->radius > 0) {
        double rho = hypot(qx, qy + d->radius);
        qx = atan2(qx, qy + d->radius) * d->radius;
        qy = rho - d->radius;
    }
    if (d->warp > 0) {
        double f = 1 / d->warp_size;
        double wx =
            d->warp * (double)tz_canvas_fbm(seed, qx * f, qy * f, d->octaves, 0.5);
        double wy =
            d->warp * (double)tz_canvas_fbm(seed + 71, qx * f, qy * f, d->octaves, 0.5);
        qx += wx, qy += wy;
    }
    return (tz_vec2){qx, qy};
}

tz_status tz_shape_bend_init(tz_canvas *c, uint64_t seed, const tz_shape_bend_def *def,
                             tz_shape_bend *b)
{
    *b = (tz_shape_bend){.cols = c->width / BEND_STEP + 2,
                         .rows = c->height / BEND_STEP + 2};
    tz_status s = tz_alloc(c->ctx, &b->node, (size_t)b->cols * (size_t)b->rows * 2,
                           sizeof *b->node);
    if (s != TZ_OK)
        return s;
    double lo[2] = {1e30, 1e30}, hi[2] = {-1e30, -1e30};
    for (int32_t j = 0; j < b->rows; j++)
        for (int32_t i = 0; i < b->cols; i++) {
            tz_vec2 q = bend_exact(c, seed, def, i * BEND_STEP, j * BEND_STEP);
            float *node = b->node + 2 * ((int64_t)j * b->cols + i);
            node[0] = (float)q.x;
            node[1] = (float)q.y;
            lo[0] = fmin(lo[0], q.x), hi[0] = fmax(hi[0], q.x);
            lo[1] = fmin(lo[1], q.y), hi[1] = fmax(hi[1], q.y);
        }
    b->box =
        (tz_rect){(int32_t)floor(lo[0]) - 8, (int32_t)floor(lo[1]) - 8,
                  (int32_t)ceil(hi[0] - lo[0]) + 17, (int32_t)ceil(hi[1] - lo[1]) + 17};
    return TZ_OK;
}

void tz_shape_bend_deinit(tz_canvas *c, tz_shape_bend *b)
{
    tz_free(c->ctx, b->node);
    *b = (tz_shape_bend){0};
}

tz_vec2 tz_shape_bend_at(const tz_shape_bend *b, double x, double y)
{
    double fx = x / BEND_STEP, fy = y / BEND_STEP;
    int32_t i = (int32_t)fx, j = (int32_t)fy;
    double u = fx - i, v = fy - j;
    const float *p = b->node + 2 * ((int64_t)j * b->cols + i),
                *q = p + 2 * (int64_t)b->cols;
    double a = (1 - u) * (1 - v), bb = u * (1 - v), cc = (1 - u) * v, dd = u * v;
    return (tz_vec2){
        a * (double)p[0] + bb * (double)p[2] + cc * (double)q[0] + dd * (double)q[2],
        a * (double)p[1] + bb * (double)p[3] + cc * (double)q[1] + dd * (double)q[3]};
}

/* ---- fields ------------------------------------------------------------------------ */

tz_status tz_shape_field_init(tz_canvas *c, uint64_t seed, double wave, int octaves,
                              tz_shape_field *f)
{
    int32_t rows = c->height / BEND_STEP + 2;
    *f = (tz_shape_field){.cols = c->width / BEND_STEP + 2};
    tz_status s =
        tz_alloc(c->ctx, &f->node, (size_t)f->cols * (size_t)rows, sizeof *f->node);
    for (int32_t i = 0; i < f->cols * rows && s == TZ_OK; i++)
        f->node[i] = tz_canvas_fbm(seed, i % f->cols * BEND_STEP / wave,
                                   i / f->cols * BEND_STEP / wave, octaves, 0.5);
    return s;
}

void tz_shape_field_deinit(tz_canvas *c, tz_shape_field *f)
{
    tz_free(c->ctx, f->node);
    *f = (tz_shape_field){0};
}

double tz_shape_field_at(const tz_shape_field *f, int32_t x, int32_t y)
{
    const float *p = f->node + (int64_t)(y / BEND_STEP) * f->cols + x / BEND_STEP;
    double u = (x % BEND_STEP + 0.5) / BEND_STEP, v = (y % BEND_STEP + 0.5) / BEND_STEP;
    double top = tz_shape_mix((double)p[0], (double)p[1], u);
    return tz_shape_mix(top, tz_shape_mix((double)p[f->cols], (double)p[f->cols + 1], u),
                        v);
}

/* ---- cells ------------------------------------------------------------------------- */

static int32_t find(int32_t *root, int32_t i)
{
    while (root[i] != i)
        i = root[i] = root[root[i]];
    return i;
}

/* Joins neighbours by chance, no union above the limit. */
static void join(tz_shape_cells *k, uint64_t seed, int32_t *size)
{
    for (int32_t i = 0; i < k->cols * k->rows; i++) {
        int32_t x = i % k->cols, y = i / k->cols;
        for (int way = 0; way < 2; way++) {
            if (way == 0 ? x + 1 == k->cols : y + 1 == k->rows)
                continue;
            if (tz_shape_unit(seed + 3, 2 * i + way, 0) >=
                (way == 0 ? k->def.join_x : k->def.join_y))
                continue;
            int32_t a = find(k->root, i),
                    b = find(k->root, way == 0 ? i + 1 : i + k->cols);
            if (a == b || size[a] + size[b] > k->def.join_most)
                continue;
            k->root[b] = a;
            size[a] += size[b];
        }
    }
    for (int32_t i = 0; i < k->cols * k->rows; i++)
        k->root[i] = find(k->root, i);
}

tz_status tz_shape_cells_init(tz_canvas *c, uint64_t seed, tz_rect box,
                              const tz_shape_cells_def *def, tz_shape_cells *cells)
{
    *cells = (tz_shape_cells){.def = *def};
    cells->cols = (int32_t)(box.w / def->pitch_x) + 7;
    cells->rows = (int32_t)(box.h / def->pitch_y) + 7;
    cells->x = box.x - 3 * def->pitch_x;
    cells->y = box.y - 3 * def->pitch_y;
    int32_t n = cells->cols * cells->rows, *size = NULL;
    tz_status s = tz_alloc(c->ctx, &cells->point, (size_t)n * 2, sizeof *cells->point);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &cells->root, (size_t)n, sizeof *cells->root);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &size, (size_t)n, sizeof *size);
    if (s != TZ_OK)
        goto done;
    for (int32_t i = 0; i < n; i++) {
        int32_t x = i % cells->cols, y = i / cells->cols;
        double shift = def->hex && (y & 1) ? 0.25 : def->hex ? -0.25 : 0;
        cells->point[2 * i] =
            (float)(x + 0.5 + shift + def->jitter * (tz_shape_unit(seed, i, 1) - 0.5));
        cells->point[2 * i + 1] =
            (float)(y + 0.5 + def->jitter * (tz_shape_unit(seed, i, 2) - 0.5));
        cells->root[i] = i;
        size[i] = 1;
    }
    join(cells, seed, size);
done:
    tz_free(c->ctx, size);
    if (s != TZ_OK)
        tz_shape_cells_deinit(c, cells);
    return s;
}

void tz_shape_cells_deinit(tz_canvas *c, tz_shape_cells *cells)
{
    tz_free(c->ctx, cells->point);
    tz_free(c->ctx, cells->root);
    *cells = (tz_shape_cells){0};
}

static int32_t clamp_index(int32_t i, int32_t lo, int32_t hi)
{
    return i < lo ? lo : i > hi ? hi : i;
}

/* The border of two cells is the bisector of their points p and q:
 *   (|x - q|^2 - |x - p|^2) / 2 = 0,  gradient p - q,
 * and the first divided by the length of the second, taken in pixels, is the distance. */
tz_shape_cell tz_shape_cells_at(const tz_shape_cells *k, double x, double y)
{
    double ax = (x - k->x) / k->def.pitch_x, ay = (y - k->y) / k->def.pitch_y;
    int32_t cx = clamp_index((int32_t)ax, 2, k->cols - 3);
    int32_t cy = clamp_index((int32_t)ay, 2, k->rows - 3);
    int32_t at[25], near = 0;
    float d2[25], fx = (float)ax, fy = (float)ay;
    for (int m = 0; m < 25; m++) {
        at[m] = (cy + m / 5 - 2) * k->cols + cx + m % 5 - 2;
        float dx = k->point[2 * at[m]] - fx, dy = k->point[2 * at[m] + 1] - fy;
        d2[m] = dx * dx + dy * dy;
    }
    for (int m = 1; m < 25; m++)
        if (d2[m] < d2[near])
            near = m;
    tz_shape_cell hit = {.cell = at[near], .root = k->root[at[near]], .edge = 1e9};
    hit.other = hit.root;
    const float *p = k->point + 2 * at[near];
    float stretch_x = (float)(1 / k->def.pitch_x),
          stretch_y = (float)(1 / k->def.pitch_y);
    /* no two of the points are further apart than six pitches either way */
    float longest = 8.5f * (stretch_x > stretch_y ? stretch_x : stretch_y), reach = 1e9f;
    for (int m = 0; m < 25; m++) {
        float twice = d2[m] - d2[near];
        if (twice > reach || k->root[at[m]] == hit.root)
            continue;
        const float *q = k->point + 2 * at[m];
        float gx = (q[0] - p[0]) * stretch_x, gy = (q[1] - p[1]) * stretch_y;
        float g = sqrtf(gx * gx + gy * gy), edge = 0.5f * twice / g;
        if ((double)edge >= hit.edge)
            continue;
        hit.edge = (double)edge;
        hit.other = k->root[at[m]];
        hit.dx = (double)(gx / g), hit.dy = (double)(gy / g);
        reach = 2 * edge * longest;
    }
    return hit;
}
