/* SPDX-License-Identifier: Apache-2.0 */
/* Strips of photo along lines.
 *
 * A place p of the canvas whose nearest place on a line is c(t), with tangent T and normal N
 * there, lies at c + a T + b N (a = 0 but at ends and corners). It shows the photo at
 *
 *     s(t) + (a T' + b N') / scale
 *
 * where s is the line's origin, T' and N' its tangent and normal at t. A line that is a moved
 * and turned copy carries along its neighbourhood rigidly, and so does the line beside it:
 * between copies of one part of the photo there is no seam at all. Of a bent one, places keep
 * their distance to it; along it the photo is stretched by
 *
 *     sigma = |s'| (1 - k' b) / (|c'| (1 - k b))        k, k': curvatures
 *
 * which with T, N gives the map's derivative, of which the blend needs to know.
 *
 * About a node, the places that have it as their nearest are those whose direction from it
 * makes more than a right angle with all its branches. There the maps of the branches are
 * turned gradually into each other, weighted by the inverse square of the angle beyond the
 * right one: at a wedge's border the branch beside it is alone.
 *
 * A strip ends where the photo shows another line: where the place in the photo is farther
 * from the strip's line than from the nearest of all lines, and that one is within `guard`.
 * What else is beyond the middle of the photo's cell is cell as well. */
#include <string.h>

#include "synthesis/curve_strip_internal.h"

/* ---- origins --------------------------------------------------------------------------- */

static bool has_origin(const tz_curve_set *set, int32_t piece)
{
    return !set->origin.n || !isnan(set->origin.v[piece].p[0].x);
}

static tz_bezier origin_of(const tz_curve_set *set, int32_t piece)
{
    return set->origin.n ? set->origin.v[piece]
                         : tz_curve_bezier(set, &set->piece.v[piece]);
}

/* A piece that was made to close a gap has no origin: it takes that of a neighbour along its
 * path, run through the other way, so that both meet in the same pixels. */
static bool borrow(const tz_curve_set *set, const tz_curve_path *p, int32_t piece,
                   tz_bezier *out)
{
    for (int32_t k = 1; k < p->pieces; k++)
        for (int side = -1; side <= 1; side += 2) {
            const int32_t i = piece + side * k;
            if (i < p->piece || i >= p->piece + p->pieces || !has_origin(set, i))
                continue;
            const tz_bezier b = origin_of(set, i);
            const bool turn = k % 2 == 1;
            for (int m = 0; m < 4; m++)
                out->p[m] = b.p[turn ? 3 - m : m];
            return true;
        }
    return false;
}

static tz_status find_origins(tz_ctx *ctx, const tz_curve_set *set, tz_strips *s)
{
    int32_t any = -1;
    tz_status st = tz_alloc(ctx, &s->from, (size_t)set->piece.n, sizeof *s->from);
    if (st == TZ_OK)
        st = tz_alloc(ctx, &s->half, (size_t)set->piece.n, sizeof *s->half);
    if (st != TZ_OK)
        return st;
    for (int32_t i = 0; i < set->piece.n && any < 0; i++)
        if (has_origin(set, i))
            any = i;
    for (int32_t i = 0; i < set->path.n && any >= 0; i++) {
        const tz_curve_path *p = &set->path.v[i];
        for (int32_t k = p->piece; k < p->piece + p->pieces; k++) {
            const double width = set->pen.v[p->pen].width;
            s->half[k] = (tz_curve_taper){0.5 * width, 0.5 * width};
            if (set->taper.n)
                s->half[k] = (tz_curve_taper){0.5 * set->taper.v[k].from,
                                              0.5 * set->taper.v[k].to};
            if (has_origin(set, k))
                s->from[k] = origin_of(set, k);
            else if (!borrow(set, p, k, &s->from[k]))
                s->from[k] = origin_of(set, any);
        }
    }
    return any >= 0 || !set->piece.n
               ? TZ_OK
               : tz_fail(ctx, TZ_INVALID,
                         "layout: none of its lines knows where in the photo it comes "
                         "from; render it with strokes");
}

