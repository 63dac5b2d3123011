/* SPDX-License-Identifier: Apache-2.0 */
/* Models of the palette's things, and bodies: their discs in the world. */
#include <stdlib.h>
#include <string.h>

#include "fields/fill_internal.h"

#define MOST_SHARE 1e12
#define MOST_SIZE  1e12

/* ---- models ------------------------------------------------------------------------- */

void tz_fill_model_deinit(tz_ctx *ctx, tz_fill_model *m)
{
    tz_disc_cover_deinit(&m->cover);
    tz_free(ctx, m->border);
    tz_free(ctx, m->sample);
    *m = (tz_fill_model){0};
}

/* Inverse of 1 + 2 w_g L by Gauss-Jordan: symmetric, positive, at most 16 rows. */
static void invert_graph(tz_fill_model *m)
{
    enum { N = TZ_COVER_DISCS };
    double a[N][2 * N] = {{0}};
    const int n = m->n;
    for (int i = 0; i < n; i++) {
        a[i][i] = 1, a[i][n + i] = 1;
        for (int32_t k = m->start[i]; k < m->start[i + 1]; k++) {
            a[i][i] += 2 * TZ_FILL_GRAPH;
            a[i][m->near[k]] -= 2 * TZ_FILL_GRAPH;
        }
    }
    for (int i = 0; i < n; i++) {
        const double p = 1 / a[i][i];
        for (int k = 0; k < 2 * n; k++)
            a[i][k] *= p;
        for (int j = 0; j < n; j++) {
            const double q = a[j][i];
            for (int k = 0; k < 2 * n && j != i; k++)
                a[j][k] -= q * a[i][k];
        }
    }
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++)
            m->inverse[i * n + k] = a[i][n + k];
}

static void take_graph(tz_fill_model *m)
{
    const tz_disc_cover *c = &m->cover;
    int32_t n = 0;
    m->n = c->n;
    for (int i = 0; i < c->n; i++) {
        m->rest[i] = (tz_vec3){c->disc[i].at.x, c->disc[i].at.y, 0};
        m->radius[i] = c->disc[i].radius;
        m->start[i] = n;
        for (int32_t e = 0; e < c->edges; e++) {
            if (c->edge[e][0] == i)
                m->near[n++] = c->edge[e][1];
            else if (c->edge[e][1] == i)
                m->near[n++] = c->edge[e][0];
        }
    }
    m->start[c->n] = n;
    invert_graph(m);
}

/* Along all polygons, in steps: places on the silhouette's border are counted, and of
 * every `each` of them one is kept. Returns how many there are. */
static int64_t walk_border(tz_fill_model *m, const tz_vec2 *v, int32_t n,
                           const int32_t *part, int32_t parts, double step, double each)
{
    const tz_shape_distance *d = &m->cover.distance;
    int64_t count = 0;
    double left = 0;
    for (int32_t k = 0; k < parts; k++) {
        const int32_t from = part[k], to = k + 1 < parts ? part[k + 1] : n;
        for (int32_t i = from; i < to; i++) {
            const tz_vec2 a = v[i], b = v[i + 1 < to ? i + 1 : from];
            const double l = hypot(b.x - a.x, b.y - a.y);
            for (; left < l; left += step) {
                const double t = left / l;
                const tz_vec2 p = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
                if (tz_shape_distance_at(d, p, NULL) > d->cell)
                    continue; /* painted over */
                if (each > 0 && m->borders < TZ_FILL_BORDER &&
                    count >= (int64_t)floor(m->borders * each))
                    m->border[m->borders++] = p;
                count++;
            }
            left -= l;
        }
    }
    return count;
}

