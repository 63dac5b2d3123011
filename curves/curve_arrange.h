/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Arranges the curves (and elements) of an exemplar over a domain: quilted from its pieces,
 * optimised sample by sample, or both; the result that is most like the exemplar is taken,
 * and finished.
 * @source [Tu20] Sec. 4; curves/quilt.h, curves/synthesis.h, curves/reconstruct.h,
 *   curves/finish.h, curves/curve_compare.h */
#ifndef TZ_CURVES_CURVE_ARRANGE_H
#define TZ_CURVES_CURVE_ARRANGE_H

#include "curves/curve_compare.h"
#include "curves/quilt.h"
#include "curves/synthesis.h"

typedef enum tz_curve_method {
    TZ_CURVES_AUTO,  /**< quilted, and optimised from that; the more alike of the two */
    TZ_CURVES_QUILT, /**< quilted only */
    TZ_CURVES_OPTIMISE, /**< as published: optimised from params.synthesis.start */
} tz_curve_method;

/** Table: tz_curve_arrange_param_table; it also has the rows of quilt and synthesis, under
 * names that begin with "curve-" as all of them do. */
typedef struct tz_curve_arrange_params {
    int32_t method; /**< tz_curve_method */
    bool detail; /**< optimised lines take the shape of the exemplar's lines that they are
                         matched with; else they run smoothly through their samples */
    bool finish; /**< gaps are closed and stubs removed */
    tz_curve_quilt_params quilt;
    tz_curve_synthesis_params synthesis;
} tz_curve_arrange_params;
TZ_API extern const tz_param_table tz_curve_arrange_param_table;

typedef struct tz_curve_arrange_job {
    const tz_curve_set *exemplar;
    const char *name; /**< of it, in messages; NULL = "exemplar" */
    const tz_domain *domain;
    const tz_curve_set *given; /**< NULL, or what is drawn there already and stays; it is
                                        not part of the result */
    const tz_region *given_region;         /**< as in tz_curve_quilt_job */
    const tz_curve_arrange_params *params; /**< NULL = defaults */
    uint64_t seed;
    bool unmeasured; /**< likeness is measured only where it decides */
    void (*trace)(void *user, const tz_curve_energy *e, const tz_sample_graph *g);
    void *user;
} tz_curve_arrange_job;

typedef struct tz_curve_arrange_report {
    double quilt, solve, finish, compare; /**< s */
    int32_t patches;                      /**< quilted; 0 = none */
    int32_t crossings, joined; /**< ends at seams, and those that met another */
    int32_t samples;           /**< of the finest level; 0 = not optimised */
    bool optimised;            /**< which of the two was taken */
    double mean; /**< its mean ratio (tz_curve_likeness); NAN = not measured */
} tz_curve_arrange_report;

/** @param[out] out  overwritten, not freed; zeroed on error; with origins where lines took
 *   the exemplar's shape; its domain is job->domain
 * @param[out] report  NULL, or what was done
 * @return TZ_OK; TZ_INVALID (an exemplar or a domain that nothing can be made of);
 *   TZ_LIMIT; TZ_NOMEM; TZ_CANCELLED
 * @cost linear in the length of what is made */
TZ_API tz_status tz_curve_arrange(tz_ctx *ctx, const tz_curve_arrange_job *job,
                                  tz_curve_set *out, tz_curve_arrange_report *report);

/** How like the exemplar a layout is, on a part of it that is at most a few exemplars
 * large; with `given` counted in where that is not NULL.
 * @return as tz_curve_compare */
TZ_API tz_status tz_curve_arrange_judge(tz_ctx *ctx, const tz_curve_set *exemplar,
                                        const tz_curve_set *layout,
                                        const tz_curve_set *given,
                                        tz_curve_likeness *out);

#endif
