//! From telemetry in to command out, with 200 tracked aircraft, in the companion itself.
//!
//! Prints the distribution; asserts nothing about time (a loaded machine says nothing). To measure:
//! `cargo test --release -p fga-link --test link -- --nocapture latency::`.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "an index into a list of times"
)]

use std::time::Instant;

use crate::common::{GOOD, Intruder, Random, World};
use fga_link::authority::Authority;

#[test]
fn telemetry_to_command_with_200_aircraft() {
    let mut world = World::new("[command]\nrate_hz = 50.0\n", GOOD, 9);
    let mut random = Random::new(4);
    for n in 0..200_u32 {
        let angle = random.uniform(0.0, core::f64::consts::TAU);
        let range_m = random.uniform(300.0, 2900.0);
        let track = random.uniform(0.0, core::f64::consts::TAU);
        // Half of them at other heights, as traffic is.
        let height_m = 100.0
            + if n % 2 == 0 {
                0.0
            } else {
                random.uniform(150.0, 900.0)
            };
        world.add(Intruder::straight(
            0x0030_0000 + n,
            [
                range_m * angle.sin(),
                1500.0 + range_m * angle.cos(),
                height_m,
            ],
            [30.0 * track.sin(), 30.0 * track.cos(), 0.0],
        ));
    }
    let mut times_us: Vec<f64> = Vec::new();
    let mut engaged = 0_u32;
    while world.time_s < 60.0 {
        let before = Instant::now();
        world.step();
        if world.time_s > 8.0 {
            times_us.push(before.elapsed().as_secs_f64() * 1e6);
            engaged += u32::from(matches!(
                world.companion.authority(),
                Authority::InCommand { .. }
            ));
        }
    }
    assert!(world.companion.tracks().tracks().len() >= 190);
    times_us.sort_by(f64::total_cmp);
    let at = |share: f64| times_us[((times_us.len() - 1) as f64 * share) as usize];
    eprintln!(
        "{} steps of 20 ms, {} in command: median {:.0} us, 99 % {:.0} us, 99.9 % {:.0} us, largest {:.0} us (emulator and 400 reports a second included)",
        times_us.len(),
        engaged,
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0)
    );
}