/* Points of the silhouette's border at even distances. */
static tz_status take_border(tz_ctx *ctx, tz_fill_model *m, const tz_vec2 *v, int32_t n,
                             const int32_t *part, int32_t parts)
{
    double all = 0;
    const tz_status s = tz_alloc(ctx, &m->border, TZ_FILL_BORDER, sizeof *m->border);
    for (int32_t k = 0; k < parts && s == TZ_OK; k++) {
        const int32_t from = part[k], to = k + 1 < parts ? part[k + 1] : n;
        for (int32_t i = from; i < to; i++) {
            const tz_vec2 a = v[i], b = v[i + 1 < to ? i + 1 : from];
            all += hypot(b.x - a.x, b.y - a.y);
        }
    }
    if (s != TZ_OK || !(all > 0))
        return s;
    const double step = all / (32 * TZ_FILL_BORDER);
    const int64_t count = walk_border(m, v, n, part, parts, step, 0);
    walk_border(m, v, n, part, parts, step, (double)count / TZ_FILL_BORDER);
    return s;
}

static tz_vec2 turned(tz_vec2 p, double angle, double scale)
{
    const double c = cos(angle) * scale, s = sin(angle) * scale;
    return (tz_vec2){c * p.x - s * p.y, s * p.x + c * p.y};
}

/* Rows of discs interlock where the outline bulges out between them: each grows by what
 * its part of the outline lies beyond it in the mean, but little, for tips do so, too. */
static void grow_discs(tz_fill_model *m)
{
    const double most = 0.15;
    double off[TZ_COVER_DISCS] = {0};
    int32_t n[TZ_COVER_DISCS] = {0};
    for (int32_t k = 0; k < m->borders; k++) {
        int32_t best = 0;
        double least = HUGE_VAL;
        for (int32_t i = 0; i < m->n; i++) {
            const double d =
                hypot(m->border[k].x - m->rest[i].x, m->border[k].y - m->rest[i].y) -
                m->radius[i];
            if (d < least)
                least = d, best = i;
        }
        off[best] += fmax(least, 0), n[best]++;
    }
    for (int32_t i = 0; i < m->n; i++)
        if (n[i] > 0)
            m->radius[i] += fmin(off[i] / n[i], most * m->radius[i]);
}

static int by_value(const void *a, const void *b)
{
    const double *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

/* By which factor radii grow for the union of the discs to have (1 + rho)^2 times its
 * area, as a polynomial through rho = 0, 1/2 and 1. Of a grid of places about them each
 * has a factor from which on it is covered: in rising order these are the area's inverse. */
static tz_status take_spread(tz_ctx *ctx, tz_fill_model *m)
{
    enum { GRID = 96 };
    const double most = 4; /* of an endless row */
    double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL}, *at = NULL;
    int32_t inside = 0, n = 0;
    m->spread[0] = 1, m->spread[1] = 0;
    if (m->n < 2)
        return TZ_OK;
    for (int32_t k = 0; k < m->n; k++) {
        const double p[2] = {m->rest[k].x, m->rest[k].y}, r = most * m->radius[k];
        for (int a = 0; a < 2; a++)
            lo[a] = fmin(lo[a], p[a] - r), hi[a] = fmax(hi[a], p[a] + r);
    }
    const tz_status s = tz_alloc(ctx, &at, GRID * GRID, sizeof *at);
    for (; n < GRID * GRID && s == TZ_OK; n++) {
        const double x = lo[0] + (n % GRID + 0.5) / GRID * (hi[0] - lo[0]);
        const double y = lo[1] + (n / GRID + 0.5) / GRID * (hi[1] - lo[1]);
        at[n] = HUGE_VAL;
        for (int32_t k = 0; k < m->n; k++)
            at[n] = fmin(at[n], hypot(x - m->rest[k].x, y - m->rest[k].y) / m->radius[k]);
        inside += at[n] <= 1;
    }
    if (s == TZ_OK && 4 * inside < n && inside > 0) {
        qsort(at, (size_t)n, sizeof *at, by_value);
        const double half = at[(int32_t)(2.25 * inside)] - 1, all = at[4 * inside] - 1;
        m->spread[0] = 4 * half - all, m->spread[1] = 2 * all - 4 * half;
    }
    tz_free(ctx, at);
    return s;
}

