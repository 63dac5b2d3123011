/* SPDX-License-Identifier: Apache-2.0 */
/* Gaps between true outlines, and rounds that even them out. A round finds all contacts,
 * then takes the steps x and turns t (times reach) of all bodies that minimise
 *
 *   sum over contacts (lack - n (x_a - x_b) - m_a t_a + m_b t_b)^2
 *     + sum over borders (lack - n x_a - m_a t_a)^2
 *     + EASE sum (|x_a|^2 + t_a^2) + STIFF sum (T_a + t_a)^2 + even sum |x_a - g_a|^2,
 *
 * n the way out of a contact, m its arm over the reach, T the turn so far, g the way to
 * the centre of its cells: bodies slide freely along each other, long ones out of jams
 * along themselves, but turn only where much presses, and back when it no longer does;
 * for directions are the solver's and the artist's. All are moved together, by conjugate
 * gradients, so that what is pressed anywhere spreads in few rounds to where there is
 * room; finding contacts costs most.
 *
 * @source Gauss-Newton on penalties; the steps that single contacts would take one by one
 *   are those of Mueller et al., Position based dynamics, 2007 */
#include <assert.h>

#include "fields/fill_outline_internal.h"

enum {
    AGAIN = 6, /* rounds that neighbours are good for */
    WHOLE =
        3, /* rounds that the nearest points of two outlines are followed along them */
    INNER = 16 /* rounds of conjugate gradients */
};
#define EASE   0.1  /* weight of staying */
#define STIFF  10.0 /* of the turn so far, which goes back when nothing presses */
#define SURE   20.0 /* times that, under strokes */
#define NEVER  1e6  /* times that: lengths only */
#define NARROW 0.2  /* part of gaps from which only overlaps count */
#define STEP   0.5  /* of the largest disc, at most in one round */

static bool is_held(const tz_fill *f, int32_t i)
{
    const tz_fill_body *b = &f->body.v[i];
    return b->gone || b->fixed || !b->awake;
}

/* ---- pairs -------------------------------------------------------------------------- */

/* One contact for a body and each near it, or for both if both move. */
static tz_status pair_up(tz_fill_outlines *o)
{
    tz_fill *f = o->f;
    const int32_t n = o->start[f->body.n];
    tz_status s = tz_realloc(f->ctx, &o->touch, (size_t)n + 1, sizeof *o->touch);
    if (s == TZ_OK)
        s = tz_realloc(f->ctx, &o->contact, (size_t)n + 1, sizeof *o->contact);
    if (s == TZ_OK)
        s = tz_realloc(f->ctx, &o->share, 2 * (size_t)n + 1, sizeof *o->share);
    o->contacts = 0;
    for (int32_t a = 0; a < f->body.n && s == TZ_OK; a++)
        for (int32_t k = o->start[a]; k < o->start[a + 1]; k++) {
            const int32_t b = o->near[k];
            int32_t e = b < a ? o->start[b] : o->start[b + 1];
            while (e < o->start[b + 1] && o->near[e] != a)
                e++;
            if (e < o->start[b + 1]) {
                o->touch[k] = ~o->touch[e];
                o->contact[o->touch[e]].both = true;
            } else {
                o->touch[k] = o->contacts;
                o->contact[o->contacts++] =
                    (tz_fill_contact){.a = a, .b = b, .age = -1, .best = {-1, -1}};
            }
        }
    return s;
}

/* From a body to the centre of all its discs' cells: Eq. (1), for the body. */
static tz_vec2 pull_of(const tz_fill_body *b, const tz_power_cells *c)
{
    tz_vec2 sum = {0, 0};
    double area = 0;
    for (int32_t k = b->first; k < b->first + b->n; k++)
        if (c->area[k] > 0) {
            sum.x += c->area[k] * c->centre[k].x, sum.y += c->area[k] * c->centre[k].y;
            area += c->area[k];
        }
    return area > 0 ? tz_vec2_scale(sum, 1 / area) : sum;
}

