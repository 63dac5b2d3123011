/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Photos and exemplar documents of a command, read, checked and analysed. */
#ifndef TZ_CLI_EXEMPLARS_H
#define TZ_CLI_EXEMPLARS_H

#include "cli/record.h"
#include "synthesis/expand.h"

/** Table: tz_rules_param_table. */
typedef struct tz_rules_params {
    char rules[TZ_PARAM_STRING_SIZE];
} tz_rules_params;
extern const tz_param_table tz_rules_param_table;

/** Table: tz_enlarge_param_table. */
typedef struct tz_enlarge_params {
    double grow;
} tz_enlarge_params;
extern const tz_param_table tz_enlarge_param_table;

/** The operands as sources, in their order. */
typedef struct tz_exemplars {
    tz_source *v;
    int32_t n;
    tz_path_list input; /**< every file that must not be overwritten */
} tz_exemplars;

/** Reads the operands: photos, or exemplar documents where the name ends in .svg. Records
 * them as inputs and brings all photos to one channel count. */
tz_status tz_exemplars_read(tz_cli *cli, tz_record *record, tz_exemplars *e);
/** Analyses those that are photos. */
tz_status tz_exemplars_analyze(tz_cli *cli, const tz_ebpt_params *params,
                               tz_exemplars *e);
/** Writes the exemplar document of source i, which refers to the photo from there. */
tz_status tz_exemplars_write(tz_cli *cli, const tz_exemplars *e, int32_t i,
                             const char *path);
void tz_exemplars_free(tz_cli *cli, tz_exemplars *e);

/** Whether a path names an SVG document. */
bool tz_path_is_svg(const char *path);
/** Size of the layout: as given, else the first exemplar's sides times `grow`. Switches
 * the automatic rotation off where a rotation is given. */
tz_status tz_arrange_settle(tz_cli *cli, const tz_exemplars *e, double grow,
                            tz_arrange_params *p);

#endif
