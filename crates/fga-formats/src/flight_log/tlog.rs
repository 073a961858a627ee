//! Telemetry logs: MAVLink frames, each after the time at which it came, microseconds in 8 bytes.
//!
//! Source: the message set `common` of MAVLink; frames of both versions. Signatures are not checked: a log says
//! what was received.
//!
//! The eight messages that are read are framed here: the crate `mavlink`, on which the link builds, would bring its whole dialect into
//! every program that reads a file.

use core::f64::consts::FRAC_PI_2;
use std::collections::HashMap;

use super::dataflash::{climb_rad, text};
use super::phases::Word;
use super::series::{Series, Signals};
use crate::clock::Elapsed;
use crate::tally::{LeftOut, Tally};

const STAMP: usize = 8;
const HEARTBEAT: u32 = 0;
const PARAM_VALUE: u32 = 22;
const ATTITUDE: u32 = 30;
const MISSION_CURRENT: u32 = 42;
const NAV_CONTROLLER_OUTPUT: u32 = 62;
const MISSION_ITEM_INT: u32 = 73;
const VFR_HUD: u32 = 74;
const SET_ATTITUDE_TARGET: u32 = 82;
/// `MAV_MODE_FLAG_SAFETY_ARMED`.
const ARMED: u8 = 128;
/// `MAV_AUTOPILOT_ARDUPILOTMEGA`, whose modes have the numbers that are known here.
const ARDUPILOT: u8 = 3;
/// Time that passes when the clock of a log is set, seconds: a gap of every signal.
const SET_S: f64 = 2.0;
/// Frames that a file of this kind begins with, before the first damaged one.
const TRIED: usize = 8;

/// A frame: which system sent what.
struct LogFrame<'a> {
    system: u8,
    component: u8,
    message: u32,
    payload: &'a [u8],
    /// Bytes with the time before it.
    length: usize,
}

/// The checksum of MAVLink: X.25, with the seed of the message at its end.
fn checksum(bytes: &[u8], seed: u8) -> u16 {
    bytes
        .iter()
        .chain(core::iter::once(&seed))
        .fold(0xffff, |crc: u16, byte| {
            let [_, crc_low] = crc.to_be_bytes();
            let mut low = byte ^ crc_low;
            low ^= low << 4;
            (crc >> 8) ^ (u16::from(low) << 8) ^ (u16::from(low) << 3) ^ (u16::from(low) >> 4)
        })
}

/// Seed of the checksum of the messages that are read.
const fn seed(message: u32) -> Option<u8> {
    match message {
        HEARTBEAT => Some(50),
        PARAM_VALUE => Some(220),
        MISSION_CURRENT => Some(28),
        MISSION_ITEM_INT => Some(38),
        SET_ATTITUDE_TARGET => Some(49),
        ATTITUDE => Some(39),
        NAV_CONTROLLER_OUTPUT => Some(183),
        VFR_HUD => Some(20),
        _ => None,
    }
}

impl<'a> LogFrame<'a> {
    /// The frame of a record; `None` without a frame, or with a wrong checksum.
    fn of(record: &'a [u8]) -> Option<Self> {
        let frame = record.get(STAMP..)?;
        let size = usize::from(*frame.get(1)?);
        let byte = |at: usize| frame.get(at).copied();
        let (head, trailer, system, component, message) = match frame.first()? {
            0xfe => (6, 0, byte(3)?, byte(4)?, u32::from(byte(5)?)),
            0xfd => {
                let message = u32::from_le_bytes([byte(7)?, byte(8)?, byte(9)?, 0]);
                let trailer = if byte(2)? & 1 == 1 { 13 } else { 0 };
                (10, trailer, byte(5)?, byte(6)?, message)
            }
            _ => return None,
        };
        let payload = frame.get(head..head + size)?;
        let sum = frame.get(head + size..head + size + 2)?;
        frame.get(..head + size + 2 + trailer)?;
        if let Some(seed) = seed(message) {
            let found = u16::from_le_bytes(sum.try_into().ok()?);
            if checksum(frame.get(1..head + size)?, seed) != found {
                return None;
            }
        }
        Some(Self {
            system,
            component,
            message,
            payload,
            length: STAMP + head + size + 2 + trailer,
        })
    }

    /// A byte; one that was left out is zero.
    fn byte(&self, at: usize) -> u8 {
        self.payload.get(at).copied().unwrap_or(0)
    }

    /// A whole number of two bytes.
    fn short(&self, begin: usize) -> u16 {
        u16::from_le_bytes([self.byte(begin), self.byte(begin + 1)])
    }

    /// Four bytes; those that were left out are zero.
    fn four(&self, begin: usize) -> [u8; 4] {
        [0, 1, 2, 3].map(|at| self.byte(begin + at))
    }

    /// A number of single precision.
    fn number(&self, begin: usize) -> f64 {
        f64::from(f32::from_le_bytes(self.four(begin)))
    }
}

