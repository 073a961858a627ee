//! Rally points: RTL leads to the nearest one, and another list uploaded on another link is read again.

use crate::common::{GOOD, Intruder, World, upload};
use fga_emulator::{EmulatorSettings, MissionItem, PlaneMode};
use fga_link::authority::Authority;
use mavlink::dialects::ardupilotmega::{MavCmd, MavMissionType};

const RALLY: MavMissionType = MavMissionType::MAV_MISSION_TYPE_RALLY;
/// Distance of the start north of home, metres.
const START_M: f64 = 3400.0;
const RTL_TOO: &str = "[vehicle]\ntake_over = [\"AUTO\", \"RTL\"]\n";

fn points(world: &World, places_m: &[[f64; 2]]) -> Vec<MissionItem> {
    let home = *world.emulator.home();
    let point = |[x, y]: &[f64; 2]| MissionItem {
        command: MavCmd::MAV_CMD_NAV_RALLY_POINT,
        ..MissionItem::waypoint(&home, [*x, *y, 100.0])
    };
    places_m.iter().map(point).collect()
}

/// North of home, flying to the south, with rally points.
fn world(places_m: &[[f64; 2]]) -> World {
    let settings = EmulatorSettings {
        position_m: [0.0, START_M, 100.0],
        heading_rad: core::f64::consts::PI,
        ..EmulatorSettings::default()
    };
    let mut world = World::with(settings, RTL_TOO, GOOD, 9);
    let items = points(&world, places_m);
    world.emulator.set_rally(items);
    world
}

/// Flying home to a rally point 200 m north of it, with an intruder ahead on the way.
fn meeting_an_intruder_in_rtl() -> World {
    let mut world = world(&[[0.0, 200.0]]);
    let mut intruder = Intruder::straight(0x00AB_CDEF, [5.0, -100.0, 100.0], [0.0, 25.0, 0.0]);
    intruder.shown_m = 1200.0;
    world.add(intruder);
    world.run_until(1.0);
    world.emulator.pilot_mode(PlaneMode::Rtl);
    world
}

/// The end of the way, east and north, metres.
fn end(world: &World) -> Option<[f64; 2]> {
    let picture = world.companion.picture()?;
    picture.waypoints_m.last().map(|at| [at.x, at.y])
}

/// Whether the way ends at a place, east and north of home, metres. The companion's local frame begins where
/// the vehicle was heard first, at its start or a few metres on.
fn leads_to(world: &World, place_m: [f64; 2]) -> bool {
    let near = |at: [f64; 2]| (at[0] - place_m[0]).hypot(at[1] + START_M - place_m[1]) < 40.0;
    end(world).is_some_and(near)
}

fn told(world: &World) -> bool {
    let texts = world.emulator.texts();
    texts
        .iter()
        .any(|text| text == "fga: the rally points have changed")
}

/// The way is known before the vehicle's own target is: at the next decision.
#[test]
fn rtl_leads_to_the_rally_point_that_the_vehicle_chooses() {
    for (limit_km, with_home, place_m) in [
        (5.0, 0.0, [300.0, 1000.0]),
        (2.0, 0.0, [0.0, 0.0]),
        (0.0, 0.0, [300.0, 1000.0]),
        (5.0, 1.0, [300.0, 1000.0]),
    ] {
        let mut world = world(&[[-4000.0, 500.0], [300.0, 1000.0]]);
        world.emulator.parameters.set("RALLY_LIMIT_KM", limit_km);
        world.emulator.parameters.set("RALLY_INCL_HOME", with_home);
        world.run_until(3.0);
        world.emulator.pilot_mode(PlaneMode::Rtl);
        world.run_until(world.time_s + 0.3);
        assert!(leads_to(&world, place_m), "{:?}", end(&world));
        world.run_until(world.time_s + 3.0);
        assert!(leads_to(&world, place_m), "{:?}", end(&world));
    }
}

#[test]
fn after_a_manoeuvre_in_rtl_it_flies_on_to_the_rally_point() {
    let mut world = meeting_an_intruder_in_rtl();
    world.run_until(115.0);
    assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
    let changes = world.emulator.mode_changes().iter();
    let modes: Vec<PlaneMode> = changes.map(|change| change.mode).collect();
    assert_eq!(modes, [PlaneMode::Rtl, PlaneMode::Guided, PlaneMode::Rtl]);
    assert!(leads_to(&world, [0.0, 200.0]));
}

/// Another number of points, or a moved one: no message reports either.
#[test]
fn other_rally_points_uploaded_on_another_link_are_noticed_within_two_seconds() {
    for new_m in [
        vec![[300.0, 1000.0], [900.0, 2000.0]],
        vec![[300.0, 1200.0]],
        vec![],
    ] {
        let mut world = world(&[[300.0, 1000.0]]);
        world.run_while(20.0, "ready", |w| {
            w.companion.authority() != Authority::Ready
        });
        world.run_until(world.time_s + 4.0);
        assert!(!told(&world), "the same points are no news");
        let items = points(&world, &new_m);
        upload_all(&mut world, &items);
        world.run_while(2.0, "the new points", |w| !told(w));
    }
}

/// An upload of nothing is how a ground station clears a list.
fn upload_all(world: &mut World, items: &[MissionItem]) {
    if items.is_empty() {
        world.emulator.set_rally(Vec::new());
    } else {
        upload(world, RALLY, items, None);
    }
}

/// The vehicle chooses again when RTL resumes: the way back leads there.
#[test]
fn rally_points_uploaded_in_a_manoeuvre_are_where_it_comes_back_to() {
    let mut world = meeting_an_intruder_in_rtl();
    world.run_while(90.0, "command", |w| {
        !matches!(w.companion.authority(), Authority::InCommand { .. })
    });
    let new_m = [-600.0, 400.0];
    let items = points(&world, &[new_m]);
    upload(&mut world, RALLY, &items, None);
    world.run_while(2.0, "the new points", |w| !leads_to(w, new_m));
    world.run_while(90.0, "RTL again", |w| w.mode() != PlaneMode::Rtl);
    assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
    world.run_until(world.time_s + 3.0);
    assert!(leads_to(&world, new_m), "{:?}", end(&world));
}

/// Without RTL in `take_over` the list does not matter.
#[test]
fn rally_points_are_read_only_where_rtl_may_be_taken_over() {
    let mut world = World::new("", GOOD, 2);
    let items = points(&world, &[[300.0, 1000.0]]);
    world.emulator.set_rally(items);
    world.keep_sent = true;
    world.run_until(8.0);
    let asked = world.sent.iter().any(|(_, message)| {
        matches!(message, mavlink::dialects::ardupilotmega::MavMessage::MISSION_REQUEST_LIST(data) if data.mission_type == RALLY)
    });
    assert!(!asked);
}
