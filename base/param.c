/* SPDX-License-Identifier: Apache-2.0 */
/* Parameter values: text to struct and back. How tables are printed: base/param_print.c.
 */
#include "base/param.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/geom.h"
#include "base/number.h"

/* Largest value of any type, for parsing before it is stored. */
typedef union value {
    bool b;
    int32_t i[4];
    uint64_t u;
    double d[2];
    char s[TZ_PARAM_STRING_SIZE];
} value;

static size_t value_size(tz_param_type t)
{
    switch (t) {
    case TZ_PARAM_BOOL: return sizeof(bool);
    case TZ_PARAM_INT:
    case TZ_PARAM_ENUM: return sizeof(int32_t);
    case TZ_PARAM_UINT64:
    case TZ_PARAM_BYTES: return sizeof(uint64_t);
    case TZ_PARAM_DOUBLE: return sizeof(double);
    case TZ_PARAM_STRING: return TZ_PARAM_STRING_SIZE;
    case TZ_PARAM_SIZE: return 2 * sizeof(int32_t);
    case TZ_PARAM_RANGE: return 2 * sizeof(double);
    case TZ_PARAM_RECT: return 4 * sizeof(int32_t);
    }
    return 0;
}

/* ---- parsing -------------------------------------------------------------------------
 */

/* Each parser returns false for text that is not of its form, and sets *in to false where
 * a number is out of the range. */

static bool in_range(const tz_param *p, double v) { return v >= p->min && v <= p->max; }

static bool parse_bool(const char *text, bool *out)
{
    static const char *const words[] = {"false", "no",  "off", "0",
                                        "true",  "yes", "on",  "1"};
    for (int i = 0; i < 8; i++) {
        if (strcasecmp(text, words[i]) == 0) {
            *out = i >= 4;
            return true;
        }
    }
    return false;
}

/* One integer; *text moves behind it. */
static bool parse_int(const char **text, const tz_param *p, int32_t *out, bool *in)
{
    char *end;
    errno = 0;
    if (**text != '-' && **text != '+' && (**text < '0' || **text > '9'))
        return false; /* strtoll would skip blanks */
    long long v = strtoll(*text, &end, 10);
    if (end == *text)
        return false;
    *text = end;
    if (errno == ERANGE || v < INT32_MIN || v > INT32_MAX || !in_range(p, (double)v)) {
        *in = false;
        return true;
    }
    *out = (int32_t)v;
    return true;
}

static bool parse_uint(const char **text, uint64_t *out, bool *in)
{
    char *end;
    errno = 0;
    if (**text == '-' && (*text)[1] >= '0' && (*text)[1] <= '9')
        *in = false; /* a number, but none of ours */
    else if (**text < '0' || **text > '9')
        return false;
    *out = strtoull(*text, &end, 10);
    if (end == *text)
        return false;
    *text = end;
    if (errno == ERANGE)
        *in = false;
    return true;
}

static bool parse_double(const char **text, const tz_param *p, double *out, bool *in)
{
    const char *end = *text;
    bool ok = tz_number_parse(*text, &end, out);
    if (end == *text)
        return false;
    *text = end;
    if (!ok || !in_range(p, *out))
        *in = false;
    return true;
}

static bool parse_bytes(const char **text, uint64_t *out, bool *in)
{
    if (!parse_uint(text, out, in))
        return false;
    static const char units[] = "KMGT";
    const char *u = **text ? strchr(units, **text & ~0x20) : NULL;
    if (u) {
        int shift = 10 * (int)(u - units + 1);
        ++*text;
        if (**text == 'i') /* KiB */
            ++*text;
        if (*out > UINT64_MAX >> shift)
            *in = false;
        else
            *out <<= shift;
    }
    if (**text == 'B' || **text == 'b')
        ++*text;
    return true;
}

static bool parse_choice(const char *text, const tz_param *p, int32_t *out)
{
    size_t n = strlen(text);
    int32_t index = 0;
    for (const char *c = p->choices;; c++, index++) {
        size_t k = strcspn(c, "|");
        if (k == n && strncmp(c, text, n) == 0) {
            *out = index;
            return true;
        }
        c += k;
        if (!*c)
            return false;
    }
}

/* Integers with a separator between. */
static bool parse_ints(const char **text, const tz_param *p, int n,
                       const char *separators, int32_t *out, bool *in)
{
    for (int i = 0; i < n; i++) {
        if (i > 0 && (!**text || !strchr(separators, *(*text)++)))
            return false;
        if (!parse_int(text, p, &out[i], in))
            return false;
    }
    return true;
}

static bool parse(const tz_param *p, const char *text, value *v, bool *in)
{
    bool ok = false;
    *in = true;
    switch (p->type) {
    case TZ_PARAM_BOOL: return parse_bool(text, &v->b);
    case TZ_PARAM_ENUM: return parse_choice(text, p, &v->i[0]);
    case TZ_PARAM_STRING:
        if (strlen(text) >= sizeof v->s)
            return false;
        memset(v->s, 0, sizeof v->s);
        strcpy(v->s, text);
        return true;
    case TZ_PARAM_INT: ok = parse_int(&text, p, &v->i[0], in); break;
    case TZ_PARAM_UINT64: ok = parse_uint(&text, &v->u, in); break;
    case TZ_PARAM_BYTES: ok = parse_bytes(&text, &v->u, in); break;
    case TZ_PARAM_DOUBLE: ok = parse_double(&text, p, &v->d[0], in); break;
    case TZ_PARAM_SIZE: ok = parse_ints(&text, p, 2, "xX", v->i, in); break;
    case TZ_PARAM_RECT: ok = parse_ints(&text, p, 4, ",", v->i, in); break;
    case TZ_PARAM_RANGE:
        ok = parse_double(&text, p, &v->d[0], in);
        v->d[1] = v->d[0];
        if (ok && *text == ',') {
            text++;
            ok = parse_double(&text, p, &v->d[1], in) && v->d[0] <= v->d[1];
        }
        break;
    }
    /* integers above 2^53 are not told apart by a double: no upper bound then */
    if (ok && (p->type == TZ_PARAM_UINT64 || p->type == TZ_PARAM_BYTES) &&
        ((double)v->u < p->min || (p->max < 0x1p63 && (double)v->u > p->max)))
        *in = false;
    return ok && !*text;
}

