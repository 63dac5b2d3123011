/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Likeness of curves: zero for the same, about one for parts of one pattern, more the
 * more a pattern is damaged, and in the measures that the damage is about. */
#include "tests/support/curve_fixture.h"

#include <math.h>

#include "base/rng.h"
#include "curves/curve_compare.h"
#include "curves/curve_io.h"

/* ---- patterns ---------------------------------------------------------------------- */

/* What a net is made like. */
typedef struct net {
    uint64_t seed;
    double w, h;   /* of the domain */
    double cell;   /* way between nodes */
    double jitter; /* of nodes, of the cell */
    double keep;   /* share of the edges */
    double bend;   /* of edges, of the cell; 0 = straight */
    double turn;   /* of the whole net about the origin */
    int32_t dents; /* each edge is so many lines, ... */
    double dent;   /* ... moved by so much of the cell */
} net;

static const net plain = {.seed = 1,
                          .w = 400,
                          .h = 400,
                          .cell = 20,
                          .jitter = 0.25,
                          .keep = 0.9,
                          .bend = 0.15,
                          .dents = 1};

static tz_curve_set empty_set(double w, double h)
{
    tz_curve_set s;
    int32_t pen;
    memset(&s, 0, sizeof s);
    s.ctx = ctx;
    s.domain.size = (tz_vec3){w, h, 0};
    ok(ctx, tz_curve_add_pen(&s, (tz_curve_pen){.width = 1, .color = 255}, &pen));
    return s;
}

static void add_line(tz_curve_set *s, tz_vec2 p, tz_vec2 q, tz_vec2 bulge)
{
    int32_t a, b;
    ok(ctx, tz_curve_add_node(s, p, &a));
    ok(ctx, tz_curve_add_node(s, q, &b));
    ok(ctx, tz_curve_begin(s, 0));
    if (bulge.x == 0 && bulge.y == 0) {
        ok(ctx, tz_curve_line(s, a, b));
    } else {
        const tz_vec2 m = {p.x + (q.x - p.x) / 3 + bulge.x,
                           p.y + (q.y - p.y) / 3 + bulge.y},
                      n = {p.x + 2 * (q.x - p.x) / 3 + bulge.x,
                           p.y + 2 * (q.y - p.y) / 3 + bulge.y};
        ok(ctx, tz_curve_cubic(s, a, b, m, n));
    }
    tz_curve_end(s, false);
}

