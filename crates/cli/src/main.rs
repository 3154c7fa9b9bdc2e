//! The program `haptical`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(haptical_cli::run(std::env::args_os()))
}
