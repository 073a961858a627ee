//! Intruders whose climb changes: they level off, go on through the altitude of the aircraft, or pull up.
//!
//! The experiment measures separations itself, on the drawn intruder and the flown samples. An encounter counts as avoidable where one
//! turn with one climb that begins with the change keeps clear: a search that learns then what the intruder will do. A needless
//! manoeuvre could not be left out where the intruder, had it levelled off at some moment, would have left nothing to that search.

use core::f64::consts::{PI, TAU};

use clap::Args;
use fga::Vec3;
use fga::maneuver::Maneuver;
use fga::vehicle::Vehicle;
use fga_campaign::campaign::parse_policy;
use fga_files::TomlText;
use fga_sim::plant::{Autopilot, Plant};
use fga_sim::policy::PolicyChoice;
use fga_sim::run::fly;
use fga_sim::scenario::parse;
use fga_sim::vehicle_file::VehicleModel;
use rayon::prelude::*;

use crate::common::PERIOD_S;
use crate::flown::{FOOT_M, Moments, NMAC, acted, measure, moments, transitions};
use crate::intruders::stream;
use crate::intruders::traffic::SplitMix64;

/// Feet per minute, metres per second.
const FPM_MPS: f64 = FOOT_M / 60.0;

/// The closest approach comes so long after the start, seconds.
const CLOSEST_S: f64 = 70.0;

/// Interval between the moments of a track, seconds.
const STEP_S: f64 = 0.5;

/// Interval between the moments of a search, seconds.
const FLOWN_S: f64 = 0.2;

/// Moments of a track after its first one.
const STEPS: u32 = 220;

const DURATION_S: f64 = STEPS as f64 * STEP_S;

/// Options of `climbs`.
#[derive(Args, Debug)]
pub(crate) struct ClimbsArgs {
    /// Number of encounters of each kind.
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    count: u64,
    /// Master seed.
    #[arg(default_value_t = 1)]
    seed: u64,
    /// Vehicle file.
    #[arg(long, default_value = "vehicles/general-aviation.toml")]
    vehicle: std::path::PathBuf,
    /// The policy, as in "published --start t0".
    #[arg(long, default_value = "turn-aware")]
    policy: String,
    /// Shows each encounter that is left.
    #[arg(long)]
    rows: bool,
}

/// What an intruder does with its climb.
#[derive(Debug, Clone, Copy)]
enum ClimbKind {
    /// It levels off up to 50 or 500 ft above or below, 2 to 25 s before the closest approach.
    LevelsOff(f64),
    /// It passes the altitude of the aircraft 25 s before to 25 s after the closest approach, and goes on.
    GoesOn(f64),
    /// It is level, pulls up or down 8 to 25 s before the closest approach, and reaches the altitude of the aircraft then.
    PullsUp,
}

const KINDS: [(&str, ClimbKind); 9] = [
    ("levels off, 500 ft/min", ClimbKind::LevelsOff(500.0)),
    ("levels off, 1,000 ft/min", ClimbKind::LevelsOff(1000.0)),
    ("levels off, 1,500 ft/min", ClimbKind::LevelsOff(1500.0)),
    ("levels off, 2,000 ft/min", ClimbKind::LevelsOff(2000.0)),
    ("goes on, 500 ft/min", ClimbKind::GoesOn(500.0)),
    ("goes on, 1,000 ft/min", ClimbKind::GoesOn(1000.0)),
    ("goes on, 1,500 ft/min", ClimbKind::GoesOn(1500.0)),
    ("goes on, 2,000 ft/min", ClimbKind::GoesOn(2000.0)),
    ("pulls up", ClimbKind::PullsUp),
];

/// The outcome of one flight.
struct ClimbFlight {
    nominal_m: f64,
    least_m: f64,
    acted: bool,
    cross_m: f64,
    changes: usize,
    is_avoidable: bool,
    /// Whether a needless manoeuvre could not be left out.
    is_due: bool,
    number: u64,
}

impl ClimbFlight {
    /// Whether it would have been lost on the mission.
    fn would_be_lost(&self) -> bool {
        self.nominal_m < 0.0
    }

    fn is_needless(&self) -> bool {
        self.acted && !self.would_be_lost()
    }
}

/// Flies all kinds and shows the counts.
pub(crate) fn run(args: &ClimbsArgs) -> Result<(), String> {
    let model = VehicleModel::read(&args.vehicle).map_err(|e| e.to_string())?;
    let policy = parse_policy(&args.policy)?;
    for (name, kind) in KINDS {
        let flown: Result<Vec<ClimbFlight>, String> = (0..args.count)
            .into_par_iter()
            .map(|number| fly_one(kind, (args.seed, number), &model, &policy))
            .collect();
        show(name, &flown?, args.rows);
    }
    Ok(())
}