/* One edge: a bent line, or a dented one. */
static void add_net_edge(tz_curve_set *s, const net *n, tz_vec2 p, tz_vec2 q, tz_rng *r)
{
    const tz_vec2 across = {-(q.y - p.y), q.x - p.x};
    if (n->dents <= 1) {
        add_line(s, p, q, tz_vec2_scale(across, n->bend * (2 * tz_rng_unit(r) - 1)));
        return;
    }
    tz_vec2 last = p;
    for (int32_t k = 1; k <= n->dents; k++) {
        const double t = (double)k / n->dents;
        tz_vec2 at = {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
        if (k < n->dents)
            at = tz_vec2_add(at, (tz_vec2){n->dent * n->cell * tz_rng_normal(r),
                                           n->dent * n->cell * tz_rng_normal(r)});
        add_line(s, last, at, (tz_vec2){0, 0});
        last = at;
    }
}

/* Place of a node; the same from every edge that it ends. */
static tz_vec2 net_node(const net *n, int32_t i, int32_t j)
{
    tz_rng r = tz_rng_make(n->seed,
                           tz_rng_stream(1, (uint64_t)(i + 1000), (uint64_t)(j + 1000)));
    const double x = n->cell * (i + n->jitter * (2 * tz_rng_unit(&r) - 1)),
                 y = n->cell * (j + n->jitter * (2 * tz_rng_unit(&r) - 1));
    return (tz_vec2){cos(n->turn) * x - sin(n->turn) * y,
                     sin(n->turn) * x + cos(n->turn) * y};
}

static tz_curve_set make_net(const net *n)
{
    tz_curve_set s = empty_set(n->w, n->h);
    const int32_t most = (int32_t)(hypot(n->w, n->h) / n->cell) + 2;
    for (int32_t i = -most; i < most; i++)
        for (int32_t j = -most; j < most; j++)
            for (int k = 0; k < 2; k++) {
                tz_rng r = tz_rng_make(n->seed, tz_rng_stream(2 + (uint64_t)k,
                                                              (uint64_t)(i + 1000),
                                                              (uint64_t)(j + 1000)));
                const tz_vec2 p = net_node(n, i, j), q = net_node(n, i + !k, j + k);
                const double reach = 2 * n->cell;
                const bool kept = tz_rng_unit(&r) < n->keep;
                if (kept && p.x > -reach && p.y > -reach && p.x < n->w + reach &&
                    p.y < n->h + reach)
                    add_net_edge(&s, n, p, q, &r);
            }
    return s;
}

/* Waves from side to side, none of which ends. */
static tz_curve_set make_waves(uint64_t seed, double w, double h, double apart)
{
    tz_curve_set s = empty_set(w, h);
    tz_rng r = tz_rng_make(seed, 1);
    for (double y = -apart; y < h + apart; y += apart) {
        double at = y;
        const double step = 2 * apart;
        for (double x = -step; x < w; x += step) {
            const double next = y + apart * 0.4 * (2 * tz_rng_unit(&r) - 1);
            int32_t a, b;
            ok(ctx, tz_curve_add_node(&s, (tz_vec2){x, at}, &a));
            ok(ctx, tz_curve_add_node(&s, (tz_vec2){x + step, next}, &b));
            ok(ctx, tz_curve_begin(&s, 0));
            ok(ctx, tz_curve_cubic(&s, a, b, (tz_vec2){x + step / 2, at},
                                   (tz_vec2){x + step / 2, next}));
            tz_curve_end(&s, false);
            at = next;
        }
    }
    return s;
}

static tz_curve_likeness compared(const tz_curve_set *a, const tz_curve_set *b)
{
    tz_curve_likeness q;
    ok(ctx, tz_curve_compare(ctx, a, b, &q));
    return q;
}

static tz_curve_likeness compared_nets(const net *a, const net *b)
{
    tz_curve_set s = make_net(a), t = make_net(b);
    const tz_curve_likeness q = compared(&s, &t);
    tz_curve_set_deinit(&s);
    tz_curve_set_deinit(&t);
    return q;
}

/* ---- honest ------------------------------------------------------------------------ */

static const size_t ratio_at[] = {
    offsetof(tz_curve_likeness, degrees),     offsetof(tz_curve_likeness, ends),
    offsetof(tz_curve_likeness, edges),       offsetof(tz_curve_likeness, turning),
    offsetof(tz_curve_likeness, orientation), offsetof(tz_curve_likeness, density),
    offsetof(tz_curve_likeness, cells),       offsetof(tz_curve_likeness, patches)};
enum { RATIOS = sizeof ratio_at / sizeof ratio_at[0] };

static double ratio_of(const tz_curve_likeness *q, size_t at)
{
    double v;
    memcpy(&v, (const char *)q + at, sizeof v);
    return v;
}

/* All figures are what they may be, and the mean is theirs. */
static void sound(const tz_curve_likeness *q)
{
    double sum = 0, n = 0;
    for (int i = 0; i < RATIOS; i++) {
        const double v = ratio_of(q, ratio_at[i]);
        if (isnan(v))
            continue;
        assert_true(v >= 0 && v <= TZ_CURVE_WORST);
        sum += v;
        n++;
    }
    assert_true(n > 0);
    assert_true(fabs(q->mean - sum / n) < 1e-12);
    assert_true(q->degree_off >= 0 && q->degree_off <= 1);
    assert_true(q->repeats >= 0 && q->repeats <= 1);
    assert_true(q->repeats_own >= 0 && q->repeats_own <= 1);
    for (int i = 0; i < 2; i++) {
        double all = 0;
        for (int k = 0; k < TZ_CURVE_DEGREES; k++)
            all += q->degree[i][k];
        assert_true(all == 0 || fabs(all - 1) < 1e-12);
        assert_true(q->length[i] > 0 && q->dangling[i] >= 0);
    }
}

static void test_same(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        net n = plain;
        n.seed = seed;
        const tz_curve_likeness q = compared_nets(&n, &n);
        sound(&q);
        for (int i = 0; i + 1 < RATIOS; i++)
            assert_true(ratio_of(&q, ratio_at[i]) == 0);
        assert_true(q.patches < 0.6);
        assert_true(q.degree_off == 0 && q.length[0] == q.length[1]);
    }
}

/* Another net of the same kind is as like as can be: two whole ones differ by sqrt(1/2) of
 * what halves differ by, and a larger one by less. */