typedef TZ_ARRAY(int32_t)
near_list;

/* A body that lies whole within larger discs has no cells and meets nobody: the sample that
 * has the cell there, walked to over neighbours from one that has a cell; -1 = none. */
static int32_t within(const tz_fill *f, const tz_fill_body *b, const tz_power_cells *c,
                      int32_t q)
{
    if (q >= f->n || c->count[q] == 0)
        return -1;
    double least = HUGE_VAL;
    for (int32_t step = 0; step < f->n; step++) {
        int32_t next = -1;
        for (int32_t e = step == 0 ? -1 : 0; e < c->count[q]; e++) {
            const int32_t k = e < 0 ? q : c->neighbour[c->start[q] + e];
            const tz_vec3 v = tz_fill_vector(f, f->at[k], f->at[b->first]);
            const double r = tz_fill_radius(f, k), power = v.x * v.x + v.y * v.y - r * r;
            if (power < least)
                least = power, next = k;
        }
        if (next < 0)
            break;
        q = next;
    }
    return q;
}

/* The owner of a sample is near a body, if it is another's; once. */
static tz_status add_near(tz_fill_outlines *o, near_list *list, int32_t i, int32_t sample)
{
    const int32_t q = o->f->owner[sample];
    bool new = q != i;
    for (int32_t j = o->start[i]; list->v && j < list->n && new; j++)
        new = list->v[j] != q;
    if (!o->known[q])
        tz_fill_outline_find(o, q);
    if (!new)
        return TZ_OK;
    const tz_status s = tz_array_push(o->f->ctx, list, q);
    assert(s != TZ_OK || list->v);
    return s;
}

tz_status tz_fill_contacts_find(tz_fill_outlines *o)
{
    tz_fill *f = o->f;
    near_list list = {0};
    f->fresh = false;
    tz_status s = tz_fill_diagram(f);
    if (s == TZ_OK)
        s = tz_fill_outlines_reserve(o, 0);
    const tz_power_cells c = tz_power_get(f->power);
    int32_t seen = 0; /* the last sample that has a cell */
    while (s == TZ_OK && seen < f->n && c.count[seen] == 0)
        seen++;
    tz_free(f->ctx, o->near);
    o->near = NULL;
    for (int32_t i = 0; i < f->body.n && s == TZ_OK; i++) {
        const tz_fill_body *b = &f->body.v[i];
        o->start[i] = list.n;
        if (is_held(f, i))
            continue;
        o->moved[i] = true;
        o->lack[i].pull = pull_of(b, &c);
        bool hidden = true;
        for (int32_t k = b->first; k < b->first + b->n; k++) {
            for (int32_t e = 0; e < c.count[k] && s == TZ_OK; e++)
                s = add_near(o, &list, i, c.neighbour[c.start[k] + e]);
            if (c.count[k] > 0)
                hidden = false, seen = k;
        }
        const int32_t in = hidden && s == TZ_OK ? within(f, b, &c, seen) : -1;
        if (in >= 0 && s == TZ_OK)
            s = add_near(o, &list, i, in);
        if (!o->known[i])
            tz_fill_outline_find(o, i);
    }
    if (s != TZ_OK) {
        tz_array_free(f->ctx, &list);
        return s;
    }
    o->start[f->body.n] = list.n;
    o->near = list.v;
    return pair_up(o);
}

/* ---- contacts ----------------------------------------------------------------------- */

/* How far a point moves along a way as a body turns, over its reach. */
static double arm_of(const tz_fill_outlines *o, int32_t i, tz_vec2 at, tz_vec2 way)
{
    const tz_fill_pose_of *p = &o->pose[i];
    const tz_vec3 v =
        tz_fill_vector(o->f, (tz_vec3){p->at.x, p->at.y, 0}, (tz_vec3){at.x, at.y, 0});
    return (v.x * way.y - v.y * way.x) / p->reach;
}

