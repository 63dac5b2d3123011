/* SPDX-License-Identifier: Apache-2.0 */
/* Which placement shows where.
 *
 * Borders are scan-converted in drawing order onto any grid of points. All arithmetic is
 * done in the layout's own coordinates, never relative to the crop, so that a point gets
 * the same label whatever rectangle it is asked with. */
#include <assert.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "synthesis/compose_internal.h"

static int32_t wrap_index(int32_t i, int32_t n)
{
    i %= n;
    return i < 0 ? i + n : i;
}

static int32_t clamp_index(int32_t i, int32_t n)
{
    return i < 0 ? 0 : i >= n ? n - 1 : i;
}

/* Cell of coordinate x, clamped before the conversion: boxes may be larger than int32. */
static int32_t cell_of(double x, int32_t cell, int32_t n)
{
    const double i = floor(x / cell);
    return i > 0 ? i < n ? (int32_t)i : n - 1 : 0;
}

/* The cells of a torus need not divide its sides: the last column is narrower, so that
 * wrapped pieces are entered with one cell more on every side. */
static void for_cells(const tz_composer *c, const tz_piece_index *ix, const tz_piece *p,
                      int32_t *count, int32_t *id, int32_t self)
{
    const bool tile = c->layout->tile;
    const double w = c->layout->width, h = c->layout->height;
    const int32_t turns_x = tile ? 1 : 0;
    for (int32_t ky = -turns_x; ky <= turns_x; ky++)
        for (int32_t kx = -turns_x; kx <= turns_x; kx++) {
            tz_piece q = *p;
            /* bring the box's centre into the layout first */
            double cx = 0.5 * (p->x0 + p->x1), cy = 0.5 * (p->y0 + p->y1);
            double mx = tile ? -floor(cx / w) * w + kx * w : 0;
            double my = tile ? -floor(cy / h) * h + ky * h : 0;
            q.x0 += mx, q.x1 += mx, q.y0 += my, q.y1 += my;
            if (q.x1 < 0 || q.y1 < 0 || q.x0 > w || q.y0 > h)
                continue;
            const int32_t i0 = cell_of(q.x0, ix->cell, ix->nx);
            const int32_t i1 = cell_of(q.x1, ix->cell, ix->nx);
            const int32_t j0 = cell_of(q.y0, ix->cell, ix->ny);
            const int32_t j1 = cell_of(q.y1, ix->cell, ix->ny);
            for (int32_t j = j0; j <= j1; j++)
                for (int32_t i = i0; i <= i1; i++) {
                    int32_t at = j * ix->nx + i;
                    if (id)
                        id[count[at]] = self;
                    count[at]++;
                }
        }
}

tz_status tz_piece_index_init(tz_ctx *ctx, const tz_composer *c, tz_piece_index *ix)
{
    const tz_layout *l = c->layout;
    int32_t *at = NULL;
    memset(ix, 0, sizeof *ix);
    ix->cell = 64;
    while ((int64_t)(l->width / ix->cell + 1) * (l->height / ix->cell + 1) > 4000000)
        ix->cell *= 2;
    ix->nx = (l->width + ix->cell - 1) / ix->cell;
    ix->ny = (l->height + ix->cell - 1) / ix->cell;
    const int32_t cells = ix->nx * ix->ny;
    tz_status s = tz_alloc_zero(ctx, &ix->first, (size_t)cells + 1, sizeof *ix->first);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &at, (size_t)cells + 1, sizeof *at);
    if (s != TZ_OK)
        goto done;
    for (int32_t k = 0; k < l->place.n; k++)
        if (!l->place.v[k].removed)
            for_cells(c, ix, &c->piece[k], at, NULL, k);
    int64_t sum = 0;
    for (int32_t i = 0; i < cells; i++) {
        ix->first[i] = (int32_t)sum;
        sum += at[i];
        at[i] = ix->first[i];
    }
    if (sum > INT32_MAX) {
        s = tz_fail(ctx, TZ_LIMIT,
                    "layout: placements overlap too much; use fewer or smaller");
        goto done;
    }
    ix->first[cells] = (int32_t)sum;
    s = tz_alloc(ctx, &ix->id, (size_t)sum, sizeof *ix->id);
    if (s != TZ_OK)
        goto done;
    for (int32_t k = 0; k < l->place.n; k++)
        if (!l->place.v[k].removed)
            for_cells(c, ix, &c->piece[k], at, ix->id, k);
