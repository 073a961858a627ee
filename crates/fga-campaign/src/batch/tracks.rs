//! Recorded or drawn aircraft, each encounter flown in closed loop.
//!
//! The first aircraft of an encounter is the ownship and flies as recorded until it manoeuvres; see
//! [`fga_sim::recording`]. Numbers count from 0 in the order of the files. A drawn encounter keeps its
//! master seed and its stream, so that it has the sensor noise of its campaign.

use std::path::Path;

use fga_formats::InputError;
use fga_formats::tally::Tally;
use fga_sim::engine::Engine;
use fga_sim::plan::Plan;
use rayon::prelude::*;

use super::row::{BLOCK, BatchError, BatchRow, row_of};
use super::world::BatchSettings;
use crate::drawn::Origin;
use crate::recorded::{self, Recordings};

/// The encounters of a folder or a file.
#[derive(Debug)]
pub struct EncounterTracks {
    recordings: Recordings,
    /// The faults of the files that were left out, one sentence each.
    pub damaged: Vec<String>,
    /// What became of the lines and rows of the other files.
    pub tally: Tally,
}

impl EncounterTracks {
    /// Finds the recordings of a folder or a file and tries each as a flight of the settings' aircraft.
    ///
    /// # Errors
    /// An unreadable path, or no usable recording.
    pub fn find(path: &Path, settings: &BatchSettings) -> Result<Self, InputError> {
        let found = recorded::find(&[path.to_owned()], &settings.model)?;
        Ok(Self {
            recordings: Recordings::open(&found.sources)?,
            damaged: found.damaged,
            tally: found.tally,
        })
    }

    /// Number of encounters.
    pub fn len(&self) -> usize {
        self.recordings.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Names of the encounters in their order.
    pub fn names(&self) -> &[String] {
        self.recordings.names()
    }

    /// Number of files, with those that were left out.
    pub fn files(&self) -> usize {
        self.recordings.files() + self.damaged.len()
    }

    /// Fingerprint of the content of the files.
    pub fn sha256(&self) -> String {
        self.recordings.sha256()
    }

    /// An encounter as a flight; its longest time is the least of the recording's and the settings'.
    ///
    /// # Errors
    /// A number past the last; a file that changed.
    pub fn plan(&self, number: usize, settings: &BatchSettings) -> Result<Plan, InputError> {
        let named = self.recordings.get(number)?.zip(self.names().get(number));
        let Some(((recording, _), name)) = named else {
            let message = format!("encounter {number} does not exist");
            return Err(InputError::in_file("recordings", message));
        };
        let wrong = |message: String| InputError::in_file(name, message);
        let origin = Origin::of(&recording).map_err(wrong)?;
        let mut plan = recorded::plan_of(&recording, name, &settings.model).map_err(wrong)?;
        plan.world.seed = origin.seed.unwrap_or(settings.seed);
        plan.world.stream = origin.number.unwrap_or(number as u64);
        plan.world.horizon_s = plan.world.horizon_s.min(settings.horizon_s);
        Ok(plan)
    }
}

/// Flies every encounter on the threads of the current pool and passes the rows to `take` in their
/// order.
///
/// # Errors
/// Settings that cannot be flown, a file that changed, or the first error of `take`.
pub fn fly_tracks<E: Send>(
    tracks: &EncounterTracks,
    settings: &BatchSettings,
    mut take: impl FnMut(&BatchRow) -> Result<(), E>,
) -> Result<(), BatchError<E>> {
    let numbers: Vec<usize> = (0..tracks.len()).collect();
    for block in numbers.chunks(BLOCK) {
        let rows: Vec<Result<BatchRow, BatchError<E>>> = block
            .par_iter()
            .map_init(Engine::new, |engine, number| {
                fly_one(engine, tracks, *number, settings)
            })
            .collect();
        for row in rows {
            take(&row?).map_err(BatchError::Sink)?;
        }
    }
    Ok(())
}

fn fly_one<E: Send>(
    engine: &mut Engine,
    tracks: &EncounterTracks,
    number: usize,
    settings: &BatchSettings,
) -> Result<BatchRow, BatchError<E>> {
    let world = tracks.plan(number, settings)?.world;
    let world = settings.policy.sees(&world).unwrap_or(world);
    let mut pilot = settings.policy.pilot(&world.settings, &world.vehicle)?;
    let asked = (number as u64, settings.tracks);
    Ok(row_of(engine, &world, pilot.as_mut(), asked))
}
