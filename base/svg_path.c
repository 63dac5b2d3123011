/* SPDX-License-Identifier: Apache-2.0 */
/* Path data of SVG 1.1 (Sec. 8.3) as absolute moves, lines and cubics. */
#include <string.h>

#include "base/svg.h"
#include "base/svg_internal.h"

typedef struct parser {
    tz_ctx *ctx;
    const char *text, *p;
    tz_svg_path *path;
    tz_vec2 at, start;
    tz_vec2 handle; /* last control point, for S and T */
    char before;    /* 'C' or 'Q' where `handle` counts */
    tz_status status;
} parser;

static void put(parser *s, tz_path_verb verb, int n, const tz_vec2 *point)
{
    for (int i = 0; i < n; i++) {
        if (!isfinite(point[i].x) || !isfinite(point[i].y)) {
            s->status =
                tz_fail(s->ctx, TZ_FORMAT, "path: number too large at character %d",
                        (int)(s->p - s->text));
            return;
        }
    }
    if (s->status == TZ_OK)
        s->status = tz_array_push(s->ctx, &s->path->verb, (uint8_t)verb);
    for (int i = 0; i < n && s->status == TZ_OK; i++)
        s->status = tz_array_push(s->ctx, &s->path->point, point[i]);
    if (n > 0)
        s->at = point[n - 1];
}

static void line_to(parser *s, tz_vec2 p) { put(s, TZ_PATH_LINE, 1, &p); }

static void cubic_to(parser *s, tz_vec2 c1, tz_vec2 c2, tz_vec2 p)
{
    tz_vec2 all[3] = {c1, c2, p};
    put(s, TZ_PATH_CUBIC, 3, all);
}

/* A quadratic is the cubic with handles two thirds of the way to its control point. */
static void quadratic_to(parser *s, tz_vec2 c, tz_vec2 p)
{
    tz_vec2 a = s->at;
    tz_vec2 c1 = {a.x + (c.x - a.x) * 2 / 3, a.y + (c.y - a.y) * 2 / 3};
    tz_vec2 c2 = {p.x + (c.x - p.x) * 2 / 3, p.y + (c.y - p.y) * 2 / 3};
    cubic_to(s, c1, c2, p);
    s->handle = c;
}

/* Elliptical arc, end points to centre (SVG 1.1, F.6.5), then a cubic a quarter turn. */
static void arc_to(parser *s, const double *v, tz_vec2 p)
{
    double rx = fabs(v[0]), ry = fabs(v[1]), phi = v[2] * TZ_PI / 180;
    tz_vec2 a = s->at;
    if (a.x == p.x && a.y == p.y)
        return;
    if (rx == 0 || ry == 0) {
        line_to(s, p);
        return;
    }
    double c = cos(phi), n = sin(phi);
    double dx = (a.x - p.x) / 2, dy = (a.y - p.y) / 2;
    double x1 = c * dx + n * dy, y1 = -n * dx + c * dy;
    double lambda = (x1 / rx) * (x1 / rx) + (y1 / ry) * (y1 / ry);
    if (lambda > 1) { /* too small to reach: grown until it does */
        rx *= sqrt(lambda);
        ry *= sqrt(lambda);
    }
    double u = x1 / rx, w = y1 / ry, uw = u * u + w * w;
    double k = uw > 0 ? sqrt(fmax(0, 1 / uw - 1)) : 0;
    if ((v[3] != 0) == (v[4] != 0))
        k = -k;
    double cx1 = k * rx * w, cy1 = -k * ry * u;
    tz_vec2 centre = {c * cx1 - n * cy1 + (a.x + p.x) / 2,
                      n * cx1 + c * cy1 + (a.y + p.y) / 2};
    double t0 = atan2((y1 - cy1) / ry, (x1 - cx1) / rx);
    double t1 = atan2((-y1 - cy1) / ry, (-x1 - cx1) / rx);
    double turn = t1 - t0;
    if (v[4] != 0 && turn < 0)
        turn += 2 * TZ_PI;
    if (v[4] == 0 && turn > 0)
        turn -= 2 * TZ_PI;
    if (!isfinite(turn)) {
        line_to(s,
                p); /* radii beyond what numbers hold: straight as far as we can tell */
        return;
    }
    int pieces = (int)ceil(fabs(turn) / (TZ_PI / 2) - 1e-9);
    pieces = pieces < 1 ? 1 : pieces;
    double step = turn / pieces, h = 4.0 / 3 * tan(step / 4);
    for (int i = 0; i < pieces && s->status == TZ_OK; i++) {
        double p0 = t0 + step * i, p1 = p0 + step;
        /* unit circle, stretched, turned, moved */
        double q[6] = {cos(p0) - h * sin(p0),
                       sin(p0) + h * cos(p0),
                       cos(p1) + h * sin(p1),
                       sin(p1) - h * cos(p1),
                       cos(p1),
                       sin(p1)};
        tz_vec2 out[3];
        for (int j = 0; j < 3; j++) {
            double ex = rx * q[2 * j], ey = ry * q[2 * j + 1];
            out[j] = (tz_vec2){centre.x + c * ex - n * ey, centre.y + n * ex + c * ey};
        }
        if (i == pieces - 1)
            out[2] = p; /* exactly where it was asked to end */
        cubic_to(s, out[0], out[1], out[2]);
    }
}

