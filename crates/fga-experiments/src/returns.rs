//! Does every aircraft return to its mission once nothing is near?
//!
//! Drawn flights of five families: fleets in which every aircraft flies fga, traffic whose tracks end, conflicts at corners and
//! at the mission's end, masts; wind up to 0.9 of the airspeed, bank lag and dead time up to 1 s. The judge is this file: it looks
//! at positions and at the word of the state, and shares no code with the decisions.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "drawn numbers are small and not negative"
)]

use clap::Args;
use fga::Vec3;
use fga::avoider::{Reason, Settings, State};
use fga::pilot::Pilot;
use fga::situation::{Mission, Movement, Obstacle, Obstacles, Passing, ProtectedVolume, Situation};
use fga::vehicle::{Response, Vehicle};
use fga_sim::plant::{Autopilot, Plant};
use fga_sim::policy::PolicyChoice;
use fga_sim::settings::PolicySettings;
use fga_sim::wind::crab;
use rayon::prelude::*;

use crate::intruders::traffic::Random;

/// Time between two steps, seconds.
const PERIOD_S: f64 = 0.1;

/// Horizon of the decisions, seconds.
const HORIZON_S: f64 = 60.0;

/// Longest time of `avoiding` with nothing near, seconds.
const STUCK_S: f64 = 30.0;

/// The distance to the mission is compared with the one so long ago, seconds.
const STRAYS_S: f64 = 120.0;

/// The last waypoint is flown when the aircraft passes it this near, metres.
const FLOWN_M: f64 = 10.0;

/// An aircraft flies on for so long after its mission, seconds.
const LANDS_S: f64 = 3.0;

/// Options of `returns`.
#[derive(Args, Debug)]
pub(crate) struct ReturnsArgs {
    /// Number of flights.
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    count: u64,
    /// Master seed.
    #[arg(default_value_t = 1)]
    seed: u64,
    /// Fly only the flight with this number, and print its aircraft twice a minute.
    #[arg(long)]
    only: Option<u64>,
}

/// What makes the aircraft avoid.
const FAMILIES: [&str; 5] = [
    "fleet",
    "tracks that end",
    "corner",
    "mission's end",
    "mast",
];

/// An obstacle that flies straight, for some time.
struct Straight {
    obstacle: Obstacle,
    present_s: (f64, f64),
}

/// An aircraft that flies fga, and what the judge saw.
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a finding of its own"
)]
struct Flier {
    plant: Plant,
    pilot: Box<dyn Pilot + Send>,
    mission_m: Vec<Vec3>,
    /// It flies over the last waypoint.
    passing: Vec<Passing>,
    state: State,
    is_complete: bool,
    /// How long it has flown on since then, seconds: with a dead time it is complete before the waypoint.
    after_s: f64,
    /// How long it has avoided with nothing near, and at most, seconds.
    alone_s: (f64, f64),
    /// Distances to the mission with nothing near, one a second, metres.
    away_m: Vec<f64>,
    has_strayed: bool,
    /// Least distance to the last waypoint, metres.
    end_m: f64,
    lowest_m: f64,
    has_entered: bool,
    is_adrift: bool,
}

/// A drawn flight.
struct Flight {
    vehicle: Vehicle,
    wind_mps: Vec3,
    radius_m: f64,
    surveillance_m: f64,
    fliers: Vec<Flier>,
    others: Vec<Straight>,
    until_s: f64,
}

/// What went wrong in flights of a family.
#[derive(Debug, Default, Clone)]
struct Count {
    flights: usize,
    aircraft: usize,
    stuck: Vec<u64>,
    longest_s: f64,
    strayed: Vec<u64>,
    open: Vec<u64>,
    end_missed: Vec<u64>,
    low: Vec<u64>,
    entered: usize,
}

impl Count {
    fn and(mut self, other: Self) -> Self {
        self.flights += other.flights;
        self.aircraft += other.aircraft;
        self.longest_s = self.longest_s.max(other.longest_s);
        self.entered += other.entered;
        self.stuck.extend(other.stuck);
        self.strayed.extend(other.strayed);
        self.open.extend(other.open);
        self.end_missed.extend(other.end_missed);
        self.low.extend(other.low);
        self
    }

