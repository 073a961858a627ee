//! Drawn aircraft and manoeuvres, and their flights, integrated in steps of a millisecond by code of the tests.

use core::f64::consts::TAU;

use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::prediction::Flyer;
use fga_proof::vehicle::{Response, Vehicle};
use fga_proof::{Vec2, Vec3};

use super::random::Random;

/// Step of the integration, seconds.
pub(crate) const STEP_S: f64 = 1e-3;

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

    /// In half of the cases none, else level with up to half of an airspeed, metres per second.
    pub(crate) fn wind_mps(&mut self, airspeed_mps: f64) -> Vec3 {
        if self.chance(0.5) {
            return Vec3::ZERO;
        }
        let (sin, cos) = self.within(0.0, TAU).sin_cos();
        Vec3::new(cos, sin, 0.0) * self.within(0.0, 0.5) * airspeed_mps
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

/// A direction that turns step by step: its middle of each step, by a rotation where the turn stays the same.
struct Direction {
    angle: f64,
    turn: f64,
    turning: Vec2,
    middle: Vec2,
}

impl Direction {
    const ZERO: Self = Self {
        angle: 0.0,
        turn: f64::NAN,
        turning: Vec2::X,
        middle: Vec2::X,
    };

    /// Turns toward an angle by at most so much; cosine and sine in the middle.
    fn step(&mut self, toward: f64, most: f64) -> Vec2 {
        let turn = (toward - self.angle).clamp(-most, most);
        if turn == self.turn {
            self.middle = self.turning.rotate(self.middle);
        } else {
            self.turn = turn;
            self.turning = Vec2::from_angle(turn);
            self.middle = Vec2::from_angle(self.angle + 0.5 * turn);
        }
        self.angle += turn;
        self.middle
    }
}

/// The flight of an ideal aircraft, integrated by mid-points.
pub(crate) struct Flown<'a> {
    vehicle: &'a Vehicle,
    rates_radps: (f64, f64),
    maneuver: &'a Maneuver,
    wind: Vec3,
    pub(crate) at: Vec3,
    course: Direction,
    climb: Direction,
    stage: Option<Stage>,
    /// When the next stage begins.
    begins_s: f64,
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
            course: Direction::ZERO,
            climb: Direction::ZERO,
            stage: None,
            begins_s: 0.0,
            time_s: 0.0,
        }
    }

    pub(crate) fn step(&mut self) {
        let now_s = self.time_s + 1e-9;
        if self.begins_s <= now_s {
            let stages = self.maneuver.stages().iter();
            self.stage = stages
                .clone()
                .rfind(|stage| stage.start_s <= now_s)
                .copied();
            let later_s = stages
                .map(|stage| stage.start_s)
                .filter(|start_s| *start_s > now_s);
            self.begins_s = later_s.fold(f64::INFINITY, f64::min);
        }
        // A stage may begin within the step.
        let step_s = STEP_S.min(self.begins_s - self.time_s);
        let (course_rad, climb_rad, share) = self.stage.map_or((0.0, 0.0, 0.0), |stage| {
            (stage.course_rad, stage.climb_rad, stage.rate_share)
        });
        let (least, most) = (self.vehicle.climb_min_rad, self.vehicle.climb_max_rad);
        let (course_rate, climb_rate) = self.rates_radps;
        let along = self.course.step(course_rad, share * course_rate * step_s);
        let up = self
            .climb
            .step(climb_rad.clamp(least, most), climb_rate * step_s);
        let air = (up.x * along).extend(up.y) * self.vehicle.airspeed_mps;
        self.at += (air + self.wind) * step_s;
        self.time_s += step_s;
    }
}
