/* SPDX-License-Identifier: Apache-2.0 */
/* Curves of each patch, as far as they run through its cells. A node belongs to a patch or
 * not by its place alone, so that pieces that share it agree. Between nodes a piece is
 * looked at every half cell, and where the label changes it is bisected. */
#include <string.h>

#include "curves/quilt_internal.h"

typedef struct cutting {
    tz_ctx *ctx;
    const quilt_source *s;
    const quilt_map *m;
    quilt_runs *r;
    const quilt_patch *p;
    int32_t patch;
    tz_vec2 lo, hi; /* window, in the exemplar */
    bool open;      /* the last run goes on */
    bool whole;     /* a thing: only the domain's border cuts it */
} cutting;

static bool inside(const cutting *c, tz_vec2 x)
{
    const int32_t label = quilt_label(c->m, quilt_place_at(c->p, x));
    return c->whole ? label != QUILT_OUTSIDE : label == c->patch;
}

/* Whether the patch lays a thing: it has the cell at its centre, or, for loops
 * that hang into a plain domain, that which is nearest. */
static bool owns(const cutting *c, int32_t thing)
{
    const tz_domain *d = c->m->domain;
    tz_vec2 p = quilt_place_at(c->p, c->s->centre[thing]);
    if (!d->torus && c->s->loops && quilt_is_whole(c->s, thing))
        p = (tz_vec2){fmin(fmax(p.x, 0), d->size.x), fmin(fmax(p.y, 0), d->size.y)};
    return quilt_label(c->m, p) == c->patch;
}

static bool reaches(const cutting *c, int32_t piece)
{
    const tz_vec2 lo = c->s->box[2 * (ptrdiff_t)piece],
                  hi = c->s->box[2 * (ptrdiff_t)piece + 1];
    return c->whole ||
           (lo.x <= c->hi.x && lo.y <= c->hi.y && hi.x >= c->lo.x && hi.y >= c->lo.y);
}

static tz_status add_cut(cutting *c, const tz_bezier *b, int32_t piece, double t,
                         int side)
{
    const tz_vec2 d = quilt_turn(c->p, tz_bezier_slope(b, t));
    const double n = tz_vec2_length(d), k = (side ? 1 : -1) / fmax(n, 1e-300);
    quilt_runs *r = c->r;
    const int32_t pen = c->s->set->path.v[r->run.v[r->run.n - 1].path].pen;
    const double beyond = side ? fmin(1, t + 1e-6) : fmax(0, t - 1e-6);
    const quilt_cut cut = {
        .at = quilt_place_at(c->p, tz_bezier_at(b, t)),
        .out = {d.x * k, d.y * k},
        .run = r->run.n - 1,
        .side = side,
        .patch = c->patch,
        .other = quilt_label(c->m, quilt_place_at(c->p, tz_bezier_at(b, beyond))),
        .pen = pen,
        .width = c->s->set->taper.n ? quilt_width_at(c->s, piece, t)
                                    : c->s->set->pen.v[pen].width,
        .mate = -1};
    r->run.v[r->run.n - 1].cut[side] = r->cut.n;
    return tz_array_push(c->ctx, &r->cut, cut);
}

static tz_status begin_run(cutting *c, int32_t path)
{
    c->open = true;
    return tz_array_push(
        c->ctx, &c->r->run,
        ((quilt_run){
            .patch = c->patch, .path = path, .part = c->r->part.n, .cut = {-1, -1}}));
}

static tz_status add_part(cutting *c, int32_t piece, double t0, double t1)
{
    c->r->run.v[c->r->run.n - 1].parts++;
    return tz_array_push(c->ctx, &c->r->part, ((quilt_part){piece, t0, t1}));
}

/* Where the label changes between t0 (of one kind) and t1 (of the other): the side of
 * which is wanted. */
static double change(const cutting *c, const tz_bezier *b, double in, double out)
{
    for (int k = 0; k < 30; k++) {
        const double t = (in + out) / 2;
        if (inside(c, tz_bezier_at(b, t)))
            in = t;
        else
            out = t;
    }
    return in;
}

static tz_status walk_piece(cutting *c, int32_t path, int32_t piece)
{
    enum { MOST = 1 << 14 };
    const tz_curve_set *set = c->s->set;
    const tz_bezier b = tz_curve_bezier(set, &set->piece.v[piece]);
    const int32_t n =
        (int32_t)fmin(ceil(tz_bezier_length(&b) / (c->m->cx / 2)) + 1, MOST);
    bool in = inside(c, b.p[0]);
    double from = 0;
    tz_status st = TZ_OK;
    if (in && !c->open)
        st = begin_run(c, path);
    else if (!in)
        c->open = false;
    for (int32_t i = 1; i <= n && st == TZ_OK; i++) {
        const double t = (double)i / n, before = (i - 1.0) / n;
        const bool now = inside(c, i == n ? b.p[3] : tz_bezier_at(&b, t));
        if (now == in)
            continue;
        if (now) {
            from = change(c, &b, t, before);
            st = begin_run(c, path);
            if (st == TZ_OK)
                st = add_cut(c, &b, piece, from, 0);
        } else {
            const double to = change(c, &b, before, t);
            st = add_part(c, piece, from, to);
            if (st == TZ_OK)
                st = add_cut(c, &b, piece, to, 1);
            c->open = false;
        }
        in = now;
    }
    if (in && st == TZ_OK)
        st = add_part(c, piece, from, 1);
    return st;
}

