/* SPDX-License-Identifier: Apache-2.0 */
/* Everything about the exemplar that the search asks for again and again: labels,
 * attributes and neighbourhoods of all samples. */
#include <stdlib.h>
#include <string.h>

#include "elements/energy_internal.h"

enum { MOST = TZ_PAIRING_MOST };

double tz_energy_spacing(const tz_element_set *set)
{
    const double area = tz_domain_area(&set->domain);
    return sqrt(area / (set->element.n > 0 ? set->element.n : 1));
}

void tz_energy_exemplar_deinit(tz_energy_exemplar *x)
{
    tz_ctx *ctx = x->ctx;
    tz_free(ctx, x->owner);
    tz_free(ctx, x->label);
    tz_free(ctx, x->a);
    tz_free(ctx, x->b);
    tz_free(ctx, x->inner);
    tz_free(ctx, x->member);
    tz_free(ctx, x->similar);
    tz_free(ctx, x->by_label);
    tz_free(ctx, x->label_first);
    tz_free(ctx, x->key);
    tz_free(ctx, x->side);
    *x = (tz_energy_exemplar){0};
}

static tz_status reserve(tz_energy_exemplar *x)
{
    const size_t n = (size_t)x->n;
    tz_ctx *ctx = x->ctx;
    tz_status s = tz_alloc(ctx, &x->owner, n, sizeof *x->owner);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &x->label, n, sizeof *x->label);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &x->a, n, sizeof *x->a);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &x->b, n, sizeof *x->b);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &x->inner, n, sizeof *x->inner);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &x->member, n * MOST, sizeof *x->member);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &x->similar, n * (size_t)x->coherent, sizeof *x->similar);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &x->by_label, n, sizeof *x->by_label);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &x->label_first, n + 2, sizeof *x->label_first);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &x->key, n, sizeof *x->key);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &x->side, n, sizeof *x->side);
    return s;
}

/* ---- labels and attributes ------------------------------------------------------- */

static uint64_t key_of(int32_t kind, int32_t id)
{
    return (uint64_t)(uint32_t)kind << 32 | (uint32_t)id;
}

static int by_key(const void *a, const void *b)
{
    const uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return (p > q) - (p < q);
}

int32_t tz_energy_label(const tz_energy_exemplar *x, int32_t kind, int32_t id)
{
    const uint64_t key = key_of(kind, id);
    const uint64_t *found =
        bsearch(&key, x->key, (size_t)x->labels, sizeof *x->key, by_key);
    return found ? (int32_t)(found - x->key) : -1;
}

tz_vec2 tz_energy_attribute(const tz_energy_exemplar *x, const tz_element *e,
                            double frame)
{
    /* several samples show the orientation by themselves */
    const bool turned = x->set->kind.v[e->kind].oriented && e->samples == 1;
    const double angle = turned ? e->angle - frame : 0;
    const double size = sqrt(x->attribute) * e->radius;
    return (tz_vec2){size * cos(angle), size * sin(angle)};
}

static void label_samples(tz_energy_exemplar *x)
{
    const tz_element_set *set = x->set;
    for (int32_t i = 0; i < set->element.n; i++) {
        const tz_element *e = &set->element.v[i];
        for (int32_t k = e->sample; k < e->sample + e->samples; k++) {
            x->owner[k] = i;
            x->key[k] = key_of(e->kind, set->sample.v[k].id);
        }
    }
    qsort(x->key, (size_t)x->n, sizeof *x->key, by_key);
    for (int32_t k = 0; k < x->n; k++)
        if (k == 0 || x->key[k] != x->key[x->labels - 1])
            x->key[x->labels++] = x->key[k];
    for (int32_t k = 0; k < x->n; k++) {
        const tz_element *e = &set->element.v[x->owner[k]];
        x->label[k] = tz_energy_label(x, e->kind, set->sample.v[k].id);
        x->label_first[x->label[k] + 1]++;
        const tz_vec2 q = tz_energy_attribute(x, e, 0);
        x->a[k] = (float)q.x, x->b[k] = (float)q.y;
    }
    for (int32_t k = 0; k < x->labels; k++)
        x->label_first[k + 1] += x->label_first[k];
    for (int32_t k = x->n - 1; k >= 0; k--)
        x->by_label[--x->label_first[x->label[k] + 1]] = k;
    /* the loop above has moved each offset to its label's begin */
    memmove(x->label_first, x->label_first + 1,
            (size_t)x->labels * sizeof *x->label_first);
    x->label_first[x->labels] = x->n;
    for (int32_t k = 1; k < x->n; k++) {
        const int32_t p = x->by_label[k - 1], q = x->by_label[k];
        const float da = x->a[p] - x->a[q], db = x->b[p] - x->b[q];
        if (x->label[p] == x->label[q] &&
            sqrt((double)(da * da + db * db)) > 1e-6 * x->spacing)
            x->attributes = true;
    }
}

