/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The element half of compare: an exemplar's elements and a layout's. */
#ifndef TZ_CLI_COMPARE_ELEMENTS_H
#define TZ_CLI_COMPARE_ELEMENTS_H

#include "cli/command.h"

/** Compares the elements of the two operands, both SVG, and prints. */
tz_status tz_compare_elements(tz_cli *cli);

#endif
