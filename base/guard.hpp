/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The one guard that turns C++ exceptions of foreign libraries into status codes. For the
 * few .cpp files that reach such a library: no algorithm inside, extern "C" outside.
 *
 *   extern "C" tz_status tz_edges_sobel(tz_ctx *ctx, ...)
 *   {
 *       return tz_guard(ctx, "edges", [&]() -> tz_status { cv::Sobel(...); return TZ_OK;
 * });
 *   } */
#ifndef TZ_BASE_GUARD_HPP
#define TZ_BASE_GUARD_HPP

#include <exception>
#include <new>

extern "C" {
#include "base/ctx.h"
}

template <class F>
tz_status tz_guard(tz_ctx *ctx, const char *what, F &&body) noexcept
{
    try {
        return body();
    } catch (const std::bad_alloc &) {
        return tz_fail(ctx, TZ_NOMEM, "%s: out of memory", what);
    } catch (const std::exception &e) {
        return tz_fail(ctx, TZ_INVALID, "%s: %s", what, e.what());
    } catch (...) {
        return tz_fail(ctx, TZ_INVALID, "%s: unknown exception", what);
    }
}

#endif
