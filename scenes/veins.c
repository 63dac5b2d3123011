/* SPDX-License-Identifier: Apache-2.0 */
/* Polished rock without relief to speak of, of two sorts:
 *
 *   bands   onyx, agate: level sets of a warped height s(x, y). Band k lies between s_k
 *           and s_{k+1}; its borders are sharp, soft, or so soft (over 12 px) that they
 *           are no boundary and the bands on both sides one piece
 *   net     slate, marble: borders of warped cells and level sets of noise, along which
 *           a vein swells and fades. Over 8 px wide it is a piece, else a line, and where
 *           it has faded nothing */
#include "scenes/shapes.h"

enum { PALETTE = 5 };

static void draw_palette(tz_rng *r, double spread, float palette[PALETTE][3])
{
    tz_canvas_base_colour(r, palette[0]);
    for (int i = 1; i < PALETTE; i++)
        if (tz_shape_chance(r, 0.3))
            tz_canvas_base_colour(r, palette[i]);
        else
            tz_canvas_colour(r, palette[0], spread, 0.6 * spread, palette[i]);
}

static double contrast(const float a[3], const float b[3])
{
    double most = 0;
    for (int k = 0; k < 3; k++)
        most = fmax(most, fabs(log((double)(a[k] + 0.02f) / (double)(b[k] + 0.02f))));
    return most;
}

/* ---- bands ------------------------------------------------------------------------- */

typedef struct band {
    float from, soft; /* lower border in s, and its width in px */
    float colour[3];
    int32_t piece;
    double streak;
} band;

typedef struct bands {
    tz_shape_bend bend;
    uint64_t seed;
    TZ_ARRAY(band)
    band;
    int32_t pieces;
    double width, spread, fray, streak_size, grain, soft_share;
    float palette[PALETTE][3];
} bands;

/* s is the bent plane's y plus noise of noise: folds that turn over. */
static tz_status bend_bands(tz_canvas *c, bands *k)
{
    tz_rng *r = &c->rng;
    tz_shape_bend_def d = {.angle = tz_rng_range(r, 0, 2 * TZ_PI), .octaves = 3};
    d.warp_size = c->width * tz_shape_log_range(r, 0.3, 1.4);
    d.warp = d.warp_size * tz_shape_log_range(r, 0.06, 0.5);
    tz_status s = tz_shape_bend_init(c, k->seed + 1, &d, &k->bend);
    if (s != TZ_OK)
        return s;
    double wave = c->width * tz_shape_log_range(r, 0.15, 0.7);
    double fold = wave * tz_shape_log_range(r, 0.06, 0.9);
    double twist = tz_rng_range(r, 0, 0.9);
    double lo = 1e30, hi = -1e30;
    for (int32_t i = 0; i < k->bend.cols * k->bend.rows; i++) {
        float *q = k->bend.node + 2 * (int64_t)i;
        double x = (double)q[0] / (1.8 * wave), y = (double)q[1] / wave;
        double w = (double)tz_canvas_fbm(k->seed + 2, x, y, 2, 0.5);
        q[1] += (float)(fold * (double)tz_canvas_fbm(k->seed + 3, x + twist * w,
                                                     y - twist * w, 4, 0.45));
        lo = fmin(lo, (double)q[1]), hi = fmax(hi, (double)q[1]);
    }
    k->bend.box.y = (int32_t)lo - 20;
    k->bend.box.h = (int32_t)(hi - lo) + 40;
    return TZ_OK;
}

static tz_status draw_bands(tz_canvas *c, bands *k)
{
    tz_rng *r = &c->rng;
    tz_status s = TZ_OK;
    double at = k->bend.box.y - 200, end = k->bend.box.y + k->bend.box.h + 200;
    while (at < end && s == TZ_OK) {
        band b = {.from = (float)at};
        const band *last = k->band.n ? &k->band.v[k->band.n - 1] : NULL;
        for (int attempt = 0; attempt < 6; attempt++) {
            tz_canvas_colour(r, k->palette[tz_rng_below(r, PALETTE)], 0.25, 0.2,
                             b.colour);
            if (!last || contrast(b.colour, last->colour) > 0.3)
                break;
        }
        if (last)
            tz_shape_part(b.colour, last->colour, tz_shape_log_range(r, 0.12, 0.7));
        bool blur = tz_shape_chance(r, k->soft_share);
        for (int q = 0; q < 3 && blur && last; q++) /* a blur that is steep is an edge */
            b.colour[q] = 0.5f * (b.colour[q] + last->colour[q]);
        b.soft = (float)(blur ? tz_rng_range(r, 30, 80) : tz_shape_log_range(r, 1, 7));
        if (last && !blur)
            k->pieces++;
        b.piece = k->pieces;
        b.streak = tz_rng_range(r, 0.05, 0.7);
        at += fmax(k->width * exp(k->spread * tz_rng_normal(r)), blur ? 50 : 3);
        s = tz_array_push(c->ctx, &k->band, b);
    }
    k->pieces++;
    return s;
}

