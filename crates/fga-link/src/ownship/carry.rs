//! The state at a later moment than the measurement: extrapolated along the arc that the aircraft flies.

use fga::Vec3;
use fga::angle::{course_of, wrap_pi};
use fga::situation::Ownship;
use fga::vehicle::{Response, STANDARD_GRAVITY_MPS2};

use super::{FLYING_SPEED_MPS, LONGEST_CARRY_S, OwnState, OwnshipEstimate, WIND_LIFETIME_S};
use crate::commanded::Commanded;

/// The measured rate of turn beyond the bank's holds for this long, then it fades, seconds.
const RATE_HOLDS_S: f64 = 0.5;
const RATE_FADES_S: f64 = 1.0;
/// Most of the measured rate of turn beyond the bank's that counts, radians per second: in a steep turn that settles the two differ by
/// 0.5 for half a second.
const MOST_OFF_RADPS: f64 = 0.3;
/// Most pieces of the extrapolation's arc, and the longest one, seconds.
const STEPS: u32 = 8;
const LONGEST_STEP_S: f64 = 0.2;

impl OwnshipEstimate {
    /// The state at `at_s` on the local clock, somewhat later than the last measurement.
    ///
    /// The recent bank commands bend the path between the measurement and `at_s`.
    /// `None` before the first position and attitude, or when the aircraft does not fly.
    pub fn state_at(
        &mut self,
        at_s: f64,
        commanded: &Commanded,
        response: &Response,
    ) -> Option<OwnState> {
        let (position, attitude) = (self.position?, self.attitude?);
        let wind_mps = self
            .wind
            .filter(|(heard_s, _)| at_s - heard_s < WIND_LIFETIME_S)
            .map_or(Vec3::ZERO, |(_, wind)| wind);
        let air_mps = position.velocity_mps - wind_mps;
        let speed = air_mps.length();
        if speed < FLYING_SPEED_MPS {
            return None;
        }
        let bank_at = |at_s: f64| {
            let latest_s = attitude.measured_s + LONGEST_CARRY_S;
            let at_s = at_s.min(latest_s);
            commanded.bank_at(attitude.bank_rad, attitude.measured_s, at_s, response)
        };
        let rate_of = |bank_rad: f64| {
            response.turn_rate_factor * STANDARD_GRAVITY_MPS2 * libm::tan(bank_rad.clamp(-1.3, 1.3))
                / speed
        };
        // In a steady turn the measured rate is more accurate than the bank. While it rolls, the nose swings
        // later than the course, and may even swing to the other side.
        let offset_radps = if attitude.rolls {
            0.0
        } else {
            (attitude.yaw_rate_radps - rate_of(attitude.bank_rad))
                .clamp(-MOST_OFF_RADPS, MOST_OFF_RADPS)
        };
        let carry_s = (at_s - position.measured_s).clamp(0.0, LONGEST_CARRY_S);
        let (mut place_m, mut course_rad) = (position.place_m, course_of(air_mps));
        let climb_rad = libm::asin((air_mps.z / speed).clamp(-1.0, 1.0));
        let level = speed * libm::cos(climb_rad);
        let steps = (carry_s / LONGEST_STEP_S).ceil().max(f64::from(STEPS));
        let step_s = carry_s / steps;
        for n in 0..crate::number::to_u16(steps) {
            let step_at_s = at_s - carry_s + (f64::from(n) + 0.5) * step_s;
            let beyond_s = (step_at_s - attitude.measured_s - RATE_HOLDS_S).max(0.0);
            let offset_radps = offset_radps * libm::exp(-beyond_s / RATE_FADES_S);
            let rate = rate_of(bank_at(step_at_s)) + offset_radps;
            let middle_rad = course_rad + 0.5 * rate * step_s;
            place_m += Vec3::new(
                (level * libm::cos(middle_rad) + wind_mps.x) * step_s,
                (level * libm::sin(middle_rad) + wind_mps.y) * step_s,
                air_mps.z * step_s,
            );
            course_rad += rate * step_s;
        }
        // Unwrapped along the flight, so that stages can express turns beyond 180°.
        let reference = self.last_course_rad.unwrap_or(course_rad);
        let course_rad = reference + wrap_pi(course_rad - reference);
        self.last_course_rad = Some(course_rad);
        let ownship = Ownship {
            position_m: place_m,
            course_rad,
            climb_rad,
            bank_rad: bank_at(at_s),
            airspeed_mps: speed,
        };
        Some(OwnState {
            ownship,
            ground_velocity_mps: ownship.velocity_mps() + wind_mps,
            wind_mps,
            above_home_m: position.above_home_m + place_m.z - position.place_m.z,
            pitch_rad: attitude.pitch_rad,
            course_rate_radps: attitude.yaw_rate_radps,
        })
    }
}