static const char *form(const tz_param *p)
{
    switch (p->type) {
    case TZ_PARAM_BOOL: return "true or false";
    case TZ_PARAM_INT: return "a whole number";
    case TZ_PARAM_UINT64: return "a whole number, not negative";
    case TZ_PARAM_DOUBLE: return "a number";
    case TZ_PARAM_ENUM: return p->choices;
    case TZ_PARAM_STRING: return "text of up to 1023 bytes";
    case TZ_PARAM_SIZE: return "a size such as 1024x512";
    case TZ_PARAM_RANGE: return "a number, or two such as -5,5, the lower first";
    case TZ_PARAM_RECT: return "a rectangle x,y,w,h such as 0,0,256,256";
    case TZ_PARAM_BYTES: return "a size such as 512M or 1G";
    }
    return "";
}

const tz_param *tz_params_find(const tz_param_table *t, const char *name)
{
    for (int32_t i = 0; i < t->n; i++)
        if (strcmp(t->row[i].name, name) == 0)
            return &t->row[i];
    return NULL;
}

tz_status tz_params_set(tz_ctx *ctx, const tz_param_table *t, void *s, const char *name,
                        const char *text)
{
    const tz_param *p = tz_params_find(t, name);
    if (!p)
        return tz_fail(ctx, TZ_INVALID, "%s: no parameter is called '%s'", t->name, name);
    value v;
    bool in;
    const char *space = p->unit[0] ? " " : "";
    if (!parse(p, text, &v, &in) && in)
        return tz_fail(ctx, TZ_INVALID, "%s: '%.80s' is not %s%s%s%s", name, text,
                       p->type == TZ_PARAM_ENUM ? "one of " : "", form(p), space,
                       p->unit);
    if (!in) {
        char low[32], high[32];
        tz_number_format(p->min, low);
        tz_number_format(p->max, high);
        return tz_fail(ctx, TZ_INVALID, "%s: '%.80s' is out of range; %s to %s%s%s", name,
                       text, low, high, space, p->unit);
    }
    memcpy((char *)s + p->offset, &v, value_size(p->type));
    return TZ_OK;
}

void tz_params_default(const tz_param_table *t, void *s)
{
    memset(s, 0, t->size);
    for (int32_t i = 0; i < t->n; i++) {
        tz_status status = tz_params_set(NULL, t, s, t->row[i].name, t->row[i].initial);
        assert(status == TZ_OK && "a table's default breaks its own rule");
        (void)status;
    }
}

/* ---- back to text ---------------------------------------------------------------------
 */

static void choice_text(const tz_param *p, int32_t index, char *text, size_t size)
{
    const char *c = p->choices;
    for (; index > 0 && *c; index--) {
        c += strcspn(c, "|");
        c += *c == '|';
    }
    snprintf(text, size, "%.*s", (int)strcspn(c, "|"), c);
}

static void bytes_text(uint64_t v, char *text, size_t size)
{
    static const char units[] = "TGMK";
    for (int i = 0; i < 4 && v > 0; i++) {
        int shift = 10 * (4 - i);
        if ((v >> shift) << shift == v) {
            snprintf(text, size, "%llu%c", (unsigned long long)(v >> shift), units[i]);
            return;
        }
    }
    snprintf(text, size, "%llu", (unsigned long long)v);
}

void tz_params_get(const tz_param *p, const void *s, char *text, size_t size)
{
    value v;
    char a[32], b[32];
    memcpy(&v, (const char *)s + p->offset, value_size(p->type));
    switch (p->type) {
    case TZ_PARAM_BOOL: snprintf(text, size, "%s", v.b ? "true" : "false"); break;
    case TZ_PARAM_INT: snprintf(text, size, "%d", v.i[0]); break;
    case TZ_PARAM_UINT64: snprintf(text, size, "%llu", (unsigned long long)v.u); break;
    case TZ_PARAM_ENUM: choice_text(p, v.i[0], text, size); break;
    case TZ_PARAM_STRING: snprintf(text, size, "%s", v.s); break;
    case TZ_PARAM_SIZE: snprintf(text, size, "%dx%d", v.i[0], v.i[1]); break;
    case TZ_PARAM_RECT:
        snprintf(text, size, "%d,%d,%d,%d", v.i[0], v.i[1], v.i[2], v.i[3]);
        break;
    case TZ_PARAM_BYTES: bytes_text(v.u, text, size); break;
    case TZ_PARAM_DOUBLE:
        tz_number_format(v.d[0], a);
        snprintf(text, size, "%s", a);
        break;
    case TZ_PARAM_RANGE:
        tz_number_format(v.d[0], a);
        tz_number_format(v.d[1], b);
        snprintf(text, size, "%s,%s", a, b);
        break;
    }
}
