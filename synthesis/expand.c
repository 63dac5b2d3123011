/* SPDX-License-Identifier: Apache-2.0 */
/* Pipeline. Reading decodes and hashes a photo at the same time; rendering goes straight
 * into the sink, whole where the picture takes a small share of the memory budget, else
 * in strips. */
#include "synthesis/expand.h"

#include <string.h>
#include <strings.h>
#include <time.h>

#include "base/file.h"
#include "synthesis/recipe.h"

double tz_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- files of an output ----------------------------------------------------------- */

#define AT(m) offsetof(tz_format_params, m)
static const tz_param format_rows[] = {
    {"format", TZ_PARAM_ENUM, AT(format), 0, 0, "auto", "",
     "auto|png|jpeg|tiff|webp|hdr|exr",
     "File format of images; auto = from the name. Standard output needs it."},
    {"depth", TZ_PARAM_ENUM, AT(depth), 0, 0, "auto", "", "auto|8|16|half|float",
     "Numbers in the file: 8 or 16 bit, half or float; auto = 8 bit, 16 where the photo "
     "has "
     "16, half for exr, float for hdr and for float maps."},
    {"compression", TZ_PARAM_INT, AT(compression), -1, 9, "-1", "", NULL,
     "0 = none .. 9 = smallest and slowest; -1 = fast (PNG level 1, all processors)."},
    {"quality", TZ_PARAM_INT, AT(quality), 0, 100, "0", "", NULL,
     "Quality of jpeg and webp, 1 to 100; 0 = 95."},
    {"file-tile", TZ_PARAM_INT, AT(tile), 0, 4096, "256", "px", NULL,
     "Side of the tiles in exr and tiff files."},
};
#undef AT
const tz_param_table tz_format_param_table = {
    "format", "How images are written.", format_rows,
    sizeof format_rows / sizeof format_rows[0], sizeof(tz_format_params)};

static const struct {
    const char *extension;
    tz_format format;
} extension_list[] = {
    {"png", TZ_FORMAT_PNG},  {"jpg", TZ_FORMAT_JPEG},  {"jpeg", TZ_FORMAT_JPEG},
    {"tif", TZ_FORMAT_TIFF}, {"tiff", TZ_FORMAT_TIFF}, {"webp", TZ_FORMAT_WEBP},
    {"hdr", TZ_FORMAT_HDR},  {"exr", TZ_FORMAT_EXR},
};
static const char *const format_name[] = {NULL,   "png", "jpg", "tif",
                                          "webp", "hdr", "exr"};

/* Last extension of a path without the dot, or "". */
static const char *extension(const char *path)
{
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    return dot && dot > (slash ? slash + 1 : path) ? dot + 1 : "";
}

tz_format tz_format_of(const char *path)
{
    for (size_t i = 0; i < sizeof extension_list / sizeof extension_list[0]; i++)
        if (strcasecmp(extension_list[i].extension, extension(path)) == 0)
            return extension_list[i].format;
    return TZ_FORMAT_AUTO;
}

tz_status tz_format_settle(tz_ctx *ctx, const char *path, const tz_format_params *p,
                           const tz_image *like, tz_image_write_options *out)
{
    bool piped = strcmp(path, "-") == 0;
    tz_format named = piped ? TZ_FORMAT_AUTO : tz_format_of(path), f = p->format;
    const char *formats = "png, jpg, tif, webp, hdr and exr";
    if (f == TZ_FORMAT_AUTO && piped)
        return tz_fail(ctx, TZ_INVALID,
                       "standard output has no name to tell the format by; "
                       "say it with --format: %s",
                       formats);
    if (f == TZ_FORMAT_AUTO && named == TZ_FORMAT_AUTO && *extension(path))
        return tz_fail(ctx, TZ_INVALID,
                       "%s: images cannot be written as '.%s'; there are %s", path,
                       extension(path), formats);
    if (f == TZ_FORMAT_AUTO && named == TZ_FORMAT_AUTO)
        return tz_fail(ctx, TZ_INVALID,
                       "%s: no extension to tell the format by; name one "
                       "(%s) or give --format",
                       path, formats);
    if (f != TZ_FORMAT_AUTO && named != TZ_FORMAT_AUTO && f != named)
        return tz_fail(ctx, TZ_INVALID,
                       "%s: the name says %s but the format is to be %s; "
                       "make them agree",
                       path, format_name[named], format_name[f]);
    if (f == TZ_FORMAT_AUTO)
        f = named;
    *out = (tz_image_write_options){.type = (tz_sample_type)p->depth,
                                    .compression = p->compression,
                                    .quality = p->quality,
                                    .tile = p->tile,
                                    .format = format_name[f]};
    if (out->type == TZ_SAMPLE_AUTO && like) {
        if (like->depth >= 16 && (f == TZ_FORMAT_PNG || f == TZ_FORMAT_TIFF))
            out->type = like->depth == 32 && f == TZ_FORMAT_TIFF ? TZ_SAMPLE_FLOAT
                                                                 : TZ_SAMPLE_U16;
        else if (like->depth == 32 && like->encoding == TZ_ENCODING_DATA &&
                 f == TZ_FORMAT_EXR)
            out->type = TZ_SAMPLE_FLOAT;
    }
    return TZ_OK;
}

