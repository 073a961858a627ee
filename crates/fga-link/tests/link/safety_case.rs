//! The safety case names tests: each of them exists.

use std::fs;
use std::path::{Path, PathBuf};

/// The pages of the safety case.
const PAGES: [&str; 9] = [
    "fly-safety.md",
    "fly-reactions.md",
    "fly-program-dies.md",
    "fly-limits.md",
    "fly-hazards-mode.md",
    "fly-hazards-link.md",
    "fly-hazards-mission.md",
    "fly-hazards-traffic.md",
    "fly-network.md",
];

fn sources(folder: &Path, found: &mut Vec<(PathBuf, String)>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") {
            let text = fs::read_to_string(&path).expect("a source file");
            found.push((path.with_extension(""), text));
        }
    }
}

#[test]
fn every_test_that_the_safety_case_names_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |page| fs::read_to_string(root.join("docs").join(page)).expect(page);
    let pages = PAGES.map(read).concat();
    let mut found = Vec::new();
    sources(&root.join("crates"), &mut found);
    let mut place = ("", String::new());
    let (mut count, mut missing) = (0, Vec::new());
    // Every other piece between backticks is code.
    for name in pages.split('`').skip(1).step_by(2) {
        let Some((file, test)) = name.rsplit_once("::") else {
            // A whole file of tests.
            if name.starts_with("fga-") && name.contains("/tests/") {
                count += 1;
                if !found.iter().any(|(path, _)| path.ends_with(name)) {
                    missing.push(name);
                }
            }
            continue;
        };
        let is_test =
            test.len() > 12 && test.chars().all(|c| c == '_' || c.is_ascii_alphanumeric());
        if !is_test || test.chars().any(|c| c.is_ascii_uppercase()) {
            continue;
        }
        // A name that begins with `::` is of the file named before; one without a path, of this crate.
        if !file.is_empty() {
            let within = if file.contains('/') {
                "crates"
            } else {
                "fga-link"
            };
            place = (within, file.replace("::", "/"));
        }
        count += 1;
        let (within, file) = &place;
        let exists = found.iter().any(|(path, text)| {
            (path.ends_with(file) || path.ends_with(file.trim_end_matches("/tests")))
                && path.components().any(|part| part.as_os_str() == *within)
                && text.contains(&format!("fn {test}("))
        });
        if !exists {
            missing.push(name);
        }
    }
    assert!(count > 60, "{count} names");
    assert!(missing.is_empty(), "{missing:?}");
}
