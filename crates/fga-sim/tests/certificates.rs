//! Certificates against flights from a separate integration: [`fga_sim::fine`].
//!
//! `FGA_CERTIFICATE_FLIGHTS` sets the number of random manoeuvres.
#![expect(clippy::cast_possible_truncation, reason = "small counts")]

use std::path::{Path, PathBuf};

use fga::Vec3;
use fga::avoider::{Avoider, Settings, Start, Verdict};
use fga::certificate::{Hazard, Status, certify};
use fga::maneuver::{Maneuver, Stage};
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::{Mission, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation};
use fga::vehicle::{Response, Vehicle};
use fga_sim::fine::{Body, FineFlight};
use fga_sim::policy::PolicyChoice;
use fga_sim::run;
use fga_sim::scenario;
use fga_sim::vehicle_file::VehicleModel;

/// Accepted excess of the certified margin over the flown one, metres.
const ROUNDING_M: f64 = 1e-3;

/// A folder of third-party data; `None` if it is missing, which continuous integration refuses.
fn data(relative: &str) -> Option<PathBuf> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = std::env::var_os("FGA_DATA")
        .map_or_else(|| repository.join("../shared/data"), PathBuf::from);
    let path = folder.join(relative);
    if path.exists() {
        return Some(path);
    }
    assert!(
        std::env::var("CI").as_deref() != Ok("true"),
        "{} is missing",
        path.display()
    );
    eprintln!("skipped: {} is missing", path.display());
    None
}

/// `SplitMix64` (Steele, Lea and Flood 2014): the same cases on every machine.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

/// A drawn manoeuvre of an aircraft past an obstacle, in wind.
struct Case {
    vehicle: Vehicle,
    own: Ownship,
    wind_mps: Vec3,
    maneuver: Maneuver,
    body: Body,
    horizon_s: f64,
}

impl Case {
    fn drawn(number: u64) -> Self {
        let mut random = Random(number.wrapping_mul(0x2545_f491_4f6c_dd1d));
        let airspeed_mps = random.within(8.0, 60.0);
        let bank = random.within(0.2, 1.05);
        let climb = random.within(0.0, 0.4);
        let lagged = random.unit() < 0.6;
        let vehicle = Vehicle {
            airspeed_mps,
            turn_radius_m: airspeed_mps * airspeed_mps / (9.806_65 * bank.tan()),
            climb_min_rad: -climb,
            climb_max_rad: climb,
            climb_rate_radps: random.within(0.02, 0.6),
            response: Response {
                dead_time_s: 0.0,
                bank_time_constant_s: if lagged { random.within(0.1, 1.5) } else { 0.0 },
                turn_rate_factor: random.within(0.5, 1.2),
            },
        };
        let far = if random.unit() < 0.2 { 1e5 } else { 100.0 };
        let own = Ownship {
            position_m: Vec3::new(random.within(-far, far), random.within(-far, far), 300.0),
            course_rad: random.within(-8.0, 8.0),
            climb_rad: random.within(-climb, climb),
            bank_rad: if lagged {
                random.within(-bank, bank)
            } else {
                0.0
            },
            airspeed_mps,
        };
        let wind = random.within(0.0, 0.9 * airspeed_mps);
        let from = random.within(-3.2, 3.2);
        let wind_mps = Vec3::new(from.cos(), from.sin(), 0.0) * wind;
        let mut maneuver = Maneuver::hold();
        let stages = [1, 2, 2, 3, 9][number as usize % 5];
        let (mut start_s, mut course_rad) = (random.within(-2.0, 4.0).max(0.0), own.course_rad);
        for _ in 0..stages {
            course_rad += random.within(-2.0, 2.0) * random.unit();
            assert!(maneuver.push(Stage {
                start_s,
                course_rad,
                climb_rad: random.within(-0.5, 0.5),
                rate_share: if random.unit() < 0.9 {
                    1.0
                } else {
                    random.within(0.2, 1.0)
                },
            }));
            start_s += random.within(0.0, 5.0);
        }
        let horizon_s = random.within(5.0, 30.0);
        let mut flight = FineFlight::new(&vehicle, wind_mps, &own, &maneuver);
        let at_s = random.within(0.0, horizon_s);
        flight.fly(at_s, |_, _, _| ());
        let volume = if random.unit() < 0.5 {
            ProtectedVolume::Sphere {
                radius_m: random.within(5.0, 80.0),
            }
        } else {
            ProtectedVolume::Cylinder {
                radius_m: random.within(5.0, 200.0),
                half_height_m: random.within(5.0, 60.0),
            }
        };
        let reach = volume.radius_m() + 8.0;
        let beside = Vec3::new(
            random.within(-reach, reach),
            random.within(-reach, reach),
            random.within(-0.5 * reach, 0.5 * reach),
        );
        let velocity_mps = if random.unit() < 0.3 {
            Vec3::ZERO
        } else {
            let heading = random.within(-3.2, 3.2);
            Vec3::new(heading.cos(), heading.sin(), random.within(-0.1, 0.1))
                * random.within(0.0, 60.0)
        };
        let body = Body {
            position_m: flight.state().position_m + beside - velocity_mps * at_s,
            velocity_mps,
            volume,
            growth_mps: if random.unit() < 0.3 {
                random.within(0.0, 2.5)
            } else {
                0.0
            },
        };
        Self {
            vehicle,
            own,
            wind_mps,
            maneuver,
            body,
            horizon_s,
        }
    }

