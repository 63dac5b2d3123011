/* SPDX-License-Identifier: Apache-2.0 */
/* Editing by example from above: who is who, who is alike, then the same done to all. */
#include "elements/propagate.h"

#include <string.h>

#include "elements/propagate_internal.h"

static const tz_param rows[] = {
    {"alike", TZ_PARAM_DOUBLE, offsetof(tz_propagate_params, alike), 0, 1, "0", "", NULL,
     "Largest difference of neighbourhoods, in spacings; 0 finds it"},
    {"radius", TZ_PARAM_DOUBLE, offsetof(tz_propagate_params, radius), 0, 1e9, "0", "px",
     NULL, "Radius of a neighbourhood; 0 takes about two rings of neighbours"},
    {"turned", TZ_PARAM_BOOL, offsetof(tz_propagate_params, turned), 0, 1, "true", "",
     NULL, "Neighbourhoods that are alike when turned follow too"},
};

const tz_param_table tz_propagate_param_table = {
    "propagate", "Changes of a few elements done to all alike", rows,
    sizeof rows / sizeof rows[0], sizeof(tz_propagate_params)};

/* What is to be done to one element, all examples together. */
typedef struct change {
    int32_t best; /* example that is most alike, -1 = none */
    double distance;
    double weight;
    tz_vec2 move;
    double cosine, sine; /* of turns */
    double grow;         /* logarithm of scale */
} change;

static tz_vec2 turned(tz_vec3 v, double angle)
{
    const double c = cos(angle), s = sin(angle);
    return (tz_vec2){c * v.x - s * v.y, s * v.x + c * v.y};
}

/* Adds an example's move, turn and scale with the weight of its likeness. */
static void add_change(const tz_propagation *g, const tz_example *x, tz_likeness l,
                       change *c)
{
    const tz_element *a = &g->before->element.v[x->before],
                     *b = &g->after->element.v[x->after];
    const double far = (double)l.distance / fmax(x->alike, 1e-9);
    const double w = 1 / (far * far + 1e-4);
    const tz_vec2 v =
        turned(tz_domain_vector(&g->before->domain, a->at, b->at), (double)l.turn);
    c->move.x += w * v.x, c->move.y += w * v.y;
    c->cosine += w * cos(b->angle - a->angle), c->sine += w * sin(b->angle - a->angle);
    c->grow += w * log(b->scale / a->scale);
    c->weight += w;
}

/* Removal counts as no move; what most alike examples want, moved or removed, is done. */
static change change_of(const tz_propagation *g, int32_t i)
{
    const int32_t n = g->example.n;
    change c = {.best = -1, .distance = HUGE_VAL};
    if (g->changed[i] || g->before->element.v[i].fixed)
        return c;
    for (int32_t k = 0; k < n; k++) {
        const tz_example *x = &g->example.v[k];
        const tz_likeness l = g->likeness[(ptrdiff_t)i * n + k];
        if (x->added || !((double)l.distance <= x->alike))
            continue;
        if ((double)l.distance < c.distance)
            c.best = k, c.distance = (double)l.distance;
        if (x->after >= 0)
            add_change(g, x, l, &c);
    }
    return c;
}

/* ---- output ---------------------------------------------------------------------- */

/* A copy of element j of `after` somewhere, with its own source and fixity. */
static tz_status put(const tz_propagation *g, tz_element_set *out, int32_t j, tz_vec3 at,
                     double turn, double scale)
{
    const tz_element *b = &g->after->element.v[j];
    tz_status s = tz_element_set_place(out, g->after, j, at, turn, scale);
    if (s == TZ_OK) {
        tz_element *e = &out->element.v[out->element.n - 1];
        e->source = b->source;
        e->fixed = b->fixed;
        if (e->at.x == b->at.x && e->at.y == b->at.y && turn == 0 && scale == 1)
            memcpy(&out->sample.v[e->sample], &g->after->sample.v[b->sample],
                   (size_t)b->samples * sizeof *out->sample.v); /* to the bit */
    }
    return s;
}

static tz_status follow(const tz_propagation *g, tz_element_set *out, int32_t i, change c)
{
    const tz_example *x = &g->example.v[c.best];
    const tz_element *a = &g->before->element.v[x->before], *e = &g->before->element.v[i];
    if (x->after < 0)
        return TZ_OK; /* removed */
    const tz_element *b = &g->after->element.v[x->after];
    const tz_vec3 at = {e->at.x + c.move.x / c.weight, e->at.y + c.move.y / c.weight,
                        e->at.z};
    const double turn = atan2(c.sine, c.cosine), scale = exp(c.grow / c.weight);
    if (g->kind[b->kind] == a->kind &&
        strcmp(g->after->symbol.v[b->symbol].id, g->before->symbol.v[a->symbol].id) == 0)
        return put(g, out, g->partner[i], at, turn, scale);
    /* another symbol: the artist's, turned as the neighbourhood is */
    const double about = (double)g->likeness[(ptrdiff_t)i * g->example.n + c.best].turn;
    tz_status s = put(g, out, x->after, at, about, e->scale / a->scale);
    if (s == TZ_OK)
        out->element.v[out->element.n - 1].depth = e->depth;
    return s;
}

