/* SPDX-License-Identifier: Apache-2.0 */
/* Where the solver starts from: patches of the exemplar side by side, or white noise.
 *
 * Each cell of the domain takes a patch. The paper's are random; here several are tried,
 * each laid so that one of its things falls on one that stands beside the cell already,
 *
 *      placed . o |          the patch's surroundings in the exemplar should look like
 *             o . | cell     what stands there: the one whose surroundings are nearest
 *             . o |          is taken
 *
 * because least squares move things but cannot add or remove any: what two patches have
 * doubled or left out at their seam stays.
 * @source [Ma11] Sec. 4.1; cells in random order, a random patch each, no overlap test,
 *   as the authors' programs do: `tries` = 1. Deviates further: a patch is as large as
 *   its cell, which keeps the density; a thing that the exemplar's border has cut is
 *   replaced by a whole one of its class. */
#include <stdlib.h>

#include "base/rng.h"
#include "elements/element_density.h"
#include "elements/energy_internal.h"

enum {
    STREAM_PATCH = 0x656e70,
    STREAM_NOISE = 0x656e6e,
    BAND = 24 /* things beside a cell that patches are compared by, at most */
};

/* A thing that stands beside a cell. */
typedef struct beside {
    tz_vec3 at;           /* from the cell's corner, turned back as the exemplar lies */
    double angle, radius; /* in the local frame */
    const tz_element *element;
} beside;

typedef struct filler {
    tz_ctx *ctx;
    const tz_element_set *from;
    tz_element_set *to;
    tz_cells fixed;
    tz_vec3 *fixed_at;
    int32_t fixed_n;
    double apart; /* least distance from fixed elements */
    int32_t tries;
    double attribute;
    tz_cells source; /* the exemplar's elements */
    tz_vec3 *source_at;
    int32_t *found; /* scratch: of the exemplar's elements */
    tz_vec2 side;   /* of a cell of the domain */
    int32_t nx, ny;
    int32_t *begin, *end; /* elements of each cell; equal = none yet */
    TZ_ARRAY(tz_energy_forbidden)
    forbidden;       /* by zones */
    double density;  /* of the exemplar */
    double expected; /* elements of the cells that are done, as the exemplar has them */
} filler;

/* Only fixed elements and their samples stay. */
static tz_status keep_fixed(tz_element_set *s)
{
    uint8_t *drop = NULL;
    tz_status st = tz_alloc(s->ctx, &drop, (size_t)s->element.n, 1);
    for (int32_t i = 0; i < s->element.n && st == TZ_OK; i++)
        drop[i] = !s->element.v[i].fixed;
    if (st == TZ_OK)
        st = tz_energy_drop(s, drop, NULL);
    tz_free(s->ctx, drop);
    return st;
}

static bool taken(const filler *f, tz_vec3 at)
{
    tz_nearby one;
    return f->fixed_n > 0 &&
           tz_cells_near(&f->fixed, f->fixed_at, at, f->apart, -1, &one, 1) > 0;
}

/* Kept when its first sample comes to lie inside and on no fixed element. */
static tz_status place(filler *f, int32_t source, tz_vec3 at, tz_rng *r)
{
    const tz_domain *d = &f->to->domain;
    const tz_vec3 in = tz_domain_wrap(d, at);
    if (!tz_domain_allows(d, in, f->from->element.v[source].kind))
        return tz_domain_contains(d, in) && !taken(f, in)
                   ? tz_array_push(f->ctx, &f->forbidden,
                                   ((tz_energy_forbidden){in, source}))
                   : TZ_OK;
    source = tz_energy_choose(f->from, d, source, in, r);
    if (source < 0)
        return TZ_OK;
    const tz_element *e = &f->from->element.v[source];
    const tz_vec3 p = f->from->sample.v[e->sample].at;
    const double turn = tz_domain_frame(d, at), c = cos(turn), s = sin(turn);
    const double size = tz_domain_scale(d, at);
    const double x = size * (p.x - e->at.x), y = size * (p.y - e->at.y);
    const tz_vec3 first = {at.x + c * x - s * y, at.y + s * x + c * y, at.z};
    if (!tz_domain_contains(d, first) || taken(f, at))
        return TZ_OK;
    return tz_element_set_place(f->to, f->from, source, at, turn, size);
}