static void test_another(void **state)
{
    (void)state;
    double equal = 0, large = 0, small = 0;
    enum { TIMES = 5 };
    for (int k = 0; k < TIMES; k++) {
        net a = plain, b = plain;
        a.seed = 10 + (uint64_t)k, b.seed = 50 + (uint64_t)k;
        equal += compared_nets(&a, &b).mean / TIMES;
        b.w = b.h = 1200;
        const tz_curve_likeness q = compared_nets(&a, &b);
        sound(&q);
        large += q.mean / TIMES;
        b.w = b.h = 200;
        small += compared_nets(&a, &b).mean / TIMES;
    }
    assert_true(equal > 0.2 && equal < 0.9);
    assert_true(large < 0.9 && small < 1.2);
}

/* The two halves of a pattern, each in a document of its own. */
static void test_halves(void **state)
{
    (void)state;
    double sum = 0;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        net n = plain;
        n.seed = seed;
        tz_curve_set a = make_net(&n), b = make_net(&n);
        a.domain.size.x = b.domain.size.x = n.w / 2;
        for (int32_t i = 0; i < b.node.n; i++)
            b.node.v[i].x -= n.w / 2;
        for (int32_t i = 0; i < b.piece.n; i++)
            b.piece.v[i].a.x -= n.w / 2, b.piece.v[i].b.x -= n.w / 2;
        sum += compared(&a, &b).mean / 4;
        tz_curve_set_deinit(&a);
        tz_curve_set_deinit(&b);
    }
    assert_true(sum > 0.2 && sum < 1.1);
}

/* Waves have no nodes, no ends, no cells: those say nothing. */
static void test_left_out(void **state)
{
    (void)state;
    tz_curve_set a = make_waves(1, 400, 400, 20), b = make_waves(2, 900, 800, 20);
    const tz_curve_likeness q = compared(&a, &b);
    sound(&q);
    assert_true(isnan(q.degrees) && isnan(q.ends) && isnan(q.edges) && isnan(q.cells));
    assert_true(q.mean < 1);
    /* broken ones have ends, which count then */
    net n = plain;
    n.keep = 0.6;
    tz_curve_set c = make_net(&n);
    const tz_curve_likeness r = compared(&a, &c);
    assert_true(r.ends > 3 && r.degrees > 3 && r.edges > 3);
    tz_curve_set_deinit(&a);
    tz_curve_set_deinit(&b);
    tz_curve_set_deinit(&c);
}

/* ---- damage ------------------------------------------------------------------------ */

typedef struct damage {
    const char *name;
    net from, step;      /* level k: from + k * step, of what is not zero in step */
    size_t rises, calm;  /* the ratio that must rise, and one that must not care */
    double most, calmly; /* it rises above; the calm one stays below */
} damage;

static net damaged(const damage *d, int level)
{
    net n = d->from;
    n.seed = 50;
    n.keep += level * d->step.keep;
    n.turn += level * d->step.turn;
    n.cell += level * d->step.cell;
    n.dent += level * d->step.dent;
    return n;
}

static void test_damage(void **state)
{
    (void)state;
    net dented = plain, lattice = plain;
    dented.dents = 8, dented.dent = 0.01;
    lattice.jitter = lattice.bend = 0, lattice.keep = 1;
#define AT(name) offsetof(tz_curve_likeness, name)
    const damage list[] = {
        {"edges gone", plain, {.keep = -0.05}, AT(ends), AT(orientation), 5, 1},
        {"edges gone", plain, {.keep = -0.05}, AT(cells), AT(orientation), 3, 1},
        {"edges gone of a lattice",
         lattice,
         {.keep = -0.05},
         AT(degrees),
         AT(orientation),
         5,
         1},
        {"turned", plain, {.turn = TZ_PI / 12}, AT(orientation), AT(degrees), 5, 1},
        {"scaled", plain, {.cell = 2}, AT(density), AT(orientation), 4, 1},
        {"scaled", plain, {.cell = 2}, AT(edges), AT(orientation), 2, 1},
        {"jittered", dented, {.dent = 0.01}, AT(turning), AT(cells), 5, 1},
    };
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        const damage *d = &list[i];
        double last = -1, mean = -1;
        for (int level = 0; level <= 3; level++) {
            const net n = damaged(d, level);
            const tz_curve_likeness q = compared_nets(&d->from, &n);
            sound(&q);
            const double v = ratio_of(&q, d->rises), c = ratio_of(&q, d->calm);
            if (!(v > last || v == TZ_CURVE_WORST || level == 0) || q.mean <= mean ||
                (level == 3 && v < d->most) || c > d->calmly)
                fail_msg("%s, level %d: %g after %g, mean %g after %g, calm %g", d->name,
                         level, v, last, q.mean, mean, c);
            last = isnan(v) ? 0 : v;
            mean = q.mean;
        }
    }
}

