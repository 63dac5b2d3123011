/* SPDX-License-Identifier: Apache-2.0 */
/* Peers: the things that the eye compares a thing with, the nearest by their middles.
 *
 * [Hsu20] Eq. (8) compares samples, and of each only with the three nearest. Of a rigid
 * thing all samples have one direction, so what is left of that is how often two things
 * touch by discs: ends of long things, which meet in one small disc, are hardly tied to
 * each other, and rows side by side are tied five times. Between rigid things it is
 * things that are compared here, each with its PEERS nearest in equal shares, twice where
 * both name each other. Directions then are harmonic over the very neighbours in which
 * steps are seen. Round things have no direction that is seen: they are passed over, and
 * take the mean of what lies about them.
 *
 * A grid of about two middles a cell; rings of cells about a middle are searched until no
 * farther one can hold a nearer thing. */
#include "fields/fill_internal.h"

typedef struct grid {
    int32_t width, height, n;
    double cell_x, cell_y;
    int32_t *start, *item; /* bodies by cell */
    tz_vec2 *at;           /* their middles */
} grid;

tz_vec3 tz_fill_middle(const tz_fill *f, const tz_fill_body *b)
{
    const tz_fill_model *m = &f->model.v[b->model];
    const tz_vec2 t = tz_fill_turn(f, b->first);
    const double c = tz_fill_scale(f, b->first);
    const double x = b->x * m->rest[0].x - b->y * m->rest[0].y,
                 y = b->y * m->rest[0].x + b->x * m->rest[0].y;
    const tz_vec3 p = f->at[b->first];
    return tz_domain_wrap(&f->domain, (tz_vec3){p.x - c * (t.x * x - t.y * y),
                                                p.y - c * (t.y * x + t.x * y), p.z});
}

static bool is_peer(const tz_fill *f, const tz_fill_body *b)
{
    const tz_fill_model *m = &f->model.v[b->model];
    return !b->gone && !m->round && m->rigidity >= TZ_FILL_RIGID;
}

static int32_t cell_of(double x, double side, int32_t n)
{
    const double c = x / side;
    return !(c > 0) ? 0 : c >= n ? n - 1 : (int32_t)c;
}

static void grid_deinit(tz_ctx *ctx, grid *g)
{
    tz_free(ctx, g->start);
    tz_free(ctx, g->item);
    tz_free(ctx, g->at);
}

static tz_status grid_init(tz_fill *f, grid *g)
{
    const tz_vec3 size = f->domain.size;
    tz_vec2 *at = NULL;
    int32_t *cell = NULL, n = 0;
    *g = (grid){0};
    tz_status s = tz_alloc(f->ctx, &at, (size_t)f->body.n, sizeof *at);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &cell, (size_t)f->body.n, sizeof *cell);
    for (int32_t b = 0; b < f->body.n && s == TZ_OK; b++)
        n += is_peer(f, &f->body.v[b]);
    const double side = sqrt(2 * size.x * size.y / (n > 0 ? n : 1));
    g->n = n;
    g->width = (int32_t)fmin(fmax(floor(size.x / side), 1), 4096);
    g->height = (int32_t)fmin(fmax(floor(size.y / side), 1), 4096);
    g->cell_x = size.x / g->width, g->cell_y = size.y / g->height;
    const size_t cells = (size_t)g->width * (size_t)g->height;
    if (s == TZ_OK)
        s = tz_alloc_zero(f->ctx, &g->start, cells + 2, sizeof *g->start);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &g->item, (size_t)n, sizeof *g->item);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &g->at, (size_t)n, sizeof *g->at);
    for (int32_t b = 0; b < f->body.n && s == TZ_OK; b++) {
        if (!is_peer(f, &f->body.v[b]))
            continue;
        const tz_vec3 p = tz_fill_middle(f, &f->body.v[b]);
        at[b] = (tz_vec2){p.x, p.y};
        cell[b] = cell_of(p.y, g->cell_y, g->height) * g->width +
                  cell_of(p.x, g->cell_x, g->width);
        g->start[cell[b] + 2]++;
    }
    for (size_t i = 2; i < cells + 2 && s == TZ_OK; i++)
        g->start[i] += g->start[i - 1];
    for (int32_t b = 0; b < f->body.n && s == TZ_OK; b++) {
        if (!is_peer(f, &f->body.v[b]))
            continue;
        const int32_t to = g->start[cell[b] + 1]++;
        g->item[to] = b, g->at[to] = at[b];
    }
    tz_free(f->ctx, at);
    tz_free(f->ctx, cell);
    if (s != TZ_OK)
        grid_deinit(f->ctx, g);
    return s;
}

