/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/bench/fill_cases.h"

#include <math.h>

#include "elements/element_io.h"
#include "tests/bench/fill_rival.h"

#define SIDE "600"

const char fill_leaf[] = "<path d=\"M-10,0 C-5,-5 4,-5 10,0 C4,5 -5,5 -10,0Z\" "
                         "fill=\"#4a8f3c\"/>";
const char fill_round[] = "<circle r=\"4\" fill=\"#c8553d\"/>";
const char fill_bar[] =
    "<path d=\"M-20,-3 L18,-3 L20,0 L18,3 L-20,3Z\" fill=\"#588b8b\"/>";
const char fill_drop[] =
    "<path d=\"M-7,0 C-3,-1 0,-5 4,-5 C10,-5 10,5 4,5 C0,5 -3,1 -7,0Z\" "
    "fill=\"#f28f3b\"/>";

void fill_palette(tz_ctx *ctx, const char *const *shape, int n, tz_element_set *s)
{
    char text[8192];
    int at = snprintf(text, sizeof text,
                      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d 60\">",
                      60 * n);
    for (int k = 0; k < n; k++)
        at += snprintf(text + at, sizeof text - (size_t)at,
                       "<g transform=\"translate(%d 30)\">%s</g>", 60 * k + 30, shape[k]);
    snprintf(text + at, sizeof text - (size_t)at, "</svg>");
    bench_check(ctx, tz_element_parse_svg(ctx, "palette", text, strlen(text), NULL, s));
}

tz_fill_params fill_defaults(void)
{
    tz_fill_params p;
    memset(&p, 0, sizeof p);
    tz_params_default(&tz_fill_param_table, &p);
    return p;
}

/* ---- cases -------------------------------------------------------------------------- */

/* Path data in a square of 600; NULL = all of it. */
static const char ring[] = "M300,10A290,290 0 1 1 299.9,10ZM300,190A110,110 0 1 1 "
                           "299.9,190Z";
static const char letter[] = "M60,30H540V150H370V570H230V150H60Z";
static const char animal[] =
    "M60,290C60,190 130,120 250,118C320,116 370,128 402,140C440,100 520,110 545,165C565,"
    "215 556,270 560,330C563,375 570,405 585,430C592,450 560,470 545,448C520,410 512,370 "
    "508,330C500,305 480,300 462,305C452,340 456,380 458,430L462,545L392,545L386,420C384,"
    "400 372,398 370,420L374,545L306,545L298,420C290,395 262,395 256,420L252,545L184,545"
    "L180,420C178,400 166,400 164,420L160,545L92,545L88,430C70,390 60,340 60,290Z";

typedef struct test_case {
    const char *name, *domain, *strokes;
    const char *thing[4];
    double rigidity, size[2];
} test_case;

static const test_case cases[] = {
    {"sparse-leaves", NULL, "M60,420 C200,150 380,520 540,180", {fill_leaf}, 100, {1, 1}},
    {"dense-mix",
     NULL,
     "M40,80 C200,20 380,140 560,80 M40,220 C200,160 380,280 560,220 M40,360 C200,300 "
     "380,420 560,360 M40,500 C200,440 380,560 560,500",
     {fill_leaf, fill_round, fill_drop},
     100,
     {1, 1}},
    {"crossing-leaves",
     NULL,
     "M60,60 L540,540 M60,540 L540,60",
     {fill_leaf, fill_drop},
     100,
     {1, 1}},
    {"circular-bars",
     NULL,
     "M300,110 C405,110 490,195 490,300 C490,405 405,490 300,490 C195,490 110,405 "
     "110,300 C110,195 195,110 300,110Z",
     {fill_bar},
     100,
     {1, 1}},
    {"singular-leaves",
     NULL,
     "M300,300 L560,300 M300,300 L300,560 M300,300 L40,300 M300,300 L300,40",
     {fill_leaf},
     100,
     {1, 1}},
    {"ring-drops",
     ring,
     "M300,40 C440,40 560,160 560,300",
     {fill_drop, fill_round},
     100,
     {1, 1}},
    {"letter-soft", letter, "M150,90 L450,90 M300,150 L300,550", {fill_bar}, 0, {1, 1}},
    {"animal-leaves",
     animal,
     "M100,300 C140,150 320,150 420,180 C540,170 530,280 545,400 M340,330 L340,520 "
     "M125,370 L126,520",
     {fill_leaf, fill_round},
     100,
     {1, 1}},
    {"mixed-sizes",
     NULL,
     "M60,300 C200,100 400,500 540,300",
     {fill_leaf, fill_round},
     100,
     {0.4, 3.2}},
    {"soft-bars",
     NULL,
     "M60,480 C200,100 400,100 540,480",
     {fill_bar, fill_round},
     0,
     {1, 1}},
};
enum { CASES = sizeof cases / sizeof *cases };

