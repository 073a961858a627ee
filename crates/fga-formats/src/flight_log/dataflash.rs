//! Dataflash logs of ArduPilot, which describe themselves: `FMT` messages say what the others hold.
//!
//! Every message begins with A3 95 and its kind. Source: the `LogStructure` of ArduPilot.

use core::f64::consts::{FRAC_PI_2, PI};
use std::collections::HashMap;

use super::phases::{Limits, Phases, Word};
use super::series::{Series, Signals};
use crate::number::count;
use crate::tally::{LeftOut, Tally};

const HEAD: [u8; 2] = [0xa3, 0x95];
const FORMAT_KIND: u8 = 128;
const FORMAT_LENGTH: usize = 89;
/// Below this an airspeed says nothing about a climb angle, metres per second.
const SLOWEST_MPS: f64 = 3.0;

/// The climb angle, radians, at a climb rate and an airspeed.
pub(super) fn climb_rad(climb_mps: f64, airspeed_mps: f64) -> Option<f64> {
    (airspeed_mps > SLOWEST_MPS).then(|| libm::asin((climb_mps / airspeed_mps).clamp(-1.0, 1.0)))
}

/// Whether a file is such a log.
pub(super) fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(&HEAD)
}

/// One kind of message.
#[derive(Debug)]
pub(crate) struct MessageFormat {
    pub(super) length: usize,
    pub(crate) name: String,
    /// Names of the fields, the codes of their types, and where they begin in a message.
    pub(super) fields: Vec<(String, u8, usize)>,
}

/// The text up to the first byte that is 0.
pub(super) fn text(bytes: &[u8]) -> String {
    let part = bytes.split(|byte| *byte == 0).next();
    String::from_utf8_lossy(part.unwrap_or_default()).into_owned()
}

/// Bytes that a field of a type takes.
pub(super) const fn width(code: u8) -> Option<usize> {
    Some(match code {
        b'b' | b'B' | b'M' => 1,
        b'h' | b'H' | b'c' | b'C' | b'g' => 2,
        b'i' | b'I' | b'f' | b'n' | b'e' | b'E' | b'L' => 4,
        b'd' | b'q' | b'Q' => 8,
        b'N' => 16,
        b'a' | b'Z' => 64,
        _ => return None,
    })
}

impl MessageFormat {
    fn of(message: &[u8]) -> Option<(u8, Self)> {
        let kind = *message.get(3)?;
        let length = usize::from(*message.get(4)?);
        let codes = message.get(9..25)?;
        let labels = text(message.get(25..FORMAT_LENGTH)?);
        let mut fields = Vec::new();
        let mut begin = 3;
        for (code, label) in codes
            .iter()
            .take_while(|code| **code != 0)
            .zip(labels.split(','))
        {
            fields.push((label.to_owned(), *code, begin));
            begin += width(*code)?;
        }
        let name = text(message.get(5..9).unwrap_or_default());
        let format = Self {
            length,
            name,
            fields,
        };
        (begin <= length).then_some((kind, format))
    }

    /// A field as a text.
    fn text(&self, message: &[u8], name: &str) -> Option<String> {
        let (_, code, begin) = self.fields.iter().find(|(label, ..)| label == name)?;
        let end = begin + width(*code)?;
        matches!(code, b'n' | b'N' | b'Z')
            .then(|| text(message.get(*begin..end).unwrap_or_default()))
    }

