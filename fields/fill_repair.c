/* SPDX-License-Identifier: Apache-2.0 */
/* True outlines. Discs stand for shapes only nearly: corners reach beyond them, and where
 * many push no one gives way enough. Here points of each outline are looked up in the
 * signed distances of the shapes beside it (bodies whose discs are neighbours); the deepest
 * point of each pair pushes both apart along the slope there, by half of its depth each,
 * and turns a rigid body a little:
 *
 *   1. rounds of pushes, first with a margin, which evens the gaps, then until nothing
 *      overlaps or they no longer help;
 *   2. where many are jammed one leaves, and the rest is pushed again;
 *   3. what still overlaps shrinks, step by step, to no less than LEAST of its size;
 *   4. what still does leaves;
 *   5. where a thing of the mix can be pushed into an empty place (and the count is free),
 *      one comes.
 *
 * Directions are the artist's: a body turns by HELD at most.
 * @source the rounds: Mueller et al., Position based dynamics, 2007 */
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "fields/fill_internal.h"

enum {
    WIDE = 20,    /* rounds with a margin */
    ROUNDS = 144, /* without, at most */
    AGAIN = 24,   /* rounds that neighbours are good for */
    STALL = 24,   /* rounds in which the count must fall */
    SHRINKS = 12,
    JAMS = 3,   /* times that jams are loosened */
    TRIES = 14, /* pushes of one that comes */
    STREAM_GAP = 0xf1e20
};
#define MARGIN 0.08  /* of the largest disc */
#define JAM    0.35  /* of the largest disc: so deep is a jam */
#define HELD   0.012 /* radians */
#define LEAST  0.8
#define DEEP   0.004 /* of the largest disc: no contact yet */

/* A body as a contact sees it. */
typedef struct pose {
    tz_vec2 at, turn; /* of a rigid body; turn times scale */
    double scale, reach;
    bool soft;
    int32_t border; /* of a soft body: where its outline's points are kept */
} pose;

/* What is done to a body in one round. */
typedef struct push {
    double x, y, turn, depth;
    int32_t n;
} push;

/* The deepest points of two bodies in each other, as the round began. */
typedef struct contact {
    int32_t a, b;
    bool both, near;       /* b moves too; they may touch */
    double depth[2];       /* of a's outline in b, of b's in a */
    tz_vec2 at[2], out[2]; /* where, and the way out of the other */
} contact;

typedef struct repair {
    tz_fill *f;
    pose *pose;
    push *push;
    bool *awake;     /* to be looked at */
    bool *moved;     /* since contacts were found */
    double *turned;  /* so far */
    double margin;   /* share of the largest disc; pushes begin there */
    tz_vec2 *border; /* TZ_FILL_BORDER a soft body */
    int32_t softs;
    int32_t *start, *near;
    int32_t *touch; /* of near: its contact; ~ if it stands there the other way round */
    contact *contact;
    int32_t contacts;
    int64_t room;   /* bodies that pose, push, turned hold */
    int32_t bodies; /* that awake and start hold */
} repair;

static void find_pose(repair *r, int32_t i)
{
    const tz_fill *f = r->f;
    pose *p = &r->pose[i];
    const tz_fill_body *b = &f->body.v[i];
    const tz_fill_model *m = &f->model.v[b->model];
    double angle;
    tz_fill_pose(f, i, &p->at, &angle, &p->scale);
    p->turn = (tz_vec2){p->scale * cos(angle), p->scale * sin(angle)};
    p->soft = b->n > 1 && m->rigidity < TZ_FILL_RIGID;
    p->reach = m->reach * p->scale;
    for (int32_t k = 0; k < m->borders && p->soft; k++) {
        tz_vec2 *q = &r->border[(ptrdiff_t)p->border * TZ_FILL_BORDER + k];
        *q = tz_fill_to_world(f, i, m->border[k]);
        p->reach = fmax(p->reach, hypot(q->x - p->at.x, q->y - p->at.y));
    }
}

/* Soft bodies get room for their outlines. */
static tz_status find_poses(repair *r)
{
    const tz_fill *f = r->f;
    r->softs = 0;
    for (int32_t i = 0; i < f->body.n; i++) {
        const tz_fill_body *b = &f->body.v[i];
        r->pose[i].border = r->softs;
        r->softs += b->n > 1 && f->model.v[b->model].rigidity < TZ_FILL_RIGID;
    }
    const tz_status s = tz_realloc(
        f->ctx, &r->border, ((size_t)r->softs + 1) * TZ_FILL_BORDER, sizeof *r->border);
    for (int32_t i = 0; i < f->body.n && s == TZ_OK; i++)
        if (!f->body.v[i].gone)
            find_pose(r, i);
    return s;
}

