/* SPDX-License-Identifier: Apache-2.0 */
/* Things found in scenes whose things are known:
 *
 *   bench_things [--scenes N] [--side PX] [--seed N] [--photo FILE]
 *
 * One line a kind, camera and method: "things KIND CAMERA METHOD precision recall F iou
 * seconds", means over N scenes (default 6, 512 px, seeds from 1000000 on, which no
 * training has seen); then the means over all kinds. A thing is found where a label pairs
 * with it at an intersection over union of 0.5 or more, greedily, the best pairs first;
 * things of fewer than 30 visible px and those whose border lies for more than a third on
 * the picture's border count on neither side (tests/support/things_truth.h).
 *
 * The rival is OpenCV's watershed on the distance transform of the Otsu-thresholded
 * picture, as its tutorial has it: at the tutorial's share of the largest distance (0.7)
 * and, apart, with that share and the picture's polarity chosen for each scene by its
 * truth, which no user could do.
 *
 * With --photo: "time FILE seconds processor-seconds peak-MiB" of the whole search and the
 * plate, on one thread. */
#include "analysis/things.h"
#include "tests/bench/bench.h"
#include "tests/bench/rivals_cv.h"
#include "tests/support/things_truth.h"

static const tz_scene_kind kinds[] = {TZ_SCENE_STONES, TZ_SCENE_BRICKS, TZ_SCENE_PEBBLES,
                                      TZ_SCENE_LEAVES, TZ_SCENE_SCALES, TZ_SCENE_MOSAIC};
static const char *const methods[] = {"terrazzo", "watershed", "watershed-told"};
enum { KINDS = sizeof kinds / sizeof *kinds, METHODS = 3 };

typedef struct figures {
    double precision, recall, f, iou, seconds;
    int32_t scenes, paired;
} figures;

typedef struct options {
    int32_t scenes, side;
    uint64_t seed;
    const char *photo;
} options;

static double f_of(const truth_counts *c)
{
    return c->found + c->things > 0 ? 2.0 * c->pairs / (c->found + c->things) : 0;
}

static void add(figures *f, const truth_counts *c, double seconds)
{
    f->precision += c->found > 0 ? (double)c->pairs / c->found : 0;
    f->recall += c->things > 0 ? (double)c->pairs / c->things : 0;
    f->f += f_of(c);
    f->iou += c->pairs > 0 ? c->iou / c->pairs : 0;
    f->paired += c->pairs > 0;
    f->seconds += seconds;
    f->scenes++;
}

static void run_own(tz_ctx *ctx, const tz_scene *scene, int32_t *label, figures *f)
{
    tz_things_params p;
    tz_element_set s;
    truth_counts c;
    tz_params_default(&tz_things_param_table, &p);
    const double start = bench_now();
    bench_check(ctx, tz_things_find(ctx, &scene->photo, &p, &s, NULL, label));
    const double seconds = bench_now() - start;
    bench_check(ctx, truth_count(ctx, scene, label, s.element.n, &c));
    add(f, &c, seconds);
    tz_element_set_deinit(&s);
}

static void run_rival(tz_ctx *ctx, const tz_scene *scene, bool told, int32_t *label,
                      figures *f)
{
    static const double shares[] = {0.7, 0.2, 0.3, 0.4, 0.5, 0.6};
    const rival_photo photo = {scene->photo.px, scene->photo.width, scene->photo.height};
    truth_counts best = {0};
    double seconds = 0;
    for (int k = 0; k < (told ? 12 : 1); k++) {
        truth_counts c;
        int32_t labels;
        double one;
        bench_check(ctx, rival_watershed(ctx, &photo, shares[k / 2], k % 2, label,
                                         &labels, &one));
        bench_check(ctx, truth_count(ctx, scene, label, labels, &c));
        if (k == 0 || f_of(&c) > f_of(&best))
            best = c, seconds = one;
    }
    add(f, &best, seconds);
}

