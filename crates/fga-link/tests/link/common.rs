//! The companion and the emulator side by side in scaled time, with a bad network between them.
#![allow(
    unreachable_pub,
    clippy::std_instead_of_alloc,
    clippy::std_instead_of_core,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a bench; its numbers are small"
)]

pub mod beat;
pub mod ground;
mod intruder;
pub mod kinds;
pub mod live;
mod network;
pub mod random;

pub use intruder::{Intruder, distance};
use network::Packet;
pub use network::{BAD, GOOD, Network};
pub use random::Random;
use std::collections::BinaryHeap;
use std::path::PathBuf;

use fga_emulator::{Emulator, EmulatorSettings, MissionItem, PlaneMode, STEP_S};
use fga_link::config::PolicyName;
use fga_link::player::{LoggedLine, read_log};
use fga_link::wire::{Signing, encode};
use fga_link::{Companion, Config};
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{
    ADSB_VEHICLE_DATA, AdsbAltitudeType, AdsbFlags, COMMAND_LONG_DATA, MISSION_COUNT_DATA, MavCmd,
    MavFrame, MavMessage, MavMissionType, MavParamType, PARAM_SET_DATA,
};

/// A file of the third-party data; without it the test skips, or fails in CI.
pub fn data(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("FGA_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    let path = folder.join(name);
    if path.exists() {
        return Some(path);
    }
    let missing = format!("{} is missing (FGA_DATA names the folder)", path.display());
    assert!(std::env::var("CI").is_err(), "{missing}");
    eprintln!("skipped: {missing}");
    None
}

/// The recorded BaseStation log.
pub fn sbs_log() -> Option<Vec<LoggedLine>> {
    let file = std::fs::File::open(data("adsb/stratux-es.log.gz")?).expect("readable");
    Some(read_log(flate2::read::GzDecoder::new(file)).0)
}

/// The seeds that `FGA_SEQUENCES` sets, as `COUNT` or `FIRST..END`; else the first `count`.
pub fn seeds(count: u64) -> core::ops::Range<u64> {
    let Ok(text) = std::env::var("FGA_SEQUENCES") else {
        return 0..count;
    };
    let number = |text: &str| text.parse().expect("FGA_SEQUENCES is COUNT or FIRST..END");
    match text.split_once("..") {
        Some((first, end)) => number(first)..number(end),
        None => 0..number(&text),
    }
}

#[expect(
    clippy::struct_excessive_bools,
    reason = "independent switches of the bench"
)]
pub struct World {
    pub emulator: Emulator,
    pub companion: Companion,
    pub intruders: Vec<Intruder>,
    pub shown: Vec<bool>,
    pub time_s: f64,
    pub network: Network,
    /// The companion is dead from here on.
    pub killed: bool,
    /// Nothing passes at all.
    pub cut: bool,
    /// The vehicle stands still, with its clock: messages to it wait.
    pub frozen: bool,
    held: Vec<(MavHeader, MavMessage)>,
    /// The companion hears nothing of the vehicle.
    pub deaf: bool,
    /// Only heartbeats pass.
    pub no_telemetry: bool,
    /// Messages to the vehicle wait this long in a queue, besides the network's delay, seconds.
    pub uplink_queue_s: f64,
    /// The pitot tube is blocked: the vehicle reports no airspeed.
    pub blocked_pitot: bool,
    /// The vehicle reports this rate of descent beside its own, metres per second, and keeps its altitude: it swings in turns.
    pub reported_sink_mps: f64,
    /// The vehicle's signing, and the companion's.
    pub signing: Option<(Signing, Signing)>,
    /// Frames that the companion refused, and those that the vehicle refused.
    pub refused: [u32; 2],
    /// The packets of each sender have a separate fate: more of one change nothing of the others.
    fates: [Random; 4],
    /// … and those about the fence's status have another, with the answers that are due for requests of it.
    fence_fate: Random,
    fence_answers: u32,
    queue: BinaryHeap<Packet>,
    number: u64,
    sequences: [u8; 4],
    next_report_s: Vec<f64>,
    /// Interval of the reports of intruders, seconds.
    pub report_every_s: f64,
    /// The companion's first report of each intruder, seconds.
    pub first_heard_s: Vec<Option<f64>>,
    /// Number of requests for GUIDED that the network lost.
    pub lost_requests: u32,
    /// Least distance to each intruder, metres, and when.
    pub least_m: Vec<(f64, f64)>,
    /// Every message the companion sent, with its time.
    pub sent: Vec<(f64, MavMessage)>,
    pub keep_sent: bool,
    /// Every message that the companion heard, with its time, where kept.
    pub heard: Option<Vec<(f64, MavHeader, MavMessage)>>,
    /// σ of the places and velocities in reports along an axis, metres and metres per second.
    pub noise: (f64, f64),
    noise_fate: Random,
    /// Reports give pressure altitudes, in air with this pressure at sea level, hectopascals.
    pub sea_level_hpa: Option<f64>,
}

