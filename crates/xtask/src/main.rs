//! Chores of the repository, as `cargo xtask CHORE`.
//!
//! | chore | what it does |
//! |---|---|
//! | `bytes` | prints the hash of every result that a refactoring must not change, or compares two builds |
//! | `cortex-m` | flies ten encounters on an emulated Cortex-M7, and compares memory and instructions with a committed table |
//! | `dist` | makes what a release consists of: archives, the Python package, their parts, checksums |
//! | `evidence` | makes the counts of the pages again, whole or a small part |
//! | `house` | counts lines, tuned constants, circles and double names of every crate and compares them with a committed table |
//! | `instructions` | counts the instructions of a step and compares them with a committed table |
//! | `mutants` | changes the code that decides about the mode, piece by piece, and names changes that no test notices |
//! | `pictures` | makes every picture of README and docs from real runs |

extern crate alloc;

mod bytes;
mod command;
mod cortex_m;
mod counts;
mod dist;
mod evidence;
mod house;
mod instructions;
mod mutants;
mod pictures;
mod table;

use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let done = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["bytes", ref options @ ..] => bytes::print(options),
        ["cortex-m", ref options @ ..] => cortex_m::check(options),
        ["dist", ref options @ ..] => dist::make(options),
        ["evidence", ref options @ ..] => evidence::make(options),
        ["house", ref options @ ..] => house::check(options),
        ["instructions", ref options @ ..] => instructions::check(options),
        ["mutants"] => mutants::check(),
        ["pictures"] => pictures::make(),
        _ => Err(
            "expected cargo xtask bytes, cortex-m, dist, evidence, house, instructions, mutants or pictures"
                .to_owned(),
        ),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::FAILURE
        }
    }
}
