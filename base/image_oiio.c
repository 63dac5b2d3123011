/* SPDX-License-Identifier: Apache-2.0 */
/* Reading by OpenImageIO, for all formats that we do not read ourselves, through the
 * module that keeps its 260 shared libraries out of our start-up. */
#include "base/image_oiio_module.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/image_internal.h"
#include "base/module.h"

typedef struct receiver {
    const tz_image_source *src;
    tz_image *im;
    tz_image_found *found;
    tz_status status;
    bool is_float;
} receiver;

static float *on_begin(void *user, const tz_oiio_head *head)
{
    receiver *r = user;
    r->status =
        tz_image_source_init(r->src, head->width, head->height, head->channels, r->im);
    if (r->status != TZ_OK)
        return NULL;
    r->im->alpha = head->alpha;
    r->im->depth = head->depth;
    r->found->encoding = head->linear ? TZ_ENCODING_LINEAR : TZ_ENCODING_SRGB;
    r->found->orientation = head->orientation;
    r->is_float = head->is_float;
    return r->im->px;
}

static void on_name(void *user, int32_t channel, const char *name)
{
    receiver *r = user;
    strncpy(r->im->names[channel], name, sizeof *r->im->names - 1);
}

static void on_meta(void *user, const char *key, const char *value)
{
    receiver *r = user;
    if (r->status != TZ_OK || strncmp(key, "oiio:", 5) == 0 ||
        strcmp(key, "compression") == 0 || strcmp(key, "planarconfig") == 0 ||
        (strcmp(key, "DateTime") == 0 && strncmp(value, "1970:01:01", 10) == 0))
        return; /* how it was stored, and our own stand-in for a date */
    if (strcmp(key, "ImageDescription") != 0) {
        r->status = tz_image_set_meta(r->im, key, value);
        return;
    }
    while (*value && r->status == TZ_OK) { /* one entry a line, as we write them */
        size_t n = strcspn(value, "\n");
        r->status = tz_image_set_meta_line(r->im, value, n);
        value += n + (value[n] == '\n');
    }
}

static int on_cancelled(void *user)
{
    receiver *r = user;
    return tz_ctx_cancelled(r->src->ctx);
}

int64_t tz_image_make_finite(tz_image *im)
{
    int64_t count = 0;
    for (int32_t y = 0; y < im->height; y++) {
        float *p = tz_image_at(im, 0, y);
        int64_t n = (int64_t)im->width * im->channels;
        for (int64_t i = 0; i < n; i++) {
            bool bad = !isfinite(p[i]);
            count += bad;
            p[i] = bad ? 0.0f : p[i];
        }
    }
    return count;
}

/* Few of OpenImageIO's formats read from memory: standard input goes through a file. */
static tz_status spool_input(const tz_image_source *src, char *name, size_t size)
{
    const char *dir = getenv("TMPDIR");
    if (!dir || strlen(dir) > size - 20)
        dir = "/tmp";
    snprintf(name, size, "%s/terrazzo.XXXXXX", dir);
    int fd = mkstemp(name);
    FILE *f = fd >= 0 ? fdopen(fd, "wb") : NULL;
    bool bad = !f || fwrite(src->data, 1, src->size, f) != src->size;
    if (f)
        bad |= fclose(f) != 0;
    else if (fd >= 0)
        close(fd);
    if (!bad)
        return TZ_OK;
    if (fd >= 0)
        unlink(name);
    return tz_fail(src->ctx, TZ_IO, "%s: no room for a temporary file in %s; set TMPDIR",
                   src->path, dir);
}

tz_status tz_oiio_read(const tz_image_source *src, tz_image *im, tz_image_found *found)
{
    const tz_oiio_api *api;
    tz_status s = tz_module_symbol(src->ctx, "oiio", TZ_OIIO_SYMBOL, (void *)&api);
    if (s != TZ_OK)
        return s;
    receiver r = {.src = src, .im = im, .found = found};
    tz_oiio_reader call = {&r, on_begin, on_name, on_meta, on_cancelled};
    char why[300] = "";
    char spool[64] = "";
    if (src->piped && (s = spool_input(src, spool, sizeof spool)) != TZ_OK)
        return s;
    int rc = api->read(spool[0] ? spool : src->path, &call, why, sizeof why);
    if (spool[0])
        unlink(spool);
    if (rc == 0)
        s = r.status;
    else if (r.status != TZ_OK)
        s = r.status;
    else if (tz_ctx_cancelled(src->ctx))
        s = tz_fail(src->ctx, TZ_CANCELLED, "cancelled");
    else if (rc == 3)
        s = tz_fail(src->ctx, TZ_NOMEM, "%s: out of memory", src->path);
    else
        s = tz_image_source_bad(src, "image", why);
    if (s == TZ_OK && r.is_float)
        found->not_finite = tz_image_make_finite(im);
    if (s != TZ_OK)
        tz_image_deinit(im);
    return s;
}
