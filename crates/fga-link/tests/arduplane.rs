//! A real ArduPlane, where there is one:
//! `FGA_SITL=tcp:127.0.0.1:5760 cargo test -p fga-link --test arduplane -- --ignored --nocapture`.
//!
//! The vehicle is armed and takes off in AUTO on a mission that is uploaded here; one static and one
//! head-on intruder are shown to the companion. Separation, mode and mission item are judged by the
//! vehicle's own telemetry. Software in the loop only: never with an aircraft.
#![allow(
    deprecated,
    clippy::cast_possible_truncation,
    reason = "older autopilots ask in the old way; coordinates fit"
)]

use core::time::Duration;
use std::time::Instant;

use std::sync::mpsc::sync_channel;

use fga::Vec3;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_link::endpoint::{Received, Writer, open};
use fga_link::player::{Played, Sample, adsb_message};
use fga_link::wire::{Frame, Framer, encode};
use fga_link::{Companion, Config};
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{
    COMMAND_LONG_DATA, HEARTBEAT_DATA, MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MavCmd, MavFrame,
    MavMessage, MavMissionType, MavModeFlag,
};

const AUTO: u32 = 10;
const GUIDED: u32 = 15;
const ALTITUDE_M: f64 = 100.0;

struct Bench {
    frames: std::sync::mpsc::Receiver<Frame>,
    writer: Writer,
    companion: Companion,
    start: Instant,
    sequence: u8,
    mode: u32,
    armed: bool,
    place: Option<Geodetic>,
    above_home_m: f64,
    item: u16,
    mission: Vec<MISSION_ITEM_INT_DATA>,
    uploaded: bool,
    intruder: Option<Played>,
    next_report_s: f64,
    next_heartbeat_s: f64,
    least_m: f64,
    modes: Vec<u32>,
}

impl Bench {
    fn new(endpoint: &str) -> Self {
        let (mut reader, writer) = open(&endpoint.parse().expect("endpoint")).expect("open");
        let (to, frames) = sync_channel(4096);
        std::thread::spawn(move || {
            let mut framer = Framer::new(None);
            let mut buffer = [0; 4096];
            loop {
                if let Received::Bytes(count) = reader.read(&mut buffer) {
                    framer.push(&buffer[..count], |frame| {
                        let _ = to.try_send(frame);
                    });
                }
            }
        });
        Self {
            frames,
            writer,
            companion: Companion::new(Config::default(), false).expect("companion"),
            start: Instant::now(),
            sequence: 0,
            mode: 0,
            armed: false,
            place: None,
            above_home_m: 0.0,
            item: 0,
            mission: Vec::new(),
            uploaded: false,
            intruder: None,
            next_report_s: 0.0,
            next_heartbeat_s: 0.0,
            least_m: f64::INFINITY,
            modes: Vec::new(),
        }
    }