/* ---- patches --------------------------------------------------------------------- */

/* A patch lies in the exemplar straight, from `corner` on; in the domain it is turned and
 * scaled about the middle of its cell by the frame there. */
typedef struct frame {
    double turn, scale;
} frame;

static bool is_plain(frame p) { return p.turn == 0 && p.scale == 1; }

static frame frame_of(const filler *f, int32_t cell)
{
    const tz_vec3 middle = {(cell % f->nx + 0.5) * f->side.x,
                            (cell / f->nx + 0.5) * f->side.y, 0};
    return (frame){tz_domain_frame(&f->to->domain, middle),
                   tz_domain_apart(&f->to->domain, middle)};
}

static tz_vec2 turned(const filler *f, tz_vec2 v, frame p)
{
    const double x = v.x - 0.5 * f->side.x, y = v.y - 0.5 * f->side.y;
    const double c = p.scale * cos(p.turn), s = p.scale * sin(p.turn);
    return (tz_vec2){c * x - s * y + 0.5 * f->side.x, s * x + c * y + 0.5 * f->side.y};
}

/* Where element i of the exemplar comes to lie, from the cell's corner; false beyond. */
static bool in_patch(const filler *f, int32_t i, tz_vec2 corner, frame p, tz_vec2 *v)
{
    const tz_domain *d = &f->from->domain;
    const tz_vec3 q = f->from->element.v[i].at;
    *v = (tz_vec2){q.x - corner.x, q.y - corner.y};
    if (d->torus && is_plain(p)) {
        v->x = tz_domain_wrap_axis(v->x, d->size.x);
        v->y = tz_domain_wrap_axis(v->y, d->size.y);
    } else if (!is_plain(p)) {
        const tz_vec3 middle = {0.5 * f->side.x, 0.5 * f->side.y, 0};
        const tz_vec3 way = tz_domain_vector(d, middle, (tz_vec3){v->x, v->y, 0});
        *v = turned(f, (tz_vec2){middle.x + way.x, middle.y + way.y}, p);
    }
    return v->x >= 0 && v->y >= 0 && v->x < f->side.x && v->y < f->side.y;
}

static int by_number(const void *a, const void *b)
{
    const int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;
    return (p > q) - (p < q);
}

/* Cells of the exemplar along one axis that lo..hi touches: the first, and how many. */
static int32_t cells_along(double lo, double hi, double side, int32_t n, bool torus,
                           int32_t *first)
{
    const double a = floor(lo / side - 1e-6), b = floor(hi / side + 1e-6);
    if (torus) {
        const double begin = tz_domain_wrap_axis(a, n);
        *first = (int32_t)begin;
        return (int32_t)fmin(b - a + 1, n);
    }
    *first = (int32_t)fmin(fmax(a, 0), n - 1);
    return (int32_t)fmin(fmax(b, 0), n - 1) - *first + 1;
}

/* Elements of the exemplar that may lie in a patch, each once, in f->found. */
static int32_t look_up(filler *f, tz_vec2 corner, tz_vec2 reach)
{
    const tz_cells *c = &f->source;
    const double x = corner.x + 0.5 * (f->side.x - reach.x) - c->origin.x;
    const double y = corner.y + 0.5 * (f->side.y - reach.y) - c->origin.y;
    const bool torus = f->from->domain.torus;
    int32_t x0, y0, n = 0;
    const int32_t nx = cells_along(x, x + reach.x, c->side.x, c->nx, torus, &x0);
    const int32_t ny = cells_along(y, y + reach.y, c->side.y, c->ny, torus, &y0);
    for (int32_t j = 0; j < ny; j++)
        for (int32_t i = 0; i < nx; i++) {
            const int32_t cell = (y0 + j) % c->ny * c->nx + (x0 + i) % c->nx;
            for (int32_t k = c->first.v[cell]; k < c->first.v[cell + 1]; k++)
                f->found[n++] = c->item.v[k];
        }
    return n;
}

