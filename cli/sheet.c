/* SPDX-License-Identifier: Apache-2.0 */
/* Contact sheet: pictures in a grid, each with a label under it. All are scaled by the
 * one factor at which the largest fits its cell, so that a small exemplar beside its
 * large texture looks small. Scaling down averages the covered pixels in linear light. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/figures.h"
#include "cli/font.h"
#include "cli/material.h"

typedef struct sheet_params {
    int32_t columns;
    int32_t cell[2];
    char labels[TZ_PARAM_STRING_SIZE];
    bool fit;
} sheet_params;

typedef struct values {
    tz_common_params common;
    tz_output_params output;
    sheet_params own;
    tz_format_params format;
} values;

static const tz_param own_rows[] = {
    {"columns", TZ_PARAM_INT, offsetof(sheet_params, columns), 1, 1000, "2", "", NULL,
     "Pictures side by side."},
    {"cell", TZ_PARAM_SIZE, offsetof(sheet_params, cell), 16, 16384, "768x768", "px",
     NULL, "Largest size of a picture on the sheet."},
    {"labels", TZ_PARAM_STRING, offsetof(sheet_params, labels), 0, 0, "", "A|B|...", NULL,
     "Words under the pictures, parted by |; else their names and sizes."},
    {"fit", TZ_PARAM_BOOL, offsetof(sheet_params, fit), 0, 1, "false", "", NULL,
     "Scales each picture by itself to fill its cell; else all by one factor."},
};
static const tz_param_table own_table = {"sheet", "How the sheet is laid out.", own_rows,
                                         sizeof own_rows / sizeof own_rows[0],
                                         sizeof(sheet_params)};

enum { GAP = 12, LETTER = 2, LABEL = TZ_FONT_HEIGHT * LETTER + GAP };

/* ---- scaling ------------------------------------------------------------------------
 */

typedef struct scale_job {
    const tz_image *from;
    tz_image *to;
    double factor; /* source px a sheet px */
    int32_t x, y;  /* where it goes */
    float paper;
} scale_job;

/* Mean of source pixels over [x0, x1) x [y0, y1), over paper where transparent. */
static void average(const scale_job *j, tz_rect r, float out[3])
{
    const tz_image *im = j->from;
    int32_t colours = im->channels - (im->alpha >= 0);
    double sum[3] = {0}, count = (double)r.w * r.h;
    for (int32_t y = r.y; y < r.y + r.h; y++)
        for (int32_t x = r.x; x < r.x + r.w; x++) {
            const float *p = tz_image_at(im, x, y);
            double a = im->alpha >= 0 ? (double)p[im->alpha] : 1;
            for (int32_t c = 0; c < 3; c++)
                sum[c] += a * (double)p[colours < 3 ? 0 : c] + (1 - a) * (double)j->paper;
        }
    for (int32_t c = 0; c < 3; c++)
        out[c] = (float)(sum[c] / count);
}

static tz_status scale_row(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx;
    (void)worker;
    const scale_job *j = arg;
    const tz_image *im = j->from;
    int32_t w = (int32_t)fmax(1, floor(im->width / j->factor));
    tz_rect r = {.y = (int32_t)fmin((double)i * j->factor, im->height - 1)};
    int32_t end = (int32_t)fmin(((double)i + 1) * j->factor, im->height);
    r.h = end > r.y ? end - r.y : 1;
    for (int32_t k = 0; k < w; k++) {
        r.x = (int32_t)fmin(k * j->factor, im->width - 1);
        end = (int32_t)fmin((k + 1) * j->factor, im->width);
        r.w = end > r.x ? end - r.x : 1;
        average(j, r, tz_image_at(j->to, j->x + k, j->y + (int32_t)i));
    }
    return TZ_OK;
}

static double factor_of(const tz_image *im, const int32_t cell[2])
{
    double f = fmax((double)im->width / cell[0], (double)im->height / cell[1]);
    return f > 1 ? f : 1;
}

/* ---- sheet --------------------------------------------------------------------------
 */

