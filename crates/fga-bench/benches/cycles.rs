//! Time of a step by kind: quiet, kept, choosing, searching, hopeless; by aircraft and number of
//! obstacles; and of the longest steps that we could construct.
//!
//! Processor time of the thread, each step the quickest of several from the same state, without the time of reading the clock. Prints rows
//! of CSV: aircraft, obstacles, kind, steps, median, 99 %, largest in microseconds, and nanoseconds per unit of work. The
//! adversarial set follows: microseconds and units of work, with 99.99 %, the longest steps, and the step with the most
//! work, which `tests/instructions` counts. With the argument `adversarial` it runs alone:
//! `cargo bench -p fga-bench --bench cycles -- adversarial`.

mod clock;

use core::hint::black_box;

use clock::{quickest_us, reading_us};
use fga_bench::cycles::{BenchAircraft, BenchEncounter, StepKind};

/// Repetitions of each step.
const RUNS: usize = 5;

/// Encounters with one obstacle; fewer with more.
const ENCOUNTERS: u64 = 40;

/// Longest steps of the adversarial set that are listed.
const LISTED: usize = 5;

/// Encounters of the adversarial set.
const ADVERSARIAL: u64 = 40;

/// The measured step.
struct Sample {
    kind: StepKind,
    cycle: usize,
    micros: f64,
    work: u32,
}

fn measure(encounter: BenchEncounter, clock_us: f64, samples: &mut Vec<Sample>) {
    let first = samples.len();
    encounter.fly(|before, situation, decision| {
        samples.push(Sample {
            kind: StepKind::of(decision),
            cycle: samples.len() - first,
            micros: quickest_us(
                RUNS,
                clock_us,
                || before.clone(),
                |avoider| avoider.step(black_box(situation)),
            ),
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
    let asked = |word: &str| std::env::args().any(|argument| argument == word);
    // `cargo test --benches` passes no --bench: one encounter of each shows that it runs.
    let quick = !asked("--bench");
    let clock_us = reading_us();
    if !asked("adversarial") {
        drawn(quick, clock_us);
    }
    adversarial(quick, clock_us);
}

/// The kinds of steps in drawn encounters.
fn drawn(quick: bool, clock_us: f64) {
    println!("aircraft,obstacles,kind,steps,median_us,p99_us,largest_us,ns_a_unit");
    for aircraft in BenchAircraft::ALL {
        for count in [1, 3, 10, 30, 100] {
            let encounters = if quick {
                1
            } else {
                (ENCOUNTERS / u64::from(count)).max(4)
            };
            let mut samples = Vec::new();
            for number in 0..encounters {
                measure(
                    BenchEncounter::threats(aircraft, count, number),
                    clock_us,
                    &mut samples,
                );
            }
            for kind in StepKind::ALL {
                let name = format!("{},{count},{}", aircraft.name(), kind.name());
                report(&name, &samples, |sample| sample.kind == kind);
            }
        }
    }
}

/// The slowest steps that we could construct.
fn adversarial(quick: bool, clock_us: f64) {
    let mut all = Vec::new();
    for number in 0..if quick { 1 } else { ADVERSARIAL } {
        let mut samples = Vec::new();
        measure(BenchEncounter::adversarial(number), clock_us, &mut samples);
        all.extend(samples.into_iter().map(|sample| (number, sample)));
    }
    println!("adversarial,steps,median,p99,p99.99,largest");
    spread("us", all.iter().map(|(_, sample)| sample.micros).collect());
    let work = |(_, sample): &(u64, Sample)| f64::from(sample.work);
    spread("work", all.iter().map(work).collect());
    all.sort_by(|(_, a), (_, b)| b.micros.total_cmp(&a.micros));
    println!("longest,encounter,cycle,kind,us,work");
    for (place, (number, sample)) in (1..=LISTED).zip(&all) {
        println!(
            "{place},{number},{},{},{:.1},{}",
            sample.cycle,
            sample.kind.name(),
            sample.micros,
            sample.work
        );
    }
    let most = all
        .iter()
        .max_by_key(|(number, s)| (s.work, *number, s.cycle));
    if let Some((number, Sample { work, cycle, .. })) = most {
        println!("most work: {work} units, encounter {number}, cycle {cycle}");
    }
}
