//! A finished flight for other programs: Google Earth, Cesium, maps, Foxglove, FlightGear.
//!
//! | module | format | program |
//! |---|---|---|
//! | [`kml`] | Keyhole markup language with time | Google Earth |
//! | [`czml`] | Cesium language | Cesium |
//! | [`geojson`] | geographic features | QGIS, web maps |
//! | [`mcap`] | log of timed JSON messages with schemas | Foxglove, PlotJuggler |
//! | [`flightgear`] | the generic protocol over UDP | FlightGear |
//!
//! Altitudes are the origin's altitude plus z. Google Earth counts them above mean sea level,
//! Cesium above the ellipsoid: choose the origin's altitude to match.

pub mod czml;
pub mod flightgear;
pub mod geojson;
pub mod kml;
pub mod mcap;
mod shapes;
mod time;

use crate::error::OutputError;
use crate::flight::Flight;
use core::fmt;
use core::str::FromStr;
use std::path::Path;

/// A format for the export of a flight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// For Google Earth.
    Kml,
    /// For Cesium.
    Czml,
    /// For maps.
    GeoJson,
    /// For Foxglove and PlotJuggler.
    Mcap,
}

impl Format {
    /// Every format.
    pub const ALL: [Self; 4] = [Self::Kml, Self::Czml, Self::GeoJson, Self::Mcap];

    /// The format's name, which is also the file's extension.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Kml => "kml",
            Self::Czml => "czml",
            Self::GeoJson => "geojson",
            Self::Mcap => "mcap",
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|format| format.name().eq_ignore_ascii_case(name))
            .ok_or_else(|| {
                let name = crate::error::shown(name);
                format!("the format {name} is unknown, expected kml, czml, geojson or mcap")
            })
    }
}

/// Writes the flight in a format, completely or not at all.
///
/// # Errors
/// A file that cannot be written.
pub fn write(flight: &Flight, format: Format, path: &Path) -> Result<(), OutputError> {
    match format {
        Format::Kml => crate::atomic::write(path, kml::text(flight)),
        Format::Czml => crate::atomic::write(path, czml::text(flight)),
        Format::GeoJson => crate::atomic::write(path, geojson::text(flight)),
        Format::Mcap => mcap::bytes(flight)
            .map_err(|error| OutputError::new(path, error))
            .and_then(|bytes| crate::atomic::write(path, bytes)),
    }
}

/// Red, green, blue of a state: the palette of Okabe and Ito, which people with any colour vision can
/// distinguish.
pub const fn state_color(state: &str) -> [u8; 3] {
    match state.as_bytes() {
        b"cruise" => [0x00, 0x72, 0xB2],
        b"threatened" => [0xE6, 0x9F, 0x00],
        b"avoiding" => [0xD5, 0x5E, 0x00],
        b"recovering" => [0x00, 0x9E, 0x73],
        _ => [0x80, 0x80, 0x80],
    }
}

/// Red, green, blue of obstacles and their volumes.
pub const OBSTACLE_COLOR: [u8; 3] = [0xCC, 0x79, 0xA7];
/// Red, green, blue of the mission.
pub const MISSION_COLOR: [u8; 3] = [0x56, 0xB4, 0xE9];

/// The flown track in pieces of one state: each piece begins at the end of the previous one.
fn pieces(flight: &Flight, step_s: f64) -> Vec<(&str, Vec<&crate::flight::FlightSample>)> {
    let mut pieces: Vec<(&str, Vec<&crate::flight::FlightSample>)> = Vec::new();
    for sample in flight.thinned(step_s) {
        match pieces.last_mut() {
            Some((state, piece)) if *state == sample.state => piece.push(sample),
            last => {
                let joint = last.and_then(|(_, piece)| piece.last().copied());
                pieces.push((&sample.state, joint.into_iter().chain([sample]).collect()));
            }
        }
    }
    pieces
}
