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
        "Gusts are not searched",
    ] {
        assert!(page.contains(what), "{what}");
    }
}

#[test]
fn wrong_options_are_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, what) in [
        (["stress", "--flights", "0"], "0"),
        (["stress", "--kind", "balloon"], "balloon"),
        (["stress", "--policy", "nobody"], "unknown policy"),
        (["stress", "--vehicle", "nothing.toml"], "nothing.toml"),
    ] {
        let done = fga_in(folder.path(), &arguments);
        assert_eq!(done.status.code(), Some(1), "{arguments:?}");
        assert!(errors(&done).contains(what), "{}", errors(&done));
        assert_eq!(errors(&done).lines().count(), 1, "{}", errors(&done));
    }
}
