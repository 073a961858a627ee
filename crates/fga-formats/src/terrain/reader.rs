//! Reads files of heights.

use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::file::{Given, MOST_BYTES, Parsed, Stated, TerrainFile};
use super::{HeightField, ardupilot, dted, geotiff, hgt, name};
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
    let parsed = parsed(input, &name).map_err(|message| InputError::in_file(path, message))?;
    let has_height = |field: &HeightField| {
        let mut rows = 0..field.grid().rows;
        rows.any(|row| (0..field.grid().columns).any(|column| field.post_m(row, column).is_some()))
    };
    if !parsed.fields.iter().any(has_height) {
        let message = "has only holes, expected at least one height";
        return Err(InputError::in_file(path, message));
    }
    Ok(finished(parsed, path, given))
}

/// Only a compressed GeoTIFF is in memory beside its heights.
fn parsed(mut input: impl Read + Seek, file_name: &str) -> Result<Parsed, String> {
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
fn streamed(input: impl Read, begin: &[u8], file_name: &str) -> Result<Parsed, String> {
    if begin.starts_with(b"UHL") {
        let (field, datum, error) = dted::parse(input)?;
        name::agrees(file_name, &field.grid().area())?;
        return Ok(Parsed::one("DTED", field, datum, error));
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
        "hgt" => {
            let field = hgt::parse(input, file_name)?;
            Ok(Parsed::one("SRTM", field, hgt::DATUM, Some(hgt::ERROR)))
        }
        "dat" => {
            let (fields, empty_blocks) = ardupilot::parse(input, file_name)?;
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
    TerrainFile {
        path: path.to_owned(),
        format: parsed.format,
        fields: parsed.fields,
        datum: given.datum.map_or(parsed.datum, Stated::given),
        vertical_error_m: given
            .vertical_error_m
            .map_or(parsed.error.unwrap_or(assumed), Stated::given),
        empty_blocks: parsed.empty_blocks,
    }
}
