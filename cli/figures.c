/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/figures.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

/* Member of an object, made on first use. */
static json_t *member(json_t *object, const char *key, json_t *(*make)(void))
{
    json_t *v = json_object_get(object, key);
    if (!v)
        json_object_set_new(object, key, v = make());
    return v;
}

void tz_figures_output(tz_cli *cli, const char *path, const char *map, int32_t width,
                       int32_t height)
{
    json_t *list = member(cli->figures, "outputs", json_array);
    json_array_append_new(list,
                          json_pack("{s:s, s:s, s:i, s:i}", "path", path, "map", map,
                                    "width", (int)width, "height", (int)height));
}

void tz_figures_seconds(tz_cli *cli, const char *stage, double seconds)
{
    json_t *list = member(cli->figures, "seconds", json_object);
    double old = json_number_value(json_object_get(list, stage));
    json_object_set_new(list, stage, json_real(old + seconds));
}

void tz_figures_count(tz_cli *cli, const char *name, int64_t n)
{
    json_int_t old = json_integer_value(json_object_get(cli->figures, name));
    json_object_set_new(cli->figures, name, json_integer(old + n));
}

void tz_figures_text(tz_cli *cli, const char *name, const char *text)
{
    json_object_set_new(cli->figures, name, json_string(text));
}

static void print_summary(const tz_cli *cli, double seconds, double peak)
{
    size_t i;
    json_t *v;
    const char *key, *comma = "";
    json_array_foreach(json_object_get(cli->figures, "outputs"), i, v)
        printf("%s  %d x %d\n", json_string_value(json_object_get(v, "path")),
               (int)json_integer_value(json_object_get(v, "width")),
               (int)json_integer_value(json_object_get(v, "height")));
    const char *as = json_string_value(json_object_get(cli->figures, "as")),
               *why = json_string_value(json_object_get(cli->figures, "why"));
    if (as && why)
        printf("as %s: %s\n", as, why);
    json_t *stages = json_object_get(cli->figures, "seconds");
    if (!stages)
        return;
    printf("%.2f s (", seconds);
    json_object_foreach(stages, key, v)
    {
        printf("%s%s %.2f", comma, key, json_number_value(v));
        comma = ", ";
    }
    printf("), %.0f MiB\n", peak / 1048576);
}

void tz_figures_print(tz_cli *cli, double seconds)
{
    struct rusage u;
    getrusage(RUSAGE_SELF, &u);
    double cpu = (double)u.ru_utime.tv_sec + 1e-6 * (double)u.ru_utime.tv_usec +
                 (double)u.ru_stime.tv_sec + 1e-6 * (double)u.ru_stime.tv_usec;
    double peak = 1024.0 * (double)u.ru_maxrss;
    if (!cli->common->json) {
        if (!cli->common->quiet && !cli->piped)
            print_summary(cli, seconds, peak);
        return;
    }
    json_object_set_new(member(cli->figures, "seconds", json_object), "total",
                        json_real(seconds));
    json_object_set_new(cli->figures, "cpu_seconds", json_real(cpu));
    json_object_set_new(cli->figures, "threads", json_integer(tz_ctx_threads(cli->ctx)));
    json_object_set_new(cli->figures, "memory_peak", json_integer((json_int_t)peak));
    json_object_set_new(cli->figures, "memory_allocated",
                        json_integer((json_int_t)tz_ctx_memory_peak(cli->ctx)));
    json_dumpf(cli->figures, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(6));
    putchar('\n');
}