/* ---- distances in the photo ------------------------------------------------------------ */

/* One pass over a row of squared distances: lower envelope of parabolas.
 * @source Felzenszwalb, Huttenlocher: Distance transforms of sampled functions, 2012 */
static void envelope(const float *f, int32_t n, float *out, int32_t *site, double *from)
{
    int32_t k = -1;
    for (int32_t q = 0; q < n; q++) {
        if (!(f[q] < 1e19F))
            continue;
        double x = -INFINITY;
        while (k >= 0) {
            const double p = site[k];
            x = ((double)f[q] + (double)q * q - ((double)f[site[k]] + p * p)) /
                (2.0 * q - 2 * p);
            if (x > from[k])
                break;
            k--;
        }
        k++;
        site[k] = q;
        from[k] = k ? x : -INFINITY;
    }
    int32_t i = 0;
    for (int32_t q = 0; q < n; q++) {
        if (k < 0) {
            out[q] = 1e20F;
            continue;
        }
        while (i < k && from[i + 1] < q)
            i++;
        const double d = (double)q - site[i];
        out[q] = (float)(d * d + (double)f[site[i]]);
    }
}

typedef struct spread {
    float *v;
    int32_t width, height;
    bool rows;
} spread;

enum { LINES = 16 };

static tz_status spread_task(tz_ctx *ctx, void *arg, int64_t index, int worker)
{
    const spread *b = arg;
    const int32_t n = b->rows ? b->width : b->height, m = b->rows ? b->height : b->width;
    float *in = NULL, *out;
    int32_t *site = NULL;
    double *from = NULL;
    (void)worker;
    tz_status s = tz_alloc(ctx, &in, 2 * (size_t)n, sizeof *in);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &site, (size_t)n, sizeof *site);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &from, (size_t)n, sizeof *from);
    const int64_t step = b->rows ? 1 : b->width, stride = b->rows ? b->width : 1;
    for (int64_t k = index * LINES; s == TZ_OK && k < m && k < (index + 1) * LINES; k++) {
        out = in + n;
        for (int32_t i = 0; i < n; i++)
            in[i] = b->v[k * stride + i * step];
        envelope(in, n, out, site, from);
        for (int32_t i = 0; i < n; i++)
            b->v[k * stride + i * step] = out[i];
    }
    tz_free(ctx, in);
    tz_free(ctx, site);
    tz_free(ctx, from);
    return s;
}

static void mark_origin(tz_strips *s, const tz_bezier *b)
{
    double length = 0;
    for (int k = 0; k < 3; k++)
        length += tz_vec2_length(tz_vec2_sub(b->p[k + 1], b->p[k]));
    const int32_t steps = (int32_t)fmin(2 * length + 1, 100000);
    for (int32_t k = 0; k <= steps; k++) {
        const tz_vec2 p = tz_bezier_at(b, (double)k / steps);
        if (p.x >= 0 && p.y >= 0 && p.x < s->width && p.y < s->height)
            s->apart[(int64_t)p.y * s->width + (int64_t)p.x] = 0;
    }
}

/* Distance of each pixel of the photo to the nearest line that some piece comes from, and
 * the largest of them. */
static tz_status measure_cells(tz_ctx *ctx, const tz_curve_set *set, tz_strips *s,
                               double *largest)
{
    const int64_t n = (int64_t)s->width * s->height;
    tz_status st = tz_alloc(ctx, &s->apart, (size_t)n, sizeof *s->apart);
    if (st != TZ_OK)
        return st;
    for (int64_t i = 0; i < n; i++)
        s->apart[i] = 1e20F;
    for (int32_t i = 0; i < set->piece.n; i++)
        if (has_origin(set, i))
            mark_origin(s, &s->from[i]);
    for (int rows = 0; rows < 2 && st == TZ_OK; rows++) {
        spread b = {s->apart, s->width, s->height, rows};
        const int32_t m = rows ? s->height : s->width;
        st = tz_parallel_for(ctx, (m + LINES - 1) / LINES, spread_task, &b);
    }
    *largest = 0;
    for (int64_t i = 0; i < n; i++) {
        s->apart[i] = sqrtf(s->apart[i]);
        *largest = fmax(*largest, (double)s->apart[i]);
    }
    return st;
}