    /// A field as a number.
    pub(crate) fn number(&self, message: &[u8], name: &str) -> Option<f64> {
        fn bytes<const N: usize>(message: &[u8], begin: usize) -> Option<[u8; N]> {
            message.get(begin..begin + N)?.try_into().ok()
        }
        let (_, code, begin) = self.fields.iter().find(|(label, ..)| label == name)?;
        let begin = *begin;
        Some(match code {
            b'b' => f64::from(i8::from_le_bytes(bytes(message, begin)?)),
            b'B' | b'M' => f64::from(u8::from_le_bytes(bytes(message, begin)?)),
            b'h' => f64::from(i16::from_le_bytes(bytes(message, begin)?)),
            b'H' => f64::from(u16::from_le_bytes(bytes(message, begin)?)),
            b'c' => f64::from(i16::from_le_bytes(bytes(message, begin)?)) / 100.0,
            b'C' => f64::from(u16::from_le_bytes(bytes(message, begin)?)) / 100.0,
            b'i' => f64::from(i32::from_le_bytes(bytes(message, begin)?)),
            b'I' => f64::from(u32::from_le_bytes(bytes(message, begin)?)),
            b'e' => f64::from(i32::from_le_bytes(bytes(message, begin)?)) / 100.0,
            b'E' => f64::from(u32::from_le_bytes(bytes(message, begin)?)) / 100.0,
            b'f' => f64::from(f32::from_le_bytes(bytes(message, begin)?)),
            b'd' => f64::from_le_bytes(bytes(message, begin)?),
            #[expect(clippy::cast_precision_loss, reason = "microseconds of a flight")]
            b'Q' => u64::from_le_bytes(bytes(message, begin)?) as f64,
            #[expect(clippy::cast_precision_loss, reason = "microseconds of a flight")]
            b'q' => i64::from_le_bytes(bytes(message, begin)?) as f64,
            _ => return None,
        })
    }
}

/// Signals that several messages may hold: the first of them that is there is taken.
#[derive(Default)]
struct Choices {
    attitude: [Series; 3],
    airspeed: [Series; 2],
    descent: [Series; 2],
    /// Whether the airspeed sensor is not used or not healthy at times.
    is_unused: bool,
    phases: Phases,
    limits: Limits,
    /// The airspeed sensor and the lane of the filter that the vehicle uses.
    primary: [f64; 2],
    /// Commands of the mission with their times, if no message names those that begin.
    commands: Vec<(f64, u32)>,
    names_begun: bool,
}

/// Commands within this time of one another are a listing of the mission, seconds.
const LISTING_S: f64 = 0.2;

/// A mode or a command that a field holds; they are small, others name nothing.
fn whole(value: f64) -> u32 {
    u32::try_from(count(value)).unwrap_or(u32::MAX)
}

impl Choices {
    /// Takes a message; `None` if it lacks a field.
    fn take(&mut self, format: &MessageFormat, message: &[u8]) -> Option<Result<(), LeftOut>> {
        let field = |name: &str| format.number(message, name);
        // The instance of sensors and filters that the vehicle uses, where there are several: 0 until the log says otherwise.
        let [sensor, lane] = self.primary;
        let instance = ["I", "C", "Instance"].iter().find_map(|name| field(name));
        let is_used = |primary: f64| instance.is_none_or(|instance| instance == primary);
        let time_s = || field("TimeUS").map(|time_us| time_us * 1e-6);
        match format.name.as_str() {
            "ATT" => {
                let time_s = time_s()?;
                let [command, bank, course] = &mut self.attitude;
                command.push(time_s, -field("DesRoll")? * PI / 180.0);
                bank.push(time_s, -field("Roll")? * PI / 180.0);
                course.push(time_s, FRAC_PI_2 - field("Yaw")? * PI / 180.0);
            }
            // A sensor that is not used or not healthy measures nothing.
            "ARSP" if !is_used(field("Pri").unwrap_or(sensor)) => {
                return Some(Err(LeftOut::NotNeeded));
            }
            "ARSP" if field("U") == Some(0.0) || field("H") == Some(0.0) => {
                self.is_unused = true;
            }
            "ARSP" => self.airspeed[0].push(time_s()?, field("Airspeed")?),
            "MODE" => {
                let mode = field("ModeNum").or_else(|| field("Mode"))?;
                self.phases.take(time_s()?, Word::Mode(whole(mode)));
            }
            "ARM" => self
                .phases
                .take(time_s()?, Word::Armed(field("ArmState")? != 0.0)),
            "MISE" => {
                self.names_begun = true;
                self.phases
                    .take(time_s()?, Word::Command(whole(field("CId")?)));
            }
            "CMD" => self.commands.push((time_s()?, whole(field("CId")?))),
            "PARM" => {
                let (name, value) = (format.text(message, "Name")?, field("Value")?);
                if name == "ARSPD_PRIMARY" {
                    self.primary[0] = value;
                }
                self.limits.take(&name, value);
            }
            "XKF4" | "NKF4" => self.primary[1] = field("PI").unwrap_or(lane),
            "CTUN" => {
                let airspeed = field("As").or_else(|| field("Aspd"))?;
                self.airspeed[1].push(time_s()?, airspeed);
            }
            "XKF1" if is_used(lane) => self.descent[0].push(time_s()?, field("VD")?),
            "NKF1" if is_used(lane) => self.descent[1].push(time_s()?, field("VD")?),
            _ => return Some(Err(LeftOut::NotNeeded)),
        }
        Some(Ok(()))
    }

