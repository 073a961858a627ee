//! Certificates of drawn manoeuvres against flights of another program: [`fga_sim::fine`], which shares no code with
//! them. Bank lag, climbs to the limit, positions 100 km from the origin, wind, growing volumes, many corners.
//!
//! A certified margin may lie above the flown one by [`ROUNDING_M`] at most, a predicted position beside the flown one
//! by that and the prediction's own bound, and by [`OFF_M`] whatever that bound is.

use clap::Args;
use fga::Vec3;
use fga::assumptions::Assumptions;
use fga::certificate::{Hazard, Status, certify_set};
use fga::maneuver::{Maneuver, Stage};
use fga::meter::Meter;
use fga::prediction::{FlightPath, Flyer, MotionState};
use fga::situation::{Obstacle, Ownship, ProtectedVolume};
use fga::vehicle::{Response, STANDARD_GRAVITY_MPS2, Vehicle};
use fga_campaign::encounters::{Random, Range};
use fga_sim::fine::{FineFlight, GrowingBody};
use rayon::prelude::*;

/// Accepted excess of the certified margin over the flown one, metres.
const ROUNDING_M: f64 = 1e-3;

/// Accepted distance of a predicted position from the flown one, metres.
const OFF_M: f64 = 0.01;

/// Accepted share of flights whose prediction has no bound, of which nothing is proven.
const MOST_UNBOUNDED: f64 = 0.01;

/// Work that the certificate may take: more than any of these manoeuvres needs.
const WORK: f64 = 1e6;

/// Flights between two lines of progress.
const BLOCK: u64 = 10_000;

/// Options of `certificates`.
#[derive(Args, Debug)]
pub(crate) struct CertificatesArgs {
    /// Number of flights.
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    count: u64,
    /// Master seed.
    #[arg(default_value_t = 1)]
    seed: u64,
    /// Number of the first flight: where an interrupted run goes on.
    #[arg(long, default_value_t = 0)]
    from: u64,
}

/// A drawn manoeuvre of an aircraft past an obstacle, in wind.
struct CertificateCase {
    vehicle: Vehicle,
    own: Ownship,
    wind_mps: Vec3,
    maneuver: Maneuver,
    horizon_s: f64,
    /// What draws the obstacle.
    random: Random<'static>,
}

/// A certificate beside its flight, metres.
#[derive(Clone, Copy, Default)]
struct Compared {
    /// Certified above flown margin.
    above_m: f64,
    /// Certified below flown margin.
    below_m: f64,
    /// Predicted from flown position.
    off_m: f64,
    /// The same beyond the prediction's own bound.
    off_beyond_m: f64,
    /// Flights whose prediction has no bound: nothing may be proven of them.
    unbounded: u64,
    /// Whether something is proven without a bound, or nothing with one.
    wrong_status: bool,
}

impl Compared {
    fn and(self, other: Self) -> Self {
        Self {
            above_m: self.above_m.max(other.above_m),
            below_m: self.below_m.max(other.below_m),
            off_m: self.off_m.max(other.off_m),
            off_beyond_m: self.off_beyond_m.max(other.off_beyond_m),
            unbounded: self.unbounded + other.unbounded,
            wrong_status: self.wrong_status || other.wrong_status,
        }
    }

    /// NaN does not hold.
    fn holds(&self) -> bool {
        self.above_m <= ROUNDING_M
            && self.off_beyond_m <= ROUNDING_M
            && self.off_m <= OFF_M
            && !self.wrong_status
    }
}

/// A drawn vehicle for which a certificate may be made.
fn vehicle(random: &mut Random) -> Vehicle {
    loop {
        let vehicle = any_vehicle(random);
        if vehicle.check().is_ok() {
            return vehicle;
        }
    }
}

