/* SPDX-License-Identifier: Apache-2.0 */
/* References from a document to files. Folders are taken with symbolic links resolved,
 * because ".." means the real parent to the system that opens the file later. */
#include "base/href.h"

#include <limits.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

/** Appends the components of `path` to `out` ("" = root), resolving "." and "..".
 * @return false if it does not fit */
static bool append(char out[PATH_MAX], const char *path)
{
    size_t n = strlen(out);
    while (*path) {
        size_t k = strcspn(path, "/");
        if (k == 2 && !memcmp(path, "..", 2)) {
            while (n && out[n - 1] != '/')
                n--;
            if (n)
                n--;
        } else if (k && !(k == 1 && *path == '.')) {
            if (n + k + 2 > PATH_MAX)
                return false;
            out[n++] = '/';
            memcpy(out + n, path, k);
            n += k;
        }
        out[n] = 0;
        path += k + (path[k] == '/');
    }
    return true;
}

/** Absolute path with the folder's symbolic links resolved as far as it exists. */
static tz_status absolute(tz_ctx *ctx, const char *path, char out[PATH_MAX])
{
    char full[PATH_MAX], real[PATH_MAX];
    size_t n = strlen(path);
    full[0] = 0;
    if (path[0] != '/' && !getcwd(full, sizeof full))
        return tz_fail(ctx, TZ_IO, "%s: the working folder is gone", path);
    size_t m = strlen(full);
    if (m + n + 2 > sizeof full)
        return tz_fail(ctx, TZ_LIMIT, "path of %zu bytes is too long", n);
    full[m] = '/';
    memcpy(full + m + 1, path, n + 1);
    char *slash = strrchr(full, '/'); /* there is one */
    const char *file = slash + 1;
    *slash = 0;
    out[0] = 0;
    if (!realpath(*full ? full : "/", real))
        memcpy(real, full, strlen(full) + 1);
    if (!append(out, real) || !append(out, file))
        return tz_fail(ctx, TZ_LIMIT, "path of %zu bytes is too long", n);
    return TZ_OK;
}

/** Absolute folder of a document, without a slash at its end ("" = root). */
static tz_status folder(tz_ctx *ctx, const char *doc, char out[PATH_MAX])
{
    tz_status st = absolute(ctx, strcmp(doc, "-") ? doc : "x", out);
    if (st)
        return st;
    char *slash = strrchr(out, '/');
    if (slash)
        *slash = 0;
    return TZ_OK;
}

tz_status tz_href_make(tz_ctx *ctx, const char *doc, const char *path, char **out)
{
    char from[PATH_MAX] = "", to[PATH_MAX] = "";
    tz_status st = folder(ctx, doc, from);
    if (!st)
        st = absolute(ctx, path, to);
    if (st)
        return st;
    /* common folders: both strings agree up to a slash or an end */
    size_t same = 0, ups = 0;
    for (size_t i = 0;; i++) {
        bool end_from = !from[i] || from[i] == '/', end_to = to[i] == '/';
        if (end_from && end_to)
            same = i;
        if (!from[i] || from[i] != to[i])
            break;
    }
    for (const char *p = from + same; *p; p++)
        ups += *p == '/';
    const char *rest = to + same + (to[same] == '/');
    char *text = NULL;
    st = tz_alloc(ctx, &text, 3 * (ups + strlen(rest)) + 1, 1);
    if (st)
        return st;
    char *w = text;
    for (size_t i = 0; i < ups; i++, w += 3)
        memcpy(w, "../", 3);
    for (; *rest; rest++) {
        unsigned char c = (unsigned char)*rest;
        if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
            strchr("-._~/!$()*+,;=@", c)) {
            *w++ = (char)c;
        } else {
            *w++ = '%';
            *w++ = "0123456789ABCDEF"[c >> 4];
            *w++ = "0123456789ABCDEF"[c & 15];
        }
    }
    *w = 0;
    *out = text;
    return TZ_OK;
}

