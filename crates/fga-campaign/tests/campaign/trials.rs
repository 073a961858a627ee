//! Cases that an earlier version lost although an exhaustive search saves them: the policy saves each, and
//! the aircraft comes back after each.

use std::path::{Path, PathBuf};

use fga::Vec3;
use fga::avoider::{Start, State};
use fga_campaign::batch::{BatchSettings, fly_all};
use fga_formats::encounters;
use fga_sim::policy::PolicyChoice;
use fga_sim::run;
use fga_sim::scenario;
use fga_sim::vehicle_file::VehicleModel;

use crate::data::data;

/// A file of the trials, or `None` without the data on this machine.
fn trial(name: &str) -> Option<PathBuf> {
    data(&format!("trials/{name}"))
}

fn vehicle(name: &str) -> VehicleModel {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    VehicleModel::read(&repository.join("vehicles").join(name)).unwrap()
}

/// Flies some encounters of a file and checks that each is saved and ends back on the mission.
fn fly(file: &str, numbers: &[u64], model: VehicleModel, horizon_s: f64) {
    let Some(path) = trial(file) else { return };
    let mut encounters = encounters::read(&path).unwrap();
    encounters.retain(|encounter| numbers.contains(&encounter.id));
    assert_eq!(encounters.len(), numbers.len(), "{file}");
    let settings = BatchSettings {
        model,
        policy: PolicyChoice::Avoider(Start::Free),
        horizon_s,
        seed: 0,
        tracks: false,
    };
    let mut wrong = Vec::new();
    fly_all::<()>(&encounters.into(), &settings, |row| {
        let number = row.encounter;
        let outcome = &row.outcome;
        if !outcome.separated() {
            wrong.push(format!("{number}: {:.3} m", outcome.min_margin_m));
        } else if outcome.start_s.is_some() && outcome.rejoined_s.is_none() {
            wrong.push(format!("{number}: never back"));
        }
        Ok(())
    })
    .unwrap();
    assert!(wrong.is_empty(), "{file}: {wrong:?}");
}

/// An earlier version stopped the full search a quarter of a second after its first failure.
#[test]
fn a_search_goes_on_while_nothing_is_certified() {
    fly("pincer4.csv", &[35], vehicle("paper.toml"), 60.0);
}

/// The same; an earlier version also gave up certificates for ever smaller margins.
#[test]
fn a_gap_between_many_is_found_and_kept() {
    let numbers = [278, 288, 461, 589, 698, 703];
    fly(
        "squeeze-pl.csv",
        &numbers,
        vehicle("paper-planar.toml"),
        120.0,
    );
}

#[test]
fn encounters_found_by_climbing_to_the_worst_are_saved() {
    let numbers = [8, 23, 44, 45];
    fly(
        "hill-pl-0.csv",
        &numbers,
        vehicle("paper-planar.toml"),
        240.0,
    );
}

/// The saving manoeuvre first waits for 10 s.
#[test]
fn a_formation_is_left_behind_in_bounded_time() {
    let numbers = [49, 58, 94, 200, 218, 222, 414, 440, 534, 567];
    fly(
        "formation.csv",
        &numbers,
        vehicle("paper-planar.toml"),
        420.0,
    );
}

#[test]
fn a_wind_of_70_percent_of_the_airspeed_from_any_side_leaves_a_way() {
    for eighth in 0..8 {
        let (sin, cos) = (f64::from(eighth) * core::f64::consts::FRAC_PI_4).sin_cos();
        let mut model = vehicle("paper-planar.toml");
        model.wind_mps = Vec3::new(10.5 * cos, 10.5 * sin, 0.0);
        fly("wind-0.7-pl.csv", &[127], model, 120.0);
    }
}

/// In a headwind of 70 % of the airspeed an earlier version remembered no tried manoeuvre and was not past
/// the sphere after 600 s.
#[test]
fn a_sphere_ahead_in_a_strong_headwind_is_passed() {
    let Some(path) = trial("wind70-livelock-4.toml") else {
        return;
    };
    let plan = scenario::read(&path, Some(vehicle("paper-planar.toml"))).unwrap();
    let log = run::fly(plan, &PolicyChoice::Avoider(Start::Free), &mut |_| ()).unwrap();
    assert!(log.outcome.separated(), "{:?}", log.outcome);
    let back = log
        .samples
        .iter()
        .rfind(|sample| sample.state != State::Cruise)
        .map_or(0.0, |sample| sample.time_s);
    assert!(back < 400.0, "last away from the mission at {back} s");
}