/* i-th of the labels in "a|b|c", or the picture's name and size. */
static void label_of(const values *v, const char *path, const tz_image *im, int32_t i,
                     char *text, size_t size)
{
    const char *p = v->own.labels;
    for (; *v->own.labels && i > 0 && p; i--)
        p = strchr(p, '|') ? strchr(p, '|') + 1 : NULL;
    if (*v->own.labels) {
        snprintf(text, size, "%.*s", p ? (int)strcspn(p, "|") : 0, p ? p : "");
        return;
    }
    char stem[TZ_PARAM_STRING_SIZE];
    tz_path_stem(path, stem, sizeof stem);
    snprintf(text, size, "%.200s  %d x %d", stem, im->width, im->height);
}

/* Where each column and row of the grid begins: as wide as the widest picture in it (and
 * at least twenty letters), as high as the highest. */
typedef struct grid {
    int32_t columns, rows;
    int32_t *x, *y; /* columns + 1, rows + 1 */
} grid;

static tz_status make_grid(tz_cli *cli, const tz_image *im, const double *factor, grid *g)
{
    const values *v = cli->values;
    int32_t n = cli->operands;
    g->columns = n < v->own.columns ? n : v->own.columns;
    g->rows = (n + g->columns - 1) / g->columns;
    tz_status s = tz_alloc_zero(cli->ctx, &g->x, (size_t)g->columns + 1, sizeof *g->x);
    if (s == TZ_OK)
        s = tz_alloc_zero(cli->ctx, &g->y, (size_t)g->rows + 1, sizeof *g->y);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < n; i++) {
        int32_t w = (int32_t)fmax(20 * TZ_FONT_WIDTH * LETTER, im[i].width / factor[i]);
        int32_t h = (int32_t)fmax(1, im[i].height / factor[i]) + LABEL;
        int32_t *x = &g->x[i % g->columns + 1], *y = &g->y[i / g->columns + 1];
        *x = w > *x ? w : *x;
        *y = h > *y ? h : *y;
    }
    int64_t width = GAP, height = GAP;
    g->x[0] = g->y[0] = GAP;
    for (int32_t i = 1; i <= g->columns && width <= TZ_IMAGE_MAX_SIDE; i++)
        g->x[i] = (int32_t)(width += g->x[i] + GAP);
    for (int32_t i = 1; i <= g->rows && height <= TZ_IMAGE_MAX_SIDE; i++)
        g->y[i] = (int32_t)(height += g->y[i] + GAP);
    if (width > TZ_IMAGE_MAX_SIDE || height > TZ_IMAGE_MAX_SIDE)
        return tz_fail(cli->ctx, TZ_LIMIT,
                       "%s: the sheet is too large; make the cells smaller",
                       v->output.output);
    return TZ_OK;
}

static tz_status draw_cell(tz_cli *cli, const tz_image *im, int32_t i, double factor,
                           const grid *g, tz_image *sheet)
{
    char label[256];
    int32_t column = i % g->columns;
    scale_job j = {im, sheet, factor, g->x[column], g->y[i / g->columns], 1};
    int32_t rows = (int32_t)fmax(1, floor(im->height / factor));
    tz_status s = tz_parallel_for(cli->ctx, rows, scale_row, &j);
    label_of(cli->values, cli->operand[i], im, i, label, sizeof label);
    int32_t letters = (g->x[column + 1] - g->x[column]) / (TZ_FONT_WIDTH * LETTER);
    if (letters < (int32_t)sizeof label)
        label[letters] = 0;
    tz_font_draw(sheet, j.x, j.y + rows + GAP / 2, LETTER, 0, label);
    return s;
}

static tz_status read_all(tz_cli *cli, tz_image *im)
{
    const tz_image_read_options opt = {.want = TZ_ENCODING_LINEAR};
    tz_status s = TZ_OK;
    for (int32_t i = 0; s == TZ_OK && i < cli->operands; i++)
        s = tz_image_read(cli->ctx, cli->operand[i], &opt, &im[i]);
    return s;
}

