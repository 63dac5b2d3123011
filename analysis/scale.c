/* SPDX-License-Identifier: Apache-2.0 */
#include "analysis/scale.h"

#include <math.h>

tz_status tz_scale_find(const tz_tensor *t, const tz_edge_map *m, const tz_ebpt_params *p,
                        double *scale)
{
    const double w = t->level[0].width, h = t->level[0].height;
    (void)m;
    *scale = p->groups > 0 ? sqrt(w * h / p->groups / 0.7) : fmax(w, h) / 12;
    *scale = fmax(*scale, 12);
    return TZ_OK;
}

void tz_scale_weights(double scale, double weight[])
{
    const double centre = log2(fmax(scale / 12 / TZ_TENSOR_SIGMA, 1));
    for (int32_t k = 0; k < TZ_TENSOR_LEVELS; k++) {
        const double d = k - centre;
        weight[k] = exp(-0.5 * d * d);
    }
}

double tz_scale_full(const float *response, int64_t n)
{
    int64_t count[1024] = {0}, below = 0;
    float top = 0;
    for (int64_t i = 0; i < n; i++) top = response[i] > top ? response[i] : top;
    if (!(top > 0)) return 0;
    for (int64_t i = 0; i < n; i++) count[(int32_t)(response[i] / top * 1023)]++;
    for (int32_t k = 0; k < 1024; k++) {
        below += count[k];
        if (below >= n - n / 10) return (k + 1) * (double)top / 1023;
    }
    return top;
}