    fn row(&self, family: &str) -> String {
        let named = |numbers: &[u64]| {
            let first: Vec<String> = numbers.iter().take(4).map(u64::to_string).collect();
            format!("{} [{}]", numbers.len(), first.join(" "))
        };
        format!(
            "{family}: {} flights, {} aircraft; avoiding with nothing near more than {STUCK_S} s: {} (longest {:.1} s); strayed: {}; \
             mission not ended: {}; last waypoint missed: {}; below the floor: {}; {} entered a volume",
            self.flights,
            self.aircraft,
            named(&self.stuck),
            self.longest_s,
            named(&self.strayed),
            named(&self.open),
            named(&self.end_missed),
            named(&self.low),
            self.entered,
        )
    }
}

/// Distance of a place from a line through points, metres.
fn distance_m(line_m: &[Vec3], place_m: Vec3) -> f64 {
    let near = |pair: &[Vec3]| {
        let along = pair[1] - pair[0];
        let share = (place_m - pair[0]).dot(along) / along.length_squared().max(1e-9);
        place_m.distance(pair[0] + along * share.clamp(0.0, 1.0))
    };
    line_m.windows(2).map(near).fold(f64::INFINITY, f64::min)
}

/// Waypoints from a place, with legs of some length and corners up to some angle.
fn mission_m(
    random: &mut Random,
    from_m: Vec3,
    legs: usize,
    turn_rad: f64,
    climbs: bool,
) -> Vec<Vec3> {
    let mut course_rad = random.within(-core::f64::consts::PI, core::f64::consts::PI);
    let mut mission_m = vec![from_m];
    let mut at_m = from_m;
    for _ in 0..legs {
        let length_m = random.within(300.0, 1200.0);
        let (sin, cos) = libm::sincos(course_rad);
        at_m += Vec3::new(cos, sin, 0.0) * length_m;
        if climbs {
            at_m.z = random.within(90.0, 110.0);
        }
        mission_m.push(at_m);
        course_rad += random.within(-turn_rad, turn_rad);
    }
    mission_m
}

impl Flight {
    fn drawn(seed: u64, number: u64) -> Self {
        let mut random = Random(seed.wrapping_mul(0x9e37_79b9).wrapping_add(number) << 8);
        let family = number as usize % FAMILIES.len();
        let airspeed_mps = random.within(12.0, 25.0);
        let bank_rad = random.within(0.45, 0.85);
        let is_planar = random.unit() < 0.5;
        let climb_rad = if is_planar {
            0.0
        } else {
            random.within(0.08, 0.25)
        };
        let late_s = |random: &mut Random| {
            if random.unit() < 0.5 {
                0.0
            } else {
                random.within(0.1, 1.0)
            }
        };
        let vehicle = Vehicle {
            airspeed_mps,
            turn_radius_m: airspeed_mps * airspeed_mps / (9.80665 * libm::tan(bank_rad)),
            climb_min_rad: -climb_rad,
            climb_max_rad: climb_rad,
            climb_rate_radps: 0.2,
            response: Response {
                bank_time_constant_s: late_s(&mut random),
                dead_time_s: late_s(&mut random),
                ..Response::default()
            },
        };
        let wind_mps = if random.unit() < 0.3 {
            Vec3::ZERO
        } else {
            let (sin, cos) = libm::sincos(random.within(0.0, core::f64::consts::TAU));
            Vec3::new(cos, sin, 0.0) * (airspeed_mps * random.within(0.0, 0.9))
        };
        let radius_m = random.within(15.0, 60.0);
        let surveillance_m = [300.0, 1000.0, 3000.0][(3.0 * random.unit()) as usize];
        let count = if family == 0 {
            random.within(3.0, 12.0) as usize
        } else {
            1
        };
        let side_m = random.within(600.0, 3000.0);
        let mut flight = Self {
            vehicle,
            wind_mps,
            radius_m,
            surveillance_m,
            fliers: Vec::new(),
            others: Vec::new(),
            until_s: 0.0,
        };
        for _ in 0..count {
            let from_m = Vec3::new(side_m * random.unit(), side_m * random.unit(), 100.0);
            let legs = 1 + (3.0 * random.unit()) as usize;
            let turn_rad = if family == 2 { 2.6 } else { 1.5 };
            let mission_m = mission_m(&mut random, from_m, legs, turn_rad, !is_planar);
            let near_m = |flier: &Flier| flier.plant.ownship().position_m.distance(from_m);
            if flight
                .fliers
                .iter()
                .all(|flier| near_m(flier) > 6.0 * radius_m)
            {
                flight.add(mission_m);
            }
        }
        if family > 0 {
            flight.conflict(&mut random, family);
        }
        flight
    }

