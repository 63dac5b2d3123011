/* SPDX-License-Identifier: Apache-2.0 */
/* A parameter table as help text, JSON schema and man page source. */
#include <string.h>

#include "base/number.h"
#include "base/param.h"

static bool numeric(const tz_param *p)
{
    return p->type != TZ_PARAM_BOOL && p->type != TZ_PARAM_ENUM &&
           p->type != TZ_PARAM_STRING;
}

static const char *placeholder(tz_param_type t)
{
    switch (t) {
    case TZ_PARAM_BOOL: return "";
    case TZ_PARAM_INT:
    case TZ_PARAM_UINT64: return "N";
    case TZ_PARAM_DOUBLE: return "X";
    case TZ_PARAM_ENUM: return "WORD";
    case TZ_PARAM_STRING: return "TEXT";
    case TZ_PARAM_SIZE: return "WxH";
    case TZ_PARAM_RANGE: return "LO,HI";
    case TZ_PARAM_RECT: return "X,Y,W,H";
    case TZ_PARAM_BYTES: return "BYTES";
    }
    return "";
}

/* "1 to 100 px, default 5" */
static void facts(const tz_param *p, char *text, size_t size)
{
    char low[32], high[32];
    size_t n = 0;
    text[0] = 0;
    if (numeric(p)) {
        tz_number_format(p->min, low);
        tz_number_format(p->max, high);
        n = (size_t)snprintf(text, size, "%s to %s%s%s; ", low, high,
                             p->unit[0] ? " " : "", p->unit);
    } else if (p->type == TZ_PARAM_ENUM) {
        n = (size_t)snprintf(text, size, "%s; ", p->choices);
    }
    if (n < size)
        snprintf(text + n, size - n, "default %s", p->initial[0] ? p->initial : "none");
}

void tz_params_print_text(const tz_param_table *t, FILE *f)
{
    fprintf(f, "%s: %s\n\n", t->name, t->summary);
    for (int32_t i = 0; i < t->n; i++) {
        const tz_param *p = &t->row[i];
        char head[80], tail[400];
        const char *value = placeholder(p->type);
        snprintf(head, sizeof head, "--%s%s%s", p->name, value[0] ? " " : "", value);
        facts(p, tail, sizeof tail);
        fprintf(f, "  %-28s %s (%s)\n", head, p->help, tail);
    }
}

/* ---- JSON schema
 * ------------------------------------------------------------------------ */

static void put_json(FILE *f, const char *s)
{
    fputc('"', f);
    for (; *s; s++) {
        unsigned char c = (unsigned char)*s;
        if (c == '"' || c == '\\')
            fprintf(f, "\\%c", c);
        else if (c < 0x20)
            fprintf(f, "\\u%04x", c);
        else
            fputc(c, f);
    }
    fputc('"', f);
}

static void put_bounds(const tz_param *p, FILE *f)
{
    char low[32], high[32];
    tz_number_format(p->min, low);
    tz_number_format(p->max, high);
    fprintf(f, "\"minimum\": %s, \"maximum\": %s", low, high);
}

static void put_choices(const char *choices, FILE *f)
{
    const char *separator = "";
    for (const char *c = choices;; c++) {
        size_t n = strcspn(c, "|");
        fprintf(f, "%s\"%.*s\"", separator, (int)n, c);
        separator = ", ";
        c += n;
        if (!*c)
            return;
    }
}

/* Sizes, ranges, rectangles and byte counts are text in JSON too: one notation for the
 * command line, recipes and batch files. */
