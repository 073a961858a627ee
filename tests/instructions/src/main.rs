//! `fga-instructions AIRCRAFT COUNT KIND TIMES`: the first step of a kind in drawn encounters, repeated TIMES times; prints the
//! number of steps and their work.
//! `fga-instructions adversarial NUMBER CYCLE TIMES`: one step of an adversarial encounter. `fga-instructions adversarial
//! NUMBER` prints the work of each of its steps.

#[path = "../../../crates/fga-bench/src/cycles.rs"]
#[expect(dead_code, reason = "the tests of the core use the rest")]
mod cycles;

use std::hint::black_box;
use std::process::ExitCode;

use fga::avoider::Avoider;
use fga::situation::Situation;

use cycles::{BenchAircraft, BenchEncounter, StepKind};

/// Most times that a step is made.
const COPIES: u32 = 5;

/// Most encounters that are flown to find one.
const ENCOUNTERS: u64 = 6;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [first, rest @ ..] = &arguments[..]
        && first == "adversarial"
    {
        return adversarial(rest);
    }
    let [aircraft, count, kind, times] = &arguments[..] else {
        eprintln!("usage: fga-instructions AIRCRAFT COUNT KIND TIMES");
        return ExitCode::FAILURE;
    };
    let aircraft = BenchAircraft::ALL.into_iter().find(|a| a.name() == aircraft);
    let kind = StepKind::ALL.into_iter().find(|k| k.name() == kind);
    let (Some(aircraft), Ok(count), Ok(times)) = (aircraft, count.parse(), times.parse::<u32>())
    else {
        eprintln!("unknown aircraft or number");
        return ExitCode::FAILURE;
    };
    let (mut steps, mut work) = (0, 0);
    for number in 0..ENCOUNTERS {
        if steps > 0 {
            break;
        }
        BenchEncounter::threats(aircraft, count, number).fly(|before, situation, decision| {
            if Some(StepKind::of(decision)) != kind {
                return false;
            }
            steps += 1;
            work += decision.record.work.work;
            repeat(before, situation, times);
            true
        });
    }
    println!("{steps} {work}");
    ExitCode::SUCCESS
}

/// Makes a step several times.
fn repeat(before: &Avoider, situation: &Situation<'_>, times: u32) {
    // As many copies of the avoider whatever is made of them.
    for copy in 0..COPIES {
        let mut avoider = black_box(before.clone());
        if copy < times {
            black_box(avoider.step(black_box(situation)));
        }
    }
}

/// One step of an adversarial encounter, or the work of all of them.
fn adversarial(arguments: &[String]) -> ExitCode {
    let numbers: Option<Vec<u32>> = arguments.iter().map(|text| text.parse().ok()).collect();
    let (number, step) = match numbers.as_deref() {
        Some([number]) => (*number, None),
        Some([number, cycle, times]) => (*number, Some((*cycle, *times))),
        _ => {
            eprintln!("usage: fga-instructions adversarial NUMBER [CYCLE TIMES]");
            return ExitCode::FAILURE;
        }
    };
    let mut now = 0;
    BenchEncounter::adversarial(number.into()).fly(|before, situation, decision| {
        match step {
            None => println!("{number},{now},{}", decision.record.work.work),
            Some((cycle, times)) if cycle == now => {
                repeat(before, situation, times);
                return true;
            }
            Some(_) => {}
        }
        now += 1;
        false
    });
    ExitCode::SUCCESS
}
