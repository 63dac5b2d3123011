/* SPDX-License-Identifier: Apache-2.0 */
/* Completion scripts, made from the tables. They are printed when Terrazzo is installed,
 * so they always fit the command that they complete. */
#include <string.h>

#include "cli/help.h"

/* What follows an option: nothing, one of some words, a file, or free text. */
typedef enum value_kind {
    VALUE_NONE,
    VALUE_WORDS,
    VALUE_FILE,
    VALUE_FOLDER,
    VALUE_FREE
} value_kind;

static value_kind kind_of(const tz_param *p)
{
    if (p->type == TZ_PARAM_BOOL)
        return VALUE_NONE;
    if (p->type == TZ_PARAM_ENUM)
        return VALUE_WORDS;
    if (p->type == TZ_PARAM_STRING && p->unit && strcmp(p->unit, "FILE") == 0)
        return VALUE_FILE;
    if (p->type == TZ_PARAM_STRING && p->unit && strcmp(p->unit, "FOLDER") == 0)
        return VALUE_FOLDER;
    return VALUE_FREE;
}

/* choices "a|b" with blanks between */
static void print_words(FILE *f, const char *choices)
{
    for (; *choices; choices++)
        fputc(*choices == '|' ? ' ' : *choices, f);
}

typedef void (*on_option)(FILE *f, const tz_param *p);

static void each_option(const tz_command *c, on_option call, FILE *f)
{
    for (int32_t g = 0; g < c->groups; g++)
        for (int32_t i = 0; i < c->group[g].table->n; i++)
            call(f, &c->group[g].table->row[i]);
}

/* ---- bash ---------------------------------------------------------------------------
 */

static void bash_name(FILE *f, const tz_param *p)
{
    fprintf(f, " --%s", p->name);
    if (tz_name_letter(p->name))
        fprintf(f, " -%c", tz_name_letter(p->name));
}

static void bash_value(FILE *f, const tz_param *p)
{
    value_kind k = kind_of(p);
    if (k == VALUE_NONE)
        return;
    fprintf(f, "    --%s", p->name);
    if (tz_name_letter(p->name))
        fprintf(f, "|-%c", tz_name_letter(p->name));
    fprintf(f, ") ");
    if (k == VALUE_WORDS) {
        fprintf(f, "COMPREPLY=($(compgen -W \"");
        print_words(f, p->choices);
        fprintf(f, "\" -- \"$cur\"))");
    } else if (k == VALUE_FILE) {
        fprintf(f, "COMPREPLY=($(compgen -f -- \"$cur\"))");
    } else if (k == VALUE_FOLDER) {
        fprintf(f, "COMPREPLY=($(compgen -d -- \"$cur\"))");
    } else {
        fprintf(f, ":");
    }
    fprintf(f, "; return ;;\n");
}

void tz_help_bash(FILE *f)
{
    fprintf(
        f,
        "# bash completion for terrazzo, made by \"terrazzo params --format bash\"\n"
        "_terrazzo() {\n"
        "  local cur=\"${COMP_WORDS[COMP_CWORD]}\" prev=\"${COMP_WORDS[COMP_CWORD-1]}\"\n"
        "  local word cmd=\n"
        "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
        "    case $word in -*) ;; *) cmd=$word; break ;; esac\n"
        "  done\n"
        "  compopt -o filenames 2>/dev/null\n"
        "  case $cmd in\n");
    for (int32_t c = 0; c < tz_command_count; c++) {
        fprintf(f, "  %s)\n    case $prev in\n", tz_command_list[c]->name);
        each_option(tz_command_list[c], bash_value, f);
        fprintf(f, "    esac\n    if [[ $cur == -* ]]; then\n"
                   "      COMPREPLY=($(compgen -W \"");
        each_option(tz_command_list[c], bash_name, f);
        fprintf(f, "\" -- \"$cur\"))\n    else\n"
                   "      COMPREPLY=($(compgen -f -- \"$cur\"))\n    fi ;;\n");
    }
    fprintf(f, "  *) COMPREPLY=($(compgen -W \"help --help --version");
    for (int32_t c = 0; c < tz_command_count; c++)
        fprintf(f, " %s", tz_command_list[c]->name);
    fprintf(f, "\" -- \"$cur\")) ;;\n  esac\n}\ncomplete -F _terrazzo terrazzo\n");
}

/* ---- zsh ----------------------------------------------------------------------------
 */

/* Help text inside '...[...]': quotes, brackets and colons made harmless. */
static void zsh_text(FILE *f, const char *text)
{
    for (; *text; text++) {
        if (*text == '\'')
            fputs("'\\''", f);
        else if (strchr("[]:\\", *text))
            fprintf(f, "\\%c", *text);
        else
            fputc(*text, f);
    }
}

static void zsh_spec(FILE *f, const tz_param *p, const char *dashes, const char *name)
{
    value_kind k = kind_of(p);
    fprintf(f, "    '*%s%s%s[", dashes, name,
            k == VALUE_NONE             ? ""
            : strcmp(dashes, "--") == 0 ? "="
                                        : "+");
    zsh_text(f, p->help);
    fprintf(f, "]");
    if (k == VALUE_WORDS) {
        fprintf(f, ":%s:(", p->name);
        print_words(f, p->choices);
        fprintf(f, ")");
    } else if (k == VALUE_FILE) {
        fprintf(f, ":%s:_files", p->name);
    } else if (k == VALUE_FOLDER) {
        fprintf(f, ":%s:_files -/", p->name);
    } else if (k == VALUE_FREE) {
        fprintf(f, ":%s:", p->name);
    }
    fprintf(f, "' \\\n");
}

static void zsh_option(FILE *f, const tz_param *p)
{
    char letter[2] = {tz_name_letter(p->name), 0};
    zsh_spec(f, p, "--", p->name);
    if (*letter)
        zsh_spec(f, p, "-", letter);
}

void tz_help_zsh(FILE *f)
{
    fprintf(f, "#compdef terrazzo\n"
               "# made by \"terrazzo params --format zsh\"\n"
               "local -a commands\ncommands=(\n");
    for (int32_t c = 0; c < tz_command_count; c++) {
        fprintf(f, "  '%s:", tz_command_list[c]->name);
        zsh_text(f, tz_command_list[c]->summary);
        fprintf(f, "'\n");
    }
    fprintf(f,
            ")\nif (( CURRENT == 2 )); then\n  _describe command commands\n  return\nfi\n"
            "local cmd=$words[2]\nshift words; (( CURRENT-- ))\ncase $cmd in\n");
    for (int32_t c = 0; c < tz_command_count; c++) {
        fprintf(f, "  %s)\n    _arguments -S \\\n", tz_command_list[c]->name);
        each_option(tz_command_list[c], zsh_option, f);
        fprintf(f, "    '*:file:_files' ;;\n");
    }
    fprintf(f, "esac\n");
}
