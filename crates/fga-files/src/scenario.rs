//! The tables of a scenario file. `docs/scenario-files.md` gives the limits and defaults of each key.

use std::path::{Path, PathBuf};

use fga::situation::{Movement, ObstacleKind, Passing};
use fga_formats::InputError;
use serde::Deserialize;
use toml::Spanned;

use crate::TomlText;
use crate::vehicle::{LimitsTable, NoiseTable, PlantTable, SensorTable, WindTable};

/// A scenario file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioFile {
    /// Name for people.
    pub name: String,
    /// Words for people.
    #[serde(default)]
    pub description: String,
    /// Longest flight, seconds.
    pub duration_s: Spanned<f64>,
    /// Seed of the sensor's noise.
    #[serde(default)]
    pub seed: u64,
    /// Vehicle file, beside this file.
    pub vehicle: Option<PathBuf>,
    /// Origin of the local frame on the earth.
    pub origin: Option<Spanned<ScenarioOrigin>>,
    /// The mission.
    pub mission: MissionTable,
    /// The aircraft at the start.
    pub start: Option<StartTable>,
    /// Altitudes of the flight.
    #[serde(default)]
    pub limits: LimitsTable,
    /// The wind.
    pub wind: Option<WindTable>,
    /// Noise of the sensor.
    pub noise: Option<NoiseTable>,
    /// The sensor.
    pub sensor: Option<SensorTable>,
    /// What the simulated aircraft does otherwise than decisions believe.
    #[serde(default)]
    pub plant: PlantTable,
    /// Obstacles.
    #[serde(default)]
    pub obstacle: Vec<Spanned<ObstacleTable>>,
    /// Zones.
    #[serde(default)]
    pub zone: Vec<Spanned<ZoneTable>>,
    /// The ground.
    pub terrain: Option<Spanned<TerrainTable>>,
}

impl ScenarioFile {
    /// Reads the tables of a scenario file.
    ///
    /// # Errors
    /// Text that is not TOML, or an unknown or missing key, with its line.
    pub fn read(text: &TomlText<'_>) -> Result<Self, InputError> {
        text.read()
    }
}

/// `[origin]` of the local frame.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioOrigin {
    /// Geodetic latitude, degrees.
    pub latitude_deg: f64,
    /// Longitude, degrees.
    pub longitude_deg: f64,
    /// Height above the ellipsoid, metres.
    #[serde(default)]
    pub altitude_m: f64,
}

/// `[mission]`: waypoints in one of two frames.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MissionTable {
    /// East, north, up, metres.
    pub waypoints_m: Option<Spanned<Vec<Spanned<[f64; 3]>>>>,
    /// Latitude and longitude, degrees, altitude, metres.
    pub waypoints_deg: Option<Spanned<Vec<Spanned<[f64; 3]>>>>,
    /// How each is passed.
    #[serde(default)]
    pub passing: Option<Spanned<Vec<Spanned<PassingName>>>>,
}

/// Word for how a waypoint is passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PassingName {
    /// `fly-by`
    FlyBy,
    /// `fly-over`
    FlyOver,
}

impl From<PassingName> for Passing {
    fn from(name: PassingName) -> Self {
        match name {
            PassingName::FlyBy => Self::FlyBy,
            PassingName::FlyOver => Self::FlyOver,
        }
    }
}

/// `[start]`: the aircraft at the start.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StartTable {
    /// East, north, up, metres.
    pub position_m: Option<Spanned<[f64; 3]>>,
    /// Latitude and longitude, degrees, altitude, metres.
    pub position_deg: Option<Spanned<[f64; 3]>>,
    /// Course over the ground, compass degrees.
    pub course_deg: Option<Spanned<f64>>,
    /// Climb angle through the air, degrees.
    pub climb_deg: Option<Spanned<f64>>,
}

