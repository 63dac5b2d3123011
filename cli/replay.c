/* SPDX-License-Identifier: Apache-2.0 */
/* Reads a recipe, finds its inputs (by name where the recipe says, then beside the file
 * that is replayed; always by their hashes) and runs its command again, once, for the one
 * output that the recipe is of. */
#include <limits.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/file.h"
#include "cli/exemplars.h"
#include "cli/figures.h"
#include "cli/material.h"

typedef struct replay_params {
    char inputs[TZ_PARAM_STRING_SIZE];
} replay_params;

typedef struct values {
    tz_common_params common;
    tz_output_params output;
    replay_params own;
} values;

static const tz_param own_rows[] = {
    {"inputs", TZ_PARAM_STRING, offsetof(replay_params, inputs), 0, 0, "", "FOLDER", NULL,
     "Folder to look for the inputs in, if they are not where they were."},
};
static const tz_param_table own_table = {"replay", "Where things are.", own_rows, 1,
                                         sizeof(replay_params)};

/* ---- inputs -------------------------------------------------------------------------
 */

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Tries one place; *changed tells that a file with another content stands there. */
static tz_status try_place(tz_cli *cli, const char *path, const char *sha256, bool *found,
                           bool *changed)
{
    char hex[65];
    *found = false;
    if (access(path, R_OK) != 0)
        return TZ_OK;
    tz_status s = tz_file_sha256(cli->ctx, path, hex);
    if (s != TZ_OK)
        return s;
    *found = strcmp(hex, sha256) == 0;
    *changed = *changed || !*found;
    return TZ_OK;
}

static tz_status find_input(tz_cli *cli, const char *path, const char *sha256, char **out)
{
    const values *v = cli->values;
    char origin[PATH_MAX], place[4][2 * PATH_MAX];
    int n = 0;
    bool found = false, changed = false;
    if (!*sha256)
        return tz_fail(cli->ctx, TZ_INVALID,
                       "%s: was made from standard input, which is "
                       "gone; it cannot be replayed",
                       cli->operand[0]);
    tz_path_folder(cli->operand[0], origin, sizeof origin);
    if (*v->own.inputs) {
        snprintf(place[n++], sizeof place[0], "%s/%s", v->own.inputs, path);
        snprintf(place[n++], sizeof place[0], "%s/%s", v->own.inputs, base_name(path));
    } else {
        snprintf(place[n++], sizeof place[0], "%s", path);
        if (*path != '/')
            snprintf(place[n++], sizeof place[0], "%s%s", origin, path);
        snprintf(place[n++], sizeof place[0], "%s%s", origin, base_name(path));
    }
    for (int i = 0; i < n; i++) {
        tz_status s = try_place(cli, place[i], sha256, &found, &changed);
        if (s != TZ_OK)
            return s;
        if (found)
            return tz_strdup(cli->ctx, place[i], out);
    }
    return tz_fail(
        cli->ctx, TZ_INVALID,
        changed ? "%s: has changed since %s was made (SHA-256 %.12s... is wanted); "
                  "restore it, or name its folder with --inputs"
                : "%s: input of %s is missing (SHA-256 %.12s...); put it back, or "
                  "name its folder with --inputs",
        path, cli->operand[0], sha256);
}

static tz_status find_inputs(tz_cli *cli, const tz_recipe *r, tz_replay *replay)
{
    int32_t n = tz_recipe_inputs(r);
    tz_status s = tz_alloc_zero(cli->ctx, &replay->path, (size_t)n, sizeof *replay->path);
    if (s == TZ_OK)
        s = tz_alloc_zero(cli->ctx, &replay->found, (size_t)n, sizeof *replay->found);
    for (; s == TZ_OK && replay->inputs < n;) {
        const char *path, *sha256;
        int32_t i = replay->inputs++;
        tz_recipe_input(r, i, &path, &sha256);
        s = find_input(cli, path, sha256, &replay->found[i]);
        if (s == TZ_OK)
            s = tz_strdup(cli->ctx, path, &replay->path[i]);
    }
    return s;
}

/* ---- command ------------------------------------------------------------------------
 */

/* An option of the command that is run again. It counts as given where it was, and where
 * its value is not the default: what the program chose then, or somebody has edited. */
