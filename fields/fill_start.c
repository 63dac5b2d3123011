/* SPDX-License-Identifier: Apache-2.0 */
/* Where bodies come from: a layout, chance, or the emptiest places.
 *
 * [Hsu20] throws all elements at random, and names the local minima that follow: limbs of
 * a domain that got more than their share keep it. Here half of them (the larger) are
 * thrown, the rest goes, a part each iteration, to the largest empty discs, which are
 * corners of the power diagram; later the hardest pressed bodies are moved to what empty
 * discs there are, so that limbs exchange what they have. */
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "elements/bend.h"
#include "fields/fill_internal.h"

enum { STREAM_BODY = 0xf1e1d, STREAM_PLACE = 0xf1e1e };
#define LAYERS 4.0 /* of elements that may lie upon each other at the start */

/* ---- counts ------------------------------------------------------------------------- */

/* Mean area of the mix: of each entry that of its sizes, even in their logarithm. */
static double mean_area(const tz_fill *f)
{
    double sum = 0, share = 0;
    for (int32_t k = 0; k < f->entries; k++) {
        const tz_fill_model *m = &f->model.v[k];
        const double a = m->size[0] * m->size[0], b = m->size[1] * m->size[1];
        const double mean = b > a * 1.0001 ? (b - a) / log(b / a) : a;
        sum += m->share * m->area * mean, share += m->share;
    }
    return sum / share;
}

/* Area that elements of the palette's own sizes have which fill the domain in one layer. */
static double layer_area(const tz_fill *f)
{
    enum { PLACES = 64 };
    const tz_vec3 size = f->domain.size;
    double sum = 0, inside = 0;
    for (int i = 0; i < PLACES * PLACES; i++) {
        const tz_vec3 at = {(i % PLACES + 0.5) / PLACES * size.x,
                            (i / PLACES + 0.5) / PLACES * size.y, 0};
        if (!tz_domain_contains(&f->domain, at))
            continue;
        const double c = tz_fill_size(f, at), d = 1 + tz_fill_rho(f, at);
        sum += 1 / (c * c * d * d), inside++;
    }
    return tz_domain_area(&f->domain) * (inside > 0 ? sum / inside : 1);
}

tz_status tz_fill_count(tz_fill *f, double *count)
{
    *count = f->par.fill * layer_area(f) / mean_area(f);
    if (!(*count <= TZ_FILL_MOST))
        return tz_fail(f->ctx, TZ_LIMIT,
                       "%.3g elements would fill the domain; over %d are too many, take "
                       "larger ones or a smaller domain",
                       *count, TZ_FILL_MOST);
    return TZ_OK;
}

/* Heaps of many layers come to rest nowhere, and cost their square. */
static tz_status check_crowd(tz_fill *f, int32_t count)
{
    const double layer = layer_area(f), one = mean_area(f);
    double all = count > 1 ? count * one : 0;
    int32_t n = count;
    for (int32_t i = 0; i < f->body.n; i++) {
        const tz_fill_body *b = &f->body.v[i];
        const double c = b->size * tz_fill_scale(f, b->first);
        all += b->fixed ? 0 : f->model.v[b->model].area * c * c;
        n += !b->fixed;
    }
    if (!(all > LAYERS * layer))
        return TZ_OK;
    return tz_fail(f->ctx, TZ_INVALID,
                   "%d elements are %.3g times as large as the domain; about %.0f fill "
                   "it, take fewer, or smaller ones",
                   n, all / layer, fmin(f->par.fill, 1) * layer / one);
}

/* ---- new bodies --------------------------------------------------------------------- */

typedef struct draw {
    int32_t model;
    double size, turn, area;
} draw;

static draw draw_one(const tz_fill *f, int32_t entry, int32_t id)
{
    tz_rng g = tz_rng_make(f->seed, tz_rng_stream(STREAM_BODY, (uint64_t)id, 0));
    double all = 0;
    for (int32_t k = 0; k < f->entries; k++)
        all += f->model.v[k].share;
    double x = tz_rng_unit(&g) * all;
    int32_t k = 0;
    for (; k + 1 < f->entries && (x >= f->model.v[k].share || f->model.v[k].share <= 0);
         k++)
        x -= f->model.v[k].share;
    const tz_fill_model *m = &f->model.v[entry >= 0 ? entry : k];
    const double t = tz_rng_unit(&g);
    const double size = m->size[0] * pow(m->size[1] / m->size[0], t);
    return (draw){entry >= 0 ? entry : k, size,
                  m->turn + m->jitter * (2 * tz_rng_unit(&g) - 1), m->area * size * size};
}

