//! The tables of a scenario file as they are written.

use std::path::PathBuf;

use fga::situation::{Movement, ObstacleKind, Passing};
use serde::Deserialize;
use toml::Spanned;

use crate::vehicle_file::{NoiseTable, SensorTable, WindTable};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) name: String,
    #[serde(default)]
    pub(super) description: String,
    pub(super) duration_s: Spanned<f64>,
    #[serde(default)]
    pub(super) seed: u64,
    pub(super) vehicle: Option<PathBuf>,
    pub(super) origin: Option<Spanned<Origin>>,
    pub(super) mission: MissionTable,
    pub(super) start: Option<StartTable>,
    pub(super) wind: Option<WindTable>,
    pub(super) noise: Option<NoiseTable>,
    pub(super) sensor: Option<SensorTable>,
    #[serde(default)]
    pub(super) obstacle: Vec<Spanned<ObstacleTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Origin {
    pub(super) latitude_deg: f64,
    pub(super) longitude_deg: f64,
    #[serde(default)]
    pub(super) altitude_m: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MissionTable {
    pub(super) waypoints_m: Option<Spanned<Vec<Spanned<[f64; 3]>>>>,
    pub(super) waypoints_deg: Option<Spanned<Vec<Spanned<[f64; 3]>>>>,
    #[serde(default)]
    pub(super) passing: Option<Spanned<Vec<Spanned<PassingName>>>>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(super) enum PassingName {
    FlyBy,
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StartTable {
    pub(super) position_m: Option<Spanned<[f64; 3]>>,
    pub(super) position_deg: Option<Spanned<[f64; 3]>>,
    pub(super) course_deg: Option<Spanned<f64>>,
    pub(super) climb_deg: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObstacleTable {
    pub(super) id: Option<Spanned<u32>>,
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) kind: KindName,
    pub(super) position_m: Option<Spanned<[f64; 3]>>,
    pub(super) position_deg: Option<Spanned<[f64; 3]>>,
    pub(super) velocity_mps: Option<Spanned<[f64; 3]>>,
    pub(super) track_m: Option<Spanned<Vec<[f64; 4]>>>,
    pub(super) radius_m: Option<Spanned<f64>>,
    pub(super) half_height_m: Option<Spanned<f64>>,
    pub(super) appears_s: Option<Spanned<f64>>,
    #[serde(default)]
    pub(super) movement: MovementName,
}

#[derive(Deserialize, Default, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(super) enum KindName {
    Passengers,
    #[default]
    Unknown,
    NaturalBarrier,
}

#[derive(Deserialize, Default, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(super) enum MovementName {
    Still,
    #[default]
    Straight,
    Aircraft,
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
