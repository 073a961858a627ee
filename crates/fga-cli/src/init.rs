//! `fga init`: writes a commented file of each kind.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use fga_formats::OutputError;
use serde_json::json;

use crate::common::AnswerArgs;
use crate::failure::Failure;
use crate::file_kind::FileKind;

/// Options of `fga init`.
#[derive(Args, Debug)]
pub(crate) struct InitArgs {
    /// Which kind of file.
    kind: FileKind,
    /// The file to write; without it KIND.toml in this folder.
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// Writes the file; never overwrites one.
pub(crate) fn run(args: &InitArgs) -> Result<ExitCode, Failure> {
    let path = args
        .file
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}.toml", args.kind)));
    let shown = path.display();
    let mut file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&path)
        .map_err(|error| match error.kind() {
            ErrorKind::AlreadyExists => Failure::Input(format!(
                "{shown} exists already, expected a name that is free"
            )),
            _ => Failure::Output(OutputError::new(&path, error)),
        })?;
    if let Err(error) = file.write_all(args.kind.template().as_bytes()) {
        // No half-written file stays.
        let _ = std::fs::remove_file(&path);
        return Err(Failure::Output(OutputError::new(&path, error)));
    }
    let next = args.kind.next_step(&shown.to_string());
    args.answer.print(
        || format!("{shown} written; {next}\n"),
        &json!({ "file": shown.to_string(), "kind": args.kind.to_string() }),
    )?;
    Ok(ExitCode::SUCCESS)
}