    fn add(&mut self, mission_m: Vec<Vec3>) {
        let along = (mission_m[1] - mission_m[0]).normalize();
        let Some((course_rad, climb_rad)) = crab(along, self.vehicle.airspeed_mps, self.wind_mps)
        else {
            return;
        };
        let settings = PolicySettings {
            avoider: Settings {
                surveillance_radius_m: self.surveillance_m,
                horizon_s: HORIZON_S,
                ..Settings::default()
            },
            ..PolicySettings::default()
        };
        let pilot = PolicyChoice::default().pilot(&settings, &self.vehicle);
        let mut plant = Plant::new(self.vehicle, Autopilot::Direct, self.wind_mps);
        plant.place(0.0, mission_m[0], course_rad, climb_rad);
        let length_m: f64 = mission_m
            .windows(2)
            .map(|leg| leg[0].distance(leg[1]))
            .sum();
        let slowest_mps = self.vehicle.airspeed_mps - self.wind_mps.length();
        self.until_s = self.until_s.max(600.0 + 4.0 * length_m / slowest_mps);
        let mut passing = vec![Passing::FlyBy; mission_m.len()];
        passing[mission_m.len() - 1] = Passing::FlyOver;
        self.fliers.push(Flier {
            plant,
            pilot: pilot.expect("usable settings"),
            lowest_m: mission_m[0].z,
            passing,
            mission_m,
            state: State::Cruise,
            is_complete: false,
            after_s: 0.0,
            alone_s: (0.0, 0.0),
            away_m: Vec::new(),
            has_strayed: false,
            end_m: f64::INFINITY,
            has_entered: false,
            is_adrift: false,
        });
    }

    /// Adds traffic that meets the aircraft on its mission.
    fn conflict(&mut self, random: &mut Random, family: usize) {
        let Some(flier) = self.fliers.first() else {
            return;
        };
        let mission_m = &flier.mission_m;
        let volume = ProtectedVolume::Sphere {
            radius_m: self.radius_m,
        };
        for id in 0..=(3.0 * random.unit()) as u32 {
            let leg = (random.unit() * (mission_m.len() - 1) as f64) as usize;
            let (from_m, to_m) = (mission_m[leg], mission_m[leg + 1]);
            let share = match family {
                2 | 3 => 1.0,
                _ => random.within(0.2, 0.9),
            };
            let (leg, share) = if family == 3 {
                (mission_m.len() - 2, 1.0)
            } else {
                (leg, share)
            };
            let meets_m = if family == 3 {
                mission_m[leg + 1]
            } else {
                from_m.lerp(to_m, share)
            };
            let aside_m =
                Vec3::new(random.within(-1.0, 1.0), random.within(-1.0, 1.0), 0.0) * self.radius_m;
            if family == 4 {
                let place_m = meets_m + aside_m;
                let clear_m = 1.5 * self.radius_m + 3.0 * self.vehicle.turn_radius_m;
                if mission_m
                    .iter()
                    .all(|waypoint_m| waypoint_m.distance(place_m) > clear_m)
                {
                    self.others.push(Straight {
                        obstacle: Obstacle {
                            movement: Movement::AtRest,
                            ..Obstacle::straight(id, place_m, Vec3::ZERO, volume)
                        },
                        present_s: (0.0, f64::INFINITY),
                    });
                }
                continue;
            }
            // The time at which the aircraft is there, without corners.
            let mut at_s = 0.0;
            for (index, pair) in mission_m.windows(2).enumerate().take(leg + 1) {
                let part = if index == leg { share } else { 1.0 };
                let along = (pair[1] - pair[0]).normalize();
                let across_mps = (self.wind_mps - along * self.wind_mps.dot(along)).length();
                let airspeed_mps = self.vehicle.airspeed_mps;
                let speed_mps =
                    libm::sqrt((airspeed_mps * airspeed_mps - across_mps * across_mps).max(0.01))
                        + self.wind_mps.dot(along);
                at_s += part * pair[0].distance(pair[1]) / speed_mps.max(0.05 * airspeed_mps);
            }
            let (sin, cos) = libm::sincos(random.within(0.0, core::f64::consts::TAU));
            let velocity_mps =
                Vec3::new(cos, sin, 0.0) * random.within(0.3, 3.0) * self.vehicle.airspeed_mps;
            let movement = [Movement::Straight, Movement::SMALL_UAS, Movement::CREWED]
                [(3.0 * random.unit()) as usize];
            let ends_s = at_s + random.within(-20.0, 60.0);
            self.others.push(Straight {
                obstacle: Obstacle {
                    movement,
                    ..Obstacle::straight(
                        id,
                        meets_m + aside_m - velocity_mps * at_s,
                        velocity_mps,
                        volume,
                    )
                },
                present_s: ((at_s - random.within(20.0, 120.0)).max(0.0), ends_s),
            });
        }
    }

