//! `fga-instructions AIRCRAFT COUNT KIND TIMES`: the first steps of a kind in drawn encounters, each made so many times.
//!
//! With KIND `none` it flies the same encounters and repeats nothing: what it takes is what the others take beside
//! the steps.

#[path = "../../../crates/fga-bench/src/cycles.rs"]
mod cycles;

use std::hint::black_box;
use std::process::ExitCode;

use cycles::{Aircraft, Encounter, Kind};

/// Encounters that are flown.
const ENCOUNTERS: u64 = 6;

/// Steps of a kind that are repeated, one an encounter.
const STEPS: u32 = 4;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [aircraft, count, kind, times] = &arguments[..] else {
        eprintln!("usage: fga-instructions AIRCRAFT COUNT KIND TIMES");
        return ExitCode::FAILURE;
    };
    let aircraft = Aircraft::ALL.into_iter().find(|a| a.name() == aircraft);
    let kind = Kind::ALL.into_iter().find(|k| k.name() == kind);
    let (Some(aircraft), Ok(count), Ok(times)) = (aircraft, count.parse(), times.parse::<u32>())
    else {
        eprintln!("unknown aircraft or number");
        return ExitCode::FAILURE;
    };
    let mut steps = 0;
    for number in 0..ENCOUNTERS {
        let mut is_taken = steps >= STEPS;
        Encounter::threats(aircraft, count, number).fly(|before, situation, decision| {
            if is_taken || Some(Kind::of(decision)) != kind {
                return;
            }
            is_taken = true;
            steps += 1;
            for _ in 0..times {
                let mut avoider = before.clone();
                black_box(avoider.step(black_box(situation)));
            }
        });
    }
    println!("{steps}");
    ExitCode::SUCCESS
}
