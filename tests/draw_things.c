/* SPDX-License-Identifier: Apache-2.0 */
/* The things of photos, side by side: one row a photo, with the photo, the outlines of
 * its things coloured by class (cut ones thin, by depth from dark to bright), and the
 * plate.
 *
 *   draw_things [--side PX] [--svg FOLDER] [--crop X,Y,SIDE] [--cutouts WHICH] -o SHEET
 *               PHOTO...
 *
 * Photos are scaled down by a whole number to at most --side px (default 1024). --svg
 * writes the set, the photo and the plate of each photo into a folder. --cutouts copied,
 * cut or all shows each such thing by itself on magenta instead, in rows. */
#include <math.h>

#include "analysis/things.h"
#include "elements/element_io.h"
#include "tests/bench/bench.h"

enum { GAP = 6 };

typedef struct options {
    const char *out, *svg, *cutouts;
    int32_t side, crop[3], first;
    tz_things_params params;
} options;

/* Means of n x n pixels, of the encoded values. */
static tz_image reduced(tz_ctx *ctx, const tz_image *im, int32_t n)
{
    tz_image out;
    bench_check(ctx, tz_image_init(ctx, &out, im->width / n, im->height / n, 3));
    out.encoding = im->encoding;
    for (int32_t y = 0; y < out.height; y++)
        for (int32_t x = 0; x < out.width; x++)
            for (int32_t c = 0; c < 3; c++) {
                float sum = 0;
                for (int32_t k = 0; k < n * n; k++)
                    sum += tz_image_at(im, n * x + k % n, n * y + k / n)[c];
                tz_image_at(&out, x, y)[c] = sum / (float)(n * n);
            }
    return out;
}

static void colour_of(int32_t kind, int32_t depth, float rgb[3])
{
    const double hue = fmod(0.1 + kind * 0.61803398874989485, 1) * 6;
    for (int32_t c = 0; c < 3; c++) {
        const double d = fabs(fmod(hue - 2 * c + 9, 6) - 3);
        rgb[c] = (float)((0.1 + 0.9 * fmin(1, fmax(0, 2 - d))) *
                         (0.6 + 0.1 * (depth < 4 ? depth : 4)));
    }
}

static void put(tz_image *im, double x, double y, const float rgb[3], float share)
{
    const int32_t px = (int32_t)floor(x), py = (int32_t)floor(y);
    if (px < 0 || py < 0 || px >= im->width || py >= im->height)
        return;
    for (int32_t c = 0; c < 3; c++) {
        float *p = tz_image_at(im, px, py) + c;
        *p += share * (rgb[c] - *p);
    }
}

static void draw_outline(tz_image *im, const tz_element_set *s, const tz_element *e)
{
    const tz_element_symbol *y = &s->symbol.v[e->symbol];
    float rgb[3];
    colour_of(e->kind, e->depth, rgb);
    for (int32_t k = 0; k < y->part.n; k++) {
        const int32_t first = y->part.v[k],
                      end = k + 1 < y->part.n ? y->part.v[k + 1] : y->outline.n;
        for (int32_t i = first; i < end; i++) {
            const tz_vec2 a = y->outline.v[i],
                          b = y->outline.v[i + 1 < end ? i + 1 : first];
            const int32_t n = (int32_t)(tz_vec2_length(tz_vec2_sub(b, a)) * 2) + 1;
            for (int32_t j = 0; j < n; j++) {
                const double t = (double)j / n;
                put(im, e->at.x + a.x + t * (b.x - a.x), e->at.y + a.y + t * (b.y - a.y),
                    rgb, tz_element_may_copy(e) ? 1 : 0.6F);
            }
        }
    }
    for (int32_t k = 0; k < e->samples; k++)
        put(im, s->sample.v[e->sample + k].at.x, s->sample.v[e->sample + k].at.y, rgb, 1);
}

/* ---- cut-outs ------------------------------------------------------------------------ */

/* Boxes of the things that are seen in a label map. */
static tz_rect *boxes_of(tz_ctx *ctx, const int32_t *label, int32_t w, int32_t h,
                         int32_t count)
{
    tz_rect *b;
    bench_check(ctx, tz_alloc_zero(ctx, &b, (size_t)count + 1, sizeof *b));
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            const int32_t l = label[(ptrdiff_t)y * w + x];
            if (l < 0)
                continue;
            if (!b[l].w)
                b[l] = (tz_rect){x, y, 1, 1};
            if (x < b[l].x)
                b[l].w += b[l].x - x, b[l].x = x;
            b[l].w = x - b[l].x + 1 > b[l].w ? x - b[l].x + 1 : b[l].w;
            b[l].h = y - b[l].y + 1; /* rows rise */
        }
    return b;
}

