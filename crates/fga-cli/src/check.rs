//! `fga check`: checks a file without flying it.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use fga_campaign::campaign::Campaign;
use fga_campaign::campaign::file::{self as campaign_file, Overrides};
use fga_campaign::drawn::{self, DrawnContent};
use fga_campaign::recorded;
use fga_files::TomlText;
use fga_files::surveillance::CREWED_MPS;
use fga_formats::error::{read_bytes, read_text};
use fga_formats::flight::Flight;
use fga_formats::flight_log::FlightLog;
use fga_formats::tally::Tally;
use fga_formats::terrain::{self, Given};
use fga_formats::words::counted;
use fga_formats::{
    InputError, areas, conf, daa, encounter_model, flight_log, missions, recordings,
};
use fga_results::flight_file;
use fga_sim::run::Plan;
use fga_sim::scenario;
use fga_sim::vehicle_file::VehicleModel;
use serde_json::json;

use crate::batch_input::PARTS;
use crate::common::AnswerArgs;
use crate::failure::Failure;
use crate::file_kind::FileKind;
use crate::terrain_ground::Facts;
use crate::unread_kind;

/// Options of `fga check`.
#[derive(Args, Debug)]
pub(crate) struct CheckArgs {
    /// A scenario, vehicle, campaign or link file (.toml), or any other file or folder that a command reads: recordings,
    /// encounters, missions, configurations of alerts, encounter models, flight logs, finished flights.
    file: PathBuf,
    /// Kind of a .toml file; without it the file's keys decide.
    #[arg(long)]
    kind: Option<FileKind>,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// What a usable file is.
struct Usable {
    /// Its kind, in words.
    kind: String,
    /// Its content, in words.
    holds: String,
    /// What it probably does not mean, or what of it is not flown; one sentence each.
    warnings: Vec<String>,
    /// What a reader of traffic uses of it, and the name of its parts in the plural.
    counts: Option<(Tally, &'static str)>,
}

impl Usable {
    fn new(kind: impl Into<String>, holds: impl Into<String>) -> Self {
        Self {
            kind: kind.into(),
            holds: holds.into(),
            warnings: Vec::new(),
            counts: None,
        }
    }

    /// With what a reader of traffic uses, if the file has any.
    fn counting(self, tally: Tally, parts: &'static str) -> Self {
        let counts = (tally.read() > 0).then_some((tally, parts));
        Self { counts, ..self }
    }