/* Lines of a straight net inside of a rectangle, moved. */
static void add_part(tz_curve_set *to, const tz_curve_set *from, tz_vec2 lo, tz_vec2 hi,
                     tz_vec2 move)
{
    for (int32_t i = 0; i < from->piece.n; i++) {
        const tz_vec2 p = from->node.v[from->piece.v[i].from],
                      q = from->node.v[from->piece.v[i].to];
        const double a[2] = {p.x, p.y}, d[2] = {q.x - p.x, q.y - p.y},
                     l[2] = {lo.x, lo.y}, h[2] = {hi.x, hi.y};
        double t0 = 0, t1 = 1;
        for (int k = 0; k < 2; k++) {
            const double u = (l[k] - a[k]) / d[k], v = (h[k] - a[k]) / d[k];
            t0 = fmax(t0, fmin(u, v));
            t1 = fmin(t1, fmax(u, v));
        }
        if (t0 < t1)
            add_line(to, (tz_vec2){p.x + t0 * d[0] + move.x, p.y + t0 * d[1] + move.y},
                     (tz_vec2){p.x + t1 * d[0] + move.x, p.y + t1 * d[1] + move.y},
                     (tz_vec2){0, 0});
    }
}

/* Quarters of a set, so much smaller each, in their places or each in that of the one across
 * from it. */
static tz_curve_set quarters(const tz_curve_set *a, double smaller, bool moved)
{
    const double x = a->domain.size.x / 2, y = a->domain.size.y / 2;
    tz_curve_set s = empty_set(2 * x, 2 * y);
    for (int k = 0; k < 4; k++) {
        const tz_vec2 lo = {k & 1 ? x : 0, k & 2 ? y : 0},
                      p = {lo.x + smaller, lo.y + smaller},
                      q = {lo.x + x - smaller, lo.y + y - smaller},
                      by = {k & 1 ? -x : x, k & 2 ? -y : y};
        add_part(&s, a, p, q, moved ? by : (tz_vec2){0, 0});
    }
    return s;
}

/* Quarters in another order: only the seams are bad, and they are. Lines are followed
 * straight on through crossings, and a seam leaves less of them on which to turn: that is all
 * that turning sees, so that it is the same where they are cut there and stay in place. */
static void test_shuffled(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        net n = plain;
        n.bend = 0;
        n.seed = seed;
        tz_curve_set a = make_net(&n), b = quarters(&a, 0, true),
                     cut = quarters(&a, 0.5, false), touching = quarters(&a, 0, false);
        const tz_curve_likeness q = compared(&a, &b), in_place = compared(&a, &cut),
                                order = compared(&cut, &b),
                                same = compared(&a, &touching);
        sound(&q);
        assert_true(q.ends > 3 && q.degrees > 1);
        assert_true(q.density < 0.1 && q.orientation < 0.1);
        assert_true(q.patches < 0.9 && q.dangling[1] > 2 * q.dangling[0]);
        if (!(order.turning < 0.4 && q.turning < in_place.turning + 0.1 &&
              same.turning < 0.2))
            fail_msg("turning: shuffled %g, cut %g, shuffled against cut %g, cut so that "
                     "parts touch %g",
                     q.turning, in_place.turning, order.turning, same.turning);
        tz_curve_set_deinit(&a);
        tz_curve_set_deinit(&b);
        tz_curve_set_deinit(&cut);
        tz_curve_set_deinit(&touching);
    }
}

/* Parallel lines 20 apart that turn by an angle every so far, to and fro, after noise at
 * every step of 5. */
static tz_curve_set zigzag(double degrees, double every, double noise)
{
    tz_curve_set s = empty_set(400, 400);
    tz_rng r = tz_rng_make(7, 1);
    for (int i = 0; i < 20; i++) {
        tz_vec2 p = {-20, 20 * i + 10};
        double turned = -degrees * TZ_PI / 360, gone = 0;
        while (p.x < 420) {
            const double a = turned + noise * TZ_PI / 180 * tz_rng_normal(&r);
            const tz_vec2 q = {p.x + 5 * cos(a), p.y + 5 * sin(a)};
            add_line(&s, p, q, (tz_vec2){0, 0});
            gone += 5;
            if (gone >= every) {
                gone = 0;
                turned = -turned;
            }
            p = q;
        }
    }
    return s;
}

