/* SPDX-License-Identifier: Apache-2.0 */
/* The choice of one piece: what lies around the void place, which groups could go there,
 * how well each fits, and where its seam would run. */
#include <string.h>

#include "synthesis/arrange_internal.h"

enum {
    POINTS = 512, /* overlap points compared, at most */
    BEST = 16,    /* candidates kept of all, at most */
    NEAR = 48     /* placed pieces looked at around a place */
};

typedef struct candidate {
    int32_t star;
    bool coherent;
    tz_affine map;
    tz_vec2 centre;
    double score;
} candidate;

typedef struct overlap {
    int32_t n;
    float x[POINTS], y[POINTS];
    tz_feature f[POINTS];
} overlap;

/* Placed piece around: where its middle comes from and where it stands. */
typedef struct echo {
    tz_vec2 from, to;
    int32_t exemplar;
} echo;

typedef struct place {
    tz_vec2 at;      /* the void point, layout px */
    tz_vec2 towards; /* from it to the middle of the void around */
    const tz_rule *rule;
    int32_t rule_index;
    double size,
        piece;     /* as the frame has them here: factor; wanted diameter, layout px */
    int32_t level; /* of thinning */
    overlap coarse, dense;
    int32_t near[NEAR], nears; /* keys of placed pieces around */
    echo echo[NEAR];
    int32_t touching; /* the first of them lie within a piece's reach */
} place;

/* ---- the place --------------------------------------------------------------------- */

static void add_near(place *pl, int32_t key)
{
    for (int32_t k = 0; k < pl->nears; k++)
        if (pl->near[k] == key)
            return;
    if (pl->nears < NEAR)
        pl->near[pl->nears++] = key;
}

static void collect(const tz_grower *g, tz_vec2 mid, double radius, int32_t stride,
                    overlap *o)
{
    const tz_canvas *c = &g->canvas;
    o->n = 0;
    const int32_t ci = (int32_t)floor(mid.x / TZ_CELL),
                  cj = (int32_t)floor(mid.y / TZ_CELL);
    const int32_t r = (int32_t)(radius / TZ_CELL);
    for (int32_t j = cj - r; j <= cj + r; j += stride)
        for (int32_t i = ci - r; i <= ci + r; i += stride) {
            const int64_t at = tz_canvas_at(c, i, j);
            if (at < 0 || c->label[at] < 0 || o->n >= POINTS)
                continue;
            if ((i - ci) * (i - ci) + (j - cj) * (j - cj) > r * r)
                continue;
            o->x[o->n] = ((float)i + 0.5F) * TZ_CELL;
            o->y[o->n] = ((float)j + 0.5F) * TZ_CELL;
            o->f[o->n++] = c->feature[at];
        }
}

static double size_at(const tz_grower *g, tz_vec2 v)
{
    return g->p.frames ? tz_frames_size(g->p.frames, (tz_vec3){v.x, v.y, 0}) : 1;
}

static double turn_at(const tz_grower *g, tz_vec2 v)
{
    return g->p.frames ? tz_frames_angle(g->p.frames, (tz_vec3){v.x, v.y, 0}) : 0;
}

/* How large pieces are here, and which block of stars is as sparse as is said. */
static void look_up_frame(const tz_grower *g, tz_vec2 v, place *pl)
{
    pl->size = size_at(g, v);
    pl->level = 0;
    if (g->stars.levels > 1) {
        const double thin = tz_frames_apart(g->p.frames, (tz_vec3){v.x, v.y, 0});
        const double level = floor(2 * log2(thin / pl->size) + 0.5);
        pl->level = (int32_t)fmin(fmax(level, 0), g->stars.levels - 1);
    }
    pl->piece = g->piece * pl->size * pow(2, 0.5 * pl->level);
}

static int32_t block_of(const tz_grower *g, const place *pl)
{
    return g->stars.block[pl->rule_index * g->stars.levels + pl->level];
}