/* ---- neighbourhoods -------------------------------------------------------------- */

static void add_column(tz_energy_exemplar *x, int32_t centre, tz_nearby v)
{
    tz_pairing_side *s = &x->side[centre];
    const int32_t j = s->n++;
    const bool own = x->owner[v.id] == x->owner[centre];
    x->member[(ptrdiff_t)centre * MOST + j] = v.id;
    s->x[j] = v.x, s->y[j] = v.y;
    s->a[j] = x->a[v.id], s->b[j] = x->b[v.id];
    s->l[j] = (float)(x->label[v.id] + (own ? x->labels : 0));
}

/* Columns by label; who they are goes along. */
static void sort_columns(tz_energy_exemplar *x, int32_t k, uint64_t inner)
{
    int32_t order[MOST], was[MOST], *member = &x->member[(ptrdiff_t)k * MOST];
    const int32_t n = x->side[k].n;
    tz_pairing_sort(&x->side[k], order);
    memcpy(was, member, (size_t)n * sizeof *was);
    x->inner[k] = 0;
    for (int32_t j = 0; j < n; j++) {
        member[j] = was[order[j]];
        x->inner[k] |= (inner >> order[j] & 1) << j;
    }
}

typedef struct neighbour_job {
    tz_energy_exemplar *x;
    const tz_vec3 *at;
    const tz_cells *cells;
    double reach;
} neighbour_job;

/* The element's own samples, whatever their distance, then the nearest. */
static tz_status look_about(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)ctx, (void)worker;
    const neighbour_job *job = arg;
    tz_energy_exemplar *x = job->x;
    const int32_t k = (int32_t)i;
    const tz_element *e = &x->set->element.v[x->owner[k]];
    tz_nearby found[MOST];
    uint64_t inner = 0;
    for (int32_t m = e->sample; m < e->sample + e->samples && x->side[k].n < MOST / 2;
         m++)
        if (m != k) {
            const tz_vec3 v = tz_domain_vector(&x->set->domain, job->at[k], job->at[m]);
            inner |= 1ull << x->side[k].n;
            add_column(x, k, (tz_nearby){(float)v.x, (float)v.y, 0, m});
        }
    const int32_t n =
        tz_cells_near(job->cells, job->at, job->at[k], job->reach, k, found, MOST);
    for (int32_t m = 0; m < n && x->side[k].n < MOST; m++) {
        if (x->owner[found[m].id] == x->owner[k])
            continue;
        if ((double)found[m].dist2 <= x->radius * x->radius)
            inner |= 1ull << x->side[k].n;
        add_column(x, k, found[m]);
    }
    sort_columns(x, k, inner);
    return TZ_OK;
}

static tz_status find_neighbours(tz_energy_exemplar *x)
{
    const tz_element_set *set = x->set;
    const double reach = x->radius + 0.75 * x->limit;
    tz_cells cells = {0};
    tz_vec3 *at;
    tz_status s = tz_alloc(x->ctx, &at, (size_t)x->n, sizeof *at);
    if (s != TZ_OK)
        return s;
    for (int32_t k = 0; k < x->n; k++)
        at[k] = set->sample.v[k].at;
    s = tz_cells_fill(x->ctx, &cells, &set->domain, at, x->n, reach);
    neighbour_job job = {x, at, &cells, reach};
    if (s == TZ_OK)
        s = tz_parallel_for(x->ctx, x->n, look_about, &job);
    tz_cells_free(x->ctx, &cells);
    tz_free(x->ctx, at);
    return s;
}

tz_status tz_energy_exemplar_init(tz_ctx *ctx, tz_energy_exemplar *x,
                                  const tz_element_set *set, const tz_energy_params *p)
{
    const double spacing = tz_energy_spacing(set);
    *x = (tz_energy_exemplar){.ctx = ctx,
                              .set = set,
                              .spacing = spacing,
                              /* between rings of square and hexagonal lattices alike */
                              .radius = p->radius > 0 ? p->radius : 2.1 * spacing,
                              .limit = spacing,
                              .attribute = p->attribute,
                              .n = set->sample.n,
                              .coherent = p->coherent};
    tz_status s = reserve(x);
    if (s == TZ_OK) {
        label_samples(x);
        s = find_neighbours(x);
    }
    if (s == TZ_OK)
        s = tz_energy_find_similar(x);
    if (s != TZ_OK)
        tz_energy_exemplar_deinit(x);
    return s;
}
