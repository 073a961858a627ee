//! Flight with a first-order bank response, or under the PI autopilot by Runge–Kutta steps.
//!
//! A roll to a commanded bank is exact in bank; course and place are integrated by Simpson's rule, whose error is
//! below 10⁻⁶ m a step. What is shown of a step is the arc of its mean rate: less than a millimetre off in between.
//!
//! The direct autopilot commands the bank of the full turn until the remaining turn equals the turn made
//! while rolling out to level, then level. The moment is exact to rounding, so a turn ends on its course.

use core::f64::consts::PI;

use fga::Vec3;
use fga::vehicle::STANDARD_GRAVITY_MPS2;

use super::{Arc, Plant, rate_to};
use crate::whole::whole;

/// Longest integration step under the PI autopilot, seconds (50 Hz).
const LONGEST_STEP_S: f64 = 0.02;

/// Longest step of a roll, seconds.
const LONGEST_ROLL_S: f64 = 0.05;

/// Longest step of the end of a roll, seconds.
const LONGEST_END_S: f64 = 0.1;

/// A bank this close to its command is at the end of its roll, radians: the course rate hardly changes any more.
const NEARLY_THERE_RAD: f64 = 0.1;

/// The integrated state under the PI autopilot: position, course and bank.
#[derive(Clone, Copy)]
struct PiState {
    position_m: Vec3,
    course_rad: f64,
    bank_rad: f64,
}

impl PiState {
    fn plus(self, rate: Self, by_s: f64) -> Self {
        Self {
            position_m: self.position_m + rate.position_m * by_s,
            course_rad: self.course_rad + rate.course_rad * by_s,
            bank_rad: self.bank_rad + rate.bank_rad * by_s,
        }
    }
}

/// A moment of a roll.
#[derive(Debug, Clone, Copy)]
struct RollMoment {
    position_m: Vec3,
    course_rad: f64,
    climb_rad: f64,
    bank_rad: f64,
    /// Tangent of the bank angle.
    bank_tan: f64,
    /// Sine and cosine of the course and of the climb angle.
    course: (f64, f64),
    climb: (f64, f64),
}

impl RollMoment {
    /// This moment of an aircraft.
    fn of(plant: &Plant) -> Self {
        Self {
            position_m: plant.position_m,
            course_rad: plant.course_rad,
            climb_rad: plant.climb_rad,
            bank_rad: plant.bank_rad,
            bank_tan: libm::tan(plant.bank_rad),
            course: libm::sincos(plant.course_rad),
            climb: libm::sincos(plant.climb_rad),
        }
    }

    fn direction(&self) -> Vec3 {
        let ((sin_course, cos_course), (sin_climb, cos_climb)) = (self.course, self.climb);
        Vec3::new(cos_climb * cos_course, cos_climb * sin_course, sin_climb)
    }
}

/// Steps of the bank's time constant, at least.
const STEPS_OF_LAG: f64 = 10.0;

/// A bank this close to its command has reached it, radians: what is left of a roll-out turns by some 0.00003 rad, which is
/// then flown at the largest rate.
const THERE_RAD: f64 = 1e-4;

/// A smaller turn does not roll in, radians.
const LITTLE_RAD: f64 = 1e-7;

/// Most iterations for the start of a roll-out.
const STEPS_TO_ROLL_OUT: u32 = 44;

/// Remaining turn beyond the roll-out at its start, radians.
const ROLL_OUT_BEGINS_RAD: f64 = 1e-14;

/// The terms of [`roll_out_integral`] beyond the nearest pole of the tangent, as a series in the square of the bank:
/// 8 · 4ⁿ / ((2n + 1) π²ⁿ⁺²) · Σ (2k − 1)⁻²ⁿ⁻² over k ≥ 2. What follows is below 10⁻¹² at a bank of 80°.
const FARTHER_POLES: [f64; 10] = [
    0.189_430_530_861_297_82,
    0.001_607_300_394_478_202_4,
    3.853_295_029_284_789e-5,
    1.196_205_952_173_013_1e-6,
    4.140_883_808_687_578e-8,
    1.519_517_149_504_476_7e-9,
    5.781_681_370_596_544_5e-11,
    2.255_296_798_919_955e-12,
    8.959_523_479_911_502e-14,
    3.609_687_927_953_456e-15,
];

