//! The tables of a campaign file. `docs/campaign-files.md` gives the limits and defaults of each key.

use fga_formats::InputError;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::TomlText;
use crate::sensors::SensorSource;
use crate::vehicle::PlantTable;

/// A campaign file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CampaignFile {
    /// Name for people; without it the file's.
    pub name: Option<String>,
    /// Words for people.
    pub description: Option<String>,
    /// Number of encounters, over all cells.
    pub encounters: Option<Spanned<u64>>,
    /// Master seeds.
    pub seeds: Option<Spanned<Vec<u64>>>,
    /// Policies by their names on the command line.
    pub policies: Spanned<Vec<Spanned<String>>>,
    /// The policy by which intruders with tracks react; without it they fly their tracks.
    pub intruders: Option<Spanned<String>>,
    /// Longest time flown in an encounter, seconds.
    pub horizon_s: Option<Spanned<f64>>,
    /// Vehicle file, beside this file.
    pub vehicle: Option<Spanned<String>>,
    /// Files of encounters, beside this file.
    #[serde(default)]
    pub files: Vec<Spanned<String>>,
    /// Cells by their names.
    #[serde(default)]
    pub cells: Vec<Spanned<String>>,
    /// Encounters with logged events, by number.
    #[serde(default)]
    pub events: Vec<Spanned<u64>>,
    /// Recordings or folders of them, beside this file.
    #[serde(default)]
    pub recordings: Vec<Spanned<String>>,
    /// Grids of conditions.
    #[serde(default)]
    pub grid: Vec<Spanned<CellGrid>>,
    /// Encounter models.
    #[serde(default)]
    pub model: Vec<Spanned<Model>>,
    /// Sources instead of the vehicle's sensor.
    #[serde(default)]
    pub sensor: Vec<Spanned<SensorSource>>,
    /// What the simulated aircraft does otherwise than decisions believe.
    #[serde(default)]
    pub plant: PlantTable,
}

impl CampaignFile {
    /// Reads the tables of a campaign file.
    ///
    /// # Errors
    /// Text that is not TOML, or an unknown or missing key, with its line.
    pub fn read(text: &TomlText<'_>) -> Result<Self, InputError> {
        text.read()
    }
}

/// `[[model]]`: an encounter model and how its aircraft meet.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Its file, beside this one.
    pub file: Option<String>,
    /// The ownship's flight.
    pub ownship: Option<OwnshipFlight>,
    /// Time of the closest approach, whole seconds.
    pub cpa_s: Option<u32>,
    /// Length of the encounter, whole seconds.
    pub duration_s: Option<u32>,
    /// Largest miss distances: horizontal, vertical, metres.
    pub cylinder_m: Option<[f64; 2]>,
    /// Miss distances of the aimed encounters, metres.
    pub aimed_m: Option<[f64; 2]>,
    /// Share of the aimed encounters.
    pub aimed_share: Option<f64>,
    /// Altitudes of the ownship, metres above ground.
    pub altitude_m: Option<[f64; 2]>,
    /// Speeds of the ownship, metres per second.
    pub ownship_speed_mps: Option<[f64; 2]>,
    /// Speeds of the intruder, metres per second.
    pub intruder_speed_mps: Option<[f64; 2]>,
}

/// The ownship's flight before it avoids.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OwnshipFlight {
    /// Straight and level, at the vehicle's airspeed or at one drawn from the speeds of the ownship.
    #[default]
    Vehicle,
    /// A flight of the model.
    Model,
}

/// `[[grid]]`: every combination is a cell.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CellGrid {
    /// Family of encounters.
    pub family: Spanned<String>,
    /// Numbers of intruders.
    pub count: Spanned<Vec<Spanned<u32>>>,
    /// Distances at which they are first seen, metres.
    pub first_seen_m: Spanned<Vec<Spanned<NumberOrRange>>>,
    /// Their speeds, metres per second.
    pub speed_mps: Spanned<Vec<Spanned<NumberOrRange>>>,
    /// Whether all stay at one altitude.
    #[serde(default)]
    pub planar: Option<Spanned<Vec<bool>>>,
    /// Whether aircraft fly by that are no threat.
    #[serde(default)]
    pub bystanders: bool,
}

/// A number, or a range.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(untagged, expecting = "expected a number or [from, to]")]
pub enum NumberOrRange {
    /// `v`
    One(f64),
    /// `[from, to]`
    FromTo([f64; 2]),
}

impl core::fmt::Display for NumberOrRange {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::One(value) => write!(f, "{value}"),
            Self::FromTo([from, to]) => write!(f, "{from}-{to}"),
        }
    }
}
