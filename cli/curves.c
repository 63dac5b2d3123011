/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/curves.h"

#include <jansson.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "cli/figures.h"
#include "cli/material.h"
#include "curves/curve_dxf.h"
#include "curves/curve_io.h"
#include "curves/tile.h"
#include "curves/trim.h"

#define AT(m) offsetof(tz_curve_input_params, m)
static const tz_param input_rows[] = {
    {"join-reach", TZ_PARAM_DOUBLE, AT(join_reach), 0, 1e9, "0", "", NULL,
     "Curves: gap that ends are joined over, user units; 0 = half of the usual line "
     "width."},
    {"as-drawn", TZ_PARAM_BOOL, AT(as_drawn), 0, 1, "false", "", NULL,
     "Curves: paths are taken as they are: neither joined nor thinned."},
    {"crossings", TZ_PARAM_BOOL, AT(crossings), 0, 1, "false", "", NULL,
     "Curves: lines that cross are joined there."},
    {"outlines", TZ_PARAM_BOOL, AT(outlines), 0, 1, "false", "", NULL,
     "Curves: filled shapes count as their outlines, not as lines as wide as they are."},
    {"trim", TZ_PARAM_BOOL, AT(trim), 0, 1, "true", "", NULL,
     "Curves: exemplars whose lines end together just inside their edge are cut there, "
     "so "
     "that these ends are none of the pattern."},
};
#undef AT
const tz_param_table tz_curve_input_param_table = {
    "curve input", "How curves are read out of a drawing.", input_rows,
    sizeof input_rows / sizeof *input_rows, sizeof(tz_curve_input_params)};

#define AT(m) offsetof(tz_curve_output_params, m)
static const tz_param output_rows[] = {
    {"format", TZ_PARAM_ENUM, AT(format), 0, 0, "auto", "", "auto|svg|dxf",
     "Curves: format of the output; auto = by its name's suffix."},
    {"unit", TZ_PARAM_DOUBLE, AT(unit), 0, 1e6, "0", "mm", NULL,
     "Curves: length of a unit in DXF; 0 = as the drawing says, else 1/96 inch."},
};
#undef AT
const tz_param_table tz_curve_output_param_table = {
    "curve output", "How curves are written.", output_rows,
    sizeof output_rows / sizeof *output_rows, sizeof(tz_curve_output_params)};

tz_status tz_curves_trim(tz_cli *cli, const char *path, const tz_curve_input_params *p,
                         tz_curve_set *set)
{
    tz_curve_set cut = {0};
    tz_curve_trim_report r;
    if (!p->trim || p->as_drawn)
        return TZ_OK;
    const tz_vec3 whole = set->domain.size;
    const tz_status s = tz_curve_trim(cli->ctx, set, &cut, &r);
    if (s != TZ_OK || !r.trimmed) {
        tz_curve_set_deinit(&cut);
        return s;
    }
    tz_curve_set_deinit(set);
    *set = cut;
    if (r.filled)
        tz_warn(
            cli->ctx,
            "%s: %.0f %% of it is empty at the border; only %.4g x %.4g of %.4g x %.4g "
            "counts (--trim false takes all of it)",
            path, 100 * r.empty, r.size.x, r.size.y, whole.x, whole.y);
    return TZ_OK;
}

/** Makes a tile a torus. */
static tz_status wrap(tz_cli *cli, const tz_curve_input_params *p, tz_curve_set *set)
{
    tz_curve_set torus = {0};
    const bool known = tz_cli_given(cli, "wrap");
    bool is = known && p->wrap && !set->domain.torus;
    tz_status s = TZ_OK;
    if (!known && !p->as_drawn)
        s = tz_curve_tile_find(cli->ctx, set, &is);
    if (s != TZ_OK || !is || set->domain.torus)
        return s;
    s = tz_curve_tile_join(cli->ctx, set, &torus);
    if (s != TZ_OK)
        return s;
    tz_curve_set_deinit(set);
    *set = torus;
    return TZ_OK;
}

