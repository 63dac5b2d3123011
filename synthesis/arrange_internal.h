/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Parts of the arrangement: features, prepared groups, canvas, seams. Private. */
#ifndef TZ_SYNTHESIS_ARRANGE_INTERNAL_H
#define TZ_SYNTHESIS_ARRANGE_INTERNAL_H

#if defined(__SSE2__)
#include <emmintrin.h>
#endif
#include <stdatomic.h>
#include <string.h>

#include "base/rng.h"
#include "elements/domain.h"
#include "elements/neighbourhood.h"
#include "synthesis/arrange.h"

/* ---- features --------------------------------------------------------------------- */

/** Eight bytes a pixel, scaled so that a byte's difference means about as much in each
 * channel. Only the last two change when a piece is turned or mirrored. */
enum {
    TZ_FEATURE_L, /**< lightness, mean of 3 px */
    TZ_FEATURE_A, /**< colour */
    TZ_FEATURE_B,
    TZ_FEATURE_BUSY,  /**< mean gradient magnitude */
    TZ_FEATURE_LINE,  /**< lightness against its surroundings of 17 px: joints, cracks */
    TZ_FEATURE_EDGE,  /**< closeness to an edge of the EBPT */
    TZ_FEATURE_ALONG, /**< direction of structure: cos of twice its angle, by strength */
    TZ_FEATURE_SLANT, /**< and sin */
    TZ_FEATURES
};

typedef struct tz_feature {
    uint8_t v[TZ_FEATURES];
} tz_feature;

/** Means and deviations that several exemplars share, so that they can be compared. */
typedef struct tz_feature_scale {
    double mean[TZ_FEATURES], gain[TZ_FEATURES];
} tz_feature_scale;

typedef struct tz_feature_map {
    int32_t width, height;
    tz_feature *v; /**< width * height */
    int32_t half_width, half_height;
    tz_feature
        *half; /**< every second of every second row: fits the cache when places are
                           only sought roughly */
} tz_feature_map;

/** Features of n exemplars on one scale. */
tz_status tz_feature_maps_init(tz_ctx *ctx, const tz_exemplar *ex, int32_t n,
                               tz_feature_map *out);
void tz_feature_maps_deinit(tz_ctx *ctx, tz_feature_map *map, int32_t n);

/* ---- groups ----------------------------------------------------------------------- */

enum {
    TZ_THIN_LEVELS = 3
}; /* density 1, 1/2, 1/4 and below: larger pieces hardly turn */
enum { TZ_RAYS = 64, TZ_RINGS = 24, TZ_BORDER = 128, TZ_SIMILAR = 6 };

/** Edge group made ready for placing: a star about the region's centre. */
typedef struct tz_star {
    int32_t exemplar, group;
    tz_vec2 centre;        /**< source px */
    float radius[TZ_RAYS]; /**< hull of region and edges, at least the piece size */
    float limit[TZ_RAYS];  /**< farthest that a seam may run */
    float mean_radius, size;
    int32_t neighbours; /**< as the exemplar surrounds it */
    tz_neighbour neighbour[TZ_NEIGHBOURS_MAX];
    int32_t similar[TZ_SIMILAR]; /**< stars with the most similar neighbourhoods, -1 */
} tz_star;

/** What the exemplar's own statistics allow. */
typedef struct tz_freedom {
    double rotation; /**< rad either way; pi = any */
    double bend;     /**< rad that a piece may turn further to follow what is around */
    bool mirror_x, mirror_y;
} tz_freedom;

/** Stars in blocks of `count`: block 0 as the exemplars want them, further blocks the same
 * groups cut to other sizes, as rules ask (granular structure, density) and frames (each
 * level of thinning halves the pieces of an area). */
typedef struct tz_stars {
    TZ_ARRAY(tz_star)
    star;
    int32_t count;
    int32_t *of_group[64]; /**< per exemplar: group -> star of block 0, or -1 */
    int32_t *first; /**< exemplar e owns stars first[e] .. first[e + 1] - 1 of block 0 */
    int32_t levels; /**< of thinning, >= 1 */
    int32_t *block; /**< per rule and level: where its block begins */
    double reach;   /**< largest limit, px */
} tz_stars;

/** @param levels  of thinning that places may ask for, 1 .. TZ_THIN_LEVELS */
tz_status tz_stars_init(tz_ctx *ctx, const tz_exemplar *ex, int32_t n,
                        const tz_rules *rules, double piece, int32_t levels, tz_stars *s);
void tz_stars_deinit(tz_ctx *ctx, tz_stars *s, int32_t n);
tz_status tz_freedom_measure(tz_ctx *ctx, const tz_exemplar *ex, tz_freedom *f);

/* ---- canvas ----------------------------------------------------------------------- */

