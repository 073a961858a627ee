//! Figs. 16 and 17, and the San Francisco case of Figs. 25 and 26.

use std::path::Path;

use fga::Vec3;
use fga_campaign::campaign::parse_policy;
use fga_campaign::oracle::{
    OracleObstacle, OracleSettings, OracleStart, OracleVehicle, best_margin,
};
use fga_files::TomlText;
use fga_formats::atomic;
use fga_formats::export::{self, Format};
use fga_report::report::{Cell, Column, Reading, Section, SectionBlock, Table};
use fga_sim::run::{RunLog, fly};
use fga_sim::scenario;
use fga_sim::vehicle_file::VehicleModel;

use crate::ReproduceError;
use crate::Setting;
use fga_results::{flight_file, flight_files, replay_page};

const RASCAL: &str = include_str!("../vehicles/rascal-110.toml");

struct PictureCase {
    title: &'static str,
    name: &'static str,
    scenario: &'static str,
    rascal: bool,
    policies: &'static [&'static str],
    paper: &'static str,
}

/// Started at once, as late as possible, and as the policy chooses.
const STARTS: [&str; 5] = [
    "published --start t0",
    "published --start tc",
    "turn-aware --start t0",
    "turn-aware --start latest",
    "turn-aware",
];

const CASES: [PictureCase; 3] = [
    PictureCase {
        title: "Fig. 16: a static obstacle in three dimensions",
        name: "fig-16",
        scenario: include_str!("../scenarios/fig-16.toml"),
        rascal: false,
        policies: &STARTS,
        paper: "The aircraft avoids a single obstacle with minimal deviation, started at t_0 and at t_c.",
    },
    PictureCase {
        title: "Fig. 17: moving obstacles in three dimensions",
        name: "fig-17",
        scenario: include_str!("../scenarios/fig-17.toml"),
        rascal: false,
        policies: &STARTS,
        paper: "The aircraft avoids several obstacles and returns to its path, started at t_0 and at t_c.",
    },
    PictureCase {
        title: "Figs. 25 and 26: San Francisco airport",
        name: "sfo",
        scenario: include_str!("../scenarios/sfo.toml"),
        rascal: true,
        policies: &["circle", "turn-aware"],
        paper: "The aircraft flies round a protected radius of 150 m over the runway on every crossing.",
    },
];

/// One section for each case.
pub(crate) fn sections(
    setting: &Setting<'_>,
    paper: &VehicleModel,
) -> Result<Vec<Section>, ReproduceError> {
    CASES
        .iter()
        .map(|case| section(case, setting, paper))
        .collect()
}

fn section(
    case: &PictureCase,
    setting: &Setting<'_>,
    paper: &VehicleModel,
) -> Result<Section, ReproduceError> {
    setting.begin(case.title)?;
    let mut blocks = Vec::new();
    let mut rows = Vec::new();
    let mut flown = Vec::new();
    for name in case.policies {
        let log = fly_case(case, name, paper)?;
        let outcome = &log.outcome;
        rows.push(vec![
            Cell::Text((*name).to_owned()),
            Cell::Number(outcome.min_margin_m, 2),
            Cell::Number(outcome.max_cross_track_m, 1),
            Cell::Number(path_m(&log), 0),
            Cell::Text(format!(
                "{} of {}",
                reached(&log),
                log.plan.world.mission_m.len()
            )),
            outcome.start_s.map_or(Cell::Empty, |s| Cell::Number(s, 1)),
            outcome
                .rejoined_s
                .map_or(Cell::Empty, |s| Cell::Number(s, 1)),
        ]);
        let svg = flight_files::overview(&log).to_svg();
        let file = file_name(case, name, "svg");
        atomic::write(&setting.data().join(&file), &svg)?;
        blocks.push(SectionBlock::Figure {
            svg,
            caption: format!("{name} (data/{file})."),
        });
        flown.push((*name, log));
    }
    blocks.insert(
        0,
        SectionBlock::Table(Table {
            caption: "Results of the flights.".into(),
            columns: vec![
                Column::text("policy"),
                Column::number("least margin (m)"),
                Column::number("largest distance from the route (m)"),
                Column::number("path flown (m)"),
                Column::number(&format!("waypoints within {REACHED_M} m")),
                Column::number("began (s)"),
                Column::number("rejoined (s)"),
            ],
            rows,
        }),
    );
    let file = format!("{}-replay.html", case.name);
    let page = replay_page::page(flown.iter().map(|(_, log)| log));
    atomic::write(&setting.data().join(&file), page)?;
    let mut files = vec![(
        format!("data/{file}"),
        "the flights in one scene, for a browser".into(),
    )];
    for (name, log) in &flown {
        // Only flights with an origin on the globe.
        if log.plan.frame.is_some() {
            let file = file_name(case, name, "kml");
            let flight = flight_file::flight(log, &flight_files::events(log));
            export::write(&flight, Format::Kml, &setting.data().join(&file))?;
            files.push((format!("data/{file}"), format!("{name}, for Google Earth")));
        }
    }
    blocks.push(SectionBlock::Files(files));
    blocks.push(SectionBlock::Reading(reading(case, &flown)));
    Ok(Section {
        title: case.title.into(),
        blocks,
    })
}

