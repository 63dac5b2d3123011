/* SPDX-License-Identifier: Apache-2.0 */
/* Finishing, in rounds until nothing is left to do: the curves become a net (joined where
 * they touch and cross), what the exemplar's net never has is mended, the net becomes
 * curves again. Where nothing is to be mended, nothing is touched.
 *
 * All limits are halves of the least that the exemplar has, so that it passes itself. */
#include "curves/finish.h"

#include <stdlib.h>
#include <string.h>

#include "curves/finish_internal.h"

enum { ROUNDS = 12 };
#define DENSE  3    /* delta is no more than so many times area over length */
#define JOIN   0.02 /* of delta: what is so near touches */
#define MARGIN 0.1  /* of delta */
#define REACH  1.25 /* of delta */
#define GROWTH 1.4  /* of the reach where the exemplar has no ends, a round */
#define CHANCE \
    1.03 /* times as many ends as the exemplar has a length are none too many */
#define SAME    1e-6 /* of delta: lines so near are one */
#define FEW     8    /* ends: of fewer nothing is told */
#define SPACING 0.1  /* of delta: points of nets */

/* ---- what the exemplar has ----------------------------------------------------------- */

/* The finest spacing of samples; in dense drawings a few times that of their lines. */
static double finest(const tz_curve_set *s)
{
    const tz_sample_levels l = tz_sample_levels_default(s);
    const double spacing = l.spacing[l.levels - 1];
    double length = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        length += tz_bezier_length(&b);
    }
    return length > 0
               ? fmin(spacing, DENSE * s->domain.size.x * s->domain.size.y / length)
               : spacing;
}

/* Thick lines that lie beside each other are not to be taken for one. */
static tz_curve_join_params join_within(const tz_curve_set *s, double delta)
{
    return (tz_curve_join_params){.crossings = true,
                                  .reach = fmin(tz_curve_reach(s), JOIN * delta)};
}

static int up(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static tz_status measure_branches(const tz_net *n, tz_finish_limits *l)
{
    TZ_ARRAY(double)
    length = {0};
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < n->edge.n && s == TZ_OK; i++) {
        const tz_net_edge *e = &n->edge.v[i];
        const bool a = tz_net_dangles(n, e->from, l->margin),
                   b = tz_net_dangles(n, e->to, l->margin);
        const int32_t far = tz_net_degree(n, a ? e->to : e->from);
        if (a != b && far >= 3)
            s = tz_array_push(n->ctx, &length, e->length);
        if (tz_net_degree(n, e->from) >= 3 && tz_net_degree(n, e->to) >= 3 &&
            e->from != e->to)
            l->junction = fmin(l->junction, e->length / 2);
    }
    if (s == TZ_OK && length.n > 0) {
        qsort(length.v, (size_t)length.n, sizeof *length.v, up);
        l->branch = length.v[length.n / 10];
        l->least = length.v[0] / 2;
    }
    tz_array_free(n->ctx, &length);
    return s;
}

static tz_status measure_parts(const tz_net *n, tz_finish_limits *l)
{
    double *length = NULL;
    const tz_status s = tz_finish_parts(n, l->margin, &length);
    for (int32_t i = 0; i < n->edge.n && s == TZ_OK; i++)
        l->crumb = fmin(l->crumb, length[n->edge.v[i].part] / 2);
    tz_free(n->ctx, length);
    return s;
}

static tz_status measure_twins(const tz_net *n, tz_finish_limits *l)
{
    double *scratch = NULL;
    tz_status s =
        tz_alloc(n->ctx, &scratch, (size_t)tz_net_most_points(n), sizeof *scratch);
    for (int32_t i = 0; i < n->edge.n && s == TZ_OK; i++) {
        l->twin = fmin(l->twin, tz_net_twin(n, i, 2 * l->twin, NULL, scratch) / 2);
    }
    tz_free(n->ctx, scratch);
    return s;
}

/* What the exemplar's own gaps cost. Of few ends nothing can be told. */
static tz_status measure_gaps(const tz_net *n, tz_finish_limits *l)
{
    tz_finish_costs cost = {0};
    const tz_status s = tz_finish_end_costs(n, l, &cost);
    l->length = n->length;
    if (s == TZ_OK && cost.n >= FEW && n->length > 0) {
        qsort(cost.v, (size_t)cost.n, sizeof *cost.v, up);
        l->gap = cost.v;
        l->gaps = cost.n;
        return TZ_OK;
    }
    tz_array_free(n->ctx, &cost);
    return s;
}

