/* SPDX-License-Identifier: Apache-2.0 */
/* Cover: which places of the domain are decided.
 *
 * [Dav19] copies elements where free-space points are left, and so fills every gap that is
 * wide enough: random textures come out denser than their exemplars. Here empty room is
 * copied like elements are. When a seed takes over the first ring of a unit, all of that
 * disc is decided, its empty parts too, and later seeds add nothing there:
 *
 *      . . # # # . .      #  decided by earlier seeds
 *      . # # # # + .      +  decided by this seed: what its unit has here is copied
 *      # # # o # + +      .  open: nothing is known yet
 *      . # # # # + .
 *      . . # # + . .
 *
 * A unit at the exemplar's border decides no more than the exemplar shows. What has been
 * decided is also the measure of density: elements placed over elements due. */
#include <math.h>
#include <string.h>

#include "elements/growth_internal.h"

enum { CELLS = 1 << 26, ZONES = 256 };
static const double cell = 0.2;   /* spacings */
static const float early = 20;    /* elements that are too few to judge density by */
static const double beyond = 0.1; /* spacings that an exemplar is known beyond centres */

/* ---- walking over discs ---------------------------------------------------------- */

typedef enum verb { COUNT, DECIDE, FORGET, OPEN, CLOSE } verb;

/* Bits from..to of a word row, inclusive. */
static uint64_t mask_of(int32_t word, int32_t from, int32_t to)
{
    const int32_t lo = from - 64 * word, hi = to - 64 * word;
    const uint64_t below = lo <= 0 ? 0 : lo > 63 ? ~(uint64_t)0 : ((uint64_t)1 << lo) - 1;
    const uint64_t upto = hi < 0 ? 0 : hi >= 63 ? ~(uint64_t)0 : ((uint64_t)2 << hi) - 1;
    return upto & ~below;
}

/* Acts on cells from..to of a row that `only` admits; how many it has changed. */
static int32_t act(tz_growth_cover *c, int32_t row, int32_t from, int32_t to, verb v,
                   const uint64_t *only)
{
    int32_t n = 0;
    for (int32_t w = from / 64; w <= to / 64; w++) {
        const size_t at = (size_t)row * (size_t)c->words + (size_t)w;
        uint64_t m = mask_of(w, from, to);
        m &= only ? only[at] : ~(uint64_t)0;
        const uint64_t todo = v == FORGET  ? m & c->open[at] & c->done[at]
                              : v == OPEN  ? m & ~c->open[at]
                              : v == CLOSE ? m & c->open[at]
                                           : m & c->open[at] & ~c->done[at];
        const int32_t k = __builtin_popcountll(todo);
        n += k;
        switch (v) {
        case COUNT: break;
        case DECIDE: c->done[at] |= todo, c->covered += k; break;
        case FORGET: c->done[at] &= ~m, c->covered -= k; break;
        case OPEN:
            c->open[at] |= todo, c->opened += k;
            c->covered += __builtin_popcountll(todo & c->done[at]);
            break;
        case CLOSE:
            c->covered -= __builtin_popcountll(todo & c->done[at]);
            c->open[at] &= ~todo, c->opened -= k;
            break;
        }
    }
    return n;
}

static int32_t act_row(tz_growth *g, int32_t row, double from, double to, verb v,
                       const uint64_t *only)
{
    tz_growth_cover *c = &g->cover;
    if (!(from <= to))
        return 0;
    if (!g->out->domain.torus) {
        const double lo = fmax(from, 0), hi = fmin(to, c->nx - 1);
        return lo <= hi ? act(c, row, (int32_t)lo, (int32_t)hi, v, only) : 0;
    }
    if (to - from >= c->nx - 1)
        return act(c, row, 0, c->nx - 1, v, only);
    const int32_t i = tz_raster_index((int32_t)from, c->nx, true);
    const int32_t j = i + (int32_t)(to - from);
    if (j < c->nx)
        return act(c, row, i, j, v, only);
    return act(c, row, i, c->nx - 1, v, only) + act(c, row, 0, j - c->nx, v, only);
}

/* A disc, or the part of it in a box about its centre that is turned by (cos, sin). */
typedef struct disc {
    double x, y, r;
    bool cut;
    tz_vec2 lo, hi;
    double c, s;
} disc;

