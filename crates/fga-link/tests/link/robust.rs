//! Rubbish from the network: random bytes, random payloads under right checksums, random
//! configurations. Nothing may panic or grow without bound.
//!
//! A fixed number of rounds by default; `FGA_FUZZ_SECONDS` runs each target for that time instead.
#![allow(
    clippy::cast_possible_truncation,
    reason = "random numbers are cut to size"
)]

use std::time::Instant;

use crate::common::Random;
use fga_link::player::read_log;
use fga_link::tlog::TlogReader;
use fga_link::traffic::ReportSource;
use fga_link::traffic::receiver::Joiner;
use fga_link::wire::Framer;
use fga_link::{Companion, Config};
use mavlink::dialects::ardupilotmega::MavMessage;
use mavlink::{Message as _, calculate_crc};

/// Runs a target `rounds` times, or for `FGA_FUZZ_SECONDS`.
fn fuzz(rounds: u64, mut target: impl FnMut(&mut Random)) {
    let seconds = std::env::var("FGA_FUZZ_SECONDS")
        .ok()
        .and_then(|text| text.parse::<u64>().ok());
    let start = Instant::now();
    let mut round = 0;
    loop {
        match seconds {
            Some(seconds) if start.elapsed().as_secs() >= seconds => break,
            None if round >= rounds => break,
            _ => {}
        }
        target(&mut Random::new(round));
        round += 1;
    }
    eprintln!("{round} rounds");
}

/// Bytes that are often extremes.
fn byte(random: &mut Random) -> u8 {
    match random.next() % 4 {
        0 => 0,
        1 => 0xFF,
        2 => 0x7F,
        _ => (random.next() & 0xFF) as u8,
    }
}

/// A MAVLink 2 frame with a random payload and a right checksum.
fn frame(random: &mut Random, message_id: u32, system: u8, component: u8) -> Vec<u8> {
    let length = (random.next() % 256) as u8;
    let [low, middle, high, _] = message_id.to_le_bytes();
    let mut bytes = vec![
        0xFD,
        length,
        0,
        0,
        byte(random),
        system,
        component,
        low,
        middle,
        high,
    ];
    bytes.extend((0..length).map(|_| byte(random)));
    let crc = calculate_crc(&bytes[1..], MavMessage::extra_crc(message_id));
    bytes.extend(crc.to_le_bytes());
    bytes
}

const IDS: [u32; 30] = [
    0, 2, 4, 20, 21, 22, 23, 30, 33, 42, 44, 46, 47, 51, 62, 69, 73, 74, 75, 76, 77, 168, 246, 253,
    24, 29, 11_037, 12_900, 12_901, 12_915,
];

#[test]
fn random_payloads_do_not_harm_the_companion() {
    fuzz(60, |random| {
        let config = "[vehicle]\nvertical = true\n";
        let mut companion =
            Companion::new(Config::parse(config).expect("valid"), false).expect("new");
        let mut framer = Framer::new(None);
        let mut now_s = 0.0;
        // A heartbeat of a plane, so that telemetry is listened to.
        let heartbeat = MavMessage::HEARTBEAT(mavlink::dialects::ardupilotmega::HEARTBEAT_DATA {
            custom_mode: 10,
            mavtype: mavlink::dialects::ardupilotmega::MavType::MAV_TYPE_FIXED_WING,
            autopilot: mavlink::dialects::ardupilotmega::MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
            base_mode: mavlink::dialects::ardupilotmega::MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
            ..mavlink::dialects::ardupilotmega::HEARTBEAT_DATA::DEFAULT
        });
        let header = mavlink::MavHeader {
            system_id: 1,
            component_id: 1,
            sequence: 0,
        };
        companion.receive(&header, &heartbeat, now_s);
        for _ in 0..400 {
            now_s += random.uniform(0.0, 0.2);
            let id = IDS[(random.next() % IDS.len() as u64) as usize];
            let component = if random.next() % 3 == 0 { 196 } else { 1 };
            let bytes = frame(random, id, 1, component);
            framer.push(&bytes, |frame| {
                companion.receive(&frame.header, &frame.message, now_s);
            });
            companion.tick(now_s);
            assert!(companion.outbox().len() <= 256);
            assert!(companion.take_log().len() <= 4096);
            assert!(companion.tracks().tracks().len() <= 512);
        }
    });
}

#[test]
fn random_bytes_do_not_harm_the_framer() {
    fuzz(300, |random| {
        let mut framer = Framer::new(None);
        for _ in 0..20 {
            let mut bytes: Vec<u8> = (0..random.next() % 600).map(|_| byte(random)).collect();
            if random.next() % 2 == 0 {
                let id = (random.next() % 400) as u32;
                bytes.extend(frame(random, id, 1, 1));
            }
            framer.push(&bytes, |_| {});
        }
        let log: Vec<u8> = (0..2000).map(|_| byte(random)).collect();
        let mut reader = TlogReader::new(log.as_slice());
        while let Ok(Some(_)) = reader.next_frame() {}
    });
}

#[test]
fn random_text_does_not_harm_configuration_and_scripts() {
    let good = include_str!("../../../../docs/how-to-arduplane.md");
    fuzz(300, |random| {
        let from = (random.next() as usize) % good.len();
        let text: String = good.chars().skip(from).take(400).collect();
        let mut bytes = text.into_bytes();
        for _ in 0..random.next() % 20 {
            let at = (random.next() as usize) % bytes.len().max(1);
            if let Some(slot) = bytes.get_mut(at) {
                *slot = byte(random);
            }
        }
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let _ = Config::parse(&text);
        let (lines, tally) = read_log(text.as_bytes());
        assert!(lines.len() as u64 <= tally.read());
        let _ = text.parse::<fga_link::player::PlayerLine>();
        let _ = text.parse::<fga_link::endpoint::Endpoint>();
        let mut joiner = Joiner::new(ReportSource::Sbs);
        for line in text.lines() {
            if let Ok(message) = fga_formats::traffic::sbs::parse_line(line.as_bytes()) {
                joiner.take(&message, random.uniform(0.0, 1e6));
            }
        }
    });
}