static void print(const char *kind, const char *camera, const char *method,
                  const figures *f)
{
    printf("things %s %s %s %.3f %.3f %.3f %.3f %.3f\n", kind, camera, method,
           f->precision / f->scenes, f->recall / f->scenes, f->f / f->scenes,
           f->iou / (f->paired > 0 ? f->paired : 1), f->seconds / f->scenes);
    fflush(stdout);
}

static void join(figures *all, const figures *f)
{
    all->precision += f->precision;
    all->recall += f->recall;
    all->f += f->f;
    all->iou += f->iou;
    all->seconds += f->seconds;
    all->scenes += f->scenes;
    all->paired += f->paired;
}

static void measure_scenes(tz_ctx *ctx, const options *o)
{
    figures all[2][METHODS] = {{{0}}};
    int32_t *label = NULL;
    bench_check(ctx,
                tz_alloc(ctx, &label, (size_t)o->side * (size_t)o->side, sizeof *label));
    for (int32_t k = 0; k < KINDS; k++)
        for (int32_t camera = 0; camera < 2; camera++) {
            figures f[METHODS] = {{0}};
            for (int32_t i = 0; i < o->scenes; i++) {
                tz_scene scene;
                bench_check(ctx, tz_scene_render(ctx, kinds[k], (tz_scene_camera)camera,
                                                 o->side, o->side, o->seed + (uint64_t)i,
                                                 &scene));
                run_own(ctx, &scene, label, &f[0]);
                run_rival(ctx, &scene, false, label, &f[1]);
                run_rival(ctx, &scene, true, label, &f[2]);
                tz_scene_deinit(&scene);
            }
            for (int32_t m = 0; m < METHODS; m++) {
                print(tz_scene_kind_name(kinds[k]), camera ? "clean" : "wild", methods[m],
                      &f[m]);
                join(&all[camera][m], &f[m]);
            }
        }
    for (int32_t camera = 0; camera < 2; camera++)
        for (int32_t m = 0; m < METHODS; m++)
            print("mean", camera ? "clean" : "wild", methods[m], &all[camera][m]);
    tz_free(ctx, label);
}

static void measure_photo(const char *path)
{
    tz_ctx *ctx = bench_ctx(1);
    tz_image photo = bench_photo(ctx, path, 3), plate;
    tz_things_params p;
    tz_element_set s;
    tz_params_default(&tz_things_param_table, &p);
    for (int k = 0; k < 2; k++) { /* the first one reads the model */
        const double start = bench_now(), cpu = bench_cpu();
        bench_check(ctx, tz_things_find(ctx, &photo, &p, &s, &plate, NULL));
        if (k == 1)
            printf("time %s %.3f %.3f %.0f\n", path, bench_now() - start,
                   bench_cpu() - cpu, bench_peak());
        tz_element_set_deinit(&s);
        tz_image_deinit(&plate);
    }
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
}

int main(int argc, char **argv)
{
    options o = {.scenes = 6, .side = 512, .seed = 1000000};
    for (int i = 1; i + 1 < argc; i += 2) {
        if (strcmp(argv[i], "--scenes") == 0)
            o.scenes = atoi(argv[i + 1]);
        else if (strcmp(argv[i], "--side") == 0)
            o.side = atoi(argv[i + 1]);
        else if (strcmp(argv[i], "--seed") == 0)
            o.seed = strtoull(argv[i + 1], NULL, 10);
        else if (strcmp(argv[i], "--photo") == 0)
            o.photo = argv[i + 1];
        else {
            fprintf(stderr, "bench_things: %s is not understood\n", argv[i]);
            return 2;
        }
    }
    if (o.photo) {
        measure_photo(o.photo);
        return 0;
    }
    tz_ctx *ctx = bench_ctx(0);
    measure_scenes(ctx, &o);
    tz_ctx_free(ctx);
    return 0;
}
