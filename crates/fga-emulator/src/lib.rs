//! An ArduPlane-like emulator for tests without an ArduPlane.
//!
//! It is *not* ArduPlane and shares no code with it. It has the modes, parameters, time-outs,
//! acknowledgements and gates that a companion computer meets, with behaviour measured on
//! ArduPlane 4.7-dev in software in the loop, on a point mass: a limited roll rate, 0.70 of the
//! ideal turn rate, altitude by a climb angle with a lag.
//!
//! The emulator reads no clock and no socket: [`Emulator::receive`] takes a message,
//! [`Emulator::advance`] advances the time, [`Emulator::drain`] returns its messages. Tests run it in
//! scaled time; `fga emulate` puts it behind a socket in real time.
//!
//! Local frame: x east, y north, z up, metres. Internal headings and banks follow the autopilot:
//! radians, heading clockwise from north, bank positive to the right.
#![forbid(unsafe_code)]
#![expect(
    deprecated,
    reason = "messages that vehicles and ground stations still send"
)]

extern crate alloc;

mod commanded;
mod geometry;
mod guidance;
mod mission;
mod mode;
mod parameters;
mod plant;
mod receive;
mod streams;
mod telemetry;
mod terrain;

pub use geometry::{Home, WirePlace};
pub use mission::MissionItem;
pub use mode::PlaneMode;
pub use parameters::Parameters;
pub use plant::{PlantSettings, Target, VehiclePlant, Vertical};

use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::MavMessage;

use commanded::{Guided, GuidedTarget, RcOverrides};
use streams::Streams;

/// Length of a step of the plant, seconds (ArduPlane's main loop runs at 50 Hz).
pub const STEP_S: f64 = 0.02;

/// The start of the emulation.
#[derive(Debug, Clone)]
pub struct EmulatorSettings {
    /// The vehicle's system id.
    pub system_id: u8,
    /// Origin of the local frame and home.
    pub home: Home,
    /// The aircraft.
    pub plant: PlantSettings,
    /// Position at the start, metres, local frame.
    pub position_m: [f64; 3],
    /// Heading at the start, radians clockwise from north.
    pub heading_rad: f64,
    /// Mode at the start.
    pub mode: PlaneMode,
    /// Whether it is armed and in flight.
    pub armed: bool,
    /// Wind velocity east and north, metres per second.
    pub wind_mps: [f64; 2],
    /// Time since boot of the receiver's first fix, seconds.
    pub fix_s: f64,
    /// Pressure at sea level, hectopascals; `None`: the vehicle does not send its pressure.
    pub sea_level_hpa: Option<f64>,
    /// Time since boot at which the emulation begins, seconds.
    pub boot_s: f64,
    /// Time since boot until which the autopilot initialises, seconds: it sends heartbeats in mode
    /// INITIALISING and ignores messages.
    pub initialising_until_s: f64,
    /// Interval of every message before a companion asks for another one, seconds (ArduPlane's
    /// `SRn` parameters); `None` sends only heartbeats.
    pub default_interval_s: Option<f64>,
    /// Least interval of any message, seconds: a slow telemetry radio.
    pub fastest_interval_s: f64,
}

impl Default for EmulatorSettings {
    fn default() -> Self {
        Self {
            system_id: 1,
            home: Home {
                latitude_deg: 37.6189,
                longitude_deg: -122.375,
                altitude_m: 4.0,
            },
            plant: PlantSettings::default(),
            position_m: [0.0, 0.0, 100.0],
            heading_rad: 0.0,
            mode: PlaneMode::Auto,
            armed: true,
            wind_mps: [0.0, 0.0],
            fix_s: 0.0,
            sea_level_hpa: Some(1013.25),
            boot_s: 20.0,
            initialising_until_s: 0.0,
            default_interval_s: None,
            fastest_interval_s: 0.0,
        }
    }
}

