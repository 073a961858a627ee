//! Time of a step by kind: quiet, kept, choosing, searching, hopeless; by aircraft and number of
//! obstacles; and of the longest steps that we could construct.
//!
//! Processor time of the thread, each step the quickest of several from the same state, without the time of reading the clock. Prints rows
//! of CSV: aircraft, obstacles, kind, steps, median, 99 %, largest in microseconds, and nanoseconds per unit of work. The
//! adversarial set follows: microseconds and units of work, with 99.99 %, and the step with the most work, which
//! `tests/instructions` counts.

use core::hint::black_box;

use fga::avoider::Avoider;
use fga::situation::Situation;
use fga_bench::cycles::{Aircraft, Encounter, Kind};
use rustix::time::{ClockId, clock_gettime};

/// Repetitions of each step.
const RUNS: usize = 5;

/// Encounters with one obstacle; fewer with more.
const ENCOUNTERS: u64 = 40;

/// Encounters of the adversarial set.
const ADVERSARIAL: u64 = 40;

/// Processor time of this thread, microseconds.
fn thread_us() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 * 1e6 + now.tv_nsec as f64 * 1e-3
}

/// Processor time of one step, microseconds.
fn step_us(before: &Avoider, situation: &Situation<'_>, clock_us: f64) -> f64 {
    let once = || {
        let mut avoider = before.clone();
        let begun = thread_us();
        black_box(avoider.step(black_box(situation)));
        thread_us() - begun - clock_us
    };
    (0..RUNS)
        .map(|_| once())
        .fold(f64::INFINITY, f64::min)
        .max(0.0)
}

/// The measured step.
struct Sample {
    kind: Kind,
    cycle: usize,
    micros: f64,
    work: u32,
}

fn measure(encounter: Encounter, clock_us: f64, samples: &mut Vec<Sample>) {
    let first = samples.len();
    encounter.fly(|before, situation, decision| {
        samples.push(Sample {
            kind: Kind::of(decision),
            cycle: samples.len() - first,
            micros: step_us(before, situation, clock_us),
            work: decision.record.work.work,
        });
        false
    });
}

fn report(name: &str, samples: &[Sample], keep: impl Fn(&Sample) -> bool) {
    let mut micros: Vec<f64> = samples
        .iter()
        .filter(|s| keep(s))
        .map(|s| s.micros)
        .collect();
    if micros.is_empty() {
        return;
    }
    micros.sort_by(f64::total_cmp);
    let last = micros.len() - 1;
    let units: f64 = samples
        .iter()
        .filter(|s| keep(s))
        .map(|s| f64::from(s.work))
        .sum();
    let total_us: f64 = micros.iter().sum();
    println!(
        "{name},{},{:.2},{:.1},{:.1},{:.1}",
        micros.len(),
        micros[last / 2],
        micros[last * 99 / 100],
        micros[last],
        1e3 * total_us / units.max(1.0)
    );
}

/// Prints the distribution of a quantity.
fn spread(name: &str, mut values: Vec<f64>) {
    values.sort_by(f64::total_cmp);
    let Some(last) = values.len().checked_sub(1) else {
        return;
    };
    println!(
        "{name},{},{:.1},{:.1},{:.1},{:.1}",
        values.len(),
        values[last / 2],
        values[last * 99 / 100],
        values[last * 9999 / 10_000],
        values[last]
    );
}

fn main() {
    // `cargo test --benches` passes no --bench: one encounter of each shows that it runs.
    let quick = !std::env::args().any(|argument| argument == "--bench");
    let clock_us = (0..1000)
        .map(|_| {
            let begun = thread_us();
            thread_us() - begun
        })
        .fold(f64::INFINITY, f64::min);
    println!("aircraft,obstacles,kind,steps,median_us,p99_us,largest_us,ns_a_unit");
    for aircraft in Aircraft::ALL {
        for count in [1, 3, 10, 30, 100] {
            let encounters = if quick {
                1
            } else {
                (ENCOUNTERS / u64::from(count)).max(4)
            };
            let mut samples = Vec::new();
            for number in 0..encounters {
                measure(
                    Encounter::threats(aircraft, count, number),
                    clock_us,
                    &mut samples,
                );
            }
            for kind in Kind::ALL {
                let name = format!("{},{count},{}", aircraft.name(), kind.name());
                report(&name, &samples, |sample| sample.kind == kind);
            }
        }
    }
    let mut all = Vec::new();
    let mut longest = (0, 0, 0);
    for number in 0..if quick { 1 } else { ADVERSARIAL } {
        let mut samples = Vec::new();
        measure(Encounter::adversarial(number), clock_us, &mut samples);
        for sample in &samples {
            longest = longest.max((sample.work, number, sample.cycle));
        }
        all.append(&mut samples);
    }
    println!("adversarial,steps,median,p99,p99.99,largest");
    spread("us", all.iter().map(|sample| sample.micros).collect());
    spread("work", all.iter().map(|s| f64::from(s.work)).collect());
    let (work, number, cycle) = longest;
    println!("most work: {work} units, encounter {number}, cycle {cycle}");
}
