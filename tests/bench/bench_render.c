/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rendering in memory, ours and stock cv::seamlessClone of the same placements one by one,
 * in turns. Ours is timed from photo and layout to pixels; of stock cloning only the calls
 * count (warp of the patch and clone, in place), neither its canvas nor conversions.
 *
 *   bench_render PHOTO [RUNS [THREADS]]
 *
 * prints lines: render CASE SIDE GROUPS BOX CHANNELS METHOD SECONDS CPU, where CASE is
 *   cover     star-shaped patches on a jittered grid that cover the layout
 *   loose     360 patches of 60 to 140 px that leave gaps, as figures of stock usage have it
 *   arranged  a layout as tz_arrange makes it
 * and BOX the mean side of the patches' boxes in px. */
#include "base/module.h"
#include "synthesis/arrange.h"
#include "synthesis/clone_module.h"
#include "synthesis/compose.h"
#include "tests/bench/bench.h"

enum { POINTS = 64, RUNS_MAX = 99, FRAME = 32 };

/* Star about (0, 0): mean radius r, three waves of random phase. */
static void star(tz_rng *rng, double r, tz_point p[POINTS])
{
    double phase[3];
    for (int k = 0; k < 3; k++)
        phase[k] = tz_rng_range(rng, 0, 2 * TZ_PI);
    for (int i = 0; i < POINTS; i++) {
        const double a = 2 * TZ_PI * i / POINTS;
        const double s = 1 + 0.08 * cos(2 * a + phase[0]) + 0.05 * cos(3 * a + phase[1]) +
                         0.03 * cos(7 * a + phase[2]);
        p[i] = (tz_point){(float)(r * s * cos(a)), (float)(r * s * sin(a))};
    }
}

/* About `groups` patches on a jittered grid.
 * @param lo, hi  sides of their boxes, px; 0 = covering */
static void make_layout(tz_ctx *ctx, const tz_image *photo, int32_t side, int32_t groups,
                        double lo, double hi, tz_layout *l)
{
    bench_check(ctx, tz_layout_init(ctx, l, side, side, false));
    bench_check(
        ctx, tz_layout_add_source(l, "photo", NULL, photo->width, photo->height, NULL));
    tz_rng rng = tz_rng_make(5, (uint64_t)groups);
    int32_t columns = (int32_t)lround(sqrt(groups)), placed = 0;
    for (int32_t j = 0; placed < groups; j++) {
        const int32_t rows = (groups + columns - 1) / columns;
        const int32_t here = j + 1 < rows ? columns : groups - placed;
        for (int32_t i = 0; i < here; i++, placed++) {
            const double dx = (double)side / here, dy = (double)side / rows;
            const double cell = sqrt(dx * dx + dy * dy);
            const double r = lo > 0 ? 0.5 * tz_rng_range(&rng, lo, hi) / 1.06
                                    : cell * tz_rng_range(&rng, 0.62, 0.72);
            tz_point p[POINTS];
            star(&rng, r, p);
            const double room = 1.2 * r;
            const double x = photo->width > 2 * room
                                 ? tz_rng_range(&rng, room, photo->width - room)
                                 : 0.5 * photo->width;
            const double y = photo->height > 2 * room
                                 ? tz_rng_range(&rng, room, photo->height - room)
                                 : 0.5 * photo->height;
            for (int k = 0; k < POINTS; k++)
                p[k].x += (float)x, p[k].y += (float)y;
            const tz_vec2 to = {(i + 0.5 + tz_rng_range(&rng, -0.15, 0.15)) * dx,
                                (j + 0.5 + tz_rng_range(&rng, -0.15, 0.15)) * dy};
            const tz_affine map =
                tz_affine_place((tz_vec2){x, y}, to, tz_rng_range(&rng, -TZ_PI, TZ_PI),
                                tz_rng_range(&rng, 0.95, 1.05), false);
            bench_check(ctx, tz_layout_add(l, 0, -1, map, p, POINTS, NULL));
        }
    }
}

