/* SPDX-License-Identifier: Apache-2.0 */
/* Cracks, grown one after the other: a tip walks on, wandering and kinking, feels for
 * older cracks and turns to meet them at a right angle, or dies out; branches leave it on
 * the way. Mud is cut up into plates, rock keeps a few cracks that end anywhere.
 *
 * Where a crack is 8 canvas px wide it is a piece; below that it is a line. What cracks
 * and lines enclose are pieces as well. */
#include "scenes/rock.h"

typedef struct plan {
    uint64_t seed;
    bool mud;
    double size;         /* of plates, px */
    double wide, narrow; /* of first and of last cracks, px */
    double wander, jag, jag_size, kink, branch, life, grain_angle, grain_pull;
    double edge, edge_size, curl, deep;
    double bump, bump_size, crease;
    bool one_skin;
    tz_rock_family family;
    tz_canvas_skin filler;
} plan;

typedef struct tip {
    tz_vec2 at;
    double angle, wide;
    int32_t parent, born; /* crack it left, generation */
} tip;

typedef struct work {
    TZ_ARRAY(tip)
    queue;
    TZ_ARRAY(tz_vec2)
    path;
    int32_t *owner; /* crack that runs here + 1 */
    float *open;    /* px inside of a crack; negative: outside */
    uint8_t *gap;   /* 1 where a crack is a piece */
    float *depth;
    int32_t cracks;
} work;

static const float nowhere = -1e3f;

static void draw_plan(tz_rng *r, const tz_canvas *c, plan *m)
{
    const double side = c->width < c->height ? c->width : c->height;
    m->seed = tz_rng_u64(r);
    m->mud = tz_scene_chance(r, 0.6);
    m->size = tz_scene_spread(r, 40, tz_scene_clamp(side * 0.6, 44, 400));
    if (!m->mud)
        m->size = fmax(m->size, side * 0.3);
    m->wide = tz_scene_spread(r, 3, tz_scene_clamp(m->size * 0.14, 5, 28));
    m->narrow = fmax(2, m->wide * tz_rng_range(r, 0.15, 0.8));
    m->wander = tz_scene_spread(r, 0.001, 0.022);
    m->jag = tz_rng_range(r, 0.05, 1.1);
    m->jag_size = tz_scene_spread(r, 4, 25);
    m->kink = tz_scene_chance(r, 0.5) ? tz_scene_spread(r, 0.003, 0.03) : 0;
    m->branch = m->mud ? 0.002 : tz_scene_spread(r, 0.001, 0.012);
    m->life = m->mud ? 1e9 : side * tz_scene_spread(r, 0.25, 2);
    m->grain_angle = tz_rng_range(r, 0, TZ_PI);
    m->grain_pull = !m->mud && tz_scene_chance(r, 0.5) ? tz_rng_range(r, 0.005, 0.05) : 0;
    m->edge_size = tz_scene_spread(r, 2, fmax(m->size * 0.12, 4));
    m->edge = m->edge_size * tz_rng_range(r, 0, 0.8);
    m->curl =
        m->mud && tz_scene_chance(r, 0.4) ? m->edge_size * tz_rng_range(r, 0.3, 1) : 0;
    m->deep = tz_rng_range(r, 0.4, 1.6);
    m->bump = m->size * tz_scene_spread(r, 0.004, m->mud ? 0.03 : 0.08);
    m->bump_size = m->size * tz_scene_spread(r, 0.1, 0.7);
    m->crease = m->mud ? 0 : m->bump * tz_rng_range(r, 0, 1.2);
    m->one_skin = tz_scene_chance(r, 0.7);
    tz_rock_family_draw(r, m->size * 0.5, &m->family);
    m->family.lightness *= 0.4;
    m->family.hue *= 0.4;
    tz_rock_filler(r, m->size * 0.3, &m->filler);
    const float dark = (float)tz_scene_spread(r, 0.08, 0.4);
    const bool own = tz_scene_chance(r, 0.88); /* else filled with other stuff */
    for (int k = 0; k < 3 && own; k++)
        m->filler.colour[k] = m->family.skin.colour[k] * dark;
}

