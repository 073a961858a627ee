//! Alert levels in flight against the emulator: what is said on the link, and a manoeuvre that
//! begins by the level.

use crate::common::{GOOD, Intruder, World};
use fga_link::Config;
use mavlink::dialects::ardupilotmega::{MavCollisionThreatLevel, MavMessage};

/// A head-on intruder that meets the aircraft after about a minute.
fn head_on(config: &str) -> World {
    let mut world = World::new(config, GOOD, 3);
    world.keep_sent = true;
    let mut intruder = Intruder::straight(0x00AB_CDEF, [5.0, 3400.0, 100.0], [0.0, -25.0, 0.0]);
    intruder.shown_m = 2900.0;
    world.add(intruder);
    world
}

/// The reported alerts with their levels.
fn told(world: &World) -> Vec<(f64, usize)> {
    let texts = world.sent.iter().filter_map(|(time_s, message)| {
        let MavMessage::STATUSTEXT(data) = message else {
            return None;
        };
        let text = data.text.to_str().unwrap_or_default().to_owned();
        let level = match text.strip_prefix("fga: alert ") {
            Some(rest) => rest.split(' ').next()?.parse().ok()?,
            None if text == "fga: no alert" => 0,
            None => return None,
        };
        Some((*time_s, level))
    });
    texts.collect()
}

/// When the companion said that it avoids, seconds on the clock of [`told`].
fn taken_s(world: &World) -> f64 {
    let avoids = world.sent.iter().find(|(_, message)| match message {
        MavMessage::STATUSTEXT(data) => data
            .text
            .to_str()
            .is_ok_and(|text| text.starts_with("fga: avoiding")),
        _ => false,
    });
    avoids.expect("it avoids").0
}

#[test]
fn each_change_of_the_level_is_told_once_and_collision_grows_with_it() {
    let mut world = head_on("[alerts]\nlevels = \"f3442\"\n");
    world.run_until(150.0);
    let levels: Vec<usize> = told(&world).iter().map(|(_, level)| *level).collect();
    assert!(matches!(levels.first(), Some(1 | 2)), "{levels:?}");
    assert_eq!(levels.last(), Some(&0), "{levels:?}");
    assert!(levels.contains(&4), "{levels:?}");
    assert!(
        levels.windows(2).all(|pair| pair[0] != pair[1]),
        "{levels:?}"
    );
    let threats: Vec<MavCollisionThreatLevel> = world
        .sent
        .iter()
        .filter_map(|(_, message)| match message {
            MavMessage::COLLISION(data) if data.id == 0x00AB_CDEF => Some(data.threat_level),
            _ => None,
        })
        .collect();
    let low = MavCollisionThreatLevel::MAV_COLLISION_THREAT_LEVEL_LOW;
    let high = MavCollisionThreatLevel::MAV_COLLISION_THREAT_LEVEL_HIGH;
    assert_eq!(threats.first(), Some(&low));
    assert!(threats.contains(&high));
    assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
}

#[test]
fn a_maneuver_begins_at_the_level_that_is_configured() {
    let scheme = "[alerts]\nlevels = \"f3442\"\n";
    let mut late = head_on(scheme);
    late.run_until(100.0);
    let mut early = head_on(&format!("{scheme}act_at_level = 3\n"));
    early.run_until(100.0);
    let (late_s, early_s) = (taken_s(&late), taken_s(&early));
    assert!(early_s < late_s - 5.0, "{early_s} {late_s}");
    let rose_s = told(&early)
        .iter()
        .find(|(_, level)| *level >= 3)
        .map(|(time_s, _)| *time_s)
        .unwrap();
    assert!(
        (rose_s - 0.5..rose_s + 2.0).contains(&early_s),
        "{rose_s} {early_s}"
    );
    assert!(early.least_m[0].0 >= 60.0, "{:?}", early.least_m);
}

#[test]
fn without_levels_nothing_is_said_of_them_and_none_can_be_acted_on() {
    let mut world = head_on("");
    world.run_until(100.0);
    assert_eq!(told(&world), []);
    let error = Config::parse("[alerts]\nact_at_level = 1\n").unwrap_err();
    assert!(error.to_string().contains("alerts.act_at_level"), "{error}");
    let error = Config::parse("[alerts]\nlevels = \"f3442\"\nact_at_level = 5\n").unwrap_err();
    assert!(error.to_string().contains("alerts.act_at_level"), "{error}");
}
