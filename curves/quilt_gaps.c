/* SPDX-License-Identifier: Apache-2.0 */
/* Things laid into gaps. Distances of cells to the next line (chamfer 3 4) have their peaks
 * in the middle of gaps. At each, the widest first, the longest thing is laid that fits and
 * was not laid far more often than others: its outline, shrunk to its centre in steps, comes nowhere
 * nearer to a line than `gap`. Rounds begin anew with what they have laid, the gap first
 * the one that things of the exemplar usually keep, then less. */
#include <stdlib.h>
#include <string.h>

#include "curves/quilt_internal.h"

enum {
    SHRINKS = 5,  /* copies of an outline, to its centre */
    ROUNDS = 4,   /* gap by gap */
    PEAKS = 4096, /* looked at in a round */
    DABS = 192,   /* of an outline, at most */
    STEP = 3,     /* distance to the next cell */
    FAR = 1 << 28
};

typedef struct shape {
    int32_t dab, dabs; /* outline, from the centre */
    int32_t kind;      /* copies around a torus are of one kind */
    double radius, length;
    bool loose; /* a line of it ends, and finishing might lead that on */
} shape;

typedef struct peak {
    int32_t far, at;
} peak;

typedef struct gaps {
    tz_ctx *ctx;
    const quilt_source *s;
    quilt_map *m;
    quilt_runs *r;
    shape *shape; /* per object */
    TZ_ARRAY(tz_vec2)
    dab;
    int32_t *laid; /* per kind, which is an object */
    int32_t *far;  /* per cell */
    TZ_ARRAY(peak)
    peak;
    double owed;
} gaps;

/* ---- shapes ------------------------------------------------------------------------- */

static tz_status outline(gaps *g, int32_t object, double step)
{
    const tz_curve_set *set = g->s->set;
    shape *h = &g->shape[object];
    tz_status st = TZ_OK;
    h->dab = g->dab.n;
    for (int32_t i = 0; i < set->path.n && st == TZ_OK; i++) {
        const tz_curve_path *p = &set->path.v[i];
        if (g->s->object[i] != object)
            continue;
        for (int32_t k = p->piece; k < p->piece + p->pieces && st == TZ_OK; k++) {
            const tz_bezier b = tz_curve_bezier(set, &set->piece.v[k]);
            const double length = tz_bezier_length(&b),
                         n = fmin(ceil(length / step), DABS);
            h->length += length;
            h->loose = h->loose || g->s->degree[set->piece.v[k].from] == 1 ||
                       g->s->degree[set->piece.v[k].to] == 1;
            for (int32_t j = 0; j <= n && st == TZ_OK; j++) {
                const tz_vec2 v =
                    tz_vec2_sub(tz_bezier_at(&b, j / fmax(n, 1)), g->s->centre[object]);
                h->radius = fmax(h->radius, tz_vec2_length(v));
                st = tz_array_push(g->ctx, &g->dab, v);
            }
        }
    }
    h->dabs = g->dab.n - h->dab;
    return st;
}

/* Whether a thing is one of the period that others are copies of. */
static bool is_first(const quilt_source *s, int32_t object)
{
    const tz_vec3 size = s->original->domain.size;
    const tz_vec2 v = tz_vec2_sub(s->centre[object], s->lo);
    return !s->original->domain.torus ||
           (v.x >= 0 && v.y >= 0 && v.x < size.x && v.y < size.y);
}

/* Those that are copies of one thing around a torus are of its kind. */
static void find_kinds(gaps *g)
{
    const tz_vec3 size = g->s->original->domain.size;
    for (int32_t i = 0; i < g->s->objects; i++) {
        g->shape[i].kind = i;
        for (int32_t j = 0; j < g->s->objects && !is_first(g->s, i); j++) {
            const tz_vec2 v = tz_vec2_sub(g->s->centre[i], g->s->centre[j]);
            const double x = v.x - size.x * round(v.x / size.x),
                         y = v.y - size.y * round(v.y / size.y);
            if (hypot(x, y) < 1e-3 * g->s->cell && is_first(g->s, j)) {
                g->shape[i].kind = j;
                break;
            }
        }
    }
}