    fn with(self, warnings: Vec<String>) -> Self {
        Self { warnings, ..self }
    }
}

/// Reads the file as its command does, and describes it.
pub(crate) fn run(args: &CheckArgs) -> Result<ExitCode, Failure> {
    let Usable {
        kind,
        holds,
        warnings,
        counts,
    } = check(&args.file, args.kind)?;
    let shown = args.file.display();
    let file = shown.to_string();
    let told = warnings.iter().fold(String::new(), |told, warning| {
        told + &format!("{shown}: warning: {warning}\n")
    });
    let read = counts.map_or_else(String::new, |(tally, parts)| {
        format!("{shown}: {}\n", in_words(&tally, parts))
    });
    let mut answer =
        json!({ "file": file, "kind": kind, "usable": true, "holds": holds, "warnings": warnings });
    if let Some((tally, _)) = counts {
        answer["read"] = tally.read().into();
        answer["used"] = tally.used.into();
        answer["left_out"] = tally.to_json().into();
    }
    args.answer.print(
        || format!("{shown}: a usable {kind}: {holds}\n{read}{told}"),
        &answer,
    )?;
    Ok(ExitCode::SUCCESS)
}

/// The counts of a reader, as in "160 lines read, 144 used, 16 with an unreadable field".
fn in_words(tally: &Tally, parts: &str) -> String {
    let words = format!("{} {parts} read, {} used", tally.read(), tally.used);
    tally.reasons().fold(words, |words, (reason, count)| {
        format!("{words}, {count} {}", reason.words())
    })
}

/// The ending of a file's name in small letters, without the one of gzip.
fn ending_of(path: &Path) -> String {
    let ending = |path: &Path| path.extension().unwrap_or_default().to_ascii_lowercase();
    let found = match ending(path) {
        gzip if gzip == "gz" => ending(Path::new(path.file_stem().unwrap_or_default())),
        plain => plain,
    };
    found.to_string_lossy().into_owned()
}

/// The kind of a file and its content.
fn check(path: &Path, kind: Option<FileKind>) -> Result<Usable, Failure> {
    if let Some(kind) = kind {
        return toml_file(path, kind);
    }
    if path.is_dir() {
        return folder(path);
    }
    if missions::is_mission_file(path) {
        return mission(path);
    }
    match ending_of(path).as_str() {
        "toml" => {
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
            toml_file(path, kind)
        }
        "daa" => {
            let recording = daa::read(path)?;
            let holds = format!("{} aircraft", recording.aircraft.len());
            Ok(Usable::new("recording", holds).counting(recording.tally, "rows"))
        }
        "conf" => {
            conf::read(path)?;
            Ok(Usable::new("configuration of DAIDALUS", "alerts and bands"))
        }
        "tlog" | "bin" | "ulg" => {
            let log = flight_log::read(path).map(|log| flight_log_of(&log));
            telemetry(path, log)
        }
        "txt" if read_text(path)?.contains(MODEL) => {
            let model = encounter_model::read(path)?;
            let holds = counted(model.variables().len(), "variable");
            Ok(Usable::new("encounter model", holds))
        }
        "json"
            if path
                .file_name()
                .is_some_and(|name| name == flight_file::NAME) =>
        {
            flight(path)
        }
        "hgt" | "tif" | "tiff" | "dt0" | "dt1" | "dt2" | "dat" => {
            let file = terrain::read(path, &Given::default())?;
            let holds = Facts::new(&file).counts();
            Ok(Usable::new(
                format!("file of heights ({})", file.format),
                holds,
            ))
        }
        "geojson" | "kml" | "kmz" | "xml" => areas_in(path),
        _ if holds_areas(path) => areas_in(path),
        ending if let Some(message) = unread_kind::of(path, ending) => {
            Err(InputError::in_file(path, message).into())
        }
        "scn" => {
            let mut usable = encounters_in(path)?;
            if let recordings::Content::States(received) = recordings::read_content(path)? {
                usable.warnings.extend(received.notes);
            }
            Ok(usable)
        }
        "csv" | "parquet" | "txt" | "json" | "sbs" | "log" => encounters_in(path),
        _ => {
            // A missing file is said first.
            let _ = read_text(path)?;
            Err(Failure::Input(format!(
                "{}: a file of this kind cannot be checked, expected .toml, .daa, .csv, .parquet, .json, .sbs, .scn, .conf, \
                 .tlog, .bin, heights (.hgt, .tif, .dt2, .DAT), areas (.geojson, .kml, .kmz, AIXM, OpenAir), a mission (.plan, .waypoints), an encounter model (.txt) or a folder",
                path.display()
            )))
        }
    }
}

/// The first section of an encounter model.
const MODEL: &str = "# labels_initial";

/// A mission, and what of it is not flown.
fn mission(path: &Path) -> Result<Usable, Failure> {
    let mut mission = missions::read(path)?;
    if mission.waypoints.is_empty() {
        let holds = format!("holds {}, expected a mission", mission.holds());
        let is_empty = mission.fences.is_empty() && mission.rally.is_empty();
        if is_empty && mission.notes.is_empty() {
            return Err(InputError::in_file(path, holds).into());
        }
        if !mission.fences.is_empty() {
            areas_in(path)?;
        }
        mission.notes.push(format!("not for fga run: {holds}"));
    } else if mission.above_ground() > 0 {
        let above = counted(mission.above_ground(), "waypoint");
        mission.notes.push(format!(
            "{above} above the ground: fga run --terrain flies them over files of its heights"
        ));
        if !mission.fences.is_empty() {
            areas_in(path)?;
        }
    } else {
        mission.notes.extend(Plan::read(path, None)?.warnings());
    }
    Ok(Usable::new("mission", mission.holds()).with(mission.notes))
}

/// Whether a file is one of areas.
fn holds_areas(path: &Path) -> bool {
    read_text(path).is_ok_and(|text| areas::is_areas(&text))
}

/// Areas as a `[[zone]]` of a scenario reads them.
fn areas_in(path: &Path) -> Result<Usable, Failure> {
    let file = areas::read(path)?;
    for (area, number) in file.areas.iter().zip(1..) {
        area.check().map_err(|error| {
            let name = area.name.as_deref().unwrap_or("no name");
            Failure::Input(format!(
                "{}: area {number} ({name}): {error}",
                path.display()
            ))
        })?;
    }
    let parts = [
        (
            file.areas.iter().filter(|area| area.is_free).count(),
            "that restrict nothing",
        ),
        (
            file.areas.iter().filter(|area| area.is_timed).count(),
            "with times",
        ),
        (
            file.areas
                .iter()
                .filter(|area| area.limits == [None; 2])
                .count(),
            "without a floor and a ceiling",
        ),
    ];
    let parts = parts.into_iter().filter(|(count, _)| *count > 0);
    let holds = parts.fold(counted(file.areas.len(), "area"), |holds, (count, what)| {
        format!("{holds}, {count} {what}")
    });
    Ok(Usable::new("file of areas for [[zone]]", holds).with(file.notes))
}

/// A folder that `fga run` or `fga campaign draw` wrote, or one of recordings.
fn folder(path: &Path) -> Result<Usable, Failure> {
    let file = path.join(flight_file::NAME);
    if file.is_file() {
        return flight(&file);
    }
    encounters_in(path)
}

fn flight(path: &Path) -> Result<Usable, Failure> {
    let flight = Flight::read(path)?;
    let (begin_s, end_s) = flight.span_s();
    Ok(Usable::new(
        "finished flight",
        format!("{:.0} s", end_s - begin_s),
    ))
}

/// A log as `fga identify` reads it, and what `fga fly --replay` reads in a telemetry log, though `fga identify` may not be
/// able to use it.
#[cfg(feature = "fly")]
fn telemetry(path: &Path, log: Result<Usable, InputError>) -> Result<Usable, Failure> {
    let contents = || {
        let bytes = read_bytes(path).ok()?;
        let bytes = fga_formats::gzip::unpacked(&bytes, path).ok()?;
        let contents = fga_link::tlog::Contents::read(bytes.as_ref()).ok()?;
        (contents.frames > 0).then_some(contents)
    };
    let Some(contents) = contents() else {
        return Ok(log?);
    };
    let usable = log.unwrap_or_else(|error| {
        let holds = format!("{} for fga fly --replay", counted(contents.frames, "frame"));
        let warning = format!("not for fga identify: {}", error.message);
        Usable::new("telemetry log", holds).with(vec![warning])
    });
    Ok(usable.counting(contents.traffic, "reports of traffic"))
}

#[cfg(not(feature = "fly"))]
fn telemetry(_path: &Path, log: Result<Usable, InputError>) -> Result<Usable, Failure> {
    Ok(log?)
}

/// Traffic for `fga traffic`, of which no two aircraft come close enough for an encounter.
fn feed(path: &Path, error: &InputError) -> Option<Usable> {
    let received = recordings::read_feed(path).ok()?;
    let holds = format!("{} aircraft for fga traffic", received.tracks.len());
    let warning = format!("not for fga batch: {}", error.message);
    let usable = Usable::new("feed of traffic", holds).with(vec![warning]);
    Some(usable.counting(received.tally, "lines or state vectors"))
}

fn flight_log_of(log: &FlightLog) -> Usable {
    let holds = format!("{} in flight", counted(log.pieces.len(), "piece"));
    Usable::new("flight log", holds)
}

/// Encounters as `fga batch` reads them, or a flight log as `fga identify` does.
fn encounters_in(path: &Path) -> Result<Usable, Failure> {
    match drawn::content(path)? {
        DrawnContent::Rows => {
            let rows = drawn::read_rows(path)?;
            let encounters = &rows.encounters;
            for encounter in encounters {
                rows.surroundings.scenery(encounter.id)?;
            }
            let obstacles: usize = encounters.iter().map(|each| each.obstacles.len()).sum();
            let holds = format!(
                "{}, {}",
                counted(encounters.len(), "encounter"),
                counted(obstacles, "obstacle")
            );
            Ok(Usable::new("file of encounters", holds))
        }
        DrawnContent::Tracks => {
            let found = match recorded::find(&[path.to_owned()], &VehicleModel::recorded()?) {
                Ok(found) => found,
                Err(error) => {
                    if let Some(usable) = feed(path, &error) {
                        return Ok(usable);
                    }
                    let log = flight_log::read(path).map_err(|_| error)?;
                    return Ok(flight_log_of(&log));
                }
            };
            let encounters: u64 = found.sources.iter().map(|source| source.encounters).sum();
            let kind = if path.is_dir() {
                "folder of recordings"
            } else {
                "recording"
            };
            let holds = counted(encounters, "encounter");
            let left_out = found
                .damaged
                .iter()
                .map(|damaged| format!("left out: {damaged}"));
            Ok(Usable::new(kind, holds)
                .with(left_out.collect())
                .counting(found.tally, PARTS))
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

fn toml_file(path: &Path, kind: FileKind) -> Result<Usable, Failure> {
    let words = format!("{kind} file");
    match kind {
        FileKind::Scenario => {
            let plan = scenario::read(path, None)?;
            let zones = match plan.world.zones.len() {
                0 => String::new(),
                zones => format!("{}, ", counted(zones, "zone")),
            };
            if let Some(refusal) = plan.refusal() {
                return Err(InputError::in_file(path, refusal).into());
            }
            let sees = plan.must_see_m().map_or_else(String::new, |must_see_m| {
                format!(", must see {must_see_m:.0} m ahead")
            });
            let holds = format!(
                "{}, {}, {zones}vehicle {}{sees}",
                counted(plan.world.mission_m.len(), "waypoint"),
                counted(plan.world.obstacles.len(), "obstacle"),
                plan.model.name
            );
            Ok(Usable::new(words, holds).with(plan.warnings()))
        }
        FileKind::Vehicle => {
            let model = VehicleModel::read(path)?;
            let holds = format!(
                "{}, {} m/s, turn radius {:.1} m, must see crewed traffic at {CREWED_MPS} m/s {:.0} m ahead",
                model.name,
                model.vehicle.airspeed_mps,
                model.vehicle.turn_radius_m,
                model.must_see_m()
            );
            Ok(Usable::new(words, holds).with(model.warnings()))
        }
        FileKind::Campaign => {
            let configuration = match campaign_file::read(path, &Overrides::default()) {
                Ok(configuration) => configuration,
                Err(error) => {
                    let holds = outline(path).ok_or(error)?;
                    return Ok(Usable::new(words, holds));
                }
            };
            let campaign = Campaign::new(configuration, path)?;
            let holds = format!(
                "{} from {}, {}, vehicle {}",
                counted(campaign.configuration.encounters, "encounter"),
                counted(campaign.source_names().len(), "source"),
                counted(campaign.policies.len(), "policy"),
                campaign.model.name
            );
            Ok(Usable::new(words, holds))
        }
        FileKind::Link => link(path),
    }
}

#[cfg(feature = "fly")]
fn link(path: &Path) -> Result<Usable, Failure> {
    let (config, terrain) = crate::fly::config_file(path)?;
    let crewed = config.volume(fga_link::traffic::AircraftClass::Crewed);
    let area = terrain.and_then(|terrain| terrain.area());
    let over = area.map_or_else(String::new, |area| format!(", knows the ground of {area}"));
    let holds = format!(
        "takes over {}, keeps {} x +-{} m from crewed aircraft, {}{over}",
        config.vehicle.take_over.join(" and "),
        crewed.radius_m(),
        crewed.half_height_m(),
        counted(config.obstacle.len(), "virtual obstacle")
    );
    Ok(Usable::new("link file", holds).with(config.warnings()))
}

#[cfg(not(feature = "fly"))]
fn link(path: &Path) -> Result<Usable, Failure> {
    Err(Failure::Input(format!(
        "{}: this program was built without the command fly, expected one built with it",
        path.display()
    )))
}
