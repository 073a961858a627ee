//! Counts what makes a crate hard to read, and compares it with a committed table to the last one: lines and tuned
//! constants outside of tests, files named `mod.rs`, files in circles, names of types that stand for two of them.
//!
//! The crates that fly have their lines and constants in a table of their own, `crates/fga/tests/ratchet.csv`. Counts
//! are of the text: what a macro makes of it is not seen, and no arrow is the call of a method or `mod` itself.

mod circles;
mod source;

use alloc::collections::{BTreeMap, BTreeSet};
use core::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use crate::counts::{self, CountTable};
use source::{Names, Sources};

const TABLE: &str = "crates/xtask/house.csv";

/// The crates whose lines and constants have a table of their own.
const FLYING: [&str; 5] = ["fga", "fga-index", "fga-mission", "fga-proof", "fga-search"];

/// Numbers, and what stands behind those that should be zero.
#[derive(Default)]
struct House {
    counts: CountTable,
    faults: String,
}

/// Compares the present numbers with the table; with `--write` writes those that fell, with `--faults` names the
/// circles and the types behind the numbers.
pub(crate) fn check(options: &[&str]) -> Result<(), String> {
    let (write, faults) = match options {
        [] => (false, false),
        ["--write"] => (true, false),
        ["--faults"] => (false, true),
        _ => {
            return Err("expected cargo xtask house, with --write, --faults or neither".to_owned());
        }
    };
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let house = count(&root)?;
    if faults {
        println!("{}", house.faults.trim_start());
        return Ok(());
    }
    counts::check(&root.join(TABLE), &house.counts, write).map_err(|off| {
        format!(
            "numbers differ from {TABLE}:{off}\nless: cargo xtask house --write; more: delete as much, or raise the row by \
             hand and say what that buys (cargo xtask house --faults names circles and types)"
        )
    })
}

/// Counts every crate.
fn count(root: &Path) -> Result<House, String> {
    let mut house = House::default();
    let mut owners: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for folder in entries(&root.join("crates"))? {
        let name = name_of(&folder);
        let mut files = Vec::new();
        sources_below(&folder, &mut files)?;
        let faces = files
            .iter()
            .filter(|file| name_of(file) == "mod.rs")
            .count();
        let (sources, lines) = read_crate(&folder.join("src"))?;
        let circles = circles::find(&sources);
        for (_, ties) in &circles {
            let _ = write!(house.faults, "\n{name}: a circle{ties}");
        }
        let mut twice = 0;
        for (type_name, files) in &sources.types {
            owners
                .entry(type_name.clone())
                .or_default()
                .insert(name.clone());
            if files.len() > 1 {
                twice += 1;
                let _ = write!(
                    house.faults,
                    "\n{name}: {type_name} in {}",
                    files.join(", ")
                );
            }
        }
        let mut add = |quantity: &str, number| {
            let row = (name.clone(), quantity.to_owned());
            house.counts.insert(row, number);
        };
        add("files named mod.rs", faces);
        add(
            "files in circles",
            circles.iter().map(|(files, _)| files.len()).sum(),
        );
        add("type names defined twice", twice);
        if !FLYING.contains(&name.as_str()) {
            add("lines", lines);
            add("tuned constants", sources.tuned);
        }
    }
    owners.retain(|_, crates| crates.len() > 1);
    for (type_name, crates) in &owners {
        let crates = crates.iter().cloned().collect::<Vec<_>>().join(", ");
        let _ = write!(house.faults, "\n{type_name} in {crates}");
    }
    let row = ("all".to_owned(), "type names in several crates".to_owned());
    house.counts.insert(row, owners.len());
    Ok(house)
}

/// What the files below a crate's `src` say, and their lines without tests.
fn read_crate(src: &Path) -> Result<(Sources, usize), String> {
    let mut files = Vec::new();
    sources_below(src, &mut files)?;
    let mut sources = Sources::default();
    let mut lines = BTreeMap::new();
    for file in files {
        let text =
            fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        let inside = file.strip_prefix(src).unwrap_or(&file);
        let mut module: Vec<String> = inside
            .with_extension("")
            .iter()
            .map(|name| name.to_string_lossy().into_owned())
            .collect();
        // A program beside a library is a crate of its own, which takes names from the library by its name.
        let is_root = module == ["lib"] || (module == ["main"] && !src.join("lib.rs").exists());
        if is_root || module.last().is_some_and(|name| name == "mod") {
            module.pop();
        }
        sources.read(&inside.display().to_string(), &module, &text)?;
        let shipped = text.split("#[cfg(test)]\nmod tests").next().unwrap_or("");
        lines.insert(module, shipped.lines().count());
    }
    // A file below a module of tests is of tests too.
    let in_tests = |up_to, of: &Names| sources.of_tests.contains(&of[..up_to]);
    let shipped = (lines.iter()).filter(|(of, _)| !(1..=of.len()).any(|up_to| in_tests(up_to, of)));
    let lines = shipped.map(|(_, lines)| lines).sum();
    Ok((sources, lines))
}

