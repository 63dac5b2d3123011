/* SPDX-License-Identifier: Apache-2.0 */
/* True outlines are kept apart. Discs stand for shapes only nearly: corners reach beyond
 * them, rows of discs of two things interlock, and of two things that lie upon each other
 * neither knows a way out. So true outlines have their say, every now and then between
 * iterations (tz_fill_loosen), and at the end:
 *
 *   1. gaps as wide as the free area allows are asked for, and become even;
 *   2. what is pressed hardest goes to the largest empty places, where it is pressed less;
 *   3. where fewer things lie than were asked for (and the count is free), some come;
 *   4. pulls to the centres of cells close holes, and gaps that are asked for become
 *      narrow, until nothing overlaps;
 *   5. what still does shrinks, to no less than LEAST of its size;
 *   6. what still does goes to an empty place or leaves.
 *
 * Steps 1 and 4 are those of Lubachevsky and Stillinger seen from the other side: things
 * that are too large for the domain push each other to where there is room, then shrink to
 * their sizes.
 * @source Lubachevsky, Stillinger: Geometric properties of random disk packings, 1990 */
#include "fields/fill_outline_internal.h"

enum {
    FIRST = 5,    /* rounds of even gaps */
    MOVES = 2,    /* times that the hardest pressed move */
    AFTER = 5,    /* rounds after each */
    EVEN = 8,     /* rounds of even gaps with pulls */
    LAST = 12,    /* rounds of narrow gaps, each time */
    STRAIGHT = 3, /* times that directions are found anew */
    SHRINKS = 16,
    LOOSE = 6 /* rounds between iterations */
};
#define SHARE   0.05 /* of all, that moves at once */
#define WIDEST  0.4  /* of the mean disc: half a gap, at most */
#define THIN    0.02 /* at least */
#define NARROW  0.3  /* part of the gaps, at the end */
#define TIGHT   0.05 /* part at which shrinking begins */
#define LEAST   0.8
#define FAST    0.97 /* shrinks so much at once */
#define WIDE    2.0  /* part of the gaps with pulls: across holes */
#define PULL    1.0  /* weight of pulls then */
#define HOLD    0.2  /* and as gaps become narrow */
#define SHALLOW 6.0  /* times the slack: what may stay */
#define DEEP    10.0 /* times the slack: nobody may overlap so far in the end */
#define MORE    1.02 /* times the fill that may come */

/* ---- gaps --------------------------------------------------------------------------- */

static double scale_of(const tz_fill *f, int32_t i)
{
    return tz_fill_scale(f, f->body.v[i].first);
}

/* Half a gap that a body's density asks for. */
static double gap_of_density(const tz_fill *f, int32_t i)
{
    const tz_fill_body *b = &f->body.v[i];
    const double r = f->radius[b->first] * scale_of(f, i);
    return fmax(f->wide[b->first] - 1, 0) * r;
}

/* Gaps in proportion to the field's sizes, and by density; together the free area. */
static void ask_gaps(tz_fill_outlines *o)
{
    const tz_fill *f = o->f;
    double free = tz_domain_area(&f->domain), rim = 0;
    for (int32_t i = 0; i < f->body.n; i++) {
        const tz_fill_body *b = &f->body.v[i];
        const double scale = scale_of(f, i), c = b->size * scale;
        if (b->gone)
            continue;
        free -= f->model.v[b->model].area * c * c;
        free -= gap_of_density(f, i) * o->rim[b->model] * c;
        rim += o->rim[b->model] * c * scale;
    }
    const double per = rim > 0 ? free / rim : 0;
    const double by = fmin(fmax(per, THIN * f->unit), WIDEST * f->unit);
    for (int32_t i = 0; i < f->body.n; i++)
        o->pose[i].gap = by * scale_of(f, i) + gap_of_density(f, i);
}