static double mean_box(const tz_layout *l)
{
    double sum = 0;
    for (int32_t k = 0; k < l->place.n; k++) {
        const tz_rect r = tz_layout_box(l, k);
        sum += sqrt((double)r.w * r.h);
    }
    return sum / (l->place.n > 0 ? l->place.n : 1);
}

/* RGB in 8 bits with a frame that repeats its border. */
static tz_clone_picture bytes_of(tz_ctx *ctx, const tz_image *im, int32_t frame)
{
    tz_clone_picture p = {NULL, im->width + 2 * frame, im->height + 2 * frame};
    bench_check(ctx, tz_alloc(ctx, &p.px, (size_t)p.width * (size_t)p.height, 3));
    uint8_t *out = p.px;
    for (int32_t y = -frame; y < im->height + frame; y++)
        for (int32_t x = -frame; x < im->width + frame; x++)
            for (int k = 0; k < 3; k++) {
                const int32_t i = x < 0 ? 0 : x < im->width ? x : im->width - 1;
                const int32_t j = y < 0 ? 0 : y < im->height ? y : im->height - 1;
                const float v = tz_image_at(im, i, j)[im->channels >= 3 ? k : 0];
                *out++ = (uint8_t)(255 * fminf(fmaxf(v, 0), 1) + 0.5F);
            }
    return p;
}

/* Clones every placement onto the canvas, which shows the plain composite. */
static void clone_all(tz_ctx *ctx, const tz_layout *l, const tz_clone_picture *photo,
                      const tz_clone_picture *canvas)
{
    const tz_clone_api *api = NULL;
    double *border = NULL;
    char why[200] = "";
    bench_check(ctx, tz_module_symbol(ctx, "clone", TZ_CLONE_SYMBOL, &api));
    bench_check(ctx, tz_alloc(ctx, &border, 2 * (size_t)l->border.n, sizeof *border));
    for (int32_t k = 0; k < l->place.n; k++) {
        const tz_placement *p = &l->place.v[k];
        tz_affine m = p->map;
        m.e += FRAME, m.f += FRAME;
        for (int32_t q = 0; q < p->points; q++) {
            const tz_point from = l->border.v[p->border + q];
            const tz_vec2 to = tz_affine_apply(m, (tz_vec2){from.x, from.y});
            border[2 * q] = to.x, border[2 * q + 1] = to.y;
        }
        const tz_clone_patch patch = {
            *photo, {m.a, m.b, m.c, m.d, m.e, m.f}, border, p->points};
        if (api->paste(&patch, canvas, why, sizeof why) != 0)
            bench_check(ctx, tz_fail(ctx, TZ_INVALID, "seamlessClone: %s", why));
    }
    tz_free(ctx, border);
}

/* Times of the runs of one method. */
typedef struct timing {
    double wall[RUNS_MAX], cpu[RUNS_MAX];
    int n;
} timing;

static void timing_add(timing *t, double start, double used)
{
    t->wall[t->n] = bench_now() - start;
    t->cpu[t->n++] = bench_cpu() - used;
}

static void render(tz_ctx *ctx, const tz_layout *l, const tz_image *photo, tz_clone clone,
                   tz_image *out)
{
    tz_compose_params p;
    tz_composer *c;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_compose_param_table, &p);
    p.clone = (int32_t)clone;
    bench_check(ctx, tz_composer_new(ctx, l, photo, 1, TZ_MAP_COLOUR, &p, &c));
    bench_check(ctx,
                tz_composer_render(ctx, c, (tz_rect){0, 0, l->width, l->height}, out));
    tz_composer_free(c);
}

