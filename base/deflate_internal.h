/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A deflate encoder for filtered photos: Huffman codes, and runs as the only matches. On
 * such data longer matches hardly occur, and leaving out their search makes it several
 * times faster than zlib's or libdeflate's lightest level. Not installed. */
#ifndef TZ_BASE_DEFLATE_INTERNAL_H
#define TZ_BASE_DEFLATE_INTERNAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Bytes that tz_deflate_fast, or zlib, may need for n bytes, and 4 more. */
size_t tz_deflate_bound(size_t n);

/** Raw deflate data of whole blocks (no zlib header), ending on a byte, so that what is
 * deflated next can be appended; `last` marks the end of the stream.
 * @param[out] out  tz_deflate_bound(n) bytes  @return bytes written  @cost O(n) */
size_t tz_deflate_fast(const uint8_t *data, size_t n, uint8_t *out, bool last);

#endif
