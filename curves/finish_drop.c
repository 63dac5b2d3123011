/* SPDX-License-Identifier: Apache-2.0 */
/* Lines that end go as a whole, up to the next junction: those first that are shortest for
 * each end they rid of. */
#include <stdlib.h>

#include "curves/finish_internal.h"

typedef struct ranked {
    double length;
    int32_t edge, ends;
} ranked;

static int by_length(const void *a, const void *b)
{
    const ranked *p = a, *q = b;
    if (p->length / p->ends != q->length / q->ends)
        return p->length / p->ends < q->length / q->ends ? -1 : 1;
    return (p->edge > q->edge) - (p->edge < q->edge);
}

tz_status tz_finish_drop(tz_net_edit *e, const tz_finish_limits *l, double share,
                         double most)
{
    const tz_net *n = e->net;
    TZ_ARRAY(ranked)
    list = {0};
    bool *busy = NULL;
    double over = tz_net_ends(n, l->margin) - most, left = share * n->length;
    tz_status s = tz_alloc_zero(n->ctx, &busy, (size_t)n->set.node.n, sizeof *busy);
    for (int32_t i = 0; i < n->edge.n && s == TZ_OK && over > 0; i++) {
        const tz_net_edge *d = &n->edge.v[i];
        const int ends = (int)tz_net_dangles(n, d->from, l->margin) +
                         (int)tz_net_dangles(n, d->to, l->margin);
        if (ends > 0)
            s = tz_array_push(n->ctx, &list, ((ranked){d->length, i, ends}));
    }
    if (s == TZ_OK && list.n > 1)
        qsort(list.v, (size_t)list.n, sizeof *list.v, by_length);
    for (int32_t i = 0; i < list.n && s == TZ_OK && over > 0; i++) {
        const tz_net_edge *d = &n->edge.v[list.v[i].edge];
        /* a junction loses one line a round: two might leave an end */
        if (d->length > left || (busy[d->from] && tz_net_degree(n, d->from) > 1) ||
            (busy[d->to] && tz_net_degree(n, d->to) > 1))
            continue;
        busy[d->from] = busy[d->to] = true;
        for (int32_t k = 0; k < d->steps; k++)
            e->gone[n->step.v[d->step + k] >> 1] = true;
        e->removed++;
        left -= d->length;
        over -= list.v[i].ends;
    }
    tz_array_free(n->ctx, &list);
    tz_free(n->ctx, busy);
    return s;
}