static tz_vec2 border_point(const repair *r, int32_t i, int32_t k)
{
    const tz_fill_model *m = &r->f->model.v[r->f->body.v[i].model];
    const pose *p = &r->pose[i];
    const tz_vec2 q = m->border[k];
    if (p->soft)
        return r->border[(ptrdiff_t)p->border * TZ_FILL_BORDER + k];
    return (tz_vec2){p->at.x + p->turn.x * q.x - p->turn.y * q.y,
                     p->at.y + p->turn.y * q.x + p->turn.x * q.y};
}

/* Whether a place lies by one of a body's discs, or a little beyond. */
static bool near_disc(const tz_fill *f, int32_t i, tz_vec2 at)
{
    const tz_fill_body *b = &f->body.v[i];
    for (int32_t s = b->first; s < b->first + b->n; s++) {
        const tz_vec3 v = tz_fill_vector(f, f->at[s], (tz_vec3){at.x, at.y, 0});
        const double r = 1.6 * f->c[s] * f->radius[s];
        if (v.x * v.x + v.y * v.y < r * r)
            return true;
    }
    return false;
}

/* How deep a place of the world lies in a body, and the way out. */
static double depth_in(const repair *r, int32_t i, tz_vec2 at, tz_vec2 *out)
{
    const tz_fill *f = r->f;
    const tz_fill_model *m = &f->model.v[f->body.v[i].model];
    const pose *p = &r->pose[i];
    tz_vec2 turn = p->turn, in, slope;
    double scale = p->scale;
    const tz_vec3 v =
        tz_fill_vector(f, (tz_vec3){p->at.x, p->at.y, 0}, (tz_vec3){at.x, at.y, 0});
    const double reach = p->reach * (1 + r->margin);
    if (v.x * v.x + v.y * v.y >= reach * reach || (p->soft && !near_disc(f, i, at)))
        return *out = (tz_vec2){0, 0}, -HUGE_VAL;
    if (p->soft) {
        in = tz_fill_to_model(f, i, at, &scale, &turn);
    } else {
        const double s2 = 1 / (scale * scale);
        in = (tz_vec2){(turn.x * v.x + turn.y * v.y) * s2,
                       (turn.x * v.y - turn.y * v.x) * s2};
        turn = tz_vec2_scale(turn, 1 / scale);
    }
    const double d = tz_shape_distance_at(&m->cover.distance, in, &slope) * scale;
    const double l = tz_vec2_length(slope);
    if (l > 0)
        *out = (tz_vec2){-(turn.x * slope.x - turn.y * slope.y) / l,
                         -(turn.y * slope.x + turn.x * slope.y) / l};
    else
        *out = (tz_vec2){0, 0};
    return d;
}

static double slack_of(const tz_fill *f, int32_t i)
{
    const tz_fill_body *b = &f->body.v[i];
    return DEEP * f->radius[b->first] * tz_fill_scale(f, b->first);
}

/* Distance to a shape's border at a place well inside its grid; no slope. */
static inline double quick_distance(const tz_shape_distance *d, double x, double y)
{
    const int32_t i = (int32_t)x, j = (int32_t)y;
    const double s = x - i, t = y - j;
    const float *p = d->v + (ptrdiff_t)j * d->width + i, *q = p + d->width;
    return ((double)p[0] * (1 - s) + (double)p[1] * s) * (1 - t) +
           ((double)q[0] * (1 - s) + (double)q[1] * s) * t;
}

/* The same for a body that does not bend: places go straight to its grid. Which point of
 * a's outline is deepest, -1 = none over *most. */
