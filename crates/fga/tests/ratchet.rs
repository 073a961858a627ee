//! What flies stays small: lines, public items, constants, dependencies and sizes of the crates that fly are
//! those of `ratchet.csv`, to the last one.
//!
//! A number below the table's is written into it by `RATCHET=write cargo test -p fga --test ratchet`. One above it
//! fails: delete as much elsewhere, or raise the row by hand and say in the commit what that buys.
//!
//! Zones, polygons and circles in the certificate and in decisions, raised it on 26 November 2026 by 773 lines (`fga` 176,
//! `fga-proof` 597), at most 1,200 being granted for zones and ground; the ground took 507, 80 more than the rest (`fga` 91, `fga-proof` 410,
//! `fga-search` 6), and turning round between zones in wind 25.
//!
//! On 29 November 2026 commands that carry their proof, assumptions as the only makers of hazards (chains of motions moved there from `fga`)
//! and derived bounds of lagged flights raised `fga-proof` from 4,146 to 5,034 lines; `fga` fell from 4,290 to 4,194, and `fga-mission` rose
//! from 1,629 to 1,681. For `fga-proof` 4,500 were granted; it is 532 above that.
//!
//! On the same day `BeliefAvoider` raised `fga` by 490 lines: it proves what `fga-choice` weighs, among zones, ground and limits. The rules for
//! uncertain reports that it makes needless stay until it flies by default.
//!
//! Then the widest turn and back between walls (`fga-search` 41 lines, `fga` 27), the depth at which a flight leads out of a fence
//! (`fga-proof` 35) and the drift that is learned of the own aircraft (`fga` 14) raised it: 9 of 10,200 drawn encounters in corridors leave a
//! fence that an oracle keeps (13 before), and 4 fly back for more than 30 s (19).
//!
//! What a pilot believes of the others, for whoever shows it, raised `fga` by 15 lines.
//!
//! Aircraft that are no longer reported are proven against while they are believed to be there, beliefs keep the clock of decisions, and a
//! waypoint is given up among aircraft too: 25 lines of `fga`.
//!
//! On 30 November 2026 what only proposals need left `fga-proof`, and raised others: where a turn leads once it is over moved to
//! `fga-mission`, which `fga-search` therefore reads (224 lines), sides of turns to `fga-search` (45).
//!
//! What decides on beliefs stands beside an avoider that lives elsewhere, for C, and says what it leaves out: 82 lines of `fga`.
#![cfg(target_pointer_width = "64")]

extern crate alloc;

#[path = "../../xtask/src/counts.rs"]
mod counts;

use alloc::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use counts::CountTable;

/// The crates that fly.
const CRATES: [&str; 5] = ["fga-proof", "fga-search", "fga-mission", "fga-index", "fga"];

/// Paths and sizes in memory of types, bytes.
macro_rules! sizes {
    ($($path:path,)*) => { [$((stringify!($path), size_of::<$path>()),)*] };
}

