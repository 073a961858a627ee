//! Whether no flight at all keeps clear of an obstacle: at some moment all that the aircraft can reach lies in its
//! volume.
//!
//! In a direction the aircraft gets farthest if it turns there as fast as it can and then flies straight on. That it
//! also has to roll out only brings it less far. Half-planes in several directions, between the least and the largest
//! height, enclose all that it can reach; the volume is convex, so it holds all of that if it holds their corners.

use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_8, PI, TAU};

use fga_proof::Vec3;
use fga_proof::certificate::Hazard;
use fga_proof::prediction::{MotionState, Target};

use super::{Scene, Search};

/// Directions to a side, an eighth of π apart.
const TO_A_SIDE: usize = 5;

/// Their sines and cosines.
const SIN_COS: [(f64, f64); TO_A_SIDE] = [
    (0.382_683_432_365_089_8, 0.923_879_532_511_286_7),
    (FRAC_1_SQRT_2, FRAC_1_SQRT_2),
    (0.923_879_532_511_286_7, 0.382_683_432_365_089_8),
    (1.0, 0.0),
    (0.923_879_532_511_286_7, -0.382_683_432_365_089_8),
];

/// Directions to both sides, ahead and back.
const DIRECTIONS: usize = 2 * TO_A_SIDE + 2;

/// The largest turn by the moment, to either side: beyond it the way round the other side may lead as far, radians.
const MOST_TURN_RAD: f64 = TAU - 2.0 * TO_A_SIDE as f64 * FRAC_PI_8;

/// Longest step of a turn, radians.
const STEP_RAD: f64 = 0.15;

/// Most steps of a turn.
const MOST_STEPS: usize = 96;

/// Moments around the closest approach of straight flight, as shares of half the time in the volume.
const MOMENTS: [f64; 6] = [-0.15, 0.1, -0.4, 0.35, -0.65, 0.6];

/// A smaller change of the climb angle is none, radians.
const LEVEL_RAD: f64 = 1e-9;

/// The corners lie this far inside, metres: more than a flight differs from its prediction.
const INSIDE_M: f64 = 0.05;

