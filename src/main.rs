//! The command line of strokefit; see `strokefit --help`.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    let args = match cli::parse() {
        Ok(args) => args,
        Err(status) => return status.leave(),
    };
    let status = cli::run(&args).unwrap_or_else(|error| cli::fail(&error));
    status.leave()
}
