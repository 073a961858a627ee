//! Wrong input and wrong usage give one sentence that says what was found and what was expected.

use std::fs;
use std::path::Path;

use crate::support::{errors, fga_in};

const ENCOUNTERS: &str = "encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m
0,0,300,0,0,-15,0,0,30
";

/// The command ends with code 1 and one sentence that holds `expected`, and prints nothing else.
fn refuses(folder: &Path, arguments: &[&str], expected: &str) {
    let output = fga_in(folder, arguments);
    let said = errors(&output);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
    assert!(said.contains(expected), "{arguments:?}: {said}");
    assert_eq!(said.trim_end().lines().count(), 1, "{arguments:?}: {said}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
}

/// `check` and `run` refuse the scenario of `fga init` for each text that takes the place of one in it, at this line.
fn refuses_scenarios(from: &str, line: u32, cases: &[(&str, &str)]) {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    assert!(fga_in(at, &["init", "scenario"]).status.success());
    let text = fs::read_to_string(at.join("scenario.toml")).unwrap();
    for (to, expected) in cases {
        let changed = text.replace(from, to);
        assert_ne!(changed, text);
        fs::write(at.join("wrong.toml"), changed).unwrap();
        for command in ["check", "run"] {
            let expected = format!("wrong.toml, line {line}: {expected}");
            refuses(at, &[command, "wrong.toml"], &expected);
        }
    }
}

#[test]
fn a_missing_file_a_folder_and_another_kind_of_file_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::create_dir(at.join("dir")).unwrap();
    fs::write(at.join("e.csv"), ENCOUNTERS).unwrap();
    fs::write(at.join("empty.toml"), "# nothing\n").unwrap();
    assert!(fga_in(at, &["init", "scenario"]).status.success());
    let no_file = "there is no such file or folder";
    for (arguments, expected) in [
        (&["check", "nope"][..], no_file),
        (&["check", "dir"], "dir: holds no recordings"),
        (&["check", "empty.toml"], "empty.toml: holds no key"),
        (&["run", "dir"], "dir: is a folder, expected a .toml"),
        (
            &["batch", "scenario.toml"],
            "scenario.toml: is a .toml file",
        ),
        (
            &["oracle", "scenario.toml"],
            "scenario.toml: is a .toml file",
        ),
        (&["view", "e.csv"], "e.csv: is a file, expected a folder"),
        (&["identify", "e.csv"], "the column t_s is missing"),
        (&["fly", "--replay", "nope.tlog"], no_file),
        (
            &["fly", "--connect", "serial:/dev/nope"],
            "fly on serial:/dev/nope:",
        ),
        (
            &["traffic", "nope.log", "--to", "udpout:127.0.0.1:9"],
            no_file,
        ),
    ] {
        refuses(at, arguments, expected);
    }
}

#[test]
fn options_say_what_they_expect() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("e.csv"), ENCOUNTERS).unwrap();
    let line = "ABC123,37,-122,100,180,25";
    for (arguments, expected) in [
        (
            &["batch", "e.csv", "--threads", "1000000"][..],
            "'1000000' for '--threads <N>': expected a whole number from 1 to 1024",
        ),
        (&["batch", "e.csv", "--threads", "0"], "from 1 to 1024"),
        (
            &["run", "scenario.toml", "--threads", "1"],
            "unexpected argument '--threads'",
        ),
        (
            &["campaign", "run", "c.toml", "--encounters", "268435457"],
            "expected a whole number from 1 to 268435456",
        ),
        (
            &["campaign", "draw", "c.toml", "--encounters", "0"],
            "expected a whole number from 1 to 268435456",
        ),
        (
            &["view", ".", "--listen", "here"],
            "expected ADDRESS:PORT, as in 127.0.0.1:8787",
        ),
        (&["traffic"], "expected a FILE or --line"),
        (&["traffic", "--line", line], "expected --to or --serve-sbs"),
        (
            &["emulate", "--fly", "--serve", "udpout:127.0.0.1:14998"],
            "expected --serve tcpin:HOST:PORT",
        ),
        (&["emulate", "--seconds", "0"], "--seconds must be above 0"),
        (&["emulate", "--intruder", "x"], "is no line"),
        (
            &["traffic", "--line", line, "--serve-sbs", "foo"],
            "'foo' for '--serve-sbs <HOST:PORT>': expected HOST:PORT",
        ),
    ] {
        refuses(at, arguments, expected);
    }
    // In JSON the sentence is in the answer, as that of a file is.
    for (arguments, expected) in [
        (
            &["run", "s.toml", "--threads", "1", "--json"][..],
            "unexpected argument '--threads'",
        ),
        (
            &["batch", "e.csv", "--policy", "nobody", "--json"],
            "unknown policy \"nobody\"",
        ),
        (&["nothing", "--json"], "unrecognized subcommand 'nothing'"),
    ] {
        let output = fga_in(at, arguments);
        assert_eq!(output.status.code(), Some(1));
        let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let said = answer["error"].as_str().unwrap();
        assert!(said.contains(expected), "{arguments:?}: {said}");
        assert_eq!(errors(&output).trim_end(), format!("fga: {said}"));
    }
    assert!(!at.join("out").exists(), "nothing is written");
}