/* What an eye takes for straight is; kinks of ten degrees are seen, larger ones more. */
static void test_kinks(void **state)
{
    (void)state;
    tz_curve_set straight = zigzag(0, 20, 0);
    const struct {
        double degrees, every, noise, least, most;
    } list[] = {{0, 20, 0.3, 0, 0.5}, {0, 20, 0.8, 0, 1},      {10, 20, 0, 3, 10},
                {20, 20, 0, 6, 10},   {10, 100, 0.3, 0.8, 10}, {20, 100, 0.3, 1.6, 10}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        tz_curve_set bent = zigzag(list[i].degrees, list[i].every, list[i].noise);
        const tz_curve_likeness q = compared(&straight, &bent);
        if (!(q.turning >= list[i].least && q.turning <= list[i].most))
            fail_msg("kinks of %g degrees every %g, noise %g: turning %g",
                     list[i].degrees, list[i].every, list[i].noise, q.turning);
        tz_curve_set_deinit(&bent);
    }
    tz_curve_set_deinit(&straight);
}

/* A path that is drawn around corners at junctions is no other pattern than one that is
 * drawn straight on. */
static void test_pairing(void **state)
{
    (void)state;
    tz_curve_set a = empty_set(400, 400), b = empty_set(400, 400);
    for (int i = 0; i < 20; i++) {
        const double at = 20 * i + 10;
        add_line(&a, (tz_vec2){at, 0}, (tz_vec2){at, 400}, (tz_vec2){0, 0});
        add_line(&a, (tz_vec2){0, at}, (tz_vec2){400, at}, (tz_vec2){0, 0});
        /* stairs: one way, and those between them */
        for (int k = 0; k < 2; k++) {
            int32_t last, next;
            tz_vec2 p = {k ? 0 : at, k ? at : 0};
            ok(ctx, tz_curve_add_node(&b, p, &last));
            ok(ctx, tz_curve_begin(&b, 0));
            for (bool down = !k; p.x < 400 && p.y < 400; down = !down) {
                const double step = (p.x > 0 && p.y > 0) ? 20 : 10;
                p = (tz_vec2){fmin(400, p.x + (down ? 0 : step)),
                              fmin(400, p.y + (down ? step : 0))};
                ok(ctx, tz_curve_add_node(&b, p, &next));
                ok(ctx, tz_curve_line(&b, last, next));
                last = next;
            }
            tz_curve_end(&b, false);
        }
    }
    const tz_curve_likeness q = compared(&a, &b);
    sound(&q);
    assert_true(q.turning < 0.1 && q.degrees < 0.1 && q.edges < 0.1);
    tz_curve_set_deinit(&a);
    tz_curve_set_deinit(&b);
}

/* ---- guided ------------------------------------------------------------------------ */

/* A lattice that runs around a torus: nothing ends at the border. */
static void test_torus(void **state)
{
    (void)state;
    net n = plain;
    n.jitter = n.bend = 0, n.keep = 1;
    tz_curve_set a = make_net(&n), b = empty_set(400, 300);
    int32_t id[15][20];
    b.domain.torus = true;
    for (int j = 0; j < 15; j++)
        for (int i = 0; i < 20; i++)
            ok(ctx, tz_curve_add_node(&b, (tz_vec2){20 * i + 7, 20 * j + 3}, &id[j][i]));
    for (int j = 0; j < 15; j++)
        for (int i = 0; i < 20; i++)
            for (int k = 0; k < 2; k++) {
                ok(ctx, tz_curve_begin(&b, 0));
                ok(ctx, tz_curve_line(&b, id[j][i], id[(j + k) % 15][(i + !k) % 20]));
                tz_curve_end(&b, false);
            }
    ok(ctx, tz_curve_set_check(ctx, &b, "torus"));
    const tz_curve_likeness q = compared(&a, &b), r = compared(&b, &a);
    sound(&q);
    sound(&r);
    assert_true(q.dangling[1] == 0 && q.degree_off < 0.01);
    assert_true(fabs(q.length[1] - 0.1) < 1e-6);
    assert_true(q.mean < 0.5 && r.mean < 0.5);
    tz_curve_set_deinit(&a);
    tz_curve_set_deinit(&b);
}

