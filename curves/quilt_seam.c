/* SPDX-License-Identifier: Apache-2.0 */
/* Minimum cut on the 4-connected grid of a window, between cells that stay and cells that
 * must be laid anew. The edge between cells p and q costs off(p) + off(q) + a little.
 * @source Boykov, Kolmogorov: An experimental comparison of min-cut/max-flow algorithms,
 *   PAMI 2004: two trees that grow towards each other and are mended, with time stamps.
 *   Terminals are cells, so trees are rooted in cells. Capacities are whole numbers:
 *   each augmentation carries one at least, so that their sum bounds the loop. */
#include <string.h>

#include "curves/quilt_internal.h"

enum { FREE, SOURCE, SINK };
enum { IS_ROOT = 4, NO_PARENT, UNIT = 1000 };

typedef struct quilt_flow {
    tz_ctx *ctx;
    int32_t most, w, h; /* cells in all; sides with the rim */
    int32_t step[4];
    int32_t *room;        /* [4 cell + direction]: residual capacity */
    uint8_t *tree, *up;   /* tree of each cell; direction of its parent */
    int32_t *stamp, *way; /* last time the root was seen, distance to it then */
    int32_t *queue;       /* active cells, a ring */
    uint8_t *queued;
    int32_t *orphan;
    int32_t head, waiting, time, orphans;
} quilt_flow;

quilt_flow *quilt_flow_new(tz_ctx *ctx, int32_t most)
{
    quilt_flow *f = NULL;
    const size_t n = (size_t)most;
    if (tz_alloc_zero(ctx, &f, 1, sizeof *f) != TZ_OK)
        return NULL;
    f->ctx = ctx;
    f->most = most;
    if (tz_alloc(ctx, &f->room, 4 * n, sizeof *f->room) != TZ_OK ||
        tz_alloc(ctx, &f->tree, n, 1) != TZ_OK || tz_alloc(ctx, &f->up, n, 1) != TZ_OK ||
        tz_alloc(ctx, &f->stamp, n, sizeof *f->stamp) != TZ_OK ||
        tz_alloc(ctx, &f->way, n, sizeof *f->way) != TZ_OK ||
        tz_alloc(ctx, &f->queue, n, sizeof *f->queue) != TZ_OK ||
        tz_alloc(ctx, &f->queued, n, 1) != TZ_OK ||
        tz_alloc(ctx, &f->orphan, n, sizeof *f->orphan) != TZ_OK) {
        quilt_flow_free(ctx, f);
        return NULL;
    }
    return f;
}

void quilt_flow_free(tz_ctx *ctx, quilt_flow *f)
{
    if (!f)
        return;
    tz_free(ctx, f->room);
    tz_free(ctx, f->tree);
    tz_free(ctx, f->up);
    tz_free(ctx, f->stamp);
    tz_free(ctx, f->way);
    tz_free(ctx, f->queue);
    tz_free(ctx, f->queued);
    tz_free(ctx, f->orphan);
    tz_free(ctx, f);
}

/* Neighbour in direction d (right, down, left, up): the grid has a rim without room. */
static inline int32_t neighbour(const quilt_flow *f, int32_t i, int d)
{
    return i + f->step[d];
}

/* Residual capacity between a cell of a tree and its neighbour j in direction d, in the
 * sense in which flow runs from source to sink, with i nearer to its root. */
static int32_t *room_from(quilt_flow *f, int32_t i, int d, int32_t j, int tree)
{
    return tree == SOURCE ? &f->room[4 * (ptrdiff_t)i + d]
                          : &f->room[4 * (ptrdiff_t)j + ((d + 2) & 3)];
}

static void activate(quilt_flow *f, int32_t i)
{
    const int32_t n = f->w * f->h;
    if (f->queued[i])
        return;
    f->queued[i] = 1;
    f->queue[(f->head + f->waiting++) % n] = i;
}

/* Length of the way to a root, or -1 if there is none. */
static int32_t rooted(quilt_flow *f, int32_t i)
{
    int32_t n = 0, at = i;
    for (;; n++) {
        if (f->stamp[at] == f->time) {
            n += f->way[at];
            break;
        }
        if (f->up[at] == NO_PARENT)
            return -1;
        if (f->up[at] == IS_ROOT) {
            f->stamp[at] = f->time;
            f->way[at] = 0;
            break;
        }
        at = neighbour(f, at, f->up[at]);
    }
    const int32_t length = n;
    for (at = i; f->stamp[at] != f->time; at = neighbour(f, at, f->up[at])) {
        f->stamp[at] = f->time;
        f->way[at] = n--;
    }
    return length;
}

static void make_orphan(quilt_flow *f, int32_t i)
{
    f->up[i] = NO_PARENT;
    f->orphan[f->orphans++] = i;
}

/* Walks from i to its root: least room (then called with room 0), or takes `room`. */
static int32_t walk(quilt_flow *f, int32_t i, int tree, int32_t room)
{
    int32_t least = INT32_MAX;
    while (f->up[i] != IS_ROOT) {
        const int d = f->up[i];
        const int32_t p = neighbour(f, i, d);
        int32_t *ahead = room_from(f, p, (d + 2) & 3, i, tree);
        if (room == 0) {
            least = *ahead < least ? *ahead : least;
        } else {
            int32_t *back = ahead == &f->room[4 * (ptrdiff_t)i + d]
                                ? &f->room[4 * (ptrdiff_t)p + ((d + 2) & 3)]
                                : &f->room[4 * (ptrdiff_t)i + d];
            *ahead -= room;
            *back += room;
            if (*ahead == 0)
                make_orphan(f, i);
        }
        i = p;
    }
    return least;
}

