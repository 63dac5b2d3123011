/* SPDX-License-Identifier: Apache-2.0 */
/* Even use: which element is shown where a unit is due.
 *
 * Where every element has a shape of its own, as in photos, a viewer knows it again: one
 * dark stone that comes back all over the picture is the first thing that is seen. What
 * belongs at a place is a matter of neighbourhoods; which of several alike elements stands
 * there is not. So a unit is shown as the one among those like it (by extents: size, shape
 * and lie at once) that costs least:
 *
 *     unlikeness + what it is used too often + how near here it is already
 *
 * if it has room. Its neighbourhood stays that of the unit. Where symbols are shared by
 * many elements all of one symbol are the same to the eye, and the classes of balance see
 * to their shares. */
#include <stdlib.h>
#include <string.h>

#include "elements/growth_internal.h"

enum { WINDOW = 256, RAYS = 32 }; /* of size, either way; compared of each pair */

/* Units less like than this, share of the radius, are not shown for another. */
static const float unlike_most = 0.6F;
/* Cost of being as unlike as that; of each use more than due, in uses due; of standing
 * side by side with a copy. */
static const float cost_unlike = 0.9F, cost_use = 1, cost_near = 5;
/* Copies want to be farther apart than this: share of what even use allows, and spacings
 * at most. */
static const float far_share = 0.6F, far_most = 7;
/* Nearer than these two they are twins. */
static const float twin_share = 0.25F, twin_most = 2.5F;

/* ---- alike units ------------------------------------------------------------------- */

typedef struct outline {
    float ray[RAYS]; /* how far it reaches, in directions of the world */
    float mean;
    int32_t unit;
} outline;

static int by_size(const void *a, const void *b)
{
    const outline *p = a, *q = b;
    return p->mean != q->mean ? (p->mean > q->mean) - (p->mean < q->mean)
                              : (p->unit > q->unit) - (p->unit < q->unit);
}

static float unlikeness(const outline *a, const outline *b)
{
    float sum = 0;
    for (int32_t k = 0; k < RAYS; k++)
        sum += fabsf(a->ray[k] - b->ray[k]);
    return sum / (RAYS * fmaxf(a->mean, b->mean));
}

static void keep(tz_growth_unit *u, int32_t unit, float unlike)
{
    enum { N = TZ_GROWTH_OTHERS };
    int32_t i = u->others < N ? u->others++ : N;
    for (; i > 0 && u->unlike[i - 1] > unlike; i--)
        if (i < N)
            u->unlike[i] = u->unlike[i - 1], u->other[i] = u->other[i - 1];
    if (i < N)
        u->unlike[i] = unlike, u->other[i] = unit;
}

static int32_t list_outlines(const tz_growth_exemplar *ex, outline *v)
{
    int32_t n = 0;
    for (int32_t k = 0; k < ex->elements; k++) {
        const tz_growth_unit *u = &ex->unit[k];
        const tz_growth_body b = tz_growth_body_of(u);
        if (!u->copied)
            continue;
        v[n] = (outline){.unit = k};
        for (int32_t i = 0; i < RAYS; i++) {
            v[n].ray[i] = tz_growth_extent(ex, &b, (float)(2 * TZ_PI * i / RAYS));
            v[n].mean += v[n].ray[i] / RAYS;
        }
        n++;
    }
    qsort(v, (size_t)n, sizeof *v, by_size);
    return n;
}

tz_status tz_growth_find_others(tz_ctx *ctx, tz_growth_exemplar *ex)
{
    outline *v = NULL;
    if (!ex->own)
        return TZ_OK;
    const tz_status s = tz_alloc(ctx, &v, (size_t)ex->elements + 1, sizeof *v);
    const int32_t n = s == TZ_OK ? list_outlines(ex, v) : 0;
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = i > WINDOW ? i - WINDOW : 0; j < n && j < i + WINDOW; j++) {
            tz_growth_unit *u = &ex->unit[v[i].unit];
            const float unlike = unlikeness(&v[i], &v[j]);
            if (ex->unit[v[j].unit].kind == u->kind && unlike <= unlike_most)
                keep(u, v[j].unit, unlike);
        }
    tz_free(ctx, v);
    return s;
}