/* Discs, graph and border of a symbol turned and scaled. */
static tz_status make_shape(tz_ctx *ctx, const tz_element_symbol *y, int32_t discs,
                            tz_fill_model *m)
{
    enum { ROUND = 48 };
    tz_vec2 *v = NULL, round[ROUND];
    const int32_t zero = 0;
    const bool disc = y->outline.n < 3 || y->part.n < 1;
    const int32_t n = disc ? ROUND : y->outline.n, parts = disc ? 1 : y->part.n;
    for (int k = 0; k < ROUND; k++)
        round[k] = (tz_vec2){y->radius * cos(2 * TZ_PI * k / ROUND),
                             y->radius * sin(2 * TZ_PI * k / ROUND)};
    tz_status s = tz_alloc(ctx, &v, (size_t)n, sizeof *v);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        v[i] = turned(disc ? round[i] : y->outline.v[i], m->angle, m->scale);
        m->reach = fmax(m->reach, hypot(v[i].x, v[i].y));
    }
    const int32_t *part = disc ? &zero : y->part.v;
    if (s == TZ_OK)
        s = tz_disc_cover_init(ctx, v, n, part, parts, y->radius * m->scale, discs, 0.97,
                               &m->cover);
    if (s == TZ_OK)
        s = take_border(ctx, m, v, n, part, parts);
    if (s == TZ_OK) {
        m->area = m->cover.area;
        take_graph(m);
        grow_discs(m);
        for (int32_t k = 0; k < m->borders; k++) {
            double off = HUGE_VAL;
            for (int32_t i = 0; i < m->n; i++)
                off = fmin(off, hypot(m->border[k].x - m->rest[i].x,
                                      m->border[k].y - m->rest[i].y) -
                                    m->radius[i]);
            m->rim = fmax(m->rim, off);
        }
    }
    tz_free(ctx, v);
    return s;
}

static tz_status take_samples(tz_ctx *ctx, const tz_element_set *p, tz_fill_model *m)
{
    const tz_element *e = &p->element.v[m->element];
    m->samples = e->samples;
    const tz_status s = tz_alloc(ctx, &m->sample, (size_t)e->samples, sizeof *m->sample);
    for (int32_t k = 0; k < e->samples && s == TZ_OK; k++) {
        const tz_vec3 q = p->sample.v[e->sample + k].at;
        m->sample[k] = (tz_vec2){q.x - e->at.x, q.y - e->at.y};
    }
    return s;
}

/* Nearly as far in all directions: no direction is seen. */
static bool is_round(const tz_fill_model *m)
{
    double least = HUGE_VAL, most = 0;
    for (int32_t k = 0; k < m->borders; k++) {
        const double r = hypot(m->border[k].x, m->border[k].y);
        least = fmin(least, r), most = fmax(most, r);
    }
    return least > 0.95 * most;
}

/* Things that stay as they came say nothing of directions. Where all things are round the
 * pictures on them may still have one. */
static void note_rounds(tz_fill *f)
{
    f->any_pointed = f->any_soft = false;
    for (int32_t k = 0; k < f->entries; k++) {
        tz_fill_model *m = &f->model.v[k];
        m->round = is_round(m);
        f->any_pointed = f->any_pointed || !m->round;
        f->any_soft = f->any_soft || m->rigidity < TZ_FILL_RIGID;
    }
    for (int32_t k = 0; k < f->entries; k++)
        f->model.v[k].round = f->model.v[k].round && f->any_pointed;
}

