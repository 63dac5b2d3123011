/* SPDX-License-Identifier: Apache-2.0 */
/* Empty places. A thing is put to each, largest first, and looks for the best place about
 * there while what lies beside it is held; how hard it is pressed then, against what all
 * are, says whether it stays. Either a new one of the mix, or one that is pressed much
 * harder where it is: so densities become even over any distance, which no push can do
 * across rows of long things, and jams dissolve. */
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "fields/fill_outline_internal.h"

enum {
    NEAR = 128, /* bodies about a place, at most */
    STEPS = 5,  /* of one that looks for its place */
    TRIES = 4,  /* places for one that may move; entries for one place */
    STREAM_GAP = 0xf1e20
};
#define PRESSED 2.0 /* times as hard as the mean: may move */
#define BETTER  0.6 /* of how hard it was pressed */
#define HOLD    1.4 /* times its radius: the largest disc of what may come to a gap */

/* Bodies about a place. */
typedef struct about {
    int32_t n, body[NEAR];
    int8_t best[NEAR][2]; /* nearest points, once they are known */
} about;

static void add_about(const tz_fill *f, about *a, int32_t body)
{
    bool new = !f->body.v[body].gone && a->n < NEAR;
    for (int32_t j = 0; j < a->n && new; j++)
        new = a->body[j] != body;
    if (new)
        a->body[a->n++] = body;
}

/* Two rings of the diagram, and those of a list that have come since it was made. */
static void find_about(const tz_fill_outlines *o, const tz_fill_gap *g,
                       const int32_t *late, int32_t lates, about *a)
{
    const tz_fill *f = o->f;
    const tz_power_cells c = tz_power_get(f->power);
    a->n = 0;
    for (int32_t k = -1; k < c.count[g->sample]; k++) {
        const int32_t q = k < 0 ? g->sample : c.neighbour[c.start[g->sample] + k];
        for (int32_t e = -1; e < c.count[q]; e++)
            add_about(f, a, f->owner[e < 0 ? q : c.neighbour[c.start[q] + e]]);
    }
    for (int32_t i = 0; i < lates; i++) {
        const tz_fill_pose_of *p = &o->pose[late[i]];
        const tz_vec3 v = tz_fill_vector(f, (tz_vec3){p->at.x, p->at.y, 0}, g->at);
        const double far = 3 * p->reach + g->radius;
        if (v.x * v.x + v.y * v.y < far * far)
            add_about(f, a, late[i]);
    }
}

/* What a stroke says there, or the mean direction of what lies about, the nearer the more;
 * about a whirl these cancel each other, and what lies harmonically between the strokes
 * knows which way is forth. */
static double angle_about(const tz_fill *f, const tz_fill_gap *g)
{
    const tz_element_field_cell *said =
        f->any_direction ? tz_element_field_at(f->field, g->at) : NULL;
    if (said && (said->x != 0 || said->y != 0))
        return atan2((double)said->y, (double)said->x);
    const tz_power_cells c = tz_power_get(f->power);
    tz_vec2 sum = {0, 0};
    for (int32_t k = -1; k < c.count[g->sample]; k++) {
        const int32_t q = k < 0 ? g->sample : c.neighbour[c.start[g->sample] + k];
        const tz_vec3 v = tz_fill_vector(f, f->at[q], g->at);
        const double w = 1 / (v.x * v.x + v.y * v.y + 0.01 * f->radius[q] * f->radius[q]);
        sum = tz_vec2_add(sum, tz_vec2_scale(tz_fill_turn(f, q), w));
    }
    tz_vec2 between;
    if (f->any_direction && tz_fill_direction(f, g->at, &between) > 0 &&
        tz_vec2_dot(sum, between) < 0)
        sum = between;
    return atan2(sum.y, sum.x);
}