/* Unit tangent; where the slope vanishes, of a chord near t. */
static tz_vec2 tangent(const tz_bezier *c, double t, tz_vec2 slope)
{
    double l = tz_vec2_length(slope);
    if (!(l > 1e-6)) {
        const double a = fmax(t - 0.05, 0), b = fmin(t + 0.05, 1);
        slope = tz_vec2_sub(tz_bezier_at(c, b), tz_bezier_at(c, a));
        l = tz_vec2_length(slope);
        if (!(l > 1e-12))
            return (tz_vec2){1, 0};
    }
    return tz_vec2_scale(slope, 1 / l);
}

static tz_status find_tangents(tz_ctx *ctx, tz_strips *s)
{
    const int32_t n = s->near.piece.n;
    tz_status st = tz_alloc(ctx, &s->end, 2 * (size_t)n, sizeof *s->end);
    for (int32_t i = 0; i < 2 * n && st == TZ_OK; i++) {
        const tz_bezier *c = &s->near.piece.v[i / 2].at, *f = &s->from[i / 2];
        const double t = i % 2;
        s->end[i].at = tangent(c, t, tz_bezier_slope(c, t));
        s->end[i].from = tangent(f, t, tz_bezier_slope(f, t));
    }
    return st;
}

/* ---- making ---------------------------------------------------------------------------- */

/* Mean of boxes: a photo shown smaller than it is. */
static tz_status shrink_photo(tz_ctx *ctx, const tz_image *im, int32_t by, tz_image *out)
{
    const int32_t w = im->width / by > 0 ? im->width / by : 1,
                  h = im->height / by > 0 ? im->height / by : 1;
    tz_status s = tz_image_init(ctx, out, w, h, im->channels);
    if (s != TZ_OK)
        return s;
    out->alpha = im->alpha;
    out->encoding = im->encoding;
    out->depth = im->depth;
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            const int32_t x0 = (int32_t)((int64_t)x * im->width / w),
                          x1 = (int32_t)(((int64_t)x + 1) * im->width / w),
                          y0 = (int32_t)((int64_t)y * im->height / h),
                          y1 = (int32_t)(((int64_t)y + 1) * im->height / h);
            for (int32_t c = 0; c < im->channels; c++) {
                double sum = 0;
                for (int32_t j = y0; j < y1; j++)
                    for (int32_t i = x0; i < x1; i++)
                        sum += (double)tz_image_at(im, i, j)[c];
                tz_image_at(out, x, y)[c] =
                    (float)(sum / ((double)(x1 - x0) * (y1 - y0)));
            }
        }
    return TZ_OK;
}

static tz_status make_plane(tz_ctx *ctx, tz_strips *s, const tz_image *map)
{
    const bool data = s->kind != TZ_MAP_COLOUR || map->encoding == TZ_ENCODING_DATA;
    const double less = s->shrink * map->width / s->width;
    tz_image small = {0};
    tz_status st = TZ_OK;
    int32_t by = 1;
    while (by * 2 <= less * 1.25 && by < 1024)
        by *= 2;
    if (by > 1)
        st = shrink_photo(ctx, map, by, &small);
    if (st == TZ_OK)
        st = tz_source_plane_init(ctx, &s->photo, by > 1 ? &small : map, s->width,
                                  s->height, data, true);
    tz_image_deinit(&small);
    return st;
}

