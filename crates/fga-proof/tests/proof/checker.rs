//! A checker of certificates by code of its own: the flight of [`Flown`], distances by elementary geometry, and between two steps
//! an enclosure by intervals that are rounded outwards. It draws everything that `Vehicle::check` accepts.
//!
//! A certificate claims a margin. The checker looks at the flight again and again: where the distance cannot fall to the margin before
//! the next look, by speed and acceleration, nothing is to check; where it can, the enclosure of the flight until the next step is
//! halved until it is above the margin or as short as a nanosecond. 4,000 certificates by default; `FGA_CHECKED` sets
//! another number, `FGA_FIRST_CASE` draws others.

use core::ops::{Add, Mul, Neg, Sub};

use crate::flown::{Flown, INTEGRATED_M, drawn, number};
use crate::random::Random;
use fga_proof::Vec3;
use fga_proof::assumptions::Assumptions;
use fga_proof::certificate::{ALWAYS, Extent, Hazard, NO_DEPTH};
use fga_proof::command::{Command, Terms};
use fga_proof::maneuver::Maneuver;
use fga_proof::meter::Meter;
use fga_proof::prediction::{FlightPath, Flyer, MotionState};
use fga_proof::situation::ProtectedVolume;
use fga_proof::vehicle::{Response, STANDARD_GRAVITY_MPS2, Vehicle};

/// What holds all values of a quantity, whatever is rounded.
#[derive(Debug, Clone, Copy)]
struct Interval(f64, f64);

impl Interval {
    fn around(middle: f64, radius: f64) -> Self {
        Self::outwards(middle - radius, middle + radius)
    }

    /// By a unit in the last place at least.
    fn outwards(low: f64, high: f64) -> Self {
        let unit = |bound: f64| (bound.abs() * 2.3e-16).max(1e-200);
        Self(low - unit(low), high + unit(high))
    }

    fn abs(self) -> Self {
        if self.0 >= 0.0 {
            self
        } else if self.1 <= 0.0 {
            -self
        } else {
            Self(0.0, self.1.max(-self.0))
        }
    }

    fn square(self) -> Self {
        let Self(low, high) = self.abs();
        Self::outwards(low * low, high * high)
    }

    fn root(self) -> Self {
        Self::outwards(self.0.max(0.0).sqrt(), self.1.max(0.0).sqrt())
    }

    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }

    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.1, -self.0)
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::outwards(self.0 + other.0, self.1 + other.1)
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul<f64> for Interval {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        let (one, other) = (self.0 * factor, self.1 * factor);
        Self::outwards(one.min(other), one.max(other))
    }
}

/// The signed distance from an obstacle of a place at a time, by intervals.
fn distance(hazard: &Extent, place: [Interval; 3], time: Interval) -> Interval {
    let exactly = |value: f64| Interval(value, value);
    let zero = exactly(0.0);
    let center: [f64; 3] = hazard.position_m.into();
    let velocity: [f64; 3] = hazard.velocity_mps.into();
    let offset: [Interval; 3] =
        core::array::from_fn(|axis| place[axis] - (exactly(center[axis]) + time * velocity[axis]));
    // From the nearest point of the stretched centre line.
    let (now_m, more_mps) = hazard.stretch_m;
    let stretch = exactly(now_m) + time * more_mps;
    let height = if hazard.stretch_m == (0.0, 0.0) {
        offset[2].abs()
    } else {
        (offset[2].abs() - stretch).max(zero)
    };
    let aside = (offset[0].square() + offset[1].square()).root();
    let unstretched = match hazard.volume {
        ProtectedVolume::Sphere { radius_m } => {
            (aside.square() + height.square()).root() - exactly(radius_m)
        }
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => {
            let (wall, face) = (aside - exactly(radius_m), height - exactly(half_height_m));
            let outside = (wall.max(zero).square() + face.max(zero).square()).root();
            outside + wall.max(face).min(zero)
        }
    };
    unstretched - time * hazard.growth_mps
}

/// The distance from an obstacle from a moment of a flight until another time, by its velocity now and its acceleration.
fn distance_until(flown: &Flown<'_>, hazard: &Extent, (from_s, to_s): (f64, f64)) -> Interval {
    let exactly = |value: f64| Interval(value, value);
    let after = Interval::outwards(from_s - flown.time_s, to_s - flown.time_s);
    let bend_m = 0.5 * flown.acceleration() * after.1 * after.1;
    let bend = Interval::around(0.0, bend_m + INTEGRATED_M);
    let (at, velocity): ([f64; 3], [f64; 3]) = (flown.at.into(), flown.velocity().into());
    let place = core::array::from_fn(|axis| exactly(at[axis]) + after * velocity[axis] + bend);
    distance(hazard, place, Interval(from_s, to_s))
}

