//! The real result of a manoeuvre: integrated in millisecond steps, measured against the obstacles.
//!
//! It judges certificates and shares no code with them: it has its own equations of motion (bank and
//! climb exactly, the rest by the corrected trapezoidal rule), wind, growth and distances. Left is positive.
//!
//! The bank follows its command exponentially. The command is the bank of the largest course rate
//! until the remaining turn equals the turn made while rolling out to level, then level.

use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::situation::{Ownship, ProtectedVolume};
use fga_proof::vehicle::{STANDARD_GRAVITY_MPS2, Vehicle};
use fga_proof::{Vec2, Vec3};

/// Integration step, seconds.
const STEP_S: f64 = 1e-3;

/// A bank below this is level, radians.
const LEVEL_RAD: f64 = 1e-9;

/// A remaining turn below this has ended, radians.
const TURNED_RAD: f64 = 1e-8;

/// Factor on the largest possible rate of what is not looked at in every step.
const LOOK_EARLIER: f64 = 1.001;

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

/// The flown state: position over the ground, angles through the air, the course not wrapped.
#[derive(Debug, Clone, Copy)]
struct FineState {
    time_s: f64,
    position_m: Vec3,
    course_rad: f64,
    climb_rad: f64,
    bank_rad: f64,
    /// Cosine and sine of the course, the climb angle and the bank.
    directions: [Vec2; 3],
}

