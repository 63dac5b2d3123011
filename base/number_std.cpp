/* SPDX-License-Identifier: Apache-2.0 */
/* C has no conversion that is free of the locale; C++17's charconv is, and is exact,
 * shortest and several times faster than strtod and printf. */
extern "C" {
#include "base/number.h"
}

#include <charconv>
#include <cstdlib>
#include <cstring>

extern "C" bool tz_number_parse(const char *text, const char **end, double *out)
{
    const char *p = text + (*text == '+' || *text == '-');
    bool digit = *p >= '0' && *p <= '9';
    if (!digit && !(*p == '.' && p[1] >= '0' && p[1] <= '9'))
        return false;
    /* The characters that can belong to it; a zero ends the text. No double needs more than
     * 1,100 of them, and a look at all that follows would make long lists cost their
     * length squared. */
    size_t n = 0;
    while (n < 1100 && p[n] && std::strchr("0123456789.eE+-", p[n]))
        n++;
    double v = 0;
    auto r = std::from_chars(p, p + n, v);
    *end = r.ptr;
    if (r.ec == std::errc::result_out_of_range) {
        /* overflow or underflow, which from_chars does not tell apart */
        v = std::strtod(p, nullptr);
        if (v > 1)
            return false;
    } else if (r.ec != std::errc()) {
        return false;
    }
    *out = *text == '-' ? -v : v;
    return true;
}

extern "C" void tz_number_format(double v, char *text)
{
    auto r = std::to_chars(text, text + 31, v);
    *r.ptr = 0;
}
