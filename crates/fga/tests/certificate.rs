//! The certificate against fine sampling: it never calls a path clear that is not, and is tight.
//!
//! 10⁵ cases by default; `FGA_CERTIFICATE_CASES` sets another number. The test computes the sampled
//! distances from spheres and upright cylinders itself, without the code under test.
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts drawn from floats"
)]

#[path = "../../fga-proof/tests/common/random.rs"]
mod random;

use fga::Vec3;
use fga::assumptions::Assumptions;
use fga::certificate::{ALWAYS, Extent, Hazard, NO_DEPTH, Status, certify_set};
use fga::maneuver::{Maneuver, Stage};
use fga::meter::Meter;
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::{Obstacle, ProtectedVolume};
use fga::vehicle::{Response, Vehicle};
use random::Random;

/// Longest step between two samples, seconds.
const SAMPLE_S: f64 = 0.125;

/// Largest distance of the certified margin below the true minimum, besides the prediction's own bound,
/// metres.
const SLACK_M: f64 = 0.02;

/// Largest error by rounding, metres.
const ROUNDING_M: f64 = 1e-7;

impl Random {
    fn vector(&mut self, size: f64, height: f64) -> Vec3 {
        Vec3::new(
            self.within(-size, size),
            self.within(-size, size),
            self.within(-height, height),
        )
    }

    fn vehicle(&mut self) -> Vehicle {
        let climb = if self.chance(0.3) {
            0.0
        } else {
            self.within(0.05, 0.6)
        };
        let lagged = self.chance(0.3);
        Vehicle {
            airspeed_mps: self.within(8.0, 60.0),
            turn_radius_m: self.within(15.0, 300.0),
            climb_min_rad: -climb,
            climb_max_rad: climb,
            climb_rate_radps: self.within(0.02, 0.6),
            response: Response {
                dead_time_s: 0.0,
                bank_time_constant_s: if lagged { self.within(0.1, 1.5) } else { 0.0 },
                turn_rate_factor: if self.chance(0.5) {
                    1.0
                } else {
                    self.within(0.5, 1.2)
                },
            },
        }
    }

    fn maneuver(&mut self, course_rad: f64) -> Maneuver {
        let mut maneuver = Maneuver::hold();
        let stages = 1 + (self.unit() * 3.0) as usize;
        let mut start_s = if self.chance(0.5) {
            0.0
        } else {
            self.within(0.0, 8.0)
        };
        let mut course = course_rad;
        for _ in 0..stages {
            course += self.within(-6.0, 6.0);
            assert!(maneuver.push(Stage {
                start_s,
                course_rad: course,
                climb_rad: self.within(-0.5, 0.5),
                rate_share: if self.chance(0.7) {
                    1.0
                } else {
                    self.within(0.2, 1.0)
                },
            }));
            start_s += self.within(0.0, 12.0);
        }
        maneuver
    }

    /// A hazard near a point at a time, so that the answer is seldom trivial.
    fn extent(&mut self, near_m: Vec3, at_s: f64) -> Extent {
        let velocity_mps = if self.chance(0.3) {
            Vec3::ZERO
        } else {
            self.vector(45.0, 8.0)
        };
        let volume = if self.chance(0.5) {
            ProtectedVolume::Sphere {
                radius_m: self.within(0.0, 80.0),
            }
        } else {
            ProtectedVolume::Cylinder {
                radius_m: self.within(1.0, 200.0),
                half_height_m: self.within(1.0, 60.0),
            }
        };
        let reach = 1.5 * volume.radius_m() + 5.0;
        Extent {
            position_m: near_m - velocity_mps * at_s + self.vector(reach, 0.7 * reach),
            velocity_mps,
            volume,
            growth_mps: if self.chance(0.5) {
                0.0
            } else {
                self.within(0.0, 2.5)
            },
            allowed_depth_m: NO_DEPTH,
            stretch_m: if self.chance(0.7) {
                (0.0, 0.0)
            } else {
                (self.within(0.0, 40.0), self.within(0.0, 2.5))
            },
            window_s: ALWAYS,
        }
    }
}