    /// Flies until every mission has ended, or for too long.
    #[expect(clippy::too_many_lines, reason = "one step after the other")]
    fn fly(mut self, number: u64, shows: bool) -> Count {
        let volume = ProtectedVolume::Sphere {
            radius_m: self.radius_m,
        };
        let mut rows = Vec::new();
        let mut step = 0_u32;
        while f64::from(step) * PERIOD_S < self.until_s {
            let time_s = f64::from(step) * PERIOD_S;
            step += 1;
            if self.fliers.iter().all(Flier::has_landed) {
                break;
            }
            let fleet: Vec<Option<Obstacle>> = self
                .fliers
                .iter()
                .zip(1000..)
                .map(|(flier, id)| {
                    // A fleet's aircraft that is done has landed.
                    (!flier.has_landed()).then(|| Obstacle {
                        movement: Movement::SMALL_UAS,
                        ..Obstacle::straight(
                            id,
                            flier.plant.ownship().position_m,
                            flier.plant.ground_velocity_mps(),
                            volume,
                        )
                    })
                })
                .collect();
            for (index, flier) in self.fliers.iter_mut().enumerate() {
                rows.clear();
                let present = |straight: &&Straight| {
                    time_s >= straight.present_s.0 && time_s <= straight.present_s.1
                };
                rows.extend(self.others.iter().filter(present).map(|straight| Obstacle {
                    position_m: straight.obstacle.position_m
                        + straight.obstacle.velocity_mps * time_s,
                    ..straight.obstacle
                }));
                let others = fleet
                    .iter()
                    .enumerate()
                    .filter(|(other, _)| *other != index);
                rows.extend(others.filter_map(|(_, other)| *other));
                if flier.has_landed() {
                    continue;
                }
                flier.step(time_s, &rows, self.wind_mps);
                flier.judge(
                    (step, time_s),
                    &rows,
                    (&self.vehicle, self.wind_mps, self.surveillance_m),
                );
                if shows
                    && step.is_multiple_of(if flier.state == State::Cruise {
                        300
                    } else {
                        50
                    })
                {
                    let own = flier.plant.ownship();
                    println!(
                        "{time_s:.1} {index}: {:?} {:.0} course {:.2} {} m off, {} near",
                        flier.state,
                        own.position_m,
                        own.course_rad,
                        distance_m(&flier.mission_m, own.position_m) as i64,
                        rows.len(),
                    );
                }
            }
        }
        if shows {
            println!(
                "{:?} wind {} others {}",
                self.vehicle,
                self.wind_mps,
                self.others.len()
            );
            for flier in &self.fliers {
                println!("mission {:?}", flier.mission_m);
            }
        }
        let mut count = Count {
            flights: 1,
            ..Count::default()
        };
        for flier in &self.fliers {
            count.aircraft += 1;
            count.longest_s = count.longest_s.max(flier.alone_s.1);
            count.entered += usize::from(flier.has_entered);
            let faults = [
                (flier.alone_s.1 > STUCK_S, &mut count.stuck),
                (flier.has_strayed, &mut count.strayed),
                (!flier.is_complete && !flier.is_adrift, &mut count.open),
                (
                    flier.is_complete && flier.end_m > FLOWN_M,
                    &mut count.end_missed,
                ),
                (flier.lowest_m < flier.floor_m() - 0.1, &mut count.low),
            ];
            for (is_fault, numbers) in faults {
                if is_fault {
                    numbers.push(number);
                }
            }
        }
        count
    }
}

