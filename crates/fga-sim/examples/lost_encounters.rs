//! Counts the encounters that the oracle saves and a policy loses.
//!
//! `lost_encounters CELL SEED COUNT [START] [turning]`, CELL as in `EncounterSource::parse`, START one of
//! `free`, `t0`, `latest` or a `C_s`. Prints one line for the cell and one for each lost encounter.
//!
//! With `turning` the closest intruder turns by 45° to either side one second after the policy has
//! begun to avoid; the oracle then learns of it when the policy does: it starts from where the
//! aircraft is at that moment.

use std::process::ExitCode;
use std::time::Instant;

use fga::Vec3;
use fga::avoider::State;
use fga::certificate::{Hazard, certify_all};
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::{Mission, Obstacles, Situation};
use fga::situation::{Obstacle, Ownship};
use fga::vehicle::{Response, Vehicle};
use fga_formats::encounters::Encounter;
use fga_sim::encounters::EncounterSource;
use fga_sim::oracle::{OracleObstacle, OracleSettings, OracleStart, OracleVehicle, best_margin};
use fga_sim::policy::{PolicyChoice, PolicySettings};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// Time from the beginning of the avoidance to the intruder's turn, seconds.
const TURNS_AFTER_S: f64 = 1.0;

/// By how much it turns, radians.
const TURNS_BY_RAD: f64 = core::f64::consts::FRAC_PI_4;

/// Where everything was when an intruder turned.
struct Turned {
    own: MotionState,
    rows: Vec<Obstacle>,
}

struct Flown {
    margin_m: f64,
    turned: Option<Turned>,
    largest_cross_m: f64,
    extra_path_m: Option<f64>,
    acted: bool,
    states: Vec<(f64, State, f64)>,
}

fn vehicle(planar: bool) -> Vehicle {
    let climb = if planar { 0.0 } else { 15.0_f64.to_radians() };
    Vehicle {
        airspeed_mps: 15.0,
        turn_radius_m: 30.0,
        climb_min_rad: -climb,
        climb_max_rad: climb,
        climb_rate_radps: 0.2,
        response: Response::default(),
    }
}

/// Turns the intruder that is closest to a position, to the left in encounters of an even number.
fn turn_closest(rows: &mut [Obstacle], position_m: Vec3, number: u64) {
    let distance_m = |row: &Obstacle| row.position_m.distance(position_m);
    let closest = rows
        .iter_mut()
        .min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
    if let Some(row) = closest {
        let side = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
        let (sin, cos) = (side * TURNS_BY_RAD).sin_cos();
        let v = row.velocity_mps;
        row.velocity_mps = Vec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z);
    }
}

