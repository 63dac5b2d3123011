/* SPDX-License-Identifier: Apache-2.0 */
/* The drawing is exemplar and surroundings at once: as exemplar it is valid in one region
 * only, as surroundings it is complete in another (predict_region.c); what is between is
 * arranged as any layout is. */
#include "curves/predict.h"

#include <string.h>

#include "curves/curve_edit.h"
#include "curves/curve_join.h"
#include "curves/predict_internal.h"

void tz_curve_prediction_deinit(tz_curve_prediction *p)
{
    tz_ctx *ctx = p->set.ctx;
    tz_array_free(ctx, &p->path);
    tz_array_free(ctx, &p->element);
    tz_curve_set_deinit(&p->set);
    *p = (tz_curve_prediction){0};
}

/* ---- foretelling ----------------------------------------------------------------------
 */

static tz_status check_span(tz_ctx *ctx, const tz_curve_set *s, const tz_region *r)
{
    const tz_vec3 a = s->domain.size, b = r->raster.size;
    if (fabs(a.x - b.x) > 1e-6 * a.x || fabs(a.y - b.y) > 1e-6 * a.y)
        return tz_fail(ctx, TZ_INVALID,
                       "a region of %g x %g does not span the drawing of %g x %g", b.x,
                       b.y, a.x, a.y);
    return TZ_OK;
}

/** All choices open. */
static tz_status open_all(tz_ctx *ctx, tz_curve_prediction *p)
{
    tz_status s = TZ_OK;
    for (int32_t i = 0; i < p->set.path.n && s == TZ_OK; i++)
        s = tz_array_push(ctx, &p->path, (uint8_t)TZ_CURVE_OPEN);
    for (int32_t i = 0; i < p->set.element.element.n && s == TZ_OK; i++)
        s = tz_array_push(ctx, &p->element, (uint8_t)TZ_CURVE_OPEN);
    return s;
}

enum { TRIES = 5 };

/** Where and how one prediction is tried. */
typedef struct attempt {
    const tz_curve_predict_job *job;
    tz_curve_arrange_params params;
    tz_region *source, *complete;
    double spacing;
} attempt;

static tz_status prepare(tz_ctx *ctx, const tz_curve_predict_job *job, attempt *a)
{
    *a = (attempt){.job = job};
    tz_status s = tz_curve_set_check(ctx, job->drawing, "drawing");
    if (s == TZ_OK)
        s = check_span(ctx, job->drawing, job->to);
    if (s == TZ_OK && job->from)
        s = check_span(ctx, job->drawing, job->from);
    if (s == TZ_OK)
        s = tz_predict_regions(ctx, job, &a->source, &a->complete, &a->spacing);
    if (job->params)
        a->params = *job->params;
    else
        tz_params_default(&tz_curve_arrange_param_table, &a->params);
    if (a->params.method == TZ_CURVES_AUTO)
        a->params.method = TZ_CURVES_QUILT;
    a->params.finish = false; /* ends are joined here: the drawing's are loose, too */
    return s;
}

static tz_status fill_once(tz_ctx *ctx, const attempt *a, uint64_t seed,
                           tz_curve_set *out, double *loss)
{
    const tz_curve_set *drawing = a->job->drawing;
    const tz_domain plain = {.size = drawing->domain.size,
                             .torus = drawing->domain.torus};
    tz_curve_set exemplar = *drawing; /* seen otherwise, not owned */
    exemplar.domain.region = a->source;
    exemplar.origin.n = 0;
    const tz_curve_arrange_job arrange = {.exemplar = &exemplar,
                                          .name = "drawing",
                                          .domain = &plain,
                                          .given = drawing,
                                          .given_region = a->complete,
                                          .params = &a->params,
                                          .seed = seed,
                                          .unmeasured = true};
    tz_status s = tz_curve_arrange(ctx, &arrange, out, NULL);
    if (s == TZ_OK)
        s = tz_predict_join(ctx, drawing, a->job->to, a->spacing, out, loss);
    if (s != TZ_OK) {
        tz_curve_set_deinit(out);
        *out = (tz_curve_set){0};
    }
    return s;
}

