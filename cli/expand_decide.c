/* SPDX-License-Identifier: Apache-2.0 */
/* The first of these that holds:
 *
 *   curves    lines stand out, and are closed: CLOSED of their length leads on to lines at
 *             both ends (joints of bricks and stones, cracked mud)
 *   elements  things stand out, on the average as surely as SURE
 *   curves    lines stand out and run on: LONG times as long as wide (cracks, veins)
 *   edges
 *
 * Closed lines come before things because what they part is kept in its place, rows stay
 * rows, and joints stay as wide as they were; where lines that should be closed are broken
 * (cobbles, whose joints can hardly be seen), stones would be bent along them, and things
 * that are surely seen are better. Short lines that are open, and things not surely seen,
 * are gaps in what neither of the two knows: heaps, gravel, rubble. */
#include "cli/expand_decide.h"

#include "cli/figures.h"

#define CLOSED 0.80
#define SURE   0.75
#define LONG   10

static bool run_on(const tz_curve_exemplar *e)
{
    return e->found.length >= LONG * e->found.width * e->set.path.n;
}

tz_status tz_expand_decide(tz_cli *cli, const tz_lines_params *lines,
                           const tz_things_params *things, const char *model,
                           tz_expand_decision *d)
{
    const char *path = cli->operand[0], *why = "several photos mix as edges";
    tz_things_verdict v = {0};
    tz_status s = TZ_OK;
    d->as = TZ_AS_EDGES;
    if (cli->operands > 1)
        goto done;
    s = tz_curve_exemplar_find(cli, path, lines, &d->line_record, &d->lines);
    if (s != TZ_OK)
        return s;
    const bool drawn = d->lines.found.is_lines && d->lines.set.path.n > 0;
    why = d->lines.found.why;
    if (drawn && d->lines.found.closed >= CLOSED) {
        d->as = TZ_AS_CURVES;
        goto done;
    }
    s = tz_element_exemplar_judge(cli, path, things, model, &d->thing_record, &d->things,
                                  &v);
    if (s != TZ_OK)
        return s;
    if (v.is_things && v.copied > 0 && v.sure >= SURE) {
        d->as = TZ_AS_ELEMENTS;
        why = v.why;
    } else if (drawn && run_on(&d->lines)) {
        d->as = TZ_AS_CURVES;
    } else if (drawn) {
        why = "its lines are short and open, and things in it are not surely seen";
    } else if (v.is_things) {
        why = "things in it are not surely seen, and no lines part them";
    } else {
        why = v.why;
    }
done:
    tz_figures_text(cli, "as",
                    d->as == TZ_AS_CURVES     ? "curves"
                    : d->as == TZ_AS_ELEMENTS ? "elements"
                                              : "edges");
    tz_figures_text(cli, "why", why);
    return s;
}

void tz_expand_decision_free(tz_cli *cli, tz_expand_decision *d)
{
    tz_curve_exemplar_free(cli, &d->lines);
    tz_element_exemplar_free(cli, &d->things);
    tz_record_free(cli, &d->line_record);
    tz_record_free(cli, &d->thing_record);
}
