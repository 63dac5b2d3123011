/* SPDX-License-Identifier: Apache-2.0 */
/* Style of SVG shapes: presentation attributes, then the rules of <style> by rising
 * specificity (* and element, .class, #id), then style="". Selectors that look at other
 * nodes (a b, a > b, :hover, [x]) are passed over. */
#include <stdlib.h>
#include <string.h>

#include "elements/element_color.h"
#include "elements/element_svg_internal.h"

#define BLANK " \t\r\n\f"

tz_style tz_style_initial(void)
{
    return (tz_style){.fill = 0x000000ff,
                      .color = 0x000000ff,
                      .fill_opacity = 1,
                      .stroke_opacity = 1,
                      .opacity = 1,
                      .width = 1,
                      .visible = true,
                      .shown = true};
}

bool tz_style_length(const char *text, double whole, double *out)
{
    static const struct {
        const char *name;
        double px;
    } unit[] = {{"", 1},    {"px", 1},         {"mm", 96 / 25.4}, {"cm", 96 / 2.54},
                {"in", 96}, {"pt", 96.0 / 72}, {"pc", 16},        {"em", 16},
                {"ex", 8},  {"rem", 16},       {"q", 96 / 101.6}, {"Q", 96 / 101.6}};
    const char *end;
    double v;
    if (!text || !tz_number_parse(text + strspn(text, BLANK), &end, &v))
        return false;
    const size_t n = strcspn(end, BLANK ";!");
    if (end[n + strspn(end + n, BLANK)] && end[n + strspn(end + n, BLANK)] != ';' &&
        end[n + strspn(end + n, BLANK)] != '!')
        return false;
    if (n == 1 && *end == '%') {
        *out = v / 100 * whole;
        return isfinite(*out);
    }
    for (size_t i = 0; i < sizeof unit / sizeof unit[0]; i++)
        if (strlen(unit[i].name) == n && strncmp(unit[i].name, end, n) == 0) {
            *out = v * unit[i].px;
            return isfinite(*out);
        }
    return false;
}

/* ---- paint ----------------------------------------------------------------------- */

static bool is(const char *v, size_t n, const char *word)
{
    return n == strlen(word) && strncmp(v, word, n) == 0;
}

/* Value of `property` in a style attribute; its length, or 0. */
static size_t in_declarations(const char *text, const char *property, const char **value)
{
    const size_t k = strlen(property);
    for (const char *p = text; p && *p; p += *p == ';') {
        p += strspn(p, BLANK ";");
        const char *v = p + k;
        if (strncmp(p, property, k) == 0 && *(v += strspn(v, BLANK)) == ':') {
            v += 1 + strspn(v + 1, BLANK);
            size_t n = strcspn(v, ";!");
            while (n && strchr(BLANK, v[n - 1]))
                n--;
            *value = v;
            return n;
        }
        p += strcspn(p, ";");
    }
    return 0;
}

static size_t stop_value(tz_svg_node n, const char *name, const char **v)
{
    const size_t k = in_declarations(tz_svg_attr(n, "style"), name, v);
    if (k)
        return k;
    *v = tz_svg_attr(n, name);
    return *v ? strlen(*v) : 0;
}

/* The mean of a gradient's stops, for a symbol has no gradients of its own. */
static uint32_t mean_of_stops(tz_element_reader *r, tz_svg_node g)
{
    double sum[4] = {0};
    int count = 0;
    for (int hop = 0; g && hop < 8 && count == 0; hop++) {
        for (tz_svg_node c = tz_svg_child(g); c; c = tz_svg_next(c)) {
            uint32_t rgba = 0x000000ff;
            double a = 1;
            const char *v;
            if (!tz_svg_is(c, "stop"))
                continue;
            size_t k = stop_value(c, "stop-color", &v);
            if (k)
                tz_color_parse(v, k, &rgba);
            if (stop_value(c, "stop-opacity", &v))
                tz_style_length(v, 1, &a);
            for (int i = 0; i < 3; i++)
                sum[i] += rgba >> (24 - 8 * i) & 255;
            sum[3] += (rgba & 255) * fmin(fmax(a, 0), 1);
            count++;
        }
        const char *href = tz_svg_attr(g, "xlink:href");
        g = href && *href == '#' ? tz_svg_by_id(r->doc, href + 1) : NULL;
    }
    uint32_t out = 0;
    for (int i = 0; i < 4; i++)
        out = out << 8 | (count ? (uint32_t)(sum[i] / count + 0.5) : i == 3 ? 255 : 128);
    return out;
}

