//! Repeats one piece of work, for counting instructions.
//!
//! `valgrind --tool=none` or `callgrind` over `instructions detect|columns COUNT TIMES`: the
//! difference between two numbers of TIMES, divided by it, is the cost of one piece.

use core::hint::black_box;
use std::process::ExitCode;

use fga::Vec3;
use fga::avoider::Avoider;
use fga::situation::{Mission, Obstacles, Situation};
use fga_bench::{Crowd, ownship, settings, vehicle};
use fga_paper::conflict::detect;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |place: usize| arguments.get(place).and_then(|text| text.parse().ok());
    let (Some(what), Some(count), Some(times)) = (arguments.first(), number(1), number(2)) else {
        eprintln!("usage: instructions detect|columns COUNT TIMES");
        return ExitCode::FAILURE;
    };
    let times: usize = times;
    let crowd = Crowd::in_the_clear(count, 1);
    let waypoints = [Vec3::ZERO, Vec3::X * 1e5];
    let hazards = crowd.hazards();
    let mut avoider = Avoider::new(settings(), vehicle()).expect("settings are valid");
    let situation = Situation {
        time_s: 0.0,
        ownship: ownship(),
        obstacles: Obstacles::Columns(crowd.columns()),
        mission: Mission::new(&waypoints),
        wind_mps: Vec3::ZERO,
    };
    for _ in 0..times {
        if what == "detect" {
            let own = ownship();
            let found = detect(black_box(&own), black_box(&hazards), f64::INFINITY);
            black_box(found.count());
        } else {
            black_box(avoider.step(black_box(&situation)));
        }
    }
    ExitCode::SUCCESS
}
