//! Decisions that need not be made: those of a pilot that flies straight on whatever it sees, and those that it knows
//! beforehand while it sees what it expects.
//!
//! Nothing happens in straight flight until it ends, so the engine flies it as one arc and measures it in
//! closed form. Its last cycles are flown one by one, which find the end as in every flight.

use fga::Vec3;
use fga::avoider::Decision;
use fga::maneuver::Maneuver;
use fga::pilot::Pilot;

use super::{Flight, situation};
use crate::track::Track;
use crate::world::Ending;

/// A flight that drifts off its line by more than this is not straight along it, metres.
const ALONG_WITHIN_M: f64 = 1e-6;

/// Rounding of times, seconds.
const ROUNDING_S: f64 = 1e-6;

impl Flight<'_> {
    /// Number of cycles for which a decision stands whatever the pilot sees; at least one.
    pub(super) fn cycles_alike(
        &self,
        time_s: f64,
        decision: &Decision,
        pilot: &(impl Pilot + ?Sized),
    ) -> u32 {
        let now = situation(self.world, self.plant.ownship(), self.sensor, time_s);
        let stands_s = pilot.stands_s(&now);
        let is_known = stands_s > 0.0
            && self.replaying().is_none()
            && self.state.progress.is_one_leg()
            && self.plant.is_straight_under((&decision.command, 0.0));
        if is_known {
            self.straight_cycles(time_s, stands_s)
        } else {
            1
        }
    }

    /// Number of cycles, at most `most`, in which a manoeuvre that has been flown for some seconds commands the same; at least one.
    pub(super) fn cycles_commanded(&self, (maneuver, flown_s): (&Maneuver, f64), most: u32) -> u32 {
        let is_late = self.plant.vehicle().response.dead_time_s > 0.0;
        // Before its first stage it holds what is flown, which changes in a turn.
        let changes = maneuver.stage_at(flown_s).is_none()
            && !self.plant.is_straight_under((maneuver, flown_s));
        if most == 1 || is_late || changes {
            return 1;
        }
        let period_s = self.world.settings.avoider.decision_period_s;
        let starts_s = maneuver
            .stages()
            .iter()
            .map(|stage| stage.start_s - flown_s);
        let until_s = (starts_s.filter(|starts_s| *starts_s > -ROUNDING_S))
            .fold(f64::INFINITY, f64::min)
            - ROUNDING_S;
        (2..=most)
            .take_while(|cycles| f64::from(*cycles) * period_s < until_s)
            .last()
            .unwrap_or(1)
    }

    /// Number of next decisions that the pilot knows, before the aircraft could see anything else and before the horizon.
    pub(super) fn known_cycles(&self, time_s: f64, pilot: &(impl Pilot + ?Sized)) -> u32 {
        let world = self.world;
        if self.replaying().is_some() {
            return 0;
        }
        let now = situation(world, self.plant.ownship(), self.sensor, time_s);
        let known = pilot.known_decisions(&now);
        if known == 0 {
            return 0;
        }
        let ours_mps = world.vehicle.airspeed_mps + world.wind_mps.length();
        let alike_s = (self.sensor)
            .alike_for_s(time_s, (now.ownship.position_m, ours_mps), &world.obstacles)
            .min(world.horizon_s - time_s);
        let most = alike_s / world.settings.avoider.decision_period_s - 2.0;
        (0..known).find(|k| f64::from(*k) >= most).unwrap_or(known)
    }

    /// Number of cycles of straight flight on which nothing ends; at least one.
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
