//! Flies a folder of recordings of two aircraft and counts losses, needless manoeuvres and changes.
//!
//! The experiment itself measures separations, on the recorded intruder and the flown samples, only
//! while the intruder was recorded. NMAC: 500 ft and 100 ft at once. `LoWC`: 2,000 ft and 250 ft at
//! once (ASTM F3442). DO-365B: 2,200 ft and 450 ft at once, the well-clear volume for non-cooperative intruders.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use fga::Vec3;
use fga::avoider::State;
use fga::situation::ProtectedVolume;
use fga::vehicle::turn_radius_m;
use fga_campaign::campaign::parse_policy;
use fga_formats::daa;
use fga_sim::engine::Sample;
use fga_sim::policy::PolicyChoice;
use fga_sim::run::{Plan, RunLog, fly};
use fga_sim::vehicle_file::VehicleModel;
use rayon::prelude::*;

use crate::common::Reversals;

pub(crate) const FOOT_M: f64 = 0.3048;
pub(crate) const NMAC: (f64, f64) = (500.0 * FOOT_M, 100.0 * FOOT_M);
const WELL_CLEAR: (f64, f64) = (2000.0 * FOOT_M, 250.0 * FOOT_M);
const NON_COOPERATIVE: (f64, f64) = (2200.0 * FOOT_M, 450.0 * FOOT_M);

/// The measured volumes: radius and half height, metres.
const VOLUMES: [(&str, (f64, f64)); 3] = [
    ("NMAC", NMAC),
    ("LoWC", WELL_CLEAR),
    ("DO-365B", NON_COOPERATIVE),
];

pub(crate) type Moments = Vec<(f64, Vec3)>;

struct FlownRow {
    name: String,
    /// Least signed distances outside of the volumes, metres.
    nominal: [f64; VOLUMES.len()],
    flown: [f64; VOLUMES.len()],
    acted: bool,
    transitions: usize,
    reversals: u32,
    cross_m: f64,
    extra_m: f64,
    back: bool,
    on_way_back: Option<OnWayBack>,
    searched: u32,
    longest_us: f64,
}

/// Distances from the recorded path of the ownship, its mission, about the first way back, metres.
#[derive(Clone, Copy)]
#[expect(clippy::struct_field_names, reason = "all are in metres")]
struct OnWayBack {
    /// The largest before it begins.
    before_m: f64,
    /// The largest during it.
    during_m: f64,
    /// What the turn out of the flight away from the mission takes at the bank of the flight, in a straight mission.
    turning_m: f64,
}

/// The way back departs more than before it.
const FARTHER_M: f64 = 1.0;

/// It departs more than before it and its turn take, beyond the time to roll and bends of the mission.
const MUCH_FARTHER_M: f64 = 10.0;

