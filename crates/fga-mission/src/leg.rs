//! A leg of the mission and the aircraft's position relative to it.
//!
//! Along-track distance increases from the leg's start to its end; cross-track distance is positive to
//! the left of the leg; height counts from the leg. All over the ground.

use fga_proof::Vec3;
use fga_proof::angle::{course_of, direction, wrap_pi};
use fga_proof::limit::Limit as _;
use fga_proof::prediction::MotionState;

/// A leg shorter over the ground than this has no direction of its own, metres.
const SHORTEST_M: f64 = 1e-3;

/// Largest cross-track and height error on the leg, metres: far below the metres to which positions are known.
pub(crate) const ON_LEG_M: f64 = 0.05;

/// A join is corrected until no more than this is left, metres: well within [`ON_LEG_M`].
pub(crate) const NEAR_M: f64 = 0.2 * ON_LEG_M;

/// A straight leg between two waypoints, and its flight in a wind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Its start, metres.
    pub from_m: Vec3,
    /// East and north part of the unit vector along it over the ground.
    along: [f64; 2],
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
    airspeed_mps: f64,
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
    /// The leg between two waypoints for an aircraft of an airspeed in a wind.
    ///
    /// Waypoints above each other give a level leg without end along `fallback_course_rad`.
    pub(crate) fn new(
        [from_m, to_m]: [Vec3; 2],
        (airspeed_mps, wind_mps): (f64, Vec3),
        fallback_course_rad: f64,
    ) -> Self {
        let over = Vec3::new(to_m.x - from_m.x, to_m.y - from_m.y, 0.0);
        let length_m = over.length();
        let (along, length_m, slope) = if length_m < SHORTEST_M || !length_m.is_finite() {
            (direction(fallback_course_rad, 0.0), f64::INFINITY, 0.0)
        } else {
            (over / length_m, length_m, (to_m.z - from_m.z) / length_m)
        };
        let across_mps = along.x * wind_mps.y - along.y * wind_mps.x;
        let crab_rad = -libm::asin((across_mps / airspeed_mps).limited(-1.0, 1.0));
        let along_mps = airspeed_mps * libm::cos(crab_rad) + along.dot(wind_mps);
        let ground_speed_mps = along_mps.max(0.0);
        let climb_mps = slope * ground_speed_mps - wind_mps.z;
        let course_rad = course_of(along);
        Self {
            from_m,
            along: [along.x, along.y],
            length_m,
            slope,
            course_rad,
            air_course_rad: course_rad + crab_rad,
            climb_rad: libm::asin((climb_mps / airspeed_mps).limited(-1.0, 1.0)),
            ground_speed_mps,
            airspeed_mps,
            wind_mps,
        }
    }

    /// A level leg without end.
    pub(crate) fn endless(from_m: Vec3, course_rad: f64, air: (f64, Vec3)) -> Self {
        Self::new([from_m, from_m], air, course_rad)
    }

    /// Change of the course through the air that turns the track over the ground by an angle from the leg, radians: the
    /// aircraft nears the leg at that angle and gains along it in every wind that it can fly against.
    pub(crate) fn air_turn_rad(&self, by_rad: f64) -> f64 {
        let (course_rad, air) = (self.course_rad + by_rad, (self.airspeed_mps, self.wind_mps));
        let turned = Self::endless(self.from_m, course_rad, air);
        let crab_rad = self.air_course_rad - self.course_rad;
        by_rad + wrap_pi(turned.air_course_rad - course_rad - crab_rad)
    }

    /// Whether an aircraft can keep the leg's track and gain along it in the wind.
    pub(crate) fn can_be_flown(&self) -> bool {
        let off_mps = self.cross_speed_mps(self.air_course_rad);
        self.ground_speed_mps > 0.0 && off_mps.abs() < 1e-6 * self.airspeed_mps
    }

    /// How far a vector leads to the left of the leg.
    fn left_of(&self, vector: Vec3) -> f64 {
        self.along[0] * vector.y - self.along[1] * vector.x
    }

    /// Where an air-mass position is `at_s` seconds after the two frames coincided.
    pub fn position(&self, air_position_m: Vec3, at_s: f64) -> LegPosition {
        let offset = air_position_m + self.wind_mps * at_s - self.from_m;
        let along_m = self.along[0] * offset.x + self.along[1] * offset.y;
        LegPosition {
            along_m,
            cross_m: self.left_of(offset),
            above_m: offset.z - self.slope * along_m,
        }
    }

    /// The point of the leg at a distance along it, metres.
    pub fn point_m(&self, along_m: f64) -> Vec3 {
        self.level_point_m(along_m) + Vec3::new(0.0, 0.0, self.slope * along_m)
    }

    /// The point of the leg at a distance along it, at the height of its beginning, metres.
    pub(crate) fn level_point_m(&self, along_m: f64) -> Vec3 {
        let [x, y] = self.along;
        self.from_m + Vec3::new(x, y, 0.0) * along_m
    }

    /// Cross-track speed at a course through the air, metres per second, left positive.
    pub(crate) fn cross_speed_mps(&self, course_rad: f64) -> f64 {
        self.airspeed_mps * libm::sin(course_rad - self.course_rad) + self.left_of(self.wind_mps)
    }

    /// Change from a course through the air to the one that keeps the leg, radians, shortest way.
    pub fn turn_onto_rad(&self, state: &MotionState) -> f64 {
        wrap_pi(self.air_course_rad - state.course_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STILL: (f64, Vec3) = (10.0, Vec3::ZERO);

    #[test]
    fn a_position_counts_along_the_leg_to_its_left_and_from_its_height() {
        let leg = Leg::new([Vec3::ZERO, Vec3::new(0.0, 100.0, 10.0)], STILL, 0.0);
        let at = leg.position(Vec3::new(-7.0, 50.0, 8.0), 0.0);
        assert_eq!((at.along_m, at.cross_m, at.above_m), (50.0, 7.0, 3.0));
        assert_eq!(leg.point_m(50.0), Vec3::new(0.0, 50.0, 5.0));
        assert_eq!(leg.level_point_m(50.0), Vec3::new(0.0, 50.0, 0.0));
    }

    /// 6 m/s from the side of 10 m/s leave 8 m/s along the leg; 12 m/s leave no way to keep the track.
    #[test]
    fn an_aircraft_crabs_into_the_wind_until_the_wind_is_too_strong() {
        let leg = |wind_mps: f64| {
            let wind_mps = Vec3::new(0.0, wind_mps, 0.0);
            let ends_m = [Vec3::ZERO, Vec3::new(100.0, 0.0, 10.0)];
            Leg::new(ends_m, (10.0, wind_mps), 0.0)
        };
        let crabbed = leg(6.0);
        assert!((crabbed.air_course_rad + libm::asin(0.6)).abs() < 1e-12);
        assert!((crabbed.ground_speed_mps - 8.0).abs() < 1e-12);
        assert!((crabbed.climb_rad - libm::asin(0.08)).abs() < 1e-12);
        assert!(crabbed.cross_speed_mps(crabbed.air_course_rad).abs() < 1e-12);
        assert!(crabbed.can_be_flown() && !leg(12.0).can_be_flown());
        // After 2 s the air has carried it 12 m to the left.
        assert_eq!(crabbed.position(Vec3::ZERO, 2.0).cross_m, 12.0);
    }

    #[test]
    fn waypoints_above_each_other_give_a_level_leg_without_end() {
        let leg = Leg::new([Vec3::ZERO, Vec3::new(0.0, 0.0, 50.0)], STILL, 1.0);
        assert!(leg.length_m.is_infinite() && leg.climb_rad == 0.0);
        assert!((leg.course_rad - 1.0).abs() < 1e-15);
    }

    /// A leg whose course is near half a turn was once left by a turn of a whole circle more.
    #[test]
    fn in_still_air_the_turn_through_the_air_is_that_over_the_ground() {
        for step in -31..=31 {
            let leg = Leg::endless(Vec3::ZERO, 0.1 * f64::from(step), STILL);
            for by_rad in [-1.45, -0.785, 0.17, 0.785, 1.45] {
                let off_rad = leg.air_turn_rad(by_rad) - by_rad;
                assert!(off_rad.abs() < 1e-12, "{step} {by_rad}: {off_rad}");
            }
        }
    }
}
