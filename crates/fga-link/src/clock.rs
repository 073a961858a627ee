//! The vehicle's time since boot on this computer's clock: when was a message measured?
//!
//! Each message arrives later than its measurement, by a delay that varies. The least of
//! "arrival − boot time" is the offset of the clocks plus the shortest delay. The estimate of that least
//! value leaks slowly, so that it follows drifting clocks. A boot time that falls back far and stays there
//! is a restart; one that falls back a little is a message out of order. A vehicle whose clock stood still
//! for a moment is late by a constant from then on; after a while the estimate takes that as a step. A late
//! link is late by varying amounts.

/// How fast the offset may grow: 200 parts per million of drift.
const LEAK: f64 = 2e-4;
/// A boot time this far behind the newest is no reordering, seconds.
const RESTART_GAP_S: f64 = 3.0;
/// A constant lateness beyond this is a step of the clocks, seconds …
const STEP_S: f64 = 0.5;
/// … if it varies by less than this, seconds …
const STEADY_S: f64 = 0.4;
/// … for this long, seconds.
const STEP_SEEN_S: f64 = 5.0;
/// A newest boot time ahead of the vehicle's clock by this comes from before the clock was set back, seconds.
const SET_BACK_S: f64 = 0.05;
/// This many in a row count.
const RESTART_COUNT: u8 = 3;
/// Boot times overflow after 2³² milliseconds.
const WRAP_S: f64 = 4_294_967.296;

/// The meaning of a boot time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BootStamp {
    /// Measured at this time of the local clock, seconds; newer than any before.
    New {
        /// Seconds, local clock.
        measured_s: f64,
    },
    /// An overtaken message, or a copy; do not use it.
    Old,
    /// The vehicle restarted.
    Restarted {
        /// Seconds, local clock.
        measured_s: f64,
    },
}

/// The vehicle's clock seen from here; one for each kind of message.
#[derive(Debug, Clone, Default)]
pub struct BootClock {
    newest_boot_s: Option<f64>,
    offset_s: f64,
    offset_at_s: f64,
    suspects: u8,
    late: Option<LateRun>,
}

/// Messages that are all late: start, least and largest lateness, seconds.
#[expect(clippy::struct_field_names, reason = "the unit is part of each name")]
#[derive(Debug, Clone, Copy)]
struct LateRun {
    since_s: f64,
    least_s: f64,
    most_s: f64,
}

impl BootClock {
    /// Takes the boot time of a message that arrived at `now_s`.
    pub fn stamp(&mut self, boot_ms: u32, now_s: f64) -> BootStamp {
        let mut boot_s = f64::from(boot_ms) * 1e-3;
        let Some(newest_s) = self.newest_boot_s else {
            return BootStamp::New {
                measured_s: self.begin(boot_s, now_s),
            };
        };
        // Unwrap, so that the count continues after 49.7 days.
        boot_s += ((newest_s - boot_s) / WRAP_S).round() * WRAP_S;
        if boot_s < newest_s - RESTART_GAP_S {
            self.suspects += 1;
            if self.suspects < RESTART_COUNT {
                return BootStamp::Old;
            }
            let measured_s = self.begin(f64::from(boot_ms) * 1e-3, now_s);
            return BootStamp::Restarted { measured_s };
        }
        if boot_s <= newest_s {
            return BootStamp::Old;
        }
        self.suspects = 0;
        self.newest_boot_s = Some(boot_s);
        let grown = self.offset_s + LEAK * (now_s - self.offset_at_s).max(0.0);
        self.offset_s = grown.min(now_s - boot_s);
        self.watch_step(now_s - boot_s - self.offset_s, now_s);
        self.offset_at_s = now_s;
        BootStamp::New {
            measured_s: boot_s + self.offset_s,
        }
    }