/// Course change while the bank decays from `bank_rad` to level, per second of time constant and per g/V: ∫₀^φ tan(u)/u du.
///
/// tan(u)/u is the sum of 8 / (a² − 4u²) over its poles a = π, 3π, 5π, …; the first of these is integrated in closed form.
fn roll_out_integral(bank_rad: f64) -> f64 {
    let square = bank_rad * bank_rad;
    let farther = (FARTHER_POLES.iter().rev()).fold(0.0, |sum, term| sum * square + term);
    let nearest = libm::log((PI + 2.0 * bank_rad) / (PI - 2.0 * bank_rad)) * (2.0 / PI);
    nearest + bank_rad * farther
}

impl Plant {
    /// Flies until `until_s` under the direct autopilot: rolls in steps, the rest in exact arcs.
    pub(super) fn fly_rolling(&mut self, until_s: f64, flown: &mut impl FnMut(&Arc, Vec3)) {
        let lag_s = self.vehicle.response.bank_time_constant_s;
        let limit = self.active.map_or(0.0, |stage| {
            self.course_rate_limit_radps() * stage.rate_share
        });
        let course_target = self.active.map_or(self.course_rad, |s| s.course_rad);
        let full_rad = self.bank_of(limit);
        // A roll-out turns by what it was begun for.
        let mut begun_for = None;
        while self.time_s < until_s {
            let (from_s, left_s) = (self.time_s, until_s - self.time_s);
            let end_s = |step_s: f64| {
                if step_s == left_s {
                    until_s
                } else {
                    from_s + step_s
                }
            };
            let climb_target = self.climb_target_rad();
            let climb_limit = self.vehicle.climb_rate_radps;
            let (climb_rate, climb_s) = rate_to(climb_target, &mut self.climb_rad, climb_limit);
            let beyond = begun_for
                .take()
                .unwrap_or_else(|| self.beyond_at(self.course_rad, self.bank_rad));
            let turns = limit > 0.0 && beyond.abs() > LITTLE_RAD;
            let command = if turns {
                libm::copysign(full_rad, beyond)
            } else {
                0.0
            };
            if (self.bank_rad - command).abs() <= THERE_RAD {
                self.bank_rad = command;
                let (course_rate, turn_s) = if turns {
                    (libm::copysign(limit, beyond), beyond.abs() / limit)
                } else {
                    rate_to(course_target, &mut self.course_rad, limit)
                };
                if (course_rate, climb_rate) == (0.0, 0.0) {
                    self.fly_straight(until_s, flown);
                    return;
                }
                let step_s = left_s.min(climb_s).min(turn_s);
                // A turn at its bank ends with the roll-out, not on its course.
                let course_end = (step_s == turn_s && !turns).then_some(course_target);
                let climb_end = (step_s == climb_s).then_some(climb_target);
                let (course, climb) = ((course_rate, course_end), (climb_rate, climb_end));
                self.fly_arc(step_s, course, climb, flown);
                self.time_s = end_s(step_s);
                continue;
            }
            let longest_s = if (self.bank_rad - command).abs() <= NEARLY_THERE_RAD {
                LONGEST_END_S.min(2.0 * lag_s / STEPS_OF_LAG)
            } else {
                LONGEST_ROLL_S.min(lag_s / STEPS_OF_LAG)
            };
            let mut step_s = longest_s.min(left_s).min(climb_s);
            let now = RollMoment::of(self);
            let mut after = self.rolled((command, climb_rate), &now, step_s);
            if turns {
                let left = self.beyond_at(after.course_rad, after.bank_rad);
                if left * beyond < 0.0 {
                    let at_end = (step_s, left);
                    step_s =
                        self.roll_out_begins((command, climb_rate), at_end, (&now, &mut after));
                }
            } else {
                begun_for = Some(beyond);
            }
            let course_rate = (after.course_rad - self.course_rad) / step_s;
            let arc = self.arc(step_s, course_rate, climb_rate);
            flown(&arc, after.position_m);
            self.straight = None;
            self.position_m = after.position_m;
            self.course_rad = after.course_rad;
            self.bank_rad = after.bank_rad;
            self.climb_rad = after.climb_rad;
            self.time_s = end_s(step_s);
        }
    }

