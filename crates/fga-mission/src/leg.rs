//! A leg of the mission and the aircraft's position relative to it.
//!
//! Along-track distance increases from the leg's start to its end; cross-track distance is positive to
//! the left of the leg; height counts from the leg. All over the ground.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use fga_proof::Vec3;
use fga_proof::angle::wrap_pi;
use fga_proof::limit::Limit as _;
use fga_proof::prediction::MotionState;

/// A leg shorter over the ground than this has no direction of its own, metres.
const SHORTEST_M: f64 = 1e-3;

/// A straight leg between two waypoints, and its flight in a wind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Its start, metres.
    pub from_m: Vec3,
    /// Unit vector along it over the ground (horizontal).
    along: Vec3,
    /// Horizontal length, metres; infinite for a leg without end.
    pub length_m: f64,
    /// Height gained per metre over the ground.
    slope: f64,
    /// Course over the ground, radians.
    pub course_rad: f64,
    /// Course through the air that keeps the track, radians: course plus crab angle.
    pub air_course_rad: f64,
    /// Climb angle through the air that keeps the slope, radians, not limited.
    pub climb_rad: f64,
    /// Speed over the ground along the leg, metres per second.
    pub ground_speed_mps: f64,
    wind_mps: Vec3,
}

/// The aircraft's position relative to a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LegPosition {
    /// Distance along the leg from its start, metres.
    pub along_m: f64,
    /// Distance to the left of the leg, metres.
    pub cross_m: f64,
    /// Height above the leg, metres.
    pub above_m: f64,
}

impl Leg {
    /// The leg between two waypoints for an aircraft of `airspeed_mps` in a wind.
    ///
    /// Waypoints that lie above each other give a leg along `fallback_course_rad`.
    pub(crate) fn new(
        from_m: Vec3,
        to_m: Vec3,
        airspeed_mps: f64,
        wind_mps: Vec3,
        fallback_course_rad: f64,
    ) -> Self {
        let over = Vec3::new(to_m.x - from_m.x, to_m.y - from_m.y, 0.0);
        let length_m = over.length();
        if length_m < SHORTEST_M || !length_m.is_finite() {
            return Self::endless(from_m, fallback_course_rad, airspeed_mps, wind_mps);
        }
        let slope = (to_m.z - from_m.z) / length_m;
        Self::along(
            from_m,
            over / length_m,
            length_m,
            slope,
            airspeed_mps,
            wind_mps,
        )
    }

    /// A level leg without end.
    pub(crate) fn endless(
        from_m: Vec3,
        course_rad: f64,
        airspeed_mps: f64,
        wind_mps: Vec3,
    ) -> Self {
        let (sin, cos) = libm::sincos(course_rad);
        let along = Vec3::new(cos, sin, 0.0);
        Self::along(from_m, along, f64::INFINITY, 0.0, airspeed_mps, wind_mps)
    }

    /// Change of course through the air that turns the track over the ground by an angle from the leg, radians: at that angle
    /// the aircraft nears the leg and gains along it in every wind that it can fly against.
    pub(crate) fn air_turn_rad(&self, airspeed_mps: f64, by_rad: f64) -> f64 {
        let crab_rad = self.air_course_rad - self.course_rad;
        let (course_rad, wind_mps) = (self.course_rad + by_rad, self.wind_mps);
        let turned = Self::endless(self.from_m, course_rad, airspeed_mps, wind_mps);
        by_rad + wrap_pi(turned.air_course_rad - course_rad - crab_rad)
    }

    /// Whether an aircraft can keep the leg's track and gain along it in the wind.
    pub(crate) fn can_be_flown(&self, airspeed_mps: f64) -> bool {
        let off_mps = self.cross_speed_mps(airspeed_mps, self.air_course_rad);
        self.ground_speed_mps > 0.0 && off_mps.abs() < 1e-6 * airspeed_mps
    }

    fn along(
        from_m: Vec3,
        along: Vec3,
        length_m: f64,
        slope: f64,
        airspeed_mps: f64,
        wind_mps: Vec3,
    ) -> Self {
        let course_rad = libm::atan2(along.y, along.x);
        let across_wind = along.x * wind_mps.y - along.y * wind_mps.x;
        let crab = -libm::asin((across_wind / airspeed_mps).limited(-1.0, 1.0));
        let along_air = airspeed_mps * libm::cos(crab);
        let ground_speed_mps = (along_air + along.dot(wind_mps)).max(0.0);
        let climb_speed = slope * ground_speed_mps - wind_mps.z;
        let climb_rad = libm::asin((climb_speed / airspeed_mps).limited(-1.0, 1.0));
        let air_course_rad = course_rad + crab;
        Self {
            from_m,
            along,
            length_m,
            slope,
            course_rad,
            air_course_rad,
            climb_rad,
            ground_speed_mps,
            wind_mps,
        }
    }

    /// Where an air-mass position is `at_s` seconds after the two frames coincided.
    pub fn position(&self, air_position_m: Vec3, at_s: f64) -> LegPosition {
        let offset = air_position_m + self.wind_mps * at_s - self.from_m;
        let along_m = offset.dot(self.along);
        LegPosition {
            along_m,
            cross_m: self.left_of(offset),
            above_m: offset.z - self.slope * along_m,
        }
    }

    /// The point of the leg at a distance along it, metres.
    pub fn point_m(&self, along_m: f64) -> Vec3 {
        self.from_m + self.along * along_m + Vec3::new(0.0, 0.0, self.slope * along_m)
    }

    /// The point of the leg at a distance along it, at the height of its beginning, metres.
    pub(crate) fn level_point_m(&self, along_m: f64) -> Vec3 {
        self.from_m + self.along * along_m
    }