/* ---- growth ------------------------------------------------------------------------ */

static int32_t owner_at(const tz_canvas *c, const work *w, tz_vec2 p)
{
    const int32_t x = (int32_t)floor(p.x), y = (int32_t)floor(p.y);
    if (x < 0 || y < 0 || x >= c->width || y >= c->height)
        return 0;
    return w->owner[(int64_t)y * c->width + x];
}

/* Two by two pixels, so that no path slips through between them. */
static void own(tz_canvas *c, work *w, tz_vec2 p, int32_t crack)
{
    for (int32_t k = 0; k < 4; k++) {
        const int32_t x = (int32_t)floor(p.x) + (k & 1), y = (int32_t)floor(p.y) + k / 2;
        if (x >= 0 && y >= 0 && x < c->width && y < c->height &&
            w->owner[(int64_t)y * c->width + x] == 0)
            w->owner[(int64_t)y * c->width + x] = crack + 1;
    }
}

static tz_vec2 ahead(tz_vec2 p, double angle, double far)
{
    return (tz_vec2){p.x + far * cos(angle), p.y + far * sin(angle)};
}

/* Turn towards the side on which an older crack is near: that meets it squarely. */
static double feel(const tz_canvas *c, const work *w, const tip *t, int32_t crack)
{
    double turn = 0;
    for (double far = 5; far < 22; far += 4) {
        const int32_t left = owner_at(c, w, ahead(t->at, t->angle - 0.8, far));
        const int32_t right = owner_at(c, w, ahead(t->at, t->angle + 0.8, far));
        turn += ((right && right != crack + 1) - (left && left != crack + 1)) * 0.05;
    }
    return turn;
}

/* Slow change of the heading; the crack's way shakes about it. */
static double wander(tz_rng *r, const plan *m, double angle, double *bend)
{
    *bend = 0.95 * *bend + m->wander * 0.35 * tz_rng_normal(r);
    double turn = *bend;
    if (tz_scene_chance(r, m->kink))
        turn += 0.5 * tz_rng_normal(r);
    return turn - m->grain_pull * sin(2 * (angle - m->grain_angle));
}

/* Walks until it meets a crack, leaves the canvas or dies. Returns whether it met one. */
static tz_status walk(tz_canvas *c, const plan *m, work *w, tip t, bool *met)
{
    const int32_t crack = w->cracks++;
    const double step = 1.5, slack = 40;
    tz_rng r = tz_rng_make(m->seed, tz_rng_stream(0xC4A, (uint64_t)crack, 0));
    const double life = m->life * tz_scene_spread(&r, 0.3, 1) / (1 + 0.7 * t.born);
    const double death = m->mud ? 0.0004 : 0.001;
    double bend = 0;
    tz_status s = TZ_OK;
    w->path.n = 0;
    *met = false;
    for (double far = 0; s == TZ_OK && far < life && far < 2e4; far += step) {
        const int32_t other = owner_at(c, w, t.at);
        const bool young = far < 12;
        if (other && other != crack + 1 && !(young && other == t.parent + 1)) {
            *met = true;
            return tz_array_push(c->ctx, &w->path, t.at);
        }
        own(c, w, t.at, crack);
        s = tz_array_push(c->ctx, &w->path, t.at);
        if (t.at.x < -slack || t.at.y < -slack || t.at.x > c->width + slack ||
            t.at.y > c->height + slack || (far > 20 && tz_scene_chance(&r, death)))
            break;
        t.angle += wander(&r, m, t.angle, &bend) + (young ? 0 : feel(c, w, &t, crack));
        if (s == TZ_OK && t.born < 4 && tz_scene_chance(&r, m->branch)) {
            const double side = tz_scene_chance(&r, 0.5) ? 1 : -1;
            const double lean = m->mud ? TZ_PI / 2 : tz_rng_range(&r, 0.5, 1.6);
            const tip next = {t.at, t.angle + side * lean,
                              t.wide * tz_rng_range(&r, 0.35, 0.85), crack, t.born + 1};
            s = tz_array_push(c->ctx, &w->queue, next);
        }
        const double shake =
            m->jag * tz_canvas_fbm(m->seed + 99, far / m->jag_size, 7.7 * crack, 3, 0.7);
        t.at = ahead(t.at, t.angle + shake, step);
    }
    return s;
}

