//! One report of another aircraft's position, and how an `ADSB_VEHICLE` message becomes one.

use fga::Vec3;
use fga::situation::Movement;
use fga_formats::geodesy::Geodetic;
use mavlink::dialects::ardupilotmega::{ADSB_VEHICLE_DATA, AdsbAltitudeType, AdsbFlags};

pub use super::identity::{LONGEST_CALLSIGN, ReportSender, ReportSource, TrackKey, tidy_callsign};

use super::class::AircraftClass;
use super::defect::Defect;
use crate::number::{place_from_e7, velocity_mps};

/// The datum of an altitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AltitudeReference {
    /// Mean sea level, measured by satellites.
    MeanSeaLevel,
    /// The WGS-84 ellipsoid.
    Ellipsoid,
    /// The pressure of 1013.25 hPa in the standard atmosphere.
    Pressure,
    /// What its sender calls geometric: the sea level, the ellipsoid, or a pressure in spite of the label.
    Geometric,
    /// None: the altitude is unknown.
    Unknown,
}

/// The quality of a report.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// σ of the horizontal position along an axis, metres.
    pub position_m: f64,
    /// σ of the velocity along an axis, metres per second; with age the position gets worse by it.
    pub velocity_mps: f64,
    /// Whether the aircraft or its receiver reported that σ. Decisions look ahead with a reported σ; an assumed σ
    /// only ages the position.
    pub velocity_sigma_is_known: bool,
    /// Whether the vertical part of the velocity is reported; else the altitudes show it.
    pub climb_is_known: bool,
    /// Bound of the altitude's error, metres, besides the error of its datum.
    pub height_m: f64,
    /// The altitude's datum.
    pub altitude: AltitudeReference,
}

/// The content of one message.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceReport {
    /// Its sender.
    pub sender: ReportSender,
    /// ICAO address, or another with [`NON_ICAO`](fga_formats::traffic::NON_ICAO); 0 if unknown.
    pub icao: u32,
    /// The claimed identity, if neither address nor call sign gives one.
    pub key: Option<TrackKey>,
    /// Call sign, without blanks.
    pub callsign: String,
    /// Position; the altitude above the datum in [`Quality::altitude`].
    pub place: Geodetic,
    /// Velocity east, north, up, metres per second; `None` if unknown.
    pub velocity_mps: Option<Vec3>,
    /// Time of validity, seconds on the local clock.
    pub valid_s: f64,
    /// How such an aircraft may move.
    pub movement: Movement,
    /// How much room it gets.
    pub class: AircraftClass,
    /// Its quality.
    pub quality: Quality,
}

/// A circle of this many σ contains 95 of 100 positions: √(−2 ln 0.05).
pub(super) const SIGMAS_IN_95: f64 = 2.4477;
/// σ of a velocity along an axis without quality figures, metres per second.
pub(crate) const VELOCITY_SIGMA_MPS: f64 = 1.0;

impl Quality {
    /// The quality of a report of a position alone, with its σ along an axis, metres.
    pub(crate) const fn of_position(sigma_m: f64, altitude: AltitudeReference) -> Self {
        Self {
            position_m: sigma_m,
            velocity_mps: 0.0,
            velocity_sigma_is_known: false,
            climb_is_known: false,
            height_m: 0.0,
            altitude,
        }
    }
}

impl PlaceReport {
    /// A report of nothing but the position of some aircraft at a time of the local clock, seconds.
    pub(crate) const fn of_position(
        sender: ReportSender,
        place: Geodetic,
        valid_s: f64,
        quality: Quality,
    ) -> Self {
        Self {
            sender,
            icao: 0,
            key: None,
            callsign: String::new(),
            place,
            velocity_mps: None,
            valid_s,
            movement: Movement::CREWED,
            class: AircraftClass::Crewed,
            quality,
        }
    }

    /// The claimed identity.
    pub fn key(&self) -> TrackKey {
        if let Some(key) = self.key {
            return key;
        }
        if self.icao != 0 {
            return TrackKey::Address(self.icao);
        }
        if self.callsign.is_empty() {
            return TrackKey::Unnamed(self.sender);
        }
        let mut name = [0; LONGEST_CALLSIGN];
        for (place, byte) in name.iter_mut().zip(self.callsign.bytes()) {
            *place = byte;
        }
        TrackKey::Callsign(self.sender, name)
    }

    /// The report in an `ADSB_VEHICLE` message.
    ///
    /// # Errors
    /// [`Defect::NoPosition`] without a valid position.
    pub fn from_adsb(
        data: &ADSB_VEHICLE_DATA,
        sender: ReportSender,
        now_s: f64,
        position_sigma_m: f64,
    ) -> Result<Self, Defect> {
        let has = |flag| data.flags.contains(flag);
        let place = adsb_place(data)
            .filter(|_| has(AdsbFlags::ADSB_FLAGS_VALID_COORDS))
            .ok_or(Defect::NoPosition)?;
        let has_altitude = has(AdsbFlags::ADSB_FLAGS_VALID_ALTITUDE)
            && place.altitude_m == f64::from(data.altitude) * 1e-3;
        let heading_rad = (f64::from(data.heading) * 0.01).to_radians();
        let speed_mps = f64::from(data.hor_velocity) * 0.01;
        let moves = AdsbFlags::ADSB_FLAGS_VALID_HEADING | AdsbFlags::ADSB_FLAGS_VALID_VELOCITY;
        let known = has(moves) && data.heading <= 36_000;
        let climb_is_known = has(AdsbFlags::ADSB_FLAGS_VERTICAL_VELOCITY_VALID) && has_altitude;
        let climb_mps = if climb_is_known {
            f64::from(data.ver_velocity) * 0.01
        } else {
            0.0
        };
        let velocity_mps = known.then(|| velocity_mps(speed_mps, heading_rad, climb_mps));
        // "Time since last communication" counts whole seconds, taken as rounded: neither the definition of MAVLink nor ArduPilot, which
        // subtracts and passes on what its receiver says, says that they are cut off. Times that are cut off are half a second late in the mean.
        let age_s = f64::from(data.tslc);
        let class = AircraftClass::of(data.emitter_type);
        let geometric = data.altitude_type == AdsbAltitudeType::ADSB_ALTITUDE_TYPE_GEOMETRIC;
        // Receivers fill in the transponder's pressure altitude, whatever the type's name says of QNH.
        let altitude = if !has_altitude {
            AltitudeReference::Unknown
        } else if geometric {
            AltitudeReference::Geometric
        } else {
            AltitudeReference::Pressure
        };
        let quality = Quality {
            velocity_mps: VELOCITY_SIGMA_MPS,
            climb_is_known,
            ..Quality::of_position(position_sigma_m, altitude)
        };
        Ok(Self {
            icao: adsb_address(data),
            callsign: tidy_callsign(data.callsign.to_str().unwrap_or_default()),
            velocity_mps,
            movement: class.movement(),
            class,
            ..Self::of_position(sender, place, now_s - age_s, quality)
        })
    }
}

/// The ICAO address of an `ADSB_VEHICLE` message; 0 if unknown.
pub const fn adsb_address(data: &ADSB_VEHICLE_DATA) -> u32 {
    data.ICAO_address & 0x00FF_FFFF
}

/// The position in an `ADSB_VEHICLE` message, valid or not; at altitude 0 for an altitude that no aircraft has.
pub fn adsb_place(data: &ADSB_VEHICLE_DATA) -> Option<Geodetic> {
    let at = |altitude_m: f64| place_from_e7(data.lat, data.lon, altitude_m);
    at(f64::from(data.altitude) * 1e-3).or_else(|| at(0.0))
}
