//! Traffic that deceives or overwhelms: the companion still avoids the threatening aircraft.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a bench with small numbers"
)]

use alloc::collections::VecDeque;

use crate::common::{GOOD, Intruder, Random, World};
use fga_emulator::PlaneMode;
use fga_formats::traffic::{Altitude, TrafficReport};
use fga_link::traffic::ReportSource;
use fga_link::traffic::receiver::Joiner;
use mavlink::dialects::ardupilotmega::{
    ADSB_VEHICLE_DATA, MavFrame, MavMessage, MavOdidHorAcc, MavOdidSpeedAcc, MavOdidVerAcc,
    OBSTACLE_DISTANCE_3D_DATA, OPEN_DRONE_ID_LOCATION_DATA,
};

/// Protected by default, metres.
const PROTECTED_M: f64 = 60.0;
const INTRUDER: u32 = 0x00AB_CDEF;
/// The receiver that reports the true intruder.
const RECEIVER: (u8, u8) = (200, 156);

/// A head-on intruder that meets the aircraft after a minute.
fn head_on() -> World {
    let mut world = World::new("", GOOD, 3);
    let mut intruder = Intruder::straight(INTRUDER, [5.0, 3000.0, 100.0], [0.0, -25.0, 0.0]);
    intruder.shown_m = 1200.0;
    world.add(intruder);
    world
}

/// Flies on until the encounter is over, with reports in each step.
fn fly(world: &mut World, until_s: f64, mut say: impl FnMut(&mut World)) {
    while world.time_s < until_s {
        say(world);
        world.step();
    }
}

fn assert_kept(world: &World) {
    let (least_m, at_s) = world.least_m[0];
    eprintln!(
        "least {least_m:.1} m at {at_s:.1} s, {:?}",
        world.emulator.mode_changes()
    );
    assert!(least_m >= PROTECTED_M, "{least_m} m at {at_s} s");
}

fn times_told(world: &World, text: &str) -> usize {
    let texts = world.emulator.texts().iter();
    texts.filter(|told| told.contains(text)).count()
}

/// The position of an aircraft on a straight line, as an aircraft to report.
fn at(icao: u32, from_m: [f64; 3], velocity_mps: [f64; 3], time_s: f64) -> Intruder {
    let mut position_m = from_m;
    for (place, rate) in position_m.iter_mut().zip(velocity_mps) {
        *place += rate * time_s;
    }
    Intruder::straight(icao, position_m, velocity_mps)
}

/// Reports this step's part of a crowd; `next` counts them.
fn report_crowd(world: &mut World, crowd: &[([f64; 3], [f64; 3])], rate_hz: f64, next: &mut f64) {
    let before = *next as usize;
    *next += rate_hz * fga_emulator::STEP_S;
    for number in before..*next as usize {
        let index = number % crowd.len();
        let (from_m, velocity_mps) = crowd[index];
        let aircraft = at(
            0x0010_0000 + index as u32,
            from_m,
            velocity_mps,
            world.time_s,
        );
        let report = world.report_of(&aircraft);
        world.say_as(RECEIVER, &report);
    }
}

#[test]
fn ten_thousand_far_aircraft_do_not_hide_the_near_one() {
    for rate_hz in [1473.0, 4450.0] {
        let mut world = head_on();
        let mut random = Random::new(1);
        let crowd: Vec<_> = (0..10_000)
            .map(|_| {
                let angle = random.uniform(0.0, core::f64::consts::TAU);
                let range_m = random.uniform(15_000.0, 80_000.0);
                let course = random.uniform(0.0, core::f64::consts::TAU);
                let height_m = random.uniform(100.0, 9000.0);
                (
                    [range_m * angle.sin(), range_m * angle.cos(), height_m],
                    [80.0 * course.sin(), 80.0 * course.cos(), 0.0],
                )
            })
            .collect();
        let mut next = 0.0;
        fly(&mut world, 95.0, |world| {
            if world.time_s > 25.0 {
                report_crowd(world, &crowd, rate_hz, &mut next);
            }
        });
        assert_kept(&world);
        assert_eq!(times_told(&world, "traffic overload"), 1);
        assert_eq!(world.mode(), PlaneMode::Auto);
        assert!(world.companion.tracks().tracks().len() <= 4096);
    }
}

