//! `fga stress`: finds a fault of a program, says the same again, and says honestly what it found.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;

use crate::support::{errors, fga_in, rows};

#[test]
fn a_program_that_does_nothing_is_found_out_and_the_bytes_are_the_same_again() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    fs::write(
        place.join("idle.sh"),
        "#!/bin/sh\nwhile read -r line; do echo '{}'; done\n",
    )
    .unwrap();
    fs::set_permissions(place.join("idle.sh"), fs::Permissions::from_mode(0o755)).unwrap();
    for (out, policy, threads) in [
        ("one", "none", "1"),
        ("two", "none", "2"),
        ("own", "pipe:./idle.sh", "2"),
    ] {
        let arguments = [
            "stress",
            "--policy",
            policy,
            "--flights",
            "60",
            "--seed",
            "3",
            "--out",
            out,
            "--threads",
            threads,
        ];
        let done = fga_in(place, &arguments);
        assert!(done.status.success(), "{}", errors(&done));
    }
    for name in [
        "stress.html",
        "stress.json",
        "failures.csv",
        "replay/1.html",
    ] {
        let bytes = |out: &str| fs::read(place.join(out).join(name)).unwrap();
        assert_eq!(bytes("one"), bytes("two"), "{name}");
    }
    let failures = rows(&place.join("one/failures.csv"));
    assert!(!failures.is_empty());
    for failure in &failures {
        assert!(failure["margin_m"].parse::<f64>().unwrap() < 0.0);
    }
    // What does nothing fails in the same motions, whoever it is.
    assert_eq!(
        fs::read(place.join("one/failures.csv")).unwrap(),
        fs::read(place.join("own/failures.csv")).unwrap()
    );
    let page = fs::read_to_string(place.join("one/stress.html")).unwrap();
    for what in [
        "seed",
        "commit",
        "standard error",
        "href=\"replay/1.html\"",
        "There are no gusts",
    ] {
        assert!(page.contains(what), "{what}");
    }
}

#[test]
fn a_search_in_its_folder_goes_on_and_another_one_begins_again() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let flown = |out: &str, flights: &str, seed: &str| {
        let arguments = ["stress", "--policy", "none", "--flights", flights];
        let more = [
            "--seed",
            seed,
            "--out",
            out,
            "--intruders",
            "2",
            "--gust-mps",
            "1",
        ];
        let done = fga_in(place, &[&arguments[..], &more].concat());
        assert!(done.status.success(), "{}", errors(&done));
        ["stress.html", "stress.json", "failures.csv", "flights.csv"]
            .map(|name| fs::read_to_string(place.join(out).join(name)).unwrap())
    };
    let whole = flown("whole", "260", "3");
    flown("part", "200", "3");
    assert_eq!(flown("part", "260", "3"), whole);
    // Torn in the middle of a line, as by a kill: that flight is flown again.
    let kept = &whole[3];
    let torn = &kept[..kept.trim_end().rfind('\n').unwrap() + 3];
    fs::write(place.join("part/flights.csv"), torn).unwrap();
    assert_eq!(flown("part", "260", "3"), whole);
    // A flight that is there is not flown again: what the file says of it counts.
    let lines: Vec<&str> = kept.lines().collect();
    let mut changed = lines.clone();
    changed[2] = "-7,0";
    fs::write(place.join("part/flights.csv"), changed.join("\n") + "\n").unwrap();
    assert_ne!(flown("part", "260", "3")[1], whole[1]);
    // Another seed is another test.
    assert_eq!(flown("part", "260", "4"), flown("other", "260", "4"));
    let failures = rows(&place.join("whole/failures.csv"));
    for column in ["turn_rad_2", "gust_start_s", "gust_up_mps"] {
        assert!(failures[0].contains_key(column), "{column}");
    }
    assert!(
        whole[0].contains("intruder 2 comes at") && whole[0].contains("One gust changes the wind")
    );
}

#[test]
fn wrong_options_are_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, what) in [
        (["stress", "--flights", "0"], "0"),
        (["stress", "--kind", "balloon"], "balloon"),
        (["stress", "--intruders", "5"], "5"),
        (["stress", "--gust-mps", "many"], "expected 0 to 20 m/s"),
        (["stress", "--gust-mps", "NaN"], "expected 0 to 20 m/s"),
        (["stress", "--policy", "nobody"], "unknown policy"),
        (["stress", "--vehicle", "nothing.toml"], "nothing.toml"),
    ] {
        let done = fga_in(folder.path(), &arguments);
        assert_eq!(done.status.code(), Some(1), "{arguments:?}");
        assert!(errors(&done).contains(what), "{}", errors(&done));
        assert_eq!(errors(&done).lines().count(), 1, "{}", errors(&done));
    }
}
