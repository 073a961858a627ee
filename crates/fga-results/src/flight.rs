//! The summary of a flight, and its `run.json`.

use std::path::Path;

use fga::situation::ProtectedVolume;
use fga_campaign::campaign::metrics::{Access, FIELDS, Metrics};
use fga_campaign::campaign::{FlownPath, metrics_of};
use fga_formats::OutputError;
use fga_sim::engine::Observer as _;
use fga_sim::run::RunLog;
use serde_json::{Value, json};

use crate::flight_files;
use crate::provenance::Provenance;

/// `run.json`: the origin of the results, and the summary.
pub fn document(
    provenance: &Provenance,
    (input, input_sha256): (&Path, &str),
    log: &RunLog,
    overlaid: &[RunLog],
) -> Value {
    let mut configuration = json!({
        "policy": log.policy,
        "vehicle_sha256": log.plan.model.sha256,
        "seed": log.plan.world.seed,
        "input_sha256": input_sha256,
    });
    if !overlaid.is_empty() {
        configuration["overlay"] = overlaid.iter().map(|log| log.policy.as_str()).collect();
    }
    let mut more = summary(log);
    if let Some(more) = more.as_object_mut() {
        more.insert("input".into(), json!(input.display().to_string()));
        more.insert("seed".into(), json!(log.plan.world.seed));
        more.insert("vehicle".into(), json!(log.plan.model.name));
    }
    provenance.to_json("run", &configuration, more)
}

/// A finite number, or null.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// The summary as JSON; the keys match the columns of the files.
pub fn summary(log: &RunLog) -> Value {
    let outcome = &log.outcome;
    let times = log.decision_times();
    let obstacles: Vec<Value> = log
        .obstacles
        .iter()
        .map(|obstacle| {
            let half_height_m = match obstacle.volume {
                ProtectedVolume::Sphere { .. } => None,
                ProtectedVolume::Cylinder { half_height_m, .. } => Some(half_height_m),
            };
            json!({
                "obstacle": obstacle.id,
                "name": obstacle.name,
                "separated": obstacle.margin.value_m >= 0.0,
                "min_separation_m": finite(obstacle.separation.value_m),
                "min_separation_t_s": finite(obstacle.separation.value_m).map(|_| obstacle.separation.time_s),
                "min_margin_m": finite(obstacle.margin.value_m),
                "min_margin_t_s": finite(obstacle.margin.value_m).map(|_| obstacle.margin.time_s),
                "radius_m": obstacle.volume.radius_m(),
                "half_height_m": half_height_m,
                "first_seen_s": obstacle.first_seen_s,
            })
        })
        .collect();
    let conflicts: Vec<Value> = log
        .conflicts()
        .iter()
        .map(|conflict| {
            json!({
                "threat_s": conflict.threat_s,
                "start_s": conflict.start_s,
                "clear_s": conflict.clear_s,
                "rejoined_s": conflict.rejoined_s,
                "obstacles": conflict.obstacles,
            })
        })
        .collect();
    let zones: Vec<Value> = (log.zones.iter())
        .map(|zone| {
            json!({
                "name": zone.name,
                "kind": if zone.keep_in { "keep-in" } else { "keep-out" },
                "kept": zone.margin.value_m >= 0.0,
                "min_margin_m": finite(zone.margin.value_m),
                "min_margin_t_s": zone.margin.time_s,
            })
        })
        .collect();
    let [floor_broken, ceiling_broken] = log.limits_broken();
    let mut summary = json!({
        "name": log.plan.name,
        "policy": log.policy,
        "separated": outcome.separated(),
        "min_separation_m": finite(outcome.min_separation_m),
        "min_margin_m": finite(outcome.min_margin_m),
        "threat_s": outcome.threat_s,
        "start_s": outcome.start_s,
        "clear_s": outcome.clear_s,
        "rejoined_s": outcome.rejoined_s,
        "conflicts": conflicts,
        "max_cross_track_m": outcome.max_cross_track_m,
        "extra_path_m": outcome.extra_path_m,
        "mission_flown": outcome.mission_flown,
        "waypoints_missed": outcome.waypoints_missed,
        "floor_broken": floor_broken,
        "ceiling_broken": ceiling_broken,
        "end_s": outcome.end_s,
        "decisions": log.decisions.len(),
        "decision_median_us": times.median_us,
        "decision_p99_us": times.p99_us,
        "decision_max_us": times.max_us,
        "obstacles": obstacles,
        "zones": zones,
    });
    let mut path = FlownPath::default();
    log.samples.iter().for_each(|sample| path.sample(sample));
    if let Some(metrics) = metrics_of(&log.plan.world, &path, outcome) {
        summary["standards"] = standards(&metrics);
    }
    if let Some(ground) = log.ground {
        summary["min_terrain_clearance_m"] = finite(ground.least.value_m).into();
        summary["min_terrain_clearance_t_s"] = ground.least.time_s.into();
    }
    let zones_m = log.zones.iter().map(|zone| zone.margin.value_m);
    if let Some(least_m) = zones_m.reduce(f64::min) {
        summary["min_zone_margin_m"] = finite(least_m).into();
    }
    if let Some(failure) = log.failure {
        summary["policy_failure"] = failure.name().into();
    }
    summary
}

/// What the standards count, by the names of the columns of `results.parquet`.
pub fn standards(metrics: &Metrics) -> Value {
    let named = FIELDS.iter().filter_map(|field| {
        let value = match field.access {
            Access::Real(get, _) => json!(get(metrics)),
            Access::Flag(get, _) => json!(get(metrics)),
            Access::Failure(..) => return None,
        };
        Some((field.name.to_owned(), value))
    });
    Value::Object(named.collect())
}

/// Writes the files of `fga run` for a flight of `input`, whose fingerprint is `input_sha256`, with further
/// flights of the same encounter in the replay page.
///
/// # Errors
/// A folder that cannot be written.
pub fn write(
    folder: &Path,
    (input, input_sha256): (&Path, &str),
    log: &RunLog,
    overlaid: &[RunLog],
) -> Result<(), OutputError> {
    fga_formats::atomic::prepare_folder(folder)?;
    let document = document(&Provenance::begin(), (input, input_sha256), log, overlaid);
    flight_files::write(folder, log, overlaid, &document)
}
