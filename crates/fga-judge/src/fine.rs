//! The real result of a manoeuvre: integrated in millisecond steps, measured against the obstacles.
//!
//! It judges certificates and shares no code with them: it has its own equations of motion (the
//! classical Runge–Kutta rule), lag, wind, growth and distances. Left is positive.
//!
//! The bank follows its command exponentially. The command is the bank of the largest course rate
//! until the remaining turn equals the turn made while rolling out to level, then level.

use fga_proof::Vec3;
use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::situation::{Ownship, ProtectedVolume};
use fga_proof::vehicle::{STANDARD_GRAVITY_MPS2, Vehicle};

/// Integration step, seconds.
const STEP_S: f64 = 1e-3;

/// A bank below this is level, radians.
const LEVEL_RAD: f64 = 1e-9;

/// A course or climb angle this close to its target has reached it, radians.
const THERE_RAD: f64 = 1e-12;

/// Abscissas and weights of Gauss's rule with eight points on [−1, 1], one half of each.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];

/// An obstacle that flies straight over the ground; its volume grows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowingBody {
    /// Centre at the beginning, metres.
    pub position_m: Vec3,
    /// Velocity over the ground, metres per second.
    pub velocity_mps: Vec3,
    /// The volume at the beginning.
    pub volume: ProtectedVolume,
    /// Outward speed of its surface, metres per second.
    pub growth_mps: f64,
}

impl GrowingBody {
    /// Signed distance of a point from the volume at a time, metres, by elementary geometry.
    pub fn margin_m(&self, position_m: Vec3, at_s: f64) -> f64 {
        let x = position_m.x - (self.position_m.x + self.velocity_mps.x * at_s);
        let y = position_m.y - (self.position_m.y + self.velocity_mps.y * at_s);
        let z = position_m.z - (self.position_m.z + self.velocity_mps.z * at_s);
        let beyond = match self.volume {
            ProtectedVolume::Sphere { radius_m } => (x * x + y * y + z * z).sqrt() - radius_m,
            ProtectedVolume::Cylinder {
                radius_m,
                half_height_m,
            } => {
                let beside = x.hypot(y) - radius_m;
                let above = z.abs() - half_height_m;
                if beside > 0.0 && above > 0.0 {
                    beside.hypot(above)
                } else {
                    beside.max(above)
                }
            }
        };
        beyond - self.growth_mps * at_s
    }
}

/// The flown state: position over the ground, angles through the air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FineState {
    /// Seconds from the decision.
    pub time_s: f64,
    /// Position over the ground, metres.
    pub position_m: Vec3,
    /// Course, radians, not wrapped.
    pub course_rad: f64,
    /// Climb angle, radians.
    pub climb_rad: f64,
    /// Bank, radians.
    pub bank_rad: f64,
}

/// An aircraft that flies a manoeuvre.
#[derive(Debug, Clone)]
pub struct FineFlight<'a> {
    vehicle: &'a Vehicle,
    wind_mps: Vec3,
    maneuver: &'a Maneuver,
    next: usize,
    /// The manoeuvre; before its first stage it holds course and climb angle.
    stage: Stage,
    state: FineState,
    /// The remaining turn beyond the turn made while rolling out, radians; 0 without lag.
    left_rad: f64,
}

/// Constant rates during a step, or the commanded bank.
#[derive(Clone, Copy)]
struct Drive {
    course_radps: f64,
    bank_command_rad: Option<f64>,
    climb_radps: f64,
}

impl<'a> FineFlight<'a> {
    /// At the moment of the decision.
    pub fn new(
        vehicle: &'a Vehicle,
        wind_mps: Vec3,
        start: &Ownship,
        maneuver: &'a Maneuver,
    ) -> Self {
        let mut flight = Self {
            vehicle,
            wind_mps,
            maneuver,
            next: 0,
            stage: Stage {
                start_s: 0.0,
                course_rad: start.course_rad,
                climb_rad: start.climb_rad,
                rate_share: 1.0,
            },
            state: FineState {
                time_s: 0.0,
                position_m: start.position_m,
                course_rad: start.course_rad,
                climb_rad: start.climb_rad,
                bank_rad: start.bank_rad,
            },
            left_rad: 0.0,
        };
        flight.left_rad = flight.left_rad(&flight.state);
        flight
    }

