/* SPDX-License-Identifier: Apache-2.0 */
/* The exemplar document, read: nothing in it is believed. Ids must be complete and
 * unique, outlines must tile the photo and be 4-connected, chains must stay inside it,
 * lists must agree with each other; else the message names the line. */
#include <string.h>

#include "analysis/chain.h"
#include "analysis/outline.h"

#define MAX_PIXELS ((int64_t)1 << 30)

typedef struct reader {
    tz_ctx *ctx;
    const char *name;
    tz_svg_doc *doc;
    tz_ebpt e;
    tz_numbers n;        /* scratch */
    tz_svg_node *region; /* by group */
    tz_svg_node *line;   /* by edge */
    tz_svg_node head;    /* <g id="regions"> */
    tz_svg_node image;
    int64_t sides; /* pixel sides left for outlines */
} reader;

/* ---- values ---------------------------------------------------------------------- */

static tz_status bad(reader *r, tz_svg_node at, const char *what)
{
    return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: %s", r->name, tz_svg_line(at), what);
}

/* Numbers of an attribute into r->n; exactly `count` of them unless count < 0. */
static tz_status numbers(reader *r, tz_svg_node at, const char *attr, int32_t count)
{
    const char *text = tz_svg_attr(at, attr);
    r->n.n = 0;
    if (!text && count < 0)
        return TZ_OK;
    if (!text)
        return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: %s is missing", r->name,
                       tz_svg_line(at), attr);
    tz_status s = tz_svg_numbers(NULL, text, &r->n);
    if (s == TZ_INVALID || (s == TZ_OK && count >= 0 && r->n.n != count))
        return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: %s is not %s", r->name, tz_svg_line(at),
                       attr, count == 1 ? "a number" : "a list of numbers as written");
    if (s != TZ_OK)
        return tz_fail(r->ctx, s, "%s:%d: %s is too long", r->name, tz_svg_line(at),
                       attr);
    return TZ_OK;
}

static bool integer(double v, int32_t lo, int32_t hi, int32_t *out)
{
    if (!(v >= lo && v <= hi) || v != floor(v))
        return false;
    *out = (int32_t)v;
    return true;
}

static tz_status one_integer(reader *r, tz_svg_node at, const char *attr, int32_t lo,
                             int32_t hi, int32_t *out)
{
    tz_status s = numbers(r, at, attr, 1);
    if (s == TZ_OK && !integer(r->n.v[0], lo, hi, out))
        s = tz_fail(r->ctx, TZ_FORMAT, "%s:%d: %s is not within %d..%d", r->name,
                    tz_svg_line(at), attr, lo, hi);
    return s;
}

static tz_status two_integers(reader *r, tz_svg_node at, const char *attr, int32_t hi_a,
                              int32_t hi_b, int32_t *a, int32_t *b)
{
    tz_status s = numbers(r, at, attr, 2);
    if (s == TZ_OK &&
        (!integer(r->n.v[0], 0, hi_a, a) || !integer(r->n.v[1], 0, hi_b, b)))
        s = tz_fail(r->ctx, TZ_FORMAT, "%s:%d: %s is out of range", r->name,
                    tz_svg_line(at), attr);
    return s;
}

static tz_status one_double(reader *r, tz_svg_node at, const char *attr, double *out)
{
    tz_status s = numbers(r, at, attr, 1);
    if (s == TZ_OK)
        *out = r->n.v[0];
    return s;
}

static tz_status one_point(reader *r, tz_svg_node at, const char *attr, tz_vec2 *out)
{
    tz_status s = numbers(r, at, attr, 2);
    if (s == TZ_OK)
        *out = (tz_vec2){r->n.v[0], r->n.v[1]};
    return s;
}

/* The attribute's ids into r->n, each 0..hi, rising if `rising`. */
static tz_status id_list(reader *r, tz_svg_node at, const char *attr, int32_t hi,
                         bool rising)
{
    tz_status s = numbers(r, at, attr, -1);
    for (int32_t i = 0, id, last = -1; i < r->n.n && s == TZ_OK; i++, last = id)
        if (!integer(r->n.v[i], 0, hi, &id) || (rising && id <= last))
            return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: %s holds an id out of range%s",
                           r->name, tz_svg_line(at), attr, rising ? " or order" : "");
    return s;
}

