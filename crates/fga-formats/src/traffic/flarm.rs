//! Sentences of FLARM, as its units and bridges send them over TCP (FLARM Data Port Interface Control Document, FTD-012).
//!
//! What becomes of each sentence and field: `docs/receivers.md`, FLARM. The unit's own place is forgotten after three `PFLAU` without
//! another one; a pressure altitude comes before a height by satellites.

use super::lines::{LineParser, Lines};
use super::{Altitude, NON_ICAO, TrafficReport};
use crate::geodesy::{Earth, Geodetic, LocalFrame, course_from_compass_rad};
use crate::number::finite;
use crate::tally::LeftOut;
use crate::units::FOOT_M;
use glam::DVec3;

/// After more `PFLAU` than this, which come each second, the unit's own place is no longer known.
const KNOWN_FOR: u32 = 3;
/// FLARM reaches no farther, metres.
const FARTHEST_M: f64 = 100_000.0;

/// A connection with such sentences.
pub type Sentences = Lines<OwnPlace>;

/// Where the unit is.
#[derive(Debug, Clone, Copy, Default)]
pub struct OwnPlace {
    /// Its place, and its height above the ellipsoid, metres.
    place: Option<(Geodetic, Option<f64>)>,
    pressure_m: Option<f64>,
    /// `PFLAU` since its place and since its pressure altitude.
    ages: [u32; 2],
}

/// The fields of a sentence with the right checksum.
fn fields(line: &[u8]) -> Result<Vec<&str>, LeftOut> {
    let line = line.trim_ascii();
    if line.is_empty() {
        return Err(LeftOut::NotNeeded);
    }
    let line = str::from_utf8(line).map_err(|_| LeftOut::UnreadableField)?;
    let content = line.strip_prefix(['$', '!']).ok_or(LeftOut::UnknownKind)?;
    let (content, sum) = content.rsplit_once('*').ok_or(LeftOut::CutShort)?;
    let found = content.bytes().fold(0, |sum, byte| sum ^ byte);
    if u8::from_str_radix(sum, 16) != Ok(found) {
        return Err(LeftOut::WrongChecksum);
    }
    Ok(content.split(',').collect())
}

/// A number in a field; `None` where it is empty.
fn number(text: &str) -> Result<Option<f64>, LeftOut> {
    if text.is_empty() {
        return Ok(None);
    }
    finite(text).map(Some).ok_or(LeftOut::UnreadableField)
}

/// Degrees of a field with degrees and minutes, as in `4530.5`, and its half of the earth.
fn degrees(text: &str, half: &str) -> Result<f64, LeftOut> {
    let number = number(text)?.ok_or(LeftOut::NoPosition)?;
    let whole = libm::trunc(number / 100.0);
    let degrees = whole + (number - 100.0 * whole) / 60.0;
    match half {
        "N" | "E" => Ok(degrees),
        "S" | "W" => Ok(-degrees),
        _ => Err(LeftOut::UnreadableField),
    }
}

impl LineParser for OwnPlace {
    fn take(&mut self, line: &[u8]) -> Result<TrafficReport, LeftOut> {
        let fields = fields(line)?;
        match &fields[..] {
            ["PFLAA", rest @ ..] => self.target(rest),
            ["PFLAU", ..] => {
                self.ages = self.ages.map(|age| age.saturating_add(1));
                Err(LeftOut::NotNeeded)
            }
            ["PGRMZ", feet, "F" | "f", ..] => {
                let feet = number(feet);
                self.pressure_m = feet.ok().flatten().map(|feet| feet * FOOT_M);
                self.ages[1] = 0;
                feet.and(Err(LeftOut::NotNeeded))
            }
            [kind, rest @ ..] if kind.len() == 5 && kind.ends_with("GGA") => {
                let place = Self::of_satellites(rest);
                self.place = place.ok().flatten();
                self.ages[0] = 0;
                place.and(Err(LeftOut::NotNeeded))
            }
            _ => Err(LeftOut::NotNeeded),
        }
    }
}

impl OwnPlace {
    /// The place in a `GGA`, and its height above the ellipsoid, metres; `None` without a fix.
    fn of_satellites(fields: &[&str]) -> Result<Option<(Geodetic, Option<f64>)>, LeftOut> {
        let [_, north, half, east, side, quality, _, _, heights @ ..] = fields else {
            return Err(LeftOut::UnreadableField);
        };
        let [height, _, geoid, ..] = heights else {
            return Err(LeftOut::UnreadableField);
        };
        if matches!(*quality, "" | "0") {
            return Ok(None);
        }
        let (latitude_deg, longitude_deg) = (degrees(north, half)?, degrees(east, side)?);
        let heights = number(height)?.zip(number(geoid)?);
        let place = Geodetic::new(latitude_deg, longitude_deg, 0.0);
        let place = place.ok_or(LeftOut::UnreadableField)?;
        Ok(Some((
            place,
            heights.map(|(above_sea_m, sea_m)| above_sea_m + sea_m),
        )))
    }

    /// The report of another aircraft.
    fn target(&self, fields: &[&str]) -> Result<TrafficReport, LeftOut> {
        let [_, north, east, up, kind, id, track, _, speed, climb, ..] = fields else {
            return Err(LeftOut::UnreadableField);
        };
        let id = id.split_once('!').map_or(*id, |(id, _)| id);
        if id.is_empty() {
            return Err(LeftOut::NoAddress);
        }
        let address = u32::from_str_radix(id, 16).ok().filter(|id| *id < NON_ICAO);
        let address = address.ok_or(LeftOut::UnreadableField)?;
        let away_m = number(north)?
            .zip(number(east)?)
            .ok_or(LeftOut::NoPosition)?;
        let [place_age, pressure_age] = self.ages;
        let own = self.place.filter(|_| place_age <= KNOWN_FOR);
        let (own, ellipsoid_m) = own.ok_or(LeftOut::NoPosition)?;
        if libm::hypot(away_m.0, away_m.1) > FARTHEST_M {
            return Err(LeftOut::Jump);
        }
        let frame = LocalFrame::new(own, Earth::Wgs84);
        let place = frame.to_geodetic(DVec3::new(away_m.1, away_m.0, 0.0));
        let pressure_m = self.pressure_m.filter(|_| pressure_age <= KNOWN_FOR);
        let own_height = pressure_m.map(Altitude::Pressure);
        let own_height = own_height.or(ellipsoid_m.map(Altitude::Ellipsoid));
        let altitude = own_height.zip(number(up)?).map(|(own, up_m)| match own {
            Altitude::Pressure(own_m) => Altitude::Pressure(own_m + up_m),
            Altitude::Ellipsoid(own_m) => Altitude::Ellipsoid(own_m + up_m),
        });
        Ok(TrafficReport {
            address: if *kind == "1" {
                address
            } else {
                address | NON_ICAO
            },
            place_deg: Some([place.latitude_deg, place.longitude_deg]),
            altitude,
            ground_speed_mps: number(speed)?,
            course_rad: number(track)?.map(course_from_compass_rad),
            climb_mps: number(climb)?,
            ..TrafficReport::default()
        })
    }
}
