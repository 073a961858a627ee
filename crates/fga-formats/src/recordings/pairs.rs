//! Finds the aircraft of a reception log that came close to each other.
//!
//! Two tracks are an encounter when at some time they are within [`CLOSE_M`] horizontally and
//! [`CLOSE_HEIGHT_M`] vertically. It reaches from [`BEFORE_S`] before their closest approach to
//! [`AFTER_S`] after it, as far as both report without a gap longer than [`GAP_S`]. The first
//! of the two by name is the ownship. Between reports aircraft fly straight.

use super::encounters::{Encounters, Named};
use super::received::{Heard, Received, ReceivedTrack};
use crate::daa::{Recording, Track, TrackSample};
use crate::error::InputError;
use crate::geodesy::{Earth, LocalFrame};
use crate::tally::{LeftOut, Tally};
use std::collections::HashMap;
use std::path::Path;

/// Horizontal distance of a pair, metres.
pub const CLOSE_M: f64 = 3000.0;
/// Vertical distance of a pair, metres.
pub const CLOSE_HEIGHT_M: f64 = 300.0;
/// An encounter begins this long before the closest approach, seconds.
pub const BEFORE_S: f64 = 120.0;
/// An encounter ends this long after the closest approach, seconds.
pub const AFTER_S: f64 = 60.0;
/// A longer silence ends a track, seconds.
pub const GAP_S: f64 = 30.0;
/// The least common time of an encounter, seconds.
const SHORTEST_S: f64 = 20.0;
/// Below this speed an aircraft stands on the ground, metres per second.
const SLOWEST_MPS: f64 = 5.0;
/// The longest step between two checks of a pair, seconds.
const LOOK_S: f64 = 1.0;

/// The close pairs among the aircraft of a log, in the order of their names; `parts` names what the log
/// counts.
///
/// # Errors
/// No pair at all.
pub(super) fn close_pairs(
    received: &Received,
    parts: &str,
    name: &str,
    path: &Path,
) -> Result<Encounters, InputError> {
    let tracks = &received.tracks;
    let mut tally = received.tally;
    let pieces: Vec<ReceivedTrack> = tracks
        .iter()
        .flat_map(|track| unbroken(track, &mut tally))
        .collect();
    let mut found = Vec::new();
    // The same two may meet twice.
    let mut met: HashMap<String, usize> = HashMap::new();
    for (index, first) in pieces.iter().enumerate() {
        for second in pieces.iter().skip(index + 1) {
            if first.name != second.name
                && let Some(recording) = pair(first, second)
            {
                let name = format!("{name} {}-{}", first.name, second.name);
                let times = met.entry(name.clone()).or_default();
                *times += 1;
                let again = format!("{name} #{times}");
                let name = if *times > 1 { again } else { name };
                found.push(Named { name, recording });
            }
        }
    }
    if found.is_empty() {
        let left_out = tally
            .words(parts)
            .map_or_else(String::new, |words| format!("; left out: {words}"));
        let message = format!(
            "has {} aircraft with positions, of which no two come within {CLOSE_M} m and {CLOSE_HEIGHT_M} m of each other, expected at least one pair{left_out}",
            tracks.len()
        );
        return Err(InputError::in_file(path, message));
    }
    Ok(Encounters {
        named: found,
        tally,
    })
}

/// The parts of a track without gaps and jumps.
fn unbroken(track: &ReceivedTrack, tally: &mut Tally) -> Vec<ReceivedTrack> {
    track
        .heard
        .chunk_by(|a, b| b.time_s - a.time_s <= GAP_S && a.reaches(b))
        .filter(|part| {
            if part.len() < 2 {
                tally.refuse(LeftOut::Alone);
            }
            part.len() >= 2
        })
        .map(|part| ReceivedTrack {
            heard: part.to_vec(),
            ..track.clone()
        })
        .collect()
}

/// A pair as a recording, if it comes close.
fn pair(first: &ReceivedTrack, second: &ReceivedTrack) -> Option<Recording> {
    let (one, other) = (&first.heard, &second.heard);
    let begin_s = one.first()?.time_s.max(other.first()?.time_s);
    let end_s = one.last()?.time_s.min(other.last()?.time_s);
    if end_s - begin_s < SHORTEST_S {
        return None;
    }
    let frame = LocalFrame::new(one.first()?.place, Earth::Daidalus);
    let tracks = [first, second].map(|track| local(track, &frame));
    let looks = libm::ceil((end_s - begin_s) / LOOK_S);
    let mut closest: Option<(f64, f64)> = None;
    let mut look = 0.0;
    while look <= looks {
        let time_s = begin_s + (end_s - begin_s) * (look / looks);
        look += 1.0;
        let [Some((a, _)), Some((b, _))] = [0, 1].map(|i: usize| tracks.get(i)?.state_at(time_s))
        else {
            break;
        };
        let offset_m = b - a;
        let horizontal_m = libm::hypot(offset_m.x, offset_m.y);
        let is_close = horizontal_m <= CLOSE_M && offset_m.z.abs() <= CLOSE_HEIGHT_M;
        let distance_m = offset_m.length();
        if is_close && closest.is_none_or(|(least_m, _)| distance_m < least_m) {
            closest = Some((distance_m, time_s));
        }
    }
    let (_, closest_s) = closest?;
    let from_s = (closest_s - BEFORE_S).max(begin_s) - GAP_S / 2.0;
    let to_s = (closest_s + AFTER_S).min(end_s) + GAP_S / 2.0;
    let mut aircraft = Vec::from(tracks);
    for track in &mut aircraft {
        let samples = &mut track.samples;
        samples.retain(|sample| (from_s..=to_s).contains(&sample.time_s));
        let is_moving = |sample: &TrackSample| sample.velocity_mps.length() > SLOWEST_MPS;
        if samples.len() < 2 || !samples.iter().all(is_moving) {
            return None;
        }
    }
    Some(Recording {
        aircraft,
        frame: Some(frame),
        ..Recording::default()
    })
}

/// A track in the local frame; the way to the next report gives a missing velocity.
fn local(track: &ReceivedTrack, frame: &LocalFrame) -> Track {
    let positions: Vec<_> = track
        .heard
        .iter()
        .map(|heard| frame.to_local_m(heard.place))
        .collect();
    let between = |from: usize, to: usize| {
        let (a, b) = (track.heard.get(from)?, track.heard.get(to)?);
        Some((*positions.get(to)? - *positions.get(from)?) / (b.time_s - a.time_s))
    };
    let velocity = |index: usize, heard: &Heard| {
        heard
            .velocity_mps
            .map(|own| frame.velocity_mps(heard.place, own))
            .or_else(|| between(index.checked_sub(1)?, index))
            .or_else(|| between(index, index + 1))
            .unwrap_or_default()
    };
    let samples = track
        .heard
        .iter()
        .zip(&positions)
        .enumerate()
        .map(|(index, (heard, position_m))| TrackSample {
            place: Some(heard.place),
            ..TrackSample::new(heard.time_s, *position_m, velocity(index, heard))
        })
        .collect();
    Track {
        name: track.name.clone(),
        samples,
    }
}