/// The public types.
fn sizes() -> impl Iterator<Item = (&'static str, usize)> {
    sizes! {
        fga_proof::assumptions::Assumption,
        fga_proof::assumptions::Assumptions,
        fga_proof::assumptions::Changes,
        fga_proof::assumptions::Turn,
        fga_proof::assumptions::Viewpoint,
        fga_proof::certificate::Closest,
        fga_proof::certificate::Extent,
        fga_proof::certificate::Fixed,
        fga_proof::certificate::Hazard,
        fga_proof::certificate::Line,
        fga_proof::certificate::Status,
        fga_proof::certificate::Zones,
        fga_proof::command::Bound,
        fga_proof::command::Certified,
        fga_proof::command::Command,
        fga_proof::command::Leaving,
        fga_proof::command::Proof,
        fga_proof::command::Terms,
        fga_proof::ground::Binding,
        fga_proof::ground::Ground,
        fga_proof::limit::SettingsError,
        fga_proof::list::List<u8, 8>,
        fga_proof::maneuver::StageList<40>,
        fga_proof::maneuver::Stage,
        fga_proof::meter::Meter,
        fga_proof::prediction::FlightPath,
        fga_proof::prediction::Flyer,
        fga_proof::prediction::MotionState,
        fga_proof::prediction::Node,
        fga_proof::prediction::Piece,
        fga_proof::situation::Mission,
        fga_proof::situation::Movement,
        fga_proof::situation::MovementBounds,
        fga_proof::situation::Obstacle,
        fga_proof::situation::ObstacleKind,
        fga_proof::situation::Ownship,
        fga_proof::situation::Passing,
        fga_proof::situation::ProtectedVolume,
        fga_proof::situation::Uncertainty,
        fga_proof::vehicle::Response,
        fga_proof::vehicle::Vehicle,
        fga_proof::zone::Outline,
        fga_proof::zone::Zone,
        fga_search::Departure,
        fga_search::Found,
        fga_search::Objective,
        fga_search::Outcome,
        fga_search::Scene,
        fga_search::Search,
        fga_search::SecondTurn,
        fga_search::Side,
        fga_search::Turns,
        fga_search::Tables,
        fga_mission::Bend,
        fga_mission::Exit,
        fga_mission::Progress,
        fga_mission::Route,
        fga_mission::Join,
        fga_mission::Turner,
        fga_mission::leg::Leg,
        fga_mission::leg::LegPosition,
        fga_index::Block,
        fga_index::Kept,
        fga_index::KeptError,
        fga_index::quiet::LineAhead,
        fga_index::situation::Columns,
        fga_index::situation::ColumnsError,
        fga_index::situation::Obstacles,
        fga_index::situation::Situation,
        fga::avoider::Against,
        fga::avoider::Avoider,
        fga::avoider::belief::BeliefAvoider,
        fga::avoider::belief::BeliefDecider,
        fga::avoider::Candidate,
        fga::avoider::Decision,
        fga::avoider::Known,
        fga::avoider::Reason,
        fga::avoider::Record,
        fga::avoider::Settings,
        fga::avoider::Start,
        fga::avoider::State,
        fga::avoider::Threat,
        fga::avoider::Tracks,
        fga::avoider::Verdict,
        fga::avoider::Work,
    }
    .into_iter()
}

/// The shipped lines of a crate: its sources without their tests, which stand at the end of a file or in `tests.rs`.
fn shipped(folder: &Path, lines: &mut Vec<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            shipped(&path, lines);
        } else if path.extension().is_some_and(|extension| extension == "rs")
            && path
                .file_stem()
                .is_some_and(|stem| stem != "draw" && stem != "tests")
        {
            let text = fs::read_to_string(&path).unwrap();
            let text = text.split("#[cfg(test)]\nmod tests").next().unwrap();
            lines.extend(text.lines().map(str::to_owned));
        }
    }
}

/// The kind and the name of the public item that a line begins.
fn public_item(line: &str) -> Option<(&str, &str)> {
    let mut words = line.trim_start().strip_prefix("pub ")?.split_whitespace();
    let kind = words.next()?;
    let kinds = ["fn", "const", "struct", "enum", "trait", "type"];
    let name = words.next()?.split(['<', '(', ';', ':']).next()?;
    kinds.contains(&kind).then_some((kind, name))
}

/// Constants that hold a real number to be tuned, and those that hold a whole one. Zero, tolerances below a
/// thousandth and bounds from 10⁹ on are neither.
fn constants(lines: &[String]) -> (usize, usize) {
    let (mut real, mut whole) = (0, 0);
    for (place, line) in lines.iter().enumerate() {
        let Some((before, rest)) = line.split_once("const ") else {
            continue;
        };
        let is_item = before.trim().is_empty() || before.trim().starts_with("pub");
        if !is_item || rest.starts_with("fn ") || rest.starts_with("unsafe ") {
            continue;
        }
        let to_end = lines.get(place..).unwrap_or(&[]).iter();
        let mut text = String::new();
        for line in to_end {
            text += line.split("//").next().unwrap_or("");
            // A length in a type ends with a bracket: `[f64; 3] =`.
            if line.ends_with(';') {
                break;
            }
        }
        let Some((kind, value)) = text.split_once(" = ").or_else(|| text.split_once(" =")) else {
            continue;
        };
        let numbers = value
            .split(|c: char| !(c.is_alphanumeric() || c == '.' || c == '_' || c == '-'))
            .map(|word| word.trim_start_matches('-').replace('_', ""))
            .filter_map(|word| word.parse::<f64>().ok());
        let is_tuned = |number: f64| (1e-3..1e9).contains(&number);
        let mut tuned = numbers.filter(|number| is_tuned(*number)).peekable();
        if tuned.peek().is_none() {
            continue;
        }
        let is_real = kind.contains("f64") || tuned.any(|number| number.fract() != 0.0);
        *if is_real { &mut real } else { &mut whole } += 1;
    }
    (real, whole)
}