/// Whether a flight keeps a margin between two times within its next step, as far as an enclosure of a nanosecond can say.
fn keeps(flown: &Flown<'_>, hazard: &Extent, margin_m: f64, (from_s, to_s): (f64, f64)) -> bool {
    let Interval(low, high) = distance_until(flown, hazard, (from_s, to_s));
    let middle_s = 0.5 * (from_s + to_s);
    low >= margin_m
        || (high >= margin_m
            && to_s - from_s > 1e-9
            && keeps(flown, hazard, margin_m, (from_s, middle_s))
            && keeps(flown, hazard, margin_m, (middle_s, to_s)))
}

/// The same in shorter steps, in which the flight bends less.
fn keeps_finely(
    flown: &Flown<'_>,
    hazard: &Extent,
    margin_m: f64,
    (from_s, to_s): (f64, f64),
) -> bool {
    if distance_until(flown, hazard, (from_s, to_s)).0 >= margin_m {
        return true;
    }
    let mut flown = flown.clone().in_steps(1.0 / 128.0);
    while flown.time_s < to_s {
        let now = flown.clone();
        flown.step();
        let within_s = (from_s.max(now.time_s), to_s.min(flown.time_s));
        if within_s.0 <= within_s.1 && !keeps(&now, hazard, margin_m, within_s) {
            return false;
        }
    }
    true
}

/// A certificate to check, and what it is about.
struct Case {
    vehicle: Vehicle,
    start: MotionState,
    maneuver: Maneuver,
    hazards: Vec<Extent>,
    horizon_s: f64,
}

/// The margin that is certified of a case, metres, and the bound of the prediction's error.
fn claim(case: &Case, path: &mut FlightPath) -> Option<(f64, f64)> {
    let flyer = Flyer::new(&case.vehicle);
    let terms = Terms::new(case.horizon_s, 0.0, 1e3)?;
    let hazards: Vec<Hazard> = (case.hazards.iter())
        .map(|extent| Hazard::given(1, *extent))
        .collect();
    let proof = Command::from(case.maneuver).prove(
        (&flyer, &mut *path),
        &case.start,
        &Assumptions::only(&hazards),
        &terms,
        &Meter::unlimited(),
    );
    proof
        .ok()
        .map(|proof| (proof.bound().margin_m, path.remainder_m()))
}

/// Whether the flight keeps a margin from the hazards.
fn check(case: &Case, margin_m: f64) -> bool {
    // Seen from where it starts, sums of small steps lose nothing.
    let start = MotionState {
        position_m: Vec3::ZERO,
        ..case.start
    };
    let mut hazards = case.hazards.clone();
    for hazard in &mut hazards {
        hazard.position_m -= case.start.position_m;
    }
    let mut flown = Flown::from(&case.vehicle, &start, &case.maneuver, Vec3::ZERO).in_long_steps();
    let mut looks_s = vec![0.0; hazards.len()];
    while flown.time_s < case.horizon_s {
        let now = flown.clone();
        flown.step();
        let until_s = flown.time_s.min(case.horizon_s);
        for (hazard, look_s) in hazards.iter().zip(&mut looks_s) {
            let (from_s, to_s) = hazard.window_s;
            let within_s = (from_s.max(now.time_s), to_s.min(until_s));
            if within_s.0 > within_s.1 || until_s < *look_s {
                continue;
            }
            let here_m = distance_until(&now, hazard, (now.time_s, now.time_s)).0;
            let falls_mps = case.vehicle.airspeed_mps
                + hazard.velocity_mps.length()
                + hazard.growth_mps
                + hazard.stretch_m.1.abs();
            *look_s = now.time_s + (here_m - margin_m) / falls_mps;
            if until_s >= *look_s && !keeps_finely(&now, hazard, margin_m, within_s) {
                return false;
            }
        }
    }
    true
}

impl Random {
    /// As often between 1 and 10 as between 10 and 100.
    fn scaled(&mut self, low: f64, high: f64) -> f64 {
        self.within(low.ln(), high.ln()).exp()
    }

