/* SPDX-License-Identifier: Apache-2.0 */
/* The exemplar, ready to be quilted from: lines as dabs on a grid of half cells (so that
 * their number is bounded, however much is drawn in one spot), features (coverage by
 * direction and by pen, on coarse cells), and things: parts that hang together, small
 * against a patch, which are laid as a whole. */
#include <stdlib.h>
#include <string.h>

#include "curves/quilt_internal.h"

/* ---- spots and features ------------------------------------------------------------- */

void quilt_spot_add(quilt_cell *c, quilt_spot spot)
{
    for (int i = 0; i < QUILT_SPOTS; i++) {
        if (c->spot[i].pen == 0) {
            c->spot[i] = spot;
            return;
        }
        if (c->spot[i].pen == spot.pen &&
            abs((int8_t)(uint8_t)(c->spot[i].turn - spot.turn)) < 20)
            return; /* within 14 degrees */
    }
}

void quilt_feature_add(float *feature, int32_t w, int32_t h, tz_vec2 at, uint8_t turn,
                       uint8_t pen, float k)
{
    const double x = at.x - 0.5, y = at.y - 0.5, fx = floor(x), fy = floor(y);
    const float ax = (float)(x - fx), ay = (float)(y - fy);
    const int bin = turn >> 6, next = (bin + 1) & 3;
    const float over = (float)(turn & 63) / 64;
    /* pens are told apart by a number in -1 .. 1 */
    const float ink = (float)((pen * 157U) % 256U) / 127.5F - 1;
    for (int j = 0; j < 2; j++)
        for (int i = 0; i < 2; i++) {
            const double cx = fx + i, cy = fy + j;
            if (!(cx >= 0 && cy >= 0 && cx < w && cy < h))
                continue;
            float *f = feature + ((ptrdiff_t)cy * w + (ptrdiff_t)cx) * QUILT_CHANNELS;
            const float v = k * (i ? ax : 1 - ax) * (j ? ay : 1 - ay);
            f[bin] += v * (1 - over);
            f[next] += v * over;
            f[4] += v * ink;
        }
}

/* 1 2 1 both ways. */
void quilt_feature_blur(float *feature, float *scratch, int32_t w, int32_t h)
{
    for (int pass = 0; pass < 2; pass++) {
        const int32_t dx = pass == 0, dy = pass == 1;
        memcpy(scratch, feature,
               (size_t)w * (size_t)h * QUILT_CHANNELS * sizeof *scratch);
        for (int32_t y = 0; y < h; y++)
            for (int32_t x = 0; x < w; x++) {
                const bool lo = dx ? x > 0 : y > 0, hi = dx ? x < w - 1 : y < h - 1;
                const ptrdiff_t at = ((ptrdiff_t)y * w + x) * QUILT_CHANNELS,
                                by = ((ptrdiff_t)dy * w + dx) * QUILT_CHANNELS;
                for (int c = 0; c < QUILT_CHANNELS; c++)
                    feature[at + c] = 0.5F * scratch[at + c] +
                                      0.25F * ((lo ? scratch[at - by + c] : 0) +
                                               (hi ? scratch[at + by + c] : 0));
            }
    }
}

/* How far beyond what may be copied an unrolled torus goes on, of its side. */
#define THINGS_MOST 0.4

/* ---- measures ----------------------------------------------------------------------- */

static double length_of(const tz_curve_set *s)
{
    double sum = 0;
    for (int32_t i = 0; i < s->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(s, &s->piece.v[i]);
        sum += tz_bezier_length(&b);
    }
    return sum;
}

static tz_status measure_boxes(quilt_source *s)
{
    const tz_curve_set *set = s->set;
    tz_status st = tz_alloc(s->ctx, &s->box, 2 * (size_t)set->piece.n, sizeof *s->box);
    if (st == TZ_OK)
        st = tz_alloc_zero(s->ctx, &s->degree, (size_t)set->node.n, sizeof *s->degree);
    if (st != TZ_OK)
        return st;
    for (int32_t i = 0; i < set->piece.n; i++) {
        const tz_bezier b = tz_curve_bezier(set, &set->piece.v[i]);
        tz_vec2 lo = b.p[0], hi = b.p[0];
        for (int k = 1; k < 4; k++) {
            lo = (tz_vec2){fmin(lo.x, b.p[k].x), fmin(lo.y, b.p[k].y)};
            hi = (tz_vec2){fmax(hi.x, b.p[k].x), fmax(hi.y, b.p[k].y)};
        }
        s->box[2 * (ptrdiff_t)i] = lo;
        s->box[2 * (ptrdiff_t)i + 1] = hi;
        s->degree[set->piece.v[i].from]++;
        s->degree[set->piece.v[i].to]++;
    }
    return TZ_OK;
}

