/* SPDX-License-Identifier: Apache-2.0 */
/* Deflate (RFC 1951) in two passes over blocks of 64 KiB: tokens and their counts, then a
 * dynamic Huffman block.
 *
 *   bytes ─▶ tokens: 0..255 literal, 256 + k: a run of k more of the byte before
 *         ─▶ counts ─▶ code lengths (Huffman, limited to 15 bits) ─▶ bits */
#include "base/deflate_internal.h"

#include <stdlib.h>
#include <string.h>

enum {
    BLOCK = 1 << 16,
    SYMBOLS = 286, /* literals, end of block, lengths */
    END = 256,
    MIN_RUN = 6, /* shorter runs are as short as literals */
    MAX_RUN = 258,
    MAX_BITS = 15
};

size_t tz_deflate_bound(size_t n) { return n + n / 8 + 1024; }

/* ---- bits ----------------------------------------------------------------------------- */

typedef struct writer {
    uint8_t *p;
    uint64_t bits;
    unsigned n; /* valid bits; under 8 after a flush */
} writer;

static inline void add(writer *w, uint32_t value, unsigned n)
{
    w->bits |= (uint64_t)value << w->n;
    w->n += n;
}

/* At most 56 bits may have been added since the last. */
static inline void flush(writer *w)
{
    memcpy(w->p, &w->bits, sizeof w->bits); /* little-endian, like the format */
    w->p += w->n >> 3;
    w->bits >>= w->n & ~7u;
    w->n &= 7;
}

/* ---- code lengths ------------------------------------------------------------------------ */

typedef struct leaf {
    uint32_t count;
    uint16_t symbol;
} leaf;

static int by_count(const void *a, const void *b)
{
    const leaf *p = a, *q = b;
    if (p->count != q->count)
        return p->count < q->count ? -1 : 1;
    return p->symbol - q->symbol;
}

/* Depths of a Huffman tree over counts in rising order, in place (Moffat and Katajainen,
 * In-place calculation of minimum-redundancy codes, WADS 1995). n >= 2. */
static void tree_depths(uint32_t *a, int n)
{
    int root = 0, leaf = 2, next;
    a[0] += a[1];
    for (next = 1; next < n - 1; next++) {
        for (int side = 0; side < 2; side++) {
            uint32_t v;
            if (leaf >= n || (root < next && a[root] < a[leaf])) {
                v = a[root];
                a[root++] = (uint32_t)next;
            } else {
                v = a[leaf++];
            }
            a[next] = side ? a[next] + v : v;
        }
    }
    a[n - 2] = 0;
    for (next = n - 3; next >= 0; next--)
        a[next] = a[a[next]] + 1;
    int available = 1, used = 0, depth = 0;
    root = n - 2;
    next = n - 1;
    while (available > 0) {
        while (root >= 0 && (int)a[root] == depth) {
            used++;
            root--;
        }
        while (available > used) {
            a[next--] = (uint32_t)depth;
            available--;
        }
        available = 2 * used;
        depth++;
        used = 0;
    }
}