fn any_vehicle(random: &mut Random) -> Vehicle {
    let airspeed_mps = random.within(Range(8.0, 60.0));
    let bank = random.within(Range(0.2, 1.05));
    let climb = random.within(Range(0.0, 0.4));
    Vehicle {
        airspeed_mps,
        turn_radius_m: airspeed_mps * airspeed_mps / (STANDARD_GRAVITY_MPS2 * libm::tan(bank)),
        climb_min_rad: -climb,
        climb_max_rad: climb,
        climb_rate_radps: random.within(Range(0.02, 0.6)),
        response: Response {
            dead_time_s: 0.0,
            bank_time_constant_s: if random.unit() < 0.6 {
                random.within(Range(0.1, 1.5))
            } else {
                0.0
            },
            turn_rate_factor: random.within(Range(0.5, 1.2)),
        },
    }
}

fn ownship(random: &mut Random, vehicle: &Vehicle) -> Ownship {
    let far = if random.unit() < 0.2 { 1e5 } else { 100.0 };
    let climb = vehicle.climb_max_rad;
    let tan_bank = vehicle.airspeed_mps * vehicle.airspeed_mps
        / (STANDARD_GRAVITY_MPS2 * vehicle.turn_radius_m);
    let bank = libm::atan(tan_bank);
    Ownship {
        position_m: Vec3::new(
            random.within(Range(-far, far)),
            random.within(Range(-far, far)),
            300.0,
        ),
        course_rad: random.within(Range(-8.0, 8.0)),
        climb_rad: random.within(Range(-climb, climb)),
        bank_rad: if vehicle.response.bank_time_constant_s > 0.0 {
            random.within(Range(-bank, bank))
        } else {
            0.0
        },
        airspeed_mps: vehicle.airspeed_mps,
    }
}

fn maneuver(random: &mut Random, from_rad: f64) -> Maneuver {
    let mut maneuver = Maneuver::hold();
    let stages = [1, 2, 2, 3, 9][random.count(0, 4) as usize];
    let mut start_s = random.within(Range(-2.0, 4.0)).max(0.0);
    let mut course_rad = from_rad;
    for _ in 0..stages {
        course_rad += random.within(Range(-2.0, 2.0)) * random.unit();
        let fits = maneuver.push(Stage {
            start_s,
            course_rad,
            climb_rad: random.within(Range(-0.5, 0.5)),
            rate_share: if random.unit() < 0.9 {
                1.0
            } else {
                random.within(Range(0.2, 1.0))
            },
        });
        assert!(fits, "a manoeuvre holds nine stages");
        start_s += random.within(Range(0.0, 5.0));
    }
    maneuver
}

/// An obstacle that is near a place of the flight at a moment of it.
fn body(random: &mut Random, near_m: Vec3, at_s: f64) -> GrowingBody {
    let volume = if random.unit() < 0.5 {
        ProtectedVolume::Sphere {
            radius_m: random.within(Range(5.0, 80.0)),
        }
    } else {
        ProtectedVolume::Cylinder {
            radius_m: random.within(Range(5.0, 200.0)),
            half_height_m: random.within(Range(5.0, 60.0)),
        }
    };
    let reach = volume.radius_m() + 8.0;
    let beside = Vec3::new(
        random.within(Range(-reach, reach)),
        random.within(Range(-reach, reach)),
        random.within(Range(-0.5 * reach, 0.5 * reach)),
    );
    let velocity_mps = if random.unit() < 0.3 {
        Vec3::ZERO
    } else {
        let (sin, cos) = libm::sincos(random.within(Range(-3.2, 3.2)));
        Vec3::new(cos, sin, random.within(Range(-0.1, 0.1))) * random.within(Range(0.0, 60.0))
    };
    GrowingBody {
        position_m: near_m + beside - velocity_mps * at_s,
        velocity_mps,
        volume,
        growth_mps: if random.unit() < 0.3 {
            random.within(Range(0.0, 2.5))
        } else {
            0.0
        },
    }
}

impl CertificateCase {
    fn drawn(seed: u64, number: u64) -> Self {
        let mut random = Random::new(seed, number);
        let vehicle = vehicle(&mut random);
        let own = ownship(&mut random, &vehicle);
        let wind = random.within(Range(0.0, 0.9 * vehicle.airspeed_mps));
        let (sin, cos) = libm::sincos(random.within(Range(-3.2, 3.2)));
        let wind_mps = Vec3::new(cos, sin, 0.0) * wind;
        let maneuver = maneuver(&mut random, own.course_rad);
        let horizon_s = random.within(Range(5.0, 30.0));
        Self {
            vehicle,
            own,
            wind_mps,
            maneuver,
            horizon_s,
            random,
        }
    }