/* Runs ours and, where `stock`, the rival in between until it has had its seconds. */
static void measure(tz_ctx *ctx, const char *name, const tz_layout *l,
                    const tz_image *photo, int runs, bool stock)
{
    timing t[2] = {{.n = 0}, {.n = 0}};
    double spent = 0;
    tz_clone_picture bytes = {0}, canvas = {0};
    tz_image out, plain;
    bench_check(ctx, tz_image_init(ctx, &out, l->width, l->height, photo->channels));
    if (stock) {
        bench_check(ctx,
                    tz_image_init(ctx, &plain, l->width, l->height, photo->channels));
        render(ctx, l, photo, TZ_CLONE_NONE, &plain);
        bytes = bytes_of(ctx, photo, 0);
    }
    for (int k = 0; k < runs; k++) {
        double start = bench_now(), used = bench_cpu();
        render(ctx, l, photo, TZ_CLONE_SCREENED, &out);
        timing_add(&t[0], start, used);
        if (!stock || spent > 5)
            continue;
        canvas = bytes_of(ctx, &plain, FRAME);
        start = bench_now(), used = bench_cpu();
        clone_all(ctx, l, &bytes, &canvas);
        timing_add(&t[1], start, used);
        spent += bench_now() - start;
        tz_free(ctx, canvas.px);
    }
    for (int method = 0; method < 2; method++)
        if (t[method].n)
            printf("render %s %d %d %.0f %d %s %.4f %.4f\n", name, (int)l->width,
                   (int)l->place.n, mean_box(l), (int)photo->channels,
                   method == 0 ? "ours" : "stock",
                   bench_median(t[method].wall, t[method].n),
                   bench_median(t[method].cpu, t[method].n));
    fflush(stdout);
    if (stock) {
        tz_image_deinit(&plain);
        tz_free(ctx, bytes.px);
    }
    tz_image_deinit(&out);
}

static void measure_arranged(tz_ctx *ctx, const tz_image *photo, int32_t side, int runs,
                             bool stock)
{
    tz_ebpt_params ep;
    tz_arrange_params ap;
    tz_ebpt e = {0};
    tz_layout l = {0};
    memset(&ep, 0, sizeof ep);
    memset(&ap, 0, sizeof ap);
    tz_params_default(&tz_ebpt_param_table, &ep);
    tz_params_default(&tz_arrange_param_table, &ap);
    ap.size[0] = ap.size[1] = side;
    bench_check(ctx, tz_ebpt_analyze(ctx, photo, &ep, &e));
    const tz_exemplar ex = {photo, &e, "photo", ""};
    bench_check(ctx, tz_arrange(ctx, &ex, 1, NULL, &ap, &l));
    measure(ctx, "arranged", &l, photo, runs, stock);
    tz_layout_deinit(&l);
    tz_ebpt_deinit(&e);
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "use: bench_render PHOTO [RUNS [THREADS]]\n");
        return 2;
    }
    int runs = argc > 2 ? atoi(argv[2]) : 11;
    runs = runs < 1 ? 1 : runs > RUNS_MAX ? RUNS_MAX : runs;
    tz_ctx *ctx = bench_ctx(argc > 3 ? atoi(argv[3]) : 0);
    tz_image photo = bench_photo(ctx, argv[1], 3), grey = bench_photo(ctx, argv[1], 1);
    static const struct {
        int32_t side, groups;
        bool stock;
    } covers[] = {{2048, 120, false},
                  {2048, 360, true},
                  {2048, 3600, true},
                  {1024, 90, false},
                  {4096, 1440, false}};
    tz_layout l;
    for (size_t k = 0; k < sizeof covers / sizeof *covers; k++) {
        make_layout(ctx, &photo, covers[k].side, covers[k].groups, 0, 0, &l);
        measure(ctx, "cover", &l, &photo, runs, covers[k].stock);
        if (covers[k].groups == 360)
            measure(ctx, "cover", &l, &grey, runs, false);
        tz_layout_deinit(&l);
    }
    make_layout(ctx, &photo, 2048, 360, 60, 140, &l);
    measure(ctx, "loose", &l, &photo, runs, true);
    tz_layout_deinit(&l);
    measure_arranged(ctx, &photo, 2048, runs, true);
    tz_image_deinit(&photo);
    tz_image_deinit(&grey);
    tz_ctx_free(ctx);
    return 0;
}
