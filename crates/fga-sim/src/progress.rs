//! The line of a mission, along which [`MissionProgress`] follows the aircraft.
//!
//! The line is the path of the same mission without obstacles: the aircraft rounds and turns
//! corners as it plans them. A mission of one leg is that leg, and the mission of a recording is the
//! recorded track.

use fga::Vec3;
use fga::avoider::Reason;
use fga::meter::Meter;
use fga::pilot::Pilot as _;
use fga::prediction::{Flyer, MotionState, flown};
use fga::situation::{Mission, Obstacles, Ownship, Situation};
use fga_judge::progress::SPACING_M;
pub use fga_judge::progress::{MissedWaypoint, MissionProgress};

use crate::mission_pilot::MissionPilot;
use crate::world::World;

/// Most steps of a planned line.
const MOST_STEPS: u32 = 2_000_000;

/// Longest time of a planned line, as a multiple of the time along the legs.
const LONGEST_SHARE: f64 = 20.0;

/// The aircraft may rejoin the line at a point this far ahead, turn radii.
const AHEAD_RADII: f64 = 20.0;

/// An aircraft at the start of a world's mission.
pub fn progress_of(world: &World) -> MissionProgress {
    let (line_m, ahead_m) = line_of(world);
    // On a recorded track every row is a waypoint.
    let notes_visits = world.recorded.is_none() && world.mission_m.len() > 2;
    let start_m = world.start.position_m;
    MissionProgress::along(line_m, &world.mission_m, start_m, ahead_m, notes_visits)
}

/// The line of a world's mission, and how far ahead the aircraft may rejoin it, metres.
fn line_of(world: &World) -> (Vec<Vec3>, f64) {
    let mission_m = &world.mission_m;
    if mission_m.len() <= 2 || world.recorded.is_some() {
        return (mission_m.clone(), 0.0);
    }
    let start = &world.start;
    let ownship = Ownship {
        position_m: start.position_m,
        course_rad: start.course_rad,
        climb_rad: start.climb_rad,
        bank_rad: 0.0,
        airspeed_mps: world.vehicle.airspeed_mps,
    };
    let length_m: f64 = mission_m
        .windows(2)
        .map(|leg| leg[0].distance(leg[1]))
        .sum();
    let limit_s = LONGEST_SHARE * (length_m / world.vehicle.airspeed_mps + 60.0);
    let (line_m, whole) = planned_line(world, ownship, limit_s);
    if !whole || line_m.len() < 2 {
        return (mission_m.clone(), 0.0);
    }
    let rate = world.vehicle.course_rate_radps();
    let radius_m = world.vehicle.airspeed_mps / rate;
    (line_m, AHEAD_RADII * radius_m)
}

/// The mission flown without obstacles: every position, [`SPACING_M`] apart, and whether the aircraft passed the last
/// waypoint within a time.
fn planned_line(world: &World, start: Ownship, limit_s: f64) -> (Vec<Vec3>, bool) {
    let step_s = SPACING_M / world.vehicle.airspeed_mps;
    let (flyer, meter) = (Flyer::new(&world.vehicle), Meter::unlimited());
    let Ok(mut pilot) = MissionPilot::new(2.0 * step_s, world.vehicle) else {
        return (Vec::new(), false);
    };
    let mut situation = Situation {
        time_s: 0.0,
        ownship: start,
        obstacles: Obstacles::Rows(&[]),
        mission: Mission {
            passing: &world.passing,
            ..Mission::new(&world.mission_m)
        },
        wind_mps: world.wind_mps,
    };
    let mut line_m = vec![start.position_m];
    for step in 0..MOST_STEPS {
        situation.time_s = f64::from(step) * step_s;
        let decision = pilot.step(&situation);
        if decision.record.reason == Reason::MissionComplete {
            return (line_m, true);
        }
        if situation.time_s >= limit_s {
            break;
        }
        let own = &mut situation.ownship;
        let now = MotionState::of(own);
        let next = flown(&flyer, &now, decision.command.stages(), step_s, &meter);
        own.position_m = next.position_m + world.wind_mps * step_s;
        (own.course_rad, own.climb_rad, own.bank_rad) =
            (next.course_rad, next.climb_rad, next.bank_rad);
        line_m.push(own.position_m);
    }
    (line_m, false)
}

/// The path of a world's mission without obstacles.
pub fn mission_line_m(world: &World) -> Vec<Vec3> {
    line_of(world).0
}
