//! Does any flight without traffic differ because of zones, ground or limits of altitude?
//!
//! Missions with slopes, corners, loops, ends and landings, aircraft with and without lag, wind up to 0.8 of the airspeed. Each is flown
//! alone, and again with a fence, zones to keep out of, ground and limits that lie near the mission but not across it. A third of them meet
//! an aircraft that passes far off.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "drawn numbers are small and not negative"
)]

use alloc::sync::Arc;
use core::f64::consts::{PI, TAU};

use fga::avoider::{Reason, Start, State};
use fga::certificate::Line;
use fga::situation::{Passing, ProtectedVolume};
use fga::vehicle::{Response, Vehicle};
use fga::zone::ALL_HEIGHTS_M;
use fga::{Vec2, Vec3};
use fga_sim::engine::{DecisionMoment, Engine, Observer, Sample};
use fga_sim::policy::PolicyChoice;
use fga_sim::track::Track;
use fga_sim::wind::crab;
use fga_sim::world::{
    Ending, StartState, World, WorldGround, WorldObstacle, WorldOutline, WorldZone,
};
use rayon::prelude::*;

use crate::common::{DrawnArgs, model};
use crate::intruders::traffic::SplitMix64;

/// Two flights are the same where no place differs by more, metres.
const SAME_M: f64 = 1e-3;

/// Error and clearance of the ground, metres.
const NEEDED_M: (f64, f64) = (5.0, 20.0);

/// Posts of the ground along a side.
const POSTS: usize = 60;

/// What lies near the mission.
const KINDS: [&str; 5] = ["fence", "keep-out zones", "ground", "limits", "all of them"];

/// A flight: where it was and what it said.
#[derive(Default)]
struct Flown {
    places_m: Vec<Vec3>,
    words: Vec<(State, Reason)>,
}

impl Observer for Flown {
    fn sample(&mut self, sample: &Sample) {
        self.places_m.push(sample.position_m);
    }

    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let decision = moment.decision;
        self.words.push((decision.state, decision.record.reason));
    }
}

impl Flown {
    fn of(world: &World) -> Result<Self, String> {
        let policy = PolicyChoice::Avoider(Start::Free);
        let pilot = policy.pilot(&world.settings, &world.vehicle);
        let mut flown = Self::default();
        Engine::new().fly(
            world,
            pilot.map_err(|error| error.to_string())?.as_mut(),
            &mut flown,
        );
        Ok(flown)
    }

    /// The largest distance from another flight, metres; infinite where they say different words or do not last as long.
    fn off_m(&self, other: &Self) -> f64 {
        if self.words != other.words || self.places_m.len() != other.places_m.len() {
            return f64::INFINITY;
        }
        let pairs = self.places_m.iter().zip(&other.places_m);
        pairs.fold(0.0, |off_m, (one, two)| one.distance(*two).max(off_m))
    }
}

/// Counts of flights.
#[derive(Default)]
struct BoundCount {
    flights: usize,
    /// Those in which a threat is seen: they are no flights without traffic.
    threatened: usize,
    differ: Vec<u64>,
    most_m: f64,
}

impl BoundCount {
    fn and(mut self, other: Self) -> Self {
        self.flights += other.flights;
        self.threatened += other.threatened;
        self.differ.extend(other.differ);
        self.most_m = self.most_m.max(other.most_m);
        self
    }
}

fn drawn_vehicle(random: &mut SplitMix64) -> Vehicle {
    let airspeed_mps = random.within(12.0, 60.0);
    let bank_rad = random.within(0.4, 0.9);
    let climb_rad = random.within(0.08, 0.25);
    let is_ideal = random.unit() < 0.4;
    let mut late_s = |most_s| {
        if is_ideal {
            0.0
        } else {
            random.within(0.02, most_s)
        }
    };
    Vehicle {
        airspeed_mps,
        turn_radius_m: airspeed_mps * airspeed_mps / (9.80665 * libm::tan(bank_rad)),
        climb_min_rad: -climb_rad,
        climb_max_rad: climb_rad,
        climb_rate_radps: 0.2,
        response: Response {
            bank_time_constant_s: late_s(1.5),
            dead_time_s: late_s(0.8),
            ..Response::default()
        },
    }
}