/** What fills the region: of some tries the one that meets what is drawn best. */
static tz_status fill(tz_ctx *ctx, const tz_curve_predict_job *job, uint64_t seed,
                      tz_curve_set *out)
{
    attempt a;
    double best = INFINITY;
    tz_status s = prepare(ctx, job, &a);
    *out = (tz_curve_set){0};
    for (int i = 0; i < TRIES && s == TZ_OK; i++) {
        tz_curve_set next;
        double loss = 0;
        s = fill_once(ctx, &a, seed + 0xd1342543de82ef95u * (uint64_t)i, &next, &loss);
        if (s == TZ_OK && loss < best) {
            tz_curve_set_deinit(out);
            *out = next;
            best = loss;
        } else if (s == TZ_OK) {
            tz_curve_set_deinit(&next);
        }
        if (a.params.method != TZ_CURVES_QUILT)
            break;
    }
    tz_region_free(a.source);
    tz_region_free(a.complete);
    if (s != TZ_OK) {
        tz_curve_set_deinit(out);
        *out = (tz_curve_set){0};
    }
    return s;
}

tz_status tz_curve_predict(tz_ctx *ctx, const tz_curve_predict_job *job,
                           tz_curve_prediction *p)
{
    *p = (tz_curve_prediction){0};
    tz_status s = fill(ctx, job, job->seed, &p->set);
    if (s == TZ_OK)
        s = open_all(ctx, p);
    if (s != TZ_OK)
        tz_curve_prediction_deinit(p);
    return s;
}

/* ---- marking --------------------------------------------------------------------------
 */

/** Share of a path's length inside a region. */
static double share_inside(const tz_curve_set *s, const tz_curve_path *p,
                           const tz_region *r)
{
    enum { PLACES = 16 };
    double all = 0, inside = 0;
    for (int32_t i = p->piece; i < p->piece + p->pieces; i++) {
        const tz_bezier c = tz_curve_bezier(s, &s->piece.v[i]);
        const double length = tz_bezier_length(&c);
        for (int k = 0; k < PLACES; k++) {
            const tz_vec2 v = tz_bezier_at(&c, (k + 0.5) / PLACES);
            const tz_vec3 at = tz_domain_wrap(&s->domain, (tz_vec3){v.x, v.y, 0});
            inside += tz_region_distance(r, at) > 0 ? length : 0;
        }
        all += length * PLACES;
    }
    return all > 0 ? inside / all : 0;
}

int32_t tz_curve_predict_mark(tz_curve_prediction *p, const tz_region *region,
                              tz_curve_choice choice)
{
    int32_t changed = 0;
    for (int32_t i = 0; i < p->path.n; i++) {
        const bool meant = region
                               ? share_inside(&p->set, &p->set.path.v[i], region) >= 0.5
                               : p->path.v[i] == TZ_CURVE_OPEN;
        changed += meant && p->path.v[i] != (uint8_t)choice;
        if (meant)
            p->path.v[i] = (uint8_t)choice;
    }
    for (int32_t i = 0; i < p->element.n; i++) {
        const bool meant =
            region ? tz_region_distance(region, p->set.element.element.v[i].at) > 0
                   : p->element.v[i] == TZ_CURVE_OPEN;
        changed += meant && p->element.v[i] != (uint8_t)choice;
        if (meant)
            p->element.v[i] = (uint8_t)choice;
    }
    return changed;
}

int32_t tz_curve_predict_mark_at(tz_curve_prediction *p, tz_vec2 at, double reach,
                                 tz_curve_choice choice)
{
    const tz_curve_set *s = &p->set;
    double best = reach;
    int32_t found = -1;
    for (int32_t i = 0; i < s->path.n; i++)
        for (int32_t k = 0; k < s->path.v[i].pieces; k++) {
            const tz_bezier c = tz_curve_bezier(s, &s->piece.v[s->path.v[i].piece + k]);
            double t;
            const double d = tz_bezier_nearest(
                &c, tz_curve_copy(&s->domain, at, tz_bezier_at(&c, 0.5)), &t);
            if (d < best || (d == best && found < 0)) {
                best = d;
                found = i;
            }
        }
    if (found >= 0)
        p->path.v[found] = (uint8_t)choice;
    return found;
}

/* ---- taking ---------------------------------------------------------------------------
 */

/** The paths and elements of one choice. */
static tz_status pick(tz_ctx *ctx, const tz_curve_prediction *p, tz_curve_choice choice,
                      tz_curve_set *out)
{
    uint8_t *path = NULL, *element = NULL;
    tz_status s = tz_alloc(ctx, &path, (size_t)p->path.n, 1);
    if (s == TZ_OK)
        s = tz_alloc(ctx, &element, (size_t)p->element.n, 1);
    for (int32_t i = 0; i < p->path.n && s == TZ_OK; i++)
        path[i] = p->path.v[i] == (uint8_t)choice;
    for (int32_t i = 0; i < p->element.n && s == TZ_OK; i++)
        element[i] = p->element.v[i] == (uint8_t)choice;
    if (s == TZ_OK)
        s = tz_curve_choose(ctx, &p->set, path, element, NULL, (tz_vec2){0, 0}, out);
    tz_free(ctx, path);
    tz_free(ctx, element);
    return s;
}