static int32_t deepest_in_rigid(const repair *r, int32_t a, int32_t b, double *most)
{
    const tz_fill_model *m = &r->f->model.v[r->f->body.v[a].model],
                        *in = &r->f->model.v[r->f->body.v[b].model];
    const tz_shape_distance *d = &in->cover.distance;
    const pose *p = &r->pose[a], *q = &r->pose[b];
    const tz_vec3 v = tz_fill_vector(r->f, (tz_vec3){q->at.x, q->at.y, 0},
                                     (tz_vec3){p->at.x, p->at.y, 0});
    const double by = 1 / (q->scale * q->scale * d->cell);
    const double c = q->turn.x * by, s = q->turn.y * by;
    const double x0 = c * v.x + s * v.y - d->origin.x / d->cell,
                 y0 = c * v.y - s * v.x - d->origin.y / d->cell;
    const double mx = c * p->turn.x + s * p->turn.y, my = c * p->turn.y - s * p->turn.x;
    const double wide = d->width - 1, high = d->height - 1, scale = q->scale;
    const tz_vec2 *soft = r->border + (ptrdiff_t)p->border * TZ_FILL_BORDER;
    const double cell = d->cell * scale, margin = 4 * cell; /* of the grid, MARGIN */
    const double stretch = p->soft ? 2 : 1;                 /* of a bent outline */
    int32_t best = -1;
    for (int32_t k = 0; k < m->borders; k++) {
        double x, y, e;
        if (p->soft) {
            const double u = soft[k].x - p->at.x, w = soft[k].y - p->at.y;
            x = x0 + c * u + s * w, y = y0 + c * w - s * u;
        } else {
            const tz_vec2 u = m->border[k];
            x = x0 + mx * u.x - my * u.y, y = y0 + my * u.x + mx * u.y;
        }
        if (x >= 0 && y >= 0 && x < wide && y < high) {
            e = quick_distance(d, x, y) * scale;
            if (e > *most)
                *most = e, best = k;
        } else {
            const double ox = x < 0 ? -x : x - wide, oy = y < 0 ? -y : y - high;
            const double off = ox > oy ? ox : oy;
            e = -margin - (off > 0 ? cell * off : 0);
        }
        /* distances change by no more than the way: none of the few can be deeper */
        if (k % TZ_FILL_FEW == 0 &&
            e + stretch * p->scale * m->span[k / TZ_FILL_FEW] < *most)
            k += TZ_FILL_FEW - 1;
    }
    return best;
}

/* Border point of a that is deepest in b, or nearest; least is returned if none is
 * deeper than that. */
static double deepest(const repair *r, int32_t a, int32_t b, double least, tz_vec2 *at,
                      tz_vec2 *out)
{
    const tz_fill_model *m = &r->f->model.v[r->f->body.v[a].model];
    double most = least;
    if (!r->pose[b].soft) {
        const int32_t k = deepest_in_rigid(r, a, b, &most);
        if (k >= 0) {
            *at = border_point(r, a, k);
            depth_in(r, b, *at, out);
        }
        return most;
    }
    for (int32_t k = 0; k < m->borders; k++) {
        tz_vec2 way;
        const tz_vec2 q = border_point(r, a, k);
        const double d = depth_in(r, b, q, &way);
        if (d > most)
            most = d, *at = q, *out = way;
    }
    return most;
}

/* Whether discs of two bodies, each as much larger as its outline may lie beyond it, touch.
 */
static bool discs_are_near(const tz_fill *f, int32_t a, int32_t b)
{
    const tz_fill_body *p = &f->body.v[a], *q = &f->body.v[b];
    const double rim = f->model.v[p->model].rim * p->size * tz_fill_scale(f, p->first) +
                       f->model.v[q->model].rim * q->size * tz_fill_scale(f, q->first);
    for (int32_t i = p->first; i < p->first + p->n; i++)
        for (int32_t k = q->first; k < q->first + q->n; k++) {
            const tz_vec3 v = tz_fill_vector(f, f->at[i], f->at[k]);
            const double sum = f->c[i] * f->radius[i] + f->c[k] * f->radius[k] + rim;
            if (v.x * v.x + v.y * v.y < sum * sum)
                return true;
        }
    return false;
}

static bool are_near(const repair *r, int32_t a, int32_t b)
{
    const pose *p = &r->pose[a], *q = &r->pose[b];
    const tz_vec3 v = tz_fill_vector(r->f, (tz_vec3){p->at.x, p->at.y, 0},
                                     (tz_vec3){q->at.x, q->at.y, 0});
    const double sum = p->reach + q->reach;
    return v.x * v.x + v.y * v.y < sum * sum && discs_are_near(r->f, a, b);
}

static void add_push(const repair *r, int32_t i, push *p, tz_vec2 at, double x, double y,
                     double depth)
{
    const tz_vec3 arm = tz_fill_vector(
        r->f, (tz_vec3){r->pose[i].at.x, r->pose[i].at.y, 0}, (tz_vec3){at.x, at.y, 0});
    const double reach = r->pose[i].reach;
    p->x += x, p->y += y;
    p->turn += (arm.x * y - arm.y * x) / (reach * reach);
    p->depth = fmax(p->depth, depth);
    p->n++;
}

