/* SPDX-License-Identifier: Apache-2.0 */
/* The OpenImageIO module: what base/image_oiio_module.h says, and no more. */
#include "base/image_oiio_module.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

using namespace OIIO;

struct tz_oiio_out {
    std::unique_ptr<ImageOutput> file;
    ImageSpec spec;
};

namespace
{

enum { BAD_FILE = 1, UNSUPPORTED = 2, NO_MEMORY = 3, STOPPED = 4 };

/* First line only: messages are one line. */
int fail(int code, const std::string &text, char *why, size_t n)
{
    std::string line = text.substr(0, text.find('\n'));
    std::snprintf(why, n, "%s", line.empty() ? "it cannot be read" : line.c_str());
    return code;
}

template <class F>
int guard(char *why, size_t n, F &&body) noexcept
{
    try {
        return body();
    } catch (const std::bad_alloc &) {
        std::snprintf(why, n, "out of memory");
        return NO_MEMORY;
    } catch (const std::exception &e) {
        std::snprintf(why, n, "%s", e.what());
        return BAD_FILE;
    } catch (...) {
        std::snprintf(why, n, "unknown exception");
        return BAD_FILE;
    }
}

int depth_of(TypeDesc t)
{
    switch (t.basetype) {
    case TypeDesc::UINT8:
    case TypeDesc::INT8: return 8;
    case TypeDesc::HALF: return 17;
    case TypeDesc::FLOAT:
    case TypeDesc::DOUBLE: return 32;
    default: return 16;
    }
}

int read_image(const char *path, const tz_oiio_reader *r, char *why, size_t n)
{
    ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    auto in = ImageInput::open(path, &config);
    if (!in) {
        std::string text = OIIO::geterror();
        bool unknown = text.find("format reader") != std::string::npos || text.empty();
        return fail(BAD_FILE, unknown ? "it is of no known image format" : text, why, n);
    }
    const ImageSpec spec = in->spec();
    if (spec.deep || spec.depth > 1)
        return fail(UNSUPPORTED, "deep and volume images are not images to us", why, n);
    bool is_float = spec.format.is_floating_point();
    std::string space = spec.get_string_attribute("oiio:ColorSpace");
    tz_oiio_head head = {spec.width,
                         spec.height,
                         spec.nchannels,
                         spec.alpha_channel,
                         depth_of(spec.format),
                         space.empty() ? is_float
                                       : space == "Linear" || space == "linear",
                         spec.get_int_attribute("Orientation", 1),
                         is_float};
    float *px = r->begin(r->user, &head);
    if (!px)
        return STOPPED;
    for (int c = 0; c < spec.nchannels; c++)
        r->name(r->user, c, spec.channel_name(c).c_str());
    for (const auto &a : spec.extra_attribs)
        if (a.type() == TypeString)
            r->meta(r->user, a.name().c_str(), a.get_string().c_str());
    auto progress = [](void *user, float) -> bool {
        auto *reader = static_cast<const tz_oiio_reader *>(user);
        return reader->cancelled(reader->user) != 0;
    };
    if (!in->read_image(0, 0, 0, spec.nchannels, TypeFloat, px, AutoStride, AutoStride,
                        AutoStride, progress, const_cast<tz_oiio_reader *>(r))) {
        if (r->cancelled(r->user))
            return STOPPED;
        return fail(BAD_FILE, in->geterror(), why, n);
    }
    return 0;
}

int open_image(const tz_oiio_spec *s, tz_oiio_out **out, char *why, size_t n)
{
    auto o = std::make_unique<tz_oiio_out>();
    o->file = ImageOutput::create(s->format);
    if (!o->file)
        return fail(UNSUPPORTED, OIIO::geterror(), why, n);
    TypeDesc type = s->depth == 8    ? TypeDesc::UINT8
                    : s->depth == 16 ? TypeDesc::UINT16
                    : s->depth == 17 ? TypeDesc::HALF
                                     : TypeDesc::FLOAT;
    o->spec = ImageSpec(s->width, s->height, s->channels, type);
    o->spec.alpha_channel = s->alpha;
    o->spec.channelnames.clear();
    for (int c = 0; c < s->channels; c++)
        o->spec.channelnames.push_back(s->names[c]);
    o->spec.attribute("oiio:UnassociatedAlpha", 1);
    o->spec.attribute("oiio:ColorSpace", s->linear ? "Linear" : "sRGB");
    std::string format = s->format;
    if (format == "tiff") {
        if (s->tile > 0)
            o->spec.tile_width = o->spec.tile_height = s->tile;
        o->spec.attribute("compression", s->compression == 0 ? "none" : "zip");
        /* else it would write the time of day, and no two files were alike */
        o->spec.attribute("DateTime", "1970:01:01 00:00:00");
        o->spec.attribute("tiff:zipquality", s->compression > 0 ? s->compression : 1);
        o->spec.attribute("tiff:bigtiff",
                          int64_t(s->width) * s->height * s->channels * type.size() >
                              int64_t(3) << 30);
    }
    if (format == "webp")
        o->spec.attribute("compression", "webp:" + std::to_string(s->quality));
    /* These formats hold a comment and no free keys: one "key: value" a line. */
    std::string lines;
    for (const char *const *m = s->meta; m && *m; m += 2)
        lines += std::string(lines.empty() ? "" : "\n") + m[0] + ": " + m[1];
    if (!lines.empty())
        o->spec.attribute("ImageDescription", lines);
    if (!o->file->open(s->path, o->spec))
        return fail(BAD_FILE, o->file->geterror(), why, n);
    *out = o.release();
    return 0;
}

int write_rows(tz_oiio_out *o, int32_t y0, int32_t y1, const void *px, char *why,
               size_t n)
{
    const ImageSpec &s = o->spec;
    if (s.tile_width == 0)
        return o->file->write_scanlines(y0, y1, 0, s.format, px)
                   ? 0
                   : fail(BAD_FILE, o->file->geterror(), why, n);
    /* Tile by tile, with zeros beyond the picture: write_tiles leaves whatever its memory
     * held there, and no two files were alike. */
    const size_t pixel = s.pixel_bytes(), side = (size_t)s.tile_width;
    std::vector<char> tile(side * side * pixel);
    for (int y = y0; y < y1; y += s.tile_height)
        for (int x = 0; x < s.width; x += s.tile_width) {
            const int rows = std::min(s.tile_height, y1 - y);
            const size_t part = (size_t)std::min(s.tile_width, s.width - x) * pixel;
            std::fill(tile.begin(), tile.end(), 0);
            for (int i = 0; i < rows; i++)
                std::memcpy(&tile[(size_t)i * side * pixel],
                            (const char *)px +
                                ((size_t)(y - y0 + i) * (size_t)s.width + (size_t)x) *
                                    pixel,
                            part);
            if (!o->file->write_tile(x, y, 0, s.format, tile.data()))
                return fail(BAD_FILE, o->file->geterror(), why, n);
        }
    return 0;
}

int close_image(tz_oiio_out *o, char *why, size_t n)
{
    std::unique_ptr<tz_oiio_out> owner(o);
    return o->file->close() ? 0 : fail(BAD_FILE, o->file->geterror(), why, n);
}

} // namespace

extern "C" {
__attribute__((visibility("default"))) extern const tz_oiio_api tz_oiio_api_1;
const tz_oiio_api tz_oiio_api_1 = {
    [](const char *path, const tz_oiio_reader *r, char *why, size_t n) {
        return guard(why, n, [&] { return read_image(path, r, why, n); });
    },
    [](const tz_oiio_spec *s, tz_oiio_out **out, char *why, size_t n) {
        return guard(why, n, [&] { return open_image(s, out, why, n); });
    },
    [](tz_oiio_out *o, int32_t y0, int32_t y1, const void *px, char *why, size_t n) {
        return guard(why, n, [&] { return write_rows(o, y0, y1, px, why, n); });
    },
    [](tz_oiio_out *o, char *why, size_t n) {
        return guard(why, n, [&] { return close_image(o, why, n); });
    },
};
}