    /// How far a vector leads to the left of the leg.
    pub(crate) fn left_of(&self, vector: Vec3) -> f64 {
        self.along.x * vector.y - self.along.y * vector.x
    }

    /// Cross-track speed at a course through the air, metres per second, left positive.
    pub(crate) fn cross_speed_mps(&self, airspeed_mps: f64, course_rad: f64) -> f64 {
        airspeed_mps * libm::sin(course_rad - self.course_rad) + self.along.x * self.wind_mps.y
            - self.along.y * self.wind_mps.x
    }

    /// The least time in which an aircraft of some airspeed, metres per second, that turns at once at a rate, radians per
    /// second, can be on the line of the leg, on its course, seconds: it turns to either side until it flies straight at the leg,
    /// and from there onto it.
    pub(crate) fn least_s_onto(
        &self,
        state: &MotionState,
        (airspeed_mps, rate_radps): (f64, f64),
    ) -> f64 {
        let cross_m = self.position(state.position_m, state.time_s).cross_m;
        let radii = cross_m.abs() * rate_radps / airspeed_mps;
        // How far the course is turned towards the leg.
        let towards_rad = libm::copysign(1.0, cross_m) * self.turn_onto_rad(state);
        let cos = libm::cos(state.course_rad - self.course_rad);
        // Turns up to straight at the leg, and down to it from beyond.
        let (up_rad, down_rad) = if towards_rad > FRAC_PI_2 {
            (towards_rad - TAU, towards_rad)
        } else {
            (towards_rad, towards_rad + TAU)
        };
        let wind_share = self.wind_mps.length() / airspeed_mps;
        let is_windy = wind_share > 0.0;
        let turns_rad = |radii: f64| {
            let straight = radii - 1.0 - cos;
            let up = if straight >= 0.0 {
                PI - up_rad + straight
            } else if is_windy {
                towards_rad.abs()
            } else {
                // So near that the second turn follows the first.
                let steepest_rad = libm::acos((-0.5 * straight).min(1.0)).max(up_rad);
                2.0 * steepest_rad - up_rad
            };
            up.min(down_rad + (radii - 1.0 + cos).max(0.0))
        };
        // Before it would be there in still air, wind brings the leg at most so much nearer.
        let nearer = radii - wind_share * turns_rad(radii);
        turns_rad(nearer.max(0.0)) / rate_radps
    }

    /// Change from a course through the air to the one that keeps the leg, radians, shortest way.
    pub fn turn_onto_rad(&self, state: &MotionState) -> f64 {
        wrap_pi(self.air_course_rad - state.course_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::join::{JoinLimits, ON_LEG_M, join};
    use fga_proof::meter::Meter;
    use fga_proof::prediction::Flyer;
    use fga_proof::vehicle::Vehicle;
    use proptest::prelude::*;

    /// A leg whose course is near half a turn was once left by a turn of a whole circle more.
    #[test]
    fn in_still_air_the_turn_through_the_air_is_that_over_the_ground() {
        for step in -31..=31 {
            let leg = Leg::endless(Vec3::ZERO, 0.1 * f64::from(step), 26.2, Vec3::ZERO);
            for by_rad in [-1.45, -0.785, 0.17, 0.785, 1.45] {
                let turn_rad = leg.air_turn_rad(26.2, by_rad);
                assert!(
                    (turn_rad - by_rad).abs() < 1e-12,
                    "{step} {by_rad}: {turn_rad}"
                );
            }
        }
    }

    proptest! {
        /// No join, at whatever angle, is over sooner than the least time, and one without lag and wind is hardly later.
        #[test]
        fn no_join_is_sooner_than_the_least_time(
            lag_s in prop_oneof![Just(0.0), 0.2..1.0f64],
            (cross_m, course_rad) in (-600.0..600.0f64, -3.1..3.1f64),
            wind_mps in prop_oneof![Just(0.0), -6.0..6.0f64],
        ) {
            let vehicle = Vehicle::lagged(lag_s);
            let flyer = Flyer::new(&vehicle);
            let speed_mps = vehicle.airspeed_mps;
            let wind_mps = Vec3::new(0.0, wind_mps, 0.0);
            let leg = Leg::endless(Vec3::ZERO, 0.0, speed_mps, wind_mps);
            let state = MotionState {
                position_m: Vec3::new(0.0, cross_m, 0.0),
                course_rad,
                ..MotionState::ahead(0.0)
            };
            // A join may end a little aside.
            let nearer_m = libm::copysign((cross_m.abs() - ON_LEG_M).max(0.0), cross_m);
            let nearer = MotionState { position_m: Vec3::new(0.0, nearer_m, 0.0), ..state };
            let least_s = leg.least_s_onto(&nearer, (speed_mps, flyer.course_rate_radps()))
                + flyer.settles_late_s();
            let meter = Meter::unlimited();
            let joined_s = |intercept_rad: f64| {
                let limits = JoinLimits { intercept_rad, climb_limits_rad: (0.0, 0.0) };
                let joined = join(&flyer, &leg, &state, &limits, &meter);
                (joined.cross_m.abs() < ON_LEG_M).then_some(joined.joined_s)
            };
            let all = (1..=78).filter_map(|step| joined_s(0.02 * f64::from(step)));
            let soonest_s = all.fold(f64::INFINITY, f64::min);
            prop_assert!(soonest_s > least_s - 1e-6, "{soonest_s} s, not {least_s} s");
            let is_plain = lag_s == 0.0 && wind_mps == Vec3::ZERO;
            let is_towards = course_rad * cross_m < 0.0;
            if is_plain && is_towards && course_rad.abs() < 1.0 && cross_m.abs() > 100.0 {
                prop_assert!(soonest_s < 1.02 * least_s + 0.05, "{soonest_s} s, not {least_s} s");
            }
        }
    }
}
