//! Encounters on a leg of a mission that a ground station uploads on another link, as flown with a real
//! ArduPlane (`examples/encounters.rs`): head-on, crossing, overtaking, climbing, and two intruders at once.

use crate::common::kinds::{KINDS, Kind, velocity_mps};
use crate::common::{BAD, Intruder, Random, World, mission, upload};
use fga_emulator::PlaneMode;
use mavlink::dialects::ardupilotmega::MavMissionType;

const PROTECTED_M: f64 = 60.0;
/// Back on the leg within this time after the last intruder has passed, seconds.
const BACK_S: f64 = 30.0;
/// Longest time along the leg before the mode is given back, with a slow link: alignment, hand-back and confirmation, seconds.
const KEPT_S: f64 = 2.0;
/// Back: this close and this well aligned.
const BACK_M: f64 = 20.0;
const BACK_RAD: f64 = 0.087_3;
/// The leg of a new mission: largest turn, largest distance beside the track, distance ahead of its beginning.
const TURNED_RAD: f64 = 0.8;
const ASIDE_M: f64 = 200.0;
const AHEAD_M: f64 = 600.0;
/// Present item of a new mission: its second waypoint is the beginning of the leg.
const BEGINNING: u16 = 2;

/// The moment of the first sight of the intruders.
#[derive(Debug, Clone, Copy)]
enum Shown {
    /// The aircraft has flown steadily along the new leg for 6 s; at a distance in this range, metres.
    Settled(f64, f64),
    /// The vehicle passes the beginning of the new leg about as the manoeuvre begins.
    AtTheBeginning,
}

/// A straight part of the mission: a point on it, and its course clockwise from north.
#[derive(Debug, Clone, Copy)]
struct Leg {
    from_m: [f64; 2],
    course_rad: f64,
}

impl Leg {
    /// East and north of a vector across the leg and along it.
    fn turned(&self, [across, along]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.course_rad.sin_cos();
        [across * cos + along * sin, along * cos - across * sin]
    }

    fn at_m(&self, along_m: f64) -> [f64; 3] {
        let [x, y] = self.turned([0.0, along_m]);
        [self.from_m[0] + x, self.from_m[1] + y, 100.0]
    }

    /// Distance from the leg, metres, angle to it, radians, and distance along it, metres.
    fn off(&self, world: &World) -> (f64, f64, f64) {
        let plant = world.emulator.plant();
        let (sin, cos) = self.course_rad.sin_cos();
        let ([x, y, _], [vx, vy, _]) = (plant.position_m(), plant.velocity_mps());
        let (x, y) = (x - self.from_m[0], y - self.from_m[1]);
        let angle_rad = (vx * cos - vy * sin).atan2(vx * sin + vy * cos);
        (
            (x * cos - y * sin).abs(),
            angle_rad.abs(),
            x * sin + y * cos,
        )
    }

    fn is_on(&self, world: &World) -> bool {
        let (across_m, angle_rad, _) = self.off(world);
        across_m <= BACK_M && angle_rad <= BACK_RAD
    }
}

/// Uploads a mission with another leg ahead of the aircraft, as in flight.
fn change_the_mission(world: &mut World, random: &mut Random) -> Leg {
    let plant = world.emulator.plant();
    let ([x, y, _], [vx, vy, _]) = (plant.position_m(), plant.velocity_mps());
    let track = Leg {
        from_m: [x, y],
        course_rad: vx.atan2(vy),
    };
    let [dx, dy] = track.turned([random.uniform(-ASIDE_M, ASIDE_M), AHEAD_M]);
    let leg = Leg {
        from_m: [x + dx, y + dy],
        course_rad: track.course_rad + random.uniform(-TURNED_RAD, TURNED_RAD),
    };
    // Its first item is the take-off, somewhere far away: the vehicle never flies the leg from there.
    let bearing_rad = random.uniform(0.0, core::f64::consts::TAU);
    let mut points = vec![[
        leg.from_m[0] + 6000.0 * bearing_rad.sin(),
        leg.from_m[1] + 6000.0 * bearing_rad.cos(),
        100.0,
    ]];
    points.extend((0..6).map(|n| leg.at_m(3000.0 * f64::from(n))));
    let items = mission(&world.emulator, &points);
    let kind = MavMissionType::MAV_MISSION_TYPE_MISSION;
    upload(world, kind, &items, Some(BEGINNING));
    leg
}

