/* SPDX-License-Identifier: Apache-2.0 */
/* Formulas: recursive descent to steps of a stack machine. Each level of the grammar
 * leaves one value on the stack, so that the depth of the text bounds the stack. */
#include "elements/formula.h"

#include <math.h>
#include <string.h>

#include "base/geom.h"
#include "base/number.h"

enum { MOST_TEXT = 4096, MOST_DEPTH = 64, STACK = 4 * (MOST_DEPTH + 2) };

typedef enum code {
    CONSTANT,
    X,
    Y,
    W,
    H,
    ADD,
    SUBTRACT,
    MULTIPLY,
    DIVIDE,
    POWER,
    NEGATE,
    SIN,
    COS,
    TAN,
    ASIN,
    ACOS,
    ATAN,
    SQRT,
    ABS,
    EXP,
    LOG,
    FLOOR,
    ATAN2,
    MIN,
    MAX,
    MOD
} code;

typedef struct name {
    const char *text;
    code code;
    int arguments; /* 0 = a value */
} name;

static const name names[] = {
    {"x", X, 0},         {"y", Y, 0},       {"w", W, 0},       {"h", H, 0},
    {"pi", CONSTANT, 0}, {"sin", SIN, 1},   {"cos", COS, 1},   {"tan", TAN, 1},
    {"asin", ASIN, 1},   {"acos", ACOS, 1}, {"atan", ATAN, 1}, {"sqrt", SQRT, 1},
    {"abs", ABS, 1},     {"exp", EXP, 1},   {"log", LOG, 1},   {"floor", FLOOR, 1},
    {"atan2", ATAN2, 2}, {"min", MIN, 2},   {"max", MAX, 2},   {"mod", MOD, 2},
};

typedef struct parser {
    tz_ctx *ctx;
    tz_formula *f;
    const char *text, *at;
    int depth; /* of nested parentheses, signs and powers */
} parser;

static tz_status parse_sum(parser *p);

static void skip(parser *p) { p->at += strspn(p->at, " \t\r\n"); }

static tz_status wrong(parser *p, const char *what)
{
    return tz_fail(p->ctx, TZ_INVALID, "formula \"%.60s\": %s at character %d", p->text,
                   what, (int)(p->at - p->text) + 1);
}

static tz_status emit(parser *p, code c, double value)
{
    return tz_array_push(p->ctx, &p->f->step, ((tz_formula_step){(int32_t)c, value}));
}

static bool take(parser *p, char c)
{
    skip(p);
    if (*p->at != c)
        return false;
    p->at++;
    return true;
}

static tz_status deeper(parser *p)
{
    if (++p->depth <= MOST_DEPTH)
        return TZ_OK;
    return tz_fail(p->ctx, TZ_LIMIT,
                   "formula \"%.60s\": over %d levels deep at character %d", p->text,
                   MOST_DEPTH, (int)(p->at - p->text) + 1);
}

static tz_status parse_call(parser *p, const name *n)
{
    tz_status s = TZ_OK;
    if (!take(p, '('))
        return wrong(p, "a ( is missing");
    for (int k = 0; k < n->arguments && s == TZ_OK; k++) {
        if (k > 0 && !take(p, ','))
            return wrong(p, "a second value behind a comma is missing");
        s = parse_sum(p);
    }
    if (s == TZ_OK && !take(p, ')'))
        return wrong(p, "a ) is missing");
    return s == TZ_OK ? emit(p, n->code, 0) : s;
}

static tz_status parse_name(parser *p)
{
    size_t n = 0;
    while ((p->at[n] >= 'a' && p->at[n] <= 'z') || (p->at[n] >= '0' && p->at[n] <= '9'))
        n++;
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++)
        if (strlen(names[k].text) == n && strncmp(names[k].text, p->at, n) == 0) {
            p->at += n;
            return names[k].arguments > 0 ? parse_call(p, &names[k])
                                          : emit(p, names[k].code, TZ_PI);
        }
    return wrong(p, "a name that is not known");
}

static tz_status parse_atom(parser *p)
{
    const char *end;
    double v;
    skip(p);
    if (*p->at >= 'a' && *p->at <= 'z')
        return parse_name(p);
    if (*p->at == '(') {
        p->at++;
        tz_status s = parse_sum(p);
        if (s == TZ_OK && !take(p, ')'))
            s = wrong(p, "a ) is missing");
        return s;
    }
    if (((*p->at >= '0' && *p->at <= '9') || *p->at == '.') &&
        tz_number_parse(p->at, &end, &v)) {
        p->at = end;
        return emit(p, CONSTANT, v);
    }
    return wrong(p, "a number, a name or a ( is missing");
}