static tz_status add_drawn(tz_fill *f, const draw *d, tz_vec3 at, int32_t like,
                           int32_t *out)
{
    double angle = tz_fill_angle(f, at), c = tz_fill_size(f, at);
    if (like >= 0) { /* where something lies already the fields have grown past strokes */
        const tz_vec2 t = tz_fill_turn(f, like);
        angle = atan2(t.y, t.x), c = tz_fill_scale(f, like);
    }
    tz_status s = tz_fill_add_body(f, d->model, at, angle, c, d->size, d->turn, out);
    if (s != TZ_OK)
        return s;
    const tz_fill_body *b = &f->body.v[*out];
    const tz_fill_model *m = &f->model.v[d->model];
    const double rho = like >= 0 ? f->rho[like] : tz_fill_rho(f, at);
    /* the middle of its discs lies at the place, wherever its reference point is */
    tz_vec2 mean = {0, 0};
    double total = 0;
    for (int32_t k = 0; k < b->n; k++) {
        const double w = m->radius[k] * m->radius[k];
        mean.x += w * f->at[b->first + k].x, mean.y += w * f->at[b->first + k].y;
        total += w;
        tz_fill_set_rho(f, b->first + k, rho);
    }
    for (int32_t k = 0; k < b->n; k++) {
        f->at[b->first + k].x += at.x - mean.x / total;
        f->at[b->first + k].y += at.y - mean.y / total;
    }
    return s;
}

tz_status tz_fill_new_body(tz_fill *f, int32_t entry, tz_vec3 at, int32_t *out)
{
    const draw d = draw_one(f, entry, f->made);
    return add_drawn(f, &d, at, -1, out);
}

/* Inside cells of a region, to draw places from. */
static tz_status inside_cells(tz_fill *f, int32_t **cells, int32_t *n)
{
    const tz_region *r = f->domain.region;
    const int32_t all = r->raster.width * r->raster.height;
    tz_status s = tz_alloc(f->ctx, cells, (size_t)all, sizeof **cells);
    *n = 0;
    for (int32_t i = 0; i < all && s == TZ_OK; i++)
        if (r->distance[i] > 0)
            (*cells)[(*n)++] = i;
    return s;
}

/* Denser where things are small or lie densely. */
static tz_vec3 random_place(const tz_fill *f, const int32_t *cells, int32_t n, int32_t id)
{
    enum { TRIES = 256 };
    tz_rng g = tz_rng_make(f->seed, tz_rng_stream(STREAM_PLACE, (uint64_t)id, 0));
    tz_vec3 at = {0, 0, 0};
    for (int k = 0; k < TRIES; k++) {
        const double x = tz_rng_unit(&g), y = tz_rng_unit(&g);
        at = (tz_vec3){x * f->domain.size.x, y * f->domain.size.y, 0};
        if (cells && n > 0) {
            const tz_raster *r = &f->domain.region->raster;
            const int32_t i = cells[tz_rng_below(&g, n)];
            at = (tz_vec3){(i % r->width + x) * r->size.x / r->width,
                           (i / r->width + y) * r->size.y / r->height, 0};
        }
        const double wide =
            tz_fill_size(f, at) * (1 + tz_fill_rho(f, at)) / f->guide.least;
        if (wide <= 1 || tz_rng_unit(&g) * wide * wide < 1)
            break;
    }
    return at;
}

static int by_area(const void *a, const void *b)
{
    const draw *p = a, *q = b;
    return (p->area < q->area) - (p->area > q->area);
}

/* By octaves of radius, largest first; within one in the order they were drawn in, so that
 * things of nearly one size are mixed everywhere. */
