//! The aircraft as it really flies: Eq. 10–12 within the vehicle's limits, in wind.
//!
//! A plant receives a [`Maneuver`] at each decision and flies it until the next. Course and climb
//! angle move to the commanded values at their rate limits. Without bank lag the path between two
//! decisions is a handful of exact [`Arc`]s, split at the start of a stage and at the end of a turn or
//! a change of climb. A straight arc goes on from decision to decision. Its places are computed from its beginning, and do not
//! depend on the decisions in between. Rolls of an aircraft with bank lag are exact in bank and integrated by Simpson's rule in
//! steps of at most 0.1 s; flight under the PI autopilot uses the classical Runge–Kutta rule in steps of at most 0.02 s. Left is positive throughout.

mod autopilot;
mod difference;
mod lagged;
mod pi_controller;

use alloc::collections::VecDeque;

use fga::Vec3;
use fga::maneuver::{Maneuver, Stage};
use fga::situation::Ownship;
use fga::vehicle::{STANDARD_GRAVITY_MPS2, Vehicle};

pub use autopilot::Autopilot;
pub use difference::{PlantDifference, at_airspeed};
pub use fga_judge::arc::Arc;

use pi_controller::PiController;

/// A rest of a turn or a change of climb that takes less than this is rounding, seconds.
const SHORTEST_S: f64 = 1e-12;

/// A change of the wind for some time, of which nobody knows beforehand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gust {
    /// Its begin, seconds since the start of the run.
    pub start_s: f64,
    /// Its duration, seconds.
    pub duration_s: f64,
    /// The velocity that it adds to the wind, metres per second.
    pub velocity_mps: Vec3,
}

/// The flown state and the pending commands.
#[derive(Debug, Clone)]
pub struct Plant {
    vehicle: Vehicle,
    autopilot: Autopilot,
    /// The wind now.
    wind_mps: Vec3,
    /// A gust, and the wind without it, metres per second.
    gust: Option<(Gust, Vec3)>,
    /// Time since the start of the run, seconds.
    time_s: f64,
    position_m: Vec3,
    course_rad: f64,
    climb_rad: f64,
    bank_rad: f64,
    /// The present manoeuvre; `None` holds course and climb angle.
    active: Option<Stage>,
    /// The straight arc that the aircraft flies and its velocity over the ground, metres per second; `None` while it flies none.
    straight: Option<(Arc, Vec3)>,
    /// Pending manoeuvres with their start times, in order (the dead time lies between).
    pending: VecDeque<(f64, Stage)>,
    /// Those of course and climb angle.
    controllers: [Option<PiController>; 2],
}

impl Plant {
    /// An aircraft in straight flight that holds its course.
    pub fn new(vehicle: Vehicle, autopilot: Autopilot, wind_mps: Vec3) -> Self {
        Self {
            vehicle,
            autopilot,
            wind_mps,
            gust: None,
            time_s: 0.0,
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            active: None,
            straight: None,
            pending: VecDeque::with_capacity(64),
            controllers: autopilot.controllers(&vehicle),
        }
    }

    /// Places the aircraft, wings level, without commands.
    pub fn place(&mut self, time_s: f64, position_m: Vec3, course_rad: f64, climb_rad: f64) {
        self.time_s = time_s;
        self.position_m = position_m;
        self.course_rad = course_rad;
        self.climb_rad = climb_rad;
        self.bank_rad = 0.0;
        self.active = None;
        self.straight = None;
        self.pending.clear();
        self.controllers = self.autopilot.controllers(&self.vehicle);
    }

    /// Replaces the vehicle, the autopilot and the wind; the state stays.
    pub fn refit(&mut self, vehicle: Vehicle, autopilot: Autopilot, wind_mps: Vec3) {
        self.vehicle = vehicle;
        self.autopilot = autopilot;
        self.wind_mps = wind_mps;
        self.gust = None;
        self.straight = None;
    }

    /// Meets a gust in the wind that it flies in now.
    pub fn meet(&mut self, gust: Gust) {
        self.gust = Some((gust, self.wind_mps));
    }

    /// Sets the wind of now; returns the time of its next change, at most `until_s`.
    fn blow(&mut self, until_s: f64) -> f64 {
        let Some((gust, steady_mps)) = self.gust else {
            return until_s;
        };
        let (from_s, to_s) = (gust.start_s, gust.start_s + gust.duration_s);
        let (gust_mps, changes_s) = if self.time_s < from_s {
            (Vec3::ZERO, from_s)
        } else if self.time_s < to_s {
            (gust.velocity_mps, to_s)
        } else {
            (Vec3::ZERO, until_s)
        };
        let wind_mps = steady_mps + gust_mps;
        if wind_mps != self.wind_mps {
            self.wind_mps = wind_mps;
            self.straight = None;
        }
        changes_s.min(until_s)
    }