static tz_status add_model(tz_fill *f, const tz_element_set *set, tz_fill_model m)
{
    tz_status s = make_shape(f->ctx, &set->symbol.v[m.symbol], f->par.discs, &m);
    if (s == TZ_OK && m.element >= 0)
        s = take_samples(f->ctx, set, &m);
    m.spread[0] = 1;
    if (s == TZ_OK && f->any_density)
        s = take_spread(f->ctx, &m);
    if (s == TZ_OK)
        s = tz_array_push(f->ctx, &f->model, m);
    if (s != TZ_OK)
        tz_fill_model_deinit(f->ctx, &m);
    return s;
}

tz_status tz_fill_model_of_symbol(tz_fill *f, const tz_element_set *set, int32_t symbol,
                                  int32_t *model)
{
    for (*model = f->entries; *model < f->model.n; ++*model)
        if (f->model.v[*model].symbol == symbol)
            return TZ_OK;
    return add_model(f, set,
                     (tz_fill_model){.symbol = symbol,
                                     .element = -1,
                                     .round = true,
                                     .scale = 1,
                                     .rigidity = TZ_FILL_RIGID,
                                     .size = {1, 1}});
}

static tz_status check_entry(tz_ctx *ctx, const tz_fill_entry *e,
                             const tz_element_set *palette, int32_t i)
{
    if (e->element < 0 || e->element >= palette->element.n)
        return tz_fail(ctx, TZ_INVALID,
                       "entry %d of the mix names element %d; the palette has %d", i,
                       e->element, palette->element.n);
    if (!(e->share >= 0 && e->share <= MOST_SHARE))
        return tz_fail(ctx, TZ_INVALID,
                       "entry %d of the mix has share %g; it must be 0 to %g", i,
                       e->share, MOST_SHARE);
    if (!(e->rigidity >= 0) || !isfinite(e->rigidity))
        return tz_fail(ctx, TZ_INVALID,
                       "entry %d of the mix has rigidity %g; it must be 0 (bends) to 100 "
                       "(rigid)",
                       i, e->rigidity);
    if (!(e->size[0] >= 1 / MOST_SIZE) || !(e->size[1] >= e->size[0]) ||
        !(e->size[1] <= MOST_SIZE))
        return tz_fail(
            ctx, TZ_INVALID,
            "entry %d of the mix has sizes %g to %g; they must be %g to %g and "
            "in order",
            i, e->size[0], e->size[1], 1 / MOST_SIZE, MOST_SIZE);
    if (!isfinite(e->turn) || !(e->jitter >= 0) || !isfinite(e->jitter))
        return tz_fail(ctx, TZ_INVALID, "entry %d of the mix has turn %g and jitter %g",
                       i, e->turn, e->jitter);
    return TZ_OK;
}

static tz_status add_entry(tz_fill *f, const tz_fill_entry *e)
{
    const tz_element_set *p = f->job.palette;
    const tz_element *of = &p->element.v[e->element];
    return add_model(f, p,
                     (tz_fill_model){.symbol = of->symbol,
                                     .kind = of->kind,
                                     .element = e->element,
                                     .angle = of->angle,
                                     .scale = of->scale,
                                     .rigidity = e->rigidity,
                                     .share = e->share,
                                     .size = {e->size[0], e->size[1]},
                                     .turn = e->turn,
                                     .jitter = e->jitter});
}

/* Radius of the largest disc that the domain holds. */
static double widest_place(const tz_fill *f)
{
    const tz_region *g = f->domain.region;
    double most = fmin(f->domain.size.x, f->domain.size.y) / 2, deep = 0;
    if (!g)
        return most;
    const double cell =
        hypot(g->raster.size.x / g->raster.width, g->raster.size.y / g->raster.height);
    for (int64_t i = 0; i < (int64_t)g->raster.width * g->raster.height; i++)
        deep = fmax(deep, (double)g->distance[i]);
    return fmin(most, deep + cell / 2);
}

/* The size up to which a thing can lie in the domain: its largest disc, its longest way
 * and its area do. */
