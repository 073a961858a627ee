//! `fga oracle`: could any manoeuvre save the encounter?

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use fga_campaign::batch::{BatchSettings, EncounterTracks};
use fga_campaign::drawn::{self, DrawnContent};
use fga_campaign::oracle::{AVOIDABLE_MARGIN_M, Judge, OracleSettings, best_margin_of_tracks};
use fga_formats::OutputError;
use fga_formats::atomic::AtomicFile;
use fga_formats::number::push_fixed;
use fga_formats::words::{counted, push_csv_field};
use fga_sim::policy::PolicyChoice;
use fga_sim::vehicle_file::VehicleModel;
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use crate::batch_args::positive_seconds;
use crate::batch_input::{PARTS, left_out, verdict};
use crate::common::{
    AnswerArgs, OutArgs, ThreadArgs, VehicleArgs, interrupted, tell_left_out, watch_for_interrupt,
};
use crate::failure::Failure;

/// Encounters searched between two writes.
const BLOCK: usize = 64;

/// Options of `fga oracle`.
#[derive(Args, Debug)]
pub(crate) struct OracleArgs {
    /// Encounters as for `fga batch`.
    encounters: PathBuf,
    #[command(flatten)]
    vehicle: VehicleArgs,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Time over which the margin counts, seconds.
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = positive_seconds)]
    horizon: f64,
    /// Exit with 0 although damaged recordings were left out.
    #[arg(long)]
    skip_damaged: bool,
    #[command(flatten)]
    answer: AnswerArgs,
}

/// The oracle's answer about one encounter.
struct OracleLine {
    encounter: u64,
    margin_m: f64,
    /// Its name and the begin of the search, seconds, where tracks are known.
    track: Option<(String, f64)>,
}

/// Columns for encounters around a line, whose obstacles fly straight.
const COLUMNS: &str = "encounter,avoidable,best_margin_m";

/// More columns for tracks: the oracle knows them to their end.
const TRACK_COLUMNS: &str = "name,start_s,knows";

/// What the oracle knows of aircraft with tracks.
const WHOLE_TRACKS: &str = "whole tracks";

/// Searches every encounter and writes `oracle.csv`.
pub(crate) fn run(args: &OracleArgs) -> Result<ExitCode, Failure> {
    let path = &args.encounters;
    match drawn::content(path)? {
        DrawnContent::Rows => {
            let model = args.vehicle.model()?;
            let rows = drawn::read_rows(path)?;
            let judge = Judge::new(&model, args.horizon).map_err(Failure::Input)?;
            let search = |place: usize| {
                let Some(encounter) = rows.encounters.get(place) else {
                    return Err(Failure::Input(format!("there is no encounter {place}")));
                };
                let scenery = rows.surroundings.scenery(encounter.id)?;
                Ok(OracleLine {
                    encounter: encounter.id,
                    margin_m: judge.best_margin_among_m(encounter, &scenery),
                    track: None,
                })
            };
            let found = (COLUMNS, rows.encounters.len(), Map::new());
            search_all(args, &model, found, search)?;
            Ok(ExitCode::SUCCESS)
        }
        DrawnContent::Tracks => {
            let given = args.vehicle.given()?;
            let model = given.map_or_else(VehicleModel::recorded, Ok)?;
            let settings = BatchSettings {
                horizon_s: f64::INFINITY,
                ..BatchSettings::of(model, PolicyChoice::default())
            };
            let tracks = EncounterTracks::find(path, &settings)?;
            tell_left_out(&tracks.damaged, &tracks.tally, PARTS);
            let oracle = OracleSettings {
                horizon_s: args.horizon,
                ..OracleSettings::default()
            };
            let search = |place: usize| {
                let plan = tracks.plan(place, &settings)?;
                // A plan of a recording has a recorded ownship.
                let answer = best_margin_of_tracks(&plan.world, &oracle);
                Ok(OracleLine {
                    encounter: place as u64,
                    margin_m: answer.map_or(f64::NEG_INFINITY, |answer| answer.best_margin_m),
                    track: answer.map(|answer| (plan.name, answer.start_s)),
                })
            };
            let columns = format!("{COLUMNS},{TRACK_COLUMNS}");
            let found = (&*columns, tracks.len(), left_out(&tracks));
            search_all(args, &settings.model, found, search)?;
            verdict(&tracks, args.skip_damaged)
        }
    }
}

/// Searches `count` encounters by their places and writes their rows in that order; answers with what was left out of them.
fn search_all(
    args: &OracleArgs,
    model: &VehicleModel,
    (columns, count, left_out): (&str, usize, Map<String, Value>),
    search: impl Fn(usize) -> Result<OracleLine, Failure> + Sync,
) -> Result<(), Failure> {
    let folder = args.out.prepare(&args.encounters)?;
    watch_for_interrupt();
    let path = folder.join("oracle.csv");
    let failed = |error| OutputError::new(&path, error);
    let mut file = AtomicFile::create(&path)?;
    writeln!(file, "{columns}").map_err(failed)?;
    let mut avoidable = 0_usize;
    let mut line = Vec::new();
    let places: Vec<usize> = (0..count).collect();
    args.threads.install(|| {
        for block in places.chunks(BLOCK) {
            let answers: Vec<Result<OracleLine, Failure>> =
                block.par_iter().map(|place| search(*place)).collect();
            if interrupted() {
                return Err(Failure::Interrupted);
            }
            for answer in answers {
                let answer = answer?;
                let is_avoidable = answer.margin_m >= AVOIDABLE_MARGIN_M;
                avoidable += usize::from(is_avoidable);
                line.clear();
                line.extend_from_slice(format!("{},{is_avoidable},", answer.encounter).as_bytes());
                push_fixed(&mut line, answer.margin_m, 6);
                if let Some((name, start_s)) = &answer.track {
                    line.push(b',');
                    push_csv_field(&mut line, name.as_bytes());
                    line.push(b',');
                    push_fixed(&mut line, *start_s, 3);
                    line.extend_from_slice(format!(",{WHOLE_TRACKS}").as_bytes());
                }
                line.push(b'\n');
                file.write_all(&line).map_err(failed)?;
            }
        }
        Ok(())
    })??;
    file.commit()?;
    let share = avoidable as f64 / count.max(1) as f64;
    args.answer.print(
        || {
            format!(
                "{}, vehicle {}: {avoidable} avoidable ({:.2} %); results in {}\n",
                counted(count, "encounter"),
                model.name,
                100.0 * share,
                folder.display()
            )
        },
        &json!({
            "encounters": count,
            "left_out": left_out,
            "vehicle": model.name,
            "avoidable": avoidable,
            "avoidable_share": share,
            "results": folder.display().to_string(),
        }),
    )
}
