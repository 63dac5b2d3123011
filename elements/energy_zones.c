/* SPDX-License-Identifier: Apache-2.0 */
/* Constrained selection: what stands in place of elements that zones forbid. Where kinds
 * mix at random any allowed one will do, but on a chessboard the black squares alone stand
 * farther apart than black and white do: a substitute is put only where it is no nearer
 * to another element than its kind lies, in the exemplar, to kinds that are allowed there.
 * @source [Ma11] Sec. 5, "Constrained selection" */
#include <stdlib.h>

#include "base/grid.h"
#include "elements/energy_internal.h"

enum { STREAM = 0x656e7a, TRIES = 4 };

int32_t tz_energy_choose(const tz_element_set *from, const tz_domain *d, int32_t i,
                         tz_vec3 at, tz_rng *r)
{
    const tz_element *e = from->element.v;
    const bool kept = tz_domain_allows(d, at, e[i].kind);
    int32_t n = 0, chosen = -1;
    if (kept && tz_element_may_copy(&e[i]))
        return i;
    for (int32_t k = 0; k < from->element.n; k++)
        if ((kept ? e[k].kind == e[i].kind : tz_domain_allows(d, at, e[k].kind)) &&
            tz_element_may_copy(&e[k]) && tz_rng_below(r, ++n) == 0)
            chosen = k;
    return chosen;
}

typedef struct substitute {
    tz_element_set *to;
    const tz_element_set *from;
    tz_grid grid; /* of elements of the output */
    tz_cells cells;
    tz_vec3 *at; /* of the exemplar's */
    double spacing;
} substitute;

/* How near the exemplar's element k has one of a kind that is allowed at a place. */
static double own_room(const substitute *u, int32_t k, tz_vec3 place)
{
    enum { LOOK = 24 };
    tz_nearby found[LOOK];
    const int32_t n =
        tz_cells_near(&u->cells, u->at, u->at[k], 2 * u->spacing, k, found, LOOK);
    for (int32_t j = 0; j < n; j++)
        if (tz_domain_allows(&u->to->domain, place, u->from->element.v[found[j].id].kind))
            return sqrt((double)found[j].dist2);
    return 2 * u->spacing;
}

static tz_status try_one(substitute *u, tz_energy_forbidden f, tz_rng *r)
{
    for (int k = 0; k < TRIES; k++) {
        const int32_t source =
            tz_energy_choose(u->from, &u->to->domain, f.source, f.at, r);
        if (source < 0)
            return TZ_OK;
        const double room =
            0.8 * own_room(u, source, f.at) * tz_domain_apart(&u->to->domain, f.at);
        int32_t other;
        if (tz_grid_query(&u->grid, (tz_vec2){f.at.x, f.at.y}, room, &other, 1) > 0)
            continue;
        tz_status s = tz_element_set_place(u->to, u->from, source, f.at,
                                           tz_domain_frame(&u->to->domain, f.at),
                                           tz_domain_scale(&u->to->domain, f.at));
        return s == TZ_OK
                   ? tz_grid_add(u->to->ctx, &u->grid, (tz_vec2){f.at.x, f.at.y}, &other)
                   : s;
    }
    return TZ_OK;
}

static tz_status prepare(substitute *u)
{
    tz_ctx *ctx = u->to->ctx;
    const tz_vec3 size = u->to->domain.size;
    const int32_t n = u->from->element.n;
    int32_t id;
    u->spacing = tz_energy_spacing(u->from);
    tz_status s = tz_grid_init(ctx, &u->grid, (tz_vec2){0, 0}, (tz_vec2){size.x, size.y},
                               u->spacing, u->to->domain.torus);
    for (int32_t i = 0; i < u->to->element.n && s == TZ_OK; i++) {
        const tz_vec3 p = u->to->element.v[i].at;
        s = tz_grid_add(ctx, &u->grid, (tz_vec2){p.x, p.y}, &id);
    }
    if (s == TZ_OK)
        s = tz_alloc(ctx, &u->at, (size_t)n, sizeof *u->at);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        u->at[i] = u->from->element.v[i].at;
    return s == TZ_OK
               ? tz_cells_fill(ctx, &u->cells, &u->from->domain, u->at, n, 2 * u->spacing)
               : s;
}

tz_status tz_energy_substitute(tz_element_set *to, const tz_element_set *from,
                               const tz_energy_forbidden *list, int32_t n, uint64_t seed)
{
    substitute u = {.to = to, .from = from};
    tz_status s = n > 0 ? prepare(&u) : TZ_OK;
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        tz_rng r = tz_rng_make(seed, tz_rng_stream(STREAM, (uint64_t)i, 0));
        s = try_one(&u, list[i], &r);
    }
    if (n > 0)
        tz_grid_deinit(to->ctx, &u.grid);
    tz_cells_free(to->ctx, &u.cells);
    tz_free(to->ctx, u.at);
    return s;
}

tz_status tz_energy_constrain(tz_element_set *s, const tz_element_set *from,
                              uint64_t seed)
{
    TZ_ARRAY(tz_energy_forbidden)
    list = {0};
    uint8_t *drop = NULL;
    const int32_t n = s->element.n;
    tz_status st = tz_alloc_zero(s->ctx, &drop, (size_t)n, 1);
    for (int32_t i = 0; i < n && st == TZ_OK; i++) {
        const tz_element *e = &s->element.v[i];
        tz_rng r = tz_rng_make(seed, tz_rng_stream(STREAM, (uint64_t)i, 1));
        if (e->fixed || tz_domain_allows(&s->domain, e->at, e->kind))
            continue;
        drop[i] = 1;
        st = tz_array_push(
            s->ctx, &list,
            ((tz_energy_forbidden){e->at, tz_rng_below(&r, from->element.n)}));
    }
    if (st == TZ_OK && list.n > 0)
        st = tz_energy_drop(s, drop, NULL);
    if (st == TZ_OK)
        st = tz_energy_substitute(s, from, list.v, list.n, seed);
    tz_array_free(s->ctx, &list);
    tz_free(s->ctx, drop);
    return st;
}
