/* SPDX-License-Identifier: Apache-2.0 */
/* Sites in grids, one for each octave of radii, so that the weights of one are nearly
 * alike and small cells do not search far because there is a large site somewhere. A cell
 * of a grid is a list through its sites: a site that moves changes lists, and the rest of
 * the grid stays. All is made anew only where counts have doubled or halved. */
#include "fields/power_internal.h"

static int level_of(const tz_power *p, double w)
{
    int l = 0;
    for (double r = p->unit * p->unit; w > r && l < TZ_POWER_LEVELS - 1; r *= 4)
        l++;
    return l;
}

void tz_power_grid_forget(tz_power *p)
{
    for (int l = 0; l < TZ_POWER_LEVELS; l++) {
        tz_free(p->ctx, p->lv[l].head);
        p->lv[l] = (tz_power_level){0};
    }
    p->unit = 0;
}

static tz_status make_level(tz_power *p, int l)
{
    tz_power_level *v = &p->lv[l];
    const tz_vec3 size = p->domain.size;
    const double side = fmax(p->unit * (1 << l) * 1.5, /* about two sites a cell */
                             sqrt(2 * size.x * size.y / v->n));
    v->nx = (int32_t)fmin(fmax(floor(size.x / side), 1), 8192);
    v->ny = (int32_t)fmin(fmax(floor(size.y / side), 1), 8192);
    v->cell_x = size.x / v->nx, v->cell_y = size.y / v->ny;
    v->made_for = v->n;
    const size_t cells = (size_t)v->nx * (size_t)v->ny;
    const tz_status s = tz_alloc(p->ctx, &v->head, cells, sizeof *v->head);
    for (size_t c = 0; c < cells && s == TZ_OK; c++)
        v->head[c] = -1;
    return s;
}

static int32_t cell_of(const tz_power *p, const tz_power_level *v, tz_vec3 at)
{
    const tz_vec3 q = tz_domain_wrap(&p->domain, at);
    return tz_power_clamp(q.y / v->cell_y, v->ny) * v->nx +
           tz_power_clamp(q.x / v->cell_x, v->nx);
}

static void put(tz_power *p, int32_t i, int level, int32_t cell)
{
    tz_power_level *v = &p->lv[level];
    p->level[i] = (uint8_t)level;
    p->cell[i] = cell;
    p->next[i] = v->head[cell];
    v->head[cell] = i;
    v->most = fmax(v->most, p->weight[i]);
}

static void take_out(tz_power *p, int32_t i)
{
    tz_power_level *v = &p->lv[p->level[i]];
    int32_t *at = &v->head[p->cell[i]];
    while (*at != i)
        at = &p->next[*at];
    *at = p->next[i];
    p->cell[i] = -1;
    v->n--;
}

static tz_status make_all(tz_power *p)
{
    const tz_vec3 size = p->domain.size;
    tz_power_grid_forget(p);
    p->unit = sqrt(size.x * size.y / fmax(p->n, 1));
    for (int32_t i = 0; i < p->n; i++) {
        p->cell[i] = -1;
        if (p->weight[i] >= 0)
            p->lv[p->level[i] = (uint8_t)level_of(p, p->weight[i])].n++;
    }
    tz_status s = TZ_OK;
    for (int l = 0; l < TZ_POWER_LEVELS && s == TZ_OK; l++)
        if (p->lv[l].n > 0)
            s = make_level(p, l);
    for (int32_t i = p->n - 1; i >= 0 && s == TZ_OK; i--)
        if (p->weight[i] >= 0)
            put(p, i, p->level[i], cell_of(p, &p->lv[p->level[i]], p->at[i]));
    if (s != TZ_OK)
        tz_power_grid_forget(p);
    return s;
}

static bool is_number(const tz_power *p, int32_t i)
{
    return isfinite(p->at[i].x) && isfinite(p->at[i].y) && isfinite(p->weight[i]);
}

/* Whether the levels still suit what they hold. */
static bool suits(const tz_power *p)
{
    for (int l = 0; l < TZ_POWER_LEVELS; l++) {
        const tz_power_level *v = &p->lv[l];
        if (v->n > 2 * v->made_for + 64 || 4 * v->n < v->made_for)
            return false;
    }
    return p->unit > 0;
}

tz_status tz_power_grid_update(tz_power *p, int32_t n, const int32_t *which)
{
    bool anew = !suits(p);
    for (int32_t k = 0; k < n; k++) {
        const int32_t i = which ? which[k] : k;
        if (!is_number(p, i))
            return tz_fail(p->ctx, TZ_INVALID,
                           "power diagram: place or weight of site %d is not a number",
                           i);
        if (anew)
            continue;
        const double w = p->weight[i];
        const int l = w >= 0 ? level_of(p, w) : 0;
        tz_power_level *v = &p->lv[l];
        if (w >= 0 && !v->head) {
            anew = true;
            continue;
        }
        const int32_t cell = w >= 0 ? cell_of(p, v, p->at[i]) : -1;
        if (p->cell[i] == cell && (cell < 0 || p->level[i] == l)) {
            v->most = fmax(v->most, w);
            continue;
        }
        if (p->cell[i] >= 0)
            take_out(p, i);
        if (cell >= 0)
            put(p, i, l, cell), v->n++;
    }
    return anew || !suits(p) ? make_all(p) : TZ_OK;
}
