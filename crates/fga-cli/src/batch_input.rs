//! The encounters of `fga batch`: around a line, or recorded.

use std::process::ExitCode;

use fga_campaign::batch::{
    BatchError, BatchRow, BatchSettings, EncounterTracks, MoreColumns, empty_world, fly_all,
    fly_tracks, plan, show,
};
use fga_campaign::drawn::{self, DrawnContent, RowTable};
use fga_sim::run::RunLog;
use fga_sim::vehicle_file::VehicleModel;

use serde_json::{Map, Value};

use crate::batch_args::BatchArgs;
use crate::common::tell_left_out;
use crate::failure::Failure;

/// Longest time flown around a line without `--horizon`, seconds.
pub(crate) const HORIZON_S: f64 = 60.0;

/// What recordings consist of, in the plural.
pub(crate) const PARTS: &str = "lines or rows";

/// The encounters and how they are flown.
#[derive(Debug)]
pub(crate) struct Input {
    pub(crate) settings: BatchSettings,
    /// Fingerprint of the files.
    pub(crate) sha256: String,
    encounters: BatchEncounters,
}

#[derive(Debug)]
enum BatchEncounters {
    Rows(RowTable),
    Tracks(Box<EncounterTracks>),
}

impl Input {
    /// Opens the path of the arguments; names recordings that cannot be used on standard error.
    pub(crate) fn open(args: &BatchArgs) -> Result<Self, Failure> {
        let path = &args.encounters;
        let content = drawn::content(path)?;
        let (model, longest_s) = match content {
            DrawnContent::Rows => (args.vehicle.model()?, HORIZON_S),
            DrawnContent::Tracks => (
                args.vehicle
                    .given()?
                    .map_or_else(VehicleModel::recorded, Ok)?,
                f64::INFINITY,
            ),
        };
        let settings = BatchSettings {
            model,
            policy: args.policy.choice()?,
            horizon_s: args.horizon.unwrap_or(longest_s),
            seed: args.seed,
            tracks: args.tracks,
        };
        Ok(match content {
            DrawnContent::Rows => {
                let rows = drawn::read_rows(path)?;
                Self {
                    sha256: rows.sha256.clone(),
                    encounters: BatchEncounters::Rows(rows),
                    settings,
                }
            }
            DrawnContent::Tracks => {
                let tracks = EncounterTracks::find(path, &settings)?;
                tell_left_out(&tracks.damaged, &tracks.tally, PARTS);
                Self {
                    sha256: tracks.sha256(),
                    encounters: BatchEncounters::Tracks(Box::new(tracks)),
                    settings,
                }
            }
        })
    }

    /// What the results have besides the columns of every batch.
    pub(crate) fn more_columns(&self) -> MoreColumns {
        MoreColumns {
            is_bounded: matches!(&self.encounters, BatchEncounters::Rows(rows) if rows.surroundings.exist()),
            is_own: self.settings.policy.own().is_some(),
            is_named: self.names().is_some(),
        }
    }

    /// Names of the encounters, where they have names.
    pub(crate) fn names(&self) -> Option<&[String]> {
        match &self.encounters {
            BatchEncounters::Rows(_) => None,
            BatchEncounters::Tracks(tracks) => Some(tracks.names()),
        }
    }

    /// What was left out, by reason, with the number of recordings left out as a whole.
    pub(crate) fn left_out(&self) -> Map<String, Value> {
        match &self.encounters {
            BatchEncounters::Rows(_) => Map::new(),
            BatchEncounters::Tracks(tracks) => left_out(tracks),
        }
    }

    /// Flies all of them in their order.
    pub(crate) fn fly<E: Send>(
        &self,
        take: impl FnMut(&BatchRow) -> Result<(), E>,
    ) -> Result<(), BatchError<E>> {
        match &self.encounters {
            BatchEncounters::Rows(rows) => fly_all(rows, &self.settings, take),
            BatchEncounters::Tracks(tracks) => fly_tracks(tracks, &self.settings, take),
        }
    }

    /// Flies one again and logs everything; `None` past the last.
    pub(crate) fn show(&self, place: usize) -> Result<Option<RunLog>, Failure> {
        let policy = &self.settings.policy;
        match &self.encounters {
            BatchEncounters::Rows(rows) => {
                let (Some(mut world), Some(encounter)) =
                    (empty_world(&self.settings), rows.encounters.get(place))
                else {
                    return Ok(None);
                };
                let scenery = rows.surroundings.scenery(encounter.id)?;
                scenery.place(&mut world);
                let plan = plan(world, encounter, &self.settings.model);
                Ok(Some(show(plan, policy)?))
            }
            BatchEncounters::Tracks(tracks) => {
                let plan = tracks.plan(place, &self.settings)?;
                Ok(Some(fga_sim::run::fly(plan, policy, &mut |_| ())?))
            }
        }
    }

    /// Left-out recordings are an error unless `--skip-damaged` accepts them.
    pub(crate) fn verdict(&self, skip_damaged: bool) -> Result<ExitCode, Failure> {
        match &self.encounters {
            BatchEncounters::Rows(_) => Ok(ExitCode::SUCCESS),
            BatchEncounters::Tracks(tracks) => verdict(tracks, skip_damaged),
        }
    }
}

/// The number of reports that recordings left out, by reason, and of the recordings left out whole.
pub(crate) fn left_out(tracks: &EncounterTracks) -> Map<String, Value> {
    let mut left_out = tracks.tally.to_json();
    left_out.insert("recordings".into(), tracks.damaged.len().into());
    left_out
}

/// Left-out recordings are an error unless `--skip-damaged` accepts them.
pub(crate) fn verdict(tracks: &EncounterTracks, skip_damaged: bool) -> Result<ExitCode, Failure> {
    let damaged = tracks.damaged.len();
    if damaged == 0 || skip_damaged {
        return Ok(ExitCode::SUCCESS);
    }
    Err(Failure::Input(format!(
        "{damaged} of {} recordings cannot be used and were left out, the rest is flown; with --skip-damaged that is a success",
        tracks.files()
    )))
}
