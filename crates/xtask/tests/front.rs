//! The front page: short, and its lines of Rust and C are those of the crates.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn page() -> String {
    fs::read_to_string(root().join("README.md")).expect("the front page")
}

/// The blocks of a language.
fn blocks(text: &str, language: &str) -> Vec<String> {
    let fence = format!("```{language}\n");
    let parts = text.split(fence.as_str()).skip(1);
    let blocks = parts.filter_map(|part| part.split_once("```"));
    blocks.map(|(block, _)| block.to_owned()).collect()
}

#[test]
fn the_front_page_is_read_in_minutes() {
    let text = page();
    let prose = text.split("```").step_by(2);
    let words: usize = prose.map(|part| part.split_whitespace().count()).sum();
    assert!(words <= 600, "{words} words outside of code");
    let third = text.lines().nth(2).unwrap_or_default();
    assert!(
        third.contains("fixed-wing, flown in simulation only"),
        "{third}"
    );
    let rows = text.lines().filter(|line| line.starts_with('|'));
    let rows: Vec<usize> = rows.map(|row| row.matches('|').count() - 1).collect();
    assert!(rows.len() <= 2 + 6, "{} rows", rows.len());
    assert!(rows.iter().all(|columns| *columns <= 5), "{rows:?}");
    for (language, lines) in [("rust", 13), ("python", 10), ("c", 10)] {
        let found = blocks(&text, language);
        assert_eq!(found.len(), 1, "{language}");
        assert!(found[0].lines().count() <= lines, "{language}");
    }
    let picture = root().join("docs/pictures/first-flight.gif");
    let size = fs::metadata(picture).expect("the picture").len();
    assert!(size <= 2_000_000, "{size} bytes");
}

/// The lines stand in a function that has an avoider; a compiler reads them with the header.
#[test]
fn the_lines_of_c_are_those_of_the_header() {
    if Command::new("cc").arg("--version").output().is_err() {
        let sentence = "cc is not installed (Debian: build-essential); skipped";
        assert!(std::env::var_os("CI").is_none(), "{sentence}");
        println!("{sentence}");
        return;
    }
    let lines = &blocks(&page(), "c")[0];
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lines.c");
    let text = format!(
        "#include \"fga.h\"\n#include <stdio.h>\n\
         void lines(fga_avoider *avoider);\nvoid lines(fga_avoider *avoider) {{\n\
         fga_refusal why = {{.size = sizeof why}};\n{lines}}}\n"
    );
    fs::write(&file, text).expect("a file");
    let compiled = Command::new("cc")
        .args(["-std=c11", "-Wall", "-Werror", "-fsyntax-only", "-I"])
        .arg(root().join("crates/fga-c/include"))
        .arg(&file)
        .output()
        .expect("a compiler");
    let said = String::from_utf8_lossy(&compiled.stderr);
    assert!(compiled.status.success(), "{said}");
}