/// Distance from the hazard's surface, metres, or minus the depth inside, by elementary geometry.
fn margin_m(hazard: &Extent, position_m: Vec3, at_s: f64) -> f64 {
    let mut offset = position_m - (hazard.position_m + hazard.velocity_mps * at_s);
    // From the nearest point of the stretched centre line.
    let (now_m, more_mps) = hazard.stretch_m;
    let along_m = now_m + more_mps * at_s;
    offset.z -= offset.z.max(-along_m).min(along_m);
    let distance = match hazard.volume {
        ProtectedVolume::Sphere { radius_m } => {
            (offset.x.powi(2) + offset.y.powi(2) + offset.z.powi(2)).sqrt() - radius_m
        }
        ProtectedVolume::Cylinder {
            radius_m,
            half_height_m,
        } => {
            let beside = offset.x.hypot(offset.y) - radius_m;
            let above = offset.z.abs() - half_height_m;
            if hazard.allowed_depth_m >= 0.0 && beside < 0.0 && above < 0.0 {
                // As two resistances in parallel, in shares of the volume.
                radius_m.min(half_height_m) / (radius_m / beside + half_height_m / above)
            } else {
                beside.max(0.0).hypot(above.max(0.0)) + beside.max(above).min(0.0)
            }
        }
    };
    distance + hazard.allowed_depth_m.max(0.0) - hazard.growth_mps * at_s
}

/// Least margin from samples, with a closer look at every dip that could be the least.
fn sampled_m(margin: impl Fn(f64) -> f64, until_s: f64) -> f64 {
    let count = (until_s / SAMPLE_S).ceil().max(2.0);
    let step_s = until_s / count;
    let values: Vec<f64> = (0..=count as usize)
        .map(|k| margin(k as f64 * step_s))
        .collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let mut exact = least;
    for (k, value) in values.iter().enumerate() {
        let before = k.checked_sub(1).map_or(f64::INFINITY, |k| values[k]);
        let after = values.get(k + 1).copied().unwrap_or(f64::INFINITY);
        if *value > before || *value > after || *value > least + 130.0 * step_s {
            continue;
        }
        let mut low = (k as f64 - 1.0).max(0.0) * step_s;
        let mut high = ((k as f64 + 1.0) * step_s).min(until_s);
        for _ in 0..32 {
            let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if margin(left) < margin(right) {
                high = right;
            } else {
                low = left;
            }
        }
        exact = exact.min(margin(0.5 * (low + high)));
    }
    exact
}

/// Checks one case; returns the distance of the certified margin below the sampled one.
fn check(case: u64, path: &mut FlightPath) -> Option<f64> {
    let mut random = Random(case.wrapping_mul(0x2545_f491_4f6c_dd1d));
    let vehicle = random.vehicle();
    let flyer = Flyer::new(&vehicle);
    let start = MotionState {
        time_s: 0.0,
        position_m: random.vector(100.0, 50.0),
        course_rad: random.within(-10.0, 10.0),
        climb_rad: random.within(vehicle.climb_min_rad, vehicle.climb_max_rad.max(1e-300)),
        bank_rad: if flyer.is_ideal() {
            0.0
        } else {
            random.within(-0.6, 0.6)
        },
    };
    let maneuver = random.maneuver(start.course_rad);
    let horizon_s = random.within(5.0, 60.0);
    path.predict(&flyer, &start, &maneuver, horizon_s);
    let at_s = random.within(0.0, horizon_s);
    let near = path.state_at(&flyer, at_s)?;
    let mut hazard = random.extent(near.position_m, at_s);
    let is_cylinder = matches!(hazard.volume, ProtectedVolume::Cylinder { .. });
    if case.is_multiple_of(2) && is_cylinder {
        hazard.allowed_depth_m = (case % 40) as f64;
    }
    let enough_m = if random.chance(0.7) {
        1e6
    } else {
        random.within(-10.0, 60.0)
    };
    let margin = |time_s: f64| {
        let state = path.state_at(&flyer, time_s).expect("a path has nodes");
        margin_m(&hazard, state.position_m, time_s)
    };
    let certificate = certify_set(
        &flyer,
        path,
        &Assumptions::only(&[Hazard::compared(0, hazard)]),
        (horizon_s, f64::MIN, enough_m),
        &Meter::unlimited(),
    );
    if certificate.status != Status::Proven {
        assert!(!path.is_complete(), "{case}: {certificate:?}");
        assert!(!certificate.holds(-1e9));
        return None;
    }
    let truth = sampled_m(margin, horizon_s);
    let claimed = certificate.margin_m;
    assert!(
        claimed <= truth.min(enough_m) + ROUNDING_M,
        "case {case}: {claimed} m certified, {truth} m flown; {hazard:?} {maneuver:?} {vehicle:?}"
    );
    // With a floor the certificate reports it, and only if the margin is below; all hazards together give the worst one.
    let floored = certify_set(
        &flyer,
        path,
        &Assumptions::only(&[Hazard::compared(0, hazard)]),
        (horizon_s, claimed + 0.5, enough_m),
        &Meter::unlimited(),
    );
    assert!(
        floored.status == Status::BelowFloor || floored.margin_m >= claimed + 0.5,
        "case {case}: {floored:?}"
    );
    let both = certify_set(
        &flyer,
        path,
        &Assumptions::only(&[Hazard::compared(0, hazard); 2]),
        (horizon_s, f64::MIN, enough_m),
        &Meter::unlimited(),
    );
    assert!(
        both.margin_m <= truth.min(enough_m) + ROUNDING_M,
        "case {case}: {both:?}"
    );
    let given_away = truth.min(enough_m) - claimed;
    assert!(
        given_away <= SLACK_M + path.remainder_m(),
        "case {case}: {claimed} m certified, {truth} m flown; {hazard:?} {maneuver:?} {vehicle:?}"
    );
    // A requested margin is certified wherever that much exists plus the prediction's bound:
    // a way back requests exactly its margin.
    if truth > enough_m + SLACK_M + path.remainder_m() {
        assert!(
            certificate.holds(enough_m),
            "case {case}: {certificate:?}, {truth} m flown, {enough_m} m asked for"
        );
    }
    Some(given_away)
}

