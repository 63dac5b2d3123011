/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/elements.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "cli/exemplars.h"
#include "cli/figures.h"
#include "elements/element_io.h"
#include "elements/field.h"
#include "synthesis/expand.h"

#define AT(m) offsetof(tz_medium_params, m)
static const tz_param medium_rows[] = {
    {"as", TZ_PARAM_ENUM, AT(as), 0, 0, "usual", "", "usual|auto|edges|elements|curves",
     "What the picture is taken as: edge groups of a photo; elements, or curves, of a "
     "drawing or a photo; usual = elements of drawings (curves of documents of curves), "
     "edges of photos; expand --as auto decides by what is in the photo."},
    {"wrap", TZ_PARAM_BOOL, AT(wrap), 0, 1, "false", "", NULL,
     "Elements, curves: the drawing is a tile that repeats (--no-wrap: it is none); "
     "found out where neither is given."},
};
#undef AT
const tz_param_table tz_medium_param_table = {
    "medium", "What is looked for.", medium_rows,
    sizeof medium_rows / sizeof *medium_rows, sizeof(tz_medium_params)};

#define AT(m) offsetof(tz_guide_params, m)
static const tz_param guide_rows[] = {
    {"domain", TZ_PARAM_STRING, AT(domain), 0, 0, "", "FILE", NULL,
     "Elements, curves: shape to fill, an image (light = inside) or an SVG of closed "
     "paths, stretched over the layout."},
    {"field", TZ_PARAM_STRING, AT(field), 0, 0, "", "FILE|FORMULA", NULL,
     "Directions, sizes and densities that the arrangement follows: an SVG of strokes, "
     "an "
     "image of vectors, or a formula of the angle in degrees, such as "
     "\"atan2(y-h/2,x-w/2)*180/pi\"."},
    {"directions", TZ_PARAM_STRING, AT(directions), 0, 0, "", "FILE", NULL,
     "Image of directions beneath the strokes of --field: red and green are the vector "
     "(0.5 = 0, green points down), a grey value the angle."},
    {"sizes", TZ_PARAM_STRING, AT(sizes), 0, 0, "", "FILE", NULL,
     "Image of sizes beneath the strokes: mid grey is the exemplar's own."},
    {"densities", TZ_PARAM_STRING, AT(densities), 0, 0, "", "FILE", NULL,
     "Elements, edges: image of densities beneath the strokes: black is sparse."},
    {"zones", TZ_PARAM_STRING, AT(zones), 0, 0, "", "FILE", NULL,
     "Elements: picture whose flat colours say which classes may lie where, see "
     "--zone-kinds."},
    {"zone-kinds", TZ_PARAM_STRING, AT(zone_kinds), 0, 0, "", "TABLE", NULL,
     "Elements: classes of each colour of --zones: "
     "\"#ff0000=leaf,flower;#0000ff=stone\"; "
     "other colours allow all."},
    {"textures", TZ_PARAM_STRING, AT(textures), 0, 0, "", "LIST", NULL,
     "Elements: exemplars of one drawing that go into the layout, such as "
     "\"frame=0,0,480,480 scale=0.5 zone=1; kinds=leaf,stone zone=2\": a frame of the "
     "drawing, the scale of copies, the n-th colour of --zone-kinds, a selection."},
    {"brush", TZ_PARAM_STRING, AT(brush), 0, 0, "", "FILE", NULL,
     "Elements: SVG of strokes that are painted instead of filling the layout: black "
     "grows, red erases, blue relaxes, green fills the room that it begins in."},
    {"brush-radius", TZ_PARAM_DOUBLE, AT(brush_radius), 0, 1e9, "0", "", NULL,
     "Elements: radius of all strokes, user units; 0 = half of each stroke's width."},
};
#undef AT
const tz_param_table tz_guide_param_table = {
    "guides", "What guides an arrangement.", guide_rows,
    sizeof guide_rows / sizeof *guide_rows, sizeof(tz_guide_params)};

/* ---- media ------------------------------------------------------------------------- */

tz_status tz_document_kind(tz_cli *cli, const char *path, char kind[32])
{
    enum { HEAD = 16384 };
    static const char name[] = "tz:document=\"";
    char *head = NULL;
    tz_status s = tz_alloc_zero(cli->ctx, &head, HEAD + 1, 1);
    FILE *f = s == TZ_OK ? fopen(tz_cli_find(cli, path), "rb") : NULL;
    kind[0] = 0;
    if (f) { /* whoever reads it tells what is wrong with a file that does not open */
        head[fread(head, 1, HEAD, f)] = 0;
        fclose(f);
        const char *at = strstr(head, name), *end = strchr(head, '>');
        const char *root = strstr(head, "<svg");
        end = root ? strchr(root, '>') : end;
        if (at && root && end && at > root && at < end) {
            at += sizeof name - 1;
            snprintf(kind, 32, "%.*s", (int)strcspn(at, "\""), at);
        }
    }
    tz_free(cli->ctx, head);
    return s;
}

