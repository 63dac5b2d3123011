/* SPDX-License-Identifier: Apache-2.0 */
/* One pass over argv. An argument is an option if it begins with "-" and is longer than
 * that; its row in the command's tables says whether a value follows. Where a name stands
 * in several of a command's tables (a seed, say), all of them get the value. */
#include "cli/options.h"

#include <stdlib.h>
#include <string.h>

/* ---- near misses ------------------------------------------------------------------ */

enum { LONGEST = 64 };

/* Edits (insert, delete, replace, swap neighbours) between two words. */
static int edits(const char *a, const char *b)
{
    int n = (int)strlen(a), m = (int)strlen(b), d[3][LONGEST + 1];
    if (n > LONGEST || m > LONGEST)
        return LONGEST;
    for (int j = 0; j <= m; j++)
        d[0][j] = j;
    for (int i = 1; i <= n; i++) {
        int *row = d[i % 3], *up = d[(i + 2) % 3], *up2 = d[(i + 1) % 3];
        row[0] = i;
        for (int j = 1; j <= m; j++) {
            int best = up[j - 1] + (a[i - 1] != b[j - 1]);
            if (up[j] + 1 < best)
                best = up[j] + 1;
            if (row[j - 1] + 1 < best)
                best = row[j - 1] + 1;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
                up2[j - 2] + 1 < best)
                best = up2[j - 2] + 1;
            row[j] = best;
        }
    }
    return d[n % 3][m];
}

const char *tz_options_nearest(const char *word, const char *const *list, int32_t n)
{
    const char *best = NULL;
    int length = (int)strlen(word), least = length < 4 ? 2 : length / 3 + 1;
    for (int32_t i = 0; i < n; i++) {
        bool begun = length >= 2 && strncmp(word, list[i], (size_t)length) == 0;
        int e = begun ? 0 : edits(word, list[i]);
        if (e < least && e < length)
            least = e, best = list[i];
    }
    return best;
}

static const char *nearest_option(const tz_command *c, const char *name)
{
    const char *list[256];
    int32_t n = 0;
    for (int32_t g = 0; g < c->groups; g++)
        for (int32_t i = 0; i < c->group[g].table->n && n < 256; i++)
            list[n++] = c->group[g].table->row[i].name;
    return tz_options_nearest(name, list, n);
}

/* ---- parsing ---------------------------------------------------------------------- */

/* "--name=value", "--name", "-ovalue" or "-o" taken apart. */
typedef struct split {
    char name[LONGEST];
    const char *value; /* NULL if none is attached */
} split;

static bool is_option(const char *arg) { return arg[0] == '-' && arg[1]; }

static void take_apart(const char *arg, split *s)
{
    s->value = NULL;
    if (arg[1] != '-') {
        const char *name = tz_letter_name(arg[1]);
        char letter[2] = {arg[1], 0};
        snprintf(s->name, sizeof s->name, "%s", name ? name : letter);
        if (arg[2])
            s->value = arg + 2 + (arg[2] == '=');
        return;
    }
    const char *eq = strchr(arg, '=');
    size_t n = eq ? (size_t)(eq - arg) - 2 : strlen(arg) - 2;
    if (n >= sizeof s->name)
        n = sizeof s->name - 1;
    memcpy(s->name, arg + 2, n);
    s->name[n] = 0;
    if (eq)
        s->value = eq + 1;
}

int tz_options_command(int argc, char **argv)
{
    for (int i = 1; i < argc; i++) {
        if (!is_option(argv[i]))
            return i;
        if (strcmp(argv[i], "--") == 0)
            return i + 1 < argc ? i + 1 : 0;
        split s;
        take_apart(argv[i], &s);
        for (int32_t c = 0; c < tz_command_count && !s.value; c++) {
            const tz_param *p = tz_command_option(tz_command_list[c], s.name, NULL);
            if (p && p->type != TZ_PARAM_BOOL) {
                i++;
                break;
            }
        }
    }
    return 0;
}