#[test]
fn a_thousand_aircraft_in_formation_nearby_do_not_hide_the_intruder() {
    let mut world = head_on();
    // Beside the way, 400 to 1,500 m to the west and in front, at its own speed.
    let crowd: Vec<_> = (0..1000)
        .map(|n| {
            let (row, column) = (f64::from(n / 25), f64::from(n % 25));
            (
                [-400.0 - 25.0 * row, -300.0 + 25.0 * column, 100.0],
                [0.0, 25.0, 0.0],
            )
        })
        .collect();
    let mut next = 0.0;
    fly(&mut world, 80.0, |world| {
        if world.time_s > 30.0 {
            report_crowd(world, &crowd, 1000.0, &mut next);
        }
    });
    assert_kept(&world);
    assert_eq!(times_told(&world, "traffic overload"), 1);
}

#[test]
fn seventy_aircraft_150_m_above_do_not_hide_the_intruder() {
    let mut world = head_on();
    let crowd: Vec<_> = (0..70)
        .map(|n| {
            let (row, column) = (f64::from(n / 10), f64::from(n % 10));
            (
                [-90.0 + 30.0 * row, -150.0 + 30.0 * column, 250.0],
                [0.0, 25.0, 0.0],
            )
        })
        .collect();
    let mut next = 0.0;
    fly(&mut world, 80.0, |world| {
        report_crowd(world, &crowd, 140.0, &mut next);
    });
    assert_kept(&world);
}

#[test]
fn reports_at_our_place_under_the_address_of_a_later_intruder() {
    let mut world = head_on();
    let mut due_s = 10.0;
    fly(&mut world, 100.0, |world| {
        if world.time_s >= due_s && world.time_s < 30.0 {
            due_s += 0.5;
            let plant = world.emulator.plant();
            let copy = Intruder::straight(INTRUDER, plant.position_m(), plant.velocity_mps());
            let report = world.report_of(&copy);
            world.say_as(RECEIVER, &report);
        }
    });
    assert_kept(&world);
    assert_eq!(world.mode(), PlaneMode::Auto);
}

/// Our transponder, heard by a receiver on board a second late, is no obstacle, in turns too.
#[test]
fn our_transponder_is_no_obstacle() {
    for config in ["", "[traffic]\nown_icao = \"123456\"\n"] {
        let mut world = head_on();
        let parsed = fga_link::Config::parse(config).unwrap();
        world.companion = fga_link::Companion::new(parsed, false).unwrap();
        let mut due_s = 1.0;
        let mut late = VecDeque::new();
        let mut before = 0;
        fly(&mut world, 100.0, |world| {
            if world.time_s >= due_s {
                due_s += 1.0;
                let plant = world.emulator.plant();
                let copy =
                    Intruder::straight(0x0012_3456, plant.position_m(), plant.velocity_mps());
                late.push_back((world.time_s + 1.0, world.report_of(&copy)));
            }
            if late.front().is_some_and(|(at_s, _)| *at_s <= world.time_s)
                && let Some((_, report)) = late.pop_front()
            {
                world.say_as(RECEIVER, &report);
            }
            if world.time_s < 25.0 {
                before = world.companion.counts().maneuvers;
                return;
            }
            let own = world.companion.tracks().tracks().iter();
            for track in own.filter(|track| track.icao == 0x0012_3456) {
                assert!(track.is_own(), "at {} s", world.time_s);
            }
        });
        assert_kept(&world);
        // Unnamed, it is another aircraft until the belief begins.
        assert!(config.is_empty() || before == 0);
        assert_eq!(world.companion.counts().maneuvers, before + 1);
        assert_eq!(world.mode(), PlaneMode::Auto);
    }
}

/// How a forger displaces the reports of an aircraft.
#[derive(Debug, Clone, Copy)]
enum Forgery {
    /// Anywhere within this many metres.
    Anywhere(f64),
    /// To the side, metres.
    Beside(f64),
    /// Ahead on its way, metres.
    Ahead(f64),
}

