//! Drawn aircraft and manoeuvres, and their flights, integrated in steps of a millisecond by code of the tests.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts drawn from floats"
)]

use fga_proof::Vec3;
use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::prediction::Flyer;
use fga_proof::vehicle::{Response, Vehicle};

use super::random::Random;

/// Step of the integration, seconds.
const STEP_S: f64 = 1e-3;

/// Error of integration and rounding, metres.
pub(crate) const INTEGRATED_M: f64 = 1e-3;

impl Random {
    pub(crate) fn vehicle(&mut self) -> Vehicle {
        let climb = if self.chance(0.3) {
            0.0
        } else {
            self.within(0.05, 0.6)
        };
        Vehicle {
            airspeed_mps: self.within(8.0, 60.0),
            turn_radius_m: self.within(15.0, 300.0),
            climb_min_rad: -climb,
            climb_max_rad: climb,
            climb_rate_radps: self.within(0.02, 0.6),
            response: Response::default(),
        }
    }

    pub(crate) fn maneuver(&mut self) -> Maneuver {
        let mut maneuver = Maneuver::hold();
        let mut start_s = if self.chance(0.5) {
            0.0
        } else {
            self.within(0.0, 8.0)
        };
        let mut course = 0.0;
        for _ in 0..=(self.unit() * 3.0) as usize {
            course += self.within(-4.0, 4.0);
            assert!(maneuver.push(Stage {
                start_s,
                course_rad: course,
                climb_rad: self.within(-0.5, 0.5),
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

/// The flight of an ideal aircraft, integrated by mid-points.
pub(crate) struct Flown<'a> {
    vehicle: &'a Vehicle,
    rates_radps: (f64, f64),
    maneuver: &'a Maneuver,
    wind: Vec3,
    pub(crate) at: Vec3,
    course: f64,
    climb: f64,
    pub(crate) time_s: f64,
}

impl<'a> Flown<'a> {
    /// From the origin along x, in a wind.
    pub(crate) fn new(
        flyer: &Flyer,
        vehicle: &'a Vehicle,
        maneuver: &'a Maneuver,
        wind: Vec3,
    ) -> Self {
        Self {
            vehicle,
            rates_radps: (flyer.course_rate_radps(), flyer.climb_rate_radps()),
            maneuver,
            wind,
            at: Vec3::ZERO,
            course: 0.0,
            climb: 0.0,
            time_s: 0.0,
        }
    }

    pub(crate) fn step(&mut self) {
        let stage = self
            .maneuver
            .stages()
            .iter()
            .rfind(|stage| stage.start_s <= self.time_s + 1e-9);
        // A stage may begin within the step.
        let begins_s = (self.maneuver.stages().iter().map(|stage| stage.start_s))
            .filter(|start_s| *start_s > self.time_s + 1e-9)
            .fold(f64::INFINITY, f64::min);
        let step_s = STEP_S.min(begins_s - self.time_s);
        let toward = |from: f64, to: f64, most: f64| from + (to - from).clamp(-most, most);
        let (course, climb) = stage.map_or((self.course, self.climb), |stage| {
            let to_climb = stage
                .climb_rad
                .clamp(self.vehicle.climb_min_rad, self.vehicle.climb_max_rad);
            (
                toward(
                    self.course,
                    stage.course_rad,
                    stage.rate_share * self.rates_radps.0 * step_s,
                ),
                toward(self.climb, to_climb, self.rates_radps.1 * step_s),
            )
        });
        let (sin, cos) = (0.5 * (self.course + course)).sin_cos();
        let (up, level) = (0.5 * (self.climb + climb)).sin_cos();
        let air = Vec3::new(level * cos, level * sin, up) * self.vehicle.airspeed_mps;
        self.at += (air + self.wind) * step_s;
        (self.course, self.climb) = (course, climb);
        self.time_s += step_s;
    }
}
