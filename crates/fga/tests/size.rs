//! The core stays small enough to read: ARCHITECTURE.md limits its size, its public items and its
//! dependencies.

use std::fs;
use std::path::{Path, PathBuf};

/// The counts.
#[derive(Default)]
struct Size {
    lines: usize,
    public_items: usize,
}

impl Size {
    /// Counts the sources of a folder without their tests.
    fn count(&mut self, folder: &Path) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                self.count(&path);
            } else if path.extension().is_some_and(|e| e == "rs")
                && path.file_stem().is_some_and(|stem| stem != "tests")
            {
                let text = fs::read_to_string(&path).unwrap();
                // Tests stand at the end of a file.
                let shipped = text.split("#[cfg(test)]\nmod tests").next().unwrap();
                self.lines += shipped.lines().count();
                self.public_items += shipped.lines().filter(|line| is_public(line)).count();
            }
        }
    }
}

/// Whether a line begins a public item.
fn is_public(line: &str) -> bool {
    let kinds = ["fn", "const", "struct", "enum", "trait", "type"];
    line.trim_start()
        .strip_prefix("pub ")
        .and_then(|rest| rest.split_whitespace().next())
        .is_some_and(|word| kinds.contains(&word))
}

/// The second cell of the row of ARCHITECTURE.md that begins with `name`.
fn allowed(page: &str, name: &str) -> String {
    let row = page
        .lines()
        .find(|line| line.starts_with(&format!("| {name} |")))
        .unwrap_or_else(|| panic!("ARCHITECTURE.md has no row {name}"));
    row.split('|').nth(2).unwrap().trim().to_owned()
}

#[test]
fn the_core_is_no_larger_than_the_architecture_says() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let page = fs::read_to_string(root.join("../../ARCHITECTURE.md")).unwrap();
    let mut size = Size::default();
    size.count(&root.join("src"));
    for (name, found) in [
        ("lines of `fga` without tests", size.lines),
        ("public items of `fga`", size.public_items),
    ] {
        let most: usize = allowed(&page, name).parse().unwrap();
        assert!(
            found <= most,
            "{name}: {found}, expected at most {most}; say in ARCHITECTURE.md if it has to grow"
        );
    }
    let manifest = fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let section = manifest.split("[dependencies]").nth(1).unwrap();
    let dependencies: Vec<&str> = section
        .lines()
        .take_while(|line| !line.starts_with('['))
        .filter_map(|line| line.split(['.', '=', ' ']).next())
        .filter(|name| !name.is_empty() && !name.starts_with('#'))
        .collect();
    assert_eq!(
        dependencies.join(", "),
        allowed(&page, "dependencies of `fga`")
    );
}