/* The nearest so far, nearest first; of equal ones those of lower number. */
typedef struct nearest {
    int32_t self, n, body[TZ_FILL_PEERS];
    double d2[TZ_FILL_PEERS];
    tz_vec3 at;
} nearest;

/* Cells from x0 to x1 of a row. */
static inline void look_into(const tz_fill *f, const grid *g, int32_t x0, int32_t x1,
                             int32_t y, nearest *s)
{
    const int32_t *row = g->start + (ptrdiff_t)y * g->width, end = row[x1 + 1];
    for (int32_t k = row[x0]; k < end; k++) {
        const int32_t b = g->item[k];
        if (b == s->self)
            continue;
        const tz_vec3 v =
            tz_fill_vector(f, s->at, (tz_vec3){g->at[k].x, g->at[k].y, s->at.z});
        const double d2 = v.x * v.x + v.y * v.y;
        if (s->n == TZ_FILL_PEERS && d2 > s->d2[s->n - 1])
            continue;
        int32_t i = s->n < TZ_FILL_PEERS ? s->n++ : s->n - 1;
        for (; i > 0 && (d2 < s->d2[i - 1] || (d2 == s->d2[i - 1] && b < s->body[i - 1]));
             i--)
            s->d2[i] = s->d2[i - 1], s->body[i] = s->body[i - 1];
        s->d2[i] = d2, s->body[i] = b;
    }
}

/* One ring of cells; false if all of them lie outside. */
static bool look_around(const tz_fill *f, const grid *g, int32_t cx, int32_t cy,
                        int32_t ring, nearest *s)
{
    const int32_t x0 = cx - ring, x1 = cx + ring, y0 = cy - ring, y1 = cy + ring;
    const int32_t from = x0 > 0 ? x0 : 0, to = x1 < g->width ? x1 : g->width - 1;
    if (x0 < 0 && y0 < 0 && x1 >= g->width && y1 >= g->height)
        return false;
    for (int32_t y = y0 > 0 ? y0 : 0; y <= y1 && y < g->height; y++) {
        if (y == y0 || y == y1) {
            look_into(f, g, from, to, y, s);
            continue;
        }
        if (x0 >= 0)
            look_into(f, g, x0, x0, y, s);
        if (x1 < g->width)
            look_into(f, g, x1, x1, y, s);
    }
    return true;
}

/* The same on a torus; each cell is met once. */
static bool look_about(const tz_fill *f, const grid *g, int32_t cx, int32_t cy,
                       int32_t ring, nearest *s)
{
    const int32_t w = g->width, h = g->height;
    const int32_t left = (w - 1) / 2, right = w / 2, up = (h - 1) / 2, down = h / 2;
    bool any = false;
    for (int32_t j = -ring; j <= ring; j++) {
        if (j < -up || j > down)
            continue;
        const int32_t step = j == -ring || j == ring ? 1 : 2 * ring;
        for (int32_t i = -ring; i <= ring; i += step > 0 ? step : 1) {
            if (i < -left || i > right)
                continue;
            const int32_t x = (cx + i + w) % w;
            look_into(f, g, x, x, (cy + j + h) % h, s);
            any = true;
        }
    }
    return any;
}

static inline double least(double a, double b) { return a < b ? a : b; }

typedef struct search {
    tz_fill *f;
    const grid *grid;
} search;

static void find_peers(void *arg, int32_t from, int32_t to, double sums[4])
{
    const search *t = arg;
    tz_fill *f = t->f;
    const grid *g = t->grid;
    const bool torus = f->domain.torus;
    (void)sums;
    for (int32_t j = from; j < to; j++) {
        const int32_t b = f->live.v[j];
        int32_t *out = f->peer + (ptrdiff_t)b * TZ_FILL_PEERS;
        nearest s = {.self = b};
        s.at = tz_fill_middle(f, &f->body.v[b]);
        const int32_t cx = cell_of(s.at.x, g->cell_x, g->width),
                      cy = cell_of(s.at.y, g->cell_y, g->height);
        const double x = least(s.at.x - cx * g->cell_x, (cx + 1) * g->cell_x - s.at.x),
                     y = least(s.at.y - cy * g->cell_y, (cy + 1) * g->cell_y - s.at.y);
        for (int32_t ring = 0;; ring++) {
            /* what is not yet seen lies beyond the cells that were */
            const double reach =
                least(x + (ring - 1) * g->cell_x, y + (ring - 1) * g->cell_y);
            if (reach > 0 && s.n == TZ_FILL_PEERS && s.d2[s.n - 1] <= reach * reach)
                break;
            if (!(torus ? look_about : look_around)(f, g, cx, cy, ring, &s))
                break;
        }
        for (int32_t k = 0; k < TZ_FILL_PEERS; k++)
            out[k] = k < s.n ? s.body[k] : -1;
    }
}