/* ---- from path to planes ----------------------------------------------------------- */

static void stamp(tz_canvas *c, work *w, tz_vec2 at, double wide)
{
    const double half = wide / 2, reach = half + 1.5;
    const int32_t x0 = (int32_t)floor(fmax(at.x - reach, 0));
    const int32_t y0 = (int32_t)floor(fmax(at.y - reach, 0));
    for (int32_t y = y0; y < c->height && y <= at.y + reach; y++)
        for (int32_t x = x0; x < c->width && x <= at.x + reach; x++) {
            const double dx = x + 0.5 - at.x, dy = y + 0.5 - at.y;
            const float open = (float)(half - sqrt(dx * dx + dy * dy));
            float *o = &w->open[(int64_t)y * c->width + x];
            *o = open > *o ? open : *o;
            if (open > 0 && wide >= 8)
                w->gap[(int64_t)y * c->width + x] = 1;
        }
}

/* Width along the path wavers, and falls to nothing where the crack died. */
static void carve(tz_canvas *c, const plan *m, work *w, double wide, bool met)
{
    const int32_t n = w->path.n;
    const double fall = fmin(n, fmax(60, 0.8 * n));
    int32_t from = 0;
    for (int32_t i = 0; i < n; i++) {
        const tz_vec2 p = w->path.v[i];
        const double wave =
            tz_canvas_fbm(m->seed + 3 + (uint64_t)w->cracks, i / 25.0, 0, 3, 0.6);
        const double end = met ? 1 : pow(tz_scene_clamp((n - i) / fall, 0, 1), 0.6);
        const double here = wide * end * (1 + 0.6 * wave);
        if (here >= 1.1)
            stamp(c, w, p, here);
        if (here >= 8 || here < 1.1 || i + 1 == n) { /* a stretch of line ends */
            if (i - from > 1)
                tz_canvas_line(c, w->path.v + from, i - from + (here >= 1.1));
            from = i;
        }
    }
}

static tz_status grow(tz_canvas *c, const plan *m, work *w)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; s == TZ_OK && i < w->queue.n && i < 20000; i++) {
        const tip t = w->queue.v[i];
        bool met = false;
        if (tz_ctx_cancelled(c->ctx))
            return TZ_CANCELLED;
        s = walk(c, m, w, t, &met);
        if (s == TZ_OK && w->path.n > 12)
            carve(c, m, w, t.wide, met);
    }
    return s;
}

/* Whether a crack runs within `reach`: looked for on a coarse cross of samples. */
static bool crowded(const tz_canvas *c, const work *w, tz_vec2 p, double reach)
{
    for (double a = 0; a < 2 * TZ_PI; a += TZ_PI / 8)
        for (double far = 2; far < reach; far += 2)
            if (owner_at(c, w, ahead(p, a, far)))
                return true;
    return false;
}

/* Arms of a new crack to both sides of a point, or three of them. */
static tz_status sow(tz_canvas *c, tz_rng *r, const plan *m, work *w, tz_vec2 p,
                     double wide)
{
    const int32_t arms = m->mud && tz_scene_chance(r, 0.3) ? 3 : 2;
    const double angle = tz_rng_range(r, 0, 2 * TZ_PI);
    tz_status s = TZ_OK;
    for (int32_t k = 0; s == TZ_OK && k < arms; k++) {
        const tip t = {p, angle + 2 * TZ_PI * k / arms, wide, w->cracks, 0};
        s = tz_array_push(c->ctx, &w->queue, t);
    }
    if (s == TZ_OK)
        s = grow(c, m, w);
    w->queue.n = 0;
    return s;
}

