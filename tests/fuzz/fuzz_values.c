/* SPDX-License-Identifier: Apache-2.0 */
/* Text values: path data, transforms, numbers, parameters. */
#include <string.h>

#include "base/param.h"
#include "base/svg.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef struct all {
    double range[2];
    uint64_t bytes;
    int32_t size[2];
    tz_rect rect;
} all;

static const tz_param rows[] = {
    {"range", TZ_PARAM_RANGE, offsetof(all, range), -1e9, 1e9, "0", "", NULL, ""},
    {"bytes", TZ_PARAM_BYTES, offsetof(all, bytes), 0, 1e18, "0", "", NULL, ""},
    {"size", TZ_PARAM_SIZE, offsetof(all, size), 0, 1e6, "1x1", "", NULL, ""},
    {"rect", TZ_PARAM_RECT, offsetof(all, rect), -1e6, 1e6, "0,0,1,1", "", NULL, ""},
};
static const tz_param_table table = {"fuzz", "", rows, 4, sizeof(all)};

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char text[4096];
    all values;
    tz_affine m;
    tz_svg_path path;
    tz_numbers numbers = {0};
    if (size < 1 || size >= sizeof text)
        return 0;
    memcpy(text, data + 1, size - 1);
    text[size - 1] = 0;
    switch (data[0] % 4) {
    case 0:
        if (tz_svg_path_parse(NULL, text, &path) == TZ_OK)
            tz_svg_path_deinit(NULL, &path);
        break;
    case 1: tz_svg_transform(NULL, text, &m); break;
    case 2:
        tz_svg_numbers(NULL, text, &numbers);
        tz_array_free(NULL, &numbers);
        break;
    default:
        tz_params_default(&table, &values);
        for (int i = 0; i < table.n; i++)
            tz_params_set(NULL, &table, &values, rows[i].name, text);
    }
    return 0;
}
