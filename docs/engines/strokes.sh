#!/usr/bin/env bash
# One file a kind of stroke, 64×48 px; then what each program makes of it.
page() { # NAME, ATTRIBUTES OF THE GROUP, PATHS
    printf '<svg xmlns="http://www.w3.org/2000/svg" width="64" height="48" viewBox="0 0 64 48">\n<rect width="64" height="48" fill="#ffe6b3"/>\n<g id="a" fill="none" stroke="#1a4dcc" %s>\n%s\n</g>\n</svg>\n' "$2" "$3" > "$1.svg"
}
paths() { for d in "$@"; do printf '<path d="%s"/>\n' "$d"; done; }
fan=$(paths 'M36 24L52 24' 'M35.5 26L49.3 34' 'M34 27.5L42 41.3' 'M32 28L32 44' 'M30 27.5L22 41.3' 'M28.5 26L14.7 34' \
      'M28 24L12 24' 'M28.5 22L14.7 14' 'M30 20.5L22 6.7' 'M32 20L32 4' 'M34 20.5L42 6.7' 'M35.5 22L49.3 14')
dots() { for x in 6.3 11.4 16.5 21.6 26.7 31.8 36.9 42 47.1; do paths "M$x 9.7$1" "M$x 33.1$1"; done; }
round='stroke-linecap="round"'
page dots-4.6 "$round stroke-width=\"4.6\"" "$(dots h0.01)"
page dots-1.02 "$round stroke-width=\"1.02\"" "$(dots h0.01)"
page length-0 "$round stroke-width=\"4.6\"" "$(dots h0)"
page length-0-butt "stroke-width=\"4.6\"" "$(dots h0)"
page width-3 "$round stroke-width=\"3\"" "$fan"
page width-1.02 "$round stroke-width=\"1.02\"" "$fan"
page width-1 "$round stroke-width=\"1\"" "$fan"
page width-0.5 "$round stroke-width=\"0.5\"" "$fan"
page width-0.1 "$round stroke-width=\"0.1\"" "$fan"
page faint-0.15 "$round stroke-width=\"20\" stroke-opacity=\"0.15\"" "$(paths M20\ 20L44\ 28 M20\ 21L44\ 28 M20\ 22L44\ 28 M20\ 23L44\ 28 M20\ 24L44\ 28 M20\ 25L44\ 28 M20\ 26L44\ 28 M20\ 27L44\ 28)"
page off-the-page "$round stroke-width=\"9\"" "$(paths 'M-30 10L10 10' 'M60-9L90 30' 'M20 48L44 48' 'M-1000 30L1000 33')"
page covered "$round stroke-width=\"90\"" "$(paths 'M32 24h5' 'M0 24L64 24')"
page rgba "$round stroke-width=\"3\" style=\"stroke:rgba(26,77,204,0.5)\"" "$fan"
page rrggbbaa "$round stroke-width=\"3\" style=\"stroke:#1a4dcc80\"" "$fan"
page group-opacity "$round stroke-width=\"3\" opacity=\"0.5\"" "$fan"
page leading-dot "$round stroke-width=\"3\"" "$(paths 'M.5.5L30.5 40.25' 'M60 .5l-20 40')"
# Paths that bend: as strokefit writes them, and the last as it does not.
bend="$round stroke-linejoin=\"round\""
page corners "$bend stroke-width=\"3\"" "$(paths 'M8 8L50 12 14 20 54 40')"
page corners-translucent "$bend stroke-width=\"9\" stroke-opacity=\"0.4\"" "$(paths 'M8 8L50 12 14 20 54 40')"
page corners-closed "$bend stroke-width=\"3\"" "$(paths 'M8 8L50 12 14 20 54 40z')"
page cusps "$bend stroke-width=\"6\" stroke-opacity=\"0.6\"" "$(paths 'M8 30L56 18 20 27.5')"
page curves "$bend stroke-width=\"4\"" "$(paths 'M6 24Q16 2 23 23T38 24 58 30')"
page curves-1.02 "$bend stroke-width=\"1.02\"" "$(paths 'M6 24Q16 2 23 23T38 24 58 30')"
page knot "$bend stroke-width=\"8\" stroke-opacity=\"0.4\"" "$(paths 'M6 40Q60 30 50 15T29 22 58 44')"
page tight "$bend stroke-width=\"14\" stroke-opacity=\"0.6\"" "$(paths 'M20 40Q30 6 36 40')"
page loops "$bend stroke-width=\"5\"" "$(paths 'M8 24Q8 8 32 8T56 24 32 40 8 24z')"
page cusps-in-curves "$bend stroke-width=\"6\"" "$(paths 'M8 10Q100 20 8 10.5' 'M8 36Q100 30 8 36')"
