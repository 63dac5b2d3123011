/* SPDX-License-Identifier: Apache-2.0 */
/* One patch for one place: all shifts are compared by features, where something lies
 * already; the best few are shifted exactly, so that their lines meet those that lie there
 * (least squares of distances across the lines), and cut in; the cheapest seam wins.
 * @source Kwatra et al. 2003, Sec. 3, entire and sub-patch matching. Deviates: what is
 *   compared are lines, by place, direction and pen */
#include <stdlib.h>
#include <string.h>

#include "curves/quilt_internal.h"

/* Lines this near to each other may be one: cells across and along, 256 = pi. */
#define ACROSS_MOST 2.0F
#define ALONG_MOST  1.3F
enum { TURN_MOST = 43 };
/* What a step of the seam costs beside lines that agree: so that it crosses them, and does
 * not run along them, where one copy may fall on either side. */
#define QUILT_ALONG 0.1F

/* ---- window ------------------------------------------------------------------------- */

tz_status quilt_window_init(tz_ctx *ctx, const quilt_source *s, const quilt_map *m,
                            tz_vec2 side, quilt_window *w)
{
    const double d = m->domain->frames ? hypot(side.x, side.y) : 0;
    const double nx = fmin(m->nx, ceil(fmax(d, side.x) / m->cx) + 2),
                 ny = fmin(m->ny, ceil(fmax(d, side.y) / m->cy) + 2);
    const size_t n = (size_t)nx * (size_t)ny, rim = (size_t)(nx + 4) * (size_t)(ny + 4),
                 shifts = (size_t)s->fx * (size_t)s->fy;
    *w = (quilt_window){.ctx = ctx, .most = (int32_t)n};
    for (int i = 0; i < 384; i++)
        w->wave[i] = (float)sin(i * TZ_PI / 256);
    w->most_coarse = (int32_t)((side.x / s->coarse + 2) * (side.y / s->coarse + 2));
    const size_t c = (size_t)w->most_coarse;
    tz_status st = tz_alloc(ctx, &w->fresh, rim, sizeof *w->fresh);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &w->kept, rim, sizeof *w->kept);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &w->old, rim, sizeof *w->old);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &w->off, n, sizeof *w->off);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &w->state, 2 * n, 1);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &w->side, n, 1);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &w->best, n, 1);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &w->score, shifts, sizeof *w->score);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &w->feature, 2 * c * QUILT_CHANNELS, sizeof *w->feature);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &w->weight, c, sizeof *w->weight);
    if (st == TZ_OK && !(w->flow = quilt_flow_new(ctx, (int32_t)((nx + 2) * (ny + 2)))))
        st = TZ_NOMEM;
    if (st != TZ_OK)
        quilt_window_deinit(w);
    return st;
}

void quilt_window_deinit(quilt_window *w)
{
    tz_free(w->ctx, w->fresh);
    tz_free(w->ctx, w->kept);
    tz_free(w->ctx, w->old);
    tz_free(w->ctx, w->off);
    tz_free(w->ctx, w->state);
    tz_free(w->ctx, w->side);
    tz_free(w->ctx, w->best);
    tz_free(w->ctx, w->score);
    tz_free(w->ctx, w->feature);
    tz_free(w->ctx, w->weight);
    quilt_flow_free(w->ctx, w->flow);
    memset(w, 0, sizeof *w);
}

/* Index in the map of a cell of the window (or beside it); -1 = outside the domain. */
static ptrdiff_t cell_at(const quilt_map *m, const quilt_window *w, int32_t i, int32_t j)
{
    int32_t x = w->x + i, y = w->y + j;
    if (m->domain->torus) {
        x = (x % m->nx + m->nx) % m->nx;
        y = (y % m->ny + m->ny) % m->ny;
    } else if (x < 0 || y < 0 || x >= m->nx || y >= m->ny) {
        return -1;
    }
    return (ptrdiff_t)y * m->nx + x;
}

/* Index of a cell in the arrays with a rim. */
static ptrdiff_t rimmed(const quilt_window *w, int32_t i, int32_t j)
{
    return (ptrdiff_t)(j + 2) * (w->w + 4) + i + 2;
}

static size_t rimmed_size(const quilt_window *w)
{
    return (size_t)(w->w + 4) * (size_t)(w->h + 4) * sizeof *w->fresh;
}

