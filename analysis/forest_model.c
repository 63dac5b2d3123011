/* SPDX-License-Identifier: Apache-2.0 */
/* The file is YAML as OpenCV's FileStorage writes it: a map `options` of whole numbers and
 * five tables of lists. Every index is checked before a detector follows it. */
#include "analysis/forest_model.h"

#include <float.h>
#include <libdeflate.h>
#include <math.h>
#include <string.h>

#include "analysis/forest_features.h"
#include "base/array.h"
#include "base/file.h"
#include "base/number.h"

#define LARGEST_FILE ((size_t)1 << 28)
#define LARGEST_TEXT ((size_t)1 << 29)
#define MOST_TREES   64

static const struct {
    const char *name;
    int32_t value; /* the only one that Terrazzo's detector computes; -1 = read it */
} options[] = {
    {"numberOfTrees", -1},
    {"numberOfTreesToEvaluate", -1},
    {"selfsimilarityGridSize", TZ_FOREST_GRID},
    {"stride", 2},
    {"shrinkNumber", 2},
    {"patchSize", TZ_FOREST_PATCH},
    {"patchInnerSize", TZ_FOREST_INNER},
    {"numberOfGradientOrientations", 4},
    {"gradientSmoothingRadius", 0},
    {"regFeatureSmoothingRadius", 2},
    {"ssFeatureSmoothingRadius", 8},
    {"gradientNormalizationRadius", 4},
};
enum { OPTIONS = sizeof options / sizeof *options };

void tz_forest_deinit(tz_forest *f)
{
    tz_free(f->ctx, f->child);
    tz_free(f->ctx, f->feature);
    tz_free(f->ctx, f->threshold);
    tz_free(f->ctx, f->bound);
    tz_free(f->ctx, f->bin);
    *f = (tz_forest){0};
}

/* ---- reading: text ----------------------------------------------------------------- */

typedef struct reader {
    tz_ctx *ctx;
    const char *path;
    char *text;
    const char *end; /* a zero byte stands here */
} reader;

static tz_status bad(const reader *r, const char *fault)
{
    tz_fail(r->ctx, TZ_FORMAT, "%s: not a structured-forest model: %s", r->path, fault);
    return TZ_FORMAT;
}

/* Gzip's trailer tells the size modulo 2^32; a liar runs out of room. */
static tz_status unpack(reader *r, char *packed, size_t n)
{
    struct libdeflate_decompressor *d = NULL;
    size_t size = 0;
    tz_status s;
    if (n < 18)
        return bad(r, "the gzip data are cut off");
    for (int i = 0; i < 4; i++)
        size |= (size_t)(uint8_t)packed[n - 4 + (size_t)i] << (8 * i);
    if (size > LARGEST_TEXT)
        return bad(r, "the gzip data are cut off or unpack to more than 512 MiB");
    if ((s = tz_alloc(r->ctx, &r->text, size + 1, 1)) != TZ_OK)
        return s;
    if (!(d = libdeflate_alloc_decompressor()))
        return tz_fail(r->ctx, TZ_NOMEM, "%s: out of memory", r->path);
    const bool whole = libdeflate_gzip_decompress(d, packed, n, r->text, size, NULL) ==
                       LIBDEFLATE_SUCCESS;
    libdeflate_free_decompressor(d);
    if (!whole)
        return bad(r, "the gzip data are damaged or cut off");
    r->text[size] = 0;
    r->end = r->text + size;
    return TZ_OK;
}

static tz_status load(reader *r)
{
    char *file = NULL;
    size_t n = 0;
    tz_status s = tz_file_read(r->ctx, r->path, LARGEST_FILE, &file, &n);
    if (s != TZ_OK)
        return s;
    if (n >= 2 && (uint8_t)file[0] == 0x1f && (uint8_t)file[1] == 0x8b) {
        s = unpack(r, file, n);
        tz_free(r->ctx, file);
    } else {
        r->text = file;
        r->end = file + n;
    }
    if (s == TZ_OK && memchr(r->text, 0, (size_t)(r->end - r->text)))
        s = bad(r, "it is not text");
    if (s == TZ_OK && (r->end - r->text < 5 || memcmp(r->text, "%YAML", 5) != 0))
        s = bad(r, "it does not begin with %YAML");
    return s;
}

static bool blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

static const char *skip(const char *p)
{
    while (blank(*p))
        p++;
    return p;
}

