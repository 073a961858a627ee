//! `fga campaign`: the same bytes on any number of threads, in parts, and after a kill; and its
//! messages about unusable input.

use core::time::Duration;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::support::{self, errors, fga_in, interrupt};

/// Two quick policies; 600 encounters are three blocks.
const CAMPAIGN: &str = r#"
name = "small"
encounters = 600
seeds = [3, 4]
policies = ["none", "published --start t0"]
horizon_s = 20

[[grid]]
family = "threats"
count = [1, 2]
first_seen_m = [300]
speed_mps = [[15, 30], 0]
"#;

fn written() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("small.toml"), CAMPAIGN).unwrap();
    folder
}

/// Runs the campaign and expects success.
fn campaign(folder: &Path, arguments: &[&str]) {
    let output = fga_in(
        folder,
        &[&["campaign", "run", "small.toml"], arguments].concat(),
    );
    assert!(output.status.success(), "{}", errors(&output));
}

fn results(folder: &Path, out: &str) -> Vec<u8> {
    fs::read(folder.join(out).join("results.parquet")).unwrap()
}

#[test]
fn the_same_bytes_on_one_and_two_threads_and_in_four_parts() {
    let folder = written();
    let at = folder.path();
    campaign(at, &["--threads", "1", "--out", "one", "--csv"]);
    campaign(at, &["--threads", "2", "--out", "two", "--resume"]);
    for part in ["1", "2", "3", "4"] {
        campaign(
            at,
            &[
                "--shard",
                &format!("{part}/4"),
                "--out",
                &format!("part{part}"),
            ],
        );
    }
    let merge = [
        "campaign", "merge", "part1", "part2", "part3", "part4", "--out", "merged",
    ];
    let output = fga_in(at, &merge);
    assert!(output.status.success(), "{}", errors(&output));
    assert!(results(at, "one") == results(at, "two"));
    assert!(results(at, "one") == results(at, "merged"));
    for file in ["summary.csv", "summary.json", "campaign.json"] {
        let text = |out: &str| fs::read_to_string(at.join(out).join(file)).unwrap();
        assert_eq!(text("one"), text("two"), "{file}");
        assert_eq!(text("one"), text("merged"), "{file}");
    }
    let csv = fs::read_to_string(at.join("one/results.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 2 * 600);
    // A missing part, and a part named twice.
    let output = fga_in(
        at,
        &["campaign", "merge", "part1", "part3", "--out", "less"],
    );
    assert_eq!(output.status.code(), Some(1));
    assert!(
        errors(&output).contains("not complete"),
        "{}",
        errors(&output)
    );
    assert!(!at.join("less/results.parquet").exists());
    let output = fga_in(
        at,
        &["campaign", "merge", "part1", "part1", "--out", "less"],
    );
    assert_eq!(output.status.code(), Some(1));
    assert!(errors(&output).contains("twice"), "{}", errors(&output));
    // A finished campaign and a finished part say that nothing is left.
    for (out, shard) in [("one", "1/1"), ("part1", "1/4")] {
        let again = [
            "campaign",
            "run",
            "small.toml",
            "--out",
            out,
            "--shard",
            shard,
            "--resume",
        ];
        let output = fga_in(at, &again);
        assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
        let expected = format!("nothing is left to fly: {out} holds every encounter\n");
        assert_eq!(errors(&output), expected);
    }
}

/// The number of encounters that standard error expects before its first line of progress.
fn expected(output: &std::process::Output) -> Option<u64> {
    let text = errors(output);
    let first = text.lines().next()?.strip_prefix("expected: ")?;
    let (before, _) = first.split_once(" encounters, ")?;
    let processor = first.contains(" of processor time (by a sample of ");
    before
        .rsplit_once(' ')
        .filter(|_| processor)?
        .1
        .parse()
        .ok()
}

#[test]
fn the_duration_is_expected_before_the_encounters_that_are_left() {
    let folder = written();
    let at = folder.path();
    let run = |arguments: &[&str]| {
        let output = fga_in(
            at,
            &[&["campaign", "run", "small.toml"], arguments].concat(),
        );
        assert!(output.status.success(), "{}", errors(&output));
        output
    };
    assert_eq!(expected(&run(&["--out", "whole"])), Some(600));
    // Three blocks of 256, 256 and 88: the second part has the second one, and flies the rest after a loss.
    assert_eq!(
        expected(&run(&["--shard", "1/2", "--out", "part"])),
        Some(256 + 88)
    );
    let lost = blocks(&at.join("part"));
    fs::remove_file(lost.iter().max().unwrap()).unwrap();
    assert_eq!(
        expected(&run(&["--shard", "1/2", "--out", "part", "--resume"])),
        Some(88)
    );
    // Too few for a sample.
    assert_eq!(
        expected(&run(&["--encounters", "19", "--out", "few"])),
        None
    );
}

#[test]
fn an_encounter_shown_alone_is_the_one_of_the_table() {
    let folder = written();
    let at = folder.path();
    campaign(at, &["--out", "all", "--csv"]);
    let csv = fs::read_to_string(at.join("all/results.csv")).unwrap();
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap();
    for (number, policy) in [("7", "none"), ("401", "published --start t0")] {
        let row: Vec<&str> = csv
            .lines()
            .map(|line| line.split(',').collect::<Vec<_>>())
            .find(|row| row[0] == number && row[column("policy")] == policy)
            .unwrap();
        let arguments = [
            "campaign",
            "show",
            "all",
            "--encounter",
            number,
            "--policy",
            policy,
            "--out",
            "alone",
        ];
        let output = fga_in(at, &arguments);
        assert!(output.status.success(), "{}", errors(&output));
        let run = fs::read_to_string(at.join("alone/run.json")).unwrap();
        let run: serde_json::Value = serde_json::from_str(&run).unwrap();
        for name in ["min_margin_m", "min_separation_m", "end_s", "extra_path_m"] {
            let alone = run[name].as_f64().unwrap();
            let together: f64 = row[column(name)].parse().unwrap();
            assert!(
                (alone - together).abs() < 1e-6,
                "{name}: {alone} {together}"
            );
        }
        for file in ["track.csv", "events.jsonl", "overview.svg", "replay.html"] {
            assert!(at.join("alone").join(file).exists(), "{file}");
        }
    }
    let output = fga_in(at, &["campaign", "show", "all", "--encounter", "600"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        errors(&output).contains("expected 0 to 599"),
        "{}",
        errors(&output)
    );
}

#[test]
fn events_of_chosen_encounters_are_logged_whole_and_in_parts() {
    let folder = written();
    let at = folder.path();
    let chosen = CAMPAIGN.replace("horizon_s", "events = [7, 401]\nhorizon_s");
    fs::write(at.join("small.toml"), &chosen).unwrap();
    campaign(at, &["--out", "all"]);
    for part in ["1/2", "2/2"] {
        campaign(at, &["--shard", part, "--out", &part[..1]]);
    }
    let output = fga_in(at, &["campaign", "merge", "1", "2", "--out", "merged"]);
    assert!(output.status.success(), "{}", errors(&output));
    let text = |path: &str| fs::read_to_string(at.join(path)).unwrap();
    for file in ["7-none", "7-published-t0", "401-none", "401-published-t0"] {
        let events = text(&format!("all/events/{file}.jsonl"));
        assert_eq!(events, text(&format!("merged/events/{file}.jsonl")));
        for line in events.lines() {
            serde_json::from_str::<serde_json::Value>(line).unwrap();
        }
    }
    let show = ["campaign", "show", "all", "--encounter", "401", "--out"];
    let policy = ["alone", "--policy", "published --start t0"];
    assert!(fga_in(at, &[&show[..], &policy].concat()).status.success());
    assert_eq!(
        text("all/events/401-published-t0.jsonl"),
        text("alone/events.jsonl")
    );
    // Logging does not change the results.
    fs::write(at.join("small.toml"), CAMPAIGN).unwrap();
    campaign(at, &["--out", "without"]);
    assert!(results(at, "all") == results(at, "without"));
}

/// Runs the program with `arguments` and files of at most `blocks` times 512 bytes: to the program that
/// is a full disk, a write that fails.
#[cfg(unix)]
fn with_small_files(at: &Path, blocks: u32, arguments: &[&str]) -> std::process::Output {
    Command::new("sh")
        .current_dir(at)
        .arg("-c")
        .arg(format!(
            "trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\""
        ))
        .arg(env!("CARGO_BIN_EXE_fga"))
        .args(arguments)
        .output()
        .unwrap()
}

#[cfg(unix)]
#[test]
fn a_full_disk_loses_nothing_that_was_finished() {
    let folder = written();
    let at = folder.path();
    campaign(at, &["--out", "once"]);
    let run = ["campaign", "run", "small.toml", "--out", "full", "--resume"];
    // Room for the single blocks but not for the table of all.
    let room = u32::try_from(results(at, "once").len() / 512 * 3 / 4).unwrap();
    let output = with_small_files(at, room, &run);
    assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
    let error = errors(&output);
    assert!(
        error.contains("results.parquet") && !error.contains("panicked"),
        "{error}"
    );
    let there = blocks(&at.join("full"));
    assert_eq!(there.len(), 3, "{error}");
    assert!(!at.join("full/results.parquet").exists());
    // Room for no block: the existing ones stay.
    fs::remove_file(&there[1]).unwrap();
    let output = with_small_files(at, 8, &run);
    assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
    assert!(errors(&output).contains("blocks"), "{}", errors(&output));
    assert_eq!(blocks(&at.join("full")).len(), 2);
    // Room again.
    campaign(at, &["--out", "full", "--resume"]);
    assert!(results(at, "once") == results(at, "full"));
}

fn blocks(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder.join("blocks")).map_or_else(
        |_| Vec::new(),
        |entries| {
            entries
                .map(|entry| entry.unwrap().path())
                .filter(|path| path.extension().is_some_and(|e| e == "parquet"))
                .collect()
        },
    )
}

/// Starts a campaign of some encounters in `out` and kills it once it has more than `finished` blocks; returns whether
/// it was still running.
fn kill_after(at: &Path, encounters: &str, out: &str, finished: usize) -> bool {
    let mut running = Command::new(env!("CARGO_BIN_EXE_fga"))
        .current_dir(at)
        .args([
            "campaign",
            "run",
            "small.toml",
            "--encounters",
            encounters,
            "--resume",
        ])
        .args(["--threads", "1", "--out", out])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    loop {
        if running.try_wait().unwrap().is_some() {
            return false;
        }
        if blocks(&at.join(out)).len() > finished {
            running.kill().unwrap();
            running.wait().unwrap();
            return true;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn killed_and_resumed_it_ends_with_the_same_bytes() {
    let folder = written();
    let at = folder.path();
    let kill = |encounters: &str, out: &str| {
        let there = blocks(&at.join(out)).len();
        let is_killed = kill_after(at, encounters, out, there);
        let finished = at.join(out).join("results.parquet");
        assert!(blocks(&at.join(out)).len() > there || finished.exists());
        is_killed
    };
    // On a busy machine a short campaign is done before the test looks at it again.
    let longer = ["3000", "30000", "300000"];
    let encounters = longer.into_iter().find(|count| kill(count, count));
    let encounters = encounters.expect("a campaign that can be killed");
    fs::rename(at.join(encounters), at.join("killed")).unwrap();
    for _ in 0..4 {
        kill(encounters, "killed");
    }
    campaign(at, &["--encounters", encounters, "--out", "once"]);
    // The leftovers of a killed program go away.
    if at.join("killed/blocks").exists() {
        fs::write(at.join("killed/blocks/.block-left.part"), "half").unwrap();
    }
    campaign(
        at,
        &["--encounters", encounters, "--out", "killed", "--resume"],
    );
    assert!(results(at, "once") == results(at, "killed"));
    assert!(!at.join("killed/blocks").exists());
}

#[test]
fn a_damaged_block_is_named_and_the_rest_is_kept() {
    let folder = written();
    let at = folder.path();
    campaign(at, &["--shard", "1/2", "--out", "part"]);
    let files = blocks(&at.join("part"));
    let damaged = files.first().unwrap();
    let mut bytes = fs::read(damaged).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x40;
    fs::write(damaged, bytes).unwrap();
    let name = damaged.file_name().unwrap().to_string_lossy().into_owned();
    let again = [
        "campaign",
        "run",
        "small.toml",
        "--shard",
        "1/2",
        "--out",
        "part",
        "--resume",
    ];
    let output = fga_in(at, &again);
    assert_eq!(output.status.code(), Some(1));
    assert!(errors(&output).contains(&name) && errors(&output).contains("damaged"));
    assert_eq!(blocks(&at.join("part")).len(), files.len());
    fs::remove_file(damaged).unwrap();
    assert!(fga_in(at, &again).status.success());
    assert_eq!(blocks(&at.join("part")).len(), files.len());
}

#[test]
fn unusable_campaigns_are_refused_in_one_sentence() {
    let folder = written();
    let at = folder.path();
    let changed = |from: &str, to: &str| {
        assert!(CAMPAIGN.contains(from), "{from}");
        fs::write(at.join("other.toml"), CAMPAIGN.replace(from, to)).unwrap();
        let output = fga_in(at, &["campaign", "run", "other.toml", "--out", "other"]);
        assert_eq!(output.status.code(), Some(1), "{to}");
        assert!(!at.join("other/results.parquet").exists());
        errors(&output)
    };
    for (from, to, told) in [
        ("\"none\"", "\"nobody\"", "unknown policy \"nobody\""),
        ("count = [1, 2]", "count = []", "line 10: count is empty"),
        ("encounters = 600", "encounters = 0", "encounters is 0"),
        (
            "encounters = 600",
            "encounters = 268_435_457",
            "line 3: encounters is 268435457, expected 1 to 268435456",
        ),
        (
            "count = [1, 2]",
            "count = [\n1,\n0]",
            "line 12: count 0: expected a number of obstacles",
        ),
        (
            "count = [1, 2]",
            "count = [1, \"a\"]",
            "line 10: found string",
        ),
        (
            "first_seen_m = [300]",
            "first_seen_m = [300, -5]",
            "line 11: first_seen_m -5: expected a number",
        ),
        (
            "first_seen_m = [300]",
            "first_seen_m = [\"near\"]",
            "line 11: expected a number or [from, to]",
        ),
        (
            "[[15, 30], 0]",
            "[0, [30, 15]]",
            "line 12: speed_mps 30-15: expected FROM not above TO",
        ),
        (
            "first_seen_m = [300]",
            "first_seen_m = [0]",
            "line 8: threats:1:0:15-30: hardly any draw",
        ),
        (
            "[[15, 30], 0]",
            "[[15, 30, 45]]",
            "line 12: expected a number or [from, to]",
        ),
        (
            "[[15, 30], 0]",
            "[0]\nplanar = []",
            "line 13: planar is empty",
        ),
        ("seeds = [3, 4]", "seeds = []", "seeds is empty"),
        ("horizon_s = 20", "horizon = 20", "unknown field `horizon`"),
        (
            "horizon_s = 20",
            "events = [600]",
            "events names encounter 600, expected 0 to 599",
        ),
        (
            "\"threats\"",
            "\"thread\"",
            "unknown family \"thread\", expected threats or from-anywhere",
        ),
    ] {
        let error = changed(from, to);
        assert!(error.contains(told), "{to}: {error}");
        assert!(error.contains("other.toml, line"), "{to}: {error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
    let output = fga_in(at, &["campaign", "run", "small.toml", "--encounters", "0"]);
    assert_eq!(output.status.code(), Some(1));
    let output = fga_in(at, &["campaign", "run", "small.toml", "--shard", "0/4"]);
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn a_folder_of_another_campaign_or_without_resume_is_refused() {
    let folder = written();
    let at = folder.path();
    campaign(at, &["--encounters", "20", "--out", "mine"]);
    let before = results(at, "mine");
    let other = [
        "campaign",
        "run",
        "small.toml",
        "--encounters",
        "30",
        "--out",
        "mine",
    ];
    for resume in [&["--resume"][..], &[]] {
        let output = fga_in(at, &[&other[..], resume].concat());
        assert_eq!(output.status.code(), Some(1));
        let error = errors(&output);
        assert!(
            error.contains("another configuration") && error.contains("encounters"),
            "{error}"
        );
    }
    let same = [
        "campaign",
        "run",
        "small.toml",
        "--encounters",
        "20",
        "--out",
        "mine",
    ];
    let output = fga_in(at, &same);
    assert!(errors(&output).contains("--resume"), "{}", errors(&output));
    assert!(before == results(at, "mine"));
}

#[test]
fn the_shipped_campaigns_can_be_flown() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["table4-static", "table4-dynamic"] {
        let file = support::repository().join(format!("campaigns/{name}.toml"));
        let file = file.to_str().unwrap();
        let output = fga_in(
            folder.path(),
            &[
                "campaign",
                "run",
                file,
                "--encounters",
                "48",
                "--out",
                name,
                "--oracle",
            ],
        );
        assert!(output.status.success(), "{}", errors(&output));
        let summary = fs::read_to_string(folder.path().join(name).join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        let all = &summary["rows"][0];
        assert_eq!(all["encounters"], 48);
        // Every encounter of these cells is threatened, and nobody saves one that the oracle loses.
        assert_eq!(all["threatened"], 48);
        assert_eq!(all["saved_of_lost"], 0);
    }
}

#[test]
fn files_of_encounters_are_a_source_too() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("e.csv"), support::encounters(40, 5)).unwrap();
    fs::write(
        at.join("mine.toml"),
        "policies = [\"none\", \"turn-aware\"]\nfiles = [\"e.csv\"]\n",
    )
    .unwrap();
    let output = fga_in(
        at,
        &["campaign", "run", "mine.toml", "--out", "mine", "--csv"],
    );
    assert!(output.status.success(), "{}", errors(&output));
    let output = fga_in(at, &["batch", "e.csv", "--out", "batch"]);
    assert!(output.status.success(), "{}", errors(&output));
    let batch = support::columns(&at.join("batch/results.csv"));
    let csv = support::columns(&at.join("mine/results.csv"));
    assert_eq!(csv["encounter"].len(), 80);
    let flown: Vec<f64> = csv["min_margin_m"]
        .iter()
        .skip(1)
        .step_by(2)
        .copied()
        .collect();
    assert_eq!(flown, batch["min_margin_m"]);
}

/// `fga campaign draw` writes what the campaign flies: flown as a file, it gives the same
/// margins.
#[test]
fn drawn_encounters_are_those_that_are_flown() {
    let folder = written();
    let at = folder.path();
    campaign(at, &["--encounters", "12", "--csv", "--out", "flown"]);
    let draw = ["campaign", "draw", "small.toml", "--encounters", "12"];
    let output = fga_in(at, &[&draw[..], &["--out", "drawn"]].concat());
    assert!(output.status.success(), "{}", errors(&output));
    let batch = ["batch", "drawn/encounters.csv", "--policy", "none"];
    let output = fga_in(
        at,
        &[&batch[..], &["--horizon", "20", "--out", "batch"]].concat(),
    );
    assert!(output.status.success(), "{}", errors(&output));
    let flown = &support::columns(&at.join("flown/results.csv"))["min_margin_m"];
    let again = &support::columns(&at.join("batch/results.csv"))["min_margin_m"];
    // Two policies fly each encounter of the campaign, `none` first; the file has six decimals.
    assert_eq!((flown.len(), again.len()), (24, 12));
    for (flown, again) in flown.iter().step_by(2).zip(again) {
        assert!((flown - again).abs() < 1e-4, "{flown} and {again}");
    }
}

/// Ctrl-C in the first block: the block is flown to its end and kept, and `--resume` goes on from there.
#[cfg(unix)]
#[test]
fn an_interrupt_in_the_first_block_keeps_that_block() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let made = crate::support::fga_in(at, &["init", "campaign", "small.toml"]);
    assert!(made.status.success());
    let command = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fga"));
        command
            .current_dir(at)
            .args(["campaign", "run", "small.toml"]);
        command.args(["--encounters", "60000", "--threads", "1", "--out", "out"]);
        command
            .args(more)
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        command
    };
    let running = command(&[]).spawn().unwrap();
    // The folder has its manifest before the first encounter.
    while !at.join("out/campaign.json").exists() {
        std::thread::sleep(Duration::from_millis(2));
    }
    interrupt(&running);
    let ended = running.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert_eq!(ended.status.code(), Some(130), "{said}");
    assert!(said.contains("ends the blocks that are begun"), "{said}");
    assert!(!said.contains("stopped after 0 of"), "{said}");
    assert!(!blocks(&at.join("out")).is_empty(), "{said}");
}

/// Ctrl-C while encounters are drawn of which hardly any fits: no block of them is drawn to its end.
#[cfg(unix)]
#[test]
fn an_interrupt_ends_draws_that_hardly_ever_fit() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let cell = "policies = [\"none\"]\ncells = [\"from-anywhere:3:695:0-0.6\"]\n";
    fs::write(at.join("rare.toml"), cell).unwrap();
    for (command, begins, says) in [
        ("run", "out/campaign.json", "stopped after 0 of 10000"),
        ("draw", "out", "interrupted; nothing was written"),
    ] {
        let running = Command::new(env!("CARGO_BIN_EXE_fga"))
            .current_dir(at)
            .args(["campaign", command, "rare.toml", "--out", "out"])
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        while !at.join(begins).exists() {
            std::thread::sleep(Duration::from_millis(2));
        }
        std::thread::sleep(Duration::from_millis(300));
        interrupt(&running);
        let ended = running.wait_with_output().unwrap();
        // A block that is drawn to its end counts as done.
        let said = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(ended.status.code(), Some(130), "{said}");
        assert!(said.contains(says), "{said}");
        fs::remove_dir_all(at.join("out")).unwrap();
    }
}