/** Layout at one cell a TZ_CELL px: features of what is shown, and by which piece. */
#define TZ_CELL 4
typedef struct tz_canvas {
    int32_t nx, ny; /**< cells of the layout */
    int32_t ring;   /**< rows held; row j is at j % ring */
    bool torus;
    tz_feature *feature;
    int32_t *label; /**< piece key, -1 = void */
    int32_t fixed;  /**< keys from here on belong to fixed placements: never covered */
} tz_canvas;

/** Cell of a coordinate: floor(x / TZ_CELL) for |x| < 2^30. */
static inline int32_t tz_cell(double x)
{
    const int32_t i = (int32_t)(x * (1.0 / TZ_CELL));
    return i - (x < i * (double)TZ_CELL);
}

static inline int64_t tz_canvas_at(const tz_canvas *c, int32_t i, int32_t j)
{
    if (c->torus) {
        if (i < 0 || i >= c->nx)
            i %= c->nx, i += i < 0 ? c->nx : 0;
        if (j < 0 || j >= c->ny)
            j %= c->ny, j += j < 0 ? c->ny : 0;
    } else if (i < 0 || j < 0 || i >= c->nx || j >= c->ny) {
        return -1;
    }
    if (c->ring < c->ny)
        j %= c->ring;
    return (int64_t)j * c->nx + i;
}

/** Placed piece while growing. */
typedef struct tz_grown {
    int32_t star;
    tz_affine map, inv;
    tz_vec2 centre;          /**< layout px */
    float border[TZ_BORDER]; /**< radii of its border, source px from the star's centre */
} tz_grown;

/** Nearest feature to source px (x, y). */
static inline tz_feature tz_feature_at(const tz_feature_map *f, double x, double y)
{
    int32_t i = (int32_t)x, j = (int32_t)y;
    i = i < 0 ? 0 : i >= f->width ? f->width - 1 : i;
    j = j < 0 ? 0 : j >= f->height ? f->height - 1 : j;
    return f->v[(int64_t)j * f->width + i];
}

/** Sum of absolute differences of two features, 0 .. 2040. */
static inline int32_t tz_feature_distance(tz_feature a, tz_feature b)
{
#if defined(__SSE2__)
    return _mm_cvtsi128_si32(_mm_sad_epu8(_mm_loadl_epi64((const __m128i *)a.v),
                                          _mm_loadl_epi64((const __m128i *)b.v)));
#else
    int32_t s = 0;
    for (int k = 0; k < TZ_FEATURES; k++) {
        const int32_t d = (int32_t)a.v[k] - (int32_t)b.v[k];
        s += d < 0 ? -d : d;
    }
    return s;
#endif
}

/** How a map changes directions: mirrored, then turned. The matrix of the pair ALONG,
 * SLANT, by rows, times 128. */
typedef struct tz_turn {
    int16_t m[4];
    bool plain; /**< leaves features as they are, within a few degrees */
} tz_turn;

static inline tz_turn tz_turn_of(tz_affine map)
{
    const double n = map.a * map.a + map.b * map.b;
    const double flip = tz_affine_det(map) < 0 ? -128 : 128;
    double c = 1, s = 0; /* of twice the angle */
    if (n > 0)
        c = (map.a * map.a - map.b * map.b) / n, s = 2 * map.a * map.b / n;
    return (tz_turn){{(int16_t)lrint(128 * c), (int16_t)lrint(-flip * s),
                      (int16_t)lrint(128 * s), (int16_t)lrint(flip * c)},
                     flip > 0 && c > 0 && fabs(s) < 0.15};
}

/** The feature as a placed piece shows it. */
static inline tz_feature tz_feature_turn(tz_feature f, const tz_turn *t)
{
    if (t->plain)
        return f;
#if defined(__SSE2__)
    /* the pair to words about 0, both rows' products and sums, back to bytes */
    const __m128i q = _mm_loadl_epi64((const __m128i *)f.v);
    const __m128i m = _mm_loadl_epi64((const __m128i *)t->m);
    __m128i w = _mm_unpacklo_epi8(_mm_srli_epi64(q, 48), _mm_setzero_si128());
    w = _mm_shuffle_epi32(_mm_sub_epi16(w, _mm_set1_epi16(128)), 0);
    w = _mm_add_epi32(_mm_srai_epi32(_mm_madd_epi16(w, m), 7), _mm_set1_epi32(128));
    w = _mm_packs_epi32(w, w);
    w = _mm_slli_epi64(_mm_packus_epi16(w, w), 48);
    const __m128i rest = _mm_srli_epi64(_mm_slli_epi64(q, 16), 16);
    _mm_storel_epi64((__m128i *)f.v, _mm_or_si128(rest, w));
#else
    const int32_t a = f.v[TZ_FEATURE_ALONG] - 128, b = f.v[TZ_FEATURE_SLANT] - 128;
    for (int k = 0; k < 2; k++) {
        const int32_t v = 128 + ((t->m[2 * k] * a + t->m[2 * k + 1] * b) >> 7);
        f.v[TZ_FEATURE_ALONG + k] = (uint8_t)(v < 0 ? 0 : v > 255 ? 255 : v);
    }
#endif
    return f;
}

