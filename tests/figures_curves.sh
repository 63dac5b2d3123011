# SPDX-License-Identifier: Apache-2.0
# The pictures of curve textures; sourced by figures.sh, in its work folder.

lines="streets circuit contours grain mud vine"
for name in $lines; do
    cp "$root/data/exemplars/$name.svg" .
done

# ---- drawings --------------------------------------------------------------------------
# lines X Y NAME : a drawing beside a layout of four times its area, at one scale
lines() {
    tz arrange "$3.svg" --as curves -o "more_$3.svg" --grow 2 --seed 7
    rsvg-convert -w 440 "$3.svg" -o "drawn_$3.png"
    rsvg-convert -w 896 "more_$3.svg" -o "more_$3.png"
    echo "<image xlink:href='drawn_$3.png' x='$1' y='$2' width='220' height='220'/>"
    echo "<image xlink:href='more_$3.png' x='$(($1 + 228))' y='$2' width='448' height='448'/>"
}
svg() { # WIDTH HEIGHT : begins a picture
    echo "<svg xmlns='http://www.w3.org/2000/svg' width='$1' height='$2'
        xmlns:xlink='http://www.w3.org/1999/xlink'>"
}
{
    svg 1376 1392
    at=0
    for name in $lines; do
        lines $((at % 2 * 700)) $((at / 2 * 472)) "$name"
        at=$((at + 1))
    done
    echo "</svg>"
} >curves-drawings.svg
picture curves-drawings
sheet curves-drawings 1 1400x1400 "drawings, and layouts of four times their area" \
    curves-drawings.png

# ---- photos ----------------------------------------------------------------------------
# ink DOCUMENT WIDTH PICTURE : its lines alone, dark on paper
ink() {
    sed -e 's/<image[^>]*>//g' -e 's/stroke="#[0-9a-f]*"/stroke="#203a5a"/g' "$1" |
        rsvg-convert -b '#fbfaf7' -w "$2" -o "$3"
}
# veins Y PHOTO : the photo over its lines; a layout of four times the area and its pixels
veins() {
    local n=${2%.*}
    tz analyze "$2" --as curves -o "lines_$n.svg"
    tz arrange "lines_$n.svg" -o "laid_$n.svg" --grow 2 --seed 7
    tz render "laid_$n.svg" -o "veins_$n.png"
    ink "lines_$n.svg" 480 "ink_$n.png"
    ink "laid_$n.svg" 976 "laid_$n.png"
    echo "<image xlink:href='$2' x='0' y='$1' width='240' height='240'/>"
    echo "<image xlink:href='ink_$n.png' x='0' y='$(($1 + 248))' width='240' height='240'/>"
    echo "<image xlink:href='laid_$n.png' x='248' y='$1' width='488' height='488'/>"
    echo "<image xlink:href='veins_$n.png' x='744' y='$1' width='488' height='488'/>"
}
{
    svg 1232 1488
    veins 0 "$cracked"
    veins 500 "$slate"
    veins 1000 "$cells"
    echo "</svg>"
} >curves-photos.svg
picture curves-photos
sheet curves-photos 1 1232x1500 "photo and its lines - layout of four times the area - pixels" \
    curves-photos.png

# ---- the method ------------------------------------------------------------------------
for kind in levels ablations energy; do
    "$build/tests/draw_curves" $kind --seed 7 -o method_$kind.svg mud.svg >/dev/null
done
# high FILE WIDTH : how tall a drawing is when it is so wide
high() {
    local w h
    read -r w h < <(sed -n 's/^<svg.* width="\([0-9.]*\)" height="\([0-9.]*\)".*/\1 \2/p' "$1")
    echo $((${h%.*} * $2 / ${w%.*}))
}
{
    at=0 parts=
    for kind in levels ablations energy; do
        h=$(high method_$kind.svg 1400)
        rsvg-convert -w 1400 method_$kind.svg -o method_$kind.png
        parts+="<image xlink:href='method_$kind.png' y='$at' width='1400' height='$h'/>"
        at=$((at + h + 24))
    done
    svg 1400 $at
    echo "$parts</svg>"
} >curves-method.svg
picture curves-method
sheet curves-method 1 1400x4000 "samples by level - with and without parts of the method - energy" \
    curves-method.png

# ---- guides ----------------------------------------------------------------------------
cat >ring.svg <<'SVG'
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><path fill-rule="evenodd"
 d="M50 4A46 46 0 1 1 49.9 4ZM50 30A20 20 0 1 1 49.9 30Z"/></svg>
SVG
cat >bow.svg <<'SVG'
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100" fill="none" stroke="black">
<path d="M5 85C20 20 60 10 95 40"/><path d="M30 98C45 70 70 70 95 85"/></svg>
SVG
cat >river.svg <<'SVG'
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 800 800" fill="none">
<path stroke="#3a7fb5" stroke-width="12" stroke-linecap="round"
 d="M-20 200C200 120 260 420 420 400S640 520 820 620"/></svg>
SVG
about="atan2(y-h/2,x-w/2)*180/pi"
size="--size 800x800 --seed 7"
tz arrange mud.svg --as curves -o guide1.svg --size 400x400 --tile --seed 5
tz arrange vine.svg --as curves -o guide2.svg $size --domain ring.svg --field "$about"
tz arrange grain.svg --as curves -o guide3.svg $size --field bow.svg
tz arrange streets.svg --as curves -o guide4.svg --size 800x800 --seed 3 --field "$about"
tz arrange streets.svg --as curves -o guide5.svg $size --given river.svg
tz arrange mud.svg --as curves -o guide6.svg $size --given river.svg
rsvg-convert -w 480 guide1.svg -o tile_mud.png
{
    svg 960 960
    for at in 0,0 480,0 0,480 480,480; do
        echo "<image xlink:href='tile_mud.png' x='${at%,*}' y='${at#*,}' width='480'
            height='480'/>"
    done
    echo "</svg>"
} >guide1.svg
for i in 1 2 3 4 5 6; do
    picture guide$i 960
done
sheet curves-guides 3 480x480 "--tile, twice each way|--domain and --field, a ring|--field, \
two strokes|--field, a formula|--given, a river|--given, a river" guide{1,2,3,4,5,6}.png

# ---- predictions -----------------------------------------------------------------------
cat >hole.svg <<'SVG'
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 400 400"><path
 d="M205 95C285 90 318 150 310 210S250 305 190 300S85 250 92 185S140 99 205 95Z"/></svg>
SVG
cat >here.svg <<'SVG'
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 400 400"><path
 d="M0 0H400V400H0ZM80 80V320H330V80Z" fill-rule="evenodd"/></svg>
SVG
for name in streets mud; do
    "$build/tests/draw_curves" hole -o hole_$name.svg $name.svg hole.svg
    tz arrange hole_$name.svg -o whole_$name.svg --complete hole.svg --seed 3
    tz arrange hole_$name.svg -o cloned_$name.svg --clone here.svg --to hole.svg --seed 3
    for kind in hole whole cloned; do
        picture ${kind}_$name 640
    done
done
sheet curves-predict 3 480x480 "a drawing with a hole|--complete|--clone, like the rim" \
    {hole,whole,cloned}_streets.png {hole,whole,cloned}_mud.png