    fn compare(mut self, path: &mut FlightPath) -> Compared {
        let h_s = self.horizon_s;
        let at_s = self.random.within(Range(0.0, h_s));
        let mut stops_s = [at_s, 0.25 * h_s, 0.5 * h_s, 0.75 * h_s, h_s];
        stops_s.sort_by(f64::total_cmp);
        let mut flight = FineFlight::new(&self.vehicle, self.wind_mps, &self.own, &self.maneuver);
        let flown_m = stops_s.map(|stop_s| flight.fly(stop_s));
        let near_m = flown_m[stops_s.partition_point(|stop_s| *stop_s < at_s)];
        let body = body(&mut self.random, near_m, at_s);
        let flyer = Flyer::new(&self.vehicle);
        let mut obstacle = Obstacle::straight(1, body.position_m, body.velocity_mps, body.volume);
        obstacle.uncertainty.velocity_mps = body.growth_mps;
        let hazard = Hazard::new(&obstacle, self.wind_mps, 1.0);
        let start = MotionState::of(&self.own);
        path.predict(&flyer, &start, &self.maneuver, self.horizon_s);
        let certificate = certify_set(
            &flyer,
            path,
            &Assumptions::only(&[hazard]),
            (self.horizon_s, f64::MIN, WORK),
            &Meter::unlimited(),
        );
        let is_proven = certificate.status == Status::Proven;
        if !path.is_complete() {
            return Compared {
                unbounded: 1,
                wrong_status: is_proven,
                ..Compared::default()
            };
        }
        let off_m = stops_s.iter().zip(&flown_m).map(|(stop_s, flown_m)| {
            let predicted = path.state_at(&flyer, *stop_s).expect("it has nodes");
            flown_m.distance(predicted.position_m + self.wind_mps * *stop_s)
        });
        let off_m = off_m.fold(0.0, f64::max);
        let flown_m = flight.least_margin_m(&[body]);
        Compared {
            above_m: certificate.margin_m - flown_m,
            below_m: flown_m - certificate.margin_m,
            off_m,
            off_beyond_m: off_m - path.remainder_m(),
            unbounded: 0,
            wrong_status: !is_proven,
        }
    }
}

/// Compares every certificate with its flight; fails at the first block in which one does not hold.
pub(crate) fn run(args: &CertificatesArgs) -> Result<(), String> {
    let end = args.from.saturating_add(args.count);
    let mut all = Compared::default();
    let mut from = args.from;
    while from < end {
        let to = end.min(from + BLOCK);
        let block = (from..to)
            .into_par_iter()
            .map_init(FlightPath::new, |path, number| {
                let compared = CertificateCase::drawn(args.seed, number).compare(path);
                if compared.holds() {
                    Ok(compared)
                } else {
                    Err(format!(
                        "flight {number} of seed {}: {:.4} m certified above the flown margin, {:.4} m off, \
                         {:.4} m beyond the bound, wrong status: {}",
                        args.seed,
                        compared.above_m,
                        compared.off_m,
                        compared.off_beyond_m,
                        compared.wrong_status
                    ))
                }
            })
            .try_reduce(Compared::default, |a, b| Ok(a.and(b)))?;
        all = all.and(block);
        from = to;
        if from < end {
            eprintln!("{from} flown; an interrupted run goes on with --from {from}");
        }
    }
    if all.unbounded as f64 > MOST_UNBOUNDED * args.count as f64 + 3.0 {
        return Err(format!(
            "the prediction of {} of {} flights has no bound",
            all.unbounded, args.count
        ));
    }
    println!(
        "0 of {} certified above what is flown by more than {ROUNDING_M} m: {:.4} m above, {:.4} m below at most; \
         predicted positions {:.4} m off at most, none beyond the bound; {} without a bound, none of them certified",
        args.count, all.above_m, all.below_m, all.off_m, all.unbounded
    );
    Ok(())
}
