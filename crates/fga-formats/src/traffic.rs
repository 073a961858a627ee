//! Reports of receivers of ADS-B about other aircraft.
//!
//! | module | wire |
//! |---|---|
//! | [`sbs`] | BaseStation lines, usually TCP port 30003 |
//! | [`flarm`] | FLARM sentences, usually TCP port 2000 or 4353 |
//! | [`gdl90`] | GDL 90 messages, usually UDP port 4000 |
//! | `beast` (with the feature of this name) | Beast binary frames, usually TCP port 30005 |
//!
//! All give [`TrafficReport`]s: the content of one message, in SI units. Memory stays bounded
//! whatever the network sends; what cannot be used is counted by reason ([`Tally`](crate::tally::Tally)).

#[cfg(feature = "beast")]
pub mod beast;
pub mod flarm;
pub mod gdl90;
mod generations;
pub mod lines;
pub mod sbs;
#[cfg(feature = "beast")]
mod surveillance;

pub use generations::Generations;

use core::fmt;

use arrayvec::ArrayString;

/// The bit of an address that ICAO has not assigned: of a ground station, or drawn by the aircraft.
pub const NON_ICAO: u32 = 1 << 24;

/// An address in hexadecimal digits; `~` before them, as readsb writes it, marks an address that ICAO has not assigned.
///
/// ```
/// use fga_formats::traffic::{NON_ICAO, address_in_words};
///
/// assert_eq!(address_in_words(0xA1B2C), "0A1B2C");
/// assert_eq!(address_in_words(0xA1B2C | NON_ICAO), "~0A1B2C");
/// ```
pub fn address_in_words(address: u32) -> String {
    let sign = if address & NON_ICAO == 0 { "" } else { "~" };
    format!("{sign}{:06X}", address & !NON_ICAO)
}

/// The content of one message about one aircraft; missing fields are `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TrafficReport {
    /// 24-bit address of the International Civil Aviation Organization, or another number with [`NON_ICAO`].
    pub address: u32,
    /// Call sign or registration.
    pub callsign: Option<Callsign>,
    /// Latitude and longitude, degrees.
    pub place_deg: Option<[f64; 2]>,
    /// Altitude.
    pub altitude: Option<Altitude>,
    /// Ground speed, metres per second.
    pub ground_speed_mps: Option<f64>,
    /// Course over ground ψ, radians from east towards north.
    pub course_rad: Option<f64>,
    /// Climb, metres per second.
    pub climb_mps: Option<f64>,
    /// Whether the aircraft says that it is on the ground.
    pub on_ground: Option<bool>,
    /// Radius that contains the true position with near certainty, metres; infinite if the aircraft
    /// reports that it does not know one.
    pub containment_m: Option<f64>,
    /// Radius that contains the true position in 95 of 100 cases, metres; infinite if the aircraft
    /// reports that it does not know one.
    pub position_error_m: Option<f64>,
    /// Source integrity level: 0 if the failure rate of the containment is unknown, 3 if it fails
    /// once in 10⁷ hours.
    pub source_integrity: Option<u8>,
    /// Bound of the horizontal velocity error in 95 of 100 cases, metres per second; infinite if
    /// the aircraft reports that it does not know one.
    pub velocity_error_mps: Option<f64>,
    /// Time from its reception to its sending on, seconds; 0 if the receiver does not say it.
    pub age_s: f64,
}

impl TrafficReport {
    /// Whether it has nothing but its address.
    fn says_nothing(&self) -> bool {
        let address = self.address;
        *self
            == Self {
                address,
                ..Self::default()
            }
    }

    /// Velocity over ground east and north, metres per second, if the report has it.
    pub fn ground_velocity_mps(&self) -> Option<[f64; 2]> {
        let (sin, cos) = libm::sincos(self.course_rad?);
        let speed_mps = self.ground_speed_mps?;
        Some([speed_mps * cos, speed_mps * sin])
    }
}

/// The estimated position uncertainty of a navigation accuracy category, metres (DO-260B, table
/// 2-71).
fn position_error_m(category: u8) -> Option<f64> {
    let errors_m = [
        f64::INFINITY,
        18_520.0,
        7_408.0,
        3_704.0,
        1_852.0,
        926.0,
        555.6,
        185.2,
        92.6,
        30.0,
        10.0,
        3.0,
    ];
    errors_m.get(usize::from(category)).copied()
}

/// The address in hexadecimal digits, of at most 24 bits and not 0; a sign before them marks one that ICAO has not assigned.
pub(crate) fn address_of(text: &str) -> Option<u32> {
    let digits = text.trim_start_matches(|letter: char| !letter.is_ascii_alphanumeric());
    let is_short = digits.len() <= 6 && text.len() - digits.len() <= 1;
    let address = u32::from_str_radix(digits, 16).ok();
    let address = address.filter(|address| is_short && *address != 0)?;
    let is_assigned = digits.len() == text.len();
    Some(address | if is_assigned { 0 } else { NON_ICAO })
}

/// An altitude and its datum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Altitude {
    /// Pressure altitude in the standard atmosphere, metres.
    Pressure(f64),
    /// Height above the WGS-84 ellipsoid, metres.
    Ellipsoid(f64),
}

impl Altitude {
    /// The altitude in metres above its datum.
    pub const fn metres(self) -> f64 {
        match self {
            Self::Pressure(metres) | Self::Ellipsoid(metres) => metres,
        }
    }
}

/// A call sign: one to eight letters, digits or blanks inside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Callsign(ArrayString<8>);

impl Callsign {
    /// The call sign in `text` without the blanks around it; `None` if that is empty, longer
    /// than eight characters or holds anything but letters, digits, `-` and blanks.
    pub fn new(text: &str) -> Option<Self> {
        let text = text.trim();
        let known = |letter: u8| letter.is_ascii_alphanumeric() || b"- ".contains(&letter);
        let is_one = !text.is_empty() && text.bytes().all(known);
        ArrayString::from(text).ok().filter(|_| is_one).map(Self)
    }

    /// The call sign as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Callsign {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}
