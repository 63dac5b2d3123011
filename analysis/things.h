/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Things of a photo: pebbles, setts, stones, leaves, tiles. Photo to elements, each cut
 * out along its outline, and to the plate: the photo with the things taken out.
 * @source Arbelaez et al., Contour detection and hierarchical image segmentation, PAMI
 *   2011; Salembier, Garrido, Binary partition tree, TIP 2000; Barnes et al., PatchMatch,
 *   SIGGRAPH 2009 */
#ifndef TZ_ANALYSIS_THINGS_H
#define TZ_ANALYSIS_THINGS_H

#include "base/image.h"
#include "base/param.h"
#include "elements/element.h"

typedef enum tz_things_detail {
    TZ_THINGS_AUTO,
    TZ_THINGS_NORMAL,
    TZ_THINGS_DOUBLE
} tz_things_detail;

typedef enum tz_things_beneath {
    TZ_THINGS_PLATE_AUTO,
    TZ_THINGS_PLATE_GROUND,
    TZ_THINGS_PLATE_PHOTO
} tz_things_beneath;

/** Table: tz_things_param_table. */
typedef struct tz_things_params {
    double size_range[2]; /**< px, diameter of a circle of a thing's area, least and
                               largest; 0 = automatic */
    int32_t classes;      /**< wanted number of kinds, 0 = automatic */
    double smoothing; /**< of outlines: deviation of the Gaussian, in px or in 4.5 % of
                               the middle diameter of the things, what is more */
    double certainty; /**< 0..1: what is less surely a thing is ground */
    int32_t detail;   /**< tz_things_detail: at which size of the photo to look; auto =
                               the best of half, normal and, up to 0.6 Mpx, double */
    int32_t plate; /**< tz_things_beneath: ground = with the things taken out; photo = as
                         it is, for piles, where gaps show more of the same; auto = the photo
                         where little sure ground is seen between things that cover
                         each other or merge into it */
    char model
        [TZ_PARAM_STRING_SIZE]; /**< structured-forest model file, "" = Terrazzo's own;
                                     has no row: commands share that of tz_ebpt_params */
} tz_things_params;
TZ_API extern const tz_param_table tz_things_param_table;

/** Finds the things of a photo.
 *
 * The set: the domain is plain, one unit a px, as large as the photo. Every thing has a
 * symbol of its own ("thing-1", ...) with photo 0, photo_scale 1, markup "" and photo_at =
 * the element's place; its outline is what is seen of the thing, to 1/4 px, holes as
 * further polygons (even-odd), none of which shows a pixel of another thing. Elements
 * stand by rising depth; scale is 1, and angle 0, since the photo shows each thing as it
 * lies: how a long thing is turned is read from its samples, which follow its axis from
 * the left end to the right one (one sample: no axis that matters; so in kinds that are
 * not `oriented`). `cut` is set where the photo's border cuts; `doubtful` on things that
 * others cover (over a tenth or so of them) and on those that are ragged, of the ground's
 * colour, crumbs, or not surely things; at least 12 things, or a third of them, the best,
 * are not doubtful. A thing that another one covers in part keeps its visible outline, but `at` and `radius` are those of the
 * whole, completed by an ellipse, where the hidden part is estimated to be under a third.
 * set.photo[0] has the size and an empty path: see tz_things_name_photo.
 *
 * @param photo        1 to 4 channels, any encoding but data
 * @param[out] out     overwritten, not freed; zeroed on error; no elements where there
 *                     are no things
 * @param[out] plate   NULL, or overwritten: 3 channels (1 of a grey photo), the photo's
 *                     size and encoding; empty on error
 * @param[out] label   NULL, or width * height: index of the element that is seen there,
 *                     -1 = ground; unspecified on error
 * @return TZ_OK; TZ_INVALID; TZ_NOMEM; TZ_CANCELLED; what the model reader returns
 * @cost O(pixels), four times as much at double size; memory about 220 bytes a px */
TZ_API tz_status tz_things_find(tz_ctx *ctx, const tz_image *photo,
                                const tz_things_params *params, tz_element_set *out,
                                tz_image *plate, int32_t *label);

/** What a photo is made of. */
typedef struct tz_things_verdict {
    bool is_things; /**< an element texture suits it */
    int32_t things; /**< found */
    int32_t copied; /**< of them, those that may be copied */
    double covered; /**< 0..1: share of the picture that things cover */
    double sure;    /**< 0..1: mean certainty of what the border does not cut */
    double solid;   /**< 0..1: mean share of its convex hull that a copied thing fills */
    double spread; /**< of the copied things' area, octaves: 1.48 median distance from the
                          median */
    double distinct; /**< 0..1: share of the things' area that is unlike the ground */
    char why[128];   /**< "132 things cover 71 % of the picture and are alike in size" */
} tz_things_verdict;

/** As tz_things_find, and judges whether the photo is made of things.
 * @param[out] verdict  zeroed on error */
TZ_API tz_status tz_things_judge(tz_ctx *ctx, const tz_image *photo,
                                 const tz_things_params *params, tz_element_set *out,
                                 tz_image *plate, int32_t *label,
                                 tz_things_verdict *verdict);

/** Says where photo 0 of a set is kept; needed before the set is written as SVG.
 * @param path    as this program opens it
 * @param sha256  of the file, NULL = unknown
 * @param plate   as this program opens it, NULL = none
 * @return TZ_OK; TZ_INVALID (the set has no photo); TZ_NOMEM (nothing is changed) */
TZ_API tz_status tz_things_name_photo(tz_element_set *s, const char *path,
                                      const char *sha256, const char *plate);

#endif
