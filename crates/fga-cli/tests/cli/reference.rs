//! The reference pages list exactly the keys that the program reads.

use alloc::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use fga_campaign::campaign::file::{self as campaign_file, Overrides};
use fga_files::TomlText;
use fga_sim::scenario;
use fga_sim::vehicle_file::VehicleModel;

const PAGES: [&str; 7] = [
    include_str!("../../../../docs/scenario-files.md"),
    include_str!("../../../../docs/scenario-areas.md"),
    include_str!("../../../../docs/vehicle-files.md"),
    include_str!("../../../../docs/condition-keys.md"),
    include_str!("../../../../docs/campaign-files.md"),
    include_str!("../../../../docs/link-files.md"),
    include_str!("../../../../docs/link-traffic-files.md"),
];

/// A key of no table; the error about it lists the known ones.
const UNKNOWN: &str = "no_such_key";

/// Keys of the pages, by kind and table.
fn documented() -> BTreeMap<(String, String), BTreeSet<String>> {
    let mut tables = BTreeMap::new();
    let mut table = None;
    for line in PAGES.iter().flat_map(|page| page.lines()) {
        if line.starts_with('#') {
            table = line
                .strip_prefix("## ")
                .and_then(|heading| heading.split_once(": "))
                .map(|(kind, name)| (kind.to_owned(), name.to_owned()));
            if let Some(table) = &table {
                tables.insert(table.clone(), BTreeSet::new());
            }
        } else if let (Some(table), Some(row)) = (&table, line.strip_prefix("| `")) {
            let key = row.split('`').next().unwrap_or_default();
            tables
                .get_mut(table)
                .expect("inserted above")
                .insert(key.to_owned());
        }
    }
    tables
}

/// The keys that an "unknown field" error lists.
fn listed(error: &str) -> BTreeSet<String> {
    let (_, expected) = error
        .split_once(", expected ")
        .unwrap_or_else(|| panic!("no list of keys in: {error}"));
    expected
        .split('`')
        .skip(1)
        .step_by(2)
        .map(str::to_owned)
        .collect()
}

/// The text of a file of a kind with an unknown key in one of its tables.
fn with_unknown_key(kind: &str, table: &str) -> String {
    let whole = match kind {
        "scenario" => "name = 'a'\nduration_s = 10.0\n",
        "vehicle" => "name = 'a'\nairspeed_mps = 15.0\nturn_radius_m = 30.0\n",
        "campaign" => "policies = ['none']\n",
        _ => "",
    };
    match table {
        "top level" => format!("{UNKNOWN} = 1\n{whole}"),
        "sensor" if kind == "campaign" => format!("{whole}[[sensor]]\n{UNKNOWN} = 1\n"),
        "obstacle" | "zone" | "grid" | "model" if kind != "vehicle" => {
            format!("{whole}[[{table}]]\n{UNKNOWN} = 1\n")
        }
        _ => format!("{whole}[{table}]\n{UNKNOWN} = 1\n"),
    }
}

/// The program's error about a file, if any.
fn error_of(kind: &str, text: &str) -> Option<String> {
    let path = Path::new("file.toml");
    match kind {
        "scenario" => scenario::parse(TomlText::new(path, text), None)
            .err()
            .map(|error| error.to_string()),
        "vehicle" => VehicleModel::parse(TomlText::new(path, text))
            .err()
            .map(|error| error.to_string()),
        "campaign" => {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let path = folder.path().join("file.toml");
            std::fs::write(&path, text).expect("written");
            campaign_file::read(&path, &Overrides::default())
                .err()
                .map(|error| error.to_string())
        }
        #[cfg(feature = "fly")]
        "link" => fga_link::Config::parse(text)
            .err()
            .map(|error| error.to_string()),
        other => panic!("{other}: not a kind of file"),
    }
}

#[test]
fn the_reference_lists_every_key_of_every_file() {
    let documented = documented();
    assert!(documented.len() >= 25, "{} tables", documented.len());
    for ((kind, table), keys) in documented {
        if kind == "link" && cfg!(not(feature = "fly")) {
            continue;
        }
        let error = error_of(&kind, &with_unknown_key(&kind, &table)).expect("an unknown key");
        assert!(error.contains(UNKNOWN), "{kind}: {table}: {error}");
        assert_eq!(
            keys,
            listed(&error),
            "{kind}: {table}: documented (left), read by the program (right)"
        );
    }
}

#[test]
fn the_reference_has_a_section_for_every_table() {
    let documented = documented();
    for ((kind, table), keys) in &documented {
        if table != "top level" {
            continue;
        }
        let whole = with_unknown_key(kind, table).replace(&format!("{UNKNOWN} = 1\n"), "");
        for key in keys {
            // Scenario files share these tables with vehicle files, and campaign files one.
            let shared = kind == "scenario" && ["wind", "noise", "sensor"].contains(&key.as_str())
                || kind != "vehicle" && key == "plant";
            let error = error_of(kind, &format!("{key} = 1\n{whole}")).unwrap_or_default();
            if error.contains("expected struct") && !shared {
                let section = (kind.clone(), key.clone());
                assert!(
                    documented.contains_key(&section),
                    "{kind}: no section for {key}"
                );
            }
        }
    }
}
