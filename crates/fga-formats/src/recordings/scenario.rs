//! Scenarios of `BlueSky` (`.scn`): the aircraft that `CRE` makes.
//!
//! An aircraft flies straight from where it begins, at its heading and calibrated airspeed or Mach number in the standard atmosphere, without
//! wind, until the first command about it that is not read (a heading, an altitude, a route), for ten minutes at most.

use alloc::collections::BTreeMap;

use super::received::{Collector, Heard, Received, Who};
use crate::geodesy::{Geodetic, velocity_from_compass};
use crate::number::finite;
use crate::tally::{LeftOut, Tally};
use crate::units::{FOOT_M, KNOT_MPS};

/// An aircraft flies straight for this long, seconds.
const STRAIGHT_S: f64 = 600.0;

/// The time and the command of a line.
fn command(line: &str) -> Option<(f64, &str)> {
    let (clock, command) = line.trim().split_once('>')?;
    let mut parts = clock.trim().split(':').map(|part| {
        let number = part.parse().ok();
        number.filter(|number: &f64| (0.0..1e6).contains(number))
    });
    let (hours, minutes, seconds) = (parts.next()??, parts.next()??, parts.next()??);
    let time_s = 3600.0 * hours + 60.0 * minutes + seconds;
    parts.next().is_none().then_some((time_s, command))
}

/// The lines that are neither blank nor a comment.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    let lines = text.lines().map(str::trim);
    lines.filter(|line| !line.is_empty() && !line.starts_with('#'))
}

/// Whether a text is a scenario, by its first line.
pub(super) fn is_one(text: &str) -> bool {
    lines(text)
        .next()
        .is_some_and(|line| command(line).is_some())
}

/// An aircraft: its first position, and when the first command about it comes, seconds.
struct CreatedAircraft {
    begin: Heard,
    end_s: f64,
}

/// The aircraft of a scenario.
pub(super) fn parse(text: &str) -> Received {
    let mut tally = Tally::default();
    let mut made: BTreeMap<String, CreatedAircraft> = BTreeMap::new();
    let mut unread: BTreeMap<String, usize> = BTreeMap::new();
    for line in lines(text) {
        let Some((time_s, words)) = command(line) else {
            tally.leave_out(LeftOut::UnreadableField);
            continue;
        };
        let words = words.to_ascii_uppercase();
        let words: Vec<&str> = words
            .split([',', ' ', '\t'])
            .filter(|word| !word.is_empty())
            .collect();
        let result = match &words[..] {
            ["CRE" | "CREATE", name, _, fields @ ..] => match begin(time_s, fields) {
                Ok(_) if made.contains_key(*name) => Err(LeftOut::SameTime),
                Ok(begin) => {
                    let end_s = time_s + STRAIGHT_S;
                    made.insert((*name).to_owned(), CreatedAircraft { begin, end_s });
                    Ok(())
                }
                Err(reason) => Err(reason),
            },
            [first, rest @ ..] => {
                let is_about = |word: &&&str| made.contains_key(**word);
                let about = words.iter().take(2).find(is_about).copied();
                let word = match rest.first() {
                    Some(second) if about == Some(first) => second,
                    _ => first,
                };
                *unread.entry((*word).to_owned()).or_default() += 1;
                match about.and_then(|name| made.get_mut(name)) {
                    Some(aircraft) => {
                        aircraft.end_s = aircraft.end_s.min(time_s);
                        Err(LeftOut::UnknownKind)
                    }
                    None => Err(LeftOut::NotNeeded),
                }
            }
            [] => Err(LeftOut::CutShort),
        };
        tally.take(&result);
    }
    let mut collector = Collector::default();
    for (name, CreatedAircraft { begin, end_s }) in &made {
        let who = Who {
            name,
            address: None,
            callsign: Some(name),
            is_by_pressure: true,
        };
        collector.push(who, *begin);
        let later = begin.straight(end_s - begin.time_s);
        later.for_each(|heard| collector.push(who, heard));
    }
    let unread = unread
        .iter()
        .map(|(word, count)| format!("{word} ({count})"));
    let unread: Vec<String> = unread.collect();
    let mut received = collector.finish(tally);
    if !unread.is_empty() {
        let notes = format!(
            "not read, {}: an aircraft flies straight until the first command about it",
            unread.join(", ")
        );
        received.notes.push(notes);
    }
    received
}

/// The first position of an aircraft by its latitude, longitude, heading, altitude and speed.
fn begin(time_s: f64, fields: &[&str]) -> Result<Heard, LeftOut> {
    let [latitude, longitude, heading, altitude, speed] = fields else {
        return Err(LeftOut::CutShort);
    };
    let number = |text: &str| finite(text).ok_or(LeftOut::UnreadableField);
    let feet = match altitude.strip_prefix("FL") {
        Some(level) => 100.0 * number(level)?,
        None => number(altitude.strip_suffix("FT").unwrap_or(altitude))?,
    };
    let altitude_m = feet * FOOT_M;
    let place = Geodetic::new(number(latitude)?, number(longitude)?, altitude_m);
    let place = place.ok_or(LeftOut::UnreadableField)?;
    // M82 and M.82 are one Mach number, and so is a speed below 1.
    let found = number(
        speed
            .trim_start_matches('M')
            .trim_end_matches("KTS")
            .trim_end_matches("KT"),
    )?;
    let is_mach = speed.starts_with('M') || (0.1..1.0).contains(&found);
    let speed_mps = match is_mach {
        true if found >= 10.0 => found / 100.0 * air(altitude_m).0,
        true => found * air(altitude_m).0,
        false => true_speed_mps(found * KNOT_MPS, altitude_m),
    };
    if !(0.0..1_000.0).contains(&speed_mps) {
        return Err(LeftOut::UnreadableField);
    }
    Ok(Heard {
        time_s,
        place,
        velocity_mps: Some(velocity_from_compass(number(heading)?, speed_mps, 0.0)),
    })
}

/// The speed of sound, metres per second, and the share of the pressure at sea level, in the standard atmosphere.
fn air(altitude_m: f64) -> (f64, f64) {
    let kelvin = (288.15 - 0.0065 * altitude_m).max(216.65);
    let above_m = (altitude_m - 11_000.0).max(0.0);
    let share = libm::pow(kelvin / 288.15, 5.255_88) * libm::exp(-above_m / 6_341.62);
    (libm::sqrt(1.4 * 287.053 * kelvin), share)
}

/// The true airspeed of a calibrated one.
fn true_speed_mps(calibrated_mps: f64, altitude_m: f64) -> f64 {
    let mach_of = |impact: f64| libm::sqrt(5.0 * (libm::pow(impact + 1.0, 2.0 / 7.0) - 1.0));
    let at_sea = calibrated_mps / air(0.0).0;
    let impact = libm::pow(1.0 + 0.2 * at_sea * at_sea, 3.5) - 1.0;
    let (sound_mps, share) = air(altitude_m);
    sound_mps * mach_of(impact / share)
}
