/* SPDX-License-Identifier: Apache-2.0 */
/* SHA-256 as in FIPS 180-4. Our own, as it is 60 lines and the alternative is a
 * cryptography library in every program that links us. */
#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"

typedef struct sha256 {
    uint32_t h[8];
    uint8_t block[64];
    size_t used;
    uint64_t bytes;
} sha256;

static const uint32_t K[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4,
    0xab1c5ed5, 0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe,
    0x9bdc06a7, 0xc19bf174, 0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f,
    0x4a7484aa, 0x5cb0a9dc, 0x76f988da, 0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7,
    0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967, 0x27b70a85, 0x2e1b2138, 0x4d2c6dfc,
    0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85, 0xa2bfe8a1, 0xa81a664b,
    0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070, 0x19a4c116,
    0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7,
    0xc67178f2};

static uint32_t ror(uint32_t x, int n) { return x >> n | x << (32 - n); }

static void start(sha256 *s)
{
    *s = (sha256){.h = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f,
                        0x9b05688c, 0x1f83d9ab, 0x5be0cd19}};
}

static void compress(sha256 *s, const uint8_t *p)
{
    uint32_t w[64], v[8];
    for (int i = 0; i < 16; i++, p += 4)
        w[i] = (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
    for (int i = 16; i < 64; i++) {
        uint32_t a = w[i - 15], b = w[i - 2];
        w[i] = w[i - 16] + (ror(a, 7) ^ ror(a, 18) ^ a >> 3) + w[i - 7] +
               (ror(b, 17) ^ ror(b, 19) ^ b >> 10);
    }
    memcpy(v, s->h, sizeof v);
    for (int i = 0; i < 64; i++) {
        uint32_t t1 = v[7] + (ror(v[4], 6) ^ ror(v[4], 11) ^ ror(v[4], 25)) +
                      ((v[4] & v[5]) ^ (~v[4] & v[6])) + K[i] + w[i];
        uint32_t t2 = (ror(v[0], 2) ^ ror(v[0], 13) ^ ror(v[0], 22)) +
                      ((v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2]));
        memmove(v + 1, v, 7 * sizeof *v);
        v[4] += t1;
        v[0] = t1 + t2;
    }
    for (int i = 0; i < 8; i++)
        s->h[i] += v[i];
}

static void add(sha256 *s, const void *data, size_t n)
{
    const uint8_t *p = data;
    s->bytes += n;
    while (n > 0) {
        if (s->used == 0 && n >= 64) {
            compress(s, p);
            p += 64;
            n -= 64;
            continue;
        }
        size_t take = 64 - s->used < n ? 64 - s->used : n;
        memcpy(s->block + s->used, p, take);
        s->used = (s->used + take) % 64;
        p += take;
        n -= take;
        if (s->used == 0)
            compress(s, s->block);
    }
}

static void finish(sha256 *s, char hex[65])
{
    uint64_t bits = s->bytes * 8;
    uint8_t tail[72] = {0x80};
    size_t pad = (s->used < 56 ? 56 : 120) - s->used;
    for (int i = 0; i < 8; i++)
        tail[pad + (size_t)i] = (uint8_t)(bits >> (56 - 8 * i));
    add(s, tail, pad + 8);
    for (int i = 0; i < 8; i++)
        snprintf(hex + (ptrdiff_t)8 * i, 9, "%08x", (unsigned)s->h[i]);
}

void tz_sha256(const void *data, size_t size, char hex[65])
{
    sha256 s;
    start(&s);
    add(&s, data, size);
    finish(&s, hex);
}

tz_status tz_file_sha256(tz_ctx *ctx, const char *path, char hex[65])
{
    struct stat st;
    char block[16384], text[128];
    size_t n;
    FILE *f = fopen(path, "rb");
    if (!f)
        return tz_fail(ctx, TZ_IO, "%s: cannot open: %s; check the name", path,
                       strerror_r(errno, text, sizeof text));
    if (fstat(fileno(f), &st) == 0 && !S_ISREG(st.st_mode)) {
        fclose(f);
        return S_ISDIR(st.st_mode)
                   ? tz_fail(ctx, TZ_IO, "%s: is a directory; name a file in it", path)
                   : tz_fail(ctx, TZ_IO,
                             "%s: is a device or a pipe, which cannot be read twice; "
                             "save it to a file and name that",
                             path);
    }
    sha256 s;
    start(&s);
    tz_status status = TZ_OK;
    while (status == TZ_OK && (n = fread(block, 1, sizeof block, f)) > 0) {
        add(&s, block, n);
        if (tz_ctx_cancelled(ctx))
            status = tz_fail(ctx, TZ_CANCELLED, "cancelled");
    }
    if (status == TZ_OK && ferror(f))
        status = tz_fail(ctx, TZ_IO, "%s: cannot read: %s; check the device", path,
                         strerror_r(errno, text, sizeof text));
    fclose(f);
    if (status == TZ_OK)
        finish(&s, hex);
    return status;
}