/// A change of mode and who asked for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VehicleModeChange {
    /// Time since boot, seconds.
    pub time_s: f64,
    /// The new mode.
    pub mode: PlaneMode,
    /// The component that asked; 0 for the pilot's switch.
    pub component_id: u8,
}

/// The emulated autopilot and aircraft.
#[derive(Debug)]
pub struct Emulator {
    settings: EmulatorSettings,
    /// Parameters by name.
    pub parameters: Parameters,
    plant: VehiclePlant,
    time_s: f64,
    left_over_s: f64,
    mode: PlaneMode,
    armed: bool,
    mode_changes: Vec<VehicleModeChange>,
    mission: Vec<MissionItem>,
    fence: Vec<MissionItem>,
    rally: Vec<MissionItem>,
    guidance: GuidedTarget,
    guided: Guided,
    overrides: RcOverrides,
    streams: Streams,
    intruders: Vec<(
        u32,
        f64,
        mavlink::dialects::ardupilotmega::ADSB_VEHICLE_DATA,
    )>,
    upload: Option<mission::Upload>,
    refuse_commands: bool,
    ignore_attitude: bool,
    outbox: Vec<MavMessage>,
    /// For the ground station on the second link.
    second_outbox: Vec<MavMessage>,
    /// Its memory card with heights of the ground.
    card: Option<terrain::Card>,
    texts: Vec<String>,
    received: u64,
    /// Height of home above the origin of the local frame, metres: a ground station can move home.
    home_up_m: f64,
}

/// Longest list of aircraft that the autopilot keeps.
const LONGEST_INTRUDER_LIST: usize = 25;

impl Emulator {
    /// An emulator at its start.
    pub fn new(settings: EmulatorSettings) -> Self {
        let plant = VehiclePlant::new(
            settings.plant,
            settings.position_m,
            settings.heading_rad,
            settings.wind_mps,
        );
        let mut emulator = Self {
            parameters: Parameters::default(),
            plant,
            time_s: settings.boot_s,
            left_over_s: 0.0,
            mode: settings.mode,
            armed: settings.armed,
            mode_changes: Vec::new(),
            mission: Vec::new(),
            fence: Vec::new(),
            rally: Vec::new(),
            guidance: GuidedTarget::default(),
            guided: Guided::default(),
            overrides: RcOverrides::default(),
            streams: Streams::new(settings.default_interval_s),
            intruders: Vec::new(),
            upload: None,
            refuse_commands: false,
            ignore_attitude: false,
            outbox: Vec::new(),
            second_outbox: Vec::new(),
            card: None,
            texts: Vec::new(),
            received: 0,
            home_up_m: 0.0,
            settings,
        };
        emulator
            .parameters
            .set("AIRSPEED_CRUISE", emulator.settings.plant.airspeed_mps);
        emulator.enter(emulator.mode);
        emulator
    }

    /// Sets the mission; item 0 is home, as on the autopilot.
    pub fn set_mission(&mut self, items: Vec<MissionItem>, current: u16) {
        self.mission = items;
        self.guidance.jumps.clear();
        self.guidance.done = false;
        self.guidance.begin_item(current, &self.plant, false);
        self.guidance.previous_m = (current > 0)
            .then(|| self.mission.get(usize::from(current) - 1))
            .flatten()
            .and_then(|item| item.position_m(&self.settings.home))
            .unwrap_or(self.plant.position_m());
    }

    /// Gives it a memory card with heights of the ground above mean sea level, metres, by latitude and longitude, degrees.
    pub fn set_card(&mut self, height_m: impl Fn([f64; 2]) -> Option<f32> + Send + Sync + 'static) {
        self.card = Some(terrain::Card::new(alloc::sync::Arc::new(height_m)));
    }

    /// Sets the fence, and enables it.
    pub fn set_fence(&mut self, items: Vec<MissionItem>) {
        self.store_fence(items);
        self.parameters.set("FENCE_ENABLE", 1.0);
    }

