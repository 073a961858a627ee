//! Encounters that an earlier version lost although the oracle saves them: the policy saves each, and
//! the aircraft comes back after each.

use std::path::Path;

use fga::avoider::Start;
use fga_campaign::batch::{BatchSettings, fly_all};
use fga_formats::encounters;
use fga_sim::policy::PolicyChoice;
use fga_sim::vehicle_file::VehicleModel;

fn fly(file: &str, planar: bool) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(file);
    let encounters = encounters::read(&path).unwrap();
    let mut model = VehicleModel::built_in().unwrap();
    model.settings.avoider.surveillance_radius_m = f64::INFINITY;
    if planar {
        (model.vehicle.climb_min_rad, model.vehicle.climb_max_rad) = (0.0, 0.0);
    }
    let settings = BatchSettings {
        model,
        policy: PolicyChoice::Avoider(Start::Free),
        horizon_s: 120.0,
        seed: 0,
        tracks: false,
    };
    let mut lost = Vec::new();
    fly_all::<()>(&encounters.into(), &settings, |row| {
        if !row.outcome.separated() {
            lost.push(format!(
                "{}: {:.3} m",
                row.encounter, row.outcome.min_margin_m
            ));
        } else if row.outcome.rejoined_s.is_none() {
            lost.push(format!("{}: never back", row.encounter));
        }
        Ok(())
    })
    .unwrap();
    assert!(lost.is_empty(), "{file}: {lost:?}");
}

#[test]
fn in_space() {
    fly("lost-once.csv", false);
}

#[test]
fn in_the_plane() {
    fly("lost-once-planar.csv", true);
}

#[test]
fn d11_a_pincer_of_two_is_kept_from_its_first_step() {
    fly("pincer.csv", false);
}