tz_status tz_medium_settle(tz_cli *cli, const char *path, const tz_medium_params *p,
                           tz_as *as)
{
    char kind[32] = "";
    const bool svg = tz_path_is_svg(path);
    tz_status s = svg ? tz_document_kind(cli, path, kind) : TZ_OK;
    if (s != TZ_OK)
        return s;
    const bool groups = strcmp(kind, "edge-groups") == 0,
               curves = strcmp(kind, "curves") == 0;
    if (strcmp(kind, "layout") == 0)
        return tz_fail(cli->ctx, TZ_INVALID,
                       "%s: is a layout already; give a photo, a drawing or an exemplar, "
                       "or make its pixels with render",
                       path);
    if ((p->as == TZ_AS_ELEMENTS || p->as == TZ_AS_CURVES) && groups)
        return tz_fail(cli->ctx, TZ_INVALID,
                       "%s: holds the edge groups of a photo; analyze the photo again "
                       "with --as %s",
                       path, p->as == TZ_AS_CURVES ? "curves" : "elements");
    if (p->as == TZ_AS_EDGES && svg && !groups)
        return tz_fail(cli->ctx, TZ_INVALID,
                       "%s: is a drawing, which has no edge groups; leave out --as edges",
                       path);
    *as = p->as >= TZ_AS_EDGES ? (tz_as)p->as
          : curves             ? TZ_AS_CURVES
          : svg && !groups     ? TZ_AS_ELEMENTS
                               : TZ_AS_EDGES;
    return TZ_OK;
}

tz_status tz_elements_read(tz_cli *cli, const char *path, const tz_medium_params *p,
                           int32_t classes, tz_record *record, tz_element_set *set)
{
    const bool known = tz_cli_given(cli, "wrap");
    const tz_element_read_options options = {
        .wrap = known && p->wrap, .wrap_auto = !known, .classes = classes};
    const double start = tz_seconds();
    tz_status s = record ? tz_record_input(cli, record, path, NULL) : TZ_OK;
    if (s == TZ_OK)
        s = tz_element_read_svg(cli->ctx, tz_cli_find(cli, path), &options, set);
    if (s != TZ_OK)
        return s;
    tz_figures_seconds(cli, "read", tz_seconds() - start);
    tz_figures_count(cli, "elements", set->element.n);
    tz_figures_count(cli, "classes", set->kind.n);
    return TZ_OK;
}

/* ---- guides ------------------------------------------------------------------------ */

/** Whether --field names a file: what has a suffix of one, or is there. */
static bool is_file(const tz_cli *cli, const char *text)
{
    struct stat st;
    return tz_path_is_svg(text) || tz_format_of(text) != TZ_FORMAT_AUTO ||
           stat(tz_cli_find(cli, text), &st) == 0;
}

tz_status tz_guides_paths(tz_cli *cli, const tz_guide_params *p, tz_path_list *inputs)
{
    const char *file[] = {p->domain, p->directions, p->sizes, p->densities,
                          p->zones,  p->brush,      p->field};
    tz_status s = TZ_OK;
    for (int i = 0; i < 7 && s == TZ_OK; i++)
        if (*file[i] && (i != 6 || is_file(cli, file[i])))
            s = tz_paths_add(cli->ctx, inputs, tz_cli_find(cli, file[i]));
    return s;
}

/* What images and strokes say, in this order. */
static tz_status read_field(tz_cli *cli, const tz_guide_params *p, tz_record *record,
                            tz_element_field *f)
{
    const struct {
        const char *path;
        tz_element_field_map map;
    } image[4] = {{p->directions, TZ_ELEMENT_FIELD_DIRECTION},
                  {p->sizes, TZ_ELEMENT_FIELD_SIZE},
                  {p->densities, TZ_ELEMENT_FIELD_DENSITY},
                  {p->field, TZ_ELEMENT_FIELD_DIRECTION}};
    tz_status s = TZ_OK;
    for (int i = 0; i < 4 && s == TZ_OK; i++) {
        const char *path = tz_cli_find(cli, image[i].path);
        if (!*image[i].path || (i == 3 && !is_file(cli, image[i].path)))
            continue;
        s = tz_record_input(cli, record, image[i].path, NULL);
        if (s == TZ_OK)
            s = i == 3 && tz_path_is_svg(path)
                    ? tz_element_field_read_strokes(f, path)
                    : tz_element_field_read_image(f, path, image[i].map);
    }
    return s == TZ_OK ? tz_element_field_settle(f) : s;
}

