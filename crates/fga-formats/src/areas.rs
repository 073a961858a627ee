//! Areas of a map and of authorities: GeoJSON (RFC 7946), KML 2.2 and KMZ, `OpenAir`, AIXM 5.1, and UAS geographical zones as EUROCAE ED-269 and ED-318 write them;
//! fences of [`missions`].
//!
//! Files of areas hold corners as longitude, latitude and perhaps an altitude, and end a ring with its first corner. What of a file is no
//! area, or is said in a way that is not known, is named in [`AreaFile::notes`].
//!
//! | file | an edge is |
//! |---|---|
//! | GeoJSON, ED-318, fences of missions | straight in longitude and latitude (RFC 7946, 3.1.1; flat coordinates of ArduPilot) |
//! | KML, ED-269, `OpenAir`, AIXM | the shortest way on the ellipsoid |

mod aixm;
mod arcs;
mod ed269;
mod fences;
mod geojson;
mod kml;
mod limits;
mod openair;
mod plane;
#[cfg(test)]
mod tests;

use alloc::borrow::Cow;
use alloc::collections::BTreeMap;
use core::fmt::Display;
use std::io::{Cursor, Read};
use std::path::Path;

use fga::Vec2;
use roxmltree::Document;
use serde::de::DeserializeOwned;
use serde_json::Value;
use zip::ZipArchive;
use zip::result::ZipError;

use crate::error::{InputError, json_sentence, read_bytes, shown, text_of};
use crate::geodesy::{Earth, Geodetic, LocalFrame};
use crate::missions;
use crate::terrain::Area;
use crate::units::FOOT_M;
use crate::words::counted;
use crate::zones::{MAX_CORNERS, ZoneError, heights_m, polygon, with_holes};

pub use plane::PlaneArea;

/// A circle has at most this radius, metres.
const LARGEST_M: f64 = 1e7;

/// No place of the ellipsoid of WGS 84 is bent more than with this radius, metres: along the meridian at the equator.
const LEAST_RADIUS_M: f64 = 6_335_439.0;

/// The areas of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AreaFile {
    /// The areas, at least one.
    pub areas: Vec<NamedArea>,
    /// What of the file is not used, or used otherwise than it is written; one sentence each.
    pub notes: Vec<String>,
}

/// Which line an edge is from one corner to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EdgeLine {
    /// Straight in longitude and latitude.
    #[default]
    Degrees,
    /// The shortest one on the ellipsoid.
    Geodesic,
}

/// An area of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NamedArea {
    /// Its name.
    pub name: Option<String>,
    /// Its outline.
    pub outline: AreaOutline,
    /// Which line its edges are.
    pub edges: EdgeLine,
    /// Its floor and its ceiling, where the file states them.
    pub limits: [Option<AreaLimit>; 2],
    /// Whether it is to stay in, or to keep out of, where the file says so.
    pub keep_in: Option<bool>,
    /// Whether the file restricts no flight in it (`NO_RESTRICTION`).
    pub is_free: bool,
    /// Whether the file states times at which it applies.
    pub is_timed: bool,
}

/// The outline of an area.
#[derive(Debug, Clone, PartialEq)]
pub enum AreaOutline {
    /// A polygon by its rings, the outline and its holes: latitude and longitude of each corner, degrees; the last corner of a ring is
    /// joined to the first.
    Polygon(Vec<Vec<[f64; 2]>>),
    /// A circle.
    Circle {
        /// Latitude and longitude of its centre, degrees.
        center_deg: [f64; 2],
        /// Its radius, metres.
        radius_m: f64,
    },
}