/* ---- distances ---------------------------------------------------------------------- */

static ptrdiff_t cell_of(const quilt_map *m, tz_vec2 p)
{
    if (m->domain->torus)
        p = (tz_vec2){tz_domain_wrap_axis(p.x, m->domain->size.x),
                      tz_domain_wrap_axis(p.y, m->domain->size.y)};
    const double x = floor(p.x / m->cx), y = floor(p.y / m->cy);
    return x >= 0 && y >= 0 && x < m->nx && y < m->ny
               ? (ptrdiff_t)y * m->nx + (ptrdiff_t)x
               : -1;
}

/* Cells of a line; of a thing also those within it. */
static void mark_run(gaps *g, const quilt_run *r)
{
    const quilt_patch *p = &g->m->patch.v[r->patch];
    const int32_t o = g->s->object[r->path];
    const tz_vec2 mid = o >= 0 ? g->s->centre[o] : (tz_vec2){0, 0};
    const int shrinks =
        o >= 0 ? (int)fmin(64, ceil(g->shape[o].radius / g->m->cx) + 1) : 1;
    for (int32_t k = r->part; k < r->part + r->parts; k++) {
        const quilt_part *part = &g->r->part.v[k];
        const tz_bezier whole =
            tz_curve_bezier(g->s->set, &g->s->set->piece.v[part->piece]);
        const tz_bezier b = tz_bezier_part(&whole, part->t0, part->t1);
        const double n = fmin(ceil(tz_bezier_length(&b) / (g->m->cx / 2)), 1 << 14);
        for (int32_t j = 0; j <= n; j++) {
            const tz_vec2 v = tz_vec2_sub(tz_bezier_at(&b, j / fmax(n, 1)), mid);
            for (int i = 0; i < shrinks; i++) {
                const tz_vec2 x =
                    tz_vec2_add(mid, tz_vec2_scale(v, 1 - (double)i / shrinks));
                const ptrdiff_t at = cell_of(g->m, quilt_place_at(p, x));
                if (at >= 0)
                    g->far[at] = 0;
            }
        }
    }
}

static void lower(gaps *g, ptrdiff_t at, int32_t x, int32_t y, int32_t by)
{
    const quilt_map *m = g->m;
    if (m->domain->torus) {
        x = (x + m->nx) % m->nx;
        y = (y + m->ny) % m->ny;
    } else if (x < 0 || y < 0 || x >= m->nx || y >= m->ny) {
        return;
    }
    const int32_t d = g->far[(ptrdiff_t)y * m->nx + x] + by;
    if (d < g->far[at])
        g->far[at] = d;
}

/* Two sweeps; around a torus twice. */
static void find_distances(gaps *g)
{
    const quilt_map *m = g->m;
    for (ptrdiff_t i = 0; i < (ptrdiff_t)m->nx * m->ny; i++)
        g->far[i] = m->label[i] >= 0 ? FAR : 0;
    for (int32_t i = 0; i < g->r->run.n; i++)
        if (!g->r->run.v[i].gone)
            mark_run(g, &g->r->run.v[i]);
    for (int k = 0; k < (m->domain->torus ? 4 : 2); k++)
        for (int32_t v = 0; v < m->ny; v++)
            for (int32_t u = 0; u < m->nx; u++) {
                const int32_t x = k % 2 ? m->nx - 1 - u : u,
                              y = k % 2 ? m->ny - 1 - v : v, d = k % 2 ? 1 : -1;
                const ptrdiff_t at = (ptrdiff_t)y * m->nx + x;
                lower(g, at, x + d, y, 3);
                lower(g, at, x - 1, y + d, 4);
                lower(g, at, x, y + d, 3);
                lower(g, at, x + 1, y + d, 4);
            }
}