/* ---- figures ------------------------------------------------------------------------ */

enum {
    THINGS,
    FIRST,
    COVERED,
    GAIN,
    OVERLAP,
    OUTSIDE,
    HOLE,
    TURN,
    RMS,
    TURN95,
    BEND,
    ALIGN,
    ALIGN_MOST,
    DROPPED,
    SHRUNK,
    CPU,
    FIGURES
};
static const struct {
    const char *name;
    int better; /* 1 = more, -1 = less, 0 = neither */
    int digits;
    double apart; /* less than that is equal: half a cell of the rasters that measure */
} figure[FIGURES] = {
    {"things", 0, 0, 0},     {"first", 0, 3, 0},       {"covered", 1, 3, 1e-3},
    {"gain", 1, 3, 1e-3},    {"overlap", -1, 4, 1e-4}, {"outside", -1, 4, 1e-4},
    {"hole", -1, 4, 5e-4},   {"turn", -1, 3, 0.01},    {"rms", -1, 3, 0.01},
    {"turn95", -1, 2, 0.05}, {"bend", -1, 4, 5e-4},    {"align", -1, 3, 0.05},
    {"most", -1, 2, 0.1},    {"dropped", -1, 1, 0.5},  {"shrunk", -1, 1, 0.5},
    {"cpu", 0, 2, 0},
};

static void add_figures(double v[FIGURES], const tz_fill_report *run,
                        const tz_fill_report *first, const tz_fill_report *m, double side)
{
    const double deg = 180 / TZ_PI;
    v[THINGS] += m->elements, v[FIRST] += first->covered, v[COVERED] += m->covered;
    v[GAIN] += m->covered - first->covered, v[OVERLAP] += m->overlap,
        v[OUTSIDE] += m->outside;
    v[HOLE] += m->hole / side, v[TURN] += m->turn * deg, v[RMS] += m->turn_rms * deg;
    v[TURN95] += m->turn_95 * deg;
    v[BEND] += m->spacing > 0 ? m->turn * deg / m->spacing : 0;
    v[ALIGN] += m->align * deg, v[ALIGN_MOST] += m->align_most * deg;
    v[DROPPED] += run->dropped, v[SHRUNK] += run->shrunk;
}

static void print_figures(const char *name, const char *way, const double v[FIGURES])
{
    printf("%-16s %-14s", name, way);
    for (int k = 0; k < FIGURES; k++)
        printf(" %s %.*f", figure[k].name, figure[k].digits, v[k]);
    printf("\n");
    fflush(stdout);
}

/* In how many cases the first is better, as good, worse. */
static void print_summary(const char *against, double (*ours)[FIGURES],
                          double (*other)[FIGURES], int n)
{
    printf("against %s better/equal/worse", against);
    for (int k = 0; k < FIGURES; k++) {
        int better = 0, worse = 0;
        for (int i = 0; i < n; i++) {
            const double d = (ours[i][k] - other[i][k]) * figure[k].better;
            better += d > figure[k].apart, worse += d < -figure[k].apart;
        }
        if (figure[k].better)
            printf(" %s %d/%d/%d", figure[k].name, better, n - better - worse, worse);
    }
    printf("\n");
}

/* ---- one case ----------------------------------------------------------------------- */

typedef struct problem {
    const test_case *c;
    const char *out;
    tz_element_set palette;
    tz_fill_entry entry[4];
    int things;
    tz_element_field strokes, full;
    tz_domain domain;
} problem;

