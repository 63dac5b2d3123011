/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Region growing of elements, on one thread.
 *
 *   bench_elements [RUNS]
 *
 * prints lines: grow EXEMPLAR SOURCES RINGS OPTIMISE ELEMENTS BEGIN_SECONDS SECONDS
 * ELEMENTS_PER_SECOND; seconds are the best of the runs.
 *
 *   bench_elements quality FOLDER [OUT]
 *
 * grows from every element exemplar (SVG) in the folder and from drawn ones: mean ratio of
 * likeness, density, overlaps and holes over the exemplar's, how far the shares of kinds,
 * symbols and angles are off. The layouts go to the folder OUT.
 *
 *   bench_elements distance OUT
 *
 * mean neighbourhood distance over time for patch initialisation, and growth alone, with
 * local and with global optimisation: OUT.csv and OUT.svg. @source [Dav19] Fig. 17 */
#include <dirent.h>

#include "elements/element_compare.h"
#include "elements/element_density.h"
#include "elements/element_io.h"
#include "elements/energy.h"
#include "elements/growth.h"
#include "tests/bench/bench.h"
#include "tests/elements/patterns.h"
#include "tests/support/elements.h"

enum { RUNS_MAX = 99, FILES_MAX = 64, CURVE = 64, WAYS = 4 };

static tz_growth_params defaults(void)
{
    tz_growth_params p;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_growth_param_table, &p);
    return p;
}

static double best_of(const double *v, int n)
{
    double least = v[0];
    for (int k = 1; k < n; k++)
        least = v[k] < least ? v[k] : least;
    return least;
}

/* ---- speed ----------------------------------------------------------------------- */

static void measure(tz_ctx *ctx, const char *name, const tz_element_set *ex,
                    int32_t rings, int32_t optimise, int runs)
{
    static const char *const how[] = {"none", "local", "global"};
    double begin[RUNS_MAX], grow[RUNS_MAX];
    int32_t n = 0;
    /* so large that some 10,000 elements fit */
    const double scale = sqrt(10000.0 / ex->element.n);
    const tz_domain d = {
        .size = {ex->domain.size.x * scale, ex->domain.size.y * scale, 0},
        .torus = false};
    tz_growth_params p = defaults();
    p.rings = rings;
    p.optimise = optimise;
    for (int k = 0; k < runs; k++) {
        tz_element_set out;
        tz_growth *g = NULL;
        bool more = true;
        bench_check(ctx, tz_element_set_like(ctx, ex, &d, &out));
        const double start = bench_cpu();
        bench_check(ctx, tz_growth_begin(ctx, ex, &p, &out, &g));
        begin[k] = bench_cpu() - start;
        while (more)
            bench_check(ctx, tz_growth_step(g, 1000, &more));
        grow[k] = bench_cpu() - start - begin[k];
        n = out.element.n;
        tz_growth_end(g);
        tz_element_set_deinit(&out);
    }
    const double seconds = best_of(grow, runs);
    printf("grow %s %d %d %s %d %.4f %.4f %.0f\n", name, (int)ex->element.n, (int)rings,
           how[optimise], (int)n, best_of(begin, runs), seconds, n / seconds);
    fflush(stdout);
}

static void speed(tz_ctx *ctx, int runs)
{
    tz_element_set ex;
    bench_check(ctx, drawn_hexagons(ctx, 9, 9, 0, false, &ex));
    measure(ctx, "hexagonal", &ex, 2, TZ_GROWTH_NONE, runs);
    measure(ctx, "hexagonal", &ex, 2, TZ_GROWTH_LOCAL, runs);
    tz_element_set_deinit(&ex);
    bench_check(ctx, drawn_darts(ctx, 163, 8, 300, 1, false, &ex));
    measure(ctx, "stochastic", &ex, 2, TZ_GROWTH_NONE, runs);
    measure(ctx, "stochastic", &ex, 2, TZ_GROWTH_LOCAL, runs);
    tz_element_set_deinit(&ex);
    bench_check(ctx, drawn_darts(ctx, 90, 8, 80, 1, false, &ex));
    measure(ctx, "stochastic", &ex, 2, TZ_GROWTH_LOCAL, runs);
    tz_element_set_deinit(&ex);
    bench_check(ctx, drawn_mosaic(ctx, 1000, &ex));
    measure(ctx, "mosaic", &ex, 3, TZ_GROWTH_LOCAL, runs);
    tz_element_set_deinit(&ex);
}

