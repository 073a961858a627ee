//! Ground and zones around the encounters of a table: a file for each of them, in the local frame of the table.

use alloc::sync::Arc;
use std::path::{Path, PathBuf};

use fga::Vec2;
use fga_formats::encounters::Encounter;
use fga_formats::error::read_bytes;
use fga_formats::{InputError, OutputError, atomic, zones};
use fga_sim::fingerprint::fingerprint;
use fga_sim::world::{WorldGround, WorldOutline, WorldZone};
use serde::{Deserialize, Serialize};

use crate::encounters::Scenery;

/// The folder with the files, beside the table.
pub const SURROUNDINGS: &str = "surroundings";

/// Where the ground and the zones around the encounters of a table are, if it has any.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SceneryFolder {
    folder: Option<PathBuf>,
}

impl SceneryFolder {
    /// Those of the table in a file: its folder's `surroundings/`, if there is one.
    pub fn of_table(table: &Path) -> Self {
        let folder = table.with_file_name(SURROUNDINGS);
        Self {
            folder: folder.is_dir().then_some(folder),
        }
    }

    /// Whether there are any; every encounter of the table then has a file.
    pub const fn exist(&self) -> bool {
        self.folder.is_some()
    }

    /// The ground and the zones around an encounter; none where the table has none.
    ///
    /// # Errors
    /// A file that is missing, or holds ground or a zone that cannot be.
    pub fn scenery(&self, encounter: u64) -> Result<Scenery, InputError> {
        let Some(folder) = &self.folder else {
            return Ok(Scenery::default());
        };
        let path = folder.join(file_name(encounter));
        let bytes = read_bytes(&path)?;
        let wrong = |message: String| InputError::in_file(&path, message);
        let file: SceneryFile = serde_json::from_slice(&bytes)
            .map_err(|error| wrong(format!("holds no surroundings: {error}")))?;
        file.scenery().map_err(wrong)
    }

    /// The fingerprint of a table's bytes, and of the surroundings of its encounters.
    ///
    /// # Errors
    /// A file that is missing.
    pub fn fingerprint(
        &self,
        table: &[u8],
        encounters: &[Encounter],
    ) -> Result<String, InputError> {
        let mut print = fingerprint(table);
        let Some(folder) = &self.folder else {
            return Ok(print);
        };
        for encounter in encounters {
            let path = folder.join(file_name(encounter.id));
            print.push_str(&fingerprint(&read_bytes(&path)?));
        }
        Ok(fingerprint(print.as_bytes()))
    }
}

/// Writes the ground and the zones around an encounter into the folder of its table, whose `surroundings/` exists.
///
/// # Errors
/// Errors of the output.
pub fn write_surroundings(
    folder: &Path,
    encounter: u64,
    scenery: &Scenery,
) -> Result<(), OutputError> {
    let path = folder.join(SURROUNDINGS).join(file_name(encounter));
    let text = serde_json::to_string(&SceneryFile::of(scenery));
    let text = text.map_err(|error| OutputError::new(&path, std::io::Error::other(error)))?;
    atomic::write(&path, text + "\n")
}

fn file_name(encounter: u64) -> String {
    format!("{encounter:08}.json")
}

/// A file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneryFile {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ground: Option<WrittenGround>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    zones: Vec<WrittenZone>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenGround {
    corner_m: [f64; 2],
    spacing_m: [f64; 2],
    columns: usize,
    vertical_error_m: f64,
    clearance_m: f64,
    /// Row by row from the south-west post on; null where unknown.
    heights_m: Vec<Option<f32>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenZone {
    name: String,
    keep_in: bool,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    polygon_m: Vec<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    circle: Option<WrittenCircle>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    floor_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ceiling_m: Option<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenCircle {
    center_m: [f64; 2],
    radius_m: f64,
}

impl SceneryFile {
    fn of(scenery: &Scenery) -> Self {
        let ground = scenery.ground.as_ref().map(|ground| {
            let ((corner_m, spacing_m), columns, heights_m) = ground.posts();
            let known = |height_m: &f32| height_m.is_finite().then_some(*height_m);
            WrittenGround {
                corner_m: corner_m.into(),
                spacing_m: spacing_m.into(),
                columns,
                vertical_error_m: ground.error_m(),
                clearance_m: ground.clearance_m(),
                heights_m: heights_m.iter().map(known).collect(),
            }
        });
        let zones = scenery.zones.iter().map(|zone| {
            let (floor_m, ceiling_m) = zone.heights_m();
            let (polygon_m, circle) = match zone.outline() {
                WorldOutline::Polygon(corners_m) => (
                    corners_m.iter().map(|corner| (*corner).into()).collect(),
                    None,
                ),
                WorldOutline::Circle { center_m, radius_m } => {
                    let (center_m, radius_m) = ((*center_m).into(), *radius_m);
                    (Vec::new(), Some(WrittenCircle { center_m, radius_m }))
                }
            };
            WrittenZone {
                name: zone.name().to_owned(),
                keep_in: zone.keep_in(),
                polygon_m,
                circle,
                floor_m: floor_m.is_finite().then_some(floor_m),
                ceiling_m: ceiling_m.is_finite().then_some(ceiling_m),
            }
        });
        Self {
            ground,
            zones: zones.collect(),
        }
    }

    fn scenery(self) -> Result<Scenery, String> {
        let ground = self.ground.map(|ground| {
            let place = (ground.corner_m.into(), ground.spacing_m.into());
            let is_height = ground.heights_m.iter().flatten().all(|height_m| height_m.is_finite());
            let known = |height_m: Option<f32>| height_m.unwrap_or(f32::NAN);
            let heights_m = ground.heights_m.into_iter().map(known).collect();
            let asked_m = (ground.vertical_error_m, ground.clearance_m);
            let made = WorldGround::new(place, ground.columns, heights_m, asked_m);
            made.ok().filter(|_| is_height).map(Arc::new).ok_or(
                "holds ground that cannot be, expected two rows of columns or more, heights as numbers or null, a positive spacing_m, and vertical_error_m and clearance_m of 0 or more",
            )
        });
        Ok(Scenery {
            ground: ground.transpose()?,
            zones: self
                .zones
                .into_iter()
                .map(WrittenZone::zone)
                .collect::<Result<_, _>>()?,
        })
    }
}

impl WrittenZone {
    fn zone(self) -> Result<WorldZone, String> {
        let name = self.name;
        let wrong = |message: &dyn core::fmt::Display| format!("zone {name}: {message}");
        let outline = match self.circle {
            Some(circle) if self.polygon_m.is_empty() && circle.radius_m > 0.0 => {
                WorldOutline::Circle {
                    center_m: circle.center_m.into(),
                    radius_m: circle.radius_m,
                }
            }
            Some(_) => {
                return Err(wrong(
                    &"expected a polygon_m, or a circle with a positive radius_m",
                ));
            }
            None => {
                let corners_m = self.polygon_m.into_iter().map(Vec2::from).collect();
                let corners_m = zones::polygon(corners_m).map_err(|error| wrong(&error))?;
                WorldOutline::Polygon(corners_m)
            }
        };
        let heights_m = (
            self.floor_m.unwrap_or(f64::NEG_INFINITY),
            self.ceiling_m.unwrap_or(f64::INFINITY),
        );
        WorldZone::new(name.clone(), self.keep_in, outline, heights_m)
            .map_err(|error| wrong(&error))
    }
}
