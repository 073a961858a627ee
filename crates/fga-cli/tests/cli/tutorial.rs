//! The tutorials, as they are written.

use std::fs;
use std::path::Path;

use crate::support::{errors, fga_in, repository};

/// A block of a page between fences: what the page says before it, its language, its lines.
struct Block {
    before: String,
    language: String,
    text: String,
}

fn blocks(page: &str) -> Vec<Block> {
    let parts: Vec<&str> = page.split("```").collect();
    let pairs = parts.chunks_exact(2);
    pairs
        .map(|pair| {
            let before = pair[0].trim().lines().last().unwrap_or("");
            let (language, text) = pair[1].split_once('\n').expect("a line");
            Block {
                before: before.into(),
                language: language.into(),
                text: text.into(),
            }
        })
        .collect()
}

/// The file that a sentence names after these words.
fn named<'a>(sentence: &'a str, words: &str) -> Option<&'a str> {
    let name = sentence.strip_prefix(words)?.strip_prefix('`')?;
    name.split('`').next()
}

/// Writes the files of a page and runs its commands in `folder`; every line of its output must be among what the commands before it print.
fn follow(page: &str, folder: &Path) -> usize {
    let (mut printed, mut shown) = (String::new(), 0);
    for block in blocks(page) {
        let add = named(&block.before, "Add this to ");
        if let Some(file) = add.or(named(&block.before, "Save this as ")) {
            let place = folder.join(file);
            let old = fs::read_to_string(&place).unwrap_or_default();
            assert_eq!(add.is_some(), !old.is_empty(), "{file}");
            fs::write(place, old + &block.text).unwrap();
        } else if block.language == "sh" {
            for line in block.text.lines() {
                let words: Vec<&str> = line.split_whitespace().collect();
                match words.as_slice() {
                    ["fga", arguments @ ..] => {
                        let ran = fga_in(folder, arguments);
                        assert_eq!(ran.status.code(), Some(0), "{line}: {}", errors(&ran));
                        printed += &String::from_utf8_lossy(&ran.stdout);
                    }
                    ["cp", file, "."] => {
                        let from = repository().join(file);
                        fs::copy(&from, folder.join(from.file_name().unwrap())).unwrap();
                    }
                    _ => panic!("the tutorial has a command of another kind: {line}"),
                }
            }
        } else {
            for line in block.text.lines() {
                assert!(printed.contains(line), "{line}\nnot in\n{printed}");
                shown += 1;
            }
        }
    }
    shown
}

#[test]
fn the_tutorial_of_the_valley_is_as_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let page = fs::read_to_string(repository().join("docs/tutorial-valley.md")).unwrap();
    assert_eq!(follow(&page, folder.path()), 6);
    let replay = fs::read_to_string(folder.path().join("out/valley/replay.html")).unwrap();
    assert!(replay.contains("village"));
}

/// What the first tutorial shows and says of its two obstacles is what the program prints.
#[test]
fn the_first_tutorial_shows_what_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    let page = fs::read_to_string(repository().join("docs/tutorial-first-encounter.md")).unwrap();
    for arguments in [["init", "scenario"], ["run", "scenario.toml"]] {
        let ran = fga_in(folder.path(), &arguments);
        assert!(ran.status.success(), "{}", errors(&ran));
        if arguments[0] == "init" {
            continue;
        }
        let printed = String::from_utf8_lossy(&ran.stdout).into_owned();
        let shown = blocks(&page);
        let shown = shown.iter().find(|block| block.text.starts_with("N1 "));
        let lines: Vec<&str> = shown.unwrap().text.lines().collect();
        assert_eq!(lines.len(), 2);
        for line in lines {
            assert!(printed.contains(line), "{line}\nnot in\n{printed}");
        }
    }
    // The last comparison of the page: without avoidance a volume is entered.
    let none = fga_in(folder.path(), &["run", "scenario.toml", "--policy", "none"]);
    assert_eq!(none.status.code(), Some(2));
}
