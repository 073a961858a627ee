//! Drawn aircraft and manoeuvres, and their flights, integrated in steps of a millisecond or less by equations of the tests.

use core::f64::consts::TAU;

use fga_proof::Vec3;
use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::prediction::MotionState;
use fga_proof::vehicle::{Response, Vehicle};

use super::random::Random;

/// Longest step of the integration, seconds; also a two-hundredth of the time constant of the bank.
pub(crate) const STEP_S: f64 = 1e-3;

/// Error of integration and rounding, metres: `a_step_of_half_the_length_leads_to_the_same_place` measures less than half of it.
pub(crate) const INTEGRATED_M: f64 = 1e-5;

/// Acceleration of gravity, metres per second squared.
const GRAVITY: f64 = 9.806_65;

impl Random {
    /// In half of the cases without lag.
    pub(crate) fn vehicle(&mut self) -> Vehicle {
        let climb = if self.chance(0.3) {
            0.0
        } else {
            self.within(0.05, 0.6)
        };
        let ideal = Vehicle {
            airspeed_mps: self.within(8.0, 60.0),
            turn_radius_m: self.within(15.0, 300.0),
            climb_min_rad: -climb,
            climb_max_rad: climb,
            climb_rate_radps: self.within(0.02, 0.6),
            response: Response::default(),
        };
        if self.chance(0.5) {
            return ideal;
        }
        let response = Response {
            dead_time_s: 0.0,
            bank_time_constant_s: self.within(0.1, 2.0),
            turn_rate_factor: self.within(0.5, 1.2),
        };
        let lagged = Vehicle { response, ..ideal };
        if lagged.check().is_ok() {
            lagged
        } else {
            ideal
        }
    }

    /// In half of the cases none, else level with up to half of an airspeed, metres per second.
    pub(crate) fn wind_mps(&mut self, airspeed_mps: f64) -> Vec3 {
        if self.chance(0.5) {
            return Vec3::ZERO;
        }
        let (sin, cos) = self.within(0.0, TAU).sin_cos();
        Vec3::new(cos, sin, 0.0) * self.within(0.0, 0.5) * airspeed_mps
    }

    pub(crate) fn maneuver(&mut self) -> Maneuver {
        self.maneuver_from(0.0, 0.5)
    }

    /// From a course, with climb angles up to one, radians.
    pub(crate) fn maneuver_from(&mut self, course_rad: f64, climb_rad: f64) -> Maneuver {
        let mut maneuver = Maneuver::hold();
        let mut start_s = if self.chance(0.5) {
            0.0
        } else {
            self.within(0.0, 8.0)
        };
        let mut course = course_rad;
        for _ in 0..=(self.unit() * 3.0) as usize {
            course += self.within(-4.0, 4.0);
            assert!(maneuver.push(Stage {
                start_s,
                course_rad: course,
                climb_rad: self.within(-climb_rad, climb_rad),
                rate_share: if self.chance(0.7) {
                    1.0
                } else {
                    self.within(0.2, 1.0)
                },
            }));
            start_s += self.within(0.0, 12.0);
        }
        maneuver
    }
}

/// A number from the environment.
pub(crate) fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).map_or(otherwise, |text| text.parse().expect("a number"))
}

/// The numbers of some cases, from `FGA_FIRST_CASE` on, 0 without it.
pub(crate) fn drawn(cases: u64) -> core::ops::Range<u64> {
    let first = number("FGA_FIRST_CASE", 0);
    first..first + cases
}

/// tan φ / φ.
fn tan_over(bank: f64) -> f64 {
    if bank == 0.0 { 1.0 } else { bank.tan() / bank }
}

/// A direction and its rates at the beginning, the middle and the end of a step.
struct Step {
    lasts_s: f64,
    bank: f64,
    /// The course at the middle and the end.
    courses: [f64; 2],
    /// The course once rolled out from the end.
    rolled_out: f64,
}

/// The flight of an aircraft: the bank follows its command as a first-order lag, the course turns by factor · g · tan φ / V. The
/// command is the bank of the largest course rate until the turn that is left is the one made while rolling out, then level.
/// Without lag the course turns at that rate. The climb angle moves at its rate.
///
/// The course once rolled out is C = ψ + factor · g τ / V · ∫ tan u / u du from 0 to φ; under a commanded bank c it changes by
/// Ċ = factor · g / V · c · tan φ / φ. Here C is integrated, not looked up.
#[derive(Clone)]
pub(crate) struct Flown<'a> {
    vehicle: &'a Vehicle,
    stages: &'a [Stage],
    wind: Vec3,
    /// Longest step while the bank moves, and at constant rates.
    longest_s: (f64, f64),
    pub(crate) at: Vec3,
    pub(crate) course: f64,
    climb: f64,
    bank: f64,
    rolled_out: f64,
    /// The stage that is flown, and the number of those that have begun.
    stage: Option<Stage>,
    begun: usize,
    /// Whether the turn of the stage is over but for its roll-out.
    is_turned: bool,
    pub(crate) time_s: f64,
}