/* What one body lacks to those about it, as they lie. */
static double sum_about(const tz_fill_outlines *o, int32_t i, about *a, bool whole,
                        double row[3], tz_vec2 *b)
{
    double energy = 0;
    row[0] = row[1] = row[2] = 0, *b = (tz_vec2){0, 0};
    if (whole) /* all: one that is too far away now may come near later */
        memset(a->best, -1, sizeof a->best);
    for (int32_t j = 0; j <= a->n; j++) {
        for (int e = 0; e < 2; e++) {
            tz_vec2 at, way = {0, 0};
            double lack = 0;
            if (j == a->n) {
                if (e == 0)
                    lack =
                        tz_fill_outline_border(o, i, o->part * o->pose[i].gap, &at, &way);
            } else if (a->body[j] != i && tz_fill_outlines_near(o, i, a->body[j])) {
                const int32_t q = a->body[j];
                const double gap = o->part * (o->pose[i].gap + o->pose[q].gap);
                int8_t *best = &a->best[j][e];
                lack = gap + tz_fill_outline_depth(o, e ? q : i, e ? i : q, -gap, whole,
                                                   best, &at, &way);
                if (e)
                    way = tz_vec2_scale(way, -1);
            }
            if (!(lack > 0))
                continue;
            energy += lack * lack;
            row[0] += way.x * way.x, row[1] += way.x * way.y, row[2] += way.y * way.y;
            b->x += lack * way.x, b->y += lack * way.y;
        }
    }
    return energy;
}

/* The best place about where a body is, for it alone; how hard it is pressed there. Given
 * up where that stays far above what is enough. */
static double settle_one(tz_fill_outlines *o, int32_t i, about *a, double enough)
{
    const double ease = 0.2, hopeless = 4;
    const tz_fill *f = o->f;
    const tz_fill_body *q = &f->body.v[i];
    const double most = 0.5 * f->radius[q->first] * tz_fill_scale(f, q->first);
    double row[3], energy = 0;
    tz_vec2 b;
    for (int32_t k = 0; k <= STEPS; k++) {
        energy = sum_about(o, i, a, k == 0, row, &b);
        if (k == STEPS || !(energy > 0) || (k > 1 && energy > hopeless * enough))
            break;
        const double x = row[0] + ease, y = row[2] + ease,
                     d = 1 / (x * y - row[1] * row[1]);
        tz_vec2 by = {d * (y * b.x - row[1] * b.y), d * (x * b.y - row[1] * b.x)};
        const double l = tz_vec2_length(by);
        if (l > most)
            by = tz_vec2_scale(by, most / l);
        tz_fill_outline_move(o, i, by);
    }
    return energy;
}

/* The middle of its discs, from the reference point, as a body lies. */
static tz_vec2 middle_of(const tz_fill *f, int32_t model, double angle, double scale)
{
    const tz_fill_model *m = &f->model.v[model];
    tz_vec2 mean = {0, 0};
    double total = 0;
    for (int32_t k = 0; k < m->n; k++) {
        const double w = m->radius[k] * m->radius[k];
        mean.x += w * m->rest[k].x, mean.y += w * m->rest[k].y, total += w;
    }
    const double x = cos(angle) * scale / total, y = sin(angle) * scale / total;
    return (tz_vec2){x * mean.x - y * mean.y, y * mean.x + x * mean.y};
}

/* Puts a body's middle to an empty place. */
static void put_at(tz_fill_outlines *o, int32_t i, const tz_fill_gap *g)
{
    tz_fill *f = o->f;
    const tz_fill_body *b = &f->body.v[i];
    const double angle = angle_about(f, g), c = tz_fill_scale(f, g->sample);
    const tz_vec2 d = middle_of(f, b->model, angle + b->turn, c * b->size);
    tz_fill_put(f, i, (tz_vec3){g->at.x - d.x, g->at.y - d.y, 0}, angle, c);
    for (int32_t k = b->first; k < b->first + b->n; k++)
        tz_fill_set_rho(f, k, f->rho[g->sample]);
    tz_fill_outline_find(o, i);
}

/* ---- moves -------------------------------------------------------------------------- */

typedef struct pressed {
    double energy;
    int32_t body;
} pressed;

static int by_energy(const void *a, const void *b)
{
    const pressed *p = a, *q = b;
    if (p->energy != q->energy)
        return p->energy < q->energy ? 1 : -1;
    return (p->body > q->body) - (p->body < q->body);
}

