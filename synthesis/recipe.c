/* SPDX-License-Identifier: Apache-2.0 */
/* A recipe is a small JSON tree. Parameters are kept as the text that the command line
 * takes: tz_params_get and tz_params_set round-trip it to the same bits, and 64-bit seeds
 * do not fit JSON's numbers. */
#include "synthesis/recipe.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"
#include "base/image_io.h"
#include "base/svg.h"

struct tz_recipe {
    tz_ctx *ctx;
    json_t *root, *operands, *parameters, *given,
        *inputs; /* inside root; given: or NULL */
};

static tz_status no_memory(tz_ctx *ctx)
{
    return tz_fail(ctx, TZ_NOMEM, "recipe: out of memory");
}

static tz_status put(tz_ctx *ctx, json_t *object, const char *key, const char *text)
{
    if (json_object_set_new(object, key, json_string(text)) != 0)
        return tz_fail(ctx, TZ_INVALID, "recipe: %s '%s' is not UTF-8 text; rename it",
                       key, text);
    return TZ_OK;
}

tz_status tz_recipe_new(tz_ctx *ctx, const char *version, const char *command,
                        tz_recipe **out)
{
    tz_recipe *r = NULL;
    tz_status s = tz_alloc_zero(ctx, &r, 1, sizeof *r);
    if (s != TZ_OK)
        return s;
    r->ctx = ctx;
    r->root = json_object();
    if (!r->root) {
        s = no_memory(ctx);
        goto done;
    }
    if ((s = put(ctx, r->root, "terrazzo", version)) != TZ_OK ||
        (s = put(ctx, r->root, "command", command)) != TZ_OK ||
        (s = put(ctx, r->root, "makes", "")) != TZ_OK)
        goto done;
    if (json_object_set_new(r->root, "operands", r->operands = json_array()) != 0 ||
        json_object_set_new(r->root, "parameters", r->parameters = json_object()) != 0 ||
        json_object_set_new(r->root, "given", r->given = json_array()) != 0 ||
        json_object_set_new(r->root, "inputs", r->inputs = json_array()) != 0)
        s = no_memory(ctx);
done:
    if (s == TZ_OK)
        *out = r;
    else
        tz_recipe_free(r);
    return s;
}

void tz_recipe_free(tz_recipe *r)
{
    if (!r)
        return;
    json_decref(r->root);
    tz_free(r->ctx, r);
}

tz_status tz_recipe_add_operand(tz_recipe *r, const char *path)
{
    json_t *v = json_string(path);
    if (!v)
        return tz_fail(r->ctx, TZ_INVALID, "%s: the name is not UTF-8 text; rename it",
                       path);
    return json_array_append_new(r->operands, v) == 0 ? TZ_OK : no_memory(r->ctx);
}

tz_status tz_recipe_add_input(tz_recipe *r, const char *path, const char *sha256)
{
    size_t i;
    json_t *old;
    json_array_foreach(r->inputs, i,
                       old) if (strcmp(json_string_value(json_object_get(old, "path")),
                                       path) == 0) return TZ_OK;
    json_t *v = json_object();
    tz_status s = v ? put(r->ctx, v, "path", path) : no_memory(r->ctx);
    if (s == TZ_OK)
        s = put(r->ctx, v, "sha256", sha256);
    if (s != TZ_OK) {
        json_decref(v);
        return s;
    }
    return json_array_append_new(r->inputs, v) == 0 ? TZ_OK : no_memory(r->ctx);
}

tz_status tz_recipe_add_params(tz_recipe *r, const tz_param_table *t, const void *values)
{
    for (int32_t i = 0; i < t->n; i++) {
        char text[TZ_PARAM_STRING_SIZE + 1];
        tz_params_get(&t->row[i], values, text, sizeof text);
        tz_status s = put(r->ctx, r->parameters, t->row[i].name, text);
        if (s != TZ_OK)
            return s;
    }
    return TZ_OK;
}

tz_status tz_recipe_add_given(tz_recipe *r, const char *name)
{
    return json_array_append_new(r->given, json_string(name)) == 0 ? TZ_OK
                                                                   : no_memory(r->ctx);
}