/* Cells that an exemplar is looked at in, at most. */
#define MOST_CELLS 4e6

/* A patch has eight cells a side at least, of its exemplar's. */
#define PATCH_LEAST (8.0 / 64)

/* What may be copied: the domain without empty margins wider than half the spacing. */
static void measure_border(quilt_source *s)
{
    const tz_vec3 size = s->set->domain.size;
    tz_vec2 lo = {INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY};
    for (int32_t i = 0; i < s->set->piece.n; i++) {
        lo.x = fmin(lo.x, s->box[2 * (ptrdiff_t)i].x);
        lo.y = fmin(lo.y, s->box[2 * (ptrdiff_t)i].y);
        hi.x = fmax(hi.x, s->box[2 * (ptrdiff_t)i + 1].x);
        hi.y = fmax(hi.y, s->box[2 * (ptrdiff_t)i + 1].y);
    }
    for (int32_t i = 0; i < s->set->element.element.n; i++) {
        const tz_element *e = &s->set->element.element.v[i];
        lo = (tz_vec2){fmin(lo.x, e->at.x - e->radius), fmin(lo.y, e->at.y - e->radius)};
        hi = (tz_vec2){fmax(hi.x, e->at.x + e->radius), fmax(hi.y, e->at.y + e->radius)};
    }
    const double length = length_of(s->set), most = fmin(size.x, size.y);
    s->spacing = fmin(size.x * size.y / fmax(length, 1e-9 * most), most);
    const double margin = s->spacing / 2;
    s->lo = (tz_vec2){fmin(fmax(0, lo.x - margin), 0.4 * size.x),
                      fmin(fmax(0, lo.y - margin), 0.4 * size.y)};
    s->hi = (tz_vec2){fmax(fmin(size.x, hi.x + margin), 0.6 * size.x),
                      fmax(fmin(size.y, hi.y + margin), 0.6 * size.y)};
    const double side = fmin(s->hi.x - s->lo.x, s->hi.y - s->lo.y);
    s->spacing =
        fmin((s->hi.x - s->lo.x) * (s->hi.y - s->lo.y) / fmax(length, 1e-9), side);
}

/* A torus has no border: a period may be copied, and what a patch is wide beyond it. */
static void measure_torus(quilt_source *s, double patch)
{
    const tz_vec3 size = s->original->domain.size;
    const double side = fmin(size.x, size.y);
    s->lo = (tz_vec2){THINGS_MOST * side, THINGS_MOST * side};
    s->hi = (tz_vec2){s->lo.x + size.x + patch, s->lo.y + size.y + patch};
    s->spacing = fmin(size.x * size.y / fmax(length_of(s->original), 1e-9 * side), side);
}

/* Side of the exemplar that all is measured by. */
static double side_of(const quilt_source *s)
{
    const tz_vec3 size = s->original->domain.size;
    return s->original->domain.torus ? fmin(size.x, size.y)
                                     : fmin(s->hi.x - s->lo.x, s->hi.y - s->lo.y);
}

static void measure(quilt_source *s, const tz_domain *domain,
                    const tz_curve_quilt_params *p)
{
    const double side = side_of(s);
    s->cell = fmin(fmax(s->spacing / 3.5, side / 128), side / 64);
    s->patch = (p->patch > 0 ? fmax(p->patch, PATCH_LEAST) : 0.5) * side;
    if (domain->torus) /* nothing may meet itself around it */
        s->patch = fmin(s->patch, 0.8 * fmin(domain->size.x, domain->size.y));
    s->coarse =
        fmax(fmin(fmax(s->spacing / 1.5, s->patch / 40), s->patch / 24), side / 160);
}

