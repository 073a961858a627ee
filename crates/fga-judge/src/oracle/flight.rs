//! The path of a manoeuvre: a chain of nodes, exact for the ideal vehicle, RK4 with a bank response.
//!
//! Course and climb angle of the ideal vehicle are linear in time on each piece, so
//! cos θ cos ψ = ½ cos(ψ+θ) + ½ cos(ψ−θ) integrates in closed form (Eq. 10–12).

use core::f64::consts::TAU;

use fga_proof::Vec3;
use fga_proof::vehicle::STANDARD_GRAVITY_MPS2;

use super::{OracleManeuver, OracleStart, OracleVehicle};

/// Longest time between two nodes of a curved piece, seconds.
const CURVED_STEP_S: f64 = 0.25;
/// Longest step of the Runge–Kutta integration, seconds, and the share of the time constant that
/// it must not exceed.
const RESPONSE_STEP_S: f64 = 0.1;
const RESPONSE_STEP_SHARE: f64 = 0.25;
/// Least time constant, seconds: a step must stay longer than rounding.
const LEAST_TIME_CONSTANT_S: f64 = 0.01;
/// Below this bank the rest of a roll-out counts as flown, radians: 0.4 mm at 15 m/s, 0.6 s.
const LEVEL_BANK_RAD: f64 = 3e-4;

/// A point of the path. The piece that follows it is straight or curved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlightNode {
    /// Time from the start, seconds.
    pub time_s: f64,
    /// Position, metres.
    pub position_m: Vec3,
    /// Velocity, metres per second.
    pub velocity_mps: Vec3,
    /// Course, radians, not wrapped.
    pub course_rad: f64,
    /// Climb angle, radians.
    pub climb_rad: f64,
    /// Bank angle, radians.
    pub bank_rad: f64,
    /// Whether the path is a straight line from here to the next node.
    pub straight: bool,
}

/// A manoeuvre flown from the start to the horizon.
#[derive(Debug, Clone, Default)]
pub struct OracleFlight {
    nodes: Vec<FlightNode>,
    /// Index of the node at which each leg ends.
    leg_ends: [usize; LEGS],
    acceleration_mps2: f64,
}

/// Legs of a flight: before the first turn, the first turn, between, the second turn, after.
pub(super) const LEGS: usize = 5;

/// One command: its duration, seconds, a turn by its sign, and a climb target, radians.
type OracleLeg = (f64, f64, f64);

impl OracleFlight {
    /// Flies `maneuver` from `start` for `horizon_s` seconds.
    pub fn new(
        start: &OracleStart,
        vehicle: &OracleVehicle,
        maneuver: &OracleManeuver,
        horizon_s: f64,
    ) -> Self {
        let mut flight = Self::default();
        flight.fly(start, vehicle, maneuver, horizon_s, None);
        flight
    }

    /// The nodes, first to last: at the start, at the horizon, and close enough in between that a
    /// cubic through positions and velocities is exact to 0.1 mm.
    pub fn nodes(&self) -> &[FlightNode] {
        &self.nodes
    }

    /// The nodes of each leg, including the last one of the previous leg.
    pub(super) fn legs(&self) -> impl Iterator<Item = &[FlightNode]> {
        let mut from = 0;
        self.leg_ends.iter().map(move |&end| {
            let leg = self.nodes.get(from..=end).unwrap_or(&[]);
            from = end;
            leg
        })
    }

    /// Bound of the acceleration on curved pieces, metres per second squared.
    pub(super) fn acceleration_mps2(&self) -> f64 {
        self.acceleration_mps2
    }

    /// State `at_s` seconds from the start, clamped to the ends: position by the cubic through the
    /// neighbouring nodes, angles linear between them.
    pub fn at(&self, at_s: f64) -> FlightNode {
        let after = self.nodes.partition_point(|n| n.time_s <= at_s);
        let (Some(a), Some(b)) = (
            self.nodes.get(after.saturating_sub(1)),
            self.nodes
                .get(after.min(self.nodes.len().saturating_sub(1))),
        ) else {
            unreachable!("a flight has at least one node")
        };
        let span = b.time_s - a.time_s;
        if span <= 0.0 {
            return FlightNode { time_s: at_s, ..*a };
        }
        let s = ((at_s - a.time_s) / span).clamp(0.0, 1.0);
        let mix = |from: f64, to: f64| from + (to - from) * s;
        FlightNode {
            time_s: at_s,
            position_m: hermite(a, b, s),
            velocity_mps: a.velocity_mps + (b.velocity_mps - a.velocity_mps) * s,
            course_rad: mix(a.course_rad, b.course_rad),
            climb_rad: mix(a.climb_rad, b.climb_rad),
            bank_rad: mix(a.bank_rad, b.bank_rad),
            straight: a.straight,
        }
    }