static tz_vec2 centre_of(const quilt_map *m, const quilt_window *w, int32_t i, int32_t j)
{
    return (tz_vec2){(w->x + i + 0.5) * m->cx, (w->y + j + 0.5) * m->cy};
}

static bool in_window(const quilt_patch *p, tz_vec2 at)
{
    const tz_vec2 u = quilt_unturn(p, tz_vec2_sub(at, p->to));
    return fabs(u.x) <= p->half.x && fabs(u.y) <= p->half.y;
}

/* Bounds of the window; states of its cells, whatever the candidate. */
static void open_window(const quilt_map *m, const quilt_place *place,
                        const quilt_patch *p, quilt_window *w)
{
    const double hx = fabs(p->c) * p->half.x + fabs(p->s) * p->half.y,
                 hy = fabs(p->s) * p->half.x + fabs(p->c) * p->half.y;
    int32_t x1 = (int32_t)ceil((p->to.x + hx) / m->cx),
            y1 = (int32_t)ceil((p->to.y + hy) / m->cy);
    w->x = (int32_t)floor((p->to.x - hx) / m->cx);
    w->y = (int32_t)floor((p->to.y - hy) / m->cy);
    if (!m->domain->torus) {
        w->x = w->x > 0 ? w->x : 0;
        w->y = w->y > 0 ? w->y : 0;
        x1 = x1 < m->nx ? x1 : m->nx;
        y1 = y1 < m->ny ? y1 : m->ny;
    }
    w->w = x1 - w->x < m->nx ? x1 - w->x : m->nx;
    w->h = y1 - w->y < m->ny ? y1 - w->y : m->ny;
    if (w->w < 0 || w->h < 0)
        w->w = w->h = 0;
    while ((int64_t)w->w * w->h > w->most)
        w->h--;
    memset(w->old, 0, rimmed_size(w));
    for (int32_t j = -2; j < w->h + 2; j++)
        for (int32_t i = -2; i < w->w + 2; i++) {
            const ptrdiff_t at = cell_at(m, w, i, j);
            if (at >= 0 && m->label[at] != QUILT_NONE)
                w->old[rimmed(w, i, j)] = m->cell[at];
        }
    for (int32_t j = 0; j < w->h; j++)
        for (int32_t i = 0; i < w->w; i++) {
            static const int8_t step[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
            const ptrdiff_t at = cell_at(m, w, i, j);
            const tz_vec2 c = centre_of(m, w, i, j);
            uint8_t *to = &w->state[(ptrdiff_t)j * w->w + i];
            *to = QUILT_BLOCKED;
            if (at < 0 || m->closed[at] || !in_window(p, c))
                continue;
            *to = m->label[at] == QUILT_NONE    ? QUILT_FRESH
                  : m->label[at] == QUILT_GIVEN ? QUILT_OLD
                                                : QUILT_FREE;
            for (int d = 0; d < 4 && *to == QUILT_FREE; d++) {
                const ptrdiff_t b = cell_at(m, w, i + step[d][0], j + step[d][1]);
                if (b >= 0 && !m->closed[b] && m->label[b] != QUILT_NONE &&
                    !in_window(p, centre_of(m, w, i + step[d][0], j + step[d][1])))
                    *to = QUILT_OLD;
            }
            const tz_vec2 v = tz_vec2_sub(c, place->at);
            if (place->core > 0 && *to == QUILT_FREE &&
                tz_vec2_dot(v, v) < place->core * place->core)
                *to = QUILT_FRESH;
        }
}

/* ---- candidates --------------------------------------------------------------------- */

static tz_vec2 spot_at(const quilt_map *m, const quilt_window *w, int32_t i, int32_t j,
                       quilt_spot s)
{
    return (tz_vec2){(w->x + i + (s.x + 0.5) / 256) * m->cx,
                     (w->y + j + (s.y + 0.5) / 256) * m->cy};
}

/* Direction of a line, seen from the patch (sign -1) or from the domain (1). */
static uint8_t turned(uint8_t turn, const quilt_patch *p, int sign)
{
    double a = turn + sign * p->angle / TZ_PI * 256;
    a -= floor(a / 256) * 256;
    return (uint8_t)((int32_t)(a + 0.5) & 255);
}

/* Features of what lies in the window, in the axes of the exemplar. Sum of weights. */
static double read_features(const quilt_source *s, const quilt_map *m,
                            const quilt_patch *p, quilt_window *w, int32_t cw, int32_t ch)
{
    const size_t n = (size_t)cw * (size_t)ch;
    const float area = (float)(m->cx * m->cy / (s->coarse * s->coarse));
    memset(w->feature, 0, n * QUILT_CHANNELS * sizeof *w->feature);
    memset(w->weight, 0, n * sizeof *w->weight);
    for (int32_t j = 0; j < w->h; j++)
        for (int32_t i = 0; i < w->w; i++) {
            const ptrdiff_t at = cell_at(m, w, i, j);
            if (at < 0 || w->state[(ptrdiff_t)j * w->w + i] == QUILT_BLOCKED ||
                m->label[at] == QUILT_NONE)
                continue;
            const tz_vec2 u = quilt_unturn(p, tz_vec2_sub(centre_of(m, w, i, j), p->to));
            const double x = (u.x + p->half.x) / s->coarse,
                         y = (u.y + p->half.y) / s->coarse;
            if (x >= 0 && y >= 0 && x < cw && y < ch)
                w->weight[(ptrdiff_t)y * cw + (ptrdiff_t)x] += area;
            for (int k = 0; k < QUILT_SPOTS && m->cell[at].spot[k].pen; k++) {
                const quilt_spot q = m->cell[at].spot[k];
                const tz_vec2 v =
                    quilt_unturn(p, tz_vec2_sub(spot_at(m, w, i, j, q), p->to));
                quilt_feature_add(w->feature, cw, ch,
                                  (tz_vec2){(v.x + p->half.x) / s->coarse,
                                            (v.y + p->half.y) / s->coarse},
                                  turned(q.turn, p, -1), q.pen,
                                  (float)(m->cx / s->coarse));
            }
        }
    quilt_feature_blur(w->feature, w->feature + n * QUILT_CHANNELS, cw, ch);
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        w->weight[i] = w->weight[i] > 0.8F ? 1 : 0;
        sum += (double)w->weight[i];
    }
    return sum;
}

