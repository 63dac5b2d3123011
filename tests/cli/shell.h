/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * For tests that run the built command: a scratch folder with photos in it, and a shell
 * whose $T is the command. Included once by each test program. */
#ifndef TZ_TESTS_CLI_SHELL_H
#define TZ_TESTS_CLI_SHELL_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/image_io.h"
#include "base/rng.h"

static char scratch[] = "/tmp/terrazzo-cli-XXXXXX";
static char out_text[1 << 16], err_text[1 << 16]; /* of the last command */

static void slurp(const char *path, char *text, size_t size)
{
    FILE *f = fopen(path, "rb");
    size_t n = f ? fread(text, 1, size - 1, f) : 0;
    text[n] = 0;
    if (f)
        fclose(f);
}

/* Runs a shell line in the scratch folder; its exit code. */
static int sh(const char *fmt, ...)
{
    char line[8192], all[10240];
    va_list args;
    va_start(args, fmt);
    vsnprintf(line, sizeof line, fmt, args);
    va_end(args);
    snprintf(all, sizeof all, "{ %s\n} >.out 2>.err </dev/null", line);
    int rc = system(all);
    slurp(".out", out_text, sizeof out_text);
    slurp(".err", err_text, sizeof err_text);
    return WIFEXITED(rc) ? WEXITSTATUS(rc) : 1000;
}

static inline bool exists(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0;
}

/* Fails unless the last command said `text` on standard error. */
#define assert_said(text)                                     \
    do {                                                      \
        if (!strstr(err_text, text))                          \
            fail_msg("wanted \"%s\" in: %s", text, err_text); \
    } while (0)

/* Lines on standard error that are not warnings; -1 if one does not begin as ours do. */
static inline int error_lines(void)
{
    int n = 0;
    for (const char *p = err_text; *p; p += strcspn(p, "\n"), p += *p == '\n') {
        if (strncmp(p, "terrazzo: ", 10) != 0)
            return -1;
        n += strncmp(p, "terrazzo: warning: ", 19) != 0;
    }
    return n;
}

#define assert_one_line()                              \
    do {                                               \
        if (error_lines() != 1)                        \
            fail_msg("wanted one line: %s", err_text); \
    } while (0)

/* Fails with the command's own words unless it exits with `code`. */
#define assert_exit(code, ...)                                                   \
    do {                                                                         \
        int rc_ = sh(__VA_ARGS__);                                               \
        if (rc_ != (code))                                                       \
            fail_msg("exit %d in place of %d: %s%s", rc_, (int)(code), out_text, \
                     err_text);                                                  \
    } while (0)

typedef float (*shade)(int32_t x, int32_t y, int32_t c);

/* Draws an image file. */
static inline void picture(const char *path, tz_rect size, int32_t channels,
                           tz_encoding encoding, shade at, tz_sample_type type)
{
    tz_image im = {0};
    assert_int_equal(tz_image_init(NULL, &im, size.w, size.h, channels), TZ_OK);
    im.encoding = encoding;
    for (int32_t y = 0; y < size.h; y++)
        for (int32_t x = 0; x < size.w; x++)
            for (int32_t c = 0; c < channels; c++)
                tz_image_at(&im, x, y)[c] = at(x, y, c);
    /* floats unpacked, so that a test can reach them */
    const tz_image_write_options opt = {.type = type,
                                        .compression = type == TZ_SAMPLE_FLOAT ? 0 : -1};
    assert_int_equal(tz_image_write(NULL, path, &im, &opt), TZ_OK);
    tz_image_deinit(&im);
}

static inline float random_shade(int32_t x, int32_t y, int32_t c)
{
    tz_rng r = tz_rng_make(1, tz_rng_stream((uint64_t)x, (uint64_t)y, (uint64_t)c));
    return (float)tz_rng_unit(&r);
}

/* Enters a fresh folder that holds stones.png; 77 where there is no command to test. */
static int enter_scratch(void **state)
{
    (void)state;
    const char *command = getenv("TZ_COMMAND");
    char line[4096];
    if (!command || access(command, X_OK) != 0) {
        fprintf(stderr, "TZ_COMMAND does not name the built command\n");
        return -1;
    }
    setenv("T", command, 1);
    setenv("DATA", TZ_SOURCE_DIR "/tests/cli", 1);
    if (!mkdtemp(scratch) || chdir(scratch) != 0)
        return -1;
    snprintf(line, sizeof line, "cp '%s/data/exemplars/'*.png .", TZ_SOURCE_DIR);
    return system(line) == 0 ? 0 : -1;
}

static int leave_scratch(void **state)
{
    (void)state;
    char line[4096];
    snprintf(line, sizeof line, "chmod -R u+w '%s' && rm -rf '%s'", scratch, scratch);
    return chdir("/") == 0 && system(line) == 0 ? 0 : -1;
}

#endif
