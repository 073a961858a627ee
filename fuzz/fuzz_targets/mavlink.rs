//! What comes over the link: any bytes through the framer, and any payload in whole frames through
//! the companion while time passes, from a vehicle that flies. Nothing grows without bound, and what
//! is sent can be sent.
//!
//! Input: one byte that chooses the configuration and whether the vehicle has been flying for a while
//! towards an intruder, so that a manoeuvre is under way; then records of a message number (an index), a
//! sender, a step of time, a length and that many bytes of payload.
#![no_main]

use fga_link::authority::Authority;
use fga_link::mavlink::{self, MavHeader, Message as _, calculate_crc};
use fga_link::traffic::table::MOST_TRACKS;
use fga_link::wire::{Framer, encode};
use fga_link::{Companion, Config};
use libfuzzer_sys::fuzz_target;
use mavlink::dialects::ardupilotmega::{
    ADSB_VEHICLE_DATA, ATTITUDE_DATA, AdsbFlags, GLOBAL_POSITION_INT_DATA, HEARTBEAT_DATA,
    MISSION_COUNT_DATA, MISSION_CURRENT_DATA, MISSION_ITEM_INT_DATA, MavAutopilot, MavCmd,
    MavFrame, MavMessage, MavMissionType, MavModeFlag, MavParamType, MavType, PARAM_VALUE_DATA,
    VFR_HUD_DATA,
};

/// Messages that the companion takes, and some that it does not.
const IDS: [u32; 26] = [
    0, 2, 4, 20, 21, 22, 23, 30, 33, 39, 42, 44, 45, 46, 47, 51, 62, 69, 73, 74, 75, 76, 77, 168,
    246, 253,
];
const CONFIGS: [&str; 4] = [
    "",
    "[vehicle]\nvertical = true\n[safety]\nceiling_m = 300.0\n",
    "[command]\nmode = \"heading\"\n",
    "[command]\nmode = \"paper\"\n[[obstacle]]\nlatitude_deg = 37.62\nlongitude_deg = -122.37\naltitude_m = 100.0\nradius_m = 150.0\n",
];

fn heartbeat(mode: u32) -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        custom_mode: mode,
        mavtype: MavType::MAV_TYPE_FIXED_WING,
        autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
        base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
        ..HEARTBEAT_DATA::DEFAULT
    })
}

const LATITUDE_E7: i32 = 376_189_000;
const LONGITUDE_E7: i32 = -1_223_750_000;
/// A ten millionth of a degree of latitude is a ninetieth of a metre.
const E7_PER_M: f64 = 89.8;

/// What the vehicle says in the first seconds of a flight north, as messages and their times: its
/// parameters, its mission, where it is, and that another aircraft comes towards it.
fn flight(mode: u32) -> Vec<(f64, MavMessage)> {
    let mut said = Vec::new();
    for (name, value) in [
        ("ROLL_LIMIT_DEG", 45.0),
        ("AIRSPEED_CRUISE", 25.0),
        ("AIRSPEED_MIN", 15.0),
        ("AIRSPEED_MAX", 35.0),
        ("PTCH_LIM_MAX_DEG", 20.0),
        ("PTCH_LIM_MIN_DEG", -25.0),
        ("TECS_CLMB_MAX", 5.0),
        ("TECS_SINK_MAX", 5.0),
        ("MAV_GCS_SYSID", 255.0),
    ] {
        said.push((
            0.1,
            MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
                param_value: value,
                param_count: 9,
                param_id: name.into(),
                param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
                ..PARAM_VALUE_DATA::DEFAULT
            }),
        ));
    }
    said.push((
        0.1,
        MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
            count: 4,
            target_system: 1,
            target_component: 196,
            ..MISSION_COUNT_DATA::DEFAULT
        }),
    ));
    for seq in 0..4_u16 {
        said.push((
            0.1,
            MavMessage::MISSION_ITEM_INT(MISSION_ITEM_INT_DATA {
                seq,
                command: MavCmd::MAV_CMD_NAV_WAYPOINT,
                frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
                x: LATITUDE_E7 + i32::from(seq) * 200_000 - 200_000,
                y: LONGITUDE_E7,
                z: 100.0,
                ..MISSION_ITEM_INT_DATA::DEFAULT
            }),
        ));
    }
    said.push((
        0.1,
        MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
            mission_type: MavMissionType::MAV_MISSION_TYPE_FENCE,
            ..MISSION_COUNT_DATA::DEFAULT
        }),
    ));
    for step in 0..60_u32 {
        let time_s = 0.1 + f64::from(step) * 0.05;
        let north_m = 25.0 * time_s;
        let time_boot_ms = 20_000 + step * 50;
        said.push((
            time_s,
            MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
                time_boot_ms,
                lat: LATITUDE_E7 + (north_m * E7_PER_M) as i32,
                lon: LONGITUDE_E7,
                alt: 104_000,
                relative_alt: 100_000,
                vx: 2500,
                ..GLOBAL_POSITION_INT_DATA::DEFAULT
            }),
        ));
        said.push((
            time_s,
            MavMessage::VFR_HUD(VFR_HUD_DATA {
                airspeed: 25.0,
                groundspeed: 25.0,
                ..VFR_HUD_DATA::DEFAULT
            }),
        ));
        if step % 10 == 0 {
            said.push((time_s, heartbeat(mode)));
            said.push((
                time_s,
                MavMessage::MISSION_CURRENT(MISSION_CURRENT_DATA {
                    seq: 2,
                    ..MISSION_CURRENT_DATA::DEFAULT
                }),
            ));
            let ahead_m = 400.0 - 25.0 * time_s;
            said.push((
                time_s,
                MavMessage::ADSB_VEHICLE(ADSB_VEHICLE_DATA {
                    ICAO_address: 0x00AB_CDEF,
                    lat: LATITUDE_E7 + (ahead_m * E7_PER_M) as i32,
                    lon: LONGITUDE_E7,
                    altitude: 104_000,
                    heading: 18_000,
                    hor_velocity: 2500,
                    flags: AdsbFlags::ADSB_FLAGS_VALID_COORDS
                        | AdsbFlags::ADSB_FLAGS_VALID_ALTITUDE
                        | AdsbFlags::ADSB_FLAGS_VALID_HEADING
                        | AdsbFlags::ADSB_FLAGS_VALID_VELOCITY,
                    ..ADSB_VEHICLE_DATA::DEFAULT
                }),
            ));
        }
        // Last: it prompts targets and decisions.
        said.push((
            time_s,
            MavMessage::ATTITUDE(ATTITUDE_DATA {
                time_boot_ms,
                ..ATTITUDE_DATA::DEFAULT
            }),
        ));
    }
    said
}

