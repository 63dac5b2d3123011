/* SPDX-License-Identifier: Apache-2.0 */
/* Files: reading, atomic output, clean-up, SHA-256. */
#include "tests/base/check.h"

#include <sys/stat.h>

#include "base/file.h"

static char dir[64];

static int set_up(void **state)
{
    (void)state;
    begin_dir(dir);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    end_dir(dir);
    return 0;
}

static const char *in_dir(const char *name)
{
    static char path[4][200];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", dir, name);
    return path[turn];
}

static void write_file(const char *path, const char *text, size_t n)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(text, 1, n, f), n);
    fclose(f);
}

static void whole_file(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    char *data, big[100000];
    size_t n;
    memset(big, 'x', sizeof big);
    write_file(in_dir("a"), big, sizeof big);
    ok(ctx, tz_file_read(ctx, in_dir("a"), sizeof big, &data, &n));
    assert_int_equal(n, sizeof big);
    assert_memory_equal(data, big, n);
    assert_int_equal(data[n], 0);
    tz_free(ctx, data);
    fails(ctx, tz_file_read(ctx, in_dir("a"), sizeof big - 1, &data, &n), TZ_LIMIT, "/a");
    write_file(in_dir("empty"), "", 0);
    ok(ctx, tz_file_read(ctx, in_dir("empty"), 0, &data, &n));
    assert_int_equal(n, 0);
    tz_free(ctx, data);
    ok(ctx,
       tz_file_read(ctx, "/proc/self/status", 1 << 20, &data, &n)); /* size unknown */
    assert_true(n > 100);
    tz_free(ctx, data);
    end_ctx(ctx);
}

static void unreadable(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    char *data, hex[65];
    size_t n;
    fails(ctx, tz_file_read(ctx, in_dir("none"), 9, &data, &n), TZ_IO, "No such file");
    fails(ctx, tz_file_read(ctx, dir, 9, &data, &n), TZ_IO, "is a directory");
    fails(ctx, tz_file_read(ctx, "/dev/zero", 100, &data, &n), TZ_LIMIT, "limit");
    fails(ctx, tz_file_sha256(ctx, in_dir("none"), hex), TZ_IO, "cannot open");
    fails(ctx, tz_file_sha256(ctx, dir, hex), TZ_IO, "is a directory");
    fails(ctx, tz_file_sha256(ctx, "/dev/zero", hex), TZ_IO, "cannot be read twice");
    end_ctx(ctx);
}

static void output_appears_when_complete(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    const char *path = in_dir("out");
    tz_file_out out;
    struct stat st;
    int before = dir_count(dir);
    ok(ctx, tz_file_out_open(ctx, path, &out));
    fputs("hello", out.f);
    assert_int_not_equal(stat(path, &st), 0);
    ok(ctx, tz_file_out_commit(&out));
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_size, 5);
    mode_t mask = umask(0);
    umask(mask);
    assert_int_equal(st.st_mode & 0777, 0666 & ~mask);
    chmod(path, 0640);
    ok(ctx, tz_file_out_open(ctx, path, &out));
    fputs("again!", out.f);
    tz_file_out_abort(&out);
    tz_file_out_abort(&out);
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_size, 5); /* the old one stands */
    ok(ctx, tz_file_out_open(ctx, path, &out));
    fputs("again!", out.f);
    ok(ctx, tz_file_out_commit(&out));
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_size, 6);
    assert_int_equal(st.st_mode & 0777, 0640); /* keeps its mode */
    assert_int_equal(dir_count(dir), before + 1);
    end_ctx(ctx);
}

static void output_that_cannot_be(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_file_out out;
    fails(ctx, tz_file_out_open(ctx, in_dir("no/such/folder"), &out), TZ_IO,
          "cannot write");
    fails(ctx, tz_file_out_open(ctx, dir, &out), TZ_IO, "is a directory");
    fails(ctx, tz_file_out_open(ctx, "", &out), TZ_INVALID, "empty");
    fails(ctx, tz_file_out_open(ctx, "/proc/x", &out), TZ_IO, "/proc/x");
    /* a full disk */
    ok(ctx, tz_file_out_open(ctx, "/dev/full", &out));
    fputs("hello", out.f);
    fails(ctx, tz_file_out_commit(&out), TZ_IO, "No space left");
    /* the rename fails: a folder took the name meanwhile */
    const char *path = in_dir("taken");
    int before = dir_count(dir);
    ok(ctx, tz_file_out_open(ctx, path, &out));
    mkdir(path, 0777);
    write_file(in_dir("taken/x"), "x", 1);
    fails(ctx, tz_file_out_commit(&out), TZ_IO, "taken");
    remove(in_dir("taken/x"));
    rmdir(path);
    assert_int_equal(dir_count(dir), before);
    end_ctx(ctx);
}

static void cleanup_unlinks_open_files(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    tz_file_out out[100];
    char name[20];
    int before = dir_count(dir);
    for (int i = 0; i < 3; i++) {
        snprintf(name, sizeof name, "open%d", i);
        ok(ctx, tz_file_out_open(ctx, in_dir(name), &out[i]));
    }
    assert_int_equal(dir_count(dir), before + 3);
    tz_file_cleanup();
    assert_int_equal(dir_count(dir), before);
    for (int i = 0; i < 3; i++)
        tz_file_out_abort(&out[i]);
    for (int i = 0; i < 100; i++) { /* more than the table holds */
        snprintf(name, sizeof name, "many%d", i);
        ok(ctx, tz_file_out_open(ctx, in_dir(name), &out[i]));
    }
    for (int i = 0; i < 100; i++)
        tz_file_out_abort(&out[i]);
    assert_int_equal(dir_count(dir), before);
    end_ctx(ctx);
}

static void sha256(void **state)
{
    (void)state;
    tz_ctx *ctx = new_ctx(1);
    char hex[65], from_file[65], *big = malloc(1000000);
    tz_sha256("", 0, hex);
    assert_string_equal(
        hex, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    tz_sha256("abc", 3, hex);
    assert_string_equal(
        hex, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    tz_sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", 56, hex);
    assert_string_equal(
        hex, "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    memset(big, 'a', 1000000);
    tz_sha256(big, 1000000, hex);
    assert_string_equal(
        hex, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    write_file(in_dir("million"), big, 1000000);
    ok(ctx, tz_file_sha256(ctx, in_dir("million"), from_file));
    assert_string_equal(from_file, hex);
    free(big);
    end_ctx(ctx);
}

static tz_status read_and_write(tz_ctx *ctx)
{
    tz_file_out out;
    char *data;
    size_t n;
    tz_status s = tz_file_out_open(ctx, in_dir("survivor"), &out);
    if (s != TZ_OK)
        return s;
    fputs("x", out.f);
    s = tz_file_out_commit(&out);
    if (s != TZ_OK)
        return s;
    s = tz_file_read(ctx, "/proc/self/status", 1 << 20, &data, &n);
    if (s == TZ_OK)
        tz_free(ctx, data);
    return s;
}

static void failures_leave_nothing(void **state)
{
    (void)state;
    int before = dir_count(dir);
    survive(read_and_write, 1);
    assert_int_equal(dir_count(dir), before + 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_file),
        cmocka_unit_test(unreadable),
        cmocka_unit_test(output_appears_when_complete),
        cmocka_unit_test(output_that_cannot_be),
        cmocka_unit_test(cleanup_unlinks_open_files),
        cmocka_unit_test(sha256),
        cmocka_unit_test(failures_leave_nothing),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
