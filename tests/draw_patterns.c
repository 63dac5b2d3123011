/* SPDX-License-Identifier: Apache-2.0 */
/* Draws the element exemplars of data/exemplars: draw_patterns FOLDER. Each is a plain SVG
 * that any editor opens: chips of stone, leaves in a current, hearts and dots in rows,
 * noodles; and a palette of garden things to fill shapes with. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/geom.h"
#include "base/rng.h"

enum { MOST = 2000, SIDE = 480 };

typedef struct spot {
    double x, y, r;
} spot;

static double between(tz_rng *g, double lo, double hi)
{
    return lo + (hi - lo) * tz_rng_unit(g);
}

/** Random places in the view, as dense as dart throwing gets them.
 * @param apart  share of the radii's sum that keeps two apart */
static int scatter(tz_rng *g, const double *radius, int radii, double apart, spot *out)
{
    int n = 0;
    for (int k = 0; k < radii; k++) /* large ones first */
        for (int i = 0; i < 6000 && n < MOST; i++) {
            const spot s = {between(g, 0, SIDE), between(g, 0, SIDE), radius[k]};
            int free = 1;
            for (int j = 0; j < n && free; j++)
                free = hypot(s.x - out[j].x, s.y - out[j].y) > apart * (s.r + out[j].r);
            if (free)
                out[n++] = s;
        }
    return n;
}

static FILE *begin(const char *folder, const char *name, const char *ground,
                   const char *more)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.svg", folder, name);
    FILE *f = fopen(path, "w");
    if (!f) {
        fprintf(stderr, "draw_patterns: %s: %s\n", path, strerror(errno));
        exit(1);
    }
    fprintf(f,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" %s"
            "xmlns:xlink=\"http://www.w3.org/1999/xlink\" viewBox=\"0 0 %d %d\">\n"
            "<!-- SPDX-License-Identifier: Apache-2.0 -->\n"
            "<rect width=\"%d\" height=\"%d\" fill=\"%s\"/>\n",
            more, SIDE, SIDE, SIDE, SIDE, ground);
    return f;
}

static void end(FILE *f)
{
    fputs("</svg>\n", f);
    if (fclose(f) != 0) {
        fprintf(stderr, "draw_patterns: %s\n", strerror(errno));
        exit(1);
    }
}

/** Chips of stone in three sizes: convex polygons of four colours. */
static void chips(const char *folder)
{
    static const char *const colour[] = {"#b5533c", "#3f6b6f", "#d9a441", "#55433d"};
    static const double radius[] = {24, 13, 6};
    tz_rng g = tz_rng_make(1, 1);
    spot s[MOST];
    const int n = scatter(&g, radius, 3, 1.12, s);
    FILE *f = begin(folder, "chips", "#efe8dc", "");
    for (int i = 0; i < n; i++) {
        const int corners = 5 + (int)(3 * tz_rng_unit(&g));
        const double turn = between(&g, 0, 2 * TZ_PI), flat = between(&g, 0.62, 0.95),
                     angle = between(&g, 0, TZ_PI);
        fprintf(f, "<path fill=\"%s\" d=\"", colour[(int)(4 * tz_rng_unit(&g))]);
        for (int k = 0; k < corners; k++) {
            const double a = turn + 2 * TZ_PI * (k + between(&g, -0.25, 0.25)) / corners;
            const double u = s[i].r * cos(a), v = s[i].r * flat * sin(a);
            fprintf(f, "%c%.2f %.2f", k ? 'L' : 'M',
                    s[i].x + u * cos(angle) - v * sin(angle),
                    s[i].y + u * sin(angle) + v * cos(angle));
        }
        fputs("Z\"/>\n", f);
    }
    end(f);
}

/** Leaves that lie as in a current: symbols, turned. */
static void leaves(const char *folder)
{
    static const double radius[] = {21, 15};
    static const char *const id[] = {"willow", "lime", "bud"};
    tz_rng g = tz_rng_make(2, 1);
    spot s[MOST];
    const int n = scatter(&g, radius, 2, 0.92, s);
    FILE *f = begin(folder, "current", "#f4f1e6", "");
    fputs("<defs>\n"
          "<symbol id=\"willow\" overflow=\"visible\"><path fill=\"#4d7a4a\" "
          "d=\"M-20 0C-10 -8 8 -8 20 0C8 8 -10 8 -20 0Z\"/>"
          "<path fill=\"none\" stroke=\"#dfe8c8\" d=\"M-16 0L16 0\"/></symbol>\n"
          "<symbol id=\"lime\" overflow=\"visible\"><path fill=\"#8aa64f\" "
          "d=\"M-19 0C-12 -13 4 -13 19 0C4 13 -12 13 -19 0Z\"/>"
          "<path fill=\"none\" stroke=\"#4d6a2a\" d=\"M-15 0L14 0M-6 0L-1 -7M-6 0L-1 "
          "7\"/></symbol>\n"
          "<symbol id=\"bud\" overflow=\"visible\"><path fill=\"#c9795b\" "
          "d=\"M-13 0C-6 -7 6 -5 13 0C6 5 -6 7 -13 0Z\"/></symbol>\n"
          "</defs>\n",
          f);
    for (int i = 0; i < n; i++) {
        const double angle =
            28 * sin(s[i].x / 70) + 20 * cos(s[i].y / 90) - 20 + between(&g, -9, 9);
        const char *which = s[i].r < 20 ? id[2] : id[(int)(2 * tz_rng_unit(&g))];
        fprintf(
            f,
            "<use xlink:href=\"#%s\" transform=\"translate(%.2f %.2f) rotate(%.2f)\"/>"
            "\n",
            which, s[i].x, s[i].y, angle);
    }
    end(f);
}

