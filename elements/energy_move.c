/* SPDX-License-Identifier: Apache-2.0 */
/* What the least squares of energy_assign.c do to elements: where each goes with its
 * samples, what shape it keeps, which attributes its neighbours elect.
 * @source [Ma11] Sec. 3.1 (shape from samples), Eq. (5), Sec. 5 (constrained selection) */
#include "elements/bend.h"
#include "elements/energy_internal.h"

enum { FEW = 64 /* samples of an element that are posed without help of the heap */ };

/* Samples of what an element copies, or NULL. */
static const tz_sample *model_of(const tz_energy_state *t, const tz_element *e)
{
    const tz_element_set *from = t->x->set;
    if (e->source < 0 || e->source >= from->element.n)
        return NULL;
    const tz_element *m = &from->element.v[e->source];
    return m->samples == e->samples && m->kind == e->kind && m->symbol == e->symbol
               ? &from->sample.v[m->sample]
               : NULL;
}

/* Samples back to the pose of their model, `size` as large, that fits them best. Without a model, or with
 * very many samples, the element stays as it is. */
static void keep_shape(tz_energy_state *t, tz_element *e, double size)
{
    const tz_sample *model = model_of(t, e);
    tz_sample *p = &t->set->sample.v[e->sample];
    tz_vec2 from[FEW], to[FEW];
    double weight[FEW];
    if (t->shape == TZ_SHAPE_BEND || e->samples > FEW || !model)
        return;
    const tz_element *m = &t->x->set->element.v[e->source];
    for (int32_t k = 0; k < e->samples; k++) {
        from[k] = (tz_vec2){m->at.x + size * (model[k].at.x - m->at.x),
                            m->at.y + size * (model[k].at.y - m->at.y)};
        to[k] = (tz_vec2){p[k].at.x, p[k].at.y};
        weight[k] = p[k].weight;
    }
    tz_pose pose =
        tz_pose_fit(e->samples, from, to, weight, t->shape == TZ_SHAPE_SIMILARITY);
    pose.scale = fmin(fmax(pose.scale, 0.5), 2);
    const tz_vec2 at = tz_pose_apply(pose, (tz_vec2){m->at.x, m->at.y});
    e->at = (tz_vec3){at.x, at.y, e->at.z};
    e->angle = m->angle + pose.angle;
    e->scale = m->scale * pose.scale * size;
    e->radius = m->radius * pose.scale * size;
    for (int32_t k = 0; k < e->samples; k++) {
        const tz_vec2 q = tz_pose_apply(pose, from[k]);
        p[k].at.x = q.x, p[k].at.y = q.y;
    }
}

/* Where an element may go that wants to go to `to`: inside, and not out of a zone that is
 * for its kind into one that is not. */
static tz_vec3 allowed(const tz_energy_state *t, const tz_element *e, tz_vec3 from,
                       tz_vec3 to)
{
    const tz_domain *d = &t->set->domain;
    tz_vec3 best = to;
    if (d->zones && !tz_domain_allows(d, to, e->kind) &&
        tz_domain_allows(d, from, e->kind)) {
        double share = 0;
        for (double step = 0.5; step > 0.01; step /= 2) { /* as far as it may */
            const double s = share + step;
            const tz_vec3 at = {from.x + s * (to.x - from.x),
                                from.y + s * (to.y - from.y), to.z};
            share = tz_domain_allows(d, at, e->kind) ? s : share;
        }
        best.x = from.x + share * (to.x - from.x);
        best.y = from.y + share * (to.y - from.y);
    }
    for (int k = 0; k < 4 && d->region; k++) { /* a little inside, to be sure */
        const tz_vec2 back = tz_energy_back(d, best);
        const double l = tz_vec2_length(back);
        if (!(l > 0))
            break;
        const double more = 1 + 1e-3 * t->x->spacing / l;
        best.x += more * back.x, best.y += more * back.y;
    }
    return best;
}

/* Rigid motion that brings the old samples nearest to the new ones: the weighted centre
 * moves along, the angle is that of the sum of products as complex numbers. */
