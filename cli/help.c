/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/help.h"

#include <stdlib.h>
#include <string.h>

/* Paragraphs filled to 80 columns behind an indent. */
static void print_filled(FILE *f, const char *text, int indent)
{
    int column = 0;
    while (*text) {
        if (text[0] == '\n' && text[1] == '\n') {
            fprintf(f, "\n\n");
            column = 0;
            text += 2;
            continue;
        }
        size_t n = strcspn(text, " \n");
        if (column && column + 1 + (int)n > 80) {
            fputc('\n', f);
            column = 0;
        }
        if (column == 0)
            column = fprintf(f, "%*s%.*s", indent, "", (int)n, text);
        else
            column += fprintf(f, " %.*s", (int)n, text);
        text += n;
        if (*text == ' ')
            text++;
    }
    fputc('\n', f);
}

/* A table as text, its long lines folded behind the column of the explanations. */
static void print_table(const tz_param_table *t, FILE *f)
{
    char *text = NULL;
    size_t size = 0;
    FILE *m = open_memstream(&text, &size);
    if (!m)
        return;
    tz_params_print_text(t, m);
    fclose(m);
    enum { HANG = 31, WIDTH = 96 };
    for (const char *line = text; text && *line; line += *line == '\n') {
        int room = WIDTH, left = (int)strcspn(line, "\n");
        while (left > room) {
            int cut = room;
            while (cut > 0 && line[cut] != ' ')
                cut--;
            if (cut == 0)
                break;
            fprintf(f, "%.*s\n%*s", cut, line, HANG, "");
            line += cut + 1;
            left -= cut + 1;
            room = WIDTH - HANG;
        }
        fprintf(f, "%.*s\n", left, line);
        line += left;
    }
    free(text);
}

void tz_help_overview(FILE *f)
{
    fprintf(f,
            "Terrazzo %s makes large textures from small photos.\n\n"
            "Use: terrazzo COMMAND [OPTIONS]\n\n",
            TZ_VERSION);
    for (int32_t i = 0; i < tz_command_count; i++)
        fprintf(f, "  %-8s  %s\n", tz_command_list[i]->name, tz_command_list[i]->summary);
    fprintf(f, "\nThe first thing to try:\n\n  %s\n\n",
            tz_expand_command.example[0].command);
    fprintf(
        f,
        "\"terrazzo help COMMAND\" tells about one of them, \"terrazzo --version\" the "
        "version.\n");
}

void tz_help_command(const tz_command *c, FILE *f)
{
    fprintf(f, "%s\n\nUse: terrazzo %s %s [OPTIONS]\n\n", c->summary, c->name,
            c->operands);
    print_filled(f, c->about, 0);
    fprintf(f, "\nExamples:\n");
    for (int32_t i = 0; i < c->examples; i++)
        fprintf(f, "\n  %s\n    %s\n", c->example[i].text, c->example[i].command);
    for (int32_t g = c->groups - 1; g >= 0; g--) {
        /* the command's own options first, the common ones last */
        const tz_param_table *t = c->group[g == 0 ? 0 : c->groups - g].table;
        fprintf(f, "\n");
        print_table(t, f);
    }
    fprintf(f, "\nIn short:");
    for (int32_t i = 0; i < tz_letter_count; i++)
        if (tz_command_option(c, tz_letter_list[i].name, NULL))
            fprintf(f, " -%c = --%s%s", tz_letter_list[i].letter, tz_letter_list[i].name,
                    i + 1 < tz_letter_count ? "," : "");
    fprintf(f, "; --no-NAME switches a switch off; -- ends the options.\n");
}

/* ---- manual page --------------------------------------------------------------------
 */

/* Text with roff's own characters made harmless. */
static void print_roff(FILE *f, const char *text)
{
    for (bool start = true; *text; text++) {
        if (start && (*text == '.' || *text == '\''))
            fputs("\\&", f);
        start = *text == '\n';
        if (*text == '\\')
            fputs("\\e", f);
        else if (*text == '-')
            fputs("\\-", f);
        else if (text[0] == '\n' && text[1] == '\n')
            fputs("\n.PP", f);
        else
            fputc(*text, f);
    }
}