/* Appends what id_list found. Expression of type tz_status. */
#define APPEND_IDS(r, a)                                                  \
    (tz_array_reserve((r)->ctx, (a), (int64_t)(a)->n + (r)->n.n) == TZ_OK \
         ? (copy_ids(&(r)->n, (a)->v, (a)->n), (a)->n += (r)->n.n, TZ_OK) \
         : TZ_NOMEM)

static void copy_ids(const tz_numbers *n, int32_t *to, int32_t at)
{
    for (int32_t i = 0; i < n->n; i++)
        to[at + i] = (int32_t)n->v[i];
}

/* ---- finding the parts ----------------------------------------------------------- */

static tz_status read_head(reader *r, tz_svg_node at)
{
    int32_t groups = 0, edges = 0;
    tz_status s;
    if (r->head)
        return bad(r, at, "a second list of regions");
    if ((s = two_integers(r, at, "tz:pixels", TZ_IMAGE_MAX_SIDE, TZ_IMAGE_MAX_SIDE,
                          &r->e.width, &r->e.height)) != TZ_OK)
        return s;
    const int64_t pixels = (int64_t)r->e.width * r->e.height;
    if (pixels < 1)
        return bad(r, at, "the photo has no pixels");
    if (pixels > MAX_PIXELS)
        return tz_fail(r->ctx, TZ_LIMIT, "%s:%d: the photo has over %lld pixels", r->name,
                       tz_svg_line(at), (long long)MAX_PIXELS);
    const int32_t most = pixels < 5000000 ? (int32_t)pixels : 5000000;
    if ((s = one_integer(r, at, "tz:groups", 1, most, &groups)) != TZ_OK)
        return s;
    if ((s = one_integer(r, at, "tz:edges", 0, 5000000, &edges)) != TZ_OK)
        return s;
    if ((s = one_double(r, at, "tz:scale", &r->e.scale)) != TZ_OK)
        return s;
    if ((s = numbers(r, at, "tz:meta", 4)) != TZ_OK)
        return s;
    const double *v = r->n.v;
    r->e.meta = (tz_meta_group){.centre = {v[0], v[1]}, .angle = v[2], .reach = v[3]};
    for (int32_t i = 0; i < tz_ebpt_param_table.n; i++) {
        const char *name = tz_ebpt_param_table.row[i].name;
        char attr[80] = "tz:param-";
        strncat(attr, name, sizeof attr - 10);
        const char *value = tz_svg_attr(at, attr);
        if (value && tz_params_set(NULL, &tz_ebpt_param_table, &r->e.params, name, value))
            return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: %s is out of range", r->name,
                           tz_svg_line(at), attr);
    }
    if ((s = tz_alloc_zero(r->ctx, &r->region, (size_t)groups, sizeof *r->region)) !=
        TZ_OK)
        return s;
    if ((s = tz_alloc_zero(r->ctx, &r->line, (size_t)edges, sizeof *r->line)) != TZ_OK)
        return s;
    if ((s = tz_array_reserve(r->ctx, &r->e.group, groups)) != TZ_OK)
        return s;
    if ((s = tz_array_reserve(r->ctx, &r->e.edge, edges)) != TZ_OK)
        return s;
    memset(r->e.group.v, 0, (size_t)groups * sizeof *r->e.group.v);
    if (edges > 0)
        memset(r->e.edge.v, 0, (size_t)edges * sizeof *r->e.edge.v);
    r->e.group.n = groups;
    r->e.edge.n = edges;
    r->sides = 2 * ((int64_t)r->e.width + 1) * r->e.height;
    r->head = at;
    return TZ_OK;
}

static tz_status note(reader *r, tz_svg_node at, const char *attr, int32_t n,
                      tz_svg_node *table)
{
    int32_t id = 0;
    if (!r->head)
        return bad(r, at, "a region or edge stands before the list of regions");
    tz_status s = one_integer(r, at, attr, 0, n - 1, &id);
    if (s != TZ_OK)
        return s;
    if (table[id])
        return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: %s=\"%d\" stands here and in line %d",
                       r->name, tz_svg_line(at), attr, id, tz_svg_line(table[id]));
    table[id] = at;
    return TZ_OK;
}

