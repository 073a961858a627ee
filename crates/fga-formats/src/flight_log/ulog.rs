//! Logs of PX4 (`ULog`), which describe themselves: `F` messages say what topics hold, `A` messages give them numbers.
//!
//! Every message begins with its length, two bytes, and its kind. Source: the `ULog` file format of the PX4 guide. The crate `px4-ulog`
//! panics on some damaged messages and ends at the first one; it is not used.

use core::f64::consts::FRAC_PI_2;
use std::collections::HashMap;

use super::dataflash::{MessageFormat, climb_rad, width};
use super::phases::{Phases, Word};
use super::series::{Series, Signals};
use super::tlog::bank_rad;
use crate::tally::{LeftOut, Tally};

/// The first bytes of a log.
const BEGIN: &[u8] = b"ULog\x01\x12\x35";
/// With the version and the time.
const HEAD: usize = 16;
/// A message to find the way back after damage, with its length and kind.
const SYNC: &[u8] = b"\x08\0S\x2f\x73\x13\x20\x25\x0c\xbb\x12";
const KINDS: &[u8] = b"BFIMPQADROLCS";
/// Modes of PX4 with the numbers of ArduPlane's that fly alike: altitude, position, mission, hold, return, offboard.
const MODES: [(u32, u32); 6] = [(1, 6), (2, 7), (3, 10), (4, 12), (5, 11), (14, 15)];
/// Any mode of ArduPlane in which a pilot flies.
const MANUAL: u32 = 0;
/// Kinds of setpoints with commands of a mission: a take-off, a landing; others are waypoints.
const COMMANDS: [(f64, u32); 2] = [(3.0, 22), (4.0, 21)];

/// Whether a file is such a log.
pub(crate) fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(BEGIN)
}

/// Types of fields with the codes of `dataflash`.
const TYPES: &str = "int8_t b,uint8_t B,bool B,char B,int16_t h,uint16_t H,int32_t i,uint32_t I,int64_t q,uint64_t Q,float f,double d";

/// Adds what the formats of a log say of a topic to one; topics in it are at most two deep.
fn add(
    format: &mut MessageFormat,
    (topic, prefix, depth): (&str, &str, usize),
    formats: &HashMap<&str, &str>,
) -> Option<()> {
    for field in formats.get(topic)?.split_terminator(';') {
        let (kind, name) = field.split_once(' ')?;
        let (kind, count) = match kind.split_once('[') {
            Some((kind, count)) => (kind, Some(count.strip_suffix(']')?.parse::<u8>().ok()?)),
            None => (kind, None),
        };
        let code_of = |known: &str| known.strip_prefix(kind)?.strip_prefix(' ')?.bytes().next();
        let code = TYPES.split(',').find_map(code_of);
        for index in 0..count.unwrap_or(1) {
            let index = count.map_or_else(String::new, |_| format!("[{index}]"));
            let name = format!("{prefix}{name}{index}");
            if let Some(code) = code {
                format.fields.push((name, code, format.length));
                format.length += width(code)?;
            } else {
                let prefix = format!("{name}.");
                (depth < 2).then(|| add(format, (kind, &prefix, depth + 1), formats))??;
            }
        }
    }
    Some(())
}

/// What the formats of a log say of a topic; its number comes first.
fn format_of(topic: &str, formats: &HashMap<&str, &str>) -> Option<MessageFormat> {
    let mut format = MessageFormat {
        length: 2,
        name: topic.to_owned(),
        fields: Vec::new(),
    };
    add(&mut format, (topic, "", 0), formats).map(|()| format)
}

/// Signals that several topics may hold.
#[derive(Default)]
struct Topics {
    signals: Signals,
    airspeed_mps: [Series; 2],
    descent_mps: Series,
}

impl Topics {
    /// Takes a message; `None` if it lacks a field.
    fn take(&mut self, format: &MessageFormat, message: &[u8]) -> Option<Result<(), LeftOut>> {
        let field = |name: &str| format.number(message, name);
        let time_s = 1e-6 * field("timestamp")?;
        let turn = |name: &str| {
            let [w, x, y, z] = [0, 1, 2, 3].map(|index| field(&format!("{name}[{index}]")));
            Some([w?, x?, y?, z?])
        };
        let phases: &mut Phases = &mut self.signals.phases;
        match format.name.as_str() {
            "vehicle_attitude" => {
                let turn = turn("q")?;
                let [w, x, y, z] = turn;
                let yaw_rad = libm::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
                self.signals.bank_rad.push(time_s, bank_rad(turn));
                self.signals.course_rad.push(time_s, FRAC_PI_2 - yaw_rad);
            }
            "vehicle_attitude_setpoint" => {
                let roll_rad = field("roll_body").filter(|roll_rad| roll_rad.is_finite());
                let command_rad = roll_rad.map(|roll_rad| -roll_rad);
                let command_rad = command_rad.or_else(|| turn("q_d").map(bank_rad))?;
                self.signals.bank_command_rad.push(time_s, command_rad);
            }
            "airspeed_validated" => self.airspeed_mps[0].push(time_s, field("true_airspeed_m_s")?),
            "airspeed" => self.airspeed_mps[1].push(time_s, field("true_airspeed_m_s")?),
            "vehicle_local_position" => self.descent_mps.push(time_s, field("vz")?),
            "vehicle_status" => {
                let is_hovering = field("vehicle_type").or_else(|| field("is_rotary_wing"));
                let is_hovering = is_hovering == Some(1.0);
                let state = field("nav_state")?;
                let mode = MODES.iter().find(|(theirs, _)| f64::from(*theirs) == state);
                let mode = mode
                    .filter(|_| !is_hovering)
                    .map_or(MANUAL, |(_, mode)| *mode);
                phases.take(time_s, Word::Mode(mode));
                phases.take(time_s, Word::Armed(field("arming_state")? == 2.0));
            }
            "position_setpoint_triplet" => {
                let kind = field("current.type")?;
                let command = COMMANDS.iter().find(|(theirs, _)| *theirs == kind);
                phases.take(
                    time_s,
                    Word::Command(command.map_or(16, |(_, command)| *command)),
                );
            }
            _ => return Some(Err(LeftOut::NotNeeded)),
        }
        Some(Ok(()))
    }
}