static tz_status set_option(tz_cli *inner, const char *name, const char *text, bool given,
                            const char *source)
{
    char before[TZ_PARAM_STRING_SIZE + 1], after[TZ_PARAM_STRING_SIZE + 1];
    const tz_option_group *g;
    const tz_param *p = tz_command_option(inner->command, name, &g);
    if (!p)
        return tz_fail(inner->ctx, TZ_FORMAT,
                       "%s: its recipe has an option '%s' that this "
                       "terrazzo (%s) does not know; use the version that made it",
                       source, name, TZ_VERSION);
    char *values = (char *)inner->values + g->offset;
    tz_params_get(p, values, before, sizeof before);
    tz_status s = tz_params_set(inner->ctx, g->table, values, name, text);
    if (s != TZ_OK)
        return s;
    tz_params_get(p, values, after, sizeof after);
    return given || strcmp(before, after) != 0 ? tz_cli_give(inner, p) : TZ_OK;
}

/* "--output" of the inner command is a template: braces are doubled. */
static void escape(const char *path, char *out, size_t size)
{
    size_t n = 0;
    for (; *path && n + 3 < size; path++) {
        if (*path == '{' || *path == '}')
            out[n++] = *path;
        out[n++] = *path;
    }
    out[n] = 0;
}

static tz_status set_outputs(tz_cli *cli, tz_cli *inner, const char *makes,
                             const char *path)
{
    char text[2 * TZ_PARAM_STRING_SIZE];
    escape(path, text, sizeof text);
    const char *option = strcmp(inner->command->name, "expand") != 0 ? "output"
                         : strcmp(makes, "layout") == 0              ? "save-layout"
                                                                     : "output";
    tz_status s = set_option(inner, option, text, true, cli->operand[0]);
    /* Standard output has no extension: the format is that of the original. */
    if (s == TZ_OK && strcmp(path, "-") == 0 &&
        tz_command_option(inner->command, "format", NULL)) {
        const tz_format_params format = {.format = tz_format_of(cli->operand[0])};
        char name[32];
        tz_params_get(&tz_format_param_table.row[0], &format, name, sizeof name);
        s = set_option(inner, "format", name, true, cli->operand[0]);
    }
    return s;
}

/* name_replay.ext beside the original. */
static void default_output(const char *original, char *path, size_t size)
{
    char folder[PATH_MAX], stem[256];
    tz_path_folder(original, folder, sizeof folder);
    tz_path_stem(original, stem, sizeof stem);
    snprintf(path, size, "%s%s_replay.%s", folder, stem, tz_path_extension(original));
}

static void tell_sameness(tz_cli *cli, const char *path)
{
    char a[65], b[65];
    if (strcmp(path, "-") == 0 || tz_file_sha256(cli->ctx, cli->operand[0], a) != TZ_OK ||
        tz_file_sha256(cli->ctx, path, b) != TZ_OK)
        return;
    bool same = strcmp(a, b) == 0;
    tz_figures_count(cli, "identical", same);
    if (!same)
        tz_warn(cli->ctx,
                "%s: differs from %s, which was edited since, or made by another "
                "version",
                path, cli->operand[0]);
}

static tz_status run_again(tz_cli *cli, const tz_recipe *r, const char *text,
                           const char *path)
{
    tz_cli inner = {0};
    tz_replay replay = {.recipe = text, .makes = tz_recipe_makes(r)};
    const tz_command *c = tz_command_find(tz_recipe_command(r));
    int32_t n = tz_recipe_operands(r);
    char **operand = NULL;
    tz_status s = TZ_OK;
    if (!c || c == &tz_replay_command || n < c->min_operands ||
        (c->max_operands >= 0 && n > c->max_operands))
        return tz_fail(cli->ctx, TZ_FORMAT,
                       "%s: its recipe is broken: command '%s' with %d "
                       "operands",
                       cli->operand[0], tz_recipe_command(r), n);
    if (strcmp(tz_recipe_version(r), TZ_VERSION) != 0)
        tz_warn(cli->ctx, "%s: was made by version %s, this is %s; the bytes may differ",
                cli->operand[0], tz_recipe_version(r), TZ_VERSION);
    if ((s = tz_alloc_zero(cli->ctx, &operand, (size_t)n, sizeof *operand)) != TZ_OK ||
        (s = tz_cli_init(&inner, cli->ctx, c)) != TZ_OK ||
        (s = find_inputs(cli, r, &replay)) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < n; i++)
        operand[i] = (char *)tz_recipe_operand(r, i);
    inner.operand = operand;
    inner.operands = n;
    inner.figures = cli->figures;
    inner.replay = &replay;
    *(tz_common_params *)inner.values = *cli->common;
    for (int32_t i = 0; s == TZ_OK && i < tz_recipe_params(r); i++) {
        const char *name, *value;
        tz_recipe_param(r, i, &name, &value);
        s = set_option(&inner, name, value, tz_recipe_given(r, name), cli->operand[0]);
    }
    if (s == TZ_OK)
        s = set_outputs(cli, &inner, replay.makes, path);
    if (s == TZ_OK)
        s = c->run(&inner);
    cli->piped = inner.piped;
    cli->usage = inner.usage;
done:
    for (int32_t i = 0; i < replay.inputs; i++) {
        tz_free(cli->ctx, replay.path[i]);
        tz_free(cli->ctx, replay.found[i]);
    }
    tz_free(cli->ctx, replay.path);
    tz_free(cli->ctx, replay.found);
    tz_free(cli->ctx, operand);
    tz_cli_deinit(&inner);
    return s;
}