/* Flow along source .. i - j .. sink. */
static int32_t augment(quilt_flow *f, int32_t i, int d, int32_t j)
{
    int32_t *between = &f->room[4 * (ptrdiff_t)i + d];
    int32_t room = *between, least = walk(f, i, SOURCE, 0);
    room = least < room ? least : room;
    least = walk(f, j, SINK, 0);
    room = least < room ? least : room;
    *between -= room;
    f->room[4 * (ptrdiff_t)j + ((d + 2) & 3)] += room;
    (void)walk(f, i, SOURCE, room);
    (void)walk(f, j, SINK, room);
    return room;
}

static void adopt(quilt_flow *f, int32_t i)
{
    const int tree = f->tree[i];
    int32_t best = INT32_MAX;
    int to = NO_PARENT;
    for (int d = 0; d < 4; d++) {
        const int32_t j = neighbour(f, i, d);
        if (f->tree[j] != tree || *room_from(f, j, (d + 2) & 3, i, tree) == 0)
            continue;
        const int32_t n = rooted(f, j);
        if (n >= 0 && n < best) {
            best = n;
            to = d;
        }
    }
    f->up[i] = (uint8_t)to;
    if (to != NO_PARENT) {
        f->stamp[i] = f->time;
        f->way[i] = best + 1;
        return;
    }
    for (int d = 0; d < 4; d++) {
        const int32_t j = neighbour(f, i, d);
        if (f->tree[j] != tree)
            continue;
        if (*room_from(f, j, (d + 2) & 3, i, tree) > 0)
            activate(f, j);
        if (f->up[j] == ((d + 2) & 3))
            make_orphan(f, j);
    }
    f->tree[i] = FREE;
}

/* Grows the trees from one active cell. False once it has nothing more to do. */
static bool grow(quilt_flow *f, int32_t i, int32_t meet[2], int *way)
{
    const int tree = f->tree[i];
    if (tree == FREE)
        return false;
    for (int d = 0; d < 4; d++) {
        const int32_t j = neighbour(f, i, d);
        if (*room_from(f, i, d, j, tree) == 0)
            continue;
        if (f->tree[j] == FREE) {
            f->tree[j] = (uint8_t)tree;
            f->up[j] = (uint8_t)((d + 2) & 3);
            f->stamp[j] = f->stamp[i];
            f->way[j] = f->way[i] + 1;
            activate(f, j);
        } else if (f->tree[j] != tree) {
            meet[0] = tree == SOURCE ? i : j;
            meet[1] = tree == SOURCE ? j : i;
            *way = tree == SOURCE ? d : (d + 2) & 3;
            return true;
        }
    }
    return false;
}

static void begin(quilt_flow *f, const float *off, const uint8_t *state)
{
    const int32_t n = f->w * f->h;
    memset(f->stamp, 0, (size_t)n * sizeof *f->stamp);
    memset(f->way, 0, (size_t)n * sizeof *f->way);
    memset(f->queued, 0, (size_t)n);
    f->head = f->waiting = f->orphans = 0;
    f->time = 0;
    memset(f->room, 0, 4 * (size_t)n * sizeof *f->room);
    for (int32_t i = 0; i < n; i++) {
        f->tree[i] = FREE;
        f->up[i] = NO_PARENT;
    }
    for (int32_t y = 0; y < f->h - 2; y++)
        for (int32_t x = 0; x < f->w - 2; x++) {
            static const int8_t step[2][2] = {{1, 0}, {0, 1}};
            const int32_t i = (y + 1) * f->w + x + 1, at = y * (f->w - 2) + x;
            if (state[at] == QUILT_BLOCKED)
                continue;
            if (state[at] != QUILT_FREE) {
                f->tree[i] = state[at] == QUILT_OLD ? SOURCE : SINK;
                f->up[i] = IS_ROOT;
            }
            for (int d = 0; d < 2; d++) {
                const int32_t u = x + step[d][0], v = y + step[d][1],
                              to = v * (f->w - 2) + u;
                if (u >= f->w - 2 || v >= f->h - 2 || state[to] == QUILT_BLOCKED)
                    continue;
                f->room[4 * (ptrdiff_t)i + d] =
                    f->room[4 * (ptrdiff_t)(i + f->step[d]) + d + 2] =
                        (int32_t)(UNIT * (off[at] + off[to] + QUILT_SEAM_LEAST));
            }
        }
    /* only where trees have somewhere to grow */
    for (int32_t i = 0; i < n; i++)
        for (int d = 0; d < 4 && f->tree[i] != FREE; d++)
            if (f->room[4 * (ptrdiff_t)i + d] > 0 &&
                f->tree[i + f->step[d]] != f->tree[i]) {
                activate(f, i);
                break;
            }
}

void quilt_flow_cut(quilt_flow *f, int32_t w, int32_t h, const float *off,
                    const uint8_t *state, uint8_t *side, double *cost)
{
    int64_t flow = 0;
    f->w = w + 2;
    f->h = h + 2;
    f->step[0] = 1;
    f->step[1] = f->w;
    f->step[2] = -1;
    f->step[3] = -f->w;
    begin(f, off, state);
    while (f->waiting > 0) {
        const int32_t i = f->queue[f->head];
        int32_t meet[2];
        int way = 0;
        if (!grow(f, i, meet, &way)) {
            f->head = (f->head + 1) % (f->w * f->h);
            f->waiting--;
            f->queued[i] = 0;
            continue;
        }
        f->time++;
        flow += augment(f, meet[0], way, meet[1]);
        while (f->orphans > 0) {
            const int32_t o = f->orphan[--f->orphans];
            adopt(f, o);
        }
    }
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++)
            side[(ptrdiff_t)y * w + x] = f->tree[(y + 1) * f->w + x + 1] == SINK;
    *cost = (double)flow / UNIT;
}