/* ---- exemplars -------------------------------------------------------------------- */

void tz_source_deinit(tz_source *s)
{
    tz_image_deinit(&s->photo);
    tz_ebpt_deinit(&s->ebpt);
    tz_free(s->ctx, s->path);
    *s = (tz_source){0};
}

/* Two tasks at once: 0 decodes, 1 hashes. */
static tz_status read_task(tz_ctx *ctx, void *arg, int64_t i, int worker)
{
    (void)worker;
    tz_source *s = arg;
    if (i == 1)
        return strcmp(s->path, "-") == 0 ? TZ_OK
                                         : tz_file_sha256(ctx, s->path, s->sha256);
    const tz_image_read_options opt = {.want = TZ_ENCODING_SRGB};
    return tz_image_read(ctx, s->path, &opt, &s->photo);
}

static bool all_transparent(const tz_image *im)
{
    if (im->alpha < 0)
        return false;
    for (int32_t y = 0; y < im->height; y++)
        for (int32_t x = 0; x < im->width; x++)
            if (tz_image_at(im, x, y)[im->alpha] > 0)
                return false;
    return true;
}

static tz_status check_photo(tz_ctx *ctx, const char *path, const tz_image *im)
{
    if (im->channels > 4)
        return tz_fail(ctx, TZ_INVALID,
                       "%s: has %d channels; a photo has 1 to 4 (grey or "
                       "colour, with or without alpha); give the others as --maps",
                       path, im->channels);
    if (all_transparent(im))
        return tz_fail(ctx, TZ_INVALID,
                       "%s: every pixel is fully transparent; give a photo "
                       "with something to see",
                       path);
    if (im->width < 16 || im->height < 16)
        tz_warn(ctx,
                "%s: %d x %d pixels hold next to no structure; the result will be plain",
                path, im->width, im->height);
    return TZ_OK;
}

tz_status tz_source_read(tz_ctx *ctx, const char *path, tz_source *s)
{
    tz_source t = {.ctx = ctx};
    tz_status st = tz_strdup(ctx, path, &t.path);
    if (st == TZ_OK)
        st = tz_parallel_for(ctx, 2, read_task, &t);
    if (st == TZ_OK)
        st = check_photo(ctx, path, &t.photo);
    if (st == TZ_OK)
        *s = t;
    else
        tz_source_deinit(&t);
    return st;
}

tz_status tz_source_read_exemplar(tz_ctx *ctx, const char *path, tz_source *s)
{
    tz_ebpt e = {0};
    tz_source t = {0};
    char *photo = NULL, sha256[65] = "";
    tz_status st = tz_ebpt_read(ctx, path, &e, &photo, sha256);
    if (st == TZ_OK)
        st = tz_source_read(ctx, photo, &t);
    if (st != TZ_OK)
        goto done;
    if (t.photo.width != e.width || t.photo.height != e.height) {
        st = tz_fail(ctx, TZ_INVALID,
                     "%s: its photo %s is now %d x %d, was %d x %d; analyze "
                     "it again",
                     path, photo, t.photo.width, t.photo.height, e.width, e.height);
        goto done;
    }
    if (sha256[0] && t.sha256[0] && strcmp(sha256, t.sha256) != 0)
        tz_warn(ctx,
                "%s: its photo %s has changed since; analyze it again if the things in "
                "it have moved",
                path, photo);
done:
    tz_free(ctx, photo);
    if (st == TZ_OK) {
        t.ebpt = e;
        *s = t;
    } else {
        tz_ebpt_deinit(&e);
        tz_source_deinit(&t);
    }
    return st;
}

tz_status tz_source_analyze(tz_ctx *ctx, const tz_ebpt_params *params, tz_source *s)
{
    tz_status st = tz_ebpt_analyze(ctx, &s->photo, params, &s->ebpt);
    if (st == TZ_OK && s->ebpt.edge.n == 0)
        tz_warn(ctx, "%s: no edges in it; regions alone carry the texture", s->path);
    return st;
}

