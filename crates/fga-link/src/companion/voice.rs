//! What the companion says: messages, texts to the operator, lines of its log.

use mavlink::dialects::ardupilotmega::MavMessage;
use serde_json::{Value, json};

use crate::authority::Severity;
use crate::outgoing::{Outbox, Outgoing};
use crate::telling;

/// Most log lines in the queue.
const MOST_LOG_LINES: usize = 4096;

/// What waits to be sent and to be written.
#[derive(Debug, Default)]
pub(super) struct Voice {
    /// The time now, seconds.
    now_s: f64,
    system: u8,
    outbox: Outbox,
    log: Vec<Value>,
    /// The last trouble of the surrounding program.
    trouble: String,
    /// Texts sent.
    texts: u32,
}

impl Voice {
    /// Speaks to a vehicle, and under its system id.
    pub(super) fn speak_to(&mut self, system: u8) {
        self.system = system;
        self.outbox.set_own_system(system);
    }

    /// System id of the vehicle.
    pub(super) const fn system(&self) -> u8 {
        self.system
    }

    /// From here on it is this time, seconds.
    pub(super) const fn at(&mut self, now_s: f64) -> &mut Self {
        self.now_s = now_s;
        self
    }

    /// The time now, seconds.
    pub(super) const fn now_s(&self) -> f64 {
        self.now_s
    }

    /// Sends a message.
    pub(super) fn send(&mut self, message: MavMessage) {
        self.outbox.send(message);
    }

    /// Where others put their messages.
    pub(super) const fn outbox(&mut self) -> &mut Outbox {
        &mut self.outbox
    }

    /// Tells the operator, and the log.
    pub(super) fn tell(&mut self, severity: Severity, words: &str) {
        self.texts += 1;
        self.outbox.send(telling::text(severity, words));
        let content = json!({ "severity": format!("{severity:?}"), "text": words });
        self.note("text", content);
    }

    /// Warns the operator.
    pub(super) fn warn(&mut self, words: &str) {
        self.tell(Severity::Warning, words);
    }

    /// Tells of trouble of the surrounding program.
    pub(super) fn tell_trouble(&mut self, words: &str) {
        words.clone_into(&mut self.trouble);
        self.warn(words);
    }

    /// The last trouble of the surrounding program; empty without one.
    pub(super) fn trouble(&self) -> &str {
        &self.trouble
    }

    /// Tells the log alone.
    pub(super) fn note(&mut self, kind: &str, content: Value) {
        let mut line = json!({ "kind": kind, "t_s": (self.now_s * 1e3).round() / 1e3 });
        if let (Some(line), Value::Object(content)) = (line.as_object_mut(), content) {
            line.extend(content);
        }
        self.log(line);
    }

    /// Adds a line to the log.
    pub(super) fn log(&mut self, line: Value) {
        if self.log.len() < MOST_LOG_LINES {
            self.log.push(line);
        }
    }

    /// Number of texts so far.
    pub(super) const fn texts(&self) -> u32 {
        self.texts
    }

    /// The messages to send, oldest first.
    pub(super) fn take_messages(&mut self) -> Vec<Outgoing> {
        self.outbox.take()
    }

    /// Lines of the log since the last call.
    pub(super) fn take_log(&mut self) -> Vec<Value> {
        core::mem::take(&mut self.log)
    }
}
