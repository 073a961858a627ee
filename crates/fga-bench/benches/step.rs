//! A decision with threats, over every cycle of flown encounters; one of `dodgy_3d` beside it.
//!
//! Each encounter flies several times and the quickest run of a cycle counts: the flights are
//! the same to the last bit, so only the machine differs. Prints a table and, on lines that
//! begin with `{`, the same as JSON.

extern crate alloc;

use alloc::borrow::Cow;
use core::hint::black_box;
use std::time::Instant;

use dodgy_3d::{Agent, AvoidanceOptions, Vec3 as Single};
use fga::Vec3;
use fga::avoider::{Avoider, Start, State};
use fga::pilot::Pilot;
use fga::situation::Obstacle;

use fga_bench::{fly, ownship, settings, vehicle};
use fga_campaign::encounters::EncounterSource;
use fga_paper::pilot::{PaperPilot, PaperSettings, Rule};

/// Flights of each encounter.
const RUNS: usize = 5;

/// The measurements of one cycle.
#[derive(Clone, Copy)]
struct Sample {
    micros: f64,
    quiet: bool,
    searched: bool,
}

fn flown(obstacles: &[Obstacle], pilot: &mut dyn Pilot) -> Vec<Sample> {
    let mut best: Vec<Sample> = Vec::new();
    for _ in 0..RUNS {
        let mut place = 0;
        fly(obstacles, pilot, |cycle| {
            let begun = Instant::now();
            let decision = cycle.pilot.step(black_box(&cycle.situation));
            let micros = begun.elapsed().as_secs_f64() * 1e6;
            if let Some(sample) = best.get_mut(place) {
                sample.micros = sample.micros.min(micros);
            } else {
                best.push(Sample {
                    micros,
                    quiet: decision.state == State::Cruise,
                    searched: decision.record.work.candidates > 0,
                });
            }
            place += 1;
            decision
        });
    }
    best
}

/// Best of several runs of one step of `dodgy_3d` with the obstacles at the start.
fn dodgy(obstacles: &[Obstacle]) -> f64 {
    #[expect(clippy::cast_possible_truncation, reason = "dodgy_3d takes f32")]
    let single = |v: Vec3| Single::new(v.x as f32, v.y as f32, v.z as f32);
    let own = ownship();
    let velocity = single(own.velocity_mps());
    let agent = Agent {
        position: single(own.position_m),
        velocity,
        radius: 0.0,
        avoidance_responsibility: 1.0,
    };
    #[expect(clippy::cast_possible_truncation, reason = "dodgy_3d takes f32")]
    let others: Vec<Agent> = obstacles
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
    (0..5 * RUNS)
        .map(|_| {
            let begun = Instant::now();
            black_box(agent.compute_avoiding_velocity(
                black_box(&neighbours),
                velocity,
                15.0,
                0.1,
                &options,
            ));
            begun.elapsed().as_secs_f64() * 1e6
        })
        .fold(f64::INFINITY, f64::min)
}

fn report(name: &str, threats: u32, mut micros: Vec<f64>) {
    if micros.is_empty() {
        return;
    }
    micros.sort_by(f64::total_cmp);
    let at = |share: f64| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of a length"
        )]
        let place = (share * micros.len() as f64) as usize;
        let last = micros.len().saturating_sub(1);
        micros.get(place.min(last)).copied().unwrap_or(f64::NAN)
    };
    let mean = micros.iter().sum::<f64>() / micros.len() as f64;
    let (median, p99, max) = (at(0.5), at(0.99), at(1.0));
    println!(
        "{name:34} {threats:>3} threats: median {median:9.2} us, mean {mean:9.2}, p99 {p99:9.1}, \
         max {max:9.1} ({} samples)",
        micros.len()
    );
    println!(
        "{{\"what\":\"{name}\",\"threats\":{threats},\"samples\":{},\"median_us\":{median:.3},\
         \"mean_us\":{mean:.3},\"p99_us\":{p99:.3},\"max_us\":{max:.3}}}",
        micros.len()
    );
}

fn main() {
    // `cargo test --benches` passes --test: one encounter shows that it runs.
    let quick = !std::env::args().any(|argument| argument == "--bench");
    for (threats, encounters) in [(1, 200), (3, 200), (10, 60), (100, 6)] {
        let encounters = if quick { 1 } else { encounters };
        let cell = format!("threats:{threats}:100-500:0-60");
        let source = EncounterSource::parse(&cell, 1).expect("the cell is valid");
        let drawn: Vec<_> = (0..encounters)
            .map(|n| source.encounter(n).unwrap())
            .collect();
        let paper = PaperSettings {
            surveillance_radius_m: f64::INFINITY,
            ..PaperSettings::new(Rule::Corrected(Start::Latest))
        };
        let avoider = Avoider::new(settings(), vehicle()).expect("settings are valid");
        let paper = PaperPilot::new(paper, vehicle()).expect("settings are valid");
        let pilots: [(&str, Box<dyn Pilot>); 2] = [
            ("turn-aware", Box::new(avoider)),
            ("published", Box::new(paper)),
        ];
        for (name, mut pilot) in pilots {
            let samples: Vec<Sample> = drawn
                .iter()
                .flat_map(|encounter| flown(&encounter.obstacles, &mut *pilot))
                .collect();
            let of = |keep: fn(&Sample) -> bool| -> Vec<f64> {
                samples
                    .iter()
                    .filter(|s| keep(s))
                    .map(|s| s.micros)
                    .collect()
            };
            report(&format!("{name}, every cycle"), threats, of(|_| true));
            report(&format!("{name}, in conflict"), threats, of(|s| !s.quiet));
            report(&format!("{name}, searching"), threats, of(|s| s.searched));
        }
        let peer = drawn.iter().map(|e| dodgy(&e.obstacles)).collect();
        report("dodgy_3d, one step", threats, peer);
    }
}