impl<'a> Flown<'a> {
    /// From the origin along x, in a wind.
    pub(crate) fn new(vehicle: &'a Vehicle, maneuver: &'a Maneuver, wind: Vec3) -> Self {
        Self::from(vehicle, &MotionState::ahead(0.0), maneuver, wind)
    }

    pub(crate) fn from(
        vehicle: &'a Vehicle,
        start: &MotionState,
        maneuver: &'a Maneuver,
        wind: Vec3,
    ) -> Self {
        let lag_s = vehicle.response.bank_time_constant_s;
        let longest_s = if lag_s > 0.0 {
            STEP_S.min(0.005 * lag_s)
        } else {
            STEP_S
        };
        let mut flown = Self {
            vehicle,
            stages: maneuver.stages(),
            wind,
            longest_s: (longest_s, STEP_S),
            at: start.position_m,
            course: start.course_rad,
            climb: start.climb_rad,
            bank: if lag_s > 0.0 { start.bank_rad } else { 0.0 },
            rolled_out: start.course_rad,
            stage: None,
            begun: 0,
            is_turned: false,
            time_s: 0.0,
        };
        // Simpson's rule.
        let (pieces, bank) = (2000, flown.bank);
        let at = |k: i32| tan_over(bank * f64::from(k) / f64::from(pieces));
        let inner: f64 = (1..pieces)
            .map(|k| at(k) * if k % 2 == 1 { 4.0 } else { 2.0 })
            .sum();
        let integral = (1.0 + inner + at(pieces)) * bank / (3.0 * f64::from(pieces));
        flown.rolled_out += flown.gain() * lag_s * integral;
        // Without a command it holds its course.
        flown.stage = Some(Stage::turn(0.0, start.course_rad, start.climb_rad));
        flown
    }

    /// The same in steps of another length.
    pub(crate) fn in_steps(mut self, share: f64) -> Self {
        self.longest_s.0 *= share;
        self.longest_s.1 = self.longest_s.0;
        self
    }

    /// The same in steps of up to a hundredth of a radian and a two-hundredth of the lag.
    pub(crate) fn in_long_steps(mut self) -> Self {
        let turn = self.gain() * self.full_rad(1.0).max(self.bank.abs()).tan();
        let steady_s = (10.0 * STEP_S).min(0.01 / (turn + self.vehicle.climb_rate_radps));
        let lag_s = self.vehicle.response.bank_time_constant_s;
        let rolling_s = if lag_s > 0.0 { 0.005 * lag_s } else { steady_s };
        self.longest_s = (rolling_s.min(steady_s), steady_s);
        self
    }

    /// Course rate at 45°.
    fn gain(&self) -> f64 {
        self.vehicle.response.turn_rate_factor * GRAVITY / self.vehicle.airspeed_mps
    }

    /// Largest acceleration of the flight through the air, metres per second squared.
    pub(crate) fn acceleration(&self) -> f64 {
        let full = self.full_rad(1.0).max(self.bank.abs());
        let turn = self.gain() * full.tan();
        self.vehicle.airspeed_mps * (turn.abs() + self.vehicle.climb_rate_radps)
    }

    /// Velocity over the ground, metres per second.
    pub(crate) fn velocity(&self) -> Vec3 {
        self.direction(self.course, self.climb) * self.vehicle.airspeed_mps + self.wind
    }

    fn climbs_to(&self, stage: &Stage) -> f64 {
        let vehicle = self.vehicle;
        (stage.climb_rad.min(vehicle.climb_max_rad)).max(vehicle.climb_min_rad)
    }

    fn full_rad(&self, share: f64) -> f64 {
        let speed = self.vehicle.airspeed_mps;
        (share * speed * speed / (GRAVITY * self.vehicle.turn_radius_m)).atan()
    }

    #[expect(clippy::unused_self, reason = "a term of the equations of motion")]
    fn direction(&self, course: f64, climb: f64) -> Vec3 {
        let ((sin, cos), (rise, level)) = (course.sin_cos(), climb.sin_cos());
        Vec3::new(level * cos, level * sin, rise)
    }

    /// A step under a commanded bank.
    fn roll(&self, command: f64, lasts_s: f64) -> Step {
        let lag_s = self.vehicle.response.bank_time_constant_s;
        let bank_at = |after_s: f64| command + (self.bank - command) * (-after_s / lag_s).exp();
        let banks = if self.bank == command {
            [command; 3]
        } else {
            [self.bank, bank_at(0.5 * lasts_s), bank_at(lasts_s)]
        };
        let [a, b, c] = banks.map(|bank| self.gain() * bank.tan());
        let [d, e, f] = banks.map(tan_over);
        Step {
            lasts_s,
            bank: banks[2],
            courses: [
                self.course + lasts_s * (5.0 * a + 8.0 * b - c) / 24.0,
                self.course + lasts_s * (a + 4.0 * b + c) / 6.0,
            ],
            rolled_out: self.rolled_out + lasts_s * self.gain() * command * (d + 4.0 * e + f) / 6.0,
        }
    }

