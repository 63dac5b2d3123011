/* SPDX-License-Identifier: Apache-2.0 */
/* Greedy pairing: all pairs of like kind within the limit, nearest first. The optimal
 * pairing differs seldom at these sizes (fewer than a dozen neighbours) and costs more. */
#include "elements/neighbourhood.h"

/* Axes as doubled-angle vectors: sin^2(p - q) = (1 - cos 2(p - q)) / 2 without a sine a pair. */
typedef struct axis {
    double c, s; /* 0, 0 = none */
} axis;

static void axes(const tz_neighbour *v, int32_t n, axis *out)
{
    for (int32_t i = 0; i < n; i++)
        out[i] = isnan(v[i].angle) ? (axis){0, 0}
                                   : (axis){cos(2 * v[i].angle), sin(2 * v[i].angle)};
}

static double pair_cost(const tz_neighbour *p, const tz_neighbour *q, axis u, axis v,
                        const tz_neighbour_weights *w)
{
    const double dx = p->offset.x - q->offset.x, dy = p->offset.y - q->offset.y;
    const double dz = p->offset.z - q->offset.z, ds = p->size - q->size;
    double cost = dx * dx + dy * dy + dz * dz + w->size * ds * ds;
    if (!isnan(p->angle) && !isnan(q->angle))
        cost += w->angle * 0.5 * (1 - (u.c * v.c + u.s * v.s)) * p->size * q->size;
    return cost;
}

double tz_neighbourhood_cost(const tz_neighbour *a, int32_t na, const tz_neighbour *b,
                             int32_t nb, const tz_neighbour_weights *w)
{
    enum { N = TZ_NEIGHBOURS_MAX };
    double cost[N][N], best[N];
    int32_t with[N];
    bool used[N] = {false};
    axis u[N], v[N];
    const double limit = w->limit * w->limit;
    if (na <= 0)
        return 0;
    na = na > N ? N : na;
    nb = nb > N ? N : nb;
    axes(a, na, u);
    axes(b, nb, v);
    for (int32_t i = 0; i < na; i++) {
        best[i] = limit, with[i] = -1;
        for (int32_t j = 0; j < nb; j++) {
            cost[i][j] =
                a[i].kind == b[j].kind ? pair_cost(&a[i], &b[j], u[i], v[j], w) : limit;
            if (cost[i][j] < best[i])
                best[i] = cost[i][j], with[i] = j;
        }
    }
    double sum = 0;
    int32_t paired = 0;
    for (;;) {
        int32_t i = -1;
        for (int32_t k = 0; k < na; k++)
            if (with[k] >= 0 && (i < 0 || best[k] < best[i]))
                i = k;
        if (i < 0)
            break;
        if (used[with[i]]) { /* taken meanwhile: the next best that is free */
            best[i] = limit, with[i] = -1;
            for (int32_t j = 0; j < nb; j++)
                if (!used[j] && cost[i][j] < best[i])
                    best[i] = cost[i][j], with[i] = j;
            continue;
        }
        used[with[i]] = true;
        sum += best[i];
        paired++;
        with[i] = -1;
    }
    return (sum + (na - paired) * w->missing * limit) / na;
}
