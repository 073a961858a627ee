//! Turns Mode S messages into reports: only extended squitters (downlink formats 17 and 18), because
//! only they carry a checksum that verifies them and the aircraft's position.

use super::{Altitude, Callsign, Generations, NON_ICAO, TrafficReport, position_error_m};
use crate::geodesy::{Geodetic, course_from_compass_rad};
use crate::tally::LeftOut;
use crate::units::{FOOT_M, FOOT_PER_MINUTE_MPS, KNOT_MPS};
use rs1090::decode::adsb::ME;
use rs1090::decode::bds::bds05::AirbornePosition;
use rs1090::decode::bds::bds09::{AirborneVelocity, AirborneVelocitySubType};
use rs1090::decode::cpr::{CPRFormat, airborne_position};
use rs1090::decode::crc::modes_checksum;
use rs1090::decode::{ControlFieldType, DF, Message};

/// Most aircraft in memory.
const MOST_AIRCRAFT: usize = 32_768;
/// Largest time between the two halves of a position, seconds (ICAO 9871, C.2.6.7).
const PAIR_AGE_S: f64 = 10.0;
/// The fastest plausible jump between positions, metres per second.
const FASTEST_MPS: f64 = 1000.0;

/// The memory of an aircraft.
#[derive(Debug, Clone, Default)]
pub(super) struct SurveillanceMessage {
    aircraft: Generations<HeardAircraft, MOST_AIRCRAFT>,
}

#[derive(Debug, Clone, Default)]
struct HeardAircraft {
    supplement: Supplement,
    even: Option<(AirbornePosition, f64)>,
    odd: Option<(AirbornePosition, f64)>,
    place: Option<(Geodetic, f64)>,
}

impl SurveillanceMessage {
    pub(super) fn aircraft(&self) -> usize {
        self.aircraft.len()
    }

    /// Takes one message received at `time_s`.
    pub(super) fn take(&mut self, message: &[u8], time_s: f64) -> Result<TrafficReport, LeftOut> {
        let Ok(bytes) = <&[u8; 14]>::try_from(message) else {
            return Err(LeftOut::NotNeeded);
        };
        let format = bytes[0] >> 3;
        if !matches!(format, 17 | 18) {
            return Err(LeftOut::NotNeeded);
        }
        // ICAO Annex 10, volume IV, 3.1.2.3.3: zero if the message is intact.
        if !matches!(modes_checksum(bytes, 8 * bytes.len()), Ok(0)) {
            return Err(LeftOut::WrongChecksum);
        }
        // Kinds without use here do not reach the decoder.
        let kind = bytes[4] >> 3;
        let report = match kind {
            29 => target_state(bytes),
            31 => self.operational_status(bytes),
            _ => None,
        };
        if !matches!(kind, 1..=22) {
            return report.ok_or(LeftOut::NotNeeded);
        }
        let decoded = Message::try_from(&bytes[..]).map_err(|_| LeftOut::UnreadableField)?;
        let (address, content) = match decoded.df {
            DF::ExtendedSquitterADSB(squitter) => (squitter.icao24.0, squitter.message),
            DF::ExtendedSquitterTisB { cf, .. } => match cf.field_type {
                // Formats of a transponder with a true address.
                ControlFieldType::ADSB_ES_NT | ControlFieldType::TISB_ADSB => (cf.aa.0, cf.me),
                // A drawn address, or one of a ground station.
                ControlFieldType::ADSB_ES_NT_ALT
                | ControlFieldType::TISB_FINE
                | ControlFieldType::TISB_ADSB_RELAY => (cf.aa.0 | NON_ICAO, cf.me),
                _ => return Err(LeftOut::NotNeeded),
            },
            _ => return Err(LeftOut::NotNeeded),
        };
        let mut report = TrafficReport {
            address,
            ..TrafficReport::default()
        };
        match content {
            ME::BDS08 { inner, .. } => report.callsign = Callsign::new(&inner.callsign),
            ME::BDS06 { .. } => report.on_ground = Some(true),
            ME::BDS05 { inner, .. } => {
                report.on_ground = Some(false);
                let supplement = self.aircraft.entry(address).supplement;
                report.containment_m = containment_m(kind, bytes, supplement);
                report.altitude = if kind >= 20 {
                    Some(Altitude::Ellipsoid(f64::from(altitude_field(bytes))))
                } else {
                    let feet = inner.alt.map(f64::from);
                    feet.map(|feet| Altitude::Pressure(feet * FOOT_M))
                };
                report.place_deg = self.place(address, inner, time_s);
            }
            ME::BDS09(velocity) => velocity_of(bytes, &velocity, &mut report),
            _ => return Err(LeftOut::NotNeeded),
        }
        if report.says_nothing() {
            return Err(LeftOut::NotNeeded);
        }
        Ok(report)
    }

    /// Quality from an operational status of a transponder of version 1 or 2 (DO-260B, 2.2.3.2.7.2);
    /// version 0 gives none.
    fn operational_status(&mut self, message: &[u8; 14]) -> Option<TrafficReport> {
        let (address, content) = address_and_content(message)?;
        let [first, _, _, _, _, accuracy, integrity] = *content;
        let version = accuracy >> 5;
        if first & 7 != 0 || !matches!(version, 1 | 2) {
            return None;
        }
        self.aircraft.entry(address).supplement = Supplement {
            version,
            a: accuracy & 0x10 != 0,
        };
        Some(TrafficReport {
            address,
            position_error_m: position_error_m(accuracy & 0xF),
            source_integrity: Some((integrity >> 4) & 3),
            ..TrafficReport::default()
        })
    }

