/* SPDX-License-Identifier: Apache-2.0 */
/* Classes and samples. What the document names keeps its name; the rest is clustered by
 * the look of its symbols: element_cluster.c. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "elements/element_cluster.h"
#include "elements/element_svg_internal.h"

enum { MOST_SAMPLES = 9, HEADS = 4096 };

typedef tz_element_look feature; /* count: unnamed elements; kind: cluster, then kind */

/* ---- features ---------------------------------------------------------------------- */

static double linear(double c)
{
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

/** Mean colour of a thing, parts weighted by the area of their boxes. */
static void color_of(const tz_element_reader *r, const tz_thing *t, double lab[3])
{
    double sum = 0;
    lab[0] = lab[1] = lab[2] = 0;
    for (int32_t i = 0; i < t->items; i++) {
        const tz_part *p = &r->part.v[r->item.v[t->item + i]];
        const uint32_t color = p->look.fill & 255 ? p->look.fill : p->look.stroke;
        const double w = p->look.width + p->box.x1 - p->box.x0,
                     h = p->look.width + p->box.y1 - p->box.y0, a = w * h + 1e-30;
        double rgb[3], one[3];
        for (int k = 0; k < 3; k++)
            rgb[k] = linear((color >> (24 - 8 * k) & 255) / 255.0);
        tz_element_lab(rgb, one);
        for (int k = 0; k < 3; k++)
            lab[k] += one[k] * a;
        sum += a;
    }
    for (int k = 0; k < 3; k++)
        lab[k] /= sum > 0 ? sum : 1;
}

static void describe(const tz_element_reader *r, const tz_thing *t,
                     const tz_element_symbol *y, double radius, feature *f)
{
    const tz_polys polys = {
        {y->outline.v, y->outline.n, 0}, {y->part.v, y->part.n, 0}, {0}};
    double lab[3];
    color_of(r, t, lab);
    tz_element_look_at(lab, &polys, y->radius, radius, f);
}

/* ---- names ------------------------------------------------------------------------- */

static tz_status add_kind(tz_element_reader *r, const char *name)
{
    tz_element_kind k = {0};
    tz_status s = tz_strdup(r->ctx, name, &k.name);
    if (s == TZ_OK)
        s = tz_array_push(r->ctx, &r->set.kind, k);
    if (s != TZ_OK)
        tz_free(r->ctx, k.name);
    return s;
}

/** Kinds of the things that have a name; -1 for the others. */
static tz_status name_kinds(tz_element_reader *r)
{
    int32_t head[HEADS];
    tz_status s = TZ_OK;
    TZ_ARRAY(int32_t)
    chain = {0};
    memset(head, 255, sizeof head);
    for (int32_t i = 0; i < r->set.element.n && s == TZ_OK; i++) {
        const char *name = r->thing.v[i].name;
        uint64_t h = 14695981039346656037u;
        r->set.element.v[i].kind = -1;
        if (!name || !*name)
            continue;
        for (const char *p = name; *p; p++)
            h = (h ^ (unsigned char)*p) * 1099511628211u;
        int32_t *first = &head[(h >> 20) % HEADS], k = *first;
        while (k >= 0 && k < chain.n && strcmp(r->set.kind.v[k].name, name) != 0)
            k = chain.v[k];
        if (k < 0) {
            k = r->set.kind.n;
            s = tz_array_push(r->ctx, &chain, *first);
            if (s == TZ_OK)
                s = add_kind(r, name);
            *first = k;
        }
        r->set.element.v[i].kind = k;
    }
    tz_array_free(r->ctx, &chain);
    return s;
}

/** Clusters what has no name and appends a kind a cluster that is used. */
static tz_status cluster(tz_element_reader *r, feature *f)
{
    int32_t kind_of[TZ_ELEMENT_CLASSES];
    const int32_t n = r->set.symbol.n;
    tz_status s = tz_element_cluster(r->ctx, f, n, r->opt.classes);
    memset(kind_of, 255, sizeof kind_of);
    for (int32_t i = 0, number = 0; i < n && s == TZ_OK; i++) {
        if (f[i].count == 0)
            continue;
        if (kind_of[f[i].kind] < 0) {
            char name[32];
            snprintf(name, sizeof name, "class-%d", ++number);
            kind_of[f[i].kind] = r->set.kind.n;
            s = add_kind(r, name);
        }
        f[i].kind = kind_of[f[i].kind];
    }
    return s;
}

/** A kind has an axis that matters where most of its elements are far from round. */
static tz_status orient(tz_element_reader *r, const feature *f)
{
    int32_t *votes = NULL;
    tz_status s = tz_alloc_zero(r->ctx, &votes, (size_t)r->set.kind.n, sizeof *votes);
    for (int32_t i = 0; i < r->set.element.n && s == TZ_OK; i++) {
        const tz_element *e = &r->set.element.v[i];
        votes[e->kind] += f[e->symbol].fullness < 0.75 ? 1 : -1;
    }
    for (int32_t k = 0; k < r->set.kind.n && s == TZ_OK; k++)
        r->set.kind.v[k].oriented = votes[k] > 0;
    tz_free(r->ctx, votes);
    return s;
}

/* ---- samples ----------------------------------------------------------------------- */

typedef struct axis {
    tz_vec2 at[MOST_SAMPLES];
    int32_t n;
} axis;

static tz_status find_axis(tz_element_reader *r, const tz_element_symbol *y, axis *a)
{
    const tz_polys polys = {
        {y->outline.v, y->outline.n, 0}, {y->part.v, y->part.n, 0}, {0}};
    tz_status s = tz_polys_axis(r->ctx, &polys, MOST_SAMPLES, a->at, &a->n);
    if (a->n == 1)
        a->at[0] = (tz_vec2){0, 0}; /* where the element is */
    return s;
}

/** Sample k of n, at p of the symbol. */
static tz_sample sample_at(const tz_element *e, tz_vec2 p, double c, double d, int32_t k,
                           int32_t n)
{
    const tz_vec3 at = {e->at.x + c * p.x - d * p.y, e->at.y + d * p.x + c * p.y,
                        e->at.z};
    return (tz_sample){at, k, 1.0 / n};
}

static tz_status sample(tz_element_reader *r)
{
    tz_element_set *set = &r->set;
    axis *of = NULL;
    tz_status s = tz_alloc_zero(r->ctx, &of, (size_t)set->symbol.n, sizeof *of);
    for (int32_t i = 0; i < set->symbol.n && s == TZ_OK; i++)
        s = find_axis(r, &set->symbol.v[i], &of[i]);
    for (int32_t i = 0; i < set->element.n && s == TZ_OK; i++) {
        tz_element *e = &set->element.v[i];
        const axis *a = &of[e->symbol];
        const double c = cos(e->angle) * e->scale, d = sin(e->angle) * e->scale;
        e->sample = set->sample.n;
        e->samples = a->n;
        for (int32_t k = 0; k < a->n && s == TZ_OK; k++)
            s = tz_array_push(r->ctx, &set->sample,
                              sample_at(e, a->at[k], c, d, k, a->n));
    }
    tz_free(r->ctx, of);
    return s;
}

tz_status tz_element_classes(tz_element_reader *r)
{
    feature *f = NULL;
    bool unnamed = false;
    tz_status s = tz_alloc_zero(r->ctx, &f, (size_t)r->set.symbol.n, sizeof *f);
    if (s == TZ_OK)
        s = name_kinds(r);
    for (int32_t i = 0; i < r->set.element.n && s == TZ_OK; i++) {
        const tz_element *e = &r->set.element.v[i];
        feature *g = &f[e->symbol];
        if (g->fullness == 0)
            describe(r, &r->thing.v[i], &r->set.symbol.v[e->symbol],
                     r->set.symbol.v[e->symbol].radius, g);
        g->count += e->kind < 0;
        unnamed = unnamed || e->kind < 0;
    }
    if (s == TZ_OK && unnamed)
        s = cluster(r, f);
    for (int32_t i = 0; i < r->set.element.n && s == TZ_OK; i++)
        if (r->set.element.v[i].kind < 0)
            r->set.element.v[i].kind = f[r->set.element.v[i].symbol].kind;
    if (s == TZ_OK)
        s = orient(r, f);
    tz_free(r->ctx, f);
    return s == TZ_OK ? sample(r) : s;
}