    /// The phases in order of time, with the commands of older logs, in which a command that begins stands alone.
    fn phases_of_all(&self) -> Phases {
        let apart = |a: usize, b: usize| {
            let pair = self.commands.get(a).zip(self.commands.get(b));
            pair.is_none_or(|(a, b)| (a.0 - b.0).abs() > LISTING_S)
        };
        let begun = self.commands.iter().enumerate();
        let begun = begun
            .filter(|_| !self.names_begun)
            .filter(|(index, _)| apart(*index, index + 1) && apart(index.wrapping_sub(1), *index))
            .map(|(_, command)| *command);
        self.phases.with_commands(begun)
    }
}

/// The message at the beginning of some bytes and its kind; `None` without a whole message of a known kind.
fn message_of<'a>(rest: &'a [u8], formats: &HashMap<u8, MessageFormat>) -> Option<(u8, &'a [u8])> {
    let kind = *rest.get(2).filter(|_| rest.starts_with(&HEAD))?;
    let length = if kind == FORMAT_KIND {
        MessageFormat::of(rest.get(..FORMAT_LENGTH)?)?;
        FORMAT_LENGTH
    } else {
        formats.get(&kind)?.length
    };
    // A shorter length would end nowhere.
    Some((kind, rest.get(..length.max(HEAD.len() + 1))?))
}

/// Reads the signals of a log and skips damaged parts.
pub(super) fn signals(bytes: &[u8]) -> Signals {
    let mut formats: HashMap<u8, MessageFormat> = HashMap::new();
    let mut choices = Choices::default();
    let tally = Tally::walk(bytes, LeftOut::UnknownKind, |rest| {
        let (kind, message) = message_of(rest, &formats)?;
        let taken = if kind == FORMAT_KIND {
            let described = MessageFormat::of(message);
            formats.extend(described);
            Some(Ok(()))
        } else {
            choices.take(formats.get(&kind)?, message)
        };
        Some((
            message.len(),
            taken.unwrap_or(Err(LeftOut::UnreadableField)),
        ))
    });
    let first = |choices: [Series; 2]| {
        let [first, second] = choices;
        if first.is_empty() { second } else { first }
    };
    let phases = choices.phases_of_all();
    let limits = choices.limits;
    let [bank_command_rad, bank_rad, course_rad] = choices.attitude;
    let [measured, estimated] = &choices.airspeed;
    // Without a sensor the estimate moves with the wind and the ground speed, once the aircraft flies.
    let constant_mps = estimated
        .constant()
        .filter(|_| choices.is_unused && measured.is_empty());
    let never_flies = constant_mps.map(|constant_mps| {
        format!(
            "its airspeed sensor is not used or not healthy (ARSP.U, ARSP.H), and the estimate CTUN.As is {constant_mps:.1} \
             m/s all the time"
        )
    });
    let airspeed_mps = first(choices.airspeed);
    let climb_rad = first(choices.descent).over(&airspeed_mps, |descent_mps, airspeed_mps| {
        climb_rad(-descent_mps, airspeed_mps)
    });
    Signals {
        airspeed_mps,
        bank_command_rad,
        bank_rad,
        course_rad,
        climb_rad,
        never_flies,
        phases,
        limits,
        sources: [
            "ARSP.Airspeed or CTUN.As",
            "ATT.DesRoll",
            "ATT.Roll",
            "ATT.Yaw",
            "XKF1.VD or NKF1.VD",
        ],
        tally,
    }
}
