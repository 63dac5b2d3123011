/* SPDX-License-Identifier: Apache-2.0 */
/* Whole-file reading and output files that appear under their name only when complete.
 *
 * A table of the temporary names that are open lets a signal handler unlink them. It is
 * the one mutable global of the library, since a handler gets no argument: slots are
 * claimed with an atomic state, and a handler reads only slots in state USED. */
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SLOTS = 64, SLOT_FREE = 0, SLOT_FILLING = 1, SLOT_USED = 2 };

static struct {
    atomic_int state;
    char name[PATH_MAX];
} open_temps[SLOTS];

static int slot_claim(const char *name)
{
    if (strlen(name) >= PATH_MAX)
        return -1;
    for (int i = 0; i < SLOTS; i++) {
        int expected = SLOT_FREE;
        if (atomic_compare_exchange_strong(&open_temps[i].state, &expected,
                                           SLOT_FILLING)) {
            strcpy(open_temps[i].name, name);
            atomic_store(&open_temps[i].state, SLOT_USED);
            return i;
        }
    }
    return -1; /* table full: the file is only removed on ordinary paths */
}

static void slot_release(int i)
{
    if (i >= 0)
        atomic_store(&open_temps[i].state, SLOT_FREE);
}

void tz_file_cleanup(void)
{
    for (int i = 0; i < SLOTS; i++)
        if (atomic_load(&open_temps[i].state) == SLOT_USED)
            unlink(open_temps[i].name);
}

/* ---- reading ------------------------------------------------------------------------
 */

static const char *remedy(int error)
{
    switch (error) {
    case ENOENT: return "check the name";
    case EACCES:
    case EPERM: return "check its permissions";
    case EISDIR: return "name a file in it";
    case ENOSPC:
    case EDQUOT: return "free some space or write elsewhere";
    case EROFS: return "write elsewhere";
    case ENOTDIR: return "a part of the path is a file";
    case EMFILE:
    case ENFILE: return "close other files";
    default: return "check the device";
    }
}

static tz_status fail_errno(tz_ctx *ctx, const char *path, const char *what, int error)
{
    /* strerror_r, the GNU one, since strerror may share a buffer between threads */
    char text[128];
    return tz_fail(ctx, TZ_IO, "%s: %s: %s; %s", path, what,
                   strerror_r(error, text, sizeof text), remedy(error));
}

/* Reads on until the end, growing the buffer; `hint` is the expected size. */
static tz_status read_stream(tz_ctx *ctx, FILE *f, const char *path, size_t max,
                             size_t hint, char **out, size_t *size)
{
    char *data = NULL;
    size_t n = 0, cap = hint + 2; /* one for the zero, one to see the end in one read */
    tz_status s = tz_alloc(ctx, &data, cap, 1);
    while (s == TZ_OK) {
        if (tz_ctx_cancelled(ctx)) {
            s = tz_fail(ctx, TZ_CANCELLED, "cancelled");
            break;
        }
        size_t want = cap - 1 - n, got = fread(data + n, 1, want, f);
        n += got;
        if (n > max) {
            s = tz_fail(ctx, TZ_LIMIT,
                        "%s: the file is larger than the limit of %zu bytes", path, max);
        } else if (got < want) {
            if (ferror(f))
                s = fail_errno(ctx, path, "cannot read", errno);
            break;
        } else {
            cap += cap / 2 + 4096;
            s = tz_realloc(ctx, &data, cap, 1);
        }
    }
    if (s != TZ_OK) {
        tz_free(ctx, data);
        return s;
    }
    data[n] = 0;
    *out = data;
    *size = n;
    return TZ_OK;
}

/* Opens for reading, with the same messages for all readers. */
static tz_status open_regular(tz_ctx *ctx, const char *path, FILE **out, size_t *size)
{
    struct stat st;
    FILE *f = fopen(path, "rb");
    if (!f)
        return fail_errno(ctx, path, "cannot open", errno);
    if (fstat(fileno(f), &st) != 0) {
        int error = errno;
        fclose(f);
        return fail_errno(ctx, path, "cannot open", error);
    }
    if (S_ISDIR(st.st_mode)) {
        fclose(f);
        return tz_fail(ctx, TZ_IO, "%s: is a directory; name a file in it", path);
    }
    /* pipes such as <(command) are welcome, their size is unknown */
    *size = S_ISREG(st.st_mode) && st.st_size > 0 ? (size_t)st.st_size : 0;
    *out = f;
    return TZ_OK;
}

tz_status tz_file_read(tz_ctx *ctx, const char *path, size_t max, char **out,
                       size_t *size)
{
    if (strcmp(path, "-") == 0)
        return read_stream(ctx, stdin, "standard input", max, 65536, out, size);
    FILE *f = NULL;
    size_t hint = 0;
    tz_status s = open_regular(ctx, path, &f, &hint);
    if (s != TZ_OK)
        return s;
    if (hint > max)
        s = tz_fail(ctx, TZ_LIMIT, "%s: the file is larger than the limit of %zu bytes",
                    path, max);
    else
        s = read_stream(ctx, f, path, max, hint, out, size);
    fclose(f);
    return s;
}

