/* SPDX-License-Identifier: Apache-2.0 */
/* Chains of a thinned shape: what corners leave behind goes, what runs on is one chain, what
 * is too stout for a line is none. */
#include "curves/curve_centre_internal.h"
#include "elements/element_svg_internal.h"

#include <stdlib.h>
#include <string.h>

/* Ends by cell. */
static int by_cell(const void *a, const void *b)
{
    const ended *p = a, *q = b;
    if (p->cell != q->cell)
        return p->cell < q->cell ? -1 : 1;
    return (p->end > q->end) - (p->end < q->end);
}

int32_t tz_centring_ends(const centring *c, ended *out)
{
    int32_t n = 0;
    for (int32_t k = 0; k < c->chain.n; k++)
        if (!c->chain.v[k].gone && c->chain.v[k].a >= 0) {
            out[n++] = (ended){c->chain.v[k].a, 2 * k};
            out[n++] = (ended){c->chain.v[k].b, 2 * k + 1};
        }
    if (n > 1)
        qsort(out, (size_t)n, sizeof *out, by_cell);
    return n;
}

void tz_centring_prune(centring *c, ended *e, int32_t *degree)
{
    const int32_t n = tz_centring_ends(c, e);
    for (int32_t i = 0, j; i < n; i = j) {
        for (j = i; j < n && e[j].cell == e[i].cell; j++)
            continue;
        for (int32_t k = i; k < j; k++)
            degree[e[k].end] = j - i;
    }
    for (int32_t k = 0; k < c->chain.n; k++) {
        chain *x = &c->chain.v[k];
        if (x->gone || x->a < 0)
            continue;
        const int32_t a = degree[2 * k], b = degree[2 * k + 1];
        if ((a > 1) == (b > 1) || (a < 3 && b < 3))
            continue;
        tz_vec2 p = c->point.v[a > 1 ? x->first : x->first + x->n - 1];
        x->gone = x->length < 1.1 * tz_centring_to_middle(c, &p);
    }
}

tz_status tz_centring_splice(centring *c, ended *e)
{
    const int32_t n = tz_centring_ends(c, e), chains = c->chain.n;
    int32_t *next = NULL;
    tz_status s = tz_alloc(c->ctx, &next, 2 * (size_t)chains, sizeof *next);
    if (s != TZ_OK)
        return s;
    memset(next, 255, 2 * (size_t)chains * sizeof *next);
    for (int32_t i = 0, j; i < n; i = j) {
        for (j = i; j < n && e[j].cell == e[i].cell; j++)
            continue;
        if (j - i == 2) {
            next[e[i].end] = e[i + 1].end;
            next[e[i + 1].end] = e[i].end;
        }
    }
    for (int32_t k = 0; k < chains && s == TZ_OK; k++) {
        if (c->chain.v[k].gone || c->chain.v[k].a < 0 ||
            (next[2 * k] < 0 && next[2 * k + 1] < 0))
            continue;
        int32_t begin = 2 * k;
        while (next[begin] >= 0 && next[begin] >> 1 != k)
            begin = next[begin] ^ 1;
        const bool around = next[begin] >= 0;
        if (around)
            begin = 2 * k;
        chain out = {.first = c->point.n};
        double width = 0;
        for (int32_t end = begin; end >= 0 && !c->chain.v[end >> 1].gone && s == TZ_OK;
             end = next[end ^ 1]) {
            chain *x = &c->chain.v[end >> 1];
            for (int32_t i = out.n > 0; i < x->n && s == TZ_OK; i++) {
                const int32_t at = x->first + (end & 1 ? x->n - 1 - i : i);
                s = tz_array_push(c->ctx, &c->point, c->point.v[at]);
                out.n++;
            }
            if (end == begin)
                out.a = end & 1 ? x->b : x->a;
            out.b = end & 1 ? x->a : x->b;
            out.length += x->length;
            width += x->length * x->width;
            x->gone = true;
        }
        out.width = out.length > 0 ? width / out.length : c->width;
        if (around) {
            out.a = out.b = -1;
            c->point.v[c->point.n - 1] = c->point.v[out.first];
        }
        if (s == TZ_OK)
            s = tz_array_push(c->ctx, &c->chain, out);
    }
    tz_free(c->ctx, next);
    return s;
}

tz_status tz_centring_drop_stout(centring *c, ended *e)
{
    const int32_t n = tz_centring_ends(c, e);
    int32_t *up = NULL;
    double *sum = NULL; /* length, and length times width */
    tz_status s = tz_alloc(c->ctx, &up, (size_t)c->chain.n, sizeof *up);
    if (s == TZ_OK)
        s = tz_alloc_zero(c->ctx, &sum, 2 * (size_t)c->chain.n, sizeof *sum);
    if (s == TZ_OK) {
        for (int32_t k = 0; k < c->chain.n; k++)
            up[k] = k;
        for (int32_t i = 1; i < n; i++)
            if (e[i].cell == e[i - 1].cell)
                tz_forest_join(up, e[i].end >> 1, e[i - 1].end >> 1);
        for (int32_t k = 0; k < c->chain.n; k++) {
            const int32_t root = tz_forest_root(up, k);
            const chain *x = &c->chain.v[k];
            sum[2 * root] += x->gone ? 0 : x->length;
            sum[2 * root + 1] += x->gone ? 0 : x->length * x->width;
        }
        for (int32_t k = 0; k < c->chain.n; k++) {
            const double *q = sum + 2 * (size_t)tz_forest_root(up, k);
            if (q[0] * q[0] < 4 * q[1])
                c->chain.v[k].gone = true;
        }
    }
    tz_free(c->ctx, up);
    tz_free(c->ctx, sum);
    return s;
}
