/* SPDX-License-Identifier: Apache-2.0 */
/* Formulas of frames, parsed and evaluated. */
#include <string.h>

#include "elements/formula.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char text[5000];
    tz_formula f;
    if (size >= sizeof text)
        return 0;
    memcpy(text, data, size);
    text[size] = 0;
    if (tz_formula_parse(NULL, text, &f) == TZ_OK)
        (void)tz_formula_at(&f, (tz_formula_place){1, 2, 3, 4});
    tz_formula_deinit(NULL, &f);
    return 0;
}