tz_status tz_guides_frames(tz_cli *cli, const tz_guide_params *p, tz_record *record,
                           tz_vec3 size, bool torus, tz_frames **out)
{
    const bool formula = *p->field && !is_file(cli, p->field);
    const bool sized = *p->sizes || *p->densities;
    const bool files = (*p->field && !formula) || *p->directions || sized;
    tz_element_field f = {0};
    *out = NULL;
    if (formula && *p->directions)
        return tz_fail(cli->ctx, TZ_INVALID,
                       "--field is a formula, which says all directions; leave out "
                       "--directions, or the formula");
    tz_status s = TZ_OK;
    if (formula)
        s = tz_frames_from_formula(cli->ctx, p->field, size, torus, out);
    if (s == TZ_OK && files)
        s = tz_element_field_init(cli->ctx, size, torus, 0, &f);
    if (s == TZ_OK && files) {
        s = read_field(cli, p, record, &f);
        if (s == TZ_OK)
            s = formula ? tz_frames_add_sizes(*out, &f) : tz_frames_from_field(&f, out);
        tz_element_field_deinit(&f);
    }
    if (s != TZ_OK) {
        tz_frames_free(*out);
        *out = NULL;
    }
    return s;
}

tz_status tz_guides_only_turn(tz_cli *cli, tz_guides *g)
{
    if (!g->frames || !g->frames->apart)
        return TZ_OK;
    if (!g->frames->turned)
        return tz_fail(cli->ctx, TZ_INVALID,
                       "the field says sizes or densities but no directions, and curves "
                       "follow directions alone; let strokes say some");
    tz_warn(cli->ctx, "curves follow the directions of the field alone; its sizes and "
                      "densities are left out");
    tz_frames_drop_sizes(g->frames);
    return TZ_OK;
}

static tz_status read_zones(tz_cli *cli, const tz_guide_params *p,
                            const tz_element_set *set, const tz_domain *d, tz_guides *g)
{
    const char **names = NULL;
    tz_status s = tz_alloc(cli->ctx, &names, (size_t)set->kind.n, sizeof *names);
    if (s != TZ_OK)
        return s;
    for (int32_t i = 0; i < set->kind.n; i++)
        names[i] = set->kind.v[i].name;
    s = tz_zones_read(cli->ctx, tz_cli_find(cli, p->zones), p->zone_kinds, names,
                      set->kind.n, d->size, d->torus, &g->zones);
    tz_free(cli->ctx, names);
    return s;
}

static tz_status read_brush(tz_cli *cli, const tz_guide_params *p,
                            const tz_element_set *exemplar, tz_record *record,
                            const tz_domain *d, tz_guides *g)
{
    const tz_vec3 size = exemplar->domain.size;
    const double spacing = sqrt(size.x * size.y / fmax(1, exemplar->element.n));
    tz_status s = tz_record_input(cli, record, p->brush, NULL);
    return s == TZ_OK ? tz_paint_read(cli->ctx, tz_cli_find(cli, p->brush), d->size,
                                      p->brush_radius, spacing, &g->paint)
                      : s;
}

tz_status tz_guides_read(tz_cli *cli, const tz_guide_params *p,
                         const tz_element_set *kinds, tz_record *record, tz_domain *d,
                         tz_guides *g)
{
    tz_status s = TZ_OK;
    g->ctx = cli->ctx;
    if (*p->zone_kinds && !*p->zones)
        return tz_fail(
            cli->ctx, TZ_INVALID,
            "--zone-kinds: there are no zones; name their picture with --zones");
    if (*p->domain) {
        s = tz_record_input(cli, record, p->domain, NULL);
        if (s == TZ_OK)
            s = tz_region_read(cli->ctx, tz_cli_find(cli, p->domain), d->size, d->torus,
                               &g->region);
    }
    if (s == TZ_OK)
        s = tz_guides_frames(cli, p, record, d->size, d->torus, &g->frames);
    if (s == TZ_OK && *p->zones) {
        s = tz_record_input(cli, record, p->zones, NULL);
        if (s == TZ_OK)
            s = read_zones(cli, p, kinds, d, g);
    }
    if (s == TZ_OK && *p->textures)
        s = tz_palette_parse(cli->ctx, p->textures, kinds, &g->palette);
    if (s == TZ_OK && *p->brush)
        s = read_brush(cli, p, kinds, record, d, g);
    if (s == TZ_OK) {
        d->region = g->region;
        d->frames = g->frames;
        d->zones = g->zones;
    }
    return s;
}

void tz_guides_free(tz_guides *g)
{
    tz_region_free(g->region);
    tz_frames_free(g->frames);
    tz_zones_free(g->zones);
    tz_array_free(g->ctx, &g->palette);
    tz_paint_deinit(&g->paint);
    *g = (tz_guides){0};
}

void tz_guides_apply(const tz_guides *g, tz_element_arrange_job *job)
{
    job->texture = g->palette.v;
    job->textures = g->palette.n;
    job->paint = g->paint.stroke.n > 0 ? &g->paint : NULL;
}
