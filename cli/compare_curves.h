/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The curve half of compare: an exemplar's curves and a layout's. */
#ifndef TZ_CLI_COMPARE_CURVES_H
#define TZ_CLI_COMPARE_CURVES_H

#include "cli/curves.h"

/** Compares the curves of the two operands, both SVG, and prints.
 * @param p  how drawings are read */
tz_status tz_compare_curves(tz_cli *cli, const tz_curve_input_params *p);

#endif