    /// The state now.
    pub const fn state(&self) -> &FineState {
        &self.state
    }

    /// Flies until `until_s`, shows both ends of every piece and whether it was straight.
    pub fn fly(&mut self, until_s: f64, mut flown: impl FnMut(&FineState, &FineState, bool)) {
        while self.state.time_s < until_s {
            let stages = self.maneuver.stages();
            while let Some(stage) = stages.get(self.next)
                && stage.start_s <= self.state.time_s
            {
                self.stage = *stage;
                self.left_rad = self.left_rad(&self.state);
                self.next += 1;
            }
            let next_s = stages
                .get(self.next)
                .map_or(until_s, |stage| stage.start_s.min(until_s));
            let left_s = next_s - self.state.time_s;
            let (drive, ends_s) = self.drive();
            let straight = ends_s == f64::INFINITY && drive.bank_command_rad.is_none();
            let step_s = if straight {
                left_s
            } else {
                STEP_S.min(left_s).min(ends_s)
            };
            let before = self.state;
            let mut after = self.stepped(&drive, step_s);
            let mut left_rad = self.left_rad(&after);
            if drive.bank_command_rad.is_some_and(|bank| bank != 0.0)
                && self.left_rad.signum() != left_rad.signum()
            {
                // The roll-out begins within this step.
                let (mut early_s, mut late_s) = (0.0, step_s);
                for _ in 0..50 {
                    let middle_s = 0.5 * (early_s + late_s);
                    let middle = self.stepped(&drive, middle_s);
                    if self.left_rad(&middle).signum() == self.left_rad.signum() {
                        early_s = middle_s;
                    } else {
                        late_s = middle_s;
                    }
                }
                after = self.stepped(&drive, late_s);
                left_rad = self.left_rad(&after);
            } else if step_s == left_s {
                after.time_s = next_s;
            }
            (self.state, self.left_rad) = (after, left_rad);
            flown(&before, &after, straight);
        }
    }

    /// The present command, and the longest time that it keeps its rates.
    fn drive(&self) -> (Drive, f64) {
        let stage = self.stage;
        let target = stage
            .climb_rad
            .clamp(self.vehicle.climb_min_rad, self.vehicle.climb_max_rad);
        let climb_left = target - self.state.climb_rad;
        let (climb_radps, climb_s) = moving(climb_left, self.vehicle.climb_rate_radps);
        let most = self.vehicle.response.turn_rate_factor * self.vehicle.airspeed_mps
            / self.vehicle.turn_radius_m
            * stage.rate_share;
        if self.lag_s() <= 0.0 {
            let (course_radps, turn_s) = moving(stage.course_rad - self.state.course_rad, most);
            let drive = Drive {
                course_radps,
                bank_command_rad: None,
                climb_radps,
            };
            return (drive, climb_s.min(turn_s));
        }
        let bank_command_rad = if self.left_rad.abs() > 1e-8 {
            Some((most / self.gain()).atan().copysign(self.left_rad))
        } else if self.state.bank_rad.abs() > LEVEL_RAD {
            Some(0.0)
        } else {
            None
        };
        let drive = Drive {
            course_radps: 0.0,
            bank_command_rad,
            climb_radps,
        };
        (drive, climb_s)
    }

    fn lag_s(&self) -> f64 {
        self.vehicle.response.bank_time_constant_s
    }

    /// Course rate over the tangent of the bank, per second.
    fn gain(&self) -> f64 {
        self.vehicle.response.turn_rate_factor * STANDARD_GRAVITY_MPS2 / self.vehicle.airspeed_mps
    }