static tz_status draw_all(tz_fill *f, int32_t count, draw **out)
{
    draw *d = NULL;
    double most = 0;
    tz_status s = tz_alloc(f->ctx, &d, (size_t)count, sizeof *d);
    for (int32_t i = 0; i < count && s == TZ_OK; i++) {
        d[i] = draw_one(f, -1, i);
        most = fmax(most, d[i].area);
    }
    for (int32_t i = 0; i < count && s == TZ_OK; i++)
        d[i].area = floor(log2(d[i].area / most) / 2) - 1e-7 * i;
    if (s == TZ_OK && f->par.start == TZ_FILL_INSERT)
        qsort(d, (size_t)count, sizeof *d, by_area);
    *out = d;
    return s;
}

/* Area that all bodies take up, with the room about them that the density asks for, over
 * what they are to take up. */
static double fullness(const tz_fill *f)
{
    double sum = 0;
    for (int32_t i = 0; i < f->body.n; i++) {
        const tz_fill_body *b = &f->body.v[i];
        const double c = b->size * tz_fill_scale(f, b->first) * (1 + f->rho[b->first]);
        sum += b->gone ? 0 : f->model.v[b->model].area * c * c;
    }
    return sum / (f->par.fill * tz_domain_area(&f->domain));
}

/* Sizes between strokes are known only now: a few more, or the hardest pressed leave. */
static tz_status correct_count(tz_fill *f)
{
    tz_status s = TZ_OK;
    for (int32_t round = 0; round < 6 && s == TZ_OK; round++) {
        const double full = fullness(f);
        const int32_t some = (int32_t)(fabs(1 - full) * f->body.n);
        tz_fill_gap *gap = NULL;
        int32_t n = 0;
        if (some < 1 || fabs(1 - full) < 0.01)
            break;
        s = tz_fill_iterate(f, 1, NULL);
        if (s == TZ_OK)
            s = tz_fill_diagram(f);
        if (s == TZ_OK && full > 1)
            s = tz_fill_relieve(f, some);
        else if (s == TZ_OK)
            s = tz_fill_gaps(f, 0, some, &gap, &n);
        for (int32_t k = 0; k < n && s == TZ_OK; k++) {
            const draw d = draw_one(f, -1, f->made);
            int32_t out;
            s = add_drawn(f, &d, gap[k].at, gap[k].sample, &out);
        }
        tz_free(f->ctx, gap);
        if (s == TZ_OK)
            s = tz_fill_lists(f);
    }
    return s;
}

static tz_status insert_rest(tz_fill *f, const draw *d, int32_t from, int32_t count)
{
    tz_status s = TZ_OK;
    for (int32_t round = 0; from < count && s == TZ_OK && round < 64; round++) {
        tz_fill_gap *gap = NULL;
        int32_t n = 0;
        const int32_t batch = round < 63 ? count / 10 + 1 : count - from;
        s = tz_fill_iterate(f, round == 0 ? 3 : 1, NULL);
        if (s == TZ_OK)
            s = tz_fill_diagram(f);
        if (s == TZ_OK)
            s = tz_fill_gaps(f, 0.25 * f->unit * f->guide.least, batch, &gap, &n);
        for (int32_t k = 0; k < n && from < count && s == TZ_OK; k++) {
            int32_t out;
            s = add_drawn(f, &d[from++], gap[k].at, gap[k].sample, &out);
        }
        for (int32_t k = n; k < batch && from < count && s == TZ_OK && round > 16; k++) {
            int32_t out; /* no gaps are left: what comes presses others apart */
            s = add_drawn(f, &d[from], random_place(f, NULL, 0, from), -1, &out);
            from++;
        }
        tz_free(f->ctx, gap);
    }
    return s;
}

tz_status tz_fill_start_bodies(tz_fill *f, int32_t count)
{
    draw *d = NULL;
    int32_t *cells = NULL, n = 0, out;
    const bool insert = f->par.start == TZ_FILL_INSERT && count > 8;
    const int32_t thrown = insert ? (count + 1) / 2 : count;
    tz_status s = check_crowd(f, count);
    if (s == TZ_OK)
        s = draw_all(f, count, &d);
    if (s == TZ_OK && f->domain.region)
        s = inside_cells(f, &cells, &n);
    for (int32_t i = 0; i < thrown && s == TZ_OK; i++)
        s = add_drawn(f, &d[i], random_place(f, cells, n, i), -1, &out);
    if (s == TZ_OK)
        s = tz_fill_pack(f, true);
    if (s == TZ_OK && insert)
        s = insert_rest(f, d, thrown, count);
    if (s == TZ_OK && insert && f->job.count == 0 && (f->any_size || f->any_density))
        s = correct_count(f);
    if (s == TZ_OK && insert)
        s = tz_fill_pack(f, true);
    tz_free(f->ctx, cells);
    tz_free(f->ctx, d);
    return s;
}

