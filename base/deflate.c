/* SPDX-License-Identifier: Apache-2.0 */
#include "base/deflate_internal.h"

#include <zlib.h>

size_t tz_deflate_bound(size_t n) { return n + n / 8 + 1024; }

size_t tz_deflate_fast(const uint8_t *data, size_t n, uint8_t *out, bool last)
{
    z_stream z = {.next_in = (Bytef *)(uintptr_t)data,
                  .avail_in = (uInt)n,
                  .next_out = out,
                  .avail_out = (uInt)tz_deflate_bound(n)};
    deflateInit2(&z, 1, Z_DEFLATED, -15, 9, Z_RLE);
    deflate(&z, last ? Z_FINISH : Z_FULL_FLUSH);
    size_t size = z.total_out;
    deflateEnd(&z);
    return size;
}
