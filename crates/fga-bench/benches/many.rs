//! A quiet step among many obstacles: as rows, as columns, and kept from step to step.
//!
//! Processor time of the thread. Prints rows of CSV: scene, number of obstacles, form, steps, median, 99 % and largest
//! microseconds, and the median number of obstacles looked at. `kept, first` is the first step after all obstacles were
//! reported; `kept` are the steps of a minute after it. The scene `crowd` is 10 km wide whatever the number, in
//! `sky` a square kilometre has ten.
//!
//! `read 5` and `read 7` are no steps: they read the columns in the plane (places, velocities, radii), and all of them, and
//! do nothing else. That is what the machine's memory gives.

use core::hint::black_box;

use fga::Vec3;
use fga::avoider::{Avoider, Block, Kept, Settings, State};
use fga::situation::{Columns, Mission, Obstacles, Ownship, Situation};
use fga_bench::{Crowd, ownship, settings, vehicle};
use fga_campaign::encounters::{Random, Range};
use rustix::time::{ClockId, clock_gettime};

/// Steps of a minute.
const STEPS: usize = 600;

/// Repetitions of what looks at all obstacles.
const RUNS: usize = 51;

/// Obstacles for a square kilometre of the scene `sky`.
const DENSITY: f64 = 10.0;

/// No obstacle comes closer, metres: all steps are quiet.
const CLEAR_M: f64 = 100.0;

/// Processor time of this thread, microseconds.
fn thread_us() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 * 1e6 + now.tv_nsec as f64 * 1e-3
}

/// Least time of reading the clock twice, microseconds.
fn clock_us() -> f64 {
    let once = |_| {
        let begun = thread_us();
        thread_us() - begun
    };
    (0..1000).map(once).fold(f64::INFINITY, f64::min)
}

/// Steps, each with its microseconds and the number of obstacles looked at.
type Steps = Vec<(f64, usize)>;

fn report(scene: &str, count: usize, form: &str, steps: &mut Steps) {
    steps.sort_by(|one, other| one.0.total_cmp(&other.0));
    let at = |share: usize| {
        let place = steps.len().saturating_sub(1) * share / 100;
        steps.get(place).map_or(f64::NAN, |step| step.0)
    };
    let mut looked: Vec<usize> = steps.iter().map(|step| step.1).collect();
    looked.sort_unstable();
    let looked = looked.get(looked.len() / 2).copied().unwrap_or_default();
    println!(
        "{scene},{count},{form},{},{:.2},{:.2},{:.2},{looked}",
        steps.len(),
        at(50),
        at(99),
        at(100)
    );
}

/// A situation on the way to the east.
fn situation(own: Ownship, step: usize, waypoints_m: &[Vec3]) -> Situation<'_> {
    Situation {
        time_s: 0.1 * step as f64,
        ownship: own,
        obstacles: Obstacles::Rows(&[]),
        mission: Mission::new(waypoints_m),
        wind_mps: Vec3::ZERO,
    }
}

/// Steps that look at all obstacles.
fn given(crowd: &Crowd, avoider: &Avoider, columns: bool, clock_us: f64) -> Steps {
    let waypoints = [Vec3::ZERO, Vec3::X * 1e6];
    let obstacles = if columns {
        Obstacles::Columns(crowd.columns())
    } else {
        Obstacles::Rows(&crowd.rows)
    };
    let situation = Situation {
        obstacles,
        ..situation(ownship(), 0, &waypoints)
    };
    let mut avoider = avoider.clone();
    let once = |_| {
        let begun = thread_us();
        let decision = black_box(avoider.step(black_box(&situation)));
        let micros = thread_us() - begun - clock_us;
        assert_eq!(decision.state, State::Cruise);
        (micros, crowd.rows.len())
    };
    (0..RUNS).map(once).collect()
}

