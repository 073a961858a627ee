//! Inputs that `fga fly` must survive: absurd reports, hostile messages and a boot time that overflows, each
//! while it avoids a head-on intruder.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "random numbers are cut to size"
)]

use crate::common::{GOOD, Intruder, Random, World};
use fga_emulator::{EmulatorSettings, PlaneMode};
use fga_link::authority::Authority;
use fga_link::wire::Framer;
use mavlink::dialects::ardupilotmega::{
    ADSB_VEHICLE_DATA, ATTITUDE_DATA, AdsbFlags, GLOBAL_POSITION_INT_DATA, MavMessage,
    SCALED_PRESSURE_DATA, VFR_HUD_DATA, WIND_DATA,
};
use mavlink::{Message as _, calculate_crc};

/// A head-on intruder that meets the aircraft after half a minute.
fn head_on(settings: EmulatorSettings) -> World {
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
    let modes: Vec<PlaneMode> = changes.map(|change| change.mode).collect();
    assert_eq!(modes, [PlaneMode::Guided, PlaneMode::Auto]);
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
    survives(head_on(EmulatorSettings::default()), |world| {
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
    survives(head_on(EmulatorSettings::default()), |world| {
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
    let settings = EmulatorSettings {
        boot_s: 4_294_967.296 - 26.0,
        ..EmulatorSettings::default()
    };
    let mut in_command = false;
    survives(head_on(settings), |world| {
        if (26.0..26.1).contains(&world.time_s) {
            in_command |= matches!(world.companion.authority(), Authority::InCommand { .. });
        }
    });
    assert!(in_command, "it was to run over in command");
}

/// The vehicle's present position message, one millisecond after the last.
fn position(world: &World) -> GLOBAL_POSITION_INT_DATA {
    let plant = world.emulator.plant();
    let place = world.emulator.home().to_place(plant.position_m());
    let [east, north, up] = plant.velocity_mps();
    GLOBAL_POSITION_INT_DATA {
        time_boot_ms: boot_ms(world),
        lat: place.latitude_e7,
        lon: place.longitude_e7,
        alt: place.altitude_mm,
        relative_alt: (plant.position_m()[2] * 1e3) as i32,
        vx: (north * 100.0) as i16,
        vy: (east * 100.0) as i16,
        vz: (-up * 100.0) as i16,
        hdg: u16::MAX,
    }
}

fn attitude(world: &World) -> ATTITUDE_DATA {
    let plant = world.emulator.plant();
    ATTITUDE_DATA {
        time_boot_ms: boot_ms(world),
        roll: plant.bank_rad() as f32,
        pitch: plant.pitch_rad() as f32,
        yaw: plant.heading_rad() as f32,
        ..ATTITUDE_DATA::DEFAULT
    }
}

fn boot_ms(world: &World) -> u32 {
    ((world.emulator.time_s() * 1e3) as i32).cast_unsigned() + 1
}

type Impossible = (&'static str, fn(&World) -> MavMessage);

/// What a sensor, an estimator or a damaged message may say: a single value, twice a second, among true ones.
const IMPOSSIBLE: [Impossible; 17] = [
    ("velocity north", |w| {
        MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
            vx: i16::MAX,
            ..position(w)
        })
    }),
    ("velocity east", |w| {
        MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
            vy: -9000,
            ..position(w)
        })
    }),
    ("velocity up", |w| {
        MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
            vz: i16::MIN,
            ..position(w)
        })
    }),
    ("no velocity", |w| {
        MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
            vx: 0,
            vy: 0,
            ..position(w)
        })
    }),
    ("height above home", |w| {
        MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
            relative_alt: i32::MIN,
            ..position(w)
        })
    }),
    ("below home", |w| {
        MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
            relative_alt: -200_000,
            ..position(w)
        })
    }),
    ("altitude", |w| {
        MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
            alt: i32::MAX,
            ..position(w)
        })
    }),
    ("place", |w| {
        let here = position(w);
        MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
            lat: here.lat + 20_000,
            ..here
        })
    }),
    ("inverted", |w| {
        MavMessage::ATTITUDE(ATTITUDE_DATA {
            roll: 3.1,
            ..attitude(w)
        })
    }),
    ("roll", |w| {
        MavMessage::ATTITUDE(ATTITUDE_DATA {
            roll: -1.5,
            ..attitude(w)
        })
    }),
    ("rate of turn", |w| {
        MavMessage::ATTITUDE(ATTITUDE_DATA {
            yawspeed: 1e30,
            ..attitude(w)
        })
    }),
    ("no attitude", |w| {
        MavMessage::ATTITUDE(ATTITUDE_DATA {
            roll: f32::NAN,
            pitch: f32::NAN,
            yaw: f32::NAN,
            ..attitude(w)
        })
    }),
    ("airspeed", |_| {
        MavMessage::VFR_HUD(VFR_HUD_DATA {
            airspeed: 400.0,
            ..VFR_HUD_DATA::DEFAULT
        })
    }),
    ("no airspeed", |_| {
        MavMessage::VFR_HUD(VFR_HUD_DATA::DEFAULT)
    }),
    ("wind", |_| {
        MavMessage::WIND(WIND_DATA {
            direction: 90.0,
            speed: 99.0,
            speed_z: 0.0,
        })
    }),
    ("no pressure", |_| {
        MavMessage::SCALED_PRESSURE(SCALED_PRESSURE_DATA::DEFAULT)
    }),
    ("pressure", |_| {
        MavMessage::SCALED_PRESSURE(SCALED_PRESSURE_DATA {
            press_abs: f32::INFINITY,
            ..SCALED_PRESSURE_DATA::DEFAULT
        })
    }),
];

#[test]
fn impossible_telemetry_of_the_vehicle() {
    for (what, message) in IMPOSSIBLE {
        println!("{what}");
        let mut next_s = 5.0;
        survives(head_on(EmulatorSettings::default()), |world| {
            if world.time_s >= next_s {
                next_s += 0.5;
                world.say_as((1, 1), &message(world));
            }
        });
    }
}
