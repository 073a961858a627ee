//! `fga run` over the ground of a scenario.

use std::fs;

use crate::support::{errors, fga_in, repository, rows};

#[test]
fn a_flight_over_ground_keeps_above_it_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = repository().join("scenarios/ridge.toml");
    let arguments = ["run", scenario.to_str().unwrap(), "--out", "f"];
    let flown = fga_in(folder.path(), &arguments);
    assert_eq!(flown.status.code(), Some(0), "{}", errors(&flown));
    let words = String::from_utf8_lossy(&flown.stdout).into_owned();
    let page = fs::read_to_string(repository().join("docs/how-to-terrain.md")).unwrap();
    let is_quoted = |line: &&str| line.starts_with("N303 ") || line.starts_with("ground: least");
    let quoted: Vec<&str> = page.lines().filter(is_quoted).collect();
    assert_eq!(quoted.len(), 2);
    for line in quoted {
        assert!(words.contains(line), "{line}: {words}");
    }
    let told = words.split_once("ground: least height ").unwrap().1;
    let told = told.split_once(" m at").unwrap().0;
    let told_m: f64 = told.parse().unwrap();
    // The clearance and the vertical error that the scenario asks for.
    assert!(told_m >= 55.0, "{words}");
    let drawn = fs::read_to_string(folder.path().join("f/profile.svg")).unwrap();
    assert!(drawn.contains(&format!("Lowest {told} m above the ground")));
    // Its export has the height above the ground of each place of the track.
    let exported = fga_in(folder.path(), &["export", "f", "--format", "geojson"]);
    assert_eq!(exported.status.code(), Some(0), "{}", errors(&exported));
    let map = fs::read(folder.path().join("f/flight.geojson")).unwrap();
    let map: serde_json::Value = serde_json::from_slice(&map).unwrap();
    let features = map["features"].as_array().unwrap().iter();
    let above_m = features.filter_map(|feature| feature["properties"]["above_ground_m"].as_array());
    let above_m = above_m.flatten().filter_map(serde_json::Value::as_f64);
    let least_m = above_m.fold(f64::INFINITY, f64::min);
    assert!((least_m - told_m).abs() < 0.1, "{least_m}");
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

#[test]
fn a_campaign_in_valleys_says_what_each_flight_keeps_and_shows_it_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let campaign = repository().join("campaigns/valleys.toml");
    let campaign = campaign.to_str().unwrap();
    let run = |arguments: &[&str]| {
        let output = fga_in(at, arguments);
        assert!(output.status.success(), "{}", errors(&output));
    };
    run(&[
        "campaign",
        "run",
        campaign,
        "--encounters",
        "24",
        "--oracle",
        "--csv",
        "--out",
        "all",
    ]);
    let flown = rows(&at.join("all/results.csv"));
    assert_eq!(flown.len(), 24);
    for row in &flown {
        let number = |name: &str| row[name].parse::<f64>().ok();
        let (ground_m, zone_m) = (
            number("min_terrain_clearance_m"),
            number("min_zone_margin_m"),
        );
        if row["source"].starts_with("corridor") {
            assert!(ground_m.is_none() && zone_m.unwrap() >= 0.0, "{row:?}");
        } else {
            // The clearance and the error of the drawn ground.
            assert!(
                zone_m.is_none() && ground_m.unwrap() >= 25.0 - 1e-3,
                "{row:?}"
            );
        }
        assert_eq!(row["avoidable"], "true", "{row:?}");
    }
    for number in ["1", "4", "7", "10"] {
        run(&[
            "campaign",
            "show",
            "all",
            "--encounter",
            number,
            "--out",
            number,
        ]);
        let alone = fs::read_to_string(at.join(number).join("run.json")).unwrap();
        let alone: serde_json::Value = serde_json::from_str(&alone).unwrap();
        let row = flown.iter().find(|row| row["encounter"] == number).unwrap();
        for (name, alone) in [
            ("min_margin_m", &alone["min_margin_m"]),
            ("min_terrain_clearance_m", &alone["min_terrain_clearance_m"]),
        ] {
            let together = row[name].parse::<f64>().ok();
            let apart_m = alone.as_f64().unwrap_or(0.0) - together.unwrap_or(0.0);
            assert!(apart_m.abs() < 1e-6, "{number} {name}");
        }
    }
    // Another campaign has no such columns, and a table of encounters no ground.
    let other = repository().join("campaigns/table4-static.toml");
    let other = other.to_str().unwrap();
    run(&[
        "campaign",
        "run",
        other,
        "--encounters",
        "2",
        "--csv",
        "--out",
        "other",
    ]);
    assert!(!rows(&at.join("other/results.csv"))[0].contains_key("min_zone_margin_m"));
}