/* ---- quality --------------------------------------------------------------------- */

typedef int32_t (*label)(const tz_element *e);

static int32_t kind_of(const tz_element *e) { return e->kind; }
static int32_t symbol_of(const tz_element *e) { return e->symbol; }
static int32_t turn_of(const tz_element *e)
{
    return (int32_t)(fmod(e->angle / TZ_PI + 4.0 + 1.0 / 16, 1.0) * 8);
}

/* Whether an element can be copied, or one of its symbol. */
static bool is_copied(const tz_element_set *s, const tz_element *e)
{
    for (int32_t i = 0; i < s->element.n && e->cut; i++)
        if (!s->element.v[i].cut && s->element.v[i].symbol == e->symbol)
            return true;
    return !e->cut;
}

/* Half the sum of differences of shares: what part of all has the wrong label. The
 * exemplar's elements weigh what they stand for: large ones are more often cut. */
static double shares_off(tz_ctx *ctx, const tz_element_set *a, const tz_element_set *b,
                         label of)
{
    enum { LABELS = 4096 };
    static double share[LABELS];
    double sum = 0, whole = 0, *weight;
    bool period;
    memset(share, 0, sizeof share);
    bench_check(ctx, tz_alloc(ctx, &weight, (size_t)a->element.n, sizeof *weight));
    tz_element_weights(a, weight, &period);
    for (int32_t i = 0; i < a->element.n; i++) {
        if (!period && !is_copied(a, &a->element.v[i]))
            weight[i] = 0;
        whole += weight[i];
    }
    for (int32_t i = 0; i < a->element.n; i++)
        share[of(&a->element.v[i]) % LABELS] += weight[i] / whole;
    for (int32_t i = 0; i < b->element.n; i++)
        share[of(&b->element.v[i]) % LABELS] -= 1.0 / b->element.n;
    for (int32_t k = 0; k < LABELS; k++)
        sum += fabs(share[k]) / 2;
    tz_free(ctx, weight);
    return sum;
}