/* Depth-first; the parser bounds the depth. */
static tz_status find_parts(reader *r, tz_svg_node parent)
{
    tz_status s = TZ_OK;
    for (tz_svg_node at = tz_svg_child(parent); at && s == TZ_OK; at = tz_svg_next(at)) {
        const bool part = tz_svg_attr(at, "tz:pixels") || tz_svg_attr(at, "tz:group");
        tz_affine m;
        if (part && tz_svg_attr(at, "transform") &&
            (tz_svg_transform(NULL, tz_svg_attr(at, "transform"), &m) != TZ_OK ||
             m.a != 1 || m.b != 0 || m.c != 0 || m.d != 1 || m.e != 0 || m.f != 0))
            return bad(r, at,
                       "regions have been moved; they must lie as they were written");
        if (tz_svg_is(at, "image") && !r->image)
            r->image = at;
        if (tz_svg_is(at, "g") && tz_svg_attr(at, "tz:pixels"))
            s = read_head(r, at);
        else if (tz_svg_is(at, "path") && tz_svg_attr(at, "tz:group"))
            s = note(r, at, "tz:group", r->e.group.n, r->region);
        else if (tz_svg_is(at, "path") && tz_svg_attr(at, "tz:edge"))
            s = note(r, at, "tz:edge", r->e.edge.n, r->line);
        if (s == TZ_OK)
            s = find_parts(r, at);
    }
    return s;
}

static tz_status check_parts(reader *r)
{
    if (!r->head)
        return tz_fail(
            r->ctx, TZ_FORMAT,
            "%s: not an exemplar document of edge groups (no tz:pixels); make one "
            "with: terrazzo analyze photo.jpg -o photo.svg",
            r->name);
    for (int32_t i = 0; i < r->e.group.n; i++)
        if (!r->region[i])
            return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: region %d of %d is missing",
                           r->name, tz_svg_line(r->head), i, r->e.group.n);
    for (int32_t i = 0; i < r->e.edge.n; i++)
        if (!r->line[i])
            return tz_fail(r->ctx, TZ_FORMAT, "%s:%d: edge %d of %d is missing", r->name,
                           tz_svg_line(r->head), i, r->e.edge.n);
    return TZ_OK;
}

/* ---- label map ------------------------------------------------------------------- */

static tz_status read_outline(reader *r, int32_t id, tz_outline_sides *out)
{
    const char *why = NULL, *d = tz_svg_attr(r->region[id], "d");
    tz_svg_path path = {0};
    if (!d)
        return bad(r, r->region[id], "the region has no outline (d)");
    tz_status s = tz_svg_path_parse(NULL, d, &path); /* its message lacks the line */
    if (s == TZ_FORMAT || s == TZ_INVALID)
        return bad(r, r->region[id], "the region's outline (d) is not path data");
    if (s != TZ_OK)
        return tz_fail(r->ctx, s, "%s: out of memory", r->name);
    s = tz_outline_read(r->ctx, &path, r->e.width, r->e.height, r->sides, out, &why);
    tz_svg_path_deinit(NULL, &path);
    return s == TZ_FORMAT ? bad(r, r->region[id], why) : s;
}

/* Outlines are read twice: a short text can claim a large photo, so that the areas are
 * added up before the label map is made. */
static tz_status read_labels(reader *r)
{
    const int64_t pixels = (int64_t)r->e.width * r->e.height;
    tz_outline_sides sides = {0};
    int64_t covered = 0;
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < r->e.group.n; i++) {
        if ((s = read_outline(r, i, &sides)) != TZ_OK)
            goto done;
        r->sides -= sides.n;
        covered += tz_outline_area(&sides);
    }
    if (covered != pixels) {
        s = tz_fail(r->ctx, TZ_FORMAT, "%s:%d: regions cover %lld of %lld pixels",
                    r->name, tz_svg_line(r->head), (long long)covered, (long long)pixels);
        goto done;
    }
    r->sides = 2 * ((int64_t)r->e.width + 1) * r->e.height;
    if ((s = tz_alloc(r->ctx, &r->e.label, (size_t)pixels, sizeof(int32_t))) != TZ_OK)
        goto done;
    memset(r->e.label, 0xff, (size_t)pixels * sizeof(int32_t));
    for (int32_t i = 0; i < r->e.group.n; i++) {
        if ((s = read_outline(r, i, &sides)) != TZ_OK)
            goto done;
        if (!tz_outline_fill(&sides, r->e.width, i, r->e.label)) {
            s = bad(r, r->region[i], "the region overlaps another");
            goto done;
        }
    }
