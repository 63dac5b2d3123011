/* SPDX-License-Identifier: Apache-2.0 */
#include "elements/element_density.h"

#include <math.h>

enum { FEW = 8 }; /* elements tell nothing of their border */

/* ---- things and frames -------------------------------------------------------------- */

/* Half the extent, axes of the world. */
static tz_vec2 half_extent(const tz_crowd *c, const tz_counted *u)
{
    const tz_element *e = u->element;
    const bool known = e->symbol >= 0 && e->symbol < c->set->symbol.n;
    const tz_element_symbol *y = known ? &c->set->symbol.v[e->symbol] : NULL;
    const double cosine = cos(e->angle), sine = sin(e->angle),
                 scale = e->scale * c->scale;
    tz_vec2 h = {0, 0};
    if (!y || y->outline.n == 0)
        return (tz_vec2){u->radius, u->radius};
    for (int32_t k = 0; k < y->outline.n; k++) {
        const tz_vec2 p = y->outline.v[k];
        h.x = fmax(h.x, scale * fabs(cosine * p.x - sine * p.y));
        h.y = fmax(h.y, scale * fabs(sine * p.x + cosine * p.y));
    }
    return h;
}

static bool in_frame(tz_vec2 size, tz_vec2 at)
{
    return at.x >= 0 && at.y >= 0 && at.x < size.x && at.y < size.y;
}

bool tz_crowd_holds(tz_vec2 size, tz_vec2 at, double radius)
{
    const double rim = 1e-3 * radius;
    return at.x >= -rim && at.y >= -rim && at.x < size.x - rim && at.y < size.y - rim;
}

/* ---- frames that repeat --------------------------------------------------------------- */

static bool has_twin(const tz_crowd *c, const tz_counted *u, double dx, double dy)
{
    const tz_element *e = u->element;
    const bool oriented = c->set->kind.v[e->kind].oriented;
    for (int32_t k = 0; k < c->n; k++) {
        tz_counted v;
        if (!c->get(c->of, k, &v))
            continue;
        const tz_element *o = v.element;
        if (o->symbol == e->symbol && o->kind == e->kind &&
            hypot(v.at.x - u->at.x - dx, v.at.y - u->at.y - dy) < 0.02 * u->radius &&
            fabs(v.radius - u->radius) < 0.02 * u->radius &&
            (!oriented || 2 * fabs(sin(o->angle - e->angle)) < 0.05))
            return true;
    }
    return false;
}

bool tz_crowd_repeats(const tz_crowd *c)
{
    tz_counted u;
    int32_t cut = 0;
    for (int32_t k = 0; k < c->n; k++) {
        if (!c->get(c->of, k, &u) || !u.element->cut)
            continue;
        cut++;
        if (!has_twin(c, &u, c->size.x, 0) && !has_twin(c, &u, -c->size.x, 0) &&
            !has_twin(c, &u, 0, c->size.y) && !has_twin(c, &u, 0, -c->size.y))
            return false;
    }
    return cut >= 2;
}

/* ---- counting ------------------------------------------------------------------------ */

/* Whether some cut elements are mere pieces: they end where the frame does. */
static bool has_pieces(const tz_crowd *c)
{
    tz_counted u;
    for (int32_t k = 0; k < c->n; k++) {
        if (!c->get(c->of, k, &u) || !u.element->cut)
            continue;
        const tz_vec2 h = half_extent(c, &u);
        const double over = 0.02 * u.radius;
        if (u.at.x - h.x > -over && u.at.y - h.y > -over &&
            u.at.x + h.x < c->size.x + over && u.at.y + h.y < c->size.y + over)
            return true;
    }
    return false;
}

/* Weight of a coordinate: 0 up to `from` from either end, 1 from `from + ramp` on. */
static double taper(double x, double size, double from, double ramp)
{
    const double d = (fmin(x, size - x) - from) / ramp;
    return d <= 0 ? 0 : d >= 1 ? 1 : 0.5 - 0.5 * cos(TZ_PI * d);
}

/* Mean half extent. */
static tz_vec2 mean_half(const tz_crowd *c)
{
    tz_vec2 sum = {0, 0};
    tz_counted u;
    int32_t n = 0;
    for (int32_t k = 0; k < c->n; k++) {
        if (!c->get(c->of, k, &u))
            continue;
        sum = tz_vec2_add(sum, half_extent(c, &u));
        n++;
    }
    return tz_vec2_scale(sum, 1.0 / (n > 0 ? n : 1));
}

/* Whether so few centres lie as near to the border as things reach that what the border
 * would cut was left out. */
