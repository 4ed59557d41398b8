//! The command line of strokefit; see `strokefit --help`.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    let args = match cli::parse() {
        Ok(args) => args,
        Err(status) => return status.into(),
    };
    match cli::run(&args) {
        Ok(status) => status.into(),
        Err(error) => cli::fail(&error).into(),
    }
}