/* A net in a disc, nothing around it: as like as one that fills the rectangle. */
static void test_region(void **state)
{
    (void)state;
    enum { SIDE = 256 };
    static float mask[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++)
        mask[i] = (float)fmin(
            1, fmax(0, 110.5 - hypot(i % SIDE - 127.5, (double)(i / SIDE) - 127.5)));
    net n = plain, m = plain;
    m.seed = 9, m.w = m.h = 800, m.bend = 0;
    n.bend = 0;
    tz_curve_set a = make_net(&n), all = make_net(&m), b = empty_set(800, 800);
    for (int32_t i = 0; i < all.piece.n; i++) { /* what lies inside, cut at the rim */
        const tz_vec2 p = all.node.v[all.piece.v[i].from],
                      q = all.node.v[all.piece.v[i].to];
        const int steps = 200;
        int from = -1;
        for (int k = 0; k <= steps; k++) {
            const double x = p.x + (k + 0.5) / steps * (q.x - p.x) - 400,
                         y = p.y + (k + 0.5) / steps * (q.y - p.y) - 400;
            const bool in = k < steps && hypot(x, y) < 110.0 / 128 * 400;
            if (in && from < 0)
                from = k;
            if (!in && from >= 0) {
                const double t0 = (double)from / steps, t1 = (double)k / steps;
                add_line(&b, (tz_vec2){p.x + t0 * (q.x - p.x), p.y + t0 * (q.y - p.y)},
                         (tz_vec2){p.x + t1 * (q.x - p.x), p.y + t1 * (q.y - p.y)},
                         (tz_vec2){0, 0});
                from = -1;
            }
        }
    }
    const tz_curve_likeness bare = compared(&a, &b);
    tz_region *region = NULL;
    ok(ctx, tz_region_from_mask(ctx, mask, SIDE, SIDE, b.domain.size, false, &region));
    b.domain.region = region;
    const tz_curve_likeness q = compared(&a, &b);
    sound(&q);
    assert_true(q.mean < 1 && fabs(q.length[1] / q.length[0] - 1) < 0.05);
    assert_true(q.dangling[1] < 0.001);
    assert_true(bare.mean > 1.5 * q.mean && bare.density > 5 && bare.ends > q.ends);
    b.domain.region = NULL;
    tz_region_free(region);
    tz_curve_set_deinit(&a);
    tz_curve_set_deinit(&all);
    tz_curve_set_deinit(&b);
}

/* A net turned as the frames are is not turned. */
static void test_frames(void **state)
{
    (void)state;
    net n = plain, m = plain;
    m.seed = 9, m.turn = TZ_PI / 6;
    tz_curve_set a = make_net(&n), b = make_net(&m);
    tz_frames *frames = NULL;
    const tz_curve_likeness bare = compared(&a, &b);
    ok(ctx, tz_frames_from_formula(ctx, "30", b.domain.size, false, &frames));
    b.domain.frames = frames;
    const tz_curve_likeness q = compared(&a, &b);
    sound(&q);
    assert_true(bare.orientation > 5 && bare.patches > 1.2);
    assert_true(q.orientation < 1.2 && q.patches < 1.1 && q.mean < 1);
    b.domain.frames = NULL;
    tz_frames_free(frames);
    tz_curve_set_deinit(&a);
    tz_curve_set_deinit(&b);
}

/* ---- repeats ----------------------------------------------------------------------- */

static void add_copy(tz_curve_set *to, const tz_curve_set *from, tz_vec2 move)
{
    for (int32_t i = 0; i < from->path.n; i++) {
        const tz_curve_path *p = &from->path.v[i];
        int32_t last = -1, next;
        ok(ctx, tz_curve_begin(to, 0));
        for (int32_t k = p->piece; k < p->piece + p->pieces; k++) {
            const tz_bezier c = tz_curve_bezier(from, &from->piece.v[k]);
            if (last < 0)
                ok(ctx, tz_curve_add_node(to, tz_vec2_add(c.p[0], move), &last));
            ok(ctx, tz_curve_add_node(to, tz_vec2_add(c.p[3], move), &next));
            ok(ctx, tz_curve_cubic(to, last, next, tz_vec2_add(c.p[1], move),
                                   tz_vec2_add(c.p[2], move)));
            last = next;
        }
        tz_curve_end(to, false);
    }
}

/* Long wavy paths, each of one go. */
static tz_curve_set make_long(uint64_t seed, double w, double h)
{
    tz_curve_set s = empty_set(w, h);
    tz_rng r = tz_rng_make(seed, 1);
    for (double y = 10; y < h; y += 20) {
        double at = y;
        int32_t last, next;
        ok(ctx, tz_curve_add_node(&s, (tz_vec2){0, at}, &last));
        ok(ctx, tz_curve_begin(&s, 0));
        for (double x = 0; x < w; x += 30) {
            const double to = y + 9 * (2 * tz_rng_unit(&r) - 1);
            ok(ctx, tz_curve_add_node(&s, (tz_vec2){x + 30, to}, &next));
            ok(ctx, tz_curve_cubic(&s, last, next, (tz_vec2){x + 15, at},
                                   (tz_vec2){x + 15, to}));
            last = next;
            at = to;
        }
        tz_curve_end(&s, false);
    }
    return s;
}

