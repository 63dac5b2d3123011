#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes every picture in docs/figures/ again, with the program itself.
#
#   tests/figures.sh BUILDDIR [PHOTOS [OUT]]
#
# With FIGURES="curves fields" in the environment it makes those of these pages only.
# OUT is where the pictures go, default docs/figures.
# PHOTOS is a folder with CC0 photos by the names below; default ../shared/exemplars/photos
# beside the repository. A photo that is not there is replaced by one of the demo's CC0
# photos, or where those cannot be had by an exemplar that Terrazzo draws. Only CC0 photos
# are used, because the pictures are committed.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/.." && pwd)
build=$(cd "${1:?use: tests/figures.sh BUILDDIR [PHOTOS [OUT]]}" && pwd)
folder=${2:-$root/../shared/exemplars/photos}
terrazzo=$build/bin/terrazzo
work=$build/figures
out=$(mkdir -p "${3:-$root/docs/figures}" && cd "${3:-$root/docs/figures}" && pwd)
. "$here/photos.sh"

[ -x "$terrazzo" ] || { echo "figures: $terrazzo is not there; build it first" >&2; exit 1; }
command -v rsvg-convert >/dev/null || { echo "figures: install librsvg2-bin" >&2; exit 1; }
mkdir -p "$work"
fetch_photos "$build/cache/photos" >/dev/null || true

"${CC:-cc}" -std=c17 -D_GNU_SOURCE -O2 -I"$root" "$here/draw_figures.c" \
    -o "$work/draw_figures" -L"$build/lib" -lterrazzo -lm -Wl,-rpath,"$build/lib"

# photo NAME SUBSTITUTE EXEMPLAR : copies the photo into the work folder, prints its name
# there
photo() {
    local f
    for f in "$folder/$1".{jpg,png} "$build/cache/photos/$1.png" \
        "$build/cache/photos/$2.png" "$root/data/exemplars/$3.png"; do
        [ -s "$f" ] || continue
        cp "$f" "$work/$1.${f##*.}"
        echo "$1.${f##*.}"
        return
    done
}

cd "$work"
tz() { "$terrazzo" "$@" --quiet; }
draw() { ./draw_figures "$@"; }
# picture NAME : NAME.svg to NAME.png, at its own size or $2 px wide
picture() { rsvg-convert -b white ${2:+-w "$2"} "$1.svg" -o "$1.png"; }
# sheet NAME COLUMNS CELL LABELS PICTURE... : docs/figures/NAME.jpg
sheet() {
    local name=$1 columns=$2 cell=$3 labels=$4
    shift 4
    tz sheet "$@" -o "$out/$name.jpg" --columns "$columns" --cell "$cell" \
        --labels "$labels" --quality 82
    echo "$out/$name.jpg"
}

wall=$(photo stone_wall brick bricks)
bark=$(photo bark_brown grass bark)
slabs=$(photo mossy_rock_slabs stones stones)
cells=$(photo volcanic_stone_cells mud stones)
cliff=$(photo cliff_strata grass mud)
cracked=$(photo cracked_rock mud mud)
leaves=$(photo leaf_litter gravel leaves)
onyx=$(photo onyx_swirl mud mud)
gravel=$(photo gravel gravel pebbles)
brick=$(photo brick brick bricks)
pavement=$(photo cobblestone_pavement brick bricks)
slate=$(photo veined_slate mud mud)
moss=$(photo moss_ground grass leaves)

parts=${FIGURES-}
for part in $parts; do
    . "$here/figures_$part.sh"
done
[ -z "$parts" ] || exit 0

# ---- README ----------------------------------------------------------------------------
# block X Y NAME : exemplar, below it a part of the texture at full size, and the texture
block() {
    local x=$1 y=$2 p=$3 n=${3%.*}
    tz expand "$p" -o "big_$n.png" --size 2048x2048 --seed 7 --save-layout "big_$n.svg"
    tz render "big_$n.svg" -o "part_$n.png" --crop 900,800,220,220
    echo "<image xlink:href='$p' x='$x' y='$y' width='220' height='220'/>"
    echo "<image xlink:href='part_$n.png' x='$x' y='$((y + 228))' width='220' height='220'/>"
    echo "<image xlink:href='big_$n.png' x='$((x + 228))' y='$y' width='448' height='448'/>"
}
{
    echo "<svg xmlns='http://www.w3.org/2000/svg' width='1376' height='920'
        xmlns:xlink='http://www.w3.org/1999/xlink'>"
    block 0 0 "$slabs"
    block 700 0 "$cracked"
    block 0 472 "$bark"
    block 700 472 "$leaves"
    echo "</svg>"
} >textures.svg
picture textures
sheet textures 1 1400x1400 "above: exemplar - below: part of the texture, full size\
 - right: texture of four times the area" textures.png