static void write_drawing(const char *path, const char *what)
{
    FILE *f = fopen(path, "w");
    if (!f) {
        fprintf(stderr, "bench: cannot write %s\n", path);
        exit(1);
    }
    fprintf(f,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " SIDE " " SIDE
            "\">%s</svg>",
            what);
    fclose(f);
}

static void begin_problem(tz_ctx *ctx, const test_case *c, const char *out, double weight,
                          problem *p)
{
    const tz_vec3 size = {600, 600, 0};
    char path[1024], text[2048];
    tz_region *region = NULL;
    *p = (problem){.c = c, .out = out, .domain.size = size};
    while (p->things < 4 && c->thing[p->things])
        p->things++;
    fill_palette(ctx, c->thing, p->things, &p->palette);
    for (int k = 0; k < p->things; k++)
        p->entry[k] = (tz_fill_entry){.element = k,
                                      .share = 1,
                                      .rigidity = c->rigidity,
                                      .size = {c->size[0], c->size[1]}};
    if (c->domain) {
        snprintf(text, sizeof text, "<path fill-rule=\"evenodd\" d=\"%s\"/>", c->domain);
        snprintf(path, sizeof path, "%s/%s-domain.svg", out, c->name);
        write_drawing(path, text);
        bench_check(ctx, tz_region_read(ctx, path, size, false, &region));
    }
    p->domain.region = region;
    snprintf(text, sizeof text,
             "<path d=\"%s\" fill=\"none\" stroke=\"#000\" stroke-width=\"8\"/>",
             c->strokes);
    snprintf(path, sizeof path, "%s/%s-field.svg", out, c->name);
    write_drawing(path, text);
    bench_check(ctx, tz_element_field_read(ctx, path, size, false, &p->strokes));
    fill_rival(ctx, &p->strokes, region, weight, &p->full);
}

static void end_problem(problem *p)
{
    tz_region_free((tz_region *)p->domain.region);
    tz_element_field_deinit(&p->strokes);
    tz_element_field_deinit(&p->full);
    tz_element_set_deinit(&p->palette);
}

/* The domain and its strokes, for the eye. */
static void ground_of(const test_case *c, double opacity, char *text, size_t room)
{
    int n =
        snprintf(text, room, "<rect width=\"" SIDE "\" height=\"" SIDE "\" fill=\"%s\"/>",
                 c->domain ? "#fff" : "#faf6ea");
    if (c->domain)
        n += snprintf(text + n, room - (size_t)n,
                      "<path fill-rule=\"evenodd\" fill=\"#faf6ea\" stroke=\"#d8d2c0\" "
                      "d=\"%s\"/>",
                      c->domain);
    snprintf(text + n, room - (size_t)n,
             "<path d=\"%s\" fill=\"none\" stroke=\"#203a5a\" stroke-opacity=\"%g\" "
             "stroke-width=\"8\" stroke-linecap=\"round\"/>",
             c->strokes, opacity);
}

static void write_layout(tz_ctx *ctx, const problem *p, const char *way,
                         tz_element_set *layout)
{
    char path[1024], text[4096];
    ground_of(p->c, 0.2, text, sizeof text);
    tz_free(ctx, layout->background);
    bench_check(ctx, tz_strdup(ctx, text, &layout->background));
    snprintf(path, sizeof path, "%s/%s-%s.svg", p->out, p->c->name, way);
    bench_check(ctx, tz_element_write_svg(ctx, path, layout));
}

typedef struct fill_way {
    const char *name;
    const char *first; /* drawing of its initialisation; NULL = none */
    bool published, full;
    double alpha;
    bool once; /* the first seed only: a row for comparison that takes its time, too */
} fill_way;

