//! Each field of a report wrong by sign, angle, unit or datum: the manoeuvre begins about as early as with true
//! reports, and the operator reads once what cannot be used.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    unreachable_pub,
    reason = "a bench; casts of floats saturate, as the wrong senders do"
)]

use crate::common::{GOOD, Intruder, Random, World, distance};
use fga_emulator::{EmulatorSettings, PlaneMode};
use fga_link::traffic::Defect;
use mavlink::dialects::ardupilotmega::{
    ADSB_VEHICLE_DATA, AdsbAltitudeType, AdsbFlags, MavMessage,
};

/// Protected by default, metres.
pub const PROTECTED_M: f64 = 60.0;
const RECEIVER: (u8, u8) = (200, 156);
const INTRUDER: u32 = 0x00AB_CDEF;
/// The manoeuvre begins with at least this share of the time that true reports leave.
pub const LEAD_SHARE: f64 = 0.8;

pub type Wrong = fn(&mut ADSB_VEHICLE_DATA);

/// The true report, and each way to be wrong.
pub const MOTIONS: [(&str, Wrong); 16] = [
    ("heading + 180 deg", |d| {
        d.heading = turned(d.heading, 18_000);
    }),
    ("heading + 90 deg", |d| d.heading = turned(d.heading, 9_000)),
    ("heading - 90 deg", |d| {
        d.heading = turned(d.heading, 27_000);
    }),
    ("heading mirrored", |d| {
        d.heading = turned(0, 36_000 - d.heading % 36_000);
    }),
    ("heading in degrees", |d| d.heading /= 100),
    ("heading 0", |d| d.heading = 0),
    ("speed in metres per second", |d| d.hor_velocity /= 100),
    ("speed in millimetres per second", |d| {
        d.hor_velocity = d.hor_velocity.saturating_mul(10);
    }),
    ("speed times 100", |d| {
        d.hor_velocity = d.hor_velocity.saturating_mul(100);
    }),
    ("speed in knots", |d| {
        d.hor_velocity = scaled(d.hor_velocity, 1.944);
    }),
    ("speed in kilometres per hour", |d| {
        d.hor_velocity = scaled(d.hor_velocity, 3.6);
    }),
    ("speed 0", |d| d.hor_velocity = 0),
    ("climb of 64 m/s", |d| d.ver_velocity = 6400),
    ("climb of 327 m/s", |d| d.ver_velocity = i16::MAX),
    ("sinks by 327 m/s", |d| d.ver_velocity = i16::MIN),
    ("no velocity", |d| {
        d.flags
            .remove(AdsbFlags::ADSB_FLAGS_VALID_VELOCITY | AdsbFlags::ADSB_FLAGS_VALID_HEADING);
    }),
];

pub const HEIGHTS: [(&str, Wrong); 10] = [
    ("190 m above", |d| d.altitude += 190_000),
    ("190 m below", |d| d.altitude -= 190_000),
    ("in feet", |d| {
        d.altitude = (f64::from(d.altitude) * 3.280_84) as i32;
    }),
    ("times 1000", |d| {
        d.altitude = d.altitude.saturating_mul(1000);
    }),
    ("lowest", |d| d.altitude = i32::MIN),
    ("100 m below", |d| d.altitude -= 100_000),
    ("80 m above", |d| d.altitude += 80_000),
    ("no altitude", |d| {
        d.flags.remove(AdsbFlags::ADSB_FLAGS_VALID_ALTITUDE);
    }),
    ("no altitude, and 0", |d| {
        d.altitude = 0;
        d.flags.remove(AdsbFlags::ADSB_FLAGS_VALID_ALTITUDE);
    }),
    ("pressure as geometric", |d| {
        d.altitude_type = AdsbAltitudeType::ADSB_ALTITUDE_TYPE_GEOMETRIC;
    }),
];

fn turned(heading: u16, by: u16) -> u16 {
    ((u32::from(heading) + u32::from(by)) % 36_000) as u16
}

fn scaled(value: u16, by: f64) -> u16 {
    (f64::from(value) * by) as u16
}

