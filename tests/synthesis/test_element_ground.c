/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Grounds of element layouts: arranged, put into the set, and read back from its file. */
#include "tests/base/check.h"

#include "base/image_io.h"
#include "elements/element_io.h"
#include "synthesis/element_ground.h"
#include "tests/support/elements.h"
#include "tests/support/pictures.h"

static void grounds_survive_documents(void **state)
{
    (void)state;
    char folder[] = "/tmp/terrazzo-ground-XXXXXX", plate[64], document[64];
    assert_non_null(mkdtemp(folder));
    snprintf(plate, sizeof plate, "%s/plate.png", folder);
    snprintf(document, sizeof document, "%s/layout.svg", folder);
    for (int torus = 0; torus < 2; torus++) {
        tz_ctx *ctx = new_ctx(2);
        tz_image im = {0};
        tz_element_set s, t;
        tz_layout a = {0}, b = {0};
        tz_ebpt_params p;
        tz_params_default(&tz_ebpt_param_table, &p);
        p.edges = TZ_EDGES_GRADIENT;
        ok(ctx, tz_image_init(ctx, &im, 160, 128, 3));
        im.encoding = TZ_ENCODING_SRGB;
        for (int32_t y = 0; y < im.height; y++)
            for (int32_t x = 0; x < im.width; x++)
                for (int32_t c = 0; c < 3; c++)
                    tz_image_at(&im, x, y)[c] =
                        0.3F + 0.4F * (float)(((x / 13) ^ (y / 11)) & 1) +
                        0.002F * (float)((x * 7 + y * 3 + c) % 50);
        ok(ctx, tz_image_write(ctx, plate, &im, NULL));
        ok(ctx, drawn_hexagons(ctx, 5, 5, 0, false, &s));
        s.domain = (tz_domain){.size = {320, 256, 0}, .torus = torus == 1};
        assert_false(tz_element_ground_is(&s));
        ok(ctx, tz_element_ground_read(ctx, document, &s, &b));
        assert_int_equal(b.place.n, 0);
        ok(ctx, tz_element_ground_arrange(ctx, &im, plate, "", &p, &s.domain, 3, &a));
        assert_int_equal(a.width, 320);
        assert_int_equal(a.height, 256);
        assert_int_equal(a.tile, torus);
        assert_true(a.place.n > 4);
        ok(ctx, tz_element_ground_embed(ctx, document, &a, &s));
        assert_true(tz_element_ground_is(&s));
        ok(ctx, tz_element_write_svg(ctx, document, &s));
        ok(ctx, tz_element_read_svg(ctx, document, NULL, &t));
        assert_int_equal(t.element.n, s.element.n);
        assert_true(tz_element_ground_is(&t));
        ok(ctx, tz_element_ground_read(ctx, document, &t, &b));
        assert_int_equal(b.place.n, a.place.n);
        for (int32_t i = 0; i < a.place.n; i++) {
            assert_memory_equal(&a.place.v[i].map, &b.place.v[i].map, sizeof(tz_affine));
            assert_int_equal(a.place.v[i].points, b.place.v[i].points);
        }
        assert_int_equal(b.source.n, 1);
        assert_int_equal(access(b.source.v[0].path, R_OK), 0);
        tz_layout_deinit(&a);
        tz_layout_deinit(&b);
        tz_element_set_deinit(&s);
        tz_element_set_deinit(&t);
        tz_image_deinit(&im);
        end_ctx(ctx);
    }
    unlink(plate);
    unlink(document);
    rmdir(folder);
}

static void too_large_a_domain_is_refused(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_image im = {0};
    tz_layout l = {0};
    tz_ebpt_params p;
    const tz_domain d = {.size = {1e9, 10, 0}};
    tz_params_default(&tz_ebpt_param_table, &p);
    ok(ctx, tz_image_init(ctx, &im, 32, 32, 3));
    im.encoding = TZ_ENCODING_SRGB;
    fails(ctx, tz_element_ground_arrange(ctx, &im, "plate.png", "", &p, &d, 1, &l),
          TZ_INVALID, "plate.png");
    assert_null(l.place.v);
    tz_image_deinit(&im);
    end_ctx(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grounds_survive_documents),
        cmocka_unit_test(too_large_a_domain_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
