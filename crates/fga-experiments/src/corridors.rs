//! Drawn encounters in corridors in wind: is a fence left that an oracle with the same fence keeps, and is the aircraft on its way back once
//! the intruder has passed?

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "drawn numbers are small and not negative"
)]

use clap::Args;
use core::f64::consts::TAU;

use fga::avoider::State;
use fga::situation::{Movement, ProtectedVolume};
use fga::vehicle::{Response, Vehicle};
use fga::zone::ALL_HEIGHTS_M;
use fga::{Vec2, Vec3};
use fga_campaign::campaign::parse_policy;
use fga_campaign::oracle::{
    OracleObstacle, OracleSettings, OracleStart, OracleVehicle, airspace_of, best_margin_within,
};
use fga_sim::engine::{DecisionMoment, Engine, Observer, Sample};
use fga_sim::policy::PolicyChoice;
use fga_sim::track::Track;
use fga_sim::wind::crab;
use fga_sim::world::{Ending, StartState, World, WorldObstacle, WorldOutline, WorldZone};
use rayon::prelude::*;

use crate::common::{DrawnArgs, model};
use crate::intruders::traffic::SplitMix64;

/// On the leg within this distance, metres.
const ON_LEG_M: f64 = 5.0;

/// A flight that is longer away, or flown backwards, after the intruder has passed is counted, seconds.
const AWAY_S: f64 = 60.0;
const BACKWARDS_S: f64 = 30.0;

/// What the oracle keeps at least where an encounter is avoidable, metres.
const AVOIDABLE_M: f64 = 1.0;

/// Horizon of the oracle, seconds.
const ORACLE_S: f64 = 60.0;

/// How the intruder comes, and the angle from the leg's direction, turns.
const COURSES: [(&str, f64); 3] = [("head-on", 0.5), ("crossing", 0.25), ("overtaking", 0.0)];

/// Options of `corridors`.
#[derive(Args, Debug)]
pub(crate) struct CorridorArgs {
    #[command(flatten)]
    drawn: DrawnArgs,
    /// Fly only the encounter with this number, and print its decisions.
    #[arg(long)]
    only: Option<u64>,
    /// The policy, as in "published --start t0".
    #[arg(long, default_value = "turn-aware")]
    policy: String,
    /// Aircraft alone, which report once a second with σ of 5 m and 0.5 m/s.
    #[arg(long)]
    noisy: bool,
}

/// A flight along the x axis.
#[derive(Default)]
struct CorridorFlight {
    shows: bool,
    intruder: Option<Track>,
    samples: Vec<(Sample, f64)>,
    words: Vec<(f64, State, String)>,
}

impl Observer for CorridorFlight {
    fn sample(&mut self, sample: &Sample) {
        let there = self
            .intruder
            .as_ref()
            .and_then(|track| track.at(sample.time_s));
        let off_m = there.map_or(f64::INFINITY, |(at_m, _)| at_m.distance(sample.position_m));
        self.samples.push((*sample, off_m));
    }

    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let word = format!("{:?}", moment.decision.record.reason);
        if self.shows
            && self
                .words
                .last()
                .is_none_or(|(_, state, last)| (*state, last) != (moment.decision.state, &word))
        {
            let margin_m = moment
                .decision
                .command
                .certified()
                .map(|certified| certified.margin_m);
            let own = moment.situation.ownship;
            println!(
                "{:.1} s {:?} {word} certified {margin_m:.1?} at {:.0} course {:.2}",
                moment.time_s, moment.decision.state, own.position_m, own.course_rad
            );
            self.words
                .push((moment.time_s, moment.decision.state, word));
        }
    }
}

/// What happened.
#[derive(Default, Clone)]
struct CorridorCount {
    flights: usize,
    avoided: usize,
    /// Left the fence, entered the volume; of them avoidable.
    left: Vec<(u64, f64, f64)>,
    entered: Vec<(u64, f64, f64)>,
    away: Vec<u64>,
    backwards: Vec<u64>,
    open: Vec<u64>,
}