#[test]
fn three_forged_reports_for_each_true_one() {
    let forgeries = [
        Forgery::Anywhere(3000.0),
        Forgery::Anywhere(100.0),
        Forgery::Beside(40.0),
        Forgery::Beside(120.0),
        Forgery::Beside(400.0),
        Forgery::Ahead(-40.0),
        Forgery::Ahead(-150.0),
        Forgery::Ahead(150.0),
    ];
    for forgery in forgeries {
        for sender in [RECEIVER, (210, 1)] {
            let mut world = head_on();
            let mut random = Random::new(7);
            let mut due_s = 0.0;
            fly(&mut world, 75.0, |world| {
                if !world.shown[0] || world.time_s < due_s {
                    return;
                }
                // The true one comes twice a second.
                due_s = world.time_s + 0.5 / 3.0;
                let mut forged = world.intruders[0];
                let [east_m, north_m, _] = &mut forged.position_m;
                match forgery {
                    Forgery::Anywhere(within_m) => {
                        *east_m += random.uniform(-within_m, within_m);
                        *north_m += random.uniform(-within_m, within_m);
                    }
                    Forgery::Beside(by_m) => *east_m += by_m,
                    Forgery::Ahead(by_m) => *north_m -= by_m,
                }
                let report = world.report_of(&forged);
                world.say_as(sender, &report);
            });
            let (least_m, at_s) = world.least_m[0];
            eprintln!("{forgery:?} by {sender:?}: least {least_m:.1} m");
            assert!(
                least_m >= PROTECTED_M,
                "{forgery:?} {least_m} m at {at_s} s"
            );
        }
    }
}

#[test]
fn reports_that_bounce_in_a_mesh_do_not_move_the_track() {
    let mut world = head_on();
    let mut bounced = VecDeque::new();
    let mut random = Random::new(5);
    let mut due_s = 0.0;
    let mut origin_m: Option<[f64; 3]> = None;
    fly(&mut world, 75.0, |world| {
        if world.shown[0] && world.time_s >= due_s {
            due_s = world.time_s + 0.5;
            let report = world.report(0);
            for _ in 0..3 {
                let late_s = random.uniform(1.5, 8.0);
                bounced.push_back((world.time_s + late_s, report.clone()));
            }
        }
        let now_s = world.time_s;
        for (_, report) in bounced.iter().filter(|(at_s, _)| *at_s <= now_s) {
            world.say_as(RECEIVER, report);
        }
        bounced.retain(|(at_s, _)| *at_s > now_s);
        let true_m = world.intruders[0].position_m;
        for track in world.companion.tracks().tracks() {
            let frame_m = track.position_m(now_s);
            let now_m = [true_m[0] - frame_m.x, true_m[1] - frame_m.y, 0.0];
            // The origin of the local frame, as the first report shows it.
            let from_m = *origin_m.get_or_insert(now_m);
            let off_m = crate::common::distance(now_m, from_m);
            assert!(off_m < 2.0, "{off_m} m at {now_s} s");
        }
    });
    assert_kept(&world);
}

#[test]
fn a_track_that_jumps_is_avoided_in_both_places_until_one_dies() {
    let mut world = World::new("", GOOD, 3);
    let say = |world: &mut World, east_m: f64| {
        let aircraft = at(
            INTRUDER,
            [east_m, 2000.0, 100.0],
            [0.0, 20.0, 0.0],
            world.time_s,
        );
        let report = world.report_of(&aircraft);
        world.say_as(RECEIVER, &report);
    };
    let mut due_s = 5.0;
    let mut count_at = Vec::new();
    fly(&mut world, 60.0, |world| {
        if world.time_s >= due_s {
            due_s += 0.5;
            say(world, if world.time_s < 20.0 { 300.0 } else { -500.0 });
        }
        for checked_s in [19.0, 21.5, 30.0] {
            if (world.time_s - checked_s).abs() < 0.011 {
                count_at.push(world.companion.tracks().tracks().len());
            }
        }
    });
    count_at.dedup();
    assert_eq!(count_at, [1, 2, 1]);
    // One stray report also counts as an aircraft, for some seconds.
    say(&mut world, 800.0);
    let mut due_s = world.time_s;
    fly(&mut world, 70.0, |world| {
        if world.time_s >= due_s {
            due_s += 0.5;
            say(world, -500.0);
        }
        if world.time_s > 60.2 && world.time_s < 62.0 {
            assert_eq!(world.companion.tracks().tracks().len(), 2);
        }
    });
    assert_eq!(world.companion.tracks().tracks().len(), 1);
}

