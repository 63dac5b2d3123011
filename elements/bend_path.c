/* SPDX-License-Identifier: Apache-2.0 */
/* Path data and markup of bent symbols. Lines and curves are cut into pieces so short
 * that to warp their control points is as good as to warp them. */
#include <string.h>

#include "base/svg.h"
#include "elements/bend.h"

enum { MOST_PIECES = 64 };

typedef struct text {
    const tz_bend *b;
    tz_vec2 origin;
    double per_unit; /* digits kept: round to 1 / per_unit */
    TZ_ARRAY(char)
    v;
    tz_status status;
} text;

static void put(text *t, const char *s, size_t n)
{
    if (t->status == TZ_OK)
        t->status = tz_array_reserve(t->b->ctx, &t->v, (int64_t)t->v.n + (int64_t)n + 1);
    if (t->status != TZ_OK)
        return;
    memcpy(t->v.v + t->v.n, s, n);
    t->v.n += (int32_t)n;
    t->v.v[t->v.n] = 0;
}

static void put_point(text *t, const char *before, tz_vec2 p)
{
    const tz_vec2 q = tz_vec2_sub(tz_bend_apply(t->b, p), t->origin);
    const double v[2] = {q.x, q.y};
    put(t, before, strlen(before));
    for (int k = 0; k < 2; k++) {
        char s[32];
        const double r = rint(v[k] * t->per_unit) / t->per_unit;
        tz_number_format(r == 0 ? 0 : r, s);
        put(t, k ? " " : "", (size_t)k);
        put(t, s, strlen(s));
    }
}

static tz_vec2 between(tz_vec2 a, tz_vec2 b, double t)
{
    return (tz_vec2){a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

/* Control points of the part t0 .. t1 of a cubic, by polar forms. */
static tz_vec2 polar(const tz_vec2 c[4], double r, double s, double t)
{
    const tz_vec2 a = between(c[0], c[1], r), b = between(c[1], c[2], r),
                  d = between(c[2], c[3], r);
    return between(between(a, b, s), between(b, d, s), t);
}

/* A line is a cubic too: bent, it is curved. */
static void put_cubic(text *t, const tz_vec2 c[4])
{
    double length = 0;
    for (int k = 0; k < 3; k++)
        length += hypot(c[k + 1].x - c[k].x, c[k + 1].y - c[k].y);
    const double want = ceil(8 * length / t->b->radius);
    const int n = want < 1 ? 1 : want < MOST_PIECES ? (int)want : MOST_PIECES;
    for (int k = 0; k < n; k++) {
        const double a = (double)k / n, b = (k + 1.0) / n;
        put_point(t, "C", polar(c, a, a, b));
        put_point(t, " ", polar(c, a, b, b));
        put_point(t, " ", polar(c, b, b, b));
    }
}

static void put_path(text *t, const tz_svg_path *path)
{
    const tz_vec2 *p = path->point.v;
    tz_vec2 at = {0, 0}, start = at;
    for (int32_t i = 0; i < path->verb.n && t->status == TZ_OK; i++) {
        const uint8_t verb = path->verb.v[i];
        if (verb == TZ_PATH_MOVE) {
            start = at = *p++;
            put_point(t, "M", at);
            continue;
        }
        tz_vec2 c[4] = {at, at, start, start}; /* CLOSE: a line back */
        if (verb == TZ_PATH_CUBIC) {
            memcpy(c + 1, p, 3 * sizeof *p);
            p += 3;
        } else {
            c[3] = verb == TZ_PATH_LINE ? *p++ : start;
            c[1] = between(at, c[3], 1.0 / 3), c[2] = between(at, c[3], 2.0 / 3);
        }
        at = c[3];
        if (verb != TZ_PATH_CLOSE || c[0].x != start.x || c[0].y != start.y)
            put_cubic(t, c);
        if (verb == TZ_PATH_CLOSE)
            put(t, "Z", 1);
    }
}

static text begin(const tz_bend *b, tz_vec2 origin)
{
    const double digits = ceil(5 - log10(b->radius * b->scale));
    return (text){.b = b,
                  .origin = origin,
                  .per_unit = pow(10, fmin(fmax(digits, 0), 12)),
                  .status = TZ_OK};
}

static tz_status finish(text *t, char **out)
{
    put(t, "", 0);
    if (t->status == TZ_OK)
        *out = t->v.v;
    else
        tz_array_free(t->b->ctx, &t->v);
    return t->status;
}

static void put_data(text *t, const char *data)
{
    tz_svg_path path = {0};
    const tz_status s = tz_svg_path_parse(t->b->ctx, data, &path);
    if (t->status == TZ_OK)
        t->status = s;
    put_path(t, &path);
    tz_svg_path_deinit(t->b->ctx, &path);
}

tz_status tz_bend_path(const tz_bend *b, const char *data, tz_vec2 origin, char **d)
{
    text t = begin(b, origin);
    put_data(&t, data);
    return finish(&t, d);
}

/* ---- markup ---------------------------------------------------------------------- */

/* Value of an attribute within a tag of `n` characters: begin and length, or NULL. */
static const char *attribute(const char *tag, size_t n, const char *name, size_t *length)
{
    const size_t k = strlen(name);
    for (size_t i = 1; i + k + 2 < n; i++) {
        if (!strchr(" \t\r\n", tag[i - 1]) || strncmp(tag + i, name, k) != 0 ||
            tag[i + k] != '=')
            continue;
        const char quote = tag[i + k + 1];
        const char *v = tag + i + k + 2;
        const char *end = quote == '"' || quote == '\'' ? strchr(v, quote) : NULL;
        if (!end || end > tag + n)
            return NULL;
        *length = (size_t)(end - v);
        return v;
    }
    return NULL;
}

static double number(const char *tag, size_t n, const char *name)
{
    size_t length;
    const char *v = attribute(tag, n, name, &length), *end;
    double out;
    return v && tz_number_parse(v, &end, &out) ? out : 0;
}

/* <path ...> with its data bent, the rest as it is. */
static void bend_path(text *t, const char *tag, size_t n)
{
    size_t length;
    const char *d = attribute(tag, n, "d", &length);
    char *copy = NULL;
    if (!d) {
        put(t, tag, n);
        return;
    }
    put(t, tag, (size_t)(d - tag));
    if (t->status == TZ_OK)
        t->status = tz_alloc(t->b->ctx, &copy, length + 1, 1);
    if (t->status != TZ_OK)
        return;
    memcpy(copy, d, length);
    copy[length] = 0;
    put_data(t, copy);
    tz_free(t->b->ctx, copy);
    put(t, d + length, n - (size_t)(d + length - tag));
}

/* <circle ...> as a path; its own numbers are left out. */
static void bend_circle(text *t, const char *tag, size_t n)
{
    const double k = 0.5522847498307936;
    const double x = number(tag, n, "cx"), y = number(tag, n, "cy"),
                 r = number(tag, n, "r");
    put(t, "<path d=\"", 9);
    put_point(t, "M", (tz_vec2){x + r, y});
    for (int q = 0; q < 4; q++) {
        static const tz_vec2 axis[5] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 0}};
        const tz_vec2 a = axis[q], b = axis[q + 1];
        const tz_vec2 c[4] = {{x + r * a.x, y + r * a.y},
                              {x + r * (a.x + k * b.x), y + r * (a.y + k * b.y)},
                              {x + r * (b.x + k * a.x), y + r * (b.y + k * a.y)},
                              {x + r * b.x, y + r * b.y}};
        put_cubic(t, c);
    }
    put(t, "Z\"", 2);
    for (size_t i = 7; i < n;) { /* what is left of the attributes */
        const char *name = tag + i + strspn(tag + i, " \t\r\n");
        const size_t length = strcspn(name, "=/>");
        if ((size_t)(name - tag) >= n || name[length] != '=') {
            put(t, name, n - (size_t)(name - tag));
            return;
        }
        const char quote = name[length + 1];
        const char *end = strchr(name + length + 2, quote ? quote : '>');
        if (!end || (size_t)(end - tag) >= n)
            return;
        if (!(length == 1 && *name == 'r') && !(length == 2 && name[0] == 'c')) {
            put(t, " ", 1);
            put(t, name, (size_t)(end + 1 - name));
        }
        i = (size_t)(end + 1 - tag);
    }
}