done:
    tz_array_free(r->ctx, &sides);
    return s;
}

static void spread(const tz_ebpt *e, int64_t p, int64_t q, uint8_t *seen, int64_t *queue,
                   int64_t *n)
{
    if (seen[q] || e->label[q] != e->label[p])
        return;
    seen[q] = 1;
    queue[(*n)++] = q;
}

/* Each label is one 4-connected piece; fills area, box and cut. */
static tz_status measure_labels(reader *r)
{
    tz_ebpt *e = &r->e;
    const int64_t pixels = (int64_t)e->width * e->height, w = e->width;
    int64_t *queue = NULL;
    uint8_t *seen = NULL;
    tz_status s;
    if ((s = tz_alloc(r->ctx, &queue, (size_t)pixels, sizeof *queue)) != TZ_OK)
        goto done;
    if ((s = tz_alloc_zero(r->ctx, &seen, (size_t)pixels, 1)) != TZ_OK)
        goto done;
    for (int64_t first = 0; first < pixels; first++) {
        if (seen[first])
            continue;
        tz_edge_group *g = &e->group.v[e->label[first]];
        if (g->area > 0) {
            s = bad(r, r->region[e->label[first]], "the region is in pieces");
            goto done;
        }
        int64_t n = 0;
        int32_t x0 = e->width, y0 = e->height, x1 = 0, y1 = 0;
        queue[n++] = first;
        seen[first] = 1;
        for (int64_t i = 0; i < n; i++) {
            const int64_t p = queue[i];
            const int32_t x = (int32_t)(p % w), y = (int32_t)(p / w);
            x0 = x < x0 ? x : x0, x1 = x >= x1 ? x + 1 : x1;
            y0 = y < y0 ? y : y0, y1 = y >= y1 ? y + 1 : y1;
            if (x > 0)
                spread(e, p, p - 1, seen, queue, &n);
            if (x < e->width - 1)
                spread(e, p, p + 1, seen, queue, &n);
            if (y > 0)
                spread(e, p, p - w, seen, queue, &n);
            if (y < e->height - 1)
                spread(e, p, p + w, seen, queue, &n);
        }
        g->area = (int32_t)n;
        g->box = (tz_rect){x0, y0, x1 - x0, y1 - y0};
        g->cut = x0 == 0 || y0 == 0 || x1 == e->width || y1 == e->height;
    }
    for (int32_t i = 0; i < e->group.n; i++) {
        if (e->group.v[i].area == 0) {
            s = bad(r, r->region[i], "the region has no pixels");
            goto done;
        }
    }
done:
    tz_free(r->ctx, queue);
    tz_free(r->ctx, seen);
    return s;
}

/* ---- groups and edges ------------------------------------------------------------ */

static tz_status read_cells(reader *r, tz_svg_node at, tz_edge_group *g)
{
    tz_ebpt *e = &r->e;
    const tz_ebpt_params *p = &e->params;
    int32_t from = e->cell_edge.n, first = from;
    tz_status s = id_list(r, at, "tz:members", e->edge.n - 1, false);
    if (s != TZ_OK || (s = APPEND_IDS(r, &e->cell_edge)) != TZ_OK)
        return s;
    if ((s = numbers(r, at, "tz:cells", -1)) != TZ_OK)
        return s;
    if (r->n.n % 4 != 0)
        return bad(r, at, "tz:cells is not a list of ring, sector, share, members");
    g->cell = e->cell.n;
    g->cells = r->n.n / 4;
    for (int32_t i = 0; i < r->n.n; i += 4) {
        const double *v = r->n.v + i;
        tz_polar_cell c = {.share = v[2], .first = first};
        if (!integer(v[0], 0, p->polar_rings - 1, &c.ring) ||
            !integer(v[1], 0, p->polar_sectors - 1, &c.sector) ||
            !integer(v[3], 1, e->cell_edge.n - first, &c.count))
            return bad(r, at, "tz:cells has a number out of range");
        first += c.count;
        if ((s = tz_array_push(r->ctx, &e->cell, c)) != TZ_OK)
            return s;
    }
    if (first != e->cell_edge.n || first - from != g->edges)
        return bad(r, at, "tz:cells and tz:members do not agree with tz:edges");
    for (int32_t i = from; i < first; i++)
        if (e->edge.v[e->cell_edge.v[i]].group != (int32_t)(g - e->group.v))
            return bad(r, at, "tz:members holds an edge of another group");
    return TZ_OK;
}