    /// Stores a half of a position and gives the position if the other half is at hand.
    fn place(&mut self, address: u32, half: AirbornePosition, time_s: f64) -> Option<[f64; 2]> {
        let heard = self.aircraft.entry(address);
        let other = match half.parity {
            CPRFormat::Even => {
                heard.even = Some((half, time_s));
                heard.odd
            }
            CPRFormat::Odd => {
                heard.odd = Some((half, time_s));
                heard.even
            }
        };
        let (other, other_s) = other?;
        if (time_s - other_s).abs() > PAIR_AGE_S {
            return None;
        }
        let position = airborne_position(&other, &half)?;
        let place = Geodetic::new(position.latitude, position.longitude, 0.0)
            .filter(|place| place.longitude_deg.abs() <= 180.0)?;
        // A jump means a wrong pair now or before; the next pair decides.
        if let Some((last, last_s)) = heard.place.replace((place, time_s)) {
            let farthest_m = FASTEST_MPS * (time_s - last_s).abs() + 2000.0;
            if last.distance_m(place) > farthest_m {
                return None;
            }
        }
        Some([place.latitude_deg, place.longitude_deg])
    }
}

/// The part of an operational status that qualifies the kind of a position message.
#[derive(Debug, Clone, Copy, Default)]
struct Supplement {
    /// Version of the standard that the transponder follows; 0 while unknown.
    version: u8,
    /// NIC supplement A.
    a: bool,
}

/// Address and content of a squitter with an address of the ICAO.
fn address_and_content(message: &[u8; 14]) -> Option<(u32, &[u8; 7])> {
    // Others, from ground stations and with anonymous addresses, give no quality here.
    let (head, rest) = message.split_first_chunk::<4>()?;
    let [format, a, b, c] = *head;
    let own = format >> 3 == 17 || format == 18 << 3;
    let address = u32::from_be_bytes([0, a, b, c]);
    own.then_some((address, rest.first_chunk::<7>()?))
}

/// Quality from a target state and status of version 2 (DO-260B, 2.2.3.2.7.1).
fn target_state(message: &[u8; 14]) -> Option<TrafficReport> {
    let (address, content) = address_and_content(message)?;
    let [first, _, _, _, fourth, fifth, _] = *content;
    if (first >> 1) & 3 != 1 {
        return None;
    }
    Some(TrafficReport {
        address,
        position_error_m: position_error_m((fourth & 1) << 3 | fifth >> 5),
        source_integrity: Some((fifth >> 2) & 3),
        ..TrafficReport::default()
    })
}

/// The twelve bits of altitude in a position message.
fn altitude_field(message: &[u8; 14]) -> u16 {
    u16::from(message[5]) << 4 | u16::from(message[6] >> 4)
}

/// Radius of containment of a kind of position message, metres (DO-260B, table 2-14; without the
/// supplement that narrows it, the larger radius).
fn containment_m(kind: u8, message: &[u8; 14], supplement: Supplement) -> Option<f64> {
    // From version 2 on the message itself has supplement B.
    let b = supplement.version < 2 || message[4] & 1 != 0;
    let narrow = supplement.version >= 1 && supplement.a && b;
    Some(match kind {
        9 | 20 => 7.5,
        10 | 21 => 25.0,
        11 if narrow => 75.0,
        11 => 185.2,
        12 => 370.4,
        13 => 1111.2,
        14 => 1852.0,
        15 => 3704.0,
        16 if narrow => 7408.0,
        16 => 18_520.0,
        17 => 37_040.0,
        18 | 22 => f64::INFINITY,
        _ => return None,
    })
}

/// Velocity over ground and climb.
fn velocity_of(message: &[u8; 14], velocity: &AirborneVelocity, report: &mut TrafficReport) {
    report.velocity_error_mps = match velocity.nac_v {
        0 => Some(f64::INFINITY),
        1 => Some(10.0),
        2 => Some(3.0),
        3 => Some(1.0),
        4 => Some(0.3),
        _ => None,
    };
    report.climb_mps = velocity
        .vertical_rate
        .map(|fpm| f64::from(fpm) * FOOT_PER_MINUTE_MPS);
    let AirborneVelocitySubType::GroundSpeedDecoding(ground) = &velocity.velocity else {
        return;
    };
    // A component of zero means unknown (ICAO 9871, table A-2-9a).
    let [.., b5, b6, b7, b8] = *message.first_chunk::<9>().unwrap_or(&[0; 9]);
    let east_west = u16::from(b5 & 0x3) << 8 | u16::from(b6);
    let north_south = u16::from(b7 & 0x7F) << 3 | u16::from(b8 >> 5);
    if east_west == 0 || north_south == 0 {
        return;
    }
    // The supersonic kind counts in steps of four knots.
    let step_kn = if velocity.subtype == 2 { 4.0 } else { 1.0 };
    report.ground_speed_mps = Some((ground.groundspeed * step_kn) * KNOT_MPS);
    report.course_rad = Some(course_from_compass_rad(ground.track));
}
