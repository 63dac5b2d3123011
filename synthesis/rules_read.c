/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rule files: JSON through Jansson. One table row a key; a key that is in no table is an
 * error which suggests the nearest one that is. Every message names the file and the
 * key's path ("rules[2].rotation"), syntax errors the line.
 *
 * A rotation field is an image, or a formula which is drawn into a small one here:
 *   angle(x, y) = angle + around * polar angle about centre + twist * distance from
 * centre
 *                 + slope[0] * x + slope[1] * y,     x, y in units of the layout */
#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/image_io.h"
#include "synthesis/rules.h"

#define MAX_BYTES   (16u << 20)
#define MAX_RULES   1024
#define MAX_MASKS   64
#define MAX_POLYGON 10000
#define MAX_GROUPS  1000000
#define FIELD_SIDE  256

typedef struct reader {
    tz_ctx *ctx;
    const char *file;
    tz_rules r;
    char *path[MAX_MASKS]; /* of r.mask[i]; NULL = drawn from a formula */
    char where[160];       /* path of the key being read */
} reader;

typedef tz_status (*read_value)(reader *p, const json_t *v, void *out);

typedef struct key {
    const char *name;
    read_value read; /* NULL = a remark, not looked at */
    size_t offset;   /* into what `out` points at */
} key;

/* ---- messages -------------------------------------------------------------------- */

static tz_status bad(const reader *p, const char *fmt, ...) TZ_PRINTF(2, 3);
static tz_status bad(const reader *p, const char *fmt, ...)
{
    char text[400];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return tz_fail(p->ctx, TZ_INVALID, "%s: %s %s", p->file, p->where, text);
}

/** Levenshtein distance of short words; long ones are far from everything. */
static int distance(const char *a, const char *b)
{
    size_t m = strlen(a), n = strlen(b);
    int row[32];
    if (m > 31 || n > 31)
        return 99;
    for (size_t j = 0; j <= n; j++)
        row[j] = (int)j;
    for (size_t i = 1; i <= m; i++) {
        int corner = row[0];
        row[0] = (int)i;
        for (size_t j = 1; j <= n; j++) {
            int best = corner + (a[i - 1] != b[j - 1]);
            if (row[j] + 1 < best)
                best = row[j] + 1;
            if (row[j - 1] + 1 < best)
                best = row[j - 1] + 1;
            corner = row[j];
            row[j] = best;
        }
    }
    return row[n];
}

/** `did you mean "x"?`, or all that is known. */
static void suggest(const char *word, const char *const *known, size_t n, char *text,
                    size_t room)
{
    size_t best = 0;
    for (size_t i = 1; i < n; i++)
        if (distance(word, known[i]) < distance(word, known[best]))
            best = i;
    if (distance(word, known[best]) <= 1 + (int)strlen(known[best]) / 3) {
        snprintf(text, room, "did you mean \"%s\"?", known[best]);
        return;
    }
    size_t used = (size_t)snprintf(text, room, "known are");
    for (size_t i = 0; i < n && used < room; i++)
        used +=
            (size_t)snprintf(text + used, room - used, "%s %s", i ? "," : "", known[i]);
}

/* ---- values ---------------------------------------------------------------------- */

static tz_status number(const reader *p, const json_t *v, double lo, double hi,
                        double *out)
{
    if (!json_is_number(v))
        return bad(p, "must be a number from %g to %g", lo, hi);
    double x = json_number_value(v);
    if (!(x >= lo && x <= hi))
        return bad(p, "is %g: it must be from %g to %g", x, lo, hi);
    *out = x;
    return TZ_OK;
}

/** Fixed number of numbers. */
static tz_status numbers(const reader *p, const json_t *v, size_t n, double lo, double hi,
                         double *out)
{
    tz_status st = TZ_OK;
    if (!json_is_array(v) || json_array_size(v) != n)
        return bad(p, "must be a list of %zu numbers", n);
    for (size_t i = 0; i < n && !st; i++)
        st = number(p, json_array_get(v, i), lo, hi, &out[i]);
    return st;
}

static tz_status range(const reader *p, const json_t *v, double lo, double hi,
                       double out[2])
{
    double pair[2] = {0};
    tz_status st = numbers(p, v, 2, lo, hi, pair);
    if (st)
        return st;
    if (pair[0] > pair[1])
        return bad(p, "runs from %g down to %g: put the smaller first", pair[0], pair[1]);
    memcpy(out, pair, sizeof pair);
    return TZ_OK;
}

