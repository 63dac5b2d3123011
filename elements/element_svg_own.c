/* SPDX-License-Identifier: Apache-2.0 */
/* Reading what elements/element_write.c has written, also after an editor has been at it.
 * Where an element's transform is the one that was written, its numbers are taken as they
 * stand, bit for bit. Where an artist has moved it, the transform counts: its samples go
 * along and it is fixed. A <use> without our attributes is a new element; one that is
 * hidden or deleted is none any more. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "elements/element_svg_photo.h"

enum { PLACE = 10, DEEPEST = 256 };

typedef struct own {
    tz_element_reader *r;
    const char *text; /* of the file, from where the next symbol is looked for */
    TZ_ARRAY(tz_svg_node)
    symbol;       /* nodes, by number */
    bool indexed; /* elements tell their index */
    TZ_ARRAY(int32_t)
    index;
    TZ_ARRAY(double)
    number;
} own;

/* ---- symbols ----------------------------------------------------------------------- */

/** Text of the next <symbol> as it stands, if that is safe; *n its length. */
static const char *raw_markup(own *o, const char *id, size_t *n)
{
    const char *p = strstr(o->text, "<symbol"), *end = p;
    if (!p)
        return NULL;
    for (char quote = 0; *end && (quote || *end != '>'); end++)
        if (quote ? *end == quote : *end == '"' || *end == '\'')
            quote = quote ? 0 : *end;
    const char *close = *end ? strstr(end, "</symbol>") : NULL;
    const char *at = strstr(p, " id=\"");
    const size_t k = strlen(id);
    if (!close || !at || at > end || strncmp(at + 5, id, k) != 0 || at[5 + k] != '"')
        return NULL;
    if (end[-1] == '/') { /* empty */
        o->text = end;
        *n = 0;
        return end;
    }
    o->text = close;
    *n = (size_t)(close - end - 1);
    for (const char *c = end + 1; c < close; c++)
        if ((unsigned char)*c >= 0x80 || strncmp(c, "<symbol", 7) == 0 ||
            strncmp(c, "<!", 2) == 0 || *c == '\r')
            return NULL;
    return end + 1;
}

/** Parts of a symbol's content as items from *item on. */
static tz_status read_parts(tz_element_reader *r, tz_svg_node n, int32_t *item)
{
    const tz_vec2 view = r->view;
    const int32_t first = r->part.n;
    r->view = (tz_vec2){1e200, 1e200}; /* nothing covers that: no backgrounds */
    tz_status s = tz_element_walk(r, n, tz_affine_identity());
    r->view = view;
    *item = r->item.n;
    for (int32_t i = first; i < r->part.n && s == TZ_OK; i++)
        if (!r->part.v[i].owned)
            s = tz_array_push(r->ctx, &r->item, i);
    return s;
}

/* Null and no offset where a symbol has no parts. */
static const int32_t *items_from(const tz_element_reader *r, int32_t item)
{
    return r->item.n > item ? r->item.v + item : NULL;
}

static tz_status copy_markup(tz_element_reader *r, const char *p, size_t n, char **out)
{
    tz_status s = tz_alloc(r->ctx, out, n + 1, 1);
    if (s == TZ_OK) {
        memcpy(*out, p, n);
        (*out)[n] = 0;
    }
    return s;
}

/** Radius about the origin of an outline. */
static double reach(const tz_element_reader *r, int32_t item)
{
    double far = 0;
    for (int32_t i = item; i < r->item.n; i++) {
        const tz_part *p = &r->part.v[r->item.v[i]];
        for (int32_t k = 0; k < p->points; k++)
            far = fmax(far, tz_vec2_length(r->point.v[p->point + k]) + p->look.width / 2);
    }
    return far;
}

static void symbol_free(tz_ctx *ctx, tz_element_symbol *y)
{
    tz_free(ctx, y->id);
    tz_free(ctx, y->markup);
    tz_free(ctx, y->words);
    tz_array_free(ctx, &y->outline);
    tz_array_free(ctx, &y->part);
}

/** Appends a symbol, or frees what there is of it. */
static tz_status keep_symbol(own *o, tz_svg_node n, tz_element_symbol *y, tz_status s)
{
    tz_element_reader *r = o->r;
    if (s == TZ_OK)
        s = tz_element_words(r->ctx, NULL, n, &y->words);
    if (s == TZ_OK)
        s = tz_array_push(r->ctx, &o->symbol, n);
    if (s == TZ_OK)
        s = tz_array_push(r->ctx, &r->set.symbol, *y);
    if (s != TZ_OK)
        symbol_free(r->ctx, y);
    return s;
}

