/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/fill_show.h"

#include <math.h>

#define AT(m) offsetof(tz_show_params, m)
static const tz_param rows[] = {
    {"ramp", TZ_PARAM_STRING, AT(ramp), 0, 0, "", "RAMP", NULL,
     "Colours of the things, by --ramp-by: viridis, magma, grey, hue (round, for "
     "directions) or colours of your own, as \"#123,#abcdef,gold\"."},
    {"ramp-by", TZ_PARAM_ENUM, AT(by), 0, 3, "direction", "",
     "direction|size|density|length",
     "What a thing's colour tells: the way it points, its size against the palette's, "
     "the "
     "density said there, the length of the vectors of --directions there."},
    {"lengths", TZ_PARAM_RANGE, AT(lengths), 0, 1000, "0,0", "", NULL,
     "Sizes of things where the vectors of --directions are 0 and where they are "
     "longest; "
     "0,0 = lengths say nothing."},
};
#undef AT
const tz_param_table tz_show_param_table = {"show", "How a field is shown by things.",
                                            rows, sizeof rows / sizeof *rows,
                                            sizeof(tz_show_params)};

void tz_show_deinit(tz_show *show) { tz_vectors_deinit(&show->vectors); }

tz_status tz_show_read(tz_cli *cli, const tz_show_params *p, const char *vectors,
                       tz_element_field *field, tz_show *show)
{
    const bool sized = p->lengths[1] > 0;
    tz_status s = TZ_OK;
    if (*p->ramp)
        s = tz_ramp_parse(cli->ctx, p->ramp, &show->ramp);
    if (s != TZ_OK || !(sized || (*p->ramp && p->by == TZ_SHOW_LENGTH)))
        return s;
    if (!*vectors)
        return tz_fail(cli->ctx, TZ_INVALID,
                       "%s: there are no vectors; name their image with --directions",
                       sized ? "--lengths" : "--ramp-by length");
    s = tz_vectors_read(cli->ctx, tz_cli_find(cli, vectors), field->raster.size,
                        field->raster.torus, &show->vectors);
    return s == TZ_OK && sized
               ? tz_vectors_say_sizes(&show->vectors, p->lengths[0], p->lengths[1], field)
               : s;
}

static double value_of(const tz_show *show, tz_show_by by, const tz_element_field *field,
                       const tz_element *e, const tz_element *drawn)
{
    switch (by) {
    case TZ_SHOW_DIRECTION: {
        const double t = (e->angle - drawn->angle) / (2 * TZ_PI);
        return t - floor(t);
    }
    case TZ_SHOW_SIZE: return log(e->scale / drawn->scale);
    case TZ_SHOW_LENGTH: return tz_vectors_at(&show->vectors, e->at);
    case TZ_SHOW_DENSITY: break;
    }
    const int32_t cell = field->nearest[2][tz_raster_at(&field->raster, e->at)];
    return cell >= 0 ? (double)field->cell[cell].density : 1;
}

/* Sizes have no bounds of their own: least to greatest becomes 0 to 1. */
static void stretch(double *v, int32_t n)
{
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (int32_t i = 0; i < n; i++)
        if (v[i] == v[i])
            lo = fmin(lo, v[i]), hi = fmax(hi, v[i]);
    for (int32_t i = 0; i < n; i++)
        v[i] = hi > lo + 1e-6 ? (v[i] - lo) / (hi - lo) : v[i] == v[i] ? 0.5 : v[i];
}

tz_status tz_show_paint(tz_cli *cli, const tz_show_params *p, const tz_show *show,
                        const tz_element_field *field, const tz_element_set *palette,
                        tz_element_set *layout)
{
    const int32_t n = layout->element.n;
    double *value = NULL;
    tz_ramp ramp = show->ramp;
    if (ramp.n == 0 || n == 0)
        return TZ_OK;
    tz_status s = tz_alloc(cli->ctx, &value, (size_t)n, sizeof *value);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        const tz_element *e = &layout->element.v[i];
        value[i] = e->source >= 0 && e->source < palette->element.n
                       ? value_of(show, (tz_show_by)p->by, field, e,
                                  &palette->element.v[e->source])
                       : NAN;
    }
    if (s == TZ_OK && p->by == TZ_SHOW_SIZE)
        stretch(value, n);
    ramp.closed = p->by == TZ_SHOW_DIRECTION; /* a turn ends where it began */
    if (s == TZ_OK)
        s = tz_ramp_paint(&ramp, layout, value);
    tz_free(cli->ctx, value);
    return s;
}
