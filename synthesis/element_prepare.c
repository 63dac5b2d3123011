/* SPDX-License-Identifier: Apache-2.0 */
/* Preparing a renderer: whether set and photos fit, which symbols show, drawings read and
 * cut-outs made, each once and in parallel. */
#include <string.h>

#include "base/module.h"
#include "synthesis/element_render_internal.h"

static const tz_param rows[] = {
    {"resolution", TZ_PARAM_DOUBLE, offsetof(tz_element_render_params, scale), 1e-6, 1e6,
     "1", "px", NULL, "Pixels that a user unit of the layout becomes"},
    {"shadow", TZ_PARAM_DOUBLE, offsetof(tz_element_render_params, shadow), 0, 256, "8",
     "px", NULL,
     "How far about a cut-out its shadow is kept, photo px; needs the ground without the "
     "things; 0 keeps none"},
    {"matte", TZ_PARAM_DOUBLE, offsetof(tz_element_render_params, matte), 0, 16, "2",
     "px", NULL,
     "How far to either side of an outline the border of a cut-out is sought, photo px; "
     "0 "
     "takes the outline"},
    {"harmonise", TZ_PARAM_DOUBLE, offsetof(tz_element_render_params, harmonise), 0, 1,
     "0.5", "", NULL, "How far the photo's slow change of light is evened in cut-outs"},
    {"rim", TZ_PARAM_DOUBLE, offsetof(tz_element_render_params, rim), -1, 64, "-1", "px",
     NULL,
     "How wide a rim of the ground about it a cut-out carries along, photo px, so that "
     "stones laid over each other keep a gap; 0 = none; -1 = half the usual gap between "
     "the photo's things"},
};

const tz_param_table tz_element_render_param_table = {"render", "Rendering of elements",
                                                      rows, sizeof rows / sizeof rows[0],
                                                      sizeof(tz_element_render_params)};

/* ---- checks -------------------------------------------------------------------------- */

static tz_status check_canvas(tz_ctx *ctx, tz_element_renderer *r)
{
    const tz_vec3 size = r->set->domain.size;
    const double w = fmax(rint(size.x * r->params.scale), 1),
                 h = fmax(rint(size.y * r->params.scale), 1);
    if (!(w <= TZ_IMAGE_MAX_SIDE && h <= TZ_IMAGE_MAX_SIDE))
        return tz_fail(
            ctx, TZ_INVALID,
            "render: %.6g x %.6g units at %.6g px a unit are over %d px; use a "
            "smaller scale",
            size.x, size.y, r->params.scale, TZ_IMAGE_MAX_SIDE);
    r->width = (int32_t)w;
    r->height = (int32_t)h;
    /* a torus must close: it is stretched by less than half a pixel in all */
    r->sx = r->set->domain.torus ? w / size.x : r->params.scale;
    r->sy = r->set->domain.torus ? h / size.y : r->params.scale;
    return TZ_OK;
}

/* w x h are the proportions of the photo. */
static bool same_shape(const tz_image *im, int32_t w, int32_t h)
{
    const double sx = (double)im->width / w, sy = (double)im->height / h;
    return fabs(sx - sy) * (w > h ? w : h) <= 1.5;
}

