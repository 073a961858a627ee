//! Joining a leg: turn to an intercept course, fly straight, turn onto the leg, at its height.
//!
//! In the plane and in still air this is the shortest Dubins path of its kind (a turn, a straight piece, a turn) onto a line.
//! It also holds in wind and for a vehicle with lag: the predicted flight corrects the moments of the second turn and of
//! levelling off.

use crate::aim::aim;
use crate::leg::{Leg, NEAR_M, ON_LEG_M};
use crate::route::Route;
use fga_proof::maneuver::{Stage, StageList};
use fga_proof::prediction::{MotionState, flown};

/// Most stages of a join: three turns, and the climb angle of the leg.
const MOST_STAGES: usize = 4;

/// Largest course error on the leg, radians.
const ON_COURSE_RAD: f64 = 1e-3;

/// A join ends at most this far beside the leg, metres: in wind, half circles ended up to 60 m beside it where the corrections failed.
const JOINED_WITHIN_M: f64 = 1.0;

/// Corrections of the two moments with the predicted flight.
const CORRECTIONS: u32 = 3;

/// A way onto a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Join {
    /// Index of the waypoint at the start of the leg.
    pub index: usize,
    /// Its commands.
    pub stages: StageList<MOST_STAGES>,
    /// Arrival on the leg, seconds from the decision.
    pub joined_s: f64,
    /// Distance along the leg at that time, metres.
    pub along_m: f64,
    /// Remaining cross-track distance at that time, metres.
    pub cross_m: f64,
}

impl Join {
    /// On a leg already, at a distance along it, metres.
    pub(crate) const fn new(index: usize, along_m: f64) -> Self {
        Self {
            index,
            stages: StageList::hold(),
            joined_s: 0.0,
            along_m,
            cross_m: 0.0,
        }
    }

    /// Its commands, first to last.
    pub fn stages(&self) -> &[Stage] {
        self.stages.stages()
    }

    /// Whether it ends on the leg: in strong wind the corrections of a turn of half a circle may fail.
    pub const fn is_on_leg(&self) -> bool {
        self.cross_m.abs() < JOINED_WITHIN_M
    }
}

/// Whether the aircraft flies along the leg, on it.
pub(crate) fn is_on_leg(leg: &Leg, state: &MotionState) -> bool {
    let position = leg.position(state.position_m, state.time_s);
    position.along_m <= leg.length_m
        && position.cross_m.abs() < ON_LEG_M
        && position.above_m.abs() < ON_LEG_M
        && leg.turn_onto_rad(state).abs() < ON_COURSE_RAD
        && (leg.climb_rad - state.climb_rad).abs() < ON_COURSE_RAD
}

/// The join of the leg that begins at waypoint `index` from a state, at an intercept angle, or at a smaller one where the leg
/// is near.
pub(crate) fn join(
    route: &Route<'_>,
    (index, leg): (usize, &Leg),
    state: &MotionState,
    intercept_rad: f64,
) -> Join {
    let speed_mps = route.flyer.airspeed_mps();
    let mut shot = aim(route, leg, state, intercept_rad);
    let mut joined = Join::new(index, 0.0);
    for correction in 0..=CORRECTIONS {
        joined.stages.set(shot.stages(state.time_s));
        let stages = joined.stages();
        let end = flown(route.flyer, state, stages, f64::INFINITY, route.meter);
        let at = leg.position(end.position_m, end.time_s);
        (joined.joined_s, joined.along_m, joined.cross_m) = (end.time_s, at.along_m, at.cross_m);
        if at.cross_m.abs().max(at.above_m.abs()) < NEAR_M || correction == CORRECTIONS {
            break;
        }
        let closing_mps = leg.cross_speed_mps(shot.intercept_course_rad);
        if closing_mps.abs() > 1e-3 * speed_mps {
            let sooner_s = at.cross_m / closing_mps;
            shot.turn_at_s = (shot.turn_at_s - sooner_s).max(state.time_s);
        }
        let climbing = libm::sin(shot.climb_rad) - libm::sin(shot.final_climb_rad);
        if climbing.abs() > 1e-3 {
            let sooner_s = at.above_m / (climbing * speed_mps);
            shot.level_at_s = (shot.level_at_s - sooner_s).max(state.time_s);
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::along;
    use fga_proof::Vec3;
    use fga_proof::situation::Mission;
    use fga_proof::vehicle::Vehicle;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        /// A join ends on the leg, where and when it says.
        #[test]
        fn a_join_ends_where_it_says(
            lag_s in prop_oneof![Just(0.0), 0.2..1.0f64],
            bank in -1.0..1.0f64,
            (cross_m, course_rad) in (-300.0..300.0f64, -2.6..2.6f64),
            intercept_rad in 0.3..1.2f64,
            wind_mps in -6.0..6.0f64,
            (above_m, climb_rad) in prop_oneof![
                Just((0.0, 0.0)),
                (-40.0..40.0f64, -0.2..0.2f64),
            ],
        ) {
            let vehicle = Vehicle::lagged(lag_s);
            let wind_mps = Vec3::new(0.0, wind_mps, 0.0);
            let mission = Mission::new(&[]);
            along(&vehicle, wind_mps, &mission, |route| {
                let state = MotionState {
                    time_s: 0.0,
                    position_m: Vec3::new(0.0, cross_m, above_m),
                    course_rad,
                    climb_rad,
                    bank_rad: bank * route.flyer.full_bank_rad(),
                };
                let leg = Leg::endless(Vec3::ZERO, 0.0, route.air());
                let joined = join(route, (3, &leg), &state, intercept_rad);
                let stages = joined.stages();
                let end = flown(route.flyer, &state, stages, f64::INFINITY, route.meter);
                let at = leg.position(end.position_m, end.time_s);
                prop_assert_eq!(joined.index, 3);
                prop_assert_eq!((joined.along_m, joined.cross_m), (at.along_m, at.cross_m));
                prop_assert_eq!(joined.joined_s, end.time_s);
                // A climb slows the aircraft over the ground, in a turn alone onto the leg too.
                let within_m = if above_m == 0.0 { ON_LEG_M } else { JOINED_WITHIN_M };
                prop_assert!(at.cross_m.abs() < within_m, "{at:?} {joined:?}");
                prop_assert!(at.above_m.abs() < ON_LEG_M, "{at:?} {joined:?}");
                prop_assert!(leg.turn_onto_rad(&end).abs() < ON_COURSE_RAD);
                Ok(())
            })?;
        }
    }

    #[test]
    fn on_a_leg_is_within_centimetres_on_its_course_and_before_its_end() {
        let ends_m = [Vec3::ZERO, Vec3::new(100.0, 0.0, 0.0)];
        let leg = Leg::new(ends_m, (15.0, Vec3::ZERO), 0.0);
        let at = |x_m: f64, y_m: f64, course_rad: f64| MotionState {
            position_m: Vec3::new(x_m, y_m, 0.0),
            course_rad,
            ..MotionState::ahead(0.0)
        };
        assert!(is_on_leg(&leg, &at(50.0, 0.04, 0.0)));
        assert!(!is_on_leg(&leg, &at(50.0, 0.06, 0.0)));
        assert!(!is_on_leg(&leg, &at(50.0, 0.0, 0.01)));
        assert!(!is_on_leg(&leg, &at(101.0, 0.0, 0.0)));
    }
}
