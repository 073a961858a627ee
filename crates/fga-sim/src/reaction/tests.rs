use fga::Vec3;
use fga_formats::daa::{Recording, Track as Recorded, TrackSample};
use fga_formats::tally::Tally;

use super::*;
use crate::engine::Engine;
use crate::recording::plan;
use crate::track::Track;

/// Two aircraft that meet head-on at 50 m/s each, level, 100 m aside, after 60 s; rows once a second. The second one begins later.
fn head_on(later_s: f64) -> Recording {
    let track = |name: &str, from_m: Vec3, velocity_mps: Vec3, first_s: f64| Recorded {
        name: name.into(),
        samples: (0..=120_i32)
            .map(f64::from)
            .filter(|time_s| *time_s >= first_s)
            .map(|time_s| TrackSample::new(time_s, from_m + velocity_mps * time_s, velocity_mps))
            .collect(),
    };
    let height = Vec3::Z * 500.0;
    Recording {
        aircraft: vec![
            track("own", height, Vec3::X * 50.0, 0.0),
            track(
                "other",
                height + Vec3::new(6000.0, 100.0, 0.0),
                Vec3::X * -50.0,
                later_s,
            ),
        ],
        frame: None,
        parameters: Vec::new(),
        tally: Tally::default(),
    }
}

fn model() -> VehicleModel {
    VehicleModel::recorded().unwrap()
}

fn reacted(recording: &Recording, policy: &str, intruders: &str) -> (World, World) {
    let world = plan(recording, String::new(), String::new(), model())
        .unwrap()
        .world;
    let policy = PolicyChoice::parse(policy, None).unwrap();
    let intruders = PolicyChoice::parse(intruders, None).unwrap();
    let answer = react(world.clone(), recording, &model(), &policy, &intruders).unwrap();
    assert_eq!(answer.failure, None);
    (world, answer.world)
}

fn least_m(world: &World, policy: &str) -> f64 {
    let policy = PolicyChoice::parse(policy, None).unwrap();
    let mut pilot = policy.pilot(&world.settings, &world.vehicle).unwrap();
    let mut engine = Engine::new();
    engine.fly(world, pilot.as_mut(), &mut ());
    engine.separations()[0].distance().value_m
}

#[test]
fn intruders_without_a_wish_to_avoid_leave_the_world_as_it_is() {
    for policy in ["none", "turn-aware"] {
        let (before, after) = reacted(&head_on(0.0), policy, "none");
        assert!(before == after);
    }
}

#[test]
fn an_intruder_gives_way_to_an_aircraft_that_does_not() {
    for later_s in [0.0, 7.0, 7.3] {
        let (before, after) = reacted(&head_on(later_s), "none", "turn-aware");
        assert!(least_m(&before, "none") < 101.0);
        assert!(
            least_m(&after, "none") > 152.4,
            "{}",
            least_m(&after, "none")
        );
        // It is where it was recorded until it leaves, and flies about as fast.
        let (Track::Points { points, .. }, Track::Points { points: was, .. }) =
            (&after.obstacles[0].track, &before.obstacles[0].track)
        else {
            panic!("two tracks with points");
        };
        let alike = points.iter().zip(was).take_while(|(a, b)| a == b).count();
        assert!(alike > 5 && alike < 60, "{alike}");
        for pair in points.windows(2) {
            let speed_mps =
                pair[0].position_m.distance(pair[1].position_m) / (pair[1].time_s - pair[0].time_s);
            assert!(
                (speed_mps - 50.0).abs() < 1.0,
                "{speed_mps} at {}",
                pair[1].time_s
            );
        }
        assert!(
            after.obstacles[0]
                .reports
                .is_sorted_by(|a, b| a.time_s < b.time_s)
        );
    }
}

/// The ownship, flown again against the recorded reaction, flies the path to which the intruder reacted.
#[test]
fn both_react_to_each_other_and_the_flight_can_be_flown_again() {
    let recording = head_on(0.0);
    let (_, both) = reacted(&recording, "right-of-way", "right-of-way");
    let (_, alone) = reacted(&recording, "none", "right-of-way");
    assert!(both.obstacles != alone.obstacles);
    let (_, again) = reacted(&recording, "right-of-way", "right-of-way");
    assert!(both == again);
    assert!(least_m(&both, "right-of-way") > 152.4);
    // By symmetry: exchange the two, and the distance is the same.
    let (_, one) = reacted(&recording, "turn-aware", "see-and-avoid");
    let mut exchanged = recording;
    exchanged.aircraft.swap(0, 1);
    let (_, other) = reacted(&exchanged, "see-and-avoid", "turn-aware");
    let (first, second) = (
        least_m(&one, "turn-aware"),
        least_m(&other, "see-and-avoid"),
    );
    assert!((first - second).abs() < 0.5, "{first} {second}");
}
