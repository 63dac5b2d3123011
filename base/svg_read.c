/* SPDX-License-Identifier: Apache-2.0 */
/* Reading SVG through libxml2. Limits are kept while parsing: our SAX call-backs count
 * elements and depth and refuse entity declarations, then hand on to libxml2's own, which
 * build the tree. Without declared entities only the five of XML itself can occur, so
 * XML_PARSE_NOENT is safe here and gives each attribute as one piece of text; and since
 * size, elements and depth are counted here, libxml2's own limits (10 MB of text in one
 * piece, or behind another) are lifted by XML_PARSE_HUGE. */
#include <libxml/parser.h>
#include <libxml/parserInternals.h>
#include <libxml/tree.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/svg.h"

enum { MAX_NODES = 5000000, MAX_DEPTH = 256 };
static const size_t max_file = (size_t)1 << 30;

typedef struct named {
    const char *id;
    const xmlNode *node;
    int32_t order;
} named;

struct tz_svg_doc {
    tz_ctx *ctx;
    xmlDocPtr xml;
    TZ_ARRAY(named)
    ids; /* sorted by id, then document order */
    TZ_ARRAY(xmlChar *)
    text; /* handed out by tz_svg_text */
};

/* What the call-backs keep; reached through the parser context's _private. */
typedef struct watch {
    int64_t nodes;
    int depth;
    const char *why; /* limit that was hit */
    tz_status status;
} watch;

static void stop(xmlParserCtxtPtr p, tz_status s, const char *why)
{
    watch *w = p->_private;
    if (!w->why) {
        w->why = why;
        w->status = s;
    }
    xmlStopParser(p);
}

static void on_start(void *ctx, const xmlChar *name, const xmlChar *prefix,
                     const xmlChar *uri, int n_ns, const xmlChar **ns, int n_attr,
                     int n_default, const xmlChar **attr)
{
    xmlParserCtxtPtr p = ctx;
    watch *w = p->_private;
    w->nodes += 1 + n_attr;
    if (w->nodes > MAX_NODES)
        stop(p, TZ_LIMIT, "more than 5 million elements and attributes; split it");
    else if (++w->depth > MAX_DEPTH)
        stop(p, TZ_LIMIT, "elements nested deeper than 256; flatten its groups");
    else
        xmlSAX2StartElementNs(ctx, name, prefix, uri, n_ns, ns, n_attr, n_default, attr);
}

static void on_end(void *ctx, const xmlChar *name, const xmlChar *prefix,
                   const xmlChar *uri)
{
    xmlParserCtxtPtr p = ctx;
    watch *w = p->_private;
    w->depth--;
    if (!w->why)
        xmlSAX2EndElementNs(ctx, name, prefix, uri);
}

static void on_entity(void *ctx, const xmlChar *name, int type, const xmlChar *public_id,
                      const xmlChar *system_id, xmlChar *content)
{
    (void)name;
    (void)type;
    (void)public_id;
    (void)system_id;
    (void)content;
    stop(ctx, TZ_FORMAT,
         "declares entities, which we do not expand; save it as plain SVG");
}

static int by_id(const void *a, const void *b)
{
    const named *p = a, *q = b;
    int c = strcmp(p->id, q->id);
    return c ? c : (p->order > q->order) - (p->order < q->order);
}

/* Next node of a walk in document order, without recursion. */
static const xmlNode *walk(const xmlNode *n, const xmlNode *root)
{
    if (n->children && n->type == XML_ELEMENT_NODE)
        return n->children;
    while (n && n != root && !n->next)
        n = n->parent;
    return !n || n == root ? NULL : n->next;
}

static tz_status index_ids(tz_svg_doc *doc)
{
    const xmlNode *root = xmlDocGetRootElement(doc->xml);
    for (const xmlNode *n = root; n; n = walk(n, root)) {
        const char *id = n->type == XML_ELEMENT_NODE ? tz_svg_attr(n, "id") : NULL;
        if (!id)
            continue;
        named item = {id, n, doc->ids.n};
        tz_status s = tz_array_push(doc->ctx, &doc->ids, item);
        if (s != TZ_OK)
            return s;
    }
    if (doc->ids.n > 0)
        qsort(doc->ids.v, (size_t)doc->ids.n, sizeof *doc->ids.v, by_id);
    return TZ_OK;
}

static tz_status report(tz_ctx *ctx, const char *name, xmlParserCtxtPtr p, const watch *w)
{
    const xmlError *e = xmlCtxtGetLastError(p);
    if (w->why)
        return tz_fail(ctx, w->status, "%s:%d: %s", name, p->input ? p->input->line : 0,
                       w->why);
    if (e && e->code == XML_ERR_NO_MEMORY)
        return tz_fail(ctx, TZ_NOMEM, "%s: out of memory", name);
    const char *text = e && e->message ? e->message : "not well-formed";
    return tz_fail(ctx, TZ_FORMAT, "%s:%d: not readable as SVG: %.*s; check the file",
                   name, e ? e->line : 0, (int)strcspn(text, "\n"), text);
}

