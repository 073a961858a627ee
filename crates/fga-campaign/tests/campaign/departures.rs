//! How far the default policy departs from the mission, beside the oracle's safe manoeuvre of least departure.

use fga_campaign::batch::{BatchSettings, empty_world, populate};
use fga_campaign::encounters::EncounterSource;
use fga_campaign::oracle::{
    OracleObstacle, OracleSettings, OracleStart, OracleVehicle, least_departure,
};
use fga_sim::engine::Engine;
use fga_sim::policy::PolicyChoice;
use fga_sim::vehicle_file::VehicleModel;

/// Encounters of each family, as many as the published table has: one flight that departs far moves the mean of a few.
const COUNT: u64 = 40;

/// Mean of the largest departures of the policy over that of the oracle's manoeuvres.
fn ratio(cell: &str) -> f64 {
    let source = EncounterSource::parse(cell, 1).unwrap();
    let mut model = VehicleModel::built_in().unwrap();
    if source.planar {
        (model.vehicle.climb_min_rad, model.vehicle.climb_max_rad) = (0.0, 0.0);
    }
    let oracle_vehicle = OracleVehicle::from(&model.vehicle);
    let settings = BatchSettings {
        model,
        policy: PolicyChoice::default(),
        horizon_s: 300.0,
        seed: 1,
        tracks: false,
    };
    let mut world = empty_world(&settings).unwrap();
    let mut engine = Engine::new();
    let mut sum_m = [0.0, 0.0];
    for number in 0..COUNT {
        let encounter = source.encounter(number).unwrap();
        populate(&mut world, &encounter, &settings.model.protection);
        let policy = &settings.policy;
        let mut pilot = policy.pilot(&world.settings, &world.vehicle).unwrap();
        let flown = engine.fly(&world, pilot.as_mut(), &mut ());
        assert!(flown.separated(), "{cell} {number}");
        let obstacles: Vec<_> = encounter
            .obstacles
            .iter()
            .map(OracleObstacle::from)
            .collect();
        let oracle = OracleSettings::default();
        let best = least_departure(
            &OracleStart::ORIGIN,
            &oracle_vehicle,
            &obstacles,
            &oracle,
            0.05,
        );
        if let Some(best) = best {
            sum_m[0] += flown.max_cross_track_m;
            sum_m[1] += best.max_cross_track_m;
        }
    }
    sum_m[0] / sum_m[1]
}

/// Families and the most that the ratio may be. The oracle's departure does not contain the way back, in which the aircraft
/// may swing farther aside.
const MOST: [(&str, f64); 3] = [
    ("threats:1:300:15-30,planar", 1.6),
    ("threats:3:300:15-30", 1.4),
    ("threats:3:300:15-30,planar", 1.4),
];

#[test]
fn past_crossing_traffic_it_departs_little_more_than_the_oracle() {
    for (cell, most) in MOST {
        let ratio = ratio(cell);
        assert!(ratio <= most, "{cell}: {ratio}, expected at most {most}");
    }
}
