#!/usr/bin/env bash
# Builds the page, web/dist, for any static host, and the npm package, web/pkg:
#
#     web/build.sh
#     python3 -m http.server --directory web/dist
#
# Needs the standard library of wasm32-unknown-unknown, which `rustup target add` installs if it can. Where it is
# missing, Debian has a toolchain that has it (rustc-web, cargo-web, rust-web-src, lld-22): web/README.md says how.
set -euo pipefail
cd "$(dirname "$0")/.."

target=wasm32-unknown-unknown
built=${CARGO_TARGET_DIR:-target}
flags="--release --locked"

has_library() {
    [ -d "$(rustc --print target-libdir --target "$target" 2>/dev/null)" ]
}

compile() {
    has_library || rustup target add "$target"
    RUSTFLAGS="${RUSTFLAGS:-} -C target-feature=+simd128" \
        cargo build --profile web --locked --package strokefit-web --lib --target "$target" ${WEB_CARGO_FLAGS:-}
}

# The package: the WebAssembly, what loads it, and what is written by hand.
package() {
    rm -rf web/pkg
    mkdir -p web/pkg
    cargo run --quiet --release --locked --package strokefit-web-bindgen -- \
        "$built/$target/web/strokefit_web.wasm" web/pkg
    cp web/js/* LICENSE-MIT LICENSE-APACHE web/pkg
}

package_page() { :; }

compile
package