/// The sources below a folder; none where there is no such folder.
fn sources_below(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), String> {
    if !folder.is_dir() {
        return Ok(());
    }
    for path in entries(folder)? {
        if path.is_dir() {
            sources_below(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

/// Paths in a folder, in order.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let unusable = |error| format!("{}: {error}", folder.display());
    let entries = fs::read_dir(folder).map_err(unusable)?;
    let mut paths = entries
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(unusable)?;
    paths.sort();
    Ok(paths)
}

fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A crate of these files.
    fn sources(files: &[(&str, &str)]) -> Sources {
        let mut sources = Sources::default();
        for (path, text) in files {
            let module: Vec<String> = path
                .split('/')
                .filter(|name| *name != "lib")
                .map(str::to_owned)
                .collect();
            sources.read(path, &module, text).expect("Rust");
        }
        sources
    }

    fn circles(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let circles = circles::find(&sources(files));
        circles.into_iter().map(|(files, _)| files).collect()
    }

    #[test]
    fn the_house_is_as_its_table_says() {
        if let Err(message) = check(&[]) {
            panic!("{message}");
        }
    }

    #[test]
    fn a_circle_runs_through_names_that_a_face_hands_on() {
        let face = "mod a; mod b; pub use a::A; pub use b::B;";
        let [a, b] = [
            "use super::B; struct A;",
            "fn f() { vec![crate::A] } struct B;",
        ];
        assert_eq!(circles(&[("lib", face), ("a", a), ("b", b)]), [["a", "b"]]);
        // A function with its module's name.
        let face = "mod a; mod b; pub use a::{A, a}; pub use b::B;";
        let [a, b] = [
            "use super::B; struct A; fn a() {}",
            "use super::a; struct B;",
        ];
        assert_eq!(circles(&[("lib", face), ("a", a), ("b", b)]), [["a", "b"]]);
        let b = "struct B;";
        assert_eq!(
            circles(&[("lib", face), ("a", a), ("b", b)]),
            <[[&str; 0]; 0]>::default()
        );
    }

    #[test]
    fn a_face_is_in_a_circle_with_a_child_that_needs_what_it_defines() {
        let child = "use super::{self as up, C}; fn f() { up::g() }";
        let face = "mod a; const C: u8 = 1; fn g() {} fn h() { a::f() }";
        assert_eq!(circles(&[("lib", face), ("a", child)]), [["a", "lib"]]);
        // Declaring a child takes no name from it; neither do tests.
        let face =
            "mod a; const C: u8 = 1; fn g() {} #[cfg(test)] mod tests { fn h() { super::a::f() } }";
        assert!(circles(&[("lib", face), ("a", child)]).is_empty());
    }

    #[test]
    fn types_and_tuned_constants_are_those_outside_of_tests() {
        let text = "struct A; mod inner { enum A { X } } impl T for A { type A = u8; }
            #[cfg(test)] use x::{y, z}; #[cfg(test)] mod faults; #[cfg(test)] mod tests { struct A; }
            const REAL: [f64; 2] = [0.5, 0.0]; const WHOLE: u32 = 1_000; const fn f<const N: usize>() -> u32 { 3 }
            impl A { const fn f(self) -> u8 { self.1 } fn g() -> impl Iterator<Item = u8> { [7].into_iter() } }
            const TINY: f64 = 1e-9; const FAR: f64 = 1e15; const NAME: &str = \"7\"; const SUM: u32 = WHOLE;";
        let sources = sources(&[("lib", text)]);
        assert_eq!(sources.types["A"].len(), 2);
        assert_eq!(sources.tuned, 2);
        assert!(sources.of_tests.contains(&vec!["faults".to_owned()]));
    }
}
