//! Areas of a map and of authorities: GeoJSON (RFC 7946), KML 2.2 and KMZ, `OpenAir`, AIXM 5.1, and UAS geographical zones as EUROCAE ED-269 and ED-318 write them;
//! fences of [`missions`].
//!
//! Files of areas hold corners as longitude, latitude and perhaps an altitude, and end a ring with its first corner. What of a file is no
//! area, or is said in a way that is not known, is named in [`AreaFile::notes`].
//!
//! Which line an edge is in each format: `docs/missions.md`.

mod aixm;
mod arcs;
mod area;
mod check;
mod ed269;
mod fences;
mod geojson;
mod kml;
mod limits;
mod mended;
mod openair;
mod plane;
mod taken;
#[cfg(test)]
mod tests;

use alloc::borrow::Cow;
use alloc::collections::BTreeMap;
use std::io::{Cursor, Read};
use std::path::Path;

use roxmltree::Document;
use zip::ZipArchive;
use zip::result::ZipError;

use crate::error::{InputError, read_bytes, shown, text_of};
use crate::gzip::unpacked;
use crate::missions;
use crate::words::counted;

pub(crate) use area::LARGEST_M;
pub use area::{AreaFile, AreaLimit, AreaOutline, EdgeLine, NamedArea, Reference};
pub use plane::PlaneArea;
use taken::Areas;

/// Reads the areas of a file, at least one.
///
/// # Errors
/// An unreadable file, one of no kind that is read here, no polygon or circle at all, a corner out of range, in ED-269 an
/// unknown unit.
pub fn read(path: &Path) -> Result<AreaFile, InputError> {
    let bytes = read_bytes(path)?;
    let bytes = unpacked(&bytes, path)?;
    if !bytes.starts_with(b"PK\x03\x04") {
        return parse(&text_of(&bytes), path);
    }
    let wrong = |error: ZipError| {
        let message = format!("is no usable archive ({error}), expected a KMZ file")
            .replace(char::is_control, " ");
        InputError::in_file(path, message)
    };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(wrong)?;
    let names = archive.file_names().filter_map(Result::ok);
    let is_map = |name: &String| name.to_ascii_lowercase().ends_with(".kml");
    let names = names.map(Cow::into_owned).filter(is_map);
    let mut names: Vec<String> = names.collect();
    names.sort_by_key(|name| (name != "doc.kml", name.matches('/').count()));
    let Some(first) = names.first() else {
        let message = "is an archive without a .kml file, expected a KMZ file";
        return Err(InputError::in_file(path, message));
    };
    let mut text = Vec::new();
    let part = archive.by_name(first).map_err(wrong)?;
    let read = part.take(MOST_BYTES).read_to_end(&mut text);
    read.map_err(|error| wrong(error.into()))?;
    let mut file = parse(&text_of(&text), path)?;
    let more = names.len() - 1;
    if more > 0 {
        let words = counted(more, "other .kml file");
        file.notes
            .push(format!("{words} of the archive left out: {first} is read"));
    }
    Ok(file)
}

/// A file of an archive is read up to here, bytes.
const MOST_BYTES: u64 = 256 << 20;

/// Whether a text is one of areas, by its beginning.
pub fn is_areas(text: &str) -> bool {
    let begin = text.trim_start_matches('\u{feff}').trim_start();
    let zones = "\"horizontalProjection\"";
    let words = ["\"FeatureCollection\"", "\"Feature\"", zones];
    let roots = ["<kml", ":kml", "AIXMBasicMessage"];
    let has = |all: &[&str]| all.iter().any(|word| begin.contains(word));
    (begin.starts_with('{') && has(&words))
        || (begin.starts_with('[') && has(&[zones]))
        || (begin.starts_with('<') && has(&roots))
        || openair::is_openair(begin)
        || fences::fence_points(begin).is_some()
}

/// Whether a text is an object with a type, as those of GeoJSON are; those of ED-269 have none.
fn is_geojson(text: &str) -> bool {
    let object = serde_json::from_str::<serde_json::Map<String, serde_json::Value>>(text);
    object.is_ok_and(|object| object.contains_key("type"))
}

/// The same of a file's text; its content decides its kind.
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, path: &Path) -> Result<AreaFile, InputError> {
    let mut areas = Areas {
        path,
        like: NamedArea::default(),
        all: Vec::new(),
        notes: Vec::new(),
        others: BTreeMap::new(),
    };
    if text.trim_start().starts_with('<') {
        let document = Document::parse(text).map_err(|error| {
            let told = error.to_string().replace(char::is_control, " ");
            let told = told.split(" at ").next().unwrap_or_default();
            InputError::at(
                path,
                Some(error.pos().row.into()),
                format!("is no KML: {told}"),
            )
        })?;
        let root = document.root_element().tag_name().name();
        match root {
            "kml" => areas.take_kml(&document)?,
            "AIXMBasicMessage" => areas.take_aixm(&document)?,
            _ => {
                let root = shown(root);
                let message = format!(
                    "is XML of the kind {root}, expected KML or AIXM 5.1 (AIXMBasicMessage)"
                );
                return Err(InputError::in_file(path, message));
            }
        }
    } else if openair::is_openair(text) {
        areas.take_openair(text)?;
    } else if fences::fence_points(text).is_some() {
        areas.take_fence_points(text)?;
    } else if missions::is_mission(text) {
        areas.take_fences(text)?;
    } else if text.contains("\"horizontalProjection\"") && !is_geojson(text) {
        areas.take_ed269(text)?;
    } else {
        areas.take_geojson(areas.json(text, "GeoJSON, no ED-269 and no KML")?)?;
    }
    areas.finish()
}
