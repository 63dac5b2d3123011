/* SPDX-License-Identifier: Apache-2.0 */
/* Greedy pairing: all pairs of like kind within the limit, nearest first. The optimal
 * pairing differs seldom at these sizes (fewer than a dozen neighbours) and costs more. */
#include "elements/neighbourhood.h"

static double pair_cost(const tz_neighbour *p, const tz_neighbour *q,
                        const tz_neighbour_weights *w)
{
    const double dx = p->offset.x - q->offset.x, dy = p->offset.y - q->offset.y;
    const double dz = p->offset.z - q->offset.z, ds = p->size - q->size;
    double cost = dx * dx + dy * dy + dz * dz + w->size * ds * ds;
    if (!isnan(p->angle) && !isnan(q->angle)) {
        const double s = sin(p->angle - q->angle);
        cost += w->angle * s * s * p->size * q->size;
    }
    return cost;
}

double tz_neighbourhood_cost(const tz_neighbour *a, int32_t na, const tz_neighbour *b,
                             int32_t nb, const tz_neighbour_weights *w)
{
    bool used_a[TZ_NEIGHBOURS_MAX] = {false}, used_b[TZ_NEIGHBOURS_MAX] = {false};
    const double limit = w->limit * w->limit;
    double sum = 0;
    if (na <= 0)
        return 0;
    if (na > TZ_NEIGHBOURS_MAX)
        na = TZ_NEIGHBOURS_MAX;
    if (nb > TZ_NEIGHBOURS_MAX)
        nb = TZ_NEIGHBOURS_MAX;
    int32_t paired = 0;
    for (;;) {
        int32_t bi = -1, bj = -1;
        double best = limit;
        for (int32_t i = 0; i < na; i++)
            for (int32_t j = 0; j < nb && !used_a[i]; j++) {
                if (used_b[j] || a[i].kind != b[j].kind)
                    continue;
                const double c = pair_cost(&a[i], &b[j], w);
                if (c < best)
                    best = c, bi = i, bj = j;
            }
        if (bi < 0)
            break;
        used_a[bi] = used_b[bj] = true;
        sum += best;
        paired++;
    }
    return (sum + (na - paired) * w->missing * limit) / na;
}
