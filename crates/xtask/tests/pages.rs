//! Every relative link leads somewhere, and the book's contents list every page.

extern crate alloc;

use alloc::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Markdown files of a folder, not of the folders in it.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let mut pages: Vec<PathBuf> = fs::read_dir(folder)
        .expect("a folder of pages")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .collect();
    pages.sort();
    pages
}

/// Text without code blocks and code spans.
fn prose(text: &str) -> String {
    let mut in_block = false;
    let mut prose = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            in_block = !in_block;
        } else if !in_block {
            for (index, part) in line.split('`').enumerate() {
                if index % 2 == 0 {
                    prose.push_str(part);
                }
            }
            prose.push('\n');
        }
    }
    prose
}

/// Targets of the links in a text.
fn links(text: &str) -> Vec<String> {
    prose(text)
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split_once(')'))
        .map(|(target, _)| target.split_whitespace().next().unwrap_or("").to_owned())
        .collect()
}

/// The anchor of a heading, as renderers make it.
fn anchor(heading: &str) -> String {
    heading
        .trim()
        .to_lowercase()
        .chars()
        .filter_map(|c| match c {
            ' ' => Some('-'),
            c if c.is_alphanumeric() || c == '-' || c == '_' => Some(c),
            _ => None,
        })
        .collect()
}

fn has_anchor(page: &Path, wanted: &str) -> bool {
    let text = fs::read_to_string(page).unwrap_or_default();
    text.lines()
        .filter(|line| line.starts_with('#'))
        .any(|line| anchor(line.trim_start_matches('#')) == wanted)
}

#[test]
fn every_relative_link_leads_somewhere() {
    let root = root();
    let mut checked = 0;
    for folder in ["", "docs", "docs/benchmarks"] {
        for page in pages(&root.join(folder)) {
            let text = fs::read_to_string(&page).expect("a page");
            for link in links(&text) {
                if link.contains("://") || link.starts_with("mailto:") {
                    continue;
                }
                let (file, place) = link.split_once('#').unwrap_or((&link, ""));
                let target = if file.is_empty() {
                    page.clone()
                } else {
                    page.parent().expect("a folder").join(file)
                };
                assert!(target.exists(), "{}: {link} leads nowhere", page.display());
                assert!(
                    place.is_empty() || has_anchor(&target, place),
                    "{}: {link}: no such heading",
                    page.display()
                );
                checked += 1;
            }
        }
    }
    assert!(checked > 50, "{checked} links");
}

/// A page works from a clone: it names no path of one machine, and each source of data with its commit.
#[test]
fn n7_no_page_needs_the_disk_of_its_authors() {
    let root = root();
    let mut folders = vec!["", "docs", "docs/benchmarks", "python"];
    folders.retain(|folder| root.join(folder).exists());
    for page in folders.iter().flat_map(|folder| pages(&root.join(folder))) {
        let text = fs::read_to_string(&page).expect("a page");
        for path in ["../shared", "/home/", "/root/", "/Users/", "/work/"] {
            assert!(!text.contains(path), "{}: {path}", page.display());
        }
    }
    let sources = fs::read_to_string(root.join("docs/sources.md")).expect("the sources");
    let rows: Vec<&str> = sources
        .lines()
        .filter(|line| line.contains("github.com/") && line.starts_with('|'))
        .collect();
    assert!(rows.len() > 5, "{rows:?}");
    for row in rows {
        let commit = row.split('|').nth(3).unwrap_or_default().trim();
        let digits = commit
            .trim_start_matches('`')
            .split('`')
            .next()
            .unwrap_or_default();
        let is_hash = digits.len() >= 7 && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
        assert!(is_hash, "no commit in {row}");
    }
}

#[test]
fn the_contents_list_every_page() {
    let docs = root().join("docs");
    let contents = fs::read_to_string(docs.join("SUMMARY.md")).expect("the contents");
    let listed: BTreeSet<String> = links(&contents).into_iter().collect();
    for folder in ["", "benchmarks"] {
        for page in pages(&docs.join(folder)) {
            let name = page
                .strip_prefix(&docs)
                .expect("below docs")
                .display()
                .to_string();
            assert!(
                name == "SUMMARY.md" || listed.contains(&name),
                "docs/SUMMARY.md does not list {name}"
            );
        }
    }
}

/// The pages of the book, of the front and of the crates.
fn all_pages(root: &Path) -> Vec<PathBuf> {
    let crates = fs::read_dir(root.join("crates")).expect("the crates");
    let crates = crates.map(|entry| entry.expect("an entry").path());
    [root.to_path_buf(), root.join("docs")]
        .into_iter()
        .chain(crates)
        .flat_map(|folder| pages(&folder))
        .collect()
}

/// A file that a page names, or an example that it runs, was deleted by a commit about something else.
#[test]
fn what_a_page_names_exists() {
    let root = root();
    let (mut files, mut examples) = (0, 0);
    for page in all_pages(&root) {
        if page.ends_with("CHANGELOG.md") {
            continue;
        }
        let text = fs::read_to_string(&page).expect("a page");
        for (before, after) in text
            .split("--example ")
            .zip(text.split("--example ").skip(1))
        {
            let word = |text: &str| -> String {
                let of_name = |c: &char| c.is_alphanumeric() || *c == '-' || *c == '_';
                text.trim_start().chars().take_while(of_name).collect()
            };
            let Some((_, package)) = before.rsplit_once("-p ") else {
                continue;
            };
            let example = format!("crates/{}/examples/{}.rs", word(package), word(after));
            assert!(
                root.join(&example).exists(),
                "{}: {example}",
                page.display()
            );
            examples += 1;
        }
        for name in text.split('`').skip(1).step_by(2) {
            let is_ours = [
                "crates/",
                "scenarios/",
                "vehicles/",
                "campaigns/",
                "docs/",
                "python/",
            ]
            .iter()
            .any(|folder| name.starts_with(folder));
            if is_ours && !name.contains([' ', '*', '…', '{', '<', '\n']) {
                assert!(root.join(name).exists(), "{}: {name}", page.display());
                files += 1;
            }
        }
    }
    assert!(files > 20 && examples > 3, "{files} and {examples}");
}
