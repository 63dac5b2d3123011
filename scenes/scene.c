/* SPDX-License-Identifier: Apache-2.0 */
/* Driver: canvas, generator, light, camera, truth. */
#include "scenes/scene.h"

#include "scenes/stage.h"

static const struct {
    const char *name;
    tz_scene_generator draw;
} kinds[TZ_SCENE_COUNT] = {
#define TZ_SCENE_ROW(id, name) {name, tz_scene_##id},
    TZ_SCENE_KINDS(TZ_SCENE_ROW)
#undef TZ_SCENE_ROW
};

const char *tz_scene_kind_name(tz_scene_kind kind) { return kinds[kind].name; }

static tz_status canvas_init(tz_canvas *c)
{
    const size_t n = (size_t)c->width * (size_t)c->height;
    tz_status s = tz_alloc_zero(c->ctx, &c->segment, n, sizeof *c->segment);
    if (s == TZ_OK)
        s = tz_alloc_zero(c->ctx, &c->relief, n, sizeof *c->relief);
    if (s == TZ_OK)
        s = tz_alloc_zero(c->ctx, &c->albedo, 3 * n, sizeof *c->albedo);
    if (s == TZ_OK)
        s = tz_alloc_zero(c->ctx, &c->line, n, 1);
    return s;
}

static void canvas_deinit(tz_canvas *c)
{
    tz_free(c->ctx, c->segment);
    tz_free(c->ctx, c->relief);
    tz_free(c->ctx, c->albedo);
    tz_free(c->ctx, c->line);
    tz_array_free(c->ctx, &c->piece);
}

static tz_status go_on(const tz_canvas *c)
{
    return tz_ctx_cancelled(c->ctx) ? TZ_CANCELLED : TZ_OK;
}

tz_status tz_scene_render(tz_ctx *ctx, tz_scene_kind kind, tz_scene_camera camera,
                          int32_t width, int32_t height, uint64_t seed, tz_scene *scene)
{
    *scene = (tz_scene){.kind = kind, .ctx = ctx};
    if (kind < 0 || kind >= TZ_SCENE_COUNT)
        return tz_fail(ctx, TZ_INVALID, "no such kind of scene: %d", (int)kind);
    if (width < 16 || height < 16 || width > 4096 || height > 4096)
        return tz_fail(ctx, TZ_INVALID, "scene of %d x %d px: sides are 16 to 4096 px",
                       (int)width, (int)height);
    tz_canvas c = {.width = 2 * width, .height = 2 * height, .ctx = ctx};
    c.seed = tz_rng_stream(seed, (uint64_t)kind, 0x5CE);
    c.rng = tz_rng_make(c.seed, 0);
    tz_status s = canvas_init(&c);
    if (s == TZ_OK)
        s = kinds[kind].draw(&c);
    if (s == TZ_OK)
        s = go_on(&c);
    if (s == TZ_OK)
        s = tz_scene_truth(&c, scene);
    if (s == TZ_OK)
        s = tz_scene_light(&c, camera);
    if (s == TZ_OK)
        s = go_on(&c);
    if (s == TZ_OK)
        s = tz_scene_shoot(&c, camera, scene);
    canvas_deinit(&c);
    if (s != TZ_OK)
        tz_scene_deinit(scene);
    return s;
}

void tz_scene_deinit(tz_scene *scene)
{
    tz_image_deinit(&scene->photo);
    tz_free(scene->ctx, scene->segment);
    tz_free(scene->ctx, scene->boundary);
    tz_free(scene->ctx, scene->piece);
    *scene = (tz_scene){0};
}
