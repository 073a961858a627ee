//! Decisions that need not be made: those of a pilot that flies straight on whatever it sees, and those that it knows
//! beforehand while it sees what it expects.
//!
//! Nothing happens in straight flight until it ends, so the engine flies it as one arc and measures it in
//! closed form. Its last cycles are flown one by one, which find the end as in every flight.

use fga::Vec3;
use fga::avoider::Decision;
use fga::pilot::Pilot;

use super::{Flight, situation};
use crate::track::Track;
use crate::world::Ending;

/// A flight that drifts off its line by more than this is not straight along it, metres.
const ALONG_WITHIN_M: f64 = 1e-6;

/// Cycles that fly on one decision.
#[derive(Debug, Clone, Copy)]
pub(super) struct Alike {
    /// Their number, at least one.
    pub cycles: u32,
    /// Whether the aircraft flies straight in all of them.
    pub is_straight: bool,
}

impl Alike {
    /// The cycle of the decision alone.
    pub(super) const ONE: Self = Self {
        cycles: 1,
        is_straight: true,
    };
}

impl Flight<'_> {
    /// The cycles that fly on a decision.
    pub(super) fn alike(
        &self,
        time_s: f64,
        decision: &Decision,
        pilot: &(impl Pilot + ?Sized),
    ) -> Alike {
        if self.replaying().is_some() || !self.state.progress.is_one_leg() {
            return Alike::ONE;
        }
        let now = situation(self.world, self.plant.ownship(), self.sensor, time_s);
        let is_straight = self.plant.is_straight_under(&decision.command);
        let stands_s = pilot.stands_s(&now);
        if is_straight && stands_s > 0.0 {
            let cycles = self.straight_cycles(time_s, stands_s);
            return Alike {
                cycles,
                is_straight,
            };
        }
        let known = self.known_cycles(time_s, pilot.known_decisions(&now));
        let period_s = self.world.settings.avoider.decision_period_s;
        let until_s = f64::from(1 + known) * period_s;
        let mut later = decision.command.stages().iter().skip(1);
        Alike {
            cycles: 1 + known,
            is_straight: is_straight && later.all(|stage| stage.start_s > until_s + 1e-9),
        }
    }

    /// Of some known decisions those before the aircraft could see anything else and before the horizon.
    fn known_cycles(&self, time_s: f64, known: u32) -> u32 {
        let world = self.world;
        if known == 0 {
            return 0;
        }
        let ours_mps = world.vehicle.airspeed_mps + world.wind_mps.length();
        let at_m = self.plant.ownship().position_m;
        let alike_s = (self
            .sensor
            .alike_for_s(time_s, (at_m, ours_mps), &world.obstacles))
        .min(world.horizon_s - time_s);
        let most = alike_s / world.settings.avoider.decision_period_s - 2.0;
        (0..known).find(|k| f64::from(*k) >= most).unwrap_or(known)
    }

    /// Number of cycles of straight flight that a pilot flies on whatever it sees; at least one.
    fn straight_cycles(&self, time_s: f64, stands_s: f64) -> u32 {
        let world = self.world;
        // Guidance corrects a drift once it has grown.
        let along = self.state.progress.direction();
        let drift_mps = self.plant.ground_velocity_mps().cross(along).length();
        let left_s = stands_s
            .min(ALONG_WITHIN_M / drift_mps)
            .min(world.horizon_s - time_s)
            .min(self.goes_on_s(time_s));
        let cycles = libm::floor(left_s / world.settings.avoider.decision_period_s) - 1.0;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a positive count; the cast keeps it in range"
        )]
        let cycles = cycles.max(1.0) as u32;
        cycles
    }

    /// How long the flight cannot end before its horizon if the aircraft flies straight on, seconds.
    fn goes_on_s(&self, time_s: f64) -> f64 {
        if self.world.ending != Ending::BackAndPassed {
            return f64::INFINITY;
        }
        let position_m = self.plant.ownship().position_m;
        let velocity_mps = self.plant.ground_velocity_mps();
        let obstacles = &self.world.obstacles;
        obstacles.iter().fold(0.0, |latest_s: f64, obstacle| {
            latest_s.max(passes_in_s(
                &obstacle.track,
                time_s,
                position_m,
                velocity_mps,
            ))
        })
    }
}

/// When an aircraft that flies straight passes an obstacle, seconds from now; 0 where a track may bend.
fn passes_in_s(track: &Track, time_s: f64, position_m: Vec3, velocity_mps: Vec3) -> f64 {
    let (Track::Straight { .. }, Some((at_m, moving_mps))) = (track, track.at(time_s)) else {
        return 0.0;
    };
    let closing_mps = velocity_mps - moving_mps;
    let square = closing_mps.length_squared();
    if square > 0.0 {
        ((at_m - position_m).dot(closing_mps) / square).max(0.0)
    } else {
        0.0
    }
}