    /// Sets the fence without a change of whether it is enabled.
    pub fn store_fence(&mut self, items: Vec<MissionItem>) {
        self.fence = items;
    }

    /// Sets the rally points.
    pub fn set_rally(&mut self, items: Vec<MissionItem>) {
        self.rally = items;
    }

    /// The target of a return from here, metres, local frame: as in ArduPlane the nearest rally point
    /// within `RALLY_LIMIT_KM` (0: any), with `RALLY_INCL_HOME` only if it is nearer than home; else home.
    pub(crate) fn return_place_m(&self) -> [f64; 3] {
        const HOME_M: [f64; 3] = [0.0, 0.0, 100.0];
        let here_m = self.plant.position_m();
        let away_m = |at_m: &[f64; 3]| geometry::distance_m(here_m, *at_m);
        let limit_m = 1e3 * self.parameters.value("RALLY_LIMIT_KM");
        let with_home = self.parameters.value("RALLY_INCL_HOME") != 0.0;
        self.rally
            .iter()
            .filter_map(|item| item.position_m(&self.settings.home))
            .min_by(|a, b| away_m(a).total_cmp(&away_m(b)))
            .filter(|at_m| limit_m <= 0.0 || away_m(at_m) <= limit_m)
            .filter(|at_m| !with_home || away_m(at_m) < away_m(&HOME_M))
            .unwrap_or(HOME_M)
    }

    /// Advances the time, in steps of the plant; a remainder waits for the next call.
    pub fn advance(&mut self, by_s: f64) {
        self.left_over_s += by_s;
        while self.left_over_s >= STEP_S - 1e-9 {
            self.left_over_s -= STEP_S;
            self.step();
        }
    }

    fn step(&mut self) {
        self.time_s += STEP_S;
        if self.armed {
            let target = self.target();
            self.plant.step(&target, &self.parameters, STEP_S);
        }
        let time_s = self.time_s;
        self.intruders
            .retain(|(_, heard_s, _)| time_s - heard_s < 5.0);
        self.send_telemetry();
    }

    /// The messages since the last call.
    pub fn drain(&mut self) -> Vec<MavMessage> {
        core::mem::take(&mut self.outbox)
    }

    /// Takes a message on the second link. The answer goes back only on that link; the first link
    /// receives only the autopilot's texts about it.
    pub fn receive_on_second_link(&mut self, header: &MavHeader, message: &MavMessage) {
        if matches!(message, MavMessage::TERRAIN_DATA(_)) {
            // It names no receiver: passed on.
            self.outbox.push(message.clone());
            return;
        }
        let first = core::mem::take(&mut self.outbox);
        self.receive(header, message);
        let answers = core::mem::replace(&mut self.outbox, first);
        for answer in answers {
            match answer {
                MavMessage::STATUSTEXT(_) | MavMessage::HEARTBEAT(_) => {
                    self.outbox.push(answer.clone());
                    self.second_outbox.push(answer);
                }
                _ => self.second_outbox.push(answer),
            }
        }
    }

    /// The messages on the second link since the last call.
    pub fn drain_second_link(&mut self) -> Vec<MavMessage> {
        core::mem::take(&mut self.second_outbox)
    }

    /// The vehicle's system id.
    pub const fn system_id(&self) -> u8 {
        self.settings.system_id
    }

    /// Time since boot, seconds.
    pub const fn time_s(&self) -> f64 {
        self.time_s
    }

    /// The true state of the aircraft.
    pub const fn plant(&self) -> &VehiclePlant {
        &self.plant
    }

    /// Origin of the local frame.
    pub const fn home(&self) -> &Home {
        &self.settings.home
    }

    /// The mode.
    pub const fn mode(&self) -> PlaneMode {
        self.mode
    }

    /// Every change of mode since the start.
    pub fn mode_changes(&self) -> &[VehicleModeChange] {
        &self.mode_changes
    }

