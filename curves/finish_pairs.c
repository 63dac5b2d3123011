/* SPDX-License-Identifier: Apache-2.0 */
/* Ends of drawings that have none. Any two within the reach may be joined, also by a turn,
 * before which one of two that end side by side is cut back to the other; the cost is the way of the curve (Hermite, the handles longer the more it turns) over the
 * reach, and more where it turns. Pairs are taken from the cheapest on; then an end that is
 * left takes a partner whose other partner finds a third (augmenting paths of three). What
 * then is left is walled in by other lines. A bridge may cross some of these: where it does
 * the two change sides, each half of the line goes on as that of the bridge which it turns
 * to less, so that nothing crosses and nothing ends. In the end, lines that end go as a
 * whole. */
#include <stdlib.h>
#include <string.h>

#include "curves/finish_internal.h"

enum {
    NEAREST = 12, /* partners that are tried for each end */
    STEPS = 12,   /* chords of a bridge */
    MOST = 20000, /* bridges in one round */
    PASSES = 6,   /* lines that a bridge crosses, at most */
    MOST_FOUND = 512
};
#define TURNING   0.7 /* of the cost, that a turn by pi adds to it */
#define MOST_TURN (1.6 * TZ_PI)
#define PASSING   1   /* a line that is crossed */
#define STEEP     0.2 /* sine of the angle with it, at least */
#define APART     0.15 /* of delta: so far from where they would cross lines change sides */
#define CUT       0.5 /* times what is cut off */
#define PENS      1.5 /* times the cost: lines of two pens */

typedef struct pair {
    double cost;
    int32_t a, b;   /* loose ends, by number */
    double cut[2];  /* lengths that their lines lose first */
    int32_t passes; /* lines that it crosses, from a on */
    struct {
        int32_t piece;
        double t, u; /* on the piece, on the curve */
    } pass[PASSES];
    tz_bezier curve;
} pair;

typedef struct way {
    tz_vec2 v[STEPS + 1], lo, hi;
} way;

typedef struct pairing {
    tz_net_edit *edit;
    tz_net *n;
    const tz_finish_limits *l;
    int32_t through;
    TZ_ARRAY(int32_t)
    loose; /* nodes */
    TZ_ARRAY(pair)
    pair;
    int32_t *taken; /* per loose end: its pair, or -1 */
    TZ_ARRAY(int32_t)
    done; /* pairs taken, also those given up */
    TZ_ARRAY(way)
    drawn; /* of these */
} pairing;

/* ---- candidates ------------------------------------------------------------------------ */

static double angle_between(tz_vec2 u, tz_vec2 v)
{
    return acos(fmin(fmax(tz_vec2_dot(u, v), -1), 1));
}

/* From p in direction u to q, where the line that ends there points to w. */
static tz_bezier connect(tz_vec2 p, tz_vec2 u, tz_vec2 q, tz_vec2 w, double *turn)
{
    const tz_vec2 v = tz_vec2_sub(q, p);
    const double d = tz_vec2_length(v);
    const tz_vec2 to = d > 0 ? tz_vec2_scale(v, 1 / d) : u;
    *turn = angle_between(u, to) + angle_between(to, tz_vec2_scale(w, -1));
    /* a half circle has handles of 2 / 3 of its diameter, a straight line of a third */
    const double h = d * (1 + fmin(*turn / TZ_PI, 1.5)) / 3;
    return (tz_bezier){
        {p, tz_vec2_add(p, tz_vec2_scale(u, h)), tz_vec2_add(q, tz_vec2_scale(w, h)), q}};
}

/* An edge's tail that does not count. */
typedef struct tail {
    int32_t edge, node;
    double way;
} tail;

static tail tail_of(const tz_net *n, int32_t node, double way)
{
    return (tail){n->edge_of[tz_net_end_at(n, node) >> 1], node, way};
}

static bool in_tail(const tz_net *n, const tail *t, const tz_net_point *p)
{
    const tz_net_edge *e = &n->edge.v[t->edge];
    return n->edge_of[p->piece] == t->edge &&
           ((e->from == t->node && p->along <= t->way) ||
            (e->to == t->node && e->length - p->along <= t->way));
}