static void find_contacts(void *arg, int32_t from, int32_t to, double sums[4])
{
    const tz_fill_outlines *o = arg;
    (void)sums;
    for (int32_t k = from; k < to; k++) {
        tz_fill_contact *c = &o->contact[k];
        if (!o->moved[c->a] && !o->moved[c->b])
            continue; /* nothing can have changed */
        c->lack[0] = c->lack[1] = 0;
        c->near = tz_fill_outlines_near(o, c->a, c->b);
        if (!c->near)
            continue;
        const double gap = o->part * (o->pose[c->a].gap + o->pose[c->b].gap);
        c->age = (int8_t)((c->age + 1) % WHOLE);
        for (int e = 0; e < 2; e++) {
            const int32_t a = e ? c->b : c->a, b = e ? c->a : c->b;
            c->lack[e] = gap + tz_fill_outline_depth(o, a, b, -gap, c->age == 0,
                                                     &c->best[e], &c->at[e], &c->way[e]);
            if (!(c->lack[e] > 0))
                continue;
            if (e)
                c->way[e] = tz_vec2_scale(c->way[e], -1);
            c->arm[e][0] = arm_of(o, c->a, c->at[e], c->way[e]);
            c->arm[e][1] = arm_of(o, c->b, c->at[e], c->way[e]);
        }
    }
}

static void add_row(tz_fill_lack *l, tz_vec2 n, double arm, double lack)
{
    l->row[0] += n.x * n.x, l->row[1] += n.x * n.y, l->row[2] += n.y * n.y;
    l->row[3] += n.x * arm, l->row[4] += n.y * arm, l->row[5] += arm * arm;
    l->b.x += lack * n.x, l->b.y += lack * n.y, l->b.z += lack * arm;
}

/* What a stroke has turned turns hardly, and nothing does that is only pushed. */
static double stiff_of(const tz_fill_outlines *o, int32_t i)
{
    const tz_fill *f = o->f;
    if (o->straight)
        return NEVER * STIFF;
    return f->confident[f->body.v[i].first] > 0 ? SURE * STIFF : STIFF;
}

/* A body's rows: its contacts and the border. Sums: energy; bodies that overlap. */
static void find_rows(void *arg, int32_t from, int32_t to, double sums[4])
{
    const tz_fill_outlines *o = arg;
    tz_fill *f = o->f;
    for (int32_t j = from; j < to; j++) {
        const int32_t a = f->live.v[j];
        tz_fill_lack *l = &o->lack[a];
        const double own = o->part * o->pose[a].gap;
        double least = HUGE_VAL;
        tz_vec2 at;
        const double turned = l->turned, even = o->even, stiff = stiff_of(o, a);
        const tz_vec2 pull = l->pull;
        tz_fill_share *share = o->share + 2 * (ptrdiff_t)o->start[a];
        *l = (tz_fill_lack){
            .turned = turned,
            .pull = pull,
            .row = {EASE + even, 0, EASE + even, 0, 0, EASE + stiff},
            .b = {even * pull.x, even * pull.y, -stiff * turned * o->pose[a].reach}};
        for (int32_t k = o->start[a]; k < o->start[a + 1] && !f->body.v[a].gone; k++) {
            const bool other = o->touch[k] < 0;
            const tz_fill_contact *c = &o->contact[other ? ~o->touch[k] : o->touch[k]];
            if (!c->near || f->body.v[o->near[k]].gone)
                continue;
            const double gap = own + o->part * o->pose[o->near[k]].gap;
            for (int e = 0; e < 2; e++) {
                if (!(c->lack[e] > 0))
                    continue;
                const double way = other ? -1 : 1;
                add_row(l, tz_vec2_scale(c->way[e], way), way * c->arm[e][other],
                        c->lack[e]);
                if (c->both)
                    share[l->shares++] =
                        (tz_fill_share){o->near[k], c->way[e].x, c->way[e].y,
                                        c->arm[e][other], c->arm[e][!other]};
                least = fmin(least, gap - c->lack[e]);
                l->energy += c->lack[e] * c->lack[e];
                sums[0] += (c->both ? 0.5 : 1) * c->lack[e] * c->lack[e];
            }
        }
        l->border =
            f->body.v[a].gone ? 0 : tz_fill_outline_border(o, a, own, &at, &l->way);
        if (l->border > 0) {
            add_row(l, l->way, arm_of(o, a, at, l->way), l->border);
            least = fmin(least, own - l->border);
            l->energy += l->border * l->border;
            sums[0] += l->border * l->border;
        }
        l->depth = -least;
        sums[1] += l->depth > tz_fill_slack(f, a);
    }
}