# ---- analysis --------------------------------------------------------------------------
tz analyze "$wall" -o wall.svg
draw edges wall.svg edges.svg
picture edges 800
sheet edges 1 800x800 "edges, coloured by the bin of their angle" edges.png
draw bins wall.svg bins.svg
picture bins 1000
sheet bins 1 1200x1200 "columns: angle - rows: length" bins.png
picture wall 800
sheet groups 1 800x800 "regions, and their edges in the same hue" wall.png
draw polar wall.svg polar.svg
picture polar
sheet polar 1 1000x1000 "one edge group with its edges' centres, and its polar grid" polar.png

# what the detector was trained on
"$build/tests/draw_scenes" scenes.png 1000000 150
sheet scenes 1 1400x1400 "a scene of each kind, and the boundaries that are known to be in it" \
    scenes.png

# the detectors side by side, with the model that Terrazzo ships
model=$root/data/edge-forest.yml.gz
if [ -s "$model" ]; then
    "$build/tests/draw_edges" --model "$model" --cell 208 --quality 50 \
        -o "$out/detectors.jpg" "$pavement" "$cells" "$wall" "$slabs" "$gravel" \
        "$cracked" "$leaves" "$bark" "$slate" "$moss"
    echo "$out/detectors.jpg"
else
    echo "figures: no data/edge-forest.yml.gz: detectors.jpg is left out" >&2
fi

# ---- arrangement -----------------------------------------------------------------------
tz arrange wall.svg -o layout.svg --size 1024x768 --seed 7
tz render layout.svg -o layout.png
draw cut wall.svg layout.svg cut.svg
picture cut 800
sheet cut 1 800x800 "blue: the group's region - red: the piece that was cut out" cut.png
draw pieces layout.svg pieces.svg
picture pieces
draw borders layout.svg layout.png borders.png
sheet layout 2 640x640 "pieces, later ones on top|their borders in the texture" \
    pieces.png borders.png

# ---- elements --------------------------------------------------------------------------
# Drawings of data/exemplars, and things of the photos.
for name in chips current hearts noodles; do
    cp "$root/data/exemplars/$name.svg" .
done
# pair X Y NAME : a drawing beside a layout of nine times its area, at one scale
pair() {
    tz expand "$3.svg" -o "grown_$3.png" --size 1440x1440 --seed 7
    rsvg-convert "$3.svg" -o "drawn_$3.png"
    echo "<image xlink:href='drawn_$3.png' x='$1' y='$2' width='170' height='170'/>"
    echo "<image xlink:href='grown_$3.png' x='$(($1 + 178))' y='$2' width='510' height='510'/>"
}
{
    echo "<svg xmlns='http://www.w3.org/2000/svg' width='1392' height='1034'
        xmlns:xlink='http://www.w3.org/1999/xlink'>"
    pair 0 0 chips
    pair 704 0 current
    pair 0 524 hearts
    pair 704 524 noodles
    echo "</svg>"
} >elements.svg
picture elements
sheet elements 1 1400x1400 "drawings, and layouts of nine times their area" elements.png

cat >ring.svg <<'SVG'
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><path fill-rule="evenodd"
 d="M50 4A46 46 0 1 1 49.9 4ZM50 30A20 20 0 1 1 49.9 30Z"/></svg>
SVG
cat >strokes.svg <<'SVG'
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100" fill="none" stroke="black">
<path d="M10 90C10 30 40 10 90 10"/><path d="M50 95C50 60 70 50 95 50"/></svg>
SVG
cat >zones.svg <<'SVG'
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><rect width="100"
 height="100" fill="#ff0000"/><circle cx="50" cy="50" r="32" fill="#0000ff"/></svg>
SVG
cat >brush.svg <<'SVG'
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 900 900" fill="none">
<path stroke="black" stroke-width="170" d="M120 450C200 100 700 100 780 450S400 900 300 600"/>
<path stroke="#ff0000" stroke-width="60" d="M100 300L800 300"/></svg>
SVG
size="--size 900x900 --seed 7"
tz arrange current.svg -o grown_leaves.svg --size 480x480 --seed 7
tz expand noodles.svg -o g1.png $size --domain ring.svg --shape bend \
    --field "atan2(y-h/2,x-w/2)*180/pi+90"
tz expand current.svg -o g2.png $size --field strokes.svg
tz expand hearts.svg -o g3.png $size --zones zones.svg \
    --zone-kinds "#ff0000=heart;#0000ff=dot"
tz expand current.svg -o g4.png $size --brush brush.svg
sheet elements-guides 2 480x480 "--domain, --field, --shape bend|--field with \
two strokes|--zones: hearts outside, dots inside|--brush: one stroke grows, one erases" \
    g1.png g2.png g3.png g4.png