static void test_repeats(void **state)
{
    (void)state;
    tz_curve_set a = make_long(1, 300, 300), other = make_long(2, 300, 300),
                 third = make_long(3, 300, 300);
    /* all of them new; one of three a second time; nothing but copies */
    const struct {
        const tz_curve_set *part[3];
        double least, most;
    } list[] = {{{&a, &other, &third}, 0, 0.02},
                {{&a, &other, &a}, 0.56, 0.68},
                {{&a, &a, &a}, 0.85, 1}};
    for (size_t i = 0; i < 3; i++) {
        tz_curve_set b = empty_set(900, 300);
        for (int k = 0; k < 3; k++)
            add_copy(&b, list[i].part[k], (tz_vec2){300 * k + 0.37 * k, 0.71 * k});
        const tz_curve_likeness q = compared(&a, &b);
        if (!(q.repeats >= list[i].least && q.repeats <= list[i].most))
            fail_msg("%zu: %g is not in %g .. %g", i, q.repeats, list[i].least,
                     list[i].most);
        assert_true(q.repeats_own < 0.02);
        tz_curve_set_deinit(&b);
    }
    /* straight lines repeat by themselves; that says nothing */
    net n = plain;
    n.jitter = n.bend = 0;
    assert_true(compared_nets(&n, &n).repeats == 0);
    tz_curve_set_deinit(&a);
    tz_curve_set_deinit(&other);
    tz_curve_set_deinit(&third);
}

/* ---- bad input --------------------------------------------------------------------- */

#define HEAD                                                                     \
    "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 100\"><g fill=" \
    "\"none\" stroke=\"#000\" stroke-width=\"1\">"
#define TAIL "</g></svg>"

static tz_curve_set parse(const char *text)
{
    const tz_curve_read_options as_drawn = {.as_drawn = true};
    tz_curve_set s;
    ok(ctx, tz_curve_parse_svg(ctx, "t.svg", text, strlen(text), &as_drawn, &s));
    return s;
}

static void test_little(void **state)
{
    (void)state;
    /* all of them against all: a sound answer, and like themselves */
    static const char *const list[] = {
        HEAD "<path d='M10 50L90 50'/>" TAIL,
        HEAD "<circle cx='50' cy='50' r='30'/>" TAIL,
        HEAD "<path d='M50 50L50.001 50'/>" TAIL,
        HEAD "<path d='M0 0L100 0L100 100L0 100Z'/>" TAIL,
        HEAD "<path d='M10 10L90 90L10 90L90 10'/><path d='M10 10L90 90'/>" TAIL,
        HEAD "<path d='M20 80C120 0 -20 0 80 80'/>" TAIL,
        HEAD "<path d='M-500 50L600 50M50 -900L50 900'/>" TAIL,
    };
    enum { N = sizeof list / sizeof *list };
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            tz_curve_set a = parse(list[i]), b = parse(list[k]);
            const tz_curve_likeness q = compared(&a, &b);
            sound(&q);
            if (i == k)
                assert_true(q.mean < 0.3);
            tz_curve_set_deinit(&a);
            tz_curve_set_deinit(&b);
        }
}

static void test_bad(void **state)
{
    (void)state;
    tz_curve_set empty = empty_set(100, 100),
                 line = parse(HEAD "<path d='M9 9L90 80'/>" TAIL),
                 out = empty_set(100, 100);
    tz_curve_likeness q, before;
    add_line(&out, (tz_vec2){200, 200}, (tz_vec2){300, 250}, (tz_vec2){0, 0});
    memset(&q, 77, sizeof q);
    before = q;
    fails(ctx, tz_curve_compare(ctx, &empty, &line, &q), TZ_INVALID, "exemplar");
    fails(ctx, tz_curve_compare(ctx, &line, &empty, &q), TZ_INVALID, "layout");
    fails(ctx, tz_curve_compare(ctx, &line, &out, &q), TZ_INVALID, "layout");
    fails(ctx, tz_curve_compare(ctx, &out, &line, &q), TZ_INVALID, "exemplar");
    line.node.v[0].x = NAN;
    fails(ctx, tz_curve_compare(ctx, &line, &line, &q), TZ_INVALID, "exemplar");
    assert_memory_equal(&q, &before, sizeof q);
    tz_curve_set_deinit(&empty);
    tz_curve_set_deinit(&line);
    tz_curve_set_deinit(&out);
}