impl AreaOutline {
    /// The smallest area of latitude and longitude around it; `None` where it has none, or reaches a pole or the antimeridian.
    pub fn span(&self) -> Option<Area> {
        let corners_deg = match self {
            Self::Polygon(rings) => rings.first()?.clone(),
            Self::Circle {
                center_deg: [latitude_deg, longitude_deg],
                radius_m,
            } => {
                let north_deg = (radius_m / LEAST_RADIUS_M).to_degrees();
                let level = libm::cos((latitude_deg.abs() + north_deg).to_radians());
                let east_deg = north_deg / level.max(0.0);
                vec![
                    [latitude_deg - north_deg, longitude_deg - east_deg],
                    [latitude_deg + north_deg, longitude_deg + east_deg],
                ]
            }
        };
        let [first, rest @ ..] = corners_deg.as_slice() else {
            return None;
        };
        let [mut south, mut west] = *first;
        let [mut north, mut east] = *first;
        for [latitude_deg, longitude_deg] in rest {
            (south, north) = (south.min(*latitude_deg), north.max(*latitude_deg));
            (west, east) = (west.min(*longitude_deg), east.max(*longitude_deg));
        }
        Area::new([south, west, north, east]).ok()
    }
}

impl NamedArea {
    /// Whether a zone can be made of it, wherever a flight begins.
    ///
    /// # Errors
    /// As [`with_holes`], with its first corner as origin; a floor that is not below a ceiling with the same reference.
    pub fn check(&self) -> Result<(), ZoneError> {
        if let [Some(floor), Some(ceiling)] = self.limits
            && floor.above == ceiling.above
        {
            heights_m(floor.height_m, ceiling.height_m)?;
        }
        let AreaOutline::Polygon(rings) = &self.outline else {
            return Ok(());
        };
        self.check_rings()?;
        // A hole is nearer to a flight than an outline round a country.
        let place = |[latitude_deg, longitude_deg]: &[f64; 2]| {
            Geodetic::new(*latitude_deg, *longitude_deg, 0.0)
        };
        let Some(origin) = rings.iter().rev().flatten().find_map(place) else {
            return Err(ZoneError::Corners(0));
        };
        let frame = LocalFrame::new(origin, Earth::Wgs84);
        for mut rings in self.on_plane(&frame, self.keep_in == Some(true)).polygons {
            let holes = rings.split_off(1);
            with_holes(rings.pop().unwrap_or_default(), holes)?;
        }
        Ok(())
    }
}

impl NamedArea {
    /// Whether its rings are polygons as they are given, on a map of longitude and latitude; those with many corners, and wide ones whose
    /// edges are bent there, show it on the plane.
    ///
    /// # Errors
    /// As [`polygon`].
    pub fn check_rings(&self) -> Result<(), ZoneError> {
        let AreaOutline::Polygon(rings) = &self.outline else {
            return Ok(());
        };
        for ring in rings.iter().filter(|ring| ring.len() <= MAX_CORNERS) {
            let [south, west] = ring.first().copied().unwrap_or_default();
            let level = libm::cos(south.to_radians()).max(0.01);
            let on_map = |[latitude_deg, longitude_deg]: &[f64; 2]| {
                let (east_deg, north_deg) = (longitude_deg - west, latitude_deg - south);
                DEGREE_M * Vec2::new(level * east_deg, north_deg)
            };
            let corners: Vec<Vec2> = ring.iter().map(on_map).collect();
            let widest_m = if self.edges == EdgeLine::Degrees {
                9e6
            } else {
                5e4
            };
            if corners.iter().all(|at| at.length() <= widest_m) {
                polygon(corners)?;
            }
        }
        Ok(())
    }
}

/// A degree of latitude, metres.
const DEGREE_M: f64 = 111_195.0;

impl Default for AreaOutline {
    fn default() -> Self {
        Self::Polygon(Vec::new())
    }
}

/// A limit of an area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaLimit {
    /// Metres above the reference.
    pub height_m: f64,
    /// What it counts from.
    pub above: Reference,
}

/// What a limit counts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// Mean sea level (`AMSL`).
    Sea,
    /// The ground or the water (`AGL`).
    Ground,
    /// The ellipsoid of WGS 84 (`WGS84`).
    Ellipsoid,
    /// The pressure of the standard atmosphere at the sea, 1013.25 hPa (`STD`): flight levels.
    Pressure,
}

impl AreaLimit {
    /// How far it may be from its height above the sea by the weather, metres: for a flight level 550 m by a pressure of 950 to 1,050 hPa
    /// at the sea, and 12 % of it by air that is 30 K colder or warmer than the standard atmosphere.
    pub fn off_m(&self) -> f64 {
        if self.above == Reference::Pressure {
            550.0 + 0.12 * self.height_m.abs()
        } else {
            0.0
        }
    }
}

