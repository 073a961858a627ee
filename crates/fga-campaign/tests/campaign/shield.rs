//! A policy that turns at random behind the shield, in drawn encounters.

use fga::avoider::{Decision, Reason, State};
use fga::maneuver::Maneuver;
use fga_campaign::batch::{empty_world, populate};
use fga_campaign::encounters::{EncounterSource, Random, Range};
use fga_sim::engine::SteppedFlight;
use fga_sim::policy::PolicyChoice;
use fga_sim::shield::Shield;
use fga_sim::vehicle_file::VehicleModel;

/// Flies drawn encounters with a policy that turns at random; returns how many entered a volume.
fn entered(count: u64, shielded: bool) -> usize {
    let model = VehicleModel::built_in().unwrap();
    let settings = fga_campaign::batch::BatchSettings {
        model: model.clone(),
        policy: PolicyChoice::default(),
        horizon_s: 40.0,
        seed: 0,
        tracks: false,
    };
    let source = EncounterSource::parse("threats:2:300:5-20", 7).unwrap();
    let empty = empty_world(&settings).unwrap();
    let mut shield = Shield::new(empty.settings.avoider, model.vehicle).unwrap();
    (0..count)
        .filter(|number| {
            let encounter = source.encounter(*number).unwrap();
            let mut world = empty.clone();
            populate(&mut world, &encounter, &model.protection);
            world.ending = fga_sim::world::Ending::Horizon;
            let mut flight = SteppedFlight::new(world);
            let mut random = Random::new(99, *number);
            let mut course_rad = 0.0;
            let mut cycle = 0_u32;
            shield.restart();
            while let Some(situation) = flight.situation() {
                if cycle.is_multiple_of(20) {
                    course_rad = random.within(Range(-1.5, 1.5));
                }
                cycle += 1;
                let wish = Maneuver::turn(0.0, course_rad, 0.0);
                let decision = if shielded {
                    shield.step(&situation, &wish).decision
                } else {
                    Decision::new(State::Cruise, &wish, Reason::Clear)
                };
                flight.advance(&decision, &mut ());
            }
            !flight.outcome().separated()
        })
        .count()
}

#[test]
fn a_random_policy_stays_clear_behind_the_shield_and_not_without() {
    assert!(entered(40, false) >= 4, "the encounters ask for something");
    assert_eq!(entered(40, true), 0);
}