/* What a body's outline lacks to the border of the domain. */
static void push_inside(const repair *r, int32_t i, push *p)
{
    const tz_fill *f = r->f;
    const tz_fill_model *m = &f->model.v[f->body.v[i].model];
    const tz_domain *d = &f->domain;
    const tz_vec3 at = {r->pose[i].at.x, r->pose[i].at.y, 0};
    if (tz_domain_depth(d, tz_domain_wrap(d, at)) > r->pose[i].reach)
        return;
    double most = 0;
    tz_vec2 where = {0, 0};
    for (int32_t k = 0; k < m->borders; k++) {
        const tz_vec2 q = border_point(r, i, k);
        const double out = -tz_domain_depth(d, tz_domain_wrap(d, (tz_vec3){q.x, q.y, 0}));
        if (out > most)
            most = out, where = q;
    }
    if (!(most > 0))
        return;
    const double e = 0.01 * r->pose[i].reach;
    double x = 0, y = 0;
    for (int k = -1; k <= 1; k += 2) {
        x += k * tz_domain_depth(
                     d, tz_domain_wrap(d, (tz_vec3){where.x + k * e, where.y, 0}));
        y += k * tz_domain_depth(
                     d, tz_domain_wrap(d, (tz_vec3){where.x, where.y + k * e, 0}));
    }
    const double l = hypot(x, y);
    if (l > 0)
        add_push(r, i, p, where, most * x / l, most * y / l, most);
}

/* From where on a body's contacts count: depths, below 0 with a margin. */
static double least_of(const repair *r, int32_t i)
{
    const double slack = slack_of(r->f, i);
    return r->margin > 0 ? -r->margin / DEEP * slack : 0.8 * slack;
}

static void find_contacts(void *arg, int32_t from, int32_t to, double sums[4])
{
    const repair *r = arg;
    (void)sums;
    for (int32_t k = from; k < to; k++) {
        contact *c = &r->contact[k];
        if (!r->moved[c->a] && !r->moved[c->b])
            continue; /* nothing can have changed */
        c->near = are_near(r, c->a, c->b);
        if (!c->near)
            continue;
        const double p = least_of(r, c->a),
                     least = c->both ? fmin(p, least_of(r, c->b)) : p;
        c->depth[0] = deepest(r, c->a, c->b, least, &c->at[0], &c->out[0]);
        c->depth[1] = deepest(r, c->b, c->a, least, &c->at[1], &c->out[1]);
    }
}

static void sum_pushes(void *arg, int32_t from, int32_t to, double sums[4])
{
    const repair *r = arg;
    tz_fill *f = r->f;
    for (int32_t j = from; j < to; j++) {
        const int32_t a = f->live.v[j];
        const double least = least_of(r, a), gap = fmin(least, 0);
        push p = {0, 0, 0, 0, 0};
        if (r->awake[a] && !f->body.v[a].gone) {
            for (int32_t k = r->start[a]; k < r->start[a + 1]; k++) {
                const int32_t t = r->touch[k], b = r->near[k], own = t < 0;
                const contact *c = &r->contact[own ? ~t : t];
                if (!c->near || f->body.v[b].gone)
                    continue;
                const bool held = f->body.v[b].fixed || !f->body.v[b].awake;
                const double share = held ? 1 : 0.5;
                for (int way = 0; way < 2; way++) { /* its own outline first */
                    const int32_t e = own ^ way;
                    const double d = c->depth[e];
                    const double by = (way == 0 ? share : -share) * (d - gap);
                    if (d > least)
                        add_push(r, a, &p, c->at[e], by * c->out[e].x, by * c->out[e].y,
                                 d);
                }
            }
            push_inside(r, a, &p);
        }
        r->push[a] = p;
        sums[0] += p.n > 0;
    }
}

static tz_status find_pushes(repair *r)
{
    const tz_status s = tz_fill_blocks(r->f->ctx, r->contacts, find_contacts, r, NULL);
    return s == TZ_OK ? tz_fill_blocks(r->f->ctx, r->f->live.n, sum_pushes, r, NULL) : s;
}

/* ---- rounds ------------------------------------------------------------------------- */

static void move_body(repair *r, int32_t i)
{
    tz_fill *f = r->f;
    const tz_fill_body *b = &f->body.v[i];
    const push *p = &r->push[i];
    /* of many pushes, each asks for its own way: the mean, and a little more */
    const double by = p->n > 0 ? fmin(1, 1.6 / p->n) : 0;
    const double x = by * p->x, y = by * p->y;
    double a = r->pose[i].soft ? 0 : 0.2 * by * p->turn;
    a = fmin(fmax(a, -HELD - r->turned[i]), HELD - r->turned[i]);
    r->turned[i] += a;
    const double c = cos(a), s = sin(a);
    for (int32_t k = b->first; k < b->first + b->n; k++) {
        const double u = f->at[k].x - r->pose[i].at.x, v = f->at[k].y - r->pose[i].at.y;
        double *o = f->o + 2 * (ptrdiff_t)k;
        f->at[k].x = r->pose[i].at.x + c * u - s * v + x;
        f->at[k].y = r->pose[i].at.y + s * u + c * v + y;
        const double ox = o[0], oy = o[1];
        o[0] = c * ox - s * oy, o[1] = s * ox + c * oy;
    }
    find_pose(r, i);
}