/// A transponder's altitude: the height at which the standard atmosphere has the
/// pressure of this air, in steps of 25 ft. By the barometric formula, layer by layer from the
/// ground, so that it shares nothing with the program's.
fn pressure_altitude_mm(altitude_mm: i32, sea_level_hpa: f64) -> i32 {
    let (mut hpa, mut standard_hpa) = (sea_level_hpa, 1013.25);
    let step_m = 0.1;
    let fall = |hpa: f64, at_m: f64| hpa * 9.806_65 / (287.053 * (288.15 - 0.0065 * at_m)) * step_m;
    let mut at_m = 0.0;
    while at_m < f64::from(altitude_mm) * 1e-3 {
        hpa -= fall(hpa, at_m);
        at_m += step_m;
    }
    let mut pressure_m = 0.0;
    while standard_hpa > hpa {
        standard_hpa -= fall(standard_hpa, pressure_m);
        pressure_m += step_m;
    }
    while standard_hpa < hpa {
        standard_hpa += fall(standard_hpa, pressure_m);
        pressure_m -= step_m;
    }
    ((pressure_m / 7.62).round() * 7620.0) as i32
}

/// A mission along these points; item 0 is home.
pub fn mission(emulator: &Emulator, points_m: &[[f64; 3]]) -> Vec<MissionItem> {
    let home = *emulator.home();
    let mut items = vec![MissionItem {
        command: MavCmd::MAV_CMD_NAV_WAYPOINT,
        frame: MavFrame::MAV_FRAME_GLOBAL,
        ..MissionItem::waypoint(&home, [0.0, 0.0, home.altitude_m])
    }];
    items.extend(
        points_m
            .iter()
            .map(|point| MissionItem::waypoint(&home, *point)),
    );
    items
}

/// A ground station.
pub const GROUND: MavHeader = MavHeader {
    system_id: 255,
    component_id: 190,
    sequence: 0,
};

/// The message that sets a parameter of a component of the vehicle.
pub fn parameter_set(component: u8, name: &str, value: f32) -> MavMessage {
    MavMessage::PARAM_SET(PARAM_SET_DATA {
        param_value: value,
        target_system: 1,
        target_component: component,
        param_id: name.into(),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    })
}

/// A ground station on the second link uploads a list, and sets the vehicle's item.
pub fn upload(
    world: &mut World,
    mission_type: MavMissionType,
    items: &[MissionItem],
    current: Option<u16>,
) {
    let count = MISSION_COUNT_DATA {
        count: u16::try_from(items.len()).expect("a short list"),
        target_system: 1,
        target_component: 1,
        mission_type,
        ..MISSION_COUNT_DATA::DEFAULT
    };
    world
        .emulator
        .receive_on_second_link(&GROUND, &MavMessage::MISSION_COUNT(count));
    for (seq, item) in (0_u16..).zip(items) {
        let data = item.message(seq, mission_type, (1, 1));
        world
            .emulator
            .receive_on_second_link(&GROUND, &MavMessage::MISSION_ITEM_INT(data));
    }
    if let Some(seq) = current {
        let data = COMMAND_LONG_DATA {
            command: MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT,
            param1: f32::from(seq),
            target_system: 1,
            target_component: 1,
            ..COMMAND_LONG_DATA::DEFAULT
        };
        world
            .emulator
            .receive_on_second_link(&GROUND, &MavMessage::COMMAND_LONG(data));
    }
}