/* Paint of url(#id): *pattern where it is one. */
static bool paint_server(tz_element_reader *r, const char *v, size_t n, uint32_t *out,
                         tz_svg_node *pattern)
{
    char id[256];
    const char *hash = memchr(v, '#', n);
    size_t k = 0;
    if (!hash)
        return false;
    hash++;
    while (hash + k < v + n && !strchr("\"')", hash[k]))
        k++;
    if (k >= sizeof id)
        return false;
    memcpy(id, hash, k);
    id[k] = 0;
    tz_svg_node target = tz_svg_by_id(r->doc, id);
    if (!target)
        return false;
    *pattern = tz_svg_is(target, "pattern") ? target : NULL;
    *out = *pattern ? 0x808080ff : mean_of_stops(r, target);
    return true;
}

static void set_paint(tz_element_reader *r, const char *v, size_t n, const tz_style *s,
                      uint32_t *out, tz_svg_node *pattern)
{
    *pattern = NULL;
    if (is(v, n, "none") || is(v, n, "transparent")) {
        *out = 0;
    } else if (is(v, n, "currentColor") || is(v, n, "currentcolor")) {
        *out = s->color;
    } else if (strncmp(v, "url(", 4) == 0 && n > 4) {
        if (!paint_server(r, v, n, out, pattern)) {
            const char *rest = memchr(v, ')', n); /* a colour may stand behind it */
            uint32_t c;
            if (rest &&
                tz_color_parse(rest + 1 + strspn(rest + 1, BLANK),
                               n - (size_t)(rest - v) - 1 - strspn(rest + 1, BLANK), &c))
                *out = c;
            else
                *out = 0;
        }
    } else {
        tz_color_parse(v, n, out); /* what is no colour leaves the paint as it was */
    }
}

/* ---- properties ------------------------------------------------------------------ */

static uint32_t choice(const char *v, size_t n, const char *a, const char *b)
{
    return is(v, n, a) ? 1 : is(v, n, b) ? 2 : 0;
}

static bool fraction(const char *v, double *out)
{
    double x;
    if (!tz_style_length(v, 1, &x))
        return false;
    *out = fmin(fmax(x, 0), 1);
    return true;
}

/* Copies v[0..n-1], which may run on, so that numbers end where it does. */
static bool number_of(const char *v, size_t n, double whole, double *out)
{
    char text[64];
    if (n >= sizeof text)
        return false;
    memcpy(text, v, n);
    text[n] = 0;
    return tz_style_length(text, whole, out);
}

/* One property; false if its value is a number that cannot be read. */
static bool set(tz_element_reader *r, const char *name, size_t k, const char *v, size_t n,
                tz_style *s, double *own_opacity)
{
    tz_svg_node none;
    if (n == 0 || is(v, n, "inherit") || is(v, n, "initial") || is(v, n, "unset"))
        return true;
    if (is(name, k, "fill"))
        set_paint(r, v, n, s, &s->fill, &s->pattern);
    else if (is(name, k, "stroke"))
        set_paint(r, v, n, s, &s->stroke, &none);
    else if (is(name, k, "color"))
        set_paint(r, v, n, s, &s->color, &none);
    else if (is(name, k, "stroke-width"))
        return number_of(v, n, hypot(r->view.x, r->view.y) / sqrt(2), &s->width) &&
               s->width >= 0;
    else if (is(name, k, "fill-opacity"))
        return fraction(v, &s->fill_opacity);
    else if (is(name, k, "stroke-opacity"))
        return fraction(v, &s->stroke_opacity);
    else if (is(name, k, "opacity"))
        return fraction(v, own_opacity);
    else if (is(name, k, "fill-rule"))
        s->rule = is(v, n, "evenodd");
    else if (is(name, k, "stroke-linecap"))
        s->cap = choice(v, n, "round", "square");
    else if (is(name, k, "stroke-linejoin"))
        s->join = choice(v, n, "round", "bevel");
    else if (is(name, k, "display"))
        s->shown = !is(v, n, "none");
    else if (is(name, k, "visibility"))
        s->visible = is(v, n, "visible");
    return true;
}