/* Things one behind another, in rows as wide as the photo;
 * without a sheet they are only measured.
 * @return height */
static int32_t lay_out(const tz_image *photo, const int32_t *label, const tz_rect *box,
                       const uint8_t *shown, int32_t count, tz_image *sheet)
{
    int32_t x0 = 0, y0 = 0, tall = 0;
    for (int32_t i = 0; i < count; i++) {
        const tz_rect b = box[i];
        if (!shown[i])
            continue;
        if (x0 > 0 && x0 + b.w > photo->width)
            x0 = 0, y0 += tall + 4, tall = 0;
        tall = b.h > tall ? b.h : tall;
        for (int32_t y = 0; y < b.h && sheet; y++)
            for (int32_t x = 0; x < b.w; x++)
                if (label[(ptrdiff_t)(b.y + y) * photo->width + b.x + x] == i)
                    memcpy(tz_image_at(sheet, x0 + x, y0 + y),
                           tz_image_at(photo, b.x + x, b.y + y), 3 * sizeof(float));
        x0 += b.w + 4;
    }
    return y0 + tall;
}

static tz_image draw_cutouts(tz_ctx *ctx, const tz_image *photo, const tz_element_set *s,
                             const int32_t *label, const char *which)
{
    const int32_t n = s->element.n;
    tz_rect *box = boxes_of(ctx, label, photo->width, photo->height, n);
    tz_image sheet;
    uint8_t *shown;
    bench_check(ctx, tz_alloc_zero(ctx, &shown, (size_t)n + 1, 1));
    for (int32_t i = 0; i < n; i++)
        shown[i] = strcmp(which, "all") == 0 ||
                   tz_element_may_copy(&s->element.v[i]) == (strcmp(which, "cut") != 0);
    const int32_t h = lay_out(photo, label, box, shown, n, NULL);
    bench_check(ctx, tz_image_init(ctx, &sheet, photo->width, h + GAP, 3));
    sheet.encoding = TZ_ENCODING_SRGB;
    for (int64_t k = 0; k < (int64_t)sheet.width * sheet.height; k++)
        sheet.px[3 * k] = sheet.px[3 * k + 2] = 0.8F;
    lay_out(photo, label, box, shown, n, &sheet);
    tz_free(ctx, shown);
    tz_free(ctx, box);
    return sheet;
}

/* ---- sheet --------------------------------------------------------------------------- */

static void paste(tz_image *sheet, const tz_image *im, int32_t x0, int32_t y0)
{
    for (int32_t y = 0; y < im->height; y++)
        for (int32_t x = 0; x < im->width; x++)
            for (int32_t c = 0; c < 3; c++)
                tz_image_at(sheet, x0 + x, y0 + y)[c] =
                    tz_image_at(im, x, y)[im->channels >= 3 ? c : 0];
}

static void write_set(tz_ctx *ctx, const options *o, const char *path,
                      const tz_image *photo, const tz_image *plate, tz_element_set *s)
{
    const tz_image_write_options write = {.compression = -1};
    const char *slash = strrchr(path, '/');
    char name[4][512];
    path = slash ? slash + 1 : path;
    const int n = (int)strcspn(path, ".");
    snprintf(name[0], sizeof name[0], "%s/%.*s.png", o->svg, n, path);
    snprintf(name[1], sizeof name[1], "%s/%.*s-plate.png", o->svg, n, path);
    snprintf(name[2], sizeof name[2], "%s/%.*s.svg", o->svg, n, path);
    bench_check(ctx, tz_image_write(ctx, name[0], photo, &write));
    bench_check(ctx, tz_image_write(ctx, name[1], plate, &write));
    bench_check(ctx, tz_things_name_photo(s, name[0], NULL, name[1]));
    if (s->element.n > 0)
        bench_check(ctx, tz_element_write_svg(ctx, name[2], s));
}