static void put_type(const tz_param *p, FILE *f)
{
    switch (p->type) {
    case TZ_PARAM_BOOL: fputs("\"type\": \"boolean\"", f); break;
    case TZ_PARAM_INT:
    case TZ_PARAM_UINT64:
        fputs("\"type\": \"integer\", ", f);
        put_bounds(p, f);
        break;
    case TZ_PARAM_DOUBLE:
        fputs("\"type\": \"number\", ", f);
        put_bounds(p, f);
        break;
    case TZ_PARAM_ENUM:
        fputs("\"enum\": [", f);
        put_choices(p->choices, f);
        fputc(']', f);
        break;
    case TZ_PARAM_STRING:
        fprintf(f, "\"type\": \"string\", \"maxLength\": %d", TZ_PARAM_STRING_SIZE - 1);
        break;
    case TZ_PARAM_SIZE:
        fputs("\"type\": \"string\", \"pattern\": \"^[0-9]+[xX][0-9]+$\"", f);
        break;
    case TZ_PARAM_RANGE:
        fputs("\"type\": \"string\", \"pattern\": \"^[-+0-9.eE]+(,[-+0-9.eE]+)?$\"", f);
        break;
    case TZ_PARAM_RECT:
        fputs("\"type\": \"string\", \"pattern\": \"^-?[0-9]+(,-?[0-9]+){3}$\"", f);
        break;
    case TZ_PARAM_BYTES:
        fputs("\"type\": \"string\", \"pattern\": \"^[0-9]+[KkMmGgTt]?i?[Bb]?$\"", f);
        break;
    }
}

static void put_default(const tz_param *p, FILE *f)
{
    bool bare = p->type == TZ_PARAM_BOOL || p->type == TZ_PARAM_INT ||
                p->type == TZ_PARAM_UINT64 || p->type == TZ_PARAM_DOUBLE;
    if (p->type == TZ_PARAM_BOOL)
        fputs(strchr("tyo1", p->initial[0] | 0x20) && strcmp(p->initial, "off") != 0
                  ? "true"
                  : "false",
              f);
    else if (bare)
        fputs(p->initial, f);
    else
        put_json(f, p->initial);
}

void tz_params_print_schema(const tz_param_table *t, FILE *f)
{
    fputs("{\n  \"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n", f);
    fputs("  \"title\": ", f);
    put_json(f, t->name);
    fputs(",\n  \"description\": ", f);
    put_json(f, t->summary);
    fputs(",\n  \"type\": \"object\",\n  \"additionalProperties\": false,\n", f);
    fputs("  \"properties\": {", f);
    for (int32_t i = 0; i < t->n; i++) {
        const tz_param *p = &t->row[i];
        fprintf(f, "%s\n    ", i ? "," : "");
        put_json(f, p->name);
        fputs(": { ", f);
        put_type(p, f);
        fputs(", \"default\": ", f);
        put_default(p, f);
        fputs(", \"description\": ", f);
        put_json(f, p->help);
        if (p->unit[0]) {
            fputs(", \"$comment\": ", f);
            put_json(f, p->unit);
        }
        fputs(" }", f);
    }
    fputs("\n  }\n}\n", f);
}

/* ---- man page
 * --------------------------------------------------------------------------- */

static void put_roff(FILE *f, const char *s)
{
    if (*s == '.' || *s == '\'')
        fputs("\\&", f); /* would be a request at the start of a line */
    for (; *s; s++) {
        if (*s == '\\')
            fputs("\\e", f);
        else if (*s == '-')
            fputs("\\-", f);
        else
            fputc(*s == '\n' ? ' ' : *s, f);
    }
}

void tz_params_print_man(const tz_param_table *t, FILE *f)
{
    for (int32_t i = 0; i < t->n; i++) {
        const tz_param *p = &t->row[i];
        char tail[400];
        facts(p, tail, sizeof tail);
        fputs(".TP\n\\fB\\-\\-", f);
        put_roff(f, p->name);
        fputs("\\fR", f);
        if (placeholder(p->type)[0])
            fprintf(f, " \\fI%s\\fR", placeholder(p->type));
        fputc('\n', f);
        put_roff(f, p->help);
        fputs(" (", f);
        put_roff(f, tail);
        fputs(").\n", f);
    }
}