/* One contact for a body and each near it, or for both if both move. */
static tz_status pair_up(repair *r)
{
    tz_fill *f = r->f;
    const int32_t n = r->start[f->body.n];
    r->contacts = 0;
    for (int32_t i = 0; i < f->body.n; i++) {
        const tz_fill_body *b = &f->body.v[i];
        r->moved[i] = b->awake && !b->fixed && !b->gone;
    }
    tz_status s = tz_realloc(f->ctx, &r->touch, (size_t)n + 1, sizeof *r->touch);
    if (s == TZ_OK)
        s = tz_realloc(f->ctx, &r->contact, (size_t)n + 1, sizeof *r->contact);
    for (int32_t a = 0; a < f->body.n && s == TZ_OK; a++)
        for (int32_t k = r->start[a]; k < r->start[a + 1]; k++) {
            const int32_t b = r->near[k];
            int32_t e = b < a ? r->start[b] : r->start[b + 1]; /* seen before */
            while (e < r->start[b + 1] && r->near[e] != a)
                e++;
            if (e < r->start[b + 1]) {
                r->touch[k] = ~r->touch[e];
                r->contact[r->touch[e]].both = true;
            } else {
                r->touch[k] = r->contacts;
                r->contact[r->contacts++] = (contact){.a = a, .b = b};
            }
        }
    return s;
}

/* Bodies that the discs of each touch. */
static tz_status find_near(repair *r)
{
    tz_fill *f = r->f;
    TZ_ARRAY(int32_t)
    list = {0};
    f->fresh = false;
    tz_status s = tz_fill_diagram(f);
    const tz_power_cells c = tz_power_get(f->power);
    tz_free(f->ctx, r->near);
    r->near = NULL;
    for (int32_t i = 0; i < f->body.n && s == TZ_OK; i++) {
        const tz_fill_body *b = &f->body.v[i];
        r->start[i] = list.n;
        if (b->gone || b->fixed || !b->awake)
            continue;
        for (int32_t k = b->first; k < b->first + b->n && s == TZ_OK; k++)
            for (int32_t e = 0; e < c.count[k] && s == TZ_OK; e++) {
                const int32_t o = f->owner[c.neighbour[c.start[k] + e]];
                bool new = o != i;
                for (int32_t j = r->start[i]; j < list.n && new; j++)
                    new = list.v[j] != o;
                if (new)
                    s = tz_array_push(f->ctx, &list, o);
            }
    }
    r->start[f->body.n] = list.n;
    r->near = list.v;
    return s == TZ_OK ? pair_up(r) : s;
}

/* Those that moved are looked at again, and those beside them. */
static void wake_moved(repair *r)
{
    tz_fill *f = r->f;
    for (int32_t j = 0; j < f->live.n; j++)
        r->awake[f->live.v[j]] = r->moved[f->live.v[j]] = false;
    for (int32_t j = 0; j < f->live.n; j++) {
        const int32_t i = f->live.v[j];
        if (r->push[i].n == 0)
            continue;
        r->awake[i] = r->moved[i] = true;
        for (int32_t k = r->start[i]; k < r->start[i + 1]; k++)
            r->awake[r->near[k]] = true;
    }
}

static void wake_every(repair *r)
{
    for (int32_t j = 0; j < r->f->live.n; j++)
        r->awake[r->f->live.v[j]] = true;
}

/* One round; *left = bodies that overlap more than the slack. */
static tz_status push_round(repair *r, int32_t *left)
{
    tz_fill *f = r->f;
    const tz_status s = find_pushes(r);
    *left = 0;
    for (int32_t j = 0; j < f->live.n && s == TZ_OK; j++) {
        const int32_t i = f->live.v[j];
        if (r->push[i].n == 0)
            continue;
        *left += r->push[i].depth > slack_of(f, i);
        move_body(r, i);
    }
    if (s == TZ_OK)
        wake_moved(r);
    return s;
}

/* Rounds until nothing overlaps, or STALL of them have not helped. */
static tz_status push_rounds(repair *r, int32_t rounds, double margin)
{
    tz_status s = TZ_OK;
    int32_t left = 1, least = INT32_MAX, since = 0;
    r->margin = margin;
    for (int32_t k = 0; k < rounds && left > 0 && s == TZ_OK; k++) {
        if (k % AGAIN == 0) {
            s = find_near(r);
            wake_every(r);
        }
        if (s == TZ_OK)
            s = tz_ctx_cancelled(r->f->ctx) ? TZ_CANCELLED : push_round(r, &left);
        since = left < 0.97 * least ? 0 : since + 1;
        least = left < least ? left : least;
        if (since >= STALL)
            break;
    }
    r->margin = 0;
    return s;
}

