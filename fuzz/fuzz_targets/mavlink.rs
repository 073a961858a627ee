//! What comes over the link: any bytes through the framer, and any payload in whole frames through
//! the companion while time passes, from a vehicle that flies. Nothing grows without bound, and what
//! is sent can be sent.
//!
//! Input: one byte that chooses the configuration, then records of a message number (an index), a
//! sender, a step of time, a length and that many bytes of payload.
#![no_main]

use fga_link::mavlink::{self, MavHeader, Message as _, calculate_crc};
use fga_link::traffic::table::MOST_TRACKS;
use fga_link::wire::{Framer, encode};
use fga_link::{Companion, Config};
use libfuzzer_sys::fuzz_target;
use mavlink::dialects::ardupilotmega::{
    HEARTBEAT_DATA, MavAutopilot, MavMessage, MavModeFlag, MavType,
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

/// A frame with a right checksum around any payload.
fn frame(id: u32, sequence: u8, component: u8, payload: &[u8]) -> Vec<u8> {
    let [low, middle, high, _] = id.to_le_bytes();
    let length = payload.len().min(255);
    let mut bytes = vec![
        0xFD, length as u8, 0, 0, sequence, 1, component, low, middle, high,
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