fn fly(
    encounter: &Encounter,
    planar: bool,
    (policy, turning): (PolicyChoice, bool),
    times: &mut Vec<f64>,
    searches: &mut Vec<f64>,
) -> Flown {
    let vehicle = vehicle(planar);
    let mut settings = PolicySettings::default();
    settings.avoider.surveillance_radius_m = f64::INFINITY;
    let mut pilot = policy
        .pilot(&settings, &vehicle)
        .expect("settings are valid");
    let flyer = Flyer::new(&vehicle);
    let waypoints = [Vec3::ZERO, Vec3::X * 1e5];
    let mut path = FlightPath::new();
    let mut own = MotionState {
        time_s: 0.0,
        position_m: Vec3::ZERO,
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
    };
    let mut rows: Vec<Obstacle> = encounter.obstacles.clone();
    let mut avoids_s = f64::INFINITY;
    let mut flown = Flown {
        margin_m: f64::INFINITY,
        turned: None,
        largest_cross_m: 0.0,
        extra_path_m: None,
        acted: false,
        states: Vec::new(),
    };
    for cycle in 0..600 {
        let time_s = f64::from(cycle) * 0.1;
        if cycle > 0 {
            for row in &mut rows {
                row.position_m = row.position_after_m(0.1);
            }
        }
        if turning && flown.turned.is_none() && time_s >= avoids_s + TURNS_AFTER_S - 1e-9 {
            turn_closest(&mut rows, own.position_m, encounter.id);
            let rows = rows.clone();
            flown.turned = Some(Turned { own, rows });
        }
        let ownship = Ownship {
            position_m: own.position_m,
            course_rad: own.course_rad,
            climb_rad: own.climb_rad,
            bank_rad: 0.0,
            airspeed_mps: 15.0,
        };
        let situation = Situation {
            time_s,
            ownship,
            obstacles: Obstacles::Rows(&rows),
            mission: Mission::new(&waypoints),
            wind_mps: Vec3::ZERO,
        };
        let begun = Instant::now();
        let decision = pilot.step(&situation);
        times.push(begun.elapsed().as_secs_f64() * 1e6);
        if decision.record.work.candidates > 2000 {
            searches.push(begun.elapsed().as_secs_f64() * 1e6);
        }
        if flown
            .states
            .last()
            .is_none_or(|last| last.1 != decision.state)
        {
            flown
                .states
                .push((time_s, decision.state, own.position_m.y));
        }
        flown.acted |= decision.state == State::Avoiding;
        if decision.state == State::Avoiding {
            avoids_s = avoids_s.min(time_s);
        }
        own.time_s = 0.0;
        path.predict(&flyer, &own, &decision.command, 0.2);
        let hazards: Vec<Hazard> = rows
            .iter()
            .zip(0..)
            .map(|(o, i)| Hazard::new(i, o, Vec3::ZERO, 0.0))
            .collect();
        let least = certify_all(&flyer, &path, &hazards, 0.1, f64::MIN, 1e6);
        flown.margin_m = flown.margin_m.min(least.margin_m);
        own = path.state_at(&flyer, 0.1).expect("the path has a state");
        let cross = Vec3::new(0.0, own.position_m.y, own.position_m.z).length();
        flown.largest_cross_m = flown.largest_cross_m.max(cross);
        let passed = rows.iter().all(|row| {
            let offset = own.position_m - row.position_m;
            let velocity = flyer.velocity_mps(&own) - row.velocity_mps;
            offset.dot(velocity) >= 0.0
        });
        if decision.state == State::Cruise && cross < 0.5 && passed {
            flown.extra_path_m = Some(15.0 * (time_s + 0.1) - own.position_m.x);
            break;
        }
    }
    flown
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn run(arguments: &[String]) -> Result<(), String> {
    let [cell, seed, count, rest @ ..] = arguments else {
        return Err("usage: lost_encounters CELL SEED COUNT [START]".into());
    };
    let number = |text: &str| {
        text.parse::<u64>()
            .map_err(|e| format!("{text}: expected a number: {e}"))
    };
    let parse = |name, start| PolicyChoice::parse(name, start);
    let policy = match rest.first().map(String::as_str) {
        None | Some("free" | "turning") => PolicyChoice::default(),
        Some("published") => parse("published", Some("t0"))?,
        Some("published-tc") => parse("published", Some("tc"))?,
        Some("literal") => parse("published-literal", None)?,
        Some(name @ ("circle" | "none")) => parse(name, None)?,
        Some(start @ ("t0" | "latest")) => parse("turn-aware", Some(start))?,
        Some(score) => parse("turn-aware", Some(&format!("Cs={score}")))?,
    };
    let turning = rest.iter().any(|word| word == "turning");
    let source = EncounterSource::parse(cell, number(seed)?)?;
    let oracle_vehicle = OracleVehicle::from(&vehicle(source.planar));
    let (mut lost, mut unsaved, mut saved) = (0, 0, 0);
    let (mut crosses, mut extras, mut times) = (Vec::new(), Vec::new(), Vec::new());
    let mut stranded = 0;
    let mut searches = Vec::new();
    for n in 0..number(count)? {
        let encounter = source.encounter(n);
        let flown = fly(
            &encounter,
            source.planar,
            (policy, turning),
            &mut times,
            &mut searches,
        );
        if flown.margin_m >= 0.0 {
            saved += 1;
            crosses.push(flown.largest_cross_m);
            match flown.extra_path_m {
                Some(extra) => extras.push(extra),
                None => stranded += 1,
            }
            if flown.extra_path_m.is_none() && std::env::var_os("STRANDED").is_some() {
                println!("  encounter {n} not back: {:?}", flown.states);
            }
            continue;
        }
        let (start, rows) = match &flown.turned {
            Some(turned) => (
                OracleStart {
                    position_m: turned.own.position_m,
                    course_rad: turned.own.course_rad,
                    climb_rad: turned.own.climb_rad,
                    ..OracleStart::ORIGIN
                },
                &turned.rows,
            ),
            None => (OracleStart::ORIGIN, &encounter.obstacles),
        };
        let obstacles: Vec<OracleObstacle> = rows.iter().map(OracleObstacle::from).collect();
        let answer = best_margin(
            &start,
            &oracle_vehicle,
            &obstacles,
            &OracleSettings::default(),
        );
        if answer.avoidable() {
            lost += 1;
            println!(
                "  lost {n}: flown {:.3} m, oracle {:.3} m by {:?} {:?}",
                flown.margin_m, answer.best_margin_m, answer.maneuver, flown.states
            );
        } else {
            unsaved += 1;
        }
    }
    let total: f64 = times.iter().sum();
    let middle = median(&mut times);
    let at_permille = |permille: usize| {
        times
            .get(permille * times.len() / 1000)
            .copied()
            .unwrap_or(0.0)
    };
    println!(
        "{cell}: saved {saved}, lost {lost}, not avoidable {unsaved}, not back {stranded}; \
         median cross {:.2} m, extra {:.2} m; decision median {middle:.2} us, p99 {:.1}, max {:.0}, \
         mean {:.2}; {} searches, median {:.0} us",
        median(&mut crosses),
        median(&mut extras),
        at_permille(990),
        times.last().copied().unwrap_or(0.0),
        total / times.len() as f64,
        searches.len(),
        median(&mut searches),
    );
    Ok(())
}
