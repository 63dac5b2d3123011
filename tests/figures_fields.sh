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

# ---- shapes and their strokes ------------------------------------------------------------
rm -f ./*-domain.svg
shape wreath "600 600" \
    "M300 30A270 270 0 1 1 299.9 30ZM300 170A130 130 0 1 1 299.900 170Z" \
    "<path d='M300 100A200 200 0 0 1 500 300'/><path d='M300 500A200 200 0 0 1 100 300'/>"
shape letter "600 600" \
    "M60 60H540V190H500C490 140 470 120 420 120H360V470C360 510 375 520 430 525V560H170V525C225 \
520 240 510 240 470V120H180C130 120 110 140 100 190H60Z" \
    "<path d='M110 90H490'/><path d='M300 130V540'/>"
shape fish "900 900" \
    "M60 450C140 300 330 240 520 300C600 326 660 370 710 412L850 260C815 390 815 510 850 640L710 \
488C660 530 600 574 520 600C330 660 140 600 60 450ZM210 385A30 30 0 1 0 210 445A30 30 0 1 0 210 \
385Z" \
    "<path d='M110 400C250 270 480 280 690 435' tz:class='size=0.7,1.1,0.8'/>
    <path d='M110 500C250 630 480 620 690 465' tz:class='size=0.7,1.1,0.8'/>
    <path d='M725 435L835 315'/><path d='M725 465L835 585'/>"
full wreath garden.svg
full letter garden.svg
full fish garden.svg --trace fish.csv --frames fish_way.svg
sheet fields 3 640x640 "strokes in a ring|in a letter|in a fish|the things of a garden, along \
them||" wreath-drawn.png letter-drawn.png fish-drawn.png wreath.png letter.png fish.png

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
full dense garden.svg $size --mix "sprig size=0.6..1.6, bead size=0.4..1.5" --count 220
# a whirl of vectors: red is x, green is y
cat >whirl.svg <<'SVG'
<svg xmlns="http://www.w3.org/2000/svg" width="256" height="256"><defs>
<linearGradient id="x" x2="0" y2="1"><stop stop-color="#f00"/><stop offset="1" stop-color="#000"/>
</linearGradient><linearGradient id="y"><stop stop-color="#000"/><stop offset="1"
stop-color="#0f0"/></linearGradient></defs><rect width="256" height="256" fill="url(#x)"/><rect
width="256" height="256" fill="url(#y)" style="mix-blend-mode:screen"/></svg>
SVG
rsvg-convert -w 1200 whirl.svg -o whirl.png
tz fill current.svg -o whirled.svg $size --directions whirl.png --seed 3
picture whirled 1200
tz fill garden.svg -o mixed.svg $size --seed 3 --mix "leaf:3 size=0.6..1.6, bead:2 \
size=0.5..2.5, petal size=0.6..1.4, berry:2"
picture mixed 1200
tz fill "$pavement" -o stones.svg --size 1200x1200 --directions whirl.png --seed 3
tz render stones.svg -o stones.png
sheet fields-things 3 480x480 "strokes|ribbons that never bend|ribbons with rigidity=1|size=0.5 \
below, 1.8 above|density=1,0.1|--mix with sizes|--directions: an image|leaves along it|setts of \
a photo along it" stiff-drawn.png stiff.png soft.png sizes.png dense.png mixed.png whirl.png \
    whirled.png stones.png

# ---- how it comes about ------------------------------------------------------------------
# the layout after so many iterations
strip=() labels=
for i in 1 2 5 10 30 100; do
    f=$(printf 'fish_way-%03d' $i)
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
    printf "<text x=\"90\" y=\"405\">iterations: %d</text></svg>\n", rows }' fish.csv >energy.svg
picture energy 1200
sheet fields-way 3 480x480 "$labels" "${strip[@]}"
sheet fields-energy 1 1200x420 "energy of each term, by iteration" energy.png