static int32_t band_at(const bands *k, double s)
{
    int32_t lo = 0, hi = k->band.n - 1;
    while (hi - lo > 1) {
        int32_t mid = (lo + hi) / 2;
        if ((double)k->band.v[mid].from <= s)
            lo = mid;
        else
            hi = mid;
    }
    return lo;
}

/* The piece at s where one px is `slope` of s: a piece thinner than 7 px is left to its
 * neighbours, who meet in its middle. */
static int32_t piece_at(const bands *k, int32_t at, double s, double slope)
{
    const band *v = k->band.v;
    int32_t a = at, b = at;
    for (;;) {
        while (a > 0 && v[a - 1].piece == v[a].piece)
            a--;
        while (b + 2 < k->band.n && v[b + 1].piece == v[b].piece)
            b++;
        double top = (double)v[a].from, low = (double)v[b + 1].from;
        if (low - top >= 7 * slope || a == 0 || b + 2 >= k->band.n)
            return v[a].piece;
        if (at == a && at == b)
            at = 2 * s < top + low ? -1 : 1; /* from here on the way to go */
        else if (at > 1 || at < -1)
            at = 2 * s < top + low ? -1 : 1;
        a = b = at < 0 ? a - 1 : b + 1;
    }
}

/* Half of a soft border lies on either side; it never reaches the middle of a band. */
static void band_colour(const bands *k, int32_t at, double s, double slope, float out[3])
{
    const band *b = &k->band.v[at];
    double room = 0.5 * (double)(b[1].from - b->from) / slope;
    double up = (s - (double)b->from) / slope, down = ((double)b[1].from - s) / slope;
    double reach = fmin(0.5 * (double)b->soft, room);
    double wu = at > 0 ? 0.5 * (1 - tz_shape_ramp(-reach, reach, up) * 2 + 1) : 0;
    reach = fmin(0.5 * (double)b[1].soft, room);
    double wd = 0.5 * (1 - tz_shape_ramp(-reach, reach, down) * 2 + 1);
    wu = fmax(0, wu), wd = fmax(0, wd);
    for (int q = 0; q < 3; q++)
        out[q] = b->colour[q] +
                 (float)wu * ((at > 0 ? b[-1].colour[q] : b->colour[q]) - b->colour[q]) +
                 (float)wd * (b[1].colour[q] - b->colour[q]);
}

static void paint_band(tz_canvas *c, const bands *k, const float *s, const float *along,
                       tz_shape_things *t, int64_t i)
{
    int32_t x = (int32_t)(i % c->width), y = (int32_t)(i / c->width);
    /* the fray does not count: it would make a band thick and thin by turns */
    tz_vec2 l = tz_shape_bend_at(&k->bend, fmax(x - 4, 0), y);
    tz_vec2 r = tz_shape_bend_at(&k->bend, fmin(x + 4, c->width), y);
    tz_vec2 u = tz_shape_bend_at(&k->bend, x, fmax(y - 4, 0));
    tz_vec2 d = tz_shape_bend_at(&k->bend, x, fmin(y + 4, c->height));
    double gx = (r.y - l.y) / 8, gy = (d.y - u.y) / 8;
    double slope = fmin(fmax(sqrt(gx * gx + gy * gy), 0.1), 4), at = (double)s[i];
    int32_t b = band_at(k, at);
    c->segment[i] = piece_at(k, b, at, slope);
    float colour[3];
    band_colour(k, b, at, slope, colour);
    tz_canvas_skin *skin = &t->v[c->segment[i]].skin;
    for (int q = 0; q < 3; q++)
        skin->colour[q] = colour[q];
    c->relief[i] = 0;
    tz_canvas_skin_at(c, skin, x, y);
    double n = (double)tz_canvas_fbm(k->seed + 4, at / k->streak_size,
                                     (double)along[i] / (14 * k->streak_size), 3, 0.7);
    const band *own = &k->band.v[b];
    const float *other = k->palette[(b * 7 + 3) % PALETTE];
    tz_shape_dim(c, i, 1 + 0.6 * own->streak * n);
    tz_shape_tint(c, i, other, own->streak * 0.5 * tz_shape_ramp(0.2, 0.6, n));
}

