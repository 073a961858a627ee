//! The flight for other programs: `flight.json`, which `fga export` reads.

use std::path::Path;

use fga_formats::OutputError;
use fga_formats::flight::{
    Flight, FlightEvent, FlightFutures, FlightObstacle, FlightSample, FlightWay, FlightZone,
    ObstacleSample,
};
use fga_formats::geodesy::{Earth, LocalFrame};
use fga_sim::run::{FutureWay, RunLog};
use fga_sim::track::Track;
use fga_sim::zone::WorldZone;
use serde_json::Value;

/// The file's name within the folder of a run.
pub const NAME: &str = "flight.json";

/// Duration of an obstacle with a single sample, seconds.
const MOMENT_S: f64 = 0.1;

/// Writes the flight into `folder`.
///
/// # Errors
/// A folder that cannot be written.
pub fn write(folder: &Path, log: &RunLog, events: &[(f64, Value)]) -> Result<(), OutputError> {
    flight(log, events).write(&folder.join(NAME))
}

/// The flight with its events.
pub fn flight(log: &RunLog, events: &[(f64, Value)]) -> Flight {
    let ground = log.plan.world.ground.as_deref();
    let mut samples: Vec<FlightSample> = Vec::with_capacity(log.samples.len());
    for sample in &log.samples {
        // The last moment may be logged twice.
        if samples
            .last()
            .is_some_and(|last| last.time_s >= sample.time_s)
        {
            continue;
        }
        samples.push(FlightSample {
            time_s: sample.time_s,
            position_m: sample.position_m,
            course_rad: sample.course_rad,
            climb_rad: sample.climb_rad,
            bank_rad: sample.bank_rad,
            state: sample.state.name().into(),
            ground_m: ground.and_then(|ground| ground.height_m(sample.position_m.truncate())),
        });
    }
    let obstacles = log
        .plan
        .world
        .obstacles
        .iter()
        .zip(&log.obstacles)
        .map(|(obstacle, flown)| FlightObstacle {
            name: flown.name.clone(),
            volume: obstacle.volume,
            track: rows(&obstacle.track, log.outcome.end_s),
        })
        .collect();
    Flight {
        name: log.plan.name.clone(),
        policy: log.policy.clone(),
        origin: log.plan.frame.as_ref().map(LocalFrame::origin),
        earth: log
            .plan
            .frame
            .as_ref()
            .map_or(Earth::Wgs84, LocalFrame::earth),
        start_unix_s: None,
        samples,
        mission: log.plan.world.mission_m.clone(),
        obstacles,
        zones: log.plan.world.zones.iter().map(zone).collect(),
        events: events
            .iter()
            .map(|(time_s, event)| FlightEvent {
                time_s: *time_s,
                kind: word(event, "reason")
                    .or(word(event, "event"))
                    .unwrap_or_default(),
                text: word(event, "text").unwrap_or_default(),
                detail: event.clone(),
            })
            .collect(),
        futures: (log.decisions.iter())
            .flat_map(|moment| {
                let name = |id| log.name_of(id).to_owned();
                (moment.futures.iter()).map(move |one| FlightFutures {
                    time_s: moment.time_s,
                    obstacle: name(one.obstacle),
                    ways: one.ways.iter().map(way).collect(),
                })
            })
            .collect(),
    }
}

pub(crate) fn zone(zone: &WorldZone) -> FlightZone {
    let (floor_m, ceiling_m) = zone.heights_m();
    let limit_m = |height_m: f64| height_m.is_finite().then_some(height_m);
    FlightZone {
        name: zone.name().to_owned(),
        keep_in: zone.keep_in(),
        ring_m: zone.ring_m().iter().map(fga::Vec2::to_array).collect(),
        floor_m: limit_m(floor_m),
        ceiling_m: limit_m(ceiling_m),
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "far within two million kilometres"
)]
fn way(way: &FutureWay) -> FlightWay {
    let whole = |point_m: &fga::Vec3| point_m.to_array().map(|along_m| along_m.round() as i32);
    FlightWay {
        weight: way.weight,
        points_m: way.points_m.iter().map(whole).collect(),
    }
}

fn word(event: &Value, key: &str) -> Option<String> {
    event.get(key)?.as_str().map(str::to_owned)
}

/// The track during the flight; one row for an obstacle at rest.
fn rows(track: &Track, end_s: f64) -> Vec<ObstacleSample> {
    let row = |time_s, position_m| ObstacleSample { time_s, position_m };
    match track {
        Track::Straight {
            position_m,
            velocity_mps,
        } => {
            let mut rows = vec![row(0.0, *position_m)];
            if *velocity_mps != fga::Vec3::ZERO && end_s > 0.0 {
                rows.push(row(end_s, *position_m + *velocity_mps * end_s));
            }
            rows
        }
        Track::Points { points, .. } => {
            let mut rows: Vec<_> = points.iter().map(|p| row(p.time_s, p.position_m)).collect();
            if let [only] = rows[..] {
                rows.push(row(only.time_s + MOMENT_S, only.position_m));
            }
            rows
        }
    }
}