static void look_around(const tz_grower *g, tz_vec2 v, tz_rng *rng, place *pl)
{
    const tz_canvas *c = &g->canvas;
    look_up_frame(g, v, pl);
    const double piece = pl->piece;
    pl->at = v;
    pl->nears = 0;
    pl->rule_index =
        tz_rules_at(g->rules, g->p.size[0], g->p.size[1], v, tz_rng_unit(rng));
    pl->rule = &g->rules->rule.v[pl->rule_index];
    const int32_t ci = (int32_t)floor(v.x / TZ_CELL), cj = (int32_t)floor(v.y / TZ_CELL);
    const int32_t r = (int32_t)(0.75 * piece / TZ_CELL) + 1;
    const int32_t pace = (int32_t)fmax(2, 2 * piece / g->piece);
    double sx = 0, sy = 0, n = 0;
    for (int32_t j = -r; j <= r; j += pace)
        for (int32_t i = -r; i <= r; i += pace) {
            const int64_t at = tz_canvas_at(c, ci + i, cj + j);
            if (at < 0)
                continue;
            if (c->label[at] < 0)
                sx += i, sy += j, n++;
            else if (i * i + j * j <= r * r)
                add_near(pl, c->label[at]);
        }
    pl->touching = pl->nears;
    pl->towards = n > 0 ? (tz_vec2){sx / n * TZ_CELL, sy / n * TZ_CELL} : (tz_vec2){0, 0};
    const int32_t far = (int32_t)(2.2 * piece / TZ_CELL),
                  step = far / 7 > 0 ? far / 7 : 1;
    for (int32_t j = -far; j <= far / 2; j += step)
        for (int32_t i = -far; i <= far; i += step) {
            const int64_t at = tz_canvas_at(c, ci + i, cj + j);
            if (at >= 0 && c->label[at] >= 0)
                add_near(pl, c->label[at]);
        }
    for (int32_t k = 0; k < pl->nears; k++) {
        const tz_grown *q = tz_grower_piece(g, pl->near[k]);
        const tz_star *s = &g->stars.star.v[q->star];
        pl->echo[k] = (echo){s->centre, q->centre, s->exemplar};
    }
    const tz_vec2 mid = tz_vec2_add(v, tz_vec2_scale(pl->towards, 0.6));
    /* about 100 and 200 points, filled or not, whatever the piece */
    const double cells = 0.75 * piece / TZ_CELL;
    collect(g, mid, 0.75 * piece, (int32_t)fmax(1, cells / 6), &pl->coarse);
    collect(g, mid, 0.8 * piece, (int32_t)fmax(1, cells / 8), &pl->dense);
}

/* ---- candidates ---------------------------------------------------------------------- */

bool tz_star_allowed(const tz_grower *g, const tz_rule *r, const tz_star *s)
{
    if (r->source >= 0 && r->source != s->exemplar)
        return false;
    if (s->size < r->size[0] || s->size > r->size[1])
        return false;
    const tz_ebpt *e = g->ex[s->exemplar].ebpt;
    const tz_edge_group *eg = &e->group.v[s->group];
    if (r->groups.n) {
        bool found = false;
        for (int32_t k = 0; k < r->groups.n; k++)
            found |= r->groups.v[k] == s->group;
        if (!found)
            return false;
    }
    if (r->length_bins == ~0U && r->angle_bins == ~0U)
        return true;
    if ((r->length_bins >> eg->length_bin & 1) && (r->angle_bins >> eg->angle_bin & 1))
        return true;
    for (int32_t k = eg->edge; k < eg->edge + eg->edges; k++) {
        const tz_edge *d = &e->edge.v[e->group_edge.v[k]];
        if ((r->length_bins >> d->length_bin & 1) && (r->angle_bins >> d->angle_bin & 1))
            return true;
    }
    return false;
}

/* Smallest distance of two points on the domain. */
static double apart(const tz_grower *g, tz_vec2 a, tz_vec2 b)
{
    const tz_domain d = {.size = {g->p.size[0], g->p.size[1], 0}, .torus = g->p.tile};
    const tz_vec3 v =
        tz_domain_vector(&d, (tz_vec3){a.x, a.y, 0}, (tz_vec3){b.x, b.y, 0});
    return sqrt(v.x * v.x + v.y * v.y);
}

