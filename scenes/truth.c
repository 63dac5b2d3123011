/* SPDX-License-Identifier: Apache-2.0 */
/* Truth of a scene.
 *
 *   canvas segments -> majority of 2 x 2 -> specks go to their neighbours -> pieces
 *   pixels whose right or lower neighbour is another piece   \
 *   lines of the canvas                                       } -> gaps of one pixel
 *   joints where they are narrower than 4 px, filled         /     closed -> thinned
 *
 * A joint of changing width is one segment to the generator; here its narrow parts turn
 * into the single curve that an observer would draw. */
#include "scenes/stage.h"

#include <assert.h>
#include <string.h>

enum { SPECK = 15 }; /* px: smaller parts of a piece are no truth worth learning */

static void majority(const tz_canvas *c, int32_t width, int32_t height, int32_t *segment)
{
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++) {
            const int32_t *q = c->segment + (int64_t)2 * y * c->width + 2 * x;
            const int32_t v[4] = {q[0], q[1], q[c->width], q[c->width + 1]};
            int32_t best = v[0], most = 0;
            for (int32_t k = 0; k < 4; k++) {
                int32_t votes = 0;
                for (int32_t i = 0; i < 4; i++)
                    votes += v[i] == v[k];
                if (votes > most)
                    most = votes, best = v[k];
            }
            segment[(int64_t)y * width + x] = best;
        }
}

/* ---- specks ------------------------------------------------------------------------ */

typedef struct plane {
    int32_t *v, width, height;
} plane;

/* Neighbours of pixel p that lie inside; returns how many. */
static int32_t around(const plane *m, int64_t p, int64_t next[4])
{
    const int32_t x = (int32_t)(p % m->width), y = (int32_t)(p / m->width);
    int32_t n = 0;
    if (x > 0)
        next[n++] = p - 1;
    if (y > 0)
        next[n++] = p - m->width;
    if (x + 1 < m->width)
        next[n++] = p + 1;
    if (y + 1 < m->height)
        next[n++] = p + m->width;
    return n;
}

/* The part that holds p if it is a speck: its pixels, else 0. */
static int32_t speck_at(const plane *m, int64_t p, int64_t part[SPECK])
{
    int32_t n = 1;
    part[0] = p;
    for (int32_t i = 0; i < n; i++) {
        int64_t next[4];
        const int32_t count = around(m, part[i], next);
        for (int32_t k = 0; k < count; k++) {
            bool known = m->v[next[k]] != m->v[p];
            for (int32_t j = 0; j < n && !known; j++)
                known = part[j] == next[k];
            if (known)
                continue;
            if (n == SPECK)
                return 0;
            part[n++] = next[k];
        }
    }
    return n;
}

/* The piece that touches a speck at most sides. */
static int32_t host(const plane *m, const int64_t *part, int32_t n)
{
    int32_t side[4 * SPECK], sides = 0, best = m->v[part[0]], most = 0;
    for (int32_t i = 0; i < n; i++) {
        int64_t next[4];
        const int32_t count = around(m, part[i], next);
        for (int32_t k = 0; k < count; k++)
            if (m->v[next[k]] != m->v[part[0]])
                side[sides++] = m->v[next[k]];
    }
    for (int32_t i = 0; i < sides; i++) {
        int32_t votes = 0;
        for (int32_t k = 0; k < sides; k++)
            votes += side[k] == side[i];
        if (votes > most)
            most = votes, best = side[i];
    }
    return best;
}

/* Only pixels at a corner of their part start a search: every speck has one. */
static void absorb_specks(plane *m)
{
    const int64_t n = (int64_t)m->width * m->height;
    for (int64_t p = 0; p < n; p++) {
        int64_t part[SPECK];
        const bool left = p % m->width > 0 && m->v[p - 1] == m->v[p];
        const bool above = p >= m->width && m->v[p - m->width] == m->v[p];
        if (left || above)
            continue;
        const int32_t size = speck_at(m, p, part);
        if (size == 0)
            continue;
        const int32_t to = host(m, part, size);
        for (int32_t i = 0; i < size; i++)
            m->v[part[i]] = to;
    }
}

/* ---- pieces ------------------------------------------------------------------------ */

static void grow_box(tz_rect *b, int32_t x, int32_t y)
{
    if (tz_rect_empty(*b)) {
        *b = (tz_rect){x, y, 1, 1};
        return;
    }
    const int32_t right = b->x + b->w, bottom = b->y + b->h;
    b->x = x < b->x ? x : b->x;
    b->y = y < b->y ? y : b->y;
    b->w = (x + 1 > right ? x + 1 : right) - b->x;
    b->h = (y + 1 > bottom ? y + 1 : bottom) - b->y;
}

