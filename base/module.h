/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Modules: parts of the library that are opened when first needed. OpenImageIO pulls in
 * 260 shared libraries (0.20 s of start-up, measured), OpenCV's ximgproc 140 (0.07 s);
 * a command that reads a PNG and writes an EXR needs neither and starts in 5 ms.
 *
 * A module is one <folder>/<name>_module.cpp, built by tz_module() in CMakeLists.txt into
 * lib/terrazzo/libterrazzo_<name>.so. It stands alone: it exports extern "C" functions,
 * calls back through pointers, and never calls into libterrazzo. */
#ifndef TZ_BASE_MODULE_H
#define TZ_BASE_MODULE_H

#include "base/alloc.h"

/** Opens module `name` if it is not open yet and looks up a symbol of it. The file is
 * looked for beside libterrazzo (or the program that contains it), then where it was
 * installed. A module stays open until the process ends.
 * @param[out] out  receives the symbol's address (a pointer to a pointer)
 * @return TZ_OK; TZ_UNSUPPORTED, with a message that names the module and the folder */
TZ_API tz_status tz_module_symbol(tz_ctx *ctx, const char *name, const char *symbol,
                                  void *out);

/** Path of a file that Terrazzo ships (a model, presets): beside libterrazzo's folder in
 * share/terrazzo, then where it was installed.
 * @param[out] path  free with tz_free
 * @return TZ_OK; TZ_IO, with a message that names the file and the folder */
TZ_API tz_status tz_module_data(tz_ctx *ctx, const char *name, char **path);

#endif