/* Code lengths of at most `limit` bits; symbols that do not occur get 0. */
static void code_lengths(const uint32_t *count, int n, int limit, uint8_t *length)
{
    leaf leaves[SYMBOLS];
    uint32_t depth[SYMBOLS];
    int m = 0;
    memset(length, 0, (size_t)n);
    for (int i = 0; i < n; i++)
        if (count[i])
            leaves[m++] = (leaf){count[i], (uint16_t)i};
    if (m == 0)
        return;
    if (m == 1) { /* a code needs a bit, and a full tree a second leaf */
        length[leaves[0].symbol] = 1;
        length[leaves[0].symbol == 0] = 1;
        return;
    }
    qsort(leaves, (size_t)m, sizeof *leaves, by_count);
    for (int i = 0; i < m; i++)
        depth[i] = leaves[i].count;
    tree_depths(depth, m);

    /* Too deep: cut to the limit, then pay the debt in Kraft's sum by making the rarest
     * codes that still can be longer so, and give back what was paid too much. */
    int64_t kraft = 0;
    for (int i = 0; i < m; i++) {
        if (depth[i] > (uint32_t)limit)
            depth[i] = (uint32_t)limit;
        kraft += (int64_t)1 << (limit - (int)depth[i]);
    }
    const int64_t full = (int64_t)1 << limit;
    for (int i = 0; kraft > full && i < m; i++) {
        while (depth[i] < (uint32_t)limit && kraft > full) {
            depth[i]++;
            kraft -= (int64_t)1 << (limit - (int)depth[i]);
        }
    }
    for (int i = m - 1; kraft < full && i >= 0; i--) {
        while (depth[i] > 1 && kraft + ((int64_t)1 << (limit - (int)depth[i])) <= full) {
            kraft += (int64_t)1 << (limit - (int)depth[i]);
            depth[i]--;
        }
    }
    for (int i = 0; i < m; i++)
        length[leaves[i].symbol] = (uint8_t)depth[i];
}

/* Canonical codes, bits reversed as the format wants them. */
static void make_codes(const uint8_t *length, int n, uint16_t *code)
{
    unsigned count[MAX_BITS + 1] = {0}, next[MAX_BITS + 2] = {0};
    for (int i = 0; i < n; i++)
        count[length[i]]++;
    count[0] = 0;
    for (int b = 1; b <= MAX_BITS; b++)
        next[b + 1] = (next[b] + count[b]) << 1;
    for (int i = 0; i < n; i++) {
        unsigned v = length[i] ? next[length[i]]++ : 0, r = 0;
        for (int b = 0; b < length[i]; b++)
            r |= (v >> b & 1) << (length[i] - 1 - b);
        code[i] = (uint16_t)r;
    }
}

/* ---- tokens ---------------------------------------------------------------------------------- */

/* Length symbols of RFC 1951, 3.2.5. */
static const uint16_t length_base[29] = {3,  4,  5,  6,   7,   8,   9,   10,  11, 13,
                                         15, 17, 19, 23,  27,  31,  35,  43,  51, 59,
                                         67, 83, 99, 115, 131, 163, 195, 227, 258};
static const uint8_t length_extra[29] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                         2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};

static int length_symbol(int run)
{
    int s = 28;
    while (length_base[s] > run)
        s--;
    return s;
}

/* How many bytes from `p` on equal `byte`, at most `max`. */
static int run_length(const uint8_t *p, uint8_t byte, int max)
{
    int n = 0;
    while (n < max && p[n] == byte)
        n++;
    return n;
}

/* Tokens of one block; `begin` is where the stream's window begins. */
static int tokenise(const uint8_t *p, int n, const uint8_t *begin, uint16_t *token,
                    uint32_t *count)
{
    /* four tables: repeated increments of one counter would wait for each other */
    uint32_t counts[4][256] = {{0}};
    int tokens = 0, i = 0;
    while (i < n) {
        if (p + i > begin && n - i >= 8) {
            uint64_t here, same = p[i - 1] * 0x0101010101010101u;
            memcpy(&here, p + i, sizeof here);
            if (((here ^ same) & 0xffffffffffff) == 0) {
                int max = n - i < MAX_RUN ? n - i : MAX_RUN;
                int run = run_length(p + i, p[i - 1], max);
                token[tokens++] = (uint16_t)(256 + run);
                count[257 + length_symbol(run)]++;
                i += run;
                continue;
            }
        }
        counts[i & 3][p[i]]++;
        token[tokens++] = p[i++];
    }
    for (int s = 0; s < 256; s++)
        count[s] += counts[0][s] + counts[1][s] + counts[2][s] + counts[3][s];
    return tokens;
}

/* ---- blocks ------------------------------------------------------------------------------------- */

