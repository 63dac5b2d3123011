/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Parameter tables: one table of descriptors for each struct of parameters. The command
 * line, recipes, the viewer's panel, the man page and the JSON schema all read it. */
#ifndef TZ_BASE_PARAM_H
#define TZ_BASE_PARAM_H

#include <stddef.h>
#include <stdio.h>

#include "base/ctx.h"

typedef enum tz_param_type {
    TZ_PARAM_BOOL,   /**< bool; text "true"/"false" (also yes, no, on, off, 1, 0) */
    TZ_PARAM_INT,    /**< int32_t */
    TZ_PARAM_UINT64, /**< uint64_t, for seeds */
    TZ_PARAM_DOUBLE, /**< double; text round-trips exactly */
    TZ_PARAM_ENUM,   /**< int32_t index into choices "gradient|forest" */
    TZ_PARAM_STRING, /**< char[TZ_PARAM_STRING_SIZE] in the struct */
    TZ_PARAM_SIZE,   /**< int32_t[2], text "1024x512" */
    TZ_PARAM_RANGE,  /**< double[2], text "-5,5" or one number for both; lo <= hi */
    TZ_PARAM_RECT,   /**< tz_rect (int32_t[4]), text "x,y,w,h" */
    TZ_PARAM_BYTES   /**< uint64_t, text "1G", "512M", "64K" or bytes */
} tz_param_type;

#define TZ_PARAM_STRING_SIZE 1024

typedef struct tz_param {
    const char *name; /**< as on the command line, without dashes: "region-size" */
    tz_param_type type;
    size_t offset;
    double min, max;     /**< inclusive, for every number of the value */
    const char *initial; /**< default, as text */
    const char *unit;    /**< "px", "rad", "" */
    const char *choices; /**< ENUM: "a|b|c", else NULL */
    const char *help;    /**< one sentence */
} tz_param;

typedef struct tz_param_table {
    const char *name;    /**< "analyze", "arrange", ... */
    const char *summary; /**< one sentence */
    const tz_param *row;
    int32_t n;
    size_t size; /**< sizeof the struct */
} tz_param_table;

/** Fills `s` (t->size bytes) with the defaults. */
TZ_API void tz_params_default(const tz_param_table *t, void *s);
/** Row by name, or NULL. */
TZ_API const tz_param *tz_params_find(const tz_param_table *t, const char *name);
/** Parses and stores one value.
 * @return TZ_OK; TZ_INVALID with a message naming option, value, range and unit */
TZ_API tz_status tz_params_set(tz_ctx *ctx, const tz_param_table *t, void *s,
                               const char *name, const char *text);
/** Value as text that tz_params_set reads back to the same bits. */
TZ_API void tz_params_get(const tz_param *p, const void *s, char *text, size_t size);

TZ_API void tz_params_print_text(const tz_param_table *t, FILE *f);
/** JSON schema (draft 2020-12) of an object with these properties. */
TZ_API void tz_params_print_schema(const tz_param_table *t, FILE *f);
/** Roff of one ".SH"-less option list for a man page. */
TZ_API void tz_params_print_man(const tz_param_table *t, FILE *f);

#endif