fn show(name: &str, flown: &[ClimbFlight], rows: bool) {
    let is_lost = |f: &&ClimbFlight| f.least_m < 0.0;
    let would = |f: &&ClimbFlight| f.would_be_lost();
    let mut cross_m: Vec<f64> = flown.iter().map(|f| f.cross_m).collect();
    cross_m.sort_by(f64::total_cmp);
    println!(
        "{name}: NMAC {} of {}, induced {}, avoidable {} of {}; needless {} of {}, not to be left out {}; cross-track median {:.0} 90% {:.0} m; changes over 2: {}, most {}",
        flown.iter().filter(is_lost).count(),
        flown.iter().filter(would).count(),
        flown.iter().filter(|f| is_lost(f) && !would(f)).count(),
        flown
            .iter()
            .filter(|f| is_lost(f) && f.is_avoidable)
            .count(),
        flown.iter().filter(|f| would(f) && f.is_avoidable).count(),
        flown.iter().filter(|f| f.is_needless()).count(),
        flown.iter().filter(|f| !would(f)).count(),
        flown.iter().filter(|f| f.is_due).count(),
        cross_m[cross_m.len() / 2],
        cross_m[(cross_m.len() - 1) * 9 / 10],
        flown.iter().filter(|f| f.changes > 2).count(),
        flown.iter().map(|f| f.changes).max().unwrap_or(0),
    );
    for left in flown.iter().filter(is_lost).filter(|_| rows) {
        println!(
            "  {}: nominal {:.1} m, flown {:.1} m, avoidable: {}",
            left.number, left.nominal_m, left.least_m, left.is_avoidable
        );
    }
}

/// Whether one turn and one climb, begun on the mission at a time, seconds, keep clear of the intruder.
fn is_avoidable(vehicle: &Vehicle, intruder: &Moments, from_s: f64) -> bool {
    let climbs = [vehicle.climb_min_rad, 0.0, vehicle.climb_max_rad];
    let turns = (-24..=24).map(|k| f64::from(k) * PI / 24.0);
    let ways = turns.flat_map(|turn_rad| climbs.map(|climb_rad| (turn_rad, climb_rad)));
    ways.into_iter().any(|(turn_rad, climb_rad)| {
        let from_m = Vec3::X * vehicle.airspeed_mps * from_s;
        let mut plant = Plant::new(*vehicle, Autopilot::Direct, Vec3::ZERO);
        plant.place(from_s, from_m, 0.0, 0.0);
        plant.command(&Maneuver::turn(0.0, turn_rad, climb_rad), DURATION_S);
        let mut track: Moments = vec![(from_s, from_m)];
        while plant.time_s() < DURATION_S {
            plant.advance(FLOWN_S, |_, _| ());
            track.push((plant.time_s(), plant.ownship().position_m));
        }
        measure(&track, intruder, DURATION_S, 1.0)[0] >= 0.0
    })
}

/// Whether an intruder that climbs or descends on, had it levelled off at some moment, would have met the aircraft on its mission and
/// left nothing to a search that learns of it one decision later.
fn is_due(vehicle: &Vehicle, own: &Moments, intruder: &Moments) -> bool {
    intruder.iter().any(|&(from_s, from_m)| {
        let levels_off = |&(time_s, at_m): &(f64, Vec3)| {
            let height_m = if time_s < from_s { at_m.z } else { from_m.z };
            (time_s, at_m.with_z(height_m))
        };
        let level: Moments = intruder.iter().map(levels_off).collect();
        measure(own, &level, DURATION_S, 1.0)[0] < 0.0
            && !is_avoidable(vehicle, &level, from_s + PERIOD_S)
    })
}

/// The height of an intruder over that of the aircraft, metres, at a time, seconds, and the time of the change.
fn heights(kind: ClimbKind, random: &mut SplitMix64) -> (Box<dyn Fn(f64) -> f64>, f64) {
    let side = if random.unit() < 0.5 { -1.0 } else { 1.0 };
    match kind {
        ClimbKind::LevelsOff(fpm) => {
            let at_s = CLOSEST_S - random.within(2.0, 25.0);
            let most_ft = if random.unit() < 0.5 { 50.0 } else { 500.0 };
            let level_m = random.within(-1.0, 1.0) * most_ft * FOOT_M;
            let rate_mps = side * fpm * FPM_MPS;
            let height_m = move |time_s| level_m + rate_mps * f64::min(time_s - at_s, 0.0);
            (Box::new(height_m), at_s)
        }
        ClimbKind::GoesOn(fpm) => {
            let at_s = CLOSEST_S + random.within(-25.0, 25.0);
            let rate_mps = side * fpm * FPM_MPS;
            (Box::new(move |time_s| rate_mps * (time_s - at_s)), 0.0)
        }
        ClimbKind::PullsUp => {
            let at_s = CLOSEST_S - random.within(8.0, 25.0);
            let (rate_mps, pull_mps2) = (random.within(5.0, 10.0), random.within(0.5, 3.0));
            let climbed_m = move |time_s: f64| {
                let since_s = f64::max(time_s - at_s, 0.0);
                let pulls_s = f64::min(since_s, rate_mps / pull_mps2);
                0.5 * pull_mps2 * pulls_s * pulls_s + rate_mps * (since_s - pulls_s)
            };
            let height_m = move |time_s| side * (climbed_m(time_s) - climbed_m(CLOSEST_S));
            (Box::new(height_m), at_s)
        }
    }
}