/// Intruders that meet the aircraft on the leg, if it is there at the expected time, off by a few metres.
fn add_intruders(world: &mut World, seed: u32, kind: Kind, leg: &Leg, shown: Shown) {
    let mut random = Random::new(u64::from(seed) * 7919 + 17);
    let own_mps = world.emulator.plant().airspeed_mps();
    let (_, _, along_m) = leg.off(world);
    let kinds = match (kind, seed / 5 % 3) {
        (Kind::Two, 0) => vec![Kind::Crossing, Kind::HeadOn],
        (Kind::Two, 1) => vec![Kind::Crossing, Kind::Crossing],
        (Kind::Two, _) => vec![Kind::Crossing, Kind::Overtaking],
        _ => vec![kind],
    };
    let (least_m, most_m) = match shown {
        Shown::Settled(least_m, most_m) => (least_m, most_m),
        Shown::AtTheBeginning => (500.0, 1000.0),
    };
    let paths: Vec<([f64; 3], f64)> = kinds
        .into_iter()
        .map(|kind| {
            let velocity = velocity_mps(&mut random, kind, own_mps);
            (velocity, random.uniform(least_m, most_m))
        })
        .collect();
    let meet_s = paths
        .iter()
        .map(|([across, ahead, up], shown_m)| {
            shown_m / (across.powi(2) + (ahead - own_mps).powi(2) + up.powi(2)).sqrt() + 3.0
        })
        .fold(0.0, f64::max);
    for (number, ([across, ahead, up], shown_m)) in (0_u32..).zip(paths) {
        let at_s = meet_s
            + if number > 0 {
                random.uniform(-4.0, 4.0)
            } else {
                0.0
            };
        let off_m = random.uniform(-30.0, 30.0);
        let late_m = random.uniform(-20.0, 20.0);
        let above_m = random.uniform(-15.0, 15.0);
        let [vx, vy] = leg.turned([across, ahead]);
        let place = leg.at_m(along_m + own_mps * at_s + late_m);
        let [ox, oy] = leg.turned([off_m, 0.0]);
        let mut intruder = Intruder::straight(
            0x0010_0000 + seed * 16 + number,
            [
                place[0] + ox - vx * at_s,
                place[1] + oy - vy * at_s,
                place[2] + above_m - up * at_s,
            ],
            [vx, vy, up],
        );
        intruder.shown_m = shown_m;
        world.add(intruder);
    }
}

#[derive(Debug)]
#[expect(dead_code, reason = "shown where a test fails")]
struct Outcome {
    seed: u32,
    kind: Kind,
    least_m: f64,
    /// Largest distance from the new leg, metres.
    largest_m: f64,
    /// From the last closest approach until the aircraft is back for good, seconds.
    back_s: f64,
    /// The part of that time in which the aircraft flew along the leg in the companion's mode, seconds.
    kept_s: f64,
    changes: usize,
}

fn fly(seed: u32, shown: Shown) -> Outcome {
    let kind = KINDS[(seed % 5) as usize];
    let mut random = Random::new(u64::from(seed) * 104_729 + 5);
    // The departures are those of known heights: a climb through 97 m of uncertainty each way takes longer.
    let config = "[traffic]\ngeometric = \"sea-level\"\n";
    let mut world = World::new(config, BAD, u64::from(seed));
    world.run_until(20.0);
    let leg = change_the_mission(&mut world, &mut random);
    match shown {
        Shown::Settled(..) => {
            let mut since_s = world.time_s;
            while world.time_s - since_s < 6.0 {
                world.step();
                let (across_m, angle_rad, _) = leg.off(&world);
                if across_m > 12.0 || angle_rad > 0.05 {
                    since_s = world.time_s;
                }
                assert!(world.time_s < 300.0, "never steady on the new leg");
            }
        }
        Shown::AtTheBeginning => {
            world.run_while(90.0, "the beginning", |w| {
                leg.off(w).2 < -100.0 - 50.0 * f64::from(seed % 4)
            });
        }
    }
    add_intruders(&mut world, seed, kind, &leg, shown);
    let (begin_s, mut last_off_s, mut largest_m) = (world.time_s, world.time_s, 0.0_f64);
    let mut aside_s = begin_s;
    let passed_s = loop {
        world.step();
        if matches!(shown, Shown::Settled(..)) || leg.off(&world).2 > 100.0 {
            largest_m = largest_m.max(leg.off(&world).0);
        }
        if !leg.is_on(&world) {
            aside_s = world.time_s;
        }
        if aside_s == world.time_s || world.mode() != PlaneMode::Auto {
            last_off_s = world.time_s;
        }
        let passed_s = world.least_m.iter().map(|l| l.1).fold(0.0, f64::max);
        let is_past = world.shown.iter().all(|shown| *shown) && world.time_s > passed_s + 35.0;
        if (is_past && world.time_s > last_off_s + 5.0) || world.time_s > begin_s + 400.0 {
            break passed_s;
        }
    };
    if std::env::var("FGA_SEED").is_ok() {
        for line in world.companion.take_log() {
            println!("{line}");
        }
    }
    let least = world.least_m.iter().map(|least| least.0);
    let outcome = Outcome {
        seed,
        kind,
        least_m: least.fold(f64::INFINITY, f64::min),
        largest_m,
        back_s: (last_off_s - passed_s).max(0.0),
        kept_s: last_off_s - aside_s.max(passed_s).min(last_off_s),
        changes: world.emulator.mode_changes().len(),
    };
    println!("{outcome:?}");
    outcome
}