static tz_parse_result unknown(tz_cli *cli, const char *arg, const char *name)
{
    const tz_command *c = cli->command;
    const char *near = nearest_option(c, name);
    int n = (int)strcspn(arg, "=");
    if (near)
        tz_fail(cli->ctx, TZ_INVALID, "%s: unknown option %.*s; did you mean --%s?",
                c->name, n, arg, near);
    else
        tz_fail(cli->ctx, TZ_INVALID,
                "%s: unknown option %.*s; \"terrazzo help %s\" lists them", c->name, n,
                arg, c->name);
    return TZ_PARSE_USAGE;
}

/* Sets the option in every table of the command that has it. */
static tz_parse_result set(tz_cli *cli, const char *name, const char *value)
{
    const tz_command *c = cli->command;
    for (int32_t g = 0; g < c->groups; g++) {
        const tz_param *p = tz_params_find(c->group[g].table, name);
        if (!p)
            continue;
        void *s = (char *)cli->values + c->group[g].offset;
        if (tz_params_set(cli->ctx, c->group[g].table, s, name, value) != TZ_OK ||
            tz_cli_give(cli, p) != TZ_OK)
            return TZ_PARSE_VALUE;
    }
    return TZ_PARSE_OK;
}

/* Handles argv[*i]; moves *i on to the value that it eats. */
static tz_parse_result option(tz_cli *cli, int argc, char **argv, int skip, int *i)
{
    const tz_command *c = cli->command;
    const char *arg = argv[*i];
    split s;
    take_apart(arg, &s);
    const tz_param *p = tz_command_option(c, s.name, NULL);
    bool no = !p && strncmp(s.name, "no-", 3) == 0;
    if (no) {
        p = tz_command_option(c, s.name + 3, NULL);
        if (p && p->type != TZ_PARAM_BOOL)
            p = NULL;
    }
    if (!p)
        return unknown(cli, arg, s.name);
    if (p->type == TZ_PARAM_BOOL) {
        if (no && s.value) {
            tz_fail(cli->ctx, TZ_INVALID, "%s: --no-%s takes no value", c->name, p->name);
            return TZ_PARSE_USAGE;
        }
        if (arg[1] != '-' && s.value) {
            tz_fail(cli->ctx, TZ_INVALID, "%s: -%c takes no value; write letters apart",
                    c->name, arg[1]);
            return TZ_PARSE_USAGE;
        }
        return set(cli, p->name, no ? "false" : s.value ? s.value : "true");
    }
    if (!s.value) {
        int next = *i + 1 + (*i + 1 == skip);
        split t = {.name = ""};
        if (next < argc && strncmp(argv[next], "--", 2) == 0)
            take_apart(argv[next], &t);
        if (next >= argc || (t.name[0] && tz_command_option(c, t.name, NULL))) {
            char metavar[256];
            tz_option_metavar(p, metavar, sizeof metavar);
            tz_fail(cli->ctx, TZ_INVALID, "%s: --%s needs a value: --%s %s", c->name,
                    p->name, p->name, metavar);
            return TZ_PARSE_USAGE;
        }
        s.value = argv[next];
        *i = next;
    }
    return set(cli, p->name, s.value);
}

tz_parse_result tz_options_parse(tz_cli *cli, int argc, char **argv, int command)
{
    const tz_command *c = cli->command;
    bool ended = false;
    cli->operand = argv;
    cli->operands = 0;
    for (int i = 1; i < argc; i++) {
        if (i == command)
            continue;
        if (!ended && strcmp(argv[i], "--") == 0) {
            ended = true;
        } else if (!ended && is_option(argv[i])) {
            tz_parse_result r = option(cli, argc, argv, command, &i);
            if (r != TZ_PARSE_OK)
                return r;
        } else {
            argv[cli->operands++] = argv[i]; /* never beyond i: argv[0] came free */
        }
    }
    if (cli->common->help)
        return TZ_PARSE_OK;
    if (cli->operands < c->min_operands) {
        tz_fail(cli->ctx, TZ_INVALID, "%s: something is missing; use: terrazzo %s %s",
                c->name, c->name, c->operands);
        return TZ_PARSE_USAGE;
    }
    if (c->max_operands >= 0 && cli->operands > c->max_operands) {
        tz_fail(cli->ctx, TZ_INVALID, "%s: '%s' is too much; use: terrazzo %s %s",
                c->name, cli->operand[c->max_operands], c->name, c->operands);
        return TZ_PARSE_USAGE;
    }
    return TZ_PARSE_OK;
}
