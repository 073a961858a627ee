//! Encounters side by side, for a policy that answers for all of them at once.

use fga::situation::Situation;
use fga_sim::engine::SteppedFlight;
use fga_sim::own::{FailureKind, Nobody, OwnPilot, OwnPolicy, PolicyAnswer, PolicyFailure};
use fga_sim::policy::PolicyPilot as _;
use rayon::prelude::*;

use super::row::{BatchError, BatchRow, timed};
use super::world::{BatchSettings, flyable_world, populate};
use crate::drawn::RowTable;

/// Flights side by side.
const ABREAST: usize = 4096;

/// What a policy that answers for all flights sees: for each flight that goes on, the number of its encounter, whether this
/// is its first step, and its situation.
pub type Questions<'a> = [(u64, bool, Situation<'a>)];

/// A flight with its pilot.
struct Abreast {
    encounter: u64,
    flight: SteppedFlight,
    pilot: OwnPilot,
    decisions: usize,
}

/// Flies encounters side by side, and passes the rows to `take` in the order of the encounters. `answer` sees the flights that go
/// on, in the order of the encounters, and answers for each of them; if it fails, all of them fly on along the mission.
/// `begin` comes before the first step of each group of flights.
///
/// # Errors
/// Settings that cannot be flown, surroundings that cannot be used, or the first error of `take`.
pub fn fly_together<E>(
    rows: &RowTable,
    settings: &BatchSettings,
    mut begin: impl FnMut(),
    mut answer: impl FnMut(&Questions<'_>) -> Result<Vec<PolicyAnswer>, PolicyFailure>,
    mut take: impl FnMut(&BatchRow) -> Result<(), E>,
) -> Result<(), BatchError<E>> {
    let world = flyable_world(settings)?;
    // The settings' policy counts the failures.
    let name = settings.policy.name();
    let nobody = OwnPolicy::new(name, "", Box::new(|_, _| Box::new(Nobody)));
    let policy = settings.policy.own().unwrap_or(&nobody);
    for group in rows.encounters.chunks(ABREAST) {
        let mut abreast = group
            .iter()
            .map(|encounter| {
                let mut world = world.clone();
                populate(&mut world, encounter, &settings.model.protection);
                rows.surroundings.scenery(encounter.id)?.place(&mut world);
                let pilot = policy.pilot_of_answers(&world.settings, &world.vehicle)?;
                Ok(Abreast {
                    encounter: encounter.id,
                    flight: SteppedFlight::new(world),
                    pilot,
                    decisions: 0,
                })
            })
            .collect::<Result<Vec<_>, BatchError<E>>>()?;
        begin();
        loop {
            let questions: Vec<_> = abreast
                .iter()
                .filter_map(|one| {
                    Some((one.encounter, one.decisions == 0, one.flight.situation()?))
                })
                .collect();
            if questions.is_empty() {
                break;
            }
            let asked = questions.len();
            let answers = answer(&questions).and_then(|answers| {
                let wrong = || format!("answered for {} flights, expected {asked}", answers.len());
                if answers.len() == asked {
                    Ok(answers)
                } else {
                    Err(PolicyFailure::new(FailureKind::WrongShape, wrong()))
                }
            });
            let going_on: Vec<&mut Abreast> = abreast
                .iter_mut()
                .filter(|one| one.flight.situation().is_some())
                .collect();
            match answers {
                Ok(answers) => {
                    let each = going_on.into_par_iter().zip(answers);
                    each.for_each(|(one, answer)| one.fly(Ok(answer)));
                }
                Err(failure) => {
                    for one in going_on {
                        one.fly(Err(failure.clone()));
                    }
                }
            }
        }
        for mut one in abreast {
            let outcome = one.flight.outcome();
            let row = BatchRow {
                decisions: one.decisions,
                failure: one.pilot.failure(),
                ..timed(one.encounter, outcome, &mut [])
            };
            take(&row).map_err(BatchError::Sink)?;
        }
    }
    Ok(())
}

impl Abreast {
    /// Flies an answer until the next step.
    fn fly(&mut self, answer: Result<PolicyAnswer, PolicyFailure>) {
        let Some(situation) = self.flight.situation() else {
            return;
        };
        let decision = self.pilot.decide(&situation, |_| answer);
        self.flight.advance(&decision, &mut ());
        self.decisions += 1;
    }
}