    pub(super) fn arc(
        &self,
        duration_s: f64,
        course_rate_radps: f64,
        climb_rate_radps: f64,
    ) -> Arc {
        Arc {
            start_s: self.time_s,
            duration_s,
            position_m: self.position_m,
            course_rad: self.course_rad,
            climb_rad: self.climb_rad,
            course_rate_radps,
            climb_rate_radps,
            airspeed_mps: self.vehicle.airspeed_mps,
            wind_mps: self.wind_mps,
        }
    }

    /// When the roll-out begins within a step at whose end it has begun (the Illinois method); sets the flight `after` to
    /// that moment.
    fn roll_out_begins(
        &self,
        (command, climb_rate): (f64, f64),
        (step_s, left): (f64, f64),
        (now, after): (&RollMoment, &mut RollMoment),
    ) -> f64 {
        let (mut a_s, mut at_a) = (0.0, self.beyond_at(now.course_rad, now.bank_rad));
        let (mut b_s, mut at_b) = (step_s, left);
        for _ in 0..STEPS_TO_ROLL_OUT {
            if at_b.abs() < ROLL_OUT_BEGINS_RAD || at_a == at_b {
                break;
            }
            let c_s = b_s - at_b * (b_s - a_s) / (at_b - at_a);
            *after = self.rolled((command, climb_rate), now, c_s);
            let at_c = self.beyond_at(after.course_rad, after.bank_rad);
            if at_c * at_b < 0.0 {
                (a_s, at_a) = (b_s, at_b);
            } else {
                at_a *= 0.5;
            }
            (b_s, at_b) = (c_s, at_c);
        }
        b_s
    }

    /// The remaining turn beyond the turn made while rolling out to level, radians.
    fn beyond_at(&self, course_rad: f64, bank_rad: f64) -> f64 {
        let Some(stage) = self.active else {
            return 0.0;
        };
        let left_rad = stage.course_rad - course_rad;
        if bank_rad == 0.0 {
            return left_rad;
        }
        let response = self.vehicle.response;
        let rolling_out = response.turn_rate_factor * STANDARD_GRAVITY_MPS2
            / self.vehicle.airspeed_mps
            * response.bank_time_constant_s
            * roll_out_integral(bank_rad);
        left_rad - rolling_out
    }

    /// The moment after a part of a roll: the bank decays exactly towards its command.
    fn rolled(
        &self,
        (bank_command, climb_rate): (f64, f64),
        now: &RollMoment,
        step_s: f64,
    ) -> RollMoment {
        let response = self.vehicle.response;
        let half_s = 0.5 * step_s;
        let decay = libm::exp(-half_s / response.bank_time_constant_s);
        let off = now.bank_rad - bank_command;
        let middle_bank = bank_command + off * decay;
        let bank_rad = bank_command + off * decay * decay;
        let bank_tan = libm::tan(bank_rad);
        let gain = response.turn_rate_factor * STANDARD_GRAVITY_MPS2 / self.vehicle.airspeed_mps;
        let (r0, r1, r2) = (
            gain * now.bank_tan,
            gain * libm::tan(middle_bank),
            gain * bank_tan,
        );
        // The integrals of the parabola through the three rates.
        let middle_course = now.course_rad + step_s / 24.0 * (5.0 * r0 + 8.0 * r1 - r2);
        let course_rad = now.course_rad + step_s / 6.0 * (r0 + 4.0 * r1 + r2);
        let climb_at = |after_s: f64| {
            if climb_rate == 0.0 {
                now.climb
            } else {
                libm::sincos(now.climb_rad + climb_rate * after_s)
            }
        };
        let middle = RollMoment {
            course: libm::sincos(middle_course),
            climb: climb_at(half_s),
            ..*now
        };
        let end = RollMoment {
            position_m: now.position_m,
            course_rad,
            climb_rad: now.climb_rad + climb_rate * step_s,
            bank_rad,
            bank_tan,
            course: libm::sincos(course_rad),
            climb: climb_at(step_s),
        };
        let sum = now.direction() + middle.direction() * 4.0 + end.direction();
        RollMoment {
            position_m: now.position_m
                + sum * (self.vehicle.airspeed_mps * step_s / 6.0)
                + self.wind_mps * step_s,
            ..end
        }
    }

