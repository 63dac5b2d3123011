/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Vectors, rectangles and affine maps. Pixel coordinates: x right, y down, pixel (i, j)
 * covers [i, i+1) x [j, j+1), its centre is (i + 0.5, j + 0.5). Angles in radians, from
 * +x towards +y. */
#ifndef TZ_BASE_GEOM_H
#define TZ_BASE_GEOM_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/export.h"

#define TZ_PI 3.14159265358979323846

typedef struct tz_vec2 {
    double x, y;
} tz_vec2;

typedef struct tz_vec3 {
    double x, y, z;
} tz_vec3;

/** Half-open rectangle of pixels. */
typedef struct tz_rect {
    int32_t x, y, w, h;
} tz_rect;

/** x' = a x + c y + e,  y' = b x + d y + f  (order of SVG's matrix(a b c d e f)). */
typedef struct tz_affine {
    double a, b, c, d, e, f;
} tz_affine;

static inline tz_vec2 tz_vec2_add(tz_vec2 p, tz_vec2 q)
{
    return (tz_vec2){p.x + q.x, p.y + q.y};
}
static inline tz_vec2 tz_vec2_sub(tz_vec2 p, tz_vec2 q)
{
    return (tz_vec2){p.x - q.x, p.y - q.y};
}
static inline tz_vec2 tz_vec2_scale(tz_vec2 p, double s)
{
    return (tz_vec2){p.x * s, p.y * s};
}
static inline double tz_vec2_dot(tz_vec2 p, tz_vec2 q) { return p.x * q.x + p.y * q.y; }
static inline double tz_vec2_length(tz_vec2 p) { return sqrt(p.x * p.x + p.y * p.y); }

static inline tz_affine tz_affine_identity(void) { return (tz_affine){1, 0, 0, 1, 0, 0}; }
static inline tz_vec2 tz_affine_apply(tz_affine m, tz_vec2 p)
{
    return (tz_vec2){m.a * p.x + m.c * p.y + m.e, m.b * p.x + m.d * p.y + m.f};
}
static inline double tz_affine_det(tz_affine m) { return m.a * m.d - m.b * m.c; }

/** q after p: apply(then(p, q), x) = apply(q, apply(p, x)). */
TZ_API tz_affine tz_affine_then(tz_affine p, tz_affine q);
/** Inverse; false and untouched output if |det| < 1e-12 or a member is not finite. */
TZ_API bool tz_affine_invert(tz_affine m, tz_affine *out);
/** Mirror x (if mirror), scale, turn by angle about the origin, then move `from` to `to`.
 */
TZ_API tz_affine tz_affine_place(tz_vec2 from, tz_vec2 to, double angle, double scale,
                                 bool mirror);
TZ_API bool tz_affine_finite(tz_affine m);

/** Intersection, w = h = 0 if empty. */
TZ_API tz_rect tz_rect_intersect(tz_rect p, tz_rect q);
static inline bool tz_rect_empty(tz_rect r) { return r.w <= 0 || r.h <= 0; }

#endif