    /// As [`OracleFlight::new`], into the same memory. At `back_s`, or after the second turn if that is later, a
    /// third turn brings the aircraft back to the start's course, the shorter way, and level.
    pub(super) fn fly(
        &mut self,
        start: &OracleStart,
        vehicle: &OracleVehicle,
        maneuver: &OracleManeuver,
        horizon_s: f64,
        back_s: Option<f64>,
    ) {
        self.nodes.clear();
        let w = vehicle.course_rate_radps;
        let q = if vehicle.can_climb() {
            vehicle.climb_rate_radps
        } else {
            0.0
        };
        self.acceleration_mps2 = vehicle.airspeed_mps * libm::sqrt(w * w + q * q);
        let lagged = vehicle.bank_time_constant_s > 0.0;
        let mut pen = Pen {
            vehicle,
            horizon_s,
            time_s: 0.0,
            position_m: start.position_m,
            course_rad: start.course_rad,
            climb_rad: start.climb_rad,
            bank_rad: if lagged { start.bank_rad } else { 0.0 },
        };
        self.nodes.push(pen.node());
        let turn_s = |turn: f64| if w > 0.0 { turn.abs() / w } else { 0.0 };
        // During the dead time the aircraft holds its present bank and climb angle.
        if lagged && vehicle.dead_time_s > 0.0 && start.bank_rad != 0.0 {
            pen.hold_bank(vehicle.dead_time_s, &mut self.nodes);
        } else {
            let hold = (vehicle.dead_time_s, 0.0, start.climb_rad);
            pen.leg(hold, &mut self.nodes);
        }
        let (turn1, turn2) = (maneuver.turn1_rad, maneuver.turn2_rad);
        let (climb1, climb2) = (maneuver.climb1_rad, maneuver.climb2_rad);
        let legs: [OracleLeg; LEGS] = [
            (maneuver.wait_s.max(0.0), 0.0, start.climb_rad),
            (turn_s(turn1), turn1, climb1),
            (maneuver.straight_s.max(0.0), 0.0, climb1),
            (turn_s(turn2), turn2, climb2),
            (f64::INFINITY, 0.0, climb2),
        ];
        for (k, (leg, end)) in legs.into_iter().zip(&mut self.leg_ends).enumerate() {
            match back_s {
                Some(back_s) if k + 1 == LEGS => {
                    let straight_s = (back_s - pen.time_s).max(0.0);
                    pen.leg((straight_s, 0.0, climb2), &mut self.nodes);
                    let turn = libm::remainder(start.course_rad - pen.course_rad, TAU);
                    pen.leg((turn_s(turn), turn, 0.0), &mut self.nodes);
                    pen.leg((f64::INFINITY, 0.0, 0.0), &mut self.nodes);
                }
                _ => pen.leg(leg, &mut self.nodes),
            }
            *end = self.nodes.len().saturating_sub(1);
        }
    }
}

/// Position at the share `s` of the way between two nodes, by the cubic through both.
pub(super) fn hermite(a: &FlightNode, b: &FlightNode, s: f64) -> Vec3 {
    let span = b.time_s - a.time_s;
    let r = 1.0 - s;
    a.position_m * (r * r * (1.0 + 2.0 * s))
        + b.position_m * (s * s * (1.0 + 2.0 * r))
        + (a.velocity_mps * (r * r * s) - b.velocity_mps * (s * s * r)) * span
}

/// The state that moves along the path and leaves nodes behind.
struct Pen<'a> {
    vehicle: &'a OracleVehicle,
    horizon_s: f64,
    time_s: f64,
    position_m: Vec3,
    course_rad: f64,
    climb_rad: f64,
    bank_rad: f64,
}

