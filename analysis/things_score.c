/* SPDX-License-Identifier: Apache-2.0 */
/* What tells a thing from its parts, from heaps of things and from ground: a strong
 * border all around and none within, a round or at least convex outline, one colour, the
 * size of the others. A small net weighs them; it has learned from scenes whose things
 * are known how well a region with such features covers a thing. All features are free of
 * the picture's contrast and, but for one, of its resolution. */
#include "analysis/things_score.h"

#include <math.h>
#include <string.h>

tz_things_overview tz_things_survey(const tz_things_tree *t)
{
    tz_things_overview o = {0};
    double edge = 0, length = 0;
    for (int32_t i = 0; i < t->leaves; i++) {
        edge += t->node[i].edge;
        length += t->node[i].perimeter;
    }
    const tz_things_node *all = &t->node[t->n - 1];
    o.edge = length > 0 ? edge / length : 0;
    o.light = all->colour[0] / all->area;
    return o;
}

static double ratio(double a, double b) { return b > 0 ? a / b : 0; }

static double solidity(const tz_things_node *v)
{
    return v->hull > 0 ? fmin(v->area / v->hull, 1) : 0.5;
}

/* Length over width by second moments, a pixel's own spread included. */
static double aspect(const tz_things_node *v)
{
    const double x = v->x / v->area, y = v->y / v->area;
    const double xx = v->xx / v->area - x * x + 1.0 / 12,
                 yy = v->yy / v->area - y * y + 1.0 / 12, xy = v->xy / v->area - x * y;
    const double mean = 0.5 * (xx + yy), d = hypot(0.5 * (xx - yy), xy);
    return sqrt((mean + d) / fmax(mean - d, 1e-3));
}

static double colour_distance(const tz_things_node *a, const tz_things_node *b)
{
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        const double d = a->colour[c] / a->area - b->colour[c] / b->area;
        sum += d * d;
    }
    return sqrt(sum);
}

static double deviation(const tz_things_node *v)
{
    double mean2 = 0;
    for (int c = 0; c < 3; c++)
        mean2 += v->colour[c] * v->colour[c] / (v->area * v->area);
    return sqrt(fmax(v->colour2 / v->area - mean2, 0));
}

static double around(const tz_things_node *v) { return v->perimeter + v->frame; }

void tz_things_describe(const tz_things_tree *t, const tz_things_overview *o,
                        const tz_things_sizes *sizes, int32_t node, float *feature)
{
    const tz_things_node *v = &t->node[node];
    const tz_things_node *up = v->parent >= 0 ? &t->node[v->parent] : v;
    const int32_t other = v->parent < 0          ? node
                          : up->child[0] == node ? up->child[1]
                                                 : up->child[0];
    const tz_things_node *next = &t->node[other];
    const double size = log2(v->area), spread = t->spread;
    const double larger =
        v->child[0] < 0
            ? 0.5
            : fmax(t->node[v->child[0]].area, t->node[v->child[1]].area) / v->area;
    const double level = v->parent >= 0 ? up->level : 2;
    const double f[] = {
        size / 4,
        ratio(v->edge, v->perimeter),
        ratio(v->bin[1] + v->bin[2] + v->bin[3], v->perimeter),
        ratio(v->bin[2] + v->bin[3], v->perimeter),
        ratio(v->bin[3], v->perimeter),
        v->level,
        v->strongest,
        level,
        v->inner / v->area,
        solidity(v),
        fmin(4 * TZ_PI * v->area / (around(v) * around(v) * 0.62), 1.3),
        log2(fmin(aspect(v), 16)),
        fmin(deviation(v) / spread, 2),
        fmax(-3,
             fmin(3, (ratio(v->light, v->perimeter) - v->colour[0] / v->area) / spread)),
        v->frame / around(v),
        fmax(-3, fmin(3, (v->colour[0] / v->area - o->light) / spread)),
        fmax(-6, fmin(6, log2(next->area / v->area))),
        solidity(up),
        larger,
        o->edge,
        fmin(colour_distance(v, next) / spread, 3),
        solidity(next),
        ratio(next->edge, next->perimeter),
        ratio(up->edge, up->perimeter),
        fmin(log2(aspect(next)), 4),
        sizes->known ? fmax(-4, fmin(4, size - sizes->middle)) : 0,
        sizes->known ? fmax(-4, fmin(4, log2(up->area) - sizes->middle)) : 0,
        sizes->known ? fmin(sizes->spread, 3) : 0,
    };
    _Static_assert(sizeof f / sizeof *f == TZ_THINGS_FEATURES, "one slot a feature");
    for (int k = 0; k < TZ_THINGS_FEATURES; k++)
        feature[k] = (float)f[k];
}

double tz_things_score(const tz_things_net *net, const float *feature)
{
    float h[TZ_THINGS_HIDDEN], sum = net->out_bias;
    for (int j = 0; j < TZ_THINGS_HIDDEN; j++)
        h[j] = net->bias[j];
    for (int k = 0; k < TZ_THINGS_FEATURES; k++) {
        const float x = (feature[k] - net->mean[k]) / net->deviation[k];
        for (int j = 0; j < TZ_THINGS_HIDDEN; j++)
            h[j] += net->in[k][j] * x;
    }
    for (int j = 0; j < TZ_THINGS_HIDDEN; j++)
        sum += net->out[j] * h[j] / (1 + fabsf(h[j]));
    return 1 / (1 + exp(-(double)sum));
}
