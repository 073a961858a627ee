//! Certificates against flights from a separate integration: [`fga_sim::fine`].
//!
//! `fga-experiments certificates` compares those of drawn manoeuvres.

use std::path::Path;

use fga::Vec3;
use fga::avoider::{Avoider, Settings, Start, Verdict};
use fga::situation::{Mission, Obstacle, Obstacles, Ownship, ProtectedVolume, Situation};
use fga::vehicle::Vehicle;
use fga_sim::fine::{FineFlight, GrowingBody};
use fga_sim::policy::PolicyChoice;
use fga_sim::run;
use fga_sim::scenario;
use fga_sim::vehicle_file::VehicleModel;

use crate::data::data;
use crate::random::Random;

/// Accepted excess of the certified margin over the flown one, metres.
const ROUNDING_M: f64 = 1e-3;

/// The first decision of an avoider: the certified and the flown margin of its manoeuvre, metres.
fn first_decision(
    settings: Settings,
    vehicle: &Vehicle,
    own: Ownship,
    mission_m: &[Vec3],
    obstacles: &[Obstacle],
) -> Option<(f64, f64)> {
    let horizon_s = settings.horizon_s;
    let mut avoider = Avoider::new(settings, *vehicle).expect("accepted");
    let decision = avoider.step(&Situation {
        time_s: 0.0,
        ownship: own,
        obstacles: Obstacles::Rows(obstacles),
        mission: Mission::new(mission_m),
        wind_mps: Vec3::ZERO,
    });
    let chosen = decision.record.chosen?;
    if chosen.verdict != Verdict::Chosen {
        return None;
    }
    let bodies: Vec<GrowingBody> = obstacles
        .iter()
        .map(|obstacle| GrowingBody {
            position_m: obstacle.position_m,
            velocity_mps: obstacle.velocity_mps,
            volume: obstacle.volume,
            growth_mps: 0.0,
        })
        .collect();
    let mut flight = FineFlight::new(vehicle, Vec3::ZERO, &own, &decision.command);
    flight.fly(horizon_s);
    Some((chosen.margin_m, flight.least_margin_m(&bodies)))
}

/// An earlier version put nine stages into eight places: it dropped the avoiding turn and kept the margin.
#[test]
fn the_first_decisions_of_the_trial_missions_keep_what_they_certify() {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut decided = 0;
    for number in [25, 74, 79] {
        let Some(file) = data(&format!("trials/false-certificate-1-{number}.toml")) else {
            return;
        };
        let mut model = VehicleModel::read(&repository.join("vehicles/paper-planar.toml"))
            .expect("a vehicle of this repository");
        model.settings.avoider.surveillance_radius_m = f64::INFINITY;
        let plan = scenario::read(&file, Some(model)).expect("a scenario");
        let policy = PolicyChoice::parse("turn-aware", None).expect("a policy");
        let world = &plan.world;
        let obstacles: Vec<Obstacle> = world
            .obstacles
            .iter()
            .filter_map(|known| {
                let (position_m, velocity_mps) = known.track.at(0.0)?;
                Some(Obstacle::straight(
                    known.id,
                    position_m,
                    velocity_mps,
                    known.volume,
                ))
            })
            .collect();
        let own = Ownship {
            position_m: world.start.position_m,
            course_rad: world.start.course_rad,
            climb_rad: world.start.climb_rad,
            bank_rad: 0.0,
            airspeed_mps: world.vehicle.airspeed_mps,
        };
        let settings = Settings {
            start: Start::Free,
            ..world.settings.avoider
        };
        let first = first_decision(settings, &world.vehicle, own, &world.mission_m, &obstacles);
        if let Some((claimed_m, flown_m)) = first {
            decided += 1;
            assert!(
                claimed_m <= flown_m + ROUNDING_M,
                "{number}: {claimed_m} m certified, {flown_m} m flown"
            );
        }
        let log = run::fly(plan, &policy, &mut |_| ()).expect("it flies");
        assert!(log.outcome.separated(), "{number}: {:?}", log.outcome);
    }
    assert!(decided > 0, "nothing was decided");
}

/// The same for random missions of legs from one to three turn radii.
#[test]
fn missions_of_short_legs_keep_what_they_certify() {
    let vehicle = Vehicle::table_4().with_climb(0.0, 0.0, 0.0);
    let settings = Settings {
        surveillance_radius_m: f64::INFINITY,
        ..Settings::default()
    };
    let mut certified = 0;
    for seed in 0..400 {
        let mut random = Random(seed);
        let mut mission_m = vec![Vec3::ZERO, Vec3::new(80.0, 0.0, 0.0)];
        let mut at = Vec3::new(80.0, 0.0, 0.0);
        for k in 0..30 {
            let course = random.within(0.3, 0.9) * if k % 2 == 0 { 1.0 } else { -1.0 };
            at += Vec3::new(course.cos(), course.sin(), 0.0) * random.within(45.0, 90.0);
            mission_m.push(at);
        }
        let meets_s = random.within(15.0, 55.0);
        let heading = random.within(-3.1, 3.1);
        let velocity_mps = Vec3::new(heading.cos(), heading.sin(), 0.0) * random.within(3.0, 20.0);
        let near = Vec3::new(13.5 * meets_s, random.within(-20.0, 60.0), 0.0);
        let volume = ProtectedVolume::Sphere { radius_m: 30.0 };
        let obstacle = Obstacle::straight(1, near - velocity_mps * meets_s, velocity_mps, volume);
        let own = Ownship {
            position_m: Vec3::ZERO,
            course_rad: 0.0,
            climb_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: 15.0,
        };
        if volume.margin_m(obstacle.position_m) < 0.0 {
            continue;
        }
        let first = first_decision(settings, &vehicle, own, &mission_m, &[obstacle]);
        if let Some((claimed_m, flown_m)) = first {
            certified += 1;
            assert!(
                claimed_m <= flown_m + ROUNDING_M,
                "seed {seed}: {claimed_m} m certified, {flown_m} m flown"
            );
        }
    }
    assert!(certified > 100, "{certified} certified");
}