static tz_status paint_bands(tz_canvas *c)
{
    tz_rng *r = &c->rng;
    bands k = {.seed = tz_rng_u64(r)};
    tz_shape_things t = {0};
    float *s = NULL;
    int64_t n = (int64_t)c->width * c->height;
    k.width = tz_shape_log_range(r, 12, 110);
    k.spread = tz_rng_range(r, 0.3, 1);
    k.fray = tz_shape_log_range(r, 0.2, 4);
    k.streak_size = tz_shape_log_range(r, 2, 0.25 * k.width + 3);
    k.grain = tz_shape_log_range(r, 0.06, 0.9);
    k.soft_share = tz_rng_range(r, 0, 0.5);
    draw_palette(r, tz_rng_range(r, 0.5, 1.4), k.palette);
    tz_status status = bend_bands(c, &k);
    if (status == TZ_OK)
        status = draw_bands(c, &k);
    if (status == TZ_OK)
        status = tz_shape_things_init(c, k.pieces, &t);
    if (status == TZ_OK)
        status = tz_alloc(c->ctx, &s, (size_t)n * 2, sizeof *s);
    if (status != TZ_OK)
        goto done;
    double wave = 5 * k.fray + 6;
    for (int64_t i = 0; i < n; i++) {
        double x = (double)(i % c->width) + 0.5, y = (double)(i / c->width) + 0.5;
        tz_vec2 q = tz_shape_bend_at(&k.bend, x, y);
        s[i] = (float)(q.y + k.fray * (double)tz_canvas_fbm(k.seed + 5, x / wave,
                                                            y / wave, 3, 0.6));
        s[n + i] = (float)q.x;
    }
    for (int32_t i = 0; i < k.pieces; i++) {
        tz_canvas_skin_draw(r, k.palette[0], k.width, k.grain, &t.v[i].skin);
        t.v[i].skin.bump *= 0.2f;
    }
    for (int64_t i = 0; i < n; i++)
        paint_band(c, &k, s, s + n, &t, i);
    tz_shape_things_count(c, &t);
    status = tz_shape_things_commit(c, &t);
done:
    tz_free(c->ctx, s);
    tz_shape_things_deinit(c, &t);
    tz_array_free(c->ctx, &k.band);
    tz_shape_bend_deinit(c, &k.bend);
    return status;
}

/* ---- net --------------------------------------------------------------------------- */

typedef struct net {
    tz_shape_bend bend;
    tz_shape_cells cells[2]; /* coarse, fine */
    tz_shape_field swell[3];
    uint64_t seed;
    double pitch, warp, half, fade[3], halo;
    double cloud, cloud_size;
    bool tones; /* cells differ enough to be pieces */
    double spread;
    float body[3], vein[3], second[3];
    float tone[64][3];
} net;

/* What veins do at a pixel: share of their colour, halo, and which of them is nearest. */
typedef struct vein_spot {
    double share, halo;
    int32_t cell;    /* coarse cell, a number below 64 of its tone */
    int32_t side[3]; /* changes across the middle of each vein */
    double strength[3], half[3], edge[3];
} vein_spot;