static bool cross(tz_vec2 p, tz_vec2 q, tz_vec2 r, tz_vec2 s)
{
    const tz_vec2 d = tz_vec2_sub(q, p), e = tz_vec2_sub(s, r), f = tz_vec2_sub(r, p);
    const double det = d.x * e.y - d.y * e.x;
    if (det == 0)
        return false;
    const double u = (f.x * e.y - f.y * e.x) / det, v = (f.x * d.y - f.y * d.x) / det;
    return u >= 0 && u <= 1 && v >= 0 && v <= 1;
}

/* The lines that a chord crosses, but for two tails, into c; false if they are too many or
 * met too flatly. The chord is that of the curve from u on, du long. */
static bool pass_chord(const tz_net *n, tz_vec2 p, tz_vec2 q, const tail but[2], double u,
                       double du, int32_t through, pair *c)
{
    int32_t id[MOST_FOUND];
    const tz_vec2 mid = tz_vec2_scale(tz_vec2_add(p, q), 0.5), d = tz_vec2_sub(q, p);
    const double r = tz_vec2_length(d) / 2 + n->spacing;
    const tz_vec3 in = tz_domain_wrap(&n->set.domain, (tz_vec3){mid.x, mid.y, 0});
    const int32_t found =
        tz_grid_query(&n->grid, (tz_vec2){in.x, in.y}, r, id, MOST_FOUND);
    for (int32_t i = 0; i < found && i < MOST_FOUND; i++) {
        const tz_net_point *v = &n->point.v[id[i]];
        if (id[i] + 1 >= n->at[v->piece + 1] || in_tail(n, &but[0], v) ||
            in_tail(n, &but[0], v + 1) || in_tail(n, &but[1], v) ||
            in_tail(n, &but[1], v + 1))
            continue;
        const tz_vec2 from = tz_curve_copy(&n->set.domain, v->at, mid),
                      e = tz_vec2_sub(v[1].at, v->at), to = tz_vec2_add(from, e);
        if (!cross(p, q, from, to))
            continue;
        const double det = d.x * e.y - d.y * e.x;
        const tz_vec2 f = tz_vec2_sub(from, p);
        if (c->passes >= through || tz_net_fixed(n, v->piece) ||
            fabs(det) < STEEP * tz_vec2_length(d) * tz_vec2_length(e))
            return false;
        c->pass[c->passes].piece = v->piece;
        c->pass[c->passes].t = v->t + (f.x * d.y - f.y * d.x) / det * (v[1].t - v->t);
        c->pass[c->passes++].u = u + (f.x * e.y - f.y * e.x) / det * du;
    }
    return found <= MOST_FOUND;
}

static void sort_passes(pair *c)
{
    for (int i = 1; i < c->passes; i++)
        for (int j = i; j > 0 && c->pass[j].u < c->pass[j - 1].u; j--) {
            const double t = c->pass[j].t, u = c->pass[j].u;
            const int32_t piece = c->pass[j].piece;
            c->pass[j] = c->pass[j - 1];
            c->pass[j - 1].t = t, c->pass[j - 1].u = u, c->pass[j - 1].piece = piece;
        }
}

/* Whether the curve stays inside and crosses no more lines than it may. */
static bool clear_way(const pairing *k, pair *c, const tail but[2])
{
    const tz_net *n = k->n;
    tz_vec2 p = c->curve.p[0];
    c->passes = 0;
    for (int i = 1; i <= STEPS; i++) {
        const tz_vec2 q = tz_bezier_at(&c->curve, (double)i / STEPS);
        if (tz_domain_depth(&n->set.domain, (tz_vec3){q.x, q.y, 0}) < 0 ||
            !pass_chord(n, p, q, but, (i - 1.0) / STEPS, 1.0 / STEPS, k->through, c))
            return false;
        p = q;
    }
    sort_passes(c);
    return true;
}

/* Where a piece has run that far from one of its ends. */
static double parameter_at(const tz_bezier *b, double way, bool back)
{
    double lo = 0, hi = 1;
    for (int i = 0; i < 30; i++) {
        const double mid = (lo + hi) / 2;
        const tz_bezier part = tz_bezier_part(b, back ? 1 - mid : 0, back ? 1 : mid);
        *(tz_bezier_length(&part) < way ? &lo : &hi) = mid;
    }
    return back ? 1 - hi : hi;
}

/* A place on an edge, before its end at that node by `way`. */
typedef struct place {
    int32_t before; /* pieces that lie behind it as a whole */
    int32_t piece;
    bool back; /* the tail is at the piece's end */
    double t;
    tz_vec2 at, out; /* out: towards the end */
} place;