/* The cells of a strip of hundreds of its own widths would fill memory. */
static tz_status check_strip(const quilt_source *s)
{
    const tz_vec3 size = s->original->domain.size;
    const double area = (s->hi.x - s->lo.x) * (s->hi.y - s->lo.y);
    return area / (s->cell * s->cell) <= MOST_CELLS
               ? TZ_OK
               : tz_fail(s->ctx, TZ_LIMIT,
                         "a drawing of %g x %g is too long and thin; give a part of it",
                         size.x, size.y);
}

/* ---- things ------------------------------------------------------------------------- */

static int32_t root(int32_t *up, int32_t i)
{
    while (up[i] != i) {
        up[i] = up[up[i]];
        i = up[i];
    }
    return i;
}

typedef struct thing {
    tz_vec2 lo, hi;
    bool is;    /* small, and not cut by the border */
    bool cut;   /* small, but cut by the border: what is left of a thing */
    bool plain; /* strokes alone: nothing branches, nothing closes */
    int32_t id;
} thing;

/* Boxes of what hangs together: thing[root]. */
static void box_things(const quilt_source *s, int32_t *up, thing *t)
{
    const tz_curve_set *set = s->set;
    for (int32_t i = 0; i < set->node.n; i++)
        t[i] =
            (thing){{INFINITY, INFINITY}, {-INFINITY, -INFINITY}, false, false, true, -1};
    for (int32_t i = 0; i < set->piece.n; i++) {
        thing *b = &t[root(up, set->piece.v[i].from)];
        const tz_vec2 lo = s->box[2 * (ptrdiff_t)i], hi = s->box[2 * (ptrdiff_t)i + 1];
        b->lo = (tz_vec2){fmin(b->lo.x, lo.x), fmin(b->lo.y, lo.y)};
        b->hi = (tz_vec2){fmax(b->hi.x, hi.x), fmax(b->hi.y, hi.y)};
        b->id = 0;
        b->plain = b->plain && s->degree[set->piece.v[i].from] < 3 &&
                   s->degree[set->piece.v[i].to] < 3;
    }
    for (int32_t i = 0; i < set->path.n; i++)
        if (set->path.v[i].closed)
            t[root(up, set->piece.v[set->path.v[i].piece].from)].plain = false;
    const double rim = s->cell / 4;
    for (int32_t i = 0; i < set->node.n; i++) {
        const double most = t[i].plain ? fmax(s->largest, 0.5 * s->patch) : s->largest;
        const bool small =
            t[i].id == 0 && t[i].hi.x - t[i].lo.x < most && t[i].hi.y - t[i].lo.y < most;
        const bool whole = t[i].lo.x > rim && t[i].lo.y > rim &&
                           t[i].hi.x < set->domain.size.x - rim &&
                           t[i].hi.y < set->domain.size.y - rim;
        t[i].is = small && whole;
        t[i].cut = small && !whole && s->loops && !s->original->domain.torus;
    }
}

/* Things that lie within others, as circles, are one with them (a wheel and its spokes).
 * */