/* ---- shrinking, leaving ------------------------------------------------------------- */

static void shrink_body(repair *r, int32_t i, double by)
{
    tz_fill *f = r->f;
    const tz_fill_body *b = &f->body.v[i];
    for (int32_t k = b->first; k < b->first + b->n; k++) {
        f->c[k] *= by;
        f->at[k].x = r->pose[i].at.x + by * (f->at[k].x - r->pose[i].at.x);
        f->at[k].y = r->pose[i].at.y + by * (f->at[k].y - r->pose[i].at.y);
    }
    find_pose(r, i);
}

static tz_status shrink_rest(repair *r)
{
    tz_fill *f = r->f;
    double *shrunk = NULL;
    int32_t left = 1;
    tz_status s = tz_alloc(f->ctx, &shrunk, (size_t)f->body.n, sizeof *shrunk);
    for (int32_t i = 0; i < f->body.n && s == TZ_OK; i++)
        shrunk[i] = 1;
    if (s == TZ_OK)
        s = find_near(r);
    wake_every(r);
    for (int k = 0; k < SHRINKS && left > 0 && s == TZ_OK; k++) {
        s = push_round(r, &left);
        for (int32_t j = 0; j < f->live.n && s == TZ_OK; j++) {
            const int32_t i = f->live.v[j];
            const push *p = &r->push[i];
            if (p->depth <= slack_of(f, i) || shrunk[i] <= LEAST)
                continue;
            const double by = fmax(1 - 0.5 * p->depth / r->pose[i].reach, 0.96);
            const double was = shrunk[i];
            shrunk[i] *= by;
            f->shrunk += was >= 0.98 && shrunk[i] < 0.98;
            shrink_body(r, i, by);
        }
    }
    tz_free(f->ctx, shrunk);
    return s;
}

/* Of those that overlap by more than a share of their largest disc the worst about leaves.
 */
static tz_status drop_worst(repair *r, double share, int32_t *dropped)
{
    tz_fill *f = r->f;
    *dropped = 0;
    wake_every(r);
    tz_status s = find_pushes(r);
    for (int32_t j = 0; j < f->live.n && s == TZ_OK; j++) {
        const int32_t i = f->live.v[j];
        const double limit = share / DEEP * slack_of(f, i);
        if (r->push[i].depth <= limit)
            continue;
        bool worst = true;
        for (int32_t k = r->start[i]; k < r->start[i + 1] && worst; k++) {
            const int32_t b = r->near[k];
            const double d = r->push[b].depth;
            worst = f->body.v[b].gone || d < r->push[i].depth ||
                    (d == r->push[i].depth && b > i) || f->body.v[b].fixed;
        }
        if (!worst)
            continue;
        s = tz_fill_remove(f, i);
        f->dropped++, ++*dropped;
    }
    return s == TZ_OK ? tz_fill_lists(f) : s;
}

/* ---- empty places ------------------------------------------------------------------- */

/* Bodies about a sample, two rings of the diagram. */
static int32_t bodies_about(const tz_fill *f, int32_t sample, const tz_power_cells *c,
                            int32_t *list, int32_t most)
{
    int32_t n = 0;
    for (int32_t k = -1; k < c->count[sample]; k++) {
        const int32_t q = k < 0 ? sample : c->neighbour[c->start[sample] + k];
        for (int32_t e = -1; e < c->count[q] && n < most; e++) {
            const int32_t b = f->owner[e < 0 ? q : c->neighbour[c->start[q] + e]];
            bool new = !f->body.v[b].gone;
            for (int32_t j = 0; j < n && new; j++)
                new = list[j] != b;
            if (new)
                list[n++] = b;
        }
    }
    return n;
}

/* Pushes one that has just come out of what lies about it, which stays; with a little less
 * of its size each time that it is stuck. Whether it lies free in the end. */
static bool settle_one(repair *r, int32_t i, const int32_t *near, int32_t n)
{
    tz_fill *f = r->f;
    double size = 1;
    find_pose(r, i);
    r->turned[i] = 0;
    for (int32_t k = 0; k < TRIES; k++) {
        push p = {0, 0, 0, 0, 0};
        tz_vec2 at = {0, 0}, out = {0, 0};
        const double least = 0.8 * slack_of(f, i);
        for (int32_t j = 0; j < n; j++) {
            if (!are_near(r, i, near[j]))
                continue;
            const double d = deepest(r, i, near[j], least, &at, &out);
            if (d > least)
                add_push(r, i, &p, at, d * out.x, d * out.y, d);
            const double e = deepest(r, near[j], i, least, &at, &out);
            if (e > least)
                add_push(r, i, &p, at, -e * out.x, -e * out.y, e);
        }
        push_inside(r, i, &p);
        if (p.depth <= slack_of(f, i))
            return true;
        if (k > 3 && size > LEAST) {
            size *= 0.97;
            shrink_body(r, i, 0.97);
        }
        r->push[i] = p;
        move_body(r, i);
    }
    return false;
}