/* Area that may still come, with the room that densities ask for. */
static double room_left(const tz_fill *f)
{
    double room = MORE * f->par.fill * tz_domain_area(&f->domain);
    for (int32_t i = 0; i < f->body.n; i++) {
        const tz_fill_body *b = &f->body.v[i];
        const double c = b->size * scale_of(f, i) * (1 + f->rho[b->first]);
        room -= b->gone ? 0 : f->model.v[b->model].area * c * c;
    }
    return room;
}

/* ---- shrinking, leaving ------------------------------------------------------------- */

static void shrink_body(tz_fill_outlines *o, int32_t i, double by)
{
    tz_fill *f = o->f;
    const tz_fill_body *b = &f->body.v[i];
    const tz_vec2 at = o->pose[i].at;
    for (int32_t k = b->first; k < b->first + b->n; k++) {
        f->c[k] *= by;
        f->at[k].x = at.x + by * (f->at[k].x - at.x);
        f->at[k].y = at.y + by * (f->at[k].y - at.y);
    }
    tz_fill_outline_find(o, i);
    o->moved[i] = true;
}

static tz_status shrink_rest(tz_fill_outlines *o)
{
    tz_fill *f = o->f;
    tz_status s = TZ_OK;
    int32_t left = 1;
    for (int k = 0; k < SHRINKS && s == TZ_OK; k++) {
        s = tz_fill_contacts_relax(o, k == 0 ? LAST : 2, TIGHT, &left);
        if (s == TZ_OK)
            s = tz_fill_contacts_measure(o);
        left = 0;
        for (int32_t j = 0; j < f->live.n && s == TZ_OK; j++) {
            const int32_t i = f->live.v[j];
            if (f->body.v[i].gone || o->lack[i].depth <= SHALLOW * tz_fill_slack(f, i) ||
                o->shrunk[i] <= LEAST)
                continue;
            left++;
            const double was = o->shrunk[i];
            o->shrunk[i] *= FAST;
            f->shrunk += was >= 0.98 && o->shrunk[i] < 0.98;
            shrink_body(o, i, FAST);
        }
        if (left == 0)
            break;
    }
    return s;
}

/* Of those that overlap too far the worst about leaves. */
static tz_status drop_worst(tz_fill_outlines *o, int32_t *dropped)
{
    tz_fill *f = o->f;
    *dropped = 0;
    tz_status s = tz_fill_contacts_find(o);
    if (s == TZ_OK)
        s = tz_fill_contacts_measure(o);
    for (int32_t j = 0; j < f->live.n && s == TZ_OK; j++) {
        const int32_t i = f->live.v[j];
        const double depth = o->lack[i].depth;
        if (depth <= DEEP * tz_fill_slack(f, i))
            continue;
        bool worst = true;
        for (int32_t k = o->start[i]; k < o->start[i + 1] && worst; k++) {
            const int32_t b = o->near[k];
            const double d = o->lack[b].depth;
            worst = f->body.v[b].gone || f->body.v[b].fixed || !f->body.v[b].awake ||
                    d < depth || (d == depth && b > i);
        }
        if (!worst)
            continue;
        s = tz_fill_remove(f, i);
        f->dropped++, ++*dropped;
    }
    return s == TZ_OK ? tz_fill_lists(f) : s;
}

/* ---- all of it ---------------------------------------------------------------------- */

static tz_status move_pressed(tz_fill_outlines *o, int times, double part)
{
    tz_status s = TZ_OK;
    int32_t moved = 1;
    for (int k = 0; k < times && moved > 0 && s == TZ_OK; k++) {
        s = tz_fill_gap_move(o, SHARE, &moved);
        if (s == TZ_OK && moved > 0)
            s = tz_fill_contacts_relax(o, AFTER, part, NULL);
    }
    return s;
}

static tz_status come(tz_fill_outlines *o)
{
    int32_t came = 0;
    const double room = room_left(o->f);
    tz_status s = TZ_OK;
    if (o->f->job.count == 0 && o->f->live.n > 0 && room > 0)
        s = tz_fill_gap_fill(o, room, &came);
    return s == TZ_OK && came > 0 ? tz_fill_contacts_relax(o, AFTER, 1, NULL) : s;
}

