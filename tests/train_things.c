/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the nets that tell things from other regions:
 *
 *   train_things [--scenes N] [--epochs N] [--seed N] -o analysis/things_weights.c
 *
 * Every region of the trees of N scenes a kind is an example; what is to be learned is
 * how well it covers a thing: 0 up to an intersection over union of 0.3, 1 from 0.8.
 * The loss is the cross entropy, steps are Adam's, their size falls along a cosine. The
 * second net learns with the sizes that the first one's choice has. The same arguments
 * give the same file. */
#include <math.h>

#include "analysis/things_choose.h"
#include "analysis/things_picture.h"
#include "tests/bench/bench.h"
#include "tests/support/things_truth.h"

enum { BATCH = 128, F = TZ_THINGS_FEATURES, H = TZ_THINGS_HIDDEN };

#define STEP      5.0
#define CERTAINTY 0.35
#define KEPT      0.3 /* share of the regions that cover nothing; they count 1 / KEPT */

typedef struct options {
    const char *out;
    int32_t scenes, epochs;
    uint64_t seed;
} options;

typedef struct example {
    float x[F], target, weight;
} example;

typedef struct examples {
    example *v;
    int64_t n, room;
} examples;

/* ---- examples ------------------------------------------------------------------------ */

static const tz_scene_kind kinds[] = {TZ_SCENE_STONES, TZ_SCENE_BRICKS,  TZ_SCENE_PEBBLES,
                                      TZ_SCENE_LEAVES, TZ_SCENE_SCALES,  TZ_SCENE_MOSAIC,
                                      TZ_SCENE_STONES, TZ_SCENE_PEBBLES, TZ_SCENE_LEAVES,
                                      TZ_SCENE_CRACKS, TZ_SCENE_GROUND,  TZ_SCENE_WEAVE};
enum { KINDS = sizeof kinds / sizeof *kinds };

static void add(examples *e, example one)
{
    if (e->n == e->room) {
        e->room = e->room ? 2 * e->room : 1 << 16;
        e->v = realloc(e->v, (size_t)e->room * sizeof *e->v);
        if (!e->v)
            exit(1);
    }
    e->v[e->n++] = one;
}

static float target_of(float iou)
{
    const float t = (iou - 0.3F) / 0.5F;
    return t < 0 ? 0 : t > 1 ? 1 : t;
}

static void add_scene(tz_ctx *ctx, const tz_scene *scene, const tz_things_net *nets,
                      tz_rng *g, examples *e)
{
    const double all = (double)scene->photo.width * scene->photo.height;
    const tz_things_choice how = {16, all / 4, CERTAINTY, nets};
    tz_things_nodes chosen = {0};
    tz_things_sizes sizes = {0};
    tz_things_view v;
    tz_things_tree t;
    float *iou;
    bench_check(ctx, tz_things_look(ctx, &scene->photo, "", &v));
    bench_check(ctx, tz_things_tree_grow(ctx, &v.picture, STEP, how.most, &t));
    bench_check(ctx, tz_alloc(ctx, &iou, (size_t)t.n, sizeof *iou));
    bench_check(ctx, truth_of_nodes(ctx, &t, scene, iou));
    if (nets) {
        bench_check(ctx, tz_things_choose(ctx, &t, &how, &chosen, NULL, &sizes));
        bench_check(ctx, tz_things_measure_sizes(ctx, &t, &chosen, &sizes));
    }
    const tz_things_overview o = tz_things_survey(&t);
    for (int32_t i = 0; i < t.n; i++) {
        example one = {.target = target_of(iou[i]), .weight = 1};
        if (t.node[i].area < how.least || t.node[i].area > how.most)
            continue;
        if (one.target <= 0) {
            if (tz_rng_unit(g) >= KEPT)
                continue;
            one.weight = 1 / KEPT;
        }
        tz_things_describe(&t, &o, &sizes, i, one.x);
        add(e, one);
    }
    tz_array_free(ctx, &chosen);
    tz_free(ctx, iou);
    tz_things_tree_deinit(&t);
    tz_things_view_deinit(ctx, &v);
}