/* ---- from a layout ------------------------------------------------------------------ */

static int32_t entry_of(const tz_fill *f, const tz_element *e)
{
    for (int32_t k = 0; k < f->entries; k++)
        if (f->model.v[k].element == e->source)
            return f->model.v[k].symbol == e->symbol ? k : -1;
    return -1;
}

static tz_status keep_obstacle(tz_fill *f, const tz_element_set *layout,
                               const tz_element *of)
{
    tz_element e = *of;
    tz_status s = TZ_OK;
    e.sample = f->obstacle_sample.n;
    for (int32_t k = 0; k < e.samples && s == TZ_OK; k++)
        s = tz_array_push(f->ctx, &f->obstacle_sample, layout->sample.v[of->sample + k]);
    return s == TZ_OK ? tz_array_push(f->ctx, &f->obstacle, e) : s;
}

/* A soft body that was bent in the layout begins so: discs go where the bend takes them,
 * and turn as it turns there. */
static tz_status bend_discs(tz_fill *f, const tz_element_set *layout, int32_t i,
                            int32_t body)
{
    const tz_fill_body *b = &f->body.v[body];
    const tz_fill_model *m = &f->model.v[b->model];
    tz_bend bend;
    if (m->rigidity >= TZ_FILL_RIGID || m->element < 0 || m->samples < 2 || b->n < 2)
        return TZ_OK;
    const tz_status s = tz_bend_init(f->ctx, layout, i, f->job.palette, &bend);
    if (s != TZ_OK)
        return s;
    const double x = cos(m->angle) / m->scale, y = sin(m->angle) / m->scale;
    const double step = 0.01 * m->reach;
    for (int32_t k = 0; k < b->n && !tz_bend_is_plain(&bend); k++) {
        tz_vec2 at[2];
        for (int e = 0; e < 2; e++) {
            const double u = m->rest[k].x + e * step, v = m->rest[k].y;
            at[e] = tz_bend_apply(&bend, (tz_vec2){x * u + y * v, x * v - y * u});
        }
        const double angle = atan2(at[1].y - at[0].y, at[1].x - at[0].x) - b->turn;
        double *o = &f->o[2 * (ptrdiff_t)(b->first + k)];
        f->at[b->first + k] = (tz_vec3){at[0].x, at[0].y, 0};
        o[0] = cos(angle), o[1] = sin(angle);
    }
    tz_bend_deinit(&bend);
    return s;
}

typedef struct heaped {
    double x, y; /* cell */
    int32_t element;
} heaped;

static int by_cell(const void *a, const void *b)
{
    const heaped *p = a, *q = b;
    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    if (p->y != q->y)
        return p->y < q->y ? -1 : 1;
    return p->element - q->element;
}

/* Of each element, how many lie in its cell before it. Cells are as large as things. */
static tz_status find_heaps(tz_fill *f, const tz_element_set *layout, int32_t *rank)
{
    heaped *list = NULL;
    tz_status s = tz_alloc(f->ctx, &list, (size_t)layout->element.n, sizeof *list);
    for (int32_t i = 0; i < layout->element.n && s == TZ_OK; i++) {
        const tz_element *e = &layout->element.v[i];
        list[i] = (heaped){floor(e->at.x / f->unit), floor(e->at.y / f->unit), i};
    }
    if (s == TZ_OK)
        qsort(list, (size_t)layout->element.n, sizeof *list, by_cell);
    for (int32_t i = 0; i < layout->element.n && s == TZ_OK; i++) {
        const bool same =
            i > 0 && list[i].x == list[i - 1].x && list[i].y == list[i - 1].y;
        rank[list[i].element] = same ? rank[list[i - 1].element] + 1 : 0;
    }
    tz_free(f->ctx, list);
    return s;
}

