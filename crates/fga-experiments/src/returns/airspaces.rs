//! Airspaces in which every aircraft flies fga: does anybody enter a volume, and does everybody come to the end of the mission?
//!
//! Aircraft with missions at random in a square, and aircraft that meet exactly symmetrically: each as far from the middle, each
//! through the middle to the other side. Extra path is measured against the same mission flown alone.

use fga::Vec3;
use rayon::prelude::*;

use super::draw::ReturnFlight;
use super::flier::Flier;
use crate::common::{DrawnArgs, model};
use crate::intruders::traffic::SplitMix64;

/// Radius of every protected sphere, metres.
const RADIUS_M: f64 = 30.0;

/// How far an aircraft sees others, metres.
const SURVEILLANCE_M: f64 = 1000.0;

/// Flight time of a mission at random, seconds.
const MISSION_S: f64 = 1200.0;

/// Time for what a mission takes longer, seconds.
const LATE_S: f64 = 600.0;

/// Aircraft, and the side of their square, metres.
const SQUARES: [(usize, f64); 3] = [(12, 2000.0), (20, 2500.0), (50, 4000.0)];

/// Distances of symmetric aircraft from the middle, metres.
const RINGS_M: [f64; 3] = [300.0, 500.0, 900.0];

/// What happened in airspaces of one kind.
#[derive(Default, Clone, Copy)]
struct Sum {
    aircraft: usize,
    entered: usize,
    open: usize,
    extra: f64,
    avoided: u32,
    reversals: u32,
    most: u32,
}

impl Sum {
    fn and(self, other: Self) -> Self {
        Self {
            aircraft: self.aircraft + other.aircraft,
            entered: self.entered + other.entered,
            open: self.open + other.open,
            extra: self.extra + other.extra,
            avoided: self.avoided + other.avoided,
            reversals: self.reversals + other.reversals,
            most: self.most.max(other.most),
        }
    }
}

/// An airspace of aircraft with missions, in the plane or in space.
fn airspace(missions_m: &[Vec<Vec3>], is_planar: bool) -> Result<ReturnFlight, String> {
    let vehicle = model(is_planar)?.vehicle;
    let mut flight = ReturnFlight::empty(vehicle, Vec3::ZERO, (RADIUS_M, SURVEILLANCE_M));
    flight.until_s = MISSION_S + LATE_S;
    for mission_m in missions_m {
        let air = (&flight.vehicle, Vec3::ZERO);
        (flight.fliers).extend(Flier::new(mission_m.clone(), air, SURVEILLANCE_M));
    }
    Ok(flight)
}

fn fly(missions_m: &[Vec<Vec3>], is_planar: bool) -> Result<Sum, String> {
    let mut together = airspace(missions_m, is_planar)?;
    together.fly_on(false);
    let mut sum = Sum::default();
    for (flier, mission_m) in together.fliers.iter().zip(missions_m) {
        let mut alone = airspace(core::slice::from_ref(mission_m), is_planar)?;
        alone.fly_on(false);
        let alone_m = alone.fliers.first().map_or(f64::NAN, |flier| flier.flown_m);
        sum = sum.and(Sum {
            aircraft: 1,
            entered: usize::from(flier.has_entered),
            open: usize::from(!flier.is_complete),
            extra: flier.flown_m / alone_m - 1.0,
            avoided: flier.avoided,
            reversals: flier.reversals.count,
            most: flier.reversals.count,
        });
    }
    Ok(sum)
}

/// Waypoints at random in a square, far enough from those of the others at the beginning.
fn in_square(
    random: &mut SplitMix64,
    (count, side_m): (usize, f64),
    is_planar: bool,
) -> Result<Vec<Vec<Vec3>>, String> {
    let length_m = MISSION_S * model(is_planar)?.vehicle.airspeed_mps;
    let mut missions_m: Vec<Vec<Vec3>> = Vec::new();
    while missions_m.len() < count {
        let mut place_m = || {
            let z_m = if is_planar {
                100.0
            } else {
                random.within(80.0, 120.0)
            };
            Vec3::new(side_m * random.unit(), side_m * random.unit(), z_m)
        };
        let mut mission_m = vec![place_m()];
        let mut left_m = length_m;
        while left_m > 0.0 {
            let next_m = place_m();
            let leg_m = mission_m[mission_m.len() - 1].distance(next_m);
            if leg_m > 400.0 {
                mission_m.push(next_m);
                left_m -= leg_m;
            }
        }
        let is_apart = |other: &Vec<Vec3>| other[0].distance(mission_m[0]) > 6.0 * RADIUS_M;
        if missions_m.iter().all(is_apart) {
            missions_m.push(mission_m);
        }
    }
    Ok(missions_m)
}

/// Missions through the middle of a ring.
fn symmetric(count: usize, ring_m: f64) -> Vec<Vec<Vec3>> {
    let place_m = |turns: f64| {
        let (sin, cos) = libm::sincos(core::f64::consts::TAU * turns);
        Vec3::new(ring_m * cos, ring_m * sin, 100.0)
    };
    (0..count)
        .map(|k| k as f64 / count as f64)
        .map(|turns| vec![place_m(turns), place_m(turns + 0.5)])
        .collect()
}

fn print(name: &str, is_planar: bool, sum: &Sum) {
    let space = if is_planar { "planar" } else { "in space" };
    let each = |count: f64| count / sum.aircraft as f64;
    println!(
        "{name}, {space}: {} aircraft, {} entered a volume, {} not at the end of the mission, extra path {:.1} %; each avoided {:.1} times \
         and changed the side {:.1} times, {} times at most",
        sum.aircraft,
        sum.entered,
        sum.open,
        each(100.0 * sum.extra),
        each(f64::from(sum.avoided)),
        each(f64::from(sum.reversals)),
        sum.most
    );
}

/// Runs the experiment.
pub(crate) fn run(args: &DrawnArgs) -> Result<(), String> {
    let and = |a: Sum, b: Sum| Ok(a.and(b));
    for is_planar in [true, false] {
        for (count, side_m) in SQUARES {
            let sum = (0..args.count)
                .into_par_iter()
                .map(|number| {
                    let mut random = SplitMix64::of(args.seed, number);
                    let missions_m = in_square(&mut random, (count, side_m), is_planar)?;
                    fly(&missions_m, is_planar)
                })
                .try_reduce(Sum::default, and)?;
            print(&format!("{count} in {side_m} m"), is_planar, &sum);
        }
        for count in 2..=8 {
            let sum = RINGS_M
                .par_iter()
                .map(|ring_m| fly(&symmetric(count, *ring_m), is_planar))
                .try_reduce(Sum::default, and)?;
            print(&format!("{count} symmetric"), is_planar, &sum);
        }
    }
    Ok(())
}
