#!/usr/bin/env bash
# Makes editing-*.png by Inkscape: a drawing as it was fitted, recoloured, and with a thing moved.
#
#     docs/pictures/editing.sh path/to/strokefit
set -euo pipefail
program=$(realpath "$1")
cd "$(dirname "$0")"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$program" render ../../samples/filled/fluent-emoji-flat__house-with-garden.svg -q -o "$scratch/house.png"
"$program" fit "$scratch/house.png" -q -o "$scratch/house.svg" --group object

# The names are those that Inkscape's list of layers and objects shows.
edit() {
    inkscape "$scratch/house.svg" --actions="$2;export-area-page;export-width:256;export-background:white;export-filename:editing-$1.png;export-do" 2>/dev/null
}
edit fitted 'select-clear'
edit recoloured 'select-by-id:blue-square-1-3;object-set-attribute:fill,#ffe08a;select-clear;select-by-id:red-curve-2-1;object-set-attribute:stroke,#2f6fd0'
edit moved 'select-by-id:object-1;transform-translate:30,-24'
