//! Time of a decision of fga and of its peers in the same situations, in one run.
//!
//! Encounters are flown by fga. Each cycle in which fga chooses (something is in conflict, a manoeuvre is looked for
//! and found) is measured for every method; the peers are told each cycle, so that they are in the state in which
//! they would decide. `dodgy_3d` is one step of the crate alone; the other times include the guidance along the mission.
//! `fga-every-cycle` are all cycles of fga: it keeps what it chose, where most peers solve again in each cycle.
//!
//! Prints rows of CSV: aircraft, obstacles, method, steps, median, 99 %, largest in microseconds of the thread's
//! processor time, each step the quickest of several.
//!
//! With the arguments `situations FILE` it measures nothing and writes the situations in which fga chose, so that the same
//! questions can be put to another library: `cargo bench -p fga-bench --bench peers -- situations /tmp/situations.csv`. A row
//! an aircraft: `aircraft` (ideal, lagged), `obstacles` (their number), `step` (number of the situation), `id` (`own` is
//! the aircraft itself, first in its situation), place `x_m,y_m,z_m` (east, north, up), velocity over the ground
//! `vx_mps,vy_mps,vz_mps`, and `radius_m`, the radius of the sphere to keep clear of. There is no wind, and the mission leads from
//! the origin along +x. The numbers read back as they were.

extern crate alloc;

mod clock;

use alloc::borrow::Cow;
use core::hint::black_box;
use std::fs::File;
use std::io::{BufWriter, Write};

use clock::{quickest_us, reading_us};
use dodgy_3d::{Agent, AvoidanceOptions, Vec3 as Single};
use fga::Vec3;
use fga::situation::Situation;
use fga_bench::cycles::{BenchAircraft, BenchEncounter, StepKind};
use fga_sim::policy::{Pilot, PolicyChoice};
use fga_sim::settings::PolicySettings;
use fga_sim::vehicle_file::VehicleModel;

/// Repetitions of each step.
const RUNS: usize = 5;

/// Encounters with one obstacle; fewer with more.
const ENCOUNTERS: u64 = 120;

/// Aircraft and numbers of obstacles.
const CASES: [(BenchAircraft, u32); 6] = [
    (BenchAircraft::Ideal, 1),
    (BenchAircraft::Ideal, 3),
    (BenchAircraft::Ideal, 10),
    (BenchAircraft::Lagged, 1),
    (BenchAircraft::Lagged, 3),
    (BenchAircraft::Lagged, 10),
];

/// The peers, and the paper's rules.
const PEERS: [(&str, Option<&str>); 8] = [
    ("orca", None),
    ("mvp", None),
    ("velocity-obstacles", None),
    ("potential-field", None),
    ("waypoint-greedy", None),
    ("waypoint-optimal", None),
    ("published", Some("t0")),
    ("published", Some("tc")),
];

/// A method and the times of its steps, microseconds.
struct Measured {
    name: String,
    pilot: Option<Box<dyn Pilot + Send>>,
    micros: Vec<f64>,
}

impl Measured {
    fn new(name: &str) -> Self {
        Self {
            name: name.into(),
            pilot: None,
            micros: Vec::new(),
        }
    }
}

/// One step of `dodgy_3d` alone.
fn dodgy_us(situation: &Situation<'_>, clock_us: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, reason = "dodgy_3d takes f32")]
    let single = |v: Vec3| Single::new(v.x as f32, v.y as f32, v.z as f32);
    let own = &situation.ownship;
    let velocity = single(own.velocity_mps());
    let agent = Agent {
        position: single(own.position_m),
        velocity,
        radius: 0.0,
        avoidance_responsibility: 1.0,
    };
    #[expect(clippy::cast_possible_truncation, reason = "dodgy_3d takes f32")]
    let others: Vec<Agent> = situation
        .obstacles
        .iter()
        .map(|obstacle| Agent {
            position: single(obstacle.position_m),
            velocity: single(obstacle.velocity_mps),
            radius: obstacle.volume.radius_m() as f32,
            avoidance_responsibility: 0.0,
        })
        .collect();
    let neighbours: Vec<Cow<'_, Agent>> = others.iter().map(Cow::Borrowed).collect();
    let options = AvoidanceOptions { time_horizon: 60.0 };
    #[expect(clippy::cast_possible_truncation, reason = "dodgy_3d takes f32")]
    let speed = own.airspeed_mps as f32;
    quickest_us(
        RUNS,
        clock_us,
        || (),
        |()| {
            agent.compute_avoiding_velocity(black_box(&neighbours), velocity, speed, 0.1, &options)
        },
    )
}

