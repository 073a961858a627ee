//! A real ArduPlane, where there is one:
//! `FGA_SITL=tcp:127.0.0.1:5760 cargo test -p fga-link --test link -- --ignored --nocapture arduplane::`.
//!
//! The test uploads a mission, arms the vehicle and takes off in AUTO. On one leg it meets an obstacle
//! at rest, a head-on and an overtaking aircraft; then Algorithm 4 flies round a disc in CRUISE.
//! The vehicle's own telemetry shows separation, recovery, mode and mission item. Software in
//! the loop only: never with an aircraft. A second flight meets a fence, a pilot who changes the mode
//! in a manoeuvre, and the death of the companion; each flight needs a freshly started ArduPlane
//! (name the test to fly one of them).
//!
//! Every run of the tests flies the same courses against the ArduPlane-like emulator over TCP, step by
//! step.
#![allow(
    deprecated,
    clippy::cast_possible_truncation,
    reason = "older autopilots ask in the old way; coordinates fit"
)]

use core::time::Duration;
use std::io::{Read as _, Write as _};
use std::net::TcpListener;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Instant;

use crate::common::ground::{ALTITUDE_M, AUTO, CRUISE, FBWB, GUIDED, Ground, listen};
use fga::Vec3;
use fga_emulator::{Emulator, EmulatorSettings, STEP_S};
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_link::endpoint::open;
use fga_link::player::{Played, PlayedState, adsb_message};
use fga_link::wire::{Framer, WireFrame, encode};
use fga_link::{Companion, Config};
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{MavCmd, MavMessage};

/// The leg of all encounters ends at this item.
const LEG_ITEM: u16 = 3;
const PROTECTED_M: f64 = 60.0;
/// The disc that Algorithm 4 flies round.
const DISC_M: f64 = 150.0;
/// The throttle stick that asks for 22 m/s between 10 and 30 m/s.
const CRUISE_THROTTLE_US: u16 = 1600;
/// Distance of the fence to the east of the leg, metres.
const FENCE_EAST_M: f64 = 45.0;
/// Without its companion the vehicle stays within this distance of the take-over, metres: it
/// circles there.
const STAYS_M: f64 = 150.0;
/// Back on the leg: this close, this well aligned, this soon after the threat has passed.
const BACK_M: f64 = 20.0;
const BACK_RAD: f64 = 0.087_3;
const BACK_S: f64 = 30.0;

/// What drives the time of the bench.
enum Clock {
    /// The wall's: a vehicle that runs by itself.
    Wall(Instant),
    /// The emulator's: it flies one step when it is told how many frames it must have heard, and
    /// tells the time and how many frames it has sent.
    Steps {
        go: SyncSender<u64>,
        done: Receiver<(f64, u64)>,
        now_s: f64,
    },
}

/// An encounter: a path, and whether traffic reports it.
struct Threat {
    path: Played,
    reported: bool,
}

struct Bench {
    clock: Clock,
    frames: Receiver<WireFrame>,
    heard: u64,
    ground: Ground,
    companion: Companion,
    home: Option<Geodetic>,
    threat: Option<Threat>,
    next_report_s: f64,
    next_heartbeat_s: f64,
    /// Least distance to the threat, metres, and when.
    least_m: (f64, f64),
    /// When the companion last commanded anything, seconds.
    commanded_s: f64,
    /// The pilot's throttle stick, if held.
    throttle_us: Option<u16>,
    /// The companion is dead: it hears and sends nothing.
    dead: bool,
    /// Farthest east of home, metres.
    east_m: f64,
}

impl Bench {
    fn new(endpoint: &str, clock: Clock) -> Self {
        let (reader, writer) = open(&endpoint.parse().expect("endpoint")).expect("open");
        Self {
            clock,
            frames: listen(reader),
            heard: 0,
            ground: Ground::new(writer),
            companion: companion(""),
            home: None,
            threat: None,
            next_report_s: 0.0,
            next_heartbeat_s: 0.0,
            least_m: (f64::INFINITY, 0.0),
            commanded_s: f64::NEG_INFINITY,
            throttle_us: None,
            dead: false,
            east_m: f64::NEG_INFINITY,
        }
    }

    fn now_s(&self) -> f64 {
        match &self.clock {
            Clock::Wall(start) => start.elapsed().as_secs_f64(),
            Clock::Steps { now_s, .. } => *now_s,
        }
    }