static void rate(tz_ctx *ctx, const char *name, const tz_element_set *ex,
                 const char *folder)
{
    const double scale = fmin(8, fmax(2, sqrt(1000.0 / ex->element.n)));
    const tz_domain d = {
        .size = {ex->domain.size.x * scale, ex->domain.size.y * scale, 0}};
    const tz_growth_params p = defaults();
    tz_element_set out;
    tz_element_likeness l;
    tz_growth *g = NULL;
    bool more = true;
    char path[512];
    bench_check(ctx, tz_element_set_like(ctx, ex, &d, &out));
    bench_check(ctx, tz_growth_begin(ctx, ex, &p, &out, &g));
    const double start = bench_cpu();
    while (more)
        bench_check(ctx, tz_growth_step(g, 1000, &more));
    const double seconds = bench_cpu() - start;
    tz_growth_report r;
    tz_growth_tell(g, &r);
    tz_growth_end(g);
    bench_check(ctx, tz_element_compare(ctx, ex, &out, &l));
    printf("%-20s %5d %6d %6.2f %7.3f %5.3f %5.2f/%4.2f %6.2f/%-6.2f %6.3f %6.3f %6.3f  "
           "%4.2f %4.2f %4.2f %4.2f %4.2f %4.2f %4.2f %8.0f\n",
           name, (int)ex->element.n, (int)out.element.n, l.mean, l.density,
           r.placed / r.expected, l.overlaps[1], l.overlaps[0], l.hole[1], l.hole[0],
           shares_off(ctx, ex, &out, kind_of), shares_off(ctx, ex, &out, symbol_of),
           shares_off(ctx, ex, &out, turn_of), l.nearest, l.correlation,
           l.neighbourhood[0], l.neighbourhood[1], l.neighbourhood[2], l.classes,
           l.orientation, out.element.n / seconds);
    fflush(stdout);
    if (folder) {
        snprintf(path, sizeof path, "%s/%s.svg", folder, name);
        bench_check(ctx, tz_element_write_svg(ctx, path, &out));
    }
    tz_element_set_deinit(&out);
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static void rate_files(tz_ctx *ctx, const char *from, const char *folder)
{
    /* curves, not elements */
    static const char *const curves = "contours lattice network wood";
    char *name[FILES_MAX], path[512];
    int n = 0;
    DIR *d = opendir(from);
    for (struct dirent *e; d && n < FILES_MAX && (e = readdir(d)) != NULL;) {
        const size_t length = strlen(e->d_name);
        char word[64] = {0};
        snprintf(word, sizeof word, "%.*s", (int)strcspn(e->d_name, "_."), e->d_name);
        if (length > 4 && !strcmp(e->d_name + length - 4, ".svg") &&
            !strstr(curves, word))
            name[n++] = strdup(e->d_name);
    }
    if (d)
        closedir(d);
    qsort(name, (size_t)n, sizeof *name, by_name);
    for (int k = 0; k < n; k++) {
        tz_element_set ex;
        snprintf(path, sizeof path, "%s/%s", from, name[k]);
        bench_check(ctx, tz_element_read_svg(ctx, path, NULL, &ex));
        name[k][strlen(name[k]) - 4] = 0;
        rate(ctx, name[k], &ex, folder);
        tz_element_set_deinit(&ex);
        free(name[k]);
    }
}

static tz_status draw(tz_ctx *ctx, int which, tz_element_set *ex)
{
    const tz_domain d = {.size = {160, 160, 0}};
    switch (which) {
    case 0: return drawn_hexagons(ctx, 9, 8, 0, false, ex);
    case 1: return drawn_hexagons(ctx, 9, 8, 0.7, false, ex);
    case 2: return drawn_squares(ctx, 9, 2, false, ex);
    case 3: return pattern_make(ctx, ex, PATTERN_JITTER, d, 3);
    case 4: return pattern_make(ctx, ex, PATTERN_RANDOM, d, 3);
    case 5: return pattern_make(ctx, ex, PATTERN_MIXED, d, 3);
    case 6: return pattern_make(ctx, ex, PATTERN_BRICK, d, 3);
    case 7: return drawn_darts(ctx, 150, 8, 300, 3, false, ex);
    case 8: return drawn_darts(ctx, 200, 8, 200, 1, false, ex);
    case 9: return drawn_mixed(ctx, 200, false, ex);
    default: return drawn_mosaic(ctx, 600, ex);
    }
}

static void quality(tz_ctx *ctx, const char *from, const char *folder)
{
    static const char *const name[] = {
        "drawn_hexagons", "drawn_hexagons_loose", "drawn_chess",  "drawn_jitter",
        "drawn_random",   "drawn_mixed_jitter",   "drawn_bricks", "drawn_darts",
        "drawn_sparse",   "drawn_sizes",          "drawn_mosaic"};
    printf("%-20s %5s %6s %6s %7s %5s %10s %13s %6s %6s %6s  %s %8s\n", "exemplar",
           "from", "grown", "mean", "density", "own", "overlaps", "hole", "kinds", "symb",
           "turns", "near corr ngb1 ngb2 ngb3 clas orie", "rate");
    rate_files(ctx, from, folder);
    for (int k = 0; k < (int)(sizeof name / sizeof name[0]); k++) {
        tz_element_set ex;
        bench_check(ctx, draw(ctx, k, &ex));
        rate(ctx, name[k], &ex, folder);
        tz_element_set_deinit(&ex);
    }
}

/* ---- mean neighbourhood distance over time --------------------------------------- */

/* A curve: seconds of work so far, elements, distance in spacings of the exemplar. */
typedef struct curve {
    const char *name;
    int n;
    double seconds[CURVE], elements[CURVE], distance[CURVE];
} curve;

static void note(tz_ctx *ctx, curve *c, const tz_element_set *ex,
                 const tz_element_set *out, double seconds)
{
    tz_element_likeness l;
    if (c->n == CURVE || out->element.n < 40)
        return;
    bench_check(ctx, tz_element_compare(ctx, ex, out, &l));
    const double spacing = sqrt(ex->domain.size.x * ex->domain.size.y / ex->element.n);
    c->seconds[c->n] = seconds;
    c->elements[c->n] = out->element.n;
    c->distance[c->n++] = l.distance[1] / spacing;
}

typedef struct watch {
    tz_ctx *ctx;
    const tz_element_set *ex;
    curve *c;
    double start, measured; /* seconds spent on measuring do not count */
} watch;

static tz_status observe(void *user, tz_element_set *out, int32_t iteration,
                         double energy)
{
    (void)iteration, (void)energy;
    watch *w = user;
    const double now = bench_cpu();
    note(w->ctx, w->c, w->ex, out, now - w->start - w->measured);
    w->measured += bench_cpu() - now;
    return TZ_OK;
}

static void follow_patches(tz_ctx *ctx, const tz_element_set *ex, const tz_domain *d,
                           curve *c)
{
    tz_element_set out;
    tz_energy_params p;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_energy_param_table, &p);
    p.start = TZ_ENERGY_PATCHES;
    p.tries = 1; /* as in the paper */
    p.iterations = 40;
    watch w = {.ctx = ctx, .ex = ex, .c = c, .start = bench_cpu()};
    const tz_energy_hook hook = {.after = observe, .user = &w};
    bench_check(ctx, tz_element_set_like(ctx, ex, d, &out));
    bench_check(ctx, tz_energy_solve(ctx, ex, &p, &out, &hook, NULL));
    tz_element_set_deinit(&out);
}