/* Where one of a heap begins: by the golden angle about it, each with its own area. */
static tz_vec3 out_of_heap(const tz_fill *f, tz_vec3 at, double radius, int32_t rank)
{
    enum { FEW = 8 };
    if (rank < FEW)
        return at;
    const double r = radius * sqrt(rank - FEW), a = 2.39996322972865332 * rank;
    const tz_vec3 q = {at.x + r * cos(a), at.y + r * sin(a), at.z};
    return tz_domain_contains(&f->domain, tz_domain_wrap(&f->domain, q)) ? q : at;
}

tz_status tz_fill_begin_bodies(tz_fill *f, const tz_element_set *layout)
{
    int32_t *rank = NULL;
    tz_status s = tz_element_set_check(f->ctx, layout, "layout");
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &rank, (size_t)layout->element.n, sizeof *rank);
    if (s == TZ_OK)
        s = find_heaps(f, layout, rank);
    for (int32_t i = 0; i < layout->element.n && s == TZ_OK; i++) {
        const tz_element *e = &layout->element.v[i];
        int32_t model = entry_of(f, e), body;
        const bool obstacle = model < 0;
        if (layout->kind.v[e->kind].is_void)
            continue;
        if (obstacle)
            s = tz_fill_model_of_symbol(f, layout, e->symbol, &model);
        if (s != TZ_OK)
            break;
        const tz_fill_model *m = &f->model.v[model];
        const double c = obstacle ? 1 : tz_fill_size(f, e->at);
        const double turn = obstacle ? 0 : m->turn;
        tz_vec3 at = e->at;
        /* heaps of elements at one place: the diagram tells no two sites there apart */
        tz_rng g = tz_rng_make(f->seed, tz_rng_stream(STREAM_PLACE, (uint64_t)i, 1));
        if (!obstacle && !e->fixed) {
            at = out_of_heap(f, at, e->radius, rank[i]);
            at.x += 1e-3 * e->radius * (tz_rng_unit(&g) - 0.5);
            at.y += 1e-3 * e->radius * (tz_rng_unit(&g) - 0.5);
        }
        s = tz_fill_add_body(f, model, at, e->angle - m->angle - turn, c,
                             e->scale / m->scale / c, turn, &body);
        if (s != TZ_OK)
            break;
        f->body.v[body].fixed = e->fixed || obstacle;
        f->body.v[body].source = f->obstacle.n;
        s = keep_obstacle(f, layout, e);
        if (s == TZ_OK)
            s = bend_discs(f, layout, i, body);
        for (int32_t k = f->body.v[body].first; k < f->n; k++)
            tz_fill_set_rho(f, k, tz_fill_rho(f, f->at[k]));
    }
    tz_free(f->ctx, rank);
    return s;
}

/* ---- empty places ------------------------------------------------------------------- */

static int by_size(const void *a, const void *b)
{
    const tz_fill_gap *p = a, *q = b;
    if (p->size != q->size)
        return p->size < q->size ? 1 : -1;
    return (p->sample > q->sample) - (p->sample < q->sample);
}

/* Whether a corner's power is the greatest about: of the cells that share the corner only
 * the first has it. */
static bool is_peak(const tz_power_cells *c, int32_t s)
{
    for (int32_t k = 0; k < c->count[s]; k++) {
        const int32_t q = c->neighbour[c->start[s] + k];
        const double g = c->gap[q], h = c->gap[s] * (1 + 1e-9);
        if (g > h || (q < s && g >= c->gap[s] * (1 - 1e-9)))
            return false;
    }
    return c->gap[s] > 0;
}

/* Radius of the empty disc at a cell's corner. */
static double room_at(const tz_fill *f, const tz_power_cells *c, int32_t s, tz_vec3 at)
{
    double room = tz_domain_depth(&f->domain, tz_domain_wrap(&f->domain, at));
    for (int32_t k = -1; k < c->count[s]; k++) {
        const int32_t q = k < 0 ? s : c->neighbour[c->start[s] + k];
        const tz_vec3 v = tz_fill_vector(f, at, f->at[q]);
        room = fmin(room, hypot(v.x, v.y) - tz_fill_radius(f, q));
    }
    return room;
}

