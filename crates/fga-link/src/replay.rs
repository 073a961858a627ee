//! Repeats the decisions of a recorded flight from its telemetry log.
//!
//! A log with the flight's steps ([`crate::steps`]) repeats the flight with the same configuration: each message, report and tick comes to
//! the companion in the same order and at the same microsecond. An older log, and one of another program, has no steps: ticks
//! are inserted, decisions fall at other moments, and a decision that comes later than in the flight may meet its consequences.

use alloc::collections::VecDeque;
use std::io::{self, Read};

use fga_formats::clock::Elapsed;
use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, MavCmd, MavMessage};
use serde_json::{Map, Value};

use crate::Companion;
use crate::authority::Authority;
use crate::ground::GroundOrder;
use crate::number::to_u16;
use crate::outgoing::{AUTOPILOT, OWN_COMPONENT};
use crate::steps::Step;
use crate::tlog::{Logged, TlogReader};

/// Time between the inserted ticks, seconds.
const TICK_S: f64 = 0.02;
/// A longer pause in a log is a new flight, seconds: no ticks in it.
const LONGEST_PAUSE_S: f64 = 60.0;
/// A decision of the replay comes this much later than the flight's at most, seconds.
const LATER_S: f64 = 2.0;
/// Frames among which the flight's clock is looked for.
const EARLY_FRAMES: usize = 20_000;

/// The result of a replay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Replayed {
    /// Frames taken.
    pub frames: u64,
    /// Frames that were not understood.
    pub skipped: u64,
    /// Decisions.
    pub decisions: u64,
    /// Whether the log has the flight's steps.
    pub has_steps: bool,
    /// Whether the log has the flight's steps, and the configuration is the flight's: then the decisions should be the flight's.
    pub repeats: bool,
}

/// How many lines differ between the decision logs of a flight and of its replay, and where first; `None` where they are the same.
pub fn differences(flown: &str, repeated: &[String]) -> Option<(usize, String)> {
    let flown: Vec<&str> = flown.lines().collect();
    let most = flown.len().max(repeated.len());
    let lines = (0..most).map(|at| (at + 1, flown.get(at).copied(), repeated.get(at)));
    let mut different = lines.filter(|(_, a, b)| *a != b.map(String::as_str));
    let (number, flown, repeated) = different.next()?;
    let words = match (flown, repeated) {
        (Some(flown), Some(repeated)) => {
            let parsed =
                |line| serde_json::from_str::<Map<String, Value>>(line).unwrap_or_default();
            let (flown, repeated) = (parsed(flown), parsed(repeated));
            let mut keys = flown.keys().chain(repeated.keys());
            let key = keys.find(|key| flown.get(*key) != repeated.get(*key));
            let key = key.map_or("kind", String::as_str);
            let value = |line: &Map<String, Value>| line.get(key).cloned().unwrap_or_default();
            format!(
                "{key} is {} in the flight, {} in the replay",
                value(&flown),
                value(&repeated)
            )
        }
        (Some(_), None) => "the replay has no such line".to_owned(),
        (None, _) => "the flight has no such line".to_owned(),
    };
    Some((1 + different.count(), format!("line {number}: {words}")))
}