/// The kind and the content of the message at the beginning of some bytes; `None` without a whole message of a known kind.
fn message_of(rest: &[u8]) -> Option<(u8, &[u8])> {
    let (head, rest) = rest.split_first_chunk::<3>()?;
    let [low, high, kind] = *head;
    let content = rest.get(..usize::from(u16::from_le_bytes([low, high])))?;
    KINDS.contains(&kind).then_some((kind, content))
}

/// A parameter's name and value.
fn parameter(content: &[u8]) -> Option<(&str, f64)> {
    let (length, rest) = content.split_first()?;
    let (key, value) = rest.split_at_checked(usize::from(*length))?;
    let (kind, name) = str::from_utf8(key).ok()?.split_once(' ')?;
    let value = *value.first_chunk::<4>()?;
    let value = match kind {
        "float" => f64::from(f32::from_le_bytes(value)),
        _ => f64::from(i32::from_le_bytes(value)),
    };
    Some((name, value))
}

/// What a message says that is read.
pub(crate) enum Said<'a> {
    /// A message of a topic, as its format has it.
    Topic(&'a MessageFormat, &'a [u8]),
    Parameter(&'a str, f64),
}

/// Reads the messages of a log and skips damaged parts. Topics are those of the first sensor or estimator each.
pub(crate) fn read(
    bytes: &[u8],
    mut take: impl FnMut(Said<'_>) -> Option<Result<(), LeftOut>>,
) -> Tally {
    let mut formats: HashMap<&str, &str> = HashMap::new();
    let mut numbered: HashMap<[u8; 2], Option<MessageFormat>> = HashMap::new();
    let mut tally = Tally::default();
    let mut at = HEAD;
    while let Some(rest) = bytes.get(at..).filter(|rest| !rest.is_empty()) {
        let Some((kind, content)) = message_of(rest) else {
            // The bytes up to the next message that says where one begins are one part.
            let next = rest.windows(SYNC.len()).position(|part| part == SYNC);
            tally.leave_out(next.map_or(LeftOut::CutShort, |_| LeftOut::UnknownKind));
            at += next.unwrap_or(rest.len());
            continue;
        };
        at += 3 + content.len();
        let taken = match kind {
            b'F' => (|| {
                let (name, fields) = str::from_utf8(content).ok()?.split_once(':')?;
                formats.insert(name, fields);
                Some(Ok(()))
            })(),
            b'A' => (|| {
                let ([instance, low, high], name) = content.split_first_chunk::<3>()?;
                let format = format_of(str::from_utf8(name).ok()?, &formats);
                // Other instances are of other sensors and estimators.
                numbered.insert([*low, *high], format.filter(|_| *instance == 0));
                Some(Ok(()))
            })(),
            b'D' => (|| {
                let format = numbered.get(content.first_chunk::<2>()?)?;
                match format {
                    Some(format) => take(Said::Topic(format, content)),
                    None => Some(Err(LeftOut::NotNeeded)),
                }
            })(),
            b'P' => parameter(content).and_then(|(name, value)| take(Said::Parameter(name, value))),
            _ => Some(Err(LeftOut::NotNeeded)),
        };
        tally.take(&taken.unwrap_or(Err(LeftOut::UnreadableField)));
    }
    tally
}

/// The signals of a log.
pub(super) fn signals(bytes: &[u8]) -> Signals {
    let mut topics = Topics::default();
    let tally = read(bytes, |said| match said {
        Said::Topic(format, message) => topics.take(format, message),
        Said::Parameter(name, value) => {
            topics.signals.limits.take(name, value);
            Some(Ok(()))
        }
    });
    let [validated, measured] = topics.airspeed_mps;
    let airspeed_mps = if validated.is_empty() {
        measured
    } else {
        validated
    };
    let climb_rad = topics
        .descent_mps
        .over(&airspeed_mps, |descent_mps, airspeed_mps| {
            climb_rad(-descent_mps, airspeed_mps)
        });
    Signals {
        airspeed_mps,
        climb_rad,
        sources: [
            "airspeed_validated.true_airspeed_m_s or airspeed's",
            "vehicle_attitude_setpoint.roll_body or q_d",
            "vehicle_attitude.q",
            "vehicle_attitude.q",
            "vehicle_local_position.vz",
        ],
        tally,
        ..topics.signals
    }
}