    fn now_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn send(&mut self, system_id: u8, component_id: u8, message: &MavMessage) {
        let header = MavHeader {
            system_id: u32::from(system_id),
            component_id,
            sequence: self.sequence,
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.writer.write(encode(header, message, None).raw_bytes());
    }

    fn command(&mut self, command: MavCmd, param1: f32, param2: f32) {
        let message = MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command,
            param1,
            param2,
            target_system: 1,
            target_component: 1,
            ..COMMAND_LONG_DATA::DEFAULT
        });
        self.send(255, 190, &message);
    }

    fn take(&mut self, frame: &Frame) {
        match &frame.message {
            MavMessage::HEARTBEAT(data) if frame.header.component_id == 1 => {
                self.armed = data
                    .base_mode
                    .contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
                if self.mode != data.custom_mode {
                    self.mode = data.custom_mode;
                    self.modes.push(self.mode);
                    eprintln!("{:7.1} s mode {}", self.now_s(), self.mode);
                }
            }
            MavMessage::GLOBAL_POSITION_INT(data) => {
                self.above_home_m = f64::from(data.relative_alt) * 1e-3;
                self.place = Geodetic::new(
                    f64::from(data.lat) * 1e-7,
                    f64::from(data.lon) * 1e-7,
                    f64::from(data.alt) * 1e-3,
                );
            }
            MavMessage::MISSION_CURRENT(data) => self.item = data.seq,
            MavMessage::MISSION_REQUEST_INT(data)
                if data.mission_type == MavMissionType::MAV_MISSION_TYPE_MISSION =>
            {
                if let Some(item) = self.mission.get(usize::from(data.seq)).cloned() {
                    self.send(255, 190, &MavMessage::MISSION_ITEM_INT(item));
                }
            }
            MavMessage::MISSION_REQUEST(data) => {
                if let Some(item) = self.mission.get(usize::from(data.seq)).cloned() {
                    self.send(255, 190, &MavMessage::MISSION_ITEM_INT(item));
                }
            }
            MavMessage::MISSION_ACK(data) if data.target_system == 255 => self.uploaded = true,
            _ => {}
        }
    }

    /// Runs until `done`, at most `longest_s`.
    fn run(&mut self, longest_s: f64, what: &str, mut done: impl FnMut(&mut Self) -> bool) {
        let end_s = self.now_s() + longest_s;
        while !done(self) {
            assert!(
                self.now_s() < end_s,
                "waited {longest_s} s for {what}: {}",
                self.companion.status_line(self.now_s())
            );
            if let Ok(frame) = self.frames.recv_timeout(Duration::from_millis(10)) {
                let now_s = self.now_s();
                self.companion.receive(&frame.header, &frame.message, now_s);
                self.take(&frame);
            }
            let now_s = self.now_s();
            if now_s >= self.next_heartbeat_s {
                self.next_heartbeat_s = now_s + 1.0;
                self.send(255, 190, &MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT));
            }
            self.show_intruder(now_s);
            self.companion.tick(now_s);
            for outgoing in self.companion.outbox() {
                self.send(outgoing.system_id, 196, &outgoing.message);
            }
        }
    }

    fn show_intruder(&mut self, now_s: f64) {
        let Some(sample) = self.intruder.as_ref().and_then(|played| played.at(now_s)) else {
            return;
        };
        if let Some(place) = self.place {
            let frame = LocalFrame::new(place, Earth::Wgs84);
            self.least_m = self.least_m.min(frame.to_local_m(sample.place).length());
        }
        if now_s >= self.next_report_s {
            self.next_report_s = now_s + 0.5;
            let message = adsb_message(0x00AB_C123, "FGATEST", &sample);
            let header = MavHeader {
                system_id: 200,
                component_id: 156,
                sequence: 0,
            };
            self.companion.receive(&header, &message, now_s);
        }
    }

    fn upload(&mut self, home: Geodetic) {
        let frame = LocalFrame::new(home, Earth::Wgs84);
        let item = |seq: u16, command: MavCmd, east_m: f64, north_m: f64| {
            let place = frame.to_geodetic(Vec3::new(east_m, north_m, 0.0));
            MISSION_ITEM_INT_DATA {
                seq,
                command,
                frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
                x: (place.latitude_deg * 1e7) as i32,
                y: (place.longitude_deg * 1e7) as i32,
                z: ALTITUDE_M as f32,
                param1: if command == MavCmd::MAV_CMD_NAV_TAKEOFF {
                    15.0
                } else {
                    0.0
                },
                target_system: 1,
                target_component: 1,
                autocontinue: 1,
                ..MISSION_ITEM_INT_DATA::DEFAULT
            }
        };
        let way = MavCmd::MAV_CMD_NAV_WAYPOINT;
        self.mission = vec![
            item(0, way, 0.0, 0.0),
            item(1, MavCmd::MAV_CMD_NAV_TAKEOFF, 0.0, 300.0),
            item(2, way, 0.0, 800.0),
            item(3, way, 0.0, 5000.0),
            item(4, way, 3000.0, 5000.0),
        ];
        let count = MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
            count: 5,
            target_system: 1,
            target_component: 1,
            ..MISSION_COUNT_DATA::DEFAULT
        });
        self.send(255, 190, &count);
    }
}

#[test]
#[ignore = "needs an ArduPlane in software in the loop, named by FGA_SITL"]
fn an_auto_mission_with_intruders_is_flown_apart_and_resumed() {
    let Ok(endpoint) = std::env::var("FGA_SITL") else {
        eprintln!("skipped: FGA_SITL names no endpoint");
        return;
    };
    let mut bench = Bench::new(&endpoint);
    bench.run(60.0, "a position", |b| {
        b.place.is_some_and(|p| p.latitude_deg != 0.0)
    });
    let home = bench.place.expect("a position");
    bench.upload(home);
    bench.run(20.0, "the mission", |b| b.uploaded);
    let mut again_s = 0.0;
    bench.run(120.0, "flight in AUTO", move |b| {
        if b.now_s() > again_s {
            again_s = b.now_s() + 2.0;
            if b.mode != AUTO {
                b.command(MavCmd::MAV_CMD_DO_SET_MODE, 1.0, AUTO as f32);
            } else if !b.armed {
                b.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 1.0, 0.0);
            }
        }
        b.armed && b.mode == AUTO && b.above_home_m > 0.8 * ALTITUDE_M && b.item >= 3
    });
    for speed_mps in [0.0_f64, 25.0] {
        // On the leg, so far ahead that it is met in about 40 s.
        let here = bench.place.expect("a position");
        let ahead_m = 40.0 * (25.0 + speed_mps);
        let frame = LocalFrame::new(here, Earth::Wgs84);
        let place = frame.to_geodetic(Vec3::new(0.0, ahead_m.min(1400.0), 0.0));
        let velocity_mps = Vec3::new(0.0, -speed_mps, 0.0);
        let sample = Sample {
            time_s: bench.now_s(),
            place,
            velocity_mps,
        };
        let samples = vec![sample];
        bench.intruder = Some(Played {
            icao: 0x00AB_C123,
            callsign: "FGATEST".into(),
            samples,
        });
        bench.least_m = f64::INFINITY;
        let began = bench.modes.len();
        bench.run(90.0, "the take-over", |b| b.mode == GUIDED);
        bench.run(120.0, "the return", |b| b.mode == AUTO);
        eprintln!("{speed_mps} m/s: least distance {:.1} m", bench.least_m);
        assert!(bench.least_m >= 60.0, "{}", bench.least_m);
        assert_eq!(bench.modes[began..], [GUIDED, AUTO]);
        assert_eq!(bench.item, 3);
        bench.intruder = None;
        let rest_s = bench.now_s() + 25.0;
        bench.run(60.0, "rest", |b| b.now_s() > rest_s);
    }
}
