#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Measures speed and quality against the rivals, in one run, side by side.
#
#   tests/bench.sh BUILDDIR [SECTION...]
#
# Sections: analyze, edges, render, arrange, expand, scores, elements (growth, the energy
# solver), likeness (layouts of elements against their drawings), curves (layouts of curves
# against theirs, and lines of photos; speed), lines (photo to curves, against lines that are
# known), things (photo to elements),
# drawings (elements to pixels), fields (domains filled along strokes, against two steps), others (layout documents, the measures themselves); huge (32,768 x 32,768 px, writes some
# 8 GB) only where it is asked for. Times are medians of several runs. The figures also go to
# BUILDDIR/bench.json, where sections that are not run keep their last figures. Photos are
# those of TZ_PHOTOS (a folder), else ../shared/exemplars/photos beside the repository, else
# those of the demo, else the exemplars that Terrazzo draws.
# shellcheck disable=SC2317 # sections are called by their names
set -u
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "${1:?use: tests/bench.sh BUILDDIR [SECTION...]}" && pwd) || exit 1
shift
sections=("$@")
[ ${#sections[@]} -gt 0 ] || sections=(analyze edges render arrange expand scores elements likeness
    curves lines things drawings fields others)
terrazzo=$build/bin/terrazzo
tools=$build/tests
out=$build/bench
cache=$build/cache/gmic
mkdir -p "$out" "$cache" || exit 1
# shellcheck source=/dev/null
. "$here/photos.sh"
[ -x "$terrazzo" ] || { echo "bench: $terrazzo is not there; build it first" >&2; exit 1; }
failed=0

# ---- helpers -------------------------------------------------------------------------

find_photos() {
    local folder=${TZ_PHOTOS:-$here/../../shared/exemplars/photos}
    if [ ! -d "$folder" ]; then
        folder=$build/cache/photos
        fetch_photos "$folder" >/dev/null || folder=$here/../data/exemplars
    fi
    shopt -s nullglob
    photos=("$folder"/*.jpg "$folder"/*.png)
    [ ${#photos[@]} -gt 0 ] || { echo "bench: no photos in $folder" >&2; exit 1; }
}

# photo PATTERN... : the first photo whose name matches one of them, else the first of all
photo() {
    local p wanted
    for wanted in "$@"; do
        for p in "${photos[@]}"; do
            # shellcheck disable=SC2254 # a pattern
            case $(basename "$p") in $wanted) echo "$p"; return ;; esac
        done
    done
    echo "${photos[0]}"
}

# the rival; status 1 where it cannot be had
need_gmic() {
    command -v gmic >/dev/null && return
    command -v apt-get >/dev/null || return 1
    local sudo=()
    [ "$(id -u)" -eq 0 ] || sudo=(sudo -n)
    echo "bench: installing gmic"
    "${sudo[@]}" apt-get update -qq >/dev/null 2>&1
    DEBIAN_FRONTEND=noninteractive "${sudo[@]}" apt-get install -y -qq \
        --no-install-recommends gmic >/dev/null 2>&1
    command -v gmic >/dev/null
}

# gmic_cached PHOTO : G'MIC's 2048 x 2048 texture of it, made once; sets $picture
gmic_cached() {
    local key
    key=$(sha256sum "$1" | cut -c1-24)
    picture=$cache/$key.png
    [ -s "$picture" ] && return
    "$tools/bench_run" 1 gmic "$1" syntexturize_matchpatch 2048,2048 -o "$cache/part.png" \
        >"$cache/$key.time" && mv "$cache/part.png" "$picture"
}

# number NAME JSON : the first number of that name
number() {
    printf '%s\n' "$2" | sed -n "s/^ *\"$1\": \([-+0-9.eE]*\),*\$/\1/p" | head -n 1
}

# rows SECTION FIELD... <<< lines : lines of blank-separated fields to a JSON array
rows() {
    local section=$1
    shift
    awk -v names="$*" 'BEGIN { n = split(names, name, " "); printf "[" }
        { printf "%s\n    {", (NR > 1 ? "," : "")
          for (i = 1; i <= n; i++) {
              v = $i ~ /^[-+]?[0-9][0-9.]*([eE][-+]?[0-9]+)?$/ ? $i \
                  : $i == "" || $i == "-" ? "null" : "\"" $i "\""
              printf "%s\"%s\": %s", (i > 1 ? ", " : ""), name[i], v }
          printf "}" }
        END { printf "]" }' >"$out/$section.json"
}

machine() {
    local cpu
    cpu=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo 2>/dev/null | head -n 1)
    printf '%s, %s threads, %s GiB, load %s' "${cpu:-$(uname -m)}" "$(nproc)" \
        "$(awk '/MemTotal/ { printf "%.0f", $2 / 1048576 }' /proc/meminfo)" \
        "$(cut -d' ' -f1 /proc/loadavg)"
}

title() { printf '\n%s\n' "$1"; }

# ---- sections ------------------------------------------------------------------------

bench_analyze() {
    title "analyze: photo to exemplar, in memory, edges by the forest (goals: 512 x 512
under 0.15 s, of that the forest under 0.08 s)"
    local p side to cut=() lines
    for p in "$(photo 'gravel*' 'stones*')" "$(photo 'cobble*' 'rocks*' 'bricks*')" \
        "$(photo 'pebbles*' 'mossy*' 'mud*')"; do
        for side in 512 1024; do
            to=$out/$(basename "${p%.*}")-$side.png
            "$tools/bench_cut" "$p" "$side" 0 "$to" && cut+=("$to")
        done
    done
    lines=$("$tools/bench_analyze" "${cut[@]}") || return 1
    printf '%s\n' "$lines" | awk '{
        sub(/.*\//, "", $2); split($3, s, "x")
        goal = s[1] > 512 ? "-" : $NF < 0.15 && $(NF - 1) < 0.08 ? "met" : "MISSED"
        gsub(/[(,]/, "", $4); print $2, s[1], $4, $6, $(NF - 1), $NF, goal }' |
        tee "$out/lines" | awk 'BEGIN {
            printf "  %-34s %6s %7s %7s %9s %9s  %s\n", "photo", "side", "groups", "edges",
                "forest s", "all s", "goal" }
            { printf "  %-34s %6d %7d %7d %9.4f %9.4f  %s\n", $1, $2, $3, $4, $5, $6, $7 }'
    rows analyze photo side groups edges forest seconds goal <"$out/lines"
}

bench_edges() {
    title "edges: boundaries found against known ones, 130 scenes that no detector was trained on
and parts of photos drawn by hand; tolerance 0.0075 of the diagonal, each rival at its best setting
(goals: the forest's ODS on scenes 0.80 and 0.10 above every rival's, on photos above)"
    local folder model=$here/../data/edge-forest.yml.gz options=(--scenes 130 --seed 1000000)
    if [ -s "$model" ]; then
        options+=(--model "$model")
    else
        echo "  data/edge-forest.yml.gz is not there: the forest is left out"
    fi
    folder=$(dirname "${photos[0]}")
    options+=(--truth "$here/truth" --photos "$folder")
    "$tools/bench_edges" "${options[@]}" | cut -d' ' -f2- >"$out/lines"
    [ "${PIPESTATUS[0]}" -eq 0 ] || return 1
    awk '{ if ($1 != set) print ""
          if (!set) printf "  %-26s %8s %-14s %-12s %6s %6s %6s %9s\n", "set", "pictures",
              "detector", "setting", "ODS", "OIS", "AP", "s"
          set = $1
          printf "  %-26s %8d %-14s %-12s %6.3f %6.3f %6.3f %9.4f\n", $1, $2, $3, $4, $5, $6, $7, $8
          if ($1 != "scenes" && $1 != "photos") next
          if ($3 == "forest") forest[$1] = $5
          else if ($3 != "forest-opencv" && $5 > rival[$1]) rival[$1] = $5 }
        END { print ""
            for (s in forest) {
                more = s == "scenes" ? 0.10 : 0
                met = forest[s] > rival[s] + more && (s != "scenes" || forest[s] >= 0.80)
                printf "  %s: forest %.3f, best of the others %.3f: %s\n", s, forest[s],
                    rival[s], (met ? "met" : "MISSED") } }' "$out/lines"
    rows edges set pictures detector setting ods ois ap seconds <"$out/lines"
}

bench_render() {
    title "render: layout to pixels, in memory; ours against the calls of stock cv::seamlessClone
one by one (goals: 2048 x 2048 of 360 groups 20 times as fast; 120 to 3,600 groups within 1.5)"
    "$tools/bench_render" "$(photo 'cobble*' 'rocks*' 'stones*')" 11 >"$out/lines" || return 1
    awk 'BEGIN { printf "  %-9s %5s %7s %5s %9s %9s %9s %9s %9s %9s %7s\n", "layout", "side",
                 "groups", "box", "channels", "ours s", "cpu s", "ns/px", "stock s", "cpu s", "times" }
        { key = $2 " " $3 " " $4 " " $5 " " $6
          if (!(key in ours) && !(key in stock)) order[++n] = key
          if ($7 == "ours") { ours[key] = $8; cpu[key] = $9 }
          else { stock[key] = $8; stock_cpu[key] = $9 } }
        END { for (k = 1; k <= n; k++) {
            key = order[k]; split(key, f, " ")
            printf "  %-9s %5d %7d %5d %9d %9.4f %9.4f %9.2f", f[1], f[2], f[3], f[4], f[5],
                ours[key], cpu[key], 1e9 * cpu[key] / (f[2] * f[2])
            if (key in stock)
                printf " %9.3f %9.3f %7.1f", stock[key], stock_cpu[key], stock[key] / ours[key]
            print ""
            if (f[1] == "cover" && f[5] == 3 && f[2] == 2048) {
                if (!lo || ours[key] < lo) lo = ours[key]
                if (ours[key] > hi) hi = ours[key]
                if (f[3] == 360) times = stock[key] / ours[key] }
            if (f[1] == "cover" && f[5] == 3 && f[3] ~ /^(90|360|1440)$/) {
                px = ours[key] / (f[2] * f[2])
                if (!least || px < least) least = px
                if (px > most) most = px }
            if (f[1] == "loose") loose = stock[key] / ours[key] }
            printf "  360 groups: %.0f times as fast (loose: %.0f): %s; 120..3,600 groups: slowest / fastest %.2f: %s\n",
                times, loose, (times >= 20 && loose >= 20 ? "met" : "MISSED"), hi / lo,
                (hi / lo <= 1.5 ? "met" : "MISSED")
            printf "  1024 to 4096 px a side: time a pixel, slowest / fastest %.2f\n", most / least }' \
        "$out/lines"
    cut -d' ' -f2- "$out/lines" >"$out/lines2"
    rows render layout side groups box channels method seconds cpu <"$out/lines2"
}

bench_arrange() {
    title "arrange: 2048 x 2048 px, alone"
    local p
    for p in "$(photo 'gravel*' 'stones*')" "$(photo 'cobble*' 'rocks*' 'bricks*')"; do
        "$tools/bench_arrange" "$p" 2048 5 || return 1
    done | cut -d' ' -f2- >"$out/lines"
    awk 'BEGIN { printf "  %-28s %7s %10s %9s %9s %13s\n", "photo", "threads", "placements", "s",
                 "cpu s", "placements/s" }
        { printf "  %-28s %7d %10d %9.3f %9.3f %13.0f\n", $1, $3, $4, $5, $6, $4 / $5 }' \
        "$out/lines"
    rows arrange photo side threads placements seconds cpu peak_mib <"$out/lines"
}

bench_expand() {
    title "expand: whole command, files in and out, 512 x 512 to 2048 x 2048 PNG, against
gmic syntexturize_matchpatch (goal: 10 times as fast); gmic is timed now, once a photo"
    local p channels name input ours theirs gmic=yes
    need_gmic || { gmic=; echo "  gmic cannot be had: its column stays empty"; }
    : >"$out/lines"
    for name in 'gravel* stones*:1' 'brick*:1' 'cobble* rocks* bricks*:3' 'pebbles* mossy* mud*:3'; do
        channels=${name#*:}
        # shellcheck disable=SC2086
        p=$(set -f; photo ${name%:*})
        input=$out/$(basename "${p%.*}")-512-$channels.png
        "$tools/bench_cut" "$p" 512 "$channels" "$input" || return 1
        ours=$("$tools/bench_run" 7 "$terrazzo" expand "$input" -o "$out/ours.png" --size \
            2048x2048 --seed 7 --quiet) || { echo "  terrazzo failed on $input"; return 1; }
        theirs='- - -'
        [ -n "$gmic" ] && theirs=$("$tools/bench_run" 1 gmic "$input" \
            syntexturize_matchpatch 2048,2048 -o "$out/gmic.png")
        echo "$(basename "${p%.*}") $channels $ours ${theirs:-- - -}" >>"$out/lines"
    done
    awk 'BEGIN { printf "  %-22s %8s | %7s %7s %8s | %7s %7s %8s | %6s\n", "photo", "channels",
                 "ours s", "cpu s", "MiB", "gmic s", "cpu s", "MiB", "times" }
        { printf "  %-22s %8d | %7.3f %7.3f %8d | %7s %7s %8s | ", $1, $2, $3, $4, $5, $6, $7, $8
          if ($6 == "-") print "-"
          else { t = $6 / $3; printf "%6.1f %s\n", t, (t >= 10 ? "met" : "MISSED") } }' "$out/lines"
    rows expand photo channels seconds cpu peak_mib gmic_seconds gmic_cpu gmic_peak_mib \
        <"$out/lines"
}

# figures PHOTO OUTPUT : score patch sharpness repetition seam broken
figures() {
    local json key v line=
    json=$("$terrazzo" compare "$1" "$2" --json --quiet 2>/dev/null) || json=
    for key in score patch sharpness repetition seam broken; do
        v=$(number "$key" "$json")
        line+="${v:--} "
    done
    echo "$line"
}

bench_scores() {
    title "scores: 2048 x 2048 of each photo, by terrazzo compare (goals: higher than gmic's on 12
of 15; patch ratio under 1.5 in the mean, sharpness 0.9 to 1.1; at four times the exemplar's
area repetition under 0.10)"
    local p theirs gmic=yes
    need_gmic || { gmic=; echo "  gmic cannot be had: its columns stay empty"; }
    [ -n "$gmic" ] && echo "  (gmic's pictures are made once a photo and kept in $cache)"
    : >"$out/lines"
    printf '  %-21s|%-37s |%-37s | %-4s |%s\n' '' ' ours' " gmic's" '' ' ours, 4 x the area'
    printf '  %-21s|%6s %6s %5s %5s %5s %5s |%6s %6s %5s %5s %5s %5s | %-4s |%6s %6s %5s %5s\n' \
        photo score patch sharp rep. seam brok. score patch sharp rep. seam brok. best \
        score patch sharp rep.
    for p in "${photos[@]}"; do
        if ! "$terrazzo" expand "$p" -o "$out/ours.png" --size 2048x2048 --seed 7 --quiet ||
            ! "$terrazzo" expand "$p" -o "$out/grown.png" --grow 2 --seed 7 --quiet; then
            echo "  terrazzo failed on $p"
            failed=1
            continue
        fi
        theirs='- - - - - -'
        [ -n "$gmic" ] && gmic_cached "$p" && theirs=$(figures "$p" "$picture")
        echo "$(basename "${p%.*}") $(figures "$p" "$out/ours.png") $theirs" \
            "$(figures "$p" "$out/grown.png")" >>"$out/lines"
        tail -n 1 "$out/lines" | awk '{
            printf "  %-21s|%6.1f %6.2f %5.2f %5.3f %5.3f %5.2f |", $1, $2, $3, $4, $5, $6, $7
            if ($8 == "-") printf "%6s %6s %5s %5s %5s %5s | %-4s |", "-", "-", "-", "-", "-", "-", "-"
            else printf "%6.1f %6.2f %5.2f %5.3f %5.3f %5.2f | %-4s |", $8, $9, $10, $11, $12, $13,
                ($2 > $8 ? "ours" : "gmic")
            printf "%6.1f %6.2f %5.2f %5.3f\n", $14, $15, $16, $17 }'
    done
    awk '{ n++; if ($8 != "-") { m++; wins += $2 > $8; theirs += $8 }
           ours += $2; patch += $3; grown += $15; worst = $17 > worst ? $17 : worst
           repeat += $17 < 0.10
           for (k = 4; k <= 16; k += 12) {
               if (!lo[k] || $k < lo[k]) lo[k] = $k
               if ($k > hi[k]) hi[k] = $k } }
        END { if (!n) exit
            if (m) printf "  ours higher on %d of %d: %s (mean %.1f against %.1f)\n", wins, m,
                (wins >= 0.8 * m ? "met" : "MISSED"), ours / n, theirs / m
            printf "  2048 x 2048: mean patch ratio %.2f: %s; sharpness %.2f to %.2f: %s\n", patch / n,
                (patch / n < 1.5 ? "met" : "MISSED"), lo[4], hi[4],
                (lo[4] >= 0.9 && hi[4] <= 1.1 ? "met" : "MISSED")
            printf "  four times the area: mean patch ratio %.2f: %s; sharpness %.2f to %.2f: %s; repetition under 0.10 on %d of %d, worst %.3f: %s\n",
                grown / n, (grown / n < 1.5 ? "met" : "MISSED"), lo[16], hi[16],
                (lo[16] >= 0.9 && hi[16] <= 1.1 ? "met" : "MISSED"), repeat, n, worst,
                (worst < 0.10 ? "met" : "MISSED") }' "$out/lines"
    rows scores photo score patch sharpness repetition seam broken gmic_score gmic_patch \
        gmic_sharpness gmic_repetition gmic_seam gmic_broken grown_score grown_patch \
        grown_sharpness grown_repetition grown_seam grown_broken <"$out/lines"
}

bench_others() {
    title "others: layout documents of 300,000 placements; the measures of terrazzo compare"
    { "$tools/bench_layout" && "$tools/bench_quality"; } >"$out/lines" || return 1
    sed 's/^/  /' "$out/lines"
    sed 's/\\/\\\\/g; s/"/\\"/g; s/.*/"&"/' "$out/lines" | paste -sd, - | sed 's/.*/[&]/' \
        >"$out/others.json"
}

bench_elements() {
    title "elements: region growing to 10,000, one core (goal: 100,000 elements/s at 2 rings, local)"
    "$tools/bench_elements" >"$out/lines" || return 1
    awk 'BEGIN { printf "  %-11s %8s %5s %8s %9s %9s %11s\n", "exemplar", "elements", "rings",
               "optimise", "grown", "begin ms", "elements/s" }
         { printf "  %-11s %8d %5d %8s %9d %9.1f %11d%s\n", $2, $3, $4, $5, $6, 1000 * $7, $9,
               ($2 == "hexagonal" && $5 == "local" ? ($9 >= 100000 ? " met" : " MISSED") : "") }' \
        "$out/lines"
    rows elements exemplar sources rings optimise grown begin seconds rate \
        < <(cut -d' ' -f2- "$out/lines")
    echo
    echo "  energy solver (goals: 1,000 elements 5 ms an iteration; 100,000 under 1 s, 500 MB)"
    "$tools/bench_energy" | sed 's/^/  /'
    echo
    echo "  mean neighbourhood distance over time ([Dav19] Fig. 17): $out/distance.svg"
    "$tools/bench_elements" distance "$out/distance" | sed 's/^/  /'
}

bench_likeness() {
    title "likeness: layouts of nine times the area against their drawings, as compare measures
(goals: mean ratio under 1.3, density within 5 %, overlaps and widest hole no more than the drawing's)"
    local f name json folder=$here/../../shared/exemplars/svg
    shopt -s nullglob
    : >"$out/lines"
    for f in "$folder"/*.svg "$here"/../data/exemplars/{chips,current,hearts,noodles}.svg; do
        name=$(basename "${f%.svg}")
        "$terrazzo" arrange "$f" -o "$out/$name-layout.svg" --grow 3 --quiet &&
            json=$("$terrazzo" compare "$f" "$out/$name-layout.svg" --json) || return 1
        echo "$name $(number mean "$json") $(number nearest "$json")" \
            "$(number correlation "$json") $(number ring-1 "$json") $(number ring-2 "$json")" \
            "$(number ring-3 "$json") $(number classes "$json") $(number orientation "$json")" \
            "$(number density "$json") $(number overlaps-exemplar "$json")" \
            "$(number overlaps "$json") $(number hole-exemplar "$json")" \
            "$(number hole "$json")" >>"$out/lines"
    done
    awk 'BEGIN { printf "  %-24s %6s %7s %7s %6s %6s %6s %7s %7s %7s %13s %13s  %s\n", "drawing",
                 "mean", "nearest", "pairs", "ring 1", "2", "3", "classes", "turned", "density",
                 "overlaps", "hole", "goals" }
         { met = $2 < 1.3 && $10 > 0.95 && $10 < 1.05 && $12 <= $11 + 0.005 && $14 <= 1.02 * $13
           count += met; means += $2 < 1.3
           printf "  %-24s %6.3f %7.2f %7.2f %6.2f %6.2f %6.2f %7.2f %7.2f %7.3f %6.3f %6.3f %6.1f %6.1f  %s\n",
               $1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, met ? "met" : "MISSED" }
         END { printf "  %d of %d meet all; mean ratio under 1.3: %d (goal: 8)\n", count, NR, means }' \
        "$out/lines"
    rows likeness drawing mean nearest correlation ring1 ring2 ring3 classes orientation \
        density overlaps_exemplar overlaps hole_exemplar hole <"$out/lines"
}

# curve_row NAME EXEMPLAR LABEL OPTION... : one line of figures of a layout of four times the
# area
curve_row() {
    local made json seconds
    made=$("$terrazzo" arrange "$2" --as curves -o "$out/$1-$3.svg" --grow 2 \
        "${@:4}" --quiet --json 2>"$out/errors") || {
        printf '  %-24s %s\n' "$1" "$(head -n 1 "$out/errors")" >&2
        return 1
    }
    json=$("$terrazzo" compare "$2" "$out/$1-$3.svg" --as curves --json) || return 1
    seconds=$(number total "$made")
    echo "$1 $3 $seconds $(number mean "$json") $(number length-exemplar "$json")" \
        "$(number length "$json") $(number dangling-exemplar "$json")" \
        "$(number dangling "$json") $(number degree-off "$json")" \
        "$(number repeats-exemplar "$json") $(number repeats "$json")"
}

# drawings of lines, and the lines of photos (made once)
curve_exemplars() {
    local f to name folder=$here/../../shared/exemplars/svg
    for name in lattice_stained_glass network_circuit_board network_streets_chicago \
        contours_topography wood_grain gears_floating_cogs memphis_mixed; do
        [ ! -f "$folder/$name.svg" ] || echo "$folder/$name.svg"
    done
    for name in noodles current streets circuit contours grain mud vine; do
        echo "$here/../data/exemplars/$name.svg"
    done
    for f in "${photos[@]}"; do
        name=$(basename "${f%.*}")
        case $name in
        cracked_rock | veined_slate | onyx_swirl | stone_wall | brick_gray | \
            volcanic_stone_cells | mossy_rock_slabs | cobblestone_pavement)
            to=$out/lines-$name.svg
            "$terrazzo" analyze "$f" --as curves -o "$to" --quiet 2>/dev/null
            [ ! -s "$to" ] || echo "$to" ;;
        esac
    done
}

bench_curves() {
    title "curves: layouts of four times the area against their drawings and the lines of photos, as
compare measures (goals: mean ratio under 1.3, length per area within 5 %, no more dangling
ends per length, node degrees within 5 %)"
    local f method seconds exemplars
    mapfile -t exemplars < <(curve_exemplars)
    : >"$out/lines"
    for f in "${exemplars[@]}"; do
        for method in auto optimise; do
            curve_row "$(basename "${f%.svg}")" "$f" "$method" --curve-method "$method" \
                >>"$out/lines" || break
        done
    done
    # parts of the optimiser left out ([Tu20] Fig. 14, 16)
    for f in "${exemplars[@]:0:3}"; do
        for method in edges robust existence detail finish; do
            curve_row "$(basename "${f%.svg}")" "$f" "no-$method" --curve-method optimise \
                "--no-curve-$method" >>"$out/lines"
        done
        curve_row "$(basename "${f%.svg}")" "$f" noise --curve-method optimise \
            --curve-start noise >>"$out/lines"
    done
    awk 'BEGIN { printf "  %-26s %-12s %7s %6s %7s %17s %7s %15s  %s\n", "drawing", "method",
                 "s", "mean", "length", "dangling", "degrees", "repeats", "goals" }
         { length_ratio = $5 > 0 ? $6 / $5 : 0
           met = $4 < 1.3 && length_ratio > 0.95 && length_ratio < 1.05 &&
                 $8 <= $7 * 1.000001 && $9 <= 0.05
           count[$2] += met; means[$2] += $4 < 1.3; all[$2]++
           printf "  %-26s %-12s %7.2f %6.2f %7.3f %8.5f %8.5f %7.3f %7.3f %7.3f  %s\n", $1, $2, $3,
               $4, length_ratio, $7, $8, $9, $10, $11, met ? "met" : "MISSED" }
         END { for (m in all) printf "  %-12s %d of %d meet all; mean ratio under 1.3: %d\n", m,
                   count[m], all[m], means[m] | "sort" }' "$out/lines"
    rows curves drawing method seconds mean length_exemplar length dangling_exemplar \
        dangling degree_off repeats_exemplar repeats <"$out/lines"
    echo
    echo "  the optimiser (goals: about 750, 1,000, 1,300 samples of 20 to 30 neighbours in 1 s on
  2 cores, 20,000 samples under 30 s, linear)"
    "$tools/bench_curve_synthesis" "$here/../data/exemplars/noodles.svg" "${exemplars[0]}" \
        >"$out/lines-speed" || return 1
    sed 's/^curves synthesis /  /' "$out/lines-speed"
    sed -n 's/^curves synthesis \([^ ]*\) *x\([0-9.]*\) threads \([0-9]*\).* all \([0-9.]*\) s  cpu \([0-9.]*\) s  \([0-9.]*\) ms.*/\1 \2 \3 \4 \5 \6/p' \
        "$out/lines-speed" >"$out/lines-rows"
    rows curves-speed drawing grow threads seconds cpu ms_cpu_a_sample <"$out/lines-rows"
    echo
    "$tools/bench_curves" "${exemplars[0]}" | sed 's/^/  /'
}

bench_lines() {
    title "lines: photo to curves, against lines that are known, and two rivals, each at the best of
its settings (goals: F higher than theirs; 1024 x 1024 px under 1 s)"
    local p of=()
    for p in "$(photo 'cobble*' 'bricks*')" "$(photo 'cracked*' 'mud*')" \
        "$(photo 'stone_wall*' 'stones*')"; do
        of+=("$p")
    done
    "$tools/bench_lines" "${of[@]}" >"$out/lines" || return 1
    grep '^lines ' "$out/lines" | cut -d' ' -f2- >"$out/lines-truth"
    grep '^photo ' "$out/lines" | cut -d' ' -f2- >"$out/lines-photos"
    awk 'BEGIN { printf "  %-12s %-10s %-14s %6s %6s %6s %8s %8s %7s %8s\n", "set", "by",
                 "settings", "F", "prec.", "recall", "off px", "width", "pieces", "s" }
         { printf "  %-12s %-10s %-14s %6.3f %6.3f %6.3f %8.2f %8.3f %7d %8.4f\n", $1, $2, $3, $4,
               $5, $6, $7, $8, $9, $10
           if ($2 == "ridges") own[$1] = $4; else if ($4 > best[$1]) best[$1] = $4 }
         END { for (s in own) { n++; won += own[s] > best[s] }
               printf "  F higher than both on %d of %d sets: %s\n", won, n,
                   won == n ? "met" : "MISSED" }' "$out/lines-truth"
    awk '{ split($2, s, "x"); goal = s[1] * s[2] < 1e6 ? "" : $(NF - 1) < 1 ? "met" : "MISSED"
           printf "  %-26s %-10s %-5s %-5s %4d paths, %4.1f px wide, contrast %5.2f, joined %.2f  %6.3f s  cpu %6.3f s  %s\n",
               $1, $2, $4, $5, $6, $8, $10, $11, $12, $13, goal }' "$out/lines-photos"
    rows lines set by settings f precision recall off width pieces seconds <"$out/lines-truth"
    rows lines-photos photo size verdict line tone paths pieces width length contrast joined \
        seconds cpu <"$out/lines-photos"
}

