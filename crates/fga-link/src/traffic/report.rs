//! One report of another aircraft's position, and how an `ADSB_VEHICLE` message becomes one.

use fga::Vec3;
use fga_formats::geodesy::Geodetic;
use mavlink::dialects::ardupilotmega::{ADSB_VEHICLE_DATA, AdsbAltitudeType, AdsbFlags};

use crate::number::degrees_from_e7;

/// Where a report came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Source {
    /// A receiver or a player on the MAVLink network.
    Mavlink,
    /// The autopilot's own list, sent about once a second and late.
    AutopilotList,
    /// A BaseStation stream.
    Sbs,
    /// A Beast stream.
    Beast,
    /// The configuration.
    Virtual,
}

impl Source {
    /// Name in logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mavlink => "mavlink",
            Self::AutopilotList => "autopilot",
            Self::Sbs => "sbs",
            Self::Beast => "beast",
            Self::Virtual => "virtual",
        }
    }
}

/// How well a report knows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// σ of the horizontal position along an axis, metres.
    pub position_m: f64,
    /// Whether the altitude is geometric; a pressure altitude may be off by tens of metres.
    pub geometric_altitude: bool,
}

/// What one message said.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Where it came from.
    pub source: Source,
    /// ICAO address; 0 where none was given.
    pub icao: u32,
    /// Call sign, without blanks.
    pub callsign: String,
    /// Where; altitude above mean sea level.
    pub place: Geodetic,
    /// Velocity east, north, up, metres per second; `None` where it was not given.
    pub velocity_mps: Option<Vec3>,
    /// When that was true, seconds on the local clock.
    pub valid_s: f64,
    /// How well it is known.
    pub quality: Quality,
}

/// Longest call sign that is kept.
const LONGEST_CALLSIGN: usize = 9;

/// A call sign without blanks and control characters, of bounded length.
pub fn tidy_callsign(text: &str) -> String {
    text.chars()
        .filter(char::is_ascii_graphic)
        .take(LONGEST_CALLSIGN)
        .collect()
}

impl Report {
    /// What an `ADSB_VEHICLE` message says; `None` without a usable position and altitude.
    pub fn from_adsb(
        data: &ADSB_VEHICLE_DATA,
        source: Source,
        now_s: f64,
        position_sigma_m: f64,
    ) -> Option<Self> {
        let needed = AdsbFlags::ADSB_FLAGS_VALID_COORDS | AdsbFlags::ADSB_FLAGS_VALID_ALTITUDE;
        if !data.flags.contains(needed) || (data.lat == 0 && data.lon == 0) {
            return None;
        }
        let place = Geodetic::new(
            degrees_from_e7(data.lat),
            degrees_from_e7(data.lon),
            f64::from(data.altitude) * 1e-3,
        )?;
        let heading_rad = (f64::from(data.heading) * 0.01).to_radians();
        let speed_mps = f64::from(data.hor_velocity) * 0.01;
        let moves = AdsbFlags::ADSB_FLAGS_VALID_HEADING | AdsbFlags::ADSB_FLAGS_VALID_VELOCITY;
        let known = data.flags.contains(moves) && data.heading <= 36_000;
        let climb_mps = if data
            .flags
            .contains(AdsbFlags::ADSB_FLAGS_VERTICAL_VELOCITY_VALID)
        {
            f64::from(data.ver_velocity) * 0.01
        } else {
            0.0
        };
        let velocity_mps = known.then(|| {
            Vec3::new(
                speed_mps * libm::sin(heading_rad),
                speed_mps * libm::cos(heading_rad),
                climb_mps,
            )
        });
        // "Time since last communication" counts whole seconds: 0 is fresh.
        let age_s = f64::from(data.tslc.min(60));
        Some(Self {
            source,
            icao: data.ICAO_address & 0x00FF_FFFF,
            callsign: tidy_callsign(data.callsign.to_str().unwrap_or_default()),
            place,
            velocity_mps,
            valid_s: now_s - age_s,
            quality: Quality {
                position_m: position_sigma_m,
                geometric_altitude: data.altitude_type
                    == AdsbAltitudeType::ADSB_ALTITUDE_TYPE_GEOMETRIC,
            },
        })
    }
}
