/* SPDX-License-Identifier: Apache-2.0 */
/* Growth copies neighbourhoods one by one and is local; the solver then evens out what
 * met badly, everywhere at once. Its energy knows neither overlaps nor empty room: the
 * first are pushed apart after each of its iterations (elements/spacing.h); and where it
 * is asked for by no one but ourselves, its result is taken only if it is more like the
 * exemplar than what was grown. */
#include "elements/element_arrange.h"

#include <string.h>
#include <time.h>

#include "elements/element_compare.h"
#include "elements/element_density.h"
#include "elements/energy.h"
#include "elements/growth.h"
#include "elements/spacing.h"

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
     "Elements: iterations of the energy solver; -1 = 3 after growth, if they help, and "
     "20 without."},
    {"most", TZ_PARAM_INT, AT(most), 0, 100000000, "0", "", NULL,
     "Elements: placed at most; 0 fills the domain."},
    {"shape", TZ_PARAM_ENUM, AT(shape), 0, 0, "rigid", "", "rigid|similarity|bend",
     "Elements: what becomes of long ones: moved and turned, also scaled, or bent."},
    {"existence", TZ_PARAM_BOOL, AT(existence), 0, 1, "true", "", NULL,
     "Elements: the solver also adds what its matches miss and removes what none of them "
     "has."},
    {"inside", TZ_PARAM_DOUBLE, AT(inside), 0, 1, "0", "", NULL,
     "Elements: share of the radius that must lie within --domain; 0 = the centre, 1 = "
     "all."},
};
#undef AT
const tz_param_table tz_element_arrange_param_table = {
    "elements", "Arrangement of elements over a domain.", rows,
    sizeof rows / sizeof rows[0], sizeof(tz_element_arrange_params)};

enum {
    STEP = 512, /* elements between two looks at progress and cancel */
    ROUNDS = 6, /* of pushing apart after an iteration of the solver */
    FEW = 8     /* elements have no statistics below this */
};

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
    return tz_element_density(exemplar, false) * tz_domain_area(&layout->domain);
}

/** Grows, or paints. @param[out] told  how far it has come */
static tz_status grow(tz_ctx *ctx, const tz_element_arrange_job *job,
                      tz_element_set *layout, tz_growth_report *told)
{
    const tz_element_arrange_params *p = job->params;
    static const tz_growth_texture whole = {0};
    const tz_growth_texture *texture = job->textures > 0 ? job->texture : &whole;
    const int32_t textures = job->textures > 0 ? job->textures : 1;
    tz_growth_params g;
    tz_growth *growth = NULL;
    bool more = true;
    tz_params_default(&tz_growth_param_table, &g);
    g.seed = job->seed;
    g.rings = p->rings;
    g.coherent = p->candidates;
    g.optimise = p->optimise;
    g.ratio = p->ratio;
    g.overlap = p->overlap;
    g.balance = p->balance;
    g.most = p->most;
    g.inside = p->inside;
    tz_status s = job->paint ? tz_brush_begin(ctx, job->exemplar, texture, textures, &g,
                                              layout, &growth)
                             : tz_growth_begin_palette(ctx, job->exemplar, texture,
                                                       textures, &g, layout, &growth);
    if (s != TZ_OK)
        return s;
    if (job->paint)
        s = tz_paint_apply(job->paint, growth, &layout->domain, 0);
    else
        tz_progress_begin(ctx, "grow", "elements",
                          (int64_t)fmax(1, fmin(2e9, wanted(job->exemplar, layout))));
    while (!job->paint && more && s == TZ_OK) {
        const int32_t before = layout->element.n;
        s = tz_growth_step(growth, STEP, &more);
        tz_progress_add(ctx, layout->element.n - before);
    }
    if (!job->paint)
        tz_progress_end(ctx);
    tz_growth_tell(growth, told);
    tz_growth_end(growth);
    return s;
}

/** After each iteration of the solver: nothing nearer than in the exemplar. */
static tz_status keep_apart(void *user, tz_element_set *output, int32_t iteration,
                            double energy)
{
    (void)iteration;
    (void)energy;
    return tz_spacing_relax(user, output, ROUNDS);
}

static tz_status solve(tz_ctx *ctx, const tz_element_arrange_job *job,
                       tz_element_set *layout)
{
    const tz_element_set *exemplar = job->exemplar;
    const tz_element_arrange_params *p = job->params;
    static const tz_energy_start start[] = {TZ_ENERGY_GIVEN, TZ_ENERGY_PATCHES,
                                            TZ_ENERGY_NOISE};
    tz_energy_params e;
    tz_params_default(&tz_energy_param_table, &e);
    e.seed = job->seed;
    e.shape = p->shape;
    e.existence = p->existence && p->most == 0;
    e.start = (int32_t)start[p->method];
    e.iterations = p->iterations >= 0                ? p->iterations
                   : p->method == TZ_ELEMENTS_GROWTH ? 3
                                                     : 20;
    if (e.start == TZ_ENERGY_GIVEN && (e.iterations == 0 || layout->element.n == 0))
        return TZ_OK;
    tz_spacing spacing;
    tz_status s = tz_spacing_init(ctx, exemplar, &spacing);
    if (s != TZ_OK)
        return s;
    const tz_energy_hook hook = {.after = keep_apart, .user = &spacing};
    s = tz_energy_solve(ctx, exemplar, &e, layout, &hook, NULL);
    tz_spacing_deinit(&spacing);
    return s;
}