static bool starts(const char *tag, const char *word)
{
    const size_t n = strlen(word);
    return strncmp(tag, word, n) == 0 && tag[n] && strchr(" \t\r\n/>", tag[n]);
}

/* One tag; false if it cannot be bent. */
static bool bend_tag(text *t, const char *tag, size_t n)
{
    size_t length;
    if (attribute(tag, n, "transform", &length) ||
        attribute(tag, n, "xlink:href", &length))
        return false;
    if (starts(tag, "<path"))
        bend_path(t, tag, n);
    else if (starts(tag, "<circle"))
        bend_circle(t, tag, n);
    else if (starts(tag, "<g") || starts(tag, "</g") || starts(tag, "</path") ||
             starts(tag, "<title") || starts(tag, "</title"))
        put(t, tag, n);
    else
        return false;
    return true;
}

tz_status tz_bend_markup(const tz_bend *b, const char *markup, tz_vec2 origin, char **out)
{
    text t = begin(b, origin);
    bool good = true;
    for (const char *p = markup; *p && good && t.status == TZ_OK;) {
        const char *tag = strchr(p, '<'), *end = tag ? strchr(tag, '>') : NULL;
        if (!end) {
            put(&t, p, strlen(p));
            break;
        }
        put(&t, p, (size_t)(tag - p));
        good = bend_tag(&t, tag, (size_t)(end + 1 - tag));
        p = end + 1;
    }
    if (good)
        return finish(&t, out);
    tz_array_free(b->ctx, &t.v);
    return t.status != TZ_OK ? t.status : TZ_UNSUPPORTED;
}