static bool declare(tz_element_reader *r, const char *text, tz_style *s, double *opacity)
{
    bool good = true;
    for (const char *p = text; p && *p;) {
        p += strspn(p, BLANK ";");
        const size_t k = strcspn(p, BLANK ":;");
        const char *v = p + k + strspn(p + k, BLANK);
        if (*v == ':') {
            v += 1 + strspn(v + 1, BLANK);
            size_t n = strcspn(v, ";!");
            while (n && strchr(BLANK, v[n - 1]))
                n--;
            good = set(r, p, k, v, n, s, opacity) && good;
        }
        p += strcspn(p, ";");
    }
    return good;
}

/* ---- rules ----------------------------------------------------------------------- */

static int by_rule(const void *a, const void *b)
{
    const tz_css_rule *p = a, *q = b;
    const int d = p->kind - q->kind, e = d ? d : strcmp(p->name, q->name);
    return e ? e : (p->order > q->order) - (p->order < q->order);
}

/* One selector of a rule; those that are not simple are dropped. */
static tz_status add_rule(tz_element_reader *r, char *name, const char *body)
{
    tz_css_rule rule = {.body = body, .order = r->rule.n};
    name += strspn(name, BLANK);
    size_t n = strlen(name);
    while (n && strchr(BLANK, name[n - 1]))
        name[--n] = 0;
    rule.kind = *name == '.' || *name == '#' || *name == '*' ? *name : 'e';
    rule.name = rule.kind == 'e' ? name : name + 1;
    if (rule.kind == 'e') { /* path.c1 and path#p: the nearer half is enough */
        char *dot = strpbrk(name, ".#");
        if (dot) {
            rule.kind = *dot;
            rule.name = dot + 1;
        }
    }
    if (n == 0 || strpbrk(rule.name, BLANK ">+~:[.#*") ||
        (rule.kind == '*' && *rule.name))
        return TZ_OK;
    return tz_array_push(r->ctx, &r->rule, rule);
}

/* Cuts css text into rules: selectors { declarations }. */
static tz_status cut_rules(tz_element_reader *r, char *css)
{
    tz_status s = TZ_OK;
    for (char *c = strstr(css, "/*"); c; c = strstr(c, "/*")) {
        char *end = strstr(c + 2, "*/");
        memset(c, ' ', end ? (size_t)(end + 2 - c) : strlen(c));
    }
    for (char *p = css; *p && s == TZ_OK;) {
        char *open = strchr(p, '{'), *close = open ? strchr(open, '}') : NULL;
        if (!close)
            break;
        *open = *close = 0;
        if (p[strspn(p, BLANK)] != '@')
            for (char *name = p; name && s == TZ_OK;) {
                char *comma = strchr(name, ',');
                if (comma)
                    *comma = 0;
                s = add_rule(r, name, open + 1);
                name = comma ? comma + 1 : NULL;
            }
        p = close + 1;
    }
    return s;
}

/* Text of all <style> of the document, one behind another. */
static tz_status gather(tz_element_reader *r, tz_svg_node n, int depth, size_t *size)
{
    tz_status s = TZ_OK;
    for (tz_svg_node c = tz_svg_child(n); c && s == TZ_OK; c = tz_svg_next(c)) {
        if (tz_svg_is(c, "style")) {
            const char *text = tz_svg_text(r->doc, c);
            const size_t k = strlen(text);
            s = tz_realloc(r->ctx, &r->css, *size + k + 2, 1);
            if (s == TZ_OK) {
                memcpy(r->css + *size, text, k);
                memcpy(r->css + *size + k, "\n", 2);
                *size += k + 1;
            }
        } else if (depth < 4 &&
                   (tz_svg_is(c, "defs") || tz_svg_is(c, "g") || tz_svg_is(c, "svg"))) {
            s = gather(r, c, depth + 1, size);
        }
    }
    return s;
}

tz_status tz_style_load(tz_element_reader *r)
{
    size_t size = 0;
    tz_status s = gather(r, tz_svg_root(r->doc), 0, &size);
    if (s == TZ_OK && r->css)
        s = cut_rules(r, r->css);
    if (s == TZ_OK && r->rule.n > 1)
        qsort(r->rule.v, (size_t)r->rule.n, sizeof *r->rule.v, by_rule);
    return s;
}