    /// Changes the airspeed and keeps the largest bank angle (ρ ∝ V², Eq. 8).
    pub fn fly_at(&mut self, airspeed_mps: f64) {
        self.vehicle = at_airspeed(&self.vehicle, airspeed_mps);
        self.straight = None;
    }

    /// The vehicle's limits at the present airspeed.
    pub fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// The state for the avoider; course and climb angle through the air.
    pub fn ownship(&self) -> Ownship {
        Ownship {
            position_m: self.position_m,
            course_rad: self.course_rad,
            climb_rad: self.climb_rad,
            bank_rad: self.bank_rad,
            airspeed_mps: self.vehicle.airspeed_mps,
        }
    }

    /// Time since the start of the run, seconds.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Velocity of the air over the ground, metres per second.
    pub fn wind_mps(&self) -> Vec3 {
        self.wind_mps
    }

    /// Velocity over the ground, metres per second.
    pub fn ground_velocity_mps(&self) -> Vec3 {
        self.ownship().velocity_mps() + self.wind_mps
    }

    /// Takes a command that holds for `duration_s` seconds from now.
    pub fn command(&mut self, maneuver: &Maneuver, duration_s: f64) {
        let dead_time_s = self.vehicle.response.dead_time_s;
        let from_s = self.time_s + dead_time_s;
        // Before its first stage a manoeuvre holds course and climb angle.
        let first = maneuver.stage_at(0.0).copied().unwrap_or(Stage {
            start_s: 0.0,
            course_rad: self.course_rad,
            climb_rad: self.climb_rad,
            rate_share: 1.0,
        });
        if dead_time_s == 0.0 {
            self.pending.clear();
            self.active = Some(first);
        } else {
            self.pending.push_back((from_s, first));
        }
        for stage in maneuver.stages() {
            if stage.start_s > 0.0 && stage.start_s < duration_s {
                self.pending.push_back((from_s + stage.start_s, *stage));
            }
        }
    }

    /// Since when the aircraft flies straight, seconds since the start of the run.
    pub fn straight_since_s(&self) -> Option<f64> {
        self.straight.as_ref().map(|(arc, _)| arc.start_s)
    }

    /// Whether the aircraft flies straight, and goes on so under its last command. Never with a
    /// dead time, under which rounding grows: commands correct a flight that has changed meanwhile. Never where a gust may come.
    pub fn is_straight(&self) -> bool {
        self.autopilot == Autopilot::Direct
            && self.gust.is_none()
            && self.vehicle.response.dead_time_s == 0.0
            && self.bank_rad == 0.0
            && self.active.iter().all(|stage| self.keeps(stage))
    }

    /// As [`Self::is_straight`], and under the first command of a manoeuvre.
    pub fn is_straight_under(&self, maneuver: &Maneuver) -> bool {
        self.is_straight() && (maneuver.stage_at(0.0)).is_none_or(|stage| self.keeps(stage))
    }

    /// Whether a command keeps the course and the climb angle.
    fn keeps(&self, stage: &Stage) -> bool {
        let (low_rad, high_rad) = (self.vehicle.climb_min_rad, self.vehicle.climb_max_rad);
        stage.course_rad == self.course_rad
            && stage.climb_rad.max(low_rad).min(high_rad) == self.climb_rad
    }

    /// Flies for `duration_s` seconds; see [`Self::advance_until`].
    pub fn advance(&mut self, duration_s: f64, flown: impl FnMut(&Arc, Vec3)) {
        self.advance_until(self.time_s + duration_s, flown);
    }

    /// Flies until `end_s` and shows every flown arc and its end, in order. A straight arc that goes on is shown again, from
    /// its beginning to its new end.
    pub fn advance_until(&mut self, end_s: f64, mut flown: impl FnMut(&Arc, Vec3)) {
        let rolls = self.vehicle.response.bank_time_constant_s > 0.0;
        while self.time_s < end_s {
            while let Some(&(from_s, stage)) = self.pending.front()
                && from_s <= self.time_s + 1e-12
            {
                self.active = Some(stage);
                self.pending.pop_front();
            }
            let until_s = self
                .pending
                .front()
                .map_or(end_s, |&(from_s, _)| from_s.min(end_s));
            let until_s = self.blow(until_s);
            match (self.autopilot, rolls) {
                (Autopilot::Direct, false) => self.fly_exact(until_s, &mut flown),
                (Autopilot::Direct, true) => self.fly_rolling(until_s, &mut flown),
                (Autopilot::ProportionalIntegral { .. }, _) => {
                    self.fly_controlled(until_s, &mut flown);
                }
            }
        }
        self.time_s = end_s;
    }

