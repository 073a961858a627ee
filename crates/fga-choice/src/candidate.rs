//! The ways that there are: manoeuvres, and the paths that they lead to.

use fga_mission::{Progress, Route};
use fga_proof::maneuver::{Maneuver, Stage};
use fga_proof::meter::Meter;
use fga_proof::prediction::{FlightPath, Flyer, MotionState, flown};
use fga_proof::vehicle::Vehicle;

use crate::chance::{Path, SECONDS};

/// Courses off the mission's leg, degrees: both sides, and on.
pub(crate) const TURNS_DEG: [f64; 19] = [
    0.0, 15.0, -15.0, 30.0, -30.0, 45.0, -45.0, 60.0, -60.0, 75.0, -75.0, 90.0, -90.0, 120.0,
    -120.0, 150.0, -150.0, 180.0, -180.0,
];

/// Farthest above and below the mission, metres.
const MOST_ASIDE_M: f64 = 150.0;

/// Not below this height, metres, unless the mission is.
const LOWEST_M: f64 = 60.0;

/// A climb, level flight or a descent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Up {
    Level,
    Climb,
    Descent,
}

/// A way off the mission: a course and a climb, held until the others have passed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Way {
    /// Course off the leg's course through the air, radians.
    pub(crate) turn_rad: f64,
    /// Its climb.
    pub(crate) up: Up,
}

/// What all candidates of a step share.
pub(crate) struct Scene<'a> {
    pub(crate) route: &'a Route<'a>,
    pub(crate) flyer: &'a Flyer,
    pub(crate) vehicle: &'a Vehicle,
    pub(crate) progress: &'a Progress,
    pub(crate) now: MotionState,
    /// The leg's course through the air, as an unwrapped course of the aircraft, radians.
    pub(crate) leg_rad: f64,
    /// Altitude of the mission here, metres.
    pub(crate) altitude_m: f64,
}

impl Scene<'_> {
    /// The stages of a way from a moment on, for an aircraft at an altitude.
    pub(crate) fn push(&self, way: &Way, from_s: f64, altitude_m: f64, command: &mut Maneuver) {
        let vehicle = self.vehicle;
        let (floor_m, ceiling_m) = self.route.mission.limits_m;
        let highest_m = (self.altitude_m + MOST_ASIDE_M).min(ceiling_m);
        let lowest_m = LOWEST_M
            .min(self.altitude_m)
            .max(self.altitude_m - MOST_ASIDE_M)
            .max(floor_m);
        let (climb_rad, left_m) = match way.up {
            Up::Level => (0.0, 0.0),
            Up::Climb => (vehicle.climb_max_rad, highest_m - altitude_m),
            Up::Descent => (vehicle.climb_min_rad, altitude_m - lowest_m),
        };
        let course_rad = self.leg_rad + way.turn_rad;
        let climb_mps = vehicle.airspeed_mps * libm::sin(climb_rad.abs());
        let levels_s = left_m / climb_mps.max(0.1);
        let stage = |start_s, climb_rad| Stage {
            start_s,
            course_rad,
            climb_rad,
            rate_share: 1.0,
        };
        if levels_s > 0.5 {
            command.push(stage(from_s, climb_rad));
        }
        if levels_s < SECONDS as f64 {
            command.push(stage(from_s + levels_s.max(0.0), 0.0));
        }
    }

    /// A way now.
    pub(crate) fn off(&self, way: &Way) -> Maneuver {
        let mut command = Maneuver::hold();
        self.push(way, 0.0, self.now.position_m.z, &mut command);
        command
    }

    /// On with the mission, or back to it.
    pub(crate) fn mission(&self) -> Maneuver {
        let mut command = Maneuver::hold();
        let mut progress = *self.progress;
        progress.guidance(self.route, &self.now, SECONDS as f64, &mut command);
        command
    }

    /// On with the mission for some seconds, then a way.
    pub(crate) fn off_later(&self, mission: &Maneuver, way: &Way, after_s: f64) -> Maneuver {
        let mut command = Maneuver::hold();
        let before = mission
            .stages()
            .iter()
            .filter(|stage| stage.start_s < after_s);
        command.set(before.copied());
        self.push(way, after_s, self.now.position_m.z, &mut command);
        command
    }

    /// A way for some seconds more, then back.
    pub(crate) fn back_later(&self, way: &Way, after_s: f64) -> Maneuver {
        let held = self.off(way);
        let meter = Meter::unlimited();
        let mut then = flown(self.flyer, &self.now, held.stages(), after_s, &meter);
        // As of a decision at that moment: where the air carries it until then.
        then.position_m += self.route.wind_mps * then.time_s;
        then.time_s = 0.0;
        let mut back = Maneuver::hold();
        let mut progress = *self.progress;
        progress.guidance(self.route, &then, SECONDS as f64, &mut back);
        let mut command = Maneuver::hold();
        let held = held.stages().iter().filter(|stage| stage.start_s < after_s);
        let back = back.stages().iter().map(|stage| Stage {
            start_s: stage.start_s + after_s,
            ..*stage
        });
        command.set(held.copied().chain(back));
        command
    }

    /// The path of a manoeuvre.
    pub(crate) fn fly(&self, command: &Maneuver, flight: &mut FlightPath, path: &mut Path) {
        flight.predict(self.flyer, &self.now, command, SECONDS as f64);
        for (at, second) in path.iter_mut().zip(0_u8..) {
            let second = f64::from(second);
            let Some(state) = flight.state_at(self.flyer, second) else {
                continue;
            };
            let off = state.position_m - self.now.position_m + self.route.wind_mps * second;
            *at = [off.x as f32, off.y as f32, off.z as f32];
        }
    }
}