static tz_status read_cut(own *o, tz_svg_node n, const char *id)
{
    tz_element_reader *r = o->r;
    tz_element_symbol y = {0};
    if (!tz_svg_number(tz_svg_attr(n, "tz:radius"), &y.radius))
        y.radius = 0;
    tz_status s = tz_strdup(r->ctx, id, &y.id);
    if (s == TZ_OK)
        s = copy_markup(r, "", 0, &y.markup);
    if (s == TZ_OK)
        s = tz_element_read_cut(r, n, &y);
    return keep_symbol(o, n, &y, s);
}

static tz_status read_symbol(own *o, tz_svg_node n)
{
    tz_element_reader *r = o->r;
    const char *id = tz_svg_attr(n, "id");
    tz_element_symbol y = {0};
    size_t size = 0;
    int32_t item;
    if (!id || !*id)
        return TZ_OK;
    const char *raw = raw_markup(o, id, &size);
    if (tz_element_is_cut(n))
        return read_cut(o, n, id);
    tz_svg_node child = tz_svg_child(n);
    const bool disc = child && tz_svg_attr(child, "tz:disc");
    tz_status s = read_parts(r, n, &item);
    if (s != TZ_OK)
        return s;
    if (strcmp(id, "tz-background") == 0) {
        if (!r->set.background)
            s = raw ? copy_markup(r, raw, size, &r->set.background)
                    : tz_element_markup(r, items_from(r, item), r->item.n - item,
                                        tz_affine_identity(), r->view.x,
                                        &r->set.background);
        return s;
    }
    if (!tz_svg_number(tz_svg_attr(n, "tz:radius"), &y.radius))
        y.radius = reach(r, item);
    if (!(y.radius > 0))
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: symbol \"%.60s\" shows nothing; draw it or delete it",
                       r->name, tz_svg_line(n), id);
    s = tz_strdup(r->ctx, id, &y.id);
    if (s == TZ_OK)
        s = disc  ? copy_markup(r, "", 0, &y.markup)
            : raw ? copy_markup(r, raw, size, &y.markup)
                  : tz_element_markup(r, items_from(r, item), r->item.n - item,
                                      tz_affine_identity(), y.radius, &y.markup);
    if (s == TZ_OK)
        s = tz_element_outline(r, items_from(r, item), r->item.n - item,
                               tz_affine_identity(), &y);
    return keep_symbol(o, n, &y, s);
}

static bool is_one(tz_svg_node n, const char *attr)
{
    const char *v = tz_svg_attr(n, attr);
    return v && strcmp(v, "1") == 0;
}

static tz_status read_kinds(tz_element_reader *r, tz_svg_node n)
{
    tz_status s = TZ_OK;
    for (tz_svg_node c = tz_svg_child(n); c && s == TZ_OK; c = tz_svg_next(c)) {
        const char *name = tz_svg_attr(c, "tz:class");
        tz_element_kind k = {.oriented = is_one(c, "tz:oriented"),
                             .is_void = is_one(c, "tz:void")};
        if (!name)
            continue;
        s = tz_strdup(r->ctx, name, &k.name);
        if (s == TZ_OK)
            s = tz_array_push(r->ctx, &r->set.kind, k);
        if (s != TZ_OK)
            tz_free(r->ctx, k.name);
    }
    return s;
}

/** Kinds and symbols, wherever an editor has put them. */
static tz_status read_tables(own *o, tz_svg_node n, int depth)
{
    tz_status s = TZ_OK;
    for (tz_svg_node c = tz_svg_child(n); c && s == TZ_OK; c = tz_svg_next(c)) {
        const char *id = tz_svg_attr(c, "id");
        if (tz_svg_is(c, "symbol"))
            s = read_symbol(o, c);
        else if (tz_svg_is(c, "image"))
            s = tz_element_read_image(o->r, c);
        else if (tz_svg_is(c, "g") && id && strcmp(id, "tz-kinds") == 0)
            s = read_kinds(o->r, c);
        else if (depth < DEEPEST && (tz_svg_is(c, "defs") || tz_svg_is(c, "g")))
            s = read_tables(o, c, depth + 1);
    }
    return s;
}

/* ---- elements ---------------------------------------------------------------------- */

static bool integer(double v, double lo, double hi)
{
    return v >= lo && v <= hi && v == rint(v);
}

