/* SPDX-License-Identifier: Apache-2.0 */
/* The terrazzo command: finds the subcommand, parses its options, runs it, and turns its
 * status into one line on standard error and an exit code:
 * 0 done, 1 bad input, 2 bad usage, 130 cancelled. */
#include <errno.h>
#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "cli/figures.h"
#include "cli/help.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "synthesis/expand.h"

enum { EXIT_DONE = 0, EXIT_BAD = 1, EXIT_USAGE = 2, EXIT_CANCELLED = 130 };

/* ---- signals ------------------------------------------------------------------------
 */

static tz_ctx *volatile running; /* the context that a signal cancels */
static volatile sig_atomic_t signals;

static void on_signal(int number)
{
    (void)number;
    if (signals++ == 0 && running) {
        tz_ctx_cancel(running);
        return;
    }
    tz_file_cleanup();
    _exit(EXIT_CANCELLED);
}

static void catch_signals(tz_ctx *ctx)
{
    struct sigaction a = {.sa_handler = on_signal};
    static const int end[] = {SIGINT, SIGTERM, SIGHUP};
    running = ctx;
    sigemptyset(&a.sa_mask);
    a.sa_flags = SA_RESTART;
    for (size_t i = 0; i < sizeof end / sizeof end[0]; i++) {
        struct sigaction old;
        if (sigaction(end[i], NULL, &old) == 0 && old.sa_handler != SIG_IGN)
            sigaction(end[i], &a, NULL);
    }
    /* A closed pipe or a file-size limit is a write error like any other. */
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
}

/* ---- run ----------------------------------------------------------------------------
 */

static int complain(const tz_ctx *ctx, tz_status s)
{
    const char *message = tz_ctx_message(ctx);
    fprintf(stderr, "terrazzo: %s\n", *message ? message : tz_status_text(s));
    return EXIT_BAD;
}

/* What standard output still holds must arrive too. */
static int flush_output(int code)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return code;
    if (code != EXIT_DONE) /* the error has been told */
        return code;
    fprintf(stderr, "terrazzo: standard output: %s\n", strerror(errno));
    return EXIT_BAD;
}

static int run(tz_cli *cli)
{
    tz_bar bar;
    tz_bar_init(&bar, cli->common->quiet);
    const bool own = cli->command->memory && !tz_cli_given(cli, "memory");
    const tz_ctx_options opt = {
        .threads = cli->common->threads,
        .memory = (size_t)(own ? cli->command->memory : cli->common->memory),
        .on_progress = bar.on ? tz_bar_progress : NULL,
        .on_warning = tz_bar_warning,
        .user = &bar};
    double start = tz_seconds();
    tz_status s = tz_ctx_new(&opt, &cli->ctx);
    if (s != TZ_OK) {
        fprintf(stderr, "terrazzo: cannot start: %s\n", tz_status_text(s));
        return EXIT_BAD;
    }
    catch_signals(cli->ctx);
    cli->figures = json_object();
    json_object_set_new(cli->figures, "command", json_string(cli->command->name));
    s = cli->command->run(cli);
    tz_bar_clear(&bar);
    int code = EXIT_DONE;
    if (signals || s == TZ_CANCELLED) {
        fprintf(stderr, "terrazzo: cancelled\n");
        code = EXIT_CANCELLED;
    } else if (s != TZ_OK) {
        code = complain(cli->ctx, s);
        code = cli->usage ? EXIT_USAGE : code;
    } else {
        tz_figures_print(cli, tz_seconds() - start);
    }
    running = NULL;
    json_decref(cli->figures);
    tz_ctx_free(cli->ctx);
    return flush_output(code);
}

/* ---- command line -------------------------------------------------------------------
 */

static int unknown_command(const char *name)
{
    const char *list[32];
    int32_t n = 0;
    for (; n < tz_command_count && n < 32; n++)
        list[n] = tz_command_list[n]->name;
    const char *near = tz_options_nearest(name, list, n);
    if (near)
        fprintf(stderr, "terrazzo: there is no command '%s'; did you mean %s?\n", name,
                near);
    else
        fprintf(stderr,
                "terrazzo: there is no command '%s'; \"terrazzo help\" lists them\n",
                name);
    return EXIT_USAGE;
}

static int help(const char *name)
{
    if (!name) {
        tz_help_overview(stdout);
        return flush_output(EXIT_DONE);
    }
    const tz_command *c = tz_command_find(name);
    if (!c)
        return unknown_command(name);
    tz_help_command(c, stdout);
    return flush_output(EXIT_DONE);
}

/* No command in the line: --version, --help, or a mistake. */
static int no_command(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "--version") == 0) {
        printf("terrazzo %s\n", TZ_VERSION);
        return flush_output(EXIT_DONE);
    }
    if (argc > 1 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0))
        return help(NULL);
    if (argc > 1)
        fprintf(stderr, "terrazzo: %s: no command given; \"terrazzo help\" lists them\n",
                argv[1]);
    else
        tz_help_overview(stderr);
    return EXIT_USAGE;
}

int main(int argc, char **argv)
{
    int at = tz_options_command(argc, argv);
    if (at == 0)
        return no_command(argc, argv);
    if (strcmp(argv[at], "help") == 0)
        return help(at + 1 < argc ? argv[at + 1] : NULL);
    const tz_command *c = tz_command_find(argv[at]);
    if (!c)
        return unknown_command(argv[at]);

    tz_cli cli = {0};
    tz_ctx *parse = NULL;
    int code = EXIT_BAD;
    const tz_ctx_options one = {.threads = 1};
    if (tz_ctx_new(&one, &parse) != TZ_OK || tz_cli_init(&cli, parse, c) != TZ_OK) {
        fprintf(stderr, "terrazzo: out of memory\n");
        goto done;
    }
    tz_parse_result r = tz_options_parse(&cli, argc, argv, at);
    if (r != TZ_PARSE_OK) {
        complain(parse, TZ_INVALID);
        code = r == TZ_PARSE_USAGE ? EXIT_USAGE : EXIT_BAD;
    } else if (cli.common->help) {
        tz_help_command(c, stdout);
        code = flush_output(EXIT_DONE);
    } else {
        code = run(&cli);
    }
done:
    tz_cli_deinit(&cli);
    tz_ctx_free(parse);
    return code;
}
