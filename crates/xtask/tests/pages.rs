//! Every relative link leads somewhere, the book's contents list every page, and what users read has short sentences.

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

/// An earlier CONTRIBUTING.md named six of the nine crates to pack, and test files that were folders by then.
#[test]
fn what_contributing_says_is_what_the_checks_install_and_pack() {
    let read = |name: &str| fs::read_to_string(root().join(name)).expect(name);
    let (page, script) = (read("CONTRIBUTING.md"), read(".ci/run"));
    let (first, _) = page.split_once("```").expect("the command");
    let names: BTreeSet<&str> = first.split('`').skip(1).step_by(2).collect();
    let (files, packages): (Vec<&str>, Vec<&str>) =
        names.into_iter().partition(|name| name.contains('/'));
    for file in files {
        assert!(root().join(file).exists(), "{file}");
        assert!(script.contains(file), "{file}");
    }
    // The words behind `need`, and before `==` of a version.
    let debian = script.split("|| need ").skip(1);
    let debian = debian.filter_map(|rest| rest.split_whitespace().next());
    let pinned = script
        .split("==")
        .filter_map(|before| before.split_whitespace().last());
    let is_name = |word: &&str| word.chars().all(char::is_alphabetic);
    let pypi = pinned
        .filter(is_name)
        .filter(|name| script.contains(&format!("{name}==")));
    let installed: BTreeSet<&str> = debian.chain(pypi).collect();
    assert_eq!(packages.into_iter().collect::<BTreeSet<_>>(), installed);

    let packed = |text: &str| -> BTreeSet<String> {
        let (_, command) = text.split_once("cargo package").expect("the command");
        let (_, command) = command.split_once("-p fga-proof").expect("the first");
        let end = command.find(['`', '\n']).map(|end| &command[..end]);
        let words = end.unwrap_or_default().split_whitespace();
        words
            .filter(|word| word.starts_with("fga"))
            .map(str::to_owned)
            .collect()
    };
    assert_eq!(packed(&page), packed(&script.replace("\\\n", " ")));
    for name in page.split('`').skip(1).step_by(2) {
        let is_test = name.starts_with("tests/");
        assert!(!is_test || root().join(name).exists(), "{name}");
    }
}

/// Paragraphs and points of a list, without headings, tables, pictures and code.
fn paragraphs(text: &str) -> Vec<String> {
    let mut paragraphs = vec![String::new()];
    let (mut is_code, mut is_comment) = (false, false);
    for line in text.lines().map(str::trim) {
        is_comment |= line.starts_with("<!--");
        let is_fence = line.starts_with("```");
        is_code ^= is_fence;
        let of_list = line.split_once(' ').is_some_and(|(mark, _)| {
            ["-", "*", ">"].contains(&mark)
                || mark.strip_suffix('.').is_some_and(|number| {
                    !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())
                })
        });
        let no_prose = is_fence || is_code || is_comment || line.is_empty();
        if no_prose || of_list || line.starts_with(['#', '|', '!']) {
            paragraphs.push(String::new());
        }
        if !no_prose && !line.starts_with(['#', '|', '!']) {
            let paragraph = paragraphs.last_mut().expect("a paragraph");
            paragraph.push(' ');
            paragraph.push_str(if of_list {
                line.split_once(' ').map_or("", |(_, rest)| rest)
            } else {
                line
            });
        }
        is_comment &= !line.contains("-->");
    }
    paragraphs
}

/// The words of each sentence; a colon and a semicolon end one too. A code span is one word, the target of a link none.
fn sentences(paragraph: &str) -> Vec<Vec<&str>> {
    let mut sentences = vec![Vec::new()];
    let (mut in_code, mut in_target) = (false, false);
    for word in paragraph.split_whitespace() {
        let (began_in_code, began_in_target) = (in_code, in_target);
        in_code ^= word.matches('`').count() % 2 == 1;
        if let Some((_, target)) = word.rsplit_once("](") {
            in_target = !target.contains(')');
        } else {
            in_target &= !word.contains(')');
        }
        if !began_in_code && !began_in_target {
            sentences.last_mut().expect("a sentence").push(word);
        }
        let bare = word.trim_end_matches(['*', '_', ')', '"']);
        if !in_code && bare.ends_with(['.', '!', '?', ':', ';']) {
            sentences.push(Vec::new());
        }
    }
    sentences
}

