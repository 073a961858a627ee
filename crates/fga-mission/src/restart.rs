//! The last resorts: back to a waypoint that was missed, and straight on from here as if the mission had just begun.

use core::f64::consts::FRAC_PI_2;

use super::join::{Join, JoinLimits};
use super::leg::{Leg, LegPosition};
use super::way_onto::MOST_LEGS;
use super::{Laid, Progress};
use crate::corner::Legs as _;
use fga_proof::Vec3;
use fga_proof::limit::Limit as _;
use fga_proof::prediction::{Flyer, MotionState};
use fga_proof::situation::{FLY_OVER_WITHIN_M, Mission, Passing};

/// The aircraft flies back to its last waypoint at most so often: a wind that gusts can keep it aside for ever.
const MOST_PASSES: u32 = 3;

/// A leg that begins where the aircraft was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Restart {
    /// Index of the waypoint before its end.
    pub(super) index: usize,
    pub(super) from_m: Vec3,
    /// How often the aircraft had passed the leg's end aside of it.
    passes: u32,
}

impl Progress {
    /// Whether the aircraft flies over the end of a leg.
    pub(super) fn ends_over(mission: &Mission<'_>, index: usize) -> bool {
        mission.passing.get(index + 1) == Some(&Passing::FlyOver)
    }

    /// Whether the aircraft passed the end of a leg to fly over so far off that it flies back: aside of it, above it, or farther on than
    /// it flew in the `passed_s` seconds since the last step. Back on the line beyond the end it is not back at the waypoint.
    pub(super) fn is_missed(
        &self,
        mission: &Mission<'_>,
        (leg, position): (&Leg, &LegPosition),
        flyer: &Flyer,
        passed_s: f64,
    ) -> bool {
        let since_m = (leg.ground_speed_mps * passed_s).limited(0.0, flyer.turn_radius_m());
        let beyond_m = position.along_m - leg.length_m - since_m;
        let aside_m = position.cross_m.abs().max(position.above_m.abs());
        Self::ends_over(mission, self.index)
            && aside_m.max(beyond_m) > FLY_OVER_WITHIN_M
            && self.corner.is_none()
            && self.passes() < MOST_PASSES
    }

    /// Number of passes beside the end of the present leg after each of which the leg began again.
    fn passes(&self) -> u32 {
        let restart = self.restart.filter(|restart| restart.index == self.index);
        restart.map_or(0, |restart| restart.passes)
    }

    /// Whether the wind is too strong to fly along the present leg.
    pub fn is_adrift(&self) -> bool {
        let leg = self.leg.filter(|_| !self.complete);
        leg.is_some_and(|leg| !leg.can_be_flown(self.airspeed_mps))
    }

    /// Restarts the mission where the aircraft is: the present leg leads straight from there to its end, or to the first
    /// waypoint after it that the wind does not keep the aircraft from.
    pub(super) fn begin_here(&mut self, mission: &Mission<'_>, state: &MotionState, flyer: &Flyer) {
        let is_passed = self.leg.is_some_and(|leg| {
            leg.position(state.position_m, state.time_s).along_m >= leg.length_m
        });
        let passes = self.passes() + u32::from(is_passed);
        let from_m = state.position_m + self.wind_mps * state.time_s;
        let last = mission.waypoints_m.len().saturating_sub(1);
        let (low, high) = self.climb_limits_rad;
        let found = (self.index..last).take(MOST_LEGS).find_map(|index| {
            let mut restart = Restart {
                index,
                from_m,
                passes,
            };
            let laid = Laid {
                restart: Some(restart),
                ..self.laid(mission)
            };
            let leg = laid.leg(index).filter(|leg| leg.length_m.is_finite())?;
            let climb_rad = leg.climb_rad.limited(low, high);
            if climb_rad != leg.climb_rad {
                // Too steep to fly: as steep as can be flown, to the same end.
                let climb_mps = self.airspeed_mps * libm::sin(climb_rad) + self.wind_mps.z;
                let rise_m = climb_mps * leg.length_m / leg.ground_speed_mps;
                restart.from_m.z = mission.waypoints_m.get(index + 1)?.z - rise_m;
            }
            leg.can_be_flown(self.airspeed_mps).then_some(restart)
        });
        if let Some(restart) = found {
            self.restart = found;
            self.go_to(restart.index, false, mission, state, flyer);
        }
    }

