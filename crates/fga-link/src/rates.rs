//! Message rates: requested until measured.
//!
//! An acknowledgement does not count: requests and answers get lost, a vehicle forgets its
//! rates when it restarts, and it may send a message at another rate than the requested one. Only
//! arrivals count, and a message that does not come often enough is requested again.

use alloc::collections::VecDeque;

use mavlink::dialects::ardupilotmega::{
    ATTITUDE_DATA, GLOBAL_POSITION_INT_DATA, GPS_RAW_INT_DATA, HEARTBEAT_DATA,
    MISSION_CURRENT_DATA, MavCmd, MavMessage, NAV_CONTROLLER_OUTPUT_DATA,
    POSITION_TARGET_GLOBAL_INT_DATA, SCALED_PRESSURE_DATA, SYS_STATUS_DATA, SYSTEM_TIME_DATA,
    VFR_HUD_DATA, WIND_DATA,
};
use mavlink::{Message as _, MessageData as _};

use crate::commands::VehicleCommand;
use crate::number::single;
use crate::outgoing::Outbox;

/// Indices of the messages with attitude and position.
const ATTITUDE: usize = 0;
const POSITION: usize = 1;
/// The numbers of the requested messages and their intervals, seconds; the heartbeat more often than usual, because it has the mode.
const STREAMS: [(u32, f64); 12] = [
    (ATTITUDE_DATA::ID, 0.05),
    (GLOBAL_POSITION_INT_DATA::ID, 0.1),
    (HEARTBEAT_DATA::ID, 0.25),
    (VFR_HUD_DATA::ID, 0.25),
    (WIND_DATA::ID, 1.0),
    (MISSION_CURRENT_DATA::ID, 0.5),
    // The commanded bank, often enough for `fga identify`.
    (NAV_CONTROLLER_OUTPUT_DATA::ID, 0.2),
    (POSITION_TARGET_GLOBAL_INT_DATA::ID, 0.5),
    (SYSTEM_TIME_DATA::ID, 2.0),
    // Our pressure, to compare with other aircraft's, and the height of the geoid.
    (SCALED_PRESSURE_DATA::ID, 0.5),
    (GPS_RAW_INT_DATA::ID, 2.0),
    // Whether the fence is enabled.
    (SYS_STATUS_DATA::ID, 1.0),
];

/// A message arrives as requested if half of its gaps are at most this many intervals.
const ENOUGH: f64 = 1.3;
/// Number of gaps for this judgement.
const JUDGED_GAPS: usize = 5;
/// Time for a request to take effect, seconds and intervals of the message.
const SHOWS_AFTER_S: f64 = 0.4;
const SHOWS_AFTER_INTERVALS: f64 = 2.2;
/// Requests at that pace; then the pause, so that they do not pester a vehicle that cannot send more,
/// seconds.
const BRISK_REQUESTS: u32 = 20;
const PAUSE_S: f64 = 5.0;
/// Memory of arrivals, s, and their largest number.
const MEMORY_S: f64 = 4.0;
const MOST_ARRIVALS: usize = 256;
/// Least number of gaps for a rate.
const KNOWN_GAPS: usize = 3;
/// Longest usable interval of position and attitude, seconds.
pub const USABLE_INTERVAL_S: f64 = 0.5;
/// Once usable, a rate stays usable until it is slower by this factor, so that it does not flicker.
const HYSTERESIS: f64 = 1.3;

/// Arrivals of one message.
#[derive(Debug, Clone, Default)]
struct Arrivals {
    /// Times of arrival, oldest first, seconds.
    at_s: VecDeque<f64>,
    /// Requests since it last arrived as requested.
    requests: u32,
    again_s: Option<f64>,
    /// The last measured interval, seconds.
    interval_s: Option<f64>,
}

impl Arrivals {
    fn push(&mut self, now_s: f64) {
        while self.at_s.len() >= MOST_ARRIVALS
            || self
                .at_s
                .front()
                .is_some_and(|at_s| now_s - at_s > MEMORY_S)
        {
            self.at_s.pop_front();
        }
        self.at_s.push_back(now_s);
        self.interval_s = self.measured_s().or(self.interval_s);
    }

    fn gaps_s(&self) -> impl Iterator<Item = f64> + '_ {
        self.at_s
            .iter()
            .zip(self.at_s.iter().skip(1))
            .map(|(before_s, after_s)| after_s - before_s)
    }

    /// The gap in which half of the time passed, without the longest one: one outage is no rate, and
    /// messages in bursts come as often as the bursts.
    fn measured_s(&self) -> Option<f64> {
        let mut gaps_s: Vec<f64> = self.gaps_s().collect();
        if gaps_s.len() < KNOWN_GAPS {
            return None;
        }
        gaps_s.sort_by(f64::total_cmp);
        gaps_s.pop();
        let half_s = 0.5 * gaps_s.iter().sum::<f64>();
        let mut passed_s = 0.0;
        gaps_s.into_iter().find(|gap_s| {
            passed_s += gap_s;
            passed_s >= half_s
        })
    }

    fn arrives(&self, asked_s: f64, now_s: f64) -> bool {
        let mut gaps_s: Vec<f64> = self.gaps_s().collect();
        let recent = gaps_s.split_off(gaps_s.len().saturating_sub(JUDGED_GAPS));
        let silent_s = self.at_s.back().map_or(f64::INFINITY, |at_s| now_s - at_s);
        let short = recent.iter().filter(|gap_s| **gap_s <= ENOUGH * asked_s);
        !recent.is_empty()
            && 2 * short.count() >= recent.len()
            && silent_s <= 2.0 * SHOWS_AFTER_S + SHOWS_AFTER_INTERVALS * asked_s
    }
}