impl Search<'_> {
    /// Whether some obstacle cannot be avoided by any flight from now.
    pub(super) fn is_enclosed(&self) -> bool {
        let hazards = self.scene.hazards.rows();
        hazards.iter().any(|hazard| self.is_within(hazard))
    }

    /// Whether all that the aircraft can reach by some moment lies in a hazard's volume.
    fn is_within(&self, hazard: &Hazard) -> bool {
        let Some((closest_s, half_s)) = self.inside_s(hazard) else {
            return false;
        };
        let (from_s, until_s) = hazard.window_s;
        MOMENTS.iter().any(|share| {
            let at_s = closest_s + share * half_s;
            let is_ahead = at_s > 0.0 && at_s <= self.scene.horizon_s;
            let is_valid = is_ahead && at_s >= from_s && at_s <= until_s;
            is_valid && !self.limit_met() && self.is_within_at(hazard, at_s)
        })
    }

    /// When straight flight is closest to the middle of a hazard, and for how long it is inside before or after that,
    /// seconds.
    fn inside_s(&self, hazard: &Hazard) -> Option<(f64, f64)> {
        if !self.meter.take(1) {
            return None;
        }
        let start = &self.scene.start;
        let relative_mps = self.scene.flyer.velocity_mps(start) - hazard.velocity_mps;
        let offset_m = start.position_m - hazard.position_m;
        let square = relative_mps.length_squared().max(f64::MIN_POSITIVE);
        let closest_s = -offset_m.dot(relative_mps) / square;
        let closest_m = (offset_m + relative_mps * closest_s).length();
        let radius_m = hazard.volume.bounding_radius_m();
        let half_m = radius_m * radius_m - closest_m * closest_m;
        (half_m > 0.0).then(|| (closest_s, libm::sqrt(half_m / square)))
    }

    fn is_within_at(&self, hazard: &Hazard, at_s: f64) -> bool {
        let start = &self.scene.start;
        let heights_m = self.heights_m(at_s);
        let (sin, cos) = libm::sincos(start.course_rad);
        let is_inside = |ahead_m: f64, left_m: f64| {
            heights_m.iter().all(|up_m| {
                let point_m = Vec3::new(
                    ahead_m * cos - left_m * sin,
                    ahead_m * sin + left_m * cos,
                    *up_m,
                );
                hazard.margin_m(start.position_m + point_m, at_s) < -INSIDE_M
            })
        };
        // Most fail where straight flight leads, which is within the corners unless the aircraft first has to roll out.
        let flown_m = self.scene.flyer.airspeed_mps() * at_s;
        if start.bank_rad == 0.0 && !is_inside(flown_m, 0.0) {
            return false;
        }
        let Some(farthest) = self.farthest(at_s) else {
            return false;
        };
        let next = farthest.iter().cycle().skip(1);
        farthest.iter().zip(next).all(|(one, other)| {
            let ((sin_one, cos_one), (sin_other, cos_other)) = (one.0, other.0);
            let between = cos_one * sin_other - sin_one * cos_other;
            let ahead_m = (one.1 * sin_other - other.1 * sin_one) / between;
            let left_m = (other.1 * cos_one - one.1 * cos_other) / between;
            is_inside(ahead_m, left_m)
        })
    }

    /// Sines and cosines of directions from the course, counterclockwise, and how far the aircraft gets in each, metres.
    fn farthest(&self, at_s: f64) -> Option<[((f64, f64), f64); DIRECTIONS]> {
        let Scene {
            flyer,
            start,
            climb_limits_rad: (low, high),
            ..
        } = self.scene;
        let steepest_rad = start.climb_rad.abs().max(low.abs()).max(high.abs());
        let flown_m = flyer.airspeed_mps() * at_s;
        // A bank to the other side first turns the aircraft that way.
        let other_rad = flyer.rollout_rad(start.bank_rad).abs();
        let less = |direction_rad: f64| {
            let behind = -libm::cos((direction_rad + other_rad).min(PI));
            flown_m * (1.0 - libm::cos(steepest_rad)) * behind.max(0.0)
        };
        let mut farthest = [((0.0, 1.0), flown_m); DIRECTIONS];
        let mut ahead_m = f64::INFINITY;
        let left = self.turning(start.bank_rad, at_s)?;
        let mirrored = (start.bank_rad == 0.0).then_some(left);
        let right = mirrored.or_else(|| self.turning(-start.bank_rad, at_s))?;
        for (side, (to_side, end)) in [(1.0, left), (-1.0, right)] {
            if end.course_rad + other_rad > MOST_TURN_RAD {
                return None;
            }
            if side * start.bank_rad >= 0.0 {
                ahead_m = ahead_m.min(end.position_m.x);
            }
            for (place, (most_m, (sin, cos))) in to_side.into_iter().zip(SIN_COS).enumerate() {
                let direction_rad = (place + 1) as f64 * FRAC_PI_8;
                let slot = if side > 0.0 {
                    TO_A_SIDE + 1 + place
                } else {
                    TO_A_SIDE - 1 - place
                };
                if let Some(slot) = farthest.get_mut(slot) {
                    *slot = ((side * sin, cos), most_m + less(direction_rad));
                }
            }
        }
        if let Some(back) = farthest.last_mut() {
            *back = ((0.0, -1.0), less(PI) - ahead_m);
        }
        Some(farthest)
    }

    /// How far the aircraft gets in each direction to a side by turning there from a bank that is positive towards it,
    /// and where it is if it turns on, in a frame of its course.
    fn turning(&self, bank_rad: f64, until_s: f64) -> Option<([f64; TO_A_SIDE], MotionState)> {
        let flyer = self.scene.flyer;
        let mut state = MotionState::ahead(bank_rad);
        let mut farthest_m = [flyer.airspeed_mps() * until_s; TO_A_SIDE];
        let longest_s = STEP_RAD / flyer.course_rate_radps();
        for _ in 0..MOST_STEPS {
            // Leaving the turn before its direction only leads farther: the last moment before it is the nearest bound.
            for (place, (most_m, (sin, cos))) in farthest_m.iter_mut().zip(SIN_COS).enumerate() {
                let direction_rad = (place + 1) as f64 * FRAC_PI_8;
                if state.course_rad <= direction_rad {
                    let straight_m = flyer.airspeed_mps() * (until_s - state.time_s);
                    *most_m = state.position_m.x * cos + state.position_m.y * sin + straight_m;
                }
            }
            let left_s = until_s - state.time_s;
            if left_s <= 0.0 {
                return Some((farthest_m, state));
            }
            if !self.meter.take(flyer.piece_work()) {
                return None;
            }
            let piece = flyer.next_piece_within(&state, &Target::TURNING_LEFT, left_s);
            let for_s = piece.duration_s.min(longest_s).min(left_s);
            state = flyer.advance(&state, &piece, for_s);
            if for_s == left_s {
                state.time_s = until_s;
            }
        }
        None
    }

    /// The least and the largest height above the present one that the aircraft can have at a moment, metres.
    fn heights_m(&self, at_s: f64) -> [f64; 2] {
        let Scene {
            flyer,
            start,
            climb_limits_rad: (low, high),
            ..
        } = self.scene;
        let rate_radps = flyer.climb_rate_radps();
        let held_m = flyer.airspeed_mps() * at_s * libm::sin(start.climb_rad);
        let height_m = |limit_rad: f64| {
            let change_rad = limit_rad - start.climb_rad;
            if rate_radps <= 0.0 || change_rad.abs() < LEVEL_RAD {
                return held_m;
            }
            let changes_s = (change_rad.abs() / rate_radps).min(at_s);
            let end_rad = start.climb_rad + libm::copysign(rate_radps * changes_s, change_rad);
            let mean =
                (libm::cos(start.climb_rad) - libm::cos(end_rad)) / (end_rad - start.climb_rad);
            flyer.airspeed_mps() * (mean * changes_s + libm::sin(end_rad) * (at_s - changes_s))
        };
        [height_m(low).min(held_m), height_m(high).max(held_m)]
    }
}

