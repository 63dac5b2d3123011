/* SPDX-License-Identifier: Apache-2.0 */
/* The layers: reads every #include of ours and fails on one that points up or across, and
 * on a source file without its licence line. */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* From the ground up; what a folder may include, as letters of folders. */
static const struct {
    const char *name, *may;
} folders[] = {
    {"base", "base"},
    {"elements", "base elements"},
    {"fields", "base elements fields"},
    {"curves", "base elements curves"},
    {"scenes", "base scenes"},
    {"analysis", "base elements curves scenes analysis"},
    {"synthesis", "base elements curves scenes analysis synthesis"},
    {"cli", "base elements fields curves scenes analysis synthesis cli"},
    {"viewer", "base elements fields curves scenes analysis synthesis viewer"},
};
enum { FOLDERS = sizeof folders / sizeof *folders };

static int is_folder(const char *word, size_t n)
{
    for (int i = 0; i < FOLDERS; i++)
        if (strlen(folders[i].name) == n && strncmp(folders[i].name, word, n) == 0)
            return 1;
    return 0;
}

static int listed(const char *list, const char *word, size_t n)
{
    for (const char *p = list; (p = strstr(p, word)) != NULL; p++)
        if ((p == list || p[-1] == ' ') && (p[n] == ' ' || p[n] == 0))
            return 1;
    return 0;
}

static int check_file(const char *path, const char *may)
{
    char line[1000], folder[64];
    int bad = 0, spdx = 0, number = 0;
    FILE *f = fopen(path, "r");
    assert_non_null(f);
    while (fgets(line, sizeof line, f)) {
        number++;
        if (number <= 3 && strstr(line, "SPDX-License-Identifier: Apache-2.0"))
            spdx = 1;
        const char *p = line + strspn(line, " \t");
        if (strncmp(p, "#include", 8) != 0)
            continue;
        p = strpbrk(p, "\"<");
        if (!p)
            continue;
        char quote = *p++;
        size_t n = strcspn(p, "/");
        if (p[n] != '/' || n >= sizeof folder) {
            if (quote == '"') {
                fprintf(stderr, "%s:%d: include from the repository's root\n", path,
                        number);
                bad++;
            }
            continue;
        }
        if (!is_folder(p, n)) /* a library's own folder */
            continue;
        memcpy(folder, p, n);
        folder[n] = 0;
        if (!listed(may, folder, n)) {
            fprintf(stderr, "%s:%d: %s/ is not below this folder\n", path, number,
                    folder);
            bad++;
        }
    }
    fclose(f);
    if (!spdx) {
        fprintf(stderr, "%s: no SPDX line\n", path);
        bad++;
    }
    return bad;
}

static int is_source(const char *name)
{
    const char *dot = strrchr(name, '.');
    return dot && (!strcmp(dot, ".c") || !strcmp(dot, ".h") || !strcmp(dot, ".cpp") ||
                   !strcmp(dot, ".hpp"));
}

static int check_folder(const char *folder, const char *may, int *files)
{
    char path[2000];
    int bad = 0;
    snprintf(path, sizeof path, "%s/%s", TZ_SOURCE_DIR, folder);
    DIR *dir = opendir(path);
    if (!dir)
        return 0;
    for (struct dirent *e; (e = readdir(dir)) != NULL;) {
        if (e->d_name[0] == '.' || !is_source(e->d_name))
            continue;
        snprintf(path, sizeof path, "%s/%s/%s", TZ_SOURCE_DIR, folder, e->d_name);
        bad += check_file(path, may);
        ++*files;
    }
    closedir(dir);
    return bad;
}

static void includes_point_down(void **state)
{
    (void)state;
    int files = 0, bad = 0;
    for (int i = 0; i < FOLDERS; i++)
        bad += check_folder(folders[i].name, folders[i].may, &files);
    assert_true(files > 20);
    assert_int_equal(bad, 0);
}

static void tests_include_from_the_root(void **state)
{
    (void)state;
    static const char *const all =
        "base elements fields curves scenes analysis synthesis cli viewer tests";
    static const char *const dirs[] = {
        "tests",        "tests/base",   "tests/elements", "tests/fields",
        "tests/curves", "tests/scenes", "tests/analysis", "tests/synthesis",
        "tests/cli",    "tests/fuzz",   "tests/bench"};
    int files = 0, bad = 0;
    for (size_t i = 0; i < sizeof dirs / sizeof *dirs; i++)
        bad += check_folder(dirs[i], all, &files);
    assert_int_equal(bad, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(includes_point_down),
        cmocka_unit_test(tests_include_from_the_root),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