/* Numbers the visible pieces from 0 in order of appearance, and measures them. */
static tz_status count_pieces(const tz_canvas *c, plane *m, tz_scene *scene)
{
    int32_t *name = NULL, n = 0;
    tz_status s = tz_alloc(c->ctx, &name, (size_t)c->piece.n, sizeof *name);
    if (s == TZ_OK)
        s = tz_alloc_zero(c->ctx, &scene->piece, (size_t)c->piece.n,
                          sizeof *scene->piece);
    if (s != TZ_OK) {
        tz_free(c->ctx, name);
        return s;
    }
    memset(name, -1, (size_t)c->piece.n * sizeof *name);
    for (int32_t y = 0; y < m->height; y++)
        for (int32_t x = 0; x < m->width; x++) {
            int32_t *id = &m->v[(int64_t)y * m->width + x];
            assert(*id >= 0 && *id < c->piece.n);
            if (name[*id] < 0) {
                const tz_canvas_piece *p = &c->piece.v[*id];
                const int64_t whole = p->whole / 4;
                scene->piece[n] = (tz_scene_piece){
                    .element = p->element,
                    .depth = p->depth,
                    .whole = whole > INT32_MAX ? INT32_MAX : (int32_t)whole};
                name[*id] = n++;
            }
            *id = name[*id];
            scene->piece[*id].area++;
            grow_box(&scene->piece[*id].box, x, y);
        }
    for (int32_t i = 0; i < n; i++)
        if (scene->piece[i].whole < scene->piece[i].area)
            scene->piece[i].whole = scene->piece[i].area;
    scene->pieces = n;
    tz_free(c->ctx, name);
    return TZ_OK;
}

/* ---- boundary ---------------------------------------------------------------------- */

/* Where a disc 4 px wide fits into one segment, that place is wide. */
static void mark_wide(const plane *m, const tz_scene *scene, uint8_t *wide)
{
    static const int8_t dx[12] = {1, 2, 0, 1, 2, 3, 0, 1, 2, 3, 1, 2};
    static const int8_t dy[12] = {0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3};
    for (int32_t y = -2; y < m->height - 1; y++)
        for (int32_t x = -2; x < m->width - 1; x++) {
            int64_t p[12];
            int32_t n = 0, id = -1;
            bool fits = true;
            for (int32_t k = 0; k < 12 && fits; k++) {
                const int32_t u = x + dx[k], v = y + dy[k];
                if (u < 0 || v < 0 || u >= m->width || v >= m->height)
                    continue;
                p[n] = (int64_t)v * m->width + u;
                id = id < 0 ? m->v[p[n]] : id;
                fits = m->v[p[n++]] == id && !scene->piece[id].element;
            }
            for (int32_t k = 0; k < n && fits; k++)
                wide[p[k]] = 1;
        }
}

static void mark_changes(const tz_canvas *c, const plane *m, uint8_t *mask)
{
    for (int32_t y = 0; y < m->height; y++)
        for (int32_t x = 0; x < m->width; x++) {
            const int64_t p = (int64_t)y * m->width + x;
            const uint8_t *line = c->line + (int64_t)2 * y * c->width + 2 * x;
            const bool right = x + 1 < m->width && m->v[p + 1] != m->v[p];
            const bool below = y + 1 < m->height && m->v[p + m->width] != m->v[p];
            mask[p] = right || below || line[0] || line[1] || line[c->width] ||
                      line[c->width + 1];
        }
}

/* Two curves with one pixel between them are one. */
static void close_gaps(uint8_t *mask, uint8_t *scratch, int32_t width, int32_t height)
{
    memcpy(scratch, mask, (size_t)width * (size_t)height);
    for (int32_t y = 0; y < height; y++)
        for (int32_t x = 0; x < width; x++) {
            const int64_t p = (int64_t)y * width + x;
            if (x > 0 && x + 1 < width && scratch[p - 1] && scratch[p + 1])
                mask[p] = 1;
            if (y > 0 && y + 1 < height && scratch[p - width] && scratch[p + width])
                mask[p] = 1;
        }
}

static tz_status find_boundary(const tz_canvas *c, const plane *m, tz_scene *scene)
{
    const int64_t n = (int64_t)m->width * m->height;
    uint8_t *wide = NULL;
    tz_status s = tz_alloc_zero(c->ctx, &wide, (size_t)n, 1);
    if (s == TZ_OK)
        s = tz_alloc(c->ctx, &scene->boundary, (size_t)n, 1);
    if (s == TZ_OK) {
        mark_wide(m, scene, wide);
        mark_changes(c, m, scene->boundary);
        for (int64_t p = 0; p < n; p++)
            if (!scene->piece[m->v[p]].element && !wide[p])
                scene->boundary[p] = 1;
        close_gaps(scene->boundary, wide, m->width, m->height);
        s = tz_scene_thin(c->ctx, scene->boundary, m->width, m->height);
    }
    tz_free(c->ctx, wide);
    return s;
}

tz_status tz_scene_truth(tz_canvas *c, tz_scene *scene)
{
    const int32_t width = c->width / 2, height = c->height / 2;
    tz_status s = tz_alloc(c->ctx, &scene->segment, (size_t)width * (size_t)height,
                           sizeof *scene->segment);
    if (s != TZ_OK)
        return s;
    plane m = {scene->segment, width, height};
    majority(c, width, height, m.v);
    absorb_specks(&m);
    s = count_pieces(c, &m, scene);
    return s == TZ_OK ? find_boundary(c, &m, scene) : s;
}
