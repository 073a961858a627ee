//! The program `fga`.

use std::process::ExitCode;

fn main() -> ExitCode {
    fga_cli::main()
}