bench_things() {
    title "things: photo to elements, against the known pieces of scenes (IoU 0.5), and the
watershed on distances from thresholded pixels"
    "$tools/bench_things" --scenes 4 | sed 's/^/  /'
    local p
    for p in "$(photo 'cobble*' 'bricks*')" "$(photo 'pebbles*' 'rocks*')"; do
        "$tools/bench_things" --photo "$p" | sed 's/^/  /'
    done
}

bench_drawings() {
    title "drawings: 10,000 elements to 2048 x 2048 px, against rsvg-convert (goal: under 1.5 s and
no slower than it)"
    "$tools/bench_element_render" 10000 2048 5 | sed 's/^/  /'
}

# pairs : "name value" pairs of a line from the column $1 on, values only
pairs() { awk -v from="$1" '{ for (i = 1; i < from; i++) printf "%s ", $i
    for (i = from + 1; i <= NF; i += 2) printf "%s ", $i
    print "" }'; }

bench_fields() {
    title "fields: domains filled along strokes (goals: 689 things, 100 iterations in 0.2 s
with start and repair; 100,000 samples under 0.3 s an iteration and 500 MiB; an edit of 1 % of
10,000 things under 0.03 s)"
    local n
    for n in "689 100" "400 20" "4000 20" "40000 20" "400000 3"; do
        # shellcheck disable=SC2086 # two arguments
        "$tools/bench_fill" speed $n || return 1
    done >"$out/lines" || return 1
    awk '{ print $2, $22, $4, $6, $8, $10, $12, $14, $20 }' "$out/lines" >"$out/fields-lines"
    awk 'BEGIN { printf "  %8s %8s %8s %8s %10s %8s %10s %14s %8s %6s\n", "things", "samples",
            "start s", "cpu s", "iterate s", "cpu s", "each s", "us each sample", "repair s",
            "MiB" }
        { printf "  %8d %8d %8.3f %8.3f %10.3f %8.3f %10.5f %14.3f %8.3f %6d", $1, $2, $3, $4,
            $5, $6, $7, 1e6 * $7 / $2, $8, $9
        if ($1 == 689) printf "  in all %.3f: %s", $3 + $5 + $8,
            ($3 + $5 + $8 < 0.2 ? "met" : "MISSED")
        if ($1 == 40000) printf "  %s", ($7 * 1e5 / $2 < 0.3 && $9 < 500 ? "met" : "MISSED")
        print "" }' "$out/fields-lines"
    rows fields-speed things samples start start_cpu iterate iterate_cpu each repair peak_mib \
        <"$out/fields-lines"
    "$tools/bench_fill" edit 10000 | pairs 1 | tee "$out/lines" |
        awk '{ printf "  %d things, %.1f %% under a brush, to a settled result: %.4f s, " \
            "cpu %.4f s: %s\n", $1, 100 * $2, $3, $4, ($3 < 0.03 ? "met" : "MISSED") }'
    rows fields-edit things share seconds cpu <"$out/lines"
    "$tools/bench_fill" strokes 1000000 | pairs 1 | tee "$out/lines" |
        awk '{ printf "  %d strokes read and settled: %.2f s, %d MiB\n", $1, $2, $4 }'
    rows fields-strokes strokes seconds cpu peak_mib <"$out/lines"
    title "fields: ten cases, means of three seeds, published and