/* ---- what is shown ------------------------------------------------------------------- */

/* Distances to the nearest copies of the candidates within `far`, in units of the local
 * frame. */
static void look_for(tz_growth *g, const tz_growth_exemplar *ex, double x, double y,
                     double far)
{
    const tz_domain *d = &g->out->domain;
    const double scale = tz_domain_apart(d, (tz_vec3){x, y, 0});
    far *= scale;
    const int32_t wx = (int32_t)fmin(g->nx, ceil(far / g->cell_x)),
                  wy = (int32_t)fmin(g->ny, ceil(far / g->cell_y));
    const int32_t cx = (int32_t)floor(x / g->cell_x), cy = (int32_t)floor(y / g->cell_y);
    for (int32_t j = cy - wy; j <= cy + wy; j++)
        for (int32_t i = cx - wx; i <= cx + wx; i++) {
            if (!d->torus && (i < 0 || j < 0 || i >= g->nx || j >= g->ny))
                continue;
            const int32_t cell = tz_raster_index(j, g->ny, d->torus) * g->nx +
                                 tz_raster_index(i, g->nx, d->torus);
            for (int32_t k = g->head[cell]; k >= 0; k = g->spot.v[k].next) {
                const tz_growth_spot *q = &g->spot.v[k];
                if (q->texture != ex->number || q->copy < 0)
                    continue;
                const tz_vec3 v =
                    tz_domain_vector(d, (tz_vec3){x, y, 0}, (tz_vec3){q->x, q->y, 0});
                tz_growth_unit *u = &ex->unit[q->copy];
                u->recent =
                    fminf(u->recent, hypotf((float)v.x, (float)v.y) / (float)scale);
            }
        }
}

int32_t tz_growth_show(tz_growth *g, int32_t texture, int32_t unit, double x, double y,
                       const tz_growth_view *view)
{
    const tz_growth_exemplar *ex = &g->ex[texture];
    const tz_growth_unit *u = &ex->unit[unit];
    const tz_vec3 at = tz_domain_wrap(&g->out->domain, (tz_vec3){x, y, 0});
    float cost[TZ_GROWTH_OTHERS] = {0};
    if (u->others < 1)
        return unit;
    const float due = (float)g->counted[texture] / (float)ex->n + 1;
    const float even = far_share * sqrtf((float)ex->elements);
    const float far = fminf(even, far_most) * (float)ex->spacing;
    for (int32_t k = 0; k < u->others; k++)
        ex->unit[u->other[k]].recent = far;
    look_for(g, ex, at.x, at.y, (double)far);
    for (int32_t k = 0; k < u->others; k++) {
        const tz_growth_unit *o = &ex->unit[u->other[k]];
        cost[k] = cost_unlike * u->unlike[k] / unlike_most +
                  cost_use * ((float)o->uses - due) / due +
                  cost_near * (1 - o->recent / far);
    }
    for (int32_t tries = 0; tries < u->others; tries++) {
        int32_t best = 0;
        for (int32_t k = 1; k < u->others; k++)
            best = cost[k] < cost[best] ? k : best;
        const tz_growth_unit *o = &ex->unit[u->other[best]];
        cost[best] = INFINITY;
        if (tz_growth_may_stand(g, texture, o, at.x, at.y) &&
            tz_growth_fits(ex, o, 0, 0, view))
            return u->other[best];
    }
    return unit;
}

bool tz_growth_is_twin(const tz_growth *g, int32_t texture, int32_t shown)
{
    const tz_growth_exemplar *ex = &g->ex[texture];
    const tz_growth_unit *u = &ex->unit[shown];
    const float apart = fminf(twin_most, twin_share * sqrtf((float)ex->elements));
    return u->others > 0 && u->recent < apart * (float)ex->spacing;
}