static examples gather(tz_ctx *ctx, const options *o, const tz_things_net *nets)
{
    examples e = {0};
    for (int32_t i = 0; i < o->scenes * KINDS; i++) {
        tz_rng g = tz_rng_make(o->seed, (uint64_t)i);
        const int32_t w = 192 + tz_rng_below(&g, 256), h = 192 + tz_rng_below(&g, 256);
        const tz_scene_camera camera = i / KINDS % 3 ? TZ_SCENE_WILD : TZ_SCENE_CLEAN;
        tz_scene scene;
        bench_check(ctx, tz_scene_render(ctx, kinds[i % KINDS], camera, w, h,
                                         o->seed + (uint64_t)i, &scene));
        add_scene(ctx, &scene, nets, &g, &e);
        tz_scene_deinit(&scene);
    }
    return e;
}

/* ---- learning ------------------------------------------------------------------------ */

typedef struct layer {
    float in[F][H], bias[H], out[H], out_bias;
} layer;

enum { WEIGHTS = sizeof(layer) / sizeof(float) };

static void standardise(const examples *e, tz_things_net *net)
{
    for (int k = 0; k < F; k++) {
        double sum = 0, square = 0;
        for (int64_t i = 0; i < e->n; i++) {
            sum += e->v[i].x[k];
            square += (double)e->v[i].x[k] * e->v[i].x[k];
        }
        const double mean = sum / (double)e->n;
        net->mean[k] = (float)mean;
        net->deviation[k] =
            (float)fmax(sqrt(fmax(square / (double)e->n - mean * mean, 0)), 1e-3);
    }
}

/* Adds the gradient of one example; returns its loss. */
static double learn(const tz_things_net *net, const layer *l, const example *e, layer *g)
{
    float x[F], h[H], sum = l->out_bias;
    memcpy(h, l->bias, sizeof h);
    for (int k = 0; k < F; k++) {
        x[k] = (e->x[k] - net->mean[k]) / net->deviation[k];
        for (int j = 0; j < H; j++)
            h[j] += l->in[k][j] * x[k];
    }
    for (int j = 0; j < H; j++)
        sum += l->out[j] * h[j] / (1 + fabsf(h[j]));
    const float p = 1 / (1 + expf(-sum)), d = e->weight * (p - e->target);
    g->out_bias += d;
    for (int j = 0; j < H; j++) {
        const float soft = 1 / (1 + fabsf(h[j]));
        g->out[j] += d * h[j] * soft;
        h[j] = d * l->out[j] * soft * soft;
        g->bias[j] += h[j];
    }
    for (int k = 0; k < F; k++)
        for (int j = 0; j < H; j++)
            g->in[k][j] += h[j] * x[k];
    return -e->weight * (e->target * log(p + 1e-9) + (1 - e->target) * log(1 - p + 1e-9));
}

static void train(const options *o, const examples *e, tz_things_net *net)
{
    static layer l, g, m1, m2;
    float *w = (float *)&l, *d = (float *)&g, *a = (float *)&m1, *b = (float *)&m2;
    tz_rng r = tz_rng_make(o->seed, 77);
    const int64_t steps = e->n / BATCH, all = steps * o->epochs;
    double loss = 0, weight = 0;
    standardise(e, net);
    memset(&m1, 0, sizeof m1);
    memset(&m2, 0, sizeof m2);
    for (int i = 0; i < WEIGHTS; i++)
        w[i] = (float)(tz_rng_normal(&r) / sqrt(F));
    for (int64_t t = 0; t < all; t++) {
        memset(&g, 0, sizeof g);
        for (int i = 0; i < BATCH; i++) {
            const example *one = &e->v[tz_rng_below(&r, (int32_t)e->n)];
            loss += learn(net, &l, one, &g);
            weight += one->weight;
        }
        const double rate = 0.004 * 0.5 * (1 + cos(TZ_PI * (double)t / (double)all)),
                     c1 = 1 - pow(0.9, (double)t + 1), c2 = 1 - pow(0.999, (double)t + 1);
        for (int i = 0; i < WEIGHTS; i++) {
            const float q = d[i] / BATCH + 1e-5F * w[i];
            a[i] = 0.9F * a[i] + 0.1F * q;
            b[i] = 0.999F * b[i] + 0.001F * q * q;
            w[i] -= (float)(rate * (a[i] / c1) / (sqrt(b[i] / c2) + 1e-8));
        }
        if ((t + 1) % steps == 0) {
            printf("epoch %d: loss %.4f of %lld examples\n", (int)((t + 1) / steps),
                   loss / weight, (long long)e->n);
            loss = weight = 0;
        }
    }
    memcpy(net->in, l.in, sizeof l.in);
    memcpy(net->bias, l.bias, sizeof l.bias);
    memcpy(net->out, l.out, sizeof l.out);
    net->out_bias = l.out_bias;
}