static int hex(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    if (c >= 'A' && c <= 'F')
        return c - 'A' + 10;
    return -1;
}

/** Length of "scheme:" at the start of a reference, 0 if there is none. */
static size_t scheme(const char *s)
{
    size_t n = 0;
    while ((s[n] >= 'a' && s[n] <= 'z') || (s[n] >= 'A' && s[n] <= 'Z') ||
           (n && s[n] && strchr("0123456789+-.", s[n])))
        n++;
    return n && s[n] == ':' ? n + 1 : 0;
}

static bool is_local_host(const char *s) { return !*s || !strcmp(s, "localhost"); }

tz_status tz_href_open(tz_ctx *ctx, const char *doc, int32_t line, const char *href,
                       char **out)
{
    char base[PATH_MAX], decoded[PATH_MAX], full[2 * PATH_MAX], path[PATH_MAX];
    const char *s = href + strspn(href, " \t\r\n");
    size_t k = scheme(s);
    if (k == 5 && !strncasecmp(s, "data:", 5))
        return tz_fail(ctx, TZ_FORMAT,
                       "%s:%d: photo is embedded; save it as a file and link that", doc,
                       line);
    bool file = k == 5 && !strncasecmp(s, "file:", 5);
    if (k && !file)
        return tz_fail(ctx, TZ_FORMAT,
                       "%s:%d: photo is remote (%.40s); only local files are read, so "
                       "download it and link the copy",
                       doc, line, s);
    if (file)
        s += k;
    if (s[0] == '/' && s[1] == '/') {
        const char *host = s + 2;
        size_t n = strcspn(host, "/");
        char name[16] = "";
        if (n < sizeof name)
            memcpy(name, host, n);
        if (!file || n >= sizeof name || !is_local_host(name))
            return tz_fail(ctx, TZ_FORMAT,
                           "%s:%d: photo is on another machine (%.40s); only local files "
                           "are read, so copy it and link the copy",
                           doc, line, s);
        s = host + n;
    }
    size_t n = 0;
    for (; *s; s++) {
        int c = (unsigned char)*s;
        if (c == '%' && hex(s[1]) >= 0 && hex(s[2]) >= 0) {
            c = hex(s[1]) * 16 + hex(s[2]);
            s += 2;
        }
        if (!c)
            return tz_fail(ctx, TZ_FORMAT, "%s:%d: reference to a photo holds %%00", doc,
                           line);
        if (n + 1 >= sizeof decoded)
            return tz_fail(ctx, TZ_LIMIT, "%s:%d: reference to a photo is over %d bytes",
                           doc, line, PATH_MAX);
        decoded[n++] = (char)c;
    }
    while (n && strchr(" \t\r\n", decoded[n - 1]))
        n--;
    decoded[n] = 0;
    if (!n)
        return tz_fail(ctx, TZ_FORMAT, "%s:%d: reference to a photo is empty", doc, line);
    tz_status st = TZ_OK;
    if (decoded[0] != '/') {
        st = folder(ctx, doc, base);
        if (st)
            return st;
        size_t m = strlen(base);
        memcpy(full, base, m);
        full[m] = '/';
        memcpy(full + m + 1, decoded, n);
        full[m + 1 + n] = 0;
    } else {
        memcpy(full, decoded, n);
        full[n] = 0;
    }
    st = absolute(ctx, full, path);
    return st ? st : tz_strdup(ctx, path, out);
}

tz_status tz_href_open_here(tz_ctx *ctx, const char *doc, int32_t line, const char *href,
                            char **out)
{
    char here[PATH_MAX];
    char *path = NULL;
    tz_status s = folder(ctx, "-", here);
    if (s == TZ_OK)
        s = tz_href_open(ctx, doc, line, href, &path);
    if (s != TZ_OK)
        return s;
    const size_t n = strlen(here);
    if (strncmp(path, here, n) == 0 && path[n] == '/' && path[n + 1])
        memmove(path, path + n + 1, strlen(path + n + 1) + 1);
    *out = path;
    return TZ_OK;
}
