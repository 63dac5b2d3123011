/* SPDX-License-Identifier: Apache-2.0 */
/* Where true outlines lie: points of each are looked up in the signed distances of the
 * shapes beside it. Distances change by no more than the way along an outline, so that
 * whole stretches of it that are too far away are passed over. */
#include <string.h>

#include "fields/fill_outline_internal.h"

#define SLACK 0.004 /* of the largest disc: no contact yet */
#define FAR   0.2   /* of it: outlines so far apart do not lie upon each other */

static bool is_soft(const tz_fill *f, int32_t i)
{
    const tz_fill_body *b = &f->body.v[i];
    return b->n > 1 && f->model.v[b->model].rigidity < TZ_FILL_RIGID;
}

double tz_fill_slack(const tz_fill *f, int32_t i)
{
    const tz_fill_body *b = &f->body.v[i];
    return SLACK * f->radius[b->first] * tz_fill_scale(f, b->first);
}

/* ---- poses -------------------------------------------------------------------------- */

void tz_fill_outline_find(tz_fill_outlines *o, int32_t i)
{
    const tz_fill *f = o->f;
    tz_fill_pose_of *p = &o->pose[i];
    const tz_fill_body *b = &f->body.v[i];
    const tz_fill_model *m = &f->model.v[b->model];
    double angle;
    tz_fill_pose(f, i, &p->at, &angle, &p->scale);
    p->turn = (tz_vec2){p->scale * cos(angle), p->scale * sin(angle)};
    p->soft = is_soft(f, i);
    p->reach = m->reach * p->scale;
    for (int32_t k = 0; k < m->borders && p->soft; k++) {
        tz_vec2 *q = &o->border[(ptrdiff_t)p->border * TZ_FILL_BORDER + k];
        *q = tz_fill_to_world(f, i, m->border[k]);
        p->reach = fmax(p->reach, hypot(q->x - p->at.x, q->y - p->at.y));
    }
    o->known[i] = true;
}

void tz_fill_outline_move(tz_fill_outlines *o, int32_t i, tz_vec2 by)
{
    tz_fill *f = o->f;
    tz_fill_pose_of *p = &o->pose[i];
    const tz_fill_body *b = &f->body.v[i];
    for (int32_t k = b->first; k < b->first + b->n; k++)
        f->at[k].x += by.x, f->at[k].y += by.y;
    p->at = tz_vec2_add(p->at, by);
    tz_vec2 *q = &o->border[(ptrdiff_t)p->border * TZ_FILL_BORDER];
    for (int32_t k = 0; k < f->model.v[b->model].borders && p->soft; k++)
        q[k] = tz_vec2_add(q[k], by);
}

void tz_fill_outline_turn(tz_fill_outlines *o, int32_t i, double by)
{
    tz_fill *f = o->f;
    tz_fill_pose_of *p = &o->pose[i];
    const tz_fill_body *b = &f->body.v[i];
    const double c = cos(by), s = sin(by);
    for (int32_t k = b->first; k < b->first + b->n; k++) {
        const double u = f->at[k].x - p->at.x, v = f->at[k].y - p->at.y;
        double *t = f->o + 2 * (ptrdiff_t)k;
        const double x = t[0], y = t[1];
        f->at[k].x = p->at.x + c * u - s * v, f->at[k].y = p->at.y + s * u + c * v;
        t[0] = c * x - s * y, t[1] = s * x + c * y;
    }
    p->turn = (tz_vec2){c * p->turn.x - s * p->turn.y, s * p->turn.x + c * p->turn.y};
    tz_vec2 *q = &o->border[(ptrdiff_t)p->border * TZ_FILL_BORDER];
    for (int32_t k = 0; k < f->model.v[b->model].borders && p->soft; k++) {
        const double u = q[k].x - p->at.x, v = q[k].y - p->at.y;
        q[k] = (tz_vec2){p->at.x + c * u - s * v, p->at.y + s * u + c * v};
    }
}