static void draw_net(tz_canvas *c, net *k)
{
    tz_rng *r = &c->rng;
    k->seed = tz_rng_u64(r);
    k->pitch = tz_shape_log_range(r, 70, 360);
    k->warp = k->pitch * tz_rng_range(r, 0.25, 0.8);
    k->half = tz_shape_chance(r, 0.35) ? tz_shape_log_range(r, 4, 16)
                                       : tz_shape_log_range(r, 0.9, 4);
    k->half = fmin(k->half, 0.05 * k->pitch);
    for (int i = 0; i < 3; i++)
        k->fade[i] = tz_rng_range(r, -0.5, 0.4) + (i ? 0.3 : 0);
    k->halo = tz_shape_chance(r, 0.6) ? tz_rng_range(r, 0.1, 0.5) : 0;
    k->cloud = tz_rng_range(r, 0.1, 0.9);
    k->cloud_size = tz_shape_log_range(r, 15, 120);
    k->tones = tz_shape_chance(r, 0.4);
    k->spread = k->tones ? tz_rng_range(r, 0.3, 0.9) : tz_rng_range(r, 0, 0.08);
    tz_canvas_base_colour(r, k->body);
    double grey = (double)(k->body[0] + k->body[1] + k->body[2]) / 3;
    double up = tz_shape_chance(r, grey > 0.3 ? 0.25 : 0.8)
                    ? fmin(tz_shape_log_range(r, 2, 7), 0.85 / grey)
                    : tz_rng_range(r, 0.08, 0.45);
    float base[3];
    for (int q = 0; q < 3; q++)
        base[q] = (float)fmin(0.9, (double)k->body[q] * up);
    tz_canvas_colour(r, base, 0.2, 0.7, k->vein);
    tz_canvas_colour(r, tz_shape_chance(r, 0.7) ? k->vein : k->body, 0.5, 0.5, k->second);
    for (int i = 0; i < 64; i++)
        tz_canvas_colour(r, k->body, k->spread, 0.5 * k->spread, k->tone[i]);
}

static tz_status build_net(tz_canvas *c, net *k)
{
    tz_rng *r = &c->rng;
    tz_shape_bend_def d = {.angle = tz_rng_range(r, 0, 2 * TZ_PI),
                           .warp = k->warp,
                           .warp_size = 1.7 * k->pitch,
                           .octaves = 4};
    tz_status s = tz_shape_bend_init(c, k->seed + 1, &d, &k->bend);
    double stretch = tz_shape_log_range(r, 1, 3);
    for (int i = 0; i < 2 && s == TZ_OK; i++) {
        double pitch = i ? k->pitch * tz_rng_range(r, 0.25, 0.5) : k->pitch;
        tz_shape_cells_def def = {.pitch_x = pitch * stretch,
                                  .pitch_y = pitch,
                                  .jitter = 1,
                                  .hex = true,
                                  .join_x = 0.3,
                                  .join_y = 0.3,
                                  .join_most = 3};
        s = tz_shape_cells_init(c, k->seed + 2 + (uint64_t)i, k->bend.box, &def,
                                &k->cells[i]);
    }
    for (int i = 0; i < 3 && s == TZ_OK; i++)
        s = tz_shape_field_init(c, k->seed + 5 + (uint64_t)i,
                                k->pitch * (i == 1 ? 0.8 : 1.1), 2, &k->swell[i]);
    return s;
}

static vein_spot net_at(const net *k, int32_t x, int32_t y)
{
    vein_spot p = {0};
    tz_vec2 q = tz_shape_bend_at(&k->bend, x + 0.5, y + 0.5);
    double f = 2.2 * (double)tz_canvas_fbm(k->seed + 9, x / 11.0, y / 11.0, 3, 0.65);
    double g = 2.2 * (double)tz_canvas_fbm(k->seed + 10, x / 11.0, y / 11.0, 2, 0.65);
    double ridge = 0;
    for (int i = 0; i < 3; i++) {
        double pair = 0, edge;
        if (i < 2) {
            tz_shape_cell hit = tz_shape_cells_at(&k->cells[i], q.x + f, q.y + g);
            pair = tz_shape_unit(k->seed + 11, hit.root + hit.other, i);
            edge = hit.edge;
            p.side[i] = hit.root;
        } else { /* level set of noise, its distance by a difference quotient */
            double w = 1 / (1.4 * k->pitch);
            double v =
                (double)tz_canvas_noise(k->seed + 12, (q.x + f) * w, (q.y + g) * w);
            edge = fabs(v) / w * 0.7;
            p.side[i] = v > 0;
        }
        double swell = tz_shape_field_at(&k->swell[i], x, y);
        double strength = tz_shape_ramp(-0.1, 0.6, swell + 0.9 * pair - 0.3 - k->fade[i]);
        double half = k->half * (i ? 0.45 : 1) * (0.25 + strength) * (0.5 + pair);
        p.strength[i] = strength, p.half[i] = half, p.edge[i] = edge;
        double soft = 1 + 0.5 * half;
        ridge = fmax(ridge, fmin(1, 1.4 * strength) *
                                (1 - tz_shape_ramp(half, half + soft, edge)));
        if (i == 0 && (p.side[0] & 1))
            p.halo = strength * exp(-edge / (5 + 2 * k->half));
    }
    p.share = ridge;
    p.cell = p.side[0] & 63;
    return p;
}