/// A configuration, with the sphere of 60 m and the 3,000 m of surveillance that the encounters of these tests are made
/// for, where it gives no volume of its own. `FGA_POLICY=belief` flies those that name no policy by beliefs.
pub fn configuration(text: &str) -> Config {
    let mut config = Config::parse(text).expect("configuration");
    let policy = std::env::var("FGA_POLICY").ok();
    if let Some(policy) = policy.filter(|_| !text.contains("[command]")) {
        config.command.policy = PolicyName::from_name(&policy).expect("FGA_POLICY is a policy");
    }
    if !text.contains("[volumes") {
        config.protection.radius_m.get_or_insert(60.0);
        config.protection.surveillance_m.get_or_insert(3000.0);
    }
    config
}

/// Whether a message is about the status of the vehicle's fence.
fn is_about_fence(message: &MavMessage) -> bool {
    match message {
        MavMessage::SYS_STATUS(_) => true,
        MavMessage::COMMAND_LONG(data) => {
            data.command == MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL && data.param1 == 1.0
        }
        MavMessage::PARAM_REQUEST_READ(data) => data.param_id.to_str() == Ok("FENCE_TYPE"),
        MavMessage::PARAM_VALUE(data) => data.param_id.to_str() == Ok("FENCE_TYPE"),
        _ => false,
    }
}

impl World {
    /// North along the y axis at 100 m: waypoints at 0 (behind), 6 km, 9 km, and east from there.
    pub fn new(config: &str, network: Network, seed: u64) -> Self {
        Self::with(EmulatorSettings::default(), config, network, seed)
    }

    /// The same with another aircraft, another start or wind.
    pub fn with(settings: EmulatorSettings, config: &str, network: Network, seed: u64) -> Self {
        let mut emulator = Emulator::new(settings);
        let points = [
            [0.0, 0.0, 100.0],
            [0.0, 6000.0, 100.0],
            [0.0, 9000.0, 100.0],
            [3000.0, 9000.0, 100.0],
        ];
        let items = mission(&emulator, &points);
        emulator.set_mission(items, 2);
        let companion = Companion::new(configuration(config), false).expect("companion");
        Self {
            emulator,
            companion,
            intruders: Vec::new(),
            shown: Vec::new(),
            time_s: 0.0,
            network,
            killed: false,
            cut: false,
            frozen: false,
            held: Vec::new(),
            deaf: false,
            no_telemetry: false,
            fence_fate: Random::new(seed ^ 0xFE7CE),
            fence_answers: 0,
            uplink_queue_s: 0.0,
            blocked_pitot: false,
            reported_sink_mps: 0.0,
            signing: None,
            refused: [0; 2],
            fates: [1, 2, 3, 4].map(|sender| Random::new(seed.wrapping_mul(4) + sender)),
            queue: BinaryHeap::new(),
            number: 0,
            sequences: [0; 4],
            next_report_s: Vec::new(),
            report_every_s: 0.5,
            first_heard_s: Vec::new(),
            lost_requests: 0,
            least_m: Vec::new(),
            sent: Vec::new(),
            keep_sent: false,
            heard: None,
            noise: (0.0, 0.0),
            noise_fate: Random::new(seed ^ 0x4015E),
            sea_level_hpa: None,
        }
    }

    pub fn add(&mut self, intruder: Intruder) {
        self.intruders.push(intruder);
        self.shown.push(false);
        self.next_report_s.push(0.0);
        self.first_heard_s.push(None);
        self.least_m.push((f64::INFINITY, 0.0));
    }