/* Widest of nine in ten lines, by length of pieces: half of that. */
static double usual_half(const tz_curve_set *set, const tz_strips *s)
{
    double sum = 0, squares = 0, all = 0;
    for (int32_t i = 0; i < set->piece.n; i++) {
        const double l = tz_bezier_length(&s->near.piece.v[i].at),
                     h = 0.5 * (s->half[i].from + s->half[i].to);
        sum += l * h, squares += l * h * h, all += l;
    }
    if (!(all > 0))
        return 0;
    const double mean = sum / all;
    return mean + sqrt(fmax(squares / all - mean * mean, 0));
}

tz_status tz_strips_init(tz_ctx *ctx, const tz_curve_set *set,
                         const tz_curve_canvas *canvas, const tz_image *photo,
                         const tz_image *map, const tz_composer *ground, tz_map_kind kind,
                         double strip, tz_strips *s)
{
    double largest = 0;
    *s = (tz_strips){.shrink = 1 / sqrt(canvas->sx * canvas->sy),
                     .strip = strip,
                     .width = photo->width,
                     .height = photo->height,
                     .ground = ground,
                     .kind = kind,
                     .channels = map->channels,
                     .decay = ground ? ground->params.decay : 96};
    tz_status st = find_origins(ctx, set, s);
    if (st == TZ_OK)
        st = measure_cells(ctx, set, s, &largest);
    double reach = strip;
    for (int32_t i = 0; i < set->piece.n && strip >= 0 && st == TZ_OK; i++)
        reach = fmax(reach, strip + fmax(s->half[i].from, s->half[i].to));
    if (strip < 0) /* without a ground, a strip goes as far as there is room */
        reach = ground ? 1.5 * largest + 16 : 1e5;
    if (st == TZ_OK)
        st = tz_near_init(ctx, set, canvas, reach / s->shrink, &s->near);
    if (st == TZ_OK)
        st = find_tangents(ctx, s);
    if (st == TZ_OK) {
        s->guard = usual_half(set, s) + 2;
        st = make_plane(ctx, s, map);
    }
    if (st != TZ_OK)
        tz_strips_deinit(ctx, s);
    return st;
}

void tz_strips_deinit(tz_ctx *ctx, tz_strips *s)
{
    tz_near_deinit(ctx, &s->near);
    tz_free(ctx, s->from);
    tz_free(ctx, s->end);
    tz_free(ctx, s->half);
    tz_free(ctx, s->apart);
    tz_source_plane_deinit(ctx, &s->photo);
    *s = (tz_strips){0};
}

/* ---- maps of lines --------------------------------------------------------------------- */

static tz_vec2 turn_by(tz_vec2 r, tz_vec2 v) /* complex product */
{
    return (tz_vec2){r.x * v.x - r.y * v.y, r.x * v.y + r.y * v.x};
}

static tz_vec2 turn_back(tz_vec2 a, tz_vec2 b) /* a times b's conjugate */
{
    return (tz_vec2){a.x * b.x + a.y * b.y, a.y * b.x - a.x * b.y};
}

static tz_vec2 bend_of(const tz_bezier *c, double t) /* second derivative */
{
    const double u = 1 - t;
    return (tz_vec2){6 * (u * (c->p[2].x - 2 * c->p[1].x + c->p[0].x) +
                          t * (c->p[3].x - 2 * c->p[2].x + c->p[1].x)),
                     6 * (u * (c->p[2].y - 2 * c->p[1].y + c->p[0].y) +
                          t * (c->p[3].y - 2 * c->p[2].y + c->p[1].y))};
}

/* Curvature at t, where the slope has that length. */
static double curvature(const tz_bezier *c, double t, tz_vec2 slope, double length)
{
    const tz_vec2 d = bend_of(c, t);
    return length > 1e-4 ? (slope.x * d.y - slope.y * d.x) / (length * length * length)
                         : 0;
}

