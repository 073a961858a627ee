//! `fga-instructions AIRCRAFT COUNT KIND TIMES`: the first step of a kind in drawn encounters, repeated TIMES times.

#[expect(dead_code, reason = "the benches use the rest of it")]
#[path = "../../../crates/fga-bench/src/cycles.rs"]
mod cycles;

use std::hint::black_box;
use std::process::ExitCode;

use cycles::{Aircraft, Encounter, Kind};

/// Most times that a step is made.
const COPIES: u32 = 5;

/// Most encounters that are flown to find one.
const ENCOUNTERS: u64 = 6;

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
        if steps > 0 {
            break;
        }
        Encounter::threats(aircraft, count, number).fly(|before, situation, decision| {
            if Some(Kind::of(decision)) != kind {
                return false;
            }
            steps += 1;
            // As many copies of the avoider whatever is made of them.
            for copy in 0..COPIES {
                let mut avoider = black_box(before.clone());
                if copy < times {
                    black_box(avoider.step(black_box(situation)));
                }
            }
            true
        });
    }
    println!("{steps}");
    ExitCode::SUCCESS
}
