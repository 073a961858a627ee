//! The campaign of flown encounters against a script that shares no code: `tests/recompute/flown.py`.

mod support;

use std::process::Command;

use support::{data, errors, fga_in, repository};

const CAMPAIGN: &str = "name = 'flown'\npolicies = ['turn-aware']\n";
const POLICY: &str = "turn-aware";

#[test]
fn the_numbers_of_flown_encounters_are_those_of_a_script_that_reads_the_tracks() {
    let Some(recordings) = data("flown") else {
        return;
    };
    let vehicle = repository().join("vehicles/general-aviation-well-clear.toml");
    let vehicle = vehicle.to_str().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let campaign = format!("{CAMPAIGN}vehicle = '{vehicle}'\n");
    std::fs::write(at.join("flown.toml"), campaign).unwrap();
    let recordings = recordings.canonicalize().unwrap();
    let from = recordings.to_str().unwrap();
    let run = [
        "campaign",
        "run",
        "flown.toml",
        "--recordings",
        from,
        "--csv",
        "--out",
        "campaign",
    ];
    let output = fga_in(at, &run);
    assert!(output.status.success(), "{}", errors(&output));
    for entry in recordings.read_dir().unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|is| is == "daa") {
            let out = format!("runs/{}", path.file_stem().unwrap().to_str().unwrap());
            let recording = path.to_str().unwrap();
            let options = ["--policy", POLICY, "--vehicle", vehicle, "--out", &out];
            // 2 is the exit code of a flight that entered a volume.
            let output = fga_in(at, &[&["run", recording][..], &options[..]].concat());
            assert!(
                matches!(output.status.code(), Some(0 | 2)),
                "{}",
                errors(&output)
            );
        }
    }
    let output = Command::new("python3")
        .arg(repository().join("tests/recompute/flown.py"))
        .args([&recordings, &at.join("campaign"), &at.join("runs")])
        .arg(POLICY)
        .output()
        .expect("python3 is installed");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", errors(&output));
    assert!(said.contains("; 0 differences"), "{said}");
}