/* What has been moved or has come takes its direction from where it lies now, and all
 * others theirs from it. */
static tz_status turn_again(tz_fill_outlines *o)
{
    tz_fill *f = o->f;
    f->fresh = false;
    const tz_status s = tz_fill_turn_again(f);
    for (int32_t k = 0; k < f->live.n; k++) {
        tz_fill_outline_find(o, f->live.v[k]);
        o->lack[f->live.v[k]].turned = 0;
    }
    f->fresh = false;
    return s;
}

/* Contacts have turned things, and what moved has not been told what is said there: from
 * here on directions are the solver's for the places that things have, and contacts only
 * push. What they cannot part so may turn again, and little else is pressed then. */
static tz_status straighten(tz_fill_outlines *o)
{
    tz_status s = TZ_OK;
    for (int k = o->f->local ? STRAIGHT - 1 : 0; k < STRAIGHT && s == TZ_OK; k++) {
        const bool last = k == STRAIGHT - 1; /* only what overlaps is pushed, if any */
        s = turn_again(o);
        o->straight = true;
        if (s == TZ_OK)
            s = tz_fill_contacts_relax(o, last ? LAST : AFTER, last ? TIGHT : NARROW,
                                       NULL);
    }
    o->straight = false;
    return s;
}

static tz_status narrow(tz_fill_outlines *o)
{
    int32_t dropped = 0;
    o->even = PULL;
    tz_status s = tz_fill_contacts_relax(o, EVEN, WIDE, NULL);
    o->even = HOLD;
    if (s == TZ_OK)
        s = tz_fill_contacts_relax(o, LAST / 2, 0.5 + 0.5 * NARROW, NULL);
    if (s == TZ_OK)
        s = tz_fill_contacts_relax(o, LAST / 2, NARROW, NULL);
    o->even = 0;
    if (s == TZ_OK)
        s = tz_fill_contacts_relax(o, LAST / 2, NARROW, NULL);
    if (s == TZ_OK)
        s = move_pressed(o, 1, NARROW);
    if (s == TZ_OK)
        s = straighten(o);
    if (s == TZ_OK)
        s = shrink_rest(o);
    if (s == TZ_OK)
        s = drop_worst(o, &dropped);
    return s == TZ_OK && dropped > 0 ? tz_fill_contacts_relax(o, LAST, NARROW, NULL) : s;
}

tz_status tz_fill_repair(tz_fill *f)
{
    tz_fill_outlines o = {.f = f};
    tz_status s = tz_fill_lists(f);
    if (s == TZ_OK && f->live.n == 0)
        return TZ_OK;
    if (s == TZ_OK) {
        tz_fill_release(f);
        s = tz_fill_outlines_init(f, &o);
    }
    if (s == TZ_OK) {
        ask_gaps(&o);
        s = tz_fill_contacts_relax(&o, f->local ? AFTER : FIRST, 1, NULL);
    }
    if (s == TZ_OK)
        s = move_pressed(&o, f->local ? 1 : MOVES, 1);
    if (s == TZ_OK)
        s = come(&o);
    if (s == TZ_OK)
        s = turn_again(&o);
    if (s == TZ_OK)
        s = tz_fill_contacts_relax(&o, AFTER, 1, NULL);
    if (s == TZ_OK)
        s = narrow(&o);
    f->fresh = false;
    tz_fill_outlines_deinit(&o);
    return s;
}

tz_status tz_fill_loosen(tz_fill *f)
{
    tz_fill_outlines o = {.f = f};
    int32_t moved;
    tz_status s = tz_fill_lists(f);
    if (s == TZ_OK)
        s = tz_fill_outlines_init(f, &o);
    if (s == TZ_OK) {
        ask_gaps(&o);
        s = tz_fill_contacts_relax(&o, LOOSE, 1, NULL);
    }
    if (s == TZ_OK)
        s = tz_fill_gap_move(&o, SHARE, &moved);
    f->fresh = false;
    tz_fill_outlines_deinit(&o);
    return s;
}