tz_status tz_curves_read(tz_cli *cli, const char *path, const tz_curve_input_params *p,
                         bool exemplar, tz_record *record, tz_path_list *inputs,
                         tz_curve_set *set)
{
    const tz_curve_read_options options = {.reach = p->join_reach,
                                           .as_drawn = p->as_drawn,
                                           .crossings = p->crossings,
                                           .outlines = p->outlines};
    const char *at = tz_cli_find(cli, path);
    const double start = tz_seconds();
    *set = (tz_curve_set){0};
    tz_status s = record ? tz_record_input(cli, record, path, NULL) : TZ_OK;
    if (s == TZ_OK && inputs)
        s = tz_paths_add(cli->ctx, inputs, at);
    if (s == TZ_OK)
        s = tz_curve_read_svg(cli->ctx, at, &options, set);
    if (s != TZ_OK)
        return s;
    if (set->origin.n > 0 && set->element.photo.n > 0) {
        tz_curve_set_deinit(set);
        *set = (tz_curve_set){0};
        return tz_fail(cli->ctx, TZ_INVALID,
                       "%s: is arranged already from the lines of a photo; give what "
                       "analyze made of the photo",
                       path);
    }
    tz_array_free(set->ctx, &set->origin);
    tz_free(set->ctx, set->recipe);
    set->recipe = NULL;
    if (exemplar)
        s = wrap(cli, p, set);
    if (exemplar && s == TZ_OK)
        s = tz_curves_trim(cli, path, p, set);
    if (s != TZ_OK) {
        tz_curve_set_deinit(set);
        *set = (tz_curve_set){0};
        return s;
    }
    tz_figures_seconds(cli, "read", tz_seconds() - start);
    return TZ_OK;
}

tz_status tz_curves_format(tz_cli *cli, const char *path, const tz_curve_output_params *p,
                           tz_curve_format *format)
{
    const char *suffix = tz_path_extension(path);
    const tz_curve_format named = strcasecmp(suffix, "svg") == 0   ? TZ_CURVE_FORMAT_SVG
                                  : strcasecmp(suffix, "dxf") == 0 ? TZ_CURVE_FORMAT_DXF
                                                                   : TZ_CURVE_FORMAT_AUTO;
    const bool piped = strcmp(path, "-") == 0;
    if (!piped && named == TZ_CURVE_FORMAT_AUTO)
        return tz_fail(cli->ctx, TZ_INVALID,
                       "%s: curves are written as .svg or .dxf; give it one of these "
                       "suffixes",
                       path);
    if (!piped && p->format != TZ_CURVE_FORMAT_AUTO && p->format != (int32_t)named)
        return tz_fail(cli->ctx, TZ_INVALID, "%s: its suffix contradicts --format %s",
                       path, p->format == TZ_CURVE_FORMAT_SVG ? "svg" : "dxf");
    *format = !piped                              ? named
              : p->format != TZ_CURVE_FORMAT_AUTO ? (tz_curve_format)p->format
                                                  : TZ_CURVE_FORMAT_SVG;
    return TZ_OK;
}

/** Length of a user unit, mm. */
static double unit_of(const tz_curve_output_params *p, const tz_curve_set *set)
{
    return p->unit > 0 ? p->unit : set->unit_mm > 0 ? set->unit_mm : 25.4 / 96;
}

tz_status tz_curves_write(tz_cli *cli, const char *path, const tz_curve_output_params *p,
                          const tz_curve_set *set)
{
    const double start = tz_seconds(), unit = unit_of(p, set);
    tz_curve_format format = TZ_CURVE_FORMAT_AUTO;
    double way[2] = {0, 0};
    tz_status s = tz_curves_format(cli, path, p, &format);
    if (s == TZ_OK)
        s = format == TZ_CURVE_FORMAT_DXF
                ? tz_curve_write_dxf(cli->ctx, path, set, unit, 0, way)
                : tz_curve_write_svg(cli->ctx, path, set);
    if (s != TZ_OK)
        return s;
    tz_figures_seconds(cli, "write", tz_seconds() - start);
    tz_figures_count(cli, "paths", set->path.n);
    tz_figures_output(cli, path, format == TZ_CURVE_FORMAT_DXF ? "dxf" : "layout",
                      (int32_t)fmin(2e9, rint(set->domain.size.x)),
                      (int32_t)fmin(2e9, rint(set->domain.size.y)));
    if (format == TZ_CURVE_FORMAT_DXF)
        json_object_set_new(
            cli->figures, "pen_up_mm",
            json_pack("{s:f,s:f}", "as_drawn", way[0] * unit, "ordered", way[1] * unit));
    return TZ_OK;
}