    /// The certified margin's distance below the flown one, and the prediction's distance from the flight, metres.
    fn check(&self, number: u64, path: &mut FlightPath) -> (f64, f64) {
        let flyer = Flyer::new(&self.vehicle);
        let body = &self.body;
        let mut obstacle = Obstacle::new(1, body.position_m, body.velocity_mps, body.volume);
        obstacle.uncertainty.velocity_mps = body.growth_mps;
        let hazard = Hazard::new(0, &obstacle, self.wind_mps, 1.0);
        let start = MotionState::of(&self.own);
        path.predict(&flyer, &start, &self.maneuver, self.horizon_s);
        let certificate = certify(&flyer, path, &hazard, self.horizon_s, f64::MIN, 1e6);
        assert!(
            path.is_complete() && certificate.status == Status::Proven,
            "{number}"
        );
        let mut flight = FineFlight::new(&self.vehicle, self.wind_mps, &self.own, &self.maneuver);
        let (mut off_m, mut flown_m) = (0.0_f64, f64::INFINITY);
        for k in 1..=4 {
            let at_s = self.horizon_s * f64::from(k) / 4.0;
            flown_m = flown_m.min(flight.least_margin_m(core::slice::from_ref(body), at_s));
            let predicted = path.state_at(&flyer, at_s).expect("nodes");
            let over_ground = predicted.position_m + self.wind_mps * at_s;
            off_m = off_m.max(over_ground.distance(flight.state().position_m));
        }
        assert!(
            off_m <= path.remainder_m() + ROUNDING_M,
            "case {number}: {off_m} m off, bound {} m, {:?} {:?}",
            path.remainder_m(),
            self.vehicle,
            self.maneuver
        );
        assert!(
            certificate.margin_m <= flown_m + ROUNDING_M,
            "case {number}: {} m certified, {flown_m} m flown, {:?} {:?}",
            certificate.margin_m,
            self.vehicle,
            self.maneuver
        );
        (flown_m - certificate.margin_m, off_m)
    }
}

/// Lag, climbs to the limit, 100 km from the origin, wind, growing volumes, many corners.
#[test]
fn a_certified_margin_is_never_above_what_another_program_flies() {
    let total: u64 = std::env::var("FGA_CERTIFICATE_FLIGHTS")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(4_000);
    let threads = std::thread::available_parallelism().map_or(1, core::num::NonZero::get) as u64;
    let largest = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|worker| {
                scope.spawn(move || {
                    let mut path = FlightPath::new();
                    let mut largest = (0.0_f64, 0.0_f64);
                    for number in (worker..total).step_by(threads as usize) {
                        let (away_m, off_m) = Case::drawn(number).check(number, &mut path);
                        largest = (largest.0.max(away_m), largest.1.max(off_m));
                    }
                    largest
                })
            })
            .collect();
        workers
            .into_iter()
            .map(|worker| worker.join().expect("no case fails"))
            .fold((0.0_f64, 0.0_f64), |a, b| (a.0.max(b.0), a.1.max(b.1)))
    });
    println!(
        "{total} flights: {:.4} m given away, {:.4} m off at most",
        largest.0, largest.1
    );
    assert!(largest.1 < 0.01, "{} m off within 30 s", largest.1);
    assert!(largest.0 < 0.1, "{} m given away", largest.0);
}

