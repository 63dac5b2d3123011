/* SPDX-License-Identifier: Apache-2.0 */
/* Units of a texture: which elements of the palette it is made of.
 *
 * Elements that the frame cuts are not copied, but something like them is, where there is
 * anything like them; pieces that are like nothing whole are left out. A frame that cuts
 * the same things at opposite sides shows one period of a texture: it is read as such. */
#include <math.h>

#include "elements/element_density.h"
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
                                         .angle = (float)e->angle,
                                         .kind = e->kind,
                                         .symbol = e->symbol,
                                         .source = k,
                                         .bent = e->samples > 1,
                                         .copied = tz_element_may_copy(e)};
}

/* Symbols are worth telling apart where each stands for several elements; where nearly all
 * elements have one of their own it is what they are known by. */
static void rate_symbols(tz_growth_exemplar *ex)
{
    int32_t used = 0;
    for (int32_t k = 0; k < ex->n; k++) {
        bool first = true;
        for (int32_t j = k > 512 ? k - 512 : 0; j < k && first; j++)
            first = ex->unit[j].symbol != ex->unit[k].symbol;
        used += first;
    }
    ex->symbols = used > 1 && 2 * used <= ex->n;
    ex->own = used >= 24 && used >= 0.8 * ex->n;
}

int32_t tz_growth_count_units(const tz_element_set *set, const tz_growth_texture *t)
{
    int32_t n = 0;
    for (int32_t k = 0; k < set->element.n; k++)
        n += is_selected(t, &set->element.v[k]);
    return n;
}

/* A cut or doubtful element is not copied; where it stood something like it may be: of its kind, and
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
    rate_symbols(ex);
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
    return tz_crowd_holds(ex->size, (tz_vec2){u->x, u->y}, (double)u->r);
}

static bool counted_of(const void *of, int32_t k, tz_counted *c)
{
    const tz_growth_exemplar *ex = of;
    const tz_growth_unit *u = &ex->unit[k];
    *c = (tz_counted){{u->x, u->y}, (double)u->r, &ex->set->element.v[u->source]};
    return true;
}

/* Density; a frame that repeats is taken as a torus. */
static void count_units(tz_growth_exemplar *ex, bool framed)
{
    const tz_crowd c = {.set = ex->set,
                        .scale = ex->texture.scale,
                        .size = ex->size,
                        .torus = ex->set->domain.torus && !framed,
                        .n = ex->elements,
                        .get = counted_of,
                        .of = ex};
    const bool repeats = !c.torus && tz_crowd_repeats(&c);
    const tz_counting how = tz_crowd_counting(&c, repeats);
    tz_counting shares = how; /* a window would count too few of each class */
    if (shares.how == TZ_COUNT_WINDOW)
        shares.how = TZ_COUNT_FRAME;
    ex->density = tz_crowd_density(&c, &how);
    for (int32_t k = 0; k < ex->n; k++) {
        tz_counted u;
        counted_of(ex, k, &u);
        ex->unit[k].weight =
            (float)(tz_crowd_weight(&c, &shares, &u) * ex->size.x * ex->size.y);
    }
    ex->torus = c.torus || repeats;
    if (!repeats)
        return;
    drop_units(ex, is_in_frame);
    for (int32_t k = 0; k < ex->n; k++)
        ex->unit[k].copied = true; /* drawn whole, beyond the frame */
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
    count_units(ex, framed);
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