static tz_vec2 border_point(const tz_fill_outlines *o, int32_t i, int32_t k)
{
    const tz_fill_model *m = &o->f->model.v[o->f->body.v[i].model];
    const tz_fill_pose_of *p = &o->pose[i];
    if (p->soft)
        return o->border[(ptrdiff_t)p->border * TZ_FILL_BORDER + k];
    const tz_vec2 q = m->border[k];
    return (tz_vec2){p->at.x + p->turn.x * q.x - p->turn.y * q.y,
                     p->at.y + p->turn.y * q.x + p->turn.x * q.y};
}

/* ---- depths ------------------------------------------------------------------------- */

/* Whether a place lies by one of a body's discs, or a little beyond. */
static bool near_disc(const tz_fill *f, int32_t i, tz_vec2 at, double beyond)
{
    const tz_fill_body *b = &f->body.v[i];
    for (int32_t s = b->first; s < b->first + b->n; s++) {
        const tz_vec3 v = tz_fill_vector(f, f->at[s], (tz_vec3){at.x, at.y, 0});
        const double r = 1.6 * f->c[s] * f->radius[s] + beyond;
        if (v.x * v.x + v.y * v.y < r * r)
            return true;
    }
    return false;
}

/* How deep a place of the world lies in a body, and the way out. */
static double depth_in(const tz_fill_outlines *o, int32_t i, tz_vec2 at, double least,
                       tz_vec2 *way)
{
    const tz_fill *f = o->f;
    const tz_fill_model *m = &f->model.v[f->body.v[i].model];
    const tz_fill_pose_of *p = &o->pose[i];
    tz_vec2 turn = p->turn, in, slope;
    double scale = p->scale;
    const tz_vec3 v =
        tz_fill_vector(f, (tz_vec3){p->at.x, p->at.y, 0}, (tz_vec3){at.x, at.y, 0});
    const double reach = p->reach + fmax(-least, 0);
    if (v.x * v.x + v.y * v.y >= reach * reach ||
        (p->soft && !near_disc(f, i, at, fmax(-least, 0))))
        return -HUGE_VAL;
    if (p->soft) {
        in = tz_fill_to_model(f, i, at, &scale, &turn);
    } else {
        const double s2 = 1 / (scale * scale);
        in = (tz_vec2){(turn.x * v.x + turn.y * v.y) * s2,
                       (turn.x * v.y - turn.y * v.x) * s2};
        turn = tz_vec2_scale(turn, 1 / scale);
    }
    const double d = tz_shape_distance_at(&m->cover.distance, in, way ? &slope : NULL);
    if (way) {
        const double l = tz_vec2_length(slope), by = l > 0 ? -1 / l : 0;
        *way = (tz_vec2){by * (turn.x * slope.x - turn.y * slope.y),
                         by * (turn.y * slope.x + turn.x * slope.y)};
    }
    return d * scale;
}

/* A body's outline in the grid of a rigid one. */
typedef struct look {
    const float *v;
    int32_t width;
    double x, y, mx, my; /* where `a` is, and its turn, in cells */
    double wide, high, scale, cell;
    const tz_vec2 *at; /* outline: of the model, or of a soft body about `from` */
    tz_vec2 from;
} look;

static look look_into(const tz_fill_outlines *o, int32_t a, int32_t b)
{
    const tz_fill *f = o->f;
    const tz_shape_distance *d = &f->model.v[f->body.v[b].model].cover.distance;
    const tz_fill_pose_of *p = &o->pose[a], *q = &o->pose[b];
    const tz_vec3 v =
        tz_fill_vector(f, (tz_vec3){q->at.x, q->at.y, 0}, (tz_vec3){p->at.x, p->at.y, 0});
    const double by = 1 / (q->scale * q->scale * d->cell);
    const double c = q->turn.x * by, s = q->turn.y * by;
    look l = {.v = d->v,
              .width = d->width,
              .x = c * v.x + s * v.y - d->origin.x / d->cell,
              .y = c * v.y - s * v.x - d->origin.y / d->cell,
              .mx = c * p->turn.x + s * p->turn.y,
              .my = c * p->turn.y - s * p->turn.x,
              .wide = d->width - 1.001,
              .high = d->height - 1.001,
              .scale = q->scale,
              .cell = d->cell * q->scale,
              .at = f->model.v[f->body.v[a].model].border,
              .from = {0, 0}};
    if (p->soft) {
        l.at = o->border + (ptrdiff_t)p->border * TZ_FILL_BORDER;
        l.from = p->at;
        l.mx = c, l.my = -s;
    }
    return l;
}

