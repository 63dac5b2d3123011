/* SPDX-License-Identifier: Apache-2.0 */
/* Units of a texture: which elements of the palette it is made of.
 *
 * Elements that the frame cuts are not copied, but something like them is, where there is
 * anything like them; pieces that are like nothing whole are left out. A frame that cuts
 * the same things at opposite sides shows one period of a texture: it is read as such. */
#include <math.h>

#include "elements/growth_internal.h"

enum { FEW = 5 };

/* Whether an element of the palette belongs to the texture. */
static bool is_selected(const tz_growth_texture *t, const tz_element *e)
{
    const bool framed = t->to.x > t->from.x && t->to.y > t->from.y;
    if (framed && (e->at.x < t->from.x || e->at.y < t->from.y || e->at.x >= t->to.x ||
                   e->at.y >= t->to.y))
        return false;
    return t->kinds == 0 || e->kind >= 64 || (t->kinds >> e->kind & 1);
}

static void add_unit(tz_growth_exemplar *ex, int32_t k)
{
    const tz_element *e = &ex->set->element.v[k];
    const bool oriented = ex->set->kind.v[e->kind].oriented;
    const double scale = ex->texture.scale;
    const tz_vec3 wrapped = tz_domain_wrap(&ex->set->domain, e->at);
    const tz_vec2 at = {scale * (wrapped.x - ex->origin.x),
                        scale * (wrapped.y - ex->origin.y)};
    const tz_growth_radius *given =
        ex->texture.radius ? &ex->texture.radius[e->kind] : NULL;
    const double r = given && given->bounding > 0 ? given->bounding : e->radius;
    ex->unit[ex->n++] = (tz_growth_unit){.x = at.x,
                                         .y = at.y,
                                         .r = (float)(scale * r),
                                         .c2 = oriented ? (float)cos(2 * e->angle) : 0,
                                         .s2 = oriented ? (float)sin(2 * e->angle) : 0,
                                         .kind = e->kind,
                                         .symbol = e->symbol,
                                         .source = k,
                                         .bent = e->samples > 1,
                                         .copied = !e->cut};
}

/* Symbols are worth telling apart where each stands for several elements. */
static bool are_symbols_used(const tz_growth_exemplar *ex)
{
    int32_t used = 0;
    for (int32_t k = 0; k < ex->n; k++) {
        bool first = true;
        for (int32_t j = k > 512 ? k - 512 : 0; j < k && first; j++)
            first = ex->unit[j].symbol != ex->unit[k].symbol;
        used += first;
    }
    return used > 1 && 2 * used <= ex->n;
}

int32_t tz_growth_count_units(const tz_element_set *set, const tz_growth_texture *t)
{
    int32_t n = 0;
    for (int32_t k = 0; k < set->element.n; k++)
        n += is_selected(t, &set->element.v[k]);
    return n;
}

/* A cut element is not copied; where it stood something like it may be: of its kind, and
 * of its symbol where symbols matter, about as large, and lying like it. */
static void set_stand_ins(tz_growth_exemplar *ex)
{
    for (int32_t k = 0; k < ex->n; k++) {
        tz_growth_unit *e = &ex->unit[k];
        float least = 0.5F;
        e->stand_in = e->copied ? k : -1;
        for (int32_t j = 0; j < ex->elements && !e->copied; j++) {
            const tz_growth_unit *o = &ex->unit[j];
            if (!o->copied || o->kind != e->kind)
                continue;
            const float size = fabsf(o->r - e->r) / (o->r + e->r);
            const float axes = hypotf(o->c2 - e->c2, o->s2 - e->s2);
            const float other = ex->symbols && o->symbol != e->symbol ? 0.25F : 0;
            const float cost = 3 * size + 0.25F * axes + other;
            if (cost < least)
                least = cost, e->stand_in = j;
        }
    }
}

/* All that is selected. */
static void list_units(tz_growth_exemplar *ex, bool framed)
{
    const tz_element_set *set = ex->set;
    const tz_growth_texture *t = &ex->texture;
    ex->size = (tz_vec2){set->domain.size.x, set->domain.size.y};
    if (framed) {
        ex->origin = t->from;
        ex->size = tz_vec2_sub(t->to, t->from);
    }
    ex->size = tz_vec2_scale(ex->size, t->scale);
    for (int32_t k = 0; k < set->element.n; k++)
        if (is_selected(t, &set->element.v[k]))
            add_unit(ex, k);
    ex->elements = ex->n;
    ex->symbols = are_symbols_used(ex);
}