/// The names of a manifest's dependencies.
fn dependencies(manifest: &str) -> Vec<&str> {
    let section = manifest.split("\n[dependencies]\n").nth(1).unwrap_or("");
    section
        .lines()
        .take_while(|line| !line.starts_with('['))
        .filter_map(|line| line.split(['.', '=', ' ']).next())
        .filter(|name| !name.is_empty() && !name.starts_with('#'))
        .collect()
}

/// The present numbers.
fn count() -> CountTable {
    let crates = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut table = CountTable::new();
    for name in CRATES {
        let mut add = |quantity: &str, number| {
            table.insert((name.to_owned(), quantity.to_owned()), number);
        };
        let mut lines = Vec::new();
        shipped(&crates.join(name).join("src"), &mut lines);
        let items: Vec<_> = lines.iter().filter_map(|line| public_item(line)).collect();
        let (real, whole) = constants(&lines);
        let manifest = fs::read_to_string(crates.join(name).join("Cargo.toml")).unwrap();
        add("lines", lines.len());
        add("public items", items.len());
        add("real constants", real);
        add("whole constants", whole);
        for dependency in dependencies(&manifest) {
            add(&format!("dependency {dependency}"), 1);
        }
        let sizes: BTreeMap<_, _> = sizes()
            .filter_map(|(path, bytes)| Some((path.split_once("::")?, path, bytes)))
            .filter(|((owner, _), ..)| owner.replace('_', "-") == name)
            .filter_map(|(_, path, bytes)| Some((path.rsplit_once("::")?.1, bytes)))
            .filter_map(|(name, bytes)| Some((name.split('<').next()?.trim_end(), bytes)))
            .collect();
        for (kind, item) in items {
            if matches!(kind, "struct" | "enum") {
                let bytes = sizes.get(item);
                let bytes = bytes.unwrap_or_else(|| panic!("{name}: {item} is not in `sizes`"));
                add(&format!("bytes of {item}"), *bytes);
            }
        }
    }
    table
}

#[test]
fn what_flies_is_as_small_as_the_table_says() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/ratchet.csv");
    let write = std::env::var_os("RATCHET").is_some_and(|asked| asked == "write");
    if let Err(off) = counts::check(&path, &count(), write) {
        panic!(
            "what flies differs from crates/fga/tests/ratchet.csv:{off}\nless: RATCHET=write cargo test -p fga --test \
             ratchet; more: delete as much, or raise the row by hand and say what that buys"
        );
    }
}

#[test]
fn constants_are_real_or_whole_where_they_hold_a_number_to_tune() {
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let real = "const A_S: f64 = 1.0;\n    pub const B: [(f64, f64); 2] = [\n    (0.5, PI),\n];\nconst C: Vector = [0.2];";
    assert_eq!(constants(&lines(real)), (3, 0));
    assert_eq!(
        constants(&lines(
            "pub const A: u32 = 10;\nconst B: usize = A as usize;"
        )),
        (0, 1)
    );
    let neither = "const A: f64 = 1e-9;\nconst B: f64 = 0.0;\nconst C: f64 = 1e15;\npub const fn f() -> u32 {\n    2;";
    assert_eq!(constants(&lines(neither)), (0, 0));
}