/* Narrows cells from..to of a row at height dy to the box's. */
static void clip(const disc *d, double dy, double *from, double *to)
{
    /* u = c dx + s dy in [lo.x, hi.x]; v = -s dx + c dy in [lo.y, hi.y] */
    const double k[2] = {d->c, -d->s}, at[2] = {d->s * dy, d->c * dy};
    const double lo[2] = {d->lo.x, d->lo.y}, hi[2] = {d->hi.x, d->hi.y};
    for (int i = 0; i < 2; i++) {
        if (fabs(k[i]) < 1e-9) {
            if (at[i] < lo[i] || at[i] > hi[i])
                *to = *from - 1;
            continue;
        }
        const double a = (lo[i] - at[i]) / k[i], b = (hi[i] - at[i]) / k[i];
        *from = fmax(*from, fmin(a, b)), *to = fmin(*to, fmax(a, b));
    }
}

static int32_t walk(tz_growth *g, const disc *d, verb v, const uint64_t *only)
{
    tz_growth_cover *c = &g->cover;
    const bool torus = g->out->domain.torus;
    const double sx = c->step_x, sy = c->step_y;
    double j0 = ceil((d->y - d->r) / sy - 0.5), j1 = floor((d->y + d->r) / sy - 0.5);
    int32_t n = 0;
    if (torus)
        j1 = fmin(j1, j0 + c->ny - 1);
    else
        j0 = fmax(j0, 0), j1 = fmin(j1, c->ny - 1);
    for (double j = j0; j <= j1; j++) {
        const double dy = (j + 0.5) * sy - d->y;
        const double half = sqrt(fmax(0, d->r * d->r - dy * dy));
        double from = -half, to = half;
        if (d->cut)
            clip(d, dy, &from, &to);
        if (from <= to)
            n += act_row(g, tz_raster_index((int32_t)j, c->ny, torus),
                         ceil((d->x + from) / sx - 0.5), floor((d->x + to) / sx - 0.5), v,
                         only);
    }
    return n;
}

/* ---- decisions ------------------------------------------------------------------- */

static disc disc_of(const tz_growth *g, const tz_growth_spot *q, int32_t unit)
{
    const tz_growth_exemplar *ex = &g->ex[q->texture];
    const tz_growth_unit *u = &ex->unit[unit];
    const double scale = tz_domain_apart(&g->out->domain, (tz_vec3){q->x, q->y, 0});
    disc d = {.x = q->x, .y = q->y, .r = u->wide * scale, .c = 1};
    if (!ex->torus && !u->known) {
        const double rim = beyond * u->spacing;
        const double turn = tz_domain_frame(&g->out->domain, (tz_vec3){q->x, q->y, 0});
        d.cut = true;
        d.lo =
            (tz_vec2){scale * (ex->lo.x - rim - u->x), scale * (ex->lo.y - rim - u->y)};
        d.hi =
            (tz_vec2){scale * (ex->hi.x + rim - u->x), scale * (ex->hi.y + rim - u->y)};
        d.c = cos(turn), d.s = sin(turn);
    }
    return d;
}

/* Elements that so many cells about a place should hold. */
static double due_in(const tz_growth *g, int32_t texture, double x, double y, int32_t n)
{
    const tz_growth_cover *c = &g->cover;
    double share = 1;
    if (c->share) {
        const tz_zones *z = g->out->domain.zones;
        share = (double)c->share[texture * ZONES +
                                 z->zone[tz_raster_at(&z->raster, (tz_vec3){x, y, 0})]];
    }
    const double scale = tz_domain_apart(&g->out->domain, (tz_vec3){x, y, 0});
    return n * c->step_x * c->step_y * g->ex[texture].density * share / (scale * scale);
}

static const uint64_t *zone_of(const tz_growth *g, int32_t texture)
{
    return g->cover.zone ? g->cover.zone + g->cover.cells * (size_t)texture : NULL;
}

float tz_growth_undecided(tz_growth *g, const tz_growth_spot *q)
{
    const double scale = tz_domain_apart(&g->out->domain, (tz_vec3){q->x, q->y, 0});
    const disc d = {
        .x = q->x, .y = q->y, .r = scale * g->ex[q->texture].unit[q->match].wide};
    const double all = TZ_PI * d.r * d.r / (g->cover.step_x * g->cover.step_y);
    return (float)(walk(g, &d, COUNT, zone_of(g, q->texture)) / all);
}

void tz_growth_decide(tz_growth *g, const tz_growth_spot *q, int32_t unit)
{
    const disc d = disc_of(g, q, unit);
    const int32_t n = walk(g, &d, DECIDE, zone_of(g, q->texture));
    g->cover.due[q->texture] += due_in(g, q->texture, q->x, q->y, n);
}

