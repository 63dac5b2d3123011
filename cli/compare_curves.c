/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/compare_curves.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/figures.h"
#include "curves/curve_compare.h"
#include "curves/curve_io.h"
#include "synthesis/expand.h"

/* One figure: name, value, the exemplar's own or NAN, whether it is as it should be (-1 =
 * nothing is asked of it), what it means. */
typedef struct row {
    const char *name;
    double value, own;
    int met;
    const char *text;
} row;

enum { ROWS = 13 };

static void list_rows(const tz_curve_likeness *q, row r[ROWS])
{
    const row rows[ROWS] = {
        {"mean", q->mean, NAN, q->mean < 1.3,
         "mean of the ratios; 1 = as the exemplar's halves; under 1.3"},
        {"length", q->length[1], q->length[0],
         fabs(q->length[1] - q->length[0]) <= 0.05 * q->length[0],
         "length of lines per area; within 5 %"},
        {"dangling", q->dangling[1], q->dangling[0],
         q->dangling[1] <= q->dangling[0] * (1 + 1e-9),
         "dangling ends per length; no more"},
        {"degree-off", q->degree_off, NAN, q->degree_off <= 0.05,
         "share of nodes of another degree; within 0.05"},
        {"repeats", q->repeats, q->repeats_own, -1,
         "share of the length that occurs once more, verbatim"},
        {"degrees", q->degrees, NAN, -1, "nodes of each degree, per length: ratio"},
        {"ends", q->ends, NAN, -1, "dangling ends per length: ratio"},
        {"edges", q->edges, NAN, -1, "ways along lines to a junction or end: ratio"},
        {"turning", q->turning, NAN, -1, "angles by which lines turn: ratio"},
        {"orientation", q->orientation, NAN, -1, "directions of lines: ratio"},
        {"density", q->density, NAN, -1, "length of lines per area: ratio"},
        {"cells", q->cells, NAN, -1, "areas of cells between lines: ratio"},
        {"patches", q->patches, NAN, -1, "patches of distances to lines: ratio"},
    };
    memcpy(r, rows, sizeof rows);
}

static void put(json_t *o, const char *name, double v)
{
    json_object_set_new(o, name, isfinite(v) ? json_real(v) : json_null());
}

static void fill_json(json_t *o, const tz_curve_likeness *q)
{
    row r[ROWS];
    json_t *goals = json_object();
    list_rows(q, r);
    for (int i = 0; i < ROWS; i++) {
        char name[64];
        put(o, r[i].name, r[i].value);
        snprintf(name, sizeof name, "%s-exemplar", r[i].name);
        if (isfinite(r[i].own))
            put(o, name, r[i].own);
        if (r[i].met >= 0)
            json_object_set_new(goals, r[i].name, json_boolean(r[i].met));
    }
    for (int i = 0; i < 2; i++) {
        json_t *degree = json_array();
        for (int k = 0; k < TZ_CURVE_DEGREES; k++)
            json_array_append_new(degree, json_real(q->degree[i][k]));
        json_object_set_new(o, i ? "degree" : "degree-exemplar", degree);
    }
    json_object_set_new(o, "goals", goals);
}

static void print_degrees(const tz_curve_likeness *q)
{
    for (int i = 0; i < 2; i++) {
        printf("%-12s", i ? "  layout" : "  exemplar");
        for (int k = 0; k < TZ_CURVE_DEGREES; k++)
            printf(" %7.4f", q->degree[i][k]);
        printf("%s\n",
               i ? "" : "  shares of nodes of degree 1 (ends), 2 (corners), 3 ..");
    }
}

static void print_text(const tz_curve_likeness *q)
{
    row r[ROWS];
    list_rows(q, r);
    for (int i = 0; i < ROWS; i++) {
        if (isnan(r[i].value))
            printf("%-12s %9s  ", r[i].name, "-");
        else
            printf("%-12s %9.4f  ", r[i].name, r[i].value);
        if (isfinite(r[i].own))
            printf("exemplar %8.4f  ", r[i].own);
        else
            printf("%19s", "");
        printf("%-6s  %s\n", r[i].met < 0 ? "" : r[i].met ? "met" : "MISSED", r[i].text);
    }
    print_degrees(q);
}

tz_status tz_compare_curves(tz_cli *cli, const tz_curve_input_params *p)
{
    const tz_curve_read_options options = {.reach = p->join_reach,
                                           .as_drawn = p->as_drawn,
                                           .crossings = p->crossings,
                                           .outlines = p->outlines};
    tz_curve_set set[2];
    tz_curve_likeness q;
    memset(set, 0, sizeof set);
    tz_status s = TZ_OK;
    double start = tz_seconds();
    for (int i = 0; i < 2 && s == TZ_OK; i++)
        s = tz_curve_read_svg(cli->ctx, tz_cli_find(cli, cli->operand[i]), &options,
                              &set[i]);
    if (s != TZ_OK)
        goto done;
    s = tz_curves_trim(cli, cli->operand[0], p, &set[0]);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "read", tz_seconds() - start);
    start = tz_seconds();
    s = tz_curve_compare(cli->ctx, &set[0], &set[1], &q);
    if (s != TZ_OK)
        goto done;
    tz_figures_seconds(cli, "measure", tz_seconds() - start);
    if (cli->common->json) {
        fill_json(cli->figures, &q);
    } else {
        print_text(&q);
        cli->piped = true; /* that was the summary */
    }
done:
    tz_curve_set_deinit(&set[0]);
    tz_curve_set_deinit(&set[1]);
    return s;
}
