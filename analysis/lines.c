/* SPDX-License-Identifier: Apache-2.0 */
#include "analysis/lines.h"

#include <math.h>

#include "analysis/lines_axis.h"
#include "analysis/lines_fit.h"
#include "analysis/lines_graph.h"
#include "analysis/lines_judge.h"
#include "analysis/lines_plate.h"

#define AT(m) offsetof(tz_lines_params, m)
static const tz_param rows[] = {
    {"line", TZ_PARAM_ENUM, AT(line), 0, 0, "auto", "", "auto|edge|ridge|both",
     "Which lines of a photo: borders between what differs, ridges (cracks, veins, "
     "joints: darker or lighter than both sides), or ridges and, elsewhere, borders."},
    {"tone", TZ_PARAM_ENUM, AT(tone), 0, 0, "auto", "", "auto|dark|light|both",
     "Ridges: darker or lighter than their sides."},
    {"line-strength", TZ_PARAM_DOUBLE, AT(strength), 0, 1, "0.5", "", NULL,
     "How much a line must stand out; 0.5 = as the photo tells, less finds more."},
    {"line-width", TZ_PARAM_RANGE, AT(width), 0, 1e4, "0,0", "px", NULL,
     "Widths of the lines looked for; 0,0 = as the photo tells."},
    {"line-length", TZ_PARAM_DOUBLE, AT(length), 0, 1e6, "0", "px", NULL,
     "Shortest line and branch that is kept; 0 = as the widths tell."},
    {"line-gap", TZ_PARAM_DOUBLE, AT(gap), -1, 1e5, "0", "px", NULL,
     "Widest gap in a line that is bridged; 0 = as the widths tell, -1 = none."},
    {"line-error", TZ_PARAM_DOUBLE, AT(error), 0.01, 100, "0.5", "px", NULL,
     "How far curves may lie off the line that was found."},
    {"line-most", TZ_PARAM_INT, AT(most), 10000, 2e9, "4000000", "px", NULL,
     "The photo is halved until it has no more pixels than this."},
};
#undef AT
const tz_param_table tz_lines_param_table = {"lines", "Finds the lines of a photo.", rows,
                                             (int32_t)(sizeof rows / sizeof *rows),
                                             sizeof(tz_lines_params)};

#define AREA   0.5  /* of the strength of lines: what they run through */
#define PROOF  12   /* px of a line as strong again as it must be */
#define LENGTH 8    /* shortest line, px */
#define HOLE   100  /* px that no line runs around */
#define EDGE   10   /* edges weaker than that are nothing, of 100 */
#define BROKEN 0.45 /* share of ends that meet others: less is no network */
#define BETTER 0.25 /* so much more of them with borders: these it is */
#define SURE   1.1  /* one tone has this much more proof than the other: it is alone */

/* One kind of lines. */
typedef struct track {
    tz_line_field field;
    tz_line_graph g;
    tz_line_tidy tidy;
    double proof;
} track;

enum { DARK, LIGHT, EDGES, TRACKS };

typedef struct search {
    tz_ctx *ctx;
    const tz_image *photo;
    const tz_lines_params *p;
    tz_line_picture picture;
    double side; /* px of the photo a px of the picture */
    float *grey;
    track track[TRACKS];
    tz_line_graph g; /* all */
} search;

static tz_status look(search *f)
{
    int32_t shift = 0;
    while ((((int64_t)f->photo->width >> shift) * (f->photo->height >> shift)) >
           f->p->most)
        shift++;
    f->side = 1 << shift;
    tz_status s = tz_line_picture_init(f->ctx, f->photo, shift, &f->picture);
    const size_t n = (size_t)f->picture.width * (size_t)f->picture.height;
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &f->grey, n, sizeof *f->grey);
    for (size_t i = 0; i < n && s == TZ_OK; i++)
        f->grey[i] = f->picture.channels == 1
                         ? f->picture.v[i]
                         : 0.30F * f->picture.v[i] + 0.59F * f->picture.v[n + i] +
                               0.11F * f->picture.v[2 * n + i];
    return s;
}

/* ---- one kind of lines --------------------------------------------------------------- */

