//! The program `lost-motion`.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run()
}
