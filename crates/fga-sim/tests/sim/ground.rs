//! Terrain of scenarios: what is refused, and the valley that comes with them.

/// A scenario with a table of terrain, and the error about it.
fn refused(origin: &str, table: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let scenario = folder.path().join("a.toml");
    std::fs::write(folder.path().join("none.tif"), "no heights").unwrap();
    let text = format!(
        "name = 'a'\nduration_s = 60.0\n{origin}\n[mission]\nwaypoints_m = [[0, 0, 0], [900, 0, 0]]\n[terrain]\n{table}\n"
    );
    std::fs::write(&scenario, text).unwrap();
    let told = fga_sim::scenario::read(&scenario, None)
        .unwrap_err()
        .to_string();
    assert!(!told.contains('\n'), "{told}");
    told
}

#[test]
fn a_wrong_table_of_terrain_is_refused_in_a_sentence() {
    let origin = "[origin]\nlatitude_deg = 47.0\nlongitude_deg = 8.0\naltitude_m = 400.0";
    for (origin, table, expected) in [
        (
            "",
            "file = 'none.tif'\nclearance_m = 50.0",
            "expected an [origin]",
        ),
        (
            origin,
            "file = 'missing.tif'\nclearance_m = 50.0",
            "there is no such file",
        ),
        (origin, "file = 'none.tif'\nclearance_m = 50.0", "none.tif"),
        (origin, "file = []\nclearance_m = 50.0", "has no file"),
        (
            origin,
            "file = 3\nclearance_m = 50.0",
            "a file of heights or a list of files",
        ),
        (
            origin,
            "file = 'none.tif'\nclearance_m = -1.0",
            "clearance_m",
        ),
        (origin, "file = 'none.tif'", "clearance_m"),
    ] {
        let told = refused(origin, table);
        assert!(told.contains(expected), "{told}");
    }
}

#[test]
fn the_valley_of_the_scenarios_is_read_and_cleared() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/ridge.toml");
    let plan = fga_sim::scenario::read(folder.as_ref(), None).unwrap();
    assert_eq!(plan.warnings(), Vec::<String>::new());
    let ground = plan.world.ground.as_ref().unwrap();
    assert!(ground.error_m() >= 5.0 && ground.clearance_m() == 50.0);
    // The warning of a mission that is 100 m lower comes before the flight, and names the lowest leg: beside the ridge.
    let text = std::fs::read_to_string(folder)
        .unwrap()
        .replace(", 180]", ", 80]");
    let text = fga_files::TomlText::new(folder.as_ref(), &text);
    let plan = fga_sim::scenario::parse(text, None).unwrap();
    let told = plan.warnings();
    let is_told = |words: &String| {
        words.contains(
            "leg 3 of the mission comes as low as 6.5 m above the ground, the lowest of 4 that",
        )
    };
    assert!(told.iter().any(is_told), "{told:?}");
}
