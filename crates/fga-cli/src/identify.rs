//! `fga identify`: which vehicle file does a flight log give?

use core::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use fga_files::TomlText;
use fga_formats::{InputError, atomic, flight_log};
use fga_sim::identification::{Identified, identify};
use fga_sim::vehicle_file::VehicleModel;
use serde_json::{Map, Value, json};

use crate::common::{AnswerArgs, tell_left_out};
use crate::failure::Failure;

/// Options of `fga identify`.
#[derive(Args, Debug)]
pub(crate) struct IdentifyArgs {
    /// Flight log: CSV, a telemetry log (.tlog) or a dataflash log (.bin), also compressed with gzip.
    log: PathBuf,
    /// Vehicle file to write; without it the file's text is printed.
    #[arg(long, value_name = "VEHICLE.toml")]
    out: Option<PathBuf>,
    /// Name of the aircraft; without it the name of the log.
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Radius of the volume to protect, metres.
    #[arg(long, value_name = "M", default_value_t = 150.0)]
    radius_m: f64,
    /// Half height of that volume, metres; without it the volume is a sphere.
    #[arg(long, value_name = "M")]
    half_height_m: Option<f64>,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// Reads the log and writes the vehicle file.
pub(crate) fn run(args: &IdentifyArgs) -> Result<ExitCode, Failure> {
    let log = flight_log::read(&args.log)?;
    tell_left_out(&[], &log.tally, "messages or rows");
    let identified = identify(&log).map_err(|message| InputError::in_file(&args.log, message))?;
    let name = args.name.clone().unwrap_or_else(|| {
        let stem = args.log.file_stem().unwrap_or("identified".as_ref());
        stem.to_string_lossy().into_owned()
    });
    let text = identified
        .to_toml(&name, args.radius_m, args.half_height_m)
        .map_err(Failure::Input)?;
    let path = args.out.clone().unwrap_or_else(|| "vehicle.toml".into());
    // What no vehicle file may hold is said before anything is written.
    VehicleModel::parse(TomlText::new(&path, &text))?;
    if let Some(out) = &args.out {
        atomic::write(out, &text)?;
    }
    let file = args.out.as_ref().map(|out| out.display().to_string());
    let mut answer = answer(&identified, file.as_deref());
    answer["left_out"] = log.tally.to_json().into();
    args.answer.print(
        || file.map_or(text, |file| table(&identified, &file)),
        &answer,
    )?;
    Ok(ExitCode::SUCCESS)
}

/// The figures in words.
fn table(identified: &Identified, file: &str) -> String {
    let mut text = String::new();
    for (key, estimate, decimals) in identified.figures() {
        let _ = writeln!(
            text,
            "{key:<22}{:>9.decimals$}   ({:.decimals$} to {:.decimals$})",
            estimate.value, estimate.low, estimate.high
        );
    }
    let _ = writeln!(
        text,
        "from {} windows, {} left out; vehicle file in {file}",
        identified.windows, identified.windows_left_out
    );
    text
}

/// The figures as JSON.
fn answer(identified: &Identified, file: Option<&str>) -> Value {
    let mut figures = Map::new();
    for (key, estimate, _) in identified.figures() {
        let interval =
            json!({ "value": estimate.value, "low": estimate.low, "high": estimate.high });
        figures.insert(key.to_owned(), interval);
    }
    json!({
        "figures": figures,
        "windows": identified.windows,
        "windows_left_out": identified.windows_left_out,
        "file": file,
    })
}
