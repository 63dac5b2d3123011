/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Visibility of public symbols; everything else stays hidden. */
#ifndef TZ_BASE_EXPORT_H
#define TZ_BASE_EXPORT_H

#if defined(TZ_STATIC)
#define TZ_API
#else
#define TZ_API __attribute__((visibility("default")))
#endif

#if defined(__GNUC__)
#define TZ_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#else
#define TZ_PRINTF(fmt, args)
#endif

#endif