static tz_status read_group(reader *r, int32_t id)
{
    tz_ebpt *e = &r->e;
    tz_edge_group *g = &e->group.v[id];
    tz_svg_node at = r->region[id];
    tz_status s;
    if ((s = one_point(r, at, "tz:centre", &g->centre)) != TZ_OK ||
        (s = one_double(r, at, "tz:angle", &g->angle)) != TZ_OK ||
        (s = one_double(r, at, "tz:size", &g->size)) != TZ_OK ||
        (s = one_double(r, at, "tz:reach", &g->reach)) != TZ_OK ||
        (s = one_point(r, at, "tz:region-centre", &g->region_centre)) != TZ_OK ||
        (s = one_integer(r, at, "tz:rank", 0, e->group.n - 1, &g->rank)) != TZ_OK ||
        (s = two_integers(r, at, "tz:bins", e->params.length_bins - 1,
                          e->params.angle_bins - 1, &g->length_bin, &g->angle_bin)) !=
            TZ_OK)
        return s;
    g->edge = e->group_edge.n;
    s = id_list(r, at, "tz:edges", e->edge.n - 1, true);
    if (s != TZ_OK || (s = APPEND_IDS(r, &e->group_edge)) != TZ_OK)
        return s;
    g->edges = e->group_edge.n - g->edge;
    for (int32_t i = g->edge; i < e->group_edge.n; i++)
        if (e->edge.v[e->group_edge.v[i]].group != id)
            return bad(r, at, "tz:edges holds an edge of another group");
    if ((s = read_cells(r, at, g)) != TZ_OK)
        return s;
    if ((s = tz_array_push(r->ctx, &e->neighbour_first, e->neighbour.n)) != TZ_OK)
        return s;
    s = id_list(r, at, "tz:neighbours", e->group.n - 1, true);
    return s == TZ_OK ? APPEND_IDS(r, &e->neighbour) : s;
}

static tz_status read_code(reader *r, tz_svg_node at, tz_edge *d)
{
    tz_ebpt *e = &r->e;
    const char *code = tz_svg_attr(at, "tz:code");
    int32_t x = d->x, y = d->y;
    if (!code)
        return bad(r, at, "the edge has no chain code (tz:code)");
    const size_t n = strlen(code);
    tz_status s = tz_array_reserve(r->ctx, &e->code, (int64_t)e->code.n + (int64_t)n);
    if (s != TZ_OK)
        return s;
    d->code = e->code.n;
    d->length = (int32_t)n;
    for (size_t i = 0; i < n; i++) {
        const int32_t k = code[i] - '0';
        if (k < 0 || k > 7)
            return bad(r, at, "tz:code has another sign than 0 to 7");
        x += tz_chain_dx[k];
        y += tz_chain_dy[k];
        if (x < 0 || y < 0 || x >= e->width || y >= e->height)
            return bad(r, at, "the edge's chain leaves the photo");
        e->code.v[e->code.n++] = (uint8_t)k;
    }
    return TZ_OK;
}

static tz_status read_edge(reader *r, int32_t id)
{
    tz_ebpt *e = &r->e;
    tz_edge *d = &e->edge.v[id];
    tz_svg_node at = r->line[id];
    tz_status s;
    if ((s = two_integers(r, at, "tz:start", e->width - 1, e->height - 1, &d->x,
                          &d->y)) != TZ_OK ||
        (s = read_code(r, at, d)) != TZ_OK ||
        (s = one_integer(r, at, "tz:group-of", 0, e->group.n - 1, &d->group)) != TZ_OK ||
        (s = two_integers(r, at, "tz:bins", e->params.length_bins - 1,
                          e->params.angle_bins - 1, &d->length_bin, &d->angle_bin)) !=
            TZ_OK ||
        (s = one_double(r, at, "tz:extent", &d->extent)) != TZ_OK ||
        (s = one_point(r, at, "tz:centre", &d->centre)) != TZ_OK ||
        (s = one_double(r, at, "tz:angle", &d->angle)) != TZ_OK ||
        (s = one_double(r, at, "tz:width", &d->width)) != TZ_OK ||
        (s = one_double(r, at, "tz:strength", &d->strength)) != TZ_OK ||
        (s = numbers(r, at, "tz:ends", 6)) != TZ_OK)
        return s;
    const double *v = r->n.v;
    d->end[0] = (tz_vec2){v[0], v[1]}, d->end_angle[0] = v[2];
    d->end[1] = (tz_vec2){v[3], v[4]}, d->end_angle[1] = v[5];
    return TZ_OK;
}