    fn take(&mut self, frame: &WireFrame) {
        let now_s = self.now_s();
        if !self.dead {
            self.companion.receive(&frame.header, &frame.message, now_s);
        }
        let mode = self.ground.mode;
        self.ground.take(frame);
        if self.ground.mode != mode {
            eprintln!("{now_s:7.1} s mode {}", self.ground.mode);
        }
        if matches!(frame.message, MavMessage::GLOBAL_POSITION_INT(_)) {
            self.measure(now_s);
        }
    }

    /// Lets time pass until the vehicle was heard or a moment is over.
    fn pass(&mut self) {
        match &mut self.clock {
            Clock::Wall(_) => {
                if let Ok(frame) = self.frames.recv_timeout(Duration::from_millis(10)) {
                    self.take(&frame);
                }
            }
            Clock::Steps { go, done, now_s } => {
                go.send(self.ground.sent).expect("the emulator");
                let (time_s, sent) = done.recv().expect("the emulator");
                *now_s = time_s;
                while self.heard < sent {
                    let frame = self.frames.recv().expect("the emulator");
                    self.heard += 1;
                    self.take(&frame);
                }
            }
        }
    }

    /// Runs until `done`, at most `longest_s`.
    fn run(&mut self, longest_s: f64, what: &str, mut done: impl FnMut(&mut Self) -> bool) {
        let end_s = self.now_s() + longest_s;
        while !done(self) {
            let now_s = self.now_s();
            assert!(
                now_s < end_s,
                "waited {longest_s} s for {what}: {}; {}",
                self.companion.status_line(now_s),
                self.ground.told(self.home)
            );
            self.pass();
            let now_s = self.now_s();
            if now_s >= self.next_heartbeat_s {
                self.next_heartbeat_s = now_s + 1.0;
                self.ground.heartbeat();
                if let Some(throttle_us) = self.throttle_us {
                    self.ground.hold_throttle(throttle_us);
                }
            }
            self.report_threat(now_s);
            if !self.dead {
                self.companion.tick(now_s);
                self.send_for_companion(now_s);
            }
            // What it decided, for one who wonders.
            let lines = self.companion.take_log();
            if std::env::var_os("FGA_LOG").is_some() {
                for line in lines {
                    eprintln!("{line}");
                }
            }
        }
    }

    fn send_for_companion(&mut self, now_s: f64) {
        for outgoing in self.companion.outbox() {
            let commands = match &outgoing.message {
                MavMessage::SET_ATTITUDE_TARGET(_) => true,
                MavMessage::COMMAND_LONG(data) => data.command == MavCmd::MAV_CMD_DO_SET_MODE,
                _ => false,
            };
            if commands {
                self.commanded_s = now_s;
            }
            self.ground
                .send_as(outgoing.system_id, 196, &outgoing.message);
        }
    }

    fn run_for(&mut self, seconds: f64) {
        let end_s = self.now_s() + seconds;
        self.run(seconds + 60.0, "time", |b| b.now_s() >= end_s);
    }

    fn report_threat(&mut self, now_s: f64) {
        let Some(threat) = self.threat.as_ref().filter(|threat| threat.reported) else {
            return;
        };
        let Some(sample) = threat.path.at(now_s) else {
            return;
        };
        if now_s >= self.next_report_s {
            self.next_report_s = now_s + 0.5;
            let message = adsb_message(threat.path.icao, &threat.path.callsign, &sample);
            let header = MavHeader {
                system_id: 200,
                component_id: 156,
                sequence: 0,
            };
            self.companion.receive(&header, &message, now_s);
        }
    }

    fn measure(&mut self, now_s: f64) {
        let sample = self.threat.as_ref().and_then(|t| t.path.at(now_s));
        if let (Some(home), Some(place)) = (self.home, self.ground.place) {
            let east_m = LocalFrame::new(home, Earth::Wgs84).to_local_m(place).x;
            self.east_m = self.east_m.max(east_m);
        }
        if let Some(away_m) = sample.and_then(|sample| self.ground.away_m(sample.place))
            && away_m < self.least_m.0
        {
            self.least_m = (away_m, now_s);
        }
    }

    /// A threat whose place is given from the vehicle: metres east and north.
    fn meet(&mut self, offset_m: Vec3, velocity_mps: Vec3, reported: bool) -> Geodetic {
        let here = self.ground.place.expect("a position");
        let place = LocalFrame::new(here, Earth::Wgs84).to_geodetic(offset_m);
        let sample = PlayedState {
            time_s: self.now_s(),
            place,
            velocity_mps,
        };
        self.threat = Some(Threat {
            path: Played {
                icao: 0x00AB_C123,
                callsign: "FGATEST".into(),
                is_by_pressure: false,
                samples: vec![sample],
            },
            reported,
        });
        self.least_m = (f64::INFINITY, 0.0);
        self.ground.modes.clear();
        place
    }