tz_status tz_recipe_text(const tz_recipe *r, const char *makes, char **out)
{
    tz_status s = put(r->ctx, r->root, "makes", makes);
    if (s != TZ_OK)
        return s;
    char *text = json_dumps(r->root, JSON_COMPACT);
    if (!text)
        return no_memory(r->ctx);
    s = tz_strdup(r->ctx, text, out);
    free(text);
    return s;
}

/* ---- reading ---------------------------------------------------------------------- */

/* Every member has its type; arrays hold strings, inputs path and sha256. */
static const char *fault(const tz_recipe *r)
{
    size_t i;
    json_t *v;
    const char *key;
    static const char *const words[] = {"terrazzo", "command", "makes"};
    for (i = 0; i < 3; i++)
        if (!json_is_string(json_object_get(r->root, words[i])))
            return words[i];
    if (!json_is_array(r->operands))
        return "operands";
    json_array_foreach(r->operands, i, v) if (!json_is_string(v)) return "operands";
    if (!json_is_object(r->parameters))
        return "parameters";
    json_object_foreach(r->parameters, key, v) if (!json_is_string(v)) return key;
    if (r->given && !json_is_array(r->given))
        return "given";
    json_array_foreach(r->given, i, v) if (!json_is_string(v)) return "given";
    if (!json_is_array(r->inputs))
        return "inputs";
    json_array_foreach(r->inputs, i, v) if (!json_is_string(json_object_get(v, "path")) ||
                                            !json_is_string(json_object_get(
                                                v, "sha256"))) return "inputs";
    return NULL;
}

tz_status tz_recipe_parse(tz_ctx *ctx, const char *name, const char *text,
                          tz_recipe **out)
{
    json_error_t e;
    json_t *root = json_loads(text, JSON_REJECT_DUPLICATES, &e);
    if (!root)
        return tz_fail(ctx, TZ_FORMAT,
                       "%s: its recipe is broken at line %d, column %d: %s", name, e.line,
                       e.column, e.text);
    tz_recipe *r = NULL;
    tz_status s = tz_alloc_zero(ctx, &r, 1, sizeof *r);
    if (s != TZ_OK) {
        json_decref(root);
        return s;
    }
    *r = (tz_recipe){ctx,
                     root,
                     json_object_get(root, "operands"),
                     json_object_get(root, "parameters"),
                     json_object_get(root, "given"),
                     json_object_get(root, "inputs")};
    const char *bad = fault(r);
    if (bad) {
        s = tz_fail(ctx, TZ_FORMAT,
                    "%s: its recipe is broken: '%s' is missing or not text", name, bad);
        tz_recipe_free(r);
        return s;
    }
    *out = r;
    return TZ_OK;
}

static const char *word(const tz_recipe *r, const char *key)
{
    return json_string_value(json_object_get(r->root, key));
}

const char *tz_recipe_version(const tz_recipe *r) { return word(r, "terrazzo"); }
const char *tz_recipe_command(const tz_recipe *r) { return word(r, "command"); }
const char *tz_recipe_makes(const tz_recipe *r) { return word(r, "makes"); }

int32_t tz_recipe_operands(const tz_recipe *r)
{
    return (int32_t)json_array_size(r->operands);
}

const char *tz_recipe_operand(const tz_recipe *r, int32_t i)
{
    return json_string_value(json_array_get(r->operands, (size_t)i));
}

int32_t tz_recipe_inputs(const tz_recipe *r)
{
    return (int32_t)json_array_size(r->inputs);
}

void tz_recipe_input(const tz_recipe *r, int32_t i, const char **path,
                     const char **sha256)
{
    json_t *v = json_array_get(r->inputs, (size_t)i);
    *path = json_string_value(json_object_get(v, "path"));
    *sha256 = json_string_value(json_object_get(v, "sha256"));
}

int32_t tz_recipe_params(const tz_recipe *r)
{
    return (int32_t)json_object_size(r->parameters);
}