static float shift_score(const quilt_source *s, const quilt_window *w, int32_t cw,
                         int32_t ch, int32_t ox, int32_t oy)
{
    float sum = 0;
    for (int32_t y = 0; y < ch; y++)
        for (int32_t x = 0; x < cw; x++) {
            const ptrdiff_t i = (ptrdiff_t)y * cw + x,
                            j = (ptrdiff_t)(y + oy) * s->fx + x + ox;
            if (!s->valid[j]) {
                sum += w->weight[i] > 0 ? 0.5F : 0.2F;
                continue;
            }
            if (w->weight[i] == 0)
                continue;
            const float *a = w->feature + i * QUILT_CHANNELS,
                        *b = s->feature + j * QUILT_CHANNELS;
            for (int c = 0; c < QUILT_CHANNELS; c++)
                sum += (a[c] - b[c]) * (a[c] - b[c]);
        }
    return sum;
}

/* Between places of the exemplar; around a torus the short way. */
static tz_vec2 least_shift(const quilt_source *s, tz_vec2 v)
{
    const tz_vec3 size = s->original->domain.size;
    if (s->original->domain.torus)
        v = (tz_vec2){v.x - size.x * round(v.x / size.x),
                      v.y - size.y * round(v.y / size.y)};
    return v;
}

/* Patches that a source is compared with: those about the place. */
static void list_near(const quilt_source *s, const quilt_map *m, const quilt_place *place,
                      quilt_window *w)
{
    const tz_vec3 size = s->original->domain.size;
    const double reach =
        s->original->domain.torus ? 1.6 * fmax(size.x, size.y) : 1.2 * s->patch;
    w->nears = 0;
    for (int32_t i = place->seen - 1; i >= 0; i--) {
        const quilt_patch *q = &m->patch.v[i];
        const tz_vec3 v = tz_domain_vector(m->domain, (tz_vec3){q->to.x, q->to.y, 0},
                                           (tz_vec3){place->at.x, place->at.y, 0});
        if (fabs(v.x) < reach && fabs(v.y) < reach && hypot(v.x, v.y) < reach &&
            w->nears < (int32_t)(sizeof w->near / sizeof *w->near))
            w->near[w->nears++] = i;
    }
}

/* Whether a source would go on where a patch as far away as the exemplar is wide has begun:
 * around a torus that has no end, and would repeat the exemplar as it is. */