static tz_status read_name(reader *p, const json_t *v, void *out)
{
    const char *s = json_string_value(v);
    if (!s || strlen(s) > 63)
        return bad(p, "must be a text of up to 63 bytes");
    memcpy(out, s, strlen(s) + 1);
    return TZ_OK;
}

static tz_status read_structure(reader *p, const json_t *v, void *out)
{
    static const char *const names[] = {"exemplar", "random", "granular"};
    const char *s = json_string_value(v);
    char hint[120];
    if (!s)
        return bad(p, "must be \"exemplar\", \"random\" or \"granular\"");
    for (int32_t i = 0; i < 3; i++)
        if (!strcmp(s, names[i])) {
            *(int32_t *)out = i;
            return TZ_OK;
        }
    suggest(s, names, 3, hint, sizeof hint);
    return bad(p, "is \"%.40s\"; %s", s, hint);
}

static tz_status read_size(reader *p, const json_t *v, void *out)
{
    double pair[2] = {0, INFINITY};
    if (json_is_array(v) && json_array_size(v) == 2 &&
        json_is_null(json_array_get(v, 1))) {
        tz_status st = number(p, json_array_get(v, 0), 0, 1e6, &pair[0]);
        if (st)
            return st;
        memcpy(out, pair, sizeof pair);
        return TZ_OK;
    }
    return range(p, v, 0, 1e6, out);
}

static tz_status read_rotation(reader *p, const json_t *v, void *out)
{
    double pair[2] = {0};
    tz_status st = range(p, v, -3600, 3600, pair);
    for (int i = 0; i < 2 && !st; i++)
        ((double *)out)[i] = pair[i] * TZ_PI / 180;
    return st;
}

static tz_status read_angle(reader *p, const json_t *v, void *out)
{
    double a = 0;
    tz_status st = number(p, v, -3600, 3600, &a);
    if (!st)
        ((double *)out)[0] = ((double *)out)[1] = a * TZ_PI / 180;
    return st;
}

static tz_status read_scale(reader *p, const json_t *v, void *out)
{
    double *s = out;
    if (!json_is_number(v))
        return range(p, v, 0.05, 20, s);
    tz_status st = number(p, v, 0.05, 20, s);
    s[1] = s[0];
    return st;
}

static tz_status read_density(reader *p, const json_t *v, void *out)
{
    return number(p, v, 0.1, 10, out);
}

static tz_status read_feather(reader *p, const json_t *v, void *out)
{
    return number(p, v, 0, 1e6, out);
}

static tz_status read_bins(reader *p, const json_t *v, void *out)
{
    uint32_t set = 0;
    if (!json_is_array(v) || !json_array_size(v))
        return bad(p, "must be a list of bin numbers such as [0, 2]");
    for (size_t i = 0; i < json_array_size(v); i++) {
        const json_t *b = json_array_get(v, i);
        json_int_t k = json_integer_value(b);
        if (!json_is_integer(b) || k < 0 || k > 31)
            return bad(p, "must hold whole numbers from 0 to 31");
        set |= 1u << k;
    }
    *(uint32_t *)out = set;
    return TZ_OK;
}

static tz_status read_groups(reader *p, const json_t *v, void *out)
{
    tz_rule *rule = out;
    size_t n = json_array_size(v);
    if (!json_is_array(v) || n > MAX_GROUPS)
        return bad(p, "must be a list of up to %d group numbers", MAX_GROUPS);
    tz_status st = tz_array_reserve(p->ctx, &rule->groups, (int64_t)n);
    for (size_t i = 0; i < n && !st; i++) {
        const json_t *g = json_array_get(v, i);
        json_int_t k = json_integer_value(g);
        if (!json_is_integer(g) || k < 0 || k > INT32_MAX)
            return bad(p, "must hold group numbers, 0 or more");
        rule->groups.v[rule->groups.n++] = (int32_t)k;
    }
    return st;
}

static tz_status read_source(reader *p, const json_t *v, void *out)
{
    json_int_t k = json_integer_value(v);
    if (json_is_string(v) && !strcmp(json_string_value(v), "all"))
        k = -1;
    else if (!json_is_integer(v) || k < 0 || k > 4095)
        return bad(p, "must be the number of an exemplar (0 = first) or \"all\"");
    *(int32_t *)out = (int32_t)k;
    return TZ_OK;
}