done:
    tz_free(ctx, at);
    if (s != TZ_OK) {
        tz_free(ctx, ix->first);
        tz_free(ctx, ix->id);
        memset(ix, 0, sizeof *ix);
    }
    return s;
}

static int compare_int32(const void *a, const void *b)
{
    const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* Sorts and keeps one of each. @return what is left */
static int32_t sort_once(int32_t *v, int32_t n)
{
    if (n < 2)
        return n;
    qsort(v, (size_t)n, sizeof *v, compare_int32);
    int32_t kept = 1;
    for (int32_t k = 1; k < n; k++)
        if (v[k] != v[kept - 1])
            v[kept++] = v[k];
    return kept;
}

/* Ids of pieces whose cells meet [x0, x1) x [y0, y1), sorted, each once. */
static tz_status gather(tz_ctx *ctx, const tz_composer *c, double x0, double y0,
                        double x1, double y1, tz_label_scratch *scratch)
{
    const tz_piece_index *ix = &c->index;
    const tz_layout *l = c->layout;
    scratch->id.n = 0;
    int32_t i0 = (int32_t)floor(x0 / ix->cell), i1 = (int32_t)floor(x1 / ix->cell);
    int32_t j0 = (int32_t)floor(y0 / ix->cell), j1 = (int32_t)floor(y1 / ix->cell);
    if (l->tile) {
        /* narrower last cells: one cell of slack a turn */
        i1 += 1 + (int32_t)((x1 - x0) / l->width),
            j1 += 1 + (int32_t)((y1 - y0) / l->height);
        i0 -= 1, j0 -= 1;
        if (i1 - i0 >= ix->nx)
            i0 = 0, i1 = ix->nx - 1;
        if (j1 - j0 >= ix->ny)
            j0 = 0, j1 = ix->ny - 1;
    } else {
        i0 = clamp_index(i0, ix->nx), i1 = clamp_index(i1, ix->nx);
        j0 = clamp_index(j0, ix->ny), j1 = clamp_index(j1, ix->ny);
    }
    for (int32_t j = j0; j <= j1; j++)
        for (int32_t i = i0; i <= i1; i++) {
            const int32_t at = wrap_index(j, ix->ny) * ix->nx + wrap_index(i, ix->nx);
            for (int32_t k = ix->first[at]; k < ix->first[at + 1]; k++) {
                tz_status s = tz_array_push(ctx, &scratch->id, ix->id[k]);
                if (s != TZ_OK)
                    return s;
            }
        }
    scratch->id.n = sort_once(scratch->id.v, scratch->id.n);
    return TZ_OK;
}

/* Number of the first grid point at or beyond coordinate t (in units of the spacing). */
static inline int64_t first_point(double t)
{
    const int64_t i = (int64_t)(t - 0.5); /* towards zero */
    return i + ((double)i < t - 0.5);
}

/* Fills label where (copy of) piece `id`, moved by (mx, my), covers grid points. The grid
 * points are numbered on the layout's own lattice: point I is at (I + 0.5) * spacing. */
static tz_status fill(tz_ctx *ctx, const tz_composer *c, int32_t id, double mx, double my,
                      int64_t gx0, int64_t gy0, int32_t spacing, int32_t nx, int32_t ny,
                      int32_t *label, tz_label_scratch *scratch)
{
    enum { PER_ROW = 32 };
    const tz_placement *pl = &c->layout->place.v[id];
    const double *e = c->edge + 2 * (size_t)pl->border;
    const tz_piece *p = &c->piece[id];
    const double inv = 1.0 / spacing;
    int64_t J0 = first_point((p->y0 + my) * inv);
    int64_t J1 = first_point((p->y1 + my) * inv);
    if (J0 < gy0)
        J0 = gy0;
    if (J1 > gy0 + ny)
        J1 = gy0 + ny;
    if (J0 >= J1 || (p->x1 + mx) * inv < (double)gx0 ||
        (p->x0 + mx) * inv > (double)(gx0 + nx))
        return TZ_OK;
    const int32_t rows = (int32_t)(J1 - J0);
    /* per row: a count, then up to PER_ROW crossings; more (never for stars) are rare and
     * kept by taking a wider table */
    int32_t per_row = PER_ROW;
    if (pl->points < per_row)
        per_row = pl->points;
    else if (pl->points > 4 * PER_ROW)
        per_row = pl->points;
    else
        per_row = 4 * PER_ROW < pl->points ? 4 * PER_ROW : pl->points;
    const int32_t width = per_row + 1;
    tz_status s = tz_array_reserve(ctx, &scratch->cross, (int64_t)rows * width);
    if (s != TZ_OK)
        return s;
    double *table = scratch->cross.v;
    for (int32_t r = 0; r < rows; r++)
        table[(size_t)r * width] = 0;
    int64_t before = first_point((e[2 * (size_t)(pl->points - 1) + 1] + my) * inv);
    for (int32_t k = 0; k < pl->points; k++) {
        const int64_t here = first_point((e[2 * k + 1] + my) * inv);
        int64_t ra = before < here ? before : here, rb = before < here ? here : before;
        before = here;
        ra = ra < J0 ? J0 : ra;
        rb = rb > J1 ? J1 : rb;
        if (ra >= rb) /* crosses no row */
            continue;
        const int32_t k1 = k == 0 ? pl->points - 1 : k - 1;
        double ax = e[2 * k1] + mx, ay = e[2 * k1 + 1] + my;
        double bx = e[2 * k] + mx, by = e[2 * k + 1] + my;
        if (ay > by) {
            double t = ax;
            ax = bx, bx = t;
            t = ay, ay = by, by = t;
        }
        const double slope = (bx - ax) / (by - ay);
        for (int64_t J = ra; J < rb; J++) {
            double *row = table + (size_t)(J - J0) * width;
            const double y = ((double)J + 0.5) * spacing;
            const double x = ax + (y - ay) * slope;
            int32_t n = (int32_t)row[0];
            int32_t at = n + 1;
            while (at > 1 && row[at - 1] > x) {
                row[at] = row[at - 1];
                at--;
            }
            row[at] = x;
            row[0] = n + 1;
        }
    }
    for (int32_t r = 0; r < rows; r++) {
        const double *row = table + (size_t)r * width;
        const int32_t n = (int32_t)row[0];
        int32_t *out = label + (size_t)(J0 + r - gy0) * (size_t)nx;
        for (int32_t k = 1; k + 1 <= n; k += 2) {
            int64_t a = first_point(row[k] * inv) - gx0;
            int64_t b = first_point(row[k + 1] * inv) - gx0;
            if (a < 0)
                a = 0;
            if (b > nx)
                b = nx;
            for (int64_t i = a; i < b; i++)
                out[i] = id;
        }
    }
    return TZ_OK;
}

tz_vec2 tz_piece_shift(const tz_composer *c, int32_t id, double px, double py)
{
    tz_vec2 shift = {0, 0};
    if (c->layout->tile) {
        const tz_piece *p = &c->piece[id];
        const double w = c->layout->width, h = c->layout->height;
        shift.x = floor((px - 0.5 * (p->x0 + p->x1)) / w + 0.5) * w;
        shift.y = floor((py - 0.5 * (p->y0 + p->y1)) / h + 0.5) * h;
    }
    return shift;
}

/* ---- bare points -------------------------------------------------------------------- */

/* Squared distances of a point to a piece's box and to the box's centre. */
static void distances(const tz_composer *c, int32_t id, double px, double py, double *box,
                      double *mid)
{
    const tz_piece *p = &c->piece[id];
    const tz_vec2 m = tz_piece_shift(c, id, px, py);
    const double x = px - m.x, y = py - m.y;
    const double dx = x < p->x0 ? p->x0 - x : x > p->x1 ? x - p->x1 : 0;
    const double dy = y < p->y0 ? p->y0 - y : y > p->y1 ? y - p->y1 : 0;
    const double ex = x - 0.5 * (p->x0 + p->x1), ey = y - 0.5 * (p->y0 + p->y1);
    *box = dx * dx + dy * dy;
    *mid = ex * ex + ey * ey;
}

/* Pieces that may be the nearest to some point of cell (ci, cj): distances change no
 * faster than the point moves, so a piece farther from the cell's centre than the nearest
 * one by a whole diagonal of the cell is nowhere in it the nearest. */
static tz_status gather_near(tz_ctx *ctx, const tz_composer *c, int32_t ci, int32_t cj,
                             tz_label_scratch *scratch)
{
    const tz_piece_index *ix = &c->index;
    const int32_t rings = ix->nx > ix->ny ? ix->nx : ix->ny;
    const double px = (ci + 0.5) * ix->cell, py = (cj + 0.5) * ix->cell;
    const double slack = 1.4143 * ix->cell;
    double least = INFINITY, box, mid;
    scratch->near.n = 0;
    for (int32_t ring = 0;
         ring <= rings && (double)(ring - 2) * ix->cell <= least + slack; ring++)
        for (int32_t j = cj - ring; j <= cj + ring; j++)
            for (int32_t i = ci - ring; i <= ci + ring;
                 i += (j == cj - ring || j == cj + ring || ring == 0) ? 1 : 2 * ring) {
                int32_t ii = i, jj = j;
                if (c->layout->tile) {
                    ii = wrap_index(i, ix->nx), jj = wrap_index(j, ix->ny);
                } else if (i < 0 || j < 0 || i >= ix->nx || j >= ix->ny) {
                    continue;
                }
                const int32_t at = jj * ix->nx + ii;
                for (int32_t k = ix->first[at]; k < ix->first[at + 1]; k++) {
                    distances(c, ix->id[k], px, py, &box, &mid);
                    box = sqrt(box);
                    least = box < least ? box : least;
                    if (box > least + slack)
                        continue;
                    const tz_status s = tz_array_push(ctx, &scratch->near, ix->id[k]);
                    if (s != TZ_OK)
                        return s;
                }
            }
    scratch->near.n = sort_once(scratch->near.v, scratch->near.n);
    return TZ_OK;
}

/* The same for the square of FEW px about a point of that cell, out of the cell's. */
enum { FEW = 8 };

static tz_status gather_few(tz_ctx *ctx, const tz_composer *c, double px, double py,
                            tz_label_scratch *scratch)
{
    const double slack = 1.4143 * FEW;
    double least = INFINITY, mid;
    tz_status s = tz_array_reserve(ctx, &scratch->few, scratch->near.n);
    if (s == TZ_OK)
        s = tz_array_reserve(ctx, &scratch->far, scratch->near.n);
    if (s != TZ_OK)
        return s;
    for (int32_t k = 0; k < scratch->near.n; k++) {
        double *box = &scratch->far.v[k];
        distances(c, scratch->near.v[k], px, py, box, &mid);
        *box = sqrt(*box);
        least = *box < least ? *box : least;
    }
    scratch->few.n = 0;
    for (int32_t k = 0; k < scratch->near.n; k++)
        if (scratch->far.v[k] <= least + slack)
            scratch->few.v[scratch->few.n++] = scratch->near.v[k];
    return TZ_OK;
}

/* Nearest piece to a bare point: smallest distance to its box, then to its centre, then
 * the upper one. */
static tz_status nearest(tz_ctx *ctx, const tz_composer *c, double px, double py,
                         tz_label_scratch *scratch, int32_t *label)
{
    const tz_piece_index *ix = &c->index;
    const int32_t ci = cell_of(px, ix->cell, ix->nx), cj = cell_of(py, ix->cell, ix->ny);
    const int32_t fx = (int32_t)(px / FEW), fy = (int32_t)(py / FEW);
    tz_status s = TZ_OK;
    if (scratch->near_cell != cj * ix->nx + ci) {
        s = gather_near(ctx, c, ci, cj, scratch);
        scratch->near_cell = cj * ix->nx + ci;
        scratch->few_x = -1;
    }
    if (s == TZ_OK && (scratch->few_x != fx || scratch->few_y != fy)) {
        s = gather_few(ctx, c, (fx + 0.5) * FEW, (fy + 0.5) * FEW, scratch);
        scratch->few_x = fx, scratch->few_y = fy;
    }
    if (s != TZ_OK) {
        scratch->near_cell = -1;
        return s;
    }
    double best_box = INFINITY, best_mid = INFINITY, box, mid;
    for (int32_t k = 0; k < scratch->few.n; k++) { /* ids rise */
        distances(c, scratch->few.v[k], px, py, &box, &mid);
        if (box < best_box || (box == best_box && mid <= best_mid))
            *label = scratch->few.v[k], best_box = box, best_mid = mid;
    }
    return TZ_OK;
}

/* ---- grids --------------------------------------------------------------------------- */

/* Next i such that g0 + i is a multiple of block. */
static int64_t next_block(int64_t g0, int64_t i, int64_t block)
{
    const int64_t in = (g0 + i) % block;
    return i + block - (in < 0 ? in + block : in);
}

typedef struct grid_points {
    int64_t gx0, gy0;
    int32_t spacing, nx;
    int32_t *label;
} grid_points;

/* Labels of the bare points i0 <= i < i1, j0 <= j < j1, one small square after the other. */
static tz_status label_bare(tz_ctx *ctx, const tz_composer *c, const grid_points *g,
                            int64_t i0, int64_t i1, int64_t j0, int64_t j1,
                            tz_label_scratch *scratch)
{
    const tz_layout *l = c->layout;
    const int64_t few = FEW > g->spacing ? FEW / g->spacing : 1;
    tz_status s = TZ_OK;
    for (int64_t jb = j0; jb < j1; jb = next_block(g->gy0, jb, few))
        for (int64_t ib = i0; ib < i1; ib = next_block(g->gx0, ib, few)) {
            const int64_t je = next_block(g->gy0, jb, few),
                          ie = next_block(g->gx0, ib, few);
            for (int64_t j = jb; j < je && j < j1; j++)
                for (int64_t i = ib; i < ie && i < i1 && s == TZ_OK; i++) {
                    int32_t *label = &g->label[j * g->nx + i];
                    if (*label >= 0)
                        continue;
                    double px = ((double)(g->gx0 + i) + 0.5) * g->spacing;
                    double py = ((double)(g->gy0 + j) + 0.5) * g->spacing;
                    if (l->tile) {
                        px -= floor(px / l->width) * l->width;
                        py -= floor(py / l->height) * l->height;
                    }
                    s = nearest(ctx, c, px, py, scratch, label);
                }
        }
    return s;
}

/* Labels of grid points that are inside the layout or, on a torus, anywhere. */
static tz_status label_inside(tz_ctx *ctx, const tz_composer *c, int64_t gx0, int64_t gy0,
                              int32_t spacing, int32_t nx, int32_t ny, int32_t *label,
                              tz_label_scratch *scratch)
{
    const tz_layout *l = c->layout;
    const int64_t x0 = gx0 * spacing, y0 = gy0 * spacing;
    for (int64_t i = 0; i < (int64_t)nx * ny; i++)
        label[i] = -1;
    /* outside a plain layout points repeat the nearest inside point */
    int64_t a = 0, b = nx, d = 0, e = ny;
    if (!l->tile) {
        const int64_t last_x = (l->width - 1) / spacing,
                      last_y = (l->height - 1) / spacing;
        a = gx0 < 0 ? -gx0 : 0;
        d = gy0 < 0 ? -gy0 : 0;
        b = gx0 + nx > last_x + 1 ? last_x + 1 - gx0 : nx;
        e = gy0 + ny > last_y + 1 ? last_y + 1 - gy0 : ny;
    }
    tz_status s = gather(ctx, c, (double)(x0 + a * spacing), (double)(y0 + d * spacing),
                         (double)(x0 + b * spacing), (double)(y0 + e * spacing), scratch);
    for (int32_t k = 0; s == TZ_OK && k < scratch->id.n; k++) {
        const int32_t id = scratch->id.v[k];
        if (!l->tile) {
            s = fill(ctx, c, id, 0, 0, gx0, gy0, spacing, nx, ny, label, scratch);
            continue;
        }
        const tz_piece *p = &c->piece[id];
        const double w = l->width, h = l->height;
        const double kx0 = floor(((double)x0 - p->x1) / w),
                     kx1 = ceil(((double)(x0 + (int64_t)nx * spacing) - p->x0) / w);
        const double ky0 = floor(((double)y0 - p->y1) / h),
                     ky1 = ceil(((double)(y0 + (int64_t)ny * spacing) - p->y0) / h);
        for (double ky = ky0; ky <= ky1 && s == TZ_OK; ky++)
            for (double kx = kx0; kx <= kx1 && s == TZ_OK; kx++)
                s = fill(ctx, c, id, kx * w, ky * h, gx0, gy0, spacing, nx, ny, label,
                         scratch);
    }
    if (s != TZ_OK)
        return s;
    const int32_t cells = c->index.nx * c->index.ny;
    if (c->index.first[cells] == 0) /* nothing shows anywhere */
        return TZ_OK;
    /* bare points, one cell of the index after the other */
    const int64_t block = c->index.cell / spacing;
    const grid_points g = {gx0, gy0, spacing, nx, label};
    scratch->near_cell = -1;
    for (int64_t jb = d; jb < e && s == TZ_OK; jb = next_block(gy0, jb, block))
        for (int64_t ib = a; ib < b && s == TZ_OK; ib = next_block(gx0, ib, block)) {
            const int64_t je = next_block(gy0, jb, block),
                          ie = next_block(gx0, ib, block);
            s = label_bare(ctx, c, &g, ib, ie < b ? ie : b, jb, je < e ? je : e, scratch);
        }
    if (s != TZ_OK)
        return s;
    if (a > 0 || b < nx)
        for (int64_t j = d; j < e; j++) {
            int32_t *row = label + j * nx;
            for (int64_t i = 0; i < a && i < nx; i++)
                row[i] = row[a < nx ? a : nx - 1];
            for (int64_t i = b < 0 ? 0 : b; i < nx; i++)
                row[i] = row[b > 0 ? b - 1 : 0];
        }
    for (int64_t j = 0; j < d && d < ny; j++)
        memcpy(label + j * nx, label + d * nx, (size_t)nx * sizeof *label);
    for (int64_t j = e; j < ny && e > 0; j++)
        memcpy(label + j * nx, label + (e - 1) * nx, (size_t)nx * sizeof *label);
    return TZ_OK;
}

static int32_t gcd(int32_t a, int32_t b)
{
    while (b) {
        const int32_t t = a % b;
        a = b, b = t;
    }
    return a;
}

tz_status tz_label_grid(tz_ctx *ctx, const tz_composer *c, int64_t x0, int64_t y0,
                        int32_t spacing, int32_t nx, int32_t ny, int32_t *label,
                        tz_label_scratch *scratch)
{
    enum { SMALL = 16384 };
    const tz_layout *l = c->layout;
    assert(x0 % spacing == 0 && y0 % spacing == 0);
    const int64_t gx0 = x0 / spacing, gy0 = y0 / spacing;
    /* On a small torus the grid goes round many times: after px x py points it sees the
     * same places again. Whether that is made use of depends on the layout alone. */
    const int32_t px = l->width / gcd(l->width, spacing);
    const int32_t py = l->height / gcd(l->height, spacing);
    if (!l->tile || (int64_t)px * py > SMALL)
        return label_inside(ctx, c, gx0, gy0, spacing, nx, ny, label, scratch);
    tz_status s = tz_array_reserve(ctx, &scratch->turn, (int64_t)px * py);
    if (s == TZ_OK)
        s = label_inside(ctx, c, 0, 0, spacing, px, py, scratch->turn.v, scratch);
    for (int32_t j = 0; j < ny && s == TZ_OK; j++) {
        const int32_t *row = scratch->turn.v + (((gy0 + j) % py + py) % py) * px;
        int32_t at = (int32_t)((gx0 % px + px) % px);
        for (int32_t i = 0; i < nx; i++) {
            label[(int64_t)j * nx + i] = row[at];
            at = at + 1 == px ? 0 : at + 1;
        }
    }
    return s;
}

void tz_label_scratch_deinit(tz_ctx *ctx, tz_label_scratch *s)
{
    tz_array_free(ctx, &s->id);
    tz_array_free(ctx, &s->cross);
    tz_array_free(ctx, &s->near);
    tz_array_free(ctx, &s->few);
    tz_array_free(ctx, &s->far);
    tz_array_free(ctx, &s->turn);
}
