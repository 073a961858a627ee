//! The pilot of the choice among the futures of a belief, in shadow: the policy `belief`.

use fga::avoider::{Decision, Reason, SettingsError, State};
use fga::maneuver::Maneuver;
use fga::pilot::Pilot;
use fga::situation::Situation;
use fga::vehicle::Vehicle;
use fga_belief::Errors;
use fga_choice::{Choice, Chooser};

use crate::baselines::{RelativeRoute, avoiding, returning};

/// Flies the least expected cost. It takes reports as they come, without a tracker.
#[derive(Debug, Clone)]
pub struct BeliefPilot {
    chooser: Box<Chooser>,
    made_for: Vehicle,
    errors: Errors,
    state: State,
    choice: Choice,
}

impl BeliefPilot {
    /// A pilot on the first leg; reports have these errors.
    ///
    /// # Errors
    /// A limit of the vehicle that is not finite or out of range.
    pub fn new(vehicle: &Vehicle, errors: &Errors) -> Result<Self, SettingsError> {
        Ok(Self {
            chooser: Box::new(Chooser::new(*vehicle)?),
            made_for: *vehicle,
            errors: *errors,
            state: State::Cruise,
            choice: Choice::default(),
        })
    }

    /// The last choice, with its chances.
    pub const fn choice(&self) -> &Choice {
        &self.choice
    }
}

impl Pilot for BeliefPilot {
    fn step(&mut self, situation: &Situation<'_>) -> Decision {
        if !situation.is_usable() {
            return Decision::new(State::Cruise, &Maneuver::hold(), Reason::InvalidInput);
        }
        self.choice = self.chooser.step(situation, &self.errors);
        let mut decision = Decision {
            command: self.choice.command.into(),
            ..Decision::default()
        };
        decision.record.reason = if self.choice.avoids {
            avoiding(&mut self.state)
        } else {
            let route = RelativeRoute::of(situation, self.chooser.leg_index());
            let reason = if self.chooser.is_complete() {
                Reason::MissionComplete
            } else {
                Reason::Clear
            };
            let (state, reason) = returning(self.state, situation, &route, reason);
            self.state = state;
            reason
        };
        decision.state = self.state;
        decision
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        self.chooser.set_vehicle(vehicle);
    }

    fn restart(&mut self) {
        // The limits were checked when it was made.
        if let Ok(chooser) = Chooser::new(self.made_for) {
            *self.chooser = chooser;
        }
        self.state = State::Cruise;
        self.choice = Choice::default();
    }
}
