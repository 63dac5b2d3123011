/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Drawn exemplars analyzed and arranged, and what tests ask of an arrangement. */
#ifndef TZ_TESTS_SUPPORT_ARRANGED_H
#define TZ_TESTS_SUPPORT_ARRANGED_H

#include "synthesis/arrange.h"
#include "tests/support/pictures.h"
#include "tests/support/scenes.h"

/** Photo, its EBPT, and both as tz_arrange wants them. The exemplar points into the
 * struct: it must not move. */
typedef struct arranged_source {
    tz_image photo;
    tz_ebpt ebpt;
    tz_exemplar exemplar;
} arranged_source;

void source_init(tz_ctx *ctx, arranged_source *s, picture_kind kind, int32_t width,
                 int32_t height, uint64_t seed);
/** Takes the photo over. */
void source_from(tz_ctx *ctx, arranged_source *s, tz_image photo, const char *name);
void source_deinit(arranged_source *s);

/** Defaults with a size, a seed, torus or not. */
tz_arrange_params arrange_params(int32_t width, int32_t height, uint64_t seed, bool tile);
/** Arranges one source; whatever fails ends the test. */
void arrange_one(tz_ctx *ctx, const arranged_source *s, const tz_rules *rules,
                 const tz_arrange_params *p, tz_layout *l);

/** Number that tells layouts apart: every bit of maps, borders, groups, sources. */
uint64_t layout_hash(const tz_layout *l);
/** Pixels in no border, and the largest distance in px from one of them to a pixel that
 * is in a border, up to 20. */
int64_t bare_pixels(const tz_layout *l, double *farthest);
/** Rotation (-pi, pi], scale, and whether mirrored, of a placement's map. */
void map_parts(tz_affine m, double *angle, double *scale, bool *mirror);
/** Middle of a placement: where its source region's centre lies in the layout. */
tz_vec2 middle_of(const tz_layout *l, int32_t id);
/** Maps finite and nearly similar (no shear), borders simple in count and within the
 * photo by `slack` px, sources and groups in range. */
void assert_sound(const tz_layout *l, const tz_exemplar *ex, int32_t n, double slack);

#endif
