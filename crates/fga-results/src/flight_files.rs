//! The files of one flight: `track.csv`, `events.jsonl`, `overview.svg`, `replay.html`, `run.json`.

use std::path::Path;

use fga::avoider::State;
use fga_campaign::batch::push_sample;
use fga_formats::OutputError;
use fga_formats::atomic;
use fga_formats::decision;
use fga_formats::words::decision_words;
use fga_report::overview::{self, ClosestApproach, MomentKind, Overview, OverviewMoment};
use fga_report::profile::{Profile, ProfilePoint};
use fga_sim::run::{DecisionLog, RunLog};
use fga_sim::track::Track;
use serde_json::{Value, json};

use crate::flight_file;
use crate::replay_page::{self, missed_words};

/// Writes the files of a flight into `folder`. The replay page also holds `overlaid`, the same
/// encounter under other policies.
///
/// # Errors
/// A folder that cannot be written.
pub fn write(
    folder: &Path,
    log: &RunLog,
    overlaid: &[RunLog],
    document: &Value,
) -> Result<(), OutputError> {
    write_guided(folder, log, overlaid, document, None)
}

/// The same; the replay page also shows alerts and bands, where settings for them are given.
///
/// # Errors
/// A folder that cannot be written.
pub fn write_guided(
    folder: &Path,
    log: &RunLog,
    overlaid: &[RunLog],
    document: &Value,
    guidance: Option<&fga_alerts::AlertSettings>,
) -> Result<(), OutputError> {
    atomic::write(&folder.join("track.csv"), track_csv(log))?;
    let events = events(log);
    atomic::write(&folder.join("events.jsonl"), events_jsonl(&events))?;
    flight_file::write(folder, log, &events)?;
    atomic::write(&folder.join("overview.svg"), overview(log).to_svg())?;
    if let Some(profile) = profile(log) {
        atomic::write(&folder.join("profile.svg"), profile.to_svg())?;
    }
    atomic::write(
        &folder.join("replay.html"),
        replay_page::guided_page(core::iter::once(log).chain(overlaid), guidance),
    )?;
    atomic::write(&folder.join("run.json"), format!("{document:#}\n"))
}

/// The flown path over the ground, where that is known.
fn profile(log: &RunLog) -> Option<Profile> {
    let ground = log.plan.world.ground.as_ref()?;
    let origin_m = (log.plan.frame.as_ref()).map_or(0.0, |frame| frame.origin().altitude_m);
    let (mut along_m, mut before_m) = (0.0, log.samples.first()?.position_m);
    let mut lowest: Option<(f64, [f64; 2])> = None;
    let mut points = Vec::new();
    for sample in &log.samples {
        let at_m = sample.position_m;
        along_m += at_m.truncate().distance(before_m.truncate());
        before_m = at_m;
        let ground_m = ground.height_m(at_m.truncate());
        let above_m = ground_m.map_or(f64::INFINITY, |ground_m| at_m.z - ground_m);
        if lowest.is_none_or(|(least_m, _)| above_m < least_m) {
            lowest = Some((above_m, [along_m, at_m.z + origin_m]));
        }
        points.push(ProfilePoint {
            along_m,
            path_m: at_m.z + origin_m,
            ground_m: ground_m.map(|ground_m| ground_m + origin_m),
        });
    }
    let required_m = ground.clearance_m() + ground.error_m();
    let least = log.ground?.least;
    let is_clear =
        least.value_m >= required_m && points.iter().all(|point| point.ground_m.is_some());
    Some(Profile {
        title: format!("{} ({}) over the ground", log.plan.name, log.policy),
        verdict: format!(
            "Lowest {:.1} m above the ground, at {:.1} s.",
            least.value_m, least.time_s
        ),
        is_clear,
        path: "flight",
        datum: "mean sea level".into(),
        points,
        waypoints_m: Vec::new(),
        required_m,
        lowest_m: lowest.map(|(_, at_m)| at_m),
    })
}

/// `track.csv`: the flown path, a row for each sample.
pub fn track_csv(log: &RunLog) -> Vec<u8> {
    let mut text = b"t_s,x_m,y_m,z_m,course_rad,climb_rad,bank_rad,state\n".to_vec();
    for sample in &log.samples {
        push_sample(&mut text, sample);
        text.push(b',');
        text.extend_from_slice(sample.state.name().as_bytes());
        text.push(b'\n');
    }
    text
}