impl Pen<'_> {
    fn node(&self) -> FlightNode {
        let (sin_course, cos_course) = libm::sincos(self.course_rad);
        let (sin_climb, cos_climb) = libm::sincos(self.climb_rad);
        FlightNode {
            time_s: self.time_s,
            position_m: self.position_m,
            velocity_mps: Vec3::new(cos_climb * cos_course, cos_climb * sin_course, sin_climb)
                * self.vehicle.airspeed_mps,
            course_rad: self.course_rad,
            climb_rad: self.climb_rad,
            bank_rad: self.bank_rad,
            straight: false,
        }
    }

    /// Flies one command until its time, or the horizon, is over.
    fn leg(&mut self, (duration_s, turn, climb_rad): OracleLeg, nodes: &mut Vec<FlightNode>) {
        let mut left_s = duration_s.min(self.horizon_s - self.time_s);
        let turn = if turn == 0.0 { 0.0 } else { turn.signum() };
        let target = climb_rad.clamp(self.vehicle.climb_min_rad, self.vehicle.climb_max_rad);
        while left_s > 1e-12 {
            let difference = target - self.climb_rad;
            let climbing = self.vehicle.can_climb() && difference.abs() > 1e-12;
            let (rate, span_s) = if climbing {
                let needed_s = difference.abs() / self.vehicle.climb_rate_radps;
                (
                    libm::copysign(self.vehicle.climb_rate_radps, difference),
                    needed_s.min(left_s),
                )
            } else {
                (0.0, left_s)
            };
            let flown_s = if self.vehicle.bank_time_constant_s > 0.0 {
                self.respond(turn, rate, span_s, nodes)
            } else {
                self.arc(turn, rate, span_s, nodes);
                span_s
            };
            if climbing && flown_s >= difference.abs() / self.vehicle.climb_rate_radps {
                self.climb_rad = target;
                if let Some(last) = nodes.last_mut() {
                    last.climb_rad = target;
                }
            }
            left_s -= flown_s;
        }
    }

    /// A straight piece along the present direction.
    fn line(&mut self, span_s: f64, nodes: &mut Vec<FlightNode>) {
        if let Some(last) = nodes.last_mut() {
            last.straight = true;
        }
        let node = self.node();
        self.position_m += node.velocity_mps * span_s;
        self.time_s += span_s;
        nodes.push(FlightNode {
            time_s: self.time_s,
            position_m: self.position_m,
            ..node
        });
    }

    /// A piece of the ideal vehicle: course and climb angle at constant rates, in closed form.
    fn arc(&mut self, turn: f64, climb_rate: f64, span_s: f64, nodes: &mut Vec<FlightNode>) {
        if turn == 0.0 && climb_rate == 0.0 {
            self.line(span_s, nodes);
            return;
        }
        let course_rate = turn * self.vehicle.course_rate_radps;
        let steps = libm::ceil(span_s / CURVED_STEP_S).max(1.0);
        let step_s = span_s / steps;
        // Sum and difference of course and climb angle, as unit vectors, turn by a constant angle
        // each step; the integral over a step is the mean direction times sin(x)/x.
        let mut sum = Spin::new(
            self.course_rad + self.climb_rad,
            (course_rate + climb_rate) * step_s,
        );
        let mut difference = Spin::new(
            self.course_rad - self.climb_rad,
            (course_rate - climb_rate) * step_s,
        );
        let mut rise = Spin::new(self.climb_rad, climb_rate * step_s);
        let speed = self.vehicle.airspeed_mps;
        let (from, course, climb) = (self.time_s, self.course_rad, self.climb_rad);
        let mut done = 0.0;
        while done < steps {
            done += 1.0;
            let (a, b, c) = (sum.advance(), difference.advance(), rise.advance());
            let elapsed = step_s * done;
            self.position_m +=
                Vec3::new(0.5 * (a.0 + b.0), 0.5 * (a.1 + b.1), c.1) * (speed * step_s);
            self.time_s = from + elapsed;
            self.course_rad = course + course_rate * elapsed;
            self.climb_rad = climb + climb_rate * elapsed;
            nodes.push(FlightNode {
                time_s: self.time_s,
                position_m: self.position_m,
                velocity_mps: Vec3::new(
                    0.5 * (sum.now.0 + difference.now.0),
                    0.5 * (sum.now.1 + difference.now.1),
                    rise.now.1,
                ) * speed,
                course_rad: self.course_rad,
                climb_rad: self.climb_rad,
                bank_rad: 0.0,
                straight: false,
            });
        }
    }

    /// A constant bank: a steady turn with the present climb angle.
    fn hold_bank(&mut self, span_s: f64, nodes: &mut Vec<FlightNode>) {
        let span_s = span_s.min(self.horizon_s - self.time_s);
        let steps = libm::ceil(span_s / self.response_step_s()).max(1.0);
        let step_s = span_s / steps;
        let held = self.bank_rad;
        let mut k = 0.0;
        while k < steps {
            self.runge_kutta(held, 0.0, step_s);
            self.bank_rad = held;
            nodes.push(self.node());
            k += 1.0;
        }
    }

    /// A piece with a first-order bank response; returns its duration, which is
    /// `span_s` unless the roll-out ends earlier.
    fn respond(
        &mut self,
        turn: f64,
        climb_rate: f64,
        span_s: f64,
        nodes: &mut Vec<FlightNode>,
    ) -> f64 {
        let target = turn * self.vehicle.bank_max_rad;
        if turn == 0.0 && self.bank_rad.abs() <= LEVEL_BANK_RAD {
            // The rest of the roll-out still turns by k·φ·τ.
            self.course_rad += self.course_rate(self.bank_rad) * self.time_constant_s();
            self.bank_rad = 0.0;
            if climb_rate == 0.0 {
                self.line(span_s, nodes);
                return span_s;
            }
        }
        let steps = libm::ceil(span_s / self.response_step_s()).max(1.0);
        let step_s = span_s / steps;
        let mut flown_s = 0.0;
        let mut k = 0.0;
        while k < steps {
            self.runge_kutta(target, climb_rate, step_s);
            nodes.push(self.node());
            k += 1.0;
            flown_s = step_s * k;
            if turn == 0.0 && climb_rate == 0.0 && self.bank_rad.abs() <= LEVEL_BANK_RAD {
                break;
            }
        }
        if k >= steps { span_s } else { flown_s }
    }

    fn time_constant_s(&self) -> f64 {
        self.vehicle.bank_time_constant_s.max(LEAST_TIME_CONSTANT_S)
    }

    fn response_step_s(&self) -> f64 {
        RESPONSE_STEP_S.min(RESPONSE_STEP_SHARE * self.time_constant_s())
    }

    /// ψ' at a bank angle (Eq. 9 with the turn-rate factor).
    fn course_rate(&self, bank: f64) -> f64 {
        self.vehicle.turn_rate_factor * STANDARD_GRAVITY_MPS2 * libm::tan(bank)
            / self.vehicle.airspeed_mps
    }

    /// One fourth-order step of x, y, z and ψ; the bank and the climb angle are exact.
    fn runge_kutta(&mut self, bank_target: f64, climb_rate: f64, step_s: f64) {
        let lag = self.time_constant_s();
        let bank = self.bank_rad;
        let bank_at = |t: f64| bank_target + (bank - bank_target) * libm::exp(-t / lag);
        let speed = self.vehicle.airspeed_mps;
        let (course, climb) = (self.course_rad, self.climb_rad);
        let velocity = |course: f64, t: f64| {
            let (sin_course, cos_course) = libm::sincos(course);
            let (sin_climb, cos_climb) = libm::sincos(climb + climb_rate * t);
            Vec3::new(cos_climb * cos_course, cos_climb * sin_course, sin_climb) * speed
        };
        let half = 0.5 * step_s;
        let middle_bank = bank_at(half);
        let end_bank = bank_at(step_s);
        let (r0, r1, r2) = (
            self.course_rate(bank),
            self.course_rate(middle_bank),
            self.course_rate(end_bank),
        );
        let v0 = velocity(course, 0.0);
        let v1 = velocity(course + half * r0, half);
        let v2 = velocity(course + half * r1, half);
        let v3 = velocity(course + step_s * r1, step_s);
        self.position_m += (v0 + (v1 + v2) * 2.0 + v3) * (step_s / 6.0);
        self.course_rad += (r0 + 4.0 * r1 + r2) * (step_s / 6.0);
        self.climb_rad += climb_rate * step_s;
        self.bank_rad = end_bank;
        self.time_s += step_s;
    }
}

/// A unit vector that turns by the same angle each step.
struct Spin {
    now: (f64, f64),
    half: (f64, f64),
    mean_scale: f64,
}

impl Spin {
    fn new(angle: f64, step: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        let (half_sin, half_cos) = libm::sincos(0.5 * step);
        Self {
            now: (cos, sin),
            half: (half_cos, half_sin),
            // sin x / x, by its series where the quotient would lose digits.
            mean_scale: if step.abs() < 1e-4 {
                1.0 - step * step / 24.0
            } else {
                2.0 * half_sin / step
            },
        }
    }

    /// Takes one step; returns the mean vector over it.
    fn advance(&mut self) -> (f64, f64) {
        let middle = rotate(self.now, self.half);
        self.now = rotate(middle, self.half);
        (middle.0 * self.mean_scale, middle.1 * self.mean_scale)
    }
}

fn rotate(a: (f64, f64), by: (f64, f64)) -> (f64, f64) {
    (a.0 * by.0 - a.1 * by.1, a.0 * by.1 + a.1 * by.0)
}
