//! Who flew does not judge: what was flown follows from the track.

use std::path::Path;

use fga::Vec3;
use fga::avoider::{Decision, Reason, State};
use fga::maneuver::Maneuver;
use fga::pilot::Pilot;
use fga::situation::Situation;
use fga::vehicle::Vehicle;
use fga_files::TomlText;
use fga_sim::engine::{Engine, Observer, Outcome, Sample};
use fga_sim::policy::PolicyChoice;
use fga_sim::scenario;
use fga_sim::world::World;

#[derive(Default)]
struct Track(Vec<Vec3>);

impl Observer for Track {
    fn sample(&mut self, sample: &Sample) {
        self.0.push(sample.position_m);
    }
}

fn first_flight() -> World {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let plan = scenario::read(&folder.join("first-flight.toml"), None).unwrap();
    plan.world
}

/// Least distance of the flown samples from each waypoint, metres.
fn distances_m(world: &World, track: &Track) -> Vec<f64> {
    let nearest = |place: &Vec3| {
        let distances = track.0.iter().map(|at| at.distance(*place));
        distances.fold(f64::INFINITY, f64::min)
    };
    world.mission_m.iter().map(nearest).collect()
}

/// Every waypoint that a flight never comes near is missed, and the mission is not flown, whatever the policy says.
#[test]
fn d9_waypoints_that_no_policy_came_near_are_missed() {
    let world = first_flight();
    let names = [
        "turn-aware",
        "published",
        "circle",
        "none",
        "orca",
        "mvp",
        "velocity-obstacles",
        "potential-field",
        "waypoint-greedy",
        "waypoint-optimal",
        "operator-f3442",
    ];
    let mut far = 0;
    for name in names {
        let policy = PolicyChoice::parse(name, None).unwrap();
        let mut pilot = policy.pilot(&world.settings, &world.vehicle).unwrap();
        let (mut track, mut engine) = (Track::default(), Engine::new());
        let outcome = engine.fly(&world, pilot.as_mut(), &mut track);
        let missed: Vec<usize> = engine.missed().iter().map(|missed| missed.index).collect();
        assert_eq!(outcome.waypoints_missed, missed.len());
        let said = format!("{name}: {outcome:?}, missed {missed:?}");
        for (index, distance_m) in distances_m(&world, &track).into_iter().enumerate().skip(1) {
            // Fly-by corners are cut by less.
            if distance_m > 60.0 {
                far += 1;
                assert!(
                    !outcome.mission_flown,
                    "{said}, waypoint {index} by {distance_m}"
                );
                if outcome.end_s < world.horizon_s {
                    assert!(
                        missed.contains(&index),
                        "{said}, waypoint {index} by {distance_m}"
                    );
                }
            }
        }
    }
    assert!(
        far > 0,
        "no policy leaves a waypoint out: the test shows nothing"
    );
}

/// Says that all is flown and that it is back, and flies straight on.
struct Liar {
    steps: u32,
}

impl Pilot for Liar {
    fn step(&mut self, _situation: &Situation<'_>) -> Decision {
        self.steps += 1;
        let (state, reason) = match self.steps {
            0..20 => (State::Avoiding, Reason::ManeuverChosen),
            20..200 => (State::Recovering, Reason::RejoinKept),
            _ => (State::Cruise, Reason::MissionComplete),
        };
        let turned = Maneuver::turn(0.0, 2.0, 0.0);
        Decision::new(state, &turned, reason)
    }
    fn retune(&mut self, _vehicle: &Vehicle) {}
    fn restart(&mut self) {
        self.steps = 0;
    }
}

#[test]
fn d9_a_pilot_that_says_it_flew_the_mission_is_not_believed() {
    let world = first_flight();
    let outcome: Outcome = Engine::new().fly(&world, &mut Liar { steps: 0 }, &mut ());
    assert_eq!(outcome.start_s, Some(0.0));
    assert!(!outcome.mission_flown, "{outcome:?}");
    assert_eq!(outcome.rejoined_s, None, "{outcome:?}");
    assert_eq!(
        outcome.waypoints_missed,
        world.mission_m.len() - 1,
        "{outcome:?}"
    );
}

/// A closed mission begins at its end, which is not yet reached there; without a threat it is flown.
#[test]
fn d9_a_closed_mission_is_flown_once_it_is_closed() {
    let text = "name = 'closed'\nduration_s = 300\n[mission]\n\
                waypoints_m = [[0, 0, 100], [600, 0, 100], [600, 500, 100], [0, 500, 100], [0, 0, 100]]\n";
    for (duration, flown) in [("300", true), ("60", false)] {
        let text = text.replace("300", duration);
        let plan = scenario::parse(TomlText::new(Path::new("c.toml"), &text), None).unwrap();
        let mut pilot = PolicyChoice::parse("none", None)
            .unwrap()
            .pilot(&plan.world.settings, &plan.world.vehicle)
            .unwrap();
        let outcome = Engine::new().fly(&plan.world, pilot.as_mut(), &mut ());
        assert_eq!(outcome.mission_flown, flown, "{outcome:?}");
        assert_eq!(outcome.waypoints_missed, 0, "{outcome:?}");
    }
}
