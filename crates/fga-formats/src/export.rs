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
mod look;
pub mod mcap;
mod shapes;
mod text;

use crate::error::OutputError;
use crate::flight::Flight;
use core::str::FromStr;
pub use look::{MISSION_COLOR, OBSTACLE_COLOR, state_color};
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