/// The first decision of an avoider: the certified and the flown margin of its manoeuvre, metres.
fn first_decision(
    settings: Settings,
    vehicle: &Vehicle,
    own: Ownship,
    mission_m: &[Vec3],
    obstacles: &[Obstacle],
) -> Option<(f64, f64)> {
    let horizon_s = settings.horizon_s;
    let mut avoider = Avoider::new(settings, *vehicle).expect("accepted");
    let decision = avoider.step(&Situation {
        time_s: 0.0,
        ownship: own,
        obstacles: Obstacles::Rows(obstacles),
        mission: Mission::new(mission_m),
        wind_mps: Vec3::ZERO,
    });
    let chosen = decision.record.chosen?;
    if chosen.verdict != Verdict::Chosen {
        return None;
    }
    let bodies: Vec<Body> = obstacles
        .iter()
        .map(|obstacle| Body {
            position_m: obstacle.position_m,
            velocity_mps: obstacle.velocity_mps,
            volume: obstacle.volume,
            growth_mps: 0.0,
        })
        .collect();
    let flown_m = FineFlight::new(vehicle, Vec3::ZERO, &own, &decision.command)
        .least_margin_m(&bodies, horizon_s);
    Some((chosen.margin_m, flown_m))
}

/// An earlier version put nine stages into eight places: it dropped the avoiding turn and kept the margin.
#[test]
fn the_first_decisions_of_the_trial_missions_keep_what_they_certify() {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut decided = 0;
    for number in [25, 74, 79] {
        let Some(file) = data(&format!("trials/false-certificate-1-{number}.toml")) else {
            return;
        };
        let mut model = VehicleModel::read(&repository.join("vehicles/paper-planar.toml"))
            .expect("a vehicle of this repository");
        model.settings.avoider.surveillance_radius_m = f64::INFINITY;
        let plan = scenario::read(&file, Some(model)).expect("a scenario");
        let policy = PolicyChoice::parse("turn-aware", None).expect("a policy");
        let world = &plan.world;
        let obstacles: Vec<Obstacle> = world
            .obstacles
            .iter()
            .filter_map(|known| {
                let (position_m, velocity_mps) = known.track.at(0.0)?;
                Some(Obstacle::new(
                    known.id,
                    position_m,
                    velocity_mps,
                    known.volume,
                ))
            })
            .collect();
        let own = Ownship {
            position_m: world.start.position_m,
            course_rad: world.start.course_rad,
            climb_rad: world.start.climb_rad,
            bank_rad: 0.0,
            airspeed_mps: world.vehicle.airspeed_mps,
        };
        let settings = Settings {
            start: Start::Free,
            ..world.settings.avoider
        };
        let first = first_decision(settings, &world.vehicle, own, &world.mission_m, &obstacles);
        if let Some((claimed_m, flown_m)) = first {
            decided += 1;
            assert!(
                claimed_m <= flown_m + ROUNDING_M,
                "{number}: {claimed_m} m certified, {flown_m} m flown"
            );
        }
        let log = run::fly(plan, &policy, &mut |_| ()).expect("it flies");
        assert!(log.outcome.separated(), "{number}: {:?}", log.outcome);
    }
    assert!(decided > 0, "nothing was decided");
}

/// The same for random missions of legs from one to three turn radii.
#[test]
fn missions_of_short_legs_keep_what_they_certify() {
    let vehicle = Vehicle::table_4().with_climb(0.0, 0.0, 0.0);
    let settings = Settings {
        surveillance_radius_m: f64::INFINITY,
        ..Settings::default()
    };
    let mut certified = 0;
    for seed in 0..400 {
        let mut random = Random(seed);
        let mut mission_m = vec![Vec3::ZERO, Vec3::new(80.0, 0.0, 0.0)];
        let mut at = Vec3::new(80.0, 0.0, 0.0);
        for k in 0..30 {
            let course = random.within(0.3, 0.9) * if k % 2 == 0 { 1.0 } else { -1.0 };
            at += Vec3::new(course.cos(), course.sin(), 0.0) * random.within(45.0, 90.0);
            mission_m.push(at);
        }
        let meets_s = random.within(15.0, 55.0);
        let heading = random.within(-3.1, 3.1);
        let velocity_mps = Vec3::new(heading.cos(), heading.sin(), 0.0) * random.within(3.0, 20.0);
        let near = Vec3::new(13.5 * meets_s, random.within(-20.0, 60.0), 0.0);
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        let obstacle = Obstacle::new(1, near - velocity_mps * meets_s, velocity_mps, volume);
        let own = Ownship {
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 15.0,
        };
        if volume.margin_m(obstacle.position_m) < 0.0 {
            continue;
        }
        let first = first_decision(settings, &vehicle, own, &mission_m, &[obstacle]);
        if let Some((claimed_m, flown_m)) = first {
            certified += 1;
            assert!(
                claimed_m <= flown_m + ROUNDING_M,
                "seed {seed}: {claimed_m} m certified, {flown_m} m flown"
            );
        }
    }
    assert!(certified > 100, "{certified} certified");
}