/* Applies the rules of one selector. */
static bool apply(tz_element_reader *r, char kind, const char *name, size_t n,
                  tz_style *s, double *opacity)
{
    int32_t lo = 0, hi = r->rule.n;
    bool good = true;
    while (lo < hi) {
        const int32_t mid = lo + (hi - lo) / 2;
        const tz_css_rule *t = &r->rule.v[mid];
        int d = t->kind - kind;
        if (d == 0) {
            d = strncmp(t->name, name, n);
            d = d ? d : t->name[n] != 0;
        }
        if (d < 0)
            lo = mid + 1;
        else
            hi = mid;
    }
    for (; lo < r->rule.n && r->rule.v[lo].kind == kind &&
           strncmp(r->rule.v[lo].name, name, n) == 0 && r->rule.v[lo].name[n] == 0;
         lo++)
        good = declare(r, r->rule.v[lo].body, s, opacity) && good;
    return good;
}

static bool apply_rules(tz_element_reader *r, tz_svg_node n, tz_style *s, double *opacity)
{
    static const char *const elements[] = {"path",    "circle",   "rect",   "ellipse",
                                           "polygon", "polyline", "line",   "g",
                                           "use",     "svg",      "symbol", "a"};
    bool good = apply(r, '*', "", 0, s, opacity);
    for (size_t i = 0; i < sizeof elements / sizeof elements[0]; i++)
        if (tz_svg_is(n, elements[i]))
            good = apply(r, 'e', elements[i], strlen(elements[i]), s, opacity) && good;
    const char *names = tz_svg_attr(n, "class"), *id = tz_svg_attr(n, "id");
    for (const char *p = names; p && *p;) {
        p += strspn(p, BLANK);
        const size_t k = strcspn(p, BLANK);
        if (k)
            good = apply(r, '.', p, k, s, opacity) && good;
        p += k;
    }
    if (id)
        good = apply(r, '#', id, strlen(id), s, opacity) && good;
    return good;
}

/* ---- the style of a node ---------------------------------------------------------- */

tz_status tz_style_at(tz_element_reader *r, tz_svg_node n, const tz_style *up,
                      tz_style *out)
{
    static const char *const property[] = {
        "color",          "fill",      "stroke",    "stroke-width",   "fill-opacity",
        "stroke-opacity", "opacity",   "fill-rule", "stroke-linecap", "stroke-linejoin",
        "display",        "visibility"};
    double opacity = 1;
    *out = *up;
    for (size_t i = 0; i < sizeof property / sizeof property[0]; i++) {
        const char *v = tz_svg_attr(n, property[i]);
        if (!v)
            continue;
        v += strspn(v, BLANK);
        size_t k = strlen(v);
        while (k && strchr(BLANK, v[k - 1]))
            k--;
        if (!set(r, property[i], strlen(property[i]), v, k, out, &opacity))
            return tz_fail(
                r->ctx, TZ_FORMAT,
                "%s:%d: %s=\"%.40s\" is not a number that it can take; correct "
                "it",
                r->name, tz_svg_line(n), property[i], v);
    }
    const bool rules = r->rule.n == 0 || apply_rules(r, n, out, &opacity);
    if (!declare(r, tz_svg_attr(n, "style"), out, &opacity) || !rules)
        return tz_fail(r->ctx, TZ_FORMAT,
                       "%s:%d: a number in the style cannot be read; correct it", r->name,
                       tz_svg_line(n));
    out->opacity *= opacity;
    return TZ_OK;
}

static uint32_t faded(uint32_t color, double by)
{
    return (color & ~255u) | (uint32_t)((color & 255) * by + 0.5);
}

tz_look tz_style_look(const tz_style *s)
{
    tz_look k;
    memset(&k, 0, sizeof k); /* compared as bytes */
    k.fill = faded(s->fill, s->fill_opacity * s->opacity);
    k.stroke = s->width > 0 ? faded(s->stroke, s->stroke_opacity * s->opacity) : 0;
    if (!(k.fill & 255))
        k.fill = 0;
    if (!(k.stroke & 255))
        k.stroke = 0;
    else {
        k.width = s->width;
        k.cap = s->cap;
        k.join = s->join;
    }
    k.rule = k.fill ? s->rule : 0;
    return k;
}
