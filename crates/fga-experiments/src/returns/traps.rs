//! Walls of masts: does every aircraft come out of a trap and to the end of its mission?
//!
//! A U of masts without gaps that is open to the aircraft, a ring of masts around a waypoint, closed or with a gap, and one to three
//! masts in a wind of 0.9 of the airspeed. No aircraft climbs over a mast. The judge of `returns` looks on.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "drawn numbers are small and not negative"
)]

use core::f64::consts::{FRAC_PI_2, TAU};
use core::ops::Range;

use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga::vehicle::{Response, Vehicle};
use rayon::prelude::*;

use super::draw::{ReturnFlight, Straight};
use super::flier::Flier;
use super::{ReturnCount, ReturnsArgs};
use crate::intruders::traffic::SplitMix64;

/// Length of a leg, metres.
const LEG_M: f64 = 1500.0;

/// Distance between two masts of a wall, as a multiple of their radius.
const SPACING: f64 = 1.3;

/// Most distances between the masts of a wall.
const MOST: f64 = 40.0;

/// Half of the height of a mast, metres.
const HALF_HEIGHT_M: f64 = 500.0;

/// Flight time beyond the mission's, seconds.
const LATE_S: f64 = 1200.0;

/// What stands in the way.
#[derive(Debug, Clone, Copy)]
enum Trap {
    /// A wall across the leg with arms towards the aircraft.
    U,
    /// A ring around a waypoint, with a gap.
    OpenShell,
    /// A closed ring around a waypoint.
    Shell,
    /// One to three masts, in a wind of 0.9 of the airspeed.
    Wind,
}

const TRAPS: [(&str, Trap); 4] = [
    ("U-trap", Trap::U),
    ("open shell", Trap::OpenShell),
    ("closed shell", Trap::Shell),
    ("masts in a wind of 0.9", Trap::Wind),
];

fn drawn(trap: Trap, (seed, number): (u64, u64)) -> ReturnFlight {
    let mut random = SplitMix64::of(seed, number);
    let airspeed_mps = random.within(12.0, 25.0);
    let bank_rad = random.within(0.45, 0.85);
    let lag_s = if random.unit() < 0.5 { 0.0 } else { 0.5 };
    let vehicle = Vehicle {
        airspeed_mps,
        turn_radius_m: airspeed_mps * airspeed_mps / (9.80665 * libm::tan(bank_rad)),
        climb_min_rad: -0.15,
        climb_max_rad: 0.15,
        climb_rate_radps: 0.2,
        response: Response {
            bank_time_constant_s: lag_s,
            ..Response::default()
        },
    };
    let wind = match trap {
        Trap::Wind => 0.9,
        _ => random.within(0.0, 0.4),
    };
    let (sin, cos) = libm::sincos(random.within(0.0, TAU));
    let wind_mps = Vec3::new(cos, sin, 0.0) * (airspeed_mps * wind);
    let radius_m = random.within(15.0, 40.0);
    let surveillance_m = if random.unit() < 0.5 { 1000.0 } else { 3000.0 };
    let mut flight = ReturnFlight::empty(vehicle, wind_mps, (radius_m, surveillance_m));
    let mission_m: Vec<Vec3> = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.3]]
        .map(|[x, y]| Vec3::new(LEG_M * x, LEG_M * y, 100.0))
        .to_vec();
    let turn_m = vehicle.turn_radius_m;
    let masts_m = match trap {
        Trap::U => {
            let longest_m = MOST * SPACING * radius_m;
            let half_m = f64::min(turn_m * random.within(3.0, 8.0), 0.5 * longest_m);
            let depth_m = f64::min(turn_m * random.within(0.0, 8.0), longest_m);
            let wall_m = Vec3::new(LEG_M * random.within(0.4, 0.7), 0.0, 0.0);
            let corners = [-1.0, 1.0].map(|side| wall_m + Vec3::new(0.0, side * half_m, 0.0));
            let ends = corners.map(|corner| corner - Vec3::new(depth_m, 0.0, 0.0));
            let mut masts_m = Vec::new();
            for (from, to) in [
                (corners[0], corners[1]),
                (corners[0], ends[0]),
                (corners[1], ends[1]),
            ] {
                let count = (from.distance(to) / (SPACING * radius_m)).ceil().max(1.0);
                masts_m.extend((0..=count as u32).map(|k| from.lerp(to, f64::from(k) / count)));
            }
            masts_m
        }
        Trap::OpenShell | Trap::Shell => {
            let ring_m = turn_m * random.within(2.0, 4.0) + radius_m;
            let gap = match trap {
                Trap::Shell => 0.0,
                _ => FRAC_PI_2,
            };
            let middle_m = mission_m[if random.unit() < 0.5 { 1 } else { 2 }];
            let from_rad = random.within(0.0, TAU);
            let step_rad = SPACING * radius_m / ring_m;
            (0..120)
                .map(|k| f64::from(k) * step_rad)
                .take_while(|turned| *turned < TAU - gap)
                .map(|turned| {
                    let (sin, cos) = libm::sincos(from_rad + turned);
                    middle_m + Vec3::new(cos, sin, 0.0) * ring_m
                })
                .collect()
        }
        Trap::Wind => (0..=(3.0 * random.unit()) as u32)
            .map(|_| {
                let aside_m = radius_m * random.within(-1.0, 1.0);
                Vec3::new(LEG_M * random.within(0.3, 0.7), aside_m, 0.0)
            })
            .collect(),
    };
    let volume = ProtectedVolume::Cylinder {
        radius_m,
        half_height_m: HALF_HEIGHT_M,
    };
    flight.others = (0..)
        .zip(masts_m)
        .map(|(id, place_m)| Straight::standing(id, place_m, volume))
        .collect();
    flight.until_s = LATE_S + 6.0 * LEG_M / (airspeed_mps * (1.0 - wind));
    flight
        .fliers
        .extend(Flier::new(mission_m, (&vehicle, wind_mps), surveillance_m));
    flight
}

fn counted(trap: Trap, seed: u64, numbers: Range<u64>, shows: bool) -> ReturnCount {
    numbers
        .into_par_iter()
        .map(|number| drawn(trap, (seed, number)).fly(number, shows))
        .reduce(ReturnCount::default, ReturnCount::and)
}

/// Runs the experiment.
pub(crate) fn run(args: &ReturnsArgs) {
    let numbers = match args.only {
        Some(number) => number..number + 1,
        None => 0..args.drawn.count,
    };
    for (name, trap) in TRAPS {
        let count = counted(trap, args.drawn.seed, numbers.clone(), args.only.is_some());
        println!("{}", count.row(name));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Around a waypoint within a ring of masts the aircraft once circled for ever (seed 1, 8 and 22).
    #[test]
    fn behind_walls_of_masts_every_mission_ends_or_its_waypoint_is_given_up() {
        for (name, trap) in TRAPS {
            let count = counted(trap, 1, 0..24, false);
            let faults = [
                &count.stuck,
                &count.strayed,
                &count.open,
                &count.end_missed,
                &count.low,
            ];
            let is_flown = faults.iter().all(|numbers| numbers.is_empty()) && count.entered == 0;
            assert!(is_flown, "{}", count.row(name));
            assert!(
                count.given_up >= count.kept_off.len(),
                "{}",
                count.row(name)
            );
        }
    }
}
