/* SPDX-License-Identifier: Apache-2.0 */
/* Removal of spots and of their elements: arrays stay dense, in their order. */
#include <string.h>

#include "elements/growth_internal.h"

/* Whether samples lie in the order of their elements, so that they can be moved up. */
static bool are_in_order(const tz_element_set *s)
{
    int32_t end = 0;
    for (int32_t i = 0; i < s->element.n; i++) {
        if (s->element.v[i].sample < end)
            return false;
        end = s->element.v[i].sample + s->element.v[i].samples;
    }
    return true;
}

static void remove_elements(tz_element_set *s, const int32_t *to)
{
    const bool order = are_in_order(s);
    int32_t n = 0, samples = 0;
    for (int32_t i = 0; i < s->element.n; i++) {
        if (to[i] < 0)
            continue;
        tz_element e = s->element.v[i];
        if (order) {
            memmove(&s->sample.v[samples], &s->sample.v[e.sample],
                    (size_t)e.samples * sizeof *s->sample.v);
            e.sample = samples;
            samples += e.samples;
        }
        s->element.v[n++] = e;
    }
    s->element.n = n;
    if (order)
        s->sample.n = samples;
}

/* What the counts of growth lose with a spot. */
static void uncount(tz_growth *g, const tz_growth_spot *q)
{
    g->placed -= q->out >= 0;
    if (q->copy < 0)
        return;
    const int32_t class = g->ex[q->texture].unit[q->copy].class;
    g->ex[q->texture].unit[q->copy].uses--;
    g->count[q->texture * TZ_GROWTH_CLASSES + class]--;
    g->counted[q->texture]--;
    g->cover.count[q->texture] -= q->out >= 0;
}

tz_status tz_growth_remove(tz_growth *g)
{
    int32_t *spot = NULL, *element = NULL, n = 0, elements = 0;
    const int32_t all = g->out->element.n;
    tz_status s = tz_alloc(g->ctx, &spot, (size_t)g->spot.n + 1, sizeof *spot);
    if (s == TZ_OK)
        s = tz_alloc(g->ctx, &element, (size_t)all + 1, sizeof *element);
    if (s != TZ_OK)
        goto done;
    memset(element, 0, (size_t)all * sizeof *element);
    for (int32_t i = 0; i < g->spot.n; i++) {
        const tz_growth_spot *q = &g->spot.v[i];
        spot[i] = q->gone ? -1 : n++;
        if (q->gone)
            uncount(g, q);
        if (q->gone && q->out >= 0)
            element[q->out] = -1;
    }
    for (int32_t i = 0; i < all; i++)
        if (element[i] == 0)
            element[i] = elements++;
    remove_elements(g->out, element);
    int32_t queued = 0;
    for (int32_t i = 0; i < g->queue_n; i++) {
        const int32_t to = spot[g->queue[(g->queue_head + i) % g->queue_cap]];
        if (to >= 0)
            g->queue[(g->queue_head + queued++) % g->queue_cap] = to;
    }
    g->queue_n = queued;
    memset(g->head, 0xff, (size_t)g->nx * (size_t)g->ny * sizeof *g->head);
    for (int32_t i = 0; i < g->spot.n; i++) {
        if (spot[i] < 0)
            continue;
        tz_growth_spot *q = &g->spot.v[spot[i]];
        *q = g->spot.v[i];
        q->out = q->out < 0 ? -1 : element[q->out];
    }
    g->spot.n = n;
    g->filled = 0;
    for (int32_t i = 0; i < n; i++)
        tz_growth_link(g, i);
done:
    tz_free(g->ctx, spot);
    tz_free(g->ctx, element);
    if (s != TZ_OK)
        for (int32_t i = 0; i < g->spot.n; i++)
            g->spot.v[i].gone = false;
    return s;
}