void tz_energy_move(tz_energy_state *t, tz_element *e, const tz_vec2 *move)
{
    tz_sample *p = &t->set->sample.v[e->sample];
    tz_vec2 old = {0, 0}, shift = {0, 0};
    double total = 0, cosine = 0, sine = 0;
    for (int32_t k = 0; k < e->samples; k++) {
        const tz_vec2 u = move[t->place[e->sample + k]];
        old.x += p[k].weight * p[k].at.x, old.y += p[k].weight * p[k].at.y;
        shift.x += p[k].weight * u.x, shift.y += p[k].weight * u.y;
        total += p[k].weight;
    }
    old = tz_vec2_scale(old, 1 / total), shift = tz_vec2_scale(shift, 1 / total);
    for (int32_t k = 0; k < e->samples; k++) {
        const tz_vec2 u = move[t->place[e->sample + k]];
        const double x = p[k].at.x - old.x, y = p[k].at.y - old.y;
        const double nx = x + u.x - shift.x, ny = y + u.y - shift.y;
        cosine += p[k].weight * (x * nx + y * ny);
        sine += p[k].weight * (x * ny - y * nx);
        p[k].at.x += u.x, p[k].at.y += u.y;
    }
    const double turn = e->samples > 1 ? atan2(sine, cosine) : 0;
    const double x = e->at.x - old.x, y = e->at.y - old.y;
    const tz_vec3 before = e->at;
    e->angle += turn;
    e->at.x = old.x + shift.x + cos(turn) * x - sin(turn) * y;
    e->at.y = old.y + shift.y + sin(turn) * x + cos(turn) * y;
    if (e->samples > 1)
        keep_shape(t, e, tz_domain_scale(&t->set->domain, before));
    const tz_vec3 to = e->at;
    e->at = tz_domain_wrap(&t->set->domain, allowed(t, e, before, to));
    /* as large as things are where it has come to */
    const double by = tz_domain_scale(&t->set->domain, e->at) /
                      tz_domain_scale(&t->set->domain, before);
    e->scale *= by, e->radius *= by;
    for (int32_t k = 0; k < e->samples && by != 1; k++) {
        p[k].at.x = to.x + by * (p[k].at.x - to.x);
        p[k].at.y = to.y + by * (p[k].at.y - to.y);
    }
    for (int32_t k = 0; k < e->samples; k++) { /* samples stay beside their element */
        p[k].at.x += e->at.x - to.x, p[k].at.y += e->at.y - to.y;
        t->at[t->place[e->sample + k]] = p[k].at;
    }
}

static double far_from(const tz_energy_exemplar *x, int32_t e, tz_vec2 mean)
{
    const double da = (double)x->a[e] - mean.x, db = (double)x->b[e] - mean.y;
    return da * da + db * db;
}

/* The vote of least summed squared distance to all votes is the one nearest to their
 * mean. Parts of things that the exemplar's border has cut do not stand for election; an
 * element as good as the winner stays what it is. */
void tz_energy_elect(tz_energy_state *t, tz_element *e)
{
    const tz_energy_exemplar *x = t->x;
    const int32_t o = t->place[e->sample];
    const int32_t begin = t->vote_first[o], end = t->vote_first[o + 1];
    if (t->match[o] < 0)
        return;
    tz_vec2 mean = {(double)x->a[t->match[o]], (double)x->b[t->match[o]]};
    for (int32_t v = begin; v < end; v++)
        mean.x += (double)x->a[t->vote.v[v]], mean.y += (double)x->b[t->vote.v[v]];
    mean = tz_vec2_scale(mean, 1.0 / (end - begin + 1));
    const double frame = tz_energy_frame(t, e->at);
    const double size = tz_domain_scale(&t->set->domain, e->at);
    const tz_vec2 q = tz_vec2_scale(tz_energy_attribute(x, e, frame), 1 / size);
    const double now = (q.x - mean.x) * (q.x - mean.x) + (q.y - mean.y) * (q.y - mean.y);
    double least = INFINITY;
    int32_t winner = -1;
    for (int32_t v = begin - 1; v < end; v++) {
        const int32_t vote = v < begin ? t->match[o] : t->vote.v[v];
        const double d = far_from(x, vote, mean);
        if (d < least && tz_element_may_copy(&x->set->element.v[x->owner[vote]]))
            least = d, winner = vote;
    }
    if (winner < 0 || fabs(now - least) <= 1e-9 * x->spacing * x->spacing)
        return;
    const tz_element *from = &x->set->element.v[x->owner[winner]];
    e->source = x->owner[winner];
    e->symbol = from->symbol;
    e->angle = from->angle + frame;
    e->scale = from->scale * size;
    e->radius = from->radius * size;
}
