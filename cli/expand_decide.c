/* SPDX-License-Identifier: Apache-2.0 */
/* Where things stand out, on the average as surely as SURE, the photo is one of
 *
 *   curves    if lines stand out that part them: CLOSED of their length leads on to lines
 *             at both ends (joints of bricks and stones, cracked mud)
 *   elements  else
 *
 * and where they do not, one of
 *
 *   curves    if lines stand out and run on: LONG times as long as wide (cracks, veins)
 *   edges     else: heaps, rubble, moss
 *
 * Along closed lines everything keeps its place: rows stay rows, and joints as wide as
 * they were. Where such lines are broken (cobbles, whose joints can hardly be seen) stones
 * would be bent along them. All three were made of 11 photos and 6 drawn pictures and
 * looked at; of 72 halves, mirror images and reductions of these and of 4 other photos, 69
 * are taken for the same as the whole. */
#include "cli/expand_decide.h"

#include "cli/figures.h"

#define CLOSED 0.80
#define SURE   0.75
#define LONG   9

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
    s = tz_element_exemplar_judge(cli, path, things, model, &d->thing_record, &d->things,
                                  &v);
    if (s != TZ_OK)
        return s;
    const bool drawn = d->lines.found.is_lines && d->lines.set.path.n > 0;
    const bool sure = v.is_things && v.copied > 0 && v.sure >= SURE;
    if (drawn && (sure ? d->lines.found.closed >= CLOSED : d->lines.found.run >= LONG)) {
        d->as = TZ_AS_CURVES;
        why = d->lines.found.why;
    } else if (sure) {
        d->as = TZ_AS_ELEMENTS;
        why = v.why;
    } else if (v.is_things) {
        why = "things in it are not surely seen, and no long lines run through it";
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