    /// Takes a round trip: the vehicle's clock read `boot_s` at some moment between `sent_s` and `now_s`.
    /// No message with a boot time was measured earlier than the trip allows, however late the
    /// messages are: this shows at once that a clock stood still or was set back, and does not mistake a late
    /// link for that.
    pub fn round_trip(&mut self, sent_s: f64, boot_s: f64, now_s: f64) {
        let Some(newest_s) = self.newest_boot_s else {
            return;
        };
        let boot_s = boot_s + ((newest_s - boot_s) / WRAP_S).round() * WRAP_S;
        let ahead_s = newest_s - boot_s;
        if ahead_s > RESTART_GAP_S {
            return;
        }
        // The clock cannot have read more than this until now.
        if ahead_s > now_s - sent_s + SET_BACK_S {
            self.newest_boot_s = Some(boot_s);
        }
        if sent_s - boot_s > self.offset_s {
            self.offset_s = sent_s - boot_s;
            self.late = None;
        }
    }

    fn begin(&mut self, boot_s: f64, now_s: f64) -> f64 {
        *self = Self {
            newest_boot_s: Some(boot_s),
            offset_s: now_s - boot_s,
            offset_at_s: now_s,
            suspects: 0,
            late: None,
        };
        now_s
    }

    fn watch_step(&mut self, late_s: f64, now_s: f64) {
        if late_s < STEP_S {
            self.late = None;
            return;
        }
        let begun = LateRun {
            since_s: now_s,
            least_s: late_s,
            most_s: late_s,
        };
        let late = self.late.get_or_insert(begun);
        late.least_s = late.least_s.min(late_s);
        late.most_s = late.most_s.max(late_s);
        if late.most_s - late.least_s > STEADY_S {
            *late = begun;
        } else if now_s - late.since_s >= STEP_SEEN_S {
            self.offset_s += late.least_s;
            self.late = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An overloaded simulator, or an autopilot that was held by a debugger.
    #[test]
    fn a_clock_that_stood_still_is_late_for_a_while_only() {
        let mut clock = BootClock::default();
        let mut age_s = 0.0;
        for n in 0_u32..200 {
            let held_s = if n < 100 { 0.0 } else { 1.6 };
            let now_s = f64::from(n) * 0.1 + held_s;
            age_s = now_s - measured(clock.stamp(n * 100, now_s));
            assert!(!(100..=148).contains(&n) || age_s > 1.5);
        }
        assert!(age_s < 0.01, "{age_s}");
        // A link with a wandering delay stays late.
        let mut clock = BootClock::default();
        for n in 0_u32..300 {
            let delay_s = if n < 50 {
                0.0
            } else {
                1.2 + 0.3 * f64::from(n % 7)
            };
            let now_s = f64::from(n) * 0.1 + delay_s;
            age_s = now_s - measured(clock.stamp(n * 100, now_s));
        }
        assert!(age_s > 2.6, "{age_s}");
    }

    fn measured(stamp: BootStamp) -> f64 {
        match stamp {
            BootStamp::New { measured_s } => measured_s,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn delays_are_seen_through() {
        let mut clock = BootClock::default();
        // Measured at 100.0, 100.1, …; delays 50 ms, then 250 ms, then 20 ms, then 120 ms.
        assert_eq!(measured(clock.stamp(5000, 100.05)), 100.05);
        assert!((measured(clock.stamp(5100, 100.35)) - 100.15).abs() < 1e-3);
        assert!((measured(clock.stamp(5200, 100.22)) - 100.22).abs() < 1e-3);
        assert!((measured(clock.stamp(5300, 100.42)) - 100.32).abs() < 1e-3);
    }

    /// The first round trip shows a step; no round trip can remove the lateness of a link.
    #[test]
    fn a_round_trip_tells_a_step_from_a_late_link() {
        let mut clock = BootClock::default();
        for n in 0_u32..50 {
            clock.stamp(n * 100, f64::from(n) * 0.1);
        }
        // It stood still for 1.6 s.
        assert!(7.0 - measured(clock.stamp(5400, 7.0)) > 1.5);
        clock.round_trip(7.02, 5.44, 7.06);
        assert!(7.1 - measured(clock.stamp(5500, 7.1)) < 0.05);
        // Every message is 1.6 s late, and so is the answer.
        let mut clock = BootClock::default();
        for n in 0_u32..50 {
            clock.stamp(n * 100, f64::from(n) * 0.1);
        }
        clock.round_trip(7.0, 7.01, 8.61);
        assert!(8.6 - measured(clock.stamp(7000, 8.6)) > 1.59);
        // It is set back by two seconds: no restart, and nothing is old for two seconds.
        let mut clock = BootClock::default();
        for n in 0_u32..50 {
            clock.stamp(10_000 + n * 100, f64::from(n) * 0.1);
        }
        assert_eq!(clock.stamp(13_000, 5.0), BootStamp::Old);
        clock.round_trip(5.0, 13.01, 5.02);
        assert!(5.1 - measured(clock.stamp(13_100, 5.1)) < 0.05);
    }

    #[test]
    fn reordered_and_repeated_messages_are_old() {
        let mut clock = BootClock::default();
        clock.stamp(5000, 0.0);
        clock.stamp(5200, 0.2);
        assert_eq!(clock.stamp(5100, 0.25), BootStamp::Old);
        assert_eq!(clock.stamp(5200, 0.25), BootStamp::Old);
    }

    #[test]
    fn a_restart_is_believed_after_three() {
        let mut clock = BootClock::default();
        clock.stamp(60_000, 0.0);
        assert_eq!(clock.stamp(1000, 1.0), BootStamp::Old);
        assert_eq!(clock.stamp(1100, 1.1), BootStamp::Old);
        assert_eq!(
            clock.stamp(1200, 1.2),
            BootStamp::Restarted { measured_s: 1.2 }
        );
        assert!((measured(clock.stamp(1300, 1.3)) - 1.3).abs() < 1e-3);
    }

    #[test]
    fn one_stray_packet_is_no_restart() {
        let mut clock = BootClock::default();
        clock.stamp(60_000, 0.0);
        for n in 0..10_u32 {
            assert_eq!(clock.stamp(1000, f64::from(n)), BootStamp::Old);
            measured(clock.stamp(60_100 + 1000 * n, f64::from(n) + 0.1));
        }
    }

    #[test]
    fn the_count_runs_over() {
        let mut clock = BootClock::default();
        clock.stamp(u32::MAX - 50, 0.0);
        assert!((measured(clock.stamp(49, 0.1)) - 0.1).abs() < 1e-3);
    }

    /// As after 29 days, and on a computer that has run for a while.
    const LATE_MS: u32 = 2_500_000_000;
    const BEGUN_S: f64 = 50.0;

    /// A clock that has heard `count` messages without delay, ten a second.
    fn heard(from_ms: u32, from_s: f64, count: u32) -> BootClock {
        let mut clock = BootClock::default();
        for n in 0..count {
            clock.stamp(from_ms.wrapping_add(n * 100), from_s + f64::from(n) * 0.1);
        }
        clock
    }

    #[test]
    fn a_late_message_is_late_after_any_time_since_boot() {
        for from_ms in [0, 5000, LATE_MS, u32::MAX - 4920] {
            let mut clock = heard(from_ms, BEGUN_S, 50);
            let at_s = measured(clock.stamp(from_ms.wrapping_add(5000), BEGUN_S + 5.3));
            assert!((at_s - BEGUN_S - 5.0).abs() < 2e-3, "{from_ms}: {at_s}");
            // It stood still for 1.6 s; the message after the round trip is late by 0.3 s.
            let boot_s = f64::from(from_ms.wrapping_add(5440)) * 1e-3;
            clock.round_trip(BEGUN_S + 7.02, boot_s, BEGUN_S + 7.06);
            let at_s = measured(clock.stamp(from_ms.wrapping_add(5500), BEGUN_S + 7.4));
            assert!((at_s - BEGUN_S - 7.1).abs() < 0.05, "{from_ms}: {at_s}");
        }
    }

    #[test]
    fn a_clock_that_stood_still_is_noticed_whatever_the_two_clocks_read() {
        for (from_ms, from_s) in [(100_000, 0.0), (0, BEGUN_S)] {
            let mut clock = heard(from_ms, from_s, 50);
            let mut age_s = 0.0;
            for n in 50_u32..150 {
                let now_s = from_s + f64::from(n) * 0.1 + 1.6;
                age_s = now_s - measured(clock.stamp(from_ms + n * 100, now_s));
                assert!(n > 99 || age_s > 1.5, "{age_s}");
            }
            assert!(age_s < 0.01, "{age_s}");
        }
    }

    #[test]
    fn a_clock_that_loses_a_tenth_of_a_millisecond_each_second_is_followed() {
        let mut clock = BootClock::default();
        let mut age_s = 0.0;
        for n in 0_u32..10_000 {
            let now_s = f64::from(n) * 0.1 + 1e-4 * f64::from(n) * 0.1;
            age_s = now_s - measured(clock.stamp(n * 100, now_s));
        }
        assert!(age_s < 0.002, "{age_s}");
    }

    #[test]
    fn messages_that_are_all_late_stay_late_but_for_the_drift() {
        let mut clock = heard(0, 1.0, 10);
        let mut age_s = 0.0;
        for n in 10_u32..210 {
            let now_s = 1.2 + f64::from(n) * 0.1;
            age_s = now_s - measured(clock.stamp(n * 100, now_s));
        }
        assert!((0.19..0.2).contains(&age_s), "{age_s}");
    }

    /// Lateness below half a second in between: a slow link, no step.
    #[test]
    fn delays_on_either_side_of_half_a_second_are_no_step() {
        let mut clock = heard(0, 0.0, 50);
        for n in 50_u32..200 {
            let late_s = if n % 2 == 0 { 0.3 } else { 0.6 };
            let now_s = f64::from(n) * 0.1 + late_s;
            let age_s = now_s - measured(clock.stamp(n * 100, now_s));
            assert!(age_s > late_s - 0.01, "{age_s}");
        }
    }

    #[test]
    fn a_restart_is_believed_however_long_the_vehicle_was_on() {
        let mut clock = heard(60_000, 0.0, 1);
        assert_eq!(clock.stamp(50_000, 1.0), BootStamp::Old);
        assert_eq!(clock.stamp(50_100, 1.1), BootStamp::Old);
        assert_eq!(
            clock.stamp(50_200, 1.2),
            BootStamp::Restarted { measured_s: 1.2 }
        );
        // A round trip alone is no restart.
        let mut clock = heard(60_000, 0.0, 1);
        clock.round_trip(0.9, 10.0, 1.0);
        assert_eq!(clock.stamp(10_100, 1.1), BootStamp::Old);
        assert_eq!(clock.stamp(10_200, 1.2), BootStamp::Old);
        assert_eq!(
            clock.stamp(10_300, 1.3),
            BootStamp::Restarted { measured_s: 1.3 }
        );
    }

    #[test]
    fn a_round_trip_of_a_clock_that_goes_on_changes_nothing() {
        // The vehicle read its clock before its last message, and after it.
        for (sent_s, boot_s) in [(4.85, 4.87), (4.9, 4.92)] {
            let mut clock = heard(0, 0.0, 50);
            clock.round_trip(sent_s, boot_s, sent_s + 0.06);
            assert_eq!(clock.stamp(4900, 4.97), BootStamp::Old);
            assert!((measured(clock.stamp(4910, 5.3)) - 4.91).abs() < 1e-3);
        }
        // It is set back by half a second: nothing is old for half a second.
        let mut clock = heard(10_000, 0.0, 50);
        clock.round_trip(5.0, 14.51, 5.02);
        assert!((measured(clock.stamp(14_600, 5.1)) - 5.1).abs() < 0.03);
    }
}