/* Behind "name:" at the start of a line, or NULL. */
static const char *find_key(const reader *r, const char *name)
{
    const size_t n = strlen(name);
    for (const char *p = r->text; p; p = memchr(p, '\n', (size_t)(r->end - p))) {
        p = p == r->text ? p : p + 1;
        if (p >= r->end)
            return NULL;
        if (strncmp(p, name, n) == 0 && p[n] == ':')
            return p + n + 1;
    }
    return NULL;
}

static tz_status read_options(const reader *r, int32_t value[OPTIONS])
{
    char what[120];
    const char *map = find_key(r, "options");
    if (!map)
        return bad(r, "no options");
    for (int i = 0; i < OPTIONS; i++)
        value[i] = INT32_MIN;
    for (const char *p = skip(map); p > map && p[-1] == ' ';) {
        const char *colon = p + strcspn(p, ":\n"), *after;
        double v;
        if (*colon != ':' || !tz_number_parse(skip(colon + 1), &after, &v))
            return bad(r, "an option is not a number");
        for (int i = 0; i < OPTIONS; i++)
            if (strlen(options[i].name) == (size_t)(colon - p) &&
                strncmp(options[i].name, p, (size_t)(colon - p)) == 0 && v >= -1e6 &&
                v <= 1e6)
                value[i] = (int32_t)v;
        p = skip(after);
    }
    for (int i = 0; i < OPTIONS; i++) {
        if (value[i] == INT32_MIN) {
            snprintf(what, sizeof what, "option %s is missing", options[i].name);
            return bad(r, what);
        }
        if (options[i].value >= 0 && value[i] != options[i].value)
            return tz_fail(r->ctx, TZ_UNSUPPORTED,
                           "%s: option %s is %d; this program computes edges with %d "
                           "only, so take another model",
                           r->path, options[i].name, value[i], options[i].value);
    }
    if (value[0] < 1 || value[0] > MOST_TREES)
        return bad(r, "option numberOfTrees is out of range");
    if (value[1] < 1 || value[1] > value[0])
        return bad(r, "option numberOfTreesToEvaluate is out of range");
    return TZ_OK;
}

/* ---- reading: lists ------------------------------------------------------------------ */

/* Where one list stands: text behind '[' to ']'. */
typedef struct list {
    const char *from, *to;
    int64_t n;
} list;

#define CHUNK ((int64_t)1 << 16) /* text bytes a task */

typedef struct list_job {
    const reader *r;
    const char *name;
    list l;
    int64_t *count; /* numbers in front of a chunk */
    int32_t *whole; /* one of the three is wanted */
    float *real;
    uint8_t *byte;
} list_job;

/* Chunk i begins behind the first comma at or after its share of the text. */
static const char *chunk_start(const list *l, int64_t i)
{
    const int64_t at = i * CHUNK, n = l->to - l->from;
    if (i == 0)
        return l->from;
    if (at >= n)
        return l->to;
    const char *comma = memchr(l->from + at, ',', (size_t)(n - at));
    return comma ? comma + 1 : l->to;
}

static tz_status count_chunk(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    list_job *j = arg;
    const char *p = chunk_start(&j->l, i), *to = chunk_start(&j->l, i + 1);
    int64_t n = 0;
    (void)ctx, (void)worker;
    for (; p < to; p++)
        n += *p == ',';
    j->count[i + 1] = n;
    return TZ_OK;
}

/* A whole number; false if it is none or has more than nine digits. */
static bool parse_whole(const char **text, int32_t *out)
{
    const char *p = *text;
    const bool minus = *p == '-';
    int32_t v = 0, digits = 0;
    for (p += minus; *p >= '0' && *p <= '9'; p++, digits++)
        v = digits < 9 ? 10 * v + (*p - '0') : v;
    *out = minus ? -v : v;
    *text = p;
    return digits > 0 && digits <= 9;
}

static bool parse_one(const list_job *j, const char **p, int64_t at)
{
    int32_t whole;
    double real;
    if (j->real) {
        if (!tz_number_parse(*p, p, &real))
            return false;
        j->real[at] = (float)real;
        return fabs(real) <= FLT_MAX;
    }
    if (!parse_whole(p, &whole))
        return false;
    if (j->byte) {
        j->byte[at] = (uint8_t)whole;
        return whole >= 0 && whole < TZ_FOREST_INNER * TZ_FOREST_INNER;
    }
    j->whole[at] = whole;
    return true;
}