/* Whether more than half of the length is straight. */
static bool mostly_straight(const tz_net *n)
{
    double straight = 0, all = 0;
    for (int32_t i = 0; i < n->set.piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(&n->set, &n->set.piece.v[i]);
        const double length = tz_bezier_length(&b);
        all += length;
        straight += n->set.piece.v[i].straight && length > n->spacing ? length : 0;
    }
    return straight > all / 2;
}

/* How fast lines turn from chord to chord, but for the fastest hundredth. */
static tz_status measure_bend(const tz_net *n, tz_finish_limits *l)
{
    TZ_ARRAY(double)
    turn = {0};
    tz_status s = TZ_OK;
    for (int32_t i = 1; i + 1 < n->point.n && s == TZ_OK; i++) {
        const tz_net_point *p = &n->point.v[i - 1], *q = &n->point.v[i + 1];
        if (p->piece == q->piece && fabs(q->along - p->along) > 0.5 * n->spacing)
            s = tz_array_push(
                n->ctx, &turn,
                acos(fmin(fmax(tz_vec2_dot(p->tangent, q->tangent), -1), 1)) /
                    fabs(q->along - p->along));
    }
    for (int32_t i = 0; i < n->set.node.n && s == TZ_OK; i++) { /* corners */
        if (tz_net_degree(n, i) != 2)
            continue;
        tz_vec2 u[2];
        for (int k = 0; k < 2; k++) {
            const int32_t end = n->end[n->first[i] + k];
            const int32_t at = end & 1 ? n->at[(end >> 1) + 1] - 1 : n->at[end >> 1];
            u[k] = tz_vec2_scale(n->point.v[at].tangent, end & 1 ? -1 : 1);
        }
        s = tz_array_push(n->ctx, &turn,
                          acos(fmin(fmax(-tz_vec2_dot(u[0], u[1]), -1), 1)) /
                              (2 * n->spacing));
    }
    l->bend = INFINITY;
    if (s == TZ_OK && turn.n > 0) {
        qsort(turn.v, (size_t)turn.n, sizeof *turn.v, up);
        l->bend = turn.v[(int32_t)(0.99 * (turn.n - 1))];
    }
    tz_array_free(n->ctx, &turn);
    return s;
}

void tz_finish_limits_deinit(tz_ctx *ctx, tz_finish_limits *l)
{
    tz_free(ctx, l->gap);
    l->gap = NULL;
}

tz_status tz_finish_measure(tz_ctx *ctx, const tz_curve_set *exemplar,
                            tz_finish_limits *out)
{
    const double delta = finest(exemplar);
    const tz_curve_join_params join = join_within(exemplar, delta);
    tz_finish_limits l = {.delta = delta,
                          .margin = MARGIN * delta,
                          .branch = delta,
                          .least = delta / 2,
                          .crumb = delta / 2,
                          .twin = delta / 5,
                          .junction = delta / 4};
    tz_curve_set joined = {.ctx = ctx};
    tz_net n = {.ctx = ctx};
    tz_status s = tz_curve_join(ctx, exemplar, &join, &joined);
    if (s == TZ_OK)
        s = tz_net_init(ctx, &joined, exemplar->pen.n, SPACING * delta, l.margin, &n);
    l.reach = REACH * delta;
    if (s == TZ_OK)
        s = measure_branches(&n, &l);
    if (s == TZ_OK)
        s = measure_parts(&n, &l);
    if (s == TZ_OK)
        s = measure_twins(&n, &l);
    if (s == TZ_OK) {
        l.ends = n.length > 0 ? tz_net_ends(&n, l.margin) / n.length : 0;
        for (int32_t i = 0; i < n.set.node.n; i++)
            l.degrees =
                tz_net_degree(&n, i) > l.degrees ? tz_net_degree(&n, i) : l.degrees;
        l.pieces = n.set.piece.n;
        l.straight = mostly_straight(&n);
        s = measure_bend(&n, &l);
    }
    if (s == TZ_OK)
        s = measure_gaps(&n, &l);
    if (s == TZ_OK)
        *out = l;
    tz_net_deinit(&n);
    tz_curve_set_deinit(&joined);
    return s;
}

/* ---- sets ---------------------------------------------------------------------------- */