/** Hearts and dots in rows, each heart with four dots about it. */
static void rows(const char *folder)
{
    FILE *f = begin(folder, "hearts", "#2f3e55", "");
    fputs("<defs><symbol id=\"heart\" overflow=\"visible\"><path fill=\"#e2695c\" "
          "d=\"M0 13C-17 0 -12 -12 -5 -11C-2 -10.500 0 -8 0 -6C0 -8 2 -10.500 5 -11C12 "
          "-12 17 0 0 13Z\"/></symbol>"
          "<symbol id=\"dot\" overflow=\"visible\"><circle r=\"5\" fill=\"#f0d9a8\"/>"
          "</symbol></defs>\n",
          f);
    for (int j = 0; j < 8; j++)
        for (int i = 0; i < 8; i++) {
            const double x = 60 * i + 30, y = 60 * j + 30;
            fprintf(
                f,
                "<use xlink:href=\"#heart\" transform=\"translate(%g %g) rotate(%d)\"/>"
                "\n",
                x, y, (i + j) % 2 ? 180 : 0);
            fprintf(f, "<use xlink:href=\"#dot\" x=\"%g\" y=\"%g\"/>\n", x + 30, y);
            fprintf(f, "<use xlink:href=\"#dot\" x=\"%g\" y=\"%g\"/>\n", x, y + 30);
        }
    end(f);
}

/** Noodles: long bent things side by side. */
static void noodles(const char *folder)
{
    tz_rng g = tz_rng_make(4, 1);
    FILE *f = begin(folder, "noodles", "#6d2f2a", "");
    for (int j = 0; j < 22; j++)
        for (int i = 0; i < 5; i++) {
            const double x = 96 * i + (j % 2 ? 48 : 0) + between(&g, -6, 6) + 6,
                         y = 22 * j + between(&g, -2, 2) + 10, b = between(&g, -9, 9);
            fprintf(f,
                    "<path fill=\"none\" stroke=\"#f2cf7a\" stroke-width=\"9\" "
                    "stroke-linecap=\"round\" d=\"M%.2f %.2fC%.2f %.2f %.2f %.2f %.2f "
                    "%.2f\"/>\n",
                    x, y, x + 24, y + b, x + 48, y - b, x + 72, y + b / 2);
        }
    end(f);
}

/** A palette: things that lie apart, each along the direction that it is to follow, and
 * their mix. */
static void garden(const char *folder)
{
    static const struct {
        const char *name, *shape;
        int x, y;
    } thing[] = {
        {"leaf",
         "<path fill='#4d7a4a' d='M-27 0C-14 -12 8 -12 27 0C8 12 -14 12 -27 0Z'/>"
         "<path fill='none' stroke='#dfe8c8' stroke-width='1.4' d='M-22 0L20 0'/>",
         90, 80},
        {"sprig", "<path fill='#8aa64f' d='M-20 0C-11 -8 6 -8 20 0C6 8 -11 8 -20 0Z'/>",
         240, 80},
        {"petal",
         "<path fill='#e2695c' d='M-17 0C-8 -2 -2 -11 8 -10C20 -9 20 9 8 10C-2 11 -8 2 "
         "-17 "
         "0Z'/><path fill='#f4b6a4' d='M2 -4C9 -5 12 -3 12 0C12 3 9 5 2 4C5 2 5 -2 2 "
         "-4Z'/>",
         390, 80},
        {"ribbon", "<path fill='#2f6f7e' d='M-56 -5L50 -5L56 0L50 5L-56 5L-50 0Z'/>", 110,
         240},
        {"bead", "<circle r='8' fill='#d9a441'/>", 270, 240},
        {"berry", "<circle r='5' fill='#7a2f45'/>", 390, 240},
    };
    FILE *f = begin(folder, "garden", "#faf6ea",
                    "xmlns:tz=\"https://terrazzo.example/ns/1\" "
                    "tz:mix=\"leaf:3, sprig:3, petal:2, ribbon:1 rigidity=5, bead:3, "
                    "berry:4\" ");
    fputs("<defs>\n", f);
    for (size_t i = 0; i < sizeof thing / sizeof *thing; i++)
        fprintf(f, "<symbol id=\"%s\" overflow=\"visible\">%s</symbol>\n", thing[i].name,
                thing[i].shape);
    fputs("</defs>\n", f);
    for (size_t i = 0; i < sizeof thing / sizeof *thing; i++)
        fprintf(f, "<use xlink:href=\"#%s\" x=\"%d\" y=\"%d\"/>\n", thing[i].name,
                thing[i].x, thing[i].y);
    end(f);
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fputs("usage: draw_patterns FOLDER\n", stderr);
        return 2;
    }
    chips(argv[1]);
    leaves(argv[1]);
    rows(argv[1]);
    noodles(argv[1]);
    garden(argv[1]);
    return 0;
}
