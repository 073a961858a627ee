//! `fga init`: writes a commented file of each kind.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use fga_files::from_mission::{over, scenario_text};
use fga_formats::{OutputError, missions};
use fga_sim::vehicle_file::VehicleModel;
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
    /// The mission that a scenario flies: a plan of QGroundControl (.plan) or a list of Mission Planner (.waypoints).
    #[arg(long, value_name = "MISSION")]
    from: Option<PathBuf>,
    /// Files of heights under the mission, which waypoints above the ground are above; again for each file.
    #[arg(long, value_name = "FILE", requires = "from")]
    terrain: Vec<PathBuf>,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// The text of the file, and notes about it.
fn text_of(args: &InitArgs) -> Result<(String, Vec<String>), Failure> {
    let Some(from) = &args.from else {
        return Ok((args.kind.template().to_owned(), Vec::new()));
    };
    if args.kind != FileKind::Scenario {
        return Err(Failure::Input(format!(
            "--from makes a scenario of a mission, expected fga init scenario --from {}",
            from.display()
        )));
    }
    let vehicle = VehicleModel::built_in()?.vehicle;
    let mission = missions::read(from)?;
    let mission = over(mission, from, &args.terrain, &vehicle)?;
    let airspeed_mps = mission.cruise_mps.unwrap_or(vehicle.airspeed_mps);
    let text = scenario_text(&mission, from, airspeed_mps, &args.terrain)?;
    Ok((text, mission.notes))
}

/// Writes the file; never overwrites one.
pub(crate) fn run(args: &InitArgs) -> Result<ExitCode, Failure> {
    let (text, notes) = text_of(args)?;
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
    if let Err(error) = file.write_all(text.as_bytes()) {
        // No half-written file stays.
        let _ = std::fs::remove_file(&path);
        return Err(Failure::Output(OutputError::new(&path, error)));
    }
    let next = args.kind.next_step(&shown.to_string());
    let told = notes
        .iter()
        .fold(String::new(), |told, note| told + note + "\n");
    args.answer.print(
        || format!("{told}{shown} written; {next}\n"),
        &json!({ "file": shown.to_string(), "kind": args.kind.to_string(), "notes": notes }),
    )?;
    Ok(ExitCode::SUCCESS)
}
