//! A policy outside of this crate as a policy of the engine, and its pilot.

use alloc::sync::Arc;
use core::fmt;
use std::sync::{Mutex, PoisonError};

use crate::mission_pilot::MissionPilot;
use fga::angle::wrap_pi;
use fga::avoider::{Decision, Reason, SettingsError, State};
use fga::maneuver::Maneuver;
use fga::pilot::Pilot;
use fga::situation::Situation;
use fga::vehicle::Vehicle;
use fga_formats::words::counted;

use super::outside::Nobody;
use super::{FailureKind, Make, Outside, PolicyAnswer, PolicyFailure};
use crate::baselines::{RelativeRoute, avoiding, returning};
use crate::policy_pilot::PolicyPilot;
use crate::settings::PolicySettings;

/// A policy of one's own by its name.
#[derive(Clone)]
pub struct OwnPolicy(Arc<Inner>);

struct Inner {
    name: String,
    sha256: String,
    make: Box<Make>,
    failed: Mutex<Failed>,
}

/// Failures of a policy so far.
#[derive(Default)]
struct Failed {
    flights: u64,
    first: Option<String>,
}

impl OwnPolicy {
    /// A policy with its name, the fingerprint of its code, and what answers for it.
    pub fn new(name: impl Into<String>, sha256: impl Into<String>, make: Box<Make>) -> Self {
        Self(Arc::new(Inner {
            name: name.into(),
            sha256: sha256.into(),
            make,
            failed: Mutex::default(),
        }))
    }

    /// Its name in files.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// Fingerprint of its code, so that results of other code are not taken for its own.
    pub fn sha256(&self) -> &str {
        &self.0.sha256
    }

    /// A pilot that asks it.
    ///
    /// # Errors
    /// Settings or limits that the core's guidance refuses.
    pub fn pilot(
        &self,
        settings: &PolicySettings,
        vehicle: &Vehicle,
    ) -> Result<OwnPilot, SettingsError> {
        self.pilot_of((self.0.make)(settings, vehicle), settings, vehicle)
    }

    /// A pilot that asks nobody: its answers are given to it.
    ///
    /// # Errors
    /// As [`Self::pilot`].
    pub fn pilot_of_answers(
        &self,
        settings: &PolicySettings,
        vehicle: &Vehicle,
    ) -> Result<OwnPilot, SettingsError> {
        self.pilot_of(Box::new(Nobody), settings, vehicle)
    }

    fn pilot_of(
        &self,
        outside: Box<dyn Outside>,
        settings: &PolicySettings,
        vehicle: &Vehicle,
    ) -> Result<OwnPilot, SettingsError> {
        settings.avoider.check()?;
        Ok(OwnPilot {
            policy: self.clone(),
            outside,
            guide: MissionPilot::new(settings.avoider.horizon_s, *vehicle)?,
            state: State::Cruise,
            failure: None,
        })
    }

    /// In how many flights it has failed so far, with the first failure, as one sentence; `None` without any. Which one is the
    /// first depends on threads.
    pub fn failures_in_words(&self) -> Option<String> {
        let failed = self.0.failed.lock().unwrap_or_else(PoisonError::into_inner);
        let first = failed.first.as_ref()?;
        Some(format!(
            "policy {} failed in {} and flew the rest of each on the mission; one of them {first}",
            self.name(),
            counted(failed.flights, "flight"),
        ))
    }

    fn note(&self, time_s: f64, failure: &PolicyFailure) {
        let mut failed = self.0.failed.lock().unwrap_or_else(PoisonError::into_inner);
        failed.flights += 1;
        failed
            .first
            .get_or_insert_with(|| format!("at {time_s:.1} s: {failure}"));
    }
}

impl fmt::Debug for OwnPolicy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("OwnPolicy").field(&self.0.name).finish()
    }
}

impl PartialEq for OwnPolicy {
    fn eq(&self, other: &Self) -> bool {
        self.0.name == other.0.name && self.0.sha256 == other.0.sha256
    }
}

/// Flies what a policy of one's own answers.
pub struct OwnPilot {
    policy: OwnPolicy,
    outside: Box<dyn Outside>,
    /// The core's own guidance along the mission.
    guide: MissionPilot,
    state: State,
    failure: Option<FailureKind>,
}

impl OwnPilot {
    /// The decision by an answer; without one, and from a failure on, the mission.
    pub fn decide(
        &mut self,
        situation: &Situation<'_>,
        answer: impl FnOnce(&mut dyn Outside) -> Result<PolicyAnswer, PolicyFailure>,
    ) -> Decision {
        let mut decision = self.guide.step(situation);
        if decision.record.reason == Reason::InvalidInput {
            return decision;
        }
        let answer = match self.failure {
            Some(_) => PolicyAnswer::Mission,
            None => answer(self.outside.as_mut())
                .and_then(checked)
                .unwrap_or_else(|failure| {
                    self.policy.note(situation.time_s, &failure);
                    self.failure = Some(failure.kind);
                    PolicyAnswer::Mission
                }),
        };
        match answer {
            PolicyAnswer::Decided(decided) => {
                self.state = decided.state;
                return *decided;
            }
            PolicyAnswer::Heading {
                course_rad,
                climb_rad,
            } => {
                let own_rad = situation.ownship.course_rad;
                let vehicle = self.guide.vehicle();
                let (least, most) = (vehicle.climb_min_rad, vehicle.climb_max_rad);
                decision.command = Maneuver::turn(
                    0.0,
                    own_rad + wrap_pi(course_rad - own_rad),
                    climb_rad.clamp(least, most),
                )
                .into();
                decision.record.reason = avoiding(&mut self.state);
            }
            PolicyAnswer::Mission => {
                let route = RelativeRoute::of(situation, self.guide.leg_index());
                let reason = decision.record.reason;
                (self.state, decision.record.reason) =
                    returning(self.state, situation, &route, reason);
            }
        }
        decision.state = self.state;
        decision
    }
}

/// An answer whose numbers are finite.
fn checked(answer: PolicyAnswer) -> Result<PolicyAnswer, PolicyFailure> {
    let numbers = |what: &str, course_rad: f64, climb_rad: f64| {
        if course_rad.is_finite() && climb_rad.is_finite() {
            return Ok(());
        }
        Err(PolicyFailure::new(
            FailureKind::NotFinite,
            format!(
                "{what} has course_rad {course_rad} and climb_rad {climb_rad}, expected finite numbers"
            ),
        ))
    };
    match &answer {
        PolicyAnswer::Mission => {}
        PolicyAnswer::Heading {
            course_rad,
            climb_rad,
        } => numbers("the answer", *course_rad, *climb_rad)?,
        PolicyAnswer::Decided(decision) => {
            for stage in decision.command.stages() {
                numbers("a stage", stage.course_rad, stage.climb_rad)?;
            }
        }
    }
    Ok(answer)
}

impl Pilot for OwnPilot {
    fn step(&mut self, situation: &Situation<'_>) -> Decision {
        self.decide(situation, |outside| outside.answer(situation))
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        // If the guidance refuses the limits, it keeps its present ones.
        if self.guide.set_vehicle(*vehicle).is_ok() {
            self.outside.retune(vehicle);
        }
    }

    fn restart(&mut self) {
        self.guide.restart();
        self.outside.restart();
        self.state = State::Cruise;
        self.failure = None;
    }
}

impl PolicyPilot for OwnPilot {
    fn failure(&self) -> Option<FailureKind> {
        self.failure
    }
}