two-step-ours of one (goals: ours better than two-step in each;
overlap under 0.005). Angles in degrees"
    mkdir -p "$out/fields"
    "$tools/bench_fill" cases "$out/fields" >"$out/cases" || return 1
    grep -v '^against' "$out/cases" | pairs 3 | tee "$out/lines" | awk '
        BEGIN { printf "  %-16s %-14s %6s %7s %7s %7s %7s %7s %7s %6s %6s %6s %7s %6s %6s %7s %6s\n",
            "case", "way", "things", "at first", "covered", "gain", "overlap", "outside", "hole", "turn",
            "rms", "95 %", "bend", "align", "worst", "dropped", "shrunk" }
        { printf "  %-16s %-14s %6d %8.3f %7.3f %7.3f %7.4f %7.4f %7.4f %6.2f %6.2f %6.2f %7.4f %6.2f " \
            "%6.2f %7.1f %6.1f\n", $1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14,
            $15, $16, $17 }'
    rows fields case way things first covered gain overlap outside hole turn turn_rms turn_95 bend align \
        align_most dropped shrunk cpu <"$out/lines"
    grep '^against' "$out/cases" | sed 's/^/  /'
    grep '^against' "$out/cases" | cut -d' ' -f2- |
        awk '{ for (i = 3; i < NF; i += 2) print $1, $i, $(i + 1) }' |
        tr / ' ' >"$out/lines"
    rows fields-better against measure better equal worse <"$out/lines"
}

