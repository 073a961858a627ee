//! Colours and pieces of a drawn flight.

use crate::flight::{Flight, FlightSample};

/// Red, green, blue of a state: the palette of Okabe and Ito, which people with any colour vision can
/// distinguish.
pub const fn state_color(state: &str) -> [u8; 3] {
    match state.as_bytes() {
        b"cruise" => [0x00, 0x72, 0xB2],
        b"threatened" => [0xE6, 0x9F, 0x00],
        b"avoiding" => [0xD5, 0x5E, 0x00],
        b"recovering" => [0x00, 0x9E, 0x73],
        _ => [0x80, 0x80, 0x80],
    }
}

/// Red, green, blue of obstacles and their volumes.
pub const OBSTACLE_COLOR: [u8; 3] = [0xCC, 0x79, 0xA7];

/// Red, green, blue of zones.
pub(super) const ZONE_COLOR: [u8; 3] = [0x80, 0x80, 0x80];

/// Red, green, blue of the ground.
pub(super) const GROUND_COLOR: [u8; 3] = [0x00, 0x9E, 0x73];

/// Red, green, blue of the mission.
pub const MISSION_COLOR: [u8; 3] = [0x56, 0xB4, 0xE9];

/// The flown track in pieces of one state: each piece begins at the end of the previous one.
pub(super) fn pieces(flight: &Flight, step_s: f64) -> Vec<(&str, Vec<&FlightSample>)> {
    let mut pieces: Vec<(&str, Vec<&FlightSample>)> = Vec::new();
    for sample in flight.thinned(step_s) {
        match pieces.last_mut() {
            Some((state, piece)) if *state == sample.state => piece.push(sample),
            last => {
                let joint = last.and_then(|(_, piece)| piece.last().copied());
                pieces.push((&sample.state, joint.into_iter().chain([sample]).collect()));
            }
        }
    }
    pieces
}
