//! `strokefit-web-bindgen IN.wasm OUT`: writes `OUT/wasm.js` and `OUT/wasm_bg.wasm`.
//!
//! This is what `wasm-bindgen --target web --no-typescript --experimental-reset-state-function` does. That program would have to be installed, in the
//! version of the crate `wasm-bindgen`; here the lock file says the version of both.

use std::env;
use std::path::PathBuf;

use anyhow::{Context, Result};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<()> {
    let mut args = env::args_os().skip(1).map(PathBuf::from);
    let input = args
        .next()
        .context("no WebAssembly named: give IN.wasm OUT")?;
    let folder = args.next().context("no folder named: give IN.wasm OUT")?;
    Bindgen::new()
        .input_path(input)
        .out_name("wasm")
        .typescript(false)
        .remove_name_section(true)
        .remove_producers_section(true)
        // A trap leaves the memory as it is in the middle of something: `web/js/api.js` then starts anew.
        .reset_state_function(true)
        .web(true)?
        .generate(folder)?;
    Ok(())
}