bench_huge() {
    title "huge: 32,768 x 32,768 px (goal: compute under 60 s, under 1 GiB resident)"
    local p free run null
    p=$(photo 'cobble*' 'rocks*' 'stones*')
    free=$(df -Pk "$out" | awk 'NR == 2 { print int($4 / 1048576) }')
    if [ "$free" -lt 16 ]; then
        echo "  skipped: $out has $free GiB free, 16 are needed"
        return 0
    fi
    null=$("$tools/bench_huge" "$p") || return 1
    run=$("$tools/bench_run" 1 "$terrazzo" expand "$p" -o "$out/huge.exr" --size 32768x32768 \
        --seed 7 --quiet) || { echo "  terrazzo failed"; rm -f "$out/huge.exr"; return 1; }
    local bytes
    bytes=$(stat -c %s "$out/huge.exr")
    rm -f "$out/huge.exr"
    echo "$null $run $bytes" | cut -d' ' -f2- >"$out/lines"
    awk '{ compute = $3 + $4 + $5
        printf "  %d placements: analyze %.1f s, arrange %.1f s, render %.1f s, thrown away; %d MiB\n",
            $2, $3, $4, $5, $6
        printf "  compute %.1f s: %s\n", compute, (compute < 60 ? "met" : "MISSED")
        printf "  whole command to tiled EXR of %.2f GB: %.1f s (cpu %.1f s), so %.1f s for compression and disk\n",
            $10 / 1e9, $7, $8, $7 - compute
        printf "  resident %d MiB: %s\n", $9, ($9 < 1024 ? "met" : "MISSED") }' "$out/lines"
    rows huge side placements analyze arrange render null_peak_mib seconds cpu peak_mib bytes \
        <"$out/lines"
}

# ---- run -----------------------------------------------------------------------------

find_photos
line=$(machine)
echo "bench: $line"
for section in "${sections[@]}"; do
    case $section in
    analyze | edges | render | arrange | expand | scores | elements | likeness | curves | lines | \
        things | drawings | fields | others | huge)
        "bench_$section" || { echo "  $section failed"; failed=1; } ;;
    *) echo "bench: no section $section" >&2; exit 2 ;;
    esac
done
{
    printf '{"machine": "%s", "date": "%s"' "${line//\"/}" "$(date -u +%FT%TZ)"
    for section in analyze edges render arrange expand scores elements likeness curves \
        curves-speed lines lines-photos fields-speed fields-edit fields-strokes fields fields-better \
        others huge; do
        [ -s "$out/$section.json" ] && printf ',\n  "%s": %s' "$section" "$(cat "$out/$section.json")"
    done
    printf '}\n'
} >"$build/bench.json"
printf '\nbench: %s\n' "$build/bench.json"
exit $failed