/* Room for one more body. */
static tz_status reserve_one(repair *r)
{
    tz_ctx *ctx = r->f->ctx;
    const size_t n = (size_t)r->f->body.n + 1;
    if ((int64_t)n <= r->room)
        return TZ_OK;
    const size_t room = n + n / 4;
    tz_status s = tz_realloc(ctx, &r->pose, room, sizeof *r->pose);
    if (s == TZ_OK)
        s = tz_realloc(ctx, &r->push, room, sizeof *r->push);
    if (s == TZ_OK)
        s = tz_realloc(ctx, &r->turned, room, sizeof *r->turned);
    if (s == TZ_OK)
        s = tz_realloc(ctx, &r->border,
                       ((size_t)r->softs + (room - n) + 2) * TZ_FILL_BORDER,
                       sizeof *r->border);
    if (s == TZ_OK)
        r->room = (int64_t)room;
    return s;
}

/* One of an entry at a gap, its middle there. */
static tz_status try_one(repair *r, int32_t entry, double size, const tz_fill_gap *g,
                         const int32_t *near, int32_t about, bool *came)
{
    tz_fill *f = r->f;
    const tz_fill_model *m = &f->model.v[entry];
    const int32_t n = f->n, bodies = f->body.n;
    const double scale = f->c[g->sample];
    const tz_vec2 t = tz_fill_turn(f, g->sample);
    tz_rng rng = tz_rng_make(f->seed, tz_rng_stream(STREAM_GAP, (uint64_t)f->made, 0));
    const double turn = m->turn + m->jitter * (2 * tz_rng_unit(&rng) - 1);
    const double angle = atan2(t.y, t.x), a = angle + turn;
    tz_vec2 mean = {0, 0};
    double total = 0;
    for (int32_t k = 0; k < m->n; k++) {
        const double w = m->radius[k] * m->radius[k];
        mean.x += w * m->rest[k].x, mean.y += w * m->rest[k].y, total += w;
    }
    const tz_vec2 d = tz_vec2_scale(mean, scale * size / total);
    const tz_vec3 at = {g->at.x - cos(a) * d.x + sin(a) * d.y,
                        g->at.y - sin(a) * d.x - cos(a) * d.y, 0};
    int32_t i;
    *came = false;
    tz_status s = reserve_one(r);
    if (s == TZ_OK)
        s = tz_fill_add_body(f, entry, at, angle, scale, size, turn, &i);
    if (s != TZ_OK)
        return s;
    r->pose[i].border = r->softs;
    for (int32_t k = n; k < f->n; k++)
        f->third[k] = 0, tz_fill_set_rho(f, k, f->rho[g->sample]);
    if (settle_one(r, i, near, about)) {
        *came = true;
        f->inserted++;
        r->softs += r->pose[i].soft;
    } else {
        f->body.n = bodies, f->n = n;
    }
    return s;
}

/* Entries in turn, beginning where chance says, until one can be pushed in; of an entry of
 * many sizes the largest that the gap may hold. */
static tz_status fill_gap(repair *r, const tz_fill_gap *g, const tz_power_cells *c,
                          int32_t first)
{
    enum { NEAR = 96, ENTRIES = 4 };
    tz_fill *f = r->f;
    int32_t near[NEAR];
    int32_t about = bodies_about(f, g->sample, c, near, 2 * NEAR / 3);
    for (int32_t i = first; i < f->body.n && about < NEAR; i++) { /* not in the diagram */
        const tz_vec3 v =
            tz_fill_vector(f, (tz_vec3){r->pose[i].at.x, r->pose[i].at.y, 0}, g->at);
        const double far = 3 * r->pose[i].reach + g->radius;
        if (v.x * v.x + v.y * v.y < far * far)
            near[about++] = i;
    }
    const double scale = f->c[g->sample];
    tz_rng rng = tz_rng_make(f->seed, tz_rng_stream(STREAM_GAP, (uint64_t)f->made, 1));
    const int32_t from = tz_rng_below(&rng, f->entries);
    bool came = false;
    tz_status s = TZ_OK;
    for (int32_t k = 0, tried = 0;
         k < f->entries && tried < ENTRIES && !came && s == TZ_OK; k++) {
        const int32_t entry = (from + k) % f->entries;
        const tz_fill_model *m = &f->model.v[entry];
        const double wide = tz_fill_spread(m, f->rho[g->sample]);
        const double hold = 1.4 * g->radius / (m->radius[0] * scale * wide);
        if (!(m->share > 0) || hold < m->size[0])
            continue;
        tried++;
        s = try_one(r, entry, fmin(hold, m->size[1]), g, near, about, &came);
    }
    return s;
}