void tz_growth_decide_place(tz_growth *g, int32_t texture, double x, double y, double r)
{
    const disc d = {.x = x, .y = y, .r = r};
    const int32_t n = walk(g, &d, DECIDE, zone_of(g, texture));
    g->cover.due[texture] += due_in(g, texture, x, y, n);
}

void tz_growth_forget_place(tz_growth *g, int32_t texture, double x, double y, double r)
{
    const disc d = {.x = x, .y = y, .r = r};
    const int32_t n = walk(g, &d, FORGET, zone_of(g, texture));
    g->cover.due[texture] = fmax(0, g->cover.due[texture] - due_in(g, texture, x, y, n));
}

void tz_growth_open_place(tz_growth *g, int32_t texture, double x, double y, double r,
                          bool open)
{
    const disc d = {.x = x, .y = y, .r = r};
    tz_growth_cover *c = &g->cover;
    walk(g, &d, open ? OPEN : CLOSE, c->inside);
    if (!open || !c->led)
        return;
    uint64_t *const real = c->open; /* what is painted last is who grows there */
    const int64_t opened = c->opened, covered = c->covered;
    for (int32_t t = 0; t < g->textures; t++) {
        c->open = c->zone + c->cells * (size_t)t;
        walk(g, &d, t == texture ? OPEN : CLOSE, c->inside);
    }
    c->open = real;
    c->opened = opened, c->covered = covered;
}

static size_t bit_at(const tz_growth_cover *c, const tz_domain *d, double x, double y)
{
    const int32_t i = tz_raster_index((int32_t)floor(x / c->step_x), c->nx, d->torus);
    const int32_t j = tz_raster_index((int32_t)floor(y / c->step_y), c->ny, d->torus);
    return (size_t)j * (size_t)c->words * 64 + (size_t)i;
}

static bool bit(const uint64_t *v, size_t at) { return v[at / 64] >> (at % 64) & 1; }

bool tz_growth_is_decided(const tz_growth *g, double x, double y)
{
    return bit(g->cover.done, bit_at(&g->cover, &g->out->domain, x, y));
}

bool tz_growth_is_of(const tz_growth *g, int32_t texture, double x, double y)
{
    const size_t at = bit_at(&g->cover, &g->out->domain, x, y);
    const uint64_t *zone = zone_of(g, texture);
    return bit(g->cover.open, at) && (!zone || bit(zone, at));
}

bool tz_growth_may_go(const tz_growth *g, int32_t texture, double x, double y)
{
    const tz_zones *z = g->out->domain.zones;
    const int32_t own = g->ex[texture].texture.zone;
    return !z || own == 0 ||
           z->zone[tz_raster_at(&z->raster, (tz_vec3){x, y, 0})] == own - 1;
}

bool tz_growth_may_stand(const tz_growth *g, int32_t texture, const tz_growth_unit *u,
                         double x, double y)
{
    const tz_domain *d = &g->out->domain;
    const tz_vec3 p = {x, y, 0};
    const bool real = u->source >= 0;
    if (!tz_domain_contains(d, p))
        return false;
    const size_t at = bit_at(&g->cover, d, x, y);
    const uint64_t *zone = zone_of(g, texture);
    if (!bit(g->cover.open, at) || (zone && !bit(zone, at)) ||
        !tz_growth_may_go(g, texture, x, y))
        return false;
    if (real && g->params.inside > 0 &&
        tz_domain_depth(d, p) < g->params.inside * (double)u->r * tz_domain_scale(d, p))
        return false;
    return !real || tz_domain_allows(d, p, u->kind);
}

float tz_growth_error(const tz_growth *g, int32_t texture)
{
    const double due = g->cover.due[texture];
    return (float)((g->cover.count[texture] - due) / (due + (double)early));
}

bool tz_growth_next_open(const tz_growth *g, int64_t *from, double *x, double *y)
{
    const tz_growth_cover *c = &g->cover;
    const int64_t words = (int64_t)c->words * c->ny;
    for (int64_t w = *from / 64; w < words; w++) {
        uint64_t left = c->open[w] & ~c->done[w];
        if (w == *from / 64)
            left &= ~(uint64_t)0 << (*from % 64);
        if (!left)
            continue;
        const int64_t at = 64 * w + __builtin_ctzll(left);
        const int64_t row = at / (64 * (int64_t)c->words);
        *x = ((double)(at - row * 64 * c->words) + 0.5) * c->step_x;
        *y = ((double)row + 0.5) * c->step_y;
        *from = at + 1;
        return true;
    }
    *from = 64 * words;
    return false;
}

/* ---- making it ------------------------------------------------------------------- */