static double most_size(const tz_fill *f, const tz_fill_model *m, double room)
{
    const tz_vec3 size = f->domain.size;
    const double way = f->domain.torus ? fmax(size.x, size.y) : hypot(size.x, size.y);
    double disc = 0, longest = 0;
    for (int32_t i = 0; i < m->cover.n; i++)
        disc = fmax(disc, m->cover.disc[i].radius);
    for (int32_t i = 0; i < m->borders; i++)
        for (int32_t k = 0; k < i; k++)
            longest = fmax(longest, hypot(m->border[i].x - m->border[k].x,
                                          m->border[i].y - m->border[k].y));
    return fmin(fmin(room / disc, way / longest),
                sqrt(tz_domain_area(&f->domain) / m->area));
}

/* What never fits gets no share, and no size that does not. */
static tz_status fit_sizes(tz_fill *f)
{
    const double room = widest_place(f);
    double share = 0, wanted = 0;
    for (int32_t i = 0; i < f->entries; i++) {
        tz_fill_model *m = &f->model.v[i];
        const double most = most_size(f, m, room);
        wanted += m->share;
        if (m->size[0] >= most)
            m->share = 0;
        m->size[1] = fmin(m->size[1], fmax(m->size[0], most));
        share += m->share;
    }
    if (!(wanted > 0))
        return tz_fail(
            f->ctx, TZ_INVALID,
            "no thing of the palette may be copied: they are cut, in doubt, or "
            "have no share in the mix");
    if (!(share > 0))
        return tz_fail(f->ctx, TZ_INVALID,
                       "every thing of the palette is larger than the domain of %g x %g, "
                       "which holds a disc of radius %.4g; scale the palette down",
                       f->domain.size.x, f->domain.size.y, room);
    return TZ_OK;
}

tz_status tz_fill_models(tz_fill *f)
{
    const tz_element_set *p = f->job.palette;
    tz_status s = TZ_OK;
    if (!p || p->element.n == 0)
        return tz_fail(f->ctx, TZ_INVALID, "the palette holds no things to fill with");
    if (f->job.entry) {
        for (int32_t i = 0; i < f->job.entries && s == TZ_OK; i++) {
            s = check_entry(f->ctx, &f->job.entry[i], p, i);
            if (s == TZ_OK)
                s = add_entry(f, &f->job.entry[i]);
        }
    } else {
        for (int32_t i = 0; i < p->element.n && s == TZ_OK; i++)
            if (tz_element_may_copy(&p->element.v[i]) &&
                !p->kind.v[p->element.v[i].kind].is_void)
                s = add_entry(f, &(tz_fill_entry){.element = i,
                                                  .share = 1,
                                                  .rigidity = f->par.rigidity,
                                                  .size = {1, 1}});
    }
    f->entries = f->model.n;
    if (s != TZ_OK)
        return s;
    note_rounds(f);
    return fit_sizes(f);
}

/* ---- samples ------------------------------------------------------------------------ */

tz_status tz_fill_reserve(tz_fill *f, int32_t samples)
{
    if (samples <= f->cap)
        return TZ_OK;
    const size_t cap = (size_t)samples + (size_t)samples / 8 + 64, m = (size_t)f->m;
    tz_status s = TZ_OK;
#define GROW(array, times) \
    if (s == TZ_OK)        \
        s = tz_realloc(f->ctx, &f->array, cap * (times), sizeof *f->array);
    GROW(at, 1)
    GROW(radius, 1)
    GROW(c, 1)
    GROW(rho, 1)
    GROW(wide, 1)
    GROW(o, m)
    GROW(owner, 1)
    GROW(node, 1)
    GROW(weight, 1)
    GROW(target, m)
    GROW(target_c, 1)
    GROW(target_rho, 1)
    GROW(confident, 1)
    GROW(prior, 1)
    GROW(said_c, 1)
    GROW(said_rho, 1)
    GROW(link_start, 1)
    GROW(link_count, 1)
    GROW(diag, 1)
    GROW(rank, 1)
    GROW(gradient, m)
    GROW(step, m)
    GROW(kept, m)
    GROW(pressure, 1)
    GROW(work, 3 * m)
    if (f->dim == 3) {
        GROW(block, m * m)
    }
#undef GROW
    if (s == TZ_OK) {
        memset(f->work, 0, 3 * m * cap * sizeof *f->work);
        f->cap = (int32_t)cap;
    }
    return s;
}