    fn change_mode(&mut self, mode: u32) {
        let mut again_s = 0.0;
        self.run(20.0, "the mode", move |b| {
            if b.ground.mode != mode && b.now_s() >= again_s {
                again_s = b.now_s() + 2.0;
                b.ground.ask_for_mode(mode);
            }
            b.ground.mode == mode
        });
    }
}

fn companion(config: &str) -> Companion {
    Companion::new(Config::parse(config).expect("configuration"), false).expect("companion")
}

/// A disc of the configuration.
fn disc(place: Geodetic, radius_m: f64) -> String {
    format!(
        "[[obstacle]]\nname = \"disc\"\nlatitude_deg = {}\nlongitude_deg = {}\naltitude_m = {}\nradius_m = {radius_m:?}\n",
        place.latitude_deg, place.longitude_deg, place.altitude_m
    )
}

/// Take-off in AUTO, on to the leg; home is where the vehicle stands.
fn take_off(bench: &mut Bench) -> Geodetic {
    let mut again_s = 0.0;
    bench.run(60.0, "a position", move |b| {
        if b.now_s() >= again_s {
            again_s = b.now_s() + 2.0;
            b.ground.ask_for_messages();
        }
        b.ground.home().is_some()
    });
    let home = bench.ground.home().expect("a position");
    bench.home = Some(home);
    bench
        .ground
        .upload(home, &[(0.0, 800.0), (0.0, 15_000.0), (3000.0, 15_000.0)]);
    bench.run(20.0, "the mission", |b| b.ground.uploaded);
    let mut again_s = 0.0;
    bench.run(180.0, "flight on the leg", move |b| {
        if b.now_s() > again_s {
            again_s = b.now_s() + 2.0;
            b.ground.ask_to_take_off();
        }
        b.ground.armed
            && b.ground.mode == AUTO
            && b.ground.item == LEG_ITEM
            && b.ground.above_home_m > 0.9 * ALTITUDE_M
            && b.ground.off_leg(home).0 < BACK_M
    });
    home
}

/// The vehicle leaves the mission once and resumes it, keeps clear of the threat, and flies the leg again.
fn judge_encounter(bench: &mut Bench, home: Geodetic, what: &str) {
    bench.run(90.0, "the take-over", |b| b.ground.mode == GUIDED);
    bench.run(120.0, "the return", |b| b.ground.mode == AUTO);
    bench.run(90.0, "the passage", |b| b.now_s() > b.least_m.1 + 3.0);
    let passed_s = bench.least_m.1;
    bench.run(passed_s + BACK_S - bench.now_s(), "the leg", |b| {
        let (across_m, angle_rad) = b.ground.off_leg(home);
        across_m <= BACK_M && angle_rad <= BACK_RAD
    });
    eprintln!(
        "{what}: least distance {:.1} m, back {:.1} s after",
        bench.least_m.0,
        bench.now_s() - passed_s
    );
    assert!(bench.least_m.0 >= PROTECTED_M, "{what}");
    assert_eq!(bench.ground.modes, [GUIDED, AUTO], "{what}");
    assert_eq!(bench.ground.item, LEG_ITEM, "{what}");
    bench.threat = None;
    // The track is dropped, and nothing more happens.
    bench.run_for(25.0);
    assert_eq!(bench.ground.mode, AUTO, "{what}");
}

/// CRUISE, FBWB round the disc, CRUISE on the old course.
fn fly_algorithm_4(bench: &mut Bench) {
    bench.companion = companion("[safety]\narmed_at_start = false\n");
    // At idle, CRUISE would fly close to the stall.
    bench.throttle_us = Some(CRUISE_THROTTLE_US);
    bench.change_mode(CRUISE);
    bench.run_for(10.0);
    let track_rad = bench.ground.track_rad();
    let ahead = Vec3::new(track_rad.sin(), track_rad.cos(), 0.0);
    let place = bench.meet(ahead * 1200.0, Vec3::ZERO, false);
    let config = format!(
        "[command]\nmode = \"paper\"\n[protection]\nmargin_m = 5.0\n{}",
        disc(place, DISC_M)
    );
    bench.companion = companion(&config);
    bench.run(90.0, "FBWB", |b| b.ground.mode == FBWB);
    bench.run(120.0, "CRUISE", |b| b.ground.mode == CRUISE);
    bench.run(60.0, "the passage", |b| b.now_s() > b.least_m.1 + 3.0);
    // The wings are level, and the heading is locked.
    bench.run_for(5.0);
    let off_rad = (bench.ground.track_rad() - track_rad).abs();
    eprintln!(
        "Algorithm 4: least distance {:.1} m, course off by {:.1} degrees",
        bench.least_m.0,
        off_rad.to_degrees()
    );
    assert!(bench.least_m.0 >= DISC_M);
    assert_eq!(bench.ground.modes, [FBWB, CRUISE]);
    assert!(off_rad <= 2.0 * BACK_RAD);
}