static tz_status fill_gaps(repair *r)
{
    tz_fill *f = r->f;
    tz_fill_gap *gap = NULL;
    int32_t n = 0;
    double least = HUGE_VAL;
    for (int32_t k = 0; k < f->entries; k++)
        if (f->model.v[k].share > 0)
            least = fmin(least, f->model.v[k].radius[0] * f->model.v[k].size[0]);
    f->fresh = false;
    tz_status s = tz_fill_diagram(f);
    if (s == TZ_OK)
        s = tz_fill_gaps(f, least * f->guide.least / 1.4, f->live.n, &gap, &n);
    const tz_power_cells c = tz_power_get(f->power);
    const int32_t first = f->body.n;
    for (int32_t k = 0; k < n && s == TZ_OK; k++)
        s = fill_gap(r, &gap[k], &c, first);
    tz_free(f->ctx, gap);
    return s;
}

/* Jams: the worst of each leaves, the others go apart. */
static tz_status loosen(repair *r)
{
    tz_status s = TZ_OK;
    int32_t dropped = 1;
    for (int k = 0; k < JAMS && dropped > 0 && s == TZ_OK; k++) {
        s = drop_worst(r, JAM, &dropped);
        if (s == TZ_OK && dropped > 0)
            s = push_rounds(r, ROUNDS / 2, 0);
    }
    return s;
}

/* Those that have come, and the places of those that left: gaps become even again. */
static tz_status even_out(repair *r)
{
    tz_fill *f = r->f;
    if (f->body.n > r->bodies) { /* lists of what has come */
        const size_t n = (size_t)f->body.n;
        tz_status s = tz_realloc(f->ctx, &r->awake, n, sizeof *r->awake);
        if (s == TZ_OK)
            s = tz_realloc(f->ctx, &r->moved, n, sizeof *r->moved);
        if (s == TZ_OK)
            s = tz_realloc(f->ctx, &r->start, n + 1, sizeof *r->start);
        if (s != TZ_OK)
            return s;
        r->bodies = f->body.n;
    }
    tz_status s = tz_fill_lists(f);
    if (s == TZ_OK)
        s = push_rounds(r, f->local ? WIDE / 4 : WIDE / 2, MARGIN);
    return s == TZ_OK ? push_rounds(r, ROUNDS / 2, 0) : s;
}

tz_status tz_fill_repair(tz_fill *f)
{
    repair r = {.f = f, .room = f->body.n, .bodies = f->body.n};
    tz_status s = tz_fill_lists(f);
    tz_fill_release(f);
    const size_t n = (size_t)f->body.n;
    int32_t dropped;
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &r.pose, n, sizeof *r.pose);
    if (s == TZ_OK)
        s = tz_alloc_zero(f->ctx, &r.push, n, sizeof *r.push);
    if (s == TZ_OK)
        s = tz_alloc_zero(f->ctx, &r.turned, n, sizeof *r.turned);
    if (s == TZ_OK)
        s = tz_alloc_zero(f->ctx, &r.awake, n, sizeof *r.awake);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &r.moved, n, sizeof *r.moved);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &r.start, n + 1, sizeof *r.start);
    if (s == TZ_OK)
        s = find_poses(&r);
    if (s == TZ_OK)
        s = push_rounds(&r, f->local ? WIDE / 4 : WIDE, MARGIN);
    if (s == TZ_OK)
        s = push_rounds(&r, ROUNDS, 0);
    if (s == TZ_OK)
        s = loosen(&r);
    if (s == TZ_OK)
        s = shrink_rest(&r);
    if (s == TZ_OK)
        s = drop_worst(&r, 16 * DEEP, &dropped);
    if (s == TZ_OK && f->job.count == 0 && f->live.n > 0)
        s = fill_gaps(&r);
    if (s == TZ_OK)
        s = even_out(&r);
    f->fresh = false;
    tz_free(f->ctx, r.pose), tz_free(f->ctx, r.push), tz_free(f->ctx, r.awake);
    tz_free(f->ctx, r.moved);
    tz_free(f->ctx, r.start), tz_free(f->ctx, r.near);
    tz_free(f->ctx, r.touch), tz_free(f->ctx, r.contact);
    tz_free(f->ctx, r.border), tz_free(f->ctx, r.turned);
    return s;
}