    fn post(&mut self, to_vehicle: bool, sender: usize, ids: (u8, u8), message: &MavMessage) {
        let sequence = self.sequences[sender];
        self.sequences[sender] = sequence.wrapping_add(1);
        if self.cut {
            return;
        }
        if self.deaf && sender == 0 {
            return;
        }
        if self.no_telemetry && !to_vehicle && !matches!(message, MavMessage::HEARTBEAT(_)) {
            return;
        }
        let header = MavHeader {
            system_id: u32::from(ids.0),
            component_id: ids.1,
            sequence,
        };
        let is_answer = matches!(message, MavMessage::COMMAND_ACK(data)
            if data.command == MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL && self.fence_answers > 0);
        self.fence_answers -= u32::from(is_answer);
        let fate = if is_answer || is_about_fence(message) {
            &mut self.fence_fate
        } else {
            &mut self.fates[sender]
        };
        let copies = if fate.uniform(0.0, 1.0) < self.network.copies {
            2
        } else {
            1
        };
        for _ in 0..copies {
            if fate.uniform(0.0, 1.0) < self.network.loss {
                let is_request = |data: &COMMAND_LONG_DATA| {
                    data.command == MavCmd::MAV_CMD_DO_SET_MODE
                        && f64::from(data.param2) == f64::from(PlaneMode::Guided.number())
                };
                if matches!(message, MavMessage::COMMAND_LONG(data) if is_request(data)) {
                    self.lost_requests += 1;
                }
                continue;
            }
            let mut delay_s = self.network.delay_s + fate.uniform(0.0, self.network.jitter_s);
            if to_vehicle {
                delay_s += self.uplink_queue_s;
            }
            let mut message = message.clone();
            if let MavMessage::VFR_HUD(data) = &mut message
                && self.blocked_pitot
            {
                data.airspeed = 0.0;
            }
            if let MavMessage::GLOBAL_POSITION_INT(data) = &mut message {
                data.vz += (100.0 * self.reported_sink_mps) as i16;
            }
            let signed = self.signing.as_ref().map(|(vehicle, companion)| {
                let signer = if to_vehicle { companion } else { vehicle };
                encode(header, &message, Some(signer))
            });
            self.number += 1;
            self.queue.push(Packet {
                due_us: ((self.time_s + delay_s) * 1e6) as u64,
                number: self.number,
                to_vehicle,
                header,
                message,
                signed,
            });
        }
    }

    /// Whether the receiver believes a packet's signature.
    fn believes(&mut self, packet: &Packet) -> bool {
        let Some(((vehicle, companion), raw)) = self.signing.as_ref().zip(packet.signed.as_ref())
        else {
            return true;
        };
        let receiver = if packet.to_vehicle {
            vehicle
        } else {
            companion
        };
        let believed = receiver.accepts(raw);
        self.refused[usize::from(packet.to_vehicle)] += u32::from(!believed);
        believed
    }

    /// Sends a message to the companion as any system and component.
    pub fn say_as(&mut self, ids: (u8, u8), message: &MavMessage) {
        self.post(false, 3, ids, message);
    }

    /// The number of the vehicle's next frame.
    pub fn vehicle_sequence(&self) -> u8 {
        self.sequences[0]
    }

    /// The ground station sets a parameter of the vehicle.
    pub fn set_parameter(&mut self, name: &str, value: f32) {
        self.emulator
            .receive(&GROUND, &parameter_set(1, name, value));
    }

    /// Sends a message to the companion as a ground station.
    pub fn say_from_ground(&mut self, message: &MavMessage) {
        self.post(false, 3, (255, 190), message);
    }

    pub fn step(&mut self) {
        self.time_s += STEP_S;
        let time_s = self.time_s;
        if !self.frozen {
            for (header, message) in core::mem::take(&mut self.held) {
                self.emulator.receive(&header, &message);
            }
            self.emulator.advance(STEP_S);
        }
        let own_m = self.emulator.plant().position_m();
        for index in 0..self.intruders.len() {
            self.intruders[index].step(time_s, STEP_S);
            let range_m = distance(own_m, self.intruders[index].position_m);
            if range_m < self.least_m[index].0 {
                self.least_m[index] = (range_m, time_s);
            }
            if range_m <= self.intruders[index].shown_m {
                self.shown[index] = true;
            }
            if self.shown[index] && time_s >= self.next_report_s[index] {
                self.next_report_s[index] = time_s + self.report_every_s;
                let seen = self.with_noise(self.intruders[index]);
                let report = self.report_of(&seen);
                self.post(false, 2, (200, 156), &report);
            }
        }
        for message in self.emulator.drain() {
            let ids = (self.emulator.system_id(), 1);
            self.post(false, 0, ids, &message);
        }
        while self
            .queue
            .peek()
            .is_some_and(|packet| packet.due_us as f64 * 1e-6 <= time_s)
        {
            let Some(packet) = self.queue.pop() else {
                break;
            };
            if !self.believes(&packet) {
                continue;
            }
            if packet.to_vehicle && self.frozen {
                self.held.push((packet.header, packet.message));
            } else if packet.to_vehicle {
                if matches!(packet.message, MavMessage::COMMAND_LONG(_)) {
                    self.fence_answers += u32::from(is_about_fence(&packet.message));
                }
                self.emulator.receive(&packet.header, &packet.message);
            } else if !self.killed {
                if let MavMessage::ADSB_VEHICLE(data) = &packet.message
                    && let Some(index) = self
                        .intruders
                        .iter()
                        .position(|intruder| intruder.icao == data.ICAO_address)
                {
                    self.first_heard_s[index].get_or_insert(time_s);
                }
                if let Some(heard) = &mut self.heard {
                    heard.push((time_s, packet.header, packet.message.clone()));
                }
                self.companion
                    .receive(&packet.header, &packet.message, time_s);
                self.flush();
            }
        }
        if !self.killed {
            self.companion.tick(time_s);
            self.companion.make_ground(time_s);
            self.flush();
        }
    }

