//! `fga check`: checks a file without flying it.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use fga_files::TomlText;
use fga_formats::error::read_text;
use fga_formats::words::counted;
use fga_formats::{InputError, daa, encounters};
use fga_sim::campaign::Campaign;
use fga_sim::campaign::file::{self as campaign_file, Overrides};
use fga_sim::scenario;
use fga_sim::vehicle_file::VehicleModel;
use serde_json::json;

use crate::common::AnswerArgs;
use crate::failure::Failure;
use crate::file_kind::FileKind;

/// Options of `fga check`.
#[derive(Args, Debug)]
pub(crate) struct CheckArgs {
    /// A scenario, vehicle, campaign or link file (.toml), a recording (.daa) or encounters (.csv).
    file: PathBuf,
    /// Kind of a .toml file; without it the file's keys decide.
    #[arg(long)]
    kind: Option<FileKind>,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// Reads the file as its command does, and describes it.
pub(crate) fn run(args: &CheckArgs) -> Result<ExitCode, Failure> {
    let (kind, holds) = check(&args.file, args.kind)?;
    let shown = args.file.display();
    let file = shown.to_string();
    args.answer.print(
        || format!("{shown}: a usable {kind}: {holds}\n"),
        &json!({ "file": file, "kind": kind, "usable": true, "holds": holds }),
    )?;
    Ok(ExitCode::SUCCESS)
}

/// The kind of a file and its content, in words.
fn check(path: &Path, kind: Option<FileKind>) -> Result<(String, String), Failure> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    match (extension, kind) {
        (Some("daa"), None) => Ok(("recording".into(), recording(path)?)),
        (Some("csv"), None) => Ok(("file of encounters".into(), encounter_file(path)?)),
        (Some("toml"), None) => {
            let text = read_text(path)?;
            let keys = TomlText::new(path, &text).keys()?;
            if keys.is_empty() {
                return Err(InputError::in_file(
                    path,
                    "holds no key, expected a scenario, a campaign, a vehicle or a link file; \
                     --kind says which",
                )
                .into());
            }
            let kind = FileKind::of(&keys).ok_or_else(|| {
                InputError::in_file(
                    path,
                    "is of no kind that is known, expected a scenario (key mission), a campaign \
                     (policies), a vehicle (airspeed_mps) or a link file; --kind says which",
                )
            })?;
            Ok((format!("{kind} file"), toml_file(path, kind)?))
        }
        (_, Some(kind)) => Ok((format!("{kind} file"), toml_file(path, kind)?)),
        (_, None) => {
            // A missing file or a folder is said first.
            let _ = read_text(path)?;
            Err(Failure::Input(format!(
                "{}: a file of this kind cannot be checked, expected .toml, .daa or .csv",
                path.display()
            )))
        }
    }
}

/// Describes a campaign whose encounters come from the command line; `None` if something else is wrong
/// with it.
fn outline(path: &Path) -> Option<String> {
    let text = read_text(path).ok()?;
    let keys = TomlText::new(path, &text).keys().ok()?;
    let outline = Overrides {
        outline: true,
        // A number in the file is checked too.
        encounters: (!keys.contains("encounters")).then_some(1),
        ..Overrides::default()
    };
    let configuration = campaign_file::read(path, &outline).ok()?;
    Some(format!(
        "{}; its encounters come from the command line (--recordings, --model)",
        counted(configuration.policies.len(), "policy")
    ))
}

fn toml_file(path: &Path, kind: FileKind) -> Result<String, Failure> {
    match kind {
        FileKind::Scenario => {
            let plan = scenario::read(path, None)?;
            Ok(format!(
                "{}, {}, vehicle {}",
                counted(plan.world.mission_m.len(), "waypoint"),
                counted(plan.world.obstacles.len(), "obstacle"),
                plan.model.name
            ))
        }
        FileKind::Vehicle => {
            let model = VehicleModel::read(path)?;
            Ok(format!(
                "{}, {} m/s, turn radius {:.1} m",
                model.name, model.vehicle.airspeed_mps, model.vehicle.turn_radius_m
            ))
        }
        FileKind::Campaign => {
            let configuration = match campaign_file::read(path, &Overrides::default()) {
                Ok(configuration) => configuration,
                Err(error) => return outline(path).ok_or_else(|| error.into()),
            };
            let campaign = Campaign::new(configuration, path)?;
            Ok(format!(
                "{} from {}, {}, vehicle {}",
                counted(campaign.configuration.encounters, "encounter"),
                counted(campaign.source_names().len(), "source"),
                counted(campaign.policies.len(), "policy"),
                campaign.model.name
            ))
        }
        FileKind::Link => link(path),
    }
}

#[cfg(feature = "fly")]
fn link(path: &Path) -> Result<String, Failure> {
    let config = crate::fly::config_file(path)?;
    Ok(format!(
        "takes over {}, keeps {} m, {}",
        config.vehicle.take_over.join(" and "),
        config.protection.radius_m,
        counted(config.obstacle.len(), "virtual obstacle")
    ))
}

#[cfg(not(feature = "fly"))]
fn link(path: &Path) -> Result<String, Failure> {
    Err(Failure::Input(format!(
        "{}: this program was built without the command fly, expected one built with it",
        path.display()
    )))
}

fn recording(path: &Path) -> Result<String, Failure> {
    let recording = daa::read(path)?;
    Ok(format!("{} aircraft", recording.aircraft.len()))
}

fn encounter_file(path: &Path) -> Result<String, Failure> {
    let encounters = encounters::read(path)?;
    let obstacles: usize = encounters.iter().map(|each| each.obstacles.len()).sum();
    Ok(format!(
        "{}, {}",
        counted(encounters.len(), "encounter"),
        counted(obstacles, "obstacle")
    ))
}