/// When a manoeuvre begins, when the intruder would have been within the volume of an aircraft that flies straight on, and
/// the flown world.
pub struct Flown {
    pub begins_s: Option<f64>,
    pub contact_s: f64,
    pub world: World,
}

pub fn flown(
    intruder: Intruder,
    interval_s: f64,
    sea_level_hpa: f64,
    pressure: bool,
    wrong: Wrong,
) -> Flown {
    let settings = EmulatorSettings {
        sea_level_hpa: Some(sea_level_hpa),
        ..EmulatorSettings::default()
    };
    let mut world = World::with(settings, "", GOOD, 3);
    world.sea_level_hpa = pressure.then_some(sea_level_hpa);
    let (mut due_s, mut begins_s, mut contact_s) = (0.0, None, f64::INFINITY);
    let mut silent = intruder;
    silent.shown_m = 0.0;
    world.add(silent);
    // The bench itself reports nothing of it.
    while world.time_s < 90.0 {
        let other_m = world.intruders[0].position_m;
        let straight_m = [0.0, 25.0 * world.time_s, 100.0];
        if distance(straight_m, other_m) < PROTECTED_M {
            contact_s = contact_s.min(world.time_s);
        }
        let own_m = world.emulator.plant().position_m();
        if world.time_s >= due_s && distance(own_m, other_m) < 1200.0 {
            due_s = world.time_s + interval_s;
            if let MavMessage::ADSB_VEHICLE(mut data) = world.report(0) {
                wrong(&mut data);
                world.say_as(RECEIVER, &MavMessage::ADSB_VEHICLE(data));
            }
        }
        world.step();
        if begins_s.is_none() && world.mode() == PlaneMode::Guided {
            begins_s = Some(world.time_s);
        }
    }
    Flown {
        begins_s,
        contact_s,
        world,
    }
}

pub fn lead_s(flown: &Flown) -> f64 {
    flown.begins_s.map_or(0.0, |s| flown.contact_s - s)
}

/// Seeded aircraft that meet ours from every side between 40 and 60 s, some of them climbing.
fn drawn(count: u32) -> Vec<Intruder> {
    let mut random = Random::new(35);
    (0..count)
        .map(|number| {
            let meets_s = random.uniform(45.0, 60.0);
            let course_rad = random.uniform(-2.6, 2.6);
            let speed_mps = random.uniform(20.0, 70.0);
            let climb_mps = if number % 2 == 0 {
                0.0
            } else {
                random.uniform(-3.0, 3.0)
            };
            let velocity_mps = [
                speed_mps * course_rad.sin(),
                -speed_mps * course_rad.cos(),
                climb_mps,
            ];
            let meeting_m = [random.uniform(-15.0, 15.0), 25.0 * meets_s, 100.0];
            let from_m = [0, 1, 2].map(|n| meeting_m[n] - meets_s * velocity_mps[n]);
            Intruder::straight(INTRUDER, from_m, velocity_mps)
        })
        .collect()
}

fn head_on() -> Intruder {
    Intruder::straight(INTRUDER, [5.0, 3000.0, 100.0], [0.0, -25.0, 0.0])
}

fn assert_as_early(name: &str, control: &Flown, flown: &Flown) {
    let (control_s, lead_s) = (lead_s(control), lead_s(flown));
    let (least_m, at_s) = flown.world.least_m[0];
    eprintln!("{name}: {lead_s:.1} s of {control_s:.1} s, least {least_m:.1} m");
    assert!(
        lead_s >= LEAD_SHARE * control_s,
        "{name}: begins {lead_s:.1} s before contact, {control_s:.1} s with true reports"
    );
    let kept = least_m >= PROTECTED_M || control.world.least_m[0].0 < PROTECTED_M;
    assert!(kept, "{name}: {least_m} m at {at_s} s");
    let tracks = flown.world.companion.tracks().tracks().len();
    assert!(tracks <= 1, "{name}: {tracks} tracks of one aircraft");
}

