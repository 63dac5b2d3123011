/* SPDX-License-Identifier: Apache-2.0 */
/* The energy solver from above: check, start, then search and assignment in turns. */
#include "elements/energy.h"

#include <string.h>

#include "elements/energy_internal.h"

static const tz_param rows[] = {
    {"seed", TZ_PARAM_UINT64, offsetof(tz_energy_params, seed), 0, 1.8e19, "1", "", NULL,
     "Names the variant: the same seed gives the same texture"},
    {"start", TZ_PARAM_ENUM, offsetof(tz_energy_params, start), 0, 2, "patches", "",
     "patches|noise|given",
     "What is improved: patches of the exemplar, elements at random, or the output as it "
     "is"},
    {"iterations", TZ_PARAM_INT, offsetof(tz_energy_params, iterations), 0, 10000, "10",
     "", NULL, "How often all elements are matched and moved"},
    {"radius", TZ_PARAM_DOUBLE, offsetof(tz_energy_params, radius), 0, 1e9, "0", "px",
     NULL, "Radius of a neighbourhood; 0 takes about two rings of neighbours"},
    {"patch", TZ_PARAM_DOUBLE, offsetof(tz_energy_params, patch), 0, 1e9, "0", "px", NULL,
     "Side of the patches to start from; 0 takes two radii"},
    {"tries", TZ_PARAM_INT, offsetof(tz_energy_params, tries), 1, 1000, "16", "", NULL,
     "Patches tried for each place of the start, the best fitting one is kept"},
    {"coherent", TZ_PARAM_INT, offsetof(tz_energy_params, coherent), 1, 16, "4", "", NULL,
     "Alike neighbourhoods of the exemplar that are tried for each one found"},
    {"attribute", TZ_PARAM_DOUBLE, offsetof(tz_energy_params, attribute), 0, 100, "1", "",
     NULL, "Weight of orientation and size against position"},
    {"border", TZ_PARAM_DOUBLE, offsetof(tz_energy_params, border), 0, 1, "0.25", "",
     NULL, "How much the exemplar's border is favoured near the output's"},
    {"shape", TZ_PARAM_ENUM, offsetof(tz_energy_params, shape), 0, 2, "rigid", "",
     "rigid|similarity|bend", "What long elements may do: turn, also grow, or bend"},
    {"existence", TZ_PARAM_BOOL, offsetof(tz_energy_params, existence), 0, 1, "false", "",
     NULL, "Adds elements where some are missing and removes those that are too many"},
};

const tz_param_table tz_energy_param_table = {
    "energy", "Elements arranged by energy minimisation", rows,
    sizeof rows / sizeof rows[0], sizeof(tz_energy_params)};

/* ---- state ----------------------------------------------------------------------- */

void tz_energy_state_deinit(tz_energy_state *t)
{
    tz_ctx *ctx = t->ctx;
    tz_free(ctx, t->sample);
    tz_free(ctx, t->place);
    tz_free(ctx, t->owner);
    tz_free(ctx, t->label);
    tz_free(ctx, t->at);
    tz_free(ctx, t->attribute);
    tz_free(ctx, t->weight);
    tz_free(ctx, t->match);
    tz_free(ctx, t->cost);
    tz_free(ctx, t->count);
    tz_free(ctx, t->near);
    tz_free(ctx, t->pair);
    tz_free(ctx, t->pull);
    tz_free(ctx, t->vote_first);
    tz_array_free(ctx, &t->vote);
    tz_array_free(ctx, &t->edge);
    tz_cells_free(ctx, &t->cells);
    *t = (tz_energy_state){0};
}

static tz_status reserve(tz_energy_state *t)
{
    const size_t n = (size_t)t->n, edges = n * TZ_ENERGY_NEAR;
    tz_ctx *ctx = t->ctx;
    tz_status s = tz_alloc(ctx, &t->sample, n, sizeof *t->sample);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &t->place, n, sizeof *t->place);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &t->owner, n, sizeof *t->owner);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &t->label, n, sizeof *t->label);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &t->at, n, sizeof *t->at);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &t->attribute, n, sizeof *t->attribute);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &t->weight, n, sizeof *t->weight);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &t->match, n, sizeof *t->match);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &t->cost, n, sizeof *t->cost);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &t->count, n, sizeof *t->count);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &t->near, edges, sizeof *t->near);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &t->pair, edges, sizeof *t->pair);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &t->pull, edges, sizeof *t->pull);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &t->vote_first, n + 2, sizeof *t->vote_first);
    return s;
}

