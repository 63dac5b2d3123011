/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/names.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- templates -------------------------------------------------------------------- */

/* Text for one word, or NULL if there is no such word. */
static const char *word_value(const tz_name_values *v, const char *w, size_t n,
                              char number[32])
{
#define IS(text) (n == sizeof text - 1 && memcmp(w, text, n) == 0)
    if (IS("name"))
        return v->name;
    if (IS("ext"))
        return v->ext;
    if (IS("map"))
        return v->map;
    if (IS("seed"))
        snprintf(number, 32, "%llu", (unsigned long long)v->seed);
    else if (IS("width"))
        snprintf(number, 32, "%d", (int)v->width);
    else if (IS("height"))
        snprintf(number, 32, "%d", (int)v->height);
    else
        return NULL;
    return number;
#undef IS
}

tz_status tz_name_expand(tz_ctx *ctx, const char *text, const tz_name_values *v,
                         char **out)
{
    TZ_ARRAY(char)
    a = {0};
    tz_status s = TZ_OK;
    for (const char *p = text; s == TZ_OK && *p; p++) {
        if ((*p == '{' || *p == '}') && p[1] == *p) {
            s = tz_array_push(ctx, &a, *p);
            p++;
            continue;
        }
        if (*p != '{' && *p != '}') {
            s = tz_array_push(ctx, &a, *p);
            continue;
        }
        size_t n = *p == '{' ? strcspn(p + 1, "{}") : 0;
        char number[32];
        const char *value =
            *p == '{' && p[1 + n] == '}' ? word_value(v, p + 1, n, number) : NULL;
        if (!value) {
            s = tz_fail(ctx, TZ_INVALID,
                        "name '%s': '%.*s' is not a word for a name; there are {name}, "
                        "{seed}, {ext}, {width}, {height} and {map}, and {{ for a brace",
                        text, (int)n + 1 + (p[1 + n] == '}'), p);
            break;
        }
        for (; s == TZ_OK && *value; value++)
            s = tz_array_push(ctx, &a, *value);
        p += n + 1;
    }
    if (s == TZ_OK)
        s = tz_array_push(ctx, &a, (char)0);
    if (s == TZ_OK)
        *out = a.v;
    else
        tz_array_free(ctx, &a);
    return s;
}

bool tz_name_uses(const char *text, const char *word)
{
    size_t n = strlen(word);
    for (const char *p = strchr(text, '{'); p; p = strchr(p + 1, '{')) {
        if (p[1] == '{')
            p++;
        else if (strncmp(p + 1, word, n) == 0 && p[1 + n] == '}')
            return true;
    }
    return false;
}

/* ---- paths ------------------------------------------------------------------------ */

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

void tz_path_stem(const char *path, char *stem, size_t size)
{
    const char *b = strcmp(path, "-") == 0 ? "stdin" : base_name(path);
    const char *dot = strrchr(b, '.');
    int n = dot && dot > b ? (int)(dot - b) : (int)strlen(b);
    snprintf(stem, size, "%.*s", n, b);
}

const char *tz_path_extension(const char *path)
{
    const char *b = base_name(path), *dot = strrchr(b, '.');
    return dot && dot > b ? dot + 1 : "";
}

void tz_path_folder(const char *path, char *folder, size_t size)
{
    snprintf(folder, size, "%.*s", (int)(base_name(path) - path), path);
}

tz_status tz_path_relative(tz_ctx *ctx, const char *document, const char *file,
                           char **out)
{
    char folder[PATH_MAX], at[PATH_MAX], to[PATH_MAX], text[2 * PATH_MAX];
    tz_path_folder(document, folder, sizeof folder);
    if (!realpath(folder[0] ? folder : ".", at))
        return tz_fail(ctx, TZ_IO, "%s: no such folder (%s)", folder, strerror(errno));
    if (!realpath(file, to))
        return tz_fail(ctx, TZ_IO, "%s: cannot be found (%s)", file, strerror(errno));
    size_t common = 0; /* length of the shared leading folders, with their slash */
    size_t n = strlen(at);
    if (n + 1 < sizeof at && at[n - 1] != '/')
        at[n] = '/', at[n + 1] = 0;
    for (size_t i = 0; at[i] && at[i] == to[i]; i++)
        if (at[i] == '/')
            common = i + 1;
    size_t k = 0;
    for (const char *p = at + common; *p; p++)
        if (*p == '/' && k + 4 < sizeof text)
            k += (size_t)snprintf(text + k, sizeof text - k, "../");
    snprintf(text + k, sizeof text - k, "%s", to + common);
    return tz_strdup(ctx, text, out);
}

/* ---- seeds ------------------------------------------------------------------------ */

enum { MOST_SEEDS = 100000 };

static bool seed(const char **p, uint64_t *v)
{
    if (**p < '0' || **p > '9')
        return false;
    char *end;
    errno = 0;
    *v = strtoull(*p, &end, 10);
    *p = end;
    return errno == 0;
}

