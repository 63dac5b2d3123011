/* SPDX-License-Identifier: Apache-2.0 */
/* Every block carries a 64-byte header in front of it:
 *
 *   malloc'ed        aligned to 64
 *   |  padding  | header: raw, size | block ...
 *
 * On malloc rather than aligned_alloc, because calloc hands out large zeroed blocks
 * without touching them and realloc moves large blocks by page tables. */
#include "base/alloc.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "base/ctx_internal.h"

enum { ALIGN = 64 };

typedef struct header {
    void *raw;     /* what malloc gave */
    size_t size;   /* bytes counted against the budget */
    size_t offset; /* of the block from raw */
} header;

static header *header_of(void *p) { return (header *)((char *)p - ALIGN); }

/* Bytes to ask malloc for, or 0 if that overflows. */
static size_t gross_size(size_t n, size_t size)
{
    size_t net, gross;
    if (__builtin_mul_overflow(n, size, &net) ||
        __builtin_add_overflow(net, (size_t)2 * ALIGN, &gross) || gross > PTRDIFF_MAX)
        return 0;
    return gross;
}

/* Where the block begins: the first multiple of ALIGN that leaves room for the header. */
static char *aligned(void *raw)
{
    return (char *)raw + (2 * ALIGN - 1 - ((uintptr_t)raw + ALIGN - 1) % ALIGN);
}

static void *place(void *raw, size_t gross)
{
    char *p = aligned(raw);
    *header_of(p) = (header){raw, gross, (uintptr_t)p - (uintptr_t)raw};
    return p;
}

static tz_status too_large(tz_ctx *ctx, size_t n, size_t size)
{
    return tz_fail(ctx, TZ_NOMEM, "out of memory: %zu items of %zu bytes were asked for",
                   n, size);
}

/* Large blocks ask for huge pages: a page fault is a microsecond for every 4 KiB, and
 * pixels read at an angle meet a page with each row. */
static void advise(void *raw, size_t gross)
{
    enum { HUGE_PAGE = 2 << 20 };
#if defined(MADV_HUGEPAGE)
    const uintptr_t from = ((uintptr_t)raw + HUGE_PAGE - 1) & ~(uintptr_t)(HUGE_PAGE - 1);
    const uintptr_t to = ((uintptr_t)raw + gross) & ~(uintptr_t)(HUGE_PAGE - 1);
    if (gross >= 2 * (size_t)HUGE_PAGE && to > from)
        madvise((void *)from, to - from, MADV_HUGEPAGE); /* no matter if it is refused */
#else
    (void)raw, (void)gross;
#endif
}

static tz_status allocate(tz_ctx *ctx, void *out, size_t n, size_t size, bool zero)
{
    void *p = NULL;
    memcpy(out, &p, sizeof p);
    size_t gross = gross_size(n, size);
    if (gross == 0)
        return too_large(ctx, n, size);
    tz_status s = tz_ctx_take_memory(ctx, gross);
    if (s != TZ_OK)
        return s;
    void *raw = zero ? calloc(1, gross) : malloc(gross);
    if (!raw) {
        tz_ctx_give_memory(ctx, gross);
        return too_large(ctx, n, size);
    }
    advise(raw, gross);
    p = place(raw, gross);
    memcpy(out, &p, sizeof p);
    return TZ_OK;
}

tz_status tz_alloc(tz_ctx *ctx, void *out, size_t n, size_t size)
{
    return allocate(ctx, out, n, size, false);
}

tz_status tz_alloc_zero(tz_ctx *ctx, void *out, size_t n, size_t size)
{
    return allocate(ctx, out, n, size, true);
}

tz_status tz_realloc(tz_ctx *ctx, void *inout, size_t n, size_t size)
{
    void *p;
    memcpy(&p, inout, sizeof p);
    if (!p)
        return allocate(ctx, inout, n, size, false);
    size_t gross = gross_size(n, size);
    if (gross == 0)
        return too_large(ctx, n, size);
    header h = *header_of(p);
    /* the budget sees the sum of both blocks, as realloc may have to copy */
    tz_status s = tz_ctx_take_memory(ctx, gross);
    if (s != TZ_OK)
        return s;
    void *raw = realloc(h.raw, gross);
    /* from here on p is gone, unless raw is NULL */
    if (!raw) {
        tz_ctx_give_memory(ctx, gross);
        return too_large(ctx, n, size);
    }
    tz_ctx_give_memory(ctx, h.size);
    size_t keep = (h.size < gross ? h.size : gross) - 2 * ALIGN;
    char *to = aligned(raw);
    char *from = (char *)raw + h.offset; /* where realloc left the contents */
    if (to != from)
        memmove(to, from, keep);
    p = place(raw, gross);
    memcpy(inout, &p, sizeof p);
    return TZ_OK;
}

void tz_free(tz_ctx *ctx, void *p)
{
    if (!p)
        return;
    header h = *header_of(p);
    tz_ctx_give_memory(ctx, h.size);
    free(h.raw);
}

tz_status tz_strdup(tz_ctx *ctx, const char *s, char **out)
{
    size_t n = strlen(s) + 1;
    tz_status status = tz_alloc(ctx, out, n, 1);
    if (status == TZ_OK)
        memcpy(*out, s, n);
    return status;
}
