/* SPDX-License-Identifier: Apache-2.0 */
#include "base/image_sink_internal.h"
static tz_status not_yet(tz_image_sink *sink)
{
    return tz_fail(sink->ctx, TZ_UNSUPPORTED, "%s: %s cannot be written yet", sink->shown,
                   sink->format->name);
}
#define STUB(x, ext, t)                                                                \
    const tz_sink_format tz_sink_##x = {.name = #x, .extensions = ext, .automatic = t, \
                                        .types = 1u << (t), .open = not_yet,           \
                                        .channels = tz_sink_channels_any};
STUB(exr, "exr", TZ_SAMPLE_HALF)
STUB(tiff, "tif|tiff", TZ_SAMPLE_U8)
STUB(jpeg, "jpg|jpeg", TZ_SAMPLE_U8)
STUB(webp, "webp", TZ_SAMPLE_U8)
STUB(hdr, "hdr", TZ_SAMPLE_FLOAT)