static void follow_growth(tz_ctx *ctx, const tz_element_set *ex, const tz_domain *d,
                          int32_t optimise, curve *c)
{
    tz_element_set out;
    tz_growth *g = NULL;
    bool more = true;
    tz_growth_params p = defaults();
    p.optimise = optimise;
    double measured = 0;
    const double start = bench_cpu();
    bench_check(ctx, tz_element_set_like(ctx, ex, d, &out));
    bench_check(ctx, tz_growth_begin(ctx, ex, &p, &out, &g));
    while (more) {
        bench_check(ctx, tz_growth_step(g, 100, &more));
        const double now = bench_cpu();
        note(ctx, c, ex, &out, now - start - measured);
        measured += bench_cpu() - now;
    }
    tz_growth_end(g);
    tz_element_set_deinit(&out);
}

static void plot_panel(FILE *f, const char *name, const curve *c, double left)
{
    static const char *const colour[WAYS] = {"#888888", "#e08214", "#1b7837", "#2166ac"};
    double longest = 1e-9, highest = 1e-9;
    for (int w = 0; w < WAYS; w++)
        for (int k = 0; k < c[w].n; k++) {
            highest = fmax(highest, c[w].distance[k]);
            if (w > 0)
                longest = fmax(longest, c[w].seconds[k]);
        }
    longest *= 1.25; /* patches go on beyond the right border */
    fprintf(f,
            "<text x='%g' y='24'>%s</text><path d='M%g 40V280H%g' stroke='#000' "
            "fill='none'/>\n<text x='%g' y='298'>0</text>"
            "<text x='%g' y='298' text-anchor='end'>%.3f s</text>"
            "<text x='%g' y='52'>%.3f spacings</text>\n",
            left, name, left, left + 280, left, left + 280, longest, left + 4, highest);
    for (int w = 0; w < WAYS; w++) {
        fprintf(f, "<polyline fill='none' stroke='%s' stroke-width='1.5' points='",
                colour[w]);
        for (int k = 0; k < c[w].n && c[w].seconds[k] <= longest; k++)
            fprintf(f, "%.1f,%.1f ", left + 280 * c[w].seconds[k] / longest,
                    280 - 225 * c[w].distance[k] / highest);
        fprintf(f, "'/>\n<text x='%g' y='%d' fill='%s'>%s: %.3f</text>\n", left + 120,
                70 + 16 * w, colour[w], c[w].name,
                c[w].n ? c[w].distance[c[w].n - 1] : 0);
    }
}

