//! The search finds a fault that was planted, in few flights, and the same one again.

use fga::avoider::Avoider;
use fga::pilot::Pilot;
use fga::situation::{MovementBounds, Obstacle, Obstacles, ProtectedVolume, Situation};
use fga::vehicle::Vehicle;
use fga_sim::own::{Outside, OwnPolicy, PolicyAnswer, PolicyFailure};
use fga_sim::policy::PolicyChoice;
use fga_sim::settings::PolicySettings;
use fga_sim::vehicle_file::VehicleModel;

use super::*;

/// The default policy, but it does not see what is to its right.
struct LeftOnly {
    avoider: Avoider,
}

impl Outside for LeftOnly {
    fn answer(&mut self, situation: &Situation<'_>) -> Result<PolicyAnswer, PolicyFailure> {
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
        Ok(PolicyAnswer::Decided(Box::new(self.avoider.step(&seen))))
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
        flights,
        seed: 39,
        ..Stress::of(model, policy, MovementBounds::SMALL_UAS)
    }
}

fn found(stress: &Stress) -> FoundEncounter {
    let found = search(stress, &[], &|| true, &mut |_| Ok(()));
    found.unwrap().unwrap()
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
    let found = found(&stress);
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
    assert!(show(&sound, &likeliest.case).unwrap().outcome.separated());
    assert!(!show(&stress, &likeliest.case).unwrap().outcome.separated());
    assert_eq!(super::tests::found(&stress), found);
    // The likelier ones come first, and are likelier than the farther ones.
    for pair in found.failures.windows(2) {
        assert!(pair[0].relative_density() >= pair[1].relative_density());
    }
}

#[test]
fn the_estimate_agrees_with_drawing_from_the_usual_distribution_alone() {
    // A policy that does nothing fails often enough to count.
    let found = found(&stress(PolicyChoice::Mission, 1000));
    let plain = stress(PolicyChoice::Mission, 0);
    let test = Test::new(&plain).unwrap();
    let usual = Proposal::usual(MOTION.len(), 1.0);
    let mut engine = Engine::new();
    let (mut entered, count) = (0.0, 1000);
    for number in 0..count {
        let point = usual.draw(&mut Random::new(4, number));
        assert_eq!(usual.weight(&point), 1.0);
        entered += f64::from(u8::from(
            test.fly(&mut engine, &point).unwrap().0.margin_m < 0.0,
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
    let usual = Proposal::usual(MOTION.len(), 2.0);
    let bounds = MovementBounds::SMALL_UAS;
    for number in 0..200 {
        let case = StressCase::of(&usual.draw(&mut Random::new(4, number)), &plain);
        let (world, motion) = (test.world_of(&case), &case.motions[0]);
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

#[test]
fn a_search_that_was_stopped_goes_on_to_the_same_end() {
    let stress = stress(PolicyChoice::Mission, 500);
    let whole = found(&stress);
    for stops_after in [1, 2] {
        let mut kept: Vec<StressFlight> = Vec::new();
        let asked = core::sync::atomic::AtomicUsize::new(0);
        let go_on = || asked.fetch_add(1, core::sync::atomic::Ordering::Relaxed) < stops_after;
        let mut take = |flights: &[StressFlight]| {
            kept.extend(flights);
            Ok(())
        };
        assert_eq!(search(&stress, &[], &go_on, &mut take).unwrap(), None);
        assert_eq!(kept.len(), stops_after * BATCH);
        // What was flown is not flown again: a changed result shows.
        let again = search(&stress, &kept, &|| true, &mut |_| Ok(()));
        assert_eq!(again.unwrap().unwrap(), whole);
        kept[0].margin_m = -1.0;
        let other = search(&stress, &kept, &|| true, &mut |_| Ok(()));
        assert_ne!(other.unwrap().unwrap(), whole);
    }
}

/// The default policy on a mission in gusts: an aircraft that holds its course is carried off by the gust alone.
#[test]
fn a_gust_carries_the_aircraft_and_several_intruders_fly() {
    let stress = Stress {
        intruders: 3,
        gust_mps: 2.0,
        ..stress(PolicyChoice::Mission, 0)
    };
    assert_eq!(stress.parameters().len(), stress.dimensions());
    let names: Vec<String> = stress
        .parameters()
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    assert!(names.contains(&"turn_rad_3".into()) && names.contains(&"gust_up_mps".into()));
    let mut point = vec![0.0; stress.dimensions()];
    // From 45 s on for 15 s: the medians.
    let left = point.len() - 2;
    point[left] = 1.0;
    let case = StressCase::of(&point, &stress);
    assert_eq!(case.values().count(), point.len());
    assert!(
        case.in_words().contains("2.0 to the left"),
        "{}",
        case.in_words()
    );
    let flown = show(&stress, &case).unwrap();
    assert_eq!(flown.obstacles.len(), 3);
    let at = |time_s: f64| {
        let near = flown
            .samples
            .iter()
            .find(|sample| sample.time_s >= time_s - 1e-6);
        near.unwrap().position_m
    };
    assert!(at(44.0).y.abs() < 1e-9);
    // 2 m/s until the guidance sees it, a tenth of a second later.
    let drifted_m = at(45.1).y;
    assert!((drifted_m - 0.2).abs() < 1e-6, "{drifted_m}");
    // The mission ends in the gust, in which the guidance holds the line.
    let last = flown.samples.last().unwrap();
    let (end_s, off_m) = (last.time_s, last.position_m.y);
    assert!(end_s > 55.0 && off_m.abs() < 0.5, "{off_m} m at {end_s} s");
    let calm = Stress {
        gust_mps: 0.0,
        ..stress
    };
    assert_eq!(calm.parameters().len(), 45);
    assert_eq!(StressCase::of(&[0.0; 45], &calm).gust, None);
}

#[test]
fn a_gust_keeps_to_its_bounds() {
    let mut gusty = stress(PolicyChoice::Mission, 0);
    gusty.gust_mps = 0.3;
    let usual = Proposal::usual(gusty.dimensions(), 3.0);
    for number in 0..200 {
        let case = StressCase::of(&usual.draw(&mut Random::new(7, number)), &gusty);
        let gust = case.gust.unwrap();
        assert!((0.0..=90.0).contains(&gust.start_s) && (0.0..=30.0).contains(&gust.duration_s));
        assert!(
            gust.velocity_mps
                .to_array()
                .iter()
                .all(|v| v.abs() <= 0.6 + 1e-12)
        );
    }
}