static void paint_net_at(tz_canvas *c, const net *k, const tz_shape_things *t,
                         const vein_spot *p, int64_t i)
{
    int32_t x = (int32_t)(i % c->width), y = (int32_t)(i / c->width);
    bool vein = c->segment[i] == 0;
    c->relief[i] = vein ? 0.5f : 0;
    tz_canvas_skin skin = t->v[vein ? 0 : 1].skin;
    for (int q = 0; q < 3; q++)
        skin.colour[q] = vein ? k->vein[q] : k->tone[p->cell][q];
    tz_canvas_skin_at(c, &skin, x, y);
    double u = x / k->cloud_size, v = y / k->cloud_size;
    double w = (double)tz_canvas_fbm(k->seed + 13, u, v, 2, 0.5);
    double n = (double)tz_canvas_fbm(k->seed + 14, u + 1.5 * w, 2 * v - 1.5 * w, 4, 0.65);
    if (!vein) {
        tz_shape_dim(c, i, 1 + 0.55 * k->cloud * n);
        tz_shape_tint(c, i, k->second, 0.6 * k->cloud * tz_shape_ramp(0.25, 0.8, n));
        tz_shape_tint(c, i, k->vein, k->halo * p->halo);
    }
    tz_shape_tint(c, i, k->vein, vein ? 0.2 : 0.9 * p->share);
}

/* A line runs where the side changes towards the right or the lower pixel. */
static void net_lines(tz_canvas *c, const vein_spot *p, bool tones)
{
    for (int32_t y = 0; y + 1 < c->height; y++)
        for (int32_t x = 0; x + 1 < c->width; x++) {
            int64_t i = (int64_t)y * c->width + x;
            for (int m = tones ? 1 : 0; m < 3; m++)
                if ((p[i].side[m] != p[i + 1].side[m] ||
                     p[i].side[m] != p[i + c->width].side[m]) &&
                    p[i].strength[m] > 0.2 && p[i].half[m] > 0.5 && c->segment[i] != 0)
                    c->line[i] = 1;
        }
}

static tz_status paint_net(tz_canvas *c)
{
    net k = {0};
    tz_shape_things t = {0};
    vein_spot *p = NULL;
    int64_t n = (int64_t)c->width * c->height;
    draw_net(c, &k);
    tz_status s = build_net(c, &k);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &p, (size_t)n, sizeof *p);
    if (s == TZ_OK)
        s = tz_shape_things_init(c, 2 + k.cells[0].cols * k.cells[0].rows, &t);
    if (s != TZ_OK)
        goto done;
    for (int64_t i = 0; i < n; i++) {
        p[i] = net_at(&k, (int32_t)(i % c->width), (int32_t)(i / c->width));
        bool vein = false;
        for (int m = 0; m < 3; m++)
            vein |= p[i].half[m] >= 4 && p[i].strength[m] > 0.2 &&
                    p[i].edge[m] < p[i].half[m];
        c->segment[i] = vein ? 0 : k.tones ? 2 + p[i].side[0] : 1;
    }
    for (int32_t i = 0; i < t.n; i++)
        t.v[i].element = i >= 2, t.v[i].depth = 0;
    double rough = tz_rng_range(&c->rng, 0.1, 0.9);
    for (int m = 0; m < 2; m++) {
        tz_canvas_skin_draw(&c->rng, k.body, 60, rough, &t.v[m].skin);
        t.v[m].skin.bump *= 0.4f;
    }
    for (int64_t i = 0; i < n; i++)
        paint_net_at(c, &k, &t, &p[i], i);
    net_lines(c, p, k.tones);
    tz_shape_things_count(c, &t);
    s = tz_shape_things_commit(c, &t);
done:
    tz_free(c->ctx, p);
    tz_shape_things_deinit(c, &t);
    for (int i = 0; i < 3; i++)
        tz_shape_field_deinit(c, &k.swell[i]);
    for (int i = 0; i < 2; i++)
        tz_shape_cells_deinit(c, &k.cells[i]);
    tz_shape_bend_deinit(c, &k.bend);
    return s;
}

tz_status tz_scene_VEINS(tz_canvas *c)
{
    return tz_shape_chance(&c->rng, 0.5) ? paint_bands(c) : paint_net(c);
}