/// `[[obstacle]]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObstacleTable {
    /// Number; without it its place in the file.
    pub id: Option<Spanned<u32>>,
    /// Name for people.
    pub name: Option<String>,
    /// What it is.
    pub nature: Option<KindName>,
    /// The name of `nature` until 0.2.
    pub kind: Option<Spanned<KindName>>,
    /// East, north, up at time 0, metres.
    pub position_m: Option<Spanned<[f64; 3]>>,
    /// Latitude and longitude, degrees, altitude, metres, at time 0.
    pub position_deg: Option<Spanned<[f64; 3]>>,
    /// East, north, up, metres per second.
    pub velocity_mps: Option<Spanned<[f64; 3]>>,
    /// Time, seconds, and east, north, up, metres.
    pub track_m: Option<Spanned<Vec<[f64; 4]>>>,
    /// Radius of its protected volume, metres.
    pub radius_m: Option<Spanned<f64>>,
    /// Half of a cylinder's height, metres.
    pub half_height_m: Option<Spanned<f64>>,
    /// Standard deviation of its position on the chart, metres.
    pub chart_error_m: Option<Spanned<f64>>,
    /// Time from which it is seen, seconds.
    pub appears_s: Option<Spanned<f64>>,
    /// How it may move.
    #[serde(default)]
    pub movement: MovementName,
}

impl ObstacleTable {
    /// What the obstacle is, by either name.
    pub fn nature(&self) -> KindName {
        let old = self.kind.as_ref().map(|kind| *kind.get_ref());
        self.nature.or(old).unwrap_or_default()
    }
}

/// `[[zone]]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ZoneTable {
    /// Name for people.
    pub name: Option<String>,
    /// Which side the aircraft keeps to.
    pub kind: ZoneKindName,
    /// Corners in order: east, north, metres.
    pub polygon_m: Option<Spanned<Vec<[f64; 2]>>>,
    /// Corners in order: latitude and longitude, degrees.
    pub polygon_deg: Option<Spanned<Vec<[f64; 2]>>>,
    /// Centre of a circle: east, north, metres.
    pub center_m: Option<Spanned<[f64; 2]>>,
    /// Centre of a circle: latitude and longitude, degrees.
    pub center_deg: Option<Spanned<[f64; 2]>>,
    /// Radius of a circle, metres.
    pub radius_m: Option<Spanned<f64>>,
    /// File of areas, each a zone of its own: GeoJSON, KML, ED-269, ED-318, or fences of a mission.
    pub file: Option<Spanned<PathBuf>>,
    /// Its lowest altitude, metres.
    pub floor_m: Option<Spanned<f64>>,
    /// Its highest altitude, metres.
    pub ceiling_m: Option<Spanned<f64>>,
    /// What the two are above.
    pub above: Option<Spanned<AboveName>>,
}

/// `[terrain]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TerrainTable {
    /// Files of heights of the ground, beside this file.
    pub file: Spanned<TerrainFiles>,
    /// Least height above the ground beyond its vertical error, metres.
    pub clearance_m: Spanned<f64>,
}

/// One file of heights, or several.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(untagged, expecting = "a file of heights or a list of files")]
pub enum TerrainFiles {
    /// One.
    One(PathBuf),
    /// Where several know a height, the first one counts.
    Several(Vec<PathBuf>),
}

impl TerrainFiles {
    /// Their paths, from a folder.
    pub fn within(&self, folder: &Path) -> Vec<PathBuf> {
        match self {
            Self::One(file) => vec![folder.join(file)],
            Self::Several(files) => files.iter().map(|file| folder.join(file)).collect(),
        }
    }
}

/// Word for the side of a zone that the aircraft keeps to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ZoneKindName {
    /// `keep-out`
    KeepOut,
    /// `keep-in`
    KeepIn,
}

/// Word for what heights are above, instead of z = 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AboveName {
    /// `ground`
    Ground,
}

/// Word for what an obstacle is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum KindName {
    /// `passengers`
    Passengers,
    /// `unknown`
    #[default]
    Unknown,
    /// `natural-barrier`
    NaturalBarrier,
}

/// Word for how an obstacle may move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum MovementName {
    /// `still`
    Still,
    /// `straight`
    #[default]
    Straight,
    /// `aircraft`
    Aircraft,
    /// `uas`
    Uas,
}

impl From<MovementName> for Movement {
    fn from(name: MovementName) -> Self {
        match name {
            MovementName::Still => Self::AtRest,
            MovementName::Straight => Self::Straight,
            MovementName::Aircraft => Self::CREWED,
            MovementName::Uas => Self::SMALL_UAS,
        }
    }
}

impl From<KindName> for ObstacleKind {
    fn from(name: KindName) -> Self {
        match name {
            KindName::Passengers => Self::Passengers,
            KindName::Unknown => Self::Unknown,
            KindName::NaturalBarrier => Self::NaturalBarrier,
        }
    }
}
