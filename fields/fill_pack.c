/* SPDX-License-Identifier: Apache-2.0 */
/* Bodies in the order of their places (along a Morton curve), so that neighbours lie near
 * each other in memory; those that are gone leave. */
#include <stdlib.h>
#include <string.h>

#include "fields/fill_internal.h"

typedef struct order {
    uint64_t key;
    int32_t body;
} order;

static uint64_t spread(uint64_t v)
{
    v = (v | v << 16) & 0x0000ffff0000ffffu;
    v = (v | v << 8) & 0x00ff00ff00ff00ffu;
    v = (v | v << 4) & 0x0f0f0f0f0f0f0f0fu;
    v = (v | v << 2) & 0x3333333333333333u;
    return (v | v << 1) & 0x5555555555555555u;
}

static uint64_t key_of(const tz_fill *f, const tz_fill_body *b)
{
    const tz_vec3 p = f->at[b->first], size = f->domain.size;
    const double x = fmin(fmax(p.x / size.x, 0), 1), y = fmin(fmax(p.y / size.y, 0), 1);
    return spread((uint64_t)(x * 65535)) | spread((uint64_t)(y * 65535)) << 1;
}

static int by_key(const void *a, const void *b)
{
    const order *p = a, *q = b;
    if (p->key != q->key)
        return p->key < q->key ? -1 : 1;
    return (p->body > q->body) - (p->body < q->body);
}

/* One array of `size` bytes a sample, through `room`. */
static void permute(const tz_fill *f, const order *o, int32_t bodies, void *array,
                    size_t size, char *room)
{
    char *to = room;
    for (int32_t k = 0; k < bodies; k++) {
        const tz_fill_body *b = &f->body.v[o[k].body];
        memcpy(to, (char *)array + (size_t)b->first * size, (size_t)b->n * size);
        to += (size_t)b->n * size;
    }
    if (bodies > 0)
        memcpy(array, room, (size_t)(to - room));
}

tz_status tz_fill_pack(tz_fill *f, bool sort)
{
    order *o = NULL;
    char *room = NULL;
    tz_fill_body *body = NULL;
    int32_t n = 0, samples = 0;
    const size_t widest = sizeof(tz_vec3) > (size_t)f->m * sizeof(double)
                              ? sizeof(tz_vec3)
                              : (size_t)f->m * sizeof(double);
    tz_status s = tz_alloc(f->ctx, &o, (size_t)f->body.n, sizeof *o);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &room, (size_t)f->n, widest);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &body, (size_t)f->body.n, sizeof *body);
    if (s != TZ_OK)
        goto done;
    for (int32_t i = 0; i < f->body.n; i++)
        if (!f->body.v[i].gone)
            o[n++] = (order){sort ? key_of(f, &f->body.v[i]) : 0, i};
    if (sort && n > 1)
        qsort(o, (size_t)n, sizeof *o, by_key);
    permute(f, o, n, f->at, sizeof *f->at, room);
    permute(f, o, n, f->radius, sizeof *f->radius, room);
    permute(f, o, n, f->c, sizeof *f->c, room);
    permute(f, o, n, f->rho, sizeof *f->rho, room);
    permute(f, o, n, f->wide, sizeof *f->wide, room);
    permute(f, o, n, f->o, (size_t)f->m * sizeof *f->o, room);
    permute(f, o, n, f->pressure, sizeof *f->pressure, room);
    for (int32_t k = 0; k < n; k++) {
        body[k] = f->body.v[o[k].body];
        body[k].first = samples;
        const bool tied = f->model.v[body[k].model].rigidity >= TZ_FILL_RIGID;
        for (int32_t i = 0; i < body[k].n; i++, samples++) {
            f->owner[samples] = k;
            f->node[samples] = tied ? body[k].first : samples;
        }
    }
    if (n > 0)
        memcpy(f->body.v, body, (size_t)n * sizeof *body);
    f->body.n = n, f->n = samples;
    f->stale = true, f->fresh = false;
    f->left.n = 0;
    tz_power_free(f->power); /* its neighbours had other numbers */
    f->power = NULL;
    s = tz_power_new(f->ctx, &f->domain, &f->power);
done:
    tz_free(f->ctx, o);
    tz_free(f->ctx, room);
    tz_free(f->ctx, body);
    return s;
}