tz_status tz_fill_contacts_measure(tz_fill_outlines *o)
{
    tz_status s = tz_fill_heavy(o->f->ctx, o->contacts, find_contacts, o, NULL);
    for (int32_t j = 0; j < o->f->live.n; j++)
        o->moved[o->f->live.v[j]] = false;
    return s == TZ_OK ? tz_fill_blocks(o->f->ctx, o->f->live.n, find_rows, o, NULL) : s;
}

/* ---- the step ----------------------------------------------------------------------- */

typedef struct run {
    tz_fill_outlines *o;
    double alpha, beta;
} run;

static inline double dot(tz_vec3 a, tz_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* The inverse of a body's own rows, as a preconditioner. */
static tz_vec3 own_step(const tz_fill_lack *l, tz_vec3 v)
{
    const double *m = l->row;
    const double a = m[2] * m[5] - m[4] * m[4], b = m[3] * m[4] - m[1] * m[5],
                 c = m[1] * m[4] - m[2] * m[3], d = m[0] * m[5] - m[3] * m[3],
                 e = m[1] * m[3] - m[0] * m[4], g = m[0] * m[2] - m[1] * m[1];
    const double by = 1 / (m[0] * a + m[1] * b + m[3] * c);
    return (tz_vec3){by * (a * v.x + b * v.y + c * v.z),
                     by * (b * v.x + d * v.y + e * v.z),
                     by * (c * v.x + e * v.y + g * v.z)};
}

static void first(void *arg, int32_t from, int32_t to, double sums[4])
{
    const run *t = arg;
    for (int32_t j = from; j < to; j++) {
        tz_fill_lack *l = &t->o->lack[t->o->f->live.v[j]];
        l->x = (tz_vec3){0, 0, 0};
        l->r = l->b;
        l->p = own_step(l, l->r);
        sums[0] += dot(l->r, l->p);
    }
}

static void multiply(void *arg, int32_t from, int32_t to, double sums[4])
{
    const run *t = arg;
    const tz_fill_outlines *o = t->o;
    const tz_fill *f = o->f;
    for (int32_t j = from; j < to; j++) {
        const int32_t a = f->live.v[j];
        tz_fill_lack *l = &o->lack[a];
        const double *m = l->row;
        const tz_vec3 p = l->p;
        tz_vec3 q = {m[0] * p.x + m[1] * p.y + m[3] * p.z,
                     m[1] * p.x + m[2] * p.y + m[4] * p.z,
                     m[3] * p.x + m[4] * p.y + m[5] * p.z};
        const tz_fill_share *share = o->share + 2 * (ptrdiff_t)o->start[a];
        for (int32_t k = 0; k < l->shares; k++) {
            const tz_fill_share *e = &share[k];
            const tz_vec3 w = o->lack[e->with].p;
            const double d = e->x * w.x + e->y * w.y + e->other * w.z;
            q.x -= d * e->x, q.y -= d * e->y, q.z -= d * e->own;
        }
        l->q = q;
        sums[0] += dot(p, q);
    }
}

static void advance(void *arg, int32_t from, int32_t to, double sums[4])
{
    const run *t = arg;
    const double by = t->alpha;
    for (int32_t j = from; j < to; j++) {
        tz_fill_lack *l = &t->o->lack[t->o->f->live.v[j]];
        l->x.x += by * l->p.x, l->x.y += by * l->p.y, l->x.z += by * l->p.z;
        l->r.x -= by * l->q.x, l->r.y -= by * l->q.y, l->r.z -= by * l->q.z;
        l->q = own_step(l, l->r);
        sums[0] += dot(l->r, l->q);
    }
}

static void turn(void *arg, int32_t from, int32_t to, double sums[4])
{
    const run *t = arg;
    (void)sums;
    for (int32_t j = from; j < to; j++) {
        tz_fill_lack *l = &t->o->lack[t->o->f->live.v[j]];
        l->p = (tz_vec3){l->q.x + t->beta * l->p.x, l->q.y + t->beta * l->p.y,
                         l->q.z + t->beta * l->p.z};
    }
}

static tz_status solve(tz_fill_outlines *o)
{
    tz_ctx *ctx = o->f->ctx;
    const int32_t n = o->f->live.n;
    run t = {o, 0, 0};
    double sums[4];
    tz_status s = tz_fill_blocks(ctx, n, first, &t, sums);
    double rz = sums[0];
    const double enough = 1e-4 * rz;
    for (int k = 0; k < INNER && rz > enough && s == TZ_OK; k++) {
        s = tz_fill_blocks(ctx, n, multiply, &t, sums);
        if (s != TZ_OK || !(sums[0] > 0))
            break;
        t.alpha = rz / sums[0];
        s = tz_fill_blocks(ctx, n, advance, &t, sums);
        t.beta = sums[0] / rz;
        rz = sums[0];
        if (s == TZ_OK)
            s = tz_fill_blocks(ctx, n, turn, &t, NULL);
    }
    return s;
}

static void move_bodies(void *arg, int32_t from, int32_t to, double sums[4])
{
    tz_fill_outlines *o = arg;
    tz_fill *f = o->f;
    (void)sums;
    for (int32_t j = from; j < to; j++) {
        const int32_t i = f->live.v[j];
        const tz_fill_body *b = &f->body.v[i];
        const tz_vec3 x = o->lack[i].x;
        const double l = sqrt(dot(x, x)),
                     r = f->radius[b->first] * tz_fill_scale(f, b->first);
        if (b->gone || !(l > 1e-4 * r))
            continue;
        o->moved[i] = true;
        const double by = fmin(1, STEP * r / l), turn = by * x.z / o->pose[i].reach;
        tz_fill_outline_move(o, i, (tz_vec2){by * x.x, by * x.y});
        tz_fill_outline_turn(o, i, turn);
        o->lack[i].turned += turn;
        o->lack[i].pull.x -= by * x.x, o->lack[i].pull.y -= by * x.y;
    }
}

tz_status tz_fill_contacts_relax(tz_fill_outlines *o, int32_t rounds, double part,
                                 int32_t *left)
{
    tz_fill *f = o->f;
    tz_status s = TZ_OK;
    double sums[4] = {0};
    o->part = part;
    for (int32_t k = 0; k < rounds && s == TZ_OK; k++) {
        if (k % AGAIN == 0)
            s = tz_fill_contacts_find(o);
        if (s == TZ_OK)
            s = tz_ctx_cancelled(f->ctx) ? TZ_CANCELLED : TZ_OK;
        if (s == TZ_OK)
            s = tz_fill_heavy(f->ctx, o->contacts, find_contacts, o, NULL);
        for (int32_t j = 0; j < f->live.n; j++)
            o->moved[f->live.v[j]] = false;
        if (s == TZ_OK)
            s = tz_fill_blocks(f->ctx, f->live.n, find_rows, o, sums);
        if (s != TZ_OK || (!(sums[0] > 0) && !(o->even > 0)) ||
            (part < NARROW && !(sums[1] > 0)))
            break;
        s = solve(o);
        if (s == TZ_OK)
            s = tz_fill_blocks(f->ctx, f->live.n, move_bodies, o, NULL);
    }
    f->fresh = false;
    if (left)
        *left = (int32_t)sums[1];
    return s;
}
