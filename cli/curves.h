/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Curve textures in commands: how curves are read out of drawings, and what they are
 * written as. */
#ifndef TZ_CLI_CURVES_H
#define TZ_CLI_CURVES_H

#include "cli/names.h"
#include "cli/record.h"
#include "curves/curve.h"

/** Table: tz_curve_input_param_table. */
typedef struct tz_curve_input_params {
    double join_reach;
    bool as_drawn, crossings, outlines, trim;
    bool
        wrap; /**< value of --wrap, where that is given: tz_medium_params has the option */
} tz_curve_input_params;
extern const tz_param_table tz_curve_input_param_table;

/** What a document of curves is written as. */
typedef enum tz_curve_format {
    TZ_CURVE_FORMAT_AUTO, /**< by the name */
    TZ_CURVE_FORMAT_SVG,
    TZ_CURVE_FORMAT_DXF
} tz_curve_format;

/** Table: tz_curve_output_param_table. */
typedef struct tz_curve_output_params {
    int32_t format; /**< tz_curve_format */
    double unit;    /**< mm; 0 = as the drawing says, else 1/96 inch */
} tz_curve_output_params;
extern const tz_param_table tz_curve_output_param_table;

/** Reads the curves (and elements) of a drawing, and records it. What its origins were is
 * forgotten: it is an exemplar now.
 * @param exemplar        what tells of a pattern: a tile (curves/tile.h; --wrap says so, or
 *   it is found out) becomes a torus, others are trimmed (curves/trim.h) if p says so
 * @param[in,out] record  NULL, or what inputs are added to
 * @param[in,out] inputs  NULL, or files that must not be overwritten
 * @param[out] set        overwritten, not freed; zeroed on error
 * @return as tz_curve_read_svg; TZ_INVALID (arranged from a photo already) */
tz_status tz_curves_read(tz_cli *cli, const char *path, const tz_curve_input_params *p,
                         bool exemplar, tz_record *record, tz_path_list *inputs,
                         tz_curve_set *set);
/** Cuts an exemplar down to what shows its pattern, as far as that is wanted, and warns of
 * what was cut off that is no mere edge. @param[in,out] set  unchanged on error */
tz_status tz_curves_trim(tz_cli *cli, const char *path, const tz_curve_input_params *p,
                         tz_curve_set *set);
/** Settles what is written under that name.
 * @return TZ_OK; TZ_INVALID (another suffix, or one that contradicts --format) */
tz_status tz_curves_format(tz_cli *cli, const char *path, const tz_curve_output_params *p,
                           tz_curve_format *format);
/** Writes the set, with its recipe where the format has room for one, and tells of it. */
tz_status tz_curves_write(tz_cli *cli, const char *path, const tz_curve_output_params *p,
                          const tz_curve_set *set);

#endif
