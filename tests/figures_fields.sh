# SPDX-License-Identifier: Apache-2.0
# The pictures of element fields; sourced by figures.sh, in its work folder.

for name in garden current hearts; do
    cp "$root/data/exemplars/$name.svg" .
done

# shape NAME VIEW PATH STROKES [GROUND] : NAME-domain.svg, NAME-field.svg, and both together
# as NAME-drawn.png
shape() {
    local head="<svg xmlns='http://www.w3.org/2000/svg' xmlns:tz='https://terrazzo.example/ns/1'
        viewBox='0 0 $2'>"
    local strokes="<g fill='none' stroke='#c03020' stroke-width='14' stroke-linecap='round'>$4</g>"
    [ -z "$3" ] || echo "$head<path fill-rule='evenodd' d='$3'/></svg>" >"$1-domain.svg"
    echo "$head$strokes</svg>" >"$1-field.svg"
    echo "$head<defs><marker id='head' markerWidth='4' markerHeight='4' refX='1.2' refY='1.5'
        orient='auto'><path d='M0 0L3 1.5L0 3Z' fill='#c03020'/></marker></defs>
        <style>g path{marker-end:url(#head)}</style><rect width='2000' height='2000'
        fill='#faf6ea'/><path fill-rule='evenodd' fill='#d8d2c0' d='$3'/>$strokes</svg>" |
        rsvg-convert -w 1200 -o "$1-drawn.png"
}
# full NAME PALETTE OPTION... : the palette's things in the shape along its strokes
full() {
    local name=$1 palette=$2
    shift 2
    set -- --field "$name-field.svg" "$@"
    [ ! -s "$name-domain.svg" ] || set -- --domain "$name-domain.svg" "$@"
    tz fill "$palette" -o "$name.svg" --seed 3 "$@"
    picture "$name" 1200
}

# inset NAME X Y : NAME.png with NAME-drawn.png in it, as NAME-both.png
inset() {
    echo "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink'
        viewBox='0 0 1200 1200'><image xlink:href='$1.png' width='1200' height='1200'/>
        <rect x='$2' y='$3' width='336' height='336' fill='#ffffff'/><image
        xlink:href='$1-drawn.png' x='$(($2 + 8))' y='$(($3 + 8))' width='320' height='320'/></svg>" \
        >"$1-both.svg"
    picture "$1-both" 1500
}
# mosaic NAME SHAPE PHOTO OPTION... : a photo's things in a shape that is drawn already
mosaic() {
    local name=$1 shape=$2 photo=$3
    shift 3
    tz fill "$photo" -o "$name.svg" --domain "$shape-domain.svg" --field "$shape-field.svg" \
        --seed 3 --size 1500x1500 "$@"
    tz render "$name.svg" -o "$name.png"
}

# ---- shapes and their strokes ------------------------------------------------------------
rm -f ./*-domain.svg
shape wreath "600 600" \
    "M300 30A270 270 0 1 1 299.9 30ZM300 170A130 130 0 1 1 299.900 170Z" \
    "<path d='M300 100A200 200 0 0 1 500 300'/><path d='M300 500A200 200 0 0 1 100 300'/>"
shape elephant "600 600" \
    "M48 330C48 220 120 150 242 146C316 144 370 156 404 168C444 126 524 136 550 194C571 246 562 303 \
566 365C569 412 576 443 592 469C599 490 566 511 550 488C524 448 516 406 512 364C503 338 482 333 464 \
338C453 374 457 416 459 469L463 566H390L384 459C382 438 369 435 367 459L371 566H301L292 459C284 433 \
255 433 249 459L245 566H174L170 459C168 438 155 438 153 459L149 566H78L74 469C58 424 48 384 48 330ZM\
494 208A13 13 0 1 0 494.100 208Z" \
    "<path d='M95 350C130 180 320 190 420 215C540 205 535 310 552 420' tz:class='size=1,1,1,0.6'/>
    <path d='M112 420L113 530' tz:class='size=0.8'/><path d='M210 420L209 530' tz:class='size=0.8'/>
    <path d='M334 420L336 530' tz:class='size=0.8'/><path d='M422 400L426 530' tz:class='size=0.8'/>"
shape tree "600 600" \
    "M250 578C268 520 272 470 268 420C190 450 90 420 80 340C20 310 20 210 90 180C95 90 190 40 270 75\
C320 20 440 35 465 110C550 120 590 220 535 285C545 380 440 445 335 420C331 470 335 520 352 578Z" \
    "<path d='M301 565V450' tz:class='size=0.7'/><path d='M302 400V110'/>
    <path d='M296 410C280 340 210 310 110 290'/><path d='M306 410C330 340 400 300 500 250'/>
    <path d='M290 330C250 240 210 190 175 125'/><path d='M314 330C350 240 390 180 425 115'/>"
full wreath garden.svg --size 800x800
full elephant garden.svg --size 1200x1200
full tree garden.svg --size 900x900 --trace tree.csv --frames tree_way.svg
for name in pebbles stones; do
    cp "$root/data/exemplars/$name.png" "drawn_$name.png"
done
mosaic stone_wreath wreath "$cells"
mosaic stone_elephant elephant drawn_stones.png
mosaic stone_tree tree drawn_pebbles.png
inset wreath 432 432
inset elephant 16 16
inset tree 16 848
sheet fields 3 640x640 "a few strokes, and the things of a garden along them|||stones of \
pictures, pixels and all||" wreath-both.png elephant-both.png tree-both.png \
    stone_wreath.png stone_elephant.png stone_tree.png

# stones of a photo, near by
tz render stone_wreath.svg -o near1.png --crop 100,100,600,600
tz render stone_tree.svg -o near2.png --crop 700,250,600,600
sheet fields-photo 3 560x560 "a photo (CC0)|its stones, full size|pebbles, full size" \
    "$cells" near1.png near2.png

# ---- strokes that overlap and contradict each other --------------------------------------
shape overlapping "600 600" "" \
    "<path d='M40 520C200 460 300 300 326 90' stroke-width='28' tz:class='size=1.3'/>
    <path d='M40 120C240 150 420 260 520 460' stroke-width='28' tz:class='size=0.7'/>
    <path d='M60 330C220 300 400 330 510 280' stroke-width='28'/>"
shape intertwined "600 600" "" \
    "<path d='M30 200C120 60 210 60 300 300S480 540 570 400'/>
    <path d='M30 400C120 540 210 540 300 300S480 60 570 200'/>
    <path d='M30 300H570' tz:class='size=0.7'/>"
shape distorted "600 600" "" \
    "<path d='M60 540C60 60 560 40 520 300S200 540 200 330S420 180 400 320S300 400 310 320'/>"
for name in overlapping intertwined distorted; do
    full $name garden.svg --size 800x800 --mix "leaf:2, sprig:2, petal, bead:2, berry:2"
done
sheet fields-strokes 3 560x560 "strokes lie over each other|cross and cross again|turn about \
themselves|later ones have their say||" overlapping-drawn.png intertwined-drawn.png \
    distorted-drawn.png overlapping.png intertwined.png distorted.png

# ---- ten cases ---------------------------------------------------------------------------
mkdir -p cases
"$build/tests/bench_fill" cases cases "" 1 >cases/figures.txt
pairs=() labels=
for name in sparse-leaves dense-mix crossing-leaves circular-bars singular-leaves ring-drops \
    letter-soft animal-leaves mixed-sizes soft-bars; do
    for way in two-step ours; do # a thin line, so that things that touch are told apart
        sed 's/fill="#\(4a8f3c\|c8553d\|588b8b\|f28f3b\)"/& stroke="#000" stroke-opacity=".5" stroke-width=".5"/g' \
            "cases/$name-$way.svg" | rsvg-convert -b white -w 880 -o "cases/$name-$way.png"
        pairs+=("cases/$name-$way.png")
        labels+="${labels:+|}$name, $way"
    done
done
sheet fields-cases 4 320x320 "$labels" "${pairs[@]}"

# ---- what strokes and mixes say ----------------------------------------------------------
wave="<path d='M30 420C160 60 300 60 330 300S480 560 570 180'/>"
size="--size 600x600"
for name in stiff soft; do
    shape $name "600 600" "" "$wave"
done
shape sizes "600 600" "" \
    "<path d='M30 480C200 430 400 430 570 480' tz:class='size=0.5'/>
    <path d='M30 120C200 170 400 170 570 120' tz:class='size=1.8'/>"
shape dense "600 600" "" \
    "<path d='M60 540C120 300 300 120 540 60' tz:class='density=1,0.1'/>"
full stiff garden.svg $size --mix "ribbon, berry:3"
full soft garden.svg $size --mix "ribbon rigidity=1, berry:3"
full sizes garden.svg $size --mix "leaf, sprig, petal, bead"
full dense garden.svg $size --mix "sprig size=0.6..0.9, bead size=0.4..0.8"
full mixed garden.svg $size --mix "leaf:3 size=0.6..1.6, bead:2 size=0.5..2.5, petal \
size=0.6..1.4, berry:2" --field stiff-field.svg
sheet fields-things 3 480x480 "strokes|ribbons that never bend|ribbons with rigidity=1|size=0.5 \
below, 1.8 above|density=1,0.1, from below to above|--mix with sizes" stiff-drawn.png stiff.png \
    soft.png sizes.png dense.png mixed.png

# ---- vectors of an image as things -------------------------------------------------------
# two whirls in a stream: red is x, green is y, half is 0
awk 'BEGIN { n = 160; print "P3", n, n, 255 >"stream.ppm"
    head = "<svg xmlns=\"http://www.w3.org/2000/svg\" shape-rendering=\"crispEdges\" viewBox="
    printf "%s\"0 0 %d %d\">", head, n, n >"stream.svg"
    for (j = 0; j < n; j++) for (i = 0; i < n; i++) {
        x = (i + 0.5) / n; y = (j + 0.5) / n; u = 0.25; v = 0
        for (k = -1; k <= 1; k += 2) {
            dx = x - 0.5 - 0.2 * k; dy = y - 0.5 + 0.12 * k; w = k * exp(-30 * (dx * dx + dy * dy))
            u -= 4.2 * w * dy; v += 4.2 * w * dx }
        r = int(127.5 + 127 * u); g = int(127.5 + 127 * v)
        print r, g, 128 >"stream.ppm"
        printf "<path fill=\"#%02x%02x80\" d=\"M%d %dh1v1h-1Z\"/>", r, g, i, j >"stream.svg" }
    print "</svg>" >"stream.svg" }'
picture stream 1200
tz fill garden.svg -o streaming.svg $size --mix sprig --directions stream.ppm \
    --lengths 0.35,1.2 --ramp viridis --ramp-by length --seed 3
tz fill garden.svg -o pointing.svg $size --mix "leaf size=0.7" --directions stream.ppm \
    --ramp hue --seed 3
picture streaming 1200
picture pointing 1200
sheet fields-vectors 3 560x560 "vectors as an image|--lengths, --ramp viridis|--ramp hue: which \
way they point" stream.png streaming.png pointing.png

# ---- how it comes about ------------------------------------------------------------------
# the layout after so many iterations
strip=() labels=
for i in 1 2 5 10 30 100; do
    f=$(printf 'tree_way-%03d' $i)
    [ -s "$f.svg" ] || continue
    picture "$f" 640
    strip+=("$f.png")
    labels+="${labels:+|}iteration $i"
done
# plot : the columns of a trace as lines, logarithmic
awk -F, 'NR == 1 { n = split($0, name); next }
{ for (k = 2; k <= 9; k++) if ($k > 0) { v[NR - 1, k] = $k
    if (!hi || $k > hi) hi = $k
    if (!lo || $k < lo) lo = $k } rows = NR - 1 }
END {
    split("- #203a5a #c03020 #2a8a4a #b07a10 #7a3a9a #2f6f7e #e2695c #8aa64f", ink, " ")
    if (lo < hi / 1e6) lo = hi / 1e6
    print "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1200\" height=\"420\"" \
        " font-family=\"sans-serif\" font-size=\"18\"><rect width=\"1200\" height=\"420\"" \
        " fill=\"#ffffff\"/>"
    for (d = 1e-6; d < 1e9; d *= 10) if (d >= lo && d <= hi) {
        y = 20 + 350 * log(hi / d) / log(hi / lo)
        printf "<path stroke=\"#cccccc\" d=\"M90 %.1fH980\"/><text x=\"8\" y=\"%.1f\">%g</text>\n", \
            y, y + 6, d }
    for (k = 2; k <= 9; k++) {
        printf "<path fill=\"none\" stroke-width=\"2.5\" stroke=\"%s\" d=\"", ink[k]
        pen = "M"
        for (i = 1; i <= rows; i++) if (v[i, k] >= lo) {
            printf "%s%.1f %.1f", pen, 90 + 890 * (i - 1) / (rows - 1), \
                20 + 350 * log(hi / v[i, k]) / log(hi / lo)
            pen = "L" }
        printf "\"/><text x=\"1000\" y=\"%d\" fill=\"%s\">%s</text>\n", 24 * k, ink[k], name[k] }
    printf "<text x=\"90\" y=\"405\">iterations: %d</text></svg>\n", rows }' tree.csv >energy.svg
picture energy 1200
sheet fields-way 3 480x480 "$labels" "${strip[@]}"
sheet fields-energy 1 1200x420 "energy of each term, by iteration" energy.png