    /// A step with lag, cut where the roll-out begins.
    fn lagged(&mut self, stage: &Stage, command: f64, lasts_s: f64) -> Step {
        let whole = self.roll(command, lasts_s);
        if self.is_turned {
            return whole;
        }
        let over = |step: &Step| (stage.course_rad - step.rolled_out) * command <= 0.0;
        if !over(&whole) {
            return whole;
        }
        let (mut low_s, mut high_s) = (0.0, lasts_s);
        for _ in 0..60 {
            let middle_s = 0.5 * (low_s + high_s);
            if over(&self.roll(command, middle_s)) {
                high_s = middle_s;
            } else {
                low_s = middle_s;
            }
        }
        self.is_turned = true;
        self.roll(command, high_s)
    }

    /// The bank that is commanded.
    fn command(&mut self, stage: &Stage) -> f64 {
        let left = stage.course_rad - self.rolled_out;
        self.is_turned |= left == 0.0;
        if self.is_turned {
            0.0
        } else {
            self.full_rad(stage.rate_share).copysign(left)
        }
    }

    pub(crate) fn step(&mut self) {
        self.step_until(f64::INFINITY);
    }

    /// A step that ends at a time at the latest.
    pub(crate) fn step_until(&mut self, until_s: f64) {
        let now_s = self.time_s + 1e-12;
        while let Some(next) = self
            .stages
            .get(self.begun)
            .filter(|next| next.start_s <= now_s)
        {
            (self.stage, self.begun, self.is_turned) = (Some(*next), self.begun + 1, false);
        }
        let next_s = self
            .stages
            .get(self.begun)
            .map_or(f64::INFINITY, |next| next.start_s);
        let stage = self.stage.expect("a command");
        let is_ideal = self.vehicle.response.bank_time_constant_s == 0.0;
        let command = if is_ideal { 0.0 } else { self.command(&stage) };
        if (self.bank - command).abs() < 1e-12 {
            self.bank = command;
        }
        let (rolling_s, steady_s) = self.longest_s;
        let longest_s = if self.bank == command && self.climb == self.climbs_to(&stage) {
            steady_s
        } else {
            rolling_s
        };
        let mut lasts_s = longest_s.min(next_s.min(until_s) - self.time_s);
        // The climb angle has a kink at its target, the course of an ideal aircraft too.
        let reaches = |left: f64, rate: f64, lasts_s: &mut f64| {
            if left.abs() < 1e-13 || rate <= 0.0 {
                return 0.0;
            }
            *lasts_s = lasts_s.min(left.abs() / rate);
            rate.copysign(left)
        };
        let vehicle = self.vehicle;
        let climb_left = self.climbs_to(&stage) - self.climb;
        let climb_rate = reaches(climb_left, vehicle.climb_rate_radps, &mut lasts_s);
        let step = if is_ideal {
            let most = self.gain() * self.full_rad(stage.rate_share).tan();
            let rate = reaches(stage.course_rad - self.course, most, &mut lasts_s);
            let courses = [0.5, 1.0].map(|share| self.course + rate * share * lasts_s);
            Step {
                lasts_s,
                bank: 0.0,
                courses,
                rolled_out: courses[1],
            }
        } else {
            self.lagged(&stage, command, lasts_s)
        };
        let lasts_s = step.lasts_s;
        let climbs = [0.5, 1.0].map(|share| self.climb + climb_rate * share * lasts_s);
        let [middle, end] = step.courses;
        let sum = if [middle, end] == [self.course; 2] && climb_rate == 0.0 {
            6.0 * self.direction(self.course, self.climb)
        } else {
            self.direction(self.course, self.climb)
                + 4.0 * self.direction(middle, climbs[0])
                + self.direction(end, climbs[1])
        };
        self.at += (sum * (vehicle.airspeed_mps / 6.0) + self.wind) * lasts_s;
        (self.course, self.climb) = (end, climbs[1]);
        if climb_rate != 0.0 && lasts_s == climb_left.abs() / vehicle.climb_rate_radps {
            self.climb = self.climbs_to(&stage);
        }
        (self.bank, self.rolled_out) = (step.bank, step.rolled_out);
        if self.is_turned && self.bank.abs() < 1e-11 {
            // It has come to the course where the roll-out was to lead.
            assert!(
                (self.course - stage.course_rad).abs() < 1e-6,
                "{}",
                self.course - stage.course_rad
            );
            self.bank = 0.0;
        }
        self.time_s += lasts_s;
    }
}