/* Mean feature distance over the overlap points that the star covers. Gives up, and returns
 * more than `limit`, once the first half of the points is clearly worse than that. */
static double compare(const tz_grower *g, const place *pl, const overlap *o,
                      const candidate *c, double limit)
{
    const tz_star *s = &g->stars.star.v[c->star];
    const tz_feature_map *f = &g->map[s->exemplar];
    tz_affine inv;
    if (!tz_affine_invert(c->map, &inv))
        return INFINITY;
    const float a = (float)inv.a, b = (float)inv.b, cc = (float)inv.c, d = (float)inv.d;
    const float ex = (float)(inv.a * c->centre.x + inv.c * c->centre.y + inv.e);
    const float ey = (float)(inv.b * c->centre.x + inv.d * c->centre.y + inv.f);
    const float ox = (float)c->centre.x, oy = (float)c->centre.y;
    const float r2 = 1.2F * s->mean_radius * 1.2F * s->mean_radius;
    const float right = (float)f->width - 0.02F, bottom = (float)f->height - 0.02F;
    /* rough comparisons look at the halved map */
    const bool rough = o == &pl->coarse;
    const tz_feature *v = rough ? f->half : f->v;
    const int64_t stride = rough ? f->half_width : f->width;
    const float unit = rough ? 0.5F : 1;
    const tz_turn turn = tz_turn_of(c->map);
    /* First where all points fall, then their features. No branch depends on a point: the
     * first loop is vectorised, the second never waits for a wrong guess; points outside
     * the star or the photo are read at its border and masked. */
    int32_t column[POINTS], row[POINTS], hit[POINTS]; /* hit: all bits or none */
    for (int32_t k = 0; k < o->n; k++) {
        const float dx = o->x[k] - ox, dy = o->y[k] - oy;
        const float ux = a * dx + cc * dy, uy = b * dx + d * dy;
        const float px = ux + ex, py = uy + ey;
        float qx = px < 0 ? 0 : px, qy = py < 0 ? 0 : py;
        qx = qx > right ? right : qx, qy = qy > bottom ? bottom : qy;
        column[k] = (int32_t)(unit * qx), row[k] = (int32_t)(unit * qy);
        hit[k] = -((ux * ux + uy * uy <= r2) & (qx == px) & (qy == py));
    }
    int32_t sum = 0, n = 0;
    for (int32_t half = 0; half < 2; half++) {
        if (turn.plain)
            for (int32_t k = half; k < o->n; k += 2) {
                const tz_feature q = v[row[k] * stride + column[k]];
                sum += tz_feature_distance(o->f[k], q) & hit[k];
                n -= hit[k];
            }
        else
            for (int32_t k = half; k < o->n; k += 2) {
                const tz_feature q = v[row[k] * stride + column[k]];
                sum += tz_feature_distance(o->f[k], tz_feature_turn(q, &turn)) & hit[k];
                n -= hit[k];
            }
        if (half == 0 && sum > 1.25 * limit * n)
            break;
    }
    return n ? (double)sum / n : 0;
}

/* A group seen again too near to itself. */
static double repetition(const tz_grower *g, const place *pl, const candidate *c)
{
    const tz_star *s = &g->stars.star.v[c->star];
    const double range = 2.5 * pl->piece, piece = g->piece;
    double cost = 0;
    for (int32_t k = 0; k < pl->nears; k++) {
        const echo *q = &pl->echo[k];
        /* the same source pixels ... */
        const double sx = q->from.x - s->centre.x, sy = q->from.y - s->centre.y;
        const double same = sx * sx + sy * sy;
        if (same > piece * piece || q->exemplar != s->exemplar)
            continue;
        const double d = apart(g, q->to, c->centre);
        if (d >= range)
            continue;
        /* ... shown by another map: not what runs on */
        const tz_affine m = tz_grower_piece(g, pl->near[k])->map;
        const tz_vec2 drift = tz_vec2_sub(tz_affine_apply(m, s->centre),
                                          tz_affine_apply(c->map, s->centre));
        if (tz_vec2_dot(drift, drift) < 9)
            continue;
        cost += 500 * (1 - sqrt(same) / piece) * (1 - 0.6 * d / range);
    }
    return cost;
}

