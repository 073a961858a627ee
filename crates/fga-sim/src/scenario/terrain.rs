//! The `[terrain]` table of a scenario.

use alloc::sync::Arc;
use std::path::Path;

use fga::Vec3;
use fga_files::scenario::TerrainTable;
use fga_formats::InputError;
use fga_formats::terrain::{Given, Terrain};
use toml::Spanned;

use super::places::FilePlaces;
use crate::world::WorldGround;

/// Largest clearance, metres.
const MOST_CLEARANCE_M: f64 = 10_000.0;

/// The heights of the files, and the ground around places of a flight, metres.
pub(super) fn read(
    table: &Spanned<TerrainTable>,
    places: &FilePlaces<'_>,
    flown_m: &[Vec3],
) -> Result<(Terrain, Arc<WorldGround>), InputError> {
    let (text, entry) = (&places.text, table.get_ref());
    let Some(frame) = &places.frame else {
        let message = "terrain has heights by latitude and longitude, expected an [origin] with latitude_deg, longitude_deg and altitude_m";
        return Err(text.error_at(table, message));
    };
    let clearance_m = text.within("clearance_m", &entry.clearance_m, (0.0, MOST_CLEARANCE_M))?;
    let folder = text.path().parent().unwrap_or(Path::new(""));
    let files = entry.file.get_ref().within(folder);
    if files.is_empty() {
        return Err(text.error_at(&entry.file, "terrain has no file, expected at least one"));
    }
    let terrain = Terrain::read(&files, &Given::default())?;
    let ground = WorldGround::around(&terrain, frame, flown_m, clearance_m);
    let ground =
        ground.map_err(|message| text.error_at(&entry.file, format!("terrain {message}")))?;
    Ok((terrain, Arc::new(ground)))
}