/* ---- writing ------------------------------------------------------------------------- */

static void put(FILE *f, const char *name, const float *v, int32_t n)
{
    fprintf(f, "        .%s = {", name);
    for (int32_t i = 0; i < n; i++)
        fprintf(f, "%s%.5eF",
                i % 6 ? ", "
                : i   ? ",\n            "
                      : "\n            ",
                (double)v[i]);
    fprintf(f, "},\n");
}

static void write(const options *o, const tz_things_net *nets)
{
    FILE *f = fopen(o->out, "w");
    if (!f) {
        perror(o->out);
        exit(1);
    }
    fprintf(f,
            "/* SPDX-License-Identifier: Apache-2.0 */\n"
            "/* Made by: train_things --scenes %d --epochs %d --seed %llu */\n"
            "#include \"analysis/things_score.h\"\n\n"
            "/* clang-format off */\nconst tz_things_net tz_things_nets[2] = {\n",
            o->scenes, o->epochs, (unsigned long long)o->seed);
    for (int i = 0; i < 2; i++) {
        fprintf(f, "    {\n");
        put(f, "mean", nets[i].mean, F);
        put(f, "deviation", nets[i].deviation, F);
        fprintf(f, "        .in = {\n");
        for (int k = 0; k < F; k++) {
            fprintf(f, "            {");
            for (int j = 0; j < H; j++)
                fprintf(f, "%s%.5eF",
                        j % 6 ? ", "
                        : j   ? ",\n             "
                              : "",
                        (double)nets[i].in[k][j]);
            fprintf(f, "},\n");
        }
        fprintf(f, "        },\n");
        put(f, "bias", nets[i].bias, H);
        put(f, "out", nets[i].out, H);
        fprintf(f, "        .out_bias = %.5eF,\n    },\n", (double)nets[i].out_bias);
    }
    fprintf(f, "};\n");
    fclose(f);
}

int main(int argc, char **argv)
{
    options o = {.scenes = 24, .epochs = 12, .seed = 3000000};
    static tz_things_net nets[2];
    for (int i = 1; i + 1 < argc; i += 2) {
        if (strcmp(argv[i], "-o") == 0)
            o.out = argv[i + 1];
        else if (strcmp(argv[i], "--scenes") == 0)
            o.scenes = atoi(argv[i + 1]);
        else if (strcmp(argv[i], "--epochs") == 0)
            o.epochs = atoi(argv[i + 1]);
        else if (strcmp(argv[i], "--seed") == 0)
            o.seed = strtoull(argv[i + 1], NULL, 10);
    }
    if (!o.out || o.scenes < 1 || o.epochs < 1) {
        fprintf(stderr,
                "use: train_things [--scenes N] [--epochs N] [--seed N] -o FILE\n");
        return 2;
    }
    tz_ctx *ctx = bench_ctx(0);
    examples e = gather(ctx, &o, NULL);
    train(&o, &e, &nets[0]);
    free(e.v);
    nets[1] = nets[0]; /* for the first gathering of sizes */
    e = gather(ctx, &o, nets);
    train(&o, &e, &nets[1]);
    free(e.v);
    write(&o, nets);
    tz_ctx_free(ctx);
    return 0;
}
