//! The seam between decisions and flights: a situation in, a decision out.
//!
//! Simulator, campaigns and autopilot links fly any [`Pilot`]: the [`Avoider`], the mission alone, the paper's rules, a peer, or one
//! of your own.

use crate::avoider::belief::{BeliefAvoider, Beliefs};
use crate::avoider::{Avoider, Decision, Places};
use crate::situation::Situation;
use crate::vehicle::Vehicle;

/// Decides step by step: from a situation to a command until the next step.
pub trait Pilot {
    /// Decides the command until the next step.
    fn step(&mut self, situation: &Situation<'_>) -> Decision;

    /// How long its next decisions say the same whatever it sees, if the aircraft flies straight on after
    /// its last one, seconds; 0 for a pilot that looks.
    fn stands_s(&self, _situation: &Situation<'_>) -> f64 {
        0.0
    }

    /// What it believes of the aircraft around, if it flies by that.
    fn beliefs(&self) -> Option<&Beliefs> {
        None
    }

    /// Applies changed limits of the vehicle; called only before it has manoeuvred. Unusable limits
    /// change nothing.
    fn retune(&mut self, vehicle: &Vehicle);

    /// The next situations have another mission, whose first `kept` waypoints are those of before. Begins another flight, unless it knows better.
    fn replace_mission(&mut self, _kept: usize) {
        self.restart();
    }

    /// Forgets the last flight: the next step is the first of another one, with the original limits of
    /// the vehicle.
    fn restart(&mut self);
}

impl<P: Places + 'static> Pilot for Avoider<P> {
    fn step(&mut self, situation: &Situation<'_>) -> Decision {
        (**self).step(situation)
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        // If it refuses the limits, it keeps its present ones.
        let _ = self.set_vehicle(*vehicle);
    }

    fn replace_mission(&mut self, kept: usize) {
        (**self).replace_mission(kept);
    }

    fn restart(&mut self) {
        self.forget_flight();
    }
}

impl Pilot for BeliefAvoider {
    fn step(&mut self, situation: &Situation<'_>) -> Decision {
        self.step(situation)
    }

    fn beliefs(&self) -> Option<&Beliefs> {
        Some(self.beliefs())
    }

    fn retune(&mut self, vehicle: &Vehicle) {
        self.avoider_mut().retune(vehicle);
    }

    fn replace_mission(&mut self, kept: usize) {
        Pilot::replace_mission(self.avoider_mut(), kept);
    }

    fn restart(&mut self) {
        self.forget_flight();
    }
}
