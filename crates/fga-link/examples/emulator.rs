//! The ArduPlane-like emulator behind a socket, in real time:
//! `cargo run -p fga-link --example emulator -- tcpin:127.0.0.1:5760`.
//!
//! It flies a square mission of 3 km legs from its start, in AUTO, at 25 m/s. With a second argument
//! it ends after that many seconds.

use core::time::Duration;
use std::sync::mpsc::sync_channel;
use std::time::Instant;

use fga_emulator::{Emulator, EmulatorSettings, MissionItem};
use fga_link::endpoint::{LinkRead, open};
use fga_link::wire::{Framer, encode};
use mavlink::MavHeader;

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let endpoint = arguments
        .next()
        .unwrap_or_else(|| "tcpin:127.0.0.1:5760".to_owned());
    let longest_s: f64 = arguments
        .next()
        .map_or(Ok(f64::INFINITY), |text| text.parse())?;
    let (mut reader, writer) = open(&endpoint.parse()?)?;
    let mut emulator = Emulator::new(EmulatorSettings::default());
    let home = *emulator.home();
    let corners = [
        [0.0, 0.0, 4.0],
        [0.0, 0.0, 100.0],
        [0.0, 3000.0, 100.0],
        [3000.0, 3000.0, 100.0],
        [3000.0, 0.0, 100.0],
        [0.0, 0.0, 100.0],
    ];
    emulator.set_mission(
        corners
            .map(|corner| MissionItem::waypoint(&home, corner))
            .to_vec(),
        2,
    );
    let (to, from) = sync_channel(1024);
    std::thread::spawn(move || {
        let mut framer = Framer::new(None);
        let mut buffer = [0; 4096];
        loop {
            match reader.read(&mut buffer) {
                LinkRead::Bytes(count) => framer.push(&buffer[..count], |frame| {
                    let _ = to.try_send(frame);
                }),
                LinkRead::NewConnection => framer.reset(),
                LinkRead::Nothing => {}
            }
        }
    });
    let start = Instant::now();
    let (mut flown_s, mut sequence, mut changes) = (0.0, 0_u8, 0);
    while flown_s < longest_s {
        while let Ok(frame) = from.try_recv() {
            emulator.receive(&frame.header, &frame.message);
        }
        let now_s = start.elapsed().as_secs_f64();
        emulator.advance(now_s - flown_s);
        flown_s = now_s;
        for message in emulator.drain() {
            let header = MavHeader {
                system_id: u32::from(emulator.system_id()),
                component_id: 1,
                sequence,
            };
            sequence = sequence.wrapping_add(1);
            writer.write(encode(header, &message, None).raw_bytes());
        }
        for change in &emulator.mode_changes()[changes..] {
            eprintln!(
                "{:8.2} s  {:?}, asked by component {}",
                now_s, change.mode, change.component_id
            );
        }
        changes = emulator.mode_changes().len();
        std::thread::sleep(Duration::from_millis(5));
    }
    Ok(())
}