/* ---- the photo ------------------------------------------------------------------- */

static int32_t hex(char c)
{
    const char *digits = "0123456789abcdef0123456789ABCDEF",
               *p = c ? strchr(digits, c) : NULL;
    return p ? (int32_t)(p - digits) % 16 : -1;
}

/* Reference to path: %XX decoded, a relative one taken from the document's folder. */
static tz_status read_photo(reader *r, char **path, char sha256[65])
{
    const char *href = tz_svg_attr(r->image, "xlink:href");
    const char *sum = tz_svg_attr(r->image, "tz:sha256");
    if (!href || !*href)
        return bad(r, r->image ? r->image : r->head,
                   "the photo's image has no reference");
    if (strncmp(href, "file://", 7) == 0)
        href += 7;
    else if (strstr(href, "://") || strncmp(href, "data:", 5) == 0)
        return bad(r, r->image,
                   "the photo must be a file beside the document, not a remote "
                   "or embedded one");
    const char *slash = strcmp(r->name, "-") ? strrchr(r->name, '/') : NULL;
    const size_t folder = slash && *href != '/' ? (size_t)(slash - r->name) + 1 : 0;
    char *out = NULL;
    tz_status s = tz_alloc(r->ctx, &out, folder + strlen(href) + 1, 1);
    if (s != TZ_OK)
        return s;
    size_t n = folder;
    memcpy(out, r->name, folder);
    for (const char *p = href; *p; p++) {
        const bool coded = *p == '%' && hex(p[1]) >= 0 && hex(p[2]) >= 0;
        out[n] = coded ? (char)(16 * hex(p[1]) + hex(p[2])) : *p;
        if (!out[n++]) {
            tz_free(r->ctx, out);
            return bad(r, r->image, "the photo's reference holds %00");
        }
        p += coded ? 2 : 0;
    }
    out[n] = 0;
    sha256[0] = 0;
    if (sum && strlen(sum) == 64)
        memcpy(sha256, sum, 65);
    *path = out;
    return TZ_OK;
}

tz_status tz_ebpt_read(tz_ctx *ctx, const char *path, tz_ebpt *e, char **photo_path,
                       char photo_sha256[65])
{
    reader r = {.ctx = ctx, .name = path, .e = {.ctx = ctx}};
    tz_status s;

    *e = (tz_ebpt){0};
    *photo_path = NULL;
    photo_sha256[0] = 0;
    tz_params_default(&tz_ebpt_param_table, &r.e.params);
    if ((s = tz_svg_read(ctx, path, &r.doc)) != TZ_OK)
        goto done;
    if ((s = find_parts(&r, tz_svg_root(r.doc))) != TZ_OK)
        goto done;
    if ((s = check_parts(&r)) != TZ_OK)
        goto done;
    if ((s = read_labels(&r)) != TZ_OK)
        goto done;
    if ((s = measure_labels(&r)) != TZ_OK)
        goto done;
    for (int32_t i = 0; i < r.e.edge.n; i++)
        if ((s = read_edge(&r, i)) != TZ_OK)
            goto done;
    for (int32_t i = 0; i < r.e.group.n; i++)
        if ((s = read_group(&r, i)) != TZ_OK)
            goto done;
    if ((s = tz_array_push(ctx, &r.e.neighbour_first, r.e.neighbour.n)) != TZ_OK)
        goto done;
    if (r.e.group_edge.n != r.e.edge.n) {
        s = bad(&r, r.head, "an edge belongs to no group");
        goto done;
    }
    s = read_photo(&r, photo_path, photo_sha256);
done:
    tz_array_free(NULL, &r.n);
    tz_free(ctx, r.region);
    tz_free(ctx, r.line);
    tz_svg_free(r.doc);
    if (s == TZ_OK)
        *e = r.e;
    else
        tz_ebpt_deinit(&r.e);
    return s;
}
