/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Recipes: how an output was made, as JSON text that travels in the output's metadata, so
 * that the same bytes can be made again.
 *
 *   {"terrazzo": "0.1.0",            version that made it
 *    "command": "expand",
 *    "makes": "colour",              which of the command's outputs this is
 *    "operands": ["rocks.jpg"],      as given
 *    "parameters": {"size": "2048x2048", "seed": "7", ...},   every option's text
 *    "given": ["size"],              those that were named, of all that decide by being
 *                                    named: without a size the program chooses one
 *    "inputs": [{"path": "rocks.jpg", "sha256": "..."}, ...]} */
#ifndef TZ_SYNTHESIS_RECIPE_H
#define TZ_SYNTHESIS_RECIPE_H

#include "base/param.h"

/** Key of the recipe in image metadata. */
#define TZ_RECIPE_KEY "terrazzo:recipe"

typedef struct tz_recipe tz_recipe;

TZ_API tz_status tz_recipe_new(tz_ctx *ctx, const char *version, const char *command,
                               tz_recipe **out);
TZ_API void tz_recipe_free(tz_recipe *r); /**< takes NULL */
TZ_API tz_status tz_recipe_add_operand(tz_recipe *r, const char *path);
/** Adds an input file once. @param sha256 64 hex digits, "" = unknown (standard input) */
TZ_API tz_status tz_recipe_add_input(tz_recipe *r, const char *path, const char *sha256);
/** Adds every row of the table; names must not repeat between tables. */
TZ_API tz_status tz_recipe_add_params(tz_recipe *r, const tz_param_table *t,
                                      const void *s);
/** Marks a parameter as named on the command line. */
TZ_API tz_status tz_recipe_add_given(tz_recipe *r, const char *name);
/** Compact JSON text of the recipe for one output.
 * @param makes     "colour", a map's name, "layout", ...
 * @param[out] out  free with tz_free(ctx, ...) */
TZ_API tz_status tz_recipe_text(const tz_recipe *r, const char *makes, char **out);

/** @param name  file that the text comes from, for messages
 *  @return TZ_OK; TZ_FORMAT with the fault and its place; TZ_NOMEM */
TZ_API tz_status tz_recipe_parse(tz_ctx *ctx, const char *name, const char *text,
                                 tz_recipe **out);
/** Values; strings live as long as the recipe. */
TZ_API const char *tz_recipe_version(const tz_recipe *r);
TZ_API const char *tz_recipe_command(const tz_recipe *r);
TZ_API const char *tz_recipe_makes(const tz_recipe *r);
TZ_API int32_t tz_recipe_operands(const tz_recipe *r);
TZ_API const char *tz_recipe_operand(const tz_recipe *r, int32_t i);
TZ_API int32_t tz_recipe_inputs(const tz_recipe *r);
TZ_API void tz_recipe_input(const tz_recipe *r, int32_t i, const char **path,
                            const char **sha256);
/** Parameters in their order; false at the end. */
TZ_API int32_t tz_recipe_params(const tz_recipe *r);
TZ_API void tz_recipe_param(const tz_recipe *r, int32_t i, const char **name,
                            const char **text);
/** Whether a parameter was named on the command line; true for all where the recipe does not
 * tell. */
TZ_API bool tz_recipe_given(const tz_recipe *r, const char *name);

/** Finds the recipe text in an image's metadata, an SVG's <metadata> or a JSON file.
 * @param[out] out  free with tz_free(ctx, ...)
 * @return TZ_OK; TZ_IO; TZ_FORMAT (no recipe in it, or not a file that can carry one);
 *   TZ_UNSUPPORTED, without a message: an SVG without a recipe, such as an exemplar */
TZ_API tz_status tz_recipe_read(tz_ctx *ctx, const char *path, char **out);

#endif
