#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# All exemplars beside their textures (four times the area), with the figures of `terrazzo
# compare`: one HTML page, and a PNG sheet for each exemplar and for all together.
#
#   tests/gallery.sh BUILDDIR [PHOTOS]
#
# With GALLERY=fields in the environment it makes the part of element fields only.
# PHOTOS is a folder of images. Default: ../shared/exemplars/photos beside the repository if
# it is there, else the demo's photos, else the exemplars that Terrazzo draws.
set -u
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "${1:?use: tests/gallery.sh BUILDDIR [PHOTOS]}" && pwd) || exit 1
terrazzo=$build/bin/terrazzo
out=$build/gallery
. "$here/photos.sh"

[ -x "$terrazzo" ] || { echo "gallery: $terrazzo is not there; build it first" >&2; exit 1; }
mkdir -p "$out" || exit 1

folder=${2:-$here/../../shared/exemplars/photos}
if [ ! -d "$folder" ]; then
    folder=$build/cache/photos
    fetch_photos "$folder" >/dev/null || folder=$here/../data/exemplars
fi
shopt -s nullglob
photos=("$folder"/*.{jpg,png})
[ ${#photos[@]} -gt 0 ] || { echo "gallery: no images in $folder" >&2; exit 1; }

page=$out/index.html
cat >"$page.part" <<'HTML'
<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>Terrazzo: gallery</title>
<style>body{font:15px sans-serif;margin:2em;background:#f6f5f2;color:#222}
figure{display:inline-block;margin:0 1em 1em 0;vertical-align:top}img{display:block}
td,th{padding:.2em .8em;text-align:right}td:first-child,th:first-child{text-align:left}
</style><h1>Terrazzo: exemplars and their textures</h1>
<p>Each texture has twice the sides of its exemplar, both shown at the same scale; a click
opens the texture. Ratios: 1 = the texture differs from its exemplar as two halves of the
exemplar differ.</p>
HTML
# figure NAME JSON : the first number of that name, to two places
figure() {
    local v
    v=$(printf '%s\n' "$2" | sed -n "s/^ *\"$1\": \([-+0-9.eE]*\),*\$/\1/p" | head -n 1)
    if [ -n "$v" ]; then printf '%.2f' "$v"; else printf -- '-'; fi
}

rows= sections= failed=0 sheet=() labels=
if [ "${GALLERY-}" = fields ]; then
    . "$here/gallery_fields.sh"
    { cat "$page.part"; echo "<h1>Element fields</h1>$fields</html>"; } >"$out/fields.html"
    rm -f "$page.part"
    echo "gallery: $out/fields.html"
    exit $((failed > 0))
fi
for photo in "${photos[@]}"; do
    name=$(basename "${photo%.*}")
    # twice the sides = four times the exemplar's area
    made=$("$terrazzo" expand "$photo" -o "$out/$name.png" --grow 2 --seed 7 --quiet \
        --json) || { failed=$((failed + 1)); continue; }
    figures=$("$terrazzo" compare "$photo" "$out/$name.png" --heat "$out/${name}_heat.png" \
        --json) || figures='{}'
    "$terrazzo" sheet "$photo" "$out/$name.png" "$out/${name}_heat.png" --quiet \
        -o "$out/${name}_sheet.png" --columns 3 --cell 800x800 || failed=$((failed + 1))
    line=
    for key in score patch orientation correlation sharpness repetition near-repeat \
        periodicity seam broken; do
        line+="</td><td>$(figure "$key" "$figures")"
    done
    line+="</td><td>$(figure total "$made")"
    score=$(figure score "$figures")
    rows+="<tr><td><a href=\"#$name\">$name</a>$line</td></tr>"$'\n'
    sections+="<h2 id=\"$name\">$name</h2><a href=\"$name.png\">
<img src=\"${name}_sheet.png\" alt=\"$name beside its texture and where it is weak\"></a>"$'\n'
    sheet+=("$photo" "$out/$name.png")
    labels+="${labels:+|}$name|score $score"
    printf '%-24s score %s\n' "$name" "$score"
done
# ---- elements ------------------------------------------------------------------------
# Drawings beside layouts of nine times their area; photos that are made of things.
elements=
element_sheet() { # NAME TITLE PICTURE...
    local name=$1 title=$2
    shift 2
    "$terrazzo" sheet "$@" -o "$out/$name.png" --columns 2 --cell 800x800 --quiet ||
        { failed=$((failed + 1)); return; }
    elements+="<h2>$title</h2><img src=\"$name.png\" alt=\"$title\">"$'\n'
    echo "$title"
}
for drawing in "$here"/../../shared/exemplars/svg/*.svg \
    "$here"/../data/exemplars/{chips,current,hearts,noodles}.svg; do
    name=$(basename "${drawing%.svg}")
    "$terrazzo" arrange "$drawing" -o "$out/e_$name.svg" --grow 3 --seed 7 --quiet &&
        "$terrazzo" render "$out/e_$name.svg" -o "$out/e_$name.png" --quiet ||
        { failed=$((failed + 1)); continue; }
    rsvg-convert -h 800 "$drawing" -o "$out/d_$name.png" 2>/dev/null || continue
    mean=$(figure mean "$("$terrazzo" compare "$drawing" "$out/e_$name.svg" --json)")
    element_sheet "s_$name" "$name: mean ratio $mean" "$out/d_$name.png" "$out/e_$name.png"
done
for photo in "${photos[@]}"; do
    name=$(basename "${photo%.*}")
    case $name in pebbles* | gravel* | cobble* | stone* | leaf* | leaves* | volcanic* | brick* | rocks*) ;;
    *) continue ;;
    esac
    "$terrazzo" expand "$photo" --as elements -o "$out/t_$name.png" --grow 2 --seed 7 --quiet ||
        { failed=$((failed + 1)); continue; }
    element_sheet "u_$name" "$name, as elements" "$photo" "$out/t_$name.png"
done

# ---- curves --------------------------------------------------------------------------
# Drawings of lines beside layouts of nine times their area.
curves=
for drawing in "$here"/../../shared/exemplars/svg/{lattice,network,contours,wood}*.svg \
    "$here"/../data/exemplars/{noodles,current,streets,circuit,contours,grain,mud,vine}.svg; do
    name=$(basename "${drawing%.svg}")
    "$terrazzo" arrange "$drawing" --as curves -o "$out/c_$name.svg" --grow 3 --seed 7 \
        --quiet &&
        "$build/tests/draw_curves" sheet -o "$out/v_$name.svg" "$drawing" \
            "$out/c_$name.svg" || { failed=$((failed + 1)); continue; }
    rsvg-convert -w 1600 "$out/v_$name.svg" -o "$out/v_$name.png" 2>/dev/null || continue
    mean=$(figure mean "$("$terrazzo" compare "$drawing" "$out/c_$name.svg" --as curves \
        --json)")
    curves+="<h2>$name: mean ratio $mean</h2><img src=\"v_$name.png\" alt=\"$name\">"$'\n'
    echo "$name, as curves: mean ratio $mean"
done
# Photos by their lines; samples, ablations and energies of the published method.
for photo in "${photos[@]}"; do
    name=$(basename "${photo%.*}")
    case $name in cracked* | veined* | onyx* | volcanic* | stone_wall* | brick* | cobble* | mud*) ;;
    *) continue ;;
    esac
    "$terrazzo" analyze "$photo" --as curves -o "$out/l_$name.svg" --quiet &&
        "$terrazzo" arrange "$out/l_$name.svg" -o "$out/k_$name.svg" --grow 2 --seed 7 \
            --quiet &&
        "$terrazzo" render "$out/k_$name.svg" -o "$out/k_$name.png" --quiet &&
        "$build/tests/draw_curves" sheet -o "$out/w_$name.svg" "$out/l_$name.svg" \
            "$out/k_$name.svg" || { failed=$((failed + 1)); continue; }
    rsvg-convert -w 1600 "$out/w_$name.svg" -o "$out/w_$name.png" 2>/dev/null || continue
    "$terrazzo" sheet "$photo" "$out/k_$name.png" -o "$out/x_$name.png" --columns 2 \
        --cell 800x800 --quiet || { failed=$((failed + 1)); continue; }
    curves+="<h2>$name, by its lines</h2><img src=\"w_$name.png\" alt=\"$name: lines\">
<img src=\"x_$name.png\" alt=\"$name: pixels\">"$'\n'
    echo "$name, by its lines"
done
for kind in levels ablations energy; do
    "$build/tests/draw_curves" $kind -o "$out/method_$kind.svg" --seed 7 \
        "$here/../data/exemplars/mud.svg" >/dev/null || { failed=$((failed + 1)); continue; }
    curves+="<h2>the published method: $kind</h2><img src=\"method_$kind.svg\" alt=\"$kind\">"$'\n'
done

. "$here/gallery_fields.sh"

{
    cat "$page.part"
    echo '<table><tr><th>exemplar</th><th>score</th><th>patch</th><th>orientation</th>'
    echo '<th>correlation</th><th>sharpness</th><th>repetition</th>'
    echo '<th>near repeats</th><th>periodicity</th>'
    echo "<th>seam</th><th>broken</th><th>seconds</th></tr>$rows</table>"
    echo "$sections"
    echo "<h1>Elements</h1>$elements<h1>Curves</h1>$curves<h1>Element fields</h1>$fields</html>"
} >"$page"
rm -f "$page.part"
if [ ${#sheet[@]} -gt 0 ]; then
    "$terrazzo" sheet "${sheet[@]}" -o "$out/sheet.png" --columns 6 --cell 480x480 \
        --labels "${labels:0:1000}" --quiet || failed=$((failed + 1))
fi
echo "gallery: $page"
[ "$failed" -eq 0 ] || { echo "gallery: $failed steps failed" >&2; exit 1; }