/* ---- where ----------------------------------------------------------------------- */

static tz_status add_point(reader *p, tz_rule *rule, double x, double y)
{
    tz_vec2 v = {x, y};
    return tz_array_push(p->ctx, &rule->shape, v);
}

static tz_status read_rect(reader *p, const json_t *v, void *out)
{
    double q[4] = {0};
    tz_status st = numbers(p, v, 4, -10, 10, q);
    if (st)
        return st;
    if (q[2] <= 0 || q[3] <= 0)
        return bad(p, "has no area: it is [x, y, width, height] in units of the layout");
    for (int i = 0; i < 4 && !st; i++) {
        bool right = i == 1 || i == 2, below = i >= 2;
        st = add_point(p, out, q[0] + right * q[2], q[1] + below * q[3]);
    }
    return st;
}

static tz_status read_circle(reader *p, const json_t *v, void *out)
{
    double q[3] = {0};
    tz_status st = numbers(p, v, 3, -10, 10, q);
    if (st)
        return st;
    if (q[2] <= 0)
        return bad(p, "has no area: it is [x, y, radius] in units of the layout");
    for (int i = 0; i < 96 && !st; i++) {
        double a = 2 * TZ_PI * i / 96;
        st = add_point(p, out, q[0] + q[2] * cos(a), q[1] + q[2] * sin(a));
    }
    return st;
}

static tz_status read_polygon(reader *p, const json_t *v, void *out)
{
    size_t n = json_array_size(v);
    tz_status st = TZ_OK;
    if (!json_is_array(v) || n < 3 || n > MAX_POLYGON)
        return bad(p, "must be a list of 3 to %d points [x, y]", MAX_POLYGON);
    for (size_t i = 0; i < n && !st; i++) {
        double q[2] = {0};
        st = numbers(p, json_array_get(v, i), 2, -10, 10, q);
        if (!st)
            st = add_point(p, out, q[0], q[1]);
    }
    return st;
}

/** Moves an image into the rules. */
static tz_status keep_image(reader *p, tz_image *im, char *path, int32_t *id)
{
    if (p->r.mask.n >= MAX_MASKS)
        return bad(p, "is one image too many: a rule file uses up to %d", MAX_MASKS);
    tz_status st = tz_array_push(p->ctx, &p->r.mask, *im);
    if (st)
        return st;
    p->path[p->r.mask.n - 1] = path;
    *id = p->r.mask.n - 1;
    return TZ_OK;
}

/** Image file, relative to the rule file; one that was read before is shared. */
static tz_status read_image(reader *p, const json_t *v, void *out)
{
    const char *s = json_string_value(v), *slash = strrchr(p->file, '/');
    tz_image_read_options data = {.data = true, .max_pixels = 1 << 28};
    tz_image im = {0};
    char *path = NULL;
    if (!s || !*s)
        return bad(p, "must be the path of an image");
    if (!strcmp(s, "-"))
        return bad(p, "must be a file, not standard input");
    size_t folder = *s != '/' && slash ? (size_t)(slash - p->file) + 1 : 0;
    tz_status st = tz_alloc(p->ctx, &path, folder + strlen(s) + 1, 1);
    if (st)
        return st;
    memcpy(path, p->file, folder);
    memcpy(path + folder, s, strlen(s) + 1);
    for (int32_t i = 0; i < p->r.mask.n; i++)
        if (p->path[i] && !strcmp(p->path[i], path)) {
            *(int32_t *)out = i;
            goto done;
        }
    st = tz_image_read(p->ctx, path, &data, &im);
    if (!st)
        st = keep_image(p, &im, path, out);
    if (!st)
        return TZ_OK;
    tz_image_deinit(&im);
done:
    tz_free(p->ctx, path);
    return st;
}

/* ---- tables ---------------------------------------------------------------------- */