/* Appends the paths of a set, pens shifted by `pens`. */
static tz_status append(const tz_curve_set *from, int32_t pens, bool tapers, bool origins,
                        tz_curve_set *to)
{
    const int32_t nodes = to->node.n;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < from->node.n && s == TZ_OK; i++)
        s = tz_array_push(to->ctx, &to->node, from->node.v[i]);
    for (int32_t i = 0; i < from->path.n && s == TZ_OK; i++) {
        const tz_curve_path *p = &from->path.v[i];
        const double width = from->pen.v[p->pen].width;
        s = tz_curve_begin(to, p->pen + pens);
        for (int32_t k = p->piece; k < p->piece + p->pieces && s == TZ_OK; k++) {
            tz_curve_piece c = from->piece.v[k];
            tz_curve_carry carry = tz_curve_carried(from, k);
            c.from += nodes;
            c.to += nodes;
            if (!carry.has_taper)
                carry.taper = (tz_curve_taper){width, width};
            carry.has_taper = tapers;
            carry.has_origin = origins;
            s = tz_curve_add_piece(to, &c, &carry);
        }
        if (s == TZ_OK) {
            tz_curve_end(to, p->closed);
            to->path.v[to->path.n - 1].closed = p->closed;
        }
    }
    return s;
}

/* What is given first, so that of lines drawn twice it is what stays; then the set. The
 * pens of what is given follow those of the set. */
static tz_status put_together(const tz_curve_set *given, const tz_curve_set *set,
                              tz_curve_set *out)
{
    tz_status s = TZ_OK;
    *out = (tz_curve_set){
        .ctx = set->ctx, .domain = set->domain, .element = {.ctx = set->ctx}};
    for (int32_t i = 0; i < set->pen.n && s == TZ_OK; i++)
        s = tz_array_push(set->ctx, &out->pen, set->pen.v[i]);
    for (int32_t i = 0; given && i < given->pen.n && s == TZ_OK; i++)
        s = tz_array_push(set->ctx, &out->pen, given->pen.v[i]);
    if (s == TZ_OK && given)
        s = append(given, set->pen.n, set->taper.n > 0, set->origin.n > 0, out);
    return s == TZ_OK ? append(set, 0, set->taper.n > 0, set->origin.n > 0, out) : s;
}

/* The paths of `from` whose pens are the set's, into the set, crossing where they merely
 * crossed; all else in it stays. */
static tz_status take_over(const tz_curve_set *from, double delta, tz_curve_set *set)
{
    tz_curve_set out = {.ctx = set->ctx, .domain = set->domain};
    tz_curve_set own = {.ctx = set->ctx, .domain = set->domain};
    bool *gone = NULL;
    tz_status s = tz_alloc_zero(set->ctx, &gone, (size_t)from->piece.n, sizeof *gone);
    for (int32_t i = 0; i < from->path.n && s == TZ_OK; i++)
        for (int32_t k = 0; k < from->path.v[i].pieces; k++)
            gone[from->path.v[i].piece + k] = from->path.v[i].pen >= set->pen.n;
    for (int32_t i = 0; i < from->node.n && s == TZ_OK; i++)
        s = tz_array_push(set->ctx, &out.node, from->node.v[i]);
    if (s == TZ_OK)
        s = tz_curve_chain(set->ctx, from, gone, false, &out);
    tz_free(set->ctx, gone);
    if (s == TZ_OK)
        s = tz_finish_release(set, JOIN * delta, SAME * delta, &out);
    if (s == TZ_OK) {
        own = *set;
        set->node.v = out.node.v, set->node.n = out.node.n, set->node.cap = out.node.cap;
        set->piece.v = out.piece.v, set->piece.n = out.piece.n;
        set->piece.cap = out.piece.cap;
        set->path.v = out.path.v, set->path.n = out.path.n, set->path.cap = out.path.cap;
        set->taper.v = out.taper.v, set->taper.n = out.taper.n;
        set->taper.cap = out.taper.cap;
        set->origin.v = out.origin.v, set->origin.n = out.origin.n;
        set->origin.cap = out.origin.cap;
        out.node.v = own.node.v, out.piece.v = own.piece.v, out.path.v = own.path.v;
        out.taper.v = own.taper.v, out.origin.v = own.origin.v;
    }
    tz_curve_set_deinit(&out);
    return s;
}

/* ---- rounds -------------------------------------------------------------------------- */