static void distances(tz_ctx *ctx, const char *to)
{
    static const char *const name[3] = {"mosaic", "jittered", "random"};
    static const int which[3] = {10, 3, 8};
    static curve c[3][WAYS];
    char path[512];
    snprintf(path, sizeof path, "%s.csv", to);
    FILE *csv = fopen(path, "w");
    snprintf(path, sizeof path, "%s.svg", to);
    FILE *svg = fopen(path, "w");
    if (!csv || !svg) {
        fprintf(stderr, "bench: %s cannot be written\n", path);
        exit(1);
    }
    fprintf(csv, "exemplar,method,seconds,elements,distance\n");
    fprintf(svg, "<svg xmlns='http://www.w3.org/2000/svg' width='980' height='310' "
                 "font-family='sans-serif' font-size='12'>\n"
                 "<rect width='980' height='310' fill='#fff'/>\n");
    for (int e = 0; e < 3; e++) {
        tz_element_set ex;
        bench_check(ctx, draw(ctx, which[e], &ex));
        const double scale = sqrt(2000.0 / ex.element.n);
        const tz_domain d = {
            .size = {ex.domain.size.x * scale, ex.domain.size.y * scale, 0}};
        c[e][0].name = "patches", c[e][1].name = "growth alone";
        c[e][2].name = "growth, local", c[e][3].name = "growth, global";
        follow_patches(ctx, &ex, &d, &c[e][0]);
        follow_growth(ctx, &ex, &d, TZ_GROWTH_NONE, &c[e][1]);
        follow_growth(ctx, &ex, &d, TZ_GROWTH_LOCAL, &c[e][2]);
        follow_growth(ctx, &ex, &d, TZ_GROWTH_GLOBAL, &c[e][3]);
        plot_panel(svg, name[e], c[e], 30 + 320 * e);
        for (int w = 0; w < WAYS; w++)
            for (int k = 0; k < c[e][w].n; k++)
                fprintf(csv, "%s,%s,%.5f,%.0f,%.5f\n", name[e], c[e][w].name,
                        c[e][w].seconds[k], c[e][w].elements[k], c[e][w].distance[k]);
        for (int w = 0; w < WAYS; w++)
            if (c[e][w].n)
                printf("distance %s %s %.4f s %.4f spacings\n", name[e], c[e][w].name,
                       c[e][w].seconds[c[e][w].n - 1], c[e][w].distance[c[e][w].n - 1]);
        tz_element_set_deinit(&ex);
    }
    fprintf(svg, "</svg>\n");
    fclose(csv);
    fclose(svg);
}

int main(int argc, char **argv)
{
    tz_ctx *ctx = bench_ctx(1);
    if (argc > 2 && !strcmp(argv[1], "quality")) {
        quality(ctx, argv[2], argc > 3 ? argv[3] : NULL);
    } else if (argc > 2 && !strcmp(argv[1], "distance")) {
        distances(ctx, argv[2]);
    } else {
        const int runs = argc > 1 ? atoi(argv[1]) : 5;
        speed(ctx, runs < 1 ? 1 : runs > RUNS_MAX ? RUNS_MAX : runs);
    }
    tz_ctx_free(ctx);
    return 0;
}
