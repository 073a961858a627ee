//! GDL 90 messages, as portable receivers send them to UDP port 4000 (Garmin, GDL 90 Data Interface Specification, 560-1058-00 revision A).
//!
//! A message lies between two bytes `0x7E`; inside, `0x7D` stands before a `0x7E` or `0x7D` that is changed by `0x20`. It ends with a
//! checksum of two bytes.
//!
//! What becomes of each message and field: `docs/receivers.md`, GDL 90.

use super::{Altitude, Callsign, NON_ICAO, TrafficReport, position_error_m};
use crate::geodesy::course_from_compass_rad;
use crate::tally::{LeftOut, Tally};
use crate::units::{FOOT_M, FOOT_PER_MINUTE_MPS, KNOT_MPS};

/// At either end of a message.
const FLAG: u8 = 0x7E;
/// Before a byte that is changed.
const ESCAPE: u8 = 0x7D;
const CHANGED: u8 = 0x20;
/// The longest message with its checksum, bytes: an uplink of 436.
const LONGEST: usize = 440;
/// A traffic report without its kind, bytes.
const TRAFFIC: usize = 27;

/// Takes the bytes of datagrams as they come and gives reports.
#[derive(Debug, Clone, Default)]
pub struct Datagrams {
    body: Vec<u8>,
    /// Whether the message under way began with its flag.
    begun: bool,
    escaped: bool,
    tally: Tally,
}

impl Datagrams {
    /// Takes bytes and calls `report` for each report in them.
    pub fn push(&mut self, bytes: &[u8], mut report: impl FnMut(TrafficReport)) {
        for byte in bytes {
            match *byte {
                FLAG => self.end(&mut report),
                ESCAPE => self.escaped = true,
                other if self.body.len() <= LONGEST => {
                    let change = if self.escaped { CHANGED } else { 0 };
                    self.escaped = false;
                    self.body.push(other ^ change);
                    if self.body.len() > LONGEST {
                        self.tally.leave_out(LeftOut::TooLong);
                    }
                }
                _ => {}
            }
        }
    }

    /// A flag: the end of a message, or the beginning of the next one.
    fn end(&mut self, report: &mut impl FnMut(TrafficReport)) {
        let is_cut = !self.begun || self.escaped;
        (self.begun, self.escaped) = (true, false);
        let length = self.body.len();
        if (1..=LONGEST).contains(&length) {
            let parsed = if is_cut {
                Err(LeftOut::CutShort)
            } else {
                parse(&self.body)
            };
            self.tally.take(&parsed);
            parsed.into_iter().for_each(report);
        }
        self.body.clear();
    }

    /// A new connection begins: a message under way will not be finished.
    pub fn reconnect(&mut self) {
        if (1..=LONGEST).contains(&self.body.len()) {
            self.tally.leave_out(LeftOut::CutShort);
        }
        self.body.clear();
        (self.begun, self.escaped) = (false, false);
    }

    /// Counts of the messages so far.
    pub const fn tally(&self) -> Tally {
        self.tally
    }
}

/// The checksum of a message (2.2.3), as its last two bytes have it.
fn checksum(message: &[u8]) -> u16 {
    message.iter().fold(0, |sum: u16, byte| {
        let mut high = sum & 0xFF00;
        for _ in 0..8 {
            let carry = high & 0x8000 != 0;
            high = high << 1 ^ if carry { 0x1021 } else { 0 };
        }
        high ^ sum << 8 ^ u16::from(*byte)
    })
}

/// A message without its flags and escapes.
fn parse(message: &[u8]) -> Result<TrafficReport, LeftOut> {
    let (message, sum) = message.split_last_chunk::<2>().ok_or(LeftOut::CutShort)?;
    if checksum(message) != u16::from_le_bytes(*sum) {
        return Err(LeftOut::WrongChecksum);
    }
    match message {
        [20, report @ ..] => match <&[u8; TRAFFIC]>::try_from(report) {
            Ok(report) => traffic(report),
            Err(_) => Err(LeftOut::UnreadableField),
        },
        [
            0 | 2 | 7 | 9 | 10 | 11 | 30 | 31 | 37 | 40 | 76 | 83 | 101 | 204,
            ..,
        ] => Err(LeftOut::NotNeeded),
        [] => Err(LeftOut::CutShort),
        _ => Err(LeftOut::UnknownKind),
    }
}

/// A traffic report (3.5.1).
fn traffic(bytes: &[u8; TRAFFIC]) -> Result<TrafficReport, LeftOut> {
    let whole = |at: usize| {
        let three = bytes.get(at..).and_then(<[u8]>::first_chunk::<3>);
        three.map_or(0, |[a, b, c]| u32::from_be_bytes([0, *a, *b, *c]))
    };
    let kind = bytes[0] & 0xF;
    let is_drawn = match kind {
        0 | 2 => false,
        // Drawn by the aircraft, of a track of a ground station, a vehicle of an airport.
        1 | 3 | 4 => true,
        // A beacon of a ground station.
        5 => return Err(LeftOut::NotNeeded),
        _ => return Err(LeftOut::UnreadableField),
    };
    let address = whole(1);
    if address == 0 {
        return Err(LeftOut::NoAddress);
    }
    let degrees = |field: u32| {
        // Extends the sign of 24 bits.
        let signed = (field << 8).cast_signed() >> 8;
        f64::from(signed) * 180.0 / 8_388_608.0
    };
    let place_deg = [degrees(whole(4)), degrees(whole(7))];
    let (integrity, accuracy) = (bytes[12] >> 4, bytes[12] & 0xF);
    let is_placed = integrity != 0 || place_deg != [0.0; 2];
    if place_deg[0].abs() > 90.0 {
        return Err(LeftOut::UnreadableField);
    }
    let (altitude, misc) = (whole(10) >> 12, bytes[11] & 0xF);
    let (speed, climb) = (whole(13) >> 12, whole(13) & 0xFFF);
    let has_track = misc & 3 == 1;
    let climb = (climb << 20).cast_signed() >> 20;
    let on_ground = misc & 8 == 0 || kind == 4;
    let callsign = bytes
        .get(18..26)
        .and_then(|letters| str::from_utf8(letters).ok());
    Ok(TrafficReport {
        address: address | if is_drawn { NON_ICAO } else { 0 },
        callsign: callsign.and_then(Callsign::new),
        place_deg: is_placed.then_some(place_deg),
        altitude: (altitude != 0xFFF)
            .then(|| Altitude::Pressure((25.0 * f64::from(altitude) - 1000.0) * FOOT_M)),
        ground_speed_mps: (speed != 0xFFF).then(|| f64::from(speed) * KNOT_MPS),
        course_rad: has_track
            .then(|| course_from_compass_rad(f64::from(bytes[16]) * 360.0 / 256.0)),
        climb_mps: (climb != -0x800).then(|| 64.0 * f64::from(climb) * FOOT_PER_MINUTE_MPS),
        on_ground: Some(on_ground),
        containment_m: containment_m(integrity),
        position_error_m: position_error_m(accuracy),
        ..TrafficReport::default()
    })
}

/// Radius of containment of a navigation integrity category, metres.
fn containment_m(category: u8) -> Option<f64> {
    let radii_m = [
        f64::INFINITY,
        37_040.0,
        14_816.0,
        7_408.0,
        3_704.0,
        1_852.0,
        1_111.2,
        370.4,
        185.2,
        75.0,
        25.0,
        7.5,
    ];
    radii_m.get(usize::from(category)).copied()
}
