/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A texture far larger than memory, computed and thrown away: what the same texture takes
 * on disk is then disk time.
 *
 *   bench_huge PHOTO [SIDE]
 *
 * prints a line: huge SIDE PLACEMENTS ANALYZE ARRANGE RENDER PEAK_MIB, times in s */
#include "synthesis/arrange.h"
#include "synthesis/compose.h"
#include "tests/bench/bench.h"

int main(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "use: bench_huge PHOTO [SIDE]\n");
        return 2;
    }
    const int32_t side = argc > 2 ? atoi(argv[2]) : 32768, rows = 512;
    tz_ctx *ctx = bench_ctx(0);
    tz_image photo = bench_photo(ctx, argv[1], 0), strip;
    tz_ebpt_params ep;
    tz_arrange_params ap;
    tz_ebpt e = {0};
    tz_layout l = {0};
    tz_composer *c = NULL;
    memset(&ep, 0, sizeof ep);
    memset(&ap, 0, sizeof ap);
    tz_params_default(&tz_ebpt_param_table, &ep);
    tz_params_default(&tz_arrange_param_table, &ap);
    ap.size[0] = ap.size[1] = side;
    const double start = bench_now();
    bench_check(ctx, tz_ebpt_analyze(ctx, &photo, &ep, &e));
    const double analyzed = bench_now();
    const tz_exemplar ex = {&photo, &e, argv[1], ""};
    bench_check(ctx, tz_arrange(ctx, &ex, 1, NULL, &ap, &l));
    const double arranged = bench_now();
    bench_check(ctx, tz_composer_new(ctx, &l, &photo, 1, TZ_MAP_COLOUR, NULL, &c));
    bench_check(ctx, tz_image_init(ctx, &strip, side, rows, photo.channels));
    for (int32_t y = 0; y < side; y += rows) {
        const tz_rect r = {0, y, side, side - y < rows ? side - y : rows};
        tz_image part = tz_image_view(&strip, (tz_rect){0, 0, r.w, r.h});
        bench_check(ctx, tz_composer_render(ctx, c, r, &part));
    }
    const double rendered = bench_now();
    printf("huge %d %d %.2f %.2f %.2f %.0f\n", (int)side, (int)l.place.n,
           analyzed - start, arranged - analyzed, rendered - arranged, bench_peak());
    tz_image_deinit(&strip);
    tz_composer_free(c);
    tz_layout_deinit(&l);
    tz_ebpt_deinit(&e);
    tz_image_deinit(&photo);
    tz_ctx_free(ctx);
    return 0;
}
