//! The pages `docs/from-paper-to-code.md`, `docs/errata.md` and `docs/errata-algorithms.md` name only existing
//! tests and functions.

use std::fs;
use std::path::{Path, PathBuf};

fn sources(folder: &Path, text: &mut String) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, text);
        } else if path.extension().is_some_and(|e| e == "rs") {
            text.push_str(&fs::read_to_string(&path).unwrap());
        }
    }
}

/// Whether a name is a function, a type, a field, a constant or a module somewhere.
fn is_defined(name: &str, text: &str) -> bool {
    let definitions = ["fn", "struct", "enum", "mod", "const", "trait"];
    definitions.iter().any(|kind| {
        text.match_indices(&format!("{kind} {name}"))
            .any(|(at, found)| {
                let next = text[at + found.len()..].chars().next();
                next.is_some_and(|c| !c.is_alphanumeric() && c != '_')
            })
    }) || text.contains(&format!("pub {name}: "))
}

#[test]
fn every_name_on_the_pages_exists() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let mut text = String::from("mod errata;\n");
    for folder in [
        "src",
        "tests",
        "../fga/src",
        "../fga/tests",
        "../fga-mission/src",
        "../fga-proof/src",
        "../fga-search/src",
        "../fga-sim/src/plant",
    ] {
        sources(&root.join(folder), &mut text);
    }
    text.push_str(&fs::read_to_string(root.join("../fga-sim/src/plant.rs")).unwrap());
    for page in ["from-paper-to-code.md", "errata.md", "errata-algorithms.md"] {
        let path = root.join("../../docs").join(page);
        let page_text = fs::read_to_string(&path).unwrap();
        let quoted = page_text.split('`').skip(1).step_by(2);
        let mut checked = 0;
        for name in quoted {
            let is_path = name
                .chars()
                .all(|c| c.is_alphanumeric() || c == '_' || c == ':');
            let last = name.rsplit("::").next().unwrap();
            // Symbols of the paper such as d_m are quoted, too.
            if is_path && last.len() > 4 && last != "published-literal" {
                assert!(is_defined(last, &text), "{page}: {name}");
                checked += 1;
            }
        }
        assert!(checked > 15, "{page}: only {checked} names found");
    }
}