fn cases() -> u64 {
    std::env::var("FGA_CERTIFICATE_CASES")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(100_000)
}

#[test]
fn a_certified_margin_is_never_above_what_is_flown() {
    let total = cases();
    let threads = std::thread::available_parallelism().map_or(1, core::num::NonZero::get) as u64;
    let (proven, largest) = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|worker| {
                scope.spawn(move || {
                    let mut path = FlightPath::new();
                    let (mut proven, mut largest) = (0_u64, 0.0_f64);
                    for case in (worker..total).step_by(threads as usize) {
                        if let Some(given_away) = check(case, &mut path) {
                            proven += 1;
                            largest = largest.max(given_away);
                        }
                    }
                    (proven, largest)
                })
            })
            .collect();
        workers
            .into_iter()
            .map(|worker| worker.join().expect("no case fails"))
            .fold((0, 0.0_f64), |a, b| (a.0 + b.0, a.1.max(b.1)))
    });
    println!("{proven} of {total} cases proven, at most {largest:.5} m given away");
    assert!(proven * 10 >= total * 9, "{proven} of {total} proven");
}

/// An earlier version subtracted the bound of a prediction with bank lag from the largest requested margin, so
/// that no flight with lag ever had that margin.
#[test]
fn a_clear_flight_with_lag_has_the_margin_that_is_asked_about() {
    let mut vehicle = Vehicle::table_4();
    vehicle.response.bank_time_constant_s = 0.6;
    let flyer = Flyer::new(&vehicle);
    let start = MotionState {
        time_s: 0.0,
        position_m: Vec3::ZERO,
        course_rad: 0.0,
        climb_rad: 0.0,
        bank_rad: 0.0,
    };
    let mut path = FlightPath::new();
    path.predict(&flyer, &start, &Maneuver::turn(0.0, 2.0, 0.0), 60.0);
    assert!(path.remainder_m() > 0.0 && path.remainder_m() < 0.01);
    let far = Obstacle::straight(
        1,
        Vec3::new(0.0, -500.0, 0.0),
        Vec3::ZERO,
        ProtectedVolume::Sphere { radius_m: 30.0 },
    );
    let hazard = Hazard::new(&far, Vec3::ZERO, 0.0);
    for asked_m in [0.025, 0.05, 3.0] {
        let certificate = certify_set(
            &flyer,
            &path,
            &Assumptions::only(&[hazard]),
            (60.0, asked_m, asked_m),
            &Meter::unlimited(),
        );
        assert!(certificate.holds(asked_m), "{certificate:?}");
    }
}
