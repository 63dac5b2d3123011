/* SPDX-License-Identifier: Apache-2.0 */
#include "base/status.h"

const char *tz_status_text(tz_status s)
{
    static const char *const text[] = {
#define TZ_STATUS_TEXT(name, text) text,
        TZ_STATUS_LIST(TZ_STATUS_TEXT)
#undef TZ_STATUS_TEXT
    };
    return (unsigned)s < TZ_STATUS_COUNT ? text[s] : "unknown";
}