    /// Whatever `Vehicle::check` accepts.
    fn any_vehicle(&mut self) -> Vehicle {
        loop {
            let airspeed_mps = self.scaled(1.0, 1000.0);
            let load = self.scaled(0.02, 10.0);
            let steep = |random: &mut Self| {
                if random.chance(0.3) {
                    0.0
                } else {
                    random.within(0.0, 80.0_f64.to_radians())
                }
            };
            let vehicle = Vehicle {
                airspeed_mps,
                turn_radius_m: airspeed_mps * airspeed_mps / (STANDARD_GRAVITY_MPS2 * load),
                climb_min_rad: -steep(self),
                climb_max_rad: steep(self),
                climb_rate_radps: self.scaled(0.01, 10.0),
                response: Response {
                    dead_time_s: 0.0,
                    bank_time_constant_s: if self.chance(0.2) {
                        0.0
                    } else {
                        self.scaled(0.01, 10.0)
                    },
                    turn_rate_factor: self.within(0.05, 2.0),
                },
            };
            if vehicle.check().is_ok() {
                return vehicle;
            }
        }
    }

    fn vector(&mut self, size: f64) -> Vec3 {
        Vec3::from_array([0; 3].map(|_| self.within(-size, size)))
    }

    fn hazard(&mut self, near: Vec3, at_s: f64, speed_mps: f64) -> Extent {
        let velocity_mps = if self.chance(0.3) {
            Vec3::ZERO
        } else {
            self.vector(1.5 * speed_mps)
        };
        let volume = if self.chance(0.5) {
            ProtectedVolume::Sphere {
                radius_m: self.scaled(0.05, 500.0),
            }
        } else {
            ProtectedVolume::Cylinder {
                radius_m: self.scaled(0.05, 500.0),
                half_height_m: self.scaled(0.05, 200.0),
            }
        };
        let reach = volume.bounding_radius_m();
        let away = self.vector(1.0).normalize_or(Vec3::X);
        // Just outside of it, or a little farther.
        let off_m = reach * self.within(0.9, 1.3) + self.scaled(1e-3, 30.0);
        Extent {
            position_m: near - velocity_mps * at_s + away * off_m,
            velocity_mps,
            volume,
            growth_mps: if self.chance(0.6) {
                0.0
            } else {
                self.within(0.0, 3.0)
            },
            allowed_depth_m: NO_DEPTH,
            stretch_m: if self.chance(0.7) {
                (0.0, 0.0)
            } else {
                (self.within(0.0, 40.0), self.within(0.0, 2.5))
            },
            window_s: if self.chance(0.7) {
                ALWAYS
            } else {
                let from_s = self.within(0.0, 2.0 * at_s);
                (from_s, from_s + self.within(0.0, 20.0))
            },
        }
    }

    fn case(&mut self) -> Case {
        let vehicle = self.any_vehicle();
        let flyer = Flyer::new(&vehicle);
        let far_m = if self.chance(0.1) { 1e7 } else { 1e3 };
        let bank = 1.2 * flyer.full_bank_rad();
        let course_rad = self.within(-100.0, 100.0);
        let start = MotionState {
            time_s: 0.0,
            position_m: self.vector(far_m),
            course_rad,
            climb_rad: self.within(vehicle.climb_min_rad, vehicle.climb_max_rad),
            bank_rad: if self.chance(0.5) {
                0.0
            } else {
                self.within(-bank, bank).clamp(-1.4, 1.4)
            },
        };
        let maneuver = self.maneuver_from(course_rad, 1.2);
        let horizon_s = self.within(2.0, 30.0);
        let at_s = self.within(0.0, horizon_s);
        // Near the prediction, if it comes so far: what is near the flight is judged elsewhere.
        let mut path = FlightPath::new();
        path.predict(&flyer, &start, &maneuver, horizon_s);
        let near_m = path
            .state_at(&flyer, at_s)
            .map_or(start.position_m, |state| state.position_m);
        let hazards = (0..=(self.unit() * 2.0) as usize)
            .map(|_| self.hazard(near_m, at_s, vehicle.airspeed_mps))
            .collect();
        Case {
            vehicle,
            start,
            maneuver,
            hazards,
            horizon_s,
        }
    }
}