static bool goes_on(const quilt_source *s, const quilt_map *m, const quilt_place *place,
                    const quilt_window *w, tz_vec2 from)
{
    const tz_vec3 size = s->original->domain.size;
    const double far = 0.6 * fmax(size.x, size.y), farther = 1.6 * fmax(size.x, size.y);
    if (!s->original->domain.torus)
        return false;
    for (int32_t i = 0; i < w->nears; i++) {
        const quilt_patch *q = &m->patch.v[w->near[i]];
        const tz_vec3 v = tz_domain_vector(m->domain, (tz_vec3){q->to.x, q->to.y, 0},
                                           (tz_vec3){place->at.x, place->at.y, 0});
        const double d = hypot(v.x, v.y);
        if (!(q->half.x > 0) || d < far || d > farther)
            continue;
        const tz_vec2 e =
            least_shift(s, tz_vec2_sub(tz_vec2_sub(from, q->from),
                                       quilt_unturn(q, (tz_vec2){v.x, v.y})));
        if (tz_vec2_length(e) < 0.1 * s->patch)
            return true;
    }
    return false;
}

/* How much a source is to be avoided: patches near by took theirs from there. */
static double repeats(const quilt_source *s, const quilt_map *m, const quilt_place *place,
                      const quilt_window *w, tz_vec2 from)
{
    double k = 1;
    const double near = 1.2 * s->patch, same = 0.3 * s->patch;
    for (int32_t i = 0; i < w->nears; i++) {
        const quilt_patch *q = &m->patch.v[w->near[i]];
        const tz_vec3 v = tz_domain_vector(m->domain, (tz_vec3){q->to.x, q->to.y, 0},
                                           (tz_vec3){place->at.x, place->at.y, 0});
        if (v.x * v.x + v.y * v.y > near * near)
            continue;
        const tz_vec2 d = least_shift(s, tz_vec2_sub(from, q->from)),
                      e = least_shift(
                          s, tz_vec2_sub(d, quilt_unturn(q, (tz_vec2){v.x, v.y})));
        if (tz_vec2_dot(d, d) < same * same && tz_vec2_length(e) > 0.1 * s->patch)
            k += 0.5 * (1 - tz_vec2_length(d) / same);
    }
    return k;
}

typedef struct shift {
    float score;
    int32_t x, y;
} shift;

/* The best shifts, no two next to each other. */
static int32_t best_shifts(const quilt_window *w, int32_t nx, int32_t ny, int32_t most,
                           shift *out)
{
    int32_t n = 0;
    for (; n < most; n++) {
        shift best = {INFINITY, -1, -1};
        for (int32_t y = 0; y < ny; y++)
            for (int32_t x = 0; x < nx; x++) {
                bool near = false;
                if (!(w->score[(ptrdiff_t)y * nx + x] < best.score))
                    continue;
                for (int32_t k = 0; k < n && !near; k++)
                    near = abs(out[k].x - x) < 2 && abs(out[k].y - y) < 2;
                if (!near)
                    best = (shift){w->score[(ptrdiff_t)y * nx + x], x, y};
            }
        if (best.x < 0)
            break;
        out[n] = best;
    }
    return n;
}

/* ---- the exact shift ---------------------------------------------------------------- */

/* Lines of the candidate, into w->fresh. */
static void draw_candidate(const quilt_source *s, const quilt_map *m,
                           const quilt_patch *p, quilt_window *w)
{
    const double rim = 3 * s->cell;
    const int32_t x0 = (int32_t)fmax(0,
                                     (p->from.x - p->half.x - rim - s->lo.x) / s->coarse),
                  y0 = (int32_t)fmax(0,
                                     (p->from.y - p->half.y - rim - s->lo.y) / s->coarse),
                  x1 = (int32_t)fmin(s->bx - 1,
                                     (p->from.x + p->half.x + rim - s->lo.x) / s->coarse),
                  y1 = (int32_t)fmin(s->by - 1,
                                     (p->from.y + p->half.y + rim - s->lo.y) / s->coarse);
    memset(w->fresh, 0, rimmed_size(w));
    for (int32_t y = y0; y <= y1; y++) {
        if (x0 > x1)
            break;
        for (int32_t k = s->bin[(ptrdiff_t)y * s->bx + x0];
             k < s->bin[(ptrdiff_t)y * s->bx + x1 + 1]; k++) {
            const quilt_dab *d = &s->dab.v[k];
            const tz_vec2 at = quilt_place_at(p, d->at);
            const double cx = at.x / m->cx - w->x, cy = at.y / m->cy - w->y;
            if (!(cx >= -2 && cy >= -2 && cx < w->w + 2 && cy < w->h + 2))
                continue;
            quilt_spot_add(&w->fresh[rimmed(w, (int32_t)floor(cx), (int32_t)floor(cy))],
                           (quilt_spot){(uint8_t)((cx - floor(cx)) * 256),
                                        (uint8_t)((cy - floor(cy)) * 256),
                                        turned(d->turn, p, 1), d->pen});
        }
    }
}