/* The lines of a field, as they run: nothing is joined yet. */
static tz_status follow(search *f, track *t)
{
    const double side = f->side, length = f->p->length > 0 ? f->p->length / side : LENGTH;
    tz_status s = t->field.edge ? TZ_OK : tz_line_along(f->ctx, &t->field);
    if (s == TZ_OK)
        s = tz_edge_map_detect(&t->field.map, 0, t->field.edge ? EDGE : 1);
    if (s != TZ_OK)
        return s;
    t->tidy.low = tz_line_part(&t->field) * exp2(4 * (f->p->strength - 0.5));
    t->tidy.length = length;
    t->tidy.proof = PROOF * t->tidy.low;
    s = tz_line_crest(&t->field, AREA * t->tidy.low, HOLE);
    if (s == TZ_OK)
        s = tz_edge_map_thin(&t->field.map);
    if (s == TZ_OK)
        s = tz_line_graph_trace(&t->field, &t->g);
    if (s == TZ_OK)
        s = tz_line_graph_rejoin(&t->g);
    if (s == TZ_OK)
        s = tz_line_graph_select(&t->g, &t->tidy);
    t->proof = 0;
    for (int32_t i = 0; i < t->g.chain.n && s == TZ_OK; i++)
        t->proof += tz_line_chain_proof(&t->g, &t->g.chain.v[i], t->tidy.low);
    return s;
}

static double mean_width(const tz_line_graph *g)
{
    double sum = 0, length = 0;
    for (int32_t i = 0; i < g->chain.n; i++) {
        sum += g->chain.v[i].length * g->chain.v[i].width;
        length += g->chain.v[i].length;
    }
    return length > 0 ? sum / length : 0;
}

static tz_status complete(search *f, track *t)
{
    const double gap = f->p->gap / f->side;
    t->tidy.gap = gap > 0 ? gap : gap < 0 ? 0 : fmin(fmax(3 * mean_width(&t->g), 10), 40);
    tz_status s = tz_line_graph_bridge(&t->g, &t->field, &t->tidy);
    if (s == TZ_OK)
        s = tz_line_graph_smooth(&t->g, 1);
    if (s == TZ_OK)
        s = tz_line_graph_measure(&t->g, f->grey);
    if (s == TZ_OK)
        s = tz_line_graph_mend(&t->g);
    if (s == TZ_OK)
        s = tz_line_graph_smooth(&t->g, 1.5);
    return s == TZ_OK ? tz_line_graph_append(&f->g, &t->g) : s;
}

/* ---- which kinds --------------------------------------------------------------------- */

static tz_status answer(search *f, int tones)
{
    const int32_t w = f->picture.width, h = f->picture.height;
    double width[2] = {f->p->width[0] / f->side, f->p->width[1] / f->side};
    tz_line_field field[2];
    if (!(width[1] > 0)) {
        width[0] = 2;
        width[1] = fmin(16, fmax(4, fmin(w, h) / 16.0));
    }
    for (int k = 0; k < 2; k++) {
        tz_line_field_deinit(f->ctx, &f->track[k].field);
        tz_line_graph_deinit(&f->track[k].g);
        f->track[k].g.ctx = f->ctx;
    }
    const tz_status s = tz_line_ridges(f->ctx, f->grey, w, h, width, tones, field);
    for (int k = 0; k < 2 && s == TZ_OK; k++)
        f->track[k].field = field[k];
    return s;
}

/* Which tone has the lines; of both only where they are as sure, and neither is a
 * network. */
static tz_status ridges(search *f, tz_lines_verdict *v)
{
    bool changed = false;
    tz_status s = answer(f, f->p->tone ? f->p->tone : 3);
    for (int k = 0; k < 2 && s == TZ_OK; k++)
        if (f->p->tone == 0 || f->p->tone == 3 || f->p->tone == k + 1)
            s = follow(f, &f->track[k]);
    const double dark = f->track[DARK].proof, light = f->track[LIGHT].proof;
    v->tone = f->p->tone            ? f->p->tone
              : dark > SURE * light ? 1
              : light > SURE * dark ? 2
                                    : 3;
    if (s == TZ_OK && v->tone < 3)
        s = tz_line_axis(&f->track[v->tone - 1].g, &f->picture, f->grey, &changed);
    if (s == TZ_OK && changed) {
        s = answer(f, v->tone);
        if (s == TZ_OK)
            s = follow(f, &f->track[v->tone - 1]);
    }
    for (int k = 0; k < 2 && s == TZ_OK; k++)
        if (v->tone & (k + 1))
            s = complete(f, &f->track[k]);
    return s;
}

/* Borders. @param besides  not where there is a ridge already */
static tz_status edges(search *f, bool besides)
{
    track *t = &f->track[EDGES];
    const int32_t w = f->picture.width, h = f->picture.height;
    const ptrdiff_t n = (ptrdiff_t)w * h;
    tz_image small = {0};
    uint8_t *taken = NULL;
    tz_status s = tz_image_init(f->ctx, &small, w, h, f->picture.channels);
    if (s == TZ_OK)
        s = tz_alloc_zero(f->ctx, &taken, (size_t)n, 1);
    for (ptrdiff_t p = 0; p < n && s == TZ_OK; p++)
        for (int32_t c = 0; c < f->picture.channels; c++)
            small.px[p * f->picture.channels + c] = 0.01F * f->picture.v[c * n + p];
    small.encoding = TZ_ENCODING_SRGB;
    if (s == TZ_OK)
        s = tz_line_edges(f->ctx, &small, "", &t->field);
    if (s == TZ_OK && besides)
        tz_line_graph_cover(&f->g, 1, 3, w, h, taken);
    for (ptrdiff_t p = 0; p < n && s == TZ_OK; p++)
        if (taken[p])
            t->field.map.response[p] = 0;
    if (s == TZ_OK)
        s = follow(f, t);
    if (s == TZ_OK)
        s = complete(f, t);
    tz_image_deinit(&small);
    tz_free(f->ctx, taken);
    return s;
}