impl CorridorCount {
    fn and(mut self, other: Self) -> Self {
        self.flights += other.flights;
        self.avoided += other.avoided;
        self.left.extend(other.left);
        self.entered.extend(other.entered);
        self.away.extend(other.away);
        self.backwards.extend(other.backwards);
        self.open.extend(other.open);
        self
    }
}

fn drawn(seed: u64, number: u64, course: f64) -> Result<Option<World>, String> {
    let random = &mut SplitMix64::of(seed, number);
    let mut model = model(random.unit() < 0.7)?;
    let airspeed_mps = random.within(12.0, 40.0);
    let bank_rad = random.within(0.5, 0.9);
    model.vehicle = Vehicle {
        airspeed_mps,
        turn_radius_m: airspeed_mps * airspeed_mps / (9.80665 * libm::tan(bank_rad)),
        response: Response {
            bank_time_constant_s: if random.unit() < 0.5 {
                0.0
            } else {
                random.within(0.2, 1.0)
            },
            ..Response::default()
        },
        ..model.vehicle
    };
    let turn_m = model.vehicle.turn_radius_m;
    model.settings.avoider.surveillance_radius_m = 5000.0;
    let (sin, cos) = libm::sincos(random.within(0.0, TAU));
    let wind_mps = if random.unit() < 0.3 {
        Vec3::ZERO
    } else {
        Vec3::new(cos, sin, 0.0) * (airspeed_mps * random.within(0.0, 0.5))
    };
    let Some((course_rad, climb_rad)) = crab(Vec3::X, airspeed_mps, wind_mps) else {
        return Ok(None);
    };
    let air_mps = fga::angle::direction(course_rad, climb_rad) * airspeed_mps;
    let ground_mps = (air_mps + wind_mps).x;
    let length_m = ground_mps * random.within(60.0, 200.0);
    let mission_m = vec![Vec3::new(0.0, 0.0, 100.0), Vec3::new(length_m, 0.0, 100.0)];
    let start = StartState {
        position_m: mission_m[0],
        course_rad,
        climb_rad,
    };
    let until = (4.0 * length_m / ground_mps + 300.0, Ending::MissionFlown);
    let mut world = World::of(&model, mission_m, start, until);
    world.wind_mps = wind_mps;
    world.sensor.range_m = f64::INFINITY;
    let radius_m = random.within(20.0, 60.0);
    let wide = |random: &mut SplitMix64| radius_m + turn_m * random.within(0.3, 4.0);
    let (left_m, right_m) = (wide(random), wide(random));
    let beyond_m = if random.unit() < 0.7 {
        random.within(50.0, 400.0)
    } else {
        6e3
    };
    let corners = [
        (-300.0, -right_m),
        (length_m + beyond_m, -right_m),
        (length_m + beyond_m, left_m),
        (-300.0, left_m),
    ];
    let outline = WorldOutline::Polygon(corners.map(|(x, y)| Vec2::new(x, y)).to_vec());
    let fence = WorldZone::new("fence".into(), true, outline, ALL_HEIGHTS_M);
    world
        .zones
        .push(fence.map_err(|error| format!("{error:?}"))?);
    // It meets the aircraft at a place of the leg.
    let meets_s = random.within(0.2, 0.9) * length_m / ground_mps;
    let speed_mps = if course == 0.0 {
        ground_mps * random.within(1.3, 3.0)
    } else {
        random.within(10.0, 60.0)
    };
    let angle_rad =
        TAU * (course + random.within(-0.03, 0.03)) * if random.unit() < 0.5 { 1.0 } else { -1.0 };
    let (sin, cos) = libm::sincos(angle_rad);
    let velocity_mps = Vec3::new(cos, sin, 0.0) * speed_mps;
    let aside_m = Vec3::new(0.0, random.within(-0.7, 0.7) * radius_m, 0.0);
    let meets_m = Vec3::new(ground_mps * meets_s, 0.0, 100.0) + aside_m;
    let track = Track::straight(meets_m - velocity_mps * meets_s, velocity_mps);
    let volume = ProtectedVolume::Sphere { radius_m };
    let mut intruder = WorldObstacle::new(1, track, volume);
    intruder.movement =
        [Movement::Straight, Movement::SMALL_UAS, Movement::CREWED][(3.0 * random.unit()) as usize];
    world.obstacles.push(intruder);
    Ok(Some(world))
}

