//! `fga run` over the ground of a scenario.

use std::fs;

use crate::support::{errors, fga_in, repository};

#[test]
fn a_flight_over_ground_keeps_above_it_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = repository().join("scenarios/ridge.toml");
    let arguments = ["run", scenario.to_str().unwrap(), "--out", "f"];
    let flown = fga_in(folder.path(), &arguments);
    assert_eq!(flown.status.code(), Some(0), "{}", errors(&flown));
    let words = String::from_utf8_lossy(&flown.stdout).into_owned();
    let told = "ground: least height 107.4 m at";
    assert!(words.contains(told), "{words}");
    let drawn = fs::read_to_string(folder.path().join("f/profile.svg")).unwrap();
    assert!(drawn.contains("Lowest 107.4 m above the ground"));
    // A mission through the ridge is flown; a warning comes before the flight.
    let text = fs::read_to_string(&scenario).unwrap();
    let text = text.replace(
        "../vehicles",
        repository().join("vehicles").to_str().unwrap(),
    );
    let low = text.replace(
        "[2000, 240, 180], [3000, 230, 180]",
        "[2000, 240, 180], [2600, 130, 180], [3000, 230, 180]",
    );
    let ground = repository().join("scenarios/ridge.tif");
    fs::copy(ground, folder.path().join("ridge.tif")).unwrap();
    fs::write(folder.path().join("low.toml"), low).unwrap();
    let told = "leg 3 of the mission comes as low as -";
    let checked = fga_in(folder.path(), &["check", "low.toml"]);
    let words = String::from_utf8_lossy(&checked.stdout).into_owned() + &errors(&checked);
    assert!(words.contains(told), "{words}");
    let flown = fga_in(folder.path(), &["run", "low.toml", "--json", "--out", "l"]);
    assert_eq!(flown.status.code(), Some(2), "{}", errors(&flown));
    assert!(errors(&flown).contains(told), "{}", errors(&flown));
    let summary: serde_json::Value = serde_json::from_slice(&flown.stdout).unwrap();
    let least_m = summary["min_terrain_clearance_m"].as_f64();
    assert!(least_m.unwrap() < -10.0, "{least_m:?}");
    // Other policies know none.
    let published = ["run", "low.toml", "--policy", "published", "--out", "p"];
    let flown = fga_in(folder.path(), &published);
    let told = "warning: published --start tc knows no ground, which only judges its flight";
    assert!(errors(&flown).contains(told), "{}", errors(&flown));
}
