//! The search finds a fault that was planted, in few flights, and the same one again.

use fga::avoider::Avoider;
use fga::pilot::Pilot;
use fga::situation::{Obstacle, Obstacles, ProtectedVolume, Situation};
use fga::vehicle::Vehicle;

use super::*;
use crate::own::{Answer, Failure, Outside, OwnPolicy};
use crate::settings::PolicySettings;

/// The default policy, but it does not see what is to its right.
struct LeftOnly {
    avoider: Avoider,
}

impl Outside for LeftOnly {
    fn answer(&mut self, situation: &Situation<'_>) -> Result<Answer, Failure> {
        let own = &situation.ownship;
        let (sin, cos) = libm::sincos(own.course_rad);
        let is_left = |obstacle: &Obstacle| {
            let offset_m = obstacle.position_m - own.position_m;
            offset_m.y * cos - offset_m.x * sin >= 0.0
        };
        let seen: Vec<Obstacle> = situation.obstacles.iter().filter(is_left).collect();
        let seen = Situation {
            obstacles: Obstacles::Rows(&seen),
            ..*situation
        };
        Ok(Answer::Decided(Box::new(self.avoider.step(&seen))))
    }

    fn retune(&mut self, _vehicle: &Vehicle) {}

    fn restart(&mut self) {
        Pilot::restart(&mut self.avoider);
    }
}

fn stress(policy: PolicyChoice, flights: usize) -> Stress {
    let mut model = VehicleModel::built_in().unwrap();
    model.protection = ProtectedVolume::Sphere { radius_m: 30.0 };
    Stress {
        model,
        policy,
        bounds: MovementBounds::SMALL_UAS,
        flights,
        seed: 39,
    }
}

fn left_only() -> PolicyChoice {
    let make = |settings: &PolicySettings, vehicle: &Vehicle| -> Box<dyn Outside> {
        let avoider = Avoider::new(settings.avoider, *vehicle).unwrap();
        Box::new(LeftOnly { avoider })
    };
    PolicyChoice::Own(OwnPolicy::new("left-only", "", Box::new(make)))
}

#[test]
fn a_policy_that_looks_left_only_is_found_out_and_the_same_way_again() {
    let stress = stress(left_only(), 400);
    let found = search(&stress, &|| true, &mut |_| ()).unwrap();
    let first = found.first.unwrap();
    assert!(first <= 2000, "{first}");
    let likeliest = &found.failures[0];
    assert!(
        likeliest.avoidable && likeliest.margin_m < 0.0,
        "{likeliest:?}"
    );
    // It is there without the fault of the policy: the same motion, flown by the default one.
    let sound = Stress {
        policy: PolicyChoice::default(),
        ..stress.clone()
    };
    assert!(show(&sound, &likeliest.motion).unwrap().outcome.separated());
    assert!(
        !show(&stress, &likeliest.motion)
            .unwrap()
            .outcome
            .separated()
    );
    assert_eq!(search(&stress, &|| true, &mut |_| ()).unwrap(), found);
    // The likelier ones come first, and are likelier than the farther ones.
    for pair in found.failures.windows(2) {
        assert!(pair[0].relative_density() >= pair[1].relative_density());
    }
}

#[test]
fn the_estimate_agrees_with_drawing_from_the_usual_distribution_alone() {
    // A policy that does nothing fails often enough to count.
    let found = search(&stress(PolicyChoice::Mission, 1000), &|| true, &mut |_| ()).unwrap();
    let plain = stress(PolicyChoice::Mission, 0);
    let test = Test::new(&plain).unwrap();
    let usual = Proposal {
        mean: [0.0; PARAMETERS.len()],
        spread: [1.0; PARAMETERS.len()],
    };
    let mut engine = Engine::new();
    let (mut entered, count) = (0.0, 1000);
    for number in 0..count {
        let point = usual.draw(&mut Random::new(4, number));
        assert_eq!(usual.weight(&point), 1.0);
        entered += f64::from(u8::from(
            test.fly(&mut engine, &point).unwrap().margin_m < 0.0,
        ));
    }
    let share = entered / count as f64;
    let error = libm::sqrt(share * (1.0 - share) / count as f64);
    let (estimate, its_error) = found.probability;
    assert!(
        (estimate - share).abs() < 4.0 * (error + its_error),
        "{estimate} ± {its_error}, drawn {share} ± {error}"
    );
    assert!(found.entered > found.flights / 10);
}

#[test]
fn a_motion_keeps_to_its_bounds_and_is_reported_but_for_its_loss() {
    let plain = stress(PolicyChoice::Mission, 0);
    let test = Test::new(&plain).unwrap();
    let usual = Proposal {
        mean: [0.0; PARAMETERS.len()],
        spread: [2.0; PARAMETERS.len()],
    };
    let bounds = MovementBounds::SMALL_UAS;
    for number in 0..200 {
        let motion = test.motion(&usual.draw(&mut Random::new(4, number)));
        let world = test.world_of(&motion);
        let intruder = &world.obstacles[0];
        let [.., loss_start_s, loss_s] = motion.values;
        let mut last: Option<(fga::Vec3, f64)> = None;
        for report in &intruder.reports {
            let is_lost = (loss_start_s..loss_start_s + loss_s).contains(&report.time_s);
            assert!(!is_lost || report.time_s == 0.0);
            let (at_m, _) = intruder.track.at(report.time_s).unwrap();
            assert!(at_m.distance(report.position_m) < 1e-9);
            if let Some((velocity_mps, time_s)) = last {
                let level = |v: fga::Vec3| fga::Vec3::new(v.x, v.y, 0.0);
                let turned = level(velocity_mps).angle_between(level(report.velocity_mps));
                // Both turns may be on at once only one after the other.
                assert!(turned <= bounds.turn_rate_radps * (report.time_s - time_s) + 1e-9);
                assert!(report.velocity_mps.z.abs() <= bounds.climb_change_mps);
            }
            last = Some((report.velocity_mps, report.time_s));
        }
    }
}