/// Requests messages and measures their arrivals.
#[derive(Debug, Clone, Default)]
pub struct Rates {
    arrivals: [Arrivals; STREAMS.len()],
    usable: bool,
}

impl Rates {
    /// Takes a message from the vehicle.
    pub fn heard(&mut self, message: &MavMessage, now_s: f64) {
        let id = message.message_id();
        let mut streams = STREAMS.iter().zip(&mut self.arrivals);
        if let Some((_, arrivals)) = streams.find(|(stream, _)| stream.0 == id) {
            arrivals.push(now_s);
        }
        if let Some(interval_s) = self.interval_s() {
            let limit_s = if self.usable {
                HYSTERESIS * USABLE_INTERVAL_S
            } else {
                USABLE_INTERVAL_S
            };
            self.usable = interval_s <= limit_s;
        }
    }

    /// Forgets the measurements: the vehicle restarted.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Requests every message that does not arrive as it should; `attitude_s` is the wanted interval of
    /// attitudes, seconds.
    pub fn tick(&mut self, attitude_s: f64, now_s: f64, target_system: u8, outbox: &mut Outbox) {
        for ((id, interval_s), arrivals) in STREAMS.into_iter().zip(&mut self.arrivals) {
            let is_attitude = id == ATTITUDE_DATA::ID;
            let asked_s = interval_s.min(if is_attitude { attitude_s } else { interval_s });
            if arrivals.arrives(asked_s, now_s) {
                arrivals.requests = 0;
                arrivals.again_s = None;
                continue;
            }
            if arrivals.again_s.is_some_and(|again_s| now_s < again_s) {
                continue;
            }
            arrivals.requests = arrivals.requests.saturating_add(1);
            let pause_s = if arrivals.requests <= BRISK_REQUESTS {
                SHOWS_AFTER_S + SHOWS_AFTER_INTERVALS * asked_s
            } else {
                PAUSE_S + SHOWS_AFTER_INTERVALS * asked_s
            };
            arrivals.again_s = Some(now_s + pause_s);
            let command = VehicleCommand::long(
                MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
                id as f32,
                single(asked_s * 1e6),
            );
            // The first request may have got lost: from then on send two.
            for _ in 0..arrivals.requests.min(2) {
                outbox.send(command.message(target_system, 0));
            }
        }
    }

    /// The longer of the measured intervals of attitude and position, seconds; `None` before both
    /// are known.
    pub fn interval_s(&self) -> Option<f64> {
        let measured = |index: usize| self.arrivals.get(index).and_then(|a| a.interval_s);
        Some(measured(ATTITUDE)?.max(measured(POSITION)?))
    }

    /// Whether attitude and position come often enough to fly by.
    pub const fn is_usable(&self) -> bool {
        self.usable
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feed(rates: &mut Rates, at_s: f64) {
        rates.heard(&MavMessage::ATTITUDE(ATTITUDE_DATA::DEFAULT), at_s);
        rates.heard(
            &MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA::DEFAULT),
            at_s,
        );
    }

    #[test]
    fn messages_that_arrive_too_seldom_are_requested_again() {
        let (mut rates, mut outbox) = (Rates::default(), Outbox::default());
        for n in 0..10_u8 {
            feed(&mut rates, f64::from(n));
            rates.tick(0.05, f64::from(n) + 0.5, 1, &mut outbox);
        }
        let asked = outbox.take();
        let attitudes = asked.iter().filter(|outgoing| {
            matches!(&outgoing.message, MavMessage::COMMAND_LONG(data)
                if data.param1 == 30.0 && data.param2 == 50_000.0)
        });
        // Ten times, all but the first one twice.
        assert_eq!(attitudes.count(), 19);
    }

    #[test]
    fn arriving_messages_are_requested_only_when_they_stop() {
        let (mut rates, mut outbox) = (Rates::default(), Outbox::default());
        let asks_for_attitude = |outbox: &mut Outbox| {
            outbox.take().iter().any(|outgoing| {
                matches!(&outgoing.message, MavMessage::COMMAND_LONG(data) if data.param1 == 30.0)
            })
        };
        for n in 0..40_u8 {
            feed(&mut rates, f64::from(n) * 0.05);
        }
        rates.tick(0.05, 2.0, 1, &mut outbox);
        assert!(!asks_for_attitude(&mut outbox));
        rates.tick(0.05, 3.5, 1, &mut outbox);
        assert!(asks_for_attitude(&mut outbox));
    }

    #[test]
    fn one_outage_is_no_rate_and_bursts_are_as_slow_as_they_are() {
        let mut rates = Rates::default();
        for n in 0..30_u8 {
            feed(&mut rates, f64::from(n) * 0.1);
        }
        for n in 0..10_u8 {
            feed(&mut rates, 5.5 + f64::from(n) * 0.1);
        }
        assert!(rates.is_usable() && rates.interval_s().unwrap() < 0.11);
        let mut rates = Rates::default();
        for second in 0..10_u8 {
            for n in 0..10_u8 {
                feed(&mut rates, f64::from(second) + f64::from(n) * 1e-3);
            }
        }
        assert!(!rates.is_usable(), "{:?}", rates.interval_s());
    }

    #[test]
    fn at_the_limit_it_does_not_come_and_go() {
        let mut rates = Rates::default();
        let (mut at_s, mut changes, mut usable) = (0.0, 0, false);
        for n in 0..200_u8 {
            at_s += if n % 3 == 0 { 0.55 } else { 0.48 };
            feed(&mut rates, at_s);
            changes += u32::from(rates.is_usable() != usable);
            usable = rates.is_usable();
        }
        assert!(changes <= 1, "{changes}");
    }
}