/* Heaps of crossing lines end in an answer or in one clear line. */
static void test_heap(void **state)
{
    (void)state;
    tz_curve_set a = empty_set(100, 100);
    tz_rng r = tz_rng_make(1, 1);
    for (int i = 0; i < 600; i++)
        add_line(&a, (tz_vec2){100 * tz_rng_unit(&r), 100 * tz_rng_unit(&r)},
                 (tz_vec2){100 * tz_rng_unit(&r), 100 * tz_rng_unit(&r)},
                 (tz_vec2){0, 0});
    const tz_curve_likeness q = compared(&a, &a);
    sound(&q);
    assert_true(q.mean < 0.3);
    tz_curve_set_deinit(&a);
}

/* ---- same bytes, and no memory ----------------------------------------------------- */

static void test_threads(void **state)
{
    (void)state;
    net n = plain, m = plain;
    m.seed = 4, m.w = 700;
    tz_curve_likeness q[3];
    static const int threads[] = {1, 2, 8};
    memset(q, 0, sizeof q);
    for (int i = 0; i < 3; i++) {
        tz_ctx *own = new_ctx(threads[i]);
        tz_curve_set a = make_net(&n), b = make_net(&m);
        ok(own, tz_curve_compare(own, &a, &b, &q[i]));
        tz_curve_set_deinit(&a);
        tz_curve_set_deinit(&b);
        end_ctx(own);
    }
    assert_memory_equal(&q[0], &q[1], sizeof q[0]);
    assert_memory_equal(&q[0], &q[2], sizeof q[0]);
}

/* A standard serves many layouts, and says what a comparison says. */
static void test_standard(void **state)
{
    (void)state;
    net n = plain, m = plain;
    tz_curve_set a = make_net(&n);
    tz_curve_standard *k = NULL;
    ok(ctx, tz_curve_standard_new(ctx, &a, &k));
    for (uint64_t seed = 3; seed < 5; seed++) {
        m.seed = seed;
        tz_curve_set b = make_net(&m);
        tz_curve_likeness p, q;
        memset(&p, 0, sizeof p);
        memset(&q, 0, sizeof q);
        ok(ctx, tz_curve_standard_compare(k, &b, &p));
        ok(ctx, tz_curve_compare(ctx, &a, &b, &q));
        assert_memory_equal(&p, &q, sizeof p);
        tz_curve_set_deinit(&b);
    }
    tz_curve_standard_free(k);
    tz_curve_standard_free(NULL);
    tz_curve_set_deinit(&a);
}

static tz_curve_set survivors[2];

static tz_status compare_survivors(tz_ctx *own)
{
    tz_curve_likeness q;
    return tz_curve_compare(own, &survivors[0], &survivors[1], &q);
}

static void test_memory(void **state)
{
    (void)state;
    net n = plain;
    n.w = n.h = 50;
    survivors[0] = make_net(&n);
    survivors[1] = make_long(1, 60, 60);
    survivors[1].domain.torus = false;
    survive(compare_survivors, 1);
    tz_curve_set_deinit(&survivors[0]);
    tz_curve_set_deinit(&survivors[1]);
}

static void test_cancel(void **state)
{
    (void)state;
    net n = plain;
    tz_curve_set a = make_net(&n);
    tz_curve_likeness q;
    tz_ctx_cancel(ctx);
    assert_int_equal(tz_curve_compare(ctx, &a, &a, &q), TZ_CANCELLED);
    tz_ctx_clear(ctx);
    tz_curve_set_deinit(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_same, begin, end),
        cmocka_unit_test_setup_teardown(test_another, begin, end),
        cmocka_unit_test_setup_teardown(test_halves, begin, end),
        cmocka_unit_test_setup_teardown(test_left_out, begin, end),
        cmocka_unit_test_setup_teardown(test_damage, begin, end),
        cmocka_unit_test_setup_teardown(test_shuffled, begin, end),
        cmocka_unit_test_setup_teardown(test_kinks, begin, end),
        cmocka_unit_test_setup_teardown(test_pairing, begin, end),
        cmocka_unit_test_setup_teardown(test_torus, begin, end),
        cmocka_unit_test_setup_teardown(test_region, begin, end),
        cmocka_unit_test_setup_teardown(test_frames, begin, end),
        cmocka_unit_test_setup_teardown(test_repeats, begin, end),
        cmocka_unit_test_setup_teardown(test_little, begin, end),
        cmocka_unit_test_setup_teardown(test_bad, begin, end),
        cmocka_unit_test_setup_teardown(test_heap, begin, end),
        cmocka_unit_test_setup_teardown(test_threads, begin, end),
        cmocka_unit_test_setup_teardown(test_standard, begin, end),
        cmocka_unit_test_setup_teardown(test_memory, begin, end),
        cmocka_unit_test_setup_teardown(test_cancel, begin, end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