/* ---- writing ------------------------------------------------------------------------
 */

static void out_free(tz_file_out *out)
{
    slot_release(out->slot);
    tz_free(out->ctx, out->path);
    tz_free(out->ctx, out->temp);
    free(out->text);
    *out = (tz_file_out){.slot = -1};
}

/* Temporary file in the folder of the target, so that rename never crosses devices:
 * .<name>.<process>-<number>~  Plain O_EXCL, so that the umask applies as to any file. */
static tz_status open_temp(tz_file_out *out)
{
    const char *slash = strrchr(out->path, '/');
    size_t dir = slash ? (size_t)(slash - out->path) + 1 : 0;
    const char *base = out->path + dir;
    size_t room = strlen(out->path) + 48;
    tz_status s = tz_alloc(out->ctx, &out->temp, room, 1);
    if (s != TZ_OK)
        return s;
    int fd = -1;
    for (int k = 0; k < 10000 && fd < 0; k++) {
        /* names are at most 255 bytes long */
        snprintf(out->temp, room, "%.*s.%.200s.%ld-%d~", (int)dir, out->path, base,
                 (long)getpid(), k);
        fd = open(out->temp, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd < 0 && errno != EEXIST)
            break;
    }
    if (fd < 0) {
        int error = errno;
        tz_free(out->ctx, out->temp);
        out->temp = NULL;
        return fail_errno(out->ctx, out->path, "cannot write here", error);
    }
    out->slot = slot_claim(out->temp);
    struct stat st;
    if (stat(out->path, &st) == 0) /* a file that is replaced keeps its mode */
        (void)!fchmod(fd, st.st_mode & 0777);
    out->f = fdopen(fd, "w+b");
    if (!out->f) {
        int error = errno;
        close(fd);
        unlink(out->temp);
        return fail_errno(out->ctx, out->path, "cannot write here", error);
    }
    return TZ_OK;
}

tz_status tz_file_out_open(tz_ctx *ctx, const char *path, tz_file_out *out)
{
    tz_file_out t = {.ctx = ctx, .slot = -1};
    struct stat st;
    *out = t;
    if (!path[0])
        return tz_fail(ctx, TZ_INVALID, "output file: the name is empty; give one");
    tz_status s = tz_strdup(ctx, path, &t.path);
    if (s != TZ_OK)
        return s;
    bool exists = stat(path, &st) == 0;
    if (strcmp(path, "-") == 0) {
        t.f = stdout;
    } else if (exists && S_ISDIR(st.st_mode)) {
        s = tz_fail(ctx, TZ_IO, "%s: is a directory; name a file in it", path);
    } else if (exists && !S_ISREG(st.st_mode)) {
        /* devices and pipes cannot be replaced: written directly */
        t.f = fopen(path, "wb");
        if (!t.f)
            s = fail_errno(ctx, path, "cannot write", errno);
    } else {
        s = open_temp(&t);
    }
    if (s != TZ_OK)
        out_free(&t);
    *out = t;
    return s;
}

tz_status tz_file_out_open_text(tz_ctx *ctx, const char *name, tz_file_out *out)
{
    *out = (tz_file_out){.ctx = ctx, .slot = -1};
    tz_status s = tz_strdup(ctx, name, &out->path);
    if (s != TZ_OK)
        return s;
    out->f = open_memstream(&out->text, &out->size);
    if (!out->f) {
        s = fail_errno(ctx, name, "cannot be made", errno);
        out_free(out);
    }
    return s;
}

tz_status tz_file_out_text(tz_file_out *out, char **text)
{
    tz_ctx *ctx = out->ctx;
    const bool bad = fclose(out->f) != 0 || !out->text; /* now text is whole */
    out->f = NULL;
    tz_status s = bad ? fail_errno(ctx, out->path, "cannot be made", ENOMEM)
                      : tz_strdup(ctx, out->text, text);
    out_free(out);
    return s;
}

tz_status tz_file_out_commit(tz_file_out *out)
{
    tz_ctx *ctx = out->ctx;
    const char *path = strcmp(out->path, "-") == 0 ? "standard output" : out->path;
    bool bad = ferror(out->f) != 0;
    errno = 0;
    bad |= fflush(out->f) != 0;
    int error = errno;
    if (out->f != stdout)
        bad |= fclose(out->f) != 0;
    else
        clearerr(stdout);
    out->f = NULL;
    error = error ? error : errno;
    tz_status s = TZ_OK;
    if (bad)
        s = fail_errno(ctx, path, "cannot write", error ? error : EIO);
    else if (out->temp && rename(out->temp, out->path) != 0)
        s = fail_errno(ctx, path, "cannot put the finished file in place", errno);
    if (s != TZ_OK && out->temp)
        unlink(out->temp);
    out_free(out);
    return s;
}

void tz_file_out_abort(tz_file_out *out)
{
    if (!out->path)
        return;
    if (out->f && out->f != stdout)
        fclose(out->f);
    if (out->temp)
        unlink(out->temp);
    out_free(out);
}
