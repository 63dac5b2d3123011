/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * SVG documents in and out. Reading goes through libxml2 with entities and network switched
 * off, and with limits of our own on nodes, depth and text. Writing is streamed text. */
#ifndef TZ_BASE_SVG_H
#define TZ_BASE_SVG_H

#include "base/array.h"
#include "base/file.h"
#include "base/geom.h"
#include "base/number.h" /* tz_number_format */

#define TZ_SVG_NS      "http://www.w3.org/2000/svg"
#define TZ_XLINK_NS    "http://www.w3.org/1999/xlink"
#define TZ_INKSCAPE_NS "http://www.inkscape.org/namespaces/inkscape"
/** Namespace of our own attributes, written as tz:name. */
#define TZ_NS          "https://terrazzo.example/ns/1"

/* ---- reading -------------------------------------------------------------------- */

typedef struct tz_svg_doc tz_svg_doc;
typedef const void *tz_svg_node; /**< NULL = none */

/** Parses a file ("-" = standard input).
 * @return TZ_OK; TZ_IO; TZ_FORMAT with the line number (not XML, root is not svg, entity
 *   declarations); TZ_LIMIT (over 1 GiB, 5 million nodes, 256 levels); TZ_NOMEM */
TZ_API tz_status tz_svg_read(tz_ctx *ctx, const char *path, tz_svg_doc **out);
TZ_API tz_status tz_svg_parse(tz_ctx *ctx, const char *name, const char *text,
                              size_t size, tz_svg_doc **out);
TZ_API void tz_svg_free(tz_svg_doc *doc); /**< takes NULL */
TZ_API tz_svg_node tz_svg_root(const tz_svg_doc *doc);
TZ_API tz_svg_node tz_svg_child(tz_svg_node n);         /**< first element child */
TZ_API tz_svg_node tz_svg_next(tz_svg_node n);          /**< next element sibling */
TZ_API bool tz_svg_is(tz_svg_node n, const char *name); /**< SVG-namespace local name */
TZ_API int32_t tz_svg_line(tz_svg_node n);
/** Attribute value, or NULL. Names: "width", "xlink:href" (also finds plain href),
 * "tz:group", "inkscape:label". Valid while the document is. */
TZ_API const char *tz_svg_attr(tz_svg_node n, const char *name);
/** Text content of a node (e.g. metadata), or "". Valid while the document is. */
TZ_API const char *tz_svg_text(tz_svg_doc *doc, tz_svg_node n);
/** Element by id attribute, or NULL. */
TZ_API tz_svg_node tz_svg_by_id(const tz_svg_doc *doc, const char *id);

/** Numbers separated by blanks or commas; rejects NaN, infinity and rest text.
 * @return TZ_OK; TZ_INVALID; TZ_LIMIT; the array is appended to */
typedef TZ_ARRAY(double)
tz_numbers;
TZ_API tz_status tz_svg_numbers(tz_ctx *ctx, const char *text, tz_numbers *out);
/** One finite number with an optional px unit; false if there is none. */
TZ_API bool tz_svg_number(const char *text, double *out);
/** transform attribute: any list of matrix, translate, scale, rotate, skewX, skewY;
 * NULL text gives the identity. */
TZ_API tz_status tz_svg_transform(tz_ctx *ctx, const char *text, tz_affine *out);

/** Path data as absolute cubic or straight segments. */
typedef enum tz_path_verb {
    TZ_PATH_MOVE,
    TZ_PATH_LINE,
    TZ_PATH_CUBIC,
    TZ_PATH_CLOSE
} tz_path_verb;
typedef struct tz_svg_path {
    TZ_ARRAY(uint8_t)
    verb; /**< tz_path_verb */
    TZ_ARRAY(tz_vec2)
    point; /**< MOVE, LINE: 1; CUBIC: 3; CLOSE: 0 */
} tz_svg_path;
/** All commands of SVG 1.1 (arcs and quadratics become cubics).
 * @return TZ_OK; TZ_FORMAT with the offset of the fault; TZ_NOMEM */
TZ_API tz_status tz_svg_path_parse(tz_ctx *ctx, const char *d, tz_svg_path *out);
TZ_API void tz_svg_path_deinit(tz_ctx *ctx, tz_svg_path *p);

/* ---- writing -------------------------------------------------------------------- */

/** Streaming writer on a tz_file_out. The first failure sticks and is returned by close.
 */
typedef struct tz_svg_writer {
    tz_file_out out;
    TZ_ARRAY(const char *)
    open; /* names of open elements */
    bool in_tag;
    tz_status status;
} tz_svg_writer;

/** Opens the file and writes the <svg> root with viewBox "0 0 width height" and the svg,
 * xlink and tz namespaces. */
TZ_API tz_status tz_svg_writer_open(tz_ctx *ctx, const char *path, double width,
                                    double height, tz_svg_writer *w);
/** The same for a drawing whose unit is so long on paper, mm; 0 = none is known. */
TZ_API tz_status tz_svg_writer_open_mm(tz_ctx *ctx, const char *path, double width,
                                       double height, double unit_mm, tz_svg_writer *w);
/** The same in memory: `w` must stay where it is. @param name  stands for it in messages */
TZ_API tz_status tz_svg_writer_open_text(tz_ctx *ctx, const char *name, double width,
                                         double height, tz_svg_writer *w);
TZ_API void tz_svg_begin(tz_svg_writer *w, const char *name); /**< name must be static */
TZ_API void tz_svg_set(tz_svg_writer *w, const char *attr,
                       const char *value); /**< escapes */
TZ_API void tz_svg_setf(tz_svg_writer *w, const char *attr, const char *fmt, ...)
    TZ_PRINTF(3, 4);
/** Shortest text that reads back to the same double. */
TZ_API void tz_svg_set_number(tz_svg_writer *w, const char *attr, double value);
TZ_API void tz_svg_set_numbers(tz_svg_writer *w, const char *attr, const double *v,
                               int32_t n);
TZ_API void tz_svg_set_affine(tz_svg_writer *w, const char *attr, tz_affine m);
TZ_API void tz_svg_put_text(tz_svg_writer *w, const char *text); /**< escapes */
TZ_API void tz_svg_end(tz_svg_writer *w);
/** Ends all open elements, commits the file; returns the first failure. */
TZ_API tz_status tz_svg_writer_close(tz_svg_writer *w);
/** The same for a document in memory. @param[out] text  caller frees with tz_free; without
 * the XML declaration, so that it can stand within another document */
TZ_API tz_status tz_svg_writer_close_text(tz_svg_writer *w, char **text);
TZ_API void tz_svg_writer_abort(tz_svg_writer *w);

#endif
