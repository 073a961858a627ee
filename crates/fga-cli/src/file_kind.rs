//! The kinds of TOML file that people write for fga.

use alloc::collections::BTreeSet;

use clap::ValueEnum;

/// A kind of TOML file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FileKind {
    /// A mission and its obstacles, for `fga run`.
    Scenario,
    /// An aircraft, its protected volume and its sensor.
    Vehicle,
    /// Conditions, policies and seeds, for `fga campaign run`.
    Campaign,
    /// The configuration of `fga fly`.
    Link,
}

impl FileKind {
    /// A commented file of this kind.
    pub(crate) const fn template(self) -> &'static str {
        match self {
            Self::Scenario => include_str!("../templates/scenario.toml"),
            Self::Vehicle => include_str!("../templates/vehicle.toml"),
            Self::Campaign => include_str!("../templates/campaign.toml"),
            Self::Link => include_str!("../templates/link.toml"),
        }
    }

    /// The next step with a file of this kind.
    pub(crate) fn next_step(self, file: &str) -> String {
        match self {
            Self::Scenario => format!("fly it with: fga run {file}"),
            Self::Vehicle => format!("use it with: --vehicle {file}"),
            Self::Campaign => format!("fly it with: fga campaign run {file}"),
            Self::Link => format!("use it with: fga fly --connect ENDPOINT --config {file}"),
        }
    }

    /// The kind of a file, by the keys that only this kind has.
    pub(crate) fn of(keys: &BTreeSet<String>) -> Option<Self> {
        const LINK: [&str; 12] = [
            "vehicle",
            "protection",
            "volumes",
            "command",
            "limits",
            "terrain",
            "safety",
            "response",
            "traffic",
            "alerts",
            "link",
            "obstacle",
        ];
        let has = |key: &str| keys.contains(key);
        if has("mission") {
            Some(Self::Scenario)
        } else if has("airspeed_mps") {
            Some(Self::Vehicle)
        } else if has("policies") {
            Some(Self::Campaign)
        } else if keys.iter().all(|key| LINK.contains(&key.as_str())) {
            Some(Self::Link)
        } else {
            None
        }
    }
}

impl core::fmt::Display for FileKind {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Scenario => "scenario",
            Self::Vehicle => "vehicle",
            Self::Campaign => "campaign",
            Self::Link => "link",
        })
    }
}