/* The code lengths themselves, run-length coded: 17 and 18 are runs of zeros. */
static int pack_lengths(const uint8_t *length, int n, uint8_t *symbol, uint8_t *extra)
{
    int m = 0;
    for (int i = 0; i < n;) {
        int zeros = 0;
        while (i + zeros < n && zeros < 138 && length[i + zeros] == 0)
            zeros++;
        if (zeros >= 11) {
            symbol[m] = 18;
            extra[m++] = (uint8_t)(zeros - 11);
            i += zeros;
        } else if (zeros >= 3) {
            symbol[m] = 17;
            extra[m++] = (uint8_t)(zeros - 3);
            i += zeros;
        } else {
            symbol[m] = length[i++];
            extra[m++] = 0;
        }
    }
    return m;
}

static void put_header(writer *w, const uint8_t *length, bool last)
{
    static const uint8_t order[19] = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                      11, 4,  12, 3, 13, 2, 14, 1, 15};
    uint8_t all[SYMBOLS + 1], symbol[SYMBOLS + 1], extra[SYMBOLS + 1], bits[19];
    uint16_t code[19];
    uint32_t count[19] = {0};
    memcpy(all, length, SYMBOLS);
    all[SYMBOLS] = 1; /* one distance code, for distance 1 */
    int n = pack_lengths(all, SYMBOLS + 1, symbol, extra);
    for (int i = 0; i < n; i++)
        count[symbol[i]]++;
    code_lengths(count, 19, 7, bits);
    make_codes(bits, 19, code);
    add(w, last, 1);
    add(w, 2, 2); /* dynamic Huffman */
    add(w, SYMBOLS - 257, 5);
    add(w, 0, 5);
    add(w, 19 - 4, 4);
    flush(w);
    for (int i = 0; i < 19; i++) {
        add(w, bits[order[i]], 3);
        flush(w);
    }
    for (int i = 0; i < n; i++) {
        add(w, code[symbol[i]], bits[symbol[i]]);
        if (symbol[i] >= 17)
            add(w, extra[i], symbol[i] == 17 ? 3 : 7);
        flush(w);
    }
}

static void put_block(writer *w, const uint8_t *p, int n, const uint8_t *begin, bool last)
{
    uint16_t token[BLOCK], code[SYMBOLS];
    uint8_t length[SYMBOLS];
    uint32_t count[SYMBOLS] = {[END] = 1};
    int tokens = tokenise(p, n, begin, token, count);
    code_lengths(count, SYMBOLS, MAX_BITS, length);
    make_codes(length, SYMBOLS, code);
    put_header(w, length, last);
    int i = 0;
    while (i < tokens) {
        /* three literals fit between flushes */
        if (i + 3 <= tokens && (token[i] | token[i + 1] | token[i + 2]) < 256) {
            add(w, code[token[i]], length[token[i]]);
            add(w, code[token[i + 1]], length[token[i + 1]]);
            add(w, code[token[i + 2]], length[token[i + 2]]);
            i += 3;
        } else if (token[i] < 256) {
            add(w, code[token[i]], length[token[i]]);
            i++;
        } else {
            int run = token[i] - 256, s = length_symbol(run);
            add(w, code[257 + s], length[257 + s]);
            add(w, (uint32_t)(run - length_base[s]), length_extra[s]);
            add(w, 0, 1); /* distance 1 */
            i++;
        }
        flush(w);
    }
    add(w, code[END], length[END]);
    flush(w);
}

size_t tz_deflate_fast(const uint8_t *data, size_t n, uint8_t *out, bool last)
{
    writer w = {.p = out};
    for (size_t at = 0; at < n; at += BLOCK) {
        size_t size = n - at < BLOCK ? n - at : BLOCK;
        put_block(&w, data + at, (int)size, data, last && at + size == n);
    }
    if (!last) { /* an empty stored block ends on a byte */
        add(&w, 0, 3);
        flush(&w);
        if (w.n > 0)
            add(&w, 0, 8 - w.n);
        add(&w, 0xffff0000u, 32);
    } else if (w.n > 0) {
        add(&w, 0, 8 - w.n);
    }
    flush(&w);
    return (size_t)(w.p - out);
}