/// Reads columns, without a step: a page of each in turn.
fn read(columns: &[&[f64]], clock_us: f64) -> Steps {
    /// Numbers of a page.
    const PAGE: usize = 512;
    let count = columns.iter().map(|column| column.len()).min().unwrap_or(0);
    let once = |_| {
        let begun = thread_us();
        let mut all = 0;
        for from in (0..count).step_by(PAGE) {
            for column in columns {
                // Its order is free, so the compiler makes vector code of it that waits for nothing but the memory.
                let page = column[from..count.min(from + PAGE)].iter();
                all ^= page.fold(0, |bits, number| bits ^ number.to_bits());
            }
        }
        black_box(all);
        (thread_us() - begun - clock_us, count)
    };
    (0..RUNS).map(once).collect()
}

/// The first step among kept obstacles of several flights, and the later ones of the last flight.
fn kept(crowd: &Crowd, avoider: &Avoider, clock_us: f64) -> (Steps, Steps) {
    let waypoints = [Vec3::ZERO, Vec3::X * 1e6];
    let mut blocks = vec![Block::EMPTY; crowd.rows.len().div_ceil(Block::OBSTACLES)];
    let (mut first, mut later) = (Steps::new(), Steps::new());
    for _ in 0..5 {
        later.clear();
        let mut kept = Kept::new(&mut blocks);
        for row in &crowd.rows {
            kept.put(row, 0.0).expect("there is room");
        }
        let mut avoider = avoider.clone();
        // Off its place along the leg; a step off the leg is not quiet.
        let mut gusts = Random::new(1, 0);
        for step in 0..=STEPS {
            let mut own = ownship();
            own.position_m = Vec3::X * (1.5 * step as f64 + gusts.within(Range(-0.02, 0.02)));
            let situation = situation(own, step, &waypoints);
            let begun = thread_us();
            let decision = black_box(avoider.step_kept(black_box(&situation), &mut kept));
            let micros = thread_us() - begun - clock_us;
            assert_eq!(decision.state, State::Cruise);
            let steps = if step == 0 { &mut first } else { &mut later };
            steps.push((micros, kept.looked()));
        }
    }
    (first, later)
}

fn main() {
    // `cargo test --benches` passes --test: a few obstacles show that it runs.
    let full = std::env::args().any(|argument| argument == "--bench");
    let clock_us = clock_us();
    println!("scene,obstacles,form,steps,median_us,p99_us,largest_us,looked_at");
    for exponent in 3..=if full { 6 } else { 3 } {
        let count = 10_usize.pow(exponent);
        let half_m = 500.0 * (count as f64 / DENSITY).sqrt();
        for (scene, half_m, radius_m) in [
            ("crowd", 5e3, f64::INFINITY),
            ("sky", half_m, f64::INFINITY),
            ("sky, 3 km", half_m, 3e3),
        ] {
            let settings = Settings {
                surveillance_radius_m: radius_m,
                ..settings()
            };
            let avoider = Avoider::new(settings, vehicle()).expect("settings are valid");
            let crowd = Crowd::clear_by(count, 1, CLEAR_M, half_m);
            for (form, columns) in [("rows", false), ("columns", true)] {
                let mut steps = given(&crowd, &avoider, columns, clock_us);
                report(scene, count, form, &mut steps);
            }
            let Columns {
                x_m,
                y_m,
                z_m,
                vx_mps,
                vy_mps,
                vz_mps,
                radius_m,
                ..
            } = crowd.columns();
            let plane = [x_m, y_m, vx_mps, vy_mps, radius_m];
            let all = [x_m, y_m, vx_mps, vy_mps, radius_m, z_m, vz_mps];
            report(scene, count, "read 5", &mut read(&plane, clock_us));
            report(scene, count, "read 7", &mut read(&all, clock_us));
            let (mut first, mut later) = kept(&crowd, &avoider, clock_us);
            report(scene, count, "kept: first", &mut first);
            report(scene, count, "kept", &mut later);
        }
    }
}
