/* SPDX-License-Identifier: Apache-2.0 */
/* Draws data/exemplars/: stones, bricks and cracked mud, as exemplars for places where no
 * photos can be had. Stones and mud are Voronoi cells, told apart by the distance to the
 * nearest border of two cells; bricks are a wobbling running bond. All are shaded as a
 * height field under a light from the upper left.
 *
 *   draw_exemplars FOLDER [SIDE]        (default side 256 px) */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/image_io.h"
#include "base/rng.h"

static double clamp(double x, double lo, double hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}

/* ---- value noise ----------------------------------------------------------------------
 */

static double lattice(uint64_t seed, int64_t x, int64_t y)
{
    tz_rng r =
        tz_rng_make(seed, tz_rng_stream(1, (uint64_t)(x + 5000), (uint64_t)(y + 5000)));
    return tz_rng_unit(&r);
}

static double noise(uint64_t seed, double x, double y)
{
    double fx = floor(x), fy = floor(y), u = x - fx, v = y - fy;
    int64_t i = (int64_t)fx, j = (int64_t)fy;
    u = u * u * (3 - 2 * u);
    v = v * v * (3 - 2 * v);
    double top = lattice(seed, i, j) * (1 - u) + lattice(seed, i + 1, j) * u;
    double low = lattice(seed, i, j + 1) * (1 - u) + lattice(seed, i + 1, j + 1) * u;
    return top * (1 - v) + low * v;
}

/* Four octaves, 0..1. */
static double cloud(uint64_t seed, double x, double y)
{
    double sum = 0, weight = 0.5;
    for (int o = 0; o < 4; o++, weight /= 2, x *= 2, y *= 2)
        sum += weight * noise(seed + (uint64_t)o, x, y);
    return sum / 0.9375;
}

/* ---- cells ----------------------------------------------------------------------------
 */

/* Cell number at a point of a jittered grid, and the distance to the nearest border. */
static uint64_t cell_at(uint64_t seed, double x, double y, double *border)
{
    double best = 1e9, px = 0, py = 0;
    uint64_t id = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int64_t j = (int64_t)floor(y) - 2; j <= (int64_t)floor(y) + 2; j++)
            for (int64_t i = (int64_t)floor(x) - 2; i <= (int64_t)floor(x) + 2; i++) {
                uint64_t own =
                    tz_rng_stream(2, (uint64_t)(i + 5000), (uint64_t)(j + 5000));
                tz_rng r = tz_rng_make(seed, own);
                double qx = (double)i + tz_rng_range(&r, 0.1, 0.9);
                double qy = (double)j + tz_rng_range(&r, 0.1, 0.9);
                if (pass == 0) {
                    double d = (qx - x) * (qx - x) + (qy - y) * (qy - y);
                    if (d < best)
                        best = d, id = own, px = qx, py = qy;
                } else if (own != id) {
                    double nx = qx - px, ny = qy - py, length = hypot(nx, ny);
                    double d = ((px + qx) / 2 - x) * nx / length +
                               ((py + qy) / 2 - y) * ny / length;
                    *border = d < *border ? d : *border;
                }
            }
    return id;
}

/* ---- the three materials
 * --------------------------------------------------------------- */

/* Height 0..1 and colour without light at a point, both in px. */
typedef double (*material)(double x, double y, double colour[3]);

static void mix(double colour[3], double r, double g, double b, double share)
{
    const double c[3] = {r, g, b};
    for (int i = 0; i < 3; i++)
        colour[i] += share * (c[i] - colour[i]);
}

static double stones(double x, double y, double colour[3])
{
    double wx = x + 9 * cloud(11, x / 24, y / 24), wy = y + 9 * cloud(12, x / 24, y / 24);
    double border = 1e9;
    uint64_t id = cell_at(3, wx / 34, wy / 34, &border);
    tz_rng r = tz_rng_make(4, id);
    double tone = tz_rng_range(&r, 0.34, 0.7), warm = tz_rng_range(&r, -0.04, 0.07);
    double grain = cloud(13, x / 5, y / 5), edge = clamp((border - 0.05) / 0.14, 0, 1);
    colour[0] = tone + warm;
    colour[1] = tone;
    colour[2] = tone - warm;
    mix(colour, 0.25, 0.24, 0.22, 0.35 * grain);
    mix(colour, 0.12, 0.10, 0.08, 1 - edge);
    return sqrt(1 - (1 - edge) * (1 - edge)) + 0.16 * grain;
}