static void map_along(const tz_strips *s, const tz_near_place *q, tz_strip_map *out)
{
    const tz_bezier *c = &s->near.piece.v[q->piece].at, *f = &s->from[q->piece];
    const tz_vec2 cs = tz_bezier_slope(c, q->t), fs = tz_bezier_slope(f, q->t);
    const double cl = tz_vec2_length(cs), fl = tz_vec2_length(fs);
    const tz_vec2 T = cl > 1e-6 ? tz_vec2_scale(cs, 1 / cl) : tangent(c, q->t, cs),
                  S = fl > 1e-6 ? tz_vec2_scale(fs, 1 / fl) : tangent(f, q->t, fs);
    const tz_vec2 at = tz_bezier_at(f, q->t);
    const double k = s->shrink, a = tz_vec2_dot(q->offset, T),
                 b = q->offset.y * T.x - q->offset.x * T.y;
    out->u = at.x + k * (a * S.x - b * S.y);
    out->v = at.y + k * (a * S.y + b * S.x);
    double sigma = k;
    if (q->t > 0 && q->t < 1) { /* how fast places at that distance move */
        const double slow = cl * (1 - b * curvature(c, q->t, cs, cl)),
                     fast = fl * (1 - b * k * curvature(f, q->t, fs, fl));
        sigma = !(fast > 0) ? 0 : fast < 4 * k * slow ? fast / slow : 4 * k;
    }
    out->f[0] = (float)(sigma * S.x * T.x + k * S.y * T.y);
    out->f[1] = (float)(sigma * S.x * T.y - k * S.y * T.x);
    out->f[2] = (float)(sigma * S.y * T.x - k * S.x * T.y);
    out->f[3] = (float)(sigma * S.y * T.y + k * S.x * T.x);
    out->plane = 0;
}

/* Direction out of a node, on the canvas and in the photo, and the node's place there. */
static void branch(const tz_strips *s, int32_t end, tz_vec2 *d, tz_vec2 *e, tz_vec2 *at)
{
    const int32_t piece = end / 2;
    const double side = end % 2 ? -1 : 1;
    *d = tz_vec2_scale(s->end[end].at, side);
    *e = tz_vec2_scale(s->end[end].from, side);
    *at = s->from[piece].p[end % 2 ? 3 : 0];
}

/* The wedge at a node. False where the node is the end of a smooth line. */
static bool map_about(const tz_strips *s, const tz_near_place *q, tz_strip_map *out)
{
    const int32_t node = s->near.piece.v[q->piece].node[q->t > 0.5];
    const int32_t *end = s->near.end + s->near.ends[node];
    const int32_t n = s->near.ends[node + 1] - s->near.ends[node];
    if (n < 2 || !(q->d > 1e-9))
        return false;
    tz_vec2 sum = {0, 0}, home = {0, 0};
    double most = -1;
    for (int pass = 0; pass < 2; pass++)
        for (int32_t i = 0; i < n && i < 64; i++) {
            tz_vec2 d, e, at;
            branch(s, end[i], &d, &e, &at);
            const double dot = tz_vec2_dot(q->offset, d) / q->d;
            const double angle = asin(fmin(fmax(-dot, 0), 1));
            const double weight = 1 / (angle * angle + 1e-6);
            if (!pass && weight > most) {
                most = weight;
                home = at;
            }
            if (pass && fabs(at.x - home.x) + fabs(at.y - home.y) < 1)
                sum = tz_vec2_add(sum, tz_vec2_scale(turn_back(e, d), weight));
        }
    const double l = tz_vec2_length(sum);
    if (!(l > 1e-9))
        return false;
    const tz_vec2 r = tz_vec2_scale(sum, s->shrink / l), o = turn_by(r, q->offset);
    *out = (tz_strip_map){
        home.x + o.x, home.y + o.y, {(float)r.x, (float)-r.y, (float)r.y, (float)r.x}, 0};
    return true;
}