#[test]
fn numbers_and_seeds_of_a_campaign_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    assert!(fga_in(at, &["init", "campaign"]).status.success());
    let text = fs::read_to_string(at.join("campaign.toml")).unwrap();
    for (from, to, expected) in [
        (
            "encounters = 2_000",
            "encounters = 0",
            "line 5: encounters is 0, expected 1 to 268435456",
        ),
        (
            "seeds = [1]",
            "seeds = [3, 1, 3]",
            "line 6: seed 3 is named twice, expected each once",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        fs::write(at.join("wrong.toml"), text.replace(from, to)).unwrap();
        refuses(at, &["check", "wrong.toml"], expected);
        refuses(at, &["campaign", "run", "wrong.toml"], expected);
    }
}

#[test]
fn check_takes_the_largest_seed_as_run_does() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    assert!(fga_in(at, &["init", "scenario"]).status.success());
    let text = fs::read_to_string(at.join("scenario.toml")).unwrap();
    let with = |seed: &str| text.replace("seed = 1\n", &format!("seed = {seed}\n"));
    fs::write(at.join("largest.toml"), with("18446744073709551615")).unwrap();
    fs::write(at.join("beyond.toml"), with("18446744073709551616")).unwrap();
    let checked = fga_in(at, &["check", "largest.toml"]);
    assert!(checked.status.success(), "{}", errors(&checked));
    for command in ["check", "run"] {
        refuses(
            at,
            &[command, "beyond.toml"],
            "beyond.toml, line 8: the number is too large, expected at most 18446744073709551615",
        );
    }
}

#[test]
fn a_waypoint_with_too_few_numbers_is_named_in_plain_words() {
    let cases = [
        ("[\n[0, 0],", "found a list of 2 values, expected 3"),
        ("[\n[0],", "found a list of 1 value, expected 3"),
    ];
    refuses_scenarios("[[0, 0, 100],", 21, &cases);
}

#[test]
fn a_place_that_is_no_number_is_named_with_what_it_holds() {
    let cases = [
        (
            "[NaN, 10, 60]",
            "found no number, expected a finite number or a word in quotes",
        ),
        (
            "[nan, 10, 60]",
            "position_m is [NaN, 10, 60], expected three finite numbers within 10,000 km",
        ),
        (
            "[7e9, 10, 60]",
            "position_m is [7000000000, 10, 60], expected three finite numbers within 10,000 km",
        ),
    ];
    refuses_scenarios("[700, 10, 60]", 31, &cases);
}

#[test]
fn one_thing_is_counted_in_the_singular() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("e.csv"), ENCOUNTERS).unwrap();
    fs::write(
        at.join("c.toml"),
        "policies = ['none']\nfiles = ['e.csv']\n",
    )
    .unwrap();
    for (file, expected) in [
        ("e.csv", ": 1 encounter, 1 obstacle\n"),
        ("c.toml", ": 1 encounter from 1 source, 1 policy, vehicle "),
    ] {
        let output = fga_in(at, &["check", file]);
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(said.contains(expected), "{said}{}", errors(&output));
    }
}

#[test]
fn every_table_of_a_link_file_shows_its_kind() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("fly.toml"),
        "[alerts]\nlevels = \"f3442\"\n",
    )
    .unwrap();
    let output = fga_in(folder.path(), &["check", "fly.toml"]);
    assert!(output.status.success(), "{}", errors(&output));
}

#[test]
fn a_value_of_a_link_file_out_of_range_is_named_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (text, expected) in [
        (
            "[vehicle]\nmax_bank_deg = 40\n\n[protection] # metres\nradius_m = -1\n",
            "fly.toml, line 5: protection.radius_m is -1, expected 1 to 5000",
        ),
        (
            "# here\nlimits.floor_m = -3\n",
            "fly.toml, line 2: limits.floor_m is -3, expected 0 to 10000",
        ),
        (
            "[vehicle]\ntake_over = [\"LOITER\"]\n",
            "fly.toml, line 2: vehicle.take_over: 'LOITER' cannot be taken over",
        ),
    ] {
        fs::write(at.join("fly.toml"), text).unwrap();
        refuses(at, &["check", "fly.toml"], expected);
    }
}

#[test]
fn the_help_names_the_exit_codes_and_the_keys_of_rc() {
    let folder = tempfile::tempdir().unwrap();
    let help = |arguments: &[&str]| {
        let output = fga_in(folder.path(), arguments);
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    assert!(help(&["--help"]).contains("Exit codes: 0 done"));
    assert!(help(&["rc", "--help"]).contains("releases the channels"));
}

/// Every `fga` command in a block of the page is a command, and its options are options of it.
#[test]
fn n9_the_commands_of_the_how_to_are_known() {
    let page = include_str!("../../../../docs/how-to-arduplane.md");
    let commands = page.lines().filter_map(|line| line.strip_prefix("fga "));
    let mut count = 0;
    for command in commands {
        let mut words = command.split_whitespace();
        let name = words.next().unwrap();
        let output = fga_in(Path::new("."), &[name, "--help"]);
        assert!(output.status.success(), "{command}");
        let help = String::from_utf8(output.stdout).unwrap();
        for option in words.filter(|word| word.starts_with("--")) {
            assert!(help.contains(option), "{command}: {option}");
        }
        count += 1;
    }
    assert!(count >= 4, "{count} commands");
}