static tz_status check_photo(tz_ctx *ctx, tz_element_renderer *r,
                             const tz_element_photo *f, const tz_element_pixels *p)
{
    const char *name = f->path ? f->path : "photo";
    if (!p->photo)
        return tz_fail(ctx, TZ_INVALID,
                       "%s: the layout's elements are cut from it, but "
                       "its pixels were not given",
                       name);
    if (f->width > 0 && (p->photo->width != f->width || p->photo->height != f->height))
        return tz_fail(ctx, TZ_INVALID,
                       "%s: is %d x %d px, but elements were cut from %d x %d; use that "
                       "photo",
                       name, p->photo->width, p->photo->height, f->width, f->height);
    if (p->plate &&
        (p->plate->width != p->photo->width || p->plate->height != p->photo->height ||
         tz_photo_colours(p->plate) != tz_photo_colours(p->photo)))
        return tz_fail(ctx, TZ_INVALID,
                       "%s: its plate is %d x %d px of %d colours, the photo %d x %d of "
                       "%d; make both alike",
                       name, p->plate->width, p->plate->height,
                       tz_photo_colours(p->plate), p->photo->width, p->photo->height,
                       tz_photo_colours(p->photo));
    if (p->map && !same_shape(p->map, p->photo->width, p->photo->height))
        return tz_fail(ctx, TZ_INVALID,
                       "%s: its map is %d x %d px, the photo %d x %d; resize it to the "
                       "same proportions",
                       name, p->map->width, p->map->height, p->photo->width,
                       p->photo->height);
    const tz_image *all[2] = {p->photo, p->map ? p->map : p->photo};
    for (int k = 0; k < 2; k++)
        if (tz_photo_colours(all[k]) != 1 && tz_photo_colours(all[k]) != 3)
            return tz_fail(ctx, TZ_INVALID,
                           "%s: has %d channels; elements are rendered from grey or RGB, "
                           "with or without alpha",
                           name, all[k]->channels);
    const int32_t colours = tz_photo_colours(all[1]);
    if (r->colours && r->colours != colours)
        return tz_fail(ctx, TZ_INVALID,
                       "%s: shows %d colours where another photo or a drawing shows %d; "
                       "convert one",
                       name, colours, r->colours);
    if (r->kind == TZ_MAP_NORMAL && colours != 3)
        return tz_fail(ctx, TZ_INVALID, "%s: a map of normals needs three channels",
                       name);
    r->colours = colours;
    r->depth = all[1]->depth > r->depth ? all[1]->depth : r->depth;
    return TZ_OK;
}

/* Which symbols show, which photos are needed, and whether all fits. */
static tz_status check_set(tz_ctx *ctx, tz_element_renderer *r,
                           const tz_element_pixels *photos)
{
    const tz_element_set *set = r->set;
    bool *need = NULL;
    tz_status s = tz_element_set_check(ctx, set, "layout");
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &r->used, (size_t)set->symbol.n, sizeof *r->used);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &need, (size_t)set->photo.n, sizeof *need);
    bool drawn = set->background && r->kind == TZ_MAP_COLOUR;
    for (int32_t i = 0; s == TZ_OK && i < set->element.n; i++) {
        const tz_element *e = &set->element.v[i];
        const tz_element_symbol *y = &set->symbol.v[e->symbol];
        if (set->kind.v[e->kind].is_void)
            continue;
        if (!tz_symbol_cut(y)) {
            r->used[e->symbol] = r->kind == TZ_MAP_COLOUR;
            drawn = drawn || r->used[e->symbol];
            continue;
        }
        r->used[e->symbol] = true;
        if (y->photo < 0 || y->photo >= set->photo.n || !photos)
            s = tz_fail(ctx, TZ_INVALID,
                        "layout: element %d is cut from photo %d, whose pixels were not "
                        "given",
                        (int)i, (int)y->photo);
        else
            need[y->photo] = true;
    }
    r->colours = drawn ? 3 : 0;
    for (int32_t k = 0; s == TZ_OK && k < set->photo.n; k++)
        if (need[k] && photos)
            s = check_photo(ctx, r, &set->photo.v[k], &photos[k]);
    if (!r->colours) /* nothing shows: any will do */
        r->colours =
            photos && set->photo.n > 0 && photos[0].photo
                ? tz_photo_colours(photos[0].map ? photos[0].map : photos[0].photo)
                : 3;
    if (r->colours != 1 && r->colours != 3)
        r->colours = 3;
    tz_free(ctx, need);
    return s;
}

/* ---- preparing ----------------------------------------------------------------------- */