static tz_status parse_chunk(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const list_job *j = arg;
    const char *p = chunk_start(&j->l, i), *to = chunk_start(&j->l, i + 1);
    const int64_t last = to == j->l.to ? j->l.n : j->count[i + 1];
    char what[120];
    (void)worker;
    if (i > 0 && p == j->l.to) /* the last number lies across this chunk's start */
        return TZ_OK;
    for (int64_t at = j->count[i]; at < last; at++) {
        p = skip(p);
        if (p >= to || !parse_one(j, &p, at)) {
            snprintf(what, sizeof what, "%s: number %lld is none or is out of range",
                     j->name, (long long)at + 1);
            return bad(j->r, what);
        }
        p = skip(p);
        if (p < to && *p++ != ',') {
            snprintf(what, sizeof what, "%s: no comma behind number %lld", j->name,
                     (long long)at + 1);
            return bad(j->r, what);
        }
    }
    return tz_ctx_cancelled(ctx) ? TZ_CANCELLED : TZ_OK;
}

/* Counts the numbers of a list; with a target set, parses them. */
static tz_status read_list(list_job *j, bool parse)
{
    tz_ctx *ctx = j->r->ctx;
    const int64_t chunks = (j->l.to - j->l.from + CHUNK - 1) / CHUNK;
    tz_status s = TZ_OK;
    if (!parse && skip(j->l.from) == j->l.to)
        return TZ_OK;
    if ((s = tz_alloc_zero(ctx, &j->count, (size_t)chunks + 1, sizeof *j->count)) !=
        TZ_OK)
        goto done;
    if ((s = tz_parallel_for(ctx, chunks, count_chunk, j)) != TZ_OK)
        goto done;
    for (int64_t i = 0; i < chunks; i++)
        j->count[i + 1] += j->count[i];
    j->l.n = j->count[chunks] + 1;
    if (parse)
        s = tz_parallel_for(ctx, chunks, parse_chunk, j);
done:
    tz_free(ctx, j->count);
    j->count = NULL;
    return s;
}

/* Finds the next list at *p and counts its numbers. */
static tz_status next_list(const reader *r, const char *name, const char **p, list *l)
{
    list_job j = {.r = r, .name = name};
    char what[120];
    const char *close = NULL;
    if (**p == '[')
        close = memchr(*p, ']', (size_t)(r->end - *p));
    if (!close) {
        snprintf(what, sizeof what, "%s: a list is missing or is cut off", name);
        return bad(r, what);
    }
    j.l = (list){*p + 1, close, 0};
    *p = close + 1;
    const tz_status s = read_list(&j, false);
    *l = j.l;
    return s;
}

/* One row a tree, all of one length. */
static tz_status read_table(const reader *r, const char *name, tz_forest *f,
                            int32_t **whole, float **real)
{
    list row[MOST_TREES];
    char what[120];
    const char *p = find_key(r, name);
    tz_status s;
    for (int32_t t = 0; t < f->trees; t++) {
        p = p ? skip(p) : "";
        if (*p != '-') {
            snprintf(what, sizeof what, "%s has no row for tree %d", name, t + 1);
            return bad(r, what);
        }
        p = skip(p + 1);
        if ((s = next_list(r, name, &p, &row[t])) != TZ_OK)
            return s;
        if (row[t].n < 1 || row[t].n > INT32_MAX / MOST_TREES ||
            (f->nodes && row[t].n != f->nodes)) {
            snprintf(what, sizeof what, "%s has rows of different lengths", name);
            return bad(r, what);
        }
        f->nodes = (int32_t)row[t].n;
    }
    const size_t n = (size_t)f->trees * (size_t)f->nodes;
    s = whole ? tz_alloc(r->ctx, whole, n, sizeof **whole)
              : tz_alloc(r->ctx, real, n, sizeof **real);
    for (int32_t t = 0; t < f->trees && s == TZ_OK; t++) {
        const size_t at = (size_t)t * (size_t)f->nodes;
        list_job j = {.r = r,
                      .name = name,
                      .l = row[t],
                      .whole = whole ? *whole + at : NULL,
                      .real = real ? *real + at : NULL};
        s = read_list(&j, true);
    }
    return s;
}