/// Options of `flown`.
#[derive(Args, Debug)]
pub(crate) struct FlownArgs {
    /// Folder of `.daa` files.
    folder: PathBuf,
    /// Vehicle file.
    vehicle: PathBuf,
    /// Protected volume; without it that of the vehicle file.
    #[arg(long)]
    volume: Option<FlownVolume>,
    /// All volumes, the protected and the measured ones, times this.
    #[arg(long, default_value_t = 1.0, requires = "volume")]
    scale: f64,
    /// The policy, as in "published --start t0".
    #[arg(long, default_value = "turn-aware")]
    policy: String,
    /// Each file with the noise of this many seeds, from 0 on.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    seeds: u64,
    /// Half of the files, by their numbers.
    #[arg(long)]
    only: Option<Half>,
    /// Shows each flight.
    #[arg(long)]
    rows: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum FlownVolume {
    /// 500 ft and 100 ft.
    Nmac,
    /// 2,000 ft and 250 ft.
    Wellclear,
    /// 2,200 ft and 450 ft.
    Do365b,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Half {
    Odd,
    Even,
}

/// Flies the folder and shows the counts.
pub(crate) fn run(args: &FlownArgs) -> Result<(), String> {
    let mut model = VehicleModel::read(&args.vehicle).map_err(|e| e.to_string())?;
    if let Some(volume) = args.volume {
        let (radius_m, half_height_m) = match volume {
            FlownVolume::Nmac => NMAC,
            FlownVolume::Wellclear => WELL_CLEAR,
            FlownVolume::Do365b => NON_COOPERATIVE,
        };
        model.protection = ProtectedVolume::Cylinder {
            radius_m: radius_m * args.scale,
            half_height_m: half_height_m * args.scale,
        };
    }
    let policy = parse_policy(&args.policy)?;
    let folder = &args.folder;
    let mut files: Vec<(u32, PathBuf)> = std::fs::read_dir(folder)
        .map_err(|e| format!("{}: {e}", folder.display()))?
        .filter_map(|entry| {
            let path = entry.ok()?.path();
            let stem = path.file_stem()?.to_str()?;
            let digits = stem.trim_start_matches(|c: char| !c.is_ascii_digit());
            (path.extension()? == "daa").then(|| (digits.parse().unwrap_or(0), path.clone()))
        })
        .collect();
    files.sort();
    // The set's numbers are odd: every other file.
    files.retain(|(number, _)| {
        let half = if number / 2 % 2 == 1 {
            Half::Odd
        } else {
            Half::Even
        };
        args.only.is_none_or(|only| only == half)
    });
    if files.is_empty() {
        return Err(format!("{}: no .daa file", folder.display()));
    }
    let flights: Vec<(&Path, u64)> = (files.iter())
        .flat_map(|(_, path)| (0..args.seeds).map(|seed| (path.as_path(), seed)))
        .collect();
    let rows: Result<Vec<FlownRow>, String> = flights
        .par_iter()
        .map(|flight| fly_one(*flight, model.clone(), &policy, args.scale))
        .collect();
    let rows = rows?;
    if args.rows {
        for r in &rows {
            println!(
                "{:18} nominal {:7.1?} flown {:7.1?} acted {:5} changes {:2} reversals {:2} cross {:7.1} extra {:7.1} back {} work {} {:.0} us",
                r.name,
                r.nominal,
                r.flown,
                r.acted,
                r.transitions,
                r.reversals,
                r.cross_m,
                r.extra_m,
                r.back,
                r.searched,
                r.longest_us
            );
        }
    }
    show(&rows);
    Ok(())
}

fn show(rows: &[FlownRow]) {
    for (place, (name, _)) in VOLUMES.iter().enumerate() {
        let entered = |r: &&FlownRow| r.flown[place] < 0.0;
        let would = |r: &&FlownRow| r.nominal[place] < 0.0;
        let left: Vec<&str> = rows
            .iter()
            .filter(entered)
            .map(|r| r.name.as_str())
            .collect();
        println!(
            "{name} {} of {}, induced {}; needless {} of {}; left: {}",
            left.len(),
            rows.iter().filter(would).count(),
            rows.iter().filter(|r| entered(r) && !would(r)).count(),
            rows.iter().filter(|r| r.acted && !would(r)).count(),
            rows.iter().filter(|r| !would(r)).count(),
            left.join(" ")
        );
    }
    let sorted = |value: fn(&FlownRow) -> f64| {
        let mut all: Vec<f64> = rows.iter().map(value).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let cross = sorted(|r| r.cross_m);
    let acted: Vec<&FlownRow> = rows.iter().filter(|r| r.acted).collect();
    let not_back: Vec<&str> = acted
        .iter()
        .filter(|r| !r.back)
        .map(|r| r.name.as_str())
        .collect();
    println!(
        "cross-track median {:.0} 90% {:.0} most {:.0} m; extra path median {:.0}; acted {}; changes over 3: {}, most {}; reversals over 3: {}, most {}; not back {}; most work {}, longest {:.0} us",
        cross[cross.len() / 2],
        cross[(cross.len() - 1) * 9 / 10],
        cross[cross.len() - 1],
        sorted(|r| r.extra_m)[rows.len() / 2],
        acted.len(),
        acted.iter().filter(|r| r.transitions > 3).count(),
        rows.iter().map(|r| r.transitions).max().unwrap_or(0),
        acted.iter().filter(|r| r.reversals > 3).count(),
        rows.iter().map(|r| r.reversals).max().unwrap_or(0),
        not_back.join(" "),
        rows.iter().map(|r| r.searched).max().unwrap_or(0),
        rows.iter().map(|r| r.longest_us).fold(0.0, f64::max),
    );
    let ways: Vec<(&str, OnWayBack)> = rows
        .iter()
        .filter_map(|r| Some((r.name.as_str(), r.on_way_back?)))
        .collect();
    let farther = |least_m: f64, turns: f64| {
        let more_m = move |w: &OnWayBack| w.during_m - w.before_m - turns * w.turning_m;
        let farther = ways.iter().filter(move |(_, w)| more_m(w) > least_m);
        farther.map(|(name, w)| format!("{name} by {:.0} m", w.during_m - w.before_m))
    };
    println!(
        "ways back {}, farther than before {}; farther than the turn back takes: {}",
        ways.len(),
        farther(FARTHER_M, 0.0).count(),
        farther(MUCH_FARTHER_M, 1.0).collect::<Vec<_>>().join(", ")
    );
}

fn fly_one(
    (path, seed): (&Path, u64),
    model: VehicleModel,
    policy: &PolicyChoice,
    scale: f64,
) -> Result<FlownRow, String> {
    let recording = daa::read(path).map_err(|e| e.to_string())?;
    let from_s = recording.aircraft[0].samples[0].time_s;
    let tracks: Vec<Moments> = recording
        .aircraft
        .iter()
        .map(|aircraft| {
            let moment = |s: &daa::TrackSample| (s.time_s - from_s, s.position_m);
            aircraft.samples.iter().map(moment).collect()
        })
        .collect();
    let (own, intruders) = tracks.split_first().ok_or("no aircraft")?;
    let until_s = own.last().map_or(0.0, |last| last.0);
    let least = |own: &Moments| {
        intruders
            .iter()
            .map(|intruder| measure(own, intruder, until_s, scale))
            .reduce(|least, one| core::array::from_fn(|place| least[place].min(one[place])))
            .unwrap_or([f64::INFINITY; VOLUMES.len()])
    };
    let mut plan = Plan::read(path, Some(model)).map_err(|e| e.to_string())?;
    plan.world.seed = seed;
    let log = fly(plan, policy, &mut |_| ()).map_err(|e| e.to_string())?;
    let track = moments(&log);
    Ok(FlownRow {
        name: path.file_stem().map_or_else(String::new, |s| {
            s.to_string_lossy().replace("NRC_Intercept", "")
        }),
        nominal: least(own),
        flown: least(&track),
        acted: acted(&log),
        transitions: transitions(&log),
        reversals: reversals(&log),
        cross_m: log.outcome.max_cross_track_m,
        extra_m: log.outcome.extra_path_m,
        back: log.samples.last().map(|s| s.state) == Some(State::Cruise),
        on_way_back: on_way_back(&log, own),
        searched: log
            .decisions
            .iter()
            .map(|d| d.decision.record.work.candidates)
            .max()
            .unwrap_or(0),
        longest_us: log.decision_times().max_us,
    })
}

/// Where the aircraft was.
pub(crate) fn moments(log: &RunLog) -> Moments {
    let samples = log.samples.iter();
    samples.map(|s| (s.time_s, s.position_m)).collect()
}

/// Whether it avoided.
pub(crate) fn acted(log: &RunLog) -> bool {
    log.samples.iter().any(|s| s.state == State::Avoiding)
}

/// How often it began or ended to avoid.
pub(crate) fn transitions(log: &RunLog) -> usize {
    let pairs = log.samples.windows(2).map(|w| [w[0].state, w[1].state]);
    pairs
        .filter(|[before, after]| before != after && [before, after].contains(&&State::Avoiding))
        .count()
}

/// How often the bank changes its side while the aircraft avoids.
fn reversals(log: &RunLog) -> u32 {
    let mut reversals = Reversals::default();
    for sample in log.samples.iter().filter(|s| s.state == State::Avoiding) {
        reversals.bank(sample.bank_rad);
    }
    reversals.count
}

/// Departures about the first way back.
fn on_way_back(log: &RunLog, mission: &Moments) -> Option<OnWayBack> {
    let from = log
        .samples
        .iter()
        .position(|s| s.state == State::Recovering)?;
    let departure_m = |sample: &Sample| distance_m(mission, sample.position_m);
    let largest_m = |samples: &[Sample]| samples.iter().map(departure_m).fold(0.0, f64::max);
    let during = log.samples[from..]
        .iter()
        .take_while(|s| s.state == State::Recovering)
        .count();
    let (now, before) = (&log.samples[from], log.samples.get(from.checked_sub(5)?)?);
    let duration_s = now.time_s - before.time_s;
    let ground_mps = (now.position_m - before.position_m).with_z(0.0).length() / duration_s;
    let away_mps = (departure_m(now) - departure_m(before)) / duration_s;
    let sin = (away_mps / ground_mps).clamp(0.0, 1.0);
    let bank_rad = log
        .samples
        .iter()
        .map(|s| s.bank_rad.abs())
        .fold(0.0, f64::max);
    let radius_m = turn_radius_m(ground_mps, bank_rad).unwrap_or(0.0);
    Some(OnWayBack {
        before_m: largest_m(&log.samples[..=from]),
        during_m: largest_m(&log.samples[from..from + during]),
        turning_m: radius_m * (1.0 - (1.0 - sin * sin).sqrt()),
    })
}

/// Horizontal distance from a path that goes straight on after its last second.
fn distance_m(path: &Moments, place_m: Vec3) -> f64 {
    let last = path[path.len() - 1].1;
    let onwards = last - path[path.len().saturating_sub(11)].1;
    let end = last + onwards.normalize_or_zero() * 1e5;
    let points = path.iter().map(|moment| moment.1);
    let ends = points.clone().skip(1).chain([end]);
    points
        .zip(ends)
        .map(|(from, to)| {
            let (way, offset) = ((to - from).with_z(0.0), (place_m - from).with_z(0.0));
            let share = offset.dot(way) / way.length_squared().max(1e-9);
            (offset - way * share.clamp(0.0, 1.0)).length()
        })
        .fold(f64::INFINITY, f64::min)
}

fn at(rows: &Moments, time_s: f64) -> Vec3 {
    let next = rows
        .partition_point(|r| r.0 < time_s)
        .clamp(1, rows.len() - 1);
    let (a, b) = (rows[next - 1], rows[next]);
    let share = if b.0 > a.0 {
        (time_s - a.0) / (b.0 - a.0)
    } else {
        0.0
    };
    a.1 + (b.1 - a.1) * share
}

/// Least signed distances outside of the scaled volumes, at the rows of both and halfway between.
pub(crate) fn measure(
    own: &Moments,
    intruder: &Moments,
    until_s: f64,
    scale: f64,
) -> [f64; VOLUMES.len()] {
    let mut times: Vec<f64> = own.iter().chain(intruder).map(|m| m.0).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let last_s = until_s
        .min(own[own.len() - 1].0)
        .min(intruder[intruder.len() - 1].0);
    times.retain(|t| (intruder[0].0..=last_s).contains(t));
    let halves: Vec<f64> = times.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
    let mut least = [f64::INFINITY; VOLUMES.len()];
    for time_s in times.into_iter().chain(halves) {
        let offset = at(own, time_s) - at(intruder, time_s);
        let level = offset.x.hypot(offset.y);
        for (least, (_, (radius, half_height))) in least.iter_mut().zip(VOLUMES) {
            *least = least.min((level - scale * radius).max(offset.z.abs() - scale * half_height));
        }
    }
    least
}
