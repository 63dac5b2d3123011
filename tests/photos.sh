# SPDX-License-Identifier: Apache-2.0
# Sourced: fetch_photos FOLDER puts real photos there, out of Debian's package archive,
# without installing anything, and prints their names, one a line. Status 1 if the archive
# cannot be reached; photos that are there already are not fetched again.

# take PACKAGE FOLDER PATH... : the files at PATH inside the package
take() {
    local package=$1 folder=$2 path work wanted=
    shift 2
    for path in "$@"; do [ -s "$folder/${path##*/}" ] || wanted=1; done
    [ -n "$wanted" ] || return 0
    work=$(mktemp -d) || return 1
    chmod 755 "$work"
    if (cd "$work" && timeout 120 apt-get -q download "$package") >"$work/log" 2>&1 &&
        dpkg-deb -x "$work"/"$package"_*.deb "$work/tree"; then
        for path in "$@"; do cp "$work/tree/$path" "$folder/" || break; done
    fi
    rm -rf "$work"
    for path in "$@"; do [ -s "$folder/${path##*/}" ] || return 1; done
}

fetch_photos() {
    local folder=$1 templates=usr/share/tuxpaint/templates
    local skimage=usr/lib/python3/dist-packages/skimage/data
    mkdir -p "$folder" || return 1
    command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || return 1
    # CC0 textures; and photos of the Tux Paint project, GPL-2+
    take tuxpaint-data "$folder" $templates/rocks.jpg $templates/mossy_bark.jpg &&
        take python3-skimage "$folder" $skimage/gravel.png $skimage/brick.png \
            $skimage/grass.png || return 1
    ls "$folder"/rocks.jpg "$folder"/mossy_bark.jpg "$folder"/gravel.png \
        "$folder"/brick.png "$folder"/grass.png
}
