//! From telemetry in to command out, measured from outside on a running `fga fly`:
//! `cargo run --release -p fga-link --example latency -- target/release/fga 300`.
//!
//! The ArduPlane-like emulator flies north in real time and sends its attitude at 50 Hz over UDP on
//! loopback, among 200 aircraft, each reported twice a second on the same link. A target
//! carries the boot time of the attitude that it answers, which matches each answer with its
//! question. The share of a core is the kernel's count for the program. Arguments: the program,
//! seconds to measure, number of aircraft.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "indices into lists of times, numbers of the wire"
)]

#[path = "../tests/link/common/random.rs"]
mod random;

use core::time::Duration;
use std::collections::HashMap;
use std::fs;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Instant;

use fga::Vec3;
use fga_emulator::{Emulator, EmulatorSettings, Home, MissionItem, PlaneMode, STEP_S};
use fga_formats::geodesy::Geodetic;
use fga_link::endpoint::{LinkRead, LinkReader, LinkWriter, open};
use fga_link::player::{PlayedState, adsb_message};
use fga_link::wire::{Framer, WireFrame, encode};
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::MavMessage;
use random::Random;

const ADDRESS: &str = "127.0.0.1:14690";
/// The program connects, reads parameters and mission, and learns the aircraft.
const WARM_UP_S: f64 = 20.0;
/// Traffic fills a square of this half width around the aircraft, metres.
const AROUND_M: f64 = 2600.0;
/// Steps between two reports of an aircraft.
const REPORT_STEPS: usize = 25;

struct Aircraft {
    icao: u32,
    position_m: [f64; 3],
    velocity_mps: [f64; 3],
}

impl Aircraft {
    fn new(random: &mut Random, icao: u32) -> Self {
        let track = random.uniform(0.0, core::f64::consts::TAU);
        // Half of them at the aircraft's height, the others above, as in real traffic.
        let above_m = if icao.is_multiple_of(2) {
            0.0
        } else {
            random.uniform(150.0, 900.0)
        };
        Self {
            icao,
            position_m: [
                random.uniform(-AROUND_M, AROUND_M),
                random.uniform(-AROUND_M, AROUND_M),
                100.0 + above_m,
            ],
            velocity_mps: [30.0 * track.sin(), 30.0 * track.cos(), 0.0],
        }
    }

    /// Flies on; one that leaves the square comes in on the other side as another aircraft.
    fn fly(&mut self, own_m: [f64; 3], new_icao: &mut u32) {
        let mut left = false;
        let level = self.position_m.iter_mut().zip(own_m).take(2);
        for ((at_m, own_m), speed_mps) in level.zip(self.velocity_mps) {
            *at_m += speed_mps * STEP_S;
            let off_m = *at_m - own_m;
            if off_m.abs() > AROUND_M {
                *at_m -= 2.0 * AROUND_M * off_m.signum();
                left = true;
            }
        }
        if left {
            // Even numbers stay even: the number gives the half.
            self.icao = *new_icao + self.icao % 2;
            *new_icao += 2;
        }
    }
}

impl Aircraft {
    fn report(&self, home: &Home) -> MavMessage {
        let place = home.to_place(self.position_m);
        let [east, north, up] = self.velocity_mps;
        let sample = PlayedState {
            time_s: 0.0,
            place: Geodetic {
                latitude_deg: f64::from(place.latitude_e7) * 1e-7,
                longitude_deg: f64::from(place.longitude_e7) * 1e-7,
                altitude_m: f64::from(place.altitude_mm) * 1e-3,
            },
            velocity_mps: Vec3::new(east, north, up),
        };
        adsb_message(self.icao, "TRAFFIC", &sample)
    }
}

/// Processor time of a process so far, seconds: user and system.
fn processor_s(child: &Child) -> Option<f64> {
    let stat = fs::read_to_string(format!("/proc/{}/stat", child.id())).ok()?;
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |index: usize| fields.get(index)?.parse::<f64>().ok();
    // Fields 14 and 15 of proc(5), of which two stand before the bracket; 100 ticks a second.
    Some((ticks(11)? + ticks(12)?) / 100.0)
}

fn listen(mut reader: LinkReader) -> Receiver<(Instant, WireFrame)> {
    let (to, frames) = sync_channel(4096);
    std::thread::spawn(move || {
        let mut framer = Framer::new(None);
        let mut buffer = [0; 4096];
        loop {
            if let LinkRead::Bytes(count) = reader.read(&mut buffer) {
                let at = Instant::now();
                framer.push(&buffer[..count], |frame| {
                    let _ = to.try_send((at, frame));
                });
                framer.reset();
            }
        }
    });
    frames
}

/// The vehicle, the traffic and the measurements.
struct Bench {
    emulator: Emulator,
    traffic: Vec<Aircraft>,
    new_icao: u32,
    writer: LinkWriter,
    frames: Receiver<(Instant, WireFrame)>,
    sequence: u8,
    step: usize,
    /// Send time of each attitude, by its boot time, and whether it was answered.
    asked: HashMap<u32, (Instant, bool)>,
    first_us: Vec<f64>,
    again_us: Vec<f64>,
    steps_in_guided: usize,
}