#[test]
fn every_certificate_holds_for_the_flight() {
    let asked = number("FGA_CHECKED", 4_000);
    let mut path = FlightPath::new();
    let (mut checked, mut violated, mut drawn_cases) = (0, 0, 0);
    let mut remainders = Vec::new();
    for number in drawn(u64::MAX / 2) {
        if checked == asked {
            break;
        }
        drawn_cases += 1;
        let case = Random(0xc4ec_0000 + number).case();
        let Some((margin_m, remainder_m)) = claim(&case, &mut path) else {
            continue;
        };
        checked += 1;
        remainders.push(remainder_m);
        if !check(&case, margin_m) {
            violated += 1;
            println!(
                "case {number}: {margin_m} m, remainder {remainder_m} m, {:?} {:?} {:?} {:?}",
                case.vehicle, case.start, case.maneuver, case.hazards
            );
        }
    }
    remainders.sort_by(f64::total_cmp);
    let of = |share: f64| remainders[(share * (remainders.len() - 1) as f64) as usize];
    println!(
        "{violated} of {checked} certificates violated, {drawn_cases} drawn: airspeed 1 to 1,000 m/s, 0.02 to 10 g, lag 0 or \
         0.01 to 10 s, factor 0.05 to 2, climb to 80 degrees, places to 1e7 m, spheres and cylinders, growth, stretch, windows; \
         remainder: median {:.4}, 99 % {:.4}, largest {:.4} m",
        of(0.5),
        of(0.99),
        of(1.0)
    );
    assert_eq!(violated, 0);
}

#[test]
fn a_step_of_half_the_length_leads_to_the_same_place() {
    let mut largest_m = 0.0_f64;
    for number in 0..300 {
        let case = Random(0x57e9 + number).case();
        let ends = [1.0, 0.5].map(|share| {
            let start = MotionState {
                position_m: Vec3::ZERO,
                ..case.start
            };
            let mut flown =
                Flown::from(&case.vehicle, &start, &case.maneuver, Vec3::ZERO).in_long_steps();
            if share < 1.0 {
                flown = flown.in_steps(share);
            }
            while flown.time_s < case.horizon_s {
                flown.step_until(case.horizon_s);
            }
            flown.at
        });
        largest_m = largest_m.max(ends[0].distance(ends[1]));
    }
    println!("{largest_m:.2e} m");
    assert!(largest_m < 0.5 * INTEGRATED_M, "{largest_m}");
}

/// The flown and the predicted place, all along long turns of steep and slow rolls.
#[test]
fn no_flight_is_farther_from_its_prediction_than_its_remainder() {
    let (mut flights, mut nearest) = (0, 0.0_f64);
    let speeds = [8.0, 15.0, 30.0, 60.0];
    for (speed_mps, load) in speeds
        .iter()
        .flat_map(|s| [0.5, 1.0, 2.0, 4.0].map(|g| (*s, g)))
    {
        for (lag_s, factor) in [0.3, 1.0, 2.0, 3.0, 10.0]
            .iter()
            .flat_map(|l| [0.8, 1.2].map(|f| (*l, f)))
        {
            let radius_m: f64 = speed_mps * speed_mps / (STANDARD_GRAVITY_MPS2 * load);
            let vehicle = Vehicle {
                airspeed_mps: speed_mps,
                turn_radius_m: radius_m.max(1.0),
                response: Response {
                    dead_time_s: 0.0,
                    bank_time_constant_s: lag_s,
                    turn_rate_factor: factor,
                },
                ..Vehicle::table_4()
            };
            if vehicle.check().is_err() {
                continue;
            }
            let flyer = Flyer::new(&vehicle);
            for (bank, turn_rad) in [(0.0, 3.0), (0.0, 12.0), (-1.0, 0.5), (-1.0, 25.0)] {
                let start = MotionState::ahead(bank * flyer.full_bank_rad());
                let mut maneuver = Maneuver::turn(0.0, turn_rad, 0.2);
                maneuver.push(fga_proof::maneuver::Stage::turn(9.0, -1.0, 0.0));
                let mut path = FlightPath::new();
                path.predict(&flyer, &start, &maneuver, 30.0);
                if !path.is_complete() {
                    continue;
                }
                flights += 1;
                let mut flown = Flown::from(&vehicle, &start, &maneuver, Vec3::ZERO);
                while flown.time_s < 30.0 {
                    let there = path.state_at(&flyer, flown.time_s).expect("nodes");
                    let off_m = there.position_m.distance(flown.at);
                    assert!(
                        off_m <= path.remainder_m() + INTEGRATED_M,
                        "{off_m} of {} at {} s: {vehicle:?} {bank} {turn_rad}",
                        path.remainder_m(),
                        flown.time_s
                    );
                    nearest = nearest.max(off_m / path.remainder_m());
                    flown.step();
                }
            }
        }
    }
    println!("{flights} flights, at most {nearest:.2} of the remainder");
    assert!(flights > 300, "{flights}");
}