#[cfg(test)]
mod tests {
    use core::cell::Cell;

    use super::*;
    use crate::tests::scene;
    use fga_proof::certificate::Hazards;
    use fga_proof::maneuver::{Maneuver, Stage};
    use fga_proof::prediction::{FlightPath, Flyer};
    use fga_proof::situation::ProtectedVolume;
    use fga_proof::vehicle::Vehicle;
    use proptest::prelude::*;
    use proptest::test_runner::{Config, TestRunner};

    /// Whether the claim is made for a hazard that arrives from ahead, and the least margin of a flight.
    fn claimed(
        (lag_s, bank): (f64, f64),
        (meets_s, aside_m, above_m): (f64, f64, f64),
        (course_rad, speed_mps): (f64, f64),
        stages: &[(f64, f64, f64)],
    ) -> (bool, f64) {
        let vehicle = Vehicle::lagged(lag_s);
        let mut flyer = Flyer::new(&vehicle);
        let full_rad = flyer.bank_rad(flyer.course_rate_radps());
        let bank_rad = if lag_s > 0.0 { bank * full_rad } else { 0.0 };
        flyer.keep_rolls_from(bank_rad);
        let (sin, cos) = course_rad.sin_cos();
        let velocity_mps = Vec3::new(cos, sin, 0.0) * speed_mps;
        let meets_m = Vec3::new(vehicle.airspeed_mps * meets_s, aside_m, above_m);
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        let hazard = Hazard::exact(0, meets_m - velocity_mps * meets_s, velocity_mps, volume);
        let mut hazards = Hazards::new();
        hazards.put(0, hazard);
        let start = MotionState::ahead(bank_rad);
        let nominal = Maneuver::hold();
        let scene = scene(&flyer, &vehicle, (start, &nominal), &hazards);
        let mut path = FlightPath::new();
        let search = Search::new(scene, &mut path, u32::MAX);
        let is_enclosed = search.is_enclosed();
        let mut maneuver = Maneuver::hold();
        for (start_s, course_rad, climb_rad) in stages {
            maneuver.push(Stage {
                start_s: *start_s,
                course_rad: *course_rad,
                climb_rad: *climb_rad,
                rate_share: 1.0,
            });
        }
        let mut path = FlightPath::new();
        path.predict(&flyer, &start, &maneuver, 60.0);
        let least_m = (0..1200)
            .filter_map(|k| {
                let at_s = 0.01 * f64::from(k);
                let state = path.state_at(&flyer, at_s)?;
                Some(hazard.margin_m(state.position_m, at_s))
            })
            .fold(f64::INFINITY, f64::min);
        (is_enclosed, least_m)
    }

    #[test]
    fn no_flight_keeps_clear_of_what_encloses_all_that_can_be_reached() {
        let claims = Cell::new(0);
        let flights = (
            (prop_oneof![Just(0.0), 0.2..1.2f64], -1.0..1.0f64),
            (0.3..3.5f64, -25.0..25.0f64, -15.0..15.0f64),
            (-3.1..3.1f64, 0.0..60.0f64),
            proptest::collection::vec((0.0..1.5f64, -4.0..4.0f64, -0.26..0.26f64), 1..4),
        );
        let mut runner = TestRunner::new(Config::with_cases(3000));
        let result = runner.run(&flights, |(lag, meets, motion, mut stages)| {
            stages.sort_by(|a, b| a.0.total_cmp(&b.0));
            if let Some(first) = stages.first_mut() {
                first.0 = 0.0;
            }
            let (is_enclosed, least_m) = claimed(lag, meets, motion, &stages);
            if is_enclosed {
                claims.set(claims.get() + 1);
                prop_assert!(least_m < 0.0, "a flight keeps {least_m} m");
            }
            Ok(())
        });
        result.unwrap();
        assert!(claims.get() > 300, "{} claims", claims.get());
    }

    #[test]
    fn directions_are_an_eighth_of_a_half_turn_apart() {
        for (place, (sin, cos)) in SIN_COS.into_iter().enumerate() {
            let (true_sin, true_cos) = ((place + 1) as f64 * FRAC_PI_8).sin_cos();
            assert!((sin - true_sin).abs().max((cos - true_cos).abs()) < 1e-15);
        }
    }

    #[test]
    fn what_a_turn_clears_is_not_claimed() {
        // Ahead in 3.2 s, at rest: a turn passes it.
        let turn = [(0.0, 1.6, 0.0)];
        let (is_enclosed, least_m) = claimed((0.3, 0.0), (4.6, 0.0, 0.0), (0.0, 0.0), &turn);
        assert!(least_m > 0.0, "{least_m}");
        assert!(!is_enclosed);
    }
}
