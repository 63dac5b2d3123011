/* SPDX-License-Identifier: Apache-2.0 */
/* What is awake, and the diagram of all: after a brush its cost is that of what is awake,
 * and of a look at each body. */
#include "fields/fill_internal.h"

tz_status tz_fill_lists(tz_fill *f)
{
    if (!f->stale)
        return TZ_OK;
    f->live.n = f->live_sample.n = f->live_node.n = 0;
    f->all_live = true;
    tz_status s = tz_array_reserve(f->ctx, &f->live, f->body.n);
    if (s == TZ_OK)
        s = tz_array_reserve(f->ctx, &f->live_sample, f->n);
    if (s == TZ_OK)
        s = tz_array_reserve(f->ctx, &f->live_node, f->n);
    for (int32_t b = 0; b < f->body.n && s == TZ_OK; b++) {
        const tz_fill_body *q = &f->body.v[b];
        if (q->gone)
            continue;
        if (q->fixed || !q->awake) {
            f->all_live = f->all_live && q->fixed;
            continue;
        }
        f->live.v[f->live.n++] = b;
        for (int32_t i = q->first; i < q->first + q->n; i++) {
            f->live_sample.v[f->live_sample.n++] = i;
            if (f->node[i] == i)
                f->live_node.v[f->live_node.n++] = i;
        }
    }
    f->stale = s != TZ_OK;
    return s;
}

static void weigh(void *arg, int32_t from, int32_t to, double sums[4])
{
    tz_fill *f = arg;
    (void)sums;
    for (int32_t k = from; k < to; k++) {
        const int32_t s = f->live_sample.v[k];
        const double r = tz_fill_radius(f, s);
        f->weight[s] = r * r;
    }
}

static void weigh_bodies(void *arg, int32_t from, int32_t to, double sums[4])
{
    tz_fill *f = arg;
    (void)sums;
    for (int32_t b = from; b < to; b++) {
        const tz_fill_body *q = &f->body.v[b];
        for (int32_t s = q->first; s < q->first + q->n; s++) {
            const double r = tz_fill_radius(f, s);
            f->weight[s] = q->gone ? -1 : r * r;
        }
    }
}

/* The diagram again where samples are awake, have come or gone. */
static tz_status change(tz_fill *f)
{
    const int32_t live = f->live_sample.n, left = f->left.n;
    tz_status s = tz_array_reserve(f->ctx, &f->changed, (int64_t)live + left);
    if (s == TZ_OK)
        s = tz_fill_blocks(f->ctx, live, weigh, f, NULL);
    if (s != TZ_OK)
        return s;
    f->changed.n = live + left;
    for (int32_t k = 0; k < live; k++)
        f->changed.v[k] = f->live_sample.v[k];
    for (int32_t k = 0; k < left; k++) {
        f->changed.v[live + k] = f->left.v[k];
        f->weight[f->left.v[k]] = -1;
    }
    return tz_power_change(f->power, f->n, f->at, f->weight, f->changed.n, f->changed.v);
}

tz_status tz_fill_diagram(tz_fill *f)
{
    const int32_t known = tz_power_get(f->power).n;
    tz_status s = tz_fill_lists(f);
    if (s != TZ_OK || (f->fresh && known == f->n))
        return s;
    if (f->all_live || known == 0 || !f->known || f->live_sample.n > f->n / 2) {
        s = tz_fill_blocks(f->ctx, f->body.n, weigh_bodies, f, NULL);
        if (s == TZ_OK)
            s = tz_power_update(f->power, f->n, f->at, f->weight);
    } else {
        s = change(f);
    }
    if (s == TZ_OK)
        f->left.n = 0;
    f->fresh = f->known = s == TZ_OK;
    return s;
}