/* Share of a cell that lies inside the region. */
static double share_of(const filler *f, int32_t cell)
{
    enum { GRID = 8 };
    int32_t in = 0;
    if (!f->to->domain.region)
        return 1;
    for (int32_t k = 0; k < GRID * GRID; k++) {
        const tz_vec3 p = {(cell % f->nx + (k % GRID + 0.5) / GRID) * f->side.x,
                           (cell / f->nx + (k / GRID + 0.5) / GRID) * f->side.y, 0};
        in += tz_region_distance(f->to->domain.region, p) > 0;
    }
    return (double)in / (GRID * GRID);
}

/* Where a patch begins along an axis: anywhere on a torus, else wholly inside if it can
 * be, also turned. */
static double patch_begin(tz_rng *r, double size, double side, double reach, bool torus)
{
    const double rest = 0.5 * (reach - side);
    const double room = torus ? size : fmax(0, size - reach);
    return tz_rng_unit(r) * room + (torus ? 0 : fmin(rest, 0.5 * fmax(0, size - side)));
}

/* Extent of a patch along the exemplar's axes. */
static tz_vec2 reach_of(const filler *f, frame p)
{
    const double c = fabs(cos(p.turn)) / p.scale, s = fabs(sin(p.turn)) / p.scale;
    return is_plain(p)
               ? f->side
               : (tz_vec2){c * f->side.x + s * f->side.y, s * f->side.x + c * f->side.y};
}

static tz_status copy_patch(filler *f, tz_vec2 from_corner, int32_t cell, tz_rng *r)
{
    const tz_element_set *from = f->from;
    const tz_vec2 to = {cell % f->nx * f->side.x, cell / f->nx * f->side.y};
    const frame p = frame_of(f, cell);
    const int32_t n = look_up(f, from_corner, reach_of(f, p));
    tz_status s = TZ_OK;
    tz_vec2 v;
    qsort(f->found, (size_t)n, sizeof *f->found, by_number);
    for (int32_t k = 0; k < n && s == TZ_OK; k++) {
        const int32_t i = f->found[k];
        if (in_patch(f, i, from_corner, p, &v))
            s = place(f, i, (tz_vec3){to.x + v.x, to.y + v.y, from->element.v[i].at.z},
                      r);
    }
    return s;
}

/* What stands beside a cell, as seen from its corner; a random choice if it is much. */
static int32_t look_beside(const filler *f, int32_t cell, double margin, tz_rng *r,
                           beside *out)
{
    const int32_t cx = cell % f->nx, cy = cell / f->nx;
    const tz_domain *d = &f->to->domain;
    const tz_vec3 middle = {(cx + 0.5) * f->side.x, (cy + 0.5) * f->side.y, 0};
    const frame p = frame_of(f, cell), back = {-p.turn, 1 / p.scale};
    int32_t seen = 0;
    margin *= p.scale;
    for (int32_t k = 0; k < 9; k++) {
        int32_t x = cx + k % 3 - 1, y = cy + k / 3 - 1;
        if (k == 4 || (!d->torus && (x < 0 || y < 0 || x >= f->nx || y >= f->ny)))
            continue;
        x = (x + f->nx) % f->nx, y = (y + f->ny) % f->ny;
        const int32_t c = y * f->nx + x;
        for (int32_t i = f->begin[c]; i < f->end[c]; i++) {
            const tz_element *e = &f->to->element.v[i];
            tz_vec3 v = tz_domain_vector(d, middle, e->at);
            v.x += 0.5 * f->side.x, v.y += 0.5 * f->side.y;
            if (v.x < -margin || v.y < -margin || v.x > f->side.x + margin ||
                v.y > f->side.y + margin)
                continue;
            const int32_t at = seen < BAND ? seen : tz_rng_below(r, seen + 1);
            if (!is_plain(p)) {
                const tz_vec2 q = turned(f, (tz_vec2){v.x, v.y}, back);
                v.x = q.x, v.y = q.y;
            }
            if (at < BAND)
                out[at] = (beside){v, e->angle - p.turn,
                                   e->radius / tz_domain_scale(d, e->at), e};
            seen++;
        }
    }
    return seen < BAND ? seen : BAND;
}