static int by_far(const void *a, const void *b)
{
    const peak *p = a, *q = b;
    if (p->far != q->far)
        return p->far > q->far ? -1 : 1;
    return (p->at > q->at) - (p->at < q->at);
}

/* Cells from which it is nowhere farther beside them. */
static tz_status find_peaks(gaps *g, int32_t least)
{
    const quilt_map *m = g->m;
    tz_status st = TZ_OK;
    g->peak.n = 0;
    for (int32_t y = 0; y < m->ny && st == TZ_OK; y++)
        for (int32_t x = 0; x < m->nx && st == TZ_OK; x++) {
            const int32_t at = y * m->nx + x, d = g->far[at];
            bool top = d >= least && d < FAR;
            for (int k = 0; k < 9 && top; k++) {
                const int32_t u = x + k % 3 - 1, v = y + k / 3 - 1;
                if (u >= 0 && v >= 0 && u < m->nx && v < m->ny)
                    top = g->far[v * m->nx + u] <= d;
            }
            if (top)
                st = tz_array_push(g->ctx, &g->peak, ((peak){d, at}));
        }
    if (g->peak.n > 1)
        qsort(g->peak.v, (size_t)g->peak.n, sizeof *g->peak.v, by_far);
    if (g->peak.n > PEAKS)
        g->peak.n = PEAKS;
    return st;
}

/* ---- laying ------------------------------------------------------------------------- */

/* Whether a thing comes nowhere nearer to a line than `least`, outside of what is laid
 * everything is free. Places of the thing in the domain count. */
static bool fits(const gaps *g, const quilt_patch *p, int32_t object, int32_t least)
{
    const shape *h = &g->shape[object];
    for (int k = 0; k < SHRINKS; k++)
        for (int32_t i = 0; i < h->dabs; i++) {
            const tz_vec2 v =
                tz_vec2_scale(g->dab.v[h->dab + i], 1 - (double)k / SHRINKS);
            const ptrdiff_t at = cell_of(g->m, tz_vec2_add(p->to, quilt_turn(p, v)));
            if (at >= 0 && g->far[at] < least)
                return false;
        }
    return true;
}

/* The longest of those that fit and were not laid far more often than others; else of all
 * that fit. Of loops none with an end that finishing might lead on. */
static int32_t choose(const gaps *g, quilt_patch *p, int32_t least)
{
    int32_t best = -1, laid = 0, kinds = 0;
    for (int32_t i = 0; i < g->s->objects; i++) {
        laid += g->laid[i];
        kinds += is_first(g->s, i);
    }
    const int32_t often = 2 * laid / (kinds > 0 ? kinds : 1) + 1;
    for (int32_t i = 0; i < g->s->objects; i++) {
        const shape *h = &g->shape[i];
        if (!is_first(g->s, i) || h->dabs == 0 || h->length > 2 * g->owed)
            continue;
        if (h->loose && g->s->loops)
            continue;
        if (best >= 0) {
            const shape *b = &g->shape[best];
            const bool much = g->laid[i] > often, most = g->laid[best] > often;
            if (much != most ? much : h->length <= b->length)
                continue;
        }
        if (fits(g, p, i, least))
            best = i;
    }
    return best;
}

static tz_status lay(gaps *g, const quilt_patch *p, int32_t object)
{
    const int32_t patch = g->m->patch.n, first = g->r->run.n;
    tz_status st = tz_array_push(g->ctx, &g->m->patch, *p);
    if (st == TZ_OK)
        st = quilt_cut_thing(g->ctx, g->s, g->m, g->r, patch, object);
    for (int32_t i = first; i < g->r->run.n; i++) {
        const quilt_run *r = &g->r->run.v[i];
        for (int32_t k = r->part; k < r->part + r->parts; k++) {
            const quilt_part *part = &g->r->part.v[k];
            const tz_bezier b =
                tz_curve_bezier(g->s->set, &g->s->set->piece.v[part->piece]);
            const tz_bezier c = tz_bezier_part(&b, part->t0, part->t1);
            g->owed -= tz_bezier_length(&c);
        }
    }
    g->laid[g->shape[object].kind]++;
    return st;
}

