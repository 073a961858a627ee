//! An aircraft and an air that differ from what the pilot knows: `[plant]`.

use std::path::Path;

use fga::Vec3;
use fga::situation::Situation;
use fga::vehicle::Vehicle;
use fga_files::TomlText;
use fga_sim::engine::{DecisionMoment, Engine, Observer, Sample};
use fga_sim::plant::PlantDifference;
use fga_sim::policy::PolicyChoice;
use fga_sim::run::Plan;
use fga_sim::scenario;
use fga_sim::vehicle_file::VehicleModel;

const VEHICLE: &str = "name = 'a'\nairspeed_mps = 20\nmax_bank_deg = 40\n[protection]\nradius_m = 60\n[response]\nbank_time_constant_s = 0.4\n";

const SCENARIO: &str = "name = 'a'\nduration_s = 90.0\n[mission]\nwaypoints_m = [[0, 0, 0], [1400, 0, 0]]\n[wind]\nnorth_mps = 3.0\n\
    [[obstacle]]\nposition_m = [600, 10, 0]\n[sensor]\n";

/// A plant of which every key differs.
const PLANT: &str = "[plant]\nturn_rate_factor = 0.85\nbank_time_constant_s = 0.9\ndead_time_s = 0.3\nairspeed_mps = 22\n\
    climb_rate_radps = 0.1\nwind_error_mps = [2, -3, 0]\n";

fn vehicle(more: &str) -> Result<VehicleModel, String> {
    let text = format!("{VEHICLE}{more}");
    let path = Path::new("v.toml");
    VehicleModel::parse(TomlText::new(path, &text)).map_err(|error| error.to_string())
}

fn plan(of_vehicle: &str, of_scenario: &str) -> Result<Plan, String> {
    let text = format!("{SCENARIO}{of_scenario}");
    let text = TomlText::new(Path::new("s.toml"), &text);
    scenario::parse(text, Some(vehicle(of_vehicle)?)).map_err(|error| error.to_string())
}

/// What a pilot is shown of the aircraft and the air, and where it flies.
#[derive(Default, PartialEq, Debug)]
struct Seen {
    shown: Vec<(f64, Vec3)>,
    flown_m: Vec<Vec3>,
}

impl Observer for Seen {
    fn watches(&self) -> bool {
        true
    }

    fn sample(&mut self, sample: &Sample) {
        self.flown_m.push(sample.position_m);
    }

    fn decision(&mut self, moment: &DecisionMoment<'_>) {
        let Situation {
            ownship, wind_mps, ..
        } = moment.situation;
        self.shown.push((ownship.airspeed_mps, *wind_mps));
    }
}

fn flown(plan: &Plan) -> Seen {
    let world = &plan.world;
    let policy = PolicyChoice::default();
    let mut pilot = policy.pilot(&world.settings, &world.vehicle).unwrap();
    let mut seen = Seen::default();
    Engine::new().fly(world, pilot.as_mut(), &mut seen);
    seen
}

/// The pilot believes the file, and the aircraft flies otherwise, whichever file says so.
#[test]
fn a_plant_flies_otherwise_than_its_pilot_believes() {
    let exact = plan("", "").unwrap();
    let [by_vehicle, by_scenario] = [plan(PLANT, "").unwrap(), plan("", PLANT).unwrap()];
    assert_eq!(by_vehicle.world, by_scenario.world);
    assert_eq!(by_vehicle.world.vehicle, exact.world.vehicle);
    let [exact, other] = [&exact, &by_vehicle].map(flown);
    assert_eq!(exact.flown_m, flown(&plan("", "").unwrap()).flown_m);
    let believed = (20.0, Vec3::new(0.0, 3.0, 0.0));
    for (airspeed_mps, wind_mps) in exact.shown.iter().chain(&other.shown) {
        assert!((airspeed_mps - believed.0).abs() < 1e-9 && *wind_mps == believed.1);
    }
    // From the first second on: 22 m/s, and another wind along the leg.
    let after = |seen: &Seen| seen.flown_m[10].x - seen.flown_m[0].x;
    assert!((after(&exact) - 19.8).abs() < 0.1, "{}", after(&exact));
    assert!((after(&other) - 23.8).abs() < 0.3, "{}", after(&other));
}

/// A key of the scenario takes the place of that of the vehicle file; what neither has is the vehicle's.
#[test]
fn a_scenario_changes_single_keys_of_the_plant() {
    let both = plan(
        "[plant]\nturn_rate_factor = 0.9\ndead_time_s = 0.2\n",
        "[plant]\nturn_rate_factor = 0.8\n",
    );
    let world = both.unwrap().world;
    assert_eq!(
        world.plant,
        PlantDifference {
            turn_rate_factor: Some(0.8),
            dead_time_s: Some(0.2),
            ..PlantDifference::NONE
        }
    );
    let flies = world.flies();
    let known = world.vehicle;
    assert_eq!(flies.response.bank_time_constant_s, 0.4);
    let back = Vehicle {
        response: known.response,
        ..flies
    };
    assert_eq!(back, known);
}

#[test]
fn wrong_keys_and_values_are_named() {
    for (table, expected) in [
        (
            "turn_rate = 1",
            "line 9: unknown field `turn_rate`, expected one of",
        ),
        (
            "turn_rate_factor = 3",
            "line 9: turn_rate_factor is 3, expected a number from 0.05 to 2",
        ),
        (
            "bank_time_constant_s = -1",
            "line 9: bank_time_constant_s is -1, expected",
        ),
        ("dead_time_s = nan", "line 9: dead_time_s is NaN, expected"),
        ("airspeed_mps = 0", "line 9: airspeed_mps is 0, expected"),
        ("wind_error_mps = [1, 2]", "line 9: "),
        (
            "wind_error_mps = [1, 2, 900]",
            "line 9: wind_error_mps is [1.0, 2.0, 900.0], expected east, north and up from -200 to 200",
        ),
    ] {
        let error = vehicle(&format!("[plant]\n{table}\n")).unwrap_err();
        assert!(error.starts_with(&format!("v.toml, {expected}")), "{error}");
        let error = plan("", &format!("[plant]\n{table}\n")).unwrap_err();
        assert!(error.starts_with("s.toml, line 11: "), "{error}");
    }
}
