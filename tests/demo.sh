#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Expands three real photos to 2048 x 2048 pixels as PNG and EXR, with a contact sheet of
# each (exemplar beside result), two drawings to layouts of elements, two to layouts of
# curves, a photo by its lines, and fills a tile with things; prints the paths and the times.
#
#   tests/demo.sh BUILDDIR
set -u
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "${1:?use: tests/demo.sh BUILDDIR}" && pwd) || exit 1
terrazzo=$build/bin/terrazzo
out=$build/demo
. "$here/photos.sh"

[ -x "$terrazzo" ] || { echo "demo: $terrazzo is not there; build it first" >&2; exit 1; }
mkdir -p "$out" || exit 1

if fetch_photos "$build/cache/photos" >/dev/null; then
    photos=("$build/cache/photos/rocks.jpg" "$build/cache/photos/gravel.png"
        "$build/cache/photos/brick.png")
    echo "demo: photos from Debian's package archive (tuxpaint-data, python3-skimage)"
else
    photos=("$here"/../data/exemplars/{stones,bricks,mud}.png)
    echo "demo: the package archive cannot be reached; these exemplars are drawn by Terrazzo"
fi

# run COMMAND... : runs it quietly, leaves the seconds that it took in $seconds
run() {
    local start end
    start=$(date +%s%N)
    "$@" --quiet || { echo "demo: failed: $*" >&2; exit 1; }
    end=$(date +%s%N)
    seconds=$(((end - start) / 10000000))
    seconds=$(printf '%d.%02d' $((seconds / 100)) $((seconds % 100)))
}

for photo in "${photos[@]}"; do
    name=$(basename "${photo%.*}")
    run "$terrazzo" expand "$photo" -o "$out/$name.png" --size 2048x2048 --seed 7
    png=$seconds
    run "$terrazzo" expand "$photo" -o "$out/$name.exr" --size 2048x2048 --seed 7
    exr=$seconds
    run "$terrazzo" sheet "$photo" "$out/$name.png" -o "$out/${name}_sheet.png" \
        --cell 1024x1024 --labels "$name, the exemplar|2048 x 2048 px, $png s"
    printf '%s s  %s\n%s s  %s\n        %s\n' "$png" "$out/$name.png" "$exr" \
        "$out/$name.exr" "$out/${name}_sheet.png"
    sheet+=("$photo" "$out/$name.png")
    labels+="${labels:+|}$name, the exemplar|2048 x 2048 px, $png s"
done
mkdir -p "$build/cache/photos" && cp "$here"/../data/exemplars/*.svg "$build/cache/photos"
for name in current chips; do
    drawing=$build/cache/photos/$name.svg
    run "$terrazzo" arrange "$drawing" -o "$out/$name.svg" --size 2048x2048 --seed 7
    placed=$seconds
    run "$terrazzo" render "$out/$name.svg" -o "$out/$name.png"
    drawn=$seconds
    printf '%s s  %s\n%s s  %s\n' "$placed" "$out/$name.svg" "$drawn" "$out/$name.png"
    run "$terrazzo" render "$drawing" -o "$out/${name}_drawing.png"
    sheet+=("$out/${name}_drawing.png" "$out/$name.png")
    labels+="|$name, a drawing|2048 x 2048 px, $placed + $drawn s"
done
# shown NAME WHAT DRAWING : a layout that took $placed, beside what it was made from
shown() {
    run "$terrazzo" render "$out/$1.svg" -o "$out/$1.png"
    drawn=$seconds
    printf '%s s  %s\n%s s  %s\n' "$placed" "$out/$1.svg" "$drawn" "$out/$1.png"
    run "$terrazzo" render "$3" -o "$out/$1_drawing.png"
    sheet+=("$out/$1_drawing.png" "$out/$1.png")
    labels+="|$1, $2|$placed + $drawn s"
}
for name in streets vine; do
    drawing=$build/cache/photos/$name.svg
    run "$terrazzo" arrange "$drawing" --as curves -o "$out/$name.svg" --grow 2 --seed 7
    placed=$seconds
    shown "$name" "lines" "$drawing"
done
drawing=$build/cache/photos/garden.svg
run "$terrazzo" fill "$drawing" -o "$out/garden.svg" --size 900x900 --tile --seed 7
placed=$seconds
shown garden "a palette" "$drawing"
photo=${photos[2]}
run "$terrazzo" expand "$photo" --as curves -o "$out/lines.png" --size 1024x1024 --seed 7
printf '%s s  %s\n' "$seconds" "$out/lines.png"
sheet+=("$photo" "$out/lines.png")
labels+="|$(basename "${photo%.*}"), a photo|by its lines, $seconds s"
run "$terrazzo" sheet "${sheet[@]}" -o "$out/sheet.png" --cell 768x768 --columns 4 --labels "$labels"
echo "all together: $out/sheet.png"