static tz_status merge_things(quilt_source *s, int32_t *up, thing *t)
{
    enum { MOST = 256 };
    tz_grid grid;
    int32_t near[MOST], id;
    const int32_t n = s->set->node.n;
    TZ_ARRAY(int32_t)
    of = {0};
    double reach = 0;
    for (int32_t i = 0; i < n; i++)
        if (t[i].is || t[i].cut)
            reach = fmax(reach, fmax(t[i].hi.x - t[i].lo.x, t[i].hi.y - t[i].lo.y));
    if (reach == 0)
        return TZ_OK;
    tz_status st =
        tz_grid_init(s->ctx, &grid, s->lo, tz_vec2_sub(s->hi, s->lo), reach, false);
    for (int32_t i = 0; i < n && st == TZ_OK; i++)
        if ((t[i].is || t[i].cut) && root(up, i) == i) {
            st = tz_grid_add(s->ctx, &grid,
                             tz_vec2_scale(tz_vec2_add(t[i].lo, t[i].hi), 0.5), &id);
            if (st == TZ_OK)
                st = tz_array_push(s->ctx, &of, i);
        }
    for (int32_t k = 0; k < of.n && st == TZ_OK; k++) {
        const thing *a = &t[of.v[k]];
        const tz_vec2 mid = tz_vec2_scale(tz_vec2_add(a->lo, a->hi), 0.5);
        const double far = hypot(a->hi.x - a->lo.x, a->hi.y - a->lo.y) / 2;
        const int32_t m = tz_grid_query(&grid, mid, far, near, MOST);
        for (int32_t j = 0; j < (m < MOST ? m : MOST); j++) {
            const thing *b = &t[of.v[near[j]]];
            const tz_vec2 to = tz_vec2_scale(tz_vec2_add(b->lo, b->hi), 0.5);
            const double ra = fmax(a->hi.x - a->lo.x, a->hi.y - a->lo.y) / 2,
                         rb = fmax(b->hi.x - b->lo.x, b->hi.y - b->lo.y) / 2,
                         apart = tz_vec2_length(tz_vec2_sub(to, mid));
            if (apart + fmin(ra, rb) <= 1.05 * fmax(ra, rb)) {
                const int32_t p = root(up, of.v[k]), q = root(up, of.v[near[j]]);
                up[p > q ? p : q] = p > q ? q : p;
            }
        }
    }
    tz_array_free(s->ctx, &of);
    tz_grid_deinit(s->ctx, &grid);
    return st;
}

/* Loops by themselves are things even if they are large, where most of the drawing is of
 * that sort (wheels, not hills with contour lines). What the border has left of a thing
 * is then not laid at all. */
static bool made_of_loops(const quilt_source *s)
{
    double closed = 0, all = 0;
    for (int32_t i = 0; i < s->set->path.n; i++) {
        const tz_curve_path *p = &s->set->path.v[i];
        for (int32_t k = p->piece; k < p->piece + p->pieces; k++) {
            const tz_bezier b = tz_curve_bezier(s->set, &s->set->piece.v[k]);
            const double n = tz_bezier_length(&b);
            all += n;
            closed += p->closed ? n : 0;
        }
    }
    return closed > 0.6 * all;
}

static tz_status find_things(quilt_source *s)
{
    const tz_curve_set *set = s->set;
    int32_t *up = NULL;
    thing *t = NULL;
    tz_status st = tz_alloc(s->ctx, &up, (size_t)set->node.n, sizeof *up);
    if (st == TZ_OK)
        st = tz_alloc(s->ctx, &t, (size_t)set->node.n, sizeof *t);
    if (st == TZ_OK)
        st = tz_alloc(s->ctx, &s->object, (size_t)set->path.n, sizeof *s->object);
    if (st == TZ_OK)
        st = tz_alloc_zero(s->ctx, &s->centre, (size_t)set->node.n, sizeof *s->centre);
    if (st != TZ_OK)
        goto done;
    s->loops = made_of_loops(s);
    s->largest = (s->loops ? 0.75 : 0.3) * s->patch;
    for (int32_t i = 0; i < set->node.n; i++)
        up[i] = i;
    for (int32_t i = 0; i < set->piece.n; i++) {
        const int32_t p = root(up, set->piece.v[i].from),
                      q = root(up, set->piece.v[i].to);
        up[p > q ? p : q] = p > q ? q : p;
    }
    box_things(s, up, t);
    st = merge_things(s, up, t);
    if (st != TZ_OK)
        goto done;
    box_things(s, up, t);
    for (int32_t i = 0; i < set->path.n; i++) {
        thing *a = &t[root(up, set->piece.v[set->path.v[i].piece].from)];
        s->object[i] = a->cut ? QUILT_REST : -1;
        if (!a->is)
            continue;
        if (a->id == 0) {
            s->centre[s->objects] = tz_vec2_scale(tz_vec2_add(a->lo, a->hi), 0.5);
            s->broad = fmax(s->broad, fmax(a->hi.x - a->lo.x, a->hi.y - a->lo.y));
            a->id = ++s->objects;
        }
        s->object[i] = a->id - 1;
    }
done:
    tz_free(s->ctx, up);
    tz_free(s->ctx, t);
    return st;
}

/* ---- dabs --------------------------------------------------------------------------- */