fn fly_the_course(bench: &mut Bench) {
    let home = take_off(bench);

    let place = bench.meet(Vec3::new(0.0, 1500.0, 0.0), Vec3::ZERO, false);
    bench.companion = companion(&disc(place, PROTECTED_M));
    judge_encounter(bench, home, "at rest");

    bench.companion = companion("");
    bench.run_for(10.0);
    let own_mps = bench.ground.velocity_mps.y;
    bench.meet(
        Vec3::new(0.0, 40.0 * (own_mps + 25.0), 0.0),
        Vec3::new(0.0, -25.0, 0.0),
        true,
    );
    judge_encounter(bench, home, "head-on");

    let own_mps = bench.ground.velocity_mps.y;
    bench.meet(
        Vec3::new(5.0, -600.0, 0.0),
        Vec3::new(0.0, own_mps + 15.0, 0.0),
        true,
    );
    judge_encounter(bench, home, "overtaking");

    fly_algorithm_4(bench);
}

/// The fence blocks the nearer turn; the aircraft keeps clear of it and of the threat.
fn meet_a_fence(bench: &mut Bench, home: Geodetic) {
    let corners = [
        (-500.0, -1000.0),
        (FENCE_EAST_M, -1000.0),
        (FENCE_EAST_M, 14_000.0),
        (-500.0, 14_000.0),
    ];
    bench.ground.upload_fence(home, &corners);
    bench.run(20.0, "the fence", |b| b.ground.uploaded);
    bench.ground.set_parameter("FENCE_ENABLE", 1.0);
    bench.companion = companion("");
    bench.run_for(10.0);
    let own_mps = bench.ground.velocity_mps.y;
    bench.east_m = f64::NEG_INFINITY;
    bench.meet(
        Vec3::new(-5.0, 40.0 * (own_mps + 25.0), 0.0),
        Vec3::new(0.0, -25.0, 0.0),
        true,
    );
    judge_encounter(bench, home, "head-on beside a fence");
    eprintln!("no farther east than {:.1} m", bench.east_m);
    assert!(bench.east_m < FENCE_EAST_M);
}

/// An obstacle at rest ahead, and the aircraft in the turn that avoids it; returns the place of the
/// take-over.
fn turn_away(bench: &mut Bench) -> Geodetic {
    let track_rad = bench.ground.track_rad();
    let ahead = Vec3::new(track_rad.sin(), track_rad.cos(), 0.0);
    let place = bench.meet(ahead * 1200.0, Vec3::ZERO, false);
    bench.companion = companion(&disc(place, PROTECTED_M));
    bench.run(90.0, "the take-over", |b| b.ground.mode == GUIDED);
    let here = bench.ground.place.expect("a position");
    bench.run_for(2.0);
    assert_eq!(bench.ground.mode, GUIDED);
    here
}

/// The pilot changes the mode in the turn: from that message on the companion commands nothing.
fn obey_the_pilot(bench: &mut Bench) {
    turn_away(bench);
    bench.change_mode(CRUISE);
    let released_s = bench.now_s();
    bench.run_for(15.0);
    eprintln!(
        "pilot: last command {:.0} ms before the new mode was heard",
        (released_s - bench.commanded_s) * 1e3
    );
    assert!(bench.commanded_s <= released_s);
    assert_eq!(bench.ground.modes, [GUIDED, CRUISE]);
    bench.companion = companion("[safety]\narmed_at_start = false\n");
    bench.change_mode(AUTO);
    bench.run_for(30.0);
}