/* Ridges; where they are broken, and borders are less so, these. */
static tz_status whichever(search *f, tz_lines_verdict *v)
{
    tz_line_graph kept;
    double by_ridges, by_edges;
    v->line = TZ_LINE_RIDGE;
    tz_status s = ridges(f, v);
    if (s == TZ_OK)
        s = tz_line_joined(&f->g, &by_ridges);
    if (s != TZ_OK || by_ridges > BROKEN)
        return s;
    kept = f->g;
    f->g = (tz_line_graph){.ctx = f->ctx};
    s = edges(f, false);
    if (s == TZ_OK)
        s = tz_line_joined(&f->g, &by_edges);
    if (s == TZ_OK && by_edges > by_ridges + BETTER) {
        v->line = TZ_LINE_EDGE;
        v->tone = 0;
        tz_line_graph_deinit(&kept);
    } else {
        tz_line_graph_deinit(&f->g);
        f->g = kept;
    }
    return s;
}

static tz_status find(search *f, tz_lines_verdict *v)
{
    if (v->line == TZ_LINE_AUTO)
        return whichever(f, v);
    tz_status s = v->line == TZ_LINE_EDGE ? TZ_OK : ridges(f, v);
    if (s == TZ_OK && v->line != TZ_LINE_RIDGE)
        s = edges(f, v->line == TZ_LINE_BOTH);
    return s;
}

static tz_status open_set(search *f, tz_curve_set *out)
{
    const tz_vec3 size = {f->photo->width, f->photo->height, 0};
    tz_element_photo p = {.width = f->photo->width, .height = f->photo->height};
    out->ctx = out->element.ctx = f->ctx;
    out->domain.size = out->element.domain.size = size;
    tz_status s = tz_strdup(f->ctx, "", &p.path);
    if (s == TZ_OK && (s = tz_array_push(f->ctx, &out->element.photo, p)) != TZ_OK)
        tz_free(f->ctx, p.path);
    return s;
}

static tz_status check(tz_ctx *ctx, const tz_image *photo)
{
    if (photo->encoding != TZ_ENCODING_DATA && photo->channels >= 1 &&
        photo->channels <= 4 && photo->width >= 1 && photo->height >= 1)
        return TZ_OK;
    return tz_fail(ctx, TZ_INVALID,
                   "lines are found in photos of 1 to 4 channels that show colours; this "
                   "is %d x %d of %d channels",
                   photo->width, photo->height, photo->channels);
}

tz_status tz_lines_find(tz_ctx *ctx, const tz_image *photo, const tz_lines_params *params,
                        tz_curve_set *out, tz_image *plate, tz_lines_verdict *verdict)
{
    search f = {.ctx = ctx, .photo = photo, .p = params, .g = {.ctx = ctx}};
    tz_lines_verdict v = {.line = params->line};
    *out = (tz_curve_set){0};
    if (plate)
        *plate = (tz_image){0};
    if (verdict)
        *verdict = (tz_lines_verdict){0};
    for (int k = 0; k < TRACKS; k++)
        f.track[k].g.ctx = ctx;
    tz_status s = check(ctx, photo);
    if (s == TZ_OK)
        s = look(&f);
    if (s == TZ_OK)
        s = find(&f, &v);
    if (s == TZ_OK)
        s = open_set(&f, out);
    if (s == TZ_OK)
        s = tz_line_fit(&f.g, &f.picture, f.side, params->error, out);
    if (s == TZ_OK)
        s = tz_line_judge(&f.g, &f.picture, f.grey, f.side, out->path.n, &v);
    if (s == TZ_OK && plate)
        s = tz_line_plate(ctx, photo, &f.g, f.side, plate);
    if (s == TZ_OK && verdict)
        *verdict = v;
    tz_line_picture_deinit(&f.picture);
    tz_free(ctx, f.grey);
    for (int k = 0; k < TRACKS; k++) {
        tz_line_field_deinit(ctx, &f.track[k].field);
        tz_line_graph_deinit(&f.track[k].g);
    }
    tz_line_graph_deinit(&f.g);
    if (s != TZ_OK)
        tz_curve_set_deinit(out);
    return s;
}