/// What an oracle with the same fence keeps of the encounter, looked at some time before they meet, metres.
fn oracle_m(world: &World) -> f64 {
    let Some(intruder) = world.obstacles.first() else {
        return f64::INFINITY;
    };
    let (Some((from_m, velocity_mps)), end_m) = (intruder.track.at(0.0), world.mission_m[1]) else {
        return f64::INFINITY;
    };
    let leg_mps = {
        let air_mps =
            fga::angle::direction(world.start.course_rad, 0.0) * world.vehicle.airspeed_mps;
        (air_mps + world.wind_mps).x
    };
    let meets_s = (from_m.x / (leg_mps - velocity_mps.x)).clamp(0.0, end_m.x / leg_mps);
    let meets_s = if velocity_mps.y.abs() > velocity_mps.x.abs() {
        -from_m.y / velocity_mps.y
    } else {
        meets_s
    };
    let begins_s = (meets_s - 25.0).max(0.0);
    let start = OracleStart {
        position_m: Vec3::new(leg_mps * begins_s, 0.0, 100.0),
        course_rad: world.start.course_rad,
        climb_rad: 0.0,
        bank_rad: 0.0,
    };
    let there = OracleObstacle {
        position_m: from_m + velocity_mps * begins_s,
        velocity_mps: velocity_mps - world.wind_mps,
        volume: intruder.volume,
    };
    // Until it has passed, and for a circle more.
    let horizon_s = (meets_s - begins_s + 15.0).min(ORACLE_S);
    let settings = OracleSettings {
        horizon_s,
        enough_m: Some(2.0 * AVOIDABLE_M),
        ..OracleSettings::default()
    };
    let vehicle = OracleVehicle::from(&world.vehicle);
    best_margin_within(&start, &vehicle, &[there], airspace_of(world), &settings).best_margin_m
}

/// Aircraft alone, and the errors of their reports.
fn make_noisy(world: &mut World) {
    let sensor = &mut world.sensor;
    (sensor.position_sigma_m, sensor.velocity_sigma_mps) = (5.0, 0.5);
    sensor.update_period_s = 1.0;
    for intruder in &mut world.obstacles {
        if intruder.movement == Movement::Straight {
            intruder.movement = Movement::SMALL_UAS;
        }
    }
}

fn fly(
    (policy, is_noisy): (&PolicyChoice, bool),
    (seed, number): (u64, u64),
    course: f64,
    shows: bool,
) -> Result<CorridorCount, String> {
    let Some(mut world) = drawn(seed, number, course)? else {
        return Ok(CorridorCount::default());
    };
    if is_noisy {
        make_noisy(&mut world);
    }
    let world = policy.sees(&world).unwrap_or(world);
    let mut pilot = policy
        .pilot(&world.settings, &world.vehicle)
        .map_err(|error| error.to_string())?;
    let mut watch = CorridorFlight {
        shows,
        intruder: world
            .obstacles
            .first()
            .map(|intruder| intruder.track.clone()),

        ..CorridorFlight::default()
    };
    if shows {
        println!("{world:#?}");
    }
    let outcome = Engine::new().fly(&world, pilot.as_mut(), &mut watch);
    let mut count = CorridorCount {
        flights: 1,
        ..CorridorCount::default()
    };
    let samples = &watch.samples;
    count.avoided = usize::from(
        samples
            .iter()
            .any(|(sample, _)| sample.state != State::Cruise),
    );
    let nearest = samples
        .iter()
        .min_by(|one, other| one.1.total_cmp(&other.1));
    let passed_s = nearest.map_or(0.0, |(sample, _)| sample.time_s);
    let (mut away_s, mut backwards_s) = (0.0, 0.0);
    for pair in samples.windows(2) {
        let (from, to) = (&pair[0].0, &pair[1].0);
        if from.time_s < passed_s {
            continue;
        }
        let step_s = to.time_s - from.time_s;
        away_s += if to.position_m.y.abs() > ON_LEG_M {
            step_s
        } else {
            0.0
        };
        backwards_s += if to.position_m.x < from.position_m.x {
            step_s
        } else {
            0.0
        };
    }
    let zone_m = outcome.min_zone_margin_m.unwrap_or(f64::INFINITY);
    let is_bad = zone_m < -0.01 || outcome.min_margin_m < -0.01;
    let kept_m = if is_bad { oracle_m(&world) } else { f64::NAN };
    if zone_m < -0.01 {
        count.left.push((number, zone_m, kept_m));
    }
    if outcome.min_margin_m < -0.01 {
        count.entered.push((number, outcome.min_margin_m, kept_m));
    }
    let last = samples.last().map_or(0.0, |(sample, _)| sample.time_s);
    let faults = [
        (away_s > AWAY_S, &mut count.away),
        (backwards_s > BACKWARDS_S, &mut count.backwards),
        (last >= world.horizon_s - 0.2, &mut count.open),
    ];
    for (is_fault, numbers) in faults {
        if is_fault {
            numbers.push(number);
        }
    }
    Ok(count)
}