static tz_status push_dab(quilt_source *s, quilt_cell *fine, int32_t w, int32_t h,
                          quilt_dab d)
{
    const double x = (d.at.x - s->lo.x) / (s->cell / 2),
                 y = (d.at.y - s->lo.y) / (s->cell / 2);
    if (!(x >= 0 && y >= 0 && x < w && y < h))
        return TZ_OK;
    quilt_cell *c = &fine[(ptrdiff_t)y * w + (ptrdiff_t)x];
    const uint8_t last = c->spot[QUILT_SPOTS - 1].pen;
    int before = 0, after = 0;
    for (int i = 0; i < QUILT_SPOTS; i++)
        before += c->spot[i].pen != 0;
    if (last)
        return TZ_OK;
    quilt_spot_add(c, (quilt_spot){0, 0, d.turn, d.pen});
    for (int i = 0; i < QUILT_SPOTS; i++)
        after += c->spot[i].pen != 0;
    return after > before ? tz_array_push(s->ctx, &s->dab, d) : TZ_OK;
}

static uint8_t turn_of(tz_vec2 d)
{
    double a = atan2(d.y, d.x) / TZ_PI * 256;
    a -= floor(a / 256) * 256;
    return (uint8_t)((int32_t)a & 255);
}

static tz_status make_dabs(quilt_source *s)
{
    enum { MOST = 8192 };
    const tz_curve_set *set = s->set;
    const int32_t w = (int32_t)((s->hi.x - s->lo.x) / (s->cell / 2)) + 1,
                  h = (int32_t)((s->hi.y - s->lo.y) / (s->cell / 2)) + 1;
    quilt_cell *fine = NULL;
    double sum = 0, rest = 0;
    tz_status st = tz_alloc_zero(s->ctx, &fine, (size_t)w * (size_t)h, sizeof *fine);
    for (int32_t i = 0; i < set->path.n && st == TZ_OK; i++) {
        const tz_curve_path *p = &set->path.v[i];
        const uint8_t pen = (uint8_t)(p->pen < 254 ? p->pen + 1 : 255);
        for (int32_t k = p->piece; k < p->piece + p->pieces && st == TZ_OK; k++) {
            const tz_bezier b = tz_curve_bezier(set, &set->piece.v[k]);
            const double length = tz_bezier_length(&b);
            const double n = fmin(ceil(length / (s->cell / 3)), MOST);
            sum += length;
            if (s->object[i] == QUILT_REST) {
                rest += length;
                continue;
            }
            for (int32_t j = 0; j < n && st == TZ_OK; j++) {
                const double t = (j + 0.5) / n;
                st = push_dab(s, fine, w, h,
                              (quilt_dab){tz_bezier_at(&b, t),
                                          turn_of(tz_bezier_slope(&b, t)), pen});
            }
        }
    }
    s->rest = sum > 0 ? fmin(0.7, rest / sum) : 0;
    tz_free(s->ctx, fine);
    return st;
}

/* Coverage summed from the corner, and spots a cell. */
static tz_status measure_density(quilt_source *s)
{
    const tz_vec2 hi = s->original->domain.torus
                           ? tz_vec2_add(s->lo, (tz_vec2){s->original->domain.size.x,
                                                          s->original->domain.size.y})
                           : s->hi;
    const int32_t w = (int32_t)((hi.x - s->lo.x) / s->cell) + 1,
                  h = (int32_t)((hi.y - s->lo.y) / s->cell) + 1, fw = s->fx + 1;
    quilt_cell *cell = NULL;
    int64_t spots = 0;
    tz_status st = tz_alloc_zero(s->ctx, &cell, (size_t)w * (size_t)h, sizeof *cell);
    if (st == TZ_OK)
        st = tz_alloc_zero(s->ctx, &s->cover, (size_t)fw * (size_t)(s->fy + 1),
                           sizeof *s->cover);
    if (st != TZ_OK)
        goto done;
    for (int32_t i = 0; i < s->dab.n; i++) {
        const quilt_dab *d = &s->dab.v[i];
        if (d->at.x >= hi.x || d->at.y >= hi.y)
            continue;
        quilt_spot_add(&cell[(ptrdiff_t)((d->at.y - s->lo.y) / s->cell) * w +
                             (ptrdiff_t)((d->at.x - s->lo.x) / s->cell)],
                       (quilt_spot){0, 0, d->turn, d->pen});
    }
    for (ptrdiff_t i = 0; i < (ptrdiff_t)w * h; i++)
        for (int k = 0; k < QUILT_SPOTS; k++)
            spots += cell[i].spot[k].pen != 0;
    s->density = (double)spots / (1 - s->rest) /
                 ((hi.x - s->lo.x) * (hi.y - s->lo.y) / (s->cell * s->cell));
    for (int32_t y = 0; y < s->fy; y++) {
        double row = 0;
        for (int32_t x = 0; x < s->fx; x++) {
            for (int c = 0; c < 4; c++)
                row +=
                    (double)s->feature[((ptrdiff_t)y * s->fx + x) * QUILT_CHANNELS + c];
            s->cover[(ptrdiff_t)(y + 1) * fw + x + 1] =
                row + s->cover[(ptrdiff_t)y * fw + x + 1];
        }
    }
done:
    tz_free(s->ctx, cell);
    return st;
}