tz_status tz_seeds_parse(tz_ctx *ctx, const char *text, tz_seed_list *out)
{
    const char *p = text;
    for (;;) {
        uint64_t a, b;
        if (!seed(&p, &a))
            break;
        b = a;
        if (p[0] == '.' && p[1] == '.' && (p += 2, !seed(&p, &b)))
            break;
        if (b < a || b - a >= MOST_SEEDS || out->n + (int64_t)(b - a) >= MOST_SEEDS)
            return tz_fail(
                ctx, TZ_INVALID,
                "--seeds %s: from %llu to %llu is not a range of 1 to %d seeds", text,
                (unsigned long long)a, (unsigned long long)b, MOST_SEEDS);
        for (uint64_t v = a;; v++) {
            tz_status s = tz_array_push(ctx, out, v);
            if (s != TZ_OK)
                return s;
            if (v == b)
                break;
        }
        if (!*p)
            return TZ_OK;
        if (*p++ != ',')
            break;
    }
    return tz_fail(ctx, TZ_INVALID,
                   "--seeds %s: not a list of seeds; write 1..8, or 1,4,10..12", text);
}

/* ---- outputs ---------------------------------------------------------------------- */

tz_status tz_paths_add(tz_ctx *ctx, tz_path_list *l, const char *path)
{
    char *copy = NULL;
    tz_status s = tz_strdup(ctx, path, &copy);
    if (s == TZ_OK)
        s = tz_array_push(ctx, l, copy);
    if (s != TZ_OK)
        tz_free(ctx, copy);
    return s;
}

void tz_paths_free(tz_ctx *ctx, tz_path_list *l)
{
    for (int32_t i = 0; i < l->n; i++)
        tz_free(ctx, l->v[i]);
    tz_array_free(ctx, l);
}

/* Path with its folder made absolute, so that two spellings of one file compare equal. */
static void canonical(const char *path, char out[2 * PATH_MAX])
{
    char folder[PATH_MAX], real[PATH_MAX];
    tz_path_folder(path, folder, sizeof folder);
    if (realpath(folder[0] ? folder : ".", real))
        snprintf(out, 2 * PATH_MAX, "%s/%s", real, base_name(path));
    else
        snprintf(out, 2 * PATH_MAX, "%s", path);
}

static bool is_device(const char *path)
{
    struct stat st;
    return strcmp(path, "-") == 0 ||
           (stat(path, &st) == 0 && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode));
}

static tz_status check_place(tz_ctx *ctx, const char *path)
{
    struct stat st;
    char folder[PATH_MAX];
    if (!*path)
        return tz_fail(ctx, TZ_INVALID, "an output's name is empty; give -o a file name");
    if (strlen(path) >= PATH_MAX)
        return tz_fail(ctx, TZ_INVALID, "%.40s...: the name is too long", path);
    tz_path_folder(path, folder, sizeof folder);
    bool exists = stat(path, &st) == 0;
    if ((exists && S_ISDIR(st.st_mode)) || !*base_name(path))
        return tz_fail(ctx, TZ_IO,
                       "%s: is a folder; give a file name in it, such as %s%sout.png",
                       path, path, *base_name(path) ? "/" : "");
    if (is_device(path))
        return TZ_OK;
    const char *at = folder[0] ? folder : ".";
    if (stat(at, &st) != 0)
        return tz_fail(ctx, TZ_IO, "%s: folder %s: %s; make it first", path, at,
                       strerror(errno));
    if (!S_ISDIR(st.st_mode))
        return tz_fail(ctx, TZ_IO, "%s: %s is not a folder", path, at);
    if (access(at, W_OK | X_OK) != 0)
        return tz_fail(ctx, TZ_IO, "%s: folder %s cannot be written to (%s)", path, at,
                       strerror(errno));
    return TZ_OK;
}

tz_status tz_outputs_check(tz_ctx *ctx, const tz_path_list *inputs,
                           const tz_path_list *outputs)
{
    char a[2 * PATH_MAX], b[2 * PATH_MAX];
    for (int32_t i = 0; i < outputs->n; i++) {
        const char *o = outputs->v[i];
        tz_status s = check_place(ctx, o);
        if (s != TZ_OK)
            return s;
        struct stat so, si;
        bool exists = strcmp(o, "-") != 0 && stat(o, &so) == 0;
        for (int32_t k = 0; exists && k < inputs->n; k++)
            if (strcmp(inputs->v[k], "-") != 0 && stat(inputs->v[k], &si) == 0 &&
                so.st_dev == si.st_dev && so.st_ino == si.st_ino && S_ISREG(so.st_mode))
                return tz_fail(
                    ctx, TZ_INVALID,
                    "%s: is also an input; it is not overwritten, give another "
                    "output name",
                    o);
        bool device = is_device(o) && strcmp(o, "-") != 0;
        canonical(o, a);
        for (int32_t k = 0; !device && k < i; k++) {
            canonical(outputs->v[k], b);
            if (strcmp(o, outputs->v[k]) == 0 || strcmp(a, b) == 0)
                return tz_fail(ctx, TZ_INVALID,
                               "%s: would be written twice in this run; tell the outputs "
                               "apart by {seed} or {map} in their names",
                               o);
        }
    }
    return TZ_OK;
}