    /// The present mission item.
    pub const fn mission_item(&self) -> u16 {
        self.guidance.item
    }

    /// The mission items without a place that ran, and when, seconds since boot.
    pub fn items_run(&self) -> &[(f64, u16)] {
        &self.guidance.ran
    }

    /// Whether the aircraft reached the last item.
    pub const fn mission_done(&self) -> bool {
        self.guidance.done
    }

    /// Texts of other components for the operator.
    pub fn texts(&self) -> &[String] {
        &self.texts
    }

    /// Present interval of a message, seconds.
    pub fn interval_s(&self, message_id: u32) -> Option<f64> {
        self.streams.interval_s(message_id)
    }

    /// Whether the autopilot is initialising.
    pub(crate) fn is_initialising(&self) -> bool {
        self.time_s < self.settings.initialising_until_s
    }

    /// Number of messages received.
    pub const fn received(&self) -> u64 {
        self.received
    }

    /// The pilot's mode switch.
    pub fn pilot_mode(&mut self, mode: PlaneMode) {
        self.change_mode(mode, 0);
    }

    /// The pilot or the ground arms or disarms.
    pub fn set_armed(&mut self, armed: bool) {
        self.armed = armed;
        self.send_heartbeat();
    }

    /// For tests: the autopilot refuses every command from now on.
    pub fn refuse_commands(&mut self, refuse: bool) {
        self.refuse_commands = refuse;
    }

    /// For tests: attitude targets, headings and overrides have no effect from now on.
    pub fn ignore_targets(&mut self, ignore: bool) {
        self.ignore_attitude = ignore;
    }

    /// For tests: a gust that moves the aircraft at once, metres.
    pub fn displace(&mut self, by_m: [f64; 3]) {
        self.plant.displace(by_m);
    }

    /// For tests: the engine gives another airspeed from now on, metres per second.
    pub const fn set_airspeed(&mut self, mps: f64) {
        self.plant.set_airspeed(mps);
    }

    /// For tests: the autopilot forgets the requested messages.
    pub fn forget_rates(&mut self) {
        self.streams = Streams::new(self.settings.default_interval_s);
    }

    /// For tests: the autopilot restarts before the flight; it initialises for two seconds.
    pub fn reboot_on_ground(&mut self) {
        self.reboot();
        self.settings.initialising_until_s = 2.0;
    }

    /// For tests: the autopilot restarts in the air; its boot time begins at zero.
    pub fn reboot(&mut self) {
        self.time_s = 0.0;
        self.forget_rates();
        self.guided = Guided::default();
        self.overrides = RcOverrides::default();
    }

    fn change_mode(&mut self, mode: PlaneMode, component_id: u8) {
        if mode == self.mode {
            return;
        }
        self.mode_changes.push(VehicleModeChange {
            time_s: self.time_s,
            mode,
            component_id,
        });
        self.enter(mode);
        // Informs the ground at once instead of at the next heartbeat.
        self.send_heartbeat();
    }

    fn enter(&mut self, mode: PlaneMode) {
        self.mode = mode;
        match mode {
            PlaneMode::Auto => {
                let next = self.guidance.resume_at.take();
                let item = if self.parameters.value("MIS_RESTART") == 1.0 {
                    1
                } else {
                    next.unwrap_or(self.guidance.item).max(1)
                };
                self.guidance.begin_item(item, &self.plant, false);
            }
            PlaneMode::Guided | PlaneMode::Loiter | PlaneMode::Circle | PlaneMode::Newer => {
                self.guided = Guided::at(&self.plant, self.time_s);
            }
            PlaneMode::Rtl => {
                self.guided = Guided::at(&self.plant, self.time_s);
                self.guided.point_m = self.return_place_m();
            }
            PlaneMode::Cruise | PlaneMode::FlyByWireB => {
                self.guidance.enter_stick_mode(&self.plant);
            }
            _ => {}
        }
    }
}