fn fly_one(
    kind: ClimbKind,
    (seed, number): (u64, u64),
    model: &VehicleModel,
    policy: &PolicyChoice,
) -> Result<ClimbFlight, String> {
    let mut random = stream(seed, number);
    let own_mps = model.vehicle.airspeed_mps;
    let (radius_m, half_height_m) = NMAC;
    let course_rad = random.within(0.0, TAU);
    let speed_mps = random.within(40.0, 90.0);
    let velocity_mps = Vec3::new(course_rad.cos(), course_rad.sin(), 0.0) * speed_mps;
    let miss_m = random.within(-1.0, 1.0) * radius_m;
    let relative_mps = velocity_mps - Vec3::X * own_mps;
    let aside = Vec3::new(-relative_mps.y, relative_mps.x, 0.0).normalize_or(Vec3::Y);
    let meets_m = Vec3::X * own_mps * CLOSEST_S + aside * miss_m;
    let (height_m, change_s) = heights(kind, &mut random);
    let times = (0..=STEPS).map(|k| f64::from(k) * STEP_S);
    let intruder: Moments = times
        .clone()
        .map(|time_s| {
            let level_m = meets_m + velocity_mps * (time_s - CLOSEST_S);
            (time_s, level_m.with_z(height_m(time_s)))
        })
        .collect();
    let own: Moments = times
        .map(|time_s| (time_s, Vec3::X * own_mps * time_s))
        .collect();
    let track: Vec<String> = intruder
        .iter()
        .map(|(time_s, at_m)| format!("[{time_s:?}, {:?}, {:?}, {:?}]", at_m.x, at_m.y, at_m.z))
        .collect();
    let text = format!(
        "name = \"climbs\"\nduration_s = {DURATION_S:?}\n[mission]\nwaypoints_m = [[0, 0, 0], [20000, 0, 0]]\n[limits]\nfloor_m = -1000.0\n[[obstacle]]\nmovement = \"aircraft\"\nradius_m = {radius_m:?}\nhalf_height_m = {half_height_m:?}\ntrack_m = [{}]\n",
        track.join(", ")
    );
    let path = std::path::Path::new("drawn.toml");
    let text = TomlText::new(path, &text);
    let plan = parse(text, Some(model.clone())).map_err(|e| e.to_string())?;
    let log = fly(plan, policy, &mut |_| ()).map_err(|e| e.to_string())?;
    let track = moments(&log);
    let mut flight = ClimbFlight {
        nominal_m: measure(&own, &intruder, DURATION_S, 1.0)[0],
        least_m: measure(&track, &intruder, DURATION_S, 1.0)[0],
        acted: acted(&log),
        cross_m: log.outcome.max_cross_track_m,
        changes: transitions(&log),
        is_avoidable: is_avoidable(&model.vehicle, &intruder, change_s),
        is_due: false,
        number,
    };
    flight.is_due = matches!(kind, ClimbKind::GoesOn(_))
        && flight.is_needless()
        && is_due(&model.vehicle, &own, &intruder);
    Ok(flight)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Head-on at 2,000 ft/min: one that levels off at the altitude of the aircraft 4 s before leaves no time, 20 s before it does.
    #[test]
    fn a_manoeuvre_is_due_where_a_late_level_off_leaves_nothing() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../vehicles/general-aviation.toml"
        );
        let vehicle = VehicleModel::read(path.as_ref()).unwrap().vehicle;
        let is_due_where_it_passes = |before_s: f64| {
            let flies = |x_mps: f64, climb_mps: f64| -> Moments {
                let times = (0..=STEPS).map(|k| f64::from(k) * STEP_S);
                let place_m = |time_s: f64| {
                    let x_m = vehicle.airspeed_mps * CLOSEST_S + x_mps * (time_s - CLOSEST_S);
                    Vec3::new(x_m, 0.0, climb_mps * (time_s - CLOSEST_S + before_s))
                };
                times.map(|time_s| (time_s, place_m(time_s))).collect()
            };
            let own = flies(vehicle.airspeed_mps, 0.0);
            let intruder = flies(-70.0, 2000.0 * FPM_MPS);
            assert!(measure(&own, &intruder, DURATION_S, 1.0)[0] >= 0.0);
            is_due(&vehicle, &own, &intruder)
        };
        assert!(is_due_where_it_passes(4.5));
        assert!(!is_due_where_it_passes(20.0));
    }
}
