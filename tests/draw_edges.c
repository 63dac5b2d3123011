/* SPDX-License-Identifier: Apache-2.0 */
/* What edge detectors see in photos, side by side: one row a photo, with the photo, the
 * edges of each detector, and the edge groups of the analysis.
 *
 *   draw_edges [--model FILE] [--cell PX] [--quality 1..100] -o SHEET PHOTO...
 *
 * Large photos are scaled down, then the middle of each is shown, one cell of it. Every detector is shown
 * at one threshold for all photos, its own best. */
#include "analysis/ebpt.h"
#include "cli/font.h"
#include "tests/bench/bench.h"
#include "tests/bench/edge_detectors.h"

enum { GAP = 6, TITLE = 2 * TZ_FONT_HEIGHT + 4, SIDE = 512, NAME = 13 };

/* Of the detectors' variants those that edge_detectors.c marks as shown. The threshold is
 * that of the best F over the photos with boundaries drawn by hand: the last figure of
 *     bench_edges --all --model ... --truth tests/truth --photos ... */
static const struct {
    const char *family, *title;
    float threshold;
} detector[] = {
    {"forest", "forest", 0.30F},
    {"gradient", "gradient", 0.16F},
    {"canny", "Canny", 0.50F},
    {"edge-drawing", "EdgeDrawing", 0.43F},
};
enum { DETECTORS = sizeof detector / sizeof *detector, COLUMNS = DETECTORS + 2 };

typedef struct options {
    const char *model, *out;
    int32_t cell, quality;
    int32_t first; /* argument: the first photo */
} options;

/* The part of a photo that a row shows, and where. */
typedef struct row {
    tz_ctx *ctx;
    tz_image *sheet;
    tz_image photo; /* sRGB, 3 channels, dense */
    int32_t left, top, cell;
    int32_t y;
} row;

/* ---- photo --------------------------------------------------------------------------- */

/* Means of n x n pixels, in linear light. */
static tz_image reduced(tz_ctx *ctx, tz_image *im, int32_t n)
{
    tz_image out;
    bench_check(ctx, tz_image_init(ctx, &out, im->width / n, im->height / n, 3));
    bench_check(ctx, tz_image_convert(ctx, im, TZ_ENCODING_LINEAR));
    out.encoding = TZ_ENCODING_LINEAR;
    for (int32_t y = 0; y < out.height; y++)
        for (int32_t x = 0; x < out.width; x++)
            for (int32_t c = 0; c < 3; c++) {
                float sum = 0;
                for (int32_t k = 0; k < n * n; k++)
                    sum += tz_image_at(im, n * x + k % n, n * y + k / n)[c];
                tz_image_at(&out, x, y)[c] = sum / (float)(n * n);
            }
    bench_check(ctx, tz_image_convert(ctx, &out, TZ_ENCODING_SRGB));
    return out;
}

static tz_image read_photo(tz_ctx *ctx, const char *path)
{
    tz_image im = bench_photo(ctx, path, 3), out;
    const int32_t longest = im.width > im.height ? im.width : im.height;
    out = reduced(ctx, &im, longest >= SIDE ? longest / SIDE : 1);
    tz_image_deinit(&im);
    return out;
}

/* ---- cells --------------------------------------------------------------------------- */

/* Pixel of a cell that shows pixel (x, y) of the photo; NULL outside the cell. */
static float *spot(const row *r, int32_t column, int32_t x, int32_t y)
{
    x -= r->left;
    y -= r->top;
    if (x < 0 || y < 0 || x >= r->cell || y >= r->cell)
        return NULL;
    return tz_image_at(r->sheet, GAP + column * (r->cell + GAP) + x, r->y + y);
}

static void put(const row *r, int32_t column, int32_t x, int32_t y, const float rgb[3])
{
    float *p = spot(r, column, x, y);
    if (p)
        memcpy(p, rgb, 3 * sizeof *p);
}

static void draw_photo(const row *r, const char *path)
{
    char name[32];
    const char *slash = strrchr(path, '/');
    const float white[3] = {1, 1, 1};
    for (int32_t y = 0; y < r->photo.height; y++)
        for (int32_t x = 0; x < r->photo.width; x++)
            put(r, 0, x, y, tz_image_at(&r->photo, x, y));
    path = slash ? slash + 1 : path;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(path, "."), path);
    const int32_t width = (int32_t)strlen(name) * TZ_FONT_WIDTH + 5;
    for (int32_t y = r->cell - NAME; y < r->cell; y++)
        for (int32_t x = 0; x < width; x++)
            put(r, 0, r->left + x, r->top + y, white);
    tz_font_draw(r->sheet, GAP + 3, r->y + r->cell - NAME + 3, 1, 0, name);
}

static void draw_detector(const row *r, int32_t k, const char *model)
{
    const int32_t w = r->photo.width, h = r->photo.height;
    const edge_input in = {
        .photo = &r->photo, .dense = {r->photo.px, w, h}, .model = model};
    const float ink[3] = {0.08F, 0.08F, 0.1F};
    const edge_detector *e = edge_detectors;
    double seconds;
    float *strength = NULL;
    while (strcmp(e->family, detector[k].family) != 0 || !e->shown)
        e++;
    bench_check(r->ctx, tz_alloc(r->ctx, &strength, (size_t)w * h, sizeof *strength));
    bench_check(r->ctx, e->detect(r->ctx, &in, e->setting, strength, &seconds));
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++)
            if (strength[(size_t)y * w + x] >= detector[k].threshold)
                put(r, k + 1, x, y, ink);
    tz_free(r->ctx, strength);
}