static double bricks(double x, double y, double colour[3])
{
    double wx = x + 3 * cloud(21, x / 18, y / 18), wy = y + 3 * cloud(22, x / 18, y / 18);
    int64_t row = (int64_t)floor(wy / 24);
    double ax = wx / 56 + 0.5 * (double)(row & 1), fx = ax - floor(ax),
           fy = wy / 24 - (double)row;
    double border = fmin(fmin(fx, 1 - fx) * 56, fmin(fy, 1 - fy) * 24);
    tz_rng r =
        tz_rng_make(5, tz_rng_stream(3, (uint64_t)(int64_t)floor(ax), (uint64_t)row));
    double tone = tz_rng_range(&r, 0.75, 1.15), grain = cloud(23, x / 4, y / 4);
    double edge = clamp((border - 1.6) / 1.8, 0, 1);
    colour[0] = 0.50 * tone;
    colour[1] = 0.23 * tone;
    colour[2] = 0.17 * tone;
    mix(colour, 0.22, 0.12, 0.10, 0.45 * grain);
    mix(colour, 0.55, 0.52, 0.47, (1 - edge) * (0.8 + 0.2 * grain));
    return edge + 0.2 * grain;
}

static double mud(double x, double y, double colour[3])
{
    double wx = x + 14 * cloud(31, x / 20, y / 20),
           wy = y + 14 * cloud(32, x / 20, y / 20);
    double large = 1e9, small = 1e9;
    cell_at(6, wx / 58, wy / 58, &large);
    cell_at(7, wx / 23, wy / 23, &small);
    double grain = cloud(33, x / 7, y / 7), broad = cloud(34, x / 60, y / 60);
    double edge =
        fmin(clamp(large * 58 / 3.4, 0, 1), 0.45 + clamp(small * 23 / 1.6, 0, 0.55));
    colour[0] = 0.46 + 0.16 * broad;
    colour[1] = 0.36 + 0.12 * broad;
    colour[2] = 0.26 + 0.07 * broad;
    mix(colour, 0.30, 0.23, 0.17, 0.4 * grain);
    mix(colour, 0.07, 0.05, 0.04, 1 - edge);
    return edge + 0.15 * grain;
}

/* ---- pictures -------------------------------------------------------------------------
 */

static tz_status draw(tz_ctx *ctx, const char *folder, const char *name, material at,
                      int32_t n)
{
    tz_image im = {0};
    char path[4096];
    tz_status s = tz_image_init(ctx, &im, n, n, 3);
    if (s != TZ_OK)
        return s;
    im.encoding = TZ_ENCODING_SRGB;
    im.depth = 8;
    for (int32_t y = 0; y < n; y++)
        for (int32_t x = 0; x < n; x++) {
            double colour[3], side[3];
            double h = at(x, y, colour), dx = at(x + 1, y, side) - h,
                   dy = at(x, y + 1, side) - h;
            double light = clamp(1 + 1.6 * (dx + dy), 0.35, 1.6);
            for (int c = 0; c < 3; c++) /* 6 bits a channel keep the file small */
                tz_image_at(&im, x, y)[c] =
                    (float)(floor(clamp(colour[c] * light, 0, 1) * 63 + 0.5) / 63);
        }
    snprintf(path, sizeof path, "%s/%s.png", folder, name);
    const tz_image_write_options opt = {.compression = 9};
    s = tz_image_write(ctx, path, &im, &opt);
    tz_image_deinit(&im);
    return s;
}

int main(int argc, char **argv)
{
    tz_ctx *ctx = NULL;
    int32_t n = argc > 2 ? atoi(argv[2]) : 256;
    if (argc < 2 || n < 16 || n > 4096) {
        fprintf(stderr, "use: draw_exemplars FOLDER [SIDE 16..4096]\n");
        return 2;
    }
    tz_status s = tz_ctx_new(NULL, &ctx);
    if (s == TZ_OK)
        s = draw(ctx, argv[1], "stones", stones, n);
    if (s == TZ_OK)
        s = draw(ctx, argv[1], "bricks", bricks, n);
    if (s == TZ_OK)
        s = draw(ctx, argv[1], "mud", mud, n);
    if (s != TZ_OK)
        fprintf(stderr, "draw_exemplars: %s\n", tz_ctx_message(ctx));
    tz_ctx_free(ctx);
    return s == TZ_OK ? 0 : 1;
}