/* Runs of a path; of a closed one from a node that lies outside, if there is one. */
static tz_status walk_path(cutting *c, int32_t path)
{
    const tz_curve_path *p = &c->s->set->path.v[path];
    const int32_t runs = c->r->run.n, cuts = c->r->cut.n;
    int32_t first = 0;
    bool any = false;
    for (int32_t k = 0; k < p->pieces && !any; k++)
        any = reaches(c, p->piece + k);
    if (!any)
        return TZ_OK;
    if (p->closed)
        for (int32_t k = 0; k < p->pieces; k++) {
            const int32_t node = c->s->set->piece.v[p->piece + k].from;
            if (!inside(c, c->s->set->node.v[node])) {
                first = k;
                break;
            }
        }
    tz_status st = TZ_OK;
    c->open = false;
    for (int32_t k = 0; k < p->pieces && st == TZ_OK; k++) {
        const int32_t piece = p->piece + (first + k) % p->pieces;
        if (reaches(c, piece))
            st = walk_piece(c, path, piece);
        else
            c->open = false;
    }
    if (st == TZ_OK && p->closed && c->r->run.n == runs + 1 && c->r->cut.n == cuts &&
        c->r->run.v[runs].parts == p->pieces)
        c->r->run.v[runs].closed = true;
    return st;
}

static tz_status cut_patch(cutting *c)
{
    const double rim = 4 * c->s->coarse;
    const tz_curve_set *set = c->s->set;
    tz_status st = TZ_OK;
    c->lo =
        (tz_vec2){c->p->from.x - c->p->half.x - rim, c->p->from.y - c->p->half.y - rim};
    c->hi =
        (tz_vec2){c->p->from.x + c->p->half.x + rim, c->p->from.y + c->p->half.y + rim};
    for (int32_t i = 0; i < set->path.n && st == TZ_OK; i++) {
        const int32_t thing = c->s->object[i];
        c->whole = false;
        if (thing == QUILT_REST || (thing >= 0 && !owns(c, thing)))
            continue;
        c->whole = thing >= 0;
        st = walk_path(c, i);
    }
    return st;
}

tz_status quilt_cut_thing(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                          quilt_runs *r, int32_t patch, int32_t object)
{
    cutting c = {.ctx = ctx,
                 .s = s,
                 .m = m,
                 .r = r,
                 .p = &m->patch.v[patch],
                 .patch = patch,
                 .whole = true};
    tz_status st = TZ_OK;
    for (int32_t i = 0; i < s->set->path.n && st == TZ_OK; i++)
        if (s->object[i] == object)
            st = walk_path(&c, i);
    return st;
}

/* Label of the nearest place within two cells that is not given; QUILT_GIVEN = none. */
static int32_t beside_given(const quilt_map *m, tz_vec2 p)
{
    for (int r = 1; r <= 2; r++)
        for (int k = 0; k < 8; k++) {
            const tz_vec2 q = {p.x + r * m->cx * cos(k * TZ_PI / 4),
                               p.y + r * m->cy * sin(k * TZ_PI / 4)};
            const int32_t label = quilt_label(m, q);
            if (label >= 0)
                return label;
        }
    return QUILT_GIVEN;
}

/* Ends of given paths beside what is laid: they wait for a line that meets them. */
static tz_status cut_given(tz_ctx *ctx, const quilt_map *m, quilt_runs *r)
{
    const tz_curve_set *g = m->given;
    tz_status st = TZ_OK;
    for (int32_t i = 0; g && i < g->path.n && st == TZ_OK; i++)
        for (int side = 0; side < 2 && !g->path.v[i].closed && st == TZ_OK; side++) {
            const tz_curve_path *p = &g->path.v[i];
            const tz_bezier b = tz_curve_bezier(
                g, &g->piece.v[side ? p->piece + p->pieces - 1 : p->piece]);
            const tz_vec2 d = tz_bezier_slope(&b, side ? 1 - 1e-6 : 1e-6),
                          at = side ? b.p[3] : b.p[0];
            const double n = tz_vec2_length(d), k = (side ? 1 : -1) / fmax(n, 1e-300);
            const int32_t other = beside_given(m, at);
            if (other < 0 || !(n > 0))
                continue;
            st = tz_array_push(ctx, &r->cut,
                               ((quilt_cut){.at = at,
                                            .out = {d.x * k, d.y * k},
                                            .run = -1,
                                            .side = side,
                                            .patch = QUILT_GIVEN,
                                            .other = other,
                                            .pen = p->pen,
                                            .mate = -1,
                                            .fixed = true}));
        }
    return st;
}

tz_status quilt_cut_runs(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                         quilt_runs *r)
{
    cutting c = {.ctx = ctx, .s = s, .m = m, .r = r};
    tz_status st = TZ_OK;
    for (int32_t i = 0; i < m->patch.n && st == TZ_OK; i++) {
        c.p = &m->patch.v[i];
        c.patch = i;
        if (c.p->half.x > 0)
            st = cut_patch(&c);
        if (tz_ctx_cancelled(ctx))
            st = TZ_CANCELLED;
    }
    return st == TZ_OK ? cut_given(ctx, m, r) : st;
}

void quilt_runs_deinit(quilt_runs *r)
{
    tz_array_free(r->ctx, &r->part);
    tz_array_free(r->ctx, &r->run);
    tz_array_free(r->ctx, &r->cut);
}
