//! Circles between the files of a crate: files that take names from each other, directly or by way of others.

use alloc::collections::{BTreeMap, BTreeSet};
use core::fmt::Write as _;

use super::source::{Names, Sources, below};

/// Files that a file takes names from, with the names.
type Arrows = BTreeMap<String, BTreeMap<String, BTreeSet<String>>>;

/// Where a path ends: a module, or something that a module defines.
enum PathEnd {
    Module(Names),
    Item(Names),
}

/// The circles of a crate: files, and what ties them in words.
pub(crate) fn find(sources: &Sources) -> Vec<(Vec<String>, String)> {
    let arrows = arrows(sources);
    let reached: BTreeMap<&String, BTreeSet<&String>> = arrows
        .keys()
        .map(|file| (file, reach(&arrows, file)))
        .collect();
    let mut left: BTreeSet<&String> = reached
        .iter()
        .filter(|(file, files)| files.contains(**file))
        .map(|(file, _)| *file)
        .collect();
    let mut circles = Vec::new();
    while let Some(first) = left.first().copied() {
        let files: Vec<&String> = left
            .iter()
            .copied()
            .filter(|file| reached[first].contains(file) && reached[file].contains(first))
            .collect();
        let mut ties = String::new();
        for file in &files {
            for (other, names) in &arrows[*file] {
                if files.contains(&other) {
                    let names = names.iter().cloned().collect::<Vec<_>>().join(", ");
                    let _ = write!(ties, "\n    {file} -> {other}: {names}");
                }
            }
        }
        left.retain(|file| !files.contains(file));
        circles.push((files.into_iter().cloned().collect(), ties));
    }
    circles
}

/// Files that can be reached from a file along one arrow or more.
fn reach<'a>(arrows: &'a Arrows, file: &'a String) -> BTreeSet<&'a String> {
    let mut reached = BTreeSet::new();
    let mut open = vec![file];
    while let Some(file) = open.pop() {
        let next = arrows
            .get(file)
            .into_iter()
            .flatten()
            .map(|(other, _)| other);
        open.extend(next.filter(|other| reached.insert(*other)));
    }
    reached
}

fn arrows(sources: &Sources) -> Arrows {
    let mut arrows = Arrows::new();
    for (module, path) in &sources.paths {
        let Some(PathEnd::Item(owner)) = end_of(sources, module, path, 0) else {
            continue;
        };
        let (from, to) = (&sources.modules[module], &sources.modules[&owner]);
        if from != to {
            let name = path.last().cloned().unwrap_or_default();
            let names = arrows.entry(from.clone()).or_default();
            names.entry(to.clone()).or_default().insert(name);
        }
    }
    arrows
}

/// Where a path that stands in a module ends; none outside of the crate.
fn end_of(sources: &Sources, module: &Names, path: &[String], depth: usize) -> Option<PathEnd> {
    let first = path.first()?.as_str();
    let is_own = ["crate", "self", "super"].contains(&first)
        || sources.modules.contains_key(&below(module, first))
        || sources
            .imports
            .contains_key(&(module.clone(), first.to_owned()));
    // Any other first name is another crate's, or a type's of this file.
    if is_own {
        follow(sources, module, path, depth)
    } else {
        None
    }
}

/// Follows a path of the crate from a module, through what modules hand on by `use`.
fn follow(sources: &Sources, from: &Names, path: &[String], depth: usize) -> Option<PathEnd> {
    let mut module = from.clone();
    for (name, rest) in path
        .iter()
        .zip((1..).map(|place| path.get(place..).unwrap_or_default()))
    {
        match name.as_str() {
            "crate" => module.clear(),
            "self" => {}
            "super" => {
                module.pop()?;
            }
            // A function may have its module's name: of a path that ends here, the function is meant.
            name if sources.modules.contains_key(&below(&module, name))
                && !(rest.is_empty()
                    && sources
                        .imports
                        .contains_key(&(module.clone(), name.to_owned()))) =>
            {
                module = below(&module, name);
            }
            name => {
                let import = sources.imports.get(&(module.clone(), name.to_owned()));
                // `use name;` and names that hand each other on in a ring lead nowhere.
                let Some(import) = import.filter(|path| path.as_slice() != [name] && depth < 8)
                else {
                    return Some(PathEnd::Item(module));
                };
                return match end_of(sources, &module, import, depth + 1)? {
                    PathEnd::Module(owner) => follow(sources, &owner, rest, depth + 1),
                    item @ PathEnd::Item(_) => Some(item),
                };
            }
        }
    }
    Some(PathEnd::Module(module))
}