/** Nearest of the halved map to source px (x, y). */
static inline tz_feature tz_feature_near(const tz_feature_map *f, double x, double y)
{
    int32_t i = (int32_t)(0.5 * x), j = (int32_t)(0.5 * y);
    i = i < 0 ? 0 : i >= f->half_width ? f->half_width - 1 : i;
    j = j < 0 ? 0 : j >= f->half_height ? f->half_height - 1 : j;
    return f->half[(int64_t)j * f->half_width + i];
}

/** Ray of TZ_RAYS nearest to direction (x, y), give or take a hundredth of a ray. */
static inline int tz_ray_of(double x, double y)
{
    /* angle in turns: atan(t) / 2 pi for 0 <= t <= 1 by t / (8 (...)), then by octants */
    const double ax = fabs(x), ay = fabs(y);
    const double lo = ax < ay ? ax : ay, hi = ax < ay ? ay : ax;
    const double t = hi > 0 ? lo / hi : 0;
    double a = t * (0.125 + (1 - t) * (0.03895 + 0.01055 * t));
    if (ay > ax)
        a = 0.25 - a;
    if (x < 0)
        a = 0.5 - a;
    if (y < 0)
        a = 1 - a;
    return (int)(a * TZ_RAYS + 0.5) % TZ_RAYS;
}

/** Direction of ray k of n. */
static inline tz_vec2 tz_ray(int k, int n)
{
    const double a = 2 * TZ_PI * k / n;
    return (tz_vec2){cos(a), sin(a)};
}

/* ---- seam ------------------------------------------------------------------------- */

/** Best closed border of a star at `map` over the canvas: dynamic programming over
 * rays x rings.
 * @param step  1: every ray and ring; 2: every second, to judge a candidate
 * @param[out] radius  TZ_RAYS radii in source px
 * @return mean mismatch along the part of the seam that meets filled cells, 0 if none */
double tz_seam_find(const tz_canvas *canvas, const tz_feature_map *f, const tz_star *star,
                    tz_affine map, int step, float radius[TZ_RAYS]);

/** What a layout point shows now: its feature at full resolution; false in the void. */
typedef bool (*tz_shown)(const void *user, double x, double y, tz_feature *f);

/** Takes a seam from rays x rings to pixels: the same search in a band of a few px about
 * it, against what is shown at full resolution.
 * @param[out] border  TZ_BORDER radii in source px */
void tz_seam_refine(const void *user, tz_shown shown, const tz_feature_map *f,
                    const tz_star *star, tz_affine map, const float radius[TZ_RAYS],
                    float border[TZ_BORDER]);

/** Writes a piece into the canvas, except over fixed ones.
 * @param border  n layout points, x and y interleaved, of a simple polygon
 * @param scratch room for n numbers */
void tz_canvas_draw(tz_canvas *canvas, const tz_feature_map *f, tz_affine map,
                    tz_affine inv, const double *border, int32_t n, double *scratch,
                    int32_t key);

/** Border of a grown star in layout px, 2 * TZ_BORDER numbers. */
void tz_grown_border(const tz_star *star, const tz_grown *g, double *border);

/* ---- growing ---------------------------------------------------------------------- */

/** A piece's key: its tile's index << TZ_KEY_BITS | its number in the tile. */
enum { TZ_KEY_BITS = 12 };

typedef TZ_ARRAY(tz_grown)
tz_grown_list;

/** State of one arrangement. */
typedef struct tz_grower {
    const tz_exemplar *ex;
    int32_t n;
    const tz_rules *rules;
    tz_arrange_params p;
    double piece;
    double largest; /* size that frames ask for anywhere, and pieces by thinning, >= 1 */
    tz_stars stars;
    tz_feature_map *map;
    tz_freedom *freedom;
    tz_canvas canvas;
    int32_t strip, span; /* cells: height of a strip, width of a tile */
    int32_t strips, tiles;
    tz_grown_list *tile;  /* strips * tiles */
    atomic_int *progress; /* tiles done, per strip */
    atomic_bool stop;
} tz_grower;

static inline const tz_grown *tz_grower_piece(const tz_grower *g, int32_t key)
{
    return &g->tile[key >> TZ_KEY_BITS].v[key & ((1 << TZ_KEY_BITS) - 1)];
}

/** Whether a rule lets a star be placed. */
bool tz_star_allowed(const tz_grower *g, const tz_rule *r, const tz_star *s);

/** Chooses and lays the piece that covers the void layout point v. Reads the canvas around,
 * changes nothing. `rng` names the place. */
tz_grown tz_place_choose(const tz_grower *g, tz_vec2 v, tz_rng *rng);

/** Puts the fixed placements of a layout on the canvas. */
tz_status tz_grower_draw_fixed(tz_ctx *ctx, tz_grower *g, const tz_layout *l);

/** Fills the canvas; pieces come to stand in g->tile. */
tz_status tz_grower_run(tz_ctx *ctx, tz_grower *g);

#endif