/// Decisions with news, and the closest approaches, in time order.
pub fn events(log: &RunLog) -> Vec<(f64, Value)> {
    let mut events: Vec<(f64, Value)> = log
        .decisions
        .iter()
        .filter(|decision| decision.changed)
        .map(|decision| (decision.time_s, decision_event(log, decision)))
        .collect();
    for obstacle in &log.obstacles {
        if obstacle.separation.value_m.is_finite() {
            let time_s = obstacle.margin.time_s;
            events.push((
                time_s,
                json!({
                    "t_s": time_s,
                    "event": "closest-approach",
                    "obstacle": obstacle.id,
                    "name": obstacle.name,
                    "min_separation_m": obstacle.separation.value_m,
                    "min_margin_m": obstacle.margin.value_m,
                    "text": format!(
                        "closest to {}: {:.1} m between the centres, {:.1} m {} its protected volume",
                        obstacle.name,
                        obstacle.separation.value_m,
                        obstacle.margin.value_m.abs(),
                        if obstacle.margin.value_m < 0.0 { "inside" } else { "outside" }
                    ),
                }),
            ));
        }
    }
    for missed in &log.missed {
        events.push((
            missed.time_s,
            json!({
                "t_s": missed.time_s,
                "event": "waypoint-missed",
                "waypoint": missed.index + 1,
                "distance_m": missed.distance_m,
                "text": missed_words(missed),
            }),
        ));
    }
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    events
}

/// The events, one JSON object a line.
pub fn events_jsonl(events: &[(f64, Value)]) -> String {
    let mut text = String::new();
    for (_, event) in events {
        text.push_str(&event.to_string());
        text.push('\n');
    }
    text
}

/// One decision with its whole record, in words and numbers.
fn decision_event(log: &RunLog, moment: &DecisionLog) -> Value {
    let name_of = |id: u32| log.name_of(id).to_string();
    let mut event = decision::to_json(&moment.decision, &moment.ownship, name_of);
    let words = decision_words(&moment.decision, &moment.ownship, name_of);
    event.insert("t_s".into(), moment.time_s.into());
    event.insert("event".into(), "decision".into());
    event.insert("text".into(), words.into());
    Value::Object(event)
}

/// The critical moments, as the avoider's state shows them.
fn moments(log: &RunLog) -> Vec<OverviewMoment> {
    let mut moments = Vec::new();
    let mut before = State::Cruise;
    for entry in &log.decisions {
        let now = entry.decision.state;
        let away = before.is_away();
        let on_route = !now.is_away();
        let kinds = [
            (away && on_route, MomentKind::Rejoined),
            (
                before != now && now == State::Threatened,
                MomentKind::ThreatSeen,
            ),
            (
                before != now && now == State::Avoiding,
                MomentKind::ManeuverBegun,
            ),
        ];
        let met = kinds
            .into_iter()
            .filter_map(|(met, kind)| met.then_some(kind));
        moments.extend(met.map(|kind| OverviewMoment {
            time_s: entry.time_s,
            kind,
            obstacle: entry.decision.record.threat.map(|threat| threat.id),
        }));
        before = now;
    }
    moments
}

/// The data of the picture.
pub fn overview(log: &RunLog) -> Overview {
    let end_s = log.outcome.end_s;
    let obstacles = log
        .plan
        .world
        .obstacles
        .iter()
        .zip(&log.obstacles)
        .map(|(obstacle, flown)| overview::OverviewObstacle {
            id: obstacle.id,
            name: flown.name.clone(),
            volume: obstacle.volume,
            track: track_points(&obstacle.track, end_s),
            closest: flown
                .separation
                .value_m
                .is_finite()
                .then_some(ClosestApproach {
                    time_s: flown.margin.time_s,
                    separation_m: flown.separation.value_m,
                    margin_m: flown.margin.value_m,
                }),
        })
        .collect();
    Overview {
        title: format!("{} ({})", log.plan.name, log.policy),
        mission_m: log.plan.world.mission_m.clone(),
        samples: log
            .samples
            .iter()
            .map(|sample| overview::PathSample {
                time_s: sample.time_s,
                position_m: sample.position_m,
                state: sample.state,
            })
            .collect(),
        obstacles,
        zones: replay_page::planned_zones(&log.plan),
        moments: moments(log),
    }
}

fn track_points(track: &Track, end_s: f64) -> Vec<overview::OverviewPoint> {
    let point = |time_s, position_m| overview::OverviewPoint { time_s, position_m };
    match track {
        Track::Straight {
            position_m,
            velocity_mps,
        } if *velocity_mps == fga::Vec3::ZERO => vec![point(0.0, *position_m)],
        Track::Straight {
            position_m,
            velocity_mps,
        } => vec![
            point(0.0, *position_m),
            point(end_s, *position_m + *velocity_mps * end_s),
        ],
        Track::Points { points, .. } => points
            .iter()
            .map(|p| point(p.time_s, p.position_m))
            .collect(),
    }
}
