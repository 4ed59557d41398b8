#!/usr/bin/env bash
# Builds the page, web/dist, and the npm package, web/pkg:
#
#     web/build.sh
#     python3 -m http.server --directory web/dist
#
# It needs the standard library of wasm32-unknown-unknown, and installs it with rustup where it is missing. web/README.md says
# what to do without rustup.
set -euo pipefail
cd "$(dirname "$0")/.."

target=wasm32-unknown-unknown
built=${CARGO_TARGET_DIR:-target}

compile() {
    # A build of the standard library itself, as web/README.md describes it, needs none that is installed.
    [ -n "${CARGO_UNSTABLE_BUILD_STD:-}" ] || [ -d "$(rustc --print target-libdir --target "$target")" ] ||
        rustup target add "$target"
    # The renderer is written for vectors, and every browser has had them since 2023. What is not hot is inlined less than
    # usual (225): a page downloads all of it.
    CARGO_ENCODED_RUSTFLAGS=$'-Ctarget-feature=+simd128\x1f-Cllvm-args=-inline-threshold=60' \
        cargo build --profile web --locked --package strokefit-web --lib --target "$target"
}

# The package: the WebAssembly, the script that loads it, and what is written by hand.
package() {
    rm -rf web/pkg
    mkdir web/pkg
    cargo run --quiet --release --locked --package strokefit-web-bindgen -- "$built/$target/web/strokefit_web.wasm" web/pkg
    cp web/js/* LICENSE-MIT LICENSE-APACHE web/pkg
}

# The page: its own files, those that it shares with the live page of the program, and the package.
page() {
    local shared=src/view/page
    rm -rf web/dist
    mkdir -p web/dist/{strokefit,examples}
    cp web/page/* "$shared"/{page.css,viewer.js,chart.js,choice.js,describe.js,edits.js,lens.js,palette.js,picture.js,swatches.js} web/dist
    sed -i -e "/<!-- viewer.html -->/{r $shared/viewer.html" -e 'd}' web/dist/index.html
    cp web/pkg/{api.js,browser.js,gradients.js,wasm.js,wasm_bg.wasm} web/dist/strokefit
    examples
    headers >web/dist/_headers
    keep_offline
}

# Pictures, and what the program draws of them without options.
examples() {
    cp samples/{coffee-300.png,noto-hibiscus.png,bicycle.png,crayon.jpg} web/dist/examples
    cp docs/pictures/{noto-hibiscus,bicycle,crayon}.svg web/dist/examples
    cp docs/pictures/coffee-quality-30.svg web/dist/examples/coffee-300.svg
}

# The policy of the page as headers, for hosts that read such a file. The page has it in itself, too.
headers() {
    local policy
    policy=$(sed -n 's/.*Content-Security-Policy" content="\([^"]*\)".*/\1/p' web/page/index.html)
    printf '/*\n  Content-Security-Policy: %s\n  X-Content-Type-Options: nosniff\n' "$policy; frame-ancestors 'none'"
}

# Tells the service worker which files to keep, under a name that changes with them.
keep_offline() (
    cd web/dist
    files=$(find . -type f ! -name _headers ! -name offline.js -printf '%P\n' | LC_ALL=C sort)
    version=$(sha256sum $files | sha256sum | cut -c 1-16)
    sed -i "s|@VERSION@|strokefit-$version|; s|@FILES@|${files//$'\n'/ }|" offline.js
)

compile
package
page
printf 'web/pkg and web/dist are built; %s bytes of WebAssembly after gzip\n' "$(gzip -9 -c web/pkg/wasm_bg.wasm | wc -c)"