/* Best partner of line a of cell `at` (of an array with a rim) in the 5 x 5 cells about it:
 * how far off it is, and its offset across the line. 1 = none. */
static float find_line(const quilt_window *w, const quilt_cell *in, ptrdiff_t at,
                       quilt_spot a, float *across)
{
    const float c = w->wave[a.turn + 128], s = w->wave[a.turn];
    const int stride = w->w + 4;
    float best = 1;
    for (int dy = -2; dy <= 2; dy++)
        for (int dx = -2; dx <= 2; dx++) {
            const quilt_cell *q = &in[at + dy * stride + dx];
            for (int k = 0; k < QUILT_SPOTS && q->spot[k].pen; k++) {
                const quilt_spot b = q->spot[k];
                const int turn = abs((int8_t)(uint8_t)(a.turn - b.turn));
                if (turn > TURN_MOST)
                    continue;
                const float x = (float)dx + (float)(b.x - a.x) / 256,
                            y = (float)dy + (float)(b.y - a.y) / 256;
                const float v = c * y - s * x, along = c * x + s * y,
                            t = (float)turn / TURN_MOST, u = v / ACROSS_MOST;
                if (fabsf(along) > ALONG_MOST)
                    continue;
                const float cost = u * u + t * t + (a.pen != b.pen ? 0.7F : 0);
                if (cost < best) {
                    best = cost;
                    *across = v;
                }
            }
        }
    return best;
}

/* Shifts a candidate so that its lines lie on those that are there. */
static void align(const quilt_source *s, const quilt_map *m, const quilt_place *place,
                  quilt_patch *p, quilt_window *w)
{
    const tz_vec2 start = p->from;
    for (int round = 0; round < 3; round++) {
        double xx = 1e-9, xy = 0, yy = 1e-9, rx = 0, ry = 0, n = 0;
        draw_candidate(s, m, p, w);
        for (int32_t j = 0; j < w->h; j++)
            for (int32_t i = 0; i < w->w; i++) {
                const ptrdiff_t at = cell_at(m, w, i, j);
                /* every third will do */
                if ((i + j) % 3 != round % 3 ||
                    w->state[(ptrdiff_t)j * w->w + i] == QUILT_BLOCKED || at < 0 ||
                    m->label[at] == QUILT_NONE)
                    continue;
                const quilt_cell *old = &w->old[rimmed(w, i, j)];
                for (int k = 0; k < QUILT_SPOTS && old->spot[k].pen; k++) {
                    const quilt_spot a = old->spot[k];
                    float across = 0;
                    const double wt =
                        1 - (double)find_line(w, w->fresh, rimmed(w, i, j), a, &across);
                    if (wt <= 0)
                        continue;
                    const double angle = a.turn * TZ_PI / 256;
                    const double nx = -sin(angle), ny = cos(angle);
                    xx += wt * nx * nx;
                    xy += wt * nx * ny;
                    yy += wt * ny * ny;
                    rx += wt * nx * (double)across;
                    ry += wt * ny * (double)across;
                    n += wt;
                }
            }
        if (n < 1)
            return;
        xx += 0.02 * n;
        yy += 0.02 * n;
        const double det = xx * yy - xy * xy;
        const tz_vec2 v = {(yy * rx - xy * ry) / det * m->cx,
                           (xx * ry - xy * rx) / det * m->cy};
        p->from = tz_vec2_add(p->from, quilt_unturn(p, v));
        const tz_vec2 d = tz_vec2_sub(p->from, start);
        if (!(tz_vec2_length(d) < 2 * s->coarse)) {
            p->from = start;
            return;
        }
        if (tz_vec2_length(v) < 0.01 * s->cell)
            return;
    }
    (void)place;
}

/* ---- the cut ------------------------------------------------------------------------ */