/// A forger who fills the shares of senders takes nothing from the one that was there.
#[test]
fn another_sender_erases_no_track() {
    let mut world = head_on();
    // Its receiver reports from the beginning, and so has a share of its own.
    world.intruders[0].shown_m = f64::INFINITY;
    let mut number = 0_u32;
    fly(&mut world, 75.0, |world| {
        if world.time_s < 30.0 {
            return;
        }
        for _ in 0..20 {
            number += 1;
            // Right on the way, where it is most urgent, from ever new systems.
            let own_m = world.emulator.plant().position_m();
            let forged = Intruder::straight(
                0x0020_0000 + number,
                [own_m[0] + 2500.0, own_m[1] + 400.0, own_m[2]],
                [-110.0, 0.0, 0.0],
            );
            let MavMessage::ADSB_VEHICLE(data) = world.report_of(&forged) else {
                return;
            };
            let data = ADSB_VEHICLE_DATA {
                callsign: "FORGED".into(),
                ..data
            };
            world.say_as(
                (100 + (number % 100) as u8, 1),
                &MavMessage::ADSB_VEHICLE(data),
            );
        }
        if world.shown[0] && world.time_s > 40.0 && number.is_multiple_of(50) {
            let tracks = world.companion.tracks().tracks();
            assert!(tracks.iter().any(|track| track.icao == INTRUDER));
        }
    });
    let tracks = world.companion.tracks().tracks();
    assert!(tracks.len() <= 4096);
    assert!(tracks.iter().any(|track| track.icao == INTRUDER));
}

/// The head-on intruder, with no reports except those of the test.
fn unreported(config: &str) -> World {
    let mut world = World::new(config, GOOD, 3);
    let mut intruder = Intruder::straight(INTRUDER, [5.0, 3000.0, 100.0], [0.0, -25.0, 0.0]);
    intruder.shown_m = 0.0;
    world.add(intruder);
    world
}

#[test]
fn an_unmanned_aircraft_is_avoided_by_its_remote_id() {
    let mut world = unreported("");
    let mut due_s = 20.0;
    fly(&mut world, 75.0, |world| {
        if world.time_s < due_s {
            return;
        }
        due_s += 1.0;
        let MavMessage::ADSB_VEHICLE(seen) = world.report(0) else {
            return;
        };
        let altitude_m = seen.altitude as f32 * 1e-3;
        let location = OPEN_DRONE_ID_LOCATION_DATA {
            latitude: seen.lat,
            longitude: seen.lon,
            altitude_barometric: altitude_m,
            altitude_geodetic: altitude_m,
            direction: seen.heading,
            speed_horizontal: seen.hor_velocity,
            speed_vertical: 0,
            id_or_mac: [9; 20],
            horizontal_accuracy: MavOdidHorAcc::MAV_ODID_HOR_ACC_3_METER,
            vertical_accuracy: MavOdidVerAcc::MAV_ODID_VER_ACC_10_METER,
            barometer_accuracy: MavOdidVerAcc::MAV_ODID_VER_ACC_10_METER,
            speed_accuracy: MavOdidSpeedAcc::MAV_ODID_SPEED_ACC_1_METERS_PER_SECOND,
            timestamp: world.time_s as f32,
            ..OPEN_DRONE_ID_LOCATION_DATA::DEFAULT
        };
        let message = MavMessage::OPEN_DRONE_ID_LOCATION(location.clone());
        world.say_as((1, 236), &message);
        // The vehicle's own broadcast is no other aircraft.
        let own = OPEN_DRONE_ID_LOCATION_DATA {
            id_or_mac: [0; 20],
            ..location
        };
        world.say_as((1, 236), &MavMessage::OPEN_DRONE_ID_LOCATION(own));
        assert!(world.companion.tracks().tracks().len() <= 1);
    });
    assert_kept(&world);
    assert_eq!(world.companion.counts().maneuvers, 1);
}