/* An exemplar document tells all by itself: its photo and the parameters. */
static tz_status exemplar_recipe(tz_cli *cli, char **text)
{
    tz_ebpt e = {0};
    tz_recipe *r = NULL;
    char *photo = NULL, sha256[65] = "";
    tz_status s = tz_ebpt_read(cli->ctx, cli->operand[0], &e, &photo, sha256);
    if (s == TZ_OK)
        s = tz_recipe_new(cli->ctx, TZ_VERSION, "analyze", &r);
    if (s == TZ_OK)
        s = tz_recipe_add_operand(r, photo);
    if (s == TZ_OK)
        s = tz_recipe_add_params(r, &tz_ebpt_param_table, &e.params);
    if (s == TZ_OK)
        s = tz_recipe_add_input(r, photo, sha256);
    if (s == TZ_OK)
        s = tz_recipe_text(r, "exemplar", text);
    tz_recipe_free(r);
    tz_free(cli->ctx, photo);
    tz_ebpt_deinit(&e);
    return s;
}

static tz_status check_output(tz_cli *cli, const char *path)
{
    tz_path_list in = {0}, out = {0};
    const char *was = tz_path_extension(cli->operand[0]), *is = tz_path_extension(path);
    tz_status s = tz_paths_add(cli->ctx, &in, cli->operand[0]);
    if (s == TZ_OK)
        s = tz_paths_add(cli->ctx, &out, path);
    if (s == TZ_OK)
        s = tz_outputs_check(cli->ctx, &in, &out);
    if (s == TZ_OK && strcmp(path, "-") != 0 && strcasecmp(was, "json") != 0 &&
        strcasecmp(was, is) != 0)
        s = tz_fail(cli->ctx, TZ_INVALID,
                    "%s: replay makes the same bytes again, so the name "
                    "must end in .%s",
                    path, was);
    tz_paths_free(cli->ctx, &in);
    tz_paths_free(cli->ctx, &out);
    return s;
}

static tz_status run(tz_cli *cli)
{
    const values *v = cli->values;
    char path[PATH_MAX + 512], *text = NULL;
    tz_recipe *r = NULL;
    const char *original = cli->operand[0];
    if (*v->output.output)
        snprintf(path, sizeof path, "%s", v->output.output);
    else
        default_output(original, path, sizeof path);
    tz_status s = check_output(cli, path);
    if (s == TZ_OK)
        s = tz_recipe_read(cli->ctx, original, &text);
    if (s == TZ_UNSUPPORTED)
        s = exemplar_recipe(cli, &text);
    if (s == TZ_OK)
        s = tz_recipe_parse(cli->ctx, original, text, &r);
    if (s == TZ_OK)
        s = run_again(cli, r, text, path);
    if (s == TZ_OK)
        tell_sameness(cli, path);
    tz_recipe_free(r);
    tz_free(cli->ctx, text);
    return s;
}

static const tz_option_group groups[] = {
    {&tz_common_param_table, offsetof(values, common), false},
    {&tz_output_param_table, offsetof(values, output), false},
    {&own_table, offsetof(values, own), false},
};
static const tz_example examples[] = {
    {"Make a texture again, and check that its bytes are the same:",
     "terrazzo replay rocks_big.png -o again.png && cmp rocks_big.png again.png"},
    {"After the photos have moved:", "terrazzo replay rocks_big.png --inputs ~/photos"},
};
const tz_command tz_replay_command = {
    .name = "replay",
    .operands = "FILE [-o OUTPUT]",
    .summary = "Makes an output again from the recipe in its metadata.",
    .about =
        "Every image and layout carries its recipe: version, options, seed, and the "
        "SHA-256 of each input. Replay checks the inputs and makes the same bytes again. "
        "Without -o it writes NAME_replay.EXT beside FILE. A JSON file with a recipe is "
        "taken too.",
    .min_operands = 1,
    .max_operands = 1,
    .group = groups,
    .groups = sizeof groups / sizeof groups[0],
    .example = examples,
    .examples = sizeof examples / sizeof examples[0],
    .size = sizeof(values),
    .run = run,
};