static double mean_energy(const tz_fill_outlines *o)
{
    const tz_fill *f = o->f;
    double sum = 0, n = 0;
    for (int32_t j = 0; j < f->live.n; j++)
        if (!f->body.v[f->live.v[j]].gone)
            sum += o->lack[f->live.v[j]].energy, n++;
    return n > 0 ? sum / n : 0;
}

/* All that are pressed harder than that, worst first. */
static tz_status list_pressed(tz_fill_outlines *o, double least, pressed **out,
                              int32_t *n)
{
    const tz_fill *f = o->f;
    tz_status s = tz_alloc(f->ctx, out, (size_t)f->live.n + 1, sizeof **out);
    *n = 0;
    for (int32_t j = 0; j < f->live.n && s == TZ_OK; j++) {
        const int32_t i = f->live.v[j];
        if (!f->body.v[i].gone && o->lack[i].energy > least)
            (*out)[(*n)++] = (pressed){o->lack[i].energy, i};
    }
    if (*n > 1)
        qsort(*out, (size_t)*n, sizeof **out, by_energy);
    return s;
}

/* A body as it lay, to put it back. */
typedef struct kept {
    tz_vec3 at[TZ_COVER_DISCS];
    double o[2 * TZ_COVER_DISCS], c[TZ_COVER_DISCS], rho[TZ_COVER_DISCS];
} kept;

static void keep(const tz_fill *f, int32_t i, kept *k)
{
    const tz_fill_body *b = &f->body.v[i];
    memcpy(k->at, f->at + b->first, (size_t)b->n * sizeof *k->at);
    memcpy(k->o, f->o + 2 * (ptrdiff_t)b->first, (size_t)b->n * 2 * sizeof *k->o);
    memcpy(k->c, f->c + b->first, (size_t)b->n * sizeof *k->c);
    memcpy(k->rho, f->rho + b->first, (size_t)b->n * sizeof *k->rho);
}

static void put_back(tz_fill_outlines *o, int32_t i, const kept *k)
{
    tz_fill *f = o->f;
    const tz_fill_body *b = &f->body.v[i];
    memcpy(f->at + b->first, k->at, (size_t)b->n * sizeof *k->at);
    memcpy(f->o + 2 * (ptrdiff_t)b->first, k->o, (size_t)b->n * 2 * sizeof *k->o);
    memcpy(f->c + b->first, k->c, (size_t)b->n * sizeof *k->c);
    for (int32_t e = 0; e < b->n; e++)
        tz_fill_set_rho(f, b->first + e, k->rho[e]);
    tz_fill_outline_find(o, i);
}

tz_status tz_fill_gap_move(tz_fill_outlines *o, double share, int32_t *moved)
{
    tz_fill *f = o->f;
    pressed *list = NULL;
    tz_fill_gap *gap = NULL;
    int32_t *late = NULL, n = 0, gaps = 0;
    *moved = 0;
    tz_status s = tz_fill_contacts_find(o);
    if (s == TZ_OK)
        s = tz_fill_contacts_measure(o);
    if (s == TZ_OK)
        s = list_pressed(o, PRESSED * mean_energy(o), &list, &n);
    const int32_t most = (int32_t)fmin(n, ceil(share * f->live.n));
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &late, (size_t)most + 1, sizeof *late);
    if (s == TZ_OK && most > 0)
        s = tz_fill_gaps(f, 0, TRIES * most, &gap, &gaps);
    for (int32_t next = 0; next < gaps && *moved < most && s == TZ_OK; next++) {
        const pressed *p = &list[*moved];
        kept was;
        about a;
        keep(f, p->body, &was);
        find_about(o, &gap[next], late, *moved, &a);
        put_at(o, p->body, &gap[next]);
        if (settle_one(o, p->body, &a, BETTER * p->energy) < BETTER * p->energy) {
            o->lack[p->body].turned = 0;
            late[(*moved)++] = p->body;
        } else {
            put_back(o, p->body, &was);
        }
    }
    f->moved += *moved;
    f->fresh = false;
    tz_free(f->ctx, list);
    tz_free(f->ctx, late);
    tz_free(f->ctx, gap);
    return s;
}

/* ---- newcomers ---------------------------------------------------------------------- */