/* What examples have added beside elements like this one. */
static tz_status add_beside(const tz_propagation *g, tz_element_set *out, int32_t i,
                            int32_t *followed)
{
    const int32_t n = g->example.n;
    tz_status s = TZ_OK;
    for (int32_t k = 0; k < n && s == TZ_OK && !g->changed[i]; k++) {
        const tz_example *x = &g->example.v[k];
        const tz_likeness l = g->likeness[(ptrdiff_t)i * n + k];
        if (!x->added || i == x->before || !((double)l.distance <= x->alike))
            continue;
        const tz_element *a = &g->before->element.v[x->before],
                         *b = &g->after->element.v[x->after],
                         *e = &g->before->element.v[i];
        const tz_vec2 v =
            turned(tz_domain_vector(&g->before->domain, a->at, b->at), (double)l.turn);
        const tz_vec3 at = {e->at.x + v.x, e->at.y + v.y, b->at.z};
        if (!tz_domain_contains(&out->domain, tz_domain_wrap(&out->domain, at)))
            continue;
        s = put(g, out, x->after, at, (double)l.turn, 1);
        ++*followed;
    }
    return s;
}

static tz_status write_all(const tz_propagation *g, tz_element_set *out,
                           int32_t *followed)
{
    tz_status s = TZ_OK;
    *followed = 0;
    for (int32_t j = 0; j < g->after->element.n && s == TZ_OK; j++) {
        const tz_element *b = &g->after->element.v[j];
        const int32_t i = g->origin[j];
        change c = {.best = -1};
        if (i >= 0)
            c = change_of(g, i);
        if (c.best >= 0)
            s = follow(g, out, i, c);
        else
            s = put(g, out, j, b->at, 0, 1);
        *followed += c.best >= 0;
    }
    for (int32_t i = 0; i < g->before->element.n && s == TZ_OK; i++)
        s = add_beside(g, out, i, followed);
    return s;
}

/* ---- the whole ------------------------------------------------------------------- */

static tz_status check(tz_ctx *ctx, const tz_element_set *before,
                       const tz_element_set *after, const tz_propagate_params *p)
{
    const tz_domain *a = &before->domain, *b = &after->domain;
    tz_status s = tz_element_set_check(ctx, before, "before");
    if (s == TZ_OK)
        s = tz_element_set_check(ctx, after, "after");
    if (s != TZ_OK)
        return s;
    if (a->size.x != b->size.x || a->size.y != b->size.y || a->torus != b->torus)
        return tz_fail(ctx, TZ_INVALID,
                       "propagate: the domains differ, %g x %g before and %g x %g after; "
                       "edit without changing the view",
                       a->size.x, a->size.y, b->size.x, b->size.y);
    if (!(a->size.x > 0) || !(a->size.y > 0))
        return tz_fail(ctx, TZ_INVALID, "propagate: the domain has no area");
    if (!(p->alike >= 0 && p->alike <= 1) || !(p->radius >= 0 && p->radius <= 1e9))
        return tz_fail(ctx, TZ_INVALID,
                       "propagate: alike is %g, not in 0..1, or radius %g, not in 0..1e9",
                       p->alike, p->radius);
    return TZ_OK;
}

static tz_status reserve(tz_propagation *g)
{
    const size_t n = (size_t)g->before->element.n, m = (size_t)g->after->element.n;
    tz_status s = tz_alloc(g->ctx, &g->kind, (size_t)g->after->kind.n, sizeof *g->kind);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &g->partner, n, sizeof *g->partner);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &g->origin, m, sizeof *g->origin);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &g->changed, n, 1);
    return s;
}

tz_status tz_element_propagate(tz_ctx *ctx, const tz_element_set *before,
                               const tz_element_set *after,
                               const tz_propagate_params *params, tz_element_set *out,
                               tz_propagate_report *report)
{
    tz_propagation g = {.ctx = ctx, .before = before, .after = after};
    tz_element_set set = {0};
    tz_propagate_report r = {0};
    memset(out, 0, sizeof *out);
    tz_params_default(&tz_propagate_param_table, &g.p);
    if (params)
        g.p = *params;
    tz_status s = check(ctx, before, after, &g.p);
    if (s != TZ_OK)
        return s;
    g.spacing = sqrt(tz_domain_area(&before->domain) / fmax(1, before->element.n));
    g.radius = g.p.radius > 0 ? g.p.radius : 2.1 * g.spacing;
    s = reserve(&g);
    if (s == TZ_OK)
        s = tz_propagate_pairs(&g);
    if (s == TZ_OK)
        s = tz_propagate_likeness(&g);
    if (s == TZ_OK)
        s = tz_element_set_like(ctx, after, NULL, &set);
    if (s == TZ_OK)
        s = write_all(&g, &set, &r.followed);
    r.examples = g.example.n;
    for (int32_t k = 0; k < g.example.n; k++)
        r.alike = fmax(r.alike, g.example.v[k].alike);
    if (s == TZ_OK)
        *out = set;
    else
        tz_element_set_deinit(&set);
    if (s == TZ_OK && report)
        *report = r;
    tz_free(ctx, g.kind);
    tz_free(ctx, g.partner);
    tz_free(ctx, g.origin);
    tz_free(ctx, g.changed);
    tz_free(ctx, g.likeness);
    tz_array_free(ctx, &g.example);
    return s;
}