/// Waypoints of slopes, corners, loops and landings.
fn drawn_mission(random: &mut SplitMix64, vehicle: &Vehicle) -> Vec<Vec3> {
    let unit_m = vehicle.turn_radius_m.max(50.0);
    let legs = 1 + (5.0 * random.unit()) as usize;
    let most_turn_rad = [0.0, 1.0, PI][(3.0 * random.unit()) as usize];
    let is_level = random.unit() < 0.3;
    let mut course_rad = random.within(-PI, PI);
    let mut mission_m = vec![Vec3::new(0.0, 0.0, 100.0)];
    for leg in 0..legs {
        let length_m = unit_m * random.within(2.0, 20.0);
        let (sin, cos) = libm::sincos(course_rad);
        let from_m = mission_m[leg];
        let steepest = libm::tan(0.7 * vehicle.climb_max_rad);
        let slope = random.within(-1.0, 1.0) * steepest * if is_level { 0.0 } else { 1.0 };
        mission_m.push(from_m + Vec3::new(cos, sin, slope) * length_m);
        course_rad += random.within(-most_turn_rad, most_turn_rad);
    }
    let end_m = mission_m[legs];
    if random.unit() < 0.2 {
        // Back to the beginning.
        mission_m.push(mission_m[0].with_z(end_m.z));
    } else if random.unit() < 0.3 {
        // A landing.
        let (sin, cos) = libm::sincos(course_rad);
        let down = -libm::tan(0.8 * vehicle.climb_max_rad);
        mission_m.push(end_m + Vec3::new(cos, sin, down) * (8.0 * unit_m));
    }
    mission_m
}

/// A distance from a mission, metres: some near, some far.
fn near_m(random: &mut SplitMix64) -> f64 {
    libm::exp(random.within(libm::log(0.5), libm::log(300.0)))
}

fn is_near(mission_m: &[Vec3], zone: &WorldZone) -> bool {
    let mut lines = mission_m
        .windows(2)
        .map(|leg| Line::between(leg[0], leg[1]));
    lines.all(|line| zone.zone().nearest_m(&line, 0.1) > 0.0)
}

fn box_zone(
    low: Vec2,
    high: Vec2,
    keep_in: bool,
    heights_m: (f64, f64),
) -> Result<WorldZone, String> {
    let corners = vec![
        low,
        Vec2::new(high.x, low.y),
        high,
        Vec2::new(low.x, high.y),
    ];
    let outline = WorldOutline::Polygon(corners);
    WorldZone::new("zone".into(), keep_in, outline, heights_m).map_err(|error| format!("{error:?}"))
}

/// Lays what is near a mission, but not across it.
fn bound(world: &mut World, random: &mut SplitMix64, kind: usize) -> Result<(), String> {
    let mission_m = world.mission_m.clone();
    let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let mission = mission_m.iter();
    let (low_m, high_m) = mission.fold(nothing, |(low, high), at| (low.min(*at), high.max(*at)));
    let (low, high) = (low_m.truncate(), high_m.truncate());
    let has = |of: usize| kind == of || kind + 1 == KINDS.len();
    if has(0) {
        let [west, south, east, north] = [(); 4].map(|()| near_m(random));
        let mut heights_m = ALL_HEIGHTS_M;
        if random.unit() < 0.5 {
            heights_m = (low_m.z - near_m(random), high_m.z + near_m(random));
        }
        let (low, high) = (low - Vec2::new(west, south), high + Vec2::new(east, north));
        world.zones.push(box_zone(low, high, true, heights_m)?);
    }
    if has(1) {
        for _ in 0..6 {
            let mut within = |low: f64, high: f64| random.within(low - 300.0, high + 300.0);
            let center = Vec2::new(within(low.x, high.x), within(low.y, high.y));
            let half = Vec2::new(near_m(random), near_m(random)) + Vec2::ONE;
            let outline = WorldOutline::Circle {
                center_m: center,
                radius_m: half.x,
            };
            let zone = if random.unit() < 0.5 {
                WorldZone::new("zone".into(), false, outline, ALL_HEIGHTS_M)
                    .map_err(|error| format!("{error:?}"))?
            } else {
                box_zone(center - half, center + half, false, ALL_HEIGHTS_M)?
            };
            if is_near(&mission_m, &zone) {
                world.zones.push(zone);
            }
        }
    }
    if has(2) {
        let beside_m = Vec2::splat(500.0);
        let (low, high) = (low - beside_m, high + beside_m);
        let spacing_m = (high - low).max_element() / (POSTS as f64 - 1.0);
        let (wall_m, under_m) = (near_m(random) + 1.5 * spacing_m, near_m(random));
        let mut heights_m = Vec::with_capacity(POSTS * POSTS);
        for index in 0..POSTS * POSTS {
            let at = low + spacing_m * Vec2::new((index % POSTS) as f64, (index / POSTS) as f64);
            let column = WorldOutline::Circle {
                center_m: at,
                radius_m: wall_m,
            };
            let beside = WorldZone::new("post".into(), false, column, ALL_HEIGHTS_M)
                .map_err(|error| format!("{error:?}"))?;
            let floor_m = low_m.z - NEEDED_M.0 - NEEDED_M.1 - under_m;
            let is_wall = is_near(&mission_m, &beside);
            let height_m = if is_wall { floor_m + 300.0 } else { floor_m };
            #[expect(clippy::cast_possible_truncation, reason = "heights of a test")]
            heights_m.push(height_m as f32);
        }
        let ground = WorldGround::new((low, Vec2::splat(spacing_m)), POSTS, heights_m, NEEDED_M);
        world.ground = Some(Arc::new(ground.map_err(|error| format!("{error:?}"))?));
    }
    if has(3) {
        world.limits_m = (low_m.z - near_m(random), high_m.z + near_m(random));
    }
    Ok(())
}