/// An aircraft that flies a manoeuvre.
#[derive(Debug, Clone)]
pub struct FineFlight<'a> {
    vehicle: Vehicle,
    wind_mps: Vec3,
    maneuver: &'a Maneuver,
    next: usize,
    /// The manoeuvre; before its first stage it holds course and climb angle.
    stage: Stage,
    state: FineState,
    /// The ends of the pieces flown; only straight pieces are longer than a step.
    flown: Vec<FineState>,
    /// The remaining turn beyond the turn made while rolling out, radians, when last looked at; 0 without lag.
    left_rad: f64,
    /// Before this time the remaining turn cannot end, seconds.
    turns_until_s: f64,
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
    pub fn new(vehicle: &Vehicle, wind_mps: Vec3, start: &Ownship, maneuver: &'a Maneuver) -> Self {
        let angles_rad = [start.course_rad, start.climb_rad, start.bank_rad];
        let state = FineState {
            time_s: 0.0,
            position_m: start.position_m,
            course_rad: start.course_rad,
            climb_rad: start.climb_rad,
            bank_rad: start.bank_rad,
            directions: angles_rad.map(Vec2::from_angle),
        };
        let mut flight = Self {
            vehicle: *vehicle,
            wind_mps,
            maneuver,
            next: 0,
            stage: Stage {
                start_s: 0.0,
                course_rad: start.course_rad,
                climb_rad: start.climb_rad,
                rate_share: 1.0,
            },
            state,
            flown: vec![state],
            left_rad: 0.0,
            turns_until_s: 0.0,
        };
        flight.look();
        flight
    }

    /// Looks at the remaining turn. It changes by −gain · command · tan φ/φ, and tan φ/φ grows with the bank φ.
    fn look(&mut self) {
        self.left_rad = self.left_rad(&self.state);
        let command_rad = self.most_rad();
        let bank_rad = self.state.bank_rad.abs().max(command_rad);
        let fastest_radps = self.gain() * command_rad * bank_rad.tan() / bank_rad;
        let least_s = (self.left_rad.abs() - TURNED_RAD) / (LOOK_EARLIER * fastest_radps);
        self.turns_until_s = self.state.time_s + least_s;
    }

    /// Flies until `until_s`; the position there.
    pub fn fly(&mut self, until_s: f64) -> Vec3 {
        while self.state.time_s < until_s {
            let now_s = self.state.time_s;
            let stages = self.maneuver.stages();
            while let Some(stage) = stages.get(self.next)
                && stage.start_s <= now_s
            {
                self.stage = *stage;
                self.look();
                self.next += 1;
            }
            let next_s = stages
                .get(self.next)
                .map_or(until_s, |stage| stage.start_s.min(until_s));
            let left_s = next_s - now_s;
            let (drive, ends_s) = self.drive();
            let straight = ends_s == f64::INFINITY && drive.bank_command_rad.is_none();
            let is_turning = drive.bank_command_rad.is_some_and(|bank| bank != 0.0);
            let same_s = if is_turning {
                left_s.min(ends_s).min(self.turns_until_s - now_s)
            } else {
                left_s.min(ends_s)
            };
            if same_s > 2.0 * STEP_S && !straight {
                self.fly_on(&drive, same_s);
                continue;
            }
            let step_s = if straight {
                left_s
            } else {
                STEP_S.min(left_s).min(ends_s)
            };
            let mut after = self.stepped(&self.state, &drive, step_s);
            let is_over = |s: &FineState| self.left_rad(s).signum() != self.left_rad.signum();
            let is_looked_at = is_turning && after.time_s >= self.turns_until_s;
            if is_looked_at && is_over(&after) {
                // The roll-out begins within this step.
                let (mut early_s, mut late_s) = (0.0, step_s);
                for _ in 0..50 {
                    let middle_s = 0.5 * (early_s + late_s);
                    if is_over(&self.stepped(&self.state, &drive, middle_s)) {
                        late_s = middle_s;
                    } else {
                        early_s = middle_s;
                    }
                }
                after = self.stepped(&self.state, &drive, late_s);
            } else if step_s == left_s {
                after.time_s = next_s;
            }
            self.state = after;
            self.flown.push(after);
            if is_looked_at {
                self.look();
            }
        }
        self.state.position_m
    }

    /// Flies steps in which nothing begins or ends but the bank.
    fn fly_on(&mut self, drive: &Drive, mut same_s: f64) {
        let (mut state, mut flown) = (self.state, core::mem::take(&mut self.flown));
        while same_s > 2.0 * STEP_S
            && (drive.bank_command_rad != Some(0.0) || state.bank_rad.abs() > LEVEL_RAD)
        {
            state = self.stepped(&state, drive, STEP_S);
            flown.push(state);
            same_s -= STEP_S;
        }
        (self.state, self.flown) = (state, flown);
    }

    /// The present command, and the longest time that it keeps its rates.
    fn drive(&self) -> (Drive, f64) {
        let stage = self.stage;
        let target = stage
            .climb_rad
            .clamp(self.vehicle.climb_min_rad, self.vehicle.climb_max_rad);
        let climb_left = target - self.state.climb_rad;
        let (climb_radps, climb_s) = moving(climb_left, self.vehicle.climb_rate_radps);
        if self.lag_s() <= 0.0 {
            let (course_radps, turn_s) =
                moving(stage.course_rad - self.state.course_rad, self.most_radps());
            let drive = Drive {
                course_radps,
                bank_command_rad: None,
                climb_radps,
            };
            return (drive, climb_s.min(turn_s));
        }
        let bank_command_rad = if self.left_rad.abs() > TURNED_RAD {
            Some(self.most_rad().copysign(self.left_rad))
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

    /// Largest course rate of the stage, radians per second.
    fn most_radps(&self) -> f64 {
        self.vehicle.response.turn_rate_factor * self.vehicle.airspeed_mps
            / self.vehicle.turn_radius_m
            * self.stage.rate_share
    }

    /// The bank at that rate, radians.
    fn most_rad(&self) -> f64 {
        (self.most_radps() / self.gain()).atan()
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

    /// One step: bank and climb exactly, course and place by the trapezoidal rule with its correction, h²/12 times the difference
    /// of the derivatives.
    #[expect(clippy::inline_always, reason = "a step stays in registers")]
    #[inline(always)]
    fn stepped(&self, s: &FineState, drive: &Drive, step_s: f64) -> FineState {
        let [course, climb, bank] = s.directions;
        let (half_s, correction_s2) = (0.5 * step_s, step_s * step_s / 12.0);
        let mut course_radps = [drive.course_radps; 2];
        let mut turn_rad = drive.course_radps * step_s;
        let mut roll_rad = 0.0;
        if let Some(command_rad) = drive.bank_command_rad {
            let (gain, lag_s) = (self.gain(), self.lag_s());
            let left_rad = command_rad - s.bank_rad;
            let keeps = (-step_s / lag_s).exp();
            roll_rad = left_rad * (1.0 - keeps);
            let [tan, end_tan] = [bank, turned(bank, roll_rad)].map(|bank| bank.y / bank.x);
            let slower = (1.0 + tan * tan) - keeps * (1.0 + end_tan * end_tan);
            turn_rad =
                gain * (half_s * (tan + end_tan) + correction_s2 / lag_s * left_rad * slower);
            course_radps = [gain * tan, gain * end_tan];
        }
        let ends = [
            turned(course, turn_rad),
            turned(climb, drive.climb_radps * step_s),
            turned(bank, roll_rad),
        ];
        // The direction of flight and its derivative.
        let flies = |course: Vec2, climb: Vec2, course_radps: f64| {
            let sideways = course.perp() * (climb.x * course_radps);
            let along = course * (-climb.y * drive.climb_radps);
            let derivative = (sideways + along).extend(climb.x * drive.climb_radps);
            ((course * climb.x).extend(climb.y), derivative)
        };
        let (from, from_rate) = flies(course, climb, course_radps[0]);
        let (to, to_rate) = flies(ends[0], ends[1], course_radps[1]);
        let way_s = (from + to) * half_s + (from_rate - to_rate) * correction_s2;
        let moved_m = way_s * self.vehicle.airspeed_mps + self.wind_mps * step_s;
        FineState {
            time_s: s.time_s + step_s,
            position_m: s.position_m + moved_m,
            course_rad: s.course_rad + turn_rad,
            climb_rad: s.climb_rad + drive.climb_radps * step_s,
            bank_rad: s.bank_rad + roll_rad,
            directions: ends,
        }
    }

    /// Least signed distance to any body's volume so far, metres; infinite without bodies. Pieces are skipped only where even
    /// the largest relative speed brings no body nearer than the least distance.
    pub fn least_margin_m(&self, bodies: &[GrowingBody]) -> f64 {
        let speeds = bodies
            .iter()
            .map(|body| (self.wind_mps - body.velocity_mps).length() + body.growth_mps);
        let fastest_mps = self.vehicle.airspeed_mps + speeds.fold(0.0, f64::max);
        let nearest_m = |at: &FineState| {
            let margins = bodies.iter().map(|b| b.margin_m(at.position_m, at.time_s));
            margins.fold(f64::INFINITY, f64::min)
        };
        let some_m = self.flown.iter().step_by(64).map(nearest_m);
        let mut least_m = some_m.fold(f64::INFINITY, f64::min);
        let mut look_s = 0.0;
        for (from, to) in self.flown.iter().zip(&self.flown[1..]) {
            if to.time_s < look_s {
                continue;
            }
            if to.time_s - from.time_s > LOOK_EARLIER * STEP_S {
                let between_m = bodies.iter().map(|body| least_between(from, to, body));
                least_m = between_m.fold(least_m, f64::min);
            }
            let margin_m = nearest_m(to);
            least_m = least_m.min(margin_m);
            look_s = to.time_s + (margin_m - least_m) / (LOOK_EARLIER * fastest_mps);
        }
        least_m
    }
}

/// A direction turned by a small angle, by the series of its cosine and sine.
fn turned(direction: Vec2, by_rad: f64) -> Vec2 {
    if by_rad == 0.0 {
        return direction;
    }
    let x = by_rad * by_rad;
    let cos = 1.0 - x * (1.0 / 2.0 - x * (1.0 / 24.0 - x * (1.0 / 720.0)));
    let sin = by_rad * (1.0 - x * (1.0 / 6.0 - x * (1.0 / 120.0 - x * (1.0 / 5040.0))));
    direction.rotate(Vec2::new(cos, sin))
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