tz_status tz_svg_parse(tz_ctx *ctx, const char *name, const char *text, size_t size,
                       tz_svg_doc **out)
{
    if (size == 0)
        return tz_fail(ctx, TZ_FORMAT, "%s: the file is empty; export it again", name);
    if (size > max_file || size > INT_MAX)
        return tz_fail(ctx, TZ_LIMIT, "%s: larger than 1 GiB; split it", name);
    watch w = {0};
    tz_svg_doc *doc = NULL;
    tz_status s = tz_alloc_zero(ctx, &doc, 1, sizeof *doc);
    if (s != TZ_OK)
        return s;
    doc->ctx = ctx;
    xmlParserCtxtPtr p = xmlNewParserCtxt();
    if (!p) {
        s = tz_fail(ctx, TZ_NOMEM, "%s: out of memory", name);
        goto done;
    }
    p->_private = &w;
    p->sax->startElementNs = on_start;
    p->sax->endElementNs = on_end;
    p->sax->entityDecl = on_entity;
    doc->xml = xmlCtxtReadMemory(
        p, text, (int)size, NULL, NULL,
        XML_PARSE_NOENT | XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING |
            XML_PARSE_BIG_LINES | XML_PARSE_COMPACT | XML_PARSE_NOCDATA | XML_PARSE_HUGE);
    const xmlNode *root = doc->xml ? xmlDocGetRootElement(doc->xml) : NULL;
    if (!doc->xml || w.why)
        s = report(ctx, name, p, &w);
    else if (!root || !tz_svg_is(root, "svg"))
        s = tz_fail(ctx, TZ_FORMAT, "%s:1: the root element is not svg; export it as SVG",
                    name);
    else
        s = index_ids(doc);
done:
    xmlFreeParserCtxt(p);
    if (s == TZ_OK)
        *out = doc;
    else
        tz_svg_free(doc);
    return s;
}

tz_status tz_svg_read(tz_ctx *ctx, const char *path, tz_svg_doc **out)
{
    char *text;
    size_t size;
    tz_status s = tz_file_read(ctx, path, max_file, &text, &size);
    if (s != TZ_OK)
        return s;
    s = tz_svg_parse(ctx, strcmp(path, "-") == 0 ? "standard input" : path, text, size,
                     out);
    tz_free(ctx, text);
    return s;
}

void tz_svg_free(tz_svg_doc *doc)
{
    if (!doc)
        return;
    for (int32_t i = 0; i < doc->text.n; i++)
        xmlFree(doc->text.v[i]);
    tz_array_free(doc->ctx, &doc->text);
    tz_array_free(doc->ctx, &doc->ids);
    xmlFreeDoc(doc->xml);
    tz_free(doc->ctx, doc);
}

/* ---- nodes
 * ------------------------------------------------------------------------------ */

tz_svg_node tz_svg_root(const tz_svg_doc *doc) { return xmlDocGetRootElement(doc->xml); }

static tz_svg_node element_from(const xmlNode *n)
{
    while (n && n->type != XML_ELEMENT_NODE)
        n = n->next;
    return n;
}

tz_svg_node tz_svg_child(tz_svg_node n)
{
    return n ? element_from(((const xmlNode *)n)->children) : NULL;
}

tz_svg_node tz_svg_next(tz_svg_node n)
{
    return n ? element_from(((const xmlNode *)n)->next) : NULL;
}

static bool in_namespace(const xmlNs *ns, const char *uri)
{
    return ns && ns->href && strcmp((const char *)ns->href, uri) == 0;
}

bool tz_svg_is(tz_svg_node node, const char *name)
{
    const xmlNode *n = node;
    /* hand-written files often lack the namespace */
    return n && n->type == XML_ELEMENT_NODE && strcmp((const char *)n->name, name) == 0 &&
           (!n->ns || in_namespace(n->ns, TZ_SVG_NS));
}

int32_t tz_svg_line(tz_svg_node n)
{
    return n ? (int32_t)xmlGetLineNo((const xmlNode *)n) : 0;
}

static const char *attr_in(const xmlNode *n, const char *uri, const char *local)
{
    for (const xmlAttr *a = n->properties; a; a = a->next) {
        if (strcmp((const char *)a->name, local) != 0)
            continue;
        if (uri ? in_namespace(a->ns, uri) : !a->ns)
            return a->children && a->children->content
                       ? (const char *)a->children->content
                       : "";
    }
    return NULL;
}

const char *tz_svg_attr(tz_svg_node node, const char *name)
{
    const xmlNode *n = node;
    if (!n || n->type != XML_ELEMENT_NODE)
        return NULL;
    if (strncmp(name, "tz:", 3) == 0)
        return attr_in(n, TZ_NS, name + 3);
    if (strncmp(name, "xlink:", 6) == 0) {
        const char *value = attr_in(n, TZ_XLINK_NS, name + 6);
        return value ? value : attr_in(n, NULL, name + 6); /* as SVG 2 has it */
    }
    if (strncmp(name, "inkscape:", 9) == 0)
        return attr_in(n, TZ_INKSCAPE_NS, name + 9);
    return attr_in(n, NULL, name);
}

const char *tz_svg_text(tz_svg_doc *doc, tz_svg_node n)
{
    xmlChar *text = n ? xmlNodeGetContent((const xmlNode *)n) : NULL;
    if (!text)
        return "";
    if (tz_array_push(doc->ctx, &doc->text, text) != TZ_OK) {
        xmlFree(text);
        return "";
    }
    return (const char *)text;
}

tz_svg_node tz_svg_by_id(const tz_svg_doc *doc, const char *id)
{
    int32_t lo = 0, hi = doc->ids.n; /* first not below id */
    while (lo < hi) {
        int32_t mid = lo + (hi - lo) / 2;
        if (strcmp(doc->ids.v[mid].id, id) < 0)
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo < doc->ids.n && strcmp(doc->ids.v[lo].id, id) == 0 ? doc->ids.v[lo].node
                                                                 : NULL;
}
