//! Drives the targets on a stable toolchain:
//!
//! ```sh
//! cargo run --manifest-path fuzz/Cargo.toml --release -- TARGET RUNS [SEED]
//! ```

use std::panic;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let (Some(name), Some(runs)) = (args.first(), args.get(1).and_then(|n| n.parse().ok())) else {
        eprintln!("give a target, how many runs, and a seed if you like");
        return ExitCode::from(2);
    };
    let seed = args.get(2).and_then(|s| s.parse().ok()).unwrap_or(0);
    panic::set_hook(Box::new(|_| {}));
    match strokefit_fuzz::drive(Path::new(env!("CARGO_MANIFEST_DIR")), name, runs, seed) {
        Ok(outcome) => {
            eprintln!("{outcome}");
            ExitCode::SUCCESS
        }
        Err(finding) => {
            eprintln!("{finding}");
            ExitCode::FAILURE
        }
    }
}