static place place_at(const tz_net *n, int32_t node, double way)
{
    const tz_net_edge *d = &n->edge.v[n->edge_of[tz_net_end_at(n, node) >> 1]];
    const bool front = d->from == node;
    place p = {.piece = -1, .at = n->set.node.v[node], .out = tz_net_outwards(n, node)};
    for (int32_t i = 0; i < d->steps && way > 0; i++) {
        const int32_t end = n->step.v[d->step + (front ? i : d->steps - 1 - i)];
        const tz_bezier b = tz_curve_bezier(&n->set, &n->set.piece.v[end >> 1]);
        const double length = tz_bezier_length(&b);
        if (length <= way) {
            way -= length;
            p.before++;
            continue;
        }
        p.piece = end >> 1;
        p.back = (end & 1) == front;
        p.t = parameter_at(&b, way, p.back);
        const tz_vec2 u = tz_bezier_slope(&b, p.t);
        const double size = tz_vec2_length(u);
        p.at = tz_bezier_at(&b, p.t);
        if (size > 0)
            p.out = tz_vec2_scale(u, (p.back ? 1 : -1) / size);
        break;
    }
    return p;
}

/* A line that the bridge crosses at pass i: its two halves on both sides of that, and what
 * of the bridge is cut out there. */
typedef struct gap {
    tz_bezier line;
    double t[2], u[2]; /* before and behind */
    tz_vec2 at[2];     /* of t, beside the bridge */
    int32_t node[2], own[2];
} gap;

/* False where there is no room. */
static bool open_gaps(const pairing *k, const pair *c, gap g[PASSES])
{
    const tz_net *n = k->n;
    const double length = tz_bezier_length(&c->curve);
    double room = APART * k->l->delta;
    for (int i = 0; i <= c->passes; i++)
        room = fmin(room, 0.3 * length *
                              ((i < c->passes ? c->pass[i].u : 1) -
                               (i > 0 ? c->pass[i - 1].u : 0)));
    for (int i = 0; i < c->passes; i++) {
        const int32_t piece = c->pass[i].piece;
        g[i].line = tz_curve_bezier(&n->set, &n->set.piece.v[piece]);
        const double size = tz_bezier_length(&g[i].line), t = c->pass[i].t;
        for (int j = 0; j < i; j++)
            if (c->pass[j].piece == piece)
                return false;
        if (k->edit->used[piece] || k->edit->gone[piece] ||
            k->edit->kept[piece].t[0] > 0 || k->edit->kept[piece].t[1] < 1)
            return false;
        room = fmin(room, 0.7 * size * fmin(t, 1 - t));
    }
    for (int i = 0; i < c->passes; i++) {
        const double size = tz_bezier_length(&g[i].line);
        const tz_vec2 x = tz_bezier_at(&c->curve, c->pass[i].u);
        for (int j = 0; j < 2; j++) {
            g[i].t[j] = c->pass[i].t + (j ? 1 : -1) * room / size;
            g[i].u[j] = c->pass[i].u + (j ? 1 : -1) * room / length;
            g[i].at[j] =
                tz_curve_copy(&n->set.domain, tz_bezier_at(&g[i].line, g[i].t[j]), x);
        }
    }
    return room > 0.02 * k->l->delta;
}

/* The pair, when its lines have been cut back so far; false if nothing comes of it. */
static bool try_pair(const pairing *k, const double cut[2], double reach, pair *c)
{
    const tz_net *n = k->n;
    const int32_t na = k->loose.v[c->a], nb = k->loose.v[c->b];
    const tail but[2] = {tail_of(n, na, cut[0] + 1.01 * n->spacing),
                         tail_of(n, nb, cut[1] + 1.01 * n->spacing)};
    const tz_net_edge *ea = &n->edge.v[but[0].edge], *eb = &n->edge.v[but[1].edge];
    const bool own = but[0].edge == but[1].edge;
    if (ea->length < (own ? cut[0] + cut[1] : cut[0]) + k->l->crumb ||
        eb->length < cut[1] + k->l->crumb)
        return false;
    const place p = place_at(n, na, cut[0]), q = place_at(n, nb, cut[1]);
    double turn;
    gap g[PASSES];
    c->curve =
        connect(p.at, p.out, tz_curve_copy(&n->set.domain, q.at, p.at), q.out, &turn);
    const double length = tz_bezier_length(&c->curve);
    if (turn > MOST_TURN || (own && ea->length < 2 * length) || !clear_way(k, c, but) ||
        !open_gaps(k, c, g))
        return false; /* it would come back by itself; be hardly a loop; cross something */
    c->cut[0] = cut[0];
    c->cut[1] = cut[1];
    c->cost =
        (length * (1 + TURNING * turn / TZ_PI) + CUT * (cut[0] + cut[1])) / reach *
        (n->pen[tz_net_end_at(n, na) >> 1] == n->pen[tz_net_end_at(n, nb) >> 1] ? 1
                                                                                : PENS);
    return true;
}