#[test]
fn radar_detections_are_avoided_with_their_uncertainty() {
    let config = "[[traffic.sensor]]\nsystem_id = 1\ncomponent_id = 158\nposition_sigma_m = 8.0\n";
    for number in [7, u16::MAX] {
        let mut world = unreported(config);
        let mut random = Random::new(2);
        let mut due_s = 0.0;
        fly(&mut world, 75.0, |world| {
            let plant = world.emulator.plant();
            let (own_m, other_m) = (plant.position_m(), world.intruders[0].position_m);
            if world.time_s < due_s || crate::common::distance(own_m, other_m) > 900.0 {
                return;
            }
            due_s = world.time_s + 0.1;
            // East, north and up, turned by heading, pitch and bank into the body's axes.
            let (sin, cos) = plant.heading_rad().sin_cos();
            let [east, north, up] = [0, 1, 2].map(|n| other_m[n] - own_m[n]);
            let (ahead, right) = (east * sin + north * cos, east * cos - north * sin);
            let (sin, cos) = plant.pitch_rad().sin_cos();
            let (ahead, down) = (ahead * cos + up * sin, ahead * sin - up * cos);
            let (sin, cos) = plant.bank_rad().sin_cos();
            let (right, down) = (right * cos + down * sin, down * cos - right * sin);
            let mut noisy = |metres: f64| (metres + 3.0 * random.uniform(-1.7, 1.7)) as f32;
            let message = MavMessage::OBSTACLE_DISTANCE_3D(OBSTACLE_DISTANCE_3D_DATA {
                x: noisy(ahead),
                y: noisy(right),
                z: noisy(down),
                max_distance: 1500.0,
                obstacle_id: number,
                frame: MavFrame::MAV_FRAME_BODY_FRD,
                ..OBSTACLE_DISTANCE_3D_DATA::DEFAULT
            });
            world.say_as((1, 158), &message);
            // A stranger's radar sees from elsewhere.
            world.say_as((9, 158), &message);
            if world.time_s > 50.0 && world.time_s < 58.0 {
                for track in world.companion.tracks().tracks() {
                    assert!(track.sigma_m(world.time_s) >= 8.0);
                }
            }
        });
        let tracks = world.companion.tracks().tracks().len();
        assert!(tracks <= 2, "{tracks} tracks of one aircraft");
        assert_kept(&world);
        assert!(world.companion.counts().maneuvers >= 1);
    }
}

/// The companion keeps clear by more of an aircraft with poor navigation.
#[test]
fn the_quality_of_a_report_widens_the_volume() {
    let mut least_m = Vec::new();
    for sigma_m in ["2.0", "40.0"] {
        let mut world = unreported(&format!("[traffic]\nposition_sigma_m = {sigma_m}\n"));
        world.intruders[0].shown_m = 1200.0;
        world.run_until(75.0);
        least_m.push(world.least_m[0].0);
    }
    assert!(least_m[1] > least_m[0] + 60.0, "{least_m:?}");
}

/// The same for its velocity: a poorly known one is kept clear of by more, the further
/// ahead the more.
#[test]
fn the_accuracy_of_the_velocity_widens_the_volume_ahead() {
    let least_m = [0.3, 3.0].map(|error_mps| {
        let mut world = unreported("");
        let mut joiner = Joiner::new(ReportSource::Beast);
        let mut due_s = 0.0;
        fly(&mut world, 75.0, |world| {
            let own_m = world.emulator.plant().position_m();
            let range_m = crate::common::distance(own_m, world.intruders[0].position_m);
            if world.time_s < due_s || range_m > 1200.0 {
                return;
            }
            due_s = world.time_s + 0.5;
            let place = world
                .emulator
                .home()
                .to_place(world.intruders[0].position_m);
            let message = TrafficReport {
                address: INTRUDER,
                place_deg: Some(
                    [place.latitude_e7, place.longitude_e7].map(|e7| f64::from(e7) * 1e-7),
                ),
                altitude: Some(Altitude::Pressure(f64::from(place.altitude_mm) * 1e-3)),
                ground_speed_mps: Some(25.0),
                course_rad: Some(-core::f64::consts::FRAC_PI_2),
                climb_mps: Some(0.0),
                position_error_m: Some(10.0),
                velocity_error_mps: Some(error_mps),
                ..TrafficReport::default()
            };
            if let Some(report) = joiner.take(&message, world.time_s) {
                world.companion.take_report(&report, world.time_s);
            }
        });
        assert_kept(&world);
        world.least_m[0].0
    });
    assert!(least_m[1] > least_m[0] + 5.0, "{least_m:?}");
}