impl Flier {
    fn step(&mut self, time_s: f64, obstacles: &[Obstacle], wind_mps: Vec3) {
        let decision = self.pilot.step(&Situation {
            time_s,
            ownship: self.plant.ownship(),
            obstacles: Obstacles::Rows(obstacles),
            mission: Mission {
                limits_m: (self.floor_m(), f64::INFINITY),
                passing: &self.passing,
                ..Mission::new(&self.mission_m)
            },
            wind_mps,
        });
        self.state = decision.state;
        self.is_complete |= decision.record.reason == Reason::MissionComplete;
        if self.is_complete {
            self.after_s += PERIOD_S;
        }
        self.is_adrift = decision.record.reason == Reason::WindTooStrong;
        self.plant.command(&decision.command, PERIOD_S);
        self.plant.advance(PERIOD_S, |_, _| ());
    }

    fn judge(
        &mut self,
        (step, _): (u32, f64),
        obstacles: &[Obstacle],
        (vehicle, wind_mps, surveillance_m): (&Vehicle, Vec3, f64),
    ) {
        let position_m = self.plant.ownship().position_m;
        self.lowest_m = self.lowest_m.min(position_m.z);
        let last_m = self.mission_m.last().copied().unwrap_or_default();
        self.end_m = self.end_m.min(last_m.distance(position_m));
        let margin_m =
            |obstacle: &Obstacle| obstacle.volume.margin_m(position_m - obstacle.position_m);
        self.has_entered |= obstacles.iter().any(|obstacle| margin_m(obstacle) < -0.1);
        let is_near = obstacles.iter().any(|obstacle| {
            let reach_m = HORIZON_S
                * (vehicle.airspeed_mps + wind_mps.length() + obstacle.velocity_mps.length());
            obstacle.position_m.distance(position_m) < surveillance_m
                && margin_m(obstacle) < reach_m
        });
        if is_near {
            self.away_m.clear();
        } else if step.is_multiple_of(10) {
            self.away_m.push(distance_m(&self.mission_m, position_m));
        }
        let is_alone = !is_near && self.state == State::Avoiding;
        self.alone_s.0 = if is_alone {
            self.alone_s.0 + PERIOD_S
        } else {
            0.0
        };
        self.alone_s.1 = self.alone_s.1.max(self.alone_s.0);
        // Until then it may avoid with nothing near, and a strong wind carries it off as fast.
        let later_m = self.away_m.get(STUCK_S as usize..).unwrap_or(&[]);
        let before = later_m
            .len()
            .checked_sub(STRAYS_S as usize)
            .and_then(|at| later_m.get(at));
        if let (Some(before_m), Some(now_m)) = (before, self.away_m.last()) {
            // A turn, and the drift in it.
            let turn_m = vehicle.turn_radius_m * (2.0 + core::f64::consts::TAU);
            self.has_strayed |= *now_m > *before_m + turn_m && !self.is_complete;
        }
    }

    /// Whether its mission is over, and its flight.
    fn has_landed(&self) -> bool {
        self.after_s > LANDS_S
    }

    /// The default floor: 30 m below the lowest waypoint, metres.
    fn floor_m(&self) -> f64 {
        let lowest_m = self
            .mission_m
            .iter()
            .map(|waypoint| waypoint.z)
            .fold(f64::INFINITY, f64::min);
        lowest_m - 30.0
    }
}

fn counted(count: u64, seed: u64) -> Vec<Count> {
    (0..FAMILIES.len() as u64)
        .map(|family| {
            (0..count)
                .into_par_iter()
                .filter(|number| number % FAMILIES.len() as u64 == family)
                .map(|number| Flight::drawn(seed, number).fly(number, false))
                .reduce(Count::default, Count::and)
        })
        .collect()
}

/// Runs the experiment.
pub(crate) fn run(args: &ReturnsArgs) {
    if let Some(number) = args.only {
        println!(
            "{}",
            Flight::drawn(args.seed, number)
                .fly(number, true)
                .row("this")
        );
        return;
    }
    for (count, family) in counted(args.count, args.seed).iter().zip(FAMILIES) {
        println!("{}", count.row(family));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn d1_with_nothing_near_every_aircraft_returns() {
        for (count, family) in counted(500, 1).iter().zip(FAMILIES) {
            let faults = [&count.stuck, &count.strayed, &count.open, &count.low];
            assert!(
                faults.iter().all(|numbers| numbers.is_empty()),
                "{}",
                count.row(family)
            );
        }
    }
}