/* Whether an earlier command has the table too: it is described once. */
static bool seen(int32_t command, int32_t group)
{
    const tz_param_table *t = tz_command_list[command]->group[group].table;
    for (int32_t c = 0; c <= command; c++)
        for (int32_t g = 0; g < tz_command_list[c]->groups; g++) {
            if (c == command && g == group)
                return false;
            if (tz_command_list[c]->group[g].table == t)
                return true;
        }
    return false;
}

static void man_command(const tz_command *c, FILE *f)
{
    fprintf(f, ".SS \"terrazzo %s ", c->name);
    print_roff(f, c->operands);
    fprintf(f, "\"\n%s\n.PP\n", c->summary);
    print_roff(f, c->about);
    fprintf(f, "\n.PP\nOptions:");
    for (int32_t g = 1; g <= c->groups; g++)
        fprintf(f, " %s%s", c->group[g % c->groups].table->name,
                g < c->groups ? "," : ".\n");
    for (int32_t i = 0; i < c->examples; i++) {
        fprintf(f, ".PP\n%s\n.PP\n.RS 4\n.nf\n", c->example[i].text);
        print_roff(f, c->example[i].command);
        fprintf(f, "\n.fi\n.RE\n");
    }
}

void tz_help_man(FILE *f)
{
    fprintf(f,
            ".TH TERRAZZO 1 \"\" \"Terrazzo %s\" \"User Commands\"\n.SH NAME\n"
            "terrazzo \\- make large textures from small photos\n.SH SYNOPSIS\n",
            TZ_VERSION);
    for (int32_t i = 0; i < tz_command_count; i++) {
        fprintf(f, ".B terrazzo %s\n", tz_command_list[i]->name);
        print_roff(f, tz_command_list[i]->operands);
        fprintf(f, "\n[\\fIOPTIONS\\fR]\n.br\n");
    }
    fprintf(f, ".SH COMMANDS\n");
    for (int32_t i = 0; i < tz_command_count; i++)
        man_command(tz_command_list[i], f);
    fprintf(
        f,
        ".SH OPTIONS\nOptions may stand anywhere; \\-\\-name=value and \\-\\-name value "
        "are the same, \\-\\-no\\-name switches a switch off, and \\-\\- ends the "
        "options.\nThe last of several values of one option holds.\n");
    for (int32_t i = 0; i < tz_letter_count; i++)
        fprintf(f, "\\-%c is short for \\-\\-%s.\n", tz_letter_list[i].letter,
                tz_letter_list[i].name);
    for (int32_t c = 0; c < tz_command_count; c++)
        for (int32_t g = 0; g < tz_command_list[c]->groups; g++)
            if (!seen(c, g)) {
                const tz_param_table *t = tz_command_list[c]->group[g].table;
                fprintf(f, ".SS %s\n%s\n", t->name, t->summary);
                tz_params_print_man(t, f);
            }
    fprintf(
        f,
        ".SH \"EXIT STATUS\"\n.TP\n0\nDone.\n.TP\n1\nAn input, an output or an option's "
        "value is not usable; one line on standard error says what, where and what to "
        "do.\n"
        ".TP\n2\nThe command line is not understood.\n.TP\n130\nCancelled by an "
        "interrupt. "
        "A second interrupt ends at once.\n.PP\nNo output ever stands under its final "
        "name "
        "before it is complete.\n"
        ".SH RECIPES\nImages and layouts carry a recipe in their metadata: version, "
        "command, options, seed and the SHA\\-256 of every input. "
        "\\fBterrazzo replay\\fR makes the same bytes again from it.\n"
        ".SH LIMITS\nAn image side is at most 1,000,000 pixels. Text values are at most "
        "1,023 bytes.\n");
}

void tz_help_schema(const tz_command *c, FILE *f)
{
    fprintf(f,
            "{\"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n"
            "\"title\": \"terrazzo %s\", \"type\": \"object\", \"properties\": {\n",
            c->name);
    for (int32_t g = 0; g < c->groups; g++) {
        fprintf(f, "\"%s\": ", c->group[g].table->name);
        tz_params_print_schema(c->group[g].table, f);
        fprintf(f, "%s", g + 1 < c->groups ? ",\n" : "\n");
    }
    fprintf(f, "}}\n");
}
