/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Edge detectors against the truth: scenes that are drawn (their boundaries are known)
 * and parts of photos whose boundaries were drawn by hand.
 *
 *   bench_edges [--scenes N] [--seed S] [--model FILE] [--truth DIR --photos DIR]
 *               [--pictures DIR] [--all]
 *
 * One line a set and detector: edges SET PICTURES DETECTOR VARIANT ODS OIS AP SECONDS,
 * the seconds a picture of one plain run. Of the variants of a detector the best one in
 * this set is shown; or all of them with --all, and behind the seconds the threshold of
 * ODS. --pictures writes what each found. */
#include <dirent.h>

#include "analysis/boundary_score.h"
#include "base/file.h"
#include "scenes/scene.h"
#include "tests/bench/bench.h"
#include "tests/bench/edge_detectors.h"
#include "tests/bench/truth_svg.h"

#define SIDE          320
#define TOLERANCE     0.0075
#define MOST_PICTURES 4096
#define MOST          32 /* detectors */
#define COLUMNS       3

typedef struct options {
    int32_t scenes;
    uint64_t seed;
    const char *model, *truth, *photos, *pictures;
    bool all;
} options;

/* What was measured on one picture. */
typedef struct result {
    char set[64];
    bool drawn; /* a scene */
    tz_boundary_counts counts[MOST];
    double seconds[MOST];
} result;

typedef struct bench {
    tz_ctx *ctx;
    options o;
    result *result;
    int32_t n;
} bench;

/* ---- pictures side by side --------------------------------------------------------- */

static void put_panel(tz_image *sheet, int32_t k, int32_t w, int32_t h,
                      const tz_image *photo, const uint8_t *truth, const float *strength)
{
    const int32_t x0 = k % COLUMNS * (w + 4), y0 = k / COLUMNS * (h + 4);
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++)
            for (int32_t c = 0; c < 3; c++) {
                const size_t p = (size_t)y * w + x;
                tz_image_at(sheet, x0 + x, y0 + y)[c] =
                    photo      ? tz_image_at(photo, x, y)[c]
                    : truth    ? (float)(1 - truth[p])
                    : strength ? 1 - sqrtf(strength[p])
                               : 1;
            }
}

static tz_image new_sheet(bench *b, const tz_image *photo, const uint8_t *truth)
{
    int32_t panels = 2;
    tz_image sheet;
    for (int32_t d = 0; d < edge_detectors_n; d++)
        panels +=
            edge_detectors[d].shown && (b->o.model || !edge_detectors[d].wants_model);
    const int32_t rows = (panels + COLUMNS - 1) / COLUMNS;
    bench_check(b->ctx, tz_image_init(b->ctx, &sheet, COLUMNS * (photo->width + 4),
                                      rows * (photo->height + 4), 3));
    sheet.encoding = TZ_ENCODING_SRGB;
    put_panel(&sheet, 0, photo->width, photo->height, photo, NULL, NULL);
    put_panel(&sheet, 1, photo->width, photo->height, NULL, truth, NULL);
    return sheet;
}

static void write_sheet(bench *b, tz_image *sheet, const char *set)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%03d-%s.png", b->o.pictures, b->n, set);
    bench_check(b->ctx, tz_image_write(b->ctx, path, sheet, NULL));
    tz_image_deinit(sheet);
}

/* ---- measuring --------------------------------------------------------------------- */

static void measure(bench *b, const char *set, bool drawn, const tz_image *photo,
                    const uint8_t *truth)
{
    const int32_t w = photo->width, h = photo->height;
    float *strength = NULL;
    int32_t panel = 2;
    tz_image dense, sheet = {0};
    if (b->n == MOST_PICTURES)
        return;
    result *r = &b->result[b->n];
    snprintf(r->set, sizeof r->set, "%s", set);
    r->drawn = drawn;
    bench_check(b->ctx, tz_image_copy(b->ctx, photo, &dense));
    bench_check(b->ctx, tz_alloc(b->ctx, &strength, (size_t)w * h, sizeof *strength));
    if (b->o.pictures)
        sheet = new_sheet(b, photo, truth);
    const edge_input in = {
        .photo = photo, .dense = {dense.px, w, h}, .model = b->o.model};
    for (int32_t d = 0; d < edge_detectors_n; d++) {
        const edge_detector *e = &edge_detectors[d];
        if (e->wants_model && !b->o.model)
            continue;
        bench_check(b->ctx, e->detect(b->ctx, &in, e->setting, strength, &r->seconds[d]));
        bench_check(b->ctx, tz_boundary_match(b->ctx, strength, truth, w, h, TOLERANCE,
                                              &r->counts[d]));
        if (b->o.pictures && e->shown)
            put_panel(&sheet, panel++, w, h, NULL, NULL, strength);
    }
    if (b->o.pictures)
        write_sheet(b, &sheet, set);
    b->n++;
    tz_free(b->ctx, strength);
    tz_image_deinit(&dense);
}

static void measure_scenes(bench *b)
{
    for (int32_t i = 0; i < b->o.scenes; i++) {
        const tz_scene_kind kind = (tz_scene_kind)(i % TZ_SCENE_COUNT);
        tz_scene scene;
        bench_check(b->ctx, tz_scene_render(b->ctx, kind, TZ_SCENE_WILD, SIDE, SIDE,
                                            b->o.seed + (uint64_t)i, &scene));
        measure(b, tz_scene_kind_name(kind), true, &scene.photo, scene.boundary);
        tz_scene_deinit(&scene);
    }
}