/* A copy starts as what it is a copy of, sample by sample. */
static int32_t first_match(const tz_energy_state *t, const tz_element *e, int32_t k,
                           int32_t label)
{
    const tz_element_set *from = t->x->set;
    if (e->source < 0 || e->source >= from->element.n)
        return -1;
    const tz_element *source = &from->element.v[e->source];
    const int32_t m = k - e->sample;
    if (m >= source->samples || t->x->label[source->sample + m] != label)
        return -1;
    return source->sample + m;
}

tz_status tz_energy_state_init(tz_ctx *ctx, tz_energy_state *t,
                               const tz_energy_exemplar *x, tz_element_set *output,
                               const tz_energy_params *p)
{
    *t = (tz_energy_state){.ctx = ctx,
                           .x = x,
                           .set = output,
                           .seed = p->seed,
                           .border = p->border,
                           .shape = p->shape,
                           .n = output->sample.n};
    tz_status s = reserve(t);
    for (int32_t k = 0; k < t->n && s == TZ_OK; k++)
        t->at[k] = output->sample.v[k].at;
    if (s == TZ_OK)
        s = tz_cells_fill(ctx, &t->cells, &output->domain, t->at, t->n, x->radius);
    if (s != TZ_OK) {
        tz_energy_state_deinit(t);
        return s;
    }
    for (int32_t o = 0; o < t->n; o++) {
        t->sample[o] = t->cells.item.v[o];
        t->place[t->sample[o]] = o;
    }
    for (int32_t i = 0; i < output->element.n; i++) {
        const tz_element *e = &output->element.v[i];
        for (int32_t k = e->sample; k < e->sample + e->samples; k++) {
            const int32_t o = t->place[k];
            const tz_sample *q = &output->sample.v[k];
            t->owner[o] = i;
            t->at[o] = q->at;
            t->label[o] = tz_energy_label(x, e->kind, q->id);
            t->match[o] = first_match(t, e, k, t->label[o]);
            t->weight[o] = (float)q->weight;
            t->weighted = t->weighted || q->weight != 1;
        }
    }
    return TZ_OK;
}

/* ---- the solver ------------------------------------------------------------------ */

/* Every sample belongs to one element. */
static tz_status check_samples(tz_ctx *ctx, const tz_element_set *s, const char *name)
{
    uint8_t *owned = NULL;
    tz_status st = tz_element_set_check(ctx, s, name);
    if (st == TZ_OK)
        st = tz_alloc_zero(ctx, &owned, (size_t)s->sample.n, 1);
    if (st != TZ_OK)
        return st;
    int32_t once = 0;
    for (int32_t i = 0; i < s->element.n; i++)
        for (int32_t k = 0; k < s->element.v[i].samples; k++) {
            uint8_t *o = &owned[s->element.v[i].sample + k];
            once += *o == 0 ? 1 : -1;
            *o = 1;
        }
    tz_free(ctx, owned);
    return once == s->sample.n
               ? TZ_OK
               : tz_fail(ctx, TZ_INVALID,
                         "%s: samples are shared by elements or belong to none", name);
}