static tz_status crack(tz_canvas *c, tz_rng *r, const plan *m, work *w)
{
    const int32_t rounds = m->mud ? 3 : 1;
    tz_status s = TZ_OK;
    for (int32_t k = 0; s == TZ_OK && k < rounds; k++) {
        tz_vec2 *at = NULL;
        int32_t n = 0;
        const double gap = m->size / (1 + 0.6 * k);
        s = tz_canvas_points(c, r, gap, m->mud ? 20 : 0, &at, &n);
        if (!m->mud) /* points come in random order */
            n = n < 6 ? n : 1 + tz_rng_below(r, 6);
        for (int32_t i = 0; s == TZ_OK && i < n; i++) {
            const double share = (double)k / rounds + 0.3 * tz_rng_unit(r);
            const double wide = m->wide + share * (m->narrow - m->wide);
            if (!crowded(c, w, at[i], gap * 0.33))
                s = sow(c, r, m, w, at[i], wide);
        }
        tz_free(c->ctx, at);
    }
    return s;
}

/* ---- pieces ------------------------------------------------------------------------ */

/* Fills the part around p that neither cracks nor lines cut off. */
static int64_t flood(tz_canvas *c, const work *w, int64_t p, int32_t id, int64_t *queue)
{
    int64_t end = 0;
    queue[end++] = p;
    c->segment[p] = id;
    for (int64_t i = 0; i < end; i++) {
        const int64_t q = queue[i], x = q % c->width, y = q / c->width;
        const int64_t next[4] = {x > 0 ? q - 1 : q, x + 1 < c->width ? q + 1 : q,
                                 y > 0 ? q - c->width : q,
                                 y + 1 < c->height ? q + c->width : q};
        for (int32_t k = 0; k < 4; k++)
            if (c->segment[next[k]] < 0 && !w->gap[next[k]] && !c->line[next[k]]) {
                c->segment[next[k]] = id;
                queue[end++] = next[k];
            }
    }
    return end;
}

/* Pixels of lines go to a plate beside them. */
static void settle_lines(tz_canvas *c, int32_t other)
{
    const int64_t n = (int64_t)c->width * c->height;
    for (int32_t pass = 0; pass < 4; pass++)
        for (int64_t p = 0; p < n; p++) {
            if (c->segment[p] >= 0)
                continue;
            const int64_t x = p % c->width;
            int32_t to = -1;
            if (x > 0)
                to = c->segment[p - 1];
            if (to < 0 && p >= c->width)
                to = c->segment[p - c->width];
            if (to < 0 && x + 1 < c->width)
                to = c->segment[p + 1];
            if (to < 0 && p + c->width < n)
                to = c->segment[p + c->width];
            c->segment[p] = to >= 0 ? to : pass == 3 ? other : -1;
        }
}

static tz_status find_plates(tz_canvas *c, const plan *m, work *w)
{
    const int64_t n = (int64_t)c->width * c->height;
    int64_t *queue = NULL;
    int32_t gap = 0, id = 0;
    tz_status s = tz_alloc(c->ctx, &queue, (size_t)n, sizeof *queue);
    if (s == TZ_OK)
        s = tz_canvas_add_piece(c, false, 0, &gap);
    for (int64_t p = 0; p < n; p++) {
        c->segment[p] = w->gap[p] ? gap : -1;
        if (w->gap[p])
            c->line[p] = 0;
    }
    for (int64_t p = 0; s == TZ_OK && p < n; p++) {
        if (c->segment[p] >= 0 || c->line[p])
            continue;
        s = tz_canvas_add_piece(c, m->mud, 1, &id);
        if (s == TZ_OK)
            flood(c, w, p, id, queue);
    }
    if (s == TZ_OK)
        settle_lines(c, gap);
    tz_free(c->ctx, queue);
    return s;
}

