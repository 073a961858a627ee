//! The drawn flights.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "drawn numbers are small and not negative"
)]

use fga::Vec3;
use fga::situation::{Movement, Obstacle, ProtectedVolume};
use fga::vehicle::{Response, Vehicle};

use super::flier::Flier;
use crate::intruders::traffic::SplitMix64;

/// What makes the aircraft avoid.
pub(super) const FAMILIES: [&str; 5] = [
    "fleet",
    "tracks that end",
    "corner",
    "mission's end",
    "mast",
];

/// An obstacle that flies straight, for some time.
pub(super) struct Straight {
    pub(super) obstacle: Obstacle,
    pub(super) present_s: (f64, f64),
}

impl Straight {
    /// What stands at a place all the time.
    pub(super) const fn standing(id: u32, place_m: Vec3, volume: ProtectedVolume) -> Self {
        Self {
            obstacle: Obstacle {
                movement: Movement::AtRest,
                ..Obstacle::straight(id, place_m, Vec3::ZERO, volume)
            },
            present_s: (0.0, f64::INFINITY),
        }
    }
}

/// A drawn flight.
pub(super) struct ReturnFlight {
    pub(super) vehicle: Vehicle,
    pub(super) wind_mps: Vec3,
    pub(super) radius_m: f64,
    pub(super) surveillance_m: f64,
    pub(super) fliers: Vec<Flier>,
    pub(super) others: Vec<Straight>,
    pub(super) until_s: f64,
}

/// Waypoints from a place, with legs of some length and corners up to some angle.
fn mission_m(
    random: &mut SplitMix64,
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

impl ReturnFlight {
    /// Without aircraft: the vehicle and the wind of all, the radius of their protected spheres and how far they see, metres.
    pub(super) const fn empty(
        vehicle: Vehicle,
        wind_mps: Vec3,
        (radius_m, surveillance_m): (f64, f64),
    ) -> Self {
        Self {
            vehicle,
            wind_mps,
            radius_m,
            surveillance_m,
            fliers: Vec::new(),
            others: Vec::new(),
            until_s: 0.0,
        }
    }

    pub(super) fn drawn(seed: u64, number: u64) -> Self {
        let mut random = SplitMix64::of(seed, number);
        let family = number as usize % FAMILIES.len();
        let airspeed_mps = random.within(12.0, 25.0);
        let bank_rad = random.within(0.45, 0.85);
        let is_planar = random.unit() < 0.5;
        let climb_rad = if is_planar {
            0.0
        } else {
            random.within(0.08, 0.25)
        };
        let late_s = |random: &mut SplitMix64| {
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
        let mut flight = Self::empty(vehicle, wind_mps, (radius_m, surveillance_m));
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
        let length_m: f64 = mission_m
            .windows(2)
            .map(|leg| leg[0].distance(leg[1]))
            .sum();
        let slowest_mps = self.vehicle.airspeed_mps - self.wind_mps.length();
        self.until_s = self.until_s.max(600.0 + 4.0 * length_m / slowest_mps);
        let air = (&self.vehicle, self.wind_mps);
        self.fliers
            .extend(Flier::new(mission_m, air, self.surveillance_m));
    }

    /// Adds traffic that meets the aircraft on its mission.
    fn conflict(&mut self, random: &mut SplitMix64, family: usize) {
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
                    self.others.push(Straight::standing(id, place_m, volume));
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
}
