/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Any bytes as strokes and as a mix. The first byte says how long the mix is, the rest is a
 * drawing. What is read fills a small domain, on a torus or not; the layout holds together,
 * and no failure is without a message or leaves anything behind. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "elements/element_io.h"
#include "fields/mix.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char things[] =
    "<svg xmlns='http://www.w3.org/2000/svg' "
    "xmlns:tz='https://terrazzo.example/ns/1' viewBox='0 0 120 40'>"
    "<path tz:class='leaf' d='M10,20 C15,15 24,15 30,20 C24,25 15,25 10,20Z'/>"
    "<circle tz:class='bead' cx='60' cy='20' r='4'/>"
    "<path tz:class='bar' d='M80,18 L112,18 L112,22 L80,22Z'/></svg>";

static const char *path_of(void)
{
    static char path[64];
    if (!path[0]) {
        const char *dir = access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm";
        snprintf(path, sizeof path, "%s/tz-fuzz-fill-%ld.svg", dir, (long)getpid());
    }
    return path;
}

/* No failure without a message. */
static bool good(tz_ctx *ctx, tz_status s)
{
    if (s != TZ_OK && !*tz_ctx_message(ctx))
        abort();
    tz_ctx_clear(ctx);
    return s == TZ_OK;
}

static void fill(tz_ctx *ctx, const tz_element_set *palette,
                 const tz_element_field *field, const tz_mix *mix, tz_domain d)
{
    tz_element_set layout = {0};
    const tz_fill_params p = {.alpha = 1,
                              .beta = 1,
                              .iterations = 2,
                              .fill = 0.5,
                              .rigidity = 100,
                              .start = TZ_FILL_INSERT,
                              .discs = 4,
                              .repair = true};
    const tz_fill_job job = {.palette = palette,
                             .entry = mix->v,
                             .entries = mix->n,
                             .domain = d,
                             .field = field,
                             .params = &p,
                             .seed = 1,
                             .count = 12};
    if (good(ctx, tz_element_set_like(ctx, palette, &d, &layout)) &&
        good(ctx, tz_fill_run(ctx, &job, &layout, NULL))) {
        if (tz_element_set_check(ctx, &layout, "layout") != TZ_OK)
            abort();
        for (int32_t i = 0; i < layout.element.n; i++)
            if (!isfinite(layout.element.v[i].at.x) || !(layout.element.v[i].scale > 0))
                abort();
    }
    tz_element_set_deinit(&layout);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const tz_ctx_options o = {.threads = 1, .memory = (size_t)256 << 20};
    tz_ctx *ctx = NULL;
    tz_element_set palette = {0};
    tz_element_field field = {0};
    tz_mix mix = {0};
    char text[256] = {0};
    if (size < 1 || tz_ctx_new(&o, &ctx))
        return 0;
    const size_t n = data[0] < size - 1 ? data[0] : size - 1;
    memcpy(text, data + 1, n);
    FILE *f = fopen(path_of(), "wb");
    if (!f || fwrite(data + 1 + n, 1, size - 1 - n, f) != size - 1 - n || fclose(f))
        abort();
    const tz_domain d = {.size = {90, 70, 0}, .torus = size % 2};
    if (tz_element_parse_svg(ctx, "things", things, strlen(things), NULL, &palette))
        abort();
    const bool mixed = good(ctx, tz_mix_parse(ctx, text, &palette, 100, &mix));
    if (!mixed && mix.v)
        abort();
    if (good(ctx, tz_element_field_init(ctx, d.size, d.torus, 32, &field))) {
        good(ctx, tz_element_field_read_strokes(&field, path_of()));
        if (good(ctx, tz_element_field_settle(&field)) && mixed)
            fill(ctx, &palette, &field, &mix, d);
    }
    tz_element_field_deinit(&field);
    tz_array_free(ctx, &mix);
    tz_element_set_deinit(&palette);
    if (tz_ctx_memory_used(ctx))
        abort();
    tz_ctx_free(ctx);
    unlink(path_of());
    return 0;
}
