/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * References from a document to files. In memory a path is one that the program can open;
 * in the document it is relative to the document's folder, so that a folder with both can
 * be moved. */
#ifndef TZ_BASE_HREF_H
#define TZ_BASE_HREF_H

#include "base/alloc.h"

/** Reference from a document to a file: relative to the document's folder,
 * percent-encoded.
 * @param doc   path of the document, "-" = standard output: relative to the working
 *              folder
 * @param path  as a program would open it
 * @param[out] out  caller frees with tz_free */
TZ_API tz_status tz_href_make(tz_ctx *ctx, const char *doc, const char *path, char **out);
/** The reverse: absolute path of the local file that `href` in `doc` means.
 * @param line  of the reference, for the message
 * @return TZ_OK; TZ_FORMAT (remote, embedded or empty reference); TZ_LIMIT; TZ_NOMEM */
TZ_API tz_status tz_href_open(tz_ctx *ctx, const char *doc, int32_t line,
                              const char *href, char **out);
/** The same, relative to the working folder where the file lies in it or below. */
TZ_API tz_status tz_href_open_here(tz_ctx *ctx, const char *doc, int32_t line,
                                   const char *href, char **out);

#endif
