/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/record.h"

#include <jansson.h>
#include <limits.h>
#include <string.h>

#include "base/file.h"

void tz_record_free(tz_cli *cli, tz_record *r)
{
    tz_paths_free(cli->ctx, &r->path);
    tz_paths_free(cli->ctx, &r->sha256);
}

tz_status tz_record_input(tz_cli *cli, tz_record *r, const char *path, const char *sha256)
{
    char hex[65] = "";
    tz_status s = TZ_OK;
    if (!sha256 && strcmp(path, "-") != 0)
        s = tz_file_sha256(cli->ctx, tz_cli_find(cli, path), hex);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &r->path, path);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &r->sha256, sha256 ? sha256 : hex);
    return s;
}

/* Every "mask" and "field" of the file is an image beside it. */
static tz_status add_images(tz_cli *cli, tz_record *r, const char *folder,
                            const json_t *v)
{
    tz_status s = TZ_OK;
    const char *key;
    size_t i;
    json_t *child;
    if (json_is_object(v)) {
        json_object_foreach((json_t *)v, key, child)
        {
            if (s == TZ_OK && json_is_string(child) &&
                (strcmp(key, "mask") == 0 || strcmp(key, "field") == 0)) {
                char path[PATH_MAX];
                const char *name = json_string_value(child);
                snprintf(path, sizeof path, "%s%s", *name == '/' ? "" : folder, name);
                s = tz_record_input(cli, r, path, NULL);
            } else if (s == TZ_OK) {
                s = add_images(cli, r, folder, child);
            }
        }
    } else if (json_is_array(v)) {
        json_array_foreach((json_t *)v, i, child) if (s == TZ_OK) s =
            add_images(cli, r, folder, child);
    }
    return s;
}

tz_status tz_record_rules(tz_cli *cli, tz_record *r, const char *path)
{
    if (!*path)
        return TZ_OK;
    char *text = NULL, folder[PATH_MAX];
    size_t size;
    tz_status s = tz_record_input(cli, r, path, NULL);
    if (s == TZ_OK)
        s = tz_file_read(cli->ctx, tz_cli_find(cli, path), 1 << 26, &text, &size);
    if (s != TZ_OK)
        return s;
    json_t *root = json_loads(text, 0, NULL); /* the reader of rules tells of faults */
    tz_path_folder(path, folder, sizeof folder);
    s = add_images(cli, r, folder, root);
    json_decref(root);
    tz_free(cli->ctx, text);
    return s;
}

/* Options that decide by being named, whatever they say: tz_cli_given asks for them. The
 * recipe tells no others, so that naming a default changes no bytes. */
static bool decides(const char *name)
{
    static const char *const names[] = {"size", "wrap", "rotation", "rotate-auto"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(names[i], name) == 0)
            return true;
    return false;
}

/* Every option that is recorded, and which of those that decide were named. */
static tz_status add_options(tz_cli *cli, tz_recipe *recipe)
{
    const tz_command *c = cli->command;
    tz_status s = TZ_OK;
    for (int32_t g = 0; s == TZ_OK && g < c->groups; g++) {
        const tz_param_table *t = c->group[g].table;
        if (!c->group[g].recorded)
            continue;
        s = tz_recipe_add_params(recipe, t, (char *)cli->values + c->group[g].offset);
        for (int32_t i = 0; s == TZ_OK && i < t->n; i++)
            if (decides(t->row[i].name) && tz_cli_given(cli, t->row[i].name))
                s = tz_recipe_add_given(recipe, t->row[i].name);
    }
    return s;
}

static tz_status add_inputs(tz_recipe *recipe, const tz_record *r)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; s == TZ_OK && r && i < r->path.n; i++)
        s = tz_recipe_add_input(recipe, r->path.v[i], r->sha256.v[i]);
    return s;
}

tz_status tz_record_text(tz_cli *cli, const tz_record *r, const tz_record *extra,
                         const char *makes, char **out)
{
    if (cli->replay)
        return tz_strdup(cli->ctx, cli->replay->recipe, out);
    tz_recipe *recipe = NULL;
    const tz_command *c = cli->command;
    tz_status s = tz_recipe_new(cli->ctx, TZ_VERSION, c->name, &recipe);
    for (int32_t i = 0; s == TZ_OK && i < cli->operands; i++)
        s = tz_recipe_add_operand(recipe, cli->operand[i]);
    if (s == TZ_OK)
        s = add_options(cli, recipe);
    if (s == TZ_OK)
        s = add_inputs(recipe, r);
    if (s == TZ_OK)
        s = add_inputs(recipe, extra);
    if (s == TZ_OK)
        s = tz_recipe_text(recipe, makes, out);
    tz_recipe_free(recipe);
    return s;
}