static void drop_units(tz_growth_exemplar *ex,
                       bool (*keep)(const tz_growth_exemplar *, const tz_growth_unit *))
{
    int32_t n = 0;
    for (int32_t k = 0; k < ex->n; k++)
        if (keep(ex, &ex->unit[k]))
            ex->unit[n++] = ex->unit[k];
    ex->n = ex->elements = n;
}

/* ---- frames that repeat ---------------------------------------------------------- */

static bool is_in_frame(const tz_growth_exemplar *ex, const tz_growth_unit *u)
{
    const double rim = 1e-3 * u->r;
    return u->x >= -rim && u->y >= -rim && u->x < ex->size.x - rim &&
           u->y < ex->size.y - rim;
}

static bool has_twin(const tz_growth_exemplar *ex, const tz_growth_unit *u, double dx,
                     double dy)
{
    for (int32_t k = 0; k < ex->n; k++) {
        const tz_growth_unit *o = &ex->unit[k];
        if (o->symbol == u->symbol && o->kind == u->kind &&
            hypot(o->x - u->x - dx, o->y - u->y - dy) < 0.02 * (double)u->r &&
            fabsf(o->r - u->r) < 0.02F * u->r &&
            hypotf(o->c2 - u->c2, o->s2 - u->s2) < 0.05F)
            return true;
    }
    return false;
}

/* A drawing of one period shows what its frame cuts at both sides. It is one if all that
 * is cut, at least two things, has a twin a width or a height away. */
static bool repeats(const tz_growth_exemplar *ex)
{
    int32_t cut = 0;
    for (int32_t k = 0; k < ex->n; k++) {
        const tz_growth_unit *u = &ex->unit[k];
        if (!ex->set->element.v[u->source].cut)
            continue;
        cut++;
        if (!has_twin(ex, u, ex->size.x, 0) && !has_twin(ex, u, -ex->size.x, 0) &&
            !has_twin(ex, u, 0, ex->size.y) && !has_twin(ex, u, 0, -ex->size.y))
            return false;
    }
    return cut >= 2;
}

/* ---- all ------------------------------------------------------------------------- */

static bool is_used(const tz_growth_exemplar *ex, const tz_growth_unit *u)
{
    (void)ex;
    return u->copied || u->stand_in >= 0;
}

static void set_box(tz_growth_exemplar *ex)
{
    ex->lo = (tz_vec2){INFINITY, INFINITY};
    ex->hi = (tz_vec2){-INFINITY, -INFINITY};
    for (int32_t k = 0; k < ex->n; k++) {
        const tz_growth_unit *u = &ex->unit[k];
        ex->lo = (tz_vec2){fmin(ex->lo.x, u->x), fmin(ex->lo.y, u->y)};
        ex->hi = (tz_vec2){fmax(ex->hi.x, u->x), fmax(ex->hi.y, u->y)};
        ex->radius = fmax(ex->radius, (double)u->r);
    }
}

static int32_t count_copied(const tz_growth_exemplar *ex)
{
    int32_t n = 0;
    for (int32_t k = 0; k < ex->n; k++)
        n += ex->unit[k].copied;
    return n;
}

void tz_growth_set_units(tz_growth_exemplar *ex)
{
    const tz_growth_texture *t = &ex->texture;
    const bool framed = t->to.x > t->from.x && t->to.y > t->from.y;
    list_units(ex, framed);
    ex->torus = ex->set->domain.torus && !framed;
    if (!ex->torus && repeats(ex)) {
        ex->torus = true;
        drop_units(ex, is_in_frame);
        for (int32_t k = 0; k < ex->n; k++)
            ex->unit[k].copied = true; /* drawn whole, beyond the frame */
    }
    tz_growth_find_density(ex);
    if (count_copied(ex) == 0) /* all are cut: better those than none */
        for (int32_t k = 0; k < ex->n; k++)
            ex->unit[k].copied = true;
    set_stand_ins(ex);
    drop_units(ex, is_used);
    set_stand_ins(ex);
    set_box(ex);
    /* too few to show how they go on, or all in a row: their frame repeats */
    ex->torus = ex->torus || ex->n < FEW || ex->hi.x - ex->lo.x < 1e-3 * ex->size.x ||
                ex->hi.y - ex->lo.y < 1e-3 * ex->size.y;
}
