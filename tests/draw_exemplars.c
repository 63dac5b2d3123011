/* SPDX-License-Identifier: Apache-2.0 */
/* Draws data/exemplars/: exemplars for places where no photos can be had. They are scenes
 * (scenes/scene.h), so what lies in them is known.
 *
 *   draw_exemplars [--size PX] [--truth] FOLDER [KIND SEED]...
 *
 * Without kinds and seeds those of the table below are drawn, which were chosen by eye;
 * else FOLDER/KIND-SEED.png, to choose from. --truth also writes NAME-truth.png, 16 bit
 * grey: the number of the piece that each pixel belongs to. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/image_io.h"
#include "scenes/scene.h"

static const struct {
    const char *name;
    tz_scene_kind kind;
    uint64_t seed;
} exemplar[] = {
    {"stones", TZ_SCENE_STONES, 95}, {"bricks", TZ_SCENE_BRICKS, 9},
    {"mud", TZ_SCENE_CRACKS, 31},    {"pebbles", TZ_SCENE_PEBBLES, 10},
    {"leaves", TZ_SCENE_LEAVES, 16}, {"bark", TZ_SCENE_BARK, 30},
};
enum { EXEMPLARS = sizeof exemplar / sizeof *exemplar };

typedef struct options {
    int32_t size;
    bool truth;
    const char *folder;
} options;

static tz_status write_truth(tz_ctx *ctx, const char *path, const tz_scene *scene)
{
    const tz_image_write_options opt = {.type = TZ_SAMPLE_U16, .compression = 9};
    const int32_t w = scene->photo.width, h = scene->photo.height;
    tz_image im;
    tz_status s = tz_image_init(ctx, &im, w, h, 1);
    if (s != TZ_OK)
        return s;
    im.encoding = TZ_ENCODING_DATA;
    im.depth = 16;
    for (int32_t p = 0; p < w * h; p++)
        im.px[p] = (float)scene->segment[p] / 65535;
    s = tz_image_write(ctx, path, &im, &opt);
    tz_image_deinit(&im);
    return s;
}

static tz_status draw(tz_ctx *ctx, const options *o, const char *name, tz_scene_kind kind,
                      uint64_t seed)
{
    const tz_image_write_options opt = {.compression = 9};
    char path[4096];
    tz_scene scene;
    tz_status s =
        tz_scene_render(ctx, kind, TZ_SCENE_CLEAN, o->size, o->size, seed, &scene);
    if (s != TZ_OK)
        return s;
    snprintf(path, sizeof path, "%s/%s.png", o->folder, name);
    s = tz_image_write(ctx, path, &scene.photo, &opt);
    snprintf(path, sizeof path, "%s/%s-truth.png", o->folder, name);
    if (s == TZ_OK && o->truth)
        s = write_truth(ctx, path, &scene);
    tz_scene_deinit(&scene);
    return s;
}

static tz_status draw_chosen(tz_ctx *ctx, const options *o, const char *kind,
                             const char *seed)
{
    char name[128];
    int32_t k = 0;
    while (k < TZ_SCENE_COUNT && strcmp(kind, tz_scene_kind_name((tz_scene_kind)k)) != 0)
        k++;
    if (k == TZ_SCENE_COUNT)
        return tz_fail(ctx, TZ_INVALID, "%s: not a kind of scene", kind);
    snprintf(name, sizeof name, "%.60s-%.60s", kind, seed);
    return draw(ctx, o, name, (tz_scene_kind)k, strtoull(seed, NULL, 10));
}

int main(int argc, char **argv)
{
    options o = {.size = 256};
    tz_ctx *ctx = NULL;
    int i = 1;
    for (; i < argc && argv[i][0] == '-'; i++)
        if (strcmp(argv[i], "--truth") == 0)
            o.truth = true;
        else if (strcmp(argv[i], "--size") == 0 && i + 1 < argc)
            o.size = atoi(argv[++i]);
        else
            i = argc;
    if (i >= argc || (argc - i) % 2 == 0) {
        fprintf(stderr, "use: draw_exemplars [--size PX] [--truth] FOLDER "
                        "[KIND SEED]...\n");
        return 2;
    }
    o.folder = argv[i++];
    tz_status s = tz_ctx_new(NULL, &ctx);
    for (int k = i; k < argc && s == TZ_OK; k += 2)
        s = draw_chosen(ctx, &o, argv[k], argv[k + 1]);
    for (int k = 0; k < EXEMPLARS && i == argc && s == TZ_OK; k++)
        s = draw(ctx, &o, exemplar[k].name, exemplar[k].kind, exemplar[k].seed);
    if (s != TZ_OK)
        fprintf(stderr, "draw_exemplars: %s\n", ctx ? tz_ctx_message(ctx) : "no memory");
    tz_ctx_free(ctx);
    return s == TZ_OK ? 0 : 1;
}
