/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/compare_elements.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/elements.h"
#include "cli/figures.h"
#include "elements/element_compare.h"
#include "elements/element_io.h"
#include "synthesis/expand.h"

/* One figure: name, value, the exemplar's own or NAN, what it means. */
typedef struct row {
    const char *name;
    double value, own;
    const char *text;
} row;

enum { ROWS = 11 };

static void list_rows(const tz_element_likeness *q, row r[ROWS])
{
    const row rows[ROWS] = {
        {"mean", q->mean, NAN, "mean of the ratios below; 1 = as the exemplar's halves"},
        {"nearest", q->nearest, NAN, "distances to nearest neighbours: ratio"},
        {"correlation", q->correlation, NAN, "pair correlation, all and by class: ratio"},
        {"ring-1", q->neighbourhood[0], NAN, "mean neighbourhood distance: ratio"},
        {"ring-2", q->neighbourhood[1], NAN, "likewise of two rings"},
        {"ring-3", q->neighbourhood[2], NAN, "likewise of three rings"},
        {"classes", q->classes, NAN, "frequencies of classes: ratio"},
        {"orientation", q->orientation, NAN, "frequencies of directions: ratio"},
        {"density", q->density, 1, "elements by area, over the exemplar's"},
        {"overlaps", q->overlaps[1], q->overlaps[0],
         "share of elements that overlap another"},
        {"hole", q->hole[1], q->hole[0], "radius of the widest empty disc"},
    };
    for (int i = 0; i < ROWS; i++)
        r[i] = rows[i];
}

static void put(json_t *o, const char *name, double v)
{
    json_object_set_new(o, name, isfinite(v) ? json_real(v) : json_null());
}

static void tell(tz_cli *cli, const tz_element_likeness *q)
{
    row r[ROWS];
    list_rows(q, r);
    for (int i = 0; i < ROWS; i++) {
        if (cli->common->json) {
            char name[64];
            put(cli->figures, r[i].name, r[i].value);
            snprintf(name, sizeof name, "%s-exemplar", r[i].name);
            if (isfinite(r[i].own))
                put(cli->figures, name, r[i].own);
            continue;
        }
        printf("%-12s %9.4f  ", r[i].name, r[i].value);
        if (isfinite(r[i].own))
            printf("exemplar %8.4f  ", r[i].own);
        else
            printf("%19s", "");
        printf("%s\n", r[i].text);
    }
    if (!cli->common->json)
        cli->piped = true; /* that was the summary */
}

tz_status tz_compare_elements(tz_cli *cli)
{
    tz_medium_params medium;
    tz_element_set set[2];
    tz_element_likeness q;
    memset(set, 0, sizeof set);
    tz_params_default(&tz_medium_param_table, &medium);
    tz_status s = TZ_OK;
    for (int i = 0; i < 2 && s == TZ_OK; i++)
        s = tz_elements_read(cli, cli->operand[i], &medium, 0, NULL, &set[i]);
    const double start = tz_seconds();
    if (s == TZ_OK)
        s = tz_element_compare(cli->ctx, &set[0], &set[1], &q);
    if (s == TZ_OK) {
        tz_figures_seconds(cli, "measure", tz_seconds() - start);
        tell(cli, &q);
    }
    tz_element_set_deinit(&set[0]);
    tz_element_set_deinit(&set[1]);
    return s;
}