tz_status tz_fill_gaps(tz_fill *f, double least, int32_t most, tz_fill_gap **out,
                       int32_t *n)
{
    const tz_power_cells c = tz_power_get(f->power);
    TZ_ARRAY(tz_fill_gap)
    list = {0};
    tz_status s = TZ_OK;
    for (int32_t j = 0; j < f->live_sample.n && s == TZ_OK; j++) {
        const int32_t i = f->live_sample.v[j];
        if (i >= c.n || !is_peak(&c, i))
            continue;
        const tz_vec3 p = tz_domain_wrap(&f->domain, f->at[i]);
        const tz_vec3 at = {p.x + c.gap_at[i].x, p.y + c.gap_at[i].y, 0};
        const double r = room_at(f, &c, i, at);
        if (r >= least)
            s = tz_array_push(
                f->ctx, &list,
                ((tz_fill_gap){r, r / (tz_fill_scale(f, i) * (1 + f->rho[i])),
                               tz_domain_wrap(&f->domain, at), i}));
    }
    if (s == TZ_OK && list.n > 1)
        qsort(list.v, (size_t)list.n, sizeof *list.v, by_size);
    *n = s != TZ_OK ? 0 : list.n < most ? list.n : most;
    if (s != TZ_OK)
        tz_array_free(f->ctx, &list);
    *out = list.v;
    return s;
}

typedef struct pressed {
    double pressure, radius;
    int32_t body;
} pressed;

static int by_pressure(const void *a, const void *b)
{
    const pressed *p = a, *q = b;
    if (p->pressure != q->pressure)
        return p->pressure < q->pressure ? 1 : -1;
    return (p->body > q->body) - (p->body < q->body);
}

/* Bodies that lack more than `enough`, worst first. */
static tz_status list_pressed(tz_fill *f, double enough, pressed **out, int32_t *n)
{
    TZ_ARRAY(pressed)
    list = {0};
    tz_status s = TZ_OK;
    for (int32_t j = 0; j < f->live.n && s == TZ_OK; j++) {
        const tz_fill_body *b = &f->body.v[f->live.v[j]];
        pressed p = {0, 0, f->live.v[j]};
        for (int32_t i = b->first; i < b->first + b->n; i++) {
            p.pressure = fmax(p.pressure, f->pressure[i]);
            p.radius = fmax(p.radius, tz_fill_radius(f, i));
        }
        if (p.pressure >= enough)
            s = tz_array_push(f->ctx, &list, p);
    }
    if (list.n > 1)
        qsort(list.v, (size_t)list.n, sizeof *list.v, by_pressure);
    *out = list.v, *n = list.n;
    return s;
}

tz_status tz_fill_relieve(tz_fill *f, int32_t count)
{
    pressed *list = NULL;
    int32_t n = 0;
    tz_status s = list_pressed(f, 0, &list, &n);
    for (int32_t k = 0; k < n && k < count && s == TZ_OK; k++)
        s = tz_fill_remove(f, list[k].body);
    tz_free(f->ctx, list);
    return s == TZ_OK ? tz_fill_lists(f) : s;
}

/* Bodies that lack more than their neighbours can give go where their largest disc fits. */
tz_status tz_fill_teleport(tz_fill *f, double share)
{
    const double enough = 0.45;
    pressed *list = NULL;
    tz_fill_gap *gap = NULL;
    int32_t n = 0, gaps = 0, next = 0;
    double least = HUGE_VAL;
    tz_status s = list_pressed(f, enough, &list, &n);
    for (int32_t k = 0; k < n && s == TZ_OK; k++)
        least = fmin(least, list[k].radius);
    const int32_t most = (int32_t)fmin(n, ceil(share * f->live.n));
    if (s == TZ_OK && most > 0)
        s = tz_fill_gaps(f, 0.75 * least, 4 * most, &gap, &gaps);
    for (int32_t k = 0; k < n && next < gaps && next < most && s == TZ_OK; k++) {
        const tz_fill_body *b = &f->body.v[list[k].body];
        const int32_t near = gap[next].sample;
        const tz_vec2 t = tz_fill_turn(f, near);
        const double by = tz_fill_scale(f, near) / tz_fill_scale(f, b->first);
        if (list[k].radius * by * 0.75 > gap[next].radius)
            continue;
        if (near >= b->first && near < b->first + b->n)
            continue; /* it lies there itself */
        tz_fill_put(f, list[k].body, gap[next].at, atan2(t.y, t.x),
                    tz_fill_scale(f, near));
        next++;
        f->moved++;
        f->fresh = false;
    }
    tz_free(f->ctx, list);
    tz_free(f->ctx, gap);
    return s;
}
