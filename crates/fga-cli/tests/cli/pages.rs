//! Every command of the front page and of the book runs as it is written, unless the page says why not.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::repository;

/// Why a page's commands are not run here: they need the network, minutes, data of others, another program, or serve until
/// they are stopped.
const REASONS: [&str; 5] = ["network", "minutes", "data", "program", "server"];

/// The tutorial whose files and commands `tutorial.rs` follows.
const FOLLOWED: &str = "tutorial-valley.md";

/// A block of commands.
struct Commands {
    lines: Vec<String>,
    /// Why they are not run.
    reason: Option<String>,
}

/// The blocks of commands of a page.
fn commands(page: &str) -> Vec<Commands> {
    let mut blocks = Vec::new();
    let (mut before, mut open) = ("", None::<Commands>);
    for line in page.lines() {
        match &mut open {
            Some(_) if line.trim_start().starts_with("```") => blocks.extend(open.take()),
            Some(block) => block.lines.push(line.to_owned()),
            None if line.trim() == "```sh" => {
                let reason = before.strip_prefix("<!-- not run: ");
                let reason = reason.and_then(|rest| rest.strip_suffix(" -->"));
                open = Some(Commands {
                    lines: Vec::new(),
                    reason: reason.map(ToOwned::to_owned),
                });
            }
            None => {}
        }
        before = line.trim();
    }
    blocks
}

/// A folder that looks like the root of the repository, in which results do no harm.
fn copy_of_the_root(folder: &Path) {
    for name in ["scenarios", "vehicles", "campaigns", "examples"] {
        std::os::unix::fs::symlink(repository().join(name), folder.join(name)).unwrap();
    }
    fs::create_dir(folder.join("bin")).unwrap();
    std::os::unix::fs::symlink(env!("CARGO_BIN_EXE_fga"), folder.join("bin/fga")).unwrap();
}

#[cfg(unix)]
#[test]
fn every_command_of_the_pages_runs_as_it_is_written() {
    let docs = fs::read_dir(repository().join("docs")).unwrap();
    let mut pages: Vec<PathBuf> = docs.map(|entry| entry.unwrap().path()).collect();
    pages.retain(|page| page.extension().is_some_and(|ending| ending == "md"));
    pages.push(repository().join("README.md"));
    pages.sort();
    let (mut ran, mut left) = (0, 0);
    for page in pages {
        let text = fs::read_to_string(&page).unwrap();
        let shown = page.file_name().unwrap().to_string_lossy().into_owned();
        if shown == FOLLOWED {
            continue;
        }
        let folder = tempfile::tempdir().unwrap();
        copy_of_the_root(folder.path());
        let path = std::env::var("PATH").unwrap_or_default();
        let path = format!("{}:{path}", folder.path().join("bin").display());
        for block in commands(&text) {
            if let Some(reason) = block.reason {
                assert!(REASONS.contains(&reason.as_str()), "{shown}: {reason}");
                left += 1;
                continue;
            }
            for line in &block.lines {
                let done = Command::new("sh")
                    .args(["-c", line])
                    .current_dir(folder.path())
                    .env("PATH", &path)
                    .output()
                    .unwrap();
                let said = String::from_utf8_lossy(&done.stderr);
                assert!(done.status.success(), "{shown}: {line}: {said}");
                ran += 1;
            }
        }
    }
    assert!(ran >= 20 && left >= 20, "{ran} ran, {left} did not");
}

#[test]
fn a_block_has_the_reason_that_stands_before_it() {
    let page = "<!-- not run: network -->\n```sh\ngit clone x\n```\n\n```sh\nfga check a\n```\n";
    let blocks = commands(page);
    assert_eq!(blocks.len(), 2);
    assert_eq!(blocks[0].reason.as_deref(), Some("network"));
    assert_eq!(blocks[1].reason, None);
    assert_eq!(blocks[1].lines, ["fga check a"]);
}

/// The distances on the page are those that `fga check` prints.
#[test]
fn the_page_about_sight_is_as_the_program_says() {
    let page = fs::read_to_string(repository().join("docs/how-far-to-see.md")).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| `"));
    let folder = tempfile::tempdir().unwrap();
    let mut compared = 0;
    for row in rows.filter(|row| row.contains(" m/s |")) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let name = cells[0].trim_matches('`');
        let vehicle = repository().join(format!("vehicles/{name}.toml"));
        let text = fs::read_to_string(vehicle).unwrap();
        for (volume, expected) in [
            ("radius_m = 152.4\nhalf_height_m = 30.48\n", cells[2]),
            ("radius_m = 609.6\nhalf_height_m = 76.2\n", cells[3]),
        ] {
            let (before, after) = text.split_once("[protection]\n").unwrap();
            let lines = after.lines();
            let rest: Vec<&str> = lines.skip_while(|line| line.contains("_m = ")).collect();
            let before = before.lines();
            let before: Vec<&str> = before.filter(|line| !line.contains("radius_m =")).collect();
            let (before, rest) = (before.join("\n"), rest.join("\n"));
            let file = folder.path().join("vehicle.toml");
            fs::write(&file, format!("{before}\n[protection]\n{volume}{rest}\n")).unwrap();
            let done = Command::new(env!("CARGO_BIN_EXE_fga"))
                .arg("check")
                .arg(&file)
                .output()
                .unwrap();
            let said = String::from_utf8_lossy(&done.stdout);
            assert!(said.contains(&format!("{expected} ahead")), "{row}: {said}");
            compared += 1;
        }
    }
    assert_eq!(compared, 8);
}