/* A list of its own; into `whole` or `byte`. */
static tz_status read_row(const reader *r, const char *name, int32_t **whole,
                          uint8_t **byte, int64_t *n)
{
    const char *p = find_key(r, name);
    list_job j = {.r = r, .name = name};
    tz_status s;
    p = p ? skip(p) : "";
    if ((s = next_list(r, name, &p, &j.l)) != TZ_OK)
        return s;
    *n = j.l.n;
    s = whole ? tz_alloc(r->ctx, whole, (size_t)j.l.n, sizeof **whole)
              : tz_alloc(r->ctx, byte, (size_t)j.l.n, 1);
    if (s != TZ_OK || j.l.n == 0)
        return s;
    j.whole = whole ? *whole : NULL;
    j.byte = byte ? *byte : NULL;
    return read_list(&j, true);
}

/* ---- checks -------------------------------------------------------------------------- */

static tz_status check_nodes(const reader *r, const tz_forest *f)
{
    char what[120];
    for (int32_t t = 0; t < f->trees; t++)
        for (int32_t i = 0; i < f->nodes; i++) {
            const size_t at = (size_t)t * (size_t)f->nodes + (size_t)i;
            const int32_t c = f->child[at];
            const char *fault = NULL;
            /* children stand behind their parents, so that every walk ends */
            if (c != 0 && (c - 1 <= i || c >= f->nodes))
                fault = "has children out of range";
            else if (c != 0 &&
                     (f->feature[at] < 0 || f->feature[at] >= TZ_FOREST_FEATURES))
                fault = "has a feature out of range";
            if (fault) {
                snprintf(what, sizeof what, "node %d of tree %d %s", i, t + 1, fault);
                return bad(r, what);
            }
        }
    return TZ_OK;
}

/* Several bounds a node are allowed by the format; the first of each counts. */
static tz_status take_bounds(const reader *r, tz_forest *f, int64_t bounds, int64_t bins)
{
    const int64_t n = (int64_t)f->trees * f->nodes;
    if (bounds < n + 1 || (bounds - 1) % n != 0)
        return bad(r, "edgeBoundaries has another length");
    if (bounds != n + 1)
        return tz_fail(r->ctx, TZ_UNSUPPORTED,
                       "%s: has several boundary maps a leaf; take a model with one",
                       r->path);
    for (int64_t i = 0; i < bounds; i++)
        if (f->bound[i] < 0 || f->bound[i] > bins ||
            (i > 0 && f->bound[i] < f->bound[i - 1]))
            return bad(r, "edgeBoundaries does not rise");
    return TZ_OK;
}

tz_status tz_forest_read(tz_ctx *ctx, const char *path, tz_forest *out)
{
    reader r = {.ctx = ctx, .path = path};
    tz_forest f = {.ctx = ctx};
    int32_t value[OPTIONS];
    int64_t bounds = 0, bins = 0;
    tz_status s;
    *out = (tz_forest){0};
    if ((s = load(&r)) != TZ_OK)
        goto done;
    if ((s = read_options(&r, value)) != TZ_OK)
        goto done;
    f.trees = value[0];
    f.evaluated = value[1];
    if ((s = read_table(&r, "childs", &f, &f.child, NULL)) != TZ_OK)
        goto done;
    if ((s = read_table(&r, "featureIds", &f, &f.feature, NULL)) != TZ_OK)
        goto done;
    if ((s = read_table(&r, "thresholds", &f, NULL, &f.threshold)) != TZ_OK)
        goto done;
    if ((s = check_nodes(&r, &f)) != TZ_OK)
        goto done;
    if ((s = read_row(&r, "edgeBoundaries", &f.bound, NULL, &bounds)) != TZ_OK)
        goto done;
    if ((s = read_row(&r, "edgeBins", NULL, &f.bin, &bins)) != TZ_OK)
        goto done;
    s = take_bounds(&r, &f, bounds, bins);
done:
    tz_free(ctx, r.text);
    if (s == TZ_OK)
        *out = f;
    else
        tz_forest_deinit(&f);
    return s;
}

/* ---- writing ------------------------------------------------------------------------- */

typedef struct writer {
    TZ_ARRAY(char)
    text;
    int64_t line; /* where the line began */
    tz_ctx *ctx;
    tz_status s;
} writer;

static void put(writer *w, const char *piece)
{
    const int64_t n = (int64_t)strlen(piece);
    if (w->s == TZ_OK)
        w->s = tz_array_reserve(w->ctx, &w->text, w->text.n + n);
    if (w->s != TZ_OK)
        return;
    memcpy(w->text.v + w->text.n, piece, (size_t)n);
    w->text.n += n;
}

