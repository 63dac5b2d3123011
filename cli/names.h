/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Names of files: templates, parts of paths, lists of seeds; and the checks on outputs
 * that run before the work begins. */
#ifndef TZ_CLI_NAMES_H
#define TZ_CLI_NAMES_H

#include "base/array.h"

/** What the words in braces stand for. */
typedef struct tz_name_values {
    const char *name, *ext, *map;
    uint64_t seed;
    int32_t width, height;
} tz_name_values;

/** Replaces {name} {seed} {ext} {width} {height} {map}; "{{" and "}}" give braces.
 * @param[out] out  free with tz_free(ctx, ...)
 * @return TZ_OK; TZ_INVALID (unknown word, lone brace); TZ_NOMEM */
tz_status tz_name_expand(tz_ctx *ctx, const char *text, const tz_name_values *v,
                         char **out);
/** Whether a template uses a word, e.g. "seed". */
bool tz_name_uses(const char *text, const char *word);

/** File name without folder and last extension; "stdin" for "-". */
void tz_path_stem(const char *path, char *stem, size_t size);
/** Last extension without dot, or "". */
const char *tz_path_extension(const char *path);
/** Folder part with its slash, or "" ("" for "-"). */
void tz_path_folder(const char *path, char *folder, size_t size);
/** `file` as seen from the folder that `document` stands in (or will stand in).
 * @return TZ_OK; TZ_IO if either cannot be resolved; TZ_NOMEM */
tz_status tz_path_relative(tz_ctx *ctx, const char *document, const char *file,
                           char **out);

typedef TZ_ARRAY(uint64_t)
tz_seed_list;
/** "7", "1..8", "1,4,10..12"; at most 100,000 seeds. */
tz_status tz_seeds_parse(tz_ctx *ctx, const char *text, tz_seed_list *out);

typedef TZ_ARRAY(char *)
tz_path_list;
tz_status tz_paths_add(tz_ctx *ctx, tz_path_list *l, const char *path);
void tz_paths_free(tz_ctx *ctx, tz_path_list *l);

/** Looks at every output before the work: it must not be a folder, stand in a missing or
 * unwritable one, overwrite one of the inputs, or be named twice.
 * @return TZ_OK; TZ_INVALID; TZ_IO */
tz_status tz_outputs_check(tz_ctx *ctx, const tz_path_list *inputs,
                           const tz_path_list *outputs);

#endif