static void measure_drawing(bench *b, const char *name)
{
    char path[1024], sha256[65], set[64];
    truth_drawing t;
    snprintf(path, sizeof path, "%s/%s", b->o.truth, name);
    bench_check(b->ctx, truth_read(b->ctx, path, &t));
    snprintf(path, sizeof path, "%s/%s", b->o.photos, t.photo);
    if (tz_file_sha256(b->ctx, path, sha256) != TZ_OK || strcmp(sha256, t.sha256) != 0) {
        fprintf(stderr,
                "bench_edges: %s is not the photo that %s was drawn on: left out\n", path,
                name);
        tz_ctx_clear(b->ctx);
        truth_deinit(&t);
        return;
    }
    tz_image photo = bench_photo(b->ctx, path, 3);
    if (t.crop.x < 0 || t.crop.y < 0 || t.crop.x + t.crop.w > photo.width ||
        t.crop.y + t.crop.h > photo.height) {
        fprintf(stderr, "bench_edges: %s: the crop is not inside the photo\n", name);
        exit(1);
    }
    const tz_image part = tz_image_view(&photo, t.crop);
    snprintf(set, sizeof set, "%.*s", (int)strcspn(name, "."), name);
    measure(b, set, false, &part, t.mask);
    tz_image_deinit(&photo);
    truth_deinit(&t);
}

static int is_svg(const struct dirent *e)
{
    const size_t n = strlen(e->d_name);
    return n > 4 && strcmp(e->d_name + n - 4, ".svg") == 0;
}

static void measure_photos(bench *b)
{
    struct dirent **list = NULL;
    const int n = scandir(b->o.truth, &list, is_svg, alphasort);
    for (int i = 0; i < n; i++) {
        measure_drawing(b, list[i]->d_name);
        free(list[i]);
    }
    free(list);
}

/* ---- figures ----------------------------------------------------------------------- */

typedef struct figures {
    tz_boundary_score score;
    double seconds;
    int32_t pictures;
} figures;

/* Over the pictures of a set: "scenes", "photos", or those of that name. */
static figures figures_of(const bench *b, const char *set, int32_t detector)
{
    tz_boundary_counts *c = calloc((size_t)b->n + 1, sizeof *c);
    figures f = {0};
    for (int32_t i = 0; i < b->n; i++) {
        const result *r = &b->result[i];
        const bool in = strcmp(set, "scenes") == 0   ? r->drawn
                        : strcmp(set, "photos") == 0 ? !r->drawn
                                                     : strcmp(set, r->set) == 0;
        if (!in)
            continue;
        c[f.pictures++] = r->counts[detector];
        f.seconds += r->seconds[detector];
    }
    f.score = tz_boundary_score_of(c, f.pictures);
    f.seconds /= f.pictures > 0 ? f.pictures : 1;
    free(c);
    return f;
}

static void print_line(const bench *b, const char *set, const edge_detector *e,
                       const figures *f)
{
    printf("edges %s %d %s %s %.4f %.4f %.4f %.5f", set, f->pictures, e->family,
           e->variant, f->score.ods, f->score.ois, f->score.ap, f->seconds);
    if (b->o.all)
        printf(" %.3f", f->score.ods_threshold);
    printf("\n");
}

static void print_set(const bench *b, const char *set)
{
    for (int32_t d = 0, next; d < edge_detectors_n; d = next) {
        const char *family = edge_detectors[d].family;
        figures best = {0};
        int32_t which = -1;
        for (next = d;
             next < edge_detectors_n && strcmp(edge_detectors[next].family, family) == 0;
             next++) {
            if (edge_detectors[next].wants_model && !b->o.model)
                continue;
            const figures f = figures_of(b, set, next);
            if (b->o.all)
                print_line(b, set, &edge_detectors[next], &f);
            if (which < 0 || f.score.ods > best.score.ods)
                best = f, which = next;
        }
        if (which >= 0 && best.pictures > 0 && !b->o.all)
            print_line(b, set, &edge_detectors[which], &best);
    }
}

static void print_sets(const bench *b)
{
    for (int32_t i = 0; i < b->n; i++) {
        bool first = true;
        for (int32_t k = 0; k < i; k++)
            first &= strcmp(b->result[k].set, b->result[i].set) != 0;
        if (first)
            print_set(b, b->result[i].set);
    }
    if (b->o.scenes > 0)
        print_set(b, "scenes");
    if (b->n > b->o.scenes)
        print_set(b, "photos");
}

static void read_options(int argc, char **argv, options *o)
{
    for (int i = 1; i < argc; i++) {
        const char *name = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(name, "--all") == 0) {
            o->all = true;
            continue;
        }
        if (value && strcmp(name, "--scenes") == 0)
            o->scenes = atoi(value);
        else if (value && strcmp(name, "--seed") == 0)
            o->seed = strtoull(value, NULL, 10);
        else if (value && strcmp(name, "--model") == 0)
            o->model = value;
        else if (value && strcmp(name, "--truth") == 0)
            o->truth = value;
        else if (value && strcmp(name, "--photos") == 0)
            o->photos = value;
        else if (value && strcmp(name, "--pictures") == 0)
            o->pictures = value;
        else {
            fprintf(stderr, "bench_edges: %s is not understood\n", name);
            exit(2);
        }
        i++;
    }
}

int main(int argc, char **argv)
{
    bench b = {.ctx = bench_ctx(0), .o = {.scenes = 0, .seed = 1000000}};
    read_options(argc, argv, &b.o);
    b.result = calloc(MOST_PICTURES, sizeof *b.result);
    if (!b.result || edge_detectors_n > MOST)
        return 1;
    if (b.o.scenes > 0)
        measure_scenes(&b);
    if (b.o.truth && b.o.photos)
        measure_photos(&b);
    print_sets(&b);
    free(b.result);
    tz_ctx_free(b.ctx);
    return 0;
}