static tz_status bad(own *o, tz_svg_node n, const char *what)
{
    return tz_fail(o->r->ctx, TZ_FORMAT, "%s:%d: %s; undo what changed it", o->r->name,
                   tz_svg_line(n), what);
}

static int by_node(const void *a, const void *b)
{
    const tz_svg_node p = *(const tz_svg_node *)a, q = *(const tz_svg_node *)b;
    return (uintptr_t)p < (uintptr_t)q ? -1 : (uintptr_t)p > (uintptr_t)q;
}

typedef struct entry {
    tz_svg_node node;
    int32_t number;
} entry;

/** Number of the symbol that n uses, -1 if it is none of ours. */
static int32_t symbol_of(const own *o, const entry *table, tz_svg_node n)
{
    const char *href = tz_svg_attr(n, "xlink:href");
    const entry key = {href && *href == '#' ? tz_svg_by_id(o->r->doc, href + 1) : NULL,
                       0};
    const entry *e =
        key.node ? bsearch(&key, table, (size_t)o->symbol.n, sizeof *table, by_node)
                 : NULL;
    return e ? e->number : -1;
}

static tz_status read_numbers(own *o, tz_svg_node n, const char *attr)
{
    tz_numbers v = {o->number.v, 0, o->number.cap};
    const tz_status s = tz_svg_numbers(o->r->ctx, tz_svg_attr(n, attr), &v);
    o->number.v = v.v;
    o->number.cap = v.cap;
    o->number.n = v.n;
    return s == TZ_INVALID ? TZ_FORMAT : s;
}

static bool near_map(tz_affine a, tz_affine b)
{
    const double size = fabs(b.a) + fabs(b.b), far = 1 + fabs(b.e) + fabs(b.f);
    return fabs(a.a - b.a) <= 1e-9 * size && fabs(a.b - b.b) <= 1e-9 * size &&
           fabs(a.c - b.c) <= 1e-9 * size && fabs(a.d - b.d) <= 1e-9 * size &&
           fabs(a.e - b.e) <= 1e-9 * far && fabs(a.f - b.f) <= 1e-9 * far;
}

static tz_affine map_of(const tz_element *e)
{
    const double c = cos(e->angle) * e->scale, d = sin(e->angle) * e->scale;
    return (tz_affine){c, d, -d, c, e->at.x, e->at.y};
}

static tz_status read_samples(own *o, tz_svg_node n, tz_element *e)
{
    tz_element_reader *r = o->r;
    e->sample = r->set.sample.n;
    e->samples = 1;
    if (!tz_svg_attr(n, "tz:samples"))
        return tz_array_push(r->ctx, &r->set.sample, ((tz_sample){e->at, 0, 1}));
    tz_status s = read_numbers(o, n, "tz:samples");
    if (s != TZ_OK)
        return s;
    const double *v = o->number.v;
    if (o->number.n < 5 || o->number.n % 5)
        return bad(o, n, "tz:samples does not hold five numbers a sample");
    e->samples = o->number.n / 5;
    for (int32_t i = 0; i < e->samples && s == TZ_OK; i++, v += 5) {
        if (!integer(v[3], INT32_MIN, INT32_MAX))
            return bad(o, n, "tz:samples holds an id that is no number");
        s = tz_array_push(r->ctx, &r->set.sample,
                          ((tz_sample){{v[0], v[1], v[2]}, (int32_t)v[3], v[4]}));
    }
    return s;
}

/** Takes over what an artist has done to an element. */
static void move_element(own *o, tz_element *e, tz_affine map, bool known)
{
    tz_element_set *set = &o->r->set;
    const tz_affine was = map_of(e);
    tz_affine back;
    for (int32_t i = e->sample; i < e->sample + e->samples; i++) {
        tz_vec3 *p = &set->sample.v[i].at;
        tz_vec2 q = {map.e, map.f};
        if (known && tz_affine_invert(was, &back))
            q = tz_affine_apply(tz_affine_then(back, map), (tz_vec2){p->x, p->y});
        p->x = q.x;
        p->y = q.y;
    }
    const double scale = sqrt(fabs(tz_affine_det(map)));
    e->at.x = map.e;
    e->at.y = map.f;
    e->angle = atan2(map.b, map.a);
    e->radius =
        known ? e->radius * scale / e->scale : set->symbol.v[e->symbol].radius * scale;
    e->scale = scale;
    e->fixed = true;
}