static int32_t bin_of(const quilt_source *s, tz_vec2 p)
{
    const int32_t x = (int32_t)((p.x - s->lo.x) / s->coarse),
                  y = (int32_t)((p.y - s->lo.y) / s->coarse);
    return (y < s->by ? y : s->by - 1) * s->bx + (x < s->bx ? x : s->bx - 1);
}

/* Dabs by bin; their order within a bin stays. */
static tz_status sort_dabs(quilt_source *s)
{
    quilt_dab *to = NULL;
    s->bx = s->fx;
    s->by = s->fy;
    const size_t bins = (size_t)s->bx * (size_t)s->by;
    tz_status st = tz_alloc_zero(s->ctx, &s->bin, bins + 2, sizeof *s->bin);
    if (st == TZ_OK)
        st = tz_alloc(s->ctx, &to, (size_t)s->dab.n, sizeof *to);
    if (st != TZ_OK)
        return st;
    for (int32_t i = 0; i < s->dab.n; i++)
        s->bin[bin_of(s, s->dab.v[i].at) + 2]++;
    for (size_t i = 2; i < bins + 2; i++)
        s->bin[i] += s->bin[i - 1];
    for (int32_t i = 0; i < s->dab.n; i++)
        to[s->bin[bin_of(s, s->dab.v[i].at) + 1]++] = s->dab.v[i];
    tz_free(s->ctx, s->dab.v);
    s->dab.v = to;
    s->dab.cap = s->dab.n;
    return TZ_OK;
}

static tz_status make_features(quilt_source *s)
{
    float *scratch = NULL;
    s->fx = (int32_t)fmax(1, ceil((s->hi.x - s->lo.x) / s->coarse - 0.01));
    s->fy = (int32_t)fmax(1, ceil((s->hi.y - s->lo.y) / s->coarse - 0.01));
    const size_t n = (size_t)s->fx * (size_t)s->fy;
    tz_status st =
        tz_alloc_zero(s->ctx, &s->feature, n * QUILT_CHANNELS, sizeof *s->feature);
    if (st == TZ_OK)
        st = tz_alloc(s->ctx, &scratch, n * QUILT_CHANNELS, sizeof *scratch);
    if (st == TZ_OK)
        st = tz_alloc(s->ctx, &s->valid, n, sizeof *s->valid);
    if (st != TZ_OK)
        goto done;
    for (int32_t i = 0; i < s->dab.n; i++) {
        const quilt_dab *d = &s->dab.v[i];
        const tz_vec2 at = {(d->at.x - s->lo.x) / s->coarse,
                            (d->at.y - s->lo.y) / s->coarse};
        quilt_feature_add(s->feature, s->fx, s->fy, at, d->turn, d->pen,
                          (float)(s->cell / 2 / s->coarse));
    }
    quilt_feature_blur(s->feature, scratch, s->fx, s->fy);
    for (int32_t y = 0; y < s->fy; y++)
        for (int32_t x = 0; x < s->fx; x++) {
            const tz_vec3 at = {s->lo.x + (x + 0.5) * s->coarse,
                                s->lo.y + (y + 0.5) * s->coarse, 0};
            const tz_region *r = s->set->domain.region;
            s->valid[(ptrdiff_t)y * s->fx + x] =
                !r || tz_region_distance(r, at) > -s->coarse / 2;
        }
done:
    tz_free(s->ctx, scratch);
    return st;
}