void tz_fill_put(tz_fill *f, int32_t body, tz_vec3 at, double angle, double c)
{
    const tz_fill_body *b = &f->body.v[body];
    const tz_fill_model *m = &f->model.v[b->model];
    const double x = cos(angle), y = sin(angle);
    for (int32_t k = 0; k < b->n; k++) {
        const int32_t s = b->first + k;
        const tz_vec2 r = {b->x * m->rest[k].x - b->y * m->rest[k].y,
                           b->y * m->rest[k].x + b->x * m->rest[k].y};
        f->at[s] = (tz_vec3){at.x + c * (x * r.x - y * r.y),
                             at.y + c * (y * r.x + x * r.y), at.z};
        f->c[s] = c;
        f->o[2 * (ptrdiff_t)s] = x, f->o[2 * (ptrdiff_t)s + 1] = y;
        f->pressure[s] = 0;
    }
}

tz_status tz_fill_add_body(tz_fill *f, int32_t model, tz_vec3 at, double angle, double c,
                           double size, double turn, int32_t *out)
{
    const tz_fill_model *m = &f->model.v[model];
    const tz_fill_body b = {.model = model,
                            .first = f->n,
                            .n = m->n,
                            .size = size,
                            .turn = turn,
                            .x = size * cos(turn),
                            .y = size * sin(turn),
                            .source = -1,
                            .awake = true};
    if (f->body.n >= TZ_FILL_MOST)
        return tz_fail(f->ctx, TZ_LIMIT,
                       "over %d elements; take larger ones, or a smaller domain",
                       TZ_FILL_MOST);
    tz_status s = tz_fill_reserve(f, f->n + m->n);
    if (s == TZ_OK)
        s = tz_array_push(f->ctx, &f->body, b);
    if (s != TZ_OK)
        return s;
    *out = f->body.n - 1;
    for (int32_t k = 0; k < m->n; k++) {
        const int32_t i = f->n + k;
        f->radius[i] = m->radius[k] * size;
        f->rho[i] = 0, f->wide[i] = 1;
        f->confident[i] = f->prior[i] = 0;
        f->owner[i] = *out;
        f->node[i] = m->rigidity >= TZ_FILL_RIGID ? f->n : i;
    }
    f->n += m->n;
    f->made++;
    f->stale = true;
    f->fresh = false;
    tz_fill_put(f, *out, at, angle, c);
    return s;
}

/* ---- poses -------------------------------------------------------------------------- */

void tz_fill_pose(const tz_fill *f, int32_t body, tz_vec2 *at, double *angle,
                  double *scale)
{
    const tz_fill_body *b = &f->body.v[body];
    const tz_fill_model *m = &f->model.v[b->model];
    tz_vec2 from = {0, 0}, to = {0, 0}, turn = {0, 0};
    double total = 0, c = 0, cosine = 0, sine = 0;
    for (int32_t k = 0; k < b->n; k++) {
        const int32_t s = b->first + k;
        const double w = m->radius[k] * m->radius[k];
        const tz_vec2 t = tz_fill_turn(f, s);
        from.x += w * m->rest[k].x, from.y += w * m->rest[k].y;
        to.x += w * f->at[s].x, to.y += w * f->at[s].y;
        turn.x += w * t.x, turn.y += w * t.y;
        c += w * tz_fill_scale(f, s);
        total += w;
    }
    from = tz_vec2_scale(from, 1 / total), to = tz_vec2_scale(to, 1 / total);
    for (int32_t k = 0; k < b->n; k++) {
        const double w = m->radius[k] * m->radius[k];
        const double x = m->rest[k].x - from.x, y = m->rest[k].y - from.y;
        const double u = f->at[b->first + k].x - to.x, v = f->at[b->first + k].y - to.y;
        cosine += w * (x * u + y * v), sine += w * (x * v - y * u);
    }
    const bool rigid = m->rigidity >= TZ_FILL_RIGID || b->n < 2 ||
                       !(hypot(cosine, sine) > 1e-12 * total);
    *angle = rigid ? atan2(turn.y, turn.x) + b->turn : atan2(sine, cosine);
    *scale = c / total * b->size;
    const double x = cos(*angle) * *scale, y = sin(*angle) * *scale;
    *at = (tz_vec2){to.x - x * from.x + y * from.y, to.y - y * from.x - x * from.y};
}