/* One of an entry at a gap, if it is pressed no harder there than that. */
static tz_status try_one(tz_fill_outlines *o, int32_t entry, double size,
                         const tz_fill_gap *g, about *a, double most, bool *came)
{
    tz_fill *f = o->f;
    const tz_fill_model *m = &f->model.v[entry];
    const int32_t n = f->n, bodies = f->body.n;
    tz_rng rng = tz_rng_make(f->seed, tz_rng_stream(STREAM_GAP, (uint64_t)f->made, 0));
    const double turn = m->turn + m->jitter * (2 * tz_rng_unit(&rng) - 1);
    const double gap = o->pose[f->owner[g->sample]].gap;
    int32_t i;
    *came = false;
    tz_status s = tz_fill_outlines_reserve(o, 1);
    if (s == TZ_OK)
        s = tz_fill_add_body(f, entry, g->at, 0, 1, size, turn, &i);
    if (s != TZ_OK)
        return s;
    o->lack[i].turned = 0;
    o->shrunk[i] = 1;
    o->pose[i].gap = gap;
    put_at(o, i, g);
    *came = settle_one(o, i, a, most) <= most;
    if (*came)
        f->inserted++;
    else
        f->body.n = bodies, f->n = n;
    return s;
}

/* Entries in turn, beginning where chance says, until one stays; of an entry of many sizes
 * the largest that the gap may hold. */
static tz_status fill_gap(tz_fill_outlines *o, const tz_fill_gap *g, const int32_t *late,
                          int32_t lates, double most)
{
    tz_fill *f = o->f;
    about a;
    bool came = false;
    tz_status s = TZ_OK;
    find_about(o, g, late, lates, &a);
    tz_rng rng = tz_rng_make(f->seed, tz_rng_stream(STREAM_GAP, (uint64_t)f->made, 1));
    const int32_t from = tz_rng_below(&rng, f->entries);
    for (int32_t k = 0, tried = 0; k < f->entries && tried < TRIES && !came && s == TZ_OK;
         k++) {
        const int32_t entry = (from + k) % f->entries;
        const tz_fill_model *m = &f->model.v[entry];
        const double wide = tz_fill_spread(m, f->rho[g->sample]);
        const double hold = HOLD * g->radius / (m->radius[0] * f->c[g->sample] * wide);
        if (!(m->share > 0) || hold < m->size[0])
            continue;
        tried++;
        s = try_one(o, entry, fmin(hold, m->size[1]), g, &a, most, &came);
    }
    return s;
}

tz_status tz_fill_gap_fill(tz_fill_outlines *o, double room, int32_t *came)
{
    tz_fill *f = o->f;
    tz_fill_gap *gap = NULL;
    int32_t n = 0, *late = NULL;
    double least = HUGE_VAL;
    const int32_t first = f->body.n;
    for (int32_t k = 0; k < f->entries; k++)
        if (f->model.v[k].share > 0)
            least = fmin(least, f->model.v[k].radius[0] * f->model.v[k].size[0]);
    tz_status s = tz_fill_contacts_find(o);
    if (s == TZ_OK)
        s = tz_fill_contacts_measure(o);
    const double most = mean_energy(o);
    if (s == TZ_OK)
        s = tz_fill_gaps(f, least * f->guide.least / HOLD, f->live.n, &gap, &n);
    if (s == TZ_OK)
        s = tz_alloc(f->ctx, &late, (size_t)n + 1, sizeof *late);
    for (int32_t k = 0; k < n && room > 0 && s == TZ_OK; k++) {
        const int32_t lates = f->body.n - first;
        s = fill_gap(o, &gap[k], late, lates, most);
        if (s != TZ_OK || f->body.n == first + lates)
            continue;
        const tz_fill_body *b = &f->body.v[f->body.n - 1];
        const double size = b->size * f->c[b->first] * (1 + f->rho[b->first]);
        late[lates] = f->body.n - 1;
        room -= f->model.v[b->model].area * size * size;
    }
    *came = f->body.n - first;
    f->fresh = false;
    tz_free(f->ctx, late);
    tz_free(f->ctx, gap);
    return s == TZ_OK ? tz_fill_lists(f) : s;
}