/* One row: three pictures side by side, the sheet made larger by it. */
static tz_image draw_row(tz_ctx *ctx, const options *o, const char *path)
{
    tz_image full = bench_photo(ctx, path, 3), plate, row;
    const int32_t longest = full.width > full.height ? full.width : full.height;
    tz_image photo = reduced(ctx, &full, (longest + o->side - 1) / o->side);
    tz_element_set s;
    tz_things_verdict verdict;
    int32_t *label;
    bench_check(ctx, tz_alloc(ctx, &label, (size_t)photo.width * (size_t)photo.height,
                              sizeof *label));
    const double start = bench_now();
    bench_check(ctx,
                tz_things_judge(ctx, &photo, &o->params, &s, &plate, label, &verdict));
    printf("%s: %d x %d, %d things, %d to copy, %d kinds, %.2f s\n    %s: %s\n", path,
           photo.width, photo.height, s.element.n, verdict.copied, s.kind.n,
           bench_now() - start, verdict.is_things ? "things" : "no things", verdict.why);
    if (o->svg)
        write_set(ctx, o, path, &photo, &plate, &s);
    tz_image drawn;
    if (o->cutouts) {
        row = draw_cutouts(ctx, &photo, &s, label, o->cutouts);
        goto done;
    }
    bench_check(ctx, tz_image_copy(ctx, &photo, &drawn));
    for (int32_t i = 0; i < s.element.n; i++)
        draw_outline(&drawn, &s, &s.element.v[i]);
    tz_rect r = {0, 0, photo.width, photo.height};
    if (o->crop[2] > 0)
        r = tz_rect_intersect(r,
                              (tz_rect){o->crop[0], o->crop[1], o->crop[2], o->crop[2]});
    bench_check(ctx, tz_image_init(ctx, &row, 3 * (r.w + GAP), r.h + GAP, 3));
    row.encoding = TZ_ENCODING_SRGB;
    const tz_image *cell[3] = {&photo, &drawn, &plate};
    for (int32_t k = 0; k < 3; k++) {
        const tz_image part = tz_image_view(cell[k], r);
        paste(&row, &part, k * (r.w + GAP), 0);
    }
    tz_image_deinit(&drawn);
done:
    tz_free(ctx, label);
    tz_element_set_deinit(&s);
    tz_image_deinit(&full);
    tz_image_deinit(&photo);
    tz_image_deinit(&plate);
    return row;
}

static tz_image below(tz_ctx *ctx, tz_image *top, tz_image *row)
{
    tz_image out;
    const int32_t w = top->width > row->width ? top->width : row->width;
    bench_check(ctx, tz_image_init(ctx, &out, w, top->height + row->height, 3));
    out.encoding = TZ_ENCODING_SRGB;
    paste(&out, top, 0, 0);
    paste(&out, row, 0, top->height);
    tz_image_deinit(top);
    tz_image_deinit(row);
    return out;
}

static options read_options(int argc, char **argv)
{
    options o = {.side = 1024, .first = 1};
    tz_params_default(&tz_things_param_table, &o.params);
    for (; o.first + 1 < argc && argv[o.first][0] == '-'; o.first += 2) {
        const char *name = argv[o.first], *value = argv[o.first + 1];
        if (strcmp(name, "--side") == 0)
            o.side = atoi(value);
        else if (strcmp(name, "--svg") == 0)
            o.svg = value;
        else if (strcmp(name, "--crop") == 0)
            sscanf(value, "%d,%d,%d", &o.crop[0], &o.crop[1], &o.crop[2]);
        else if (strcmp(name, "--cutouts") == 0)
            o.cutouts = value;
        else if (strcmp(name, "-o") == 0)
            o.out = value;
        else
            bench_check(NULL, tz_params_set(NULL, &tz_things_param_table, &o.params,
                                            name + 2, value));
    }
    if (!o.out || o.first >= argc || o.side < 16) {
        fprintf(stderr, "use: draw_things [--side PX] [--svg FOLDER] [--crop X,Y,SIDE] "
                        "[--cutouts copied|cut|all] -o SHEET PHOTO...\n");
        exit(2);
    }
    return o;
}

int main(int argc, char **argv)
{
    const options o = read_options(argc, argv);
    const tz_image_write_options write = {.compression = 9, .quality = 90};
    tz_ctx *ctx = bench_ctx(1);
    tz_image sheet = {0};
    for (int32_t i = o.first; i < argc; i++) {
        tz_image row = draw_row(ctx, &o, argv[i]);
        if (i == o.first)
            sheet = row;
        else
            sheet = below(ctx, &sheet, &row);
    }
    bench_check(ctx, tz_image_write(ctx, o.out, &sheet, &write));
    tz_image_deinit(&sheet);
    tz_ctx_free(ctx);
    return 0;
}
