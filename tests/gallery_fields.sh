# SPDX-License-Identifier: Apache-2.0
# Element fields; sourced by gallery.sh. Leaves its part of the page in $fields.
#   ten cases as sheets: strokes, initialisation, the two-step alternative, ours
#   palettes in shapes, things of photos in an animal

fields=
folder=$out/fields
mkdir -p "$folder"

# seen FILE : a layout of bench_fill as PNG, a thin line about each thing so that things that
# touch are told apart
seen() {
    sed 's/fill="#\(4a8f3c\|c8553d\|588b8b\|f28f3b\)"/& stroke="#000" stroke-opacity=".5" stroke-width=".5"/g' \
        "$1.svg" | rsvg-convert -b white -w 1200 -o "$1.png"
}
# row NAME WAY : the figures of a case as a label
row() {
    awk -v name="$1" -v way="$2" '$1 == name && $2 == way {
        for (i = 3; i < NF; i += 2) v[$i] = $(i + 1)
        printf "covered %.3f, overlap %.4f, hole %.4f, turn %.2f, align %.2f", v["covered"],
            v["overlap"], v["hole"], v["turn"], v["align"] }' "$folder/figures.txt"
}
# field_sheet NAME TITLE LABELS PICTURE...
field_sheet() {
    local name=$1 title=$2 labels=$3
    shift 3
    "$terrazzo" sheet "$@" -o "$folder/$name.png" --columns 2 --cell 1200x1200 \
        --labels "$labels" --quiet || { failed=$((failed + 1)); return; }
    fields+="<h2>$title</h2><a href=\"fields/$name.png\"><img src=\"fields/$name.png\"
width=\"1200\" alt=\"$title\"></a>"$'\n'
    echo "element fields: $title"
}

# ---- ten cases -----------------------------------------------------------------------
if "$build/tests/bench_fill" cases "$folder" "" 1 >"$folder/figures.txt"; then
    fields="<pre>$(cat "$folder/figures.txt")</pre>"
    for strokes in "$folder"/*-strokes.svg; do
        name=$(basename "${strokes%-strokes.svg}")
        for way in strokes first two-step ours; do
            seen "$folder/$name-$way" || failed=$((failed + 1))
        done
        field_sheet "sheet_$name" "$name" "strokes|ours at first|two-step: \
$(row "$name" two-step)|ours: $(row "$name" ours)" "$folder/$name"-{strokes,first,two-step,ours}.png
    done
else
    failed=$((failed + 1))
fi

# ---- palettes and photos --------------------------------------------------------------
# filled NAME PALETTE SHAPE [OPTION...] : a palette in the shape of a case, along its strokes
filled() {
    local name=$1 palette=$2 shape=$3
    shift 3
    "$terrazzo" fill "$palette" -o "$folder/$name.svg" --domain "$folder/$shape-domain.svg" \
        --field "$folder/$shape-field.svg" --seed 7 --quiet "$@" &&
        "$terrazzo" render "$folder/$name.svg" -o "$folder/$name.png" --quiet
}
for palette in "$here"/../data/exemplars/{garden,current,hearts,chips}.svg \
    "$here"/../../shared/exemplars/svg/*.svg; do
    name=$(basename "${palette%.svg}")
    pictures=()
    for shape in animal-leaves ring-drops letter-soft; do
        if filled "p_${name}_$shape" "$palette" $shape --size 1200x1200 2>/dev/null; then
            pictures+=("$folder/p_${name}_$shape.png")
        else
            failed=$((failed + 1))
        fi
    done
    [ ${#pictures[@]} -eq 0 ] || field_sheet "palette_$name" "$name in shapes" "" "${pictures[@]}"
done
for photo in "${photos[@]}" "$here"/../data/exemplars/{pebbles,stones,leaves}.png; do
    name=$(basename "${photo%.*}")
    case $name in pebbles* | gravel* | cobble* | stone* | leaves* | volcanic* | rocks*) ;;
    *) continue ;;
    esac
    if filled "t_$name" "$photo" animal-leaves --size 1500x1500; then
        field_sheet "photo_$name" "$name, its things" "photo|its things in a shape" "$photo" \
            "$folder/t_$name.png"
    else
        failed=$((failed + 1))
    fi
done