/// Feeds a telemetry log to a companion and passes each line of its decision log to `line`.
///
/// Skips the messages of the recorded flight's companion; this one's messages go
/// nowhere.
///
/// # Errors
/// An unreadable log, one with a second flight, or an error of `line`.
pub fn replay(
    log: impl Read,
    companion: &mut Companion,
    mut line: impl FnMut(&Value) -> io::Result<()>,
) -> io::Result<Replayed> {
    let mut reader = TlogReader::new(log);
    let mut replayed = Replayed::default();
    let mut early = VecDeque::new();
    early.extend(reader.next_frame()?);
    let begin = early
        .front()
        .and_then(|first| Some((first.unix_us, step_of(first)?)));
    let mut player = match begin {
        Some((
            begin_us,
            Step::Begin {
                configuration,
                dry_run,
            },
        )) => {
            early.clear();
            replayed.has_steps = true;
            replayed.repeats = configuration == companion.fingerprint();
            companion.set_dry_run(dry_run);
            Player::Steps(StepReplay {
                begin_us,
                is_copy: false,
                order: None,
            })
        }
        _ => Player::Frames(FrameReplay::new(&mut reader, &mut early)?),
    };
    if !replayed.repeats {
        companion.set_recorded();
    }
    while let Some(logged) = match early.pop_front() {
        Some(logged) => Some(logged),
        None => reader.next_frame()?,
    } {
        if matches!(step_of(&logged), Some(Step::Begin { .. })) {
            return Err(io::Error::other(
                "another flight begins in the log, expected the log of one start of the program",
            ));
        }
        replayed.frames += u64::from(match &mut player {
            Player::Steps(steps) => steps.take(&logged, companion),
            Player::Frames(frames) => frames.take(&logged, companion),
        });
        drop(companion.outbox());
        for entry in companion.take_log() {
            replayed.decisions +=
                u64::from(entry.get("kind").is_some_and(|kind| kind == "decision"));
            line(&entry)?;
        }
    }
    replayed.skipped = reader.skipped;
    Ok(replayed)
}

enum Player {
    Steps(StepReplay),
    Frames(FrameReplay),
}

/// The step of a frame of the log.
fn step_of(logged: &Logged) -> Option<Step> {
    let is_ours = logged.frame.header.component_id == OWN_COMPONENT;
    is_ours
        .then(|| Step::of_message(&logged.frame.message))
        .flatten()
}

/// A flight with its steps.
struct StepReplay {
    /// When the flight's clock began, microseconds since 1970.
    begin_us: u64,
    /// The next frame repeats a report for other readers.
    is_copy: bool,
    /// Ground that was ordered in the flight.
    order: Option<GroundOrder>,
}

impl StepReplay {
    /// Takes a frame; whether it is one of the vehicle's or another system's.
    fn take(&mut self, logged: &Logged, companion: &mut Companion) -> bool {
        #[expect(
            clippy::cast_precision_loss,
            reason = "microseconds of a flight are exact for 285 years"
        )]
        let now_s = logged.unix_us.saturating_sub(self.begin_us) as f64 * 1e-6;
        if core::mem::take(&mut self.is_copy) {
            return false;
        }
        match step_of(logged) {
            Some(Step::Tick) => {
                companion.tick(now_s);
                if self.order.is_none() {
                    self.order = companion.ground_order();
                }
            }
            Some(Step::Report(report)) => {
                companion.take_report(&report, now_s);
                self.is_copy = true;
            }
            Some(Step::Feed(status)) => companion.take_feed(status, now_s),
            Some(Step::Ground) => {
                if let Some(order) = self.order.take() {
                    companion.take_ground(order.make(), now_s);
                }
            }
            Some(Step::End { at_once: true }) => companion.shut_down_at_once(now_s),
            Some(Step::End { at_once: false }) => companion.shut_down(now_s),
            Some(Step::Begin { .. }) => {}
            None if logged.frame.header.component_id == OWN_COMPONENT => {}
            None => {
                companion.receive(&logged.frame.header, &logged.frame.message, now_s);
                return true;
            }
        }
        false
    }
}

/// A flight without steps.
struct FrameReplay {
    elapsed: Elapsed,
    /// The flight's clock at the first frame, seconds: the vehicle's answers name times of that clock.
    first_s: f64,
    now_s: f64,
    /// The mode that the flight asked for last, and when, seconds.
    asked: Option<(u32, f64)>,
    /// The mode of the vehicle as the companion knows it.
    mode: u32,
}