    /// Commanded climb angle, within the vehicle's limits.
    fn climb_target_rad(&self) -> f64 {
        self.active.map_or(self.climb_rad, |stage| {
            stage
                .climb_rad
                .max(self.vehicle.climb_min_rad)
                .min(self.vehicle.climb_max_rad)
        })
    }

    /// Flies straight until `until_s`: on the present straight arc, else on a new one.
    fn fly_straight(&mut self, until_s: f64, flown: &mut impl FnMut(&Arc, Vec3)) {
        let (mut arc, velocity_mps) = self
            .straight
            .unwrap_or_else(|| (self.arc(0.0, 0.0, 0.0), self.ground_velocity_mps()));
        arc.duration_s = until_s - arc.start_s;
        self.position_m = arc.position_m + velocity_mps * arc.duration_s;
        self.time_s = until_s;
        self.straight = Some((arc, velocity_mps));
        flown(&arc, self.position_m);
    }

    /// Flies an arc; the time stays. The course and the climb angle have a rate, radians per second, and what they end on, radians,
    /// where they reach it.
    fn fly_arc(
        &mut self,
        duration_s: f64,
        (course_rate, course_end): (f64, Option<f64>),
        (climb_rate, climb_end): (f64, Option<f64>),
        flown: &mut impl FnMut(&Arc, Vec3),
    ) {
        let arc = self.arc(duration_s, course_rate, climb_rate);
        self.straight = None;
        self.position_m = arc.end_m();
        self.course_rad = course_end.unwrap_or(self.course_rad + course_rate * duration_s);
        self.climb_rad = climb_end.unwrap_or(self.climb_rad + climb_rate * duration_s);
        flown(&arc, self.position_m);
    }

    /// Flies exact arcs until `until_s`.
    fn fly_exact(&mut self, until_s: f64, flown: &mut impl FnMut(&Arc, Vec3)) {
        let climb_target = self.climb_target_rad();
        let (course_target, course_limit) = self.active.map_or((self.course_rad, 0.0), |stage| {
            (
                stage.course_rad,
                self.course_rate_limit_radps() * stage.rate_share,
            )
        });
        while self.time_s < until_s {
            let left_s = until_s - self.time_s;
            let (course_rate, turn_s) = rate_to(course_target, &mut self.course_rad, course_limit);
            let climb_limit = self.vehicle.climb_rate_radps;
            let (climb_rate, climb_s) = rate_to(climb_target, &mut self.climb_rad, climb_limit);
            if (course_rate, climb_rate) == (0.0, 0.0) {
                self.bank_rad = 0.0;
                self.fly_straight(until_s, flown);
                return;
            }
            let duration_s = left_s.min(turn_s).min(climb_s);
            let course_end = (duration_s == turn_s).then_some(course_target);
            let climb_end = (duration_s == climb_s).then_some(climb_target);
            let (course, climb) = ((course_rate, course_end), (climb_rate, climb_end));
            self.fly_arc(duration_s, course, climb, flown);
            self.bank_rad = self.bank_of(course_rate);
            self.time_s = if duration_s == left_s {
                until_s
            } else {
                self.time_s + duration_s
            };
        }
    }

    /// Largest course rate at the present airspeed, radians per second (Eq. 9).
    fn course_rate_limit_radps(&self) -> f64 {
        self.vehicle.response.turn_rate_factor * self.vehicle.airspeed_mps
            / self.vehicle.turn_radius_m
    }

    /// Bank angle of a course rate (Eq. 9), radians.
    fn bank_of(&self, course_rate_radps: f64) -> f64 {
        if course_rate_radps == 0.0 {
            return 0.0;
        }
        libm::atan(
            course_rate_radps * self.vehicle.airspeed_mps
                / (STANDARD_GRAVITY_MPS2 * self.vehicle.response.turn_rate_factor),
        )
    }
}

/// Rate that brings an angle to its target at a limit, and how long that takes, seconds: infinite when it is there or there is
/// no rate. A rest too short to fly is rounding, and taken at once.
fn rate_to(target_rad: f64, angle_rad: &mut f64, limit_radps: f64) -> (f64, f64) {
    let difference = target_rad - *angle_rad;
    if difference == 0.0 || limit_radps <= 0.0 {
        return (0.0, f64::INFINITY);
    }
    let needed_s = difference.abs() / limit_radps;
    if needed_s < SHORTEST_S {
        *angle_rad = target_rad;
        return (0.0, f64::INFINITY);
    }
    (limit_radps.copysign(difference), needed_s)
}
