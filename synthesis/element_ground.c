/* SPDX-License-Identifier: Apache-2.0 */
#include "synthesis/element_ground.h"

#include <string.h>

#include "synthesis/arrange.h"

tz_status tz_element_ground_arrange(tz_ctx *ctx, const tz_image *plate, const char *path,
                                    const char *sha256, const tz_ebpt_params *params,
                                    const tz_domain *domain, uint64_t seed,
                                    tz_layout *ground)
{
    tz_ebpt ebpt = {0};
    tz_arrange_params p;
    tz_params_default(&tz_arrange_param_table, &p);
    if (!(domain->size.x <= TZ_IMAGE_MAX_SIDE && domain->size.y <= TZ_IMAGE_MAX_SIDE))
        return tz_fail(ctx, TZ_INVALID,
                       "%s: a layout of %g x %g is too large; its sides may have %d px",
                       path, domain->size.x, domain->size.y, TZ_IMAGE_MAX_SIDE);
    p.size[0] = (int32_t)fmax(1, ceil(domain->size.x));
    p.size[1] = (int32_t)fmax(1, ceil(domain->size.y));
    p.seed = seed;
    p.tile = domain->torus;
    tz_status s = tz_ebpt_analyze(ctx, plate, params, &ebpt);
    if (s == TZ_OK) {
        const tz_exemplar e = {plate, &ebpt, path, sha256};
        s = tz_arrange(ctx, &e, 1, NULL, &p, ground);
    }
    tz_ebpt_deinit(&ebpt);
    return s;
}

tz_status tz_element_ground_embed(tz_ctx *ctx, const char *document,
                                  const tz_layout *ground, tz_element_set *set)
{
    char *text = NULL;
    tz_status s = tz_layout_text(ctx, document, ground, &text);
    if (s != TZ_OK)
        return s;
    tz_free(ctx, set->background);
    set->background = text;
    return TZ_OK;
}

bool tz_element_ground_is(const tz_element_set *set)
{
    const char *root = set->background ? strstr(set->background, "<svg") : NULL;
    const char *end = root ? strchr(root, '>') : NULL;
    const char *mark = root ? strstr(root, "tz:document=\"layout\"") : NULL;
    return mark && end && mark < end;
}

tz_status tz_element_ground_read(tz_ctx *ctx, const char *document,
                                 const tz_element_set *set, tz_layout *ground)
{
    if (!tz_element_ground_is(set))
        return TZ_OK;
    const char *text = strstr(set->background, "<svg");
    return tz_layout_parse(ctx, document, text, strlen(text), ground);
}