/* Depth of a point; *most = what it is at most, where it lies off the grid. */
static inline double look_at(const look *l, int32_t k, double *most)
{
    const double u = l->at[k].x - l->from.x, w = l->at[k].y - l->from.y;
    const double x = l->x + l->mx * u - l->my * w, y = l->y + l->my * u + l->mx * w;
    const double cx = !(x > 0)      ? 0
                      : x > l->wide ? l->wide
                                    : x,
                 cy = !(y > 0)      ? 0
                      : y > l->high ? l->high
                                    : y;
    const int32_t i = (int32_t)cx, j = (int32_t)cy;
    const double s = cx - i, t = cy - j;
    const float *p = l->v + (ptrdiff_t)j * l->width + i, *q = p + l->width;
    const double d = (((double)p[0] * (1 - s) + (double)p[1] * s) * (1 - t) +
                      ((double)q[0] * (1 - s) + (double)q[1] * s) * t) *
                     l->scale;
    if (cx == x && cy == y)
        return *most = d;
    enum { MARGIN = 4 }; /* cells of the grid about a shape */
    const double off = sqrt((x - cx) * (x - cx) + (y - cy) * (y - cy)) * l->cell;
    *most = -MARGIN * l->cell - off;
    return d - off;
}

/* Points that are passed over after one that lacks so much. */
static inline int32_t pass(const double *way, int32_t k, int32_t n, double room)
{
    const double to = way[k] + room;
    while (k + 1 < n && way[k + 1] < to)
        k++;
    return k;
}

/* Way along the outline, as drawn, that is one unit in the world at most: a bent one may
 * be longer. */
static double per_way(const tz_fill_outlines *o, int32_t i)
{
    return 1 / ((o->pose[i].soft ? 2 : 1) * o->pose[i].scale);
}

/* From a point along the outline, either way, as long as it gets deeper. */
static int32_t climb(const look *l, int32_t k, int32_t n, double *deep)
{
    double upper;
    for (int way = -1; way <= 1; way += 2)
        for (int32_t step = 0; step < n; step++) {
            const int32_t q = k + way < 0 ? n - 1 : k + way == n ? 0 : k + way;
            const double d = look_at(l, q, &upper);
            if (d <= *deep)
                break;
            *deep = d, k = q;
        }
    return k;
}

static double deepest_in_rigid(const tz_fill_outlines *o, int32_t a, int32_t b,
                               double least, bool whole, int8_t *best)
{
    const int32_t model = o->f->body.v[a].model, n = o->f->model.v[model].borders;
    const double *way = o->way[model];
    const look l = look_into(o, a, b);
    const double per = per_way(o, a);
    double upper, deep = least;
    int32_t k0 = -1;
    if (*best >= 0) {
        double d = look_at(&l, *best, &upper);
        const int32_t q = climb(&l, *best, n, &d);
        if (d > deep)
            deep = d, k0 = q;
    }
    for (int32_t k = 0; k < n && (whole || k0 < 0); k++) {
        const double d = look_at(&l, k, &upper);
        if (d > deep)
            deep = d, k0 = k;
        else if (upper < deep)
            k = pass(way, k, n, (deep - upper) * per);
    }
    *best = (int8_t)k0;
    return deep;
}

/* Deep overlaps: where the centre of a's disc lies in b, all of the disc is to come out. Of
 * two that lie on each other no point of an outline says so. Returns the depth, if more
 * than `deep`. */
static double deepest_disc(const tz_fill_outlines *o, int32_t a, int32_t b, double deep,
                           tz_vec2 *at, tz_vec2 *way)
{
    const tz_fill *f = o->f;
    const tz_fill_body *p = &f->body.v[a];
    for (int32_t k = p->first; k < p->first + p->n; k++) {
        const double r = tz_fill_scale(f, k) * f->radius[k];
        tz_vec2 out = {0, 0};
        const tz_vec2 q = {f->at[k].x, f->at[k].y};
        const double d = depth_in(o, b, q, 0, NULL);
        if (!(d > 0) || d + r <= deep)
            continue;
        depth_in(o, b, q, 0, &out);
        if (out.x == 0 && out.y == 0) { /* on its axis: any way that both agree on */
            const double side = a < b ? 1 : -1, l = tz_vec2_length(o->pose[b].turn);
            out = (tz_vec2){-side * o->pose[b].turn.y / l, side * o->pose[b].turn.x / l};
        }
        deep = d + r, *at = q, *way = out;
    }
    return deep;
}