/* The next number of a list, without blanks: a third of the file would be blanks. */
static void put_number(writer *w, bool first, const char *number)
{
    if (!first)
        put(w, ",");
    if (w->text.n - w->line > 240) {
        put(w, "\n      ");
        w->line = w->text.n;
    }
    put(w, number);
}

static void put_whole(writer *w, bool first, int32_t v)
{
    char number[16];
    snprintf(number, sizeof number, "%d", v);
    put_number(w, first, number);
}

/* Fewest digits that give the same float; a point makes it a real for YAML. */
static void put_real(writer *w, bool first, float v)
{
    char number[40];
    const char *end;
    double back = 0;
    for (int digits = 3; digits <= 9; digits++) {
        snprintf(number, sizeof number, "%.*g", digits, (double)v);
        if (tz_number_parse(number, &end, &back) && (float)back == v)
            break;
    }
    if (!strpbrk(number, ".e"))
        strcat(number, ".");
    put_number(w, first, number);
}

static void put_table(writer *w, const char *name, const tz_forest *f,
                      const int32_t *whole, const float *real)
{
    put(w, name);
    put(w, ":\n");
    for (int32_t t = 0; t < f->trees && w->s == TZ_OK; t++) {
        put(w, "   - [");
        w->line = w->text.n;
        for (int32_t i = 0; i < f->nodes && w->s == TZ_OK; i++) {
            const size_t at = (size_t)t * (size_t)f->nodes + (size_t)i;
            if (whole)
                put_whole(w, i == 0, whole[at]);
            else
                put_real(w, i == 0, real[at]);
        }
        put(w, " ]\n");
    }
}

static tz_status write_text(writer *w, const tz_forest *f)
{
    char line[80];
    const int64_t bounds = (int64_t)f->trees * f->nodes + 1;
    put(w, "%YAML:1.0\n---\noptions:\n");
    for (int i = 0; i < OPTIONS; i++) {
        const int32_t v = i == 0 ? f->trees : i == 1 ? f->evaluated : options[i].value;
        snprintf(line, sizeof line, "   %s: %d\n", options[i].name, v);
        put(w, line);
    }
    put_table(w, "childs", f, f->child, NULL);
    put_table(w, "featureIds", f, f->feature, NULL);
    put_table(w, "thresholds", f, NULL, f->threshold);
    put(w, "edgeBoundaries: [");
    w->line = w->text.n;
    for (int64_t i = 0; i < bounds && w->s == TZ_OK; i++)
        put_whole(w, i == 0, f->bound[i]);
    put(w, " ]\nedgeBins: [");
    w->line = w->text.n;
    for (int64_t i = 0; i < f->bound[bounds - 1] && w->s == TZ_OK; i++)
        put_whole(w, i == 0, f->bin[i]);
    put(w, " ]\n");
    return w->s;
}

static tz_status pack(tz_ctx *ctx, const char *text, size_t n, char **out, size_t *size)
{
    struct libdeflate_compressor *c = libdeflate_alloc_compressor(12);
    if (!c)
        return tz_fail(ctx, TZ_NOMEM, "out of memory");
    const size_t room = libdeflate_gzip_compress_bound(c, n);
    const tz_status s = tz_alloc(ctx, out, room, 1);
    if (s == TZ_OK)
        *size = libdeflate_gzip_compress(c, text, n, *out, room);
    libdeflate_free_compressor(c);
    return s;
}

tz_status tz_forest_write(tz_ctx *ctx, const char *path, const tz_forest *f)
{
    const size_t length = strlen(path);
    const bool gzip = length > 3 && strcmp(path + length - 3, ".gz") == 0;
    writer w = {.ctx = ctx};
    tz_file_out out = {0};
    char *packed = NULL;
    size_t size = 0;
    tz_status s;
    if ((s = write_text(&w, f)) != TZ_OK)
        goto done;
    if (gzip && (s = pack(ctx, w.text.v, (size_t)w.text.n, &packed, &size)) != TZ_OK)
        goto done;
    if ((s = tz_file_out_open(ctx, path, &out)) != TZ_OK)
        goto done;
    if (gzip)
        fwrite(packed, 1, size, out.f);
    else
        fwrite(w.text.v, 1, (size_t)w.text.n, out.f);
    s = tz_file_out_commit(&out);
done:
    tz_file_out_abort(&out);
    tz_free(ctx, packed);
    tz_array_free(ctx, &w.text);
    return s;
}
