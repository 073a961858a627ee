//! Decisions that need not be made: those of a pilot that flies straight on whatever it sees, and those that it knows
//! beforehand while it sees what it expects.
//!
//! Nothing happens in straight flight until it ends, so the engine flies it as one arc and measures it in
//! closed form. Its last cycles are flown one by one, which find the end as in every flight. No flight ends during known
//! decisions: they are none of a cruise.

use fga::Vec3;
use fga::avoider::Decision;
use fga::maneuver::Maneuver;
use fga::pilot::Pilot;
use fga::situation::Situation;

use super::steps::path_over_ground_m;
use super::{Flight, situation};
use crate::track::Track;
use crate::world::Ending;

/// A flight that drifts off its line by more than this is not straight along it, metres.
const ALONG_WITHIN_M: f64 = 1e-6;

/// Times this close to each other are one moment, seconds.
const SAME_MOMENT_S: f64 = 1e-9;

impl Flight<'_> {
    /// Number of cycles that a decision is flown; at least one. The pilot leaves out the decisions of the others.
    pub(super) fn cycles_alike(
        &self,
        time_s: f64,
        decision: &Decision,
        pilot: &mut (impl Pilot + ?Sized),
    ) -> u32 {
        if self.replaying().is_some() {
            return 1;
        }
        let now = situation(self.world, self.plant.ownship(), self.sensor, time_s);
        let stands_s = pilot.stands_s(&now);
        let is_straight = self.plant.is_straight_under(&decision.command);
        if stands_s > 0.0 && self.state.progress.is_one_leg() && is_straight {
            return self.straight_cycles(time_s, stands_s);
        }
        // Before its first stage a command holds what is flown at its beginning, which changes in a turn.
        if decision.command.stage_at(0.0).is_none() && !is_straight {
            return 1;
        }
        let known = self.known_cycles(time_s, &now, pilot);
        pilot.leave_out(known);
        1 + known
    }

    /// Number of next decisions that the pilot knows, before the aircraft could see anything else and before the horizon.
    fn known_cycles(&self, time_s: f64, now: &Situation<'_>, pilot: &(impl Pilot + ?Sized)) -> u32 {
        let world = self.world;
        let known = pilot.known_decisions(now);
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

    /// Flies a command for some cycles without a decision in between, and measures. Where the mission is one leg, the
    /// distance from it is largest at an end of a straight arc; elsewhere the progress is followed cycle by cycle.
    pub(super) fn advance_cycles(&mut self, command: &Maneuver, time_s: f64, cycles: u32) {
        let period_s = self.world.settings.avoider.decision_period_s;
        let obstacles = &self.world.obstacles;
        let separations = &mut *self.separations;
        let (flown_m, progress) = (&mut self.state.flown_m, &mut self.state.progress);
        let is_one_leg = progress.is_one_leg();
        // The last cycle ends with a decision, which follows the mission.
        let mut followed = 0;
        self.plant.command(command, f64::from(cycles) * period_s);
        self.plant.advance_cycles(cycles, period_s, |arc, end_m| {
            *flown_m += path_over_ground_m(arc, end_m);
            for (separation, obstacle) in separations.iter_mut().zip(obstacles) {
                separation.observe(arc, end_m, &obstacle.track);
            }
            let end_s = arc.start_s + arc.duration_s + SAME_MOMENT_S;
            let is_convex = is_one_leg && arc.is_straight();
            let due_s = |cycle: u32| time_s + f64::from(cycle) * period_s;
            let mut is_first = true;
            while followed + 1 < cycles && due_s(followed + 1) <= end_s {
                followed += 1;
                let is_last = followed + 1 == cycles || due_s(followed + 1) > end_s;
                if is_convex && !is_first && !is_last {
                    continue;
                }
                is_first = false;
                let after_s = due_s(followed) - arc.start_s;
                let place_m = if after_s + SAME_MOMENT_S >= arc.duration_s {
                    end_m
                } else {
                    arc.position_at_m(after_s)
                };
                progress.follow(due_s(followed), place_m, || arc.velocity_at_mps(after_s));
            }
        });
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