static tz_status read_place(own *o, tz_svg_node n, tz_element *e, int32_t *index)
{
    const tz_element_set *set = &o->r->set;
    tz_status s = read_numbers(o, n, "tz:place");
    if (s != TZ_OK)
        return s;
    const double *v = o->number.v;
    if (o->number.n != PLACE && o->number.n != PLACE + 1)
        return bad(o, n, "tz:place does not hold ten numbers");
    if (!integer(v[0], 0, set->kind.n - 1) || !integer(v[1], INT32_MIN, INT32_MAX) ||
        !integer(v[2], -1, INT32_MAX) || !integer(v[3], 0, 7) || !(v[8] > 0) ||
        !(v[9] > 0))
        return bad(o, n, "tz:place holds a number that cannot be");
    e->kind = (int32_t)v[0];
    e->depth = (int32_t)v[1];
    e->source = (int32_t)v[2];
    e->cut = (int)v[3] & 1;
    e->fixed = (int)v[3] & 2;
    e->doubtful = (int)v[3] & 4;
    e->at = (tz_vec3){v[4], v[5], v[6]};
    e->angle = v[7];
    e->scale = v[8];
    e->radius = v[9];
    *index = -1;
    if (o->number.n > PLACE) {
        if (!integer(v[10], 0, INT32_MAX))
            return bad(o, n, "tz:place holds an index that cannot be");
        *index = (int32_t)v[10];
        o->indexed = true;
    }
    return TZ_OK;
}

static tz_status read_use(own *o, const entry *table, tz_svg_node n, tz_affine map)
{
    tz_element_reader *r = o->r;
    const bool known = tz_svg_attr(n, "tz:place") != NULL;
    double x, y;
    bool hidden;
    int32_t index = -1;
    tz_element e = {.symbol = symbol_of(o, table, n),
                    .source = -1,
                    .scale = 1,
                    .radius = 1,
                    .depth = r->set.element.n};
    if (e.symbol < 0 && !known)
        return TZ_OK;
    if (e.symbol < 0)
        return bad(o, n, "the symbol that is used does not exist");
    tz_status s = tz_element_length(r, n, "x", r->view.x, 0, &x);
    if (s == TZ_OK)
        s = tz_element_length(r, n, "y", r->view.y, 0, &y);
    if (s == TZ_OK && known)
        s = read_place(o, n, &e, &index);
    if (s == TZ_OK)
        s = tz_element_is_hidden(r, n, &hidden);
    if (s == TZ_OK && hidden &&
        !(known && (r->set.kind.v[e.kind].is_void || tz_svg_attr(n, "tz:bent"))))
        return TZ_OK; /* void and bent elements are hidden as they are written */
    if (s == TZ_OK)
        s = read_samples(o, n, &e);
    if (s != TZ_OK)
        return s;
    if (x != 0 || y != 0)
        map = tz_affine_then((tz_affine){1, 0, 0, 1, x, y}, map);
    if (!(fabs(tz_affine_det(map)) > 1e-300))
        return bad(o, n, "the element is squeezed to nothing");
    if (!known || !near_map(map, map_of(&e)))
        move_element(o, &e, map, known);
    if (!known) /* of the kind that its symbol has had so far */
        for (int32_t i = 0; i < r->set.element.n; i++)
            if (r->set.element.v[i].symbol == e.symbol) {
                e.kind = r->set.element.v[i].kind;
                break;
            }
    s = tz_array_push(r->ctx, &o->index, index);
    return s == TZ_OK ? tz_array_push(r->ctx, &r->set.element, e) : s;
}

static tz_status read_elements(own *o, const entry *table, tz_svg_node n, tz_affine map,
                               int depth);

static tz_status read_group(own *o, const entry *table, tz_svg_node n, tz_affine map,
                            int depth)
{
    bool hidden;
    const tz_status s = tz_element_is_hidden(o->r, n, &hidden);
    return s != TZ_OK || hidden ? s : read_elements(o, table, n, map, depth);
}

static tz_status read_elements(own *o, const entry *table, tz_svg_node n, tz_affine map,
                               int depth)
{
    tz_status s = TZ_OK;
    for (tz_svg_node c = tz_svg_child(n); c && s == TZ_OK; c = tz_svg_next(c)) {
        const bool use = tz_svg_is(c, "use");
        tz_affine m, all;
        if ((!use && !tz_svg_is(c, "g")) || tz_svg_attr(c, "tz:copy"))
            continue;
        if (tz_svg_transform(NULL, tz_svg_attr(c, "transform"), &m) != TZ_OK)
            return bad(o, c, "its transform cannot be read");
        all = tz_affine_then(m, map);
        if (depth == 0)
            all = m; /* to the bit */
        if (!tz_affine_finite(all))
            return bad(o, c, "its transform overflows");
        if (use)
            s = read_use(o, table, c, all);
        else if (depth < DEEPEST)
            s = read_group(o, table, c, all, depth + 1);
    }
    return s;
}

