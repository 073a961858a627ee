//! Inputs that `fga fly` must survive: absurd reports, hostile messages and a boot time that overflows, each
//! while it avoids a head-on intruder.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "random numbers are cut to size"
)]

mod common;

use common::{GOOD, Intruder, Random, World};
use fga_emulator::{Mode, Settings};
use fga_link::authority::Authority;
use fga_link::wire::Framer;
use mavlink::dialects::ardupilotmega::{ADSB_VEHICLE_DATA, AdsbFlags, MavMessage};
use mavlink::{Message as _, calculate_crc};

/// A head-on intruder that meets the aircraft after half a minute.
fn head_on(settings: Settings) -> World {
    let mut world = World::with(settings, "", GOOD, 3);
    let mut intruder = Intruder::straight(0x00AB_CDEF, [5.0, 1500.0, 100.0], [0.0, -25.0, 0.0]);
    intruder.shown_m = 1200.0;
    world.add(intruder);
    world
}

/// Flies past the intruder, with a message in each step: the aircraft keeps clear, with one change of the mode
/// out and one back.
fn survives(mut world: World, mut say: impl FnMut(&mut World)) {
    while world.time_s < 75.0 {
        say(&mut world);
        world.step();
    }
    assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
    let changes = world.emulator.mode_changes().iter();
    let modes: Vec<Mode> = changes.map(|change| change.mode).collect();
    assert_eq!(modes, [Mode::Guided, Mode::Auto]);
    assert_eq!(world.companion.authority(), Authority::Ready);
}

/// Numbers, often extreme.
fn absurd(random: &mut Random) -> u32 {
    match random.next() % 6 {
        0 => 0,
        1 => u32::MAX,
        2 => i32::MAX as u32,
        3 => i32::MIN.cast_unsigned(),
        4 => 1,
        _ => random.next() as u32,
    }
}

#[test]
fn absurd_adsb_vehicle_messages() {
    let mut random = Random::new(484);
    let mut said = 0;
    survives(head_on(Settings::default()), |world| {
        if said >= 484 || world.time_s < 5.0 {
            return;
        }
        said += 1;
        let data = ADSB_VEHICLE_DATA {
            ICAO_address: absurd(&mut random),
            lat: absurd(&mut random) as i32,
            lon: absurd(&mut random) as i32,
            altitude: absurd(&mut random) as i32,
            heading: absurd(&mut random) as u16,
            hor_velocity: absurd(&mut random) as u16,
            ver_velocity: absurd(&mut random) as i16,
            squawk: absurd(&mut random) as u16,
            tslc: absurd(&mut random) as u8,
            flags: AdsbFlags::from_bits_truncate(absurd(&mut random) as u16),
            ..ADSB_VEHICLE_DATA::DEFAULT
        };
        world.say_as((200, 156), &MavMessage::ADSB_VEHICLE(data));
    });
    assert_eq!(said, 484);
}

/// Messages of every kind that the companion reads, with random payloads under right checksums, from other
/// systems than the vehicle's: 250 per second.
#[test]
fn hostile_messages_at_250_a_second() {
    const IDS: [u32; 28] = [
        0, 2, 4, 20, 21, 22, 23, 24, 29, 30, 33, 42, 44, 46, 47, 51, 62, 69, 73, 74, 75, 76, 77,
        111, 168, 253, 12_900, 12_915,
    ];
    let mut random = Random::new(250);
    let mut framer = Framer::new(None);
    survives(head_on(Settings::default()), |world| {
        for _ in 0..5 {
            let id = IDS[(random.next() % IDS.len() as u64) as usize];
            let length = (random.next() % 256) as u8;
            let [low, middle, high, _] = id.to_le_bytes();
            let system = 2 + (random.next() % 250) as u8;
            let mut bytes = vec![0xFD, length, 0, 0, 0, system, 1, low, middle, high];
            bytes.extend((0..length).map(|_| absurd(&mut random) as u8));
            let crc = calculate_crc(&bytes[1..], MavMessage::extra_crc(id));
            bytes.extend(crc.to_le_bytes());
            let mut frames = Vec::new();
            framer.push(&bytes, |frame| frames.push(frame));
            for frame in frames {
                let ids = (system, frame.header.component_id);
                world.say_as(ids, &frame.message);
            }
        }
    });
}

/// The count of milliseconds since boot overflows after 49.7 days, here in the middle of the manoeuvre.
#[test]
fn boot_time_wrap_in_a_manoeuvre() {
    let settings = Settings {
        boot_s: 4_294_967.296 - 26.0,
        ..Settings::default()
    };
    let mut in_command = false;
    survives(head_on(settings), |world| {
        if (26.0..26.1).contains(&world.time_s) {
            in_command |= matches!(world.companion.authority(), Authority::InCommand { .. });
        }
    });
    assert!(in_command, "it was to run over in command");
}