/* Whether a strip reaches there. */
static bool reaches(const tz_strips *s, const tz_near_place *q, const tz_strip_map *m)
{
    const double d = q->d * s->shrink;
    if (s->strip >= 0) {
        const tz_curve_taper h = s->half[q->piece];
        return d <= s->strip + h.from + q->t * (h.to - h.from);
    }
    if (!s->ground) /* what there is has to do */
        return true;
    if (!(m->u >= 0 && m->v >= 0 && m->u < s->width && m->v < s->height))
        return false;
    const double apart = (double)s->apart[(int64_t)m->v * s->width + (int64_t)m->u];
    return d <= apart + 1.5 || apart >= s->guard;
}

static void map_of_place(const tz_strips *s, const tz_near_place *q, tz_strip_map *out)
{
    out->plane = -1;
    if (q->piece < 0)
        return;
    const bool at_node = q->t <= 0 || q->t >= 1;
    if (!at_node || !map_about(s, q, out))
        map_along(s, q, out);
    if (!reaches(s, q, out))
        out->plane = -1;
}

/* ---- maps of the ground ---------------------------------------------------------------- */

static void map_of_ground(const tz_composer *g, int32_t label, double x, double y,
                          tz_strip_map *out)
{
    if (label < 0)
        return;
    const tz_piece *p = &g->piece[label];
    const tz_vec2 shift = tz_piece_shift(g, label, x, y);
    const tz_vec2 at = tz_affine_apply(p->inv, (tz_vec2){x - shift.x, y - shift.y});
    *out = (tz_strip_map){
        at.x,
        at.y,
        {(float)p->inv.a, (float)p->inv.c, (float)p->inv.b, (float)p->inv.d},
        1 + p->source};
}

static tz_status reserve(tz_ctx *ctx, tz_strip_work *w, size_t n)
{
    if (n <= w->room)
        return TZ_OK;
    tz_free(ctx, w->place);
    tz_free(ctx, w->label);
    w->place = NULL;
    w->label = NULL;
    w->room = 0;
    tz_status s = tz_alloc(ctx, &w->place, n, sizeof *w->place);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &w->label, n, sizeof *w->label);
    if (s == TZ_OK)
        w->room = n;
    return s;
}

tz_status tz_strip_maps(tz_ctx *ctx, const tz_strips *s, int64_t x0, int64_t y0,
                        int32_t spacing, int32_t nx, int32_t ny, tz_strip_map *out,
                        tz_strip_work *w)
{
    const size_t n = (size_t)nx * (size_t)ny;
    bool bare = false;
    tz_status st = reserve(ctx, w, n);
    if (st == TZ_OK)
        st = tz_near_grid(ctx, &s->near, x0, y0, spacing, nx, ny, w->place, &w->near);
    if (st != TZ_OK)
        return st;
    for (size_t i = 0; i < n; i++) {
        map_of_place(s, &w->place[i], &out[i]);
        bare = bare || out[i].plane < 0;
    }
    if (!bare || !s->ground)
        return TZ_OK;
    st = tz_label_grid(ctx, s->ground, x0, y0, spacing, nx, ny, w->label, &w->labels);
    for (size_t i = 0; i < n && st == TZ_OK; i++)
        if (out[i].plane < 0)
            map_of_ground(s->ground, w->label[i],
                          (double)x0 + ((double)(i % (size_t)nx) + 0.5) * spacing,
                          (double)y0 + ((double)(i / (size_t)nx) + 0.5) * spacing,
                          &out[i]);
    return st;
}

void tz_strip_work_deinit(tz_ctx *ctx, tz_strip_work *w)
{
    tz_near_scratch_deinit(ctx, &w->near);
    tz_label_scratch_deinit(ctx, &w->labels);
    tz_free(ctx, w->place);
    tz_free(ctx, w->label);
    for (int k = 0; k < 3; k++)
        tz_free(ctx, w->map[k]);
    for (int k = 0; k < 2; k++)
        tz_correction_deinit(ctx, &w->grid[k]);
    tz_free(ctx, w->u);
    tz_free(ctx, w->v);
    tz_free(ctx, w->row);
    tz_free(ctx, w->low);
    tz_free(ctx, w->texel);
    tz_free(ctx, w->seam);
    *w = (tz_strip_work){0};
}
