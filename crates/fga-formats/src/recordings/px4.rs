//! Logs of PX4: the vehicle by `vehicle_global_position`, other aircraft as its receiver of ADS-B gave them, by `transponder_report`.

use super::received::{Collector, Heard, Received, Who};
use crate::flight_log::ulog::{Said, read};
use crate::geodesy::{Geodetic, velocity_from_compass};
use crate::number::count;
use crate::tally::LeftOut;
use crate::traffic::address_in_words;

/// Positions of the vehicle are taken at least this far apart, seconds: five of them a second.
const EVERY_S: f64 = 0.19;

/// The aircraft of a log. The vehicle's name comes before all addresses: it is the ownship.
pub(super) fn parse(bytes: &[u8]) -> Received {
    let mut collector = Collector::default();
    let mut last_s = f64::NEG_INFINITY;
    let tally = read(bytes, |said| {
        let Said::Topic(format, message) = said else {
            return Some(Err(LeftOut::NotNeeded));
        };
        let field = |name: &str| format.number(message, name);
        let time_s = 1e-6 * field("timestamp")?;
        let mut who = Who {
            name: "(PX4)",
            address: None,
            callsign: None,
            is_by_pressure: false,
        };
        let (name, altitude_m, velocity_mps, age_s);
        match format.name.as_str() {
            "vehicle_global_position" if time_s - last_s < EVERY_S => {
                return Some(Err(LeftOut::NotNeeded));
            }
            "vehicle_global_position" => {
                last_s = time_s;
                (altitude_m, velocity_mps, age_s) = (field("alt")?, None, 0.0);
            }
            "transponder_report" => {
                // What is valid, from the lowest bit on: place, altitude, direction, velocity.
                let flags = count(field("flags")?);
                if flags & 0b0001 == 0 {
                    return Some(Err(LeftOut::NoPosition));
                }
                if flags & 0b0010 == 0 {
                    return Some(Err(LeftOut::NoAltitude));
                }
                let compass_deg = field("heading")?.to_degrees();
                let (speed_mps, climb_mps) = (field("hor_velocity")?, field("ver_velocity")?);
                let flown_mps = velocity_from_compass(compass_deg, speed_mps, climb_mps);
                let has_velocity = flags & 0b1100 == 0b1100 && flown_mps.is_finite();
                let address = u32::try_from(count(field("icao_address")?)).ok()?;
                name = address_in_words(address);
                (who.name, who.address) = (&name, Some(address));
                who.is_by_pressure = field("altitude_type")? == 0.0;
                (altitude_m, age_s) = (field("altitude")?, field("tslc")?);
                velocity_mps = has_velocity.then_some(flown_mps);
            }
            _ => return Some(Err(LeftOut::NotNeeded)),
        }
        let heard = Heard {
            time_s: time_s - age_s,
            place: Geodetic::new(field("lat")?, field("lon")?, altitude_m)?,
            velocity_mps,
        };
        collector.push(who, heard);
        Some(Ok(()))
    });
    let mut received = collector.finish(tally);
    if received.tracks.iter().any(|track| track.is_by_pressure) {
        let note =
            "altitudes of other aircraft are by pressure, those of the vehicle above the sea";
        received.notes.push(note.to_owned());
    }
    received
}