typedef struct ranked {
    int32_t index, place;
} ranked;

static int by_index(const void *a, const void *b)
{
    const ranked *p = a, *q = b;
    if (p->index != q->index)
        return p->index < q->index ? -1 : 1;
    return (p->place > q->place) - (p->place < q->place);
}

/** Puts elements back into the order of their indices, new ones behind; samples too. */
static tz_status restore_order(own *o)
{
    tz_element_set *set = &o->r->set;
    const int32_t n = set->element.n;
    ranked *rank = NULL;
    tz_element *e = NULL;
    tz_sample *p = NULL;
    int32_t at = 0;
    if (!o->indexed)
        return TZ_OK;
    tz_status s = tz_alloc(o->r->ctx, &rank, (size_t)n, sizeof *rank);
    if (s == TZ_OK)
        s = tz_alloc(o->r->ctx, &e, (size_t)n, sizeof *e);
    if (s == TZ_OK)
        s = tz_alloc(o->r->ctx, &p, (size_t)set->sample.n, sizeof *p);
    for (int32_t i = 0; i < n && s == TZ_OK; i++)
        rank[i] = (ranked){o->index.v[i] < 0 ? INT32_MAX : o->index.v[i], i};
    if (s == TZ_OK && n > 0)
        qsort(rank, (size_t)n, sizeof *rank, by_index);
    for (int32_t i = 0; i < n && s == TZ_OK; i++) {
        e[i] = set->element.v[rank[i].place];
        memcpy(p + at, set->sample.v + e[i].sample, (size_t)e[i].samples * sizeof *p);
        e[i].sample = at;
        at += e[i].samples;
    }
    if (s == TZ_OK && n > 0) {
        memcpy(set->element.v, e, (size_t)n * sizeof *e);
        memcpy(set->sample.v, p, (size_t)at * sizeof *p);
    }
    tz_free(o->r->ctx, rank);
    tz_free(o->r->ctx, e);
    tz_free(o->r->ctx, p);
    return s;
}

/* ---- the document ------------------------------------------------------------------ */

static tz_status read_all(own *o)
{
    tz_element_reader *r = o->r;
    tz_svg_node root = tz_svg_root(r->doc);
    entry *table = NULL;
    tz_status s = tz_svg_attr(root, "tz:size") ? read_numbers(o, root, "tz:size") : TZ_OK;
    if (s != TZ_OK || o->number.n != 3 || !(o->number.v[0] > 0) || !(o->number.v[1] > 0))
        return s == TZ_NOMEM ? s : bad(o, root, "tz:size does not hold three sizes");
    r->set.domain = (tz_domain){.size = {o->number.v[0], o->number.v[1], o->number.v[2]},
                                .torus = is_one(root, "tz:torus")};
    r->view = (tz_vec2){o->number.v[0], o->number.v[1]};
    s = tz_style_load(r);
    if (s == TZ_OK)
        s = read_tables(o, root, 0);
    if (s == TZ_OK)
        s = tz_element_join_photos(r);
    if (s == TZ_OK)
        s = tz_alloc(r->ctx, &table, (size_t)o->symbol.n, sizeof *table);
    for (int32_t i = 0; i < o->symbol.n && s == TZ_OK; i++)
        table[i] = (entry){o->symbol.v[i], i};
    if (s == TZ_OK && o->symbol.n > 0)
        qsort(table, (size_t)o->symbol.n, sizeof *table, by_node);
    if (s == TZ_OK)
        s = read_elements(o, table, root, tz_affine_identity(), 0);
    tz_free(r->ctx, table);
    if (s == TZ_OK && r->set.element.n == 0 && !r->may_lack)
        return tz_fail(r->ctx, TZ_INVALID,
                       "%s: there are no elements in it; place some first", r->name);
    return s == TZ_OK ? restore_order(o) : s;
}

tz_status tz_element_read_own(tz_element_reader *r, const char *text)
{
    own o = {.r = r, .text = text};
    tz_status s = read_all(&o);
    tz_array_free(r->ctx, &o.symbol);
    tz_array_free(r->ctx, &o.index);
    tz_array_free(r->ctx, &o.number);
    return s;
}
