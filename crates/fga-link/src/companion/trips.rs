//! How long does the link take, to the vehicle and back?
//!
//! The vehicle answers requests for its clock. Its state is dated as if the fastest message had taken no time, so a command
//! acts on that state a whole round trip later: the round trip is part of the dead time.

use mavlink::dialects::ardupilotmega::{MavMessage, TIMESYNC_DATA};

use crate::outgoing::{AUTOPILOT, OWN_COMPONENT};

/// Interval of requests for a round trip of the vehicle's clock, shorter while telemetry is late, seconds.
const ROUND_TRIP_S: f64 = 1.0;
const LATE_ROUND_TRIP_S: f64 = 0.2;
/// Telemetry is late when it is older than this, seconds.
const LATE_S: f64 = 0.3;
/// A slower answer says nothing of the vehicle's clock, seconds.
const LONGEST_TRIP_S: f64 = 5.0;
/// A slower answer is not ours, seconds.
const LONGEST_QUEUE_S: f64 = 30.0;
/// Number of round trips; the middle one counts.
const KEPT: usize = 5;
/// A longer round trip lets no manoeuvre be followed, seconds: half of the time after which a bank that does not come is a
/// fault ([`crate::config::SafetyConfig::follow_time_s`]) …
const LONGEST_S: f64 = 1.5;
/// … and it is short enough again below this, seconds.
const SHORT_AGAIN_S: f64 = 1.2;
/// This much of a round trip is part of the configured or estimated dead time, seconds.
const ORDINARY_S: f64 = 0.3;
/// Requests are lost now and then: only after this long without an answer the link is late for that, seconds.
const LOST_S: f64 = 3.0;

/// The round trip of an answer: the time of the request, and the reading of the vehicle's clock;
/// seconds. `None` for the answer to somebody else.
pub(crate) fn round_trip_of(data: &TIMESYNC_DATA, now_s: f64) -> Option<(f64, f64)> {
    answer_of(data, now_s, LONGEST_TRIP_S)
}

/// The same for an answer after at most `longest_s` seconds.
fn answer_of(data: &TIMESYNC_DATA, now_s: f64, longest_s: f64) -> Option<(f64, f64)> {
    #[expect(
        clippy::cast_precision_loss,
        reason = "nanoseconds of a flight are exact for 104 days"
    )]
    let seconds = |nanoseconds: i64| nanoseconds as f64 * 1e-9;
    let for_us = data.target_component == OWN_COMPONENT || data.target_component == 0;
    let sent_s = seconds(data.ts1);
    let plausible = data.tc1 > 0 && (now_s - longest_s..=now_s).contains(&sent_s);
    (for_us && plausible).then(|| (sent_s, seconds(data.tc1)))
}

/// The last round trips.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Trips {
    /// When the next request is due, seconds.
    due_s: f64,
    kept_s: [Option<f64>; KEPT],
    next: usize,
    /// When the newest answered request was sent, seconds.
    answered_s: Option<f64>,
    late: bool,
}

impl Trips {
    /// The request for what the vehicle's clock reads, when it is due; `age_s` is the telemetry's.
    pub(super) fn request(&mut self, age_s: f64, system: u8, now_s: f64) -> Option<MavMessage> {
        if now_s < self.due_s {
            return None;
        }
        self.due_s = now_s
            + if age_s > LATE_S {
                LATE_ROUND_TRIP_S
            } else {
                ROUND_TRIP_S
            };
        #[expect(
            clippy::cast_possible_truncation,
            reason = "nanoseconds of a flight fit 63 bits for 292 years"
        )]
        let ts1 = (now_s * 1e9) as i64;
        Some(MavMessage::TIMESYNC(TIMESYNC_DATA {
            tc1: 0,
            ts1,
            target_system: system,
            target_component: AUTOPILOT,
        }))
    }

    /// Takes an answer, if it is to us.
    pub(super) fn take(&mut self, data: &TIMESYNC_DATA, now_s: f64) {
        if let Some((sent_s, _)) = answer_of(data, now_s, LONGEST_QUEUE_S) {
            self.answered(sent_s, now_s);
        }
    }

    /// Takes the answer to a request of `sent_s`.
    fn answered(&mut self, sent_s: f64, now_s: f64) {
        if let Some(kept_s) = self.kept_s.get_mut(self.next % KEPT) {
            *kept_s = Some(now_s - sent_s);
        }
        self.next = (self.next + 1) % KEPT;
        self.answered_s = Some(self.answered_s.map_or(sent_s, |s| s.max(sent_s)));
        self.late = self.is_too_long(now_s);
    }

    /// The present round trip, seconds: the middle one of the last, or at least the age of the newest answered request, less
    /// the time for lost ones; `None` before the first answer.
    pub(super) fn trip_s(&self, now_s: f64) -> Option<f64> {
        let mut known: Vec<f64> = self.kept_s.iter().flatten().copied().collect();
        known.sort_by(f64::total_cmp);
        let middle_s = known.get(known.len() / 2)?;
        Some(middle_s.max(now_s - self.answered_s? - LOST_S))
    }

    /// Whether no manoeuvre could be followed.
    pub(super) fn is_too_long(&self, now_s: f64) -> bool {
        let limit_s = if self.late { SHORT_AGAIN_S } else { LONGEST_S };
        self.trip_s(now_s).is_some_and(|trip_s| trip_s > limit_s)
    }

    /// The dead time that the link adds to the vehicle's, seconds: by the shortest of the last round trips, because delays that
    /// wander are part of the estimate.
    pub(super) fn dead_time_s(&self) -> f64 {
        let shortest_s = self.kept_s.iter().flatten().copied().reduce(f64::min);
        (shortest_s.unwrap_or(0.0).min(LONGEST_S) - ORDINARY_S).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn l10_a_queue_that_grows_is_too_long_before_its_answers_come() {
        let mut trips = Trips::default();
        assert_eq!((trips.trip_s(9.0), trips.is_too_long(9.0)), (None, false));
        for n in 0..10 {
            let sent_s = f64::from(n);
            trips.answered(sent_s, sent_s + 0.06);
        }
        assert_eq!(trips.dead_time_s(), 0.0);
        assert!(!trips.is_too_long(12.0) && trips.is_too_long(13.6));
        // The answers come, 4 s late; then the queue is gone.
        for n in 10..14 {
            let sent_s = f64::from(n);
            trips.answered(sent_s, sent_s + 4.0);
        }
        assert!(trips.is_too_long(18.1));
        for n in 18..24 {
            let sent_s = f64::from(n);
            trips.answered(sent_s, sent_s + 0.8);
        }
        assert!(!trips.is_too_long(24.0));
        assert!((trips.dead_time_s() - 0.5).abs() < 1e-9);
    }
}
