/* SPDX-License-Identifier: Apache-2.0 */
/* Discrete elements among the curves: they come as wholes, their samples keep the shape
 * that they have in the exemplar, and in the end each stands where its samples are.
 * @source [Tu20] Sec. 4.3.4, 4.4.1 */
#include "curves/synthesis_internal.h"

#include "elements/bend.h"

enum { MOST = 64 /* samples of an element that shape a pose */ };

/* Samples of the exemplar's graph that belong to an element: a run of them. */
static int32_t first_sample(const tz_curve_model *x, int32_t sample)
{
    const int32_t e = x->g.sample.v[sample].element;
    while (sample > 0 && x->g.sample.v[sample - 1].element == e)
        sample--;
    return sample;
}

static bool is_taken(const tz_curve_solve *t, int32_t sample, tz_vec2 at)
{
    const tz_curve_sample *q = &t->x->g.sample.v[sample];
    const double r = t->job->exemplar->element.element.v[q->element].radius;
    for (int32_t i = t->o.sample.n - 1; i >= 0; i--) {
        const tz_curve_sample *p = &t->o.sample.v[i];
        if (p->element >= 0 && p->q == q->q &&
            tz_vec2_length(tz_curve_vector(t->job->domain, p->at, at)) < r)
            return true;
    }
    return false;
}

tz_status tz_curve_solve_place(tz_curve_solve *t, int32_t sample, tz_vec2 at)
{
    const tz_sample_graph *g = &t->x->g;
    const int32_t e = g->sample.v[sample].element;
    const double frame = tz_curve_solve_frame(t, at);
    if (e < 0 || is_taken(t, sample, at) ||
        !tz_element_may_copy(&t->job->exemplar->element.element.v[e]))
        return TZ_OK;
    tz_status s = tz_array_push(t->ctx, &t->body, e);
    for (int32_t k = first_sample(t->x, sample);
         k < g->sample.n && g->sample.v[k].element == e && s == TZ_OK; k++) {
        const tz_vec2 v =
            tz_curve_vector(&g->domain, g->sample.v[sample].at, g->sample.v[k].at);
        const tz_vec2 p = tz_vec2_add(at, tz_curve_rotate(v, frame));
        s = tz_curve_solve_add(
            t,
            &(tz_curve_sample){.at = tz_curve_wrapped(t->job->domain, p),
                               .q = g->sample.v[k].q,
                               .element = t->body.n - 1,
                               .existence = 1},
            k);
    }
    return s;
}

/* Samples of one element of the output: `n` from `first` on, which lie together. */
static int32_t run_of(const tz_curve_solve *t, int32_t first)
{
    int32_t n = 1;
    while (first + n < t->o.sample.n &&
           t->o.sample.v[first + n].element == t->o.sample.v[first].element)
        n++;
    return n;
}

/* The pose that brings the exemplar's samples onto the output's; its turn is the frame's
 * where one sample has to do. */
static tz_pose pose_of(const tz_curve_solve *t, int32_t first, int32_t n)
{
    const tz_element_set *from = &t->job->exemplar->element;
    const tz_element *e = &from->element.v[t->body.v[t->o.sample.v[first].element]];
    const tz_vec2 origin = t->o.sample.v[first].at;
    tz_vec2 a[MOST], b[MOST];
    n = n < e->samples ? n : e->samples;
    n = n < MOST ? n : MOST;
    for (int32_t k = 0; k < n; k++) {
        const tz_vec3 p = from->sample.v[e->sample + k].at;
        a[k] = (tz_vec2){p.x, p.y};
        b[k] = tz_vec2_add(
            origin, tz_curve_vector(t->job->domain, origin, t->o.sample.v[first + k].at));
    }
    tz_pose pose = tz_pose_fit(n, a, b, NULL, true);
    if (n == 1)
        pose.angle = tz_curve_solve_frame(t, origin);
    pose.scale = fmin(fmax(pose.scale, 0.8), 1.25);
    return pose;
}

tz_status tz_curve_solve_shapes(tz_curve_solve *t)
{
    const tz_element_set *from = &t->job->exemplar->element;
    for (int32_t i = 0; i < t->o.sample.n;) {
        const tz_curve_sample *p = &t->o.sample.v[i];
        const int32_t n = p->element >= 0 ? run_of(t, i) : 1;
        if (p->element >= 0 && !p->fixed && t->body.v[p->element] >= 0) {
            const tz_element *e = &from->element.v[t->body.v[p->element]];
            const tz_pose pose = pose_of(t, i, n);
            for (int32_t k = 0; k < n && k < e->samples; k++) {
                const tz_vec3 q = from->sample.v[e->sample + k].at;
                t->o.sample.v[i + k].at = tz_curve_wrapped(
                    t->job->domain, tz_pose_apply(pose, (tz_vec2){q.x, q.y}));
            }
        }
        i += n;
    }
    return TZ_OK;
}

tz_status tz_curve_solve_elements(tz_curve_solve *t, tz_element_set *to)
{
    const tz_element_set *from = &t->job->exemplar->element;
    tz_element_set out = {0};
    tz_status s = tz_element_set_like(t->ctx, from, t->job->domain, &out);
    for (int32_t i = 0; i < t->o.sample.n && s == TZ_OK;) {
        const tz_curve_sample *p = &t->o.sample.v[i];
        const int32_t n = p->element >= 0 ? run_of(t, i) : 1;
        if (p->element >= 0 && !p->fixed && t->body.v[p->element] >= 0) {
            const int32_t source = t->body.v[p->element];
            const tz_pose pose = pose_of(t, i, n);
            const tz_vec3 q = from->element.v[source].at;
            const tz_vec2 at = tz_pose_apply(pose, (tz_vec2){q.x, q.y});
            const tz_vec3 place = {at.x, at.y, q.z};
            if (tz_domain_contains(t->job->domain, tz_domain_wrap(t->job->domain, place)))
                s = tz_element_set_place(&out, from, source, place, pose.angle,
                                         pose.scale);
        }
        i += n;
    }
    if (s == TZ_OK)
        *to = out;
    else
        tz_element_set_deinit(&out);
    return s;
}