double quilt_width_at(const quilt_source *s, int32_t piece, double t)
{
    const tz_curve_taper w = s->set->taper.v[piece];
    const tz_bezier b = tz_curve_bezier(s->set, &s->set->piece.v[piece]),
                    part = tz_bezier_part(&b, 0, t);
    const double all = tz_bezier_length(&b),
                 k = all > 0 ? tz_bezier_length(&part) / all : t;
    return w.from + k * (w.to - w.from);
}

/* Small loops (rings at the ends of lines) keep their shape: their nodes move as their
 * centre does. */
static tz_status find_rigid(quilt_source *s)
{
    const tz_curve_set *set = s->set;
    tz_status st = tz_alloc(s->ctx, &s->anchor, (size_t)set->node.n, sizeof *s->anchor);
    if (st == TZ_OK)
        st = tz_alloc_zero(s->ctx, &s->rigid, (size_t)set->path.n, sizeof *s->rigid);
    if (st != TZ_OK)
        return st;
    memcpy(s->anchor, set->node.v, (size_t)set->node.n * sizeof *s->anchor);
    for (int32_t i = 0; i < set->path.n; i++) {
        const tz_curve_path *p = &set->path.v[i];
        tz_vec2 lo = {INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY};
        for (int32_t k = p->piece; k < p->piece + p->pieces; k++) {
            const tz_vec2 *b = &s->box[2 * (ptrdiff_t)k];
            lo = (tz_vec2){fmin(lo.x, b[0].x), fmin(lo.y, b[0].y)};
            hi = (tz_vec2){fmax(hi.x, b[1].x), fmax(hi.y, b[1].y)};
        }
        s->rigid[i] = p->closed && fmax(hi.x - lo.x, hi.y - lo.y) < 1.5 * s->spacing;
        for (int32_t k = p->piece; k < p->piece + p->pieces && s->rigid[i]; k++)
            s->anchor[set->piece.v[k].from] = s->anchor[set->piece.v[k].to] =
                tz_vec2_scale(tz_vec2_add(lo, hi), 0.5);
    }
    return TZ_OK;
}

tz_status quilt_source_init(tz_ctx *ctx, const tz_curve_set *set, const tz_domain *domain,
                            const tz_curve_quilt_params *p, quilt_source *s)
{
    *s = (quilt_source){.ctx = ctx, .set = set, .original = set};
    tz_status st = TZ_OK;
    if (set->domain.torus) {
        measure_torus(s, (p->patch > 0 ? p->patch : 0.5) * side_of(s));
        st = quilt_unroll(ctx, set, tz_vec2_add(s->hi, s->lo), &s->unrolled, &s->origin);
        s->set = &s->unrolled;
    }
    if (st == TZ_OK)
        st = measure_boxes(s);
    if (st == TZ_OK) {
        if (!set->domain.torus)
            measure_border(s);
        measure(s, domain, p);
        st = check_strip(s);
    }
    if (st == TZ_OK)
        st = find_things(s);
    if (st == TZ_OK)
        st = find_rigid(s);
    if (st == TZ_OK)
        st = make_dabs(s);
    if (st == TZ_OK)
        st = make_features(s);
    if (st == TZ_OK)
        st = measure_density(s);
    if (st == TZ_OK)
        st = sort_dabs(s);
    if (st != TZ_OK)
        quilt_source_deinit(s);
    return st;
}

void quilt_source_deinit(quilt_source *s)
{
    tz_array_free(s->ctx, &s->dab);
    tz_free(s->ctx, s->bin);
    tz_free(s->ctx, s->feature);
    tz_free(s->ctx, s->valid);
    tz_free(s->ctx, s->cover);
    tz_free(s->ctx, s->object);
    tz_free(s->ctx, s->centre);
    tz_free(s->ctx, s->anchor);
    tz_free(s->ctx, s->rigid);
    tz_free(s->ctx, s->degree);
    tz_free(s->ctx, s->box);
    tz_free(s->ctx, s->origin);
    tz_curve_set_deinit(&s->unrolled);
    memset(s, 0, sizeof *s);
}
