//! Repeats the decisions of a recorded flight from its telemetry log.

use std::io::{self, Read};

use fga_formats::clock::Elapsed;
use serde_json::Value;

use crate::Companion;
use crate::outgoing::OWN_COMPONENT;
use crate::tlog::TlogReader;

/// Time between the inserted ticks, seconds.
const TICK_S: f64 = 0.02;
/// A longer pause in a log is a new flight, seconds: no ticks in it.
const LONGEST_PAUSE_S: f64 = 60.0;

/// The result of a replay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Replayed {
    /// Frames taken.
    pub frames: u64,
    /// Frames that were not understood.
    pub skipped: u64,
}

/// Feeds a telemetry log to a companion and passes each line of its decision log to `line`.
///
/// Skips the messages of the recorded flight's companion; this one's messages go
/// nowhere.
///
/// # Errors
/// An unreadable log, or an error of `line`.
pub fn replay(
    log: impl Read,
    companion: &mut Companion,
    mut line: impl FnMut(&Value) -> io::Result<()>,
) -> io::Result<Replayed> {
    let mut reader = TlogReader::new(log);
    companion.set_recorded();
    let mut replayed = Replayed::default();
    let mut elapsed = Elapsed::default();
    let mut now_s = 0.0_f64;
    while let Some(logged) = reader.next_frame()? {
        let at_s = elapsed.at_s(logged.unix_us);
        if at_s - now_s > LONGEST_PAUSE_S {
            now_s = at_s;
        }
        while now_s + TICK_S < at_s {
            now_s += TICK_S;
            companion.tick(now_s);
            companion.make_ground(now_s);
            drop(companion.outbox());
        }
        now_s = at_s.max(now_s);
        if logged.frame.header.component_id != OWN_COMPONENT {
            replayed.frames += 1;
            companion.receive(&logged.frame.header, &logged.frame.message, now_s);
            companion.make_ground(now_s);
            drop(companion.outbox());
        }
        for entry in companion.take_log() {
            line(&entry)?;
        }
    }
    replayed.skipped = reader.skipped;
    Ok(replayed)
}
