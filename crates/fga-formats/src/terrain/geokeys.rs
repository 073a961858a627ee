//! The GeoKeys of a TIFF (OGC GeoTIFF 1.1): its coordinates, its datum, and whether its pixels are points or areas.

use super::{Datum, Stated};
use crate::units::FOOT_M;

/// Model: 1 projected, 2 geographic, 3 earth-centred.
pub(super) const MODEL: u16 = 1024;
/// Raster: 1 areas, 2 points.
pub(super) const RASTER: u16 = 1025;
/// Geographic coordinates, by their number of EPSG.
pub(super) const GEOGRAPHIC: u16 = 2048;
pub(super) const ANGULAR_UNITS: u16 = 2054;
/// A map's grid, by its number of EPSG.
const PROJECTED: u16 = 3072;
/// Vertical datum, by its number of EPSG.
pub(super) const VERTICAL: u16 = 4096;
pub(super) const VERTICAL_UNITS: u16 = 4099;

const DEGREE: u16 = 9102;
/// Units of heights by their numbers of EPSG, metres.
const UNITS_M: [(u16, f64); 3] = [(9001, 1.0), (9002, FOOT_M), (9003, SURVEY_FOOT_M)];
/// A foot of the surveys of the United States, metres.
pub(super) const SURVEY_FOOT_M: f64 = 1200.0 / 3937.0;
/// National and European sea levels within 1 m of EGM2008: EVRF2000, 2007 and 2019, DHHN92 and 2016, France, Netherlands, Switzerland (2),
/// Great Britain, Sweden, Finland, Norway, Italy, Spain, Denmark, Austria, Australia.
const NATIONAL: [u16; 18] = [
    5730, 5621, 9389, 5783, 7837, 5720, 5709, 5728, 5729, 5701, 5613, 3900, 5941, 5214, 5782, 5799,
    5778, 5711,
];
/// A key that says nothing.
const UNDEFINED: u16 = 0;
const USER_DEFINED: u16 = 32767;

/// What the keys say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GeoKeys {
    /// Whether a pixel is a point; otherwise it is an area, and the file gives the area's corner.
    pub is_point: bool,
    /// Whether they name a vertical datum.
    pub is_vertical: bool,
    /// The unit of heights, metres.
    pub vertical_unit_m: f64,
    pub datum: Stated<Datum>,
    /// The map's grid by its number of EPSG; otherwise the coordinates are degrees.
    pub projected: Option<u16>,
}

/// The number of EPSG of the vertical part of a datum, and of its geographic part.
pub(super) const fn codes(datum: Datum) -> (u16, Option<u16>) {
    match datum {
        Datum::Egm96 => (4326, Some(5773)),
        Datum::Egm2008 => (4326, Some(3855)),
        Datum::Navd88 => (4326, Some(5703)),
        Datum::Ellipsoid => (4979, None),
    }
}

/// Reads the directory of keys.
pub(super) fn read(directory: &[u16]) -> Result<GeoKeys, String> {
    let Some(([1, _, _, count], entries)) = directory.split_first_chunk::<4>() else {
        return Err("has no usable GeoKeys, expected a GeoTIFF with geographic coordinates".into());
    };
    let (entries, _) = entries.as_chunks::<4>();
    // Only keys that hold their value themselves count here.
    let key = |wanted: u16| {
        entries
            .iter()
            .take(usize::from(*count))
            .find(|[key, location, _, _]| *key == wanted && *location == 0)
            .map(|[.., value]| *value)
            .filter(|value| *value != UNDEFINED && *value != USER_DEFINED)
    };
    let model = key(MODEL);
    if model.is_some_and(|model| ![1, 2].contains(&model)) {
        return Err(format!(
            "has coordinates of an unknown or earth-centred model (GeoKey {MODEL} is {}), expected geographic or projected ones",
            model.unwrap_or(UNDEFINED)
        ));
    }
    let projected = key(PROJECTED).filter(|_| model == Some(1));
    if model == Some(1) && projected.is_none() {
        return Err(format!(
            "has a projection of its own (no number of EPSG in GeoKey {PROJECTED}), expected a grid that has a number, as UTM and national ones do"
        ));
    }
    let geographic = key(GEOGRAPHIC).filter(|_| projected.is_none());
    let geographic = geographic.unwrap_or(4326);
    // NAD83 and ETRS89 are within two metres of WGS84, far below any spacing of heights.
    if ![4326, 4979, 4269, 4258].contains(&geographic) {
        return Err(format!(
            "has the coordinates EPSG:{geographic} (GeoKey {GEOGRAPHIC}), expected WGS84 (4326, 4979), NAD83 (4269) or ETRS89 (4258)"
        ));
    }
    let wrong_unit = |found: u16, wanted: u16, expected: &str| {
        Err(format!(
            "has the unit EPSG:{found} (GeoKey {wanted}), expected {expected}"
        ))
    };
    if let Some(found) = key(ANGULAR_UNITS)
        && found != DEGREE
        && projected.is_none()
    {
        return wrong_unit(found, ANGULAR_UNITS, "degrees (9102)");
    }
    let unit = key(VERTICAL_UNITS).unwrap_or(9001);
    let Some((_, vertical_unit_m)) = UNITS_M.iter().find(|(code, _)| *code == unit) else {
        return wrong_unit(unit, VERTICAL_UNITS, "metres (9001) or feet (9002, 9003)");
    };
    Ok(GeoKeys {
        is_point: key(RASTER) == Some(2),
        is_vertical: key(VERTICAL).is_some(),
        vertical_unit_m: *vertical_unit_m,
        datum: datum(geographic, key(VERTICAL))?,
        projected,
    })
}

fn datum(geographic: u16, vertical: Option<u16>) -> Result<Stated<Datum>, String> {
    let source = "the file's GeoKeys";
    let value = match (vertical, geographic) {
        (Some(5773), _) => Datum::Egm96,
        (Some(3855), _) => Datum::Egm2008,
        (Some(5703), _) => Datum::Navd88,
        // Old files have the number of the ellipsoid here.
        (Some(4979 | 5030), _) | (None, 4979) => Datum::Ellipsoid,
        (None, _) => {
            return Ok(Stated {
                value: Datum::Egm96,
                source: "assumed: the file does not say",
            });
        }
        (Some(other), _) if NATIONAL.contains(&other) => {
            return Ok(Stated {
                value: Datum::Egm2008,
                source: "within 1 m: the file's GeoKeys name a national sea level",
            });
        }
        (Some(other), _) => {
            return Err(format!(
                "has the vertical datum EPSG:{other} (GeoKey {VERTICAL}), expected EGM96 (5773), EGM2008 (3855), NAVD88 (5703), a national sea level of Europe or the ellipsoid (4979)"
            ));
        }
    };
    Ok(Stated { value, source })
}
