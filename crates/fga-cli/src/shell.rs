//! `fga completions` and `fga man`: completion scripts and manual pages.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Command};
use clap_complete::Shell;
use fga_formats::OutputError;
use fga_formats::atomic;

use crate::common::print;
use crate::failure::Failure;

/// Options of `fga completions`.
#[derive(Args, Debug)]
pub(crate) struct CompletionsArgs {
    /// The shell.
    shell: Shell,
}

/// Prints the completion script.
pub(crate) fn completions(
    args: &CompletionsArgs,
    mut command: Command,
) -> Result<ExitCode, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "fga", &mut script);
    print(&String::from_utf8_lossy(&script))?;
    Ok(ExitCode::SUCCESS)
}

/// Options of `fga man`.
#[derive(Args, Debug)]
pub(crate) struct ManArgs {
    /// Folder for the pages, one for each command.
    #[arg(long, value_name = "DIR", default_value = "man")]
    out: PathBuf,
}

/// Writes the manual pages.
pub(crate) fn man(args: &ManArgs, command: Command) -> Result<ExitCode, Failure> {
    atomic::prepare_folder(&args.out)?;
    clap_mangen::generate_to(command, &args.out)
        .map_err(|error| Failure::Output(OutputError::new(&args.out, error)))?;
    print(&format!("manual pages in {}\n", args.out.display()))?;
    Ok(ExitCode::SUCCESS)
}
