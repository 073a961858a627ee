//! Is what a record claims true?
//!
//! `docs/real-intruders.md` says what a resilience of r proves. At a drawn moment of an encounter among one, three or eight aircraft
//! each of them does exactly one of the motions that r covers, and the aircraft flies what it flies now, for the whole horizon. The
//! judge is this file: it integrates the intruders and measures distances at instants.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "drawn numbers are small and not negative"
)]

use fga::Vec3;
use fga::avoider::{Avoider, Settings, State};
use fga::situation::{Mission, Movement, Obstacle, Obstacles, ProtectedVolume, Situation};
use fga::vehicle::{Response, Vehicle};
use fga_sim::plant::{Autopilot, Plant};
use rayon::prelude::*;

use crate::common::{DrawnArgs, HORIZON_S, PERIOD_S};
use crate::intruders::traffic::SplitMix64;

/// Time between two instants of the judge, seconds.
const INSTANT_S: f64 = 0.05;

/// Longest time before the drawn moment, seconds.
const LONGEST_S: f64 = 90.0;

/// A change of climb lasts this long, seconds.
const CLIMBS_S: f64 = 20.0;

const RADIUS_M: f64 = 30.0;

/// Numbers of aircraft.
const COUNTS: [usize; 3] = [1, 3, 8];

/// What came of encounters.
#[derive(Debug, Default, Clone)]
struct Outcomes {
    /// Decisions that claimed a resilience.
    claimed: u32,
    /// Of these, the encounters in which an aircraft was entered: their numbers, and by how much, metres.
    entered: Vec<(u64, f64)>,
    /// Encounters in which some aircraft counted as flying straight on.
    straight: u32,
}

impl Outcomes {
    fn and(mut self, other: Self) -> Self {
        self.entered.extend(other.entered);
        Self {
            claimed: self.claimed + other.claimed,
            entered: self.entered,
            straight: self.straight + other.straight,
        }
    }
}

/// An aircraft that meets the mission after some time.
fn drawn(random: &mut SplitMix64, id: u32, planar: bool, airspeed_mps: f64) -> Obstacle {
    let meets_s = random.within(15.0, 50.0);
    let meets_m = Vec3::new(
        airspeed_mps * meets_s,
        random.within(-20.0, 20.0),
        if planar {
            0.0
        } else {
            random.within(-20.0, 20.0)
        },
    );
    let (sin, cos) = libm::sincos(random.within(0.0, core::f64::consts::TAU));
    let is_crewed = random.unit() < 0.5;
    let speed_mps = if is_crewed {
        random.within(25.0, 60.0)
    } else {
        random.within(10.0, 25.0)
    };
    let climb_mps = if planar {
        0.0
    } else {
        random.within(-2.0, 2.0)
    };
    let velocity_mps = Vec3::new(speed_mps * cos, speed_mps * sin, climb_mps);
    let volume = ProtectedVolume::Sphere { radius_m: RADIUS_M };
    Obstacle {
        movement: if is_crewed {
            Movement::CREWED
        } else {
            Movement::SMALL_UAS
        },
        ..Obstacle::straight(id, meets_m - velocity_mps * meets_s, velocity_mps, volume)
    }
}

/// One of the motions that a share of the bounds covers: turn rate, its duration, and the change of climb, which is 1.4 times
/// the share of its bound.
fn motion(
    random: &mut SplitMix64,
    obstacle: &Obstacle,
    share: f64,
    planar: bool,
) -> (f64, f64, f64) {
    let Some(bounds) = obstacle.movement.bounds() else {
        return (0.0, 0.0, 0.0);
    };
    let side = [-1.0, 0.0, 1.0][(3.0 * random.unit()) as usize];
    let climb_mps = if planar {
        0.0
    } else {
        1.4 * share * bounds.climb_change_mps * random.within(-1.0, 1.0)
    };
    (
        side * bounds.turn_rate_radps,
        share * bounds.turn_rad / bounds.turn_rate_radps,
        climb_mps,
    )
}

/// The least distance of the aircraft, which flies its command for a time, from intruders that each turn at a rate for a time and
/// climb, metres.
fn least_m(
    plant: &mut Plant,
    intruders: &mut [Obstacle],
    motions: &[(f64, f64, f64)],
    horizon_s: f64,
) -> f64 {
    let mut least_m = f64::INFINITY;
    // Counted, so that no rounding adds an instant: nothing is claimed beyond the horizon.
    for instant in 0..(horizon_s / INSTANT_S).round() as u32 {
        let at_s = f64::from(instant) * INSTANT_S;
        plant.advance(INSTANT_S, |_, _| ());
        for (intruder, (rate_radps, turns_s, climb_mps)) in intruders.iter_mut().zip(motions) {
            let turned_s = (turns_s - at_s).clamp(0.0, INSTANT_S);
            let half_rad = 0.5 * rate_radps * turned_s;
            let turn = |velocity_mps: Vec3| {
                let (sin, cos) = libm::sincos(half_rad);
                Vec3::new(
                    cos * velocity_mps.x - sin * velocity_mps.y,
                    sin * velocity_mps.x + cos * velocity_mps.y,
                    velocity_mps.z,
                )
            };
            let middle_mps = turn(intruder.velocity_mps);
            let climbs_mps = if at_s < CLIMBS_S { *climb_mps } else { 0.0 };
            intruder.position_m += (middle_mps + Vec3::Z * climbs_mps) * INSTANT_S;
            intruder.velocity_mps = turn(middle_mps);
            let distance_m = intruder.position_m.distance(plant.ownship().position_m);
            least_m = least_m.min(distance_m);
        }
    }
    least_m
}