/* Copies `im` into one of `channels` channels: 1 -> 3 repeats grey, absent alpha is 1. */
static tz_status widen(tz_ctx *ctx, tz_image *im, int32_t channels)
{
    tz_image out = {0};
    tz_status s = tz_image_init(ctx, &out, im->width, im->height, channels);
    if (s != TZ_OK)
        return s;
    int32_t colours = im->channels - (im->alpha >= 0);
    int32_t wanted = channels - (out.alpha >= 0);
    for (int32_t y = 0; y < im->height; y++)
        for (int32_t x = 0; x < im->width; x++) {
            const float *p = tz_image_at(im, x, y);
            float *q = tz_image_at(&out, x, y);
            for (int32_t c = 0; c < wanted; c++)
                q[c] = p[colours == 1 ? 0 : c];
            if (out.alpha >= 0)
                q[out.alpha] = im->alpha >= 0 ? p[im->alpha] : 1;
        }
    out.encoding = im->encoding;
    out.depth = im->depth;
    for (int32_t i = 0; s == TZ_OK && i < im->meta.n; i++)
        s = tz_image_set_meta(&out, im->meta.v[i].key, im->meta.v[i].value);
    if (s != TZ_OK) {
        tz_image_deinit(&out);
        return s;
    }
    tz_image_deinit(im);
    *im = out;
    return TZ_OK;
}

tz_status tz_images_match(tz_ctx *ctx, tz_image *const *images, int32_t n)
{
    int32_t colours = 1;
    bool alpha = false, same = true;
    for (int32_t i = 0; i < n; i++) {
        int32_t own = images[i]->channels - (images[i]->alpha >= 0);
        colours = own > colours ? own : colours;
        alpha = alpha || images[i]->alpha >= 0;
        same = same && images[i]->channels == images[0]->channels &&
               images[i]->alpha == images[0]->alpha;
    }
    for (int32_t i = 0; !same && i < n; i++)
        if (images[i]->channels != colours + alpha) {
            tz_status s = widen(ctx, images[i], colours + alpha);
            if (s != TZ_OK)
                return s;
        }
    return TZ_OK;
}

/* ---- layout and pixels ------------------------------------------------------------ */

tz_status tz_expand_arrange(tz_ctx *ctx, const tz_source *sources, int32_t n,
                            const char *rules, const tz_arrange_params *params,
                            tz_layout *l)
{
    tz_rules r = {0};
    tz_exemplar *e = NULL;
    tz_status s = tz_alloc(ctx, &e, (size_t)n, sizeof *e);
    if (s == TZ_OK && rules && *rules)
        s = tz_rules_read(ctx, rules, &r);
    if (s != TZ_OK)
        goto done;
    for (int32_t i = 0; i < n; i++)
        e[i] = (tz_exemplar){&sources[i].photo, &sources[i].ebpt, sources[i].path,
                             sources[i].sha256};
    s = tz_arrange(ctx, e, n, rules && *rules ? &r : NULL, params, l);
done:
    tz_rules_deinit(&r);
    tz_free(ctx, e);
    return s;
}

/* 1 x 1 image that carries what the sink wants to know, the photo's metadata and the
 * recipe. */
static tz_status make_like(tz_ctx *ctx, const tz_image *im, const char *recipe,
                           tz_image *out)
{
    tz_image like = {0};
    tz_status s = tz_image_init(ctx, &like, 1, 1, im->channels);
    if (s != TZ_OK)
        return s;
    like.alpha = im->alpha;
    like.encoding = im->encoding;
    like.depth = im->depth;
    if (im->names && like.names)
        memcpy(like.names, im->names, (size_t)im->channels * sizeof *im->names);
    for (int32_t i = 0; s == TZ_OK && i < im->meta.n; i++)
        s = tz_image_set_meta(&like, im->meta.v[i].key, im->meta.v[i].value);
    if (s == TZ_OK && recipe)
        s = tz_image_set_meta(&like, TZ_RECIPE_KEY, recipe);
    if (s == TZ_OK)
        *out = like;
    else
        tz_image_deinit(&like);
    return s;
}

tz_status tz_crop_settle(tz_ctx *ctx, const int32_t size[2],
                         const tz_compose_params *params, tz_rect *out)
{
    tz_rect c = params->crop;
    if (c.w == 0 && c.h == 0)
        c = (tz_rect){0, 0, size[0], size[1]};
    if (c.w < 1 || c.h < 1 || c.x < 0 || c.y < 0 || c.w > size[0] - c.x ||
        c.h > size[1] - c.y)
        return tz_fail(
            ctx, TZ_INVALID,
            "--crop %d,%d,%d,%d: does not lie within the layout of %d x %d pixels", c.x,
            c.y, c.w, c.h, size[0], size[1]);
    *out = c;
    return TZ_OK;
}