tz_vec3 tz_fill_centre(const tz_fill *f, int32_t body)
{
    tz_vec2 at;
    double angle, scale;
    tz_fill_pose(f, body, &at, &angle, &scale);
    return (tz_vec3){at.x, at.y, 0};
}

/* A soft body's map is that of its discs, each rigid, blended by nearness. */
tz_vec2 tz_fill_to_world(const tz_fill *f, int32_t body, tz_vec2 p)
{
    const tz_fill_body *b = &f->body.v[body];
    const tz_fill_model *m = &f->model.v[b->model];
    tz_vec2 sum = {0, 0};
    double total = 0;
    for (int32_t k = 0; k < b->n; k++) {
        const int32_t s = b->first + k;
        const double x = p.x - m->rest[k].x, y = p.y - m->rest[k].y;
        const double near = x * x + y * y + 1e-9 * m->reach * m->reach;
        const double w = 1 / (near * near), c = tz_fill_scale(f, s);
        const tz_vec2 t = tz_fill_turn(f, s);
        const double u = c * (b->x * x - b->y * y), v = c * (b->y * x + b->x * y);
        sum.x += w * (f->at[s].x + t.x * u - t.y * v);
        sum.y += w * (f->at[s].y + t.y * u + t.x * v);
        total += w;
    }
    return tz_vec2_scale(sum, 1 / total);
}

tz_vec2 tz_fill_to_model(const tz_fill *f, int32_t body, tz_vec2 world, double *scale,
                         tz_vec2 *turn)
{
    const tz_fill_body *b = &f->body.v[body];
    const tz_fill_model *m = &f->model.v[b->model];
    tz_vec2 sum = {0, 0};
    double total = 0;
    *scale = 0, *turn = (tz_vec2){0, 0};
    for (int32_t k = 0; k < b->n; k++) {
        const int32_t s = b->first + k;
        const tz_vec3 d = tz_fill_vector(f, f->at[s], (tz_vec3){world.x, world.y, 0});
        const double near = d.x * d.x + d.y * d.y + 1e-9 * m->reach * m->reach;
        const double w = 1 / (near * near), c = tz_fill_scale(f, s) * b->size;
        const tz_vec2 t = tz_fill_turn(f, s);
        const tz_vec2 r = {(t.x * b->x - t.y * b->y) / b->size,
                           (t.y * b->x + t.x * b->y) / b->size};
        sum.x += w * (m->rest[k].x + (r.x * d.x + r.y * d.y) / c);
        sum.y += w * (m->rest[k].y + (r.x * d.y - r.y * d.x) / c);
        *scale += w * c;
        *turn = tz_vec2_add(*turn, tz_vec2_scale(r, w));
        total += w;
    }
    *scale /= total;
    const double l = tz_vec2_length(*turn);
    *turn = l > 0 ? tz_vec2_scale(*turn, 1 / l) : (tz_vec2){1, 0};
    return tz_vec2_scale(sum, 1 / total);
}
