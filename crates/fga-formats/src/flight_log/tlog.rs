//! Telemetry logs: MAVLink frames, each after the time at which it came, microseconds in 8 bytes.
//!
//! Source: the message set `common` of MAVLink; frames of both versions. Signatures are not checked: a log says
//! what was received.

use core::f64::consts::FRAC_PI_2;
use std::collections::HashMap;

use super::series::{Series, Signals};

const STAMP: usize = 8;
const ATTITUDE: u32 = 30;
const NAV_CONTROLLER_OUTPUT: u32 = 62;
const VFR_HUD: u32 = 74;
/// Below this an airspeed says nothing about a climb angle, metres per second.
const SLOWEST_MPS: f32 = 3.0;
/// Frames that a file of this kind begins with, before the first damaged one.
const TRIED: usize = 8;

/// A frame: which system sent what.
struct Frame<'a> {
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

/// Seed of the checksum and full length of the messages that are read.
const fn known(message: u32) -> Option<(u8, usize)> {
    match message {
        ATTITUDE => Some((39, 28)),
        NAV_CONTROLLER_OUTPUT => Some((183, 26)),
        VFR_HUD => Some((20, 20)),
        _ => None,
    }
}

impl<'a> Frame<'a> {
    /// The frame of a record; `None` where there is none or its checksum is wrong.
    fn of(record: &'a [u8]) -> Option<Self> {
        let frame = record.get(STAMP..)?;
        let size = usize::from(*frame.get(1)?);
        let (head, trailer, system, component, message) = match frame.first()? {
            0xfe => (
                6,
                0,
                *frame.get(3)?,
                *frame.get(4)?,
                u32::from(*frame.get(5)?),
            ),
            0xfd => {
                let message = [*frame.get(7)?, *frame.get(8)?, *frame.get(9)?, 0];
                let trailer = if frame.get(2)? & 1 == 1 { 13 } else { 0 };
                (
                    10,
                    trailer,
                    *frame.get(5)?,
                    *frame.get(6)?,
                    u32::from_le_bytes(message),
                )
            }
            _ => return None,
        };
        let payload = frame.get(head..head + size)?;
        let sum = frame.get(head + size..head + size + 2)?;
        frame.get(..head + size + 2 + trailer)?;
        if let Some((seed, _)) = known(message) {
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

    /// A number of single precision; bytes that were left out are zero.
    fn number(&self, begin: usize) -> f32 {
        let mut bytes = [0; 4];
        for (index, byte) in bytes.iter_mut().enumerate() {
            *byte = self.payload.get(begin + index).copied().unwrap_or(0);
        }
        f32::from_le_bytes(bytes)
    }
}

/// Whether a file is such a log: it begins with frames one after the other.
pub(super) fn is_one(bytes: &[u8]) -> bool {
    let mut at = 0;
    for _ in 0..TRIED {
        let Some(rest) = bytes.get(at..).filter(|rest| !rest.is_empty()) else {
            return at > 0;
        };
        let Some(frame) = Frame::of(rest) else {
            return false;
        };
        at += frame.length;
    }
    true
}

/// The signals of one system.
#[derive(Default)]
struct Heard {
    airspeed: Series,
    command: Series,
    bank: Series,
    course: Series,
    climb: Series,
    attitudes: usize,
}

/// Reads the signals of the aircraft that sent its attitude most often, and skips damaged parts.
pub(super) fn signals(bytes: &[u8]) -> Signals {
    let mut systems: HashMap<(u8, u8), Heard> = HashMap::new();
    let mut at = 0;
    while let Some(rest) = bytes.get(at..).filter(|rest| rest.len() > STAMP) {
        let Some(frame) = Frame::of(rest) else {
            at += 1;
            continue;
        };
        let stamp = rest.get(..STAMP).and_then(|stamp| stamp.try_into().ok());
        #[expect(
            clippy::cast_precision_loss,
            reason = "microseconds since 1970 fit in 53 bits"
        )]
        let time_s = u64::from_be_bytes(stamp.unwrap_or_default()) as f64 * 1e-6;
        if known(frame.message).is_some() {
            let heard = systems.entry((frame.system, frame.component)).or_default();
            match frame.message {
                ATTITUDE => {
                    heard.attitudes += 1;
                    heard.bank.push(time_s, -f64::from(frame.number(4)));
                    heard
                        .course
                        .push(time_s, FRAC_PI_2 - f64::from(frame.number(12)));
                }
                NAV_CONTROLLER_OUTPUT => {
                    heard
                        .command
                        .push(time_s, -f64::from(frame.number(0)).to_radians());
                }
                _ => {
                    let (airspeed, climb) = (frame.number(0), frame.number(12));
                    heard.airspeed.push(time_s, f64::from(airspeed));
                    if airspeed > SLOWEST_MPS {
                        let share = (f64::from(climb) / f64::from(airspeed)).clamp(-1.0, 1.0);
                        heard.climb.push(time_s, libm::asin(share));
                    }
                }
            }
        }
        at += frame.length;
    }
    let most = systems
        .into_iter()
        .max_by_key(|(address, heard)| (heard.attitudes, core::cmp::Reverse(*address)));
    let heard = most.map_or_else(Heard::default, |(_, heard)| heard);
    Signals {
        airspeed_mps: heard.airspeed,
        bank_command_rad: heard.command,
        bank_rad: heard.bank,
        course_rad: heard.course,
        climb_rad: heard.climb,
        sources: [
            "VFR_HUD.airspeed",
            "NAV_CONTROLLER_OUTPUT.nav_roll",
            "ATTITUDE.roll",
            "ATTITUDE.yaw",
            "VFR_HUD.climb",
        ],
    }
}