/* v: sums over seeds, added to. */
static void run_way(tz_ctx *ctx, const problem *p, const fill_way *way, uint64_t seed,
                    bool draw, double v[FIGURES])
{
    tz_fill_params par = fill_defaults();
    tz_fill_report run, first, last;
    tz_element_set layout;
    tz_fill *f;
    par.start = way->published ? TZ_FILL_RANDOM : TZ_FILL_INSERT;
    par.repair = !way->published;
    if (way->alpha >= 0)
        par.alpha = way->alpha;
    const tz_fill_job job = {.palette = &p->palette,
                             .entry = p->entry,
                             .entries = p->things,
                             .domain = p->domain,
                             .field = way->full ? &p->full : &p->strokes,
                             .params = &par,
                             .seed = seed};
    bench_check(ctx, tz_element_set_like(ctx, &p->palette, &p->domain, &layout));
    bench_check(ctx, tz_fill_begin(ctx, &job, &layout, &f));
    bench_check(ctx, tz_fill_write(f, &layout));
    tz_fill_end(f);
    bench_check(ctx, tz_fill_measure(ctx, &layout, &p->palette, &p->strokes, 0, &first));
    if (draw && way->first)
        write_layout(ctx, p, way->first, &layout);
    tz_element_set_deinit(&layout);

    bench_check(ctx, tz_element_set_like(ctx, &p->palette, &p->domain, &layout));
    const double t = bench_cpu();
    bench_check(ctx, tz_fill_run(ctx, &job, &layout, &run));
    v[CPU] += bench_cpu() - t;
    bench_check(ctx, tz_fill_measure(ctx, &layout, &p->palette, &p->strokes, 0, &last));
    add_figures(v, &run, &first, &last, p->domain.size.x);
    if (draw)
        write_layout(ctx, p, way->name, &layout);
    tz_element_set_deinit(&layout);
}

/* v: means. */
static void run_ways(tz_ctx *ctx, const problem *p, const fill_way *way, int ways,
                     int seeds, bool draw, double (*v)[FIGURES])
{
    for (int k = 0; k < ways; k++) {
        memset(v[k], 0, sizeof v[k]);
        const int n = way[k].once ? 1 : seeds;
        for (int i = 0; i < n; i++)
            run_way(ctx, p, &way[k], 7 + (uint64_t)i, draw && i == 0, v[k]);
        for (int i = 0; i < FIGURES; i++)
            v[k][i] /= n;
        print_figures(p->c->name, way[k].name, v[k]);
    }
}

/* ---- all ---------------------------------------------------------------------------- */

#define FORCED 1000.0 /* weight of a field that is followed whatever neighbours say */

void fill_cases(tz_ctx *ctx, const char *out, const char *only, int seeds)
{
    enum { WAYS = 4 };
    static const fill_way way[WAYS] = {
        {"ours", "first", false, false, -1, false},
        {"published", "random", true, false, -1, true},
        {"two-step", NULL, true, true, 0, false},
        {"two-step-ours", NULL, false, true, 0, true},
    };
    static double v[WAYS][CASES][FIGURES];
    int n = 0;
    for (int k = 0; k < CASES; k++) {
        double one[WAYS][FIGURES];
        char path[1024], text[4096];
        problem p;
        if (!strstr(cases[k].name, only))
            continue;
        begin_problem(ctx, &cases[k], out, FORCED, &p);
        ground_of(p.c, 1, text, sizeof text);
        snprintf(path, sizeof path, "%s/%s-strokes.svg", out, p.c->name);
        write_drawing(path, text);
        run_ways(ctx, &p, way, WAYS, seeds, true, one);
        for (int i = 0; i < WAYS; i++)
            memcpy(v[i][n], one[i], sizeof one[i]);
        n++;
        end_problem(&p);
    }
    for (int i = 1; i < WAYS; i++)
        print_summary(way[i].name, v[0], v[i], n);
}

void fill_weights(tz_ctx *ctx, const char *out, const char *only, int seeds)
{
    static const fill_way way[] = {
        {"alpha-0", NULL, true, true, 0, false},
        {"alpha-0.1", NULL, true, true, 0.1, false},
        {"alpha-0.3", NULL, true, true, 0.3, false},
        {"alpha-1", NULL, true, true, 1, false},
        {"alpha-3", NULL, true, true, 3, false},
    };
    enum { WAYS = sizeof way / sizeof *way };
    for (int k = 0; k < CASES; k++) {
        double v[WAYS][FIGURES];
        problem p;
        if (!strstr(cases[k].name, only))
            continue;
        begin_problem(ctx, &cases[k], out, 1, &p);
        run_ways(ctx, &p, way, WAYS, seeds, false, v);
        end_problem(&p);
    }
}