/** Origins tell where pixels come from. A drawing without a photo has none; in one with a
 * photo, what is drawn is its own. */
static tz_status settle_origins(tz_ctx *ctx, tz_curve_set *drawing, tz_curve_set *taken)
{
    tz_status s = TZ_OK;
    if (drawing->element.photo.n == 0 && drawing->origin.n == 0)
        tz_array_free(taken->ctx, &taken->origin);
    else if (drawing->origin.n == 0 && taken->origin.n > 0)
        for (int32_t i = 0; i < drawing->piece.n && s == TZ_OK; i++)
            s = tz_array_push(ctx, &drawing->origin,
                              tz_curve_bezier(drawing, &drawing->piece.v[i]));
    return s;
}

/** `drawing` with the taken paths in it, as a new set. */
static tz_status draw_taken(tz_ctx *ctx, const tz_curve_prediction *p,
                            const tz_curve_set *drawing, tz_curve_set *out)
{
    tz_curve_set taken = {0};
    tz_status s = tz_curve_choose(ctx, drawing, NULL, NULL, NULL, (tz_vec2){0, 0}, out);
    const int32_t first = out->path.n;
    if (s == TZ_OK)
        s = pick(ctx, p, TZ_CURVE_TAKEN, &taken);
    if (s == TZ_OK)
        s = settle_origins(ctx, out, &taken);
    if (s == TZ_OK)
        s = tz_curve_append(ctx, out, &taken);
    if (s == TZ_OK)
        s = tz_curve_weld(ctx, out, first, tz_curve_reach(drawing), NULL);
    tz_curve_set_deinit(&taken);
    if (s != TZ_OK) {
        tz_curve_set_deinit(out);
        *out = (tz_curve_set){0};
    }
    return s;
}

/** A prediction of the set, everything with one choice; takes the set over. */
static tz_status wrap(tz_ctx *ctx, tz_curve_set *set, int32_t round,
                      tz_curve_prediction *p)
{
    *p = (tz_curve_prediction){.set = *set, .round = round};
    *set = (tz_curve_set){0};
    const tz_status s = open_all(ctx, p);
    if (s != TZ_OK)
        tz_curve_prediction_deinit(p);
    return s;
}

tz_status tz_curve_predict_accept(tz_ctx *ctx, tz_curve_prediction *p,
                                  tz_curve_set *drawing)
{
    tz_curve_set next = {0}, open = {0};
    tz_curve_prediction rest = {0};
    tz_status s = draw_taken(ctx, p, drawing, &next);
    if (s == TZ_OK)
        s = pick(ctx, p, TZ_CURVE_OPEN, &open);
    if (s == TZ_OK)
        s = wrap(ctx, &open, p->round, &rest);
    if (s == TZ_OK) {
        next.recipe = drawing->recipe;
        drawing->recipe = NULL;
        tz_curve_set_deinit(drawing);
        *drawing = next;
        next = (tz_curve_set){0};
        tz_curve_prediction_deinit(p);
        *p = rest;
    }
    tz_curve_set_deinit(&open);
    tz_curve_set_deinit(&next);
    return s;
}

tz_status tz_curve_predict_again(tz_ctx *ctx, const tz_curve_predict_job *job,
                                 tz_curve_prediction *p)
{
    const int32_t round = p->round + 1;
    tz_curve_predict_job anew = *job;
    tz_curve_set drawing = {0}, taken = {0}, open = {0};
    tz_curve_prediction next = {0};
    tz_status s = draw_taken(ctx, p, job->drawing, &drawing);
    anew.drawing = &drawing;
    if (s == TZ_OK)
        s = fill(ctx, &anew, job->seed + 0x9e3779b97f4a7c15u * (uint64_t)round, &open);
    if (s == TZ_OK)
        s = pick(ctx, p, TZ_CURVE_TAKEN, &taken);
    const int32_t paths = taken.path.n, elements = taken.element.element.n;
    if (s == TZ_OK)
        s = tz_curve_append(ctx, &taken, &open);
    if (s == TZ_OK)
        s = wrap(ctx, &taken, round, &next);
    if (s == TZ_OK) {
        memset(next.path.v, TZ_CURVE_TAKEN, (size_t)paths);
        memset(next.element.v, TZ_CURVE_TAKEN, (size_t)elements);
        tz_curve_prediction_deinit(p);
        *p = next;
    }
    tz_curve_set_deinit(&drawing);
    tz_curve_set_deinit(&taken);
    tz_curve_set_deinit(&open);
    return s;
}
