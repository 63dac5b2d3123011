/* SPDX-License-Identifier: Apache-2.0 */
/* Density of an exemplar, its border taken into account.
 *
 * Elements over area is right where every element whose centre lies in the frame is there
 * and stands for itself. Two habits of drawings spoil it:
 *   - elements that the frame cuts are pieces, with a centre of their own (two halves of
 *     one thing count twice). Then only whole ones count, each by how likely a thing of
 *     its extent w, h is to be whole in a frame W, H (Horvitz, Thompson 1952):
 *         density = sum of 1 / ((W - w) (H - h))
 *   - cut elements were left out, which leaves a margin that the texture itself has not.
 *     Then an inner window counts, whose weight rises smoothly from its border, so that
 *     rows of lattices do not enter at one stroke. */
#include <math.h>

#include "elements/growth_internal.h"

/* Half the extent of a unit. */
static tz_vec2 half_extent(const tz_growth_exemplar *ex, const tz_growth_unit *u)
{
    const tz_element *e = &ex->set->element.v[u->source];
    const tz_element_symbol *y = &ex->set->symbol.v[e->symbol];
    const double c = cos(e->angle), s = sin(e->angle);
    const double scale = e->scale * ex->texture.scale;
    tz_vec2 h = {0, 0};
    if (y->outline.n == 0)
        return (tz_vec2){u->r, u->r};
    for (int32_t k = 0; k < y->outline.n; k++) {
        const tz_vec2 p = y->outline.v[k];
        h.x = fmax(h.x, scale * fabs(c * p.x - s * p.y));
        h.y = fmax(h.y, scale * fabs(s * p.x + c * p.y));
    }
    return h;
}

static bool in_frame(const tz_growth_exemplar *ex, const tz_growth_unit *u)
{
    return u->x >= 0 && u->y >= 0 && u->x < ex->size.x && u->y < ex->size.y;
}

/* Whether some cut elements are mere pieces: they end where the frame does. */
static bool has_pieces(const tz_growth_exemplar *ex)
{
    for (int32_t k = 0; k < ex->elements; k++) {
        const tz_growth_unit *u = &ex->unit[k];
        if (!ex->set->element.v[u->source].cut)
            continue;
        const tz_vec2 h = half_extent(ex, u);
        const double over = 0.02 * u->r;
        if (u->x - h.x > -over && u->y - h.y > -over && u->x + h.x < ex->size.x + over &&
            u->y + h.y < ex->size.y + over)
            return true;
    }
    return false;
}

static double by_whole_ones(const tz_growth_exemplar *ex)
{
    double sum = 0;
    for (int32_t k = 0; k < ex->elements; k++) {
        const tz_growth_unit *u = &ex->unit[k];
        if (ex->set->element.v[u->source].cut)
            continue;
        const tz_vec2 h = half_extent(ex, u);
        sum += 1 / (fmax(0.25 * ex->size.x, ex->size.x - 2 * h.x) *
                    fmax(0.25 * ex->size.y, ex->size.y - 2 * h.y));
    }
    return sum;
}

/* Weight of a coordinate: 0 up to `from` from either end, 1 from `from + ramp` on. */
static double taper(double x, double size, double from, double ramp)
{
    const double d = (fmin(x, size - x) - from) / ramp;
    return d <= 0 ? 0 : d >= 1 ? 1 : 0.5 - 0.5 * cos(TZ_PI * d);
}

static double by_window(const tz_growth_exemplar *ex, tz_vec2 from, double ramp)
{
    double sum = 0;
    for (int32_t k = 0; k < ex->elements; k++)
        sum += taper(ex->unit[k].x, ex->size.x, from.x, ramp) *
               taper(ex->unit[k].y, ex->size.y, from.y, ramp);
    return sum / ((ex->size.x - 2 * from.x - ramp) * (ex->size.y - 2 * from.y - ramp));
}

void tz_growth_find_density(tz_growth_exemplar *ex)
{
    const double area = ex->size.x * ex->size.y;
    int32_t n = 0, margin = 0;
    tz_vec2 rim = {0, 0};
    for (int32_t k = 0; k < ex->elements; k++)
        n += in_frame(ex, &ex->unit[k]);
    ex->density = n / area;
    if (ex->torus || n < 8)
        return;
    if (has_pieces(ex)) {
        const double whole = by_whole_ones(ex);
        ex->density = whole > 0 ? whole : ex->density;
        return;
    }
    for (int32_t k = 0; k < ex->elements; k++) {
        const tz_vec2 h = half_extent(ex, &ex->unit[k]);
        rim.x += h.x / ex->elements, rim.y += h.y / ex->elements;
    }
    for (int32_t k = 0; k < ex->elements; k++) {
        const tz_growth_unit *u = &ex->unit[k];
        margin += in_frame(ex, u) && (fmin(u->x, ex->size.x - u->x) < rim.x ||
                                      fmin(u->y, ex->size.y - u->y) < rim.y);
    }
    const double due = n * (1 - fmax(0, ex->size.x - 2 * rim.x) *
                                    fmax(0, ex->size.y - 2 * rim.y) / area);
    const double ramp = 1.5 * sqrt(area / n);
    if (margin < due - 2 * sqrt(due) && ex->size.x > 2 * rim.x + 2 * ramp &&
        ex->size.y > 2 * rim.y + 2 * ramp)
        ex->density = by_window(ex, rim, ramp);
}
