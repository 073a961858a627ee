//! BaseStation lines, as receivers send them on port 30003.
//!
//! One message is a line of at least 22 fields separated by commas:
//! `MSG,type,session,aircraft,address,flight,date,time,date,time,callsign,altitude,ground speed,
//! track,latitude,longitude,vertical rate,squawk,alert,emergency,identification,on ground`.
//! Units: feet, knots, degrees from true north, degrees, feet per minute. What programs write besides:
//!
//! `docs/receivers.md`, BaseStation.
//!
//! A line with fewer fields is cut short; its last number may be cut too.

mod log;
mod message;
mod time;

use std::io::Write as _;

use super::lines::{LineParser, Lines};
use super::{Altitude, TrafficReport, address_in_words};
use crate::geodesy::compass_from_course_deg;
use crate::number::fixed;
use crate::tally::LeftOut;
use crate::units::{FOOT_M, FOOT_PER_MINUTE_MPS, KNOT_MPS};

pub use log::{Log, LoggedLine};
pub(crate) use message::is_message;
pub use message::parse_line;

/// A connection with such lines.
pub type LineStream = Lines<BaseStation>;

/// BaseStation lines, each of which stands for itself.
#[derive(Debug, Clone, Copy, Default)]
pub struct BaseStation;

impl LineParser for BaseStation {
    fn take(&mut self, line: &[u8]) -> Result<TrafficReport, LeftOut> {
        parse_line(line)
    }
}

/// Appends a report as BaseStation lines: identification, position and velocity, if the
/// report has them.
pub fn push_lines(out: &mut Vec<u8>, report: &TrafficReport) {
    let address = address_in_words(report.address);
    let ground = report
        .on_ground
        .map_or("", |on_ground| if on_ground { "-1" } else { "0" });
    // The fields from the call sign to the vertical rate; memory takes all.
    let mut line = |kind: u8, fields: &str| {
        let _ = write!(
            out,
            "MSG,{kind},1,1,{address},1,,,,,{fields},,,,,{ground}\r\n"
        );
    };
    let shown = |value: Option<f64>, decimals| {
        value.map_or_else(String::new, |value| fixed(value, decimals))
    };
    if let Some(callsign) = report.callsign {
        line(1, &format!("{callsign},,,,,,"));
    }
    if report.place_deg.is_some() || report.altitude.is_some() {
        let altitude = shown(
            report.altitude.map(|altitude| altitude.metres() / FOOT_M),
            0,
        );
        let above = if let Some(Altitude::Ellipsoid(_)) = report.altitude {
            "H"
        } else {
            ""
        };
        let (latitude_deg, longitude_deg) = report.place_deg.map(<(f64, f64)>::from).unzip();
        let place = [latitude_deg, longitude_deg]
            .map(|degrees| shown(degrees, 6))
            .join(",");
        line(3, &format!(",{altitude}{above},,,{place},"));
    }
    if report.ground_speed_mps.is_some() || report.climb_mps.is_some() {
        let speed = shown(
            report
                .ground_speed_mps
                .map(|speed_mps| speed_mps / KNOT_MPS),
            1,
        );
        let track = shown(report.course_rad.map(compass_from_course_deg), 1);
        let climb = shown(
            report
                .climb_mps
                .map(|climb_mps| climb_mps / FOOT_PER_MINUTE_MPS),
            0,
        );
        line(4, &format!(",,{speed},{track},,,{climb}"));
    }
}