static tz_status check(tz_ctx *ctx, const tz_element_set *exemplar,
                       const tz_energy_params *p, const tz_element_set *output)
{
    const tz_vec3 size = output->domain.size;
    for (int32_t i = 0; i < (int32_t)(sizeof rows / sizeof rows[0]); i++) {
        const char *at = (const char *)p + rows[i].offset;
        const double v =
            rows[i].type == TZ_PARAM_DOUBLE ? *(const double *)(const void *)at
            : rows[i].type == TZ_PARAM_UINT64 || rows[i].type == TZ_PARAM_BOOL
                ? 0
                : (double)*(const int32_t *)(const void *)at;
        if (!(v >= rows[i].min && v <= rows[i].max))
            return tz_fail(ctx, TZ_INVALID, "energy: %s is %g, not in %g..%g",
                           rows[i].name, v, rows[i].min, rows[i].max);
    }
    if (exemplar->element.n == 0)
        return tz_fail(ctx, TZ_INVALID, "energy: the exemplar has no elements");
    if (!(size.x > 0) || !(size.y > 0) || !isfinite(size.x) || !isfinite(size.y))
        return tz_fail(ctx, TZ_INVALID, "energy: the domain of %g x %g has no area",
                       size.x, size.y);
    tz_status s = check_samples(ctx, exemplar, "exemplar");
    if (s == TZ_OK)
        s = check_samples(ctx, output, "output");
    for (int32_t i = 0; s == TZ_OK && i < output->element.n; i++)
        if (output->element.v[i].kind >= exemplar->kind.n)
            s = tz_fail(ctx, TZ_INVALID,
                        "energy: element %d of the output is of a class that the "
                        "exemplar does not have",
                        i);
    return s;
}

/* The hook may have moved things. */
static void read_positions(tz_energy_state *t)
{
    for (int32_t o = 0; o < t->n; o++)
        t->at[o] = t->set->sample.v[t->sample[o]].at;
}

/* Not before things have settled a little, and early enough for what comes to settle. */
static bool may_change(const tz_energy_params *p, int32_t i)
{
    return p->existence && i > 0 && 2 * i <= p->iterations;
}

static tz_status iterate(tz_energy_state *t, const tz_energy_params *p, double *energy)
{
    const int32_t iterations = p->iterations;
    double e = 0;
    bool changed = false;
    tz_status s = tz_energy_search(t, 0, &e);
    if (energy)
        energy[0] = e;
    for (int32_t i = 0; i < iterations && s == TZ_OK; i++) {
        s = tz_ctx_cancelled(t->ctx) ? TZ_CANCELLED : tz_energy_assign(t);
        if (s == TZ_OK)
            s = tz_energy_search(t, i + 1, &e);
        if (s == TZ_OK && may_change(p, i)) {
            s = tz_energy_existence(t, i + 1, &changed);
            if (s == TZ_OK && changed)
                s = tz_energy_search(t, i + 1, &e);
        }
        if (s != TZ_OK)
            break;
        if (energy)
            energy[i + 1] = e;
        if (t->hook && t->hook->after) {
            s = t->hook->after(t->hook->user, t->set, i, e);
            read_positions(t);
        }
        tz_progress_add(t->ctx, 1);
    }
    return s;
}

tz_status tz_energy_solve(tz_ctx *ctx, const tz_element_set *exemplar,
                          const tz_energy_params *params, tz_element_set *output,
                          const tz_energy_hook *hook, double *energy)
{
    tz_energy_exemplar x = {.ctx = ctx};
    tz_energy_state t = {.ctx = ctx};
    tz_status s = check(ctx, exemplar, params, output);
    if (s == TZ_OK && output->kind.n == 0) {
        const tz_domain domain = output->domain;
        tz_element_set_deinit(output);
        s = tz_element_set_like(ctx, exemplar, &domain, output);
        output->domain = domain;
    }
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; energy && i <= params->iterations; i++)
        energy[i] = 0;
    tz_progress_begin(ctx, "energy", "iterations", params->iterations);
    s = tz_energy_exemplar_init(ctx, &x, exemplar, params);
    if (s == TZ_OK && params->start != TZ_ENERGY_GIVEN)
        s = tz_energy_fill(ctx, exemplar, params,
                           params->patch > 0 ? params->patch : 2 * x.radius, output);
    if (s == TZ_OK && params->start == TZ_ENERGY_GIVEN && output->domain.zones)
        s = tz_energy_constrain(output, exemplar, params->seed);
    if (s == TZ_OK && output->element.n > 0) {
        s = tz_energy_state_init(ctx, &t, &x, output, params);
        t.hook = hook;
        if (s == TZ_OK)
            s = iterate(&t, params, energy);
    }
    tz_progress_end(ctx);
    tz_energy_state_deinit(&t);
    tz_energy_exemplar_deinit(&x);
    return s;
}