static tz_status parse_sign(parser *p)
{
    tz_status s = deeper(p);
    const bool minus = s == TZ_OK && take(p, '-');
    if (s == TZ_OK && (minus || take(p, '+'))) {
        s = parse_sign(p);
        if (s == TZ_OK && minus)
            s = emit(p, NEGATE, 0);
    } else if (s == TZ_OK) {
        s = parse_atom(p);
        if (s == TZ_OK && take(p, '^')) {
            s = parse_sign(p);
            if (s == TZ_OK)
                s = emit(p, POWER, 0);
        }
    }
    p->depth--;
    return s;
}

static tz_status parse_product(parser *p)
{
    tz_status s = parse_sign(p);
    while (s == TZ_OK) {
        const code c = take(p, '*') ? MULTIPLY : take(p, '/') ? DIVIDE : CONSTANT;
        if (c == CONSTANT)
            break;
        s = parse_sign(p);
        if (s == TZ_OK)
            s = emit(p, c, 0);
    }
    return s;
}

static tz_status parse_sum(parser *p)
{
    tz_status s = parse_product(p);
    while (s == TZ_OK) {
        const code c = take(p, '+') ? ADD : take(p, '-') ? SUBTRACT : CONSTANT;
        if (c == CONSTANT)
            break;
        s = parse_product(p);
        if (s == TZ_OK)
            s = emit(p, c, 0);
    }
    return s;
}

tz_status tz_formula_parse(tz_ctx *ctx, const char *text, tz_formula *f)
{
    parser p = {.ctx = ctx, .f = f, .text = text, .at = text};
    *f = (tz_formula){0};
    if (strlen(text) > MOST_TEXT)
        return tz_fail(ctx, TZ_LIMIT, "formula \"%.30s...\": over %d characters", text,
                       MOST_TEXT);
    tz_status s = parse_sum(&p);
    skip(&p);
    if (s == TZ_OK && *p.at)
        s = wrong(&p, "something that does not belong there");
    if (s != TZ_OK)
        tz_formula_deinit(ctx, f);
    return s;
}

void tz_formula_deinit(tz_ctx *ctx, tz_formula *f) { tz_array_free(ctx, &f->step); }

/* ---- values ---------------------------------------------------------------------- */

static double of_one(code c, double a)
{
    switch (c) {
    case NEGATE: return -a;
    case SIN: return sin(a);
    case COS: return cos(a);
    case TAN: return tan(a);
    case ASIN: return asin(a);
    case ACOS: return acos(a);
    case ATAN: return atan(a);
    case SQRT: return sqrt(a);
    case ABS: return fabs(a);
    case EXP: return exp(a);
    case LOG: return log(a);
    default: return floor(a);
    }
}

static double of_two(code c, double a, double b)
{
    switch (c) {
    case ADD: return a + b;
    case SUBTRACT: return a - b;
    case MULTIPLY: return a * b;
    case DIVIDE: return a / b;
    case POWER: return pow(a, b);
    case ATAN2: return atan2(a, b);
    case MIN: return fmin(a, b);
    case MAX: return fmax(a, b);
    default: return a - b * floor(a / b);
    }
}

static double value_of(code c, double constant, tz_formula_place p)
{
    switch (c) {
    case X: return p.x;
    case Y: return p.y;
    case W: return p.w;
    case H: return p.h;
    default: return constant;
    }
}

double tz_formula_at(const tz_formula *f, tz_formula_place place)
{
    double stack[STACK] = {0};
    int n = 0;
    for (int32_t i = 0; i < f->step.n; i++) {
        const code c = (code)f->step.v[i].code;
        if (c <= H) {
            if (n >= STACK)
                return NAN;
            stack[n++] = value_of(c, f->step.v[i].value, place);
        } else if (n > 0 && (c == NEGATE || (c >= SIN && c <= FLOOR))) {
            stack[n - 1] = of_one(c, stack[n - 1]);
        } else if (n > 1) {
            n--;
            stack[n - 1] = of_two(c, stack[n - 1], stack[n]);
        }
    }
    return n > 0 ? stack[0] : NAN;
}
