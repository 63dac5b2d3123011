/* SPDX-License-Identifier: Apache-2.0 */
/* The vector module: what synthesis/element_vector_module.h says, all by librsvg. */
#include "synthesis/element_vector_module.h"

#include <librsvg/rsvg.h>

#include <charconv>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>

namespace
{

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

int open(const char *svg, size_t size, void **out, char *why, size_t n)
{
    GError *error = nullptr;
    /* without a base file librsvg reads no other files */
    RsvgHandle *handle =
        rsvg_handle_new_from_data(reinterpret_cast<const guint8 *>(svg), size, &error);
    if (!handle)
        return fail(error, why, n);
    *out = handle;
    return 0;
}

void close(void *doc)
{
    if (doc)
        g_object_unref(doc);
}

int extents(void *doc, double reach, double box[4], char *why, size_t n)
{
    GError *error = nullptr;
    const RsvgRectangle view = {0, 0, 2 * reach, 2 * reach};
    RsvgRectangle ink = {0, 0, 0, 0}, logical;
    if (!rsvg_handle_get_geometry_for_layer(static_cast<RsvgHandle *>(doc), nullptr,
                                            &view, &ink, &logical, &error))
        return fail(error, why, n);
    box[0] = ink.x;
    box[1] = ink.y;
    box[2] = ink.x + ink.width;
    box[3] = ink.y + ink.height;
    if (!(ink.width > 0) && !(ink.height > 0))
        box[0] = 1, box[2] = 0;
    return 0;
}

/* The map is set by a style sheet, inside the document: librsvg makes the surfaces of
 * groups with opacity, masks and filters as large as its view and as it lies, which must
 * therefore be the block itself. */
int set_map(RsvgHandle *handle, const double m[6], char *why, size_t n)
{
    GError *error = nullptr;
    std::string css = "#" TZ_VECTOR_GROUP "{transform:matrix(";
    for (int k = 0; k < 6; k++) {
        char text[64];
        const auto end = std::to_chars(text, text + sizeof text, m[k]); /* no locale */
        css.append(text, end.ptr).append(k < 5 ? "," : ")}");
    }
    if (!rsvg_handle_set_stylesheet(handle, reinterpret_cast<const guint8 *>(css.data()),
                                    css.size(), &error))
        return fail(error, why, n);
    return 0;
}

int draw(void *doc, const double m[6], const tz_vector_block *block, char *why, size_t n)
{
    auto *handle = static_cast<RsvgHandle *>(doc);
    GError *error = nullptr;
    const RsvgRectangle view = {0, 0, (double)block->width, (double)block->height};
    int code = set_map(handle, m, why, n);
    if (code != 0)
        return code;
    cairo_surface_t *surface = cairo_image_surface_create_for_data(
        reinterpret_cast<unsigned char *>(block->px), CAIRO_FORMAT_ARGB32, block->width,
        block->height, 4 * block->width);
    cairo_t *cr = cairo_create(surface);
    if (!rsvg_handle_render_document(handle, cr, &view, &error))
        code = fail(error, why, n);
    else if (cairo_status(cr) != CAIRO_STATUS_SUCCESS)
        code = fail(cairo_status(cr), why, n);
    cairo_destroy(cr);
    cairo_surface_flush(surface);
    cairo_surface_destroy(surface);
    return code;
}

template <class F>
int guard(char *why, size_t n, F &&body) noexcept
{
    try {
        return body();
    } catch (const std::exception &) {
        return fail(2, "out of memory", why, n);
    }
}

} // namespace

extern "C" {
__attribute__((visibility("default"))) extern const tz_vector_api tz_vector_api_1;
const tz_vector_api tz_vector_api_1 = {
    open,
    close,
    extents,
    [](void *doc, const double m[6], const tz_vector_block *block, char *why, size_t n) {
        return guard(why, n, [&] { return draw(doc, m, block, why, n); });
    },
};
}
