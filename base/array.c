/* SPDX-License-Identifier: Apache-2.0 */
#include "base/array.h"

#include <string.h>

tz_status tz_array_grow(tz_ctx *ctx, void *v, int32_t *cap, int64_t count, size_t size)
{
    if (count <= *cap)
        return TZ_OK;
    if (count > INT32_MAX)
        return tz_fail(ctx, TZ_LIMIT, "array of %lld items is over the limit of %d",
                       (long long)count, INT32_MAX);
    int64_t room = *cap + (int64_t)*cap / 2 + 8;
    if (room < count)
        room = count;
    if (room > INT32_MAX)
        room = INT32_MAX;
    tz_status s = tz_realloc(ctx, v, (size_t)room, size);
    if (s == TZ_OK)
        *cap = (int32_t)room;
    return s;
}