static tz_status add_pair(pairing *k, int32_t a, int32_t b, double reach)
{
    const tz_net *n = k->n;
    const int32_t na = k->loose.v[a], nb = k->loose.v[b];
    const tz_vec2 v = tz_net_vector(n, n->set.node.v[na], n->set.node.v[nb]),
                  u = tz_net_outwards(n, na), w = tz_net_outwards(n, nb);
    const double d = tz_vec2_length(v);
    pair c = {.a = a, .b = b};
    /* as they end; brought level; and a little farther back */
    const double ahead = 0.5 * (tz_vec2_dot(v, u) - tz_vec2_dot(v, w) * -1),
                 level[2] = {fmax(-ahead, 0), fmax(ahead, 0)};
    const double side = sqrt(fmax(d * d - ahead * ahead, 0)), room = 0.5 * side;
    const double cuts[4][2] = {{0, 0},
                               {level[0], level[1]},
                               {level[0] + room, level[1] + room},
                               {level[0] + 2 * room, level[1] + 2 * room}};
    const int tries = tz_vec2_dot(u, w) > 0.3 ? 4 : 1;
    if (!(d <= reach))
        return TZ_OK;
    for (int i = 0; i < tries; i++)
        if (try_pair(k, cuts[i], reach, &c))
            return tz_array_push(n->ctx, &k->pair, c);
    return TZ_OK;
}

typedef struct near_end {
    double d;
    int32_t id;
} near_end;

static int by_distance(const void *a, const void *b)
{
    const near_end *p = a, *q = b;
    if (p->d != q->d)
        return p->d < q->d ? -1 : 1;
    return (p->id > q->id) - (p->id < q->id);
}

static tz_status find_pairs(pairing *k, double reach)
{
    const tz_net *n = k->n;
    const tz_domain *d = &n->set.domain;
    tz_grid g = {0};
    near_end *near = NULL;
    int32_t id[MOST_FOUND];
    tz_vec2 *at = NULL;
    tz_status s = tz_alloc(n->ctx, &at, (size_t)k->loose.n, sizeof *at);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &near, MOST_FOUND, sizeof *near);
    for (int32_t i = 0; i < k->loose.n && s == TZ_OK; i++)
        at[i] = n->set.node.v[k->loose.v[i]];
    if (s == TZ_OK)
        s = tz_grid_init(n->ctx, &g, (tz_vec2){0, 0}, (tz_vec2){d->size.x, d->size.y},
                         fmax(reach / 2, hypot(d->size.x, d->size.y) / 2000), d->torus);
    for (int32_t i = 0; i < k->loose.n && s == TZ_OK; i++)
        s = tz_grid_add(n->ctx, &g, at[i], &id[0]);
    for (int32_t i = 0; i < k->loose.n && s == TZ_OK; i++) {
        int32_t found = MOST_FOUND + 1, m = 0;
        for (double r = reach; found > MOST_FOUND && r > 1e-3 * reach; r /= 2)
            found = tz_grid_query(&g, at[i], r, id, MOST_FOUND);
        found = found < MOST_FOUND ? found : MOST_FOUND;
        for (int32_t j = 0; j < found; j++)
            if (id[j] != i)
                near[m++] =
                    (near_end){tz_vec2_length(tz_net_vector(n, at[i], at[id[j]])), id[j]};
        if (m > 1)
            qsort(near, (size_t)m, sizeof *near, by_distance);
        for (int32_t j = 0; j < m && j < NEAREST && s == TZ_OK; j++)
            s = add_pair(k, i < near[j].id ? i : near[j].id,
                         i < near[j].id ? near[j].id : i, reach);
        if (s == TZ_OK && !(i & 1023) && tz_ctx_cancelled(n->ctx))
            s = TZ_CANCELLED;
    }
    tz_grid_deinit(n->ctx, &g);
    tz_free(n->ctx, near);
    tz_free(n->ctx, at);
    return s;
}