/// Reads the areas of a file, at least one.
///
/// # Errors
/// An unreadable file, one of no kind that is read here, no polygon or circle at all, a ring that is not closed, a corner out of
/// range, in ED-269 and ED-318 a limit without a known unit and reference.
pub fn read(path: &Path) -> Result<AreaFile, InputError> {
    let bytes = read_bytes(path)?;
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
            let line = u64::from(error.pos().row);
            areas.unreadable(line, "KML", error.to_string().split(" at ").next())
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
    } else if text.contains("\"horizontalProjection\"") {
        areas.take_ed269(text)?;
    } else {
        areas.take_geojson(areas.json(text, "GeoJSON, no ED-269 and no KML")?)?;
    }
    areas.finish()
}

/// The areas of a file so far.
struct Areas<'a> {
    path: &'a Path,
    /// What the file says of the next one.
    like: NamedArea,
    all: Vec<NamedArea>,
    notes: Vec<String>,
    /// How often what is no area stands beside areas, by its kind.
    others: BTreeMap<String, usize>,
}

impl Areas<'_> {
    /// The areas, and what else the file holds.
    fn finish(mut self) -> Result<AreaFile, InputError> {
        let others = self.others.iter();
        let others = others.map(|(what, count)| format!("{} left out", counted(*count, what)));
        let others: Vec<String> = others.collect();
        if self.all.is_empty() {
            let beside = others.iter().map(|other| format!("{other}, "));
            let beside: String = beside.collect();
            let message = format!("has no area, {beside}expected at least one");
            return Err(InputError::in_file(self.path, message));
        }
        self.notes.extend(others);
        let Self {
            all: areas, notes, ..
        } = self;
        Ok(AreaFile { areas, notes })
    }

    /// Counts what is no area.
    fn leave_out(&mut self, what: &str) {
        *self
            .others
            .entry(Self::name(what).unwrap_or_default())
            .or_default() += 1;
    }

    /// Notes something about the next area.
    fn note(&mut self, message: &str) {
        let number = self.all.len() + 1;
        let name = self.like.name.as_ref();
        let name = name.map_or_else(String::new, |name| format!(" ({name})"));
        self.notes.push(format!("area {number}{name} {message}"));
    }

    fn json<T: DeserializeOwned>(&self, text: &str, kind: &str) -> Result<T, InputError> {
        serde_json::from_str(text).map_err(|error| {
            let line = u64::try_from(error.line()).unwrap_or_default();
            self.unreadable(line, kind, Some(&json_sentence(&error)))
        })
    }

    /// What is wrong with the text of a kind, as one line whatever it quotes.
    fn unreadable(&self, line: u64, kind: &str, told: Option<&str>) -> InputError {
        let told = told.unwrap_or_default().replace(char::is_control, " ");
        InputError {
            line: Some(line).filter(|line| *line > 0),
            ..InputError::in_file(self.path, format!("is no {kind}: {told}"))
        }
    }

    fn refuse<T>(&self, message: impl Display) -> Result<T, InputError> {
        let number = self.all.len() + 1;
        let name = self.like.name.as_ref();
        let name = name.map_or_else(String::new, |name| format!(" ({name})"));
        let message = format!("area {number}{name} {message}");
        Err(InputError::in_file(self.path, message))
    }

    /// Takes a polygon by its rings, the first of which is its outline.
    fn take(&mut self, rings: &[Vec<Vec<f64>>]) -> Result<(), InputError> {
        let mut rings_deg = Vec::new();
        for ring in rings {
            let corners = ring.iter().zip(1..);
            let corners =
                corners.map(|(at, number)| self.place(at, format_args!("corner {number}")));
            let mut corners_deg = corners.collect::<Result<Vec<_>, _>>()?;
            if corners_deg.is_empty() {
                return self.refuse("has no corners, expected a ring");
            }
            if corners_deg.len() == 1 || corners_deg.first() != corners_deg.last() {
                return self.refuse("is not closed, expected its first corner at its end again");
            }
            // Published outlines repeat a corner.
            corners_deg.dedup();
            if corners_deg.len() > 1 && corners_deg.first() == corners_deg.last() {
                corners_deg.pop();
            }
            rings_deg.push(corners_deg);
        }
        if rings_deg.is_empty() {
            return self.refuse("has no corners, expected a ring");
        }
        self.push(AreaOutline::Polygon(rings_deg));
        Ok(())
    }

    fn take_circle(&mut self, center: &[f64], radius_m: f64) -> Result<(), InputError> {
        let center_deg = self.place(center, "its centre")?;
        if !(radius_m > 0.0 && radius_m <= LARGEST_M) {
            return self.refuse(format_args!(
                "has a radius of {radius_m} m, expected more than 0, up to 10,000 km"
            ));
        }
        self.push(AreaOutline::Circle {
            center_deg,
            radius_m,
        });
        Ok(())
    }

    /// A name as one line, unless it is empty.
    fn name(text: &str) -> Option<String> {
        let words = text.split(|each: char| each.is_whitespace() || each.is_control());
        let words: Vec<_> = words.filter(|word| !word.is_empty()).collect();
        (!words.is_empty()).then(|| words.join(" "))
    }

    fn push(&mut self, outline: AreaOutline) {
        let mut like = self.like.clone();
        // Authorities write 0 to 0 for a zone of all heights.
        if let [Some(floor), Some(ceiling)] = like.limits
            && floor == ceiling
        {
            let height_m = floor.height_m;
            self.note(&format!(
                "has its floor and its ceiling at {height_m} m: the ceiling counts as unknown"
            ));
            like.limits[1] = None;
        }
        self.all.push(NamedArea { outline, ..like });
    }

    /// Latitude and longitude of a place, degrees.
    fn place(&self, at: &[f64], what: impl Display) -> Result<[f64; 2], InputError> {
        let is_place = |latitude_deg: f64, longitude_deg: f64| {
            latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 180.0
        };
        match *at {
            [longitude_deg, latitude_deg, ..] if is_place(latitude_deg, longitude_deg) => {
                Ok([latitude_deg, longitude_deg])
            }
            [one, other, ..] if is_place(one, other) => self.refuse(format_args!(
                "has {what} out of range: latitude and longitude look exchanged, expected the longitude first"
            )),
            _ => self.refuse(format_args!(
                "has {what} out of range, expected longitude from -180 to 180 and latitude from -90 to 90"
            )),
        }
    }

    /// A unit of lengths, metres.
    fn unit_m(&self, unit: &str) -> Result<f64, InputError> {
        match unit.to_ascii_lowercase().as_str() {
            "m" => Ok(1.0),
            "ft" => Ok(FOOT_M),
            _ => self.refuse(format_args!("has the unit {unit:?}, expected m or ft")),
        }
    }

    /// A limit in a unit, metres, above a reference; `None` without one.
    fn limit(
        &self,
        value: Option<&Value>,
        unit_m: f64,
        reference: Option<&str>,
    ) -> Result<Option<AreaLimit>, InputError> {
        let height = match value {
            None | Some(Value::Null) => return Ok(None),
            // Some authorities write numbers as texts.
            Some(Value::String(text)) => text.trim().parse().ok(),
            Some(other) => other.as_f64(),
        };
        let Some(height) = height.filter(|height| height.is_finite()) else {
            let value = value.unwrap_or(&Value::Null);
            return self.refuse(format_args!("has the limit {value}, expected a number"));
        };
        let above = match reference.map(str::to_ascii_uppercase).as_deref() {
            Some("AMSL") => Reference::Sea,
            Some("AGL") => Reference::Ground,
            Some("WGS84") => Reference::Ellipsoid,
            other => {
                let other = other.unwrap_or_default();
                return self.refuse(format_args!(
                    "has a limit above {other:?}, expected the vertical reference AGL, AMSL or WGS84"
                ));
            }
        };
        let height_m = height * unit_m;
        Ok(Some(AreaLimit { height_m, above }))
    }
}