/** Reads an object's members by a table. */
static tz_status read_object(reader *p, const json_t *object, const key *table, size_t n,
                             void *out)
{
    size_t base = strlen(p->where);
    const char *name;
    json_t *v;
    if (!json_is_object(object))
        return bad(p, "must be an object { ... }");
    json_object_foreach((json_t *)object, name, v)
    {
        size_t i = 0;
        snprintf(p->where + base, sizeof p->where - base, "%s%.60s", base ? "." : "",
                 name);
        while (i < n && strcmp(name, table[i].name) != 0)
            i++;
        if (i == n) {
            const char *known[32];
            char hint[300];
            for (i = 0; i < n; i++)
                known[i] = table[i].name;
            suggest(name, known, n, hint, sizeof hint);
            return bad(p, "is no key of a rule file; %s", hint);
        }
        tz_status st =
            table[i].read ? table[i].read(p, v, (char *)out + table[i].offset) : TZ_OK;
        if (st)
            return st;
        p->where[base] = 0;
    }
    return TZ_OK;
}

typedef struct formula {
    double angle, centre[2], around, twist, slope[2];
} formula;

static tz_status read_centre(reader *p, const json_t *v, void *out)
{
    return numbers(p, v, 2, -10, 10, out);
}
static tz_status read_degrees(reader *p, const json_t *v, void *out)
{
    return number(p, v, -36000, 36000, out);
}
static tz_status read_around(reader *p, const json_t *v, void *out)
{
    double k = 0;
    tz_status st = number(p, v, -16, 16, &k);
    if (!st && k != floor(k))
        return bad(p, "must be a whole number, or the field tears");
    if (!st)
        *(double *)out = k;
    return st;
}
static tz_status read_slope(reader *p, const json_t *v, void *out)
{
    return numbers(p, v, 2, -36000, 36000, out);
}

static const key formula_keys[] = {
    {"angle", read_degrees, offsetof(formula, angle)},
    {"centre", read_centre, offsetof(formula, centre)},
    {"around", read_around, offsetof(formula, around)},
    {"twist", read_degrees, offsetof(formula, twist)},
    {"slope", read_slope, offsetof(formula, slope)},
};

static tz_status read_field(reader *p, const json_t *v, void *out)
{
    formula f = {.centre = {0.5, 0.5}};
    tz_image im = {0};
    if (json_is_string(v))
        return read_image(p, v, out);
    if (!json_is_object(v))
        return bad(p, "must be the path of an image or a formula { \"around\": 1, ... }");
    tz_status st =
        read_object(p, v, formula_keys, sizeof formula_keys / sizeof *formula_keys, &f);
    if (!st)
        st = tz_image_init(p->ctx, &im, FIELD_SIDE, FIELD_SIDE, 3);
    if (st)
        return st;
    im.encoding = TZ_ENCODING_DATA;
    for (int32_t j = 0; j < FIELD_SIDE; j++)
        for (int32_t i = 0; i < FIELD_SIDE; i++) {
            double x = (i + 0.5) / FIELD_SIDE, y = (j + 0.5) / FIELD_SIDE;
            double dx = x - f.centre[0], dy = y - f.centre[1];
            double a = (f.angle + f.twist * sqrt(dx * dx + dy * dy) + f.slope[0] * x +
                        f.slope[1] * y) *
                           TZ_PI / 180 +
                       f.around * atan2(dy, dx);
            float *px = tz_image_at(&im, i, j);
            px[0] = (float)(0.5 + 0.5 * cos(a));
            px[1] = (float)(0.5 + 0.5 * sin(a));
            px[2] = 0.5f;
        }
    st = keep_image(p, &im, NULL, out);
    if (st)
        tz_image_deinit(&im);
    return st;
}

#define IN_RULE(member) offsetof(tz_rule, member)
static const key rule_keys[] = {
    {"name", read_name, IN_RULE(name)},
    {"description", NULL, 0},
    {"rect", read_rect, 0},
    {"circle", read_circle, 0},
    {"polygon", read_polygon, 0},
    {"mask", read_image, IN_RULE(mask)},
    {"feather", read_feather, IN_RULE(feather)},
    {"structure", read_structure, IN_RULE(structure)},
    {"size", read_size, IN_RULE(size)},
    {"rotation", read_rotation, IN_RULE(rotation)},
    {"angle", read_angle, IN_RULE(rotation)},
    {"field", read_field, IN_RULE(field)},
    {"scale", read_scale, IN_RULE(scale)},
    {"density", read_density, IN_RULE(density)},
    {"length_bins", read_bins, IN_RULE(length_bins)},
    {"angle_bins", read_bins, IN_RULE(angle_bins)},
    {"groups", read_groups, 0},
    {"source", read_source, IN_RULE(source)},
};