    /// The flight after one Runge–Kutta step under a bank command.
    fn stepped(&self, bank_command: f64, climb_rate: f64, step_s: f64) -> PiState {
        let response = self.vehicle.response;
        let (time_constant_s, factor) = (response.bank_time_constant_s, response.turn_rate_factor);
        let (speed, wind, climb) = (self.vehicle.airspeed_mps, self.wind_mps, self.climb_rad);
        let before = PiState {
            position_m: self.position_m,
            course_rad: self.course_rad,
            bank_rad: if time_constant_s > 0.0 {
                self.bank_rad
            } else {
                bank_command
            },
        };
        let held = libm::sincos(climb);
        let heading = |course_rad: f64, after_s: f64| {
            let (sin_climb, cos_climb) = if climb_rate == 0.0 {
                held
            } else {
                libm::sincos(climb + climb_rate * after_s)
            };
            let (sin_course, cos_course) = libm::sincos(course_rad);
            Vec3::new(cos_climb * cos_course, cos_climb * sin_course, sin_climb)
        };
        let rate = |state: PiState, after_s: f64| PiState {
            position_m: heading(state.course_rad, after_s) * speed + wind,
            course_rad: factor * STANDARD_GRAVITY_MPS2 * libm::tan(state.bank_rad) / speed,
            bank_rad: if time_constant_s > 0.0 {
                (bank_command - state.bank_rad) / time_constant_s
            } else {
                0.0
            },
        };
        let half = step_s / 2.0;
        let k1 = rate(before, 0.0);
        let k2 = rate(before.plus(k1, half), half);
        let k3 = rate(before.plus(k2, half), half);
        let k4 = rate(before.plus(k3, step_s), step_s);
        before
            .plus(k1, step_s / 6.0)
            .plus(k2, step_s / 3.0)
            .plus(k3, step_s / 3.0)
            .plus(k4, step_s / 6.0)
    }

    /// Flies Runge–Kutta steps until `until_s` under the PI autopilot.
    pub(super) fn fly_controlled(&mut self, until_s: f64, flown: &mut impl FnMut(&Arc, Vec3)) {
        self.straight = None;
        let span_s = until_s - self.time_s;
        let steps = whole(libm::ceil(span_s / LONGEST_STEP_S - 1e-9)).max(1);
        let step_s = span_s / f64::from(steps);
        let start_s = self.time_s;
        for k in 1..=steps {
            self.step_controlled(step_s, flown);
            self.time_s = start_s + span_s * f64::from(k) / f64::from(steps);
        }
        self.time_s = until_s;
    }

    fn step_controlled(&mut self, step_s: f64, flown: &mut impl FnMut(&Arc, Vec3)) {
        let bank_command = self.bank_command_rad(step_s);
        let climb_rate = self.climb_rate_command_radps(step_s);
        let after = self.stepped(bank_command, climb_rate, step_s);
        let course_rate = (after.course_rad - self.course_rad) / step_s;
        let arc = self.arc(step_s, course_rate, climb_rate);
        flown(&arc, after.position_m);
        self.position_m = after.position_m;
        self.course_rad = after.course_rad;
        self.bank_rad = after.bank_rad;
        self.climb_rad += climb_rate * step_s;
    }

    /// Bank demand of the course controller.
    fn bank_command_rad(&mut self, step_s: f64) -> f64 {
        let Some(stage) = self.active else {
            return 0.0;
        };
        let limit = self.course_rate_limit_radps() * stage.rate_share;
        let remaining = stage.course_rad - self.course_rad;
        let rate = match &mut self.controllers[0] {
            Some(controller) => controller.step(remaining, step_s),
            None => remaining / step_s,
        };
        self.bank_of(rate.clamp(-limit, limit))
    }

