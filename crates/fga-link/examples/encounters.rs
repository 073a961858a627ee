//! Seeded encounters of ArduPlane in software in the loop with the running program `fga fly`:
//! `cargo run --release -p fga-link --example encounters -- target/release/fga 500 2000 0 24
//! tcp:127.0.0.1:5760 tcp:127.0.0.1:5762`.
//!
//! Arguments: the program, or `none` for what the vehicle itself does, its own avoidance or fga inside it; least and largest distance of an
//! intruder at first sight, metres; the first seed and the number of seeds; the vehicle's link for the ground station and the one
//! for the program; then, optionally, the configuration of the program and a folder for its logs.
//!
//! The vehicle stands on its runway without a mission; it takes off and flies north. Before each encounter the ground station uploads
//! a new mission on its own link, which the program does not hear: another leg, to the side and on another course. The intruders
//! meet the aircraft on that leg. `ADSB_VEHICLE` reports them twice a second on the ground station's link; the vehicle passes
//! them on to the program's link as long as its `ADSB_TYPE` is 0. The vehicle's telemetry on the ground station's link is the
//! judge. Real time: the vehicle runs at speed 1; several vehicles side by side need several runs of this program.

#[path = "../tests/link/common/ground.rs"]
mod ground;
#[path = "../tests/link/common/kinds.rs"]
mod kinds;
#[path = "../tests/link/common/random.rs"]
mod random;

use core::time::Duration;
use std::process::{Child, Command, ExitCode, Stdio};
use std::sync::mpsc::Receiver;
use std::time::Instant;

use fga::Vec3;
use fga::situation::ProtectedVolume;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_judge::oracle::{OracleObstacle, OracleSettings, OracleStart, OracleVehicle, best_margin};
use fga_link::endpoint::open;
use fga_link::player::{Played, PlayedState, adsb_message};
use fga_link::wire::WireFrame;
use ground::{ALTITUDE_M, AUTO, AVOID_ADSB, GUIDED, Ground, listen};
use kinds::{KINDS, Kind, velocity_mps};
use mavlink::dialects::ardupilotmega::MavCmd;
use random::Random;

const PROTECTED_M: f64 = 60.0;
/// Back on the leg: this close and this well aligned.
const BACK_M: f64 = 20.0;
const BACK_RAD: f64 = 0.087_3;
/// The example watches an encounter for this long after the last intruder has passed, seconds …
const AFTER_S: f64 = 35.0;
/// … or until the mission continues, but at most this long.
const LONGEST_AFTER_S: f64 = 240.0;
/// The aircraft is steady on its leg for this long before the next one, seconds.
const STEADY_S: f64 = 6.0;
/// Steady: this close and this well aligned. Where the vehicle passes a waypoint at its side, its own leg begins there.
const STEADY_M: f64 = 12.0;
const STEADY_RAD: f64 = 0.05;
/// Distance between waypoints of the first mission; its leg is as long as the aircraft can fly.
const WAYPOINT_M: f64 = 5_000.0;
const WAYPOINTS: u16 = 40;

/// The leg of a new mission: largest turn, largest distance beside the aircraft's track, distance ahead of its beginning.
const TURNED_RAD: f64 = 0.8;
const ASIDE_M: f64 = 200.0;
const AHEAD_M: f64 = 600.0;
/// Distance between its waypoints.
const NEW_WAYPOINT_M: f64 = 3_000.0;
/// Beyond this distance from home, new legs lead back, metres.
const AWAY_M: f64 = 15_000.0;

/// The turns of an ArduPlane of the model `plane` at the bank limit of its parameters (65°), and the delays that no decision
/// avoids: for the oracle, which judges lost encounters.
const BANK_RAD: f64 = 65.0 * core::f64::consts::PI / 180.0;
const TURN_RATE_FACTOR: f64 = 0.69;
const BANK_TIME_CONSTANT_S: f64 = 0.4;
const DEAD_TIME_S: f64 = 0.2;

/// An intruder: its path, and what the example has seen of it.
struct Intruder {
    path: Played,
    shown_m: f64,
    shown: bool,
    next_report_s: f64,
    /// Where it was from the vehicle when the vehicle last told its place, metres.
    last_m: Option<Vec3>,
    /// Least distance, metres, and when.
    least_m: (f64, f64),
}

