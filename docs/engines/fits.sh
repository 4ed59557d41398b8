#!/usr/bin/env bash
# The table of fits in docs/notebook/2026-11-25-engines.md: every sample, or those NAMED, at 500 and 2,000 strokes and at the defaults.
# Run in the repository's folder; STROKEFIT is the program, strokefit unless set.
set -euo pipefail
strokefit=${STROKEFIT:-strokefit}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# One column of resvg, one of the least of Cairo's three, one of Chromium.
columns() { # PICTURE, OPTIONS OF THE FIT
    "$strokefit" fit "$1" -o "$folder/fit.svg" -q "${@:2}"
    # A drawing that a program draws differently is a row like others.
    { "$strokefit" check "$folder/fit.svg" "$1" 2>/dev/null || true; } | awk '
        $1 == "resvg" && $2 != "on" { resvg = $3 }
        $1 ~ /^(inkscape|rsvg|cairosvg)$/ && (cairo == "" || $3 < cairo) { cairo = $3; cairo_agrees = $6 }
        $1 == "chromium" { skia = $3; skia_agrees = $6 }
        function than(db, agrees) { return db == "" ? "–" : sprintf("%s%.2f (%.1f)", db < resvg ? "−" : "+", db < resvg ? resvg - db : db - resvg, agrees) }
        END { printf " %s | %s | %s |", resvg, than(cairo, cairo_agrees), than(skia, skia_agrees) }'
}

echo '| sample, strokes | resvg | Cairo’s three | Chromium | `--opaque`: resvg | Cairo’s three | Chromium |'
echo '| --- | --- | --- | --- | --- | --- | --- |'
for picture in ${*:-samples/*.png samples/*.jpg}; do
    name=$(basename "${picture%.*}")
    for strokes in 500 2000 default; do
        budget=(--strokes "$strokes")
        [ "$strokes" = default ] && budget=()
        printf '| %s, %s |' "$name" "$strokes"
        columns "$picture" "${budget[@]}"
        columns "$picture" "${budget[@]}" --opaque
        echo
    done
done
