//! A ground station: the observations of the tests with an ArduPlane.
#![allow(
    deprecated,
    dead_code,
    unreachable_pub,
    clippy::cast_possible_truncation,
    reason = "used in part by tests and an example; coordinates fit"
)]

use std::sync::mpsc::{Receiver, sync_channel};

use fga::Vec3;
use fga_formats::geodesy::{Earth, Geodetic, LocalFrame};
use fga_link::endpoint::{LinkRead, LinkReader, LinkWriter};
use fga_link::wire::{Framer, WireFrame, encode};
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{
    COMMAND_LONG_DATA, GpsFixType, HEARTBEAT_DATA, MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA,
    MavCmd, MavFrame, MavMessage, MavMissionType, MavModeFlag, MavParamType, PARAM_SET_DATA,
    RC_CHANNELS_OVERRIDE_DATA,
};

pub const FBWB: u32 = 6;
pub const CRUISE: u32 = 7;
pub const AUTO: u32 = 10;
pub const AVOID_ADSB: u32 = 14;
pub const GUIDED: u32 = 15;
/// Height of every mission, metres above home.
pub const ALTITUDE_M: f64 = 100.0;

/// The frames that come over a link, in order.
pub fn listen(mut reader: LinkReader) -> Receiver<WireFrame> {
    let (to, frames) = sync_channel(4096);
    std::thread::spawn(move || {
        let mut framer = Framer::new(None);
        let mut buffer = [0; 4096];
        let mut wanted = true;
        while wanted {
            if let LinkRead::Bytes(count) = reader.read(&mut buffer) {
                framer.push(&buffer[..count], |frame| wanted &= to.send(frame).is_ok());
            }
        }
    });
    frames
}

/// The link to the vehicle, and the vehicle's reports.
pub struct Ground {
    writer: LinkWriter,
    sequence: u8,
    /// Frames sent so far.
    pub sent: u64,
    pub mode: u32,
    /// Modes since the list was cleared.
    pub modes: Vec<u32>,
    pub armed: bool,
    pub place: Option<Geodetic>,
    /// Its satellite position, once there is a fix.
    fix: Option<Geodetic>,
    /// East, north, up.
    pub velocity_mps: Vec3,
    pub above_home_m: f64,
    pub item: u16,
    mission: Vec<MISSION_ITEM_INT_DATA>,
    fence: Vec<MISSION_ITEM_INT_DATA>,
    /// Whether the vehicle accepted the last upload.
    pub uploaded: bool,
    /// Positions received so far.
    pub positions: u64,
    /// Texts since the list was cleared.
    pub texts: Vec<String>,
}

impl Ground {
    pub fn new(writer: LinkWriter) -> Self {
        Self {
            writer,
            sequence: 0,
            sent: 0,
            mode: 0,
            modes: Vec::new(),
            armed: false,
            place: None,
            fix: None,
            velocity_mps: Vec3::ZERO,
            above_home_m: 0.0,
            item: 0,
            mission: Vec::new(),
            fence: Vec::new(),
            uploaded: false,
            positions: 0,
            texts: Vec::new(),
        }
    }

    /// Sends a message under these ids.
    pub fn send_as(&mut self, system_id: u8, component_id: u8, message: &MavMessage) {
        let header = MavHeader {
            system_id: u32::from(system_id),
            component_id,
            sequence: self.sequence,
        };
        self.sequence = self.sequence.wrapping_add(1);
        let raw = encode(header, message, None);
        self.sent += u64::from(self.writer.write(raw.raw_bytes()));
    }

    /// Sends a message of the ground station.
    pub fn send(&mut self, message: &MavMessage) {
        self.send_as(255, 190, message);
    }