static int by_cost(const void *a, const void *b)
{
    const pair *p = a, *q = b;
    if (p->cost != q->cost)
        return p->cost < q->cost ? -1 : 1;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

/* ---- bridges among themselves ------------------------------------------------------------ */

static way way_of(const tz_bezier *c)
{
    way w = {.lo = {INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY}};
    for (int i = 0; i <= STEPS; i++) {
        const tz_vec2 p = w.v[i] = tz_bezier_at(c, (double)i / STEPS);
        w.lo = (tz_vec2){fmin(w.lo.x, p.x), fmin(w.lo.y, p.y)};
        w.hi = (tz_vec2){fmax(w.hi.x, p.x), fmax(w.hi.y, p.y)};
    }
    return w;
}

static bool ways_cross(const tz_domain *d, const way *a, const way *b)
{
    tz_vec2 by = {0, 0};
    if (d->torus)
        by = tz_vec2_sub(tz_curve_copy(d, b->v[STEPS / 2], a->v[STEPS / 2]),
                         b->v[STEPS / 2]);
    if (a->lo.x > b->hi.x + by.x || b->lo.x + by.x > a->hi.x ||
        a->lo.y > b->hi.y + by.y || b->lo.y + by.y > a->hi.y)
        return false;
    for (int i = 0; i < STEPS; i++)
        for (int j = 0; j < STEPS; j++)
            if (cross(a->v[i], a->v[i + 1], tz_vec2_add(b->v[j], by),
                      tz_vec2_add(b->v[j + 1], by)))
                return true;
    return false;
}

/* Whether it crosses one that is taken, but for those of that end (-1 = none). */
static bool in_the_way(const pairing *k, const way *w, int32_t but)
{
    for (int32_t i = 0; i < k->done.n; i++) {
        const int32_t id = k->done.v[i];
        const pair *c = &k->pair.v[id];
        if (k->taken[c->a] == id && c->a != but && c->b != but &&
            ways_cross(&k->n->set.domain, w, &k->drawn.v[i]))
            return true;
    }
    return false;
}

/* ---- matching ---------------------------------------------------------------------------- */

static tz_status take(pairing *k, int32_t id)
{
    const pair *c = &k->pair.v[id];
    k->taken[c->a] = k->taken[c->b] = id;
    tz_status s = tz_array_push(k->n->ctx, &k->done, id);
    return s == TZ_OK ? tz_array_push(k->n->ctx, &k->drawn, way_of(&c->curve)) : s;
}

/* Each pair has been found from both its ends. */
static void drop_doubles(pairing *k)
{
    int32_t n = 0;
    for (int32_t i = 0; i < k->pair.n; i++)
        if (n == 0 || k->pair.v[n - 1].a != k->pair.v[i].a ||
            k->pair.v[n - 1].b != k->pair.v[i].b)
            k->pair.v[n++] = k->pair.v[i];
    k->pair.n = n;
}

/* c joins a free end and a taken one, whose partner finds another free one. */
static tz_status augment(pairing *k, int32_t id, const int32_t *first, const int32_t *of)
{
    const pair *c = &k->pair.v[id];
    const bool fa = k->taken[c->a] < 0, fb = k->taken[c->b] < 0;
    if (fa == fb)
        return TZ_OK;
    const int32_t held = fa ? c->b : c->a, old = k->taken[held];
    const pair *o = &k->pair.v[old];
    const int32_t left = o->a == held ? o->b : o->a, mine = fa ? c->a : c->b;
    const way w = way_of(&c->curve);
    if (in_the_way(k, &w, held))
        return TZ_OK;
    for (int32_t i = first[left]; i < first[left + 1]; i++) {
        const pair *f = &k->pair.v[of[i]];
        const int32_t other = f->a == left ? f->b : f->a;
        const way x = way_of(&f->curve);
        if (other == mine || k->taken[other] >= 0 || in_the_way(k, &x, held) ||
            ways_cross(&k->n->set.domain, &w, &x))
            continue;
        const tz_status s = take(k, id);
        return s == TZ_OK ? take(k, of[i]) : s;
    }
    return TZ_OK;
}

static tz_status augment_all(pairing *k)
{
    int32_t *first = NULL, *of = NULL;
    tz_status s = tz_alloc_zero(k->n->ctx, &first, (size_t)k->loose.n + 2, sizeof *first);
    if (s == TZ_OK)
        s = tz_alloc(k->n->ctx, &of, 2 * (size_t)k->pair.n, sizeof *of);
    if (s == TZ_OK) {
        for (int32_t i = 0; i < k->pair.n; i++)
            first[k->pair.v[i].a + 2]++, first[k->pair.v[i].b + 2]++;
        for (int32_t i = 2; i < k->loose.n + 2; i++)
            first[i] += first[i - 1];
        for (int32_t i = 0; i < k->pair.n; i++) {
            of[first[k->pair.v[i].a + 1]++] = i;
            of[first[k->pair.v[i].b + 1]++] = i;
        }
    }
    for (int32_t i = 0; i < k->pair.n && s == TZ_OK; i++)
        s = augment(k, i, first, of);
    tz_free(k->n->ctx, first);
    tz_free(k->n->ctx, of);
    return s;
}

static tz_status need_kept(tz_net_edit *e)
{
    if (e->kept)
        return TZ_OK;
    const tz_status s =
        tz_alloc(e->net->ctx, &e->kept, (size_t)e->net->set.piece.n, sizeof *e->kept);
    for (int32_t i = 0; i < e->net->set.piece.n && s == TZ_OK; i++)
        e->kept[i] = (tz_net_kept){{0, 1}, {-1, -1}};
    return s;
}

/* Takes `way` from the edge's end at that node; the end is then `out`. */
static tz_status cut_back(tz_net_edit *e, int32_t node, double way, int32_t *out)
{
    const tz_net *n = e->net;
    const tz_net_edge *d = &n->edge.v[n->edge_of[tz_net_end_at(n, node) >> 1]];
    const place p = place_at(n, node, way);
    const bool front = d->from == node;
    *out = node;
    if (p.piece < 0)
        return TZ_OK;
    for (int32_t i = 0; i < p.before; i++)
        e->gone[n->step.v[d->step + (front ? i : d->steps - 1 - i)] >> 1] = true;
    tz_net_kept *k = &e->kept[p.piece];
    k->t[p.back] = p.t;
    const tz_status s = tz_net_edit_node(e, p.at, out);
    k->node[p.back] = *out;
    return s;
}

static tz_status add_bridge(pairing *k, const tz_bezier *c, int32_t a, int32_t b,
                            int32_t end, double wa, double wb)
{
    const tz_net_bridge bridge = {
        .node = {a, b}, .curve = *c, .taper = {wa, wb}, .pen = k->n->pen[end >> 1]};
    return tz_array_push(k->n->ctx, &k->edit->bridge, bridge);
}

static tz_vec2 heading(const tz_bezier *c, double t)
{
    const tz_vec2 d = tz_bezier_slope(c, t);
    const double size = tz_vec2_length(d);
    return size > 0 ? tz_vec2_scale(d, 1 / size) : (tz_vec2){1, 0};
}

/* Both halves of the line are led on to those of the bridge that they turn to less. */
static tz_status switch_sides(pairing *k, const pair *c, int i, gap *g, double w)
{
    const tz_net *n = k->n;
    const int32_t piece = c->pass[i].piece;
    const tz_vec2 v = heading(&c->curve, c->pass[i].u),
                  d = heading(&g->line, c->pass[i].t);
    const bool along = tz_vec2_dot(v, d) > 0;
    tz_status s = TZ_OK;
    k->edit->used[piece] = true;
    for (int j = 0; j < 2 && s == TZ_OK; j++) {
        s = tz_net_edit_node(k->edit, g->at[j], &g->node[j]);
        if (s == TZ_OK)
            s = tz_array_push(
                n->ctx, &k->edit->cut,
                ((tz_curve_cut){piece, j ? g->node[j] : ~g->node[j], g->t[j]}));
        if (s == TZ_OK)
            s = tz_net_edit_node(k->edit, tz_bezier_at(&c->curve, g->u[j]), &g->own[j]);
    }
    for (int j = 0; j < 2 && s == TZ_OK; j++) { /* j: what comes, what goes */
        const int half = along ? 1 - j : j;
        double turn;
        const tz_vec2 from = tz_bezier_at(&c->curve, g->u[j]),
                      out = heading(&c->curve, g->u[j]),
                      in = heading(&g->line, g->t[half]);
        const tz_bezier b = connect(from, j ? tz_vec2_scale(out, -1) : out, g->at[half],
                                    half ? tz_vec2_scale(in, -1) : in, &turn);
        s = add_bridge(k, &b, g->own[j], g->node[half], 2 * piece, w, w);
    }
    return s;
}

static tz_status draw(pairing *k, int32_t id)
{
    const tz_net *n = k->n;
    const pair *c = &k->pair.v[id];
    const int32_t a = k->loose.v[c->a], b = k->loose.v[c->b];
    const int32_t ends[2] = {tz_net_end_at(n, a), tz_net_end_at(n, b)};
    const double wa = tz_net_width_at(n, a), wb = tz_net_width_at(n, b);
    gap g[PASSES];
    int32_t from, to;
    for (int i = 0; i < 2; i++) /* a line that has been switched is another */
        if (k->edit->used[ends[i] >> 1])
            return TZ_OK;
    if (!open_gaps(k, c, g))
        return TZ_OK;
    tz_status s = cut_back(k->edit, a, c->cut[0], &from);
    if (s == TZ_OK)
        s = cut_back(k->edit, b, c->cut[1], &to);
    double u = 0;
    for (int i = 0; i <= c->passes && s == TZ_OK; i++) {
        const bool last = i == c->passes;
        if (!last)
            s = switch_sides(k, c, i, &g[i], (wa + wb) / 2);
        const tz_bezier part = tz_bezier_part(&c->curve, u, last ? 1 : g[i].u[0]);
        if (s == TZ_OK)
            s = add_bridge(k, &part, from, last ? to : g[i].own[0],
                           u < 0.5 ? ends[0] : ends[1], i ? (wa + wb) / 2 : wa,
                           last ? wb : (wa + wb) / 2);
        if (!last) {
            from = g[i].own[1];
            u = g[i].u[1];
        }
    }
    k->edit->closed++;
    return s;
}

tz_status tz_finish_pairs(tz_net_edit *e, const tz_finish_limits *l, double reach,
                          int32_t through, double most)
{
    tz_net *n = e->net;
    pairing k = {
        .edit = e, .n = n, .l = l, .through = through < PASSES ? through : PASSES};
    double over = tz_net_ends(n, l->margin) - most;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < n->set.node.n && s == TZ_OK && over > 0; i++)
        if (tz_net_dangles(n, i, l->margin) && !e->gone[tz_net_end_at(n, i) >> 1] &&
            e->merged[i] == i)
            s = tz_array_push(n->ctx, &k.loose, i);
    if (s == TZ_OK)
        s = need_kept(e);
    if (s == TZ_OK && k.loose.n > 1)
        s = find_pairs(&k, reach);
    if (s == TZ_OK)
        s = tz_alloc(n->ctx, &k.taken, (size_t)k.loose.n, sizeof *k.taken);
    for (int32_t i = 0; i < k.loose.n && s == TZ_OK; i++)
        k.taken[i] = -1;
    if (s == TZ_OK && k.pair.n > 1)
        qsort(k.pair.v, (size_t)k.pair.n, sizeof *k.pair.v, by_cost);
    if (s == TZ_OK)
        drop_doubles(&k);
    for (int32_t i = 0; i < k.pair.n && s == TZ_OK && over > 0 && k.done.n < MOST; i++) {
        const pair *c = &k.pair.v[i];
        if (k.taken[c->a] >= 0 || k.taken[c->b] >= 0)
            continue;
        const way w = way_of(&c->curve);
        if (in_the_way(&k, &w, -1))
            continue;
        s = take(&k, i);
        over -= 2;
    }
    if (s == TZ_OK && over > 0 && k.done.n < MOST)
        s = augment_all(&k);
    for (int32_t i = 0; i < k.loose.n && s == TZ_OK; i++)
        if (k.taken[i] >= 0 && k.pair.v[k.taken[i]].a == i)
            s = draw(&k, k.taken[i]);
    tz_array_free(n->ctx, &k.loose);
    tz_array_free(n->ctx, &k.pair);
    tz_array_free(n->ctx, &k.done);
    tz_array_free(n->ctx, &k.drawn);
    tz_free(n->ctx, k.taken);
    return s;
}

/* ---- going as a whole --------------------------------------------------------------------- */

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