/* One thing to a gap: those that come too near to another of this round wait. */
static tz_status lay_round(gaps *g, double gap)
{
    TZ_ARRAY(tz_vec3)
    now = {0};
    const quilt_map *m = g->m;
    const int32_t least = (int32_t)ceil(STEP * gap / fmax(m->cx, m->cy));
    find_distances(g);
    tz_status st = find_peaks(g, least);
    for (int32_t i = 0; i < g->peak.n && g->owed > 0 && st == TZ_OK; i++) {
        const int32_t at = g->peak.v[i].at;
        const tz_vec2 to = {(at % m->nx + 0.5) * m->cx, (at / m->nx + 0.5) * m->cy};
        const double angle = tz_domain_frame(m->domain, (tz_vec3){to.x, to.y, 0});
        quilt_patch p = {.to = to, .angle = angle, .c = cos(angle), .s = sin(angle)};
        const int32_t object = choose(g, &p, least);
        bool near = object < 0;
        for (int32_t k = 0; k < now.n && !near; k++) {
            const tz_vec3 v = tz_domain_vector(m->domain, (tz_vec3){to.x, to.y, 0},
                                               (tz_vec3){now.v[k].x, now.v[k].y, 0});
            near = hypot(v.x, v.y) < now.v[k].z + g->shape[object].radius + gap;
        }
        if (near)
            continue;
        p.from = g->s->centre[object];
        st = lay(g, &p, object);
        if (st == TZ_OK)
            st = tz_array_push(g->ctx, &now,
                               ((tz_vec3){to.x, to.y, g->shape[object].radius}));
        if (tz_ctx_cancelled(g->ctx))
            st = TZ_CANCELLED;
    }
    tz_array_free(g->ctx, &now);
    return st;
}

/* A thing of many paths counts by the first of its own. */
static tz_status count_laid(gaps *g)
{
    int32_t *first = NULL;
    const tz_status st = tz_alloc(g->ctx, &first, (size_t)g->s->objects, sizeof *first);
    if (st != TZ_OK)
        return st;
    for (int32_t i = g->s->set->path.n; i-- > 0;)
        if (g->s->object[i] >= 0)
            first[g->s->object[i]] = i;
    for (int32_t i = 0; i < g->r->run.n; i++) {
        const int32_t o = g->s->object[g->r->run.v[i].path];
        if (o >= 0 && !g->r->run.v[i].gone && g->r->run.v[i].path == first[o])
            g->laid[g->shape[o].kind]++;
    }
    tz_free(g->ctx, first);
    return TZ_OK;
}

tz_status quilt_fill_gaps(tz_ctx *ctx, const quilt_source *s, quilt_map *m, quilt_runs *r,
                          double length)
{
    gaps g = {.ctx = ctx, .s = s, .m = m, .r = r, .owed = length};
    const size_t cells = (size_t)m->nx * (size_t)m->ny;
    tz_status st = tz_alloc_zero(ctx, &g.shape, (size_t)s->objects, sizeof *g.shape);
    if (st == TZ_OK)
        st = tz_alloc_zero(ctx, &g.laid, (size_t)s->objects, sizeof *g.laid);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &g.far, cells, sizeof *g.far);
    for (int32_t i = 0; i < s->objects && st == TZ_OK; i++)
        st = outline(&g, i, s->cell / 2);
    if (st == TZ_OK) {
        find_kinds(&g);
        st = count_laid(&g);
    }
    for (int k = 0; k < 2 * ROUNDS && g.owed > 0 && st == TZ_OK; k++)
        st = lay_round(&g, s->cell * (ROUNDS + 1 - k / 2.0));
    tz_free(ctx, g.shape);
    tz_free(ctx, g.laid);
    tz_free(ctx, g.far);
    tz_array_free(ctx, &g.dab);
    tz_array_free(ctx, &g.peak);
    return st;
}