    /// The remaining turn beyond the turn made while rolling out to level, radians; 0 without lag.
    fn left_rad(&self, state: &FineState) -> f64 {
        if self.lag_s() <= 0.0 {
            return 0.0;
        }
        // ∫ tan φ dt with φ falling as e^(−t/τ) is τ ∫ tan(u)/u du from 0 to φ.
        let half = 0.5 * state.bank_rad;
        let integrand = |x: f64| {
            let u = half * (1.0 + x);
            if u == 0.0 { 1.0 } else { u.tan() / u }
        };
        let sum: f64 = GAUSS
            .iter()
            .map(|(x, weight)| weight * (integrand(*x) + integrand(-x)))
            .sum();
        let rolling_out = self.gain() * self.lag_s() * sum * half;
        self.stage.course_rad - state.course_rad - rolling_out
    }

    /// One Runge–Kutta step.
    fn stepped(&self, drive: &Drive, step_s: f64) -> FineState {
        let (speed, gain, lag_s) = (self.vehicle.airspeed_mps, self.gain(), self.lag_s());
        // x, y, z, course, climb, bank.
        let rates = |s: [f64; 6]| {
            let [_, _, _, course, climb, bank] = s;
            let turning = match drive.bank_command_rad {
                Some(_) => gain * bank.tan(),
                None => drive.course_radps,
            };
            let rolling = drive
                .bank_command_rad
                .map_or(0.0, |command| (command - bank) / lag_s);
            [
                speed * climb.cos() * course.cos() + self.wind_mps.x,
                speed * climb.cos() * course.sin() + self.wind_mps.y,
                speed * climb.sin() + self.wind_mps.z,
                turning,
                drive.climb_radps,
                rolling,
            ]
        };
        let s = self.state;
        let from = [
            s.position_m.x,
            s.position_m.y,
            s.position_m.z,
            s.course_rad,
            s.climb_rad,
            s.bank_rad,
        ];
        let on = |by_s: f64, rate: [f64; 6]| {
            let mut moved = from;
            for (x, rate) in moved.iter_mut().zip(rate) {
                *x += by_s * rate;
            }
            moved
        };
        let k1 = rates(from);
        let k2 = rates(on(0.5 * step_s, k1));
        let k3 = rates(on(0.5 * step_s, k2));
        let k4 = rates(on(step_s, k3));
        let mut sum = k1;
        for (((sum, k2), k3), k4) in sum.iter_mut().zip(k2).zip(k3).zip(k4) {
            *sum = (*sum + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
        }
        let [x, y, z, course_rad, climb_rad, bank_rad] = on(step_s, sum);
        FineState {
            time_s: s.time_s + step_s,
            position_m: Vec3::new(x, y, z),
            course_rad,
            climb_rad,
            bank_rad: if self.lag_s() > 0.0 { bank_rad } else { 0.0 },
        }
    }

    /// Least signed distance to any body's volume up to `until_s`, metres; infinite without bodies.
    pub fn least_margin_m(&mut self, bodies: &[GrowingBody], until_s: f64) -> f64 {
        let mut least = bodies
            .iter()
            .map(|body| body.margin_m(self.state.position_m, self.state.time_s))
            .fold(f64::INFINITY, f64::min);
        self.fly(until_s, |from, to, straight| {
            for body in bodies {
                least = least.min(body.margin_m(to.position_m, to.time_s));
                if straight {
                    least = least.min(least_between(from, to, body));
                }
            }
        });
        least
    }
}

/// The rate that closes a difference, and its duration.
fn moving(left_rad: f64, limit_radps: f64) -> (f64, f64) {
    if left_rad.abs() < THERE_RAD || limit_radps <= 0.0 {
        return (0.0, f64::INFINITY);
    }
    (limit_radps.copysign(left_rad), left_rad.abs() / limit_radps)
}

/// Least margin on a straight piece, along which it is a convex function.
fn least_between(from: &FineState, to: &FineState, body: &GrowingBody) -> f64 {
    let span_s = to.time_s - from.time_s;
    let at = |share: f64| {
        let position_m = from.position_m + (to.position_m - from.position_m) * share;
        body.margin_m(position_m, from.time_s + span_s * share)
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let third = (high - low) / 3.0;
        if at(low + third) < at(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    at(0.5 * (low + high))
}