/* ---- grown or solved: the better one ------------------------------------------------ */

/** How unlike a layout is: ratios, and what must not be, in the units of a ratio. */
static tz_status unlikeness(tz_ctx *ctx, const tz_element_set *exemplar,
                            const tz_element_set *layout, double *out)
{
    tz_element_likeness q;
    const double spacing =
        sqrt(tz_domain_area(&exemplar->domain) / seen_elements(exemplar));
    tz_status s = tz_element_compare(ctx, exemplar, layout, &q);
    if (s == TZ_OK)
        *out = q.mean + 5 * fmax(0, q.overlaps[1] - q.overlaps[0]) +
               4 * fmax(0, fabs(q.density - 1) - 0.02) +
               fmax(0, q.hole[1] - q.hole[0]) / spacing;
    return s;
}

/** Elements and samples of a layout, to go back to. */
typedef struct tz_kept {
    tz_element *element;
    tz_sample *sample;
    int32_t elements, samples;
} tz_kept;

static tz_status keep(tz_ctx *ctx, const tz_element_set *set, tz_kept *k)
{
    *k = (tz_kept){.elements = set->element.n, .samples = set->sample.n};
    tz_status s = tz_alloc(ctx, &k->element, (size_t)k->elements, sizeof *k->element);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &k->sample, (size_t)k->samples, sizeof *k->sample);
    if (s != TZ_OK)
        return s;
    memcpy(k->element, set->element.v, (size_t)k->elements * sizeof *k->element);
    memcpy(k->sample, set->sample.v, (size_t)k->samples * sizeof *k->sample);
    return TZ_OK;
}

static tz_status restore(tz_ctx *ctx, const tz_kept *k, tz_element_set *set)
{
    tz_status s = tz_array_reserve(ctx, &set->element, k->elements);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &set->sample, k->samples);
    if (s != TZ_OK)
        return s;
    memcpy(set->element.v, k->element, (size_t)k->elements * sizeof *k->element);
    memcpy(set->sample.v, k->sample, (size_t)k->samples * sizeof *k->sample);
    set->element.n = k->elements;
    set->sample.n = k->samples;
    return TZ_OK;
}

/** Solves, and goes back where that made it less like the exemplar. Guided layouts differ
 * from their exemplar on purpose: there the solver is trusted. */
static tz_status solve_if_better(tz_ctx *ctx, const tz_element_arrange_job *job,
                                 tz_element_set *layout)
{
    const tz_element_set *exemplar = job->exemplar;
    const tz_element_arrange_params *p = job->params;
    const tz_domain *d = &layout->domain;
    const bool measured = p->method == TZ_ELEMENTS_GROWTH && p->iterations < 0 &&
                          !d->region && !d->frames && !d->zones && p->most == 0 &&
                          exemplar->element.n >= FEW && layout->element.n >= FEW;
    tz_kept grown = {0};
    double before = 0, after = 0;
    if (!measured)
        return solve(ctx, job, layout);
    tz_status s = unlikeness(ctx, exemplar, layout, &before);
    if (s == TZ_OK)
        s = keep(ctx, layout, &grown);
    if (s == TZ_OK)
        s = solve(ctx, job, layout);
    if (s == TZ_OK)
        s = unlikeness(ctx, exemplar, layout, &after);
    if (s == TZ_OK && !(after < before))
        s = restore(ctx, &grown, layout);
    tz_free(ctx, grown.element);
    tz_free(ctx, grown.sample);
    return s;
}

tz_status tz_element_arrange(tz_ctx *ctx, const tz_element_arrange_job *job,
                             tz_element_set *layout, tz_element_arrange_report *report)
{
    const double start = seconds();
    const bool one = job->textures <= 1 && !job->paint;
    double grown = start;
    tz_growth_report told = {.covered = 1};
    tz_status s = TZ_OK;
    if (seen_elements(job->exemplar) == 0)
        return tz_fail(ctx, TZ_INVALID,
                       "%s: has no elements to arrange; draw at least one", job->name);
    if (job->params->method == TZ_ELEMENTS_GROWTH || !one) {
        s = grow(ctx, job, layout, &told);
        grown = seconds();
    }
    if (s == TZ_OK && one)
        s = solve_if_better(ctx, job, layout);
    if (report && (s == TZ_OK || s == TZ_CANCELLED)) {
        report->elements = seen_elements(layout);
        report->filled =
            report->elements /
            (told.expected > 0 ? told.expected : wanted(job->exemplar, layout));
        report->covered = told.covered;
        report->grow = grown - start;
        report->solve = seconds() - grown;
    }
    return s;
}