/* ---- painting ---------------------------------------------------------------------- */

static float surface_at(const plan *m, double x, double y)
{
    const double u = x / m->bump_size, v = y / m->bump_size;
    double h = m->bump * tz_canvas_fbm(m->seed + 1, u, v, 4, 0.55);
    if (m->crease > 0)
        h -= m->crease *
             (1 - fabs((double)tz_canvas_fbm(m->seed + 2, u, 2 * v, 2, 0.5)) * 3);
    return (float)h;
}

static void paint_pixel(tz_canvas *c, const plan *m, const work *w,
                        const tz_canvas_skin *skin, int32_t x, int32_t y)
{
    const int64_t p = (int64_t)y * c->width + x;
    const float open = w->open[p], d = w->depth[p];
    c->relief[p] = surface_at(m, x, y);
    tz_canvas_skin_at(c, &skin[m->one_skin ? 1 : c->segment[p]], x, y);
    if (open <= -1) {
        const double t = tz_scene_clamp(d / m->edge_size, 0, 1), near = 1 - t;
        c->relief[p] += (float)(m->curl * exp(-2 * t) - m->edge * near * near);
        return;
    }
    const float share = (float)tz_scene_clamp(open + 0.5, 0, 1);
    const float fill = m->filler.colour[1] / fmaxf(m->family.skin.colour[1], 0.01f);
    const float tint[3] = {m->filler.colour[0], m->filler.colour[1], m->filler.colour[2]};
    tz_rock_mix(c, p, tint, share * (fill < 1 ? 0.9f : 0.6f));
    c->relief[p] += (float)(m->curl - m->edge) * (1 - share);
    c->relief[p] -= (float)m->deep * (share + 1.4f * fminf(fmaxf(open, 0), 12));
}

static tz_status paint(tz_canvas *c, tz_rng *r, const plan *m, work *w)
{
    const int64_t n = (int64_t)c->width * c->height;
    tz_canvas_skin *skin = NULL;
    tz_status s = tz_alloc(c->ctx, &skin, (size_t)c->piece.n + 2, sizeof *skin);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < c->piece.n + 2; i++)
        skin[i] = tz_rock_skin(&m->family, i);
    for (int64_t p = 0; p < n; p++) /* the owners are no longer needed */
        w->owner[p] = w->open[p] > 0;
    s = tz_rock_depth(c, w->owner, w->depth);
    for (int32_t y = 0; s == TZ_OK && y < c->height; y++)
        for (int32_t x = 0; x < c->width; x++)
            paint_pixel(c, m, w, skin, x, y);
    if (s == TZ_OK)
        tz_rock_weather(c, r, m->size, NULL);
    tz_free(c->ctx, skin);
    return s;
}

tz_status tz_scene_CRACKS(tz_canvas *c)
{
    plan m = {0};
    work w = {0};
    const int64_t n = (int64_t)c->width * c->height;
    draw_plan(&c->rng, c, &m);
    tz_status s = tz_alloc_zero(c->ctx, &w.owner, (size_t)n, sizeof *w.owner);
    if (s == TZ_OK)
        s = tz_alloc_zero(c->ctx, &w.gap, (size_t)n, 1);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &w.open, (size_t)n, sizeof *w.open);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &w.depth, (size_t)n, sizeof *w.depth);
    for (int64_t p = 0; s == TZ_OK && p < n; p++)
        w.open[p] = nowhere;
    if (s == TZ_OK)
        s = crack(c, &c->rng, &m, &w);
    if (s == TZ_OK)
        s = find_plates(c, &m, &w);
    if (s == TZ_OK)
        s = paint(c, &c->rng, &m, &w);
    tz_array_free(c->ctx, &w.queue);
    tz_array_free(c->ctx, &w.path);
    tz_free(c->ctx, w.owner);
    tz_free(c->ctx, w.gap);
    tz_free(c->ctx, w.open);
    tz_free(c->ctx, w.depth);
    return s;
}