    /// A way straight to the next waypoint, as if the mission began where the aircraft is. Without a way nothing changes.
    pub fn way_from_here(
        &mut self,
        mission: &Mission<'_>,
        state: &MotionState,
        flyer: &Flyer,
        limits: &JoinLimits,
    ) -> Option<(Join, usize)> {
        // The steepest way joins soonest, before a near waypoint too. It need not end on the leg: guidance goes on from there.
        let limits = JoinLimits {
            intercept_rad: FRAC_PI_2,
            ..*limits
        };
        let before = *self;
        self.begin_here(mission, state, flyer);
        let found = self.way_back(mission, state, flyer, &limits, MOST_LEGS);
        let found = found.filter(|_| !self.is_adrift());
        if found.is_none() {
            let work = self.work;
            *self = Self { work, ..before };
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fga_proof::prediction::for_each_piece;
    use fga_proof::vehicle::Vehicle;
    use proptest::prelude::*;

    /// Whether the mission to 500 m ahead ends when it is flown from a state, and how near the aircraft came to its end, metres.
    fn flown(lag_s: f64, mut state: MotionState) -> (bool, f64) {
        let vehicle = Vehicle::lagged(lag_s);
        let flyer = Flyer::new(&vehicle);
        let waypoints_m = [Vec3::ZERO, Vec3::new(500.0, 0.0, 0.0)];
        let passing = [Passing::FlyBy, Passing::FlyOver];
        let mission = Mission {
            passing: &passing,
            ..Mission::new(&waypoints_m)
        };
        let climb_limits_rad = (vehicle.climb_min_rad, vehicle.climb_max_rad);
        let (mut progress, mut least_m) = (Progress::new(), f64::INFINITY);
        for step in 0..3000_u32 {
            let time_s = 0.1 * f64::from(step);
            progress.update(
                &mission,
                &state,
                &flyer,
                Vec3::ZERO,
                (time_s, climb_limits_rad),
            );
            least_m = state.position_m.distance(waypoints_m[1]).min(least_m);
            if progress.is_complete() {
                break;
            }
            let (maneuver, _) = progress.guidance(&mission, &state, &flyer, 0.2);
            state = for_each_piece(&flyer, &state, &maneuver, 0.1, |_, _, _| ());
            state.time_s = 0.0;
        }
        (progress.is_complete(), least_m)
    }

    /// Restarted within a millimetre of the leg's end, the mission once went on for ever along a leg without end.
    #[test]
    fn d1_a_leg_that_restarts_at_its_end_has_an_end() {
        for before_m in [0.0, 1e-9, 5e-4, 9e-4] {
            let state = MotionState {
                position_m: Vec3::new(500.0 - before_m, 0.0, 0.0),
                course_rad: 0.5,
                ..MotionState::ahead(0.0)
            };
            assert!(flown(0.0, state).0, "{before_m} m before its end");
        }
    }

    proptest! {
        /// From wherever it is near the end of its mission the aircraft flies over the last waypoint, and the mission ends then, not
        /// where it comes back to the line beyond.
        #[test]
        fn d10_a_mission_ends_over_its_last_waypoint(
            lag_s in prop_oneof![Just(0.0), 0.2..1.0f64],
            (x, y, z) in (300.0..560.0f64, -80.0..80.0f64, -20.0..20.0f64),
            course_rad in -3.1..3.1f64,
        ) {
            let state = MotionState { position_m: Vec3::new(x, y, z), course_rad, ..MotionState::ahead(0.0) };
            let (is_complete, least_m) = flown(lag_s, state);
            prop_assert!(is_complete && least_m < 10.0, "{least_m} m off");
        }
    }
}