/// Whether a file is such a log: it begins with frames one after the other.
pub(super) fn is_one(bytes: &[u8]) -> bool {
    let mut at = 0;
    for _ in 0..TRIED {
        let Some(rest) = bytes.get(at..).filter(|rest| !rest.is_empty()) else {
            return at > 0;
        };
        let Some(frame) = LogFrame::of(rest) else {
            return false;
        };
        at += frame.length;
    }
    true
}

/// The signals of one system.
#[derive(Default)]
struct SystemSignals {
    signals: Signals,
    attitudes: usize,
}

impl SystemSignals {
    fn take(&mut self, frame: &LogFrame<'_>, time_s: f64, commands: &HashMap<u16, u16>) {
        let signals = &mut self.signals;
        match frame.message {
            ATTITUDE => {
                self.attitudes += 1;
                signals.bank_rad.push(time_s, -frame.number(4));
                let course_rad = FRAC_PI_2 - frame.number(12);
                signals.course_rad.push(time_s, course_rad);
            }
            NAV_CONTROLLER_OUTPUT => {
                let bank_rad = -frame.number(0).to_radians();
                signals.bank_command_rad.push(time_s, bank_rad);
            }
            VFR_HUD => {
                let (airspeed_mps, climb_mps) = (frame.number(0), frame.number(12));
                signals.airspeed_mps.push(time_s, airspeed_mps);
                if let Some(climb_rad) = climb_rad(climb_mps, airspeed_mps) {
                    signals.climb_rad.push(time_s, climb_rad);
                }
            }
            HEARTBEAT if frame.byte(5) == ARDUPILOT => {
                let mode = u32::from_le_bytes(frame.four(0));
                signals.phases.take(time_s, Word::Mode(mode));
                signals
                    .phases
                    .take(time_s, Word::Armed(frame.byte(6) & ARMED != 0));
            }
            MISSION_CURRENT => {
                if let Some(command) = commands.get(&frame.short(0)) {
                    signals
                        .phases
                        .take(time_s, Word::Command(u32::from(*command)));
                }
            }
            PARAM_VALUE => {
                let name: Vec<u8> = (8..24).map(|at| frame.byte(at)).collect();
                signals.limits.take(&text(&name), frame.number(0));
            }
            _ => {}
        }
    }
}

/// Bank of an attitude as a quaternion, radians, positive in a left turn.
pub(super) fn bank_rad([w, x, y, z]: [f64; 4]) -> f64 {
    -libm::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
}

/// Reads the signals of the aircraft that sent its attitude most often, and skips damaged parts.
pub(super) fn signals(bytes: &[u8]) -> Signals {
    let mut systems: HashMap<(u8, u8), SystemSignals> = HashMap::new();
    // What others command to a system, and the commands of its mission.
    let mut commanded: HashMap<u8, Series> = HashMap::new();
    let mut commands: HashMap<u16, u16> = HashMap::new();
    let mut elapsed = Elapsed::with_gaps(SET_S);
    let mut begin_s = None;
    let tally = Tally::walk(bytes, LeftOut::WrongChecksum, |rest| {
        let frame = LogFrame::of(rest)?;
        let stamp = rest.get(..STAMP).and_then(|stamp| stamp.try_into().ok());
        let stamp_us = u64::from_be_bytes(stamp.unwrap_or_default());
        #[expect(
            clippy::cast_precision_loss,
            reason = "microseconds since 1970 fit in 53 bits"
        )]
        let begin_s = *begin_s.get_or_insert(stamp_us as f64 * 1e-6);
        let time_s = begin_s + elapsed.at_s(stamp_us);
        let result = seed(frame.message).map(|_| ()).ok_or(LeftOut::NotNeeded);
        match frame.message {
            SET_ATTITUDE_TARGET => {
                let series = commanded.entry(frame.byte(36)).or_default();
                series.push(time_s, bank_rad([4, 8, 12, 16].map(|at| frame.number(at))));
            }
            MISSION_ITEM_INT => {
                commands.insert(frame.short(28), frame.short(30));
            }
            _ if result.is_ok() => {
                let heard = systems.entry((frame.system, frame.component)).or_default();
                heard.take(&frame, time_s, &commands);
            }
            _ => {}
        }
        Some((frame.length, result))
    });
    let most = systems
        .into_iter()
        .max_by_key(|(address, heard)| (heard.attitudes, core::cmp::Reverse(*address)));
    let ((system, _), SystemSignals { mut signals, .. }) = most.unwrap_or_default();
    // A companion that commands the attitude does so often; the vehicle's own word of it may be slow.
    let mut source = "NAV_CONTROLLER_OUTPUT.nav_roll";
    if signals.bank_rad.is_fast()
        && !signals.bank_command_rad.is_fast()
        && let Some(sent) = commanded.remove(&system)
    {
        (signals.bank_command_rad, source) = (sent, "SET_ATTITUDE_TARGET.q");
    }
    Signals {
        sources: [
            "VFR_HUD.airspeed",
            source,
            "ATTITUDE.roll",
            "ATTITUDE.yaw",
            "VFR_HUD.climb",
        ],
        tally,
        ..signals
    }
}