/* Squared distance of orientation and size, as in Eq. (1). Several samples show the
 * angle even where the class is said to have none. */
static double unlike(const filler *f, const tz_element *p, const beside *b)
{
    const double ds = p->radius - b->radius;
    if (!f->from->kind.v[p->kind].oriented && p->samples == 1)
        return f->attribute * ds * ds;
    const double x = p->radius * cos(p->angle) - b->radius * cos(b->angle);
    const double y = p->radius * sin(p->angle) - b->radius * sin(b->angle);
    return f->attribute * (x * x + y * y);
}

/* Mean squared distance from what stands beside the cell to the nearest of its class in
 * the exemplar about the patch; `limit` is the most that one can add. */
static double mismatch(const filler *f, tz_vec2 corner, const beside *v, int32_t n,
                       double limit)
{
    const tz_element_set *from = f->from;
    tz_nearby near[4];
    double sum = 0;
    int32_t known = 0;
    for (int32_t i = 0; i < n; i++) {
        const tz_vec3 p = {v[i].at.x + corner.x, v[i].at.y + corner.y, 0};
        if (!tz_domain_contains(&from->domain, p))
            continue; /* the exemplar does not say */
        const int32_t m =
            tz_cells_near(&f->source, f->source_at, p, sqrt(limit), -1, near, 4);
        double least = limit;
        for (int32_t k = 0; k < m; k++) {
            const tz_element *e = &from->element.v[near[k].id];
            if (e->kind == v[i].element->kind)
                least = fmin(least, (double)near[k].dist2 + unlike(f, e, &v[i]));
        }
        sum += least;
        known++;
    }
    return (sum + 0.25 * limit) / (known + 1); /* to know little is worth little */
}

/* Corner of a patch that brings a random thing of the exemplar to where one stands. */
static bool aligned(const filler *f, const beside *v, int32_t n, tz_vec2 reach, tz_rng *r,
                    tz_vec2 *corner)
{
    const tz_element_set *from = f->from;
    const tz_vec3 size = from->domain.size;
    const double slack = from->domain.torus ? INFINITY : 1e-9 * size.x;
    const tz_vec2 rest = {0.5 * (reach.x - f->side.x), 0.5 * (reach.y - f->side.y)};
    const beside *b = &v[tz_rng_below(r, n)];
    for (int32_t k = 0; k < 24; k++) {
        const tz_element *e = &from->element.v[tz_rng_below(r, from->element.n)];
        const tz_vec2 c = {e->at.x - b->at.x, e->at.y - b->at.y};
        if (e->kind != b->element->kind || c.x < rest.x - slack || c.y < rest.y - slack ||
            c.x > size.x - f->side.x - rest.x + slack ||
            c.y > size.y - f->side.y - rest.y + slack)
            continue;
        *corner = c;
        return true;
    }
    return false;
}

/* What fits best is often what is dense, since dense patches have something near
 * everything: the more elements there are too many (or few), the more a patch that adds
 * to that costs. In shares, so that 0 = as the exemplar. */
static double surplus(filler *f, tz_vec2 corner, int32_t cell, double share)
{
    const tz_vec3 size = f->from->domain.size;
    const frame p = frame_of(f, cell);
    const double average = f->from->element.n * f->side.x * f->side.y /
                           (size.x * size.y * p.scale * p.scale);
    const double excess = f->to->element.n - f->fixed_n - f->expected;
    const tz_vec2 to = {cell % f->nx * f->side.x, cell / f->nx * f->side.y};
    const int32_t n = look_up(f, corner, reach_of(f, p));
    int32_t here = 0;
    tz_vec2 v;
    for (int32_t k = 0; k < n; k++)
        here += in_patch(f, f->found[k], corner, p, &v) &&
                (share == 1 || tz_domain_contains(&f->to->domain,
                                                  (tz_vec3){to.x + v.x, to.y + v.y, 0}));
    /* the first cells say little */
    return excess / (f->expected + 10 * average) * (here - average * share) / average;
}