void tz_recipe_param(const tz_recipe *r, int32_t i, const char **name, const char **text)
{
    void *it = json_object_iter(r->parameters);
    while (i-- > 0)
        it = json_object_iter_next(r->parameters, it);
    *name = json_object_iter_key(it);
    *text = json_string_value(json_object_iter_value(it));
}

bool tz_recipe_given(const tz_recipe *r, const char *name)
{
    size_t i;
    json_t *v;
    json_array_foreach(r->given, i,
                       v) if (strcmp(json_string_value(v), name) == 0) return true;
    return !r->given;
}

/* ---- finding ---------------------------------------------------------------------- */

/* Images carry the text as it is, near the file's beginning (PNG, EXR, JPEG) or its end
 * (TIFF): a look there spares decoding gigapixels. Formats that wrap or pack their
 * metadata (WebP) are read whole after that. */
enum { LOOK = 1 << 20 };
static const char mark[] = "{\"terrazzo\":\"";

/* Text of the JSON object that begins with the mark, or NULL. */
static char *find_text(const char *data, size_t size)
{
    const char *at = memmem(data, size, mark, sizeof mark - 1);
    if (!at)
        return NULL;
    json_t *v = json_loadb(at, size - (size_t)(at - data),
                           JSON_REJECT_DUPLICATES | JSON_DISABLE_EOF_CHECK, NULL);
    char *text = v ? json_dumps(v, JSON_COMPACT) : NULL;
    json_decref(v);
    return text;
}

static char *look(FILE *f, char *buffer)
{
    char *text = find_text(buffer, fread(buffer, 1, LOOK, f));
    if (!text && fseeko(f, -(off_t)LOOK, SEEK_END) == 0)
        text = find_text(buffer, fread(buffer, 1, LOOK, f));
    return text;
}

static tz_status take(tz_ctx *ctx, char *text, char **out)
{
    tz_status s = tz_strdup(ctx, text, out);
    free(text);
    return s;
}

static tz_status read_svg(tz_ctx *ctx, const char *path, char **out)
{
    tz_svg_doc *doc = NULL;
    tz_status s = tz_svg_read(ctx, path, &doc);
    if (s != TZ_OK)
        return s;
    tz_svg_node n = tz_svg_by_id(doc, "tz-recipe");
    s = n ? tz_strdup(ctx, tz_svg_text(doc, n), out) : TZ_UNSUPPORTED;
    tz_svg_free(doc);
    return s;
}

static tz_status read_json(tz_ctx *ctx, const char *path, char **out)
{
    size_t size;
    return tz_file_read(ctx, path, LOOK, out, &size);
}

static tz_status read_image(tz_ctx *ctx, const char *path, char **out)
{
    tz_image im = {0};
    char *buffer = NULL, *text = NULL;
    FILE *f = fopen(path, "rb");
    tz_status s = f ? tz_alloc(ctx, &buffer, LOOK, 1)
                    : tz_fail(ctx, TZ_IO, "%s: %s", path, strerror(errno));
    if (s == TZ_OK)
        text = look(f, buffer);
    if (f)
        fclose(f);
    tz_free(ctx, buffer);
    if (s != TZ_OK)
        return s;
    if (text)
        return take(ctx, text, out);
    const tz_image_read_options opt = {.data = true};
    s = tz_image_read(ctx, path, &opt, &im);
    if (s != TZ_OK)
        return s;
    const char *meta = tz_image_meta(&im, TZ_RECIPE_KEY);
    s = meta ? tz_strdup(ctx, meta, out)
             : tz_fail(ctx, TZ_FORMAT,
                       "%s: carries no recipe; only outputs of terrazzo do, "
                       "until another program saves them anew",
                       path);
    tz_image_deinit(&im);
    return s;
}

tz_status tz_recipe_read(tz_ctx *ctx, const char *path, char **out)
{
    const char *dot = strrchr(path, '.');
    if (dot && strcasecmp(dot, ".svg") == 0)
        return read_svg(ctx, path, out);
    if (dot && strcasecmp(dot, ".json") == 0)
        return read_json(ctx, path, out);
    return read_image(ctx, path, out);
}