/* Score that a candidate must beat to be kept. */
static double bar(const candidate best[BEST], int32_t n)
{
    return n < BEST ? INFINITY : best[BEST - 1].score;
}

static void keep(candidate best[BEST], int32_t *n, candidate c)
{
    int32_t at = *n;
    if (at == BEST) {
        if (c.score >= best[BEST - 1].score)
            return;
        at--;
    } else {
        (*n)++;
    }
    while (at > 0 && best[at - 1].score > c.score)
        best[at] = best[at - 1], at--;
    best[at] = c;
}

/* Angles that a rule allows to pieces of an exemplar, before its field; and factors. */
static void ranges(const tz_grower *g, const tz_rule *r, int32_t exemplar,
                   double angle[2], const double **scale)
{
    const double free = g->freedom[exemplar].rotation, rad = TZ_PI / 180;
    angle[0] = -free, angle[1] = free;
    if (!isnan(r->rotation[0]))
        angle[0] = r->rotation[0], angle[1] = r->rotation[1];
    else if (!g->p.rotate_auto)
        angle[0] = g->p.rotation[0] * rad, angle[1] = g->p.rotation[1] * rad;
    *scale = isnan(r->scale[0]) ? g->p.scale : r->scale;
}

/* Directions and sizes that change from place to place leave this much to what runs on. */
static const double field_turn = 0.1, field_scale = 1.08;

/* Whether a piece may run on here under its neighbour's map: that may lie in the region of
 * another rule. Mirrored pieces may stand on their heads. */
static bool map_allowed(const tz_grower *g, const place *pl, int32_t exemplar,
                        tz_affine m)
{
    double angle[2];
    const double *scale, slack = 1e-6, more = g->p.frames ? field_scale : 1;
    if (pl->rule->field >= 0)
        return false;
    ranges(g, pl->rule, exemplar, angle, &scale);
    const double det = tz_affine_det(m), s = sqrt(fabs(det)) / pl->size;
    if (s < scale[0] / more - slack || s > scale[1] * more + slack)
        return false;
    if (g->p.frames) {
        const double turn = turn_at(g, pl->at),
                     free = g->p.frames->turned ? field_turn : 0;
        angle[0] += turn - free, angle[1] += turn + free;
    }
    const double turn = det < 0 ? TZ_PI : 2 * TZ_PI;
    if (g->p.rotate_auto && isnan(pl->rule->rotation[0])) {
        const double bend = g->freedom[exemplar].bend;
        angle[0] -= bend, angle[1] += bend;
    }
    const double above = atan2(-m.c, m.d) - angle[0] + slack;
    return above - floor(above / turn) * turn <= angle[1] - angle[0] + 2 * slack;
}

/* Map that lays the star's centre on `at`, with a drawn turn, scale, stretch and mirror. A
 * stretch of a few per cent is not seen, but makes that no two copies are alike. */