/** At most one of two keys. */
static tz_status exclude(reader *p, const json_t *o, const char *a, const char *b)
{
    if (!json_object_get(o, a) || !json_object_get(o, b))
        return TZ_OK;
    return bad(p, "has both \"%s\" and \"%s\": keep one", a, b);
}

static tz_status read_rule(reader *p, const json_t *o, int32_t number_in_file)
{
    tz_rule rule = tz_rule_default();
    snprintf(p->where, sizeof p->where, "rules[%d]", number_in_file);
    snprintf(rule.name, sizeof rule.name, "rule %d", number_in_file);
    tz_status st =
        read_object(p, o, rule_keys, sizeof rule_keys / sizeof *rule_keys, &rule);
    if (!st)
        st = exclude(p, o, "rect", "circle");
    if (!st)
        st = exclude(p, o, "rect", "polygon");
    if (!st)
        st = exclude(p, o, "circle", "polygon");
    if (!st)
        st = exclude(p, o, "rotation", "angle");
    /* rule 0 holds everywhere */
    if (!st && !p->r.rule.n && (rule.shape.n || rule.mask >= 0)) {
        tz_rule everywhere = tz_rule_default();
        st = tz_array_push(p->ctx, &p->r.rule, everywhere);
    }
    if (!st)
        st = tz_array_push(p->ctx, &p->r.rule, rule);
    if (st) {
        tz_array_free(p->ctx, &rule.shape);
        tz_array_free(p->ctx, &rule.groups);
    }
    return st;
}

static tz_status read_rules(reader *p, const json_t *list, void *out)
{
    (void)out;
    size_t n = json_array_size(list);
    tz_status st = TZ_OK;
    if (!json_is_array(list))
        return bad(p, "must be a list of rules [ { ... } ]");
    if (n > MAX_RULES)
        return tz_fail(p->ctx, TZ_LIMIT, "%s: %zu rules: %d are the most", p->file, n,
                       MAX_RULES);
    for (size_t i = 0; i < n && !st; i++)
        st = read_rule(p, json_array_get(list, i), (int32_t)i);
    return st;
}

static const key file_keys[] = {
    {"$schema", NULL, 0},
    {"name", NULL, 0},
    {"description", NULL, 0},
    {"rules", read_rules, 0},
};

tz_status tz_rules_parse(tz_ctx *ctx, const char *name, const char *text, size_t size,
                         tz_rules *r)
{
    reader p = {.ctx = ctx, .file = name, .r = {.ctx = ctx}};
    json_error_t e;
    if (size > MAX_BYTES)
        return tz_fail(ctx, TZ_LIMIT, "%s: rule file over %u MiB", name, MAX_BYTES >> 20);
    json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, &e);
    if (!root) {
        bool memory = json_error_code(&e) == json_error_out_of_memory;
        return tz_fail(ctx, memory ? TZ_NOMEM : TZ_FORMAT, "%s:%d:%d: %s", name, e.line,
                       e.column, e.text);
    }
    tz_status st = TZ_OK;
    if (!json_is_object(root) || !json_object_get(root, "rules"))
        st = tz_fail(ctx, TZ_INVALID,
                     "%s: no rules: the file must be { \"rules\": [ { ... } ] }", name);
    if (!st)
        st = read_object(&p, root, file_keys, sizeof file_keys / sizeof *file_keys, &p);
    if (!st && !p.r.rule.n) {
        tz_rule everywhere = tz_rule_default();
        st = tz_array_push(ctx, &p.r.rule, everywhere);
    }
    for (int32_t i = 0; i < p.r.mask.n; i++)
        tz_free(ctx, p.path[i]);
    json_decref(root);
    if (st)
        tz_rules_deinit(&p.r);
    else
        *r = p.r;
    return st;
}

tz_status tz_rules_read(tz_ctx *ctx, const char *path, tz_rules *r)
{
    char *text = NULL;
    size_t size = 0;
    tz_status st = tz_file_read(ctx, path, MAX_BYTES, &text, &size);
    if (!st)
        st = tz_rules_parse(ctx, path, text, size, r);
    tz_free(ctx, text);
    return st;
}
