//! Other vehicles on the link.
//!
//! The companion belongs to one aircraft. Without `vehicle.system_id` it takes the first plane that it hears. If it hears two planes
//! before it has ever been ready, nothing shows which plane carries it, and it takes neither.

use fga::Vec3;
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{GLOBAL_POSITION_INT_DATA, HEARTBEAT_DATA, MavAutopilot};

use fga_formats::geodesy::LocalFrame;

use super::voice::Voice;
use crate::number::flown;
use crate::outgoing::AUTOPILOT;

/// Without an id in the configuration the companion listens for this long for a second vehicle, seconds: each sends its heartbeat
/// once a second.
const LISTENS_S: f64 = 1.5;
/// A vehicle that was not heard for this long is gone, seconds.
const GONE_S: f64 = 5.0;
/// The companion reports a vehicle that it cannot fly after hearing it alone for this long, seconds.
const ALONE_S: f64 = 8.0;

/// This many signs of a second sender within this time count, seconds: each message of the other one gives one. …
const SIGNS: usize = 12;
const SIGNS_S: f64 = 2.0;
/// … They hold for this long, seconds.
const SIGNS_HOLD_S: f64 = 3.0;
/// Signs: the clock falls back by more than this, seconds; …
const CLOCK_BACK_S: f64 = 3.0;
/// … the place differs from the one expected from the message before, within this time, by more than this; seconds and metres.
const SAME_FLIGHT_S: f64 = 1.0;
const ELSEWHERE_M: f64 = 40.0;

/// Signs of two vehicles under one id: their clocks and their places alternate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Senders {
    boot_ms: Option<u32>,
    place: Option<(u32, Vec3, Vec3)>,
    signs_s: [f64; SIGNS],
    doubted_s: f64,
}

impl Default for Senders {
    fn default() -> Self {
        Self {
            boot_ms: None,
            place: None,
            signs_s: [f64::NEG_INFINITY; SIGNS],
            doubted_s: f64::NEG_INFINITY,
        }
    }
}

impl Senders {
    /// Whether two vehicles send under one id.
    pub(super) fn are_two(&self, now_s: f64) -> bool {
        now_s - self.doubted_s < SIGNS_HOLD_S
    }

    /// Takes the time since boot of an attitude.
    pub(super) fn stamp(&mut self, boot_ms: u32, now_s: f64) {
        let Some(last_ms) = self.boot_ms.replace(boot_ms) else {
            return;
        };
        if signed_s(boot_ms, last_ms) < -CLOCK_BACK_S {
            self.sign(now_s);
        }
    }

    /// Takes a place and a velocity.
    pub(super) fn take_position(
        &mut self,
        data: &GLOBAL_POSITION_INT_DATA,
        frame: &LocalFrame,
        now_s: f64,
    ) {
        let Some((place, velocity_mps)) = flown(data) else {
            return;
        };
        let at_m = frame.to_local_m(place);
        let stood = self.place.replace((data.time_boot_ms, at_m, velocity_mps));
        let Some((last_ms, last_m, last_mps)) = stood else {
            return;
        };
        let passed_s = signed_s(data.time_boot_ms, last_ms);
        let off_m = at_m - last_m - (last_mps + velocity_mps) * (0.5 * passed_s);
        if passed_s.abs() < SAME_FLIGHT_S && off_m.length() > ELSEWHERE_M {
            self.sign(now_s);
        }
    }

    fn sign(&mut self, now_s: f64) {
        self.signs_s.rotate_left(1);
        if let Some(newest_s) = self.signs_s.last_mut() {
            *newest_s = now_s;
        }
        let oldest_s = self.signs_s.first().copied();
        if oldest_s.is_some_and(|oldest_s| now_s - oldest_s <= SIGNS_S) {
            self.doubted_s = now_s;
        }
    }
}

/// From one count of milliseconds to another, which may have overflowed between, seconds.
fn signed_s(to_ms: u32, from_ms: u32) -> f64 {
    f64::from(to_ms.wrapping_sub(from_ms).cast_signed()) * 1e-3
}

/// The vehicles that are not ours.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Neighbors {
    /// When another plane was last heard, seconds.
    plane_s: Option<f64>,
    told: bool,
    /// Whether the companion has been ready: then it belongs to the vehicle of that time.
    chosen: bool,
    /// An autopilot that is no ArduPlane, heard before any plane: its system id, and since when, seconds.
    stranger: Option<(u8, f64)>,
    stranger_told: bool,
    /// A sender of MAVLink 1, heard before any plane.
    version1: Option<u8>,
    /// A plane that is not the configured one.
    other: Option<u8>,
}

impl Neighbors {
    /// Whether a second vehicle may still be heard; `since_s` is the first heartbeat of ours.
    pub(super) fn may_come(&self, since_s: f64, now_s: f64) -> bool {
        !self.chosen && now_s - since_s < LISTENS_S
    }

    /// Whether nothing shows which vehicle is meant.
    pub(super) fn is_ambiguous(&self, now_s: f64) -> bool {
        !self.chosen && self.plane_s.is_some_and(|at_s| now_s - at_s < GONE_S)
    }

    /// From now on the vehicle is known.
    pub(super) const fn choose(&mut self) {
        self.chosen = true;
    }

    /// What is heard instead of a vehicle, in words.
    pub(super) fn instead(&self) -> Option<String> {
        if let Some((system, _)) = self.stranger {
            return Some(format!("{system} is no ArduPlane"));
        }
        if let Some(system) = self.version1 {
            return Some(format!("{system} sends MAVLink 1, expected MAVLink 2"));
        }
        self.other
            .map(|system| format!("{system} is heard, expected vehicle.system_id"))
    }

    /// A plane that is not the configured one was heard.
    pub(super) const fn hear_other(&mut self, system: u8) {
        self.other = Some(system);
    }

    /// A system sends MAVLink 1.
    pub(super) fn hear_version1(&mut self, system: u8, voice: &mut Voice) {
        if self.version1.replace(system).is_none() {
            voice.warn(&format!(
                "fga: {system} sends MAVLink 1, expected MAVLink 2"
            ));
        }
    }

    /// Another plane was heard.
    pub(super) fn hear_plane(&mut self, system: u8, voice: &mut Voice) {
        let now_s = voice.now_s();
        self.plane_s = Some(now_s);
        if self.chosen && !core::mem::replace(&mut self.told, true) {
            voice.warn(&format!("fga: another vehicle on the link: {system}"));
        }
    }

    /// A heartbeat that is not a plane's, before the first one of a plane.
    pub(super) fn hear_stranger(
        &mut self,
        header: MavHeader,
        data: &HEARTBEAT_DATA,
        wanted: Option<u8>,
        voice: &mut Voice,
    ) {
        let now_s = voice.now_s();
        let flies = data.autopilot != MavAutopilot::MAV_AUTOPILOT_INVALID;
        let Ok(system) = u8::try_from(header.system_id) else {
            return;
        };
        let other = wanted.is_some_and(|wanted| wanted != system);
        if !flies || other || header.component_id != AUTOPILOT {
            return;
        }
        let (first, since_s) = *self.stranger.get_or_insert((system, now_s));
        if now_s - since_s >= ALONE_S && !core::mem::replace(&mut self.stranger_told, true) {
            voice.warn(&format!("fga: not ready: vehicle {first} is no ArduPlane"));
        }
    }
}