static bool has_margin(const tz_crowd *c, int32_t n, tz_vec2 rim)
{
    const double inner = fmax(0, c->size.x - 2 * rim.x) * fmax(0, c->size.y - 2 * rim.y);
    const double due = n * (1 - inner / (c->size.x * c->size.y));
    tz_counted u;
    int32_t margin = 0;
    for (int32_t k = 0; k < c->n; k++)
        margin += c->get(c->of, k, &u) && in_frame(c->size, u.at) &&
                  (fmin(u.at.x, c->size.x - u.at.x) < rim.x ||
                   fmin(u.at.y, c->size.y - u.at.y) < rim.y);
    return margin < due - 2 * sqrt(due);
}

tz_counting tz_crowd_counting(const tz_crowd *c, bool repeats)
{
    tz_counted u;
    int32_t n = 0, whole = 0;
    for (int32_t k = 0; k < c->n; k++) {
        if (!c->get(c->of, k, &u))
            continue;
        n += in_frame(c->size, u.at);
        whole += !u.element->cut;
    }
    if (repeats)
        return (tz_counting){.how = TZ_COUNT_PERIOD};
    if (c->torus || n < FEW)
        return (tz_counting){.how = TZ_COUNT_FRAME};
    if (has_pieces(c))
        return (tz_counting){.how = whole > 0 ? TZ_COUNT_WHOLE : TZ_COUNT_FRAME};
    const tz_vec2 rim = mean_half(c);
    const double ramp = 1.5 * sqrt(c->size.x * c->size.y / n);
    const bool window = has_margin(c, n, rim) && c->size.x > 2 * (rim.x + ramp) &&
                        c->size.y > 2 * (rim.y + ramp);
    return (tz_counting){window ? TZ_COUNT_WINDOW : TZ_COUNT_FRAME, rim, ramp};
}

double tz_crowd_weight(const tz_crowd *c, const tz_counting *how, const tz_counted *u)
{
    const tz_vec2 size = c->size, rim = how->rim;
    const double area = size.x * size.y;
    switch (how->how) {
    case TZ_COUNT_FRAME: return in_frame(size, u->at) ? 1 / area : 0;
    case TZ_COUNT_PERIOD: return tz_crowd_holds(size, u->at, u->radius) ? 1 / area : 0;
    case TZ_COUNT_WHOLE: {
        const tz_vec2 h = half_extent(c, u);
        return u->element->cut ? 0
                               : 1 / (fmax(0.25 * size.x, size.x - 2 * h.x) *
                                      fmax(0.25 * size.y, size.y - 2 * h.y));
    }
    case TZ_COUNT_WINDOW:
        return taper(u->at.x, size.x, rim.x, how->ramp) *
               taper(u->at.y, size.y, rim.y, how->ramp) /
               ((size.x - 2 * rim.x - how->ramp) * (size.y - 2 * rim.y - how->ramp));
    }
    return 0;
}

double tz_crowd_density(const tz_crowd *c, const tz_counting *how)
{
    double sum = 0;
    tz_counted u;
    for (int32_t k = 0; k < c->n; k++)
        if (c->get(c->of, k, &u))
            sum += tz_crowd_weight(c, how, &u);
    return sum;
}

/* ---- of sets ------------------------------------------------------------------------- */

static bool any_of(const void *of, int32_t k, tz_counted *u)
{
    const tz_element_set *s = of;
    const tz_element *e = &s->element.v[k];
    const tz_vec3 at = tz_domain_wrap(&s->domain, e->at);
    *u = (tz_counted){{at.x, at.y}, e->radius, e};
    return true;
}

static bool solid_of(const void *of, int32_t k, tz_counted *u)
{
    return any_of(of, k, u) &&
           !((const tz_element_set *)of)->kind.v[u->element->kind].is_void;
}

static tz_crowd crowd_of(const tz_element_set *set, bool voids)
{
    return (tz_crowd){.set = set,
                      .scale = 1,
                      .size = {set->domain.size.x, set->domain.size.y},
                      .torus = set->domain.torus,
                      .n = set->element.n,
                      .get = voids ? any_of : solid_of,
                      .of = set};
}

double tz_element_density(const tz_element_set *set, bool voids)
{
    const tz_crowd c = crowd_of(set, voids);
    tz_counted u;
    int32_t n = 0;
    if (!set->domain.region) {
        const tz_counting how = tz_crowd_counting(&c, !c.torus && tz_crowd_repeats(&c));
        return tz_crowd_density(&c, &how);
    }
    for (int32_t k = 0; k < c.n; k++)
        n += c.get(c.of, k, &u);
    return n / tz_domain_area(&set->domain);
}

void tz_element_weights(const tz_element_set *set, double *weight, bool *period)
{
    const tz_crowd c = crowd_of(set, true);
    const bool repeats = !c.torus && tz_crowd_repeats(&c);
    const tz_counting how = tz_crowd_counting(&c, repeats);
    tz_counted u;
    for (int32_t k = 0; k < c.n; k++)
        weight[k] = c.get(c.of, k, &u) ? tz_crowd_weight(&c, &how, &u) : 0;
    if (period)
        *period = repeats;
}
