//! Reads files of heights.

use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::file::{Given, MOST_BYTES, Stated, TerrainFile};
use super::{HeightField, ardupilot, dted, geotiff, hgt};
use crate::error::InputError;
use crate::gzip::{fill, unread};

/// Reads a file of heights.
///
/// # Errors
/// A file that is unreadable or of no known format; a part of it that cannot be right, with its place.
pub fn read(path: &Path, given: &Given) -> Result<TerrainFile, InputError> {
    let file = std::fs::File::open(path).map_err(|error| InputError::unreadable(path, &error))?;
    nothing_beside(path)?;
    file_of(BufReader::new(file), path, given)
}

/// Refuses a file whose meaning programs of GDAL keep in a file beside it.
fn nothing_beside(path: &Path) -> Result<(), InputError> {
    let beside = |ending: &str| {
        let mut name = path.as_os_str().to_owned();
        name.push(ending);
        std::fs::read(name).unwrap_or_default()
    };
    let refused = |what: &str| {
        let message = format!(
            "{what} in a file beside it, which is not read, expected it in the file itself"
        );
        Err(InputError::in_file(path, message))
    };
    if !beside(".msk").is_empty() {
        return refused("has a mask (.msk)");
    }
    let said = beside(".aux.xml");
    let said = String::from_utf8_lossy(&said);
    let words = ["Scale", "Offset", "UnitType", "NoDataValue"];
    let word = words
        .iter()
        .find(|word| said.contains(&format!("<{word}>")));
    word.map_or(Ok(()), |word| refused(&format!("has {word} (.aux.xml)")))
}

/// Reads heights from the bytes of a file; see [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path, given: &Given) -> Result<TerrainFile, InputError> {
    file_of(Cursor::new(bytes), path, given)
}

fn file_of(input: impl Read + Seek, path: &Path, given: &Given) -> Result<TerrainFile, InputError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut file = parsed(input, &name).map_err(|message| InputError::in_file(path, message))?;
    let is_hole = |field: &HeightField| field.heights().known().next().is_none();
    if file.fields.iter().all(is_hole) {
        let message = "has only holes, expected at least one height";
        return Err(InputError::in_file(path, message));
    }
    path.clone_into(&mut file.path);
    file.datum = given.datum.map_or(file.datum, Stated::given);
    let error_m = given.vertical_error_m;
    file.vertical_error_m = error_m.map_or(file.vertical_error_m, Stated::given);
    Ok(file)
}

/// Only a compressed GeoTIFF is in memory beside its heights.
fn parsed(mut input: impl Read + Seek, file_name: &str) -> Result<TerrainFile, String> {
    let mut begin = Vec::new();
    fill(&mut input, &mut begin, 4)?;
    input.rewind().map_err(|error| unread(&error))?;
    if geotiff::is_tiff(&begin) {
        return geotiff::parse(input, file_name);
    }
    if !begin.starts_with(&[0x1f, 0x8b]) {
        return streamed(input, &begin, file_name);
    }
    let mut plain = BufReader::new(MultiGzDecoder::new(input));
    fill(&mut plain, &mut begin, 4)?;
    let mut plain = begin.chain(plain);
    if geotiff::is_tiff(&begin) {
        let mut bytes = Vec::new();
        fill(&mut plain, &mut bytes, MOST_BYTES)?;
        return geotiff::parse(Cursor::new(bytes), file_name);
    }
    streamed(plain, &begin, file_name)
}

/// Heights of an input with these first bytes.
fn streamed(input: impl Read, begin: &[u8], file_name: &str) -> Result<TerrainFile, String> {
    if begin.starts_with(b"UHL") {
        return dted::parse(input, file_name);
    }
    if begin == b"PK\x03\x04" {
        return Err(
            "is a zip archive, expected the file in it: unzip it first, or compress with gzip"
                .into(),
        );
    }
    let lower = file_name.to_ascii_lowercase();
    let name = lower.strip_suffix(".gz").unwrap_or(&lower);
    match name.rsplit_once('.').map_or("", |(_, ending)| ending) {
        "hgt" => hgt::parse(input, file_name),
        "dat" => ardupilot::parse(input, file_name),
        _ => Err(
            "is of no known format, expected heights as .hgt, GeoTIFF (.tif), DTED (.dt0, .dt1, .dt2) or ArduPilot's .DAT"
                .into(),
        ),
    }
}