typedef struct finishing {
    tz_ctx *ctx;
    tz_finish_limits limit;
    int32_t pens;          /* of the set; those behind are given */
    tz_curve_set now;      /* the set, joined; or else */
    tz_net net;            /* as a net */
    bool is_net, is_clean; /* is_clean: there was nothing to clean in this net */
    tz_curve_finish_report report;
    bool changed;
    bool left; /* there were still too many ends as the last round began */
} finishing;

/* What has been added may touch something. Takes the set. */
static tz_status rejoin(tz_curve_set *out, double delta, tz_curve_set *now)
{
    const tz_curve_join_params join = join_within(out, delta);
    const tz_status s = tz_curve_join(out->ctx, out, &join, now);
    now->ctx = out->ctx;
    tz_curve_set_deinit(out);
    return s;
}

/* How many ends there may be: of a pattern of ends a few more are chance. */
static double most_ends(const tz_finish_limits *l, double length)
{
    return floor(l->ends * length * (!l->gap ? 1 : CHANCE) + 0.5);
}

/* What a round does. */
typedef enum stage { MEND, PAIR, DROP } stage;

static tz_status do_stage(finishing *f, stage what, double by, int32_t through,
                          tz_net_edit *e)
{
    const double most = most_ends(&f->limit, e->net->length);
    tz_status s = TZ_OK;
    switch (what) {
    case MEND:
        s = f->is_clean ? TZ_OK : tz_finish_clean(e, &f->limit);
        return s == TZ_OK ? tz_finish_ends(e, &f->limit, most) : s;
    case PAIR: return tz_finish_pairs(e, &f->limit, by, through, most);
    default: return tz_finish_drop(e, &f->limit, by, most);
    }
}

static tz_status make_net(finishing *f)
{
    if (f->is_net)
        return TZ_OK;
    const tz_status s = tz_net_init(f->ctx, &f->now, f->pens, SPACING * f->limit.delta,
                                    f->limit.margin, &f->net);
    f->is_net = true; /* also where it failed: it is to be freed */
    return s;
}

/* The net, edited, becomes a set again; touching: what was added may touch or cross
 * something. */
static tz_status take_edit(finishing *f, bool touching, tz_net_edit *e)
{
    tz_curve_set out = {.ctx = f->ctx};
    f->report.closed += e->closed;
    f->report.removed += e->removed;
    f->changed = true;
    tz_status s = tz_net_edit_apply(e, &out);
    if (s == TZ_OK && touching)
        s = rejoin(&out, f->limit.delta, &f->now);
    else if (s == TZ_OK)
        f->now = out;
    if (s == TZ_OK) {
        tz_net_deinit(&f->net);
        f->is_net = f->is_clean = false;
    }
    return s;
}

/* One round; `again` where something has been done. */
static tz_status finish_round(finishing *f, stage what, double by, int32_t through,
                              bool *again)
{
    tz_net_edit e = {.net = &f->net};
    tz_status s = make_net(f);
    *again = false;
    if (s == TZ_OK)
        s = tz_net_edit_init(&f->net, &e);
    if (s == TZ_OK) {
        f->report.ends[1] = tz_net_ends(&f->net, f->limit.margin);
        if (f->report.ends[0] < 0)
            f->report.ends[0] = f->report.ends[1];
        f->left = f->report.ends[1] > most_ends(&f->limit, f->net.length);
        s = do_stage(f, what, by, through, &e);
    }
    *again = s == TZ_OK && e.closed + e.removed > 0;
    if (*again)
        s = take_edit(f, what == MEND && e.closed > 0, &e);
    else if (s == TZ_OK)
        f->is_clean = f->is_clean || what == MEND;
    tz_net_edit_deinit(&e);
    return s;
}

/* Gaps and stubs, until there are none. */
static tz_status mend(finishing *f)
{
    const double reach = f->limit.reach, branch = f->limit.branch;
    bool again = true;
    tz_status s = TZ_OK;
    for (int k = 0; k < ROUNDS && s == TZ_OK && again; k++) {
        s = finish_round(f, MEND, 0, 0, &again);
        /* where no end is right, the last of them are worth a longer way */
        if (!again && !f->limit.gap && k + 1 < ROUNDS && f->limit.reach < 3 * reach &&
            f->left) {
            f->limit.reach *= GROWTH;
            f->limit.branch = fmin(f->limit.branch * GROWTH, 2 * branch);
            again = true;
        }
    }
    return s;
}

/* Ends that are left where hardly any are right: paired at ever longer ways, then across
 * lines, then away with their lines. */