/* Steps to where nothing lies yet cost as if it went on there: else seams would run
 * along that border, where only one side counts. */
static void extend(const quilt_map *m, quilt_window *w)
{
    for (int32_t j = 0; j < w->h; j++)
        for (int32_t i = 0; i < w->w; i++) {
            static const int8_t step[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
            const ptrdiff_t here = (ptrdiff_t)j * w->w + i, at = cell_at(m, w, i, j);
            if (at < 0 || m->label[at] != QUILT_NONE)
                continue;
            for (int d = 0; d < 4; d++) {
                const int32_t x = i + step[d][0], y = j + step[d][1];
                const ptrdiff_t to =
                    x < 0 || y < 0 || x >= w->w || y >= w->h ? -1 : cell_at(m, w, x, y);
                if (to >= 0 && m->label[to] != QUILT_NONE)
                    w->off[here] = fmaxf(w->off[here], w->off[(ptrdiff_t)y * w->w + x]);
            }
        }
}

/* How far old and fresh lines differ in each cell; cells that the exemplar has nothing
 * for are closed to it. */
static void compare(const quilt_source *s, const quilt_map *m, const quilt_patch *p,
                    quilt_window *w, uint8_t *state)
{
    float across;
    for (int32_t j = 0; j < w->h; j++)
        for (int32_t i = 0; i < w->w; i++) {
            const ptrdiff_t here = (ptrdiff_t)j * w->w + i, at = cell_at(m, w, i, j);
            float sum = 0;
            state[here] = w->state[here];
            w->off[here] = 0;
            if (state[here] == QUILT_BLOCKED)
                continue;
            const tz_vec2 x = quilt_source_at(p, centre_of(m, w, i, j));
            const double fx = (x.x - s->lo.x) / s->coarse,
                         fy = (x.y - s->lo.y) / s->coarse;
            const bool able = x.x >= s->lo.x && x.y >= s->lo.y && x.x <= s->hi.x &&
                              x.y <= s->hi.y && fx < s->fx && fy < s->fy &&
                              s->valid[(ptrdiff_t)fy * s->fx + (ptrdiff_t)fx];
            const bool known = m->label[at] != QUILT_NONE;
            if (!able)
                state[here] = known ? QUILT_OLD : QUILT_BLOCKED;
            if (!known)
                continue;
            const ptrdiff_t rim = rimmed(w, i, j);
            for (int k = 0; k < QUILT_SPOTS && w->old[rim].spot[k].pen; k++)
                sum += QUILT_ALONG +
                       find_line(w, w->fresh, rim, w->old[rim].spot[k], &across);
            for (int k = 0; k < QUILT_SPOTS && w->fresh[rim].spot[k].pen; k++)
                sum += find_line(w, w->old, rim, w->fresh[rim].spot[k], &across);
            w->off[here] = sum;
        }
    extend(m, w);
}

/* What seams cost that would be laid over. */
static double seams_gone(const quilt_map *m, const quilt_window *w, const uint8_t *side)
{
    double sum = 0;
    for (int32_t j = 0; j < w->h; j++)
        for (int32_t i = 0; i < w->w; i++) {
            const ptrdiff_t here = (ptrdiff_t)j * w->w + i, at = cell_at(m, w, i, j);
            if (at < 0)
                continue;
            const bool right = i + 1 < w->w && (side[here] || side[here + 1]),
                       below = j + 1 < w->h && (side[here] || side[here + w->w]);
            sum += right ? (double)m->seam[2 * at] : 0;
            sum += below ? (double)m->seam[2 * at + 1] : 0;
        }
    return sum;
}

static void lay(quilt_map *m, const quilt_place *place, const quilt_window *w,
                const float *off)
{
    for (int32_t j = 0; j < w->h; j++)
        for (int32_t i = 0; i < w->w; i++) {
            const ptrdiff_t here = (ptrdiff_t)j * w->w + i, at = cell_at(m, w, i, j);
            if (!w->best[here] || at < 0)
                continue;
            m->label[at] = place->patch;
            m->cell[at] = w->kept[rimmed(w, i, j)];
        }
    for (int32_t j = 0; j < w->h; j++)
        for (int32_t i = 0; i < w->w; i++)
            for (int d = 0; d < 2; d++) {
                const int32_t x = i + (d == 0), y = j + (d == 1);
                if (x >= w->w || y >= w->h)
                    continue;
                const ptrdiff_t here = (ptrdiff_t)j * w->w + i, at = cell_at(m, w, i, j),
                                there = (ptrdiff_t)y * w->w + x, to = cell_at(m, w, x, y);
                if (at < 0 || to < 0 || !(w->best[here] || w->best[there]))
                    continue;
                m->seam[2 * at + d] = m->label[at] == m->label[to] ||
                                              m->label[at] == QUILT_NONE ||
                                              m->label[to] == QUILT_NONE
                                          ? 0
                                          : off[here] + off[there] + QUILT_SEAM_LEAST;
            }
}

/* Spots that a cut adds, less those that the exemplar would have on what it newly covers
 * and those that it replaces. */
static double surplus(const quilt_source *s, const quilt_map *m, const quilt_window *w,
                      const uint8_t *side, const quilt_cell *fresh)
{
    double sum = 0;
    for (int32_t j = 0; j < w->h; j++)
        for (int32_t i = 0; i < w->w; i++) {
            if (!side[(ptrdiff_t)j * w->w + i])
                continue;
            const ptrdiff_t rim = rimmed(w, i, j), at = cell_at(m, w, i, j);
            for (int k = 0; k < QUILT_SPOTS; k++)
                sum += (fresh[rim].spot[k].pen != 0) - (w->old[rim].spot[k].pen != 0);
            sum -= m->label[at] == QUILT_NONE ? s->density : 0;
        }
    return sum;
}

/* Coverage of a window of the exemplar against the mean, less 1. */
static double excess(const quilt_source *s, int32_t x, int32_t y, int32_t w, int32_t h)
{
    const int32_t fw = s->fx + 1;
    const double *c = s->cover, all = c[(ptrdiff_t)s->fy * fw + s->fx],
                 sum = c[(ptrdiff_t)(y + h) * fw + x + w] - c[(ptrdiff_t)y * fw + x + w] -
                       c[(ptrdiff_t)(y + h) * fw + x] + c[(ptrdiff_t)y * fw + x];
    return all > 0 ? sum / all * s->fx * s->fy / ((double)w * h) - 1 : 0;
}

/* ---- all of it ---------------------------------------------------------------------- */

/* The shifts about a place, and the size of its window in cells of features. */
typedef struct shifting {
    const quilt_source *s;
    const quilt_map *m;
    const quilt_place *place;
    quilt_window *w;
    int32_t cw, ch, nx, ny;
    double known; /* cells where something lies */
    double owed;  /* by how much too much was laid */
} shifting;

static double score_at(const shifting *h, int32_t x, int32_t y, double vary)
{
    const quilt_source *s = h->s;
    const tz_vec2 from = {s->lo.x + (x + h->cw * 0.5) * s->coarse,
                          s->lo.y + (y + h->ch * 0.5) * s->coarse};
    const double score = (double)shift_score(s, h->w, h->cw, h->ch, x, y) /
                             fmax(h->known, 1) +
                         1e-6,
                 off = excess(s, x, y, h->cw, h->ch) + h->owed;
    if (!(h->known > 0))
        return vary + off * off + 1e3 * (score - 1e-6);
    return score * vary * repeats(s, h->m, h->place, h->w, from) * (1 + 2 * off * off) +
           (goes_on(s, h->m, h->place, h->w, from) ? 1e3 : 0);
}

/* The best of a shift and those beside it. */
static void refine(const shifting *h, shift *v)
{
    const shift at = *v;
    double least = INFINITY;
    for (int32_t y = at.y - 1; y <= at.y + 1; y++)
        for (int32_t x = at.x - 1; x <= at.x + 1; x++) {
            if (x < 0 || y < 0 || x >= h->nx || y >= h->ny)
                continue;
            const double score = score_at(h, x, y, 1);
            if (score < least) {
                least = score;
                *v = (shift){(float)score, x, y};
            }
        }
}

/* The best shifts by features, which change little from one to the next: of many only
 * every other one each way is looked at, and those beside the best. */
static int32_t choose(const quilt_source *s, const quilt_map *m, const quilt_place *place,
                      const quilt_patch *p, tz_rng *g, quilt_window *w, shift *best,
                      int32_t most)
{
    enum { FEW = 400 };
    const int32_t cw = (int32_t)fmin(s->fx, fmax(1, 2 * p->half.x / s->coarse + 0.01)),
                  ch = (int32_t)fmin(s->fy, fmax(1, 2 * p->half.y / s->coarse + 0.01));
    shifting h = {.s = s,
                  .m = m,
                  .place = place,
                  .w = w,
                  .cw = cw,
                  .ch = ch,
                  .nx = s->fx - cw + 1,
                  .ny = s->fy - ch + 1};
    h.known = read_features(s, m, p, w, cw, ch);
    const double room = s->density * w->w * w->h;
    h.owed = room > 0 ? fmax(-0.5, fmin(0.5, m->balance / room)) : 0;
    const bool sparse = (double)h.nx * h.ny > FEW;
    const int32_t px = (int32_t)(2 * tz_rng_unit(g)), py = (int32_t)(2 * tz_rng_unit(g));
    for (int32_t y = 0; y < h.ny; y++)
        for (int32_t x = 0; x < h.nx; x++) {
            float *to = &w->score[(ptrdiff_t)y * h.nx + x];
            *to = INFINITY;
            if (sparse && (x % 2 != px || y % 2 != py))
                continue;
            const double vary = h.known > 0 ? 0.9 + 0.2 * tz_rng_unit(g) : tz_rng_unit(g);
            *to = (float)score_at(&h, x, y, vary);
        }
    const int32_t n = best_shifts(w, h.nx, h.ny, h.known > 0 ? most : 1, best);
    for (int32_t i = 0; i < n && sparse && h.known > 0; i++)
        refine(&h, &best[i]);
    return n;
}

tz_status quilt_place_patch(const quilt_source *s, quilt_map *m, quilt_place *place,
                            const tz_curve_quilt_params *q, uint64_t seed,
                            quilt_window *w, bool *laid)
{
    enum { MOST = 64 };
    shift best[MOST];
    tz_rng g = tz_rng_make(seed, place->stream);
    const double angle =
        tz_domain_frame(m->domain, (tz_vec3){place->at.x, place->at.y, 0});
    quilt_patch p = {.to = place->at,
                     .angle = angle,
                     .c = cos(angle),
                     .s = sin(angle),
                     .half = place->half};
    double least = INFINITY;
    *laid = false;
    open_window(m, place, &p, w);
    list_near(s, m, place, w);
    const double room = 0.3 * s->density * w->w * w->h;
    if (w->w == 0 || w->h == 0)
        return TZ_OK;
    const int32_t most = place->core > 0 ? (q->candidates + 1) / 2 : q->candidates;
    const int32_t n = choose(s, m, place, &p, &g, w, best, most < MOST ? most : MOST);
    uint8_t *state = w->state + w->most;
    float *off = w->off;
    quilt_patch kept = p;
    for (int32_t k = 0; k < n; k++) {
        double cost;
        quilt_patch c = p;
        const double cw = fmin(s->fx, fmax(1, floor(2 * p.half.x / s->coarse + 0.01))),
                     ch = fmin(s->fy, fmax(1, floor(2 * p.half.y / s->coarse + 0.01)));
        c.from = (tz_vec2){s->lo.x + (best[k].x + cw * 0.5) * s->coarse,
                           s->lo.y + (best[k].y + ch * 0.5) * s->coarse};
        /* the window is p.half wide, the shift counts from its corner */
        c.from.x += p.half.x - cw * 0.5 * s->coarse;
        c.from.y += p.half.y - ch * 0.5 * s->coarse;
        align(s, m, place, &c, w);
        draw_candidate(s, m, &c, w);
        compare(s, m, &c, w, state);
        quilt_flow_cut(w->flow, w->w, w->h, off, state, w->side, &cost);
        if (place->core > 0 && !(cost < 0.8 * seams_gone(m, w, w->side)))
            continue;
        const double more = surplus(s, m, w, w->side, w->fresh),
                     score = (cost + 0.5) * repeats(s, m, place, w, c.from) +
                             0.04 * fabs(fmax(-room, fmin(room, m->balance)) + more);
        if (score < least) {
            place->surplus = more;
            least = score;
            kept = c;
            memcpy(w->best, w->side, (size_t)w->w * (size_t)w->h);
            memcpy(w->kept, w->fresh, rimmed_size(w));
        }
    }
    if (least == INFINITY)
        return TZ_OK;
    memcpy(w->fresh, w->kept, rimmed_size(w));
    compare(s, m, &kept, w, state);
    lay(m, place, w, off);
    m->patch.v[place->patch] = kept;
    *laid = true;
    return TZ_OK;
}