static tz_status fill_cell(filler *f, const tz_energy_params *p, int32_t cell)
{
    const double push = 1; /* of `surplus` against misfit */
    const tz_vec3 size = f->from->domain.size;
    const double spacing = tz_energy_spacing(f->from), limit = spacing * spacing;
    const double share = share_of(f, cell);
    const frame here = frame_of(f, cell);
    const tz_vec2 reach = reach_of(f, here);
    tz_rng r = tz_rng_make(p->seed, tz_rng_stream(STREAM_PATCH, (uint64_t)cell, 0));
    tz_vec2 best = {patch_begin(&r, size.x, f->side.x, reach.x, f->from->domain.torus),
                    patch_begin(&r, size.y, f->side.y, reach.y, f->from->domain.torus)};
    beside v[BAND];
    f->begin[cell] = f->end[cell] = f->to->element.n;
    if (share == 0)
        return TZ_OK;
    const int32_t n = f->tries > 1 ? look_beside(f, cell, 1.5 * spacing, &r, v) : 0;
    double least = n > 0 ? mismatch(f, best, v, n, limit) +
                               push * limit * surplus(f, best, cell, share)
                         : 0;
    for (int32_t k = 1; k < f->tries && n > 0; k++) {
        tz_vec2 corner;
        if (!aligned(f, v, n, reach, &r, &corner))
            continue;
        const double m = mismatch(f, corner, v, n, limit) +
                         push * limit * surplus(f, corner, cell, share);
        if (m < least)
            least = m, best = corner;
    }
    tz_status s = copy_patch(f, best, cell, &r);
    f->end[cell] = f->to->element.n;
    f->expected += share * f->density * f->side.x * f->side.y / (here.scale * here.scale);
    return s;
}

/* Cells in rows where each looks at those before it, else in random order. */
static void order_cells(int32_t *order, int32_t n, bool rows, uint64_t seed)
{
    tz_rng r = tz_rng_make(seed, tz_rng_stream(STREAM_PATCH, 0, 1));
    for (int32_t i = 0; i < n; i++) { /* shuffled as it is filled */
        const int32_t j = rows ? i : tz_rng_below(&r, i + 1);
        order[i] = order[j];
        order[j] = i;
    }
}

static tz_status index_exemplar(filler *f)
{
    const tz_element_set *from = f->from;
    const int32_t n = from->element.n;
    tz_status s = tz_alloc(f->ctx, &f->source_at, (size_t)n, sizeof *f->source_at);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &f->found, (size_t)n, sizeof *f->found);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        f->source_at[i] = from->element.v[i].at;
    return s == TZ_OK ? tz_cells_fill(f->ctx, &f->source, &from->domain, f->source_at, n,
                                      tz_energy_spacing(from))
                      : s;
}

static tz_status fill_patches(filler *f, const tz_energy_params *p, double patch)
{
    const tz_vec3 size = f->to->domain.size, whole = f->from->domain.size;
    /* a patch cannot be larger than what it is cut from, however it is turned */
    const tz_frames *frames = f->to->domain.frames;
    const double least = frames && frames->apart ? fmin(frames->apart_least, 1) : 1;
    const double part = frames ? sqrt(0.5) * least : 1;
    const tz_vec2 most = {part * whole.x, part * whole.y};
    const double nx = fmax(1, fmax(floor(size.x / patch + 0.5), ceil(size.x / most.x)));
    const double ny = fmax(1, fmax(floor(size.y / patch + 0.5), ceil(size.y / most.y)));
    int32_t *order = NULL;
    if (nx * ny > 1e8)
        return tz_fail(f->ctx, TZ_INVALID,
                       "patches of %g units make too many cells; take larger ones",
                       patch);
    f->side = (tz_vec2){size.x / nx, size.y / ny};
    f->nx = (int32_t)nx, f->ny = (int32_t)ny;
    f->tries = p->tries;
    f->attribute = p->attribute;
    f->density = tz_element_density(f->from, true);
    const int32_t n = f->nx * f->ny;
    tz_status s = index_exemplar(f);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &order, (size_t)n, sizeof *order);
    if (s == TZ_OK)
        s = tz_alloc_zero(f->ctx, &f->begin, (size_t)n, sizeof *f->begin);
    if (s == TZ_OK)
        s = tz_alloc_zero(f->ctx, &f->end, (size_t)n, sizeof *f->end);
    if (s == TZ_OK)
        order_cells(order, n, f->tries > 1, p->seed);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        s = tz_ctx_cancelled(f->ctx) ? TZ_CANCELLED : fill_cell(f, p, order[i]);
    tz_free(f->ctx, order);
    return s;
}