# things PHOTO Y : the photo, its things and the plate; beside them a texture
pebbles=$(photo pebbles pebbles pebbles)
things() {
    local n=${1%.*}
    "$build/tests/draw_things" --side 640 -o "things_$n.png" "$1"
    tz expand "$1" --as elements -o "big_$n.png" --seed 7 --size 960x640
    echo "<image xlink:href='things_$n.png' x='0' y='$2' width='960' height='320'/>"
    echo "<image xlink:href='big_$n.png' x='968' y='$2' width='480' height='320'/>"
}
{
    echo "<svg xmlns='http://www.w3.org/2000/svg' width='1448' height='976'
        xmlns:xlink='http://www.w3.org/1999/xlink'>"
    things "$pavement" 0
    things "$pebbles" 328
    things "$cells" 656
    echo "</svg>"
} >elements-photo.svg
picture elements-photo
sheet elements-photo 1 1448x1000 "photo, its things, the plate; a texture" elements-photo.png

tz analyze "$pavement" --as elements -o setts.svg
tz arrange setts.svg -o setts_big.svg --size 480x480 --seed 3
tz render setts_big.svg -o m0.png --maps id=m1.exr,class=m2.exr,uv=m3.exr
for i in 1 3; do
    draw numbers m$i.exr m$i.png
done
tz render grown_leaves.svg -o m4.png --maps class=m5.exr,angle=m6.exr
for i in 5 6; do
    draw numbers m$i.exr m$i.png
done
sheet elements-maps 3 400x400 "colour|id|uv|colour|class|angle" \
    m0.png m1.png m3.png m4.png m5.png m6.png

# ---- seams -----------------------------------------------------------------------------
tz expand "$cliff" -o cliff.png --size 1024x1024 --seed 7 --save-layout cliff.svg
part=256,256,480,480
for kind in none screened opencv; do
    tz render cliff.svg -o "seams_$kind.png" --clone $kind --crop $part
done
draw difference seams_screened.png seams_none.png seams_difference.png
sheet seams 2 480x480 \
    "--clone none|--clone screened (default)|the correction, 4 times|--clone opencv" \
    seams_none.png seams_screened.png seams_difference.png seams_opencv.png

# ---- parameters ------------------------------------------------------------------------
size="--size 480x480 --seed 3"
tz expand "$wall" -o p1.png $size
tz expand "$wall" -o p2.png $size --coherence 0
tz expand "$wall" -o p3.png $size --coherence 1
tz expand "$wall" -o p4.png $size --piece 60
tz expand "$wall" -o p5.png $size --piece 240
tz expand "$wall" -o p6.png $size --rotation=-180,180
sheet parameters 3 480x480 \
    "default|--coherence 0|--coherence 1|--piece 60|--piece 240|--rotation=-180,180" \
    p1.png p2.png p3.png p4.png p5.png p6.png

# ---- rules -----------------------------------------------------------------------------
presets=$root/data/presets
tz expand "$bark" -o r1.png --size 1024x1024 --seed 3 --rules "$presets/swirl.json"
tz expand "$bark" -o r2.png --size 1024x1024 --seed 3 --rules "$presets/angle-by-region.json"
tz expand "$cells" -o r3.png --size 1024x1024 --seed 3 \
    --rules "$presets/random-and-granular.json"
tz expand "$slabs" "$cells" -o r4.png --size 1024x1024 --seed 3 \
    --rules "$presets/two-sources.json"
tz expand "$slabs" "$cliff" -o r5.png --size 1024x1024 --seed 3 \
    --rules "$presets/patches-of-second-source.json"
tz expand "$bark" -o r6.png --size 1024x1024 --seed 3 --rules "$presets/wind.json"
labels="swirl|angle-by-region|random-and-granular|two-sources"
sheet rules 3 400x400 "$labels|patches-of-second-source|wind" \
    r1.png r2.png r3.png r4.png r5.png r6.png

# ---- tiles and maps --------------------------------------------------------------------
tz expand "$gravel" -o tile.png --size 320x320 --seed 5 --tile
cat >four.svg <<'SVG'
<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"
 width="640" height="640"><image xlink:href="tile.png" width="320" height="320"/>
<image xlink:href="tile.png" x="320" width="320" height="320"/>
<image xlink:href="tile.png" y="320" width="320" height="320"/>
<image xlink:href="tile.png" x="320" y="320" width="320" height="320"/></svg>
SVG
picture four
sheet tile 2 640x640 "one tile|two by two tiles" tile.png four.png
draw normals "$cells" cells_n.png
tz expand "$cells" -o maps.png --size 640x640 --seed 5 --maps normal=cells_n.png \
    --rotation=-180,180
sheet maps 2 640x640 "colour|normals, turned with their pieces" maps.png maps_normal.png

# ---- limits ----------------------------------------------------------------------------
tz expand "$brick" -o limit1.png --size 512x512 --seed 7
tz expand "$onyx" -o onyx.png --size 2048x2048 --seed 7 --crop 700,700,512,512
labels="an exemplar in perspective|its rows meet at odd places"
sheet limits 3 512x512 "$labels|long bands break off at seams" \
    "$brick" limit1.png onyx.png

. "$here/figures_curves.sh"
. "$here/figures_fields.sh"

du -ch "$out"/* | tail -1
