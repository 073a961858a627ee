//! Reads files of heights.

use std::io::{BufReader, Cursor, Read, Seek as _};
use std::path::Path;

use super::file::{GIVEN, Given, MOST_BYTES, Parsed, Stated, TerrainFile};
use super::{ardupilot, dted, geotiff, hgt, name};
use crate::error::{InputError, read_bytes};
use crate::gzip;

/// Reads a file of heights.
///
/// # Errors
/// A file that is unreadable or of no known format; a part of it that cannot be right, with its place.
pub fn read(path: &Path, given: &Given) -> Result<TerrainFile, InputError> {
    let unreadable = |error| InputError::unreadable(path, &error);
    let size = std::fs::metadata(path).map_err(unreadable)?.len();
    let mut file = std::fs::File::open(path).map_err(unreadable)?;
    let mut begin = Vec::new();
    file.by_ref()
        .take(4)
        .read_to_end(&mut begin)
        .map_err(unreadable)?;
    file.rewind().map_err(unreadable)?;
    let name = name_of(path);
    let is_packed = begin.starts_with(&[0x1f, 0x8b]);
    // The large formats are never in memory twice.
    let streamed = if geotiff::is_tiff(&begin) {
        Some(geotiff::parse(BufReader::new(file), size, &name))
    } else if name.to_ascii_lowercase().ends_with(".hgt") && !is_packed {
        Some(srtm(file, size, &name))
    } else {
        None
    };
    if let Some(parsed) = streamed {
        return parsed
            .map(|parsed| finished(parsed, path, given))
            .map_err(|message| InputError::in_file(path, message));
    }
    if size > MOST_BYTES {
        let message = format!("has {size} bytes, expected at most {MOST_BYTES}");
        return Err(InputError::in_file(path, message));
    }
    parse(&read_bytes(path)?, path, given)
}

/// Reads heights from the bytes of a file; see [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path, given: &Given) -> Result<TerrainFile, InputError> {
    let bytes = gzip::unpacked_to(bytes, path, MOST_BYTES)?;
    parsed(&bytes, &name_of(path))
        .map(|parsed| finished(parsed, path, given))
        .map_err(|message| InputError::in_file(path, message))
}

fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

fn srtm(input: impl Read, size: u64, file_name: &str) -> Result<Parsed, String> {
    let field = hgt::parse(input, size, file_name)?;
    Ok(Parsed {
        error: Some(hgt::ERROR),
        ..Parsed::one("SRTM", field, hgt::DATUM)
    })
}

fn parsed(bytes: &[u8], file_name: &str) -> Result<Parsed, String> {
    if geotiff::is_tiff(bytes) {
        return geotiff::parse(Cursor::new(bytes), bytes.len() as u64, file_name);
    }
    if bytes.starts_with(b"UHL") {
        let (field, datum, error) = dted::parse(bytes)?;
        name::agrees(file_name, &field.grid().area())?;
        return Ok(Parsed {
            error,
            ..Parsed::one("DTED", field, datum)
        });
    }
    if bytes.starts_with(b"PK\x03\x04") {
        return Err(
            "is a zip archive, expected the file in it: unzip it first, or compress with gzip"
                .into(),
        );
    }
    let lower = file_name.to_ascii_lowercase();
    let name = lower.strip_suffix(".gz").unwrap_or(&lower);
    match name.rsplit_once('.').map_or("", |(_, ending)| ending) {
        "hgt" => {
            srtm(bytes, bytes.len() as u64, file_name)
        }
        "dat" => {
            let (fields, empty_blocks) = ardupilot::parse(bytes, file_name)?;
            Ok(Parsed {
                format: "ArduPilot's terrain",
                fields,
                datum: ardupilot::DATUM,
                error: Some(hgt::ERROR),
                empty_blocks,
            })
        }
        _ => Err(
            "is of no known format, expected heights as .hgt, GeoTIFF (.tif), DTED (.dt0, .dt1, .dt2) or ArduPilot's .DAT"
                .into(),
        ),
    }
}

fn finished(parsed: Parsed, path: &Path, given: &Given) -> TerrainFile {
    let assumed = Stated {
        value: hgt::ERROR.value,
        source: "assumed, as of SRTM: the file does not say",
    };
    let given_datum = given.datum.map(|value| Stated {
        value,
        source: GIVEN,
    });
    let given_error = given.vertical_error_m.map(|value| Stated {
        value,
        source: GIVEN,
    });
    TerrainFile {
        path: path.to_owned(),
        format: parsed.format,
        fields: parsed.fields,
        datum: given_datum.unwrap_or(parsed.datum),
        vertical_error_m: given_error.or(parsed.error).unwrap_or(assumed),
        empty_blocks: parsed.empty_blocks,
    }
}
