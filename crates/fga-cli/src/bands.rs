//! `fga bands`: which manoeuvres lead into a conflict, as the standards see it?

use std::process::ExitCode;

use clap::Args;
use fga_formats::atomic;
use fga_formats::daa::tables::{DaaTables, watch};
use serde_json::json;

use crate::alerts::DetectArgs;
use crate::failure::Failure;

/// Options of `fga bands`.
#[derive(Args, Debug)]
pub(crate) struct BandsArgs {
    #[command(flatten)]
    input: DetectArgs,
}

/// Writes `bands.out`.
pub(crate) fn run(args: &BandsArgs) -> Result<ExitCode, Failure> {
    let input = &args.input;
    let (recording, configuration) = input.read()?;
    let folder = input.out.prepare(&input.recording)?;
    let tables = DaaTables {
        recording: &recording,
        configuration: &configuration,
    };
    // The name as the user gave it, so that outputs of the same command compare.
    let mut text = DaaTables::bands_head(&input.recording.display().to_string());
    let mut times = 0;
    watch(&recording, &configuration, |monitor, scene| {
        tables.bands_text(monitor, scene, &mut text);
        times += 1;
    })
    .map_err(|message| input.refused(&message))?;
    let path = folder.join("bands.out");
    atomic::write(&path, text)?;
    input.answer.print(
        || format!("{times} instants; bands in {}\n", path.display()),
        &json!({
            "instants": times,
            "left_out": recording.tally.to_json(),
            "file": path.display().to_string(),
        }),
    )?;
    Ok(ExitCode::SUCCESS)
}