static tz_status end_all(finishing *f)
{
    static const struct {
        stage what;
        double by; /* of delta, or a share */
        int32_t through;
        bool curved; /* not for drawings of straight lines */
    } plan[] = {
        {PAIR, 1.5, 0, true}, {PAIR, 3, 0, true},     {PAIR, 2, 1, true},
        {PAIR, 3, 2, true},   {PAIR, 3, 3, true},     {PAIR, 4, 6, true},
        {PAIR, 6, 6, true},   {PAIR, 8, 6, true},     {DROP, 0.01, 0, false},
        {PAIR, 10, 6, true},  {DROP, 0.01, 0, false},
    };
    tz_status s = TZ_OK;
    for (size_t k = 0; k < sizeof plan / sizeof *plan && s == TZ_OK && f->left; k++) {
        bool again = false;
        if (plan[k].curved && f->limit.straight)
            continue;
        s = finish_round(f, plan[k].what,
                         plan[k].by * (plan[k].what == DROP ? 1 : f->limit.delta),
                         plan[k].through, &again);
    }
    return s;
}

/* Ends as they are now; the net becomes a set. */
static tz_status settle(finishing *f)
{
    const tz_status s = make_net(f);
    if (s == TZ_OK) {
        f->report.ends[1] = tz_net_ends(&f->net, f->limit.margin);
        f->now = f->net.set;
        f->net.set = (tz_curve_set){.ctx = f->ctx};
    }
    return s;
}

struct tz_curve_finish_measure {
    tz_ctx *ctx;
    tz_finish_limits limit;
};

tz_status tz_curve_finish_measure_new(tz_ctx *ctx, const tz_curve_set *exemplar,
                                      tz_curve_finish_measure **out)
{
    tz_curve_finish_measure *m = NULL;
    *out = NULL;
    tz_status s = tz_alloc_zero(ctx, &m, 1, sizeof *m);
    if (s != TZ_OK)
        return s;
    m->ctx = ctx;
    if (exemplar->path.n > 0)
        s = tz_finish_measure(ctx, exemplar, &m->limit);
    if (s == TZ_OK)
        *out = m;
    else
        tz_curve_finish_measure_free(m);
    return s;
}

void tz_curve_finish_measure_free(tz_curve_finish_measure *m)
{
    if (!m)
        return;
    tz_finish_limits_deinit(m->ctx, &m->limit);
    tz_free(m->ctx, m);
}

int32_t tz_curve_finish_measure_pieces(const tz_curve_finish_measure *m)
{
    return m->limit.pieces;
}

tz_status tz_curve_finish_like(tz_ctx *ctx, const tz_curve_finish_measure *m,
                               const tz_curve_set *given, tz_curve_set *set,
                               tz_curve_finish_report *report)
{
    finishing f = {.ctx = ctx, .pens = set->pen.n, .limit = m->limit};
    tz_curve_set all = {.ctx = ctx};
    if (report)
        memset(report, 0, sizeof *report);
    if (set->path.n == 0 || m->limit.pieces == 0)
        return TZ_OK;
    tz_status s = put_together(given, set, &all);
    const tz_curve_join_params join = join_within(set, f.limit.delta);
    if (s == TZ_OK)
        s = tz_curve_join(ctx, &all, &join, &f.now);
    f.now.ctx = ctx;
    f.report.ends[0] = -1;
    if (s == TZ_OK)
        s = mend(&f);
    if (s == TZ_OK && f.left && !f.limit.gap)
        s = end_all(&f);
    if (s == TZ_OK && f.changed)
        s = settle(&f);
    if (s == TZ_OK && f.changed)
        s = take_over(&f.now, f.limit.delta, set);
    if (s == TZ_OK && report)
        *report = f.report;
    tz_curve_set_deinit(&all);
    tz_curve_set_deinit(&f.now);
    if (f.is_net)
        tz_net_deinit(&f.net);
    return s;
}

tz_status tz_curve_finish(tz_ctx *ctx, const tz_curve_set *exemplar,
                          const tz_curve_set *given, tz_curve_set *set,
                          tz_curve_finish_report *report)
{
    tz_curve_finish_measure *m = NULL;
    if (report)
        memset(report, 0, sizeof *report);
    if (set->path.n == 0 || exemplar->path.n == 0)
        return TZ_OK;
    tz_status s = tz_curve_finish_measure_new(ctx, exemplar, &m);
    if (s == TZ_OK)
        s = tz_curve_finish_like(ctx, m, given, set, report);
    tz_curve_finish_measure_free(m);
    return s;
}
