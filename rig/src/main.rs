//! The command line of what measures strokefit; see `strokefit-rig --help`.

use std::env;
use std::process::ExitCode;

fn main() -> ExitCode {
    rig::cli::main(env::args_os().collect()).into()
}