double tz_fill_outline_depth(const tz_fill_outlines *o, int32_t a, int32_t b,
                             double least, bool whole, int8_t *best, tz_vec2 *at,
                             tz_vec2 *way)
{
    const int32_t model = o->f->body.v[a].model, n = o->f->model.v[model].borders;
    double deep = least;
    if (!o->pose[b].soft) {
        deep = deepest_in_rigid(o, a, b, least, whole, best);
    } else {
        int8_t k0 = -1;
        for (int32_t k = 0; k < n; k++) {
            const double d = depth_in(o, b, border_point(o, a, k), deep, NULL);
            if (d > deep)
                deep = d, k0 = (int8_t)k;
        }
        *best = k0;
    }
    if (*best >= 0) {
        *at = border_point(o, a, *best);
        depth_in(o, b, *at, fmin(deep, 0) - 1e-3 * o->pose[b].reach, way);
    }
    const int32_t first = o->f->body.v[a].first;
    const double far = FAR * o->f->radius[first] * tz_fill_scale(o->f, first);
    return deep > -far ? deepest_disc(o, a, b, deep, at, way) : deep;
}

bool tz_fill_outlines_near(const tz_fill_outlines *o, int32_t a, int32_t b)
{
    const tz_fill *f = o->f;
    const tz_fill_pose_of *p = &o->pose[a], *q = &o->pose[b];
    const double gap = o->part * (p->gap + q->gap);
    const tz_vec3 v =
        tz_fill_vector(f, (tz_vec3){p->at.x, p->at.y, 0}, (tz_vec3){q->at.x, q->at.y, 0});
    const double sum = p->reach + q->reach + gap;
    if (v.x * v.x + v.y * v.y >= sum * sum)
        return false;
    const tz_fill_body *c = &f->body.v[a], *d = &f->body.v[b];
    const double rim =
        f->model.v[c->model].rim * p->scale + f->model.v[d->model].rim * q->scale + gap;
    for (int32_t i = c->first; i < c->first + c->n; i++) {
        const double r = tz_fill_scale(f, i) * f->radius[i] + rim;
        for (int32_t k = d->first; k < d->first + d->n; k++) {
            const tz_vec3 w = tz_fill_vector(f, f->at[i], f->at[k]);
            const double far = r + tz_fill_scale(f, k) * f->radius[k];
            if (w.x * w.x + w.y * w.y < far * far)
                return true;
        }
    }
    return false;
}

/* ---- the border --------------------------------------------------------------------- */

double tz_fill_outline_border(const tz_fill_outlines *o, int32_t i, double gap,
                              tz_vec2 *at, tz_vec2 *way)
{
    const tz_fill *f = o->f;
    const tz_fill_model *m = &f->model.v[f->body.v[i].model];
    const tz_domain *d = &f->domain;
    const tz_vec3 from = {o->pose[i].at.x, o->pose[i].at.y, 0};
    if (tz_domain_depth(d, tz_domain_wrap(d, from)) > o->pose[i].reach + gap)
        return 0;
    const double *along = o->way[f->body.v[i].model], per = per_way(o, i);
    double most = 0;
    tz_vec2 where = {0, 0};
    for (int32_t k = 0; k < m->borders; k++) {
        const tz_vec2 q = border_point(o, i, k);
        const double lack =
            gap - tz_domain_depth(d, tz_domain_wrap(d, (tz_vec3){q.x, q.y, 0}));
        if (lack > most)
            most = lack, where = q;
        else
            k = pass(along, k, m->borders, (most - lack) * per);
    }
    if (!(most > 0))
        return 0;
    const double e = 0.01 * o->pose[i].reach;
    double x = 0, y = 0;
    for (int k = -1; k <= 1; k += 2) {
        const tz_vec3 u = {where.x + k * e, where.y, 0},
                      v = {where.x, where.y + k * e, 0};
        x += k * tz_domain_depth(d, tz_domain_wrap(d, u));
        y += k * tz_domain_depth(d, tz_domain_wrap(d, v));
    }
    const double l = hypot(x, y);
    if (!(l > 0))
        return 0;
    *at = where;
    *way = (tz_vec2){x / l, y / l};
    return most;
}