fn counted(
    policy: (&PolicyChoice, bool),
    of: usize,
    (count, seed): (u64, u64),
) -> Result<CorridorCount, String> {
    let (_, course) = COURSES[of];
    (0..count)
        .into_par_iter()
        .map(|number| {
            let number = number * COURSES.len() as u64 + of as u64;
            fly(policy, (seed, number), course, false)
        })
        .try_reduce(CorridorCount::default, |one, other| Ok(one.and(other)))
}

/// Runs the experiment.
pub(crate) fn run(args: &CorridorArgs) -> Result<(), String> {
    let drawn = (args.drawn.count, args.drawn.seed);
    let policy = (&parse_policy(&args.policy)?, args.noisy);
    if let Some(number) = args.only {
        let (_, course) = COURSES[usize::try_from(number % COURSES.len() as u64).unwrap_or(0)];
        fly(policy, (args.drawn.seed, number), course, true)?;
        return Ok(());
    }
    for (of, (name, _)) in COURSES.iter().enumerate() {
        let count = counted(policy, of, drawn)?;
        let avoidable =
            |lost: &[(u64, f64, f64)]| lost.iter().filter(|lost| lost.2 >= AVOIDABLE_M).count();
        println!(
            "{name}: {} flights, {} avoided; fence left {}, of them avoidable {}; volume entered {}, of them avoidable {}; after the intruder \
             has passed away for more than {AWAY_S} s {}, backwards for more than {BACKWARDS_S} s {}; not ended {}",
            count.flights,
            count.avoided,
            count.left.len(),
            avoidable(&count.left),
            count.entered.len(),
            avoidable(&count.entered),
            count.away.len(),
            count.backwards.len(),
            count.open.len(),
        );
        let first = |numbers: &[u64]| numbers.iter().take(6).copied().collect::<Vec<u64>>();
        println!(
            "  away {:?} backwards {:?} not ended {:?}",
            first(&count.away),
            first(&count.backwards),
            first(&count.open)
        );
        for (what, lost) in [("left", &count.left), ("entered", &count.entered)] {
            for (number, by_m, kept_m) in lost.iter().take(12) {
                println!("  {number}: {what} by {:.2} m, oracle {kept_m:.2} m", -by_m);
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The aircraft has turned round in the corridor; each shorter way back leads through the fence.
    #[test]
    fn a_way_back_that_leaves_the_fence_is_not_begun() {
        for number in [43, 73, 88, 152] {
            let (_, course) = COURSES[number as usize % COURSES.len()];
            let policy = (&PolicyChoice::default(), true);
            let count = fly(policy, (3, number), course, false).unwrap();
            assert!(count.avoided == 1 && count.left.is_empty(), "{number}");
        }
    }
}
