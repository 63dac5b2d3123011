/* SPDX-License-Identifier: Apache-2.0 */
/* What a drawing says of its things: names, and words as share=3. In plain SVG they stand
 * in data- attributes, in Inkscape in an object's label, and in tz:mix. */
#include <string.h>

#include "elements/element_svg_internal.h"

typedef TZ_ARRAY(char)
text;

static const char *const keys[] = {"share",    "weight", "size",
                                   "rigidity", "turn",   "jitter"};
enum { KEYS = sizeof keys / sizeof *keys };

static tz_status add(tz_ctx *ctx, text *t, const char *v, size_t n)
{
    tz_status s = tz_array_reserve(ctx, t, (int64_t)t->n + (int64_t)n);
    if (s == TZ_OK) {
        memcpy(t->v + t->n, v, n);
        t->n += (int32_t)n;
    }
    return s;
}

static bool is_key(const char *w, size_t n)
{
    for (int k = 0; k < KEYS; k++)
        if (strlen(keys[k]) == n && memcmp(keys[k], w, n) == 0)
            return true;
    return false;
}

/* Words of a text; of a loose one only names and those that are known. */
static tz_status add_text(tz_ctx *ctx, text *t, const char *v, bool loose)
{
    static const char blanks[] = " \t\r\n,";
    tz_status s = TZ_OK;
    while (v && *v && s == TZ_OK) {
        v += strspn(v, blanks);
        const size_t n = strcspn(v, blanks);
        const char *eq = memchr(v, '=', n);
        if (n > 0 && n < 256 && (!loose || !eq || is_key(v, (size_t)(eq - v)))) {
            s = add(ctx, t, v, n);
            if (s == TZ_OK)
                s = add(ctx, t, " ", 1);
        }
        v += n;
    }
    return s;
}

static tz_status add_node(tz_ctx *ctx, text *t, tz_svg_node n)
{
    static const char *const names[] = {"id", "inkscape:label", "tz:class"};
    tz_status s = TZ_OK;
    for (int k = 0; k < 3 && s == TZ_OK && n; k++)
        s = add_text(ctx, t, tz_svg_attr(n, names[k]), true);
    for (int k = 0; k < KEYS && s == TZ_OK && n; k++) {
        char name[32] = "data-";
        strcat(name, keys[k]);
        const char *value = tz_svg_attr(n, name);
        if (!value || !*value)
            continue;
        s = add(ctx, t, keys[k], strlen(keys[k]));
        if (s == TZ_OK)
            s = add(ctx, t, "=", 1);
        if (s == TZ_OK)
            s = add_text(ctx, t, value, false);
    }
    return s == TZ_OK && n ? add_text(ctx, t, tz_svg_attr(n, "tz:mix"), false) : s;
}

tz_status tz_element_words(tz_ctx *ctx, tz_svg_node up, tz_svg_node node, char **out)
{
    text t = {0};
    tz_status s = add_node(ctx, &t, up);
    if (s == TZ_OK)
        s = add_node(ctx, &t, node);
    if (s == TZ_OK)
        s = add(ctx, &t, "", 1);
    if (s == TZ_OK)
        s = tz_strdup(ctx, t.v, out);
    tz_array_free(ctx, &t);
    return s;
}
