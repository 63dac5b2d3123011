/* SPDX-License-Identifier: Apache-2.0 */
/* The vector module: what synthesis/element_vector_module.h says, all by librsvg. */
#include "synthesis/element_vector_module.h"

#include <librsvg/rsvg.h>

#include <cstdio>
#include <cstring>
#include <new>

namespace
{

struct document {
    RsvgHandle *handle;
    RsvgRectangle view;
};

/* First line only: messages are one line. */
int fail(int code, const char *text, char *why, size_t n)
{
    std::snprintf(why, n, "%.*s", (int)std::strcspn(text, "\n"), text);
    return code;
}

int fail(GError *error, char *why, size_t n)
{
    const int code = fail(1, error ? error->message : "unknown error", why, n);
    g_clear_error(&error);
    return code;
}

int fail(cairo_status_t status, char *why, size_t n)
{
    return fail(status == CAIRO_STATUS_NO_MEMORY ? 2 : 1, cairo_status_to_string(status),
                why, n);
}

int open(const char *svg, size_t size, double reach, void **out, char *why, size_t n)
{
    GError *error = nullptr;
    /* without a base file librsvg reads no other files */
    RsvgHandle *handle =
        rsvg_handle_new_from_data(reinterpret_cast<const guint8 *>(svg), size, &error);
    if (!handle)
        return fail(error, why, n);
    auto *doc =
        new (std::nothrow) document{handle, {-reach, -reach, 2 * reach, 2 * reach}};
    if (!doc) {
        g_object_unref(handle);
        return fail(2, "out of memory", why, n);
    }
    *out = doc;
    return 0;
}

void close(void *p)
{
    auto *doc = static_cast<document *>(p);
    if (doc)
        g_object_unref(doc->handle);
    delete doc;
}

int extents(void *p, double box[4], char *why, size_t n)
{
    auto *doc = static_cast<document *>(p);
    GError *error = nullptr;
    RsvgRectangle ink = {0, 0, 0, 0}, logical;
    if (!rsvg_handle_get_geometry_for_layer(doc->handle, nullptr, &doc->view, &ink,
                                            &logical, &error))
        return fail(error, why, n);
    box[0] = ink.x;
    box[1] = ink.y;
    box[2] = ink.x + ink.width;
    box[3] = ink.y + ink.height;
    if (!(ink.width > 0) && !(ink.height > 0))
        box[0] = 1, box[2] = 0;
    return 0;
}

int draw(void *p, const double m[6], const tz_vector_block *block, char *why, size_t n)
{
    auto *doc = static_cast<document *>(p);
    GError *error = nullptr;
    int code = 0;
    cairo_surface_t *surface = cairo_image_surface_create_for_data(
        reinterpret_cast<unsigned char *>(block->px), CAIRO_FORMAT_ARGB32, block->width,
        block->height, 4 * block->width);
    cairo_t *cr = cairo_create(surface);
    const cairo_matrix_t map = {m[0], m[1], m[2], m[3], m[4], m[5]};
    cairo_set_matrix(cr, &map);
    if (!rsvg_handle_render_document(doc->handle, cr, &doc->view, &error))
        code = fail(error, why, n);
    else if (cairo_status(cr) != CAIRO_STATUS_SUCCESS)
        code = fail(cairo_status(cr), why, n);
    cairo_destroy(cr);
    cairo_surface_flush(surface);
    cairo_surface_destroy(surface);
    return code;
}

} // namespace

extern "C" {
__attribute__((visibility("default"))) extern const tz_vector_api tz_vector_api_1;
const tz_vector_api tz_vector_api_1 = {open, close, extents, draw};
}