    pub fn heartbeat(&mut self) {
        self.send(&MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT));
    }

    pub fn set_parameter(&mut self, name: &str, value: f32) {
        self.send(&MavMessage::PARAM_SET(PARAM_SET_DATA {
            param_value: value,
            target_system: 1,
            target_component: 1,
            param_id: name.into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        }));
    }

    pub fn command(&mut self, command: MavCmd, param1: f32, param2: f32) {
        self.send(&MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command,
            param1,
            param2,
            target_system: 1,
            target_component: 1,
            ..COMMAND_LONG_DATA::DEFAULT
        }));
    }

    /// Requests the messages that it needs; the vehicle sends some by default, and some rarely.
    pub fn ask_for_messages(&mut self) {
        for (message_id, interval_s) in [(24.0, 0.5), (33.0, 0.1), (42.0, 0.5)] {
            self.command(
                MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
                message_id,
                interval_s * 1e6,
            );
        }
    }

    /// Its position, once it agrees with the satellites: before the first fix the autopilot
    /// dead-reckons from latitude and longitude 0.
    pub fn home(&self) -> Option<Geodetic> {
        let away_m = self.away_m(self.fix?)?;
        self.place.filter(|_| away_m < 50.0)
    }

    pub fn ask_for_mode(&mut self, mode: u32) {
        self.command(MavCmd::MAV_CMD_DO_SET_MODE, 1.0, mode as f32);
    }

    /// Holds the throttle stick, as a pilot would, and leaves the others. In CRUISE it sets the
    /// airspeed.
    pub fn hold_throttle(&mut self, throttle_us: u16) {
        self.send(&MavMessage::RC_CHANNELS_OVERRIDE(
            RC_CHANNELS_OVERRIDE_DATA {
                chan1_raw: u16::MAX,
                chan2_raw: u16::MAX,
                chan3_raw: throttle_us,
                chan4_raw: u16::MAX,
                chan5_raw: u16::MAX,
                chan6_raw: u16::MAX,
                chan7_raw: u16::MAX,
                chan8_raw: u16::MAX,
                target_system: 1,
                target_component: 1,
                ..RC_CHANNELS_OVERRIDE_DATA::DEFAULT
            },
        ));
    }

    /// Asks for AUTO, then to be armed, where that is still to come.
    pub fn ask_to_take_off(&mut self) {
        if self.mode != AUTO {
            self.ask_for_mode(AUTO);
        } else if !self.armed {
            self.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 1.0, 0.0);
        }
    }

    /// Takes a message of the vehicle.
    pub fn take(&mut self, frame: &WireFrame) {
        match &frame.message {
            MavMessage::HEARTBEAT(data) if frame.header.component_id == 1 => {
                self.armed = data
                    .base_mode
                    .contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
                if self.mode != data.custom_mode {
                    self.mode = data.custom_mode;
                    self.modes.push(self.mode);
                }
            }
            MavMessage::GLOBAL_POSITION_INT(data) => {
                self.positions += 1;
                self.above_home_m = f64::from(data.relative_alt) * 1e-3;
                self.velocity_mps = Vec3::new(
                    f64::from(data.vy) * 0.01,
                    f64::from(data.vx) * 0.01,
                    -f64::from(data.vz) * 0.01,
                );
                self.place = Geodetic::new(
                    f64::from(data.lat) * 1e-7,
                    f64::from(data.lon) * 1e-7,
                    f64::from(data.alt) * 1e-3,
                );
            }
            MavMessage::GPS_RAW_INT(data)
                if data.fix_type as u32 >= GpsFixType::GPS_FIX_TYPE_3D_FIX as u32 =>
            {
                self.fix = Geodetic::new(
                    f64::from(data.lat) * 1e-7,
                    f64::from(data.lon) * 1e-7,
                    f64::from(data.alt) * 1e-3,
                );
            }
            MavMessage::MISSION_CURRENT(data) => self.item = data.seq,
            MavMessage::MISSION_REQUEST_INT(data) if data.target_system == 255 => {
                self.hand_over_item(data.mission_type, data.seq);
            }
            MavMessage::MISSION_REQUEST(data) if data.target_system == 255 => {
                self.hand_over_item(data.mission_type, data.seq);
            }
            MavMessage::MISSION_ACK(data) if data.target_system == 255 => self.uploaded = true,
            MavMessage::STATUSTEXT(data) => {
                let text = data.text.to_str().unwrap_or("?");
                eprintln!("  {text}");
                self.texts.push(text.to_owned());
            }
            _ => {}
        }
    }

    fn hand_over_item(&mut self, list: MavMissionType, number: u16) {
        let items = match list {
            MavMissionType::MAV_MISSION_TYPE_FENCE => &self.fence,
            _ => &self.mission,
        };
        if let Some(item) = items.get(usize::from(number)).cloned() {
            self.send(&MavMessage::MISSION_ITEM_INT(item));
        }
    }

    /// Uploads a mission: home, a take-off to the north, and waypoints this far east and north of
    /// home, metres.
    pub fn upload(&mut self, home: Geodetic, waypoints_m: &[(f64, f64)]) {
        let frame = LocalFrame::new(home, Earth::Wgs84);
        let way = MavCmd::MAV_CMD_NAV_WAYPOINT;
        let mut items = vec![
            (way, (0.0, 0.0)),
            (MavCmd::MAV_CMD_NAV_TAKEOFF, (0.0, 300.0)),
        ];
        items.extend(waypoints_m.iter().map(|at_m| (way, *at_m)));
        self.mission = (0..)
            .zip(items)
            .map(|(seq, (command, (east_m, north_m)))| {
                let place = frame.to_geodetic(Vec3::new(east_m, north_m, 0.0));
                let takes_off = command == MavCmd::MAV_CMD_NAV_TAKEOFF;
                MISSION_ITEM_INT_DATA {
                    seq,
                    command,
                    frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
                    x: (place.latitude_deg * 1e7) as i32,
                    y: (place.longitude_deg * 1e7) as i32,
                    z: ALTITUDE_M as f32,
                    param1: if takes_off { 15.0 } else { 0.0 },
                    target_system: 1,
                    target_component: 1,
                    autocontinue: 1,
                    ..MISSION_ITEM_INT_DATA::DEFAULT
                }
            })
            .collect();
        self.announce(self.mission.len(), MavMissionType::MAV_MISSION_TYPE_MISSION);
    }

    /// Uploads a fence: an inclusion polygon with corners this far east and north of home,
    /// metres.
    pub fn upload_fence(&mut self, home: Geodetic, corners_m: &[(f64, f64)]) {
        let frame = LocalFrame::new(home, Earth::Wgs84);
        self.fence = (0..)
            .zip(corners_m)
            .map(|(seq, (east_m, north_m))| {
                let place = frame.to_geodetic(Vec3::new(*east_m, *north_m, 0.0));
                MISSION_ITEM_INT_DATA {
                    seq,
                    command: MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION,
                    frame: MavFrame::MAV_FRAME_GLOBAL,
                    x: (place.latitude_deg * 1e7) as i32,
                    y: (place.longitude_deg * 1e7) as i32,
                    param1: corners_m.len() as f32,
                    target_system: 1,
                    target_component: 1,
                    mission_type: MavMissionType::MAV_MISSION_TYPE_FENCE,
                    ..MISSION_ITEM_INT_DATA::DEFAULT
                }
            })
            .collect();
        self.announce(self.fence.len(), MavMissionType::MAV_MISSION_TYPE_FENCE);
    }

    fn announce(&mut self, count: usize, mission_type: MavMissionType) {
        self.uploaded = false;
        self.send(&MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
            count: u16::try_from(count).expect("a short list"),
            target_system: 1,
            target_component: 1,
            mission_type,
            ..MISSION_COUNT_DATA::DEFAULT
        }));
    }

    /// The state of the flight, for a time-out.
    pub fn told(&self, home: Option<Geodetic>) -> String {
        let off_leg = home
            .filter(|_| self.place.is_some())
            .map(|home| self.off_leg(home));
        format!(
            "mode {}, armed {}, item {}, {:.1} m above home, off the leg by {off_leg:?}",
            self.mode, self.armed, self.item, self.above_home_m
        )
    }

    /// Course over the ground, radians clockwise from north.
    pub fn track_rad(&self) -> f64 {
        self.velocity_mps.x.atan2(self.velocity_mps.y)
    }

    /// Distance from a line north through home, metres, and angle to it, radians.
    pub fn off_leg(&self, home: Geodetic) -> (f64, f64) {
        self.off_line(home, (0.0, 0.0), 0.0)
    }

    /// Distance from a line through a point so far east and north of home, metres, and angle to it,
    /// radians. The course is clockwise from north.
    pub fn off_line(
        &self,
        home: Geodetic,
        (east_m, north_m): (f64, f64),
        course_rad: f64,
    ) -> (f64, f64) {
        let frame = LocalFrame::new(home, Earth::Wgs84);
        let at_m = frame.to_local_m(self.place.expect("a position"));
        let (sin, cos) = course_rad.sin_cos();
        let across_m = (at_m.x - east_m) * cos - (at_m.y - north_m) * sin;
        let (turned_sin, turned_cos) = (self.track_rad() - course_rad).sin_cos();
        (across_m.abs(), turned_sin.atan2(turned_cos).abs())
    }

    /// Distance to a place, metres.
    pub fn away_m(&self, place: Geodetic) -> Option<f64> {
        let frame = LocalFrame::new(self.place?, Earth::Wgs84);
        Some(frame.to_local_m(place).length())
    }
}