/** Strips of about 16 MiB. */
static tz_status stream_strips(tz_ctx *ctx, const tz_pixels_job *job, tz_image_sink *sink)
{
    const tz_rect r = job->rect;
    const int64_t row = (int64_t)r.w * job->like->channels * (int64_t)sizeof(float);
    const int64_t rows = ((16 << 20) / row + 255) / 256 * 256;
    tz_image strip = {0};
    tz_status s = TZ_OK;
    for (int64_t y = 0; y < r.h && s == TZ_OK; y += rows) {
        const int32_t h = (int32_t)(r.h - y < rows ? r.h - y : rows);
        if (strip.height != h) {
            tz_image_deinit(&strip);
            s = tz_image_init(ctx, &strip, r.w, h, job->like->channels);
            strip.alpha = job->like->alpha;
            strip.encoding = job->like->encoding;
        }
        if (s == TZ_OK)
            s = job->render(ctx, job->user, (tz_rect){r.x, r.y + (int32_t)y, r.w, h},
                            &strip);
        if (s == TZ_OK)
            s = tz_image_sink_rows(sink, &strip);
    }
    tz_image_deinit(&strip);
    return s;
}

tz_status tz_pixels_write(tz_ctx *ctx, const tz_pixels_job *job,
                          tz_render_figures *figures)
{
    tz_image like = {0}, whole = {0};
    tz_image_sink *sink = NULL;
    tz_image_write_options opt;
    const tz_rect r = job->rect;
    double start = tz_seconds(), rendered = start;
    tz_status s = make_like(ctx, job->like, job->recipe, &like);
    if (s != TZ_OK)
        return s;
    if ((s = tz_format_settle(ctx, job->path, job->format, &like, &opt)) != TZ_OK ||
        (s = tz_image_sink_open(ctx, job->path, r.w, r.h, &like, &opt, &sink)) != TZ_OK)
        goto done;
    /* A sixteenth of the budget, at most 256 MiB: the sink needs room too. */
    uint64_t bytes =
        (uint64_t)r.w * (uint64_t)r.h * (uint64_t)like.channels * sizeof(float);
    uint64_t budget = tz_ctx_memory(ctx) ? tz_ctx_memory(ctx) / 16 : 1 << 28;
    if (bytes <= budget && bytes <= 1 << 28) {
        s = tz_image_init(ctx, &whole, r.w, r.h, like.channels);
        whole.alpha = like.alpha;
        whole.encoding = like.encoding;
        if (s == TZ_OK)
            s = job->render(ctx, job->user, r, &whole);
        rendered = tz_seconds();
        if (s == TZ_OK)
            s = tz_image_sink_rows(sink, &whole);
    } else {
        s = job->stream ? job->stream(ctx, job->user, r, sink)
                        : stream_strips(ctx, job, sink);
        rendered = tz_seconds();
    }
    if (s == TZ_OK) {
        s = tz_image_sink_close(sink);
        sink = NULL;
    }
    if (s == TZ_OK && figures)
        *figures =
            (tz_render_figures){r.w, r.h, rendered - start, tz_seconds() - rendered};
done:
    tz_image_sink_abort(sink);
    tz_image_deinit(&whole);
    tz_image_deinit(&like);
    return s;
}

static tz_status render_composer(tz_ctx *ctx, void *c, tz_rect r, tz_image *out)
{
    return tz_composer_render(ctx, c, r, out);
}

static tz_status stream_composer(tz_ctx *ctx, void *c, tz_rect r, tz_image_sink *sink)
{
    return tz_composer_stream(ctx, c, r, sink);
}

tz_status tz_expand_render(tz_ctx *ctx, const tz_render_job *job,
                           tz_render_figures *figures)
{
    tz_composer *c = NULL;
    tz_image_write_options opt;
    const double start = tz_seconds();
    const int32_t size[2] = {job->layout->width, job->layout->height};
    tz_pixels_job pixels = {.render = render_composer,
                            .stream = stream_composer,
                            .like = &job->images[0],
                            .path = job->path,
                            .format = job->format,
                            .recipe = job->recipe};
    tz_status s = tz_crop_settle(ctx, size, job->params, &pixels.rect);
    if (s == TZ_OK) /* a wrong name shows before the work */
        s = tz_format_settle(ctx, job->path, job->format, &job->images[0], &opt);
    if (s == TZ_OK)
        s = tz_composer_new(ctx, job->layout, job->images, job->n, job->kind, job->params,
                            &c);
    const double prepared = tz_seconds() - start;
    pixels.user = c;
    if (s == TZ_OK)
        s = tz_pixels_write(ctx, &pixels, figures);
    if (s == TZ_OK && figures)
        figures->render += prepared;
    tz_composer_free(c);
    return s;
}