static tz_affine draw_map(const tz_grower *g, const place *pl, const tz_star *star,
                          tz_vec2 at, tz_rng *rng)
{
    const int32_t exemplar = star->exemplar;
    double angle, scale, turns[2];
    const double *range;
    bool mirror;
    const tz_rule *r = pl->rule;
    const tz_freedom *f = &g->freedom[exemplar];
    const double u = tz_rng_unit(rng), w = tz_rng_unit(rng), m = tz_rng_unit(rng);
    const double v = tz_rng_unit(rng);
    mirror = false;
    ranges(g, r, exemplar, turns, &range);
    angle = turns[0] + u * (turns[1] - turns[0]);
    if (r->field >= 0)
        angle += tz_rules_field(g->rules, pl->rule_index, g->p.size[0], g->p.size[1], at);
    angle += turn_at(g, at);
    scale = range[0] * pow(range[1] / range[0], w) * size_at(g, at);
    if (g->p.mirror == 2 || (g->p.mirror == 0 && f->mirror_x))
        mirror = m < 0.5;
    if (g->p.mirror == 0 && f->mirror_y && !f->mirror_x && m < 0.5) {
        mirror = true; /* a mirrored copy turned half round is upside down */
        angle += TZ_PI;
    }
    const double stretch = pow(fmin(range[1] / range[0], 1.13), 0.6 * (v - 0.5));
    const tz_affine squash = {stretch,
                              0,
                              0,
                              1 / stretch,
                              star->centre.x * (1 - stretch),
                              star->centre.y * (1 - 1 / stretch)};
    return tz_affine_then(squash,
                          tz_affine_place(star->centre, at, angle, scale, mirror));
}

static bool covers(const tz_star *s, const candidate *c, tz_vec2 v, double share)
{
    tz_affine inv;
    if (!tz_affine_invert(c->map, &inv))
        return false;
    const tz_vec2 p = tz_vec2_sub(tz_affine_apply(inv, v), s->centre);
    const double limit = share * s->limit[tz_ray_of(p.x, p.y)];
    return tz_vec2_dot(p, p) <= limit * limit;
}

/* Lays star `id` towards the void with the given jitter and judges it. */
static void try_star(const tz_grower *g, const place *pl, int32_t id, tz_rng *rng,
                     candidate best[], int32_t *n)
{
    const tz_star *s = &g->stars.star.v[id];
    const double u = tz_rng_unit(rng), w = tz_rng_unit(rng);
    const double length = tz_vec2_length(pl->towards) + 1e-9;
    const double r = s->mean_radius * pl->size;
    const double off = fmin(length, (0.35 + 0.4 * u) * r);
    const double side = (w - 0.5) * 0.8 * r;
    tz_vec2 c = tz_vec2_add(pl->at, tz_vec2_scale(pl->towards, off / length));
    c.x -= pl->towards.y / length * side, c.y += pl->towards.x / length * side;
    candidate k = {id, false, draw_map(g, pl, s, c, rng), c, 0};
    if (!covers(s, &k, pl->at, 0.85))
        return;
    k.score = pl->rule->structure == TZ_STRUCTURE_RANDOM
                  ? 1000 * tz_rng_unit(rng)
                  : compare(g, pl, &pl->coarse, &k, bar(best, *n));
    if (k.score >= bar(best, *n))
        return;
    k.score += repetition(g, pl, &k);
    keep(best, n, k);
}

/* Groups that run on from a placed neighbour, and groups that look like them. */
static void try_neighbours(const tz_grower *g, const place *pl, tz_rng *rng,
                           candidate best[], int32_t *n)
{
    for (int32_t k = 0; k < pl->touching; k++) {
        const tz_grown *q = tz_grower_piece(g, pl->near[k]);
        const tz_star *t = &g->stars.star.v[q->star];
        const tz_ebpt *e = g->ex[t->exemplar].ebpt;
        if (e->neighbour_first.n <= t->group + 1)
            continue;
        for (int32_t j = e->neighbour_first.v[t->group];
             j < e->neighbour_first.v[t->group + 1]; j++) {
            int32_t id = g->stars.of_group[t->exemplar][e->neighbour.v[j]];
            if (id < 0)
                continue;
            const int32_t block = block_of(g, pl);
            id += block;
            const tz_star *s = &g->stars.star.v[id];
            candidate c = {id, true, q->map, tz_affine_apply(q->map, s->centre), 0};
            const double u = tz_rng_unit(rng);
            if (!covers(s, &c, pl->at, 0.85))
                continue;
            if (u < g->p.coherence && tz_star_allowed(g, pl->rule, s) &&
                map_allowed(g, pl, s->exemplar, c.map)) {
                c.score =
                    compare(g, pl, &pl->coarse, &c, INFINITY) + repetition(g, pl, &c);
                keep(best, n, c);
            }
            for (int m = 0; m < TZ_SIMILAR && s->similar[m] >= 0; m++) {
                const int32_t like = block + s->similar[m];
                const tz_star *z = &g->stars.star.v[like];
                if (!tz_star_allowed(g, pl->rule, z))
                    continue;
                candidate d = {like, false, draw_map(g, pl, z, c.centre, rng), c.centre,
                               0};
                if (!covers(z, &d, pl->at, 0.85))
                    continue;
                d.score = compare(g, pl, &pl->coarse, &d, bar(best, *n));
                if (d.score >= bar(best, *n))
                    continue;
                d.score += repetition(g, pl, &d);
                keep(best, n, d);
            }
        }
    }
}