/* Hues a golden angle apart: the groups' colours in the exemplar documents. */
static void colour_of(int32_t id, float rgb[3])
{
    const double hue = fmod(id * 0.61803398874989485, 1) * 6;
    for (int32_t c = 0; c < 3; c++) {
        const double d = fabs(fmod(hue - 2 * c + 9, 6) - 3); /* from the channel's own */
        rgb[c] = (float)(0.15 + 0.7 * fmin(1, fmax(0, 2 - d)));
    }
}

/* Whether a pixel's right or lower neighbour belongs to another group. */
static bool outlines(const tz_ebpt *e, int32_t x, int32_t y)
{
    const int32_t *p = e->label + (size_t)y * e->width + x;
    return (x + 1 < e->width && p[1] != *p) || (y + 1 < e->height && p[e->width] != *p);
}

static void draw_groups(const row *r, const tz_ebpt *e)
{
    for (int32_t y = 0; y < e->height; y++)
        for (int32_t x = 0; x < e->width; x++) {
            const float *p = tz_image_at(&r->photo, x, y);
            const float grey = 0.3F * p[0] + 0.6F * p[1] + 0.1F * p[2];
            float rgb[3];
            colour_of(e->label[(size_t)y * e->width + x], rgb);
            const float own = outlines(e, x, y) ? 1 : 0.3F;
            for (int32_t c = 0; c < 3; c++)
                rgb[c] = own * rgb[c] + (1 - own) * (0.45F + 0.55F * grey);
            put(r, COLUMNS - 1, x, y, rgb);
        }
}

static void draw_chains(const row *r, const tz_ebpt *e)
{
    static const int32_t dx[] = {1, 1, 0, -1, -1, -1, 0, 1};
    static const int32_t dy[] = {0, -1, -1, -1, 0, 1, 1, 1};
    const float ink[3] = {0.05F, 0.05F, 0.05F};
    for (int32_t i = 0; i < e->edge.n; i++) {
        const tz_edge *d = &e->edge.v[i];
        int32_t x = d->x, y = d->y;
        put(r, COLUMNS - 1, x, y, ink);
        for (int32_t k = 0; k < d->length; k++) {
            x += dx[e->code.v[d->code + k]];
            y += dy[e->code.v[d->code + k]];
            put(r, COLUMNS - 1, x, y, ink);
        }
    }
}

static void draw_row(row *r, const char *path, const char *model)
{
    tz_ebpt_params p;
    tz_ebpt e;
    r->photo = read_photo(r->ctx, path);
    r->left = (r->photo.width - r->cell) / 2;
    r->top = (r->photo.height - r->cell) / 2;
    draw_photo(r, path);
    for (int32_t k = 0; k < DETECTORS; k++)
        draw_detector(r, k, model);
    tz_params_default(&tz_ebpt_param_table, &p);
    p.edges = TZ_EDGES_FOREST;
    snprintf(p.model, sizeof p.model, "%s", model);
    bench_check(r->ctx, tz_ebpt_analyze(r->ctx, &r->photo, &p, &e));
    draw_groups(r, &e);
    draw_chains(r, &e);
    tz_ebpt_deinit(&e);
    tz_image_deinit(&r->photo);
}

/* ---- sheet --------------------------------------------------------------------------- */

static tz_image new_sheet(tz_ctx *ctx, int32_t cell, int32_t rows)
{
    const int32_t step = cell + GAP;
    tz_image sheet;
    bench_check(ctx, tz_image_init(ctx, &sheet, COLUMNS * step + GAP,
                                   TITLE + rows * step + GAP, 3));
    sheet.encoding = TZ_ENCODING_SRGB;
    for (int32_t y = 0; y < sheet.height; y++)
        for (int32_t x = 0; x < sheet.width; x++)
            for (int32_t c = 0; c < 3; c++)
                tz_image_at(&sheet, x, y)[c] =
                    y < TITLE || (y - TITLE) % step < GAP || x % step < GAP ? 0.85F : 1;
    for (int32_t k = 0; k < COLUMNS; k++)
        tz_font_draw(&sheet, GAP + k * step, 5, 2, 0,
                     k == 0           ? "photo"
                     : k <= DETECTORS ? detector[k - 1].title
                                      : "edge groups");
    return sheet;
}

static options read_options(int argc, char **argv)
{
    options o = {.model = "", .cell = 256, .quality = 85, .first = 1};
    for (; o.first + 1 < argc && argv[o.first][0] == '-'; o.first += 2) {
        const char *name = argv[o.first], *value = argv[o.first + 1];
        if (strcmp(name, "--model") == 0)
            o.model = value;
        else if (strcmp(name, "--quality") == 0)
            o.quality = atoi(value);
        else if (strcmp(name, "--cell") == 0)
            o.cell = atoi(value);
        else if (strcmp(name, "-o") == 0)
            o.out = value;
        else
            o.out = NULL, o.first = argc;
    }
    if (!o.out || o.first >= argc || o.cell < 64 || o.cell > 4096) {
        fprintf(stderr,
                "use: draw_edges [--model FILE] [--cell 64..4096] [--quality 1..100] "
                "-o SHEET PHOTO...\n");
        exit(2);
    }
    return o;
}

int main(int argc, char **argv)
{
    const options o = read_options(argc, argv);
    tz_ctx *ctx = bench_ctx(0);
    tz_image sheet = new_sheet(ctx, o.cell, argc - o.first);
    row r = {.ctx = ctx, .sheet = &sheet, .cell = o.cell};
    for (int32_t i = o.first; i < argc; i++) {
        r.y = TITLE + GAP + (i - o.first) * (o.cell + GAP);
        draw_row(&r, argv[i], o.model);
    }
    const tz_image_write_options write = {.compression = 9, .quality = o.quality};
    bench_check(ctx, tz_image_write(ctx, o.out, &sheet, &write));
    tz_image_deinit(&sheet);
    tz_ctx_free(ctx);
    return 0;
}