/* ---- white noise ----------------------------------------------------------------- */

static tz_status fill_noise(filler *f, const tz_energy_params *p)
{
    const tz_vec3 size = f->to->domain.size;
    const double spacing = tz_energy_spacing(f->from);
    /* as many as the densest place asks for; where it is less dense some are left out */
    const tz_domain *d = &f->to->domain;
    const double least = d->frames && d->frames->apart ? d->frames->apart_least : 1;
    const double room = spacing * spacing * least * least;
    const double count = floor(size.x * size.y / room + 0.5);
    tz_status s = TZ_OK;
    if (count > 1e8)
        return tz_fail(f->ctx, TZ_INVALID, "%g elements are too many; fill a part",
                       count);
    for (int32_t i = 0; i < (int32_t)count && s == TZ_OK; i++) {
        tz_rng r = tz_rng_make(p->seed, tz_rng_stream(STREAM_NOISE, (uint64_t)i, 0));
        const int32_t source = tz_rng_below(&r, f->from->element.n);
        const double x = tz_rng_unit(&r) * size.x, y = tz_rng_unit(&r) * size.y;
        const double scale = least / tz_domain_apart(d, (tz_vec3){x, y, 0});
        if (scale < 1 && tz_rng_unit(&r) > scale * scale)
            continue;
        s = tz_ctx_cancelled(f->ctx)
                ? TZ_CANCELLED
                : place(f, source, (tz_vec3){x, y, f->from->element.v[source].at.z}, &r);
    }
    return s;
}

tz_status tz_energy_fill(tz_ctx *ctx, const tz_element_set *exemplar,
                         const tz_energy_params *p, double patch, tz_element_set *output)
{
    filler f = {.ctx = ctx, .from = exemplar, .to = output};
    tz_status s = keep_fixed(output);
    if (s != TZ_OK)
        return s;
    f.fixed_n = output->element.n;
    f.apart = 0.6 * tz_energy_spacing(exemplar);
    if (f.fixed_n > 0) {
        s = tz_alloc(ctx, &f.fixed_at, (size_t)f.fixed_n, sizeof *f.fixed_at);
        for (int32_t i = 0; s == TZ_OK && i < f.fixed_n; i++)
            f.fixed_at[i] = output->element.v[i].at;
        if (s == TZ_OK)
            s = tz_cells_fill(ctx, &f.fixed, &output->domain, f.fixed_at, f.fixed_n,
                              f.apart);
    }
    if (s == TZ_OK)
        s = p->start == TZ_ENERGY_NOISE ? fill_noise(&f, p) : fill_patches(&f, p, patch);
    if (s == TZ_OK)
        s = tz_energy_substitute(output, exemplar, f.forbidden.v, f.forbidden.n, p->seed);
    tz_array_free(ctx, &f.forbidden);
    tz_cells_free(ctx, &f.fixed);
    tz_cells_free(ctx, &f.source);
    tz_free(ctx, f.fixed_at);
    tz_free(ctx, f.source_at);
    tz_free(ctx, f.found);
    tz_free(ctx, f.begin);
    tz_free(ctx, f.end);
    return s;
}