fn fly_all(count: u32, shown: Shown) -> Vec<Outcome> {
    let only = std::env::var("FGA_SEED").ok();
    let only: Option<u32> = only.map(|text| text.parse().expect("a number"));
    (0..count)
        .filter(|seed| only.is_none_or(|only| only == *seed))
        .map(|seed| fly(seed, shown))
        .collect()
}

fn median(of: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = of.collect();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

fn sum_up(outcomes: &[Outcome]) {
    for kind in KINDS {
        let of = || outcomes.iter().filter(|o| o.kind == kind);
        if of().count() > 0 {
            println!(
                "{kind:?}: off the leg {:.1} m, back {:.1} s, least {:.1} m (medians)",
                median(of().map(|o| o.largest_m)),
                median(of().map(|o| o.back_s)),
                median(of().map(|o| o.least_m))
            );
        }
    }
    println!(
        "all: off the leg {:.1} m, most {:.0}, back {:.1} s, most {:.1}, later than {BACK_S} s {}, least {:.1} m, lost {}, changes {}",
        median(outcomes.iter().map(|o| o.largest_m)),
        outcomes.iter().map(|o| o.largest_m).fold(0.0, f64::max),
        median(outcomes.iter().map(|o| o.back_s)),
        outcomes.iter().map(|o| o.back_s).fold(0.0, f64::max),
        outcomes.iter().filter(|o| o.back_s > BACK_S).count(),
        outcomes
            .iter()
            .map(|o| o.least_m)
            .fold(f64::INFINITY, f64::min),
        outcomes.iter().filter(|o| o.least_m < PROTECTED_M).count(),
        outcomes.iter().filter(|o| o.changes > 2).count(),
    );
}

/// Longest time back for a departure: half a circle, and straight back onto the leg at an intercept of 53°, a second per 20 m.
fn latest_back_s(largest_m: f64) -> f64 {
    BACK_S.max(18.0 + largest_m / 20.0)
}

/// One flight in fifty may come back later than that, by part of another circle: the way back stays clear of wherever an aircraft
/// can have turned since its report.
pub(crate) fn come_back(back_and_largest: impl Iterator<Item = (f64, f64)>) -> bool {
    let late_s = |(back_s, largest_m)| back_s - latest_back_s(largest_m);
    let late: Vec<f64> = back_and_largest.map(late_s).filter(|s| *s > 0.0).collect();
    eprintln!("later than half a circle and straight back, by s: {late:?}");
    late.len() <= 1 && late.iter().all(|late_s| *late_s < 8.0)
}

fn check(outcomes: &[Outcome], median_m: f64) {
    sum_up(outcomes);
    assert!(come_back(outcomes.iter().map(|o| (o.back_s, o.largest_m))));
    for outcome in outcomes {
        assert!(outcome.least_m >= PROTECTED_M, "{outcome:?}");
        assert!(outcome.changes == 2 || outcome.changes == 0, "{outcome:?}");
        // An earlier version kept the mode for up to 6 s on the leg, until the planned end of the way back.
        assert!(outcome.kept_s <= KEPT_S, "{outcome:?}");
    }
    let late = outcomes.iter().filter(|o| o.back_s > BACK_S).count();
    assert!(late * 10 <= outcomes.len(), "{late} later than {BACK_S} s");
    let departure_m = median(outcomes.iter().map(|outcome| outcome.largest_m));
    assert!(departure_m <= median_m, "{departure_m:.1} m");
}

/// A median departure of 90 m and 30 s for the way back in all are wanted; these limits hold what is reached.
#[test]
fn encounters_on_a_new_leg_depart_little_and_come_straight_back() {
    check(&fly_all(50, Shown::Settled(500.0, 2000.0)), 130.0);
}

/// An earlier version turned round to the beginning of a leg that the vehicle had entered long before, and came back 148 s after
/// the intruder had passed.
#[test]
fn encounters_at_the_beginning_of_a_new_leg_lead_to_no_turn_round() {
    check(&fly_all(50, Shown::AtTheBeginning), 125.0);
}