/// The companion dies in the turn: the autopilot returns to the place of the take-over, and stays.
fn die(bench: &mut Bench) {
    let here = turn_away(bench);
    let height_m = bench.ground.above_home_m;
    bench.dead = true;
    for _ in 0..12 {
        bench.run_for(5.0);
        eprintln!(
            "dead: {:.0} m from the take-over, on course {:.0} degrees, {:.0} m above home",
            bench.ground.away_m(here).unwrap_or(f64::NAN),
            bench.ground.track_rad().to_degrees(),
            bench.ground.above_home_m
        );
    }
    assert_eq!(bench.ground.modes, [GUIDED]);
    let away_m = bench.ground.away_m(here).expect("a position");
    assert!(away_m < STAYS_M, "{away_m} m");
    assert!((bench.ground.above_home_m - height_m).abs() < 10.0);
    bench.change_mode(AUTO);
}

fn fly_the_faults(bench: &mut Bench) {
    let home = take_off(bench);
    meet_a_fence(bench, home);
    obey_the_pilot(bench);
    die(bench);
}

/// The bench at the ArduPlane that `FGA_SITL` names.
fn arduplane() -> Option<Bench> {
    let Ok(endpoint) = std::env::var("FGA_SITL") else {
        eprintln!("skipped: FGA_SITL names no endpoint");
        return None;
    };
    Some(Bench::new(&endpoint, Clock::Wall(Instant::now())))
}

#[test]
#[ignore = "needs an ArduPlane in software in the loop, named by FGA_SITL"]
fn an_arduplane_flies_the_course() {
    if let Some(mut bench) = arduplane() {
        fly_the_course(&mut bench);
    }
}

#[test]
#[ignore = "needs an ArduPlane in software in the loop, named by FGA_SITL"]
fn an_arduplane_meets_a_fence_a_pilot_and_a_death() {
    if let Some(mut bench) = arduplane() {
        fly_the_faults(&mut bench);
    }
}

#[test]
#[ignore = "needs an ArduPlane in software in the loop, named by FGA_SITL"]
fn an_arduplane_keeps_its_fence_in_a_wind_towards_it() {
    if let Some(mut bench) = arduplane() {
        let home = take_off(&mut bench);
        bench.ground.set_parameter("SIM_WIND_DIR", 270.0);
        bench.ground.set_parameter("SIM_WIND_SPD", 8.0);
        bench.run_for(20.0);
        meet_a_fence(&mut bench, home);
    }
}

/// The emulator behind a TCP port; it flies a step for each `go`.
fn serve_emulator(server: &TcpListener, go: &Receiver<u64>, done: &SyncSender<(f64, u64)>) {
    let mut emulator = Emulator::new(EmulatorSettings {
        position_m: [0.0, 0.0, 0.0],
        mode: fga_emulator::PlaneMode::Manual,
        armed: false,
        fix_s: 28.0,
        ..EmulatorSettings::default()
    });
    let (mut stream, _) = server.accept().expect("the bench");
    stream.set_nodelay(true).expect("no delay");
    let begin_s = emulator.time_s();
    let mut framer = Framer::new(None);
    let mut buffer = [0; 4096];
    let (mut heard, mut sent) = (0, 0);
    while let Ok(expected) = go.recv() {
        while heard < expected {
            let count = stream.read(&mut buffer).expect("the bench");
            framer.push(&buffer[..count], |frame| {
                heard += 1;
                emulator.receive(&frame.header, &frame.message);
            });
        }
        emulator.advance(STEP_S);
        for message in emulator.drain() {
            let header = MavHeader {
                system_id: u32::from(emulator.system_id()),
                component_id: 1,
                sequence: (sent % 256) as u8,
            };
            stream
                .write_all(encode(header, &message, None).raw_bytes())
                .expect("the bench");
            sent += 1;
        }
        if done.send((emulator.time_s() - begin_s, sent)).is_err() {
            break;
        }
    }
}

/// A flight with the emulator.
fn with_the_emulator(fly: impl FnOnce(&mut Bench)) {
    let server = TcpListener::bind("127.0.0.1:0").expect("a port");
    let endpoint = format!("tcp:{}", server.local_addr().expect("an address"));
    let (go, told) = sync_channel(1);
    let (tell, done) = sync_channel(1);
    let emulator = std::thread::spawn(move || serve_emulator(&server, &told, &tell));
    let clock = Clock::Steps {
        go,
        done,
        now_s: 0.0,
    };
    let mut bench = Bench::new(&endpoint, clock);
    fly(&mut bench);
    drop(bench);
    emulator.join().expect("the emulator");
}

#[test]
fn the_emulator_flies_the_course() {
    with_the_emulator(fly_the_course);
}

#[test]
fn the_emulator_meets_a_fence_a_pilot_and_a_death() {
    with_the_emulator(fly_the_faults);
}
