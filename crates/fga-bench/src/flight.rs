//! An encounter flown with ideal rates, observed cycle by cycle.

use fga::Vec3;
use fga::avoider::{Decision, Settings, State};
use fga::pilot::Pilot;
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::{Mission, Obstacles, Situation};
use fga::situation::{Obstacle, Ownship};
use fga::vehicle::{Response, Vehicle};

use crate::ownship;

/// Time from one step to the next, seconds.
const PERIOD_S: f64 = 0.1;

/// Longest flight, steps.
const MOST_CYCLES: usize = 600;

/// The aircraft of Table 4.
pub fn vehicle() -> Vehicle {
    let climb_rad = 15.0_f64.to_radians();
    Vehicle {
        airspeed_mps: 15.0,
        turn_radius_m: 30.0,
        climb_min_rad: -climb_rad,
        climb_max_rad: climb_rad,
        climb_rate_radps: 0.2,
        response: Response::default(),
    }
}

/// Settings that track every obstacle, however far.
pub fn settings() -> Settings {
    Settings {
        surveillance_radius_m: f64::INFINITY,
        ..Settings::default()
    }
}

/// A step to measure.
pub struct Cycle<'a> {
    /// The pilot before the step.
    pub pilot: &'a mut dyn Pilot,
    /// The situation.
    pub situation: Situation<'a>,
}

/// Flies one encounter until the aircraft is back on its line and every obstacle has passed.
///
/// `look` makes the step and returns the decision, which the aircraft then flies.
pub fn fly(
    obstacles: &[Obstacle],
    pilot: &mut dyn Pilot,
    mut look: impl FnMut(Cycle<'_>) -> Decision,
) {
    let vehicle = vehicle();
    pilot.restart();
    let flyer = Flyer::new(&vehicle);
    let waypoints = [Vec3::ZERO, Vec3::X * 1e5];
    let mut path = FlightPath::new();
    let mut own = MotionState::of(&ownship());
    let mut rows = obstacles.to_vec();
    let mut time_s = 0.0;
    for _ in 0..MOST_CYCLES {
        for (row, start) in rows.iter_mut().zip(obstacles) {
            row.position_m = start.position_after_m(time_s);
        }
        let decision = look(Cycle {
            pilot: &mut *pilot,
            situation: Situation {
                time_s,
                ownship: Ownship {
                    position_m: own.position_m,
                    course_rad: own.course_rad,
                    climb_rad: own.climb_rad,
                    ..ownship()
                },
                obstacles: Obstacles::Rows(&rows),
                mission: Mission::new(&waypoints),
                wind_mps: Vec3::ZERO,
            },
        });
        own.time_s = 0.0;
        path.predict(&flyer, &own, &decision.command, 2.0 * PERIOD_S);
        let Some(next) = path.state_at(&flyer, PERIOD_S) else {
            return;
        };
        own = next;
        time_s += PERIOD_S;
        let cross_m = Vec3::new(0.0, own.position_m.y, own.position_m.z).length();
        let passed = rows.iter().all(|row| {
            let offset = own.position_m - row.position_m;
            offset.dot(flyer.velocity_mps(&own) - row.velocity_mps) >= 0.0
        });
        if decision.state == State::Cruise && cross_m < 0.5 && passed {
            return;
        }
    }
}
