//! The heights of the ground that a configuration names.

use alloc::sync::Arc;
use std::path::Path;

use fga_formats::InputError;
use fga_formats::terrain::{Given, Terrain};

use super::{Config, ConfigError, TerrainConfig};
use crate::ground::SIDES_M;

impl Config {
    /// The keys of the ground that are usable one by one and not together.
    pub(super) fn check_terrain(&self) -> Result<(), ConfigError> {
        let TerrainConfig {
            file,
            source,
            clearance_m,
        } = &self.terrain;
        let message = match (file, source, clearance_m) {
            (Some(_), Some(_), _) => {
                "terrain.file and terrain.source are given, expected one of them"
            }
            (Some(_), _, None) => {
                "terrain.file is given without terrain.clearance_m, expected the least height above the ground, m"
            }
            (_, Some(_), None) => {
                "terrain.source is given without terrain.clearance_m, expected the least height above the ground, m"
            }
            (None, None, Some(_)) => {
                "terrain.clearance_m is given without terrain.file or terrain.source, expected one of them"
            }
            _ => return Ok(()),
        };
        Err(ConfigError(message.to_owned()))
    }

    /// Reads the heights of the ground from the files beside the configuration in a folder; `None` without files.
    ///
    /// # Errors
    /// An unusable file, or heights above the ellipsoid.
    pub fn read_terrain(&self, folder: &Path) -> Result<Option<Arc<Terrain>>, InputError> {
        let Some(files) = &self.terrain.file else {
            return Ok(None);
        };
        let files = files.within(folder);
        let terrain = Terrain::read(&files, &Given::default())?;
        let first = files.first().map_or(folder, |file| file);
        let latitude_deg = terrain
            .area()
            .map_or(0.0, |area| area.north_deg.abs().max(area.south_deg.abs()));
        let is_usable = terrain.sea_level();
        let is_usable = is_usable.and_then(|()| terrain.posts(latitude_deg, SIDES_M));
        is_usable.map_err(|message| InputError::in_file(first, message))?;
        Ok(Some(Arc::new(terrain)))
    }
}