/// A sentence of more words is read twice.
const MOST_WORDS: usize = 35;

#[test]
fn what_users_read_has_short_sentences() {
    let root = root();
    let mut pages = pages(&root.join("docs"));
    pages.push(root.join("README.md"));
    let (mut long, mut read) = (Vec::new(), 0);
    for page in pages {
        let text = fs::read_to_string(&page).expect("a page");
        for paragraph in paragraphs(&text) {
            for sentence in sentences(&paragraph) {
                read += 1;
                if sentence.len() > MOST_WORDS {
                    let (page, words) = (page.display(), sentence.len());
                    long.push(format!("{page}: {words} words: {}", sentence.join(" ")));
                }
            }
        }
    }
    assert!(long.is_empty(), "{}", long.join("\n"));
    assert!(read > 1_000, "{read} sentences");
}

#[test]
fn sentences_end_where_they_end() {
    let words = |text: &str| -> Vec<usize> {
        let sentences = sentences(text);
        sentences
            .iter()
            .map(Vec::len)
            .filter(|words| *words > 0)
            .collect()
    };
    assert_eq!(words("One two. Three: four; five!"), [2, 1, 1, 1]);
    assert_eq!(words("It says `a b: c`. Then more."), [3, 2]);
    assert_eq!(
        words("A `code span. of many` words and a [link](to a) end"),
        [7]
    );
    assert_eq!(
        paragraphs("# a\n- b c\n- d\n| e |\n```sh\nf\n```\ng\nh").concat(),
        " b c d g h"
    );
}

/// A page of more words is several questions: it becomes several pages.
const MOST_WORDS_OF_A_PAGE: usize = 1_200;

/// Pages that may have more words. The number of a page may fall, never rise; the test asks for the fall.
const LONGER: [(&str, usize); 1] = [("proof.md", 1_500)];

/// Words as `wc -w` counts them, with those of tables and code.
#[test]
fn a_page_of_the_book_is_read_in_minutes() {
    let docs = root().join("docs");
    for (name, most) in LONGER {
        let text = fs::read_to_string(docs.join(name)).expect(name);
        let words = text.split_whitespace().count();
        assert!(
            words > MOST_WORDS_OF_A_PAGE && words + 100 > most,
            "{name} has {words} words: lower its {most} in LONGER, or take it out"
        );
    }
    for page in pages(&docs) {
        let name = page.file_name().expect("a name").to_string_lossy();
        let longer = LONGER.iter().find(|(longer, _)| *longer == name);
        let most = longer.map_or(MOST_WORDS_OF_A_PAGE, |(_, most)| *most);
        let text = fs::read_to_string(&page).expect("a page");
        let words = text.split_whitespace().count();
        assert!(words <= most, "{name}: {words} words, at most {most}");
    }
}

/// Words of the glossary stand in its order once, and each has its name in the code where it says so.
#[test]
fn the_glossary_has_one_line_for_each_word_and_its_names_exist() {
    let root = root();
    let text = fs::read_to_string(root.join("docs/glossary.md")).expect("the glossary");
    let rows = text.lines().filter(|line| line.starts_with("| ")).skip(1);
    let rows: Vec<Vec<&str>> = rows
        .map(|row| row.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    let words: BTreeSet<&str> = rows.iter().map(|row| row[0]).collect();
    assert_eq!(words.len(), rows.len(), "a word stands twice");
    assert!(rows.len() > 25, "{} words", rows.len());
    let mut code = String::new();
    let mut folders: Vec<PathBuf> = vec![root.join("crates")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() && !path.ends_with("target") && !path.ends_with("xtask") {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                code += &fs::read_to_string(&path).unwrap_or_default();
            }
        }
    }
    let is_of_name = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    let names: BTreeSet<&str> = code.split(|c| !is_of_name(c)).collect();
    for row in &rows {
        for name in row.get(2).unwrap_or(&"").split('`').skip(1).step_by(2) {
            let last = name.rsplit("::").next().unwrap_or(name);
            assert!(names.contains(last), "{}: {name}", row[0]);
        }
    }
}