impl Bench {
    fn new(count: u32, writer: LinkWriter, frames: Receiver<(Instant, WireFrame)>) -> Self {
        let mut emulator = Emulator::new(EmulatorSettings::default());
        let home = *emulator.home();
        let corners = [[0.0, 0.0, 4.0], [0.0, 0.0, 100.0], [0.0, 90_000.0, 100.0]];
        emulator.set_mission(
            corners
                .map(|corner| MissionItem::waypoint(&home, corner))
                .to_vec(),
            2,
        );
        let mut random = Random::new(4);
        Self {
            emulator,
            traffic: (0..count)
                .map(|number| Aircraft::new(&mut random, 0x0030_0000 + number))
                .collect(),
            new_icao: 0x0031_0000,
            writer,
            frames,
            sequence: 0,
            step: 0,
            asked: HashMap::new(),
            first_us: Vec::new(),
            again_us: Vec::new(),
            steps_in_guided: 0,
        }
    }

    fn flown_s(&self) -> f64 {
        self.step as f64 * STEP_S
    }

    fn send(&mut self, ids: (u8, u8), message: &MavMessage) {
        let header = MavHeader {
            system_id: u32::from(ids.0),
            component_id: ids.1,
            sequence: self.sequence,
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.writer.write(encode(header, message, None).raw_bytes());
    }

    fn report_traffic(&mut self) {
        let home = *self.emulator.home();
        let own_m = self.emulator.plant().position_m();
        let mut reports = Vec::new();
        for (number, aircraft) in self.traffic.iter_mut().enumerate() {
            aircraft.fly(own_m, &mut self.new_icao);
            if (number + self.step).is_multiple_of(REPORT_STEPS) {
                reports.push(aircraft.report(&home));
            }
        }
        for report in reports {
            self.send((200, 156), &report);
        }
    }

    fn report_vehicle(&mut self) {
        let measures = self.flown_s() >= WARM_UP_S;
        for message in self.emulator.drain() {
            // The clock before the send: what the kernel takes counts.
            if let MavMessage::ATTITUDE(data) = &message
                && measures
            {
                self.asked
                    .insert(data.time_boot_ms, (Instant::now(), false));
            }
            self.send((1, 1), &message);
        }
        self.steps_in_guided += usize::from(measures && self.emulator.mode() == PlaneMode::Guided);
    }

    /// Takes what the program sends until the next step is due.
    fn listen_until(&mut self, next: Instant) {
        while let Some(rest) = next.checked_duration_since(Instant::now()) {
            let Ok((at, frame)) = self.frames.recv_timeout(rest) else {
                break;
            };
            self.emulator.receive(&frame.header, &frame.message);
            if let MavMessage::SET_ATTITUDE_TARGET(target) = &frame.message
                && let Some((asked, answered)) = self.asked.get_mut(&target.time_boot_ms)
            {
                let after_us = at.duration_since(*asked).as_secs_f64() * 1e6;
                if core::mem::replace(answered, true) {
                    self.again_us.push(after_us);
                } else {
                    self.first_us.push(after_us);
                }
            }
        }
    }
}

fn print(name: &str, mut times_us: Vec<f64>) {
    if times_us.is_empty() {
        println!("{name}: none");
        return;
    }
    times_us.sort_by(f64::total_cmp);
    let at = |share: f64| times_us[((times_us.len() - 1) as f64 * share) as usize];
    println!(
        "{name}: {} | median {:.0} us | 99 % {:.0} us | 99.9 % {:.0} us | largest {:.0} us",
        times_us.len(),
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0)
    );
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let program = arguments.next().ok_or("expected the path of fga")?;
    let measure_s: f64 = arguments.next().map_or(Ok(300.0), |text| text.parse())?;
    let count: u32 = arguments.next().map_or(Ok(200), |text| text.parse())?;

    let folder = std::env::temp_dir().join(format!("fga-latency-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let config = folder.join("fly.toml");
    fs::write(&config, "[command]\nrate_hz = 50.0\n")?;
    let (reader, writer) = open(&format!("udpin:{ADDRESS}").parse()?)?;
    let frames = listen(reader);
    let mut child = Command::new(&program)
        .args(["fly", "--quiet", "--connect", &format!("udpout:{ADDRESS}")])
        .arg("--config")
        .arg(&config)
        .arg("--out")
        .arg(&folder)
        .stdin(Stdio::null())
        .spawn()?;

    let mut bench = Bench::new(count, writer, frames);
    let start = Instant::now();
    let mut processor_before_s = None;
    while bench.flown_s() <= WARM_UP_S + measure_s {
        if processor_before_s.is_none() && bench.flown_s() >= WARM_UP_S {
            processor_before_s = processor_s(&child).map(|at_s| (at_s, Instant::now()));
        }
        bench.emulator.advance(STEP_S);
        bench.report_traffic();
        bench.report_vehicle();
        bench.step += 1;
        bench.listen_until(start + Duration::from_secs_f64(bench.flown_s()));
    }
    let used = processor_before_s
        .zip(processor_s(&child))
        .map(|((before_s, at), after_s)| (after_s - before_s) / at.elapsed().as_secs_f64());
    child.kill()?;
    child.wait()?;
    fs::remove_dir_all(&folder)?;
    println!(
        "{} aircraft; in GUIDED {:.0} % of the time; {:.1} % of a core",
        bench.traffic.len(),
        100.0 * bench.steps_in_guided as f64 * STEP_S / measure_s,
        100.0 * used.unwrap_or(f64::NAN)
    );
    print("telemetry in to command out", bench.first_us);
    print("sent again before the next telemetry", bench.again_us);
    Ok(())
}
