/* SPDX-License-Identifier: Apache-2.0 */
/* Growth copies neighbourhoods one by one and is local; the solver then evens out what
 * met badly, everywhere at once. */
#include "elements/element_arrange.h"

#include <string.h>
#include <time.h>

#include "elements/energy.h"
#include "elements/growth.h"

#define AT(m) offsetof(tz_element_arrange_params, m)
static const tz_param rows[] = {
    {"method", TZ_PARAM_ENUM, AT(method), 0, 0, "growth", "", "growth|patches|noise",
     "Elements: grown and then evened out; or the energy solver alone, from patches of "
     "the "
     "exemplar or from noise."},
    {"rings", TZ_PARAM_INT, AT(rings), 1, 3, "2", "", NULL,
     "Elements: rings of neighbours that are compared; more keep larger figures."},
    {"optimise", TZ_PARAM_ENUM, AT(optimise), 0, 0, "local", "", "none|local|global",
     "Elements: what is moved into better places while growing."},
    {"candidates", TZ_PARAM_INT, AT(candidates), 1, 8, "5", "", NULL,
     "Elements: alike neighbourhoods of the exemplar that are tried; more vary more."},
    {"ratio", TZ_PARAM_DOUBLE, AT(ratio), 1, 1000, "2", "", NULL,
     "Elements: neighbourhoods that fit this many times worse than the best are not "
     "copied."},
    {"overlap", TZ_PARAM_DOUBLE, AT(overlap), 0, 2, "0.8", "", NULL,
     "Elements: two of classes that the exemplar never shows side by side keep apart by "
     "this share of the sum of their radii."},
    {"balance", TZ_PARAM_DOUBLE, AT(balance), 0, 1, "0.5", "", NULL,
     "Elements: how hard the shares of classes follow the exemplar's."},
    {"iterations", TZ_PARAM_INT, AT(iterations), -1, 10000, "-1", "", NULL,
     "Elements: iterations of the energy solver; -1 = 3 after growth, 20 without."},
    {"most", TZ_PARAM_INT, AT(most), 0, 100000000, "0", "", NULL,
     "Elements: placed at most; 0 fills the domain."},
};
#undef AT
const tz_param_table tz_element_arrange_param_table = {
    "elements", "Arrangement of elements over a domain.", rows,
    sizeof rows / sizeof rows[0], sizeof(tz_element_arrange_params)};

enum { STEP = 512 }; /* elements between two looks at progress and cancel */

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int32_t seen_elements(const tz_element_set *s)
{
    int32_t n = 0;
    for (int32_t i = 0; i < s->element.n; i++)
        n += !s->kind.v[s->element.v[i].kind].is_void;
    return n;
}

/** Elements that the exemplar's density asks for in the layout's domain. */
static double wanted(const tz_element_set *exemplar, const tz_element_set *layout)
{
    return (double)seen_elements(exemplar) * tz_domain_area(&layout->domain) /
           tz_domain_area(&exemplar->domain);
}

static tz_status grow(tz_ctx *ctx, const tz_element_set *exemplar,
                      const tz_element_arrange_params *p, uint64_t seed,
                      tz_element_set *layout)
{
    tz_growth_params g;
    tz_growth *growth = NULL;
    bool more = true;
    tz_params_default(&tz_growth_param_table, &g);
    g.seed = seed;
    g.rings = p->rings;
    g.coherent = p->candidates;
    g.optimise = p->optimise;
    g.ratio = p->ratio;
    g.overlap = p->overlap;
    g.balance = p->balance;
    g.most = p->most;
    tz_status s = tz_growth_begin(ctx, exemplar, &g, layout, &growth);
    if (s != TZ_OK)
        return s;
    tz_progress_begin(ctx, "grow", "elements",
                      (int64_t)fmax(1, fmin(2e9, wanted(exemplar, layout))));
    while (more && s == TZ_OK) {
        const int32_t before = layout->element.n;
        s = tz_growth_step(growth, STEP, &more);
        tz_progress_add(ctx, layout->element.n - before);
    }
    tz_progress_end(ctx);
    tz_growth_end(growth);
    return s;
}

static tz_status solve(tz_ctx *ctx, const tz_element_set *exemplar,
                       const tz_element_arrange_params *p, uint64_t seed,
                       tz_element_set *layout)
{
    static const tz_energy_start start[] = {TZ_ENERGY_GIVEN, TZ_ENERGY_PATCHES,
                                            TZ_ENERGY_NOISE};
    tz_energy_params e;
    tz_params_default(&tz_energy_param_table, &e);
    e.seed = seed;
    e.start = (int32_t)start[p->method];
    e.iterations = p->iterations >= 0                ? p->iterations
                   : p->method == TZ_ELEMENTS_GROWTH ? 3
                                                     : 20;
    if (e.start == TZ_ENERGY_GIVEN && (e.iterations == 0 || layout->element.n == 0))
        return TZ_OK;
    return tz_energy_solve(ctx, exemplar, &e, layout, NULL, NULL);
}

tz_status tz_element_arrange(tz_ctx *ctx, const tz_element_set *exemplar,
                             const char *name, const tz_element_arrange_params *params,
                             uint64_t seed, tz_element_set *layout,
                             tz_element_arrange_report *report)
{
    const double start = seconds();
    double grown = start;
    tz_status s = TZ_OK;
    if (seen_elements(exemplar) == 0)
        return tz_fail(ctx, TZ_INVALID,
                       "%s: has no elements to arrange; draw at least one", name);
    if (params->method == TZ_ELEMENTS_GROWTH) {
        s = grow(ctx, exemplar, params, seed, layout);
        grown = seconds();
    }
    if (s == TZ_OK)
        s = solve(ctx, exemplar, params, seed, layout);
    if (report && (s == TZ_OK || s == TZ_CANCELLED)) {
        report->elements = seen_elements(layout);
        report->filled = report->elements / wanted(exemplar, layout);
        report->grow = grown - start;
        report->solve = seconds() - grown;
    }
    return s;
}