typedef struct prepare_job {
    tz_element_renderer *r;
    const tz_element_pixels *photos;
    tz_matte_photo *matte; /* one a photo */
    tz_photo_light *light;
} prepare_job;

static tz_status prepare_cutout(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    const prepare_job *job = arg;
    tz_element_renderer *r = job->r;
    const tz_element_symbol *y = &r->set->symbol.v[i];
    tz_cutout *c = &r->cutout[i];
    tz_matte m = {0};
    (void)worker;
    if (!r->used[i] || !tz_symbol_cut(y) || !c->levels)
        return TZ_OK;
    const tz_element_pixels *p = &job->photos[y->photo];
    if (r->params.harmonise > 0 && r->kind == TZ_MAP_COLOUR)
        c->gain = tz_photo_gain(&job->light[y->photo], p->photo, y->photo_at,
                                r->params.harmonise);
    c->tables = r->tables;
    tz_status s =
        tz_matte_init(ctx, y, (int32_t)i, &job->matte[y->photo], &r->params, c->rim, &m);
    if (s == TZ_OK)
        s = tz_cutout_fill(ctx, c, y, p, &m, r->kind);
    tz_matte_deinit(ctx, &m);
    return s;
}

/* What mattes and light of each photo need. */
static tz_status prepare_photo(tz_ctx *ctx, tz_element_renderer *r, int32_t k,
                               const tz_element_pixels *p, tz_matte_photo *m,
                               tz_photo_light *l)
{
    const tz_element_set *set = r->set;
    bool shows = false;
    for (int32_t i = 0; i < set->symbol.n; i++)
        shows = shows || (r->used[i] && tz_symbol_cut(&set->symbol.v[i]) &&
                          set->symbol.v[i].photo == k);
    if (!p->photo || !shows)
        return TZ_OK;
    *m = (tz_matte_photo){
        .photo = p->photo, .plate = p->plate, .rim = r->params.rim, .tables = r->tables};
    if (r->params.harmonise > 0 && r->kind == TZ_MAP_COLOUR)
        tz_photo_find_light(p, l);
    m->shadows = p->plate && r->params.shadow > 0 && r->kind == TZ_MAP_COLOUR;
    if (!m->shadows && m->rim == 0)
        return TZ_OK;
    tz_status s =
        tz_alloc_zero(ctx, &m->label, (size_t)p->photo->width * (size_t)p->photo->height,
                      sizeof *m->label);
    for (int32_t i = 0; i < set->symbol.n && s == TZ_OK; i++)
        if (tz_symbol_cut(&set->symbol.v[i]) && set->symbol.v[i].photo == k)
            s = tz_matte_mark(ctx, &set->symbol.v[i], i, m);
    if (s == TZ_OK && m->rim != 0)
        s = tz_rim_look(ctx, set, k, m);
    return s;
}

/* Looks at the photos, and how far each cut-out reaches: before it is known which show. */
static tz_status prepare_photos(tz_ctx *ctx, tz_element_renderer *r, prepare_job *job)
{
    const tz_element_set *set = r->set;
    tz_status s =
        tz_alloc_zero(ctx, &job->matte, (size_t)set->photo.n, sizeof *job->matte);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &job->light, (size_t)set->photo.n, sizeof *job->light);
    for (int32_t k = 0; job->photos && k < set->photo.n && s == TZ_OK; k++)
        s = prepare_photo(ctx, r, k, &job->photos[k], &job->matte[k], &job->light[k]);
    for (int32_t i = 0; i < set->symbol.n && s == TZ_OK; i++) {
        const tz_element_symbol *y = &set->symbol.v[i];
        if (r->used[i] && tz_symbol_cut(y))
            tz_cutout_place(&r->cutout[i], y, &job->photos[y->photo], &r->params,
                            tz_rim_width(y, &job->matte[y->photo]));
    }
    return s;
}