tz_status tz_fill_peers(tz_fill *f)
{
    grid g;
    if (f->dim != 2 || f->body.n == 0)
        return TZ_OK;
    if (f->body.n > f->peer_cap) {
        const size_t cap = (size_t)f->body.n + (size_t)f->body.n / 4 + 16;
        tz_status s = tz_realloc(f->ctx, &f->peer, cap * TZ_FILL_PEERS, sizeof *f->peer);
        if (s == TZ_OK)
            s = tz_realloc(f->ctx, &f->named, cap, sizeof *f->named);
        if (s != TZ_OK)
            return s;
        f->peer_cap = (int32_t)cap;
    }
    tz_status s = grid_init(f, &g);
    if (s != TZ_OK)
        return s;
    search t = {f, &g};
    s = tz_fill_blocks(f->ctx, f->live.n, find_peers, &t, NULL);
    grid_deinit(f->ctx, &g);
    return s;
}

/* Whether a thing that is awake names another. */
static bool names(const tz_fill *f, int32_t b, int32_t other)
{
    const int32_t *p = f->peer + (ptrdiff_t)b * TZ_FILL_PEERS;
    for (int k = 0; k < TZ_FILL_PEERS; k++)
        if (p[k] == other)
            return true;
    return false;
}

static bool is_live(const tz_fill_body *b) { return b->awake && !b->fixed && !b->gone; }

void tz_fill_count_peers(tz_fill *f)
{
    for (int32_t j = 0; j < f->live.n; j++)
        f->named[f->live.v[j]] = 0;
    for (int32_t j = 0; j < f->live.n; j++) {
        const int32_t b = f->live.v[j];
        if (!is_peer(f, &f->body.v[b]))
            continue;
        const int32_t *p = f->peer + (ptrdiff_t)b * TZ_FILL_PEERS;
        for (int k = 0; k < TZ_FILL_PEERS && p[k] >= 0; k++) {
            f->named[b]++;
            if (is_live(&f->body.v[p[k]]) && !names(f, p[k], b))
                f->named[p[k]]++;
        }
    }
}

/* Half of a link each time that one of two names the other; what is held would, too. */
void tz_fill_link_peers(tz_fill *f)
{
    const double half = 0.5;
    for (int32_t j = 0; j < f->live.n; j++) {
        const int32_t b = f->live.v[j], node = f->body.v[b].first;
        if (!is_peer(f, &f->body.v[b]))
            continue;
        const int32_t *p = f->peer + (ptrdiff_t)b * TZ_FILL_PEERS;
        for (int k = 0; k < TZ_FILL_PEERS && p[k] >= 0; k++) {
            const tz_fill_body *q = &f->body.v[p[k]];
            const bool live = is_live(q), both = !live || names(f, p[k], b);
            const double w = both ? 2 * half : half;
            f->link.v[f->link_start[node] + f->link_count[node]++] =
                (tz_fill_link){.to = q->first, .wt = w};
            if (!both)
                f->link.v[f->link_start[q->first] + f->link_count[q->first]++] =
                    (tz_fill_link){.to = node, .wt = w};
        }
    }
}

void tz_fill_turn_rounds(tz_fill *f)
{
    for (int32_t j = 0; j < f->live.n && f->any_pointed && !f->any_soft; j++) {
        const int32_t b = f->live.v[j], node = f->body.v[b].first;
        if (!f->model.v[f->body.v[b].model].round)
            continue;
        const int32_t *p = f->peer + (ptrdiff_t)b * TZ_FILL_PEERS;
        tz_vec2 sum = {0, 0};
        for (int k = 0; k < TZ_FILL_PEERS && p[k] >= 0; k++)
            sum = tz_vec2_add(sum, tz_fill_turn(f, f->body.v[p[k]].first));
        const double l = tz_vec2_length(sum);
        if (l > 0)
            f->o[2 * (ptrdiff_t)node] = sum.x / l,
                     f->o[2 * (ptrdiff_t)node + 1] = sum.y / l;
    }
}
