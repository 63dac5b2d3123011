/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The last pass over synthesised curves: gaps are closed and stubs taken away, as far as
 * the exemplar has none of them; junctions fall into one point; what runs on is one path.
 * @source [Tu20] Sec. 5.1 names dangling and broken ends as a limit of the method */
#ifndef TZ_CURVES_FINISH_H
#define TZ_CURVES_FINISH_H

#include "curves/curve.h"

typedef struct tz_curve_finish_report {
    int32_t
        closed; /**< gaps: ends drawn to another end, or on to a line that they point at */
    int32_t removed; /**< stubs, crumbs and doubled lines */
    int32_t
        ends[2]; /**< dangling ends before and after, apart from those at the border */
} tz_curve_finish_report;

/** Brings dangling ends to the number per length that the exemplar has (ends at the
 * domain's border are none), the worst first: an end within reach of another end or of a
 * line ahead of it is joined to it by a piece that keeps both tangents, a stub as short as
 * the exemplar's shortest free branches goes; each only as far as the exemplar has fewer of
 * that kind. Where it has hardly any ends, those that are left are paired over longer ways
 * by smooth curves, also by turns; a line in between then changes sides with the curve, so
 * that nothing crosses; at last lines that end go, up to 2 % of all length. Fixed things (the paths of `given`) are
 * not moved. Lines that merely crossed merely cross again, in the pieces that they had.
 * @param exemplar  what tells which ends are right
 * @param given     NULL, or paths which must stay as they are
 * @param[in,out] s  domain may be a torus or have a region; origins and tapers are kept;
 *   unchanged on error
 * @param[out] report  NULL, or what was done
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED; TZ_LIMIT
 * @cost O(n log n) */
TZ_API tz_status tz_curve_finish(tz_ctx *ctx, const tz_curve_set *exemplar,
                                 const tz_curve_set *given, tz_curve_set *s,
                                 tz_curve_finish_report *report);

/** What an exemplar tells of ends, branches, gaps and turns, where several sets are finished
 * after it. */
typedef struct tz_curve_finish_measure tz_curve_finish_measure;

/** @param[out] out  free with tz_curve_finish_measure_free; NULL on error
 * @return TZ_OK; TZ_NOMEM; TZ_CANCELLED; TZ_LIMIT */
TZ_API tz_status tz_curve_finish_measure_new(tz_ctx *ctx, const tz_curve_set *exemplar,
                                             tz_curve_finish_measure **out);
TZ_API void tz_curve_finish_measure_free(tz_curve_finish_measure *m); /**< takes NULL */
/** Pieces of the exemplar, cut where they cross: what finishing has to do with. */
TZ_API int32_t tz_curve_finish_measure_pieces(const tz_curve_finish_measure *m);
/** As tz_curve_finish. */
TZ_API tz_status tz_curve_finish_like(tz_ctx *ctx, const tz_curve_finish_measure *m,
                                      const tz_curve_set *given, tz_curve_set *s,
                                      tz_curve_finish_report *report);

#endif