    /// The next report of each intruder comes at this time, seconds.
    pub fn next_reports_at(&mut self, time_s: f64) {
        self.next_report_s.fill(time_s);
    }

    fn flush(&mut self) {
        for outgoing in self.companion.outbox() {
            if self.keep_sent {
                self.sent.push((self.time_s, outgoing.message.clone()));
            }
            self.post(true, 1, (outgoing.system_id, 196), &outgoing.message);
        }
    }

    /// An aircraft as it is reported, with noise in its level place and its velocity.
    fn with_noise(&mut self, mut seen: Intruder) -> Intruder {
        let (sigma_m, sigma_mps) = self.noise;
        for axis in 0..2 {
            seen.position_m[axis] += self.noise_fate.normal(sigma_m);
            seen.velocity_mps[axis] += self.noise_fate.normal(sigma_mps);
        }
        seen
    }

    /// A receiver's present report of an intruder.
    pub fn report(&self, index: usize) -> MavMessage {
        self.report_of(&self.intruders[index])
    }

    /// A receiver's report of an aircraft.
    pub fn report_of(&self, intruder: &Intruder) -> MavMessage {
        let place = self.emulator.home().to_place(intruder.position_m);
        let [east, north, up] = intruder.velocity_mps;
        let heading = east.atan2(north).to_degrees().rem_euclid(360.0);
        MavMessage::ADSB_VEHICLE(ADSB_VEHICLE_DATA {
            ICAO_address: intruder.icao,
            lat: place.latitude_e7,
            lon: place.longitude_e7,
            altitude: self.sea_level_hpa.map_or(place.altitude_mm, |hpa| {
                pressure_altitude_mm(place.altitude_mm, hpa)
            }),
            heading: (heading * 100.0) as u16,
            hor_velocity: (east.hypot(north) * 100.0) as u16,
            ver_velocity: (up * 100.0) as i16,
            flags: AdsbFlags::ADSB_FLAGS_VALID_COORDS
                | AdsbFlags::ADSB_FLAGS_VALID_ALTITUDE
                | AdsbFlags::ADSB_FLAGS_VALID_HEADING
                | AdsbFlags::ADSB_FLAGS_VALID_VELOCITY
                | AdsbFlags::ADSB_FLAGS_VERTICAL_VELOCITY_VALID,
            altitude_type: if self.sea_level_hpa.is_some() {
                AdsbAltitudeType::ADSB_ALTITUDE_TYPE_PRESSURE_QNH
            } else {
                AdsbAltitudeType::ADSB_ALTITUDE_TYPE_GEOMETRIC
            },
            callsign: "TEST".into(),
            ..ADSB_VEHICLE_DATA::DEFAULT
        })
    }

    pub fn run_until(&mut self, time_s: f64) {
        while self.time_s < time_s {
            self.step();
        }
    }

    /// Runs until a condition holds; panics after `longest_s`.
    pub fn run_while(
        &mut self,
        longest_s: f64,
        what: &str,
        mut goes_on: impl FnMut(&Self) -> bool,
    ) {
        let end_s = self.time_s + longest_s;
        while goes_on(self) {
            assert!(
                self.time_s < end_s,
                "waited {longest_s} s for: {what}; {}",
                self.companion.status_line(self.time_s)
            );
            self.step();
        }
    }

    pub fn mode(&self) -> PlaneMode {
        self.emulator.mode()
    }

    /// Distance from the leg along the y axis, metres, and angle to it, radians.
    pub fn off_leg(&self) -> (f64, f64) {
        let plant = self.emulator.plant();
        let velocity = plant.velocity_mps();
        (
            plant.position_m()[0].abs(),
            velocity[0].atan2(velocity[1]).abs(),
        )
    }
}
