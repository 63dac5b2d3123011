/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Mixes: which things of a palette fill a domain, in which shares, how large and how soft,
 * as text.
 *
 *   "leaf:3 rigidity=20 size=0.5..2, stone:1 turn=90 jitter=10, *:0.2"
 *
 * Parts stand between commas. A part names a class or a symbol of the palette, or * for all
 * that no other part names, and its share of the count (1 where none is given), which its
 * elements divide among them. Words after it:
 *
 *   rigidity=R    0 bends .. 100 never bends
 *   size=S, A..B  of the palette's; each thing draws its own between A and B
 *   turn=DEG      against the directions of the field, positive clockwise
 *   jitter=DEG    each thing turns by up to this more, either way
 *
 *
 * A palette may bring its mix along: tz:mix of its <svg>. And each of its things may say
 * such words of itself, share= among them: in data- attributes of its shape, group or
 * symbol (data-share="3" data-size="0.5..2"), in its label in Inkscape
 * ("leaf share=3 size=0.5..2") or in its own tz:mix. They hold where the mix says nothing
 * else. Things are also called by their ids and the plain words of their labels. */
#ifndef TZ_FIELDS_MIX_H
#define TZ_FIELDS_MIX_H

#include "fields/fill.h"

typedef TZ_ARRAY(tz_fill_entry)
tz_mix;

/** @param rigidity  where a part says nothing of it
 * @param[out] mix  zeroed before; free with tz_array_free(ctx, mix); empty on error
 * @return TZ_OK; TZ_INVALID (names the word, or the class that is not there); TZ_NOMEM */
TZ_API tz_status tz_mix_parse(tz_ctx *ctx, const char *text,
                              const tz_element_set *palette, double rigidity,
                              tz_mix *mix);
/** Whether an element of a palette is called so: its class, or its symbol. */
TZ_API bool tz_mix_is(const tz_element_set *palette, int32_t element, const char *name);
/** The mix that a document brings along.
 * @param[out] text  "" where it has none; free with tz_free(ctx, ...)
 * @return TZ_OK; TZ_IO; TZ_FORMAT; TZ_LIMIT; TZ_NOMEM */
TZ_API tz_status tz_mix_of_document(tz_ctx *ctx, const char *path, char **text);

#endif