#[test]
fn t2_a_velocity_wrong_in_any_way_is_avoided_as_early_and_is_one_track() {
    for interval_s in [0.5, 1.0, 5.0] {
        let control = flown(head_on(), interval_s, 1013.25, false, |_| {});
        for (name, wrong) in MOTIONS {
            let flown = flown(head_on(), interval_s, 1013.25, false, wrong);
            assert_as_early(name, &control, &flown);
            let texts = flown.world.emulator.texts();
            assert!(
                !texts.iter().any(|text| text.contains("overload")),
                "{name}"
            );
        }
    }
}

#[test]
fn t2_a_wrong_velocity_from_every_side() {
    for (number, intruder) in drawn(8).into_iter().enumerate() {
        let control = flown(intruder, 1.0, 1013.25, false, |_| {});
        for (name, wrong) in MOTIONS.into_iter().skip(number % 2).step_by(2) {
            let flown = flown(intruder, 1.0, 1013.25, false, wrong);
            assert_as_early(&format!("{number}: {name}"), &control, &flown);
        }
    }
}

#[test]
fn t3_a_wrong_height_or_label_is_avoided_as_early() {
    for sea_level_hpa in [990.0, 1013.25, 1035.0] {
        for (name, wrong) in HEIGHTS {
            let as_pressure = name.starts_with("pressure");
            let control = flown(head_on(), 1.0, sea_level_hpa, as_pressure, |_| {});
            let flown = flown(head_on(), 1.0, sea_level_hpa, as_pressure, wrong);
            assert_as_early(&format!("{sea_level_hpa} hPa, {name}"), &control, &flown);
        }
    }
}

#[test]
fn t4_traffic_that_cannot_be_used_is_told_once_and_counted() {
    let cases: [(&str, Wrong, Defect); 4] = [
        (
            "without position",
            |d| d.flags = AdsbFlags::empty(),
            Defect::NoPosition,
        ),
        ("old reports", |d| d.tslc = 30, Defect::Old),
        ("old reports", |d| d.tslc = 255, Defect::Old),
        (
            "without altitude",
            |d| d.flags.remove(AdsbFlags::ADSB_FLAGS_VALID_ALTITUDE),
            Defect::NoAltitude,
        ),
    ];
    for (text, wrong, defect) in cases {
        let flown = flown(head_on(), 1.0, 1013.25, false, wrong);
        let told: Vec<_> = flown.world.emulator.texts().iter().collect();
        let times = told.iter().filter(|words| words.contains(text)).count();
        assert_eq!(times, 1, "{text}: {told:?}");
        let defects = flown.world.companion.defects();
        assert_eq!(defects.aircraft(defect), 1, "{text}");
        assert!(defects.reports(defect) > 5, "{text}");
        assert_eq!(flown.begins_s.is_some(), defect.is_bounded(), "{text}");
    }
}

/// The altitude is lost in the last seconds: the last one holds for a while, and after that any.
#[test]
fn t4_a_lost_altitude_is_bounded_by_the_last_one() {
    for above_m in [0.0, 600.0] {
        let intruder =
            Intruder::straight(INTRUDER, [5.0, 3000.0, 100.0 + above_m], [0.0, -25.0, 0.0]);
        let mut world = World::new("", GOOD, 3);
        let mut silent = intruder;
        silent.shown_m = 0.0;
        world.add(silent);
        let mut due_s = 40.0;
        while world.time_s < 60.0 {
            if world.time_s >= due_s {
                due_s += 1.0;
                if let MavMessage::ADSB_VEHICLE(mut data) = world.report(0) {
                    if world.time_s > 48.0 {
                        data.altitude = 0;
                        data.flags.remove(AdsbFlags::ADSB_FLAGS_VALID_ALTITUDE);
                    }
                    world.say_as(RECEIVER, &MavMessage::ADSB_VEHICLE(data));
                }
            }
            world.step();
        }
        let avoided = world.companion.counts().maneuvers > 0;
        assert_eq!(avoided, above_m == 0.0, "{above_m} m above");
    }
}
