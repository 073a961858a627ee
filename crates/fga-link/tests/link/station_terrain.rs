//! Ground asked of a ground station on the second link, which answers as MAVProxy does.

use fga_emulator::{EmulatorSettings, PlaneMode};
use mavlink::dialects::ardupilotmega::{MavMessage, TERRAIN_DATA_DATA, TERRAIN_REQUEST_DATA};

use crate::common::{GOOD, GROUND, Intruder, World};
use crate::terrain::{Flown, PROTECTED_M, choice, fly_beside, is_told};

/// What a ground station says of a height, at a time, seconds; `None` is silence.
type Says<'a> = &'a dyn Fn(f64, [f64; 2], u8) -> Option<i16>;

/// Ground stations on the second link, which answer as MAVProxy does, all of them, one after the other.
struct Station<'a> {
    says: &'a [Says<'a>],
    request: Option<TERRAIN_REQUEST_DATA>,
    due_s: f64,
    requests: u32,
}

/// A flight past a head-on intruder with ground that a ground station sends.
fn asked(says: &[Says<'_>], until_s: f64) -> (World, Flown, u32) {
    asked_with(EmulatorSettings::default(), says, until_s)
}

fn asked_with(settings: EmulatorSettings, says: &[Says<'_>], until_s: f64) -> (World, Flown, u32) {
    let config = "[terrain]\nsource = \"ground-station\"\nclearance_m = 30.0\n";
    let mut world = World::with(settings, config, GOOD, 8);
    world.add(Intruder::head_on());
    let mut station = Station {
        says,
        request: None,
        due_s: 0.0,
        requests: 0,
    };
    let mut flown = fly_beside(&mut world, None, until_s, |world| station.step(world));
    world.companion.shut_down(until_s);
    flown.log.extend(world.companion.take_log());
    (world, flown, station.requests)
}

impl Station<'_> {
    fn step(&mut self, world: &mut World) {
        for message in world.emulator.drain_second_link() {
            if let MavMessage::TERRAIN_REQUEST(data) = message {
                self.requests += 1;
                self.request = Some(data);
            }
        }
        // Five pieces a second.
        let Some(request) = self.request.as_mut().filter(|request| request.mask != 0) else {
            return;
        };
        if world.time_s < self.due_s {
            return;
        }
        self.due_s = world.time_s + 0.2;
        let bit = u8::try_from(request.mask.trailing_zeros()).expect("below 64");
        request.mask &= request.mask - 1;
        let home = world.emulator.home();
        let spacing_m = f64::from(request.grid_spacing);
        let corner = [request.lat, request.lon].map(|e7| f64::from(e7) * 1e-7);
        let north_m = (corner[0] - home.latitude_deg) * 111_320.0;
        let east_m = (corner[1] - home.longitude_deg) * 111_320.0 * corner[0].to_radians().cos();
        let (row, column) = (f64::from(bit / 8) * 4.0, f64::from(bit % 8) * 4.0);
        for says in self.says {
            let posts = core::array::from_fn(|index| {
                let at_m = [
                    east_m + (column + (index % 4) as f64) * spacing_m,
                    north_m + (row + (index / 4) as f64) * spacing_m,
                ];
                says(world.time_s, at_m, bit)
            });
            let posts: [Option<i16>; 16] = posts;
            if posts.contains(&None) {
                continue;
            }
            let data = TERRAIN_DATA_DATA {
                lat: request.lat,
                lon: request.lon,
                grid_spacing: request.grid_spacing,
                gridbit: bit,
                data: posts.map(Option::unwrap_or_default),
            };
            let message = MavMessage::TERRAIN_DATA(data);
            world.emulator.receive_on_second_link(&GROUND, &message);
        }
    }
}

/// The pieces that the log counts at the end.
pub(crate) fn pieces(flown: &Flown, key: &str) -> u64 {
    let line = flown.log.iter().find(|line| line["kind"] == "ground-heard");
    line.expect("counts")["pieces"][key]
        .as_u64()
        .expect("a count")
}

#[test]
fn a_ground_station_is_asked_for_the_ground_and_its_ridge_is_avoided() {
    let side = choice();
    // Posts are 100 m apart: the mission is clear wherever they are.
    let says = move |_: f64, [east_m, _]: [f64; 2], _: u8| {
        Some(if side * east_m > 105.0 { 400 } else { 4 })
    };
    let (world, flown, requests) = asked(&[&says], 130.0);
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    assert_eq!(flown.modes, [PlaneMode::Guided, PlaneMode::Auto]);
    let to_ridge_m = if side > 0.0 {
        flown.east_m[1]
    } else {
        -flown.east_m[0]
    };
    assert!(to_ridge_m < 20.0, "{:?}", flown.east_m);
    assert!(is_told(&world, "fga: the ground bounds the way round"));
    assert!(pieces(&flown, "taken") > 300, "{}", pieces(&flown, "taken"));
    assert!(requests <= 66, "{requests}");
    assert_eq!(
        (pieces(&flown, "wrong"), pieces(&flown, "contradicting")),
        (0, 0)
    );
}

/// A ground station needs minutes for the way of a flight.
#[test]
fn before_the_vehicle_moves_the_ground_is_asked_for_and_the_operator_reads_what_is_missing() {
    let stands = EmulatorSettings {
        armed: false,
        ..EmulatorSettings::default()
    };
    let (world, flown, _) = asked_with(stands, &[&|_, _, _| Some(4)], 60.0);
    assert!(pieces(&flown, "taken") > 200, "{}", pieces(&flown, "taken"));
    assert!(is_told(&world, "fga: not ready: vehicle is disarmed"));
    assert!(
        !is_told(&world, "telemetry"),
        "{:?}",
        world.emulator.texts()
    );
}

#[test]
fn a_silent_ground_station_is_told_asked_ever_less_often_and_traffic_is_avoided() {
    let (world, flown, requests) = asked(&[&|_, _, _| None], 130.0);
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    assert_eq!(flown.modes, [PlaneMode::Guided, PlaneMode::Auto]);
    assert!(is_told(&world, "fga: no terrain from the ground station"));
    // After 2, 4, 8, 16 and then each 32 s.
    assert!((5..=8).contains(&requests), "{requests}");
}

#[test]
fn lies_of_a_ground_station_are_counted_and_told_and_lower_no_ground() {
    // Heights that are no ground: nothing is known.
    let (world, flown, _) = asked(&[&|_, _, _| Some(20_000)], 130.0);
    assert!(is_told(&world, "fga: terrain answers that are no ground"));
    assert!(pieces(&flown, "wrong") > 10 && pieces(&flown, "taken") == 0);
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    // Of two that contradict each other the higher counts, whichever comes first.
    let side = choice();
    let ridge = move |_: f64, [east_m, _]: [f64; 2], _: u8| {
        Some(if side * east_m > 105.0 { 400 } else { 4 })
    };
    let plain = |_: f64, _: [f64; 2], _: u8| Some(4);
    let both: [[Says<'_>; 2]; 2] = [[&ridge, &plain], [&plain, &ridge]];
    for says in both {
        let (world, flown, _) = asked(&says, 130.0);
        assert!(is_told(
            &world,
            "fga: terrain answers contradict, higher counts"
        ));
        assert!(pieces(&flown, "contradicting") > 10);
        let to_ridge_m = if side > 0.0 {
            flown.east_m[1]
        } else {
            -flown.east_m[0]
        };
        assert!(to_ridge_m < 20.0, "{:?}", flown.east_m);
        assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    }
}

#[test]
fn half_of_the_pieces_leaves_the_other_half_unknown() {
    let says = |_: f64, _: [f64; 2], bit: u8| bit.is_multiple_of(2).then_some(4);
    let (world, flown, _) = asked(&[&says], 130.0);
    assert!(world.least_m[0].0 >= PROTECTED_M, "{:?}", world.least_m);
    assert_eq!(flown.modes, [PlaneMode::Guided, PlaneMode::Auto]);
    // A block that is never whole holds up no other.
    assert!(
        pieces(&flown, "taken") > 2 * 28,
        "{}",
        pieces(&flown, "taken")
    );
    // A manoeuvre over what is known between holes is as good as any.
    let made = flown
        .log
        .iter()
        .filter(|line| line["kind"] == "ground" && line["unusable"].is_null());
    assert!(made.count() > 0);
}