static bool number(parser *s, double *out)
{
    const char *p = tz_svg_skip_comma(s->p);
    if (!tz_number_parse(p, &p, out))
        return false;
    s->p = p;
    return true;
}

/* Arc flags may stand without blanks: "a1 1 0 01.5.5". */
static bool flag(parser *s, double *out)
{
    const char *p = tz_svg_skip_comma(s->p);
    if (*p != '0' && *p != '1')
        return false;
    *out = *p - '0';
    s->p = p + 1;
    return true;
}

static int arguments(char command)
{
    switch (command & ~0x20) {
    case 'H':
    case 'V': return 1;
    case 'M':
    case 'L':
    case 'T': return 2;
    case 'S':
    case 'Q': return 4;
    case 'C': return 6;
    case 'A': return 7;
    case 'Z': return 0;
    default: return -1;
    }
}

/* One command with its numbers. */
static void execute(parser *s, char command, const double *v)
{
    bool relative = command >= 'a';
    tz_vec2 o = relative ? s->at : (tz_vec2){0, 0}, a = s->at, handle = s->handle;
    char before = s->before;
    tz_vec2 q[3] = {
        {o.x + v[0], o.y + v[1]}, {o.x + v[2], o.y + v[3]}, {o.x + v[4], o.y + v[5]}};
    tz_vec2 mirrored = {2 * a.x - handle.x, 2 * a.y - handle.y};
    s->before = 0;
    switch (command & ~0x20) {
    case 'M':
        put(s, TZ_PATH_MOVE, 1, q);
        s->start = s->at;
        break;
    case 'L': line_to(s, q[0]); break;
    case 'H': line_to(s, (tz_vec2){q[0].x, a.y}); break;
    case 'V': line_to(s, (tz_vec2){a.x, o.y + v[0]}); break;
    case 'C':
        cubic_to(s, q[0], q[1], q[2]);
        s->handle = q[1];
        s->before = 'C';
        break;
    case 'S':
        cubic_to(s, before == 'C' ? mirrored : a, q[0], q[1]);
        s->handle = q[0];
        s->before = 'C';
        break;
    case 'Q':
        quadratic_to(s, q[0], q[1]);
        s->before = 'Q';
        break;
    case 'T':
        quadratic_to(s, before == 'Q' ? mirrored : a, q[0]);
        s->before = 'Q';
        break;
    case 'A': arc_to(s, v, (tz_vec2){o.x + v[5], o.y + v[6]}); break;
    default: put(s, TZ_PATH_CLOSE, 0, NULL); s->at = s->start;
    }
}

tz_status tz_svg_path_parse(tz_ctx *ctx, const char *d, tz_svg_path *out)
{
    tz_svg_path path = {0};
    parser s = {.ctx = ctx, .text = d, .path = &path, .p = tz_svg_skip_blank(d)};
    bool begun = false;
    while (*s.p && s.status == TZ_OK) {
        char command = *s.p;
        int n = arguments(command);
        if (n < 0 || (!begun && (command & ~0x20) != 'M'))
            goto bad;
        begun = true;
        s.p++;
        bool again = false;
        do {
            double v[7] = {0};
            for (int i = 0; i < n; i++) {
                bool is_flag = n == 7 && (i == 3 || i == 4);
                if (is_flag ? !flag(&s, &v[i]) : !number(&s, &v[i])) {
                    if (again && i == 0)
                        goto next; /* no further set of numbers */
                    goto bad;
                }
            }
            execute(&s, command, v);
            if ((command & ~0x20) == 'M') /* further pairs are lines */
                command = command == 'M' ? 'L' : 'l';
            again = true;
        } while (n > 0 && s.status == TZ_OK);
    next:
        s.p = tz_svg_skip_blank(s.p);
    }
    if (s.status == TZ_OK)
        *out = path;
    else
        tz_svg_path_deinit(ctx, &path);
    return s.status;
bad:
    tz_svg_path_deinit(ctx, &path);
    return tz_fail(ctx, TZ_FORMAT, "path data is wrong at character %d, '%.12s'",
                   (int)(s.p - d), s.p);
}

void tz_svg_path_deinit(tz_ctx *ctx, tz_svg_path *p)
{
    tz_array_free(ctx, &p->verb);
    tz_array_free(ctx, &p->point);
}