static tz_status check(tz_cli *cli, tz_image_write_options *opt)
{
    const values *v = cli->values;
    tz_path_list in = {0}, out = {0};
    if (!*v->output.output)
        return tz_cli_usage(cli, "no output; give one with -o FILE");
    tz_status s = tz_paths_add(cli->ctx, &out, v->output.output);
    for (int32_t i = 0; s == TZ_OK && i < cli->operands; i++)
        s = tz_paths_add(cli->ctx, &in, cli->operand[i]);
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &in, &out);
    if (s == TZ_OK)
        s = tz_format_settle(cli->ctx, v->output.output, &v->format, NULL, opt);
    tz_paths_free(cli->ctx, &in);
    tz_paths_free(cli->ctx, &out);
    return s;
}

/* One factor for all, or each its own. */
static void set_factors(const values *v, const tz_image *im, int32_t n, double *factor)
{
    double most = 1;
    for (int32_t i = 0; i < n; i++) {
        factor[i] = factor_of(&im[i], v->own.cell);
        most = fmax(most, factor[i]);
    }
    for (int32_t i = 0; i < n && !v->own.fit; i++)
        factor[i] = most;
}

static tz_status run(tz_cli *cli)
{
    const values *v = cli->values;
    tz_image *im = NULL, sheet = {0};
    tz_image_write_options opt;
    grid g = {0};
    double *factor = NULL;
    int32_t n = cli->operands;
    tz_status s = check(cli, &opt);
    if (s == TZ_OK)
        s = tz_alloc_zero(cli->ctx, &im, (size_t)n, sizeof *im);
    if (s == TZ_OK)
        s = tz_alloc(cli->ctx, &factor, (size_t)n, sizeof *factor);
    if (s == TZ_OK)
        s = read_all(cli, im);
    if (s != TZ_OK)
        goto done;
    set_factors(v, im, n, factor);
    if ((s = make_grid(cli, im, factor, &g)) != TZ_OK ||
        (s = tz_image_init(cli->ctx, &sheet, g.x[g.columns], g.y[g.rows], 3)) != TZ_OK)
        goto done;
    sheet.encoding = TZ_ENCODING_LINEAR;
    sheet.depth = 8;
    for (int64_t i = 0; i < (int64_t)sheet.width * sheet.height * 3; i++)
        sheet.px[i] = 1;
    for (int32_t i = 0; s == TZ_OK && i < n; i++)
        s = draw_cell(cli, &im[i], i, factor[i], &g, &sheet);
    if (s == TZ_OK)
        s = tz_image_write(cli->ctx, v->output.output, &sheet, &opt);
    if (s == TZ_OK)
        tz_figures_output(cli, v->output.output, "sheet", sheet.width, sheet.height);
    cli->piped = strcmp(v->output.output, "-") == 0;
done:
    for (int32_t i = 0; im && i < n; i++)
        tz_image_deinit(&im[i]);
    tz_free(cli->ctx, im);
    tz_free(cli->ctx, factor);
    tz_free(cli->ctx, g.x);
    tz_free(cli->ctx, g.y);
    tz_image_deinit(&sheet);
    return s;
}

static const tz_option_group groups[] = {
    {&tz_common_param_table, offsetof(values, common), false},
    {&tz_output_param_table, offsetof(values, output), false},
    {&own_table, offsetof(values, own), false},
    {&tz_format_param_table, offsetof(values, format), false},
};
static const tz_example examples[] = {
    {"Exemplar beside result:", "terrazzo sheet rocks.jpg rocks_big.png -o sheet.png"},
};
const tz_command tz_sheet_command = {
    .name = "sheet",
    .operands = "IMAGE... -o SHEET",
    .summary = "Lays pictures out on a contact sheet, with labels.",
    .about =
        "All pictures are scaled down by the same factor, so that their details can be "
        "compared; --fit scales each by itself.",
    .min_operands = 1,
    .max_operands = -1,
    .group = groups,
    .groups = sizeof groups / sizeof groups[0],
    .example = examples,
    .examples = sizeof examples / sizeof examples[0],
    .size = sizeof(values),
    .run = run,
};