/* Share of a texture's elements that each zone lets in. */
static tz_status set_shares(tz_growth *g)
{
    const tz_zones *z = g->out->domain.zones;
    tz_growth_cover *c = &g->cover;
    if (!z)
        return TZ_OK;
    const size_t n = (size_t)g->textures * ZONES;
    const tz_status s = tz_alloc_zero(g->ctx, &c->share, n, sizeof *c->share);
    for (int32_t t = 0; s == TZ_OK && t < g->textures; t++)
        for (int32_t k = 0; k < z->zones; k++) {
            const tz_growth_exemplar *ex = &g->ex[t];
            float in = 0, all = 0;
            for (int32_t u = 0; u < ex->elements; u++)
                if (ex->unit[u].copied) {
                    const int32_t kind = ex->unit[u].kind;
                    in += kind >= 64 || (z->allow[k] >> kind & 1);
                    all += 1;
                }
            const bool other = ex->texture.zone > 0 && ex->texture.zone != k + 1;
            c->share[t * ZONES + k] = other || all <= 0 ? 0 : in / all;
        }
    return s;
}

static tz_status set_open(tz_growth *g, bool closed)
{
    tz_growth_cover *c = &g->cover;
    const tz_domain *d = &g->out->domain;
    tz_status s = TZ_OK;
    c->led = closed && g->textures > 1;
    if (d->zones || c->led)
        s = tz_alloc_zero(g->ctx, &c->zone, c->cells * (size_t)g->textures,
                          sizeof *c->zone);
    for (int64_t k = 0; s == TZ_OK && k < (int64_t)c->nx * c->ny; k++) {
        const int32_t i = (int32_t)(k % c->nx), j = (int32_t)(k / c->nx);
        const tz_vec3 p = {(i + 0.5) * c->step_x, (j + 0.5) * c->step_y, 0};
        const size_t at = (size_t)j * (size_t)c->words + (size_t)(i / 64);
        const uint64_t one = (uint64_t)1 << (i % 64);
        bool any = !d->zones;
        if (d->region && !tz_domain_contains(d, p))
            continue;
        for (int32_t t = 0; d->zones && t < g->textures; t++) {
            const int32_t z = d->zones->zone[tz_raster_at(&d->zones->raster, p)];
            if (c->share[t * ZONES + z] > 0) {
                c->zone[c->cells * (size_t)t + at] |= c->led ? 0 : one;
                any = true;
            }
        }
        if (any) {
            c->inside[at] |= one;
            c->open[at] |= closed ? 0 : one;
            c->opened += !closed;
        }
    }
    return s;
}

tz_status tz_growth_cover_init(tz_growth *g, bool closed)
{
    tz_growth_cover *c = &g->cover;
    const tz_vec3 size = g->out->domain.size;
    double step = cell * g->spacing * g->least;
    while (size.x / step * (size.y / step) > CELLS)
        step *= 1.25;
    c->nx = (int32_t)fmax(1, ceil(size.x / step - 1e-9));
    c->ny = (int32_t)fmax(1, ceil(size.y / step - 1e-9));
    c->words = (c->nx + 63) / 64;
    c->step_x = size.x / c->nx, c->step_y = size.y / c->ny;
    c->cells = (size_t)c->words * (size_t)c->ny;
    tz_status s = tz_alloc_zero(g->ctx, &c->open, c->cells, sizeof *c->open);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &c->done, c->cells, sizeof *c->done);
    if (s == TZ_OK)
        s = tz_alloc_zero(g->ctx, &c->inside, c->cells, sizeof *c->inside);
    if (s == TZ_OK)
        s = set_shares(g);
    if (s == TZ_OK)
        s = set_open(g, closed);
    return s;
}

void tz_growth_cover_deinit(tz_growth *g)
{
    tz_growth_cover *c = &g->cover;
    tz_free(g->ctx, c->open);
    tz_free(g->ctx, c->done);
    tz_free(g->ctx, c->inside);
    tz_free(g->ctx, c->zone);
    tz_free(g->ctx, c->share);
    memset(c, 0, sizeof *c);
}

void tz_growth_tell(const tz_growth *g, tz_growth_report *report)
{
    const tz_growth_cover *c = &g->cover;
    const double one = c->step_x * c->step_y;
    double density = 0, due = 0;
    for (int32_t t = 0; t < g->textures; t++)
        density += g->ex[t].density / g->textures, due += c->due[t];
    *report = (tz_growth_report){
        .area = (double)c->opened * one,
        .covered = c->opened ? (double)c->covered / (double)c->opened : 1,
        .placed = g->placed,
        .expected = due + (double)(c->opened - c->covered) * one * density};
}
