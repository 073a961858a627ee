//! Who judges shares no code with what it judges: plain types of `fga-proof`, and nothing else of this project.

use std::fs;
use std::path::{Path, PathBuf};

/// What it takes of `fga-proof`, module by module: types that are only read, and a constant.
const TAKEN: &str = "Vec2 Vec3 maneuver Maneuver Stage situation Obstacle Ownship ProtectedVolume \
                     vehicle Response default STANDARD_GRAVITY_MPS2 Vehicle zone Outline Zone";

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder");
    let (folders, files): (Vec<_>, Vec<_>) = entries
        .map(|entry| entry.expect("an entry").path())
        .partition(|path| path.is_dir());
    let below = folders.iter().flat_map(|folder| sources(folder));
    below.chain(files).collect()
}

#[test]
fn the_judge_takes_plain_types_alone() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest = fs::read_to_string(root.join("Cargo.toml")).expect("the manifest");
    let crates: Vec<&str> = manifest
        .lines()
        .filter(|line| line.starts_with("fga"))
        .collect();
    assert_eq!(crates, ["fga-proof.workspace = true"]);
    let files = sources(&root.join("src"));
    assert!(files.len() > 15, "{} files", files.len());
    for file in files {
        let text = fs::read_to_string(&file).expect("a source");
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for path in code.split("fga_proof::").skip(1) {
            let path = path.split([';', '(']).next().unwrap_or_default();
            let mut words = path.split(|c: char| !c.is_alphanumeric() && c != '_');
            assert!(
                words.all(|word| word.is_empty() || TAKEN.split(' ').any(|taken| taken == word)),
                "{}: fga_proof::{path}",
                file.display()
            );
        }
        // Certificates rest on the distances that volumes have of their own.
        for call in [".margin_m(", ".bounding_radius_m(", ".is_entered("] {
            let is_volume = code.contains(&format!("volume{call}"));
            assert!(!is_volume, "{}: volume{call}", file.display());
        }
    }
}