/// The world of a drawn flight, and what bounds it; `None` where the wind is too strong for its first leg.
fn drawn(seed: u64, number: u64, kind: usize) -> Result<Option<[World; 2]>, String> {
    let random = &mut SplitMix64::of(seed, number);
    let mut model = model(false)?;
    model.vehicle = drawn_vehicle(random);
    let airspeed_mps = model.vehicle.airspeed_mps;
    let mission_m = drawn_mission(random, &model.vehicle);
    let (sin, cos) = libm::sincos(random.within(0.0, TAU));
    let wind_share = if random.unit() < 0.3 {
        0.0
    } else {
        random.within(0.0, 0.8)
    };
    let wind_mps = Vec3::new(cos, sin, 0.0) * (airspeed_mps * wind_share);
    let along = (mission_m[1] - mission_m[0]).normalize();
    let Some((course_rad, climb_rad)) = crab(along, airspeed_mps, wind_mps) else {
        return Ok(None);
    };
    let start = StartState {
        position_m: mission_m[0],
        course_rad,
        climb_rad,
    };
    let length_m: f64 = mission_m
        .windows(2)
        .map(|leg| leg[0].distance(leg[1]))
        .sum();
    let longest_s = 60.0 + 2.0 * length_m / (airspeed_mps * (1.0 - wind_share));
    let ends = [Ending::MissionFlown, Ending::Horizon];
    let until = (longest_s, ends[usize::from(random.unit() < 0.3)]);
    let mut free = World::of(&model, mission_m, start, until);
    free.wind_mps = wind_mps;
    free.sensor.range_m = f64::INFINITY;
    if random.unit() < 0.3 {
        free.passing = vec![Passing::FlyOver; free.mission_m.len()];
    }
    if random.unit() < 0.3 {
        let far_m = Vec3::new(-sin, cos, 0.0) * random.within(400.0, 2000.0);
        let track = Track::straight(far_m + Vec3::Z * 100.0, far_m.normalize() * 20.0 + wind_mps);
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        free.obstacles.push(WorldObstacle::new(1, track, volume));
    }
    let mut bounded = free.clone();
    bound(&mut bounded, random, kind)?;
    Ok(Some([free, bounded]))
}

fn fly(seed: u64, number: u64, kind: usize) -> Result<BoundCount, String> {
    let Some([free, bounded]) = drawn(seed, number, kind)? else {
        return Ok(BoundCount::default());
    };
    let (free, bounded) = (Flown::of(&free)?, Flown::of(&bounded)?);
    let is_threatened = free.words.iter().any(|(state, _)| *state != State::Cruise);
    let off_m = free.off_m(&bounded);
    let is_other = off_m > SAME_M && !is_threatened;
    Ok(BoundCount {
        flights: 1,
        threatened: usize::from(is_threatened),
        differ: if is_other { vec![number] } else { Vec::new() },
        most_m: if is_threatened { 0.0 } else { off_m },
    })
}

fn counted(kind: usize, count: u64, seed: u64) -> Result<BoundCount, String> {
    let numbers = (0..count).into_par_iter();
    numbers
        .map(|number| fly(seed, number * KINDS.len() as u64 + kind as u64, kind))
        .try_reduce(BoundCount::default, |one, other| Ok(one.and(other)))
}

/// Runs the experiment.
pub(crate) fn run(args: &DrawnArgs) -> Result<(), String> {
    for (kind, name) in KINDS.iter().enumerate() {
        let count = counted(kind, args.count, args.seed)?;
        println!(
            "{name}: {} flights, {} with a threat; {} of the others differ from the flight without by more than {SAME_M} m or in a word {:?}, \
             largest difference {} m",
            count.flights,
            count.threatened,
            count.differ.len(),
            count.differ.iter().take(4).collect::<Vec<_>>(),
            count.most_m
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_traffic_a_flight_is_the_flight_without_bounds() {
        for (kind, name) in KINDS.iter().enumerate() {
            let count = counted(kind, 40, 1).unwrap();
            assert!(count.flights > 30 && count.threatened < 5, "{name}");
            assert!(count.differ.is_empty(), "{name}: {:?}", count.differ);
        }
    }
}