impl FrameReplay {
    /// Looks among the first frames for a request of the flight for the vehicle's clock, which has the time of the flight's.
    fn new(reader: &mut TlogReader<impl Read>, early: &mut VecDeque<Logged>) -> io::Result<Self> {
        let mut elapsed = Elapsed::default();
        let mut first_s = 0.0;
        let mut index = 0;
        while index < EARLY_FRAMES {
            if index >= early.len() {
                early.extend(reader.next_frame()?);
            }
            let Some(logged) = early.get(index) else {
                break;
            };
            index += 1;
            let at_s = elapsed.at_s(logged.unix_us);
            if logged.frame.header.component_id == OWN_COMPONENT
                && let MavMessage::TIMESYNC(data) = &logged.frame.message
                && data.tc1 == 0
            {
                #[expect(
                    clippy::cast_precision_loss,
                    reason = "nanoseconds of a flight are exact for 104 days"
                )]
                let sent_s = data.ts1 as f64 * 1e-9;
                first_s = (sent_s - at_s).max(0.0);
                break;
            }
        }
        Ok(Self {
            elapsed: Elapsed::default(),
            first_s,
            now_s: first_s,
            asked: None,
            mode: 0,
        })
    }

    /// A heartbeat that reports the mode which the flight asked for, with the mode before while the companion may be about to ask for
    /// it too: its decision is a little later than the flight's, and would find the mode changed by others.
    fn wait_for_request(&mut self, data: &HEARTBEAT_DATA, companion: &Companion) -> HEARTBEAT_DATA {
        let is_asked = self.asked.is_some_and(|(mode, asked_s)| {
            mode == data.custom_mode && self.now_s - asked_s < LATER_S
        });
        if !(is_asked && companion.authority() == Authority::Ready) {
            self.mode = data.custom_mode;
        }
        HEARTBEAT_DATA {
            custom_mode: self.mode,
            ..data.clone()
        }
    }

    /// Takes a frame, after the ticks before it; whether it is one of the vehicle's or another system's.
    fn take(&mut self, logged: &Logged, companion: &mut Companion) -> bool {
        let at_s = self.first_s + self.elapsed.at_s(logged.unix_us);
        if at_s - self.now_s > LONGEST_PAUSE_S {
            self.now_s = at_s;
        }
        while self.now_s + TICK_S < at_s {
            self.now_s += TICK_S;
            companion.tick(self.now_s);
            companion.make_ground(self.now_s);
            drop(companion.outbox());
        }
        self.now_s = at_s.max(self.now_s);
        let (header, message) = (&logged.frame.header, &logged.frame.message);
        if header.component_id == OWN_COMPONENT {
            if let MavMessage::COMMAND_LONG(data) = message
                && data.command == MavCmd::MAV_CMD_DO_SET_MODE
            {
                let mode = u32::from(to_u16(f64::from(data.param2)));
                self.asked = Some((mode, self.now_s));
            }
            return false;
        }
        match message {
            MavMessage::HEARTBEAT(data) if header.component_id == AUTOPILOT => {
                let heard = self.wait_for_request(data, companion);
                companion.receive(header, &MavMessage::HEARTBEAT(heard), self.now_s);
            }
            _ => companion.receive(header, message, self.now_s),
        }
        companion.make_ground(self.now_s);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_differ_are_counted_and_the_first_is_said() {
        let flown = "{\"t_s\":1.5,\"kind\":\"decision\"}\n{\"t_s\":2.0}\n";
        let repeated: Vec<String> = flown.lines().map(str::to_owned).collect();
        let first = |repeated: &[String]| differences(flown, repeated);
        assert_eq!(first(&repeated), None);
        let other = [repeated[0].replace("1.5", "1.25"), "{}".to_owned()];
        let words = "line 1: t_s is 1.5 in the flight, 1.25 in the replay";
        assert_eq!(first(&other), Some((2, words.to_owned())));
        let shorter = "line 2: the replay has no such line";
        assert_eq!(first(&repeated[..1]), Some((1, shorter.to_owned())));
        let longer = [repeated, other.to_vec()].concat();
        let words = "line 3: the flight has no such line";
        assert_eq!(first(&longer), Some((2, words.to_owned())));
    }
}