/// A straight part of the mission: a point on it, east and north of home, metres, and its course, radians clockwise from north.
#[derive(Debug, Clone, Copy)]
struct Leg {
    from_m: (f64, f64),
    course_rad: f64,
}

/// A vector given across the leg (to the right), along it and up, as east, north and up.
fn along(course_rad: f64, v: Vec3) -> Vec3 {
    let (sin, cos) = course_rad.sin_cos();
    Vec3::new(v.x * cos + v.y * sin, v.y * cos - v.x * sin, v.z)
}

/// The least distance from the origin to a straight path between two points.
fn least_between(from: Vec3, to: Vec3) -> f64 {
    let step = to - from;
    let length_2 = step.dot(step);
    let part = if length_2 > 0.0 {
        (-from.dot(step) / length_2).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (from + step * part).length()
}

/// Intruders that meet the aircraft, off by a few metres, a little after they are shown.
fn intruders(seed: u32, kind: Kind, shown: (f64, f64), bench: &Bench) -> Vec<Intruder> {
    let mut random = Random::new(u64::from(seed) * 7919 + 17);
    let course_rad = bench.leg.course_rad;
    let ground = bench.ground.velocity_mps;
    let own = Vec3::new(0.0, ground.x.hypot(ground.y), 0.0);
    let kinds: &[Kind] = match kind {
        Kind::Two => match seed / 5 % 3 {
            0 => &[Kind::Crossing, Kind::HeadOn],
            1 => &[Kind::Crossing, Kind::Crossing],
            _ => &[Kind::Crossing, Kind::Overtaking],
        },
        _ => &[kind][..],
    };
    let paths: Vec<(Vec3, f64)> = kinds
        .iter()
        .map(|kind| {
            let velocity = Vec3::from(velocity_mps(&mut random, *kind, own.y));
            (velocity, random.uniform(shown.0, shown.1))
        })
        .collect();
    // All meet the aircraft at about the same time.
    let meet_s = paths
        .iter()
        .map(|(velocity, shown_m)| shown_m / (*velocity - own).length() + 3.0)
        .fold(0.0, f64::max);
    let here = bench.ground.place.expect("a position");
    let frame = LocalFrame::new(here, Earth::Wgs84);
    (0..)
        .zip(paths)
        .map(|(number, (velocity_mps, shown_m))| {
            let at_s = meet_s
                + if number > 0 {
                    random.uniform(-4.0, 4.0)
                } else {
                    0.0
                };
            let meet = Vec3::new(
                random.uniform(-30.0, 30.0),
                own.y * at_s + random.uniform(-20.0, 20.0),
                random.uniform(-15.0, 15.0),
            );
            Intruder {
                path: Played {
                    icao: 0x0010_0000 + seed * 16 + number,
                    callsign: format!("E{seed}{number}"),
                    is_by_pressure: false,
                    samples: vec![PlayedState {
                        time_s: bench.now_s(),
                        place: frame.to_geodetic(along(course_rad, meet - velocity_mps * at_s)),
                        velocity_mps: along(course_rad, velocity_mps),
                    }],
                },
                shown_m,
                shown: false,
                next_report_s: 0.0,
                last_m: None,
                least_m: (f64::INFINITY, 0.0),
            }
        })
        .collect()
}

struct Bench {
    start: Instant,
    frames: Receiver<WireFrame>,
    ground: Ground,
    home: Option<Geodetic>,
    intruders: Vec<Intruder>,
    next_heartbeat_s: f64,
    leg: Leg,
    off_leg: (f64, f64),
    positions: u64,
}

impl Bench {
    fn new(endpoint: &str) -> Self {
        let (reader, writer) = open(&endpoint.parse().expect("endpoint")).expect("open");
        Self {
            start: Instant::now(),
            frames: listen(reader),
            ground: Ground::new(writer),
            home: None,
            intruders: Vec::new(),
            next_heartbeat_s: 0.0,
            leg: Leg {
                from_m: (0.0, 0.0),
                course_rad: 0.0,
            },
            off_leg: (f64::INFINITY, 0.0),
            positions: 0,
        }
    }

    fn now_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Hears the vehicle, and shows it what is near.
    fn step(&mut self) {
        if let Ok(frame) = self.frames.recv_timeout(Duration::from_millis(10)) {
            self.ground.take(&frame);
        }
        let now_s = self.now_s();
        if now_s >= self.next_heartbeat_s {
            self.next_heartbeat_s = now_s + 1.0;
            self.ground.heartbeat();
        }
        if let (Some(home), Some(_)) = (self.home, self.ground.place) {
            self.off_leg = self
                .ground
                .off_line(home, self.leg.from_m, self.leg.course_rad);
        }
        let told = self.ground.positions != self.positions;
        self.positions = self.ground.positions;
        let place = self.ground.place;
        for intruder in &mut self.intruders {
            let Some(sample) = intruder.path.at(now_s) else {
                continue;
            };
            if let (true, Some(place)) = (told, place) {
                let at_m = LocalFrame::new(place, Earth::Wgs84).to_local_m(sample.place);
                let away_m = least_between(intruder.last_m.unwrap_or(at_m), at_m);
                intruder.last_m = Some(at_m);
                if away_m < intruder.least_m.0 {
                    intruder.least_m = (away_m, now_s);
                }
                intruder.shown |= at_m.length() < intruder.shown_m;
            }
            if intruder.shown && now_s >= intruder.next_report_s {
                intruder.next_report_s = now_s + 0.5;
                let message = adsb_message(intruder.path.icao, &intruder.path.callsign, &sample);
                self.ground.send_as(200, 156, &message);
            }
        }
    }

    fn is_on_leg(&self) -> bool {
        self.off_leg.0 <= BACK_M && self.off_leg.1 <= BACK_RAD
    }

    /// Runs until `done`, at most `longest_s`; `ask` every two seconds.
    fn wait(
        &mut self,
        longest_s: f64,
        what: &str,
        mut ask: impl FnMut(&mut Ground),
        mut done: impl FnMut(&Self) -> bool,
    ) {
        let (end_s, mut again_s) = (self.now_s() + longest_s, 0.0);
        while !done(self) {
            self.step();
            if self.now_s() >= again_s {
                again_s = self.now_s() + 2.0;
                ask(&mut self.ground);
            }
            let told = self.ground.told(self.home);
            assert!(self.now_s() < end_s, "no {what} in {longest_s} s: {told}");
        }
    }

    fn take_off(&mut self) {
        self.wait(90.0, "position", Ground::ask_for_messages, |b| {
            b.ground.home().is_some()
        });
        let home = self.ground.home().expect("a position");
        self.home = Some(home);
        let waypoints: Vec<(f64, f64)> = core::iter::once(800.0)
            .chain((1..=WAYPOINTS).map(|n| f64::from(n) * WAYPOINT_M))
            .map(|north_m| (0.0, north_m))
            .collect();
        self.ground.upload(home, &waypoints);
        self.wait(20.0, "mission", |_| (), |b| b.ground.uploaded);
        self.wait(240.0, "flight on the leg", Ground::ask_to_take_off, |b| {
            b.ground.armed
                && b.ground.mode == AUTO
                && b.ground.item >= 3
                && b.ground.above_home_m > 0.9 * ALTITUDE_M
        });
    }

    /// Uploads a mission with another leg, and lets the vehicle fly it.
    fn change_the_mission(&mut self, seed: u32) {
        let mut random = Random::new(u64::from(seed) * 104_729 + 5);
        let home = self.home.expect("a home");
        let here =
            LocalFrame::new(home, Earth::Wgs84).to_local_m(self.ground.place.expect("a position"));
        let track_rad = self.ground.track_rad();
        let to_home_rad = (-here.x).atan2(-here.y);
        let turned_rad = random.uniform(-TURNED_RAD, TURNED_RAD);
        let course_rad = turned_rad
            + if here.x.hypot(here.y) > AWAY_M {
                to_home_rad
            } else {
                track_rad
            };
        let aside_m = random.uniform(-ASIDE_M, ASIDE_M);
        let from = here + along(track_rad, Vec3::new(aside_m, AHEAD_M, 0.0));
        let waypoints: Vec<(f64, f64)> = (0..6 + seed % 2)
            .map(|n| {
                let on = Vec3::new(0.0, f64::from(n) * NEW_WAYPOINT_M, 0.0);
                let at = from + along(course_rad, on);
                (at.x, at.y)
            })
            .collect();
        self.ground.upload(home, &waypoints);
        self.wait(20.0, "mission", |_| (), |b| b.ground.uploaded);
        // Its first waypoint.
        self.wait(
            20.0,
            "first waypoint",
            |ground| {
                ground.item = 0;
                ground.command(MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT, 2.0, 0.0);
            },
            |b| b.ground.item == 2,
        );
        self.leg = Leg {
            from_m: (from.x, from.y),
            course_rad,
        };
    }

    /// Flies on until the aircraft has been steady on its leg for a while.
    fn settle(&mut self) {
        let end_s = self.now_s() + 300.0;
        let mut since_s = self.now_s();
        while self.now_s() - since_s < STEADY_S {
            self.step();
            let steady = self.off_leg.0 < STEADY_M
                && self.off_leg.1 < STEADY_RAD
                && self.ground.mode == AUTO;
            if !steady {
                since_s = self.now_s();
            }
            assert!(self.now_s() < end_s, "never steady on the leg again");
        }
    }

    /// The oracle's largest margin from here on.
    fn scene(&self) -> (OracleStart, OracleVehicle, Vec<OracleObstacle>) {
        let own = self.ground.velocity_mps;
        let airspeed_mps = own.x.hypot(own.y);
        let vehicle = OracleVehicle {
            airspeed_mps,
            course_rate_radps: TURN_RATE_FACTOR * 9.806_65 * BANK_RAD.tan() / airspeed_mps,
            climb_min_rad: 0.0,
            climb_max_rad: 0.0,
            climb_rate_radps: 0.0,
            dead_time_s: DEAD_TIME_S,
            bank_time_constant_s: BANK_TIME_CONSTANT_S,
            bank_max_rad: BANK_RAD,
            turn_rate_factor: TURN_RATE_FACTOR,
        };
        let start = OracleStart {
            position_m: Vec3::ZERO,
            course_rad: own.y.atan2(own.x),
            climb_rad: 0.0,
            bank_rad: 0.0,
        };
        let here = self.ground.place.expect("a position");
        let frame = LocalFrame::new(here, Earth::Wgs84);
        let samples = self
            .intruders
            .iter()
            .filter_map(|i| i.path.at(self.now_s()));
        let obstacles = samples
            .map(|sample| OracleObstacle {
                position_m: frame.to_local_m(sample.place),
                velocity_mps: sample.velocity_mps,
                volume: ProtectedVolume::Sphere {
                    radius_m: PROTECTED_M,
                },
            })
            .collect();
        (start, vehicle, obstacles)
    }

    fn encounter(&mut self, seed: u32, shown: (f64, f64)) -> Outcome {
        let kind = KINDS[(seed % 5) as usize];
        self.change_the_mission(seed);
        self.settle();
        self.intruders = intruders(seed, kind, shown, self);
        self.ground.modes.clear();
        self.ground.texts.clear();
        let begin_s = self.now_s();
        let (mut largest_m, mut height_m, mut last_off_s) = (0.0_f64, 0.0_f64, begin_s);
        let mut passed_s = f64::INFINITY;
        let mut scene = None;
        loop {
            self.step();
            if scene.is_none() && self.intruders.iter().all(|i| i.shown) {
                scene = Some(self.scene());
            }
            let now_s = self.now_s();
            largest_m = largest_m.max(self.off_leg.0);
            height_m = height_m.max((self.ground.above_home_m - ALTITUDE_M).abs());
            if !self.is_on_leg() || self.ground.mode != AUTO {
                last_off_s = now_s;
            }
            let least = self.intruders.iter().map(|i| i.least_m.1);
            let least_s = least.fold(0.0, f64::max);
            let all_shown = self.intruders.iter().all(|i| i.shown);
            if all_shown && now_s > least_s + 3.0 {
                passed_s = least_s;
            }
            let after_s = now_s - passed_s;
            let back = self.ground.mode == AUTO && now_s - last_off_s > 5.0;
            if after_s > LONGEST_AFTER_S || (after_s > AFTER_S && back) || now_s > begin_s + 400.0 {
                break;
            }
        }
        let distances = self.intruders.iter().map(|i| i.least_m.0);
        let outcome = Outcome {
            least_m: distances.fold(f64::INFINITY, f64::min),
            largest_m,
            back_s: (last_off_s - passed_s).max(0.0),
            once: matches!(*self.ground.modes, [GUIDED | AVOID_ADSB, AUTO]),
            in_need: self.ground.texts.iter().any(|t| t == "fga: bank in need"),
        };
        let shown_m: Vec<String> = self
            .intruders
            .iter()
            .map(|i| format!("{:.0}", i.shown_m))
            .collect();
        println!(
            "{seed:3} {:10} shown {:9}: least {:6.1} m, off the leg {largest_m:6.1} m, off its height {height_m:5.1} m, \
             back after {:5.1} s, modes {:?}, item {}{}",
            format!("{kind:?}"),
            shown_m.join(" "),
            outcome.least_m,
            outcome.back_s,
            self.ground.modes,
            self.ground.item,
            if outcome.in_need { ", in need" } else { "" },
        );
        if let Some((start, vehicle, obstacles)) = scene.filter(|_| outcome.least_m < PROTECTED_M) {
            let settings = OracleSettings::default();
            let best_m = best_margin(&start, &vehicle, &obstacles, &settings).best_margin_m;
            println!("    lost; the best possible margin was {best_m:.1} m");
        }
        self.intruders.clear();
        outcome
    }
}

/// What came of an encounter.
struct Outcome {
    least_m: f64,
    /// Largest distance from the leg of the new mission, metres.
    largest_m: f64,
    /// From the last intruder's closest approach until the aircraft is back for good, seconds.
    back_s: f64,
    /// Whether the mode was changed once out and once back.
    once: bool,
    in_need: bool,
}

/// The middle and the largest of some numbers.
fn middle_and_largest(of: impl Iterator<Item = f64>) -> (f64, f64) {
    let mut sorted: Vec<f64> = of.collect();
    sorted.sort_by(f64::total_cmp);
    let at = |index: usize| sorted.get(index).copied().unwrap_or(f64::NAN);
    let last = sorted.len().saturating_sub(1);
    (f64::midpoint(at(last / 2), at(sorted.len() / 2)), at(last))
}

fn sum_up(outcomes: &[Outcome]) {
    let count = |wanted: fn(&Outcome) -> bool| outcomes.iter().filter(|o| wanted(o)).count();
    let (off_m, off_most_m) = middle_and_largest(outcomes.iter().map(|o| o.largest_m));
    let (back_s, back_most_s) = middle_and_largest(outcomes.iter().map(|o| o.back_s));
    println!(
        "{} of {} kept {PROTECTED_M} m; off the leg {off_m:.1} m (median), {off_most_m:.1} m (most); back after {back_s:.1} s, \
         {back_most_s:.1} s, later than 30 s in {}; one change of mode out and one back in {}; in need in {}",
        count(|o| o.least_m >= PROTECTED_M),
        outcomes.len(),
        count(|o| o.back_s > 30.0),
        count(|o| o.once),
        count(|o| o.in_need),
    );
}

/// The program, ended with this value.
struct Program(Child);

impl Drop for Program {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [program, from_m, to_m, first, count, ground, link, rest @ ..] = arguments.as_slice()
    else {
        eprintln!("PROGRAM FROM_M TO_M FIRST COUNT GROUND_LINK PROGRAM_LINK [CONFIG [FOLDER]]");
        return ExitCode::from(2);
    };
    let shown = (
        from_m.parse().expect("metres"),
        to_m.parse().expect("metres"),
    );
    let first: u32 = first.parse().expect("a seed");
    let count: u32 = count.parse().expect("a number");
    let mut bench = Bench::new(ground);
    let _program = (program != "none").then(|| start(program, link, rest));
    bench.take_off();
    let mut outcomes = Vec::new();
    for seed in first..first + count {
        outcomes.push(bench.encounter(seed, shown));
        sum_up(&outcomes);
    }
    ExitCode::SUCCESS
}

/// Starts the program on its link; what else is known are its configuration and the folder for its logs.
fn start(program: &str, link: &str, rest: &[String]) -> Program {
    let mut command = Command::new(program);
    command.args(["fly", "--quiet", "--connect", link]);
    if let Some(config) = rest.first() {
        command.args(["--config", config]);
    }
    command.args([
        "--out",
        rest.get(1).map_or("out/encounters", String::as_str),
    ]);
    Program(command.stdin(Stdio::null()).spawn().expect("the program"))
}
