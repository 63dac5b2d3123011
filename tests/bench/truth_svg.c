/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/bench/truth_svg.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/svg.h"

/* Pieces that a Bezier is cut into; boundaries are short ones. */
#define PIECES 24

/* Straight line from pixel to pixel (Bresenham), clipped by leaving out. */
static void draw_line(truth_drawing *t, tz_vec2 from, tz_vec2 to)
{
    int32_t x = (int32_t)floor(from.x), y = (int32_t)floor(from.y);
    const int32_t x1 = (int32_t)floor(to.x), y1 = (int32_t)floor(to.y);
    const int32_t dx = x1 > x ? x1 - x : x - x1, dy = y1 > y ? y1 - y : y - y1;
    const int32_t sx = x1 > x ? 1 : -1, sy = y1 > y ? 1 : -1;
    int32_t error = dx - dy;
    for (;;) {
        if (x >= 0 && y >= 0 && x < t->crop.w && y < t->crop.h)
            t->mask[(size_t)y * t->crop.w + x] = 1;
        if (x == x1 && y == y1)
            return;
        const int32_t twice = 2 * error;
        if (twice > -dy)
            error -= dy, x += sx;
        if (twice < dx)
            error += dx, y += sy;
    }
}

static tz_vec2 bezier(tz_vec2 a, const tz_vec2 p[3], double t)
{
    const double u = 1 - t, k0 = u * u * u, k1 = 3 * u * u * t, k2 = 3 * u * t * t,
                 k3 = t * t * t;
    return (tz_vec2){k0 * a.x + k1 * p[0].x + k2 * p[1].x + k3 * p[2].x,
                     k0 * a.y + k1 * p[0].y + k2 * p[1].y + k3 * p[2].y};
}

static tz_status draw_path(tz_ctx *ctx, const char *d, truth_drawing *t)
{
    tz_svg_path path = {0};
    tz_vec2 at = {0, 0}, start = {0, 0};
    const tz_status s = tz_svg_path_parse(ctx, d, &path);
    const tz_vec2 *p = path.point.v;
    for (int32_t i = 0; i < path.verb.n && s == TZ_OK; i++) {
        switch ((tz_path_verb)path.verb.v[i]) {
        case TZ_PATH_MOVE: at = start = *p++; break;
        case TZ_PATH_LINE:
            draw_line(t, at, *p);
            at = *p++;
            break;
        case TZ_PATH_CUBIC: {
            tz_vec2 last = at;
            for (int32_t k = 1; k <= PIECES; k++) {
                const tz_vec2 next = bezier(at, p, (double)k / PIECES);
                draw_line(t, last, next);
                last = next;
            }
            at = p[2];
            p += 3;
            break;
        }
        case TZ_PATH_CLOSE:
            draw_line(t, at, start);
            at = start;
            break;
        }
    }
    tz_svg_path_deinit(ctx, &path);
    return s;
}

static tz_status draw_children(tz_ctx *ctx, tz_svg_node parent, truth_drawing *t)
{
    tz_status s = TZ_OK;
    for (tz_svg_node n = tz_svg_child(parent); n && s == TZ_OK; n = tz_svg_next(n)) {
        const char *d = tz_svg_is(n, "path") ? tz_svg_attr(n, "d") : NULL;
        if (d) {
            t->paths++;
            s = draw_path(ctx, d, t);
        } else if (tz_svg_is(n, "g")) {
            s = draw_children(ctx, n, t);
        }
    }
    return s;
}

static tz_status read_head(tz_ctx *ctx, const char *path, tz_svg_node root,
                           truth_drawing *t)
{
    const char *document = tz_svg_attr(root, "tz:document");
    const char *photo = tz_svg_attr(root, "tz:photo"),
               *sha = tz_svg_attr(root, "tz:sha256");
    const char *crop = tz_svg_attr(root, "tz:crop");
    tz_rect *c = &t->crop;
    if (!document || strcmp(document, "boundaries") != 0 || !photo || !sha || !crop ||
        strlen(photo) >= sizeof t->photo || strlen(sha) != 64 ||
        sscanf(crop, "%d %d %d %d", &c->x, &c->y, &c->w, &c->h) != 4 || c->w < 1 ||
        c->h < 1 || c->w > 4096 || c->h > 4096)
        return tz_fail(ctx, TZ_FORMAT,
                       "%s: not a drawing of boundaries; tz:document, tz:photo, "
                       "tz:sha256 and tz:crop are wanted",
                       path);
    strcpy(t->photo, photo);
    strcpy(t->sha256, sha);
    return TZ_OK;
}

tz_status truth_read(tz_ctx *ctx, const char *path, truth_drawing *t)
{
    tz_svg_doc *doc = NULL;
    tz_status s;
    *t = (truth_drawing){.ctx = ctx};
    if ((s = tz_svg_read(ctx, path, &doc)) != TZ_OK)
        goto done;
    if ((s = read_head(ctx, path, tz_svg_root(doc), t)) != TZ_OK)
        goto done;
    if ((s = tz_alloc_zero(ctx, &t->mask, (size_t)t->crop.w * t->crop.h, 1)) != TZ_OK)
        goto done;
    s = draw_children(ctx, tz_svg_root(doc), t);
done:
    tz_svg_free(doc);
    if (s != TZ_OK)
        truth_deinit(t);
    return s;
}

void truth_deinit(truth_drawing *t)
{
    tz_free(t->ctx, t->mask);
    *t = (truth_drawing){0};
}