/* ---- all of them -------------------------------------------------------------------- */

/* Lengths along a model's outline, and of all of it: by the area just about the shape. */
static void measure_model(tz_fill_outlines *o, int32_t i)
{
    enum { RING = 2 }; /* cells */
    const tz_fill_model *m = &o->f->model.v[i];
    const tz_shape_distance *d = &m->cover.distance;
    double *way = o->way[i];
    int32_t n = 0;
    way[0] = 0;
    for (int32_t k = 1; k < m->borders; k++)
        way[k] = way[k - 1] + tz_vec2_length(tz_vec2_sub(m->border[k], m->border[k - 1]));
    for (int32_t k = 0; k < d->width * d->height; k++)
        n += (double)d->v[k] <= 0 && (double)d->v[k] > -RING * d->cell;
    o->rim[i] = n * d->cell / RING;
}

tz_status tz_fill_outlines_reserve(tz_fill_outlines *o, int32_t more)
{
    const tz_fill *f = o->f;
    const int32_t n = f->body.n + more;
    const size_t room = (size_t)n + (size_t)n / 8 + 16;
    tz_status s = TZ_OK;
    if (n > o->room) {
        size_t softs =
            (size_t)o->softs; /* outlines of what is there, and of any to come */
        for (int32_t i = o->bodies; i < f->body.n; i++)
            softs += is_soft(f, i);
        softs += o->any_soft ? room - (size_t)f->body.n : 1;
#define GROW(array, size) \
    if (s == TZ_OK)       \
        s = tz_realloc(f->ctx, &o->array, (size), sizeof *o->array);
        GROW(pose, room)
        GROW(lack, room)
        GROW(moved, room)
        GROW(known, room)
        GROW(shrunk, room)
        GROW(start, room + 1)
        GROW(border, softs * TZ_FILL_BORDER)
#undef GROW
        if (s != TZ_OK)
            return s;
        o->room = (int32_t)room;
    }
    for (; o->bodies < n; o->bodies++) {
        const int32_t i = o->bodies;
        o->pose[i] = (tz_fill_pose_of){.border = o->softs};
        o->lack[i] = (tz_fill_lack){.depth = 0};
        o->known[i] = o->moved[i] = false;
        o->shrunk[i] = 1;
        o->softs += i < f->body.n ? is_soft(f, i) : o->any_soft;
    }
    return s;
}

tz_status tz_fill_outlines_init(tz_fill *f, tz_fill_outlines *o)
{
    *o = (tz_fill_outlines){.f = f, .part = 1};
    tz_status s = tz_alloc(f->ctx, &o->way, (size_t)f->model.n, sizeof *o->way);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &o->rim, (size_t)f->model.n, sizeof *o->rim);
    for (int32_t i = 0; i < f->model.n && s == TZ_OK; i++) {
        measure_model(o, i);
        o->any_soft = o->any_soft || f->model.v[i].rigidity < TZ_FILL_RIGID;
    }
    return s == TZ_OK ? tz_fill_outlines_reserve(o, 0) : s;
}

void tz_fill_outlines_deinit(tz_fill_outlines *o)
{
    tz_ctx *ctx = o->f->ctx;
    tz_free(ctx, o->pose), tz_free(ctx, o->lack), tz_free(ctx, o->moved);
    tz_free(ctx, o->known), tz_free(ctx, o->shrunk), tz_free(ctx, o->border);
    tz_free(ctx, o->way), tz_free(ctx, o->rim);
    tz_free(ctx, o->start), tz_free(ctx, o->near);
    tz_free(ctx, o->touch), tz_free(ctx, o->contact), tz_free(ctx, o->share);
}