/// A waypoint counts as reached within this distance, metres: the aircraft cuts corners.
const REACHED_M: f64 = 150.0;

/// Waypoints within that distance of the flight.
fn reached(log: &RunLog) -> usize {
    let near = |waypoint_m: &&Vec3| {
        log.samples
            .iter()
            .any(|sample| sample.position_m.distance(**waypoint_m) <= REACHED_M)
    };
    log.plan.world.mission_m.iter().filter(near).count()
}

/// Path flown over the ground, metres.
fn path_m(log: &RunLog) -> f64 {
    log.samples
        .windows(2)
        .map(|pair| pair[0].position_m.distance(pair[1].position_m))
        .sum()
}

fn file_name(case: &PictureCase, policy: &str, ending: &str) -> String {
    format!(
        "{}-{}.{ending}",
        case.name,
        policy.replace(" --start ", "-")
    )
}

/// The margin that the oracle keeps from the first state of the flight, over the first minute, metres;
/// obstacles fly straight at their first velocity.
fn allowed_m(log: &RunLog) -> f64 {
    let world = &log.plan.world;
    let start = OracleStart {
        position_m: world.start.position_m,
        course_rad: world.start.course_rad,
        climb_rad: world.start.climb_rad,
        bank_rad: 0.0,
    };
    let obstacles: Vec<OracleObstacle> = world
        .obstacles
        .iter()
        .filter_map(|obstacle| {
            let (position_m, velocity_mps) = obstacle.track.at(0.0)?;
            let seen = OracleObstacle {
                position_m,
                velocity_mps,
                volume: obstacle.volume,
            };
            Some(seen.in_wind(world.wind_mps))
        })
        .collect();
    let vehicle = OracleVehicle::from(&world.vehicle);
    best_margin(&start, &vehicle, &obstacles, &OracleSettings::default()).best_margin_m
}

fn fly_case(
    case: &PictureCase,
    policy: &str,
    paper: &VehicleModel,
) -> Result<RunLog, ReproduceError> {
    let vehicle = if case.rascal {
        VehicleModel::parse(TomlText::new(Path::new("vehicles/rascal-110.toml"), RASCAL))?
    } else {
        paper.clone()
    };
    let path = format!("scenarios/{}.toml", case.name);
    let plan = scenario::parse(
        TomlText::new(Path::new(&path), case.scenario),
        Some(vehicle),
    )?;
    let policy = parse_policy(policy).map_err(ReproduceError::Input)?;
    fly(plan, &policy, &mut |_| ()).map_err(|error| ReproduceError::of(&error))
}

fn reading(case: &PictureCase, flown: &[(&str, RunLog)]) -> Reading {
    let words = |(name, log): &(&str, RunLog)| {
        format!(
            "{name}: {}, least margin {:.2} m, {:.0} m of path past {} of {} waypoints",
            if log.outcome.separated() {
                "separated"
            } else {
                "entered the volume"
            },
            log.outcome.min_margin_m,
            path_m(log),
            reached(log),
            log.plan.world.mission_m.len()
        )
    };
    let of = |own: bool| {
        let told: Vec<String> = flown
            .iter()
            .filter(|(name, _)| name.starts_with("turn-aware") == own)
            .map(words)
            .collect();
        told.join("; ") + "."
    };
    let separated = flown
        .iter()
        .filter(|(_, log)| log.outcome.separated())
        .count();
    let whole = |log: &RunLog| reached(log) == log.plan.world.mission_m.len();
    let shortest = flown
        .iter()
        .filter(|(_, log)| log.outcome.separated() && whole(log))
        .min_by(|a, b| path_m(&a.1).total_cmp(&path_m(&b.1)));
    let left_out: Vec<&str> = flown
        .iter()
        .filter(|(_, log)| !whole(log))
        .map(|(name, _)| *name)
        .collect();
    Reading {
        paper: case.paper.into(),
        published: of(false),
        turn_aware: of(true),
        oracle: flown.first().map_or_else(String::new, |(_, log)| {
            format!(
                "Can be kept clear: from the state at the start some manoeuvre keeps {:.0} m over the \
                 first minute, at whatever length of path.",
                allowed_m(log)
            )
        }),
        reading: format!(
            "{separated} of {} stay outside the protected volumes{}{}; the paper's own positions are \
             not given, so the pictures compare in kind only.",
            flown.len(),
            shortest.map_or_else(String::new, |(name, _)| format!(
                ", {name} on the shortest way past all waypoints"
            )),
            if left_out.is_empty() {
                String::new()
            } else {
                format!("; {} leaves waypoints out", left_out.join(" and "))
            }
        ),
    }
}