    fn climb_rate_command_radps(&mut self, step_s: f64) -> f64 {
        let limit = self.vehicle.climb_rate_radps;
        let remaining = self.climb_target_rad() - self.climb_rad;
        let rate = match &mut self.controllers[1] {
            Some(controller) => controller.step(remaining, step_s),
            None => remaining / step_s,
        };
        rate.clamp(-limit, limit)
    }
}

#[cfg(test)]
mod tests {
    use super::super::autopilot::Autopilot;
    use super::*;
    use fga::vehicle::Vehicle;

    /// Rolls to one side and then to the other, climbing, in wind, against the equations of motion in fine steps.
    #[test]
    fn a_roll_is_flown_as_fine_steps_fly_it() {
        for (airspeed_mps, lag_s) in [(15.0, 0.2), (22.0, 0.6), (60.0, 1.2)] {
            let mut vehicle = Vehicle::table_4();
            vehicle.response.bank_time_constant_s = lag_s;
            vehicle.response.turn_rate_factor = 0.74;
            let vehicle = super::super::at_airspeed(&vehicle, airspeed_mps);
            let mut plant = Plant::new(vehicle, Autopilot::Direct, Vec3::new(3.0, -4.0, 0.0));
            plant.place(0.0, Vec3::ZERO, 0.3, 0.0);
            let (mut fine, mut between_m, mut arcs) = (plant.clone(), 0.0_f64, 0);
            for cycle in 0..12 {
                let side = if cycle < 6 { 1.0 } else { -1.0 };
                plant.active = Some(fga::maneuver::Stage {
                    start_s: 0.0,
                    course_rad: 6.0 * side,
                    climb_rad: vehicle.climb_max_rad,
                    rate_share: 1.0,
                });
                plant.advance(0.1, |arc, end_m| {
                    arcs += 1;
                    for tenth in 1..=10 {
                        let after_s = arc.duration_s * f64::from(tenth) / 10.0;
                        fly_finely(&mut fine, side, arc.start_s + after_s);
                        let at_m = arc.position_at_m(after_s);
                        between_m = between_m.max(at_m.distance(fine.position_m));
                    }
                    assert!(end_m.distance(fine.position_m) < 2e-5, "{arc:?}");
                });
            }
            assert!((plant.course_rad - fine.course_rad).abs() < 1e-6);
            assert!((plant.bank_rad - fine.bank_rad).abs() < 1e-9);
            assert!(between_m < 6e-4, "{lag_s}: {between_m}");
            assert!(arcs >= 24, "{arcs}");
        }
    }

    /// Flies the reference in Runge–Kutta steps of at most 0.1 ms under the largest bank to one side.
    fn fly_finely(fine: &mut Plant, side: f64, until_s: f64) {
        let command = side * fine.bank_of(fine.course_rate_limit_radps());
        let climb_rate = fine.vehicle.climb_rate_radps;
        while fine.time_s < until_s {
            let step_s = (until_s - fine.time_s).min(1e-4);
            let after = fine.stepped(command, climb_rate, step_s);
            fine.position_m = after.position_m;
            fine.course_rad = after.course_rad;
            fine.bank_rad = after.bank_rad;
            fine.climb_rad += climb_rate * step_s;
            fine.time_s += step_s;
        }
    }

    /// Against Simpson's rule in a thousand steps.
    #[test]
    fn a_roll_out_turns_by_the_integral_of_its_rate() {
        let rate = |bank_rad: f64| libm::tan(bank_rad) / bank_rad;
        for hundredths in (-139..=139).filter(|hundredths| *hundredths != 0) {
            let bank_rad = 0.01 * f64::from(hundredths);
            let step_rad = bank_rad / 1000.0;
            let mut turn = (1.0 + rate(bank_rad)) * step_rad / 3.0;
            for step in 1..1000 {
                let weight = if step % 2 == 1 { 4.0 } else { 2.0 };
                turn += weight * rate(step_rad * f64::from(step)) * step_rad / 3.0;
            }
            let found = roll_out_integral(bank_rad);
            assert!((found - turn).abs() < 1e-9, "{bank_rad}: {found} {turn}");
        }
    }
}
