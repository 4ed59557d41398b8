//! The command line of strokefit; see `strokefit --help`.

use std::env;
use std::process::ExitCode;

fn main() -> ExitCode {
    strokefit::cli::main(env::args_os().collect()).into()
}