/// A frame with a right checksum around any payload.
fn frame(id: u32, sequence: u8, component: u8, payload: &[u8]) -> Vec<u8> {
    let [low, middle, high, _] = id.to_le_bytes();
    let length = payload.len().min(255);
    let mut bytes = vec![
        0xFD,
        length as u8,
        0,
        0,
        sequence,
        1,
        component,
        low,
        middle,
        high,
    ];
    bytes.extend(&payload[..length]);
    let crc = calculate_crc(&bytes[1..], MavMessage::extra_crc(id));
    bytes.extend(crc.to_le_bytes());
    bytes
}

fuzz_target!(|bytes: &[u8]| {
    let mut noise = Framer::new(None);
    noise.push(bytes, |_| {});
    let Some((choice, mut rest)) = bytes.split_first() else {
        return;
    };
    let config = CONFIGS[usize::from(*choice) % CONFIGS.len()];
    let config = Config::parse(config).expect("valid");
    let mode = if *choice & 4 == 0 { 10 } else { 7 };
    let mut companion = Companion::new(config, *choice & 8 != 0).expect("valid");
    let header = MavHeader {
        system_id: 1,
        component_id: 1,
        sequence: 0,
    };
    companion.receive(&header, &heartbeat(mode), 0.0);
    let mut framer = Framer::new(None);
    let (mut now_s, mut sequence) = (0.0, 1_u8);
    if *choice & 16 != 0 {
        for (time_s, message) in flight(mode) {
            now_s = time_s;
            let header = MavHeader { sequence, ..header };
            companion.receive(&header, &message, now_s);
            sequence = sequence.wrapping_add(1);
            if companion.owed().is_some() {
                // It was asked for GUIDED, and obeys.
                let header = MavHeader { sequence, ..header };
                companion.receive(&header, &heartbeat(15), now_s);
                sequence = sequence.wrapping_add(1);
            }
            companion.tick(now_s);
            companion.outbox();
            if matches!(companion.authority(), Authority::InCommand { .. }) {
                break;
            }
        }
        // In AUTO, by attitude targets, and not only to report: it has taken over.
        let acts = *choice & (1 | 2 | 4 | 8) == 0;
        assert!(
            !acts || matches!(companion.authority(), Authority::InCommand { .. }),
            "{}",
            companion.status_line(now_s)
        );
        companion.take_log();
    }
    while let [id, component, step, length, more @ ..] = rest {
        let length = usize::from(*length).min(more.len());
        let (payload, left) = more.split_at(length);
        rest = left;
        now_s += f64::from(*step) * 0.01;
        let component = if *component & 3 == 3 { 196 } else { 1 };
        let id = IDS[usize::from(*id) % IDS.len()];
        framer.push(&frame(id, sequence, component, payload), |frame| {
            companion.receive(&frame.header, &frame.message, now_s);
        });
        sequence = sequence.wrapping_add(1);
        companion.tick(now_s);
        let sent = companion.outbox();
        assert!(sent.len() <= 256);
        for outgoing in sent {
            encode(header, &outgoing.message, None);
        }
        assert!(companion.take_log().len() <= 4096);
        assert!(companion.tracks().tracks().len() <= MOST_TRACKS);
    }
});
