/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What expand is to make: seeds, and the files of each. */
#ifndef TZ_CLI_EXPAND_PLAN_H
#define TZ_CLI_EXPAND_PLAN_H

#include "cli/material.h"

/** Table: tz_expand_param_table. */
typedef struct tz_expand_params {
    char seeds[TZ_PARAM_STRING_SIZE];
    char save_exemplar[TZ_PARAM_STRING_SIZE];
    char save_layout[TZ_PARAM_STRING_SIZE];
} tz_expand_params;
extern const tz_param_table tz_expand_param_table;

typedef struct tz_expand_plan {
    tz_seed_list seeds;
    tz_path_list layouts;     /* one a seed, or none */
    tz_picture_list pictures; /* all seeds */
    int32_t *first;           /* seeds.n + 1 offsets into pictures */
} tz_expand_plan;

/** What a plan is made from. */
typedef struct tz_expand_wish {
    const tz_expand_params *own;
    const char *output;
    const tz_format_params *format;
    uint64_t seed;               /**< where no list is given */
    int32_t width, height;       /**< for names */
    const tz_path_list *inputs;  /**< not to be overwritten */
    const tz_path_list *besides; /**< outputs of other kinds; NULL = none */
    /** Names the pictures of one seed; appends them. */
    tz_status (*pictures)(tz_cli *cli, void *user, tz_name_values v,
                          tz_picture_list *out);
    void *user;
} tz_expand_wish;

/** Seeds alone, which decide how often all else is made. */
tz_status tz_expand_seeds(tz_cli *cli, const tz_expand_wish *w, tz_expand_plan *p);
/** Names and checks every output before the work begins. */
tz_status tz_expand_plan_make(tz_cli *cli, const tz_expand_wish *w, tz_expand_plan *p);
void tz_expand_plan_free(tz_cli *cli, tz_expand_plan *p);

#endif