fn measure(encounter: BenchEncounter, clock_us: f64, methods: &mut [Measured]) {
    for method in methods.iter_mut() {
        if let Some(pilot) = &mut method.pilot {
            pilot.restart();
        }
    }
    encounter.fly(|before, situation, decision| {
        let chooses = StepKind::of(decision) == StepKind::Choosing;
        let own_us = quickest_us(
            RUNS,
            clock_us,
            || before.clone(),
            |avoider| avoider.step(black_box(situation)),
        );
        for method in methods.iter_mut() {
            let micros = match (&mut method.pilot, method.name.as_str()) {
                (Some(pilot), _) => {
                    let runs = if chooses { RUNS } else { 1 };
                    quickest_us(runs, clock_us, || (), |()| pilot.step(black_box(situation)))
                }
                (None, "dodgy_3d") if chooses => dodgy_us(situation, clock_us),
                (None, _) => own_us,
            };
            if chooses || method.name == "fga-every-cycle" {
                method.micros.push(micros);
            }
        }
        false
    });
}

/// Encounters with a number of obstacles.
fn encounters(
    aircraft: BenchAircraft,
    count: u32,
    quick: bool,
) -> impl Iterator<Item = BenchEncounter> {
    let encounters = if quick {
        1
    } else {
        ENCOUNTERS / u64::from(count)
    };
    (0..encounters).map(move |number| BenchEncounter::threats(aircraft, count, number))
}

/// Writes the situations in which fga chose.
fn write_situations(file: &str, quick: bool) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::create(file)?);
    writeln!(
        out,
        "aircraft,obstacles,step,id,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m"
    )?;
    for (aircraft, count) in CASES {
        let mut rows = Vec::new();
        let mut step = 0;
        for encounter in encounters(aircraft, count, quick) {
            encounter.fly(|_, situation, decision| {
                if StepKind::of(decision) == StepKind::Choosing {
                    let own = &situation.ownship;
                    let head = format!("{},{count},{step}", aircraft.name());
                    let mut row = |id: &str, at: Vec3, velocity: Vec3, radius_m: f64| {
                        let numbers = [at.x, at.y, at.z, velocity.x, velocity.y, velocity.z];
                        let numbers = numbers.map(|number| number.to_string()).join(",");
                        rows.push(format!("{head},{id},{numbers},{radius_m}"));
                    };
                    row("own", own.position_m, own.velocity_mps(), 0.0);
                    for other in situation.obstacles.iter() {
                        let radius_m = other.volume.radius_m();
                        row(
                            &other.id.to_string(),
                            other.position_m,
                            other.velocity_mps,
                            radius_m,
                        );
                    }
                    step += 1;
                }
                false
            });
        }
        for row in rows {
            writeln!(out, "{row}")?;
        }
    }
    out.flush()
}

fn main() {
    // `cargo test --benches` passes no --bench: one encounter of each shows that it runs.
    let quick = !std::env::args().any(|argument| argument == "--bench");
    let mut words = std::env::args().skip_while(|argument| argument != "situations");
    if words.next().is_some() {
        let file = words.next().filter(|word| word != "--bench");
        let file = file.expect("the name of a file behind `situations`");
        write_situations(&file, quick).unwrap_or_else(|error| panic!("{file}: {error}"));
        return;
    }
    let clock_us = reading_us();
    let model = VehicleModel::built_in().expect("the built-in vehicle");
    let mut settings: PolicySettings = model.settings;
    settings.avoider.surveillance_radius_m = f64::INFINITY;
    println!("aircraft,obstacles,method,steps,median_us,p99_us,largest_us");
    for (aircraft, count) in CASES {
        let mut methods: Vec<Measured> = ["fga", "fga-every-cycle", "dodgy_3d"]
            .map(Measured::new)
            .into();
        methods.extend(PEERS.map(|(name, start)| {
            let choice = PolicyChoice::parse(name, start).expect("a policy by its name");
            let pilot = choice.pilot(&settings, &aircraft.vehicle());
            Measured {
                pilot: Some(pilot.expect("settings of Table 4")),
                ..Measured::new(&choice.name())
            }
        }));
        for encounter in encounters(aircraft, count, quick) {
            measure(encounter, clock_us, &mut methods);
        }
        for Measured { name, micros, .. } in &mut methods {
            micros.sort_by(f64::total_cmp);
            let Some(last) = micros.len().checked_sub(1) else {
                continue;
            };
            println!(
                "{},{count},{name},{},{:.2},{:.1},{:.1}",
                aircraft.name(),
                micros.len(),
                micros[last / 2],
                micros[last * 99 / 100],
                micros[last]
            );
        }
    }
}
