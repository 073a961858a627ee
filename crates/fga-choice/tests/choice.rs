//! What is flown among aircraft that may do many things.

use fga_belief::{Errors, Sigma, Source};
use fga_choice::{Choice, Chooser};
use fga_index::situation::{
    Mission, Movement, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation,
};
use fga_proof::Vec3;
use fga_proof::vehicle::{Response, Vehicle};

const VEHICLE: Vehicle = Vehicle {
    airspeed_mps: 30.0,
    turn_radius_m: 200.0,
    climb_min_rad: -0.1,
    climb_max_rad: 0.1,
    climb_rate_radps: 0.05,
    response: Response::IDEAL,
};

fn errors() -> Errors {
    let sigma = |value| Sigma::new(value, Source::Sensor);
    Errors {
        position_m: sigma(15.0),
        altitude_m: sigma(2.0),
        velocity_mps: sigma(1.0),
        climb_mps: sigma(1.0),
        lasting_position_m: sigma(0.0),
        lasting_altitude_m: sigma(20.0),
    }
}

/// The last choice after reports for ten seconds of an aircraft that is at a place after them, with a velocity.
fn chosen(chooser: &mut Chooser, at_m: Vec3, velocity_mps: Vec3) -> Choice {
    let mut choice = Choice::default();
    for second in 0..=10 {
        let (time_s, left_s) = (f64::from(second), f64::from(10 - second));
        let own_m = Vec3::new(30.0 * time_s, 0.0, 300.0);
        let obstacle = Obstacle {
            movement: Movement::CREWED,
            ..Obstacle::straight(
                7,
                at_m - velocity_mps * left_s,
                velocity_mps,
                ProtectedVolume::Cylinder {
                    radius_m: 609.6,
                    half_height_m: 76.2,
                },
            )
        };
        let waypoints_m = [Vec3::new(0.0, 0.0, 300.0), Vec3::new(2e4, 0.0, 300.0)];
        let situation = Situation {
            time_s,
            ownship: Ownship {
                position_m: own_m,
                course_rad: 0.0,
                climb_rad: 0.0,
                bank_rad: 0.0,
                airspeed_mps: 30.0,
            },
            obstacles: Obstacles::Rows(&[obstacle]),
            mission: Mission::new(&waypoints_m),
            wind_mps: Vec3::ZERO,
        };
        choice = chooser.step(&situation, &errors());
    }
    choice
}

#[test]
fn a_head_on_aircraft_is_avoided_and_one_far_above_is_not() {
    let mut chooser = Chooser::new(VEHICLE).unwrap();
    let towards = Vec3::new(-60.0, 0.0, 0.0);
    let near = chosen(&mut chooser, Vec3::new(2600.0, 0.0, 300.0), towards);
    assert!(near.avoids && near.p_loss_hold > 0.8, "{near:?}");
    assert!(
        near.p_loss < 0.2 && !near.command.stages().is_empty(),
        "{near:?}"
    );
    let mut chooser = Chooser::new(VEHICLE).unwrap();
    let above = chosen(&mut chooser, Vec3::new(2600.0, 0.0, 700.0), towards);
    assert!(!above.avoids && above.p_loss_hold < 0.05, "{above:?}");
}

/// Two minutes away nothing is lost yet, and it waits.
#[test]
fn a_conflict_far_ahead_is_waited_for() {
    let mut chooser = Chooser::new(VEHICLE).unwrap();
    let towards = Vec3::new(-60.0, 0.0, 0.0);
    let far = chosen(&mut chooser, Vec3::new(5600.0, 300.0, 300.0), towards);
    assert!(!far.avoids && far.p_loss_hold > 0.1, "{far:?}");
}

#[test]
fn the_same_reports_give_the_same_choice() {
    let choice = || {
        let mut chooser = Chooser::new(VEHICLE).unwrap();
        chosen(
            &mut chooser,
            Vec3::new(2500.0, 500.0, 320.0),
            Vec3::new(-40.0, -10.0, 0.0),
        )
    };
    assert_eq!(choice(), choice());
}