static candidate moved(candidate c, double dx, double dy)
{
    c.map.e += dx, c.map.f += dy;
    c.centre.x += dx, c.centre.y += dy;
    return c;
}

static candidate turned(candidate c, double angle)
{
    c.map = tz_affine_then(c.map, tz_affine_place(c.centre, c.centre, angle, 1, false));
    return c;
}

/* Whether the arrangement is free to turn pieces here. */
static bool automatic(const tz_grower *g, const tz_rule *r)
{
    return g->p.rotate_auto && isnan(r->rotation[0]) && r->field < 0;
}

/* Moves a candidate downhill: by 8 and 4 px on the coarse points, by 2 and 1 on all; where
 * the exemplar itself bends, also turns it, by 4 degrees down to half a degree. */
static void refine(const tz_grower *g, const place *pl, candidate *c)
{
    static const int8_t dir[6][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                     {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    const tz_star *s = &g->stars.star.v[c->star];
    const double least = g->p.frames && g->p.frames->turned ? field_turn : TZ_PI;
    const double bend =
        automatic(g, pl->rule) ? fmin(g->freedom[s->exemplar].bend, least) : 0;
    const int ways = bend > 0 ? 6 : 4;
    const overlap *o = &pl->coarse;
    double angle = 0, here = compare(g, pl, o, c, INFINITY);
    for (int step = 8; step >= 1; step /= 2) {
        const double by = step * (TZ_PI / 360);
        if (step == 2) {
            o = &pl->dense;
            here = compare(g, pl, o, c, INFINITY);
        }
        for (int turn = 0; turn < (bend > 0 ? 3 : 2); turn++) {
            int way = -1;
            candidate next = *c;
            for (int k = 0; k < ways; k++) {
                if (dir[k][2] && fabs(angle + dir[k][2] * by) > bend)
                    continue;
                const candidate d = dir[k][2]
                                        ? turned(*c, dir[k][2] * by)
                                        : moved(*c, step * dir[k][0], step * dir[k][1]);
                if (!covers(s, &d, pl->at, 0.85))
                    continue;
                const double there = compare(g, pl, o, &d, here);
                if (there < here)
                    here = there, way = k, next = d;
            }
            if (way < 0)
                break;
            angle += dir[way][2] * by;
            *c = next;
        }
    }
    c->score = here;
}

/* ---- choice ------------------------------------------------------------------------- */

static bool inside(const tz_star *s, const tz_grown *q, const float radius[TZ_RAYS],
                   tz_vec2 v)
{
    const tz_vec2 p = tz_vec2_sub(tz_affine_apply(q->inv, v), s->centre);
    double a = atan2(p.y, p.x) / (2 * TZ_PI);
    a -= floor(a);
    const int i = (int)(a * TZ_RAYS) % TZ_RAYS, j = (i + 1) % TZ_RAYS;
    return tz_vec2_length(p) < 0.98 * fminf(radius[i], radius[j]);
}

/* Feature that a layout point shows, through the piece that owns its cell. */
static bool shown(const void *user, double x, double y, tz_feature *f)
{
    const tz_grower *g = user;
    const int64_t at = tz_canvas_at(&g->canvas, tz_cell(x), tz_cell(y));
    if (at < 0 || g->canvas.label[at] < 0)
        return false;
    const tz_grown *q = tz_grower_piece(g, g->canvas.label[at]);
    if (g->p.tile) { /* over the nearest copy */
        x -= floor((x - q->centre.x) / g->p.size[0] + 0.5) * g->p.size[0];
        y -= floor((y - q->centre.y) / g->p.size[1] + 0.5) * g->p.size[1];
    }
    const tz_vec2 p = tz_affine_apply(q->inv, (tz_vec2){x, y});
    const tz_turn turn = tz_turn_of(q->map);
    *f = tz_feature_turn(
        tz_feature_at(&g->map[g->stars.star.v[q->star].exemplar], p.x, p.y), &turn);
    return true;
}

tz_grown tz_place_choose(const tz_grower *g, tz_vec2 v, tz_rng *rng)
{
    place here, *pl = &here;
    look_around(g, v, rng, pl);
    candidate best[BEST];
    int32_t n = 0;
    const int32_t stars = g->stars.count, block = block_of(g, pl);
    const bool structured = pl->rule->structure != TZ_STRUCTURE_RANDOM;
    if (structured)
        try_neighbours(g, pl, rng, best, &n);
    const int32_t tries = 100 * g->p.effort;
    for (int32_t k = 0; k < tries; k++) {
        const int32_t id = block + tz_rng_below(rng, stars);
        if (tz_star_allowed(g, pl->rule, &g->stars.star.v[id]))
            try_star(g, pl, id, rng, best, &n);
    }
    tz_grown won = {.star = -1};
    float radius[TZ_RAYS], best_radius[TZ_RAYS];
    double least = INFINITY;
    const int32_t most = structured ? 3 + g->p.effort : 2; /* refined, seam and all */
    const int32_t judged = n < most ? n : most;
    for (int32_t k = 0; k < judged; k++) {
        candidate c = best[k];
        if (pl->coarse.n && structured && !c.coherent)
            refine(g, pl, &c);
        const double other = 0.3 * c.score + repetition(g, pl, &c);
        if (other >= least)
            continue;
        const tz_star *s = &g->stars.star.v[c.star];
        tz_grown q = {.star = c.star, .map = c.map, .centre = c.centre};
        if (!tz_affine_invert(q.map, &q.inv))
            continue;
        const double seam =
            tz_seam_find(&g->canvas, &g->map[s->exemplar], s, c.map, 2, radius);
        if (!inside(s, &q, radius, pl->at))
            continue;
        const double score = seam + other;
        if (score < least) {
            least = score, won = q;
            memcpy(best_radius, radius, sizeof radius);
        }
    }
    if (won.star >= 0) {
        const tz_star *s = &g->stars.star.v[won.star];
        tz_seam_find(&g->canvas, &g->map[s->exemplar], s, won.map, 1, radius);
        if (inside(s, &won, radius, pl->at))
            memcpy(best_radius, radius, sizeof radius);
        tz_seam_refine(g, shown, &g->map[s->exemplar], s, won.map, best_radius,
                       won.border);
        return won;
    }
    /* nothing fits: the first allowed star (or any) right on the place */
    int32_t id = tz_rng_below(rng, stars);
    for (int32_t k = 0; k < stars && !tz_star_allowed(g, pl->rule, &g->stars.star.v[id]);
         k++)
        id = (id + 1) % stars;
    id += block;
    const tz_star *s = &g->stars.star.v[id];
    won = (tz_grown){.star = id, .centre = pl->at};
    won.map = draw_map(g, pl, s, pl->at, rng);
    tz_affine_invert(won.map, &won.inv);
    for (int k = 0; k < TZ_BORDER; k++)
        won.border[k] = fminf(fmaxf(s->radius[k * TZ_RAYS / TZ_BORDER], 6),
                              fmaxf(s->limit[k * TZ_RAYS / TZ_BORDER], 1));
    return won;
}
