//! The `[[zone]]` tables of a scenario.

use std::path::{Path, PathBuf};

use fga::Vec2;
use fga_files::scenario::{ZoneKindName, ZoneTable};
use fga_files::vehicle::LimitsTable;
use fga_formats::{InputError, areas, zones};
use toml::Spanned;

use super::places::Places;
use crate::vehicle_file::checks::Checked;
use crate::zone::{WorldOutline, WorldZone};

/// The zones of a file.
pub(super) fn all(
    tables: &[Spanned<ZoneTable>],
    places: &Places<'_>,
) -> Result<Vec<WorldZone>, InputError> {
    let mut zones = Vec::new();
    for (entry, number) in tables.iter().zip(1..) {
        match &entry.get_ref().file {
            Some(file) => zones.extend(of_file(entry, (file, number), places)?),
            None => zones.push(zone(entry, number, places)?),
        }
    }
    Ok(zones)
}

/// The zones of a file of polygons, each with what else its table says.
fn of_file(
    entry: &Spanned<ZoneTable>,
    (file, number): (&Spanned<PathBuf>, usize),
    places: &Places<'_>,
) -> Result<Vec<WorldZone>, InputError> {
    let folder = places.text.path().parent().unwrap_or(Path::new(""));
    let path = folder.join(file.get_ref());
    let areas = areas::read(&path)?;
    let zones = areas.into_iter().map(|area| {
        let span = file.span();
        let mut table = ZoneTable {
            file: None,
            ..entry.get_ref().clone()
        };
        if table.polygon_deg.is_some() || table.polygon_m.is_some() || table.radius_m.is_some() {
            let message = "a zone has a file and an outline of its own, expected one of these";
            return Err(places.text.error_at(entry, message));
        }
        table.name = area.name.or(table.name);
        table.polygon_deg = Some(Spanned::new(span, area.corners_deg));
        zone(&Spanned::new(entry.span(), table), number, places)
    });
    zones.collect()
}

/// The zone of a table, which is the file's `number`th.
fn zone(
    entry: &Spanned<ZoneTable>,
    number: usize,
    places: &Places<'_>,
) -> Result<WorldZone, InputError> {
    let (table, text) = (entry.get_ref(), &places.text);
    let name = table.name.clone();
    let name = name.unwrap_or_else(|| format!("zone {number}"));
    let outline = match (&table.polygon_m, &table.polygon_deg, &table.radius_m) {
        (Some(corners), None, None) => {
            let corners_m: Vec<Vec2> = corners
                .get_ref()
                .iter()
                .map(|at| Vec2::from_array(*at))
                .collect();
            polygon(corners_m, &name).map_err(|message| text.error_at(corners, message))?
        }
        (None, Some(corners), None) => {
            let local = |at| Ok(level(places, corners, "a corner", at)?.truncate());
            let corners_m: Result<Vec<Vec2>, InputError> =
                corners.get_ref().iter().map(local).collect();
            polygon(corners_m?, &name).map_err(|message| text.error_at(corners, message))?
        }
        (None, None, Some(radius)) => WorldOutline::Circle {
            center_m: center(entry, places)?,
            radius_m: text.positive("radius_m", radius)?,
        },
        (None, None, None) => {
            let message = format!(
                "{name} has no outline, expected polygon_m, polygon_deg, file, or radius_m with a centre"
            );
            return Err(text.error_at(entry, message));
        }
        _ => {
            let message = format!(
                "{name} has more than one outline, expected one of polygon_m, polygon_deg and radius_m"
            );
            return Err(text.error_at(entry, message));
        }
    };
    let is_circle = matches!(outline, WorldOutline::Circle { .. });
    if !is_circle && (table.center_m.is_some() || table.center_deg.is_some()) {
        let message =
            format!("{name} is a polygon with a centre, expected radius_m beside a centre");
        return Err(text.error_at(entry, message));
    }
    let limits = LimitsTable {
        floor_m: table.floor_m.clone(),
        ceiling_m: table.ceiling_m.clone(),
    };
    let keep_in = table.kind == ZoneKindName::KeepIn;
    WorldZone::new(name.clone(), keep_in, outline, limits.checked(text)?)
        .map_err(|error| text.error_at(entry, format!("{name}: {error}")))
}

fn polygon(corners_m: Vec<Vec2>, name: &str) -> Result<WorldOutline, String> {
    let corners_m = zones::polygon(corners_m).map_err(|error| format!("{name}: {error}"))?;
    Ok(WorldOutline::Polygon(corners_m))
}

fn center(entry: &Spanned<ZoneTable>, places: &Places<'_>) -> Result<Vec2, InputError> {
    let table = entry.get_ref();
    match (&table.center_m, &table.center_deg) {
        (Some(center), None) => {
            let [east_m, north_m] = *center.get_ref();
            let at = Spanned::new(center.span(), [east_m, north_m, 0.0]);
            Ok(places.local("center_m", &at)?.truncate())
        }
        (None, Some(center)) => {
            Ok(level(places, center, "center_deg", center.get_ref())?.truncate())
        }
        _ => Err(places.text.error_at(
            entry,
            "a circle has no centre of its own, expected one of center_m and center_deg beside radius_m",
        )),
    }
}

/// A place of latitude and longitude at the altitude of the origin.
fn level<T>(
    places: &Places<'_>,
    near: &Spanned<T>,
    key: &str,
    [latitude_deg, longitude_deg]: &[f64; 2],
) -> Result<fga::Vec3, InputError> {
    let altitude_m = (places.frame.as_ref()).map_or(0.0, |frame| frame.origin().altitude_m);
    let place = [*latitude_deg, *longitude_deg, altitude_m];
    places.geodetic(key, &Spanned::new(near.span(), place))
}