static void prepare_deinit(tz_ctx *ctx, const tz_element_renderer *r, prepare_job *job)
{
    for (int32_t k = 0; job->matte && k < r->set->photo.n; k++)
        tz_free(ctx, job->matte[k].label);
    tz_free(ctx, job->matte);
    tz_free(ctx, job->light);
}

static tz_status prepare_drawing(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    tz_element_renderer *r = arg;
    const tz_element_set *set = r->set;
    (void)worker;
    if (i == set->symbol.n) {
        const double reach = hypot(set->domain.size.x, set->domain.size.y);
        return set->background && *set->background && r->kind == TZ_MAP_COLOUR
                   ? tz_drawing_init(ctx, &r->drawing[i], "background", set->background,
                                     reach)
                   : TZ_OK;
    }
    const tz_element_symbol *y = &set->symbol.v[i];
    if (!r->used[i] || tz_symbol_cut(y))
        return TZ_OK;
    return tz_drawing_init(ctx, &r->drawing[i], y->id ? y->id : "symbol",
                           y->markup ? y->markup : "", y->radius);
}

tz_status tz_element_renderer_new(tz_ctx *ctx, const tz_element_set *set,
                                  const tz_element_pixels *photos, tz_map_kind kind,
                                  const tz_element_render_params *params,
                                  tz_element_renderer **out)
{
    tz_element_renderer *r = NULL;
    const size_t symbols = (size_t)set->symbol.n;
    tz_status s = tz_alloc_zero(ctx, &r, 1, sizeof *r);
    if (s != TZ_OK)
        return s;
    prepare_job job = {r, photos, NULL, NULL};
    r->ctx = ctx;
    r->set = set;
    r->kind = kind;
    r->encode = kind == TZ_MAP_COLOUR;
    r->depth = 8;
    tz_params_default(&tz_element_render_param_table, &r->params);
    if (params)
        r->params = *params;
    s = check_canvas(ctx, r);
    if (s == TZ_OK)
        s = check_set(ctx, r, photos);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &r->drawing, symbols + 1, sizeof *r->drawing);
    if (s == TZ_OK)
        s = tz_alloc_zero(ctx, &r->cutout, symbols, sizeof *r->cutout);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &r->tables, 1, sizeof *r->tables);
    for (int k = 0; k < TZ_TABLE + 2 && s == TZ_OK; k++) {
        const float v = (float)k / TZ_TABLE;
        r->tables->decode[k] = tz_srgb_decode(v);
        r->tables->encode[k] = tz_srgb_encode(v * v);
    }
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, set->symbol.n + 1, prepare_drawing, r);
    if (s == TZ_OK)
        s = tz_bent_init(ctx, r);
    if (s == TZ_OK)
        s = prepare_photos(ctx, r, &job);
    if (s == TZ_OK)
        s = tz_showing_index_init(ctx, r);
    if (s == TZ_OK)
        s = tz_parallel_for(ctx, set->symbol.n, prepare_cutout, &job);
    prepare_deinit(ctx, r, &job);
    if (s == TZ_OK)
        *out = r;
    else
        tz_element_renderer_free(r);
    return s;
}

void tz_element_renderer_free(tz_element_renderer *r)
{
    if (!r)
        return;
    tz_ctx *ctx = r->ctx;
    const int32_t n = r->set->symbol.n;
    for (int32_t i = 0; i < n && r->cutout; i++)
        tz_cutout_deinit(ctx, &r->cutout[i]);
    for (int32_t i = 0; i <= n && r->drawing; i++)
        tz_drawing_deinit(ctx, &r->drawing[i]);
    tz_bent_deinit(ctx, r);
    tz_showing_index_deinit(ctx, &r->index);
    tz_free(ctx, r->cutout);
    tz_free(ctx, r->tables);
    tz_free(ctx, r->drawing);
    tz_free(ctx, r->used);
    tz_free(ctx, r);
}
