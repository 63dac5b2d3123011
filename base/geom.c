/* SPDX-License-Identifier: Apache-2.0 */
#include "base/geom.h"

tz_affine tz_affine_then(tz_affine p, tz_affine q)
{
    return (tz_affine){
        q.a * p.a + q.c * p.b, q.b * p.a + q.d * p.b,       q.a * p.c + q.c * p.d,
        q.b * p.c + q.d * p.d, q.a * p.e + q.c * p.f + q.e, q.b * p.e + q.d * p.f + q.f,
    };
}

bool tz_affine_finite(tz_affine m)
{
    return isfinite(m.a) && isfinite(m.b) && isfinite(m.c) && isfinite(m.d) &&
           isfinite(m.e) && isfinite(m.f);
}

bool tz_affine_invert(tz_affine m, tz_affine *out)
{
    double det = tz_affine_det(m);
    if (!tz_affine_finite(m) || !isfinite(det) || fabs(det) < 1e-12)
        return false;
    double a = m.d / det, b = -m.b / det, c = -m.c / det, d = m.a / det;
    tz_affine inverse = {a, b, c, d, -(a * m.e + c * m.f), -(b * m.e + d * m.f)};
    if (!tz_affine_finite(inverse))
        return false;
    *out = inverse;
    return true;
}

tz_affine tz_affine_place(tz_vec2 from, tz_vec2 to, double angle, double scale,
                          bool mirror)
{
    double c = cos(angle) * scale, s = sin(angle) * scale, x = mirror ? -1.0 : 1.0;
    tz_affine m = {x * c, x * s, -s, c, 0, 0};
    tz_vec2 p = tz_affine_apply(m, from);
    m.e = to.x - p.x;
    m.f = to.y - p.y;
    return m;
}

tz_rect tz_rect_intersect(tz_rect p, tz_rect q)
{
    /* 64 bits: x + w may leave int32 */
    int64_t x0 = p.x > q.x ? p.x : q.x, y0 = p.y > q.y ? p.y : q.y;
    int64_t px = (int64_t)p.x + p.w, qx = (int64_t)q.x + q.w;
    int64_t py = (int64_t)p.y + p.h, qy = (int64_t)q.y + q.h;
    int64_t x1 = px < qx ? px : qx, y1 = py < qy ? py : qy;
    if (x1 <= x0 || y1 <= y0)
        return (tz_rect){(int32_t)x0, (int32_t)y0, 0, 0};
    return (tz_rect){(int32_t)x0, (int32_t)y0, (int32_t)(x1 - x0), (int32_t)(y1 - y0)};
}