fn fly(seed: u64, number: u64, aircraft: usize, planar: bool) -> Outcomes {
    let stream = seed
        .wrapping_mul(0x9e37_79b9)
        .wrapping_add(number)
        .wrapping_mul(16)
        + aircraft as u64;
    let mut random = SplitMix64(stream << 8 | u64::from(planar));
    let climb_rad = if planar { 0.0 } else { 0.26 };
    let vehicle = Vehicle {
        airspeed_mps: 15.0,
        turn_radius_m: 30.0,
        climb_min_rad: -climb_rad,
        climb_max_rad: climb_rad,
        climb_rate_radps: 0.2,
        response: Response::default(),
    };
    let settings = Settings {
        surveillance_radius_m: f64::INFINITY,
        ..Settings::default()
    };
    let mut avoider = Avoider::new(settings, vehicle).expect("usable settings");
    let mut plant = Plant::new(vehicle, Autopilot::Direct, Vec3::ZERO);
    plant.place(0.0, Vec3::ZERO, 0.0, 0.0);
    let mut intruders: Vec<Obstacle> = (0..)
        .zip(0..aircraft)
        .map(|(id, _)| drawn(&mut random, id, planar, vehicle.airspeed_mps))
        .collect();
    if intruders
        .iter()
        .any(|intruder| intruder.position_m.length() < 3.0 * RADIUS_M)
    {
        return Outcomes::default();
    }
    let waypoints_m = [Vec3::ZERO, Vec3::new(1e5, 0.0, 0.0)];
    let mut count = Outcomes::default();
    // The moment: after this number of decisions that claim something.
    let mut left = (random.unit() * random.unit() * 150.0) as u32;
    let mut step = 0_u32;
    while f64::from(step) * PERIOD_S < LONGEST_S {
        let time_s = f64::from(step) * PERIOD_S;
        let decision = avoider.step(&Situation {
            time_s,
            ownship: plant.ownship(),
            obstacles: Obstacles::Rows(&intruders),
            mission: Mission::new(&waypoints_m),
            wind_mps: Vec3::ZERO,
        });
        count.straight = count
            .straight
            .max(u32::from(decision.record.straight_aircraft > 0));
        if let Some(share) = decision
            .record
            .resilience
            .filter(|_| decision.state == State::Avoiding)
        {
            if left == 0 {
                count.claimed = 1;
                let motions: Vec<_> = intruders
                    .iter()
                    .map(|one| motion(&mut random, one, share, planar))
                    .collect();
                plant.command(&decision.command, HORIZON_S);
                // Of a kept manoeuvre a little less than the horizon is proven.
                let certified = decision.command.certified();
                let until_s = certified.map_or(0.0, |certified| certified.horizon_s);
                let until_s = until_s.min(HORIZON_S);
                let least_m = least_m(&mut plant, &mut intruders, &motions, until_s);
                if least_m < RADIUS_M {
                    count.entered.push((number, RADIUS_M - least_m));
                }
                return count;
            }
            left -= 1;
        }
        plant.command(&decision.command, PERIOD_S);
        plant.advance(PERIOD_S, |_, _| ());
        for intruder in &mut intruders {
            intruder.position_m += intruder.velocity_mps * PERIOD_S;
        }
        step += 1;
    }
    count
}

fn counted(count: u64, seed: u64) -> Vec<(usize, bool, Outcomes)> {
    let cells = COUNTS
        .into_iter()
        .flat_map(|aircraft| [(aircraft, true), (aircraft, false)]);
    cells
        .map(|(aircraft, planar)| {
            let flown = (0..count)
                .into_par_iter()
                .map(|number| fly(seed, number, aircraft, planar));
            (
                aircraft,
                planar,
                flown.reduce(Outcomes::default, Outcomes::and),
            )
        })
        .collect()
}

/// Runs the experiment.
pub(crate) fn run(args: &DrawnArgs) {
    for (aircraft, planar, count) in counted(args.count, args.seed) {
        println!(
            "{aircraft} aircraft {}: {} of {} claims entered; {} encounters with aircraft that count as straight",
            if planar { "in the plane" } else { "in space" },
            count.entered.len(),
            count.claimed,
            count.straight,
        );
        for (number, by_m) in count.entered {
            println!("  encounter {number}: by {by_m:.3} m");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn d4_what_a_record_claims_is_true() {
        for (aircraft, planar, count) in counted(60, 1) {
            assert!(count.entered.is_empty(), "{aircraft} {planar} {count:?}");
            assert!(count.claimed > 5, "{aircraft} {planar} {count:?}");
        }
    }
}
