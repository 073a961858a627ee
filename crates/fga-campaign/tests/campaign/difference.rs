//! An aircraft that differs from what the pilot knows, `[plant]`, for the oracle and in campaigns.

use std::path::Path;

use fga::Vec3;
use fga::situation::{Obstacle, ProtectedVolume};
use fga_campaign::campaign::Campaign;
use fga_campaign::campaign::file::{self, Overrides};
use fga_campaign::oracle::Judge;
use fga_files::TomlText;
use fga_formats::encounters::Encounter;
use fga_sim::vehicle_file::VehicleModel;

const VEHICLE: &str = "name = 'a'\nairspeed_mps = 20\nmax_bank_deg = 40\n[protection]\nradius_m = 60\n[response]\nbank_time_constant_s = 0.4\n";

/// The oracle knows what the aircraft can do: a slow one keeps less.
#[test]
fn the_oracle_knows_the_plant() {
    let encounter = Encounter {
        id: 1,
        obstacles: vec![Obstacle::straight(
            1,
            Vec3::new(260.0, 0.0, 0.0),
            Vec3::new(-20.0, 0.0, 0.0),
            ProtectedVolume::Sphere { radius_m: 60.0 },
        )],
    };
    let best_m = |more: &str| {
        let text = format!("{VEHICLE}{more}");
        let model = VehicleModel::parse(TomlText::new(Path::new("v.toml"), &text)).unwrap();
        Judge::new(&model, 60.0).unwrap().best_margin_m(&encounter)
    };
    let [exact_m, slow_m] = ["", "[plant]\nturn_rate_factor = 0.6\n"].map(best_m);
    assert!(slow_m < exact_m - 1.0, "{slow_m} {exact_m}");
}

/// The campaign's table is part of what makes its results, and without one nothing of it is written.
#[test]
fn a_campaign_has_a_plant_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("c.toml");
    let opened = |more: &str| {
        let text =
            format!("policies = ['none']\ncells = ['threats:1:300:15-30']\nencounters = 4\n{more}");
        std::fs::write(&path, text).unwrap();
        let configuration = file::read(&path, &Overrides::default()).map_err(|e| e.to_string())?;
        Campaign::new(configuration, &path).map_err(|error| error.to_string())
    };
    let [exact, slow] = ["", "[plant]\nturn_rate_factor = 0.9\n"].map(|more| opened(more).unwrap());
    assert_eq!(slow.world().unwrap().flies().response.turn_rate_factor, 0.9);
    assert_eq!(
        slow.world().unwrap().vehicle,
        exact.world().unwrap().vehicle
    );
    assert!(!exact.configuration.to_json().contains("plant"));
    assert_ne!(exact.configuration.hash(), slow.configuration.hash());
    let written = slow.configuration.to_json();
    assert!(
        written.contains(r#""plant":{"turn_rate_factor":0.9}"#),
        "{written}"
    );
    let error = opened("[plant]\nturn_rate_factor = 0\n").err().unwrap();
    assert!(
        error.contains("c.toml, line 5: turn_rate_factor is 0, expected"),
        "{error}"
    );
}
