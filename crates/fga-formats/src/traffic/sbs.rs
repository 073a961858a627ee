//! BaseStation lines, as receivers send them on port 30003.
//!
//! One message is a line of at least 22 fields separated by commas:
//! `MSG,type,session,aircraft,address,flight,date,time,date,time,callsign,altitude,ground speed,
//! track,latitude,longitude,vertical rate,squawk,alert,emergency,identification,on ground`.
//! Units: feet, knots, degrees from true north, degrees, feet per minute. What programs write besides:
//!
//! | what | who | meaning here |
//! |---|---|---|
//! | `H` after an altitude or a vertical rate | dump1090 and readsb with `--gnss` | height above the ellipsoid |
//! | `~` before an address | readsb, tar1090 | no address of the ICAO: [`NON_ICAO`](super::NON_ICAO) |
//! | more fields at the end | readsb (signal, category), mlat-client (stations, error) | ignored; after `MLAT` the error is read |
//! | `MLAT` or another word than `MSG` | mlat-client, Virtual Radar Server | read all the same |
//! | a field in quotes | mlat-client | its content |
//! | a first date and time before the second | mlat-client, readsb | the age of the message |
//! | a number before the first word | Stratux | the recorder's time, nanoseconds |
//! | `STA`, `AIR`, `ID`, `SEL`, `CLK`, `START`, blank lines | `BaseStation`, recorders, heartbeats | without use |
//!
//! A line with fewer fields is cut short; its last number may be cut too.

mod log;
mod message;
mod time;

use super::lines::LineBuffer;
use super::{Altitude, TrafficReport, address_in_words};
use crate::geodesy::compass_from_course_deg;
use crate::number::push_fixed;
use crate::tally::Tally;
use crate::units::{FOOT_M, FOOT_PER_MINUTE_MPS, KNOT_MPS};

pub use log::{Log, LoggedLine};
pub(crate) use message::is_message;
pub use message::parse_line;

use message::FIELDS;

/// Takes the bytes of a connection as they come and gives reports.
#[derive(Debug, Clone, Default)]
pub struct LineStream(LineBuffer);

impl LineStream {
    /// Takes bytes and calls `report` for each report in them.
    pub fn push(&mut self, bytes: &[u8], report: impl FnMut(TrafficReport)) {
        self.0.push(bytes, parse_line, report);
    }

    /// A new connection begins: a line under way will not be finished.
    pub fn reconnect(&mut self) {
        self.0.reconnect();
    }

    /// Counts of the lines so far.
    pub const fn tally(&self) -> Tally {
        self.0.tally()
    }
}

/// Appends a report as BaseStation lines: identification, position and velocity, if the
/// report has them.
pub fn push_lines(out: &mut Vec<u8>, report: &TrafficReport) {
    let mut line = |kind: u8, fill: &dyn Fn(&mut [Vec<u8>; FIELDS])| {
        let mut fields: [Vec<u8>; FIELDS] = core::array::from_fn(|_| Vec::new());
        fields[0].extend(b"MSG");
        fields[1].push(kind);
        fields[2].push(b'1');
        fields[3].push(b'1');
        fields[4].extend(address_in_words(report.address).bytes());
        fields[5].push(b'1');
        if let Some(on_ground) = report.on_ground {
            fields[21].extend(if on_ground { &b"-1"[..] } else { b"0" });
        }
        fill(&mut fields);
        out.extend(fields.join(&b','));
        out.extend(b"\r\n");
    };
    let altitude_ft = report.altitude.map(|a| a.metres() / FOOT_M);
    if let Some(callsign) = report.callsign {
        line(b'1', &|fields| {
            fields[10].extend(callsign.as_str().bytes());
        });
    }
    if report.place_deg.is_some() || altitude_ft.is_some() {
        line(b'3', &|fields| {
            if let Some(feet) = altitude_ft {
                push_fixed(&mut fields[11], feet, 0);
                if let Some(Altitude::Ellipsoid(_)) = report.altitude {
                    fields[11].push(b'H');
                }
            }
            if let Some([latitude_deg, longitude_deg]) = report.place_deg {
                push_fixed(&mut fields[14], latitude_deg, 6);
                push_fixed(&mut fields[15], longitude_deg, 6);
            }
        });
    }
    if report.ground_speed_mps.is_some() || report.climb_mps.is_some() {
        line(b'4', &|fields| {
            if let Some(speed_mps) = report.ground_speed_mps {
                push_fixed(&mut fields[12], speed_mps / KNOT_MPS, 1);
            }
            if let Some(course_rad) = report.course_rad {
                push_fixed(&mut fields[13], compass_from_course_deg(course_rad), 1);
            }
            if let Some(climb_mps) = report.climb_mps {
                push_fixed(&mut fields[16], climb_mps / FOOT_PER_MINUTE_MPS, 0);
            }
        });
    }
}
