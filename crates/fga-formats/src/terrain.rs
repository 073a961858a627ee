//! Heights of the ground from the files that people have.
//!
//! | file | recognized by |
//! |---|---|
//! | SRTM, also compressed with gzip | the ending `.hgt`, `.hgt.gz`; the name is the place |
//! | GeoTIFF: geographic, one band | its first bytes |
//! | DTED 0, 1, 2 | a first word `UHL1` |
//! | ArduPilot's terrain, also compressed with gzip | the ending `.DAT`, `.DAT.gz` |
//!
//! A [`RequestedBlock`] is ground that a ground station sends over MAVLink.
//!
//! A file becomes one or several [`HeightField`]s, and files together a [`Terrain`]. A hole and what lies outside are
//! unknown ground: never a height, always `None`. Heights count above a [`Datum`]; datum and vertical error have a source.

mod along;
mod ardupilot;
mod dted;
mod field;
mod geokeys;
mod geotiff;
mod hgt;
mod mosaic;
mod name;
mod requested;
mod write;

use std::io::{BufReader, Cursor, Read, Seek as _};
use std::path::{Path, PathBuf};

pub use along::{Clearance, Lowest, Piece};
pub use field::{Grid, HeightField};
pub use mosaic::Terrain;
pub use requested::RequestedBlock;
pub use write::Cut;

use crate::error::InputError;
use crate::gzip;

/// A file may hold this many bytes, decompressed too: ten times a degree with a post each second of arc as 32-bit numbers.
const MOST_BYTES: u64 = 512 << 20;

/// What heights are above.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Datum {
    /// Mean sea level by the geoid EGM96.
    Egm96,
    /// Mean sea level by the geoid EGM2008.
    Egm2008,
    /// Mean sea level of North America, NAVD88.
    Navd88,
    /// The ellipsoid WGS84, as a satellite receiver without a geoid gives it.
    Ellipsoid,
}

impl Datum {
    /// Every datum.
    pub const ALL: [Self; 4] = [Self::Egm96, Self::Egm2008, Self::Navd88, Self::Ellipsoid];

    /// Its name, as `--datum` takes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Egm96 => "egm96",
            Self::Egm2008 => "egm2008",
            Self::Navd88 => "navd88",
            Self::Ellipsoid => "ellipsoid",
        }
    }

    /// What it is, in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Egm96 => "mean sea level (EGM96)",
            Self::Egm2008 => "mean sea level (EGM2008)",
            Self::Navd88 => "mean sea level (NAVD88)",
            Self::Ellipsoid => "the ellipsoid (WGS84)",
        }
    }

    /// Whether it is mean sea level, as altitudes of missions are.
    pub const fn is_sea_level(self) -> bool {
        !matches!(self, Self::Ellipsoid)
    }
}

/// A value and how it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stated<T> {
    /// The value.
    pub value: T,
    /// How it is known, in words.
    pub source: &'static str,
}

/// What the user knows better than a file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Given {
    /// The datum.
    pub datum: Option<Datum>,
    /// The vertical error, metres.
    pub vertical_error_m: Option<f64>,
}

const GIVEN: &str = "given by the user";

/// An area of latitudes and longitudes, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Least latitude.
    pub south_deg: f64,
    /// Least longitude.
    pub west_deg: f64,
    /// Largest latitude.
    pub north_deg: f64,
    /// Largest longitude.
    pub east_deg: f64,
}

impl Area {
    /// An area from its sides in the order south, west, north, east.
    ///
    /// # Errors
    /// Sides out of order or range, a pole, an area across the antimeridian.
    pub fn new([south_deg, west_deg, north_deg, east_deg]: [f64; 4]) -> Result<Self, String> {
        let area = Self {
            south_deg,
            west_deg,
            north_deg,
            east_deg,
        };
        if !(south_deg > -90.0 && south_deg < north_deg && north_deg < 90.0) {
            return Err(format!(
                "the latitudes {south_deg} and {north_deg}, expected south below north and no pole"
            ));
        }
        if !(west_deg >= -180.0 && west_deg < east_deg && east_deg <= 180.0) {
            return Err(format!(
                "the longitudes {west_deg} and {east_deg}, expected west below east from -180 to 180; \
                 an area across the antimeridian is two areas"
            ));
        }
        Ok(area)
    }

    /// Whether two areas have more than an edge in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.south_deg < other.north_deg
            && other.south_deg < self.north_deg
            && self.west_deg < other.east_deg
            && other.west_deg < self.east_deg
    }

    /// The smallest area around both.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        Self {
            south_deg: self.south_deg.min(other.south_deg),
            west_deg: self.west_deg.min(other.west_deg),
            north_deg: self.north_deg.max(other.north_deg),
            east_deg: self.east_deg.max(other.east_deg),
        }
    }
}

impl core::fmt::Display for Area {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "latitude {:.5} to {:.5}, longitude {:.5} to {:.5}",
            self.south_deg, self.north_deg, self.west_deg, self.east_deg
        )
    }
}

/// A file of heights.
#[derive(Debug, Clone, PartialEq)]
pub struct TerrainFile {
    /// The file, as the user named it.
    pub path: PathBuf,
    /// Its format, in words.
    pub format: &'static str,
    /// Its grids, at least one; all with about the same spacing.
    pub fields: Vec<HeightField>,
    /// What its heights are above.
    pub datum: Stated<Datum>,
    /// Vertical error of its heights, metres.
    pub vertical_error_m: Stated<f64>,
    /// Blocks without any height.
    pub empty_blocks: usize,
}

impl TerrainFile {
    /// The smallest area around its grids.
    pub fn area(&self) -> Option<Area> {
        let areas = self.fields.iter().map(|field| field.grid().area());
        areas.reduce(|all, area| all.with(&area))
    }
}

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
    parse(&std::fs::read(path).map_err(unreadable)?, path, given)
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

/// What a reader found.
struct Parsed {
    format: &'static str,
    fields: Vec<HeightField>,
    datum: Stated<Datum>,
    error: Option<Stated<f64>>,
    empty_blocks: usize,
}

impl Parsed {
    fn one(format: &'static str, field: HeightField, datum: Stated<Datum>) -> Self {
        Self {
            format,
            fields: vec![field],
            datum,
            error: None,
            empty_blocks: 0,
        }
    }
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
